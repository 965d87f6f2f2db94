// A run as it stands, in the places of a recording and its history.

/** A recording of a single tick. */
class PresentPlaces extends Recording {
  constructor(bodies) {
    super();
    this.bodies = bodies;
    this.begins = [0];
  }

  /** Takes the places of a frame. */
  take({ tick, corner, step, numbers }) {
    const bytes = Uint8Array.from(atob(numbers), letter => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    this.ticks = [tick];
    this.chunks = [{ ticks: [tick], corner, step }];
    this.cache = new Map([[0, { numbers: Uint16Array.from({ length: 7 * this.bodies }, (_, i) => view.getUint16(2 * i, true)) }]]);
  }
}

/** What the structure does at that tick, and nothing of before. */
class Present {
  constructor(about) {
    this.roles = about.tables.blocks.map(block => block.name);
    this.phases = about.tables.phases.map(phase => phase.name);
    // Target cells are drawn anew when the structure changes, which the scene sees by the number of steps.
    this.steps = [];
    this.seen = '';
    this.take({ held: [], active: [], in_reach: [], bonds: [] });
  }

  take({ held, active, in_reach, bonds }) {
    this.held = new Map(held.map(([body, role, cell, phase]) => [body, { role, cell, phase }]));
    this.active = active.map(([body, face]) => ({ body, face }));
    this.groups = new Groups(bonds.map(([a, b]) => [0, 'bond', a, b]));
    this.near = in_reach.map(([body, of, face]) => ({ body, of, face }));
    const cells = held.map(([, , cell]) => cell.join()).join(' ');
    if (cells !== this.seen) this.steps.push(0);
    this.seen = cells;
  }

  holdAt(body) {
    return this.held.get(body);
  }

  facesAt() {
    return this.active;
  }

  pullsAt() {
    return this.near;
  }

  nameAt(body) {
    if (body < 0) return this.roles[-1 - body];
    const hold = this.held.get(body);
    return hold ? this.roles[hold.role] : `block ${body}`;
  }
}
