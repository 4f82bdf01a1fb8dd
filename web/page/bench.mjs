// What the page costs: node web/page/bench.mjs BODY.palpable. Prints one JSON object: ms from opening the page to its
// first picture, the body at rest, and until it can be pressed, from a disk with everything in it and from a server;
// and frames a second while a finger presses. PALPABLE names the program that writes the pages (build/release/bin/palpable).
// WebGL is drawn in software here; a machine with graphics draws at the rate of its screen.
import { mkdtempSync, readdirSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { launch, serve, writePage } from './browser.mjs';

const kLargestInline = 50e6; // bytes of a body; a larger one is only served
const kPressed = 4;          // s, how long the finger stays

async function firstPicture(browser, url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  await page.goto(url, { waitUntil: 'commit' });
  const [picture, ready] = await page.evaluate(async () => {
    while (!globalThis.palpablePage) await new Promise((done) => setTimeout(done, 5));
    await palpablePage;
    return ['first picture', 'ready'].map((name) => performance.getEntriesByName(`palpable: ${name}`)[0].startTime);
  });
  return { page, ms: { first_picture: Math.round(picture), ready: Math.round(ready) } }; // since the page was asked for
}

// Of frames that press at full depth, and the ms of the core's call in them.
async function pressed(page) {
  await page.mouse.move(640, 380);
  await page.mouse.down();
  const result = await page.evaluate(async (seconds) => {
    const shown = await palpablePage, wait = (s) => new Promise((done) => setTimeout(done, 1000 * s));
    await wait(1.5);
    const before = shown.frames, start = performance.now();
    await wait(seconds);
    const elapsed = (performance.now() - start) / 1000, fingers = shown.body.shown.length, frames = shown.frames - before;
    const times = [];
    for (let k = 0; k < 20; ++k) {
      const from = performance.now();
      shown.body.step(from / 1000, true);
      times.push(performance.now() - from);
    }
    return { frames_a_second: frames / elapsed, core_ms: times.sort((a, b) => a - b)[10], fingers };
  }, kPressed);
  await page.mouse.up();
  if (result.fingers !== 1) throw new Error('the middle of the picture shows no body to press');
  return { frames_a_second: Number(result.frames_a_second.toFixed(1)), core_ms: Number(result.core_ms.toFixed(2)) };
}

const file = process.argv[2];
if (!file) {
  console.error('node web/page/bench.mjs BODY.palpable');
  process.exit(2);
}
const folder = mkdtempSync(join(tmpdir(), 'palpable-page-')), browser = await launch();
const served = join(folder, 'served');
writePage(served, [file], 'never');
const delivered = readdirSync(served).find((name) => name.endsWith('.palpweb'));
const server = await serve(served);
const result = { body: basename(file), body_bytes: statSync(join(served, delivered)).size };
if (result.body_bytes <= kLargestInline) {
  writePage(join(folder, 'inline'), [file], 'always');
  const path = join(folder, 'inline/index.html');
  result.page_bytes = statSync(path).size;
  const { page, ms } = await firstPicture(browser, `file://${path}`);
  await page.close();
  result.from_disk_ms = ms;
}
const { page, ms } = await firstPicture(browser, server.url);
Object.assign(result, { from_server_ms: ms }, await pressed(page));
console.log(JSON.stringify(result, null, 2));
await browser.close();
server.close();
rmSync(folder, { recursive: true });
