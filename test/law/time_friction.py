#!/usr/bin/env python3
"""Coulomb friction with stiction in time: closed forms, published numbers, laws, bad input.

usage: time_friction.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import math
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report
from timed import Kalm, data, near

KALM = Kalm(sys.argv[1])
G = 9.81


def block(angle, gravity, x0=0.0):
    """2 kg on a slide at an angle, x0 from the joint P of the frame."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return f"""BLOCK ON A ROUGH SLIDE
 &CHAIN JNT='P','A', JX=0.0,{x0*c!r}, JY=0.0,{x0*s!r}, LNAME='frame','block', LNK='P','A', NSLIDE=1, SLNK='frame', SLNK2='block',
  SLX=0.0, SLY=0.0, SLANG={angle!r} &END
 &DRIVES DRIVE='S1' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='block A', MASS=2.0, MDIST=0.0, GRAVY={-gravity!r} &END
"""


def closed_forms():
    # 2 kg, 200 N/m, mu .15 from 0.1 at rest: half oscillations about +-d; the spring acts between the frame at P and the block
    d = .15*2*G/200
    text = data("rough_slide")
    blocks, said = KALM.tables(text)
    t, events = blocks["time"], blocks["events"]
    x = t["A.x"]
    for k, want in ((1, -(.1 - 2*d)), (2, .1 - 4*d), (3, -(.1 - 6*d))):
        row = int(np.argmin(np.abs(t["time"] - k*math.pi/10)))
        near(t["time"][row], k*math.pi/10, 1e-12, "a time of the table is that of a stop")
        near(x[row], want, 1e-12, f"block and spring: place of stop {k}")
    row = int(np.argmin(np.abs(t["time"] - .25)))
    near(x[row], -.0536105332519202, 1e-12, "block and spring: place at 0.25 s")
    near(t["A.vx"][row], -.510406968099059, 1e-12, "block and spring: speed at 0.25 s")
    near(events["time"][-1], 3*math.pi/10, 1e-12, "block and spring: sticks")
    check("block and spring: one event, it sticks", list(events["event"]) == ["stick"])
    near(abs(t["friction.S1"][-1]), 200*abs(.1 - 6*d), 1e-12, "block and spring: what friction holds then")
    check("block and spring: it stands exactly", t["A.vx"][-1] == 0.0 and x[-1] == x[-2])
    near(t["lost"][-1], .15*2*G*(2*(.1 - d) + 2*(.1 - 3*d) + 2*(.1 - 5*d)), 1e-12, "block and spring: work of friction")
    check("block and spring: energy in balance", np.max(np.abs(t["balance"])) < 1e-12)
    check("block and spring: the summary says so", "Sticks S1" in said and "2.34" in said)

    # incline of 30 degrees, mu .3, up at 2 m/s: stops and slides back
    friction = " &FRICTN FNAME='S1', FMU=0.3 &END\n"
    t, _ = KALM.time(block(30.0, G) + friction + " &TIME VSTART=2.0, TAT=.268322655232618,.745554651954863 &END\n")
    near(math.hypot(t["A.x"][1], t["A.y"][1]), .268322655232618, 1e-12, "incline: how far up")
    near(math.hypot(t["A.x"][2], t["A.y"][2]), 0.0, 1e-12, "incline: back again")
    near(math.hypot(t["A.vx"][2], t["A.vy"][2]), 1.12449566280354, 1e-12, "incline: its speed there")
    # steeper friction: it stays where it stops; a greater coefficient at rest keeps it, too
    for items, name in (("FMU=0.6", "FMU"), ("FMU=0.3, FSTAT=0.6", "FSTAT")):
        b, _ = KALM.tables(block(30.0, G) + f" &FRICTN FNAME='S1', {items} &END\n &TIME VSTART=2.0, TEND=2.0, NTIME=4 &END\n")
        mu = .6 if name == "FMU" else .3
        brake = G*(.5 + mu*math.cos(math.pi/6))
        near(math.hypot(b["time"]["A.x"][-1], b["time"]["A.y"][-1]), 2.0/brake, 1e-12, f"incline with {name}: it stays where it stops")
        near(b["events"]["time"][0], 2.0/brake, 1e-12, f"incline with {name}: when it stops")
        near(abs(b["time"]["friction.S1"][-1]), G, 1e-12, f"incline with {name}: friction holds m g/2")
    # pulled by a moving spring: sticks, slips when the spring pulls mu_s m g
    text = block(0.0, G) + """ &FRICTN FNAME='S1', FMU=0.1, FSTAT=0.25 &END
 &TIME TEND=1.0, NTIME=10 &END
