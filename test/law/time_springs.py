#!/usr/bin/env python3
"""Gas springs, cords and buffers, tables, square damping, loads over time, clutches and switched motors: closed forms, SciPy, laws.

usage: time_springs.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import csv
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


def block(spring, time, x0=0.1, mass=2.0, more="", gravity=""):
    """A block on the x axis, a spring between the frame at -1 and it."""
    return f"""BLOCK AND SPRING
 &CHAIN JNT='P','A', JX=-1.0,{x0!r}, JY=0.0,0.0, LNAME='frame','block', LNK='P','A',
  NSLIDE=1, SLNK='frame', SLNK2='block', SLX=0.0, SLY=0.0, SLANG=0.0 &END
 &DRIVES DRIVE='S1' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='block A', MASS={mass!r}, MDIST=0.0{gravity} &END
 &SPRING ANAME='frame P', BNAME='block A', {spring} &END
{more} &TIME {time} &END
"""


def springs():
    # a buffer: back with the speed it came with, half a period later; k = 800 N/m, free at 0
    w = math.sqrt(800/2)
    t, said = KALM.time(block("STIFF=800.0, SFREE=1.0, SSIDE=-1", f"VSTART=-2.0, TAT=0.02,{.05 + math.pi/w/2!r},{.1 + math.pi/w!r}"))
    near(t["A.x"][1], .06, 1e-13, "buffer: free before")
    near(t["A.x"][2], -2/w, 1e-12, "buffer: deepest a quarter of a period after it is met")
    near(t["A.x"][3], .1, 1e-12, "buffer: back where it began")
    near(t["A.vx"][3], 2.0, 1e-12, "buffer: speed turned round")
    check("buffer: energy in balance", np.max(np.abs(t["balance"])) < 1e-12)
    # a cord: nothing while it is slack
    t, _ = KALM.time(block("STIFF=800.0, SFREE=1.5, SSIDE=1", f"VSTART=2.0, TAT=0.2,{.2 + math.pi/w!r}"))
    near(t["A.x"][1], .5, 1e-13, "cord: slack until 0.2 s")
    near(t["A.vx"][2], -2.0, 1e-12, "cord: and back")
    # a buffer with damping never pulls; SciPy in three pieces
    c = 60.0
    t, _ = KALM.time(block(f"STIFF=800.0, SFREE=1.0, SDAMP={c}, SSIDE=-1", "VSTART=-2.0, TAT=0.3"))

    def gone(_, y):
        return -(800*y[0] + c*y[1])
    gone.terminal, gone.direction = True, -1
    hit = solve_ivp(lambda _, y: [y[1], -(800*y[0] + c*y[1])/2], (.05, .3), [0.0, -2.0], method="DOP853", rtol=1e-12, atol=1e-14,
                    events=gone, first_step=1e-5)
    y, v = hit.y[:, -1]
    near(t["A.x"][-1], y + v*(.3 - hit.t[-1]), 1e-9, "buffer with damping: place after it lets go")
    near(t["A.vx"][-1], v, 1e-9, "buffer with damping: speed then")
    check("buffer with damping: energy in balance", np.max(np.abs(t["balance"])) < 1e-10)
    # gas: exponents with and without a logarithm in the energy
    for power in (1.0, 1.25, 2.0):
        t, _ = KALM.time(block(f"SPRE=-300.0, SFREE=0.9, SGASP=0.5, SGAS={power}", "VSTART=-1.5, TEND=0.6, NTIME=6"))
        done = solve_ivp(lambda _, y, n=power: [y[1], 300*(.4/(1 + y[0] - .5))**n/2], (0, .6), [.1, -1.5], method="DOP853", rtol=1e-13,
                         atol=1e-14)
        near(t["A.x"][-1], done.y[0, -1], 1e-11, f"gas spring, exponent {power}: place")
        near(t["A.vx"][-1], done.y[1, -1], 1e-11, f"gas spring, exponent {power}: speed")
        check(f"gas spring, exponent {power}: energy in balance", np.max(np.abs(t["balance"])) < 1e-12*np.ptp(t["potential"]) + 1e-13)
    t, said = KALM.time(block("SPRE=-3.0, SFREE=0.9, SGASP=0.5, SGAS=0.5", "VSTART=-9.0, TEND=0.6, NTIME=6"), want=1)
    check(f"gas spring without room ends the motion: {said[-200:]}", "gas spring 1 has no room left" in said)
    # square damping: a block falls (page of the theory: 2 kg, 0.5 N s2/m2)
    text = block("SQUAD=0.5", "TAT=1.0", gravity=", GRAVY=-9.81").replace("SLANG=0.0", "SLANG=-90.0").replace(
        "JX=-1.0,0.1, JY=0.0,0.0", "JX=0.0,0.0, JY=1.0,0.0")
    t, _ = KALM.time(text)
    near(-t["A.vy"][-1], 5.74046389114108, 1e-12, "square damping: speed after 1 s")
    near(-t["A.y"][-1], 3.66240161004335, 1e-12, "square damping: way")
    check("square damping: energy in balance", abs(t["balance"][-1]) < 1e-12)
    # tables: a straight one is a spring; one with a knee against SciPy
    straight, _ = KALM.time(block("SLTAB=1, NSTAB=1, NSTABL=2, STABL=0.0,2.0, STABF=-200.0,200.0", "TAT=0.1,0.35"))
    plain, _ = KALM.time(block("STIFF=200.0, SFREE=1.0", "TAT=0.1,0.35"))
    near(straight["A.x"][-1], plain["A.x"][-1], 1e-13, "a straight table is a spring")
    t, _ = KALM.time(block("SLTAB=1, SFREE=1.0, NSTAB=1, NSTABL=3, STABL=0.9,1.0,1.1, STABF=-80.0,0.0,20.0", "TAT=0.4"))
    y, v, now = .1, 0.0, 0.0
    for _ in range(20):
        stiff = 200.0 if y > 0 or (y == 0 and v > 0) else 800.0

        def knee(_, z):
            return z[0]
        knee.terminal = True
        done = solve_ivp(lambda _, z, k=stiff: [z[1], -k*z[0]/2], (now, .4), [y, v], method="DOP853", rtol=1e-12, atol=1e-14,
                         events=knee, first_step=1e-5)
        y, v, now = done.y[0, -1], done.y[1, -1], done.t[-1]
        if done.status == 0:
            break
        y = math.copysign(1e-18, v)
    near(t["A.x"][-1], y, 1e-10, "a table with a knee: place")
    near(t["A.vx"][-1], v, 1e-9, "a table with a knee: speed")
    check("a table with a knee: energy in balance", abs(t["balance"][-1]) < 1e-13)


def at_positions():
    """The drive of a crank holds what the potential energy grows by: at positions, every kind of spring."""
    kinds = {"gas": "SPRE=-300.0, SFREE=0.5, SGASP=0.2, SGAS=1.3", "cord": "STIFF=500.0, SFREE=0.62, SSIDE=1",
             "table": "SLTAB=1, NSTAB=1, NSTABL=3, STABL=0.3,0.6,0.9, STABF=-50.0,10.0,90.0"}
    for name, spring in kinds.items():
        text = f"""FOUR-BAR WITH A SPRING
 &CHAIN JNT='A','B','C','D', JX=0.0,0.1,0.75,0.8, JY=0.0,0.25,0.5,0.0, LNAME='frame','crank','coupler','rocker',
  LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &METHOD NDES=3, DELT=-0.01,0.0,0.01 &END
 &RATES SPEED=1.0 &END
 &MASSES MNAME='crank A', MASS=0.0 &END
 &SPRING ANAME='frame A', BNAME='coupler C', {spring} &END
