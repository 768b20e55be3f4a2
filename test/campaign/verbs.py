#!/usr/bin/env python3
"""Does a verb of the library keep memory? Every verb, called again and again on a case that asks for it, its result looked at and dropped.

usage: verbs.py [--count 100000] [--seconds S] [VERB ...], with the Python module on its path (python/ after scripts/build_library).
A line for each verb: calls made, the memory of the process after a tenth of them and at the end; --seconds ends each verb after that
time. Last line: N passed, N failed; a verb passes that grows by less than 1 MB from the first tenth to the end.
"""
import argparse
import ctypes
import os
import sys
import time

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(1, os.path.join(TOP, "python"))
import psalm  # noqa: E402

# data sets that are studied in a moment, and what makes them so
ASKING = {"analysis": "dyad4_slider_crank.nml", "summary": "dyad4_slider_crank.nml", "tolerances": "adjustable_stroke.nml",
          "allocation": "cheapest_tolerances.nml",
          "sweep": "adjustable_stroke.nml", "synthesis": "path5.nml", "exact": "exact/five_poses.nml", "proof": "dyad4_slider_crank.nml",
          "assemblies": "sketch_four_bar.nml", "rates": "engine.nml", "forces": "engine.nml", "machine": "engine.nml",
          "balance": "muscle/haines_bodies.nml", "springs": "muscle/haines_spring.nml", "vibration": "rig_coupler.nml",
          "cams": "calm/flat_swinging.nml", "clearance": "bridge/four_bar_haines.nml", "picture": "sketch_four_bar.nml",
          "board": "sketch_four_bar.nml", "kinds": "types/kinds_for_corner.nml"}
SHORTER = {"kinds": [("SEARCH", "NSTART", 2)], "synthesis": [("SEARCH", "NSTART", 2)]}
LEAST_GROWTH = 1024     # kB


def memory():
    """Of the process, kB, once what is free has gone back to the system: else it goes up and down by megabytes from call to call."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim:
        trim(ctypes.c_size_t(0))
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1])*os.sysconf("SC_PAGE_SIZE")//1024


def call(case, verb):
    result = case.study(verb)
    for table in result.tables.values():
        table.to_dict()
    return len(result.listing) + len(result.cases) + len(result.files)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=100000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("verbs", nargs="*", default=list(psalm.verbs))
    options = parser.parse_args()
    passed = failed = 0
    for verb in options.verbs:
        case = psalm.from_file(os.path.join(TOP, "data", ASKING[verb]))
        for group, item, value in SHORTER.get(verb, ()):
            case.set(group, item, value)
        began, made, first = time.monotonic(), 0, None
        while made < options.count and time.monotonic() - began < options.seconds:
            call(case, verb)
            made += 1
            # by calls, or by time where that is what ends it
            if first is None and (10*made >= options.count or 10*(time.monotonic() - began) >= options.seconds):
                first = memory()
        last = memory()
        flat = last - (first or last) < LEAST_GROWTH
        passed, failed = passed + flat, failed + (not flat)
        print("%s%-10s %6d calls, %6d kB after a tenth, %6d kB at the end, %.3f ms each" % (
            "" if flat else "FAILED: ", verb, made, first or last, last, 1e3*(time.monotonic() - began)/max(1, made)), flush=True)
    print("%d passed, %d failed" % (passed, failed))
    sys.exit(failed > 0)


main()
