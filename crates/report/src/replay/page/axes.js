// Coordinate axes that show the directions and a length.

const DIRECTIONS = { E: NORMALS.east, N: NORMALS.north, up: NORMALS.up };

/** Draws the axes into the lower right corner of an arena of this size [px]. `side` is the block length [m]. */
function drawAxes(sheet, camera, { width, height }, side, look, sharp) {
  const { pen } = sheet;
  // Narrow pages have lines of text below.
  const level = height - (width < 600 ? 80 : 26);
  const [x, y, long] = [width - 46, level - 48, 26];
  // Pixels per block length at the centre of the view.
  const scale = height / (2 * camera.distance * Math.tan(camera.angle / 2));
  const sides = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000].findLast(sides => sides * scale <= 130) ?? 1;
  const [from, to] = [width - 16 - sides * scale, width - 16];
  const length = `${count(sides, 'side')} = ${metres(sides * side)}`;
  const font = '600 11px system-ui, sans-serif';
  pen.font = font;
  // Length of the arrows including their names, and half the height of a line of text.
  const [reach, line] = [long + 9 + pen.measureText('up').width, 11];
  const first = Math.min(x - reach, from, to - pen.measureText(length).width);
  sheet.cover([[first - 2, y - reach - line, width, level + 11 + line]], { width, height }, sharp);
  const [right, up, back] = camera.basis;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.strokeStyle = pen.fillStyle = look.ink;
  pen.lineWidth = 1.5;
  pen.font = font;
  for (const [name, way] of Object.entries(DIRECTIONS)) {
    const [u, v] = [dot(way, right), -dot(way, up)];
    // Axes that point away from the reader are fainter.
    pen.globalAlpha = dot(way, back) < -0.1 ? 0.55 : 1;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + long * u, y + long * v);
    pen.stroke();
    pen.fillText(name, x + (long + 9) * u, y + (long + 9) * v);
  }
  pen.globalAlpha = 1;
  pen.beginPath();
  pen.moveTo(from, level - 4);
  pen.lineTo(from, level);
  pen.lineTo(to, level);
  pen.lineTo(to, level - 4);
  pen.stroke();
  pen.textAlign = 'right';
  pen.fillText(length, to, level + 11);
}

/** Returns a length as text, in a unit that makes the number at least 1 if possible. */
function metres(length) {
  const units = [['m', 1], ['cm', 1e2], ['mm', 1e3], ['µm', 1e6], ['nm', 1e9]];
  const [unit, scale] = units.find(([, scale]) => length * scale >= 0.9995) ?? units.at(-1);
  return `${Number((length * scale).toPrecision(3))} ${unit}`;
}
