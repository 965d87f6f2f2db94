// Events of the run as time intervals. The view at a tick depends only on the tick.

const NORMALS = {
  east: [1, 0, 0], west: [-1, 0, 0], north: [0, 1, 0], south: [0, -1, 0], up: [0, 0, 1], down: [0, 0, -1],
};

class History {
  /** `about` is the data about the program, and `recording` the recording of the run. */
  constructor(about, recording) {
    this.about = about;
    this.end = recording.record.ticks;
    this.roles = about.tables.blocks.map(block => block.name);
    this.phases = about.tables.phases.map(phase => phase.name);
    this.rows = recording.events;
    /** Beginning of each phase. */
    this.begins = [];
    /** For each free block, the intervals during which it is part of the structure, with its role. */
    this.holds = Array.from({ length: recording.bodies }, () => []);
    /** Intervals during which faces are on. */
    this.faces = [];
    /** Intervals during which blocks are within reach of a face. */
    this.pulls = [];
    /** Messages, and reports that the plate has counted. */
    this.messages = [];
    /** For each event of the graph, the tick when it became possible and the tick when it happened. */
    this.deeds = new Map();
    /** Bonds between free blocks. */
    this.groups = new Groups(this.rows);
    this.turns = deedsByWhat(about.graph);
    this.read(recording.record);
    this.stops = [...new Set(this.rows.filter(row => this.isNotable(row)).map(row => row[0]))];
    this.steps = [...new Set(this.rows.map(row => row[0]))];
  }

  read({ bonds: kept, aborts = [] }) {
    const bonds = [...kept, ...aborts.flatMap(abort => abort.bonds)].sort((a, b) => a.docked - b.docked);
    const on = new Map();
    const near = new Map();
    let phase = 0;
    let bond = 0;
    const face = (body, name) => `${body} ${name}`;
    for (const row of this.rows) {
      const [tick, kind] = row;
      if (kind === 'phase') {
        phase = row[2];
        const abort = aborts.find(({ retried }) => retried === tick);
        if (abort) this.begin(phase, abort.tick);
        this.begins.push({ from: tick, phase });
      } else if (kind === 'on') {
        const [, , body, name, by, child, cell] = row;
        const deed = this.turn(`capture ${phase} ${this.roles[by]} ${name} ${this.roles[child]}`);
        const stretch = { from: tick, to: Infinity, body, face: name, by, child, cell, phase, deed };
        this.faces.push(stretch);
        on.set(face(body, name), stretch);
        if (deed !== undefined) this.deeds.set(deed, { from: tick, done: Infinity });
      } else if (kind === 'in') {
        const [, , body, of, name] = row;
        const pull = { from: tick, to: Infinity, body, of, face: name };
        this.pulls.push(pull);
        near.set(`${body} ${face(of, name)}`, pull);
      } else if (kind === 'out') {
        const [, , body, of, name] = row;
        const pull = near.get(`${body} ${face(of, name)}`);
        if (pull) pull.to = tick;
      } else if (kind === 'dock') {
        const [, , body, of, name, role, cell] = row;
        const stretch = on.get(face(of, name));
        if (stretch) {
          stretch.to = tick;
          stretch.took = true;
          if (stretch.deed !== undefined) this.deeds.get(stretch.deed).done = tick;
        }
        for (const pull of this.pulls) if (pull.body === body && pull.to > tick) pull.to = tick;
        this.holds[body].push({ from: tick, to: Infinity, role, cell, of, face: name, phase, bond: bonds[bond++] });
      } else if (kind === 'free') {
        const [, , body, role] = row;
        const hold = this.holds[body].at(-1);
        if (hold) hold.to = tick;
        // Releasing a block also switches off its open faces.
        for (const stretch of this.faces) if (stretch.body === body && stretch.to > tick) stretch.to = tick;
        const deed = this.turn(`release ${phase} ${this.roles[role]}`);
        if (deed !== undefined) this.deeds.set(deed, { from: tick, done: tick });
      } else if (kind === 'say') {
        this.messages.push({ tick, from: row[2], to: row[3], what: row[4], role: row[5] });
      } else if (kind === 'report') {
        this.messages.push({ tick, to: null, what: 'counted', role: row[2] });
      }
    }
  }

  /** Begins an aborted phase again. Its open faces were switched off at the tick `stopped`. */
  begin(phase, stopped) {
    for (const stretch of this.faces) if (stretch.to === Infinity) stretch.to = stopped;
    for (const [what, deeds] of deedsByWhat(this.about.graph)) {
      if (what.split(' ')[1] === String(phase)) this.turns.set(what, deeds);
    }
  }

