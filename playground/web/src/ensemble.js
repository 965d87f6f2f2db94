// Simulates many runs of a program in workers, and shows the results so far.
import { Engine, Stopped } from './engine.js';

/** Largest number of workers. */
const WORKERS = Math.max(1, Math.min(8, (navigator.hardwareConcurrency || 2) - 1));
/** Number of runs per request, by model. Runs with physics take about a second each. */
const BATCH = { rigid: 1, rate: 25, shuffle: 25 };

/**
 * Simulation of many runs. Calls `changed` after new records and new statistics. `records` are the outcomes in
 * the order of the runs. `summary` are the statistics of the first `summary.total` records that arrived.
 */
export class Ensemble {
  constructor(request, runs, changed) {
    Object.assign(this, { request, runs, changed, records: [], texts: [], next: 0, isRunning: true });
    const batch = BATCH[request.model] ?? 1;
    const count = Math.min(WORKERS, Math.ceil(runs / batch));
    this.engines = Array.from({ length: count }, () => new Engine());
    this.statistics = new Engine();
    this.summary = { total: 0, times: null, shares: [], curve: [] };
    this.done = Promise.all(this.engines.map(engine => this.work(engine, batch))).finally(() => this.stop());
  }

  async work(engine, batch) {
    while (this.isRunning && this.next < this.runs) {
      const first = this.next;
      const runs = Math.min(batch, this.runs - first);
      this.next += runs;
      try {
        const { records, text } = await engine.call({ call: 'simulate', ...this.request, first, runs });
        this.records.push(...records);
        this.texts.push(text);
        this.records.sort((a, b) => a.run - b.run);
        this.changed(this);
        this.summarize();
      } catch (error) {
        if (error instanceof Stopped) return;
        this.stop();
        throw error;
      }
    }
  }

  stop() {
    if (!this.isRunning) return;
    this.isRunning = false;
    for (const engine of this.engines) engine.close();
    this.changed(this);
    this.summarize();
  }

  /** Computes the statistics of all records so far, until no further records arrive. */
  async summarize() {
    if (this.isSummarizing) return;
    this.isSummarizing = true;
    const { text, program } = this.request;
    while (this.texts.length) {
      const total = this.records.length;
      const texts = this.texts.splice(0);
      this.summary = { ...await this.statistics.call({ call: 'summarize', text, program, texts }), total };
      this.changed(this);
    }
    this.isSummarizing = false;
    if (!this.isRunning) this.statistics.close();
  }
}

/** Returns the curve of the share of completed runs over time, with its 95 % confidence intervals, as SVG. */
export function curve({ curve: points, total }, tick, runs) {
  const [width, height, left, bottom, top, right] = [560, 240, 44, 34, 10, 14];
  const end = (points.at(-1)?.[0] ?? 1) * 1.05;
  const step = niceStep((end * tick) / 8);
  const x = ticks => (left + (ticks / end) * (width - left - right)).toFixed(1);
  const y = share => (height - bottom - share * (height - bottom - top)).toFixed(1);
  let path = `M${x(0)} ${y(0)}`;
  let [upper, lower] = ['', ''];
  points.forEach(([ticks, share, low, high], i) => {
    path += `H${x(ticks)}V${y(share)}`;
    if (low === null) return;
    const [from, to] = [x(ticks), x(points[i + 1]?.[0] ?? end)];
    upper += `${upper ? 'L' : 'M'}${from} ${y(high)}H${to}`;
    lower = `L${to} ${y(low)}H${from}${lower}`;
  });
  path += `H${x(end)}`;
  const lines = [0, 0.25, 0.5, 0.75, 1].map(share => `<line x1="${left}" x2="${width - right}" y1="${y(share)}" y2="${y(share)}"/><text x="${left - 6}" y="${y(share - 0.02)}" text-anchor="end">${100 * share} %</text>`);
  const marks = [];
  for (let at = 0; at <= end * tick; at += step) marks.push(`<text x="${x(at / tick)}" y="${height - bottom + 16}" text-anchor="middle">${Number(at.toPrecision(3))}</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" role="img" aria-label="share of ${total} of ${runs} runs that are complete, over time, with 95 % confidence intervals"><g class="grid">${lines.join('')}${marks.join('')}<text x="${(left + width - right) / 2}" y="${height - 3}" text-anchor="middle">time of the robots [s]</text></g>${upper && `<path class="band" fill="#9c4700" fill-opacity="0.18" d="${upper}${lower}Z"/>`}<path class="curve" d="${path}"/></svg>`;
}

/** Returns the curve as the content of a file, with its own style. */
export const standalone = svg => svg.replace('<g class="grid">', '<style>line{stroke:#d4d9df}text{fill:#56606d;font:11px sans-serif}.curve{fill:none;stroke:#9c4700;stroke-width:2}</style><rect width="100%" height="100%" fill="#fff"/><g>');

function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough || 1));
  return [1, 2, 5, 10].map(it => it * power).find(it => it >= rough) ?? rough;
}

/** Returns the runs as comma-separated values. */
export function csv(records, tick) {
  const rows = records.map(({ run, outcome, ticks }) => [run, outcome.kind, ticks, ticks * tick].join());
  return ['run,outcome,ticks,seconds', ...rows].join('\n') + '\n';
}
