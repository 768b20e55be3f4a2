#!/usr/bin/env python3
"""Kinds of linkages (&KINDS) against an enumeration of its own.

usage: test/law/kind_counts.py PROGRAM_DIRECTORY

Chains are found another way than in the program: links of three and more joints as a multigraph, links of two put on its edges, the least
description over all renumberings of the former. Kinds of them - frame, crank, output, slides, a gear pair - are told apart by all
renumberings, and are counted; psalm --kinds must list as many, no two of them the same. Last line: N passed, N failed.
"""
import hashlib
import itertools
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tools"))
from tally import check, report

PSALM = os.path.join(os.path.abspath(sys.argv[1]), "psalm")
PUBLISHED = {4: 1, 6: 2, 8: 16, 10: 230}         # chains of one freedom with pins
PUBLISHED_TWO = {5: 1, 7: 4, 9: 40}              # of two freedoms
INVERSIONS = {4: 1, 6: 5, 8: 71}


def stiff(n, joints):
    """A part of the links has no freedom left."""
    for k in range(2, n):
        for part in itertools.combinations(range(n), k):
            inside = set(part)
            if 3*(k - 1) - 2*sum(a in inside and b in inside for a, b in joints) < 1:
                return True
    return False


def degree_lists(n, freedom):
    """Joints of the links with more than two: their sum is 3n - 3 - freedom with those of two."""
    found = []
    for many in range(1, n):
        for degrees in itertools.combinations_with_replacement(range(3, n), many):
            if sum(degrees) + 2*(n - many) == 3*n - 3 - freedom:
                found.append(tuple(sorted(degrees, reverse=True)))
    return found


