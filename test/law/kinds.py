#!/usr/bin/env python3
"""Every study with every kind of mechanism: it has a result, or says why not.

usage: test/law/kinds.py BIN [--update] [--only STUDY[/KIND]] [--show]   (BIN: directory with the programs)

A study is some items added to the case of each kind. Positions, rates and the power of the drives are held against closed forms and
differences of them; of the other studies the figures must be there, finite, and the same where one linkage is written in two ways (by
loops and as a sketch, with wheels and with a drive geared to the first). Where a study does not apply the program must refuse it with one of
the messages in REASONS, each of which has a footnote of the table in doc/guide/which.md. --update writes that table; without it the table must be
what was found. --show prints what the programs say to the fields of --only. Last line: N passed, N failed.
"""
import argparse
import cmath
import csv
import functools
import math
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from results import cases_of, counterweights
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MANUAL = os.path.join(TOP, "doc", "guide", "which.md")
BEGIN, END = "<!-- written by test/law/kinds.py --update -->\n", "<!-- end of what test/law/kinds.py writes -->\n"
GRAVITY = -9.81j


# ---- linkages: joints from the values of the drives, counted from the drawing -----------------------------------------------------

def meet(p, r, q, s, drawn):
    """The joint at the distance r from p and s from q, on that side of the line where `drawn` (p, joint, q) has it."""
    line = q - p
    along = (abs(line)**2 + r*r - s*s)/(2.0*abs(line))
    side = 1.0 if ((drawn[2] - drawn[0]).conjugate()*(drawn[1] - drawn[0])).imag > 0.0 else -1.0
    return p + line/abs(line)*complex(along, side*math.sqrt(r*r - along*along))


def carried(drawn, a, b, joint, at):
    """A joint of the link that has a and b."""
    return at[a] + (drawn[joint] - drawn[a])*(at[b] - at[a])/(drawn[b] - drawn[a])


def dyad(drawn, at, a, joint, b):
    return meet(at[a], abs(drawn[joint] - drawn[a]), at[b], abs(drawn[joint] - drawn[b]), [drawn[n] for n in (a, joint, b)])


def turned(drawn, pivot, joint, degrees):
    return drawn[pivot] + (drawn[joint] - drawn[pivot])*cmath.exp(1j*math.radians(degrees))


def root(gap, value):
    """x with gap(x) = value, followed from x = 0, where gap is 0."""
    x, steps = 0.0, max(1, math.ceil(abs(value)/2.0))
    for k in range(1, steps + 1):
        for _ in range(60):
            slope = (gap(x + 1e-4) - gap(x - 1e-4))/2e-4
            step = (gap(x) - value*k/steps)/slope
            x -= max(-5.0, min(5.0, step))
            if abs(step) < 1e-13*max(1.0, abs(x)):
                break
    return x


FOUR = dict(A=0j, B=-4 + 25j, C=40 + 80j, D=90 + 5j, P=20 + 95j)
FLOAT = dict(FOUR, M=-2 + 5j, N=20 + 50j)
SIX = dict(A=0j, B=-25 + 45j, C=35 + 55j, D=75 + 0j, P=10 + 80j, E=120 + 70j, F=127 + 74j)
FIVE = dict(A=0j, B=9 + 12j, P=30 + 55j, G=68 + 6j, E=60 + 0j)
ARM = dict(A=1.5j, B=0.5 + 1j, C=2.6 + 3.4j, D=2.9 + 3.9j, E=5.2 + 3.2j, F=4.6 + 3.9j, G=5 + 3.7j, H=6 + 1.9j, I=6.6 + 1.6j,
           J=6.3 + 2.3j, K=5.9 + 2.4j, P=7 + 0.5j)
SLANT = cmath.rect(50.0, math.radians(70.0))
THREE = dict(A=0j, D=80 + 0j, F=40 - 20j, B=SLANT, C=80 + SLANT, G=40 - 20j + SLANT, P=30 + 30j + SLANT)


def longer(drawn, a, joint, b, scale, carried_too=""):
    """The drawing put together again with a longer link from `joint` to b; what the link of a and `joint` carries comes along."""
    at = dict(drawn)
    at[joint] = meet(drawn[a], abs(drawn[joint] - drawn[a]), drawn[b], scale*abs(drawn[joint] - drawn[b]), [drawn[n] for n in (a, joint, b)])
    for n in carried_too:
        at[n] = drawn[a] + (drawn[n] - drawn[a])*(at[joint] - at[a])/(drawn[joint] - drawn[a])
    return at


def four_bar(turn, scale=1.0, drawn=None):
    """Of a sketch with other joints too. Its follower C D is longer by `scale`."""
    drawn = longer(drawn or FOUR, "B", "C", "D", scale, "PN" if drawn and "N" in drawn else "P")
    at = dict(drawn, B=turned(drawn, "A", "B", turn))
    at["C"] = dyad(drawn, at, "B", "C", "D")
    for joint in "PN":
        if joint in drawn:
            at[joint] = carried(drawn, "B", "C", joint, at)
    if "M" in drawn:
        at["M"] = carried(drawn, "A", "B", "M", at)
    return at


def floating(stroke, scale=1.0):
    """By a cylinder from crank to coupler."""
    def gap(turn):
        at = four_bar(turn, scale, FLOAT)
        return abs(at["N"] - at["M"]) - abs(FLOAT["N"] - FLOAT["M"])
    return four_bar(root(lambda turn: gap(turn) - gap(0.0), stroke - gap(0.0)), scale, FLOAT)


def left_rocker(turn, scale, x):
    """Of the six-bar: how far its left rocker has turned when the rod, longer by `scale`, reaches the crank; sought from x on."""
    rod, end = abs(SIX["E"] - SIX["P"]), turned(SIX, "F", "E", turn)

    def gap(left):
        return abs(end - four_bar(left, drawn=SIX)["P"]) - rod*scale

    for _ in range(60):
        step = gap(x)*2e-4/(gap(x + 1e-4) - gap(x - 1e-4))
        x -= max(-2.0, min(2.0, step))
        if abs(step) < 1e-12:
            break
    return x


@functools.cache
def followed(twos, scale):
    """The left rocker followed along the turn of the crank E, by two degrees at a time."""
    return left_rocker(2.0*twos, scale, followed(twos - (1 if twos > 0 else -1), scale) if twos else 0.0)


def six_bar(turn, scale=1.0):
    x = left_rocker(turn, scale, followed(int(turn/2.0), scale))
    return dict(four_bar(x, drawn=SIX), E=turned(SIX, "F", "E", turn))


def five_bar(turn, scale=1.0):
    drawn = longer(FIVE, "B", "P", "G", scale)
    at = dict(FIVE, B=turned(FIVE, "A", "B", turn), G=turned(FIVE, "E", "G", -turn))
    at["P"] = dyad(drawn, at, "B", "P", "G")
    return at


def arm(*strokes, scale=1.0):
    """Each cylinder and two arms are a triangle."""
    drawn = longer(ARM, "K", "I", "J", scale, "P")

    def swing(pivot, fixed, moved, stroke, at):
        """Of the link with `moved` about `pivot`: its turn against the drawing by the cylinder from `fixed`."""
        third = meet(at[pivot], abs(ARM[moved] - ARM[pivot]), at[fixed], abs(ARM[moved] - ARM[fixed]) + stroke,
                     [ARM[n] for n in (pivot, moved, fixed)])
        return (third - at[pivot])/(ARM[moved] - ARM[pivot])
    at = dict(drawn)
    for pivot, fixed, moved, stroke, joints in (("A", "B", "C", strokes[0], "CDE"), ("E", "D", "F", strokes[1], "FGHK"),
                                                ("H", "G", "J", strokes[2], "J")):
        turn = swing(pivot, fixed, moved, stroke, at)
        at.update({n: at[pivot] + (ARM[n] - ARM[pivot])*turn for n in joints})
    at["I"] = dyad(drawn, at, "J", "I", "K")
    at["P"] = carried(drawn, "K", "I", "P", at)
    return at


