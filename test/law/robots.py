#!/usr/bin/env python3
"""Models of the bodies that balm writes for other programs, driven there and compared with psalm and kalm.

MJCF: MuJoCo turns the crank once at the speed of the case; the loops stay closed, coupler points pass where psalm has them, the drive
takes the torque that kalm has. SDF: the joints of the file alone, closed by Newton's method, put the links where MuJoCo has them.
URDF: read by another reader, the tree with MuJoCo's coordinates does the same, and the joints for Gazebo meet.

usage: test/law/robots.py PROGRAM_DIRECTORY [CASE ...]. Last line: N passed, N failed"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from namelist import read_namelist
from data_sets import data, without
from tally import check, report

try:
    import mujoco
    import numpy as np
    import yourdfpy
except ImportError as missing:
    print("SKIPPED: models for other programs: %s is not installed" % missing.name)
    print("0 passed, 0 failed, 1 skipped")
    sys.exit()

try:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
except ImportError:         # of 400 MB, so it is not asked for
    MultibodyPlant = None
try:
    import pysdf
except ImportError:         # asks for numpy and lxml of 2022
    pysdf = None

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv[1])
CLOSURE = 1e-4      # gaps, and places of coupler points, as part of the size
TORQUE = 1e-2       # part of the largest
SAMPLES = 12        # positions at which SDF and URDF are compared


def with_masses(text, metre=1.0, gravity=-9.81):
    """A sketch whose links each have a mass beside the middle of their joints, and a moment of inertia."""
    chain = {item: [float(v) if isinstance(v, str) else v[1] for _, values in given for v in values]
             for item, given in read_namelist(text)[0][1]["CHAIN"].items()}
    at = dict(zip(chain["JNT"], zip(chain["JX"], chain["JY"])))
    names = chain.get("LNAME") or [str(k + 1) for k in range(len(chain["LNK"]))]
    links = [link.split() for link in chain["LNK"]]
    size = max(math.hypot(a[0] - b[0], a[1] - b[1]) for a in at.values() for b in at.values())
    rows = []
    for k, (name, joints) in enumerate(zip(names, links)):
        if k == 0:
            continue
        x = sum(at[j][0] for j in joints) / len(joints) + 0.03 * size - at[joints[0]][0]
        y = sum(at[j][1] for j in joints) / len(joints) - 0.02 * size - at[joints[0]][1]
        rows.append((name, joints[0], 1.0 + 0.4 * k, math.hypot(x, y),
                     math.degrees(math.atan2(y, x)), (1.0 + 0.4 * k) * (0.1 * size * metre)**2))
    return text.replace(" &METHOD", " &MASSES UNITL=%r, GRAVY=%r, NMASS=%d, MNAME=%s, MASS=%s,\n  MDIST=%s,\n  MANG=%s,\n  MINERT=%s &END\n &METHOD" % (
        metre, gravity, len(rows), ",".join("'%s %s'" % row[:2] for row in rows),
        *(",".join(repr(row[i]) for row in rows) for i in (2, 3, 4, 5))), 1)


def dense(text):
    return re.sub(r"&METHOD\b.*?&END", "&METHOD IKIN=1 &END", text, flags=re.S)


def speed(text, value):
    return text.rstrip("\n") + "\n &RATES SPEED=%r &END\n" % value


# name -> case; the models of all of them turn fully but those in WAYS, whose drives go so far
CASES = {
    "hoecken": lambda: speed(dense(with_masses(data("hoecken"))), 6.0),
    "klann": lambda: speed(dense(with_masses(data("klann"), 0.001)), 8.0),
    "jansen": lambda: speed(dense(with_masses(data("jansen"), 0.001)), -5.0),
    "squeezer": lambda: speed(dense(with_masses(data("squeezer"))), 20.0),
    "watt_six_bar": lambda: speed(dense(with_masses(data("watt_six_bar"))), 2.0),
    "geared_five_bar": lambda: speed(re.sub(
        r" &LIMITS.*?&END\n", "", with_masses(data("geared_five_bar"), 0.001)).replace("NDES=7, DELT=-30.0,-20.0,-10.0,0.0,10.0,20.0,30.0", "NDES=7, DELT=0.0,5.0,10.0,15.0,20.0,25.0,30.0"), 3.0),
    "scissors_lift": lambda: speed(with_masses(data("scissors_lift")), 0.2),
    "sprung_four_bar": lambda: speed(dense(without(data("time/sprung_four_bar"), "TIME")), 4.0),
    "engine": lambda: without(data("engine"), "LOADS", "MOTOR").replace("IKIN=10", "IKIN=1"),
    "needle_masses": lambda: data("needle_masses").replace("IKIN=-5", "IKIN=-1"),
    "oldham_coupling": lambda: data("dyad7_oldham_coupling").replace("IKIN=15", "IKIN=1").replace(
        " &LIMITS", " &MASSES NMASS=2, MLINK=-1,3, MLOOP=1,1, MASS=2.0,3.0, MDIST=1.0,2.0, MANG=30.0,0.0, MINERT=0.5,0.7, UNITL=0.01, GRAVY=-9.81 &END\n"
        " &RATES SPEED=7.0 &END\n &LIMITS"),
    "excavator_digging": lambda: without(data("excavator_digging"), "LOADS"),
}
WAYS = {"scissors_lift": 0.2, "geared_five_bar": math.radians(30.0), "excavator_digging": 0.1}


def run(work, program, name, *options):
    done = subprocess.run([os.path.join(BIN, program), "--quiet", *options, name + ".nml"], cwd=work, capture_output=True, text=True)
    check("%s: %s runs" % (name, program), done.returncode == 0, done.stderr[-300:])
    return done.returncode == 0


def drive_through(model, way):
    """Strokes, forces of the first drive, places of the marked points and of all bodies, and the largest gap, step by step."""
    now = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, now, 0)
    mujoco.mj_forward(model, now)
    steps = int(math.ceil(way / abs(now.ctrl[0]) / model.opt.timestep))
    strokes, forces, points, poses, gap = [], [], [], [], 0.0
    every = max(1, steps // SAMPLES)
    for k in range(steps):
        mujoco.mj_step1(model, now)
        mujoco.mj_step2(model, now)
        strokes.append(now.actuator_length[0])
        forces.append(now.actuator_force[0])
        points.append(now.site_xpos.copy())
        if now.ne:
            gap = max(gap, np.abs(now.efc_pos[:now.ne]).max())
        if k % every == 0:
            mujoco.mj_kinematics(model, now)
            poses.append((now.qpos.copy(), now.xpos.copy(), now.xmat.copy()))
    return np.array(strokes), np.array(forces), np.array(points), poses, gap


def test_mjcf(name, work):
    """MuJoCo against psalm and kalm; returns what it did."""
    model = mujoco.MjModel.from_xml_path(os.path.join(work, name + ".mjcf.xml"))
    size = model.stat.extent / 2.0
    way = WAYS.get(name, 2.5 * math.pi)
    strokes, forces, points, poses, gap = drive_through(model, way)
    check(name + ": loops stay closed", gap < CLOSURE * size, "gap %.2e of the size" % (gap / size))
    if name == "excavator_digging":
        check(name + ": three drives", model.nu == 3)
        return model, poses
    with open(os.path.join(work, name + ".kalm.csv"), encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    slides = name == "scissors_lift"
    if slides:
        now = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, now, 0)
        mujoco.mj_forward(model, now)
        blocks = [now.geom_xpos[k] for k in range(model.ngeom) if model.geom_type[k] == mujoco.mjtGeom.mjGEOM_SPHERE and model.geom_rgba[k][1] != model.geom_rgba[k][0]]
        apart = [np.abs(now.xanchor - place).sum(axis=1).min() for place in blocks]
        check(name + ": blocks are drawn at their joints", len(blocks) == 4 and max(apart) < 1e-9 * size, str(apart))
    first = next(c for c in rows[0] if c.startswith("input"))
    inputs = np.array([float(row[first]) for row in rows]) - model.numeric("input").data[0]
    # the drive of a second crank that is geared to the first is that one's, through the gear
    torques = np.array([float(row[next(c for c in row if re.match("drive", c))]) + 0.5 * float(row.get("drive2") or 0.0) for row in rows])
    sense = 1.0 if strokes[-1] > 0.0 else -1.0
    if not slides:
        inputs = np.radians(inputs)
        if way > 2.0 * math.pi:     # the second quarter of a turn and the rest; the first is for the run to settle
            inputs = sense * np.mod(sense * inputs, 2.0 * math.pi)
            inputs = np.where(sense * inputs < 0.25 * math.pi, inputs + sense * 2.0 * math.pi, inputs)
    inside = (sense * inputs > 0.1 * way) & (sense * inputs < sense * strokes[-1])
    check(name + ": positions are compared", inside.sum() >= (3 if name in WAYS else 300), str(inside.sum()))
    order = np.argsort(strokes)
    found = np.interp(inputs[inside], strokes[order], forces[order])
    worst = np.abs(found - torques[inside]).max() / np.abs(torques).max()
    check(name + ": torque of the drive as kalm has it", worst < TORQUE, "%.2e of the largest" % worst)
    columns = [c for c in rows[0] if re.match(r"point_\w+\.x$|output\.x$", c)]
    for column in columns:
        marked = column[len("point_"):-2] if column.startswith("point_") else "output"
        site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, marked)
        if site < 0:
            continue
        metre = 0.001 if name in ("klann", "jansen", "needle_masses") else 1.0
        for axis, component in ((0, ".x"), (2, ".y")):
            path = np.interp(inputs[inside], strokes[order], points[order, site, axis])
            wanted = metre * np.array([float(row[column[:-2] + component]) for row in rows])[inside]
            worst = np.abs(path - wanted).max() / size
            check("%s: %s%s as psalm has it" % (name, marked, component), worst < CLOSURE, "%.2e of the size" % worst)
    return model, poses


def numbers(text):
    return [float(word) for word in text.split()]


def test_sdf(name, work, model, poses):
    """Joints of the file, closed by Newton's method for the coordinates of the drives, against the places of MuJoCo's bodies."""
    world = ElementTree.parse(os.path.join(work, name + ".sdf")).getroot().find("world")
    root = world.find("model")
    links = {link.get("name"): numbers(link.findtext("pose") or "0 0 0 0 0 0") for link in root.findall("link")}
    joints = [j for j in root.findall("joint") if j.get("type") != "fixed"]
    names = [e.get("name") for e in list(root.findall("link")) + list(root.findall("joint"))]
    check(name + ": SDF: names are unique", len(set(names)) == len(names))
    ends = {j.findtext(end) for j in joints for end in ("parent", "child")}
    check(name + ": SDF: all links have joints", ends == set(links), str(ends ^ set(links)))
    frame = next(iter(links))
    moving = [link for link in links if link != frame]
    check(name + ": SDF: masses are those of MJCF", all(
        abs(float(link.findtext("inertial/mass")) - model.body(link.get("name")).mass[0]) < 1e-12 * abs(model.body(link.get("name")).mass[0])
        for link in root.findall("link") if link.get("name") != frame))
    frame_body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, frame)
    driven = []
    for k in range(model.nu):
        if model.actuator_trntype[k] == mujoco.mjtTrn.mjTRN_JOINT:
            driven.append(mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, model.actuator_trnid[k, 0]))
    start = np.array([v for link in moving for v in (links[link][0], links[link][1], 0.0)])

    def pose(state, link):
        if link == frame:
            return 0.0, 0.0, 0.0
        i = 3 * moving.index(link)
        return state[i], state[i + 1], state[i + 2]

    def carried(state, link, x, y):
        """A place told where all links stand as in the file, on its link."""
        at = links[link]
        ox, oy, turn = pose(state, link)
        c, s = math.cos(turn), math.sin(turn)
        return ox + c * (x - at[0]) - s * (y - at[1]), oy + s * (x - at[0]) + c * (y - at[1])

    def co_ordinate(state, joint):
        one, other = joint.findtext("parent"), joint.findtext("child")
        x, y = numbers(joint.findtext("pose"))[:2]
        turn = pose(state, one)[2]
        if joint.get("type") == "revolute":
            return pose(state, other)[2] - turn
        along = numbers(joint.find("axis").findtext("xyz"))
        a, b = carried(state, one, x, y), carried(state, other, x, y)
        return (b[0] - a[0]) * (math.cos(turn) * along[0] - math.sin(turn) * along[1]) + \
            (b[1] - a[1]) * (math.sin(turn) * along[0] + math.cos(turn) * along[1])

    def gaps(state, wanted):
        rest = []
        for joint in joints:
            one, other = joint.findtext("parent"), joint.findtext("child")
            x, y = numbers(joint.findtext("pose"))[:2]
            a, b = carried(state, one, x, y), carried(state, other, x, y)
            if joint.get("type") == "revolute":
                rest += [b[0] - a[0], b[1] - a[1]]
            else:
                along = numbers(joint.find("axis").findtext("xyz"))
                turn = pose(state, one)[2]
                c, s = math.cos(turn), math.sin(turn)
                across = (-(s * along[0] + c * along[1]), c * along[0] - s * along[1])
                rest += [(b[0] - a[0]) * across[0] + (b[1] - a[1]) * across[1], pose(state, other)[2] - turn]
            mimic = joint.find("axis/mimic")
            if mimic is not None:
                leader = next(j for j in joints if j.get("name") == mimic.get("joint"))
                rest.append(co_ordinate(state, joint) - float(mimic.findtext("multiplier")) * co_ordinate(state, leader))
        for drive, value in wanted.items():
            rest.append(co_ordinate(state, next(j for j in joints if j.get("name") == drive)) - value)
        return np.array(rest)

    size = model.stat.extent / 2.0
    if not driven:
        return
    worst = 0.0
    for qpos, xpos, xmat in poses:
        wanted = {d: qpos[model.joint(d).qposadr[0]] for d in driven}
        state = start.copy()    # from where MuJoCo has them, pushed aside a little
        for i, link in enumerate(moving):
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, link)
            state[3 * i:3 * i + 3] = xpos[body][0], xpos[body][2], 0.0
            # the plane stands upright: turns are about -y of the world
            across = np.array(xmat[body]).reshape(3, 3) @ np.array([1.0, 0.0, 0.0])
            state[3 * i + 2] = math.atan2(across[2], across[0])
        # turns of many revolutions: as the coordinates of the joints have them
        for _ in range(3):
            for joint in joints:
                if joint.get("type") == "prismatic" or joint.find("axis/mimic") is not None or joint.get("name") in wanted:
                    one, other = joint.findtext("parent"), joint.findtext("child")
                    if other == frame:
                        continue
                    target = pose(state, one)[2] + (0.0 if joint.get("type") == "prismatic" else qpos[model.joint(joint.get("name")).qposadr[0]])
                    i = 3 * moving.index(other) + 2
                    state[i] += 2.0 * math.pi * round((target - state[i]) / (2.0 * math.pi))
        there = state.copy()
        state = state + 1e-3 * size * np.cos(np.arange(len(state)))
        for _ in range(12):
            rest = gaps(state, wanted)
            slope = np.empty((len(rest), len(state)))
            for i in range(len(state)):
                h = 1e-7 * max(size, 1e-3)
                moved = state.copy()
                moved[i] += h
                slope[:, i] = (gaps(moved, wanted) - rest) / h
            state = state - np.linalg.lstsq(slope, rest, rcond=None)[0]
        worst = max(worst, np.abs(gaps(state, wanted)).max() / size, np.abs((state - there).reshape(-1, 3)[:, :2]).max() / size)
    check(name + ": SDF: links where MuJoCo has them", worst < CLOSURE, "%.2e of the size" % worst)


def test_sdf_parsers(name, work, model):
    """The file as parsers of the package index have it: python-sdformat, and libsdformat in Drake where that is installed."""
    path = os.path.join(work, name + ".sdf")
    masses = {model.body(b).name: model.body(b).mass[0] for b in range(1, model.nbody)}
    joints = {joint.get("name"): (joint.get("type"), joint.findtext("parent"), joint.findtext("child"))
              for joint in ElementTree.parse(path).getroot().find("world/model").findall("joint")}
    frame = model.body(1).name
    if pysdf is not None:
        world = pysdf.SDF.from_file(path, remove_blank_text=True).worlds[0]
        read = {link.name: float(link.inertial.mass) for link in world.models[0].links if link.name != frame}
        check(name + ": SDF: links and masses as python-sdformat reads them", set(read) == set(masses) - {frame} and all(
            abs(read[link] - masses[link]) < 1e-12 * masses[link] for link in read), str(read))
        check(name + ": SDF: joints as python-sdformat reads them", joints == {
            joint.name: (joint.type, joint.parent, joint.child) for joint in world.models[0].joints})
    if MultibodyPlant is None:
        return
    plant = MultibodyPlant(0.0)
    made, = Parser(plant).AddModels(path)       # raises what libsdformat finds wrong
    read = {plant.get_body(b).name(): plant.get_body(b).default_mass() for b in plant.GetBodyIndices(made)}
    check(name + ": SDF: links and masses as libsdformat reads them", all(abs(read[link] - masses[link]) < 1e-12 * masses[link]
                                                                         for link in read if link != frame) and set(read) == set(masses) | {frame}, str(read))
    kinds = {"RevoluteJoint": "revolute", "PrismaticJoint": "prismatic", "WeldJoint": "fixed"}
    found = {plant.get_joint(j).name(): kinds[type(plant.get_joint(j)).__name__.split("_")[0]] for j in plant.GetJointIndices(made)}
    check(name + ": SDF: joints as libsdformat reads them", found == {name: kind for name, (kind, *_) in joints.items()}, str(found))


def test_urdf(name, work, model, poses):
    """The tree with MuJoCo's coordinates, and the joints that close its loops."""
    path = os.path.join(work, name + ".urdf")
    robot = yourdfpy.URDF.load(path, load_meshes=False, build_collision_scene_graph=False)
    check(name + ": URDF: valid", robot.validate())
    mimics = {j.name for j in robot.robot.joints if j.mimic is not None}
    closing = ElementTree.parse(path).getroot().findall("gazebo/joint")
    size = model.stat.extent / 2.0
    worst = gape = 0.0
    pins = {}
    for qpos, xpos, xmat in poses:
        robot.update_cfg({j: qpos[model.joint(j).qposadr[0]] for j in robot.actuated_joint_names})
        for link in robot.link_map:
            body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, link)
            if body < 0:
                continue
            there = robot.get_transform(link, "world")
            worst = max(worst, np.abs(there[:3, 3] - xpos[body]).max() / size, np.abs(there[:3, :3].ravel() - xmat[body]).max())
        for joint in closing:
            at = numbers(joint.findtext("pose"))[:3] + [1.0]
            one = robot.get_transform(joint.findtext("parent"), "world")
            place = one @ at
            rest = robot.get_transform(joint.findtext("child"), "world")
            if joint.get("type") == "revolute":
                # where the pin is on the second link, from the first position
                own = pins.setdefault(joint.get("name"), np.linalg.inv(rest) @ place)
                gape = max(gape, np.abs(rest @ own - place).max() / size)
    check(name + ": URDF: links where MuJoCo has them", worst < (1e-6 if not mimics else CLOSURE), "%.2e" % worst)
    check(name + ": URDF: joints for Gazebo meet", gape < CLOSURE, "%.2e of the size" % gape)


