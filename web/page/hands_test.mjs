// Following, placing and pressing of webcam hands, without a browser: node --test web/page/hands_test.mjs
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { handCapsules, load } from '../index.js';
import { joints, kTip, onScreen, Plane, pxPerMetre } from './hand_placing.js';
import { HandPresses, kFirstThing } from './hand_presses.js';
import { HandTracks, lagAt, sizeOf, withoutDoubles } from './hand_tracks.js';

// A right hand's joints as MediaPipe has them, flat, m; x right, y down. Wrist at the origin.
const kFlat = [[0, 0], [0.03, -0.02], [0.052, -0.045], [0.066, -0.068], [0.08, -0.09], [0.03, -0.087], [0.034, -0.13], [0.036, -0.155],
               [0.038, -0.178], [0.008, -0.09], [0.008, -0.138], [0.008, -0.167], [0.008, -0.19], [-0.013, -0.085], [-0.015, -0.13],
               [-0.016, -0.157], [-0.017, -0.18], [-0.03, -0.075], [-0.038, -0.108], [-0.042, -0.128], [-0.046, -0.146]];
/** In widths of a picture: a hand whose size (0.09 m) is 0.15 of the width, its wrist at (x, y). */
const kScale = 0.15 / 0.09;
const handAt = (x, y, more = {}) => ({ side: 'left', score: 0.9, ...more,
  points: Float32Array.from(kFlat.flatMap(([a, b]) => [x + kScale * a, y + kScale * b, 0])) });

// Deterministic noise, about normal, standard deviation 1.
function noise(seed) {
  let state = seed;
  const uniform = () => { state = (1664525 * state + 1013904223) >>> 0; return state / 2 ** 32; };
  return () => Array.from({ length: 12 }, uniform).reduce((sum, x) => sum + x, -6);
}

test('two hands keep their identity, whatever their order in the list', () => {
  const tracks = new HandTracks();
  for (let k = 0; k < 20; ++k) {
    const both = [handAt(0.2 + 0.005 * k, 0.5), handAt(0.8 - 0.005 * k, 0.5)];
    tracks.update(k % 2 ? both : both.reverse(), k / 10);
  }
  const [one, two] = tracks.at(1.9).sort((a, b) => a.id - b.id);
  assert.deepEqual([one.id, two.id], [1, 2]);
  assert.ok(Math.abs(one.points[0] - two.points[0]) > 0.3);
});

test('one hand that is found twice is one hand', () => {
  const twice = [handAt(0.5, 0.5, { score: 0.7 }), handAt(0.51, 0.5, { side: 'right', score: 0.95 })];
  assert.deepEqual(withoutDoubles(twice).map(({ score }) => score), [0.95]);
  const tracks = new HandTracks();
  for (let k = 0; k < 10; ++k) tracks.update(k % 3 ? twice : twice.slice(0, 1), k / 10);
  assert.equal(tracks.at(0.9).length, 1);
  assert.equal(tracks.at(0.9)[0].id, 1);
});

test('a hand goes on through a gap of 200 ms, and is gone after it', () => {
  const tracks = new HandTracks();
  tracks.update([handAt(0.5, 0.5)], 0);
  tracks.update([], 0.1);
  tracks.update([], 0.2);
  assert.equal(tracks.at(0.2).length, 1);
  tracks.update([handAt(0.52, 0.5)], 0.25);
  assert.equal(tracks.at(0.25)[0].id, 1);
  tracks.update([], 0.35);
  tracks.update([], 0.46);
  assert.equal(tracks.at(0.46).length, 0);
  tracks.update([handAt(0.5, 0.5)], 0.5);
  assert.equal(tracks.at(0.5)[0].id, 2);
  assert.equal(tracks.at(1.6).length, 0, 'a finder that says nothing for a second');
});

test('a slow finder, three pictures a second, does not lose who is who', () => {
  const tracks = new HandTracks();
  for (let k = 0; k < 6; ++k) tracks.update([handAt(0.2 + 0.2 * k, 0.5)], 0.3 * k); // 1.3 hand sizes each time
  assert.equal(tracks.at(1.5)[0].id, 1);
});

test('a side that flips once it is settled is not believed', () => {
  const tracks = new HandTracks();
  for (let k = 0; k < 8; ++k) tracks.update([handAt(0.5, 0.5)], k / 10);
  for (let k = 8; k < 40; ++k) {
    tracks.update([handAt(0.5, 0.5, { side: k % 5 ? 'right' : 'left' })], k / 10);
    assert.equal(tracks.at(k / 10)[0].side, 'left');
  }
});

