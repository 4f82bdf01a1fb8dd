// Presses the page in headless Chromium, and compares force and largest stress with those of the same capsules in Node:
// node --test web/page/test.mjs. web/test.mjs compares Node with the C library, byte by byte.
//
//   PALPABLE         the program, which writes the pages; left out: build/release/bin/palpable
//   PALPABLE_BODY    a body file; left out: tests/data/touched_ball_v1.palpable
//   PALPABLE_SHOTS   a folder for pictures of each test, in full size; left out: none, and coarser pixels, of which
//                    software draws more in a second
import assert from 'node:assert/strict';
import { mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { loadBody, Session } from '../index.js';
import { chromiumPath, launch, root, serve, writePage } from './browser.mjs';

const given = process.env.PALPABLE_BODY ?? join(root, 'tests/data/touched_ball_v1.palpable');
const shots = process.env.PALPABLE_SHOTS;
const kDesktop = { viewport: { width: 1280, height: 800 }, deviceScaleFactor: shots ? 1 : 0.4 };
const kPhone = { viewport: { width: 390, height: 844 }, deviceScaleFactor: shots ? 2 : 0.6, hasTouch: true, isMobile: true };
const skip = chromiumPath() ? false : 'there is no Chromium: apt-get install chromium, or set PALPABLE_CHROMIUM';

let folder, file, browser, server;
before(async () => {
  if (skip) return;
  folder = mkdtempSync(join(tmpdir(), 'palpable-page-'));
  writePage(join(folder, 'served'), [given], 'never');
  writePage(join(folder, 'inline'), [given, given], 'always');
  file = join(folder, 'served', readdirSync(join(folder, 'served')).find((name) => name.endsWith('.palpweb')));
  server = await serve(join(folder, 'served'));
  browser = await launch();
});
after(async () => {
  await browser?.close();
  server?.close();
  if (folder) rmSync(folder, { recursive: true, force: true });
});

/** Opens the page, does something, and sees that nothing was complained about. */
async function visit(kind, doWith, url = server.url) {
  const context = await browser.newContext(kind), page = await context.newPage(), complaints = [];
  page.on('console', (message) => { if (message.type() === 'error') complaints.push(message.text()); });
  page.on('pageerror', (error) => complaints.push(error.message));
  try {
    await page.goto(url);
    await page.evaluate(async () => {
      const shown = await palpablePage;
      globalThis.shown = shown;
      globalThis.calls = [];
      shown.body.onPress = (things, seconds) =>
        calls.push([seconds, things.map(({ id, capsules }) => ({ id, capsules: [...capsules] }))]);
    });
    await doWith(page);
    assert.deepEqual(complaints, []);
  } finally {
    await context.close();
  }
}

async function shoot(page, name) {
  if (!shots) return;
  mkdirSync(shots, { recursive: true });
  await page.screenshot({ path: join(shots, `${name}.png`) });
}

/** Pixels of `count` points of the skin that face the visitor, far from each other: [[x, y], ...]. */
const facing = (page, count) => page.evaluate((wanted) => {
  const { body, sides } = shown, { vertices, normals } = body.skin, found = [], points = [];
  const floor = body.shape.target[2] - 0.2 * body.shape.height;
  for (let v = 0; v < vertices.length; v += 3) {
    const p = [...vertices.subarray(v, v + 3)], toEye = sides.eye.map((x, k) => x - p[k]), far = Math.hypot(...toEye);
    const facing = toEye.reduce((sum, x, k) => sum + x * normals[v + k], 0) / far;
    const seen = facing > 0.6 && p[2] > floor && body.placeAt(sides.eye, toEye.map((x) => -x / far));
    if (seen && Math.hypot(...seen.point.map((x, k) => x - p[k])) < 1e-3) points.push(shown.pixelOf(p));
  }
  const apart = (p) => Math.min(...found.map((q) => Math.hypot(p[0] - q[0], p[1] - q[1])), 1e9);
  while (found.length < wanted && points.length > 0) {
    points.sort((p, q) => apart(q) - apart(p));
    found.push(points.shift());
  }
  return found;
}, count);

const reading = (page) => page.evaluate(() => shown.body.reading());
const kPatience = { timeout: 60000 }; // a machine of CI draws a few frames a second
/** Until `count` fingers are as deep as they get. */
const untilDeep = (page, count = 1) => page.waitForFunction((wanted) => {
  const fingers = shown.body.shown, deepest = Math.min(0.01, 0.1 * shown.body.shape.height);
  return fingers.length === wanted && fingers.every(({ push }) => push >= 0.99 * deepest);
}, count, kPatience);
const untilRest = (page) => page.waitForFunction(() => shown.body.shown.length === 0 && !shown.body.moves, null, kPatience);

/** The same calls in Node: force and largest stress as the page shows them. */
async function again(calls) {
  const body = await loadBody(readFileSync(file)), session = new Session(body);
  session.pressAt([], 1); // as the page does before it shows the body
  for (const [seconds, things] of calls) {
    session.pressAt(things.map(({ id, capsules }) => ({ id, capsules: Float64Array.from(capsules) })), seconds);
  }
  const sums = new Map();
  for (const { thing, force } of session.touches) {
    sums.set(thing, (sums.get(thing) ?? [0, 0, 0]).map((x, k) => x + force[k]));
  }
  const force = [...sums.values()].reduce((sum, f) => sum + Math.hypot(...f), 0), stress = Math.max(...session.stress());
  session.close();
  body.free();
  return { force, stress, fingers: sums.size };
}

// The page goes on while it is asked: what it shows and what it did are read in one go.
const snapshot = (page) => page.evaluate(() => {
  return { shown: shown.body.reading(), calls: structuredClone(calls), newtons: document.getElementById('newtons').textContent };
});
async function compare(page, fingers) {
  const { shown, calls, newtons } = await snapshot(page), expected = await again(calls);
  assert.equal(expected.fingers, fingers);
  assert.ok(expected.force > 0.01, `${expected.force} N`);
  assert.equal(shown.force, expected.force);
  assert.equal(shown.stress, expected.stress);
  assert.equal(newtons, expected.force.toFixed(2));
}

test('a mouse presses at three points as the core does in Node', { skip }, async () => {
  await visit(kDesktop, async (page) => {
    await shoot(page, 'desktop');
    for (const [x, y] of await facing(page, 3)) {
      await page.mouse.move(x, y);
      await page.mouse.down();
      await untilDeep(page);
      await compare(page, 1);
      await page.mouse.up();
      await untilRest(page);
      assert.equal((await reading(page)).force, 0);
    }
  });
});

test('a press begins at the skin, and deepens from there', { skip }, async () => {
  await visit(kDesktop, async (page) => {
    const [[x, y]] = await facing(page, 1);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await untilDeep(page);
    const pushes = await page.evaluate(() => {
      const [first] = shown.body.shown;
      const along = (capsules) => [0, 1, 2].reduce((sum, k) => sum + capsules[k] * first.inwards[k], 0);
      const all = calls.map(([, [thing]]) => along(thing.capsules)), last = all.at(-1);
      return all.map((way) => first.push - (last - way)); // m, of the tip from where it began
    });
    assert.ok(pushes[0] < 0.0025, `it begins ${1000 * pushes[0]} mm in the skin`);
    for (let k = 1; k < pushes.length; ++k) {
      assert.ok(pushes[k] >= pushes[k - 1] - 1e-12 && pushes[k] - pushes[k - 1] < 0.0026, `step ${k}: ${pushes[k]}`);
    }
    await page.mouse.up();
    await untilRest(page);
  });
});

test('a drag beside the body turns the room and presses nothing', { skip }, async () => {
  await visit(kDesktop, async (page) => {
    const before = await page.evaluate(() => shown.sides.eye);
    await page.mouse.move(300, 600);
    await page.mouse.down();
    await page.mouse.move(380, 600, { steps: 4 });
    await page.mouse.up();
    await page.mouse.wheel(0, -200);
    await page.waitForTimeout(300);
    const [eye, calls] = await page.evaluate(() => [shown.sides.eye, globalThis.calls.length]);
    assert.ok(Math.hypot(...eye.map((x, k) => x - before[k])) > 0.02);
    assert.equal(calls, 0);
  });
});

test('two fingers on glass press at once', { skip }, async () => {
  await visit(kPhone, async (page) => {
    await shoot(page, 'phone');
    const [one, , two] = await facing(page, 3), touch = await page.context().newCDPSession(page);
    const points = [one, two].map(([x, y], id) => ({ x, y, id }));
    await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: [points[0]] });
    await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: points });
    await untilDeep(page, 2);
    await compare(page, 2);
    await shoot(page, 'phone-two-fingers');
    await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await untilRest(page);
  });
});

