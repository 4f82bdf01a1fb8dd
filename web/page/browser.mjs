// A headless Chromium, a server of files, and pages that the program writes, for tests and benches.
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import { extname, join, normalize, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

const kTypes = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript; charset=utf-8', '.wasm': 'application/wasm',
                 '.palpweb': 'application/octet-stream', '.mjs': 'text/javascript; charset=utf-8' };

/** The source folder. */
export const root = fileURLToPath(new URL('../..', import.meta.url));
const program = () => resolve(process.env.PALPABLE ?? join(root, 'build/release/bin/palpable'));

/** What PALPABLE (left out: build/release/bin/palpable) writes of body files, with the bundle of web/dist/page.
 * @param {string} folder, @param {string[]} bodies, @param {'always' | 'never'} inline  of --inline */
export function writePage(folder, bodies, inline) {
  // It looks for the bundle in the folder that it runs in.
  execFileSync(program(), ['export', ...bodies.map((body) => resolve(body)), '--to', 'page', '-o', resolve(folder), '--inline', inline],
               { cwd: root, stdio: ['ignore', 'ignore', 'inherit'] });
}

/** Debian's, or that of PALPABLE_CHROMIUM; null: there is none. */
export const chromiumPath = () =>
  [process.env.PALPABLE_CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser'].find((path) => path && existsSync(path)) ?? null;

/** Chromium's arguments for a camera that shows a film over and over, 30 pictures a second. @param {string} film  JPEG files in a row, .mjpeg */
export const fakeCamera = (film) => ['--use-fake-device-for-media-stream', '--use-fake-ui-for-media-stream',
                                     `--use-file-for-fake-video-capture=${film}`];

/** With WebGL in software, as machines of CI have no graphics. @param {string[]} more  arguments */
export const launch = (more = []) => chromium.launch({
  executablePath: chromiumPath(),
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', ...more],
});

/** Serves a folder on 127.0.0.1, as an isolated origin: there performance.now() counts in steps of 5 us instead of 100.
 * @returns {Promise<{url: string, close: () => void}>} */
export async function serve(folder) {
  const server = createServer(async (request, answer) => {
    const name = normalize(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html');
    try {
      const bytes = await readFile(join(folder, name));
      answer.writeHead(200, { 'content-type': kTypes[extname(name)] ?? 'application/octet-stream', 'content-length': bytes.length,
                              'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' });
      answer.end(bytes);
    } catch {
      answer.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}
