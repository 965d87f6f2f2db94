// Tests the page in Chromium, used as a newcomer uses it. usage: node playground/test/browser.mjs
// [FOLDER]; writes screenshots to the folder
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { launch } from './chromium.mjs';
import { engine } from './engine.mjs';
import { serve } from './server.mjs';

const here = path => fileURLToPath(new URL(path, import.meta.url));
const [pictures] = process.argv.slice(2);

const server = await serve();
const browser = await launch();
const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
const page = await context.newPage();
const complaints = [];
page.on('console', message => message.type() === 'error' && complaints.push(message.text()));
page.on('pageerror', error => complaints.push(error.stack));

let tests = 0;
async function test(name, act) {
  try {
    await act();
    assert.deepEqual(complaints, [], 'the console has no errors');
    tests++;
  } catch (error) {
    await page.screenshot({ path: '/tmp/playground-failed.png' }).catch(() => {});
    throw new Error(`${name}: ${error.message} (picture: /tmp/playground-failed.png)`);
  }
}
const picture = name => pictures && page.screenshot({ path: `${pictures}/${name}.png` });
const data = name => page.evaluate(name => document.body.dataset[name], name);
const text = () => page.evaluate(() => document.querySelector('.cm-content').cmTile.view.state.doc.toString());

/** Performs an action, and waits until the changed program has been checked. */
async function checked(act) {
  const before = await data('checked');
  await act();
  await page.waitForFunction(before => document.body.dataset.checked !== before, before, { timeout: 30000 });
}

async function go(fragment) {
  await page.goto('about:blank');
  await page.goto(server.url + fragment);
  await page.waitForSelector('body[data-ready][data-checked]', { timeout: 60000 });
}

/** Replaces the program, as if the user typed it. */
async function type(program) {
  await page.click('.cm-content');
  await page.keyboard.press('Control+a');
  await checked(() => page.keyboard.insertText(program));
}

const isDone = () => page.waitForSelector('#lesson.done', { timeout: 60000 });

let requests;
await test('the page loads and proves its first program', async () => {
  await go('');
  assert.match(await page.textContent('#problems'), /7 captures.*Proved/);
  await page.waitForSelector('#facts b');
  requests = server.requests.length;
  await picture('start');
});

await test('a run is computed and equals that of the engine outside of the browser', async () => {
  await page.click('text=Watch it build itself');
  await page.waitForSelector('body[data-record]', { timeout: 60000 });
  const made = JSON.parse(await data('record'));
  const call = await engine(here('../target/stochc_playground.wasm'));
  const program = readFileSync(here('../../examples/gate.sa'), 'utf8');
  const [record] = call({ call: 'simulate', text: program, program: 0, model: 'rigid', seed: 1, first: 0, runs: 1 }).records;
  assert.deepEqual(made, { ticks: record.ticks, outcome: 'completed' });
  // The replay plays, and the slider rewinds it.
  await page.waitForFunction(() => Number(document.getElementById('tick').value) > 20);
  await picture('run');
  await page.focus('#tick');
  await page.keyboard.press('Home');
  await page.waitForFunction(() => document.getElementById('tick').value === '0');
  await page.click('#next');
  await page.waitForFunction(() => document.getElementById('tick').value !== '0');
});

await test('many runs by rates have a curve and a table', async () => {
  await page.click('#tab-runs');
  await page.selectOption('#model', 'rate');
  await page.selectOption('#runs', '200');
  await page.click('#start');
  await page.waitForFunction(() => document.body.dataset.runs === '200', null, { timeout: 60000 });
  await page.waitForFunction(() => document.getElementById('cancel').hidden);
  assert.match(await page.textContent('#results'), /200 of 200 runs complete/);
  assert.ok(await page.$('#results svg .curve'));
  // The last statistics arrive after the last run.
  await page.waitForFunction(() => /^share of 200 of 200/.test(document.querySelector('#results svg').getAttribute('aria-label')));
  assert.ok(await page.$('#results svg .band'));
  assert.match(await page.textContent('#results table'), /mean[\d,]+ ± [\d,]+/);
  const shares = (await page.locator('#bottleneck td').allTextContents()).map(Number.parseFloat);
  assert.ok(shares[0] > 10 && shares.reduce((a, b) => a + b) <= 101, shares.join());
  await page.click('#bottleneck button');
  await picture('runs');
});

