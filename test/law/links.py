"""Clearances of links and joints, proven and sampled, against a model of its own.

    links.py BIN [CASES]

Random linkages of a crank-rocker and a dyad on its coupler, with links of some width, a box, a half-plane and circles. The model here
solves the triangles by complex numbers, measures distances by the ends of crossing segments, and looks for the least by dense sampling
and golden section. What BIN/psalm proves must not be refuted by any sample, must be as near as the best of them, and must agree with
the margins of &CONSTR. Last line: N passed, N failed.
"""
import os
import random
import subprocess
import sys
import tempfile

import numpy as np

BIN = os.path.abspath(sys.argv[1])
CASES = int(sys.argv[2]) if len(sys.argv) > 2 else 8
SAMPLES = 720
GOLDEN = 0.5*(5.0**0.5 - 1.0)
SEGMENTS = ('AB', 'BC', 'CD', 'BE', 'EF', 'FG')
BODIES = ('AB', 'BCE', 'CD', 'EF', 'FG', 'ADG')
passed = failed = 0


def check(truth, what):
    global passed, failed
    if truth:
        passed += 1
    else:
        failed += 1
        print('FAILED:', what)


def cross(a, b):
    return a.real*b.imag - a.imag*b.real


def dyad(start, finish, p, q, side):
    """The joint between two links, by the law of cosines; NaN where they do not reach."""
    h = finish - start
    along = (p*p - q*q + abs(h)**2)/(2.0*abs(h))
    with np.errstate(invalid='ignore'):
        return start + h/abs(h)*(along + 1j*side*np.sqrt(p*p - along*along))


class Linkage:
    def __init__(self, draw):
        while True:
            self.drawn = {n: complex(x, y) for n, x, y in (
                ('A', 0.0, 0.0), ('B', draw.uniform(8, 20), draw.uniform(-10, 25)), ('C', draw.uniform(45, 80), draw.uniform(50, 80)),
                ('D', draw.uniform(70, 110), draw.uniform(-20, 10)), ('E', draw.uniform(0, 60), draw.uniform(60, 110)),
                ('F', draw.uniform(90, 150), draw.uniform(50, 110)), ('G', draw.uniform(110, 170), draw.uniform(-20, 30)))}
            d = self.drawn
            self.length = {s: abs(d[s[0]] - d[s[1]]) for s in ('AB', 'BC', 'CD', 'BE', 'EF', 'FG', 'AD')}
            self.side = [np.sign(cross(d['D'] - d['B'], d['C'] - d['B'])), np.sign(cross(d['G'] - d['E'], d['F'] - d['E']))]
            self.points = self.at(np.linspace(0.0, 360.0, SAMPLES + 1))
            self.closed = np.isfinite(self.points['F'])
            sines = abs(cross(d['C'] - d['B'], d['C'] - d['D']))/(self.length['BC']*self.length['CD'])
            if np.all(np.isfinite(self.points['C'])) and self.closed.sum() > SAMPLES//4 and sines > 0.1:
                return

    def at(self, degrees):
        d = self.drawn
        p = {n: d[n] + 0.0*degrees for n in 'ADG'}
        p['B'] = self.length['AB']*np.exp(1j*np.radians(degrees))
        p['C'] = dyad(p['B'], p['D'], self.length['BC'], self.length['CD'], self.side[0])
        turn = (p['C'] - p['B'])/(d['C'] - d['B'])
        p['E'] = p['B'] + turn*(d['E'] - d['B'])
        p['F'] = dyad(p['E'], p['G'], self.length['EF'], self.length['FG'], self.side[1])
        return p


def to_segment(point, a, b):
    foot = np.clip(((point - a)*np.conj(b - a)).real/abs(b - a)**2, 0.0, 1.0)
    return abs(point - a - foot*(b - a))


def to_line(point, a, b):
    return abs(cross(point - a, b - a))/abs(b - a)


def pair(a, b, c, d):
    """Distance of two segments; crossing, the negative of the way of the end that is least far through."""
    apart = np.minimum.reduce([to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)])
    through = np.minimum.reduce([to_line(a, c, d), to_line(b, c, d), to_line(c, a, b), to_line(d, a, b)])
    signs = [np.sign(x) for x in (cross(b - a, c - a), cross(b - a, d - a), cross(d - c, a - c), cross(d - c, b - c))]
    return np.where((signs[0]*signs[1] < 0) & (signs[2]*signs[3] < 0), -through, apart)


