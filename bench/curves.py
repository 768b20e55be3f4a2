#!/usr/bin/env python3
"""Thirty closed curves: what a search among kinds of linkages makes of each.

usage: curves.py PSALM DIRECTORY [--seconds S] [--seeds N] [--jobs N] [--only NAME] >TABLE

The curves are drawn here: letters as one closed line through a few points (a periodic cubic spline), and five others. Each becomes 40
points evenly by arc length, RMS radius 20. One search a curve and seed on one thread, LINKS=4,6,8 with pins, MAXTIME seconds of the clock.
"""
import argparse
import cmath
import concurrent.futures
import csv
import math
import os
import re
import statistics
import subprocess
import sys

RADIUS = 20.0      # RMS distance of the points wanted from their mean
POINTS = 40
COMPARED = 200     # points of both curves, evenly by arc length, RMS radius of the wanted one 1
DENSE = 400        # points of the file of a curve
LETTERS = {  # points of a closed line, round the letter's strokes in one go
    "A": "0,0 4,10 8,0 6,1 4,6 2,1", "B": "0,0 0,5 0,10 5,9 3,5 6,2", "C": "7,8 3,10 0,5 3,0 7,2 4,1.5 1.5,5 4,8.5",
    "D": "0,0 0,5 0,10 4,9 6,5 4,1", "E": "6,0 0,0 0,5 0,10 6,10 2,8 4,5 2,2", "F": "0,0 0,5 0,10 6,10 2,8 4,5.5 1.5,5",
    "G": "7,8 3,10 0,5 3,0 7,1 7,4 4,4 5.5,2.5 3,1.5 1.5,5 4,8.5", "H": "0,0 0,10 1.5,5.5 5,5.5 6.5,10 6.5,0 5,4.5 1.5,4.5",
    "I": "0,0 -0.6,5 0,10 0.6,5", "J": "5,10 5,3 2.5,0 0,3 1.5,2 3,1.5 4,4", "K": "0,0 0,10 1.5,6 6,10 3,5 6,0 1.5,4",
    "L": "0,10 0,0 6,0 3,1 1,2 0.7,6", "M": "0,0 1,10 4,4 7,10 8,0 6.5,6 4,2 1.5,6", "N": "0,0 0,10 5,3 6,10 6,0 1.5,6",
    "P": "0,0 0,5 0,10 5,9 5,6 1.5,5", "Q": "3,0 0,5 3,10 6,5 5,2 7,0 4.5,1", "R": "0,0 0,10 5,9 4,5.5 6,0 3,4 1.5,4",
    "S": "6,8 3,10 0,7.5 3,5 5,2.5 3,1 0,2 3,0 6.5,2.5 3.5,6 1.5,7.5 3,8.7", "T": "3,0 3.5,7 6,9 6,10 0,10 0,9 2.5,7",
    "U": "0,10 0,3 3,0 6,3 6,10 5,4 3,1.5 1,4", "V": "0,10 3,0 6,10 4.5,6 3,2.5 1.5,6", "W": "0,10 2,0 4,5 6,0 8,10 6,3 4,7 2,3",
    "X": "0,0 2.5,5 0,10 3,6 6,10 3.5,5 6,0 3,4", "Y": "3,0 2.5,4 0,10 3,6 6,10 3.5,4", "Z": "0,10 6,10 1.5,1.2 6,0 0,0 4.5,8.8"}


def spline(text):
    """Closed cubic through points, slopes from the neighbours (Catmull and Rom, 1974)."""
    p = [complex(*map(float, pair.split(","))) for pair in text.split()]
    line = []
    for k in range(len(p)):
        a, b, c, d = (p[(k + j) % len(p)] for j in (-1, 0, 1, 2))
        for t in (j/40 for j in range(40)):
            line.append(b + t*((c - a)/2 + t*(a - 2.5*b + 2*c - d/2 + t*((d - a)/2 + 1.5*(b - c)))))
    return line


