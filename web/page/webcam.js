// The visitor's webcam: its picture behind the body, the hands in it found, followed, and put where they press. The body
// and the mouse go on as before. Nothing leaves the page: the pictures go to the finder's thread and no further.
import { handCapsules } from '../index.js';
import { filesOf, HandFinder } from './hand_finder.js';
import { forearm } from './hand_mask.js';
import { joints, kTip, onScreen, Plane, pointAt, pxPerMetre } from './hand_placing.js';
import { HandPresses, kFirstThing } from './hand_presses.js';
import { HandTracks } from './hand_tracks.js';

const kCamera = { video: { width: { ideal: 1280 }, height: { ideal: 720 }, facingMode: 'user' }, audio: false };
const kFound = 640;          // px, longer side of the picture in which hands are looked for
const kMeasures = 8;         // finds of a hand from which the body's size in the picture comes
const kSmallest = 0.16;      // of the free picture's shorter side: the body's radius at least
const kLargest = 0.42;       // and at most
const kWheel = 0.004;        // m of the plane for each step of the wheel
const kPatience = 50;        // ms: a browser that tells of no pictures is not waited for
const kNothingAfter = 3;     // s without a hand
const kPushed = 1.12;        // growth of a hand over the body that is a push towards the screen
const kPushTime = 0.7;       // s, over which
const kStays = 0.025;        // m of the hand's, across the picture meanwhile
const kSlowest = 1 / 24;     // s between frames, from which on less is drawn
const kOver = 0.5;           // s, of which the mean is taken
const kArea = 1e-3;          // m^2: a hand stops at this times the stress at the colours' top (bunny: 16 N)
const kEase = 6;             // 1/s, of the body's size

const at = (id) => document.getElementById(id);
const write = (id, text) => { if (at(id).textContent !== text) at(id).textContent = text; };
const now = () => performance.now() / 1000;

const kShowHand = 'Show a hand to the camera, fingers spread, and keep it in the light.';
const kHowTo = 'Press from the side: move your fingertip onto the body from its outline inwards.';
const kWhyNot = 'Pushing towards the screen does not press: one camera cannot tell how far away your finger is. ' +
  'The orange line is where it presses. Come from the side.';
const kTooFar = 'Your hand is too small or too large in the picture. Sit half a metre from the camera, or press R to measure it anew.';

/** Why there is no camera, for its visitor. */
export function cameraTrouble({ name, message }) {
  if (name === 'NotAllowedError') return 'The camera was refused. Allow it in the address bar and try again; the mouse goes on pressing.';
  if (name === 'NotFoundError' || name === 'OverconstrainedError') return 'There is no camera here. The mouse goes on pressing.';
  if (name === 'NotReadableError') return 'The camera is in use by another program. Close that and try again; the mouse goes on pressing.';
  return `The webcam does not start: ${message}. The mouse goes on pressing.`;
}

export class Webcam {
  #page;
  #video = at('camera');
  #stream = null;
  #finder = null;
  #tracks = new HandTracks();
  #presses = new HandPresses();
  #planes = new Map();  // by hand
  #shift = 0;           // m of the plane, by the wheel
  #measures = [];
  #zoom = null;         // that the orbit eases to
  #sizes = new Map();   // by hand, while it is over the body: time, px per metre, place
  #pushed = -Infinity;  // s, when a push towards the screen was seen last
  #seen = -Infinity;    // s, when a hand was
  #run = 0;
  #tooFar = false;
  /** For tests and benches: pictures that were looked at, those with a hand, hands that are there. */
  finds = 0;
  withHand = 0;
  hands = [];
  onFound = null;

