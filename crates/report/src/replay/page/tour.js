// Tour of the critical path: the view moves from event to event.

/** Returns the duration of a step [s]: the time for reading its text. */
const reading = text => 2 + text.length / 18;

class Tour {
  /** `about.tour` is the list of steps. Calls `go` with the tick of a moment, and `look` with the cell of the event. */
  constructor(element, history, { go, look, changed }) {
    Object.assign(this, { element, history, go, look, changed });
    this.steps = history.about.tour.map(({ from, to, cell, html }) => ({ from, to, cell, text: plain(html) }));
    this.at = null;
    const button = (label, words, act) => {
      const made = part('button', '', label);
      made.setAttribute('aria-label', words);
      made.addEventListener('click', act);
      return made;
    };
    this.caption = part('p');
    this.caption.setAttribute('aria-live', 'polite');
    const buttons = part('div', 'row');
    buttons.append(
      button('◀', 'step before', () => this.show(this.at - 1)),
      button('▶', 'next step', () => this.show(this.at + 1)),
      button('✕', 'end the tour', () => this.show(null)),
    );
    element.append(this.caption, buttons);
  }

  get playing() {
    return this.at !== null;
  }

  /** Shows a step. `null` or an index after the last step ends the tour. */
  show(step) {
    const known = step !== null && step < this.steps.length;
    this.at = known ? Math.max(0, step) : null;
    this.begun = null;
    this.element.hidden = !known;
    if (known) {
      const { text } = this.steps[this.at];
      this.caption.textContent = `${this.at + 1} of ${this.steps.length}: ${text}`;
    }
    this.changed();
  }

  /** Advances the tour from the beginning of a wait to its end, then pauses for a moment. */
  pass(now) {
    if (!this.playing) return;
    this.begun ??= now;
    const { from, to, cell, text } = this.steps[this.at];
    const share = (now - this.begun) / 1000 / reading(text);
    this.go(from + (to - from) * Math.min(1, share / 0.85));
    this.look(cell);
    if (share >= 1) this.show(this.at + 1);
  }
}

/** Returns the text in a piece of HTML. The piece never becomes a part of the page. */
const plain = html => new DOMParser().parseFromString(html, 'text/html').body.textContent;
