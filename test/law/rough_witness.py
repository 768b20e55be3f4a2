"""Random mechanisms with rough pins and slides by an independent integration: all poses, multipliers, friction by what they bear.

Each rough joint slips one way, or the other, or sticks; where a rate comes to 0, or what holds a joint to what friction can hold,
the integration ends, and of all states of the joints at rest the first is taken that agrees with itself.
"""
import itertools
import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from time_motion import Witness, random_mechanism

ROUGH = {"four-bar": "A B C D", "slider-crank": "S1 A B", "five-bar": "A B C D E", "chain": "A B", "bar on a slide": "S1 A B"}
MOST = {"four-bar": 4, "slider-crank": 3, "five-bar": 2, "chain": 2, "bar on a slide": 2}
REST = 1e-9           # rad/s or m/s: a joint is at rest
AGREES = 1e-9
BLOW = 1e6            # rad/s2 or m/s2


class RoughWitness(Witness):
    """A witness with friction: of pins by their number (and radius), of slides by theirs."""

    def __init__(self, plain, rough_pins, rough_slides, coefficient, at_rest, radius):
        self.__dict__.update(plain.__dict__)
        self.rough = [(k, False) for k in rough_pins] + [(k, True) for k in rough_slides]
        self.coefficient, self.at_rest, self.radius = coefficient, at_rest, radius

    def pair(self, rough):
        """First and second body of a rough joint, and which of their coordinates has its rate."""
        number, slides = rough
        return (None, self.slides[number], 0) if slides else (self.pins[number][0], self.pins[number][2], 2)

    def along(self, rough):
        """The row that gives the rate of a joint."""
        row = np.zeros(3*len(self.places))
        a, b, part = self.pair(rough)
        row[3*b + part] = 1.0
        if a is not None:
            row[3*a + part] = -1.0
        return row

    def loads(self, multipliers):
        """What friction is a part of, by joint."""
        loads = []
        for number, slides in self.rough:
            if slides:
                loads.append(abs(multipliers[2*len(self.pins) + 2*number]))
            else:
                loads.append(self.radius*math.hypot(*multipliers[2*number:2*number + 2]))
        return np.array(loads)

    def solve(self, y, v, states):
        """Accelerations, what each rough joint bears, and the loads, for 1, -1 (slips) or 0 (sticks)."""
        n = len(y)
        mass, force, rows, right = self.equations(y, v)
        stuck = [k for k, state in enumerate(states) if state == 0]
        g = np.vstack([rows] + [self.along(self.rough[k])[None, :] for k in stuck])
        right = np.concatenate([right, np.zeros(len(stuck))])
        k = np.block([[mass, -g.T], [g, np.zeros((len(g), len(g)))]])
        slips = [k for k, state in enumerate(states) if state]
        columns = np.array([np.concatenate([self.along(self.rough[j]), np.zeros(len(g))]) for j in slips]).reshape(len(slips), len(k)).T
        loads = np.column_stack([np.concatenate([force, right]), columns])
        base = np.linalg.lstsq(k, loads, rcond=1e-12)[0]
        if np.max(np.abs(k @ base - loads)) > 1e-7*np.max(np.abs(loads)):
            return None                                 # a joint that turns back while the rest goes on cannot be held

        def found(push):
            return base[:, 0] + base[:, 1:] @ push

        def missing(push):
            return push + np.array([states[j]*self.coefficient for j in slips])*self.loads(found(push)[n:])[slips]

        push = np.zeros(len(slips))
        for _ in range(100):
            step = missing(push)
            push = push - step
            size = np.max(np.abs(step), initial=0.0)
            if size < 1e-15*max(1.0, np.max(np.abs(push), initial=0.0)) or size > 1e6:
                break
        if not size < 1e-12*max(1.0, np.max(np.abs(push), initial=0.0)):
            push = np.zeros(len(slips))
            for share in np.linspace(0.05, 1.0, 20):
                push = fsolve(lambda p, s=share: p + s*(missing(p) - p), push, xtol=1e-14)
            if np.max(np.abs(missing(push))) > 1e-9:
                return None
        x = found(push)
        bears = np.zeros(len(states))
        bears[slips] = push
        bears[stuck] = x[n + len(rows):]
        return x[:n], bears, self.loads(x[n:])

    def equations(self, y, v):
        """Masses, forces and closure, as the plain witness has them."""
        kept = {}
        original = np.linalg.solve
        try:
            np.linalg.solve = lambda k, b: (kept.update(k=k, b=b), b)[1]
            self.accelerations(y, v)
        finally:
            np.linalg.solve = original
        n = len(y)
        return kept["k"][:n, :n], kept["b"][:n], kept["k"][n:, :n], kept["b"][n:]

    def choose(self, y, v, states, at_rest, loose):
        """The first state that agrees with itself; those that stick before those that slip, but for joints that have come loose."""
        for tried in itertools.product(*[((0, 1, -1)[free:]) if rests else (state,)
                                         for rests, state, free in zip(at_rest, states, loose)]):
            solved = self.solve(y, v, tried)
            if solved is None:
                continue
            a, bears, loads = solved
            good = np.max(np.abs(a)) < BLOW             # likewise
            for k, rests in enumerate(at_rest):
                accel = self.along(self.rough[k]) @ a
                if rests and tried[k] == 0:
                    good = good and abs(bears[k]) <= self.at_rest*loads[k]*(1 + AGREES)
                elif rests:
                    good = good and tried[k]*accel >= -AGREES*max(1.0, np.max(np.abs(a)))
            if good:
                return list(tried)
        return None

    def end(self, time, v0):
        n = 3*len(self.places)
        y, now = np.concatenate([np.array(self.places).ravel(), v0]), 0.0
        states = [1]*len(self.rough)
        ended = [True]*len(self.rough)
        loose = [False]*len(self.rough)
        for _ in range(400):
            rates = [self.along(r) @ y[n:] for r in self.rough]
            at_rest = [e or abs(r) < REST for e, r in zip(ended, rates)]
            states = self.choose(y[:n], y[n:], [s if rest else (1 if r > 0 else -1) for s, r, rest in zip(states, rates, at_rest)],
                                 at_rest, loose)
            if states is None:
                return None
            events = []
            for k, state in enumerate(states):
                if state:
                    event = (lambda t, z, k=k, s=state: s*(self.along(self.rough[k]) @ z[n:]))
                else:
                    def event(t, z, k=k, states=tuple(states)):
                        _, bears, loads = self.solve(z[:n], z[n:], states)
                        return self.at_rest*loads[k]*(1 + AGREES) - abs(bears[k])
                event.terminal, event.direction = True, -1
                events.append(event)
            held = tuple(states)
            done = solve_ivp(lambda t, z: np.concatenate([z[n:], self.solve(z[:n], z[n:], held)[0]]), (now, time), y, method="DOP853",
                             rtol=1e-11, atol=1e-13, events=events)
            y, now = done.y[:, -1], done.t[-1]
            if done.status != 1:
                return y[:n], y[n:]
            ended = [len(t) > 0 for t in done.t_events]
            loose = [e and state == 0 for e, state in zip(ended, states)]
        return None


def random_rough(draw, kind):
    """A random mechanism with friction in some joints, and its witness; of several freedoms no more than those are rough."""
    case, plain, order, holder = random_mechanism(draw, kind)
    names = ROUGH[kind].split()
    draw.shuffle(names)
    names = names[:draw.randint(1, MOST[kind])]
    slip, radius = draw.choice((.1, .3)), draw.choice((.01, .03))
    rest = slip*draw.choice((1, 1.5))
    if len(names) > 1 and kind not in ("five-bar", "chain"):
        rest = slip                                     # how joints that hold one motion share it is a rule, not a law
    pins = [joint for joint, held in holder.items() for _ in held[1:]]
    witness = RoughWitness(plain, [pins.index(name) for name in names if name != "S1"], [0]*("S1" in names), slip, rest, radius)
    radii = ",".join("0.0" if name == "S1" else repr(radius) for name in names)
    quoted = ",".join(f"'{name}'" for name in names)
    case += f" &FRICTN FNAME={quoted}, FMU={len(names)}*{slip}, FSTAT={len(names)}*{rest!r}, FRAD={radii} &END\n"
    return case, witness, order, holder
