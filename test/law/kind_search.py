#!/usr/bin/env python3
"""Searches among kinds of linkages (&KINDS).

usage: test/law/kind_search.py PROGRAM_DIRECTORY

A path that a four-bar makes, computed here, must be found by four-bars; results are the same for any number of threads, device 7 has
them as cases that the other programs take, and mistakes are told. Last line: N passed, N failed.
"""
import cmath
import html.parser
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
FOLDER = tempfile.mkdtemp(prefix="psalm-kind-search-")


def coupler_points(count):
    """Of a crank-rocker: crank 1, coupler 3.2, rocker 2.6, frame 3.4, point at 2 and 35 degrees on the coupler."""
    points = []
    for k in range(count):
        b = cmath.rect(1.0, 2*math.pi*k/count)
        gap = 3.4 - b
        cosine = (3.2**2 + abs(gap)**2 - 2.6**2)/(2*3.2*abs(gap))
        direction = cmath.phase(gap) + math.acos(cosine)
        points.append(b + cmath.rect(2.0, direction + math.radians(35)))
    return points


def run(name, kinds, more="", curve=None, options=(), program="psalm", what="PATH"):
    with open(os.path.join(FOLDER, name + "_target.csv"), "w") as out:
        out.write(curve if curve is not None else "".join("%r,%r\n" % (p.real, p.imag) for p in coupler_points(16)))
    path = os.path.join(FOLDER, name + ".nml")
    with open(path, "w") as out:
        out.write("wanted\n &CURVE FILE='%s_target.csv', WHAT='%s' &END\n &KINDS %s &END\n %s\n" % (name, what, kinds, more))
    done = subprocess.run([os.path.join(BIN, program), *options, path], capture_output=True, text=True, timeout=600)
    return done.returncode, done.stdout, done.stderr, os.path.join(FOLDER, name)


def choice(listing):
    """Rows of the choice: RMS error, name."""
    part = listing.split(" CHOICE (DEVICE 7 HAS THEM ALL)")[1].split(" * NONE OF THEM")[0]
    rows = []
    for line in part.split("\n"):
        if re.match(r" +\d+ ", line):
            rows.append((float(line.split()[1].replace("D", "E")), line))
    return rows


code, listing, said, stem = run("four", "LINKS=4, SLIDES=1, NKINDS=2, PATNCE=1", "&LIMITS TANGLE=90 &END")
check("a search among kinds ends with status 0", code == 0, said)
rows = choice(listing)
check("the four-bar comes first", "four-bar" in rows[0][1] and "slide" not in rows[0][1], rows)
check("it makes the path", rows[0][0] < 1e-3, rows)
check("the rows are in order", all(p[0] <= q[0]*(1 + 1e-9) for p, q in zip(rows, rows[1:])), rows)
check("it turns, proven", "TURNS      YES" in rows[0][1], rows)
check("it says how it ended", re.search(r"the search ended because (its last rounds|a linkage does)", said) is not None, said)
check("it says what more time would bring", "as much time again" in said, said)
check("each result is a case", re.findall(r"^wanted: .*$", open(stem + ".dev7").read(), re.M) != [], stem)
again = os.path.join(FOLDER, "again.nml")
os.replace(stem + ".dev7", again)
for program in ("psalm", "kalm", "balm"):
    done = subprocess.run([os.path.join(BIN, program), again], capture_output=True, text=True, timeout=300)
    check("%s takes device 7" % program, done.returncode in (0, 1) and "error" not in done.stderr, done.stderr)
done = subprocess.run([os.path.join(BIN, "balm"), "--sheet", again], capture_output=True, text=True, timeout=300)
with open(os.path.join(FOLDER, "again.sheet.html")) as page:
    sheet = page.read()
