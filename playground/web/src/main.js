// Main module of the playground page: connects its parts.
import './style.css';
import engineUrl from '../../target/stochc_playground.wasm?url';
import pictures from 'virtual:pictures';
import { Editor, units } from './editor.js';
import { Engine, load, Stopped } from './engine.js';
import { csv, curve, Ensemble, standalone } from './ensemble.js';
import { LESSONS } from './lessons.js';
import { markdown } from './markdown.js';
import { planner } from './plan.js';
import { pack, unpack } from './share.js';
import { Stage } from './stage.js';

const element = id => document.getElementById(id);

/** Time after which a check is stopped [ms]. */
const PATIENCE = 15000;
/** Limit on a run [ticks], as in the command. */
const MAX_TICKS = 1_000_000;

/** Description of the cost of each model. */
const COSTS = {
  rigid: 'Physics with collisions, drag, agitation and attraction. A short run takes a fraction of a second to compute.',
  rate: 'No motion: waiting times are drawn from rates that were calibrated with physics. Thousands of runs per second.',
  shuffle: 'No physics: captures in random order, one per tick. Times have no meaning.',
};

/** Description of each example, and its picture. */
const EXAMPLES = {
  'gate.sa': ['A gate', 'Two posts and a lintel: the smallest complete program.', 'gate'],
  'line.sa': ['Tower', 'Thirteen blocks in a row, open on every side.', 'line'],
  'open_platform.sa': ['Open platform', 'A stem and a ring that never touches itself.', 'open_platform'],
  'closed_platform.sa': ['Closed platform', 'The same number of blocks as a closed plate.', 'closed_platform'],
  'five_tower.sa': ['Five towers', 'The last tower grows in a narrow gap between four others.', 'five_tower'],
  'five_tower_reconfigured.sa': ['Five towers, reconfigured', 'Arms drop blocks into the gap, which is faster.', 'five_tower_reconfigured'],
  'planned/five_towers.sa': ['Five towers, planned', 'The same towers, built in the order of the planner.', 'five_tower'],
  'planned/chair.sa': ['Chair', 'Written by the planner for a drawn shape.', 'chair'],
  'planned/serpentine.sa': ['Serpentine', 'Planned with scaffolds, which are removed again.', 'serpentine'],
  'lab/bowl.sa': ['Laboratory bowl', 'The gate in a tank of one’s own, in two orders.', 'bowl'],
  'lab/tank.sa': ['Stirred tank', 'Suction valves in a stirred cylinder of water.', 'tank'],
  'lab/air_table.sa': ['Air table', 'Squares slide on a cushion of air and build a T.', 'air_table'],
  'microns.sa': ['Micrometres', 'Cubes of 10 µm in water, moved by heat only.', 'microns'],
  'suction_growth.sa': ['Suction', 'A cross with four open valves at once, or one after the other.', 'suction_growth'],
  'experiment_1.sa': ['Recapture in oil', 'A block is rejected and captured by another face.', 'experiment_1'],
  'experiment_3.sa': ['Recapture by suction', 'A valve holds a block and releases it. Another valve captures it.', 'experiment_1'],
  'experiment_2.sa': ['Free blocks', 'Free blocks in stirred oil find each other.', 'free'],
};

/** First version of a program of one's own. */
const TEMPLATE = `assembly mine {
    seed plate 3 x 3 {
        M at (1, 1)
    }
    phase grow {
        M.up ->> T[1..3]
    }
}
`;

const state = {
  /** Name of the program, and the open lesson. */
  name: '', lesson: null,
  /** Result of the last check, and of the last check without errors. */
  check: null, good: null,
  /** Index of the shown assembly in the program. */
  program: 0,
  tab: 'structure', run: null, record: null, ensemble: null, estimate: null,
};

let editor, stage, about, checker, runner;

function node(tag, attributes = {}, ...children) {
  const made = Object.assign(document.createElement(tag), attributes);
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
}

const number = value => Math.round(value).toLocaleString('en');

/** Returns seconds as text, with the half-width of their interval if it is known. */
function duration(seconds, half = null) {
  const [unit, length] = seconds < 100 ? ['s', 1] : seconds < 6000 ? ['min', 60] : ['h', 3600];
  const digits = (value, count) => Number((value / length).toPrecision(count));
  return `${digits(seconds, 3)}${half === null ? '' : ` ± ${digits(half, 2)}`} ${unit}`;
}

let hiding;
function toast(words) {
  element('toast').textContent = words;
  element('toast').classList.add('shown');
  clearTimeout(hiding);
  hiding = setTimeout(() => element('toast').classList.remove('shown'), 3500);
}

// ---- programs ----

function openProgram(text, name) {
  stopAll();
  delete document.body.dataset.record;
  element('toast').classList.remove('shown');
  Object.assign(state, { name, model: undefined, lesson: null, program: 0, check: null, good: null, record: null, ensemble: null, estimate: null });
  element('lesson').hidden = true;
  element('results').replaceChildren();
  editor.open(text);
  element('file-name').textContent = name;
  show('structure');
  check();
}

