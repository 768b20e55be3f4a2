#!/usr/bin/env python3
"""Motion from torque against an independent integration: kalm's steady cycle, run-up and verdicts of a press.

usage: machines.py BIN   (directory with the programs). The last line is N passed, N failed.

Here the press is solved by circles, its inertia and the torque of its loads follow from velocities, and SciPy's implicit Runge-Kutta
method (Radau) integrates the energy over the crank angle, piece by piece between the corners of the load. With a strong motor and
little inertia that equation is stiff: its speed settles within hundredths of a degree.
"""
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
DEGREE = math.pi/180.0
CRANK, ROD, UPPER, LOWER = 20.0, math.hypot(114.0, 20.0), math.hypot(4.0, 120.0), math.hypot(4.0, 120.0)   # millimetres
PIVOT, HANGER, SLIDE = (0.0, 0.0), (118.0, 160.0), 118.0
ROD_MASS, LOWER_MASS, RAM_MASS = 3.0, 4.0, 20.0                 # kg, the rod at 40 mm from B, the lower link at 55 mm from C
LOAD, CORNERS, HEIGHTS = 20000.0, (0.0, 20.0, 60.0, 80.0), (0.0, 1.0, 1.0, 0.0)


def places(angle):
    """B, C, E of the press, mm, as complex numbers."""
    b = complex(*PIVOT) + CRANK*complex(math.cos(angle), math.sin(angle))
    gap = complex(*HANGER) - b
    along = (ROD**2 - UPPER**2 + abs(gap)**2)/(2.0*abs(gap))
    c = b + (along - 1j*math.sqrt(ROD**2 - along**2))*gap/abs(gap)
    return b, c, complex(SLIDE, c.imag - math.sqrt(LOWER**2 - (SLIDE - c.real)**2))


def at_unit_speed(angle):
    """Inertia at the crank, kg m2, and torque of weight and load, N m."""
    b, c, e = places(angle)
    vb = 1j*CRANK*complex(math.cos(angle), math.sin(angle))
    # C keeps its distances from B and the hanger, E its distance from C
    u, w = c - b, c - complex(*HANGER)
    vc = complex(*np.linalg.solve([[u.real, u.imag], [w.real, w.imag]], [(u.conjugate()*vb).real, 0.0]))
    r = e - c
    ve = 1j*(vc.imag + r.real*vc.real/r.imag)
    v1, v2 = vb + 40.0/ROD*(vc - vb), vc + 55.0/LOWER*(ve - vc)
    inertia = 1e-6*(ROD_MASS*abs(v1)**2 + LOWER_MASS*abs(v2)**2 + RAM_MASS*abs(ve)**2)
    force = LOAD*np.interp(angle/DEGREE % 360.0, CORNERS, HEIGHTS)
    torque = 1e-3*(force*ve.imag - 9.81*(ROD_MASS*v1.imag + LOWER_MASS*v2.imag + RAM_MASS*ve.imag))
    return inertia, torque


