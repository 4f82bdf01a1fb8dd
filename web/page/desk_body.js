// What a running session sends (docs/web.md, the live desk): its messages, and the bodies that they describe. No page and
// no network here.
import { shapeOf } from './orbit.js';
import { materialWords } from './words.js';

/** The words of a binary message: "MESH", "SKIN", or "JPEG" of a picture's file. */
export function kindOf(buffer) {
  const bytes = new Uint8Array(buffer, 0, Math.min(4, buffer.byteLength));
  return bytes[0] === 0xff && bytes[1] === 0xd8 ? 'JPEG' : String.fromCharCode(...bytes);
}

/** @param {ArrayBuffer} buffer  "MESH" @returns {Int32Array[]}  of each body: indices of its triangles' corners */
export function readMesh(buffer) {
  const view = new DataView(buffer), bodies = [];
  let at = 8;
  for (let left = view.getUint32(4, true); left > 0; --left) {
    const count = 3 * view.getUint32(at, true);
    bodies.push(new Int32Array(buffer, at + 4, count));
    at += 4 + 4 * count;
  }
  return bodies;
}

/** @param {ArrayBuffer} buffer  "SKIN"
 *  @returns {{frame: number, bodies: {vertices: Float32Array, normals: Float32Array, stress: Float32Array}[]}}
 *    m and unit vectors, in each body's frame; Pa */
export function readSkin(buffer) {
  const view = new DataView(buffer), bodies = [];
  let at = 12;
  for (let left = view.getUint32(8, true); left > 0; --left) {
    const count = view.getUint32(at, true), part = (begin, size) => new Float32Array(buffer, at + 4 + 4 * begin * count, size * count);
    bodies.push({ vertices: part(0, 3), normals: part(3, 3), stress: part(6, 1) });
    at += 4 + 28 * count;
  }
  return { frame: view.getUint32(4, true), bodies };
}

// Rigid transforms of 16 numbers, row by row.
const kRest = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
export const turned = (m, v) => [0, 1, 2].map((r) => m[4 * r] * v[0] + m[4 * r + 1] * v[1] + m[4 * r + 2] * v[2]);
export const moved = (m, p) => turned(m, p).map((x, r) => x + m[4 * r + 3]);
/** inverse(a) * b */
export function between(a, b) {
  const columns = [0, 1, 2].map((c) => [b[c], b[4 + c], b[8 + c]]);
  const back = [a[0], a[4], a[8], 0, a[1], a[5], a[9], 0, a[2], a[6], a[10], 0];
  const shift = turned(back, [b[3] - a[3], b[7] - a[7], b[11] - a[11]]), result = kRest.slice();
  columns.forEach((column, c) => turned(back, column).forEach((x, r) => { result[4 * r + c] = x; }));
  shift.forEach((x, r) => { result[4 * r + 3] = x; });
  return result;
}

/** All bodies of a session as one skin, in the frame of the first, for scene.js. */
export class DeskBody {
  #places;     // of each body: first_from_body
  #triangles = null;
  #old = true; // whether the arrays are to be made anew
  skin = null;
  shape = null;
  shown = [];  // no fingers are drawn
  touches = [];

  /** @param hello, @param page  the two lines that greet a client */
  constructor(hello, page) {
    const poses = hello.bodies.map(({ world_from_body }) => world_from_body ?? kRest);
    this.#places = poses.map((pose) => between(poses[0], pose));
    const materials = new Set(page.bodies.map(({ material }) => materialWords(material ?? '')));
    this.facts = { name: hello.bodies.map(({ name }) => name).join(', '), material: [...materials].filter(Boolean).join('; '),
                   stressTop: Math.max(page.stress_top, 1e-9) };
  }

  /** @param {Int32Array[]} triangles */
  setMesh(triangles) {
    this.#triangles = triangles.map((corners) => corners.slice());
    this.#old = true;
  }

  /** @returns {boolean} whether the skin has other triangles than before @throws Error for a skin of other bodies */
  setSkin({ bodies }) {
    if (!this.#triangles || bodies.length !== this.#triangles.length) throw new Error('a skin came without its triangles');
    const count = bodies.reduce((sum, { stress }) => sum + stress.length, 0), isNew = this.#old || this.skin.stress.length !== count;
    if (isNew) this.#make(bodies, count);
    const { vertices, normals, stress } = this.skin;
    let from = 0;
    bodies.forEach((body, k) => {
      stress.set(body.stress, from);
      if (k === 0) {
        vertices.set(body.vertices);
        normals.set(body.normals);
      } else {
        for (let v = 0; v < 3 * body.stress.length; v += 3) {
          vertices.set(moved(this.#places[k], body.vertices.subarray(v, v + 3)), 3 * from + v);
          normals.set(turned(this.#places[k], body.normals.subarray(v, v + 3)), 3 * from + v);
        }
      }
      from += body.stress.length;
    });
    if (isNew) this.shape = shapeOf(vertices);
    return isNew;
  }
  #make(bodies, count) {
    const triangles = new Int32Array(this.#triangles.reduce((sum, corners) => sum + corners.length, 0));
    let to = 0, first = 0;
    this.#triangles.forEach((corners, k) => {
      for (const corner of corners) triangles[to++] = first + corner;
      first += bodies[k].stress.length;
    });
    this.skin = { triangles, vertices: new Float32Array(3 * count), normals: new Float32Array(3 * count), stress: new Float32Array(count) };
    this.#old = false;
  }

  /** Takes the touches of a line `frame`. What one body presses another with is marked as `mutual`. */
  setFrame(line) {
    this.hasFrame = true;
    const pose = line.bodies[0]?.camera_from_body;
    if (pose) this.eye = [3, 7, 11].map((k) => between(pose, kRest)[k]);
    this.errors = line.bodies.map((body) => body.stress_error).filter((error) => error > 0);
    this.touches = line.bodies.flatMap((body, k) => body.touches.map(({ point, force, press_depth, by }) => ({
      point: moved(this.#places[k] ?? kRest, point), force: turned(this.#places[k] ?? kRest, force), depth: press_depth ?? 0,
      mutual: by !== undefined,
    })));
  }
  errors = [];
  hasFrame = false;
  /** m, where the camera stands, in the frame of the first body; null before the first frame. */
  eye = null;

  /** As PressedBody.reading(): N, the sizes of the touches' forces, added; m, the deepest; Pa; relative or NaN. What one body
   *  presses another with is the answer to what presses from outside: it is not counted. */
  reading() {
    const touches = this.touches.filter(({ mutual }) => !mutual);
    let stress = 0;
    for (const x of this.skin?.stress ?? []) stress = Math.max(stress, x);
    return { force: touches.reduce((sum, { force }) => sum + Math.hypot(...force), 0),
             push: touches.reduce((most, { depth }) => Math.max(most, depth), 0), stress,
             error: this.errors.length > 0 ? Math.max(...this.errors) : NaN, fingers: touches.length };
  }
}
