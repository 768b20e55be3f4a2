#!/usr/bin/env bash
# The library for other languages, from outside the package: the C interface with all its misuse, the Python module as pip installs
# it, the slider-crank in both; Fortran against the library that is installed.
# usage: test/program/other_languages.sh. Last lines: N passed, N failed. scripts/setup test must have run.
set -u
here=$(dirname "${BASH_SOURCE[0]}")
. "$here/../../scripts/setup"
set +e
lib="$top/build/lib"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
check() { local law=$1; shift; if "$@" >"$work/log" 2>&1; then passed=$((passed + 1)); else
    failed=$((failed + 1)); printf 'FAILED: other languages: %s\n' "$law"; tail -5 "$work/log"; fi; }
# the first three positions of the slider-crank of doc/guide/library.md
slides() { "$@" >"$work/slides" && head -3 "$work/slides" | tr -s ' ' | grep -c -E '^ (0.0 179.6424|15.0 178.6366|30.0 174.2834)$' | grep -qx 3; }

# the tests of the workbench wait for it, or build it
check 'it builds' flock "$top/build/lib.lock" "$top/scripts/build_library" "$lib"
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
check 'the program of all studies compiles' "${c[@]}" "$top/c/every_study.c" -o every "${libraries[@]}"
check 'C: every study by its name' sh -c './every | grep -qx clearance && ./every rates "$1/engine.nml" | grep -q "^table positions, rows 36: input closed output"' - "$top/data"
check 'the header compiles in a C++ program' sh -c 'command -v c++ || exit 0; echo "#include <psalm.h>
    int main() { psalm_case *c = nullptr; return psalm_new(\"T\", &c) + psalm_interface() - PSALM_INTERFACE; }" >p.cpp &&
    c++ -Wall -Wextra -Werror -I "$1/include" p.cpp -o p -L "$1" -lpsalm "-Wl,-rpath,$1" && ./p' - "$lib"
check 'the library has a soname' sh -c 'objdump -p "$1/libpsalm.so" | grep -q "SONAME *libpsalm.so.1"' - "$lib"
check 'the test in C compiles' "${c[@]}" "$top/c/test_psalm.c" -o capi "${libraries[@]}" -lm
./capi "$top/data" || failed=$((failed + 1))
check 'pip installs the module' "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
    --target "$work/site" "$top/python"
check 'pip: the workbench has its command' test -x site/bin/psalm-workbench
check 'pip: the library is beside the module' test -s site/psalm/libpsalm.so
export PYTHONPATH="$work/site"
check 'Python: the slider-crank' slides "$venv/bin/python" "$top/python/example/slider_crank.py"
"$venv/bin/python" "$top/python/test_psalm.py" "$top/data" || failed=$((failed + 1))
"$venv/bin/python" "$top/test/program/notebook.py" || failed=$((failed + 1))
# one example a verb in C and in Python, which show the same; those in Fortran are run by library.sh
tried=""
mkdir few
cp "$top/data/types/corner.txt" few
sed 's/NSTART=100/NSTART=4/' "$top/data/types/kinds_for_corner.nml" >few/kinds_for_corner.nml
check 'fewer starts for kinds' grep -q 'NSTART=4 ' few/kinds_for_corner.nml
while read -r verb file; do
    tried+="$verb "
    case $verb in kinds) ;; *) file="$top/data/$file" ;; esac
    ./every "$verb" "$file" >every_c 2>/dev/null
    check "C: $verb" test $? -le 1 -a -s every_c
    "$venv/bin/python" "$top/python/example/every_study.py" "$verb" "$file" >every_python 2>/dev/null
    check "Python: $verb, as in C" cmp every_c every_python
done <<'END'
analysis textile.nml
summary textile.nml
tolerances adjustable_stroke.nml
allocation cheapest_tolerances.nml
sweep adjustable_stroke.nml
synthesis path5.nml
exact exact/five_poses.nml
kinds few/kinds_for_corner.nml
proof geared_five_bar.nml
assemblies sketch_four_bar.nml
rates engine.nml
forces engine.nml
machine engine.nml
time time/toggle.nml
balance muscle/haines_bodies.nml
springs muscle/haines_spring.nml
vibration rig_coupler.nml
cams calm/flat_swinging.nml
clearance bridge/four_bar_haines.nml
picture jansen.nml
board jansen.nml
END
check 'every verb has an example' test "$tried" = "$("$venv/bin/python" "$top/python/example/every_study.py" | tr '\n' ' ')"
# every verb, the slow ones on small cases; test/campaign/verbs.py has the figures of 100000 calls
"$venv/bin/python" "$top/test/campaign/verbs.py" --count 12 --short || failed=$((failed + 1))
"$venv/bin/python" "$top/python/example/many_cases.py" >futures
check 'Python: cases on all processors, strokes in closed form' awk '{ d = 10; s = sqrt(($2 + $1)^2 - d*d) - sqrt(($2 - $1)^2 - d*d)
    e = $3 - s; n += NF == 3 && e*e < 2e-4 } END { exit n != 9 }' futures
check 'Python: the same by joblib' sh -c '"$1" "$2/python/example/many_cases.py" joblib | cmp - futures' - "$venv/bin/python" "$top"
check 'the version is one in all descriptions' test 1 -eq "$(grep -hoE '^version = "[0-9.]+"|version = .[0-9.]+. !! as|^version: [0-9.]+|^  version: "[0-9.]+"|^psalm \([0-9.]+-' \
    "$top"/fpm.toml "$top/python/pyproject.toml" "$top/src/base/psalm_version.f90" "$top/CITATION.cff" "$top/conda/meta.yaml" "$top/debian/changelog" |
    grep -oE '[0-9]+\.[0-9.]+[0-9]' | sort -u | wc -l)"
# what each program can do is a verb of the library; its groups ask for one
check 'every group that a program reads for a study is one of a verb' "$venv/bin/python" -c "
import re, subprocess, psalm
text = open('$top/src/facade/psalm_verbs.f90').read()
verbs = re.findall(r\"verb_t\('(\w+)', '(\w+)', '([^']*)', '\w*'\)\", text)
assert [v[0] for v in verbs] == list(psalm.verbs), 'the list of the library'
assert {v[1] for v in verbs} == {'psalm', 'kalm', 'balm', 'muscle', 'ssics', 'calm', 'bridge'}, 'every program'
asked = {g for v in verbs for g in v[2].split()}
from psalm import report
groups = {v[0]: v[2] for v in verbs}
assert all(asks in ('', groups[verb]) for verb, _, asks in report.STUDIES), 'studies of a report'
case = {'LINKS', 'CHAIN', 'DRIVES', 'OUTPUTS', 'METHOD', 'CURVE', 'LIMITS', 'CONSTR', 'CYCLE'}
for program in sorted({v[1] for v in verbs}):
    groups = re.findall(r'^ &(\w+)', subprocess.run(['$prefix/bin/' + program, '--items'], capture_output=True, text=True).stdout, re.M)
    assert groups and set(groups) <= asked | case, (program, set(groups) - asked - case)"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
