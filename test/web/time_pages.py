#!/usr/bin/env python3
"""Pages of balm that play a motion in time: its states are those of kalm, its clock is true.

usage: test/web/time_pages.py PROGRAM_DIRECTORY. Last line: N passed, N failed.
"""
import glob
import json
import math
import os
import re
import shutil
import sys
import tempfile

from playwright.sync_api import sync_playwright

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "tools"))
import picture_tools
from curve_plots import plots_of
from page_in_browser import Page
from picture_tools import DATA, FLAGS, changed, check, page_data, read, run, write

NINE_DIGITS = 1e-8     # of the size: pages have nine digits
LOOPS = """OFFSET SLIDER-CRANK THAT A MOTOR STARTS
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1, ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, NDES=1, DELT=0.0 &END
 &MASSES MLINK=-1,-2,-3, MLOOP=3*1, MASS=.1,.2,.3, MDIST=10.0,20.0,30.0, MANG=10.0,20.0,30.0, MINERT=1E-4,2E-4,3E-4, UNITL=.001 &END
 &LOADS LLINK=-1, LLOOP=1, LMOM=-5.0 &END
 &MOTOR MTORQ=20.0, MSPEED=100.0 &END
 &TIME TEND=.1, NTIME=50 &END
"""


def both(name, codes=(0, 0)):
    """A case NAME.nml by kalm and by balm: blocks of tables, the case of the page."""
    for program, more, code in (("kalm", ["--json"], codes[0]), ("balm", ["--animate", "--curves", "--phase"], codes[1])):
        done = run(os.path.join(picture_tools.programs, program), *more, "--quiet", name + ".nml")
        check("%s %s ends with %d" % (program, name, code), done[0] == code, "%d %s" % (done[0], done[2]))
    with open(name + ".kalm.json", encoding="utf-8") as file:
        blocks = json.load(file)["cases"][0]["blocks"]
    return {block: table["columns"] for block, table in blocks.items()}, page_data(name + ".html")[0]


def frames_of(case, times):
    """The frame at each time; all of them are frames."""
    frames = [time/case["time"]*(case["sweep"]["n"] - 1) for time in times]
    check("times of the case are frames of its page", all(abs(frame - round(frame)) < 1e-9 for frame in frames))
    return [round(frame) for frame in frames]


def value(row, frame):
    return row[frame] if isinstance(row, list) else row


def line(case, name, label=""):
    """Values of a line of a panel."""
    return next(one["values"] for panel in case["panels"] if panel["name"] == name for one in panel["lines"] if one["label"] == label)


def near(law, found, wanted, scale):
    worst = max((abs(a - b) for a, b in zip(found, wanted)), default=1.0)
    check(law, len(found) == len(wanted) and worst <= NINE_DIGITS*scale, "%g of %g" % (worst, scale))


def drawn_to_the_end():
    """The uneven times of rough_slide are no frames."""
    return [path for path in sorted(glob.glob(os.path.join(DATA, "time", "*.nml"))) if not path.endswith("rough_slide.nml")]


def test_states():
    """Joints, inputs and energies at the times that kalm lists."""
    for path in drawn_to_the_end():
        name = os.path.basename(path)[:-len(".nml")]
        shutil.copy(path, ".")
        blocks, case = both(name)
        time, sweep = blocks["time"], case["sweep"]
        check(name + ": up to the end of its motion", case["time"] == time["time"][-1] and "0" not in sweep["closed"])
        check(name + ": over the time", case["inputLabel"] == "time, s" and case["sliding"])
        frames = frames_of(case, time["time"])
        size = max(case["view"][2] - case["view"][0], case["view"][3] - case["view"][1])
        for j, joint in enumerate(case["joints"]):
            if joint["name"] + ".x" not in time:
                continue
            for axis in "xy":
                near("%s: %s.%s" % (name, joint["name"], axis), [value(sweep[axis][j], frame) for frame in frames],
                     time["%s.%s" % (joint["name"], axis)], size)
        kinetic = line(case, "energy, J", "kinetic")
        near(name + ": kinetic energy", [kinetic[frame] for frame in frames], time["kinetic"], max(time["kinetic"]))
        for drive in case.get("drives", []):
            if "input." + drive["name"] not in time:
                continue
            column = time["input." + drive["name"]]
            near("%s: drive %s" % (name, drive["name"]), [drive["sweep"][frame] for frame in frames], column, max(map(abs, column)))
        for key in time:
            if key.startswith("stop."):
                stop = line(case, "stop %s, N m" % key[len("stop."):])
                near(name + ": force of a stop", [stop[frame] for frame in frames], time[key], max(map(abs, time[key])))


