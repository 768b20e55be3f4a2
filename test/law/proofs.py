#!/usr/bin/env python3
"""What psalm proves over a range, against its positions at many inputs: dwells, and brackets of sketches in the poses of their links.

usage: proofs.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile
from decimal import Decimal

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PSALM = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
SAMPLES = 400
NEAR = 1e-9            # relative: rounding of positions that are compared


def run(text, place, code=0):
    """Listing, device 9 by blocks and the first table of a case."""
    with open(os.path.join(place, "case.nml"), "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([PSALM, "--quiet", "--json", "case.nml"], cwd=place, capture_output=True, text=True, check=False, timeout=300)
    check("runs", done.returncode == code, (done.returncode, done.stderr, text))
    blocks = {}
    with open(os.path.join(place, "case.dev9"), encoding="utf-8") as file:
        for part in file.read().split("\n\n\n")[1:]:
            rows = part.strip("\n").split("\n")
            blocks[rows[0].split()[-1]] = [row.split() for row in rows if not row.startswith("#")]
    with open(os.path.join(place, "case.csv"), encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file.read().split("\n\n")[0].strip("\n").split("\n")))
    return done.stdout, blocks, table


def first_input(place):
    """The first input of device 9, which counts from the drawing, as the table does."""
    with open(os.path.join(place, "case.dev9"), encoding="utf-8") as file:
        return next((float(line.split()[0]) for line in file if not line.startswith("#")), None)


def listed(numbers):
    """Numbers for a data set, some to a line."""
    texts = ["%.17G" % number for number in numbers]
    return ",\n  ".join(",".join(texts[i:i + 5]) for i in range(0, len(texts), 5))


def spread(low, high, count=SAMPLES):
    return [low + (high - low) * i / count for i in range(count + 1)]


# ---- dwells --------------------------------------------------------------------------------------------------------------------

SIX_BAR = """SIX-BAR WITH A DWELL
 &LINKS NLOOP=2, MAXARC=5, ILINK=1,-2,-3,4,0, 1,-2,-3,-4,-4, ILOOP=1,0,0,1,0, 1,1,0,0,1,
  ARCL=1.0,3.2721968,7.1472941,6.5220197,0.0, 1.0,5.3743169,2.8193555,1.1968416,7.9999999,
  GAMA=3*0.0,180.0,0.0, 0.0,2.6117033,2*0.0,96.346822, NOUTLK=4, NOUTLP=2, OUTLK=1.0, OUTANG=306.67049 &END
 &METHOD MOTION=1, %s &END
 &LIMITS TANGLE=90.0, %s &END
"""
SLIDER_CRANK = """OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1, ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, %s &END
 &LIMITS TANGLE=90.0, %s &END
"""
DISTANCE = """DISTANCE OF A COUPLER POINT
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=40.0,120.0,80.0,130.0, GAMA=3*0.0,180.0,
  NOUTLK=-2, NOUTLP=1, OUTLK=50.0, OUTANG=30.0 &END
 &METHOD MOTION=2, %s &END
 &LIMITS TANGLE=90.0, %s &END
"""


def dwells(place):
    """Within the ends proven the output stays within DWELL of its value at the dead point; a little beyond them it does not."""
    for name, text, amount in (("angle", SIX_BAR, 0.05), ("slide", SLIDER_CRANK, 1.0), ("distance", DISTANCE, 2.0)):
        listing, _, _ = run(text % ("IKIN=30", "IPROOF=1, DWELL=%g" % amount), place)
        found = [tuple(map(float, m)) for m in re.findall(r"DWELL, OUTPUT WITHIN \S+ OF ITS VALUE AT (\S+): (\S+) TO (\S+)", listing)]
        dead = re.search(r"DEAD POINTS OF THE OUTPUT: (.*)", listing)
        check(name + ": each dead point has its dwell", dead and len(found) == len(dead[1].split(",")) > 1, listing)
        for at, low, high in found:
            check(name + ": about the dead point", low < at < high or low < at + 360.0 < high, (at, low, high))
            beyond = 1e-6 * (high - low)
            inputs = [at] + spread(low, high) + [low - beyond, high + beyond]
            _, _, table = run(text % ("CRNKI=0.0, NDES=%d, DELT=%s" % (len(inputs), listed(inputs)), "IPROOF=0"), place)
            column = next(key for key in table[0] if key.startswith("output"))
            values = [float(row[column]) for row in table]
            away = [abs((value - values[0] + 180.0) % 360.0 - 180.0) if name == "angle" else abs(value - values[0]) for value in values]
            slack = NEAR * max(abs(values[0]), 1.0)
            check(name + ": within them it stays", max(away[1:-2]) <= amount + slack, (at, low, high, max(away[1:-2])))
            check(name + ": beyond them it does not", min(away[-2:]) >= amount - slack, (at, low, high, away[-2:]))


def short_segment(place):
    """The clearance of a segment whose ends nearly coincide: no less than proven at any position, and as little at the input told."""
    case = """TWO JOINTS OF A LINK NEARLY AT ONE PLACE
 &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,14.0,60.0,110.0,20.0,21.0, JY=0.0,4.0,52.0,-18.0,60.0,60.0,
  LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P Q','C D', LENP='P Q', LENV=1.0E-12 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P','point C' &END
 &METHOD %s &END
 &CONSTR IRANGE=2, NSEG=2, SJNT='P Q','C D', SWIDTH=2*0.0, SCLEAR=2*3.0 &END
