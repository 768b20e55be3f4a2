// Out of the page: a frame as SVG or PNG, the table of the sweep, a film. All is made here, nothing is asked for.
'use strict';

balm.save = (() => {
  const FILMS = [['video/webm;codecs=vp9', 'webm'], ['video/webm', 'webm'], ['video/mp4', 'mp4']];
  const RATE = 25;           // frames a second
  const LARGER = 2;          // pixels of a PNG for each of the screen
  const BITS = 6e6;          // a second, of a film
  const SLICE = 100;         // milliseconds after which what is made of a film is handed over
  const HEAD = 2000;         // bytes: a film of fewer has no picture
  const PATIENCE = 10;       // seconds that the first pictures of a film may be late
  const $ = (id) => document.getElementById(id);
  const shown = () => balm.cases[balm.state.c];

  // ---- a pen that writes SVG ----------------------------------------------------------------------------------------

  const digits = (v) => String(Math.round(v * 1000) / 1000);
  const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);

  /** What of a canvas's context the drawing uses, written down as SVG. */
  class SvgPen {
    constructor(width, height) {
      Object.assign(this, { width, height, parts: [], stack: [], d: '', begun: false, dash: [], fillStyle: '#000', strokeStyle: '#000',
        lineWidth: 1, lineCap: 'butt', lineJoin: 'miter', globalAlpha: 1, font: '10px sans-serif', textAlign: 'left' });
    }
    save() {
      const { dash, fillStyle, strokeStyle, lineWidth, lineCap, lineJoin, globalAlpha, font, textAlign } = this;
      this.stack.push({ dash, fillStyle, strokeStyle, lineWidth, lineCap, lineJoin, globalAlpha, font, textAlign });
    }
    restore() { Object.assign(this, this.stack.pop()); }
    setLineDash(dash) { this.dash = dash; }
    beginPath() { this.d = ''; this.begun = false; }
    to(letter, x, y) { this.d += letter + digits(x) + ' ' + digits(y); this.begun = true; }
    moveTo(x, y) { this.to('M', x, y); }
    lineTo(x, y) { this.to(this.begun ? 'L' : 'M', x, y); }
    closePath() { if (this.begun) this.d += 'Z'; }
    rect(x, y, w, h) { this.d += 'M' + [x, y].map(digits).join(' ') + 'h' + digits(w) + 'v' + digits(h) + 'h' + digits(-w) + 'Z'; this.begun = true; }
    arc(x, y, r, from, to) {
      const turn = Math.min(2 * Math.PI, to - from), size = 'A' + digits(r) + ' ' + digits(r) + ' 0 0 1 ';
      this.lineTo(x + r * Math.cos(from), y + r * Math.sin(from));
      // in two, for a whole circle ends where it begins
      for (const part of [0.5, 1]) this.d += size + digits(x + r * Math.cos(from + part * turn)) + ' ' + digits(y + r * Math.sin(from + part * turn));
    }
    put(looks) {
      if (!/[LAh]/.test(this.d)) return;
      this.parts.push('<path d="' + this.d + '" ' + looks + (this.globalAlpha < 1 ? ' opacity="' + digits(this.globalAlpha) + '"' : '') + '/>');
    }
    fill() { this.put('fill="' + escaped(this.fillStyle) + '"'); }
    stroke() {
      this.put('fill="none" stroke="' + escaped(this.strokeStyle) + '" stroke-width="' + digits(this.lineWidth) + '" stroke-linecap="' + this.lineCap +
        '" stroke-linejoin="' + this.lineJoin + '"' + (this.dash.length ? ' stroke-dasharray="' + this.dash.join(' ') + '"' : ''));
    }
    fillRect(x, y, w, h) { this.beginPath(); this.rect(x, y, w, h); this.fill(); }
    fillText(text, x, y) {
      const anchor = { center: 'middle', right: 'end' }[this.textAlign] || 'start';
      this.parts.push('<text x="' + digits(x) + '" y="' + digits(y) + '" fill="' + escaped(this.fillStyle) + '" style="font:' + escaped(this.font).replaceAll('&quot;', "'") +
        '" text-anchor="' + anchor + '">' + escaped(text) + '</text>');
    }
    text(title) {
      // the name of the format, in two for it looks like an address
      return '<svg xmlns="http:/' + '/www.w3.org/2000/svg" width="' + this.width + '" height="' + this.height + '" viewBox="0 0 ' + this.width + ' ' +
        this.height + '">\n<title>' + escaped(title) + '</title>\n' + this.parts.join('\n') + '\n</svg>\n';
    }
  }

  // ---- files --------------------------------------------------------------------------------------------------------

  /** The picture as it stands, as SVG. */
  function svg() {
    const pen = new SvgPen(...balm.drawing.sizeAt(shown(), balm.state.t));
    balm.drawing.picture(shown(), balm.state.t, pen);
    return pen.text(shown().title + ', ' + $('facts').textContent);
  }

  /** A canvas of the picture's size, `scale` times, its sides even as films want them. */
  function sheet(scale) {
    const canvas = document.createElement('canvas'), [w, h] = balm.drawing.sizeAt(shown(), balm.state.t);
    canvas.width = 2 * Math.round(w * scale / 2);
    canvas.height = 2 * Math.round(h * scale / 2);
    const g = canvas.getContext('2d');
    g.setTransform(canvas.width / w, 0, 0, canvas.height / h, 0, 0);
    return [canvas, g];
  }

  /** The same as PNG. */
  function png() {
    const [canvas, g] = sheet(LARGER);
    balm.drawing.picture(shown(), balm.state.t, g);
    return new Promise((done) => canvas.toBlob(done, 'image/png'));
  }

  const table = () => balm.scene.csv(balm.scene.table(shown()));

  /** The kind of film that this browser can make: [type, ending of the file], or none. */
  const kindOfFilm = () => globalThis.MediaRecorder && FILMS.find(([type]) => MediaRecorder.isTypeSupported(type));

  /** The whole motion once as a film of so many seconds; what is played in parts goes there and back. */
  function film(seconds) {
    const c = shown(), [from, to] = balm.controls.limits(), ring = c.ring && to - from >= 360, [type] = kindOfFilm();
    const [canvas, g] = sheet(Math.min(2, window.devicePixelRatio || 1)), pieces = [];
    const at = (part) => from + (to - from) * (ring ? part % 1 : 1 - Math.abs(1 - 2 * part));
    balm.drawing.picture(c, at(0), g);
    const recorder = new MediaRecorder(canvas.captureStream(RATE), { mimeType: type, videoBitsPerSecond: BITS });
    recorder.addEventListener('dataavailable', (event) => pieces.push(event.data));
    return new Promise((done, failed) => {
      recorder.addEventListener('stop', () => done(new Blob(pieces, { type: type.split(';')[0] })));
      recorder.addEventListener('error', failed);
      recorder.addEventListener('start', () => {
        const began = performance.now(), clock = setInterval(() => {
          const part = (performance.now() - began) / 1000 / seconds, made = pieces.reduce((sum, piece) => sum + piece.size, 0);
          balm.drawing.picture(c, at(Math.min(1, part)), g);
          // a busy machine may have made nothing of the pictures yet but the head of the file
          if (part < 1 || (made < HEAD && part < 1 + PATIENCE / seconds)) return;
          clearInterval(clock);
          recorder.stop();
        }, 1000 / RATE);
      });
      recorder.start(SLICE);
    });
  }

  /** Hands a file over. */
  function give(content, ending, type) {
    const link = document.createElement('a'), blob = content instanceof Blob ? content : new Blob([content], { type });
    const number = balm.state.c ? '.' + (balm.state.c + 1) : '';
    link.href = URL.createObjectURL(blob);
    link.download = (shown().file || 'linkage').replace(/\.[^.]*$/, '') + number + ending;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }

  async function record() {
    const button = $('savefilm'), words = button.textContent;
    balm.controls.setPlaying(false);
    button.disabled = true;
    button.textContent = 'recording \u2026';
    try {
      give(await film(balm.controls.duration()), '.film.' + kindOfFilm()[1]);
    } finally {
      button.disabled = false;
      button.textContent = words;
    }
  }

  function begin() {
    // a case that is wrong has nothing to save
    const saves = (id, act) => $(id).addEventListener('click', () => shown().sound ? act() : undefined);
    saves('savesvg', () => give(svg(), '.frame.svg', 'image/svg+xml'));
    saves('savepng', async () => give(await png(), '.frame.png'));
    saves('savetable', () => give(table(), '.sweep.csv', 'text/csv'));
    saves('savefilm', record);
    $('savefilm').hidden = !kindOfFilm();
  }

  return { begin, svg, png, table, film, SvgPen };
})();
