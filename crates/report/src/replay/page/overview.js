// Small view of the whole arena from above: structure, free blocks and camera.

/** Largest number of free blocks in the view. */
const DOTS = 2000;

class Overview {
  constructor(canvas) {
    this.canvas = canvas;
    // The view is drawn without the graphics processor, which may be missing.
    this.pen = canvas.getContext('2d', { willReadFrequently: true });
  }

  draw(scene) {
    const { canvas, pen } = this;
    const { places, camera, free } = scene;
    const look = THEMES[themeName()];
    const scale = devicePixelRatio || 1;
    const size = canvas.clientWidth;
    if (!size) return;
    const wide = Math.round(size * scale);
    // Setting the size to the same value would clear the canvas.
    if (canvas.width !== wide) canvas.width = canvas.height = wide;
    // Without a shell, show the initial extent of the blocks.
    this.reach ??= scene.shell?.reach ?? places.reduce((most, place, i) => (i % 7 < 2 ? Math.max(most, Math.abs(place)) : most), 4);
    const half = size / 2;
    const unit = (half - 12) / this.reach;
    pen.setTransform(scale, 0, 0, scale, scale * half, scale * half);
    pen.clearRect(-half, -half, size, size);
    const spot = ([x, y], wide) => pen.fillRect(unit * x - wide / 2, -unit * y - wide / 2, wide, wide);
    pen.strokeStyle = look.shell;
    pen.fillStyle = look.ground;
    pen.globalAlpha = 0.85;
    pen.beginPath();
    if (scene.shell) scene.shell.trace(pen, unit);
    else pen.arc(0, 0, unit * this.reach, 0, 2 * Math.PI);
    pen.fill();
    pen.globalAlpha = 1;
    pen.stroke();
    for (let i = 0; i < free.length; i += Math.ceil(free.length / DOTS)) {
      pen.fillStyle = scene.pulled.has(free[i]) ? look.lit : look.free;
      spot(places.subarray(7 * free[i]), Math.max(1.5, unit));
    }
    for (const { centre, colour } of scene.solid) {
      pen.fillStyle = colour;
      spot(centre, Math.max(2, unit));
    }
    // Position of the camera. If it is outside the view, the direction to it. Also its centre of
    // view.
    const [x, y] = times(camera.eye, unit);
    const inside = Math.min(1, (half - 4) / (Math.hypot(x, y) || 1));
    pen.strokeStyle = pen.fillStyle = look.ink;
    pen.globalAlpha = 0.6;
    pen.beginPath();
    pen.moveTo(unit * camera.at[0], -unit * camera.at[1]);
    pen.lineTo(x * inside, -y * inside);
    pen.stroke();
    pen.globalAlpha = 1;
    pen.beginPath();
    pen.arc(x * inside, -y * inside, 3.5, 0, 2 * Math.PI);
    pen.fill();
    pen.font = '600 11px system-ui, sans-serif';
    pen.textAlign = 'center';
    pen.fillText('N', 0, -half + 10);
  }
}
