#!/usr/bin/env python3
"""Sketches against an independent route: Newton's method on the poses of all links, started from the drawing, in numpy.

usage: test/sketches.py PROGRAM_DIRECTORY [--count N]. Last line: N passed, N failed.

Random chains of dyads of every kind are written as sketches; psalm chooses loops and signs, and its output is compared with what
Newton finds for the sketch itself, so are all joints in CASE.csv, and so is what the equivalent &LINKS of --links do.
What a search finds is drawn anew on device 7: read again it must be the same linkage."""
import argparse
import cmath
import csv
import math
import os
import random
import subprocess
import sys
import tempfile

import numpy as np

KINDS = ["RRR", "RRP", "RPR", "PRP", "RPP"]

SEARCHES = {
    "four_bar": """SEARCH FROM A SKETCH
 &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0, JY=0.0,31.0,82.0,5.0,95.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',
  VARY='A B','B C','C D','B P','angle B C B P','place D','input',
   &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=5, DELT=0.0,20.0,40.0,60.0,80.0, DESX=20.,12.,5.,0.,-6., DESY=95.,96.,95.,92.,87. &END
 &SEARCH SOLVER='LSQ', NSTART=20 &END
 &LIMITS TANGLE=70.0 &END
""",
    "slides": """SEARCH SLIDER-CRANK AND RPR
 &CHAIN JNT='A','B','C','D','F','P', JX=0.0,20.0,130.0,60.0,40.,70., JY=0.0,30.0,10.0,60.0,-50.,70.,
  LNAME='frame','crank','rod','piston','barrel','plunger', LNK='A F','A B','B C D','C','F P','D',
  NSLIDE=2, SLNK='frame','barrel', SLNK2='piston','plunger', SLX=0.0,60., SLY=10.0,60., SLANG=0.0,70.,
  VARY='A B','B C','B D','angle B C B D','place F','input',
  VLOW=20.0,60.0,20.0,0.0,40.0,-90.0,-60.0, VHIGH=60.0,160.0,80.0,90.0,90.0,-20.0,60.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=4, DELT=0.0,20.0,40.0,60.0, DESX=70.,66.,60.,55., DESY=70.,72.,74.,75. &END
 &SEARCH SOLVER='LSQ', NSTART=5 &END
 &LIMITS TANGLE=85.0 &END
""",
    "yoke": """SEARCH SCOTCH YOKE AND SLOT
 &CHAIN JNT='A','B','Q','R', JX=0.0,20.0,60.0,90., JY=0.0,30.0,10.0,40.,
  LNAME='frame','crank','block','yoke','arm','slider', LNK='A','A B','B','Q','Q R','R',
  NSLIDE=3, SLNK='yoke','frame','frame', SLNK2='block','yoke','slider', SLX=20.0,60.0,90., SLY=30.0,10.0,40., SLANG=80.0,5.0,60.,
  VARY='A B','Q R','input' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point R' &END
 &METHOD NDES=4, DELT=0.0,10.0,20.0,30.0, DESX=90.,88.,86.,83., DESY=40.,36.,32.,27. &END
 &SEARCH SOLVER='LSQ', NSTART=5 &END
 &LIMITS TANGLE=85.0 &END
""",
}


