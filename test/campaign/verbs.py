#!/usr/bin/env python3
"""Does a verb of the library keep memory? Every verb, called again and again on a case that asks for it, its result read and dropped.

usage: verbs.py [--count 100000] [--seconds S] [--short] [VERB ...]
       verbs.py --digits [VERB ...]
The Python module is that on the path, else python/ of the checkout, after scripts/build_library. A line for each verb: calls made, the
bytes that the process has in use after a tenth of them and at the end (as the allocator of the C library counts them, exactly: its caches
of threads, which count as in use, are switched off), what the system has given it, and the time of a call. --seconds ends each verb after S seconds of the processor. Last line: N passed, N failed. A
verb passes if the bytes in use have not grown by more than what caches of the allocator and of Python make of it, whatever the number of
calls, and what the system has given by less than 1 MB (looked at from a thousand calls on).

--short: the slower verbs on the smallest case for which they still give a result (SHORT below), so that 100000 calls take minutes, not hours.
--digits: no memory; a line for each verb with a digest of everything that it gives for the same cases: builds of the library can be compared.
"""
import argparse
import ctypes
import gc
import hashlib
import os
import sys
import threading
import time

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.append(os.path.join(TOP, "python"))
import psalm  # noqa: E402

# masses of a slider-crank, so that its forces can be asked for
MASSES = (("RATES", "SPEED", 10.0), ("RATES", "UNITS", "RAD/S"), ("MASSES", "MLINK", [-2]), ("MASSES", "MLOOP", [1]),
          ("MASSES", "MASS", [0.5]), ("MASSES", "MDIST", [45.0]), ("MASSES", "UNITL", 0.001))
# a data set for each verb, and items that make a call short
ASKING = {"analysis": ("dyad4_slider_crank.nml", ()),
          "summary": ("dyad4_slider_crank.nml", ()),
          "tolerances": ("adjustable_stroke.nml", ()),
          "allocation": ("cheapest_tolerances.nml", (("METHOD", "IKIN", 120), ("ALLOC", "ALRULE", "WORST"), ("ALLOC", "ALTRY", 100))),
          "sweep": ("adjustable_stroke.nml", ()),
          "synthesis": ("path5.nml", (("SEARCH", "NSTART", 1), ("SEARCH", "MAXEVAL", 5))),
          "exact": ("exact/five_poses.nml", ()),
          "kinds": ("types/kinds_for_corner.nml", (("SEARCH", "NSTART", 1), ("SEARCH", "MAXEVAL", 5), ("KINDS", "SLIDES", 0),
                                                   ("KINDS", "NKINDS", 1))),
          "proof": ("dyad4_slider_crank.nml", ()),
          "assemblies": ("sketch_four_bar.nml", ()),
          "rates": ("dyad4_slider_crank.nml", MASSES),
          "forces": ("dyad4_slider_crank.nml", MASSES),
          "time": ("time/toggle.nml", (("TIME", "NTIME", 5),)),
          "machine": ("dyad4_slider_crank.nml", MASSES + (("MOTOR", "MTORQ", 1.0), ("MOTOR", "MSPEED", 20.0), ("MOTOR", "FLYWHL", 0.1))),
          "balance": ("muscle/haines_bodies.nml", ()),
          "springs": ("muscle/haines_spring.nml", ()),
          "vibration": ("sketch_four_bar.nml", (("RATES", "SPEED", 10.0), ("RATES", "UNITS", "RAD/S"), ("HILL", "HC0", [1.0, 1.1]),
                                                ("HILL", "HP", [0.1, 0.1]))),
          "cams": ("calm/flat_swinging.nml", ()),
          "clearance": ("bridge/four_bar_haines.nml", (("CLEAR", "NCSPED", 0), ("CLEAR", "NCPNT", 32))),
          "picture": ("sketch_four_bar.nml", ()),
          "board": ("sketch_four_bar.nml", ())}
# of the verbs whose call takes longer than that of the others, the smallest case that has a result: a file or a text, and items. The flights of
# a joint with clearance, the bounces of a stop and a search among shapes of weights are in the cases above alone.
SHORT = {"synthesis": ("path5.nml", (("SEARCH", "NSTART", 1), ("SEARCH", "MAXEVAL", 1))),
         "exact": ("exact/function_points.nml", ()),
         "kinds": ("FOUR-LINKS FOR TWO ANGLES\n &METHOD NDES=2, DELT=0.0,30.0, DESANG=90.0,100.0 &END\n &KINDS LINKS=4, OUTPUT='ANGLE', "
                   "NKINDS=1, PATNCE=1 &END\n &SEARCH NSTART=1, MAXEVAL=20 &END\n", ()),
         "machine": ("dyad4_slider_crank.nml", MASSES + (("METHOD", "IKIN", 120), ("MOTOR", "MTORQ", 1.0), ("MOTOR", "MSPEED", 20.0),
                                                         ("MOTOR", "FLYWHL", 100.0))),
         "time": ("time/toggle.nml", (("TIME", "NTIME", 5), ("TIME", "TEND", 0.03))),
         "balance": ("muscle/haines_bodies.nml", (("METHOD", "IKIN", 60), ("BALANC", "NFRONT", 2))),
         "springs": ("muscle/lamp.nml", (("METHOD", "NDES", 3), ("METHOD", "DELT", [0.0, 50.0, 100.0]), ("SPRNGS", "NSSTRT", 1))),
         "clearance": ("bridge/four_bar_haines.nml", (("CLEAR", "NCSPED", 0), ("CLEAR", "NCPNT", 32), ("MASSES", "GRAVY", -9.81),
                                                      ("RATES", "SPEED", 20.0))),
         "cams": ("calm/flat_swinging.nml", (("CAM", "TOLCUT", 1.0),)),
         "picture": ("dyad4_slider_crank.nml", (("METHOD", "IKIN", 120),))}
