// The live desk: a session that runs in `palpable live --serve`, shown as it comes. The camera's picture, the pressed bodies
// with their stress, touches and forces; nothing is computed here.
import { DeskBody, kindOf, readMesh, readSkin } from './desk_body.js';
import { DeskSocket } from './desk_socket.js';
import { differ, Orbit } from './orbit.js';
import { Pointers } from './pointers.js';
import * as words from './readout.js';

const kSpeakAfter = 1300; // ms from the first touch
const kTurn_px = 24;      // of one arrow key, as of a mouse
const kArrows = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const kStates = { connecting: 'connecting', connected: 'live', lost: 'connection lost; trying again', ended: 'the run has ended' };
const kKeys = 'Arrow keys turn the room. Plus and minus zoom. R shows it from the front again.';
const kExplained = [
  'This is a run of palpable live: real things press virtual bodies, and this page shows what comes out.',
  'The picture is that of the run, at half its size. Close this page, and nobody gets it.',
  'The body beside it is the same one, pressed; drag to turn it, the wheel or two fingers come closer.',
  'Keyboard: arrows turn, + and − zoom, R shows it from the front again.',
  'An arrow shows where something presses, and along which direction; the number in the corner adds up the sizes of these forces, in newtons.',
  'The colours show how hard the material is strained: von Mises stress, in thousands of pascals.',
  '“Model error” is how far the stress shown may be from a full computation, without the camera’s error.',
];
const at = (id) => document.getElementById(id);

export class Desk {
  #canvas;
  #scene;
  #socket;
  #orbit = null;
  #body = null;
  #isNew = false; // whether the body is to be shown anew, with its first skin
  #hello = null;
  #hasPicture = false;
  #asked = false;
  #before = 0;
  #picture = { isShown: false, isBusy: false, next: null };
  #speech = null;
  /** For tests. */
  frames = 0;
  pictures = 0;
  state = 'connecting';
  lines = 0;

