// Vectors are arrays of three numbers, quaternions of four (x, y, z, w). Matrices are arrays of
// sixteen, by columns.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = a => times(a, 1 / (Math.hypot(...a) || 1));

/** Returns a vector rotated by a quaternion. */
function turned(q, v) {
  const t = times(cross(q, v), 2);
  return add(add(v, times(t, q[3])), cross(q, t));
}

const turnedBack = (q, v) => turned([-q[0], -q[1], -q[2], q[3]], v);

function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  const depth = 1 / (near - far);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) * depth, -1, 0, 0, 2 * far * near * depth, 0];
}

/** Returns the matrix from arena coordinates to the view of an eye that looks at a point. */
function looking(eye, at, up) {
  const z = unit(minus(eye, at));
  const x = unit(cross(up, z));
  const y = cross(z, x);
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}

function product(a, b) {
  const out = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let i = 0; i < 4; i++) sum += a[4 * i + row] * b[4 * column + i];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** Returns the distance along a ray to a cube of side 1, or Infinity if the ray misses it. */
function meets(origin, direction, centre, turn) {
  // Fast path: most blocks are far from the ray. Half of a cube's diagonal is 0.87.
  const way = minus(centre, origin);
  const along = dot(way, direction);
  if (along < -0.9 || dot(way, way) - along * along > 0.76) return Infinity;
  const o = turnedBack(turn, minus(origin, centre));
  const d = turnedBack(turn, direction);
  let [near, far] = [0, Infinity];
  for (let axis = 0; axis < 3; axis++) {
    const inverse = 1 / d[axis];
    const [a, b] = [(-0.5 - o[axis]) * inverse, (0.5 - o[axis]) * inverse];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
  }
  return near <= far ? near : Infinity;
}
