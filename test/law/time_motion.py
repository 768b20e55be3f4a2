#!/usr/bin/env python3
"""Motion in time against closed forms, published numbers, and an independent integration of all poses with multipliers.

usage: time_motion.py BIN   (directory with the programs). The last line is N passed, N failed.

The witness knows bodies, pins and slides in Cartesian coordinates: place and angle of every body, the closure differentiated twice,
accelerations and multipliers from one linear system, SciPy's DOP853. It shares neither coordinates nor closure nor forces with kalm.
"""
import math
import os
import random
import re
import sys

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report
from timed import Kalm, data, near

KALM = Kalm(sys.argv[1])
MECHANISMS = 30       # random ones, as many of each kind
run = KALM.time


# ---- closed forms and published numbers (in 34 digits by quadratures and multipliers; Andrews: IVP test set) -----------------------------------------

def heights():
    """Moments out of the plane are those of a drive with its speed: not in the table for sizing of a motion in time."""
    text = data("pendulum")
    _, said = KALM.tables(re.sub(r" MASS *=", " MZ=0.5, MASS=", data("pendulum"), count=1))
    _, found, sizes = said.partition("AT THE TIME")
    check(f"a height has no effect on a motion in time: {said[-200:]}", "MZ: has no effect" in said and found and
          "FRAME FX" in sizes and "FRAME QX" not in sizes and "NaN" not in sizes)


def long_times():
    """The first step of a motion over a very long time is not one of many turns, which seem right by chance."""
    _, said = run("""THREE BARS ALIKE, ONE OUT OF LINE
 &CHAIN JNT='A0','A1','A2','B0','B1','B2', JX=0.0,1.0,2.0,-0.344215005894412,1.0,2.0, JY=3*0.0,3*1.0,
 LNAME='frame','bar0','bar1','bar2','top1','top2', LNK='A0 A1 A2','A0 B0','A1 B1','A2 B2','B0 B1','B1 B2' &END
 &DRIVES DRIVE='A0' &END
 &METHOD DELT=0.7603945947317818 &END
 &MASSES MNAME='bar0 A0','bar1 A1','bar2 A2','top1 B0','top2 B1', MASS=5*1.0 &END
 &TIME TEND=2000000.0, NTSTEP=1000, VSTART=-1.0 &END
""", want=1)
    told = re.search(r"ends at ([\d.]+) s of 2.0000E\+06 s: more steps than NTSTEP", said)
    check(f"a long time: steps that follow the motion: {said[-600:]}", told and 10.0 < float(told[1]) < 200.0)