"""
    t, _ = KALM.time(text)
    check("at rest with nothing that pulls: it stands", np.all(t["A.x"] == 0.0) and np.all(t["A.vx"] == 0.0))


def crank_and_slide():
    """Friction whose load contains the acceleration (page of the theory: quadrature over the crank)."""
    r, l = .05, .15
    x, y = r*math.cos(.3), r*math.sin(.3)
    c = x + math.sqrt(l*l - y*y)

    def case(mu, more="", time=" &TIME VSTART=20.0, TAT=.356482487266544 &END\n"):
        return f"""ROUGH SLIDER-CRANK
 &CHAIN JNT='A','B','C', JX=0.0,{x!r},{c!r}, JY=0.0,{y!r},0.0, LNAME='frame','crank','rod','slide', LNK='A','A B','B C','C',
  NSLIDE=1, SLNK='frame', SLNK2='slide', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='A' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='crank A','rod B','slide C', MASS=0.0,0.3,0.5, MDIST=0.0,{l/2!r},0.0, MINERT=.002,{.3*l*l/12!r},0.0 &END
 &FRICTN FNAME='S1', FMU={mu!r} &END
{more}{time}"""

    t, _ = KALM.time(case(.2))
    near(t["input"][-1] % 360.0, 360.0 if t["input"][-1] > 359.0 else 0.0, 1e-10, "slider-crank: one turn with friction")
    near(t["input.v"][-1], 19.3045540773625, 1e-11, "slider-crank: speed after it")
    t, _ = KALM.time(case(0.0, time=" &TIME VSTART=20.0, TAT=.349913153540461 &END\n"))
    near(t["input.v"][-1], 20.0, 1e-11, "slider-crank: without friction the speed comes back")
    # friction at the pins brings it to rest; it stands then
    pins = " &LOADS LNAME='slide C', LFY=-40.0 &END\n"
    text = case(.2, pins, " &TIME VSTART=3.0, TEND=3.0, NTIME=30 &END\n").replace("FNAME='S1', FMU=0.2", "FNAME='S1','A','B', FMU=0.3,0.2,0.2, "
                                                                                "FRAD=0.0,0.01,0.01")
    b, said = KALM.tables(text)
    check("slider-crank with weight: comes to rest", b["events"]["event"][-1] == "stick" and b["time"]["input.v"][-1] == 0.0)
    check(f"slider-crank with weight: energy in balance {np.max(np.abs(b['time']['balance'])):.1e}", np.max(np.abs(b["time"]["balance"])) < 1e-11)
    near(b["time"]["lost"][-1] + b["time"]["potential"][-1] - b["time"]["work"][-1] - b["time"]["potential"][0] - b["time"]["kinetic"][0], 0.0,
         1e-11, "slider-crank with weight: all its energy is lost in friction")


def pin_pendulum():
    """A pendulum with friction in its pin, against an integration of its own equation piece by piece."""
    from scipy.integrate import solve_ivp
    m, h, inertia, radius, mu = 1.0, .5, 1/12, .02, .3
    text = f"""PENDULUM WITH A ROUGH PIN
 &CHAIN JNT='O','P', JX=0.0,1.0, JY=0.0,0.0, LNAME='frame','bar', LNK='O','O P' &END
 &DRIVES DRIVE='O' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='bar O', MASS={m}, MDIST={h}, MINERT={inertia!r}, GRAVY=-9.81 &END
 &FRICTN FNAME='O', FMU={mu}, FRAD={radius} &END
 &TIME TEND=3.0, NTIME=30 &END
