"""Motion in time by psalm's library and by Exudyn at equal errors: Andrews's squeezer, and a slider-crank that a motor starts.

usage: time_beside_exudyn.py   (psalm importable, with its library; NumPy, SciPy, Exudyn). Writes a table in Markdown.

Exudyn integrates bodies with joints as constraints, by the trapezoidal rule with constraints on velocities (index 2) and by generalized
alpha; the settings are its own but for Newton's tolerances. Both are of order 2, so errors fall by four where the steps are halved. Errors
are those of the crank's angle at the end, against values of 17 digits (squeezer) and SciPy's DOP853 on the equation of one freedom
(slider-crank). Wall-clock time, the best of several runs, of the solution alone: cases and models are made before.
"""
import os
import subprocess
import sys
import time

import exudyn as exu
import numpy as np
import psalm
from exudyn.itemInterface import (CoordinateSpringDamper, LoadTorqueVector, MarkerBodyPosition, MarkerBodyRigid, MarkerNodeCoordinate,
                                  MarkerNodeRigid, NodePointGround, NodeRigidBody2D, ObjectConnectorSpringDamper, ObjectGround,
                                  ObjectJointPrismatic2D, ObjectJointRevolute2D, ObjectRigidBody2D)
from scipy.integrate import solve_ivp

TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
RUNS = 5                        # 2 where there are more than 4000 steps
WANTED = (1e-4, 1e-6, 1e-8)     # the fewest steps of Exudyn are sought with which it errs by less
MOST_STEPS = 128000


class Model:
    """Bodies in the plane with joints; every body turns by the angle of its line from `start` to `end` in the drawing."""

    def __init__(self):
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.ground = self.system.AddObject(ObjectGround())
        self.frames, self.nodes = {self.ground: ((0.0, 0.0), 0.0)}, {}

    def body(self, start, end, mass, inertia, centre):
        """Centre along the line from start to end, and across it."""
        start, end = np.array(start), np.array(end)
        angle = np.arctan2(*(end - start)[::-1])
        along = np.array([np.cos(angle), np.sin(angle)])
        place = start + centre[0]*along + centre[1]*np.array([-along[1], along[0]])
        node = self.system.AddNode(NodeRigidBody2D(referenceCoordinates=[*place, angle]))
        body = self.system.AddObject(ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=node))
        self.frames[body], self.nodes[body] = (tuple(place), angle), node
        return body

    def local(self, body, point):
        place, angle = self.frames[body]
        away = np.array(point) - place
        c, s = np.cos(angle), np.sin(angle)
        return [c*away[0] + s*away[1], -s*away[0] + c*away[1], 0.0]

    def marker(self, body, point, rigid=False):
        kind = MarkerBodyRigid if rigid else MarkerBodyPosition
        return self.system.AddMarker(kind(bodyNumber=body, localPosition=self.local(body, point)))

    def pin(self, one, other, point):
        self.system.AddObject(ObjectJointRevolute2D(markerNumbers=[self.marker(one, point, True), self.marker(other, point, True)]))

    def torque(self, body, value):
        marker = self.system.AddMarker(MarkerNodeRigid(nodeNumber=self.nodes[body]))
        self.system.AddLoad(LoadTorqueVector(markerNumber=marker, loadVector=[0.0, 0.0, value]))

    def solve(self, body, end, steps, method):
        """How far a body turns, and the seconds that it takes."""
        settings = exu.SimulationSettings()
        integration = settings.timeIntegration
        integration.numberOfSteps, integration.endTime = steps, end
        integration.newton.relativeTolerance, integration.newton.absoluteTolerance = 1e-10, 1e-12
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = end
        settings.show.statistics = False
        began = time.perf_counter()
        self.system.SolveDynamic(settings, solverType=method, updateInitialValues=False)
        took = time.perf_counter() - began
        return self.system.GetNodeOutput(self.nodes[body], exu.OutputVariableType.Coordinates)[2], took


