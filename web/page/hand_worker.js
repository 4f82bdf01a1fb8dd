// The hand finder's own thread. @mediapipe/hands 0.4.1675469240 is written for the page's thread, which it blocks for each
// picture; here it is given the few things of a page that it asks for. Nothing but this file and hand_finder.js knows it.
//
//   gets  {begin: {folder, sizes}}   address of its files, bytes of each
//         {find: ImageData, key}    
//   says  {progress: 0..1}, {ready: true}, {hands: [...], key, ms}, {failed: message}
const kMostHands = 2;
// Of finding and of following; the package has 0.5, with which a palm that turns is lost: 69 of 80 pictures instead of 79.
const kSurest = 0.35;

const elements = {
  canvas: () => Object.assign(new OffscreenCanvas(1, 1), { style: {}, addEventListener() {}, id: '' }),
  script: () => new ScriptElement(),
  div: () => ({ style: {}, appendChild() {} }),
};
class ScriptElement {
  #handlers = {};
  setAttribute(name, value) { this[name] = value; }
  addEventListener(name, handler) { this.#handlers[name] = handler; }
  load() {
    try {
      importScripts(this.src);
      this.#handlers.load?.();
    } catch (error) {
      report(error);
      this.#handlers.error?.();
    }
  }
}
self.window = self;
self.document = {
  createElement: (tag) => elements[tag](),
  body: { appendChild: (element) => { element.load?.(); } },
  addEventListener() {},
  removeEventListener() {},
  querySelector: () => null,
};

for (const word of ['log', 'info', 'warn', 'error']) console[word] = () => {}; // the package tells about itself at length

const report = (error) => postMessage({ failed: String(error?.message ?? error) });

/** Fetches the files and gives them to the package as addresses in memory, so that progress is that of all of them. */
async function fetchAll(folder, sizes) {
  const all = Object.values(sizes).reduce((sum, size) => sum + size, 0), places = {};
  let come = 0;
  for (const name of Object.keys(sizes)) {
    const answer = await fetch(new URL(name, folder));
    if (!answer.ok) throw new Error(`${name}: ${answer.status} ${answer.statusText}`);
    const reader = answer.body.getReader(), pieces = [];
    for (;;) {
      const { done, value } = await reader.read();
      if (done) break;
      pieces.push(value);
      come += value.length;
      postMessage({ progress: Math.min(come / all, 1) });
    }
    const type = name.endsWith('.js') ? 'text/javascript' : name.endsWith('.wasm') ? 'application/wasm' : 'application/octet-stream';
    places[name] = URL.createObjectURL(new Blob(pieces, { type }));
  }
  return places;
}

let finder = null, found = null;

async function begin({ folder, sizes }) {
  const places = await fetchAll(folder, sizes);
  importScripts(places['hands.js']);
  finder = new self.Hands({ locateFile: (name) => places[name] ?? new URL(name, folder).href });
  finder.setOptions({ maxNumHands: kMostHands, modelComplexity: 0, useCpuInference: true,
                      minDetectionConfidence: kSurest, minTrackingConfidence: kSurest });
  finder.onResults((results) => { found = results; });
  await finder.initialize();
  const blank = new OffscreenCanvas(64, 48); // the first picture costs a second
  blank.getContext('2d').fillRect(0, 0, 64, 48);
  await finder.send({ image: blank });
  postMessage({ ready: true });
}

async function find(image, key) {
  const from = performance.now();
  found = null;
  await finder.send({ image });
  const hands = (found?.multiHandLandmarks ?? []).map((points, k) => ({
    side: found.multiHandedness[k].label.toLowerCase(),
    score: found.multiHandedness[k].score,
    points: Float32Array.from(points.flatMap(({ x, y, z }) => [x, y, z])),
  }));
  postMessage({ hands, key, ms: performance.now() - from });
}

onmessage = ({ data }) => {
  if (data.begin) begin(data.begin).catch(report);
  else if (data.find) find(data.find, data.key).catch(report);
};
