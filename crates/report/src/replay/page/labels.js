// Names, arrows and axes on sheets above the arena.

class Labels {
  /** `holder` contains the sheets and is as large as the arena. */
  constructor(holder) {
    this.arrows = new Sheet(holder, 'arrows');
    this.names = new Sheet(holder, 'names');
    this.axes = new Sheet(holder, 'axes');
  }

  /** Makes the next drawing start from scratch. */
  forget() {
    this.key = this.around = null;
  }

  /**
   * Draws the names of blocks that are large enough and not hidden by opaque blocks. `glass` are transparent blocks:
   * names behind them are fainter. `moves` states whether any of these blocks moves between ticks.
   */
  draw(scene, view, { blocks, opaque, glass, moves }, look, scale) {
    const { width, height } = scene.painter;
    // Skip drawing if the view and the structure are unchanged.
    const around = `${view.join()} ${width} ${height} ${scale} ${look.ink}`;
    if (around !== this.around) drawAxes(this.axes, scene.camera, { width, height }, scene.about.scene.block.side, look, scale);
    const who = blocks.map(({ body }) => (body === null ? '' : `${body} ${scene.history.nameAt(body, scene.tick)}`));
    const key = `${around} ${scene.named} ${scene.arrows} ${[...scene.marked.keys()]} ${moves ? scene.tick : ''} ${who.join()}`;
    const eye = scene.camera.eye;
    if (key !== this.key) {
      this.shown = visible(scene, view, blocks, opaque, eye);
      drawArrows(this.arrows, scene, view, scene.arrows ? scene.captures() : [], opaque, look, scale);
    }
    const faint = this.shown.map(({ block, middle }) => hidden(middle, block, glass, eye));
    if (key === this.key && faint.join() === this.faint) return;
    Object.assign(this, { around, key, faint: faint.join() });
    const { pen } = this.names;
    for (const name of this.shown) {
      const size = Math.min(22, Math.max(11, name.scale * 0.42));
      pen.font = name.font = `600 ${size}px system-ui, sans-serif`;
      name.half = [pen.measureText(name.text).width / 2 + 2, size / 2 + 2];
    }
    // Leave space for the halo, and for unusually high letters.
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

  /** Draws names, arrows and axes onto a picture that is as large as the arena. */
  paint(pen) {
    this.axes.paint(pen);
    this.arrows.paint(pen);
    this.names.paint(pen);
  }

  /** Returns the block whose name is at a point [px], or `undefined` if there is none. */
  at(x, y) {
    return this.shown.findLast(name => Math.abs(x - name.x) <= name.half[0] && Math.abs(y - name.y) <= name.half[1])?.body;
  }
}

/** Returns the visible names and their positions, the nearest last. */
function visible(scene, view, blocks, opaque, eye) {
  const shown = [];
  const named = blocks.filter(({ named, body }) => named && (scene.named || scene.marked.has(body)));
  for (const block of named) {
    // Only the upper side of a block of the plate is visible.
    const middle = block.body < 0 ? add(block.centre, [0, 0, 0.5]) : block.centre;
    const at = scene.screen(middle, view);
    const isMarked = scene.marked.has(block.body);
    if (!at || at.scale < SMALLEST || (!isMarked && named.length <= MANY && hidden(middle, block, opaque, eye))) continue;
    const name = scene.history.nameAt(block.body, scene.tick);
    shown.push({ block, middle, body: block.body, text: isMarked ? `⚠ ${name}` : name, ...at });
  }
  return shown.sort((a, b) => a.scale - b.scale);
}

/** Returns whether one of the other blocks hides the centre of a block. */
function hidden(middle, block, others, eye) {
  const direction = unit(minus(middle, eye));
  // Touching blocks overlap slightly.
  const surface = meets(eye, direction, block.centre, block.turn) - 0.02;
  return others.some(other => other !== block && meets(eye, direction, other.centre, other.turn) < surface);
}