check("the contact sheet shows both", sheet.count("<figure>") == 2 and sheet.count("<img src=") == 2, sheet[:1000])
check("its pictures are there", all(os.path.exists(os.path.join(FOLDER, name)) for name in re.findall(r'<img src="([^"]*)"', sheet)), sheet[:1000])
check("a click leads to the case", all('id="case-%d"' % k in sheet and 'href="#case-%d"' % k in sheet for k in (1, 2)) and
      sheet.count("&amp;CHAIN") == 2, sheet[:1000])
html.parser.HTMLParser().feed(sheet)
code, listing_of_kinds, said, stem = run("atlas", "LINKS=4,6, SLIDES=1", options=["--kinds"])
count = int(re.search(r"KINDS OF LINKAGES: (\d+)", listing_of_kinds).group(1))
os.replace(stem + ".dev7", stem + "2.nml")
done = subprocess.run([os.path.join(BIN, "psalm"), "--quiet", stem + "2.nml"], capture_output=True, text=True, timeout=300)
check("every kind as a sketch is a linkage", count > 20 and done.returncode in (0, 1) and "error" not in done.stderr.replace("TOTAL ERROR", ""),
      done.stderr[:2000])
def devices(stem):
    return [open(stem + end).read() for end in (".dev1", ".dev7", ".dev9")]


first = None
for threads in ("1", "2", "3"):
    code, other, said, stem = run("slides", "LINKS=4,6, SLIDES=1, NKINDS=3, PATNCE=1, ONLY='four-bar','Watt I with a slide, 1'",
                                  "&LIMITS TANGLE=90 &END\n &SEARCH NSTART=4 &END", options=["--threads", threads])
    first = first or (other, devices(stem))
    check("the same for %s threads" % threads, (other, devices(stem)) == first, said)

# starts of an ordinary search are the best of lots: none may hang on those that its thread made before
LOT = """SLIDER-CRANK THAT DRIVES A DYAD
 &LINKS NLOOP=2, MAXARC=5, ILINK=1,-2,3,4,0,1,-2,3,4,-4,
  ILOOP=1,0,-4,1,0,1,1,0,0,1,
  ARCL=0.781,2.43,0.0,0.434,0.0,0.781,1.32,1.54,1.44,2.02,
  GAMA=0.0,0.0,0.0,270.0,0.0,0.0,34.5,0.0,0.0,121.0,
  NOUTLK=-3, NOUTLP=2, OUTLK=1.22, OUTANG=305.0 &END
 &METHOD IFREE=1, ORIGLK=4.6, ORIGNG=32.1, NDES=25,
  DELT=0.0,14.4,28.8,43.2,57.6,72.0,86.4,100.8,115.2,129.6,144.0,158.4,172.8,187.2,201.6,216.0,230.4,244.8,259.2,273.6,
   288.0,302.4,316.8,331.2,345.6,
  DESX=7.03,6.95,6.77,6.4,5.91,5.43,4.93,4.67,4.38,4.04,3.76,3.76,3.76,3.76,3.76,3.76,3.76,3.8,4.07,4.53,5.07,5.05,5.89,
   6.41,6.92,
  DESY=5.99,5.45,5.03,4.6,4.03,3.56,2.94,2.6,2.2,1.67,1.22,1.97,2.78,3.56,4.34,4.91,5.47,5.98,6.4,6.75,6.85,6.84,6.83,6.8,
   6.58,
  IVA=1,1,0,1,0,0,1,1,1,1, ILKOUT=1, IORIG=1,
  IVG=0,0,0,1,0,0,1,0,0,1, INGOUT=1, VAR=0.0 &END
 &LIMITS TANGLE=90.0, LIMVAL=1, STEPIN=1.0E-9,
  OPLOW=7*0.07,2*0.0,5*-720.0,
  OPHIGH=7*30.0,30.0,37.0,5*720.0 &END
 &SEARCH SOLVER='LSQ', NSTART=6, NBEST=2, ORDER=2 &END
 &CONSTR IRANGE=2 &END
"""
first = None
for threads in ("1", "2", "3"):
    stem = os.path.join(FOLDER, "lot")
    with open(stem + ".nml", "w") as out:
        out.write(LOT)
    done = subprocess.run([os.path.join(BIN, "psalm"), "--threads", threads, stem + ".nml"], capture_output=True, text=True, timeout=300)
    first = first or (done.stdout, devices(stem))
    check("lots with a slide are the same for %s threads" % threads, done.returncode in (0, 1) and (done.stdout, devices(stem)) == first, done.stderr)
