// The skin as it is drawn: each triangle of the core as a curved piece through its three vertices and normals, so that
// outlines are round. Curved PN triangles: Vlachos, Peters, Boyd, Mitchell, I3D 2001. The core's results stay those of
// its own vertices; stress is interpolated linearly.

const kPieces = 3; // of each edge, up to kFine triangles; beyond, 2
const kFine = 4000;

// Barycentric coordinates of the points of a piece, row by row, and the triangles between them.
function patternOf(n) {
  const points = [], triangles = [], at = (row, k) => row * (row + 1) / 2 + k;
  for (let row = 0; row <= n; ++row) {
    for (let k = 0; k <= row; ++k) points.push([1 - row / n, (row - k) / n, k / n]);
  }
  for (let row = 0; row < n; ++row) {
    for (let k = 0; k <= row; ++k) {
      triangles.push([at(row, k), at(row + 1, k), at(row + 1, k + 1)]);
      if (k < row) triangles.push([at(row, k), at(row + 1, k + 1), at(row, k + 1)]);
    }
  }
  return { points, triangles };
}

// The weights of the ten control points of a cubic: three corners, two on each of three edges, the middle.
const weightsOf = ([a, b, c]) => [a ** 3, b ** 3, c ** 3, 3 * a * a * b, 3 * a * b * b, 3 * b * b * c, 3 * b * c * c,
                                  3 * c * c * a, 3 * c * a * a, 6 * a * b * c];

export class CurvedSkin {
  #triangles;
  #points;
  #weights;
  #controls = new Float64Array(30);

  /** @param {Int32Array} triangles  of the core @param {boolean} plain  draws these as they are */
  constructor(triangles, plain = false) {
    const { points, triangles: within } = patternOf(plain ? 1 : triangles.length / 3 <= kFine ? kPieces : 2);
    const count = triangles.length / 3, each = points.length;
    this.#triangles = triangles.slice();
    this.#points = points;
    this.#weights = points.map(weightsOf);
    this.indices = new Uint32Array(count * within.length * 3);
    let to = 0;
    for (let t = 0; t < count; ++t) {
      for (const corners of within) for (const k of corners) this.indices[to++] = each * t + k;
    }
    this.vertices = new Float32Array(3 * each * count);
    this.normals = new Float32Array(3 * each * count);
    this.stress = new Float32Array(each * count);
  }

  /** @param skin  vertices, normals, stress; of the core */
  update({ vertices, normals, stress }) {
    const each = this.#points.length, corners = this.#triangles;
    for (let t = 0, to = 0; t < corners.length; t += 3, to += each) {
      const [i, j, k] = [corners[t], corners[t + 1], corners[t + 2]];
      this.#shape(vertices, normals, i, j, k);
      for (let p = 0; p < each; ++p) this.#point(to + p, p, normals, stress, i, j, k);
    }
  }

  // The control points of one piece.
  #shape(x, n, i, j, k) {
    const c = this.#controls;
    for (let d = 0; d < 3; ++d) {
      c[d] = x[3 * i + d];
      c[3 + d] = x[3 * j + d];
      c[6 + d] = x[3 * k + d];
    }
    const edge = (from, to, at) => { // a third of the way, moved into the plane of the nearer vertex
      let away = 0, alike = 0;
      for (let d = 0; d < 3; ++d) {
        away += (x[3 * to + d] - x[3 * from + d]) * n[3 * from + d];
        alike += n[3 * from + d] * n[3 * to + d];
      }
      away *= Math.min(Math.max((alike - 0.2) / 0.5, 0), 1); // an edge between unlike normals is sharp: it stays straight
      for (let d = 0; d < 3; ++d) c[at + d] = (2 * x[3 * from + d] + x[3 * to + d] - away * n[3 * from + d]) / 3;
    };
    edge(i, j, 9);
    edge(j, i, 12);
    edge(j, k, 15);
    edge(k, j, 18);
    edge(k, i, 21);
    edge(i, k, 24);
    for (let d = 0; d < 3; ++d) {
      const mean = (c[9 + d] + c[12 + d] + c[15 + d] + c[18 + d] + c[21 + d] + c[24 + d]) / 6;
      c[27 + d] = mean + (mean - (c[d] + c[3 + d] + c[6 + d]) / 3) / 2;
    }
  }

  #point(to, p, n, stress, i, j, k) {
    const c = this.#controls, w = this.#weights[p], [a, b, g] = this.#points[p];
    let length = 0;
    for (let d = 0; d < 3; ++d) {
      let x = 0;
      for (let q = 0; q < 10; ++q) x += w[q] * c[3 * q + d];
      this.vertices[3 * to + d] = x;
      const y = a * n[3 * i + d] + b * n[3 * j + d] + g * n[3 * k + d];
      this.normals[3 * to + d] = y;
      length += y * y;
    }
    length = Math.sqrt(length) || 1;
    for (let d = 0; d < 3; ++d) this.normals[3 * to + d] /= length;
    this.stress[to] = a * stress[i] + b * stress[j] + g * stress[k];
  }
}
