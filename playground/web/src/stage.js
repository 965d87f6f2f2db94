// View on the right side of the page: a structure or a run, drawn by the viewer of `stochc replay`.
import { viewer } from 'virtual:viewer';
import { recordings } from './recordings.js';

/** Largest number of names in the picture. */
const MANY_NAMES = 40;

const element = id => document.getElementById(id);

export class Stage {
  /** Calls `selected` with the event of a block that the reader clicks, and `told` when the tick changes. */
  constructor(palette, { selected, told }) {
    this.parts = viewer(palette);
    Object.assign(this, recordings(this.parts), { selected, told });
    const { Painter, Labels, steer } = this.parts;
    this.canvas = element('arena');
    this.painter = new Painter(this.canvas, () => this.wake());
    this.labels = new Labels(element('labels'));
    /** Shown structure or run: `{ kind, about, recording, history, scene, player }`. */
    this.shown = null;
    this.camera = null;
    /** Whether captures of structures have arrows. */
    this.arrows = true;
    /** Block under the pointer. */
    this.pointed = null;
    const camera = new Proxy({}, { get: (_, name) => this.camera[name]?.bind?.(this.camera) ?? this.camera[name] });
    const at = ({ clientX, clientY, x = clientX, y = clientY }) => {
      const box = this.canvas.getBoundingClientRect();
      return this.shown?.scene.pick(x - box.left, y - box.top) ?? null;
    };
    steer(this.canvas, camera, () => this.wake(), place => this.select(at(place), true));
    this.canvas.addEventListener('pointermove', event => {
      if (!event.buttons && this.shown?.scene.marked.size) this.point(at(event));
    });
    this.canvas.addEventListener('pointerleave', () => this.point(null));
    this.canvas.addEventListener('keydown', event => this.key(event));
    new ResizeObserver(() => this.wake()).observe(this.canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.wake());
  }

  /**
   * Shows a structure at its last event, or at the tick where the reader was. `messages` are the diagnostics of captures
   * and seeds.
   */
  structure(structure, messages) {
    const { about } = structure;
    const recording = new this.Steps(structure);
    const before = this.shown?.kind === 'structure' && this.shown.about.program === about.program ? this.shown : null;
    const wasLast = !before || before.player.tick >= before.player.end;
    this.show('structure', about, recording);
    const { player, scene } = this.shown;
    scene.clouds = 2;
    scene.arrows = this.arrows;
    const bodies = new Map(recording.origin.map((event, body) => [event, body]));
    for (const [it, message] of messages) scene.marked.set(bodies.get(it) ?? -1 - it.role, message);
    // More names would hide the structure.
    scene.named = recording.bodies <= MANY_NAMES;
    player.speed = 1;
    player.tick = wasLast ? player.end : Math.min(before.player.tick, player.end);
    this.wake();
  }

  /** Shows a run that is still being computed. Returns the function that receives its batches. */
  live(about, bodies, speed) {
    const recording = new this.Live(bodies);
    let drawn = 0;
    return {
      recording,
      push: (batch, numbers) => {
        recording.push(batch, numbers);
        if (this.shown?.recording === recording) {
          // The history is rebuilt at most four times a second.
          const now = performance.now();
          if (now - drawn > 250) {
            drawn = now;
            this.grow();
          }
        } else if (!this.isClosed && recording.frames.length) {
          this.show('run', about, recording);
          this.shown.growing = true;
          this.shown.player.tick = 0;
          this.shown.player.speed = speed;
          this.shown.player.playing = true;
          this.wake();
        }
      },
      finish: () => {
        if (this.shown?.recording !== recording) return;
        this.shown.growing = false;
        this.grow();
      },
    };
  }

