// Assembly of the page.

const element = id => document.getElementById(id);

async function start() {
  const whole = element('whole');
  if (!whole) throw new Unreadable('The end of this page is missing. Copy the page again, or write it again with `stochc replay`.');
  const about = JSON.parse(element('about').textContent);
  const recording = await Recording.open(element('recording').textContent.trim());
  const history = new History(about, recording);
  const painter = new Painter(element('arena'), () => wake());
  const camera = new Camera(about, history);
  const scene = new Scene(about, recording, history, painter, new Labels(element('labels')), camera);
  const timeline = new Timeline(element('timeline'), history, tick => player.jump(tick));
  const overview = new Overview(element('overview'));
  const second = element('against').textContent.trim();
  const against = second ? new Against(about, await Recording.open(second), camera, { wake: () => wake(), select: body => select(body, against) }) : null;
  const state = { following: false, drawn: null, told: -Infinity, surveyed: -Infinity, scale: 1, slow: 0 };
  const player = new Player(history, about.scene.tick, () => wake());
  if (against) player.end = Math.max(history.end, against.history.end);
  const graph = new Graph(element('graph'), history, tick => player.jump(tick));
  const panel = new Panel(element('block'), history, tick => player.jump(tick));
  const tour = new Tour(element('tour'), history, {
    go: tick => player.jump(tick),
    look: cell => cell && camera.approach(scene.centre(cell)),
    changed: () => wake(),
  });
  const program = new ProgramText(element('program'), history, tick => player.jump(tick));
  const legend = new GroupLegend(element('groups'), history.groups);
  head(about, recording, against);
  save(about, recording, player, () => window.replay);

  /** Selects a block of the first run, or of the second run `of`. */
  function select(body, of = null) {
    scene.selected = of ? null : body;
    if (against) against.scene.selected = of ? body : null;
    panel.history = (of ?? { history }).history;
    panel.key = '';
    if (body === null) state.following = false;
    wake();
  }

  function follow(on = !state.following) {
    state.following = on && scene.selected !== null;
    wake();
  }

  /** Draws the page again, repeatedly while something moves. */
  let awake = false;
  function wake() {
    if (awake) return;
    awake = true;
    requestAnimationFrame(frame);
  }

  function frame(now) {
    awake = false;
    player.pass(now, ready(player.tick));
    tour.pass(now);
    if (painter.lost) return;
    if (ready(player.tick)) draw(now);
    else fetch(player.tick).then(wake);
    if (player.playing || tour.playing) wake();
  }

  /** Returns the shown runs, each with its tick. */
  const shown = tick => [[recording, scene, Math.min(tick, history.end)], ...(against ? [[against.recording, against.scene, against.tick(tick, history)]] : [])];
  const ready = tick => shown(tick).every(([recording, , tick]) => recording.has(tick));
  const fetch = tick => Promise.all(shown(tick).map(([recording, , tick]) => recording.fetch(tick)));

  function draw(now) {
    for (const [, scene, tick] of shown(player.tick)) scene.go(tick);
    if (state.following && scene.selected !== null) camera.at = scene.place(scene.selected).centre;
    for (const [, scene] of shown(player.tick)) scene.draw((devicePixelRatio || 1) * state.scale);
    graph.show(scene.tick);
    const chosen = panel.history === history ? scene : against.scene;
    panel.show(chosen.selected, Math.floor(chosen.tick), chosen);
    program.show(scene.tick);
    timeline.draw();
    legend.show(scene.tick);
    // The overview is too small to show the motion of its dots, so update it rarely.
    if (!player.playing || now - state.surveyed > 500) {
      state.surveyed = now;
      overview.draw(scene);
    }
    // Readers cannot follow more than ten updates of text per second.
    if (!player.playing || now - state.told > 100) {
      state.told = now;
      controls();
    }
    adapt(now);
  }

  /** Reduces the number of pixels while the replay plays if drawing is slow. */
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
    text('now', `tick ${tick} of ${history.end}${against ? `, ${Math.floor(against.scene.tick)} of ${against.history.end}` : ''}`);
    element('clocks').hidden = !against;
    text('clocks', against?.byPhase ? 'clocks: by phase' : 'clocks: by tick');
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
    text('cloud', ['cloud: faint', 'cloud: solid', 'cloud: off'][scene.clouds]);
    const last = lastAtOrBefore(history.stops, tick);
    const rows = history.rows.filter(row => row[0] === history.stops[last] && history.isNotable(row));
    text('event', rows.length ? `${rows[0][0]}: ${rows.map(row => history.words(row)).join('; ')}` : '');
    text('beyond', scene.allBeyond());
    if (!player.playing) writeLink({ tick: player.tick, body: scene.selected, view: camera.isFirst ? null : camera.view, embedded: document.body.classList.contains('embed') });
  }

  function recall() {
    const { tick, body, view, embedded } = readLink();
    document.body.classList.toggle('embed', embedded);
    if (body !== null && body < recording.bodies && body >= -history.roles.length) {
      if (body >= 0 || about.tables.blocks[-1 - body].seed) scene.selected = body;
    }
    if (view) camera.view = view;
    if (tick !== null) player.jump(tick);
    wake();
  }

  SPEEDS.forEach(speed => element('speed').append(new Option(`${speed}×`, String(speed))));
  element('tick').max = player.end;
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
    clocks: () => {
      against.byPhase = !against.byPhase;
      player.end = against.byPhase ? history.end : Math.max(history.end, against.history.end);
      element('tick').max = player.end;
      player.go(player.tick);
    },
    tourer: () => tour.show(tour.playing ? null : 0),
  };
  for (const [id, act] of Object.entries(buttons)) element(id).addEventListener('click', act);
  /** Selects the next or previous block of the structure or of the pulled blocks. */
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
  element('tourer').hidden = !tour.steps.length;
  recall();
  if (about.guided && readLink().tick === null) tour.show(0);
  await fetch(player.tick);
  draw(performance.now());
  element('message').hidden = true;

  window.replay = api({ about, recording, history, scene, painter, camera, player, fetch, draw, select, follow, recall, against });
  document.body.dataset.ready = 'yes';
}

function text(id, words) {
  const place = element(id);
  if (place.textContent !== words) place.textContent = words;
}

/** Writes the name and the facts of the run at the top of the page. */
function head(about, recording, against) {
  const { record } = recording;
  text('name', about.program);
  if (against) text('beside', `right: ${outcome(about, against.recording)}`);
  const waiting = record.waiting ? [`${count(record.waiting.length, 'capture')} still waiting`] : [];
  text('facts', [outcome(about, recording), count(record.bonds.length, 'capture'), ...waiting, about.model, `scene ${about.scene.name}`, `seed ${about.seed}`].join(' · '));
}

/** Returns a description of how and when a run ended. */
function outcome(about, { header, record }) {
  const { kind, by } = record.outcome;
  const words = kind === 'timed_out' ? { timeout: 'timed out', max_ticks: 'stopped by --max-ticks' }[by] : kind;
  return `run ${header.run} · ${words} after ${record.ticks} ticks (${time(record.ticks * about.scene.tick)})`;
}

/** Returns seconds as a text in minutes and seconds. */
function time(seconds) {
  const digits = seconds < 60 ? `${seconds.toFixed(2)} s` : `${Math.floor(seconds / 60)} min ${String(Math.floor(seconds % 60)).padStart(2, '0')} s`;
  return digits;
}

addEventListener('DOMContentLoaded', start);
