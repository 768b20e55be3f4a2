#!/usr/bin/env bash
# The library from outside: the programs of example/, and the program of doc/guide/library.md in a package of its own that depends on this
# checkout. What they print is compared with what the programs of the suite list.
#
# usage: test/program/library.sh PROGRAM_DIRECTORY [EXAMPLE_DIRECTORY]    the last line is N passed, N failed
# With a directory of built examples these are run; nothing is built, the package of its own is left out.
set -u
bin=$(cd "$1" && pwd)
built=${2:+$(cd "${2:-.}" && pwd)}
. "$(dirname "${BASH_SOURCE[0]}")/../../scripts/setup"
set +e
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0

check() { # check LAW COMMAND ...
    local law=$1
    shift
    if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $law"; fi
}

# Columns of numbers of two tables agree to 1e-6 of their size (of zero: to 1e-6), and there are as many rows as there should be.
same_columns() { # same_columns ROWS ONE OTHER
    awk -v rows="$1" 'FNR == NR { n = NR; line[NR] = $0; next }
        { k = split($0, a); m = split(line[FNR], b); if (k != m || k == 0) bad = 1
          for (i = 1; i <= k; i++) { d = a[i] - b[i]; s = a[i] < 0 ? -a[i] : a[i]; if (s == 0) s = 1; if (d < 0) d = -d
              if (a[i] !~ /^[-+0-9.Ee]+$/ || d > 1e-6*s) bad = 1 } }
        END { exit bad || n != rows || FNR != rows }' "$2" "$3"
}

rows_of() { awk 'NF > 1 && !/[A-DF-Za-z]/'; }  # rows of numbers

run_example() { # run_example NAME: its output in $work/NAME
    (cd "$top" && "$examples/$1") >"$work/$1"
}

examples=$built
if [ -z "$built" ]; then
    # fpm builds all of them, and tells where one is
    examples=$(cd "$top" && "$fpm" run --example analyse --runner echo --flag "$release_flags" 2>"$work/examples.log" | tail -1)
    examples=$(dirname "$examples")
    check "the examples build" test -x "$top/$examples/analyse"
fi

cp "$top/data/dyad4_slider_crank.nml" "$top/data/path5.nml" "$work"
(cd "$work" && "$bin/psalm" --quiet dyad4_slider_crank.nml && "$bin/psalm" --quiet path5.nml >path5.lst) >"$work/listing"
awk '/CRANK ANGLE +ACTUAL/ { on = 1; next } on && NF == 2' "$work/listing" >"$work/motion"

check "example analyse runs" run_example analyse
check "example analyse: the slide that psalm lists" same_columns 24 <(rows_of <"$work/analyse") "$work/motion"

check "example synthesise runs" run_example synthesise
check "example synthesise: the objective that psalm finds" same_columns 1 \
    <(awk '$1 == "objective" { print $2 }' "$work/synthesise") <(awk '/TOTAL ERROR/ { getline; sub("D", "E"); print $1 }' "$work/path5.lst")

check "example rates runs" run_example rates
awk '/^OFFSET/ { print; next } /MOTION=3/ { sub("IKIN=15", "IKIN=45"); n++ } { if (!/^!/) print }
    END { print " &RATES SPEED=3000.0, UNITS=\047REV/MIN\047 &END"; exit n != 1 }' "$work/dyad4_slider_crank.nml" >"$work/rates.nml"
check "the rates of the same case by kalm" "$bin/kalm" --quiet "$work/rates.nml" >"$work/rates.lst"
awk '/CRANK ANGLE +OUTPUT/ { on = 1; next } on && NF == 7 { print $1, $2, $3, $4 }' "$work/rates.lst" >"$work/rates.kalm"
check "example rates: velocities and accelerations that kalm lists" same_columns 8 <(rows_of <"$work/rates") "$work/rates.kalm"

check "example forces runs" run_example forces
{ cat "$work/rates.nml"
    echo ' &MASSES NMASS=2, MLINK=-2,-3, MLOOP=1,1, MASS=0.5,0.8, MDIST=45.0,0.0, MINERT=0.0015,0.0, UNITL=0.001 &END'; } >"$work/forces.nml"
check "the forces of the same case by kalm" "$bin/kalm" --quiet "$work/forces.nml" >"$work/forces.lst"
awk '/DRIVE TORQUE +FRAME/ { on = 1; next } on && NF < 7 { on = 0 } on { gsub("D", "E"); print $1, $2 }' "$work/forces.lst" >"$work/forces.kalm"
check "example forces: the torque that kalm lists" same_columns 8 <(awk 'NF == 3 && !/[a-df-z]/ { print $1, $2 }' "$work/forces") \
    "$work/forces.kalm"

