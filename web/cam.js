// The page of calm: cams turning with their followers and the linkage, and curves over the cam angle.
'use strict';

globalThis.calm = (() => {
  const FORMAT = 3;              // of the data, as in psalm_cam_page.f90
  const NOISE = 1e-12;           // part of a size that is rounding
  const ROUND = 2 * Math.PI;
  const SECONDS = 6;             // of a turn at speed 1
  const COLOURS = ['paper', 'ink', 'soft', 'line', 'panel', 'accent', 'actual', 'bad', 'badband', 'frame', 'ghost', 'good',
    'link0', 'link1', 'link2', 'link3', 'link4', 'link5', 'link6', 'link7'];
  const { short } = scales, { line } = panels;
  const data = JSON.parse(document.getElementById('data').textContent);
  const element = (id) => document.getElementById(id);
  const state = { angle: 0, playing: false, shown: 0, last: 0 };
  const slides = data.cams.some((cam) => cam.turn === 0); // then the rows go from one end to the other
  const pens = {};
  let view = null;               // scale and place of the machine
  let box = null;                // place of the curves

  // ---- data ------------------------------------------------------------------------------------------------------------

  /** A row at a cam angle between its frames; a number stands for a row that does not change. */
  function at(row, angle) {
    if (typeof row === 'number') return row;
    if (slides) {
      const place = Math.min(Math.max(angle, 0), 360) / 360 * (row.length - 1), i = Math.min(Math.floor(place), row.length - 2);
      return row[i] + (place - i) * (row[i + 1] - row[i]);
    }
    const step = 360 / row.length, place = ((angle % 360) + 360) % 360 / step;
    const i = Math.floor(place) % row.length, share = place - Math.floor(place);
    return row[i] + share * (row[(i + 1) % row.length] - row[i]);
  }

  const point = (cam, name, angle) => [at(cam[name + '_x'], angle), at(cam[name + '_y'], angle)];
  const entry = (row, i) => (typeof row === 'number' ? row : row[i]);
  /** A number to six digits; what is rounding beside a size is 0. */
  const rounded = (value, size) => short(Math.abs(value) < NOISE * size ? 0 : Number(value.toPrecision(6)));
  const lengthOf = (row) => (typeof row === 'number' ? 1 : row.length);
  const joint = (j, angle) => [at(data.joints[j].x, angle), at(data.joints[j].y, angle)];

  /** A point of a cam in machine axes. */
  function turned(cam, x, y, angle) {
    if (slides) return [cam.centre[0] + x + angle * cam.slide[0], cam.centre[1] + y + angle * cam.slide[1]];
    const a = cam.turn * angle * Math.PI / 180, c = Math.cos(a), s = Math.sin(a);
    return [cam.centre[0] + c * x - s * y, cam.centre[1] + s * x + c * y];
  }

  // ---- the machine -----------------------------------------------------------------------------------------------------

  const X = (x) => view.ox + view.k * x, Y = (y) => view.oy - view.k * y;

  function path(pen, points, closed) {
    pen.beginPath();
    points.forEach(([x, y], i) => (i ? pen.lineTo(X(x), Y(y)) : pen.moveTo(X(x), Y(y))));
    if (closed) pen.closePath();
  }

  function circle(pen, [x, y], pixels) {
    pen.beginPath();
    pen.arc(X(x), Y(y), Math.max(pixels, 0.5), 0, ROUND);
  }

  function outline(cam, name, angle) {
    const xs = cam[name + '_x'], ys = cam[name + '_y'], n = Math.max(lengthOf(xs), lengthOf(ys)), points = [];
    for (let i = 0; i < n; i += 1) points.push(turned(cam, entry(xs, i), entry(ys, i), angle));
    return points;
  }

  function drawCam(pen, cam, number) {
    const { angle } = state, colour = pens['link' + (number + 1) % 8];
    pen.lineJoin = 'round';
    if (cam.drives || cam.name.startsWith('conjugate')) {
      path(pen, outline(cam, 'profile', angle), true);
      pen.globalAlpha = 0.18;
      pen.fillStyle = colour;
      pen.fill();
      pen.globalAlpha = 1;
    } else path(pen, slides ? outline(cam, 'profile', angle).slice(0, -2) : outline(cam, 'profile', angle), !slides);
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.stroke();
    if (element('pitch').checked && !cam.flat) {
      path(pen, outline(cam, 'pitch', angle), !slides);
      pen.setLineDash([6, 4]);
      pen.strokeStyle = pens.ghost;
      pen.lineWidth = 1;
      pen.stroke();
      pen.setLineDash([]);
    }
    if (element('cutter').checked) {
      path(pen, outline(cam, 'cutter', angle), !slides);
      pen.strokeStyle = pens.good;
      pen.lineWidth = 1;
      pen.stroke();
    }
    if (slides) return;
    // a mark that turns with the cam, and the shaft
    const rim = turned(cam, entry(cam.profile_x, 0), entry(cam.profile_y, 0), angle);
    path(pen, [cam.centre, rim], false);
    pen.strokeStyle = colour;
    pen.lineWidth = 1;
    pen.stroke();
    circle(pen, cam.centre, 5);
    pen.fillStyle = pens.paper;
    pen.fill();
    pen.stroke();
    circle(pen, cam.centre, 1.5);
    pen.fillStyle = pens.ink;
    pen.fill();
  }

  function drawFollower(pen, cam) {
    const { angle } = state, c = point(cam, 'follower', angle), contact = point(cam, 'contact', angle);
    const normal = point(cam, 'normal', angle), steep = Math.abs(at(cam.alpha, angle)) > cam.limit;
    pen.strokeStyle = pens.ink;
    pen.lineWidth = 2;
    path(pen, [point(cam, 'arm', angle), c], false);
    pen.stroke();
    if (cam.flat) {
      const reach = 0.3 * (data.view[2] - data.view[0]);
      path(pen, [[contact[0] - reach * normal[1], contact[1] + reach * normal[0]],
        [contact[0] + reach * normal[1], contact[1] - reach * normal[0]]], false);
      pen.stroke();
      path(pen, [c, contact], false);
      pen.stroke();
    } else {
      circle(pen, c, Math.max(view.k * cam.roller, 2));
      pen.fillStyle = pens.paper;
      pen.fill();
      pen.stroke();
    }
    if (cam.second > 0) {
      path(pen, [point(cam, 'second_arm', angle), point(cam, 'second', angle)], false);
      pen.stroke();
      circle(pen, point(cam, 'second', angle), view.k * cam.second);
      pen.fillStyle = pens.paper;
      pen.fill();
      pen.stroke();
    }
    // the push of the cam
    const long = 46 / view.k;
    path(pen, [contact, [contact[0] + long * normal[0], contact[1] + long * normal[1]]], false);
    pen.strokeStyle = steep ? pens.bad : pens.actual;
    pen.lineWidth = 1.5;
    pen.stroke();
    circle(pen, contact, 3);
    pen.fillStyle = pen.strokeStyle;
    pen.fill();
  }

  function drawLinkage(pen) {
    const { angle } = state, colour = (body) => (body < 0 ? pens.ink : data.bodies[body].frame ? pens.frame : pens['link' + body % 8]);
    for (const rail of data.rails) {
      const [x, y] = joint(rail.from, angle), ux = at(rail.ux, angle), uy = at(rail.uy, angle);
      path(pen, [[x + rail.low * ux, y + rail.low * uy], [x + rail.high * ux, y + rail.high * uy]], false);
      pen.strokeStyle = pens.line;
      pen.lineWidth = 6;
      pen.stroke();
    }
    data.bodies.forEach((body, i) => {
      if (body.frame || body.hull.length < 3) return;
      path(pen, body.hull.map((j) => joint(j, angle)), true);
      pen.globalAlpha = 0.12;
      pen.fillStyle = colour(i);
      pen.fill();
      pen.globalAlpha = 1;
    });
    for (const [from, to, body, slide] of data.bars) {
      if (body >= 0 && data.bodies[body].frame) continue;
      path(pen, [joint(from, angle), joint(to, angle)], false);
      pen.strokeStyle = slide >= 0 ? pens.frame : colour(body);
      pen.lineWidth = slide >= 0 ? 1 : 3;
      pen.lineCap = 'round';
      pen.stroke();
    }
    data.joints.forEach((one, j) => {
      const p = joint(j, angle);
      if (one.fixed) {
        pen.beginPath();
        pen.moveTo(X(p[0]), Y(p[1]));
        pen.lineTo(X(p[0]) - 8, Y(p[1]) + 13);
        pen.lineTo(X(p[0]) + 8, Y(p[1]) + 13);
        pen.closePath();
        pen.strokeStyle = pens.frame;
        pen.lineWidth = 1.5;
        pen.stroke();
      }
      if (!one.name) return;
      circle(pen, p, 4);
      pen.fillStyle = pens.paper;
      pen.strokeStyle = pens.ink;
      pen.lineWidth = 1.5;
      pen.fill();
      pen.stroke();
    });
  }

  /** Names beside their joints, each in the first corner that is free of rollers, joints and other names. */
  function drawNames(pen) {
    const { angle } = state, high = 12, round = [], boxes = [];
    data.joints.forEach((one, j) => { if (one.name) round.push([...joint(j, angle), 4]); });
    for (const cam of data.cams) {
      if (!cam.flat) round.push([...point(cam, 'follower', angle), Math.max(view.k * cam.roller, 2)]);
      if (cam.second > 0) round.push([...point(cam, 'second', angle), view.k * cam.second]);
    }
    pen.fillStyle = pens.ink;
    pen.font = high + 'px system-ui, sans-serif';
    data.joints.forEach((one, j) => {
      if (!one.name) return;
      const [x, y] = joint(j, angle), wide = pen.measureText(one.name).width;
      const boxAt = ([dx, dy]) => { const l = X(x) + (dx > 0 ? dx : dx - wide), b = Y(y) + (dy > 0 ? dy + high : dy); return [l, b - high, l + wide, b]; };
      const free = ([l, t, r, b]) => boxes.every(([l2, t2, r2, b2]) => r < l2 || r2 < l || b < t2 || b2 < t) && round.every(([cx, cy, radius]) =>
        Math.hypot(X(cx) - Math.min(r, Math.max(l, X(cx))), Y(cy) - Math.min(b, Math.max(t, Y(cy)))) > radius);
      const corners = [7, 20].flatMap((far) => [[far, -far], [-far, -far], [far, far], [-far, far]]).map(boxAt), box = corners.find(free) || corners[0];
      boxes.push(box);
      pen.fillText(one.name, box[0], box[3]);
    });
  }

  function drawMachine() {
    const [w, h] = panels.fit(element('machine')), pen = element('machine').getContext('2d'), margin = 26, [x0, y0, x1, y1] = data.view;
    const k = Math.min((w - 2 * margin) / (x1 - x0), (h - 2 * margin) / (y1 - y0));
    view = { k, ox: w / 2 - k * (x0 + x1) / 2, oy: h / 2 + k * (y0 + y1) / 2 };
    pen.clearRect(0, 0, w, h);
    data.cams.forEach((cam, i) => drawCam(pen, cam, i));
    drawLinkage(pen);
    for (const cam of data.cams) if (cam.drives || cam.name.startsWith('conjugate')) drawFollower(pen, cam);
    drawNames(pen);
  }

  // ---- curves ----------------------------------------------------------------------------------------------------------

  /** Panels of a cam: the row of its data, its name with its unit. */
  function panelsOf(cam) {
    const [unit, rate] = cam.angular ? [', degrees', ', rad/rad'] : [', length', ', length/rad'];
    return [['y', 'output' + unit], ['y1', 'first derivative' + rate], ['y2', 'second derivative' + rate + '^2'],
      ['y3', 'third derivative' + rate + '^3'], ['alpha', 'pressure angle, degrees'], ['bend', 'curvature of the profile, 1/length']];
  }

  function drawCurves() {
    const canvas = element('curves'), [w, h] = panels.fit(canvas), pen = canvas.getContext('2d'), cam = data.cams[state.shown];
    const u = Math.min(2.2, Math.max(1, Math.min(w / 480, h / 560))), list = panelsOf(cam), each = (h - 34 * u) / list.length;
    box = { left: 58 * u, right: w - 18 * u };
    pen.clearRect(0, 0, w, h);
    pen.font = panels.font(u);
    const across = (angle) => box.left + (box.right - box.left) * angle / 360, room = box.right - box.left;
    list.forEach(([key, name], p) => {
      const row = cam[key], n = lengthOf(row), words = [[name, pens.ink], ['', pens.accent]];
      // the height is that of the longest number, so that nothing moves
      const top = p * each + 6 * u + panels.headHeight(pen, [words[0], ['-0.000000000', pens.accent]], room, u), bottom = (p + 1) * each - 8 * u;
      let low = Infinity, most = -Infinity;
      for (let i = 0; i < n; i += 1) { low = Math.min(low, entry(row, i)); most = Math.max(most, entry(row, i)); }
      words[1][0] = rounded(at(row, state.angle), Math.max(Math.abs(low), Math.abs(most)));
      const limits = key === 'alpha' ? [-cam.limit, cam.limit].filter((v) => v > low - cam.limit / 2 && v < most + cam.limit / 2) : [];
      const [least, upper] = scales.range(Math.min(low, ...limits), Math.max(most, ...limits), Math.max(Math.abs(low), Math.abs(most)));
      const up = (value) => bottom - (bottom - top) * (value - least) / (upper - least);
      panels.head(pen, words, box.left, top - 6 * u, room, u);
      panels.grid(pen, pens, box, scales.ticks(least, upper, Math.max(2, (bottom - top) / (27 * u)), key === 'alpha'), up, u);
      pen.setLineDash([5, 4]);
      pen.strokeStyle = pens.bad;
      for (const limit of limits) line(pen, box.left, up(limit), box.right, up(limit));
      pen.setLineDash([]);
      pen.strokeStyle = pens.accent;
      pen.lineWidth = 1.6 * u;
      pen.beginPath();
      for (let i = 0; i < n + (slides ? 0 : 1); i += 1) {
        const x = across(360 * i / (slides ? Math.max(n - 1, 1) : n)), y = up(entry(row, i % n));
        if (i) pen.lineTo(x, y); else pen.moveTo(x, y);
      }
      if (n === 1) pen.lineTo(across(360), up(entry(row, 0)));
      pen.stroke();
      pen.beginPath();
      pen.arc(across(state.angle), up(at(row, state.angle)), 3.6 * u, 0, ROUND);
      pen.fillStyle = pens.actual;
      pen.fill();
    });
    pen.strokeStyle = pens.ink;
    pen.lineWidth = u;
    line(pen, across(state.angle), 14 * u, across(state.angle), h - 34 * u);
    panels.axis(pen, pens, { ...box, bottom: h - 34 * u }, [0, 90, 180, 270, 360], across, 'cam angle, degrees', u);
  }

  function draw() {
    drawMachine();
    drawCurves();
    const cam = data.cams[state.shown];
    element('facts').textContent = 'cam angle ' + state.angle.toFixed(1) + '\u00b0, pressure angle ' +
      at(cam.alpha, state.angle).toFixed(1) + '\u00b0';
    if (document.activeElement !== element('angle')) element('angle').value = state.angle;
  }

  // ---- hands -----------------------------------------------------------------------------------------------------------

  function turnTo(angle) {
    state.angle = angle > 360 || angle < 0 ? ((angle % 360) + 360) % 360 : angle;
    draw();
  }

  function play(on) {
    state.playing = on;
    element('play').textContent = on ? 'Pause' : 'Play';
    element('play').setAttribute('aria-pressed', String(on));
    state.last = performance.now();
    if (on) requestAnimationFrame(step);
  }

  function step(now) {
    if (!state.playing) return;
    turnTo(state.angle + (now - state.last) / 1000 * 360 / SECONDS * Number(element('speed').value));
    state.last = now;
    requestAnimationFrame(step);
  }

  function drag(canvas, move) {
    let held = null;
    canvas.addEventListener('pointerdown', (event) => {
      play(false);
      held = move(event, null);
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointermove', (event) => { if (held !== null) held = move(event, held); });
    canvas.addEventListener('pointerup', () => { held = null; });
    canvas.addEventListener('pointercancel', () => { held = null; });
  }

  /** The pointer's angle about the first shaft, or its place along the slide; the cam moves with it. */
  function dragCam(event, held) {
    const cam = data.cams[state.shown];
    if (slides) {
      const [dx, dy] = cam.slide, place = (event.offsetX * dx - event.offsetY * dy) / view.k / (dx * dx + dy * dy);
      if (held !== null) turnTo(Math.min(360, Math.max(0, state.angle + place - held)));
      return place;
    }
    const now = Math.atan2(-(event.offsetY - Y(cam.centre[1])), event.offsetX - X(cam.centre[0])) * 180 / Math.PI;
    if (held !== null) turnTo(state.angle + cam.turn * (((now - held + 540) % 360) - 180));
    return now;
  }

  function dragCurve(event) {
    turnTo(Math.min(360, Math.max(0, 360 * (event.offsetX - box.left) / (box.right - box.left))));
    return 0;
  }

  function begin() {
    element('title').textContent = data.title;
    if (data.format !== FORMAT) {
      element('facts').textContent = 'data of another format';
      return;
    }
    const rows = element('extremes').tBodies[0];
    data.cams.forEach((cam, i) => {
      element('which').add(new Option(cam.name, String(i)));
      for (const [name, value, angle] of cam.facts) {
        const [said, unit] = name.endsWith('angle') ? [name, '\u00b0'] : [name + ', length', ''];
        const row = rows.insertRow();
        if (!cam.sound) row.className = 'bad';
        for (const words of [cam.name, said, rounded(value, data.view[2] - data.view[0]) + unit, angle.toFixed(2) + '\u00b0']) row.insertCell().textContent = words;
      }
    });
    element('chooser').hidden = data.cams.length < 2;
    element('which').addEventListener('change', () => { state.shown = Number(element('which').value); draw(); });
    element('play').addEventListener('click', () => play(!state.playing));
    element('angle').addEventListener('input', () => { play(false); turnTo(Number(element('angle').value)); });
    for (const id of ['pitch', 'cutter']) element(id).addEventListener('change', draw);
    drag(element('machine'), dragCam);
    drag(element('curves'), dragCurve);
    for (const id of ['machine', 'curves']) {
      element(id).addEventListener('keydown', (event) => {
        const by = { ArrowRight: 1, ArrowLeft: -1, PageUp: 10, PageDown: -10 }[event.key];
        if (by) turnTo(state.angle + by);
        else if (event.key === ' ') play(!state.playing);
        else return;
        event.preventDefault();
      });
    }
    const repaint = () => { panels.colours(COLOURS, pens); draw(); };
    window.addEventListener('resize', repaint);
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', repaint);
    repaint();
  }

  begin();
  return { data, state, at, point, turned, turnTo, play, outline };
})();
