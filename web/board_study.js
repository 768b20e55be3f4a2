// Studies that the groups of a data set ask for, each in a process of its own: the listing as the programs write it, and the linkages found,
// one of which becomes the sketch.
'use strict';

board.study = (() => {
  const EVERY = 300;                     // milliseconds between two questions
  const { words } = board;
  const parts = {};
  let running = '', about = '', stopping = false;

  /** The part below the results. */
  function part() {
    const { make, head, button } = board.panel;
    parts.verb = make('select', { 'aria-label': words.studies }, ...Object.entries(words.studyNames).map(([verb, [name, groups]]) => new Option(groups ? name + ' (' + groups + ')' : name, verb)));
    parts.run = button(words.run, run, { id: 'run-study' });
    parts.stop = button(words.searchStop, stop, { id: 'stop-study', 'aria-label': words.studyStop });
    parts.doing = make('p', { role: 'status' });
    parts.told = make('p', { class: 'wrong', role: 'alert' });
    parts.listing = make('pre', { class: 'listing', tabindex: '0', 'aria-label': words.listing, hidden: true });
    parts.sheet = make('div', { class: 'cards' });
    parts.stop.disabled = true;
    return make('div', { class: 'study' }, head(words.studies), make('p', {}, words.studyHint), make('div', { class: 'row' }, parts.verb), make('div', { class: 'list' }, parts.run, parts.stop),
      parts.doing, parts.told, parts.listing, parts.sheet);
  }

  function follow() {
    if (!parts.listing) return;
    parts.listing.classList.toggle('old', Boolean(about) && about !== board.write());
  }

  async function run() {
    const verb = parts.verb.value;
    parts.told.textContent = '';
    parts.run.disabled = true;
    about = board.write();
    const got = await board.engine.ask('run', JSON.stringify({ verb, case: about }));
    if (got.error) { over(); parts.told.textContent = got.error; return; }
    parts.listing.hidden = true;
    parts.sheet.replaceChildren();
    running = got.search;
    stopping = false;
    parts.stop.disabled = false;
    parts.doing.textContent = words.studying(words.studyNames[verb][0]);
    watch(running, 0);
  }

  async function watch(name, after) {
    const got = await board.engine.ask('search/' + name + '?after=' + after);
    if (running !== name) return;
    for (const one of got.events || []) {
      if (one.made) parts.doing.textContent = words.progress(one.made, one.most, one.best);
      if (one.error) parts.told.textContent = one.error;
      if (one.done) show(one);
    }
    if (got.error) parts.told.textContent = got.error;
    if (got.running) { setTimeout(() => watch(name, after + got.events.length), EVERY); return; }
    over();
  }

  function over() {
    running = '';
    parts.run.disabled = false;
    parts.stop.disabled = true;
    parts.doing.textContent = '';
  }

  function stop() {
    if (!running || stopping) return;
    stopping = true;
    parts.stop.disabled = true;
    board.engine.ask('search/' + running + '/stop', '');
  }

  function show({ listing, findings = [], cases = [] }) {
    const { make } = board.panel;
    parts.listing.textContent = [listing || '', ...findings.map((one) => words.line(one.line, one.text))].join('\n').trim();
    parts.listing.hidden = !parts.listing.textContent;
    const sketches = cases.map((one) => {
      try { return [one, board.text.parse(one.text)]; } catch (error) {
        if (!(error instanceof board.text.Mistake)) throw error;
        return null;                     // a linkage of loops is not drawn here; it is in the listing
      }
    }).filter(Boolean);
    parts.sheet.replaceChildren(...sketches.map(([one, sketch]) => make('button', { type: 'button', class: 'card', onclick: () => choose(one.text) },
      board.store.picture(sketch), make('span', {}, one.title))));
    follow();
  }

  function choose(text) {
    board.load(text, board.state.file);
    board.state.dirty = true;
    board.store.keep();
    board.view.canvas.scrollIntoView({ block: 'nearest' });
  }

  return { part, follow, get running() { return running; } };
})();