  /** @param {HTMLCanvasElement} canvas, @param {import('./scene.js').Scene} scene  in it
   *  @param {string} socket  address relative to the page's */
  constructor(canvas, scene, socket) {
    this.#canvas = canvas;
    this.#scene = scene;
    this.ready = new Promise((done) => { this.#ready = done; });
    this.#prepareWords();
    this.#listen();
    const url = new URL(socket, document.baseURI);
    url.protocol = url.protocol === 'https:' ? 'wss:' : 'ws:';
    this.#socket = new DeskSocket(url.href, {
      line: (line) => this.#takeLine(line),
      bytes: (bytes) => this.#takeBytes(bytes),
      state: (state) => this.#showState(state),
    });
  }
  #ready;
  get body() { return this.#body; }
  /** Ends the connection as if it were lost; for tests. */
  drop() { this.#socket.drop(); }

  #prepareWords() {
    document.title = 'The live desk';
    at('keys').textContent = kKeys;
    at('explained').querySelector('ol').replaceChildren(...kExplained.map((text) => {
      const item = document.createElement('li');
      item.textContent = text;
      return item;
    }));
    at('hint').textContent = '';
    words.endHint();
    at('state').hidden = false;
    words.showProgress('Waiting for the run');
  }

  #listen() {
    const darkness = matchMedia('(prefers-color-scheme: dark)');
    this.#scene.dark = darkness.matches;
    darkness.addEventListener('change', () => { this.#scene.dark = darkness.matches; this.#ask(); });
    this.#canvas.addEventListener('webglcontextrestored', () => this.#ask());
    new ResizeObserver(() => this.#resize()).observe(this.#canvas);
    new ResizeObserver(() => this.#resize()).observe(at('seen'));
    new Pointers(this.#canvas, {
      placeAt: () => null, // everything turns: real things press here
      turn: (dx, dy) => this.#turn(dx, dy),
      zoom: (steps) => this.#zoom(steps),
    });
    this.#canvas.addEventListener('keydown', (event) => this.#key(event));
    document.addEventListener('visibilitychange', () => this.#sayWishes());
  }
  #key(event) {
    if (event.altKey || event.metaKey || event.ctrlKey) return;
    const { key } = event, arrow = kArrows[key];
    if (arrow) this.#turn(kTurn_px * arrow[0], kTurn_px * arrow[1]);
    else if (key === '+' || key === '=') this.#zoom(1);
    else if (key === '-' || key === '_') this.#zoom(-1);
    else if (key === 'r' || key === 'R') this.#reset();
    else return;
    event.preventDefault();
  }
  #turn(dx, dy) { this.#orbit?.turn(dx, dy); this.#ask(); }
  #zoom(steps) { this.#orbit?.zoomBy(steps); this.#ask(); }
  #reset() { this.#orbit?.reset(matchMedia('(prefers-reduced-motion: reduce)').matches); this.#ask(); }

  #showState(state) {
    this.state = state;
    at('state').textContent = kStates[state];
    at('state').dataset.state = this.#canvas.dataset.state = state; // the body is dim while it may be another one
    if (state === 'lost' || state === 'ended') this.#forgetTouches();
  }
  // What is shown no longer holds.
  #forgetTouches() {
    if (!this.#body) return;
    this.#body.touches = [];
    this.#scene.showForces([]);
    this.#speakOnce(); // no more
    this.#ask();
  }

  // Nobody looks at a page in the background: it needs no pictures.
  #sayWishes() {
    const isSeen = document.visibilityState !== 'hidden';
    this.#socket.want(isSeen ? [...(this.#hasPicture ? ['picture'] : []), 'skin'] : []);
  }

  #takeLine(line) {
    ++this.lines;
    if (line.type === 'hello') this.#hello = line;
    else if (line.type === 'page') this.#begin(line);
    else if (line.type === 'frame') this.#takeFrame(line);
    else if (line.type === 'error') console.error(line.reason);
  }
  // Also for another session of the run: its bodies may stand elsewhere, or be of another material.
  #begin(page) {
    this.#forgetTouches();
    this.#isNew = false;
    this.#body = new DeskBody(this.#hello, page);
    this.#hasPicture = page.picture;
    this.#showPlaceOfPicture();
    this.#sayWishes();
  }
  #takeFrame(line) {
    if (!this.#body) return;
    this.#body.setFrame(line);
    if (this.#isNew) this.#showBody();
    const lost = line.camera?.state === 'lost' ? 'live; the camera does not know where it is' : kStates.connected;
    if (at('state').textContent !== lost) at('state').textContent = lost;
    this.#scene.showForces(this.#body.touches);
    this.#speakOnce();
    this.#ask();
  }

  // A screen reader hears the numbers once for all touches from the first to the last.
  #speakOnce() {
    if (this.#body.touches.length === 0) {
      clearTimeout(this.#speech);
      this.#speech = null;
    } else {
      this.#speech ??= setTimeout(() => words.speak(this.#body.reading()), kSpeakAfter);
    }
  }

  #takeBytes(buffer) {
    const kind = kindOf(buffer);
    if (kind === 'JPEG') this.#showPicture(buffer);
    else if (kind === 'MESH') this.#body?.setMesh(readMesh(buffer));
    else if (kind === 'SKIN' && this.#body) this.#takeSkin(readSkin(buffer));
  }
  #takeSkin(skin) {
    this.#isNew = this.#body.setSkin(skin) || this.#isNew;
    if (this.#isNew) this.#showBody();
    else this.#scene.update(this.#body);
    ++this.frames;
    this.#ask();
  }
  #showBody() {
    if (this.#hasPicture && !this.#body.hasFrame) return; // which says where the camera stands
    this.#isNew = false;
    // The view stays after a reconnection.
    if (!this.#orbit || differ(this.#orbit.shape, this.#body.shape)) this.#orbit = this.#firstView();
    words.showFacts(this.#body);
    this.#scene.show(this.#body);
    words.endProgress();
    this.#resize();
    this.#ready(this);
  }

  // From the camera's side, so that left is left in the picture, too.
  #firstView() {
    const { shape, eye } = this.#body;
    if (this.#hasPicture && eye) shape.azimuth = Math.atan2(eye[0] - shape.target[0], shape.target[1] - eye[1]);
    return new Orbit(shape);
  }

  // The newest picture; those that come while one is decoded are left out.
  #showPicture(buffer) {
    const picture = this.#picture;
    if (picture.isBusy) {
      picture.next = buffer;
      return;
    }
    picture.isBusy = true;
    // Another element: one that gets another source is empty until it is read.
    const before = at('picture'), image = before.cloneNode();
    image.src = URL.createObjectURL(new Blob([buffer], { type: 'image/jpeg' }));
    image.decode().then(() => {
      before.replaceWith(image);
      URL.revokeObjectURL(before.src);
      ++this.pictures;
      picture.isShown = true;
      this.#showPlaceOfPicture();
    }, () => URL.revokeObjectURL(image.src)).finally(() => {
      picture.isBusy = false;
      const next = picture.next;
      picture.next = null;
      if (next) this.#showPicture(next);
    });
  }
  #showPlaceOfPicture() {
    const isShown = this.#hasPicture && this.#picture.isShown;
    if (at('seen').hidden === !isShown) return;
    at('seen').hidden = !isShown;
    this.#resize();
  }

  #ask() {
    if (this.#asked || !this.#orbit) return;
    this.#asked = true;
    requestAnimationFrame(() => this.#frame());
  }
  #frame() {
    this.#asked = false;
    const time = performance.now() / 1000, turned = this.#orbit.step(time - this.#before);
    this.#before = time;
    words.showReading(this.#body.reading(), this.#body.facts.stressTop, { many: 'touches', none: 'force on the body' });
    this.#scene.draw(this.#orbit);
    if (turned) this.#ask();
  }
  #resize() {
    const strips = words.coveredStrips();
    if (strips.width === 0) return;
    this.#scene.resize(strips);
    if (this.#orbit) this.#scene.draw(this.#orbit); // at once: a canvas that was resized is empty
  }
}
