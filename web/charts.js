// What a vibrating link does at other speeds: its deflection, and the chart of stability.
'use strict';

balm.charts = (() => {
  const HEIGHT = 300;       // pixels on a desk
  let canvas, box;

  function begin() {
    canvas = document.getElementById('charts');
    box = document.getElementById('chartbox');
  }

  /** Panels side by side; nothing for a case without them. */
  function layOut(c) {
    const v = c.vibration, panels = [];
    if (v && v.speeds.some(([, a]) => a !== null)) panels.push(drawSpeeds);
    if (v && v.chart.length) panels.push(drawChart);
    box.hidden = !panels.length;
    if (box.hidden) return;
    canvas.style.height = HEIGHT + 'px';
    const [w, h] = balm.drawing.fit(canvas), g = canvas.getContext('2d'), each = w / panels.length;
    g.clearRect(0, 0, w, h);
    g.font = '11px system-ui, sans-serif';
    panels.forEach((panel, i) => panel(g, v, { left: i * each + 64, right: (i + 1) * each - 16, top: 26, bottom: h - 40 }));
  }

  /** Axes with their ticks; gives the functions from values to pixels. */
  function axes(g, at, name, across, [x0, x1], [y0, y1], logarithmic) {
    const { pens } = balm.drawing, { ticks } = balm.curves, { short } = balm.scene;
    const tall = logarithmic ? Math.log10 : (v) => v, low = tall(y0), high = tall(y1);
    const x = (v) => at.left + (v - x0) / (x1 - x0) * (at.right - at.left);
    const y = (v) => at.bottom - (tall(v) - low) / (high - low) * (at.bottom - at.top);
    const marks = logarithmic ? decades(low, high) : ticks(y0, y1, 6);
    g.lineWidth = 1;
    g.strokeStyle = pens.line;
    g.fillStyle = pens.soft;
    g.textAlign = 'right';
    for (const v of marks) {
      g.beginPath();
      g.moveTo(at.left, y(v));
      g.lineTo(at.right, y(v));
      g.stroke();
      g.fillText(short(v), at.left - 5, y(v) + 4);
    }
    g.textAlign = 'center';
    for (const v of ticks(x0, x1, 6)) {
      g.beginPath();
      g.moveTo(x(v), at.bottom);
      g.lineTo(x(v), at.bottom + 4);
      g.stroke();
      g.fillText(short(v), x(v), at.bottom + 16);
    }
    g.fillText(across, (at.left + at.right) / 2, at.bottom + 32);
    g.textAlign = 'left';
    g.fillStyle = pens.ink;
    g.fillText(name, at.left, at.top - 10);
    return [x, y];
  }

  /** Powers of ten, with 2 and 5 times them where there are few. */
  function decades(low, high) {
    const list = [];
    for (let k = Math.floor(low); k <= high; k++) for (const m of high - low > 3 ? [1] : [1, 2, 5]) {
      const v = m * 10 ** k;
      if (Math.log10(v) >= low - 1e-9 && Math.log10(v) <= high + 1e-9) list.push(v);
    }
    return list;
  }

  function drawSpeeds(g, v, at) {
    const { pens } = balm.drawing, known = v.speeds.filter(([, a]) => a !== null && a > 0);
    const ends = [v.speeds[0][0], v.speeds.at(-1)[0]], sizes = known.map(([, a]) => a);
    const [x, y] = axes(g, at, 'greatest deflection of mode 1 (shaded: unstable speeds)', 'speed, rad/s', ends,
      [Math.min(...sizes) / 1.2, Math.max(...sizes) * 1.2], true);
    g.fillStyle = pens.badband;
    for (const [from, to] of v.bands) g.fillRect(x(from), at.top, Math.max(1, x(to) - x(from)), at.bottom - at.top);
    g.strokeStyle = pens.actual;
    g.lineWidth = 1.6;
    g.beginPath();
    let down = false;
    for (const [speed, a] of v.speeds) {
      if (!(a > 0)) { down = false; continue; }
      if (down) g.lineTo(x(speed), y(a)); else g.moveTo(x(speed), y(a));
      down = true;
    }
    g.stroke();
  }

  /** Oldham's figure 14.2: unstable between the two boundaries of each number of half waves. */
  function drawChart(g, v, at) {
    const { pens } = balm.drawing, rows = v.chart, last = rows[0].bounds.length - 1;
    const top = Math.max(v.ratio, 1, ...rows.map((row) => row.bounds[last][1]));
    const [x, y] = axes(g, at, 'chart of stability (shaded: unstable; dot: this case)', 'e, inertia of the other links',
      [rows[0].e, rows.at(-1).e], [0, top], false);
    g.save();
    g.beginPath();
    g.rect(at.left, at.top, at.right - at.left, at.bottom - at.top);
    g.clip();
    g.fillStyle = pens.badband;
    g.strokeStyle = pens.bad;
    g.lineWidth = 0.7;
    for (let p = 0; p <= last; p++) {
      g.beginPath();
      for (const row of rows) g.lineTo(x(row.e), y(row.bounds[p][1]));
      for (const row of rows.slice().reverse()) g.lineTo(x(row.e), p ? y(row.bounds[p][0]) : at.bottom + 9);
      g.closePath();
      g.fill();
      g.stroke();
    }
    g.fillStyle = pens.accent;
    g.beginPath();
    g.arc(x(v.e), y(v.ratio), 4, 0, 2 * Math.PI);
    g.fill();
    g.restore();
  }

  return { begin, layOut };
})();
