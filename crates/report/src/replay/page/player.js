// Clock of the replay, and the buttons and keys that control it.

/** Speeds of the replay, as multiples of real time. */
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200];

const nearest = wanted => SPEEDS.reduce((best, speed) => (Math.abs(Math.log(speed / wanted)) < Math.abs(Math.log(best / wanted)) ? speed : best), 1);

class Player {
  /** Calls `changed` when the view changes. */
  constructor(history, secondsPerTick, changed) {
    this.history = history;
    this.end = history.end;
    this.secondsPerTick = secondsPerTick;
    this.changed = changed;
    this.tick = 0;
    this.playing = false;
    // Initial speed: the whole run takes about a minute and a half.
    this.speed = nearest((history.end * secondsPerTick) / 90);
    this.last = null;
  }

  go(tick) {
    this.tick = Math.min(this.end, Math.max(0, tick));
    this.changed();
  }

  /** Stops the replay and moves to a whole tick. */
  jump(tick) {
    this.playing = false;
    this.go(Math.round(tick));
  }

  toggle() {
    if (!this.playing && this.tick >= this.end) this.tick = 0;
    this.playing = !this.playing;
    this.last = null;
    this.changed();
  }

  /** Sets the speed to the available speed that is nearest to `wanted`. */
  setSpeed(wanted) {
    this.speed = nearest(wanted);
    this.changed();
  }

  faster(steps) {
    const at = SPEEDS.indexOf(this.speed);
    this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at + steps))];
    this.changed();
  }

  /** Moves to the next or previous event. `any` includes events that are not of the structure. */
  event(direction, any) {
    const list = any ? this.history.steps : this.history.stops;
    const here = lastAtOrBefore(list, this.tick);
    const before = list[here] === this.tick ? here - 1 : here;
    const to = list[direction > 0 ? here + 1 : before];
    if (to !== undefined) this.jump(to);
  }

  /** Advances the clock of a playing replay. `ready` states whether the positions at this tick are unpacked. */
  pass(now, ready) {
    if (!this.playing) return;
    // If the browser pauses the page, the replay continues later without skipping.
    const seconds = this.last === null ? 0 : Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (!ready) return;
    this.tick = Math.min(this.end, this.tick + (seconds * this.speed) / this.secondsPerTick);
    if (this.tick >= this.end) this.playing = false;
  }
}

/** Assigns actions to keys, by the names of the keys. */
function keys(player, does) {
  const actions = {
    ' ': () => player.toggle(),
    k: () => player.toggle(),
    ArrowRight: event => player.jump(Math.floor(player.tick) + (event.shiftKey ? 100 : 1)),
    ArrowLeft: event => player.jump(Math.ceil(player.tick) - (event.shiftKey ? 100 : 1)),
    Home: () => player.jump(0),
    End: () => player.jump(player.end),
    n: () => player.event(1, false),
    p: () => player.event(-1, false),
    N: () => player.event(1, true),
    P: () => player.event(-1, true),
    '+': () => player.faster(1),
    '=': () => player.faster(1),
    '-': () => player.faster(-1),
    ...does,
  };
  addEventListener('keydown', event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Except for the slider, a focused element uses some keys itself.
    if (event.target.matches('select, input:not([type=range])')) return;
    if (event.key === ' ' && event.target.matches('button, summary, [role=button]')) return;
    const act = actions[event.key];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}