  /** @param page  body, scene, orbit, redraw() */
  constructor(page) {
    this.#page = page;
    const dialog = at('leave');
    at('webcam').addEventListener('click', () => {
      if (this.isOn || this.#isStarting) this.stop();
      else this.#offer(dialog);
    });
    dialog.addEventListener('close', () => { if (dialog.returnValue === 'start') this.start(); });
    dialog.addEventListener('click', (event) => { if (event.target === dialog) dialog.close(); });
    at('webcam').hidden = false;
  }
  get isOn() { return this.#stream !== null && this.#finder !== null; }
  #isStarting = false;
  get isStarting() { return this.#isStarting; }
  /** ms, that the last picture took. */
  get findMs() { return this.#finder?.ms; }

  async #offer(dialog) {
    dialog.returnValue = '';
    const needs = location.protocol === 'file:'
      ? 'This page was opened from a disk, where a browser lets it fetch nothing. Put it on a server of this machine: palpable export BODY --to page --inline never -o FOLDER, then palpable serve FOLDER.'
      : !navigator.mediaDevices?.getUserMedia ? 'This browser gives cameras only to pages with https, or to those of this machine.' : null;
    let trouble = needs;
    if (!trouble) {
      try {
        const bytes = Object.values(await filesOf()).reduce((sum, size) => sum + size, 0);
        write('download', `${(bytes / 1e6).toFixed(1)} MB`);
      } catch (error) {
        trouble = `The hand finder's files are missing: ${error.message}. web/page/build.sh makes the folder hands, which belongs beside index.html.`;
      }
    }
    at('leave').querySelector('[value="start"]').disabled = trouble !== null;
    write('needs', trouble ?? '');
    dialog.showModal();
  }

  async start() {
    const run = ++this.#run;
    this.#isStarting = true;
    write('webcam', 'Stop the webcam');
    try {
      this.#say('Waiting for your leave to use the camera');
      const stream = await navigator.mediaDevices.getUserMedia(kCamera);
      if (run !== this.#run) return stream.getTracks().forEach((track) => track.stop());
      this.#stream = stream;
      stream.getVideoTracks()[0].addEventListener('ended', () => { this.stop(); this.#say('The camera was taken away. The mouse goes on pressing.', true); });
      this.#video.srcObject = stream;
      await this.#video.play();
      document.documentElement.classList.add('webcam');
      this.#page.scene.overPicture = true;
      this.#page.redraw();
      this.#say('Fetching the hand finder');
      const finder = await HandFinder.start((share) => this.#say(`Fetching the hand finder: ${Math.round(100 * share)} %`));
      if (run !== this.#run) return finder.close();
      this.#finder = finder;
      this.#seen = now();
      this.#isStarting = false;
      this.#say('Looking for your hand');
      this.#page.redraw();
      this.#look(run);
    } catch (error) {
      if (run !== this.#run) return;
      this.stop();
      this.#say(cameraTrouble(error), true);
      if (!/^Not(Allowed|Found|Readable)Error/.test(error.name)) console.warn(error);
    }
  }

  stop() {
    ++this.#run;
    this.#isStarting = false;
    this.#finder?.close();
    this.#finder = null;
    this.#stream?.getTracks().forEach((track) => track.stop());
    this.#stream = this.#video.srcObject = null;
    this.#tracks.clear();
    this.#planes.clear();
    this.hands = [];
    document.documentElement.classList.remove('webcam');
    this.#page.scene.overPicture = false;
    this.#interval = 0;
    this.#page.scene.setPlain(false, this.#page.body);
    this.#say('');
    write('webcam', 'Press with your hand');
    this.#page.redraw();
  }

  /** For tests. */
  newFinder(onProgress) { return HandFinder.start(onProgress); }

  /** Measures the hand anew, and puts the plane back. */
  reset() {
    [this.#measures, this.#shift] = [[], 0];
    this.#presses.clear();
    this.#planes.clear();
  }
  /** The wheel: towards the visitor or away. */
  movePlane(steps) {
    const most = 1.2 * this.#page.body.shape.radius;
    this.#shift = Math.min(Math.max(this.#shift - kWheel * steps, -most), most);
    this.#page.redraw();
  }

  #say(text, isTrouble = false) {
    at('handsay').hidden = text === '';
    at('handsay').classList.toggle('trouble', isTrouble);
    write('handsay', text);
  }

  // Looks at one picture after the other, at its own pace.
  async #look(run) {
    const video = this.#video, pictures = new Pictures(video);
    while (run === this.#run) {
      const taken = await pictures.next();
      if (run !== this.#run) return;
      if (document.visibilityState === 'hidden') continue;
      try {
        const picture = this.#shrunk(video);
        const found = await this.#finder.find(picture);
        if (run !== this.#run) return;
        this.#take(found, taken);
      } catch (error) {
        if (run !== this.#run) return;
        this.stop();
        this.#say(`The hand finder stopped: ${error.message}. The mouse goes on pressing.`, true);
      }
    }
  }
  // In memory, not on the graphics card: a bitmap of a video would be read back by the finder, at ten times the cost where
  // graphics are done in software.
  #shrunk(video) {
    const scale = Math.min(1, kFound / Math.max(video.videoWidth, video.videoHeight));
    const [width, height] = [video.videoWidth, video.videoHeight].map((px) => Math.round(scale * px));
    if (this.#small.width !== width || this.#small.height !== height) Object.assign(this.#small, { width, height });
    const context = this.#small.getContext('2d', { willReadFrequently: true, alpha: false });
    context.drawImage(video, 0, 0, width, height);
    return context.getImageData(0, 0, width, height);
  }
  #small = document.createElement('canvas');
  get #aspect() { return this.#video.videoHeight / this.#video.videoWidth; }

  #take(found, taken) {
    const aspect = this.#aspect;
    ++this.finds;
    this.withHand += found.length > 0;
    for (const { points } of found) for (let k = 1; k < 63; k += 3) points[k] *= aspect; // widths, as x
    this.onFound?.(found, taken);
    this.#tracks.update(found, taken);
    if (found.length > 0) {
      this.#seen = now();
      if (this.#measures.length < kMeasures && isWhole(found[0].points, aspect)) this.#measure(found[0].points);
    }
    this.#page.redraw();
  }
  // The body is drawn as large as it would be beside the hand.
  #measure(points) {
    const { scene, orbit, body } = this.#page, lens = scene.lens;
    this.#measures.push(pxPerMetre(onScreen(points, this.#aspect, scene.width, scene.height)));
    if (this.#measures.length < kMeasures) return;
    const wanted = [...this.#measures].sort((a, b) => a - b)[kMeasures >> 1];
    const side = Math.min(scene.width, scene.height), { radius, target } = body.shape;
    const px = Math.min(Math.max(wanted, kSmallest * side / radius), kLargest * side / radius);
    const depth = [0, 1, 2].reduce((sum, k) => sum + (target[k] - lens.eye[k]) * lens.forward[k], 0);
    this.#zoom = Math.min(Math.max(orbit.zoom * lens.f / depth / px, 0.25), 4);
  }

  /** Before a frame is drawn. @returns {boolean} whether another frame is to come */
  prepare(time, seconds) {
    if (!this.isOn) return this.#presses.count > 0;
    const { orbit } = this.#page;
    this.#keepUp(seconds);
    if (this.#zoom !== null) {
      orbit.zoom += (1 - Math.exp(-kEase * Math.min(seconds, 0.1))) * (this.#zoom - orbit.zoom);
      if (Math.abs(orbit.zoom - this.#zoom) < 1e-3) this.#zoom = null;
    }
    return true;
  }

  // Draws less finely where frames come too seldom.
  #keepUp(seconds) {
    this.#interval += (1 - Math.exp(-seconds / kOver)) * (Math.min(seconds, 0.5) - this.#interval);
    if (this.#interval > kSlowest) this.#page.scene.setPlain(true, this.#page.body);
  }
  #interval = 0;

  /** What hands press with, for PressedBody.hands. */
  steps(time) {
    const { body, scene } = this.#page, { lens } = scene, { vertices } = body.skin, touches = body.touches;
    const middle = [0, 1, 2].reduce((sum, k) => sum + (body.shape.target[k] - lens.eye[k]) * lens.forward[k], 0);
    const found = this.isOn ? this.#tracks.at(time) : [];
    this.#tooFar = false;
    this.hands = [];
    for (const { id, side, points } of found) {
      const screen = onScreen(points, this.#aspect, scene.width, scene.height);
      const [x, y] = [screen[3 * kTip], screen[3 * kTip + 1]];
      const isTouching = touches.some(({ thing }) => thing === kFirstThing + id);
      if (!this.#planes.has(id)) this.#planes.set(id, new Plane());
      const depth = this.#planes.get(id).step(lens, x, y, vertices, middle, isTouching, time) + this.#shift;
      const places = joints(lens, screen, depth);
      let capsules;
      try {
        capsules = handCapsules('mediapipe', side, places);
      } catch { // not as long as a hand is
        this.#tooFar = true;
        continue;
      }
      this.#watchPush(id, { time, size: pxPerMetre(screen), x, y }, this.#planes.get(id).isOver && !isTouching);
      this.hands.push({ id, side, capsules, joints: places, tip: { at: pointAt(lens, x, y, depth), depth, touches: isTouching } });
    }
    for (const id of this.#planes.keys()) if (!found.some((hand) => hand.id === id)) this.#planes.delete(id);
    return this.#presses.step(this.hands, { vertices, touches, toEye: lens.forward.map((x) => -x), now: time,
                                            strongest: kArea * body.facts.stressTop });
  }

  // A hand over the body that stays where it is in the picture, and grows, comes nearer to the camera.
  #watchPush(id, seen, isOver) {
    const kept = (this.#sizes.get(id) ?? []).filter(({ time }) => seen.time - time < kPushTime), first = kept[0];
    if (isOver && kept.length > 4 && seen.time - first.time > 0.6 * kPushTime && seen.size > kPushed * first.size &&
        Math.hypot(seen.x - first.x, seen.y - first.y) < kStays * seen.size) this.#pushed = seen.time;
    this.#sizes.set(id, isOver ? [...kept, seen] : []);
  }

  /** After the body was pressed: the scene's hands and the words. */
  show(time) {
    if (!this.isOn) return;
    this.#page.scene.showHands(this.hands.map(({ capsules, joints: places }) => Float64Array.of(...capsules, ...forearm(places))),
                               this.hands.map(({ tip }) => tip));
    if (time - this.#pushed < 5) this.#say(kWhyNot);
    else if (this.#tooFar) this.#say(kTooFar);
    else if (this.hands.length > 0) this.#say(kHowTo);
    else if (time - this.#seen > kNothingAfter) this.#say(kShowHand);
  }
}

const isWhole = (points, aspect) => points.every((x, k) => k % 3 === 2 || (x > 0.01 && x < (k % 3 ? aspect : 1) - 0.01));

/** The newest picture's time, and a wait for one that is newer. */
class Pictures {
  #video;
  #taken = null;  // s, of the newest
  #wake = null;

  constructor(video) {
    this.#video = video;
    if (video.requestVideoFrameCallback) this.#follow();
  }
  #follow() {
    this.#video.requestVideoFrameCallback((shown, { captureTime }) => {
      this.#taken = (captureTime ?? shown) / 1000;
      this.#wake?.();
      if (this.#video.srcObject) this.#follow();
    });
  }
  /** @returns {Promise<number>}  s, when the picture was taken, as far as is known */
  async next() {
    if (this.#taken === null) await new Promise((done) => { this.#wake = done; setTimeout(done, kPatience); });
    const taken = this.#taken ?? now();
    this.#taken = this.#wake = null;
    return taken;
  }
}
