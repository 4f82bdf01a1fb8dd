// The viewpoint: a camera that turns about the body, as in `palpable view` (orbit_camera.h).

/** Vertical field of view, rad: that of the desktop's studio. */
export const kView = 0.55;
const kRadPerPx = 0.008;
const kLowest = 0.02, kSteepest = 1.45; // rad above the floor: the camera stays above it, and off the vertical
// Distance to the body, as a ratio to that at which a ball around it just fits; in a narrow picture none is lost at
// the sides, as bodies are seldom as wide as the ball.
const kRoom = 1.1, kNarrowRoom = 0.98;
const kEase = 9; // 1/s, how fast the view follows a reset

const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const wrapped = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));

/** @param {ArrayLike<number>} vertices  x0 y0 z0 x1 ..., m
 *  @returns {{target: number[], radius: number, azimuth: number, height: number, width: number, foot: number[]}}
 *    m, rad; target: the middle; foot: x, y, half widths along x and y, and z of the part that stands on the floor */
export function shapeOf(vertices) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < vertices.length; ++k) {
    low[k % 3] = Math.min(low[k % 3], vertices[k]);
    high[k % 3] = Math.max(high[k % 3], vertices[k]);
  }
  const target = low.map((x, k) => (x + high[k]) / 2);
  let radius = 0, xx = 0, xy = 0, yy = 0;
  for (let v = 0; v < vertices.length; v += 3) {
    const [x, y, z] = [0, 1, 2].map((k) => vertices[v + k] - target[k]);
    radius = Math.max(radius, Math.hypot(x, y, z));
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  // Looks along the horizontal direction in which the body extends least, and a little from the side.
  const azimuth = wrapped(0.5 * Math.atan2(2 * xy, xx - yy) + 0.45);
  return { target, radius, azimuth, height: high[2] - low[2], width: Math.max(high[0] - low[0], high[1] - low[1]),
           foot: footOf(vertices, low[2], high[2] - low[2]) };
}

/** Whether two shapes of shapeOf() have another size or place, so that a view of one does not fit the other. A body that is
 *  pressed keeps its view. */
export function differ(a, b) {
  const far = Math.hypot(...a.target.map((x, k) => x - b.target[k]));
  return Math.max(far, Math.abs(a.radius - b.radius)) > 0.1 * Math.min(a.radius, b.radius);
}

function footOf(vertices, floor, height) {
  const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
  for (let v = 0; v < vertices.length; v += 3) {
    if (vertices[v + 2] > floor + 0.15 * height) continue;
    for (const k of [0, 1]) {
      low[k] = Math.min(low[k], vertices[v + k]);
      high[k] = Math.max(high[k], vertices[v + k]);
    }
  }
  return [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (high[0] - low[0]) / 2, (high[1] - low[1]) / 2, floor];
}

export class Orbit {
  #usual;
  #goal = null; // the usual view while it eases there

  /** @param {ReturnType<typeof shapeOf>} shape */
  constructor(shape) {
    this.shape = shape;
    this.#usual = { azimuth: shape.azimuth, elevation: 0.32, zoom: 1 };
    Object.assign(this, this.#usual);
  }

  turn(dx, dy) {
    this.#goal = null;
    this.azimuth = wrapped(this.azimuth - kRadPerPx * dx);
    this.elevation = clamp(this.elevation + kRadPerPx * dy, kLowest, kSteepest);
  }
  /** @param {number} steps  of a wheel; positive: nearer */
  zoomBy(steps) {
    this.#goal = null;
    this.zoom = clamp(this.zoom * 0.9 ** steps, 0.25, 4);
  }
  /** @param {boolean} atOnce  without motion */
  reset(atOnce) {
    if (atOnce) Object.assign(this, this.#usual);
    else this.#goal = this.#usual;
  }
  /** Turns until a surface normal points no further than `widest` rad away from the eye. */
  face(normal, widest) {
    const [x, y] = normal, away = wrapped(Math.atan2(x, -y) - this.azimuth);
    if (Math.hypot(x, y) > 0.2 && Math.abs(away) > widest) {
      this.azimuth = wrapped(this.azimuth + away - Math.sign(away) * widest);
    }
  }

  /** Goes on with a reset. @returns {boolean} whether the view moves */
  step(seconds) {
    if (!this.#goal) return false;
    const share = 1 - Math.exp(-kEase * Math.min(seconds, 0.1));
    const left = wrapped(this.#goal.azimuth - this.azimuth);
    this.azimuth += share * left;
    this.elevation += share * (this.#goal.elevation - this.elevation);
    this.zoom += share * (this.#goal.zoom - this.zoom);
    if (Math.abs(left) + Math.abs(this.#goal.elevation - this.elevation) < 2e-3 &&
        Math.abs(this.#goal.zoom - this.zoom) < 2e-3) this.#goal = null;
    return true;
  }

  /** Places a camera of three.js. @param {number} aspect  of the part of the picture that is free of words */
  place(camera, aspect) {
    const { target, radius } = this.shape;
    const distance = this.zoom * (aspect > 1 ? kRoom : kNarrowRoom) * radius / Math.sin(0.5 * kView * Math.min(aspect, 1));
    const flat = distance * Math.cos(this.elevation);
    camera.position.set(target[0] + flat * Math.sin(this.azimuth), target[1] - flat * Math.cos(this.azimuth),
                        target[2] + distance * Math.sin(this.elevation));
    camera.up.set(0, 0, 1);
    camera.lookAt(...target);
    camera.near = Math.max(0.05 * radius, distance - 3 * radius);
    camera.far = distance + 60 * radius;
  }
}
