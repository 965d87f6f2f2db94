// Enclosures: their distances and lines. Lengths are in block lengths.

/** Returns the enclosure for the data of a page, or `null` if there is none. */
function enclosure(shell) {
  const kinds = { ball: BallShell, box: BoxShell, cylinder: CylinderShell };
  return shell && new kinds[shell.kind](shell);
}

/** A ball with its centre at the height `lift`, cut off by the ground. */
class BallShell {
  constructor({ radius, lift }) {
    Object.assign(this, { radius, middle: lift, reach: radius });
  }

  /** Returns the distance of a point outside of the walls and the lid. It is negative inside. */
  distance([x, y, z]) {
    return Math.hypot(x, y, z - this.middle) - this.radius;
  }

  /** Adds the outline from above to the path of a pen. */
  trace(pen, unit) {
    pen.arc(0, 0, unit * this.radius, 0, 2 * Math.PI);
  }

  /** Returns the ground, as triangles. */
  ground(colour) {
    return disc(Math.sqrt(this.radius ** 2 - this.middle ** 2), colour);
  }

  /** Returns the lines of the walls, and of rings on the ground every five block lengths. */
  wires(rings, shell) {
    const { radius, middle } = this;
    const sketch = new Sketch();
    // Angle below the centre where the shell meets the ground.
    const low = Math.asin(middle / radius);
    for (let r = 5; r < radius * Math.cos(low); r += 5) sketch.ring(r, 0, rings);
    for (let part = Math.ceil((-8 * low) / Math.PI); part < 4; part++) {
      const angle = (part * Math.PI) / 8;
      sketch.ring(radius * Math.cos(angle), middle + radius * Math.sin(angle), shell);
    }
    for (let i = 0; i < 12; i++) {
      const [x, y] = [Math.cos((Math.PI * i) / 6), Math.sin((Math.PI * i) / 6)];
      const at = j => {
        const angle = -low + ((Math.PI / 2 + low) * j) / 24;
        return [radius * x * Math.cos(angle), radius * y * Math.cos(angle), middle + radius * Math.sin(angle)];
      };
      for (let j = 0; j < 24; j++) sketch.line(at(j), at(j + 1), shell);
    }
    return sketch;
  }
}

/** Number of parts of the height between two horizontal lines of a wall. */
const STOREYS = 4;

/** A box on the ground. */
class BoxShell {
  constructor({ length, width, height }) {
    const half = [length / 2, width / 2];
    Object.assign(this, { half, height, middle: height / 2, reach: Math.max(...half) });
  }

  distance([x, y, z]) {
    return beyond([Math.abs(x) - this.half[0], Math.abs(y) - this.half[1], z - this.height]);
  }

  trace(pen, unit) {
    const [x, y] = times(this.half, unit);
    pen.rect(-x, -y, 2 * x, 2 * y);
  }

  corners(z) {
    const [x, y] = this.half;
    return [[-x, -y, z], [x, -y, z], [x, y, z], [-x, y, z]];
  }

  ground(colour) {
    const sketch = new Sketch();
    const corners = this.corners(-0.02);
    for (const i of [0, 1, 2, 0, 2, 3]) sketch.point(corners[i], colour);
    return sketch;
  }

  wires(rings, shell) {
    const sketch = new Sketch();
    const [x, y] = this.half;
    for (let at = 5 * Math.ceil(1 - x / 5); at < x; at += 5) sketch.line([at, -y, 0], [at, y, 0], rings);
    for (let at = 5 * Math.ceil(1 - y / 5); at < y; at += 5) sketch.line([-x, at, 0], [x, at, 0], rings);
    for (let part = 0; part <= STOREYS; part++) {
      const corners = this.corners((part / STOREYS) * this.height);
      for (let i = 0; i < 4; i++) sketch.line(corners[i], corners[(i + 1) % 4], shell);
    }
    for (const [x, y] of this.corners(0)) sketch.line([x, y, 0], [x, y, this.height], shell);
    return sketch;
  }
}

/** A standing cylinder. */
class CylinderShell {
  constructor({ radius, height }) {
    Object.assign(this, { radius, height, middle: height / 2, reach: radius });
  }

  distance([x, y, z]) {
    return beyond([Math.hypot(x, y) - this.radius, z - this.height]);
  }

  trace(pen, unit) {
    pen.arc(0, 0, unit * this.radius, 0, 2 * Math.PI);
  }

  ground(colour) {
    return disc(this.radius, colour);
  }

  wires(rings, shell) {
    const { radius, height } = this;
    const sketch = new Sketch();
    for (let r = 5; r < radius; r += 5) sketch.ring(r, 0, rings);
    for (let part = 0; part <= STOREYS; part++) sketch.ring(radius, (part / STOREYS) * height, shell);
    for (let i = 0; i < 12; i++) {
      const [x, y] = [radius * Math.cos((Math.PI * i) / 6), radius * Math.sin((Math.PI * i) / 6)];
      sketch.line([x, y, 0], [x, y, height], shell);
    }
    return sketch;
  }
}

/** Returns the signed distance from a convex body, from the distances outside of its independent walls. */
function beyond(excess) {
  return Math.hypot(...excess.map(it => Math.max(it, 0))) + Math.min(Math.max(...excess), 0);
}