def known_numbers():
    t, said = run(data("pendulum"))
    told = re.search(r"Greatest speed +([\d.]+) rad/s", said)
    check("pendulum: the words have its greatest speed, from level to the lowest", told is not None and
          abs(float(told[1]) - math.sqrt(2.0*9.81)) < 1e-3)
    near(t["point_P.x"][-1], -.275087462576117, 2e-12, "pendulum, x after 10 s")
    near(t["point_P.y"][-1], -.961419205099125, 2e-12, "pendulum, y after 10 s")
    check("pendulum: energy in balance", np.max(np.abs(t["balance"])) < 1e-11)
    check("pendulum: no torque at the free drive", np.max(np.abs(t["drive"])) < 1e-12)

    t, _ = run(data("crane", ("FREE='C'", "FREE='none'")))
    near(t["input.A"][-1], math.degrees(20.0) % 360.0 if t["input.A"][-1] < 360.0 else math.degrees(20.0), 1e-12,
         "no free drive: the crank turns as given")
    t, said = run('''MASS ON A SLIDE WITH SPRING AND DAMPER
 &CHAIN JNT='P','A', JX=1.0,0.0, JY=0.0,0.0, LNAME='frame','s', LNK='A','P', NSLIDE=1, SLNK='frame', SLNK2='s', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='s P', MASS=1.0, MDIST=0.0 &END
 &SPRING ANAME='frame A', BNAME='s P', STIFF=10.0, SFREE=0.5, SDAMP=4.0 &END
 &TIME TEND=100.0, TAT=1.0,100.0 &END
''')
    w, a = math.sqrt(6.0), math.exp(-2.0)           # x'' + 4 x' + 10 (x - 0.5) = 0 from x = 1 at rest
    near(t["point_P.x"][1], .5 + .5*a*(math.cos(w) + 2.0/w*math.sin(w)), 1e-12, "mass, spring and damper: after 1 s")
    near(t["point_P.x"][2], .5, 1e-12, "and at rest after 100 s")

    t, _ = run(data("andrews_squeezer"))
    start, end = -0.0617138900142764496, 15.810771195153707
    near(math.radians(t["input"][-1]) + start, end, 1e-12, "Andrews: beta at 0.03 s")
    near(t["input.v"][-1], 1139.92030225910606, 1e-12, "Andrews: its rate")
    near(t["input.a"][-1], -24631.763122874634, 1e-9, "Andrews: its acceleration")
    near(t["input.a"][0], 14222.4439199541139, 1e-12, "Andrews: acceleration at rest")
    near(t["kinetic"][-1], 1.508949733903534, 2e-12, "Andrews: kinetic energy")
    near(t["potential"][-1], .4506386730686787, 2e-12, "Andrews: energy of the spring")
    for joint, place in (("F", (-.00696303942704685, -.000718388430719102)), ("E", (-.0349216183953031, -.00224084108212674)),
                         ("G", (-.0347152190498839, .0177580938722705)), ("H", (-.0346813335644284, -.0222393976100377)),
                         ("D", (-.0156320659849406, .0155612140747330))):
        for axis, want in zip("xy", place):
            check(f"Andrews: {joint}.{axis} at 0.03 s", abs(t[f"{joint}.{axis}"][-1] - want) < 1e-13)
    near(t["work"][-1], .033*math.radians(t["input"][-1]), 1e-12, "Andrews: the torque's work is torque times angle")
    check("Andrews: energy in balance", np.max(np.abs(t["balance"])) < 2e-12)

    t, _ = run(data("crane"))
    near(t["input.C.v"][-1], -1.27008018721124, 1e-11, "bar on a driven slide: rate after 2 s")
    near(t["point_T.x"][-1], .168885043179309, 1e-11, "bar on a driven slide: place after 2 s")
    check("bar on a driven slide: no torque at the free drive", np.max(np.abs(t["drive2"])) < 1e-12)
    check("bar on a driven slide: what the drive does is in the balance", np.max(np.abs(t["balance"])) < 1e-10)

    # N four-bars in closed form: ((N+1)/3 + N) th'' = -((N+1)/2 + N) g cos th
    t, _ = run(data("four_bars", ("TEND=2.0, NTIME=100", "TEND=0.7, NTIME=70")))
    n = 2
    c = ((n + 1)/2 + n)*9.81/((n + 1)/3 + n)
    exact = solve_ivp(lambda s, y: [y[1], -c*math.cos(y[0])], (0, .7), [math.pi/2, -1.0], method="DOP853", rtol=1e-13, atol=1e-14)
    near(math.radians(t["input"][-1]) + math.pi/2, exact.y[0, -1], 1e-10, "two four-bars: angle at 0.7 s")
    near(t["input.v"][-1], exact.y[1, -1], 1e-10, "two four-bars: rate at 0.7 s")

    # one turn of the crank takes the time that kalm finds over the angle (&MOTOR without &TIME), with masses elsewhere
    engine = """OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1, ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, NDES=1, DELT=0.0 &END
 &MASSES MLINK=-1,-2,-3, MLOOP=3*1, MASS=.1,.2,.3, MDIST=10.0,20.0,30.0, MANG=10.0,20.0,30.0, MINERT=1E-4,2E-4,3E-4, UNITL=.001 &END
"""
    torque = " &LOADS LLINK=-1, LLOOP=1, LMOM=1.0 &END\n"
    t, _ = run(engine + torque + " &TIME TAT=.0852432063153193 &END\n")
    near(t["input.v"][-1], 183.854105017321, 1e-10, "engine from rest: speed after the first turn")
    near(t["work"][-1], 2*math.pi, 1e-11, "engine from rest: a turn of 1 N m")
    resisting = " &LOADS LLINK=-1, LLOOP=1, LMOM=-5.0 &END\n &MOTOR MTORQ=20.0, MSPEED=100.0 &END\n"
    t, _ = run(engine + resisting + " &TIME TAT=.1 &END\n")
    near(t["input.v"][-1], 68.054785083114616, 1e-10, "engine with its motor: speed at 0.1 s")
    near(t["output"][-1], 160.171793794359, 1e-10, "engine with its motor: piston at 0.1 s")
    near((t["length.v"] if "length" in t else t["output.v"])[-1], -2522.1356070777, 1e-10, "engine with its motor: its speed")
    wheel = " &MOTOR MTORQ=20.0, MSPEED=100.0, FLYWHL=.05 &END\n"
    bare = engine.replace("MASS=.1,.2,.3", "MASS=3*0.0").replace("MINERT=1E-4,2E-4,3E-4", "MINERT=3*0.0")
    t, _ = run(bare + wheel + " &TIME TAT=.2, VSTART=1.0 &END\n")
    near(t["input.v"][-1], 100.0 - 99.0*math.exp(-20.0*.2/(.05*100.0)), 1e-11, "a motor's line on a flywheel alone")
    t, _ = run(engine + " &TIME TAT=.1, VSTART=20.0 &END\n")
    check("nothing acts: the energy stays", np.max(np.abs(t["kinetic"]/t["kinetic"][0] - 1.0)) < 1e-12)


