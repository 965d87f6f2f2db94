// Recordings for the viewer of `stochc replay`: a structure event by event, or a run that is still
// being computed.

/** Position of a block before its capture, outside of the view. */
const AWAY = [0, 0, -1e4, 0, 0, 0, 1];
/** Largest size of a run's frames in memory [bytes]. */
const MEMORY = 64 << 20;

/** Returns classes of recordings that extend the class of the viewer. */
export function recordings({ Recording }) {
  /** Recording whose frames are in memory. */
  class Frames extends Recording {
    constructor(bodies) {
      super();
      Object.assign(this, { bodies, ticks: [], frames: [], events: [], record: { ticks: 0, bonds: [] } });
    }

    has() {
      return this.frames.length > 0;
    }

    async fetch() {}

    reader(frame) {
      const numbers = this.frames[frame];
      return (body, into) => {
        for (let i = 0; i < 7; i++) into[i] = numbers[7 * body + i];
      };
    }
  }

  /** Recording of a structure: tick k is the state after k events. */
  class Steps extends Frames {
    constructor({ about, events }) {
      super(events.filter(({ cell }) => cell).length || 1);
      const { width, depth } = about.tables.plate;
      const corner = [-(width - 1) / 2, -(depth - 1) / 2, -0.5];
      const seeds = new Set(about.tables.blocks.flatMap(({ seed }, role) => (seed ? [role] : [])));
      const holders = new Map();
      const holder = role => holders.get(role) ?? (seeds.has(role) ? -1 - role : 0);
      /** For each block, the event that captures it, its tick, and the place of the block then. */
      this.origin = [];
      this.docked = [];
      this.seats = [];
      let phase = null;
      this.ticks.push(0);
      events.forEach((event, index) => {
        const [before, tick] = [index, index + 1];
        if (event.phase !== phase) this.events.push([before, 'phase', (phase = event.phase)]);
        if (event.cell) {
          const body = this.origin.push(event) - 1;
          const of = holder(event.parent);
          this.events.push([before, 'on', of, event.face, event.parent, event.role, event.cell]);
          this.events.push([tick, 'dock', body, of, event.face, event.role, event.cell]);
          holders.set(event.role, body);
          this.docked.push(tick);
          this.seats.push([...corner.map((from, axis) => from + event.cell[axis]), 0, 0, 0, 1]);
        } else {
          this.events.push([tick, 'free', holder(event.role), event.role, event.role]);
          holders.delete(event.role);
        }
        this.ticks.push(tick);
      });
      this.record.ticks = events.length;
      this.texts = events.map(({ phase, text }) => `phase ${about.tables.phases[phase]?.name}: ${text}`);
    }

    has() {
      return true;
    }

    reader(frame) {
      return (body, into) => {
        const place = frame < this.docked[body] || !this.seats[body] ? AWAY : this.seats[body];
        for (let i = 0; i < 7; i++) into[i] = place[i];
      };
    }
  }

  /** Recording of a run that grows while the run is computed. */
  class Live extends Frames {
    constructor(bodies) {
      super(bodies);
      this.every = 4;
    }

    /** Adds a batch of frames from the engine. */
    push({ tick, ticks, events }, numbers) {
      ticks.forEach((at, i) => {
        this.ticks.push(at);
        this.frames.push(numbers.slice(7 * this.bodies * i, 7 * this.bodies * (i + 1)));
      });
      for (const event of events) this.events.push(event);
      this.record.ticks = tick;
      while (this.frames.length * this.bodies * 28 > MEMORY) {
        const keep = (_, i) => i % 2 === 0;
        this.ticks = this.ticks.filter(keep);
        this.frames = this.frames.filter(keep);
      }
    }
  }

  return { Steps, Live };
}
