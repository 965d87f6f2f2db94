// Simulates many runs of a program in workers, and shows the results so far.
import { Engine, Stopped } from './engine.js';

/** Largest number of workers. */
const WORKERS = Math.max(1, Math.min(8, (navigator.hardwareConcurrency || 2) - 1));
/** Number of runs per request, by model. Runs with physics take about a second each. */
const BATCH = { rigid: 1, rate: 25, shuffle: 25 };

/** Simulation of many runs. Calls `changed` with all records so far, in the order of the runs. */
export class Ensemble {
  constructor(request, runs, changed) {
    Object.assign(this, { request, runs, changed, records: [], next: 0, isRunning: true });
    const batch = BATCH[request.model] ?? 1;
    const count = Math.min(WORKERS, Math.ceil(runs / batch));
    this.engines = Array.from({ length: count }, () => new Engine());
    this.done = Promise.all(this.engines.map(engine => this.work(engine, batch))).finally(() => this.stop());
  }

  async work(engine, batch) {
    while (this.isRunning && this.next < this.runs) {
      const first = this.next;
      const runs = Math.min(batch, this.runs - first);
      this.next += runs;
      try {
        const { records } = await engine.call({ call: 'simulate', ...this.request, first, runs });
        this.records.push(...records);
        this.records.sort((a, b) => a.run - b.run);
        this.changed(this);
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
  }
}

/** Returns the completion times in ascending order [ticks], and the last tick of each run. */
export function times(records) {
  const completed = records.filter(({ outcome }) => outcome.kind === 'completed');
  return { completed: completed.map(({ ticks }) => ticks).sort((a, b) => a - b), total: records.length };
}

/** Returns a quantile of sorted numbers. */
export const quantile = (sorted, q) => sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))];

/** Returns the mean waiting times of captures, the longest first, as `{ text, wait, count, role }`. */
export function waits(records, blocks) {
  const all = new Map();
  for (const { bonds } of records) {
    for (const { parent, face, child, magnetized, docked } of bonds) {
      const text = `${blocks[parent].name}.${face} -> ${blocks[child].name}`;
      const entry = all.get(text) ?? { text, role: child, sum: 0, count: 0 };
      entry.sum += docked - magnetized;
      entry.count++;
      all.set(text, entry);
    }
  }
  return [...all.values()].map(it => ({ ...it, wait: it.sum / it.count })).sort((a, b) => b.wait - a.wait);
}

/** Returns the curve of the share of completed runs over time, as SVG. */
export function curve({ completed, total }, tick, runs) {
  const [width, height, left, bottom, top, right] = [560, 240, 44, 34, 10, 14];
  const end = (completed.at(-1) ?? 1) * 1.05;
  const step = niceStep((end * tick) / 8);
  const x = ticks => left + (ticks / end) * (width - left - right);
  const y = share => height - bottom - share * (height - bottom - top);
  let path = `M${x(0)} ${y(0)}`;
  completed.forEach((ticks, i) => (path += `H${x(ticks).toFixed(1)}V${y((i + 1) / total).toFixed(1)}`));
  path += `H${x(end).toFixed(1)}`;
  const lines = [0, 0.25, 0.5, 0.75, 1].map(share => `<line x1="${left}" x2="${width - right}" y1="${y(share)}" y2="${y(share)}"/><text x="${left - 6}" y="${y(share) + 4}" text-anchor="end">${100 * share} %</text>`);
  const marks = [];
  for (let at = 0; at <= end * tick; at += step) marks.push(`<text x="${x(at / tick).toFixed(1)}" y="${height - bottom + 16}" text-anchor="middle">${Number(at.toPrecision(3))}</text>`);
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" role="img" aria-label="share of ${total} of ${runs} runs that are complete, over time"><g class="grid">${lines.join('')}${marks.join('')}<text x="${(left + width - right) / 2}" y="${height - 3}" text-anchor="middle">time of the robots [s]</text></g><path class="curve" d="${path}"/></svg>`;
}

/** Returns the curve as the content of a file, with its own style. */
export const standalone = svg => svg.replace('<g class="grid">', '<style>line{stroke:#d4d9df}text{fill:#56606d;font:11px sans-serif}path{fill:none;stroke:#9c4700;stroke-width:2}</style><rect width="100%" height="100%" fill="#fff"/><g>');

function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough || 1));
  return [1, 2, 5, 10].map(it => it * power).find(it => it >= rough) ?? rough;
}

/** Returns the runs as comma-separated values. */
export function csv(records, tick) {
  const rows = records.map(({ run, outcome, ticks }) => [run, outcome.kind, ticks, ticks * tick].join());
  return ['run,outcome,ticks,seconds', ...rows].join('\n') + '\n';
}
