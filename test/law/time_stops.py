#!/usr/bin/env python3
"""Stops of joints with &TIME: published numbers, closed forms, an independent integration with events, laws, bad input.

usage: time_stops.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import math
import os
import sys

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report
from timed import Kalm, data, near

KALM = Kalm(sys.argv[1])
METHOD = " &METHOD NDES=1, DELT=0.0 &END\n"

FOUR_BAR = """FOUR-BAR ONTO A STOP
 &CHAIN JNT='A','B','C','D', JX=0.0,0.3,1.1,1.3, JY=0.0,0.4,0.7,0.0, LNAME='frame','ab','bc','cd', LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
""" + METHOD + f""" &MASSES MNAME='ab A','bc B','cd C', MASS=1.0,2.0,1.5, MDIST=.25,{math.hypot(.8, .3)/2!r},{math.hypot(.2, .7)/2!r},
  MINERT={1/48!r},{2*.73/12!r},{1.5*.53/12!r}, GRAVY=-9.81 &END
 &STOPS STNAME='A', STLOW={math.degrees(.3 - math.atan2(.4, .3))!r}, STREST=0.5 &END
 &TIME TEND=1.0, NTIME=20 &END
"""

SLIDE = """A MASS ON A SLIDE
 &CHAIN JNT='P','A', JX=0.0,0.0, JY=0.0,0.0, LNAME='frame','block', LNK='A','P', NSLIDE=1, SLNK='frame', SLNK2='block',
  SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
""" + METHOD + """ &MASSES MNAME='block P', MASS=2.0, MDIST=0.0 &END
"""

TWO_BARS = """TWO UNIFORM BARS
 &CHAIN JNT='A','B','C', JX=0.0,1.0,2.0, JY=3*0.0, LNAME='frame','ab','bc', LNK='A','A B','B C' &END
 &DRIVES DRIVE='A','B', DBASE='frame','ab', DLINK='ab','bc', DELT2=0.0 &END
