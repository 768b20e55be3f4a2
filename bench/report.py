#!/usr/bin/env python3
"""Turns what bench/run measured into doc/measured/benchmark.md and doc/measured/accuracy.md. usage: report.py MEASURED_DIR DOC_DIR"""
import math
import os
import re
import subprocess
import sys

measured, doc = sys.argv[1], sys.argv[2]


def read(name):
    with open(os.path.join(measured, name), encoding="utf-8") as text:
        return text.read()


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as text:
        for line in text:
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return "unknown processor"


def slope(points):
    """Exponent of a power law through (x, y), least squares in logarithms."""
    xs, ys = zip(*((math.log(x), math.log(y)) for x, y in points))
    mx, my = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


raw = [line.split("|") for line in read("raw").splitlines()]
raw = [(r[0], r[1], r[2], int(r[3]), int(r[4]), float(r[5]), float(r[6])) for r in raw]
limit = {int(n): float(t) for n, t in
         re.findall(r"program ten-bar div +N=(\d+) +cache +([\d.]+)", read("limit.txt"))}
trig = {int(n): float(t) for n, t in re.findall(r"one_loop_trig N= *(\d+) +([\d.]+)", read("naive.txt"))}
with open(os.path.join(measured, "limit.ns"), "w", encoding="utf-8") as out:
    out.write(str(limit[180]))
time = {(r[0], r[1], r[2], r[4]): r[5] for r in raw}
needle = "ten-bar (needle)"
linkages = list(dict.fromkeys(r[2] for r in raw))
dyads = {r[2]: r[3] for r in raw}
positions = sorted({r[4] for r in raw})
methods = list(dict.fromkeys((r[0], r[1]) for r in raw))
methods.sort(key=lambda m: (m[1] != "positions", m[0] != "real64"))


def commit():
    done = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=os.path.dirname(os.path.abspath(__file__)))
    return done.stdout.strip() or "not known"


def label(method):
    return "psalm, " + method[0] if method[1] == "positions" else method[1]


lines = ["# Speed against error", "",
         "Written by `bench/run` on: " + machine() + ", one thread, commit " + commit() + ". Times are the best of several in one run; compare ratios only. The yardstick is `bench/yardstick/limit.c`, \"program ... div\": a dyad list as data in C intrinsics.", "",
         "![time against error](benchmark.svg)", "", "## In short", ""]
big = 10000
ratio = {n: time[("real64", "positions", needle, n)] / limit[m] for n, m in ((180, 180), (10000, 1000000), (1000000, 1000000))}
lines += ["| figure | measured |", "| --- | --- |",
          "| yardstick, ten-bar, ns per dyad and position | %.3f (180 positions), %.3f (1000000) |" % (limit[180], limit[1000000]),
          "| psalm / yardstick, ten-bar: all positions and the output point | %.2f (180), %.2f (10000), %.2f (1000000) |"
          % (ratio[180], ratio[10000], ratio[1000000]),
          "| textbook form with trigonometry (`naive.f90`, one_loop_trig) / psalm, ten-bar | %.0f |"
          % (trig[1000000] / time[("real64", "positions", needle, 1000000)]),
          "| direct formulas of 1977 / psalm, ten-bar, 10000 positions | %.0f |"
          % (time[("real64", "direct formulas of 1977", needle, big)] / time[("real64", "positions", needle, big)]),
          "| exponent of time with positions (ten-bar, 180 to 1000000; 1 is linear) | %.3f |"
          % slope([(n, n * time[("real64", "positions", needle, n)]) for n in positions if n >= 180]),
          "| exponent of time with dyads (1, 2, 4, 64; 10000 positions) | %.3f |"
          % slope([(dyads[k], dyads[k] * time[("real64", "positions", k, big)]) for k in linkages if "slides" not in k])]
for row in read("objective").split():
    n, us, ns = row.split("|")
    lines.append("| objective of the needle linkage, %s positions: angles, errors, limits, all dimensions changed | %.3f us; "
                 "%.2f ns per dyad and position |" % (n, float(us), float(ns)))
    if n == "20":
        lines.append("| the same / yardstick at 180 positions, per dyad and position | %.2f |" % (float(ns) / limit[180]))
for row in read("lanes").split():
    count, us = row.split("|")
    lines.append("| the same for the variables of the data set, %s a call | %s us |"
                 % ("one linkage" if count == "1" else "%s linkages side by side" % count, us))
chain, pair = (float(x) for x in read("pruning").split("|"))
for row in read("derivatives").splitlines():
    cells = row.split("|")
    if len(cells) == 3:
        lines.append("| positions, velocities and accelerations / positions alone, %s, 10000 positions | %.2f (%.2f ns per dyad "
                     "and position) |" % (cells[0], float(cells[1]), float(cells[2])))
    else:
        lines.append("| Jacobian of the needle linkage, 16 variables, 20 positions | %.2f us |" % float(cells[1]))
lines.append("| Monte-Carlo sample of the needle linkage, 20 positions, 19 dimensions: million linkages a second, one thread | %s |"
             % read("sample").strip())
