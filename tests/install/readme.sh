#!/usr/bin/env bash
# readme.sh ROOT BIN: what the README shows is what is in the tree, and what it tells to type works.
#   <!-- file: PATH -->  the fenced block below is that file, byte by byte
#   <!-- run -->         each line of the block below is run in ROOT, build/release/bin being BIN
# And all links into the tree lead somewhere.
set -euo pipefail
root=$(cd "$1" && pwd -P)
bin=$(cd "$2" && pwd -P)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root"

# Blocks into files NUMBER.block, what is asked of them into NUMBER.what.
awk -v out="$work" '
    /^<!-- (file: .*|run) -->$/ { what = $0; sub(/^<!-- /, "", what); sub(/ -->$/, "", what); next }
    /^```/ { if (open) { open = 0; what = "" } else { open = 1; n++; if (what != "") { print what > (out "/" n ".what"); printf "" > (out "/" n ".block") } } next }
    open && what != "" { print > (out "/" n ".block") }
    !open && NF { what = "" }' README.md

files=0 runs=0
for what in "$work"/*.what; do
    block=${what%.what}.block
    case $(cat "$what") in
        file:*)
            file=$(sed 's/^file: //' "$what")
            diff -u "$file" "$block" || { echo "README.md shows another $file" >&2; exit 1; }
            files=$((files + 1))
            ;;
        run)
            while IFS= read -r line; do
                case $line in '' | \#*) continue ;; esac
                echo "\$ $line"
                bash -euo pipefail -c "${line//build\/release\/bin/"$bin"}" </dev/null
                runs=$((runs + 1))
            done <"$block"
            ;;
    esac
done
if [ "$files" -lt 2 ] || [ "$runs" -lt 1 ]; then
    echo "README.md: only $files files and $runs commands found" >&2
    exit 1
fi

links=0
while IFS= read -r document; do
    while IFS= read -r link; do
        case $link in http*: | http*://* | \#* | mailto:*) continue ;; esac
        [ -e "$(dirname "$document")/${link%%#*}" ] || { echo "$document: no such file: $link" >&2; exit 1; }
        links=$((links + 1))
    done < <(grep -oE '\]\([^) ]+\)' "$document" | sed 's/^](//; s/)$//')
done < <(find . -name '*.md' -not -path './build/*' -not -path './.git/*')
echo "$files files, $runs commands, $links links"
