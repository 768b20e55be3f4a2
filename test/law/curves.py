#!/usr/bin/env python3
"""Curves from files (&CURVE) against the same curves computed here.

usage: test/law/curves.py PROGRAM_DIRECTORY

A case whose linkage is given and does not vary is analysed; device 7 has the positions that were read. Points of CSV files come back to
the bit, those taken along a curve are compared with an integration of the arc length of its own, and bad files give their message.
Last line: N passed, N failed.
"""
import cmath
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from namelist import read_namelist
from tally import check, report

PSALM = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
LINKAGE = """ &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL=1.0,3.0,3.0,3.5, GAMA=3*0.0,180.0,
  NOUTLK=-2, NOUTLP=1, OUTLK=2.0, OUTANG=30.0 &END
"""
FOLDER = tempfile.mkdtemp(prefix="psalm-curves-")


def run(curve, method="", files=(), linkage=LINKAGE, where="case", json_text=None):
    """Exit status, messages, items of METHOD on device 7."""
    folder = os.path.join(FOLDER, where)
    os.makedirs(folder, exist_ok=True)
    for name, text in files:
        with open(os.path.join(folder, name), "w") as out:
            out.write(text)
    name = os.path.join(folder, "case.nml" if json_text is None else "case.json")
    with open(name, "w") as out:
        out.write(json_text or "a curve\n" + linkage + " &CURVE " + curve + " &END\n" + (" &METHOD %s &END\n" % method if method else ""))
    device = os.path.join(folder, "case.dev7")
    if os.path.exists(device):
        os.remove(device)
    done = subprocess.run([PSALM, name], capture_output=True, text=True, timeout=60)
    items = {}
    if os.path.exists(device):
        for title, groups in read_namelist(open(device).read())[:1]:
            for item, entries in groups["METHOD"].items():
                items[item] = [float(v) for v in entries[-1][1] if v is not None and not isinstance(v, tuple)]
    return done.returncode, done.stderr, items


def points_of(items):
    return [complex(x, y) for x, y in zip(items.get("DESX", []), items.get("DESY", []))]


def near(a, b, slack):
    return len(a) == len(b) and all(abs(p - q) <= slack for p, q in zip(a, b))


def along(curve, count, closed, fine=200000):
    """Points evenly by arc length on a curve of a parameter from 0 to 1, by small chords."""
    dense = [curve(k/fine) for k in range(fine + 1)]
    s = [0.0]
    for p, q in zip(dense, dense[1:]):
        s.append(s[-1] + abs(q - p))
    found, j = [], 0
    for k in range(count):
        want = s[-1]*k/(count if closed else count - 1)
        while s[j + 1] < want and j < fine - 1:
            j += 1
        part = (want - s[j])/(s[j + 1] - s[j])
        found.append(dense[j] + part*(dense[j + 1] - dense[j]))
    return found


def svg(data, attributes="", outside="", more=""):
    return '<?xml version="1.0"?>\n<!-- <path d="M0 0"/> -->\n<svg xmlns="http://www.w3.org/2000/svg"><g %s>%s<path id="p" d="%s" %s/></g></svg>\n' % (
        outside, more, data, attributes)