""" + METHOD + """ &MASSES MNAME='ab A','bc B', MASS=1.0,1.0, MDIST=0.5,0.5, MINERT=.0833333333333333333,.0833333333333333333 &END
"""


def published():
    """Page of the theory: quadratures in 34 digits."""
    blocks, _ = KALM.tables(FOUR_BAR)
    events, t = blocks["events"], blocks["time"]
    for got, want in zip(events["time"], (.317301418870548, .505629320320364, .598704495846735, .645225631770632)):
        near(got, want, 2e-13, "four-bar: time of an impact")
    near(events["time"][9], .691021374304380, 1e-12, "four-bar: the tenth")
    near(events["time"][-1], .691748298404071, 2e-10, "four-bar: rests from then on")
    check("four-bar: ends with rest", events["event"][-1] == "rest" and set(events["event"][:-1]) == {"impact"})
    near(events["before"][0], -4.86133874006246, 1e-12, "four-bar: rate before the first impact")
    check("four-bar: half of the rate comes back", np.allclose(events["after"][:10], -.5*np.array(events["before"][:10]), rtol=1e-14))
    near(events["impulse"][0], 1.5*4.86133874006246*.30475906380045, 1e-12, "four-bar: impulse, inertia at the stop times change")
    near(t["C.x"][-1], 1.12410089188574, 1e-13, "four-bar: C at the stop")
    near(t["C.y"][-1], .706441436896652, 1e-13, "four-bar: C at the stop, y")
    check("four-bar: energy in balance", np.max(np.abs(t["balance"])) < 1e-12)

    blocks, _ = KALM.tables(data("toggle"))
    events, t = blocks["events"], blocks["time"]
    for got, want in zip(events["time"], (.0493531839022665, .05581757514054, .0578855946533759)):
        near(got, want, 1e-13, "toggle: time of an impact")
    near(events["time"][-1], .0587790891591021, 1e-11, "toggle: rests from then on")
    near(events["before"][0], -148.644060963935, 1e-12, "toggle: rate before the first impact")
    near(t["stop.A"][-1], 3.1611591447834, 1e-12, "toggle: what the stop bears")
    check("toggle: no torque at the free drive, in motion or at rest", np.max(np.abs(t["drive"])) < 1e-12)

    blocks, _ = KALM.tables(TWO_BARS + " &STOPS STNAME='B', STLOW=0.0, STREST=0.5 &END\n"
                            " &TIME TAT=1E-9, VNAME='A','B', VSTART=1.0,-3.0 &END\n")
    events, t = blocks["events"], blocks["time"]
    near(t["input.A.v"][-1], -.40625, 1e-8, "knee: rate of the first bar")
    near(t["input.A.v"][-1] + t["input.B.v"][-1], 1.09375, 1e-8, "knee: rate of the second bar")
    near(events["impulse"][0], .328125, 1e-13, "knee: impulse")
    near(t["lost"][-1], .24609375, 1e-8, "knee: loss")
    check("knee: at time 0", events["time"][0] == 0.0 and len(events["time"]) == 1)


def closed_forms():
    # thrown at a wall by a force: x = v t + F t^2/(2 m); of a drawing in millimetres the same
    for unit, names in ((1.0, ""), (1e-3, ", UNITL=0.001")):
        case = SLIDE.replace("MDIST=0.0", "MDIST=0.0" + names) + f" &LOADS LNAME='block P', LFX=6.0 &END\n &STOPS STNAME='S1', " \
            f"STHIGH={1.0/unit!r}, STREST=0.5 &END\n &TIME TEND=3.0, NTIME=30, VSTART={.5/unit!r} &END\n"
        blocks, _ = KALM.tables(case)
        events, t = blocks["events"], blocks["time"]
        v = math.sqrt(.25 + 6.0)
        hit = (v - .5)/3.0
        near(events["time"][0], hit, 1e-14, "a block that a force throws at a wall: when")
        near(events["before"][0], v/unit, 1e-13, "how fast")
        near(events["impulse"][0], -1.5*2.0*v, 1e-13, "with what impulse, N s")
        near(events["time"][-1], hit + 2.0*(.5*v)/3.0/(1 - .5), 1e-9, "when it rests: a geometric series")
        near(t["stop.S1"][-1], -6.0, 1e-13, "the wall bears the force, N")
        near(t["input"][-1], 1.0/unit, 1e-14, "at the wall")
        check("at rate 0", t["input.v"][-1] == 0.0)
        near(t["lost"][-1], 2.0*v*v/2.0, 1e-9, "all energy is lost")
        check("energy in balance", np.max(np.abs(t["balance"])) < 1e-12)
    # the other way round
    blocks, _ = KALM.tables(SLIDE.replace("SLANG=0.0", "SLANG=180.0") + " &LOADS LNAME='block P', LFX=6.0 &END\n &STOPS STNAME='S1', "
                            "STLOW=-1.0, STREST=0.5 &END\n &TIME TEND=1.0, NTIME=3, VSTART=-.5 &END\n")
    near(blocks["events"]["time"][0], hit, 1e-14, "a slide drawn the other way meets its lower stop at the same time")
    # between two walls without loss
    blocks, _ = KALM.tables(SLIDE + " &STOPS STNAME='S1', STLOW=-1.0, STHIGH=0.5, STREST=1.0 &END\n &TIME TEND=9.9, NTIME=3, VSTART=1.0 &END\n")
    check("between two walls: every 1.5 s", np.allclose(blocks["events"]["time"], .5 + 1.5*np.arange(7), rtol=1e-14))
    check("without loss", np.max(np.abs(blocks["time"]["lost"])) < 1e-14)
    # e = 0: it stays where a force presses, else it stops and stays without force
    blocks, _ = KALM.tables(SLIDE + " &STOPS STNAME='S1', STHIGH=0.5 &END\n &TIME TEND=2.0, NTIME=2, VSTART=1.0 &END\n")
    check("a block without a force stays at the wall", blocks["time"]["input"][-1] == .5 and blocks["time"]["input.v"][-1] == 0.0)
    near(blocks["time"]["lost"][-1], 1.0, 1e-14, "its energy is lost")
    # a spring from 1 to -1: a stop just there is touched at rate 0, one just beyond is not touched, one before is hit
    oscillator = SLIDE.replace("JX=0.0,0.0", "JX=1.0,0.0") + " &SPRING ANAME='frame A', BNAME='block P', STIFF=2.0 &END\n"
    for at, hits in ((-2.0, None), (-2.0001, False), (-1.9999, True)):
        blocks, _ = KALM.tables(oscillator.replace("JX=1.0", "JX=5.0").replace("'frame A'", "'frame A', ADIST=4.0") +
                                f" &STOPS STNAME='S1', STLOW={at!r}, STREST=1.0 &END\n &TIME TAT=4.5 &END\n")
        if hits is not None:
            check(f"a stop at {at}: hit {hits}", (len(blocks["events"]["time"]) > 0) == hits)
        near(blocks["time"]["P.x"][-1], 4.0 + math.cos(4.5 + (2*(math.pi - math.acos(1.0 + at)) if hits else 0.0)),
             1e-6, "swings on after a stop that is just touched")
    # pressed to its stop by a spring to a pin that turns: leaves when the spring pulls the other way, and comes back
    crank = """BLOCK AT A STOP, PULLED BY A SPRING TO A CRANK PIN
 &CHAIN JNT='O','B','P', JX=0.0,-0.1,0.0, JY=0.0,0.0,0.0, LNAME='frame','crank','block', LNK='O','O B','P', NSLIDE=1, SLNK='frame',
  SLNK2='block', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='O','S1', DELT2=0.0 &END