await test('memory stays flat over 100 runs', async () => {
  await page.selectOption('#runs', '50');
  const used = async () => {
    const session = await context.newCDPSession(page);
    await session.send('HeapProfiler.collectGarbage');
    const { usedSize } = await session.send('Runtime.getHeapUsage');
    await session.detach();
    return { megabytes: usedSize / 2 ** 20, workers: page.workers().length };
  };
  const fifty = async () => {
    await page.click('#start');
    await page.waitForFunction(() => document.body.dataset.runs === '50' && document.getElementById('cancel').hidden, null, { timeout: 60000 });
    await page.waitForFunction(() => /^share of 50 of 50/.test(document.querySelector('#results svg').getAttribute('aria-label')));
  };
  await fifty();
  const before = await used();
  await fifty();
  await fifty();
  const after = await used();
  assert.ok(after.megabytes < before.megabytes + 5, `${before.megabytes} MiB, then ${after.megabytes} MiB`);
  assert.ok(after.workers <= before.workers, `${before.workers} workers, then ${after.workers}`);
});

await test('the page reacts while large programs are checked, estimated and simulated', async () => {
  const seeds = Array.from({ length: 225 }, (_, i) => [2 * (i % 15), 2 * Math.floor(i / 15)]);
  const lines = each => seeds.map(([x, y]) => each(x, y)).join('\n');
  const scene = 'scene big from hemisphere { free 6000 uniform  enclosure hemisphere { radius 12 m  wall 200 N/m } }';
  const program = `${scene}\nassembly big in big {\nseed plate 30 x 30 {\n${lines((x, y) => `S${x}_${y} at (${x}, ${y})`)}\n}\nphase grow {\n${lines((x, y) => `S${x}_${y}.up ->> T${x}_${y}[1..8]`)}\n}\n}\n`;
  // Counts the tasks of the page between a request and its reply.
  await page.evaluate(() => {
    window.turns = {};
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...rest) {
      const call = message.request?.call;
      if (call) {
        window.turns[call] ??= 0;
        let timer;
        const count = () => {
          window.turns[call]++;
          timer = setTimeout(count);
        };
        timer = setTimeout(count);
        this.addEventListener('message', () => clearTimeout(timer), { once: true });
      }
      post.call(this, message, ...rest);
    };
  });
  await checked(() => page.setInputFiles('#file', { name: 'big.sa', mimeType: 'text/plain', buffer: Buffer.from(program) }));
  assert.match(await page.textContent('#problems'), /1800 captures/);
  await page.waitForSelector('#facts b', { timeout: 120000 });
  await page.click('#tab-runs');
  await page.selectOption('#model', 'shuffle');
  await page.selectOption('#runs', '10');
  await page.click('#start');
  await page.waitForFunction(() => /^share of 10 of 10/.test(document.querySelector('#results svg')?.getAttribute('aria-label')), null, { timeout: 120000 });
  const turns = await page.evaluate(() => window.turns);
  for (const call of ['check', 'estimate', 'simulate', 'summarize']) assert.ok(turns[call] >= 1, JSON.stringify(turns));
  await go('');
  await page.click('#tab-runs');
});

await test('runs stop at once', async () => {
  await page.selectOption('#model', 'rigid');
  await page.selectOption('#runs', '1000');
  await page.click('#start');
  await page.click('#cancel');
  await page.waitForFunction(() => document.getElementById('cancel').hidden);
  assert.match(await page.textContent('#results'), /begin|stopped/);
});

