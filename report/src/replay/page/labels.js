// Names, on a sheet above the arena.

/** With more blocks than this in the structure, those in front are not looked for. */
const MANY = 400;

class Labels {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d');
  }

  /**
   * Names those of the blocks that have a name, are large enough and are not hidden by what is opaque; `glass` is what lets
   * light through, and makes the names behind it fainter.
   */
  draw(scene, view, blocks, opaque, glass, look, scale) {
    const { canvas, pen } = this;
    const { width, height } = scene.painter;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
    }
    // While the view, the structure and what is in front of it are the same, so are the names.
    const who = blocks.map(({ body }) => (body === null ? '' : `${body} ${scene.history.nameAt(body, scene.tick)}`));
    const moves = glass.length || opaque.length > blocks.length ? scene.tick : '';
    const key = `${view.join()} ${width} ${height} ${scale} ${scene.named} ${scene.selected} ${moves} ${look.ink} ${who.join()}`;
    if (key === this.key) return;
    this.key = key;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.shown = [];
    const named = scene.named ? blocks.filter(block => block.named) : [];
    const eye = scene.camera.eye;
    for (const block of named) {
      // Of a block of the plate only the upper side is seen.
      const middle = block.body < 0 ? add(block.centre, [0, 0, 0.5]) : block.centre;
      const at = scene.screen(middle, view);
      if (!at || at.scale < 13 || (named.length <= MANY && hidden(middle, block, opaque, eye))) continue;
      const faint = hidden(middle, block, glass, eye);
      this.shown.push({ body: block.body, text: scene.history.nameAt(block.body, scene.tick), far: at.scale, faint, ...at });
    }
    // The nearest are written last.
    this.shown.sort((a, b) => a.far - b.far);
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.lineJoin = 'round';
    for (const name of this.shown) {
      const { text, x, y } = name;
      const size = Math.min(22, Math.max(11, name.scale * 0.42));
      pen.font = `600 ${size}px system-ui, sans-serif`;
      name.half = [pen.measureText(text).width / 2 + 2, size / 2 + 2];
      pen.globalAlpha = name.faint ? 0.5 : 1;
      pen.lineWidth = 3;
      pen.strokeStyle = look.halo;
      pen.strokeText(text, x, y);
      pen.fillStyle = look.ink;
      pen.fillText(text, x, y);
    }
    pen.globalAlpha = 1;
    drawAxes(pen, scene.camera, scene.painter, scene.about.scene.block.side, look);
  }

  /** The block whose name is written at a point [px]; `undefined`: there is none. */
  at(x, y) {
    return this.shown.findLast(name => Math.abs(x - name.x) <= name.half[0] && Math.abs(y - name.y) <= name.half[1])?.body;
  }
}

/** Whether one of the others is in front of a block, on the way to its middle. */
function hidden(middle, block, others, eye) {
  const direction = unit(minus(middle, eye));
  // Blocks that touch overlap a little.
  const surface = meets(eye, direction, block.centre, block.turn) - 0.02;
  return others.some(other => other !== block && meets(eye, direction, other.centre, other.turn) < surface);
}
