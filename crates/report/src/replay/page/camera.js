// Camera of the arena. Dragging turns it, two fingers or the right button move it, and the wheel or
// a pinch changes the distance.

class Camera {
  /** Shows the whole structure and a part of the free blocks. */
  constructor(about, history) {
    const { width, depth } = about.tables.plate;
    let high = 1;
    let wide = Math.max(width, depth);
    for (const { cell } of history.holds.flat()) {
      high = Math.max(high, cell[2]);
      const [x, y] = [cell[0] - (width - 1) / 2, cell[1] - (depth - 1) / 2];
      wide = Math.max(wide, 2 * Math.abs(x) + 1, 2 * Math.abs(y) + 1);
    }
    this.middle = [0, 0, high / 2];
    this.reach = 8 + 2.2 * Math.max(wide, high);
    // Without a plate, no structure grows, so the camera shows the shell.
    const shell = enclosure(about.shell);
    if (!width && shell) {
      this.middle = [0, 0, shell.middle];
      this.reach = 2.8 * Math.max(shell.reach, shell.middle);
    }
    // A planar world is shown from above, north at the top.
    this.isPlanar = Boolean(about.scene.planar);
    this.reset();
  }

  reset() {
    this.azimuth = this.isPlanar ? -Math.PI / 2 : -0.9;
    this.height = this.isPlanar ? 1.55 : 0.42;
    this.distance = this.reach;
    this.at = this.middle;
    this.first = this.view;
  }

  /** View of the camera: azimuth and height [rad], distance and target point [block lengths]. */
  get view() {
    return [this.azimuth, this.height, this.distance, ...this.at];
  }

  set view([azimuth, height, distance, ...at]) {
    this.azimuth = azimuth;
    this.height = height;
    // Apply the same limits as for manual control.
    this.turn(0, 0);
    this.distance = distance;
    this.zoom(1);
    this.at = at;
  }

  get isFirst() {
    const { view } = this;
    return view.every((number, i) => number === this.first[i]);
  }

  /** Moves the target and the distance of the camera one step towards a close view of a point. */
  approach(point) {
    this.at = add(this.at, times(minus(point, this.at), 0.06));
    this.distance += 0.06 * (0.6 * this.reach - this.distance);
  }

  get eye() {
    const flat = Math.cos(this.height) * this.distance;
    return add(this.at, [flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), Math.sin(this.height) * this.distance]);
  }

  /** Unit vectors of the view: to the right, up, and towards the eye. */
  get basis() {
    const back = unit(minus(this.eye, this.at));
    const right = unit(cross([0, 0, 1], back));
    return [right, cross(back, right), back];
  }

  turn(dx, dy) {
    this.azimuth -= dx * 0.008;
    this.height = Math.min(1.55, Math.max(-0.1, this.height + dy * 0.008));
  }

  shift(dx, dy, pixels) {
    const scale = (this.distance * 2 * Math.tan(ANGLE / 2)) / pixels;
    const [right, up] = this.basis;
    this.at = add(this.at, add(times(right, -dx * scale), times(up, dy * scale)));
  }

  zoom(factor) {
    this.distance = Math.min(20 * this.reach, Math.max(2.5, this.distance * factor));
  }

  /** Returns the projection matrix for a picture of this size. */
  matrix(width, height) {
    this.aspect = width / height;
    const far = this.distance + 200;
    this.lens = perspective(this.angle, this.aspect, Math.max(0.05, this.distance / 200), far);
    return product(this.lens, looking(this.eye, this.at, [0, 0, 1]));
  }

  /** Vertical angle of view [rad]. A tall picture shows the same width as a square one. */
  get angle() {
    return this.aspect < 1 ? 2 * Math.atan(Math.tan(ANGLE / 2) / this.aspect) : ANGLE;
  }

  /** Returns the ray through a point of the picture. Coordinates are from -1 to 1, to the right and up. */
  ray(x, y) {
    const [right, up, back] = this.basis;
    const half = Math.tan(this.angle / 2);
    const sideways = add(times(right, x * half * this.aspect), times(up, y * half));
    return { origin: this.eye, direction: unit(minus(sideways, back)) };
  }
}

/** Vertical angle of view of a wide picture [rad]. */
const ANGLE = 0.7;

/** Moves the camera with pointers. Calls `moved` after each change and `clicked` with the position of a click. */
function steer(element, camera, moved, clicked) {
  const pointers = new Map();
  let travelled = 0;
  const place = event => ({ x: event.clientX, y: event.clientY });
  const middle = () => {
    const [a, b] = [...pointers.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  element.addEventListener('pointerdown', event => {
    element.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
    if (pointers.size === 1) travelled = 0;
  });
  element.addEventListener('pointermove', event => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    const old = pointers.size === 2 ? middle() : null;
    pointers.set(event.pointerId, now);
    travelled += Math.hypot(now.x - before.x, now.y - before.y);
    if (old) {
      const next = middle();
      camera.shift(next.x - old.x, next.y - old.y, element.clientHeight);
      camera.zoom(old.apart / (next.apart || 1));
    } else if (event.buttons & 2 || event.shiftKey) {
      camera.shift(now.x - before.x, now.y - before.y, element.clientHeight);
    } else camera.turn(now.x - before.x, now.y - before.y);
    moved();
  });
  const up = event => {
    if (!pointers.delete(event.pointerId)) return;
    // A finger never rests completely still.
    if (event.type === 'pointerup' && pointers.size === 0 && travelled < 6) clicked(place(event));
  };
  element.addEventListener('pointerup', up);
  element.addEventListener('pointercancel', up);
  element.addEventListener('contextmenu', event => event.preventDefault());
  element.addEventListener(
    'wheel',
    event => {
      event.preventDefault();
      camera.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.03 : 0.001)));
      moved();
    },
    { passive: false },
  );
}