class Machine:
    """A press with its motor: torque MTORQ (1 - w/MSPEED) and flywheel."""

    def __init__(self, torque, idle, flywheel):
        self.torque, self.idle, self.flywheel = torque, idle, flywheel

    def rate(self, angle, energy):
        inertia, load = at_unit_speed(angle)
        speed = math.copysign(math.sqrt(2.0*abs(energy)/(inertia + self.flywheel)), energy)
        return self.torque*(1.0 - speed/self.idle) + load

    def turn(self, energy):
        """Energy after a turn, angles and speeds, the time; or the angle in degrees at which the energy is spent."""
        edges = [DEGREE*c for c in CORNERS] + [2.0*math.pi]
        angles, speeds, time = [], [], 0.0
        for a, b in zip(edges, edges[1:]):
            spent = lambda x, y: y[0]
            spent.terminal, spent.direction = True, -1
            run = solve_ivp(lambda x, y: [self.rate(x, y[0])], (a, b), [energy], method="Radau", rtol=1e-9, atol=1e-13,
                            events=spent, dense_output=True)
            if run.t_events[0].size:
                return run.t_events[0][0]/DEGREE
            x = np.linspace(a, b, 2001)
            j = CubicSpline(x[::20], [at_unit_speed(p)[0] for p in x[::20]])(x)       # smooth
            w = np.sqrt(2.0*run.sol(x)[0]/(j + self.flywheel))
            weights = np.ones(x.size)
            weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
            time += (x[1] - x[0])/3.0*np.sum(weights/w)
            angles.append(x)
            speeds.append(w)
            energy = run.y[0, -1]
        return energy, np.concatenate(angles), np.concatenate(speeds), time

    def cycle(self):
        """Least, greatest and mean speed of the steady cycle: the energy that comes back after a turn."""
        after = lambda e: self.turn(e)[0]
        energy = 0.5*(at_unit_speed(0.0)[0] + self.flywheel)*self.idle**2
        first = after(energy)
        if abs(after(first) - first) > 1e-7*first:
            first = brentq(lambda e: after(e) - e, 0.5*first, energy, xtol=1e-12*energy, rtol=1e-12)
        _, _, w, time = self.turn(first)
        return w.min(), w.max(), 2.0*math.pi/time


def kalm(motor):
    """Exit status, the part of the listing on motion from torque, and what is reported on standard error."""
    b, c, e = places(0.0)
    text = """KNUCKLE PRESS
 &CHAIN JNT='A','B','C','D','E', JX=%r,%r,%r,%r,%r, JY=%r,%r,%r,%r,%r,
  LNAME='frame','crank','rod','upper','lower','ram',
  LNK='A D','A B','B C','D C','C E','E', SLNK='frame', SLNK2='ram', SLX=118, SLY=-80, SLANG=90 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='angle rod' &END
 &METHOD IKIN=5 &END
 &RATES SPEED=60, UNITS='REV/MIN' &END
 &MASSES NMASS=3, MNAME='rod','lower','ram', MASS=%r,%r,%r, MDIST=40,55,0, UNITL=0.001, GRAVY=-9.81 &END
 &LOADS NLOAD=1, LNAME='ram', LFY=%r, LTABLE=1, NTABLE=1, NTABIN=4, TABIN=0,20,60,80, TABVAL=0,1,1,0 &END
 &MOTOR %s &END
""" % (PIVOT[0], b.real, c.real, HANGER[0], e.real, PIVOT[1], b.imag, c.imag, HANGER[1], e.imag, ROD_MASS, LOWER_MASS, RAM_MASS, LOAD, motor)
    with tempfile.TemporaryDirectory() as place:
        with open(os.path.join(place, "press.nml"), "w") as file:
            file.write(text)
        run = subprocess.run([os.path.join(BIN, "kalm"), "press.nml"], cwd=place, capture_output=True, text=True, timeout=120)
    return run.returncode, run.stdout.partition("MOTION FROM TORQUE")[2], run.stderr


def numbers(text):
    return [float(n.replace("D", "E")) for n in re.findall(r"[-+]?\d*\.\d+(?:D[-+]\d+)?", text)]


def row(listing, head):
    """Numbers in the line that contains `head`."""
    lines = [line for line in listing.splitlines() if head in line]
    return numbers(lines[0]) if lines else []


def near(got, wanted, tolerance, law):
    check(law, len(got) >= len(wanted) and all(abs(g - w) <= tolerance*abs(w) for g, w in zip(got, wanted)), (got, wanted))


