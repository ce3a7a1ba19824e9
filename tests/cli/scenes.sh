#!/usr/bin/env bash
# scenes.sh PROGRAM: scenes as .bullet files: written, run again, and files that are not what they claim to be.
set -euo pipefail
tool=$1
# shellcheck source=tests/cli/says.sh
. "$(dirname "$(readlink -f "$0")")/says.sh"

expect() { says "$1" "$2" "$tool" "${@:3}"; }
# overwrite FILE BYTE HEX...: bytes in place.
overwrite() {
    local file=$1 at=$2 bytes=
    shift 2
    for byte in "$@"; do bytes+="\\x$byte"; done
    printf '%b' "$bytes" | dd of="$file" bs=1 seek="$at" conv=notrunc status=none
}
value() { grep -oE "\"$2\": [-0-9.e+]+" "$1" | head -n 1 | grep -oE '[-0-9.e+]+$'; }

for name in pile tori u-on-bar cross chain; do
    expect 0 "$name.bullet" scene "$name" "$name.bullet"
    expect 0 "grapeshot" run "$name.bullet" --steps 20
done
expect 2 "" scene nonsense out.bullet
expect 2 "cannot be written" scene tori /nonexistent/out.bullet
expect 2 "" run
expect 2 "" run tori.bullet --steps 0
expect 2 "" run tori.bullet --against nonsense

# The GImpact bodies are there, and collide; in plain Bullet they fall through the floor.
expect 0 "3 bodies, 2 of them moving, 2 mesh shapes (1 GImpact)" run tori.bullet --against none --steps 240 --json report.json
awk -v ours="$(value report.json 'contacts/step')" 'BEGIN { exit !(ours > 2) }'
[ "$(grep -oE '"contacts/step": [-0-9.e+]+' report.json | tail -n 1 | grep -oE '[-0-9.e+]+$' | cut -d. -f1)" = 0 ]
expect 0 "gimpact" run pile.bullet --against gimpact --steps 30 --json report.json
grep -q '"peer": "gimpact"' report.json
# The same bytes in, the same work out, on any number of threads.
expect 0 "" run pile.bullet --steps 60 --json one.json
expect 0 "" run pile.bullet --steps 60 --threads 3 --json three.json
[ "$(value one.json 'units/step')" = "$(value three.json 'units/step')" ]
[ "$(value one.json 'contacts/step')" = "$(value three.json 'contacts/step')" ]
expect 0 "" run pile.bullet --steps 60 --budget 50 --json poor.json
awk -v n="$(value poor.json 'cut short/step')" 'BEGIN { exit !(n > 0) }'

# Files that are none.
expect 2 "No such file" run missing.bullet
: >empty.bullet
expect 2 "does not begin with BULLET" run empty.bullet
printf 'solid nothing\nendsolid\n' >stl.bullet
expect 2 "does not begin with BULLET" run stl.bullet
size=$(stat -c %s tori.bullet)
for part in 11 12 20 40 1000 $((size / 3)) $((size / 2)) $((size - 100)) $((size - 1)); do
    head -c "$part" tori.bullet >cut.bullet
    expect 2 "badFile" run cut.bullet
done
damaged() { cp tori.bullet damaged.bullet; overwrite damaged.bullet "$@"; }
damaged 0 58 # another magic
expect 2 "does not begin with BULLET" run damaged.bullet
damaged 8 56 # the other byte order
expect 2 "byte order" run damaged.bullet
damaged 16 ff ff ff 7f # the first chunk
expect 2 "longer than the file" run damaged.bullet
damaged 16 ff ff ff ff
expect 2 "longer than the file" run damaged.bullet
damaged 32 ff ff ff 7f # its structures
expect 2 "badFile" run damaged.bullet

# Wild numbers anywhere: a named error or another scene, never a crash.
refused=0
for at in $(seq 12 $((size / 97)) $((size - 4))); do
    for number in "ff ff ff 7f" "ff ff ff ff" "00 00 c0 7f"; do
        # shellcheck disable=SC2086
        damaged "$at" $number
        code=0
        "$tool" run damaged.bullet --steps 2 >out 2>&1 </dev/null || code=$?
        if [ "$code" -gt 2 ]; then
            echo "byte $at <- $number: exit code $code"
            cat out
            exit 1
        fi
        [ "$code" -ne 2 ] || refused=$((refused + 1))
    done
done
if [ "$refused" -lt 3 ]; then
    echo "only $refused of the damaged files were refused"
    exit 1
fi