def csv():
    rows = [(0.1*k + 0.0317, math.sin(k)/3) for k in range(9)]
    text = "x,y\n" + "".join("%r,%r\n" % row for row in rows)
    code, said, items = run("FILE='w.csv', CLOSED=0", files=[("w.csv", text)])
    check("csv: exit status", code in (0, 1), said)
    check("csv: points to the bit", points_of(items) == [complex(*r) for r in rows], items)
    check("csv: NDES", items.get("NDES") == [9.0], items)
    check("csv: open, half a turn", near(items["DELT"], [180*k/8 for k in range(9)], 1e-12), items)
    german = "# gemessen\r\n" + "".join(("%.17g;%.17g\r\n" % row).replace(".", ",") for row in rows)
    check("csv: semicolons and decimal commas", points_of(run("FILE='w.csv', CLOSED=0", files=[("w.csv", german)])[2]) ==
          [complex(*r) for r in rows])
    blank = "! comment\n\n" + "".join("  %r \t %r\n" % row for row in rows)
    check("csv: blanks", points_of(run("FILE='w.csv', CLOSED=0", files=[("w.csv", blank)])[2]) == [complex(*r) for r in rows])
    full = "input,y,x,weight\n" + "".join("%r,%r,%r,%r\n" % (7.5*k, y, x, k + 0.5) for k, (x, y) in enumerate(rows))
    items = run("FILE='w.csv', UNITS=1000, CLOSED=0", files=[("w.csv", full)])[2]
    check("csv: input", items["DELT"] == [7.5*k for k in range(9)], items)
    check("csv: weights", items["XMULT"] == items["YMULT"] == [k + 0.5 for k in range(9)], items)
    check("csv: units", near(points_of(items), [1000*complex(*r) for r in rows], 1e-12))
    items = run("FILE='w.csv', CLOSED=0", files=[("w.csv", "x,y,vx,vy\n1,2,3,4\n2,3,4,5\n3,5,1,1\n")])[2]
    check("csv: velocities", items.get("DVELX") == [3.0, 4.0, 1.0] and items.get("DVELY") == [4.0, 5.0, 1.0], items)
    round_points = [cmath.rect(2, 2*math.pi*k/12) for k in range(12)]
    circle = "".join("%r,%r\n" % (p.real, p.imag) for p in round_points)
    items = run("FILE='w.csv'", files=[("w.csv", circle)])[2]
    check("csv: a ring closes by itself", near(items["DELT"], [30.0*k for k in range(12)], 1e-12), items)
    items = run("FILE='w.csv'", files=[("w.csv", circle + circle.split("\n")[0] + "\n")])[2]
    check("csv: the first point once more is left out", points_of(items) == round_points, items)
    items = run("FILE='w.csv', CLOSED=0, TURN=-90", files=[("w.csv", circle)])[2]
    check("csv: the way of the input", near(items["DELT"], [-90*k/11 for k in range(12)], 1e-12), items)
    items = run("FILE='w.csv', TOFRO=1, CLOSED=0", files=[("w.csv", "0,0\n1,0\n3,1\n4,1\n")])[2]
    check("csv: to and fro", points_of(items) == [0, 1, 3 + 1j, 4 + 1j, 3 + 1j, 1] and near(items["DELT"], [60.0*k for k in range(6)],
                                                                                           1e-12), items)
    items = run("FILE='w.csv'", method="DELT=0,10,20,45", files=[("w.csv", "0,0\n1,0\n3,1\n4,1\n")])[2]
    check("csv: inputs of METHOD", items["DELT"] == [0.0, 10.0, 20.0, 45.0], items)
    code, said, items = run("FILE='data/w.csv', CLOSED=0", files=[], where="case")
    os.makedirs(os.path.join(FOLDER, "case", "data"), exist_ok=True)
    code, said, items = run("FILE='data/w.csv', CLOSED=0", files=[("data/w.csv", "1,2\n3,4\n")])
    check("csv: counted from the directory of the case", points_of(items) == [1 + 2j, 3 + 4j], said)


