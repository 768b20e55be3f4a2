"""The exact model of a joint with clearance: all links free, every other joint kept, the pin of one joint within a circle.

A linkage is written down once, as a sketch; from it come the data set that bridge reads and the equations here, which share
nothing with bridge: Newton's method on the poses of all links, then one linear system for accelerations and forces.
"""
import math

import numpy
from scipy.integrate import solve_ivp


class Linkage:
    """Joints by name, links by their joints (the first is the frame, the second the crank, which turns about the first joint they
    share), slides (link, link, place, degrees), masses by link: kg, centre, inertia about the centre. Metres."""

    def __init__(self, title, joints, links, slides=(), masses=None):
        self.title, self.joints, self.links, self.slides = title, joints, links, list(slides)
        self.masses = masses or {}
        self.names = list(links)
        self.pivot = next(j for j in links[self.names[0]].split() if j in links[self.names[1]].split())
        n = len(self.names)
        self.mass, self.inertia, self.centre = numpy.zeros(n), numpy.zeros(n), numpy.zeros((n, 2))
        for k, name in enumerate(self.names):
            self.centre[k] = joints[links[name].split()[0]]
            if name in self.masses:
                self.mass[k], self.centre[k], self.inertia[k] = self.masses[name]
        self.pairs = []                                    # first link, second link, joint
        for joint in joints:
            at = [k for k, name in enumerate(self.names) if joint in links[name].split()]
            self.pairs += [(at[0], k, joint) for k in at[1:]]
        self.weights = numpy.repeat(self.mass, 3)
        self.weights[2::3] = self.inertia

    def text(self, groups):
        """The data set, with further groups."""
        def row(values):
            return "\n  ".join(",".join(values[i:i + 5]) + "," for i in range(0, len(values), 5))
        number = lambda v: "%.17g" % v
        points = [self.joints[j] for j in self.joints]
        text = self.title + "\n &CHAIN JNT=\n  " + row(["'%s'" % j for j in self.joints])
        text += "\n  JX=\n  " + row([number(p[0]) for p in points]) + "\n  JY=\n  " + row([number(p[1]) for p in points])
        text += "\n  LNAME=\n  " + row(["'%s'" % n for n in self.names])
        text += "\n  LNK=\n  " + row(["'%s'" % self.links[n] for n in self.names])
        if self.slides:
            text += "\n  NSLIDE=%d, SLNK=%s, SLNK2=%s,\n  SLX=%s,\n  SLY=%s,\n  SLANG=%s" % (
                len(self.slides), ",".join("'%s'" % s[0] for s in self.slides), ",".join("'%s'" % s[1] for s in self.slides),
                ",".join(number(s[2][0]) for s in self.slides), ",".join(number(s[2][1]) for s in self.slides),
                ",".join(number(s[3]) for s in self.slides))
        first = self.links[self.names[0]].split()
        text += " &END\n &DRIVES DRIVE='%s', DBASE='%s', DLINK='%s' &END\n" % (self.pivot, self.names[0], self.names[1])
        last = self.links[self.names[-1]].split()[-1]
        text += " &OUTPUTS OUTPUT='point %s' &END\n &METHOD IKIN=90 &END\n &LIMITS TANGLE=90.0, TOGGLE=0.0 &END\n" % last
        places, distances, angles = [], [], []
        for name in self.masses:
            own = self.links[name].split()
            base = numpy.array(self.joints[own[0]])
            arm = self.masses[name][1] - base
            line = numpy.array([1.0, 0.0]) if len(own) < 2 else numpy.array(self.joints[own[1]]) - base
            places.append("'%s'" % name)
            distances.append(number(math.hypot(*arm)))
            angles.append(number(math.degrees(math.atan2(arm[1], arm[0]) - math.atan2(line[1], line[0])) if math.hypot(*arm) > 0 else 0.0))
        text += " &MASSES NMASS=%d, MNAME=\n  %s\n  MASS=\n  %s\n  MDIST=\n  %s\n  MANG=\n  %s\n  MINERT=\n  %s &END\n" % (
            len(places), row(places), row([number(self.masses[n][0]) for n in self.masses]), row(distances), row(angles),
            row([number(self.masses[n][2]) for n in self.masses]))
        assert first
        return text + groups