def parallelogram(turn, scale=1.0):
    shift = SLANT*(cmath.exp(1j*math.radians(turn)) - 1.0)
    at = {n: z + (shift if n in "BCGP" else 0.0) for n, z in THREE.items()}
    at["P"] = at["B"] + scale*(at["P"] - at["B"])
    return at


# ---- kinds of mechanism ---------------------------------------------------------------------------------------------------------

class Kind:
    """A linkage written in one way. `roles`: the link that is driven, one that moves with two others, one that is last, the frame: name,
    and the joints of the line from which places on it are counted."""

    def __init__(self, name, head, linkage, model, roles, joints, **more):
        self.name, self.head, self.linkage, self.model, self.roles, self.joints = name, head, linkage, model, roles, joints
        self.motion = more.get("motion", "IKIN=15")
        self.few = more.get("few", "NDES=6, DELT=0.0,10.0,20.0,30.0,40.0,50.0")
        self.sought = more.get("sought")               # the length that searches and settings are about
        self.reference = more.get("reference", "")     # what &METHOD needs besides
        self.arcs = more.get("arcs", False)            # written as loops: roles are arcs
        self.unit = more.get("unit", 1e-3)             # metres
        self.speeds = more.get("speeds", (20.0,))      # of the drives, rad/s or lengths a second
        self.turns = more.get("turns", True)           # the first drive turns, its inputs are degrees
        self.ratios = more.get("ratios", ())           # of the drives after the first to it
        self.pose = more.get("pose", " ".join(map(str, roles["coupler"]))).split()     # a link of P and its first two joints
        self.drawn = model(*[0.0]*len(self.speeds))

    def text(self, groups="", motion=None, outputs="'point P'", linkage="", method=""):
        words = "" if self.arcs and outputs == "'point P'" else " &OUTPUTS OUTPUT=%s &END\n" % outputs
        return "%s\n%s%s &METHOD %s%s%s &END\n%s" % (self.head.upper(), self.linkage % linkage, words, self.reference,
                                                     self.motion if motion is None else motion, method, groups)

    def place(self, item, *roles):
        """Places on links: of item M MNAME, or MLINK and MLOOP, from the start of the arc."""
        if self.arcs:
            return "%sLINK=%s, %sLOOP=%d*1" % (item, ",".join("%d" % -self.roles[r][0] for r in roles), item, len(roles))
        return "%sNAME=%s" % (item, ",".join("'%s %s %s'" % self.roles[r] for r in roles))

    def joint(self, item, which):
        """One of the first three joints: the end of the crank, the joint after it, the output point."""
        if self.arcs:
            return "%sLINK=%d, %sLOOP=%d" % (item, (1, 2, 0)[which], item, (1, 1, 0)[which])
        return "%s='%s'" % ("RJNT" if item == "R" else item + "NAME", self.joints[which])

    def link(self, item, role):
        return "%sLINK=%d, %sLOOP=1" % (item, self.roles[role][0], item) if self.arcs else "%sNAME='%s'" % (item, self.roles[role][0])

    def with_length(self, factor):
        """The sought length otherwise than drawn."""
        a, b = self.sought
        return ", LENP='%s %s', LENV=%.17g" % (a, b, factor*self.sought_length())

    def sought_length(self):
        return abs(self.drawn[self.sought[1]] - self.drawn[self.sought[0]])

    def line(self, role):
        """Joints of the line of a role."""
        return self.roles[role][1:]


def chain(joints, links, drives, more=""):
    return " &CHAIN JNT=%s, JX=%s, JY=%s,\n  LNAME=%s,\n  LNK=%s%s%%s &END\n &DRIVES %s &END\n" % (
        ",".join("'%s'" % n for n in joints), ",".join("%.17g" % z.real for z in joints.values()),
        ",".join("%.17g" % z.imag for z in joints.values()), ",".join("'%s'" % n for n in links),
        ",".join("'%s'" % n for n in links.values()), more, drives)


def polar(a, b):
    return abs(b - a), math.degrees(cmath.phase(b - a))


def four_bar_loops(factor=1.0):
    lengths = [polar(FOUR[a], FOUR[b]) for a, b in ("AB", "BC", "CD", "DA", "BP")]
    return (" &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1,\n  ARCL=%.17g,%.17g,%.17g,%.17g, GAMA=3*0.0,%.17g,\n"
            "  NOUTLK=-2, NOUTLP=1, OUTLK=%.17g, OUTANG=%.17g%%s &END\n" % (
                lengths[0][0], lengths[1][0], factor*lengths[2][0], lengths[3][0], lengths[3][1], lengths[4][0],
                lengths[4][1] - lengths[1][1]))


def roles(*words):
    return {role: tuple(word.split()) for role, word in zip(("input", "coupler", "follower", "frame"), words)}


FOUR_ROLES = roles("crank A B", "coupler B C", "rocker C D", "frame A D")
FIVE_LINKS = dict(frame="A E", crank="A B", rod="B P", other="P G", second="G E")
FIVE_ROLES = roles("crank A B", "rod B P", "other P G", "frame A E")


def braced(joints):
    return Kind("braced", "Parallelogram, KOVER", chain(joints, dict(frame="A D F", crank="A B", coupler="B C G P", rocker="C D",
                                                                     third="F G"), "DRIVE='A'", ", KOVER=1"), parallelogram, FOUR_ROLES,
                "BCP", sought="BP",
                few="NDES=6, DELT=-30.0,-20.0,-10.0,0.0,10.0,20.0")


KINDS = [
    Kind("loops", "Four-bar, &LINKS", four_bar_loops(), four_bar,
         {k: (n, *v[1:]) for (k, v), n in zip(FOUR_ROLES.items(), (1, 2, 3, -4))}, "BCP", arcs=True, sought="CD",
         reference="CRNKI=%.17g, " % polar(FOUR["A"], FOUR["B"])[1]),
    Kind("sketch", "Four-bar, sketch", chain(FOUR, dict(frame="A D", crank="A B", coupler="B C P", rocker="C D"), "DRIVE='A'"), four_bar,
         FOUR_ROLES, "BCP", sought="CD"),
    Kind("group", "Six-bar, larger group", chain(SIX, dict(frame="A D F", left="A B", coupler="B C P", rocker="C D", rod="P E",
                                                           crank="E F"), "DRIVE='F'"), six_bar,
         roles("crank F E", "coupler B C", "rocker C D", "frame A D"), "ECP", sought="PE"),
    Kind("wheels", "Five-bar, wheels", chain(FIVE, FIVE_LINKS, "DRIVE='A'", ", GEARA='crank', GEARB='second', GCARR='frame', "
                                             "GTA=30.0, GTB=30.0"), five_bar, FIVE_ROLES, "BGP", sought="PG"),
    Kind("geared", "Five-bar, geared drive", chain(FIVE, FIVE_LINKS, "DRIVE='A','E', RATIO=0.0,-1.0"), five_bar, FIVE_ROLES, "BGP",
         sought="PG", ratios=(-1.0,)),
    Kind("drives", "Excavator, three drives", chain(ARM, dict(frame="A B", boom="A C D E", stick="E F G H K", rocker="H J", pusher="J I",
                                                              bucket="K I P"), "DRIVE='B C','D F','G J', DELT2=0.0,0.0,0.1,0.1,-0.1, "
                                                    "DELT3=0.0,0.1,0.0,-0.1,0.1, DSPEED=0.0,0.05,-0.04"), arm,
         roles("boom A C", "stick E F", "bucket K P", "frame A B"), "CEP", motion="NDES=5, DELT=0.0,0.1,0.2,-0.1,0.0",
         few="NDES=5, DELT=0.0,0.1,0.2,-0.1,0.0", sought="JI", unit=1.0, pose="bucket K I", speeds=(0.1, 0.05, -0.04), turns=False),
    Kind("cylinder", "Four-bar, floating cylinder", chain(FLOAT, dict(frame="A D", crank="A B M", coupler="B C P N", rocker="C D"),
                                                          "DRIVE='M N'"), floating, FOUR_ROLES, "BCP", sought="CD",
         motion="NDES=7, DELT=-3.0,-2.0,-1.0,0.0,1.0,2.0,3.0", few="NDES=6, DELT=-3.0,-2.0,-1.0,0.0,1.0,2.0", turns=False),
    braced(THREE),
]
TWINS = (("sketch", "loops"), ("geared", "wheels"))    # one linkage, written in two ways


