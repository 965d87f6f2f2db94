// Source text of the program. Running events are highlighted, finished events have the colour of
// their phase.

class ProgramText {
  /** Calls `jump` with the tick of a statement that the reader clicks. */
  constructor(element, history, jump) {
    this.element = element;
    this.history = history;
    this.marks = [];
    this.key = '';
    for (const { file, pieces } of history.about.text) {
      const text = part('pre');
      text.tabIndex = 0;
      text.setAttribute('aria-label', file);
      for (const { lines, events } of pieces) {
        const piece = part('span', '', lines.join('\n'));
        if (events.length) {
          this.marks.push({ piece, events });
          piece.addEventListener('click', () => {
            const deeds = events.map(id => history.deeds.get(id)).filter(Boolean);
            if (deeds.length) jump(deeds.at(-1).from);
          });
        }
        text.append(piece);
      }
      element.append(part('p', 'hint', file), text);
    }
    element.hidden = !this.marks.length;
    element.addEventListener('toggle', () => this.reveal());
  }

  /** Highlights the statements whose events are running at a tick. */
  show(tick) {
    const key = lastAtOrBefore(this.history.steps, tick);
    if (key === this.key) return;
    this.key = key;
    for (const { piece, events } of this.marks) {
      const deeds = events.map(id => this.history.deeds.get(id)).filter(deed => deed?.from <= tick);
      const happened = deeds.filter(({ done }) => done <= tick);
      const state = happened.length < deeds.length ? 'under-way' : happened.length === events.length ? 'done' : '';
      if (piece.className !== state) piece.className = state;
    }
    this.reveal();
  }

  /** Scrolls to the last statement with a running event, unless the reader is using the text. */
  reveal() {
    const piece = this.marks.findLast(({ piece }) => piece.className === 'under-way')?.piece;
    const text = piece?.parentNode;
    if (!text || text.matches(':hover') || text === document.activeElement) return;
    const top = piece.offsetTop;
    if (top < text.scrollTop || top + 20 > text.scrollTop + text.clientHeight) text.scrollTop = top - text.clientHeight / 2;
  }
}
