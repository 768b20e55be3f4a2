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
    fused=$(objdump -d "$bin/$p" | grep -cE '\bvfn?m(add|sub)')
    if [ "$fused" -eq 0 ]; then ok; else bad "$p: $fused fused products: the digits depend on the processor"; fi
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
if [ "$(./probe)" = "$(GLIBC_TUNABLES=$plain ./probe)" ]; then
    echo 'SKIPPED: here GLIBC_TUNABLES changes no digit of the C library; the digits of two processors are not compared'
else
    mkdir with without
    for f in "$top"/data/*.nml "$top"/data/hard/*.nml; do
        name=$(basename "$f" .nml)
        grep -q 'MAXTIME' "$f" && continue
        # searches of seconds; those left go the same ways
        case $name in dwell | line6 | needle_wide | door_five_poses) continue ;; esac
        cp "$f" with/ && cp "$f" without/
        (cd with && "$bin/psalm" "$name.nml" >"$name.lst" 2>"$name.err"
         "$bin/kalm" --quiet "$name.nml" >"$name.kalm.lst" 2>/dev/null)
        (cd without && export GLIBC_TUNABLES=$plain && "$bin/psalm" "$name.nml" >"$name.lst" 2>"$name.err"
         "$bin/kalm" --quiet "$name.nml" >"$name.kalm.lst" 2>/dev/null)
        differ=$(for g in with/"$name".*; do cmp -s "$g" "without/${g#with/}" || echo "${g#with/}"; done)
        if [ -s "with/$name.dev9" ] && [ -z "$differ" ]; then ok; else bad "$name: other digits on another processor: $differ"; fi
    done
fi

# two builds: all files of all programs but muscle, which takes LAPACK where that multiplies by infinity and drops the result, so that a
# build with traps ends there; hard/extreme_lengths overflows on purpose
if [ -n "$other" ]; then
    mkdir here there
    for f in "$top"/data/*.nml "$top"/data/hard/*.nml "$top"/data/exact/*.nml "$top"/data/calm/*.nml "$top"/data/bridge/*.nml "$top"/data/ssics/*.nml; do
        name=$(basename "$f" .nml)
        grep -q 'MAXTIME' "$f" && continue
        case $f in
        */stephenson_seven.nml | */six_bar_minimax.nml) continue ;; # half a minute in a checked build
        *calm/*) programs='calm' ;;
        *bridge/*) programs='bridge' ;;
        *ssics/* | *rig_coupler* | *drive_haines* | *striking*) programs='ssics' ;;
        *exact/*) programs='psalm' ;;
        */dwell* | */line6* | */needle_wide* | */door_five_poses* | */extreme_lengths*) continue ;; # seconds, or traps
        *) programs='psalm kalm' ;;
        esac
        for p in $programs; do
            for d in here there; do
                b=$bin
                [ $d = here ] || b=$other
                "$b/$p" --quiet --output-dir $d "$f" >"$d/$name.$p.lst" 2>/dev/null
                echo "status $?" >>"$d/$name.$p.lst"
            done
            differ=$(for g in here/"$name".*; do cmp -s "$g" "there/${g#here/}" || echo "${g#here/}"; done)
            if [ -z "$differ" ]; then ok; else bad "$p $name: other digits in another build: $differ"; fi
            rm -f here/* there/*
        done
    done
else
    echo 'SKIPPED: no other build to compare the digits with'
fi
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