"""
    listing, _, _ = run(case % "IKIN=10" + " &LIMITS IPROOF=2 &END\n", place)
    told = re.search(r"LINKS P-Q AND C-D +(\S+) +(\S+) +3.0  KEPT", listing.split("AT LEAST")[-1])
    check("short segment: it is proven", told, listing)
    if not told:
        return
    least, at = float(told[1]), float(told[2])
    inputs = spread(0.0, 360.0) + [at]
    _, _, table = run(case % ("NDES=%d, DELT=%s" % (len(inputs), listed(inputs))), place)
    gaps = []
    for row in table:
        p, c = (complex(float(row["point_%s.x" % joint]), float(row["point_%s.y" % joint])) for joint in "PC")
        along = c - 110.0 + 18.0j
        part = ((p - 110.0 + 18.0j)/along).real
        gaps.append(abs(p - 110.0 + 18.0j - min(1.0, max(0.0, part))*along))
    check("short segment: no position is nearer", least <= min(gaps)*(1.0 + NEAR), (least, min(gaps)))
    check("short segment: it is so near there", gaps[-1] <= least + 1e-5, (least, gaps[-1]))


def time_ratio(place):
    """The crank angle of the slower stroke over that of the faster one, from the two dead points."""
    listing, blocks, _ = run(SLIDER_CRANK % ("IKIN=30", "IPROOF=1"), place)
    first, second = sorted(float(row[3]) for row in blocks["dead_points"] if row[0] == "output")
    ratio = max(second - first, 360.0 - second + first)/min(second - first, 360.0 - second + first)
    told = float(re.search(r"TIME RATIO AT LEAST (\S+)", listing)[1])
    check("time ratio", ratio - 1e-6 < told <= ratio, (told, ratio))


# ---- sketches in the poses of their links --------------------------------------------------------------------------------------

# a slide between two moving links, in a group of five: the block slides along the coupler and is pinned to a rocker of its own
SLIDES = """A LARGER GROUP WITH A SLIDE
 &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,0.0,60.0,80.0,35.0,40.0,70.0, JY=0.0,25.0,60.0,0.0,85.0,-30.0,35.0,
  LNAME='frame','crank','coupler','rocker','rod','lever',
  LNK='A D F','A B','B C E','C D','E G','F', NSLIDE=1, SLNK='lever', SLNK2='rod', SLX=70.0, SLY=35.0, SLANG=60.0 &END
 &DRIVES DRIVE='F' &END
 &OUTPUTS OUTPUT='point E','angle A B','slide S1' &END
