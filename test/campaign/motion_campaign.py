#!/usr/bin/env python3
"""Random mechanisms of one to three freedoms in time against an independent integration of all poses with multipliers.

usage: motion_campaign.py BIN [--count N] [--seed S] [--seconds T] [--rough]   (N mechanisms, 200; up to T s of their time, 0.8)

Four-bars, slider-cranks, five-bars, chains of two or three bars and bars on slides, with centres of mass off their lines, weight, a
spring and a damper, from rest; long enough that some pass dead points of their drives. The witness is that of
test/law/time_motion.py: places and angles of all bodies, multipliers, SciPy's DOP853. With --rough some joints have friction with
stiction, by the witness of test/law/rough_witness.py. The last line is N passed, N failed.
"""
import argparse
import os
import random
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tools"))
sys.path.insert(0, os.path.join(HERE, "..", "law"))
from tally import check, report
from timed import Kalm

KINDS = ("four-bar", "slider-crank", "five-bar", "chain", "bar on a slide")
FREEDOMS = {"four-bar": 1, "slider-crank": 1, "five-bar": 2, "chain": None, "bar on a slide": 2}
ALLOWED = 1e-7        # metres, and a tenth of a metre a second


def difference(t, witness, order, holder, end):
    """Largest difference of joints, and a tenth of that of their speeds, at the end; None: to the witness joints hold each other."""
    found = witness.end(end, np.zeros(3*len(witness.places)))
    if found is None:
        return None
    y, v = found
    worst = 0.0
    for joint in order:
        body, point = next(((b, p) for b, p in holder[joint] if b is not None), (None, None))
        place, jac, _ = witness.where(y, body, point)
        speed = jac @ v[3*body:3*body + 3]
        worst = max(worst, abs(t[f"{joint}.x"][-1] - place[0]), abs(t[f"{joint}.y"][-1] - place[1]),
                    .1*abs(t[f"{joint}.vx"][-1] - speed[0]), .1*abs(t[f"{joint}.vy"][-1] - speed[1]))
    return worst


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=39)
    parser.add_argument("--seconds", type=float, default=0.8)
    parser.add_argument("--rough", action="store_true")
    options = parser.parse_args()
    sys.argv[1:] = [options.programs]
    from rough_witness import random_rough
    from time_motion import random_mechanism
    kalm = Kalm(options.programs)
    errors, balances, exchanged, stood, stuck, freedoms = [], [], 0, 0, 0, {1: 0, 2: 0, 3: 0}
    for number in range(options.count):
        draw = random.Random(1000*options.seed + number)
        kind = KINDS[number % len(KINDS)]
        case, witness, order, holder = (random_rough if options.rough else random_mechanism)(draw, kind)
        end = draw.uniform(.25, 1.0)*options.seconds
        t, said = kalm.time(case + f" &TIME TAT={end!r} &END\n")
        freedoms[FREEDOMS[kind] or len(order) - 1] += 1
        exchanged += "Coordinates" in said
        stuck += "Sticks" in said
        if t is None or len(t["time"]) == 0 or t["time"][-1] != end:
            check(f"{kind} {number} comes to its end of {end:.3f} s: {said[-300:]}", False)
            continue
        error = difference(t, witness, order, holder, end)
        if error is None:
            check(f"{kind} {number}: joints that hold each other stick", "Sticks" in said)
            stood += 1
            continue
        errors.append(error)
        check(f"{kind} {number}: joints and speeds at {end:.3f} s are {errors[-1]:.1e} off", errors[-1] < ALLOWED)
        balances.append(np.max(np.abs(t["balance"]))/max(np.max(t["kinetic"]), np.max(np.abs(t["lost"])), np.ptp(t["potential"]), 1e-1))
        check(f"{kind} {number}: energy in balance to {balances[-1]:.1e}", balances[-1] < 1e-10)
    print(f"{len(errors)} mechanisms, {freedoms[1]}, {freedoms[2]}, {freedoms[3]} with one, two, three freedoms; {exchanged} passed a "
          f"dead point of their drives" + f"; in {stuck} joints stick, {stood} hold each other in a way that is not decided"*options.rough)
    print(f"difference from the witness: median {np.median(errors):.1e}, largest {np.max(errors):.1e}; balance of energy: largest "
          f"remainder {np.max(balances):.1e}")
    return report()


if __name__ == "__main__":
    sys.exit(main())
