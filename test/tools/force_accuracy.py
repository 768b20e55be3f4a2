#!/usr/bin/env python3
"""Forces beside dead points, every kind of dyad that has one: kalm against a build of it in quadruple precision.

usage: force_accuracy.py EPSILON KALM QUAD_KALM

EPSILON is that of KALM's real kind. Each linkage comes to a dead point at a crank angle that is known exactly; positions are
binary fractions of a degree before it, which both builds read alike. The error of every load (a joint's force as a vector, the
drive, force and moment on the frame) must stay within 16 EPSILON times its condition number: the sum, over lengths (by their
relative changes) and angles (by radians), of the load's derivatives by quadruple precision, over the load. At the dead point
itself kalm must name the loop, end with status 1 and print no NaN in the listing. Last line: N passed, N failed."""
import os
import subprocess
import sys
import tempfile
from decimal import Decimal, getcontext

getcontext().prec = 60
RADIAN = Decimal(180) / Decimal("3.14159265358979323846264338327950288419716939937510582097494")
STEP = Decimal("1e-20")          # relative change of a dimension
OFFSETS = [2.0 ** -k for k in (-2, 4, 10, 16, 22)]     # degrees before the dead point

# name: ILINK, ILOOP, ARCL, GAMA (what is not 0 varies), crank angle of the dead point, arcs with masses
LINKAGES = {
    # 3, 4, 5: at 90 degrees coupler and rocker are in one line
    "RRR": ("1,2,3,4", "1,0,0,1", "3.0,2.0,3.0,4.0", "0.0,0.0,0.0,180.0", 90, (2, -3)),
    # at 0 degrees the crank pin is as near to the pivot as the slide's guide is long: a slide without length
    "RPR, the first slides": ("1,2,3,4", "1,-3,0,1", "3.0,0.0,2.0,5.0", "0.0,0.0,0.0,180.0", 0, (-2, 3)),
    "RPR, the second slides": ("1,2,3,4", "1,0,-2,1", "3.0,2.0,0.0,5.0", "0.0,0.0,0.0,180.0", 0, (2, 3)),
    # rod square to the slide at 30 and at 60 degrees
    "RRP": ("1,-2,3,4", "1,0,-4,1", "6.0,3.0,0.0,0.0", "0.0,0.0,0.0,270.0", 30, (-2, -3)),
    "PRR": ("1,2,3,4", "1,-1,0,1", "3.0,0.0,2.0,2.0", "0.0,0.0,0.0,180.0", 60, (2, -3)),
    # both slides parallel at 0 degrees, where they meet nowhere
    "PRP": ("1,2,-3,4", "1,-1,-4,1", "0.0,0.0,0.0,4.0", "0.0,0.0,0.0,180.0", 0, (2, -3)),
}

# what is told at the dead point, if the linkage closes there no more
WORDS = {"PRP": "LOOP 1, DYAD OF TYPE 8 (ARCS 2 AND 3), POSITION 1: THE SLIDES ARE PARALLEL"}


def text(ilink, iloop, lengths, angles, masses, delt, crnki):
    """A data set with masses on both links of the dyad, weight and a load."""
    values = lambda numbers: ",".join(str(n) for n in numbers)
    n = len(masses)
    return "\n".join([
        "BESIDE A DEAD POINT",
        f" &LINKS NLOOP=1, MAXARC={len(lengths)}, ILINK={ilink}, ILOOP={iloop}, ARCL={values(lengths)},",
        f"  GAMA={values(angles)}, NOUTLK=2, NOUTLP=1 &END",
        f" &METHOD NDES={len(delt)}, DELT={values(delt)}, CRNKI={crnki} &END",
        " &RATES SPEED=10.0, ACCEL=3.0 &END",
        f" &MASSES NMASS={n + 1}, MLINK=-1,{values(masses)}, MLOOP={values([1] * (n + 1))}, MASS={values([0.5] * (n + 1))},",
        f"  MDIST={values([0.25] * (n + 1))}, MANG={values([30.0] * (n + 1))}, MINERT={values([0.125] * (n + 1))}, GRAVY=-9.8125 &END",
        f" &LOADS NLOAD=1, LLINK={masses[-1]}, LLOOP=1, LFX=16.0, LFY=-5.0 &END", ""])


