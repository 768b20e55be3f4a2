#!/usr/bin/env python3
"""muscle from outside: sets and masses of force balance, published tables, random linkages, kalm on what muscle writes.

usage: muscle.py BIN   (directory with the programs). The last line is N passed, N failed.
"""
import cmath
import math
import os
import random
import re
import subprocess
import sys
import tempfile

import numpy
from scipy.optimize import differential_evolution, minimize

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from results import cases_of, counterweights, rows_of

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv[1])
passed = failed = 0


def check(right, law, got=""):
    global passed, failed
    if right:
        passed += 1
    else:
        failed += 1
        print("FAILED: %s%s" % (law, "; got %s" % (got,) if got != "" else ""))


def close(got, want, tolerance, law):
    check(abs(got - want) <= tolerance*abs(want) if want else abs(got) <= tolerance, law, "%r instead of %r" % (got, want))


def program(name, text, place, *options):
    """Exit status, listing, standard error."""
    with open(os.path.join(place, "case.nml"), "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([os.path.join(BIN, name), *options, "case.nml"], cwd=place, capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout, done.stderr


def muscle(text, place):
    """Exit status, results, listing, standard error."""
    target = os.path.join(place, "case.muscle.json")
    if os.path.exists(target):
        os.remove(target)
    code, listing, error = program("muscle", text, place, "--json")
    results = {}
    if os.path.exists(target):
        results = counterweights(cases_of(target)[0])
    return code, results, listing, error


def data(name, *changes):
    text = open(os.path.join(TOP, "data", name), encoding="utf-8").read()
    for old, new in changes:
        assert text.count(old) == 1, "%s: %r is there %d times" % (name, old, text.count(old))
        text = text.replace(old, new)
    return text


def frame_force(listing):
    """RMS of the frame force that kalm lists, its components pooled."""
    rows = [line.split() for line in listing.split("\n") if line.startswith((" FRAME FX ", " FRAME FY "))]
    return math.sqrt(sum(float(row[4].replace("D", "E"))**2 for row in rows if row[2] != "ORDER")/2)


def kalm_agrees(place, results, design, law):
    """kalm finds on device 7 what muscle says of its design."""
    text = open(os.path.join(place, "case.muscle.dev7"), encoding="utf-8").read()
    code, listing, error = program("kalm", text.split("\n", 1)[1] if text.startswith("! run") else text, place)
    check(code == 0, "kalm reads what muscle writes: " + law, error)
    check(abs(frame_force(listing) - design["after"]["force"]["rms"]) <= 1e-6*results["before"]["force"]["rms"],
          "kalm's shaking force is muscle's: " + law, frame_force(listing))


# ---- complete force balance --------------------------------------------------------------------------------------------

def needle(place):
    """Ten-bar needle linkage: all sets, the masses of three of them, the linear programme, what a mass buys."""
    code, results, listing, error = muscle(data("muscle/needle_balance.nml"), place)
    check(code == 0, "needle linkage is balanced", error)
    check(results["feasible"] and results["adrift"] == [] and results["counterweights"] == 5, "needle: five weights", results)
    check(results["minimal_sets"] == 71 and len(results["sets"]) == 71, "needle: 71 of 126 sets", results["minimal_sets"])
    check(len({tuple(names) for names in results["sets"]}) == 71, "needle: the sets differ")
    links = ["crank"] + ["arc %d of loop %d" % pair for pair in ((2, 1), (3, 1), (2, 2), (3, 2), (3, 3), (4, 3), (4, 4), (5, 4))]
    bare = results["before"]
    for what, want in (("force", 192.425211), ("moment", 30.704572), ("torque", 7.147433)):
        close(bare[what]["rms"], want, 1e-6, "needle bare, RMS " + what)
    found = {frozenset(links.index(w["link"]) + 1 for w in d["weights"]): d for d in results["designs"]}
    table = {(1, 3, 5, 6, 9): ((.160287, 1.367268, 3.209386, 3.511105, 1.663145), 33.513781, 14.686412),
             (1, 3, 4, 6, 9): ((5.174229, 1.367268, 10.870499, 3.511105, 1.663145), 100.206189, 12.300186),
             (1, 3, 5, 7, 9): ((.160287, 1.292343, .571947, .719489, 1.663145), 22.924657, 11.855030)}
    for names, (masses, moment, torque) in table.items():
        design = found.get(frozenset(names))
        check(design is not None, "needle: weights on %s are listed" % (names,))
        if design is None:
            continue
        got = {links.index(w["link"]) + 1: w["mass"] for w in design["weights"]}
        check(all(abs(got[n] - m) <= 2e-6*max(1, m) for n, m in zip(names, masses)), "needle: masses on %s" % (names,), got)
        close(design["after"]["moment"]["rms"], moment, 1e-6, "needle: moment with weights on %s" % (names,))
        close(design["after"]["torque"]["rms"], torque, 1e-6, "needle: torque with weights on %s" % (names,))
        check(design["after"]["force"]["rms"] < 1e-10, "needle: no force with weights on %s" % (names,))
        check(all(abs(w["distance"] - 60) < 1e-5 for w in design["weights"]), "needle: weights at the full reach")
    check(4.407179 <= results["lightest"]["mass"] <= 4.407532 and results["lightest"]["bound"] >= 4.40717,
          "needle: the linear programme over all links", results["lightest"]["mass"])
    for budget, want in zip(results["budgets"], (192.42521, 110.20973, 64.59095, 21.08015, 10.31802, 2.15927)):
        # the published values are those of a polygon of 360 sides within the circle: a little above
        check(want*(1 - 5e-4) <= budget["force"] <= want*(1 + 1e-6), "needle: force for %g kg" % budget["mass"], budget["force"])
        check(budget["bound"] <= budget["force"]*(1 + 1e-6), "needle: the bound is no higher", budget)
    kalm_agrees(place, results, results["designs"][0], "needle")


def ten_bar(place):
    """The thesis's ten-bar: its sets, that of the thesis among them; all criteria on all links, proven."""
    code, results, _, error = muscle(data("muscle/thesis_ten_bar.nml"), place)
    check(code == 0 and results["counterweights"] == 5 and results["minimal_sets"] == 76, "ten-bar of the thesis: 76 of 126 sets",
          (error, results.get("minimal_sets")))
    check(sorted(["three", "five", "eight", "nine"]) in [sorted(names) for names in results["sets"]], "ten-bar: the thesis's set")
    bare = results["before"]["force"]["rms"]
    check(all(d["after"]["force"]["rms"] <= 1e-10*bare for d in results["designs"]), "ten-bar: no force is left")
    composite = results["composite"]
    check(composite["convex"] and abs(composite["after"] - composite["bound"]) <= 1e-6*composite["after"], "ten-bar: proven", composite)
    kalm_agrees(place, results, results["optimum"], "ten-bar")


def counts(place):
    """Least number of weights and number of sets."""
    table = {"dyad1_crank_rocker": (2, 3), "dyad2_oscillating_cylinder": (2, 2), "dyad3_quick_return": (2, 2),
             "dyad4_slider_crank": (2, 1), "dyad5_turning_block": (2, 2), "dwell": (3, 9)}
    for name, (number, sets) in table.items():
        code, results, _, error = muscle(rule_masses(name), place)
        check(code in (0, 1) and results.get("feasible") is True, name + " can be balanced", error)
        check((results["counterweights"], results["minimal_sets"]) == (number, sets), name + ": number and sets",
              (results["counterweights"], results["minimal_sets"]))
    shaper = data("quick_return.nml")
    code, results, _, error = muscle(
        shaper[shaper.index("QUICK"):] + " &RATES SPEED=60.0, UNITS='REV/MIN' &END\n &MASSES NMASS=5, MNAME='crank O','block','lever L',"
        "'rod B','ram', MASS=1.0,0.2,3.0,1.0,4.0, MDIST=20.0,0.0,150.0,50.0,0.0, MINERT=5*0.001, UNITL=0.001 &END\n"
        " &BALANC WREACH=300.0, WMOST=1000.0 &END\n", place)
    check(code == 0 and (results.get("counterweights"), results.get("minimal_sets")) == (3, 2), "shaper: three weights, two sets",
          (error, results.get("counterweights"), results.get("minimal_sets")))
    check(all(d["after"]["force"]["rms"] <= 1e-9*results["before"]["force"]["rms"] for d in results["designs"]), "shaper: no force is left")
    refused = {"dyad6_scotch_yoke": 1, "dyad7_oldham_coupling": 1, "textile": 1, "actuator_rapson_slide": 2,
               "dyad8_tangent_mechanism": 2, "actuator_davis_steering": 3}
    for name, adrift in refused.items():
        code, results, listing, error = muscle(rule_masses(name), place)
        check(code == 1 and results.get("feasible") is False, name + " is refused", (code, error))
        check(len(results["adrift"]) == adrift, name + ": links adrift", results["adrift"])
        check(all(link in listing and link in error for link in results["adrift"]), name + ": they are named", error)


def rule_masses(name):
    """A data set with masses by a rule: link n has .1 n kg, its centre 10 n units at 10 n degrees from its own arc."""
    case = "\n".join(line for line in data(name + ".nml").split("\n") if not line.startswith("!"))
    if "LAST=0" in case:
        case = case[:case.index("LAST=0")].rstrip(" \n,") + " &END"
    ends = OWN_ENDS[name]
    n = len(ends)
    return case.rstrip() + "\n &RATES SPEED=%s &END\n &MASSES NMASS=%d, MLINK=%s, MLOOP=%s,\n  MASS=%s,\n  MDIST=%s,\n  MANG=%s,\n" \
        "  MINERT=%s, UNITL=0.001 &END\n &BALANC WREACH=60.0 &END\n" % (
            "100.0" if name.startswith("actuator") else "600.0, UNITS='REV/MIN'", n,
            ",".join(str(a) for a, _ in ends), ",".join(str(b) for _, b in ends),
            ",".join("%.1f" % (.1*k) for k in range(1, n + 1)), ",".join("%d.0" % (10*k) for k in range(1, n + 1)),
            ",".join("%d.0" % (10*k) for k in range(1, n + 1)), ",".join("%d.0E-4" % k for k in range(1, n + 1)))


# arc and loop of the input and of each dyad's links, the arc negative where its own end is the start
OWN_ENDS = {
    "dyad1_crank_rocker": ((-1, 1), (-2, 1), (-3, 1)),
    "dyad2_oscillating_cylinder": ((-1, 1), (-2, 1), (-3, 1)),
    "dyad3_quick_return": ((-1, 1), (-2, 1), (3, 1)),
    "dyad4_slider_crank": ((-1, 1), (-2, 1), (-3, 1)),
    "dyad5_turning_block": ((-1, 1), (2, 1), (-3, 1)),
    "dyad6_scotch_yoke": ((-1, 1), (-2, 1), (-3, 1)),
    "dyad7_oldham_coupling": ((-1, 1), (2, 1), (3, 1)),
    "dyad8_tangent_mechanism": ((-1, 1), (2, 1), (-3, 1)),
    "actuator_rapson_slide": ((1, 1), (-2, 1), (3, 1)),
    "actuator_davis_steering": ((1, 1), (-2, 1), (3, 1), (-3, 2), (4, 2)),
    "dwell": ((-1, 1), (-2, 1), (-3, 1), (-3, 2), (-4, 2)),
    "textile": ((-1, 1), (-2, 1), (-3, 1), (2, 2), (3, 2), (-4, 3), (-5, 3), (-3, 4), (-4, 4))}


# ---- optimum counterweights ----------------------------------------------------------------------------------------------

def example_10u(place):
    """Haines's example: discs and loads as printed, then less with bodies no heavier."""
    code, results, listing, error = muscle(data("muscle/haines_10u.nml"), place)
    check(code == 0, "10U runs", error)
    close(results["composite"]["after"], 167.436, 1e-5, "10U: objective")
    check(results["composite"]["bound"] <= results["composite"]["after"]*(1 + 1e-9), "10U: the bound is no higher")
    loads = results["optimum"]["after"]
    for what, want in (("force", .14484), ("moment", 1.5111), ("torque", .49657)):
        close(loads[what]["rms"], want, 5e-5, "10U: RMS " + what)
    printed = {"IN": (24.456, 6.0748), "S1": (67.344, 58.829), "M1": (11.416, 12.009), "E1": (24.417, 6.0446)}
    for joint, (x, y) in printed.items():
        close(loads["joints"][joint]["rms_x"], x, 1e-4, "10U: joint %s, x" % joint)
        close(loads["joints"][joint]["rms_y"], y, 1e-4, "10U: joint %s, y" % joint)
    bare = results["before"]["joints"]
    for joint, (x, y) in {"IN": (8.7821, 21.069), "M1": (2.2400, 11.197), "E1": (7.8765, 4.9995)}.items():
        close(bare[joint]["rms_x"], x, 1e-4, "10U bare: joint %s, x" % joint)
        close(bare[joint]["rms_y"], y, 1e-4, "10U bare: joint %s, y" % joint)
    # x, y in the thesis's axes; those of the rocker begin at its pivot, against the arc
    discs = {"crank": (-.0064679, -.0014698, .1), "arc 2 of loop 1": (-.0062665, -.0525577, .05293),
             "arc 3 of loop 1": (.0337734, -.0347102, .0484297)}
    for weight in results["optimum"]["weights"]:
        x, y, radius = discs[weight["link"]]
        centre = cmath.rect(weight["distance"], math.radians(weight["angle"]))
        check(abs(centre - complex(x, y)) < 3e-6 and abs(weight["radius"] - radius) < 2e-6, "10U: disc on " + weight["link"], weight)
    kalm_agrees(place, results, results["optimum"], "10U")
    exact = data("muscle/haines_10u.nml", ("TOLF=1.0, TOLM=1.0", "TOLM=1.0, IEXACT=1"))
    code, results, listing, error = muscle(exact, place)
    close(results["optimum"]["after"]["moment"]["rms"], 1.5390, 1e-4, "10U, no force: moment")
    check(results["optimum"]["after"]["force"]["rms"] < 1e-6, "10U, no force", results["optimum"]["after"]["force"])
    code, results, listing, error = muscle(data("muscle/haines_bodies.nml"), place)
    check(code == 0 and results["composite"]["convex"], "bodies: a convex problem", error)
    check(results["composite"]["after"] < 0.5*167.436, "bodies no heavier than the discs do better", results["composite"])
    masses = {w["link"]: w["mass"] for w in results["optimum"]["weights"]}
    check(masses["crank"] <= 12.3*(1 + 1e-6) and masses["arc 2 of loop 1"] <= 1.378*(1 + 1e-6), "bodies keep their limits", masses)
    front = results["front"]
    check(all(a["first"] <= b["first"]*(1 + 1e-6) and a["second"] >= b["second"] for a, b in zip(front, front[1:])),
          "along a front one criterion falls and the other rises", front)
    check(all(p["bound"] <= p["first"]*(1 + 1e-6) + 1e-9 for p in front), "points of a front are proven")


def four_bar_rows():
    """Shaking force and moment of Haines's four-bar by (m, mx, my, I) of coupler, crank and rocker about A, O and C: his chapter 9,
    the speed held by a flywheel. Shape (4, 216, 4): bare in the first place."""
    l1, l2, l3, l4, w = .25, .05, .20, .275, 10*math.pi
    rows = numpy.zeros((4, 3, 72, 4))
    for k in range(72):
        th = math.radians(5*k)
        a = l2*cmath.exp(1j*th)
        ac = l1 - a
        t3 = cmath.phase(ac) + math.acos((l3**2 + abs(ac)**2 - l4**2)/(2*l3*abs(ac)))
        t4 = cmath.phase(a + l3*cmath.exp(1j*t3) - l1)
        # a + l3 e3 = l1 + l4 e4, derived twice
        e3, e4 = cmath.exp(1j*t3), cmath.exp(1j*t4)
        m = numpy.array([[(1j*l3*e3).real, -(1j*l4*e4).real], [(1j*l3*e3).imag, -(1j*l4*e4).imag]])
        da = 1j*a*w
        w3, w4 = numpy.linalg.solve(m, [-da.real, -da.imag])
        rest = -(-a*w*w) + l3*e3*w3**2 - l4*e4*w4**2
        a3, a4 = numpy.linalg.solve(m, [rest.real, rest.imag])
        for link, (origin, va, aa, angle, om, al) in enumerate(((a, da, -a*w*w, t3, w3, a3), (0, 0, 0, th, w, 0.0),
                                                                 (l1, 0, 0, t4, w4, a4)), 1):
            va, aa, origin = complex(va), complex(aa), complex(origin)
            c, s = math.cos(angle), math.sin(angle)
            fx = numpy.array([-aa.real, om**2*c + al*s, -om**2*s + al*c, 0])
            fy = numpy.array([-aa.imag, om**2*s - al*c, om**2*c + al*s, 0])
            mz = numpy.array([0, aa.real*s - aa.imag*c, aa.real*c + aa.imag*s, -al])
            growth = numpy.array([va.real*aa.real + va.imag*aa.imag,
                                  al*(-va.real*s + va.imag*c) + om*(-aa.real*s + aa.imag*c) - om**2*(va.real*c + va.imag*s),
                                  al*(-va.real*c - va.imag*s) + om*(-aa.real*c - aa.imag*s) + om**2*(va.real*s - va.imag*c), om*al])
            rows[link, :, k, :] = fx, fy, mz + origin.real*fy - origin.imag*fx + growth/w
    return rows.reshape(4, 216, 4)


def global_least(bare, bodies, most, reach, seeds):
    """Least sum of squares that a global search finds for one body on each link.

    bodies: by link, the columns of loads for a mass, its moments along x and y, an inertia; most: greatest mass of each; reach: of
    the circle that a body stays in. The sum is a quadratic form of the bodies: its matrix is made once.
    """
    columns = numpy.column_stack([bare] + [column for body in bodies for column in body])
    form = columns.T @ columns

    def objective(x):
        mass, out, turn, spread = (x[k::4] for k in range(4))
        mass, out, turn = mass*numpy.reshape(most, (-1, 1)), reach*out, 2*math.pi*turn
        body = numpy.stack([mass, mass*out*numpy.cos(turn), mass*out*numpy.sin(turn), mass*(out**2 + spread*(reach**2 - out**2))], axis=1)
        all_of = numpy.concatenate([numpy.ones((1, x.shape[1])), body.reshape(-1, x.shape[1])])
        return numpy.einsum("is,is->s", all_of, form @ all_of)

    return min(differential_evolution(objective, [(0, 1)]*(4*len(bodies)), seed=seed, popsize=12, maxiter=300, tol=0, vectorized=True,
                                      updating="deferred").fun for seed in range(seeds))


def against_global_search(place):
    """The convex optimum against an independent model and a global search over the same bodies."""
    rows = four_bar_rows()
    bare = rows[1] @ [.33235, .033235, 0, .001278 + .33235*.01] + rows[3] @ [.47445, .47445*.1375, 0, .00405 + .47445*.1375**2]
    close(math.sqrt(numpy.mean(bare[:144]**2)), 16.494, 5e-5, "independent model: bare force")
    code, results, _, error = muscle(data("muscle/haines_bodies.nml"), place)
    most = {"arc 2 of loop 1": 1.378, "crank": 12.3, "arc 3 of loop 1": 2.887}
    value = bare.copy()
    for w in results["optimum"]["weights"]:
        link = list(most).index(w["link"]) + 1
        centre = cmath.rect(w["distance"], math.radians(w["angle"]))*(-1 if link == 3 else 1)
        value += rows[link] @ [w["mass"], w["mass"]*centre.real, w["mass"]*centre.imag, w["inertia"] + w["mass"]*abs(centre)**2]
    close(results["composite"]["after"], value @ value, 1e-6, "independent model: composite")

    best = global_least(bare, [rows[link].T for link in (1, 2, 3)], list(most.values()), .1, 3)
    check(results["composite"]["after"] <= best*(1 + 1e-9), "no global search gets below the convex optimum", best)


def limits_and_desires(place):
    """Limits of places and loads, desired loads and a given start against the independent model, closed forms and kalm."""
    rows = four_bar_rows()
    bare = rows[1] @ [.33235, .033235, 0, .001278 + .33235*.01] + rows[3] @ [.47445, .47445*.1375, 0, .00405 + .47445*.1375**2]
    names = ["arc 2 of loop 1", "crank", "arc 3 of loop 1"]
    # what known bodies on coupler, crank and rocker do is desired: they come out again
    known = ([.5, .01, -.02, .002], [2.0, -.01, .03, .004], [1.5, -.02, -.015, .003])
    desired = bare + sum(rows[link] @ body for link, body in enumerate(known, 1))
    lists = ",\n".join("%s=%s" % (item, ",\n".join("%.17g" % v for v in desired[72*k:72*k + 72]))
                       for k, item in enumerate(("DESFX", "DESFY", "DESMOM")))
    case = data("muscle/haines_10u.nml", ("WFORM='DISC', WDENS=7833.0, WREACH=0.8", "WFORM='BODY', WREACH=0.2"),
                ("TOLM=1.0", "TOLM=1.0, " + lists),
                ("  WRLOW=0.1,0.03,0.03, WRHIGH=0.1,0.6,0.6, WTLOW=0.05,0.02,0.05, WTHIGH=0.05,0.02,0.05,\n", ""))
    code, results, listing, error = muscle(case, place)
    check(code == 0 and results["composite"]["after"] <= 1e-8*(desired @ desired), "bodies that do what is desired are found", (error, results))
    code, results, listing, error = muscle(case.replace("DESFX=", "DESFX=1.0,"), place)
    check(code == 2 and "DESFX" in error and "at most 72" in error, "desired values for more than all positions are refused", error)

    # boxes and a limit of the force: the same convex problem by sequential quadratic programming
    low, high = numpy.array([[-.03, -.08], [-.04, 0], [0, -.08]]), numpy.array([[.03, .08], [0, .03], [.06, .08]])
    most, reach, limit = numpy.array([1.5, 6, 3]), .1, 1.0
    case = data("muscle/haines_bodies.nml", ("TOLM=1.0", "TOLM=1.0, MAXF=1.0, WXLOW=-0.04,-0.03,0.0, WXHIGH=0.0,0.03,0.06,"
                " WYLOW=0.0,-0.08,-0.08, WYHIGH=0.03,0.08,0.08"), ("WMOST=12.3,1.378,2.887", "WMOST=6.0,1.5,3.0"))
    case = case[:case.index("  NFRONT")].rstrip().rstrip(",") + " &END\n"
    code, results, listing, error = muscle(case, place)
    check(results["composite"]["convex"], "limits of places and loads leave a convex problem", error)
    check(results["optimum"]["after"]["force"]["peak"] <= limit*(1 + 1e-6), "the limit of the force is kept", results["optimum"]["after"])
    check(abs(results["optimum"]["after"]["force"]["peak"] - limit) < 1e-4, "and is reached", results["optimum"]["after"])
    for w in results["optimum"]["weights"]:
        at = cmath.rect(w["distance"], math.radians(w["angle"]))
        k = names.index(w["link"])
        check(low[k][0] - 2e-7 <= at.real <= high[k][0] + 2e-7 and low[k][1] - 2e-7 <= at.imag <= high[k][1] + 2e-7,
              "the weight on %s is in its box" % w["link"], at)
    # muscle counts the rocker's axes from its own arc, which ends where the model's begins
    model = numpy.concatenate([rows[link]*[1, s, s, 1] for link, s in ((1, 1), (2, 1), (3, -1))], axis=1)
    scale = numpy.concatenate([[m, m*reach, m*reach, m*reach**2] for m in most])

    def objective(x):
        value = bare + model @ (scale*x)
        return value @ value, 2*scale*(model.T @ value)

    def room(x):
        out = []
        for k in range(3):
            m, px, py, inertia = x[4*k:4*k + 4]
            out += [m*inertia - px**2 - py**2, m - inertia, 1 - m, m]
            for p, axis in ((px, 0), (py, 1)):
                out += [high[k][axis]/reach*m - p, p - low[k][axis]/reach*m]
        force = (bare + model @ (scale*x))[:144].reshape(2, 72)
        return numpy.concatenate([out, limit**2 - (force**2).sum(axis=0)])

    found = minimize(lambda x: objective(x)[0]/1e3, [.5, -.1, 0, .2]*3, jac=lambda x: objective(x)[1]/1e3, method="SLSQP",
                     constraints={"type": "ineq", "fun": room}, options={"maxiter": 500, "ftol": 1e-14})
    check(room(found.x).min() > -1e-7, "the other method finds allowed bodies", found.message)
    check(results["composite"]["after"] <= found.fun*1e3*(1 + 1e-6), "no allowed bodies that it finds are better", found.fun)
    close(results["composite"]["after"], found.fun*1e3, 1e-3, "limits of places and loads: nearly the same optimum by another method")

    # complete balance with one counterweight nearer the pivot: its mass by the lever
    free = muscle(data("muscle/haines_10u.nml"), place)[1]["designs"]
    near = data("muscle/haines_10u.nml", ("WREACH=0.8,", "WREACH=0.8, WXLOW=-0.05,-0.8,-0.8,"))
    near = muscle(near, place)[1]["designs"]
    for outer in free:
        links = {w["link"] for w in outer["weights"]}
        inner = next((d for d in near if {w["link"] for w in d["weights"]} == links), None)
        check(inner is not None and inner["after"]["force"]["rms"] < 1e-9, "complete balance in a box", near)
        if inner is None or "crank" not in links:
            continue
        far, close_by = ({w["link"]: w for w in d["weights"]}["crank"] for d in (outer, inner))
        check(abs(close_by["distance"]*math.cos(math.radians(close_by["angle"])) + .05) < 1e-6, "the crank's weight is at its limit", close_by)
        close(close_by["mass"]*.05, far["mass"]*far["distance"]*-math.cos(math.radians(far["angle"])), 2e-5, "mass times distance stays")
    # loads of joints that kalm finds on device 7
    code, results, listing, error = muscle(data("muscle/haines_limits.nml"), place)
    check(code == 0 and abs(results["optimum"]["after"]["joints"]["A"]["peak"] - 45.0) < 1e-4, "the limit of a joint is reached", error)
    check(results["composite"]["after"] - results["composite"]["bound"] <= 1e-6*results["composite"]["after"], "and the optimum proven")
    text = open(os.path.join(place, "case.muscle.dev7"), encoding="utf-8").read().split("\n", 1)[1]
    code, listing, error = program("kalm", text, place)
    check(code == 0, "kalm reads the weights within limits", error)
    joints = kalm_columns(place, [joint + part for joint in "OABC" for part in ("_fx", "_fy")]).reshape(-1, 4, 2)
    peaks = numpy.sqrt((joints**2).sum(axis=2)).max(axis=0)
    check(abs(peaks[1] - 45.0) < 1e-4 and peaks.max() < 45.0001, "kalm finds the joints within their limits", peaks)
    free_case = data("muscle/haines_limits.nml", (", BMAX=4*45.0", ", BTOL=4*1.0E6"))
    free = muscle(free_case, place)[1]
    check(free["optimum"]["after"]["joints"]["A"]["peak"] > 45.1, "without the limit the joint bears more", free["optimum"]["after"])
    lightest = data("muscle/haines_limits.nml", ("TOLF=1.0, TOLM=1.0, TOLT=0.2, DESDRV=0.1, MAXF=5.0", "MAXF=20.0"))
    code, results, listing, error = muscle(lightest, place)
    check(code == 0 and "LEAST ADDED MASS" in listing and abs(results["optimum"]["after"]["force"]["peak"] - 20.0) < 1e-4,
          "loads have limits only: the least mass that keeps them", error)
    old = "TOLF=1.0, TOLM=1.0, TOLT=0.2, DESDRV=0.1, MAXF=5.0, BNAME='O','A','B','C', BMAX=4*45.0"
    code, results, listing, error = muscle(data("muscle/haines_limits.nml", (old, "IEXACT=1, MAXM=9.0")), place)
    after = results["optimum"]["after"]
    check(code == 0 and after["force"]["peak"] < 1e-9 and after["moment"]["peak"] < 9.0*(1 + 1e-6),
          "force balance stays complete where the limits ask for no weight", (error, after))
    masses = [muscle(data("muscle/haines_limits.nml", (old, words)), place)[1]["optimum"]["mass"] for words in ("TOLW=0.01, MAXF=10.0", "TOLW=1.0, MAXF=10.0")]
    check(abs(masses[0] - masses[1]) < 1e-6, "the tolerance of the mass does not say whether limits can be kept", masses)
    impossible = data("muscle/haines_limits.nml", ("BMAX=4*45.0", "BMAX=4*1.0"))
    code, results, listing, error = muscle(impossible, place)
    check(code == 1 and "no weights within WREACH, WMOST" in error, "limits that nothing keeps", (code, error))

    # a given start is where the search begins: at the optimum one start stays there, in a far corner another optimum may wait
    start = ("TOLM=1.0", "TOLM=1.0, NWSTRT=1, WXSTRT=-0.006,-0.006,0.034, WYSTRT=-0.0015,-0.0526,-0.0347, WRSTRT=0.1,0.053,0.048")
    code, results, listing, error = muscle(data("muscle/haines_10u.nml", start), place)
    close(results["composite"]["after"], 167.436, 1e-5, "10U from a given start")
    corner = (start[0], start[1].replace("-0.0526", "0.7"))
    check(muscle(data("muscle/haines_10u.nml", corner), place)[1]["composite"]["after"] != results["composite"]["after"],
          "another start takes another way")
    code, results, listing, error = muscle(data("muscle/haines_10u.nml", (start[0], start[1].replace("WRSTRT=0.1", "WRSTRT=9.0"))), place)
    check(code == 2 and "WRSTRT" in error and "entry 1: the start is not between WRLOW and WRHIGH" in error,
          "a start outside the limits of the radius", error)


def contact(place):
    """What becomes of contact with each choice of weights: as bridge finds it on device 7; what is left out and how it is ranked."""
    def bridge(text):
        code, listing, error = program("bridge", text, place, "--json")
        check(code in (0, 1), "bridge reads what muscle writes", error)
        blocks = cases_of(os.path.join(place, "case.bridge.json"))[0]
        rows = blocks["preload"]
        ratios = [min([h/b for h, b in zip(rows["h1"], rows[border]) if b > 0], default=None) for border in ("h1_passage", "h1_any")]
        return min(rows["h1"]), ratios[0], ratios[1], [v.startswith("contact lost in the passage") for v in blocks["losses"]["verdict"]].count(True)

    def by_outcome():
        return {row["outcome"]: row for row in rows_of(cases_of(os.path.join(place, "case.muscle.json"))[0]["contact"])}

    filtered = data("muscle/haines_contact.nml")
    all_of = filtered.replace("WCLEAR='PASSAGE'", "WCLEAR='LIST'").replace("TOLF=1.0, TOLM=0.1, ", "")
    for case, outcome in ((all_of, "design 1"), (filtered, "optimum")):
        code, results, listing, error = muscle(case, place)
        rows = by_outcome()
        text = open(os.path.join(place, "case.muscle.dev7"), encoding="utf-8").read().split("\n", 1)[1]
        for name, found in (("before", bridge(case[:case.index(" &BALANC")] + case[case.index(" &CLEAR"):])), (outcome, bridge(text))):
            row = rows[name]
            check(all(abs(row[k]/v - 1) < 1e-6 for k, v in zip(("h1", "over_passage", "over_any"), found)), "contact as bridge finds it: " + name,
                  (row, found))
            check(row["lost_in_passage"] == found[3] and row["lost_in_passage"] <= row["lost"], "losses in the passage: " + name, (row, found))
    rows = by_outcome()
    check([name for name in rows if name.startswith("design")] == ["design 1"] and "LEFT OUT" in listing, "a design that loses contact is left out", rows)
    muscle(all_of, place)
    listed = by_outcome()
    check(listed["design 1"]["over_passage"] > 1 > listed["design 2"]["over_passage"], "designs are ranked by contact", listed)
    code, results, listing, error = muscle(filtered.replace("WCLEAR='PASSAGE'", "WCLEAR='ANY'"), place)
    check(code == 1 and "loses contact" in error and results["designs"] == [], "all designs lose contact after the passage", (code, error))
    by_loops = data("muscle/haines_10u.nml", ("TOLF=1.0, TOLM=1.0 &END", "WCLEAR='LIST' &END\n &CLEAR CLINK=2, CLOOP=1, CDIAM=0.002 &END"))
    code, results, listing, error = muscle(by_loops, place)
    row = by_outcome()["before"]
    check(code == 0 and abs(row["h1"]/listed["before"]["h1"] - 1) < 1e-5, "a case by loops: the same contact", (error, row))
    for old, new, item in ((" &CLEAR", " &USERCLR", "WRANK"), ("CDIAM=0.002", "CDIAM=-1.0", "CDIAM"), ("CNAME='B'", "CNAME='Q'", "Q")):
        code, _, _, error = muscle(filtered.replace(old, new), place)
        check(code == 2 and item in error, "bad input: %s" % new, (code, error))


def kalm_rows(case, place):
    """Force on the frame and moment at every position, by kalm: shape (positions, 3)."""
    code, listing, error = program("kalm", case, place)
    check(code == 0, "kalm runs for the rows of an independent model", error)
    return kalm_columns(place, ["frame_fx", "frame_fy", "frame_m"])


def kalm_columns(place, wanted):
    """Columns of the table that kalm wrote: shape (positions, columns)."""
    rows = [line for line in open(os.path.join(place, "case.kalm.dev9"), encoding="utf-8")]
    names = next(row for row in rows if " drive " in row).lstrip("#").split()
    chosen = [names.index(name) for name in wanted]
    return numpy.array([[float(row.split()[k]) for k in chosen] for row in rows
                        if row.strip() and not row.startswith("#") and len(row.split()) == len(names)])


def against_global_searches(place):
    """A slider-crank and a six-bar: no global search over bodies, their loads taken from kalm, gets below the convex optimum."""
    for name, links, reach, most in (("dyad4_slider_crank", ((-1, 1), (-2, 1)), 30.0, .6),
                                     ("dwell", ((-1, 1), (-3, 1), (-4, 2)), 1.5, 2.0)):
        case = rule_masses(name)
        bare_case = case[:case.index(" &BALANC")]
        case = bare_case + " &BALANC NWEIGH=%d, WLINK=%s, WLOOP=%s, WFORM='BODY', WREACH=%.1f, WMOST=%.1f, TOLF=1.0, TOLM=0.1 &END\n" % (
            len(links), ",".join(str(a) for a, _ in links), ",".join(str(b) for _, b in links), reach, most)
        code, results, listing, error = muscle(case, place)
        check(code in (0, 1) and results.get("composite", {}).get("convex") is True, name + ": a convex composite", error)
        weight = numpy.repeat([[1.0, 1.0, 10.0]], len(kalm_rows(bare_case, place)), axis=0).ravel()
        bare = weight*kalm_rows(bare_case, place).ravel()
        masses = bare_case.index("NMASS=")
        n = int(bare_case[masses + 6:bare_case.index(",", masses)])

        def with_mass(link, distance, angle, inertia):
            changed = bare_case.replace("NMASS=%d," % n, "NMASS=%d," % (n + 1))
            for item, value in (("MLINK", link[0]), ("MLOOP", link[1]), ("MASS", 1.0), ("MDIST", distance), ("MANG", angle),
                                ("MINERT", inertia)):
                changed = re.sub(r"(\b%s=(?:[^A-Z&]|E[-+])*?)(,?\s*(?:[A-Z]+=|&END))" % item, lambda m: "%s,%r%s" % (m.group(1), value, m.group(2)),
                                 changed, count=1)
            return weight*kalm_rows(changed, place).ravel() - bare

        basis = []
        for link in links:
            mass = with_mass(link, 0.0, 0.0, 0.0)
            spin = with_mass(link, 0.0, 0.0, 1.0) - mass
            along = [(with_mass(link, 1000*reach, turn, 0.0) - mass - reach**2*spin)/reach for turn in (0.0, 90.0)]
            basis.append((mass, along[0], along[1], spin))

        def load(link, mass, out, turn, inertia):
            m, x, y, spin = basis[link]
            return mass*(m + out*(math.cos(turn)*x + math.sin(turn)*y)) + (inertia + mass*out**2)*spin

        value = bare.copy()
        for w in results["optimum"]["weights"]:
            k = [i for i, (arc, loop) in enumerate(links) if w["link"] in ("arc %d of loop %d" % (-arc, loop), "crank" if arc == -1 else "")][0]
            value += load(k, w["mass"], w["distance"]/1000, math.radians(w["angle"]), w["inertia"])
        close(results["composite"]["after"], value @ value, 1e-6, name + ": composite from kalm's loads")
        best = global_least(bare, basis, [most]*len(links), reach/1000, 2)
        check(results["composite"]["after"] <= best*(1 + 1e-9), name + ": no global search gets below the convex optimum",
              (results["composite"]["after"], best))


# ---- random linkages -----------------------------------------------------------------------------------------------------

def random_linkages(place):
    """Six-bar linkages of random dimensions and masses: nothing of the force is left; yokes are refused by name."""
    draw = random.Random(11)
    for seed in range(12):
        frame = draw.uniform(80, 120)
        crank = draw.uniform(.15, .3)*frame
        coupler, rocker = draw.uniform(.8, 1.1)*frame, draw.uniform(.6, .9)*frame
        if crank + max(frame, coupler) > min(frame, coupler) + rocker or coupler + rocker < frame + crank:
            coupler, rocker = frame, .8*frame
        lengths = crank, coupler, rocker, frame
        # a second dyad from a point of the rocker's arc to a pivot of the frame
        q, p = draw.uniform(1.2, 1.6)*frame, draw.uniform(1.2, 1.6)*frame
        n = 5
        text = "RANDOM SIX-BAR\n &LINKS NLOOP=2, MAXARC=5, ILINK=1,-2,-3,4,0, 1,-2,-3,-4,-4, ILOOP=1,0,0,1,0, 1,1,0,0,1,\n" \
            "  ARCL=%.6f,%.6f,%.6f,%.6f,0.0, %.6f,%.6f,%.6f,%.6f,%.6f,\n  GAMA=3*0.0,180.0,0.0, 0.0,%.3f,2*0.0,%.3f,\n" \
            "  NOUTLK=4, NOUTLP=2 &END\n &METHOD MOTION=1, IKIN=10 &END\n &LIMITS TANGLE=90.0 &END\n" % (
                *lengths, crank, draw.uniform(.3, .9)*coupler, p, q, draw.uniform(.8, 1.4)*frame, draw.uniform(-20, 20),
                draw.uniform(150, 210))
        text += " &RATES SPEED=300.0, UNITS='REV/MIN' &END\n &MASSES NMASS=%d, MLINK=-1,-2,-3,-3,-4, MLOOP=1,1,1,2,2,\n" \
            "  MASS=%s,\n  MDIST=%s,\n  MANG=%s,\n  MINERT=%s, UNITL=0.001 &END\n &BALANC WREACH=%.1f, NLIST=20 &END\n" % (
                n, ",".join("%.3f" % draw.uniform(.1, 2) for _ in range(n)), ",".join("%.3f" % draw.uniform(5, 90) for _ in range(n)),
                ",".join("%.2f" % draw.uniform(0, 360) for _ in range(n)), ",".join("%.6f" % draw.uniform(0, .01) for _ in range(n)),
                draw.uniform(40, 90))
        code, results, _, error = muscle(text, place)
        if "failure_at" in results:
            continue
        check(results["feasible"] and results["counterweights"] == 3, "random six-bar %d: three weights" % seed, error)
        bare = results["before"]["force"]["rms"]
        for design in results["designs"]:
            check(design["after"]["force"]["rms"] <= 1e-10*bare, "random six-bar %d: no force is left" % seed, design["after"]["force"])
            check(design["mass"] - design["bound"] <= 1e-8*design["mass"], "random six-bar %d: the bound proves the mass" % seed)
            check(results["lightest"]["mass"] <= design["mass"]*(1 + 1e-8), "random six-bar %d: lightest of all" % seed)
        if results["designs"]:
            kalm_agrees(place, results, results["designs"][0], "random six-bar %d" % seed)


def random_adrift(place):
    """Yokes, couplings and slotted arms of random dimensions and masses: the links adrift are named."""
    draw = random.Random(23)
    for name, adrift in (("dyad6_scotch_yoke", 1), ("dyad7_oldham_coupling", 1), ("dyad8_tangent_mechanism", 2)):
        for _ in range(5):
            case = rule_masses(name)
            at = case.index("ARCL=") + 5
            end = case.index("GAMA=")
            lengths = [v if float(v) == 0.0 else "%.6f" % (float(v)*draw.uniform(.98, 1.02)) for v in re.findall(r"[-\d.E+]+", case[at:end])]
            case = case[:at] + ",".join(lengths) + ", " + case[end:]
            for item, low, high in (("MASS", .1, 3.0), ("MDIST", 1.0, 90.0), ("MANG", -180.0, 180.0)):
                case = re.sub(r"(\s%s=)([^A-Z]*)" % item, lambda m: m.group(1) + ",".join(
                    "%.4f" % draw.uniform(low, high) for _ in m.group(2).strip(", \n").split(",")) + ",\n  ", case, count=1)
            code, results, listing, error = muscle(case, place)
            check(code == 1 and results.get("feasible") is False and len(results["adrift"]) == adrift,
                  "random " + name + ": refused", (code, error[:300]))
            check(all(link in listing and link in error for link in results.get("adrift", ["?"])), "random " + name + ": named", error)


# ---- hard cases ----------------------------------------------------------------------------------------------------------

def hard_cases(place):
    """Parallelogram, no reach, nothing to balance, two runs, one link alone."""
    arms = " &RATES SPEED=600.0, UNITS='REV/MIN' &END\n &MASSES NMASS=3, MLINK=-1,-2,-3, MLOOP=3*1, MASS=0.4,0.9,0.5,\n" \
        "  MDIST=20.0,30.0,25.0, MANG=0.0,10.0,5.0, MINERT=3*1.0E-4, UNITL=0.001 &END\n"
    parallelogram = "PARALLELOGRAM\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=1,0,0,1,\n  ARCL=40.0,100.0,40.0,100.0, " \
        "GAMA=3*0.0,180.0, NOUTLK=2, NOUTLP=1 &END\n &METHOD MOTION=1, CRNKI=10.0, NDES=40, DELT=%s &END\n" \
        " &LIMITS TANGLE=90.0 &END\n" % ",".join("%.1f" % (4*k) for k in range(40))
    code, results, _, error = muscle(parallelogram + arms + " &BALANC WREACH=50.0 &END\n", place)
    check(code == 0 and results["counterweights"] == 1, "parallelogram: one weight does", (code, results.get("counterweights"), error))
    check(results["minimal_sets"] == 2, "parallelogram: on either of the links that turn", results["sets"])
    check(all(d["after"]["force"]["rms"] <= 1e-10*results["before"]["force"]["rms"] for d in results["designs"]),
          "parallelogram: no force is left")
    kite = parallelogram.replace("PARALLELOGRAM", "KITE").replace("ARCL=40.0,100.0,40.0,100.0", "ARCL=40.0,40.0,100.0,100.0").replace(
        "CRNKI=10.0", "CRNKI=90.0")
    code, results, _, error = muscle(kite + arms + " &BALANC WREACH=90.0, WMOST=1000.0 &END\n", place)
    check(code == 0 and (results.get("counterweights"), results.get("minimal_sets")) == (2, 3), "kite: two weights, three sets",
          (code, results.get("counterweights"), results.get("minimal_sets"), error))
    check(results["designs"] and all(d["after"]["force"]["rms"] <= 1e-9*results["before"]["force"]["rms"] for d in results["designs"]),
          "kite: no force is left")
    four_bar = data("muscle/haines_bodies.nml")
    code, results, listing, error = muscle(four_bar.replace("WREACH=0.1", "WREACH=3*0.0"), place)
    check(code == 1 and results["feasible"] is False and results["allowed"] == [], "no reach: no weights", error)
    weightless = four_bar.replace("MASS=0.33235,0.47445", "MASS=2*0.0").replace("MINERT=0.001278,0.00405", "MINERT=2*0.0")
    code, results, listing, error = muscle(weightless, place)
    check(code == 0 and results["feasible"] and results["before"]["force"]["rms"] == 0.0, "no masses: balanced already", error)
    first = muscle(data("muscle/haines_10u.nml"), place)
    check(muscle(data("muscle/haines_10u.nml"), place) == first, "the same starts, the same result")
    only_rocker = data("muscle/haines_10u.nml", ("NWEIGH=3, WLINK=-1,-2,3, WLOOP=3*1", "NWEIGH=1, WLINK=3, WLOOP=1"),
                      ("WRLOW=0.1,0.03,0.03, WRHIGH=0.1,0.6,0.6, WTLOW=0.05,0.02,0.05, WTHIGH=0.05,0.02,0.05",
                       "WRLOW=0.03, WRHIGH=0.6, WTLOW=0.05, WTHIGH=0.05"))
    code, results, listing, error = muscle(only_rocker, place)
    check(code == 1 and results["feasible"] is False and results["cannot_balance"], "one link cannot balance all", results)
    # torque alone: weights whose first moments do nothing leave a flat valley
    flat = four_bar.replace("TOLF=1.0, TOLM=1.0", "TOLT=0.01")
    code, results, listing, error = muscle(flat, place)
    check(code == 0 and results["composite"]["after"] <= results["composite"]["before"], "torque alone: a flat valley", error)
    peak = four_bar.replace("TOLF=1.0, TOLM=1.0", "TOLF=1.0, TOLM=0.2, WCRIT='PEAK'")
    code, results, listing, error = muscle(peak, place)
    loads = results["optimum"]["after"]
    close(results["composite"]["after"], max(loads["force"]["peak"], loads["moment"]["peak"]/.2), 1e-6, "peaks: the greatest over its tolerance")
    check(results["composite"]["after"] - results["composite"]["bound"] <= 1e-6*results["composite"]["after"], "peaks: proven", results["composite"])


def bad_input(place):
    """Mistakes end with status 2 and a message that names the item."""
    good = data("muscle/haines_bodies.nml")
    for old, new, item in (("WREACH=0.1, ", "", "WREACH"), ("WREACH=0.1", "WREACH=-0.1", "WREACH"), ("'BODY'", "'CUBE'", "WFORM"),
                           ("WLINK=-1,-2,3", "WLINK=-1,-2,4", "WLINK"), ("WLINK=-1,-2,3", "WLINK=-1,-2,2", "WLINK"),
                           ("WLINK=-1,-2,3", "WLINK=-1,-2,9", "WLINK"), ("TOLF=1.0", "TOLF=-1.0", "TOLF"),
                           ("'BODY'", "'DISC'", "WTHIGH"), ("FRONT2='MASS'", "FRONT2='MOMENT'", "FRONT2"),
                           ("TOLF=1.0", "TOLF=1.0, NBJNT=1, BLINK=2, BLOOP=1", "BTOL"), ("WFORM='BODY'", "WFORM='BODY', WSHAPE=1", "WSHAPE"),
                           ("TOLF=1.0", "TOLF=1.0, DESDRV=0.2", "TOLT"), ("TOLF=1.0", "TOLF=1.0, WXLOW=0.05, WXHIGH=0.01", "WXLOW"),
                           ("TOLF=1.0", "TOLF=1.0, WXLOW=0.09, WYLOW=0.09", "WREACH"), ("TOLF=1.0", "TOLF=1.0, WXSTRT=0.01", "WXSTRT"),
                           ("TOLF=1.0", "TOLF=1.0, NBJNT=1, BLINK=2, BLOOP=1, BMAX=9.0, BDESX=1.0", "BDESX"),
                           ("TOLF=1.0", "TOLF=1.0, MAXT=-1.0", "MAXT"),
                           (" &BALANC", " &USERBAL", "BALANC"), (" &MASSES", " &USERMAS", "MASSES")):
        assert old in good, old
        code, _, listing, error = muscle(good.replace(old, new), place)
        check(code == 2 and item in error, "bad input: %s" % new, (code, error))


# ---- springs ---------------------------------------------------------------------------------------------------------------

def sizing(listing, name):
    row = next(line for line in listing.split("\n") if line.startswith(" " + name + " "))
    return row[len(name) + 1:].replace("D", "E").split()


def drive_of_kalm(place):
    """Drive torque at every position, by kalm on what muscle wrote."""
    return drive_of(open(os.path.join(place, "case.muscle.dev7"), encoding="utf-8").read().split("\n", 1)[1], place)


def drive_of(case, place):
    """Drive torque at every position, by kalm."""
    code, listing, error = program("kalm", case, place)
    check(code == 0, "kalm reads weights and springs", error)
    rows = [line for line in open(os.path.join(place, "case.kalm.dev9"), encoding="utf-8")]
    names = next(row for row in rows if " drive " in row).lstrip("#").split()
    return [float(row.split()[names.index("drive")]) for row in rows if row.strip() and not row.startswith("#")
            and len(row.split()) == len(names)]


def springs_of_haines(place):
    """Springs of zero free length, phase by phase, as the corrected method has them; the coil; kalm's torque."""
    code, results, listing, error = muscle(data("muscle/haines_spring.nml"), place)
    check(code == 0, "spring of zero free length", error)
    rows = open(os.path.join(place, "case.muscle.dev9"), encoding="utf-8").read().split("# block spring_phases\n")[1].split("\n")
    phases = {}
    for row in rows:
        if row and not row.startswith("#"):
            v = [float(word) for word in row.split()]
            phases.setdefault(round(64*v[0]), []).append(v[1:])
    table = {190: (.1978, 2756, 201.7, 166.1, 213.2, -150.0), 199: (.1707, 2442, 182.7, 144.4, 186.6, -137.3),
             202: (.1693, 2373, 175.2, 136.9, 177.3, -131.6), 205: (.1708, 2315, 166.3, 128.1, 166.6, -124.6)}
    for phase, (ratio, stiffness, *points) in table.items():
        near = [v for v in phases[phase] if v[1] == 1 and abs(v[2] - stiffness) <= 3e-3*stiffness]
        check(len(near) == 1 and abs(near[0][0] - ratio) <= 2e-3, "spring at phase %d: ratio and stiffness" % phase, phases[phase])
        if near:
            check(max(abs(1000*g - w) for g, w in zip(near[0][3:], points)) <= .3, "spring at phase %d: places" % phase, near[0])
    check(all(v[1] == 0 or not .179 < v[0] < .188 for v in phases[211]), "no real spring at phase 211", phases[211])
    spring = results["springs"][0]
    close(results["spring_load"]["after"]/results["spring_load"]["before"], .1697, 3e-3, "best spring: ratio of the ranges")
    close(spring["longest"], .0539, 3e-3, "best spring: length")
    close(spring["stress"], 819.5e6*spring["longest"]/.0537, 3e-3, "coil: stress")
    check(" 1462.963 " in listing and " 1.094571" in listing, "coil: stiffness and Wahl's factor")
    torque = drive_of_kalm(place)
    close(max(torque) - min(torque), results["spring_load"]["after"], 1e-9, "kalm's range of the torque with the spring")
    # a spot value: the spring of 2920 N/m of the thesis at 60 degrees, and one that does nothing
    case = data("muscle/haines_spring.nml")
    case = case[:case.index(" &SPRNGS")].replace("IKIN=5", "NDES=1, DELT=60.0")
    spots = []
    for k, (x1, y1, x2, y2) in ((0.0, (1, 0, 1, 0)), (2920.0, (.182, .147, .190, -.137)), (1000.0, (.25, 0, .2, 0))):
        one = case + " &SPRING NSPRNG=1, ALINK=4, ALOOP=1, ADIST=%.17g, AANG=%.17g, BLINK=-2, BLOOP=1, BDIST=%.17g, BANG=%.17g, " \
            "STIFF=%.17g, SFREE=0.0 &END\n" % (math.hypot(x1, y1), math.degrees(math.atan2(y1, x1)) + 180, math.hypot(x2, y2),
                                              math.degrees(math.atan2(y2, x2)), k)
        code, out, error = program("kalm", one, place)
        spots.append(float(sizing(out, "DRIVE")[0]))
    close(spots[1] - spots[0], -2.947749, 1e-6, "spot value of dE/d(angle)")
    close(spots[2] - spots[0], 0.0, 1e-8, "a spring along a rocker does nothing")


def springs_by_search(place):
    """Search: no worse than the exact method, static balance, places given, the load of a joint; kalm agrees."""
    case = data("muscle/haines_springs.nml")
    code, results, listing, error = muscle(case, place)
    check(code == 0 and results["spring_load"]["after"] < .1693*results["spring_load"]["before"],
          "two springs by search do better than the exact one", results.get("spring_load"))
    torque = drive_of_kalm(place)
    close(max(torque) - min(torque), results["spring_load"]["after"], 1e-8, "kalm's range of the torque with two springs")
    for spring in results["springs"]:
        check(0 <= spring["free"] <= .1*(1 + 1e-9) and spring["stiffness"] >= 0, "springs keep their limits", spring)
    again = muscle(case, place)[1]
    check(again == results, "the same starts, the same springs")
    # a range of .03965984 is known from 128 starts of another method (stiffness 16217.5 and 2162.91 N/m); another seed finds as little
    for seed in (10,):
        found = muscle(case.replace("NSSTRT=8", "ISSEED=%d" % seed), place)[1]
        check(found["spring_load"]["after"] <= .03965984, "two springs: as good as is known, seed %d" % seed, found["spring_load"])
        torque = drive_of_kalm(place)
        close(max(torque) - min(torque), found["spring_load"]["after"], 1e-7, "kalm's range of the torque, seed %d" % seed)
    # never worse than either of them alone, even from one start
    for seed in (1, 2):
        both = muscle(case.replace("NSSTRT=8", "NSSTRT=1, ISSEED=%d" % seed), place)[1]["spring_load"]["after"]
        for which in (0, 1):
            alone = case.replace("NSFIND=2, PLINK=4,4, PLOOP=2*1, QLINK=-2,3, QLOOP=2*1, PREACH=0.3,0.3, QREACH=0.3,0.3",
                                 "NSFIND=1, PLINK=4, PLOOP=1, QLINK=%s, QLOOP=1, PREACH=0.3, QREACH=0.3" % ("-2", "3")[which])
            alone = alone.replace("SFHIGH=0.1,0.1, NSSTRT=8", "SFHIGH=0.1, NSSTRT=1, ISSEED=%d" % seed)
            one = muscle(alone, place)[1]["spring_load"]["after"]
            check(both <= one*(1 + 1e-9), "two springs are no worse than one, seed %d" % seed, (both, one))
    code, results, listing, error = muscle(data("muscle/lamp.nml"), place)
    check(code == 0 and results["spring_load"]["after"] <= 1e-8*results["spring_load"]["before"],
          "static balance of a parallelogram is complete", results["spring_load"])
    torque = drive_of_kalm(place)
    check(max(abs(t) for t in torque) <= 1e-7*results["spring_load"]["before"], "kalm: no torque holds it", torque)
    # places given: stiffness and free length are a convex problem, which a scan cannot beat
    fixed = data("muscle/haines_springs.nml", ("NSFIND=2, PLINK=4,4, PLOOP=2*1, QLINK=-2,3, QLOOP=2*1, PREACH=0.3,0.3, QREACH=0.3,0.3,",
                 "NSFIND=1, PLINK=4, PLOOP=1, PDIST=0.22, PANG=218.0, QLINK=-2, QLOOP=1, QDIST=0.22, QANG=-37.0,"),
                 ("SFHIGH=0.1,0.1", "SFHIGH=0.1"))
    for criterion in ("RANGE", "RMS", "PEAK"):
        code, results, listing, error = muscle(fixed.replace("NSSTRT=8", "NSSTRT=8, SCRIT='%s'" % criterion), place)
        load = results["spring_load"]
        check(code == 0 and load["convex"] and load["after"] - load["bound"] <= 1e-7*load["before"],
              "places given: the optimum is proven, " + criterion, (error, load))
        best, free = load["after"], results["springs"][0]["free"]
        for change in (.9, .99, 1.01, 1.1):
            stiffness = results["springs"][0]["stiffness"]*change
            moved = fixed.replace("SFHIGH=0.1", "SFLOW=%.17g, SFHIGH=%.17g, SKMAX=%.17g" % (free, free, stiffness))
            code, other, listing, error = muscle(moved.replace("NSSTRT=8", "NSSTRT=8, SCRIT='%s'" % criterion), place)
            check(other["spring_load"]["after"] >= best*(1 - 1e-7), "places given: no stiffness does better, " + criterion, change)
    joint = data("muscle/haines_springs.nml", ("NSSTRT=8", "NSSTRT=4, SJLINK=-3, SJLOOP=1, SCRIT='RMS'"))
    code, results, listing, error = muscle(joint, place)
    check(code == 0 and results["spring_load"]["after"] < results["spring_load"]["before"], "a joint's load falls", error)


def bad_springs(place):
    good = data("muscle/haines_springs.nml")
    for old, new, item in (("QLINK=-2,3", "QLINK=4,3", "QLINK"), ("NSFIND=2", "NSFIND=2, SCRIT='MEAN'", "SCRIT"),
                           ("NSFIND=2", "NSFIND=2, SMETH='EXACT'", "SMETH"), ("SFHIGH=0.1,0.1", "SFHIGH=0.1,0.1, SFLOW=0.2", "SFLOW"),
                           ("NSSTRT=8", "NSSTRT=8, SJLINK=-3, SJLOOP=1", "SCRIT"), ("NSSTRT=8", "NSSTRT=8, CWIRE=0.002", "CWIRE"),
                           ("PREACH=0.3,0.3", "PREACH=-0.3", "PREACH"), ("PLINK=4,4", "PLINK=7,4", "PLINK")):
        assert old in good, old
        code, _, listing, error = muscle(good.replace(old, new), place)
        check(code == 2 and item in error, "bad input: %s" % new, (code, error))


# ---- sketches ---------------------------------------------------------------------------------------------------------------

def sketches(place):
    """The four-bar as a sketch: the same weights as by loops, links by their names, and kalm reads what is written."""
    sketch = "FOUR-BAR OF HAINES AS A SKETCH\n &CHAIN JNT='O','A','B','C', JX=0.0,0.05,%.12f,0.25, JY=0.0,0.0,%.12f,0.0,\n" \
        "  LNAME='frame','crank','coupler','rocker', LNK='O C','O A','A B','C B' &END\n &DRIVES DRIVE='O', DBASE='frame', DLINK='crank' " \
        "&END\n &OUTPUTS OUTPUT='angle rocker' &END\n &METHOD IKIN=5 &END\n &LIMITS TANGLE=90.0 &END\n" \
        " &RATES SPEED=300.0, UNITS='REV/MIN' &END\n &MASSES NMASS=2, MNAME='coupler A','rocker C', MASS=0.33235,0.47445, " \
        "MDIST=0.1,0.1375, MINERT=0.001278,0.00405, IMOTOR=0 &END\n"
    # B from A (0.05, 0) and C (0.25, 0): coupler .20, rocker .275
    x = (.20**2 - .275**2 + .2**2)/(2*.2)
    sketch = sketch % (.05 + x, math.sqrt(.20**2 - x**2))
    by_loops = muscle(data("muscle/haines_bodies.nml").replace("WLINK=-1,-2,3, WLOOP=3*1", "WLINK=-1,-2,3, WLOOP=3*1, IEXACT=1"), place)[1]
    code, results, listing, error = muscle(
        sketch + " &BALANC NWEIGH=3, WNAME='crank O','coupler A','rocker C', WFORM='BODY', WREACH=0.1,\n"
        "  WMOST=12.3,1.378,2.887, TOLF=1.0, TOLM=1.0, IEXACT=1 &END\n", place)
    check(code == 0 and results["sets"] and {n for s in results["sets"] for n in s} == {"crank", "coupler", "rocker"},
          "sketch: links by their names", (error, results.get("sets")))
    close(results["composite"]["after"], by_loops["composite"]["after"], 1e-6, "sketch: the same composite as by loops")
    kalm_agrees(place, results, results["optimum"], "sketch")
    # a lever whose own arc is the way of a block on it, and a link that is counted from a joint with one
    quick = data("quick_return.nml")
    quick = quick[quick.index("QUICK"):] + """ &RATES SPEED=60.0, UNITS='REV/MIN' &END
 &MASSES NMASS=3, MNAME='crank O','lever L','rod B', MASS=1.0,3.0,1.0, MDIST=20.0,150.0,50.0, MINERT=3*0.001, UNITL=0.001 &END
"""
    code, results, listing, error = muscle(
        quick + " &BALANC NWEIGH=3, WNAME='crank O','lever L','rod B', WFORM='BODY', WREACH=60.0, WMOST=5.0, TOLF=1.0, TOLM=1.0 &END\n", place)
    check(len(results["optimum"]["weights"]) == 2, "sketch with a slide: two weights", results["optimum"]["weights"])
    lever = results["optimum"]["weights"][1]
    check(lever["link"] == "lever" and abs(abs(lever["angle"]) - 180) < 5, "sketch with a slide: angles count from the lever's line", lever)
    kalm_agrees(place, results, results["optimum"], "sketch with a slide")
    code, results, listing, error = muscle(
        quick + " &SPRNGS NSFIND=1, PNAME='frame', QNAME='lever B', PREACH=100.0, QREACH=50.0, NSSTRT=4 &END\n", place)
    check(code == 0 and "spring_load" in results, "sketch with a slide: a spring", error)
    torque = drive_of_kalm(place)
    close(max(torque) - min(torque), results["spring_load"]["after"], 1e-6, "sketch with a slide: kalm's range of the torque")
    # links whose own arc is a slide, and one without a second joint: their weights are counted from the first joint
    shaper = "SHAPER AS A SKETCH\n &CHAIN JNT='A','B','D','P','Q', JX=0.0,0.05,-0.01,0.06,0.19, JY=0.0,0.02,-0.16,0.21,0.225,\n" \
        "  LNAME='frame','crank','block','lever','rod','ram', LNK='A D','A B','B','D P','P Q','Q',\n  NSLIDE=2, SLNK='lever','frame', " \
        "SLNK2='block','ram', SLX=0.05,0.0, SLY=0.02,0.225, SLANG=71.565051177078,0.0 &END\n &DRIVES DRIVE='A', DBASE='frame', " \
        "DLINK='crank' &END\n &OUTPUTS OUTPUT='point Q' &END\n &METHOD IKIN=5 &END\n &LIMITS TANGLE=90.0, TOGGLE=0.0 &END\n" \
        " &RATES SPEED=20.0 &END\n &MASSES NMASS=4, MNAME='lever D','rod P','ram Q','block', MASS=0.8,0.3,1.4,0.2, MDIST=0.19,0.06," \
        "0.01,0.0, MANG=4.0,0.0,20.0,0.0, MINERT=0.011,0.0006,0.002,0.0001 &END\n"
    for names in ("'block','lever','crank'", "'lever','block'", "'crank','ram','lever','rod'"):
        code, results, listing, error = muscle(shaper + " &BALANC NWEIGH=%d, WNAME=%s, WREACH=0.1, TOLF=1.0, TOLT=1.0, WMOST=0.8 &END\n" % (
            names.count(",") + 1, names), place)
        check(code < 2 and len(results["optimum"]["weights"]) > 0, "sketch with slides: weights are found on " + names, error)
        kalm_agrees(place, results, results["optimum"], "sketch with slides: " + names)


def yokes(place):
    """Random Scotch yokes, whose yoke hangs on the frame by slides alone: the yoke is named as adrift."""
    draw = random.Random(5)
    for seed in range(4):
        bx, by, across, along = draw.uniform(.03, .08), draw.uniform(-.04, .04), draw.uniform(70, 110), draw.uniform(-15, 15)
        text = "SCOTCH YOKE\n &CHAIN JNT='A','B','Q', JX=0.0,%.4f,0.12, JY=0.0,%.4f,0.01, LNAME='frame','crank','block','yoke',\n" \
            "  LNK='A','A B','B','Q', NSLIDE=2, SLNK='yoke','frame', SLNK2='block','yoke', SLX=%.4f,0.12, SLY=%.4f,0.01, SLANG=%.3f,%.3f " \
            "&END\n &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END\n &OUTPUTS OUTPUT='point Q' &END\n &METHOD IKIN=10 &END\n" \
            " &LIMITS TANGLE=90.0, TOGGLE=0.0 &END\n &RATES SPEED=20.0 &END\n &MASSES NMASS=2, MNAME='crank','yoke', MASS=0.3,%.3f,\n" \
            "  MDIST=0.02,0.01, MINERT=1E-4,1E-3 &END\n &BALANC WREACH=0.1 &END\n" % (bx, by, bx, by, across, along, draw.uniform(.2, 1))
        code, results, listing, error = muscle(text, place)
        check(code == 1 and results.get("feasible") is False and results.get("adrift") == ["yoke"], "random yoke %d is adrift" % seed, error)
        check("by slides only: yoke" in error and "yoke" in listing, "random yoke %d is named" % seed, error)


# ---- pictures ---------------------------------------------------------------------------------------------------------------

def pictures(place):
    """balm draws what muscle added: discs of the weights' inertia, springs between their ends, the drive's load before and after."""
    def rows(page, key, after):
        at = page.index('"%s":[' % key, page.index(after)) + len(key) + 4
        return [float(value) for value in page[at:page.index("]", at)].split(",")]

    for name, springs in (("muscle/haines_10u.nml", 0), ("muscle/haines_springs.nml", 2)):
        before = data(name)
        code, results, listing, error = muscle(before, place)
        after = open(os.path.join(place, "case.muscle.dev7"), encoding="utf-8").read()
        weights = results["optimum"]["weights"] if not springs else []
        check(program("balm", after, place)[0] == 0, "pictures: balm draws device 7 of " + name)
        svg = open(os.path.join(place, "case.svg"), encoding="utf-8").read()
        page = open(os.path.join(place, "case.html"), encoding="utf-8").read()
        radii = [float(r) for r in re.findall(r'class="weight"[^>]* r="([^"]+)"', svg)]
        check(len(radii) == len(weights), "pictures: a disc for every weight", radii)
        for radius, weight in zip(radii, weights):
            close(radius, weight["radius"], 1e-9, "pictures: a disc has the radius of the weight")
        check(len(re.findall(r'<path class="spring" d="[^"Z]*"', svg)) == springs, "pictures: every spring is drawn")
        # kalm on the case as it was gives the drive's load before, kalm on device 7 that after
        for case, key in ((before, '"bare":{'), (after, '"forces":{')):
            table = drive_of(case, place)
            shown = rows(page, "drive", key)
            worst = max(abs(table[k] - shown[5*k]) for k in range(72))
            check(worst <= 1e-4*max(map(abs, table)), "pictures: the drive's load of %s in %s" % (key, name), worst)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        needle(folder)
        counts(folder)
        ten_bar(folder)
        example_10u(folder)
        limits_and_desires(folder)
        contact(folder)
        against_global_search(folder)
        against_global_searches(folder)
        random_linkages(folder)
        random_adrift(folder)
        hard_cases(folder)
        bad_input(folder)
        springs_of_haines(folder)
        springs_by_search(folder)
        bad_springs(folder)
        sketches(folder)
        yokes(folder)
        pictures(folder)
    print("%d passed, %d failed" % (passed, failed))
    sys.exit(1 if failed else 0)