""" + METHOD + """ &RATES SPEED=2.0 &END
 &MASSES MNAME='block P', MASS=2.0, MDIST=0.0 &END
 &SPRING ANAME='crank B', BNAME='block P', STIFF=18.0 &END
 &STOPS STNAME='S1', STLOW=0.0, STREST=0.3 &END
 &TIME TEND=3.0, NTIME=60, FREE='S1' &END
"""
    blocks, _ = KALM.tables(crank)
    events, t = blocks["events"], blocks["time"]
    leave = math.pi/4
    check("rests at first, leaves, hits", events["event"][:3] == ["rest", "lift", "impact"])
    check("rests from time 0", events["time"][0] == 0.0)
    near(events["time"][1], leave, 1e-14, "leaves when the spring pulls the other way")
    pressed = t["time"] < leave
    check("the stop bears the spring", np.allclose(t["stop.S1"][pressed], 1.8*np.cos(2*t["time"][pressed]), atol=1e-14))
    # x'' + 9 x = .9 sin 2 s from rest, s from then on: x = .18 sin 2 s - .12 sin 3 s; 0 at sin 3 s = 1.5 sin 2 s
    s = t["time"] - leave
    flies = (s > 0) & (t["time"] < events["time"][2])
    check("and flies by the closed form", flies.sum() > 5 and np.allclose(t["input.S1"][flies], (.18*np.sin(2*s) - .12*np.sin(3*s))[flies], atol=1e-13))
    back = events["time"][2] - leave
    near(math.sin(3*back)/1.5, math.sin(2*back), 1e-13, "until it comes back")
    check("energy in balance, with what the crank does", np.max(np.abs(t["balance"])) < 1e-13)


def witness():
    """A bar that rests on its stop while another swings on it: the other is a pendulum, the stop bears its moment until it lifts."""
    case = TWO_BARS.replace("MINERT=.0833333333333333333,.0833333333333333333", "MINERT=.0833333333333333333,.0833333333333333333, GRAVY=-9.81")
    blocks, _ = KALM.tables(case + " &STOPS STNAME='A', STLOW=0.0, STREST=0.4 &END\n &TIME TEND=1.2, NTIME=48, VNAME='B', VSTART=4.0 &END\n")
    events, t = blocks["events"], blocks["time"]
    g = 9.81

    def lone(_, y):
        return [y[1], -1.5*g*math.cos(y[0])]

    def moment(_, y):             # that the stop gives to the first bar, which does not move: weights, and the pin force of the other
        a = -1.5*g*math.cos(y[0])
        fy = g + .5*(a*math.cos(y[0]) - y[1]**2*math.sin(y[0]))
        return .5*g + fy

    moment.terminal = True
    done = solve_ivp(lone, (0, 1.2), [0.0, 4.0], method="DOP853", rtol=1e-13, atol=1e-14, events=moment, dense_output=True)
    lift = done.t_events[0][0] if len(done.t_events[0]) else 1.2
    rest = t["time"] < lift - 1e-9
    swing = done.sol(t["time"][rest])
    check("a bar on a bar that rests is a pendulum", rest.sum() > 5 and np.allclose(np.radians(t["input.B"][rest]), swing[0], atol=1e-11))
    check("what the stop bears", np.allclose(t["stop.A"][rest], [moment(0, y) for y in swing.T], atol=1e-10))
    check("the resting bar does not move", np.max(np.abs(t["input.A"][rest])) < 1e-14)
    check("no torque at free drives", np.max(np.abs(t["drive"])) < 1e-11 and np.max(np.abs(t["drive2"])) < 1e-11)
    if lift < 1.2:
        near(events["time"][list(events["event"]).index("lift")], lift, 1e-11, "when it leaves the stop")

    # the same two bars, whirled so that the first lifts and comes back, against poses and multipliers by SciPy with its events
    def bars(_, y):
        (c1, s1), (c2, s2) = [(math.cos(a), math.sin(a)) for a in (y[0], y[1])]
        c = c1*c2 + s1*s2
        s = s1*c2 - c1*s2
        m = [[4/3, .5*c], [.5*c, 1/3]]
        r = [-1.5*g*c1 - .5*s*y[3]**2, -.5*g*c2 + .5*s*y[2]**2]
        return [y[2], y[3], *np.linalg.solve(m, r)]

    def hits(_, y):
        return y[0]
    hits.terminal, hits.direction = True, -1
    blocks, _ = KALM.tables(case + " &STOPS STNAME='A', STLOW=0.0, STREST=0.4 &END\n &TIME TEND=1.2, NTIME=48, VSTART=2.0,-5.0 &END\n")
    events, t = blocks["events"], blocks["time"]
    free = solve_ivp(bars, (0, 1.2), [0.0, 0.0, 2.0, -3.0], method="DOP853", rtol=1e-13, atol=1e-14, events=hits)
    check("it does come back", len(events["time"]) > 0 and events["event"][0] == "impact")
    near(events["time"][0], free.t_events[0][0], 1e-11, "two bars: time of the impact")
    y = free.y_events[0][0]
    near(events["before"][0], y[2], 1e-10, "two bars: rate before it")
    # impulse of the stop P on the first bar: H dq' = (P, 0) with the rates of both bars
    h = np.array([[4/3, .5*math.cos(y[0] - y[1])], [.5*math.cos(y[0] - y[1]), 1/3]])
    p = -1.4*y[2]/np.linalg.inv(h)[0, 0]
    near(events["impulse"][0], p, 1e-10, "two bars: impulse")


def laws():
    # the same linkage by its loops: the same events
    loops = """FOUR-BAR BY ITS LOOP
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=0.5,0.85440037453175311679,0.72801098892805182711,1.3,
  GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
