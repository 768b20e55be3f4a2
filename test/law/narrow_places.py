"""Narrow places: a dyad swings round within a small part of a degree and drives a second loop that is open for part of that.

    narrow_places.py BIN [DRAWS]

The first loop is an almost-kite, a slotted lever or an oscillating cylinder whose crank is longer than the frame by a gap; the
second is a four-bar on its coupler, made here, by formulas of its own, to be open within the swing and nowhere else. BIN/psalm
must tell every one violated, and sound where the second loop is made to close there too. DRAWS (4) second loops for each of the
three first loops and five gaps. Exit status 1 if one is missed.
"""
import cmath
import math
import os
import random
import subprocess
import sys
import tempfile

CRANK = 60.0
GAPS = (6.0E-2, 6.0E-3, 6.0E-4, 6.0E-5, 6.0E-6)
FAMILIES = ('kite', 'slotted lever', 'oscillating cylinder')


def coupler(family, gap, angle):
    """Crank pin, and direction of the arc that the second loop hangs on. The frame joint lies on the x axis."""
    pin = cmath.rect(CRANK, angle)
    # CRANK - gap - CRANK cos(angle), without losing digits
    h = complex(2.0*CRANK*math.sin(0.5*angle)**2 - gap, -CRANK*math.sin(angle))
    d = abs(h)
    if family == 'kite':
        along = 0.5*d/100.0
        return pin, h/d*complex(along, -math.sqrt(1.0 - along*along))
    return pin, h/d


def distances(family, gap, arm, turn, joint, angles):
    found = []
    for angle in angles:
        pin, way = coupler(family, gap, angle)
        found.append(abs(joint - pin - arm*way*turn))
    return found


def second_loop(draw, family, gap):
    """Arm and its angle, frame joint, greatest distance outside the swing and within it, width of a level in degrees."""
    wide = [math.radians(0.25 + 359.5*k/2000) for k in range(2001)]
    fine = [s*10.0**(-9.0 + 9.0*k/400.0)*0.0045 for s in (-1.0, 1.0) for k in range(401)]
    while True:
        arm, turn = draw.uniform(50.0, 150.0), cmath.rect(1.0, draw.uniform(-math.pi, math.pi))
        joint = cmath.rect(draw.uniform(50.0, 300.0), draw.uniform(-math.pi, math.pi))
        outside = max(distances(family, gap, arm, turn, joint, wide + [-0.0045, 0.0045]))
        low = min(distances(family, gap, arm, turn, joint, wide + fine))
        inside = distances(family, gap, arm, turn, joint, fine)
        if max(inside) > 1.02*outside and low > 0.25*outside:
            return arm, turn, joint, outside, max(inside), sorted(zip(fine, inside)), low


def text(family, gap, arm, turn, joint, p, q):
    first = {'kite': ('1,2,3,4,0', '1,0,0,1,0', '100.0,100.0'),
             'slotted lever': ('1,2,3,4,0', '1,0,-2,1,0', '0.0,0.0'),
             'oscillating cylinder': ('1,2,3,4,0', '1,-3,0,1,0', '0.0,0.0')}[family]
    # the direction of a slide is that of its guide turned by a right angle
    angle = math.degrees(cmath.phase(turn)) + (90.0 if family == 'slotted lever' else 0.0)
    frame = -joint
    return (f'NARROW\n &LINKS NLOOP=2, MAXARC=5, ILINK={first[0]}, 1,-2,-3,-4,-4,\n  ILOOP={first[1]}, 1,1,0,0,1,\n'
            f'  ARCL={CRANK!r},{first[2]},{CRANK - gap!r},0.0, 0.0,{arm!r},{p!r},{q!r},\n  {abs(frame)!r},\n'
            f'  GAMA=0.0,0.0,0.0,180.0,0.0, 0.0,{angle - 360.0*round(angle/360.0)!r},0.0,0.0,\n'
            f'  {math.degrees(cmath.phase(frame)) - 180.0!r}, NOUTLK=-3, NOUTLP=2 &END\n'
            ' &METHOD MOTION=0, NDES=3, CRNKI=40.123, DELT=0.0,30.0,60.0 &END\n &LIMITS TANGLE=90.0, TOGGLE=0.0, IPROOF=0 &END\n'
            ' &CONSTR IRANGE=2 &END\n')


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    psalm = os.path.join(sys.argv[1], 'psalm')
    draws = int(sys.argv[2]) if len(sys.argv) > 2 else 4
    draw = random.Random(20)
    passed = failed = 0
    narrowest = math.inf
    with tempfile.TemporaryDirectory() as folder:
        name = os.path.join(folder, 'narrow.nml')
        for family in FAMILIES:
            for gap in GAPS:
                for _ in range(draws):
                    arm, turn, joint, outside, inside, swing, low = second_loop(draw, family, gap)
                    for share, want in ((0.7, 1), (1.3, 0)):
                        reach = outside + share*(inside - outside)
                        # p + q is the reach; nowhere else does the loop open: p - q is less than the least distance
                        p = 0.5*reach + 0.3*low
                        q = reach - p
                        with open(name, 'w') as file:
                            file.write(text(family, gap, arm, turn, joint, p, q))
                        run = subprocess.run([psalm, '--quiet', '--output-dir', folder, name], capture_output=True, text=True)
                        if run.returncode == want:
                            passed += 1
                        else:
                            failed += 1
                            print(f'FAILED: {family}, gap {gap}: exit status {run.returncode} instead of {want}')
                            print(open(name).read() + run.stdout[run.stdout.find(' MARGINS'):])
                        if want:
                            open_at = [angle for angle, distance in swing if distance > reach]
                            narrowest = min(narrowest, math.degrees(max(open_at) - min(open_at)))
    print(f'narrowest gap: {narrowest:.1e} degrees of the crank')
    print(f'{passed} passed, {failed} failed')
    sys.exit(0 if failed == 0 else 1)


main()
