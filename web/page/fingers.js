// The fingers that press: where, how deep, and the capsules that the core gets. As in `palpable view`
// (finger_press.h, view_controls.h): a finger is a capsule that is pushed along the skin's inward normal, deeper while
// it is held or dragged, and springs back when it is released. No clock and no page: times come as arguments.

/** m, of a fingertip. */
export const kRadius = 0.008;
const kLength = 0.06;        // m, of the capsule: longer than the largest push
const kDeepest = 0.010;      // m, largest push
const kOfHeight = 0.1;       // the same, as a ratio to the body's height
const kFullAfter = 1.2;      // s from the start of a press to the largest push
const kFullDrag = 280;       // px of dragging to the largest push
const kSpring = 28;          // 1/s, critically damped: back in 0.2 s
const kNothing = 1e-3;       // a level below this is not seen
const kMostAFrame = 0.25;    // of the level: after a pause of the page a finger must not jump through the skin

export class Finger {
  /** @param {number} id  of a thing in the core, @param {import('./pick.js').Place} place, @param {number} now  s */
  constructor(id, place, now) {
    Object.assign(this, { id, place, dragPx: 0, level: 0 });
    this.#since = now;
  }
  #since;
  #releasedFrom = null; // the level at release

  get released() { return this.#releasedFrom !== null; }
  release(now) {
    if (this.released) return;
    [this.#releasedFrom, this.#since] = [this.level, now];
  }

  /** @param {boolean} springs  or ends at once, for people who do not want motion
   *  @returns {boolean} whether the finger is still there */
  step(now, springs) {
    const t = Math.max(0, now - this.#since);
    let wanted = Math.min(t / kFullAfter + this.dragPx / kFullDrag, 1);
    if (this.released) wanted = springs ? this.#releasedFrom * (1 + kSpring * t) * Math.exp(-kSpring * t) : 0;
    this.level = Math.min(wanted, this.level + kMostAFrame);
    return !this.released || this.level > kNothing;
  }
}

export class Fingers {
  #all = new Map(); // by pointer, or 'keyboard'
  #next = 1;
  #deepest;

  /** @param {number} height  m, of the body */
  constructor(height) { this.#deepest = Math.min(kDeepest, kOfHeight * height); }

  press(key, place, now) {
    this.#all.get(key)?.release(now);
    if (this.#all.has(key)) this.#all.set(`${key}, released ${this.#next}`, this.#all.get(key));
    this.#all.set(key, new Finger(this.#next++, place, now));
  }
  drag(key, px) {
    const finger = this.#all.get(key);
    if (finger && !finger.released) finger.dragPx = px;
  }
  release(key, now) { this.#all.get(key)?.release(now); }
  releaseAll(now) { for (const key of this.#all.keys()) this.release(key, now); }
  clear() { this.#all.clear(); }
  has(key) { return this.#all.has(key) && !this.#all.get(key).released; }
  get count() { return this.#all.size; }
  get held() { return [...this.#all.values()].filter((finger) => !finger.released).length; }

  /** All fingers at a time, those that have sprung back left out.
   * @returns {{id: number, tip: number[], inwards: number[], push: number, capsules: Float64Array}[]}
   *          tip: m, the foremost point; push: m; capsules: one, for the core */
  step(now, springs) {
    const shown = [];
    for (const [key, finger] of this.#all) {
      if (!finger.step(now, springs)) {
        this.#all.delete(key);
        continue;
      }
      const { point, inwards } = finger.place, push = finger.level * this.#deepest;
      const along = (distance) => point.map((x, k) => x + distance * inwards[k]);
      const ends = [...along(push - kRadius), ...along(push - kRadius - kLength)];
      shown.push({ id: finger.id, tip: along(push), inwards, push, capsules: Float64Array.of(...ends, kRadius, kRadius) });
    }
    return shown;
  }
}
