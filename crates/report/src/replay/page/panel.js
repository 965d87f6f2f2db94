// Panel with the name, the history and the event table of one block.

class Panel {
  constructor(element, history, jump) {
    this.element = element;
    this.history = history;
    this.jump = jump;
    this.key = '';
  }

  /** Shows a block at a tick. `null` is no block. `scene` has the positions at this tick. */
  show(body, tick, scene) {
    const { history } = this;
    const role = body === null ? null : this.roleAt(body, tick);
    // The panel changes only at events.
    const beyond = body === null || body < 0 ? [] : scene.beyond(body);
    const key = `${body} ${role} ${lastAtOrBefore(history.steps, tick)} ${beyond.join()}`;
    if (key === this.key) return;
    this.key = key;
    if (body === null) {
      const hint = part('p', 'hint', 'Click a block to see its name, its history and its event table.');
      this.replace(hint, part('h2', 'small', 'Latest events'), this.latest(tick));
      return;
    }
    const title = part('h2', '', history.nameAt(body, tick));
    const follows = part('p', 'state', this.words(body, tick));
    this.replace(title, follows, ...beyond.map(words => part('p', 'hint', words)), ...this.story(body, tick), ...this.table(role, tick));
  }

  /** Replaces the content of the panel. Keeps the focus on a line, or moves it to the latest line. */
  replace(...parts) {
    const { element } = this;
    const focused = element.contains(document.activeElement) ? document.activeElement.closest('li') : null;
    const top = element.querySelector('.story')?.scrollTop;
    element.replaceChildren(...parts);
    if (!focused) return;
    const lines = [...element.querySelectorAll('li')];
    const line = lines.find(({ textContent }) => textContent === focused.textContent) ?? lines[0];
    line?.querySelector('button').focus({ preventScroll: true });
    if (line) line.parentNode.scrollTop = top;
  }

  /** Returns a list of the latest events of the structure. */
  latest(tick) {
    const rows = this.history.rows.filter(row => row[0] <= tick && this.history.isNotable(row));
    const lines = rows.slice(-40).reverse();
    return this.list(lines.map(row => ({ at: row[0], text: this.history.words(row), kind: row[1] })));
  }

  list(lines) {
    const list = part('ol', 'story');
    for (const { at, text, kind } of lines) {
      const line = part('li', kind);
      const when = part('button', 'tick', String(at));
      when.addEventListener('click', () => this.jump(at));
      line.append(when, ` ${text}`);
      list.append(line);
    }
    return list;
  }

  roleAt(body, tick) {
    if (body < 0) return -1 - body;
    return this.history.holdAt(body, tick)?.role ?? null;
  }

  words(body, tick) {
    const { history } = this;
    if (body < 0) return 'part of the plate from the beginning';
    const hold = history.holdAt(body, tick);
    if (hold) {
      const on = history.nameAt(hold.of, tick);
      return `block ${body}, on ${on}.${hold.face} at (${hold.cell.join(', ')}) since tick ${hold.from}`;
    }
    const pull = history.pullsAt(tick).find(pull => pull.body === body);
    if (pull) return `free, pulled by ${history.nameAt(pull.of, tick)}.${pull.face} since tick ${pull.from}`;
    const group = history.groups.at(tick).of.get(body);
    if (!group) return 'free';
    const others = group.filter(other => other !== body).sort((a, b) => a - b);
    return `free, in a group of ${group.length} with ${others.slice(0, 12).map(other => `block ${other}`).join(', ')}${others.length > 12 ? ' and others' : ''}`;
  }

