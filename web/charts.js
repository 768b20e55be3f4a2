// What a vibrating link does at other speeds: its deflection, and the chart of stability.
'use strict';

balm.charts = (() => {
  const HEIGHT = 300;       // pixels of a panel
  const NARROW = 640;       // pixels across, below which panels stand one below the other
  const WIDE = 1280;        // pixels across, above which letters grow
  let canvas, box, u = 1;

  function begin() {
    canvas = document.getElementById('charts');
    box = document.getElementById('chartbox');
  }

  /** Panels side by side, on a phone one below the other; nothing for a case without them. */
  function layOut(c) {
    const v = c.vibration, list = [];
    if (v && v.speeds.some(([, a]) => a !== null)) list.push(drawSpeeds);
    if (v && v.chart.length) list.push(drawChart);
    box.hidden = !list.length;
    if (box.hidden) return;
    const below = box.clientWidth < NARROW;
    u = balm.drawing.sizeOf(box.clientWidth / WIDE, Infinity);
    canvas.style.height = (below ? list.length : 1) * HEIGHT * u + 'px';
    const [w] = panels.fit(canvas), g = canvas.getContext('2d'), across = below ? 1 : list.length, each = w / across;
    g.clearRect(0, 0, w, canvas.clientHeight);
    g.font = panels.font(u);
    list.forEach((panel, i) => {
      const left = (i % across) * each, top = Math.floor(i / across) * HEIGHT * u;
      panel(g, v, { left: left + 64 * u, right: left + each - 16 * u, top, bottom: top + (HEIGHT - 40) * u });
    });
  }

  /** Axes with their ticks below a heading; gives the functions from values to pixels. */
  function axes(g, at, name, across, [x0, x1], [y0, y1], logarithmic) {
    const { pens } = balm.drawing, words = [[name, pens.ink]], room = at.right - at.left;
    at.top += 6 * u + panels.headHeight(g, words, room, u);
    const tall = logarithmic ? Math.log10 : (v) => v, low = tall(y0), high = tall(y1);
    const x = (v) => at.left + (v - x0) / (x1 - x0) * room;
    const y = (v) => at.bottom - (tall(v) - low) / (high - low) * (at.bottom - at.top);
    panels.head(g, words, at.left, at.top - 6 * u, room, u);
    panels.grid(g, pens, at, logarithmic ? scales.decades(low, high) : scales.ticks(y0, y1, 6), y, u);
    panels.axis(g, pens, at, scales.ticks(x0, x1, 6), x, across, u);
    return [x, y];
  }

  function drawSpeeds(g, v, at) {
    const { pens } = balm.drawing, known = v.speeds.filter(([, a]) => a !== null && a > 0);
    const ends = [v.speeds[0][0], v.speeds.at(-1)[0]], sizes = known.map(([, a]) => a);
    const [x, y] = axes(g, at, 'greatest deflection of mode 1, length (shaded: unstable speeds)', 'speed, rad/s', ends,
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
    const [x, y] = axes(g, at, 'frequency/speed, chart of stability (shaded: unstable; dot: this case)', 'e, factor on the inertia of the other links',
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