CACHES = 16*1024        # bytes
GIVEN = 1024            # kB
MANY = 1000             # calls; pages that are touched for the first time come to more than GIVEN in fewer
BEFORE = 5              # calls that fill caches
PLAIN = "glibc.malloc.tcache_count=0"   # of GLIBC_TUNABLES, which only a new process hears
ROUNDS = 10             # of few calls; what a verb keeps shows in each
LOOKS = 10              # at what the system has given


class Allocated(ctypes.Structure):
    """`struct mallinfo2` of the GNU C library."""
    _fields_ = [(name, ctypes.c_size_t) for name in
                ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")]


def memory():
    """Bytes in use, 0 where the C library does not count them, and kB of the process, once what is free has gone back to the system.

    Pages of files do not count: code is read when it runs for the first time. A study has a thread of its own, which has memory until it
    has ended: a little later than its result is there.
    """
    for thread in threading.enumerate():
        if thread is not threading.current_thread():
            thread.join()
    gc.collect()
    own = ctypes.CDLL(None)
    if getattr(own, "malloc_trim", None):
        own.malloc_trim(ctypes.c_size_t(0))
    used = 0
    if getattr(own, "mallinfo2", None):
        own.mallinfo2.restype = Allocated
        told = own.mallinfo2()
        used = told.uordblks + told.hblkhd
    with open("/proc/self/status", encoding="ascii") as file:
        fields = dict(line.split(":", 1) for line in file)
    return used, int(fields["RssAnon"].split()[0])


def call(case, verb):
    result = case.study(verb, threads=1)
    for table in result.tables.values():
        table.to_dict()
    return len(result.listing) + len(result.cases) + len(result.files)


def case_for(verb, short=False):
    given, items = SHORT[verb] if short and verb in SHORT else ASKING[verb]
    case = psalm.from_text(given) if "\n" in given else psalm.from_file(os.path.join(TOP, "data", given))
    for group, item, value in items:
        case.set(group, item, value)
    return case


def digest(verb):
    """Of every table, listing, file and linkage that a study gives."""
    result = case_for(verb).study(verb)
    sum_of = hashlib.sha256(result.listing.encode() + result.data_set.encode())
    for name, table in result.tables.items():
        for column, values in table.to_dict().items():
            sum_of.update(("%s.%s" % (name, column)).encode())
            sum_of.update("\n".join(values).encode() if values.dtype == object else values.tobytes())
    for ending, content in result.files.items():
        sum_of.update(ending.encode() + content.encode())
    return sum_of.hexdigest()


def calls(case, verb, options):
    """Number of calls, milliseconds of each, and the memory after a tenth of them and at the end."""
    began, made, first = time.process_time(), 0, None
    while made < options.count and time.process_time() - began < options.seconds:
        call(case, verb)
        made += 1
        # by calls, or by time where that is what ends it
        if first is None and (10*made >= options.count or 10*(time.process_time() - began) >= options.seconds):
            first = memory()
    each = 1e3*(time.process_time() - began)/max(1, made)
    last = memory()
    first = first or last
    # what is free in pieces cannot go back: how much that is varies from call to call by some MB. What is kept shows every time
    for _ in range(LOOKS):
        if last[1] - first[1] < GIVEN:
            break
        for _ in range(BEFORE):
            call(case, verb)
        last = min(last, memory(), key=lambda one: one[1])
    return made, each, first, last


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--count", type=int, default=100000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--digits", action="store_true")
    parser.add_argument("verbs", nargs="*", default=list(psalm.verbs))
    options = parser.parse_args()
    if not options.digits and PLAIN not in os.environ.get("GLIBC_TUNABLES", ""):
        others = os.environ.get("GLIBC_TUNABLES")
        os.execve(sys.executable, [sys.executable] + sys.argv, dict(os.environ, GLIBC_TUNABLES=PLAIN + (":" + others if others else "")))
    if options.digits:
        for verb in options.verbs:
            print(verb, digest(verb), flush=True)
        return
    passed = failed = 0
    for verb in options.verbs:
        case = case_for(verb, options.short)
        for _ in range(BEFORE):
            call(case, verb)
        # Python's own tables grow now and then
        rounds, flat = 1 if options.count >= MANY else ROUNDS, False
        while rounds > 0 and not flat:
            rounds -= 1
            made, each, first, last = calls(case, verb, options)
            flat = made > 0 and last[0] - first[0] < CACHES and (made < MANY or last[1] - first[1] < GIVEN)
            if not flat and rounds > 0:
                print("once more: %s, %d bytes in use, %+d at the end" % (verb, first[0], last[0] - first[0]), flush=True)
        passed, failed = passed + flat, failed + (not flat)
        print("%s%-10s %6d calls, %9d bytes in use after a tenth, %+6d at the end, %6d kB given, %+5d at the end, %.3f ms each" % (
            "" if flat else "FAILED: memory: ", verb, made, first[0], last[0] - first[0], first[1], last[1] - first[1], each), flush=True)
    print("%d passed, %d failed" % (passed, failed))
    sys.exit(failed > 0)


main()
