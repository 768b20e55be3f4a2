// Unit tests of what the page computes. `results` lists [law, good, detail].
'use strict';

globalThis.results = [];

(() => {
  const { scene, curves } = balm;
  const near = (a, b, within = 1e-12) => Math.abs(a - b) <= within;
  const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

  function check(law, good, detail = '') {
    results.push([law, Boolean(good), String(detail)]);
  }

  /** True if the procedure refuses. */
  function refuses(procedure) {
    try { procedure(); } catch { return true; }
    return false;
  }

  /** A case of balm in small: a crank at four positions of its turn, one moving joint, nothing wrong. */
  function small(changes = {}) {
    const zeros = [0, 0, 0, 0];
    const row = () => ({ n: 4, delt: [0, 90, 180, 270], input: [10, 100, 190, 280], actual: [1, 2, 3, 4], actual_y: zeros.slice(),
      closed: '1111', x: [0, [1, 0, -1, 0]], y: [0, [0, 1, 0, -1]], ux: [], uy: [], angle: [], broken: [], violations: [] });
    return { title: 'A crank', sound: true, motion: 'distance', sliding: false, desired: false, limits: [30, 150], sense: 1,
      loops: 1, output: 1, base: 0, reference: 0, view: [-1, -1, 1, 1], errors: [], warnings: [], breaches: [],
      joints: [{ name: 'A' }, { name: 'B' }], bars: [{ from: 0, to: 1, loop: 1, arc: 1, slide: -1, body: 0, length: 1 }],
      bodies: [], slides: [], pairs: [{ type: 'RRR', start: 0, shared: 1, finish: 0 }], regions: [],
      prescribed: { ...row(), at: [0, 90, 180, 270] }, sweep: { ...row(), others: [] }, ...changes };
  }

  const sample = () => scene.read(document.getElementById('data').textContent);

  // ---- data ---------------------------------------------------------------------------------------------------------

  check('the sample has two sound cases', sample().length === 2 && sample().every((c) => c.sound));
  check('another format is refused', refuses(() => scene.read('{"format":2,"cases":[]}')) &&
    refuses(() => scene.read('{"cases":[]}')) && !refuses(() => scene.read('{"format":1,"cases":[]}')));

  const c = scene.prepare(small());
  check('moving values become typed arrays, others stay numbers', c.sweep.x[1] instanceof Float64Array && c.sweep.x[0] === 0);
  check('prepared once', scene.prepare(c) === c && c.sweep.x[1] instanceof Float64Array);
  const unsound = scene.prepare({ sound: false });
  check('a case of messages only stays as it is', !unsound.ready && Object.keys(unsound).length === 1);
  const gap = small();
  gap.sweep.actual[2] = null;
  scene.prepare(gap);
  check('what is not known is no number', Number.isNaN(gap.sweep.actual[2]) && gap.sweep.actual[1] === 2);

  const bad = small();
  bad.sweep.closed = '1101';
  bad.sweep.violations = [{ loop: 1, first: 1, last: 2, text: 'Loop 1: too short' }];
  bad.sweep.broken = [[2, 0, 0, 0, 3, 4]];
  scene.prepare(bad);
  check('status: closes, beyond limits, open', same([...bad.status], [0, scene.BEYOND, scene.OPEN, 0]), bad.status);
  check('violations are known at each of their positions', same(bad.wrong.map((w) => w.length), [0, 1, 1, 0]));
  check('explained with the gap where there is one', scene.explain(bad, bad.wrong[2][0], 2) === 'Loop 1: too short; here by 5' &&
    scene.explain(bad, bad.wrong[1][0], 1) === 'Loop 1: too short', scene.explain(bad, bad.wrong[2][0], 2));

  // ---- places -------------------------------------------------------------------------------------------------------

  check('between two positions', same(scene.between(c, 1.25), [1, 2, 0.25]));
  check('a ring goes on', same(scene.between(c, 3.5), [3, 0, 0.5]) && same(scene.between(c, -0.5), [3, 0, 0.5]));
  check('beside an open position stands the nearer one', same(scene.between(bad, 1.3), [1, 1, 0]) &&
    same(scene.between(bad, 1.7), [2, 2, 0]));
  const slide = scene.prepare(small({ sliding: true }));
  check('a slide ends', same(scene.between(slide, 3), [3, 3, 0]) && same(scene.between(slide, 9), [3, 3, 0]));
  check('values between', scene.mixed([2, 4, 8], [1, 2, 0.25]) === 5 && scene.mixed(7, [1, 2, 0.25]) === 7);
  check('a place at a position is not mixed with an unknown one', scene.mixed([1, NaN], [0, 1, 0]) === 1);
  check('input of a crank, either way round', scene.inputAt(c, 5) === 15 &&
    scene.inputAt(scene.prepare(small({ sense: -1 })), 5) === 5);
  check('input of a slide', scene.inputAt(slide, 1.5) === 10 + 270 / 2);
  check('a turn begins anew, a part of it ends', scene.within(c, 361, [0, 360]) === 1 && scene.within(c, -1, [0, 360]) === 359 &&
    scene.within(c, 200, [0, 90]) === 90 && scene.within(c, -5, [0, 90]) === 0);
  check('a crank that is prescribed over a part of a turn', same(scene.prepare(small({
    prescribed: { ...small().prescribed, at: [0, 30, 60, 90] } })).range, [0, 90]) && same(c.range, [0, 270]) && c.limited);
  check('prescribed positions: this one, next, before, round', scene.prescribedAt(c, 90) === 1 && scene.prescribedAt(c, 91) === -1 &&
    scene.prescribedNext(c, 90, 1) === 180 && scene.prescribedNext(c, 90, -1) === 0 && scene.prescribedNext(c, 270, 1) === 0 &&
    scene.prescribedNext(c, 0, -1) === 270);

  const close = small();
  close.prescribed.at = [0, 1 - 5e-7, 1, 2];
  check('of prescribed positions close together it is the nearest', scene.prescribedAt(scene.prepare(close), 1) === 2 &&
    scene.prescribedAt(close, 1 - 6e-7) === 1);

  // ---- angles -------------------------------------------------------------------------------------------------------

  const turning = small({ motion: 'angle' });
  turning.sweep.actual = [350, 355, 5, 10];
  turning.prescribed.actual = [350, 355, 5, 10];
  check('an angle goes on beyond a turn', same([...scene.prepare(turning).sweep.actual], [350, 355, 365, 370]), turning.sweep.actual);
  const aimed = small({ motion: 'angle' });
  aimed.sweep.actual = [350, 355, 5, 10];
  aimed.prescribed = { ...aimed.prescribed, at: [0, 1, 2, 3], actual: [-10, -5, 5, 10], desired: [-10, -5, 5, 10] };
  check('the curve lies beside the desired values', same([...scene.prepare(aimed).sweep.actual], [-10, -5, 5, 10]), aimed.sweep.actual);

  // ---- words --------------------------------------------------------------------------------------------------------

  check('seven digits', scene.short(1 / 3) === '0.3333333' && scene.short(2) === '2' && scene.short(NaN) === '\u2013');
  check('rounding is no output', scene.shortOutput(c, 2e-14) === '0' && scene.shortOutput(c, 2e-9) === '2e-9' &&
    scene.shortOutput(turning, 30.0000000001) === '30');
  const title = 'FOUR-BAR LINKAGE, LEAST SQUARES FROM 60 STARTS, RANK 12';
  check('a long title keeps its beginning and its end', scene.shortTitle(title, 30).length <= 30 &&
    scene.shortTitle(title, 30).startsWith('FOUR-BAR') && scene.shortTitle(title, 30).endsWith('RANK 12') &&
    scene.shortTitle(title, 80) === title, scene.shortTitle(title, 30));

  // ---- other assemblies ---------------------------------------------------------------------------------------------

  const wide = small();
  wide.sweep.others = [{ pair: 0, x: [0, 2, 100, null], y: [0, -1.5, 0, null] }];
  check('other assemblies widen the view, not beyond its size', same(scene.withOthers(scene.prepare(wide), wide.view), [-1, -1.5, 3, 1]),
    scene.withOthers(wide, wide.view));
  const four = scene.prepare(sample()[0]), other = four.sweep.others[0], { start, finish } = four.pairs[other.pair];
  const sides = (i, x, y) => [start, finish].map((j) => Math.hypot(x - scene.mixed(four.sweep.x[j], [i, i, 0]),
    y - scene.mixed(four.sweep.y[j], [i, i, 0])));
  const shared = four.pairs[other.pair].shared;
  check('the other assembly of a four-bar linkage has the same links', [0, 50, 100, 200].every((i) => {
    const a = sides(i, other.x[i], other.y[i]), b = sides(i, four.sweep.x[shared][i], four.sweep.y[shared][i]);
    return near(a[0], b[0], 1e-6) && near(a[1], b[1], 1e-6) && a[0] > 1;
  }));

  // ---- forces -------------------------------------------------------------------------------------------------------

  const forces = () => ({ sliding: false, drive: [1, -2, null, 4], fx: [3, 0, null, 0], fy: [4, 0, null, 1], moment: [0, 1, null, 3],
    centres: [{ link: 'crank', x: [0, 1, null, 2], y: [0, 0, null, 0] }],
    loads: [{ number: 1, x: [0, 1, null, 2], y: [0, 0, null, 0], fx: [3, 0, null, -6], fy: [4, 0, null, 8] },
      { number: 2, x: [0, 1, null, 2], y: [0, 0, null, 0], fx: [0, 0, null, 0], fy: [1, 1, null, 1] }],
    joints: [{ name: 'IN', fx: [0, 5, null, 0], fy: [0, 12, null, 1] }, { name: 'S1', fx: [0, 0, null, 0], fy: [0, 0, null, 0] }] });
  const loaded = scene.prepare(small({ forces: forces() })), f = loaded.forces;
  check('forces become typed arrays', [f.drive, f.fx, f.fy, f.moment, f.centres[0].x, f.loads[1].fy, f.joints[1].fx].every(
    (values) => values instanceof Float64Array));
  check('forces that are not known are no numbers', Number.isNaN(f.drive[2]) && Number.isNaN(f.joints[0].fx[2]) && f.drive[3] === 4);
  check('peaks of loads and bearings', f.loads[0].peak === 10 && f.loads[1].peak === 1 && f.joints[0].peak === 13 &&
    f.joints[1].peak === 0, [f.loads[0].peak, f.joints[0].peak]);
  check('arrows are drawn by the largest load', f.largest === 10);
  const unloaded = scene.prepare(small({ forces: { ...forces(), loads: [] } }));
  check('masses alone have no load to draw by', unloaded.forces.largest === 0);
  check('a force between two positions', scene.mixed(f.joints[0].fy, [0, 1, 0.5]) === 6 &&
    Number.isNaN(scene.mixed(f.joints[0].fy, [1, 2, 0.5])));

  // ---- axes ---------------------------------------------------------------------------------------------------------

  check('ticks are round', same(curves.ticks(0.3, 4.7, 5), [1, 2, 3, 4]) && same(curves.ticks(-7, 7, 3), [-5, 0, 5]));
  check('ticks of a turn divide it', same(curves.ticks(0, 360, 4, true), [0, 90, 180, 270, 360]));
  check('ticks of a falling input', same(curves.ticks(90, 0, 3, true), [0, 30, 60, 90]));
  check('an axis takes its values', same(curves.axisRange(3, 5, 100), [3, 5]));
  check('rounding is not magnified', same(curves.axisRange(-2e-14, 3e-14, 100), [-1, 1]));
  const [low, high] = curves.axisRange(27, 27 + 1e-9, 100);
  check('a constant lies in the middle', near(low, 26, 1e-8) && near(high, 28, 1e-8), [low, high]);
  check('small linkages have small axes', same(curves.axisRange(0, 1e-12, 1e-9), [0, 1e-12]));
  check('nothing to show', same(curves.axisRange(Infinity, -Infinity, 1), [0, 1]));
  const panel = { lines: [{ values: [5, 1, NaN, 9] }], points: [{ marks: [[1, -2], [3, 20]] }] };
  check('an axis shows what is in its range', same(curves.extent(panel, 0, 2), [-2, 5]) && same(curves.extent(panel, 0, 3), [-2, 20]) &&
    same(curves.extent({ ...panel, zero: true }, 0, 0.5), [0, 5]));

  const failed = results.filter(([, good]) => !good);
  document.getElementById('results').textContent = failed.map(([law, , detail]) => 'FAILED: ' + law + ' ' + detail + '\n').join('') +
    (results.length - failed.length) + ' passed, ' + failed.length + ' failed';
})();
