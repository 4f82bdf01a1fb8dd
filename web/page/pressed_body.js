// A body of the core, the fingers on it, and what is read from it in a frame.
import { loadBody, Session } from '../index.js';
import { Fingers } from './fingers.js';
import { placeAt } from './pick.js';
import { shapeOf } from './orbit.js';

const kSettled = 2e-5; // m: smaller motion is not visible and counts as none

export class PressedBody {
  #body;
  #session;
  #normals; // at rest
  #steps = 0;
  #moves = false;

  /** @param source  bytes or the answer of fetch(), @param facts  of bodies.js: name, material, stressTop ... */
  static async load(source, facts, onProgress) {
    return new PressedBody(await loadBody(source, { onProgress }), facts);
  }
  constructor(body, facts) {
    this.#body = body;
    this.facts = facts;
    this.#session = new Session(body);
    this.#session.pressAt([], ++this.#steps); // stress at rest, and the first allocations
    this.#moves = this.#session.frame.leftToGo > kSettled;
    const skin = this.skin;
    this.#normals = skin.normals.slice();
    this.shape = shapeOf(skin.vertices);
    this.fingers = new Fingers(this.shape.height);
    this.shown = [];
    /** Other things that press, as steps of a frame: (now) => [[{ id, capsules }, ...], ...], the last one where they are now. */
    this.hands = null;
    /** Called before each call of the core with what it gets; for tests. */
    this.onPress = null;
  }
  close() {
    this.#session.close();
    this.#body.free();
  }

  /** Arrays of the core: valid until the next step(). */
  get skin() { return this.#session.skin(); }

  /** @returns {import('./pick.js').Place | null} */
  placeAt(origin, direction) { return placeAt(origin, direction, this.skin, this.#normals); }

  /** One frame. @returns {boolean} whether the body may have changed */
  step(now, springs) {
    this.shown = this.fingers.step(now, springs);
    const steps = this.hands?.(now) ?? [[]];
    if (this.shown.length === 0 && steps.at(-1).length === 0 && !this.#moves) return false;
    const fingers = this.shown.map(({ id, capsules }) => ({ id, capsules }));
    for (const hands of steps) {
      const things = [...fingers, ...hands];
      this.onPress?.(things, this.#steps + 1);
      this.#session.pressAt(things, ++this.#steps);
      this.#moves = things.length > 0 || this.#session.frame.leftToGo > kSettled;
    }
    return true;
  }
  get touches() { return this.#session.touches; }
  get moves() { return this.#moves; }

  /** Forgets everything that has pressed. */
  reset() {
    this.fingers.clear();
    this.#session.reset();
    this.#moves = true;
  }

  /** @returns {{force: number, push: number, stress: number, error: number, fingers: number}}
   *   N: the sizes of the fingers' forces, added; m, the deepest; Pa, the largest; relative, of the stress, or NaN */
  reading() {
    const byFinger = new Map(), skin = this.skin, fingers = new Set(this.shown.map(({ id }) => id));
    let push = this.shown.reduce((most, finger) => Math.max(most, finger.push), 0);
    for (const { thing, force, depth } of this.#session.touches) {
      if (!fingers.has(thing)) push = Math.max(push, depth);
      const sum = byFinger.get(thing) ?? [0, 0, 0];
      byFinger.set(thing, sum.map((x, k) => x + force[k]));
    }
    let force = 0, stress = 0;
    for (const sum of byFinger.values()) force += Math.hypot(...sum);
    for (const x of skin.stress) stress = Math.max(stress, x);
    const hands = [...byFinger.keys()].filter((thing) => !fingers.has(thing)).length;
    return { force, push, stress, error: skin.statedStressError, fingers: this.shown.length + hands };
  }
}
