// Drafts in the browser, links that hold a sketch, the gallery.
'use strict';

board.store = (() => {
  const KEY = 'psalm.board', DELAY = 250, MOST_TEXT = 1 << 20;   // characters of a data set in a link
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  let timer = 0, given = '', works = true;

  // ---- drafts -------------------------------------------------------------------------------------------------------

  /** Keeps what is on the board, a moment after the last change. */
  function keep() {
    clearTimeout(timer);
    timer = setTimeout(put, DELAY);
  }

  function put() {
    clearTimeout(timer);
    timer = 0;
    const { sketch, file, wanted } = board.state;
    try {
      if (sketch.joints.length || wanted) localStorage.setItem(KEY, JSON.stringify({ text: sketch.joints.length ? board.write() : '', file, wanted, given }));
      else localStorage.removeItem(KEY);
      works = true;
    } catch {
      works = false;             // the browser keeps nothing, or is full
    }
  }

  /** What was drawn last time, if the same was given then as now. */
  function restore(text) {
    given = text;
    if (board.state.sketch.joints.length && !text) return;         // it came with the address
    let draft = null;
    try {
      draft = JSON.parse(localStorage.getItem(KEY));
    } catch { return; }
    if (!draft || draft.given !== given || draft.text === given || typeof draft.text !== 'string') return;
    if (draft.text && !board.attempt(draft.text, String(draft.file), true)) return;
    board.state.wanted = wantedOf(draft.wanted);
    board.state.dirty = true;
    board.refresh();
    board.fit();
    $('hint').textContent = words.restored;
  }

  const wantedOf = (one) => one && Array.isArray(one.points) && one.points.every((p) => Array.isArray(p) && p.length === 2 && p.every(Number.isFinite)) ?
    { points: one.points, closed: Boolean(one.closed) } : null;

  /** Whether all changes are kept. */
  function kept() {
    if (timer) put();
    return works;
  }

  // ---- links --------------------------------------------------------------------------------------------------------

  const through = (bytes, stream) => new Blob([bytes]).stream().pipeThrough(stream);

  /** A text compressed, in letters that an address may have. */
  async function packed(text) {
    const bytes = new Uint8Array(await new Response(through(new TextEncoder().encode(text), new CompressionStream('deflate-raw'))).arrayBuffer());
    let letters = '';
    for (const byte of bytes) letters += String.fromCharCode(byte);
    return btoa(letters).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
  }

  /** The text again; refused if it is no such text, or grows without measure. */
  async function unpacked(letters) {
    const bytes = Uint8Array.from(atob(letters.replace(/-/g, '+').replace(/_/g, '/')), (letter) => letter.charCodeAt(0));
    const reader = through(bytes, new DecompressionStream('deflate-raw')).getReader(), parts = [];
    let size = 0;
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      size += value.length;
      if (size > MOST_TEXT) { await reader.cancel(); throw new RangeError('too long'); }
      parts.push(value);
    }
    return new TextDecoder('utf-8', { fatal: true }).decode(await new Blob(parts).arrayBuffer());
  }

  /** A link that holds the data set; of a served board, whose address has a token, the part that holds it alone. */
  async function link() {
    const part = '#z=' + await packed(board.write()) + '&file=' + encodeURIComponent(board.state.file);
    return board.engine.served ? part : location.href.replace(/#.*$/, '') + part;
  }

  async function share() {
    const { make, button } = board.panel, dialog = $('dialog'), field = make('input', { readonly: true, 'aria-label': words.linkLabel, value: await link() });
    const copy = button(words.copy, () => {
      field.select();
      navigator.clipboard.writeText(field.value).catch(() => document.execCommand('copy'));
      copy.textContent = words.copied;
    }, { class: 'main' });
    dialog.className = 'link';
    dialog.replaceChildren(make('h2', {}, words.linkHead), make('p', {}, board.engine.served ? words.linkServed : words.linkHint), field,
      make('div', { class: 'row' }, copy, button(words.close, () => dialog.close())));
    dialog.showModal();
    field.select();
  }

  /** A link or a data set that is pasted onto the board. */
  function paste(event) {
    if (/^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName)) return;
    const text = event.clipboardData.getData('text/plain'), packed = /#z=([\w-]+)(?:&file=([\w.%-]+))?/.exec(text);
    if (packed) unpacked(packed[1]).then((case_) => board.attempt(case_, decoded(packed[2] || 'sketch.nml')), () => board.wrong(words.badLink));
    else if (/[&$]CHAIN\b/i.test(text)) board.attempt(text, 'sketch.nml');
    else if (/^https?:\/\/\S*pmks\S*\?\S+$/i.test(text.trim())) board.imports.link(text.trim());
    else return;
    event.preventDefault();
  }

  function decoded(name) {
    try { return decodeURIComponent(name); } catch { return 'sketch.nml'; }
  }

  // ---- gallery ------------------------------------------------------------------------------------------------------

  /** A picture of a sketch: its links, and the paths of its outputs. */
  function picture(sketch, path = null) {
    const at = new Map(sketch.joints.map((j) => [j.name, [j.x, -j.y]])), lines = [];
    let curve = path ? path.map(([x, y]) => [x, -y]) : null;
    if (!path) {
      const mech = board.motion.assess(sketch).length ? null : board.motion.compile(sketch), start = mech && board.motion.assemble(mech);
      if (start && !start.dead) {
        board.motion.joints(mech, start.pose).forEach(([x, y], j) => at.set(sketch.joints[j].name, [x, -y]));
        const out = sketch.outputs.find((o) => ['point', 'pose', 'x', 'y'].includes(o.kind)), j = out ? sketch.joints.findIndex((one) => one.name === out.of[0]) : -1;
        if (j >= 0) curve = board.sweepOf(sketch, mech, start, 3).places.map((places) => [places[j][0], -places[j][1]]);
      }
    }
    const all = [...at.values(), ...(curve || [])], xs = all.map((p) => p[0]), ys = all.map((p) => p[1]);
    const [x1, x2, y1, y2] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)], size = Math.max(x2 - x1, 1.4 * (y2 - y1), 1e-9), edge = 0.07 * size;
    const { svg } = board.panel;
    const text = (points) => points.map((p) => p.map((v) => Number(v.toPrecision(6))).join(',')).join(' ');
    sketch.links.forEach((one, i) => {
      if (i && one.joints.length > 1) lines.push(svg('polygon', { points: text(board.view.outline(one.joints.map((name) => at.get(name)))), class: 'link', style: '--c:var(--link' + (i - 1) % 8 + ')' }));
    });
    const frame = new Set(sketch.links[0].joints);
    const dots = sketch.joints.map((j) => svg('circle', { cx: at.get(j.name)[0], cy: at.get(j.name)[1], r: 0.018 * size, class: frame.has(j.name) ? 'frame' : 'pin' }));
    const whole = svg('svg', { viewBox: [x1 - edge, (y1 + y2) / 2 - size / 2.8 - edge, size + 2 * edge, size / 1.4 + 2 * edge].join(' '), 'aria-hidden': 'true' });
    if (curve && curve.length > 1) lines.unshift(svg('polyline', { points: text(curve), class: 'path' }));
    whole.append(...lines, ...dots);
    return whole;
  }

  function gallery() {
    const { make, button } = board.panel, dialog = $('dialog');
    const cards = board.examples.map((one) => {
      const sketch = board.text.parse(one.text);
      const card = make('button', { type: 'button', class: 'card', 'data-name': one.name, onclick: () => { dialog.close(); board.load(one.text, one.name + '.nml'); board.store.keep(); } },
        picture(sketch), make('span', {}, one.title));
      return card;
    });
    const find = make('input', { type: 'search', 'aria-label': words.galleryFilter, placeholder: words.galleryFilter, oninput: () => {
      for (const card of cards) card.hidden = !(card.dataset.name + ' ' + card.textContent).toLowerCase().includes(find.value.trim().toLowerCase());
    } });
    dialog.className = 'gallery';
    dialog.replaceChildren(make('div', { class: 'row' }, make('h2', {}, words.galleryHead), find, button(words.close, () => dialog.close())),
      make('div', { class: 'cards' }, ...cards));
    dialog.showModal();
  }

  function begin() {
    $('share').addEventListener('click', share);
    $('gallery').addEventListener('click', gallery);
    document.addEventListener('paste', paste);
    addEventListener('pagehide', () => { if (timer) put(); });
  }

  return { begin, keep, kept, restore, packed, unpacked, link, picture };
})();
