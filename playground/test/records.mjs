// Checks that runs in WebAssembly equal runs of the command, bit for bit, and that every example is
// correct. usage: node playground/test/records.mjs STOCHC
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { isDeepStrictEqual } from 'node:util';
import { engine } from './engine.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const [command = `${root}/target/debug/stochc`] = process.argv.slice(2);
const call = await engine(`${root}/playground/target/stochc_playground.wasm`);
const away = mkdtempSync(join(tmpdir(), 'playground-'));
let [records, failures] = [0, 0];

/** Model, program, number of runs, seed and time limit of each test. */
const CASES = readFileSync(`${root}/tests/identical-runs.txt`, 'utf8').split('\n')
  .filter(line => line && !line.startsWith('#'))
  .map(line => line.split(' '));

for (const [model, file, runs, seed, maxTicks] of CASES) {
  const path = `${root}/examples/${file}`;
  const out = join(away, `${model}-${file.replaceAll('/', '-')}`);
  const { status } = spawnSync(command, ['simulate', path, '--model', model, '--runs', runs, '--seed', seed, '--max-ticks', maxTicks, '--out', out, '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'] });
  // Exit status 3: some runs did not complete.
  if (status !== 0 && status !== 3) throw new Error(`${command} ends with status ${status}`);
  const lines = readFileSync(join(out, 'journal.jsonl'), 'utf8').trim().split('\n').map(line => JSON.parse(line));
  const native = lines.filter(({ record }) => record);
  const text = readFileSync(path, 'utf8');
  const programs = call({ call: 'check', text }).programs.length;
  for (let program = 0; program < programs; program++) {
    const request = { text, program, model, seed: Number(seed), max_ticks: Number(maxTicks) };
    const made = call({ call: 'simulate', ...request, first: 0, runs: Number(runs) }).records;
    for (const record of made) {
      records++;
      const other = native.find(line => line.program === program && line.record.run === record.run)?.record;
      if (other && isDeepStrictEqual(record, other)) continue;
      failures++;
      console.error(`${model} ${file}, program ${program}, run ${record.run}: the records differ`);
    }
    if (model !== 'rigid') continue;
    // Watching a run must not change its record.
    let frames = 0;
    const { record } = call({ call: 'watch', ...request, first: 0 }, ({ ticks }) => (frames += ticks.length));
    if (frames && isDeepStrictEqual(record, made[0])) continue;
    failures++;
    console.error(`${model} ${file}, program ${program}: the run that is watched differs`);
  }
}
const examples = call({ call: 'about' }).examples;
for (const { name, text } of examples) {
  const { diagnostics, programs } = call({ call: 'check', text });
  const errors = diagnostics.filter(({ severity }) => severity === 'error');
  if (!errors.length && programs.length && programs.every(({ structure }) => structure)) continue;
  failures++;
  console.error(`${name}: ${errors.map(({ title }) => title).join('; ') || 'no structure'}`);
}
rmSync(away, { recursive: true });
console.log(`playground: ${records} records equal those of the command; ${examples.length} examples are correct${failures ? `; ${failures} failures` : ''}`);
process.exit(failures ? 1 : 0);
