// Takes the picture of the documents: a run of an example. usage: node playground/test/picture.mjs
import { fileURLToPath } from 'node:url';
import { launch } from './chromium.mjs';
import { serve } from './server.mjs';

const server = await serve();
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1280, height: 760 }, colorScheme: 'dark' });
await page.goto(`${server.url}#example=five_tower_reconfigured.sa`);
await page.waitForSelector('body[data-ready][data-checked]', { timeout: 60000 });
await page.click('#run');
await page.waitForSelector('body[data-record]', { timeout: 120000 });
if (await page.getAttribute('#play', 'aria-label') === 'pause') await page.click('#play');
await page.fill('#tick', '2100');
await page.waitForSelector('#toast:not(.shown)', { state: 'attached' });
await page.screenshot({ path: fileURLToPath(new URL('../../docs/pictures/playground.png', import.meta.url)) });
await browser.close();
server.close();