def test_polynomials(name, work, model, poses):
    """The coordinates of the tree by the series of the JSON file, against MuJoCo and against the loops, over the whole range."""
    path = os.path.join(work, name + ".urdf")
    if name == "excavator_digging":
        check(name + ": of several drives there are no series", not os.path.exists(path + ".json"))
        return
    with open(path + ".json", encoding="utf-8") as file:
        series = json.load(file)
    robot = yourdfpy.URDF.load(path, load_meshes=False, build_collision_scene_graph=False)
    drive, by = series["drive"], {one["joint"]: one for one in series["joints"]}
    check(name + ": URDF: each joint of the tree has a series", set(by) == {j.name for j in robot.robot.joints if j.type != "fixed"})
    size = model.stat.extent / 2.0
    worst = max(one["largest_error"] / (size if one["unit"] == "m" else 1.0) for one in by.values())
    check(name + ": errors are small", worst < 1e-4, "%.1e" % worst)

    def coordinates(stroke):
        turns = 0.0
        if drive["whole_turn"]:
            turns = math.floor((stroke - drive["low"]) / (2.0 * math.pi))
        t = (2.0 * (stroke - 2.0 * math.pi * turns) - drive["low"] - drive["high"]) / (drive["high"] - drive["low"])
        return {joint: np.polynomial.chebyshev.chebval(t, one["coefficients"]) + turns * one["advance"] for joint, one in by.items()}

    def pull(values):
        return sum(factor * values[joint] for joint, factor in drive["stroke"].items())

    for stroke in np.linspace(drive["low"], drive["high"], 7):
        check(name + ": the stroke is what it is by its joints", abs(pull(coordinates(stroke)) - stroke) < 1e-7 * max(1.0, abs(stroke)))
    zero = coordinates(0.0)
    check(name + ": all are 0 where the model stands", max(abs(v) for v in zero.values()) < 10.0 * max(worst * max(1.0, size), 1e-9))
    apart = 0.0
    for qpos, _, _ in poses:
        real = {joint: qpos[model.joint(joint).qposadr[0]] for joint in by}
        if not drive["low"] <= pull(real) <= drive["high"] and not drive["whole_turn"]:
            continue
        found = coordinates(pull(real))
        apart = max(apart, *(abs(found[joint] - real[joint]) / (size if by[joint]["unit"] == "m" else 1.0) for joint in by))
    check(name + ": coordinates by the series are MuJoCo's", apart < 10.0 * CLOSURE, "%.1e" % apart)
    # the loops close over the whole range: an independent check of every value
    closing = ElementTree.parse(path).getroot().findall("gazebo/joint")
    pins, gape = {}, 0.0
    mimics = {j.name for j in robot.robot.joints if j.mimic is not None}
    for stroke in [0.0, *np.linspace(drive["low"], drive["high"], 181)]:
        robot.update_cfg({joint: value for joint, value in coordinates(stroke).items() if joint not in mimics})
        for joint in closing:
            if joint.get("type") != "revolute":
                continue
            place = robot.get_transform(joint.findtext("parent"), "world") @ (numbers(joint.findtext("pose"))[:3] + [1.0])
            rest = robot.get_transform(joint.findtext("child"), "world")
            own = pins.setdefault(joint.get("name"), np.linalg.inv(rest) @ place)
            gape = max(gape, np.abs(rest @ own - place).max() / size)
    check(name + ": the series close the loops", gape < max(1e-6, 20.0 * worst), "%.1e of the size" % gape)
    limits = {j.name: j.limit for j in robot.robot.joints}
    if len(drive["stroke"]) == 1:
        (joint, factor), = drive["stroke"].items()
        wanted = sorted((drive["low"] / factor, drive["high"] / factor))
        if drive["whole_turn"]:
            check(name + ": a drive that turns has no limit", next(j for j in robot.robot.joints if j.name == joint).type == "continuous")
        else:
            check(name + ": limits of the drive", max(abs(limits[joint].lower - wanted[0]), abs(limits[joint].upper - wanted[1])) < 1e-12 * size)


