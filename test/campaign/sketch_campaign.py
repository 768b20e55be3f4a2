#!/usr/bin/env python3
"""Random sketches of every kind against an independent solver: positions, rates, forces, verdicts, order of writing.

usage: sketch_campaign.py BIN [--count N] [--seed S] [--only SEED] [--jobs J] [--seconds T] [--keep DIR] [--quiet]

Sketch k of a campaign has the seed S + k: --only SEED repeats one. Their kinds: dyads of all kinds on a driven link of the frame
(psalm takes them apart into loops), larger groups, drives between moving links, cylinders, several drives, drives with a ratio,
gears; joints, links, slides and outputs are written in random order. tools/testing/sketch_solver.c (compiled here) follows each from the
drawing by equations in the coordinates of points: no poses, no loops. What is compared, at every position:

- all joints and outputs of CASE.csv; device 9, listing and CASE.csv with each other;
- `closed` with what the solver reaches; the summary and the exit status with `closed`;
- velocities and accelerations of joints and outputs (kalm);
- torques and forces of drives by virtual work, kinetic energy, and every joint's force by the equilibrium of links;
- the same sketch written in another order: the same numbers. psalm reads one order, kalm another; in one batch of four (and with
  --only) kalm reads both, and balm a third;
- the page of balm: joints, outputs, drives and `closed` at every position.

With several drives a position may close although the straight way to it from the drawing does not, because dyads close again beyond a
gap. Such a position passes if psalm's own proof finds a dead point on that way, too ("beyond a gap" in the last lines). Whether it
closes is not compared between orders: one may be taken apart into dyads, another into groups, which are followed.
A sketch that fails is written to --keep (build/test/sketches unless given) with what is wrong in its first lines.
Last line: N passed, N failed (sketches)."""
import argparse
import cmath
import ctypes
import functools
import json
import math
import multiprocessing
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter

import numpy as np

SIZE = 100.0                # of the drawings; the solver works in this unit
EPSILON = 2.0 ** -52
SINGULAR = 1.0e5            # norm of the inverse Jacobian from which on no number is compared
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
COUNT = 200                 # sketches of the short form
# and these, which were wrong before: masses on links that only slide on others; slides that are parallel on the way; a wheel whose
# only pin is the pivot of the first drive; a group behind a gap of another; a page with a position that is not
# reached; a way through links that a group does not depend on; a wheel
# at the first position; a group that came the other way round; a gap within half a degree of the drawing; two motions that cross
# on the way; several inputs that are reached from the drawing, but not from the position before
ONCE_WRONG = [200136, 200272, 200496, 201797, 201960, 202034, 202073, 301168, 500752, 501919, 520700, 530011, 532313, 532680,
              534951, 912668, 926407]
DEAD = 1.0e8                # norm at a dead point, as near to it as numbers come
MULTIPLE = 3000.0           # of epsilon times condition that a number may differ by
FAR = 100.0*SIZE            # no place is this far away where the solver is asked
PAGE = 1.0e-8               # digits of pages: nine
BOTH_ORDERS = 4             # kalm reads both orders in one batch of so many
PATIENCE = ["prlimit", "--cpu=120"] if shutil.which("prlimit") else [] # seconds of the processor that a run may take
NO_END = 3600               # seconds by the clock: so long only where it waits for something

DYADS = ["RRR", "RRR", "RRR", "RRR", "RRP", "RRP", "PRR", "PRR", "RPR", "RPR", "PRP", "RPP", "PPR"]
LEGS = ["RR", "RR", "RR", "PR", "RP"]


# ---------------------------------------------------------------------------------------------------------------------------------
# sketches
# ---------------------------------------------------------------------------------------------------------------------------------

class Link:
    def __init__(self, name):
        self.name, self.joints, self.fixed_order = name, [], False


class Unfit(Exception):
    """A sketch that is drawn anew."""


class Sketch:
    """Joints, links, slides (a, b, place, degrees), gears (a, b, carrier, teeth), drives; link 0 is the frame."""

    def __init__(self, draw):
        self.draw = draw
        self.joints, self.links, self.slides, self.gears, self.drives, self.outputs = {}, [Link("frame")], [], [], [], []
        self.masses, self.loads, self.springs = [], [], []
        self.kind = ""

    def spot(self):
        return complex(round(self.draw.uniform(-SIZE, SIZE), 3), round(self.draw.uniform(-SIZE, SIZE), 3))

    def new_link(self):
        self.links.append(Link("L%d" % len(self.links)))
        return len(self.links) - 1

    def other(self, *links):
        """A link that is there, none of these."""
        rest = [k for k in range(len(self.links)) if k not in links]
        if not rest:
            raise Unfit
        return self.draw.choice(rest)

    def joint(self, *links, place=None):
        name = "J%d" % (len(self.joints) + 1)
        self.joints[name] = self.spot() if place is None else place
        for link in links:
            self.links[link].joints.append(name)
        return name

    def pair(self, kind, a, b, reuse=True):
        """Pin or slide of link b on link a; a new link may be pinned to a joint of a that is there."""
        if kind == "R":
            if reuse and self.links[a].joints and not self.links[b].joints and self.draw.random() < 0.12:
                name = self.draw.choice(self.links[a].joints)
                self.links[b].joints.append(name)
                return name
            return self.joint(a, b)
        self.slides.append(["S%d" % (len(self.slides) + 1), *self.draw.sample([a, b], 2), self.spot(),
                            round(self.draw.uniform(-180.0, 180.0), 3)])
        return self.slides[-1][0]

    def drive(self, kind, at, base, link, **more):
        self.drives.append(dict(kind=kind, at=at, base=base, link=link, ratio=0.0, phase=0.0, **more))

    def driven(self, base):
        """A link that is driven against one that is there: by pin, slide or cylinder."""
        kind = self.draw.choice(["pin", "pin", "slide", "cylinder"])
        link = self.new_link()
        if kind == "cylinder":
            self.pair("R", base, link)
            foot, end = self.joint(self.other(link)), self.joint(link)
            self.drive("cylinder", (foot, end) if self.draw.random() < 0.5 else (end, foot), None, None)
        else:
            at = self.pair("R" if kind == "pin" else "P", base, link)
            self.drive(kind, at, *self.draw.sample([base, link], 2))
        return link

    def driven_within(self):
        """Three links between two that are there; one of the four pairs is driven."""
        kinds = [self.draw.choice("RRRP") for _ in range(4)]
        first = self.draw.randrange(len(self.links))
        second = self.other(first) if len(self.links) > 1 else first
        links = [first] + [self.new_link() for _ in range(3)] + [second]
        which = self.draw.randrange(4)
        for k in range(4):
            at = self.pair(kinds[k], links[k], links[k + 1], reuse=k == 0)
            if k == which:
                self.drive("pin" if kinds[k] == "R" else "slide", at, *self.draw.sample(links[k:k + 2], 2))

    def dyad(self):
        kind = self.draw.choice(DYADS)
        first = self.draw.randrange(len(self.links))
        second = self.other(first)
        p, q = self.new_link(), self.new_link()
        self.pair(kind[0], first, p)
        self.pair(kind[1], p, q, reuse=False)
        self.pair(kind[2], second, q, reuse=False)

    def leg(self, body, base):
        """A link between two."""
        kind = self.draw.choice(LEGS)
        link = self.new_link()
        self.pair(kind[0], base, link)
        self.pair(kind[1], body, link, reuse=False)

    def bases(self, count):
        """Links that are there, not all the same."""
        chosen = [self.draw.randrange(len(self.links)) for _ in range(count)]
        if len(set(chosen)) == 1:
            chosen[0] = self.other(chosen[0])
        return chosen

    def triad(self):
        bases = self.bases(3)
        body = self.new_link()
        for base in bases:
            self.leg(body, base)

    def ring(self):
        """Four links in a ring, two opposite ones on what is there."""
        bases = self.bases(2)
        links = [self.new_link() for _ in range(4)]
        for k in range(4):
            self.pair(self.draw.choice("RRRRRP"), links[k], links[(k + 1) % 4], reuse=False)
        for k, base in zip((0, 2), bases):
            self.joint(base, links[k])

    def six(self):
        """Two bodies pinned to each other, each on two legs."""
        bases = self.bases(4)
        one, two = self.new_link(), self.new_link()
        self.pair(self.draw.choice("RRRP"), one, two, reuse=False)
        for base, body in zip(bases, (one, one, two, two)):
            self.leg(body, base)

    def gear(self):
        """A wheel on a carrier that has a wheel already: a link pinned to it."""
        pins = [(a, c, name) for name in self.joints for a in range(len(self.links)) for c in range(len(self.links))
                if a != c and name in self.links[a].joints and name in self.links[c].joints]
        if not pins:
            raise Unfit
        a, c, name = self.draw.choice(pins)
        b = self.new_link()
        self.joint(b, c)
        teeth = self.draw.sample(range(12, 80), 2)
        if self.draw.random() < 0.3:
            teeth[self.draw.randrange(2)] *= -1
        self.gears.append((a, b, c, *teeth))

    def text(self, rows, title, order, last):
        """The case; order: a source of random orders, None: as drawn."""
        def shuffled(things):
            things = list(things)
            if order:
                order.shuffle(things)
            return things

        def items(values):
            lines, line = [], ""
            for value in values:
                line += value + ","
                if len(line) > 90:
                    lines.append(line)
                    line = ""
            return "\n   ".join(lines + [line])

        number = lambda value: repr(float(value))
        quoted = lambda words: items("'%s'" % w for w in words)
        names = shuffled(self.joints)
        links = [self.links[0]] + shuffled(self.links[1:])
        text = title + "\n &CHAIN JNT=" + quoted(names)
        text += "\n  JX=" + items(number(self.joints[n].real) for n in names)
        text += "\n  JY=" + items(number(self.joints[n].imag) for n in names)
        text += "\n  LNAME=" + quoted(link.name for link in links)
        text += "\n  LNK=" + quoted(" ".join(link.joints if link.fixed_order else shuffled(link.joints)) for link in links)
        if self.slides:
            slides = shuffled(self.slides)
            text += "\n  SNAME=" + quoted(s[0] for s in slides)
            text += "\n  SLNK=" + quoted(self.links[s[1]].name for s in slides)
            text += "\n  SLNK2=" + quoted(self.links[s[2]].name for s in slides)
            text += "\n  SLX=%s\n  SLY=%s\n  SLANG=%s" % tuple(items(number(f(s)) for s in slides) for f in (
                lambda s: s[3].real, lambda s: s[3].imag, lambda s: s[4]))
        if self.gears:
            gears = shuffled(self.gears)
            text += "\n  GEARA=%s GEARB=%s GCARR=%s" % tuple(quoted(self.links[g[k]].name for g in gears) for k in range(3))
            text += "\n  GTA=%s GTB=%s" % tuple(items(number(g[k]) for g in gears) for k in (3, 4))
        text += " &END\n &DRIVES DRIVE=" + quoted(d["at"] if isinstance(d["at"], str) else " ".join(d["at"]) for d in self.drives)
        text += " DBASE=" + quoted("" if d["base"] is None else self.links[d["base"]].name for d in self.drives)
        text += " DLINK=" + quoted("" if d["link"] is None else self.links[d["link"]].name for d in self.drives)
        if any(d["ratio"] for d in self.drives):
            text += "\n  RATIO=" + items(number(d["ratio"]) for d in self.drives)
            text += " PHASE=" + items(number(d["phase"]) for d in self.drives)
        for k, d in enumerate(self.drives[1:], 1):
            if not d["ratio"]:
                text += "\n  DELT%d=" % (k + 1) + items(number(r[k]) for r in rows)
        if any(d.get("speed") for d in self.drives[1:]):
            text += "\n  DSPEED=" + items(number(0 if k == 0 or d["ratio"] else d["speed"]) for k, d in enumerate(self.drives))
            text += " DACCEL=" + items(number(0 if k == 0 or d["ratio"] else d["growth"]) for k, d in enumerate(self.drives))
        # a ratio comes after the outputs it is of
        ratios = [o for o in self.outputs if o[1] == "ratio"]
        outputs = shuffled(o for o in self.outputs if o[1] != "ratio") + ratios
        text += " &END\n &OUTPUTS OUTPUT=" + quoted(" ".join([o[1], *o[2]]) for o in outputs)
        text += " ONAME=" + quoted(o[0] for o in outputs)
        text += " &END\n &METHOD NDES=%d, DELT=" % len(rows) + items(number(r[0]) for r in rows)
        text += " &END\n &LIMITS TANGLE=90.0, TOGGLE=0.0%s &END\n" % ("" if last else ", LAST=0")
        first = self.drives[0]
        text += " &RATES SPEED=%r, ACCEL=%r &END\n" % (first["speed"], first["growth"])
        if self.masses:
            masses = shuffled(self.masses)
            text += " &MASSES NMASS=%d, MNAME=%s\n  MASS=%s MDIST=%s MANG=%s\n  MINERT=%s UNITL=%r, GRAVX=%r, GRAVY=%r &END\n" % (
                len(masses), quoted(self.anchor(m[0]) for m in masses), *(items(number(m[k]) for m in masses) for k in (1, 2, 3, 4)),
                self.unit, self.gravity.real, self.gravity.imag)
        if self.loads:
            loads = shuffled(self.loads)
            text += " &LOADS NLOAD=%d, LNAME=%s\n  LDIST=%s LANG=%s LFX=%s LFY=%s LMOM=%s LTURN=%s &END\n" % (
                len(loads), quoted(self.anchor(o[0]) for o in loads), *(items(number(o[k]) for o in loads) for k in (1, 2, 3, 4, 5)),
                items("%d" % o[6] for o in loads))
        if self.springs:
            springs = shuffled(self.springs)
            text += " &SPRING NSPRNG=%d, ANAME=%s BNAME=%s\n  ADIST=%s AANG=%s BDIST=%s BANG=%s\n" % (
                len(springs), quoted(self.anchor(s[0]) for s in springs), quoted(self.anchor(s[3]) for s in springs),
                *(items(number(s[k]) for s in springs) for k in (1, 2, 4, 5)))
            text += "  STIFF=%s SFREE=%s SPRE=%s SDAMP=%s &END\n" % tuple(items(number(s[k]) for s in springs) for k in (6, 7, 8, 9))
        return text

    def anchor(self, at):
        """Name of a place's line: link, first and second joint; (link, joint): the link has one joint only."""
        return " ".join([self.links[at[0]].name, *at[1:]])

    def line(self, at):
        """Where such a line begins in the drawing, and its direction there, degrees."""
        start = self.joints[at[1]]
        return start, math.degrees(cmath.phase(self.joints[at[2]] - start)) if len(at) > 2 else 0.0