test('the lag of the filter is the stated one, and prediction makes up for it', () => {
  const speed = 3 * 0.15, tracks = new HandTracks(); // three sizes a second, in widths
  for (let k = 0; k <= 30; ++k) tracks.update([handAt(0.2 + speed * k / 30, 0.5)], k / 30);
  const filtered = tracks.at(1)[0].points[0], behind = (0.2 + speed - filtered) / speed;
  assert.ok(Math.abs(behind - lagAt(3)) < 0.006, `${1000 * behind} ms, stated ${1000 * lagAt(3)}`);
  const later = tracks.at(1.08)[0].points[0], wrong = Math.abs(later - (0.2 + 1.08 * speed));
  assert.ok(wrong < 1.3 * speed * lagAt(3), 'after 80 ms it is no farther off than by the filter');
});

test('a hand that rests trembles by less than 0.7 of what the finder does', () => {
  const tracks = new HandTracks(), tremble = noise(5), kDeviation = 0.0015 * kScale, seen = []; // 1.5 mm
  for (let k = 0; k < 200; ++k) {
    const hand = handAt(0.5, 0.5);
    for (let n = 0; n < 63; ++n) if (n % 3 < 2) hand.points[n] += kDeviation * tremble();
    tracks.update([hand], k / 12);
    if (k > 20) seen.push(tracks.at(k / 12)[0].points[3 * kTip]);
  }
  const mean = seen.reduce((a, b) => a + b) / seen.length, rms = Math.sqrt(seen.reduce((sum, x) => sum + (x - mean) ** 2, 0) / seen.length);
  assert.ok(rms < 0.7 * kDeviation, `${rms / kDeviation} of the finder's`);
});

// --- placing -----------------------------------------------------------------------------------------------

const kLens = { f: 1000, cx: 640, cy: 400, eye: [0, 0, 0], right: [1, 0, 0], up: [0, 0, 1], forward: [0, 1, 0] };

test('a hand is mirrored, and its tip is at the depth of the plane', () => {
  const hand = handAt(0.3, 0.5), screen = onScreen(hand.points, 0.75, 1280, 800);
  // 1280 x 960 fills 1280 x 800: 80 px are cut off above and below.
  assert.ok(Math.abs(screen[0] - 0.7 * 1280) < 1e-3 && Math.abs(screen[1] - (0.5 * 1280 - 80)) < 1e-3);
  const places = joints(kLens, screen, 0.5), tip = places.subarray(3 * kTip, 3 * kTip + 3);
  assert.ok(Math.abs(tip[1] - 0.5) < 1e-12);
  const seen = (screen[3 * kTip] - 640) / 1000 * 0.5, end = Math.hypot(tip[0] - seen, tip[2] - (400 - screen[3 * kTip + 1]) / 1000 * 0.5);
  assert.ok(Math.abs(end - 0.008) < 1e-9, 'the finger ends 8 mm on');
  assert.ok(Math.abs(pxPerMetre(screen) - 1280 * kScale) < 0.1 * 1280 * kScale, 'within the tenth by which hands differ');
});

test('what is placed on the screen is as long as a hand, and has capsules of the core', async () => {
  await load(readFileSync(new URL('../dist/palpable.wasm', import.meta.url)));
  const screen = onScreen(handAt(0.3, 0.5).points, 0.75, 1280, 800), depth = kLens.f / pxPerMetre(screen);
  const capsules = handCapsules('mediapipe', 'left', joints(kLens, screen, depth));
  assert.equal(capsules.length, 26 * 8);
  assert.ok(Math.abs(sizeOf(joints(kLens, screen, depth).map((x, k) => k % 3 === 1 ? 0 : x)) - 0.09) < 0.05);
});

test('the plane follows the part that the tip comes to, and stays once it is there', () => {
  // Two posts, 60 mm left at a depth of 0.4 m and 60 mm right at 0.6 m.
  const vertices = Float32Array.of(-0.06, 0.4, 0, -0.06, 0.4, 0.01, 0.06, 0.6, 0, 0.06, 0.6, 0.01), plane = new Plane();
  const px = (x, depth) => 640 + x / depth * 1000;
  let depth;
  for (let k = 0; k < 60; ++k) depth = plane.step(kLens, px(-0.1, 0.4), 400, vertices, 0.5, false, k / 60);
  assert.ok(Math.abs(depth - 0.4) < 1e-3);
  for (let k = 60; k < 120; ++k) depth = plane.step(kLens, px(0.1, 0.6), 400, vertices, 0.5, false, k / 60);
  assert.ok(Math.abs(depth - 0.6) < 1e-3, 'nearer to the other post');
  for (let k = 120; k < 180; ++k) depth = plane.step(kLens, px(-0.1, 0.4), 400, vertices, 0.5, true, k / 60);
  assert.ok(Math.abs(depth - 0.6) < 1e-3, 'it touches: the plane is held');
  assert.equal(new Plane().step(kLens, px(0.06, 0.6), 400, vertices, 0.5, false, 0), 0.5, 'comes up over the body: its middle');
});

// --- pressing ----------------------------------------------------------------------------------------------

const capsule = (x, y, z) => Float64Array.of(x, y, z, x + 0.05, y, z, 0.008, 0.008);
const kSkin = Float32Array.of(0, 0, 0), kCalm = { vertices: kSkin, touches: [], toEye: [0, -1, 0], now: 0 };