""" + METHOD.replace("NDES", "MOTION=1, CRNKI=53.130102354155978703, NDES") + """ &MASSES MLINK=-1,-2,-3, MLOOP=3*1,""" + FOUR_BAR.split("'cd C',")[1].split(" &STOPS")[0] + \
        " &STOPS STLINK=-1, STLOOP=1," + FOUR_BAR.split("STNAME='A',")[1]
    drawn, _ = KALM.tables(FOUR_BAR)
    looped, said = KALM.tables(loops)
    if "events" in looped:
        check("by loops: the same impacts", len(looped["events"]["time"]) > 5 and
              np.allclose(looped["events"]["time"][:5], drawn["events"]["time"][:5], rtol=1e-13))
        check("and the same motion", np.allclose(looped["time"]["input.v"], drawn["time"]["input.v"], atol=1e-10))
    else:
        check(f"by loops: {said[:300]}", False)
    # a smaller tolerance changes little
    looser, _ = KALM.tables(FOUR_BAR.replace("TEND=1.0", "TEND=1.0, TTOL=1E-10"))
    check("a looser TTOL changes the time of an impact a little", 0 < abs(looser["events"]["time"][1] - drawn["events"]["time"][1]) < 1e-8)
    # the stop by joint B, whose turn is that of the coupler on the crank: hit at the same place as by joint A
    crank = math.degrees(.3 - math.atan2(.4, .3))
    check("the crank's stop is where it was put", abs(drawn["time"]["input"][-1] - crank) < 1e-12)
    coupler = math.degrees(math.atan2(.706441436896652 - .5*math.sin(.3), 1.12410089188574 - .5*math.cos(.3)) - math.atan2(.3, .8)) - crank
    other, _ = KALM.tables(FOUR_BAR.replace("STNAME='A', STLOW=", "STNAME='B', STHIGH=").replace(repr(crank), repr(coupler)))
    near(other["events"]["time"][0], drawn["events"]["time"][0], 1e-12, "the same stop at joint B")
    near(other["time"]["stop.B"][-1]*other["events"]["before"][0], drawn["time"]["stop.A"][-1]*drawn["events"]["before"][0], 1e-9,
         "its force by the principle of virtual work")
    # two that close together: mirror images
    pair = """TWO BLOCKS
 &CHAIN JNT='A','P','Q', JX=0.0,0.0,0.0, JY=0.0,0.0,1.0, LNAME='frame','p','q', LNK='A','P','Q', NSLIDE=2, SLNK='frame','frame',
  SLNK2='p','q', SLX=0.0,0.0, SLY=0.0,1.0, SLANG=0.0,180.0 &END
 &DRIVES DRIVE='S1','S2', DELT2=0.0 &END
