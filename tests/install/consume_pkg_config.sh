#!/usr/bin/env bash
# consume_pkg_config.sh STAGE WORK MODULE COMPILER [mixed]: the same by pkg-config. With `mixed`, the headers are set to
# the other precision than the library's, and the link must fail for a name of the other precision's namespace.
set -euo pipefail
stage=$1 work=$2 module=$3 compiler=$4 mixed=${5-}
here=$(cd "$(dirname "$0")" && pwd -P)
rm -rf "$work"
mkdir -p "$work"
PKG_CONFIG_PATH=$(dirname "$(find "$stage" -name grapeshot.pc)")
export PKG_CONFIG_PATH
[ "$PKG_CONFIG_PATH" != . ] || { echo "no grapeshot.pc in $stage" >&2; exit 1; }
libraries=$(pkg-config --variable=libdir grapeshot)
source=$here/../../demos/minimal.cpp
[ "$module" != grapeshot ] || source=$here/consumer/core.cpp
read -ra flags < <(pkg-config --cflags "$module")
read -ra libs < <(pkg-config --libs "$module")
link() { "$compiler" -std=c++20 "${flags[@]}" "$@" "$source" -o "$work/my_game" "${libs[@]}"; }

if [ -z "$mixed" ]; then
    link
    LD_LIBRARY_PATH=$libraries "$work/my_game"
    exit
fi
case $module in
    grapeshot-bullet) other=f64 toggle=-DBT_USE_DOUBLE_PRECISION ;;
    *) other=f32 toggle=-UBT_USE_DOUBLE_PRECISION ;;
esac
# Bullet's other library too, so that only our own names can be missing.
libs+=(-lBulletDynamics -lBulletCollision -lLinearMath -lBulletDynamics-float64 -lBulletCollision-float64
    -lLinearMath-float64)
if link "$toggle" 2>"$work/log"; then
    echo "a mixed program links" >&2
    exit 1
fi
if ! grep -q "undefined reference to .*grapeshot::$other::" "$work/log"; then
    cat "$work/log" >&2
    echo "it does not link, but not for the namespace" >&2
    exit 1
fi