test('two fingers beside the body come closer', { skip }, async () => {
  await visit(kPhone, async (page) => {
    const touch = await page.context().newCDPSession(page);
    const distance = () => page.evaluate(() => {
      const { sides, body } = shown;
      return Math.hypot(...sides.eye.map((x, k) => x - body.shape.target[k]));
    });
    const before = await distance();
    for (const [type, half] of [['touchStart', 30], ['touchMove', 60], ['touchMove', 90]]) {
      await touch.send('Input.dispatchTouchEvent', { type, touchPoints: [-1, 1].map((side, id) => ({ x: 195 + side * half, y: 640, id })) });
    }
    await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
    await page.waitForTimeout(300);
    assert.ok(await distance() < 0.6 * before);
    assert.equal(await page.evaluate(() => calls.length), 0);
  });
});

test('the keyboard alone presses, and its numbers are spoken', { skip }, async () => {
  await visit({ ...kDesktop, reducedMotion: 'reduce', colorScheme: 'dark' }, async (page) => {
    await page.keyboard.press('Tab');
    assert.equal(await page.evaluate(() => document.activeElement.id), 'view');
    for (const key of ['ArrowUp', 'ArrowUp', 'ArrowLeft']) await page.keyboard.press(key);
    await page.keyboard.down('Space');
    await untilDeep(page);
    await compare(page, 1);
    await shoot(page, 'keyboard-dark');
    await page.waitForFunction(() => document.getElementById('spoken').textContent.startsWith('Pressed'), null, kPatience);
    const { spoken, push } = await page.evaluate(() => (
      { spoken: document.getElementById('spoken').textContent, push: 1000 * shown.body.reading().push }));
    // Whole millimetres of a push that may have grown by 0.1 since it was spoken.
    assert.ok(Math.abs(Number(spoken.match(/Pressed (\d+)/)[1]) - push) <= 0.5 + 0.1 + 1e-6, `${spoken}, now ${push} mm`);
    await page.keyboard.up('Space');
    await untilRest(page);
    assert.match(await page.textContent('#spoken'), /^Pressed \d+ millimetres: [\d.]+ newtons, largest stress [\d.]+ kilopascals/);
    await page.keyboard.press('r');
    assert.match(await page.textContent('#spoken'), /At rest/);
    // A closed dialog gives the keys back to the body, in an event of its own after the key's.
    await page.click('#how');
    await page.keyboard.press('Escape');
    await page.waitForFunction(() => document.activeElement.id === 'view', null, kPatience);
  });
});

