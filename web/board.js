// The drawing board: its state, every change with undo, the motion that follows from it, playing, files to open and to save.
'use strict';

(() => {
  const { view, motion: solver, text: notation } = board;
  const $ = (id) => document.getElementById(id);
  const MOST_UNDO = 200, TURN_TIME = 6, WAY_TIME = 4;      // seconds of a turn, of a way there
  const NEAR = 1e-3;                                       // part of a step of the sweep that is followed to a dead point
  const FINE = 1, COARSE = 5;                              // degrees between positions of a sweep; while dragging
  const clone = (value) => JSON.parse(JSON.stringify(value));
  const blank = () => ({ title: board.words.title, joints: [], links: [{ name: 'frame', joints: [] }], slides: [], gears: [], lengths: [], vary: [], kover: false,
    drives: [], outputs: [], ikin: 15, crnki: 0, delt: [], keep: {} });

  const state = {
    sketch: blank(), source: '', file: 'sketch.nml', dirty: false,
    book: '',                   // where the book is, seen from this page; empty: not known
    wanted: null,               // points that a search is to come near: { points, closed }
    tool: 'select', selection: null, hover: null, pending: null, grid: 'auto',
    messages: [], wrong: new Set(),
    motion: {},                 // mech, start, sweep: what follows from the sketch
    live: null,                 // state shown; null: the drawing as it is
    t: 0, forth: 1, playing: false, speed: 0,
  };
  const parts = [board.source, board.engine, board.search];    // what follows every change
  const past = [], future = [];
  let before = null;            // what there was before a change that goes on

  const jointOf = (name) => state.sketch.joints.find((j) => j.name === name);
  const linkOf = (name) => state.sketch.links.find((l) => l.name === name);
  const linksAt = (name) => state.sketch.links.filter((l) => l.joints.includes(name));
  const inFrame = (name) => state.sketch.links[0].joints.includes(name);

  // ---- changes ------------------------------------------------------------------------------------------------------

  /** A change that goes on, as dragging: `begin`, any number of `touch`, `end`. */
  function begin() {
    if (before) return;
    pause();
    settle();
    before = snapshot();
  }

  function touch(change) {
    change(state.sketch);
    refresh(true);
  }

  function end() {
    if (before && before !== snapshot()) {
      remember(before);
      state.dirty = true;
    }
    before = null;
    refresh();
    board.store.keep();
  }

  /** All that undo brings back. */
  const snapshot = () => JSON.stringify({ sketch: state.sketch, source: state.source, file: state.file, wanted: state.wanted });

  function remember(one) {
    past.push(one);
    if (past.length > MOST_UNDO) past.shift();
    future.length = 0;
  }

  function edit(change) {
    begin();
    change(state.sketch);
    end();
  }

  function undo(from = past, to = future) {
    if (!from.length) return;
    pause();
    to.push(snapshot());
    Object.assign(state, JSON.parse(from.pop()));
    state.selection = null;
    state.dirty = true;
    refresh();
    board.store.keep();
  }

  /** Exact lengths may hold the joints elsewhere than they were drawn: from there on they are drawn where they are. */
  function settle() {
    const { mech, start } = state.motion;
    if (!start || !state.sketch.lengths.length) return;
    solver.joints(mech, start.pose).forEach(([x, y], j) => Object.assign(state.sketch.joints[j], { x, y }));
  }

  /** Moves joints as little as may be until all exact lengths hold. What is pinned stays, unless lengths between pinned joints ask for
      more, or the lengths cannot hold otherwise; `held` joints give way last of the others. */
  function relax(sketch, held = []) {
    const { lengths, joints } = sketch, pinned = new Set(sketch.links[0].joints);
    if (!lengths.length) return;
    const short = ({ joints: names, value }) => {
      const [a, b] = names.map((name) => joints.find((j) => j.name === name));
      return Math.abs(Math.hypot(b.x - a.x, b.y - a.y) - value) > 1e-12 * value;
    };
    const within = lengths.filter((l) => l.joints.every((name) => pinned.has(name))), wrong = within.filter(short);
    const rest = lengths.filter((l) => !within.includes(l) || wrong.includes(l)), drawn = joints.map(({ x, y }) => ({ x, y }));
    for (const [rows, give] of [[rest, new Set(wrong.flatMap((l) => l.joints))], [lengths, pinned]]) {
      if (meet(joints, rows, joints.map((j) => pinned.has(j.name) ? (give.has(j.name) ? 1e-6 : 0) : held.includes(j.name) ? 1e-2 : 1))) return;
      if (give !== pinned) joints.forEach((j, i) => Object.assign(j, drawn[i]));
    }
  }

  /** Newton's method for exact lengths; a joint moves by its `ease`, not at all with 0. True if they hold. */
  function meet(joints, lengths, ease) {
    let worst = Infinity;
    const largest = Math.max(...lengths.map((l) => l.value));
    for (let round = 0; round < 60; round++) {
      const rows = [], right = [];
      for (const { joints: [a, b], value } of lengths) {
        const i = joints.findIndex((j) => j.name === a), k = joints.findIndex((j) => j.name === b);
        const dx = joints[k].x - joints[i].x, dy = joints[k].y - joints[i].y, d = Math.hypot(dx, dy) || 1e-9;
        rows.push({ i, k, u: [dx / d, dy / d] });
        right.push(value - d);
      }
      worst = Math.max(0, ...right.map(Math.abs));
      if (!(worst >= 1e-13 * largest)) return !Number.isNaN(worst);
      const dot = (p, q) => p.u[0] * q.u[0] + p.u[1] * q.u[1];
      const gram = rows.map((p) => rows.map((q) => dot(p, q) * ((p.i === q.i) * ease[p.i] + (p.k === q.k) * ease[p.k] -
        (p.i === q.k) * ease[p.i] - (p.k === q.i) * ease[p.k])));
      const { x } = solver.eliminate(gram, right);
      if (!x) return false;
      rows.forEach((row, n) => {
        joints[row.i].x -= ease[row.i] * x[n] * row.u[0];
        joints[row.i].y -= ease[row.i] * x[n] * row.u[1];
        joints[row.k].x += ease[row.k] * x[n] * row.u[0];
        joints[row.k].y += ease[row.k] * x[n] * row.u[1];
      });
    }
    return worst < 1e-9 * largest;      // what rounding leaves, or three lengths along one line
  }

  /** Another name for a joint, link or slide, wherever it is used. */
  function rename(kind, from, to) {
    const { sketch } = state, all = [...sketch.joints, ...sketch.slides].map((one) => one.name);
    if (!/^[^\s,'"]{1,31}$/.test(to) || (kind === 'link' ? sketch.links.some((l) => l.name === to) : all.includes(to))) return false;
    edit((s) => {
      const swap = (name) => name === from ? to : name;
      // what the board does not edit names joints and links too
      const one = { kind, from, to, joints: s.joints.map((joint) => joint.name) };
      s.renamed = [...(s.renamed || []), one];
      for (const name of Object.keys(s.keep)) s.keep[name] = s.keep[name].map((text) => notation.renameIn(/^\w+/.exec(text)[0].toUpperCase(), text, one));
      if (kind === 'link') {
        linkOf(from).name = to;
        for (const slide of s.slides) slide.links = slide.links.map(swap);
        for (const gear of s.gears) [gear.wheels, gear.carrier] = [gear.wheels.map(swap), swap(gear.carrier)];
        for (const drive of s.drives) [drive.base, drive.link] = [swap(drive.base), swap(drive.link)];
      } else {
        for (const one of [...s.joints, ...s.slides]) one.name = swap(one.name);
        for (const one of [...s.links, ...s.lengths]) one.joints = one.joints.map(swap);
        for (const drive of s.drives) drive.at = drive.at.map(swap);
      }
      for (const output of s.outputs) if (output.kind !== 'ratio') output.of = output.of.map(swap);
      for (const each of s.vary) each.of = notation.renameIn('VARY', "'" + each.of + "'", one).slice(1, -1);
    });
    return true;
  }

  /** What is chosen, one by one. */
  const each = (selection = state.selection) => selection ? selection.many || [selection] : [];

  const isChosen = (kind, name) => each().some((one) => one[kind] === name);

  /** Chooses one thing more, or no longer; several are `{ many }`. */
  function chooseMore(what) {
    const [kind, name] = Object.entries(what)[0], rest = each().filter((one) => one[kind] !== name), all = isChosen(kind, name) ? rest : [...rest, what];
    state.selection = all.length > 1 ? { many: all } : all[0] || null;
  }

  /** Joints that move with what is chosen. */
  const movedBy = (selection) => [...new Set(each(selection).flatMap((one) => one.joint ? [one.joint] : one.link ? linkOf(one.link).joints : []))];

  /** Moves what is chosen, and the lines of blocks whose joints go with it; exact lengths hold. */
  function shift(sketch, selection, [dx, dy]) {
    const names = movedBy(selection), slides = each(selection).map((one) => one.slide), more = (v, by) => Number((v + by).toPrecision(14));
    const carried = (slide) => slides.includes(slide.name) || slide.links.some((name) => linkOf(name).joints.length === 1 && names.includes(linkOf(name).joints[0]));
    for (const one of [...sketch.joints.filter((j) => names.includes(j.name)), ...sketch.slides.filter(carried)]) [one.x, one.y] = [more(one.x, dx), more(one.y, dy)];
    relax(sketch, names);
  }

  /** Takes joints, links or slides away, and what cannot be without them. */
  function remove(selection) {
    edit((s) => {
      for (const { joint, link, slide, cylinder } of each(selection)) {
        if (cylinder) s.drives = s.drives.filter((d) => d.at.join(' ') !== cylinder);
        if (slide) s.slides = s.slides.filter((one) => one.name !== slide);
        if (link && link !== s.links[0].name) s.links = s.links.filter((one) => one.name !== link);
        if (joint) {
          s.joints = s.joints.filter((one) => one.name !== joint);
          for (const one of s.links) one.joints = one.joints.filter((name) => name !== joint);
        }
      }
      tidy(s);
    });
    state.selection = null;
    refresh();
  }

  function tidy(s) {
    const slides = (name) => s.slides.some((one) => one.links.includes(name));
    // a link of one joint is a block if it slides; else its joint stays only if others have it
    s.links = s.links.filter((one, i) => i === 0 || one.joints.length > 1 || slides(one.name));
    const link = (name) => s.links.some((one) => one.name === name), joint = (name) => s.joints.some((one) => one.name === name);
    s.slides = s.slides.filter((one) => one.links.every(link));
    s.links = s.links.filter((one, i) => i === 0 || one.joints.length > 1 || slides(one.name));
    s.joints = s.joints.filter((one) => s.links.some((l) => l.joints.includes(one.name)));
    for (const one of s.links) one.joints = one.joints.filter(joint);
    const shared = (names) => s.links.some((l) => names.every((name) => l.joints.includes(name)));
    s.gears = s.gears.filter((one) => [...one.wheels, one.carrier].every(link));
    s.lengths = s.lengths.filter((one) => one.joints.every(joint) && shared(one.joints));
    s.drives = s.drives.filter((one) => one.kind === 'slide' ? s.slides.some((slide) => slide.name === one.at[0]) : one.at.every(joint) &&
      (one.kind !== 'cylinder' || !shared(one.at)) && (one.kind !== 'turn' || s.links.filter((l) => l.joints.includes(one.at[0])).length > 1));
    for (const one of s.drives) for (const key of ['base', 'link']) if (one[key] && !link(one[key])) one[key] = '';
    for (const one of s.drives) if (one.kind === 'turn') for (const key of ['base', 'link'])
      if (one[key] && !s.links.find((l) => l.name === one[key]).joints.includes(one.at[0])) one[key] = '';
    if (s.drives.length && s.drives[0].ratio) Object.assign(s.drives[0], { ratio: 0, phase: 0 });
    // what runs together are joints of one letter each
    s.vary = s.vary.filter(({ of }) => of.split(/\s+/).every((word, i) => (i === 0 && ['angle', 'place', 'input', 'all'].includes(word)) || joint(word) || [...word].every(joint)));
    s.outputs = s.outputs.filter((one) => one.kind === 'ratio' || one.of.every((word) => joint(word) || link(word) ||
      s.slides.some((slide) => slide.name === word) || [...word].every(joint)));
  }

  /** A name that is free: A, B ... for joints, the word with a number for others. */
  function freeName(kind) {
    const { sketch } = state;
    if (kind === 'joint') {
      const letters = (n) => (n >= 26 ? letters(Math.floor(n / 26) - 1) : '') + String.fromCharCode(65 + n % 26);
      for (let n = 0; ; n++) if (!jointOf(letters(n)) && !sketch.slides.some((s) => s.name === letters(n))) return letters(n);
    }
    const taken = kind === 'slide' ? [...sketch.slides, ...sketch.joints] : sketch.links;
    const stem = kind === 'slide' ? 'S' : kind;
    for (let n = kind === 'slide' ? 1 : 2; ; n++) if (!taken.some((one) => one.name === stem + n)) return stem + n;
  }

  // ---- motion -------------------------------------------------------------------------------------------------------

  /** What follows from the sketch; `rough` while something is dragged. */
  function refresh(rough = false) {
    const { sketch } = state;
    state.motion = {};
    state.live = null;
    state.t = 0;
    state.messages = solver.assess(sketch);
    if (!state.messages.length) {
      const mech = solver.compile(sketch), start = solver.assemble(mech);
      state.motion = { mech, start };
      if (!start) tell(board.words.apart);
      else if (start.dead) tell(board.words.dead);
      else {
        state.motion.sweep = sweepOf(sketch, mech, start, rough ? COARSE : FINE);
        state.live = start;
        state.t = state.motion.sweep.home;
      }
    }
    state.wrong = new Set(state.messages.flatMap((m) => m.joints));
    if (state.selection && !exists(state.selection)) state.selection = null;
    board.panel.show(rough);
    for (const part of parts) part.follow(rough);
    view.draw();
  }

  const tell = (text) => state.messages.push({ text, joints: [], links: [] });
  const exists = (s) => s.many ? s.many.every(exists) : s.joint ? jointOf(s.joint) : s.link ? linkOf(s.link) : s.slide ? state.sketch.slides.some((one) => one.name === s.slide) :
    state.sketch.drives.some((d) => d.at.join(' ') === s.cylinder);

  const free = (sketch = state.sketch) => sketch.drives.filter((d) => !d.ratio).length;

  /** States along the motion: a whole turn, or as far as the linkage goes both ways; of several drives the way through all positions. */
  function sweepOf(sketch, mech, start, step) {
    let states = [start], home = 0, ring = false;
    if (free(sketch) === 1) {
      const turns = sketch.drives[0].kind === 'turn', each = turns ? step : mech.size * step / 120, most = turns ? 360 : mech.size;
      const run = (way) => {
        const list = [];
        let now = start;
        for (let k = 1; k * each <= most + 1e-9; k++) {
          const next = solver.advance(mech, now, solver.inputsAt(sketch, way * k * each), NEAR);
          if (!next) { list.push(...edge(mech, now, solver.inputsAt(sketch, way * k * each))); break; }
          list.push(now = next);
        }
        return list;
      };
      const forth = run(1), last = forth.at(-1);
      ring = turns && forth.length * each >= 360 - 1e-9 && same(mech, start, last);
      if (ring) states = [start, ...forth.slice(0, -1)];
      else {
        const back = run(-1).reverse();
        states = [...back, start, ...forth];
        home = back.length;
      }
    } else {
      const rows = solver.positions(sketch), between = [start.inputs];
      rows.forEach((row, k) => {
        const from = k ? rows[k - 1] : start.inputs, steps = Math.max(1, Math.round(120 / Math.max(1, rows.length) / step));
        for (let i = 1; i <= steps; i++) between.push(from.map((v, d) => v + (row[d] - v) * i / steps));
      });
      states = [];
      for (const inputs of between) {
        const next = solver.advance(mech, states.at(-1) || start, inputs, NEAR);
        if (!next) break;
        states.push(next);
      }
    }
    return { states, home, ring, places: states.map((one) => solver.joints(mech, one.pose)) };
  }

  /** The last states before a dead point, nearer and nearer. */
  function edge(mech, from, target) {
    const list = [];
    let now = from, part = 0.5;
    for (let i = 0; i < 6; i++, part /= 2) {
      const next = solver.advance(mech, now, from.inputs.map((v, k) => now.inputs[k] + part * (target[k] - v)), NEAR);
      if (next) list.push(now = next);
    }
    return list;
  }

  const same = (mech, a, b) => {
    const p = solver.joints(mech, a.pose), q = solver.joints(mech, b.pose);
    return p.every(([x, y], j) => Math.hypot(x - q[j][0], y - q[j][1]) < 1e-6 * mech.size);
  };

  /** Where all joints are now. */
  function places() {
    const { motion: m, live, sketch } = state;
    const list = live ? solver.joints(m.mech, live.pose) : sketch.joints.map((j) => [j.x, j.y]);
    return new Map(sketch.joints.map((j, i) => [j.name, list[i]]));
  }

  /** A slide now: a point of its line, direction, and the place of its block. */
  function slidePlace(i) {
    const { sketch, motion: m, live } = state, slide = sketch.slides[i], [a, b] = slide.links.map(linkOf);
    const moves = a === sketch.links[0] || (b !== sketch.links[0] && a.joints.length > b.joints.length) ? b : a.joints.length < b.joints.length || b === sketch.links[0] ? a : b;
    let { x, y } = slide, u = [Math.cos(slide.angle * solver.RADIAN), Math.sin(slide.angle * solver.RADIAN)];
    if (live) {
      const row = m.mech.slides[i], at = (link, p) => {
        const phi = live.pose[3 * link + 2], c = Math.cos(phi), s = Math.sin(phi);
        return [live.pose[3 * link] + c * p[0] - s * p[1], live.pose[3 * link + 1] + s * p[0] + c * p[1]];
      };
      [x, y] = at(moves === a ? row.a : row.b, moves === a ? row.p : row.q);
      const phi = live.pose[3 * row.a + 2];
      u = [u[0] * Math.cos(phi) - u[1] * Math.sin(phi), u[0] * Math.sin(phi) + u[1] * Math.cos(phi)];
    }
    const joint = moves.joints.length ? places().get(moves.joints[0]) : [x, y];
    const along = (joint[0] - x) * u[0] + (joint[1] - y) * u[1];
    return { x, y, u, bx: x + along * u[0], by: y + along * u[1] };
  }

  /** Pairs of joints whose distances give the shape of a link. */
  function sides({ joints }) {
    return joints.flatMap((b, i) => joints.slice(Math.max(0, i - 2), i).map((a) => [a, b]));
  }

  // ---- playing ------------------------------------------------------------------------------------------------------

  function go(t) {
    const { sweep } = state.motion;
    if (!sweep) return;
    const n = sweep.states.length;
    state.t = sweep.ring ? ((t % n) + n) % n : Math.min(n - 1, Math.max(0, t));
    state.live = sweep.states[Math.round(state.t) % n];
    show();
  }

  /** One drive of several to a value in its own unit; false where the linkage does not get there. */
  function drive(k, value) {
    const { live, motion: m } = state, target = live.inputs.slice();
    target[k] = state.sketch.drives[k].kind === 'turn' ? value * solver.RADIAN : value;
    state.sketch.drives.forEach((d, i) => {
      if (!d.ratio) return;
      const first = state.sketch.drives[0].kind === 'turn' ? target[0] / solver.RADIAN : target[0];
      target[i] = (d.ratio * first + d.phase) * (d.kind === 'turn' ? solver.RADIAN : 1);
    });
    const next = solver.advance(m.mech, live, target);
    if (next) state.live = next;
    show();
    return Boolean(next);
  }

  function show() {
    board.panel.follow();
    view.draw();
  }

  function play(on = !state.playing) {
    state.playing = on && Boolean(state.motion.sweep) && state.motion.sweep.states.length > 1;
    $('play').textContent = state.playing ? board.words.pause : board.words.play;
    $('play').setAttribute('aria-label', state.playing ? board.words.pauseLabel : board.words.playLabel);
    $('play').setAttribute('aria-pressed', String(state.playing));
    if (!state.playing) return;
    let last = 0;
    const tick = (now) => {
      if (!state.playing) return;
      const { sweep } = state.motion, n = sweep.states.length, dt = last ? Math.min(0.1, (now - last) / 1000) : 0;
      last = now;
      let t = state.t + state.forth * 2 ** state.speed * dt * n / (sweep.ring ? TURN_TIME : WAY_TIME);
      if (sweep.ring) state.forth = 1;
      else if (t >= n - 1) { t = n - 1; state.forth = -1; } else if (t <= 0) { t = 0; state.forth = 1; }
      go(t);
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  const pause = () => { if (state.playing) play(false); };

  /** Every position of the data set: inputs, whether it closes, joints, outputs; as psalm has it in CASE.csv. */
  function table() {
    const { mech, start } = state.motion;
    if (!start) return [];
    return solver.follow(mech, start, solver.positions(state.sketch)).map((one) => one ? { closed: 1,
      ...Object.fromEntries(solver.joints(mech, one.pose).flatMap(([x, y], j) => [[state.sketch.joints[j].name + '.x', x], [state.sketch.joints[j].name + '.y', y]])),
      ...Object.assign({}, ...state.sketch.outputs.map((o) => solver.output(mech, one, o))) } : { closed: 0 });
  }

  // ---- files --------------------------------------------------------------------------------------------------------

  /** Another data set; what was there comes back by undo. */
  function load(source, file = 'sketch.nml', draft = false) {
    const sketch = notation.parse(source);
    instead({ sketch, source, file }, draft);
    board.tools.choose('select');
  }

  function start(sketch = blank()) {
    instead({ sketch, source: '', file: 'sketch.nml', wanted: null });
    board.tools.choose('link');
  }

  function instead(other, draft = false) {
    pause();
    before = null;
    if (draft || state.sketch.joints.length || state.wanted) remember(snapshot());
    Object.assign(state, other, { selection: null, pending: null, dirty: false });
    refresh();
    fit();
  }

  /** The sketch of a text, in the same view; throws a Mistake. */
  function take(source) {
    const sketch = notation.parse(source);
    begin();
    Object.assign(state, { sketch, source });
    end();
  }

  const write = () => notation.write(state.sketch, state.source);

  function save() {
    download(write(), state.file.replace(/\.(dev7|txt)$/, '.nml'));
    state.dirty = false;
  }

  function download(text, name) {
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type: 'text/plain' }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function open(file) {
    if (/\.(dxf|fcstd|json|pmks)$/i.test(file.name)) { board.imports.file(file); return; }
    file.text().then((source) => attempt(source, file.name));
  }

  /** Everything into the view, with the paths. */
  function fit() {
    const { motion: m, wanted } = state, all = [...places().values(), ...(m.sweep ? m.sweep.places.flat() : []), ...(wanted ? wanted.points : [])];
    if (!all.length) { view.look([-20, -20, 180, 120]); view.draw(); return; }
    const xs = all.map((p) => p[0]), ys = all.map((p) => p[1]), least = (l) => l.reduce((a, b) => Math.min(a, b)), most = (l) => l.reduce((a, b) => Math.max(a, b));
    view.look([least(xs), least(ys), most(xs), most(ys)]);
    view.draw();
  }

  /** The page of the book for what is being done: what is wrong, else what is chosen, else the tool. Without the book, its name. */
  function help() {
    const { book, messages, selection, sketch, tool } = state, chosen = selection || {};
    let page = 'board';
    if (messages.length && sketch.joints.length) page = 'loops#what-psalm-makes-of-it';
    else if (chosen.gear !== undefined) page = 'sketch#gears-in-chain';
    else if (chosen.slide !== undefined || tool === 'slider') page = 'sketch#chain';
    else if (chosen.drive !== undefined || tool === 'drive') page = 'sketch#drives';
    else if (chosen.output !== undefined || tool === 'output') page = 'sketch#outputs-optional';
    const [name, place] = page.split('#');
    if (book) window.open(book + 'guide/' + name + '.html' + (place ? '#' + place : ''), 'book');
    else $('hint').textContent = board.words.explained(name);
    return page;
  }

  /** What the address asks for: #case=TEXT&file=NAME&book=PATH, or #z=TEXT, compressed. A path leads to a folder beside or above this page,
      nowhere else. */
  function asked() {
    const words = new URLSearchParams(location.hash.slice(1)), book = words.get('book') || '';
    if (/^(\.{1,2}\/)*(\w[\w.-]*\/)*$/.test(book)) state.book = book;
    if (words.has('z')) return { z: words.get('z'), file: words.get('file') || 'sketch.nml' };
    return words.has('case') ? { lines: words.get('case').split('\n'), file: words.get('file') || 'sketch.nml' } : null;
  }

  function ready() {
    view.begin();
    view.resize();
    board.panel.begin();
    board.tools.begin();
    board.store.begin();
    board.picture.begin();
    for (const part of parts) part.begin();
    new ResizeObserver(() => { view.resize(); view.draw(); }).observe(view.canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { view.resize(); view.draw(); });
    addEventListener('beforeunload', (event) => { if (state.dirty && !board.store.kept()) event.preventDefault(); });
    addEventListener('hashchange', () => { const words = asked(); if (words) present(words); });
    const given = asked() || JSON.parse($('data').textContent);
    start();
    present(given);
    board.store.restore(given.lines ? given.lines.join('\n') + '\n' : '');
  }

  /** Puts what was given on the board: lines of a data set, or a compressed one. */
  function present({ lines, z, file }) {
    if (z) board.store.unpacked(z).then((text) => attempt(text, file), () => wrong(board.words.badLink));
    else if (lines) attempt(lines.join('\n') + '\n', file);
  }

  /** Opens a text; a mistake is told. */
  function attempt(text, file, draft = false) {
    try {
      load(text, file, draft);
      return true;
    } catch (error) {
      if (!(error instanceof notation.Mistake)) throw error;
      wrong(file + ': ' + error.message);
      return false;
    }
  }

  function wrong(words) {
    state.messages = [{ text: words, joints: [], links: [] }];
    board.panel.show();
  }

  Object.assign(board, { state, edit, begin, touch, end, undo: () => undo(), redo: () => undo(future, past), relax, rename, remove, each, isChosen, chooseMore, shift, freeName, tidy, take, attempt, wrong, sweepOf, download,
    refresh, places, slidePlace, sides, jointOf, linkOf, linksAt, inFrame, go, drive, play, pause, table, load, start, write, save, open, fit, free, clone, help,
    canUndo: () => past.length > 0, canRedo: () => future.length > 0 });
  ready();
})();
