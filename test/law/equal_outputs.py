#!/usr/bin/env python3
"""Outputs that are to be equal, whatever they are: EQUAL of &OUTPUTS.

usage: test/law/equal_outputs.py PROGRAM_DIRECTORY

A four-bar in dyads and a lift in the poses of its links. What a search finds is computed again here: the four-bar from its lengths,
with rates by central differences; the lift from its joints, with the leverage by the velocities of its places in the table. Solvers
with and without derivatives find the same optimum. Inputs that cannot be are refused. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

FOUR_BAR = """FOUR-BAR
 &CHAIN JNT='A','B','C','D', JX=0.0,1.0,4.0,4.0, JY=0.0,1.0,3.0,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','D C', VARY='B C','D C','A D', VLOW=2.0,1.5,2.0, VHIGH=8.0,6.0,8.0 &END
 &DRIVES DRIVE='A', DLINK='crank' &END
 &OUTPUTS OUTPUT='angle rocker','angle coupler','point C','x C','point B', ONAME='rocker','coupler','pin','reach','end',
  %s &END
 &METHOD NDES=5, DELT=0.0,30.0,60.0,90.0,120.0%s &END
 &SEARCH SOLVER='%s', NSTART=10%s &END
"""
BOTH = "EQUAL='rocker 1 rocker 5','coupler 2 coupler 4','reach end'"
LAW = "EQORD=1,0, EQADD=0.0,5.0, EQWGT=2.0,1.0, DES4=4*0.0,3.2, WGT4=4*0.0,1.0"


def run(programs, program, text, folder, *options):
    """A run of a case: exit status, listing, remarks."""
    path = os.path.join(folder, "case.nml")
    with open(path, "w") as out:
        out.write(text)
    done = subprocess.run([os.path.join(programs, program), path, *options], capture_output=True, text=True, timeout=120, cwd=folder)
    return done.returncode, done.stdout, done.stderr


def lengths(listing):
    """Lengths between joints, as the listing has them."""
    found = {}
    for line in listing.split("ANGLES, DEGREES")[0].splitlines():
        words = line.split()
        if len(words) == 3 and words[0] in "ABCD" and words[1] in "ABCD":
            found["".join(sorted(words[:2]))] = float(words[2])
    return found


def table(folder):
    with open(os.path.join(folder, "case.csv")) as source:
        return list(csv.DictReader(source))


def four_bar(of, crank):
    """Direction of coupler and rocker, degrees, and the pin between them, by circles."""
    b = of["AB"] * cmath.exp(1j * math.radians(crank))
    d = complex(of["AD"], 0.0)
    line = d - b
    along = (abs(line) ** 2 + of["BC"] ** 2 - of["CD"] ** 2) / (2.0 * abs(line))
    across = math.sqrt(of["BC"] ** 2 - along**2)
    c = b + line / abs(line) * complex(along, across)
    return math.degrees(cmath.phase(c - b)), math.degrees(cmath.phase(c - d)), c, b


def of_four_bar(programs, folder):
    """Equal rates, equal angles but for five degrees, and a wanted place."""
    objectives = []
    for solver in ("LSQ", "LN_COBYLA", "LD_SLSQP"):
        status, listing, remarks = run(programs, "psalm", FOUR_BAR % (BOTH.replace(",'reach end'", "") + ", " + LAW, "", solver, ""),
                                       folder)
        check(status == 0, "four-bar, %s: exit status %d" % (solver, status))
        objectives.append(float(remarks.split("best objective")[1].split()[0]))
    check(max(objectives) < min(objectives) * (1.0 + 1e-5), "solvers find one optimum: %s" % objectives)
    status, listing, remarks = run(programs, "psalm", FOUR_BAR % (BOTH.replace(",'reach end'", "") + ", " + LAW, "", "LSQ", ""), folder)
    of = lengths(listing)
    start = 45.0
    step = 1e-4

    def rate(delt):
        high, low = (four_bar(of, start + delt + sign * step)[1] for sign in (1, -1))
        return (high - low) / (2.0 * step)

    total = 2.0 * (rate(0.0) - rate(120.0)) ** 2
    total += (four_bar(of, start + 30.0)[0] - four_bar(of, start + 90.0)[0] - 5.0) ** 2
    total += (four_bar(of, start + 120.0)[2].real - 3.2) ** 2
    check(abs(total - objectives[0]) < 1e-4 * total, "its objective, computed again: %.7g, %.7g" % (total, objectives[0]))
    check("To be equal         rocker 1 rocker 5: off by at most" in remarks, "the summary says how far they are off")
    rows = [line.split() for line in listing.splitlines() if line.startswith("  rocker (VEL)")]
    check(len(rows) == 1 and abs(float(rows[0][6]) - rate(0.0)) < 1e-5 and abs(float(rows[0][7]) - rate(120.0)) < 1e-5,
          "rates in the listing")
    # two outputs at every position, of two numbers: a pin that is to follow the crank's end at twice the distance
    status, listing, remarks = run(programs, "psalm", FOUR_BAR % ("EQUAL='pin end', EQMULT=2.0, EQADD=1.0", "", "LSQ", ""), folder)
    of = lengths(listing)
    total = 0.0
    for delt in (0.0, 30.0, 60.0, 90.0, 120.0):
        _, _, c, b = four_bar(of, start + delt)
        miss = c - 2.0 * b - complex(1.0, 1.0)
        total += abs(miss) ** 2
    found = float(remarks.split("best objective")[1].split()[0])
    check(status == 0 and abs(total - found) < 1e-5 * total, "a point against another: %.7g, %.7g" % (total, found))
    # an analysis, and the thesis's simplex
    status, listing, remarks = run(programs, "psalm", FOUR_BAR.replace("VARY='B C','D C','A D', VLOW=2.0,1.5,2.0, VHIGH=8.0,6.0,8.0",
                                                                       "KOVER=0") % ("EQUAL='rocker 1 rocker 3'", "", "LSQ", ""), folder)
    first, third = (four_bar({"AB": math.sqrt(2.0), "BC": math.sqrt(13.0), "CD": 3.0, "AD": 4.0}, start + d)[1] for d in (0.0, 60.0))
    check("TOTAL ERROR" in listing and abs(float(listing.split("TOTAL ERROR")[1].split()[0]) - (first - third) ** 2)
          < 1e-6 * (first - third) ** 2, "an analysis has the difference")
    status, listing, remarks = run(programs, "psalm", FOUR_BAR % ("EQUAL='rocker 1 rocker 5', EQORD=1", ", NITER=3000, VAR=0.1",
                                                                  "SIMPLEX", ", NBEST=1"), folder)
    found = float(remarks.split("best objective")[1].split()[0])
    of = lengths(listing)
    check(abs((rate_of(of, start) - rate_of(of, start + 120.0)) ** 2 - found) < 1e-6 + 1e-3 * found, "several simplexes: %g" % found)


def of_orders(programs, folder):
    """The same question with outputs in another order, with sides exchanged, and beside a group larger than dyads: one answer."""
    first = FOUR_BAR % (BOTH.replace(",'reach end'", "") + ", " + LAW, "", "LSQ", "")
    other = first.replace("'angle rocker','angle coupler','point C','x C','point B'", "'x C','point C','angle coupler','point B','angle rocker'")
    other = other.replace("'rocker','coupler','pin','reach','end'", "'reach','pin','coupler','end','rocker'").replace("DES4", "DES1").replace("WGT4", "WGT1")
    turned = first.replace("'rocker 1 rocker 5','coupler 2 coupler 4'", "'rocker 5 rocker 1','coupler 4 coupler 2'").replace("0.0,5.0", "0.0,-5.0")
    # a plate on two links to the frame and one to the coupler, far away, whose dimensions do not vary
    beside = first.replace("'C','D', JX=0.0,1.0,4.0,4.0, JY=0.0,1.0,3.0,0.0,", "'C','D','E','F','G','H','I','K', JX=0.0,1.0,4.0,4.0,19.0,24.0,15.0,19.0,"
                           "24.5,2.0, JY=0.0,1.0,3.0,0.0,15.0,15.5,16.0,0.0,0.0,4.0,")
    beside = beside.replace("'coupler','rocker',\n", "'coupler','rocker','plate','left','right','tie',\n")
    beside = beside.replace("LNK='A D','A B','B C','D C'", "LNK='A D H I','A B','B C K','D C','E F G','E H','F I','G K'")
    objectives = []
    for case in (first, other, turned, beside):
        status, _, remarks = run(programs, "psalm", case, folder)
        check(status == 0, "orders: exit status %d %s" % (status, remarks[:100]))
        objectives.append(float(remarks.split("best objective")[1].split()[0]))
    check(max(objectives) < min(objectives) * (1.0 + 1e-5), "outputs in another order, another group beside: %s" % objectives)


def rate_of(of, crank, step=1e-4):
    return (four_bar(of, crank + step)[1] - four_bar(of, crank - step)[1]) / (2.0 * step)


def of_lift(programs, folder, source):
    """The lift of the data set: its leverage from the places of its joints alone."""
    status, listing, remarks = run(programs, "psalm", open(source).read(), folder)
    check(status == 0, "lift: exit status %d" % status)
    rows = table(folder)

    def place(row, joint):
        return complex(float(row[joint + ".x"]), float(row[joint + ".y"]))

    # the arms turn about their pin by the law of the scissors: rise of the deck for the stroke, by differences of the arm's angle
    pins = {name: place(rows[0], name) for name in "AMBCDPQ"}
    arm1 = cmath.phase(pins["M"] - pins["A"])
    arm2 = cmath.phase(pins["M"] - pins["B"])
    p = (pins["P"] - pins["A"]) * cmath.exp(-1j * arm1)
    q = (pins["Q"] - pins["B"]) * cmath.exp(-1j * arm2)

    def lift(angle):
        foot = complex(2.0 * math.cos(angle), 0.0)
        at_p = p * cmath.exp(1j * angle)
        at_q = foot + q * cmath.exp(1j * (math.pi - angle))
        return 2.0 * math.sin(angle), abs(at_q - at_p)

    def leverage(angle, step=1e-5):
        high, low = lift(angle + step), lift(angle - step)
        return (high[0] - low[0]) / (high[1] - low[1])

    ends = []
    for row in (rows[0], rows[-1], rows[4]):
        angle = cmath.phase(place(row, "M") - place(row, "A"))
        check(abs(lift(angle)[1] - float(row["cylinder"])) < 1e-9, "lift: length of the cylinder")
        ends.append(leverage(angle))
    wanted = [(float(rows[0]["height"]) - 0.45) ** 2, (float(rows[-1]["height"]) - 1.35) ** 2, (ends[2] - 2.2) ** 2,
              10.0 * (ends[0] - ends[1]) ** 2]
    found = float(remarks.split("best objective")[1].split()[0])
    check(abs(sum(wanted) - found) < 1e-6 * found, "lift: objective %.9g, %.9g" % (sum(wanted), found))
    check(abs(ends[0] - ends[1]) < 0.02, "nearly the same leverage at both ends: %.9g, %.9g" % tuple(ends[:2]))
    check("leverage 1 leverage 9" in listing.split("ANGLES, DEGREES")[0], "the listing of the search has it")
    status, listing, _ = run(programs, "psalm", open(os.path.join(folder, "case.dev7")).read(), folder)
    check(status == 0 and "OUTPUTS THAT ARE TO BE EQUAL" in listing and abs(float(listing.split("TOTAL ERROR")[1].split()[0]) - found) < 1e-6 * found,
          "device 7 keeps what is to be equal")


def of_slides(programs, folder):
    """The travel of a slide counts from the drawing, and a found linkage is drawn anew: device 7 gives the same error."""
    case = """SLIDER-CRANK
 &CHAIN JNT='A','B','C', JX=0.0,1.0,5.0, JY=0.0,1.0,0.5, LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',
  SLNK='frame', SLNK2='piston', SLX=5.0, SLY=0.5, SLANG=0.0, VARY='A B','B C', VLOW=0.5,3.0, VHIGH=2.0,8.0 &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='slide S1','x B', ONAME='piston','pin', EQUAL='piston 2 pin 2', EQADD=0.5, DES2=0.0,0.9,0.0, WGT2=0.0,1.0,0.0 &END
 &METHOD NDES=3, DELT=10.0,40.0,80.0 &END
 &SEARCH SOLVER='LSQ', NSTART=5 &END
