#!/usr/bin/env python3
"""Loads of links for stress analysis (ILOADS of &MASSES): forces and moments on each link balance its inertia, which is found from
masses of the case and differences of the poses listed; they are the forces of joints, drives and frame that kalm lists otherwise.

usage: link_loads.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import csv
import glob
import math
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from namelist import read_namelist
from data_sets import data, without
from tally import check, report

BIN = os.path.abspath(sys.argv[1])
TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOLDER = tempfile.mkdtemp()
BALANCED = 1e-10    # what is left of the sum of forces, part of the largest
AGREED = 1e-11      # forces listed twice, part of the largest
DIFFERENCE = 1e-3   # accelerations by differences of poses a degree apart, part of the largest


def rows_of(name, block=""):
    with open(os.path.join(FOLDER, "%s.kalm%s.csv" % (name, block)), encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [{key.split(" (")[0]: value for key, value in row.items()} for row in rows]


def kalm(name, text):
    for path in glob.glob(os.path.join(FOLDER, name + ".*")):
        os.remove(path)
    with open(os.path.join(FOLDER, name + ".nml"), "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([os.path.join(BIN, "kalm"), "--json", name + ".nml"], cwd=FOLDER, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


def asked(text):
    return text.replace("&MASSES", "&MASSES ILOADS=1,", 1)


def dense(text):
    return re.sub(r"&METHOD\b.*?&END", "&METHOD IKIN=1 &END", text, flags=re.S)


def spread_of(rows, *columns):
    return max((abs(float(row[c])) for row in rows for c in columns if row[c]), default=0.0)


def equilibrium(name, loads, motion, metre):
    """Sum of forces and moments about the centre of mass against inertia; returns the inputs, in their order."""
    by = {}
    for row in loads:
        if row["fx"]:
            by.setdefault((row["position"], row["link"]), []).append([float(row[c]) for c in ("x", "y", "fx", "fy", "m")])
    force = spread_of(loads, "fx", "fy")
    reach = metre * spread_of(loads, "x", "y")
    moment = max(spread_of(loads, "m"), force * reach)
    worst = [0.0, 0.0]
    for row in motion:
        if not row["accel"]:
            continue
        mass, cx, cy, inertia, al, ax, ay = (float(row[c]) for c in ("mass", "centre_x", "centre_y", "inertia", "accel", "centre_ax", "centre_ay"))
        given = by.get((row["position"], row["link"]), [])
        rest = [sum(g[2] for g in given) - mass * ax, sum(g[3] for g in given) - mass * ay]
        turn = sum(metre * ((g[0] - cx) * g[3] - (g[1] - cy) * g[2]) + g[4] for g in given) - inertia * al
        scale = max(force, mass * math.hypot(ax, ay))
        worst = [max(worst[0], max(map(abs, rest)) / scale), max(worst[1], abs(turn) / max(moment, abs(inertia * al)))]
    check(name + ": forces on each link balance its inertia", worst[0] < BALANCED, "%.1e" % worst[0])
    check(name + ": and their moments", worst[1] < BALANCED, "%.1e" % worst[1])
    return by


def turned(row, angle):
    c, s = math.cos(angle), math.sin(angle)
    fx, fy = float(row["fx"]), float(row["fy"])
    return c * fx - s * fy, s * fx + c * fy


def against_listing(name, loads, motion, positions, metre):
    """Pins, drives and frame as the columns of kalm have them."""
    pose = {(row["position"], row["link"]): row for row in motion}
    frame = {}
    for row in loads:
        if row["link"] == "frame" or row["link"] not in {link for _, link in pose}:
            frame.setdefault(row["position"], []).append(row)
    first = next(c for c in positions[0] if c.startswith(("input", "crank")))
    size = spread_of(positions, "frame_fx", "frame_fy") or 1.0
    turning = spread_of(positions, "frame_m") or 1.0
    compared = 0
    for place, row in zip(dict.fromkeys(r["position"] for r in loads), positions):
        if not row["frame_fx"]:
            continue
        on = frame.get(place, [])
        sums = [sum(float(r[c]) for r in on) for c in ("fx", "fy")]
        m = sum(metre * (float(r["x"]) * float(r["fy"]) - float(r["y"]) * float(r["fx"])) + float(r["m"]) for r in on)
        worst = max(abs(sums[0] - float(row["frame_fx"])), abs(sums[1] - float(row["frame_fy"]))) / size
        check(name + ": the frame bears what kalm lists", worst < AGREED * 10, "%s %.1e" % (row[first], worst))
        check(name + ": and its moment", abs(m - float(row["frame_m"])) < 1e-9 * turning, "%s %r %s" % (row[first], m, row["frame_m"]))
        pins = [c[:-3] for c in row if c.endswith("_fx") and c != "frame_fx"]
        for pin in pins:
            listed = float(row[pin + "_fx"]), float(row[pin + "_fy"])
            here = [turned(r, math.radians(float(pose[place, r["link"]]["angle"])) if (place, r["link"]) in pose else 0.0)
                    for r in loads if r["position"] == place and r["kind"] == "joint" and (
                        r["at"] == pin or pin == r["at"] + "." + r["link"])]
            if not here:
                continue
            compared += 1
            check(name + ": pin as kalm lists it", any(math.hypot(f[0] - s * listed[0], f[1] - s * listed[1]) <= AGREED * 100 * max(size, math.hypot(*listed))
                                                      for f in here for s in (1, -1)), "%s %r %r" % (pin, listed, here))
    check(name + ": pins are compared", compared > 0)


def by_differences(name, motion, speed, metre):
    """Accelerations of centres of mass and of turning from the poses alone, the positions a degree apart at constant speed."""
    links = {}
    for row in motion:
        links.setdefault(row["link"], []).append(row)
    step = math.radians(1.0) / speed
    for link, rows in links.items():
        if any(not row["angle"] for row in rows):
            continue
        angles, places = [], []
        for row in rows:
            a = math.radians(float(row["angle"]))
            if angles:
                a += 2 * math.pi * round((angles[-1] - a) / (2 * math.pi))
            angles.append(a)
            c, s = math.cos(a), math.sin(a)
            cx, cy = float(row["centre_x"]), float(row["centre_y"])
            places.append((metre * (float(row["x"]) + c * cx - s * cy), metre * (float(row["y"]) + s * cx + c * cy)))
        size = [max(spread_of(rows, "centre_ax", "centre_ay"), 1e-30), max(spread_of(rows, "accel"), 1e-3 * speed**2)]
        worst = [0.0, 0.0]
        for k in range(2, len(rows) - 2):
            def second(values):
                return (-values[k - 2] + 16 * values[k - 1] - 30 * values[k] + 16 * values[k + 1] - values[k + 2]) / (12 * step**2)
            ax, ay = second([p[0] for p in places]), second([p[1] for p in places])
            c, s = math.cos(angles[k]), math.sin(angles[k])
            own = float(rows[k]["centre_ax"]), float(rows[k]["centre_ay"])
            worst[0] = max(worst[0], math.hypot(c * ax + s * ay - own[0], c * ay - s * ax - own[1]) / size[0])
            worst[1] = max(worst[1], abs(second(angles) - float(rows[k]["accel"])) / size[1])
        check("%s: acceleration of %s by differences" % (name, link), worst[0] < DIFFERENCE, "%.1e" % worst[0])
        check("%s: and of its turning" % name, worst[1] < DIFFERENCE, "%.1e" % worst[1])


def wheels(carrier, fixed, extra):
    """A crank with a wheel, a rod and a rocker, a load at the end of the rod."""
    return """WHEELS
 &CHAIN JNT='A','B','C','D','E', JX=0.0,60.0,75.0,130.0,150.0, JY=0.0,0.0,12.0,50.0,-10.0,
  LNAME='base','crank','wheel','rod','rocker', LNK='A E','A B','B C','C D','D E',
  GEARA='%s', GEARB='wheel', GCARR='%s', GTA=40.0, GTB=%s &END
 &DRIVES DRIVE='A', DBASE='base', DLINK='crank' &END
 &OUTPUTS OUTPUT='point D' &END
 &METHOD NDES=7, DELT=0.0,5.0,10.0,15.0,20.0,25.0,30.0 &END
 &RATES SPEED=5.0, ACCEL=2.0 &END
 &MASSES ILOADS=1, UNITL=0.001, GRAVY=-9.81, MNAME='crank','wheel B','rod','rocker', MASS=0.4,0.3,0.2,0.5, MDIST=20.0,3.0,30.0,25.0,
  MINERT=1E-4,2E-4,1E-4,3E-4 &END
 &LOADS LNAME='rocker D', LFX=7.0, LMOM=0.3 &END
