#!/usr/bin/env python3
"""Every six-bar through the points of a function: counts, a linkage made here is found, and each that is listed meets its points.

usage: test/published/six_bars.py [BIN]    default: build/local/bin
       test/published/six_bars.py BIN all  Watt II through nine and eight points and Stephenson II through eight too: minutes for
                                           their start sets
The linkage is made here with intersections of circles; what is listed is run again as a sketch by the suite's own analysis."""
import cmath
import importlib.util
import math
import os
import re
import struct
import subprocess
import sys
import tempfile

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = sys.argv[1] if len(sys.argv) > 1 else os.path.join(TOP, "build", "local", "bin")
EVERYTHING = "all" in sys.argv[2:]
sys.path.insert(0, os.path.join(TOP, "test", "tools"))
import tally
from tally import check


def psalm(name, text, folder):
    """status, listing, standard error"""
    path = os.path.join(folder, name + ".nml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(BIN, "psalm"), path], capture_output=True, text=True, timeout=3000,
                          env=dict(os.environ, XDG_CACHE_HOME=os.path.join(folder, "cache")))
    return done.returncode, done.stdout, done.stderr


def table_of(path, block):
    """Rows of a block of device 9 by column."""
    rows, names, inside = [], None, False
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("# block "):
                inside = line.split()[2] == block
                names = None
            elif inside and line.startswith("# rank "):
                names = line[1:].split()
            elif inside and names and line.strip() and not line.startswith("#"):
                rows.append(dict(zip(names, map(float, line.split()))))
    return rows


def positions_of(path):
    """Output angles of every case of a file of sketches."""
    blocks = [[]]
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("#"):
                continue
            if line.strip():
                blocks[-1].append([float(v) for v in line.split()])
            elif blocks[-1]:
                blocks.append([])
    return [[row[2] for row in block] for block in blocks if block and len(block[0]) == 4]


def meet(name, folder, wanted):
    """Every listed linkage turns its output as is wanted, by the suite's own analysis."""
    with open(os.path.join(folder, name + ".dev7"), encoding="utf-8") as file:
        status, _, errors = psalm(name + "_again", file.read(), folder)
    check(name + ": device 7 is a file of cases", status in (0, 1), errors[:200])
    rows = positions_of(os.path.join(folder, name + "_again.dev9"))
    listed = table_of(os.path.join(folder, name + ".dev9"), "exact")
    check(name + ": a case for every linkage listed", len(rows) == len(listed) > 0, (len(rows), len(listed)))
    worst = max((abs(math.remainder(a - r[0] - w + wanted[0], 360.0)) for r in rows for a, w in zip(r, wanted)), default=math.inf)
    check(name + ": the analysis meets the points", all(len(r) == len(wanted) for r in rows) and worst < math.degrees(1e-9), worst)


def chebyshev(n):
    return [0.5 - 0.5*math.cos(math.pi*(2*k - 1)/(2*n)) for k in range(1, n + 1)]


def circles(a, ra, b, rb, side):
    """The point at ra from a and rb from b, on a side of the line from a to b."""
    d = abs(b - a)
    x = (d*d + ra*ra - rb*rb)/(2*d)
    return a + (b - a)/d*complex(x, side*math.sqrt(ra*ra - x*x))


def made(phis):
    """Outputs of a Stephenson III, and its numbers p q r s c: crank, floating link, output link and third pivot."""
    p, rocker, side, q, r, pivot, s_length, link, side_2 = 0.35+0.1j, 0.9, 1, 1.1, 0.7+0.5j, 1.4+0.6j, 0.8, 0.9, -1
    outputs, numbers = [], None
    first = None
    for phi in phis:
        pin = p*cmath.exp(1j*phi)
        d = circles(pin, q, 1.0, rocker, side)
        float_link = d - pin
        g = pin + r*float_link/q
        h = circles(pivot, s_length, g, link, side_2)
        if first is None:
            first = h - pivot
            numbers = [p, float_link, g - pin, -first, -pivot]
        outputs.append(cmath.phase((h - pivot)/first))
    return outputs, numbers


def table(phis, outputs, p, c):
    """A data set: Stephenson III through these angles, radians; crank and third pivot are given."""
    degrees = [",".join("%.17g" % math.degrees(v) for v in angles) for angles in (phis, outputs)]
    return ("TABLE\n &EXACT KIND='FUNCTION', SIXBAR='STEPHENSON', PHI=%s,\n  PSI=%s,\n"
            "  PIVOTS=%r,%r, CRANK=%r,%r, TRMIN=0.0, NBEST=200 &END\n" % (*degrees, -c.real, -c.imag, p.real, p.imag))


