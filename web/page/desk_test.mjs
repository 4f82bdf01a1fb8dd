// Opens the live desk of real runs in headless Chromium: node --test web/page/desk_test.mjs. tests/cli/live_page.py has what
// is sent; here is what a person sees of it.
//
//   PALPABLE        the program; left out: build/release/bin/palpable. It finds the bundle in web/dist/page
//   PALPABLE_SHOTS  a folder for pictures of each test; left out: none
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync, linkSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';
import { deflateSync } from 'node:zlib';
import { chromiumPath, launch } from './browser.mjs';
import { between, DeskBody, kindOf, moved, readMesh, readSkin } from './desk_body.js';
import { differ } from './orbit.js';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.PALPABLE ?? join(root, 'build/release/bin/palpable');
const body = join(root, 'tests/data/touched_ball_v1.palpable');
const kDesktop = { viewport: { width: 1280, height: 800 } };
const kPhone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const skip = !chromiumPath() ? 'there is no Chromium: apt-get install chromium, or set PALPABLE_CHROMIUM'
  : !existsSync(program) ? `${program} is not built` : !existsSync(join(root, 'web/dist/page')) ? 'web/dist/page is not built' : false;

// ---- without a browser ---------------------------------------------------------------------------------------------

function message(kind, ...numbers) { // ['u', 1], ['i', 1], ['f', 1]
  const buffer = new ArrayBuffer(4 + 4 * numbers.length), view = new DataView(buffer);
  [...kind].forEach((letter, k) => view.setUint8(k, letter.charCodeAt(0)));
  numbers.forEach(([type, value], k) => {
    if (type === 'f') view.setFloat32(4 + 4 * k, value, true);
    else view.setInt32(4 + 4 * k, value, true);
  });
  return buffer;
}
const ints = (...values) => values.map((value) => ['i', value]);
const floats = (...values) => values.map((value) => ['f', value]);
// Two bodies of one triangle; the second stands 1 m along the first one's y, turned by 90 degrees about z.
const kMesh = message('MESH', ...ints(2, 1, 0, 1, 2, 1, 2, 1, 0));
const skinOf = (stress) => message('SKIN', ...ints(7, 2, 3), ...floats(0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 2, stress),
                                   ...ints(3), ...floats(0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0, 4, 5, 6));
const kFirst = [0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1];
const kHello = { bodies: [{ name: 'a', world_from_body: kFirst },
                          { name: 'b', world_from_body: [-1, 0, 0, 4, 0, -1, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1] }] };

test('messages are read, and bodies joined in the frame of the first', () => {
  assert.equal(kindOf(kMesh), 'MESH');
  assert.equal(kindOf(Uint8Array.of(0xff, 0xd8, 0xff, 0xe0).buffer), 'JPEG');
  const desk = new DeskBody(kHello, { stress_top: 10, bodies: [{ material: 'rubber' }, {}] });
  assert.equal(desk.facts.material, 'rubber');
  assert.throws(() => desk.setSkin(readSkin(skinOf(3))), /triangles/);
  desk.setMesh(readMesh(kMesh));
  assert.equal(desk.setSkin(readSkin(skinOf(3))), true);
  assert.equal(desk.setSkin(readSkin(skinOf(9))), false);
  assert.deepEqual([...desk.skin.triangles], [0, 1, 2, 5, 4, 3]);
  assert.deepEqual([...desk.skin.stress], [1, 2, 9, 4, 5, 6]);
  const near = (got, wanted) => wanted.forEach((x, k) => assert.ok(Math.abs(got[k] - x) < 1e-6, `${got} is not ${wanted}`));
  near([...desk.skin.vertices.subarray(9)], [0, 1, 0, 0, 2, 0, -1, 1, 1]);
  near([...desk.skin.normals.subarray(9, 12)], [0, 1, 0]);
  near(moved(between(kFirst, kFirst), [1, 2, 3]), [1, 2, 3]);
  desk.setFrame({ bodies: [{ camera_from_body: [1, 0, 0, 0, 0, 0, -1, 0.1, 0, 1, 0, 0.4, 0, 0, 0, 1], touches: [{ point: [1, 0, 0], force: [3, 0, 4], press_depth: 0.002 }], stress_error: 0.1 },
                           { touches: [{ point: [0, 0, 0], force: [0, -1, 0], press_depth: 0.001 }] }] });
  const reading = desk.reading();
  assert.deepEqual([reading.force, reading.push, reading.stress, reading.error, reading.fingers], [6, 0.002, 9, 0.1, 2]);
  near(desk.touches[1].force, [1, 0, 0]);
  near(desk.eye, [0, -0.4, 0.1]); // of a body upright before the camera
});

