#!/usr/bin/env python3
"""Equilibria and small oscillations of &TIME: published numbers, the potential in its own closed form, the motion itself, bad input.

usage: time_equilibria.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import cmath
import math
import os
import sys

import numpy as np
from scipy.optimize import minimize, root

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report
from timed import Kalm, data, near

KALM = Kalm(sys.argv[1])
METHOD = " &METHOD NDES=1, DELT=0.0 &END\n"
LENGTHS = math.hypot(.1, .25), math.hypot(.65, .25), math.hypot(.05, .5)


def bars(*masses):
    return "MASS=" + ",".join(map(repr, masses)) + ", MDIST=" + ",".join(repr(x/2) for x in LENGTHS) + ", MINERT=" + \
        ",".join(repr(m*x*x/12) for m, x in zip(masses, LENGTHS)) + ", GRAVY=-9.81 &END\n"


def four_bar(c=(.75, .5)):
    return f"""FOUR-BAR WITH A SPRING
 &CHAIN JNT='A','B','C','D', JX=0.0,0.1,{c[0]!r},0.8, JY=0.0,0.25,{c[1]!r},0.0, LNAME='frame','ab','bc','cd', LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
""" + METHOD + " &MASSES MNAME='ab A','bc B','cd C', " + bars(1.0, 2.0, 1.5) + \
        " &SPRING ANAME='frame A', BNAME='bc C', STIFF=400.0, SFREE=0.6 &END\n &TIME IEQUIL=1 &END\n"


TWO_BARS = """TWO UNIFORM BARS, HANGING NEARLY
 &CHAIN JNT='A','B','C', JX=0.0,0.3,0.2, JY=0.0,-1.0,-2.0, LENP='A B','B C', LENV=1.0,1.0, LNAME='frame','ab','bc', LNK='A','A B','B C' &END
 &DRIVES DRIVE='A','B', DBASE='frame','ab', DLINK='ab','bc', DELT2=0.0 &END
""" + METHOD + """ &MASSES MNAME='ab A','bc B', MASS=1.0,1.0, MDIST=0.5,0.5, MINERT=.0833333333333333333,.0833333333333333333, GRAVY=-9.81 &END
"""

DRAWN = ((.608092728321231, 37.5224082223861, -701.583537898055), (2.76241785359993, 8.21359953331684, 62.0499191962208),
         (3.27722247773139, 8.58769232698898, -70.3003488491225), (5.0194862809594, 2.55957702603268, 116.958476665092))
OTHER = ((.870574565778645, -3.48600701364819, 148.095933129027), (2.34704486649293, 4.45553211221795, -206.546060184308),
         (4.05546594200045, -9.65560061202043, 166.288778851231), (5.79908443182259, 16.1754339440942, -781.651511006904))
FIVE_BAR = """FIVE-BAR WITH TWO SPRINGS
 &CHAIN JNT='A','B','C','D','E', JX=0.0,-0.1,0.25,0.6,0.5, JY=0.0,0.3,0.55,0.25,0.0, LNAME='frame','ab','bc','cd','de',
  LNK='A E','A B','B C','C D','D E' &END
 &DRIVES DRIVE='A','E', DBASE='frame','frame', DLINK='ab','de', DELT2=0.0 &END