class Sketch:
    """Joints, links and slides; the first link is the frame, the second the driven one."""

    def __init__(self, title):
        self.title, self.joints, self.links, self.slides = title, {}, [["A"], ["A"]], []
        self.joints["A"] = 0j
        self.extra = ""

    def joint(self, place, *links):
        name = "J%d" % len(self.joints)
        self.joints[name] = complex(round(place.real, 3), round(place.imag, 3))
        for link in links:
            self.links[link].append(name)
        return name

    def slide(self, a, b, place, angle):
        self.slides.append((a, b, complex(round(place.real, 3), round(place.imag, 3)), round(angle, 3)))

    def text(self, output, deltas):
        def row(values):
            lines, line = [], "  "
            for value in values:
                line += value + ","
                if len(line) > 90:
                    lines.append(line)
                    line = "  "
            return "\n".join(lines + [line])
        names = list(self.joints)
        text = self.title + "\n &CHAIN JNT=\n" + row("'%s'" % n for n in names)
        text += "\n  JX=\n" + row("%.3f" % self.joints[n].real for n in names)
        text += "\n  JY=\n" + row("%.3f" % self.joints[n].imag for n in names)
        text += "\n  LNK=\n" + row("'%s'" % " ".join(link) for link in self.links)
        if self.slides:
            text += "\n  NSLIDE=%d, SLNK=%s, SLNK2=%s,\n" % (len(self.slides), ",".join("'%d'" % (s[0] + 1) for s in self.slides),
                                                           ",".join("'%d'" % (s[1] + 1) for s in self.slides))
            text += "  SLX=%s,\n  SLY=%s,\n  SLANG=%s" % tuple(",".join(f(s) for s in self.slides) for f in (
                lambda s: "%.3f" % s[2].real, lambda s: "%.3f" % s[2].imag, lambda s: "%.3f" % s[3]))
        text += self.extra + " &END\n &DRIVES DRIVE='A', DBASE='1', DLINK='2' &END\n"
        text += " &OUTPUTS OUTPUT='%s' &END\n" % output
        return text + " &METHOD NDES=%d, DELT=%s &END\n &LIMITS TANGLE=90.0, TOGGLE=0.0 &END\n" % (
            len(deltas), ",".join("%.3f" % d for d in deltas))

    def residual(self, pose, turn):
        """Everything that must vanish; pose: (x, y, angle) of every link but the frame, counted from the drawing."""
        t = [0j] + [complex(pose[3 * k], pose[3 * k + 1]) for k in range(len(self.links) - 1)]
        phi = [0.0] + [pose[3 * k + 2] for k in range(len(self.links) - 1)]
        place = lambda link, p: t[link] + cmath.exp(1j * phi[link]) * p
        rest = [phi[1] - turn]
        for name, p in self.joints.items():
            at = [k for k, link in enumerate(self.links) if name in link]
            for other in at[1:]:
                d = place(other, p) - place(at[0], p)
                rest += [d.real, d.imag]
        for a, b, p, angle in self.slides:
            rest.append(phi[b] - phi[a])
            rest.append(((place(b, p) - place(a, p)) * cmath.exp(-1j * (phi[a] + math.radians(angle)))).imag)
        return np.array(rest)

    def jacobian(self, pose, turn):
        """By differences of a complex step would need analytic functions; central differences serve the direction only."""
        h = 1e-6
        columns = []
        for k in range(len(pose)):
            e = np.zeros(len(pose))
            e[k] = h
            columns.append((self.residual(pose + e, turn) - self.residual(pose - e, turn)) / (2 * h))
        return np.array(columns).T

    def solve(self, turn, steps=8):
        """Follow from the drawing; None where the way is not safe: the chain then is drawn anew."""
        pose = np.zeros(3 * (len(self.links) - 1))
        before = None
        for k in range(1, steps + 1):
            part = turn * k / steps
            for _ in range(30):
                matrix = self.jacobian(pose, part)
                if np.linalg.cond(matrix) > 3e5:
                    return None
                step = np.linalg.solve(matrix, -self.residual(pose, part))
                pose = pose + step
                if np.max(np.abs(step)) < 1e-13 * 100:
                    break
            sign = np.sign(np.linalg.det(matrix))
            if before is not None and sign != before:
                return None
            before = sign
        return pose

    def place(self, pose, name):
        link = [k for k, joints in enumerate(self.links) if name in joints][-1]
        if link == 0:
            return self.joints[name]
        return complex(pose[3 * link - 3], pose[3 * link - 2]) + cmath.exp(1j * pose[3 * link - 1]) * self.joints[name]


def random_sketch(source, dyads, number):
    """A driven link and dyads hung on links that are there already."""
    sketch = Sketch("RANDOM CHAIN %d" % number)
    spot = lambda: complex(source.uniform(-100, 100), source.uniform(-100, 100))
    sketch.joints["A"] = complex(round(source.uniform(-20, 20), 3), round(source.uniform(-20, 20), 3))
    for k in range(dyads):
        kind = source.choice(KINDS)
        there = list(range(len(sketch.links)))
        first = 1 if k == 0 else source.choice(there)
        second = source.choice([link for link in there if link != first])
        if k == 0:
            second = 0
        p, q = len(sketch.links), len(sketch.links) + 1
        sketch.links += [[], []]
        if kind[0] == "R":
            sketch.joint(spot(), first, p)
        else:
            sketch.slide(first, p, spot(), source.uniform(0, 360))
        if kind[1] == "R":
            sketch.joint(spot(), p, q)
        else:
            sketch.slide(p, q, spot(), source.uniform(0, 360))
        if kind[2] == "R":
            sketch.joint(spot(), q, second)
        else:
            sketch.slide(second, q, spot(), source.uniform(0, 360))
        sketch.title += " " + kind
    last = source.randrange(max(2, len(sketch.links) - 2), len(sketch.links))
    output = sketch.joint(spot(), last)
    return sketch, output


