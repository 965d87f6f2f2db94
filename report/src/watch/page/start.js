// Puts the page together, and listens.

const element = id => document.getElementById(id);
/** Where a length in words is needed: as many as there are. */
const count = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;

/** The arena: a scene for the program of the run that is shown, made anew for another one. */
class Stage {
  constructor() {
    this.painter = new Painter(element('arena'), () => this.wake());
    this.labels = new Labels(element('labels'));
    this.overview = new Overview(element('overview'));
    /** What is known of programs, by number; promises, so that each is asked for once. */
    this.programs = new Map();
    this.awake = false;
    const camera = { turn: (...by) => this.scene?.camera.turn(...by), shift: (...by) => this.scene?.camera.shift(...by), zoom: by => this.scene?.camera.zoom(by) };
    steer(element('arena'), camera, () => this.wake(), () => {});
    new ResizeObserver(() => this.wake()).observe(element('arena'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.wake());
    const press = (id, act) => element(id).addEventListener('click', () => this.scene && (act(this.scene), this.mark(), this.wake()));
    press('names', scene => (scene.named = !scene.named));
    press('target', scene => (scene.aimed = !scene.aimed));
    press('cloud', scene => (scene.clouds = (scene.clouds + 1) % 3));
    press('reset', scene => scene.camera.reset());
    element('arena').addEventListener('keydown', event => this.key(event));
  }

  key(event) {
    const camera = this.scene?.camera;
    if (!camera || event.ctrlKey || event.metaKey || event.altKey) return;
    const does = {
      ArrowLeft: () => camera.turn(-20, 0), ArrowRight: () => camera.turn(20, 0), ArrowUp: () => camera.turn(0, 20), ArrowDown: () => camera.turn(0, -20),
      '+': () => camera.zoom(0.85), '=': () => camera.zoom(0.85), '-': () => camera.zoom(1 / 0.85),
    }[event.key];
    if (!does) return;
    event.preventDefault();
    does();
    this.wake();
  }

  /** What is known of a program. */
  program(number) {
    if (!this.programs.has(number)) {
      const asked = fetch(`program/${number}`).then(answer => (answer.ok ? answer.json() : null), () => null);
      this.programs.set(number, asked);
    }
    return this.programs.get(number);
  }

  /** Shows a frame; of those that come while a program is asked for, the last. */
  async take(frame) {
    this.next = frame;
    const about = await this.program(frame.program);
    if (this.next !== frame) return;
    if (!about) {
      this.programs.delete(frame.program);
      return;
    }
    const bodies = about.scene.free.count;
    if (this.about !== about) this.change(about, bodies);
    const { scene } = this;
    scene.recording.take(frame);
    scene.history.take(frame);
    scene.go(frame.tick);
    this.frame = frame;
    const phase = scene.history.phases[frame.phase] ?? '';
    const words = [about.program, `run ${frame.run}`, `tick ${frame.tick}`, phase, count(scene.history.held.size, 'captured block')];
    write(element('shown'), words.filter(Boolean).join(' · '));
    element('message').hidden = true;
    this.wake();
  }

  change(about, bodies) {
    const old = this.scene;
    for (const { buffer } of this.painter.fixed.values()) this.painter.gl.deleteBuffer(buffer);
    this.painter.fixed.clear();
    this.about = about;
    // All that will be built is in sight from the beginning.
    const camera = new Camera(about, { holds: target(about).map(cell => ({ cell })) });
    if (old && !old.camera.isFirst) camera.view = old.camera.view;
    this.overview.reach = undefined;
    this.labels.forget();
    this.scene = new Scene(about, new PresentPlaces(bodies), new Present(about), this.painter, this.labels, camera);
    if (old) for (const name of ['named', 'aimed', 'clouds']) this.scene[name] = old[name];
    this.mark();
  }

  mark() {
    const { scene } = this;
    element('names').setAttribute('aria-pressed', scene.named);
    element('target').setAttribute('aria-pressed', scene.aimed);
    element('target').hidden = !scene.target.length;
    write(element('cloud'), ['cloud: faint', 'cloud: solid', 'cloud: off'][scene.clouds]);
  }

  wake() {
    if (this.awake) return;
    this.awake = true;
    requestAnimationFrame(() => {
      this.awake = false;
      if (this.painter.lost || !this.scene) return;
      this.scene.draw(devicePixelRatio || 1);
      this.overview.draw(this.scene);
      document.body.dataset.drawn = this.frame.tick;
    });
  }
}

function start() {
  let stage = null;
  try {
    stage = new Stage();
  } catch (error) {
    // Numbers and curves are seen all the same.
    if (!(error instanceof Unreadable)) throw error;
    fail(error.message);
  }
  if (stage) write(element('message'), 'Waiting for a run.');
  const source = new EventSource('events');
  const heard = (name, act) => source.addEventListener(name, event => act(JSON.parse(event.data)));
  const state = words => write(element('state'), words);
  heard('numbers', told => {
    state('running');
    tell(told);
    document.querySelector('main').classList.toggle('flat', Boolean(told.arena));
    if (told.arena) write(element('facts'), `${element('facts').dataset.first ??= element('facts').textContent} · no arena: ${told.arena}`);
  });
  heard('curves', draw);
  heard('frame', frame => stage?.take(frame));
  heard('end', ({ complete }) => {
    source.close();
    state(complete ? 'All runs are done.' : 'The command has ended before all runs were done.');
    if (!stage?.scene) write(element('message'), 'The command has ended.');
  });
  source.addEventListener('error', () => state('no connection: the command has ended, or does not answer'));
  window.watch = stage;
  document.body.dataset.ready = 'yes';
}

start();
