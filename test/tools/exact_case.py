"""What tests of exact synthesis share: a check with its condition first, and a run of psalm on a case."""
import os
import subprocess

from tally import check


def holds(good, what):
    check(what, good)


def run(programs, text, folder):
    """Exit status, listing and messages of a case."""
    path = os.path.join(folder, "case.nml")
    with open(path, "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(programs, "psalm"), path], capture_output=True, text=True, timeout=120, cwd=folder)
    return done.returncode, done.stdout, done.stderr
