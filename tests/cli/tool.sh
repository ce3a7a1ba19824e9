#!/usr/bin/env bash
# tool.sh PROGRAM: what `grapeshot` prints, writes and returns.
set -euo pipefail
tool=$1
# shellcheck source=tests/cli/says.sh
. "$(dirname "$(readlink -f "$0")")/says.sh"

expect() { says "$1" "$2" "$tool" "${@:3}"; }

printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' >'a good one.off'
printf "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n" >open.off
printf "OFF\n4 4 0\nnan 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n" >nan.off
printf 'OFF\n1099511627776 4 0\n0 0 0\n' >huge.off

expect 0 "grapeshot " --version
expect 0 "inspect" --help
expect 2 "" # no subcommand
expect 2 "" nonsense
expect 2 "" inspect
expect 2 "" compare 'a good one.off'

expect 0 "It can be used." inspect 'a good one.off' --json report.json
grep -q '"closed": true' report.json
grep -q '"triangles": 4' report.json
expect 0 "It can be used." inspect open.off --json report.json
grep -q '"boundaryEdges": 3' report.json
expect 1 "notFinite" inspect nan.off --json report.json
grep -q '"notFiniteVertices": 1' report.json
grep -q '"usable": false' report.json
expect 2 "1099511627776" inspect huge.off
expect 2 "No such file" inspect missing.off
expect 2 "cannot be written" inspect open.off --json /nonexistent/report.json

expect 0 "decide" compare 'a good one.off' open.off --poses 500 --seed 7 --json first.json
expect 0 "decide" compare 'a good one.off' open.off --poses 500 --seed 7 --json second.json
expect 0 "decide" compare 'a good one.off' open.off --poses 500 --seed 8 --json other.json
# Same seed, same counts; another seed, other poses. (Times differ, so only the counts are compared.)
counts() { grep -oE '"(colliding|work)": ([0-9.]+|\{[^}]*\})' "$1"; }
diff <(counts first.json) <(counts second.json)
if diff -q <(counts first.json) <(counts other.json) >/dev/null; then
    echo "the seed changes nothing"
    exit 1
fi
colliding=$(grep -oE '"colliding": [0-9]+' first.json | head -n 1 | grep -oE '[0-9]+')
if [ "$colliding" -lt 25 ] || [ "$colliding" -gt 475 ]; then
    echo "$colliding of 500 poses collide: no sample to speak of"
    exit 1
fi
expect 2 "" compare 'a good one.off' nan.off
expect 2 "" compare 'a good one.off' open.off --poses 0
expect 2 "" compare 'a good one.off' open.off --poses many
