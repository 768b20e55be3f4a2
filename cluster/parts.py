#!/usr/bin/env python3
"""The parts of a case from Python: by processes of this machine, joblib, dask or mpi4py.

usage: cluster/parts.py CASE.nml PARTS PASSES [processes | joblib | dask]
       mpiexec -n RANKS python3 -m mpi4py.futures cluster/parts.py CASE.nml PARTS PASSES mpi4py

Each pass makes the next round of numbered work; `psalm --merge` joins the parts and makes what is left. psalm must be in PATH.
"""
import subprocess
import sys


def part(case, number, parts):
    """The exit status of one part."""
    return subprocess.run(["psalm", "--quiet", "--part", "%d/%d" % (number, parts), case], check=False).returncode


def by_processes(case, parts):
    from concurrent.futures import ThreadPoolExecutor
    with ThreadPoolExecutor() as pool:  # a thread waits for a process
        return list(pool.map(lambda k: part(case, k, parts), range(1, parts + 1)))


def by_joblib(case, parts):
    from joblib import Parallel, delayed
    return Parallel(n_jobs=-1)(delayed(part)(case, k, parts) for k in range(1, parts + 1))


def by_dask(case, parts):
    from dask.distributed import Client
    with Client() as client:  # or the address of a scheduler whose workers see the same files
        return client.gather([client.submit(part, case, k, parts, pure=False) for k in range(1, parts + 1)])


def by_mpi4py(case, parts):
    from mpi4py.futures import MPIPoolExecutor
    with MPIPoolExecutor() as pool:
        return list(pool.map(part, [case]*parts, range(1, parts + 1), [parts]*parts))


WAYS = {"processes": by_processes, "joblib": by_joblib, "dask": by_dask, "mpi4py": by_mpi4py}


def main():
    if len(sys.argv) not in (4, 5) or (len(sys.argv) == 5 and sys.argv[4] not in WAYS):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    case, parts, passes = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    way = WAYS[sys.argv[4] if len(sys.argv) == 5 else "processes"]
    for _ in range(passes):
        status = max(way(case, parts))
        if status:
            return status
    return subprocess.run(["psalm", "--merge", case], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
