// A headless Chromium and a server of files, for tests and the bench.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { existsSync } from 'node:fs';
import { extname, join, normalize } from 'node:path';
import { chromium } from 'playwright-core';

const kTypes = { '.html': 'text/html; charset=utf-8', '.js': 'text/javascript; charset=utf-8', '.wasm': 'application/wasm',
                 '.palpweb': 'application/octet-stream' };

/** Debian's, or that of PALPABLE_CHROMIUM; null: there is none. */
export const chromiumPath = () =>
  [process.env.PALPABLE_CHROMIUM, '/usr/bin/chromium', '/usr/bin/chromium-browser'].find((path) => path && existsSync(path)) ?? null;

/** With WebGL in software, as machines of CI have no graphics. */
export const launch = () => chromium.launch({
  executablePath: chromiumPath(),
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
});

/** Serves a folder on 127.0.0.1. @returns {Promise<{url: string, close: () => void}>} */
export async function serve(folder) {
  const server = createServer(async (request, answer) => {
    const name = normalize(new URL(request.url, 'http://x').pathname).replace(/\/$/, '/index.html');
    try {
      const bytes = await readFile(join(folder, name));
      answer.writeHead(200, { 'content-type': kTypes[extname(name)] ?? 'application/octet-stream', 'content-length': bytes.length });
      answer.end(bytes);
    } catch {
      answer.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}/`, close: () => server.close() };
}
