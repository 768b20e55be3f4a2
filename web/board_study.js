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
    parts.proposal = make('div');
    parts.verb.addEventListener('change', () => showProposal());
    parts.stop.disabled = true;
    return make('div', { class: 'study' }, head(words.studies), make('p', {}, words.studyHint), make('div', { class: 'row' }, parts.verb), make('div', { class: 'list' }, parts.run, parts.stop),
      parts.doing, parts.told, parts.proposal, parts.listing, parts.sheet);
  }

  function follow() {
    if (!parts.listing) return;
    parts.listing.classList.toggle('old', Boolean(about) && about !== board.write());
  }

  // ---- groups that are proposed ---------------------------------------------------------------------------------------

  const CAM_SWING = 30, CAM_RISE = 120, CAM_DWELL = 60;  // degrees: of the crank, of the cam for each way, of the cam at rest
  const WAY = 0.8;                       // of the way to a dead point
  const PARTS = { roller: 0.2, centre: 1.2, reach: 0.4, longest: 1, shortest: 0.1 };   // of the crank, of the size

  const round = (value) => board.text.number(Number(value.toPrecision(3)));
  const nameOf = (...words) => "'" + words.join(' ') + "'";

  /** What stands in place of a group that the text has not: a sensible beginning from the sketch; `why` where there is none. */
  function proposed(verb, text) {
    const { sketch, motion } = board.state, group = { springs: 'SPRNGS', balance: 'BALANC', cams: 'CAM' }[verb];
    if (!group || board.text.placeOf(text, group)) return {};
    if (!motion.sweep || board.free() !== 1) return { why: words.proposalMoves };
    const frame = sketch.links[0], size = board.text.sizeOf(sketch.joints);
    const mounted = sketch.links.slice(1).flatMap((link) => { const at = link.joints.find(board.inFrame); return at && link.joints.length > 1 ? [{ link, at }] : []; });
    const drive = sketch.drives[0], driven = mounted.find(({ link, at }) => drive.kind === 'turn' && drive.at[0] === at && (!drive.link || drive.link === link.name));
    if (verb === 'cams') {
      if (!driven) return { why: words.proposalCrank };
      const end = board.jointOf(driven.link.joints.find((name) => name !== driven.at)), pivot = board.jointOf(driven.at), dx = end.x - pivot.x, dy = end.y - pivot.y;
      // as far as it goes; the cam stands square to the crank in the middle of its swing
      const { ring, states } = motion.sweep, [back, forth] = ring ? [-360, 360] : [states[0], states.at(-1)].map((one) => one.inputs[0] * 180 / Math.PI);
      const swing = Number((forth >= -back || forth >= CAM_SWING ? Math.min(CAM_SWING, WAY * forth) : Math.max(-CAM_SWING, WAY * back)).toPrecision(3));
      const half = swing / 2 * Math.PI / 180, [mx, my] = [dx * Math.cos(half) - dy * Math.sin(half), dy * Math.cos(half) + dx * Math.sin(half)], long = Math.hypot(dx, dy);
      return { text: ' &CAM KOUT=0, SEGEND=' + [CAM_RISE, CAM_RISE + CAM_DWELL, 2 * CAM_RISE + CAM_DWELL, 360].map(board.text.number).join(',') + ', SEGOUT=' +
        [swing, swing, 0, 0].map(board.text.number).join(',') + ", LAW='MODSINE','DWELL','MODSINE','DWELL',\n  FOLJNT=" + nameOf(end.name) + ', RROLL=' + round(PARTS.roller * long) +
        ', XCAM=' + round(pivot.x + mx + PARTS.centre * my) + ', YCAM=' + round(pivot.y + my - PARTS.centre * mx) + ' &END' };
    }
    if (!['MASSES', 'PLATES', 'LOADS'].some((name) => board.text.placeOf(text, name))) return { why: words.proposalMasses };
    if (!mounted.length) return { why: words.proposalMounted };
    if (verb === 'balance') return { text: ' &BALANC NWEIGH=' + mounted.length + ', WNAME=' + mounted.map(({ link, at }) => nameOf(link.name, at)).join(',') + ', WREACH=' + round(PARTS.reach * size) + ' &END' };
    const { link, at } = driven || mounted[0];
    return { text: ' &SPRNGS NSFIND=1, PNAME=' + nameOf(frame.name, at) + ', QNAME=' + nameOf(link.name, at) + ', PREACH=' + round(PARTS.reach * size) + ', QREACH=' + round(PARTS.reach * size) +
      ',\n  SFLOW=' + round(PARTS.shortest * size) + ', SFHIGH=' + round(PARTS.longest * size) + ", SCRIT='RMS' &END" };
  }

  /** A text with one group more, the last of its first case. */
  const withGroup = (text, group) => { const end = board.text.endOf(text); return text.slice(0, end) + '\n' + group + text.slice(end); };

  function showProposal(text, why = '') {
    const { make, button } = board.panel;
    parts.proposal.replaceChildren(...(why ? [make('p', { class: 'wrong', role: 'alert' }, why)] : text ? [make('p', {}, words.proposal), make('pre', { class: 'listing', tabindex: '0', 'aria-label': words.proposalLabel }, text),
      button(words.proposalTake, () => { board.take(withGroup(board.write(), text)); parts.proposal.replaceChildren(); board.panel.turnTo('text'); })] : []));
  }

  async function run() {
    const verb = parts.verb.value, now = board.write(), { text, why } = proposed(verb, now);
    parts.told.textContent = '';
    showProposal(text, why);
    if (why) return;
    parts.run.disabled = true;
    about = now;
    const got = await board.engine.ask('run', JSON.stringify({ verb, case: text ? withGroup(now, text) : now }));
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
