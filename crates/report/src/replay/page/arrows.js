// Arrows on a sheet above the arena: one for each capture, from the parent to the captured block.

/** Half of the length of an arrow [block lengths]. The middle is in the face of the parent. */
const HALF = 0.24;

/** Draws the arrows between blocks that are large enough and not hidden. Each is `{ parent, child }`. */
function drawArrows(sheet, scene, view, arrows, opaque, look, sharp) {
  const eye = scene.camera.eye;
  const shown = [];
  for (const { parent, child } of arrows) {
    const way = unit(minus(child.centre, parent.centre));
    const middle = times(add(parent.centre, child.centre), 0.5);
    const [tail, head] = [-HALF, HALF].map(along => scene.screen(add(middle, times(way, along)), view));
    if (!tail || !head || head.scale < SMALLEST) continue;
    const sight = minus(middle, eye);
    const covers = ({ body, centre, turn }) => body !== parent.body && body !== child.body && meets(eye, unit(sight), centre, turn) < Math.hypot(...sight);
    if (arrows.length > MANY || !opaque.some(covers)) shown.push({ tail, head });
  }
  const boxes = shown.flatMap(({ tail, head }) => [tail, head].map(({ x, y }) => [x - 12, y - 12, x + 12, y + 12]));
  sheet.cover(boxes, scene.painter, sharp);
  const { pen } = sheet;
  pen.lineCap = pen.lineJoin = 'round';
  for (const { tail, head } of shown) {
    const thick = Math.min(3, Math.max(1.5, head.scale * 0.04));
    const angle = Math.atan2(head.y - tail.y, head.x - tail.x);
    const barb = side => [head.x - 3 * thick * Math.cos(angle + side), head.y - 3 * thick * Math.sin(angle + side)];
    pen.beginPath();
    pen.moveTo(tail.x, tail.y);
    pen.lineTo(head.x, head.y);
    pen.moveTo(...barb(0.6));
    pen.lineTo(head.x, head.y);
    pen.lineTo(...barb(-0.6));
    for (const [colour, width] of [[look.halo, thick + 2.5], [look.ink, thick]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.stroke();
    }
  }
}