def squeezer():
    o, a, b, c = (0.0, 0.0), (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
    f, e = (0.0069866741154514457, -0.00043172306456889546), (-0.020960022346354337, 0.0012951691937066864)
    g, h = (-0.033997203885839981, 0.016461971674997683), (-0.0316331345074089, -0.015618868668304537)
    d = (-0.010472393888814623, 0.025357788530275246)
    model = Model()
    crank = model.body(o, f, 0.04325, 2.194e-6, (0.00092, 0.0))
    k2 = model.body(f, e, 0.00365, 4.410e-7, (0.0115, 0.0))
    # K3 as published: axes at B with E on the negative y axis, which is the line from B to E turned by a right angle
    k3 = model.body(b, e, 0.02373, 5.255e-6, (0.01874, 0.01043))
    k4 = model.body(e, g, 0.00706, 5.667e-7, (0.01421, 0.0))
    k5 = model.body(a, g, 0.0705, 1.169e-5, (0.02308, 0.00916))
    k6 = model.body(e, h, 0.00706, 5.667e-7, (0.01421, 0.0))
    k7 = model.body(a, h, 0.05498, 1.912e-5, (0.00449, -0.01228))
    for one, other, point in ((model.ground, crank, o), (crank, k2, f), (k2, k3, e), (model.ground, k3, b), (k3, k4, e), (k4, k5, g),
                              (model.ground, k5, a), (k3, k6, e), (k6, k7, h), (model.ground, k7, a)):
        model.pin(one, other, point)
    model.torque(crank, 0.033)
    model.system.AddObject(ObjectConnectorSpringDamper(markerNumbers=[model.marker(model.ground, c), model.marker(k3, d)],
                                                       referenceLength=0.07785, stiffness=4530.0, damping=0.0))
    model.system.Assemble()
    return model, crank


def slider_crank():
    crank_length, rod_length, offset = 0.040, 0.140, 0.010
    pin, piston_pin = (crank_length, 0.0), (crank_length + np.sqrt(rod_length**2 - offset**2), offset)
    model = Model()
    crank = model.body((0.0, 0.0), pin, 0.5, 1e-4, (0.020, 0.0))
    rod = model.body(pin, piston_pin, 0.7, 1.2e-3, (0.070, 0.0))
    piston = model.body(piston_pin, (1.0, offset), 0.4, 1e-4, (0.0, 0.0))
    model.pin(model.ground, crank, (0.0, 0.0))
    model.pin(crank, rod, pin)
    model.pin(rod, piston, piston_pin)
    model.system.AddObject(ObjectJointPrismatic2D(markerNumbers=[model.marker(model.ground, (0.0, offset), True),
                                                                 model.marker(piston, piston_pin, True)]))
    # 20 N m (1 - w/100 rad/s) of the motor less 5 N m: a torque and a damper
    model.torque(crank, 15.0)
    still = model.system.AddMarker(MarkerNodeCoordinate(nodeNumber=model.system.AddNode(NodePointGround()), coordinate=0))
    turning = model.system.AddMarker(MarkerNodeCoordinate(nodeNumber=model.nodes[crank], coordinate=2))
    model.system.AddObject(CoordinateSpringDamper(markerNumbers=[still, turning], stiffness=0.0, damping=0.2))
    model.system.Assemble()
    return model, crank


def slider_crank_exactly(end):
    """J q'' + J' q'^2/2 = Q with derivatives of the closed form."""
    r, l, e = 0.040, 0.140, 0.010

    def inertia(q):
        s, c = np.sin(q), np.cos(q)
        turn = np.arcsin((e - r*s)/l)
        rate = -r*c/(l*np.cos(turn))
        piston = -r*s - l*np.sin(turn)*rate
        centre = (-r*s - 0.5*l*np.sin(turn)*rate, r*c + 0.5*l*np.cos(turn)*rate)
        return 0.5*0.020**2 + 1e-4 + 0.7*(centre[0]**2 + centre[1]**2) + 1.2e-3*rate**2 + 0.4*piston**2

    def slopes(t, y):
        step = 1e-30
        return [y[1], (15.0 - 0.2*y[1] - 0.5*(inertia(y[0] + 1j*step).imag/step)*y[1]**2)/inertia(y[0])]

    return solve_ivp(slopes, (0.0, end), [0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-15).y[0, -1]


def by_psalm(name, tolerance):
    """How far the crank turns, and the seconds."""
    with open(os.path.join(TOP, "data", "time", name + ".nml"), encoding="utf-8") as file:
        text = file.read()
    text = text[:text.index("&TIME")] + "&TIME TEND=%s, NTIME=1, TTOL=%s &END\n" % ({"andrews_squeezer": "0.03", "engine_run_up": "0.2"}[name], tolerance)
    case = psalm.from_text(text)
    took = []
    for _ in range(RUNS):
        began = time.perf_counter()
        found = case.time()
        took.append(time.perf_counter() - began)
    return np.radians(np.asarray(found.tables["time"]["input"])[-1]), min(took)


def by_exudyn(make, end, steps, method):
    took, turned = [], 0.0
    for _ in range(2 if steps > 4000 else RUNS):
        model, crank = make()
        turned, seconds = model.solve(crank, end, steps, method)
        took.append(seconds)
    return turned, min(took)


def main():
    commit = subprocess.run(["git", "-C", TOP, "rev-parse", "--short=12", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    print("\n## Motion in time beside Exudyn\n\nMeasured by `bench/time_beside_exudyn.py` at commit %s, Exudyn %s, one run, wall-clock time of the"
          " solution, best of %d.\nErrors are those of the crank's angle at the end, radians: of Exudyn with the fewest steps (1000 times a power of two, at most"
          " %d)\nthat err by less than 1E-4, 1E-6 and 1E-8, and with the most.\n" % (commit, exu.__version__, RUNS, MOST_STEPS))
    print("| mechanism | method | setting | error | time, ms |\n| --- | --- | --- | --- | --- |")
    for title, name, make, end, exact in (
            ("Andrews's squeezer, 0.03 s", "andrews_squeezer", squeezer, 0.03, 15.810771195153707 + 0.0617138900142764496),
            ("slider-crank started by a motor, 0.2 s", "engine_run_up", slider_crank, 0.2, slider_crank_exactly(0.2))):
        for tolerance in ("1E-3", "1E-4", "1E-6", "1E-8", "1E-10", "1E-13"):
            turned, seconds = by_psalm(name, tolerance)
            print("| %s | psalm | TTOL=%s | %.1e | %.2f |" % (title, tolerance, abs(turned - exact), 1e3*seconds))
        for method, words in ((exu.DynamicSolverType.TrapezoidalIndex2, "Exudyn, trapezoidal rule"),
                              (exu.DynamicSolverType.GeneralizedAlpha, "Exudyn, generalized alpha")):
            wanted, steps = list(WANTED), 1000
            while wanted and steps <= MOST_STEPS:
                turned, seconds = by_exudyn(make, end, steps, method)
                error = abs(turned - exact)
                if not np.isfinite(error):
                    break
                if error <= wanted[0] or steps == MOST_STEPS:
                    print("| %s | %s | %d steps | %.1e | %.2f |" % (title, words, steps, error, 1e3*seconds))
                    wanted = [one for one in wanted if one < error]
                steps *= 2
    print("""
Exudyn solves the equations of every body and joint with methods of order 2 and fixed steps, which are made for any three-dimensional
system, elastic bodies and contact among them; psalm solves those of one drive with an explicit method of order 8. Time includes, with
psalm, the tables of forces and results, and with Exudyn neither.""")
    return 0


if __name__ == "__main__":
    sys.exit(main())
