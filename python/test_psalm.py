#!/usr/bin/env python3
"""The Python module as another program uses it.

usage: test_psalm.py DATA_DIRECTORY [WRONG_CALLS], with the module on the path. Last line: N passed, N failed, with
N skipped where packages are missing."""
import contextlib
import copy
import ctypes
import importlib
import io
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree

import numpy
import psalm

DATA = sys.argv[1]
SLIDER = """OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,
  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, IKIN=15 &END
"""
passed = failed = skipped = 0


def check(law, right):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: python: " + law)


def package(name):
    """A package that the module uses where it is there; None, and counted, where it is not."""
    global skipped
    try:
        return importlib.import_module(name)
    except ImportError:
        skipped += 1
        print("SKIPPED: results handed to " + name)
        return None


def raises(law, words, action, kind=None):
    try:
        action()
    except kind or psalm.Error as error:
        check("%s: '%s'" % (law, error), words in str(error))
    else:
        check(law + ": nothing was raised", False)


def slide(degrees):
    """Slide of the linkage of the README by the theorem of Pythagoras."""
    angle = numpy.radians(degrees)
    return 40*numpy.cos(angle) + numpy.sqrt(140**2 - (40*numpy.sin(angle) - 10)**2)


def test_analysis():
    result = psalm.Case.from_text(SLIDER).analyse(listing=True)
    check("shapes", result.input.shape == (24,) and result.actual.shape == (24, 1) and result.closed.dtype == bool)
    check("the slide is that of a right triangle", numpy.abs(result.actual[:, 0] - slide(result.input)).max() < 1e-12*180)
    check("closes, without findings", result.closed.all() and not result.violated and result.findings == [])
    check("the listing", "179.6424" in result.listing)
    textile = psalm.Case.from_file(os.path.join(DATA, "textile.nml")).analyse()
    check("a point has two components", textile.actual.shape == (12, 2))
    published = numpy.loadtxt(os.path.join(DATA, "reference", "textile-output.txt"), comments="#")
    check("columns have names and units", (result["output"] == result.actual[:, 0]).all() and result["input"].unit == "deg")
    check("the listing only if it is wanted", psalm.Case.from_text(SLIDER).analyse().listing == "")
    check("the published points of the textile linkage", numpy.allclose(textile.actual, published[:, 1:3], rtol=1e-11, atol=0))


def test_conditions():
    """ICOND=1 gives the condition number of every output of a sketch, as that of the program: it bounds the effect of a small change."""
    text = "\n".join(["FOUR-BAR", " &CHAIN JNT='A','B','C','D', JX=0.0,0.0,60.0,100.0, JY=0.0,30.0,80.0,0.0, LNK='A D','A B','B C','C D' &END",
                      " &DRIVES DRIVE='A' &END", " &OUTPUTS OUTPUT='angle C D','point C' &END", " &LIMITS ICOND=1 &END", " &METHOD IKIN=30 &END"])
    table = psalm.Case.from_text(text).study("analysis", listing=False).tables["positions"]
    check("outputs have condition numbers", "angle_C_D.condition" in table and "point_C.condition" in table)
    larger = psalm.Case.from_text(text.replace("100.0,", "100.0001,")).study("analysis", listing=False).tables["positions"]
    change = numpy.hypot(larger["point_C.x"] - table["point_C.x"], larger["point_C.y"] - table["point_C.y"])
    size = numpy.hypot(table["point_C.x"], table["point_C.y"])
    bound = table["point_C.condition"]*1e-6*size
    check("it bounds the effect of a small change", numpy.all(change <= 1.001*bound) and numpy.all(table["point_C.condition"] > 1.0))


def test_made():
    case = psalm.Case("MADE IN MEMORY")
    case.add_loop([1, -2, 3, 4], [1, 0, -4, 1], [40, 140, 0, 10], [0, 0, 0, 270.0])
    for group, item, values in (("METHOD", "MOTION", 3), ("METHOD", "NDES", 5), ("METHOD", "DELT", numpy.linspace(0, 2, 5)),
                                ("LINKS", "NOUTLK", 3), ("LINKS", "NOUTLP", 1), ("RATES", "UNITS", "RAD/S"), ("RATES", "SPEED", 2.0)):
        case.set(group, item, values)
    rates = case.rates()
    check("inputs", numpy.allclose(rates.input, [0, 0.5, 1, 1.5, 2]))
    check("velocity is speed times rate", numpy.allclose(rates.velocity, 2*rates.rate) and numpy.allclose(rates.jerk, 8*rates.rate3))
    step = numpy.radians(0.5)
    second = (rates.rate[2:] - rates.rate[:-2])/(2*step)
    check("second rate is the difference of the first", numpy.allclose(second, rates.rate2[1:-1], rtol=1e-4))
    check("lengths and angles", case.length(1, 2) == 140 and case.angle(1, 4) == 270)
    case.set_length(1, 2, 150)
    check("a changed length", abs(case.analyse().actual[0, 0] - (40 + numpy.sqrt(150**2 - 10**2))) < 1e-12*200)