def test_two_ways(name, work):
    """A sketch and the loops that psalm makes of it are one mechanism; so is the sketch with its outputs in another order."""
    text = data(name)
    outputs = re.search(r"OUTPUT='([^']*)'", text).group(1)
    crank = re.search(r"LNK='[^']*','(\w+) (\w+)", text)
    more = "'angle %s %s'" % crank.groups()
    cases = {"sketch": text, "first": text.replace("OUTPUT='%s'" % outputs, "OUTPUT='%s',%s" % (outputs, more)),
             "second": text.replace("OUTPUT='%s'" % outputs, "OUTPUT=%s,'%s'" % (more, outputs))}
    for case, own in cases.items():
        with open(os.path.join(work, case + ".nml"), "w", encoding="utf-8") as file:
            file.write(own)
    run(work, "psalm", "sketch", "--links")
    os.replace(os.path.join(work, "sketch.dev7"), os.path.join(work, "loops.nml"))
    found = {}
    for case in (*cases, "loops"):
        run(work, "balm", case, "--mjcf")
        with open(os.path.join(work, case + ".mjcf.xml"), encoding="utf-8") as file:
            found[case] = file.read().split("\n", 1)[1]
    check(name + ": outputs in another order: the same model", found["sketch"] == found["first"] == found["second"])
    one, other = (mujoco.MjModel.from_xml_string(found[case]) for case in ("sketch", "loops"))
    states = []
    for model in (one, other):
        now = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, now, 0)
        mujoco.mj_forward(model, now)
        order = np.lexsort((now.xipos[:, 0].round(9), model.body_mass.round(9)))
        joints = now.xanchor[np.lexsort(now.xanchor.round(9).T)]
        states.append((model.body_mass[order], model.body_inertia[order][:, 0], now.xipos[order], joints, now.actuator_velocity))
    same = all(a.shape == b.shape and np.abs(a - b).max() < 1e-9 * max(1.0, np.abs(a).max()) for a, b in zip(*states))
    check(name + ": by loops and by a sketch: the same bodies, joints and drive", same, str(states)[:600])