""" % (fixed, carrier, extra)


CONCENTRIC = """WHEELS ON ONE PIN
 &CHAIN JNT='A','B','C','D','E', JX=0.0,30.0,-20.0,10.0,5.0, JY=0.0,10.0,25.0,80.0,-20.0,
  LNAME='base','crank','wheel','left','right', LNK='A E','A B','A C','B D','C D', GEARA='crank', GEARB='wheel', GCARR='base', GTA=20.0, GTB=-40.0 &END
 &DRIVES DRIVE='A', DBASE='base', DLINK='crank' &END
 &OUTPUTS OUTPUT='point D' &END
 &METHOD NDES=5, DELT=0.0,10.0,20.0,30.0,40.0 &END
"""


def heavy(text, metre, gravity=-9.81):
    """Each link of a sketch has a mass beside the middle of its joints."""
    chain = {item: [float(v) if isinstance(v, str) else v[1] for _, values in given for v in values]
             for item, given in read_namelist(text)[0][1]["CHAIN"].items()}
    at = dict(zip(chain["JNT"], zip(chain["JX"], chain["JY"])))
    names = chain.get("LNAME") or [str(k + 1) for k in range(len(chain["LNK"]))]
    size = max(math.hypot(a[0] - b[0], a[1] - b[1]) for a in at.values() for b in at.values())
    masses = " &MASSES ILOADS=1, UNITL=%r, GRAVY=%r, MNAME=%s, MASS=%s, MDIST=%s, MANG=%s, MINERT=%s &END\n" % (
        metre, gravity, ",".join("'%s'" % name for name in names[1:]), ",".join(repr(1.0 + 0.3 * k) for k in range(len(names) - 1)),
        ",".join([repr(0.1 * size)] * (len(names) - 1)), ",".join(repr(17.0 * k) for k in range(len(names) - 1)),
        ",".join([repr(0.01 * (size * metre)**2)] * (len(names) - 1)))
    text = re.sub(r" &METHOD", lambda found: masses + " &METHOD", text, count=1)
    return text if "&RATES" in text else text.replace(" &METHOD", " &RATES SPEED=3.0, ACCEL=1.0 &END\n &METHOD", 1)


# name -> case, metres in a unit of length
CASES = {
    "engine": lambda: (asked(without(data("engine"), "MOTOR")), 0.001),
    "spring_friction": lambda: (asked(data("spring_friction")), 0.001),
    "excavator": lambda: (asked(data("excavator_digging")), 1.0),
    "plates": lambda: (asked(data("cut_from_plate")), 0.001),
    "needle": lambda: (asked(data("needle_masses")), 0.001),
    "rod_driven": lambda: (asked(without(data("stephenson3_rod_driven"), "SWEEP", "TOLER")), 0.001),
    "planet": lambda: (wheels("crank", "base", "20.0"), 0.001),
    "ring": lambda: (wheels("crank", "base", "-20.0"), 0.001),
    "concentric": lambda: (heavy(CONCENTRIC, 0.001), 0.001),
    "jansen": lambda: (heavy(data("jansen"), 0.001), 0.001),
    "squeezer": lambda: (heavy(data("squeezer"), 1.0), 1.0),
    "scissors": lambda: (heavy(data("scissors_lift"), 1.0), 1.0),
    "landing_gear": lambda: (heavy(data("landing_gear"), 0.001), 0.001),
    "five_bar": lambda: (heavy(data("geared_five_bar"), 0.001), 0.001),
    "oldham": lambda: (data("dyad7_oldham_coupling").replace(
        " &LIMITS", " &MASSES ILOADS=1, NMASS=2, MLINK=-1,3, MLOOP=1,1, MASS=2.0,3.0, MDIST=1.0,2.0, MANG=30.0,0.0, MINERT=0.5,0.7, UNITL=0.01, "
        "GRAVY=-9.81 &END\n &RATES SPEED=7.0 &END\n &LIMITS"), 0.01),
}


def main():
    for name, make in CASES.items():
        text, metre = make()
        status, said = kalm(name, text)
        check(name + ": runs", status == 0, said[-300:])
        if status > 1:
            continue
        loads, motion, positions = rows_of(name, ".link_loads"), rows_of(name, ".link_motion"), rows_of(name)
        equilibrium(name, loads, motion, metre)
        against_listing(name, loads, motion, positions, metre)
    for name, text, metre in (("dense_plates", dense(asked(data("cut_from_plate"))), 0.001), ("dense_squeezer", dense(heavy(data("squeezer"), 1.0)), 1.0)):
        text = re.sub(r"&RATES.*?&END", "&RATES SPEED=3.0 &END", text, flags=re.S)
        status, said = kalm(name, text)
        check(name + ": runs", status == 0, said[-300:])
        by_differences(name, rows_of(name, ".link_motion"), 3.0, metre)
    both_ways()
    places()
    faults()


def both_ways():
    """A four-bar by loops and as a sketch: the same forces act on its links."""
    steps = " &METHOD IKIN=10 &END\n &RATES SPEED=40.0 &END\n &MASSES ILOADS=1, %s, MASS=0.3, MDIST=0.07, MINERT=1E-4, GRAVY=-9.81 &END\n"
    loops = ("LOOPS\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=0.06,0.30,0.14,0.32, GAMA=3*0.0,180.0, NOUTLK=3, NOUTLP=1 "
             "&END\n" + steps % "MLINK=3, MLOOP=1")
    along = (0.26**2 + 0.30**2 - 0.14**2) / 0.52
    sketch = ("SKETCH\n &CHAIN JNT='A','B','C','D', JX=0.0,0.06,%r,0.32, JY=0.0,0.0,%r,0.0, LNAME='frame','crank','coupler','rocker', "
              "LNK='A D','A B','B C','C D' &END\n &DRIVES DRIVE='A' &END\n &OUTPUTS OUTPUT='angle C D' &END\n"
              % (0.06 + along, -math.sqrt(0.30**2 - along**2)) + steps % "MNAME='rocker D'")
    forces = []
    for name, text in (("by_loops", loops), ("by_sketch", sketch)):
        status, said = kalm(name, text)
        check(name + ": runs", status == 0, said[-300:])
        found = {}
        for row in rows_of(name, ".link_loads"):
            found.setdefault(int(row["position"]), []).append(math.hypot(float(row["fx"]), float(row["fy"])))
        forces.append([sorted(found[k]) for k in sorted(found)])
    worst = max(abs(a - b) for one, other in zip(*forces) for a, b in zip(one, other))
    check("loops and sketch: the same forces", len(forces[0]) == len(forces[1]) == 36 and worst < 1e-10, str(worst))


def places():
    """Axes, points and words of a case that can be followed by hand."""
    text = asked(data("cut_from_plate"))
    kalm("plates", text)
    loads = [row for row in rows_of("plates", ".link_loads") if row["position"] == "1"]
    at = {"A": (0.0, 0.0), "B": (20.0, 38.0), "C": (95.0, 70.0), "D": (110.0, 0.0)}
    links = {"crank": "AB", "coupler": "BC", "rocker": "CD"}
    for row in loads:
        if row["kind"] != "joint" or row["link"] == "base":
            continue
        a, b = (at[name] for name in links[row["link"]])
        along = math.hypot(b[0] - a[0], b[1] - a[1])
        u = (b[0] - a[0]) / along, (b[1] - a[1]) / along
        x, y = at[row["at"]][0] - a[0], at[row["at"]][1] - a[1]
        wanted = u[0] * x + u[1] * y, u[0] * y - u[1] * x
        check("axes lead from the first joint to the second", math.hypot(float(row["x"]) - wanted[0], float(row["y"]) - wanted[1]) < 1e-9, str(row))
    check("each kind is there", {row["kind"] for row in loads} == {"joint", "drive", "weight"}, str({row["kind"] for row in loads}))
    with open(os.path.join(FOLDER, "plates.kalm.dev8"), encoding="utf-8") as file:
        said = file.read()
    check("device 8 lists them", said.count("WHAT ACTS ON THE LINKS") == 1 and said.count("coupler           ANGLE") == 7, said[-200:])
    status, said = kalm("plain", data("cut_from_plate"))
    check("without ILOADS there are no such tables", not os.path.exists(os.path.join(FOLDER, "plain.kalm.link_loads.csv")))


def faults():
    text = data("cut_from_plate")
    status, said = kalm("bad", text.replace("&MASSES", "&MASSES ILOADS=2,"))
    check("2 is no flag", status == 2 and "ILOADS" in said, said)
    status, said = kalm("timed", asked(data("time/sprung_four_bar")))
    check("a motion in time has none", status < 2 and "&MASSES ILOADS: has no effect on a motion in time" in said, said)
    status, said = kalm("open", asked(without(data("engine"), "MOTOR")).replace("ARCL=40.0,140.0", "ARCL=40.0,35.0"))
    rows = rows_of("open", ".link_loads")
    check("where it does not close nothing is listed", status == 1 and any(row["fx"] == "" for row in rows) and any(row["fx"] for row in rows), said)


if __name__ == "__main__":
    main()
    sys.exit(report())