"""


def published():
    """The page of the theory: crank, V, w^2 of the four-bar, in both assemblies."""
    b, d = complex(.1, .25), complex(.8, 0.0)
    c = complex(.75, .5)
    mirrored = b + (d - b)*((c - b)/(d - b)).conjugate()
    for case, wanted in ((four_bar(), DRAWN), (four_bar((mirrored.real, mirrored.imag)), OTHER)):
        tables, said = KALM.tables(case)
        if "equilibria" not in tables:
            check(f"the four-bar has a table of equilibria: {said[:300]}", False)
            continue
        found, motion = tables["equilibria"], tables["small_motion"]
        check(f"four equilibria, not {len(found['potential'])}", len(found["potential"]) == 4)
        cranks = np.mod(np.radians(found["input"]) + math.atan2(.25, .1), 2*math.pi)
        for crank, potential, square in wanted:
            k = int(np.argmin(np.abs(cranks - crank)))
            near(cranks[k], crank, 1e-12, "four-bar: crank at an equilibrium")
            near(found["potential"][k], potential, 1e-11, "four-bar: potential")
            near(motion["square"][k], square, 1e-9, "four-bar: square of the frequency")
            check("four-bar: stable where it is positive", (found["stable"][k] == 1) == (square > 0))
    check("without TEND there is no motion", "time" not in tables)
    tables, _ = KALM.tables(TWO_BARS + " &TIME IEQUIL=1, NSTART=40 &END\n")
    found, motion = tables["equilibria"], tables["small_motion"]
    check("two bars: four equilibria, one stable", len(found["stable"]) == 4 and sum(found["stable"]) == 1)
    k = int(np.argmax(found["stable"]))
    squares = motion["square"][motion["equilibrium"] == found["equilibrium"][k]]
    near(squares[0], 7.18301111867689, 1e-10, "two bars: hanging, first mode")
    near(squares[1], 51.6769888813231, 1e-10, "two bars: second mode")
    near(found["potential"][k], -9.81*2.0, 1e-12, "two bars: hanging, potential")
    shape = [motion[f"shape.input.{x}"][motion["equilibrium"] == found["equilibrium"][k]] for x in "AB"]
    h, s = np.array([[4/3, .5], [.5, 1/3]]), np.diag([1.5*9.81, .5*9.81])
    for mode in (0, 1):
        u = np.array([shape[0][mode], shape[0][mode] + shape[1][mode]])
        check("two bars: shapes solve the equations of small motion", np.max(np.abs(s @ u - squares[mode]*(h @ u))) < 1e-8)


def five_bar():
    """Every equilibrium found has no force by an own potential; its frequencies are those of that potential's second derivatives."""
    p = {"A": 0j, "B": complex(-.1, .3), "C": complex(.25, .55), "D": complex(.6, .25), "E": complex(.5, 0)}
    length = {k: abs(p[k[0]] - p[k[1]]) for k in ("AB", "BC", "CD", "DE")}
    mass = dict(zip(length, (1.0, 1.5, 1.2, .8)))
    case = FIVE_BAR + METHOD + " &MASSES MNAME='ab A','bc B','cd C','de D', MASS=1.0,1.5,1.2,.8, MDIST=" + \
        ",".join(repr(x/2) for x in length.values()) + ", MINERT=" + ",".join(repr(mass[k]*x*x/12) for k, x in length.items()) + \
        ", GRAVY=-9.81 &END\n &SPRING ANAME='ab B','frame A', BNAME='cd D','bc C', STIFF=300.0,500.0, SFREE=0.5,0.55 &END\n" + \
        " &TIME IEQUIL=1, NSTART=30 &END\n"
    tables, said = KALM.tables(case)
    if "equilibria" not in tables:
        check(f"the five-bar has a table of equilibria: {said[:300]}", False)
        return

    def potential(q):
        b, d = cmath.rect(length["AB"], q[0]), .5 + cmath.rect(length["DE"], q[1])
        gap = d - b
        along = (length["BC"]**2 - length["CD"]**2 + abs(gap)**2)/(2*abs(gap))
        c = b + gap/abs(gap)*complex(along, math.sqrt(max(0.0, length["BC"]**2 - along**2)))
        weight = 9.81*(mass["AB"]*b.imag/2 + mass["BC"]*(b + c).imag/2 + mass["CD"]*(c + d).imag/2 + mass["DE"]*d.imag/2)
        return weight + 150.0*(abs(gap) - .5)**2 + 250.0*(abs(c) - .55)**2

    def gradient(q, h=1e-5):
        return [(potential(q + h*e) - potential(q - h*e))/(2*h) for e in np.eye(2)]

    found, motion = tables["equilibria"], tables["small_motion"]
    turned = np.radians([found["input.A"], found["input.E"]]).T
    angles = turned + [cmath.phase(p["B"]), cmath.phase(p["D"] - p["E"])]
    best = int(np.argmin(np.abs(found["potential"] - .0620505504496198)))
    check("five-bar: the stable one of the page", np.allclose(np.mod(angles[best] + math.pi, 2*math.pi) - math.pi,
                                                             (-.594405670003506, -.763523385681678), atol=1e-10) and found["stable"][best])
    near(found["potential"][best], .0620505504496198, 1e-11, "five-bar: its potential")
    saddle = min(range(len(angles)), key=lambda k: np.max(np.abs(angles[k] - (1.4379549190774, .710581618810879))))
    check("five-bar: the saddle of the page", np.allclose(angles[saddle], (1.4379549190774, .710581618810879), atol=1e-10))
    for k, squares in ((best, (175.039920429799, 399.522530104574)), (saddle, (-46.688070250465, 249.138536281226))):
        got = motion["square"][motion["equilibrium"] == found["equilibrium"][k]]
        check(f"five-bar: squares of frequencies {got}", np.allclose(got, squares, rtol=1e-9))
    for q, v in zip(angles, found["potential"]):
        near(potential(q), v, 1e-10, "five-bar: the potential in its own closed form")
        check("five-bar: no force there", np.max(np.abs(gradient(q))) < 1e-4)
    solved = root(gradient, angles[saddle] + .01)
    check("five-bar: SciPy's root", np.allclose(solved.x, angles[saddle], atol=1e-6))
    check("five-bar: SciPy's minimum", minimize(potential, angles[best] + .05).fun > found["potential"][best] - 1e-8)


