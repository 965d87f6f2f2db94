// Shows a second run next to the first. Both runs share the camera, and their clocks are
// synchronized by tick or by phase.

class Against {
  /** Calls `wake` when the view changes, and `select` with the block that was clicked. */
  constructor(about, recording, camera, { wake, select }) {
    this.recording = recording;
    this.history = new History(about, recording);
    const [arena, labels] = ['canvas', 'div'].map((tag, i) => part(tag, `second ${['arena', 'labels'][i]}`));
    element('overview').before(arena, labels);
    arena.tabIndex = 0;
    arena.setAttribute('role', 'img');
    arena.setAttribute('aria-label', `the arena of run ${recording.header.run}: drag to turn, click a block`);
    labels.setAttribute('aria-hidden', 'true');
    element('stage').classList.add('two');
    this.scene = new Scene(about, recording, this.history, new Painter(arena, wake), new Labels(labels), camera);
    steer(arena, camera, wake, ({ x, y }) => {
      const box = arena.getBoundingClientRect();
      select(this.scene.pick(x - box.left, y - box.top));
    });
    new ResizeObserver(wake).observe(arena);
    /** Whether the two runs are synchronized by phase instead of by tick. */
    this.byPhase = false;
  }

  /** Returns the tick of this run that corresponds to a tick of the other run. */
  tick(tick, other) {
    if (!this.byPhase) return Math.min(tick, this.history.end);
    const at = lastAtOrBefore(other.begins.map(({ from }) => from), tick);
    const stretch = ({ begins, end }) => [begins[at]?.from ?? end, begins[at + 1]?.from ?? end];
    const [[from, to], [here, there]] = [stretch(other), stretch(this.history)];
    const share = to > from ? (tick - from) / (to - from) : 0;
    return here + (there - here) * Math.min(1, share);
  }
}
