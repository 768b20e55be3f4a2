// The data of a page: typed arrays, interpolation, what is wrong where. Nothing here knows the document.
//
// The scripts are classic ones, each in a function of its own, because browsers refuse modules from file://. They share
// the object `balm`.
'use strict';
globalThis.balm = globalThis.balm || {};

balm.scene = (() => {
  const FORMAT = 1;             // of the data that balm writes
  const OPEN = 2, BEYOND = 1;   // status of a position: does not close, a transmission angle is beyond its limits
  const HERE = 1e-6;            // places nearer than this are one
  const NOISE = 1e-12;          // part of the size of a linkage that is rounding

  const modulo = (a, b) => ((a % b) + b) % b;
  const filled = (values) => Float64Array.from(values, (v) => v === null ? NaN : v);
  const moving = (rows) => rows.map((v) => Array.isArray(v) ? filled(v) : v === null ? NaN : v);

  /** The cases of a page; the format must be the one the scripts were written for. */
  function read(text) {
    const data = JSON.parse(text);
    if (data.format !== FORMAT) throw new Error('format ' + data.format + ' of the data, ' + FORMAT + ' is expected');
    return data.cases;
  }

  /** Typed arrays, status of every position of the sweep, range of the inputs. Comes before anything else. */
  function prepare(c) {
    if (c.ready || !c.sound) return c;
    const s = c.sweep, p = c.prescribed, n = s.n;
    c.ready = true;
    c.ring = !c.sliding;
    for (const row of [s, p]) {
      for (const key of ['x', 'y', 'ux', 'uy']) row[key] = moving(row[key]);
      for (const key of ['actual', 'actual_y', 'actual_mark_x', 'actual_mark_y', 'error', 'error_y'])
        if (row[key]) row[key] = filled(row[key]);
      for (const a of row.angle) a.values = filled(a.values);
    }
    for (const other of s.others) [other.x, other.y] = [filled(other.x), filled(other.y)];
    if (c.forces) prepareForces(c.forces);
    if (c.clearance) for (const key of ['px', 'py', 'fx', 'fy', 'force']) c.clearance[key] = filled(c.clearance[key]);
    if (c.vibration) c.vibration.modes = c.vibration.modes.map(filled);
    for (const one of [...c.curves || [], ...c.drives || []])
      [one.prescribed, one.sweep] = [filled(one.prescribed), filled(one.sweep)];
    c.panels = (c.panels || []).map((panel) => ({ ...panel,
      lines: panel.lines.map((one) => ({ ...one, values: filled(one.values) })) }));
    if (c.band) c.band = c.band.map(({ square, worst }) => ({ square: filled(square), worst: filled(worst) }));
    c.at = p.at;
    c.broken = new Map();
    for (const [i, loop, ...tip] of s.broken) {
      if (!c.broken.has(i)) c.broken.set(i, []);
      c.broken.get(i).push([loop, tip]);
    }
    c.wrong = Array.from({ length: n }, () => []);
    c.status = new Uint8Array(n);
    for (const v of s.violations) for (let i = v.first; i <= v.last; i++) {
      c.wrong[i].push(v);
      c.status[i] = Math.max(c.status[i], BEYOND);
    }
    for (let i = 0; i < n; i++) if (c.broken.has(i) || s.closed[i] === '0') c.status[i] = OPEN;
    const last = Math.max(...c.at);
    c.ends = [0, c.ring ? 360 : n - 1];
    c.limited = c.ring && 360 - last > 60 && p.n > 1;
    c.range = c.limited ? [0, last] : c.ends.slice();
    c.bar = c.bars.find((b) => b.loop === 1 && b.arc === 1);
    c.size = Math.max(c.view[2] - c.view[0], c.view[3] - c.view[1]);
    c.px = new Float64Array(c.joints.length);   // joints as drawn last
    c.py = new Float64Array(c.joints.length);
    if (c.motion === 'angle') goOn(c);
    if (c.proof) for (const mark of c.proof.marks) if ('input' in mark) mark.t = placeOf(c, mark.input);
    return c;
  }

  /** Typed arrays of the forces, and the largest load and bearing load, which the drawing is scaled by. */
  function prepareForces(f) {
    for (const key of ['drive', 'fx', 'fy', 'moment']) f[key] = filled(f[key]);
    f.weights = f.weights || [];
    f.springs = f.springs || [];
    if (f.bare) for (const key of ['drive', 'fx', 'fy', 'moment']) f.bare[key] = filled(f.bare[key]);
    for (const one of [...f.centres, ...f.loads, ...f.joints, ...f.weights, ...f.springs])
      for (const key of ['x', 'y', 'x2', 'y2', 'footx', 'footy', 'footx2', 'footy2', 'fx', 'fy']) if (one[key]) one[key] = filled(one[key]);
    const peak = (one) => one.fx.reduce((most, v, i) => Math.max(most, Math.hypot(v, one.fy[i]) || 0), 0);
    for (const one of [...f.loads, ...f.joints]) one.peak = peak(one);
    f.largest = Math.max(0, ...f.loads.map((one) => one.peak));
    const most = (...rows) => rows.reduce((top, row) => row.reduce((m, v) => Math.max(m, Math.abs(v) || 0), top), 0);
    // what the joints bear tells what of a force is rounding
    f.force = Math.max(0, ...f.joints.map((one) => one.peak));
    f.turning = most(f.drive, f.moment);
  }

  /** Corners of a spring between two points, drawn with eight coils. */
  function coil(x1, y1, x2, y2, half) {
    const COILS = 8, HOOK = 0.14, dx = x2 - x1, dy = y2 - y1, length = Math.hypot(dx, dy) || 1, points = [[x1, y1], [x1 + HOOK * dx, y1 + HOOK * dy]];
    for (let i = 1; i <= 2 * COILS; i++) {
      const part = HOOK + (1 - 2 * HOOK) * (i - 0.5) / (2 * COILS), side = (i % 2 ? half : -half) / length;
      points.push([x1 + part * dx - side * dy, y1 + part * dy + side * dx]);
    }
    return [...points, [x2 - HOOK * dx, y2 - HOOK * dy], [x2, y2]];
  }

  /** Points of a torsional spring of two and a half turns around a joint. */
  function spiral(x, y, radius) {
    return Array.from({ length: 41 }, (_, i) => {
      const angle = i * Math.PI / 8, r = radius * (0.3 + 0.7 * i / 40);
      return [x + r * Math.cos(angle), y + r * Math.sin(angle)];
    });
  }

  /** An angle goes on from the one before it; the curve then lies nearest to the desired values. */
  function goOn(c) {
    const a = c.sweep.actual, p = c.prescribed;
    let before = NaN;
    for (let i = 0; i < a.length; i++) {
      if (!isFinite(a[i])) continue;
      if (isFinite(before)) a[i] -= 360 * Math.round((a[i] - before) / 360);
      before = a[i];
    }
    const near = (k) => a[Math.round(c.at[k]) % a.length];
    const k = p.actual.findIndex((v, i) => isFinite(v) && isFinite(near(i)));
    if (k < 0 || !p.desired) return;
    const turn = 360 * Math.round((p.actual[k] - near(k)) / 360);
    for (let i = 0; i < a.length; i++) a[i] += turn;
  }

  /** Input at a place t of the sweep: degrees that go on, or a length. */
  function inputAt(c, t) {
    const from = c.sweep.input[0], n = c.sweep.n;
    if (c.ring) return from + c.sense * t;
    return from + (c.sweep.input[n - 1] - from) * t / Math.max(1, n - 1);
  }

  /** Place of the sweep where an input is. */
  function placeOf(c, input) {
    const from = c.sweep.input[0], n = c.sweep.n;
    if (c.ring) return modulo(c.sense * (input - from), 360);
    return (input - from) / (c.sweep.input[n - 1] - from) * (n - 1);
  }

  /** Place t brought into the limits [from, to]; a whole turn begins anew. */
  function within(c, t, [from, to]) {
    return c.ring && to - from >= 360 ? modulo(t, 360) : Math.min(to, Math.max(from, t));
  }

  /** Place t between two positions of the sweep: lower, upper, part. Beside an open position: the nearer one. */
  function between(c, t) {
    const n = c.sweep.n;
    let i = Math.floor(t), f = t - i;
    if (c.ring) i = modulo(i, n); else if (i >= n - 1) { i = n - 1; f = 0; }
    let k = c.ring ? (i + 1) % n : Math.min(i + 1, n - 1);
    if (c.status[i] === OPEN || c.status[k] === OPEN) { if (f > 0.5) i = k; k = i; f = 0; }
    return [i, k, f];
  }

  /** A value there; what does not move is one number. */
  const mixed = (v, [i, k, f]) => typeof v === 'number' ? v : f === 0 ? v[i] : v[i] + f * (v[k] - v[i]);

  /** Index of the prescribed position at t, or -1. */
  function prescribedAt(c, t) {
    let best = -1, least = HERE;
    c.at.forEach((at, i) => {
      if (Math.abs(at - t) < least) [best, least] = [i, Math.abs(at - t)];
    });
    return best;
  }

  /** Place of the next prescribed position in the direction `way`; beyond the last comes the first. */
  function prescribedNext(c, t, way) {
    const list = [...c.at].sort((a, b) => a - b);
    const next = way > 0 ? list.find((at) => at > t + HERE) : list.findLast((at) => at < t - HERE);
    return next ?? (way > 0 ? list[0] : list.at(-1));
  }

  /** The table of the sweep: names, and a row of numbers for each of its positions; what is not known is no number. */
  function table(c) {
    const s = c.sweep, names = [c.time ? 'time' : 'input', 'closed'], columns = [Array.from({ length: s.n }, (_, i) => inputAt(c, i)),
      Array.from(s.closed, Number)];
    const add = (name, values) => { names.push(name); columns.push(values); };
    if (c.drives) for (const one of c.drives) add('drive ' + one.name, one.sweep);
    if (c.curves) for (const one of c.curves) add(one.name, one.sweep);
    else if (c.motion === 'point') { add('output x', s.actual); add('output y', s.actual_y); } else add(c.motion, s.actual);
    (c.band || []).forEach(({ square, worst }, i) => {
      const which = c.band.length > 1 ? ' ' + ['x', 'y', 'angle'][i] : '';
      add('root-sum-square deviation' + which, square);
      add('worst deviation' + which, worst);
    });
    for (const panel of c.panels) for (const one of panel.lines) add((panel.name + ' ' + one.label).trim(), one.values);
    for (const a of s.angle) add('transmission angle of ' + a.name, a.values);
    c.joints.forEach((joint, j) => {
      if (!joint.name) return;
      for (const key of ['x', 'y']) add(joint.name + '.' + key, typeof s[key][j] === 'number' ? Array(s.n).fill(s[key][j]) : s[key][j]);
    });
    return { names, rows: Array.from({ length: s.n }, (_, i) => columns.map((values) => values[i])) };
  }

  /** A table as comma separated values; names are in quotes where they must be, unknown fields are empty. */
  function csv({ names, rows }) {
    const quoted = (name) => /[",\n]/.test(name) ? '"' + name.replaceAll('"', '""') + '"' : name;
    return [names.map(quoted), ...rows.map((row) => row.map((v) => Number.isFinite(v) ? String(v) : ''))]
      .map((row) => row.join(',') + '\r\n').join('');
  }

  /** What the axis of the input is called. */
  const inputName = (c) => c.inputLabel || (c.sliding ? 'input, length' : 'crank angle, degrees');

  /** Seven digits. */
  const { short } = scales;

  /** Seven digits of an output, without what is rounding only. */
  function shortOutput(c, v) {
    if (c.motion === 'angle') return short(isFinite(v) ? Number(v.toFixed(9)) : v);
    return short(Math.abs(v) < NOISE * c.size ? 0 : v);
  }

  /** A title with its beginning and its end, where there is no room for all: ranks of a search differ at the end. */
  function shortTitle(title, most) {
    if (title.length <= most) return title;
    const tail = Math.floor((most - 1) / 2);
    return title.slice(0, most - 1 - tail).trimEnd() + '\u2026' + title.slice(title.length - tail).trimStart();
  }

  /** What is wrong at position i of the sweep: the violation, and by how much the pair is apart here. */
  function explain(c, violation, i) {
    const gap = (c.broken.get(i) || []).find(([loop]) => loop === violation.loop - 1);
    const here = gap ? Math.hypot(gap[1][2] - gap[1][0], gap[1][3] - gap[1][1]) : 0;
    return violation.text + (here > 0 ? '; here by ' + short(Number(here.toPrecision(5))) : '');
  }

  /** The view with the other assemblies in it, as far as it does not grow to more than three times its size. */
  function withOthers(c, view) {
    const room = Math.max(view[2] - view[0], view[3] - view[1]), grown = view.slice();
    for (const { x, y } of c.sweep.others) for (let t = 0; t < c.sweep.n; t += Math.ceil(c.sweep.n / 72)) {
      if (!(isFinite(x[t]) && isFinite(y[t]))) continue;
      grown[0] = Math.min(grown[0], Math.max(x[t], view[0] - room));
      grown[1] = Math.min(grown[1], Math.max(y[t], view[1] - room));
      grown[2] = Math.max(grown[2], Math.min(x[t], view[2] + room));
      grown[3] = Math.max(grown[3], Math.min(y[t], view[3] + room));
    }
    return grown;
  }

  return { OPEN, BEYOND, read, prepare, table, csv, inputAt, inputName, within, between, mixed, modulo, prescribedAt, prescribedNext, short, coil, spiral,
    shortOutput, shortTitle, explain, withOthers };
})();