def run_psalm(programs, folder, name, text, *options):
    path = os.path.join(folder, name + ".nml")
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    done = subprocess.run([os.path.join(programs, "psalm"), *options, path], capture_output=True, text=True, check=False)
    rows = []
    if done.returncode in (0, 1):
        with open(os.path.join(folder, name + ".dev9"), encoding="ascii") as file:
            for line in file:
                if line.startswith("# block limits"):
                    break
                if line.strip() and not line.startswith("#"):
                    rows.append([float(v) for v in line.split()])
    return done, rows


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep")
    arguments = parser.parse_args()
    source = random.Random(arguments.seed)
    passed = failed = 0
    worst = 0.0
    told = []
    with tempfile.TemporaryDirectory() as folder:
        folder = arguments.keep or folder
        number = 0
        while number < arguments.count:
            sketch, output = random_sketch(source, source.randint(1, 6), number)
            deltas = [0.0, 2.0, -3.0]
            poses = [sketch.solve(math.radians(d)) for d in deltas]
            if any(pose is None for pose in poses):
                continue
            number += 1
            done, rows = run_psalm(arguments.programs, folder, "c%d" % number, sketch.text("point " + output, deltas))
            if done.returncode not in (0, 1) or len(rows) != len(deltas):
                told.append("%s: exit status %d: %s" % (sketch.title, done.returncode, done.stderr.strip()[:300]))
                failed += 1
                continue
            wrong = 0.0
            for pose, row in zip(poses, rows):
                at = sketch.place(pose, output)
                wrong = max(wrong, abs(complex(row[2], row[3]) - at) / 100)
            with open(os.path.join(folder, "c%d.csv" % number), encoding="ascii") as file:
                for pose, row in zip(poses, csv.DictReader(file)):
                    for name in sketch.joints:
                        at = complex(float(row[name + ".x"]), float(row[name + ".y"]))
                        wrong = max(wrong, abs(sketch.place(pose, name) - at) / 100)
            # the equivalent loops, asked for on device 7 and read again
            run_psalm(arguments.programs, folder, "c%d" % number, sketch.text("point " + output, deltas), "--links", "--quiet")
            with open(os.path.join(folder, "c%d.dev7" % number), encoding="ascii") as file:
                loops = file.read()
            again, same = run_psalm(arguments.programs, folder, "l%d" % number, loops, "--quiet")
            if "&LINKS" not in loops or "&CHAIN" in loops or again.returncode not in (0, 1) or len(same) != len(rows):
                wrong = 1.0
            for row, other in zip(rows, same):
                wrong = max([wrong] + [abs(a - b) / 100 for a, b in zip(row[1:], other[1:])])
            worst = max(worst, wrong)
            if wrong < 1e-12:
                passed += 1
            else:
                failed += 1
                told.append("%s: differs by %.2e" % (sketch.title, wrong))
    with tempfile.TemporaryDirectory() as folder:
        for name, text in SEARCHES.items():
            done, rows = run_psalm(arguments.programs, folder, name, text)
            with open(os.path.join(folder, name + ".dev7"), encoding="ascii") as file:
                found = file.read()
            again, same = run_psalm(arguments.programs, folder, name + "_again", found)
            differ = max((abs(a - b) for r, s in zip(rows, same) for a, b in zip(r[1:], s[1:])), default=1.0)
            if "&CHAIN" in found and done.returncode == again.returncode == 0 and len(rows) == len(same) and differ < 1e-9:
                passed += 1
            else:
                failed += 1
                told.append("search of %s: its device 7 is another linkage, by %.1e; %s" % (name, differ, again.stderr))
    for line in told:
        print("FAILED:", line)
    print("largest difference, of the size of the drawing: %.1e" % worst)
    print("%d passed, %d failed" % (passed, failed))
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
