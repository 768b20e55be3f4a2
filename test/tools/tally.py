"""Counts of checks that hold and of those that do not, for tests in Python."""
import os
import sys

passed = failed = 0


def check(law, good, detail=""):
    global passed, failed
    passed, failed = passed + bool(good), failed + (not good)
    if not good:
        print("FAILED: %s %s" % (law, detail), flush=True)
        if os.environ.get("STOP_AT_FIRST"):
            sys.exit(1)


def report(skipped=0):
    """The last line of a test; returns its exit status."""
    print("%d passed, %d failed" % (passed, failed) + (", %d skipped" % skipped if skipped else ""))
    return int(failed > 0)