class Exact:
    """One joint opened. States are poses of all moving links: x, y of the centre, angle from the drawing."""

    def __init__(self, linkage, joint, link, speed=1.0):
        """The link is the one that turns in the joint: the pin is that of the joint's other link, as bridge has it."""
        self.of, self.speed = linkage, speed
        moving = len(linkage.names) - 1
        self.size = 3*moving
        number = linkage.names.index(link)
        pairs = [p for p in linkage.pairs if p[2] == joint and number in p[:2]]
        self.open = pairs[0]
        self.closed = [p for p in linkage.pairs if p is not self.open]
        start = linkage.centre[1:]
        self.last = numpy.column_stack([start, numpy.zeros(moving)]).ravel()
        self.last_input = 0.0
        self.weights = linkage.weights[3:]

    # ---- constraints -------------------------------------------------------------------------------------------------

    def _point(self, q, link, place):
        """A point of a link, and its derivatives by x, y, angle (2 by 3)."""
        if link == 0:
            return numpy.array(place, dtype=q.dtype), None
        x, y, phi = q[3*link - 3:3*link]
        c, s = numpy.cos(phi), numpy.sin(phi)
        dx, dy = place[0] - self.of.centre[link, 0], place[1] - self.of.centre[link, 1]
        return numpy.array([x + c*dx - s*dy, y + s*dx + c*dy]), numpy.array([[1, 0, -s*dx - c*dy], [0, 1, c*dx - s*dy]])

    def _conditions(self, q, theta, gap):
        """What must vanish, and its matrix: the opened joint in the last two rows."""
        rest, matrix = [], []

        def add(value, terms):
            row = numpy.zeros(self.size, dtype=q.dtype)
            for link, part in terms:
                if link > 0 and part is not None:
                    row[3*link - 3:3*link] += part
            rest.append(value)
            matrix.append(row)

        add(q[2] - theta, [(1, numpy.array([0, 0, 1.0]))])
        for a, b, place, angle in self.of.slides:
            a, b = self.of.names.index(a), self.of.names.index(b)
            phi = q[3*a - 1] if a else 0.0
            other = q[3*b - 1] if b else 0.0
            turn = numpy.array([0, 0, 1.0])
            add(other - phi, [(b, turn), (a, -turn)])
            n = numpy.array([-numpy.sin(phi + math.radians(angle)), numpy.cos(phi + math.radians(angle))])
            along = numpy.array([n[1], -n[0]])
            pa, ja = self._point(q, a, place)
            pb, jb = self._point(q, b, place)
            terms = [(b, n @ jb if jb is not None else None), (a, -(n @ ja) if ja is not None else None)]
            add(n @ (pb - pa), terms + [(a, numpy.array([0, 0, -(along @ (pb - pa))]))])
        for a, b, joint in self.closed + [self.open]:
            pa, ja = self._point(q, a, self.of.joints[joint])
            pb, jb = self._point(q, b, self.of.joints[joint])
            for k in (0, 1):
                add(pa[k] - pb[k], [(a, ja[k] if ja is not None else None), (b, -jb[k] if jb is not None else None)])
        rest = numpy.array(rest)
        rest[-2:] -= gap
        return rest, numpy.array(matrix)

    def place(self, theta, gap):
        """Poses for an angle of the crank and a displacement of the pin, nearest to the last ones."""
        q = self.last.copy()
        steps = max(1, int(abs(theta - self.last_input)/0.05))
        for k in range(1, steps + 1):
            part = self.last_input + (theta - self.last_input)*k/steps
            for _ in range(50):
                rest, matrix = self._conditions(q, part, gap)
                move = numpy.linalg.solve(matrix, -rest)
                q = q + move
                if numpy.abs(move).max() < (1e-8 if k < steps else 1e-15) or (_ > 6 and numpy.abs(move).max() < 1e-12):
                    break
        self.last, self.last_input = q, theta
        return q

    def _bend(self, q, rates):
        """Minus the part of the conditions' second derivatives that comes from the rates, by a complex step."""
        h = 1e-30
        _, matrix = self._conditions(q + 1j*h*rates, self.last_input, numpy.zeros(2))
        return -(matrix.imag/h) @ rates

    # ---- what bridge tells too ---------------------------------------------------------------------------------------

    def tensor(self, theta, h):
        """Inertia against displacements of the pin, the crank held: kinetic energy of differences of fourth order."""
        moves = []
        for unit in numpy.eye(2):
            q = {k: self.place(theta, k*h*unit) for k in (-2, -1, 1, 2)}
            moves.append((8*(q[1] - q[-1]) - (q[2] - q[-2]))/(12*h))
        self.place(theta, numpy.zeros(2))
        return [moves[i] @ (self.weights*moves[k]) for i, k in ((0, 0), (0, 1), (1, 1))]

    def nominal(self, theta):
        """Force of the pin on its hole without clearance, constant speed."""
        q = self.place(theta, numpy.zeros(2))
        _, matrix = self._conditions(q, theta, numpy.zeros(2))
        right = numpy.zeros(self.size)
        right[0] = self.speed
        rates = numpy.linalg.solve(matrix, right)
        acceleration = numpy.linalg.solve(matrix, self._bend(q, rates))
        return -numpy.linalg.solve(matrix.T, self.weights*acceleration)[-2:]

    # ---- following, flight -------------------------------------------------------------------------------------------

    def contact(self, theta, g, turning, e):
        """Second derivative of the pin's angle, and the force of contact."""
        unit, across = numpy.array([math.cos(g), math.sin(g)]), numpy.array([-math.sin(g), math.cos(g)])
        q = self.place(theta, e*unit)
        _, matrix = self._conditions(q, theta, numpy.zeros(2))
        right = numpy.zeros(self.size)
        right[0] = self.speed
        right[-2:] = e*turning*across
        rates = numpy.linalg.solve(matrix, right)
        n = self.size
        whole, known = numpy.zeros((2*n + 1, 2*n + 1)), numpy.zeros(2*n + 1)
        whole[:n, :n] = numpy.diag(self.weights)
        whole[:n, n:2*n] = -matrix.T
        whole[n:2*n, :n] = matrix
        whole[2*n - 2:2*n, 2*n] = -e*across
        whole[2*n, 2*n - 2:2*n] = across
        known[n:2*n] = self._bend(q, rates)
        known[2*n - 2:2*n] -= e*turning**2*unit
        done = numpy.linalg.solve(whole, known)
        return done[2*n], -(done[2*n - 2:2*n] @ unit)

    def follow(self, begin, end, e, points=2000, tolerance=1e-9):
        """Minima of the force of contact (input, force) between two angles of the crank in degrees, from a = a' = 0."""
        h = 1e-5
        angle = lambda th: math.atan2(*self.nominal(th)[::-1])
        theta = math.radians(begin)
        turn = (math.remainder(angle(theta + h) - angle(theta - h), 2*math.pi))/(2*h)

        def slope(time, state):
            second, _ = self.contact(theta + self.speed*time, *state, e)
            return [state[1], second]

        times = numpy.linspace(0.0, math.radians(end - begin)/self.speed, points)
        done = solve_ivp(slope, [0.0, times[-1]], [angle(theta), turn*self.speed], method="DOP853", rtol=tolerance,
                         atol=1e-2*tolerance, dense_output=True)
        force = lambda t: self.contact(theta + self.speed*t, *done.sol(t), e)[1]
        values = numpy.array([force(t) for t in times])
        found = []
        for i in range(1, points - 1):
            if values[i] < values[i - 1] and values[i] <= values[i + 1]:
                a, b, c = values[i - 1:i + 2]
                shift = 0.5*(a - c)/(a - 2*b + c)
                found.append((begin + (end - begin)*(i + shift)/(points - 1), b - 0.25*(a - c)*shift))
        return numpy.array(found)


