// View of the run at a tick.

/**
 * Limits for reporting a block: depth in the floor, and position of its centre relative to the wall [block lengths].
 */
const [SUNK, OUT] = [0.05, -0.5];

class Scene {
  constructor(about, recording, history, painter, labels, camera) {
    Object.assign(this, { about, recording, history, painter, labels, camera });
    const { width, depth } = about.tables.plate;
    // Centre of cell (0, 0, 0). The origin is the centre of the plate's upper side.
    this.corner = [-(width - 1) / 2, -(depth - 1) / 2, -0.5];
    this.seeds = about.tables.blocks.flatMap((block, role) => (block.seed ? [{ body: -1 - role, cell: block.seed }] : []));
    const seeded = new Set(this.seeds.map(({ cell }) => cell.join()));
    this.plain = [];
    // In a planar world, the table is in the place of the plate.
    const columns = about.scene.planar ? 0 : width;
    for (let x = 0; x < columns; x++) for (let y = 0; y < depth; y++) if (!seeded.has([x, y, 0].join())) this.plain.push([x, y, 0]);
    this.places = new Float64Array(7 * recording.bodies);
    this.numbers = new Float32Array(CUBE * (recording.bodies + width * depth));
    this.shell = enclosure(about.shell);
    this.cloud = new Cloud(recording.bodies);
    this.list = new Uint32Array(recording.bodies);
    /** Display of free blocks: 0 is faint, 1 is solid, 2 is hidden. */
    this.clouds = 0;
    this.named = true;
    /** Whether each capture has an arrow. */
    this.arrows = false;
    /** Blocks with a warning sign, and their messages. */
    this.marked = new Map();
    /** Whether cells are shown that are still empty. */
    this.aimed = true;
    this.target = target(about);
    this.selected = null;
    this.tick = 0;
  }

  centre(cell) {
    return add(this.corner, cell);
  }

  /** Returns the centre of a block and its rotation. */
  place(body) {
    if (body < 0) {
      const seed = this.seeds.find(seed => seed.body === body);
      return { centre: this.centre(seed.cell), turn: [0, 0, 0, 1] };
    }
    const at = 7 * body;
    return { centre: [...this.places.subarray(at, at + 3)], turn: [...this.places.subarray(at + 3, at + 7)] };
  }

  /**
   * Returns the depth of a free block in the floor, and the distance of its centre from the wall [block lengths].
   * Negative values are inside.
   */
  depths(body) {
    const [px, py, pz, x, y, z, w] = this.places.subarray(7 * body, 7 * body + 7);
    // Vertical distance from the block's centre to its farthest point.
    const reach = Math.abs(x * z - w * y) + Math.abs(y * z + w * x) + Math.abs(0.5 - x * x - y * y);
    return this.shell ? { sunk: reach - pz, out: this.shell.distance([px, py, pz]) } : { sunk: -1, out: -1 };
  }

  /** Returns descriptions of how far a block is in the floor or outside the wall, and why. */
  beyond(body) {
    const { sunk, out } = this.depths(body);
    const words = [];
    const told = sides => `${sides.toFixed(1)} sides`;
    if (sunk >= SUNK) words.push(`reaches ${told(sunk)} into the floor: contacts give way, and places between two recorded ticks are on a straight line`);
    if (out >= OUT) words.push(`reaches outside of the wall: the wall holds centres of blocks, not their corners, and gives way${out >= 0.05 ? ` (by ${told(out)})` : ''}`);
    return words;
  }

  /** Returns a description of the number of such blocks, or an empty text if there are none. */
  allBeyond() {
    let [floor, shell] = [0, 0];
    for (let body = 0; body < this.recording.bodies; body++) {
      const { sunk, out } = this.depths(body);
      if (sunk >= SUNK) floor++;
      if (out >= OUT) shell++;
    }
    const kinds = [...(floor ? [`${floor} into the floor`] : []), ...(shell ? [`${shell} outside of the wall`] : [])];
    return kinds.length ? `now some blocks reach ${kinds.join(', and ')}: click one to see why` : '';
  }

  /** Moves all blocks to their positions at a tick. Returns `false` if these are not unpacked yet. */
  go(tick) {
    if (!this.recording.has(tick)) return false;
    this.recording.places(tick, this.places);
    this.tick = tick;
    return true;
  }

