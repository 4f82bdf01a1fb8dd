// Where hands of a mirrored picture are in the body's room. Across the line of sight a webcam tells it well; along it, it
// does not: the index finger's tip is put on a plane that faces the eye, at the depth of the body's part that the tip
// comes to. Pure functions; metres, and px of CSS on the screen.

/** Between the knuckles of index and little finger of a hand: assumed, as no picture tells it. */
export const kKnuckles = 0.060;   // m; the synthetic desk's hand has 0.0596
const kWristToKnuckle = 0.087;    // m, of the same hand: wrist to the middle finger's knuckle
export const kTip = 8;            // of the 21 points: the index finger's tip
const kHold = 0.006;              // m: nearer to the body than this the plane stays where it is
const kDeepEnough = 0.006;        // m: how much farther than the nearest a skin point counts for the depth
const kEase = 12;                 // 1/s, of the plane

/** @typedef {{f: number, cx: number, cy: number, eye: number[], right: number[], up: number[], forward: number[]}} Lens
 *    px: focal length and the pixel straight ahead; m and unit vectors: the eye, in the body's room */

/** Points on the screen of points in the picture: mirrored, and the picture fills the screen (object-fit: cover).
 *  @param points  21 times x y z in widths of the picture, y downwards, from its upper left corner
 *  @param {number} aspect  height of the picture over its width  @returns {Float64Array}  px; z: px, farther positive */
export function onScreen(points, aspect, width, height) {
  const scale = Math.max(width, height / aspect), result = new Float64Array(63);
  for (let k = 0; k < 63; k += 3) {
    result[k] = width / 2 - (points[k] - 0.5) * scale;
    result[k + 1] = height / 2 + (points[k + 1] - aspect / 2) * scale;
    result[k + 2] = points[k + 2] * scale;
  }
  return result;
}

/** px of the screen for each metre of the hand: the larger of two estimates, as a tilt makes both smaller. */
export function pxPerMetre(screen) {
  const apart = (i, j) => Math.hypot(screen[3 * i] - screen[3 * j], screen[3 * i + 1] - screen[3 * j + 1]);
  return Math.max(apart(5, 17) / kKnuckles, apart(0, 9) / kWristToKnuckle);
}

/** The point of a pixel at a depth (m, along the line of sight). @param {Lens} lens */
export function pointAt(lens, x, y, depth) {
  const { f, cx, cy, eye, right, up, forward } = lens, a = (x - cx) / f * depth, b = (cy - y) / f * depth;
  return [0, 1, 2].map((k) => eye[k] + a * right[k] + b * up[k] + depth * forward[k]);
}

const kBeforeEnd = 0.008;         // m: tips are found that far before the finger's end (docs/webcam.md), seen along the last bone
const kTips = [4, 8, 12, 16, 20];

/** The joints of a hand in the room, its index finger's tip at a depth. */
export function joints(lens, screen, depth) {
  const places = new Float64Array(63), ofPx = depth / lens.f, tip = screen[3 * kTip + 2];
  for (let k = 0; k < 63; k += 3) {
    const away = depth + (screen[k + 2] - tip) * ofPx;
    places.set(pointAt(lens, screen[k], screen[k + 1], Math.max(away, 0.2 * depth)), k);
  }
  for (const tip of kTips) {
    const along = [0, 1, 2].map((k) => places[3 * tip + k] - places[3 * tip - 3 + k]), size = Math.hypot(...along) || 1;
    for (let k = 0; k < 3; ++k) places[3 * tip + k] += kBeforeEnd * along[k] / size;
  }
  return places;
}

/** The depth of the skin that a pixel is next to, and how far that is across the line of sight.
 *  @param {Float32Array} vertices  m, x0 y0 z0 x1 ...  @returns {{depth: number, away: number}} */
export function depthBeside(lens, x, y, vertices) {
  const { f, cx, cy, eye, right, up, forward } = lens, count = vertices.length / 3;
  const away = new Float64Array(count), depths = new Float64Array(count);
  let nearest = Infinity;
  for (let v = 0; v < count; ++v) {
    const [a, b, c] = [vertices[3 * v] - eye[0], vertices[3 * v + 1] - eye[1], vertices[3 * v + 2] - eye[2]];
    const depth = depths[v] = a * forward[0] + b * forward[1] + c * forward[2];
    const dx = (a * right[0] + b * right[1] + c * right[2]) - (x - cx) / f * depth;
    const dy = (a * up[0] + b * up[1] + c * up[2]) - (cy - y) / f * depth;
    nearest = Math.min(nearest, away[v] = Math.hypot(dx, dy));
  }
  let sum = 0, weight = 0;
  for (let v = 0; v < count; ++v) {
    const w = Math.max(0, 1 - (away[v] - nearest) / kDeepEnough);
    sum += w * depths[v];
    weight += w;
  }
  return { depth: sum / weight, away: nearest };
}

/** The plane of pressing of one hand: follows the part of the body that the tip comes to, and stays while it is there. */
export class Plane {
  isOver = false; // whether the tip is at the body, across the line of sight
  #depth = null;
  #time = 0;

  /** @param {number} middle  m, depth of the body's middle: where a hand begins that comes up over the body
   *  @param {boolean} held  whether the hand touches  @returns {number} m, depth */
  step(lens, x, y, vertices, middle, held, time) {
    const found = depthBeside(lens, x, y, vertices), isNew = this.#depth === null;
    if (isNew) this.#depth = found.away < kHold ? middle : found.depth;
    else if (!held && found.away > kHold) this.#depth += (1 - Math.exp(-kEase * (time - this.#time))) * (found.depth - this.#depth);
    this.#time = time;
    this.isOver = found.away < kHold;
    return this.#depth;
  }
}

/** Whether a capsule reaches points of the skin. @param {Float64Array} capsules  8 numbers each */
export function reaches(capsules, vertices, margin = 0.002) {
  for (let c = 0; c < capsules.length; c += 8) {
    const [ax, ay, az, bx, by, bz, ra, rb] = capsules.subarray(c, c + 8);
    const [ux, uy, uz] = [bx - ax, by - ay, bz - az], uu = ux * ux + uy * uy + uz * uz || 1;
    for (let v = 0; v < vertices.length; v += 3) {
      const [px, py, pz] = [vertices[v] - ax, vertices[v + 1] - ay, vertices[v + 2] - az];
      const t = Math.min(Math.max((px * ux + py * uy + pz * uz) / uu, 0), 1), r = ra + t * (rb - ra) + margin;
      const [dx, dy, dz] = [px - t * ux, py - t * uy, pz - t * uz];
      if (dx * dx + dy * dy + dz * dz < r * r) return true;
    }
  }
  return false;
}

/** All capsules moved by a vector. */
export function movedBy(capsules, shift) {
  const result = capsules.slice();
  for (let c = 0; c < result.length; c += 8) {
    for (let k = 0; k < 6; ++k) result[c + k] += shift[k % 3];
  }
  return result;
}

/** The largest way of a capsule's end from one pose to another, m. */
export function wayBetween(before, after) {
  let most = 0;
  for (let c = 0; c < after.length; c += 8) {
    for (const k of [c, c + 3]) {
      most = Math.max(most, Math.hypot(after[k] - before[k], after[k + 1] - before[k + 1], after[k + 2] - before[k + 2]));
    }
  }
  return most;
}
