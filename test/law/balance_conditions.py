#!/usr/bin/env python3
"""Conditions that counterweights satisfy, and balance of force and moment together, against Oldham's equations and momentum.

usage: test/law/balance_conditions.py PROGRAM_DIRECTORY

Equations 11.17 to 11.21 of the ten-bar linkage of the thesis are written here anew, term by term, with complex fractions of the links'
lines; those of a four-bar by loops are Berkof and Lowen's. Weights that are listed satisfy them. The least shaking moment with the
force balanced is that of the angular momentum of all bodies, differentiated numerically; a parallelogram can be balanced, a crank-rocker
cannot. Last line: N passed, N failed.
"""

import cmath
import csv
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
JOINTS = dict(zip("ABCDEFGHJKLM", map(complex, (
    0.000000, 15.320889, 74.653796, 75.000000, -17.726540, -87.840589, -85.000000, -67.497707, 31.699866, -26.711766, -57.154747, 20.000000), (
        0.000000, 12.855752, 49.998801, 0.000000, -3.125667, 44.926597, -10.000000, 24.291686, 51.530410, 126.450910, 211.145803, 190.000000))))
NUMBERS = ("two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
LINES = dict(zip(NUMBERS, ("AB", "BC", "CD", "EF", "FG", "HK", "JK", "KL", "LM")))         # first two joints of each link
BASES = dict(LINES, four="DC", six="GF", ten="ML")                                         # from the anchor of those with a weight
FOUR_BAR = """FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=%s, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=1, IKIN=10 &END
 &LIMITS TANGLE=90.0 &END
 &RATES SPEED=30.0 &END
 &MASSES NMASS=3, MLINK=-1,-2,3, MLOOP=3*1, MASS=0.5,1.5,0.9, MDIST=10.0,50.0,40.0, MANG=0.0,20.0,180.0, MINERT=1E-4,2E-3,5E-4,
  UNITL=0.001 &END
 &BALANC NWEIGH=2, WLINK=-1,3, WLOOP=2*1, WREACH=200.0, WMOST=20.0, NCOND=1, IDYNAM=1 &END
"""


def run(place, name, text):
    with open(os.path.join(place, name + ".nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, "muscle"), "--json", name + ".nml"], cwd=place, capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


def rows(place, name):
    with open(os.path.join(place, name), encoding="utf-8") as file:
        return list(csv.DictReader(file))


def value(row):
    return cmath.rect(float(row["product"]), math.radians(float(row["angle"])))


def arc(name):
    return JOINTS[name[1]] - JOINTS[name[0]]


def fraction(point, base):
    return (JOINTS[point] - JOINTS[base[0]]) / arc(base)


def ten_bar():
    """(weight, source) -> complex term, kg and length, from the line of its link."""
    centre, mass = {}, dict(zip(NUMBERS, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)))
    places = zip(NUMBERS, (10, 13, 16, 19, 22, 25, 28, 31, 34), (0, 17, 34, 51, 68, 85, 102, 119, 136))
    for link, distance, angle in places:
        line = LINES[link]
        at = JOINTS[line[0]] + cmath.rect(distance, math.radians(angle)) * arc(line) / abs(arc(line))
        centre[link] = (at - JOINTS[BASES[link][0]]) / arc(BASES[link])
    c, m = centre, mass
    j, h, e, l = fraction("J", "BC"), fraction("H", "GF"), fraction("E", "AB"), fraction("L", "ML")
    terms = {("ten", "ten"): m["ten"] * c["ten"], ("ten", "nine"): m["nine"] * c["nine"] * l,                                # 11.17
             ("seven", "seven"): m["seven"] * c["seven"], ("seven", "eight"): m["eight"] * c["eight"],
             ("seven", "nine"): m["nine"] * (1 - c["nine"]),                                                                  # 11.18
             ("four", "four"): m["four"] * c["four"], ("four", "three"): m["three"] * c["three"],
             ("four", "eight"): m["eight"] * (1 - c["eight"]) * j,                                                            # 11.19
             ("six", "six"): m["six"] * c["six"], ("six", "five"): m["five"] * c["five"], ("six", "weight"): h,
             ("six", "seven"): m["seven"] * h, ("six", "eight"): m["eight"] * c["eight"] * h,
             ("six", "nine"): m["nine"] * (1 - c["nine"]) * h,                                                                # 11.20
             ("two", "two"): m["two"] * c["two"], ("two", "five"): m["five"] * (1 - c["five"]) * e,
             ("two", "three"): m["three"] * (1 - c["three"]), ("two", "eight"): m["eight"] * (1 - c["eight"]) * (1 - j)}      # 11.21
    return {(link, source): -term * arc(BASES[link]) / (arc(LINES[link]) / abs(arc(LINES[link]))) for (link, source), term in terms.items()}


def momentum(bodies, turn):
    """Angular momentum about the input pivot at 30 rad/s, of bodies: mass, inertia, place(turn), angle(turn); SI."""
    step = 1e-4
    total = 0.0
    for mass, inertia, place, angle in bodies:
        before, now, after = place(turn - step), place(turn), place(turn + step)
        speed = (after - before) / (2 * step) * 30.0
        total += mass * (now.conjugate() * speed).imag
        change = cmath.phase(cmath.exp(1j * (angle(turn + step) - angle(turn - step))))
        total += inertia * change / (2 * step) * 30.0
    return total


def main():
    with open(os.path.join(TOP, "data", "muscle", "thesis_ten_bar.nml"), encoding="utf-8") as file:
        text = file.read()
    text = text[:text.index(" &BALANC")] + (" &BALANC NWEIGH=5, WNAME='two A','four D','six G','seven H','ten M', WREACH=90.0, WMOST=10.0, "
                                            "NCOND=3 &END\n")
    with tempfile.TemporaryDirectory() as place:
        status, listing, words = run(place, "ten", text)
        check("the ten-bar is balanced by the thesis's weights", status == 0, words)
        table = rows(place, "ten.muscle.conditions.csv")
        terms = ten_bar()
        for (link, source), term in terms.items():
            if source == "weight":
                found = [value(row) for row in table if row["link"] == link and row["kind"] == "2" and row["source"] == "seven"]
            else:
                found = [value(row) for row in table if row["link"] == link and row["kind"] == "1" and row["source"] == source]
            check("weight on %s: the term of %s is Oldham's" % (link, source), len(found) == 1 and abs(found[0] - term) < 1e-5 * (1 + abs(term)),
                  (found, term))
        count = sum(row["kind"] != "0" for row in table)
        check("there are no other terms", count == len(terms), (count, len(terms)))
        weights = {row["link"]: row for row in rows(place, "ten.muscle.weights.csv") if row["outcome"] == "design 1"}
        for row in table:
            if row["kind"] != "0":
                continue
            link = row["link"]
            product = float(weights[link]["mass"]) * float(weights[link]["distance"])
            whole = sum(term * (float(weights["seven"]["mass"]) if source == "weight" else 1.0) for (on, source), term in terms.items() if on == link)
            check("weight on %s: mass times distance" % link, abs(abs(whole) - product) < 1e-5 * product
                  and abs(value(row) - whole) < 1e-5 * product, (whole, product, row))
        check("conditions are listed", "CONDITIONS OF DESIGN 1" in listing and "EACH KG OF THE WEIGHT ON seven" in listing)

        # a four-bar by loops: Berkof and Lowen; force and moment together
        for name, lengths, possible in (("crank-rocker", (40.0, 120.0, 80.0, 130.0), False), ("parallelogram", (40.0, 120.0, 40.0, 120.0), True)):
            a, b, c, d = lengths
            case = FOUR_BAR % ",".join("%g" % length for length in lengths)
            if possible:
                # a coupler whose centre is off its line needs a weight of its own
                case = case.replace("IKIN=10", "IKIN=10, CRNKI=5.0").replace("MANG=0.0,20.0", "MANG=0.0,0.0")
            status, listing, words = run(place, "bar", case)
            table = rows(place, "bar.muscle.conditions.csv")
            check(name + ": balanced", status == 0, words)
            at = cmath.rect(50.0, math.radians(20.0))
            expected = {("crank", "coupler"): -1.5 * (1 - at / b) * a, ("rocker", "coupler"): 1.5 * (at / b) * c}
            names = {}
            for row in table:
                names.setdefault("crank" if row["link"] == "crank" else "rocker", row["link"])
            if not possible:      # there both links turn alike
                for (link, _), term in expected.items():
                    found = [value(row) for row in table if row["link"] == names[link] and row["kind"] == "1"
                             and row["source"] not in names.values()]
                    check("%s: the coupler's term of the %s" % (name, link), len(found) == 1 and abs(found[0] - term) < 1e-5 * abs(term), (found, term))
            row = rows(place, "bar.muscle.dynamic_balance.csv")[0]
            check(name + ": complete balance of force and moment is %spossible" % ("" if possible else "im"),
                  row["possible"] == ("1" if possible else "0"), row)
            check(name + ": the bound is not above", float(row["bound"]) <= float(row["after"]) + 1e-9, row)
            if possible:
                continue

            def joint(turn, a=a, b=b, c=c, d=d):
                crank = a * cmath.exp(1j * turn)
                length = abs(d - crank)
                return crank, crank + b * (d - crank) / length * cmath.exp(-1j * math.acos((length ** 2 + b ** 2 - c ** 2) / (2 * length * b)))

            links = {"crank": (lambda t: 0j, lambda t: cmath.phase(joint(t)[0])),
                     "coupler": (lambda t: joint(t)[0], lambda t: cmath.phase(joint(t)[1] - joint(t)[0])),
                     "rocker": (lambda t: complex(d), lambda t: cmath.phase(joint(t)[1] - d))}
            bodies = []
            for link, mass, inertia, distance in (("crank", 0.5, 1e-4, 10.0), ("coupler", 1.5, 2e-3, at), ("rocker", 0.9, 5e-4, 40.0)):
                origin, angle = links[link]
                bodies.append((mass, inertia, lambda t, o=origin, n=angle, r=distance: 0.001 * (o(t) + r * cmath.exp(1j * n(t))), angle))
            before = [momentum(bodies, math.radians(10 * k)) for k in range(36)]
            moments = []
            for k in range(36):
                turn, step = math.radians(10 * k), 1e-3
                moments.append(-(momentum(bodies, turn + step) - momentum(bodies, turn - step)) / (2 * step) * 30.0)
            rms = math.sqrt(sum(m * m for m in moments) / 36)
            check(name + ": the moment before is that of momentum", abs(rms - float(row["before"])) < 1e-4 * rms and len(before) == 36, (rms, row))
            # the weights of the least moment, as listed
            block = listing.split("COMPLETE BALANCE OF FORCE AND MOMENT")[1].split("WEIGHT ON")[1].split("\n")
            check(name + ": has the words", "IMPOSSIBLE WITHIN THE LIMITS" in listing and "OWN INERTIA" in block[0], listing[-900:])
            for line in block[1:]:
                numbers = line.split()[-4:]
                if len(line.split()) < 5:
                    break
                mass, distance, angle, inertia = (float(word.replace("D", "E")) for word in numbers)
                link = "crank" if "crank" in line else "rocker"
                origin, direction = links[link]
                more = math.radians(angle) + (math.pi if link == "rocker" else 0.0)
                bodies.append((mass, inertia, lambda t, o=origin, n=direction, r=distance, x=more: 0.001 * (o(t) + r * cmath.exp(1j * (n(t) + x))),
                               direction))
            moments = []
            for k in range(36):
                turn, step = math.radians(10 * k), 1e-3
                moments.append(-(momentum(bodies, turn + step) - momentum(bodies, turn - step)) / (2 * step) * 30.0)
            rms = math.sqrt(sum(m * m for m in moments) / 36)
            check(name + ": the least moment is that of momentum", len(bodies) == 5 and abs(rms - float(row["after"])) < 1e-3 * rms,
                  (len(bodies), rms, row))
    return report()


sys.exit(main())