test('what bodies press each other with is drawn, and not counted', () => {
  const desk = new DeskBody(kHello, { stress_top: 10, bodies: [{ material: 'rubber' }, { material: 'rubber' }] });
  assert.equal(desk.hasFrame, false);
  const at = { point: [0, 0, 0], press_depth: 0.003 };
  desk.setFrame({ bodies: [{ touches: [{ ...at, force: [0, 0, -2], press_depth: 0.001 }, { ...at, force: [0, 0, 1.5], by: 'b' }] },
                           { touches: [{ ...at, force: [0, 0, -1.5], by: 'a' }] }] });
  assert.equal(desk.hasFrame, true);
  assert.equal(desk.touches.length, 3);
  const { force, push, fingers } = desk.reading();
  assert.deepEqual([force, push, fingers], [2, 0.001, 1]);
});

test('the materials of all bodies are named, each once', () => {
  const of = (...materials) => new DeskBody(kHello, { stress_top: 10, bodies: materials.map((material) => ({ material })) }).facts.material;
  const soft = "neo-Hookean: Young's modulus 2e+04 Pa", hard = "neo-Hookean: Young's modulus 2e+06 Pa";
  assert.equal(of(soft, soft), of(soft));
  assert.equal(of(soft, hard), `${of(soft)}; ${of(hard)}`);
  assert.notEqual(of(soft), of(hard));
});

test('a view is kept for a body that is pressed, not for one of another size or place', () => {
  const shape = { target: [0, 0, 0.05], radius: 0.06 };
  assert.equal(differ(shape, { target: [0, 0, 0.048], radius: 0.059 }), false);
  assert.equal(differ(shape, { target: [0, 0.02, 0.05], radius: 0.06 }), true);
  assert.equal(differ(shape, { target: [0, 0, 0.05], radius: 0.03 }), true);
});

// ---- with a run and a browser --------------------------------------------------------------------------------------

let folder, browser;
before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'palpable-desk-'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

function crc32(bytes) { // node:zlib of Node 18 has none
  let crc = ~0;
  for (const byte of bytes) {
    crc ^= byte;
    for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc >>> 0;
}
function png(width, height, gray) {
  const rows = Buffer.alloc(height * (width + 1));
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) rows[y * (width + 1) + 1 + x] = gray(x, y);
  const part = (name, data) => {
    const whole = Buffer.alloc(12 + data.length);
    whole.writeUInt32BE(data.length);
    whole.write(name, 4);
    data.copy(whole, 8);
    whole.writeUInt32BE(crc32(whole.subarray(4, 8 + data.length)), 8 + data.length);
    return whole;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width);
  head.writeUInt32BE(height, 4);
  head[8] = 8;
  return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), part('IHDR', head), part('IDAT', deflateSync(rows)), part('IEND', Buffer.alloc(0))]);
}

/** A film of a wall 0.44 m away, which presses the ball. */
function writeWall(clip, frames) {
  const noise = (x, y) => ((x * 7919 + y * 104729) ^ (x * y * 31)) % 251 & 255;
  for (const [eye, shift] of [['left', 0], ['right', 25]]) {
    mkdirSync(join(clip, eye), { recursive: true });
    const first = join(clip, eye, '000000.png');
    writeFileSync(first, png(320, 180, (x, y) => noise((x + shift) >> 1, y >> 1)));
    for (let n = 1; n < frames; ++n) linkSync(first, join(clip, eye, `${String(n).padStart(6, '0')}.png`));
  }
  writeFileSync(join(clip, 'rectified.yml'), '%YAML:1.0\n---\nfx: 175.0\nfy: 175.0\ncx: 159.5\ncy: 89.5\nwidth: 320\nheight: 180\nbaseline_m: 0.063\ndoffs_px: 0.0\n');
  writeFileSync(join(clip, 'scene.toml'), 'press_static = true\ncamera_from_body = [1, 0, 0, 0,  0, 0, -1, 0.04,  0, 1, 0, 0.42,  0, 0, 0, 1]\n');
  return clip;
}

/** A hands file: a fingertip that comes down on the ball, and stays. */
function writeFinger(file, lines) {
  const text = Array.from({ length: lines }, (_, k) => {
    const tip = 0.092 + 0.008 - Math.min(0.00005 * k, 0.005);
    return JSON.stringify({ time: 0.02 * k, things: [{ id: 1, capsules: [[0, 0, tip, 0, 0, tip + 0.05, 0.008, 0.008]] }] });
  });
  writeFileSync(file, `${text.join('\n')}\n`);
  return file;
}

/** Starts a run; @returns {Promise<{url: string, end: () => Promise<string>}>} end: what it printed */
async function run(...words) {
  const child = spawn(program, ['live', body, ...words, '--serve', '0'], { cwd: root, stdio: ['ignore', 'pipe', 'pipe'] });
  let printed = '';
  child.stderr.on('data', (bytes) => { printed += bytes; });
  const ended = new Promise((done) => child.on('close', done));
  const url = await new Promise((found, failed) => {
    createInterface({ input: child.stdout }).on('line', (line) => {
      printed += `${line}\n`;
      if (line.startsWith('page: http')) found(line.slice(6));
    });
    ended.then(() => failed(new Error(`the run ended: ${printed}`)));
  });
  return { url, end: async () => { child.kill('SIGINT'); await ended; return printed; } };
}

