"""Tables of paths without prescribed timing: what bench/app/paths measured, and SciPy on the same problems.

usage: paths.py ROWS DATA SECONDS. ROWS is what the program printed, DATA the folder of the data sets. Prints doc/measured/paths.md. SciPy has
SECONDS for each problem and solver, and a closed form in NumPy; where the crank does not turn by the rule of Grashof the form is large.
"""
import os
import re
import sys
import time

import numpy
import scipy
from scipy.optimize import basinhopping, differential_evolution

EXACT = 1.0e-6            # errors below this part of the path's size count as none


class Problem:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.text = file.read()
        self.name = os.path.splitext(os.path.basename(path))[0]
        self.points = numpy.array([self.numbers("DESX"), self.numbers("DESY")]).T
        self.size = numpy.sqrt(((self.points - self.points.mean(0))**2).sum(1).mean())
        self.limits_angle = float(re.search(r"TANGLE=([0-9.]+)", self.text).group(1)) < 90.0
        self.low, self.high = self.numbers("OPLOW"), self.numbers("OPHIGH")

    def numbers(self, item):
        values = []
        for word in re.search(item + r"=([-+0-9.eE,*\s]+)", self.text).group(1).replace(",", " ").split():
            count, _, value = word.rpartition("*")
            values += [float(value)]*int(count or 1)
        return values

    def exact(self):
        """Sum of squares of errors that do not matter."""
        return len(self.points)*(EXACT*self.size)**2


def closed_form(problem):
    """Sum of squares of four lengths, coupler point, pivot, ground line, inputs and direction; large where the crank does not turn."""
    points = problem.points[:, 0] + 1j*problem.points[:, 1]

    def error(x):
        ground, crank, coupler, follower, u, v, px, py, line = x[:9]
        if coupler + follower < ground + crank or abs(coupler - follower) > abs(ground - crank) or min(x[:4]) <= 0.0:
            return 1.0e6*problem.size**2
        t = x[9] + numpy.copysign(1.0, x[-1])*numpy.concatenate(([0.0], numpy.cumsum(numpy.abs(x[10:-1]))))
        pin = crank*numpy.exp(1j*t)
        h = ground - pin
        d = numpy.maximum(numpy.abs(h), 1.0e-12)
        along = (coupler**2 - follower**2 + d**2)/(2.0*d)
        across = numpy.sqrt(numpy.maximum(coupler**2 - along**2, 0.0))
        link = h/d*(along + 1j*across)/coupler
        path = px + 1j*py + numpy.exp(1j*line)*(pin + (u + 1j*v)*link)
        return float((numpy.abs(path - points)**2).sum() + problem.size**2*max(abs(t[-1] - t[0]) - 2.0*numpy.pi, 0.0)**2)

    n = len(points)
    high = problem.high
    box = [(max(low, 1.0e-3*problem.size), top) for low, top in zip(problem.low[:4], high[:4])]
    box += [(-high[4], high[4])]*2 + [(-high[5], high[5])]*2 + [(0.0, 2.0*numpy.pi)]*2
    return error, box + [(0.0, numpy.pi)]*(n - 1) + [(-1.0, 1.0)]


def rival_of_scipy(problem, which, seconds):
    error, box = closed_form(problem)
    if which == "differential evolution":
        method = lambda call, seed: differential_evolution(call, box, seed=seed, maxiter=10**6, tol=0.0, polish=False)
    else:
        random = numpy.random.default_rng(1)
        low, high = numpy.array(box).T
        first = min((low + random.random(len(box))*(high - low) for _ in range(1000)), key=error)
        method = lambda call, seed: basinhopping(call, first, niter=10**6, seed=seed,
                                                 minimizer_kwargs={"method": "L-BFGS-B", "bounds": box})
    best = numpy.inf
    start = time.process_time()

    class Over(Exception):
        pass

    def call(x):
        nonlocal best
        value = error(x)
        best = min(best, value)
        if time.process_time() - start > seconds:
            raise Over
        return value

    try:
        method(call, 1)
    except Over:
        pass
    return best


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        rows = file.read().strip().splitlines()
    data, seconds = sys.argv[2], float(sys.argv[3])
    print("""# Paths without prescribed timing

Measured by `bench/paths`: processor time, one thread. The search is that of `SOLVER='LSQ', ORDER=2` on `data/paths/` and
`data/path18_free.nml`: a four-bar whose crank turns fully passes points in their order, with the crank turning either way. Nine
dimensions and every input are unknown, in both assemblies. All problems have the same settings, no first guess and 20 seeds. Reached: a linkage
within 1 per cent of the best sum of squares of all runs, or with errors below a millionth of the path's size (exact). A batch is 64 random linkages, of which one is finished; it is one start of psalm (which keeps the assembly of the data set). At most 500 batches were
drawn for a seed; median and worst are those of the seeds that reach the best. `yu20a_angle` requires a transmission angle of at least 40 degrees
over the turn, a limit that its best linkage attains twice a turn; the searches compared below did not have this problem.

| problem | points | best sum of squares | RMS error, of the path's size | seeds that reach it | median, s | worst, s | ms a batch |
| --- | --- | --- | --- | --- | --- | --- | --- |""")
    print("\n".join(rows))
    solvers = "differential evolution", "basin hopping"
    print("""
## The same with SciPy

SciPy %s, %g s of processor time for each: RMS error as a multiple of the best one above (of a millionth of the path's size where that is
exact). The closed form is written in NumPy, for one assembly; the direction of the crank is the sign of a further unknown, and bounds are those of
the data set. This is a spot check, with one run of each.

| problem | %s |
| --- | --- | --- |""" % (scipy.__version__, seconds, " | ".join(solvers)))
    for row in rows:
        name, best = row.split("|")[1].strip(" `"), float(row.split("|")[3])
        path = os.path.join(data, "paths", name + ".nml")
        problem = Problem(path if os.path.exists(path) else os.path.join(data, name + ".nml"))
        if problem.limits_angle:
            continue          # the closed form knows no transmission angle
        least = max(best, problem.exact())
        print("| `%s` | %s |" % (name, " | ".join("%.3g" % numpy.sqrt(rival_of_scipy(problem, which, seconds)/least)
                                                    for which in solvers)))


main()
