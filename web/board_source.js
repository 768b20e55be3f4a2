// The text of the data set beside the drawing: what changes in one of them changes in the other; mistakes stand at their line.
'use strict';

board.source = (() => {
  const DELAY = 350;             // milliseconds after the last key until a text is taken over
  const LINE = 17;               // pixels from line to line, as in the style sheet
  const MOST_MARKS = 200;
  const { words } = board;
  const $ = (id) => document.getElementById(id);
  let box, numbers, marks, list, back;
  let timer = 0;
  let written = '';              // what the drawing was when it was written here
  let mistake = null;            // of the text that is here: it is not on the board
  let aside = '';                // a text with a mistake, and the drawing has gone on
  let found = [];                // what the engine finds in the text `foundIn`
  let foundIn = '';

  function begin() {
    const { make, button } = board.panel;
    box = make('textarea', { id: 'source', 'aria-label': words.dataSet, spellcheck: 'false', wrap: 'off', autocomplete: 'off' });
    numbers = make('pre', { id: 'numbers', 'aria-hidden': 'true' });
    marks = make('div', { id: 'marks', 'aria-hidden': 'true' });
    list = make('ul', { id: 'faults', role: 'status', 'aria-live': 'polite' });
    back = make('p', { hidden: true }, words.aside + ' ', button(words.backToText, () => { box.value = aside; aside = ''; changed(); }));
    $('text').append(make('p', {}, words.textHint), make('div', { class: 'editor' }, numbers, make('div', { class: 'sheet' }, marks, box)), back, list);
    box.addEventListener('input', () => { clearTimeout(timer); timer = setTimeout(changed, DELAY); number(); });
    box.addEventListener('blur', () => { if (timer) changed(); });
    box.addEventListener('scroll', scroll);
  }

  /** The text was changed: onto the board with it, if it is understood. */
  function changed() {
    clearTimeout(timer);
    timer = 0;
    const text = box.value;
    mistake = null;
    if (text !== board.write()) {
      try {
        board.take(text);
      } catch (error) {
        if (!(error instanceof board.text.Mistake)) throw error;
        mistake = { line: error.line || 0, text: error.message.replace(/^line \d+: /, ''), level: 'error' };
      }
    }
    show();
  }

  /** The drawing was changed: the text follows, unless somebody is typing it. */
  function follow(rough) {
    if (rough || timer) return;
    const now = board.write();
    if (now === box.value) { written = now; show(); return; }
    if (now === written && mistake) return;                // nothing but the selection, or the view, has changed
    if (mistake) aside = box.value;
    written = now;
    mistake = null;
    const { scrollTop, selectionStart } = box;
    box.value = now;
    box.setSelectionRange(selectionStart, selectionStart);
    box.scrollTop = scrollTop;
    show();
  }

  /** What the engine says of a text. */
  function findings(text, all) {
    [found, foundIn] = [all, text];
    show();
  }

  /** Line numbers, marked lines, messages. */
  function show() {
    number();
    const all = faults(), { make } = board.panel;
    back.hidden = !aside;
    marks.replaceChildren(...all.slice(0, MOST_MARKS).filter((one) => one.line).map((one) => {
      const mark = make('div', { class: 'mark ' + one.level });
      mark.style.top = (one.line - 1) * LINE + 'px';
      return mark;
    }));
    list.replaceChildren(...(all.length ? all.slice(0, MOST_MARKS).map((one) => make('li', { class: one.level },
      make('button', { type: 'button', class: 'go', onclick: () => go(one.line) }, words.line(one.line, one.text)))) :
      [make('li', { class: 'good' }, words.understood)]));
    const button = $('tab-text');
    button.classList.toggle('bad', all.some((one) => one.level === 'error'));
    scroll();
  }

  /** The board's own mistake first, then what the engine says of the same text. */
  const faults = () => [...(mistake ? [mistake] : []), ...(foundIn === box.value ? found.filter((one) => one.level !== 'remark') : [])];

  function number() {
    const count = box.value.split('\n').length;
    if (numbers.dataset.count === String(count)) return;
    numbers.dataset.count = String(count);
    numbers.textContent = Array.from({ length: count }, (_, k) => k + 1).join('\n') + '\n';
  }

  function scroll() {
    numbers.scrollTop = box.scrollTop;
    marks.style.transform = 'translateY(' + -box.scrollTop + 'px)';
  }

  /** The caret to a line, and the line into view. */
  function go(line) {
    if (!line) return;
    const lines = box.value.split('\n'), from = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    box.focus();
    box.setSelectionRange(from, from + (lines[line - 1] || '').length);
    box.scrollTop = Math.max(0, (line - 4) * LINE);
    scroll();
  }

  /** An item of a group, as text, in the data set. */
  function setItem(group, item, value) {
    board.take(board.text.changed(board.write(), group, item, value));
  }

  return { begin, follow, findings, setItem, shown: (tab) => { if (tab === 'text') show(); }, get mistaken() { return Boolean(mistake); }, get value() { return box.value; } };
})();