def some_line(sketch, link):
    """A line of a link that places are counted from; None: it has no joint."""
    joints = sketch.links[link].joints
    if not joints:
        return None
    if len(joints) == 1:
        return (link, joints[0])
    at = sketch.draw.sample(joints, 2)
    return (link, *at) if abs(sketch.joints[at[0]] - sketch.joints[at[1]]) > 1.0 else None


def random_sketch(seed):
    """A sketch, its drive values (as written) at the positions, and whether it is one of dyads with one drive on the frame."""
    draw = random.Random(seed)
    while True:
        try:
            return draw_sketch(draw)
        except Unfit:
            continue


def draw_sketch(draw):
    sketch = Sketch(draw)
    kind = draw.choices(["dyads", "groups", "drives", "gears"], [45, 25, 20, 10])[0]
    sketch.kind = kind
    dyads = kind == "dyads"
    if dyads:
        link = sketch.new_link()
        at = sketch.pair("R" if draw.random() < 0.7 else "P", 0, link)
        sketch.drive("pin" if at[0] == "J" else "slide", at, *((0, link) if draw.random() < 0.9 else (link, 0)))
        for _ in range(draw.randint(1, 5)):
            sketch.dyad()
    else:
        steps = {"groups": ["one"], "drives": ["one", "one"] + ["one"]*(draw.random() < 0.4),
                 "gears": ["one", "gear"] + ["gear"]*(draw.random() < 0.2)}[kind]
        rest = steps[1:] + [draw.choice(["dyad", "dyad", "triad", "ring", "six"]) for _ in range(draw.randint(1, 2))]
        if kind == "groups":
            rest[-1] = draw.choice(["triad", "triad", "ring", "six"])
        draw.shuffle(rest)
        steps[1:] = rest
        for step in steps:
            if step == "one":
                if draw.random() < 0.3:
                    sketch.driven_within()
                else:
                    sketch.driven(draw.randrange(len(sketch.links)))
            else:
                getattr(sketch, step)()
    if len(sketch.links) > 16:
        raise Unfit
    for drive in sketch.drives[1:]:
        if draw.random() < 0.25 and (drive["kind"] == "pin") == (sketch.drives[0]["kind"] == "pin"):
            drive["ratio"], drive["phase"] = round(draw.uniform(-2.0, 2.0), 2) or 0.5, 0.0
    for _ in range(draw.randint(0, 2)):
        sketch.joint(draw.randrange(1, len(sketch.links)))
    # what moves how far
    wide = [2.0, 10.0, 40.0, 180.0] if dyads else [2.0, 5.0, 20.0]
    rows, reach = [], [draw.choice(wide if d["kind"] == "pin" else [2.0, 5.0, 20.0]) for d in sketch.drives]
    for k in range(draw.randint(2, 5)):
        row = [0.0 if k == 0 and draw.random() < 0.3 else round(draw.uniform(-r, r), 3) for r in reach]
        if any(abs(row[0] - other[0]) < 0.01 for other in rows):
            continue
        for m, drive in enumerate(sketch.drives):
            if drive["ratio"]:
                row[m] = drive["ratio"]*row[0] + drive["phase"]
        rows.append(row)
    for drive in sketch.drives:
        unit = 1.0 if drive["kind"] == "pin" else SIZE
        drive["speed"], drive["growth"] = round(draw.uniform(0.2, 5.0)*unit, 2), round(draw.uniform(-3.0, 3.0)*unit, 2)
    for drive in sketch.drives[1:]:
        if drive["ratio"]:
            drive["speed"], drive["growth"] = (drive["ratio"]*sketch.drives[0][k] for k in ("speed", "growth"))
    choose_outputs(sketch)
    if draw.random() < 0.7:
        choose_forces(sketch)
    return sketch, rows, dyads


def choose_outputs(sketch):
    draw, joints = sketch.draw, list(sketch.joints)
    moving = [n for n in joints if n not in sketch.links[0].joints]
    if not moving:
        raise Unfit
    apart = lambda a, b: a != b and abs(sketch.joints[a] - sketch.joints[b]) > 5.0
    for k in range(draw.randint(1, 4)):
        name, kind = "O%d" % (k + 1), draw.choice(["point", "point", "x", "y", "angle", "line", "distance", "origin", "slide", "between",
                                                   "pose"])
        if kind in ("point", "x", "y"):
            sketch.outputs.append((name, kind, [draw.choice(moving)]))
        elif kind == "angle" or kind == "pose":
            links = [link for link in sketch.links[1:] if len(link.joints) > 1 and apart(*link.joints[:2])]
            if links:
                link = draw.choice(links)
                link.fixed_order = True
                sketch.outputs.append((name, kind, [link.name] if kind == "angle" else [draw.choice(link.joints), link.name]))
        elif kind in ("line", "distance", "between") and len(joints) > 1:
            pairs = [draw.sample(joints, 2) for _ in range(2)]
            if all(apart(*p) and not set(p) <= set(sketch.links[0].joints) for p in pairs):
                word = "angle" if kind == "line" else kind
                sketch.outputs.append((name, word, pairs[0] + (pairs[1] if kind == "between" else [])))
        elif kind == "origin":
            sketch.outputs.append((name, "distance", [draw.choice(moving)]))
        elif kind == "slide" and sketch.slides:
            sketch.outputs.append((name, "slide", [draw.choice(sketch.slides)[0]]))
    if not sketch.outputs:
        sketch.outputs.append(("O1", "point", [draw.choice(moving)]))
    single = [o[0] for o in sketch.outputs if o[1] not in ("point", "pose")]
    if len(single) > 1 and len(sketch.drives) == 1 and draw.random() < 0.5:
        sketch.outputs.append(("R", "ratio", draw.sample(single, 2)))


