#!/usr/bin/env bash
# Error against condition number, measured with the build in quadruple precision: all hard cases and every dyad.
# Then every derivative that kalm prints, to 1e-9 of its largest value.
# usage: test/tools/hard_cases.sh PROGRAM_DIRECTORY QUAD_DIRECTORY [--table FILE]. Last lines: N passed, N failed.
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
bin=$1 quad=$2
shift 2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$top"/data/hard/*.nml "$work"
for f in "$top"/data/dyad*.nml "$top"/data/actuator*.nml "$top"/data/textile.nml; do
    sed 's/&LIMITS/\&LIMITS ICOND=1,/' "$f" >"$work/$(basename "$f")"
    if cmp -s "$f" "$work/$(basename "$f")"; then echo "FAILED: $f has no &LIMITS to be changed"; exit 1; fi
done
# 2**-52, the epsilon of real64
python3 "$top/test/tools/accuracy.py" "$@" 2.220446049250313e-16 "$bin/psalm" "$quad/psalm" "$work"/*.nml
python3 "$top/test/tools/compare_columns.py" 1e-9 "$bin/kalm" "$quad/kalm" .kalm "$work"/dyad*.nml "$work"/textile.nml "$top/data/needle.nml" \
    "$top/data/brake_reaction.nml" "$top/data/chain_short.nml" "$work"/actuator_rapson_slide.nml "$work/chain64.nml"
# Forces beside dead points.
python3 "$top/test/tools/force_accuracy.py" 2.220446049250313e-16 "$bin/kalm" "$quad/kalm"
