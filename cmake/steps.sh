# shellcheck shell=bash
# Steps that demos/run and tests/run share; sourced by them. Sets `root`, the source folder, symbolic links resolved.
root=$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/.." && pwd -P)
jobs=$(nproc)

# Installs what is missing from the named lists (paths below root).
install_packages() { "$root/cmake/install_packages.sh" "${@/#/$root/}"; }

# configure PRESET [cmake options]: quiet unless it fails. A build folder that came from elsewhere with a copy of the
# sources is made anew: CMake refuses it.
configure() {
    local preset=$1 folder="$root/build/$1" log
    shift
    if [ -f "$folder/CMakeCache.txt" ] &&
        ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
        echo "$folder was made from another source folder: starting anew"
        rm -rf "$folder"
    fi
    if ! mkdir -p "$folder" || [ ! -w "$folder" ]; then
        echo "cannot write to $folder (made by root?)" >&2
        return 1
    fi
    log="$folder/configure.log"
    echo "Configuring build/$preset"
    if ! cmake -S "$root" --preset "$preset" "$@" >"$log" 2>&1; then
        cat "$log" >&2
        return 1
    fi
}

# build PRESET [targets]
build() {
    local preset=$1
    shift
    echo "Building build/$preset, $jobs at a time"
    cmake --build "$root/build/$preset" --parallel "$jobs" ${1:+--target "$@"}
}
