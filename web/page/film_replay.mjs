// Hands that were found in a film, pressed into its body in Node as the page would, through the film's own camera.
import { handCapsules, Session } from '../index.js';
import { joints, kTip, Plane, pointAt } from './hand_placing.js';
import { HandPresses, kFirstThing } from './hand_presses.js';
import { HandTracks } from './hand_tracks.js';

/** The film's camera in the body's frame; "pixels" are x / z and y / z. @param {number[]} m  camera_from_body, row by row */
export function lensOf(m) {
  const axis = (r) => [m[4 * r], m[4 * r + 1], m[4 * r + 2]], [right, down, forward] = [axis(0), axis(1), axis(2)];
  const t = [m[3], m[7], m[11]], eye = [0, 1, 2].map((k) => -(right[k] * t[0] + down[k] * t[1] + forward[k] * t[2]));
  return { f: 1, cx: 0, cy: 0, eye, right, up: down.map((x) => -x), forward };
}

/** @param body  of loadBody(), @param truth  of readTruth(), @param {[number, FoundHand[]][]} found  by frame, not mirrored
 *  @param {{every: number, late: number, strongest?: number, alter?: (frame: number, hands: object[]) => object[]}} how  finds every so many frames, so many
 *    frames late, and what else happens to them
 *  @returns {{frame: number, touches: boolean, force: number, jump: number, push: number}[]}
 *    jump: m, the farthest that a point of the skin moved since the frame before */
export function replay(body, truth, found, { every = 3, late = 3, strongest = Infinity, alter = (_, hands) => hands } = {}) {
  const lens = lensOf(truth.cameraFromBody), session = new Session(body), tracks = new HandTracks(), presses = new HandPresses();
  const planes = new Map(), byFrame = new Map(found), rows = [];
  const [left, right] = [truth.directionOf(0, 0.5), truth.directionOf(1, 0.5)], width = right[0] - left[0];
  session.pressAt([], 1);
  let step = 1, before = session.skin().vertices.slice();
  const target = [0, 1, 2].map((k) => before.reduce((sum, x, n) => n % 3 === k ? sum + x : sum, 0) / (before.length / 3));
  const middle = target.reduce((sum, x, k) => sum + (x - lens.eye[k]) * lens.forward[k], 0);
  for (const [frame] of found) {
    const time = frame / 30;
    if (frame % every === 0 && byFrame.has(frame - late)) {
      const hands = alter(frame - late, byFrame.get(frame - late).map(({ side, score, points }) => {
        const seen = new Float32Array(63);
        for (let k = 0; k < 63; k += 3) seen.set([...truth.directionOf(points[k], points[k + 1]), width * points[k + 2]], k);
        return { side: side === 'left' ? 'right' : 'left', score, points: seen };
      }));
      tracks.update(hands, (frame - late) / 30);
    }
    const { vertices } = session.skin(), touches = session.touches, placed = [];
    for (const { id, side, points } of tracks.at(time)) {
      if (!planes.has(id)) planes.set(id, new Plane());
      const isTouching = touches.some(({ thing }) => thing === kFirstThing + id);
      const depth = planes.get(id).step(lens, points[3 * kTip], points[3 * kTip + 1], vertices, middle, isTouching, time);
      try {
        placed.push({ id, capsules: handCapsules('mediapipe', side, joints(lens, points, depth)) });
      } catch { /* not as long as a hand is */ }
    }
    for (const things of presses.step(placed, { vertices, touches, toEye: lens.forward.map((x) => -x), now: time, strongest })) session.pressAt(things, ++step);
    const skin = session.skin().vertices, now = session.touches;
    let jump = 0;
    for (let v = 0; v < skin.length; v += 3) jump = Math.max(jump, Math.hypot(skin[v] - before[v], skin[v + 1] - before[v + 1], skin[v + 2] - before[v + 2]));
    before = skin.slice();
    rows.push({ frame, jump, touches: now.length > 0, force: now.reduce((sum, { force }) => sum + Math.hypot(...force), 0),
                push: now.reduce((most, { depth }) => Math.max(most, depth), 0) });
  }
  session.close();
  return rows;
}
