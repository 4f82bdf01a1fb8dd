// Compares the core for pages with the C library: node --test web/test.mjs
//
//   PALPABLE_BODY   a body file, PALPABLE_WEB_BODY its delivery file; left out: tests/data/touched_ball_v1.palpable
//                   and what PALPABLE (the program; build/release/bin/palpable) exports of it
//   PALPABLE_LIBRARY   folder of libpalpable.so; left out: build/release/lib
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { handCapsules, loadBody, memoryBytes, PalpableError, Session, version } from './index.js';
import { thingsOf, topOf } from './test/frames.mjs';

const root = fileURLToPath(new URL('..', import.meta.url));
const library = process.env.PALPABLE_LIBRARY ?? join(root, 'build/release/lib');
const program = process.env.PALPABLE ?? join(root, 'build/release/bin/palpable');
const nativeBody = process.env.PALPABLE_BODY ?? join(root, 'tests/data/touched_ball_v1.palpable');
const kFrames = 300;

let folder, bytes, body;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'palpable-web-'));
  symlinkSync(join(root, 'src/palpable/live/capi'), join(folder, 'palpable'));
  let file = process.env.PALPABLE_WEB_BODY;
  if (!file) {
    file = join(folder, 'body.palpweb');
    execFileSync(program, ['export', nativeBody, '--to', 'web', '-o', file]);
  }
  bytes = readFileSync(file);
  body = await loadBody(bytes);
});
after(() => {
  body?.free();
  rmSync(folder, { recursive: true, force: true });
});

function compile(source, name) {
  const made = join(folder, name);
  execFileSync('cc', ['-std=c11', '-O1', '-Wall', '-Werror', `-I${folder}`, source, '-o', made, join(library, 'libpalpable.so'),
                      `-Wl,-rpath,${library}`]);
  return made;
}

const flat = (things) => things.map(({ id, capsules }) => ({
  id, capsules: Float64Array.from(capsules.flatMap((c) => [...c.a, ...c.b, c.radiusA, c.radiusB])),
}));
const numbersOf = (things) => [things.length, ...things.flatMap(({ id, capsules }) => [id, capsules.length / 8, ...capsules])];

// What press_lines.c writes of a frame, as named arrays.
function resultsOf(session) {
  const { leftToGo, inside, passedThrough, touchCount } = session.frame, skin = session.skin();
  const touches = session.touches.flatMap((t) =>
    [...t.point, ...t.normal, ...t.force, t.depth, t.area, t.thing === null ? -(2 ** 63) : Number(t.thing)]);
  return [['frame', Float64Array.of(leftToGo, inside, passedThrough, touchCount)], ['touches', Float64Array.from(touches)],
          ['vertices', skin.vertices.slice()], ['normals', skin.normals.slice()], ['stress', skin.stress.slice()],
          ['contact pressure', skin.contactPressure.slice()]];
}

test('300 frames give the same bytes as the C library', () => {
  const session = new Session(body), rest = session.skin().vertices.slice();
  const all = Array.from({ length: kFrames }, (_, k) => flat(thingsOf('all', k, rest)));
  writeFileSync(join(folder, 'frames'), Float64Array.from(all.flatMap(numbersOf)));
  execFileSync(compile(join(root, 'web/test/press_lines.c'), 'press_lines'), [nativeBody, join(folder, 'frames'), join(folder, 'results')]);
  const expected = readFileSync(join(folder, 'results'));
  const differing = new Map();
  let at = 0, touched = 0;
  all.forEach((things, k) => {
    session.pressAt(things, (k + 1) / 30);
    touched += session.frame.touchCount > 0;
    for (const [name, array] of resultsOf(session)) {
      const ours = Buffer.from(array.buffer), theirs = expected.subarray(at, at += ours.length);
      if (ours.equals(theirs)) continue;
      const its = new array.constructor(Uint8Array.from(theirs).buffer);
      const far = array.reduce((most, x, i) => Math.max(most, Math.abs(x - its[i])), 0);
      const before = differing.get(name) ?? { first: k, frames: 0, far: 0 };
      differing.set(name, { ...before, frames: before.frames + 1, far: Math.max(before.far, far) });
    }
  });
  session.close();
  assert.equal(at, expected.length, 'as many bytes');
  assert.ok(touched > kFrames / 2, `${touched} of ${kFrames} frames touch`);
  assert.deepEqual([...differing], []);
});

test('twenty lines of JavaScript and of C print the same force', () => {
  const page = readFileSync(join(root, 'docs/web.md'), 'utf8');
  const source = join(folder, 'example.c'), file = join(folder, 'example.palpweb');
  writeFileSync(source, page.match(/```c\n([^]*?)```/)[1]);
  writeFileSync(file, bytes);
  const native = execFileSync(compile(source, 'example'), [nativeBody], { encoding: 'utf8' });
  const ours = execFileSync(process.execPath, [join(root, 'web/example.mjs'), file], { encoding: 'utf8' });
  assert.match(native, /^-?\d+\.\d+ -?\d+\.\d+ -\d+\.\d+ N, reached$/m);
  assert.equal(ours, native);
});