""" + METHOD + """ &MASSES MNAME='p P','q Q', MASS=2.0,1.0, MDIST=0.0,0.0 &END
 &STOPS STNAME='S1','S2', STHIGH=1.0,1.0, STREST=0.5,0.25 &END
 &TIME TEND=1.5, NTIME=3, VSTART=1.0,1.0 &END
"""
    blocks, _ = KALM.tables(pair)
    check("two blocks hit at the same time", np.allclose(blocks["events"]["time"], [1.0, 1.0], rtol=1e-15))
    check("each with its own restitution", np.allclose(blocks["events"]["after"], [-.5, -.25], rtol=1e-13))
    # kinks of a table of loads over the input: an order-2 error without them
    kinked = SLIDE + """ &LOADS LNAME='block P', LFX=2.0, LTABLE=1, NTABIN=4, TABIN=0.0,0.3,0.7,9.0, TABVAL=0.0,1.0,-1.0,-1.0 &END
 &TIME TEND=1.5, NTIME=10, VSTART=1.0 &END
"""
    t, said = KALM.time(kinked)
    if t is None:
        check(f"a load by a table: {said[:300]}", False)
    else:
        def force(x):
            return 2.0*np.interp(x, [0.0, .3, .7, 9.0], [0.0, 1.0, -1.0, -1.0])
        y, at = [0.0, 1.0], 0.0
        for kink in (.3, .7):
            def crossed(_, z, kink=kink):
                return z[0] - kink
            crossed.terminal = True
            leg = solve_ivp(lambda _, z: [z[1], force(z[0])/2.0], (at, 1.5), y, method="DOP853", rtol=1e-13, atol=1e-14, events=crossed)
            y, at = leg.y[:, -1], leg.t[-1]
        leg = solve_ivp(lambda _, z: [z[1], force(z[0])/2.0], (at, 1.5), y, method="DOP853", rtol=1e-13, atol=1e-14)
        near(t["input"][-1], leg.y[0, -1], 1e-11, "kinks of a table end steps: place")
        # SciPy finds the kinks on a polynomial of its step: 5E-13 with some processors
        near(t["input.v"][-1], leg.y[1, -1], 1e-11, "kinks of a table end steps: speed")


def mistakes():
    for old, new, words in (
            ("STLOW=", "STLOW=5.0, STHIGH=", "beyond this stop at time 0"), ("STLOW=-", "STHIGH=-", "beyond this stop at time 0"),
            ("STNAME='A'", "STNAME='Q'", "no joint or slide is called 'Q'"), ("STREST=0.5", "STREST=1.5", "0 to 1"),
            ("&TIME TEND=1.0, NTIME=20 &END", "", "give &TIME too")):
        assert old in FOUR_BAR, old
        _, said = KALM.tables(FOUR_BAR.replace(old, new), want=2)
        check(f"{new!r} is refused with '{words}': {said[:300]}", words in said)
    _, said = KALM.tables(SLIDE + " &STOPS STNAME='S1' &END\n &TIME TEND=1.0 &END\n", want=2)
    check(f"a stop without a limit: {said[:200]}", "has no limit" in said)
    t, said = KALM.time(FOUR_BAR.replace("TEND=1.0", "TEND=1.0, NEVENT=3"), want=1)
    check(f"the motion ends after NEVENT events: {said[-300:]}", "more events than NEVENT" in said and .64 > t["time"][-1] > .59)
    t, said = KALM.time(FOUR_BAR.replace("TEND=1.0", "TEND=1.0, NTSTEP=20"), want=1)
    check(f"the motion ends after NTSTEP steps: {said[-300:]}", "more steps than NTSTEP" in said and 1.0 > t["time"][-1] > 0.0)


published()
closed_forms()
witness()
laws()
mistakes()
sys.exit(report())