def laws():
    # small motion about an equilibrium against the run itself
    tables, _ = KALM.tables(data("pendulum", ("TEND=10.0", "IEQUIL=1")))
    found, motion = tables["equilibria"], tables["small_motion"]
    check("pendulum: two, one stable", len(found["stable"]) == 2 and sum(found["stable"]) == 1)
    check("pendulum: squares g and -g", np.allclose(sorted(motion["square"]), [-9.81, 9.81], rtol=1e-12))
    sprung = KALM.tables(four_bar())[0]
    k = int(np.argmax(sprung["small_motion"]["square"]))
    period = 2*math.pi/math.sqrt(sprung["small_motion"]["square"][k])
    b = cmath.rect(LENGTHS[0], math.radians(sprung["equilibria"]["input"][k]) + math.atan2(.25, .1) + 1e-5)
    along = (LENGTHS[1]**2 - LENGTHS[2]**2 + abs(.8 - b)**2)/(2*abs(.8 - b))
    c = b + (.8 - b)/abs(.8 - b)*complex(along, math.sqrt(LENGTHS[1]**2 - along**2))
    t, _ = KALM.time(four_bar((c.real, c.imag)).replace("0.1,", repr(b.real) + ",").replace("0.25,", repr(b.imag) + ",")
                     .replace("IEQUIL=1", f"TAT={period/4!r}"))
    near(t["input"][-1], -math.degrees(1e-5), 1e-8, "beside the equilibrium: there after a quarter of the period")
    check("and it was beside it", t["input"][0] == 0.0 and abs(t["input.v"][0]) == 0.0)
    # damping: the roots of one freedom in closed form
    tables, _ = KALM.tables("""MASS ON A SLIDE WITH SPRING AND DAMPER
 &CHAIN JNT='P','A', JX=1.0,0.0, JY=0.0,0.0, LNAME='frame','s', LNK='A','P', NSLIDE=1, SLNK='frame', SLNK2='s', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
""" + METHOD + """ &MASSES MNAME='s P', MASS=1.0, MDIST=0.0 &END
 &SPRING ANAME='frame A', BNAME='s P', STIFF=10.0, SFREE=0.5, SDAMP=4.0 &END
 &STOPS STNAME='S1', STLOW=-0.9 &END
 &TIME IEQUIL=1 &END
""")
    roots = tables["small_motion_roots"]
    check("spring and damper: -2 +- i sqrt(6)", np.allclose(roots["growth"], -2.0, rtol=1e-10) and
          np.allclose(np.abs(roots["angular_frequency"]), math.sqrt(6.0), rtol=1e-10))
    check("spring and damper: damping ratio", np.allclose(roots["damping_ratio"], 2.0/math.sqrt(10.0), rtol=1e-10))
    near(tables["equilibria"]["input"][0], -.5, 1e-14, "spring and damper: at the free length")
    # a stop that weight presses to
    tables, _ = KALM.tables(data("pendulum", ("TEND=10.0", "IEQUIL=1")) + "\n &STOPS STNAME='O', STLOW=-60.0, STHIGH=45.0 &END\n")
    found = tables["equilibria"]
    check("pendulum between stops: it hangs on the lower one", list(found["stop"]) == [1] and abs(found["input"][0] - 45.0) < 1e-11)
    # no force anywhere
    _, said = KALM.tables(data("pendulum", ("TEND=10.0", "IEQUIL=1"), ("GRAVY=-9.81", "GRAVY=0.0")))
    check("without weight it stays everywhere", "no force acts on the free drives" in said)
    _, said = KALM.tables(TWO_BARS.replace("GRAVY=-9.81", "GRAVY=0.0") + " &TIME IEQUIL=1, NSTART=5 &END\n")
    check("two bars without weight, too", "no force acts on the free drives" in said)


