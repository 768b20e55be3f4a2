// The linkage on its canvas: what stands still is drawn once, the rest in every frame.
'use strict';

balm.drawing = (() => {
  const { between, mixed, short, prepare, withOthers } = balm.scene;
  const COLOURS = ['paper', 'ink', 'soft', 'line', 'accent', 'actual', 'desired', 'bad', 'warn', 'badband', 'warnband',
    'frame', 'ghost', 'link0', 'link1', 'link2', 'link3', 'link4', 'link5', 'link6', 'link7'];
  const MANY = 60;               // joints above which symbols are smaller and letters left out
  const LONGEST = 90;            // pixels of the arrow of the largest load
  const HOLE = 52;               // radius of a hole with its pin, pixels
  const INSET = 68;              // half the side of a square for the polar diagram, or for the pin, pixels
  const CAPTION = 16;            // pixels of a line of words below a saved picture
  const ROUND = 2 * Math.PI;
  const LEAN = 1;                // pixels by which a slanted letter stands out of its width
  // about the joint, from where it is put at first, then further away: [turn, times as far]
  const LETTER_PLACES = [1, 1.8].flatMap((far) => [0, 1, -1, 2, -2, 3, -3, 4].map((n) => [n * ROUND / 8, far]));
  const FAR = 1000;              // pixels: a letter so far away is left out
  const pens = {};               // colours of the scheme
  let canvas, pen, still;        // `still` holds what does not move
  let view = null;               // scale and place of the drawing

  function begin() {
    canvas = document.getElementById('linkage');
    pen = canvas.getContext('2d');
    still = document.createElement('canvas');
  }

  const readColours = () => panels.colours(COLOURS, pens);

  /** How much larger than on a desk everything is drawn on a large screen. */
  const sizeOf = (across, down) => Math.min(2.2, Math.max(1, Math.min(across, down)));

  const X = (x) => view.ox + view.k * x, Y = (y) => view.oy - view.k * y;

  /** Colour of the link of a body. */
  const linkColour = (i) => pens['link' + i % 8];
  function colourOf(c, body) {
    if (c.ink) return c.ink;
    return body < 0 ? pens.link0 : c.bodies[body].frame ? pens.frame : linkColour(body);
  }

  /** Cases laid over the one shown, each in a colour of its own. */
  function shownOverlays() {
    const { state, cases } = balm;
    return [...state.overlays].filter((i) => i !== state.c && cases[i].sound).map((i) => {
      const o = prepare(cases[i]);
      o.ink = linkColour(i + 1);
      return o;
    });
  }

  /** Sizes, colours, everything that does not move. */
  function layOut(c) {
    const { state } = balm;
    readColours();
    c.ink = null;
    const [w, h] = panels.fit(canvas, still), overlays = shownOverlays();
    let box = c.view.slice();
    if (state.other) box = withOthers(c, box);
    for (const { view: v } of overlays)
      box = [Math.min(box[0], v[0]), Math.min(box[1], v[1]), Math.max(box[2], v[2]), Math.max(box[3], v[3])];
    const margin = Math.min(48, w / 10);
    view = { w, h, u: sizeOf(w / 740, h / 520), letters: [] };
    const [wide, high] = placeInsets(c, box, margin);
    const k = Math.min((wide - 2 * margin) / (box[2] - box[0]), (high - 2 * margin) / (box[3] - box[1]));
    Object.assign(view, { k, ox: wide / 2 - k * (box[0] + box[2]) / 2, oy: h - high / 2 + k * (box[1] + box[3]) / 2 });
    view.small = view.u * (c.joints.length > MANY ? 0.55 : 1);
    const g = still.getContext('2d');
    g.clearRect(0, 0, w, h);
    drawStill(g, c);
  }

  /** Polar diagram and pin in its hole stand beside the linkage: above it or at its right, where it stays larger. Gives the room
   *  that is left, at the lower left. */
  function placeInsets(c, box, margin) {
    const side = 2 * INSET * view.u, shown = { polar: c.forces && balm.state.forces, pin: c.clearance && balm.state.pin };
    const names = Object.keys(shown).filter((name) => shown[name]);
    if (!names.length) return [view.w, view.h];
    const scale = (w, h) => Math.min((w - 2 * margin) / (box[2] - box[0]), (h - 2 * margin) / (box[3] - box[1]));
    const above = scale(view.w, view.h - side) >= scale(view.w - side, view.h);
    names.forEach((name, i) => {
      view[name] = { x: view.w - side / 2 - (above ? i * side : 0), y: side / 2 + (above ? 0 : i * side) };
    });
    return above ? [view.w, view.h - side] : [view.w - side, view.h];
  }

  /** What is told about the picture in words, below it: [words, colour]; of a position. */
  function captions(c, t) {
    const list = [], at = between(c, t), newton = (value) => short(Number(value.toPrecision(4))) + ' N';
    if (c.forces && balm.state.forces) {
      const f = c.forces, bearing = f.joints[balm.state.bearing];
      if (f.largest > 0) list.push(['loads: ' + LONGEST + ' pixels are ' + newton(f.largest), pens.link2]);
      if (bearing) list.push(['force at ' + bearing.name + ' ' + newton(Math.hypot(mixed(bearing.fx, at), mixed(bearing.fy, at))) +
        ', peak ' + newton(bearing.peak), pens.accent]);
    }
    if (c.clearance && balm.state.pin) {
      const v = c.clearance, force = mixed(v.force, at);
      list.push([v.name + ': clearance ' + short(v.diametral) + ', load ' + newton(Math.hypot(mixed(v.fx, at), mixed(v.fy, at))), pens.ink]);
      list.push(force < 0 ? ['contact lost', pens.bad] : ['contact ' + newton(force), pens.ink]);
    }
    if (c.vibration && balm.state.bent) list.push(['bending drawn ' + short(c.vibration.factor) + ' times larger' +
      (c.vibration.settles ? '' : '; the motion is not stable'), pens.soft]);
    return list;
  }

  /** What does not move. */
  function drawStill(g, c) {
    const { state } = balm;
    drawRegions(g, c);
    if (c.meshes) drawReach(g, c.meshes);
    if (state.traces) for (const o of [c, ...shownOverlays()]) drawTraces(g, o, o === c ? 1 : 0.5);
    for (const j of state.paths) drawPathOf(g, c, j);
    if (c.proof) drawProof(g, c.proof);
    drawScale(g);
  }

  const MARKS = { opens: 'bad', extreme: 'actual', dead: 'warn' };

  /** What is proven: the tightest clearance of the motion, rings where the output is when something ends or stands still. */
  function drawProof(g, { marks, near }) {
    g.save();
    g.lineCap = 'round';
    for (const { links, way } of near.filter((one) => one.tightest)) {
      g.strokeStyle = pens.warn;
      g.globalAlpha = 0.3;
      for (const { width, ends } of links) {
        g.lineWidth = Math.max(view.k * width, 2 * view.u);
        segment(g, ...ends);
      }
      g.globalAlpha = 1;
      g.lineWidth = 1.6 * view.u;
      segment(g, ...way);
    }
    g.lineWidth = 1.6 * view.u;
    for (const { kind, output, at } of marks) {
      if (!output || !at.every(isFinite)) continue;
      g.strokeStyle = pens[MARKS[kind]];
      g.beginPath();
      g.arc(X(at[0]), Y(at[1]), 4.5 * view.u, 0, ROUND);
      g.stroke();
    }
    g.restore();
  }

  // ---- what stands still --------------------------------------------------------------------------------------------

  /** What the output reaches over a grid of strokes: the meshes cover each other, so all are outlined, then filled as one. */
  function drawReach(g, meshes) {
    g.beginPath();
    for (const m of meshes) {
      for (let i = 0; i < 8; i += 2) if (i) g.lineTo(X(m[i]), Y(m[i + 1])); else g.moveTo(X(m[0]), Y(m[1]));
      g.closePath();
    }
    g.lineJoin = 'round';
    g.strokeStyle = pens.link2;
    g.lineWidth = 3 * view.u;
    g.stroke();
    g.fillStyle = g.strokeStyle = pens.paper;
    g.lineWidth = 0.5;
    g.fill();
    g.stroke();
    g.fillStyle = g.strokeStyle = pens.link2;
    g.globalAlpha = 0.12;
    g.fill();
    g.globalAlpha = 0.35;
    g.stroke();
    g.globalAlpha = 1;
  }

  /** Where joints must not go is shaded, where they must stay is outlined. */
  function drawRegions(g, c) {
    g.save();
    g.strokeStyle = pens.bad;
    g.fillStyle = pens.badband;
    for (const region of c.regions) {
      g.beginPath();
      outline[region.kind](g, region);
      g.setLineDash(region.inside ? [5, 4] : []);
      if (!region.inside) g.fill();
      g.stroke();
    }
    g.restore();
  }

  const outline = {
    box: (g, { at }) => g.rect(X(at[0]), Y(at[3]), view.k * (at[2] - at[0]), view.k * (at[3] - at[1])),
    circle: (g, { at }) => g.arc(X(at[0]), Y(at[1]), view.k * at[2], 0, ROUND),
    'half-plane'(g, { inside, at }) {
      const direction = at[2] * Math.PI / 180, far = 4 * (view.w + view.h), side = inside ? -12 : 12;
      const ux = Math.cos(direction), uy = -Math.sin(direction), x = X(at[0]), y = Y(at[1]);
      g.moveTo(x - far * ux, y - far * uy);
      g.lineTo(x + far * ux, y + far * uy);
      g.lineTo(x + far * ux + side * uy, y + far * uy - side * ux);
      g.lineTo(x - far * ux + side * uy, y - far * uy - side * ux);
      g.closePath();
    },
  };

  /** Moving joints and output at the prescribed positions, desired values, path of the output. */
  function drawTraces(g, c, alpha) {
    g.save();
    g.globalAlpha = alpha;
    if (!c.meshes) drawPlaces(g, c);
    if (c.meshes) { g.restore(); return; }   // the way through a grid is no path
    if (c.motion !== 'angle' && c.motion !== 'slide') drawPath(g, c);
    if (c.motion === 'angle') drawDirections(g, c, alpha); else if (c.motion !== 'number') drawMarks(g, c);
    if (c.motion === 'distance') {
      g.strokeStyle = pens.ink;
      g.lineWidth = 1.2 * view.u;
      cross(g, X(0), Y(0));
    }
    g.restore();
  }

  function drawPlaces(g, c) {
    const p = c.prescribed, size = 2.4 * view.u;
    g.fillStyle = pens.soft;
    c.joints.forEach((joint, j) => {
      if (joint.fixed || !joint.name) return;
      for (let i = 0; i < p.n; i++) {
        const x = mixed(p.x[j], [i, i, 0]), y = mixed(p.y[j], [i, i, 0]);
        if (isFinite(x)) g.fillRect(X(x) - size / 2, Y(y) - size / 2, size, size);
      }
    });
  }

  function drawPath(g, c) {
    g.strokeStyle = c.ink || pens.actual;
    g.lineWidth = 1.2 * view.u;
    drawWay(g, c, c.output);
  }

  /** The path of a joint that was chosen, with its name where the path is highest. */
  function drawPathOf(g, c, j) {
    const s = c.sweep;
    g.strokeStyle = g.fillStyle = linkColour(j);
    g.lineWidth = 1.6 * view.u;
    drawWay(g, c, j);
    let top = -1;
    for (let i = 0; i < s.n; i++)
      if (isFinite(mixed(s.y[j], [i, i, 0])) && (top < 0 || mixed(s.y[j], [i, i, 0]) > mixed(s.y[j], [top, top, 0]))) top = i;
    if (top < 0) return;
    g.font = 'italic ' + 12 * view.u + 'px system-ui, sans-serif';
    g.textAlign = 'center';
    g.fillText(c.joints[j].name, X(mixed(s.x[j], [top, top, 0])), Y(mixed(s.y[j], [top, top, 0])) - 6 * view.u);
    g.textAlign = 'left';
  }

  function drawWay(g, c, j) {
    const s = c.sweep;
    g.beginPath();
    let down = false;
    for (let i = 0; i <= (c.ring ? s.n : s.n - 1); i++) {
      const at = [i % s.n, i % s.n, 0], x = mixed(s.x[j], at), y = mixed(s.y[j], at);
      if (!isFinite(x)) { down = false; continue; }
      if (down) g.lineTo(X(x), Y(y)); else g.moveTo(X(x), Y(y));
      down = true;
    }
    g.stroke();
  }

  /** Output of the kind angle: lines along the actual and the desired direction. */
  function drawDirections(g, c, alpha) {
    const p = c.prescribed;
    g.globalAlpha = alpha * Math.max(0.01, Math.min(1, 80 / p.n));   // many lines must not become a blot
    g.lineWidth = 0.8 * view.u;
    for (let i = 0; i < p.n; i++) {
      if (p.closed[i] === '0') continue;
      const x = mixed(p.x[c.base], [i, i, 0]), y = mixed(p.y[c.base], [i, i, 0]);
      g.strokeStyle = pens.actual;
      segment(g, x, y, p.actual_mark_x[i], p.actual_mark_y[i]);
      if (!c.desired) continue;
      g.setLineDash([5, 4]);
      g.strokeStyle = pens.desired;
      segment(g, x, y, p.desired_mark_x[i], p.desired_mark_y[i]);
      g.setLineDash([]);
    }
    g.globalAlpha = alpha;
  }

  /** Other outputs: stars at the actual places, diamonds at the desired ones. */
  function drawMarks(g, c) {
    const p = c.prescribed, x = p.x[c.output], y = p.y[c.output];
    for (let i = 0; i < p.n; i++) {
      const closed = p.closed[i] === '1', at = [i, i, 0];
      if (closed) star(g, X(mixed(x, at)), Y(mixed(y, at)), 4.5 * view.u, c.ink || pens.actual);
      if (c.desired && (closed || c.motion === 'point')) diamond(g, X(p.desired_mark_x[i]), Y(p.desired_mark_y[i]));
    }
  }

  function line(g, x1, y1, x2, y2) {
    g.beginPath();
    g.moveTo(x1, y1);
    g.lineTo(x2, y2);
    g.stroke();
  }

  const segment = (g, x1, y1, x2, y2) => line(g, X(x1), Y(y1), X(x2), Y(y2));

  function cross(g, x, y) {
    const r = 8 * view.u;
    line(g, x - r, y, x + r, y);
    line(g, x, y - r, x, y + r);
  }

  function diamond(g, x, y) {
    const r = 6 * view.u;
    g.strokeStyle = pens.desired;
    g.lineWidth = 1.3 * view.u;
    g.beginPath();
    g.moveTo(x, y - r);
    g.lineTo(x + r * 5 / 6, y);
    g.lineTo(x, y + r);
    g.lineTo(x - r * 5 / 6, y);
    g.closePath();
    g.stroke();
  }

  function star(g, x, y, r, colour) {
    g.fillStyle = colour;
    g.beginPath();
    for (let i = 0; i < 10; i++) {
      const a = -Math.PI / 2 + i * Math.PI / 5, d = i % 2 ? r * 0.382 : r;
      g.lineTo(x + d * Math.cos(a), y + d * Math.sin(a));
    }
    g.fill();
  }

  /** A bar of a round length, about a sixth of the width. */
  function drawScale(g) {
    let length = view.w / 6 / view.k;
    const power = 10 ** Math.floor(Math.log10(length)), y = view.h - 12;
    length = power * (length >= 5 * power ? 5 : length >= 2 * power ? 2 : 1);
    const end = 12 + view.k * length;
    g.strokeStyle = g.fillStyle = pens.soft;
    g.lineWidth = 1.5 * view.u;
    g.font = 12 * view.u + 'px system-ui, sans-serif';
    g.beginPath();
    g.moveTo(12, y - 6);
    g.lineTo(12, y);
    g.lineTo(end, y);
    g.lineTo(end, y - 6);
    g.stroke();
    g.fillText(short(length), end + 6, y);
  }

  // ---- what moves ---------------------------------------------------------------------------------------------------

  /** The linkage at the place t of its sweep, under it the cases laid over it. */
  function frame(c, t) {
    pen.clearRect(0, 0, view.w, view.h);
    pen.drawImage(still, 0, 0, view.w, view.h);
    drawMoving(c, t);
  }

  /** The whole picture at the place t on another pen: a file, a film; paper below it. */
  function picture(c, t, g) {
    const own = pen;
    pen = g;
    g.fillStyle = pens.paper;
    g.fillRect(0, 0, view.w, view.h + captionRoom(c, t));
    drawStill(g, c);
    drawMoving(c, t);
    g.font = panels.font(view.u);
    captions(c, t).forEach(([words, colour], i) => {
      g.fillStyle = colour;
      g.fillText(words, 12, view.h + CAPTION * view.u * (i + 0.7));
    });
    pen = own;
  }

  /** Height of the captions below the linkage. */
  const captionRoom = (c, t) => CAPTION * view.u * captions(c, t).length;

  function drawMoving(c, t) {
    const part = (t - c.ends[0]) / Math.max(1e-9, c.ends[1] - c.ends[0]);
    for (const o of shownOverlays()) {
      pen.globalAlpha = 0.6;
      drawLinkage(o, o.ends[0] + part * (o.ends[1] - o.ends[0]), false);
      pen.globalAlpha = 1;
    }
    drawLinkage(c, t, true);
  }

  /** One linkage; `main` is false for a case laid over the one shown. */
  function drawLinkage(c, t, main) {
    const s = c.sweep, at = between(c, t), px = c.px, py = c.py;
    for (let j = 0; j < px.length; j++) {
      px[j] = X(mixed(s.x[j], at));
      py[j] = Y(mixed(s.y[j], at));
    }
    pen.lineJoin = pen.lineCap = 'round';
    if (c.ghosts && main) drawEquilibria(c);
    drawRails(c, at);
    if (c.proof && main) drawWide(c);
    drawPlates(c);
    if (balm.state.other && main) drawOthers(c, at);
    if (c.wheels) drawWheels(c);
    drawBars(c, at, main);
    if (main) drawBroken(c, at[0]);
    drawJoints(c, at, main);
    drawOutput(c, at);
    if (c.forces && main && balm.state.forces) {
      drawWeights(c.forces, at);
      drawForces(c.forces, at);
    }
    if (c.clearance && main && balm.state.pin) drawPin(c, at);
  }

  /** Links that are segments with a width. */
  function drawWide(c) {
    pen.strokeStyle = pens.frame;
    pen.globalAlpha = 0.28;
    for (const { from, to, width } of c.proof.wide) {
      if (!(width > 0) || ![c.px[from], c.py[from], c.px[to], c.py[to]].every(isFinite)) continue;
      pen.lineWidth = view.k * width;
      line(pen, c.px[from], c.py[from], c.px[to], c.py[to]);
    }
    pen.globalAlpha = 1;
  }

  /** Counterweights as discs to scale, springs between their ends. */
  function drawWeights(f, at) {
    const g = pen, u = view.u;
    g.save();
    g.strokeStyle = g.fillStyle = pens.frame;
    g.lineWidth = 1.2 * u;
    for (const one of f.weights) {
      const x = X(mixed(one.x, at)), y = Y(mixed(one.y, at));
      if (!isFinite(x)) continue;
      g.beginPath();
      g.arc(x, y, view.k * one.radius, 0, ROUND);
      g.globalAlpha = 0.3;
      g.fill();
      g.globalAlpha = 1;
      g.stroke();
    }
    g.strokeStyle = pens.warn;
    g.lineWidth = 1.6 * u;
    for (const one of f.springs) {
      const ends = [X(mixed(one.x, at)), Y(mixed(one.y, at)), X(mixed(one.x2, at)), Y(mixed(one.y2, at))];
      if (!ends.every(isFinite)) continue;
      g.beginPath();
      for (const [x, y] of one.torsional ? balm.scene.spiral(ends[0], ends[1], 9 * u) : balm.scene.coil(...ends, 6 * u)) g.lineTo(x, y);
      g.stroke();
      if (one.torsional) continue;
      drawSpringEnd(g, ends[0], ends[1], one.frame[0], X(mixed(one.footx, at)), Y(mixed(one.footy, at)));
      drawSpringEnd(g, ends[2], ends[3], one.frame[1], X(mixed(one.footx2, at)), Y(mixed(one.footy2, at)));
    }
    g.restore();
  }

  /** The pin of a spring: on the frame with a triangle below it, else with a thin line to the link that holds it. */
  function drawSpringEnd(g, x, y, frame, footx, footy) {
    const r = 2.6 * view.u, width = g.lineWidth;
    g.beginPath();
    if (frame) {
      g.moveTo(x, y);
      g.lineTo(x - 2 * r, y + 3.5 * r);
      g.lineTo(x + 2 * r, y + 3.5 * r);
      g.closePath();
    } else {
      g.lineWidth = 0.5 * width;
      g.moveTo(footx, footy);
      g.lineTo(x, y);
    }
    g.stroke();
    g.lineWidth = width;
    g.fillStyle = pens.paper;
    g.beginPath();
    g.arc(x, y, r, 0, ROUND);
    g.fill();
    g.stroke();
  }

  /** Centres of mass, loads as arrows, and the polar diagram of one bearing beside the linkage. */
  function drawForces(f, at) {
    const g = pen, u = view.u, r = 5.5 * u;
    for (const one of f.centres) {
      const x = X(mixed(one.x, at)), y = Y(mixed(one.y, at));
      if (!isFinite(x)) continue;
      g.fillStyle = pens.paper;
      g.strokeStyle = pens.ink;
      g.lineWidth = 1.2 * u;
      g.beginPath();
      g.arc(x, y, r, 0, ROUND);
      g.fill();
      g.stroke();
      g.fillStyle = pens.ink;
      for (const from of [0, Math.PI]) {
        g.beginPath();
        g.moveTo(x, y);
        g.arc(x, y, r, from, from + Math.PI / 2);
        g.fill();
      }
    }
    g.strokeStyle = g.fillStyle = pens.link2;
    for (const one of f.loads) arrow(g, one, at, f.largest);
    const bearing = f.joints[balm.state.bearing];
    if (bearing) drawPolar(g, bearing, at);
  }

  function arrow(g, one, at, largest) {
    const u = view.u, x = X(mixed(one.x, at)), y = Y(mixed(one.y, at)), scale = LONGEST * u / (largest || 1);
    const dx = scale * mixed(one.fx, at), dy = -scale * mixed(one.fy, at), length = Math.hypot(dx, dy);
    if (!(length > 1)) return;
    const head = Math.min(9 * u, 0.6 * length) / length;
    g.lineWidth = 2.2 * u;
    line(g, x, y, x + dx, y + dy);
    g.beginPath();
    g.moveTo(x + dx - head * (dx - 0.4 * dy), y + dy - head * (dy + 0.4 * dx));
    g.lineTo(x + dx, y + dy);
    g.lineTo(x + dx - head * (dx + 0.4 * dy), y + dy - head * (dy - 0.4 * dx));
    g.stroke();
  }

  /** Force on the later link of a joint over the sweep, machine axes, with a dot where it is now. */
  function drawPolar(g, bearing, at) {
    const u = view.u, r = 58 * u, { x, y } = view.polar, scale = r / (bearing.peak || 1);
    g.strokeStyle = pens.line;
    g.lineWidth = u;
    line(g, x - r, y, x + r, y);
    line(g, x, y - r, x, y + r);
    g.strokeStyle = pens.accent;
    g.lineWidth = 1.4 * u;
    g.beginPath();
    let down = false;
    bearing.fx.forEach((v, i) => {
      if (!isFinite(v)) { down = false; return; }
      const px = x + scale * v, py = y - scale * bearing.fy[i];
      if (down) g.lineTo(px, py); else g.moveTo(px, py);
      down = true;
    });
    g.stroke();
    const fx = mixed(bearing.fx, at), fy = mixed(bearing.fy, at);
    g.fillStyle = pens.actual;
    if (isFinite(fx)) {
      g.beginPath();
      g.arc(x + scale * fx, y - scale * fy, 3.4 * u, 0, ROUND);
      g.fill();
    }
  }

  /** The pin in its hole, magnified: load without clearance, force of contact, and where the joint is. */
  function drawPin(c, at) {
    const g = pen, v = c.clearance, u = view.u, hole = HOLE * u, play = hole / 4, { x, y } = view.pin;
    const px = mixed(v.px, at), py = mixed(v.py, at), size = Math.hypot(px, py) || 1, ux = px / size, uy = -py / size;
    const fx = mixed(v.fx, at), fy = mixed(v.fy, at), force = mixed(v.force, at);
    const most = v.fx.reduce((top, f, i) => Math.max(top, Math.hypot(f, v.fy[i]) || 0), 0) || 1;
    g.lineWidth = 1.2 * u;
    if (v.joint >= 0 && isFinite(c.px[v.joint])) {
      g.strokeStyle = pens.line;
      line(g, c.px[v.joint], c.py[v.joint], x, y);
      g.beginPath();
      g.arc(c.px[v.joint], c.py[v.joint], 9 * u, 0, ROUND);
      g.stroke();
    }
    g.fillStyle = pens.paper;
    g.strokeStyle = pens.frame;
    g.beginPath();
    g.arc(x, y, hole + 9 * u, 0, ROUND);
    g.fill();
    g.stroke();
    g.strokeStyle = pens.ink;
    g.lineWidth = 2.2 * u;
    g.beginPath();
    g.arc(x, y, hole, 0, ROUND);
    g.stroke();
    g.fillStyle = force < 0 ? pens.badband : pens.warnband;
    g.strokeStyle = force < 0 ? pens.bad : pens.frame;
    g.beginPath();
    g.arc(x + play * ux, y + play * uy, hole - play, 0, ROUND);
    g.fill();
    g.stroke();
    // the circle that the centre of the pin runs on, and where it is
    g.lineWidth = u;
    g.strokeStyle = pens.line;
    g.beginPath();
    g.arc(x, y, play, 0, ROUND);
    g.stroke();
    g.fillStyle = pens.ink;
    g.beginPath();
    g.arc(x + play * ux, y + play * uy, 2.4 * u, 0, ROUND);
    g.fill();
    const reach = hole - play - 4 * u;
    g.strokeStyle = pens.accent;
    vector(g, x, y, reach * fx / most, -reach * fy / most);
    g.strokeStyle = pens.actual;
    if (force > 0) vector(g, x + hole * ux, y + hole * uy, Math.min(1.2, force / most) * reach * ux, Math.min(1.2, force / most) * reach * uy);
  }

  /** An arrow in pixels. */
  function vector(g, x, y, dx, dy) {
    const length = Math.hypot(dx, dy);
    if (!(length > 1)) return;
    const head = Math.min(7 * view.u, 0.6 * length) / length;
    g.lineWidth = 2 * view.u;
    line(g, x, y, x + dx, y + dy);
    g.beginPath();
    g.moveTo(x + dx - head * (dx - 0.4 * dy), y + dy - head * (dy + 0.4 * dx));
    g.lineTo(x + dx, y + dy);
    g.lineTo(x + dx - head * (dx + 0.4 * dy), y + dy - head * (dy - 0.4 * dx));
    g.stroke();
  }

  function drawRails(c, at) {
    const s = c.sweep, px = c.px, py = c.py;
    pen.strokeStyle = pens.frame;
    pen.lineWidth = 1.2 * view.u;
    c.slides.forEach((slide, i) => {
      const x = px[slide.guide], y = py[slide.guide];
      if (!(isFinite(x) && isFinite(px[slide.block]))) return;
      const ux = slide.sense * view.k * mixed(s.ux[i], at), uy = -slide.sense * view.k * mixed(s.uy[i], at);
      line(pen, x + slide.low * ux, y + slide.low * uy, x + slide.high * ux, y + slide.high * uy);
    });
  }

  function drawPlates(c) {
    const g = pen, alpha = g.globalAlpha;
    c.bodies.forEach((body, b) => {
      if (!body.hull.length || body.frame || !body.hull.every((j) => isFinite(c.px[j]))) return;
      g.globalAlpha = 0.16 * alpha;
      g.fillStyle = colourOf(c, b);
      g.beginPath();
      for (const j of body.hull) g.lineTo(c.px[j], c.py[j]);
      g.closePath();
      g.fill();
      g.globalAlpha = alpha;
      g.strokeStyle = g.fillStyle;
      g.lineWidth = 1.3 * view.small;
      g.stroke();
    });
  }

  /** Equilibria in grey, dashed where they are not stable, with their numbers. */
  function drawEquilibria(c) {
    const g = pen, high = 14 * view.u;
    g.strokeStyle = pens.ghost;
    g.lineWidth = 1.8 * view.u;
    g.font = 'italic ' + high + 'px system-ui, "DejaVu Sans", sans-serif';
    g.fillStyle = pens.soft;
    for (const one of c.ghosts) {
      g.setLineDash(one.stable ? [] : [4, 4]);
      for (const bar of c.bars) {
        const ends = [one.x[bar.from], one.y[bar.from], one.x[bar.to], one.y[bar.to]];
        if (bar.from === bar.to || (bar.body >= 0 && c.bodies[bar.body].frame) || ends.includes(null)) continue;
        g.beginPath();
        g.moveTo(X(ends[0]), Y(ends[1]));
        g.lineTo(X(ends[2]), Y(ends[3]));
        g.stroke();
      }
      const j = c.joints.findIndex((joint, i) => !joint.fixed && one.x[i] !== null);
      if (j >= 0) g.fillText(one.name, X(one.x[j]) + 7 * view.u, Y(one.y[j]) - 7 * view.u);
    }
    g.setLineDash([]);
  }

  /** The other assembly of each pair that has one, in grey. */
  function drawOthers(c, at) {
    const g = pen, px = c.px, py = c.py;
    g.strokeStyle = pens.ghost;
    g.lineWidth = 1.8 * view.u;
    g.setLineDash([2, 4]);
    for (const other of c.sweep.others) {
      const { start, finish } = c.pairs[other.pair], x = mixed(other.x, at);
      if (!isFinite(x)) continue;
      g.beginPath();
      g.moveTo(px[start], py[start]);
      g.lineTo(X(x), Y(mixed(other.y, at)));
      g.lineTo(px[finish], py[finish]);
      g.stroke();
    }
    g.setLineDash([]);
  }

  function drawBars(c, at, main) {
    const g = pen, px = c.px, py = c.py, thin = (c.joints.length > MANY ? 0.7 : 1) * view.u;
    for (const bar of c.bars) {
      if (bar.from === bar.to || !isFinite(px[bar.from]) || !isFinite(px[bar.to])) continue;
      const fixed = bar.body >= 0 && c.bodies[bar.body].frame;
      g.strokeStyle = colourOf(c, bar.body);
      g.lineWidth = (bar === balm.state.hover && main ? 5 : fixed ? 1.4 : 2.8) * thin;
      if (fixed) g.setLineDash([6, 5]);
      if (main && isBent(c, bar)) drawBent(c, at);
      else line(g, px[bar.from], py[bar.from], px[bar.to], py[bar.to]);
      if (fixed) g.setLineDash([]);
      if ('barrel' in bar) drawBarrel(c, bar);
    }
  }

  /** Is it the link that vibrates, and to be drawn so? */
  function isBent(c, bar) {
    const v = c.vibration;
    return v && balm.state.bent && Math.min(v.from, v.to) === Math.min(bar.from, bar.to) &&
      Math.max(v.from, v.to) === Math.max(bar.from, bar.to);
  }

  /** The vibrating link, its deflection drawn larger; the straight one beside it, thin. */
  function drawBent(c, at) {
    const v = c.vibration, g = pen, x = c.px[v.from], y = c.py[v.from], dx = c.px[v.to] - x, dy = c.py[v.to] - y;
    const length = Math.hypot(dx, dy), steps = 40, q = v.modes.map((values) => view.k * v.factor * mixed(values, at) / length);
    const width = g.lineWidth;
    g.lineWidth = 0.8 * view.u;
    g.setLineDash([4, 4]);
    line(g, x, y, x + dx, y + dy);
    g.setLineDash([]);
    g.lineWidth = width;
    g.beginPath();
    for (let i = 0; i <= steps; i++) {
      // to the left of the link; pixels count downwards
      const f = i / steps, bow = q.reduce((sum, one, j) => sum + one * Math.sin((j + 1) * Math.PI * f), 0);
      g.lineTo(x + f * dx + bow * dy, y + f * dy - bow * dx);
    }
    g.stroke();
  }

  /** Pitch circles of gear wheels, with a line that turns with each. */
  function drawWheels(c) {
    for (const wheel of c.wheels) {
      const x = c.px[wheel.centre], y = c.py[wheel.centre];
      if (!isFinite(x)) continue;
      pen.strokeStyle = colourOf(c, wheel.body);
      pen.lineWidth = 1.4 * view.u;
      pen.beginPath();
      pen.arc(x, y, view.k * wheel.radius, 0, ROUND);
      pen.stroke();
      line(pen, x, y, c.px[wheel.rim], c.py[wheel.rim]);
    }
  }

  /** The thick part of a cylinder. */
  function drawBarrel(c, bar) {
    const x = c.px[bar.from], y = c.py[bar.from], dx = c.px[bar.to] - x, dy = c.py[bar.to] - y;
    const part = view.k * bar.barrel / (Math.hypot(dx, dy) || 1);
    pen.lineCap = 'butt';
    pen.lineWidth = 8 * view.u;
    pen.globalAlpha *= 0.55;
    line(pen, x, y, x + part * dx, y + part * dy);
    pen.globalAlpha /= 0.55;
    pen.lineCap = 'round';
  }

  /** Pairs that do not meet: both arcs as far as they reach, dots between them. */
  function drawBroken(c, i) {
    const g = pen, px = c.px, py = c.py;
    for (const [loop, tip] of c.broken.get(i) || []) {
      const { start, finish } = c.pairs[loop];
      g.strokeStyle = pens.bad;
      g.lineWidth = 3 * view.u;
      line(g, px[start], py[start], X(tip[0]), Y(tip[1]));
      line(g, px[finish], py[finish], X(tip[2]), Y(tip[3]));
      g.lineWidth = 1.3 * view.u;
      g.setLineDash([3, 4]);
      segment(g, ...tip);
      g.setLineDash([]);
    }
  }

  /** The star, and with an output angle without an output arc a line in its direction. */
  function drawOutput(c, at) {
    let x = c.px[c.output], y = c.py[c.output];
    if (c.motion === 'angle' && c.output === c.base && c.sweep.closed[at[0]] === '1') {
      const ax = X(mixed(c.sweep.actual_mark_x, at)), ay = Y(mixed(c.sweep.actual_mark_y, at));
      pen.strokeStyle = pens.actual;
      pen.lineWidth = 2.2 * view.u;
      line(pen, x, y, ax, ay);
      [x, y] = [ax, ay];
    }
    // on a block the symbol stays visible
    if (isFinite(x)) star(pen, x, y, (c.motion === 'slide' ? 5 : 9) * view.u, pens.actual);
  }

  /** Circles, triangles, pairs of triangles; letters of the case in front. */
  function drawJoints(c, at, main) {
    const s = c.sweep, g = pen, px = c.px, py = c.py, m = view.small;
    g.lineWidth = 1.6 * m;
    g.strokeStyle = pens.ink;
    g.fillStyle = pens.paper;
    g.beginPath();
    c.joints.forEach((joint, j) => {
      if (!joint.turning || !joint.fixed || !isFinite(px[j])) return;
      g.moveTo(px[j], py[j]);
      g.lineTo(px[j] - 9 * m, py[j] + 15 * m);
      g.lineTo(px[j] + 9 * m, py[j] + 15 * m);
      g.closePath();
    });
    c.slides.forEach((slide, i) => {
      const x = px[slide.block], y = py[slide.block], r = 9 * m;
      if (!isFinite(x)) return;
      const ux = mixed(s.ux[i], at), uy = -mixed(s.uy[i], at);
      for (const side of [1, -1]) {
        g.moveTo(x, y);
        g.lineTo(x + r * (ux - side * uy), y + r * (uy + side * ux));
        g.lineTo(x + r * (-ux - side * uy), y + r * (-uy + side * ux));
        g.closePath();
      }
    });
    g.fill();
    g.stroke();
    g.beginPath();
    c.joints.forEach((joint, j) => {
      if (!joint.turning || !isFinite(px[j])) return;
      g.moveTo(px[j] + 4.6 * m, py[j]);
      g.arc(px[j], py[j], 4.6 * m, 0, ROUND);
    });
    g.fill();
    g.stroke();
    if (balm.state.letters && main && c.joints.length <= MANY) drawLetters(c);
  }

  /** Letters beside their joints. One that would lie on another one or on a joint goes round its joint to the first free place, and
   *  stays there while that is free. */
  function drawLetters(c) {
    const high = 14 * view.u, boxes = [], g = pen;
    g.font = 'italic ' + high + 'px system-ui, "DejaVu Sans", sans-serif';
    g.fillStyle = pens.ink;
    g.textAlign = 'center';
    const free = ([x, y, half], own) => boxes.every(([bx, by, other]) => Math.abs(x - bx) > half + other || Math.abs(y - by) > high) &&
      c.joints.every((joint, j) => j === own || !joint.turning || !(Math.abs(x - c.px[j]) < half + 4 * view.small && Math.abs(y - 5 * view.u - c.py[j]) < 10 * view.u));
    c.joints.forEach((joint, j) => {
      if (!joint.name || !isFinite(c.px[j]) || Math.abs(joint.letter[0]) > FAR) return;
      const half = LEAN * view.u + (g.measureText ? g.measureText(joint.name).width / 2 : 0.3 * high * joint.name.length), [dx, dy] = joint.letter;
      const boxAt = ([turn, far]) => [c.px[j] + view.u * far * (Math.cos(turn) * dx - Math.sin(turn) * dy),
        c.py[j] + view.u * (far * (Math.sin(turn) * dx + Math.cos(turn) * dy) + 5), half];
      const tried = [view.letters[j] || LETTER_PLACES[0], ...LETTER_PLACES], place = tried.find((one) => free(boxAt(one), j)) ?? tried[0], box = boxAt(place);
      view.letters[j] = place;
      boxes.push(box);
      g.fillText(joint.name, box[0], box[1]);
    });
    g.textAlign = 'left';
  }

  // ---- where things are ---------------------------------------------------------------------------------------------

  /** The bar nearest to a point of the canvas, or null if none is near. */
  function nearest(c, x, y) {
    let best = null, least = 10 * view.u;
    for (const bar of c.bars) {
      const ax = c.px[bar.from], ay = c.py[bar.from], dx = c.px[bar.to] - ax, dy = c.py[bar.to] - ay;
      const d = dx * dx + dy * dy;
      if (!(d > 0)) continue;
      const f = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / d));
      const away = Math.hypot(x - ax - f * dx, y - ay - f * dy);
      if (away < least) { least = away; best = bar; }
    }
    return best;
  }

  /** A place of the canvas in machine axes. */
  const machine = (x, y) => [(x - view.ox) / view.k, (view.oy - y) / view.k];

  return { pens, begin, readColours, sizeOf, linkColour, layOut, frame, picture, captions, nearest, machine,
    sizeAt: (c, t) => [view.w, view.h + captionRoom(c, t)],
    get canvas() { return canvas; }, get pen() { return pen; }, get scale() { return view.k; } };
})();