def test_tolerances():
    case = psalm.Case.from_text(SLIDER + " &TOLER TOLLEN=0.01 &END\n")
    bands = case.tolerances()
    worst, rss = bands["output"].worst_case, bands["output"].root_sum_square
    check("worst case is at least RSS, RSS at least nothing", (worst >= rss).all() and (rss > 0).all())
    check("the nominal output", numpy.abs(bands["output"] - slide(bands["input"])).max() < 1e-12*180)


def test_search():
    found = psalm.Case.from_file(os.path.join(DATA, "path5.nml")).synthesise(threads=2)
    check("linkages were found", len(found) >= 1)
    check("five points: as good as known", found[0].analyse().objective < 7.5e-7)
    objectives = [case.analyse().objective for case in found]
    check("objectives are a column over the linkages", len(found) == len(found["objective"]) > 1 and
          numpy.abs(found["objective"] - objectives).max() < 1e-12)
    check("the best objective", found.best_objective == found["objective"].min())
    check("best first", all(a.analyse().objective <= b.analyse().objective*(1 + 1e-9) for a, b in zip(found, found[1:])))


def test_search_in_poses():
    """No loop has the length C P: a search in the poses of links. The angle between C B and C P, zero in the drawing, changes by parts of
    a radian, not by thousands of times what it was."""
    found = psalm.from_text("""A STRAIGHT COUPLER
 &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,-4.0,33.0,90.0,70.0,51.5, JY=0.0,31.0,82.0,5.0,133.0,107.5, LNK='A D','A B','B C P Q','C D',
  VARY='B C','C P','angle B C C P','A B','P Q' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point P' &END
 &METHOD NDES=4, DELT=0,36,72,108, DESX=70,75,80,70, DESY=130,133,120,110 &END
 &SEARCH SOLVER='LSQ', NSTART=1 &END
""").synthesise()
    check("a search in poses: the largest change", 0.01 < found["found"]["distance"][0] < 10.0)


def test_errors():
    raises("a misspelt item", "did you mean NLOOP?", lambda: psalm.Case.from_text(SLIDER.replace("NLOOP=1", "NLOPP=1")))
    try:
        psalm.Case.from_text(SLIDER.replace("NOUTLK=3", "NOUTLK=9")).analyse()
    except psalm.Error as error:
        check("a finding", error.status == 2 and error.findings[0].level == "error" and error.findings[0].line == 3)
    raises("a missing file", "cannot open", lambda: psalm.Case.from_file("/nowhere.nml"))
    raises("a missing case", "no case of this number", lambda: psalm.Case.from_text(SLIDER, 3))
    raises("an arc that is not there", "no such arc", lambda: psalm.Case.from_text(SLIDER).length(1, 9))
    raises("a length that is none", "not negative", lambda: psalm.Case.from_text(SLIDER).set_length(1, 1, -1.0))
    raises("arrays of different lengths", "as many", lambda: psalm.Case().add_loop([1, 2], [1]), ValueError)
    raises("reals for integers", "integers", lambda: psalm.Case().add_loop([1.5, 2], [1, 0]), TypeError)
    raises("an empty case", "", lambda: psalm.Case().analyse())
    case = psalm.Case.from_text(SLIDER.replace("140.0,", "35.0,"))
    result = case.analyse()
    check("a linkage that opens is a result", result.violated and not result.closed.all() and result.findings[0].level == "warning")
    check("NaN where it is open", (numpy.isnan(result.actual[:, 0]) == ~result.closed).all())


