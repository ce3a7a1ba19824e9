#!/usr/bin/env bash
# Usage: install_packages.sh LIST...
# Installs the Debian packages named in the lists (one per line, # comments) that are missing; needs no network and no
# rights if none is. Exit code 1, and a message that names the package, if one cannot be had.
set -euo pipefail

die() { printf 'install_packages.sh: %s\n' "$*" >&2; exit 1; }

[ $# -gt 0 ] || die "name at least one list of packages"
wanted=()
for list in "$@"; do
    [ -r "$list" ] || die "cannot read the list $list"
    while read -r name _ || [ -n "$name" ]; do
        name=${name%%#*}
        if [ -n "$name" ]; then wanted+=("$name"); fi
    done <"$list"
done

if ! command -v dpkg-query >/dev/null; then
    echo "install_packages.sh: not a Debian system; what the build needs stands in $*" >&2
    exit 0
fi

# Prints those of the arguments that are not installed.
missing_of() {
    local installed
    installed=$'\n'$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p')$'\n'
    local name
    for name in "$@"; do
        [[ $installed == *$'\n'"$name"$'\n'* ]] || printf '%s\n' "$name"
    done
}

mapfile -t missing < <(missing_of "${wanted[@]}")
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || die "not root and no sudo; as root run: apt-get install ${missing[*]}"
    as_root=(sudo)
    [ -t 0 ] || as_root=(sudo -n)  # nobody is there to type a password
    "${as_root[@]}" true || die "sudo refused; as root run: apt-get install ${missing[*]}"
fi
apt() {
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300 \
        -o Dpkg::Options::=--force-confold "$@" </dev/null
}

echo "Installing ${#missing[@]} packages: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# A broken third-party source fails here too, and does no harm if the packages come from elsewhere.
apt update >"$log" 2>&1 || { tail -n 5 "$log" >&2; echo "install_packages.sh: apt-get update failed; going on" >&2; }

for name in "${missing[@]}"; do
    # To a variable first: with pipefail, a grep that stops reading would fail the pipe.
    policy=$(LC_ALL=C apt-cache policy "$name" 2>/dev/null || true)
    [[ $policy == *"Candidate: "* && $policy != *"Candidate: (none)"* ]] ||
        die "there is no package '$name' in this machine's apt sources (Debian 12 has it in main; is the network up?)"
done

if ! apt install --no-install-recommends "${missing[@]}" >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    mapfile -t missing < <(missing_of "${missing[@]}")
    die "apt-get could not install: ${missing[*]}"
fi
mapfile -t missing < <(missing_of "${missing[@]}")
[ ${#missing[@]} -eq 0 ] || die "still missing after apt-get install: ${missing[*]}"