def multigraphs(degrees, freedom):
    """How many paths join each pair of links; a link with itself only where there are two freedoms, one in each of two parts."""
    pairs = list(itertools.combinations(range(len(degrees)), 2))
    if freedom > 1:
        pairs += [(a, a) for a in range(len(degrees))]

    def go(i, left):
        if i == len(pairs):
            if not any(left):
                yield ()
            return
        a, b = pairs[i]
        for m in range((min(left[a], left[b]) if a != b else left[a]//2) + 1):
            rest = list(left)
            rest[a] -= m
            rest[b] -= m
            for more in go(i + 1, rest):
                yield (m,) + more
    return pairs, go(0, list(degrees))


def chains(n, freedom=1):
    """All chains as lists of joints."""
    found = []
    for degrees in degree_lists(n, freedom):
        binaries, many = n - len(degrees), range(len(degrees))
        pairs, graphs = multigraphs(degrees, freedom)
        place = {pair: i for i, pair in enumerate(pairs)}
        # by a renumbering the paths of a pair become those of another
        moves = [tuple(place[tuple(sorted((p[a], p[b])))] for a, b in pairs) for p in itertools.permutations(many)
                 if all(degrees[a] == degrees[p[a]] for a in many)]
        shapes = set()
        for graph in graphs:
            if graph in shapes:
                continue
            images = {}
            for move in moves:
                image = [0]*len(pairs)
                for i, m in enumerate(graph):
                    image[move[i]] = m
                images.setdefault(tuple(image), []).append(move)
            shapes.update(images)
            own = images[graph]
            used = [i for i, m in enumerate(graph) if m]
            seen = set()
            for counts in spread(binaries, len(used)):
                for lengths in itertools.product(*(partitions(c, graph[i]) for c, i in zip(counts, used))):
                    row = [()]*len(pairs)
                    for i, v in zip(used, lengths):
                        row[i] = v
                    if any(v.count(0) > 1 for v in row) or tuple(row) in seen:
                        continue
                    if any(a == b and min(v, default=3) < 3 for (a, b), v in zip(pairs, row)):
                        continue
                    for move in own:
                        image = [()]*len(pairs)
                        for i, v in enumerate(row):
                            image[move[i]] = v
                        seen.add(tuple(image))
                    joints, next_link = [], len(degrees)
                    for (a, b), v in zip(pairs, row):
                        for length in v:
                            last = a
                            for _ in range(length):
                                joints.append((last, next_link))
                                last, next_link = next_link, next_link + 1
                            joints.append((last, b))
                    if not stiff(n, joints) and connected(n, joints):
                        found.append(joints)
    if n == 3 + freedom:
        found.append([(k, k + 1) for k in range(n - 1)] + [(0, n - 1)])
    return found


def connected(n, joints):
    together = list(range(n))
    for a, b in joints:
        together = [together[a] if t == together[b] else t for t in together]
    return len(set(together)) == 1


def partitions(total, places, least=0):
    """Whole numbers in rising order."""
    if places == 1:
        if total >= least:
            yield (total,)
        return
    for first in range(least, total//places + 1):
        for more in partitions(total - first, places - 1, first):
            yield (first,) + more


def spread(total, places):
    if places == 1:
        yield (total,)
        return
    for first in range(total + 1):
        for more in spread(total - first, places - 1):
            yield (first,) + more


def least_form(n, joints, colours):
    """The least description over all renumberings that keep colours, and what follows for the joints from them."""
    marks = [repr(c) for c in colours]
    for _ in range(n):
        marks = [repr((marks[x], sorted((kind, marks[a if b == x else b]) for (a, b), kind in joints.items() if x in (a, b)))) for x in range(n)]
        marks = [hashlib.md5(m.encode()).hexdigest() for m in marks]
    members = [[a for a in range(n) if marks[a] == c] for c in sorted(set(marks))]
    best = None
    for orders in itertools.product(*(itertools.permutations(m) for m in members)):
        number, k = [0]*n, 0
        for order in orders:
            for a in order:
                number[a], k = k, k + 1
        form = tuple(sorted((min(number[a], number[b]), max(number[a], number[b]), kind) for (a, b), kind in joints.items()))
        if best is None or form < best:
            best = form
    return tuple(sorted(marks)), best


def dyads_move_all(n, joints, frame, driven, output):
    """All links follow by dyads, and the output hangs on all of them."""
    beside = {a: set() for a in range(n)}
    for a, b in joints:
        beside[a].add(b)
        beside[b].add(a)
    known, hangs = {frame, driven}, {frame: set(), driven: {driven}}
    while len(known) < n:
        for a, b in joints:
            if a in known or b in known or not (beside[a] & known) or not (beside[b] & known):
                continue
            on = {a, b}.union(*(hangs[c] for c in (beside[a] | beside[b]) & known))
            known |= {a, b}
            hangs[a] = hangs[b] = on
            break
        else:
            return False
    return hangs[output] | {frame} == set(range(n))


def turns(n, joints):
    together = list(range(n))
    for (a, b), kind in joints.items():
        if kind == "=":
            if together[a] == together[b]:
                return False
            old, new = together[b], together[a]
            together = [new if t == old else t for t in together]
    if any(kind != "=" and together[a] == together[b] for (a, b), kind in joints.items()):
        return False                                # wheels, too: between links that slides join they would be locked
    return all(sum(kind == "=" and x in pair for pair, kind in joints.items()) <= 2 for x in range(n))


def forms_with_slides(n, chain, crank, frame, driven, output, may_slide, slides, output_is, gears=()):
    """Forms of the kinds that a chain gives with so many slides in place of pins, those that turn and whose output no simpler one has."""
    pair = next((p for p in chain if set(p) == {frame, output}), None)
    forms = set()
    for chosen in itertools.combinations(may_slide, slides):
        joints = {p: "=" if p in chosen else "*" if p == crank else "-" for p in chain}
        on_frame = joints[pair] if pair else None
        if (on_frame is not None) if output_is != "ANGLE" else on_frame != "-":
            continue
        joints.update(gears)
        if not turns(n, joints):
            continue
        colours = [0]*n
        colours[frame], colours[driven], colours[output] = 1, 2, 3
        forms.add(least_form(n, joints, colours))
    return forms


def own_kinds(n, slides, output_is):
    found = set()
    for chain in chains(n):
        for frame in range(n):
            for crank in chain:
                if frame not in crank:
                    continue
                driven = sum(crank) - frame
                for output in range(n):
                    if output in (frame, driven) or not dyads_move_all(n, chain, frame, driven, output):
                        continue
                    others = [p for p in chain if p != crank]
                    found |= forms_with_slides(n, chain, crank, frame, driven, output, others, slides, output_is)
    return found


def geared_kinds(n, slides, output_is, largest):
    """With a gear pair: kinds in which no fewer links with the frame, the crank and the output have one freedom. Two links of a group at
    most: wheels follow one by one, the others as dyads."""
    found = set()
    for chain in chains(n, 2):
        joined = [sum(1 for a, b in chain if s >> a & s >> b & 1) for s in range(2**n)]
        freedom = [3*(bin(s).count("1") - 1) - 2*joined[s] for s in range(2**n)]
        beside = {a: {b for p in chain for b in p if a in p and b != a} for a in range(n)}
        for arm in range(n):
            for wheels in itertools.combinations(sorted(beside[arm]), 2):
                if wheels in chain or wheels[::-1] in chain:
                    continue
                three = 1 << arm | 1 << wheels[0] | 1 << wheels[1]
                left = [f - (s & three == three) for s, f in enumerate(freedom)]
                if any(left[s] < 1 for s in range(2**n - 1) if bin(s).count("1") > 1):
                    continue
                for crank in chain:
                    for frame in crank:
                        driven = sum(crank) - frame
                        for output in range(n):
                            if output in (frame, driven):
                                continue
                            ends = 1 << frame | 1 << driven | 1 << output
                            if any(left[s] == 1 for s in range(2**n - 1) if s & ends == ends):
                                continue
                            if largest == 2 and not wheel_and_dyads(n, beside, arm, wheels, frame, driven):
                                continue
                            others = [p for p in chain if p != crank and not (arm in p and set(p) & set(wheels))]
                            found |= forms_with_slides(n, chain, crank, frame, driven, output, others, slides, output_is, {wheels: ":"})
    return found


def wheel_and_dyads(n, beside, arm, wheels, frame, driven):
    """All links follow, one wheel from the arm and the other wheel, two links at a time from the others."""
    known = {frame, driven}
    used = False
    while len(known) < n:
        step = None
        for w, other in (wheels, wheels[::-1]):
            if not used and w not in known and {arm, other} <= known and beside[w] & known == {arm}:
                step = {w}
                used = True
        if not step:
            for a in set(range(n)) - known:
                for b in beside[a] - known:
                    if len(beside[a] & known) == 1 and len(beside[b] & known) == 1 and (used or not {arm, *wheels} <= known | {a, b}):
                        step = {a, b}
        if not step:
            return False
        known |= step
    return used


def listed(n, slides, output, gears="0", groups=2):
    name = os.path.join(FOLDER, "kinds.nml")
    with open(name, "w") as out:
        out.write("kinds\n &KINDS LINKS=%d, SLIDES=%d,%d, OUTPUT='%s', GEARS=%s, GROUPS=%d &END\n &METHOD NDES=1 &END\n"
                  % (n, slides, slides, output, gears, groups))
    done = subprocess.run([PSALM, "--kinds", name], capture_output=True, text=True, timeout=300)
    kinds = []
    for line in done.stdout.split("\n"):
        match = re.search(r"((?:\d+\*?[-=:]\d+(?:\(\d+\))? )+) P ON (\d+)", line)
        if not match:
            continue
        joints = {}
        driven = None
        for a, kind, b in re.findall(r"(\d+)(\*?[-=:])(\d+)", match.group(1)):
            joints[(int(a) - 1, int(b) - 1)] = "*" if "*" in kind else kind
            if "*" in kind:
                driven = int(b) - 1
        kinds.append((joints, driven, int(match.group(2)) - 1))
    return kinds, done.stderr


FOLDER = tempfile.mkdtemp(prefix="psalm-kinds-")
for n in (4, 6, 8, 10):
    all_of_them = chains(n)
    check("%d links: %d chains here" % (n, PUBLISHED[n]), len(all_of_them) == PUBLISHED[n], len(all_of_them))
    if n < 10:
        inversions = set()
        for chain in all_of_them:
            for frame in range(n):
                inversions.add(least_form(n, {p: "-" for p in chain}, [x == frame for x in range(n)]))
        check("%d links: %d inversions here" % (n, INVERSIONS[n]), len(inversions) == INVERSIONS[n], len(inversions))
for n, slides, output in ((4, 0, "POINT"), (4, 1, "POINT"), (4, 2, "POINT"), (4, 0, "ANGLE"), (4, 1, "ANGLE"), (6, 0, "POINT"), (6, 1, "POINT"),
                          (6, 2, "POINT"), (6, 0, "ANGLE"), (6, 1, "ANGLE"), (6, 0, "POSE"), (8, 0, "POINT"), (8, 0, "ANGLE")):
    kinds, said = listed(n, slides, output)
    what = "%d links, %d slides, %s" % (n, slides, output)
    forms = set()
    for joints, driven, out in kinds:
        colours = [0]*n
        colours[0], colours[driven], colours[out] = 1, 2, 3
        forms.add(least_form(n, joints, colours))
    check(what + ": no two the same", len(forms) == len(kinds), (len(forms), len(kinds), said))
    own = own_kinds(n, slides, output)
    check(what + ": all of them, %d" % len(own), forms == own, (len(own), len(forms), len(own - forms), len(forms - own)))
for n, number in PUBLISHED_TWO.items():
    found = chains(n, 2)
    check("%d links: %d chains of two freedoms here" % (n, number), len(found) == number, len(found))
for n, slides, output, groups in ((5, 0, "POINT", 2), (5, 0, "POINT", 6), (5, 1, "POINT", 6), (5, 2, "POINT", 6), (5, 1, "ANGLE", 6),
                                  (5, 0, "POSE", 6), (7, 0, "POINT", 2), (7, 0, "POINT", 6), (7, 0, "ANGLE", 6), (7, 1, "ANGLE", 2)):
    kinds, said = listed(n, slides, output, "1", groups)
    what = "%d links with gears, %d slides, %s, GROUPS=%d" % (n, slides, output, groups)
    forms = set()
    for joints, driven, out in kinds:
        colours = [0]*n
        colours[0], colours[driven], colours[out] = 1, 2, 3
        forms.add(least_form(n, joints, colours))
    check(what + ": no two the same", len(forms) == len(kinds) > 0, (len(forms), len(kinds), said))
    own = geared_kinds(n, slides, output, groups)
    check(what + ": all of them, %d" % len(own), forms == own, (len(own), len(forms), len(own - forms), len(forms - own)))
sys.exit(report())