# ---- what a program said --------------------------------------------------------------------------------------------------------

class Run:
    def __init__(self, program, text, work, options=(), name="case"):
        self.work, self.name = work, name
        with open(os.path.join(work, name + ".nml"), "w", encoding="utf-8") as f:
            f.write(text)
        done = subprocess.run([os.path.join(BIN, program), *options, "--output-dir", work, name + ".nml"], cwd=work, capture_output=True,
                              text=True, timeout=300, check=False)
        self.status, self.out, self.err = done.returncode, done.stdout, done.stderr

    def file(self, ending):
        path = os.path.join(self.work, self.name + ending)
        if not os.path.exists(path):
            return ""
        with open(path, encoding="utf-8") as f:
            return f.read()

    def table(self, ending=".csv"):
        """Columns by name; the first output is called output however the linkage is written."""
        rows = list(csv.reader(self.file(ending).split("\n\n")[0].splitlines()))
        return {re.sub(r"^(point_P|pose_P_[a-z]+)\b", "output", name): [float(v or "nan") for v in column]
                for name, *column in zip(*rows)}

    def columns(self, pattern, ending=".csv"):
        return {n: v for n, v in self.table(ending).items() if re.fullmatch(pattern, n)}

    def block(self, name, ending=".dev9", words=None):
        """Numbers of the rows of a block of device 9, or those words of each row."""
        part = self.file(ending).split("# block %s\n" % name)
        rows = [r.split() for r in part[1].split("\n\n", 1)[0].splitlines() if not r.startswith("#")] if len(part) > 1 else []
        return {name: [float(w) for row in rows for w in (row if words is None else [row[i] for i in words]) if is_number(w)]}

    def listed(self, *labels, text=None):
        """Numbers on the lines that begin with each label."""
        lines = (self.out if text is None else text).splitlines()
        return {label: [number(w) for line in lines if line.strip().startswith(label)
                        for w in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:[DE][+-]?\d+)?(?![\w.])|NaN", line.strip()[len(label):])]
                for label in labels}

    def message(self):
        found = re.search(r"\d: error: (.*)", self.err)
        return found[1] if found else self.err.strip().split("\n")[0]


def is_number(word):
    try:
        float(word)
        return True
    except ValueError:
        return False


def number(word):
    return float(word.replace("D", "E"))


# ---- studies --------------------------------------------------------------------------------------------------------------------

STUDIES = []


class Study:
    def __init__(self, title, program, options, build):
        self.title, self.program, self.options, self.build = title, program, options, build
        self.name = build.__name__
        self.figures = None                     # of a run: its figures, to be finite and the same for twins
        self.close = 1e-6                       # relative difference of the figures of twins
        self.of_drive = False                   # they are of the first drive: where a second is geared to it, it bears its own part
        self.proven = None                      # further checks of a run
        self.instead = lambda run: run.message() # why there is no result, though the status is not 2; empty: there is one
        STUDIES.append(self)


def study(title, program="psalm", *options):
    return lambda build: Study(title, program, options, build)


def item(name, *values):
    return " &%s %s &END\n" % (name, ", ".join(values))


def size(k, millimetres):
    """A length of so many millimetres, of the arm of metres instead, in the unit of the kind."""
    return "%.6g" % (millimetres*(1.0 if k.unit != 1.0 else 0.01))


MASSES = (("input", 0.5, 10.0, 1e-4), ("coupler", 0.8, 20.0, 3e-4), ("follower", 0.6, 15.0, 2e-4))
LOAD = 20.0 - 10.0j


def masses(k):
    return item("MASSES", "NMASS=3", k.place("M", *[m[0] for m in MASSES]), "MASS=0.5,0.8,0.6", "MDIST=" + ",".join(
        size(k, m[2]) for m in MASSES), "MINERT=1E-4,3E-4,2E-4", "UNITL=%g" % k.unit, "GRAVY=-9.81")


def loads(k):
    return item("LOADS", "NLOAD=1", k.place("L", "follower"), "LFX=20.0", "LFY=-10.0")


def spring(k):
    return item("SPRING", "NSPRNG=1", k.place("A", "frame"), k.place("B", "coupler"), "STIFF=200.0", "SFREE=" + size(k, 40.0))


def rated(k):
    return item("RATES", "SPEED=%g" % k.speeds[0])


def increments(k):
    """Values of the drives at every position."""
    if k.motion == "IKIN=15":
        return [(15.0*i,) for i in range(24)]
    first = [float(v) for v in k.motion.split("DELT=")[1].split(",")]
    if k.name != "drives":
        return [(v,) for v in first]
    return list(zip(first, (0.0, 0.0, 0.1, 0.1, -0.1), (0.0, 0.1, 0.0, -0.1, 0.1)))


def history(k, values, psalm=False):
    """Joints at times -2 to 2 steps from a position, and the step; psalm, which reads no SPEED, moves the first drive by one a second."""
    dt = 1e-4 if k.turns else 2e-3
    rates = [math.degrees(v) if k.turns else v for v in k.speeds]
    if psalm:
        rates[0] = math.degrees(1.0) if k.turns else 1.0
    return [k.model(*[v + s*dt*r for v, r in zip(values, rates)]) for s in (-2, -1, 0, 1, 2)], dt


def first_rate(v, dt):
    return (8.0*(v[3] - v[1]) - (v[4] - v[0]))/(12.0*dt)


def second_rate(v, dt):
    return (16.0*(v[3] + v[1]) - (v[4] + v[0]) - 30.0*v[2])/(12.0*dt*dt)


def ways(k, parts):
    """Joints at the positions, and where there is one drive between them."""
    values = increments(k)
    parts = 1 if k.name == "drives" else parts
    for one, other in zip(values, values[1:]):
        for n in range(parts):
            yield k.model(*[a + (b - a)*n/parts for a, b in zip(one, other)])
    yield k.model(*values[-1])


def near(found, wanted, tolerance):
    return abs(found - wanted) <= tolerance         # False of NaN


@study("positions of all joints and outputs", "psalm", "--json")
def positions(_):
    return ""


positions.figures = lambda k, run: run.columns(r"closed|output\..*")


def are_closed_forms(k, run):
    table = run.table()
    for n, values in enumerate(increments(k)):
        at = k.model(*values)
        for joint in "P" if k.arcs else at:
            name = "output" if joint == "P" else joint
            gap = abs(complex(table[name + ".x"][n], table[name + ".y"][n]) - at[joint])
            yield "joint %s at position %d" % (joint, n + 1), gap < 1e-8*abs(at["P"]), gap


positions.proven = are_closed_forms


@study("every arc (KTHETA)")
def arcs(_):
    return item("LIMITS", "KTHETA=1")


arcs.figures = lambda k, run: {"arcs": [number(w) for w in re.findall(r"\n INPUT +-?\d\S*(?: .*)?\n(?:  LINE \S+ \S+)? +(-?\d\S*)", run.file(".dev8"))]}


@study("every degree (IPLOT)")
def degrees(_):
    return item("LIMITS", "IPLOT=1")


degrees.figures = lambda k, run: {"plot": drawn_inputs(k, [v for row in plotted(run) for v in row[:4]], 4, 0)}


def plotted(run):
    """Rows of every degree: input, closed, x, y, and what else there is."""
    blocks = run.file(".dev9").split("\n\n\n")
    return [[float(w) for w in line.split()] for line in blocks[1].splitlines() if line and line[0] != "#"] if len(blocks) > 1 else []