def test_copies():
    for case in (psalm.Case.from_text(SLIDER), four_bar(), made_in_memory(), psalm.from_file(os.path.join(DATA, "four_bars.json"))):
        want = case.analyse()
        for name, copier in (("copy", copy.copy), ("deepcopy", copy.deepcopy), ("pickle", lambda c: pickle.loads(pickle.dumps(c)))):
            other = copier(case)
            check("a case is copied: " + name, type(other) is type(case) and other.title == case.title and
                  all((other.analyse().table[n] == want.table[n]).all() for n in want.table))
    one = psalm.Case.from_text(SLIDER)
    other = one.copy()
    other.set_length(1, 2, 200.0)
    check("a copy is a case of its own", one.length(1, 2) == 140 and pickle.loads(pickle.dumps(other)).length(1, 2) == 200)
    raises("a result is not copied", "not copied", lambda: pickle.dumps(one.analyse()), TypeError)


def four_bar(**more):
    return psalm.Linkage({"A": (0, 0), "B": (0, 31), "C": (33, 82), "D": (90, 5), "P": (20, 95)}, links={"crank": "A B", "coupler":
                         ["B", "C", "P"], "rocker": "C D"}, fixed="AD", drive="A", output=["point P", "angle rocker"], step=10, **more)


def test_linkage():
    """A linkage from its drawing: lengths stay, columns have names, pages and drawings come as texts."""
    linkage = four_bar(RATES={"SPEED": 2.0, "UNITS": "RAD/S"})
    motion = linkage.analyse()
    rod = numpy.hypot(motion["C"].x - motion["B"].x, motion["C"].y - motion["B"].y)
    check("links keep their lengths", numpy.abs(rod - numpy.hypot(33, 51)).max() < 1e-11 and motion["P"].xy.shape == (36, 2))
    check("names of columns", dir(motion["P"]) == ["x", "y"] and "P.x" in motion and motion["angle_rocker"].unit == "deg")
    raises("a column that is not there", "there are", lambda: motion["Q"], KeyError)
    raises("a part that is not there", "P.z", lambda: motion["P"].z, AttributeError)
    rates = linkage.rates()
    check("speed of a joint of the crank", numpy.abs(numpy.hypot(rates["B"].vx, rates["B"].vy) - 62).max() < 1e-10)
    check("a rate is an attribute of its output", rates["angle_rocker"].v.shape == (36,))
    check("a repr that tells: %r" % linkage, repr(linkage) ==
          "<psalm.Linkage 'LINKAGE': joints A B C D P; 4 links; &CHAIN &DRIVES &METHOD &OUTPUTS &RATES>" and "positions" in repr(motion) and "36" in repr(motion.table))
    check("a summary in words", "Closes" in linkage.summary())
    files = linkage.draw()
    check("pictures", files[".svg"].lstrip().startswith("<") and "ENTITIES" in files[".dxf"] and "<script" in files[".html"])
    shown = linkage._repr_html_()
    check("in a notebook a sandboxed frame", shown.startswith('<iframe sandbox="allow-scripts"') and "<script" not in shown)
    check("tables in a notebook", "<table" in motion.table._repr_html_() and "point_P.x" in motion._repr_html_())
    check("the drawing board", "<html" in linkage.board().lower())
    moved = linkage.copy()
    check("assemblies of a four-bar", linkage.assemblies().table.rows == 2)
    moved.set("METHOD", IKIN=30)
    check("an item of a copy", moved.analyse().table.rows == 12 and linkage.analyse().table.rows == 36)
    proof = linkage.prove()
    check("a proof has tables", len(proof.tables) > 0)
    pandas = package("pandas")
    if pandas:
        frame = motion.to_dataframe()
        check("pandas", isinstance(frame, pandas.DataFrame) and frame.shape[0] == 36 and frame.attrs["units"]["P.x"] == "length")
    xarray = package("xarray")
    if xarray:
        data = motion.to_xarray()
        check("xarray", isinstance(data, xarray.Dataset) and data["P.x"].dims == ("input",) and data["P.x"].attrs["units"] == "length")
    matplotlib = package("matplotlib")
    if matplotlib:
        matplotlib.use("Agg")
        check("plot", len(linkage.plot().lines) >= 5)


def test_next_study():
    """What one study found is a case for the next."""
    found = psalm.from_file(os.path.join(DATA, "path5.nml")).synthesise()
    best = found[0]
    best.set("RATES", SPEED=10.0)
    best.set("MASSES", MLINK=[-2], MLOOP=[1], MASS=[0.5], MDIST=[0.5])
    forces = best.forces()
    check("forces of a linkage that was found", numpy.isfinite(forces["drive"]).any() and "drive" in forces)


def test_files_of_a_case():
    """A file that a case names is counted from the directory of the case, of one that was changed, too."""
    case = psalm.from_file(os.path.join(DATA, "types", "kinds_for_corner.nml"))
    case.set("SEARCH", NSTART=1)
    check("the curve of a changed case is found", len(case.kinds().cases) > 0)
    case.set("SEARCH", NSTART=-1)
    raises("lines of a changed case are not those of its file", "kinds_for_corner.nml (changed)", case.kinds)