code, listing, said, stem = run("named", "LINKS=4,6, ONLY='Stephenson III', PATNCE=1, NKINDS=1", "&LIMITS TANGLE=90 &END\n &SEARCH NSTART=2, MAXEVAL=1 &END")
check("only what is named", "SEARCH AMONG 1 KINDS" in listing and "STEPHENSON III" in listing.upper(), said)
check("all starts made", "every kind had its starts" in said, said)

# eight links
code, listing, said, stem = run("eight", "LINKS=8, ONLY='chain 8-5, 3', PATNCE=1, NKINDS=1", "&LIMITS TANGLE=90 &END\n &SEARCH NSTART=2 &END")
check("an eight-link finds its way", code in (0, 1) and "SEARCH AMONG 1 KINDS" in listing and choice(listing)[0][0] < 0.2, (said, listing[:1500]))# a closed curve with deep corners, the letter K of bench/curves: linkages that turn are compared with it as a whole
letter = [complex(*p) for p in ((0, 0), (0, 10), (1.5, 6), (6, 10), (3, 5), (6, 0), (1.5, 4))]
ring = []
for k in range(len(letter)):
    a, b, c, d = (letter[(k + j) % len(letter)] for j in (-1, 0, 1, 2))
    ring += [b + t*((c - a)/2 + t*(a - 2.5*b + 2*c - d/2 + t*((d - a)/2 + 1.5*(b - c)))) for t in (j/40 for j in range(40))]
first = None
for threads in ("1", "2"):
    code, listing, said, stem = run("letter", "LINKS=8, ONLY='chain 8-2, 7', NKINDS=1", "&LIMITS TANGLE=90 &END\n &SEARCH NSTART=4 &END",
                                    curve="".join("%r,%r\n" % (p.real, p.imag) for p in ring[::7]), options=["--threads", threads])
    first = first or (listing, devices(stem))
    check("a letter: the same for %s threads" % threads, (listing, devices(stem)) == first, said)
check("a letter is traced", code == 0 and choice(listing)[0][0] < 0.4, (said, listing[:1500]))

# a cylinder: open paths alone, the stroke as long as the path is wide
arc = "".join("%r,%r\n" % (1.5*math.cos(0.2*k), 1.2*math.sin(0.2*k)) for k in range(8))
code, listing, said, stem = run("stroke", "LINKS=6, DRIVEN='CYLINDER', PATNCE=1, NKINDS=1", "&LIMITS TANGLE=85 &END\n &SEARCH NSTART=4 &END", curve=arc)
check("a cylinder makes an open path", code in (0, 1) and choice(listing)[0][0] < 0.1, (said, listing[:1500]))
case = open(stem + ".dev7").read()
with open(stem + "_again.nml", "w") as out:
    out.write(case)
done = subprocess.run([os.path.join(BIN, "psalm"), stem + "_again.nml"], capture_output=True, text=True, timeout=300)
check("its drive stretches a link, and device 7 is read again", re.search("DRIVE='[A-Z] [A-Z]'", case) and done.returncode in (0, 1) and "error" not in done.stderr,
      done.stderr)
code, listing, said, stem = run("closed", "LINKS=6, DRIVEN='CYLINDER'")
check("a cylinder makes no closed path", code == 2 and "a cylinder takes the point back" in said, said)
code, listing, said, stem = run("cylinders", "LINKS=6, SLIDES=1, DRIVEN='CYLINDER'", curve=arc, options=["--kinds"])
kinds = re.findall(r"^ +\d+ +6 .* (\d.*) P ON", listing, re.M)
check("cylinder and rod have a pin each", len(kinds) > 1 and not any(re.search(r"\b[23]=|=[23]\b", k.replace("2*=3", "")) for k in kinds), kinds)

