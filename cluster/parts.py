#!/usr/bin/env python3
"""The parts of a case from Python: by processes of this machine, joblib, dask or mpi4py.

usage: cluster/parts.py CASE.nml PARTS PASSES [processes | joblib | dask]
       mpiexec -n RANKS python3 -m mpi4py.futures cluster/parts.py CASE.nml PARTS PASSES mpi4py

Each pass makes the next round of numbered work; `psalm --merge` joins the parts and makes what is left. psalm must be in PATH.
"""
import os
import subprocess
import sys


def part(case, number, parts):
    """The exit status of one part."""
    return subprocess.run(["psalm", "--quiet", "--part", "%d/%d" % (number, parts), case], check=False).returncode


def by_processes(function, jobs):
    from concurrent.futures import ThreadPoolExecutor
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # a thread waits for a process
        return list(pool.map(lambda job: function(*job), jobs))


def by_joblib(function, jobs):
    from joblib import Parallel, delayed
    return Parallel(n_jobs=-1)(delayed(function)(*job) for job in jobs)


def by_dask(function, jobs):
    from dask.distributed import Client
    with Client() as client:  # or the address of a scheduler whose workers see the same files
        return client.gather([client.submit(function, *job, pure=False) for job in jobs])


def by_mpi4py(function, jobs):
    from mpi4py.futures import MPIPoolExecutor
    with MPIPoolExecutor() as pool:
        return list(pool.starmap(function, jobs))


WAYS = {"processes": by_processes, "joblib": by_joblib, "dask": by_dask, "mpi4py": by_mpi4py}


def main():
    if len(sys.argv) not in (4, 5) or (len(sys.argv) == 5 and sys.argv[4] not in WAYS):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    case, parts, passes = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    way = WAYS[sys.argv[4] if len(sys.argv) == 5 else "processes"]
    for _ in range(passes):
        status = max(way(part, [(case, k, parts) for k in range(1, parts + 1)]))
        if status:
            return status
    return subprocess.run(["psalm", "--merge", case], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