  /**
   * Draws the view. `scale` is the number of pixels of the picture per pixel of the page, and `sharp` the same for
   * names.
   */
  draw(scale, sharp = devicePixelRatio || 1) {
    const { history, painter, camera, tick } = this;
    const look = THEMES[themeName()];
    painter.fit(scale);
    painter.begin(camera, look.background);
    const { view } = painter;
    const solid = (this.solid = []);
    for (const cell of this.plain) solid.push({ body: null, centre: this.centre(cell), turn: [0, 0, 0, 1], colour: look.plate });
    for (const { body } of this.seeds) solid.push({ body, ...this.place(body), colour: look.seed, named: true });
    let free = 0;
    const groups = history.groups.at(tick);
    const pulled = (this.pulled = new Set(history.pullsAt(tick).map(({ body }) => body)));
    for (let body = 0; body < this.recording.bodies; body++) {
      const hold = history.holdAt(body, tick);
      const size = groups.size(body);
      if (hold) solid.push({ body, ...this.place(body), cell: hold.cell, colour: phaseColour(hold.phase), named: true });
      else if (size > 1) solid.push({ body, ...this.place(body), colour: groupColour(look, size) });
      else if (this.clouds < 2 || pulled.has(body) || body === this.selected) this.list[free++] = body;
    }
    const eye = camera.eye;
    this.free = this.list.subarray(0, free);
    const sight = new Sight(view, eye, painter.canvas.height / (2 * painter.small * Math.tan(camera.angle / 2)));
    this.shown = this.cloud.sort(this.free.filter(body => sight.has(this.places, 7 * body, this.clouds === 0)), this.places, eye);
    const style = { mark: look.mark, pulled: look.lit, edge: look.edge };
    if (this.shell && camera.eye[2] > 0) {
      painter.drawSketch(() => this.shell.ground([...rgb(look.ground), 1]), { opaque: true, name: 'ground', of: themeName() });
    }
    painter.drawCubes(this.numbers, ...this.fillSolid(sight), { opaque: true, ...style });
    this.drawFaces(look);
    if (this.shell) {
      const lines = () => this.shell.wires([...rgb(look.rings), 1], [...rgb(look.shell), 0.45]);
      painter.drawSketch(lines, { lines: true, name: 'wires', of: themeName() });
    }
    this.drawTarget(look);
    painter.drawCubes(this.numbers, ...this.fillFree(pulled, look, sight), { opaque: this.clouds === 1, ...style });
    const seen = bodies => Array.from(bodies, body => ({ body, ...this.place(body) }));
    const chosen = seen(this.free.filter(body => body === this.selected)).map(block => ({ ...block, named: true }));
    const opaque = this.clouds === 1 && this.named ? [...solid, ...seen(this.shown)] : solid;
    const glass = this.clouds === 1 ? [] : seen(this.shown.filter(body => pulled.has(body)));
    const moves = chosen.length > 0 || opaque.length > solid.length || groups.groups.size > 0;
    this.labels.draw(this, view, { blocks: [...solid.filter(({ named }) => named), ...chosen], opaque, glass, moves }, look, sharp);
  }

  /** Returns the blocks of the structure that were captured, with their parents. */
  captures() {
    const blocks = new Map(this.solid.map(block => [block.body, block]));
    return this.solid.flatMap(child => {
      const hold = child.body >= 0 && this.history.holdAt(child.body, this.tick);
      const parent = hold && blocks.get(hold.of);
      return parent ? [{ parent, child }] : [];
    });
  }

  /** Writes the visible opaque blocks for the painter. Returns their number, and the number of them that are small. */
  fillSolid(sight) {
    const seen = this.solid.filter(({ centre }) => sight.has(centre));
    return inTwo(seen, ({ centre }) => sight.isSmall(centre), ({ body, centre, turn, colour }, at) => {
      this.numbers.set(centre, at);
      this.numbers.set(turn, at + 3);
      this.numbers.set(rgb(colour), at + 7);
      this.numbers[at + 10] = 1;
      this.numbers[at + 11] = body !== null && body === this.selected ? 1 : this.marked.has(body) ? 2 : 0;
    });
  }

  /** Writes the visible free blocks in the same way, but faster, because there may be very many. */
  fillFree(pulled, look, sight) {
    const { numbers, places } = this;
    const colour = rgb(look.free);
    return inTwo(this.shown, body => sight.isSmall(places, 7 * body), (body, at) => {
      const from = 7 * body;
      for (let j = 0; j < 7; j++) numbers[at + j] = places[from + j];
      for (let j = 0; j < 3; j++) numbers[at + 7 + j] = colour[j];
      const isPulled = pulled.has(body);
      const isChosen = body === this.selected;
      numbers[at + 10] = this.clouds === 1 ? 1 : isPulled || isChosen ? 0.6 : look.ghost;
      numbers[at + 11] = isChosen ? 1 : isPulled ? 2 : 0;
    });
  }

