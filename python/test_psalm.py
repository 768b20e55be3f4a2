#!/usr/bin/env python3
"""The Python module as another program uses it.

usage: test_psalm.py DATA_DIRECTORY, with the module on the path. Last line: N passed, N failed."""
import copy
import os
import pickle
import re
import signal
import sys
import threading
import time

import numpy
import psalm

DATA = sys.argv[1]
SLIDER = """OFFSET SLIDER-CRANK
 &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,
  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END
 &METHOD MOTION=3, IKIN=15 &END
"""
passed = failed = 0


def check(law, right):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: python: " + law)


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
    result = psalm.Case.from_text(SLIDER).analyse()
    check("shapes", result.input.shape == (24,) and result.actual.shape == (24, 1) and result.closed.dtype == bool)
    check("the slide is that of a right triangle", numpy.abs(result.actual[:, 0] - slide(result.input)).max() < 1e-12*180)
    check("closes, without findings", result.closed.all() and not result.violated and result.findings == [])
    check("the listing", "179.6424" in result.listing)
    textile = psalm.Case.from_file(os.path.join(DATA, "textile.nml")).analyse()
    check("a point has two components", textile.actual.shape == (12, 2))
    published = numpy.loadtxt(os.path.join(DATA, "reference", "textile-output.txt"), comments="#")
    check("the published points of the textile linkage", numpy.allclose(textile.actual, published[:, 1:3], rtol=1e-11, atol=0))


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
    check("worst case is at least RSS, RSS at least nothing", (bands.worst_case >= bands.rss).all() and (bands.rss > 0).all())
    check("the nominal output", numpy.abs(bands.actual[:, 0] - slide(bands.input)).max() < 1e-12*180)


def test_search():
    found = psalm.Case.from_file(os.path.join(DATA, "path5.nml")).synthesise(threads=2)
    check("linkages were found", len(found) >= 1)
    check("five points: as good as known", found[0].analyse().objective < 7.5e-7)
    check("best first", all(a.analyse().objective <= b.analyse().objective*(1 + 1e-9) for a, b in zip(found, found[1:])))


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
    case = psalm.Case.from_text(SLIDER)
    for name, copier in (("copy", copy.copy), ("deepcopy", copy.deepcopy), ("pickle", pickle.dumps)):
        raises("a case is not copied: " + name, "cannot be copied", lambda: copier(case), TypeError)
    check("and lives on", case.analyse().closed.all())


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
        timer = threading.Timer(0.5, lambda: (sent.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT)))
        timer.start()
        try:
            endless().synthesise(threads)
            check("Ctrl-C is heard", False)
        except KeyboardInterrupt:
            late = time.monotonic() - sent[0]
            check("Ctrl-C ends a search at once: %.2f s" % late, late < 2)    # 0.1 s on a machine that does nothing else
        signal.signal(signal.SIGINT, before)
    raises("too many threads", "1024", lambda: endless().synthesise(2147483647))
    raises("too many threads for tolerances", "1024", lambda: endless().tolerances(100000))


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


for test in (test_analysis, test_made, test_tolerances, test_search, test_errors, test_copies, test_names,
             test_stopping, test_threads):
    test()
with open(os.path.join(DATA, "..", "python", "pyproject.toml"), encoding="utf-8") as project:
    check("the version is that of the package", 'version = "%s"' % psalm.version in project.read())
print("%d passed, %d failed" % (passed, failed))
sys.exit(failed > 0)