ASKING = {"analysis": "textile.nml", "summary": "textile.nml", "tolerances": "adjustable_stroke.nml", "sweep": "adjustable_stroke.nml",
          "allocation": "cheapest_tolerances.nml",
          "synthesis": "path5.nml", "exact": "exact/five_poses.nml", "kinds": "types/kinds_for_corner.nml", "proof": "geared_five_bar.nml",
          "assemblies": "sketch_four_bar.nml", "rates": "engine.nml", "forces": "engine.nml", "machine": "engine.nml", "time": "time/toggle.nml",
          "balance": "muscle/needle_balance.nml", "springs": "muscle/haines_spring.nml", "vibration": "rig_coupler.nml",
          "cams": "calm/conjugate_cams.nml", "clearance": "bridge/four_bar_haines.nml", "picture": "jansen.nml",
          "board": "jansen.nml"}


# the table that a result is about, if it is not called like the verb
ABOUT = {"analysis": "positions", "rates": "positions", "forces": "positions", "machine": "positions", "synthesis": "found", "kinds": "found",
         "proof": "limits", "vibration": "estimates", "cams": "cam"}


def test_verbs():
    """Every verb, on a data set that asks for it: the listing is that of the program."""
    check("every verb is tried", set(ASKING) == set(psalm.verbs))
    for verb, file in ASKING.items():
        result = psalm.from_file(os.path.join(DATA, file)).study(verb)
        check(verb + " gives something", len(result.listing) > 100 or len(result.files) > 0)
        check(verb + " has tables", verb in ("picture", "board") or result.table.name == ABOUT.get(verb, verb))
        for table in result.tables.values():
            check("%s: the columns of %s are as long" % (verb, table.name), all(len(table[n]) == table.rows for n in table))
        check(verb + " has linkages", verb not in ("synthesis", "exact", "kinds", "balance", "springs") or len(result.cases) > 0)


