// Pictures and films of the arena in any size.

/** Returns a canvas of this size [px] with the arena and its names. `sheet` may be a canvas from an earlier call. */
function painted(scene, width, height, sheet = new OffscreenCanvas(width, height)) {
  const { painter, labels } = scene;
  const { gl } = painter;
  const [most] = [gl.getParameter(gl.MAX_RENDERBUFFER_SIZE), ...gl.getParameter(gl.MAX_VIEWPORT_DIMS)].sort((a, b) => a - b);
  const sizes = [width, height];
  if (!sizes.every(size => Number.isInteger(size) && size > 0)) throw new Unreadable('A picture has a width and a height in whole pixels.');
  if (sizes.some(size => size > most)) throw new Unreadable(`The graphics of this browser draw ${most} x ${most} pixels at most.`);
  const shown = [painter.width, painter.height];
  // The unit is the height of the arena on the page, so that letters and lines keep their relative
  // size.
  const scale = height / painter.height;
  [painter.width, painter.height] = [width / scale, height / scale];
  try {
    scene.draw(scale, scale);
    if (gl.drawingBufferWidth !== width || gl.drawingBufferHeight !== height) throw new Unreadable('The graphics of this browser cannot draw a picture of this size.');
    const pen = sheet.getContext('2d');
    pen.drawImage(painter.canvas, 0, 0, width, height);
    labels.paint(pen);
  } finally {
    [painter.width, painter.height] = shown;
  }
  return sheet;
}

/** Resolves with a PNG picture of the arena. */
const picture = (scene, width, height) => painted(scene, width, height).convertToBlob({ type: 'image/png' });

/**
 * Resolves with a WebM film of a range of ticks, recorded while it plays. `at` receives each tick and resolves when
 * it can be drawn.
 */
async function film(scene, { from, to, width, height, speed, secondsPerTick, at }) {
  if (typeof MediaRecorder === 'undefined' || !MediaRecorder.isTypeSupported('video/webm')) {
    throw new Unreadable('This browser cannot record films in WebM.');
  }
  if (!(from >= 0 && from < to)) throw new Unreadable('A film goes from a tick to a later one.');
  const sheet = document.createElement('canvas');
  [sheet.width, sheet.height] = [width, height];
  await at(from);
  painted(scene, width, height, sheet);
  const recorder = new MediaRecorder(sheet.captureStream(30), { mimeType: 'video/webm', videoBitsPerSecond: 8e6 });
  const parts = [];
  recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
  const stopped = new Promise(stop => recorder.addEventListener('stop', stop));
  // The recorder returns its data at intervals.
  recorder.start(100);
  const begun = performance.now();
  for (let tick = from; tick < to; ) {
    await new Promise(requestAnimationFrame);
    tick = Math.min(to, from + (((performance.now() - begun) / 1000) * speed) / secondsPerTick);
    await at(tick);
    painted(scene, width, height, sheet);
  }
  // A busy machine may not have recorded a picture yet. Without pictures, there is no film.
  for (let wait = 0; wait < 300 && !parts.some(({ size }) => size > 0); wait++) {
    painted(scene, width, height, sheet);
    await new Promise(passed => setTimeout(passed, 50));
  }
  recorder.stop();
  await stopped;
  return new Blob(parts, { type: 'video/webm' });
}

/** Offers a file to the reader for download. */
function keep(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}
