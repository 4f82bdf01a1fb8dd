// The skin at rest, which the page shows while tables of touch arrive and are read: a body that gives way to nothing.
import { shapeOf } from './orbit.js';

/** Unit normals of the vertices, weighted by area, as the core has them. */
function normalsOf(x, triangles) {
  const sums = new Float32Array(x.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]];
    const [vx, vy, vz] = [x[c] - x[a], x[c + 1] - x[a + 1], x[c + 2] - x[a + 2]];
    const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (const v of [a, b, c]) {
      sums[v] += nx;
      sums[v + 1] += ny;
      sums[v + 2] += nz;
    }
  }
  for (let v = 0; v < sums.length; v += 3) {
    const length = Math.hypot(sums[v], sums[v + 1], sums[v + 2]) || 1;
    for (let k = v; k < v + 3; ++k) sums[k] /= length;
  }
  return sums;
}

/** To the page the same as a PressedBody. */
export class RestingBody {
  fingers = { count: 0, press() {}, drag() {}, release() {}, releaseAll() {} };
  shown = [];
  moves = false;

  /** @param facts  of bodies.js
   *  @param {Float32Array} vertices  m, x0 y0 z0 x1 ..., @param {Uint32Array} triangles */
  constructor(facts, vertices, triangles) {
    this.facts = facts;
    this.skin = { vertices, triangles, normals: normalsOf(vertices, triangles), stress: new Float32Array(vertices.length / 3) };
    this.shape = shapeOf(vertices);
  }
  placeAt() { return null; } // a drag on it turns the room
  step() { return false; }
  reading() { return { force: 0, push: 0, stress: 0, error: NaN, fingers: 0 }; }
  reset() {}
  close() {}
}
