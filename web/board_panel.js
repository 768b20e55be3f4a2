// Beside and below the drawing board: tabs, properties of what is chosen, positions, drives, messages.
'use strict';

board.panel = (() => {
  const $ = (id) => document.getElementById(id);
  const TABS = [['panel', board.words.tabs.panel], ['text', board.words.tabs.text], ['engine', board.words.tabs.engine], ['search', board.words.tabs.search]];
  let tab = 'panel';
  const words = board.words.panel;

  /** An element with attributes, listeners (on...) and children. */
  function make(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
      else if (value === true) element.setAttribute(name, '');
      else if (value !== false && value !== undefined) element.setAttribute(name, value);
    }
    element.append(...children);
    return element;
  }

  const pictures = make('template');
  pictures.innerHTML = '<svg></svg>';

  /** An element of a picture. */
  function svg(tag, attributes = {}) {
    const element = document.createElementNS(pictures.content.firstChild.namespaceURI, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  }

  const row = (label, ...fields) => make('div', { class: 'row' }, make('span', {}, label), ...fields);
  const head = (text) => make('h2', {}, text);

  /** A field that takes a text; `take` gives false for one that cannot be. */
  function field(label, value, take, attributes = {}) {
    const input = make('input', { value, 'aria-label': label, title: label, spellcheck: 'false', autocomplete: 'off', ...attributes });
    input.addEventListener('change', () => {
      if (input.value.trim() === String(value)) return;
      if (take(input.value.trim()) === false) input.classList.add('bad');
    });
    return input;
  }

  /** A number with its decimals; an arithmetic expression will do. */
  function numberField(label, value, take, attributes = {}) {
    return field(label, board.view.short(value) === '0' ? '0' : String(Number(value.toPrecision(12))), (text) => {
      const number = valueOf(text);
      return isFinite(number) ? take(number) : false;
    }, { inputmode: 'decimal', ...attributes });
  }

  /** Numbers, + - * / and brackets; a comma is a decimal point. */
  function valueOf(text) {
    let at = 0;
    const s = text.replace(/,/g, '.').replace(/\s/g, '');
    const sum = () => {
      let v = product();
      while (s[at] === '+' || s[at] === '-') v = s[at++] === '+' ? v + product() : v - product();
      return v;
    };
    const product = () => {
      let v = factor();
      while (s[at] === '*' || s[at] === '/') v = s[at++] === '*' ? v * factor() : v / factor();
      return v;
    };
    const factor = () => {
      if (s[at] === '-') { at++; return -factor(); }
      if (s[at] === '(') { at++; const v = sum(); if (s[at++] !== ')') return NaN; return v; }
      const found = /^(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/i.exec(s.slice(at));
      if (!found) return NaN;
      at += found[0].length;
      return Number(found[0]);
    };
    const value = sum();
    return at === s.length ? value : NaN;
  }

  const check = (label, on, take) => {
    const box = make('input', { type: 'checkbox', 'aria-label': label, onchange: () => take(box.checked) });
    box.checked = on;
    return box;
  };

  function choice(label, options, value, take) {
    const select = make('select', { 'aria-label': label, onchange: () => take(select.value) }, ...options.map((name) => new Option(name, name)));
    select.value = value;
    return select;
  }

  const button = (text, act, attributes = {}) => make('button', { type: 'button', onclick: act, ...attributes }, text);

  // ---- parts --------------------------------------------------------------------------------------------------------

  function show(rough = false) {
    const { state } = board, { sketch } = state;
    $('title').value = sketch.title;
    document.title = words.pageTitle(sketch.title);
    $('undo').disabled = !board.canUndo();
    $('redo').disabled = !board.canRedo();
    showState();
    if (rough) return;
    const panel = $('panel'), held = document.activeElement && panel.contains(document.activeElement) ?
      document.activeElement.getAttribute('aria-label') : null;
    panel.replaceChildren(...chosen(), ...drivePart(), ...positionPart(), ...outputPart(), ...listPart(), ...board.picture.part());
    if (held) panel.querySelector('[aria-label="' + CSS.escape(held) + '"]')?.focus();
    showDrives();
    follow();
  }

  /** Freedom, or what is wrong, in words. */
  function showState() {
    const { state } = board, chip = $('chip'), wrong = state.messages.length > 0;
    chip.className = wrong ? 'wrong' : '';
    const n = state.sketch.drives.length;
    const text = wrong ? state.messages[0].text : board.words.freedom.moves(n);
    if (chip.textContent !== text) chip.textContent = text;
  }

  function chosen() {
    const { state } = board, s = state.selection;
    if (!s) return [];
    if (s.many) return manyPart(s);
    if (s.joint) return jointPart(board.jointOf(s.joint));
    if (s.link) return linkPart(board.linkOf(s.link));
    if (s.slide) return slidePart(state.sketch.slides.find((one) => one.name === s.slide));
    return cylinderPart(s.cylinder);
  }

  /** Several things: which, a step for all, Delete. */
  function manyPart(s) {
    const by = [0, 0], step = (axis) => (value) => { by[axis] = value; };
    return [head(words.several(s.many.length)), make('p', {}, words.severalHint),
      make('div', { class: 'list' }, ...s.many.map((one) => {
        const [kind, name] = Object.entries(one)[0];
        return button(name + ' \u00d7', () => { board.chooseMore(one); show(); board.view.draw(); }, { 'aria-label': words.chosenNoMore[kind](name) });
      })),
      row(words.moveBy, numberField(words.moveX, 0, step(0)), numberField(words.moveY, 0, step(1)),
        button(words.move, () => { if (by[0] || by[1]) board.edit((sketch) => board.shift(sketch, s, by)); })),
      button(words.delete, () => board.remove(s))];
  }

  function jointPart(joint) {
    const { edit } = board, { name } = joint;
    const move = (key) => (value) => edit((sketch) => { joint = board.jointOf(name); joint[key] = value; board.relax(sketch, [name]); });
    const places = board.places().get(name);
    return [head(words.joint(name)),
      row(words.name, field(words.jointName, name, (text) => board.rename('joint', name, text) && choose({ joint: text }))),
      row('x', numberField('x', board.state.live ? places[0] : joint.x, move('x'))), row('y', numberField('y', board.state.live ? places[1] : joint.y, move('y'))),
      row(words.frame, check(words.pinned, board.inFrame(name), () => board.tools.pivot(name))),
      row(words.output, check(words.pathIsOutput, board.state.sketch.outputs.some((o) => o.kind === 'point' && o.of[0] === name), () => board.tools.output({ joint: name }))),
      make('p', {}, words.linksOf(board.linksAt(name).map((l) => l.name))),
      button(words.delete, () => board.remove({ joint: name }))];
  }

  function linkPart(link) {
    const { edit } = board, { name } = link, frame = link === board.state.sketch.links[0], at = board.places();
    const parts = [head(frame ? words.frameHead : words.link(name)),
      row(words.name, field(words.linkName, name, (text) => board.rename('link', name, text) && choose({ link: text }))),
      row(words.joints, field(words.linkJoints, link.joints.join(' '), (text) => {
        let joints;
        try {
          joints = board.text.jointsIn(text, board.state.sketch.joints.map((j) => j.name), (words) => new RangeError(words));
        } catch { return false; }
        edit((sketch) => { board.linkOf(name).joints = [...new Set(joints)]; board.tidy(sketch); });
      }))];
    if (!frame) {
      for (const [a, b] of board.sides(link)) {
        const [p, q] = [at.get(a), at.get(b)], length = Math.hypot(q[0] - p[0], q[1] - p[1]), label = a + ' ' + b;
        const exact = board.state.sketch.lengths.find((l) => l.joints.includes(a) && l.joints.includes(b));
        const fix = (value) => edit((sketch) => {
          sketch.lengths = sketch.lengths.filter((l) => !(l.joints.includes(a) && l.joints.includes(b)));
          if (value > 0) sketch.lengths.push({ joints: [a, b], value });
          board.relax(sketch);
        });
        parts.push(row(label, numberField(words.length(label), exact ? exact.value : length, (value) => value > 0 ? fix(value) : false),
          check(words.exactLength(label), Boolean(exact), (on) => fix(on ? Number(length.toPrecision(12)) : 0))));
      }
      parts.push(make('p', {}, words.lengthHint), ...rangePart(link),
        button(words.delete, () => board.remove({ link: name })));
    }
    return parts;
  }

  /** Least and most of the dimensions of a link, which searches honour. */
  function rangePart(link) {
    const { sketch } = board.state, { TURNS, sizeOf } = board.text, list = board.search.dimensionsOf(link).filter((of) => !/^place/.test(of));
    if (!list.length) return [];
    const set = (of, side) => (value) => {
      const angle = /^angle/.test(of), { vary } = sketch, there = vary.find((one) => one.of === of);
      const range = { low: there && there.low.length ? there.low[0] : NaN, high: there && there.high.length ? there.high[0] : NaN, [side]: value };
      // one bound alone: the other is far
      const far = angle ? { low: -TURNS, high: TURNS } : { low: 0, high: Number((10 * sizeOf(sketch.joints)).toPrecision(3)) };
      for (const key of ['low', 'high']) if (Number.isNaN(range[key])) range[key] = far[key];
      if (range.low > range.high || (!angle && range.low < 0)) return false;
      return board.edit((s) => {
        const one = { of, low: [range.low], high: [range.high] };
        s.vary = s.vary.some((each) => each.of === of) ? s.vary.map((each) => each.of === of ? one : each) : [...s.vary, one];
      });
    };
    const clear = (of) => board.edit((s) => { s.vary = s.vary.filter((one) => one.of !== of); });
    return [head(words.ranges), make('p', {}, words.rangeHint), ...list.map((of) => {
      const one = sketch.vary.find((each) => each.of === of && each.low.length);
      const bound = (side, label) => field(label(of), one ? String(one[side][0]) : '', (text) => {
        const number = valueOf(text);
        return isFinite(number) ? set(of, side)(number) : false;
      }, { inputmode: 'decimal', placeholder: side === 'low' ? words.least : words.most });
      return row(of, bound('low', words.leastOf), bound('high', words.mostOf), ...(one ? [button(words.cross, () => clear(of), { 'aria-label': words.noRange(of) })] : []));
    })];
  }

  function slidePart(slide) {
    const { edit, state } = board, { name } = slide, names = state.sketch.links.map((l) => l.name);
    const set = (key) => (value) => edit((sketch) => { sketch.slides.find((one) => one.name === name)[key] = value; });
    const onto = (i) => (value) => edit((sketch) => { sketch.slides.find((one) => one.name === name).links[i] = value; });
    return [head(words.slide(name)), row(words.name, field(words.slideName, name, (text) => board.rename('slide', name, text) && choose({ slide: text }))),
      row(words.lineOn, choice(words.lineOnLabel, names, slide.links[0], onto(0))),
      row(words.slides, choice(words.slidesLabel, names, slide.links[1], onto(1))),
      row(words.angle, numberField(words.slideAngle, slide.angle, set('angle'))),
      row(words.throughX, numberField(words.lineX, slide.x, set('x'))),
      row('y', numberField(words.lineY, slide.y, set('y'))),
      row(words.driven, check(words.slideDriven, state.sketch.drives.some((d) => d.at[0] === name), () => board.tools.drive({ slide: name }))),
      button(words.delete, () => board.remove({ slide: name }))];
  }

  function cylinderPart(at) {
    return [head(words.cylinder(at)), make('p', {}, words.cylinderOf(at)),
      button(words.delete, () => board.remove({ cylinder: at }))];
  }

  /** The drives, and between which links they act. */
  function drivePart() {
    const { state, edit } = board, { drives, links } = state.sketch;
    if (!drives.length) return [];
    const parts = [head(words.drives(drives.length))];
    drives.forEach((drive, i) => {
      const at = drive.at.join(' '), label = words.driveKind[drive.kind](at);
      parts.push(row(label, ...(drive.kind === 'turn' ? [choice(words.drivenAt(at), links.filter((l) => l.joints.includes(drive.at[0])).map((l) => l.name),
        drive.link || (board.state.motion.mech ? links[board.state.motion.mech.drives[i].link].name : ''), (name) => edit((sketch) => {
          const one = sketch.drives[i];
          one.link = name;
          if (!one.base || one.base === name) one.base = (sketch.links.find((l) => l.joints.includes(one.at[0]) && l.name !== name) || { name: '' }).name;
        }))] : []), button(words.cross, () => edit((sketch) => { sketch.drives.splice(i, 1); board.tidy(sketch); }), { 'aria-label': words.noDrive(at) })));
      if (i > 0) parts.push(row(words.ratio, numberField(words.ratioOf(at), drive.ratio, (value) => edit((sketch) => { sketch.drives[i].ratio = value; }))));
    });
    return parts;
  }

  /** The positions of the data set. */
  function positionPart() {
    const { state, edit } = board, { sketch } = state;
    if (!sketch.drives.length) return [];
    if (sketch.drives.some((d) => d.grid)) return [head(words.positions), make('p', {}, words.gridOfStrokes)];
    const list = (label, values, take) => field(label, values.join(' '), (text) => {
      const numbers = text.split(/[\s;]+/).filter(Boolean).map(valueOf);
      return numbers.length && numbers.every(isFinite) ? take(numbers) : false;
    });
    const parts = [head(words.positions), row(words.every, numberField(words.everyLabel, sketch.ikin, (value) => {
      if (!Number.isInteger(value) || Math.abs(value) > 360) return false;
      edit((s) => { s.ikin = value; if (!value && !s.delt.length) s.delt = [0, 10, 20, 30]; });
    }), make('span', { style: 'flex:0 0 auto' }, words.degrees))];
    if (sketch.ikin) return parts;
    sketch.drives.forEach((drive, i) => {
      if (i && drive.ratio) return;
      const at = drive.at.join(' ');
      parts.push(row(at, list(words.positionsOf(at), i ? drive.delt : sketch.delt, (numbers) => edit((s) => {
        const n = numbers.length;
        if (i) s.drives[i].delt = numbers; else s.delt = numbers;
        const fill = (values) => Array.from({ length: n }, (_, k) => values[k] ?? values.at(-1) ?? 0);
        s.delt = fill(s.delt);
        s.drives.forEach((d, k) => { if (k && !d.ratio) d.delt = fill(d.delt); });
      }))));
    });
    parts.push(make('p', {}, words.countedFrom));
    return parts;
  }

  function outputPart() {
    const { state, edit } = board, { outputs } = state.sketch;
    const add = field(words.outputToAdd, '', (text) => {
      const words = text.split(/\s+/);
      if (!['point', 'x', 'y', 'angle', 'distance', 'slide', 'between', 'pose', 'ratio'].includes(words[0]) || words.length < 2) return false;
      const known = (word) => board.jointOf(word) || board.linkOf(word) || state.sketch.slides.some((s) => s.name === word) ||
        (words[0] === 'ratio' ? outputs.some((o) => (o.name || [o.kind, ...o.of].join('_')) === word) : [...word].every((letter) => board.jointOf(letter)));
      if (!words.slice(1).every(known)) return false;
      edit((sketch) => { sketch.outputs.push({ kind: words[0], of: words.slice(1), name: '' }); });
    }, { placeholder: words.outputExample });
    return [head(words.outputs), make('div', { class: 'list' }, ...outputs.map((one, i) => button([one.kind, ...one.of].join(' ') + ' \u00d7', () =>
      edit((sketch) => { sketch.outputs.splice(i, 1); }), { 'aria-label': words.noOutput([one.kind, ...one.of].join(' ')) }))), row(words.add, add)];
  }

  /** All joints and links, to be chosen without a mouse. */
  function listPart() {
    const { sketch } = board.state;
    const item = (kind) => ({ name }) => button(name, (event) => {
      if (event.shiftKey) { board.chooseMore({ [kind]: name }); choose(board.state.selection); } else choose({ [kind]: name });
    }, { class: board.isChosen(kind, name) ? 'on' : '', 'aria-label': kind + ' ' + name });
    const [joints, links, slides] = [['joint', sketch.joints], ['link', sketch.links], ['slide', sketch.slides]].map(([kind, all]) => all.map(item(kind)));
    const parts = [head(words.jointsHead), make('div', { class: 'list' }, ...joints), head(words.links), make('div', { class: 'list' }, ...links)];
    if (slides.length) parts.push(head(words.slidesHead), make('div', { class: 'list' }, ...slides));
    const place = field(words.newJointLabel, '', (text) => {
      const at = text.split(/[\s;]+/).map(valueOf);
      if (at.length !== 2 || !at.every(isFinite)) return false;
      board.tools.jointAt(at);
    }, { placeholder: 'x y' });
    const link = field(words.newLinkLabel, '', (text) => {
      let joints;
      try {
        joints = [...new Set(board.text.jointsIn(text, sketch.joints.map((j) => j.name), (words) => new RangeError(words)))];
      } catch { return false; }
      if (joints.length < 2) return false;
      board.edit((one) => { one.links.push({ name: board.freeName('link'), joints }); });
    }, { placeholder: 'B C' });
    return [...parts, row(words.newJoint, place), row(words.newLink, link)];
  }

  function choose(what) {
    board.state.selection = what;
    show();
    board.view.draw();
  }

  // ---- drives and facts ---------------------------------------------------------------------------------------------

  /** A slider for each drive that is its own. */
  function showDrives() {
    const { state } = board, { sketch, motion } = state, several = board.free() > 1;
    $('drives').replaceChildren(...(motion.sweep ? sketch.drives : []).flatMap((drive, k) => {
      if (drive.ratio) return [];
      const at = drive.at.join(' '), turns = drive.kind === 'turn', value = make('span', { 'data-drive': String(k) });
      const values = motion.sweep.states.map((one) => one.inputs[k] / (turns ? board.motion.RADIAN : 1));
      const size = motion.mech.size, room = several ? (turns ? 90 : 0.15 * size) : 0;
      const low = values.reduce((a, b) => Math.min(a, b)) - room, high = values.reduce((a, b) => Math.max(a, b)) + room;
      const range = make('input', { type: 'range', min: several ? low : 0, max: several ? high : motion.sweep.states.length - 1, step: several ? (high - low) / 1000 : 1,
        'aria-label': words.driveSlider(at), 'data-drive': String(k) });
      range.addEventListener('input', () => {
        board.pause();
        if (several) board.drive(k, Number(range.value)); else board.go(Number(range.value));
      });
      return [make('label', {}, at, make('div', { class: 'track' }, range), value)];
    }));
    board.engine.marks();
  }

  /** What changes while it moves. */
  function follow() {
    const { state } = board, { live, motion, sketch } = state, several = board.free() > 1;
    $('play').disabled = !motion.sweep;
    if (!live || !motion.sweep) { $('facts').textContent = ''; return; }
    for (const part of $('drives').querySelectorAll('[data-drive]')) {
      const k = Number(part.dataset.drive), turns = sketch.drives[k].kind === 'turn', value = live.inputs[k] / (turns ? board.motion.RADIAN : 1);
      if (part.tagName === 'INPUT') part.value = several ? value : Math.round(state.t);
      else part.textContent = board.view.short(Number(value.toPrecision(5))) + (turns ? '\u00b0' : '');
    }
    const facts = sketch.outputs.slice(0, 4).flatMap((one) => Object.entries(board.motion.output(motion.mech, live, one)))
      .map(([name, value]) => name.replace(/_/g, ' ') + ' ' + board.view.short(Number(value.toPrecision(6))));
    const ends = motion.sweep.ring || several || motion.sweep.states.length < 2 ? '' : range(motion.sweep, sketch);
    $('facts').textContent = facts.join(', ') + ends;
  }

  /** How far it goes between its dead points. */
  function range(sweep, sketch) {
    const turns = sketch.drives[0].kind === 'turn', of = (one) => board.view.short(Number((one.inputs[0] / (turns ? board.motion.RADIAN : 1)).toPrecision(4)));
    return words.goes(of(sweep.states[0]), of(sweep.states.at(-1)) + (turns ? '\u00b0' : ''));
  }

  /** Shows one of the parts beside the drawing. */
  function turnTo(name) {
    tab = name;
    for (const [id] of TABS) {
      $(id).hidden = id !== name;
      const button = $('tab-' + id);
      if (!button) continue;
      button.setAttribute('aria-selected', String(id === name));
      button.tabIndex = id === name ? 0 : -1;
    }
    $('side').dataset.tab = name;
    for (const part of [board.source, board.engine, board.search]) if (part.shown) part.shown(name);
  }

  function listTabs() {
    for (const [id, words] of TABS) {
      if (!board.engine.served && (id === 'engine' || id === 'search')) continue;
      const tabButton = button(words, () => turnTo(id), { id: 'tab-' + id, role: 'tab', 'aria-controls': id });
      tabButton.addEventListener('keydown', (event) => {
        const all = [...$('tabs').children], step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (!step) return;
        event.preventDefault();
        event.stopPropagation();
        const next = all[(all.indexOf(tabButton) + step + all.length) % all.length];
        next.click();
        next.focus();
      });
      $('tabs').append(tabButton);
    }
    turnTo('panel');
  }

  /** The words of what is on the page from the beginning. */
  function name() {
    for (const [id, { text, title, label }] of Object.entries(board.words.page)) {
      const element = $(id);
      if (text) element.textContent = text;
      if (title) element.title = title;
      if (label) element.setAttribute('aria-label', label);
    }
  }

  function begin() {
    name();
    listTabs();
    $('title').addEventListener('change', () => board.edit((sketch) => { sketch.title = $('title').value.trim().slice(0, 72) || board.words.title; }));
    $('grid').append(new Option(words.gridAuto, 'auto'), new Option(words.gridOff, '0'), ...[0.1, 0.5, 1, 2, 5, 10, 20, 50].map((v) => new Option(v, v)));
  }

  return { begin, show, follow, choose, valueOf, make, svg, row, head, button, check, numberField, turnTo, get tab() { return tab; } };
})();
