#!/usr/bin/env python3
"""Many cases by one program, spread over processes of this machine, joblib, dask or mpi4py: sweeps, assemblies, proofs, charts.

usage: cluster/cases.py WAY PROGRAM [OPTION ...] CASE.nml ...        WAY: processes, joblib or dask
       mpiexec -n RANKS python3 -m mpi4py.futures cluster/cases.py mpi4py PROGRAM [OPTION ...] CASE.nml ...

Every case is run by itself: CASE.listing is its listing, CASE.remarks its remarks, beside the case or in the folder of --output-dir.
The program must be in PATH. One line for each case that is not done (exit status above 0). Exit status: the highest of the cases.
"""
import os
import shutil
import subprocess
import sys

from parts import WAYS


def run(program, options, case, folder):
    """The exit status of one case."""
    stem = os.path.splitext(case if folder is None else os.path.join(folder, os.path.basename(case)))[0]
    with open(stem + ".listing", "wb") as listing, open(stem + ".remarks", "wb") as remarks:
        return subprocess.run([program, *options, case], stdout=listing, stderr=remarks, check=False).returncode


def main():
    words = sys.argv[1:]
    cases = [word for word in words[2:] if word.endswith(".nml")]
    if len(words) < 3 or words[0] not in WAYS or not cases:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    if not shutil.which(words[1]):
        print("cases.py: there is no program '%s' in PATH" % words[1], file=sys.stderr)
        return 2
    options = [word for word in words[2:] if not word.endswith(".nml")]
    folder = options[options.index("--output-dir") + 1] if "--output-dir" in options[:-1] else None
    statuses = WAYS[words[0]](run, [(words[1], options, case, folder) for case in cases])
    for case, status in zip(cases, statuses):
        if status:
            print("%s: exit status %d" % (case, status))
    return max(statuses)


if __name__ == "__main__":
    sys.exit(main())