# ---- the witness -------------------------------------------------------------------------------------------------------

class Witness:
    """Bodies by place of their first joint and angle; pins (body, point, body, point), slides along the x axis of the frame."""

    def __init__(self):
        self.masses, self.places, self.pins, self.slides, self.springs, self.gravity = [], [], [], [], [], np.zeros(2)

    def body(self, place, angle, mass, centre, inertia):
        self.places.append([*place, angle])
        self.masses.append((mass, np.array(centre, float), inertia))
        return len(self.places) - 1

    def where(self, y, body, point):
        if body is None:
            return np.array(point, float), np.zeros((2, 3)), np.zeros(2)
        c, s = math.cos(y[3*body + 2]), math.sin(y[3*body + 2])
        r = np.array([c*point[0] - s*point[1], s*point[0] + c*point[1]])
        return y[3*body:3*body + 2] + r, np.array([[1, 0, -r[1]], [0, 1, r[0]]]), -r

    def accelerations(self, y, v):
        n = len(y)
        mass, force = np.zeros((n, n)), np.zeros(n)
        for b, (m, centre, inertia) in enumerate(self.masses):
            _, jac, bend = self.where(y, b, centre)
            part = slice(3*b, 3*b + 3)
            mass[part, part] += m*jac.T @ jac
            mass[3*b + 2, 3*b + 2] += inertia
            force[part] += m*jac.T @ (self.gravity - bend*v[3*b + 2]**2)
        for a, p, b, q, stiff, free, damp in self.springs:
            pa, ja, _ = self.where(y, a, p)
            pb, jb, _ = self.where(y, b, q)
            gap = pb - pa
            length = np.hypot(*gap)
            speed = np.zeros(2)
            if b is not None:
                speed += jb @ v[3*b:3*b + 3]
            if a is not None:
                speed -= ja @ v[3*a:3*a + 3]
            pull = (stiff*(length - free) + damp*(gap @ speed)/length)*gap/length
            if a is not None:
                force[3*a:3*a + 3] += ja.T @ pull
            if b is not None:
                force[3*b:3*b + 3] -= jb.T @ pull
        rows, right = [], []
        for a, p, b, q in self.pins:
            row, bend = np.zeros((2, n)), np.zeros(2)
            for body, point, sign in ((a, p, 1.0), (b, q, -1.0)):
                if body is None:
                    continue
                _, jac, bent = self.where(y, body, point)
                row[:, 3*body:3*body + 3] += sign*jac
                bend -= sign*bent*v[3*body + 2]**2
            rows.append(row)
            right.extend(bend)
        for b in self.slides:
            row = np.zeros((2, n))
            row[0, 3*b + 1] = row[1, 3*b + 2] = 1.0
            rows.append(row)
            right.extend((0.0, 0.0))
        g = np.vstack(rows)
        k = np.block([[mass, g.T], [g, np.zeros((len(g), len(g)))]])
        return np.linalg.solve(k, np.concatenate([force, right]))[:n]

    def end(self, time, v0):
        n = 3*len(self.places)
        y0 = np.concatenate([np.array(self.places).ravel(), v0])
        done = solve_ivp(lambda t, y: np.concatenate([y[n:], self.accelerations(y[:n], y[n:])]), (0.0, time), y0, method="DOP853",
                         rtol=1e-11, atol=1e-12)
        return done.y[:n, -1], done.y[n:, -1]