def others():
    turn = [2*math.pi*k/DENSE for k in range(DENSE)]
    corners = [complex(math.copysign(abs(math.cos(t))**0.35, math.cos(t)), math.copysign(abs(math.sin(t))**0.35, math.sin(t))) for t in turn]
    line = [complex(x/50, 0) for x in range(-100, 101)] + [2*cmath.exp(1j*math.pi*k/100).real + 0.7j*math.sin(math.pi*k/100) for k in range(1, 100)]
    foot = [complex(-x/50, 0) for x in range(-100, 101)] + [complex(-2*math.cos(math.pi*k/100), 1.1*math.sin(math.pi*k/100)**1.5) for k in range(1, 100)]
    return {"foot's path": foot, "eight": [complex(math.sin(t), 0.8*math.sin(2*t)) for t in turn],
            "trefoil": [cmath.exp(1j*t)*(1 + 0.45*math.cos(3*t)) for t in turn], "rounded square": corners, "line, quick return": line}


def evenly(line, count):
    """Points of a closed line evenly by arc length."""
    ring = line + line[:1]
    at = [0.0]
    for p, q in zip(ring, ring[1:]):
        at.append(at[-1] + abs(q - p))
    points, k = [], 0
    for i in range(count):
        s = at[-1]*i/count
        while at[k + 1] < s:
            k += 1
        points.append(ring[k] + (ring[k + 1] - ring[k])*((s - at[k])/max(at[k + 1] - at[k], 1e-300)))
    return points


def scaled(points, radius):
    mean = sum(points)/len(points)
    rms = math.sqrt(sum(abs(p - mean)**2 for p in points)/len(points))
    return [(p - mean)*(radius/rms) for p in points], mean, rms


def distances(wanted, made):
    """As LInK has them (Nobari and others 2024). Chamfer: mean distance of a point to the nearest of the other curve, sum of both ways.
    Ordered: 2 pi times the mean squared distance of points in order, from the start, either way round, at which the sum of the
    distances is least."""
    nearest = [min(abs(p - q) for q in made) for p in wanted], [min(abs(p - q) for p in wanted) for q in made]
    ordered = math.inf
    for curve in (made, made[::-1]):
        apart = min(([abs(p - curve[k - first]) for k, p in enumerate(wanted)] for first in range(len(curve))), key=sum)
        ordered = min(ordered, 2.0*math.pi*sum(d*d for d in apart)/len(apart))
    return sum(sum(n)/len(n) for n in nearest), ordered


