#!/usr/bin/env python3
"""Motion in time through change points: closed forms of the smooth motion, quadratures, the equations of every link.

usage: time_change_points.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import json
import math
import os
import random
import subprocess
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from scipy.integrate import solve_ivp
from tally import check, report
from timed import Kalm, data, near

import picture_tools

KALM = Kalm(sys.argv[1])
G = 9.81
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)
FOLDS = "straight on through change points"


def quoted(names):
    """Names of a NAMELIST group, on lines that are not too long."""
    lines = [""]
    for name in names:
        if len(lines[-1]) > 100:
            lines.append("")
        lines[-1] += f"'{name}',"
    return "\n  ".join(lines).rstrip(",")


def numbers(values):
    return "\n  ".join(",".join(repr(float(v)) for v in values[k:k + 5]) + "," for k in range(0, len(values), 5)).rstrip(",")


def row_of_bars(n, angle, time):
    """N four-bars: 2N+1 uniform bars of 1 m and 1 kg, pivots 1 m apart, parallel bars at an angle from the x axis."""
    every = range(n + 1)
    links = ["frame"] + [f"bar{k}" for k in every] + [f"top{k}" for k in every[1:]]
    joints = [f"A{k}" for k in every] + [f"B{k}" for k in every]
    lists = [" ".join(joints[:n + 1])] + [f"A{k} B{k}" for k in every] + [f"B{k - 1} B{k}" for k in every[1:]]
    masses = [f"bar{k} A{k}" for k in every] + [f"top{k} B{k - 1}" for k in every[1:]]
    return (f"N FOUR-BARS, N = {n}\n &CHAIN JNT={quoted(joints)},\n  JX={numbers(list(every) + [k + math.cos(angle) for k in every])},\n"
            f"  JY={n + 1}*0.0,\n  {numbers([math.sin(angle)]*(n + 1))},\n  LNAME={quoted(links)},\n  LNK={quoted(lists)} &END\n"
            " &DRIVES DRIVE='A0' &END\n &OUTPUTS OUTPUT='point B0' &END\n &METHOD NDES=1, DELT=0.0 &END\n"
            f" &MASSES MNAME={quoted(masses)},\n  MASS={2*n + 1}*1.0, MDIST={2*n + 1}*0.5, MINERT={2*n + 1}*0.0833333333333333333, "
            f"GRAVY=-{G} &END\n &TIME {time} &END\n")


def pull(n):
    """th'' = -pull cos th."""
    return ((n + 1)/2 + n)*G/((n + 1)/3 + n)


def time_to(n, start, rate, end):
    """When the bars of N four-bars come to an angle, by quadrature."""
    def part(a, b):
        th = .5*(a + b) + .5*(b - a)*NODES
        return abs(.5*(b - a))*float(np.sum(WEIGHTS/np.sqrt(rate**2 + 2*pull(n)*(math.sin(start) - np.sin(th)))))
    parts = max(4, int(abs(end - start)*6))
    return sum(part(start + (end - start)*k/parts, start + (end - start)*(k + 1)/parts) for k in range(parts))


def four_bars():
    """The test problem of the IFToMM with 2 and with 40 four-bars: published numbers, closed forms at every row."""
    published = {2: {10.0: (.328458111540815, .944518538178601, 1.42305147020694, -.494868845487043)},
                 40: {10.0: (.180512226686728, .983572740582312, 1.14844127746941, -.210770066779424),
                      20.0: (.410901153762945, .911679900971981, 1.56678537190907, -.706162235593837)}}
    for n, first in ((2, .714355529292961), (40, .721581024825657)):
        tables, said = KALM.tables(row_of_bars(n, math.pi/2, "TEND=20.0, NTIME=200, VSTART=-1.0"))
        t, events = tables["time"], tables["events"]
        near(t["time"][-1], 20.0, 0.0, f"{n} four-bars come to their end")
        for time, wanted in published[n].items():
            row = int(np.argmin(np.abs(t["time"] - time)))
            for name, value in zip(("B0.x", "B0.y", "B0.vx", "B0.vy"), wanted):
                near(t[name][row], value, 1e-9, f"{n} four-bars, {name} at {time} s")
        near(events["time"][0], first, 1e-12, f"{n} four-bars: the first change point, published")
        check(f"{n} four-bars: all events are change points", set(events["event"]) == {"change"} and set(events["stop"]) == {"-"})
        exact = [time_to(n, math.pi/2, -1.0, -k*math.pi) for k in range(25)]
        exact = [time for time in exact if time < 20.0]
        # at -pi/2 and +pi/2 beyond the ground line the bars are upright; in line at 0, -pi, -2 pi, ...
        check(f"{n} four-bars: so many change points: {len(events['time'])}", len(events["time"]) == len(exact))
        for k, (got, want) in enumerate(zip(events["time"], exact)):
            near(got, want, 1e-10, f"{n} four-bars: change point {k + 1}")
        angle = math.pi/2 + np.radians(t["input"])
        for k in range(n + 1):
            off = np.max(np.abs(t[f"B{k}.x"] - k - np.cos(angle))) + np.max(np.abs(t[f"B{k}.y"] - np.sin(angle)))
            if k % 10 in (0, 1, 2):
                check(f"{n} four-bars: bar {k} stays parallel, {off:.1e} off", off < 2e-12)
        for name, wanted in (("vx", -np.sin(angle)*t["input.v"]), ("ay", np.cos(angle)*t["input.a"] - np.sin(angle)*t["input.v"]**2)):
            off = np.max(np.abs(t[f"B{n}.{name}"] - wanted))/np.max(np.abs(wanted))
            check(f"{n} four-bars: B{n}.{name} is {off:.1e} off", off < 2e-12)
        drift = np.max(np.abs(t["balance"]))/np.max(np.abs(t["potential"] - t["potential"][0]))
        check(f"{n} four-bars: energy in balance to {drift:.1e} of the turnover", drift < 3e-12)
        check(f"{n} four-bars: said in the summary and as a remark", "Passes" in said and "straight on" in said and FOLDS in said)
        check(f"{n} four-bars: force on the frame", np.max(np.abs(t["frame_fx"] + momentum(n, angle, t, 0)))
              < 1e-9*np.max(np.abs(t["frame_fx"])))
    forces_beside()


def momentum(n, angle, t, axis):
    """Rate of the momentum of all bars along x or y."""
    rate, growth = t["input.v"], t["input.a"]
    top = (-np.sin(angle)*growth - np.cos(angle)*rate**2, np.cos(angle)*growth - np.sin(angle)*rate**2)[axis]
    return ((n + 1)/2 + n)*top


def forces_beside():
    """Forces of all joints of two four-bars beside their change point, by the equations of all links, and none at it."""
    when = time_to(2, math.pi/2, -1.0, 0.0)
    away = (-.05, -.01, -1e-3, 0.0, 1e-3, .01, .05)
    t, _ = KALM.time(row_of_bars(2, math.pi/2, "TAT=" + ",".join(repr(when + d) for d in away) + ", VSTART=-1.0"))
    # dev9 has no number for what is not determined
    for row, d in enumerate(away, 1):
        if d == 0.0:
            check("at the change point no force of a joint is listed", math.isnan(t["A1_fx"][row]) and math.isnan(t["frame_fx"][row]))
            check("but the motion is", abs(t["B1.x"][row] - 2.0) < 1e-11 and abs(t["B1.y"][row]) < 1e-9)
            continue
        th, w, al = math.pi/2 + math.radians(t["input"][row]), t["input.v"][row], t["input.a"][row]
        wanted = joint_forces(th, w, al)
        for name, value in wanted.items():
            size = max(abs(v) for v in wanted.values())
            # the sine between the links is that of the angle: digits are lost as its inverse
            check(f"{d} s from the change point: {name}_fx {t[name + '_fx'][row]!r} instead of {value!r}",
                  abs(abs(t[name + "_fx"][row]) - abs(value)) < 1e-11*size/abs(math.sin(th)))


def joint_forces(th, w, al):
    """Of two four-bars at an angle, rate and acceleration: x components of the forces of the pins A0, A1, A2, by Newton and Euler."""
    u = np.array([math.cos(th), math.sin(th)])
    top = al*np.array([-u[1], u[0]]) - w**2*u
    # unknowns: forces on bars at A0 A1 A2, on bar k at its top from tops: F01 (top1 on bar0), F11 (top1 on bar1), F12, F22 (top2)
    rows, right = [], []

    def equation(parts, value):
        row = np.zeros(14)
        for column, factor in parts:
            row[column] += factor
        rows.append(row)
        right.append(value)

    held = {0: [0], 1: [1, 2], 2: [3]}                # forces at the top of each bar: numbers 3 + these
    for k in range(3):
        for axis in range(2):
            equation([(2*k + axis, 1.0)] + [(6 + 2*f + axis, 1.0) for f in held[k]], .5*top[axis] + (G if axis else 0.0))
        # about the centre, J = 1/12: force at the pivot at -u/2, at the top at +u/2
        equation([(2*k, .5*u[1]), (2*k + 1, -.5*u[0])] +
                 [part for f in held[k] for part in ((6 + 2*f, -.5*u[1]), (6 + 2*f + 1, .5*u[0]))], al/12)
    for left, far in ((0, 1), (2, 3)):                # tops: the bars push back; no turn
        for axis in range(2):
            equation([(6 + 2*left + axis, -1.0), (6 + 2*far + axis, -1.0)], top[axis] + (G if axis else 0.0))
        equation([(6 + 2*left + 1, .5), (6 + 2*far + 1, -.5)], 0.0)
    solution = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    return {f"A{k}": solution[2*k] for k in range(3)}


class FourBar:
    """A(0, 0), crank a, coupler b, rocker c, D(d, 0) with a + d = b + c or a = d and b = c: the smooth motion in closed form.

    With h from B to D, 16 times the square of the area of b, c, h has the factor (b + c)^2 - h^2 = 4 a d cos(th/2)^2, whose root is
    smooth. For a = d, b = c it is h itself that goes through 0."""

    def __init__(self, a, b, c, d, side=1.0, mass=(1.0, 2.0, 1.5)):
        self.a, self.b, self.c, self.d, self.side, self.mass = a, b, c, d, side, mass
        self.kite = a == d and b == c

    def places(self, th):
        """B and C as complex numbers of coordinates, x and y apart, of complex angles."""
        x, y = self.a*np.cos(th), self.a*np.sin(th)
        hx, hy = self.d - x, -y
        if self.kite:
            h = 2*self.a*np.sin(th/2)
            along, across = h/2, self.side*np.sqrt(self.b**2 - h*h/4)
            ex, ey = np.sin(th/2), -np.cos(th/2)
        else:
            square = hx*hx + hy*hy
            h = np.sqrt(square)
            along = (self.b**2 - self.c**2 + square)/(2*h)
            if self.a == self.c:
                across = self.side*self.a*self.d*np.sin(th)/h
            else:
                across = self.side*np.sqrt(self.a*self.d)*np.cos(th/2)*np.sqrt(square - (self.b - self.c)**2)/h
            ex, ey = hx/h, hy/h
        return x, y, x + along*ex - across*ey, y + along*ey + across*ex

    def inertia_and_potential(self, th):
        """Of uniform bars, reduced to the crank; derivatives by a complex step."""
        e = 1e-30
        z = [np.imag(p)/e for p in self.places(th + 1j*e)]
        b, c = complex(z[0], z[1]), complex(z[2], z[3])
        m1, m2, m3 = self.mass
        j = m1*abs(b)**2/3 + m3*abs(c)**2/3 + m2*(abs(b)**2 + abs(c)**2 + (b*c.conjugate()).real)/3
        _, by, _, cy = (np.real(p) for p in self.places(th + 0j))
        return j, G*(m1*by/2 + m2*(by + cy)/2 + m3*cy/2)

    def time(self, start, rate, end):
        """From an angle and rate of the crank to another angle, one way."""
        j, v = self.inertia_and_potential(start)
        energy = .5*j*rate**2 + v
        total, parts = 0.0, max(2, int(12*abs(end - start)))
        for k in range(parts):
            p, q = (start + (end - start)*(k + i)/parts for i in (0, 1))
            for x, weight in zip(NODES, WEIGHTS):
                j, v = self.inertia_and_potential(.5*(p + q) + .5*(q - p)*x)
                total += abs(.5*(q - p))*weight*math.sqrt(.5*j/(energy - v))
        return total

    def case(self, th, time, more="", place=None, longer=0.0):
        bx, by, cx, cy = (float(np.real(p)) for p in self.places(th + 0j))
        if longer:
            # the coupler is longer: C on the same side of B D
            h = complex(self.d - bx, -by)
            along = ((self.b + longer)**2 - self.c**2 + abs(h)**2)/(2*abs(h))
            side = math.copysign(1.0, (complex(cx - bx, cy - by)*h.conjugate()).imag)
            c = complex(bx, by) + complex(along, side*math.sqrt((self.b + longer)**2 - along**2))*h/abs(h)
            cx, cy = c.real, c.imag
        if place:
            bx, by, cx, cy = place
        m, lengths = self.mass, (self.a, self.b, self.c)
        return (f"FOUR-BAR\n &CHAIN JNT='A','B','C','D', JX=0.0,{numbers([bx, cx, self.d])}, JY=0.0,{numbers([by, cy, 0.0])},\n"
                "  LNAME='frame','ab','bc','cd', LNK='A D','A B','B C','D C' &END\n &DRIVES DRIVE='A' &END\n"
                " &OUTPUTS OUTPUT='point C' &END\n &METHOD NDES=1, DELT=0.0 &END\n"
                f" &MASSES MNAME='ab A','bc B','cd D', MASS={numbers(m)}, MDIST={numbers([x/2 for x in lengths])},\n"
                f"  MINERT={numbers([k*x*x/12 for k, x in zip(m, lengths)])}, GRAVY=-{G} &END\n{more} &TIME {time} &END\n")


def turn_of(t):
    """Angle of the crank, radians, not within a turn."""
    return math.radians(t["input"][-1] - t["input"][0])


def grashof_and_others():
    """The Grashof limit, parallelogram, antiparallelogram and kite against quadratures over the crank."""
    cases = (("Grashof limit", FourBar(1.0, 2.5, 1.5, 3.0), 2.5, 2.0, 1.0, math.pi),
             ("Grashof limit, other assembly", FourBar(1.0, 2.5, 1.5, 3.0, -1.0), 2.5, 2.0, 1.0, math.pi),
             ("parallelogram", FourBar(1.0, 2.0, 1.0, 2.0), 1.0, 8.0, 1.0, math.pi),
             ("antiparallelogram", FourBar(1.0, 2.0, 1.0, 2.0, -1.0), 1.0, 8.0, .8, math.pi),
             ("kite", FourBar(1.0, 2.0, 2.0, 1.0), 1.0, -8.0, .5, 0.0))
    for name, bar, start, rate, end, change in cases:
        tables, said = KALM.tables(bar.case(start, f"TEND={end}, NTIME=20, VSTART={rate!r}"))
        t = tables["time"]
        turned = start + turn_of(t)
        near(bar.time(start, rate, turned), end, 1e-10, f"{name}: time to where the crank is then")
        x, y, cx, cy = bar.places(turned + 0j)
        off = max(abs(t["B.x"][-1] - x), abs(t["B.y"][-1] - y), abs(t["C.x"][-1] - cx), abs(t["C.y"][-1] - cy))
        check(f"{name}: joints on the smooth motion, {off:.1e} off", off < 1e-12)
        drift = np.max(np.abs(t["balance"]))/np.max(t["kinetic"])
        check(f"{name}: energy in balance to {drift:.1e}", drift < 5e-12)
        first = bar.time(start, rate, change)
        near(tables["events"]["time"][0], first, 1e-11, f"{name}: change point")
        check(f"{name}: said", FOLDS in said)
    # speeds turned round at the end lead back through the change point
    bar = FourBar(1.0, 2.5, 1.5, 3.0)
    tables, _ = KALM.tables(bar.case(2.5, "TEND=1.0, NTIME=10, VSTART=2.0"))
    t = tables["time"]
    back, _ = KALM.tables(bar.case(2.5, f"TEND=1.0, NTIME=10, VSTART={float(-t['input.v'][-1])!r}",
                                   place=[float(t[n][-1]) for n in ("B.x", "B.y", "C.x", "C.y")]))
    for name in ("B.x", "B.y", "C.x", "C.y"):
        near(back["time"][name][-1], t[name][0], 1e-11, f"speeds turned round lead back: {name}")
    near(back["events"]["time"][-1], 1.0 - tables["events"]["time"][0], 1e-11, "speeds turned round: change point")


def random_linkages(count):
    """Random linkages with change points: joints where the closed form has them for the crank, energy in balance."""
    draw = random.Random(1939)
    passed = 0
    for number in range(count):
        kind = draw.choice(("Grashof limit", "parallelogram", "kite"))
        a = draw.uniform(.3, 1.0)
        d = draw.uniform(1.5, 3.0) if kind != "kite" else a
        b = d if kind == "parallelogram" else a*draw.uniform(1.1, 3.0) if kind == "kite" else draw.uniform(1.05*a, d)
        c = a if kind == "parallelogram" else b if kind == "kite" else a + d - b
        bar = FourBar(a, b, c, d, draw.choice((1.0, -1.0)))
        start, rate = draw.uniform(.3, 2.8)*draw.choice((1, -1)), draw.uniform(1.0, 15.0)*draw.choice((1, -1))
        loose = draw.choice(("", ", TTOL=1E-9", ", TTOL=1E-6"))
        tables, _ = KALM.tables(bar.case(start, f"TEND=3.0, NTIME=30, VSTART={rate!r}{loose}"))
        t = tables["time"]
        passed += len(tables["events"]["time"]) if "events" in tables else 0
        off = 0.0
        for row, crank in enumerate(start + np.radians(t["input"] - t["input"][0])):
            for name, value in zip(("B.x", "B.y", "C.x", "C.y"), bar.places(crank + 0j)):
                off = max(off, abs(t[name][row] - value))
        check(f"random {kind} {number}: joints {off:.1e} off the closed form", off < 1e-10 and t["time"][-1] == 3.0)
        balance = np.max(np.abs(t["balance"]))/np.max(t["kinetic"])
        check(f"random {kind} {number}: energy in balance to {balance:.1e}", balance < (1e-3 if loose else 1e-11))
    check(f"random linkages: {passed} change points are passed", passed > 2*count)


def slider():
    """Crank and rod of 0.1 m: at a right angle the slide may stay at the pivot, or go on; masses and the couple of gravity."""
    text = ("ISOSCELES SLIDER-CRANK\n &CHAIN JNT='A','B','C', JX=0.0,0.06,0.12, JY=0.0,0.08,0.0, LNAME='frame','crank','rod','block',\n"
            "  LNK='A','A B','B C','C', SLNK='frame', SLNK2='block', SLX=0.12, SLY=0.0, SLANG=0.0 &END\n &DRIVES DRIVE='A' &END\n"
            " &OUTPUTS OUTPUT='point C' &END\n &METHOD NDES=1, DELT=0.0 &END\n"
            " &MASSES MNAME='crank A','rod B','block C', MASS=0.5,0.4,1.0, MDIST=0.05,0.05,0.0, MINERT=5E-4,4E-4,0.0, GRAVY=-9.81 &END\n"
            " &TIME TEND=0.5, NTIME=20, VSTART=10.0 &END\n")
    tables, said = KALM.tables(text)
    t, start = tables["time"], math.atan2(.08, .06)

    def reduced(th):
        # crank about A; rod: centre at 1.5 and .5 times the crank's projections; block at 2 a cos
        j = 5e-4 + .5*.05**2 + 4e-4 + .4*((.15*math.sin(th))**2 + (.05*math.cos(th))**2) + (.2*math.sin(th))**2
        return j, G*math.sin(th)*(.5*.05 + .4*.05)

    end = start + turn_of(t)
    j, v = reduced(start)
    energy, total, parts = .5*j*100.0 + v, 0.0, 60
    for k in range(parts):
        for x, weight in zip(NODES, WEIGHTS):
            j, v = reduced(start + (end - start)*(k + .5 + .5*x)/parts)
            total += .5*(end - start)/parts*weight*math.sqrt(.5*j/(energy - v))
    near(total, .5, 1e-11, "slider-crank of equal links: time to where the crank is then")
    off = np.max(np.abs(t["C.x"] - .2*np.cos(start + np.radians(t["input"]))))
    check(f"slider-crank of equal links: the block goes on beyond the pivot, {off:.1e} off", off < 1e-13)
    check("slider-crank of equal links: said, with the number of change points", FOLDS in said and len(tables["events"]["time"]) >= 2)


def what_acts():
    """A parallelogram with a motor and a damper, and onto a stop beside its change point."""
    bar = FourBar(1.0, 2.0, 1.0, 2.0)
    j = 1.0/3 + 1.5/3 + 2.0
    pulls = G*(.5 + 2.0 + .75)
    motor = " &MOTOR MTORQ=40.0, MSPEED=20.0, FLYWHL=0.5 &END\n"
    damper = " &SPRING ANAME='frame', BNAME='ab', STORS=1, STIFF=0.0, SFREE=0.0, SDAMP=1.5 &END\n"
    for method in ("", ", ISTIFF=1, TTOL=1E-11"):
        t, said = KALM.time(bar.case(1.0, "TEND=2.0, NTIME=40, VSTART=3.0" + method, motor + damper))
        exact = solve_ivp(lambda s, y: [y[1], (40.0*(1 - y[1]/20.0) - 1.5*y[1] - pulls*math.cos(y[0]))/(j + .5)], (0.0, 2.0), [1.0, 3.0],
                          method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        tolerance = 1e-6 if method else 1e-11
        near(1.0 + turn_of(t), exact[0], tolerance, f"parallelogram with motor and damper{method}: crank")
        near(t["input.v"][-1], exact[1], tolerance, f"parallelogram with motor and damper{method}: its rate")
        off = np.max(np.abs(t["C.x"] - t["B.x"] - 2.0)) + np.max(np.abs(t["C.y"] - t["B.y"]))
        check(f"parallelogram with motor and damper{method}: stays one, {off:.1e} off", off < 1e-12 and FOLDS in said)
        check(f"parallelogram with motor and damper{method}: energy in balance",
              np.max(np.abs(t["balance"])) < (1e-4 if method else 1e-9))
        wanted = 40.0*(1 - t["input.v"]/20.0) - .5*t["input.a"]
        check(f"parallelogram{method}: the drive is its motor less its flywheel", np.max(np.abs(t["drive"] - wanted)) < 1e-9)
    # a stop 2 degrees beyond the change point
    stop = math.degrees(math.pi - 1.0) + 2.0
    tables, _ = KALM.tables(bar.case(1.0, "TEND=0.8, NTIME=80, VSTART=4.0", f" &STOPS STNAME='A', STHIGH={stop!r}, STREST=0.5 &END\n"))
    events = tables["events"]
    check(f"onto a stop: what happens {events['event'][:4]}", events["event"][:3] == ["change", "impact", "change"])
    speed = math.sqrt(16.0 + 2*pulls/j*(math.sin(1.0) - math.sin(1.0 + math.radians(stop))))
    near(events["before"][1], speed, 1e-11, "onto a stop: rate before the impact")
    near(events["after"][1], -.5*speed, 1e-11, "onto a stop: rate after it")
    near(tables["time"]["lost"][-1] if events["event"].count("impact") == 1 else .375*j*speed**2, .375*j*speed**2, 1e-10,
         "onto a stop: what is lost")


def gaps():
    """A linkage that is a change point but for rounding, and one that is none."""
    bar = FourBar(1.0, 2.5, 1.5, 3.0)
    exact, _ = KALM.time(bar.case(2.5, "TEND=1.0, NTIME=10, VSTART=2.0"))
    for longer in (1e-9, -1e-9):
        tables, said = KALM.tables(bar.case(2.5, "TEND=1.0, NTIME=10, VSTART=2.0", longer=longer))
        off = max(np.max(np.abs(tables["time"][name] - exact[name])) for name in ("B.x", "B.y", "C.x", "C.y"))
        check(f"coupler {longer} m longer: goes straight on, {off:.1e} beside the exact linkage", off < 1e-7)
        check(f"coupler {longer} m longer: a remark says so", "misses a change point that the motion passes by" in said and FOLDS in said)
    tables, said = KALM.tables(bar.case(2.5, "TEND=1.0, NTIME=100, VSTART=2.0", longer=1e-4))
    t = tables["time"]
    side = (t["C.x"] - t["B.x"])*(0.0 - t["B.y"]) - (t["C.y"] - t["B.y"])*(3.0 - t["B.x"])
    check("coupler 1E-4 m longer: no change point, the same side", FOLDS not in said and "events" not in tables and (np.all(side > 0.0)
          or np.all(side < 0.0)))
    check("coupler 1E-4 m longer: passes it all the same", math.degrees(2.5) + t["input"][-1] > 200.0)
    check("coupler 1E-4 m longer: energy in balance", np.max(np.abs(t["balance"])) < 1e-10*np.max(t["kinetic"]))
    # 1E-4 m shorter the crank cannot turn round: it turns back in a sharp corner, which the rocker goes through
    t, said = KALM.time(bar.case(2.5, "TEND=1.0, NTIME=100, VSTART=2.0", longer=-1e-4))
    check("coupler 1E-4 m shorter: turns back, by the rocker as coordinate", FOLDS not in said and "D from 0.21" in said
          and t["time"][-1] == 1.0 and 2.5 + math.radians(np.max(t["input"])) < math.pi)
    check("coupler 1E-4 m shorter: energy in balance", np.max(np.abs(t["balance"])) < 1e-8*np.max(t["kinetic"]))


def two_freedoms():
    """A pendulum on the coupler of a parallelogram: the motion ends at the change point, and says so."""
    text = FourBar(1.0, 2.0, 1.0, 2.0).case(1.0, "TEND=1.0, NTIME=10, VNAME='A', VSTART=5.0")
    for old, new in (("JNT='A','B','C','D', JX=0.0,", "JNT='P','Q','A','B','C','D', JX=1.5403023058681398,1.54,0.0,"),
                     ("JY=0.0,", "JY=0.8414709848078965,0.3,0.0,"), ("'cd',", "'cd','pendulum',"), ("'B C',", "'B C P',"),
                     ("'D C' &END", "'D C','P Q' &END"), ("DRIVE='A'", "DRIVE='A','P', DELT2=0.0"), ("MNAME='ab A',", "MNAME='pendulum P','ab A',"),
                     ("MASS=", "MASS=1.0,"), ("MDIST=", "MDIST=0.25,"), ("MINERT=", "MINERT=0.05,")):
        check(f"two freedoms: {old} is in the case", old in text)
        text = text.replace(old, new, 1)
    t, said = KALM.time(text, want=1)
    check("two freedoms: ends before the change point, and says what it may be", t["time"][-1] < .5 and "a change point" in said)
    check("two freedoms: energy in balance as far as it goes", np.max(np.abs(t["balance"])) < 1e-9*np.max(t["kinetic"]))


def page():
    """The page of balm shows the motion, not the other one."""
    picture_tools.programs = os.path.abspath(sys.argv[1])
    folder = KALM.folder
    text = FourBar(1.0, 2.5, 1.5, 3.0).case(2.5, "TEND=2.0, NTIME=50, VSTART=2.0")
    with open(os.path.join(folder, "page.nml"), "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(picture_tools.programs, "balm"), "--animate", "--quiet", "page.nml"], cwd=folder,
                          capture_output=True, text=True, check=False)
    check("balm draws it", done.returncode == 0)
    case = picture_tools.page_data(os.path.join(folder, "page.html"))[0]
    t, _ = KALM.time(text)
    names, sweep = [joint["name"] for joint in case["joints"]], case["sweep"]
    frames = [round(time/2.0*(sweep["n"] - 1)) for time in t["time"]]
    off = max(abs(sweep[axis][names.index("C")][frame] - value) for axis in "xy" for frame, value in zip(frames, t["C." + axis]))
    check(f"the page: the rocker's joint, {off:.1e} off", off < 1e-8 and "0" not in sweep["closed"])
    check("the page: data are JSON", json.dumps(case) != "")


if __name__ == "__main__":
    four_bars()
    grashof_and_others()
    random_linkages(15)
    slider()
    what_acts()
    gaps()
    two_freedoms()
    page()
    sys.exit(report())
