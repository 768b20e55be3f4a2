#!/usr/bin/env python3
"""Every column of a device 9 file of one build against that of a build in quadruple precision.

usage: compare_columns.py RELATIVE PROGRAM QUAD_PROGRAM SUFFIX CASE.nml ...
A column's differences must stay below RELATIVE times its largest value, at positions where both have numbers.
Last line: N passed, N failed.
"""
import os
import subprocess
import sys
import tempfile
from decimal import Decimal, getcontext

getcontext().prec = 40


def columns(program, case, suffix, folder):
    os.makedirs(folder, exist_ok=True)
    subprocess.run([program, "--quiet", "--output-dir", folder, case], stdout=subprocess.DEVNULL, check=False)
    names, table = [], []
    with open(os.path.join(folder, os.path.splitext(os.path.basename(case))[0] + suffix + ".dev9"), encoding="utf-8") as text:
        for line in text:
            if line.startswith("# input"):
                names = line.split()[1:]
            elif line.strip() and not line.startswith("#"):
                table.append([Decimal(w) for w in line.split()])
    return names, table


def main(relative, program, quad, suffix, *cases):
    passed = failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for case in cases:
            names, ours = columns(program, case, suffix, os.path.join(folder, "ours"))
            _, exact = columns(quad, case, suffix, os.path.join(folder, "quad"))
            for k in range(2, len(names)):
                pairs = [(a[k], b[k]) for a, b in zip(ours, exact) if a[k].is_finite() and b[k].is_finite()]
                largest = max([abs(b) for _, b in pairs] + [Decimal("1e-30")])
                worst = max([abs(a - b) for a, b in pairs] + [Decimal(0)]) / largest
                if len(ours) == len(exact) > 0 and pairs and worst <= Decimal(relative):
                    passed += 1
                else:
                    failed += 1
                    print("FAILED: %s, column %s: %.1e" % (os.path.basename(case), names[k], worst))
    print("%d passed, %d failed" % (passed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
