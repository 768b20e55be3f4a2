// Panels of curves, whatever page they are on: canvases, headings with a legend, grids and axes.
'use strict';

globalThis.panels = (() => {
  const { short } = scales;
  const CLOSE = 11;         // pixels: labels of an axis that are nearer than this would touch
  const LINE = 14;          // pixels of a line of a heading

  /** Gives a canvas and copies of it the pixels of its place on the screen. */
  function fit(shown, ...copies) {
    const dpr = window.devicePixelRatio || 1, w = shown.clientWidth, h = shown.clientHeight;
    for (const one of [shown, ...copies]) {
      one.width = Math.max(1, Math.round(w * dpr));
      one.height = Math.max(1, Math.round(h * dpr));
      one.getContext('2d').setTransform(dpr, 0, 0, dpr, 0, 0);
    }
    return [w, h];
  }

  /** The colours of the scheme, by their names in colours.css. */
  function colours(names, pens) {
    const css = getComputedStyle(document.documentElement);
    for (const name of names) pens[name] = css.getPropertyValue('--' + name).trim();
  }

  const font = (u) => 11 * u + 'px system-ui, sans-serif';

  function line(g, x1, y1, x2, y2) {
    g.beginPath();
    g.moveTo(x1, y1);
    g.lineTo(x2, y2);
    g.stroke();
  }

  /** Places of words `[text, colour]` in lines no longer than `room`: [text, colour, x, line]; a word longer than that is broken. */
  function placed(g, words, room, u) {
    const list = [];
    let x = 0, row = 0;
    for (const [text, colour] of words) {
      let rest = text;
      while (rest) {
        const wide = g.measureText(rest).width;
        if (x > 0 && x + wide > room) { x = 0; row++; continue; }
        let part = rest;
        while (g.measureText(part).width > room && part.includes(' ')) part = part.slice(0, part.lastIndexOf(' '));
        list.push([part, colour, x, row]);
        rest = rest.slice(part.length).trim();
        x = rest ? 0 : x + wide + 12 * u;
        if (rest) row++;
      }
    }
    return list;
  }

  /** Height of a heading. */
  function headHeight(g, words, room, u) {
    const list = placed(g, words, room, u);
    return LINE * u * (1 + (list.length ? list.at(-1)[3] : 0));
  }

  /** A heading, each word in its colour, above `bottom`. */
  function head(g, words, left, bottom, room, u) {
    const list = placed(g, words, room, u), last = list.length ? list.at(-1)[3] : 0;
    g.textAlign = 'left';
    for (const [text, colour, x, row] of list) {
      g.fillStyle = colour;
      g.fillText(text, left + x, bottom - LINE * u * (last - row));
    }
  }

  /** Lines across at values with their numbers; those that would touch another one have none. */
  function grid(g, pens, at, values, y, u) {
    const written = [];
    g.strokeStyle = pens.line;
    g.lineWidth = 1;
    g.fillStyle = pens.soft;
    g.textAlign = 'right';
    for (const v of values) {
      const place = Math.round(y(v)) + 0.5;
      line(g, at.left, place, at.right, place);
      if (written.some((other) => Math.abs(place - other) < CLOSE * u)) continue;
      g.fillText(short(v), at.left - 5 * u, place + 4 * u);
      written.push(place);
    }
    g.textAlign = 'left';
  }

  /** The axis below a panel, or below several: numbers at their places, its name in the middle. */
  function axis(g, pens, at, values, x, name, u, words = short) {
    const written = [];
    g.fillStyle = pens.soft;
    g.textAlign = 'center';
    for (const v of values) {
      const text = words(v), half = g.measureText(text).width / 2, place = x(v);
      if (written.some(([other, far]) => Math.abs(place - other) < half + far + 4 * u)) continue;
      g.fillText(text, place, at.bottom + 14 * u);
      written.push([place, half]);
    }
    g.fillText(name, (at.left + at.right) / 2, at.bottom + 29 * u);
    g.textAlign = 'left';
  }

  return { fit, colours, font, line, headHeight, head, grid, axis };
})();
