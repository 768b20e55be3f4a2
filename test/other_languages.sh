#!/usr/bin/env bash
# The library for other languages, from outside the package: the C interface with all its misuse, the Python module as pip installs
# it, the slider-crank in both; Fortran against the library that is installed.
# usage: test/other_languages.sh. Last lines: N passed, N failed. scripts/setup test must have run.
set -u
here=$(dirname "${BASH_SOURCE[0]}")
. "$here/../scripts/setup"
set +e
lib="$top/build/lib"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
check() { local law=$1; shift; if "$@" >"$work/log" 2>&1; then passed=$((passed + 1)); else
    failed=$((failed + 1)); printf 'FAILED: other languages: %s\n' "$law"; tail -5 "$work/log"; fi; }
# the first three positions of the slider-crank of doc/guide/library.md
slides() { "$@" >"$work/slides" && head -3 "$work/slides" | tr -s ' ' | grep -c -E '^ (0.0 179.6424|15.0 178.6366|30.0 174.2834)$' | grep -qx 3; }

check 'it builds' "$top/scripts/build_library" "$lib"
cd "$work" || exit 1
fortran=(gfortran -std=f2018 -I "$lib/include")
libraries=(-L "$lib" -lpsalm "-Wl,-rpath,$lib")
check 'example analyse.f90 compiles' "${fortran[@]}" "$top/example/analyse.f90" -o analyse "${libraries[@]}"
check 'Fortran: the slider-crank' slides ./analyse
check 'statically linked' "${fortran[@]}" "$top/example/analyse.f90" -o static "$lib/libpsalm.a" -lnlopt -llapack -fopenmp
check 'statically linked: the slider-crank' slides ./static
c=(cc -std=c11 -Wall -Wextra -Wpedantic -Werror -I "$lib/include")
check 'slider_crank.c compiles' "${c[@]}" "$top/c/slider_crank.c" -o slider "${libraries[@]}"
check 'C: the slider-crank' slides ./slider
check 'the header is C++ too' sh -c 'command -v c++ || exit 0; echo "#include <psalm.h>" | c++ -Wall -Werror -fsyntax-only -x c++ -I "$1" -' - "$lib/include"
check 'the test in C compiles' "${c[@]}" "$top/c/test_psalm.c" -o capi "${libraries[@]}" -lm
./capi "$top/data" || failed=$((failed + 1))
check 'pip installs the module' "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
    --target "$work/site" "$top/python"
check 'pip: the library is beside the module' test -s site/psalm/libpsalm.so
export PYTHONPATH="$work/site"
check 'Python: the slider-crank' slides "$venv/bin/python" "$top/python/example/slider_crank.py"
"$venv/bin/python" "$top/python/test_psalm.py" "$top/data" || failed=$((failed + 1))
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
