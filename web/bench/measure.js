// What the core costs, in Node or in a browser: both run this file. Times are those of performance.now().
import { load, loadBody, memoryBytes, Session, version } from '../index.js';
import { thingsOf } from '../test/frames.mjs';

const kWarm = 60, kFrames = 600, kLong = 10000;

const timed = async (work) => {
  const start = performance.now();
  const value = await work();
  return [value, performance.now() - start];
};
const short = (x) => Number(x.toPrecision(3));
const share = (sorted, part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];

/** ms a frame of one kind of thing: the call, and reading touches and views. */
function pressing(body, kind) {
  const session = new Session(body), rest = session.skin().vertices.slice(), times = [];
  let touches = 0;
  for (let k = 0; k < kWarm + kFrames; ++k) {
    const things = thingsOf(kind, k, rest), start = performance.now();
    session.pressAt(things, k + 1);
    touches += session.touches.length;
    session.skin().vertices;
    if (k >= kWarm) times.push(performance.now() - start);
  }
  session.close();
  times.sort((a, b) => a - b);
  return { median_ms: short(share(times, 0.5)), p99_ms: short(share(times, 0.99)), most_ms: short(times.at(-1)),
           touches_a_frame: short(touches / (kWarm + kFrames)) };
}

/** Bytes of the module's memory after the first frames, and after 10,000. */
function growth(body) {
  const session = new Session(body), rest = session.skin().vertices.slice();
  const press = (from, to) => {
    for (let k = from; k < to; ++k) session.pressAt(thingsOf('all', k, rest), k + 1);
    return memoryBytes();
  };
  const before = press(0, 300), after = press(300, 300 + kLong);
  session.close();
  return { frames: kLong, before_bytes: before, grown_bytes: after - before };
}

/** @param {Uint8Array} wasm  palpable.wasm, @param {Uint8Array} bytes  of a delivery file
 *  @param {boolean} long  with the 10,000 frames */
export async function measure(wasm, bytes, long) {
  const [, startMs] = await timed(() => load(wasm)), [body, loadMs] = await timed(() => loadBody(bytes));
  const result = { version: version(), wasm_bytes: wasm.length, start_ms: short(startMs), body_bytes: bytes.length,
                   load_ms: short(loadMs), memory_bytes: memoryBytes() };
  for (const kind of ['finger', 'palm', 'eight fingers']) result[kind.replace(' ', '_')] = pressing(body, kind);
  if (long) result.memory = growth(body);
  body.free();
  return result;
}