def drawn_inputs(k, numbers, row, *places):
    """Rows of numbers with their inputs, at these places of a row, from the drawing in a turn: those of arcs count from the x axis."""
    zero = polar(FOUR["A"], FOUR["B"])[1] if k.arcs else 0.0
    return [round((v - zero) % 360.0, 6) % 360.0 if k.turns and i % row in places else v for i, v in enumerate(numbers)]


def are_on_the_way(k, run):
    """Places of every degree, or of 361 even steps of a range."""
    rows = plotted(run)
    first = [v[0] for v in increments(k)]
    whole = k.turns and k.motion == "IKIN=15"
    yield "361 rows, or 360", len(rows) in (360, 361), len(rows)
    for n, row in enumerate(rows):
        value = n if whole else min(first) + (max(first) - min(first))*n/(len(rows) - 1)
        at = k.model(value)["P"]
        yield "step %d" % n, near(complex(row[2], row[3]), at, 1e-7*abs(at)), (row, at)


degrees.proven = are_on_the_way


@study("condition numbers, bounds of the error (ICOND)")
def condition(_):
    return item("LIMITS", "ICOND=1")


def condition_column(_, run):
    lines = run.file(".dev9").split("\n\n")[0].splitlines()
    heads = [line[1:].split() for line in lines if line.startswith("# input")]
    if not heads or "condition" not in heads[0]:
        return {}
    return {"condition": [float(line.split()[heads[0].index("condition")]) for line in lines if line and line[0] != "#"]}


condition.figures = condition_column
condition.close = 0.2                           # of one linkage other dimensions may be given: directions of frame and wheels


@study("summary: range of the motion, extremes of the output")
def summary(_):
    return ""


summary.figures = lambda k, run: {} if summary.instead(run) else {"ranges": run.listed("Output ", text=run.err)["Output "]}
summary.instead = lambda run: re.search(r"(Closes +at .* positions)|$", run.err)[0]
summary.close = 1e-4


def are_ranges(k, run):
    """Ranges of x and y: over a whole turn where there is one, else over the range of the inputs or at the positions."""
    if k.motion == "IKIN=15":
        places = [k.model(0.5*n)["P"] for n in range(720)]
    else:
        places = [at["P"] for at in ways(k, 200)]
    for name, part in (("x", lambda z: z.real), ("y", lambda z: z.imag)):
        own = [min(map(part, places)), max(map(part, places))]
        told = re.search(r"%s (-?[\d.E+-]+) to (-?[\d.E+-]+)" % name, run.err)
        yield "range of %s" % name, told and all(near(float(a), b, 2e-4*max(map(abs, own))) for a, b in zip(told.groups(), own)), (
            told and told.groups(), own)


summary.proven = are_ranges


@study("least transmission angle (TRMIN)")
def transmission(_):
    return item("LIMITS", "TRMIN=20.0")


transmission.figures = lambda k, run: {"least": run.listed("Transmission angle", text=run.err)["Transmission angle"][:1]}
transmission.close = 1e-4


@study("all assemblies (--assemblies)", "psalm", "--assemblies")
def assemblies(_):
    return ""


assemblies.instead = lambda run: re.search(r"(--assemblies lists .*)|$", run.err)[0]
assemblies.figures = lambda k, run: run.block("assemblies")


@study("several outputs, ratios of rates", "psalm", "--json")
def outputs(_):
    return ""


outputs.outputs = "'point P','distance A P','angle A P','ratio distance_A_P angle_A_P'"
outputs.figures = lambda k, run: run.columns(r"distance_A_P|angle_A_P|ratio.*")


def are_values(k, run):
    table = run.table()
    for n, values in enumerate(increments(k)):
        at, dt = history(k, values, psalm=True)
        lines = [a["P"] - a["A"] for a in at]
        own = {"distance_A_P": abs(lines[2]), "angle_A_P": math.degrees(cmath.phase(lines[2]))}
        turn = first_rate([cmath.phase(z/lines[2]) for z in lines], dt)
        for name, value in own.items():
            gap = table[name][n] - value
            gap -= 360.0*round(gap/360.0) if name == "angle_A_P" else 0.0
            yield "%s at position %d" % (name, n + 1), near(gap, 0.0, 1e-7), (table[name][n], value)
        ratio = [v[n] for c, v in table.items() if c.startswith("ratio")][0]
        own = first_rate([abs(z) for z in lines], dt)/turn
        yield "ratio at position %d" % (n + 1), near(ratio, own, 1e-4*(abs(own) + abs(lines[2]))), (ratio, own)


outputs.proven = are_values


@study("velocities, accelerations", "kalm", "--json")
def rates(k):
    return rated(k)


rates.figures = lambda k, run: run.columns(r"output\.[xy]\.[va]", ".kalm.csv")


def are_differences(k, run):
    table = run.table(".kalm.csv")
    for n, values in enumerate(increments(k)):
        at, dt = history(k, values)
        for order, rate in (("v", first_rate), ("a", second_rate)):
            own = rate([a["P"] for a in at], dt)
            found = complex(table["output.x." + order][n], table["output.y." + order][n])
            yield "%s at position %d" % ("velocity" if order == "v" else "acceleration", n + 1), near(
                found, own, 1e-5*max(abs(own), abs(at[2]["P"])*max(abs(v) for v in k.speeds)**(1 if order == "v" else 2))), (found, own)


rates.proven = are_differences


@study("forces of drives, joints, frame", "kalm", "--json")
def forces(k):
    return rated(k) + masses(k) + loads(k) + spring(k)


forces.figures = lambda k, run: run.columns(r"drive|frame_.*|kinetic" if k.name in ("loops", "sketch") else r"frame_f.|kinetic", ".kalm.csv")


def is_power(k, run):
    """The drives' power is that which masses, weight, load and spring take."""
    table = run.table(".kalm.csv")
    for n, values in enumerate(increments(k)):
        at, dt = history(k, values)
        power, scale = 0.0, 0.0
        for role, mass, distance, inertia in MASSES:
            a, b = k.line(role)
            places = [(v[a] + float(size(k, distance))*(v[b] - v[a])/abs(v[b] - v[a]))*k.unit for v in at]
            turns = [cmath.phase((v[b] - v[a])/(at[2][b] - at[2][a])) for v in at]
            parts = (mass*(first_rate(places, dt).conjugate()*(second_rate(places, dt) - GRAVITY)).real,
                     inertia*first_rate(turns, dt)*second_rate(turns, dt))
            power, scale = power + sum(parts), scale + sum(map(abs, parts))
        loaded = (first_rate([v[k.line("follower")[0]]*k.unit for v in at], dt).conjugate()*LOAD).real
        stretch = [(abs(v[k.line("coupler")[0]] - v[k.line("frame")[0]]) - float(size(k, 40.0)))*k.unit for v in at]
        stored = first_rate([100.0*s*s for s in stretch], dt)
        power, scale = power - loaded + stored, scale + abs(loaded) + abs(stored)
        speeds = list(k.speeds) + [r*k.speeds[0] for r in k.ratios]
        drives = ["drive"] + ["drive%d" % i for i in range(2, len(speeds) + 1)]
        metre = 1.0 if k.turns else k.unit
        found = sum(table[d][n]*v*metre for d, v in zip(drives, speeds))
        yield "power of the drives at position %d" % (n + 1), near(found, power, 1e-4*scale), (found, power)


forces.proven = is_power


@study("friction in a joint", "kalm", "--json")
def friction(k):
    return rated(k) + masses(k) + loads(k) + item("FRICTN", "NFRIC=1", k.joint("F", 1), "FMU=0.1", "FRAD=" + size(k, 5.0))


friction.figures = forces.figures