def box(a, b, low, high):
    """A segment and a box: their distance, or the shortest of the ways that part them."""
    corner = [low, complex(high.real, low.imag), high, complex(low.real, high.imag)]
    ways = [np.maximum(a.real, b.real) - low.real, high.real - np.minimum(a.real, b.real),
            np.maximum(a.imag, b.imag) - low.imag, high.imag - np.minimum(a.imag, b.imag)]
    if np.any(a != b):
        side = [cross(b - a, c - a)/abs(b - a) for c in corner]
        ways += [np.maximum.reduce(side), -np.minimum.reduce(side)]
    ways = np.minimum.reduce(ways)
    apart = np.minimum.reduce([to_box(a, low, high), to_box(b, low, high)] +
                              ([to_segment(c, a, b) for c in corner] if np.any(a != b) else []))
    return np.where(ways > 0.0, -ways, apart)


def to_box(point, low, high):
    dx = np.maximum(np.maximum(low.real - point.real, point.real - high.real), 0.0)
    dy = np.maximum(np.maximum(low.imag - point.imag, point.imag - high.imag), 0.0)
    return np.hypot(dx, dy)


class Case:
    """A linkage, its links and regions, and the clearance of each in the order of psalm."""

    def __init__(self, draw, number):
        self.linkage = Linkage(draw)
        self.width = [round(draw.uniform(0.0, 4.0), 3) for _ in SEGMENTS]
        self.layer = [draw.randint(0, 1) if number % 2 else 0 for _ in SEGMENTS]
        corner = complex(draw.uniform(20, 120), draw.uniform(20, 100))
        size = complex(draw.uniform(2, 12), draw.uniform(2, 12))
        self.box = [round(x, 3) for x in (corner.real, corner.imag, (corner + size).real, (corner + size).imag)]
        self.hole = [round(draw.uniform(20, 120), 3), round(draw.uniform(20, 100), 3), round(draw.uniform(2, 15), 3)]
        self.room = [60.0, 40.0, round(draw.uniform(120, 180), 3)]
        self.wall = [round(draw.uniform(-60, 0), 3), round(draw.uniform(-60, 0), 3), round(draw.uniform(-40, 60), 3)]
        self.names = []
        for region, of in ((1, range(len(SEGMENTS))), (2, range(len(SEGMENTS))), (3, range(len(SEGMENTS))), (4, (3,))):
            self.names += [(region, s + 1, 0) for s in of]
        self.names += [(5, 0, 0), (6, 0, 0)]
        for s, second in enumerate(SEGMENTS):
            for k, first in enumerate(SEGMENTS[:s]):
                together = set(first) & set(second) or any(set(first + second) <= set(body) for body in BODIES)
                if not together and self.layer[s] == self.layer[k]:
                    self.names.append((0, k + 1, s + 1))

    def value(self, name, degrees):
        region, first, second = name
        p = self.linkage.at(degrees)
        if region == 0:
            (a, b), (c, d) = SEGMENTS[first - 1], SEGMENTS[second - 1]
            v = pair(p[a], p[b], p[c], p[d]) - 0.5*(self.width[first - 1] + self.width[second - 1])
        else:
            a, b = SEGMENTS[first - 1] if first else 'EE'
            a, b = p[a], p[b]
            low, high = complex(*self.box[:2]), complex(*self.box[2:])
            if region in (1, 5):
                v = box(a, b, low, high)
            elif region == 2:
                v = to_segment(complex(*self.hole[:2]), a, b) - self.hole[2]
            elif region == 3:
                v = self.room[2] - np.maximum(abs(a - complex(*self.room[:2])), abs(b - complex(*self.room[:2])))
            elif region == 4:
                away = np.exp(1j*np.radians(self.wall[2] - 90.0))
                v = np.minimum(((a - complex(*self.wall[:2]))*np.conj(away)).real, ((b - complex(*self.wall[:2]))*np.conj(away)).real)
            else:
                v = np.minimum.reduce([a.real + 300.0, 300.0 - a.real, a.imag + 250.0, 200.0 - a.imag])
            if first:
                v = v - 0.5*self.width[first - 1]
        return np.where(np.isfinite(p['F']), v, np.inf)

    def least(self, name):
        """Least value: sampled, then by golden section in the deepest valleys."""
        degrees = np.linspace(0.0, 360.0, SAMPLES + 1)
        values = self.value(name, degrees)
        best, at = values.min(), degrees[values.argmin()]
        step = 360.0/SAMPLES
        deepest = [i for i in range(SAMPLES + 1) if values[i] <= min(values[max(i - 1, 0)], values[min(i + 1, SAMPLES)])]
        centre = np.array([degrees[i] for i in sorted(deepest, key=lambda i: values[i])[:4]])
        low, high = np.maximum(centre - step, 0.0), np.minimum(centre + step, 360.0)
        for _ in range(36):
            one, other = high - GOLDEN*(high - low), low + GOLDEN*(high - low)
            left = self.value(name, one) < self.value(name, other)
            low, high = np.where(left, low, one), np.where(left, other, high)
        refined = self.value(name, 0.5*(low + high))
        if refined.min() < best:
            best, at = refined.min(), (0.5*(low + high))[refined.argmin()]
        return best, at, values

    def text(self):
        d = self.linkage.drawn
        listed = lambda values: ','.join(repr(float(v)) for v in values)
        return f"""MEMBERS THAT KEEP APART
 &CHAIN JNT={','.join(repr(n) for n in d)}, JX={listed(z.real for z in d.values())},
  JY={listed(z.imag for z in d.values())}, LNK='A D G','A B','B C E','C D','E F','F G' &END
 &DRIVES DRIVE='A' &END
 &OUTPUTS OUTPUT='point E' &END
 &METHOD IKIN=10 &END
 &LIMITS TANGLE=90.0 &END
 &CONSTR IRANGE=2, NSEG=6, SJNT='A B','B C','C D','B E','EF','FG', SWIDTH={listed(self.width)},
  SLAYER={','.join(str(v) for v in self.layer)},
  NREGN=6, RKIND=1,3,-3,2,1,-1, RSEG=-1,-1,-1,4,0,0, RJNT(5)='E','E', RPLACE={listed(self.box)}, {listed(self.hole)},0.0,
  {listed(self.room)},0.0, {listed(self.wall)},0.0, {listed(self.box)}, -300.0,-250.0,300.0,200.0 &END
"""


