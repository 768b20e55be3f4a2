// A sketch as text: the NAMELIST notation is read and written. Nothing here knows the document.
//
// A sketch is plain data; joints, links, slides and outputs are referred to by their names:
//   title; joints [{name, x, y}]; links [{name, joints}], the first is the frame; slides [{name, links, x, y, angle}];
//   gears [{wheels, carrier, teeth}]; lengths [{joints, value}]; kover;
//   vary [{of: a dimension as VARY has it, low, high: its bounds, lists of as many numbers as it has; empty: none are given}];
//   drives [{kind: 'turn' | 'slide' | 'cylinder', at (a joint, a slide, or two joints), base, link, ratio, phase, delt}];
//   outputs [{kind, of: words after the kind, name}]; ikin, delt: the positions; crnki
// What the board does not edit stays in `keep`: items by group, as they were written.
'use strict';
globalThis.board = globalThis.board || {};

board.text = (() => {
  const WIDTH = 108;             // columns of a line that is written
  const MOST_VALUES = 1e6;       // of an item
  const TURNS = 720;             // degrees to either side: no bound of an angle
  const KINDS = ['point', 'x', 'y', 'angle', 'distance', 'slide', 'between', 'pose', 'ratio'];
  const NAMING = /^(?!ONAME)\w*NAME$|JNT$|^VARY$|^FREE$|^FOTHER$|^(TOL|AL)NAM$/; // items that name joints or links
  const OWN = {                  // items that a sketch has places for; others are kept
    CHAIN: ['JNT', 'JX', 'JY', 'LNAME', 'LNK', 'NSLIDE', 'SNAME', 'SLNK', 'SLNK2', 'SLX', 'SLY', 'SLANG', 'GEARA', 'GEARB', 'GCARR',
      'GTA', 'GTB', 'LENP', 'LENV', 'KOVER', 'VARY', 'VLOW', 'VHIGH'],
    DRIVES: ['DRIVE', 'DBASE', 'DLINK', 'NDRIVE', 'RATIO', 'PHASE', 'NGRID', 'DLOW', 'DHIGH'],
    OUTPUTS: ['OUTPUT', 'ONAME'],
    METHOD: ['NDES', 'DELT', 'IKIN', 'CRNKI'],
  };

  /** A mistake in a text, with the number of its line. */
  class Mistake extends Error {
    constructor(text, line) {
      super((line ? 'line ' + line + ': ' : '') + text);
      this.line = line;
    }
  }

  // ---- reading ------------------------------------------------------------------------------------------------------

  /** Title and groups of the first case, each with its place in the text; `end` is where a further case begins. */
  function split(text) {
    const lines = text.split('\n'), starts = [];
    lines.reduce((at, line) => { starts.push(at); return at + line.length + 1; }, 0);
    const plain = (line) => /^\s*[^\s!]/.test(line);
    const first = lines.findIndex(plain);
    if (first < 0) throw new Mistake('there is no title');
    const groups = [];
    let at = starts[first] + lines[first].length, end = text.length;
    // places are asked for in their order: one way through the lines does for all
    let known = 0;
    const lineOf = (place) => {
      if (place < starts[known]) known = 0;
      while (known + 1 < starts.length && starts[known + 1] <= place) known++;
      return known + 1;
    };
    while (at < text.length) {
      const from = afterBlanks(text, at);
      if (from >= text.length) break;
      if (!/[&$]/.test(text[from])) { end = text.lastIndexOf('\n', from) + 1; break; }
      const head = /[&$]\s*(\w+)/y;
      head.lastIndex = from;
      const name = head.exec(text);
      if (!name) throw new Mistake('a group has no name', lineOf(from));
      const group = { name: name[1].toUpperCase(), start: from, line: lineOf(from), items: [] };
      at = readItems(text, from + name[0].length, group, lineOf);
      group.end = at;
      groups.push(group);
    }
    return { titleStart: starts[first], title: lines[first].trim(), titleEnd: starts[first] + lines[first].replace(/\r$/, '').length,
      groups, end };
  }

  /** The place after blanks, line ends and comments. */
  function afterBlanks(text, at) {
    const part = /\s+|![^\n]*/y;
    for (;;) {
      part.lastIndex = at;
      const found = part.exec(text);
      if (!found) return at;
      at += found[0].length;
    }
  }

  /** Items and values of a group up to its end; returns the place after it. */
  function readItems(text, at, group, lineOf) {
    const token = /\s+|![^\n]*|&END\b|\$END\b|\/|'[^']*(?:''[^']*)*'|"[^"]*(?:""[^"]*)*"|,|(\w+)\s*(?:(\([^)]{0,99}\))\s*)?=|([^\s,'"!&$/=]+)/giy;
    let item = null, empty = true;
    for (;;) {
      token.lastIndex = at;
      const found = token.exec(text);
      if (!found) throw new Mistake('&' + group.name + ' is not closed, or has a character that does not belong here', lineOf(Math.min(at, text.length - 1)));
      const word = found[0];
      at += word.length;
      if (/^(\s|!)/.test(word)) continue;
      if (/^([&$]END|\/)$/i.test(word)) return at;
      if (found[1] !== undefined) {
        item = { name: found[1].toUpperCase(), place: found[2] || '', values: [], line: lineOf(at), from: at - word.length, to: at };
        group.items.push(item);
        empty = true;
        continue;
      }
      if (!item) throw new Mistake("&" + group.name + ": an item, NAME=, is expected; found '" + word + "'", lineOf(at));
      item.to = at;
      if (word === ',') {
        if (empty) item.values.push('');
        empty = true;
        continue;
      }
      empty = false;
      if (/^['"]/.test(word)) item.values.push(word.slice(1, -1).split(word[0] + word[0]).join(word[0]));
      else {
        const many = /^(\d+)\*(.*)$/.exec(word);
        if (many && item.values.length + Number(many[1]) > MOST_VALUES) throw new Mistake('&' + group.name + ' ' + item.name + ': more than ' + MOST_VALUES + ' values', lineOf(at));
        for (let i = many ? Number(many[1]) : 1; i > 0; i--) item.values.push(many ? many[2] : word);
      }
    }
  }

  /** What the items of a group give: by name, `texts` and `numbers`. */
  function reader(group) {
    const find = (name) => group && group.items.find((item) => item.name === name);
    const texts = (name) => (find(name) || { values: [] }).values;
    const numbers = (name) => texts(name).map((value) => {
      const number = Number(value.replace(/^([-+.\d]*)[dq]/i, '$1e'));
      if (value === '' || !isFinite(number))
        throw new Mistake('&' + group.name + ' ' + name + ": a number is expected; found '" + value + "'", find(name).line);
      return number;
    });
    return { texts, numbers, line: (name) => (find(name) || group || {}).line };
  }

  /** The sketch of the first case of a text. */
  function parse(text) {
    const whole = split(text);
    const groupOf = (name) => whole.groups.find((group) => group.name === name);
    if (!groupOf('CHAIN')) {
      throw new Mistake(groupOf('LINKS') ? 'this data set describes its linkage by loops (&LINKS); the drawing board takes sketches (&CHAIN)' :
        'there is no group &CHAIN');
    }
    for (const name of Object.keys(OWN)) for (const item of (groupOf(name) || { items: [] }).items)
      if (item.place && OWN[name].includes(item.name)) throw new Mistake('&' + name + ' ' + item.name + item.place +
        ': the drawing board reads lists, not single elements', item.line);
    const sketch = { title: whole.title, ...readChain(reader(groupOf('CHAIN'))), keep: {} };
    readDrives(reader(groupOf('DRIVES')), sketch);
    readOutputs(reader(groupOf('OUTPUTS')), sketch);
    readMethod(reader(groupOf('METHOD')), sketch);
    for (const name of Object.keys(OWN)) sketch.keep[name] = (groupOf(name) || { items: [] }).items
      .filter((item) => !OWN[name].includes(item.name) && !(name === 'DRIVES' && /^DELT\d+$/.test(item.name)))
      .map((item) => text.slice(item.from, item.to).replace(/\s*,\s*$/, ''));
    return sketch;
  }

  /** The joints that a text names: words, or one-letter names that run together. */
  function jointsIn(words, names, mistake) {
    return words.trim().split(/\s+/).filter(Boolean).flatMap((word) => {
      if (names.includes(word)) return [word];
      if ([...word].every((letter) => names.includes(letter))) return [...word];
      throw mistake("no joint is called '" + word + "'");
    });
  }

  function readChain({ texts, numbers, line }) {
    const names = texts('JNT').map((name) => name.trim()), x = numbers('JX'), y = numbers('JY');
    const wrong = (item) => (words) => new Mistake('&CHAIN ' + item + ': ' + words, line(item));
    if (!names.length) throw wrong('JNT')('names the joints');
    if (x.length < names.length || y.length < names.length) throw wrong('JX')('places for ' + names.length + ' joints are expected');
    const twice = names.find((name, i) => names.indexOf(name) < i);
    if (twice) throw wrong('JNT')('joint ' + twice + ' is named twice');
    const links = texts('LNK').map((words, i) => ({ name: (texts('LNAME')[i] || String(i + 1)).trim(),
      joints: jointsIn(words, names, wrong('LNK')) }));
    const count = texts('NSLIDE').length ? numbers('NSLIDE')[0] : texts('SLNK').length;
    const known = (name, item) => {
      if (!links.some((link) => link.name === name.trim())) throw wrong(item)("no link is called '" + name + "'");
      return name.trim();
    };
    const slides = Array.from({ length: count }, (_, i) => ({ name: (texts('SNAME')[i] || 'S' + (i + 1)).trim(),
      links: [known(texts('SLNK')[i] || '', 'SLNK'), known(texts('SLNK2')[i] || '', 'SLNK2')],
      x: numbers('SLX')[i], y: numbers('SLY')[i], angle: numbers('SLANG')[i] }));
    const gears = texts('GEARA').map((first, i) => ({ wheels: [known(first, 'GEARA'), known(texts('GEARB')[i] || '', 'GEARB')],
      carrier: known(texts('GCARR')[i] || '', 'GCARR'), teeth: [numbers('GTA')[i], numbers('GTB')[i]] }));
    const lengths = texts('LENP').map((words, i) => ({ joints: jointsIn(words, names, wrong('LENP')), value: numbers('LENV')[i] }));
    const vary = readVary({ texts, numbers }, wrong);
    return { joints: names.map((name, i) => ({ name, x: x[i], y: y[i] })), links, slides, gears, lengths, vary,
      kover: numbers('KOVER')[0] === 1, named: texts('LNAME').length > 0, drives: [], outputs: [] };
  }

  /** How many numbers a dimension is. */
  const numbersOf = (of) => /^place\b/.test(of) ? 2 : 1;

  function readVary({ texts, numbers }, wrong) {
    const all = texts('VARY').map((of) => of.trim()), low = numbers('VLOW'), high = numbers('VHIGH');
    const count = all.reduce((sum, of) => sum + numbersOf(of), 0);
    for (const [item, values] of [['VLOW', low], ['VHIGH', high]]) if ((low.length || high.length) && values.length !== count)
      throw wrong(item)('bounds of ' + count + ' numbers are expected, in the order of VARY');
    let at = 0;
    return all.map((of) => { const from = at; at += numbersOf(of); return { of, low: low.slice(from, at), high: high.slice(from, at) }; });
  }

  /** The larger side of the box round joints. */
  function sizeOf(joints) {
    const xs = joints.map((j) => j.x), ys = joints.map((j) => j.y);
    return Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys)) || 1;
  }

  /** A dimension that has no bounds has wide ones where others have some: lengths by the size of the drawing, angles by two turns. */
  function boundsOf({ of, low, high }, { joints }) {
    if (low.length) return [low, high];
    const size = sizeOf(joints), round = (v) => Number(v.toPrecision(3)), length = [round(size / 50), round(5 * size)], turns = [-TURNS, TURNS];
    const pairs = /^place\b/.test(of) ? [[0, length[1]], turns] : /^(angle|input)\b/.test(of) ? [turns] : [length];
    return [pairs.map((p) => p[0]), pairs.map((p) => p[1])];
  }

  function readDrives({ texts, numbers, line }, sketch) {
    const names = sketch.joints.map((joint) => joint.name);
    const wrong = (words) => new Mistake('&DRIVES DRIVE: ' + words, line('DRIVE'));
    sketch.drives = texts('DRIVE').map((text, i) => {
      const drive = { kind: 'turn', at: [text.trim()], base: (texts('DBASE')[i] || '').trim(), link: (texts('DLINK')[i] || '').trim(),
        ratio: numbers('RATIO')[i] || 0, phase: numbers('PHASE')[i] || 0, delt: i ? numbers('DELT' + (i + 1)) : [] };
      if (texts('NGRID').length) drive.grid = [numbers('NGRID')[i], numbers('DLOW')[i] || 0, numbers('DHIGH')[i] || 0];
      if (sketch.slides.some((slide) => slide.name === drive.at[0])) drive.kind = 'slide';
      else if (!names.includes(drive.at[0])) {
        drive.kind = 'cylinder';
        drive.at = jointsIn(text, names, wrong);
        if (drive.at.length !== 2) throw wrong("'" + text + "' is no joint, no slide and no pair of joints");
      }
      return drive;
    });
  }

  function readOutputs({ texts, line }, sketch) {
    sketch.outputs = texts('OUTPUT').map((text, i) => {
      const words = text.trim().split(/\s+/), kind = words[0].toLowerCase();
      if (!KINDS.includes(kind)) throw new Mistake("&OUTPUTS OUTPUT: '" + words[0] + "' is no output", line('OUTPUT'));
      return { kind, of: words.slice(1), name: texts('ONAME')[i] || '' };
    });
  }

  function readMethod({ numbers }, sketch) {
    sketch.ikin = numbers('IKIN')[0] || 0;
    sketch.crnki = numbers('CRNKI')[0] || 0;
    const count = numbers('NDES')[0] || 0;
    sketch.delt = numbers('DELT').slice(0, count);
    while (sketch.delt.length < count) sketch.delt.push(0);
  }

  // ---- writing ------------------------------------------------------------------------------------------------------

  /** The shortest text that is read as the same number, with a decimal point. */
  function number(value) {
    const text = String(value).replace('e', 'E').replace('E+', 'E');
    return /[.E]/.test(text) ? text.replace(/^(-?\d+)E/, '$1.0E') : text + '.0';
  }

  const quoted = (text) => "'" + text.split("'").join("''") + "'";

  /** A group as text: items are [name, values as text]; long ones go on in further lines. */
  function group(name, items) {
    const lines = [];
    let line = ' &' + name;
    for (const [item, values] of items) {
      const room = line.length + item.length + values.join(',').length;
      if (room > WIDTH && line.trim() !== '&' + name) { lines.push(line); line = ' '; }
      line += ' ' + item + '=';
      values.forEach((value) => {
        if (line.length + value.length + 1 > WIDTH) { lines.push(line); line = '   '; }
        line += value + ',';
      });
    }
    return lines.concat(line.replace(/,$/, '') + ' &END').join('\n');
  }

  const kept = (sketch, name) => (sketch.keep && sketch.keep[name] || []).map((text) => {
    const at = text.indexOf('=');
    return [text.slice(0, at).trim(), [text.slice(at + 1).trim()]];
  });

  /** The groups of a sketch, each as text. */
  function groups(sketch) {
    const { joints, links, slides, gears, lengths, drives, outputs } = sketch;
    const chain = [['JNT', joints.map((j) => quoted(j.name))], ['JX', joints.map((j) => number(j.x))], ['JY', joints.map((j) => number(j.y))]];
    if (sketch.named !== false) chain.push(['LNAME', links.map((l) => quoted(l.name))]);
    chain.push(['LNK', links.map((l) => quoted(l.joints.join(' ')))]);
    if (slides.length) {
      chain.push(['NSLIDE', [String(slides.length)]]);
      if (slides.some((s, i) => s.name !== 'S' + (i + 1))) chain.push(['SNAME', slides.map((s) => quoted(s.name))]);
      chain.push(['SLNK', slides.map((s) => quoted(s.links[0]))], ['SLNK2', slides.map((s) => quoted(s.links[1]))],
        ['SLX', slides.map((s) => number(s.x))], ['SLY', slides.map((s) => number(s.y))], ['SLANG', slides.map((s) => number(s.angle))]);
    }
    if (gears.length) chain.push(['GEARA', gears.map((g) => quoted(g.wheels[0]))], ['GEARB', gears.map((g) => quoted(g.wheels[1]))],
      ['GCARR', gears.map((g) => quoted(g.carrier))], ['GTA', gears.map((g) => number(g.teeth[0]))], ['GTB', gears.map((g) => number(g.teeth[1]))]);
    if (lengths.length) chain.push(['LENP', lengths.map((l) => quoted(l.joints.join(' ')))], ['LENV', lengths.map((l) => number(l.value))]);
    if (sketch.kover) chain.push(['KOVER', ['1']]);
    const vary = sketch.vary || [];
    if (vary.length) chain.push(['VARY', vary.map((one) => quoted(one.of))]);
    if (vary.some((one) => one.low.length)) {
      const bounds = vary.map((one) => boundsOf(one, sketch));
      chain.push(['VLOW', bounds.flatMap((pair) => pair[0].map(number))], ['VHIGH', bounds.flatMap((pair) => pair[1].map(number))]);
    }
    const list = { CHAIN: group('CHAIN', chain.concat(kept(sketch, 'CHAIN'))) };
    list.DRIVES = drives.length ? group('DRIVES', driveItems(sketch).concat(kept(sketch, 'DRIVES'))) : '';
    const wanted = [['OUTPUT', outputs.map((o) => quoted([o.kind, ...o.of].join(' ')))]];
    if (outputs.some((o) => o.name)) wanted.push(['ONAME', outputs.map((o) => quoted(o.name || [o.kind, ...o.of].join('_')))]);
    list.OUTPUTS = outputs.length ? group('OUTPUTS', wanted.concat(kept(sketch, 'OUTPUTS'))) : '';
    const method = [];
    if (sketch.crnki) method.push(['CRNKI', [number(sketch.crnki)]]);
    if (sketch.ikin) method.push(['IKIN', [String(sketch.ikin)]]);
    else if (!drives.some((d) => d.grid)) method.push(['NDES', [String(sketch.delt.length)]], ['DELT', sketch.delt.map(number)]);
    list.METHOD = group('METHOD', method.concat(kept(sketch, 'METHOD')));
    return list;
  }

  function driveItems({ drives }) {
    const items = [['DRIVE', drives.map((d) => quoted(d.at.join(' ')))]];
    if (drives.some((d) => d.base)) items.push(['DBASE', drives.map((d) => d.base ? quoted(d.base) : "' '")]);
    if (drives.some((d) => d.link)) items.push(['DLINK', drives.map((d) => d.link ? quoted(d.link) : "' '")]);
    if (drives.some((d) => d.ratio)) items.push(['RATIO', drives.map((d) => number(d.ratio))]);
    if (drives.some((d) => d.phase)) items.push(['PHASE', drives.map((d) => number(d.phase))]);
    if (drives.some((d) => d.grid)) items.push(['NGRID', drives.map((d) => String((d.grid || [0])[0] || 0))],
      ['DLOW', drives.map((d) => number((d.grid || [0, 0])[1]))], ['DHIGH', drives.map((d) => number((d.grid || [0, 0, 0])[2]))]);
    drives.forEach((d, i) => { if (i && !d.ratio && !d.grid && d.delt.length) items.push(['DELT' + (i + 1), d.delt.map(number)]); });
    return items;
  }

  /** An item as text in which a joint or a link has another name; `letters` are the joints' names, which run together if all are one
      letter. Items that name neither stay as they are. */
  function renameIn(item, text, { kind, from, to, joints }) {
    if (!NAMING.test(item)) return text;
    const word = (one) => one === from ? to : kind === 'joint' && !joints.includes(one) && from.length === 1 && one.includes(from) &&
      [...one].every((letter) => joints.includes(letter)) ? [...one].map((letter) => letter === from ? to : letter).join(to.length > 1 ? ' ' : '') : one;
    return text.replace(/'([^']*)'/g, (_, words) => "'" + words.split(/([\s-]+)/).map(word).join('') + "'");
  }

  /** The data set of a sketch. Of `source`, the text it was read from, everything stays as it was written that has not changed. */
  function write(sketch, source = '') {
    const now = groups(sketch);
    if (!source) return sketch.title + '\n' + Object.values(now).filter(Boolean).join('\n') + '\n &LIMITS TANGLE=80.0 &END\n';
    const whole = split(source), before = groups(parse(source));
    let text = source.slice(0, whole.titleStart) + sketch.title, at = whole.titleEnd;
    const missing = Object.keys(now).filter((name) => now[name] && !whole.groups.some((one) => one.name === name));
    for (const one of whole.groups) {
      const changed = one.name in now && now[one.name] !== before[one.name];
      let part = source.slice(at, one.end);
      if (changed && now[one.name]) part = source.slice(at, one.start).replace(/[ \t]+$/, '') + now[one.name];
      else if (changed) part = '';
      else if (!(one.name in now)) part = renamed(source, at, one, sketch.renamed || []);
      text += part;
      if (one.name === 'CHAIN') for (const name of missing) text += '\n' + now[name];
      at = one.end;
    }
    return text + source.slice(at);
  }

  /** A group that the board does not edit, with what stands before it, and with the names that joints and links have now. */
  function renamed(source, at, group, renames) {
    let text = '';
    for (const item of group.items) {
      text += source.slice(at, item.from) + renames.reduce((part, one) => renameIn(item.name, part, one), source.slice(item.from, item.to));
      at = item.to;
    }
    return text + source.slice(at, group.end);
  }

  /** Where a group of the first case stands in a text, with its items; nothing if there is none. */
  const placeOf = (text, name) => split(text).groups.find((one) => one.name === name);

  /** Where the last group of the first case ends. */
  const endOf = (text) => { const { groups: all } = split(text); return all.length ? all.at(-1).end : text.length; };

  /** A text in which a group, or one item of it, is another; a group that is not there comes last of its case. */
  function changed(text, name, item, value) {
    const place = placeOf(text, name), there = place && place.items.find((one) => one.name === item);
    if (there) return text.slice(0, there.from) + item + '=' + value + (/,\s*$/.test(text.slice(there.from, there.to)) ? ',' : '') + text.slice(there.to);
    const head = ' &' + name + ' ';
    if (place) return text.slice(0, place.start) + head.trimStart() + item + '=' + value + ',' + text.slice(place.start + 1 + name.length);
    const { groups: all } = split(text), last = all.length ? all.at(-1).end : text.length;
    return text.slice(0, last) + '\n' + head + item + '=' + value + ' &END' + text.slice(last);
  }

  return { TURNS, Mistake, parse, write, sizeOf, renameIn, groups, number, jointsIn, placeOf, endOf, changed };
})();