  show(kind, about, recording) {
    const { Camera, History, Player, Scene, Timeline } = this.parts;
    const history = new History(about, recording);
    this.place(new Camera(about, history));
    // Stored sketches belong to one scene.
    for (const { buffer } of this.painter.fixed.values()) this.painter.gl.deleteBuffer(buffer);
    this.painter.fixed.clear();
    this.labels.forget();
    const scene = new Scene(about, recording, history, this.painter, this.labels, this.camera);
    const perTick = kind === 'structure' ? 0.6 : about.scene.tick;
    const player = new Player(history, perTick, () => this.wake());
    // A new canvas has no listeners of the previous timeline.
    if (kind === 'run') element('timeline').replaceWith(element('timeline').cloneNode());
    const timeline = kind === 'run' ? new Timeline(element('timeline'), history, tick => player.jump(tick)) : null;
    this.shown = { kind, about, recording, history, scene, player, timeline, growing: false };
    this.pointed = null;
    element('tick').max = player.end;
    this.wake();
  }

  /** Adds the ticks that were computed since the last call. */
  grow() {
    const { shown } = this;
    shown.history = shown.scene.history = shown.player.history = new this.parts.History(shown.about, shown.recording);
    shown.player.end = shown.history.end;
    shown.timeline.history = shown.history;
    shown.timeline.drawn = '';
    element('time').classList.toggle('courses', shown.history.groups.course.length > 0);
    element('tick').max = shown.history.end;
    this.wake();
  }

  /** Sets the camera, but keeps a view that the reader chose. */
  place(camera) {
    const old = this.camera;
    if (old && !old.isFirst && old.middle.join() === camera.middle.join()) camera.view = old.view;
    this.camera = camera;
  }

  point(body) {
    if (this.pointed === body) return;
    this.pointed = body;
    this.wake();
  }

  /** Returns the diagnostic of the block under the pointer, or of the selected block. */
  get message() {
    const { marked, selected } = this.shown.scene;
    return marked.get(this.pointed) ?? marked.get(selected);
  }

  select(body, isOwn = false) {
    const { shown } = this;
    if (!shown) return;
    shown.scene.selected = body;
    this.wake();
    if (!isOwn || body === null) return;
    const role = body < 0 ? -1 - body : shown.history.holdAt(body, shown.scene.tick)?.role;
    this.selected(role ?? null);
  }

  /** Marks the block of an event in the structure. */
  mark(id) {
    if (this.shown?.kind !== 'structure') return;
    const body = this.shown.recording.origin.findIndex(event => event.id === id);
    const { scene } = this.shown;
    const next = body < 0 ? null : body;
    if (scene.selected !== next) {
      scene.selected = next;
      this.wake();
    }
  }

  wake() {
    if (this.awake) return;
    this.awake = true;
    requestAnimationFrame(now => this.frame(now));
  }

  frame(now) {
    this.awake = false;
    const { shown } = this;
    if (!shown || this.painter.lost) return;
    const { player, scene, timeline } = shown;
    const wasPlaying = player.playing;
    player.pass(now, true);
    // The clock waits at the last computed tick.
    if (wasPlaying && !player.playing && shown.growing) player.playing = true;
    scene.go(shown.kind === 'structure' ? Math.floor(player.tick) : player.tick);
    scene.draw(devicePixelRatio || 1);
    timeline?.draw();
    this.told(shown);
    if (player.playing) this.wake();
  }

  key(event) {
    const { shown } = this;
    if (!shown || event.ctrlKey || event.metaKey || event.altKey) return;
    const { player } = shown;
    const turn = (x, y) => () => {
      if (event.shiftKey) this.camera.shift(-40 * x, 40 * y, this.painter.height);
      else this.camera.turn(20 * x, 20 * y);
    };
    const actions = {
      ' ': () => player.toggle(),
      ArrowRight: () => player.jump(Math.floor(player.tick) + (event.shiftKey && shown.kind === 'run' ? 100 : 1)),
      ArrowLeft: () => player.jump(Math.ceil(player.tick) - (event.shiftKey && shown.kind === 'run' ? 100 : 1)),
      a: turn(-1, 0), d: turn(1, 0), w: turn(0, 1), s: turn(0, -1),
      e: () => this.camera.zoom(0.85),
      q: () => this.camera.zoom(1 / 0.85),
      r: () => this.camera.reset(),
      Escape: () => this.select(null),
    };
    const act = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act) return;
    event.preventDefault();
    act();
    this.wake();
  }
}