def random_mechanism(draw, kind):
    """A case and its witness: four-bar, slider-crank, five-bar with two free drives, chain of two or three bars, bar on a slide."""
    joints = {"A": (0.0, 0.0)}

    def reach(start, name, length, angle):
        joints[name] = (joints[start][0] + length*math.cos(angle), joints[start][1] + length*math.sin(angle))

    def uniform(low, high):
        return draw.uniform(low, high)

    slide = None
    if kind == "four-bar":
        reach("A", "B", uniform(.2, .3), uniform(.6, 1.4))
        reach("B", "C", uniform(.8, .9), uniform(.1, .4))
        joints["D"] = (uniform(.9, 1.1), uniform(-.1, .1))
        links, drives, frame = ["A B", "B C", "C D"], ["A"], "A D"
    elif kind == "five-bar":
        joints["E"] = (.5, 0.0)
        reach("A", "B", uniform(.3, .4), uniform(1.6, 2.2))
        reach("E", "D", uniform(.3, .4), uniform(.9, 1.5))
        joints["C"] = (uniform(.2, .3), uniform(.6, .7))
        links, drives, frame = ["A B", "B C", "C D", "D E"], ["A", "E"], "A E"
    elif kind == "chain":
        names = "ABCD"[:draw.choice((3, 4))]
        for a, b in zip(names, names[1:]):
            reach(a, b, uniform(.3, .6), uniform(-2.5, -.5))
        links, drives, frame = [f"{a} {b}" for a, b in zip(names, names[1:])], list(names[:-1]), "A"
    else:
        reach("A", "B", uniform(.1, .15), uniform(.5, 2.5))
        length = uniform(.4, .5)
        joints["C"] = (joints["B"][0] + math.sqrt(length**2 - joints["B"][1]**2), 0.0)
        links, drives, frame, slide = ["A B", "B C"], ["A"], "A", "C"
        if kind == "bar on a slide":
            reach("C", "T", uniform(.2, .3), uniform(-2.2, -.9))
            links.append("C T")
            drives.append("C")
    witness, names = Witness(), []
    witness.gravity = np.array([0.0, -9.81])
    mass_items = {"MNAME": [], "MASS": [], "MDIST": [], "MANG": [], "MINERT": []}
    holder = {}
    for number, link in enumerate(links):
        a, b = link.split()
        line = np.subtract(joints[b], joints[a])
        angle = math.atan2(line[1], line[0])
        mass, inertia = uniform(.5, 2.0), uniform(.005, .02)
        centre = (uniform(.05, .3), uniform(-.1, .1))
        body = witness.body(joints[a], angle, mass, centre, inertia)
        names.append(f"link{number + 1}")
        for item, value in zip(mass_items, (f"'{names[-1]} {a}'", mass, math.hypot(*centre), math.degrees(math.atan2(*centre[::-1])),
                                            inertia)):
            mass_items[item].append(value)
        for joint, point in ((a, (0.0, 0.0)), (b, (float(np.hypot(*line)), 0.0))):
            holder.setdefault(joint, []).append((body, point))
    if slide:
        mass = uniform(.3, 1.0)
        body = witness.body(joints["C"], 0.0, mass, (0.0, 0.0), 0.0)
        witness.slides.append(body)
        for item, value in zip(mass_items, ("'slide C'", mass, 0.0, 0.0, 0.0)):
            mass_items[item].append(value)
        holder["C"].insert(0, (body, (0.0, 0.0)))
    for joint in frame.split():
        holder[joint].insert(0, (None, joints[joint]))
    for held in holder.values():
        for other in held[1:]:
            witness.pins.append((*held[0], *other))
    # a spring with a damper from the last joint that moves to the frame
    last = links[-1].split()
    far = last[1] not in frame.split()
    body, point = next(h for h in holder[last[far]] if h[0] is not None and (h[1][0] > 0.0) == far)
    anchor, stiff, free, damp = (joints["A"][0], joints["A"][1]), uniform(20.0, 60.0), uniform(.2, .5), uniform(.5, 2.0)
    witness.springs.append((None, anchor, body, point, stiff, free, damp))
    order = list(joints)
    texts = {item: ",".join(v if isinstance(v, str) else repr(v) for v in values) for item, values in mass_items.items()}
    quoted = ",".join
    lnames = ["frame"] + names + (["slide"] if slide else [])
    lnk = [frame] + links + (["C"] if slide else [])
    case = "RANDOM MECHANISM\n &CHAIN JNT=" + quoted(f"'{j}'" for j in order)
    case += ", JX=" + quoted(repr(float(joints[j][0])) for j in order) + ", JY=" + quoted(repr(float(joints[j][1])) for j in order)
    case += ",\n  LNAME=" + quoted(f"'{x}'" for x in lnames) + ", LNK=" + quoted(f"'{x}'" for x in lnk)
    if slide:
        case += ",\n  NSLIDE=1, SLNK='frame', SLNK2='slide', SLX=0.0, SLY=0.0, SLANG=0.0"
    case += " &END\n &DRIVES DRIVE=" + quoted(f"'{d}'" for d in drives)
    if kind == "bar on a slide":
        case += ", DBASE='frame','slide', DLINK='link1','link3'"
    for k in range(2, len(drives) + 1):
        case += f", DELT{k}=0.0"
    case += f" &END\n &OUTPUTS OUTPUT='point {last[0]}' &END\n &METHOD NDES=1, DELT=0.0 &END\n &MASSES "
    case += ",\n  ".join(f"{item}={text}" for item, text in texts.items()) + ", GRAVY=-9.81 &END\n"
    case += f" &SPRING ANAME='frame A', BNAME='{names[body]} {last[far]}', STIFF={stiff!r}, SFREE={free!r}, SDAMP={damp!r} &END\n"
    return case, witness, order, holder


