// What the core costs: node web/bench.mjs BODY.palpweb [--browser]. Prints one JSON object: in Node, and with --browser
// in headless Chromium (web/page/build.sh installs playwright-core), there without the 10,000 frames.
import { readFile } from 'node:fs/promises';
import { measure } from './bench/measure.js';

const words = process.argv.slice(2), file = words.find((word) => word !== '--browser');
if (!file) {
  console.error('node web/bench.mjs BODY.palpweb [--browser]');
  process.exit(2);
}
const [wasm, bytes] = [await readFile(new URL('./dist/palpable.wasm', import.meta.url)), await readFile(file)];

async function inBrowser() {
  const { launch, root, serve } = await import('./page/browser.mjs');
  const server = await serve(`${root}web`), browser = await launch();
  try {
    const page = await browser.newPage();
    await page.route('**/bench/body', (route) => route.fulfill({ body: bytes, contentType: 'application/octet-stream' }));
    await page.route('**/bench/', (route) => route.fulfill({
      body: '<!doctype html>', contentType: 'text/html',
      headers: { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' },
    }));
    await page.goto(`${server.url}bench/`);
    return await page.evaluate(async () => {
      const fetched = async (url) => new Uint8Array(await (await fetch(url)).arrayBuffer());
      const { measure } = await import('/bench/measure.js');
      const result = await measure(await fetched('/dist/palpable.wasm'), await fetched('/bench/body'), false);
      return { browser: navigator.userAgent.match(/Chrome\/[\d.]+/)[0], ...result };
    });
  } finally {
    await browser.close();
    server.close();
  }
}

const result = words.includes('--browser') ? await inBrowser() : { node: process.version, ...await measure(wasm, bytes, true) };
console.log(JSON.stringify(result, null, 2));
