// Selects the blocks that the camera can see. Only these are drawn.

/** From the centre of a block to its corners [side]. */
const CORNER = 0.87;
/** What lets light through fades out towards the eye (shaders.js), and is less than half a step of a colour within this [side]. */
const FADED = 3.2;

class Sight {
  /** `view`: from the arena to the picture, by columns; `far`: from where on blocks are small [side]. */
  constructor(view, eye, far) {
    this.eye = eye;
    this.far = far;
    const row = i => [view[i], view[4 + i], view[8 + i], view[12 + i]];
    const last = row(3);
    // Planes at the left, right, bottom, top and front. Visible points have a positive distance from each.
    const pairs = [[0, 1], [0, -1], [1, 1], [1, -1], [2, 1]];
    this.planes = pairs.map(([axis, sign]) => {
      const plane = row(axis).map((number, i) => last[i] + sign * number);
      const length = Math.hypot(plane[0], plane[1], plane[2]);
      return plane.map(number => number / length);
    });
  }

  /** Whether any of a block may be seen, whose centre is at an index of a list; `faint`: it lets light through. */
  has(places, at = 0, faint = false) {
    const [x, y, z] = [places[at], places[at + 1], places[at + 2]];
    const { planes, eye } = this;
    for (let i = 0; i < 5; i++) {
      const plane = planes[i];
      if (plane[0] * x + plane[1] * y + plane[2] * z + plane[3] < -CORNER) return false;
    }
    return !faint || (x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (z - eye[2]) ** 2 > FADED * FADED;
  }

  /** Whether a block is small in the picture, and its centre within: of a point whose centre is not, nothing is drawn. */
  isSmall(places, at = 0) {
    const [x, y, z] = [places[at], places[at + 1], places[at + 2]];
    const { planes, eye } = this;
    if ((x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (z - eye[2]) ** 2 < this.far ** 2) return false;
    return planes.every(plane => plane[0] * x + plane[1] * y + plane[2] * z + plane[3] > 0);
  }
}
