// Tolerances that &ALLOC allots: of every dimension its part of the cost and of the deviation in the tightest band; the bands.
'use strict';

balm.allotted = (() => {
  const HEIGHT = 300;       // pixels of a panel of bands
  const ROW = 26;           // of a dimension
  const GAP = 8;            // between words and bars
  const PART = 46;          // room of the per cent at the end of a bar
  const NARROW = 640;       // pixels across, below which panels stand one below the other
  const WIDE = 1280;        // pixels across, above which letters grow
  let canvas, box, u = 1;

  function begin() {
    canvas = document.getElementById('allotted');
    box = document.getElementById('allottedbox');
  }

  /** Bars on the left, bands beside them, on a phone below; nothing for a case without them. */
  function layOut(c) {
    const a = c.allotted;
    box.hidden = !a;
    if (box.hidden) return;
    u = balm.drawing.sizeOf(box.clientWidth / WIDE, Infinity);
    const below = box.clientWidth < NARROW, half = below ? box.clientWidth : box.clientWidth / 2, g = canvas.getContext('2d');
    g.font = panels.font(u);
    const room = half - 34 * u, head = wordsOf(a).reduce((sum, words) => sum + panels.headHeight(g, words, room, u), GAP * u);
    const bars = head + ROW * a.rows.length * u, bands = HEIGHT * u * a.bands.length;
    canvas.style.height = (below ? bars + bands : Math.max(bars, bands)) + 'px';
    const [w] = panels.fit(canvas);
    g.clearRect(0, 0, w, canvas.clientHeight);
    g.font = panels.font(u);
    drawBars(g, a, 18 * u, half - 16 * u);
    a.bands.forEach((band, i) => {
      const left = below ? 0 : half, top = (below ? bars : 0) + i * HEIGHT * u;
      drawBand(g, a, band, { left: left + 64 * u, right: w - 16 * u, top, bottom: top + (HEIGHT - 40) * u });
    });
  }

  /** What stands above the bars, line by line. */
  function wordsOf(a) {
    const { pens } = balm.drawing;
    return [[[a.words, pens.ink]], [['part of the cost', pens.link0], [a.legend, pens.link1]]];
  }

  /** Two bars a dimension, in proportion to the parts that they stand for. */
  function drawBars(g, a, left, right) {
    const { pens } = balm.drawing, colours = [pens.link0, pens.link1], at = left + 0.34 * (right - left);
    const room = right - at - PART * u - Math.max(...a.rows.map((row) => g.measureText(row.tolerance).width)) - GAP * u;
    const largest = Math.max(...a.rows.flatMap((row) => [row.cost, row.share]));
    let top = 0;
    for (const words of wordsOf(a)) {
      top += panels.headHeight(g, words, right - left, u);
      panels.head(g, words, left, top, right - left, u);
    }
    top += GAP * u;
    a.rows.forEach((row, i) => {
      const y = top + ROW * i * u;
      g.fillStyle = pens.soft;
      g.textAlign = 'right';
      g.fillText(row.name, at - 8 * u, y + 12 * u, at - left - 8 * u);
      g.textAlign = 'left';
      [row.cost, row.share].forEach((part, k) => {
        g.fillStyle = colours[k];
        g.fillRect(at, y + 10 * u * k, Math.max(1, part / largest * room), 8 * u);
        g.fillStyle = pens.soft;
        g.fillText(row.parts[k], at + Math.max(1, part / largest * room) + 5 * u, y + (10 * k + 8) * u);
      });
      g.fillStyle = pens.ink;
      g.textAlign = 'right';
      g.fillText(row.tolerance, right, y + 13 * u);
      g.textAlign = 'left';
    });
  }

  /** What an output deviates over the input: worst case and root-sum-square, the band dashed. */
  function drawBand(g, a, band, at) {
    const { pens } = balm.drawing;
    const lines = [['worst case', pens.link1, band.worst], ['root-sum-square', pens.link0, band.square],
      ...band.used ? [['share of the linkages', pens.link2, band.used]] : [], ['band', pens.actual, band.width]];
    const words = [['deviation of ' + band.name, pens.ink], ...lines.map(([label, colour]) => [label, colour])];
    const most = 1.05 * Math.max(...lines.flatMap(([, , values]) => values)), n = band.input.length;
    const [from, to] = band.input[0] < band.input[n - 1] ? [band.input[0], band.input[n - 1]] : [band.input[0] - 0.5, band.input[0] + 0.5];
    at.top += 6 * u + panels.headHeight(g, words, at.right - at.left, u);
    const x = (v) => at.left + (v - from) / (to - from) * (at.right - at.left);
    const y = (v) => at.bottom - (v + most) / (2 * most) * (at.bottom - at.top);
    panels.head(g, words, at.left, at.top - 6 * u, at.right - at.left, u);
    panels.grid(g, pens, at, scales.ticks(-most, most, 6), y, u);
    panels.axis(g, pens, at, scales.ticks(from, to, 6, a.turning), x, a.input, u);
    const places = n > 1 ? band.input : [from, to], value = (values, i) => values[Math.min(i, n - 1)];
    for (const [label, colour, values] of lines) {
      g.strokeStyle = g.fillStyle = colour;
      g.lineWidth = 1.6 * u;
      g.setLineDash(label === 'band' ? [6, 4] : values === band.used ? [2, 3] : []);
      if (values === band.worst || values === band.square) {
        g.globalAlpha = 0.22;
        g.beginPath();
        places.forEach((v, i) => g.lineTo(x(v), y(value(values, i))));
        for (let i = places.length - 1; i >= 0; i--) g.lineTo(x(places[i]), y(-value(values, i)));
        g.fill();
        g.globalAlpha = 1;
      }
      for (const side of [1, -1]) {
        g.beginPath();
        places.forEach((v, i) => g.lineTo(x(v), y(side * value(values, i))));
        g.stroke();
      }
    }
    g.setLineDash([]);
  }

  return { begin, layOut };
})();