@study("motion from torque, flywheel (&MOTOR)", "kalm")
def motor(k):
    return rated(k) + masses(k) + item("MOTOR", "MTORQ=5.0", "MSPEED=30.0", "FLYWHL=0.02", "FLUCT=0.05", "NTURN=2")


motor.figures = lambda k, run: run.listed("INERTIA AT THE CRANK", "MEAN SPEED", "FLYWHEEL FOR THE FLUCTUATION")


@study("tolerances, sample of linkages (&TOLER)")
def tolerances(k):
    return item("TOLER", "TOLLEN=" + size(k, 0.05), "TOLANG=0.02", "NTRIAL=100")


def tolerance_bands(_, run):
    part = run.file(".dev9").split("# tolerances: linear bands", 1)
    return {"bands": [float(w) for line in part[-1].split("\n\n", 1)[0].splitlines()[1:] for w in line.split()[1:6]]} if len(part) > 1 else {}


tolerances.figures = tolerance_bands
tolerances.close = 0.3                          # the frame's place is a dimension of sketches, not of loops


def has_effect(k, run):
    """One of the effects listed is that of the sought length, by differences."""
    step, length = 1e-4, k.sought_length()
    most = max(abs(k.model(*v, scale=1.0 + step)["P"] - k.model(*v, scale=1.0 - step)["P"]) for v in increments(k))
    most *= float(size(k, 0.05))/(2.0*step*length)
    effects = [abs(number(v)) for v in re.findall(r"^ LENGTH .* (\S+) +\d+$", run.out, re.M)]
    rows = run.file(".dev9").split("# tolerances", 1)[-1].split("\n\n", 1)[0].splitlines()[1:]
    yield "a band at every position", len(rows) == len(increments(k)), len(rows)
    for n, (row, values) in enumerate(zip(rows, increments(k))):
        v = [float(w) for w in row.split()]
        at = k.model(*values)["P"]
        yield "middle of the band at position %d" % (n + 1), near(complex(v[2], v[9]), at, 1e-8*abs(at)), (v[2], v[9], at)
        yield "sample and linear band at position %d" % (n + 1), all(0.65 < math.sqrt(3.0)*v[i + 6]/v[i + 2] < 1.4 for i in (2, 9)), v
    yield "no length from a joint to itself", not re.search(r"^ LENGTH (\S+) \1 ", run.out, re.M), ""
    yield "effect of the length %s" % "".join(k.sought), any(near(e, most, 1e-4*most) for e in effects), (most, effects)


tolerances.proven = has_effect


@study("a compensating member (ADJUST)")
def adjustment(k):
    return item("TOLER", "TOLLEN=" + size(k, 0.05), "ADJUST=1")


adjustment.figures = lambda k, run: run.block("adjustment")
adjustment.close = 0.3


BAND_COLUMNS = (3, 4, 5)        # of allocation_bands: band, used, price


@study("the cheapest tolerances within a band (&ALLOC)")
def allocation(k):
    return item("ALLOC", "ALBAND=" + size(k, 0.5))


allocation.figures = lambda k, run: run.block("allocation_bands", words=BAND_COLUMNS)


def keeps_the_band(k, run):
    """The deviation of the sought length alone, by differences, is within the band; the bands are used up to the bound of the cost."""
    step, length, band = 1e-4, k.sought_length(), float(size(k, 0.5))
    name = "OF ARC 3 IN LOOP 1" if k.arcs else "(?:%s %s|%s %s)" % (*k.sought, *k.sought[::-1])
    found = [number(v) for v in re.findall(r"^ LENGTH %s +(\S+)" % name, run.out, re.M)]
    yield "one tolerance of the length %s" % "".join(k.sought), len(found) == 1 and found[0] > 0.0, found
    for n, values in enumerate(increments(k)):
        change = (k.model(*values, scale=1.0 + step)["P"] - k.model(*values, scale=1.0 - step)["P"])/(2.0*step*length)
        for part in (change.real, change.imag):
            yield "band at position %d" % (n + 1), abs(part)*sum(found) < (1.0 + 1e-6)*band, (part, found, band)
    bands, used, _ = zip(*zip(*[iter(run.block("allocation_bands", words=BAND_COLUMNS)["allocation_bands"])]*len(BAND_COLUMNS)))
    yield "no band is left", all(u < (1.0 + 1e-9)*b for u, b in zip(used, bands)), max(used)
    yield "a band is full", max(u/b for u, b in zip(used, bands)) > 1.0 - 1e-6, max(used)


allocation.proven = keeps_the_band


@study("an adjustable dimension (&SWEEP)")
def sweep(k):
    length = k.sought_length()
    which = "SWLINK=3, SWLOOP=1" if k.arcs else "SWJNT='%s %s'" % tuple(sorted(k.sought, key=lambda joint: joint == "P"))
    return item("SWEEP", which, "SWLOW=%.9g" % (0.99*length), "SWHIGH=%.9g" % (1.01*length))


sweep.figures = lambda k, run: {n: drawn_inputs(k, v, 5, 1) for n, v in run.block("sweep", words=range(5)).items()}


