// Sorting of free blocks from far to near. They are drawn in this order because they are
// transparent.

const SHELLS = 2048;

class Cloud {
  constructor(bodies) {
    this.shells = new Uint16Array(bodies);
    this.sorted = new Uint32Array(bodies);
    this.begins = new Uint32Array(SHELLS + 1);
  }

  /** Sorts a list of blocks, the farthest from the eye first. */
  sort(list, places, eye) {
    const { shells, sorted, begins } = this;
    const count = list.length;
    let farthest = 1;
    const distance = body => Math.hypot(places[7 * body] - eye[0], places[7 * body + 1] - eye[1], places[7 * body + 2] - eye[2]);
    for (let i = 0; i < count; i++) farthest = Math.max(farthest, distance(list[i]));
    begins.fill(0);
    for (let i = 0; i < count; i++) {
      shells[i] = Math.floor((1 - distance(list[i]) / farthest) * (SHELLS - 1));
      begins[shells[i] + 1]++;
    }
    for (let i = 0; i < SHELLS; i++) begins[i + 1] += begins[i];
    for (let i = 0; i < count; i++) sorted[begins[shells[i]]++] = list[i];
    return sorted.subarray(0, count);
  }
}