def haines():
    """The four-bar of Haines: coupler and rocker with their masses."""
    th = math.radians(90.0)
    a, c = numpy.array([0.05*math.cos(th), 0.05*math.sin(th)]), numpy.array([0.25, 0.0])
    d = math.hypot(*(c - a))
    t3 = math.atan2(*(c - a)[::-1]) + math.acos((0.2**2 + d**2 - 0.275**2)/(2*0.2*d))
    b = a + 0.2*numpy.array([math.cos(t3), math.sin(t3)])
    return Linkage("FOUR-BAR OF HAINES AS A SKETCH", {"O": (0.0, 0.0), "A": tuple(a), "B": tuple(b), "C": tuple(c)},
                   {"frame": "O C", "crank": "O A", "coupler": "A B", "rocker": "C B"},
                   masses={"coupler": (0.33235, 0.5*(a + b), 0.001278), "rocker": (0.47445, 0.5*(b + c), 0.00405)})


def slider_crank():
    b, c = numpy.array([0.0, 0.04]), numpy.array([0.14*math.cos(math.asin(0.03/0.14)), 0.01])
    return Linkage("SLIDER-CRANK", {"A": (0.0, 0.0), "B": tuple(b), "C": tuple(c)},
                   {"frame": "A", "crank": "A B", "rod": "B C", "piston": "C"},
                   slides=[("frame", "piston", (0.0, 0.01), 0.0)],
                   masses={"crank": (0.9, numpy.array([0.002, 0.005]), 0.0006), "rod": (0.4, b + (c - b)*0.35, 0.001),
                           "piston": (0.7, c + (0.004, 0.001), 0.0002)})


