// What hands do to the body from frame to frame, without jumps: a hand that comes up over the body comes onto it slowly from
// before it; one that touches goes on by 4 mm a frame at most, and no deeper than 10 mm; one that is lost while it presses
// goes back slowly along the way it pressed. Pure; no clock, no page.
import { movedBy, reaches, wayBetween } from './hand_placing.js';

const kWay = 0.003;         // m a frame: coming on and going back
const kTouchWay = 0.004;    // m a frame, most of a hand that touches: at 30 frames a second 120 mm/s
const kStep = 0.006;        // m, most of a capsule's way in one call of the core; a fingertip is 7 to 9 mm thick
const kMostSteps = 10;      // calls in a frame
const kDeepest = 0.010;     // m, as a finger of the mouse
const kTooDeep = 0.018;     // m: a hand that is this deep has gone through
const kTooStrong = 3;       // times the largest force that is allowed: a palm that came in flat
const kThrough = 0.05;      // m: a hand that would be farther in has gone through, and presses again once it is clear
const kThinner = 0.85;      // of its thickness, which a hand that goes back keeps in a frame: it may be held from two sides
const kLongestLeave = 0.5;  // s
const kMostBefore = 0.2;    // m, before the body
export const kFirstThing = 1_000_000; // ids of the mouse's fingers are below

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (v, by) => v.map((x) => by * x);

/** How a hand touches: m, the deepest; N; unit vector along which it presses, null without a touch. */
function touchOf(touches, id) {
  let depth = 0, sum = [0, 0, 0];
  for (const touch of touches) {
    if (touch.thing !== id) continue;
    depth = Math.max(depth, touch.depth);
    sum = sum.map((x, k) => x + touch.force[k]);
  }
  const size = Math.hypot(...sum);
  return { depth, force: size, along: size > 0 ? scaled(sum, 1 / size) : null };
}

export class HandPresses {
  #all = new Map(); // by id: capsules as the core got them (null: none), before: m still to come, leaving since, isThrough

  /** @param {{id: number, capsules: Float64Array}[]} hands  where they are now
   *  @param {{vertices: Float32Array, touches: {thing: number, force: number[], depth: number}[], toEye: number[], now: number, strongest?: number}} of
   *    touches: of the last frame; toEye: unit vector; strongest: N, of a hand that comes no farther
   *  @returns {{id: number, capsules: Float64Array}[][]}  what to press with, call by call */
  step(hands, { vertices, touches, toEye, now, strongest = Infinity }) {
    const goals = new Map(), here = new Set();
    for (const { id: hand, capsules } of hands) {
      const id = kFirstThing + hand, known = this.#all.get(id);
      here.add(id);
      const before = known?.capsules ? Math.max(0, known.before - kWay) : distanceBefore(capsules, vertices, toEye);
      const wanted = before > 0 ? movedBy(capsules, scaled(toEye, before)) : capsules;
      const touch = touchOf(touches, id), goal = known?.capsules ? allowed(known.capsules, wanted, touch, strongest) : wanted;
      const isFar = wayBetween(goal, wanted) > kThrough || touch.depth > kTooDeep || touch.force > kTooStrong * strongest;
      const isThrough = (known?.isThrough || isFar) && reaches(capsules, vertices);
      this.#all.set(id, { capsules: known?.capsules ?? null, before, leaving: isThrough ? known.leaving : null, isThrough });
      if (!isThrough) goals.set(id, goal);
    }
    for (const [id, press] of this.#all) {
      if (goals.has(id)) continue;
      press.leaving ??= now;
      const { along } = touchOf(touches, id);
      if (press.capsules && along && now - press.leaving <= kLongestLeave) goals.set(id, thinner(movedBy(press.capsules, scaled(along, -kWay))));
      else if (here.has(id)) press.capsules = null;
      else this.#all.delete(id);
    }
    return this.#steps(goals, vertices, touches);
  }

  // On the way to the goals, and no farther than to where a hand that was free first touches.
  #steps(goals, vertices, touches) {
    const most = Math.max(0, ...[...goals].map(([id, goal]) => wayBetween(this.#all.get(id).capsules ?? goal, goal)));
    const count = Math.min(Math.max(Math.ceil(most / kStep), 1), kMostSteps), steps = [], stopped = new Map();
    for (let k = 1; k <= count; ++k) {
      steps.push([...goals].map(([id, goal]) => {
        const at = stopped.get(id) ?? mixed(this.#all.get(id).capsules ?? goal, goal, k / count);
        if (k < count && !touches.some(({ thing }) => thing === id) && reaches(at, vertices, 0)) stopped.set(id, at);
        return { id, capsules: at, friction: 0 }; // a hand whose depth is not known must not drag the body along
      }));
    }
    for (const { id, capsules } of steps.at(-1)) this.#all.get(id).capsules = capsules;
    return steps;
  }
  clear() { this.#all.clear(); }
  get count() { return this.#all.size; }
}

const mixed = (from, to, share) => to.map((x, k) => from[k] + share * (x - from[k]));

const thinner = (capsules) => capsules.map((x, k) => k % 8 < 6 ? x : kThinner * x);

/** Where a hand may go from one frame to the next. */
function allowed(from, wanted, { depth, force, along }, strongest) {
  if (!along) return wanted;
  const way = wayBetween(from, wanted);
  if (depth <= kDeepest && force <= strongest) return way > kTouchWay ? mixed(from, wanted, kTouchWay / way) : wanted;
  // Too deep: out again, and along the skin as it likes.
  const mean = [0, 1, 2].map((k) => {
    let sum = 0;
    for (let c = 0; c < from.length; c += 8) sum += wanted[c + k] - from[c + k];
    return 8 * sum / from.length;
  });
  const into = dot(mean, along), back = Math.min(Math.max(depth - kDeepest, 0.5 * kWay), kTouchWay);
  const shift = mean.map((x, k) => x - into * along[k] + Math.min(into, -back) * along[k]), size = Math.hypot(...shift);
  return movedBy(from, size > kTouchWay ? scaled(shift, kTouchWay / size) : shift);
}

/** m towards the eye, at which a hand is clear of the body; 0: it is where it is. */
function distanceBefore(capsules, vertices, toEye) {
  for (let way = 0; way <= kMostBefore; way += 0.01) {
    if (!reaches(way === 0 ? capsules : movedBy(capsules, toEye.map((x) => way * x)), vertices)) return way;
  }
  return kMostBefore;
}
