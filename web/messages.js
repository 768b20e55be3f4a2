// Words: what the linkage does at the position shown, what is wrong there, the messages of a case, names of arcs.
'use strict';

balm.messages = (() => {
  const MOST_OUTPUTS = 5;   // of several told in the line of facts
  const { OPEN, between, mixed, modulo, inputAt, prescribedAt, short, shortOutput, explain } = balm.scene;
  const MOST = 3;           // violations told below the picture at a time
  const $ = (id) => document.getElementById(id);

  function setText(element, text) {
    if (element.textContent !== text) element.textContent = text;
  }

  /** The position in one line: input, output, and at a prescribed one the errors. */
  function factsOf(c, t) {
    const p = c.prescribed, s = c.sweep, at = between(c, t), near = prescribedAt(c, t);
    if (c.drives) return (c.time ? 'time ' + timeAt(c, t) + ' s, ' : '') + factsOfDrives(c, at, c.time ? -1 : near);
    const value = (key) => shortOutput(c, near >= 0 ? p[key][near] : mixed(s[key], at));
    const input = near >= 0 ? p.input[near] : c.ring ? modulo(inputAt(c, t), 360) : inputAt(c, t);
    if (c.time) return 'time ' + timeAt(c, t) + ' s, ' + (c.motion === 'point' ? 'x ' + shortOutput(c, mixed(s.actual, at)) + ', y ' +
      shortOutput(c, mixed(s.actual_y, at)) : c.motion + ' ' + shortOutput(c, mixed(s.actual, at)) + (c.motion === 'angle' ? '\u00b0' : ''));
    let text = (c.sliding || c.inputLabel ? 'input ' : 'crank ') + short(input) + (c.sliding ? ', ' : '\u00b0, ');
    if (c.motion === 'point') text += 'x ' + value('actual') + ', y ' + value('actual_y');
    else text += c.motion + ' ' + value('actual') + (c.motion === 'angle' ? '\u00b0' : '');
    if ((near >= 0 ? p.closed[near] : s.closed[at[0]]) === '0') text += ' (does not close)';
    if (near < 0) return text;
    text += ', position ' + (near + 1);
    if (!c.desired) return text;
    if (c.motion === 'point') return text + ', error ' + short(p.error[near]) + ', ' + short(p.error_y[near]);
    return text + ', desired ' + short(p.desired[near]) + ', error ' + short(p.error[near]);
  }

  /** Seconds, to a thousandth of the whole. */
  const timeAt = (c, t) => inputAt(c, t).toFixed(Math.max(0, 3 - Math.floor(Math.log10(c.time))));

  /** The same of a sketch with several drives or outputs. */
  function factsOfDrives(c, at, near) {
    const value = (one) => near >= 0 ? one.prescribed[near] : mixed(one.sweep, at);
    const digits = (v) => short(isFinite(v) ? Number(v.toPrecision(6)) : v);
    const parts = c.drives.map((one) => one.name + ' ' + digits(value(one)) + (one.turning ? '\u00b0' : ''));
    for (const one of c.curves.slice(0, MOST_OUTPUTS)) parts.push(one.name.replace(/, [^,]*$/, '') + ' ' + digits(value(one)) +
      (one.angle ? '\u00b0' : ''));
    if ((near >= 0 ? c.prescribed.closed[near] : c.sweep.closed[at[0]]) === '0') parts.push('does not close');
    if (near >= 0) parts.push('position ' + (near + 1));
    return parts.join(', ');
  }

  /** Facts and what is wrong at t. */
  function show(c, t) {
    const i = between(c, t)[0], wrong = c.wrong[i], open = c.status[i] === OPEN, alert = $('alert');
    setText($('facts'), factsOf(c, t));
    if (c.time) setText($('clock'), timeAt(c, t) + ' of ' + timeAt(c, c.ends[1]) + ' s');
    // its room stays while the linkage moves
    alert.hidden = !c.status.some(Boolean) && !wrong.length;
    alert.style.visibility = wrong.length || open ? '' : 'hidden';
    alert.className = open ? 'open' : 'limits';
    showCaptions(c, t);
    setText(alert, wrong.slice(0, MOST).map((v) => explain(c, v, i)).join(' \u2014 ') || 'Does not close');
  }

  /** Words about the picture, below it. */
  function showCaptions(c, t) {
    const box = $('captions'), list = balm.drawing.captions(c, t);
    box.hidden = !list.length;
    while (box.children.length > list.length) box.lastChild.remove();
    while (box.children.length < list.length) box.append(document.createElement('span'));
    list.forEach(([words, colour], i) => {
      setText(box.children[i], words);
      box.children[i].style.color = colour;
    });
  }

  /** The lists below the picture; a violation leads to its position. */
  function list(c) {
    const box = $('messages');
    box.textContent = '';
    const part = (head, items, kind, fill) => {
      if (!items.length) return;
      const h = document.createElement('h2'), ul = document.createElement('ul');
      h.textContent = head;
      ul.className = kind;
      for (const item of items) {
        const li = document.createElement('li');
        li.append(fill(item));
        ul.append(li);
      }
      box.append(h, ul);
    };
    const plain = (text) => text;
    const goTo = (text, t) => {
      const button = document.createElement('button');
      button.className = 'go';
      button.type = 'button';
      button.textContent = text;
      button.addEventListener('click', () => {
        if (c.limited && !balm.state.whole && t > c.range[1]) $('whole').click();   // it lies beyond the prescribed positions
        balm.controls.go(t);
      });
      return button;
    };
    const link = (violation) => goTo(violation.text, c.at[violation.first]);
    part(c.sound ? 'Errors' : 'The input is wrong; there is no linkage to draw', c.errors, 'error', plain);
    if (c.sound) part('Closure and limits at the prescribed positions', c.prescribed.violations, 'error', link);
    part(c.time ? 'Constraints, end of the motion' : 'Constraints', c.breaches, 'error', plain);
    part('Warnings', c.warnings, 'warning', plain);
    if (c.proof) part('Proven', c.proof.marks, 'proof', mark => 't' in mark ? goTo(mark.text, mark.t) : mark.text);
  }

  /** Name, length and direction of a bar at t. */
  function describe(c, bar, t) {
    const s = c.sweep, at = between(c, t), scale = balm.drawing.scale;
    let dx = (c.px[bar.to] - c.px[bar.from]) / scale, dy = (c.py[bar.from] - c.py[bar.to]) / scale;
    let length = 'barrel' in bar ? Math.hypot(dx, dy) : bar.length;
    if (bar.slide >= 0) {
      const ux = mixed(s.ux[bar.slide], at), uy = mixed(s.uy[bar.slide], at);
      length = dx * ux + dy * uy;
      [dx, dy] = [ux, uy];
    }
    const angle = modulo(Math.atan2(dy, dx) * 180 / Math.PI, 360);
    const link = bar.body >= 0 && c.bodies[bar.body].name;
    return (link ? 'link ' + link : bar.loop ? 'loop ' + bar.loop + ', arc ' + bar.arc : 'output arc') +
      ': length ' + short(Number(length.toPrecision(6))) + ', angle ' + angle.toFixed(2) + '\u00b0' +
      (bar.others ? ' (also ' + bar.others + ')' : '');
  }

  /** The tip at a point of a box of the given width and height; without words it goes. */
  function tip(words, x, y, box) {
    const element = $('tip');
    element.hidden = !words;
    if (!words) return;
    setText(element, words);
    element.style.left = Math.max(4, Math.min(x + 14, box.width - element.offsetWidth - 6)) + 'px';
    element.style.top = Math.min(y + 16, box.height - 30) + 'px';
  }

  return { show, list, describe, tip };
})();
