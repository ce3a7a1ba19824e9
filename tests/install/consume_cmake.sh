#!/usr/bin/env bash
# consume_cmake.sh STAGE WORK COMPONENT COMPILER: a project of somebody else finds the staged installation by
# find_package, builds the README's program (or, for component grapeshot, one without Bullet) and runs it.
set -euo pipefail
stage=$1 work=$2 component=$3 compiler=$4
here=$(cd "$(dirname "$0")" && pwd -P)
rm -rf "$work"
mkdir -p "$work"
case $component in
    grapeshot) cp "$here/consumer/core.cpp" "$work/minimal.cpp" ;;
    *) cp "$here/../../demos/minimal.cpp" "$work/minimal.cpp" ;;
esac
sed -e "s/COMPONENTS bullet/COMPONENTS $component/" -e "s/Grapeshot::bullet/Grapeshot::$component/" \
    "$here/consumer/CMakeLists.txt" >"$work/CMakeLists.txt"
cmake -S "$work" -B "$work/build" -G Ninja -DCMAKE_PREFIX_PATH="$stage" -DCMAKE_CXX_COMPILER="$compiler"
cmake --build "$work/build"
"$work/build/my_game"
