#!/usr/bin/env bash
# Reading a case needs neither NLopt nor LAPACK: the reader links without them. A search does not, which shows that this can fail.
# usage: test/program/reader_alone.sh [LIBRARY]   default: the newest libpsalm.a below build/
set -eu
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
library=${1:-$(ls -t "$top"/build/gfortran_*/psalm/libpsalm.a | head -1)}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
p=0
f=0
links() { # of a module's procedure
    echo "void $1(void); int main(void) { void (*volatile used)(void) = $1; return used == 0; }" >"$work/main.c"
    gcc -w -c "$work/main.c" -o "$work/main.o"
    gfortran "$work/main.o" "$library" -fopenmp -o "$work/main" 2>"$work/errors"
}
if links __psalm_data_set_MOD_read_data_sets; then p=$((p + 1)); else
    echo "FAILED: the reader alone links"
    sed -n '1,5p' "$work/errors"
    f=$((f + 1))
fi
if ! links __psalm_search_MOD_search_many && grep -q nlopt "$work/errors"; then p=$((p + 1)); else
    echo "FAILED: a search does not link without NLopt"
    f=$((f + 1))
fi
echo "$p passed, $f failed"
[ "$f" -eq 0 ]
