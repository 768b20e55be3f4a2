#!/usr/bin/env bash
# The same digits on every processor: all data sets with the C library's choice of kernels by processor, and without.
# usage: test/processor.sh PROGRAM_DIRECTORY. Last line: N passed, N failed; before it what was skipped.
set -u
bin=$(cd "$1" && pwd)
top=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
ok() { passed=$((passed + 1)); }
bad() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$1"; }
# names of glibc since 2.26 and before
plain=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F,-AVX2_Usable,-FMA_Usable,-FMA4_Usable
cd "$work" || exit 1

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
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