test('a hand that comes up over the body comes onto it slowly from before it', () => {
  const presses = new HandPresses(), hand = { id: 1, capsules: capsule(-0.02, 0, 0) };
  const first = presses.step([hand], kCalm).at(-1)[0].capsules;
  assert.ok(first[1] <= -0.0099, `${first[1]} m: clear of the skin`);
  let before = first;
  for (let k = 0; k < 100; ++k) {
    const next = presses.step([hand], kCalm).at(-1)[0].capsules;
    assert.ok(next[1] - before[1] <= 0.003 + 1e-12);
    before = next;
  }
  assert.equal(before[1], 0);
  const beside = new HandPresses().step([{ id: 1, capsules: capsule(0.1, 0, 0) }], kCalm).at(-1)[0].capsules;
  assert.deepEqual(beside, capsule(0.1, 0, 0));
});

test('a fast hand presses in steps, each less than a finger is thick', () => {
  const presses = new HandPresses();
  presses.step([{ id: 1, capsules: capsule(0.1, 0, 0) }], kCalm);
  const steps = presses.step([{ id: 1, capsules: capsule(0.12, 0, 0) }], kCalm);
  assert.equal(steps.length, 4);
  assert.ok(Math.abs(steps[0][0].capsules[0] - 0.105) < 1e-12 && Math.abs(steps[3][0].capsules[0] - 0.12) < 1e-12);
});

test('a hand that is lost while it presses goes back the way it pressed, and is gone once it is clear', () => {
  const presses = new HandPresses(), touches = [{ thing: kFirstThing + 1, force: [-2, 0, 0], depth: 0.006 }];
  presses.step([{ id: 1, capsules: capsule(0.1, 0, 0) }], kCalm);
  const left = presses.step([], { ...kCalm, touches, now: 1 }).at(-1)[0].capsules;
  assert.ok(Math.abs(left[0] - 0.103) < 1e-12);
  assert.equal(presses.step([], { ...kCalm, touches: [], now: 1.05 }).at(-1).length, 0);
  assert.equal(presses.count, 0);
  // And never longer than half a second, whatever it touches.
  presses.step([{ id: 2, capsules: capsule(0.1, 0, 0) }], kCalm);
  const stuck = [{ thing: kFirstThing + 2, force: [-2, 0, 0], depth: 0.006 }];
  presses.step([], { ...kCalm, touches: stuck, now: 2 });
  assert.equal(presses.step([], { ...kCalm, touches: stuck, now: 2.51 }).at(-1).length, 0);
});

test('a hand that touches goes on by 4 mm a frame, one that is too deep goes out again', () => {
  const presses = new HandPresses(), touches = [{ thing: kFirstThing + 1, force: [-2, 0, 0], depth: 0.004 }];
  presses.step([{ id: 1, capsules: capsule(0.03, 0, 0) }], kCalm);
  const on = presses.step([{ id: 1, capsules: capsule(0.002, 0, 0) }], { ...kCalm, touches }).at(-1)[0].capsules;
  assert.ok(Math.abs(on[0] - 0.026) < 1e-12);
  const deep = [{ ...touches[0], depth: 0.015 }];
  const out = presses.step([{ id: 1, capsules: capsule(0.002, 0, 0) }], { ...kCalm, touches: deep }).at(-1)[0].capsules;
  assert.ok(Math.abs(out[0] - 0.03) < 1e-12, `${out[0]}`);
  const along = presses.step([{ id: 1, capsules: capsule(0.002, 0, 0.004) }], { ...kCalm, touches: deep }).at(-1)[0].capsules;
  assert.ok(along[2] > 0.002, 'along the skin it goes where the hand goes');
});

test('a free hand that moves fast stops where it first touches', () => {
  const presses = new HandPresses();
  presses.step([{ id: 1, capsules: capsule(0.04, 0, 0) }], kCalm);
  const last = presses.step([{ id: 1, capsules: capsule(-0.02, 0, 0) }], kCalm).at(-1)[0].capsules;
  assert.ok(last[0] > 0.001 && last[0] <= 0.008, `${last[0]}`);
});

test('a hand that went through presses no more until it is clear', () => {
  const presses = new HandPresses(), far = { id: 1, capsules: capsule(-0.045, 0, 0) };
  presses.step([{ id: 1, capsules: capsule(0.02, 0, 0) }], kCalm);
  const touches = [{ thing: kFirstThing + 1, force: [-2, 0, 0], depth: 0.011 }];
  presses.step([far], { ...kCalm, touches }); // it would be 57 mm farther on
  assert.equal(presses.step([far], { ...kCalm, now: 1 }).at(-1).length, 0);
  assert.equal(presses.step([far], { ...kCalm, now: 2 }).at(-1).length, 0);
  assert.equal(presses.step([{ id: 1, capsules: capsule(0.1, 0, 0) }], kCalm).at(-1).length, 1);
});
