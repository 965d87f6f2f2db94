// Puts the page together.

const element = id => document.getElementById(id);

async function start() {
  const whole = element('whole');
  if (!whole) throw new Unreadable('This page was cut short: its end is missing. Copy it again, or make it again with `stochc replay`.');
  const about = JSON.parse(element('about').textContent);
  const recording = await Recording.open(element('recording').textContent.trim());
  const history = new History(about, recording);
  const painter = new Painter(element('arena'), () => wake());
  const camera = new Camera(about, history);
  const scene = new Scene(about, recording, history, painter, new Labels(element('labels')), camera);
  const timeline = new Timeline(element('timeline'), history, tick => player.jump(tick));
  const overview = new Overview(element('overview'));
  const state = { following: false, drawn: null, told: -Infinity, scale: 1, slow: 0 };
  const player = new Player(history, about.scene.tick, () => wake());
  const graph = new Graph(element('graph'), history, tick => player.jump(tick));
  const panel = new Panel(element('block'), history, tick => player.jump(tick));
  const program = new ProgramText(element('program'), history, tick => player.jump(tick));
  head(about, recording);

  function select(body) {
    scene.selected = body;
    if (body === null) state.following = false;
    wake();
  }

  function follow(on = !state.following) {
    state.following = on && scene.selected !== null;
    wake();
  }

  /** Draws once more, and goes on while something moves. */
  let awake = false;
  function wake() {
    if (awake) return;
    awake = true;
    requestAnimationFrame(frame);
  }

  function frame(now) {
    awake = false;
    const ready = recording.has(player.tick);
    player.pass(now, ready);
    if (painter.lost) return;
    if (scene.go(player.tick)) draw(now);
    else recording.fetch(player.tick).then(wake);
    if (player.playing) wake();
  }

  function draw(now) {
    if (state.following && scene.selected !== null) camera.at = scene.place(scene.selected).centre;
    scene.draw((devicePixelRatio || 1) * state.scale);
    graph.show(scene.tick);
    panel.show(scene.selected, Math.floor(scene.tick));
    program.show(scene.tick);
    timeline.draw();
    // Ten times a second is as fast as anybody reads.
    if (!player.playing || now - state.told > 100) {
      state.told = now;
      controls();
    }
    adapt(now);
  }

  /** Where drawing is slow, fewer pixels are drawn while the clock runs. */
  function adapt(now) {
    const took = now - (state.drawn ?? now);
    state.drawn = player.playing ? now : null;
    if (!player.playing) {
      if (state.scale < 1) {
        state.scale = 1;
        state.slow = 0;
        wake();
      }
      return;
    }
    state.slow = Math.max(0, state.slow + (took > 40 ? took / 40 : -0.5));
    if (state.slow > 12 && state.scale > 0.6) {
      state.scale *= 0.75;
      state.slow = 0;
    }
  }

  function controls() {
    const tick = Math.floor(scene.tick);
    const seconds = tick * about.scene.tick;
    element('tick').value = tick;
    text('now', `tick ${tick} of ${history.end}`);
    text('clock', time(seconds));
    text('phase', history.phases[history.phaseAt(tick)] ?? '');
    text('play', player.playing ? '❚❚' : '▶');
    element('play').setAttribute('aria-label', player.playing ? 'pause' : 'play');
    element('speed').value = String(player.speed);
    element('follow').setAttribute('aria-pressed', state.following);
    element('follow').disabled = scene.selected === null;
    element('names').setAttribute('aria-pressed', scene.named);
    element('target').setAttribute('aria-pressed', scene.aimed);
    element('target').hidden = !scene.target.length;
    overview.draw(scene);
    text('cloud', ['cloud: faint', 'cloud: solid', 'cloud: off'][scene.clouds]);
    const last = lastAtOrBefore(history.stops, tick);
    const rows = history.rows.filter(row => row[0] === history.stops[last] && NOTABLE.has(row[1]));
    text('event', rows.length ? `${rows[0][0]}: ${rows.map(row => history.words(row)).join('; ')}` : '');
    if (!player.playing) remember(tick);
  }

  /** Keeps the tick in the address, so that it can be passed on. */
  function remember(tick) {
    const hash = `#tick=${tick}${scene.selected === null ? '' : `&block=${scene.selected}`}`;
    if (location.hash === hash) return;
    try {
      window.history.replaceState(null, '', hash);
    } catch {
      // Some browsers do not let a file change its own address.
    }
  }

  function recall() {
    const asked = new URLSearchParams(location.hash.slice(1));
    const number = name => (asked.has(name) && /^-?\d+$/.test(asked.get(name)) ? Number(asked.get(name)) : null);
    const body = number('block');
    if (body !== null && body < recording.bodies && body >= -history.roles.length) {
      if (body >= 0 || about.tables.blocks[-1 - body].seed) scene.selected = body;
    }
    const tick = number('tick');
    if (tick !== null) player.jump(tick);
    wake();
  }

  SPEEDS.forEach(speed => element('speed').append(new Option(`${speed}×`, String(speed))));
  element('tick').max = history.end;
  element('tick').addEventListener('input', event => player.jump(Number(event.target.value)));
  element('speed').addEventListener('change', event => (player.speed = Number(event.target.value)));
  const cloud = () => {
    scene.clouds = (scene.clouds + 1) % 3;
    wake();
  };
  const names = () => {
    scene.named = !scene.named;
    wake();
  };
  const aim = () => {
    scene.aimed = !scene.aimed;
    wake();
  };
  const reset = () => {
    state.following = false;
    camera.reset();
    wake();
  };
  const theme = () => {
    document.documentElement.dataset.theme = themeName() === 'dark' ? 'light' : 'dark';
    wake();
  };
  const help = () => element('help').toggleAttribute('open');
  const buttons = {
    play: () => player.toggle(),
    next: () => player.event(1, false),
    previous: () => player.event(-1, false),
    follow: () => follow(), names, target: aim, cloud, reset, theme,
  };
  for (const [id, act] of Object.entries(buttons)) element(id).addEventListener('click', act);
  /** Chooses another block: of the structure, or one of those that are pulled. */
  const choose = step => () => {
    const all = [...scene.solid.flatMap(({ body }) => body ?? []), ...scene.pulled];
    const at = all.indexOf(scene.selected);
    if (all.length) select(all[(at < 0 && step < 0 ? all.length - 1 : at + step + all.length) % all.length]);
  };
  const look = change => () => {
    change();
    wake();
  };
  const looks = { e: look(() => camera.zoom(0.85)), q: look(() => camera.zoom(1 / 0.85)) };
  for (const [key, x, y] of [['a', -1, 0], ['d', 1, 0], ['w', 0, -1], ['s', 0, 1]]) {
    looks[key] = look(() => camera.turn(20 * x, 20 * -y));
    looks[key.toUpperCase()] = look(() => camera.shift(-40 * x, -40 * y, painter.height));
  }
  const choices = { b: choose(1), B: choose(-1), Escape: () => select(null) };
  keys(player, { ...looks, ...choices, f: () => follow(), l: names, g: aim, c: cloud, r: reset, t: theme, '?': help });
  steer(element('arena'), camera, wake, ({ x, y }) => {
    const box = element('arena').getBoundingClientRect();
    select(scene.pick(x - box.left, y - box.top));
  });
  new ResizeObserver(wake).observe(element('arena'));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', wake);
  addEventListener('hashchange', recall);
  recall();
  await recording.fetch(player.tick);
  scene.go(player.tick);
  draw(performance.now());
  element('message').hidden = true;

  /** For whoever wants to look at the page by a program. */
  window.replay = {
    version: VERSION,
    async seek(tick) {
      player.jump(tick);
      await recording.fetch(player.tick);
      scene.go(player.tick);
      draw(performance.now());
      return this.state();
    },
    /** The state when what was asked for is to be seen. */
    async settled() {
      await recording.fetch(player.tick);
      await new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)));
      return this.state();
    },
    select,
    state: () => ({
      tick: scene.tick,
      end: history.end,
      blocks: recording.bodies,
      places: Array.from(scene.places),
      structure: Array.from({ length: recording.bodies }, (_, body) => body)
        .filter(body => history.holdAt(body, scene.tick))
        .map(body => [body, history.nameAt(body, scene.tick)]),
      lit: history.facesAt(scene.tick).map(({ body, face }) => [body, face]),
      pulled: history.pullsAt(scene.tick).map(({ body }) => body),
      done: [...history.deeds].filter(([, { done }]) => done <= scene.tick).map(([id]) => id),
      cubes: scene.solid.length + scene.free.length,
      labels: scene.labels.shown.map(({ text }) => text),
      selected: scene.selected,
      playing: player.playing,
    }),
    screen: body => scene.screen(scene.place(body).centre),
    pixel: (x, y) => {
      // What was drawn is gone once it has been shown.
      draw(performance.now());
      const scale = painter.canvas.width / painter.canvas.clientWidth;
      return painter.pixel(Math.round(x * scale), Math.round(y * scale));
    },
    pick: (x, y) => scene.pick(x, y),
    /** The names that are written, and where [px]. */
    names: () => scene.labels.shown.map(({ body, text, x, y }) => ({ body, text, x, y })),
    face: (body, face) => scene.screen(add(scene.place(body).centre, times(NORMALS[face], 0.5))),
  };
  document.body.dataset.ready = 'yes';
}

function text(id, words) {
  const place = element(id);
  if (place.textContent !== words) place.textContent = words;
}

/** What the page is of. */
function head(about, recording) {
  const { record } = recording;
  text('name', about.program);
  const { kind, by } = record.outcome;
  const outcome = kind === 'timed_out' ? { timeout: 'timed out', max_ticks: 'stopped by --max-ticks' }[by] : kind;
  const after = `${record.ticks} ticks (${time(record.ticks * about.scene.tick)})`;
  const waiting = record.waiting ? [`${count(record.waiting.length, 'wait')} under way`] : [];
  text('facts', [`run ${recording.header.run}`, `${outcome} after ${after}`, count(record.bonds.length, 'capture'), ...waiting, about.model, `scene ${about.scene.name}`, `seed ${about.seed}`].join(' · '));
}

/** Seconds as minutes and seconds. */
function time(seconds) {
  const digits = seconds < 60 ? `${seconds.toFixed(2)} s` : `${Math.floor(seconds / 60)} min ${String(Math.floor(seconds % 60)).padStart(2, '0')} s`;
  return digits;
}

addEventListener('DOMContentLoaded', start);