test('the page of a disk holds everything, with several bodies to choose from', { skip }, async () => {
  await visit(kDesktop, async (page) => {
    const list = page.getByRole('combobox', { name: 'Body' });
    await list.selectOption({ index: 1 });
    await page.waitForFunction(() => !document.getElementById('bodies').disabled);
    await page.getByRole('button', { name: 'How it works' }).click();
    assert.equal(await page.locator('#explained li').count(), 10);
    await shoot(page, 'how-it-works');
    await page.keyboard.press('Escape');
    await page.locator('#explained').waitFor({ state: 'hidden' });
  }, `file://${join(folder, 'inline')}/index.html`);
});

/** The share of a picture's pixels that are yellowish, as rubber is and the room is not. */
const rubberIn = (page, png) => page.evaluate(async (base64) => {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const picture = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
  const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, 0, picture.width, picture.height);
  let count = 0;
  for (let k = 0; k < data.length; k += 4) count += data[k] - data[k + 2] > 22;
  return count / (data.length / 4);
}, png.toString('base64'));

test('the body is shown at rest while its tables arrive', { skip }, async () => {
  const context = await browser.newContext(kDesktop), page = await context.newPage();
  let release;
  const held = new Promise((done) => { release = done; });
  await page.route('**/*.palpweb', async (route) => { await held; await route.continue(); });
  try {
    await page.goto(server.url);
    await page.waitForFunction(() => performance.getEntriesByName('palpable: first picture').length > 0, null, kPatience);
    assert.equal(await page.locator('#loading').isVisible(), true);
    const early = await rubberIn(page, await page.screenshot());
    assert.equal(await page.evaluate(() => performance.getEntriesByName('palpable: ready').length), 0);
    release();
    await page.evaluate(() => palpablePage.then(() => null));
    const late = await rubberIn(page, await page.screenshot());
    assert.ok(late > 0.02 && early > 0.5 * late, `${early} and then ${late} of the picture is rubber`);
  } finally {
    release();
    await context.close();
  }
});

test('the smallest page has 5 MB at most', { skip }, () => {
  const alone = join(folder, 'alone');
  writePage(alone, [given], 'always');
  const { size } = statSync(join(alone, 'index.html'));
  if (!process.env.PALPABLE_BODY || readFileSync(file).length < 2e6) assert.ok(size <= 5e6, `${size} bytes`);
});