def choose_forces(sketch):
    draw = sketch.draw
    sketch.unit, sketch.gravity = draw.choice([1.0, 0.001]), complex(round(draw.uniform(-3, 3), 2), -9.81)
    size = SIZE*sketch.unit
    for link in range(1, len(sketch.links)):
        at = some_line(sketch, link)
        if at and draw.random() < 0.8:
            sketch.masses.append((at, round(draw.uniform(0.1, 3.0), 3), round(draw.uniform(-30, 60), 2), round(draw.uniform(-180, 180), 1),
                                  draw.uniform(0.0, 0.3)*size**2))
    if not sketch.masses:
        return
    for _ in range(draw.randint(0, 2)):
        at = some_line(sketch, draw.randrange(1, len(sketch.links)))
        if at:
            force = 30.0*max(size, 1.0)
            sketch.loads.append((at, round(draw.uniform(-30, 60), 2), round(draw.uniform(-180, 180), 1),
                                 round(draw.uniform(-force, force), 2), round(draw.uniform(-force, force), 2),
                                 round(draw.uniform(-force, force)*size, 3), draw.randrange(2)))
    for _ in range(draw.randint(0, 2)):
        a, b = draw.sample(range(len(sketch.links)), 2)
        ends = some_line(sketch, a), some_line(sketch, b)
        if all(ends):
            stiff = 10.0*max(size, 1.0)/size
            sketch.springs.append((ends[0], round(draw.uniform(-30, 60), 2), round(draw.uniform(-180, 180), 1),
                                   ends[1], round(draw.uniform(-30, 60), 2), round(draw.uniform(-180, 180), 1),
                                   round(draw.uniform(0.1, 1.0)*stiff, 3), round(draw.uniform(0, 60), 2),
                                   round(draw.uniform(-1, 1)*stiff*size, 3), round(draw.uniform(0, 1)*stiff, 3)))


# ---------------------------------------------------------------------------------------------------------------------------------
# the independent solver
# ---------------------------------------------------------------------------------------------------------------------------------

def compile_solver(folder):
    path = os.path.join(folder, "sketch_solver.so")
    subprocess.run([os.environ.get("CC", "cc"), "-O2", "-shared", "-fPIC", "-o", path, os.path.join(TOP, "tools", "testing", "sketch_solver.c"), "-lm"],
                   check=True)
    return path


@functools.lru_cache(maxsize=None)
def load_solver(path):
    solver = ctypes.CDLL(path)
    solver.follow.restype = ctypes.c_double
    return solver


class Model:
    """Equations of a sketch: every link has two points whose coordinates are unknowns (joints where it has them)."""

    def __init__(self, sketch, solver):
        self.sketch, self.solver = sketch, solver
        self.unknown = {}
        draw = random.Random(1)
        frame = set(sketch.links[0].joints)
        start = [1.0]
        for name, place in sketch.joints.items():
            if name not in frame:
                self.unknown[name] = len(start)
                start += [place.real/SIZE, place.imag/SIZE]
        ends = []
        for k, link in enumerate(sketch.links):
            joints = link.joints
            far = max(((a, b) for a in joints for b in joints if a < b), default=None,
                      key=lambda p: abs(sketch.joints[p[0]] - sketch.joints[p[1]]))
            if k == 0:
                ends.append(None)
                continue
            if far and abs(sketch.joints[far[0]] - sketch.joints[far[1]]) > 10.0:
                ends.append(far)
                continue
            points = joints[:1]
            base = sketch.joints[joints[0]] if joints else complex(draw.uniform(-SIZE, SIZE), draw.uniform(-SIZE, SIZE))
            if not joints:
                self.unknown[("point", k, 0)] = len(start)
                start += [base.real/SIZE, base.imag/SIZE]
                points = [("point", k, 0)]
            self.unknown[("point", k, 1)] = len(start)
            start += [base.real/SIZE + 0.5, base.imag/SIZE + 0.2]
            ends.append((points[0], ("point", k, 1)))
        self.start = np.array(start)
        self.n = len(start) - 1
        self.ends = ends
        self.entries, self.count = [], 0
        self.turn_rows, self.turn_weights, self.turn_forms = [], [], []
        for k, link in enumerate(sketch.links):
            if k == 0:
                continue
            a, b = (self.point(e) for e in ends[k])
            d = b - a
            self.square(d, constant=-abs(self.place_of(ends[k][1]) - self.place_of(ends[k][0]))**2)
            for name in link.joints:
                if name not in ends[k]:
                    rest = self.point(name) - self.on(k, sketch.joints[name])
                    self.linear(rest[0])
                    self.linear(rest[1])
        for name, a, b, place, degrees in sketch.slides:
            angle = cmath.exp(1j*math.radians(degrees))
            ea, eb = self.along(a, angle), self.along(b, angle)
            self.cross(ea, eb)
            self.cross(ea, self.on(b, place) - self.on(a, place))
        for m, drive in enumerate(sketch.drives):
            if drive["kind"] == "pin":
                ea, eb = self.along(drive["base"], 1.0), self.along(drive["link"], 1.0)
                self.product(ea[0], eb[1], 1.0, m, 1)
                self.product(ea[1], eb[0], -1.0, m, 1)
                self.product(ea[0], eb[0], -1.0, m, 2)
                self.product(ea[1], eb[1], -1.0, m, 2)
            elif drive["kind"] == "slide":
                _, a, b, place, degrees = next(s for s in sketch.slides if s[0] == drive["at"])
                ea = self.along(drive["base"], cmath.exp(1j*math.radians(degrees)))
                d = self.on(drive["link"], place) - self.on(drive["base"], place)
                self.product(ea[0], d[0])
                self.product(ea[1], d[1])
                self.entries.append((self.count, 0, 0, m, 3, -1.0))
            else:
                b, c = drive["at"]
                d = self.point(c) - self.point(b)
                self.product(d[0], d[0])
                self.product(d[1], d[1])
                length = abs(sketch.joints[c] - sketch.joints[b])/SIZE
                drive["length"] = length
                self.entries.append((self.count, 0, 0, -1, 0, -length**2))
                self.entries.append((self.count, 0, 0, m, 3, -2.0*length))
                self.entries.append((self.count, 0, 0, m, 4, -1.0))
            self.count += 1
        for a, b, c, ta, tb in sketch.gears:
            for link, weight in ((a, ta), (b, tb), (c, -ta - tb)):
                if link:
                    self.turn_rows.append(self.count)
                    self.turn_weights.append(weight/(abs(ta) + abs(tb)))
                    self.turn_forms.append(self.along(link, 1.0))
            self.count += 1
        if self.count != self.n:
            raise Unfit
        table = np.array(self.entries, dtype=float)
        ints = [np.ascontiguousarray(table[:, k], dtype=np.int32) for k in range(5)]
        self.keep = ints + [np.ascontiguousarray(table[:, 5]), np.array(self.turn_rows, dtype=np.int32), np.array(self.turn_weights, dtype=float),
                            np.array(self.turn_forms, dtype=float).reshape(-1)]
        self.header = [ctypes.c_int(self.n), ctypes.c_int(len(table)), ctypes.c_int(len(sketch.drives)), ctypes.c_int(len(self.turn_rows))]
        self.arguments = self.header + [a.ctypes.data_as(ctypes.c_void_p) for a in self.keep]

    def place_of(self, end):
        if isinstance(end, str):
            return self.sketch.joints[end]/SIZE
        k = self.unknown[end]
        return complex(self.start[k], self.start[k + 1])

    def point(self, end):
        """Linear forms of x and y of a joint or an auxiliary point, in the unknowns."""
        form = np.zeros((2, self.n + 1))
        k = self.unknown.get(end)
        if k is None:
            place = self.place_of(end)
            form[:, 0] = place.real, place.imag
        else:
            form[0, k] = form[1, k + 1] = 1.0
        return form

    def turned(self, form, factor):
        return np.array([factor.real*form[0] - factor.imag*form[1], factor.imag*form[0] + factor.real*form[1]])

    def along(self, link, direction):
        """A direction of a link, as it is in the drawing."""
        if link == 0:
            form = np.zeros((2, self.n + 1))
            direction = complex(direction)
            form[:, 0] = direction.real, direction.imag
            return form
        a, b = self.ends[link]
        return self.turned(self.point(b) - self.point(a), direction/(self.place_of(b) - self.place_of(a)))

    def on(self, link, place):
        """A point of a link at a place of the drawing."""
        place = place/SIZE
        if link == 0:
            form = np.zeros((2, self.n + 1))
            form[:, 0] = place.real, place.imag
            return form
        a, b = self.ends[link]
        return self.point(a) + self.turned(self.point(b) - self.point(a),
                                           (place - self.place_of(a))/(self.place_of(b) - self.place_of(a)))

    def product(self, u, v, factor=1.0, drive=-1, kind=0):
        for i in np.nonzero(u)[0]:
            for j in np.nonzero(v)[0]:
                self.entries.append((self.count, int(i), int(j), drive, kind, factor*u[i]*v[j]))

    def square(self, d, constant):
        self.product(d[0], d[0])
        self.product(d[1], d[1])
        self.entries.append((self.count, 0, 0, -1, 0, constant))
        self.count += 1

    def cross(self, u, v):
        self.product(u[0], v[1])
        self.product(u[1], v[0], -1.0)
        self.count += 1

    def linear(self, form):
        for i in np.nonzero(form)[0]:
            self.entries.append((self.count, int(i), 0, -1, 0, form[i]))
        self.count += 1

    def drives(self, row):
        return np.array([math.radians(v) if d["kind"] == "pin" else v/SIZE for v, d in zip(row, self.sketch.drives)])

    def follow(self, state, before, row, step=0.05):
        """From a state (unknowns, angles of gears) at drives `before`; part of the way, the state, the inverse's norm."""
        x, angle = state[0].copy(), state[1].copy()
        s0, s1, norm = self.drives(before), self.drives(row), ctypes.c_double()
        reach = self.solver.follow(*self.arguments, angle.ctypes.data_as(ctypes.c_void_p), s0.ctypes.data_as(ctypes.c_void_p),
                                   s1.ctypes.data_as(ctypes.c_void_p), ctypes.c_double(step), x.ctypes.data_as(ctypes.c_void_p),
                                   ctypes.byref(norm))
        return reach, (x, angle), norm.value

    def drawing(self):
        return self.start, np.zeros(max(1, len(self.turn_rows)))

    def rates(self, state, row):
        """Velocities, accelerations, derivatives by each drive of the unknowns."""
        x, angle = state
        drives = self.sketch.drives
        units = [1.0 if d["kind"] == "pin" else SIZE for d in drives]
        speed = np.array([d["speed"]/u for d, u in zip(drives, units)])
        growth = np.array([d["growth"]/u for d, u in zip(drives, units)])
        s = self.drives(row)
        v, w, by = np.zeros(self.n + 1), np.zeros(self.n + 1), np.zeros((len(drives), self.n + 1))
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (angle, s, speed, growth, x, v, w, by)]
        if not self.solver.rates(*self.arguments, *pointers):
            return None
        return v, w, by


