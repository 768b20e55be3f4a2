// Results of the engine on the board, where psalm-workbench serves it: one look at the case after every change, arrows, numbers, curves.
// The one file of the pages that asks for something: of the server that the page comes from, with the token that stands in the page.
'use strict';

board.engine = (() => {
  const DELAY = 200, DRAGGING = 40;      // milliseconds after a change
  const ARROW = 0.2;                     // longest arrow, part of the picture
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  const meta = document.querySelector('meta[name="psalm-workbench"]'), served = Boolean(meta);
  const page = Math.random().toString(36).slice(2);
  const shown = { velocities: true, forces: true };
  const PATIENT = 300;                   // milliseconds: an answer that takes longer is given up for one to a later text
  const PROOF = 250;                     // after an answer
  let timer = 0, later = 0, since = 0, number = 0, asked = '';     // begin and number of the question that is open, its text
  let answer = null, fresh = false, parts = {};

  /** What the server says; an object with `error` if it says no. */
  async function ask(path, body, method = body === undefined ? 'GET' : 'POST') {
    try {
      const reply = await fetch(path, { method, body, headers: { 'X-Psalm-Token': meta.content, 'X-Psalm-Page': page }, credentials: 'omit', cache: 'no-store' });
      return await reply.json();
    } catch {
      return { error: words.away, away: true };
    }
  }

  function begin() {
    if (!served) return;
    const { make, head, check, row, button } = board.panel;
    const part = (name, ...inside) => { parts[name] = make('div', { class: name }, ...inside); return parts[name]; };
    const arrow = (name) => make('label', { class: 'tick ' + name }, check(words[name], true, (on) => { shown[name] = on; board.view.draw(); }), words[name]);
    $('engine').append(part('state'), part('result', head(words.here), part('here'), row(words.shownArrows, arrow('velocities'), arrow('forces')),
      head(words.assumptions), part('loads'), part('angles'), head(words.summary), part('summary'), part('proof'), part('ways'), part('found'), head(words.exports), part('files', make('div', { class: 'list' }, ...Object.entries(words.exportNames)
      .map(([ending, text]) => button(text, () => save(ending))))), board.study.part()));
    parts.result.hidden = true;
    parts.state.setAttribute('role', 'status');
  }

  const textNow = () => board.source.mistaken ? board.source.value : board.write();

  /** After a change: what was found holds no longer, unless the text is the same. */
  function follow(rough) {
    if (!served) return;
    if (!rough) board.study.follow();
    const text = textNow();
    fresh = Boolean(answer) && answer.text === text && !board.source.mistaken;
    if (fresh) { if (!rough) report(); return; }
    clearTimeout(timer);
    timer = setTimeout(look, rough ? DRAGGING : DELAY);
    if (!rough) say();
  }

  async function look() {
    timer = 0;
    const text = textNow();
    if (!board.state.sketch.joints.length && !board.source.mistaken) { answer = null; asked = ''; say(); return; }
    if (text === asked) return;
    if (since && performance.now() - since < PATIENT) { timer = setTimeout(look, DRAGGING); return; }
    const mine = ++number;
    since = performance.now();
    asked = text;
    const got = await ask('look', text);
    if (mine !== number) return;                 // a later question is open; the server has ended this one
    since = 0;
    if (got.stale || textNow() !== text) { asked = ''; if (!timer) timer = setTimeout(look, DRAGGING); return; }
    if (got.error) { answer = null; fresh = false; say(got.error); if (got.away) asked = ''; return; }
    answer = { ...got, text };
    fresh = !board.source.mistaken;
    prepare();
    board.source.findings(text, got.findings || []);
    report();
    board.view.draw();
    clearTimeout(later);
    later = setTimeout(prove, PROOF);
  }

  /** What takes longer is asked for when the drawing rests. */
  async function prove() {
    if (!fresh || !answer.motion) return;
    const { text } = answer, got = await ask('prove', text);
    if (!fresh || answer.text !== text || got.stale) return;
    Object.assign(answer, { proof: got.proof, assemblies: got.assemblies, unproven: got.error || '' });
    proof();
    ways();
  }

  /** A picture of the case, for other programs. */
  async function save(ending) {
    const got = await ask('files', board.write());
    if (got.files) board.download(got.files[ending], board.state.file.replace(/\.\w+$/, '') + ending);
    else say(got.error || (got.findings || []).filter((one) => one.level === 'error').map((one) => words.line(one.line, one.text)).join('; '), true);
  }

  /** The largest of what is drawn as arrows, and what counts along the motion. */
  function prepare() {
    const { motion, velocity } = answer, largest = (joints) => Math.max(0, ...Object.values(joints).flatMap(([x, y]) => (Array.isArray(x) ? x : [x])
      .map((v, i) => Math.hypot(v || 0, (Array.isArray(y) ? y[i] : y) || 0))));
    answer.fastest = velocity ? largest(velocity.joints) : 0;
    answer.strongest = motion && motion.forces ? Math.max(largest(motion.forces.joints), largest(motion.forces.loads.map(([, , x, y]) => [x, y]))) : 0;
  }

  // ---- at the position that is shown --------------------------------------------------------------------------------

  /** Where the position shown is on a list of inputs: number and part of the way to the next; nothing if it is not on it. */
  function placeOn(inputs) {
    const { live, sketch } = board.state;
    if (!live || !inputs || inputs.length < 1 || board.free() !== 1) return null;
    const turns = sketch.drives[0].kind === 'turn', value = live.inputs[0] / (turns ? board.motion.RADIAN : 1), round = (v) => turns ? v - 360 * Math.round(v / 360) : v;
    let best = -1, least = Infinity;
    inputs.forEach((v, i) => { const away = Math.abs(round(v - value)); if (away < least) { least = away; best = i; } });
    const near = round(value - inputs[best]), n = inputs.length;
    for (const next of [best + 1, best - 1]) {
      const to = (next + n) % n, gap = round(inputs[to] - inputs[best]);
      if ((turns || to === next) && to !== best && gap && near / gap >= 0 && near / gap <= 1) return { i: best, k: to, part: near / gap };
    }
    return Math.abs(near) < 1e-6 ? { i: best, k: best, part: 0 } : null;
  }

  const mixed = (values, at) => {
    if (!Array.isArray(values)) return values;
    const a = values[at.i], b = values[at.k];
    return a === null || b === null ? null : a + at.part * (b - a);
  };

  /** Arrows at the position shown: from, along, kind. */
  function arrows() {
    const list = [];
    if (!fresh || !answer.motion || answer.motion.time || board.state.messages.length) return list;
    const places = board.places(), { velocity, motion } = answer, outputs = new Set(board.state.sketch.outputs.flatMap((o) => o.of));
    const moving = velocity && shown.velocities && placeOn(velocity.input), loaded = motion.forces && shown.forces && placeOn(motion.input);
    if (moving) for (const [name, [x, y]] of Object.entries(velocity.joints)) if (places.has(name) && !board.inFrame(name))
      list.push({ from: places.get(name), x: mixed(x, moving), y: mixed(y, moving), most: answer.fastest, kind: 'velocity', strong: outputs.has(name) });
    if (loaded) for (const [name, [x, y]] of Object.entries(motion.forces.joints)) if (places.has(name))
      list.push({ from: places.get(name), x: mixed(x, loaded), y: mixed(y, loaded), most: answer.strongest, kind: 'force', strong: true });
    if (loaded) for (const [x, y, fx, fy] of motion.forces.loads.map((one) => one.map((v) => mixed(v, loaded))))
      list.push({ from: [x, y], x: fx, y: fy, most: answer.strongest, kind: 'load', strong: true });
    return list.filter((one) => one.x !== null && one.y !== null && one.most > 0);
  }

  function draw(g, X, Y, pens) {
    if (!served) return;
    const size = ARROW * Math.min(board.view.canvas.clientWidth, board.view.canvas.clientHeight);
    if (fresh && answer.motion && !answer.motion.time && !board.state.messages.length) { drawBand(g, X, Y, pens); drawPath(g, X, Y, pens); }
    for (const { from, x, y, most, kind, strong } of arrows()) {
      const [u, v] = [X(from[0]), Y(from[1])], dx = size * x / most, dy = -size * y / most, d = Math.hypot(dx, dy);
      if (d < 3) continue;
      g.strokeStyle = g.fillStyle = { velocity: pens.good, force: pens.bad, load: pens.warn }[kind];
      g.globalAlpha = strong ? 1 : 0.5;
      g.lineWidth = strong ? 2.4 : 1.6;
      const head = Math.min(10, 0.5 * d), [ux, uy] = [dx / d, dy / d];
      g.beginPath();
      g.moveTo(u, v);
      g.lineTo(u + dx - head * ux, v + dy - head * uy);
      g.stroke();
      g.beginPath();
      g.moveTo(u + dx, v + dy);
      g.lineTo(u + dx - head * ux - 0.45 * head * uy, v + dy - head * uy + 0.45 * head * ux);
      g.lineTo(u + dx - head * ux + 0.45 * head * uy, v + dy - head * uy - 0.45 * head * ux);
      g.closePath();
      g.fill();
    }
    g.globalAlpha = 1;
    here();
  }

  /** Every fifth position of the outputs as the engine has them: points on the path. */
  function drawPath(g, X, Y, pens) {
    const { joints } = answer.motion;
    g.fillStyle = pens.actual;
    for (const output of board.state.sketch.outputs) {
      const at = ['point', 'pose', 'x', 'y'].includes(output.kind) && joints[output.of[0]];
      if (!at || !Array.isArray(at[0])) continue;
      for (let i = 0; i < at[0].length; i += 5) {
        const y = Array.isArray(at[1]) ? at[1][i] : at[1];
        if (at[0][i] === null || y === null) continue;
        g.beginPath();
        g.arc(X(at[0][i]), Y(y), 2.2, 0, 2 * Math.PI);
        g.fill();
      }
    }
  }

  /** The band of the tolerances round the path of the first output. */
  function drawBand(g, X, Y, pens) {
    const { band, joints, input } = answer.motion, output = board.state.sketch.outputs.find((one) => one.kind === 'point'), at = output && joints[output.of[0]];
    if (!band || band.length < 2 || !at || !Array.isArray(at[0]) || !Array.isArray(at[1]) || at[0].some((v) => v === null) || at[1].some((v) => v === null)) return;
    const n = input.length, ring = Math.abs(at[0][0] - at[0][n - 1]) + Math.abs(at[1][0] - at[1][n - 1]) < 0.2 * (Math.max(...at[0]) - Math.min(...at[0]) + Math.max(...at[1]) - Math.min(...at[1]));
    for (const [kind, alpha] of [['worst', 0.14], ['square', 0.24]]) {
      g.fillStyle = pens.accent;
      g.globalAlpha = alpha;
      const shape = new Path2D();
      for (let i = 0; i + 1 < n + (ring ? 1 : 0); i++) {
        const k = (i + 1) % n, corners = [];
        for (const m of [i, k]) for (const [u, v] of [[1, 1], [1, -1], [-1, -1], [-1, 1]])
          corners.push([X(at[0][m] + u * band[0][kind][m]), Y(at[1][m] + v * band[1][kind][m])]);
        const part = new Path2D();
        board.view.outline(corners).forEach(([x, y], c) => { if (c) part.lineTo(x, y); else part.moveTo(x, y); });
        part.closePath();
        shape.addPath(part);
      }
      g.fill(shape, 'nonzero');
    }
    g.globalAlpha = 1;
  }

  const digits = (v) => board.view.short(Number(v.toPrecision(4)));

  /** Numbers at the position shown. */
  function here() {
    if (!parts.here || $('engine').hidden) return;
    const rows = [];
    if (fresh && answer.motion) {
      const { motion, velocity, condition } = answer, at = placeOn(motion.input), moving = velocity && placeOn(velocity.input), exact = condition && placeOn(condition.input);
      if (at) for (const one of motion.angle) { const v = mixed(one.values, at); if (v !== null) rows.push([words.transmission + ', ' + one.name, digits(v) + '\u00b0']); }
      if (moving) for (const output of board.state.sketch.outputs) {
        const of = velocity.joints[output.of[0]];
        if (of && ['point', 'pose', 'x', 'y'].includes(output.kind)) rows.push([words.speedOf(output.of[0]), digits(Math.hypot(mixed(of[0], moving), mixed(of[1], moving))) + words.perSecond]);
      }
      if (exact) for (const [name, values] of Object.entries(condition.outputs)) { const v = mixed(values, exact); if (v !== null && v !== undefined) rows.push([words.conditionOf(name), digits(v)]); }
      if (at && motion.forces) {
        const drive = mixed(motion.forces.drive, at);
        if (drive !== null && drive !== undefined) rows.push([words.drive, digits(drive) + (motion.forces.sliding ? words.newton : words.moment)]);
        for (const [name, [x, y]] of Object.entries(motion.forces.joints)) {
          const u = mixed(x, at), v = mixed(y, at);
          if (u !== null && v !== null) rows.push([words.forceAt(name), digits(Math.hypot(u, v)) + words.newton]);
        }
      }
      cursor(at);
    }
    list(parts.here, rows);
  }

  /** A list of names and values, without making what is there anew. */
  function list(box, rows) {
    const { make } = board.panel;
    while (box.children.length > rows.length) box.lastChild.remove();
    while (box.children.length < rows.length) box.append(make('div', { class: 'fact' }, make('span'), make('b')));
    rows.forEach(([name, value], i) => [name, value].forEach((text, k) => { const one = box.children[i].children[k]; if (one.textContent !== text) one.textContent = text; }));
  }

  // ---- the panel ----------------------------------------------------------------------------------------------------

  /** What the engine is doing, or what is wrong. */
  function say(text = '', now = false) {
    const wait = board.state.sketch.joints.length ? words.waiting : words.nothingYet;
    parts.state.textContent = fresh && !now ? '' : text || wait;
    parts.state.classList.toggle('wrong', Boolean(text) && (now || !fresh));
    parts.result.classList.toggle('old', !fresh);
    if (!answer) parts.result.hidden = true;
  }

  function report() {
    say();
    const { make, head } = board.panel, { motion, summary, findings } = answer, errors = (findings || []).filter((one) => one.level === 'error');
    parts.result.hidden = !motion;
    if (!motion && errors.length) { parts.state.textContent = words.line(errors[0].line, errors[0].text); parts.state.classList.add('wrong'); return; }
    const lines = (summary || '').split('\n').slice(1).map((line) => /^ {2}(\S.*?)(?: {2,}(.*))?$/.exec(line)).filter(Boolean);
    parts.summary.replaceChildren(...lines.map(([, name, value]) => make('div', { class: 'fact' }, make('span', {}, name), make('b', {}, value || ''))));
    const told = (findings || []).filter((one) => one.text), breaches = motion ? motion.breaches : [];
    parts.found.replaceChildren(...(told.length || breaches.length ? [head(words.messages), make('ul', {}, ...breaches.map((text) => make('li', { class: 'error' }, text)),
      ...told.map((one) => make('li', { class: one.level }, words.line(one.line, one.text))))] : []));
    chart();
    loads();
    proof();
    ways();
    here();
  }

  /** What is proven, with its bounds; where it closes stands below the slider of the drive, too. */
  function proof() {
    const { make, head } = board.panel, { limits = [], extremes = [] } = answer.proof || {}, unit = turning() ? '\u00b0' : '';
    const span = (a, b) => Math.abs(a - b) <= 1e-6 * (1 + Math.abs(a)) ? digits((a + b) / 2) : digits(a) + ' ... ' + digits(b);
    const fact = (name, value) => make('div', { class: 'fact' }, make('span', {}, name), make('b', {}, value));
    const rows = limits.filter((one) => one.kind !== 'undecided').map((one) => fact(words.closing[one.kind] || one.kind,
      words.range(digits(one.from) + unit, digits(one.to) + unit) + (one.group ? ', ' + one.group : '')));
    rows.push(...extremes.filter((one) => one.least_low !== null && one.greatest_high !== null).map((one) => fact(one.of,
      words.extremes(span(one.least_low, one.least_high), digits(one.least_at) + unit, span(one.greatest_low, one.greatest_high), digits(one.greatest_at) + unit))));
    if (answer.unproven) rows.push(make('p', {}, answer.unproven));
    parts.proof.replaceChildren(...(rows.length && board.free() === 1 ? [head(words.proven), ...rows] : []));
    marks();
  }

  const turning = () => Boolean(board.state.sketch.drives.length) && board.state.sketch.drives[0].kind === 'turn';

  /** Below the slider of a single drive: where the linkage closes for certain, and where something has a dead point. */
  function marks() {
    const track = $('drives').querySelector('.track'), { sweep } = board.state.motion, { make } = board.panel;
    for (const one of $('drives').querySelectorAll('.proven')) one.remove();
    if (!served || !fresh || !answer || !answer.proof || !track || !sweep || board.free() !== 1 || sweep.states.length < 2) return;
    const k = board.state.sketch.drives.findIndex((d) => !d.ratio), unit = turning() ? board.motion.RADIAN : 1;
    const value = (i) => sweep.states[i].inputs[k] / unit, n = sweep.states.length, low = Math.min(value(0), value(n - 1)), high = Math.max(value(0), value(n - 1));
    if (!(high > low)) return;
    const strip = make('div', { class: 'proven', title: words.strip }), x = (v) => 100 * Math.min(1, Math.max(0, (v - low) / (high - low)));
    const shifts = turning() ? [-360, 0, 360] : [0], put = (from, to, kind, title) => {
      for (const shift of shifts) {
        const [a, b] = [from, to].map((v) => v + shift).sort((p, q) => p - q);
        if (b < low || a > high) continue;
        const mark = make('i', { class: kind, title });
        mark.style.left = x(a) + '%';
        if (kind === 'closes') mark.style.width = Math.max(0, x(b) - x(a)) + '%';
        strip.append(mark);
      }
    };
    for (const one of answer.proof.limits || []) if (one.kind === 'closes') put(one.from, one.to, 'closes', words.closing.closes);
    for (const one of answer.proof.dead_points || []) put(one.low, one.high, 'dead', words.deadPoint(one.of));
    track.append(strip);
  }

  /** Every way in which the links can be put together; a click on one draws it. */
  function ways() {
    const { make, head } = board.panel, all = answer.assemblies || [], { sketch } = board.state;
    const known = all.length > 1 && sketch.joints.every((joint) => all.every((one) => one.joints[joint.name]));
    parts.ways.replaceChildren(...(!known ? [] : [head(words.assemblies), make('p', {}, words.assembliesHint), make('div', { class: 'cards' }, ...all.map((one, i) => {
      const other = { ...sketch, outputs: [], drives: [], lengths: [], joints: sketch.joints.map(({ name }) => ({ name, x: one.joints[name][0], y: one.joints[name][1] })) };
      return make('button', { type: 'button', class: 'card', 'aria-label': words.assembly(i + 1), 'aria-pressed': String(one.drawn), onclick: () => redraw(one.joints) },
        board.store.picture(other, []), make('small', {}, one.drawn ? words.assemblyDrawn : words.assembly(i + 1)));
    }))]));
  }

  function redraw(joints) {
    board.edit((sketch) => { for (const joint of sketch.joints) [joint.x, joint.y] = joints[joint.name].map((v) => Number(v.toPrecision(12))); });
  }

  /** The transmission angles over the motion, and where the position shown is. */
  function chart() {
    const { make, head, svg } = board.panel, { angle, limits, input } = answer.motion;
    parts.angles.replaceChildren();
    if (!angle.length || input.length < 2) return;
    const wide = 280, high = 110, X = (i) => 4 + (wide - 8) * i / (input.length - 1), Y = (v) => high - 4 - (high - 8) * v / 180;
    const picture = svg('svg', { viewBox: '0 0 ' + wide + ' ' + high, class: 'chart', role: 'img', 'aria-label': words.transmission });
    for (const v of [0, 90, 180]) picture.append(svg('line', { x1: 4, x2: wide - 4, y1: Y(v), y2: Y(v), class: 'grid' }));
    for (const v of limits || []) if (v > 0 && v < 180) picture.append(svg('line', { x1: 4, x2: wide - 4, y1: Y(v), y2: Y(v), class: 'limit' }));
    angle.forEach((one, k) => {
      let d = '', on = false;
      one.values.forEach((v, i) => { if (v === null) { on = false; return; } d += (on ? 'L' : 'M') + X(i).toFixed(1) + ' ' + Y(v).toFixed(1); on = true; });
      picture.append(svg('path', { d, class: 'curve', style: '--c:var(--link' + k % 8 + ')' }));
    });
    parts.cursor = svg('line', { y1: 4, y2: high - 4, class: 'cursor' });
    parts.cursorAt = X;
    picture.append(parts.cursor);
    parts.angles.append(head(words.transmission), picture, make('p', {}, angle.map((one) => one.name).join('; ')));
  }

  function cursor(at) {
    if (!parts.cursor) return;
    parts.cursor.style.display = at ? '' : 'none';
    if (!at) return;
    const x = parts.cursorAt(Math.abs(at.k - at.i) === 1 ? at.i + at.part * (at.k - at.i) : at.i);
    parts.cursor.setAttribute('x1', x);
    parts.cursor.setAttribute('x2', x);
  }

  /** Fields for the speed of the input and for one load. */
  function loads() {
    const { make, row, numberField, button } = board.panel, { sketch } = board.state, text = board.write();
    const held = parts.loads.contains(document.activeElement) ? document.activeElement.getAttribute('aria-label') : null;
    const group = (name) => { try { return board.text.placeOf(text, name); } catch { return undefined; } };
    const item = (place, name) => ((place && place.items.find((one) => one.name === name)) || { values: [] }).values;
    const first = (place, name, other) => { const v = Number((item(place, name)[0] || '').replace(/d/i, 'e')); return item(place, name).length && isFinite(v) ? v : other; };
    const rates = group('RATES'), place = group('LOADS'), own = !place || (item(place, 'LNAME').length === 1 && place.items.every((one) => ['NLOAD', 'LNAME', 'LFX', 'LFY'].includes(one.name)));
    const play = group('TOLER'), tolerance = row(words.tolerance, numberField(words.toleranceLabel, first(play, 'TOLLEN', 0), (value) => value >= 0 ?
      board.source.setItem('TOLER', 'TOLLEN', board.text.number(value)) : false));
    const speed = row(words.speed, numberField(words.speedLabel, first(rates, 'SPEED', 1), (value) => board.source.setItem('RATES', 'SPEED', board.text.number(value))));
    const put = (...all) => { parts.loads.replaceChildren(...all); if (held) parts.loads.querySelector('[aria-label="' + CSS.escape(held) + '"]')?.focus(); };
    if (!own) { put(speed, make('p', {}, words.severalLoads), tolerance); return; }
    const joints = sketch.joints.filter((joint) => sketch.links.slice(1).some((link) => link.joints.includes(joint.name)));
    const now = (item(place, 'LNAME')[0] || '').trim().split(/\s+/).at(-1), output = sketch.outputs.find((o) => o.kind === 'point');
    const at = make('select', { 'aria-label': words.loadAt }, ...joints.map((joint) => new Option(joint.name, joint.name)));
    at.value = joints.some((one) => one.name === now) ? now : output ? output.of[0] : joints.length ? joints.at(-1).name : '';
    const field = (label, value) => make('input', { 'aria-label': label, value: String(value), inputmode: 'decimal', autocomplete: 'off' });
    const x = field(words.loadX, first(place, 'LFX', 0)), y = field(words.loadY, first(place, 'LFY', 0));
    const set = () => {
      const [fx, fy] = [x, y].map((one) => { const v = board.panel.valueOf(one.value); one.classList.toggle('bad', !isFinite(v)); return v; });
      const link = sketch.links.slice(1).find((one) => one.joints.includes(at.value));
      if (!isFinite(fx) || !isFinite(fy) || !link) return;
      let changed = board.write();
      const words = { LNAME: "'" + link.name + ' ' + at.value + "'", LFX: board.text.number(fx), LFY: board.text.number(fy) };
      for (const [name, value] of Object.entries(words)) changed = board.text.changed(changed, 'LOADS', name, value);
      board.take(changed);
    };
    put(speed, row(words.load, at, x, y), button(words.setLoad, set, { 'aria-label': words.setLoad }), make('p', {}, answer.motion.forces ? words.loadHint : words.noForces + ' ' + words.loadHint), tolerance);
  }

  return { begin, follow, draw, ask, served, marks, shown: (tab) => { if (tab === 'engine') board.view.draw(); }, arrows,
    get answer() { return fresh ? answer : null; } };
})();