check "example own_objective runs" run_example own_objective
# stroke and time ratio of a slider-crank in closed form: its crank and rod in one line
check "example own_objective: stroke and ratio wanted, by the closed form too" awk '
    function acos(c) { return atan2(sqrt(1 - c*c), c) }
    { v[$1] = $2 }
    END { r = v["crank"]; e = v["offset"]; l = 140; pi = atan2(0, -1)
          s = sqrt((l + r)^2 - e^2) - sqrt((l - r)^2 - e^2)
          a = acos(e/(l + r)) - acos(e/(l - r)); if (a < 0) a = -a
          q = (pi + a)/(pi - a)
          exit !((s - 80)^2 < 1e-6 && (q - 1.2)^2 < 1e-8 && (s - v["stroke"])^2 < 1e-6 && (q - v["ratio"])^2 < 1e-8) }' \
    "$work/own_objective"

# the other verbs: what they list is what the programs list
says() { # says EXAMPLE PROGRAM FILE WORDS: both outputs have a line with the words, the same line, and not only once in nothing
    local one other
    one=$(grep -m1 -F -- "$4" "$work/$1") || return 1
    local options=(--quiet --output-dir "$work")
    [ "$1" != assemblies ] || options+=(--assemblies)
    other=$("$bin/$2" "${options[@]}" "$top/data/$3" 2>/dev/null | grep -m1 -F -- "$4") || return 1
    [ "$one" = "$other" ]
}
while read -r example program file words; do
    check "example $example runs" run_example "$example"
    check "example $example: '$words' as $program lists it" says "$example" "$program" "$file" "$words"
done <<'END'
machine kalm engine.nml STEADY CYCLE
time kalm time/toggle.nml EVENTS
tolerances psalm adjustable_stroke.nml WORST CASE
allocation psalm cheapest_tolerances.nml LOWER BOUND
sweep psalm adjustable_stroke.nml FAMILY OF CURVES
exact psalm exact/five_poses.nml certified: 
kinds psalm types/kinds_for_corner.nml four-bar with a slide, 1
proof psalm geared_five_bar.nml PROVEN
assemblies psalm triad_six_assemblies.nml ASSEMBLIES AT
balance muscle muscle/haines_bodies.nml BALANCE
springs muscle muscle/haines_spring.nml SPRING
vibration ssics rig_coupler.nml EULER
cams calm calm/conjugate_cams.nml CAM
clearance bridge bridge/four_bar_haines.nml JOINT M1 WITH CLEARANCE:
END
check "example sketch runs" run_example sketch
check "example sketch: the path of P in CASE.csv of the same sketch" same_columns 24 <(rows_of <"$work/sketch" | awk '{ print $2, $3 }') \
    <("$bin/psalm" --quiet --output-dir "$work" "$top/data/sketch_four_bar.nml" >/dev/null
      awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { if ($i == "P.x") x = i; if ($i == "P.y") y = i }; next } { print $x, $y }' \
          "$work/sketch_four_bar.csv")
check "example summary runs" run_example summary
check "example summary: that of psalm" grep -qF "$("$bin/psalm" --output-dir "$work" "$top/data/dyad4_slider_crank.nml" 2>&1 >/dev/null |
    grep -m1 -E '^  Closes')" "$work/summary"
check "example picture runs" run_example picture
check "example picture: SVG, DXF, page, board" test "$(awk '$1 ~ /^\./ && $2 > 1000' "$work/picture" | wc -l)" -ge 4
check "example next_study runs" run_example next_study
check "example next_study: a torque" awk '/largest torque/ && $3 > 0 { found = 1 } END { exit !found }' "$work/next_study"

if [ -n "$built" ]; then
    echo "$passed passed, $failed failed"
    [ $failed -eq 0 ]
    exit
fi

# the first program of doc/guide/library.md: a package outside, with the checkout as its only dependency
mkdir -p "$work/outside/app"
awk '/^```fortran/ { on = !done; next } /^```/ { if (on) done = 1; on = 0 } on' "$top/doc/guide/library.md" >"$work/outside/app/main.f90"
printf 'name = "outside"\n[dependencies]\nopenmp = "*"\npsalm.path = "%s"\n' "$(realpath --relative-to="$work/outside" "$top")" >"$work/outside/fpm.toml"
check "doc/guide/library.md: a program of a dozen lines" test "$(wc -l <"$work/outside/app/main.f90")" -le 13
# what is compiled already is not compiled again
mkdir "$work/objects"
(cd "$work/objects" && ar x "$bin/../lib/libpsalm.a")
(cd "$work/outside" &&
    INSTALLED=$(dirname "$bin") OBJECTS="$work/objects" FPM_FC="$top/test/tools/installed/gfortran" "$fpm" run --profile debug --flag "-std=f2018 -O0" 2>"$work/outside.log") >"$work/outside.out"
check "doc/guide/library.md: a package outside builds and runs" test $? -eq 0
check "doc/guide/library.md: the slide that psalm lists" same_columns 24 <(grep -vE '^\[|^Project|^ \+' "$work/outside.out") "$work/motion"
[ $failed -eq 0 ] || cat "$work"/*.log | grep -iE 'error' | head -20

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
