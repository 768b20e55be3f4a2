// A sketch in motion: closure equations in the poses of its links, Newton's method, continuation; its freedom in words.
//
// A point p of a link lies at t + exp(i phi) p, poses counted from the drawing. Links agree in the joints they share; a slide keeps
// both directions and lets nothing move across its line; a cylinder gives a distance; gears and drives give angles or travels.
// The same equations as psalm's, for the whole sketch at once. Nothing here knows the document.
'use strict';
globalThis.board = globalThis.board || {};

board.motion = (() => {
  const ROUNDS = 40;             // of Newton's method
  const TRUSTED = 0.15;          // first correction against the prediction: beyond it the step is halved
  const FARTHEST = 0.3;          // of the drawing's size: a longer prediction is halved too
  const EASY = 0.01;             // below it the next step is doubled
  const LEAST_STEP = 1e-7;       // of the way
  const RANK_LOST = 1e-11;       // least pivot against the largest
  const RADIAN = Math.PI / 180;

  // ---- linear algebra -----------------------------------------------------------------------------------------------

  /** Solves A x = b in place (rows of A are arrays); gives x, the sign of the determinant, and whether the rank is full. */
  function eliminate(A, b) {
    const n = A.length;
    let sign = 1, largest = 0, least = Infinity;
    for (let k = 0; k < n; k++) {
      let p = k;
      for (let i = k + 1; i < n; i++) if (Math.abs(A[i][k]) > Math.abs(A[p][k])) p = i;
      const pivot = A[p][k];
      largest = Math.max(largest, Math.abs(pivot));
      least = Math.min(least, Math.abs(pivot));
      if (!(Math.abs(pivot) > 1e-300)) return { full: false, sign: 0, x: null };
      if (p !== k) { [A[p], A[k]] = [A[k], A[p]]; [b[p], b[k]] = [b[k], b[p]]; sign = -sign; }
      if (pivot < 0) sign = -sign;
      for (let i = k + 1; i < n; i++) {
        const f = A[i][k] / pivot;
        if (f === 0) continue;
        for (let j = k; j < n; j++) A[i][j] -= f * A[k][j];
        b[i] -= f * b[k];
      }
    }
    const x = new Array(n);
    for (let k = n - 1; k >= 0; k--) {
      let v = b[k];
      for (let j = k + 1; j < n; j++) v -= A[k][j] * x[j];
      x[k] = v / A[k][k];
    }
    return { full: n === 0 || least > RANK_LOST * largest, sign, x };
  }

  /** The same with more equations than unknowns: least squares. */
  function solve(A, b, columns) {
    if (A.length === columns) return eliminate(A.map((row) => row.slice()), b.slice());
    const normal = Array.from({ length: columns }, (_, i) => Array.from({ length: columns }, (_, j) =>
      A.reduce((sum, row) => sum + row[i] * row[j], 0)));
    const right = Array.from({ length: columns }, (_, i) => A.reduce((sum, row, k) => sum + row[i] * b[k], 0));
    return { ...eliminate(normal, right), sign: 1 };
  }

  // ---- equations ----------------------------------------------------------------------------------------------------

  /** Places of a link's joints, moved as little as possible until the exact lengths are kept. */
  function shape(sketch, link, isFrame) {
    const at = new Map(link.joints.map((name) => {
      const { x, y } = sketch.joints.find((joint) => joint.name === name);
      return [name, [x, y]];
    }));
    const held = sketch.lengths.filter((l) => l.joints.every((name) => at.has(name)));
    if (!held.length) return at;
    const names = link.joints, first = at.get(names[0]).slice();
    for (let round = 0; round < ROUNDS; round++) {
      const rows = [], right = [];
      for (const { joints: [a, b], value } of held) {
        const dx = at.get(b)[0] - at.get(a)[0], dy = at.get(b)[1] - at.get(a)[1], d = Math.hypot(dx, dy);
        const row = new Array(2 * names.length).fill(0), i = 2 * names.indexOf(a), k = 2 * names.indexOf(b);
        [row[i], row[i + 1], row[k], row[k + 1]] = [-dx / d, -dy / d, dx / d, dy / d];
        rows.push(row);
        right.push(value - d);
      }
      const worst = Math.max(...right.map(Math.abs));
      if (worst <= 4e-16 * Math.max(...held.map((l) => l.value))) break;
      // the shortest step: a combination of the rows
      const gram = rows.map((u) => rows.map((v) => u.reduce((sum, f, i) => sum + f * v[i], 0)));
      const { x, full } = eliminate(gram, right);
      if (!full) break;
      names.forEach((name, i) => rows.forEach((row, k) => {
        at.get(name)[0] += x[k] * row[2 * i];
        at.get(name)[1] += x[k] * row[2 * i + 1];
      }));
    }
    if (isFrame) {
      const [dx, dy] = [first[0] - at.get(names[0])[0], first[1] - at.get(names[0])[1]];
      for (const place of at.values()) { place[0] += dx; place[1] += dy; }
    }
    return at;
  }

  /** A sketch made ready: points of links in their own axes, rows of equations. */
  function compile(sketch) {
    const index = new Map(sketch.links.map((link, i) => [link.name, i]));
    const joint = new Map(sketch.joints.map((one, i) => [one.name, i]));
    const xs = sketch.joints.map((j) => j.x), ys = sketch.joints.map((j) => j.y);
    const size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys), 1e-12);
    const origin = [], point = [];
    sketch.links.forEach((link, i) => {
      const at = shape(sketch, link, i === 0);
      const slide = sketch.slides.find((s) => s.links.includes(link.name));
      origin[i] = i === 0 ? [0, 0] : link.joints.length ? at.get(link.joints[0]).slice() : slide ? [slide.x, slide.y] : [0, 0];
      point[i] = new Map([...at].map(([name, p]) => [joint.get(name), [p[0] - origin[i][0], p[1] - origin[i][1]]]));
    });
    const of = sketch.joints.map((one) => sketch.links.flatMap((link, i) => link.joints.includes(one.name) ? [i] : []));
    const slides = sketch.slides.map((s) => {
      const [a, b] = s.links.map((name) => index.get(name)), c = Math.cos(s.angle * RADIAN), n = Math.sin(s.angle * RADIAN);
      return { a, b, d: [c, n], p: [s.x - origin[a][0], s.y - origin[a][1]], q: [s.x - origin[b][0], s.y - origin[b][1]] };
    });
    const rows = [];
    of.forEach((links, j) => links.slice(1).forEach((b) => rows.push({ kind: 'pin', a: links[0], b, j })));
    slides.forEach((s, i) => rows.push({ kind: 'same', a: s.a, b: s.b, i }, { kind: 'line', a: s.a, b: s.b, i }));
    sketch.gears.forEach((g, i) => rows.push({ kind: 'gear', a: index.get(g.wheels[0]), b: index.get(g.wheels[1]),
      c: index.get(g.carrier), ratio: -g.teeth[0] / g.teeth[1], i }));
    const drives = [];
    sketch.drives.forEach((drive, k) => {
      const one = { kind: drive.kind, drive: k };
      if (drive.kind === 'cylinder') {
        const [i, j] = drive.at.map((name) => joint.get(name)), from = sketch.joints[i], to = sketch.joints[j];
        drives.push({ ...one, i, j, length: Math.hypot(to.x - from.x, to.y - from.y) });
        return;
      }
      const ends = drive.kind === 'turn' ? of[joint.get(drive.at[0])] || [] : [];
      const s = drive.kind === 'slide' ? sketch.slides.findIndex((slide) => slide.name === drive.at[0]) : -1;
      const links = s >= 0 ? [slides[s].a, slides[s].b] : ends;
      let base = index.get(drive.base), link = index.get(drive.link);
      if (base === undefined && link === undefined) base = Math.min(...links);
      if (base === undefined) base = links.find((l) => l !== link);
      if (link === undefined) link = links.find((l) => l !== base);
      drives.push({ ...one, base, link, slide: s });
    });
    return { sketch, size, origin, point, of, slides, rows, drives, links: sketch.links.length,
      count: rows.reduce((sum, row) => sum + (row.kind === 'pin' ? 2 : 1), 0) + drives.length };
  }

  /** Where a point of a link is, and its derivative by the turn of the link. */
  function place(mech, pose, link, p) {
    const phi = pose[3 * link + 2], c = Math.cos(phi), s = Math.sin(phi), x = c * p[0] - s * p[1], y = s * p[0] + c * p[1];
    return [pose[3 * link] + x, pose[3 * link + 1] + y, -y, x];
  }

  /** Displacement of the second link of a slide along and across its line, with derivatives by both poses. */
  function travel(mech, pose, i) {
    const s = mech.slides[i], [px, py, pdx, pdy] = place(mech, pose, s.a, s.p), [qx, qy, qdx, qdy] = place(mech, pose, s.b, s.q);
    const [ux, uy] = turn(s.d, pose[3 * s.a + 2]), dx = qx - px, dy = qy - py;
    return { along: dx * ux + dy * uy, across: dy * ux - dx * uy, u: [ux, uy],
      by: (n) => ({ b: [n[0], n[1], qdx * n[0] + qdy * n[1]], a: [-n[0], -n[1], -(pdx * n[0] + pdy * n[1])] }), dx, dy };
  }

  const turn = ([x, y], phi) => [x * Math.cos(phi) - y * Math.sin(phi), x * Math.sin(phi) + y * Math.cos(phi)];

  /** Residuals and their matrix by the poses of the moving links (turns times the size); drives at `inputs`. */
  function equations(mech, pose, inputs) {
    const n = 3 * (mech.links - 1), A = [], r = [], { size } = mech;
    const add = (value, parts) => {
      const row = new Array(n).fill(0);
      for (const [link, dx, dy, dphi] of parts) if (link > 0) {
        row[3 * link - 3] += dx;
        row[3 * link - 2] += dy;
        row[3 * link - 1] += dphi / size;
      }
      A.push(row);
      r.push(value);
    };
    for (const row of mech.rows) {
      const { a, b } = row;
      if (row.kind === 'pin') {
        const p = place(mech, pose, a, mech.point[a].get(row.j)), q = place(mech, pose, b, mech.point[b].get(row.j));
        add(q[0] - p[0], [[b, 1, 0, q[2]], [a, -1, 0, -p[2]]]);
        add(q[1] - p[1], [[b, 0, 1, q[3]], [a, 0, -1, -p[3]]]);
      } else if (row.kind === 'same') {
        add(size * (pose[3 * b + 2] - pose[3 * a + 2]), [[b, 0, 0, size], [a, 0, 0, -size]]);
      } else if (row.kind === 'line') {
        const z = travel(mech, pose, row.i), by = z.by([-z.u[1], z.u[0]]);
        by.a[2] -= z.along;
        add(z.across, [[b, ...by.b], [a, ...by.a]]);
      } else {
        const turnOf = (l) => pose[3 * l + 2];
        add(size * (turnOf(b) - turnOf(row.c) - row.ratio * (turnOf(a) - turnOf(row.c))),
          [[b, 0, 0, size], [a, 0, 0, -row.ratio * size], [row.c, 0, 0, (row.ratio - 1) * size]]);
      }
    }
    mech.drives.forEach((drive, k) => {
      if (drive.kind === 'turn') {
        add(size * (pose[3 * drive.link + 2] - pose[3 * drive.base + 2] - inputs[k]), [[drive.link, 0, 0, size], [drive.base, 0, 0, -size]]);
      } else if (drive.kind === 'slide') {
        const s = mech.slides[drive.slide], z = travel(mech, pose, drive.slide), by = z.by(z.u), sense = s.a === drive.base ? 1 : -1;
        by.a[2] += z.across;
        const times = (v) => v.map((f) => sense * f);
        add(sense * z.along - inputs[k], [[s.b, ...times(by.b)], [s.a, ...times(by.a)]]);
      } else {
        const i = mech.of[drive.i][0], j = mech.of[drive.j][0];
        const p = place(mech, pose, i, mech.point[i].get(drive.i)), q = place(mech, pose, j, mech.point[j].get(drive.j));
        const dx = q[0] - p[0], dy = q[1] - p[1], d = Math.hypot(dx, dy) || 1e-300, ux = dx / d, uy = dy / d;
        add(d - drive.length - inputs[k], [[j, ux, uy, ux * q[2] + uy * q[3]], [i, -ux, -uy, -ux * p[2] - uy * p[3]]]);
      }
    });
    return { A, r, n };
  }

  /** Newton's method from where `pose` stands; it is changed. */
  function correct(mech, pose, inputs) {
    let first = 0, before = Infinity, sign = 0, full = true;
    for (let round = 1; round <= ROUNDS; round++) {
      const { A, r, n } = equations(mech, pose, inputs);
      if (A.length < n) return { closed: false };
      const step = solve(A, r.map((v) => -v), n);
      if (!step.x || step.x.some((v) => !isFinite(v))) return { closed: false };
      ({ sign, full } = step);
      const length = Math.max(0, ...step.x.map(Math.abs));
      if (round === 1) first = length;
      if (length > 10 * mech.size) return { closed: false };
      for (let i = 0; i < n; i++) pose[i + 3] += i % 3 === 2 ? step.x[i] / mech.size : step.x[i];
      if (length <= 4e-16 * mech.size || (round > 3 && length >= 0.5 * before && length < 1e-9 * mech.size)) break;
      before = length;
    }
    const worst = Math.max(0, ...equations(mech, pose, inputs).r.map(Math.abs));
    return { closed: worst <= 1e-9 * mech.size, sign, full, first };
  }

  /** The sketch put together at its drawing: poses, or null where that cannot be done. */
  function assemble(mech) {
    const pose = mech.origin.flatMap(([x, y]) => [x, y, 0]), inputs = mech.drives.map(() => 0);
    const { closed, full, sign } = correct(mech, pose, inputs);
    return closed ? { pose, inputs, sign, dead: !full } : null;
  }

  /** Rates of all poses for rates of the inputs; null at a dead point. */
  function velocity(mech, state, rates) {
    const { A, n } = equations(mech, state.pose, state.inputs);
    const right = A.map((_, i) => i < A.length - rates.length ? 0 : rates[i - (A.length - rates.length)] *
      (mech.drives[i - (A.length - rates.length)].kind === 'turn' ? mech.size : 1));
    const { x, full } = solve(A, right, n);
    return full ? x : null;
  }

  /** From a state to other inputs, in steps that stay on the branch, of at least this part of the way; null where the linkage cannot
      get there. */
  function advance(mech, state, target, least = LEAST_STEP) {
    const from = state.inputs.slice(), n = 3 * (mech.links - 1), rates = target.map((v, k) => v - from[k]);
    let way = 0, step = 1, now = state;
    while (way < 1) {
      const x = velocity(mech, now, rates);
      if (!x) return null;
      step = Math.min(step, 1 - way);
      for (;;) {
        const pose = now.pose.slice(), inputs = way + step >= 1 ? target.slice() : from.map((v, k) => v + (way + step) * rates[k]);
        for (let i = 0; i < n; i++) pose[i + 3] += step * (i % 3 === 2 ? x[i] / mech.size : x[i]);
        const predicted = Math.max(1e-7 * mech.size, step * Math.max(0, ...x.map(Math.abs)));
        const { closed, sign, full, first } = correct(mech, pose, inputs);
        if (closed && full && sign === now.sign && first < TRUSTED * predicted && predicted < FARTHEST * mech.size) {
          way = way + step >= 1 ? 1 : way + step;
          now = { pose, inputs, sign, dead: false };
          if (first < EASY * predicted) step *= 2;
          break;
        }
        step *= 0.5;
        if (step < least) return null;
      }
    }
    return now;
  }

  /** Places of all joints, [x, y] each. */
  const joints = (mech, pose) => mech.of.map((links, j) => links.length ? place(mech, pose, links[0], mech.point[links[0]].get(j)).slice(0, 2) :
    [mech.sketch.joints[j].x, mech.sketch.joints[j].y]);

  // ---- positions ----------------------------------------------------------------------------------------------------

  /** Inputs (radians or lengths) of all drives where the first free one has a value in its own unit; `k`: position. */
  function inputsAt(sketch, first, k = -1) {
    return sketch.drives.map((drive, i) => {
      let value = i === 0 ? first : drive.ratio ? drive.ratio * first + drive.phase : k >= 0 ? drive.delt[k] || 0 : 0;
      if (drive.kind === 'turn') value *= RADIAN;
      return value;
    });
  }

  /** Inputs at all positions of the data set. */
  function positions(sketch) {
    const grids = sketch.drives.map((drive) => drive.grid && drive.grid[0] > 1 ? drive.grid : null);
    if (grids.some(Boolean)) return gridPositions(sketch, grids);
    if (sketch.ikin) return Array.from({ length: Math.floor(359 / Math.abs(sketch.ikin)) + 1 },
      (_, k) => inputsAt(sketch, sketch.crnki + k * sketch.ikin, k));
    return sketch.delt.map((value, k) => inputsAt(sketch, sketch.crnki + value, k));
  }

  function gridPositions(sketch, grids) {
    const counts = grids.map((grid) => grid ? grid[0] : 1), total = counts.reduce((a, b) => a * b, 1);
    return Array.from({ length: total }, (_, k) => {
      let rest = k;
      const values = counts.map((count, d) => {
        let digit = rest % count;
        rest = Math.floor(rest / count);
        if (rest % 2) digit = count - 1 - digit;
        return grids[d] ? (grids[d][1] * (count - 1 - digit) + grids[d][2] * digit) / (count - 1) : 0;
      });
      values[0] += sketch.crnki;
      return values.map((value, d) => sketch.drives[d].ratio ? sketch.drives[d].ratio * values[0] + sketch.drives[d].phase : value)
        .map((value, d) => sketch.drives[d].kind === 'turn' ? value * RADIAN : value);
    });
  }

  /** States at rows of inputs, each from the nearest one known; null where it does not close. */
  function follow(mech, start, rows) {
    const known = [start], away = (a, b) => a.reduce((sum, v, i) => sum + (v - b[i]) ** 2, 0);
    return rows.map((inputs) => {
      let best = known[0];
      for (const one of known) if (away(one.inputs, inputs) < away(best.inputs, inputs)) best = one;
      const state = advance(mech, best, inputs);
      if (state) known.push(state);
      return state;
    });
  }

  /** What an output is at a state: its numbers, by the names of the columns of CASE.csv. */
  function output(mech, state, one, first) {
    const at = new Map(joints(mech, state.pose).map((p, j) => [mech.sketch.joints[j].name, p]));
    const name = one.name || [one.kind, ...one.of].join('_'), words = one.of;
    const link = (word) => mech.sketch.links.find((l) => l.name === word);
    const line = (list) => {
      const [a, b] = list.length === 1 && link(list[0]) ? link(list[0]).joints.slice(0, 2) : board.text.jointsIn(list.join(' '), [...at.keys()], (t) => new Error(t));
      return [at.get(b)[0] - at.get(a)[0], at.get(b)[1] - at.get(a)[1]];
    };
    const angle = ([x, y]) => Math.atan2(y, x) / RADIAN;
    const names = (list) => board.text.jointsIn(list.join(' '), [...at.keys()], (t) => new Error(t)).map((n) => at.get(n));
    switch (one.kind) {
    case 'point': { const [p] = names(words); return { [name + '.x']: p[0], [name + '.y']: p[1] }; }
    case 'x': return { [name]: names(words)[0][0] };
    case 'y': return { [name]: names(words)[0][1] };
    case 'pose': { const [p] = names(words.slice(0, 1)); return { [name + '.x']: p[0], [name + '.y']: p[1], [name + '.angle']: angle(line(words.slice(1))) }; }
    case 'angle': return { [name]: angle(line(words)) };
    case 'distance': { const [p, q] = names(words); return { [name]: q ? Math.hypot(q[0] - p[0], q[1] - p[1]) : Math.hypot(...p) }; }
    case 'slide': return { [name]: travel(mech, state.pose, mech.sketch.slides.findIndex((s) => s.name === words[0])).along };
    case 'between': {
      const half = words.length === 2 ? [[words[0]], [words[1]]] : words.length === 4 ? [words.slice(0, 2), words.slice(2)] : [[...words[0]].slice(0, 2), [...words[0]].slice(2)];
      const turned = angle(line(half[1])) - angle(line(half[0]));
      return { [name]: turned - 360 * Math.round(turned / 360) };
    }
    default: return { [name]: NaN };   // a ratio of rates: psalm has it
    }
  }

  // ---- freedom ------------------------------------------------------------------------------------------------------

  /** The sketch with joints and slides anywhere: what holds there holds for almost all dimensions. Always the same places. */
  function anywhere(sketch) {
    let seed = 12345;
    const random = () => { seed = (seed * 1103515245 + 12345) % 2147483648; return seed / 2147483648; };
    const next = () => 1 + 9 * ((random() + random() / 4096) % 1);
    return { ...sketch, lengths: [], joints: sketch.joints.map((j) => ({ ...j, x: next(), y: next() })),
      slides: sketch.slides.map((s) => ({ ...s, x: next(), y: next(), angle: 40 * next() })) };
  }

  /** What is underconstrained and what is overconstrained: links that still move with the drives held, equations that others imply. */
  function freedom(sketch) {
    const mech = compile(anywhere(sketch)), pose = mech.origin.flatMap(([x, y]) => [x, y, 0]);
    const { A, n } = equations(mech, pose, mech.drives.map(() => 0));
    const tags = mech.rows.flatMap((row) => row.kind === 'pin' ? [row, row] : [row]).concat(mech.drives);
    // rows are taken in their order; one that adds nothing is held twice. What special lengths allow is driven all the same
    const basis = [], twice = [], order = A.map((_, k) => k);
    if (sketch.kover) order.sort((a, b) => ('drive' in tags[b]) - ('drive' in tags[a]));
    order.forEach((k) => {
      const row = A[k], v = row.slice(), scale = Math.max(1e-12, ...row.map(Math.abs));
      for (const { column, w } of basis) {
        const f = v[column] / w[column];
        if (f) for (let j = 0; j < n; j++) v[j] -= f * w[j];
      }
      let column = 0;
      for (let j = 1; j < n; j++) if (Math.abs(v[j]) > Math.abs(v[column])) column = j;
      if (n && Math.abs(v[column]) > 1e-9 * scale) basis.push({ column, w: v }); else twice.push(tags[k]);
    });
    const left = n - basis.length;
    return { left, twice, free: left ? freeLinks(basis, n) : [], count: n - (mech.count - mech.drives.length), driven: mech.drives.length };
  }

  /** Links with a part in some motion that all equations allow. */
  function freeLinks(basis, n) {
    const rows = basis.map(({ column, w }) => ({ column, w: w.slice() }));
    for (let i = rows.length - 1; i >= 0; i--) for (let k = 0; k < i; k++) {
      const f = rows[k].w[rows[i].column] / rows[i].w[rows[i].column];
      if (f) for (let j = 0; j < n; j++) rows[k].w[j] -= f * rows[i].w[j];
    }
    const bound = new Map(rows.map((row) => [row.column, row])), moving = new Set();
    for (let free = 0; free < n; free++) {
      if (bound.has(free)) continue;
      moving.add(Math.floor(free / 3) + 1);
      for (const [column, { w }] of bound) if (Math.abs(w[free]) > 1e-7 * Math.abs(w[column])) moving.add(Math.floor(column / 3) + 1);
    }
    return [...moving].sort((a, b) => a - b);
  }

  /** What is wrong with a sketch, in words, and the remedy; empty if it is a mechanism. Each has the names it is about. */
  function assess(sketch) {
    const words = board.words.freedom, say = (text, joints = [], links = []) => [{ text, joints, links }];
    if (!sketch.joints.length) return say(words.empty);
    const home = sketch.joints.filter((j) => !sketch.links.some((l) => l.joints.includes(j.name)));
    if (home.length) return say(words.noLink(home[0].name), [home[0].name]);
    if (sketch.links.length < 2) return say(words.frameOnly);
    for (const link of sketch.links) for (const [i, a] of link.joints.entries()) for (const b of link.joints.slice(0, i)) {
      const [p, q] = [a, b].map((name) => sketch.joints.find((j) => j.name === name));
      if (Math.hypot(p.x - q.x, p.y - q.y) <= 1e-9) return say(words.samePlace(b, a, link.name), [a, b]);
    }
    const reached = new Set([0]), touch = sketch.links.map((link) => (other) => link.joints.some((j) => other.joints.includes(j)) ||
      sketch.slides.some((s) => s.links.includes(link.name) && s.links.includes(other.name)) ||
      sketch.drives.some((d) => d.kind === 'cylinder' && link.joints.includes(d.at[0]) && other.joints.includes(d.at[1])));
    for (let grown = true; grown;) {
      grown = false;
      sketch.links.forEach((link, i) => {
        if (reached.has(i) || ![...reached].some((k) => touch[i](sketch.links[k]) || touch[k](link))) return;
        reached.add(i);
        grown = true;
      });
    }
    const apart = sketch.links.filter((_, i) => !reached.has(i)).map((l) => l.name);
    if (apart.length) return say(words.apart(apart), [], apart);
    const { left, twice, free, count } = freedom(sketch), names = free.map((i) => sketch.links[i].name);
    const held = sketch.drives.map((d) => d.at.join(' '));
    if (twice.length && !(sketch.kover && !twice.some((row) => 'drive' in row))) {
      const row = twice.find((one) => 'drive' in one) || twice[0];
      if ('drive' in row) return say(words.idle(held[row.drive], count, held.length), sketch.drives[row.drive].kind === 'slide' ? [] : sketch.drives[row.drive].at);
      const [a, b] = [row.a, row.b].map((i) => sketch.links[i].name);
      if (row.kind === 'pin') return say(words.heldTwice(sketch.joints[row.j].name, a, b), [sketch.joints[row.j].name], [a, b]);
      return say(words.pairTwice(row.kind === 'gear', a, b), [], [a, b]);
    }
    if (left) {
      const tail = sketch.joints.find((j) => sketch.links.filter((l) => l.joints.includes(j.name)).length === 1 &&
        names.some((name) => sketch.links.find((l) => l.name === name).joints.includes(j.name)) && !sketch.outputs.some((o) => o.of.includes(j.name)));
      if (!sketch.drives.length && left === 1) return say(words.noDrive, [], names);
      return say(words.loose(names, held, left, tail ? tail.name : ''), tail ? [tail.name] : [], names);
    }
    return [];
  }

  return { compile, assemble, advance, correct, joints, travel, positions, inputsAt, follow, output, freedom, assess, eliminate, RADIAN };
})();