"""

    def accel(q, v, s):
        a = 0.0
        for _ in range(200):
            fx = m*h*(-a*math.sin(q) - v*v*math.cos(q))
            fy = m*h*(a*math.cos(q) - v*v*math.sin(q)) + m*G
            new = (-m*G*h*math.cos(q) - s*mu*radius*math.hypot(fx, fy))/(inertia + m*h*h)
            if abs(new - a) < 1e-15:
                break
            a = new
        return a

    q, v, time, s = 0.0, 0.0, 0.0, -1.0
    turns = []
    for _ in range(20):
        def stop(_, y):
            return y[1]
        stop.terminal, stop.direction = True, -s
        done = solve_ivp(lambda _, y, s=s: [y[1], accel(y[0], y[1], s)], (time, 3.0), [q, v], method="DOP853", rtol=1e-12, atol=1e-13,
                         events=stop, first_step=1e-4)
        q, v, time = done.y[0, -1], done.y[1, -1], done.t[-1]
        if done.status == 0:
            break
        turns.append((time, q))
        v, s = 0.0, -s
    t, said = KALM.time(text)
    near(math.radians(t["input"][-1]), q, 1e-10, "pendulum with a rough pin: angle at the end")
    near(t["input.v"][-1], v, 1e-10, "pendulum with a rough pin: its rate")
    check("pendulum with a rough pin: it has turned back", len(turns) > 2)
    check("pendulum with a rough pin: energy in balance", np.max(np.abs(t["balance"])) < 1e-11)


def mistakes():
    text = data("rough_slide")
    _, said = KALM.tables(text.replace("FMU=0.15", "FMU=0.15, FSTAT=0.1"), want=2)
    check(f"a coefficient at rest below that of slip: {said[:200]}", "below that of slip" in said)
    _, said = KALM.tables(text[:text.index(" &TIME")].replace("FMU=0.15", "FMU=0.15, FSTAT=0.2"), want=2)
    check(f"a coefficient at rest without &TIME: {said[:200]}", "give &TIME" in said)
    _, said = KALM.tables(text.replace("&TIME", "&TIME IEQUIL=1,"), want=2)
    check(f"equilibria with friction: {said[:200]}", "whole ranges" in said)


def rough_joints():
    """Friction in several joints, dead points of drives passed: an independent integration of all poses with multipliers."""
    import random
    from rough_witness import random_rough
    sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "campaign"))
    from motion_campaign import KINDS, difference
    worst = 0.0
    for number in range(15):
        draw = random.Random(39013 + number)
        kind = KINDS[number % len(KINDS)]
        case, witness, order, holder = random_rough(draw, kind)
        end = draw.uniform(.25, .7)
        t, said = KALM.time(case + f" &TIME TAT={end!r} &END\n")
        if t is None or t["time"][-1] != end:
            check(f"{kind} {number} comes to its end: {said[-300:]}", False)
            continue
        error = difference(t, witness, order, holder, end)
        if error is None:
            check(f"{kind} {number}: joints that hold each other stick", "Sticks" in said)
            continue
        worst = max(worst, error)
        check(f"{kind} {number}: joints and speeds at {end:.3f} s are {error:.1e} off", error < 1e-7)
        scale = max(np.max(t["kinetic"]), np.max(np.abs(t["lost"])), 1e-2)
        check(f"{kind} {number}: energy in balance", np.max(np.abs(t["balance"])) < 1e-10*scale)
    print(f"largest difference from the witness {worst:.1e}")
    # all joints rough, for so long that some stick, two of them at the same time or one after the other
    for number in range(20):
        draw = random.Random(39600 + number)
        kind = KINDS[number % len(KINDS)]
        case, _, _, _ = random_rough(draw, kind)
        t, said = KALM.time(case + " &TIME TEND=3.0, NTIME=20 &END\n")
        check(f"{kind} {number} rough for three seconds comes to its end: {said[-300:]}", t is not None and t["time"][-1] == 3.0)


closed_forms()
crank_and_slide()
rough_joints()
pin_pendulum()
mistakes()
sys.exit(report())