def test_phase():
    """Speeds over places are those that kalm lists; impacts are jumps between the speeds of its events."""
    for path in drawn_to_the_end():
        name = os.path.basename(path)[:-len(".nml")]
        with open(name + ".kalm.json", encoding="utf-8") as file:
            blocks = {block: table["columns"] for block, table in json.load(file)["cases"][0]["blocks"].items()}
        time, case = blocks["time"], page_data(name + ".html")[0]
        given = {"crane": ["A"]}.get(name, [])
        drives = [key[5:] for key in time if key.startswith("input") and key + ".v" in time and key[6:] not in given]
        plots = plots_of(name + ".phase.svg")
        check(name + ": a phase plane for each free drive", len(plots) == len(drives), (drives, len(plots)))
        hits = [k for k, kind in enumerate(blocks.get("events", {"event": []})["event"]) if kind == "impact"]
        for plot, drive in zip(plots, drives):
            places, speeds = time["input" + drive], time["input" + drive + ".v"]
            follow(name + ": phase plane of " + (drive[1:] or "the drive"), plot, places, speeds)
            check(name + ": start and end", near_point(plot, plot.line("start")[0], places[0], speeds[0]) and
                  near_point(plot, plot.line("end")[0], places[-1], speeds[-1]))
            strokes = [point for point in plot.line("motion") if point]
            check(name + ": as many points as states, and three for each impact but for a gap",
                  len(strokes) == case["sweep"]["n"] + 2*len(times_of(blocks, hits)), (len(strokes), case["sweep"]["n"]))
            if "equilibria" in blocks:
                rests, stable = blocks["equilibria"]["input" + drive], blocks["equilibria"]["stable"]
                for label, kind in (("equilibrium", 1), ("equilibrium, not stable", 0)):
                    marks = [place for place, is_so in zip(rests, stable) if is_so == kind]
                    drawn = [point for point in plot.line(label) if point] if marks else []
                    check(name + ": " + label, len(marks) == len(drawn) and
                          all(near_point(plot, point, place, 0.0) for point, place in zip(drawn, marks)), (marks, drawn))
        # a stop of the only free drive's own joint has that drive's rates
        if name in ("toggle", "door_closer", "garage_door"):
            jumps = [point for point in plots[0].line("impact") if point]
            events = blocks["events"]
            check(name + ": there are impacts", len(hits) > 0)
            check(name + ": their jumps", len(jumps) == 2*len(hits) and all(
                abs(jumps[2*i + side][1] - events[which][k]) <= 2*plots[0].error()
                for i, k in enumerate(hits) for side, which in enumerate(("before", "after"))), (jumps, hits))
            gaps = sum(point is None for point in plots[0].line("motion"))
            check(name + ": the line is broken there", gaps == len(hits), (gaps, len(hits)))
    write("still.nml", re.sub(r"&TIME .*?&END", "&TIME IEQUIL=1 &END", read("sprung_four_bar.nml")))
    done = picture_tools.balm("--phase", "still.nml")
    check("no motion: no phase plane, and says so", done[0] == 0 and "--phase draws motions in time" in done[2] and
          not os.path.exists("still.phase.svg"), done)


BARS = """TWO BARS THAT HANG
 &CHAIN JNT='A','B','C', JX=3*0.0, JY=0.0,-1.0,-2.0, LNAME='frame','upper','lower', LNK='A','A B','B C' &END
 &DRIVES DRIVE='A','B', DELT2=0.0 &END
 &OUTPUTS OUTPUT='point C' &END
 &METHOD NDES=1, DELT=0.0 &END
 &MASSES MNAME='upper A','lower B', MASS=1.0,1.0, MDIST=0.5,0.5, MINERT=0.08333333333333333,0.08333333333333333, GRAVY=-9.81 &END
 &TIME IEQUIL=1 &END
"""


