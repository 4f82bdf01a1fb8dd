// What hands do to the body from frame to frame, without jumps: a hand that comes up over the body comes onto it slowly from
// before it, one that is lost while it presses goes back slowly along the way it pressed. Pure; no clock, no page.
import { movedBy, reaches, wayBetween } from './hand_placing.js';

const kWay = 0.003;         // m a call of the core: coming on and going back
const kStep = 0.006;        // m, most of a capsule's way in one call; a fingertip is 7 to 9 mm thick
const kMostSteps = 4;       // calls in a frame
const kLongestLeave = 0.5;  // s
const kMostBefore = 0.2;    // m, before the body
const kDeepest = 0.012;     // m: a finger of the mouse goes 10 mm deep
const kGlide = 0.006;       // m a call, most that a hand that is deeper is held back more
const kThrough = 0.05;      // m: a hand that is held back by more has gone through, and presses again once it is clear
export const kFirstThing = 1_000_000; // ids of the mouse's fingers are below

export class HandPresses {
  #all = new Map(); // by id: capsules as the core got them, before: m still to come, leaving since

  /** @param {{id: number, capsules: Float64Array}[]} hands  where they are now
   *  @param {{vertices: Float32Array, touches: {thing: number, force: number[]}[], toEye: number[], now: number}} of
   *    touches: of the last frame; toEye: unit vector
   *  @returns {{id: number, capsules: Float64Array}[][]}  what to press with, call by call */
  step(hands, { vertices, touches, toEye, now }) {
    const wanted = new Map(hands.map(({ id, capsules }) => [kFirstThing + id, capsules])), goals = new Map();
    for (const [id, capsules] of [...wanted]) {
      const known = this.#all.get(id), before = known?.before ?? distanceBefore(capsules, vertices, toEye);
      const left = Math.max(0, before - (known ? kWay : 0)), off = heldBack(known?.off ?? [0, 0, 0], touches, id);
      const isThrough = (known?.isThrough || Math.hypot(...off) > kThrough) && reaches(capsules, vertices);
      if (isThrough) {
        wanted.delete(id);
        if (known.capsules) Object.assign(known, { isThrough, off: [0, 0, 0], before: 0 });
        else this.#all.set(id, { isThrough, off: [0, 0, 0], before: 0, capsules: null, leaving: null });
        continue;
      }
      this.#all.set(id, { capsules: known?.capsules ?? null, before: left, off, leaving: null, isThrough: false });
      goals.set(id, movedBy(capsules, toEye.map((x, k) => left * x + off[k])));
    }
    for (const [id, press] of this.#all) {
      if (wanted.has(id)) continue;
      const isHere = hands.some((hand) => kFirstThing + hand.id === id); // and has gone through
      if (!press.capsules) {
        if (!isHere) this.#all.delete(id);
        continue;
      }
      press.leaving ??= now;
      const force = touches.filter(({ thing }) => thing === id).reduce((sum, touch) => sum.map((x, k) => x + touch.force[k]), [0, 0, 0]);
      const size = Math.hypot(...force);
      if (size === 0 || now - press.leaving > kLongestLeave) {
        if (isHere) press.capsules = null;
        else this.#all.delete(id);
      } else goals.set(id, movedBy(press.capsules, force.map((x) => -kWay * x / size)));
    }
    let most = 0;
    for (const [id, goal] of goals) {
      const from = this.#all.get(id).capsules;
      if (from) most = Math.max(most, wayBetween(from, goal));
    }
    const count = Math.min(Math.max(Math.ceil(most / kStep), 1), kMostSteps), steps = [];
    for (let k = 1; k <= count; ++k) {
      steps.push([...goals].map(([id, goal]) => ({ id, capsules: mixed(this.#all.get(id).capsules ?? goal, goal, k / count) })));
    }
    for (const [id, goal] of goals) this.#all.get(id).capsules = goal;
    return steps;
  }
  clear() { this.#all.clear(); }
  get count() { return this.#all.size; }
}

const mixed = (from, to, share) => to.map((x, k) => from[k] + share * (x - from[k]));

/** How far a hand is held back along the way it presses, so that it is not deeper than kDeepest: it glides on the body. */
function heldBack(off, touches, id) {
  let deepest = 0, sum = [0, 0, 0];
  for (const { thing, depth, force } of touches) {
    if (thing !== id) continue;
    deepest = Math.max(deepest, depth);
    sum = sum.map((x, k) => x + force[k]);
  }
  const size = Math.hypot(...sum), length = Math.hypot(...off);
  if (size > 0 && deepest > kDeepest) {
    const more = Math.min(deepest - kDeepest, kGlide);
    return off.map((x, k) => x - more * sum[k] / size);
  }
  return deepest > 0.8 * kDeepest || length === 0 ? off : off.map((x) => x * Math.max(0, 1 - kWay / length));
}

/** m towards the eye, at which a hand is clear of the body; 0: it is where it is. */
function distanceBefore(capsules, vertices, toEye) {
  for (let way = 0; way <= kMostBefore; way += 0.01) {
    if (!reaches(way === 0 ? capsules : movedBy(capsules, toEye.map((x) => way * x)), vertices)) return way;
  }
  return kMostBefore;
}