def random_mechanisms():
    draw = random.Random(39)
    kinds = ("four-bar", "slider-crank", "five-bar", "chain", "bar on a slide")
    worst = 0.0
    for number in range(MECHANISMS):
        kind = kinds[number % len(kinds)]
        case, witness, order, holder = random_mechanism(draw, kind)
        end = draw.uniform(.1, .15) if kind == "five-bar" else draw.uniform(.2, .4)   # before a dead point of its drives
        t, said = run(case + f" &TIME TAT={end!r} &END\n")
        if t is None:
            check(f"{kind} {number}: {said[:200]}", False)
            continue
        y, v = witness.end(end, np.zeros(3*len(witness.places)))
        error = 0.0
        for joint in order:
            body, point = next(((b, p) for b, p in holder[joint] if b is not None), (None, None))
            place, jac, _ = witness.where(y, body, point)
            speed = jac @ v[3*body:3*body + 3]
            error = max(error, abs(t[f"{joint}.x"][-1] - place[0]), abs(t[f"{joint}.y"][-1] - place[1]),
                        .1*abs(t[f"{joint}.vx"][-1] - speed[0]), .1*abs(t[f"{joint}.vy"][-1] - speed[1]))
        worst = max(worst, error)
        check(f"{kind} {number}: joints and speeds at {end:.3f} s are {error:.1e} off", error < 1e-8)
        balance = np.max(np.abs(t["balance"]))/max(np.max(t["kinetic"]), np.max(np.abs(t["lost"])), 1e-3)
        check(f"{kind} {number}: energy in balance to {balance:.1e}", balance < 1e-11)
    print(f"largest difference from the witness {worst:.1e}")


# ---- laws ---------------------------------------------------------------------------------------------------------------