await test('the lessons can be finished, from the first to the last', async () => {
  await go('#lesson=1');
  await page.click('.cm-content');
  await page.keyboard.press('Control+Home');
  for (let i = 0; i < 5; i++) await page.keyboard.press('ArrowDown');
  await page.keyboard.press('End');
  await page.keyboard.type('\nA.up -> B');
  await isDone();
  await page.click('#next-lesson');
  await page.click('#run');
  await isDone();
  await page.click('#next-lesson');
  for (const lesson of [3, 4]) {
    await page.click('text=Show me');
    await isDone();
    if (lesson === 3) await picture('lesson');
    await page.click('#next-lesson');
  }
  // The page shows a diagnostic and its fix.
  await page.waitForSelector('.problem.error .fix');
  assert.match(await page.textContent('.problem.error'), /can become unreachable/);
  assert.ok(await page.$('.cm-lintRange-error'));
  await picture('diagnostic');
  const before = await text();
  await page.click('.problem.error .fix');
  await isDone();
  assert.notEqual(await text(), before);
  assert.equal(await page.$('.problem.error'), null);
  // The fix can be undone and redone.
  await checked(() => page.keyboard.press('Control+z'));
  assert.equal(await text(), before);
  await checked(() => page.keyboard.press('Control+y'));
  await page.click('#next-lesson');
  for (const lesson of [6, 7, 8]) {
    await page.click('text=Show me');
    await isDone();
    await page.click('#next-lesson');
  }
  await checked(() => page.click('text=Show me'));
  await page.click('#tab-runs');
  await page.selectOption('#model', 'rigid');
  await page.selectOption('#runs', '10');
  await page.click('#start');
  await isDone();
  await page.click('#lessons');
  assert.equal(await page.locator('ol.lessons button', { hasText: '✓' }).count(), 9);
  await page.keyboard.press('Escape');
});

await test('a diagnostic is explained', async () => {
  await go('');
  await type('assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase grow { M.up -> A   M.up -> B }\n}\n');
  assert.match(await page.textContent('.problem.error'), /both take cell/);
  await page.click('.explain-button');
  await page.waitForSelector('dialog[open] .explain h3');
  assert.match(await page.textContent('#dialog-title'), /occupied-cell/);
  await page.keyboard.press('Escape');
});

await test('the picture marks the block of an error, and has arrows', async () => {
  // The cursor selects the block of its capture.
  await type('assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase grow {\n        M.up -> B\n        M.up -> A\n    }\n}\n');
  assert.match(await page.textContent('#stale'), /Blocks with ⚠/);
  await page.click('.cm-line:nth-child(4)');
  await page.waitForFunction(() => /^error: .*both take cell/.test(document.getElementById('caption').textContent));
  await picture('marked');
  assert.ok(await page.isVisible('canvas.arrows'));
  await page.click('#arrows');
  await page.waitForSelector('canvas.arrows', { state: 'hidden' });
  await page.click('#arrows');
});

await test('a program is laid out', async () => {
  await type('assembly a { seed plate 1 x 1 { M at (0,0) } phase grow { M.up->A } }');
  await checked(() => page.click('#format'));
  assert.match(await text(), /\n {4}phase grow \{ M\.up -> A \}\n/);
});

await test('a new program is typed, with indentation', async () => {
  await checked(() => page.click('#new'));
  assert.match(await page.textContent('#problems'), /3 captures/);
  await page.keyboard.press('Control+a');
  await checked(() => page.keyboard.type('assembly a {\nseed plate 1 x 1 { M at (0, 0) }\nphase grow {\nM.up -> A\nA.up -> B', { delay: 20 }));
  assert.equal(await text(), 'assembly a {\n    seed plate 1 x 1 { M at (0, 0) }\n    phase grow {\n        M.up -> A\n        A.up -> B\n    }\n}');
  // Completion knows scenes, and does not replace the names of new blocks.
  await page.keyboard.press('Control+End');
  await page.keyboard.type('\nscene s from hemisphere {\ngra', { delay: 20 });
  await page.waitForSelector('.cm-tooltip-autocomplete');
  assert.equal(await page.locator('.cm-tooltip-autocomplete li').first().textContent(), 'gravity');
  await page.keyboard.press('Escape');
});

await test('a link opens the program again', async () => {
  const program = '// Ünïcode 🧱\nassembly mine {\n    seed plate 1 x 1 {\n        M at (0, 0)\n    }\n    phase grow {\n        M.up ->> T[1..4]\n    }\n}\n';
  await type(program);
  await page.click('#share');
  await page.waitForFunction(() => location.hash.startsWith('#p='));
  const link = new URL(page.url()).hash;
  await go(link);
  assert.equal(await text(), program);
  assert.match(await page.textContent('#problems'), /4 captures/);
});