def pendulum(x, y, more=""):
    return f"""BAR
 &CHAIN JNT='O','P', JX=0.0,{x!r}, JY=0.0,{y!r}, LNAME='frame','bar', LNK='O','O P' &END
 &DRIVES DRIVE='O' &END
""" + METHOD + " &MASSES MNAME='bar O', MASS=1.0, MDIST=1.0, GRAVY=-9.81 &END\n &TIME IEQUIL=1 &END\n" + more


def ends():
    # the drawing itself, and what lies between the last step and a stop
    for x, y, low, high, inputs in ((0.0, -1.0, -20.0, 20.2, [0.0]), (1.0, .01, -90.7, 90.2, [-90.0, 90.0, 90.2]), (1.0, 0.0, -.1, .1, [-.1]),
                                    (1.0, 0.0, 0.0, 10.0, [0.0]), (1.0, 0.0, -400.0, 500.0, [90.0, 270.0])):
        turn = 0.0 if y == -1.0 else math.degrees(math.atan2(y, x))
        wanted = [a - turn if abs(a) % 90.0 == 0.0 and a else a for a in inputs]
        found = KALM.tables(pendulum(x, y, f" &STOPS STNAME='O', STLOW={low!r}, STHIGH={high!r} &END\n"))[0]["equilibria"]
        check(f"pendulum between {low} and {high}: {found['input']}", len(found["input"]) == len(wanted) and
              np.allclose(found["input"], wanted, atol=1e-9))
    # a stop backwards alone: a turn forwards is free, and the stop holds it none the less; what hangs is found once
    found = KALM.tables(pendulum(-1.0, 0.0, " &STOPS STNAME='O', STLOW=-50.0 &END\n"))[0]["equilibria"]
    check(f"pendulum, a stop backwards alone: {found['input']}", np.allclose(found["input"], [90.0, 270.0], atol=1e-9))
    found = KALM.tables(pendulum(1.0, 0.0, " &STOPS STNAME='O', STLOW=-50.0 &END\n"))[0]["equilibria"]
    check(f"pendulum pressed to it: {found['input']}", np.allclose(found["input"], [-50.0, 90.0, 270.0], atol=1e-9) and found["stop"][0] == 1)
    # of two stops in one step the first is met: the slide's, at 0.99 m from O, or the crank's
    for order in ((0, 1), (1, 0)):
        names, low = [("'O'", "'S1'")[k] for k in order], [(-10.3, -2.0e-3)[k] for k in order]
        found = KALM.tables(f"""CRANK AND SLIDE
 &CHAIN JNT='O','A','B', JX=0.0,0.5,1.5, JY=0.0,0.0,0.0, LNAME='frame','crank','rod','slide', LNK='O','O A','A B','B', NSLIDE=1,
  SLNK='frame', SLNK2='slide', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='O' &END
""" + METHOD + " &MASSES MNAME='crank O', MASS=1.0, MDIST=0.5, GRAVY=-9.81 &END\n &TIME IEQUIL=1 &END\n" +
                            f" &STOPS STNAME={','.join(names)}, STLOW={low[0]!r},{low[1]!r} &END\n")[0]["equilibria"]
        # .5 cos a + sqrt(1 - .25 sin^2 a) = 1.498
        crank = -math.degrees(math.acos((.25 + 1.498**2 - 1.0)/1.498))
        check(f"crank: the stop that is met first, {found['input']}, not {crank}", order[found["stop"].astype(int)[0] - 1] == 1 and
              abs(found["input"][0] - crank) < 1e-9)
    # a drive at half the pace: after a turn it is not where it was; four equilibria in two turns, by the potential's own roots
    found = KALM.tables("""TWO BARS, ONE AT HALF THE PACE
 &CHAIN JNT='A','P','B','Q', JX=0.0,1.0,3.0,4.0, JY=0.0,0.0,0.0,0.0, LNAME='frame','a','b', LNK='A B','A P','B Q' &END
 &DRIVES DRIVE='A','B', DBASE='frame','frame', DLINK='a','b', RATIO=0.0,0.5 &END
""" + METHOD + """ &MASSES MNAME='a A','b B', MASS=1.0,3.0, MDIST=0.5,0.5, MINERT=0.1,0.1, GRAVY=-9.81 &END
 &TIME IEQUIL=1 &END
""")[0]["equilibria"]
    turned = np.radians(np.linspace(-360.0, 360.0, 100001))
    force = .5*np.cos(turned) + .75*np.cos(turned/2)
    roots = np.degrees(turned[:-1][force[:-1]*force[1:] < 0.0])
    check(f"half the pace: {found['input.A']}, not {roots}", len(roots) == len(found["input.A"]) and
          np.allclose(found["input.A"], roots, atol=.01))
    # no mass at all
    _, said = KALM.tables(pendulum(1.0, 0.0).replace("MASS=1.0", "MASS=0.0"), want=1)
    check("nothing has mass: said so", "moves no mass" in said and "no force acts" not in said.lower())
    # a spring between the frame and the end of two bars: positions on a circle
    found, said = KALM.tables(TWO_BARS.replace("GRAVY=-9.81", "GRAVY=0.0") + " &SPRING ANAME='frame A', BNAME='bc C', STIFF=10.0, SFREE=0.5"
                              " &END\n &TIME IEQUIL=1, NSTART=5 &END\n")
    check("a circle of equilibria: none is stable, some neutral", sum(found["equilibria"]["stable"]) == 0 and "NEUTRAL" in said)
    _, said = KALM.tables(TWO_BARS + " &TIME IEQUIL=1, NSTART=2 &END\n &STOPS STNAME='A', STLOW=-5.0 &END\n")
    check("several drives and stops: said what is not looked for", "ONLY THOSE BETWEEN THE STOPS" in said)


def mistakes():
    for case, words in ((data("pendulum", ("TEND=10.0", "IEQUIL=2")), "from 0 to 1"),
                        (data("pendulum", ("TEND=10.0", "IEQUIL=1, NTIME=3")), "without TEND there is no motion"),
                        (data("crane", ("FREE='C'", "FREE='C', IEQUIL=1")), "must be 0"),
                        (data("crane", ("FREE='C'", "FREE='none', IEQUIL=1"), ("SPEED=10.0", "SPEED=0.0")), "need a free drive")):
        _, said = KALM.tables(case, want=2)
        check(f"refused with '{words}': {said[:300]}", words in said)


published()
five_bar()
laws()
ends()
mistakes()
sys.exit(report())
