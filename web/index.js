// Palpable for pages and for Node: the C interface (palpable.h, hands.h) by its names. Units are SI, frames and the
// meaning of each number are those of palpable.h.

import { core, PalpableError, running } from './core.js';
export { PalpableError };

/** Starts the module. Only needed to say where palpable.wasm is, or to start it before a body is there. */
export async function load(source) { await core(source); }

/** "0.2.0"; like memoryBytes(), after load() or loadBody(). */
export const version = () => running().text(running().exports.palpable_version());

/** Bytes of the module's memory. It never shrinks. */
export const memoryBytes = () => running().memoryBytes;

// Reads a delivery file to where the module has it, piece by piece: in JavaScript there is no second copy.
async function fetchInto(c, response, onProgress) {
  if (!response.ok) throw new Error(`${response.url}: ${response.status} ${response.statusText}`);
  const stated = Number(response.headers.get('content-length')) || 0;
  let room = stated || 1 << 20, at = c.allocate(room), count = 0;
  try {
    const reader = response.body.getReader();
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return { at, count };
      if (count + value.length > room) { // no length, or that of compressed bytes
        const larger = Math.max(2 * room, count + value.length), to = c.allocate(larger);
        c.bytes(to, count).set(c.bytes(at, count));
        c.free(at);
        [at, room] = [to, larger];
      }
      c.bytes(at + count, value.length).set(value);
      count += value.length;
      onProgress?.(count, stated || undefined);
    }
  } catch (error) {
    c.free(at);
    throw error;
  }
}

function copyInto(c, source) {
  const bytes = ArrayBuffer.isView(source)
    ? new Uint8Array(source.buffer, source.byteOffset, source.byteLength) : new Uint8Array(source);
  const at = c.allocate(Math.max(1, bytes.length));
  c.bytes(at, bytes.length).set(bytes);
  return { at, count: bytes.length };
}

/** A body of a delivery file (palpable export BODY --to web -o FILE).
 * @param source   its bytes, a Response or the promise of one: loadBody(fetch('bunny.palpweb'))
 * @param options  scale: factor of every length; onProgress(bytes, all or undefined) */
export async function loadBody(source, { scale = 1, onProgress } = {}) {
  const [c, given] = [await core(), await source];
  const isResponse = typeof given?.arrayBuffer === 'function';
  const { at, count } = isResponse ? await fetchInto(c, given, onProgress) : copyInto(c, given);
  const out = c.allocate(4);
  try {
    c.call('palpable_read_body', at, count, scale, out);
    return new Body(c, c.view.getUint32(out, true));
  } finally {
    c.free(at);
    c.free(out);
  }
}

