/** Palpable for pages and for Node. Units are SI; frames and the meaning of each number are those of palpable.h. */

/** A call that the library refused: what was wrong, in one line. */
export class PalpableError extends Error {
  /** A palpable_status of palpable.h. */
  readonly status: number;
  constructor(status: number, message: string);
}

/** Starts the module. Needed before handCapsules() without a body, and to say where palpable.wasm is.
 * @param source  URL or bytes of palpable.wasm; left out: beside this file */
export function load(source?: string | URL | BufferSource): Promise<void>;
/** Of the library: "0.2.0". */
export function version(): string;
/** Bytes of the module's memory. It never shrinks. */
export function memoryBytes(): number;

export interface LoadOptions {
  /** Factor of every length, 0.001 to 1000. */
  scale?: number;
  /** While a Response is read. `all` is undefined where the server does not state the length; of a compressed answer
   * it may be smaller than `bytes`. */
  onProgress?: (bytes: number, all: number | undefined) => void;
}

/** A body from a delivery file (palpable export BODY --to web -o FILE).
 * @param source  its bytes, or an answer of fetch(), which is not copied a second time in JavaScript
 * @throws PalpableError for a damaged file */
export function loadBody(source: BufferSource | Response | Promise<BufferSource | Response>,
                         options?: LoadOptions): Promise<Body>;

export class Body {
  private constructor();
  /** Sets the pose in sessions that are opened later: rotation and translation, row by row, the last row 0 0 0 1. */
  place(worldFromBody: ArrayLike<number>): void;
  /** Frees the memory. Sessions that were opened on the body stay valid. */
  free(): void;
}

/** The balls with centres from a to b, whose radius changes from radiusA to radiusB. World frame, m. */
export interface Capsule {
  a: readonly [number, number, number];
  b: readonly [number, number, number];
  radiusA: number;
  /** radiusA if left out. */
  radiusB?: number;
}

/** Capsules that belong together, such as those of a hand. */
export interface Thing {
  /** The same from call to call, another one for each other thing; its place in the list if left out. */
  id?: number | bigint;
  /** Either objects or, without garbage, 8 numbers for each: a, b, radii. */
  capsules: readonly Capsule[] | Float64Array;
  /** Coulomb's coefficient between it and the skins, 0 to 10; none if left out: that of the body, which has none in
   * delivery files. */
  friction?: number;
}

export type Answer = 'not judged' | 'reached' | 'later' | 'not reached';

/** palpable_frame. */
export interface Frame {
  /** s, of the last call; NaN before the first. */
  time: number;
  bodyCount: number;
  touchCount: number;
  /** m, the way that the skins have yet to move. */
  leftToGo: number;
  /** m, how deep capsules still are inside the skins. */
  inside: number;
  /** Whether the skins give way to everything that presses. */
  answer: Answer;
  passedThrough: number;
  /** J, energy of the bodies' motion around their static states. */
  ringing: number;
}

/** palpable_touch: one contact patch; vectors in the body frame. */
export interface Touch {
  body: number;
  /** The body that presses; -1: capsules. */
  by: number;
  /** m, on the deformed skin. */
  point: [number, number, number];
  normal: [number, number, number];
  /** N, on the body. */
  force: [number, number, number];
  /** m */
  depth: number;
  /** m^2; 0: unknown. */
  area: number;
  /** Thing.id of what presses; null: a body. Ids beyond 2^53 are bigints. */
  thing: number | bigint | null;
}

/** Bodies, what presses them, and the state from call to call. */
export class Session {
  /** At the poses that the bodies have now. Several bodies press each other, too. */
  constructor(...bodies: (Body | readonly Body[])[]);
  /** One frame: the skins deform until they no longer penetrate the capsules. From call to call a capsule should
   * advance by less than its radius.
   * @param seconds  larger than that of the previous call
   * @throws PalpableError  nothing was changed */
  pressAt(things: readonly Thing[], seconds: number): this;
  readonly frame: Frame;
  /** Of all bodies, the strongest first. Copies. */
  readonly touches: Touch[];
  skin(body?: number): Skin;
  /** Pa, von Mises: skin(body).stress. */
  stress(body?: number): Float32Array;
  readonly bodyCount: number;
  /** Discards all frames. */
  reset(): void;
  /** Frees the memory. */
  close(): void;
}

/** A body's skin after a call. The arrays are views of the module's memory, without a copy.
 *
 * They hold until the session's next pressAt(), reset() or close(): then the getters of an old Skin throw. An array
 * that was taken out of it before is not watched: it shows what lies there, or becomes empty (length 0) when the
 * module's memory grows, which loading a body, opening a session and the first calls may cause. Take skin() in each
 * frame, and slice() what is to be kept. */
export class Skin {
  private constructor();
  readonly vertexCount: number;
  readonly triangleCount: number;
  /** x0 y0 z0 x1 ..., m, body frame, deformed. */
  readonly vertices: Float32Array;
  /** Unit, outwards. */
  readonly normals: Float32Array;
  /** Pa, von Mises stress of each vertex; 0 before the first call. */
  readonly stress: Float32Array;
  /** Pa, of each vertex; null before the first call. */
  readonly contactPressure: Float32Array | null;
  /** Three vertices for each triangle, counterclockwise from outside. They never change. */
  readonly triangles: Int32Array;
  readonly worldFromBody: Float64Array;
  /** Relative; NaN: unknown, or nothing touches. */
  readonly statedDisplacementError: number;
  readonly statedStressError: number;
}

/** The capsules around a tracked hand, for Thing.capsules: hands.h. The module must have started.
 * @param places  of the joints: x0 y0 z0 x1 ..., m, world frame: 26, 25 or 21 of them
 * @param jointRadii  m, of each joint; left out: not known */
export function handCapsules(layout: 'openxr' | 'webxr' | 'mediapipe', side: 'left' | 'right',
                             places: ArrayLike<number>, jointRadii?: ArrayLike<number>): Float64Array;
