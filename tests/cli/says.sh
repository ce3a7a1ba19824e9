# For the scripts beside it: a folder that is gone afterwards, and what programs say and return.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# says CODE WORDS PROGRAM ARGUMENTS...: exit code, and words in what it says (either stream, in `out`).
says() {
    local code=$1 words=$2 found=0
    shift 2
    "$@" >out 2>&1 </dev/null || found=$?
    if [ "$found" -ne "$code" ] || ! grep -qF -- "$words" out; then
        echo "$*: exit code $found, expected $code and '$words'; it said:"
        cat out
        exit 1
    fi
}
