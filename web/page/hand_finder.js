// Finds hands in pictures: one interface, whatever finds them. Behind it is @mediapipe/hands in a thread of its own
// (hand_worker.js); another finder replaces these two files.

/** @typedef {{side: 'left' | 'right', score: number, points: Float32Array}} FoundHand
 *    points: 21 times x y z, MediaPipe's order; x and y in widths and heights of the picture from its upper left corner,
 *    z in its widths, towards the camera negative, from the wrist: known badly. side: of the mirrored hand; it flips at times.
 *    score: of the side, 0..1 */

const kFiles = 'hands/'; // beside the page: web/page/build.mjs puts them there, with files.json

export class HandFinder {
  #worker;
  #waiting = null; // of the picture that is looked at: done, failed
  #key = 0;
  /** ms, of the last picture. */
  ms = NaN;

  /** @param {(share: number) => void} onProgress  0..1, while the files come
   *  @returns {Promise<HandFinder>} @throws Error where they are not there */
  static async start(onProgress) {
    const folder = new URL(kFiles, document.baseURI), sizes = await filesOf(folder);
    const worker = new Worker(new URL('hand_worker.js', folder)), finder = new HandFinder(worker);
    await new Promise((done, failed) => {
      worker.onerror = (event) => failed(new Error(event.message || 'its script does not load'));
      worker.onmessage = ({ data }) => {
        if (data.progress) onProgress(data.progress);
        else if (data.failed) failed(new Error(data.failed));
        else if (data.ready) done();
      };
      worker.postMessage({ begin: { folder: folder.href, sizes } });
    }).catch((error) => { worker.terminate(); throw error; });
    worker.onmessage = ({ data }) => finder.#take(data);
    return finder;
  }
  constructor(worker) { this.#worker = worker; }

  get isBusy() { return this.#waiting !== null; }

  /** One picture at a time. @param {ImageData} picture  not mirrored; it is given away
   *  @returns {Promise<FoundHand[]>} */
  find(picture) {
    return new Promise((done, failed) => {
      this.#waiting = { done, failed };
      this.#worker.postMessage({ find: picture, key: ++this.#key }, [picture.data.buffer]);
    });
  }
  #take({ hands, ms, failed }) {
    const waiting = this.#waiting;
    this.#waiting = null;
    if (failed) return void waiting?.failed(new Error(failed));
    this.ms = ms;
    waiting?.done(hands);
  }
  close() { this.#worker.terminate(); }
}

/** Bytes of each file to fetch, or an Error that says that they are not there. */
export async function filesOf(folder = new URL(kFiles, document.baseURI)) {
  const answer = await fetch(new URL('files.json', folder));
  if (!answer.ok) throw new Error('the hand finder is not beside this page');
  return answer.json();
}
