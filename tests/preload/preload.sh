#!/usr/bin/env bash
# preload.sh TOOL PRECISION PROGRAM OPENER PLUGIN: programs that know nothing of us get our contacts, and are told so.
set -euo pipefail
tool=$1 precision=$2 program=$3 opener=$4 plugin=$5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "preload.sh: $*" >&2
    exit 1
}

# with NAME LOGLINE ARGUMENTS...: the ring rests, and the log has the line.
with() {
    local name=$1 line=$2
    shift 2
    rm -f "$work/log"
    "$tool" preload --log "$work/log" "$@" >"$work/out" || fail "$name: exit code $?"
    awk '$1 == "y" && $2 > 0.5 && $2 < 1.5 && $4 > 0 { good = 1 } END { exit !good }' "$work/out" ||
        fail "$name: does not rest: $(cat "$work/out")"
    grep -q "$precision precision" "$work/log" || fail "$name: log says: $(cat "$work/log")"
    grep -q "$line" "$work/log" || fail "$name: no '$line' in: $(cat "$work/log")"
    [ "$(grep -c 'dispatcher 1' "$work/log")" = 1 ] || fail "$name: reported twice: $(cat "$work/log")"
}

falls=$("$program")
awk '$2 < -10 && $4 == 0 { good = 1 } END { exit !good }' <<<"$falls" || fail "Bullet alone holds it: $falls"

taken='BVH mesh against GImpact mesh: 1$'
with "plain" "$taken" -- "$program"
with "GImpact registered afterwards" "$taken" -- "$program" --gimpact
with "a class of its own" "$taken" -- "$program" --derived
with "never destroyed" "$taken" -- "$program" --leak
with "opened at run time" "$taken" -- "$opener" "$plugin"
with "opened, never destroyed" "$taken" -- "$opener" "$plugin" --leak --gimpact
with "under a budget" "$taken" --pair-budget 256 -- "$program"
with "exact" "$taken" --exact -- "$program"

# By hand, without the tool: what it would set.
library=$(dirname "$(readlink -f "$tool")")/../plugin/preload/libgrapeshot-preload.so
GRAPESHOT_PRELOAD_BUDGET=many LD_PRELOAD=$library "$program" >"$work/out" 2>"$work/err"
grep -q "GRAPESHOT_PRELOAD_BUDGET is 'many'" "$work/err" || fail "bad budget: $(cat "$work/err")"
grep -q "$taken" "$work/err" || fail "on standard error: $(cat "$work/err")"

# Settings of a program around it are not its own.
"$tool" preload --log "$work/outer" --exact -- "$tool" preload --log "$work/inner" -- "$program" >/dev/null
grep -q "$taken" "$work/inner" || fail "nested: $(cat "$work/inner")"
mkdir -p "$work/a folder/bin" "$work/a folder/plugin/preload"
cp "$tool" "$work/a folder/bin/grapeshot"
cp "$library" "$work/a folder/plugin/preload/"
code=0
LD_LIBRARY_PATH=$(dirname "$library")/..:$(dirname "$library")/../.. "$work/a folder/bin/grapeshot" preload -- "$program" >"$work/out" 2>"$work/err" || code=$?
[ $code = 2 ] && grep -q 'space or a colon' "$work/err" || fail "a path with a space: $code, $(cat "$work/err")"

"$tool" preload --log "$work/none" -- true
grep -q 'nothing was taken over in this process' "$work/none" || fail "without Bullet: $(cat "$work/none")"

code=0
"$tool" preload -- "$work/no such program" 2>"$work/err" || code=$?
[ $code = 2 ] && grep -q 'No such file' "$work/err" || fail "missing program: $code, $(cat "$work/err")"
code=0
"$tool" preload >/dev/null 2>&1 || code=$?
[ $code = 2 ] || fail "no program: $code"
"$tool" preload -- sh -c 'exit 7' >/dev/null 2>&1 || code=$?
[ $code = 7 ] || fail "the program's own exit code: $code"
echo "preload.sh: $precision: ok"