def test_wrong_arguments(calls):
    """Wrong arguments of every kind are a Python exception, never a signal."""
    odd = [None, 0, 1, -1, 2**31, -2**40, 1.5, float("nan"), float("inf"), "", "A", "A B", "\0", "\n", "x"*5000, "'", "\u00e9\u4e2d", b"A",
           [], [1], [1.5], ["A"], [None], [[1, 2], [3]], {}, object(), True, numpy.zeros((2, 2)), numpy.array([]), ("A", "B"),
           {"A": 1}, "LINKS", "METHOD", "DELT", "analysis", range(3), lambda: 0]
    odd += ["synthesis", "tolerances", "kinds", "proof", "time", "picture", slice(None), -7, 10**30, Ellipsis, complex(1, 2)]
    words = ["threads", "progress", "listing", "number", "name", "fixed", "step", "inputs", "slides", "gears", "drive", "output", "reference",
             "length", "METHOD", "nothing"]
    left_out = ("from_file", "synthesise", "exact", "plot", "found", "to_dataframe", "to_xarray")
    special = ("__getitem__", "__contains__", "__len__", "__copy__", "_repr_html_", "__repr__", "__getattr__")
    random = numpy.random.default_rng(1)
    raised = 0
    things, rest, tried = [], [], set()
    search = psalm.from_file(os.path.join(DATA, "path5.nml")).synthesise()
    for call in range(calls):
        if call % 50 == 0:
            case = [four_bar(), psalm.Case.from_text(SLIDER), psalm.Case("T"), psalm.from_joints({}, [])][call//50 % 4]
            motion = four_bar().analyse()
            things = [case]*4 + [psalm.Case, psalm.Linkage, psalm, motion, motion.table, motion["P"], motion["input"], search]
        thing = things[random.integers(len(things))]
        names = [n for n in dir(thing) if not n.startswith("_") and n not in left_out and thing is not motion["input"]]
        names += [n for n in special if hasattr(type(thing), n)]
        if isinstance(thing, type):
            names = ["from_text", "from_joints", "__call__"]
        elif thing is psalm:
            names = ["from_text", "from_joints", "from_file", "Case", "Linkage", "Error", "Group", "Table", "Result", "Search", "Motion"]
        name = names[random.integers(len(names))]
        arguments = [odd[random.integers(len(odd))] for _ in range(random.integers(0, 5))]
        named = {words[random.integers(len(words))]: odd[random.integers(len(odd))] for _ in range(random.integers(0, 2))}
        try:
            part = thing if name == "__call__" else getattr(thing, name)
            if callable(part):
                part(*arguments, **named)
        except (psalm.Error, TypeError, ValueError, OverflowError, KeyError, IndexError, AttributeError, UnicodeError):
            raised += 1
        except Exception as error:
            rest.append((name, arguments, named, error))
        tried.add((type(thing).__name__, name))
    print("        %d wrong calls of %d functions: %d exceptions" % (calls, len(tried), raised))
    check("%d wrong calls: exceptions of a kind that is meant: %s" % (calls, rest[:2]), not rest)
    check("most of them raise", raised > calls//3)
    check("and the library works on", four_bar().analyse()["P"].x.shape == (36,))


def test_fork():
    """A forked child analyses and searches; the parent goes on."""
    case, path = four_bar(), psalm.from_file(os.path.join(DATA, "path5.nml"))
    path.set("SEARCH", NSTART=3)
    want, best = case.analyse()["P"].x, path.synthesise(threads=1).best_objective
    for threads in (1, 2):      # of two the parent has had a team before
        path.synthesise(threads=threads)
        child = os.fork()
        if child == 0:
            signal.alarm(60)    # ends a child that waits for threads which it has not
            same = (case.analyse()["P"].x == want).all() and (four_bar().analyse()["P"].x == want).all()
            os._exit(0 if same and path.synthesise(threads=threads).best_objective == best else 1)
        check("a child after fork, %d threads" % threads, os.waitpid(child, 0)[1] == 0)
    check("the parent after it", (case.analyse()["P"].x == want).all())


class Counted:
    """The library, with a count of its calls."""

    def __init__(self, library):
        self._library, self.calls = library, []

    def __getattr__(self, name):
        self.calls.append(name)
        return getattr(self._library, name)


def test_speed():
    """What Python adds to an analysis of 180 positions: calls are counted, the time is told, not assessed."""
    case = four_bar()
    case.set("METHOD", IKIN=2)
    case.analyse()
    library = psalm._library.library
    made = ctypes.c_void_p()

    def whole():
        return case.analyse()["P"].x

    def alone():
        library.psalm_study(case._handle, b"analysis", 1, 0, ctypes.byref(made))
        library.psalm_result_free(made)

    counted = Counted(library)
    modules = psalm._cases, psalm._results
    for module in modules:
        module.library = counted
    whole()
    for module in modules:
        module.library = library
    check("a column of an analysis takes six calls of the library: %s" % counted.calls, len(counted.calls) == 6)
    # in turn: a processor that slows down does so for both
    pairs = [(timed(whole), timed(alone)) for _ in range(1000)]
    best, study = (min(times) for times in zip(*pairs))
    print("        180 positions: %.0f us, of which %.0f us in the library" % (best*1e6, study*1e6))


def test_import():
    """What it takes to import the module, NumPy first: seconds of the processor, the least of five processes."""
    script = ("import time; began = time.process_time(); import numpy; between = time.process_time(); import psalm; "
              "print(between - began, time.process_time() - between)")
    where = dict(os.environ, PYTHONPATH=os.path.dirname(os.path.dirname(os.path.abspath(psalm.__file__))))
    spent = [[float(word) for word in subprocess.run([sys.executable, "-c", script], env=where, capture_output=True, text=True,
                                                     check=True).stdout.split()] for _ in range(5)]
    numpys, own = (min(times) for times in zip(*spent))
    print("        import: %.3f s of NumPy and %.3f s of its own" % (numpys, own))
    check("the module is imported in a moment: %.3f s" % own, own < 0.1)


def test_level():
    """A build of the library for an instruction set that is not there is refused in words."""
    where = {name: value for name, value in os.environ.items() if name != "PSALM_LIBRARY"}
    where.update(PYTHONPATH=os.path.dirname(os.path.dirname(os.path.abspath(psalm.__file__))), PSALM_LEVEL="x86-64-v9")
    ran = subprocess.run([sys.executable, "-c", "import psalm"], env=where, capture_output=True, text=True, check=False)
    check("PSALM_LEVEL of no build: " + ran.stderr[-200:], ran.returncode == 1 and "ImportError: PSALM_LEVEL=x86-64-v9: there is no build" in ran.stderr)


def timed(action):
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def made_in_memory():
    case = psalm.Case("MADE IN MEMORY")
    case.add_loop([1, -2, 3, 4], [1, 0, -4, 1], [40, 140, 0, 10], [0, 0, 0, 270.0])
    for group, item, values in (("METHOD", "MOTION", 3), ("METHOD", "NDES", 2), ("METHOD", "DELT", [0.0, 5.0]),
                                ("LINKS", "NOUTLK", 3), ("LINKS", "NOUTLP", 1)):
        case.set(group, item, values)
    return case


def test_names():
    """Names and words cannot leave their place in the text of the case."""
    case = made_in_memory()
    case.set("RATES", "SPEED", 2.0)
    plain = case.rates().velocity
    case.set("RATES", "UNITS", "RAD/S', SPEED=1000.0 &END &USERX A='")
    raises("a word with apostrophes stays one word", "UNITS", case.rates)
    case.set("RATES", "UNITS", "RAD/S")
    check("and nothing else was set", (case.rates().velocity == plain).all())
    for what, group, item, value in (("a group with a blank", "LIM ITS", "TANGLE", 3.0), ("no group", "", "TANGLE", 3.0),
                                     ("an item that sets another", "LIMITS", "TANGLE=3, LAST", 1), ("a long name", "A"*100000, "X", 1),
                                     ("a line break in an item", "LIMITS", "TANGLE\n", 3.0), ("a name of digits", "LIMITS", "3", 1)):
        raises(what, "letters and digits", lambda: case.set(group, item, value))
    raises("a line break in a word", "line breaks", lambda: case.set("RATES", "UNITS", "A\nB"))
    raises("not a number", "finite", lambda: case.set("RATES", "SPEED", float("nan")))
    check("what was refused has not spoilt the case", (case.rates().velocity == plain).all())
    case.set("METHOD", "DELT(2)", 7.0)
    check("an item with an index", case.analyse().input[1] == 7.0)
    raises("a group that is not there", "LIMIDS", lambda: (case.set("LIMIDS", "TANGLE", 3.0), case.analyse()))
    raises("a title of two lines", "one line", lambda: psalm.Case("T\n &LIMITS TANGLE=3.0 &END").analyse())


def endless():
    with open(os.path.join(DATA, "needle_lsq.nml"), encoding="utf-8") as file:
        return psalm.Case.from_text(re.sub(r"NSTART=\d+", "NSTART=1000000", file.read()))


def legs_in_a_row(bodies):
    """Bodies pinned in a row, on legs of which one stands on the crank: one group of bodies + 1 loops, C(2n, n) paths to its assemblies."""
    joints, links, fixed, legs = {"O": (0, 0), "A": (0.3, 0.6)}, ["O A"], ["O"], 0
    for body in range(bodies):
        own = ["P%d" % k for k in (body, body + 1) if 0 < k < bodies]
        joints["P%d" % (body + 1)] = (2*body + 3, 3 + 0.3*(body % 2))
        for leg in range(1 + (body == 0) + (body == bodies - 1)):
            legs += 1
            joints["L%d" % legs] = (2*body + 1.2 + 0.9*leg + 0.05*legs, 2.2 - 0.4*leg + 0.1*(legs % 3))
            joints["F%d" % legs] = (2*body + 1.5 + 1.1*leg + 0.2*(legs % 2), -0.3*(legs % 3))
            own.append("L%d" % legs)
            fixed += ["F%d" % legs]*(legs > 1)
            links.append("%s L%d" % ("F%d" % legs if legs > 1 else "A", legs))
        links.append(own)
    del joints["P%d" % bodies], joints["F1"]
    return psalm.from_joints(joints, links, fixed=fixed, drive="O", output="point L2", step=30)


def test_bar():
    """progress=True draws a bar on standard error, and ends its line."""
    case = endless()
    case.set("SEARCH", NSTART=200)
    with contextlib.redirect_stderr(io.StringIO()) as shown:
        case.synthesise(progress=True)
    bars = [re.fullmatch(r"\[(#*) *\] (\d+) of 200  \d+ s(?:  best [\d.e+-]+)? \n?", bar) for bar in shown.getvalue().split("\r")[1:]]
    check("a bar is drawn: %r" % shown.getvalue()[-200:], len(bars) > 0 and all(bars) and shown.getvalue().endswith("\n"))
    check("its length is the part that is made", all(len(bar[1]) == 40*int(bar[2])//200 for bar in bars if bar))
    check("the bar grows", [int(bar[2]) for bar in bars if bar] == sorted(int(bar[2]) for bar in bars if bar))


def test_stopping():
    """A search that would take days ends when it is asked to."""
    calls = []
    began = time.monotonic()
    found = endless().synthesise(progress=lambda *state: calls.append(state) or len(calls) > 2)
    check("progress ends a search", time.monotonic() - began < 20 and len(calls) > 2)
    check("what was found so far is there", len(found) > 0)
    check("progress rises towards its limit", 0 < calls[0][0] <= calls[-1][0] < calls[-1][1] == 1000000 and calls[-1][2] >= 0)
    for threads in (1, 2):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        sent = []
        # seconds of the processor: a machine that does other work lets every process wait
        timer = threading.Timer(0.5, lambda: (sent.append(time.process_time()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            endless().synthesise(threads)
            check("Ctrl-C is heard", False)
        except KeyboardInterrupt as interrupt:
            check("what was found so far is kept", len(interrupt.result) > 0)
            late = time.process_time() - sent[0]
            check("Ctrl-C ends a search at once: %.2f s" % late, late < 1)
        signal.signal(signal.SIGINT, before)
    springs = psalm.from_file(os.path.join(DATA, "muscle", "haines_springs.nml"))   # 18 s
    running = psalm.from_file(os.path.join(DATA, "dyad4_slider_crank.nml"))         # a minute
    running.set("RATES", SPEED=10.0, UNITS="RAD/S")
    running.set("MASSES", MLINK=[-2], MLOOP=[1], MASS=[0.5], MDIST=[45.0], UNITL=0.001)
    running.set("MOTOR", MTORQ=1.0, MSPEED=20.0, FLYWHL=0.1, NTURN=100000)
    shaking = psalm.from_file(os.path.join(DATA, "rig_coupler.nml"))                # a minute
    shaking.set("VIBR", NVSPED=10000)
    moving = psalm.from_file(os.path.join(DATA, "time", "pendulum.nml"))            # a minute
    links = psalm.from_file(os.path.join(DATA, "hard", "chain64.nml"))              # 18 s
    moving.set("TIME", TEND=50000.0, NTIME=100000)
    for name, action, kept in (("springs", springs.springs, lambda result: len(result.cases) == 1),
                               ("time", moving.time, lambda result: 1 < result.table.rows < 100000),
                               ("machine", running.machine, lambda result: "machine_cycle" in result.tables and
                                "run_up" not in result.tables),
                               ("vibration", shaking.vibration, lambda result: 0 < result.tables["speeds"].rows < 10000 and
                                "unstable_speeds" not in result.tables),
                               ("picture", lambda: shaking.study("picture"), lambda result: not result.files),
                               ("picture of a motion in time", lambda: moving.study("picture"), lambda result: not result.files),
                               ("proof", links.prove, lambda result: not result.tables),
                               ("assemblies", legs_in_a_row(5).assemblies, lambda result: 1 <= result.table.rows <= 6 and
                                abs(result["P1"].x[0] - 3) < 1e-9)):
        before = signal.signal(signal.SIGINT, signal.default_int_handler)
        sent = []
        timer = threading.Timer(0.5, lambda: (sent.append(time.process_time()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            action()
            timer.cancel()
            check("Ctrl-C is heard: " + name, False)
        except KeyboardInterrupt as interrupt:
            late = time.process_time() - sent[0]
            check("what there is so far is kept: " + name, interrupt.result.violated and kept(interrupt.result))
            check("Ctrl-C ends it at once: %s, %.2f s" % (name, late), late < 1)
        signal.signal(signal.SIGINT, before)
        if name == "proof" or name.startswith("picture"):    # nothing is counted there
            continue
        result = action(progress=lambda *state: True)
        check("a function of the caller ends it: " + name, result.violated and kept(result))
    raises("too many threads", "1024", lambda: endless().synthesise(2147483647))
    raises("a negative number of threads", "-1 threads", lambda: endless().synthesise(-1))
    raises("too many threads for tolerances", "1024", lambda: endless().tolerances(100000))


def test_report():
    """The report says what the studies say; a case that is wrong and a limit that is violated give their exit statuses."""
    from psalm import report
    case = psalm.from_file(os.path.join(DATA, "cut_from_plate.nml"))
    page = report.report(case)
    plates, forces = case.study("forces").tables["plates"], case.forces()
    check("report: masses", all("<td>%.6g</td>" % mass in page for mass in plates["mass"]))
    check("report: forces", all("<td>%.6g</td>" % value in page for value in forces["drive"]))
    check("report: summary", "crank-rocker" in page and "<svg" not in page.split("<h2>Positions")[0])
    check("report: the page is XML", bool(xml.etree.ElementTree.fromstring(re.sub(r"<!DOCTYPE html>|<meta[^>]*>|<img[^>]*>|<br>", "", page))))
    check("report: words of the case are escaped", "&lt;b&gt;" in report.report(psalm.Case.from_text(case.text.replace("VENT LIFT", "<b>"))))
    long = report.report(psalm.from_file(os.path.join(DATA, "needle_masses.nml")))
    check("report: long tables are thinned, curves drawn", "every" in long and long.count("<svg") > 10)
    check("report: motion in time", "<h2>Motion in time</h2>" in report.report(psalm.from_file(os.path.join(DATA, "time", "clutch_press.nml"))))
    raises("report: a case without a linkage", "no linkage", lambda: report.report(psalm.from_file(os.path.join(DATA, "exact", "five_poses.nml"))))
    for name in ("needle", "muscle/haines_10u", "bridge/four_bar_haines"):
        check("report: " + name, "</html>" in report.report(psalm.from_file(os.path.join(DATA, name + ".nml"))))
    with tempfile.TemporaryDirectory() as folder:
        def written(name, text):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
            return report.main([os.path.join(folder, name)])
        sys.stdout.flush()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()) as said:
            check("report: written", written("good.nml", case.text) == 0 and os.path.getsize(os.path.join(folder, "good.report.html")) > 10000)
            check("report: violated", written("open.nml", case.text.replace("TANGLE=70.0", "TANGLE=10.0")) == 1)
            check("report: wrong", written("wrong.nml", case.text.replace("JNT", "JOINTS")) == 2 and "JOINTS" in said.getvalue())
            check("report: a case that is searched", written("exact.nml", open(os.path.join(DATA, "exact", "five_poses.nml"), encoding="utf-8").read()) == 2
                  and "device 7" in said.getvalue())
            check("report: nothing there", report.main([os.path.join(folder, "nothing.nml")]) >= 2)
            check("report: no folder", report.main([os.path.join(folder, "good.nml"), "--output-dir", os.path.join(folder, "none")]) == 3)
            check("report: the file that cannot be written", os.path.join("none", "good.report.html") in said.getvalue())
        check("report: nothing else is left", sorted(os.listdir(folder)) == ["exact.nml", "good.nml", "good.report.html", "open.nml", "open.report.html", "wrong.nml"])


def test_threads():
    """Cases of different threads do not disturb each other."""
    results = {}

    def work(length):
        case = psalm.Case.from_text(SLIDER)
        case.set_length(1, 2, length)
        results[length] = [case.analyse().actual for _ in range(20)]

    workers = [threading.Thread(target=work, args=(length,)) for length in (100.0, 140.0, 200.0)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    check("threads", all((a == all_of[0]).all() for all_of in results.values() for a in all_of) and len(results) == 3 and
          abs(results[100.0][0][0, 0] - (40 + numpy.sqrt(100**2 - 10**2))) < 1e-12*140)

    def columns(verb):
        tables = psalm.from_file(os.path.join(DATA, ASKING[verb])).study(verb).tables
        return {(t.name, n): list(t[n]) for t in tables.values() for n in t}

    # two studies of two cases, each as often as it can while the other works
    pair = "synthesis", "forces"
    alone, beside, ends = {verb: repr(columns(verb)) for verb in pair}, {verb: [] for verb in pair}, time.monotonic() + 1.0

    def repeat(verb):
        while time.monotonic() < ends or not beside[verb]:
            beside[verb].append(repr(columns(verb)))

    workers = [threading.Thread(target=repeat, args=(verb,)) for verb in pair]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    check("two threads on two cases: the digits of each alone", all(set(beside[verb]) == {alone[verb]} for verb in pair))


for test in (test_analysis, test_conditions, test_made, test_linkage, test_tolerances, test_search, test_search_in_poses, test_next_study,
             test_files_of_a_case, test_verbs, test_errors, test_copies, test_names, test_fork, test_bar, test_stopping, test_report, test_threads, test_speed,
             test_import, test_level):
    test()
test_wrong_arguments(int(sys.argv[2]) if len(sys.argv) > 2 else 4000)
PROJECT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pyproject.toml")
if os.path.exists(PROJECT):
    with open(PROJECT, encoding="utf-8") as project:
        check("the version is that of the package", 'version = "%s"' % psalm.version in project.read())
print("%d passed, %d failed" % (passed, failed) + (", %d skipped" % skipped if skipped else ""))
sys.exit(failed > 0)
