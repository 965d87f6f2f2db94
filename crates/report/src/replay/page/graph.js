// Dependency graph next to the arena. Events are highlighted when they happen.

const SVG = 'http://www.w3.org/2000/svg';
/** Distance between neighbouring events [px]. */
const STEP = { x: 92, y: 30 };
const BOX = { width: 78, height: 22 };
/** Largest number of events of a phase whose graph is laid out with few crossings. */
const TIDY = 400;

class Graph {
  /** Calls `jump` with the tick of an event that the reader clicks. */
  constructor(element, history, jump) {
    this.element = element;
    this.history = history;
    this.jump = jump;
    this.phases = history.about.graph.phases;
    this.open = -1;
    this.boxes = new Map();
    this.sections = this.phases.map((phase, number) => {
      const section = document.createElement('details');
      const title = document.createElement('summary');
      const count = document.createElement('span');
      const dot = document.createElement('i');
      dot.style.background = phaseColour(number);
      count.className = 'count';
      title.append(dot, `${number + 1} ${phase.name}`, count);
      section.append(title);
      // Draws only the graph of the open phase.
      section.addEventListener('toggle', () => {
        section.querySelector('svg')?.remove();
        if (section.open) section.append(this.picture(number));
        this.show(this.tick, true);
      });
      element.append(section);
      return { section, count };
    });
  }

  /** Draws the graph of a phase. The column of an event is the length of the longest path to it. */
  picture(number) {
    const { events } = this.phases[number];
    const column = new Map();
    for (const { id } of events) column.set(id, 0);
    for (let round = 0, moved = true; moved && round < events.length; round++) {
      moved = false;
      for (const { id, after } of events) {
        for (const { event, enough } of after) {
          // Another event may fulfil the dependency, and this event may even happen later.
          if (enough) continue;
          if (column.get(event) >= column.get(id)) {
            column.set(id, column.get(event) + 1);
            moved = true;
          }
        }
      }
    }
    const row = rows(events, column);
    const picture = document.createElementNS(SVG, 'svg');
    const [wide, high] = [Math.max(0, ...column.values()), Math.max(0, ...row.values())];
    picture.setAttribute('width', (wide + 1) * STEP.x);
    picture.setAttribute('height', (high + 1) * STEP.y);
    picture.setAttribute('role', 'group');
    const at = id => ({ x: column.get(id) * STEP.x + 2, y: row.get(id) * STEP.y + 4 });
    for (const { id, after } of events) {
      for (const { event, why, enough } of after) {
        const [from, to] = [at(event), at(id)];
        const [x, y, u, v] = [from.x + BOX.width, from.y + BOX.height / 2, to.x, to.y + BOX.height / 2];
        const edge = document.createElementNS(SVG, 'path');
        edge.setAttribute('d', `M${x} ${y}C${x + 12} ${y} ${u - 12} ${v} ${u} ${v}`);
        edge.setAttribute('class', `edge ${why}`);
        const title = document.createElementNS(SVG, 'title');
        title.textContent = enough ? `${why}, ${enough} of these` : why;
        edge.append(title);
        picture.append(edge);
      }
    }
    for (const event of events) {
      const { x, y } = at(event.id);
      const node = document.createElementNS(SVG, 'g');
      node.setAttribute('transform', `translate(${x} ${y})`);
      node.setAttribute('tabindex', '0');
      node.setAttribute('role', 'button');
      const box = document.createElementNS(SVG, 'rect');
      box.setAttribute('width', BOX.width);
      box.setAttribute('height', BOX.height);
      box.setAttribute('rx', event.kind === 'capture' ? 4 : 11);
      const name = document.createElementNS(SVG, 'text');
      name.setAttribute('x', BOX.width / 2);
      name.setAttribute('y', BOX.height / 2 + 4);
      name.textContent = shortened(event.kind === 'capture' ? event.block : `− ${event.block}`, 11);
      const title = document.createElementNS(SVG, 'title');
      title.textContent = event.event;
      node.append(box, name, title);
      const go = () => {
        const deed = this.history.deeds.get(event.id);
        if (deed) this.jump(Number.isFinite(deed.done) ? deed.done : deed.from, event);
      };
      node.addEventListener('click', go);
      node.addEventListener('keydown', press => {
        if (press.key !== 'Enter' && press.key !== ' ') return;
        // The space bar would also scroll the page.
        press.preventDefault();
        go();
      });
      picture.append(node);
      this.boxes.set(event.id, { node, box, name, at: at(event.id) });
    }
    return picture;
  }

  /** Highlights the events that have happened by a tick. */
  show(tick, anew) {
    this.tick = tick;
    const phase = this.history.phaseAt(tick);
    if (phase !== this.open && this.sections[phase]) {
      this.sections.forEach(({ section }, number) => (section.open = number === phase));
      this.open = phase;
    }
    this.phases.forEach(({ events }, number) => {
      let done = 0;
      let latest = null;
      const isOpen = this.sections[number].section.open;
      for (const { id } of events) {
        const state = this.state(id, tick);
        if (state === 'done' || state === 'new') done++;
        const drawn = isOpen && this.boxes.get(id);
        if (!drawn || (drawn.state === state && !anew)) continue;
        drawn.state = state;
        drawn.node.setAttribute('class', state);
        const { colour, ink } = ofPhase(number);
        const happened = state === 'done' || state === 'new';
        drawn.box.style.fill = happened ? colour : '';
        drawn.name.style.fill = happened ? ink : '';
        if (state === 'under-way' || state === 'new') latest = drawn;
      }
      if (latest) this.reveal(latest, number);
      const text = `${done} of ${events.length}`;
      const { count } = this.sections[number];
      if (count.textContent !== text) count.textContent = text;
    });
  }

  /** Scrolls to an event of a phase, unless the reader is using the graph. */
  reveal({ at, node }, number) {
    const { element } = this;
    if (element.matches(':hover') || element.contains(document.activeElement)) return;
    const { section } = this.sections[number];
    if (at.x < section.scrollLeft || at.x + STEP.x > section.scrollLeft + section.clientWidth) section.scrollLeft = at.x - section.clientWidth / 2;
    const top = section.offsetTop + section.firstElementChild.offsetHeight + at.y;
    if (top < element.scrollTop || top + 2 * STEP.y > element.scrollTop + element.clientHeight) element.scrollTop = top - element.clientHeight / 2;
  }

  /** Returns the state of an event: `waiting`, `under-way`, `new` (it happened just now) or `done`. */
  state(id, tick) {
    const deed = this.history.deeds.get(id);
    if (!deed || deed.from > tick) return 'waiting';
    if (deed.done > tick) return 'under-way';
    return tick - deed.done < 25 ? 'new' : 'done';
  }
}

/** Returns a row for every event: the row of a dependency if it is free. */
function rows(events, column) {
  const taken = new Set();
  const row = new Map();
  const ordered = events.length > TIDY ? events : [...events].sort((a, b) => column.get(a.id) - column.get(b.id));
  for (const { id, after } of ordered) {
    const known = after.map(({ event }) => row.get(event)).filter(number => number !== undefined);
    let at = known.length ? Math.min(...known) : 0;
    while (taken.has(`${column.get(id)} ${at}`)) at++;
    taken.add(`${column.get(id)} ${at}`);
    row.set(id, at);
  }
  return row;
}

const shortened = (text, length) => (text.length > length ? `${text.slice(0, length - 1)}…` : text);