class Motion:
    """Position, velocity, acceleration of points and directions at a state: complex numbers, in SIZE."""

    def __init__(self, model, x, v=None, w=None):
        self.model, self.vectors = model, [u for u in (x, v, w) if u is not None]

    def of(self, form):
        return [complex(form[0] @ u, form[1] @ u) if k == 0 else complex(form[0, 1:] @ u[1:], form[1, 1:] @ u[1:])
                for k, u in enumerate(self.vectors)]

    def joint(self, name):
        k = self.model.unknown.get(name)
        if k is None:
            return [self.model.place_of(name)] + [0j]*(len(self.vectors) - 1)
        return [complex(u[k], u[k + 1]) for u in self.vectors]


def angle_of(d):
    """Direction of a vector with its rates: degrees, radians a second."""
    out = [math.degrees(cmath.phase(d[0]))]
    if len(d) > 1:
        rate = d[1]/d[0]
        out += [rate.imag, (d[2]/d[0] - rate*rate).imag]
    return out


def length_of(d):
    out = [abs(d[0])*SIZE]
    if len(d) > 1:
        rate = d[1]/d[0]
        growth = d[2]/d[0] - rate*rate
        out += [out[0]*rate.real, out[0]*(growth.real + rate.real**2)]
    return out


def output_values(sketch, model, motion):
    """{column: [value, velocity, acceleration]}; angles in degrees."""
    values = {}
    minus = lambda a, b: [p - q for p, q in zip(a, b)]
    line = lambda a, b: minus(motion.joint(b), motion.joint(a))
    for name, kind, at in sketch.outputs:
        if kind in ("point", "x", "y", "pose"):
            place = [p*SIZE for p in motion.joint(at[0])]
            x, y = [p.real for p in place], [p.imag for p in place]
            if kind in ("x", "y"):
                values[name] = x if kind == "x" else y
                continue
            values[name + ".x"], values[name + ".y"] = x, y
            if kind == "pose":
                link = next(o for o in sketch.links if o.name == at[1])
                values[name + ".angle"] = angle_of(line(*link.joints[:2]))
        elif kind == "angle":
            link = [o for o in sketch.links if o.name == at[0]]
            values[name] = angle_of(line(*(link[0].joints[:2] if link else at)))
        elif kind == "distance":
            values[name] = length_of(line(*at) if len(at) == 2 else motion.joint(at[0]))
        elif kind == "between":
            one, two = angle_of(line(*at[:2])), angle_of(line(*at[2:]))
            values[name] = [b - a for a, b in zip(one, two)]
        elif kind == "slide":
            _, a, b, place, degrees = next(s for s in sketch.slides if s[0] == at[0])
            e = motion.of(model.along(a, cmath.exp(1j*math.radians(degrees))))
            d = minus(motion.of(model.on(b, place)), motion.of(model.on(a, place)))
            dot = lambda p, q: (p*q.conjugate()).real
            values[name] = [SIZE*dot(d[0], e[0])]
            if len(d) > 1:
                values[name] += [SIZE*(dot(d[1], e[0]) + dot(d[0], e[1])), SIZE*(dot(d[2], e[0]) + 2*dot(d[1], e[1]) + dot(d[0], e[2]))]
    return values


# ---------------------------------------------------------------------------------------------------------------------------------
# forces
# ---------------------------------------------------------------------------------------------------------------------------------

def forces(sketch, model, state, derivatives):
    """Everything kalm prints of forces: drives by virtual work, joints by equilibrium of the links. None: not solvable.

    Returns ({column: value}, {column: value whose sign is a convention}, greatest force)."""
    x, (v, w, by) = state[0], derivatives
    motion, count = Motion(model, x, v, w), len(sketch.links)
    unit = sketch.unit*SIZE                         # metres in the solver's unit
    cross = lambda a, b: (a.conjugate()*b).imag
    applied = [[] for _ in range(count)]            # (place, force) of each link, solver's places
    couples = [0.0]*count
    work = np.zeros(len(sketch.drives))             # virtual work of everything applied, a unit of each drive
    turn = lambda link: motion.of(model.along(link, 1.0))
    rate = lambda link, u: 0.0 if link == 0 else (complex(*(model.along(link, 1.0)[:, 1:] @ u[1:]))/turn(link)[0]).imag
    kinetic = 0.0

    def place(at, distance, degrees):
        start, direction = sketch.line(at)
        return start + distance*cmath.exp(1j*math.radians(direction + degrees))

    def push(link, form, force):
        if link == 0:
            applied[0].append((complex(form[0, 0], form[1, 0]), force))
            return
        applied[link].append((motion.of(form)[0], force))
        for m in range(len(work)):
            work[m] += (force.conjugate()*complex(*(form[:, 1:] @ by[m][1:]))).real*unit

    def wring(link, couple):
        couples[link] += couple
        for m in range(len(work)):
            work[m] += couple*rate(link, by[m])

    for at, mass, distance, degrees, inertia in sketch.masses:
        link, form = at[0], model.on(at[0], place(at, distance, degrees))
        _, velocity, acceleration = motion.of(form)
        push(link, form, mass*(sketch.gravity - acceleration*unit))
        spin = angle_of(turn(link))
        wring(link, -inertia*spin[2])
        kinetic += 0.5*mass*abs(velocity*unit)**2 + 0.5*inertia*spin[1]**2
    for at, distance, degrees, fx, fy, moment, turns in sketch.loads:
        force = complex(fx, fy)
        if turns:
            force *= cmath.exp(1j*math.radians(sketch.line(at)[1]))*turn(at[0])[0]
            force /= abs(turn(at[0])[0])
        push(at[0], model.on(at[0], place(at, distance, degrees)), force)
        wring(at[0], moment)
    for a, da, aa, b, db, ab, stiff, free, pre, damp in sketch.springs:
        one, two = model.on(a[0], place(a, da, aa)), model.on(b[0], place(b, db, ab))
        d = [q - p for p, q in zip(motion.of(one), motion.of(two))]
        length = length_of(d)
        pull = stiff*(length[0] - free)*sketch.unit + pre + damp*length[1]*sketch.unit
        push(a[0], one, pull*d[0]/abs(d[0]))
        push(b[0], two, -pull*d[0]/abs(d[0]))
    drive = [-q/(unit if d["kind"] != "pin" else 1.0) for q, d in zip(work, sketch.drives)]
    # unknowns: forces of pins on links, of slides, of teeth, of drives
    size = 3*(count - 1)
    columns, names = [], []

    def column(name, acts):
        """acts: (link, place, force, couple) of a unit."""
        vector = np.zeros(3*count)
        for link, at, force, couple in acts:
            vector[3*link:3*link + 3] += force.real, force.imag, unit*cross(at, force) + couple
        columns.append(vector)
        names.append(name)

    members, cylinder_ends = {}, {}
    for m, d in enumerate(sketch.drives):
        if d["kind"] == "cylinder":
            for end in d["at"]:
                cylinder_ends.setdefault(end, []).append(m)
    for name in sketch.joints:
        at, links = motion.joint(name)[0], [k for k, link in enumerate(sketch.links) if name in link.joints]
        members[name] = links
        for link in links[1:]:
            for force in (1.0 + 0j, 1j):
                column((name, link, force == 1j), [(link, at, force, 0.0), (links[0], at, -force, 0.0)])
    for name, a, b, spot, degrees in sketch.slides:
        e = motion.of(model.along(b, cmath.exp(1j*math.radians(degrees))))[0]
        at = motion.of(model.on(b, spot))[0]
        normal = 1j*e/abs(e)
        column((name, "n"), [(b, at, normal, 0.0), (a, at, -normal, 0.0)])
        column((name, "m"), [(b, at, 0j, 1.0), (a, at, 0j, -1.0)])
    for a, b, c, ta, tb in sketch.gears:
        centres = [next(n for n in sketch.joints if n in sketch.links[k].joints and n in sketch.links[c].joints) for k in (a, b)]
        pa, pb = (motion.joint(n)[0] for n in centres)
        pitch, across = pa + (pb - pa)*ta/(ta + tb), 1j*(pb - pa)/abs(pb - pa)
        column(("gear", a, b), [(a, pitch, -across, 0.0), (b, pitch, across, 0.0)])
    cylinder = {}
    for m, d in enumerate(sketch.drives):
        if d["kind"] == "pin":
            column(("drive", m), [(d["link"], 0j, 0j, 1.0), (d["base"], 0j, 0j, -1.0)])
        elif d["kind"] == "slide":
            slide = next(s for s in sketch.slides if s[0] == d["at"])
            e = motion.of(model.along(d["link"], cmath.exp(1j*math.radians(slide[4]))))[0]
            at = motion.of(model.on(slide[2], slide[3]))[0]
            column(("drive", m), [(d["link"], at, e/abs(e), 0.0), (d["base"], at, -e/abs(e), 0.0)])
        else:
            (pb, pc), (b, c) = (motion.joint(n)[0] for n in d["at"]), d["at"]
            e = (pc - pb)/abs(pc - pb)
            cylinder[m] = e
            # it pushes on the first link of each joint's list
            column(("drive", m), [(members[c][0], pc, e, 0.0), (members[b][0], pb, -e, 0.0)])
    if len(columns) != size:
        return None
    matrix = np.array(columns).T
    right = np.zeros(3*count)
    for link in range(count):
        for at, force in applied[link]:
            right[3*link:3*link + 3] -= force.real, force.imag, unit*cross(at, force)
        right[3*link + 2] -= couples[link]
    scale = np.tile([1.0, 1.0, 1.0/unit], count)
    balance = matrix[3:]*scale[3:, None]
    width = np.max(np.abs(balance), axis=0)
    try:
        solution = np.linalg.solve(balance/width, right[3:]*scale[3:])/width
    except np.linalg.LinAlgError:
        return None
    whole = matrix @ solution                        # on the frame: by the linkage
    whole[:3] -= right[:3]
    value = dict(zip(names, solution))
    sure, either, extra = {}, {}, {}
    for m, q in enumerate(drive):
        sure["drive" if m == 0 else "drive%d" % (m + 1)] = q
        extra["drive%d" % m] = (q, value[("drive", m)])
    sure["frame_fx"], sure["frame_fy"], sure["frame_m"] = whole[:3]
    sure["kinetic"] = kinetic
    for name, links in members.items():
        on = {sketch.links[k].name: complex(value[(name, k, False)], value[(name, k, True)]) for k in links[1:]}
        first = -sum(on.values(), 0j)
        for m in cylinder_ends.get(name, []):
            away = cylinder[m] if name == sketch.drives[m]["at"][1] else -cylinder[m]
            push_on_pin = value[("drive", m)]*away
            on["-".join(sketch.drives[m]["at"])] = -push_on_pin
            # what the pin passes on to the first link is what the cylinder pushes and what the others take
            first += push_on_pin
        on[sketch.links[links[0]].name] = first
        for link, force in on.items():
            if len(on) == 2:
                either[name + "_f"] = force
            elif len(on) > 2:
                sure[name + "." + link + "_fx"], sure[name + "." + link + "_fy"] = force.real, force.imag
    for name, *_ in sketch.slides:
        either[name + "_n"], either[name + "_m"] = value[(name, "n")], value[(name, "m")]
    for a, b, *_ in sketch.gears:
        either[sketch.links[a].name + "-" + sketch.links[b].name + "_t"] = value[("gear", a, b)]
    largest = max([abs(f) for f in solution*width] + [1e-30])
    return sure, either, largest, extra, np.linalg.cond(balance/width)