def test_modes():
    """Equilibria are ghosts where kalm has them; the modes of the stable ones swing in its shapes, each in an SVG of its own."""
    write("bars.nml", BARS)
    for name, drives in (("bars", (".A", ".B")), ("sprung_four_bar", ("",))):
        blocks, _ = both(name)
        cases, rests, motions = page_data(name + ".html"), blocks["equilibria"], blocks["small_motion"]
        joints = [joint["name"] for joint in cases[0]["joints"]]
        check(name + ": a ghost for each equilibrium", len(cases[0]["ghosts"]) == len(rests["equilibrium"]) > 1 and
              [ghost["stable"] for ghost in cases[0]["ghosts"]] == [bool(stable) for stable in rests["stable"]])
        first = turn_of(cases[0]["sweep"], joints, 0) if name == "sprung_four_bar" else -90.0
        for k, ghost in enumerate(cases[0]["ghosts"]):
            away = turn_of(ghost, joints) - first - rests["input" + drives[0]][k]
            check("%s: ghost %d is where it rests" % (name, k + 1), abs((away + 180.0) % 360.0 - 180.0) < 1e-6, away)
        wanted = [i for i, k in enumerate(motions["equilibrium"]) if rests["stable"][k - 1] and not rests["stop"][k - 1]]
        check(name + ": a scene for each mode of the stable ones", len(cases) == 1 + len(wanted) > 1, len(cases))
        for case, i in zip(cases[1:], wanted):
            k, mode = motions["equilibrium"][i], motions["mode"][i]
            law = "%s: equilibrium %d, mode %d" % (name, k, mode)
            said = re.search(r"equilibrium %d, mode %d, ([\d.E+-]+) Hz, drawn with ([\d.]+) degrees of" % (k, mode), case["title"])
            check(law + ": its title", said and abs(float(said[1])/motions["frequency"][i] - 1.0) < 1e-3, case["title"])
            check(law + ": one oscillation", case["sweep"]["n"] == 360 and case["inputLabel"] == "phase, degrees" and "time" not in case)
            shape = [motions["shape.input" + drive][i] for drive in drives]
            swing = 0.15*180.0/math.pi
            check(law + ": the largest amplitude", said and abs(float(said[2]) - swing*max(map(abs, shape))) < 1e-2)
            for phase in (0, 37, 90, 270):
                for d, drive in enumerate(drives):
                    move = swing*shape[d]*math.sin(math.radians(phase))
                    if drive:
                        found = case["drives"][d]["sweep"][phase]
                    else:
                        found = turn_of(case["sweep"], joints, phase) - first
                    away = found - rests["input" + drive][k - 1] - move
                    check(law + ": drive %d at %d degrees" % (d + 1, phase), abs((away + 180.0) % 360.0 - 180.0) < 1e-6, away)
            svg = read("%s.mode-%d-%d.svg" % (name, k, mode))
            lists = re.findall(r' values="([^"]+)"', svg)
            check(law + ": the SVG moves and closes", lists and all(one.split(";")[0] == one.split(";")[-1] for one in lists) and
                  svg.count('class="equilibrium"') == len(rests["equilibrium"]))
    check("no mode about what is not stable", not os.path.exists("sprung_four_bar.mode-2-1.svg"))


def turn_of(row, joints, frame=None):
    """Angle of the line from A to B, degrees."""
    a, b = joints.index("A"), joints.index("B")
    at = [[value(row[axis][j], frame) if frame is not None else row[axis][j] for axis in "xy"] for j in (a, b)]
    return math.degrees(math.atan2(at[1][1] - at[0][1], at[1][0] - at[0][0]))


def times_of(blocks, hits):
    """Impacts at one time are one jump."""
    return {blocks["events"]["time"][k] for k in hits}


