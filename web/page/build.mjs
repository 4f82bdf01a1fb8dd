// Bundles the page: node web/page/build.mjs. Writes web/dist/page, which `palpable export --to page`
// copies: the page with its style, its script twice, and the core that web/build.sh has compiled.
import { copyFileSync, mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const out = here('../dist/page/');

const options = {
  entryPoints: [here('main.js')],
  bundle: true,
  minify: true,
  target: ['chrome95', 'firefox100', 'safari16.4'], // those that run the core
  loader: { '.glsl': 'text' },
  external: ['node:fs/promises'], // of the core under Node
  define: { 'import.meta.url': 'document.baseURI' }, // a classic script has no other
  legalComments: 'inline',
};
mkdirSync(out, { recursive: true });
// As a module for pages on a server, and as a classic script for pages that hold everything: a browser refuses modules
// of a disk.
await build({ ...options, format: 'esm', outfile: `${out}page.js` });
await build({ ...options, format: 'iife', outfile: `${out}page-classic.js` });
const style = await build({ entryPoints: [here('page.css')], minify: true, write: false,
                            target: options.target });
const page = readFileSync(here('index.html'), 'utf8').replace('/*palpable:style*/', () => style.outputFiles[0].text.trim());
writeFileSync(`${out}index.html`, page);
// The hand finder, which the page fetches when its visitor asks for it: the package's files that it needs, their sizes, and
// the thread that runs it. Of its models the lite one; every browser that runs the core has SIMD.
const kHands = ['hands.js', 'hands.binarypb', 'hand_landmark_lite.tflite', 'hands_solution_packed_assets.data',
                'hands_solution_packed_assets_loader.js', 'hands_solution_simd_wasm_bin.js', 'hands_solution_simd_wasm_bin.wasm'];
const from = here('../node_modules/@mediapipe/hands/');
mkdirSync(`${out}hands`, { recursive: true });
for (const name of kHands) copyFileSync(from + name, `${out}hands/${name}`);
await build({ ...options, entryPoints: [here('hand_worker.js')], format: 'iife', outfile: `${out}hands/hand_worker.js` });
writeFileSync(`${out}hands/files.json`, JSON.stringify(Object.fromEntries(kHands.map((name) => [name, statSync(from + name).size]))));
writeFileSync(`${out}hands/LICENSE.txt`, '@mediapipe/hands 0.4.1675469240, (c) Google, Apache-2.0: https://www.apache.org/licenses/LICENSE-2.0\n');
copyFileSync(here('../dist/palpable.wasm'), `${out}palpable.wasm`);
for (const name of ['index.html', 'page.js', 'page-classic.js', 'palpable.wasm']) {
  console.log(`web/dist/page/${name}: ${readFileSync(out + name).length} bytes`);
}