def block(lines, name):
    found = []
    inside = False
    for line in lines:
        if line.startswith('# block '):
            inside = line.split()[2] == name
        elif inside and line.strip() and not line.startswith('#'):
            found.append(line.split())
    return found


def margins(listing):
    """Margins of regions and links in the order of the listing."""
    found = []
    for line in listing.splitlines():
        if line.startswith((' REGION ', ' LINKS ')):
            found.append(float(line[45:60]))
    return found


def main():
    draw = random.Random(20260722)
    cases = [Case(draw, i) for i in range(CASES)]
    with tempfile.TemporaryDirectory() as work:
        files = []
        for i, case in enumerate(cases):
            files.append(f'links{i}.nml')
            with open(os.path.join(work, files[-1]), 'w') as file:
                file.write(case.text())
        widest = 0.0
        for name, case in zip(files, cases):
            run = subprocess.run([BIN + '/psalm', '--quiet', name], cwd=work, capture_output=True, text=True)
            if run.returncode not in (0, 1):
                check(False, f'{name}: {run.stderr}')
                continue
            with open(os.path.join(work, name[:-4] + '.dev9')) as file:
                rows = block(file.read().splitlines(), 'clearance')
            check([tuple(int(x) for x in row[:3]) for row in rows] == case.names, f'{name}: the clearances looked at')
            seen = margins(run.stdout)
            check(len(seen) == len(rows), f'{name}: as many margins as clearances')
            for row, what, margin in zip(rows, case.names, seen):
                low, high, at, asked = (float(x) for x in row[3:7])
                best, where, values = case.least(what)
                at += np.degrees(np.angle(case.linkage.drawn['B'] - case.linkage.drawn['A']))  # inputs count from the drawing
                label = f'{name}, clearance {what}'
                check(low <= best + 1e-11, f'{label}: {low!r} is proven, but {best!r} is taken at {where!r}')
                # at an end of what closes the joints move like a square root
                nearby = [at] if np.all(case.linkage.closed) else [at, at - 1e-9, at + 1e-9]
                there = float(case.value(what, np.array(nearby)).min())
                check(there <= high + (1e-9 if len(nearby) == 1 else 1e-2), f'{label}: at most {high!r} at {at!r}, but {there!r} there')
                if np.all(case.linkage.closed):
                    check(high - low < 1e-7 and abs(best - low) < 1e-6, f'{label}: bracket {low!r} {high!r}, sampled {best!r}')
                    check(abs(margin - best) < 5e-4*max(1.0, abs(best)), f'{label}: margin {margin!r}, sampled {best!r}')
                widest = max(widest, high - low)
    print(f'{passed} passed, {failed} failed')
    sys.exit(failed > 0)


main()
