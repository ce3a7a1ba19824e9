#!/usr/bin/env bash
# bullet_probe.sh WORK COMPILER: headers and library of Bullet that agree pass, all ways to disagree stop the configure.
set -euo pipefail
work=$1 compiler=$2
here=$(cd "$(dirname "$0")" && pwd -P)
rm -rf "$work"
mkdir -p "$work/pc"
include=$(pkg-config --cflags-only-I bullet)

# Packages that lie: the define of one precision with the library of the other.
pc() {
    printf 'Name: %s\nDescription: a lie\nVersion: 3.24\nCflags: %s %s\nLibs: %s\n' "$1" "$include" "$2" "$3" \
        >"$work/pc/$1.pc"
}
pc double-headers -DBT_USE_DOUBLE_PRECISION "-lBulletCollision -lLinearMath"
pc double-library "" "-lBulletCollision-float64 -lLinearMath-float64"
export PKG_CONFIG_PATH=$work/pc

# expect agree|disagree MODULE SCALAR
expect() {
    local folder="$work/$2-$3" found=disagree
    if cmake -S "$here/bullet_probe" -B "$folder" -G Ninja -DMODULE="$2" -DSCALAR="$3" \
        -DCMAKE_CXX_COMPILER="$compiler" >"$work/log" 2>&1; then
        found=agree
    elif ! grep -q "disagree about btScalar" "$work/log"; then
        found="fail otherwise"
    fi
    echo "$2 as $3: $found"
    [ "$found" = "$1" ] || { cat "$work/log"; exit 1; }
}
expect agree bullet float
expect agree bullet-float64 double
expect disagree bullet double
expect disagree bullet-float64 float
expect disagree double-headers double # right headers, wrong library: only the link can tell
expect disagree double-library float