  /** Returns whether buttons and keys stop at an event. In an aggregate, they also stop at bonds. */
  isNotable([, kind]) {
    return NOTABLE.has(kind) || (Boolean(this.about.tables.aggregate) && BONDS.has(kind));
  }

  /** Returns the next event of the graph that an observed action can belong to. */
  turn(what) {
    return this.turns.get(what)?.shift();
  }

  phaseAt(tick) {
    const begun = this.begins.filter(({ from }) => from <= tick);
    return begun.length ? begun.at(-1).phase : 0;
  }

  /**
   * Returns the time a free block is part of the structure, as an interval around a tick. Returns `undefined` if it
   * is free at this tick.
   */
  holdAt(body, tick) {
    return this.holds[body]?.find(({ from, to }) => from <= tick && tick < to);
  }

  /** Returns whether a block is pre-attached rather than captured. */
  isPreAttached({ phase }) {
    return Boolean(this.about.tables.phases[phase]?.pre_attached);
  }

  facesAt(tick) {
    return this.faces.filter(({ from, to }) => from <= tick && tick < to);
  }

  pullsAt(tick) {
    return this.pulls.filter(({ from, to }) => from <= tick && tick < to);
  }

  /** Returns the name of a block at a tick. */
  nameAt(body, tick) {
    if (body < 0) return this.roles[-1 - body];
    const hold = this.holdAt(body, tick);
    return hold ? this.roles[hold.role] : `block ${body}`;
  }

  /** Returns the name of a block in an event. A block that is released at this tick still has its name. */
  nameIn(body, tick) {
    if (body < 0 || this.holdAt(body, tick)) return this.nameAt(body, tick);
    const last = this.holds[body].find(({ to }) => to === tick);
    return last ? this.roles[last.role] : `block ${body}`;
  }

  /** Returns a description of an event. */
  words(row) {
    const [tick, kind] = row;
    const name = body => this.nameIn(body, tick);
    if (kind === 'phase') return `phase ${this.phases[row[2]]} begins`;
    if (kind === 'on') return `${name(row[2])}.${row[3]} on, for ${this.roles[row[5]]}`;
    if (kind === 'in') return `block ${row[2]} comes into reach of ${name(row[3])}.${row[4]}`;
    if (kind === 'out') return `block ${row[2]} leaves the reach of ${name(row[3])}.${row[4]}`;
    if (kind === 'dock') return this.docking(row, `${name(row[3])}.${row[4]}`);
    if (kind === 'bond') return `${name(row[2])} and ${name(row[3])} bond, ${row[4]} to ${row[5]}: a group of ${row[6]}`;
    if (kind === 'unbond') return `${name(row[2])} and ${name(row[3])} part, ${row[4]} from ${row[5]}: ${remainder(row[6])} and ${remainder(row[7])}`;
    if (kind === 'free') return `${this.roles[row[4]]} releases ${this.roles[row[3]]}: block ${row[2]}`;
    if (kind === 'shed') return `${this.roles[row[5]]}.${row[4]} rejects block ${row[2]}, which is not expected there`;
    if (kind === 'say') return `${name(row[2])} to ${name(row[3])}: ${SAID[row[4]](this.roles[row[5]])}`;
    return `the plate counts the report of ${this.roles[row[2]]}`;
  }

  /** Returns a description of the attachment of a block to the structure. */
  docking([tick, , body, , , role], site) {
    const hold = this.holds[body].find(({ from }) => from === tick);
    const name = this.roles[role];
    return this.isPreAttached(hold) ? `${name} is pre-attached to ${site}: block ${body}` : `${site} captures ${name}: block ${body}`;
  }
}

/** Kinds of events that the buttons and keys stop at. */
const NOTABLE = new Set(['phase', 'on', 'dock', 'shed', 'free']);
const BONDS = new Set(['bond', 'unbond']);

/** Returns a description of the rest of a group. */
const remainder = size => (size > 1 ? `a group of ${size}` : 'a single block');

const SAID = {
  report: role => `${role} is done`,
  ask: role => `${role} asks for its release`,
  anchored: role => `${role} is anchored`,
  released: role => `${role} is released`,
};

/** Returns the events of the graph by action, in source order. Several events may have the same action. */
function deedsByWhat(graph) {
  const deeds = new Map();
  graph.phases.forEach((phase, number) => {
    for (const event of phase.events) {
      const what =
        event.kind === 'capture'
          ? `capture ${number} ${event.parent} ${event.face} ${event.block}`
          : `release ${number} ${event.block}`;
      if (!deeds.has(what)) deeds.set(what, []);
      deeds.get(what).push(event.id);
    }
  });
  return deeds;
}
