"""Linkages with two slides (dyads of type 8) that psalm tells sound, scanned by an independent solver.

    slide_pairs.py BIN [LINKAGES [INPUTS [SEED]]]

draws linkages of one to four loops, at least one of type 8 among their dyads, and assesses each by `BIN/psalm` over a range of the
input or a full turn. What is told sound is made to be only just so: a dimension, or the end of the range, is moved until psalm
tells it violated, and bisected. LINKAGES of these (60) are looked at by the solver below at INPUTS inputs (2000): none may have an
open loop there, and between two inputs the sine between two slides may not change its sign. Margins that are proven must hold those
that are looked for in their brackets. The long run, about a quarter of an hour:

    slide_pairs.py build/local/bin 1000 20000

Prints what it did; exit status 1 if a linkage is refuted or the solver's positions are not those of psalm.
The solver follows the manual ("How a linkage is described") and shares nothing with psalm.
"""
import cmath
import math
import os
import random
import subprocess
import sys
import tempfile

DEGREE = math.pi/180.0
TYPES = (1, 2, 3, 4, 5, 8)


class Loop:
    """Arcs before p: those of loop `on` before its p, and one fixed to its p. Then p, q and one arc of the frame."""

    def __init__(self, number, on, kind, draw):
        self.on, self.kind = on, kind
        self.before = 1 if number == 1 else on.before + 1
        self.sign = draw.choice((1, -1))
        self.sign_q = draw.choice((1, -1)) if kind in (4, 5, 8) else self.sign
        self.sign_p = self.sign if kind != 5 else draw.choice((1, -1))
        if kind == 5:
            self.sign_q = self.sign
        self.length = draw.uniform(10.0, 30.0) if number == 1 else draw.uniform(20.0, 90.0)
        self.angle = 0.0 if number == 1 else draw.uniform(-180.0, 180.0)
        self.p, self.q = draw.uniform(50.0, 150.0), draw.uniform(50.0, 150.0)
        if kind in (2, 3):
            self.p = self.q = draw.uniform(2.0, 30.0)
        self.frame = draw.uniform(40.0, 140.0)
        self.frame_angle = draw.uniform(-180.0, 180.0)


    def turned_by(self):
        """The loops that the direction of p hangs on."""
        return self.needed() if self.kind in (1, 2, 3, 4) else self.on.turned_by() if self.on else set()

    def needed(self):
        """The loops that must be solved for this one, itself included."""
        found, loop = {self}, self
        while loop.on:
            found |= loop.on.turned_by()
            loop = loop.on
        return found