"""
        KALM.tables(text)
        with open(os.path.join(KALM.folder, "case.kalm.csv"), encoding="utf-8", newline="") as file:
            rows = [row for row in csv.reader(line for line in file if not line.startswith("#"))]
        torque = float(rows[2][rows[0].index("drive")])
        energies = []
        for sense in (-1.0, 1.0):
            moved, _ = KALM.time(text.replace("MASS=0.0", "MASS=1.0").replace("DELT=-0.01,0.0,0.01", "DELT=3*0.0").replace(
                "SPEED=1.0", f"SPEED={sense}") + f" &TIME FREE='none', TAT={math.radians(.01)!r} &END\n")
            energies.append(moved["potential"][-1])
        slope = (energies[1] - energies[0])/(2*math.radians(.01))
        near(torque, slope, 2e-6*max(1.0, abs(slope)), f"{name}: the drive's torque is the slope of the potential energy")


def grip_at_positions():
    """At positions, too, FGRIP is friction whatever the load is: the drive gives its power, from the rates of the joints' places."""
    grips = {"A": 1.0, "B": 2.0, "C": 3.0, "D": 0.5}
    KALM.tables(f"""FOUR-BAR WITH SEALS
 &CHAIN JNT='A','B','C','D', JX=0.0,0.1,0.75,0.8, JY=0.0,0.25,0.5,0.0, LNAME='frame','ab','bc','cd', LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &METHOD IKIN=30 &END
 &RATES SPEED=2.0 &END
 &FRICTN FNAME={",".join(f"'{name}'" for name in grips)}, FGRIP={",".join(map(str, grips.values()))} &END
""")
    with open(os.path.join(KALM.folder, "case.kalm.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    worst = 0.0
    for row in rows:
        at = {name: complex(float(row[name + ".x"]), float(row[name + ".y"])) for name in grips}
        speed = {name: complex(float(row[name + ".vx"]), float(row[name + ".vy"])) for name in grips}
        rates = [((speed[b] - speed[a])/(at[b] - at[a])).imag for a, b in ("AB", "BC", "CD")]
        power = sum(grip*abs(rate) for grip, rate in zip(grips.values(), (rates[0], rates[1] - rates[0], rates[2] - rates[1], rates[2])))
        worst = max(worst, abs(2.0*float(row["drive"]) - power)/power)
    check(f"grip at {len(rows)} positions: the drive's power is that of friction, {worst:.1e} off", len(rows) == 12 and worst < 1e-12)


def time_and_switches():
    # a force over time: momentum is its integral; kinks of the table are met
    table = " &LOADS LNAME='block A', LFX=10.0, LTABLE=1, LTIME=1, NTABLE=1, NTABIN=4, TABIN=0.1,0.2,0.4,0.5, TABVAL=0.0,1.0,1.0,0.0 &END\n"
    t, _ = KALM.time(block("STIFF=0.0, SFREE=1.0", "TAT=0.15,0.3,1.0", more=table))
    near(t["A.vx"][1], 10*.05*.5*.5/2, 1e-14, "a force over time: speed on its slope")
    near(t["A.vx"][-1], 10*.3/2, 1e-14, "a force over time: speed at the end is the impulse")
    near(t["work"][-1], .5*2*1.5**2, 1e-13, "a force over time: its work is the energy")
    # two discs: a clutch takes the second along with 10 N m from 0.5 s on
    discs = """CLUTCH BETWEEN TWO DISCS
 &CHAIN JNT='O','W','D', JX=0.0,0.1,0.0, JY=0.0,0.0,0.1, LNAME='frame','wheel','disc', LNK='O','O W','O D' &END
 &DRIVES DRIVE='O','O', DBASE='frame','frame', DLINK='wheel','disc', DELT2=0.0 &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='wheel O','disc O', MASS=1.0,1.0, MINERT=2.0,0.5 &END
"""
    clutch = " &FRICTN FNAME='O disc', FOTHER='wheel', FGRIP=10.0, FTON=0.5 &END\n"
    b, said = KALM.tables(discs + clutch + " &TIME VNAME='O.frame-wheel', VSTART=30.0, TAT=1.0,3.0 &END\n")
    t, events = b["time"], b["events"]
    check("clutch: on, sticks", list(events["event"]) == ["on", "stick"])
    near(events["time"][-1], 1.7, 1e-12, "clutch: when both turn together")
    near(t["lost"][-1], .5*2*.5/2.5*30**2, 1e-12*180, "clutch: energy lost")
    near(t["kinetic"][-1], .5*2.5*24**2, 1e-10, "clutch: energy left")
    # let go again at 2 s, the disc braked by 5 N m from 2.5 s on
    rows = " &FRICTN FNAME='O wheel','O disc', FOTHER='disc','', FGRIP=10.0,5.0, FTON=0.5,2.5, FTOFF=2.0,100.0 &END\n"
    b, _ = KALM.tables(discs + rows + " &TIME VNAME='O.frame-wheel', VSTART=30.0, TAT=2.2,4.0,6.0 &END\n")
    check(f"clutch and brake: events {list(b['events']['event'])}",
          list(b["events"]["event"]) == ["on", "stick", "off", "slip", "on", "stick"])
    near(b["events"]["time"][-1], 2.5 + .5*24/5, 1e-12, "clutch and brake: the disc stands")
    near(b["time"]["kinetic"][-1], .5*2*24**2, 1e-10, "clutch and brake: the wheel alone goes on")
    # a motor on the second drive, on from 0.2 to 0.7 s: 8 (1 - w/40) on 0.5 kg m2 and a flywheel of 0.3
    motor = " &MOTOR MNAME='O.frame-disc', MTORQ=8.0, MSPEED=40.0, FLYWHL=0.3, MTON=0.2, MTOFF=0.7 &END\n"
    b, _ = KALM.tables(discs + motor + " &TIME TAT=0.1,0.6,1.0 &END\n")
    t = b["time"]
    end = 40*(1 - math.exp(-8*.5/(40*.8)))
    near(t["kinetic"][-1], .5*.8*end**2, 1e-12*end**2, "a switched motor: energy at the end")
    near(t["kinetic"][1], 0.0, 1e-15, "a switched motor: nothing before it is on")
    near(t["kinetic"][2], .5*.8*(40*(1 - math.exp(-8*.4/(40*.8))))**2, 1e-10, "a switched motor: energy while it is on")
    check("a switched motor: on, off", list(b["events"]["event"]) == ["on", "off"] and list(b["events"]["stop"]) == ["motor", "motor"])
    check("a switched motor: energy in balance", np.max(np.abs(t["balance"])) < 1e-12*np.max(t["kinetic"]))
    # a motor's line on a flywheel comes within 1 per cent of its last speed after T ln(100/(1 + 99 exp(-end/T)))
    line = " &MOTOR MNAME='O.frame-disc', MTORQ=8.0, MSPEED=40.0, FLYWHL=0.3 &END\n"
    decay = .8*40/8
    _, said = KALM.tables(discs + line + " &TIME TEND=40.0, NTIME=4000 &END\n")
    v_end = 40*(1 - math.exp(-40/decay))
    want = math.ceil(100*decay*math.log(40/(40 - .99*v_end)))/100
    found = re.search(r"Steady speed +O.frame-disc ([\d.]+) rad/s, within 1 per cent from ([\d.]+) s", said)
    check(f"a motor's line: steady from {want} s: {said[-400:] if not found else found[0]}", bool(found) and float(found[2]) == want)
    # the data sets
    b, said = KALM.tables(data("clutch_press"))
    check("press with a clutch: the flywheel runs steadily, the crank stands", "Stands              O.frame-crank from 3" in said and
          "Steady speed        O.frame-flywheel 6.28 rad/s" in said)
    check("press with a clutch: events", list(b["events"]["event"]) == ["on", "stick", "off", "on", "slip", "stick"])
    t = b["time"]
    check("press with a clutch: energy in balance", np.max(np.abs(t["balance"])) < 1e-9*np.max(t["work"]))
    b, said = KALM.tables(data("hatch"))
    check("hatch: opens to its stop and rests there", list(b["events"]["event"]) == ["impact", "rest"])


def loops_and_sketch():
    """The same four-bar by loops and as a sketch: springs, friction, loads over time and a switched motor move it alike."""
    a, b, c, d, start, swing = .25, .7, .5, .8, 1.2, 3.0
    bx, by = a*math.cos(start), a*math.sin(start)
    far = math.hypot(d - bx, by)
    turn = math.atan2(-by, d - bx) + math.acos((b*b + far*far - c*c)/(2*b*far))
    cx, cy = bx + b*math.cos(turn), by + b*math.sin(turn)
    masses = "MASS=1.0,2.0,1.5, MDIST=.12,.35,.25, MINERT=.006,.08,.03, GRAVY=-9.81"
    sketch = f"""FOUR-BAR
 &CHAIN JNT='A','B','C','D', JX=0.0,{bx!r},{cx!r},{d}, JY=0.0,{by!r},{cy!r},0.0, LNAME='frame','ab','bc','cd', LNK='A D','A B','B C','C D' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='ab A','bc B','cd C', {masses} &END
"""
    loops = f"""FOUR-BAR
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1, ARCL={a},{b},{c},{d}, GAMA=3*0.0,180.0, NOUTLK=2, NOUTLP=1 &END
 &METHOD MOTION=0, NDES=1, DELT=0.0, CRNKI={math.degrees(start)!r} &END
 &MASSES MLINK=-1,-2,-3, MLOOP=3*1, {masses} &END
"""
    acts = {"a gas spring": (" &SPRING ANAME='frame A', BNAME='bc C', ", " &SPRING ALINK=4, ALOOP=1, BLINK=2, BLOOP=1, ",
                             "SPRE=-30.0, SFREE=0.6, SGASP=0.2, SGAS=1.3, SDAMP=2.0"),
            "a cord": (" &SPRING ANAME='frame A', BNAME='bc C', ", " &SPRING ALINK=4, ALOOP=1, BLINK=2, BLOOP=1, ",
                       "STIFF=300.0, SFREE=0.75, SSIDE=1, SQUAD=3.0"),
            "a table": (" &SPRING ANAME='frame A', BNAME='bc C', ", " &SPRING ALINK=4, ALOOP=1, BLINK=2, BLOOP=1, ",
                        "SLTAB=1, NSTAB=1, NSTABL=3, STABL=0.3,0.8,1.2, STABF=-10.0,5.0,30.0"),
            "friction that is switched": (" &FRICTN FNAME='A','B','C', ", " &FRICTN FLINK=-1,1,2, FLOOP=3*1, ",
                                          "FMU=0.0,0.2,0.3, FRAD=0.0,0.02,0.02, FGRIP=0.4,0.0,0.1, FTON=0.3,0.0,0.1, FTOFF=0.8,9.0,9.0"),
            "a load over time": (" &LOADS LNAME='bc C', ", " &LOADS LLINK=2, LLOOP=1, ",
                                 "LFX=10.0, LTABLE=1, LTIME=1, NTABLE=1, NTABIN=3, TABIN=0.1,0.2,0.6, TABVAL=0.0,1.0,-0.3"),
            "a switched motor": (" &MOTOR ", " &MOTOR ", "MTORQ=3.0, MSPEED=20.0, FLYWHL=0.02, MTON=0.1, MTOFF=0.5")}
    for name, (of_sketch, of_loops, items) in acts.items():
        found = []
        for text, group in ((sketch, of_sketch), (loops, of_loops)):
            t, said = KALM.time(text + group + items + f" &END\n &TIME TAT=0.25,0.5,1.0, VSTART={swing} &END\n")
            check(f"{name} by loops and as a sketch: {said[-200:] if t is None else ''}", t is not None and len(t["time"]) == 4)
            found.append(t)
        for column in ("input.v", "kinetic", "work", "lost"):
            scale = max(1.0, np.max(np.abs(found[0][column])))
            worst = np.max(np.abs(found[0][column] - found[1][column]))/scale
            check(f"{name}: {column} by loops and as a sketch, {worst:.1e} apart", worst < 1e-10)


def exchanged():
    """The same motion by the rocker, whose dead points it passes, and by the crank: whatever acts is carried over."""
    text = data("swing")
    text = text[:text.index(" &TIME")]
    acts = {"a gas spring": " &SPRING ANAME='frame A', BNAME='bc C', SPRE=-20.0, SFREE=0.5, SGASP=0.2, SGAS=1.3 &END\n",
            "a cord": " &SPRING ANAME='frame D', BNAME='ab B', STIFF=300.0, SFREE=0.8, SSIDE=1, SDAMP=2.0 &END\n",
            "a table": " &SPRING ANAME='frame A', BNAME='bc C', SLTAB=1, NSTAB=1, NSTABL=3, STABL=0.3,0.8,1.2, STABF=-10.0,5.0,30.0, "
                       "SQUAD=0.7 &END\n",
            "a load over time": " &LOADS LNAME='bc C', LFX=10.0, LFY=5.0, LTURN=1, LTABLE=1, LTIME=1, NTABLE=1, NTABIN=4, "
                                "TABIN=0.1,0.2,0.6,0.7, TABVAL=0.0,1.0,1.0,-0.3 &END\n",
            "friction that is switched": " &FRICTN FNAME='B','C','A', FMU=0.2,0.3,0.0, FRAD=0.02,0.02,0.0, FGRIP=0.0,0.1,0.5, "
                                         "FTON=0.0,0.15,0.3, FTOFF=9.0,9.0,0.8 &END\n",
            "a brake": " &FRICTN FNAME='A', FGRIP=8.0, FTON=0.4 &END\n"}
    for name, group in acts.items():
        found = []
        for drive in "DA":
            t, said = KALM.time(text.replace("DRIVE='D'", f"DRIVE='{drive}'") + group + " &TIME TEND=1.2, NTIME=24 &END\n")
            found.append(t)
            check(f"{name}: exchanged by the rocker alone", ("Coordinates" in said) == (drive == "D"))
        worst = max(np.max(np.abs(found[0][key] - found[1][key])) for key in ("B.x", "B.y", "C.x", "C.y"))
        check(f"{name}: the same motion by both drives, {worst:.1e} m off", worst < 1e-9)
        balance = max(np.max(np.abs(t["balance"])) for t in found)
        check(f"{name}: energy in balance to {balance:.1e} J", balance < 1e-10)


def mistakes():
    for words, spring in (("leave its STIFF out", "STIFF=1.0, SPRE=-1.0, SFREE=1.0, SGAS=1.2"), ("must be below SFREE", "SPRE=-1.0, SFREE=0.1, "
                          "SGASP=0.2, SGAS=1.2"), ("needs its force", "SFREE=1.0, SGAS=1.2"), ("is for a gas spring", "SGASP=0.1, SFREE=1.0"),
                          ("there are tables 1 to 0", "SLTAB=1"), ("must ascend", "SLTAB=1, STABL=1.0,1.0, STABF=0.0,1.0, NSTAB=1"),
                          ("is expected", "SSIDE=2")):
        _, said = KALM.tables(block(spring, "TEND=1.0"), want=2)
        check(f"{spring}: {said[:160]}", words in said)
    _, said = KALM.tables(block("STIFF=1.0", "TEND=1.0", more=" &MOTOR MTORQ=1.0, MNAME='X' &END\n"), want=2)
    check(f"a motor on no drive: {said[:160]}", "no drive 'X'" in said)
    text = block("STIFF=1.0", "TEND=1.0", more=" &FRICTN FNAME='S1', FGRIP=1.0, FTON=1.0 &END\n")
    _, said = KALM.tables(text[:text.index(" &TIME")], want=2)
    check(f"FTON without &TIME: {said[:160]}", "give &TIME" in said)
    _, said = KALM.tables(text.replace("FTON=1.0", "FTON=1.0, FTOFF=0.5"), want=2)
    check(f"FTOFF before FTON: {said[:160]}", "end after it begins" in said)
    _, said = KALM.tables(block("STIFF=1.0", "TEND=1.0", more=" &LOADS LNAME='block A', LFX=1.0, LTIME=1 &END\n").split(" &TIME")[0], want=2)
    check(f"LTIME without &TIME: {said[:160]}", "give &TIME" in said)


springs()
at_positions()
grip_at_positions()
time_and_switches()
loops_and_sketch()
exchanged()
mistakes()
sys.exit(report())
