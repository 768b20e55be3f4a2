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

  const heavy = scene.prepare(small({ forces: { ...forces(), bare: { of: '1 spring', drive: [1, null, 2, 3], fx: [0, 0, 0, 0],
    fy: [0, 0, 0, 0], moment: [0, 0, 0, 0] }, weights: [{ radius: 0.5, x: [0, 1, null, 2], y: [0, 0, null, 0] }],
    springs: [{ torsional: false, x: [0, 0, 0, 0], y: [0, 0, 0, 0], x2: [3, 3, 3, 3], y2: [4, 4, 4, 4], frame: [true, false], footx: [0, 0, 0, 0], footy: [0, 0, 0, 0], footx2: [3, 3, 3, 3],
      footy2: [3, 3, 3, 3] }] } })).forces;
  check('weights and springs become typed arrays', [heavy.bare.drive, heavy.weights[0].x, heavy.springs[0].y2].every(
    (values) => values instanceof Float64Array) && Number.isNaN(heavy.bare.drive[1]));
  check('forces without weights and springs have none', f.weights.length === 0 && f.springs.length === 0);
  const coil = scene.coil(0, 0, 3, 4, 0.5), off = coil.map(([x, y]) => (4 * x - 3 * y) / 5);
  check('a spring ends where it is held', same(coil[0], [0, 0]) && same(coil[coil.length - 1], [3, 4]));
  check('its coils are as wide as told', near(Math.max(...off), 0.5, 1e-12) && near(Math.min(...off), -0.5, 1e-12), off);
  check('a torsional spring winds about its joint', scene.spiral(1, 2, 9).every(([x, y]) => Math.hypot(x - 1, y - 2) <= 9 + 1e-12) &&
    near(Math.hypot(...scene.spiral(0, 0, 9)[40]), 9, 1e-12));

  // ---- tables and files ---------------------------------------------------------------------------------------------

  const listed = scene.prepare(small({ joints: [{ name: 'A' }, { name: 'B, "left"' }], band: [{ square: [1, 2, null, 4], worst: [2, 4, null, 8] }],
    panels: [{ name: 'velocity', group: 'rates', scale: 1, lines: [{ label: '', values: [5, 6, null, 8] }] }] }));
  const table = scene.table(listed), lines = scene.csv(table).split('\r\n');
  check('the table has a row for each position of the sweep', table.rows.length === 4 && table.rows.every((row) => row.length === table.names.length) &&
    same(table.names.slice(0, 3), ['input', 'closed', 'distance']) && same(table.names.slice(-4), ['A.x', 'A.y', 'B, "left".x', 'B, "left".y']), table.names);
  check('inputs of the table go on', same(table.rows.map((row) => row[0]), [10, 11, 12, 13]));
  check('names with commas and quotes are quoted, unknown fields are empty', lines[0].endsWith(',"B, ""left"".x","B, ""left"".y"') &&
    lines[3] === '12,1,3,,,,0,0,-1,0' && lines[4] === '13,1,4,4,8,8,0,0,0,-1' && lines.length === 6, lines);
  const ink = new balm.save.SvgPen(40, 30);
  ink.beginPath();
  ink.lineTo(1, 2);
  ink.lineTo(3, 4);
  ink.closePath();
  ink.globalAlpha = 0.5;
  ink.fill();
  ink.save();
  ink.lineWidth = 7;
  ink.restore();
  ink.beginPath();
  ink.arc(5, 6, 2, 0, 2 * Math.PI);
  ink.stroke();
  ink.fillText('a<b & "c"', 1, 2);
  const drawn = new DOMParser().parseFromString(ink.text('T<1>'), 'image/svg+xml'), paths = [...drawn.querySelectorAll('path')];
  check('the pen writes SVG that is read', !drawn.querySelector('parsererror') && drawn.documentElement.getAttribute('viewBox') === '0 0 40 30' &&
    drawn.querySelector('title').textContent === 'T<1>' && drawn.querySelector('text').textContent === 'a<b & "c"', ink.text('T'));
  check('a path begins where its first line does', paths[0].getAttribute('d') === 'M1 2L3 4Z' && paths[0].getAttribute('opacity') === '0.5', paths[0].outerHTML);
  check('a circle is whole, and what was put by comes back', /^M7 6A2 2 0 0 1 3 6A2 2 0 0 1 7 6$/.test(
    paths[1].getAttribute('d').replace(/-0(?=[ A]|$)/g, '0')) && paths[1].getAttribute('stroke-width') === '1', paths[1].outerHTML);

  // ---- axes ---------------------------------------------------------------------------------------------------------

  check('ticks are round', same(scales.ticks(0.3, 4.7, 5), [1, 2, 3, 4]) && same(scales.ticks(-7, 7, 3), [-5, 0, 5]));
  check('ticks are two at least', same(scales.ticks(-0.3, 0.9, 1), [0, 0.5]));
  check('ticks of a turn divide it', same(scales.ticks(0, 360, 4, true), [0, 90, 180, 270, 360]));
  check('ticks of a falling input', same(scales.ticks(90, 0, 3, true), [0, 30, 60, 90]));
  check('decades', same(scales.decades(-1, 3), [0.1, 1, 10, 100, 1000]) && same(scales.decades(0, 1), [1, 2, 5, 10]));
  check('a part of a decade has round numbers', scales.decades(Math.log10(6e-4), Math.log10(1.05e-3)).length >= 2);
  check('an axis takes its values', same(scales.range(3, 5, 100), [3, 5]));
  check('rounding is not magnified', same(scales.range(-2e-14, 3e-14, 100), [-1, 1]));
  const [low, high] = scales.range(27, 27 + 1e-9, 100);
  check('a constant lies in the middle', near(low, 26, 1e-8) && near(high, 28, 1e-8), [low, high]);
  check('small linkages have small axes', same(scales.range(0, 1e-12, 1e-9), [0, 1e-12]));
  check('nothing to show', same(scales.range(Infinity, -Infinity, 1), [0, 1]));
  const panel = { lines: [{ values: [5, 1, NaN, 9] }], points: [{ marks: [[1, -2], [3, 20]] }] };
  check('an axis shows what is in its range', same(curves.extent(panel, 0, 2), [-2, 5]) && same(curves.extent(panel, 0, 3), [-2, 20]) &&
    same(curves.extent({ ...panel, zero: true }, 0, 0.5), [0, 5]));

  {
    // ---- sketches: their text ------------------------------------------------------------------------------------------

    const { text, motion: solver, panel: words } = board;
    const plain = "! a remark\nA FOUR-BAR\n &CHAIN JNT='A','B','C','D', JX=2*0.0,40.,7D1, JY=0.,30.,60.,0., ! rough\n  LNK='A D','AB','B C','C D' &END\n" +
      " &DRIVES DRIVE='A' /\n &METHOD IKIN=30 &END\n &LIMITS TANGLE=85. &END\nANOTHER CASE\n &LINKS &END\n";
    const mistake = (source) => { try { text.parse(source); return ''; } catch (error) { return error instanceof text.Mistake ? error.message : 'crash: ' + error; } };
    const sketch = text.parse(plain);
    check('a sketch is read: repeats, exponents, names that run together', same(sketch.joints.map((j) => [j.x, j.y]), [[0, 0], [0, 30], [40, 60], [70, 0]]) &&
      same(sketch.links.map((l) => l.joints.join('')), ['AD', 'AB', 'BC', 'CD']) && sketch.links[0].name === '1' && sketch.ikin === 30);
    check('written without a change it is the same, remarks and a second case included', text.write(sketch, plain) === plain);
    const moved = text.parse(plain);
    moved.joints[1].y = 31;
    const again = text.write(moved, plain);
    check('a change rewrites its own group only', again !== plain && again.startsWith('! a remark\nA FOUR-BAR\n &CHAIN ') &&
      again.endsWith(plain.slice(plain.indexOf(' &DRIVES'))) && same(text.parse(again), moved), again);
    const richer = text.parse(plain);
    richer.outputs.push({ kind: 'point', of: ['C'], name: '' });
    check('a group that was not there comes after &CHAIN', text.write(richer, plain).includes("&END\n &OUTPUTS OUTPUT='point C' &END\n &DRIVES DRIVE='A' /"), text.write(richer, plain));
    check('numbers: the shortest that are read back, with a point', same([0.1, 1 / 3, -7, 1e-7, 2.5e21, 0].map(text.number),
      ['0.1', '0.3333333333333333', '-7.0', '1.0E-7', '2.5E21', '0.0']));
    check('every example is read and written again', board.examples.length > 9 && board.examples.every((one) => {
      const it = text.parse(one.text);
      return text.write(it, one.text) === one.text && same(text.parse(text.write(it)).joints, it.joints) && same(text.parse(text.write(it)).drives, it.drives);
    }));
    check('mistakes are told with their line', mistake(plain.replace("'C D'", "'C X'")) === "line 4: &CHAIN LNK: no joint is called 'X'" &&
      mistake(plain.replace('60.', 'x')) === "line 3: &CHAIN JY: a number is expected; found 'x'" && mistake('A\n &LINKS &END\n').includes('&LINKS') &&
      mistake('\n') === 'there is no title' && mistake("A\n &CHAIN JNT='A'\n").includes('is not closed'), mistake(plain.replace('60.', 'x')));
    check('sums are numbers, other things are none', words.valueOf('120/3 + 2*(1,5-1)') === 41 && words.valueOf('-.5e1') === -5 &&
      ['', '2+', 'alert(1)', '1 2x', '(1'].every((s) => Number.isNaN(words.valueOf(s))));

    // ---- sketches: motion and freedom ------------------------------------------------------------------------------------

    check('linear systems: solution and sign of the determinant', (() => {
      const { x, sign, full } = solver.eliminate([[0, 2, 1], [1, 0, 3], [2, 1, 0]], [7, 10, 4]);
      return full && sign === 1 && near(x[0], 1, 1e-15) && near(x[1], 2, 1e-15) && near(x[2], 3, 1e-15) && solver.eliminate([[1, 2], [2, 4]], [1, 2]).full === false;
    })());
    const mech = solver.compile(sketch), start = solver.assemble(mech);
    // the same four-bar by the law of cosines, on the side that is drawn
    const rocker = (turn) => {
      const bx = -30 * Math.sin(turn), by = 30 * Math.cos(turn), p = Math.hypot(40, 30), q = Math.hypot(30, 60);
      const d = Math.hypot(70 - bx, by), a = (p * p - q * q + d * d) / (2 * d), h = Math.sqrt(p * p - a * a), ux = (70 - bx) / d, uy = -by / d;
      return [bx + a * ux - h * uy, by + a * uy + h * ux];
    };
    const far = [10, 60, -50, 130].map((degrees) => {
      const state = solver.advance(mech, start, [degrees * Math.PI / 180]), [x, y] = solver.joints(mech, state.pose)[2], [u, v] = rocker(degrees * Math.PI / 180);
      return Math.hypot(x - u, y - v);
    });
    check('a four-bar moves as the law of cosines says', far.every((away) => away < 1e-12), far);
    const tooFar = text.parse(plain.replace('7D1', '14D1'));
    const short = solver.compile(tooFar);
    check('what cannot be reached is not', solver.advance(short, solver.assemble(short), [Math.PI / 2]) === null);
    check('freedom of the examples is their number of drives', board.examples.every((one) => {
      const it = text.parse(one.text), { left, twice, count, driven } = solver.freedom(it);
      return left === 0 && twice.length === 0 && count === driven;
    }));
    const without = (change) => { const it = text.parse(plain); change(it); return it; };
    const told = (change) => (solver.assess(without(change))[0] || { text: '' }).text;
    check('what is underconstrained is named', told((s) => { s.links[0].joints = ['A']; }).startsWith('Underconstrained: links 3 and 4 can still move with A held. 2 drives more'), told((s) => { s.links[0].joints = ['A']; }));
    check('what is overconstrained is named', told((s) => { s.drives = []; s.links.push({ name: 'tie', joints: ['A', 'C'] }, { name: 'tie2', joints: ['B', 'D'] }); }).startsWith('Overconstrained: joint'));
    check('a drive too many is named', told((s) => { s.drives.push({ kind: 'turn', at: ['D'], base: '', link: '', ratio: 1, phase: 0, delt: [] }); }).startsWith('Drive D moves nothing'));
    check('joints at one place are named', told((s) => { Object.assign(s.joints[1], s.joints[0], { name: 'B' }); }).startsWith('Joints A and B of link 2 are at the same place'));
    check('a linkage in order needs no words', solver.assess(sketch).length === 0);
  }

  const failed = results.filter(([, good]) => !good);
  document.getElementById('results').textContent = failed.map(([law, , detail]) => 'FAILED: ' + law + ' ' + detail + '\n').join('') +
    (results.length - failed.length) + ' passed, ' + failed.length + ' failed';
})();
