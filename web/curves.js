// The curves against the input, with a cursor: output, error, transmission angles, rates, tolerances, forces; the strip above
// the time line.
'use strict';

balm.curves = (() => {
  const { OPEN, between, mixed, modulo, inputAt, inputName, short } = balm.scene;
  const { ticks, range } = scales, { fit, line } = panels;
  const MOST = 6;           // panels of outputs; CASE.csv has all
  const ROOM = 7;           // so many panels are shown at once unasked
  const OUTPUT = { angle: 'angle', distance: 'distance', slide: 'place of the slide' };
  const ROUND = 2 * Math.PI;
  let canvas, chart, still, strip;
  let plot = null;          // place of the panels

  function begin() {
    canvas = document.getElementById('curves');
    chart = canvas.getContext('2d');
    still = document.createElement('canvas');
    strip = document.getElementById('strip');
  }

  /** Least and greatest of all values of a panel that are seen from `from` to `to`. */
  function extent(panel, from, to) {
    let low = Infinity, high = -Infinity;
    const see = (t, v) => {
      if (!isFinite(v) || t < from - 1e-6 || t > to + 1e-6) return;
      low = Math.min(low, v);
      high = Math.max(high, v);
    };
    for (const one of panel.lines) one.values.forEach((v, i) => see(i, v));
    for (const one of panel.points) for (const [t, v] of one.marks) see(t, v);
    return panel.zero ? [Math.min(low, 0), Math.max(high, 0)] : [low, high];
  }

  // ---- panels -------------------------------------------------------------------------------------------------------

  const GROUPS = { position: 'output', tolerance: 'tolerances', rates: 'velocity, acceleration', forces: 'forces',
    energy: 'energy', vibration: 'vibration', contact: 'contact' };

  /** What the panels show: lines over the sweep, points at the prescribed positions; each belongs to a group. */
  function allPanels(c) {
    const { pens, linkColour } = balm.drawing, s = c.sweep, p = c.prescribed, list = [];
    const size = c.motion === 'angle' ? 360 : c.size, called = c.outputLabel || 'the output';
    const unit = c.motion === 'number' ? '' : c.motion === 'angle' ? ', degrees' : ', length';
    // the curves of a whole turn end where they begin; an angle that has turned ends whole turns further
    const closed = (values, size) => {
      if (!c.ring) return values;
      const turns = size === 360 ? 360 * Math.round((values[s.n - 1] - values[0]) / 360) : 0;
      return Float64Array.from({ length: s.n + 1 }, (_, i) => (i < s.n ? values[i] : values[0] + turns));
    };
    const put = (group, panel) => list.push({ group, points: [], ...panel,
      band: panel.band && { square: closed(panel.band.square), worst: closed(panel.band.worst) },
      lines: panel.lines.map((one) => ({ ...one, values: closed(one.values, panel.size) })) });
    const marks = (values) => Array.from(values, (v, i) => [c.at[i], v]);
    const output = (name, actual, desired, band) => put('position', { name, size, band,
      lines: [{ label: c.desired || band ? 'actual' : '', colour: pens.actual, values: s[actual] }],
      points: c.desired ? [{ label: 'desired', colour: pens.desired, marks: marks(p[desired]) }] : [] });
    const further = (group) => {
      for (const panel of c.panels) if (panel.group === group) put(group, { name: panel.name, size: panel.scale,
        lines: panel.lines.map((one, i) => ({ ...one, colour: linkColour(i) })) });
    };
    if (c.curves) {
      for (const one of c.curves.slice(0, MOST)) put('position', { name: one.name, size: one.angle ? 360 : c.size,
        lines: [{ label: '', colour: pens.actual, values: one.sweep }],
        points: c.time ? [] : [{ colour: pens.actual, marks: marks(one.prescribed) }] });
      if (c.drives.length > 1) {
        const unitOf = (one) => (one.turning ? ', degrees' : ', length'), alike = c.drives.every((one) => one.turning === c.drives[0].turning);
        put('position', { name: 'drives' + (alike ? unitOf(c.drives[0]) : ',') + ' from the drawing', size: c.drives.every((one) => one.turning) ? 360 : c.size,
          lines: c.drives.map((one, i) => ({ label: one.name + (alike ? '' : unitOf(one)), colour: linkColour(i), values: one.sweep })) });
      }
    } else if (c.motion === 'point') {
      output('x of ' + called + ', length', 'actual', 'desired', c.band?.[0]);
      output('y of ' + called + ', length', 'actual_y', 'desired_y', c.band?.[1]);
    } else if (c.motion !== 'number') { // the panels have it
      output((c.outputLabel || OUTPUT[c.motion]) + unit, 'actual', 'desired', c.band?.[0]);
    }
    further('position');
    if (c.desired) {
      const error = (label, colour, values) => ({ label, colour, joined: true, marks: marks(values) });
      const points = [error(c.motion === 'point' ? 'x' : '', pens.accent, p.error)];
      if (c.motion === 'point') points.push(error('y', pens.link1, p.error_y));
      put('position', { name: 'error: desired - actual' + unit, size, zero: true, lines: [], points });
    }
    const named = s.angle.length <= 8;
    const angle = (a, i) => ({ label: named ? a.name : '', colour: linkColour(i),
      values: a.values });
    if (s.angle.length) put('position', { name: 'transmission angle, degrees', fixed: [0, 180], limits: c.limits,
      lines: s.angle.map(angle) });
    // bands are often too narrow to be seen beside the curve
    if (c.band) put('tolerance', { name: 'deviation within tolerances' + unit + ' (dotted: worst case)', size, zero: true,
      lines: c.band.slice(0, 2).flatMap((one, i) => {
        const label = c.motion === 'point' ? 'xy'[i] : '', colour = linkColour(i);
        return [{ label, colour, values: one.square }, { label: '', colour, dotted: true, values: one.worst }];
      }) });
    further('rates');
    if (c.forces) {
      const f = c.forces, curve = (label, colour, values) => ({ label, colour, values });
      const shown = (name, scale, lines) => put('forces', { name, size: scale, zero: true, lines });
      const bare = f.bare ? (label, key) => [curve(label, pens.soft, f.bare[key])] : () => [];
      const with_before = f.bare ? ' (grey: without the ' + f.bare.of + ')' : '';
      shown((f.sliding ? 'force of the drive, N' : 'torque of the drive, N m') + with_before, f.sliding ? f.force : f.turning,
        [...bare('', 'drive'), curve('', pens.actual, f.drive)]);
      shown('force on the frame, N', f.force, [...bare('', 'fx'), ...bare('', 'fy'), curve('x', pens.link0, f.fx), curve('y', pens.link1, f.fy)]);
      shown('moment on the frame, N m', f.turning, [...bare('', 'moment'), curve('', pens.link3, f.moment)]);
    }
    further('forces');
    further('energy');
    if (c.vibration) put('vibration', { name: 'deflection of the link, length' + (c.vibration.settles ? '' : ' (not settled)'), size: 0,
      zero: true, lines: c.vibration.modes.map((values, j) => ({ label: 'mode ' + (j + 1),
        colour: linkColour(j), values })) });
    if (c.clearance) put('contact', { name: 'contact in joint ' + c.clearance.name + ', N', size: 0, zero: true,
      lines: [{ label: 'force of contact', colour: pens.actual, values: c.clearance.force },
        { label: 'load without clearance', colour: pens.accent,
          values: Array.from(c.clearance.fx, (v, i) => Math.hypot(v, c.clearance.fy[i])) }] });
    return list;
  }

  /** The groups of panels that a case has, as [name, words]; with several of them all together come first. */
  function groupsOf(c) {
    const has = new Set(allPanels(c).map((panel) => panel.group));
    const list = Object.entries(GROUPS).filter(([group]) => has.has(group));
    return list.length > 1 ? [['all', 'all'], ...list] : list;
  }

  /** The group that is shown unasked: all, if there is room; else all but the rates; else the output alone. */
  function firstGroup(c) {
    const list = allPanels(c), usual = list.filter((panel) => panel.group !== 'rates').length;
    return list.length <= ROOM ? 'all' : usual <= ROOM ? 'usual' : 'position';
  }

  const panelsOf = (c) => allPanels(c).filter(({ group }) => balm.state.group === 'all' || group === balm.state.group ||
    balm.state.group === 'usual' && group !== 'rates');

  /** Name of a panel and of its lines, each in its colour. */
  const headOf = (panel) => [[panel.name, balm.drawing.pens.ink],
    ...[...panel.lines, ...panel.points].filter((one) => one.label).map((one) => [one.label, one.colour])];

  /** Everything but the cursor. */
  function layOut(c) {
    const [w, h] = fit(canvas, still), g = still.getContext('2d');
    const [from, to] = balm.state.whole ? c.ends : c.range, u = balm.drawing.sizeOf(w / 480, h / 520);
    plot = { w, h, u, left: 58 * u, right: w - 18 * u, from, to: Math.max(to, from + 1e-9), panels: panelsOf(c) };
    plot.x = (t) => plot.left + (t - plot.from) / (plot.to - plot.from) * (plot.right - plot.left);
    g.clearRect(0, 0, w, h);
    g.font = panels.font(u);
    const each = (h - 34 * u) / plot.panels.length;
    plot.panels.forEach((panel, i) => {
      panel.top = i * each + 6 * u + panels.headHeight(g, headOf(panel), plot.right - plot.left, u);
      panel.bottom = (i + 1) * each - 8 * u;
      drawPanel(g, c, panel);
    });
    drawInputAxis(g, c);
    layOutStrip(c);
  }

  function drawInputAxis(g, c) {
    const { w, h, u } = plot, first = inputAt(c, 0), each = inputAt(c, 1) - first || 1;
    const ends = [inputAt(c, plot.from), inputAt(c, plot.to)].sort((a, b) => a - b);
    // an axis from 0 to 360 ends with 360, any other turn goes on with 0
    const shown = (v) => (c.ring && (ends[0] < -1e-6 || ends[1] > 360 + 1e-6) ? modulo(v, 360) : v);
    panels.axis(g, balm.drawing.pens, { ...plot, bottom: h - 34 * u },
      ticks(inputAt(c, plot.from), inputAt(c, plot.to), w < 500 * u ? 4 : 7, c.ring), (v) => plot.x((v - first) / each), inputName(c), u,
      (v) => short(shown(v)));
  }

  function drawPanel(g, c, panel) {
    const { pens } = balm.drawing, { left, right, u } = plot, { top, bottom } = panel;
    const [low, high] = panel.fixed || range(...extent(panel, plot.from, plot.to), panel.size);
    const pad = panel.fixed ? 0 : 0.06 * (high - low);
    panel.y = (v) => bottom - (v - low + pad) / (high - low + 2 * pad) * (bottom - top);
    bands(g, c, plot.x, top, bottom - top);
    panels.grid(g, pens, plot, panel.fixed ? [0, 90, 180, 45, 135] : ticks(low, high, Math.max(2, (bottom - top) / (27 * u))), panel.y, u);
    panels.head(g, headOf(panel), left, top - 6 * u, right - left, u);
    g.save();
    g.beginPath();
    g.rect(left - 4 * u, top - 4, right - left + 8 * u, bottom - top + 8);
    g.clip();
    for (const v of panel.limits || []) {
      g.strokeStyle = pens.bad;
      g.setLineDash([5, 4]);
      line(g, left, panel.y(v), right, panel.y(v));
      g.setLineDash([]);
    }
    if (panel.band) drawBand(g, panel);
    for (const one of panel.lines) drawCurve(g, panel, one);
    for (const one of panel.points) drawPoints(g, panel, one);
    g.restore();
  }

  /** Within the root-sum-square of the tolerances; dotted lines at the worst case. */
  function drawBand(g, panel) {
    const [{ values, colour }] = panel.lines, { square, worst } = panel.band, n = values.length;
    g.fillStyle = colour;
    g.globalAlpha = 0.25;
    for (let i = 0; i < n;) {
      let k = i;
      while (k < n && isFinite(values[k]) && isFinite(square[k])) k++;
      if (k > i + 1) {
        g.beginPath();
        for (let m = i; m < k; m++) g.lineTo(plot.x(m), panel.y(values[m] + square[m]));
        for (let m = k - 1; m >= i; m--) g.lineTo(plot.x(m), panel.y(values[m] - square[m]));
        g.closePath();
        g.fill();
      }
      i = k + 1;
    }
    g.globalAlpha = 0.7;
    for (const side of [1, -1]) drawCurve(g, panel, { values: values.map((v, i) => v + side * worst[i]), colour, dotted: true });
    g.globalAlpha = 1;
  }

  function drawCurve(g, panel, { values, colour, dotted }) {
    g.strokeStyle = colour;
    g.lineWidth = (dotted ? 1 : 1.6) * plot.u;
    g.setLineDash(dotted ? [2, 3] : []);
    g.beginPath();
    let down = false;
    for (let i = 0; i < values.length; i++) {
      if (!isFinite(values[i])) { down = false; continue; }
      if (down) g.lineTo(plot.x(i), panel.y(values[i])); else g.moveTo(plot.x(i), panel.y(values[i]));
      down = true;
    }
    g.stroke();
    g.setLineDash([]);
  }

  function drawPoints(g, panel, { marks, colour, joined }) {
    const sorted = marks.filter(([, v]) => isFinite(v)).sort((a, b) => a[0] - b[0]);
    g.strokeStyle = colour;
    g.lineWidth = 1.2 * plot.u;
    if (joined) {
      g.globalAlpha = 0.5;
      g.beginPath();
      for (const [t, v] of sorted) g.lineTo(plot.x(t), panel.y(v));
      g.stroke();
      g.globalAlpha = 1;
    }
    for (const [t, v] of sorted) {
      g.beginPath();
      g.arc(plot.x(t), panel.y(v), 2.6 * plot.u, 0, ROUND);
      g.stroke();
    }
  }

  /** Red where it does not close, amber where a transmission angle is out of its limits. */
  function bands(g, c, x, top, height) {
    const { pens } = balm.drawing, n = c.sweep.n;
    for (let i = 0; i < n;) {
      const status = c.status[i];
      let k = i;
      while (k < n && c.status[k] === status) k++;
      if (status) {
        const a = Math.max(x(i - 0.5), x(plot.from)), b = Math.min(x(k - 0.5), x(plot.to));
        g.fillStyle = status === OPEN ? pens.badband : pens.warnband;
        if (b > a) g.fillRect(a, top, b - a, height);
      }
      i = k;
    }
  }

  function layOutStrip(c) {
    const { pens } = balm.drawing, [w, h] = fit(strip), g = strip.getContext('2d');
    const x = (t) => 8 + (t - plot.from) / (plot.to - plot.from) * (w - 16);
    g.clearRect(0, 0, w, h);
    bands(g, c, x, 0, h);
    g.fillStyle = pens.accent;
    for (const t of c.at) if (t <= plot.to + 1e-9) g.fillRect(x(t) - 0.8, 2, 1.6, h - 4);
    for (const { kind, t } of c.proof ? c.proof.marks : []) {
      if (t === undefined || t < plot.from - 1e-9 || t > plot.to + 1e-9) continue;
      g.fillStyle = kind === 'opens' ? pens.bad : kind === 'extreme' ? pens.actual : pens.warn;
      g.fillRect(x(t) - 0.6, h / 2, 1.2, h / 2);
    }
  }

  /** One frame: the cursor at t. */
  function frame(c, t) {
    const g = chart, at = between(c, t), x = plot.x(t);
    g.clearRect(0, 0, plot.w, plot.h);
    g.drawImage(still, 0, 0, plot.w, plot.h);
    g.strokeStyle = balm.drawing.pens.ink;
    g.lineWidth = plot.u;
    line(g, x, 14 * plot.u, x, plot.h - 34 * plot.u);
    for (const panel of plot.panels) for (const one of panel.lines) {
      const v = mixed(one.values, at);
      if (!isFinite(v)) continue;
      g.fillStyle = one.colour;
      g.beginPath();
      g.arc(x, panel.y(v), 3.6 * plot.u, 0, ROUND);
      g.fill();
    }
  }

  /** Place of the sweep under a point of the canvas. */
  function placeAt(x) {
    const part = (x - plot.left) / (plot.right - plot.left);
    return plot.from + Math.min(1, Math.max(0, part)) * (plot.to - plot.from);
  }

  return { begin, extent, groupsOf, firstGroup, layOut, frame, placeAt,
    get canvas() { return canvas; }, get chart() { return chart; }, get from() { return plot.from; },
    get to() { return plot.to; } };
})();
