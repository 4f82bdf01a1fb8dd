// What is true in a film of `palpable synth` (docs/benchmark_files.md): its hand and its touches, and the way from a pixel of
// its left pictures to the rectified left camera, in which truth is stated.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

const numbers = (text) => text.split(',').map(Number);
/** A matrix of OpenCV's YAML. */
const matrixOf = (yaml, name) => numbers(yaml.match(new RegExp(`^${name}: !!opencv-matrix[^]*?data: \\[([^\\]]*)\\]`, 'm'))[1]);
const lines = (path) => readFileSync(path, 'utf8').trim().split('\n').map((line) => JSON.parse(line));

const times = (a, b) => Array.from({ length: 9 }, (_, k) => [0, 1, 2].reduce((sum, j) => sum + a[3 * Math.floor(k / 3) + j] * b[3 * j + k % 3], 0));
const transposed = (m) => [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];
const turned = (m, v) => [0, 1, 2].map((r) => m[3 * r] * v[0] + m[3 * r + 1] * v[1] + m[3 * r + 2] * v[2]);

/** Rodrigues' formula. */
function rotation(axis, angle) {
  const [x, y, z] = axis, c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [t * x * x + c, t * x * y - s * z, t * x * z + s * y, t * x * y + s * z, t * y * y + c, t * y * z - s * x,
          t * x * z - s * y, t * y * z + s * x, t * z * z + c];
}
/** rectified_from_left, as cv::stereoRectify has it: half of the rotation to the right eye, then the baseline onto x. */
function rectifying(R, T) {
  const w = [R[7] - R[5], R[2] - R[6], R[3] - R[1]], size = Math.hypot(...w), angle = Math.atan2(size / 2, (R[0] + R[4] + R[8] - 1) / 2);
  const half = rotation(w.map((x) => x / (size || 1)), -angle / 2), t = turned(half, T), sign = Math.sign(t[0]);
  const of = [0, t[2] * sign, -t[1] * sign], long = Math.hypot(...of); // t x (sign, 0, 0)
  const align = long > 0 ? rotation(of.map((x) => x / long), Math.acos(Math.abs(t[0]) / Math.hypot(...t))) : [1, 0, 0, 0, 1, 0, 0, 0, 1];
  return times(align, transposed(half));
}

/** @param {string} film  folder of `palpable synth` */
export function readTruth(film) {
  const yaml = readFileSync(join(film, 'frames/calibration.yml'), 'utf8');
  const K = matrixOf(yaml, 'K1'), [k1, k2, p1, p2] = matrixOf(yaml, 'D1');
  const rectify = rectifying(matrixOf(yaml, 'R'), matrixOf(yaml, 'T'));
  const width = Number(yaml.match(/image_width: (\d+)/)[1]), height = Number(yaml.match(/image_height: (\d+)/)[1]);
  const hands = new Map(lines(join(film, 'truth/hand.jsonl')).map(({ frame, capsules }) => [frame, capsules]));
  const scene = readFileSync(join(film, 'frames/scene.toml'), 'utf8');
  return {
    width, height, hands, contact: lines(join(film, 'truth/contact.jsonl')),
    cameraFromBody: numbers(scene.match(/camera_from_body = \[([^\]]*)\]/)[1]),
    /** x / z and y / z in the rectified camera, of a pixel of the left pictures as a share of width and height. */
    directionOf(u, v) {
      // A pixel's centre is at whole numbers.
      const [a, b] = [(u * width - 0.5 - K[2]) / K[0], (v * height - 0.5 - K[5]) / K[4]];
      let [x, y] = [a, b];
      for (let k = 0; k < 12; ++k) {
        const r2 = x * x + y * y, radial = 1 + k1 * r2 + k2 * r2 * r2;
        [x, y] = [(a - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial, (b - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial];
      }
      const [X, Y, Z] = turned(rectify, [x, y, 1]);
      return [X / Z, Y / Z];
    },
  };
}

/** The end of a hand's index finger: where its skin is farthest along its last bone, m. @param capsules  of truth, the hand's first */
export function indexTip(capsules) {
  const [ax, ay, az, bx, by, bz, , r] = capsules[2], d = [bx - ax, by - ay, bz - az], size = Math.hypot(...d);
  return [bx, by, bz].map((x, k) => x + r * d[k] / size);
}
