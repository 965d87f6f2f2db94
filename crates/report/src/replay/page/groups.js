// Groups of bonded free blocks, with their sizes.

/** Smallest group size of each colour in the scale. */
const SIZES = [2, 3, 5, 9, 17];

/** Returns the colour of blocks in a group of this size, in a theme. */
const groupColour = (look, size) => look.groups[lastAtOrBefore(SIZES, size)];

/** Division of free blocks into groups. Bonds can be added and removed. */
class Partition {
  constructor() {
    /** For each block, the blocks that it is bonded to. `of` has the group of each block. */
    this.neighbours = new Map();
    this.of = new Map();
    this.groups = new Set();
  }

  size(body) {
    return this.of.get(body)?.length ?? 1;
  }

  get largest() {
    let most = 1;
    for (const { length } of this.groups) if (length > most) most = length;
    return most;
  }

  bond(a, b) {
    for (const [one, other] of [[a, b], [b, a]]) {
      if (!this.neighbours.has(one)) this.neighbours.set(one, new Set());
      this.neighbours.get(one).add(other);
    }
    const [first, second] = [this.of.get(a) ?? [a], this.of.get(b) ?? [b]];
    if (first === second) return;
    const [few, many] = first.length < second.length ? [first, second] : [second, first];
    this.groups.delete(few);
    for (const body of few) many.push(body);
    for (const body of [...few, a, b]) this.of.set(body, many);
    this.groups.add(many);
  }

  unbond(a, b) {
    this.neighbours.get(a)?.delete(b);
    this.neighbours.get(b)?.delete(a);
    const part = this.connected(a);
    const whole = this.of.get(a);
    if (!whole || part.length === whole.length) return;
    const inside = new Set(part);
    this.groups.delete(whole);
    for (const piece of [part, whole.filter(body => !inside.has(body))]) {
      if (piece.length > 1) {
        this.groups.add(piece);
        for (const body of piece) this.of.set(body, piece);
      } else this.of.delete(piece[0]);
    }
  }

  /** Returns a block and all blocks that bonds connect to it. */
  connected(first) {
    const found = [first];
    const known = new Set(found);
    for (const body of found) {
      for (const other of this.neighbours.get(body) ?? []) {
        if (known.has(other)) continue;
        known.add(other);
        found.push(other);
      }
    }
    return found;
  }

  /** Returns the blocks of every group in ascending order, sorted by the lowest number. */
  list() {
    const rising = (a, b) => a - b;
    return [...this.groups].map(group => [...group].sort(rising)).sort((a, b) => a[0] - b[0]);
  }
}

class Groups {
  /** `rows` are all events of the run. */
  constructor(rows) {
    /** Bonds, each with the ticks of its start and end. */
    this.bonds = [];
    /** For each tick with a change: the number of groups and the size of the largest group. */
    this.course = [];
    const held = new Map();
    const partition = new Partition();
    for (const [tick, kind, a, b, face, other, size, otherSize] of rows) {
      if (kind === 'bond') {
        const bond = { from: tick, to: Infinity, a, b, faces: [face, other], size };
        held.set(`${a} ${b}`, bond);
        this.bonds.push(bond);
        partition.bond(a, b);
      } else if (kind === 'unbond') {
        const bond = held.get(`${a} ${b}`);
        if (bond) Object.assign(bond, { to: tick, left: [size, otherSize] });
        partition.unbond(a, b);
      } else continue;
      if (this.course.at(-1)?.tick === tick) this.course.pop();
      this.course.push({ tick, count: partition.groups.size, largest: partition.largest });
    }
    this.ticks = this.course.map(({ tick }) => tick);
    /** Size of the largest group at any tick. `most` is the largest number of groups. */
    this.largest = this.course.reduce((most, { largest }) => Math.max(most, largest), 1);
    this.most = this.course.reduce((most, { count }) => Math.max(most, count), 0);
    this.known = { step: -1, partition: new Partition() };
  }

  /** Returns the groups at a tick. */
  at(tick) {
    // Groups change only at events.
    const step = lastAtOrBefore(this.ticks, tick);
    if (step !== this.known.step) {
      const partition = new Partition();
      for (const { from, to, a, b } of this.bonds) if (from <= tick && tick < to) partition.bond(a, b);
      this.known = { step, partition };
    }
    return this.known.partition;
  }

  /** Returns all bonds of a block during the run. */
  of(body) {
    return this.bonds.filter(({ a, b }) => a === body || b === body);
  }
}

/** Legend with the colours of group sizes and the groups at a tick. Hidden if the run has no bonds. */
class GroupLegend {
  constructor(element, groups) {
    this.element = element;
    this.groups = groups;
    element.hidden = !groups.bonds.length;
    if (element.hidden) return;
    element.append('groups of');
    SIZES.forEach((from, i) => {
      if (from > groups.largest) return;
      const next = SIZES[i + 1];
      const swatch = part('i');
      swatch.style.background = `var(--group-${i})`;
      const words = next === undefined ? `${from} and more` : next === from + 1 ? String(from) : `${from} to ${next - 1}`;
      element.append(swatch, words);
    });
    this.now = part('span');
    element.append(part('br'), this.now);
  }

  show(tick) {
    if (this.element.hidden) return;
    const { groups, largest } = this.groups.at(tick);
    const words = groups.size ? `now ${count(groups.size, 'group')}, the largest of ${largest} blocks` : 'no groups now';
    if (this.now.textContent !== words) this.now.textContent = words;
  }
}
