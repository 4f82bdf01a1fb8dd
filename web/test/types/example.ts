// Uses all that index.d.ts declares; web/test/types.mjs has tsc compile it. It is not run.
import {
  type Answer, type Body, type Capsule, type Frame, handCapsules, load, loadBody, type LoadOptions, memoryBytes,
  PalpableError, Session, type Skin, type Thing, type Touch, version,
} from '../../index.js';

/** Loads a body from a server and from bytes. */
async function bodies(bytes: ArrayBuffer, bar: (share: number) => void): Promise<[Body, Body]> {
  await load();
  await load(new URL('https://example.org/palpable.wasm'));
  const options: LoadOptions = { scale: 0.5, onProgress: (read, all) => bar(all === undefined ? 0 : read / all) };
  const fetched = await loadBody(fetch('bunny.palpweb'), options);
  const small = await loadBody(new Uint8Array(bytes), { scale: 0.1 });
  small.place([1, 0, 0, 0.2, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
  return [fetched, small];
}

/** What presses in a frame: a hand, and a ball. */
function things(joints: Float32Array, radii: Float32Array): Thing[] {
  const hand: Float64Array = handCapsules('webxr', 'right', joints, radii);
  const ball: Capsule = { a: [0, 0, 0.2], b: [0, 0, 0.2], radiusA: 0.01, radiusB: 0.02 };
  return [{ id: 1, capsules: hand }, { id: 2n, capsules: [ball, { a: ball.a, b: ball.b, radiusA: 0.01 }], friction: 0.5 },
          { capsules: handCapsules('mediapipe', 'left', [...joints]) }];
}

function textOf(touch: Touch): string {
  const { body, by, thing, point, normal, force, depth, area } = touch;
  const who: number | bigint | null = thing;
  return `${body} ${by} ${who} ${[...point, ...normal, ...force].map((x) => x.toFixed(3)).join(' ')} ${depth + area}`;
}

function numbersOf(frame: Frame): number {
  const answer: Answer = frame.answer;
  return answer === 'reached' ? frame.time : frame.ringing + frame.leftToGo + frame.inside + frame.passedThrough + frame.bodyCount + frame.touchCount;
}

function draw(skin: Skin, put: (name: string, array: Float32Array | Int32Array) => void): void {
  put('vertices', skin.vertices);
  put('normals', skin.normals);
  put('stress', skin.stress);
  put('triangles', skin.triangles);
  if (skin.contactPressure) put('pressure', skin.contactPressure);
  const pose: Float64Array = skin.worldFromBody;
  const counts: number = skin.vertexCount + skin.triangleCount + pose.length;
  if (skin.statedDisplacementError > 0.1 || skin.statedStressError > 0.1 || counts === 0) put('doubtful', new Float32Array(1));
}

/** A session of two bodies, from its beginning to its end. */
export async function pressed(bytes: ArrayBuffer, joints: Float32Array, radii: Float32Array): Promise<string> {
  const [first, second] = await bodies(bytes, console.log), session = new Session(first, second);
  const alone = new Session([first]);
  try {
    const { frame, touches } = session.pressAt(things(joints, radii), 0.1).pressAt([], 0.2);
    for (let k = 0; k < session.bodyCount; ++k) draw(session.skin(k), () => {});
    draw(alone.skin(), () => {});
    const largest = Math.max(...session.stress(), ...session.stress(1));
    session.reset();
    return [version(), memoryBytes(), numbersOf(frame), largest, ...touches.map(textOf)].join('\n');
  } catch (error) {
    if (error instanceof PalpableError) return `${error.status}: ${error.message}`;
    throw error;
  } finally {
    for (const each of [session, alone]) each.close();
    for (const body of [first, second]) body.free();
  }
}

/** What the types refuse: tsc complains of a line that it should refuse and does not. */
export function refused(session: Session, body: Body): void {
  // @ts-expect-error: a time is a number
  session.pressAt([], 'now');
  // @ts-expect-error: a capsule has a radius
  session.pressAt([{ capsules: [{ a: [0, 0, 0], b: [0, 0, 1] }] }], 1);
  // @ts-expect-error: a point has three numbers
  session.pressAt([{ capsules: [{ a: [0, 0], b: [0, 0, 1], radiusA: 1 }] }], 1);
  // @ts-expect-error: no such layout
  handCapsules('leap', 'left', []);
  // @ts-expect-error: bodies come from loadBody()
  new (body.constructor as typeof Body)();
  // @ts-expect-error: pressure is missing before the first call
  session.skin().contactPressure.length;
  // @ts-expect-error: results are not written
  session.skin().vertices = new Float32Array(3);
}