"""
    status, listing, remarks = run(programs, "psalm", case, folder)
    first = float(listing.split("TOTAL ERROR")[-1].split()[0])
    again, listing, _ = run(programs, "psalm", open(os.path.join(folder, "case.dev7")).read(), folder)
    second = float(listing.split("TOTAL ERROR")[-1].split()[0])
    check(status == 0 and again == 0 and abs(first - second) < 1e-9 + 1e-6 * abs(first), "a slide: %g, from device 7 %g" % (first, second))


def of_mistakes(programs, folder):
    for words, extra, what, needed in (
            ("EQUAL='rocker'", "", "", "names no two outputs"),
            ("EQUAL='rocker 1 rocket 5'", "", "", "no output is called 'rocket'; did you mean 'rocker'"),
            ("EQUAL='rocker 1 rocker 6'", "", "", "there is no position 6 among NDES=5"),
            ("EQUAL='rocker one rocker 5'", "", "", "is no number of a position"),
            ("EQUAL='rocker rocker'", "", "", "compares an output with itself"),
            ("EQUAL='rocker pin'", "", "", "cannot be equal"),
            ("EQUAL='rocker reach'", "", "", "one is an angle"),
            ("EQUAL='rocker 1 rocker 5', EQORD=3", "", "", "is the order of a derivative"),
            ("EQUAL='rocker 1 rocker 5', EQMULT=2.0", "", "", "of angles is 1 or -1"),
            ("EQUAL='rocker 1 rocker 5', EQWGT=0.0", "", "", "weights must be positive"),
            ("EQADD=1.0", "", "", "there are none: EQUAL"),
            ("EQUAL='rocker 1 rocker 5'", ", IFREE=1", "", "the inputs are unknown"),
            ("EQUAL='rocker 1 rocker 5'", "", ", PARETO='LARGEST', NBEST=2", "of which there are none"),
            ("EQUAL='rocker 1 rocker 5'", "", ", NFEW=3", "leaves most of them out")):
        status, _, remarks = run(programs, "psalm", FOUR_BAR % (words, extra, "LSQ", what), folder)
        check(status == 2 and needed in " ".join(remarks.split()), "%s%s%s: status %d, %s" % (words, extra, what, status,
                                                                                              remarks.strip()[:120]))
    without = FOUR_BAR % ("EQUAL='rocker 1 rocker 5'", "", "LSQ", ", NBEST=2")
    status, listing, _ = run(programs, "psalm", without, folder)
    check(status == 0 and "LINKAGES FOUND" in listing and "ERRORS ARE THOSE OF" not in listing
          and all(c == "\n" or c.isprintable() for c in listing), "a ranking without desired values names no output")
    turn = without.replace(re.search("NDES=5.*?(?= *&END)", without, re.S).group(), "IKIN=30")
    status, _, remarks = run(programs, "psalm", turn, folder)
    check(status == 0 and "EQUAL: has no effect" in remarks, "an analysis through a turn: %d, %s" % (status, remarks[:200]))


def main():
    programs = os.path.abspath(sys.argv[1])
    data = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "data")
    with tempfile.TemporaryDirectory() as folder:
        of_four_bar(programs, folder)
        of_orders(programs, folder)
        of_lift(programs, folder, os.path.join(data, "types", "scissors_even.nml"))
        of_slides(programs, folder)
        of_mistakes(programs, folder)
    return report()


if __name__ == "__main__":
    sys.exit(main())
