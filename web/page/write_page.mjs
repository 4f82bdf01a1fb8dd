// What `palpable export BODY.palpweb... --to page -o DIR` writes, for tests before the program is built:
// node web/page/write_page.mjs DIR [--inline] BODY.palpweb...
// It differs in the top of the colours' scale, which the program computes.
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const dist = fileURLToPath(new URL('../dist/', import.meta.url));
const kOfLargest = 0.35; // of the largest stress of any press; the program's tops are 0.12 (bunny) to 0.69 (post) of it

function factsOf(bytes, file) {
  const header = JSON.parse(bytes.subarray(32, 32 + Number(bytes.readBigUInt64LE(24))).toString());
  const facts = { name: header.name, file, bytes: bytes.length, material: header.values.material,
                  stressTop: kOfLargest * header.values.largest_von_mises };
  if (/bunny|dragon/.test(header.provenance.mesh_source)) {
    facts.credit = { text: 'Shape: Stanford Computer Graphics Laboratory', url: 'https://graphics.stanford.edu/data/3Dscanrep/',
                     terms: '(research use, free to pass on with credit, not commercial).' };
  }
  return facts;
}

/** @param {string} folder, @param {string[]} files  delivery files, @param {boolean} inline  all in index.html */
export function writePage(folder, files, inline) {
  mkdirSync(folder, { recursive: true });
  const base64 = (id, bytes) => `<script type="application/octet-stream" id="${id}">${bytes.toString('base64')}</script>\n`;
  let scripts = inline ? base64('palpable.wasm', readFileSync(join(dist, 'palpable.wasm'))) : '';
  const bodies = files.map((path) => {
    const bytes = readFileSync(path), file = basename(path);
    if (inline) scripts += base64(file, bytes);
    else writeFileSync(join(folder, file), bytes);
    return factsOf(bytes, file);
  });
  if (inline) {
    scripts += `<script>${readFileSync(join(dist, 'page/page-classic.js'), 'utf8')}</script>`;
  } else {
    scripts += '<script type="module" src="page.js"></script>';
    copyFileSync(join(dist, 'page/page.js'), join(folder, 'page.js'));
    copyFileSync(join(dist, 'palpable.wasm'), join(folder, 'palpable.wasm'));
  }
  const content = JSON.stringify({ inline, bodies }).replaceAll('<', '\\u003c');
  writeFileSync(join(folder, 'index.html'), readFileSync(join(dist, 'page/index.html'), 'utf8')
    .replace('/*palpable:page*/', () => content).replace('<!-- palpable:scripts -->', () => scripts));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [folder, ...files] = process.argv.slice(2).filter((word) => word !== '--inline');
  writePage(folder, files, process.argv.includes('--inline'));
}