def are_settings(k, run):
    rows = run.block("sweep", words=(0, 1, 2, 3, 4))["sweep"]
    rows = [rows[i:i + 5] for i in range(0, len(rows), 5)]
    values = increments(k)
    yield "five settings", len(rows) == 5*len(values), len(rows)
    for n, row in enumerate(rows):
        at = k.model(*values[n % len(values)], scale=0.99 + 0.005*(n//len(values)))["P"]
        yield "setting %d, position %d" % (n//len(values) + 1, n % len(values) + 1), row[2] == 1 and near(
            complex(row[3], row[4]), at, 1e-8*abs(at)), (row, at)


sweep.proven = are_settings


@study("the motion proven between the positions (IPROOF)")
def proof(_):
    return item("LIMITS", "IPROOF=2")


proof.figures = lambda k, run: {"width": [b - a for a, b in zip(*[iter(run.block("limits", words=(1, 2))["limits"])]*2)]}
proof.close = 1e-9


@study("extremes of the outputs, proven")
def extremes(_):
    return item("LIMITS", "IPROOF=2")


extremes.figures = lambda k, run: run.block("extremes", words=(3, 4, 6, 7))


def are_bounds(k, run):
    """No sampled value of x and y is beyond what is proven, and some come near it."""
    rows = re.findall(r"^(?:output|point_P\.)_?([xy]|point_[xy]) \S+ \S+ (\S+) \S+ \S+ \S+ (\S+)", run.file(".dev9"), re.M)
    places = [at["P"] for at in ways(k, 15 if k.motion == "IKIN=15" else 40)]
    yield "x and y are there", len(rows) == 2, rows
    for name, low, high in rows:
        own = [z.real if name.endswith("x") else z.imag for z in places]
        room = (0.5 if k.name == "drives" else 2e-3)*(max(own) - min(own))
        yield "bounds of %s" % name, float(low) <= min(own) + 1e-9*abs(min(own)) and max(own) - 1e-9*abs(max(own)) <= float(high) and (
            min(own) - float(low) < room and float(high) - max(own) < room), (low, high, min(own), max(own))


extremes.proven = are_bounds


@study("all dead points, dwells and ratio of velocities, proven")
def dwells(_):
    return item("LIMITS", "IPROOF=2", "DWELL=0.5")


dwells.outputs = lambda k: "'point P'" if k.arcs else "'angle %s %s'" % k.line("follower")
dwells.figures = lambda k, run: {"turning": sorted(drawn_inputs(k, [
    float(v) for v in re.findall(r"^turning \S+ \S+ (\S+)", run.file(".dev9"), re.M)], 1, 0)),
                                 "ratio": [float(v) for v in re.findall(r"^velocity_ratio\S* .*", run.file(".dev9"), re.M)[:1]
                                           for v in v.split()[3:-1]]} # behind the figures is the name


def proven_ways(k):
    """Ways of the inputs that are proven: where each begins, and the direction in which places on it count. Of one drive places are its
    inputs from the drawing, of several drives 2.25 is a quarter of the way to position 3, from the nearest position before it."""
    values = increments(k)
    if k.name != "drives":
        first = [v[0] for v in values]
        return [(min(first), (0.0,), (1.0,), max(first))]
    legs = []
    for n, to in enumerate(values[1:], 1):
        start = min([(0.0,)*len(to), *reversed(values[:n])], key=lambda v: sum((a - b)**2 for a, b in zip(v, to)))
        legs.append((float(n), tuple(a - n*(b - a) for a, b in zip(start, to)), tuple(b - a for a, b in zip(start, to)), n + 1.0))
    return legs


def are_dead_points(k, run):
    """Dead points, velocity ratios and dwells of the angle of the follower, by differences and bisection."""
    line = k.line("follower")
    rows = re.findall(r"^%s (\S+) (\S+) (\d)" % ("turning 1 3" if k.arcs else r"output 0 [01]"), run.file(".dev9"), re.M)
    found = [tuple(map(float, row)) for row in rows]
    limits = [float(w) for row in re.findall(r"^closes (\S+) (\S+)", run.file(".dev9"), re.M) for w in row]
    ends = [v[0] for v in increments(k)]
    zero = 0.0 if k.name == "drives" else min(limits) - min(ends)
    own, least, most = [], math.inf, -math.inf
    for low, base, by, high in proven_ways(k):
        def turn(place, other):
            """How much the follower turns from one place to another."""
            a, b = (k.model(*[o + x*d for o, d in zip(base, by)]) for x in (place, other))
            return math.degrees(cmath.phase((b[line[1]] - b[line[0]])/(a[line[1]] - a[line[0]])))
        step = (high - low)/240.0
        h = 1e-3*step
        rate = lambda x: turn(x - h, x + h)/(2.0*h)
        places = [low + h + (high - low - 2.0*h)*n/240.0 for n in range(241)]
        rates = [rate(x) for x in places]
        least, most = min(least, *rates), max(most, *rates)
        for x, y, a, b in zip(places, places[1:], rates, rates[1:]):
            if (a > 0.0) == (b > 0.0):
                continue
            while y - x > 1e-5*step:
                middle = 0.5*(x + y)
                x, y = (middle, y) if (rate(middle) > 0.0) == (a > 0.0) else (x, middle)
            own.append(x)
            for _, start, stop in ((w, float(u) - zero, float(v) - zero) for w, u, v in re.findall(
                    r"DWELL, .* AT (\S+): (\S+) TO (\S+)", run.out) if abs(float(w) - zero - x) < step):
                for end, out in ((start, -1.0), (stop, 1.0)):
                    inside = end <= low + h or end >= high - h
                    yield "the dwell ends at %g" % end, abs(turn(x, end)) <= 0.5 + 1e-7 and (
                        inside or abs(turn(x, end + 0.01*out*step)) > 0.5), (x, end, turn(x, end))
    if not k.arcs and not own:
        yield "no dead point, no dwell", "HAS NO DEAD POINT" in run.out, run.out
    yield "as many dead points", len(found) == len(own), (found, own)
    for (low, high, reverses), x in zip(sorted(found), sorted(own)):
        near_enough = 1e-4*(1.0 if k.name == "drives" else max(ends) - min(ends))
        yield "dead point at %g" % x, near(0.5*(low + high) - zero, x, near_enough) and high - low < 1e-8*(abs(x) + 1.0) and reverses == 1.0, (
            low, high, reverses, x)
    if k.arcs or k.name == "drives":
        return
    unit = 1.0 if k.turns else math.radians(1.0)
    for low, high in re.findall(r"^velocity_ratio\S* \S+ \S+ (\S+) \S+ \S+ \S+ (\S+)", run.file(".dev9"), re.M):
        room = 2e-2*(most - least)*unit
        yield "velocity ratio", (float(low) <= least*unit + 1e-6*room and most*unit - 1e-6*room <= float(high) and
                                 least*unit - float(low) < room and float(high) - most*unit < room), (low, high, least*unit, most*unit)
    yield "there is a velocity ratio", "velocity_ratio" in run.file(".dev9"), ""


dwells.proven = are_dead_points


@study("regions at the positions (&CONSTR)")
def regions(k):
    return item("CONSTR", "NREGN=1", "RKIND=3", k.joint("R", 1), "RPLACE=%s,%s,%s" % (size(k, 900.0), size(k, 900.0), size(k, 10.0)))


regions.figures = lambda k, run: {"margin": [number(v) for v in re.findall(r"^ REGION 1, .* (\d\S*) +\S+$", run.out, re.M)]}


def is_distance(k, run):
    """From the joint to the edge of the region, at the position where it is least."""
    centre, radius = (1.0 + 1.0j)*float(size(k, 900.0)), float(size(k, 10.0))
    joint = k.joints[1]
    own = min(abs(k.model(*v)[joint] - centre) - radius for v in increments(k))
    found = regions.figures(k, run)["margin"][0]
    yield "least distance from the region", near(found, own, 1e-6*abs(own)), (found, own)


regions.proven = is_distance


def is_distance_on_the_way(k, run):
    centre, radius = (1.0 + 1.0j)*float(size(k, 900.0)), float(size(k, 10.0))
    own = min(abs(at[k.joints[1]] - centre) - radius for at in ways(k, 60))
    found = margins.figures(k, run)["margin"][0]
    yield "least distance over the range", near(found, own, 1e-5*abs(own)), (found, own)


@study("widths of links (NSEG)")
def widths(k):
    ends = "SLINK=-3,3, SLOOP=1,1" if k.arcs else "SJNT='%s %s'" % k.line("follower")
    return item("CONSTR", "NSEG=1", ends, "SWIDTH=" + size(k, 4.0), "NREGN=1", "RKIND=3", "RSEG=1",
                "RPLACE=%s,%s,%s" % (size(k, 900.0), size(k, 900.0), size(k, 10.0)))


widths.figures = regions.figures


@study("margins over the range (IRANGE)")
def margins(k):
    return item("CONSTR", "IRANGE=1", "NREGN=1", "RKIND=3", k.joint("R", 1),
                "RPLACE=%s,%s,%s" % (size(k, 900.0), size(k, 900.0), size(k, 10.0)))


margins.figures = regions.figures
margins.proven = is_distance_on_the_way


@study("margins and clearances, proven (IRANGE)")
def proven_margins(k):
    return margins.build(k)


proven_margins.figures = lambda k, run: {n: drawn_inputs(k, v, 7, 5) for n, v in run.block("clearance", words=range(7)).items()}


@study("counterweights, complete balance (&BALANC)", "muscle", "--json")
def balance(k):
    return rated(k) + masses(k) + item("BALANC", "NWEIGH=2", k.place("W", "input", "follower"), "WREACH=" + size(k, 200.0), "TOLF=1.0",
                                       "TOLW=1.0")


def balance_figures(_, run):
    found = counterweights(cases_of(os.path.join(run.work, run.name + ".muscle.json"))[0]) if run.file(".muscle.json") else {}
    return {"before": [found["before"][n]["rms"] for n in ("force", "moment")] if "before" in found else []}


balance.figures = balance_figures


@study("springs (&SPRNGS)", "muscle", "--json")
def springs(k):
    return rated(k) + masses(k) + item("SPRNGS", "NSFIND=1", k.place("P", "frame"), k.place("Q", "follower"), "SFLOW=" + size(k, 50.0),
                                       "SFHIGH=" + size(k, 100.0), "SKMAX=5000.0")


springs.figures = lambda k, run: {n: drawn_inputs(k, v, 3, 0) for n, v in run.block("spring_load", ".muscle.dev9").items()}
springs.of_drive = True


@study("vibration of a link (&ESTIM, &VIBR)", "ssics")
def vibration(k):
    beam = "MOD=207E9, %sRHO=7850.0, %sDEPTH=0.004, %sWIDTH=0.01"
    return (rated(k) + item("MASSES", "NMASS=1", k.place("M", "coupler"), "MASS=0.5", "UNITL=%g" % k.unit) +
            item("ESTIM", "NESTIM=1", k.link("E", "follower"), "E" + beam % ("E", "E", "E")) +
            item("VIBR", k.link("V", "follower"), "V" + beam % ("V", "V", "V"), "VZETA=0.01"))


vibration.figures = lambda k, run: run.block("response", ".ssics.dev9")


@study("a link of beam elements (&FLEX)", "ssics")
def elements(k):
    role = k.roles["follower"]
    end = "YLINK=%d, YLOOP=1" % role[0] if k.arcs else "YNAME='%s %s'" % (role[0], role[2])
    return (rated(k) + item("MASSES", "NMASS=1", k.place("M", "coupler"), "MASS=0.5", "UNITL=%g" % k.unit) +
            item("FLEX", k.place("X", "follower"), end, "XMOD=207E9", "XRHO=7850.0", "XDEPTH=0.004", "XWIDTH=0.01", "XZETA=0.01",
                 "NXPNT=64"))


elements.figures = lambda k, run: run.block("flexible_stresses", ".ssics.dev9")


@study("a flexible drive (&DRIVEL)", "ssics")
def drive(k):
    return rated(k) + masses(k) + item("DRIVEL", "DSTIF=500.0", "DDAMP=0.1")


drive.figures = lambda k, run: run.block("drive_response", ".ssics.dev9")


@study("clearance of a joint (&CLEAR)", "bridge")
def clearance(k):
    return rated(k) + masses(k) + item("CLEAR", k.joint("C", 1), "CDIAM=" + size(k, 0.01), "CREST=0.5")


clearance.figures = lambda k, run: run.block("minima", ".bridge.dev9")
clearance.close = 1e-4


@study("a cam that drives it (&CAM)", "calm")
def cam(k):
    zero = polar(FOUR["A"], FOUR["B"])[1] if k.arcs else 0.0       # the input of a sketch counts from the drawing
    rise = 20.0 if k.turns else float(size(k, 2.0))
    roller = "NFOLLK=1, NFOLLP=1" if k.arcs else "FOLJNT='%s'" % k.joints[0]
    at = k.drawn[k.joints[0]]
    reach = float(size(k, 90.0))
    return item("CAM", "KOUT=0", "NSEG=4", "SEGEND=100.0,160.0,260.0,360.0", "OUT0=%.12g" % zero,
                "SEGOUT=%.12g,%.12g,%.12g,%.12g" % (zero + rise, zero + rise, zero, zero), "LAW='MODSINE','DWELL','MODSINE','DWELL'",
                roller, "RROLL=" + size(k, 5.0), "XCAM=%.9g" % (at.real + 0.8*reach), "YCAM=%.9g" % (at.imag - 0.6*reach), "ALFMAX=85.0")


cam.figures = lambda k, run: run.columns(r"roller_[xy]|profile_[xy]", ".calm.csv")


@study("forces of the cam (CAMRPM)", "calm")
def cam_forces(k):
    return cam.build(k).replace("KOUT=0", "KOUT=0, CAMRPM=60.0, CAMWID=0.01") + rated(k) + masses(k)


cam_forces.figures = lambda k, run: run.block("contact", ".calm.dev9")


def is_power_of_cam(k, run):
    """The cam's force times the speed of the roller along it is the power that the masses take."""
    table, forces = run.table(".calm.csv"), run.block("contact", ".calm.dev9")["contact"]
    zero = polar(FOUR["A"], FOUR["B"])[1] if k.arcs else 0.0
    speed, joint = 2.0*math.pi, k.joints[0]
    start, reach = k.drawn[joint], float(size(k, 90.0))
    centre = start + complex(0.8, -0.6)*reach
    shown = 0
    for n, angle in enumerate(table["cam_angle"]):
        force = forces[3*n + 1]
        q = [table[c][n] for c in ("input", "input1", "input2", "input3")]
        if n % 12 or abs(q[1]) < 1e-3*max(map(abs, table["input1"])):
            continue
        dt = 1e-3
        drives = [q[0] - zero + (math.degrees(1.0) if k.turns else 1.0)*(q[1]*x + q[2]*x*x/2.0 + q[3]*x**3/6.0)
                  for x in (s*dt*speed for s in (-2, -1, 0, 1, 2))]
        at = [k.model(v) for v in drives]
        power, scale = 0.0, 0.0
        for role, mass, distance, inertia in MASSES:
            a, b = k.line(role)
            places = [(v[a] + float(size(k, distance))*(v[b] - v[a])/abs(v[b] - v[a]))*k.unit for v in at]
            turns = [cmath.phase((v[b] - v[a])/(at[2][b] - at[2][a])) for v in at]
            parts = (mass*(first_rate(places, dt).conjugate()*(second_rate(places, dt) - GRAVITY)).real,
                     inertia*first_rate(turns, dt)*second_rate(turns, dt))
            power, scale = power + sum(parts), scale + sum(map(abs, parts))
        roller = complex(table["roller_x"][n], table["roller_y"][n])
        touched = centre + complex(table["profile_x"][n], table["profile_y"][n])*cmath.exp(1j*math.radians(angle))
        push = (roller - touched)/abs(roller - touched)
        found = force*(push.conjugate()*first_rate([v[joint]*k.unit for v in at], dt)).real
        shown += 1
        yield "the roller is at its joint at cam angle %g" % angle, near(roller, at[2][joint], 1e-7*reach), (roller, at[2][joint])
        yield "power of the cam at %g degrees" % angle, near(found, power, 1e-4*scale), (found, power, scale)
    yield "there are angles at which it moves", shown > 5, shown


cam_forces.proven = is_power_of_cam


def targets(k, factor=1.0, kinds="point P"):
    """Desired values of the first output that the drawing has at a few positions."""
    values = [(float(v),) for v in k.few.split("DELT=")[1].split(",")]
    if k.name == "drives":
        values = increments(k)
    at = [k.model(*v) for v in values]
    line = "BP" if k.arcs else k.pose[1:]
    text = ", DESX=%s, DESY=%s" % tuple(",".join("%.15g" % part(a["P"]) for a in at) for part in (lambda z: z.real, lambda z: z.imag))
    if kinds == "pose":
        text += ", DESANG=%s" % ",".join("%.15g" % polar(a[line[0]], a[line[1]])[1] for a in at)
    return text


def sought(k, groups="SOLVER='LSQ', NSTART=4", outputs="'point P'", method="", wanted=None, more=""):
    """A search for the length that the case has wrong by a hundredth."""
    length = k.sought_length()
    low, high = "%.9g" % (0.9*length), "%.9g" % (1.1*length)
    wanted = targets(k) if wanted is None else wanted
    search = item("SEARCH", groups) if groups else ""
    # the dyad of its bucket is nearly straight
    if k.name == "drives" and "LIMITS" not in more:
        search += item("LIMITS", "TANGLE=89.0")
    if k.name == "braced":
        return braced(dict(THREE, P=THREE["B"] + 1.01*(THREE["P"] - THREE["B"]))).text(
            search + more, k.few, outputs, ", VARY='B P', VLOW=%s, VHIGH=%s" % (low, high), wanted + method)
    if k.arcs:
        k = Kind(k.name, k.head, four_bar_loops(1.01), k.model, k.roles, k.joints, arcs=True, sought=k.sought, reference=k.reference)
        return k.text(item("LIMITS", "LIMVAL=1", "OPLOW=" + low, "OPHIGH=" + high) + search + more, k.few, method=wanted + ", IVA=0,0,1,0" +
                      method)
    return k.text(search + more, k.few, outputs, ", VARY='%s %s', VLOW=%s, VHIGH=%s" % (*k.sought, low, high) + k.with_length(1.01),
                  wanted + method)


def found_again(k, run):
    """The data set found has the drawing's length: its output is the desired one."""
    again = Run("psalm", run.file(".dev7"), run.work, ("--json",), "again")
    table, at = again.table(), None
    values = increments(k) if k.name == "drives" else [(float(v),) for v in k.few.split("DELT=")[1].split(",")]
    for n, v in enumerate(values):
        at = k.model(*v)["P"]
        found = complex(table["output.x"][n], table["output.y"][n]) if "output.x" in table else cmath.nan
        yield "output of the linkage found at position %d" % (n + 1), near(found, at, 2e-4*abs(at)), (found, at)


def search_study(title, **how):
    def enter(build):
        made = Study(title, "psalm", ("--json",), build)
        made.whole = lambda k: sought(k, **{n: v(k) if callable(v) else v for n, v in how.items()})
        made.proven = found_again
        return made
    return enter


@search_study("search, least squares (&SEARCH)")
def search(_):
    """Points."""


@search_study("search, simplex of the thesis", groups="SOLVER='SIMPLEX'", method=", NITER=3000, FMIN=1E-12, SMALL=1E-9")
def simplex(_):
    """Points."""


@search_study("search, an algorithm of NLopt", groups="SOLVER='LD_SLSQP', NSTART=2")
def nlopt(_):
    """Points."""


@search_study("search, free timing (IFREE)", method=", IFREE=1")
def timing(_):
    """Points."""


@search_study("search, poses as targets", outputs=lambda k: "'pose P %s'" % k.pose[0], wanted=lambda k: targets(k, kinds="pose"),
              method=lambda k: ", MOTION=4" if k.arcs else "")
def poses(_):
    """Poses."""


@search_study("search within regions at the positions", more=lambda k: regions.build(k))
def search_regions(_):
    """Points."""


@search_study("search, constraints over the range (IRANGE)", more=lambda k: margins.build(k))
def search_range(_):
    """Points."""


@study("pictures: SVG, page, DXF", "balm")
def pictures(_):
    return item("DXF", "FLAT=1", "PIN=2.0", "WIDTH=6.0")


pictures.figures = lambda k, run: {n: [float(len(run.file(n)) > 500)] for n in (".svg", ".html", ".dxf", ".flat.dxf")}


@study("curves (--curves)", "balm", "--curves")
def curves(_):
    return ""


curves.figures = lambda k, run: {n: [float(len(run.file(n)) > 500)] for n in (".curves.svg",)}


# ---- why a study does not apply -------------------------------------------------------------------------------------------------

# what the message has, and the footnote; the first that fits counts
REASONS = (
    (r"how forces divide between them depends on the stiffness", "Constraints in excess bear what the stiffness of the links gives them, "
     "which is not known here."),
    (r"IPROOF proves nothing where more constraints hold|\(KOVER\) fit exact lengths only", "Links in excess fit exact lengths only: of numbers that are rounded nothing "
     "can be proven."),
    (r"no transmission angle \(it is that of two links", "The groups of this linkage have no transmission angle, which is that of a dyad; "
     "the margins of &CONSTR and the summary say how far they are from a dead point."),
    (r"3 drives of their own, but 1 cam", "Each drive of its own needs a cam of its own; calm makes one or two."),
    (r"a crank that turns; (the input of this linkage slides|this sketch has 3 drives)", "What is asked is of a crank that turns."),
    (r"Closes +at .* of 5 positions|between the positions of several drives", "At the positions only: between those of several drives there "
     "is no one way."),
    (r"--assemblies lists|belongs to the sketch of a group &CHAIN", "&LINKS has one output (MOTION), and the assembly of its signs."),
    (r"meet with the lengths they have and no others", "Links that brace others meet with the lengths they have and with no others."),
    (r"how far groups are from a dead point is found here at samples", "Clearances are proven; how far its group is from a dead point is found at samples "
     "of the range."),
)


def fields_of(only):
    name, _, column = only.partition("/")
    return [(s, k) for s in STUDIES for k in KINDS if name in ("", s.name) and column in ("", k.name)]


def examine(field, show=0):
    """Status, figures, what the program says in place of a result, and checks of a field."""
    what, kind = field
    if hasattr(what, "whole"):
        text = what.whole(kind)
    elif hasattr(what, "outputs"):
        text = kind.text(what.build(kind), outputs=what.outputs(kind) if callable(what.outputs) else what.outputs)
    else:
        text = kind.text(what.build(kind))
    with tempfile.TemporaryDirectory() as work:
        run = Run(what.program, text, work, what.options)
        figures, checks = {}, []
        instead = run.message() if run.status > 1 else ""
        if not instead and what.figures:
            figures = {n: v for n, v in what.figures(kind, run).items() if v}
            instead = "" if figures else what.instead(run) or "nothing"
            checks = [("%s are finite" % n, all(map(math.isfinite, v)), v) for n, v in figures.items()]
        if not instead and what.proven:
            try:
                checks += list(what.proven(kind, run))
            except (KeyError, IndexError) as missing:
                checks.append(("what is to be compared is there", False, missing))
        if show:
            print(text, run.out, "-- status %d" % run.status, run.err, "-- figures", figures if show > 1 else list(figures), sep="\n")
    return run.status, figures, instead, checks


def same(one, other, close):
    """The first figure of twins that differs."""
    for name in sorted(set(one) & set(other)):
        scale = max(map(abs, one[name]), default=0.0)
        if len(one[name]) != len(other[name]) or any(abs(a - b) > close*scale for a, b in zip(one[name], other[name])):
            return name
    return "" if set(one) & set(other) else "no name"


def write_table(marks, notes):
    lines = ["| | " + " | ".join(k.head for k in KINDS) + " |", "| --- |" + " --- |"*len(KINDS)]
    lines += ["| %s | %s |" % (s.title, " | ".join(marks[s.name, k.name] for k in KINDS)) for s in STUDIES]
    lines += [""] + ["%d. %s" % (n, note) for n, note in enumerate(notes, 1)]
    return "\n".join(lines) + "\n"


def main():
    global BIN
    arguments = argparse.ArgumentParser()
    arguments.add_argument("bin")
    arguments.add_argument("--update", action="store_true")
    arguments.add_argument("--only", default="")
    arguments.add_argument("--show", action="count", default=0)
    options = arguments.parse_args()
    BIN = os.path.abspath(options.bin)
    fields = fields_of(options.only)
    with ThreadPoolExecutor(1 if options.show else 2) as team:
        results = list(team.map(lambda f: examine(f, options.show), fields))
    figures, marks, notes = {}, {}, []
    for (s, k), (status, found, instead, checks) in zip(fields, results):
        name = "%s of %s" % (s.name, k.name)
        figures[s.name, k.name] = found
        for what, good, detail in checks:
            check("%s: %s" % (name, what), good, detail)
        marks[s.name, k.name] = "+"
        if instead:
            note = next((text for pattern, text in REASONS if re.search(pattern, instead)), None)
            check("%s: a result, or a reason known here" % name, note is not None, "status %d: %s" % (status, instead))
            notes += [note] if note not in notes and note else []
            marks[s.name, k.name] = str(notes.index(note) + 1) if note else "?"
    for s in STUDIES:
        for one, other in TWINS:
            a, b = figures.get((s.name, one)), figures.get((s.name, other))
            if a and b and not (s.of_drive and one == "geared"):
                differs = same(a, b, s.close)
                check("%s: %s as %s" % (s.name, one, other), not differs, differs and (
                    differs, a.get(differs, list(a))[:8], b.get(differs, list(b))[:8]))
    if not options.only:
        with open(MANUAL, encoding="utf-8") as f:
            manual = f.read()
        before, _, rest = manual.partition(BEGIN)
        table, _, after = rest.partition(END)
        new = write_table(marks, notes)
        if options.update:
            with open(MANUAL, "w", encoding="utf-8") as f:
                f.write(before + BEGIN + new + END + after)
        else:
            check("the table of doc/guide/which.md is this one (--update)", table == new)
    return report()


if __name__ == "__main__":
    sys.exit(main())
