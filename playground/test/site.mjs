// Tests the "Try it" links of the documentation. Its site must have been built with the playground.
// usage: node playground/test/site.mjs
import assert from 'node:assert/strict';
import { launch } from './chromium.mjs';
import { serve } from './server.mjs';

const PAGES = ['tutorials/first-structure.html', 'tutorials/your-tank.html', 'reference/language.html'];

const server = await serve('../../target/site');
const browser = await launch();
const page = await browser.newPage();
let links = 0;
for (const name of PAGES) {
  await page.goto(server.url + name);
  const program = await page.textContent('.highlight:has(+ p > a.try-it) code >> nth=0');
  links += await page.locator('a.try-it').count();
  await page.click('a.try-it >> nth=0');
  await page.waitForSelector('body[data-ready][data-checked]', { timeout: 60000 });
  const text = await page.evaluate(() => document.querySelector('.cm-content').cmTile.view.state.doc.toString());
  assert.equal(text.trim(), program.trim(), name);
}
await browser.close();
server.close();
console.log(`site: the first programs of ${PAGES.length} pages open in the playground; these pages have ${links} links`);