FUNCTION = """X**2
 &EXACT KIND='FUNCTION', SIXBAR='STEPHENSON', NPOINT=7, FUNC='POWER', FPOWER=2.0, FXLOW=0.0, FXHIGH=1.0, DPHI=90.0, DPSI=90.0,
  PIVOTS=-1.4,-0.5, CRANK=0.4,0.1, TRMIN=0.0, NBEST=100, CERTIFY=1 &END
"""
SINE = """SINE
 &EXACT KIND='FUNCTION', SIXBAR='STEPHENSON', NPOINT=7, FUNC='SIN', FXLOW=0.0, FXHIGH=90.0, DPHI=90.0, DPSI=90.0,
  PIVOTS=-1.4,-0.5, CRANK=0.4,0.1, TRMIN=0.0, NBEST=100 &END
"""
WATT = """X**2
 &EXACT KIND='FUNCTION', SIXBAR='WATT', NPOINT=9, FUNC='POWER', FPOWER=2.0, FXLOW=0.0, FXHIGH=1.0, DPHI=90.0, DPSI=90.0,
  TRMIN=0.0, RLONG=50.0, NBEST=100 &END
"""


EIGHT = """LOG10
 &EXACT KIND='FUNCTION', SIXBAR='WATT', NPOINT=8, FUNC='LOG10', FXLOW=1.0, FXHIGH=50.0, DPHI=90.0, DPSI=90.0, ARMLEN=0.75,
  TRMIN=0.0, RLONG=50.0, NBEST=100, CERTIFY=1 &END
"""
SECOND = """X**2
 &EXACT KIND='FUNCTION', SIXBAR='STEPHENSON2', NPOINT=8, FUNC='POWER', FPOWER=2.0, FXLOW=0.0, FXHIGH=1.0, DPHI=90.0, DPSI=90.0,
  OUTPIN=-0.8,-0.3, ARMLEN=1.2, TRMIN=0.0, NBEST=100, CERTIFY=1 &END
"""


def turned_by(row, degrees, steps):
    """Output turns in degrees of a Stephenson III at inputs from 0, followed with intersections of circles."""
    a, b = 0j, 1 + 0j
    c, d, e, g, h = (complex(row[n + "x"], row[n + "y"]) for n in "cdegh")
    side_d = 1 if ((b - c).conjugate()*(d - c)).imag > 0 else -1
    side_h = 1 if ((g - e).conjugate()*(h - e)).imag > 0 else -1
    turns = []
    for i in range(steps + 1):
        pin = a + (c - a)*cmath.exp(1j*math.radians(degrees*i/steps))
        other = circles(pin, abs(d - c), b, abs(d - b), side_d)
        coupler = pin + (g - c)*(other - pin)/(d - c)
        output = circles(e, abs(h - e), coupler, abs(h - g), side_h)
        turns.append(math.degrees(cmath.phase((output - e)/(h - e))))
    return turns


def least_errors(folder):
    """Six-bars whose largest error is made least: it is what intersections of circles say, and less than that of the exact ones."""
    text = FUNCTION.replace("TRMIN=0.0, NBEST=100, CERTIFY=1", "TRMIN=20.0, MINIMAX=1")
    status, listing, errors = psalm("least", text, folder)
    check("MINIMAX: all exact ones are found first", status == 0 and "complete: 1286 of 1286" in listing, listing + errors)
    rows = table_of(os.path.join(folder, "least.dev9"), "exact")
    check("MINIMAX: linkages are listed", rows, listing)
    for row in rows:
        places = 900
        errors = [t - 90.0*(i/places)**2 for i, t in enumerate(turned_by(row, 90.0, places))]
        # where the range begins the output need not be where it is wanted
        middle = 0.5*(max(errors) + min(errors))
        largest = max(errors) - middle
        check("MINIMAX: the error listed", abs(largest - row["error"]) < 2e-3*row["error"], (largest, row["error"]))
        check("MINIMAX: less than before", row["error"] < row["before"], row)
        check("MINIMAX: TRMIN is kept", row["transmission"] > 20.0 - 0.01, row["transmission"])
    # a table of more entries than an exact linkage meets
    places = [k/14 for k in range(15)]
    entries = FUNCTION[:FUNCTION.index("NPOINT")] + "PHI=%s,\n  PSI=%s,\n  PIVOTS=-1.4,-0.5, CRANK=0.4,0.1, TRMIN=20.0, MINIMAX=1 &END\n" % (
        ",".join("%.15g" % (90.0*p + 7.0) for p in places), ",".join("%.15g" % (90.0*p*p - 3.0) for p in places))
    status, listing, errors = psalm("entries", entries, folder)
    rows = table_of(os.path.join(folder, "entries.dev9"), "exact") if status == 0 else []
    check("MINIMAX of a table: linkages are listed", rows, listing + errors)
    for row in rows:
        errors = [t - 90.0*p*p for t, p in zip(turned_by(row, 90.0, 14), places)]
        largest = 0.5*(max(errors) - min(errors))
        check("MINIMAX of a table: the error listed", abs(largest - row["error"]) < 2e-2*row["error"] + 1e-9, (largest, row["error"]))
    for name, change, words in (
            ("points", ("NPOINT=7", "NPOINT=9"), "a six-bar of Stephenson III is made for"),
            ("hours", ("NPOINT=7", "NPOINT=9, CRANK=,"), "START=1 asks for them"),
            ("start", ("NPOINT=7", "NPOINT=7, START=1"), "through 9 or 11 points"),
            ("arm", ("NPOINT=7", "NPOINT=7, ARMLEN=1.0"), "is not to be chosen in a six-bar of Stephenson III")):
        text = FUNCTION.replace(*change)
        if name == "hours":
            text = text.replace("NPOINT=9, CRANK=,", "NPOINT=9").replace(", CRANK=0.4,0.1", "")
        status, _, errors = psalm(name, text, folder)
        check("refused: " + name, status == 2 and words in errors, (status, errors))