function openExample(name) {
  openProgram(about.examples.find(example => example.name === name).text, name);
  history.replaceState(null, '', `#example=${name}`);
}

function openLesson(index) {
  const lesson = LESSONS[index];
  openProgram(lesson.program, `Lesson ${index + 1}`);
  state.lesson = index;
  state.isDone = false;
  history.replaceState(null, '', `#lesson=${index + 1}`);
  drawLesson();
  check();
}

const finished = () => new Set(JSON.parse(read('finished') ?? '[]'));

/** Reads a stored value. The browser may not allow storage. */
function read(key) {
  try {
    return localStorage.getItem(`stochc-${key}`);
  } catch {
    return null;
  }
}

function write(key, value) {
  try {
    localStorage.setItem(`stochc-${key}`, value);
  } catch {
    // Without storage, nothing is saved.
  }
}

function drawLesson() {
  const place = element('lesson');
  place.hidden = state.lesson === null;
  if (place.hidden) return;
  const index = state.lesson;
  const lesson = LESSONS[index];
  const body = node('p');
  body.innerHTML = lesson.text;
  const task = node('p', { className: 'task' });
  task.innerHTML = lesson.task;
  place.classList.toggle('done', state.isDone);
  const isLast = index === LESSONS.length - 1;
  const next = isLast
    ? node('button', { onclick: () => gallery() }, 'See the examples')
    : node('button', { className: state.isDone ? 'primary' : '', id: 'next-lesson', onclick: () => openLesson(index + 1) }, state.isDone ? 'Next lesson' : 'Skip');
  place.replaceChildren(
    node('div', { className: 'count' }, `Lesson ${index + 1} of ${LESSONS.length}`),
    node('h2', {}, lesson.title),
    body,
    task,
    node('div', { className: 'row' },
      state.isDone ? node('span', { className: 'done-mark' }, '✓ Done.') : null,
      next,
      state.isDone || !(lesson.solution || lesson.fix) || lesson.solution?.(lesson.program) === lesson.program || lesson.fix ? null : node('button', { onclick: () => editor.replace(lesson.solution(lesson.program)) }, 'Show me'),
      node('button', { onclick: () => editor.replace(lesson.program) }, 'Start over')));
}

/** Checks whether the task of the lesson is solved. */
function judge() {
  if (state.lesson === null || state.isDone || !state.check) return;
  const lesson = LESSONS[state.lesson];
  const { check, record: run, ensemble } = state;
  if (!lesson.done({ check, run, ensemble, text: editor.text })) return;
  state.isDone = true;
  write('finished', JSON.stringify([...finished().add(state.lesson)]));
  drawLesson();
  // On narrow screens, the lesson may be out of view.
  toast(`✓ Lesson ${state.lesson + 1} is done. The next one is above the program.`);
}

// ---- checks ----

let waiting;
function changed() {
  clearTimeout(waiting);
  waiting = setTimeout(check, 180);
  if (state.record || state.ensemble) {
    stopAll();
    Object.assign(state, { record: null, ensemble: null });
    element('results').replaceChildren();
  }
  if (location.hash.startsWith('#p=')) history.replaceState(null, '', location.pathname + location.search);
}

let turn = 0;
async function check() {
  clearTimeout(waiting);
  const mine = ++turn;
  const text = editor.text;
  const limit = setTimeout(() => checker.stop(), PATIENCE);
  let result;
  try {
    result = await checker.call({ call: 'check', text });
  } catch (error) {
    if (mine === turn) element('problems').replaceChildren(node('p', {}, error instanceof Stopped ? 'The check takes too long here. Use the command `stochc check`.' : `The check has failed: ${error.message}`));
    return;
  } finally {
    clearTimeout(limit);
  }
  if (mine !== turn) return;
  state.check = result;
  state.checked = text;
  state.program = Math.min(state.program, Math.max(0, result.programs.length - 1));
  drawProblems();
  drawAssemblies();
  drawStructure();
  drawModels();
  judge();
  estimate(mine, text);
  document.body.dataset.checked = String(mine);
}

const errors = () => state.check.diagnostics.filter(({ severity }) => severity === 'error');
const current = () => state.check?.programs[state.program];

/** Returns whether a diagnostic is in the program itself, not in an imported example. */
const isOwn = ({ file }) => file === 'program.sa';

