#!/usr/bin/env python3
"""Measured error against condition number: device 9 of one build against that of a build in quadruple precision.

usage: accuracy.py [--table FILE] EPSILON PROGRAM QUAD_PROGRAM CASE.nml ...

EPSILON is that of PROGRAM's real kind. The cases ask for the condition column (ICOND=1). For every position the error of
the output (of a point: length of the error vector over distance from the origin; of an angle: radians; else relative)
must stay within 16 EPSILON times the condition number that PROGRAM printed. Last line: N passed, N failed.
"""
import math
import os
import subprocess
import sys
import tempfile
from decimal import Decimal, getcontext

getcontext().prec = 50
PI = Decimal("3.14159265358979323846264338327950288419716939937510")


def rows(path):
    """Blocks of device 9: (title, column names, list of rows)."""
    blocks, names = [], None
    with open(path, encoding="utf-8") as text:
        for line in text:
            words = line.split()
            if line.startswith("# run "):
                continue
            if line.startswith("# input"):
                names = words[1:]
                blocks.append(["", names, [], ""])
            elif line.startswith("#") and blocks and not blocks[-1][0]:
                blocks[-1][0] = line[1:].strip()
            elif line.startswith("#") and blocks:
                blocks[-1][3] = line
            elif words:
                blocks[-1][2].append(dict(zip(blocks[-1][1], words)))
    return blocks


def error(row, exact, angle):
    """Error of one position as the condition number understands it."""
    if "actual_x" in row:
        x, y = (Decimal(exact[k]) for k in ("actual_x", "actual_y"))
        dx, dy = (Decimal(row[k]) - Decimal(exact[k]) for k in ("actual_x", "actual_y"))
        return ((dx * dx + dy * dy) / (x * x + y * y)).sqrt()
    difference = Decimal(row["actual"]) - Decimal(exact["actual"])
    if angle:
        difference = (difference + 180) % 360 - 180 if abs(difference) > 180 else difference
        return abs(difference) * PI / 180
    return abs(difference / Decimal(exact["actual"])) if Decimal(exact["actual"]) else abs(difference)


def run(program, case, folder):
    os.makedirs(folder, exist_ok=True)
    subprocess.run([program, "--quiet", "--output-dir", folder, case], stdout=subprocess.DEVNULL, check=False)
    return rows(os.path.join(folder, os.path.splitext(os.path.basename(case))[0] + ".dev9"))


def main(arguments):
    table = None
    if arguments[0] == "--table":
        table, arguments = arguments[1], arguments[2:]
    epsilon, program, quad, cases = Decimal(arguments[0]), arguments[1], arguments[2], arguments[3:]
    passed = failed = 0
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        for case in cases:
            ours = run(program, case, os.path.join(folder, "ours"))
            exact = run(quad, case, os.path.join(folder, "quad"))
            for (title, names, got, units), (_, _, want, _) in zip(ours, exact):
                angle = "output in degrees" in units
                worst = (Decimal(-1), None, None)
                sound = "condition" in names and len(got) == len(want) > 0
                largest = Decimal(0)
                for a, b in zip(got, want):
                    if a["closed"] != b["closed"]:
                        sound = False
                        print("FAILED: %s: closed differs at input %s" % (title, a["input"]))
                        continue
                    if a["closed"] == "0":
                        continue
                    e = error(a, b, angle)
                    kappa = Decimal(a["condition"])
                    largest = max(largest, e)
                    if e / (epsilon * kappa) > worst[0]:
                        worst = (e / (epsilon * kappa), e, kappa)
                if sound and worst[0] <= 16:
                    passed += 1
                else:
                    failed += 1
                    print("FAILED: %s: error %.2e at condition %.2e" % (title, worst[1] or 0, worst[2] or 0))
                kappas = [Decimal(a["condition"]) for a in got if a["closed"] == "1"]
                lines.append("| %s | %s | %.1e | %.1e | %.2f |" % (os.path.basename(case)[:-4], title.lower(), max(kappas or [0]),
                                                             largest, worst[0]))
    if table:
        with open(table, "w", encoding="utf-8") as out:
            out.write("| data set | case | largest condition number | largest error | error / (epsilon x condition), worst |\n"
                      "| --- | --- | --- | --- | --- |\n" + "\n".join(lines) + "\n")
    print("%d passed, %d failed" % (passed, failed))
    return failed > 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
