// `window.replay`: an interface for controlling the page from outside (docs/guides/replay.md).

function api({ about, recording, history, scene, painter, camera, player, fetch, draw, select, against }) {
  const show = async tick => {
    await fetch(tick);
    draw(performance.now());
  };
  const state = () => ({
    tick: scene.tick,
    end: history.end,
    blocks: recording.bodies,
    places: Array.from(scene.places),
    structure: Array.from({ length: recording.bodies }, (_, body) => body)
      .filter(body => history.holdAt(body, scene.tick))
      .map(body => [body, history.nameAt(body, scene.tick)]),
    lit: history.facesAt(scene.tick).map(({ body, face }) => [body, face]),
    groups: history.groups.at(scene.tick).list(),
    pulled: history.pullsAt(scene.tick).map(({ body }) => body),
    done: [...history.deeds].filter(([, { done }]) => done <= scene.tick).map(([id]) => id),
    cubes: scene.solid.length + scene.free.length,
    labels: scene.labels.shown.map(({ text }) => text),
    selected: scene.selected,
    playing: player.playing,
    view: camera.view,
    against: against && { run: against.recording.header.run, tick: against.scene.tick, end: against.history.end },
  });
  const centre = body => scene.place(body).centre;
  return {
    version: VERSION,
    /** Stops the replay at a tick. Resolves with the state of the page when that tick is visible. */
    async seek(tick) {
      player.jump(tick);
      await show(player.tick);
      return state();
    },
    /** Resolves with the state of the page when the requested tick is visible. */
    async settled() {
      await fetch(player.tick);
      await new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)));
      return state();
    },
    play: () => player.playing || player.toggle(),
    pause: () => player.playing && player.toggle(),
    /** Sets the speed of the replay, as a multiple of real time. */
    speed: speed => player.setSpeed(speed),
    select,
    state,
    /** Moves the camera: azimuth and height [rad], distance and target point [block lengths]. */
    look: view => {
      camera.view = view;
      player.changed();
    },
    /** Resolves with a PNG picture of the given size [px], as a blob. */
    async png(width, height) {
      await fetch(player.tick);
      const blob = await picture(scene, width, height);
      draw(performance.now());
      return blob;
    },
    /** Resolves with a WebM film of a range of ticks, as a blob. */
    async film({ from = 0, to = history.end, width = 1280, height = 720, speed = player.speed }) {
      const at = async tick => {
        await recording.fetch(tick);
        scene.go(tick);
      };
      player.jump(from);
      const blob = await film(scene, { from, to, width, height, speed, secondsPerTick: about.scene.tick, at });
      await this.seek(to);
      return blob;
    },
    screen: body => scene.screen(centre(body)),
    pixel: (x, y) => {
      // The browser clears the drawing buffer after showing it, so draw again.
      draw(performance.now());
      const scale = painter.canvas.width / painter.canvas.clientWidth;
      return painter.pixel(Math.round(x * scale), Math.round(y * scale));
    },
    pick: (x, y) => scene.pick(x, y),
    /** Returns the names that are visible, with their positions [px]. */
    names: () => scene.labels.shown.map(({ body, text, x, y }) => ({ body, text, x, y })),
    face: (body, face) => scene.screen(add(centre(body), times(NORMALS[face], 0.5))),
  };
}