await test('a drawn structure gets a planned program', async () => {
  await go('');
  await page.click('#draw');
  assert.ok(await page.isDisabled('#plan-now'));
  const cell = (x, y) => page.click(`.drawing [data-at="${x},${y}"]`);
  // A gate: two posts of two blocks, and a lintel.
  for (const layer of [1, 2, 3]) {
    await cell(1, 3);
    await cell(3, 3);
    if (layer === 3) await cell(2, 3);
    else await page.click('#layer-above');
  }
  await picture('draw');
  await checked(() => page.click('#plan-now'));
  assert.match(await text(), /assembly build_drawing/);
  assert.match(await page.textContent('#problems'), /7 captures/);
  // Keys draw, too. A floating block cannot be built.
  await page.click('#draw');
  await page.focus('.drawing [tabindex="0"]');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Space');
  await page.click('#layer-above');
  await cell(5, 5);
  await page.click('#plan-now');
  await page.waitForFunction(() => /There is no plan/.test(document.querySelector('.plan [role=status]').textContent));
  await page.keyboard.press('Escape');
});

await test('a MagicaVoxel file is drawn', async () => {
  const chunk = (name, content, children = Buffer.alloc(0)) => {
    const head = Buffer.alloc(12);
    head.write(name);
    head.writeUInt32LE(content.length, 4);
    head.writeUInt32LE(children.length, 8);
    return Buffer.concat([head, content, children]);
  };
  const words = (...numbers) => Buffer.from(new Uint32Array(numbers).buffer);
  const cells = Buffer.from([0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 1, 1]);
  const main = chunk('MAIN', Buffer.alloc(0), Buffer.concat([chunk('SIZE', words(3, 3, 3)), chunk('XYZI', Buffer.concat([words(3), cells]))]));
  const voxels = Buffer.concat([Buffer.from('VOX '), words(150), main]);
  await page.click('#draw');
  await page.setInputFiles('.plan input[type=file]', { name: 'step.vox', mimeType: 'application/octet-stream', buffer: voxels });
  await page.waitForFunction(() => document.querySelector('.plan output').textContent === '3 blocks');
  await page.setInputFiles('.plan input[type=file]', { name: 'text.vox', mimeType: 'text/plain', buffer: Buffer.from('no voxels') });
  await page.waitForFunction(() => /cannot be read/.test(document.querySelector('.plan [role=status]').textContent));
  await page.keyboard.press('Escape');
  // A file that is opened in the page gets a program at once.
  const file = { name: 'step.vox', mimeType: 'application/octet-stream', buffer: voxels };
  await checked(() => page.setInputFiles('#file', file));
  assert.match(await page.textContent('#problems'), /3 captures/);
  await go('');
  await checked(() => page.evaluate(bytes => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([new Uint8Array(bytes)], 'step.vox'));
    document.body.dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
  }, [...voxels]));
  assert.equal(await page.textContent('#file-name'), 'step.sa');
  assert.match(await page.textContent('#problems'), /3 captures/);
});

await test('a hostile program in a link does no harm', async () => {
  await page.evaluate(async () => {
    const program = `assembly h { seed plate 1 x 1 { M at (0, 0) }\nphase p { for i in 1..2000000000 { M.up -> A }\n<img src=x onerror="window.hurt=1"> } }`;
    const stream = new Blob([JSON.stringify({ text: program, program: 1e9, seed: -5 })]).stream().pipeThrough(new CompressionStream('deflate-raw'));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    window.link = `#p=${btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '')}`;
  });
  await go(await page.evaluate(() => window.link));
  await page.waitForSelector('.problem.error');
  assert.equal(await page.evaluate(() => window.hurt), undefined);
  // A damaged link opens the first page.
  await go('#p=AAAA');
  assert.match(await page.textContent('#problems'), /7 captures/);
});