# ---------------------------------------------------------------------------------------------------------------------------------
# the programs
# ---------------------------------------------------------------------------------------------------------------------------------

class Case:
    """A sketch with what the solver knows of it."""

    def __init__(self, seed, solver):
        self.seed, self.faults, self.beyond = seed, [], []
        draw = random.Random(seed)
        while True:
            try:
                self.sketch, self.rows, self.dyads = draw_sketch(draw)
                if len(self.rows) < 2:
                    continue
                self.model = Model(self.sketch, solver)
            except Unfit:
                continue
            zero = [0.0]*len(self.sketch.drives)
            reach, state, norm = self.model.follow(self.model.drawing(), zero, zero)
            if norm < 3.0e3 and np.max(np.abs(state[0] - self.model.start)) < 1e-9:
                break
        self.zero, self.state = zero, state
        self.title = "SKETCH %d" % seed
        self.found = [self.model.follow(state, zero, row) for row in self.rows]
        sure = lambda r: r[0] == 1.0 and r[2] < SINGULAR
        self.sound = all(sure(r) for r in self.found)

    def text(self, last, order):
        return self.sketch.text(self.rows, self.title, random.Random(order), last)

    def fault(self, kind, words):
        self.faults.append((kind, words))


class Output:
    """What a program printed on one case."""

    def __init__(self):
        self.csv, self.nine, self.listing, self.summary, self.status = [], [], [], [], None


def number(text):
    return float(text) if text else math.nan


def different(names):
    """Names of columns; of equal ones (two drives at one joint) the later with their number."""
    return [name if name not in names[:k] else "%s #%d" % (name, k) for k, name in enumerate(names)]


def run(programs, program, folder, cases, order):
    """One run on the cases in one file: exit status, messages, an Output for each (None: refused)."""
    path = os.path.join(folder, "sketches.nml")
    with open(path, "w", encoding="ascii") as file:
        for case in cases:
            file.write(case.text(case is cases[-1], case.seed*4 + order))
    stem = path[:-4] + ("" if program == "psalm" else "." + program)
    files = [stem + ("-%d" % (k + 1) if k else "") + ".csv" for k in range(len(cases))]
    for name in files + [stem + ".dev9"]:
        if os.path.exists(name):
            os.remove(name)
    try:
        done = subprocess.run(PATIENCE + [os.path.join(programs, program), path], capture_output=True, text=True, check=False,
                              timeout=NO_END)
    except subprocess.TimeoutExpired:
        return -1, "no end in %d seconds" % NO_END, None
    if done.returncode not in (0, 1) or not os.path.exists(stem + ".csv"):
        return done.returncode, done.stderr, None
    outputs = [Output() for _ in cases]
    tables = []
    for name in files:
        if os.path.exists(name):
            with open(name, encoding="ascii") as file:
                tables.append(file.read().strip().split("\n"))
    for output, table in zip(outputs, tables):
        names = different(table[0].split(","))
        output.csv = [dict(zip(names, map(number, line.split(",")))) for line in table[1:]]
    k, names = -1, None
    with open(stem + ".dev9", encoding="ascii") as file:
        for line in file:
            if line.startswith("# input"):
                k, names = k + 1, different(line[1:].split())
            elif line.startswith("# block"):
                names = None
            elif names and line.strip() and not line.startswith("#"):
                outputs[k].nine.append(dict(zip(names, map(float, line.split()))))
    by_title = {case.title: output for case, output in zip(cases, outputs)}
    for text, where in ((done.stdout, "listing"), (done.stderr, "summary")):
        now = None
        for line in text.split("\n"):
            if line.strip() in by_title:
                now = getattr(by_title[line.strip()], where)
            elif now is not None:
                now.append(line)
    if len(tables) != len(cases) or any(len(o.csv) != len(c.rows) for c, o in zip(cases, outputs)):
        return -1, "tables are missing", None
    return done.returncode, done.stderr, outputs


def differ_angle(a, b):
    return abs((a - b + 180.0) % 360.0 - 180.0)


ANGLES = ("angle", "between")
HEAD, COLUMN = 9, 15      # characters of the list of all outputs: numbers of positions, each column


def angular(sketch, column):
    kinds = {o[0]: o[1] for o in sketch.outputs}
    return column.endswith(".angle") or (kinds.get(column) in ANGLES)


def meets_dead_point(case, row):
    """Is the inverse without bound somewhere on the straight way from the drawing? Two motions cross there, as in a parallelogram: the
    solver goes on along one of them, and psalm stops."""
    norm_at = lambda part: case.model.follow(case.state, case.zero, [part*r for r in row])[2]
    parts = 400
    norms = [norm_at(k/parts) for k in range(parts + 1)]
    k = norms.index(max(norms))
    low, high, ratio = max(k - 1, 0)/parts, min(k + 1, parts)/parts, 0.5*(math.sqrt(5.0) - 1.0)
    for _ in range(50):
        one, two = high - ratio*(high - low), low + ratio*(high - low)
        if norm_at(one) > norm_at(two):
            high = two
        else:
            low = one
    return norm_at(0.5*(low + high)) > DEAD