class Bench:
    def __init__(self, kalm, quad, folder):
        self.kalm, self.quad, self.folder, self.runs = kalm, quad, folder, 0

    def run(self, program, words):
        """Exit status, listing, and the columns of device 9 as rows of loads: {name: [components]}."""
        self.runs += 1
        case = os.path.join(self.folder, f"case{self.runs}.nml")
        with open(case, "w", encoding="ascii") as file:
            file.write(words)
        done = subprocess.run([program, "--output-dir", self.folder, case], capture_output=True, text=True,
                              check=False, timeout=60)
        rows = []
        nine = case[:-4] + ".kalm.dev9"
        if not os.path.exists(nine):
            raise SystemExit(f"{program} wrote no device 9:\n{words}\n{done.stderr}")
        with open(nine, encoding="ascii") as file:
            names = []
            for line in file:
                if line.startswith("# input"):
                    names = line[1:].split()
                elif not line.startswith("#") and line.strip():
                    rows.append(loads(dict(zip(names, line.split()))))
        return done.returncode, done.stdout + done.stderr, rows


def loads(row):
    """The loads of a position as vectors: a joint's force, of a slide the force and the couple each by itself."""
    out = {"drive": [row["drive"]], "frame": [row["frame_fx"], row["frame_fy"]], "moment": [row["frame_m"]]}
    for name in row:
        if name.endswith("_fx") and name != "frame_fx":
            out[name[:-3]] = [row[name], row[name[:-3] + "_fy"]]
        elif name.endswith(("_n", "_m")) and name != "frame_m":
            out[name] = [row[name]]
    return {name: [Decimal(v) for v in values] for name, values in out.items()}


def norm(vector):
    return sum(v * v for v in vector).sqrt()


def condition(bench, linkage, delt, exact):
    """{load: condition number} for every position."""
    ilink, iloop, arcl, gama, dead, masses = linkage
    lengths, angles = [Decimal(v) for v in arcl.split(",")], [Decimal(v) for v in gama.split(",")]
    totals = [{name: Decimal(1) for name in row} for row in exact]
    variants = []
    for k, length in enumerate(lengths):
        if length:
            changed = list(lengths)
            changed[k] = length * (1 + STEP)
            variants.append((changed, angles, Decimal(0)))
    for k, angle in enumerate(angles):
        if angle:
            changed = list(angles)
            changed[k] = angle + RADIAN * STEP
            variants.append((lengths, changed, Decimal(0)))
    variants.append((lengths, angles, RADIAN * STEP))
    for changed_lengths, changed_angles, crnki in variants:
        rows = bench.run(bench.quad, text(ilink, iloop, changed_lengths, changed_angles, masses, delt, crnki))[2]
        for total, row, base in zip(totals, rows, exact):
            for name, vector in row.items():
                size = norm(base[name])
                if size:
                    total[name] += norm([a - b for a, b in zip(vector, base[name])]) / STEP / size
    return totals


def main(arguments):
    epsilon = Decimal(arguments[0])
    passed, failed, worst = 0, [], Decimal(0)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments[1], arguments[2], folder)
        for kind, linkage in LINKAGES.items():
            ilink, iloop, arcl, gama, dead, masses = linkage
            lengths, angles = arcl.split(","), gama.split(",")
            delt = [dead - offset for offset in OFFSETS]
            words = text(ilink, iloop, lengths, angles, masses, delt, 0.0)
            got = bench.run(bench.kalm, words)[2]
            exact = bench.run(bench.quad, words)[2]
            conditions = condition(bench, linkage, delt, exact)
            for offset, row, want, limits in zip(OFFSETS, got, exact, conditions):
                for name, vector in row.items():
                    size = norm(want[name])
                    law = f"{kind}, {offset} degrees before the dead point: {name}"
                    if not all(v.is_finite() for v in vector):
                        # where no digit is left the position may count as the dead point itself
                        if 16 * epsilon * limits[name] >= 1:
                            passed += 1
                        else:
                            failed.append(f"{law}: no number")
                        continue
                    if not size:
                        continue
                    ratio = norm([a - b for a, b in zip(vector, want[name])]) / size / (epsilon * limits[name])
                    worst = max(worst, ratio)
                    if ratio <= 16:
                        passed += 1
                    else:
                        failed.append(f"{law}: error {float(ratio):.1f} epsilon x condition {float(limits[name]):.2e}")
            status, listing, rows = bench.run(bench.kalm, text(ilink, iloop, lengths, angles, masses, [dead], 0.0))
            for law, holds in (("ends with status 1", status == 1), ("prints no NaN", "NaN" not in listing),
                               ("names the loop", WORDS.get(kind, "DEAD POINT OF LOOP 1: FORCES ARE INFINITE") in listing),
                               ("has NaN on device 9", all(v.is_nan() for values in rows[0].values() for v in values))):
                if holds:
                    passed += 1
                else:
                    failed.append(f"{kind} at its dead point {law}: status {status}\n{listing[-600:]}")
    for line in failed:
        print("FAILED:", line)
    print(f"largest error: {float(worst):.2f} epsilon x condition number")
    print(f"{passed} passed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