function drawProblems() {
  const { diagnostics, programs } = state.check;
  const at = units(state.checked);
  const range = ({ start, end }) => ({ from: at(start.offset), to: at(end.offset) });
  const fixes = diagnostic => {
    const edits = diagnostic.fix?.edits ?? [];
    if (!edits.length || !edits.every(isOwn)) return null;
    return () => editor.edit(edits.map(edit => ({ ...range(edit), text: edit.text })));
  };
  editor.mark(diagnostics.flatMap(diagnostic => diagnostic.labels.filter(isOwn).map((label, i) => ({
    ...range(label),
    severity: i ? 'info' : diagnostic.severity,
    message: i ? label.text : `${diagnostic.title}${label.text ? `: ${label.text}` : ''}`,
    source: diagnostic.code,
    actions: !i && fixes(diagnostic) ? [{ name: 'Fix', apply: () => fixes(diagnostic)() }] : [],
  }))));
  const list = diagnostics.map(diagnostic => {
    const labels = diagnostic.labels;
    const [first] = labels;
    const fix = fixes(diagnostic);
    const go = label => isOwn(label) && editor.select(...Object.values(range(label)));
    const [advice, ...rest] = (diagnostic.help ?? '').split('\n');
    const told = labels.filter(({ text }) => text).slice(0, 8);
    const more = told.length > 1 || rest.length > 0;
    return node('div', { className: `problem ${diagnostic.severity}` },
      node('div', { className: 'row' },
        node('strong', {}, `${diagnostic.severity}: `, ...spans(diagnostic.title)),
        first ? node('button', { className: 'link where', onclick: () => go(first) }, isOwn(first) ? `line ${first.start.line}` : first.file) : null),
      first?.text ? node('div', {}, ...spans(first.text)) : null,
      advice ? node('div', { className: 'advice' }, 'Help: ', ...spans(advice)) : null,
      node('div', { className: 'actions' },
        fix ? node('button', { className: 'primary fix', onclick: fix }, 'Fix: ', ...spans(diagnostic.fix.title)) : null,
        node('button', { className: 'explain-button', onclick: () => explain(diagnostic.code) }, `Explain ${diagnostic.code}`)),
      more ? node('details', { open: diagnostic.code === 'shape-mismatch' }, node('summary', {}, 'Details'),
        rest.length ? node('pre', { className: 'help', tabIndex: 0 }, rest.join('\n')) : null,
        told.length > 1 ? node('ul', {}, ...told.map(label => node('li', {}, `${isOwn(label) ? `line ${label.start.line}` : label.file}: `, ...spans(label.text)))) : null) : null);
  });
  if (!errors().length && programs.length) list.unshift(node('p', { className: 'ok' }, ...spans(proof(programs[state.program]))));
  if (!list.length) list.push(node('p', {}, 'No assembly yet. Write one, or open a lesson or an example.'));
  element('problems').replaceChildren(...list);
}

