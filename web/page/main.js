// The page: joins the body, its picture, and what the visitor does.
import { loadFacts, readPage, restingBody, startCore } from './bodies.js';
import { Desk } from './desk.js';
import { Keyboard } from './keyboard.js';
import { Orbit } from './orbit.js';
import { Pointers } from './pointers.js';
import * as words from './readout.js';
import { Scene } from './scene.js';
import { Webcam } from './webcam.js';

const canvas = document.getElementById('view');
const prefers = (what) => matchMedia(`(prefers-${what})`);
const stillness = prefers('reduced-motion: reduce'), darkness = prefers('color-scheme: dark');
const kSpeakAfter = 0.4; // s without a change of depth

class Page {
  #scene;
  #body = null;
  #orbit = null;
  #asked = false; // whether the next frame is asked for
  #old = true;    // whether the picture is
  #before = 0;    // s, of the last frame
  #spoken = true;
  #keyboard;
  frames = 0;

  /** @param {Scene} scene  in the canvas */
  constructor(scene) {
    this.#scene = scene;
    this.#scene.dark = darkness.matches;
    darkness.addEventListener('change', () => { this.#scene.dark = darkness.matches; this.redraw(); });
    canvas.addEventListener('webglcontextrestored', () => this.redraw());
    new ResizeObserver(() => this.#resize()).observe(canvas);
    new Pointers(canvas, {
      placeAt: (x, y) => this.#placeAt(x, y),
      press: (key, place) => { this.#keyboard.hide(); this.#press(key, place); },
      drag: (key, px) => this.#body?.fingers.drag(key, px),
      release: (key) => this.#release(key),
      turn: (dx, dy) => this.#turn(dx, dy),
      zoom: (steps, isWheel) => {
        if (isWheel && this.webcam?.isOn) return this.webcam.movePlane(steps);
        this.#orbit?.zoomBy(steps);
        this.redraw();
      },
    });
    this.#keyboard = new Keyboard(canvas, this.#keyboardActions());
    addEventListener('blur', () => this.#body?.fingers.releaseAll(now()));
  }

  #keyboardActions() {
    const page = this;
    return {
      start: () => page.#start(),
      look: (origin, direction) => page.#body.placeAt(origin, direction),
      get sides() { return page.#scene.sides; },
      mark: (place) => { page.#scene.mark(place); page.redraw(); },
      press: (key, place) => page.#press(key, place),
      release: (key) => page.#release(key),
      turn: (dx, dy) => page.#turn(dx, dy),
      face: (normal, widest) => { page.#orbit.face(normal, widest); page.#scene.place(page.#orbit); },
      zoom: (steps) => { page.#orbit?.zoomBy(steps); page.redraw(); },
      plane: (steps) => { if (page.webcam?.isOn) page.webcam.movePlane(steps); },
      reset: () => page.#reset(),
    };
  }

  /** @param {import('./pressed_body.js').PressedBody | import('./resting_body.js').RestingBody} body */
  show(body) {
    const isSame = this.#body?.facts === body.facts; // it was shown at rest: the view that was chosen stays
    this.#body?.close();
    this.#body = body;
    body.hands = (time) => this.webcam?.steps(time) ?? [[]];
    this.webcam?.reset();
    if (!isSame) this.#orbit = new Orbit(body.shape);
    words.showFacts(body);
    words.showReading(body.reading(), body.facts.stressTop);
    this.#keyboard.hide(true);
    this.#scene.show(body);
    this.#resize();
  }
  get body() { return this.#body; }
  get scene() { return this.#scene; }
  get orbit() { return this.#orbit; }
  /** Once the body can be pressed. */
  webcam = null;
  offerWebcam() { this.webcam = new Webcam(this); }
  /** px of CSS, of a point of the body (m). */
  pixelOf(point) { return this.#scene.pixelOf(point); }
  get sides() { return this.#scene.sides; }

  redraw() {
    this.#old = true;
    this.#ask();
  }
  #ask() {
    if (this.#asked || !this.#body) return;
    this.#asked = true;
    requestAnimationFrame(() => this.#frame());
  }

  #frame() {
    this.#asked = false;
    const time = now(), body = this.#body;
    const turned = this.#orbit.step(time - this.#before), goesOn = this.webcam?.prepare(time, time - this.#before);
    this.#before = time;
    if (goesOn) this.#scene.place(this.#orbit); // hands are put where this view has them
    if (body.step(time, !stillness.matches)) {
      const reading = body.reading();
      this.#scene.update(body);
      words.showReading(reading, body.facts.stressTop);
      this.#old = true;
    }
    this.webcam?.show(time);
    this.#speakOnce(body.reading(), time);
    if (turned || goesOn || this.#old) this.#scene.draw(this.#orbit);
    this.#old = false;
    ++this.frames;
    if (turned || goesOn || body.moves || body.fingers.count > 0) this.#ask();
  }

  // A screen reader hears the numbers once in a press: when it has stopped growing for a while, or when it ends.
  #since = 0;
  #push = 0;
  #speakOnce(reading, time) {
    if (this.#spoken || reading.fingers === 0) return;
    if (Math.abs(reading.push - this.#push) > 1e-4) [this.#push, this.#since] = [reading.push, time];
    if (time - this.#since < kSpeakAfter) return;
    this.#spoken = true;
    words.speak(reading);
  }

  #placeAt(x, y) {
    if (!this.#body) return null;
    this.#scene.place(this.#orbit);
    const { origin, direction } = this.#scene.rayAt(x, y);
    return this.#body.placeAt(origin, direction);
  }
  // Where the keyboard begins: the skin in front of the body's middle.
  #start() {
    if (!this.#body) return null;
    this.#scene.place(this.#orbit);
    const { eye } = this.#scene.sides, to = this.#body.shape.target, size = Math.hypot(...to.map((x, k) => x - eye[k]));
    return this.#body.placeAt(eye, to.map((x, k) => (x - eye[k]) / size));
  }

  #press(key, place) {
    this.#body.fingers.press(key, place, now());
    [this.#spoken, this.#since] = [false, now()];
    words.endHint();
    this.#ask();
  }
  #release(key) {
    this.#body?.fingers.release(key, now());
    if (!this.#spoken && this.#body) words.speak(this.#body.reading());
    this.#spoken = true;
    this.#ask();
  }
  #turn(dx, dy) {
    this.#orbit?.turn(dx, dy);
    this.redraw();
  }
  #reset() {
    if (!this.#body) return;
    this.#body.reset();
    this.webcam?.reset();
    this.#keyboard.hide(true);
    this.#orbit.reset(stillness.matches);
    words.say('At rest, as at the beginning.');
    this.redraw();
  }
  #resize() {
    const strips = words.coveredStrips();
    if (strips.width === 0) return;
    this.#scene.resize(strips);
    if (!this.#body) return;
    this.#scene.draw(this.#orbit); // at once: a canvas that was resized is empty
    this.redraw();
  }
}

const now = () => performance.now() / 1000;

/** When what was drawn is on the screen; a page that is not visible draws nothing, and does not wait long. */
const onScreen = () => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(done));
  setTimeout(done, 500);
});

async function choose(page, content, facts) {
  words.showProgress(`Fetching the ${facts.name}`, content.inline ? undefined : 0);
  const resting = restingBody(facts);
  if (resting) {
    page.show(resting);
    await onScreen();
    performance.mark('palpable: first picture');
  }
  const body = await loadFacts(content, facts, (share) => words.showProgress(`Fetching the ${facts.name}`, share));
  page.show(body);
  words.endProgress();
}

function offerChoice(page, content) {
  const list = document.getElementById('bodies'), { bodies } = content;
  if (bodies.length < 2) return;
  list.append(...bodies.map(({ name }) => new Option(name)));
  document.getElementById('choice').hidden = false;
  document.getElementById('name').classList.add('unseen');
  list.addEventListener('change', () => {
    list.disabled = true; // one at a time
    choose(page, content, bodies[list.selectedIndex]).catch(complain).finally(() => { list.disabled = false; list.focus(); });
  });
}

function complain(error) {
  const local = location.protocol === 'file:';
  words.showTrouble(local
    ? 'A browser does not let a page on the disk fetch files. Open it with: palpable serve FOLDER'
    : `This did not work: ${error.message}`);
  if (!local) console.error(error);
}

async function begin() {
  const how = document.getElementById('explained');
  document.getElementById('how').addEventListener('click', () => how.showModal());
  // The keys are the body's again, not the button's.
  how.addEventListener('close', () => document.getElementById('view').focus());
  how.addEventListener('click', (event) => { if (event.target === how) how.close(); });
  words.showHint(matchMedia('(pointer: coarse)').matches);
  const content = readPage();
  let scene;
  try {
    scene = new Scene(canvas);
  } catch {
    throw new Error('this browser draws no three-dimensional pictures (WebGL is off).');
  }
  if (content.live) return await new Desk(canvas, scene, content.live).ready; // of palpable live --serve
  const page = new Page(scene);
  offerChoice(page, content);
  // Both at once: the body arrives while the core is compiled.
  await Promise.all([startCore(content), choose(page, content, content.bodies[0])]);
  performance.mark('palpable: ready');
  page.offerWebcam();
  return page;
}

/** For tests and benches: the page once it shows a body. */
globalThis.palpablePage = begin();
globalThis.palpablePage.catch(complain);