# gears: the path of a five-bar whose second crank turns back twice as fast, by wheels and dyads of its own
def meeting(p, r, q, s, side):
    line = q - p
    along = (abs(line)**2 + r*r - s*s)/(2*abs(line))
    return p + line/abs(line)*complex(along, side*math.sqrt(max(r*r - along*along, 0.0)))


def side_of(p, joint, q):
    return 1.0 if ((q - p).conjugate()*(joint - p)).imag > 0 else -1.0


def five_bar(joints, at, ratio, turn):
    """The output point of a sketch whose wheels are crank and rocker on the frame; joints by name: pivots 'A', 'B', on the crank 'C', the
    meeting 'D', on the wheel 'E', the output 'P' on `at`, 'CD' or 'DE'."""
    a, b, c, d, e, p = (joints[k] for k in "ABCDEP")
    c_now = a + (c - a)*cmath.exp(1j*math.radians(turn))
    e_now = b + (e - b)*cmath.exp(1j*math.radians(ratio*turn))
    d_now = meeting(c_now, abs(d - c), e_now, abs(d - e), side_of(c, d, e))
    start, now = (c, c_now) if at == "CD" else (e, e_now)
    return now + (p - start)*(d_now - now)/(d - start)


GIVEN = dict(A=0j, B=3+0.5j, C=0.6+0.5j, D=1.9+2.9j, E=3.4+1.1j, P=0.5+3.1j)
points = [five_bar(GIVEN, "CD", -2.0, 15*k) for k in range(24)]
curve = "".join("%r,%r\n" % (z.real, z.imag) for z in points)
wide = max(abs(z - w) for z in points for w in points)
code, listing, said, stem = run("geared", "LINKS=5, GEARS=1,1, ONLY='geared five-bar, 1', PATNCE=2, NKINDS=1", "&LIMITS TANGLE=90 &END\n &SEARCH NSTART=150 &END",
                                curve=curve)
check("a geared five-bar is found again", code in (0, 1) and choice(listing)[0][0] < 0.01*wide and ", gears " in listing, (said, listing[:1500]))
case = open(stem + ".dev7").read()
numbers = lambda item: [float(x) for x in re.search(r"\b%s=([^A-Z']*?)(?:,?\s*(?:[A-Z]\w*=|&END))" % item, case.replace("E+", "e+").replace("E-", "e-"), re.S)
                        .group(1).replace("\n", "").rstrip(", ").split(",")]
names = re.findall(r"'(\w+)'", re.search(r"JNT=(.*?)\n  JX", case, re.S).group(1))
drawn = dict(zip(names, (complex(x, y) for x, y in zip(numbers("JX"), numbers("JY")))))
links = dict(zip(re.findall(r"'(\w+)'", re.search(r"LNAME=(.*?)\n", case).group(1)),
                 (w.split() for w in re.findall(r"'([\w ]+)'", re.search(r"LNK=(.*?)\n", case).group(1)))))
wheel = re.search(r"GEARB='(\w+)'", case).group(1)
check("its wheels are the crank and a link on the frame", re.search(r"GEARA='crank'", case) and re.search(r"GCARR='frame'", case) and
      set(links[wheel]) & set(links["frame"]), case[:800])