def kinds():
    text = "input,value\n" + "".join("%r,%r\n" % (10*k, k*k/7) for k in range(6))
    linkage = LINKAGE.replace("NOUTLK=-2, NOUTLP=1, OUTLK=2.0, OUTANG=30.0", "NOUTLK=-3, NOUTLP=1")
    items = run("FILE='w.csv', WHAT='FUNCTION'", method="MOTION=1", files=[("w.csv", text)], linkage=linkage)[2]
    check("function", items.get("DESANG") == [k*k/7 for k in range(6)] and items["DELT"] == [10.0*k for k in range(6)], items)
    items = run("FILE='w.csv', WHAT='FUNCTION', NPTS=11", method="MOTION=1", files=[("w.csv", text)], linkage=linkage)[2]
    check("function: evenly by the input", near(items["DESANG"], [((k//2)**2 + ((k + 1)//2)**2)/14 for k in range(11)], 1e-12) and
          near(items["DELT"], [5.0*k for k in range(11)], 1e-12), items)
    poses = [(cmath.rect(3, 0.3*k), 0.9*k) for k in range(8)]
    text = "x1,y1,x2,y2\n" + "".join("%r,%r,%r,%r\n" % (p.real, p.imag, (p + cmath.rect(2, a)).real, (p + cmath.rect(2, a)).imag)
                                     for p, a in poses)
    code, said, items = run("FILE='w.csv', WHAT='POSES', CLOSED=0", method="MOTION=4", files=[("w.csv", text)])
    check("poses: points", near(points_of(items), [p for p, a in poses], 1e-12), said)
    check("poses: angles, turned on", near(items["DESANG"], [math.degrees(a) for p, a in poses], 1e-10), items)
    check("poses: a rigid body is not doubted", "apart" not in said, said)
    said = run("FILE='w.csv', WHAT='POSES', CLOSED=0", method="MOTION=4", files=[("w.csv", "0,0,1,0\n0,0,2,0\n1,1,3,1\n")])[1]
    check("poses: no rigid body", "from 1.0 to 2.0 apart" in said, said)


def sampling():
    ellipse = lambda t: complex(4*math.cos(2*math.pi*t), 1.5*math.sin(2*math.pi*t))
    text = "".join("%r,%r\n" % (p.real, p.imag) for p in (ellipse(k/5000) for k in range(5000)))
    points = points_of(run("FILE='w.csv', NPTS=37", files=[("w.csv", text)])[2])
    check("even: ellipse", near(points, along(ellipse, 37, True), 1e-5), points)
    square = [complex(x, y) for x, y in ((0.5, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
    text = "".join("%r,%r\n" % (p.real, p.imag) for p in square)
    points = points_of(run("FILE='w.csv', NPTS=11, CLOSED=1", files=[("w.csv", text)])[2])
    check("corners: all four are kept", all(any(abs(p - c) < 1e-12 for p in points) for c in square[1:]), points)
    gaps = [abs(p - q) for p, q in zip(points, points[1:] + points[:1])]
    check("corners: evenly between", len(points) == 11 and max(gaps) <= 0.5 + 1e-9 and min(gaps) >= 1/3 - 1e-9, gaps)
    points = points_of(run("FILE='w.csv', NPTS=10, CLOSED=1, CORNER=180", files=[("w.csv", text)])[2])
    check("corners: none wanted", not any(abs(p - (1 + 1j)) < 1e-9 for p in points) or len(points) == 10, points)
    shaky = [cmath.rect(5*(1 + 0.02*(-1)**k), 2*math.pi*k/200) for k in range(200)]
    text = "".join("%r,%r\n" % (p.real, p.imag) for p in shaky)
    points = points_of(run("FILE='w.csv', SMOOTH=1.0, CORNER=180", files=[("w.csv", text)])[2])
    spread = max(map(abs, points)) - min(map(abs, points))
    check("smooth: noise goes", len(points) == 200 and spread < 0.02 and abs(sum(map(abs, points))/200 - 5) < 0.05, spread)
    bent = [complex(k/20, 0) for k in range(21)] + [complex(1, k/20) for k in range(1, 21)]
    text = "".join("%r,%r\n" % (p.real, p.imag) for p in bent)
    points = points_of(run("FILE='w.csv', SMOOTH=0.3, CLOSED=0", files=[("w.csv", text)])[2])
    check("smooth: straight lines and their corner stay", near(points, bent, 1e-12), points)


def pictures():
    def taken(data, count=40, **more):
        code, said, items = run("FILE='w.svg', ID='p', NPTS=%d, CORNER=180" % count, files=[("w.svg", svg(data, **more))])
        return points_of(items), said
    cubic = lambda t: ((1 - t)**3*0 + 3*(1 - t)**2*t*(30 + 80j) + 3*(1 - t)*t*t*(90 - 40j) + t**3*(120 + 10j)).conjugate()
    points, said = taken("M0,0C30 80 90-40 120 10")
    check("svg: cubic", near(points, along(cubic, 40, False), 0.05), said)
    check("svg: relative cubic", near(taken("m0,0c30 80 90-40 120 10")[0], points, 1e-12))
    quadratic = lambda t: (2*(1 - t)*t*(50 + 90j) + t*t*(100 + 0j)).conjugate()
    check("svg: quadratic", near(taken("M0 0 Q50 90 100 0")[0], along(quadratic, 40, False), 0.05))
    both = lambda t: quadratic(2*t) if t < 0.5 else 100 + ((quadratic(2*t - 1)).conjugate()).conjugate().conjugate()
    check("svg: smooth quadratic", near(taken("M0 0 Q50 90 100 0 T200 0")[0], along(both, 40, False), 0.1))
    first = lambda t: 3*(1 - t)**2*t*(0 + 30j) + 3*(1 - t)*t*t*(20 + 30j) + t**3*20
    second = lambda t: (1 - t)**3*20 + 3*(1 - t)**2*t*(20 - 30j) + 3*(1 - t)*t*t*(50 - 10j) + t**3*60
    wave = lambda t: (first(2*t) if t < 0.5 else second(2*t - 1)).conjugate()
    check("svg: smooth cubic", near(taken("M0 0C0 30 20 30 20 0S50-10 60 0")[0], along(wave, 40, False), 0.05))
    check("svg: lines", near(taken("M1 2h3v4H0V2z", 4)[0][:1], [1 - 2j], 1e-12))
    for large in (0, 1):
        for sweep in (0, 1):
            points, said = taken("M10 0A30 15 25 %d%d 40 20" % (large, sweep))
            turned = [p.conjugate()*cmath.rect(1, -math.radians(25)) for p in points]
            # the centre is where all points have the same elliptic radius: solve for it from three of them, test the others
            u = [complex(p.real/30, p.imag/15) for p in turned]
            a, b, c = u[0], u[13], u[39]
            d = 2*((a.real - c.real)*(b.imag - c.imag) - (b.real - c.real)*(a.imag - c.imag))
            ea, eb = abs(a)**2 - abs(c)**2, abs(b)**2 - abs(c)**2
            centre = complex((ea*(b.imag - c.imag) - eb*(a.imag - c.imag))/d, (eb*(a.real - c.real) - ea*(b.real - c.real))/d)
            turn = sum(cmath.phase((q - centre)/(p - centre)) for p, q in zip(u, u[1:]))
            check("svg: arc %d%d on its ellipse" % (large, sweep), all(abs(abs(p - centre) - 1) < 2e-3 for p in u), said)
            check("svg: arc %d%d the right part of it" % (large, sweep), (abs(turn) > math.pi) == (large == 1) and
                  (turn > 0) == (sweep == 1) and abs(points[0] - 10) < 1e-9 and abs(points[-1] - (40 - 20j)) < 1e-9, turn)
    ring, said = taken("M10 0a10 10 0 1 1-20 0a10 10 0 1 1 20 0z")
    check("svg: a ring", len(ring) == 40 and all(abs(abs(p) - 10) < 5e-3 for p in ring), said)
    plain = taken("M0,0C30 80 90-40 120 10")[0]
    moved, said = taken("M0,0C30 80 90-40 120 10", attributes='transform="translate(5,7) rotate(30) scale(2)"',
                        outside='transform="matrix(1 0 0.5 1 0 0)" id="outer"')
    wanted = []
    for p in along(cubic, 4000, False, 8000):
        q = p.conjugate()*2*cmath.rect(1, math.radians(30)) + 5 + 7j
        wanted.append(complex(q.real + 0.5*q.imag, -q.imag))
    check("svg: transforms within transforms", len(moved) == 40 and all(min(abs(p - q) for q in wanted) < 0.2 for p in moved), said)
    check("svg: skew about itself", taken("M0 0L10 0", 2, attributes='transform="skewY(45)"')[0][1] == 10 - 10j)
    check("svg: rotation about a point", near(taken("M1 0L2 0", 2, attributes='transform="rotate(90 1 0)"')[0], [1, 1 - 1j], 1e-12))
    code, said, items = run("FILE='w.svg', NPTS=4", files=[("w.svg", '<svg><polygon points="0,0 2,0 2,2 0,2"/></svg>')])
    check("svg: polygon", near(points_of(items), [0, 2, 2 - 2j, -2j], 1e-12) and near(items["DELT"], [0, 90, 180, 270], 1e-12), said)
    check("svg: 40 points by default", len(points_of(run("FILE='w.svg'", files=[("w.svg", svg("M0 0L10 0"))])[2])) == 40)
    for data, words in (("", "has no points"), ("L1 1", "does not begin with M"), ("M0 0L1", "too few numbers"),
                        ("M0 0X1 1", "command 'X'"), ("M0 0", "fewer than two points"), ("M0 0L1 1M2 2L3 3", "2 separate lines"),
                        ("M0 0L1 1e999", "too few numbers, or what is no number")):
        said = run("FILE='w.svg', ID='p'", files=[("w.svg", svg(data))])[1]
        check("svg: says %s" % words, words in said and "w.svg" in said, said)
    for text, curve, words in (
            (svg("M0 0L1 1"), "ID='q'", "no path with the ID 'q'; there are p"),
            (svg("M0 0L1 1", more='<path id="r" d="M0 0L2 2"/>'), "", "there are 2 paths; say by ID which is wanted: r, p"),
            (svg("M0 0L1 1", more='<rect id="r"/>'), "ID='r'", "is no path but a rect"),
            (svg("M0 0L1 1", attributes='transform="twist(3)"'), "", "the transform 'twist(3)' is not understood"),
            ("<html></html>", "", "no SVG picture"), ("<svg></svg>", "", "no path in the picture"),
            ("<svg><g>" + "<g>"*300, "", "more than 200 elements"), ("<svg><path d=", "", "ends within an element"),
            (svg("M0 0L1 1"), "WHAT='POSES'", "function or poses are a CSV file")):
        code, said, items = run("FILE='w.svg', " + curve, files=[("w.svg", text)])
        check("svg: says " + words, words in said and code == 2, said)


def mistakes():
    for text, curve, words in (
            ("", "", "the file is empty"), ("\n \n", "", "the file is empty"), ("# only\n", "", "no point in the file"),
            ("1,2\n", "", "one point in the file"), ("x,y\n", "", "no point in the file"),
            ("1,2\n3,nan\n", "", "w.csv:2: error: a finite number is expected; found 'nan' in column 2"),
            ("1,2\n3,Inf\n", "", "a finite number is expected"), ("1,2\n3,abc\n", "", "found 'abc' in column 2"),
            ("1,2\n3\n", "", "w.csv:2: error: the line has 1 numbers; 2 columns"), ("1,2\n3,,4\n", "", "w.csv:2: error"),
            ("1\n2\n", "", "there is no column y"), ("x,z\n1,2\n", "", "column 2 is called 'z'"),
            ("x,x\n1,2\n", "", "two columns are called 'x'"), ("x,y,vx\n1,2,3\n2,3,4\n", "", "velocity has two columns"),
            ("1,2,3,4,5\n", "", "the line has 5 numbers"), ("1,1\n1,1\n1,1\n", "NPTS=3", "at one place"),
            ("0,0\n1,0\n1,1\n0,1\n", "NPTS=3, CLOSED=1", "3 points are too few: the curve has 4 corners"),
            ("0,0\n1,0\n1,1\n0,1\n", "NPTS=1", "two points at least"), ("0,0\n1,0\n1,1\n0,1\n", "TOFRO=1, CLOSED=1", "comes back"),
            ("0,0,0\n1,0,10\n1,1,5\n", "NPTS=5", "at point 3 it turns round"), ("0,0,0\n1,0,10\n", "TOFRO=1", "leave TOFRO or that"),
            ("0,0\n1,1\n", "NPTS=-1", "NPTS"), ("0,0\n1,1\n", "UNITS=0", "UNITS"), ("0,0\n1,1\n", "NPST=4", "did you mean NPTS"),
            ("0,0,1,1\n2,2,2,2\n", "WHAT='POSES'", "at pose 2 both points"), ("0,0\n1,1\n", "WHAT='CURVE'", "is expected"),
            ("0,0\n1,1\n", "ID='p'", "no SVG picture"), ("1,2\n2,3\n", "WHAT='FUNCTION', NPTS=5, TURN=9", "has no effect"),
            ("1,2\n2,3\n2,4\n", "WHAT='FUNCTION', NPTS=5", "turns round or stands"),
            ("1,2\n\x00", "", "zero byte")):
        code, said, items = run("FILE='w.csv', " + curve, files=[("w.csv", text)])
        check("says " + words, words in said, said)
        check("status of: " + words, code == (2 if "error" in said else code) and code != 0 or "has no effect" in words or
              "no SVG picture" in words, (code, said))
    code, said, items = run("FILE='none.csv'")
    check("a missing file", code == 3 and "none.csv" in said, said)
    code, said, items = run("FILE='.'")
    check("a directory", code == 3 and "it is a directory" in said, said)
    for name in ("case.csv", "case-2.csv"):
        code, said, items = run("FILE='%s'" % name, files=[(name, "1,2\n2,3\n")])
        check("a file that a table would replace", code == 2 and "call the file otherwise" in said, said)
    check("no file", "names the file" in run("NPTS=3")[1])
    check("huge", "more than 100000 points" in run("FILE='w.csv'", files=[("w.csv", "1,2\n"*100001)])[1])
    for item in ("NDES=2", "DESX=1,2", "DESY=1,2", "IKIN=10"):
        code, said, items = run("FILE='w.csv'", method=item, files=[("w.csv", "1,2\n2,3\n")])
        check("twice: " + item, code == 2 and "METHOD " + item.split("=")[0] in said and "leave" in said, said)
    code, said, items = run("FILE='w.csv'", method="DELT=0,3", files=[("w.csv", "1,2,0\n2,3,4\n")])
    check("twice: DELT", code == 2 and "leave DELT out" in said, said)
    said = run("FILE='w.csv', TURN=30", method="DELT=0,3", files=[("w.csv", "1,2\n2,3\n")])[1]
    check("twice: TURN", "leave one of both out" in said, said)


def other_ways():
    text = "1.5,2\n3,4.25\n"
    code, said, plain = run("FILE='w.csv', CLOSED=0", files=[("w.csv", text)])
    case = """{"title": "a curve", "LINKS": {"NLOOP": 1, "MAXARC": 4, "ILINK": [[1,-2,-3,4]], "ILOOP": [[1,0,0,1]],
      "ARCL": [[1.0,3.0,3.0,3.5]], "GAMA": [[0.0,0.0,0.0,180.0]], "NOUTLK": -2, "NOUTLP": 1, "OUTLK": 2.0, "OUTANG": 30.0},
      "CURVE": {"FILE": "w.csv", "CLOSED": 0}}"""
    code, said, items = run("", json_text=case)
    check("a case in JSON", items == plain and len(plain) > 3, said)
    # device 7 is a case by itself
    folder = os.path.join(FOLDER, "case")
    os.replace(os.path.join(folder, "case.dev7"), os.path.join(folder, "again.nml"))
    os.remove(os.path.join(folder, "w.csv"))
    done = subprocess.run([PSALM, os.path.join(folder, "again.nml")], capture_output=True, text=True)
    check("device 7 needs no file", done.returncode in (0, 1) and "error" not in done.stderr, done.stderr)
    marks = []
    for number in (1, 2):
        subprocess.run(["true"])
        run("FILE='w.csv', CLOSED=0", files=[("w.csv", text.replace("4.25", "4.%d" % number))])
        marks.append(open(os.path.join(folder, "case.dev7")).readline())
    check("the mark of the run takes the file in", marks[0] != marks[1], marks)


csv()
kinds()
sampling()
pictures()
mistakes()
other_ways()
sys.exit(report())