def compare_positions(case, output):
    """Places and `closed` of CASE.csv; where the solver did not get straight from the drawing it tries other ways."""
    sketch, model = case.sketch, case.model
    worst = 0.0
    case.used = [None]*len(case.rows)
    for k, (row, line, found) in enumerate(zip(case.rows, output.csv, case.found)):
        reach, state, norm = found
        closed = line["closed"] == 1.0
        if reach < 1.0 or norm >= SINGULAR:
            if not closed:
                continue
            # a turn the other way, or from another position
            starts = [(case.state, case.zero, [r - math.copysign(360.0, r) if d["kind"] == "pin" and not sketch.gears else r
                                               for r, d in zip(row, sketch.drives)])] if len(row) == 1 else []
            starts += [(f[1], case.rows[m], row) for m, f in enumerate(case.found) if f[0] == 1.0 and m != k and f[2] < SINGULAR]
            for start in starts:
                reach, state, norm = model.follow(*start)
                if reach == 1.0 and norm < SINGULAR and at_places(case, state, line) < 1e-6:
                    break
            else:
                if not holds(case, line):
                    case.fault("positions", "row %d does not fulfil the sketch" % (k + 1))
                elif found[0] < 1.0 - 1e-9 and len(row) > 1:
                    case.beyond.append((k, found[0]))
                elif found[0] < 1.0 - 1e-9 and not far_away(case, line):
                    case.fault("unreached", "row %d is closed, but the motion ends at %.6f of the way" % (k + 1, found[0]))
                continue
        elif not closed:
            if meets_dead_point(case, row):
                continue
            kind = "first open" if len(sketch.drives) > 1 else "open"
            case.fault(kind, "row %d is open, but can be reached (norm of the inverse %.1e)" % (k + 1, norm))
            continue
        error = at_places(case, state, line)
        motion = Motion(model, state[0])
        for name, values in output_values(sketch, model, motion).items():
            if angular(sketch, name):
                error = max(error, math.radians(differ_angle(values[0], line[name]))*0.05)
            else:
                error = max(error, abs(values[0] - line[name])/SIZE)
        ratio = error/(EPSILON*(10.0 + norm))
        if ratio > MULTIPLE or not math.isfinite(ratio):
            finer = model.follow(case.state, case.zero, row, 0.002)
            if finer[0] == 1.0 and at_places(case, finer[1], line) < EPSILON*(10.0 + finer[2])*MULTIPLE:
                continue
            if holds(case, line):
                case.fault("assembly", "row %d: places differ by %.1e, norm of the inverse %.1e, but fulfil the sketch" % (k + 1, error, norm))
            else:
                case.fault("positions", "row %d: places differ by %.1e, norm of the inverse %.1e" % (k + 1, error, norm))
            continue
        worst = max(worst, ratio)
        case.used[k] = (state, norm)
    return worst


def at_places(case, state, line):
    motion = Motion(case.model, state[0])
    return max(abs(motion.joint(n)[0] - complex(line[n + ".x"], line[n + ".y"])/SIZE) for n in case.sketch.joints)


def far_away(case, line):
    """True if a joint is so far away, on slides almost parallel, that the solver does not get there."""
    return max(abs(line[name + axis]) for name in case.sketch.joints for axis in (".x", ".y")) > FAR


def holds(case, line):
    """Lengths of links at the places of a table's row."""
    sketch = case.sketch
    at = {n: complex(line[n + ".x"], line[n + ".y"]) for n in sketch.joints}
    wrong = 0.0
    for link in sketch.links:
        for a in link.joints:
            for b in link.joints:
                wrong = max(wrong, abs(abs(at[a] - at[b]) - abs(sketch.joints[a] - sketch.joints[b])))
    return wrong < 1e-7*SIZE


def compare_gaps(programs, folder, case):
    """Positions that close although no straight way leads there: psalm's proof must not get there either."""
    path = os.path.join(folder, "proof.nml")
    with open(path, "w", encoding="ascii") as file:
        file.write(case.text(True, case.seed*4).replace("&LIMITS", "&LIMITS IPROOF=2,"))
    listing = subprocess.run(PATIENCE + [os.path.join(programs, "psalm"), path], capture_output=True, text=True, check=False,
                             timeout=NO_END).stdout
    ends = {int(m.group(2)): m.group(1) for m in re.finditer(r"(DEAD POINT|UNDECIDED) ON THE WAY TO POSITION (\d+)", listing)}
    for k, way in case.beyond:
        if k + 1 not in ends:
            case.fault("unreached", "row %d is closed and proven, but the motion ends at %.6f of the way" % (k + 1, way))


def compare_verdicts(case, output, status):
    """Summary and exit status of a run of this case alone (status None: of several)."""
    opened = [k for k, line in enumerate(output.csv) if line["closed"] != 1.0]
    summary = " ".join(" ".join(output.summary).split())
    closes = re.search(r"Closes (over the full|over the whole|for|at (\d+) of (\d+))", summary)
    if opened:
        if closes and (closes.group(2) is None or closes.group(2) == closes.group(3)):
            case.fault("summary", "rows %s are open, the summary says '%s'" % (opened, closes.group(0)))
        if status == 0:
            case.fault("status", "rows %s are open, exit status 0" % opened)
    elif closes and closes.group(2) and int(closes.group(2)) != len(output.csv):
        case.fault("summary", "all rows are closed, the summary says '%s'" % closes.group(0))
    if not opened and status == 1 and not any("VIOLAT" in w.upper() or "DEAD POINT" in w.upper() for w in output.listing):
        case.fault("status", "all rows are closed, exit status 1: " + summary[:200])


def compare_tables(case, output):
    """Listing and device 9 with CASE.csv."""
    sketch = case.sketch
    if len(output.nine) != len(output.csv):
        case.fault("tables", "device 9 has %d rows" % len(output.nine))
        return
    # which output is the first in the file is random; loops list that one only
    for k, (nine, line) in enumerate(zip(output.nine, output.csv)):
        if nine["closed"] != line["closed"]:
            case.fault("closed on device 9", "row %d: closed %d on device 9, %d in the table" % (k + 1, nine["closed"], line["closed"]))
            continue
        if line["closed"] != 1.0:
            continue
        for name in nine:
            if name in line and name not in ("input", "closed") and nine[name] != line[name] and not math.isnan(line[name]):
                case.fault("device 9", "row %d: %s is %r on device 9, %r in the table" % (k + 1, name, nine[name], line[name]))
    heading = next((k for k, text in enumerate(output.listing)
                    if "ACTUAL" in text and "ACTUAL" not in text[:4] or text.startswith(" POSITION ")), None)
    if heading is None:
        case.fault("listing", "no table in the listing")
        return
    first = case.first_output
    columns = [n for n in output.csv[0] if n == first or n.startswith(first + ".")]
    dyads = any(n.startswith("actual") for n in output.nine[0])
    lines = output.listing[heading + 1:]
    lines = [text.split() for text in lines if text.strip()][:len(output.csv)]
    kind = next(o[1] for o in sketch.outputs if o[0] == first)
    offset = None
    for k, (nine, line) in enumerate(zip(output.nine, output.csv)):
        if line["closed"] != 1.0:
            continue
        if dyads:
            named = ["actual"] if "actual" in nine else ["actual_x", "actual_y"] + ["actual_angle"]*("actual_angle" in nine)
            if len(named) != len(columns):
                continue
            for name, column in zip(named, columns):
                gap = nine[name] - line[column]
                norm = case.used[k][1] if case.used[k] else SINGULAR
                if angular(sketch, column) or name == "actual_angle":
                    gap = differ_angle(gap, 0.0)
                elif kind == "slide":
                    # the listing has the length of the sliding arc, which may count the other way
                    length = nine[name] - line[column], nine[name] + line[column]
                    offset = length if offset is None else offset
                    gap = min(abs(a - b) for a, b in zip(length, offset))
                if not abs(gap) < EPSILON*(10.0 + norm)*MULTIPLE*SIZE:
                    case.fault("device 9", "row %d: %s is %r on device 9, %r in the table" % (k + 1, column, nine[name], line[column]))
            try:
                words = lines[k][1:1 + len(named)]
                printed = [float(w) for w in words]
            except (ValueError, IndexError):
                case.fault("listing", "row %d is not in the listing" % (k + 1))
                continue
            for name, value, word in zip(named, printed, words):
                if abs(value - nine[name]) > half_unit(word) and differ_angle(value, nine[name]) > 1e-4:
                    case.fault("listing", "row %d: %s is %r in the listing, %r on device 9" % (k + 1, name, value, nine[name]))
    compare_list(case, output, dyads and len(sketch.outputs) == 1 and len([n for n in output.csv[0] if n.startswith("input")]) == 1)


def half_unit(word):
    """Half a unit of the last digit of a number, as it is written, and a little more."""
    digits, _, power = word.partition("E")
    return 0.501*10.0**(int(power or 0) - len(digits.partition(".")[2]))


def compare_list(case, output, absent):
    """The list of all outputs with CASE.csv, column by column; it is absent where the list of loops has everything."""
    heading = next((k for k, text in enumerate(output.listing) if text.startswith(" POSITION ")), None)
    if heading is None:
        if not absent:
            case.fault("listing", "no list of all outputs")
        return
    head = output.listing[heading][HEAD:].rstrip("\n")
    heads = [head[k:k + COLUMN].strip() for k in range(0, len(head), COLUMN)]
    inputs = [n for n in output.csv[0] if n == "input" or n.startswith("input.")]
    outputs = [n for n in output.csv[0] if n.split(".")[0] in {o[0] for o in case.sketch.outputs} and n.split(".")[-1] != "desired"]
    names = inputs + outputs
    wanted = [("INPUT" if n in inputs else n)[:COLUMN - 1] for n in names]
    told = [h[:5] if n in inputs else h for h, n in zip(heads, names)]
    if told != wanted or len(heads) != len(names):
        case.fault("listing", "the list of all outputs has the columns %s for %s" % (heads, names))
        return
    for k, line in enumerate(output.csv):
        text = output.listing[heading + 1 + k].rstrip("\n")
        if text[:HEAD].strip() != str(k + 1):
            case.fault("listing", "row %d is not in the list of all outputs" % (k + 1))
            return
        printed = [text[i:i + COLUMN].strip() for i in range(HEAD, len(text), COLUMN)]
        if line["closed"] != 1.0:
            names_here = inputs
        else:
            names_here = names
            if len(printed) != len(names):
                case.fault("listing", "row %d has %d columns in the list of all outputs" % (k + 1, len(printed)))
                continue
        for name, value in zip(names_here, printed):
            number = math.nan if value == "-" else float(value)
            if not (abs(number - line[name]) <= half_unit(value) or math.isnan(number) and math.isnan(line[name])):
                case.fault("listing", "row %d: %s is %r in the list of all outputs, %r in the table" % (k + 1, name, value, line[name]))


