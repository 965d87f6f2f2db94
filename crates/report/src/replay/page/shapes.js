// Corners of the shapes to draw.

/**
 * Returns three faces of a cube of side 1: to the east, north and up. Each has four corners and a normal. At most
 * three faces are visible. The shader moves them to the sides that face the eye.
 */
function cube() {
  const corners = [];
  for (const normal of [NORMALS.east, NORMALS.north, NORMALS.up]) {
    const [u, v] = sides(normal);
    for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
      corners.push(...times(add(normal, add(times(u, a), times(v, b))), 0.5), ...normal);
    }
  }
  return new Float32Array(corners);
}

/** Triangles of the three faces, as indices of corners. */
const CUBE_TRIANGLES = new Uint16Array([0, 4, 8].flatMap(at => [at, at + 1, at + 2, at, at + 2, at + 3]));

/** Returns two directions u and v in a face, with u x v = normal. */
function sides(normal) {
  const u = normal[2] ? [1, 0, 0] : [0, 0, 1];
  return [u, cross(normal, u)];
}

/** Collector of coloured lines or triangles. */
class Sketch {
  constructor() {
    this.numbers = [];
  }

  point(place, colour) {
    this.numbers.push(...place, ...colour);
  }

  line(a, b, colour) {
    this.point(a, colour);
    this.point(b, colour);
  }

  /** Adds the edges of a cube. `half` is half of its side. */
  box(centre, half, colour) {
    for (const [u, v, w] of [[0, 1, 2], [1, 2, 0], [2, 0, 1]]) {
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const from = [...centre];
        from[u] += a * half;
        from[v] += b * half;
        const to = [...from];
        from[w] -= half;
        to[w] += half;
        this.line(from, to, colour);
      }
    }
  }

  /** Adds a horizontal ring about the vertical axis. */
  ring(radius, z, colour, parts = 96) {
    const at = i => [radius * Math.cos((2 * Math.PI * i) / parts), radius * Math.sin((2 * Math.PI * i) / parts), z];
    for (let i = 0; i < parts; i++) this.line(at(i), at(i + 1), colour);
  }

  /** Adds a flat square around a point. `half` is half of its side. */
  square(centre, normal, half, colour, rim = colour) {
    const [u, v] = sides(normal);
    const corner = (a, b) => add(centre, add(times(u, a * half), times(v, b * half)));
    const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    for (let i = 0; i < 4; i++) {
      this.point(centre, colour);
      this.point(corners[i], rim);
      this.point(corners[(i + 1) % 4], rim);
    }
  }
}

/** Returns a disc on the ground, as triangles. */
function disc(radius, colour) {
  const sketch = new Sketch();
  const at = i => [radius * Math.cos((Math.PI * i) / 64), radius * Math.sin((Math.PI * i) / 64), -0.02];
  // Without a graphics processor, few wide triangles are faster than many narrow ones. Each joins
  // two corners of the rim.
  const fill = (from, to) => {
    const middle = (from + to) / 2;
    for (const i of [from, middle, to]) sketch.point(at(i), colour);
    if (middle - from > 1) for (const [first, last] of [[from, middle], [middle, to]]) fill(first, last);
  };
  for (const half of [0, 64]) fill(half, half + 64);
  return sketch;
}
