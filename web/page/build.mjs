// Bundles the page: node web/page/build.mjs. Writes web/dist/page, which `palpable export --to page`
// copies: the page with its style, its script twice, and the core that web/build.sh has compiled.
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
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
copyFileSync(here('../dist/palpable.wasm'), `${out}palpable.wasm`);
for (const name of ['index.html', 'page.js', 'page-classic.js', 'palpable.wasm']) {
  console.log(`web/dist/page/${name}: ${readFileSync(out + name).length} bytes`);
}