  /** Returns the history of a block up to a tick, the latest event first. */
  story(body, tick) {
    const { history } = this;
    const lines = [];
    const say = (at, text, kind) => at <= tick && lines.push({ at, text, kind });
    if (body >= 0) {
      for (const { from, to, of, face } of history.pulls.filter(pull => pull.body === body)) {
        const name = history.nameIn(of, from);
        say(from, `enters the reach of ${name}.${face}`, 'in');
        const docks = history.holds[body].some(hold => hold.from === to && hold.of === of && hold.face === face);
        if (!docks && Number.isFinite(to)) say(to, `leaves the reach of ${name}.${face}`, 'out');
      }
      for (const hold of history.holds[body]) {
        const { from, to, role, of, face, bond } = hold;
        const name = history.roles[role];
        const site = `${history.nameIn(of, from)}.${face}`;
        const origin = bond?.origin.kind === 'released' ? `; it was ${history.roles[bond.origin.role]} until ${bond.origin.tick}` : '; it was free from the beginning';
        const wait = bond ? `, ${count(bond.docked - bond.magnetized, 'tick')} after the face was switched on, with ${count(bond.entries, 'entry', 'entries')}` : '';
        say(from, history.isPreAttached(hold) ? `is pre-attached to ${site} as ${name}` : `docks on ${site} as ${name}${wait}${origin}`, 'dock');
        if (Number.isFinite(to)) say(to, `is released as ${name}`, 'free');
      }
    }
    for (const { from, to, a, b, faces, size, left: sizes } of history.groups.of(body)) {
      const [other, own, its] = body === a ? [b, faces[0], faces[1]] : [a, faces[1], faces[0]];
      say(from, `bonds to block ${other}, ${own} to its ${its} and forms a group of ${size}`, 'bond');
      if (sizes) say(to, `parts from ${history.nameIn(other, to)}, and is left ${remainder(sizes[body === a ? 0 : 1]).replace('a group', 'in a group')}`, 'unbond');
    }
    for (const stretch of history.faces.filter(face => face.body === body)) {
      say(stretch.from, `switches ${stretch.face} on for ${history.roles[stretch.child]}`, 'on');
      if (stretch.took) say(stretch.to, `holds ${history.roles[stretch.child]} on ${stretch.face}`, 'dock');
    }
    for (const { tick: at, from, to, what, role } of history.messages) {
      if (from === body) say(at, `sends a message to ${history.nameIn(to, at)}: ${SAID[what](history.roles[role])}`, 'say');
      if (to === body) say(at, `receives a message from ${history.nameIn(from, at)}: ${SAID[what](history.roles[role])}`, 'say');
    }
    const entries = lines.filter(({ kind }) => kind === 'in').length;
    const left = lines.filter(({ kind }) => kind === 'out').length;
    lines.sort((a, b) => b.at - a.at);
    const list = this.list(lines.slice(0, 200));
    const title = body < 0 ? 'History' : `History: entered the reach of a face ${count(entries, 'time')}, left it ${count(left, 'time')}`;
    return [part('h3', '', title), lines.length ? list : part('p', 'hint', 'This block has no events yet.')];
  }

  /** Returns the event table of the role that a block has. */
  table(role, tick) {
    if (role === null) return [];
    const { about, phases } = this.history;
    const now = phases[this.history.phaseAt(tick)];
    const duties = about.tables.blocks[role].duties.map(duty => {
      const body = part('tbody');
      for (const rule of duty.rules) {
        const row = part('tr');
        row.append(part('td', '', rule.when.map(condition).join(' and ') || 'at once'), part('td', '', action(rule.then)));
        body.append(row);
      }
      const table = part('table', duty.phase === now ? 'now' : '');
      const trigger = duty.trigger === 'start' ? 'from its start' : 'once anchored';
      table.append(part('caption', '', `phase ${duty.phase}, ${trigger}`), body);
      return table;
    });
    const title = part('h3', '', `Event table of ${this.history.roles[role]}`);
    return [title, ...(duties.length ? duties : [part('p', 'hint', 'This table has no rules.')])];
  }
}

function condition(when) {
  const [kind, what] = Object.entries(when)[0];
  if (kind !== 'notified') return `${what} ${kind === 'asked' ? 'asks for its release' : kind}`;
  const [event, role] = Object.entries(what)[0];
  return `after the message that ${role} is ${event}`;
}

function action(then) {
  const notification = what => Object.entries(what).map(([kind, role]) => `${role} is ${kind}`)[0];
  const words = {
    magnetize: () => `magnetize ${then.face} for ${then.child}`,
    ask_release: () => 'ask the parent for its release',
    switch_off: () => `switch ${then.face} off and release ${then.child}`,
    notify: () => `send ${then.to} the message that ${notification(then.notification)}`,
    report: () => 'report to the plate',
  };
  return words[then.do] ? words[then.do]() : then.do;
}

const count = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;

/** Returns an element with a text, which is never parsed as HTML. */
function part(tag, name = '', text = '') {
  const made = document.createElement(tag);
  if (name) made.className = name;
  if (text) made.textContent = text;
  return made;
}
