#!/usr/bin/env python3
"""Motion in time with strong dampers (ISTIFF=1, CVODE) against closed forms, SciPy's Radau and the explicit method; its advice.

usage: time_stiff.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import math
import os
import re
import sys

import numpy as np
from scipy.integrate import solve_ivp

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report
from timed import Kalm, data, near

KALM = Kalm(sys.argv[1])
MASS = """MASS ON A SLIDE WITH SPRING AND STRONG DAMPER
 &CHAIN JNT='P','A', JX=1.0,0.0, JY=0.0,0.0, LNAME='frame','s', LNK='A','P', NSLIDE=1, SLNK='frame', SLNK2='s', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='s P', MASS=1.0, MDIST=0.0 &END
 &SPRING ANAME='frame A', BNAME='s P', STIFF=1000.0, SFREE=0.5, SDAMP={} &END
 &TIME TAT=1.0,10.0{} &END
"""
PENDULUM = """PENDULUM IN THICK OIL
 &CHAIN JNT='O','P', JX=0.0,1.0, JY=0.0,0.0, LNAME='frame','bar', LNK='O','O P' &END
 &DRIVES DRIVE='O' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='bar O', MDIST=1.0, MASS=1.0, GRAVY=-9.81 &END
 &SPRING ANAME='frame', BNAME='bar', STORS=1, STIFF=0.0, SFREE=0.0, SDAMP=1.0E4 &END
 &TIME TEND=1000.0, NTIME=10, ISTIFF=1 &END
"""


def closed_form(damping, t):
    """x'' + damping x' + 1000 (x - 0.5) = 0 from x = 1 at rest; the slow root without cancellation."""
    fast = -0.5*damping - math.sqrt(0.25*damping**2 - 1000.0)
    slow = 1000.0/fast
    return 0.5 + 0.5*(slow*math.exp(fast*t) - fast*math.exp(slow*t))/(slow - fast)


def steps_of(said):
    return int(re.search(r"s in (\d+) steps", said)[1])


def main():
    for damping in (1.0e4, 1.0e7):
        t, said = KALM.time(MASS.format(damping, ", ISTIFF=1"))
        for row in (1, 2):
            near(t["point_P.x"][row], closed_form(damping, t["time"][row]), 1e-11, "damper %g: place at %g s" % (damping, t["time"][row]))
        check("damper %g: few steps" % damping, steps_of(said) < 4000 and "stability" not in said, said)
        check("damper %g: what is lost and what is left" % damping, np.max(np.abs(t["balance"])) < 1e-8, t["balance"])
    # the advice: where the explicit method comes to the end, and where it would not
    t, said = KALM.time(MASS.format(1.0e4, ""))
    near(t["point_P.x"][2], closed_form(1.0e4, 10.0), 1e-11, "explicit: place at 10 s")
    check("explicit, 10 000 /s: it is advised", "stability kept the steps of the motion short" in said and "ISTIFF=1" in said and
          steps_of(said) > 10000, said)
    t, said = KALM.time(MASS.format(1.0e7, ""), want=1)
    check("explicit, 1E7 /s: it ends with the advice", "more than 100 000 would follow" in said and "ISTIFF=1" in said, said)
    t, said = KALM.time(MASS.format(4.0, ""))
    check("a weak damper: no advice", "stability" not in said)

    # a pendulum that creeps down in oil: th'' = -g cos th - c th'
    t, said = KALM.time(PENDULUM)
    exact = solve_ivp(lambda s, y: [y[1], -9.81*math.cos(y[0]) - 1e4*y[1]], (0, 1000.0), [0.0, 0.0], method="Radau", rtol=1e-12,
                      atol=1e-15, t_eval=t["time"])
    worst = np.max(np.abs(np.radians(t["input"]) - exact.y[0]))
    check("pendulum in oil: as SciPy's Radau", worst < 1e-10, worst)
    # slowly: th' = -g cos th/c to first order in 1/c^2, so th = -gd(g t/c)
    slow = -2.0*math.atan(math.tanh(0.5*9.81*1000.0/1e4))
    check("pendulum in oil: the creeping solution", abs(math.radians(t["input"][-1]) - slow) < 1e-6, (t["input"][-1], slow))

    # impacts and rest: as by the explicit method, whose event times were tested by themselves
    for name, changes in (("door_closer", ()), ("toggle", ())):
        own, _ = KALM.tables(data(name, *changes))
        other, _ = KALM.tables(data(name, *changes, ("&TIME ", "&TIME ISTIFF=1, ")))
        first, second = own["events"], other["events"]
        check(name + ": the same events", first["event"][:3] == second["event"][:3], (first["event"], second["event"]))
        for i in range(3):
            near(second["time"][i], first["time"][i], 1e-9, "%s: time of event %d" % (name, i + 1))
        scale = max(1.0, np.max(np.abs(own["time"]["input"])))
        check(name + ": places", np.max(np.abs(own["time"]["input"] - other["time"]["input"])) < 1e-7*scale)
    own, said = KALM.tables(data("dashpot"))
    other, _ = KALM.tables(data("dashpot", (", ISTIFF=1", "")))
    near(own["events"]["time"][0], other["events"]["time"][0], 1e-9, "flap with a dashpot: it shuts")
    check("flap with a dashpot: few steps", steps_of(said) < 5000, steps_of(said))
    return report()


if __name__ == "__main__":
    sys.exit(main())