def left_out(folder):
    """Limits that leave nothing are named with what they remove."""
    status, _, errors = psalm("flat", SINE.replace("TRMIN=0.0", "TRMIN=89.0"), folder)
    check("TRMIN leaves none", status == 1 and " with a transmission angle less than TRMIN" in errors and "RLONG" not in errors, errors)
    status, _, errors = psalm("long", SINE.replace("TRMIN=0.0", "TRMIN=0.0, RLONG=1.01"), folder)
    check("RLONG leaves none", status == 1 and " with a link longer than RLONG" in errors and "TRMIN" not in errors, errors)


def cut_short(folder, kept):
    """A study that MAXTIME ends; a start set that it ends is gone on with, unless its file is damaged."""

    def known(seconds):
        """Solutions known when it was stopped; -1: it was not."""
        status, listing, _ = psalm("short", FUNCTION.replace("NBEST=100", "MAXTIME=%g" % seconds), folder)
        found = re.search(r"while the start set was made, (\d+) of 1286 solutions known", listing)
        return int(found[1]) if found else 1286 if status == 1 and "not complete: stopped after MAXTIME" in listing else -1

    check("a start set that is kept is not said to be made", known(0.001) == 1286)
    # behind the head of three numbers: seed, passes, idle passes, done, numbers of a solution, solutions
    os.remove(kept)
    seconds, passes, solutions = 0.05, 0, 0
    while solutions <= 2 and seconds < 60.0:
        before = passes
        known(seconds)
        if os.path.exists(kept):
            with open(kept, "rb") as file:
                state = file.read()
            _, passes, _, done, _, solutions = struct.unpack("6q", state[24:72])
        if passes == before:
            seconds *= 1.5
    check("a start set is kept while it is made", passes > 0 and not done and 2 < solutions < 1286, (passes, done, solutions))
    check("a start set is gone on with", known(0.001) == solutions, solutions)
    for name, place, change in (("one bit", len(state)//2//8*8, bytes([state[len(state)//2//8*8] ^ 1])),
                                ("no number", len(state)//2//8*8, struct.pack("d", math.nan)),
                                ("cut short", len(state) - 8, None)):
        with open(kept, "wb") as file:
            file.write(state[:place] + (change + state[place + len(change):] if change else b""))
        check("a damaged start set is made anew: " + name, 0 < known(0.001) < solutions)


def by_threads(folder, kept):
    """Neither the start set nor a listing depends on the number of threads."""
    results = []
    for threads in (1, 3):
        place = os.path.join(folder, "threads%d" % threads)
        os.mkdir(place)
        with open(os.path.join(place, "case.nml"), "w", encoding="utf-8") as file:
            file.write(FUNCTION)
        done = subprocess.run([os.path.abspath(os.path.join(BIN, "psalm")), "--threads", str(threads), "case.nml"], capture_output=True,
                              text=True, cwd=place, check=False,
                              env=dict(os.environ, XDG_CACHE_HOME=os.path.join(place, "cache")))
        files = []
        for name in ("case.dev7", "case.dev9", os.path.join("cache", "psalm", os.path.basename(kept))):
            with open(os.path.join(place, name), "rb") as file:
                files.append(file.read())
        results.append([done.returncode, done.stdout, done.stderr.replace(place, "")] + files)
    check("three threads: the same listing, files and start set", results[0] == results[1] and results[0][0] == 0,
          [a == b for a, b in zip(*results)])


def main():
    with tempfile.TemporaryDirectory() as folder:
        # counts of an independent program: doc/guide/exact.md
        for name, text, real, sound in (("square", FUNCTION, 172, 10), ("sine", SINE, 170, 6)):
            status, listing, errors = psalm(name, text, folder)
            check(name + ": all ends", status == 0 and "complete: 1286 of 1286 ends distinct" in listing, listing + errors)
            check(name + ": real ones", "%d real; without a defect: %d driven at the input" % (real, sound) in listing, listing)
            meet(name, folder, [90.0*x*x if name == "square" else 90.0*math.sin(math.pi/2*x) for x in chebyshev(7)])
            if name == "square":
                check(name + ": certificate", "certified: of 172 real ones 172 exist, 172 apart from all others, 172 are real" in listing, listing)
        kept = os.path.join(folder, "cache", "psalm", "stephenson3-07-p-c.start")
        size = os.path.getsize(kept) if os.path.exists(kept) else 0
        check("the start set is kept", size > 1286*10*16, size)

        phis = [math.radians(d) for d in (0.0, 17.0, 31.0, 50.0, 64.0, 83.0, 100.0)]
        outputs, numbers = made(phis)
        p, c = numbers[0], numbers[4]
        status, listing, errors = psalm("made", table(phis, outputs, p, c), folder)
        check("made: all ends", status == 0 and "complete: 1286 of 1286" in listing, listing + errors)
        found = table_of(os.path.join(folder, "made.dev9"), "exact")
        away = min((max(abs(complex(row["number_%sx" % n], row["number_%sy" % n]) - own) for n, own in zip("pqrsc", numbers)) for row in found),
                   default=math.inf)
        check("made: the linkage that the points come from is listed", away < 1e-7, away)
        meet("made", folder, [math.degrees(v) for v in outputs])

        # other direction of both angles: the mirror image of every linkage
        status, listing, errors = psalm("mirrored", table([-v for v in reversed(phis)], [-v for v in reversed(outputs)],
                                                         p.conjugate(), c.conjugate()), folder)
        other = table_of(os.path.join(folder, "mirrored.dev9"), "exact") if status == 0 else []
        check("both angles reversed: the same linkages mirrored", len(other) == len(found) and
              all(abs(a["longest"] - b["longest"]) < 1e-6 for a, b in zip(other, found)), listing + errors)
        check("a table has no error between its entries", "ERROR" not in listing and "error" not in found[0], listing)
        by_threads(folder, kept)
        left_out(folder)
        least_errors(folder)
        cut_short(folder, kept)
        status, listing, _ = psalm("cut", WATT.replace("NBEST=100", "MAXTIME=0.5"), folder)
        check("stopped early", status == 1 and "not complete: stopped after MAXTIME while the start set was made" in listing, listing)
        if EVERYTHING:
            status, listing, errors = psalm("watt", WATT, folder)
            check("watt: all ends", status == 0 and "complete: 26370 of 26370 ends distinct" in listing, listing + errors)
            check("watt: real ones", "1590 real; without a defect: 23 driven at the input" in listing, listing)
            meet("watt", folder, [90.0*x*x for x in chebyshev(9)])
            best = table_of(os.path.join(folder, "watt.dev9"), "exact")[0]["error"]
            check("watt: least error", abs(best - 3.73e-5) < 1e-6, best)
            # two real ends 2.7e-6 apart; paths whose last part takes quadruple precision
            drawn = importlib.util.spec_from_file_location("drawn", os.path.join(TOP, "bench", "six_bars.py"))
            bench = importlib.util.module_from_spec(drawn)
            drawn.loader.exec_module(bench)
            for name, (inputs, outputs) in (("near", bench.drawn_points(36)), ("lost", bench.drawn_linkage(2)[:2])):
                angles = [",\n  ".join("%.17g" % math.degrees(v) for v in values) for values in (inputs, outputs)]
                _, listing, errors = psalm(name, "TABLE\n &EXACT KIND='FUNCTION', SIXBAR='WATT', PHI=%s,\n  PSI=%s,\n  TRMIN=0.0 &END\n" % tuple(angles),
                                           folder)
                check(name + ": all ends", "complete: 26370 of 26370 ends distinct" in listing, listing + errors)
            # counts of an independent program: 676 and 590 real ones
            for name, text, count, real, function in (
                    ("eight", EIGHT, 16908, 676, lambda x: 90.0*math.log10(1.0 + 49.0*x)/math.log10(50.0)),
                    ("second", SECOND, 7324, 590, lambda x: 90.0*x*x)):
                status, listing, errors = psalm(name, text, folder)
                check(name + ": all ends", status == 0 and "complete: %d of %d ends distinct" % (count, count) in listing, listing + errors)
                check(name + ": real ones", "%d real" % real in listing, listing)
                check(name + ": certificate", "certified: of %d real ones %d exist, %d apart from all others, %d are real"
                      % (real, real, real, real) in listing, listing)
                meet(name, folder, [function(x) for x in chebyshev(8)])
    return tally.report()


if __name__ == "__main__":
    sys.exit(main())
