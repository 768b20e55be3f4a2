// Start, state, choice of the case.
'use strict';

(() => {
  const { scene, drawing, curves, charts, allotted, messages, controls, save } = balm;
  const $ = (id) => document.getElementById(id);
  const cases = scene.read($('data').textContent);
  const state = {
    c: 0,                   // case shown
    t: 0,                   // place on its sweep
    playing: false,
    speed: 1,
    forth: 1,               // -1: a part of a turn is played backwards
    whole: true,            // the whole turn, not only what is prescribed
    other: false,           // other assemblies
    traces: true,
    letters: true,
    forces: true,           // centres of mass, loads
    bent: true,             // a vibrating link is drawn bent
    pin: true,              // a pin with clearance is drawn in its hole, magnified
    bearing: -1,            // joint of the polar diagram
    overlays: new Set(),    // cases laid over the one shown
    group: 'all',           // curves that are shown
    paths: new Set(),       // joints whose paths are drawn
    hover: null,            // bar under the pointer
  };
  let laidOut = false;      // a linkage has been drawn

  const shown = () => cases[state.c];
  const titleOf = (c) => c.title || 'untitled';

  /** One frame. */
  function draw() {
    const c = shown();
    if (!c.sound) return;
    drawing.frame(c, state.t);
    curves.frame(c, state.t);
  }

  function choose(i) {
    const c = scene.prepare(cases[i]), fresh = state.c !== i || !laidOut;
    state.c = i;
    state.hover = null;
    $('case').value = String(i);
    // a case that is shown cannot be laid over itself
    for (const box of $('overlays').querySelectorAll('input')) box.disabled = Number(box.dataset.overlay) === i;
    $('title').textContent = document.title = titleOf(c);
    $('stage').hidden = !c.sound;
    if (!c.sound) $('chartbox').hidden = $('allottedbox').hidden = true;
    document.querySelector('.keys').hidden = !c.sound;
    messages.list(c);
    if (!c.sound) {
      nameCases();
      $('facts').textContent = '';
      controls.setPlaying(false);
      return;
    }
    if (fresh) [state.whole, state.t, state.forth] = [!c.limited, c.at[c.reference], 1];
    offerForces(c, fresh);
    if (fresh) offerCurves(c);
    if (fresh) offerPaths(c);
    $('bentbox').hidden = !c.vibration;
    $('pinbox').hidden = !c.clearance;
    $('whole').checked = state.whole;
    $('wholebox').hidden = !c.limited;
    $('clock').hidden = !c.time;
    $('speed').title = c.time ? 'times true time' : '';
    $('time').setAttribute('aria-label', c.time ? 'time' : 'input');
    $('other').parentNode.hidden = !c.pairs.length;
    refresh();
  }

  /** Lays out everything: after a change of case, size or colours. */
  function refresh() {
    const c = shown();
    nameCases();
    if (!c.sound) return;
    drawing.layOut(c);
    curves.layOut(c);
    charts.layOut(c);
    allotted.layOut(c);
    for (const box of $('overlays').querySelectorAll('input')) {
      const on = box.checked && !box.disabled;
      box.parentNode.style.color = on ? drawing.linkColour(Number(box.dataset.overlay) + 1) : '';
    }
    laidOut = true;
    $('time').min = curves.from;
    $('time').max = curves.to;
    controls.go(state.t);
  }

  /** Choices that only a case with forces has. */
  function offerForces(c, fresh) {
    $('forcebox').hidden = $('bearingbox').hidden = !c.forces;
    if (!c.forces || !fresh) return;
    state.bearing = 0;
    $('bearing').replaceChildren(...c.forces.joints.map((joint, i) => new Option(joint.name, i)));
  }

  /** Which curves there are to choose from. */
  function offerCurves(c) {
    drawing.readColours();
    const groups = curves.groupsOf(c);
    state.group = curves.firstGroup(c);
    if (state.group === 'usual') groups.splice(1, 0, ['usual', 'all but velocity, acceleration']);
    $('groupbox').hidden = groups.length < 2;
    $('group').replaceChildren(...groups.map(([group, words]) => new Option(words, group)));
    $('group').value = state.group;
  }

  /** The joints that move, by their names. */
  function offerPaths(c) {
    state.paths.clear();
    const named = c.joints.map((joint, j) => [joint, j]).filter(([joint]) => joint.name && !joint.fixed);
    $('pathbox').hidden = !named.length || Boolean(c.meshes);
    $('paths').replaceChildren(...named.map(([joint, j]) => {
      const label = document.createElement('label'), box = document.createElement('input');
      box.type = 'checkbox';
      box.dataset.path = String(j);
      box.addEventListener('change', () => {
        if (box.checked) state.paths.add(j); else state.paths.delete(j);
        refresh();
      });
      label.append(box, ' ' + joint.name);
      return label;
    }));
  }

  /** Titles in the list as long as the window has room for. */
  function nameCases() {
    const room = Math.max(12, Math.floor((document.documentElement.clientWidth - 130) / 10));
    [...$('case').options].forEach((option, i) => {
      option.textContent = (i + 1) + ': ' + scene.shortTitle(titleOf(cases[i]), room);
      option.title = titleOf(cases[i]);
    });
  }

  function listCases() {
    cases.forEach((c, i) => {
      const option = document.createElement('option');
      option.value = String(i);
      $('case').append(option);
      const label = document.createElement('label'), box = document.createElement('input');
      box.type = 'checkbox';
      box.dataset.overlay = String(i);
      box.setAttribute('aria-label', 'overlay case ' + (i + 1));
      box.addEventListener('change', () => {
        if (box.checked) state.overlays.add(i); else state.overlays.delete(i);
        refresh();
      });
      label.append(box, ' ' + (i + 1));
      $('overlays').append(label);
    });
    $('chooser').hidden = $('overlays').hidden = cases.length < 2;
    $('case').addEventListener('change', () => choose(Number($('case').value)));
  }

  function start() {
    drawing.begin();
    curves.begin();
    charts.begin();
    allotted.begin();
    controls.begin(refresh);
    save.begin();
    listCases();
    new ResizeObserver(refresh).observe($('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refresh);
    // paper is white, whatever the scheme of the screen
    for (const [kind, paper] of [['beforeprint', true], ['afterprint', false]]) addEventListener(kind, () => {
      document.documentElement.classList.toggle('paper', paper);
      refresh();
    });
    choose(0);
  }

  /** Mean time of a frame, milliseconds, over a turn; with `raster` the pixels are waited for. */
  function frameTime(count = 200, raster = false) {
    if (!shown().sound) return 0;
    const before = state.t, [from, to] = controls.limits(), began = performance.now();
    for (let i = 0; i < count; i++) {
      state.t = from + (to - from) * ((i * 0.618034) % 1);
      draw();
      if (raster) for (const pen of [drawing.pen, curves.chart]) pen.getImageData(0, 0, 1, 1);
    }
    const mean = (performance.now() - began) / count;
    state.t = before;
    draw();
    return mean;
  }

  /** What a script on the page, or a test, may use. */
  const api = {
    cases, state, draw, frameTime, choose,
    go: controls.go,
    play: () => controls.setPlaying(true),
    pause: () => controls.setPlaying(false),
    get position() { return state.t; },
    get playing() { return state.playing; },
    get current() { return state.c; },
    get speed() { return state.speed; },
    get overlays() { return [...state.overlays]; },
    get input() { return shown().sound ? scene.inputAt(shown(), state.t) : null; },
    /** Co-ordinates of a joint as drawn, in machine axes. */
    joint: (j) => drawing.machine(shown().px[j], shown().py[j]),
    /** Where a joint is on the screen. */
    screen(j) {
      const box = drawing.canvas.getBoundingClientRect();
      return [box.left + shown().px[j], box.top + shown().py[j]];
    },
  };
  Object.defineProperties(balm, Object.getOwnPropertyDescriptors(api));
  start();
})();
