// Where the core and the bodies come from: files beside the page, or text in it. A page from a disk (file://) cannot
// fetch, therefore small pages hold everything as base64 (palpable export --to page --inline).
import { load } from '../index.js';
import { PressedBody } from './pressed_body.js';
import { RestingBody } from './resting_body.js';

/** @typedef {{name: string, file: string, bytes: number, material: string, stressTop: number,
 *              credit?: {text: string, url?: string, terms?: string},
 *              skin?: {vertices: string, triangles: string}}} BodyFacts
 *  file: beside the page, or the id of the element with its base64; bytes: of the file; stressTop: Pa;
 *  skin: at rest, base64 of float32 and uint32 */

/** @returns {{inline: boolean, bodies: BodyFacts[]}} */
export const readPage = () => JSON.parse(document.getElementById('page').textContent);

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; ++k) bytes[k] = binary.charCodeAt(k);
  return bytes;
}

const bytesIn = (id) => bytesOf(document.getElementById(id).textContent.trim());

/** When the browser has read the whole page: in a page of one file the bodies come after the script. */
const wholePage = () => new Promise((done) => {
  if (document.readyState !== 'loading') done();
  else document.addEventListener('DOMContentLoaded', done, { once: true });
});

/** The body at rest, which needs neither core nor tables; null in a page without it. */
export function restingBody(facts) {
  if (!facts.skin) return null;
  const [vertices, triangles] = [facts.skin.vertices, facts.skin.triangles].map((text) => bytesOf(text).buffer);
  return new RestingBody(facts, new Float32Array(vertices), new Uint32Array(triangles));
}

/** Starts the core. */
export const startCore = ({ inline }) => load(inline ? bytesIn('palpable.wasm') : new URL('palpable.wasm', document.baseURI));

/** @param {(share: number) => void} onProgress  0..1 */
export async function loadFacts({ inline }, facts, onProgress) {
  if (inline) {
    await wholePage();
    return PressedBody.load(bytesIn(facts.file), facts);
  }
  // The length that the server states may be that of compressed bytes.
  return PressedBody.load(fetch(new URL(facts.file, document.baseURI)), facts,
                          (bytes) => onProgress(Math.min(bytes / facts.bytes, 1)));
}