def shaper():
    """Whitworth's quick return: the crank's block slides in a lever, whose end drives a ram by a rod."""
    joints = {"A": (0.0, 0.0), "B": (0.05, 0.02), "D": (-0.01, -0.16), "P": (0.06, 0.21), "Q": (0.19, 0.225)}
    up = math.degrees(math.atan2(0.02 + 0.16, 0.05 + 0.01))
    return Linkage("SIX-BAR SHAPER", joints,
                   {"frame": "A D", "crank": "A B", "block": "B", "lever": "D P", "rod": "P Q", "ram": "Q"},
                   slides=[("lever", "block", (0.05, 0.02), up), ("frame", "ram", (0.0, 0.225), 0.0)],
                   masses={"crank": (0.5, numpy.array([0.01, 0.004]), 0.0004), "block": (0.15, numpy.array([0.05, 0.02]), 5e-5),
                           "lever": (0.8, numpy.array([0.02, 0.03]), 0.011), "rod": (0.3, numpy.array([0.12, 0.22]), 0.0006),
                           "ram": (1.4, numpy.array([0.2, 0.23]), 0.002)})


def needle():
    """The ten-bar needle linkage of the thesis at its reference position, rounded to a micrometre; masses as in needle_masses."""
    joints = {"A": (0.0, 0.0), "B": (-19.0, 0.0), "C": (59.0, 95.75), "D": (75.711, -7.405), "E": (-3.75, 110.0),
              "F": (23.839, 95.863), "G": (79.033, 82.533), "H": (84.798, 93.625), "I": (68.5, 346.0), "J": (-12.155, 319.17),
              "K": (-36.904, 406.635)}
    joints = {name: (x*1e-3, y*1e-3) for name, (x, y) in joints.items()}
    links = {"frame": "A C E I", "crank": "A B", "b2": "B D", "b3": "C D G", "b4": "B F", "b5": "E F", "b6": "F H", "b7": "G H",
             "b8": "H J", "b9": "I J K"}
    at = {name: numpy.array(p) for name, p in joints.items()}
    middle = lambda a, b, part: at[a] + (at[b] - at[a])*part
    masses = {"crank": (0.12, middle("A", "B", 0.3), 2e-5), "b2": (0.10, middle("B", "D", 0.5), 8e-5),
              "b3": (0.15, middle("C", "D", 0.5), 1.5e-4), "b4": (0.09, middle("B", "F", 0.5), 9e-5),
              "b5": (0.06, middle("E", "F", 0.5), 8e-6), "b6": (0.05, middle("F", "H", 0.5), 2e-6),
              "b7": (0.04, middle("G", "H", 0.5), 3e-6), "b8": (0.20, middle("H", "J", 0.5), 1e-3),
              "b9": (0.11, at["J"] + numpy.array([-0.01, 0.03]), 9e-5)}
    return Linkage("TEN-BAR NEEDLE LINKAGE AS A SKETCH", joints, links, masses=masses)