"""


TURNING = ("larger group with a slide", "stephenson2_six_bar", "geared_five_bar")   # their input is a crank


def brackets(place):
    """The value at the input told lies in its bracket, and no sample lies outside of all."""
    cases = [("larger group with a slide", SLIDES, spread(-4.0, 4.0, 4), " &METHOD NDES=%d, DELT=%s &END\n")]
    for name, low, high in (("scissors_lift", -0.2, 0.2), ("landing_gear", -150.0, 0.0), ("stephenson2_six_bar", -60.0, 0.0),
                            ("geared_five_bar", 0.0, 60.0)):
        with open(os.path.join(TOP, "data", name + ".nml"), encoding="utf-8") as file:
            text = file.read()
        text = re.sub(r" &(METHOD|LIMITS|CONSTR|RATES|MASSES|PLOT)\b.*?&END *\n", "", text, flags=re.S)
        cases.append((name, text, spread(low, high, 4), " &METHOD NDES=%d, DELT=%s &END\n"))
    for name, text, ends, method in cases:
        listing, blocks, table = run(text + method % (len(ends), listed(ends)) + " &LIMITS IPROOF=2 &END\n", place)
        check(name + ": one zero of the input", first_input(place) == float(next(value for key, value in table[0].items()
                                                                                  if key.startswith("input"))), table[0])

        def drawn(value):
            """An input in the range."""
            return value + (360.0 * round((sum((ends[0], ends[-1]))/2 - value)/360.0) if name in TURNING else 0.0)

        check(name + ": closes", "CLOSES FOR EVERY INPUT OF THE RANGE" in listing, listing)
        rows = [row for row in blocks.get("extremes", []) if "NaN" not in row]
        check(name + ": has extremes", rows, listing)
        told = sorted(drawn(float(row[k])) for row in rows for k in (5, 8))
        inputs = spread(ends[0], ends[-1]) + told
        _, _, table = run(text + method % (len(inputs), listed(inputs)) + " &LIMITS IPROOF=0 &END\n", place)
        first = next(key for key in table[0] if key.startswith("input"))
        at = {float(row[first]): row for row in table}
        for row in rows:
            low, low_high, where, high_low, high, there = map(float, row[3:])
            where, there = drawn(where), drawn(there)
            if row[0].startswith("velocity_ratio_"):
                # between two samples the rate is once their difference by that of the inputs
                output = row[0][len("velocity_ratio_"):]
                unit = (math.radians(1.0) if output.startswith("angle") else 1.0)/(math.radians(1.0) if name in TURNING else 1.0)
                pairs = sorted((value, float(one[output])) for value, one in at.items())
                quotients = [unit*(b - a)/(y - x) for (x, a), (y, b) in zip(pairs, pairs[1:]) if y - x > 1e-3*(inputs[1] - inputs[0])]
                slack = 1e-7*(1.0 + max(map(abs, quotients)))
                check("%s, %s: no difference is outside" % (name, row[0]), low - slack <= min(quotients) and max(quotients) <= high + slack and
                      max(quotients) - min(quotients) > 0.1*(high - low) - slack, (low, min(quotients), max(quotients), high))
                continue
            values = [float(one[row[0]]) for one in table]
            slack = NEAR * max(1.0, max(map(abs, values)))
            law = "%s, %s: " % (name, row[0])
            check(law + "no sample is outside", low - slack <= min(values) and max(values) <= high + slack,
                  (low, min(values), max(values), high))
            check(law + "what is told is reached", float(at[where][row[0]]) <= low_high + slack and
                  float(at[there][row[0]]) >= high_low - slack, row)
            check(law + "the brackets are narrow", low_high - low <= 1e-6 * (high - low) + slack and
                  high - high_low <= 1e-6 * (high - low) + slack, row)


def ends_of_ways(place):
    """A way of a larger group closes to an end that is rounded towards the drawing, and goes no further than one rounded away."""
    with open(os.path.join(TOP, "data", "geared_five_bar.nml"), encoding="utf-8") as file:
        text = re.sub(r" &(METHOD|LIMITS)\b.*?&END *\n", "", file.read(), flags=re.S)
    # other drawings of the same group have other last digits
    for turned in (0.0, 5.0, 10.0):
        for way in (1, -1):
            name = "geared five-bar drawn %g degrees lower, %s" % (turned, "forwards" if way > 0 else "backwards")
            drawn = text.replace("90.0,49.0", "%.1f,49.0" % (90.0 - turned))
            listing, blocks, _ = run(drawn + " &METHOD NDES=2, DELT=0.0,%.1f &END\n &LIMITS IPROOF=2 &END\n" % (way*360.0), place, code=1)
            closes, stops = re.search(r"CLOSES FROM THE DRAWING TO (\S+)", listing), re.search(r"THE INPUT GOES NO FURTHER THAN (\S+)", listing)
            rows = {row[0]: (float(row[1]), float(row[2])) for row in blocks["limits"]}
            check(name + ": a dead point", closes and stops and "undecided" in rows, listing)
            if not (closes and stops and "undecided" in rows):
                continue
            near, far = sorted(rows["undecided"], key=lambda end: way*end)
            near, far, first, last = Decimal(near), Decimal(far), Decimal(closes[1]), Decimal(stops[1])
            check(name + ": both ends, to twelve decimals", 0 <= way*(near - first) < Decimal("2e-12") and 0 <= way*(last - far) < Decimal("2e-12"),
                  (first, near, far, last))


def many_tubes(place):
    """A way along which every tube holds, but is short, comes to an end: links of which the longest is a million times the shortest."""
    with open(os.path.join(TOP, "data", "geared_five_bar.nml"), encoding="utf-8") as file:
        text = re.sub(r" &(METHOD|LIMITS)\b.*?&END *\n", "", file.read(), flags=re.S)
    text = text.replace("85.0,80.0", "85000000.0,80.0")
    check("many tubes: the drawing is changed", "85000000.0" in text, text)
    listing, _, _ = run(text + " &METHOD NDES=3, DELT=-30.0,0.0,30.0 &END\n &LIMITS IPROOF=2 &END\n", place, code=1)
    check("many tubes: a part of the way is proven, the rest undecided", listing.count("CLOSES FROM THE DRAWING TO") == 2 and
          listing.count("UNDECIDED BEYOND IT") == 2, listing)


def main():
    with tempfile.TemporaryDirectory() as place:
        ends_of_ways(place)
        many_tubes(place)
        dwells(place)
        time_ratio(place)
        short_segment(place)
        brackets(place)
    return report()


if __name__ == "__main__":
    sys.exit(main())
