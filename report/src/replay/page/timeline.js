// The bar below the arena: phases, captures and releases over time.

class Timeline {
  constructor(canvas, history) {
    this.canvas = canvas;
    this.history = history;
    this.drawn = '';
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
    // The handle of the slider below is 16 pixels wide.
    const at = tick => 8 + (tick / Math.max(1, history.end)) * (width - 16);
    history.begins.forEach(({ from, phase }, i) => {
      const to = history.begins[i + 1]?.from ?? history.end;
      pen.fillStyle = phaseColour(phase);
      pen.globalAlpha = 0.35;
      pen.fillRect(at(from), height - 6, at(to) - at(from), 6);
      pen.globalAlpha = 1;
      const name = history.phases[phase];
      pen.font = '11px system-ui, sans-serif';
      if (pen.measureText(name).width < at(to) - at(from) - 4) {
        pen.fillStyle = THEMES[themeName()].ink;
        pen.fillText(name, at(from) + 2, height - 16);
      }
    });
    for (const [tick, kind] of history.rows) {
      if (kind !== 'dock' && kind !== 'free') continue;
      pen.fillStyle = kind === 'dock' ? phaseColour(history.phaseAt(tick)) : THEMES[themeName()].lit;
      pen.fillRect(at(tick) - 1, height - (kind === 'dock' ? 13 : 9), 2, kind === 'dock' ? 13 : 9);
    }
  }
}
