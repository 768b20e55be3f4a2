#!/usr/bin/env bash
# The same digits on every processor: no fused products, no elementary functions of the C library; all data sets with the library's
# choice of kernels by processor, and without; and with programs of another build.
# usage: test/program/processor.sh PROGRAM_DIRECTORY [OTHER_PROGRAMS]. Last line: N passed, N failed; before it what was skipped.
#        OTHER_PROGRAMS: built for any x86-64, with other optimisation
set -u
bin=$(cd "$1" && pwd)
other=${2:+$(cd "$2" && pwd)}
top=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
ok() { passed=$((passed + 1)); }
bad() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$1"; }
# names of glibc since 2.26 and before
plain=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX2_Usable,-FMA_Usable,-FMA4_Usable
cd "$work" || exit 1

# a product fused into a sum rounds once, where there are such instructions (tools/gfortran)
for p in psalm kalm balm muscle ssics bridge calm; do
    fused=$("$top/test/tools/fused.py" "$bin/$p")
    if [ "${fused%% *}" = 0 ]; then ok; else bad "$p: fused products (${fused%% *}): the digits depend on the processor"; fi
done

# nothing of the library that picks its kernel by processor is called: no elementary function, no product of matrices. (balm draws
# vibrations by what ssics has, LAPACK among it: of these the last digit is not promised, nor of exact synthesis, which follows
# paths of complex numbers and takes the functions that a user names.)
functions='(sin|cos|sincos|tan|asin|acos|atan|atan2|exp|exp2|log|log2|pow|hypot|_ZGV[a-zA-Z0-9_]*|_gfortran_matmul[a-z0-9_]*)(f|l)?'
callers=$(nm -A "$bin/../lib/libpsalm.a" 2>/dev/null | grep -E " U $functions\$" | sed -E 's/^[^:]*:([^:]*):.*/\1/' | sort -u)
[ -n "$callers" ] || bad 'no module of the library calls an elementary function: they have other names here'
for p in psalm kalm; do
    symbols=$(nm "$bin/$p")
    found=''
    for object in $callers; do
        module=$(sed -E 's/.*(psalm_[a-z0-9_]+)\.f90\.o$/\1/' <<<"$object")
        case $object in *src_exact_* | *psalm_exact_*) continue ;; esac
        grep -q "__${module}_MOD_" <<<"$symbols" && found+=" $module"
    done
    if [ -n "$found" ]; then bad "$p: elementary functions of the library are called by$found"; else ok; fi
done

# the switch must show at all: some sine of the library has another last digit without it
cat >probe.f90 <<'PROBE'
program probe
   use, intrinsic :: iso_fortran_env, only: real64, int64
   implicit none (type, external)
   real(real64), volatile :: angle
   integer(int64) :: digest
   integer :: i
   digest = 0_int64
   do i = 1, 200000
      angle = real(i, real64)*1.0e-4_real64
      digest = ieor(ishftc(digest, 1), transfer(sin(angle), digest))
   end do
   print '(z16.16)', digest
end program probe
PROBE
gfortran -O1 probe.f90 -o probe || exit 1
switch=yes
if [ "$(./probe)" = "$(GLIBC_TUNABLES=$plain ./probe)" ]; then
    echo 'SKIPPED: here GLIBC_TUNABLES changes no digit of the C library; the digits of two processors are not compared'
    switch=''
fi
[ -n "$other" ] || echo 'SKIPPED: no other build to compare the digits with'

differing() { # differing ONE OTHER: the files that are not the same in both directories
    local f
    ! diff -rq "$1" "$2" >/dev/null || return 0
    for f in "$1"/* "$2"/*; do
        cmp -s "$1/${f##*/}" "$2/${f##*/}" || echo "${f##*/}"
    done | sort -u | xargs
}

