// Files of other programs - drawings, sketches of FreeCAD, linkages of pylinkage and PMKS+ - as sketches; the server reads them.
'use strict';

board.imports = (() => {
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  const MOST = 5 << 20;                  // bytes of a file; in a request they are a third more

  function file(one) {
    if (!board.engine.served) { board.wrong(words.importServed(one.name)); return; }
    if (one.size > MOST) { board.wrong(words.importLarge(one.name, MOST >> 20)); return; }
    const reader = new FileReader();
    reader.addEventListener('load', () => ask({ name: one.name, content: reader.result.replace(/^[^,]*,?/, '') }));
    reader.addEventListener('error', () => board.wrong(words.importUnread(one.name)));
    reader.readAsDataURL(one);
  }

  /** A link of PMKS+ that is pasted. */
  const link = (text) => { if (board.engine.served) ask({ name: text }); else board.wrong(words.importServed(words.importLink)); };

  /** What the server makes of it: the sketch, with what was assumed; or what is missing is asked for. */
  async function ask(given) {
    const got = await board.engine.ask('import', JSON.stringify(given));
    if (got.stale) return;
    if (got.text === undefined) { missing(given, got.error); return; }
    $('dialog').close();
    if (!board.attempt(got.text, given.name.startsWith('http') ? 'sketch.nml' : given.name.replace(/\.[^.]*$/, '') + '.nml')) return;
    board.state.dirty = true;
    board.store.keep();
    board.panel.turnTo('text');
  }

  /** The joints of the frame and the drive, where the file does not say which they are. */
  function missing(given, error) {
    const { make, row, button } = board.panel, dialog = $('dialog');
    const field = (label, value) => make('input', { 'aria-label': label, value, spellcheck: 'false', autocomplete: 'off' });
    const fixed = field(words.importFixed, given.fixed || ''), drive = field(words.importDrive, given.drive || '');
    const again = () => ask({ ...given, fixed: fixed.value.trim(), drive: drive.value.trim() });
    for (const one of [fixed, drive]) one.addEventListener('keydown', (event) => { if (event.key === 'Enter') again(); });
    dialog.className = 'link';
    dialog.replaceChildren(make('h2', {}, words.importHead), make('p', { class: 'wrong', role: 'alert' }, error), make('p', {}, words.importHint),
      row(words.importFixed, fixed), row(words.importDrive, drive),
      make('div', { class: 'row' }, button(words.importAgain, again, { class: 'main' }), button(words.close, () => dialog.close())));
    if (!dialog.open) dialog.showModal();
    fixed.focus();
  }

  return { file, link };
})();
