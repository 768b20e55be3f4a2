// Tools of the drawing board: pointer (mouse, pen, fingers), wheel, keys, buttons.
'use strict';

board.tools = (() => {
  const { view } = board;
  const $ = (id) => document.getElementById(id);
  const CLICK = 5, TOUCH_CLICK = 12;     // pixels that a pointer may move in a click
  const BAR_STEPS = 20;                  // places on a bar where a joint may be put
  const ANGLE = 15;                      // degrees between directions of a slide that is drawn
  const TOOLS = [
    ['select', 'v', 'M6 3l13 9-6 1.5-2.5 6z'],
    ['several', 'm', 'M4 4h3M10 4h4M17 4h3v3M20 10v4M20 17v3h-3M14 20h-4M7 20H4v-3M4 14v-4M4 7V4M9 9l7 5-3.500 1-1.500 3.500z'],
    ['link', 'l', 'M6 18L18 6M6 18m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0M18 6m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0'],
    ['pivot', 'p', 'M12 8L5 19h14zM12 8m-3 0a3 3 0 1 0 6 0a3 3 0 1 0-6 0'],
    ['slider', 's', 'M2 18h20M7 8h10v7H7zM2 5h20'],
    ['drive', 'd', 'M5 14a7 7 0 1 1 3 4M5 14l-3-3M5 14l4-2'],
    ['output', 'o', 'M12 3l2.6 6 6.4.5-4.900 4.200 1.500 6.300-5.600-3.400-5.600 3.400 1.500-6.300L3 9.500l6.400-.5z'],
    ...(board.engine.served ? [['wanted', 'w', 'M4 15c2-9 8-12 11-8s-1 6-3 5 1-6 8-7']] : []),
    ['delete', 'x', 'M6 6l12 12M18 6L6 18'],
  ];
  const pointers = new Map();
  let press = null;                      // what the pointer that is down does
  let pinch = 0;                         // distance of two fingers
  let hand = null;                       // points of a curve that is being drawn
  let marquee = null;                        // corners of the box that is pulled round what is to be chosen, pixels

  // ---- what tools do ------------------------------------------------------------------------------------------------

  const edit = (change) => board.edit(change);

  /** A joint at a place; on a link it belongs to it. Gives its name. */
  function addJoint(sketch, [x, y], on = '') {
    const name = board.freeName('joint');
    sketch.joints.push({ name, x, y });
    if (on) sketch.links.find((l) => l.name === on).joints.push(name);
    return name;
  }

  /** A frame joint at a place that is typed in: it can be freed, or have links pulled from it. A joint that is there is pinned. */
  function jointAt(place) {
    edit((sketch) => {
      const name = jointOn(place) || addJoint(sketch, place);
      if (!board.inFrame(name)) sketch.links[0].joints.push(name);
      board.state.selection = { joint: name };
    });
  }

  /** Pins a joint to the frame or frees it. */
  function pivot(name) {
    edit((sketch) => {
      const frame = sketch.links[0];
      if (frame.joints.includes(name)) frame.joints = frame.joints.filter((one) => one !== name);
      else frame.joints.push(name);
      board.tidy(sketch);
    });
  }

  /** The joint at the start or end of what is pulled: one that is there, one on a link, or a new one. */
  const jointFor = (sketch, at) => at.hit && at.hit.joint ? at.hit.joint : addJoint(sketch, at.place, at.hit && at.hit.link);

  function link(from, to) {
    if (from.hit && to.hit && from.hit.joint && from.hit.joint === to.hit.joint) return;
    edit((sketch) => {
      const a = jointFor(sketch, from), b = jointFor(sketch, to);
      if (!sketch.links.slice(1).some((l) => l.joints.includes(a) && l.joints.includes(b))) sketch.links.push({ name: board.freeName('link'), joints: [a, b] });
      board.state.selection = { joint: b };
    });
  }

  /** A joint slides on the frame along a direction: a block with that one joint. */
  function slider(joint, angle) {
    edit((sketch) => {
      const { x, y } = board.jointOf(joint), frame = sketch.links[0];
      const has = sketch.slides.find((s) => s.links.some((name) => name !== frame.name && sketch.links.find((l) => l.name === name).joints.join() === joint));
      if (has) Object.assign(has, { x, y, angle });
      else {
        frame.joints = frame.joints.filter((one) => one !== joint);
        const name = board.freeName('block');
        sketch.links.push({ name, joints: [joint] });
        sketch.slides.push({ name: board.freeName('slide'), links: [frame.name, name], x, y, angle });
      }
      board.state.selection = { slide: (has || sketch.slides.at(-1)).name };
    });
  }

  /** Drives what was clicked, or no longer. */
  function drive({ joint, slide, cylinder }) {
    edit((sketch) => {
      const at = slide ? [slide] : cylinder ? cylinder.split(' ') : [joint], kind = slide ? 'slide' : cylinder ? 'cylinder' : 'turn';
      const there = sketch.drives.findIndex((d) => d.at.join(' ') === at.join(' '));
      if (there >= 0) { sketch.drives.splice(there, 1); board.tidy(sketch); return; }
      const one = { kind, at, base: '', link: '', ratio: 0, phase: 0, delt: [] };
      if (kind === 'turn') {
        const links = sketch.links.filter((l) => l.joints.includes(joint));
        if (links.length < 2) return;
        one.base = links[0].name;
        one.link = links[1].name;
      }
      sketch.drives.push(one);
      choosePositions(sketch);
    });
  }

  /** Positions for drives that have none: a turn of a crank alone, else a few steps. */
  function choosePositions(sketch) {
    const only = sketch.drives.length === 1, xs = sketch.joints.map((j) => j.x), ys = sketch.joints.map((j) => j.y);
    const size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
    const stroke = Number((size / 60).toPrecision(1)), steps = (by) => [0, 1, 2, 3, 4, 5, 6].map((k) => Number((k * by).toPrecision(12)));
    if (only && sketch.drives[0].kind === 'turn') { if (!sketch.delt.length) sketch.ikin = sketch.ikin || 15; return; }
    if (sketch.ikin || !sketch.delt.length) {
      sketch.ikin = 0;
      sketch.delt = steps(sketch.drives[0].kind === 'turn' ? 5 : stroke);
    }
    for (const one of sketch.drives.slice(1)) if (!one.ratio && one.delt.length !== sketch.delt.length) one.delt = sketch.delt.map(() => 0);
  }

  function output({ joint, link: name }) {
    const kind = joint ? 'point' : 'angle', of = joint || name;
    edit((sketch) => {
      const there = sketch.outputs.findIndex((o) => o.kind === kind && o.of.join() === of);
      if (there >= 0) sketch.outputs.splice(there, 1);
      else if (joint || board.linkOf(name).joints.length > 1) sketch.outputs.push({ kind, of: [of], name: '' });
    });
  }

  /** Two joints become one, in all their links. */
  function join(from, to) {
    const swap = (names) => [...new Set(names.map((name) => name === from ? to : name))];
    board.touch((sketch) => {
      for (const one of sketch.links) one.joints = swap(one.joints);
      for (const one of sketch.lengths) one.joints = one.joints.map((name) => name === from ? to : name);
      sketch.lengths = sketch.lengths.filter((one) => one.joints[0] !== one.joints[1]);
      for (const one of sketch.drives) one.at = one.at.map((name) => name === from ? to : name);
      sketch.drives = sketch.drives.filter((one) => one.kind !== 'cylinder' || one.at[0] !== one.at[1]);
      for (const one of sketch.outputs) one.of = one.of.map((name) => name === from ? to : name);
      sketch.joints = sketch.joints.filter((one) => one.name !== from);
      board.tidy(sketch);
    });
    board.state.selection = { joint: to };
  }

  // ---- pointer ------------------------------------------------------------------------------------------------------

  /** Where an event is: pixels of the canvas, place in lengths on the grid, and what is there. */
  function spot(event, without = '') {
    const box = view.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
    const hit = view.under(x, y, event.pointerType === 'touch', without), at = board.places();
    const place = hit && hit.joint ? at.get(hit.joint) : hit && hit.link && board.state.tool !== 'select' ? onLink(hit.link, view.world(x, y)) : event.altKey ? view.world(x, y) : view.snap(view.world(x, y));
    const there = jointAtPlace(place, without, at);
    return { x, y, hit: there && !(hit && hit.joint) ? { joint: there } : hit, place, touch: event.pointerType === 'touch' };
  }

  /** The joint that is where a link ends, a joint is dropped or pinned: on the grid it may be farther from the pointer than a hit. */
  const jointAtPlace = (place, without, at) => without || ['link', 'pivot'].includes(board.state.tool) ? jointOn(place, without, at) : '';

  function jointOn([x, y], without = '', at = board.places()) {
    const near = 1e-9 * (1 + Math.abs(x) + Math.abs(y));
    for (const [name, p] of at) if (name !== without && Math.hypot(p[0] - x, p[1] - y) <= near) return name;
    return '';
  }

  /** The place on a link's bars nearest to a point, in twentieths of the bar. */
  function onLink(name, [x, y]) {
    const at = board.places(), round = view.outline(board.linkOf(name).joints.map((joint) => at.get(joint)));
    let best = [x, y], least = Infinity;
    round.forEach((a, i) => {
      const b = round[(i + 1) % round.length], dx = b[0] - a[0], dy = b[1] - a[1];
      const f = Math.round(BAR_STEPS * ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy || 1)) / BAR_STEPS, g = Math.min(1, Math.max(0, f));
      const p = [a[0] + g * dx, a[1] + g * dy], away = Math.hypot(p[0] - x, p[1] - y);
      if (away < least) { best = p.map((v) => Number(v.toPrecision(12))); least = away; }
    });
    return best;
  }

  /** In the middle of a motion nothing is drawn: back to the drawing, where the same things stand elsewhere. */
  function atHome() {
    const { state } = board, { sweep } = state.motion;
    board.pause();
    if (!sweep || state.live === sweep.states[sweep.home]) return true;
    board.go(sweep.home);
    return false;
  }

  function down(event) {
    view.canvas.focus({ preventScroll: true });
    if (event.isTrusted) view.canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    if (pointers.size === 2) { cancel(); pinch = spread(); return; }
    if (pointers.size > 2) return;
    const { state } = board, first = spot(event);
    if (event.button === 1 || event.button === 2) { press = { pan: true, x: first.x, y: first.y }; return; }
    if (state.tool === 'wanted') { press = { tool: 'wanted', x: first.x, y: first.y }; hand = [view.world(first.x, first.y)]; return; }
    if (!atHome() && first.hit) return;
    const at = spot(event);
    const several = state.tool === 'several' || (state.tool === 'select' && event.shiftKey);
    press = { at, tool: several ? 'select' : state.tool, moved: false, x: at.x, y: at.y, several };
    if (several && !at.hit) marquee = { from: [at.x, at.y], to: [at.x, at.y] };
    else if (press.tool === 'select') {
      // of several that are chosen one is taken hold of for all
      const held = at.hit && board.isChosen(...Object.entries(at.hit)[0]);
      if (!several && !(held && state.selection.many)) state.selection = at.hit;
      if (several && !held) board.chooseMore(at.hit);
      press.drop = several && held;
      press.alone = !several && held;
      if (!at.hit || at.hit.cylinder) press.pan = true;
      board.panel.show();
    } else if (state.pending && state.pending.tool === state.tool) {
      press.second = state.pending.start;
    } else if (['link', 'slider', 'drive'].includes(state.tool)) {
      state.pending = { tool: state.tool, start: at, from: at.place, to: at.place };
    }
    view.draw();
  }

  function move(event) {
    const { state } = board;
    if (pointers.has(event.pointerId)) pointers.set(event.pointerId, event);
    if (pinch) { pinchTo(); return; }
    if (hand) { trace(event); return; }
    if (marquee) {
      const box = view.canvas.getBoundingClientRect();
      marquee.to = [event.clientX - box.left, event.clientY - box.top];
      press.moved = true;
      view.draw();
      return;
    }
    const dragged = draggedJoint();
    const at = spot(event, dragged);
    if (state.pending) { state.pending.to = target(state.pending, at); state.hover = at.hit; view.draw(); }
    if (!press) {
      if (event.pointerType !== 'touch') { state.hover = at.hit; view.canvas.style.cursor = cursor(at.hit); view.draw(); }
      return;
    }
    if (!press.moved && Math.hypot(at.x - press.x, at.y - press.y) < (at.touch ? TOUCH_CLICK : CLICK)) return;
    if (!press.moved) { press.moved = true; if (press.tool === 'select' && !press.pan) board.begin(); }
    if (press.pan) {
      view.pan(at.x - press.x, at.y - press.y);
      [press.x, press.y] = [at.x, at.y];
      view.draw();
    } else if (press.tool === 'select') {
      drag(at);
    }
  }

  /** The joint that is dragged by itself. */
  const draggedJoint = () => press && press.at && press.tool === 'select' && press.at.hit && !(board.state.selection && board.state.selection.many) && press.at.hit.joint || '';

  /** The curve that is being drawn goes on, with all places that the browser has kept between two frames. */
  function trace(event) {
    const box = view.canvas.getBoundingClientRect(), all = event.getCoalescedEvents ? event.getCoalescedEvents() : [];
    for (const one of all.length ? all : [event]) hand.push(view.world(one.clientX - box.left, one.clientY - box.top));
    view.draw();
  }

  /** Where the line that is pulled ends: a slide's turns in steps. */
  function target({ tool, from }, at) {
    if (tool !== 'slider') return at.place;
    const dx = at.place[0] - from[0], dy = at.place[1] - from[1], d = Math.hypot(dx, dy), a = slideAngle(dx, dy) * Math.PI / 180;
    return [from[0] + d * Math.cos(a), from[1] + d * Math.sin(a)];
  }

  const slideAngle = (dx, dy) => {
    const a = ANGLE * Math.round(Math.atan2(dy, dx) * 180 / Math.PI / ANGLE);
    return ((a % 180) + 180) % 180;
  };

  function drag(at) {
    const { hit } = press.at, { selection } = board.state;
    if (draggedJoint()) {
      board.state.hover = at.hit;
      board.touch((sketch) => {
        const joint = board.jointOf(hit.joint), [dx, dy] = [at.place[0] - joint.x, at.place[1] - joint.y];
        [joint.x, joint.y] = at.place;
        // the line of a block goes with its joint
        for (const slide of sketch.slides) if (slide.links.some((name) => board.linkOf(name).joints.join() === hit.joint)) { slide.x += dx; slide.y += dy; }
        board.relax(sketch, [hit.joint]);
      });
    } else {
      const step = [at.x - press.x, at.y - press.y], [ox, oy] = view.world(0, 0), [x, y] = view.world(...step);
      const grid = view.gridStep(), whole = (v) => grid ? grid * Math.round(v / grid) : v, by = [whole(x - ox), whole(y - oy)];
      if (!by[0] && !by[1]) return;
      const k = view.eye.k;
      [press.x, press.y] = [press.x + by[0] * k, press.y - by[1] * k];
      board.touch((sketch) => board.shift(sketch, selection && selection.many ? selection : hit, by));
    }
  }

  function up(event) {
    pointers.delete(event.pointerId);
    if (pinch) { if (pointers.size < 2) pinch = 0; return; }
    if (!press) return;
    if (hand) {
      const points = hand;
      hand = press = null;
      board.search.drawn(points);
      view.draw();
      return;
    }
    if (marquee) {
      const { from, to } = marquee, added = press.moved ? view.within(from, to) : [];
      marquee = press = null;
      for (const what of added) if (!board.isChosen(...Object.entries(what)[0])) board.chooseMore(what);
      if (!added.length) board.state.selection = null;
      board.panel.show();
      view.draw();
      return;
    }
    const { state } = board, one = press, dragged = draggedJoint();
    const at = spot(event, dragged);
    press = null;
    if (one.pan) { view.draw(); return; }
    if (one.tool === 'select') {
      if (!one.moved) {
        if (one.drop) board.chooseMore(one.at.hit);
        else if (one.alone) state.selection = one.at.hit;
        board.panel.show();
        view.draw();
        return;
      }
      if (dragged && at.hit && at.hit.joint) join(dragged, at.hit.joint);
      board.end();
      return;
    }
    const start = one.second || one.at, pulled = one.moved || Boolean(one.second);
    if (!pulled && one.tool === 'link' && !(one.at.hit && one.at.hit.link)) return;      // the second end comes with the next click
    state.pending = null;
    act(one.tool, start, at, pulled);
    view.draw();
  }

  function act(tool, start, at, pulled) {
    const { state } = board, hit = start.hit || {};
    if (tool === 'link' && pulled) link(start, at);
    else if (tool === 'link') edit((sketch) => { state.selection = { joint: addJoint(sketch, start.place, hit.link) }; });
    else if (tool === 'pivot' && hit.joint) pivot(hit.joint);
    else if (tool === 'pivot') edit((sketch) => { const name = addJoint(sketch, start.place, hit.link); sketch.links[0].joints.push(name); state.selection = { joint: name }; });
    else if (tool === 'slider' && hit.joint) slider(hit.joint, pulled ? slideAngle(at.place[0] - start.place[0], at.place[1] - start.place[1]) : 0);
    else if (tool === 'drive') driveAt(hit, at.hit || {}, pulled);
    else if (tool === 'output' && (hit.joint || hit.link)) output(hit);
    else if (tool === 'delete' && start.hit) board.remove(hit);
  }

  function driveAt(hit, end, pulled) {
    const { sketch } = board.state;
    if (pulled && hit.joint && end.joint && hit.joint !== end.joint) drive({ cylinder: hit.joint + ' ' + end.joint });
    else if (hit.cylinder || hit.slide) drive(hit);
    else if (hit.joint) {
      // the joint of a block that slides means the slide
      const slide = sketch.slides.find((s) => s.links.some((name) => board.linkOf(name).joints.join() === hit.joint));
      drive(slide && !board.inFrame(hit.joint) ? { slide: slide.name } : { joint: hit.joint });
    } else if (hit.link) {
      const joint = board.linkOf(hit.link).joints.find(board.inFrame);
      if (joint) drive({ joint });
    }
  }

  function cancel() {
    if (press && press.moved && press.tool === 'select' && !press.pan) board.end();
    press = hand = marquee = null;
    board.state.pending = null;
    view.draw();
  }

  const spread = () => { const [a, b] = [...pointers.values()]; return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY) || 1; };

  function pinchTo() {
    const [a, b] = [...pointers.values()], box = view.canvas.getBoundingClientRect(), now = spread();
    view.zoom(now / pinch, (a.clientX + b.clientX) / 2 - box.left, (a.clientY + b.clientY) / 2 - box.top);
    pinch = now;
    view.draw();
  }

  const cursor = (hit) => !['select', 'several'].includes(board.state.tool) ? 'crosshair' : hit ? 'grab' : 'default';

  // ---- buttons and keys ---------------------------------------------------------------------------------------------

  function choose(tool) {
    board.state.tool = tool;
    board.state.pending = null;
    for (const button of $('tools').children) button.setAttribute('aria-pressed', String(button.dataset.tool === tool));
    $('hint').textContent = board.words.tools[tool][1];
    view.canvas.style.cursor = cursor(null);
    view.draw();
  }

  /** Moves what is chosen by steps of the grid. */
  function nudge(dx, dy) {
    const { selection } = board.state, step = view.gridStep() || 1 / view.eye.k;
    if (!selection || !(selection.many || selection.joint || selection.link)) { view.pan(-40 * dx, 40 * dy); view.draw(); return; }
    edit((sketch) => board.shift(sketch, selection, [dx * step, dy * step]));
  }

  function key(event) {
    const own = event.target.tagName, typing = own === 'TEXTAREA' || own === 'SELECT' || (own === 'INPUT' && event.target.type !== 'range' && event.target.type !== 'checkbox');
    const control = event.ctrlKey || event.metaKey, letter = event.key.toLowerCase();
    const commands = { s: board.save, o: () => $('file').click(), z: () => event.shiftKey ? board.redo() : board.undo(), y: board.redo, a: chooseAll };
    if (control && commands[letter] && !(typing && 'zya'.includes(letter))) { event.preventDefault(); commands[letter](); return; }
    if (control || event.altKey || typing) return;
    const keys = {
      ' ': () => board.play(), Escape: () => { cancel(); board.state.selection = null; board.panel.show(); choose('select'); },
      Delete: () => board.state.selection && board.remove(board.state.selection), Backspace: () => board.state.selection && board.remove(board.state.selection),
      F1: () => board.help(), f: board.fit, '+': () => zoom(1.25), '=': () => zoom(1.25), '-': () => zoom(0.8),
    };
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const tool = TOOLS.find(([, shortcut]) => shortcut === letter);
    if (event.key === ' ' && (own === 'BUTTON' || own === 'INPUT')) return;
    if (arrows[event.key] && own === 'CANVAS') { event.preventDefault(); nudge(...arrows[event.key].map((v) => v * (event.shiftKey ? 5 : 1))); return; }
    if (keys[event.key]) { event.preventDefault(); keys[event.key](); } else if (keys[letter] && letter === 'f') keys.f(); else if (tool) choose(tool[0]);
  }

  function chooseAll() {
    const { joints, slides } = board.state.sketch, all = [...joints.map((one) => ({ joint: one.name })), ...slides.map((one) => ({ slide: one.name }))];
    board.state.selection = all.length > 1 ? { many: all } : all[0] || null;
    board.panel.show();
    view.draw();
  }

  function zoom(factor) {
    view.zoom(factor);
    view.draw();
  }

  function begin() {
    for (const [name, shortcut, path] of TOOLS) {
      const [label] = board.words.tools[name];
      const button = document.createElement('button');
      button.type = 'button';
      button.dataset.tool = name;
      button.title = label + ' (' + shortcut.toUpperCase() + ')';
      button.innerHTML = '<svg viewBox="0 0 24 24" aria-hidden="true"><path d="' + path + '"/></svg>';
      button.append(label);
      button.addEventListener('click', () => choose(name));
      $('tools').append(button);
    }
    const { canvas } = view;
    canvas.addEventListener('pointerdown', down);
    canvas.addEventListener('pointermove', move);
    canvas.addEventListener('pointerup', up);
    canvas.addEventListener('pointercancel', (event) => { pointers.delete(event.pointerId); pinch = 0; cancel(); });
    canvas.addEventListener('pointerleave', () => { if (!press && board.state.hover) { board.state.hover = null; view.draw(); } });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const box = canvas.getBoundingClientRect();
      view.zoom(1.0015 ** -event.deltaY, event.clientX - box.left, event.clientY - box.top);
      view.draw();
    }, { passive: false });
    canvas.addEventListener('dragover', (event) => event.preventDefault());
    canvas.addEventListener('drop', (event) => { event.preventDefault(); const [file] = event.dataTransfer.files; if (file) (file.type.startsWith('image/') ? board.picture : board).open(file); });
    document.addEventListener('keydown', key);
    const acts = { play: () => board.play(), undo: () => board.undo(), redo: () => board.redo(), save: () => board.save(), fit: () => board.fit(),
      larger: () => zoom(1.25), smaller: () => zoom(0.8), open: () => $('file').click(), new: () => board.start(),
      help: () => board.help() };
    for (const [id, act] of Object.entries(acts)) $(id).addEventListener('click', act);
    $('file').addEventListener('change', () => { if ($('file').files[0]) board.open($('file').files[0]); $('file').value = ''; });
    $('grid').addEventListener('change', () => { board.state.grid = $('grid').value; view.draw(); });
    $('speed').addEventListener('input', () => { board.state.speed = Number($('speed').value); });
  }

  return { begin, choose, pivot, output, drive, slider, jointAt, link, get hand() { return hand; }, get marquee() { return marquee; } };
})();