def test_limits(work):
    """A crank that does not turn fully: limits of the URDF file between its dead points, which follow from the lengths."""
    text = data("suspension").replace("CRNKI=-7.0", "CRNKI=10.0")      # not beside a dead point
    with open(os.path.join(work, "limited.nml"), "w", encoding="utf-8") as file:
        file.write(text)
    subprocess.run([os.path.join(BIN, "balm"), "--quiet", "--urdf", "limited.nml"], cwd=work, check=False)
    with open(os.path.join(work, "limited.urdf"), encoding="utf-8") as file:
        found = re.search(r'type="revolute">(?:(?!</joint>).)*<limit lower="([^"]*)" upper="([^"]*)"', file.read(), re.S)
    crank, coupler, rocker, base = (float(v) for v in re.search(r"ARCL=([\d.,]+)", text).group(1).strip(",").split(",")[:4])
    open_at = [math.degrees(math.acos((crank**2 + base**2 - reach**2) / (2.0 * crank * base)))
               for reach in (coupler + rocker, abs(coupler - rocker)) if abs(crank**2 + base**2 - reach**2) < 2.0 * crank * base]
    ends = sorted(sign * a for a in open_at for sign in (1, -1))
    width = math.degrees(float(found.group(2)) - float(found.group(1))) if found else 0.0
    check("limits lie between dead points, 2 % from each", any(abs(0.96 * (b - a) - width) < 1e-6 for a, b in zip(ends, ends[1:])), "%r %r" % (width, ends))


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)    # MuJoCo writes a log where it stands
    for case in sys.argv[2:] or CASES:
        with open(os.path.join(folder, case + ".nml"), "w", encoding="utf-8") as out:
            out.write(CASES[case]())
        if not run(folder, "balm", case, "--mjcf", "--sdf", "--urdf") or not run(folder, "kalm", case, "--json"):
            continue
        made, places = test_mjcf(case, folder)
        test_sdf(case, folder, made, places)
        test_sdf_parsers(case, folder, made)
        test_urdf(case, folder, made, places)
        test_polynomials(case, folder, made, places)
    for case in [] if sys.argv[2:] else ["hoecken", "watt_six_bar"]:
        test_two_ways(case, folder)
    if not sys.argv[2:]:
        test_limits(folder)
sys.exit(report())
