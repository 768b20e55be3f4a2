// A wanted curve on the board, and a search for linkages that trace it: the sheet of those found, one of which becomes the sketch.
'use strict';

board.search = (() => {
  const POINTS = 24, MOST_POINTS = 200;  // of a curve that is drawn
  const NEAR = 0.12;                     // of its size: how far apart the ends of a closed one may be
  const EVERY = 400;                     // milliseconds between two questions
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  const parts = {}, chosen = new Set(['pins4', 'slide4', 'pins6']);
  let cards = [], running = '', round = 0, angle = 0, count = POINTS, stopping = false;
  let low = 0, high = 0;                 // bounds of lengths; 0: the usual ones
  let text = '';                         // the data set of the last search, as psalm reads it

  // ---- the curve ----------------------------------------------------------------------------------------------------

  const length = (points) => points.slice(1).reduce((sum, p, i) => sum + Math.hypot(p[0] - points[i][0], p[1] - points[i][1]), 0);

  /** Points evenly along a line; a closed one does not have its first point again. */
  function even(points, n, closed) {
    const line = closed ? [...points, points[0]] : points, whole = length(line), list = [];
    let k = 1, passed = 0;
    for (let i = 0; i < n; i++) {
      const target = whole * i / (closed ? n : n - 1);
      let step = Math.hypot(line[k][0] - line[k - 1][0], line[k][1] - line[k - 1][1]);
      while (k < line.length - 1 && passed + step < target) {
        passed += step;
        k++;
        step = Math.hypot(line[k][0] - line[k - 1][0], line[k][1] - line[k - 1][1]);
      }
      const f = step ? Math.min(1, (target - passed) / step) : 0;
      list.push([0, 1].map((axis) => Number((line[k - 1][axis] + f * (line[k][axis] - line[k - 1][axis])).toPrecision(7))));
    }
    return list;
  }

  /** A hand that trembles is smoothed: each point is the mean of its neighbours. */
  function smoothed(points, closed) {
    const n = points.length;
    return points.map((p, i) => !closed && (i === 0 || i === n - 1) ? p : [0, 1].map((axis) => Number(((points[(i + n - 1) % n][axis] + 2 * p[axis] + points[(i + 1) % n][axis]) / 4).toPrecision(7))));
  }

  /** What was drawn by hand becomes the wanted curve. */
  function drawn(points) {
    const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]), size = Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys));
    if (points.length < 4 || !(size > 0)) return;
    const ends = Math.hypot(points[0][0] - points.at(-1)[0], points[0][1] - points.at(-1)[1]), closed = ends < NEAR * length(points);
    want({ points: smoothed(even(points, count, closed), closed), closed });
    board.panel.turnTo('search');
  }

  function want(curve) {
    board.begin();
    board.state.wanted = curve;
    board.end();
    forget();
  }

  /** Points of a CSV file: the first two numbers of each line that has two. */
  function fromTable(text) {
    const comma = text.includes(';');
    return text.split(/\r?\n/).map((line) => (comma ? line.replace(/,/g, '.').split(/[;\s]+/) : line.split(/[,\s]+/)).filter(Boolean).map(Number))
      .filter((row) => row.length > 1 && isFinite(row[0]) && isFinite(row[1])).map((row) => [row[0], row[1]]);
  }

  /** Points along the longest path of an SVG picture, y upwards. */
  function fromPicture(text) {
    const whole = new DOMParser().parseFromString(text, 'image/svg+xml'), mine = board.panel.svg('path');
    const pathOf = (one) => one.tagName === 'path' ? one.getAttribute('d') : 'M' + (one.getAttribute('points') || '') + (one.tagName === 'polygon' ? 'z' : '');
    let best = [], closed = false;
    for (const one of whole.querySelectorAll('path,polygon,polyline')) {
      mine.setAttribute('d', pathOf(one) || '');
      const reach = mine.getTotalLength(), points = [];
      if (!(reach > 0)) continue;
      for (let i = 0; i <= MOST_POINTS; i++) { const p = mine.getPointAtLength(reach * i / MOST_POINTS); points.push([p.x, p.y]); }
      for (let up = one; up && up.transform; up = up.parentNode) {
        const one_ = up.transform.baseVal.consolidate();
        if (one_) for (const p of points) [p[0], p[1]] = [one_.matrix.a * p[0] + one_.matrix.c * p[1] + one_.matrix.e, one_.matrix.b * p[0] + one_.matrix.d * p[1] + one_.matrix.f];
      }
      if (length(points) > length(best)) { best = points; closed = /z\s*$/i.test(pathOf(one)); }
    }
    return { points: best.map(([x, y]) => [x, -y]), closed };
  }

  function openCurve(file) {
    file.text().then((text) => {
      const picture = /\.svg$/i.test(file.name), found = picture ? fromPicture(text) : { points: fromTable(text), closed: false }, { points } = found;
      if (points.length < 3 || !(length(points) > 0)) { parts.told.textContent = words.noCurve(file.name); return; }
      const gap = Math.hypot(points[0][0] - points.at(-1)[0], points[0][1] - points.at(-1)[1]), closed = found.closed || gap < NEAR * length(points);
      if (closed && gap < 1e-9 * length(points)) points.pop();
      parts.told.textContent = '';
      want({ points: picture || points.length > MOST_POINTS ? even(points, count, closed) : points, closed });
      board.fit();
    });
  }

  function draw(g, X, Y, pens) {
    const { wanted } = board.state, hand = board.tools.hand;
    for (const [points, closed] of [[hand || [], false], wanted && !hand ? [wanted.points, wanted.closed] : [[], false]]) {
      if (!points.length) continue;
      g.strokeStyle = g.fillStyle = pens.accent;
      g.lineWidth = 2;
      g.setLineDash([7, 5]);
      g.beginPath();
      for (const [x, y] of points) g.lineTo(X(x), Y(y));
      if (closed) g.closePath();
      g.stroke();
      g.setLineDash([]);
      if (points !== hand) for (const [x, y] of points) { g.beginPath(); g.arc(X(x), Y(y), 2.6, 0, 2 * Math.PI); g.fill(); }
    }
  }

  // ---- the search ---------------------------------------------------------------------------------------------------

  function begin() {
    if (!board.engine.served) return;
    const { make, head, check, button, row, numberField } = board.panel;
    parts.file = make('input', { type: 'file', accept: '.csv,.txt,.svg', 'aria-label': words.wantedFile, hidden: true });
    parts.file.addEventListener('change', () => { if (parts.file.files[0]) openCurve(parts.file.files[0]); parts.file.value = ''; });
    parts.has = make('p');
    parts.told = make('p', { class: 'wrong', role: 'alert' });
    parts.clear = button(words.wantedClear, () => want(null));
    parts.closed = check(words.wantedClosed, false, (on) => { const { wanted } = board.state; if (wanted) want({ points: even(wanted.points, wanted.points.length, on), closed: on }); });
    parts.start = button(words.searchStart, start, { class: 'main', id: 'start-search' });
    parts.stop = button(words.searchStop, stop, { id: 'stop-search' });
    parts.save = button(words.searchSave, () => board.download(text, 'wanted.nml'), { hidden: true });
    parts.doing = make('p', { role: 'status' });
    parts.sheet = make('div', { class: 'cards' });
    parts.found = make('div', { hidden: true }, head(words.sheet), make('p', {}, words.sheetHint), parts.sheet);
    const kinds = Object.entries(words.kindNames).map(([name, text]) => make('label', { class: 'tick' }, check(text, chosen.has(name), (on) => { if (on) chosen.add(name); else chosen.delete(name); follow(); }), text));
    $('search').append(head(words.wantedHead), parts.has, make('div', { class: 'list' }, button(words.tools.wanted[0], () => { board.tools.choose('wanted'); board.view.canvas.scrollIntoView({ block: 'nearest' }); }),
      button(words.wantedFile, () => parts.file.click()), parts.clear, parts.file, make('label', { class: 'tick' }, parts.closed, words.wantedClosed)),
    row(words.wantedPoints, numberField(words.wantedPoints, count, (value) => {
      if (!Number.isInteger(value) || value < 3 || value > MOST_POINTS) return false;
      count = value;
      const { wanted } = board.state;
      if (wanted) want({ points: even(wanted.points, count, wanted.closed), closed: wanted.closed });
      return true;
    })), parts.told, head(words.kinds), make('div', { class: 'list' }, ...kinds),
    parts.mine = make('p'), row(words.lengths, ...[[words.lengthLow, (v) => { low = v; }], [words.lengthHigh, (v) => { high = v; }]].map(([label, take]) =>
      numberField(label, 0, (value) => { if (value < 0) return false; take(value); return true; }))), row(words.leastAngle, numberField(words.leastAngleLabel, angle, (value) => { if (value < 0 || value > 60) return false; angle = value; return true; })),
    make('div', { class: 'list' }, parts.start, parts.stop, parts.save), parts.doing, parts.found);
    follow();
  }

  function follow() {
    if (!board.engine.served) return;
    const { wanted } = board.state;
    parts.has.textContent = wanted ? words.wantedHas(wanted.points.length, wanted.closed) : words.wantedNone;
    parts.clear.disabled = parts.closed.disabled = !wanted;
    parts.closed.checked = Boolean(wanted && wanted.closed);
    parts.mine.textContent = !chosen.has('mine') ? '' : !ownPossible() ? words.mineNeeds : own() ? words.mineHint : words.mineSlides;
    parts.start.disabled = (chosen.has('mine') && !ownPossible()) || !wanted || !chosen.size || Boolean(running);
    parts.stop.disabled = !running || stopping;
    parts.start.textContent = cards.length ? words.searchOn : words.searchStart;
  }

  /** Whether the sketch that is drawn can be varied. */
  function ownPossible() {
    const { sketch, messages } = board.state;
    return !messages.length && board.free() === 1 && Boolean(sketch.outputs.length) && sketch.outputs[0].kind === 'point';
  }

  const exact = (a, b) => board.state.sketch.lengths.some((l) => l.joints.includes(a) && l.joints.includes(b));

  /** Dimensions of a link that may vary: all but exact lengths, as psalm names them. */
  function dimensionsOf(link) {
    const { links, lengths } = board.state.sketch, [a, b, ...more] = link.joints;
    if (link === links[0]) return link.joints.map((name) => 'place ' + name);
    // a length across a plate holds the whole plate
    if (!b || lengths.some((l) => l.joints.every((name) => [b, ...more].includes(name)))) return [];
    return [...(exact(a, b) ? [] : [a + ' ' + b]), ...more.flatMap((c) => [...(exact(a, c) ? [] : [a + ' ' + c]), ...(exact(b, c) ? [] : ['angle ' + a + ' ' + b + ' ' + a + ' ' + c])])];
  }

  /** Dimensions of the sketch that vary; nothing where they have no names. */
  function own() {
    const { links, lengths, slides, gears, vary } = board.state.sketch, bounded = vary.filter((one) => one.low.length);
    if (!lengths.length && !bounded.length) return ['all'];
    if (slides.length || gears.length) return null;
    return links.flatMap(dimensionsOf);
  }

  /** Bounds of single dimensions. */
  const ranges = (list) => Object.fromEntries(board.state.sketch.vary.filter((one) => one.low.length && list.includes(one.of)).map((one) => [one.of, one.low.map((low, i) => [low, one.high[i]])]));

  /** Of another curve nothing has been found yet. */
  function forget() {
    stop();
    running = '';
    [cards, round, text] = [[], 0, ''];
    if (parts.save) parts.save.hidden = true;
    show();
    if (parts.doing) parts.doing.textContent = '';
    follow();
  }

  async function start() {
    const { wanted } = board.state;
    parts.told.textContent = '';
    const got = await board.engine.ask('search', JSON.stringify({ points: wanted.points, closed: wanted.closed, kinds: [...chosen], round, angle, low, high,
      ...(chosen.has('mine') ? { case: board.write(), output: board.state.sketch.outputs[0].of[0], vary: own() || ['all'], ranges: ranges(own() || []) } : {}) }));
    if (got.error) { parts.told.textContent = got.error; return; }
    running = got.search;
    stopping = false;
    follow();
    watch(running, 0);
  }

  /** Asks what was found until the search is over; of a search that is no longer wanted nothing is taken. */
  async function watch(name, after) {
    const got = await board.engine.ask('search/' + name + '?after=' + after);
    if (running !== name) return;
    if (got.error) { parts.told.textContent = got.error; running = ''; follow(); return; }
    for (const one of got.events) {
      if (one.doing) {
        parts.doing.textContent = words.searching(words.kindNames[one.doing], one.round);
        text = one.text;
        parts.save.hidden = false;
      }
      if (one.found) add(one.found);
      if (one.error) parts.told.textContent = one.error;
      if (one.done) round = one.round === undefined ? round + 1 : one.round;
    }
    if (got.events.some((one) => one.found)) show();
    if (got.running) { setTimeout(() => watch(name, after + got.events.length), EVERY); return; }
    running = '';
    parts.doing.textContent = words.searchOver(cards.length);
    follow();
  }

  function stop() {
    if (!running) return;
    stopping = true;
    board.engine.ask('search/' + running + '/stop', '');
    follow();
  }

  /** The best of each kind is on the sheet. */
  function add(one) {
    const there = cards.find((card) => card.kind === one.kind);
    if (there && there.error <= one.error) return;
    cards = [...cards.filter((card) => card !== there), one].sort((a, b) => a.error - b.error);
  }

  function show() {
    if (!parts.sheet) return;
    const { make } = board.panel, made = new Map([...parts.sheet.children].map((element) => [element.dataset.key, element]));
    parts.found.hidden = !cards.length;
    parts.sheet.replaceChildren(...cards.map((card) => {
      const key = card.kind + ' ' + card.error;
      if (made.has(key)) return made.get(key);
      const path = card.path[0].map((x, i) => [x, card.path[1][i]]).filter(([x, y]) => x !== null && y !== null);
      return make('button', { type: 'button', class: 'card', 'data-key': key, 'data-kind': card.kind, onclick: () => choose(card) }, board.store.picture(board.text.parse(card.text), path),
        make('span', {}, words.kindNames[card.kind] || card.kind), make('small', {}, words.error((100 * card.part).toPrecision(2) + ' %') + (card.angle === null ? '' : ', ' + words.angle(card.angle.toFixed(0)))));
    }));
  }

  function choose(card) {
    board.load(card.text, card.kind.replace(/[^\w]+/g, '_') + '.nml');
    board.store.keep();
    board.state.dirty = true;
    board.view.canvas.scrollIntoView({ block: 'nearest' });
  }

  return { begin, follow, draw, drawn, even, dimensionsOf, fromTable, fromPicture, get cards() { return cards; }, get running() { return running; } };
})();
