"""A sweep over two lengths on all processors: cases are pickled by their text and analysed by worker processes.

usage: many_cases.py [joblib]    by concurrent.futures, or by joblib
"""
import concurrent.futures
import multiprocessing
import sys

import numpy
import psalm


def slider_crank(crank, rod):
    """A slider-crank with an offset of 10, drawn at 30 degrees of its crank."""
    x, y = crank*numpy.cos(numpy.pi/6), crank*numpy.sin(numpy.pi/6)
    pin = x + numpy.sqrt(rod**2 - (10 - y)**2)
    return psalm.from_joints({"O": (0, 0), "B": (x, y), "C": (pin, 10)}, links={"frame": "O", "crank": "O B", "rod": "B C", "block": "C"},
                             slides=[("frame", "block", pin, 10, 0)], drive="O", output="point C", step=2)


def stroke(case):
    """Stroke of the pin."""
    return float(numpy.ptp(case.analyse()["C"].x))


def by_futures(cases):
    # "spawn": a process forked while a thread works may wait for it for ever
    with concurrent.futures.ProcessPoolExecutor(mp_context=multiprocessing.get_context("spawn")) as pool:
        return list(pool.map(stroke, cases))


def by_joblib(cases):
    import joblib
    return joblib.Parallel(n_jobs=-1)(joblib.delayed(stroke)(case) for case in cases)


def main():
    sizes = [(crank, rod) for crank in (30, 40, 50) for rod in (120, 140, 160)]
    cases = [slider_crank(*size) for size in sizes]
    spread = by_joblib if sys.argv[1:] == ["joblib"] else by_futures
    for (crank, rod), found in zip(sizes, spread(cases)):
        print(f"{crank:6.1f}{rod:8.1f}{found:12.5f}")


if __name__ == "__main__":
    main()
