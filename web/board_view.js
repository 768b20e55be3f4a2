// The drawing board's picture: what is on the canvas, and what is under a point of it.
'use strict';

board.view = (() => {
  const ROUND = 2 * Math.PI, FINGER = 22, MOUSE = 12;   // pixels: how near is on a joint
  const COLOURS = ['paper', 'ink', 'soft', 'line', 'accent', 'actual', 'bad', 'warn', 'good', 'frame', 'ghost',
    'link0', 'link1', 'link2', 'link3', 'link4', 'link5', 'link6', 'link7'];
  const pens = {};
  let canvas, g, w = 1, h = 1;
  const eye = { x: 0, y: 0, k: 4 };                     // middle of the view in lengths, pixels a length

  function begin() {
    canvas = document.getElementById('board');
    g = canvas.getContext('2d');
  }

  const X = (x) => w / 2 + eye.k * (x - eye.x), Y = (y) => h / 2 - eye.k * (y - eye.y);
  const world = (px, py) => [eye.x + (px - w / 2) / eye.k, eye.y - (py - h / 2) / eye.k];

  function resize() {
    const dpr = window.devicePixelRatio || 1, css = getComputedStyle(document.documentElement);
    for (const name of COLOURS) pens[name] = css.getPropertyValue('--' + name).trim();
    [w, h] = [Math.max(1, canvas.clientWidth), Math.max(1, canvas.clientHeight)];
    canvas.width = Math.round(w * dpr);
    canvas.height = Math.round(h * dpr);
    g.setTransform(dpr, 0, 0, dpr, 0, 0);
  }

  /** The eye on a box of lengths. */
  function look([x1, y1, x2, y2]) {
    const across = Math.max(x2 - x1, 1e-9), down = Math.max(y2 - y1, 1e-9), room = Math.max(across, down);
    eye.x = (x1 + x2) / 2;
    eye.y = (y1 + y2) / 2;
    eye.k = Math.min(Math.max(60, w - 150) / Math.max(across, room / 8), Math.max(60, h - Math.min(170, 0.4 * h)) / Math.max(down, room / 8));
  }

  function zoom(factor, px = w / 2, py = h / 2) {
    const [x, y] = world(px, py);
    eye.k = Math.min(1e9, Math.max(1e-9, eye.k * factor));
    const [x2, y2] = world(px, py);
    eye.x += x - x2;
    eye.y += y - y2;
  }

  function pan(dx, dy) {
    eye.x -= dx / eye.k;
    eye.y += dy / eye.k;
  }

  /** Lengths between two lines of the grid: round, and wide enough to be seen. */
  function gridStep() {
    const chosen = board.state.grid;
    if (chosen === 'auto') {
      const least = 22 / eye.k, power = 10 ** Math.floor(Math.log10(least));
      return [1, 2, 5, 10].map((s) => s * power).find((s) => s >= least * 0.999);
    }
    return Number(chosen);
  }

  /** A place on the grid, as round a number as it can be. */
  function snap([x, y]) {
    const step = gridStep();
    if (!step) return [Number(x.toPrecision(12)), Number(y.toPrecision(12))];
    const digits = Math.max(0, 2 - Math.floor(Math.log10(step)));
    return [x, y].map((v) => { const r = Number((Math.round(v / step) * step).toFixed(Math.min(20, digits))); return r === 0 ? 0 : r; });
  }

  // ---- picture ------------------------------------------------------------------------------------------------------

  const colourOf = (i) => i === 0 ? pens.frame : pens['link' + (i - 1) % 8];

  function line(x1, y1, x2, y2) {
    g.beginPath();
    g.moveTo(x1, y1);
    g.lineTo(x2, y2);
    g.stroke();
  }

  function draw() {
    const { state } = board, { sketch } = state, at = board.places();
    g.clearRect(0, 0, w, h);
    g.lineJoin = g.lineCap = 'round';
    board.picture.draw(g, X, Y);
    drawGrid();
    const p = (name) => { const [x, y] = at.get(name); return [X(x), Y(y)]; };
    drawPaths();
    board.search.draw(g, X, Y, pens);
    sketch.slides.forEach((slide, i) => drawRail(slide, i));
    sketch.gears.forEach((gear) => drawGear(gear, p));
    sketch.links.forEach((link, i) => drawLink(link, i, p));
    sketch.drives.forEach((drive) => { if (drive.kind === 'cylinder') drawCylinder(drive, p); });
    sketch.slides.forEach((slide, i) => drawBlock(slide, i, p));
    sketch.joints.forEach((joint) => drawJoint(joint, p(joint.name)));
    sketch.drives.forEach((drive) => { if (drive.kind === 'turn') drawMotor(...p(drive.at[0])); });
    drawOutputs(p);
    drawDimensions(p);
    board.engine.draw(g, X, Y, pens);
    drawPending();
  }

  function drawGrid() {
    const step = gridStep() || 22 / eye.k, [left, top] = world(0, 0), [right, bottom] = world(w, h), shown = gridStep() > 0;
    const lines = (from, to) => Array.from({ length: Math.min(400, Math.floor(to / step) - Math.ceil(from / step) + 1) }, (_, i) => Math.ceil(from / step) + i);
    g.strokeStyle = g.fillStyle = pens.line;
    g.font = '11px system-ui, sans-serif';
    for (const [list, put] of [[lines(left, right), (v) => [X(v), 0, X(v), h]], [lines(bottom, top), (v) => [0, Y(v), w, Y(v)]]]) for (const i of list) {
      const [x1, y1, x2, y2] = put(i * step), main = i % 5 === 0;
      if (!shown && !main) continue;
      g.globalAlpha = i === 0 ? 0.95 : main ? 0.55 : 0.25;
      g.lineWidth = i === 0 ? 1.3 : 1;
      line(Math.round(x1) + 0.5, Math.round(y1) + 0.5, Math.round(x2) + 0.5, Math.round(y2) + 0.5);
    }
    g.globalAlpha = 1;
    g.fillStyle = pens.soft;
    for (const i of lines(left, right)) if (i % 5 === 0 && X(i * step) > 30) g.fillText(short(i * step), X(i * step) + 3, 11);
    for (const i of lines(bottom, top)) if (i % 5 === 0 && Y(i * step) > 50) g.fillText(short(i * step), 3, Y(i * step) - 3);
  }

  const short = (v) => Number(v.toPrecision(6)).toString();

  /** Paths over the sweep: outputs strongly, other moving joints faintly. */
  function drawPaths() {
    const { motion, sketch } = board.state;
    if (!motion.sweep) return;
    const wanted = new Set(sketch.outputs.filter((o) => ['point', 'pose', 'x', 'y'].includes(o.kind)).map((o) => o.of[0]));
    sketch.joints.forEach((joint, j) => {
      if (board.inFrame(joint.name)) return;
      const strong = wanted.has(joint.name);
      g.strokeStyle = strong ? pens.actual : pens.ghost;
      g.globalAlpha = strong ? 1 : 0.55;
      g.lineWidth = strong ? 2 : 1;
      g.beginPath();
      for (const places of motion.sweep.places) g.lineTo(X(places[j][0]), Y(places[j][1]));
      if (motion.sweep.ring) g.closePath();
      g.stroke();
    });
    g.globalAlpha = 1;
  }

  /** A link: a rounded bar from joint to joint, a plate where it has more than two. */
  function drawLink(link, i, p) {
    const { hover } = board.state, chosen = board.isChosen('link', link.name);
    if (!link.joints.length) return;
    const round = outline(link.joints.map(p));
    const wide = i === 0 ? 6 : 15;
    g.strokeStyle = g.fillStyle = colourOf(i);
    if (i === 0) {
      g.setLineDash([7, 6]);
      g.lineWidth = chosen ? 3 : 1.4;
      trace(round);
      g.stroke();
      g.setLineDash([]);
      return;
    }
    if (link.joints.length === 1) return;
    if (chosen || (hover && hover.link === link.name)) {
      g.globalAlpha = 0.35;
      g.strokeStyle = pens.accent;
      g.lineWidth = wide + 9;
      trace(round);
      g.stroke();
      g.strokeStyle = colourOf(i);
    }
    g.globalAlpha = 0.2;
    g.lineWidth = wide;
    trace(round);
    g.stroke();
    if (round.length > 2) g.fill();
    g.globalAlpha = 1;
    g.lineWidth = 2.4;
    trace(round);
    g.stroke();
  }

  function trace(points) {
    g.beginPath();
    points.forEach(([x, y], i) => { if (i) g.lineTo(x, y); else g.moveTo(x, y); });
    if (points.length > 2) g.closePath();
  }

  /** Points round the outline; where they lie on a line, its ends. */
  function outline(points) {
    if (points.length < 3) return points;
    const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const half = (list) => {
      const chain = [];
      for (const q of list) {
        while (chain.length > 1) {
          const [a, b] = chain.slice(-2);
          if ((b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]) > 1e-6) break;
          chain.pop();
        }
        chain.push(q);
      }
      return chain;
    };
    return [...half(sorted).slice(0, -1), ...half(sorted.reverse()).slice(0, -1)];
  }

  /** The line of a slide, with the link that it is drawn on. */
  function drawRail(slide, i) {
    const place = board.slidePlace(i), [ux, uy] = place.u, reach = 1.2 * (w + h);
    g.strokeStyle = pens.frame;
    g.lineWidth = 1.2;
    g.setLineDash([2, 5]);
    line(X(place.x) - reach * ux, Y(place.y) + reach * uy, X(place.x) + reach * ux, Y(place.y) - reach * uy);
    g.setLineDash([]);
    g.lineWidth = 2.2;
    const half = 46;
    line(X(place.bx) - half * ux + 11 * uy, Y(place.by) + half * uy + 11 * ux, X(place.bx) + half * ux + 11 * uy, Y(place.by) - half * uy + 11 * ux);
    line(X(place.bx) - half * ux - 11 * uy, Y(place.by) + half * uy - 11 * ux, X(place.bx) + half * ux - 11 * uy, Y(place.by) - half * uy - 11 * ux);
  }

  function drawBlock(slide, i) {
    const { sketch } = board.state, place = board.slidePlace(i);
    const driven = sketch.drives.some((d) => d.kind === 'slide' && d.at[0] === slide.name);
    g.save();
    g.translate(X(place.bx), Y(place.by));
    g.rotate(-Math.atan2(place.u[1], place.u[0]));
    g.fillStyle = pens.paper;
    g.strokeStyle = board.isChosen('slide', slide.name) ? pens.accent : pens.ink;
    g.lineWidth = 2;
    g.beginPath();
    g.rect(-15, -9.5, 30, 19);
    g.fill();
    g.stroke();
    if (driven) {
      g.strokeStyle = pens.good;
      g.lineWidth = 2.4;
      line(-24, -17, 24, -17);
      line(24, -17, 18, -21);
      line(24, -17, 18, -13);
    }
    g.restore();
  }

  function drawCylinder(drive, p) {
    const [a, b] = drive.at.map(p), d = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1, f = 0.6;
    g.strokeStyle = pens.good;
    g.lineWidth = 2.6;
    line(...a, ...b);
    g.lineCap = 'butt';
    g.lineWidth = 11;
    g.globalAlpha = 0.55;
    line(a[0] + 7 * (b[0] - a[0]) / d, a[1] + 7 * (b[1] - a[1]) / d, a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]));
    g.globalAlpha = 1;
    g.lineCap = 'round';
  }

  function drawGear(gear, p) {
    const { sketch } = board.state, link = (name) => sketch.links.find((l) => l.name === name);
    const centre = (wheel) => link(wheel).joints.find((name) => link(gear.carrier).joints.includes(name));
    const [a, b] = gear.wheels.map(centre);
    if (!a || !b) return;
    const [pa, pb] = [p(a), p(b)], d = Math.hypot(pb[0] - pa[0], pb[1] - pa[1]), ratio = -gear.teeth[0] / gear.teeth[1];
    g.lineWidth = 1.4;
    [[pa, ratio / (ratio - 1), gear.wheels[0]], [pb, 1 / (ratio - 1), gear.wheels[1]]].forEach(([c, f, name]) => {
      g.strokeStyle = colourOf(sketch.links.findIndex((l) => l.name === name));
      g.beginPath();
      g.arc(c[0], c[1], Math.abs(f) * d, 0, ROUND);
      g.stroke();
    });
  }

  function drawJoint(joint, [x, y]) {
    const { hover, wrong } = board.state, chosen = board.isChosen('joint', joint.name);
    if (board.inFrame(joint.name)) {
      g.strokeStyle = pens.ink;
      g.fillStyle = pens.paper;
      g.lineWidth = 1.8;
      g.beginPath();
      g.moveTo(x, y);
      g.lineTo(x - 12, y + 19);
      g.lineTo(x + 12, y + 19);
      g.closePath();
      g.fill();
      g.stroke();
      for (let i = -14; i < 14; i += 7) line(x + i, y + 25, x + i + 6, y + 19);
      line(x - 15, y + 19, x + 15, y + 19);
    }
    const r = chosen || (hover && hover.joint === joint.name) ? 8 : 6;
    if (chosen || wrong.has(joint.name)) {
      g.fillStyle = chosen ? pens.accent : pens.warn;
      g.globalAlpha = 0.3;
      g.beginPath();
      g.arc(x, y, 15, 0, ROUND);
      g.fill();
      g.globalAlpha = 1;
    }
    g.fillStyle = pens.paper;
    g.strokeStyle = chosen ? pens.accent : wrong.has(joint.name) ? pens.warn : pens.ink;
    g.lineWidth = 2.2;
    g.beginPath();
    g.arc(x, y, r, 0, ROUND);
    g.fill();
    g.stroke();
    g.fillStyle = pens.ink;
    g.font = 'italic 600 15px system-ui, "DejaVu Sans", sans-serif';
    g.fillText(joint.name, x + 11, y - 10);
  }

  /** A crank is driven: an arrow round its joint. */
  function drawMotor(x, y) {
    g.strokeStyle = g.fillStyle = pens.good;
    g.lineWidth = 2.8;
    g.beginPath();
    g.arc(x, y, 17, 0.6, -1.9, true);
    g.stroke();
    const tip = [x + 17 * Math.cos(-1.9), y + 17 * Math.sin(-1.9)];
    g.beginPath();
    g.moveTo(tip[0] - 9, tip[1] + 3);
    g.lineTo(tip[0] + 1, tip[1] - 7);
    g.lineTo(tip[0] + 3, tip[1] + 6);
    g.closePath();
    g.fill();
  }

  function drawOutputs(p) {
    for (const output of board.state.sketch.outputs) {
      if (!['point', 'pose', 'x', 'y'].includes(output.kind)) continue;
      const [x, y] = p(output.of[0]);
      g.fillStyle = pens.actual;
      g.beginPath();
      for (let i = 0; i < 10; i++) {
        const a = -Math.PI / 2 + i * Math.PI / 5, d = i % 2 ? 4 : 10;
        g.lineTo(x + d * Math.cos(a), y + d * Math.sin(a));
      }
      g.fill();
    }
  }

  /** Exact lengths, and those of the link chosen. */
  function drawDimensions(p) {
    const { sketch, selection } = board.state, at = board.places();
    const pairs = new Map(sketch.lengths.map((l) => [l.joints.join('\n'), { joints: l.joints, exact: true }]));
    const link = selection && sketch.links.find((l) => l.name === selection.link);
    if (link && link !== sketch.links[0]) board.sides(link).forEach((joints) => {
      if (!pairs.has(joints.join('\n')) && !pairs.has(joints.slice().reverse().join('\n'))) pairs.set(joints.join('\n'), { joints, exact: false });
    });
    g.font = '12px system-ui, sans-serif';
    g.textAlign = 'center';
    for (const { joints: [a, b], exact } of pairs.values()) {
      const [x1, y1] = p(a), [x2, y2] = p(b), d = Math.hypot(x2 - x1, y2 - y1);
      if (d < 36) continue;
      const [ax, ay] = at.get(a), [bx, by] = at.get(b), text = short(Math.hypot(bx - ax, by - ay));
      const nx = (y2 - y1) / d, ny = -(x2 - x1) / d, side = ny > 0 ? -1 : 1;
      const x = (x1 + x2) / 2 + 17 * side * nx, y = (y1 + y2) / 2 + 17 * side * ny, wide = g.measureText(text).width;
      g.fillStyle = pens.paper;
      g.globalAlpha = 0.85;
      g.fillRect(x - wide / 2 - 3, y - 8, wide + 6, 16);
      g.globalAlpha = 1;
      g.fillStyle = exact ? pens.accent : pens.soft;
      g.fillText(text, x, y + 4);
    }
    g.textAlign = 'left';
  }

  /** What a tool is about to make, or the box that is pulled round what is to be chosen. */
  function drawPending() {
    const { pending } = board.state, { marquee } = board.tools;
    if (marquee) {
      const { from, to } = marquee, [x1, x2, y1, y2] = [...sorted(from[0], to[0]), ...sorted(from[1], to[1])];
      g.strokeStyle = g.fillStyle = pens.accent;
      g.lineWidth = 1.4;
      g.setLineDash([5, 4]);
      g.strokeRect(x1, y1, x2 - x1, y2 - y1);
      g.setLineDash([]);
      g.globalAlpha = 0.1;
      g.fillRect(x1, y1, x2 - x1, y2 - y1);
      g.globalAlpha = 1;
    }
    if (!pending) return;
    const [x1, y1] = [X(pending.from[0]), Y(pending.from[1])], [x2, y2] = [X(pending.to[0]), Y(pending.to[1])];
    g.strokeStyle = pens.accent;
    g.lineWidth = 2.5;
    g.setLineDash([6, 5]);
    line(x1, y1, x2, y2);
    g.setLineDash([]);
    for (const [x, y] of [[x1, y1], [x2, y2]]) {
      g.beginPath();
      g.arc(x, y, 6, 0, ROUND);
      g.stroke();
    }
    g.fillStyle = pens.accent;
    g.font = '12px system-ui, sans-serif';
    const dx = pending.to[0] - pending.from[0], dy = pending.to[1] - pending.from[1];
    g.fillText(short(Math.hypot(dx, dy)) + '  ' + short(Number((Math.atan2(dy, dx) * 180 / Math.PI).toFixed(2))) + '\u00b0', x2 + 12, y2 + 20);
  }

  const sorted = (a, b) => [Math.min(a, b), Math.max(a, b)];

  /** Joints and slides in a box of the canvas. */
  function within(from, to) {
    const { sketch } = board.state, at = board.places(), [x1, x2] = sorted(from[0], to[0]), [y1, y2] = sorted(from[1], to[1]);
    const inside = (x, y) => x >= x1 && x <= x2 && y >= y1 && y <= y2;
    return [...sketch.joints.filter((joint) => inside(X(at.get(joint.name)[0]), Y(at.get(joint.name)[1]))).map((joint) => ({ joint: joint.name })),
      ...sketch.slides.filter((slide, i) => { const place = board.slidePlace(i); return inside(X(place.bx), Y(place.by)); }).map((slide) => ({ slide: slide.name }))];
  }

  // ---- what is under a point ----------------------------------------------------------------------------------------

  const distance = (px, py, [ax, ay], [bx, by]) => {
    const dx = bx - ax, dy = by - ay, f = Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy || 1)));
    return Math.hypot(px - ax - f * dx, py - ay - f * dy);
  };

  /** The joint, else the slide, else the link under a point of the canvas; `touch`: by a finger; `without`: a joint not looked at. */
  function under(px, py, touch = false, without = '') {
    const { sketch } = board.state, at = board.places(), p = (name) => { const [x, y] = at.get(name); return [X(x), Y(y)]; };
    let best = null, least = touch ? FINGER : MOUSE;
    for (const joint of sketch.joints) {
      const [x, y] = p(joint.name), away = Math.hypot(px - x, py - y);
      if (joint.name !== without && away < least) { best = { joint: joint.name }; least = away; }
    }
    if (best) return best;
    sketch.slides.forEach((slide, i) => {
      const place = board.slidePlace(i);
      if (!best && Math.hypot(px - X(place.bx), py - Y(place.by)) < 18) best = { slide: slide.name };
    });
    if (best) return best;
    least = touch ? 16 : 9;
    sketch.links.forEach((link, i) => {
      if (i === 0 || link.joints.includes(without)) return;
      const round = outline(link.joints.map(p));
      round.forEach((a, k) => {
        const away = round.length > 1 ? distance(px, py, a, round[(k + 1) % round.length]) : Infinity;
        if (away < least) { best = { link: link.name }; least = away; }
      });
      if (!best && round.length > 2 && round.every((a, k) => {
        const b = round[(k + 1) % round.length];
        return (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]) >= 0;
      })) best = { link: link.name };
    });
    for (const drive of sketch.drives) if (!best && drive.kind === 'cylinder' && distance(px, py, p(drive.at[0]), p(drive.at[1])) < 9) best = { cylinder: drive.at.join(' ') };
    return best;
  }

  return { begin, resize, look, zoom, pan, draw, world, snap, gridStep, under, within, short, outline,
    screen: (x, y) => { const box = canvas.getBoundingClientRect(); return [box.left + X(x), box.top + Y(y)]; },
    get canvas() { return canvas; }, get eye() { return eye; } };
})();
