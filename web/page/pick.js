// Where a ray meets the skin, in the triangles of the core: not in those of the picture, which are finer.

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const three = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];

/** Moeller and Trumbore 1997; triangles that are seen from inside are not met.
 * @returns {[number, number, number] | null}  distance along the ray, and two barycentric coordinates */
function meet(origin, direction, a, b, c) {
  const ab = sub(b, a), ac = sub(c, a), p = cross(direction, ac), det = dot(ab, p);
  if (det < 1e-14) return null;
  const s = sub(origin, a), u = dot(s, p) / det;
  if (u < 0 || u > 1) return null;
  const q = cross(s, ab), v = dot(direction, q) / det;
  if (v < 0 || u + v > 1) return null;
  const t = dot(ac, q) / det;
  return t > 0 ? [t, u, v] : null;
}

/** @typedef {{point: number[], inwards: number[]}} Place  a point of the skin, m, and the unit vector into the body */

/** The place at which a ray first meets the skin.
 * @param skin     vertices, triangles; of the core
 * @param normals  of the vertices at rest: a press goes the way that it would go without the other ones
 * @returns {Place | null} */
export function placeAt(origin, direction, { vertices, triangles }, normals) {
  let best = Infinity, found = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const [i, j, k] = [triangles[t], triangles[t + 1], triangles[t + 2]];
    const hit = meet(origin, direction, three(vertices, i), three(vertices, j), three(vertices, k));
    if (hit && hit[0] < best) [best, found] = [hit[0], { i, j, k, u: hit[1], v: hit[2] }];
  }
  if (!found) return null;
  const { i, j, k, u, v } = found, w = 1 - u - v;
  const sum = [0, 1, 2].map((d) => w * normals[3 * i + d] + u * normals[3 * j + d] + v * normals[3 * k + d]);
  const length = Math.hypot(...sum) || 1;
  return { point: origin.map((x, d) => x + best * direction[d]), inwards: sum.map((x) => -x / length) };
}