def compare_rates(case, output):
    """Velocities, accelerations, forces of kalm."""
    sketch, model = case.sketch, case.model
    worst = [0.0, 0.0]
    signs = {}
    for k, (row, line) in enumerate(zip(case.rows, output.csv)):
        if case.used[k] is None:
            continue
        state, norm = case.used[k]
        if line["closed"] != 1.0:
            case.fault("kalm open", "row %d is open for kalm only" % (k + 1))
            continue
        derivatives = model.rates(state, row)
        if derivatives is None:
            continue
        v, w, by = derivatives
        motion = Motion(model, state[0], v, w)
        slow, fast = max(np.max(np.abs(v)), 1e-30), max(np.max(np.abs(w)), np.max(np.abs(v))**2, 1e-30)
        room = EPSILON*(10.0 + norm)*MULTIPLE
        room_v, room_a = room*(1.0 + norm)*slow, room*(1.0 + norm)*(fast + (1.0 + norm)*slow**2)

        def near(name, value, wanted, limit):
            wanted = complex(wanted) if isinstance(wanted, complex) else float(wanted)
            if not abs(value - wanted) <= limit:
                case.fault("rates", "row %d: %s is %r, should be %r, limit %.1e" % (k + 1, name, value, wanted, limit))
            worst[0] = max(worst[0], abs(value - wanted)/limit)

        for name in sketch.joints:
            _, velocity, acceleration = motion.joint(name)
            near(name + ".v", complex(line[name + ".vx"], line[name + ".vy"])/SIZE, velocity, room_v)
            near(name + ".a", complex(line[name + ".ax"], line[name + ".ay"])/SIZE, acceleration, room_a)
        values = output_values(sketch, model, motion)
        for name, value in values.items():
            # an angle of a short line, a distance that is nearly none: worse by as much
            poor = 40.0 if angular(sketch, name) else 1.0
            if not angular(sketch, name):
                value = [u/SIZE for u in value]
                near(name + ".v", line[name + ".v"]/SIZE, value[1], room_v*5)
                if abs(value[0]) > 0.02 or next(o[1] for o in sketch.outputs if o[0] == name.split(".")[0]) != "distance":
                    near(name + ".a", line[name + ".a"]/SIZE, value[2], room_a*5 + 1e3*slow**2*room)
            else:
                near(name + ".v", line[name + ".v"], value[1], poor*room_v)
                near(name + ".a", line[name + ".a"], value[2], poor*poor*room_a)
        for name, kind, at in sketch.outputs:
            if kind == "ratio":
                one, two = values[at[0]], values[at[1]]
                if abs(two[1]) > 1e-3*SIZE**(not angular(sketch, at[1])):
                    ratio = one[1]/two[1]
                    worse = 1.0 + abs(ratio) + 1/abs(two[1])
                    near(name, line[name], ratio, room_v*worse**2*1e4)
        if not sketch.masses:
            continue
        if math.isnan(line.get("drive", math.nan)):
            case.fault("forces", "row %d has no forces" % (k + 1))
            continue
        wanted = forces(sketch, model, state, derivatives)
        if wanted is None:
            continue
        sure, either, largest, extra, condition = wanted
        limit = 10.0*EPSILON*MULTIPLE*(10.0 + norm)*(10.0 + norm)*max(largest, 1.0)*(1.0 + condition*1e-2)
        arm = 5.0*SIZE*sketch.unit

        def agree(name, value, wanted, limit):
            wanted = complex(wanted) if isinstance(wanted, complex) else float(wanted)
            if not abs(value - wanted) <= limit:
                case.fault("forces", "row %d: %s is %r, should be %r, limit %.1e" % (k + 1, name, value, wanted, limit))
            worst[1] = max(worst[1], abs(value - wanted)/limit)

        for name, (one, two) in extra.items():
            if not abs(one - two) <= limit*max(arm, 1.0):
                case.fault("solver", "row %d: %s by virtual work %r, by equilibrium %r" % (k + 1, name, one, two))
        for name, value in sure.items():
            if name in line:
                agree(name, line[name], value, limit*max(arm, 1.0, abs(value)/max(largest, 1e-30)))
            elif not re.match(r"J\d+\.", name):
                case.fault("columns", "no column " + name)
        for name, value in either.items():
            if name[-2:] in ("_n", "_m"):
                if name not in line:
                    case.fault("columns", "no column " + name)
                    continue
                if name.endswith("_m") and not case.poses:
                    continue
                got = line[name]
            elif name[-2:] == "_t":
                one = name[:-2]
                pair = [one + "_fx", one + "_fy"]
                if pair[0] not in line:
                    a, b = one.split("-")
                    pair = [b + "-" + a + "_fx", b + "-" + a + "_fy"]
                got, value = abs(complex(line[pair[0]], line[pair[1]])), abs(value)
            else:
                got = complex(line[name + "x"], line[name + "y"]) if name + "x" in line else None
                if got is None:
                    case.fault("columns", "no column " + name)
                    continue
            # the sign is a convention, the same at all positions
            sign = signs.get(name)
            if sign is None and abs(value) > limit*1e3:
                sign = signs[name] = 1.0 if abs(got - value) <= abs(got + value) else -1.0
            agree(name, got*(sign or 1.0), value, limit*max(arm, 1.0) if sign else max(limit*2e3*max(arm, 1.0), 0))
    return worst


def stands(sketch, line):
    """True if the second output of the ratio hardly moves: the ratio is rounding."""
    name = next(o[2][1] for o in sketch.outputs if o[1] == "ratio")
    return abs(line[name + ".v"]) < 1e-6*(1.0 if angular(sketch, name) else SIZE)


def doubt_of_ratio(sketch, line, name, norm):
    """By how much a ratio of rates, or a rate of it, may differ in units of epsilon: it divides by a rate that may be small."""
    one, two = next(o[2] for o in sketch.outputs if o[1] == "ratio")
    unit = lambda output: 1.0 if angular(sketch, output) else SIZE
    slow = max(abs(value) for key, value in line.items() if key.endswith((".vx", ".vy")))/SIZE
    by = abs(line[two + ".v"])
    grows = abs(line[two + ".a"])/by
    doubt = slow*(unit(one) + abs(line["R"])*unit(two))/by
    if name != "R":
        doubt = doubt*grows + (1.0 + norm)*(abs(line[one + ".a"]) + abs(line["R"]*line[two + ".a"]))/by
    if name == "R.a":
        doubt *= 3.0*grows
    return (1.0 + norm)*doubt


def compare_orders(case, output, again):
    """The same sketch written in another order; `again` is kalm's, which knows rates."""
    for k, (one, two) in enumerate(zip(output.csv, again.csv)):
        if one["closed"] != two["closed"]:
            if k not in [row for row, _ in case.beyond]:
                case.fault("order", "row %d: closed %d, in another order %d" % (k + 1, one["closed"], two["closed"]))
            continue
        if case.used[k] is None:
            continue
        norm = case.used[k][1]
        most_force = max([abs(two[n]) for n in two if n.endswith(("_fx", "_fy", "_n"))] + [1e-30])
        for name, value in one.items():
            if name not in two or math.isnan(value) or name.split(".")[0] == "R" and stands(case.sketch, two):
                continue
            gap = abs(value - two[name])
            if name.startswith("crank_angle"):
                gap = min(gap, 360.0 - gap)
            if name.endswith(("_n", "_fx", "_fy", "_m")):
                if name.endswith("_m") and name != "frame_m":
                    continue                        # the foot of a slide is another one
                gap = min(gap, abs(value + two[name]))
                scale = max(most_force*(1 + norm), abs(value))*(SIZE if name == "frame_m" else 1.0)
            elif name.startswith(("drive", "kinetic")):
                scale = max(abs(value), most_force)*SIZE*(1 + norm)
            elif name.endswith((".ax", ".ay", ".a")):
                scale = max(abs(value), SIZE)*(1 + norm)**2*10
            elif name.endswith((".vx", ".vy", ".v")):
                scale = max(abs(value), SIZE)*(1 + norm)
            elif angular(case.sketch, name):
                gap, scale = differ_angle(value, two[name]), 1e3
            else:
                scale = max(abs(value), SIZE)
            if name.split(".")[0] == "R" and "R.v" in two:
                scale = max(scale, doubt_of_ratio(case.sketch, two, name, norm))
            if gap > EPSILON*(10.0 + norm)*MULTIPLE*scale:
                case.fault("order", "row %d: %s is %r, in another order %r" % (k + 1, name, value, two[name]))
                break


def assess(programs, folder, cases, counts, worst, both=True):
    """All checks of some cases. Those with an open position are runs of psalm by themselves: the exit status is one for all.

    both: kalm reads both orders; else it reads another than psalm."""
    sound = [case for case in cases if case.sound]
    for group in ([sound] if sound else []) + [[case] for case in cases if not case.sound]:
        assess_psalm(programs, folder, group, counts, worst)
    read = [case for case in cases if case.read]
    outputs = {}
    for order in (0, 1) if both else (1,):
        run_in_parts(programs, "kalm", folder, read, order, outputs)
    for case in read:
        one, two = outputs.get((case.seed, 0)), outputs.get((case.seed, 1))
        first = one if both else two
        if first:
            if first.status is not None:
                compare_verdicts(case, first, first.status)
            compare_tables_kalm(case, first)
            for k, ratio in enumerate(compare_rates(case, first)):
                worst[1 + k] = max(worst[1 + k], ratio)
        if one and two:
            compare_orders(case, one, two)
        if two:
            compare_orders(case, case.output, two)
    if both:
        assess_pages(programs, folder, read)