await test('narrow screens scroll in one direction only', async () => {
  for (const width of [320, 390, 820]) {
    await page.setViewportSize({ width, height: 800 });
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${width} px`);
    await picture(`narrow-${width}`);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
});

await test('fingers turn, zoom, select, rewind, edit and run', async () => {
  const phone = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const page = await phone.newPage();
  page.on('pageerror', error => complaints.push(error.stack));
  const session = await phone.newCDPSession(page);
  /** Moves fingers along lines `[x, y, x2, y2]`. */
  const fingers = async (...lines) => {
    const at = part => lines.map(([x, y, x2, y2], id) => ({ x: x + part * (x2 - x), y: y + part * (y2 - y), id }));
    const send = (type, touchPoints) => session.send('Input.dispatchTouchEvent', { type, touchPoints });
    await send('touchStart', at(0));
    for (let i = 1; i <= 8; i++) await send('touchMove', at(i / 8));
    await send('touchEnd', []);
  };
  await page.goto(server.url);
  await page.waitForSelector('body[data-ready][data-checked]', { timeout: 60000 });
  await page.evaluate(() => document.getElementById('stage').scrollIntoView({ block: 'center' }));
  const { x, y, width, height } = await page.locator('#arena').boundingBox();
  const [middle, level] = [x + width / 2, y + height / 2];
  const view = () => page.locator('#stage').screenshot().then(bytes => bytes.toString('base64'));
  /** Performs a gesture, and waits until the picture differs. */
  const changes = async gesture => {
    const before = await view();
    await gesture();
    for (let i = 0; i < 100; i++) {
      if (await view() !== before) return;
      await page.waitForTimeout(50);
    }
    throw new Error('the picture is the same');
  };
  const scrolled = await page.evaluate(() => scrollY);
  await changes(() => fingers([middle, level, middle + 60, level + 20]));
  await changes(() => fingers([middle - 20, level, middle - 100, level], [middle + 20, level, middle + 100, level]));
  assert.equal(await page.evaluate(() => scrollY), scrolled, 'the page does not scroll with the picture');
  // A block is under one of these points.
  const chosen = () => page.evaluate(() => {
    const { state } = document.querySelector('.cm-content').cmTile.view;
    return state.sliceDoc(state.selection.main.from, state.selection.main.to);
  });
  for (const share of [0.2, 0.35, 0.5, 0.65, 0.8]) if (!(await chosen())) await page.touchscreen.tap(x + share * width, level);
  assert.match(await chosen(), /->/);
  const slider = await page.locator('#tick').boundingBox();
  const along = share => slider.x + share * slider.width;
  await fingers([along(0.95), slider.y + slider.height / 2, along(0.4), slider.y + slider.height / 2]);
  assert.ok(Number(await page.inputValue('#tick')) < 5);
  await page.locator('.cm-line').nth(1).tap();
  const before = await page.getAttribute('body', 'data-checked');
  await page.keyboard.insertText('// A comment.');
  await page.waitForFunction(before => document.body.dataset.checked !== before, before, { timeout: 30000 });
  await page.locator('#run').tap();
  await page.waitForSelector('body[data-record]', { timeout: 60000 });
  if (pictures) await page.screenshot({ path: `${pictures}/phone.png` });
  await phone.close();
});

if (process.env.STOCHC_AXE) {
  await test('the page follows the rules of accessibility', async () => {
    for (const scheme of ['light', 'dark']) {
      await page.emulateMedia({ colorScheme: scheme });
      await go('#lesson=5');
      await page.waitForSelector('.problem.error');
      await page.evaluate(readFileSync(process.env.STOCHC_AXE, 'utf8'));
      const { violations } = await page.evaluate(() => window.axe.run({ runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa'] }));
      const words = violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(' | ')}`);
      assert.deepEqual(words, [], scheme);
    }
  });
}

await test('nothing is asked of the network after loading', async () => {
  await go('');
  const before = server.requests.length;
  await context.setOffline(true);
  await page.click('#examples');
  await checked(() => page.click('.gallery button:nth-child(2)'));
  await page.click('#run');
  await page.waitForSelector('body[data-record]', { timeout: 60000 });
  assert.deepEqual(server.requests.slice(before), []);
  // Opening the page makes four requests: for the page, the script, the style and the engine.
  assert.ok(requests <= 4, `${requests} requests`);
});

await browser.close();
server.close();
console.log(`playground: ${tests} tests in Chromium`);