class Linkage:
    def __init__(self, draw):
        self.needed = set()
        while not any(loop.kind == 8 for loop in self.needed):
            self.loops = []
            for number in range(1, draw.randint(1, 4) + 1):
                on = draw.choice(self.loops) if self.loops else None
                self.loops.append(Loop(number, on, draw.choice(TYPES), draw))
            self.needed = self.loops[-1].needed()
        self.turn = draw.random() < 0.4
        self.start = draw.uniform(0.0, 360.0)
        self.range = 360.0 if self.turn else draw.uniform(20.0, 200.0)

    def knobs(self):
        """What can be moved: attribute names with their owners."""
        found = [] if self.turn else [(self, 'range')]
        for loop in self.loops:
            found += [(loop, 'length'), (loop, 'frame')]
            found += [(loop, 'p')] if loop.kind in (1, 4) else []
            found += [(loop, 'q')] if loop.kind in (1, 5) else []
        return found

    def text(self, proof=0):
        arcs = max(loop.before for loop in self.loops) + 3
        ilink, iloop, arcl, gama = [], [], [], []
        for number, loop in enumerate(self.loops, 1):
            link, where, length, angle = [], [], [], []
            if number == 1:
                link, where, length, angle = [1], [1], [loop.length], [0.0]
            else:
                on = self.loops.index(loop.on) + 1
                for a in range(1, loop.on.before + 1):
                    link.append(a)
                    where.append(on)
                    length.append(0.0)
                    angle.append(0.0)
                link.append(-(loop.on.before + 1))
                where.append(on)
                length.append(loop.length)
                angle.append(loop.angle)
            b = loop.before
            p, q, f = b + 1, b + 2, b + 3
            link += [loop.sign_p*p, loop.sign_q*q]
            where += {1: [0, 0], 2: [-q, 0], 3: [0, -p], 4: [0, -f], 5: [-b, 0], 8: [-b, -f]}[loop.kind]
            length += [{1: loop.p, 3: loop.p, 4: loop.p}.get(loop.kind, 0.0), {1: loop.q, 2: loop.q, 5: loop.q}.get(loop.kind, 0.0)]
            angle += [0.0, 0.0]
            if number == 1:
                link.append(f)
                where.append(1)
            else:
                link.append(-(self.loops[0].before + 3))
                where.append(1)
            length.append(loop.frame)
            angle.append(loop.frame_angle)
            pad = [0]*(arcs - len(link))
            ilink += link + pad
            iloop += where + pad
            arcl += length + pad
            gama += angle + pad
        last = self.loops[-1]

        def row(values):
            return ',\n  '.join(','.join(repr(v) for v in values[k:k + 6]) for k in range(0, len(values), 6))
        stops = [self.range*k/6.0 for k in range(6 if self.turn else 7)]
        return (f'SLIDES\n &LINKS NLOOP={len(self.loops)}, MAXARC={arcs},\n  ILINK={row(ilink)},\n  ILOOP={row(iloop)},\n'
                f'  ARCL={row(arcl)},\n  GAMA={row(gama)},\n  NOUTLK={-(last.before + 2)}, NOUTLP={len(self.loops)} &END\n'
                f' &METHOD MOTION=0, CRNKI={self.start!r}, NDES={len(stops)}, DELT={row(stops)} &END\n'
                f' &LIMITS KTHETA=1, TOGGLE=0.0, IPROOF={proof} &END\n'
                f' &CONSTR IRANGE={2 if self.turn else 1} &END\n')

    def solve(self, input_angle):
        """Joint of p and q of the last loop, whether all loops close, sines between slides. None: a loop is open."""
        sines = []
        base = self.loops[0].frame_angle
        for number, loop in enumerate(self.loops, 1):
            if number == 1:
                arm = cmath.rect(1.0, input_angle*DEGREE)
                start = loop.length*arm
                frame = cmath.rect(1.0, base*DEGREE)
            else:
                arm = loop.on.along*cmath.rect(1.0, loop.angle*DEGREE)
                start = loop.on.start + loop.length*arm
                frame = cmath.rect(1.0, (base + loop.frame_angle)*DEGREE)
            if loop not in self.needed:
                # psalm does not solve it, and nothing hangs on what it finds
                loop.start = start
                loop.along = arm*1j*loop.sign_p
                continue
            # the frame arc leads to the input pivot
            finish = -loop.frame*frame
            h = finish - start
            d = abs(h)
            kind = loop.kind
            if kind in (1, 2, 3):
                if d == 0.0:
                    return None
                if kind == 1:
                    along = (d*d + loop.p**2 - loop.q**2)/(2.0*d)
                    rest = (loop.p - along)*(loop.p + along)
                else:
                    guide = loop.q if kind == 2 else loop.p
                    if d < guide:
                        return None
                    slide = math.sqrt(d*d - guide*guide)
                    along = (slide*slide if kind == 2 else guide*guide)/d
                    rest = (slide*guide/d)**2
                if rest < 0.0:
                    return None
                # right of the way from start to finish
                joint = start + (along - 1j*loop.sign*math.sqrt(rest))*h/d
                # a slide has its guide's direction turned, whatever its length
                if kind == 2:
                    loop.along = (finish - joint)/guide*(1j*loop.sign*-1.0)
                else:
                    loop.along = (joint - start)/loop.p
            elif kind == 8:
                u = arm*1j*loop.sign_p
                v = frame*-1j*loop.sign_q
                sine = (u.conjugate()*v).imag
                sines.append(sine)
                if sine == 0.0:
                    return None
                joint = start + u*((h.conjugate()*v).imag/sine)
                loop.along = u
            else:
                u = frame*-1j*loop.sign_q if kind == 4 else arm*1j*loop.sign_p
                centre, through, link = (start, finish, loop.p) if kind == 4 else (finish, start, loop.q)
                foot = through + ((centre - through)*u.conjugate()).real*u
                rest = link*link - abs(centre - foot)**2
                if rest < 0.0:
                    return None
                joint = foot + loop.sign*math.sqrt(rest)*u
                loop.along = (joint - start)/loop.p if kind == 4 else u
            loop.start = start
        return joint, sines


def assess(psalm, linkage, folder):
    """Exit status and margin list of psalm."""
    name = os.path.join(folder, 'slides.nml')
    with open(name, 'w') as file:
        file.write(linkage.text())
    run = subprocess.run([psalm, '--quiet', '--output-dir', folder, name], capture_output=True, text=True)
    if run.returncode not in (0, 1):
        print(linkage.text(), run.stderr)
        sys.exit('psalm refuses a linkage of this test')
    return run.returncode == 0