def run_in_parts(programs, program, folder, cases, order, outputs):
    """Runs of halves where a case is refused, down to the one it is; the exit status of one run of all."""
    if not cases:
        return None
    status, words, found = run(programs, program, folder, cases, order)
    if found is not None:
        for case, output in zip(cases, found):
            output.status = status if len(cases) == 1 else None
            outputs[(case.seed, order)] = output
    elif len(cases) > 1:
        half = len(cases)//2
        run_in_parts(programs, program, folder, cases[:half], order, outputs)
        run_in_parts(programs, program, folder, cases[half:], order, outputs)
    else:
        words = " ".join(words.replace(folder + "/", "").split())[:300]
        cases[0].fault("refused by " + program, "exit status %d, order %d: %s" % (status, order, words))
    return None if found is None else status


def assess_psalm(programs, folder, cases, counts, worst):
    outputs = {}
    status = run_in_parts(programs, "psalm", folder, cases, 0, outputs)
    for case in cases:
        output = case.output = outputs.get((case.seed, 0))
        case.read = output is not None
        if not case.read:
            counts["refused"] += 1
            continue
        case.first_output = first_of(case)
        case.poses = not any(n.startswith("actual") for n in output.nine[0]) if output.nine else True
        counts["poses" if case.poses else "loops"] += 1
        counts["rows"] += len(case.rows)
        counts["open"] += sum(line["closed"] != 1.0 for line in output.csv)
        worst[0] = max(worst[0], compare_positions(case, output))
        compare_verdicts(case, output, output.status)
        compare_tables(case, output)
        if case.beyond:
            compare_gaps(programs, folder, case)
            counts["beyond"] += len(case.beyond)
    if len(cases) > 1 and status and all(case.read and case.sound and not case.faults for case in cases):
        for case in cases:
            status, words, _ = run(programs, "psalm", folder, [case], 0)
            if status != 0:
                case.fault("status", "all rows are closed, exit status %d: %s" % (status, " ".join(words.split())[:200]))


def compare_tables_kalm(case, output):
    """Device 9 of kalm has the forces of CASE.kalm.csv."""
    for k, (nine, line) in enumerate(zip(output.nine, output.csv)):
        for name, value in nine.items():
            if name in line and name not in ("input", "closed") and value != line[name] and not math.isnan(line[name]):
                case.fault("device 9", "row %d: %s is %r on kalm's device 9, %r in the table" % (k + 1, name, value, line[name]))
                break


def read_pages(programs, folder, cases):
    """What the page of balm knows of each case, written in a third order; None: refused."""
    path = os.path.join(folder, "pages.nml")
    with open(path, "w", encoding="ascii") as file:
        for case in cases:
            file.write(case.text(case is cases[-1], case.seed*4 + 2))
    page = path[:-4] + ".html"
    if os.path.exists(page):
        os.remove(page)
    done = subprocess.run(PATIENCE + [os.path.join(programs, "balm"), path], capture_output=True, text=True, check=False, timeout=NO_END)
    if done.returncode not in (0, 1) or not os.path.exists(page):
        return None
    with open(page, encoding="utf-8") as file:
        found = re.search(r'<script type="application/json" id="data">(.*?)</script>', file.read(), re.S)
    data = json.loads(found.group(1))["cases"] if found else []
    return data if len(data) == len(cases) else None


def assess_pages(programs, folder, cases):
    """Pages of halves where a case is refused, down to the one it is."""
    if not cases:
        return
    pages = read_pages(programs, folder, cases)
    if pages is not None:
        for case, page in zip(cases, pages):
            compare_page(case, page)
    elif len(cases) > 1:
        assess_pages(programs, folder, cases[:len(cases)//2])
        assess_pages(programs, folder, cases[len(cases)//2:])
    else:
        cases[0].fault("page", "refused by balm")


def compare_page(case, page):
    """The page at the prescribed positions with CASE.csv."""
    at = page["prescribed"]
    if at["n"] != len(case.output.csv):
        case.fault("page", "%d positions of %d" % (at["n"], len(case.output.csv)))
        return
    places = {joint["name"]: k for k, joint in enumerate(page["joints"])}
    curves = {curve["name"].split(",")[0]: curve["prescribed"] for curve in page.get("curves", [])}
    compared = 0
    for k, line in enumerate(case.output.csv):
        beyond = k in [row for row, _ in case.beyond]
        if (at["closed"][k] == "1") != (line["closed"] == 1.0) and not beyond:
            case.fault("page", "row %d: closed %s on the page, %d in the table" % (k + 1, at["closed"][k], line["closed"]))
            return
        for drive, known in zip([n for n in line if n == "input" or n.startswith("input.")], page.get("drives", [])):
            if abs(known["prescribed"][k] - line[drive]) > PAGE*max(1.0, abs(line[drive])):
                case.fault("page", "row %d: %s is %r on the page, %r in the table" % (k + 1, drive, known["prescribed"][k], line[drive]))
                return
        if at["closed"][k] != "1" or case.used[k] is None:
            continue
        for name in case.sketch.joints:
            place = places.get(name)
            if place is None:
                case.fault("page", "joint %s is not on the page" % name)
                return
            gap = max(abs(at["x"][place][k] - line[name + ".x"]), abs(at["y"][place][k] - line[name + ".y"]))
            compared += 1
            if not gap <= SIZE*(PAGE + EPSILON*(10.0 + case.used[k][1])*MULTIPLE):
                case.fault("page", "row %d: %s is %.1e off the table" % (k + 1, name, gap))
                return
        for name, values in curves.items():
            if name not in line or values[k] is None or math.isnan(line[name]):
                continue
            gap = differ_angle(values[k], line[name]) if angular(case.sketch, name) else abs(values[k] - line[name])
            compared += 1
            if gap > max(SIZE, abs(line[name]))*(PAGE + EPSILON*(10.0 + case.used[k][1])*MULTIPLE):
                case.fault("page", "row %d: %s is %r on the page, %r in the table" % (k + 1, name, values[k], line[name]))
                return
    if not compared and any(used is not None for used in case.used):
        case.fault("page", "nothing of it was compared")


def first_of(case):
    """Name of the output that is written first."""
    text = case.text(True, case.seed*4)
    return re.search(r"ONAME='(\w+)'", text).group(1)


def work(programs, seeds, keep, library, both):
    """A batch: [(seed, faults)] of those that fail, counts, largest errors."""
    counts, worst, failed = Counter(), [0.0, 0.0, 0.0], []
    with tempfile.TemporaryDirectory(dir=os.path.dirname(library)) as folder:
        cases = [Case(seed, load_solver(library)) for seed in seeds]
        assess(programs, folder, cases, counts, worst, both)
    for case in cases:
        if not case.faults:
            continue
        failed.append((case.seed, case.faults))
        os.makedirs(keep, exist_ok=True)
        with open(os.path.join(keep, "sketch_%d.nml" % case.seed), "w", encoding="ascii") as file:
            for kind, words in case.faults[:8]:
                file.write("! %s: %s\n" % (kind, words))
            file.write(case.text(True, case.seed*4))
    return failed, counts, worst


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=COUNT)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--batch", type=int, default=25)
    parser.add_argument("--seconds", type=float, default=math.inf, help="no batch is begun after so many")
    parser.add_argument("--keep", default=os.path.join(TOP, "build", "test", "sketches"))
    parser.add_argument("--quiet", action="store_true", help="failures are counted and written, not printed")
    arguments = parser.parse_args()
    counts, worst, classes = Counter(), [0.0, 0.0, 0.0], Counter()
    failed = done = 0
    began = time.time()
    seeds = [arguments.only] if arguments.only is not None else range(arguments.seed, arguments.seed + arguments.count)
    batches = [seeds[k:k + arguments.batch] for k in range(0, len(seeds), arguments.batch)]
    if arguments.only is None and (arguments.seed, arguments.count) == (1, COUNT):
        batches.append(ONCE_WRONG)
    both = lambda batch: arguments.only is not None or batch is ONCE_WRONG or batch[0]//arguments.batch % BOTH_ORDERS == 0
    with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
        library = compile_solver(folder)
        pool = multiprocessing.Pool(arguments.jobs) if arguments.jobs > 1 else None
        waiting = []
        while batches or waiting:
            if batches and time.time() - began > arguments.seconds:
                batches = []
                continue
            if pool is None:
                batch = batches.pop(0)
                found, many, largest = work(arguments.programs, batch, arguments.keep, library, both(batch))
            else:
                while batches and len(waiting) < 2*arguments.jobs:
                    batch = batches.pop(0)
                    waiting.append((batch, pool.apply_async(work, (arguments.programs, batch, arguments.keep, library, both(batch)))))
                batch, answer = waiting.pop(0)
                found, many, largest = answer.get()
            done += len(batch)
            counts += many
            worst = [max(pair) for pair in zip(worst, largest)]
            failed += len(found)
            for seed, faults in found:
                classes["; ".join(sorted({kind for kind, _ in faults}))] += 1
                if not arguments.quiet:
                    print("FAILED: sketch %d: %s: %s" % (seed, *faults[0]), flush=True)
        if pool:
            pool.close()
    took = time.time() - began
    busy = sum(resource.getrusage(who).ru_utime + resource.getrusage(who).ru_stime
               for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    print("%d sketches (%d in loops, %d in poses), %d positions (%d open, %d beyond a gap), %.1f ms a sketch, %.1f of the processor" % (
        done, counts["loops"], counts["poses"], counts["rows"], counts["open"], counts["beyond"], 1e3*took/max(done, 1),
        1e3*busy/max(done, 1)))
    print("largest errors, in epsilon times condition: places %.1f, rates %.1f, forces %.1f (limit %.0f)" % (
        worst[0], worst[1]*MULTIPLE, worst[2]*MULTIPLE, MULTIPLE))
    for kinds, many in classes.most_common():
        print("%6d  %s" % (many, kinds))
    print("%d passed, %d failed" % (done - failed, failed))
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