def near_point(plot, point, place, speed):
    wide = 0.02*(plot.last - plot.first)/plot.box[2]
    return abs(point[0] - place) <= wide and abs(point[1] - speed) <= 2*plot.error()


def follow(law, plot, places, speeds):
    """All states are points of the line, in this order."""
    points = iter(point for point in plot.line("motion") if point)
    check(law, all(any(near_point(plot, point, place, speed) for point in points) for place, speed in zip(places, speeds)))


def test_loops():
    """A linkage by its loops: output, drive, frame."""
    write("loops.nml", LOOPS)
    blocks, case = both("loops")
    time = blocks["time"]
    frames = frames_of(case, time["time"])
    near("loops: output", [case["sweep"]["actual"][frame] for frame in frames], time["output"], 100.0)
    forces = case["forces"]
    for key, column in (("drive", "drive"), ("fx", "frame_fx"), ("fy", "frame_fy"), ("moment", "frame_m")):
        near("loops: " + column, [forces[key][frame] for frame in frames], time[column], max(map(abs, time[column])))
    velocity, steps = line(case, "velocity of the output, length/s"), case["sweep"]["n"] - 1
    actual, step = case["sweep"]["actual"], case["time"]/steps
    worst = max(abs((actual[i + 1] - actual[i - 1])/(2.0*step) - velocity[i]) for i in range(1, steps))
    check("loops: the velocity is the slope of the output", worst < 2e-3*max(map(abs, velocity)), worst)


def test_early_end():
    """A motion that ends before its time is shown as far as it goes."""
    with open(os.path.join(DATA, "time", "toggle.nml"), encoding="utf-8") as file:
        write("toggle.nml", changed(file.read(), "&TIME", "&TIME NEVENT=1,"))
    blocks, case = both("toggle", (1, 1))
    last = blocks["time"]["time"][-1]
    check("ends early: as far as it goes", last - 0.001 < case["time"] < last + 0.001 and "0" not in case["sweep"]["closed"],
          case["time"])
    check("ends early: says so", any("ends at 0.055" in words and "more events" in words for words in case["breaches"]),
          case["breaches"])
    with open(os.path.join(DATA, "time", "pendulum.nml"), encoding="utf-8") as file:
        write("no_masses.nml", re.sub(r" &MASSES.*?&END\n", "", file.read(), flags=re.S))
    done = picture_tools.balm("no_masses.nml")
    check("without masses: refused as by kalm", done[0] == 2 and "motion in time needs masses" in done[2], done)
    with open(os.path.join(DATA, "time", "sprung_four_bar.nml"), encoding="utf-8") as file:
        write("rest.nml", re.sub(r"&TIME .*?&END", "&TIME IEQUIL=1 &END", file.read(), flags=re.S))
    picture_tools.balm("--quiet", "rest.nml")
    check("equilibria alone: the positions are drawn", "time" not in page_data("rest.html")[0])
    with open(os.path.join(DATA, "time", "sprung_four_bar.nml"), encoding="utf-8") as file:
        write("swing.nml", re.sub(r"&TIME .*?&END", "&TIME TEND=0.1, NTIME=5 &END", changed(file.read(), "'point C'", "'point C','angle rocker'"), flags=re.S))
    picture_tools.balm("--quiet", "swing.nml")
    check("an angle in time is drawn by the turn", [panel["scale"] for panel in page_data("swing.html")[0]["panels"]
                                                    if panel["name"] == "angle_rocker, degrees"] == [360])


def test_animation():
    """The SVG takes the time of the motion; its frames are states of it."""
    svg, case = read("trebuchet.move.svg"), page_data("trebuchet.html")[0]
    check("animation: true time", set(re.findall(r' dur="([^"]+)"', svg)) == {"1.6s"})
    lists = re.findall(r'translate".*? values="([^"]+)"', svg)
    lengths = {len(one.split(";")) for one in lists}
    check("animation: as many frames in every part", len(lengths) == 1 and lengths.pop() >= 48, lengths)
    check("animation: it does not go back", lists[-1].split(";")[0] != lists[-1].split(";")[-1])
    check("SVG: says which time it shows", "motion in time, drawn at 0 of 1.6 s" in read("trebuchet.svg") and
          "marked every 0.04 s" in read("trebuchet.svg"))
    curves = read("trebuchet.curves.svg")
    check("curves: over the time", "time, s" in curves and "energy, J" in curves and "speed of drive B, rad/s" in curves)
    check("stars at even times", case["prescribed"]["n"] == 41 and abs(case["prescribed"]["input"][1] - 0.04) < 1e-12)