def search(psalm, folder, name, line, seed, seconds):
    """Search and trace the best linkage: error by links, proof, distances, time of the processor."""
    stem = os.path.join(folder, re.sub(r"\W", "_", name) + "_%d" % seed)
    points, _, _ = scaled(evenly(line, DENSE), RADIUS)
    with open(stem + "_target.txt", "w") as out:
        out.writelines("%.6f,%.6f\n" % (p.real, p.imag) for p in points)
    with open(stem + ".nml", "w") as out:
        out.write("%s\n &CURVE FILE='%s_target.txt', NPTS=%d, CLOSED=1 &END\n &KINDS LINKS=4,6,8 &END\n &METHOD ISTART=%d &END\n"
                  " &LIMITS TANGLE=90.0 &END\n &SEARCH MAXTIME=%g &END\n" % (name, os.path.basename(stem), POINTS, seed, seconds))
    child = subprocess.Popen([psalm, "--threads", "1", "--output-dir", folder, stem + ".nml"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                             text=True)
    listing = child.stdout.read()
    _, _, usage = os.wait4(child.pid, 0)
    count = POINTS
    found = re.search(r"NDES=(\d+)", open(stem + ".dev7").read())
    if found:
        count = int(found.group(1))
    errors = {}
    for row in re.findall(r"^ +\d+ +(\d\S*) +(\d+) +\d+ +\d+ +\d+ +\d+   \S", listing.split("HITS: STARTS")[0], re.M):
        links, error = int(row[1]), math.sqrt(float(row[0].replace("D", "E"))/count)/RADIUS
        errors[links] = min(error, errors.get(links, math.inf))
    first = re.search(r"^ +1 .* (YES|NO|-) +\*? +(\S.*)$", listing.split("CHOICE (DEVICE 7")[1], re.M)
    case = "\n".join(row for row in open(stem + ".dev7").read().split("\n &METHOD")[0].split("\n") if not row.startswith("!"))
    with open(stem + "_traced.nml", "w") as out:
        out.write(case + "\n &METHOD IKIN=1 &END\n")
    subprocess.run([psalm, "--quiet", "--output-dir", folder, stem + "_traced.nml"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(stem + "_traced.csv") as table:
        made = [complex(float(row["point_P.x"]), float(row["point_P.y"])) for row in csv.DictReader(table) if row["closed"] == "1"]
    wanted, mean, rms = scaled(evenly(points, COMPARED), 1.0)
    chamfer, ordered = distances(wanted, [(p - mean)/rms for p in evenly(made, COMPARED)])
    return errors, first.group(2).strip(), first.group(1), chamfer, ordered, usage.ru_utime + usage.ru_stime


def per_cent(x):
    return "%.2g" % (100*x) if x < math.inf else "-"


arguments = argparse.ArgumentParser()
arguments.add_argument("psalm")
arguments.add_argument("folder")
arguments.add_argument("--seconds", type=float, default=30.0)
arguments.add_argument("--seeds", type=int, default=5)
arguments.add_argument("--jobs", type=int, default=1)
arguments.add_argument("--only", default="")
asked = arguments.parse_args()
curves = {name: spline(text) for name, text in LETTERS.items()}
curves.update(others())
names = [name for name in curves if asked.only in ("", name)]
os.makedirs(asked.folder, exist_ok=True)
with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
    tasks = {(n, s): pool.submit(search, os.path.abspath(asked.psalm), os.path.abspath(asked.folder), n, curves[n], 1987 + s, asked.seconds)
             for n in names for s in range(asked.seeds)}
    results = {key: task.result() for key, task in tasks.items()}
rows, best_of_all, spent = [], [], []
for name in names:
    of_name = [results[name, s] for s in range(asked.seeds)]
    by_links = [statistics.median(r[0].get(n, math.inf) for r in of_name) for n in (4, 6, 8)]
    least = statistics.median(min(r[0].values()) for r in of_name)
    best_of_all.append(least)
    spent += [r[5] for r in of_name]
    kind = min(of_name, key=lambda r: abs(min(r[0].values()) - least))
    rows.append("| %s | %s | %s | %s | %s | %.4f | %.4f | %s | %.0f |" % (
        name, per_cent(least), *map(per_cent, by_links), statistics.median(r[3] for r in of_name),
        statistics.median(r[4] for r in of_name), "%s, proven: %s" % (kind[1], kind[2].lower().replace("-", "no")),
        statistics.median(r[5] for r in of_name)))
print("# Thirty curves\n")
commit = subprocess.run(["git", "-C", os.path.dirname(os.path.abspath(__file__)), "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
print("Written by `bench/curves --seconds %g --seeds %d --jobs %d`, commit %s: `psalm` on one thread, LINKS=4,6,8 with pins, dyads only; processor time"
      "\n(MAXTIME is wall-clock time, so on a busy machine a search gets less of the processor). The curves are drawn by `bench/curves.py`: letters as one closed line, and five other curves; %d points of each, RMS radius %g. Errors are RMS in per cent of that radius: the least of all kinds, and of the kinds with that number of links; medians of the seeds. Chamfer and ordered distance are those of LInK (Nobari and others, *LInK: learning joint representations of design and performance spaces through contrastive learning for mechanism synthesis*, 2024), as its program computes them: the mean distance of a point from the nearest of the other curve, summed over both ways; 2 pi times the mean squared distance of points in order, from the start and in the direction for which it is least. Both use %d points evenly spaced by arc length on either curve and a desired curve of RMS radius 1; nothing is moved or turned. Points are 0.03 apart, so two samplings of one curve may differ by a chamfer distance of 0.03. Where the ordered distance is far above the error, the linkage passes the points and leaves the curve between two of them, mostly between the last and the first. `bench/curves` without options (30 s, 5 seeds) takes 75 minutes of a quiet core.\n" % (asked.seconds, asked.seeds, asked.jobs, commit or "not known", POINTS, RADIUS, COMPARED))
print("Below 2 per cent: %d of %d curves; below 5: %d. Processor time a search: %.1f s (median).\n"
      % (sum(e < 0.02 for e in best_of_all), len(names), sum(e < 0.05 for e in best_of_all), statistics.median(spent)))
print("| curve | error, per cent | 4 links | 6 links | 8 links | chamfer | ordered | best kind | time, s |")
print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
print("\n".join(rows))
