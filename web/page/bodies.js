// Where the core and the bodies come from: files beside the page, or text in it. A page from a disk (file://) cannot
// fetch, therefore small pages hold everything as base64 (palpable export --to page --inline).
import { load } from '../index.js';
import { PressedBody } from './pressed_body.js';

/** @typedef {{name: string, file: string, bytes: number, material: string, stressTop: number,
 *              credit?: {text: string, url?: string, terms?: string}}} BodyFacts
 *  file: beside the page, or the id of the element with its base64; bytes: of the file; stressTop: Pa */

/** @returns {{inline: boolean, bodies: BodyFacts[]}} */
export const readPage = () => JSON.parse(document.getElementById('page').textContent);

function bytesIn(id) {
  const text = document.getElementById(id).textContent.trim();
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; ++k) bytes[k] = binary.charCodeAt(k);
  return bytes;
}

/** Starts the core. */
export const startCore = ({ inline }) => load(inline ? bytesIn('palpable.wasm') : new URL('palpable.wasm', document.baseURI));

/** @param {(share: number) => void} onProgress  0..1 */
export function loadFacts({ inline }, facts, onProgress) {
  if (inline) return PressedBody.load(bytesIn(facts.file), facts);
  // The length that the server states may be that of compressed bytes.
  return PressedBody.load(fetch(new URL(facts.file, document.baseURI)), facts,
                          (bytes) => onProgress(Math.min(bytes / facts.bytes, 1)));
}