/** Returns a text of the compiler as elements. Text between backticks becomes code. */
function spans(text) {
  return text.split(/(`[^`]+`)/).filter(Boolean).map(part => (part.startsWith('`') && part.length > 2 ? node('code', {}, part.slice(1, -1)) : part));
}

/** Returns a sentence that states what was proved. */
function proof(program) {
  const plural = (n, one) => `${n} ${one}${n === 1 ? '' : 's'}`;
  const counts = [program.captures && plural(program.captures, 'capture'), program.releases && plural(program.releases, 'release')].filter(Boolean).join(' and ');
  if (program.kind === 'aggregate') return 'Correct. Free blocks meet by chance, so there is no structure to prove.';
  const { proved } = program;
  const facts = [proved?.completes && 'completes in every order of arrivals', proved?.no_cell_blocked && proved.no_cell_used_twice && 'no cell is blocked or used twice', ...(proved?.shapes ?? []).map(shape => `builds \`${shape}\``)].filter(Boolean);
  return `✓ ${counts || 'no captures'}. ${facts.length ? `Proved: ${facts.join(', ')}.` : ''}`;
}

function drawAssemblies() {
  const { programs } = state.check;
  const select = element('assembly');
  select.hidden = programs.length < 2;
  select.replaceChildren(...programs.map(({ name }, i) => new Option(name, String(i), false, i === state.program)));
}

function drawStructure() {
  const program = current();
  const isGood = program?.structure && !errors().length;
  const messages = program?.structure ? concerned(program.structure) : new Map();
  // Without event tables, the structure may be incomplete. It is shown if it shows an error.
  const isShown = program?.structure && (!program.structure.is_partial || messages.size > 0 || errors().every(({ code }) => code === 'shape-mismatch'));
  if (isShown) state.good = { program, text: state.checked };
  element('run').disabled = element('start').disabled = !isGood;
  let warning = '';
  if (!isGood) {
    if (messages.size) warning = 'The program has errors. Blocks with ⚠ show where.';
    else if (isShown) warning = 'The program has errors.';
    else if (state.good) warning = 'The program has errors. This is an earlier version.';
  }
  element('stale').textContent = warning;
  element('stale').hidden = !warning || state.tab !== 'structure';
  if (state.tab !== 'structure') return;
  empty(null);
  if (program?.kind === 'aggregate') return empty('An aggregate has no planned structure. Press Run to watch it.', isGood ? node('button', { className: 'primary', onclick: () => run() }, '▶ Run') : null);
  if (isShown) return stage.structure(program.structure, messages);
  if (!state.good) return empty(errors().length ? 'The structure appears here when the program has no errors.' : 'Nothing to show yet.');
  if (stage.shown?.kind !== 'structure') stage.structure(state.good.program.structure, new Map());
}

/** Returns the captures and seeds of a structure that diagnostics concern, each with a message. */
function concerned({ events, wrong, seeds, about }) {
  const found = new Map();
  const name = ({ role }) => `\`${about.tables.blocks[role].name}\``;
  const captures = events.filter(({ cell }) => cell);
  for (const { severity, title, labels } of state.check.diagnostics) {
    const message = `${severity}: ${title.replaceAll('`', '')}`;
    const at = (all, { start, end }) => all.filter(it => it.is_own && it.start <= start.offset && end.offset <= it.end);
    const own = labels.filter(isOwn);
    // The first label is the most important one. A wrong capture has no block, but its parent has.
    let places = own.map(label => at([...captures, ...seeds], label)).find(places => places.length) ?? [];
    if (!places.length) {
      const parents = new Set(own.flatMap(label => at(wrong, label)).map(({ parent }) => parent));
      places = [...captures, ...seeds].filter(({ role }) => parents.has(role));
    }
    const named = places.filter(it => title.includes(name(it)));
    for (const it of named.length ? named : places) if (!found.has(it) || severity === 'error') found.set(it, message);
  }
  return found;
}

function empty(words, button = null) {
  document.body.toggleAttribute('data-empty', words !== null);
  element('empty').hidden = words === null;
  if (words !== null) element('empty').replaceChildren(node('p', {}, words), ...(button ? [button] : []));
}

async function estimate(mine, text) {
  state.estimate = null;
  drawFacts();
  const program = current();
  if (!program?.structure || errors().length || program.kind === 'aggregate') return;
  try {
    const found = await checker.call({ call: 'estimate', text, program: state.program });
    if (mine !== turn) return;
    state.estimate = found;
    drawFacts();
  } catch (error) {
    if (!(error instanceof Stopped)) throw error;
  }
}

function drawFacts() {
  const place = element('facts');
  const found = state.estimate;
  if (!found?.total) return place.replaceChildren();
  const { total, tick, captures, is_guess, lower_bound } = found;
  const ticks = value => `${number(value)} ticks (${duration(value * tick)})`;
  const least = lower_bound?.length ? 'at least ' : '';
  const middle = total.mean ?? total.median;
  const slowest = captures.filter(({ share }) => share > 0).slice(0, 3).map(({ text, share, event }, i) => {
    const button = node('button', { className: 'link', onclick: () => reveal(event) }, text);
    return node('span', {}, i ? ', ' : '', button, ` ${Math.round(100 * share)} %`);
  });
  place.replaceChildren(
    node('p', {}, node('b', {}, `Expected: ${least}${ticks(middle)}`), total.p10 != null && total.p90 != null ? `, 80 % of the runs between ${number(total.p10)} and ${number(total.p90)} ticks.` : '.', is_guess ? ' This scene is not calibrated, so this is a rough estimate from kinetic theory.' : ''),
    slowest.length ? node('p', {}, 'Captures that take most of the time: ', ...slowest) : null ?? '');
}

/** Selects the statement of an event in the editor, and its block in the view. */
function reveal(id) {
  const event = state.good?.program.structure.events.find(event => event.id === id);
  if (!event?.is_own) return;
  const at = units(state.good.text);
  editor.select(at(event.start), at(event.end));
  stage.mark(id);
}

// ---- the stage ----

function show(tab) {
  state.tab = tab;
  document.body.dataset.tab = tab;
  for (const button of element('tabs').children) {
    const is = button.dataset.to === tab;
    button.setAttribute('aria-selected', is);
    button.tabIndex = is ? 0 : -1;
  }
  element('stale').hidden = true;
  if (!state.check) return;
  if (tab === 'structure') drawStructure();
  if (tab === 'run') {
    if (state.run?.kind === state.program && stage.shown?.kind === 'run') empty(null);
    else if (state.run?.stream.recording.frames.length) {
      empty(null);
      stage.show('run', state.run.about, state.run.stream.recording);
      stage.shown.growing = !state.record && state.run.isRunning;
    } else empty('Watch one run with physics while it is computed.', node('button', { className: 'primary', onclick: () => run(), disabled: !current()?.structure || errors().length > 0 }, '▶ Run'));
  }
  element('stop').hidden = !(tab === 'run' && state.run?.isRunning);
  stage.wake();
}

/** Updates the controls below the view. */
function told({ kind, player, history, scene, growing, recording }) {
  const tick = Math.floor(scene.tick);
  element('tick').value = String(tick);
  element('play').textContent = player.playing ? '❚❚' : '▶';
  element('play').setAttribute('aria-label', player.playing ? 'pause' : 'play');
  const message = stage.message;
  element('caption').classList.toggle('warned', message !== undefined);
  if (kind === 'structure') {
    element('now').textContent = `event ${tick} of ${player.end}`;
    element('caption').textContent = message ?? (tick ? recording.texts[tick - 1] : 'before the first event');
    return;
  }
  const seconds = tick * stage.shown.about.scene.tick;
  element('now').textContent = `${number(tick)} of ${number(player.end)} ticks`;
  element('speed').value = String(player.speed);
  const stops = history.stops.filter(stop => stop <= tick);
  const rows = history.rows.filter(row => row[0] === stops.at(-1) && history.isNotable(row));
  element('caption').textContent = `${duration(seconds)} · ${rows.length ? rows.map(row => history.words(row)).join('; ') : ''}${growing ? ' · computing' : ''}`;
}

async function run() {
  const program = current();
  if (!program?.structure || errors().length) return;
  stopRun();
  const { about } = program.structure;
  const bodies = about.scene.free?.count ?? 0;
  const expected = state.estimate?.total?.median;
  // The speed is chosen so that the expected run takes about 20 s.
  const speed = nearest(((expected ?? 2000) * about.scene.tick) / 20);
  const stream = stage.live(about, bodies, speed);
  const mine = (state.run = { stream, about, isRunning: true, kind: state.program });
  state.record = null;
  delete document.body.dataset.record;
  show('run');
  empty('The run begins …');
  element('stop').hidden = false;
  // On narrow screens, the view is below the program.
  element('right').scrollIntoView({ block: 'nearest' });
  try {
    const { record } = await runner.call(
      { call: 'watch', text: state.checked, program: state.program, model: 'rigid', seed: seed(), max_ticks: MAX_TICKS },
      (batch, numbers) => {
        if (state.run !== mine) return;
        stream.push(batch, numbers);
        if (state.tab === 'run') empty(null);
      });
    if (state.run !== mine) return;
    mine.isRunning = false;
    state.record = record;
    stream.finish();
    // If there was no estimate, the speed was a guess and is corrected now.
    if (!expected && stage.shown?.recording === stream.recording) stage.shown.player.setSpeed((record.ticks * about.scene.tick) / 20);
    const seconds = duration(record.ticks * about.scene.tick);
    toast(record.outcome.kind === 'completed' ? `The run completes after ${number(record.ticks)} ticks (${seconds} of the robots)` : `The run is ${record.outcome.kind.replace('_', ' ')} after ${number(record.ticks)} ticks`);
    document.body.dataset.record = JSON.stringify({ ticks: record.ticks, outcome: record.outcome.kind });
    judge();
  } catch (error) {
    if (state.run === mine) mine.isRunning = false;
    if (!(error instanceof Stopped)) empty(`The run has failed: ${error.message}`);
  } finally {
    if (state.run === mine) element('stop').hidden = true;
  }
}

const nearest = wanted => stage.parts.SPEEDS.reduce((best, speed) => (Math.abs(Math.log(speed / wanted)) < Math.abs(Math.log(best / wanted)) ? speed : best));
const seed = () => Math.max(0, Math.min(2 ** 32 - 1, Math.floor(Number(element('seed').value)) || 0));

function stopRun() {
  if (state.run?.isRunning) runner.stop();
  if (state.run) {
    state.run.isRunning = false;
    state.run.stream.finish();
  }
  state.run = null;
  element('stop').hidden = true;
}

function stopAll() {
  if (state.run) {
    if (state.run.isRunning) runner.stop();
    state.run = null;
    element('stop').hidden = true;
    if (state.tab === 'run') show('structure');
  }
  state.ensemble?.stop();
}

// ---- many runs ----

function drawModels() {
  const program = current();
  const chosen = state.model ?? element('model').value;
  const models = about.models.filter(({ name }) => name !== 'rate' || program?.has_rates);
  element('model').replaceChildren(...models.map(({ name }) => new Option({ rigid: 'physics', rate: 'rates', shuffle: 'random order' }[name], name)));
  element('model').value = models.some(({ name }) => name === chosen) ? chosen : 'rigid';
  element('cost').textContent = COSTS[element('model').value];
}

function startEnsemble() {
  if (!current()?.structure || errors().length) return;
  state.ensemble?.stop();
  const { about } = current().structure;
  const request = { text: state.checked, program: state.program, model: element('model').value, seed: seed(), max_ticks: MAX_TICKS };
  const ensemble = new Ensemble(request, Number(element('runs').value), () => drawEnsemble(about));
  state.ensemble = ensemble;
  element('cancel').hidden = false;
  drawEnsemble(about);
  ensemble.done.catch(error => toast(`The runs have failed: ${error.message}`));
}

let drawing = false;
function drawEnsemble(about) {
  if (drawing) return;
  drawing = true;
  requestAnimationFrame(() => {
    drawing = false;
    const { ensemble } = state;
    if (!ensemble) return;
    const { records, runs, isRunning, request, summary } = ensemble;
    element('cancel').hidden = !isRunning;
    const { tick } = about.scene;
    const total = records.length;
    const completed = records.filter(({ outcome }) => outcome.kind === 'completed').length;
    const { times, shares } = summary;
    const parts = [node('progress', { max: runs, value: total, ariaLabel: 'runs' })];
    if (!total) parts.push(node('p', { className: 'hint' }, 'The first runs begin …'));
    else {
      const figure = node('div');
      figure.innerHTML = curve(summary, tick, runs);
      const cell = text => node('td', { className: 'number' }, text);
      const row = (name, value, half) => value !== null && node('tr', {}, node('th', { scope: 'row' }, name), cell(number(value) + (half === null ? '' : ` ± ${number(half)}`)), cell(duration(value * tick, half && half * tick)));
      parts.push(node('h3', {}, `${completed} of ${total} runs complete${isRunning ? `, ${runs - total} to come` : total < runs ? ', stopped' : ''}`), figure);
      if (times) {
        const rows = [row('mean', times.mean, times.half_width), row('median', times.median, times.median_half_width), row('10 % of the runs by', times.p10, times.p10_half_width), row('90 % of the runs by', times.p90, times.p90_half_width)];
        parts.push(node('table', {}, node('thead', {}, node('tr', {}, node('th', {}, 'completion time'), node('th', { className: 'number' }, 'ticks'), node('th', { className: 'number' }, 'robots’ time'))), node('tbody', {}, ...rows.filter(Boolean))),
          node('p', { className: 'hint' }, '± is half the width of the 95 % confidence interval. The band of the curve shows these intervals.'));
      }
      if (shares.length) {
        parts.push(node('h3', {}, 'Bottleneck'), node('p', { className: 'hint' }, 'Share of the completion time during which the critical path waits for an event.'), node('table', { id: 'bottleneck' }, node('tbody', {}, ...shares.map(({ event, share }) => node('tr', {}, node('th', { scope: 'row' }, node('button', { className: 'link', onclick: () => revealText(event) }, event)), cell(`${Math.round(100 * share)} %`))))));
      }
      parts.push(node('p', { className: 'hint' }, `Model ${request.model}, seed ${request.seed}: the same runs as `, node('code', {}, `stochc simulate --model ${request.model} --seed ${request.seed} --runs ${runs}`), '. '), node('button', { onclick: () => download(csv(records, tick), `${about.program}.csv`, 'text/csv') }, 'Download CSV'), ' ', node('button', { onclick: () => download(standalone(curve(summary, tick, runs)), `${about.program}.svg`, 'image/svg+xml') }, 'Download SVG'));
    }
    element('results').replaceChildren(...parts);
    document.body.dataset.runs = String(total);
    judge();
  });
}

function revealText(text) {
  const event = state.good?.program.structure.events.find(event => event.text === text);
  if (event) reveal(event.id);
}

function revealRole(role) {
  const event = state.good?.program.structure.events.find(event => event.role === role && event.cell);
  if (event) reveal(event.id);
}

// ---- dialogs, files, links ----

function dialog(title, ...body) {
  element('dialog-title').textContent = title;
  element('dialog-body').replaceChildren(...body);
  element('dialog').showModal();
  element('dialog-body').scrollTop = 0;
}

async function explain(code) {
  const { page } = await checker.call({ call: 'explain', code });
  const body = node('div', { className: 'explain' });
  body.innerHTML = markdown(page);
  dialog(code, body);
}

function gallery() {
  // Free blocks have no structure to draw.
  const places = [[20, 40, 10], [60, 25, 50], [95, 60, 25], [112, 60, 25], [150, 30, 70], [140, 80, 40], [45, 80, 65]];
  const free = `<svg xmlns="http://www.w3.org/2000/svg" width="180" height="106">${places.map(([x, y, turn]) => `<rect x="-8" y="-8" width="16" height="16" fill="#8a94a6" stroke="#fff" transform="translate(${x} ${y}) rotate(${turn})"/>`).join('')}</svg>`;
  const cards = Object.entries(EXAMPLES).map(([name, [title, words, picture]]) => {
    const image = node('img', { alt: '', src: `data:image/svg+xml,${encodeURIComponent({ ...pictures, free }[picture])}` });
    return node('button', { onclick: () => { element('dialog').close(); openExample(name); } }, node('span', { className: 'picture' }, image), node('b', {}, title), node('small', {}, words));
  });
  dialog('Examples', node('div', { className: 'gallery' }, ...cards));
}

function drawShape() {
  // A run would delay the plan.
  stopAll();
  dialog('Draw a structure', planner({ node, call: request => runner.call(request), open: plan => openPlan(plan, 'drawing.sa') }));
}

function lessons() {
  const done = finished();
  const items = LESSONS.map(({ title }, i) => node('li', {}, node('button', { onclick: () => { element('dialog').close(); openLesson(i); } }, `${i + 1}. ${title}${done.has(i) ? ' ✓' : ''}`)));
  dialog('Lessons', node('p', { className: 'hint' }, 'The lessons lead from one capture to a scene of your own. Each lesson has a task that the page checks.'), node('ol', { className: 'lessons' }, ...items));
}

function download(text, name, type) {
  const link = node('a', { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

async function openFile(file) {
  if (/\.vox$/i.test(file.name)) return planVoxels(file);
  if (file.size > 1 << 20) return toast('This file is larger than 1 MiB.');
  openProgram(await file.text(), file.name);
  history.replaceState(null, '', location.pathname + location.search);
}

/** Opens a planned program for the shape in a MagicaVoxel file. */
async function planVoxels(file) {
  stopAll();
  toast('Planning …');
  try {
    const vox = [...new Uint8Array(await file.arrayBuffer())];
    openPlan(await runner.call({ call: 'plan', drawing: { vox } }), file.name.replace(/vox$/i, 'sa'));
  } catch (error) {
    toast(`${file.name} cannot be planned: ${error.message}`);
  }
}

function openPlan({ text, notes }, name) {
  element('dialog').close();
  openProgram(text, name);
  history.replaceState(null, '', location.pathname + location.search);
  toast(['Planned', ...notes].map(sentence => `${sentence}.`).join(' '));
}

async function share() {
  const fragment = await pack({ text: editor.text, program: state.program, model: element('model').value, seed: seed(), tab: state.tab });
  history.replaceState(null, '', fragment);
  try {
    await navigator.clipboard.writeText(location.href);
    toast('The link is copied. It contains the program; nothing is uploaded.');
  } catch {
    toast('The link is in the address bar. It contains the program; nothing is uploaded.');
  }
}

/** Opens the program that the address contains. */
async function recall() {
  const { hash } = location;
  try {
    const shared = await unpack(hash);
    if (shared) {
      openProgram(shared.text, 'shared program');
      state.program = Number.isInteger(shared.program) ? Math.max(0, shared.program) : 0;
      if (Number.isInteger(shared.seed)) element('seed').value = String(shared.seed);
      if (shared.tab === 'runs') show('runs');
      state.model = shared.model;
      check();
      return;
    }
  } catch (error) {
    welcome();
    return toast(`This link is damaged: ${error.message}`);
  }
  const asked = new URLSearchParams(hash.slice(1));
  const lesson = Number(asked.get('lesson'));
  if (lesson >= 1 && lesson <= LESSONS.length) return openLesson(lesson - 1);
  const example = asked.get('example');
  if (about.examples.some(({ name }) => name === example)) return openExample(example);
  welcome();
}

/** Opens the page that a newcomer sees first. */
function welcome() {
  openProgram(about.examples.find(({ name }) => name === 'gate.sa').text, 'gate.sa');
  const place = element('lesson');
  place.hidden = false;
  place.classList.remove('done');
  place.replaceChildren(
    node('h2', {}, 'Structures that build themselves, by chance'),
    node('p', {}, 'Cubes without motors drift in an agitated tank. A program lists which face of which block attracts the next block. This program builds the gate in the picture. stochc has proved that it completes in every order of arrivals.'),
    node('div', { className: 'row' },
      node('button', { className: 'primary', onclick: () => run() }, '▶ Watch it build itself'),
      node('button', { onclick: () => openLesson(0) }, `Learn it in ${LESSONS.length} short lessons`),
      node('button', { onclick: () => { place.hidden = true; } }, 'Close')));
}

function hover(position) {
  if (!state.good || state.good.text !== editor.text) return null;
  const at = units(state.good.text);
  const found = state.good.program.structure.events.filter(event => event.is_own && at(event.start) <= position && position <= at(event.end));
  if (!found.length) return null;
  const { phases } = state.good.program.structure.about.tables;
  const waits = new Map((state.estimate?.captures ?? []).map(it => [it.event, it]));
  const lines = found.slice(0, 6).map(event => {
    const cell = event.cell ? ` in cell (${event.cell.join(', ')})` : '';
    const wait = waits.get(event.id);
    return `${event.text}${cell}${wait ? `, waits ${number(wait.wait)} ticks` : ''}`;
  });
  if (found.length > 6) lines.push(`and ${found.length - 6} more`);
  return { from: Math.min(...found.map(({ start }) => at(start))), to: Math.max(...found.map(({ end }) => at(end))), lines: [`phase ${phases[found[0].phase]?.name ?? ''}`, ...lines] };
}

async function format() {
  try {
    const { text } = await checker.call({ call: 'format', text: editor.text });
    if (!editor.replace(text)) toast('The layout is standard already.');
  } catch (error) {
    toast(error.message);
  }
}

async function start() {
  await load(engineUrl);
  [checker, runner] = [new Engine(), new Engine()];
  about = await checker.call({ call: 'about' });
  const theme = read('theme');
  if (theme) document.documentElement.dataset.theme = theme;
  stage = new Stage(about.palette, {
    told,
    selected(role) {
      if (role !== null) revealRole(role);
    },
  });
  const style = document.documentElement.style;
  about.palette.phases.forEach(({ colour }, i) => style.setProperty(`--phase-${i}`, colour));
  const colours = () => {
    const dark = document.documentElement.dataset.theme ? document.documentElement.dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
    for (const [name, colour] of Object.entries(about.palette[dark ? 'dark' : 'light'])) {
      const sample = document.querySelector(`#legend .${name}`);
      if (sample) sample.style.background = colour;
    }
    document.querySelector('#legend .held').style.background = `linear-gradient(90deg, ${about.palette.phases[0].colour} 50%, ${about.palette.phases[1].colour} 50%)`;
    stage.wake();
  };
  colours();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', colours);
  editor = new Editor(element('editor'), {
    changed, run: () => run(), format, hover, terms: about.terms,
    names: () => (state.good?.program.structure.about.tables.blocks ?? []).map(({ name }) => name.replace(/\[.*/, '')),
    moved(offset) {
      if (!state.good || state.good.text !== editor?.text || state.tab !== 'structure') return;
      const at = units(state.good.text);
      const event = state.good.program.structure.events.find(event => event.is_own && at(event.start) <= offset && offset <= at(event.end));
      stage.mark(event?.id ?? -1);
    },
  });
  stage.parts.SPEEDS.forEach(speed => element('speed').append(new Option(`${speed}×`, String(speed))));
  const player = act => () => {
    if (stage.shown) act(stage.shown.player);
  };
  const buttons = {
    run, format, share, examples: gallery, lessons, draw: drawShape,
    new() {
      openProgram(TEMPLATE, 'mine.sa');
      history.replaceState(null, '', location.pathname + location.search);
      editor.focus();
    },
    open: () => element('file').click(),
    save: () => download(editor.text, /\.sa$/.test(state.name) ? state.name.split('/').at(-1) : 'program.sa', 'text/plain'),
    close: () => element('dialog').close(),
    stop: () => { stage.shown.growing = false; stopKeeping(); },
    cancel: () => state.ensemble?.stop(),
    arrows: () => {
      stage.arrows = !stage.arrows;
      element('arrows').setAttribute('aria-pressed', stage.arrows);
      if (stage.shown) stage.shown.scene.arrows = stage.arrows;
      stage.wake();
    },
    play: player(it => it.toggle()),
    previous: player(it => (stage.shown.kind === 'structure' ? it.jump(it.tick - 1) : it.event(-1, false))),
    next: player(it => (stage.shown.kind === 'structure' ? it.jump(it.tick + 1) : it.event(1, false))),
    theme: () => {
      const dark = (document.documentElement.dataset.theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light')) === 'dark';
      document.documentElement.dataset.theme = dark ? 'light' : 'dark';
      write('theme', document.documentElement.dataset.theme);
      colours();
    },
  };
  for (const [id, act] of Object.entries(buttons)) element(id).addEventListener('click', () => act());
  element('tick').addEventListener('input', player(it => it.jump(Number(element('tick').value))));
  element('speed').addEventListener('change', player(it => it.setSpeed(Number(element('speed').value))));
  element('model').addEventListener('change', () => {
    state.model = element('model').value;
    element('cost').textContent = COSTS[state.model];
  });
  element('settings').addEventListener('submit', event => {
    event.preventDefault();
    startEnsemble();
  });
  element('assembly').addEventListener('change', () => {
    stopAll();
    state.program = Number(element('assembly').value);
    check();
  });
  element('tabs').addEventListener('click', ({ target }) => target.dataset.to && show(target.dataset.to));
  element('tabs').addEventListener('keydown', event => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const all = [...element('tabs').children];
    const to = all[(all.indexOf(event.target) + step + all.length) % all.length];
    show(to.dataset.to);
    to.focus();
  });
  element('dialog').addEventListener('click', event => event.target === element('dialog') && element('dialog').close());
  element('file').addEventListener('change', async ({ target }) => {
    const [file] = target.files;
    if (file) await openFile(file);
    target.value = '';
  });
  addEventListener('dragover', event => event.preventDefault());
  addEventListener('drop', event => {
    const [file] = event.dataTransfer.files;
    if (!file) return;
    event.preventDefault();
    openFile(file);
  });
  addEventListener('hashchange', recall);
  await recall();
  document.body.dataset.ready = 'yes';
}

/** Stops the running simulation, and keeps the part that was computed. */
function stopKeeping() {
  if (!state.run?.isRunning) return;
  const { stream } = state.run;
  runner.stop();
  state.run.isRunning = false;
  stream.finish();
  element('stop').hidden = true;
}

start().catch(error => {
  document.body.replaceChildren(node('p', { style: 'padding: 2em', role: 'alert' }, `The playground cannot start: ${error.message}`));
  throw error;
});