ends = {"A": (set(links["frame"]) & set(links["crank"])).pop(), "B": (set(links["frame"]) & set(links[wheel])).pop()}
ends["C"] = (set(links["crank"]) - {ends["A"]}).pop()
ends["E"] = (set(links[wheel]) - {ends["B"]}).pop()
ends["D"] = (set(names) - set(ends.values()) - {"P"}).pop()
on = "CD" if any({ends["C"], "P"} <= set(link) for link in links.values()) else "DE"
found = {k: drawn[v] for k, v in ends.items()} | {"P": drawn["P"]}
ratio = -numbers("GTA")[0]/numbers("GTB")[0]
off = [abs(five_bar(found, on, ratio, turn) - z) for turn, z in zip(numbers("DELT"), points)]
rms = math.sqrt(sum(x*x for x in off)/len(off))
check("its error is that of the law of its wheels", math.isclose(rms, choice(listing)[0][0], rel_tol=1e-4, abs_tol=1e-7*wide), (rms, choice(listing)[0]))
code, listing, said, stem = run("atlas", "LINKS=4,5, GEARS=1, GROUPS=3", options=["--kinds"])
check("kinds with and without gears", "KINDS OF LINKAGES: 10" in listing and "2:5(1)" in listing, listing)
shutil.copy(stem + ".dev7", stem + "_drawn.nml")
done = subprocess.run([os.path.join(BIN, "balm"), "--animate", stem + "_drawn.nml"], capture_output=True, text=True, timeout=300, cwd=FOLDER)
svg = [open(os.path.join(FOLDER, f)).read() for f in sorted(os.listdir(FOLDER)) if f.startswith("atlas_drawn") and f.endswith(".move.svg")]
check("wheels are drawn", len(svg) == 10 and sum('<g class="wheel' in s for s in svg) == 9, (len(svg), done.stderr[-300:]))

# a function and poses, whose timing is prescribed
text = "".join("%d,%r\n" % (10*k, 60 + 20*math.sin(k/3)) for k in range(8))
code, listing, said, stem = run("function", "LINKS=4, OUTPUT='ANGLE', PATNCE=1, NKINDS=1", "&CONSTR IRANGE=1 &END\n &SEARCH NSTART=40 &END\n &LIMITS TANGLE=90 &END",
                                curve=text, what="FUNCTION")
check("a function: a four-bar within half a degree", code == 0 and choice(listing)[0][0] < 0.5, (said, listing[:2000]))
code, listing, said, stem = run("bare", "LINKS=4, OUTPUT='ANGLE'")
check("a function is not a path", code == 2 and "nothing is wanted" in said, said)

for kinds, more, words in (("LINKS=9", "", "kinds of 4, 6 and 8 links"), ("LINKS=5", "", "only a gear pair gives an odd number"),
                           ("LINKS=4, GEARS=1,1", "", "with a gear pair have 5 or 7 links"), ("GEARS=2", "", "a linkage has one gear pair"),
                           ("GEARS=1,0", "", "least number of gear pairs comes first"), ("LINKS=4, SLIDES=4", "", "from 0 to 3 pins"),
                           ("LINKS=4, SLIDES=2,1", "", "least number of slides comes first"),
                           ("LINKS=4, LENLOW=1", "", "both bounds"), ("LINKS=4, LENLOW=2, LENHGH=1", "", "must be above LENLOW"),
                           ("LINKS=4, WEIGH='ERROR'", "", "two words are weighed"), ("LINKS=4, WEIGH='ERROR','X'", "", "is expected; found 'X'"),
                           ("LINK=4", "", "did you mean LINKS"), ("LINKS=4, OUTPUT='WORD'", "", "is expected"),
                           ("LINKS=4", "&CHAIN JNT='A' &END", "leave one of both out"), ("LINKS=4", "&SEARCH SOLVER='SIMPLEX' &END", "needs another SOLVER")):
    code, listing, said, stem = run("wrong", kinds, more)
    check("says " + words, words in said and code == 2, said)
code, listing, said, stem = run("none", "LINKS=4, ONLY='no such kind'")
check("no kind", code == 1 and "no kind to search" in said, said)
code, listing, said, stem = run("kalm", "LINKS=4", program="kalm")
check("kalm sends to psalm", code == 2 and "device 7" in said, said)
sys.exit(report())
