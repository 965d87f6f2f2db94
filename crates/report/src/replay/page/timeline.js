// Bar below the arena with phases, captures and releases over time.

/** Half the width of the slider's handle [px]. The slider is below the bar. */
const MARGIN = 8;

/** Height of the part with phases and captures, and of the part with the curves of groups [px]. */
const STRIP = 28;

class Timeline {
  /** Calls `jump` with the tick that the reader drags to. */
  constructor(canvas, history, jump) {
    this.canvas = canvas;
    this.history = history;
    this.drawn = '';
    canvas.parentNode.classList.toggle('courses', history.groups.course.length > 0);
    const drag = event => {
      if (!event.buttons) return;
      canvas.setPointerCapture(event.pointerId);
      const box = canvas.getBoundingClientRect();
      jump(((event.clientX - box.left - MARGIN) / (box.width - 2 * MARGIN)) * history.end);
    };
    canvas.addEventListener('pointerdown', drag);
    canvas.addEventListener('pointermove', drag);
  }

  draw() {
    const { canvas, history } = this;
    const scale = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const key = `${width} ${height} ${scale} ${themeName()}`;
    if (key === this.drawn) return;
    this.drawn = key;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const pen = canvas.getContext('2d');
    pen.scale(scale, scale);
    const at = tick => MARGIN + (tick / Math.max(1, history.end)) * (width - 2 * MARGIN);
    history.begins.forEach(({ from, phase }, i) => {
      const to = history.begins[i + 1]?.from ?? history.end;
      pen.fillStyle = phaseColour(phase);
      pen.globalAlpha = 0.35;
      pen.fillRect(at(from), height - 6, at(to) - at(from), 6);
      pen.globalAlpha = 1;
      pen.font = '11px system-ui, sans-serif';
      const room = at(to) - at(from) - 4;
      // If there is no space for names, numbers identify the phases.
      const name = [`${phase + 1} ${history.phases[phase]}`, String(phase + 1)].find(name => pen.measureText(name).width < room);
      if (name) {
        pen.fillStyle = THEMES[themeName()].ink;
        pen.fillText(name, at(from) + 2, height - 16);
      }
    });
    this.courses(pen, at, height - STRIP - 4);
    // Phase of the event at this tick, which gives a capture its colour.
    let during = 0;
    for (const [tick, kind, number] of history.rows) {
      if (kind === 'phase') during = number;
      if (kind !== 'dock' && kind !== 'free') continue;
      pen.fillStyle = kind === 'dock' ? phaseColour(during) : THEMES[themeName()].lit;
      pen.fillRect(at(tick) - 1, height - (kind === 'dock' ? 13 : 9), 2, kind === 'dock' ? 13 : 9);
    }
  }
  /** Draws the size of the largest group and the number of groups over time, each relative to its maximum. */
  courses(pen, at, height) {
    const { course, largest, most } = this.history.groups;
    if (!course.length) return;
    const look = THEMES[themeName()];
    const lines = [
      { name: `largest group: ${largest} at most`, top: largest, of: it => it.largest, first: 1, dash: [], colour: look.groups.at(-1) },
      { name: `groups: ${most} at most`, top: most, of: it => it.count, first: 0, dash: [4, 3], colour: look.ink },
    ];
    let x = MARGIN;
    pen.font = '11px system-ui, sans-serif';
    pen.lineWidth = 1.5;
    for (const { name, top, of, first, dash, colour } of lines) {
      const level = value => height - (value / top) * (height - 16);
      pen.strokeStyle = colour;
      pen.setLineDash(dash);
      pen.beginPath();
      pen.moveTo(at(0), level(first));
      let before = first;
      for (const step of course) {
        pen.lineTo(at(step.tick), level(before));
        pen.lineTo(at(step.tick), level((before = of(step))));
      }
      pen.lineTo(at(this.history.end), level(before));
      pen.stroke();
      // Sample of the line, and its label.
      pen.beginPath();
      pen.moveTo(x, 6);
      pen.lineTo(x + 18, 6);
      pen.stroke();
      pen.fillStyle = look.ink;
      pen.fillText(name, x + 23, 10);
      x += 40 + pen.measureText(name).width;
    }
    pen.setLineDash([]);
  }
}