async function visit(kind, url, doWith) {
  const context = await browser.newContext(kind), page = await context.newPage(), complaints = [];
  page.on('console', (text) => { if (text.type() === 'error') complaints.push(text.text()); });
  page.on('pageerror', (error) => complaints.push(error.message));
  try {
    await page.goto(url);
    await page.evaluate(async () => { globalThis.desk = await palpablePage; });
    await doWith(page, complaints);
  } finally {
    await context.close();
  }
}
async function shoot(page, name) {
  if (!process.env.PALPABLE_SHOTS) return;
  mkdirSync(process.env.PALPABLE_SHOTS, { recursive: true });
  await page.screenshot({ path: join(process.env.PALPABLE_SHOTS, `${name}.png`) });
}
const kPatience = { timeout: 60000 }; // a machine of CI draws a few frames a second

test('a run with a camera is shown: its picture, the pressed body, force and touches, and its end', { skip }, async () => {
  const live = await run('--source', writeWall(join(folder, 'clip'), 5000));
  await visit(kDesktop, live.url, async (page, complaints) => {
    await page.waitForFunction(() => desk.pictures > 2 && desk.body.touches.length > 0 && desk.frames > 0, null, kPatience);
    await page.waitForFunction(() => Number(document.getElementById('newtons').textContent) > 0, null, kPatience);
    const picture = await page.evaluate(() => [document.getElementById('picture').naturalWidth, document.getElementById('seen').hidden]);
    assert.deepEqual(picture, [160, false]); // half of 320
    assert.match(await page.textContent('#push'), /mm/);
    assert.match(await page.textContent('#largest'), /^largest [\d.]+ kPa(, above the colours)?$/);
    assert.equal(await page.textContent('#state'), 'live');
    assert.ok(await page.getByRole('img', { name: 'What the run shows' }).isVisible());
    // What is in the numbers is what is in the skin.
    assert.ok(await page.evaluate(() => Math.abs(Math.max(...desk.body.skin.stress) - desk.body.reading().stress) === 0));
    await shoot(page, 'desk');
    await page.keyboard.press('Tab');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'view');
    const lines = await page.evaluate(() => desk.lines);
    await page.keyboard.press('ArrowLeft');
    await page.waitForFunction((before) => desk.lines > before, lines, kPatience);
    assert.deepEqual(complaints, []);
    const printed = await live.end();
    assert.match(printed, /page: 1 clients, 0 refused/);
    await page.waitForFunction(() => desk.state === 'ended', null, kPatience);
    assert.equal(await page.textContent('#state'), 'the run has ended');
    assert.equal(await page.evaluate(() => desk.body.touches.length), 0);
  });
});

test('a run without a camera is shown without a picture, on a phone in the dark', { skip }, async () => {
  const live = await run('--source', writeFinger(join(folder, 'hands.jsonl'), 5000), '--paced');
  await visit({ ...kPhone, colorScheme: 'dark' }, live.url, async (page, complaints) => {
    await page.waitForFunction(() => desk.body.reading().force > 0.05, null, kPatience);
    assert.equal(await page.evaluate(() => document.getElementById('seen').hidden), true);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await page.getByRole('button', { name: 'How it works' }).click();
    assert.match(await page.locator('#explained li').first().textContent(), /palpable live/);
    await page.keyboard.press('Escape');
    await shoot(page, 'desk-phone');
    assert.deepEqual(complaints, []);
  });
  await live.end();
});

test('a page that lost its run says so, and one with another token sees nothing', { skip }, async () => {
  const live = await run('--source', writeFinger(join(folder, 'lost.jsonl'), 5000), '--paced');
  await visit(kDesktop, live.url, async (page) => {
    await page.evaluate(() => {
      globalThis.states = [];
      new MutationObserver(() => states.push([desk.state, Number(getComputedStyle(document.getElementById('view')).opacity)]))
        .observe(document.getElementById('state'), { attributeFilter: ['data-state'] });
      desk.drop();
    });
    await page.waitForFunction(() => states.some(([state]) => state === 'connected'), null, kPatience); // it has opened it again
    const states = await page.evaluate(() => globalThis.states);
    assert.deepEqual(states.map(([state]) => state), ['lost', 'connecting', 'connected']);
    assert.ok(states[0][1] < 1 && states[2][1] === 1, `opacities ${states}`);
    const frames = await page.evaluate(() => desk.lines);
    await page.waitForFunction((before) => desk.lines > before, frames, kPatience);
  });
  const other = live.url.replace(/[0-9a-f]{32}/, '0'.repeat(32)), context = await browser.newContext(), page = await context.newPage();
  assert.equal((await page.goto(other)).status(), 403);
  await context.close();
  await live.end();
});