def laws():
    # back in time: speeds turned round lead to where it came from
    t, _ = run(data("four_bars", ("TEND=2.0, NTIME=100", "TAT=0.4")))
    there = t["input"][-1], t["input.v"][-1]
    angle = math.radians(90.0 + there[0])
    text = data("four_bars", ("TEND=2.0, NTIME=100, VSTART=-1.0", f"TAT=0.4, VSTART={float(-there[1])!r}"),
                ("JX=0.0,1.0,2.0,0.0,1.0,2.0", "JX=0.0,1.0,2.0," + ",".join(repr(float(k + math.cos(angle))) for k in range(3))),
                ("JY=3*0.0,3*1.0", "JY=3*0.0," + ",".join([repr(float(math.sin(angle)))]*3)))
    t, _ = run(text)
    near(t["input.v"][-1], 1.0, 1e-11, "speeds turned round lead back to the speed at the beginning")
    near(t["input"][-1], -there[0], 1e-11, "and to the place")
    t, _ = run(data("andrews_squeezer", ("TEND=0.03, NTIME=30", "TAT=0.01")))
    looser, _ = run(data("andrews_squeezer", ("TEND=0.03, NTIME=30", "TAT=0.01, TTOL=1E-9")))
    difference = abs(t["input"][-1] - looser["input"][-1])/t["input"][-1]
    check(f"a looser TTOL changes the result, by less than 10 times as much: {difference:.1e}", 0.0 < difference < 1e-8)
    near(looser["time"][-1], 0.01, 0.0, "the last time is that of TAT")
    # a torsional damper has no angle at which it is free: 16 turns, J w' = -c w with J = 1 kg m2
    t, said = run(data("pendulum", (" &TIME TEND=10.0", " &SPRING ANAME='frame', BNAME='bar', STORS=1, STIFF=0.0, SFREE=0.0, "
                                   "SDAMP=0.5 &END\n &TIME TEND=10.0, VSTART=50.0"), ("GRAVY=-9.81", "GRAVY=0.0")))
    near(math.radians(t["input"][-1]), 100.0*(1.0 - math.exp(-5.0)), 1e-9, "a torsional damper alone, through many turns: " + said[-200:])


def trebuchet():
    """Its beam, weight and sling as three bars with angles from the x axis, by Lagrange's equations for these, integrated by scipy."""
    t, _ = run(data("trebuchet"))
    o, a, w, b, s = (complex(*p) for p in ((0.0, 4.5), (1.5, 5.9), (1.5, 4.1), (-4.5, .3), (1.0, .3)))
    # places are O + sums of complex factors times exp(i angle): beam's centre of mass, weight, stone
    axis = (a - o)/abs(a - o)
    reach = np.array([[-1.5*axis, 0, 0], [a - o, w - a, 0], [b - o, 0, s - b]])
    mass, inertia = np.array([100.0, 1500.0, 10.0]), np.array([560.0, 200.0, 0.0])

    def slope(_, y):
        arms = 1j*reach*np.exp(1j*y[:3])                      # of each place by each angle
        matrix = np.real(np.einsum("m,mi,mj->ij", mass, arms.conj(), arms)) + np.diag(inertia)
        bend = 1j*arms@y[3:]**2                               # accelerations at constant rates
        force = -np.real(np.einsum("m,mi,m->i", mass, arms.conj(), bend + 9.81j))
        return np.concatenate([y[3:], np.linalg.solve(matrix, force)])

    found = solve_ivp(slope, (0.0, 1.6), np.zeros(6), method="DOP853", t_eval=t["time"], rtol=1e-13, atol=1e-13).y
    stone = o + np.exp(1j*found[[0, 2]].T)@reach[2, [0, 2]]
    worst = np.abs(t["S.x"] + 1j*t["S.y"] - stone).max()
    check(f"trebuchet: place of the stone, {worst:.1e} m", worst < 1e-9)


def sizing():
    """Peaks, their times and means of the listing are those of the table, means over the time by the trapezoidal rule."""
    def area(y, x):
        return float(np.sum(np.diff(x)*(y[1:] + y[:-1])/2.0))

    for name, joint in (("press", "O"), ("crane", "C.bar")):
        t, said = run(data(name, *([("NTIME=800", "NTAT=5, TAT=0.1,0.2,1.7,4.0,8.0")] if name == "press" else [])))
        row = re.search(r"AT THE TIME.*?^ %s +(\S+) +(\S+) +(\S+) +(\S+)$" % re.escape(joint), said, re.M | re.S)
        force = np.hypot(t[joint + "_fx"], t[joint + "_fy"])
        span = t["time"][-1] - t["time"][0]
        want = [force.max(), t["time"][force.argmax()], math.sqrt(area(force**2, t["time"])/span), area(force, t["time"])/span]
        got = [float(word) for word in row.groups()] if row else []
        check(f"sizing of {joint} of {name}: {got} instead of {want}", len(got) == 4 and np.allclose(got, want, rtol=2e-5, atol=0.01))