test('a damaged or cut file is refused in a line', async () => {
  for (const count of [0, 7, 100, bytes.length - 1]) {
    await assert.rejects(loadBody(bytes.subarray(0, count)), (error) => {
      assert.ok(error instanceof PalpableError && error.status === 2, String(error));
      assert.match(error.message, /^[^\n]+$/);
      return true;
    });
  }
});

test('a Response is read with progress, with and without its length', async () => {
  for (const headers of [{ 'content-length': String(bytes.length) }, {}]) {
    const seen = [];
    const again = await loadBody(new Response(bytes, { headers }), { onProgress: (...now) => seen.push(now) });
    assert.equal(seen.at(-1)[0], bytes.length);
    assert.equal(seen.at(-1)[1], headers['content-length'] ? bytes.length : undefined);
    again.free();
  }
});

test('wrong arguments are refused, and nothing is changed', () => {
  const session = new Session(body);
  const ball = (x) => [{ id: 1, capsules: [{ a: [x, 0, 1], b: [x, 0, 1], radiusA: 0.01 }] }];
  session.pressAt(ball(0), 1);
  assert.throws(() => session.pressAt(ball(NaN), 2), /coordinate/);
  assert.throws(() => session.pressAt(ball(0), 1), /time is 1 s/);
  assert.throws(() => session.pressAt([...ball(0), ...ball(1)], 2), /same id/);
  for (const friction of [-1, NaN, 11]) { // -1 is PALPABLE_NO_FRICTION in C
    assert.throws(() => session.pressAt([{ ...ball(0)[0], friction }], 2), /friction is/);
  }
  assert.throws(() => session.skin(1), /no body 1/);
  assert.throws(() => body.place(new Array(16).fill(1)), /last row/);
  assert.equal(session.frame.time, 1);
  session.close();
});

test('old skins say that they are old', () => {
  const session = new Session(body), skin = session.pressAt([], 1).skin();
  assert.equal(skin.vertices.length, 3 * skin.vertexCount);
  session.pressAt([], 2);
  assert.throws(() => skin.vertices, /earlier frame/);
  session.close();
});

test('of two bodies the one that is pressed gives way', async () => {
  const other = await loadBody(bytes);
  other.place([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]); // 1 m beside
  const session = new Session(body, other), [x, y, z] = topOf(session.skin(1).vertices);
  const rest = [0, 1].map((k) => session.skin(k).vertices.slice());
  const centre = [x + 1, y, z + 0.007];
  for (let k = 1; k <= 3; ++k) session.pressAt([{ id: 5, capsules: [{ a: centre, b: centre, radiusA: 0.01 }] }], k);
  assert.equal(session.bodyCount, 2);
  assert.deepEqual(session.touches.map((touch) => [touch.body, touch.by, touch.thing]), [[1, -1, 5]]);
  assert.deepEqual(session.skin(0).vertices, rest[0]);
  assert.notDeepEqual(session.skin(1).vertices, rest[1]);
  assert.equal(session.skin(1).worldFromBody[3], 1);
  session.close();
  other.free();
});

test('the capsules of a hand are those of hands.h', () => {
  const joints = readHand();
  const hand = handCapsules('webxr', 'right', joints);
  assert.equal(hand.length, 8 * 26);
  assert.ok(hand.every(Number.isFinite));
  assert.throws(() => handCapsules('webxr', 'right', joints.map((x) => 1000 * x)), /in metres/);
  assert.throws(() => handCapsules('webxr', 'right', joints.slice(3)), /25 joints/);
});

// A flat hand: the wrist, then five fingers of 4 or 5 joints each along y.
function readHand() {
  const joints = [0, 0, 0];
  [-0.04, -0.02, 0, 0.02, 0.04].forEach((x, finger) => {
    const count = finger === 0 ? 4 : 5;
    for (let k = 0; k < count; ++k) joints.push(x, 0.03 + 0.03 * k, 0);
  });
  return joints;
}

test('memory does not grow from call to call', () => {
  const session = new Session(body), rest = session.skin().vertices.slice();
  const press = (from, to) => {
    for (let k = from; k < to; ++k) session.pressAt(thingsOf('all', k, rest), k + 1);
  };
  press(0, 300);
  const bytesBefore = memoryBytes();
  press(300, 900);
  assert.equal(memoryBytes(), bytesBefore);
  session.close();
});

test('the version is that of the package', () => {
  const { version: ours } = JSON.parse(readFileSync(join(root, 'web/package.json'), 'utf8'));
  assert.equal(ours.split('-')[0], version());
  assert.ok(existsSync(join(root, 'web/dist/palpable.wasm')));
});