export class Body {
  #core;
  #handle;
  constructor(c, handle) { [this.#core, this.#handle] = [c, handle]; }

  get core() { return this.#core; }
  /** Of the module; 0 after free(). */
  get handle() { return this.#handle; }

  /** The pose in sessions that are opened later. @param worldFromBody  16 numbers, row by row */
  place(worldFromBody) {
    const c = this.#core;
    if (worldFromBody.length !== 16) throw new PalpableError(1, 'a pose has 16 numbers');
    const at = c.allocate(16 * 8);
    try {
      c.doubles(at, 16).set(worldFromBody);
      c.call('palpable_place_body', this.#handle, at);
    } finally {
      c.free(at);
    }
  }
  /** Sessions on it stay valid. */
  free() {
    this.#core.exports.palpable_free_body(this.#handle);
    this.#handle = 0;
  }
}

// A piece of the module's memory that grows on demand, so that a frame allocates nothing.
class Space {
  #core;
  #at = 0;
  #room = 0;
  constructor(c) { this.#core = c; }
  of(bytes) {
    if (bytes > this.#room) {
      this.free();
      this.#at = this.#core.allocate(2 * bytes);
      this.#room = 2 * bytes;
    }
    return this.#at;
  }
  free() {
    if (this.#at) this.#core.free(this.#at);
    this.#at = this.#room = 0;
  }
}

const kCapsuleNumbers = 8; // a b radius_a radius_b: a palpable_capsule has no gaps

const countOf = (capsules) => ArrayBuffer.isView(capsules) ? capsules.length / kCapsuleNumbers : capsules.length;

function writeCapsules(capsules, to) {
  if (ArrayBuffer.isView(capsules)) return void to.set(capsules);
  capsules.forEach(({ a, b, radiusA, radiusB }, k) => {
    to.set([...a, ...b, radiusA, radiusB ?? radiusA], kCapsuleNumbers * k);
  });
}

// palpable_thing::friction, where 0 is that of the body and -1 none. C refuses what is above 10.
function frictionOfC(given) {
  if (given === undefined || given === null) return 0;
  if (!(given >= 0)) throw new PalpableError(1, `friction is ${given}, not within 0 and 10`);
  return given === 0 ? -1 : given;
}

const kNoThing = -(2n ** 63n); // PALPABLE_NO_THING

function idOf(id) {
  if (id === kNoThing) return null;
  return Number.isSafeInteger(Number(id)) ? Number(id) : id;
}

const kAnswers = { PALPABLE_NOT_JUDGED: 'not judged', PALPABLE_REACHED: 'reached', PALPABLE_LATER: 'later',
                   PALPABLE_NOT_REACHED: 'not reached' };

export class Session {
  #core;
  #handle;
  #bodies;
  #number = 0; // of presses, by which skins know that they are old
  #things;
  #capsules;
  #frame;
  #touch;
  #skin;
  #answers = new Map();

  /** @param bodies  at least one, at the poses that they have now; several also press each other */
  constructor(...bodies) {
    bodies = bodies.flat();
    if (bodies.length === 0) throw new PalpableError(1, 'a session has a body');
    const c = this.#core = bodies[0].core;
    const handles = c.allocate(4 * bodies.length), setup = c.struct('palpable_setup'), out = c.allocate(4);
    try {
      bodies.forEach((body, k) => c.view.setUint32(handles + 4 * k, body.handle, true));
      c.call('palpable_open', handles, bodies.length, setup, out);
      this.#handle = c.view.getUint32(out, true);
    } finally {
      for (const at of [handles, setup, out]) c.free(at);
    }
    this.#bodies = bodies.length;
    [this.#things, this.#capsules] = [new Space(c), new Space(c)];
    [this.#frame, this.#touch, this.#skin] = ['frame', 'touch', 'skin'].map((name) => c.struct(`palpable_${name}`));
    for (const name in kAnswers) this.#answers.set(c.constants[name], kAnswers[name]);
  }

  /** One frame: the skins deform until they no longer penetrate the capsules.
   * @param things   [{ id, capsules, friction }]: ids that differ, and a Float64Array of 8 numbers for each capsule, as
   *                 handCapsules() returns it, or [{ a, b, radiusA, radiusB }]; world frame, m
   * @param seconds  larger than that of the call before
   * @returns this session */
  pressAt(things, seconds) {
    const c = this.#core, { size, members } = c.structs.palpable_thing;
    const counts = things.map((thing) => countOf(thing.capsules));
    if (!counts.every(Number.isInteger)) throw new PalpableError(1, 'a capsule has 8 numbers');
    const all = counts.reduce((sum, count) => sum + count, 0);
    const list = this.#things.of(Math.max(1, size * things.length));
    let at = this.#capsules.of(Math.max(1, 8 * kCapsuleNumbers * all));
    const view = c.view;
    things.forEach((thing, k) => {
      const to = list + size * k;
      view.setUint32(to + members.size, size, true);
      view.setBigInt64(to + members.id, BigInt(thing.id ?? k), true);
      view.setUint32(to + members.capsules, at, true);
      view.setUint32(to + members.count, counts[k], true);
      view.setFloat64(to + members.friction, frictionOfC(thing.friction), true);
      writeCapsules(thing.capsules, c.doubles(at, kCapsuleNumbers * counts[k]));
      at += 8 * kCapsuleNumbers * counts[k];
    });
    ++this.#number;
    c.call('palpable_press_at', this.#handle, list, things.length, seconds);
    return this;
  }

  /** How far the last call came: palpable_frame. */
  get frame() {
    const c = this.#core, m = c.structs.palpable_frame.members, at = this.#frame;
    c.call('palpable_get_frame', this.#handle, at);
    const v = c.view;
    return {
      time: v.getFloat64(at + m.time, true),
      bodyCount: v.getInt32(at + m.body_count, true),
      touchCount: v.getInt32(at + m.touch_count, true),
      leftToGo: v.getFloat64(at + m.left_to_go, true),
      inside: v.getFloat64(at + m.inside, true),
      answer: this.#answers.get(v.getInt32(at + m.answer, true)),
      passedThrough: v.getInt32(at + m.passed_through, true),
      ringing: v.getFloat64(at + m.ringing, true),
    };
  }

  /** Of all bodies, the strongest first; copies. */
  get touches() {
    const c = this.#core, m = c.structs.palpable_touch.members, at = this.#touch, touches = [];
    const three = (member) => Array.from(c.doubles(at + member, 3));
    for (let k = 0, count = this.frame.touchCount; k < count; ++k) {
      c.call('palpable_get_touch', this.#handle, k, at);
      const v = c.view;
      touches.push({
        body: v.getInt32(at + m.body, true),
        by: v.getInt32(at + m.by, true),
        point: three(m.point),
        normal: three(m.normal),
        force: three(m.force),
        depth: v.getFloat64(at + m.depth, true),
        area: v.getFloat64(at + m.area, true),
        thing: idOf(v.getBigInt64(at + m.thing, true)),
      });
    }
    return touches;
  }

  /** The skin of a body after the last call. Its arrays are views of the module's memory, not copies: they may be
   * passed to WebGL as they are, and hold until the next pressAt(), reset(), close() or loadBody(). */
  skin(body = 0) {
    const c = this.#core;
    c.call('palpable_get_skin', this.#handle, body, this.#skin);
    return new Skin(c, this.#skin, () => this.#number);
  }
  /** Pa, von Mises, one for each vertex: skin(body).stress. */
  stress(body = 0) { return this.skin(body).stress; }

  get bodyCount() { return this.#bodies; }
  reset() {
    ++this.#number;
    this.#core.call('palpable_reset', this.#handle);
  }
  close() {
    if (!this.#handle) return;
    const c = this.#core;
    ++this.#number;
    c.exports.palpable_close(this.#handle);
    this.#handle = 0;
    for (const at of [this.#frame, this.#touch, this.#skin]) c.free(at);
    this.#things.free();
    this.#capsules.free();
  }
}

export class Skin {
  #core;
  #at;
  #number;
  #now;
  #floats = {};

  constructor(c, struct, now) {
    const m = c.structs.palpable_skin.members, v = c.view;
    this.#core = c;
    this.#now = now;
    this.#number = now();
    this.vertexCount = v.getInt32(struct + m.vertex_count, true);
    this.triangleCount = v.getInt32(struct + m.triangle_count, true);
    this.worldFromBody = Float64Array.from(c.doubles(struct + m.world_from_body, 16));
    this.statedDisplacementError = v.getFloat64(struct + m.stated_displacement_error, true);
    this.statedStressError = v.getFloat64(struct + m.stated_stress_error, true);
    this.#at = Object.fromEntries(['vertices', 'normals', 'von_mises', 'triangles', 'contact_pressure']
      .map((name) => [name, v.getUint32(struct + m[name], true)]));
  }

  #view(name, count) {
    if (this.#number !== this.#now()) throw new Error('this skin is of an earlier frame: call session.skin() again');
    const kept = this.#floats[name];
    if (kept && kept.buffer === this.#core.memory.buffer) return kept;
    const view = name === 'triangles' ? this.#core.ints(this.#at[name], count)
                                      : this.#core.floats(this.#at[name], count);
    return this.#floats[name] = view;
  }
  /** x0 y0 z0 x1 ..., m, body frame, deformed. */
  get vertices() { return this.#view('vertices', 3 * this.vertexCount); }
  get normals() { return this.#view('normals', 3 * this.vertexCount); }
  /** Pa, von Mises, one for each vertex. */
  get stress() { return this.#view('von_mises', this.vertexCount); }
  /** Pa, one for each vertex; null before the first frame. */
  get contactPressure() {
    return this.#at.contact_pressure ? this.#view('contact_pressure', this.vertexCount) : null;
  }
  /** Three vertices for each triangle, counterclockwise from outside. They never change. */
  get triangles() { return this.#view('triangles', 3 * this.triangleCount); }
}

const kLayouts = { openxr: 'PALPABLE_OPENXR_HAND', webxr: 'PALPABLE_WEBXR_HAND', mediapipe: 'PALPABLE_MEDIAPIPE_HAND' };
const kSides = { left: 'PALPABLE_LEFT', right: 'PALPABLE_RIGHT' };

let joints, radii, made;

/** The capsules around a tracked hand, for pressAt(). The module must have started: load() or loadBody().
 * @param layout       'openxr', 'webxr' or 'mediapipe'
 * @param side         'left' or 'right'
 * @param places       of the joints, x0 y0 z0 x1 ..., m, world frame
 * @param jointRadii   m, of each joint; left out: not known
 * @returns a new Float64Array */
export function handCapsules(layout, side, places, jointRadii) {
  const c = running(), count = c.joints[kLayouts[layout]], capsules = c.constants.PALPABLE_HAND_CAPSULES;
  if (!count || !kSides[side]) throw new PalpableError(1, `no such hand: ${layout}, ${side}`);
  if (places.length !== 3 * count || (jointRadii && jointRadii.length !== count)) {
    throw new PalpableError(1, `${layout} has ${count} joints`);
  }
  [joints, radii, made] = [joints, radii, made].map((space) => space ?? new Space(c));
  const from = joints.of(24 * count), r = radii.of(8 * count), to = made.of(8 * kCapsuleNumbers * capsules);
  c.doubles(from, 3 * count).set(places);
  if (jointRadii) c.doubles(r, count).set(jointRadii);
  c.call('palpable_hand_capsules', c.constants[kLayouts[layout]], c.constants[kSides[side]], from,
         jointRadii ? r : 0, to);
  return c.doubles(to, kCapsuleNumbers * capsules).slice();
}
