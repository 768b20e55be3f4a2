// Moving: buttons, keys, the time line, dragging the picture and the cursor of the curves.
'use strict';

balm.controls = (() => {
  const { between, mixed, prescribedNext, within } = balm.scene;
  const REST = 0.7;                      // seconds that the end of a motion in time is shown
  const TURN_TIME = 8, RANGE_TIME = 4;   // seconds at speed 1 for a whole turn, for a part of it
  const BEFORE_TURN = 1e-6;              // the end of a whole turn is its beginning: the time line stops short of it
  const NEAR = 12;                       // part of the sweep that a joint may be dragged at a time
  const $ = (id) => document.getElementById(id);
  let last = 0;                          // time of the frame before
  let resting = 0;                       // seconds that the end of a motion in time has been shown
  let drag = null;                       // where the pointer was last; null: nothing is dragged
  let pointing = false;                  // the cursor of the curves is dragged

  const shown = () => balm.cases[balm.state.c];
  const limits = () => balm.state.whole ? shown().ends : shown().range;

  /** Seconds that the whole motion takes at the speed chosen: a turn, or a part of one there and back. */
  function duration() {
    const [from, to] = limits(), turns = shown().ring && to - from >= 360;
    if (shown().time) return shown().time / balm.state.speed;
    return (turns ? TURN_TIME : 2 * RANGE_TIME) / balm.state.speed;
  }

  /** Shows the place t of the sweep. */
  function go(t) {
    const c = shown();
    if (!c.sound) return;
    balm.state.t = within(c, t, limits());
    balm.draw();
    balm.messages.show(c, balm.state.t);
    if (Number($('time').value) !== balm.state.t) $('time').value = balm.state.t;
  }

  function setPlaying(on) {
    const { state } = balm, button = $('play');
    state.playing = on && shown().sound;
    button.textContent = state.playing ? 'Pause' : 'Play';
    button.setAttribute('aria-label', state.playing ? 'pause' : 'play');
    button.setAttribute('aria-pressed', String(state.playing));
    if (!state.playing) return;
    last = 0;
    requestAnimationFrame(tick);
  }

  function tick(now) {
    const { state } = balm;
    if (!state.playing) return;
    const [from, to] = limits(), turns = shown().ring && to - from >= 360;
    const passed = last ? (now - last) / 1000 : 0, dt = Math.min(0.1, passed);
    last = now;
    if (shown().time) {
      // in true time at speed 1; its end is shown for a moment, then it begins anew
      resting = state.t >= to ? resting + passed : 0;
      go(resting > REST ? from : state.t + state.speed * passed * (to - from) / shown().time);
      requestAnimationFrame(tick);
      return;
    }
    let t = state.t + state.forth * state.speed * dt * (to - from) / (turns ? TURN_TIME : RANGE_TIME);
    if (!turns && t >= to) { t = to; state.forth = -1; }
    if (!turns && t <= from) { t = from; state.forth = 1; }
    if (turns) state.forth = 1;
    go(t);
    requestAnimationFrame(tick);
  }

  function step(way) {
    if (!shown().sound) return;
    setPlaying(false);
    go(Math.round(balm.state.t + way));
  }

  function prescribed(way) {
    if (!shown().sound) return;
    setPlaying(false);
    go(prescribedNext(shown(), balm.state.t, way));
  }

  function speed(way) {
    const box = $('speed');
    box.selectedIndex = Math.min(box.options.length - 1, Math.max(0, box.selectedIndex + way));
    balm.state.speed = Number(box.value);
  }

  // ---- the picture --------------------------------------------------------------------------------------------------

  function grab(event) {
    const { canvas } = balm.drawing;
    if (!shown().sound) return;
    setPlaying(false);
    balm.messages.tip('');
    drag = { x: event.clientX, y: event.clientY, moved: false };
    if (event.isTrusted && canvas.setPointerCapture) canvas.setPointerCapture(event.pointerId);
  }

  /** The crank turns by the angle the pointer turns about its pivot, the slide moves by as much as the pointer. */
  function pull(event) {
    if (!drag) { if (event.pointerType !== 'touch') hover(event); return; }
    const c = shown(), s = c.sweep, { t } = balm.state, box = balm.drawing.canvas.getBoundingClientRect();
    const x0 = drag.x - box.left, y0 = drag.y - box.top, x = event.clientX - box.left, y = event.clientY - box.top;
    // a finger is never quite still
    if (event.pointerType === 'touch' && !drag.moved && Math.hypot(x - x0, y - y0) < 4) return;
    drag = { x: event.clientX, y: event.clientY, moved: true, joint: drag.joint ?? movingJoint(c, x0, y0) };
    if (c.drives) {
      follow(c, drag.joint, x, y);
    } else if (c.time) {
      follow(c, drag.joint, x, y);
    } else if (c.ring) {
      const px = c.px[c.bar.from], py = c.py[c.bar.from];
      const turn = Math.atan2(py - y, x - px) - Math.atan2(py - y0, x0 - px);
      go(t + c.sense * Math.atan2(Math.sin(turn), Math.cos(turn)) * 180 / Math.PI);
    } else {
      const at = between(c, t), k = c.bar.slide, whole = s.delt[s.n - 1] - s.delt[0];
      const along = ((x - x0) * mixed(s.ux[k], at) - (y - y0) * mixed(s.uy[k], at)) / balm.drawing.scale;
      if (whole) go(t + along / whole * (s.n - 1));
    }
  }

  /** The moving joint nearest to a point of the canvas. */
  function movingJoint(c, x, y) {
    let best = c.output, least = Infinity;
    c.joints.forEach((joint, j) => {
      const away = Math.hypot(c.px[j] - x, c.py[j] - y);
      if (!joint.fixed && away < least) [best, least] = [j, away];
    });
    return best;
  }

  /** Several drives have no one direction: the joint that was grabbed goes along its path to the place nearest to the pointer. */
  function follow(c, joint, x, y) {
    const s = c.sweep, [mx, my] = balm.drawing.machine(x, y), reach = Math.ceil(s.n / NEAR), here = Math.round(balm.state.t);
    let best = -1, least = Infinity;
    for (let i = here - reach; i <= here + reach; i++) {
      const k = c.ring ? balm.scene.modulo(i, s.n) : i;
      if (k < 0 || k >= s.n || s.closed[k] === '0') continue;
      const away = Math.hypot(mixed(s.x[joint], [k, k, 0]) - mx, mixed(s.y[joint], [k, k, 0]) - my);
      if (away < least) [best, least] = [k, away];
    }
    if (best >= 0) go(best);
  }

  /** A tap names the arc it meets: a finger cannot point. */
  function release(event) {
    if (drag && !drag.moved && event.type === 'pointerup') hover(event);
    drag = null;
  }

  function hover(event) {
    if (!shown().sound) return;
    const c = shown(), { state, drawing, messages } = balm, box = drawing.canvas.getBoundingClientRect();
    const x = event.clientX - box.left, y = event.clientY - box.top, found = drawing.nearest(c, x, y);
    messages.tip(found ? messages.describe(c, found, state.t) : '', x, y, box);
    if (found === state.hover) return;
    state.hover = found;
    balm.draw();
  }

  function leave(event) {
    if (event.pointerType === 'touch') return;
    balm.messages.tip('');
    if (!balm.state.hover) return;
    balm.state.hover = null;
    balm.draw();
  }

  // ---- the curves ---------------------------------------------------------------------------------------------------

  const beforeTurn = (t) => balm.curves.to >= 360 ? Math.min(t, balm.curves.to - BEFORE_TURN) : t;

  function point(event) {
    if (!shown().sound) return;
    const { curves } = balm, t = curves.placeAt(event.clientX - curves.canvas.getBoundingClientRect().left);
    setPlaying(false);
    go(shown().ring ? beforeTurn(t) : t);
  }

  // ---- keys ---------------------------------------------------------------------------------------------------------

  function key(event) {
    if (event.altKey || event.ctrlKey || event.metaKey || !shown().sound) return;
    const own = event.target.tagName, button = (own === 'BUTTON' || own === 'INPUT') && event.target.type !== 'range';
    if (own === 'SELECT') return;
    const far = event.shiftKey ? 10 : 1, [from, to] = limits();
    const actions = {
      ' ': () => setPlaying(!balm.state.playing),
      ArrowLeft: () => step(-far),
      ArrowRight: () => step(far),
      '+': () => speed(1),
      '=': () => speed(1),
      '-': () => speed(-1),
      Home: () => go(from),
      End: () => go(to >= 360 ? 359 : to),
      '[': () => prescribed(-1),
      ']': () => prescribed(1),
    };
    if (!(event.key in actions) || (event.key === ' ' && button)) return;
    event.preventDefault();
    actions[event.key]();
  }

  /** Everything that listens; `refresh` is called where the picture must be laid out anew. */
  function begin(refresh) {
    const { state } = balm, picture = balm.drawing.canvas, curves = balm.curves.canvas;
    $('play').addEventListener('click', () => setPlaying(!state.playing));
    $('speed').addEventListener('change', () => { state.speed = Number($('speed').value); });
    $('before').addEventListener('click', () => prescribed(-1));
    $('after').addEventListener('click', () => prescribed(1));
    $('time').addEventListener('input', () => {
      setPlaying(false);
      if (shown().sound) go(beforeTurn(Number($('time').value)));
    });
    for (const name of ['whole', 'other', 'traces', 'letters', 'forces', 'bent', 'pin']) $(name).addEventListener('change', () => {
      state[name] = $(name).checked;
      refresh();
    });
    $('group').addEventListener('change', () => {
      state.group = $('group').value;
      refresh();
    });
    $('bearing').addEventListener('change', () => {
      state.bearing = Number($('bearing').value);
      refresh();
    });
    picture.addEventListener('pointerdown', grab);
    picture.addEventListener('pointermove', pull);
    picture.addEventListener('pointerup', release);
    picture.addEventListener('pointercancel', release);
    picture.addEventListener('pointerleave', leave);
    curves.addEventListener('pointerdown', (event) => {
      pointing = true;
      if (event.isTrusted) curves.setPointerCapture(event.pointerId);
      point(event);
    });
    curves.addEventListener('pointermove', (event) => { if (pointing) point(event); });
    for (const kind of ['pointerup', 'pointercancel']) curves.addEventListener(kind, () => { pointing = false; });
    document.addEventListener('keydown', key);
  }

  return { begin, go, setPlaying, limits, duration };
})();