# Each program runs once as it is, once with the switch, once in the other build: all files and what it lists. The switch is for
# psalm and kalm; what psalm says on standard error counts there, too. Muscle has no part in it: it takes LAPACK where that multiplies
# by infinity and drops the result, so that a build with traps ends there. hard/extreme_lengths overflows on purpose: no other build
mkdir here without there
compare() { # compare FILE PROGRAM SWITCH BUILD OPTION ...
    local f=$1 p=$2 with=$3 build=$4 name differ said said_without
    shift 4
    name=${f##*/}
    name=${name%.nml}
    rm -f here/* without/* there/*
    "$bin/$p" "$@" --output-dir here "$f" >"here/$name.lst" 2>err
    echo "status $?" >>"here/$name.lst"
    if [ -n "$with" ]; then
        GLIBC_TUNABLES=$plain "$bin/$p" "$@" --output-dir without "$f" >"without/$name.lst" 2>err2
        echo "status $?" >>"without/$name.lst"
        differ=$(differing here without)
        said=$(<err) said_without=$(<err2)
        [ "$p" != psalm ] || [ "${said//here\//}" = "${said_without//without\//}" ] || differ+=" messages"
        [ "$p" != psalm ] || [ -s "here/$name.dev9" ] || differ+=" no device 9"
        if [ -z "$differ" ]; then ok; else bad "$p $name: other digits on another processor: $differ"; fi
    fi
    if [ -n "$build" ]; then
        "$other/$p" "$@" --output-dir there "$f" >"there/$name.lst" 2>/dev/null
        echo "status $?" >>"there/$name.lst"
        differ=$(differing here there)
        if [ -z "$differ" ]; then ok; else bad "$p $name: other digits in another build: $differ"; fi
    fi
}

part_of() { # part_of FILE K/N: some paths of an exact synthesis in the other build
    local name=${1##*/}
    compare "$1" psalm '' yes --part "$2"
    [ "$(wc -c <"here/${name%.nml}.part${2%/*}")" -gt 1000 ] || bad "${name%.nml}: no paths in part $2"
}

# a lever of beam elements: its equations at a quarter of the positions of a turn
sed 's/XZETA=0.02/XZETA=0.02, NXPNT=64/' "$top/data/ssics/slotted_lever.nml" >slotted_lever.nml
grep -q 'NXPNT=64' slotted_lever.nml || bad 'slotted_lever: the number of positions is not changed'
mapfile -t files < <(grep -L 'MAXTIME' "$top"/data/*.nml "$top"/data/{hard,exact,calm,bridge,ssics}/*.nml)
for f in "${files[@]}"; do
    case $f in
    */dwell.nml | */line6.nml | */needle_wide.nml | */door_five_poses.nml) ;; # searches of seconds; those left go the same ways
    */stephenson_seven.nml | */six_bar_minimax.nml) ;; # half a minute in a checked build
    # so is this one, but a fortieth of its paths is not: points, tangents and curvatures without pivots
    */three_bends.nml) [ -z "$other" ] || part_of "$f" 2/40 ;;
    # a quarter of their paths; others go on to the end: certificates, cognates, defects
    */exact/nine_points.nml | */exact/eight_points_slider.nml) [ -z "$other" ] || part_of "$f" 2/4 ;;
    */ssics/slotted_lever.nml) [ -z "$other" ] || compare slotted_lever.nml ssics '' yes ;;
    */data/calm/*) [ -z "$other" ] || compare "$f" calm '' yes ;;
    */data/bridge/*) [ -z "$other" ] || compare "$f" bridge '' yes ;;
    */data/exact/*) [ -z "$other" ] || compare "$f" psalm '' yes ;;
    */data/ssics/*) [ -z "$other" ] || compare "$f" ssics '' yes ;;
    */extreme_lengths.nml | */dwell*)
        [ -z "$switch" ] || for p in psalm kalm; do compare "$f" $p yes ''; done ;;
    */rig_coupler.nml | */drive_haines.nml | */striking.nml)
        [ -z "$switch" ] || for p in psalm kalm; do compare "$f" $p yes ''; done
        [ -z "$other" ] || compare "$f" ssics '' yes ;;
    *) for p in psalm kalm; do compare "$f" $p "$switch" "$other"; done ;;
    esac
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
