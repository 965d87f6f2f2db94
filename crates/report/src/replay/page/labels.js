// Draws names and axes on sheets above the arena.

/** With more blocks than this in the structure, those in front are not looked for. */
const MANY = 400;

class Labels {
  /** `holder` is where the sheets are, as large as the arena. */
  constructor(holder) {
    this.names = new Sheet(holder, 'names');
    this.axes = new Sheet(holder, 'axes');
  }

  /** Has all be drawn anew. */
  forget() {
    this.key = this.around = null;
  }

  /**
   * Names those of the blocks that have a name, are large enough and are not hidden by what is opaque; `glass` is what lets
   * light through, and makes the names behind it fainter. `moves`: whether some of it does from tick to tick.
   */
  draw(scene, view, { blocks, opaque, glass, moves }, look, scale) {
    const { width, height } = scene.painter;
    // Skips drawing while the view and the structure stay the same.
    const around = `${view.join()} ${width} ${height} ${scale} ${look.ink}`;
    if (around !== this.around) drawAxes(this.axes, scene.camera, { width, height }, scene.about.scene.block.side, look, scale);
    const who = blocks.map(({ body }) => (body === null ? '' : `${body} ${scene.history.nameAt(body, scene.tick)}`));
    const key = `${around} ${scene.named} ${moves ? scene.tick : ''} ${who.join()}`;
    const eye = scene.camera.eye;
    if (key !== this.key) this.shown = visible(scene, view, blocks, opaque, eye);
    const faint = this.shown.map(({ block, middle }) => hidden(middle, block, glass, eye));
    if (key === this.key && faint.join() === this.faint) return;
    Object.assign(this, { around, key, faint: faint.join() });
    const { pen } = this.names;
    for (const name of this.shown) {
      const size = Math.min(22, Math.max(11, name.scale * 0.42));
      pen.font = name.font = `600 ${size}px system-ui, sans-serif`;
      name.half = [pen.measureText(name.text).width / 2 + 2, size / 2 + 2];
    }
    // Leaves space for the halo, and for letters that are higher than most.
    const boxes = this.shown.map(({ x, y, half: [wide, high] }) => [x - wide - 2, y - 2 * high, x + wide + 2, y + 2 * high]);
    this.names.cover(boxes, { width, height }, scale);
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.lineJoin = 'round';
    this.shown.forEach(({ text, x, y, font }, i) => {
      pen.font = font;
      pen.globalAlpha = faint[i] ? 0.5 : 1;
      pen.lineWidth = 3;
      pen.strokeStyle = look.halo;
      pen.strokeText(text, x, y);
      pen.fillStyle = look.ink;
      pen.fillText(text, x, y);
    });
    pen.globalAlpha = 1;
  }

  /** Puts all of it onto a sheet as large as the arena. */
  paint(pen) {
    this.axes.paint(pen);
    this.names.paint(pen);
  }

  /** The block whose name is written at a point [px]; `undefined`: there is none. */
  at(x, y) {
    return this.shown.findLast(name => Math.abs(x - name.x) <= name.half[0] && Math.abs(y - name.y) <= name.half[1])?.body;
  }
}

/** The names that are seen, and where; the nearest come last. */
function visible(scene, view, blocks, opaque, eye) {
  const shown = [];
  const named = scene.named ? blocks.filter(block => block.named) : [];
  for (const block of named) {
    // Only the upper side of a plate's block is visible.
    const middle = block.body < 0 ? add(block.centre, [0, 0, 0.5]) : block.centre;
    const at = scene.screen(middle, view);
    if (!at || at.scale < 13 || (named.length <= MANY && hidden(middle, block, opaque, eye))) continue;
    shown.push({ block, middle, body: block.body, text: scene.history.nameAt(block.body, scene.tick), ...at });
  }
  return shown.sort((a, b) => a.scale - b.scale);
}

/** Whether one of the others is in front of a block, on the way to its middle. */
function hidden(middle, block, others, eye) {
  const direction = unit(minus(middle, eye));
  // Touching blocks overlap slightly.
  const surface = meets(eye, direction, block.centre, block.turn) - 0.02;
  return others.some(other => other !== block && meets(eye, direction, other.centre, other.turn) < surface);
}