  /** Draws the faces that are on, with a line from each to the blocks that it pulls. */
  drawFaces(look) {
    const centres = new Map();
    const shapes = new Sketch();
    const threads = new Sketch();
    const red = rgb(look.lit);
    for (const { body, face } of this.history.facesAt(this.tick)) {
      const normal = NORMALS[face];
      const middle = add(this.place(body).centre, times(normal, 0.5));
      centres.set(`${body} ${face}`, middle);
      shapes.square(add(middle, times(normal, 0.012)), normal, 0.46, [...red, 1]);
      // Glow around and above the face.
      shapes.square(add(middle, times(normal, 0.02)), normal, 0.95, [...red, 0.65], [...red, 0]);
      const [u, v] = sides(normal);
      for (const [a, b] of [[u, v], [v, u]]) {
        for (const side of [-1, 1]) {
          const foot = add(middle, times(a, 0.46 * side));
          const [p, q] = [add(foot, times(b, 0.46)), minus(foot, times(b, 0.46))];
          const [far, away] = [add(p, times(normal, 0.7)), add(q, times(normal, 0.7))];
          for (const [place, glow] of [[p, 0.5], [q, 0.5], [away, 0], [p, 0.5], [away, 0], [far, 0]]) shapes.point(place, [...red, glow]);
        }
      }
    }
    for (const { body, of, face } of this.history.pullsAt(this.tick)) {
      const to = centres.get(`${of} ${face}`);
      if (to) threads.line(this.place(body).centre, to, [...rgb(look.lit), 1]);
    }
    this.painter.drawSketch(() => shapes, { opaque: false, graded: true });
    this.painter.drawSketch(() => threads, { lines: true, opaque: true });
  }

  /** Draws the edges of cells in the final structure that are still empty. */
  drawTarget(look) {
    if (!this.aimed) return;
    const edges = () => {
      const taken = new Set(this.solid.map(({ cell }) => cell?.join()));
      const sketch = new Sketch();
      for (const cell of this.target) if (!taken.has(cell.join())) sketch.box(this.centre(cell), 0.46, [...rgb(look.ink), 0.28]);
      return sketch;
    };
    // The structure changes only at events.
    const step = lastAtOrBefore(this.history.steps, this.tick);
    this.painter.drawSketch(edges, { lines: true, name: 'target', of: `${themeName()} ${step}` });
  }

  /**
   * Returns the block at a point of the canvas [px], or `null` if there is none. Names have priority over blocks, and
   * opaque blocks over transparent ones.
   */
  pick(x, y) {
    const named = this.labels.at(x, y);
    if (named !== undefined) return named;
    const { width, height } = this.painter;
    const { origin, direction } = this.camera.ray((2 * x) / width - 1, 1 - (2 * y) / height);
    let [best, found] = [Infinity, null];
    const look = (body, { centre, turn }) => {
      const distance = meets(origin, direction, centre, turn);
      if (distance < best) [best, found] = [distance, body];
    };
    for (const block of this.solid) look(block.body, block);
    if (best === Infinity || this.clouds === 1) for (const body of this.shown) look(body, this.place(body));
    return found;
  }

  /** Returns the position of a point on the canvas [px], or `null` if it is behind the camera. */
  screen(place, view = this.camera.matrix(this.painter.canvas.width, this.painter.canvas.height)) {
    const at = row => view[row] * place[0] + view[4 + row] * place[1] + view[8 + row] * place[2] + view[12 + row];
    const w = at(3);
    if (w <= 0) return null;
    const { width, height } = this.painter;
    return { x: ((at(0) / w + 1) / 2) * width, y: ((1 - at(1) / w) / 2) * height, scale: height / (2 * w * Math.tan(this.camera.angle / 2)) };
  }
}

/**
 * Calls `fill` for the small blocks of a list, then for the others. Returns the number of blocks, and the number of
 * small ones.
 */
function inTwo(list, isSmall, fill) {
  let [far, i] = [0, 0];
  const rest = [];
  for (const block of list) {
    if (isSmall(block)) fill(block, CUBE * far++);
    else rest.push(block);
  }
  for (const block of rest) fill(block, CUBE * (far + i++));
  return [far + i, far];
}