lines += ["| 64 loops, output at the second / its two loops alone | %.2f |" % (chain / pair),
          "| instructions of one objective evaluation (x86-64-v3), 20 positions | %d |" % (int(read("instructions.20")) // 10),
          "| the same, 10240 positions, per dyad and position | %.1f |" % (int(read("instructions.10240")) / 10 / 4 / 10240), ""]
lines += ["## Forces, ns per dyad and position", "",
          "Positions, velocities and accelerations (motion), then forces of drive, frame and all joints, with masses and weight "
          "(`bench forces`, time of the processor).", "",
          "| linkage | dyads | positions | motion | forces | forces / motion |", "| --- | --- | --- | --- | --- | --- |"]
for row in read("forces").splitlines():
    title, count, n, motion, forces = row.split("|")
    lines.append("| %s | %s | %s | %.2f | %.2f | %.2f |" % (title, count, n, float(motion), float(forces),
                                                         float(forces) / float(motion)))
lines += ["", "## Larger groups, gears, cylinders", "",
          "Nanoseconds a position of sketches with all their joints, in blocks of 256, one thread (`bench groups`, time of the processor): "
          "groups of more than two links and cylinders by Newton's method from the previous position; wheels alone side by side, by "
          "products of unit vectors where the ratio is a whole number, otherwise by series from the middle of each 16 positions.", "",
          "| linkage | groups | positions | ns per position |", "| --- | --- | --- | --- |"]
lines += ["| %s |" % " | ".join(row.split("|")) for row in read("groups").splitlines()]
lines += ["", "## Time, ns per dyad and position", ""]
for k in linkages:
    lines += ["### %s (%d dyad%s)" % (k, dyads[k], "s" if dyads[k] > 1 else ""), "",
              "| method | " + " | ".join("N = %d" % n for n in positions) + " | largest relative error, N = 180 |",
              "| --- |" + " --- |" * (len(positions) + 1)]
    for m in methods:
        cells = [time.get((m[0], m[1], k, n)) for n in positions]
        if not any(cells):
            continue
        errors = [r[6] for r in raw if (r[0], r[1]) == m and r[2] == k and r[4] == 180]
        lines.append("| %s | %s | %s |" % (label(m), " | ".join("-" if c is None else "%.3g" % c for c in cells),
                                           "%.1e" % errors[0] if errors else "failed"))
    lines.append("")
lines += ["The rivals are timed up to 4 million dyads times positions. On the ten-bar with slides Newton's method and the",
          "integration pass a change point and follow the other assembly, or stop there; the closed forms keep the assembly that",
          "the data set names. The time of the integration does not grow with the number of positions as long as its own steps are shorter.", "",
          "## The thesis's tables (IBM 370, seconds for 180 positions)", "",
          "| method (table 5.2) | four-bar | six-bar |", "| --- | --- | --- |", "| direct | 0.053 | 0.121 |",
          "| Adams-Moulton | 0.474 | 0.981 |", "| Brown | 0.540 | 2.038 |", "| Newton-Raphson | 0.840 | 1.735 |", "",
          "| variables, Brown's method (table 5.1) | four-bar | six-bar |", "| --- | --- | --- |",
          "| link angles and lengths | 0.540 | 2.038 |", "| joint coordinates | 0.350 | 3.862 |", "",
          "Here, microseconds for 180 positions:", "", "| method | four-bar | six-bar |", "| --- | --- | --- |"]
for m in methods:
    if m[0] == "real64":
        cells = [time.get((m[0], m[1], k, 180)) for k in linkages[:2]]
        lines.append("| %s | %s |" % (label(m), " | ".join("-" if c is None else "%.3g" % (c * 180 * d / 1000)
                                                         for c, d in zip(cells, (dyads[linkages[0]], dyads[linkages[1]])))))
# the last section is that of bench/packages
with open(os.path.join(doc, "benchmark.md"), encoding="utf-8") as text:
    _, title, others = text.read().partition("\n## Other packages\n")
lines += [title + others.rstrip("\n")] if title else []
with open(os.path.join(doc, "benchmark.md"), "w", encoding="utf-8") as out:
    out.write("\n".join(lines) + "\n")
with open(os.path.join(measured, "plot.dat"), "w", encoding="utf-8") as out:
    for group in ("positions", "direct", "Newton", "Adams"):
        for r in raw:
            if r[2] == needle and r[4] == 180 and r[1].startswith(group):
                out.write('"%s" %g %g\n' % (r[0] + " " + r[1], r[5], max(r[6], 1e-34)))
        out.write("\n\n")
with open(os.path.join(doc, "accuracy.md"), "w", encoding="utf-8") as out:
    out.write("""# Accuracy

Measured error of the real64 program against the same sources in quadruple precision, with the condition number that the
program prints (`bench/run`, or `test/tools/hard_cases.sh build/local/bin build/real128/bin --table FILE`). The program promises an error of at most 16 epsilon times the condition number, epsilon = 2.2e-16, so the last column must not exceed 16.

""" + read("accuracy"))
