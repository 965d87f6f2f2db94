// Selection of the blocks that the camera can see. Only these are drawn.

/** Distance from the centre of a block to its corners [block lengths]. */
const CORNER = 0.87;
/**
 * Distance from the eye below which transparent blocks are invisible [block lengths]. They fade out towards the eye
 * (shaders.js).
 */
const FADED = 3.2;

class Sight {
  /**
   * `view` is the matrix from the arena to the picture, by columns. Blocks farther away than `far` are small [block
   * lengths].
   */
  constructor(view, eye, far) {
    this.eye = eye;
    this.far = far;
    const row = i => [view[i], view[4 + i], view[8 + i], view[12 + i]];
    const last = row(3);
    // Planes at the left, right, bottom, top and front of the view. Visible points have a positive
    // distance from each.
    const pairs = [[0, 1], [0, -1], [1, 1], [1, -1], [2, 1]];
    this.planes = pairs.map(([axis, sign]) => {
      const plane = row(axis).map((number, i) => last[i] + sign * number);
      const length = Math.hypot(plane[0], plane[1], plane[2]);
      return plane.map(number => number / length);
    });
  }

  /**
   * Returns whether a part of a block may be visible. Its centre is at index `at` of a list. `faint` states whether
   * the block is transparent.
   */
  has(places, at = 0, faint = false) {
    const [x, y, z] = [places[at], places[at + 1], places[at + 2]];
    const { planes, eye } = this;
    for (let i = 0; i < 5; i++) {
      const plane = planes[i];
      if (plane[0] * x + plane[1] * y + plane[2] * z + plane[3] < -CORNER) return false;
    }
    return !faint || (x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (z - eye[2]) ** 2 > FADED * FADED;
  }

  /**
   * Returns whether a block is small in the picture and its centre visible. A point whose centre is not visible is
   * not drawn.
   */
  isSmall(places, at = 0) {
    const [x, y, z] = [places[at], places[at + 1], places[at + 2]];
    const { planes, eye } = this;
    if ((x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (z - eye[2]) ** 2 < this.far ** 2) return false;
    return planes.every(plane => plane[0] * x + plane[1] * y + plane[2] * z + plane[3] > 0);
  }
}