def mistakes():
    base = data("pendulum")
    for old, new, words in (
            ("TEND=10.0", "NTIME=10", "the end of the motion"), ("TEND=10.0", "TAT=2.0,1.0", "times must ascend"),
            ("TEND=10.0", "TEND=1.0, FREE='Q'", "no drive 'Q'"), ("TEND=10.0", "TEND=1.0, TTOL=1E-20", "1E-14"),
            ("TEND=10.0", "TEND=1.0, VNAME='O'", "VSTART has 0 speeds"), ("TEND=10.0", "TEND=-1.0", "above 0"),
            ("TEND=10.0", "TEND=1.0, VSTART=1.0,2.0", "more speeds"), ("TEND=10.0", "TEND=1.0, FREE='none', VSTART=1.0", "more speeds"),
            ("TEND=10.0", "TEND=1.0, FREE='none', VNAME='O', VSTART=1.0", "not free"),
            ("&TIME", "&MOTOR MTORQ=1.0, NTURN=2 &END\n &TIME", "NTURN"), ("&TIME", "&MOTOR MTORQ=1.0, WSTART=2.0 &END\n &TIME", "VSTART"),
            ("&MASSES MNAME='bar O', MDIST=1.0, MASS=1.0, GRAVY=-9.81 &END", "&RATES SPEED=1.0 &END", "needs masses")):
        assert old in base
        table, said = run(base.replace(old, new), want=2)
        check(f"{new!r} is refused with '{words}': {said[:200]}", table is None and words in said)
    t, said = run(data("crane", ("FREE='C'", "FREE='none', VNAME='C'")), want=2)
    check(f"a drive that is not free has no speed of its own: {said[:200]}", t is None and "VSTART" in said)
    t, said = run(base.replace("GRAVY=-9.81 &END", "&END\n &SPRING ANAME='frame O', BNAME='bar O', STORS=1, STIFF=0.01 &END")
                  .replace("TEND=10.0", "TEND=20.0, VSTART=1.0"), want=1)
    check(f"a torsional spring ends the motion at half a turn: {said[:200]}",
          "torsional spring 1 is turned past half a turn" in said and 5.9 < t["time"][-1] < 6.3)
    t, said = run(base.replace("MASS=1.0", "MASS=0.0"), want=1)
    check(f"no mass on a free link: {said[:200]}", "moves no mass" in said and len(t["time"]) == 0)
    # a rocker that another drive follows comes to its dead point: no joint can take its place, so the motion ends there, and says so
    swing = """FOUR-BAR, ITS ROCKER AS DRIVE
 &CHAIN JNT='A','B','C','D','E','F', JX=0.0,0.1,0.75,0.8,2.0,2.1, JY=0.0,0.25,0.5,0.0,0.0,0.0,
  LNAME='frame','ab','bc','cd','wheel', LNK='A D E','A B','B C','C D','E F' &END
 &DRIVES DRIVE='D','E', RATIO=0.0,2.0 &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='ab A','bc B','cd C', MASS=1.0,2.0,1.5, MDIST=.13462912017836259,.34820970692960316,.25124689052802224,
  MINERT=.006041666666666667,.08083333333333333,.0315625, GRAVY=-9.81 &END
 &TIME TEND=1.0, NTIME=100 &END
"""
    t, said = run(swing, want=1)
    check(f"a dead point of the drive ends the motion: {said[:200]}", "the motion ends at" in said and .3 < t["time"][-1] < .34)


if __name__ == "__main__":
    known_numbers()
    heights()
    long_times()
    random_mechanisms()
    laws()
    trebuchet()
    sizing()
    mistakes()
    sys.exit(report())
