// Names, on a sheet above the arena.

/** With more blocks than this in the structure, those in front are not looked for. */
const MANY = 400;

class Labels {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d');
  }

  /** Names the blocks of the structure that are large enough and not hidden by others. */
  draw(scene, view, blocks, look) {
    const { canvas, pen } = this;
    const scale = devicePixelRatio || 1;
    const { width, height } = scene.painter;
    if (canvas.width !== Math.round(width * scale) || canvas.height !== Math.round(height * scale)) {
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(height * scale);
    }
    // While the view and the structure are the same, so are the names.
    const who = blocks.map(({ body }) => (body === null ? '' : `${body} ${scene.history.nameAt(body, scene.tick)}`));
    const key = `${view.join()} ${width} ${height} ${scale} ${scene.named} ${scene.selected} ${look.ink} ${who.join()}`;
    // A free block that has been chosen is named as well, and moves.
    if (key === this.key && scene.selected === null) return;
    this.key = key;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.shown = [];
    const named = scene.named ? blocks.filter(block => block.named || (block.body !== null && block.body === scene.selected)) : [];
    const eye = scene.camera.eye;
    for (const block of named) {
      // Of a block of the plate only the upper side is seen.
      const middle = block.body < 0 ? add(block.centre, [0, 0, 0.5]) : block.centre;
      const at = scene.screen(middle, view);
      if (!at || at.scale < 13 || (named.length <= MANY && hidden(middle, block, named, eye))) continue;
      this.shown.push({ text: scene.history.nameAt(block.body, scene.tick), far: at.scale, ...at });
    }
    // The nearest are written last.
    this.shown.sort((a, b) => a.far - b.far);
    pen.textAlign = 'center';
    pen.textBaseline = 'middle';
    pen.lineJoin = 'round';
    for (const { text, x, y, scale: size } of this.shown) {
      pen.font = `600 ${Math.min(22, Math.max(11, size * 0.42))}px system-ui, sans-serif`;
      pen.lineWidth = 3;
      pen.strokeStyle = look.halo;
      pen.strokeText(text, x, y);
      pen.fillStyle = look.ink;
      pen.fillText(text, x, y);
    }
  }
}

/** Whether another block is in front of the middle of one. */
function hidden(middle, block, others, eye) {
  const way = minus(middle, eye);
  const distance = Math.hypot(...way);
  const direction = times(way, 1 / distance);
  // The middle of a block is this far behind its surface, at most.
  const inside = block.body < 0 ? 0.05 : 0.9;
  const high = others.filter(other => other !== block && !(other.body < 0));
  return high.some(other => meets(eye, direction, other.centre, other.turn) < distance - inside);
}
