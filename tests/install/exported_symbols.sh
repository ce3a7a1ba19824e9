#!/usr/bin/env bash
# exported_symbols.sh LIBRARY: shows nothing but names of namespace grapeshot, and uses wide registers only in functions
# that are chosen at run time (namespaces N_AVX2, N_AVX3...): a template shared with the program must run on any machine.
set -euo pipefail
library=$1

names=$(nm --dynamic --defined-only --demangle "$library" | cut -d' ' -f3-)
[ -n "$names" ] || { echo "no names at all" >&2; exit 1; }
prefix='(typeinfo for |typeinfo name for |vtable for |VTT for |construction vtable for |guard variable for |(non-)?virtual thunk to )?'
foreign=$(grep -vE "^${prefix}grapeshot::" <<<"$names" || true)
if [ -n "$foreign" ]; then
    printf 'names that are not ours:\n%s\n' "$foreign" >&2
    exit 1
fi
grep -q '^grapeshot::' <<<"$names"

[ "$(uname -m)" = x86_64 ] || exit 0
wide=$(objdump --disassemble --demangle --no-show-raw-insn "$library" |
    awk '/^[0-9a-f]+ <.*>:$/ { name = $0; sub(/^[0-9a-f]+ </, "", name); sub(/>:$/, "", name) }
         /%[yz]mm[0-9]/ { if (name !~ /N_AVX|N_SSE4|avx|Avx/ && !(name in seen)) { seen[name]; print name } }')
if [ -n "$wide" ]; then
    printf 'wide registers in functions that are not chosen at run time:\n%s\n' "$wide" >&2
    exit 1
fi
