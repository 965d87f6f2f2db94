// A tour of the critical path: the view moves from event to event.

/** Seconds of the reader's that a step takes: as long as it is read. */
const reading = text => 2 + text.length / 18;

class Tour {
  /** `about.tour` is a list of steps; `go` is told the tick of a moment, `look` the cell that it is about. */
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

  /** Goes to a step; `null`, or one beyond the last, ends the tour. */
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

  /** Time passes: from the beginning of a wait to its end, and a moment longer. */
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

/** The text of a piece of HTML, which never becomes a part of the page. */
const plain = html => new DOMParser().parseFromString(html, 'text/html').body.textContent;
