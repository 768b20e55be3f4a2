// A picture underneath the drawing, to trace over. It is not part of the data set.
'use strict';

board.picture = (() => {
  const PART = 0.8;                      // of the view that a new picture takes
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  let image = null, place = null;        // x, y of its lower left corner, width: lengths; fade: how strongly it shows

  function open(file) {
    const one = new Image(), address = URL.createObjectURL(file);
    one.onload = () => {
      URL.revokeObjectURL(address);
      if (!(one.width > 0 && one.height > 0)) { $('hint').textContent = words.noPicture(file.name); return; }
      const { view } = board, [left, top] = view.world(0, 0), [right, bottom] = view.world(view.canvas.clientWidth, view.canvas.clientHeight);
      const width = Number((PART * Math.min(right - left, (top - bottom) * one.width / one.height)).toPrecision(3)), height = width * one.height / one.width;
      image = one;
      place = { x: Number(((left + right - width) / 2).toPrecision(4)), y: Number(((top + bottom - height) / 2).toPrecision(4)), width, fade: 50 };
      show();
    };
    one.onerror = () => { URL.revokeObjectURL(address); $('hint').textContent = words.noPicture(file.name); };
    one.src = address;
  }

  function show() {
    board.panel.show();
    board.view.draw();
  }

  function draw(g, X, Y) {
    if (!image) return;
    const { x, y, width, fade } = place, height = width * image.height / image.width;
    g.globalAlpha = fade / 100;
    g.drawImage(image, X(x), Y(y + height), X(x + width) - X(x), Y(y) - Y(y + height));
    g.globalAlpha = 1;
  }

  /** Its place and strength among the properties. */
  function part() {
    const { head, row, numberField, button, make } = board.panel;
    if (!image) return [];
    const field = (key, least = -Infinity, most = Infinity) => numberField(words.picture[key], place[key], (value) => {
      if (!(value >= least && value <= most)) return false;
      place[key] = value;
      show();
      return true;
    });
    return [head(words.pictureHead), row('x, y', field('x'), field('y')), row(words.pictureWidth, field('width', 1e-9)), row(words.pictureFade, field('fade', 0, 100)),
      make('div', { class: 'list' }, button(words.pictureAway, () => { image = null; show(); }))];
  }

  function begin() {
    $('picture').addEventListener('click', () => $('picture-file').click());
    $('picture-file').addEventListener('change', () => { if ($('picture-file').files[0]) open($('picture-file').files[0]); $('picture-file').value = ''; });
  }

  return { begin, open, draw, part, get place() { return image && place; } };
})();