def main():
    np.seterr(over="ignore")     # of Radau's own differences
    # from stiff (nothing but the links) to a flywheel that takes turns to settle; just above what the load asks of the motor
    for torque, flywheel in ((200.0, 0.0), (200.0, 0.01), (40.0, 0.0), (33.0, 0.0), (200.0, 2.0), (20.0, 5.0)):
        name = "MTORQ=%r, MSPEED=8.0, FLYWHL=%r" % (torque, flywheel)
        code, listing, error = kalm(name)
        check(name + ": balance", code == 0 and "TORQUE AND SPEED ARE IN BALANCE" in listing, (code, error))
        least, greatest, mean = Machine(torque, 8.0, flywheel).cycle()
        found = row(listing, "LEAST SPEED")
        tolerance = 2e-6 if flywheel == 0.0 else 2e-7     # corners of the load, and seven digits
        near(found[::2], [least, greatest], max(tolerance, 1e-6*8.0/least if torque < 40 else 0.0), name + ": least and greatest speed")
        near(row(listing, "MEAN SPEED"), [mean, 2.0*math.pi/mean], tolerance, name + ": mean speed and time of a turn")
        claimed = row(listing, "ESTIMATED ERROR OF THE SPEEDS")
        check(name + ": error claimed", claimed and abs(found[0] - least) <= 2.0*claimed[0]*greatest + 1e-7*greatest, (claimed, found, least))

    # run-up of the stiff machine from rest and from a speed far above
    machine = Machine(200.0, 8.0, 0.0)
    for start in (0.0, 50.0):
        code, listing, error = kalm("MTORQ=200, MSPEED=8, NTURN=2, WSTART=%r" % start)
        first = at_unit_speed(0.0)[0]
        # from rest the first ten thousandths of a degree are run at the torque at rest
        tiny = 1e-9
        begin = 0.5*first*start**2 if start else tiny*machine.rate(0.0, 0.0)
        # time over the first turn by itself: the speed changes fast at its beginning
        def rates(x, y):
            inertia, _ = at_unit_speed(x)
            return [machine.rate(x, y[0]), math.sqrt(inertia/(2.0*max(y[0], 1e-300)))]
        time = math.sqrt(2.0*tiny*first/machine.rate(0.0, 0.0)) if not start else 0.0
        state = [begin, time]
        edges = [DEGREE*c for c in CORNERS] + [2.0*math.pi]
        edges[0] = 0.0 if start else tiny
        for a, b in zip(edges, edges[1:]):
            state = solve_ivp(rates, (a, b), state, method="Radau", rtol=1e-9, atol=1e-13).y[:, -1]
        rows = [numbers(line) for line in listing.partition("RUN-UP")[2].splitlines() if re.match(r" +\d+ +\d", line)]
        check("run-up from %g: two turns" % start, code == 0 and len(rows) == 2, (code, error, listing[-300:]))
        if len(rows) == 2:
            near(rows[0], [state[1], math.sqrt(2.0*state[0]/first)], 2e-6, "run-up from %g: time and speed after a turn" % start)
            near(rows[1][1:], [row(listing, "            0.0")[-1]], 2e-6, "run-up from %g: the second turn is the cycle" % start)

    # too weak at rest for the load: it stops where the energy is spent, from whatever speed; and a motor that the weights overcome
    for torque, flywheel in ((25.0, 0.0), (31.0, 0.01)):
        code, listing, error = kalm("MTORQ=%r, MSPEED=8, FLYWHL=%r, NTURN=3, WSTART=8" % (torque, flywheel))
        check("MTORQ=%g: it stops" % torque, code == 1 and "THE MACHINE STOPS AT" in listing and "stops at" in error, (code, error))
        wanted = Machine(torque, 8.0, flywheel).turn(0.5*(at_unit_speed(0.0)[0] + flywheel)*64.0)
        near(row(listing, "IT STOPS AT"), [wanted], 0.4/wanted, "MTORQ=%g: run-up stops there" % torque)
    # the same load with a flywheel that carries the crank over it
    code, listing, error = kalm("MTORQ=25, MSPEED=8, FLYWHL=5")
    least, greatest, mean = Machine(25.0, 8.0, 5.0).cycle()
    check("a flywheel carries it over the load", code == 0, error)
    near(row(listing, "LEAST SPEED")[::2], [least, greatest], 2e-7, "least and greatest speed with this flywheel")
    # a torque that first rises with the speed: at rest it is below the mean load, yet there is a cycle
    code, listing, error = kalm("NMTAB=3, MTABW=0,4,8, MTABT=1,60,0, FLYWHL=50")
    check("torque rises with the speed: balance", code == 0 and row(listing, "MEAN SPEED")[0] > 7.0, (code, error))
    return report()


sys.exit(main())