def compare(linkage, folder):
    """Largest distance of psalm's positions from the solver's, relative to the linkage."""
    worst = 0.0
    with open(os.path.join(folder, 'slides.dev9')) as file:
        for line in file:
            if line.startswith('# block '):
                break
            if line.startswith('#') or not line.strip():
                continue
            words = line.split()
            found = linkage.solve(float(words[0]))
            if found is None or words[1] != '1':
                return math.inf
            worst = max(worst, abs(found[0] - complex(float(words[2]), float(words[3])))/(100.0 + abs(found[0])))
    return worst


def margins(linkage, psalm, folder):
    """What is wrong with proven margins: lists of those compared, and of those that the margins looked for refute."""
    name = os.path.join(folder, 'slides.nml')
    with open(name, 'w') as file:
        file.write(linkage.text(proof=2 if linkage.turn is False else 1))
    run = subprocess.run([psalm, '--quiet', '--output-dir', folder, name], capture_output=True, text=True)
    looked_for, proven, last = {}, {}, None
    for line in run.stdout.splitlines():
        words = line.rsplit(None, 3) if line.endswith(('KEPT', 'VIOLATED')) else line.rsplit(None, 2)
        if ', LOOP ' not in line or len(words) < 3:
            if line.startswith('     AT MOST ') and last:
                proven[last][1] = float(words[-1])
            last = None
            continue
        key, value = words[0].strip(), words[1].replace('D', 'E')
        if line.startswith('   '):
            if line.endswith('KEPT'):
                proven[key] = [float(value), None]
                last = key
        elif key.startswith(('TRANSMISSION', 'ANGLE', 'GUIDE', 'OFFSET')):
            looked_for[key] = float(value)
    if ' CLOSES FOR EVERY' not in run.stdout:
        return 0, []
    wrong = []
    for key, value in looked_for.items():
        if key not in proven:
            wrong.append(f'{key}: not among the proven margins')
            continue
        low, high = proven[key]
        slack = 6.0E-7*max(abs(value), 1.0) # seven digits are printed
        if not low <= value + slack or not value <= (high or low) + slack + 1.0E-4:
            wrong.append(f'{key}: {value} is not in the bracket {low}, {high}')
    return len(looked_for), wrong


def refuted(linkage, inputs):
    """The first input at which the solver finds the linkage open, or past parallel slides; None: sound."""
    signs = None
    for k in range(inputs + 1):
        at = linkage.start + linkage.range*k/inputs
        found = linkage.solve(at)
        if found is None:
            return at
        now = [sine > 0.0 for sine in found[1]]
        if signs is not None and now != signs:
            return at
        signs = now
    return None


def tune(psalm, linkage, draw, folder):
    """Move one number of a sound linkage to where psalm begins to tell it violated, and stop just before."""
    owner, name = draw.choice(linkage.knobs())
    sound = getattr(owner, name)
    factor = draw.choice((0.2, 0.5, 2.0, 4.0)) if name != 'range' else draw.choice((1.5, 2.0))
    wrong = sound*factor if name != 'range' else min(359.0, sound*factor)
    setattr(owner, name, wrong)
    if assess(psalm, linkage, folder):
        return False
    for _ in range(18):
        middle = 0.5*(sound + wrong)
        setattr(owner, name, middle)
        if assess(psalm, linkage, folder):
            sound = middle
        else:
            wrong = middle
    setattr(owner, name, sound)
    return True


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    psalm = os.path.join(sys.argv[1], 'psalm')
    wanted, inputs, seed = (int(a) for a in (sys.argv[2:] + ['60', '2000', '8'][len(sys.argv) - 2:])[:3])
    draw = random.Random(seed)
    drawn = sound = tuned = turns = wrong = compared = 0
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        while sound < wanted:
            linkage = Linkage(draw)
            drawn += 1
            if refuted(linkage, 60) is not None or not assess(psalm, linkage, folder):
                continue
            sound += 1
            turns += linkage.turn
            tuned += tune(psalm, linkage, draw, folder)
            if not assess(psalm, linkage, folder):
                sys.exit('the tuned linkage is not sound')
            worst = max(worst, compare(linkage, folder))
            more, differ = margins(linkage, psalm, folder)
            compared += more
            if differ:
                wrong += 1
                print('FAILED: margins\n', '\n'.join(differ), linkage.text(), sep='')
            at = refuted(linkage, inputs)
            if at is not None:
                wrong += 1
                print(f'FAILED: told sound, refuted at {at!r}\n{linkage.text()}')
    print(f'{drawn} linkages drawn, {sound} told sound ({turns} over a full turn, {tuned} only just), '
          f'{wrong} refuted at {inputs} inputs; positions differ by {worst:.1e}; {compared} margins lie in their proven brackets')
    good = wrong == 0 and worst < 1.0e-7 and compared > 0
    print(f'{int(good)} passed, {int(not good)} failed')
    sys.exit(0 if good else 1)


if __name__ == '__main__':
    main()