def test_long_motion():
    """Too many turns for the states of a picture are told; the animation has the beginning."""
    write("long.nml", changed(LOOPS, "TEND=.1, NTIME=50", "TEND=60.0, NTIME=60"))
    code, _, said = picture_tools.balm("--animate", "long.nml")
    case = page_data("long.html")[0]
    check("long: a drive turns far between two states", code == 0 and case["sweep"]["n"] <= 3001 and
          "turns by up to" in said and any("turns by up to" in words for words in case["warnings"]), said)
    check("long: the animation has the first 20 s", set(re.findall(r' dur="([^"]+)"', read("long.move.svg"))) == {"20s"})


def test_browser():
    """At speed 1 a second is a second."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        for name in ("trebuchet", "press", "garage_door", "loops"):
            for width, scheme in ((390, "dark"), (1280, "light")):
                one = Page(browser, name + ".html", width=width, scheme=scheme)
                page, case = one.page, page_data(name + ".html")[0]
                last, seconds = case["sweep"]["n"] - 1, case["time"]
                check(name + ": loads without complaint", not one.complaints, one.complaints)
                check(name + ": begins at 0", one.ask("balm.position") == 0 and "time 0.0" in page.text_content("#facts"))
                check(name + ": a clock", page.text_content("#clock").endswith("%g" % seconds + " s") or
                      " of %g" % seconds in page.text_content("#clock"), page.text_content("#clock"))
                check(name + ": nothing is wider than the window", one.ask(
                    "document.documentElement.scrollWidth <= document.documentElement.clientWidth"))
                if width == 1280:
                    true_time(one, name, last, seconds)
                one.ask("balm.go(%d)" % last)
                for j, joint in enumerate(case["joints"]):
                    if joint["name"] and not joint["fixed"]:
                        drawn = one.ask("balm.joint(%d)" % j)
                        at = [value(case["sweep"][axis][j], last) for axis in "xy"]
                        check("%s: joint %s at the end" % (name, joint["name"]), max(abs(a - b) for a, b in zip(drawn, at)) <
                              1e-6*max(case["view"][2] - case["view"][0], 1.0), (drawn, at))
                one.context.close()
        browser.close()


def true_time(one, name, last, seconds):
    for speed in ("0.1", "1", "10"):
        one.page.select_option("#speed", speed)
        # between two frames of the browser, before the motion begins anew
        passed, gone = one.ask("""async () => {
            const frame = () => new Promise(requestAnimationFrame);
            let seen = null;
            balm.go(0);
            balm.play();
            await frame();
            let before = [await frame(), balm.position], now = before;
            while (now[0] - before[0] < 120) {
                now = [await frame(), balm.position];
                if (now[1] >= %d) break;
                if (now[1] < before[1]) before = now;
                seen = [now[0] - before[0], now[1] - before[1]];
            }
            balm.pause();
            return seen;
        }""" % last) or (0.0, 0.0)     # it came to its end within a frame
        want = float(speed)*passed/1000.0*last/seconds
        check("%s: in true time, at speed %s" % (name, speed), abs(gone - want) <= 1e-6*last + 0.02*want, (gone, want))


def main():
    picture_tools.programs = os.path.realpath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        test_states()
        test_phase()
        test_modes()
        test_loops()
        test_animation()
        test_long_motion()
        test_browser()
        test_early_end()
        os.chdir("/")
    print("%d passed, %d failed" % (picture_tools.passed, picture_tools.failed))
    return picture_tools.failed > 0


if __name__ == "__main__":
    sys.exit(main())
