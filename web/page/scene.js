// The picture: a body in a room, and the fingers on it. Metres, Z up.
import * as three from 'three';
import { CurvedSkin } from './curved_skin.js';
import { HandMask } from './hand_mask.js';
import { bodyMaterial, fingerMaterial, sheetMaterial } from './materials.js';
import { Room } from './room.js';
import { kView } from './orbit.js';
import { kRadius } from './fingers.js';

const kArrow = 0.22;   // of the body's radius, length of a small force's arrow; at most three times as long
const kSheet = 0.035;  // m, half the side of the sheet around a fingertip
const kPlainPixels = 0.5; // the same, drawn less finely
const kMostPixels = 2; // a screen with more for each unit of CSS is drawn with this many

export class Scene {
  #renderer;
  #scene = new three.Scene();
  #camera = new three.PerspectiveCamera(kView * 180 / Math.PI);
  #room = new Room();
  #body = new three.Mesh(new three.BufferGeometry());
  #curved;
  #fingers = [];
  #marker;
  #ray = new three.Raycaster();

  /** @param {HTMLCanvasElement} canvas  @throws Error where the browser has no WebGL */
  constructor(canvas) {
    this.#renderer = new three.WebGLRenderer({ canvas, antialias: true, alpha: true }); // a camera's picture may lie behind
    this.#renderer.shadowMap.enabled = true;
    this.#renderer.shadowMap.type = three.PCFShadowMap;
    this.#renderer.shadowMap.autoUpdate = false;
    this.#body.castShadow = this.#body.receiveShadow = true;
    this.#body.frustumCulled = false;
    this.#marker = new three.Mesh(new three.TorusGeometry(kRadius, kRadius / 9, 10, 40),
                                  new three.MeshBasicMaterial({ color: 0xd8480a }));
    this.#marker.visible = false;
    this.#scene.add(...this.#room.parts, this.#body, this.#marker, this.#mask.mesh);
  }
  #mask = new HandMask();
  #tips = [];

  /** Draws less finely, for machines whose graphics are slow beside a webcam: no shadows, the core's own triangles, fewer pixels.
   *  @param {boolean} is, @param body  that is shown */
  setPlain(is, body) {
    if (this.#plain === is) return;
    this.#plain = is;
    this.#renderer.shadowMap.enabled = !is;
    this.show(body);
    if (this.#frame) this.resize(this.#frame);
  }
  get isPlain() { return this.#plain; }
  #plain = false;

  /** Whether the room is the camera's picture, which lies behind the canvas. @param {boolean} is */
  set overPicture(is) {
    this.#room.show(this.#scene, !is);
    if (!is) this.showHands([], []);
  }

  /** Hands of the camera's picture. @param {Float64Array[]} capsules  of each, which hide the body
   *  @param {{at: number[], depth: number, touches: boolean}[]} tips  m: the fingertip, and the depth of its plane */
  showHands(capsules, tips) {
    this.#mask.show(capsules);
    const planes = this.#body.material.userData.planes?.value;
    planes?.set(tips[0]?.depth ?? -1, tips[1]?.depth ?? -1);
    while (this.#tips.length < tips.length) {
      const sheet = new three.Mesh(new three.PlaneGeometry(2 * kSheet, 2 * kSheet), sheetMaterial(kSheet));
      sheet.renderOrder = 3;
      this.#tips.push(sheet);
      this.#scene.add(sheet);
    }
    this.#tips.forEach((sheet, k) => {
      sheet.visible = tips[k] !== undefined;
      if (!sheet.visible) return;
      sheet.position.set(...tips[k].at);
      sheet.quaternion.copy(this.#camera.quaternion);
      sheet.material.uniforms.touches.value = tips[k].touches ? 1 : 0;
    });
  }

  /** @param {boolean} dark  the colours of the room */
  set dark(dark) { this.#room.paint(this.#scene, this.#renderer, dark); }

  /** @param {import('./pressed_body.js').PressedBody} body */
  show(body) {
    const skin = body.skin, curved = this.#curved = new CurvedSkin(skin.triangles, this.#plain);
    const geometry = new three.BufferGeometry();
    geometry.setIndex(new three.BufferAttribute(curved.indices, 1));
    for (const [name, array, size] of [['position', curved.vertices, 3], ['normal', curved.normals, 3],
                                       ['stress', curved.stress, 1]]) {
      geometry.setAttribute(name, new three.BufferAttribute(array, size).setUsage(three.DynamicDrawUsage));
    }
    this.#body.geometry.dispose();
    this.#body.geometry = geometry;
    this.#body.material.dispose();
    this.#body.material = bodyMaterial(body.facts.stressTop);
    this.#room.fit(body.shape);
    this.#radius = body.shape.radius;
    this.update(body);
  }

  /** Takes shape, stress and fingers of the body's last frame. */
  update(body) {
    this.#curved.update(body.skin);
    for (const attribute of Object.values(this.#body.geometry.attributes)) attribute.needsUpdate = true;
    while (this.#fingers.length < body.shown.length) this.#addFinger();
    this.#fingers.forEach((finger, k) => {
      const shown = body.shown[k];
      finger.visible = shown !== undefined;
      if (shown) lay(finger, shown.tip, shown.inwards);
    });
    this.#renderer.shadowMap.needsUpdate = true;
  }
  #addFinger() {
    const length = 5 * kRadius;
    const shape = new three.CapsuleGeometry(kRadius, length, 12, 24).translate(0, -kRadius - length / 2, 0);
    const finger = new three.Mesh(shape, fingerMaterial(length));
    finger.renderOrder = 1; // it is translucent: after the body
    this.#fingers.push(finger);
    this.#scene.add(finger);
  }

  /** Shows forces as arrows that end where they press. @param {{point: number[], force: number[]}[]} forces  m, N */
  showForces(forces) {
    while (this.#arrows.length < forces.length) {
      const arrow = arrowOfOne();
      this.#arrows.push(arrow);
      this.#scene.add(arrow);
    }
    this.#arrows.forEach((arrow, k) => {
      const size = forces[k] ? Math.hypot(...forces[k].force) : 0;
      arrow.visible = size > 0;
      if (!arrow.visible) return;
      const along = forces[k].force.map((x) => x / size), length = kArrow * this.#radius * (1 + 2 * size / (size + 1));
      lay(arrow, forces[k].point, along);
      arrow.scale.setScalar(length);
    });
  }
  #arrows = [];
  #radius = 0.1; // m, of the body

  /** Shows where a press by keyboard would begin. @param {import('./pick.js').Place | null} place */
  mark(place) {
    this.#marker.visible = place !== null;
    if (place) lay(this.#marker, place.point.map((x, k) => x - 0.0006 * place.inwards[k]), place.inwards, 'z');
  }

  /** @param {{width: number, height: number, left: number, top: number, right: number, bottom: number}} frame
   *    px of CSS: of the picture, and the strips at its edges that words cover */
  resize(frame) {
    this.#renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio ?? 1, this.#plain ? kPlainPixels : kMostPixels));
    this.#renderer.setSize(frame.width, frame.height, false);
    this.#frame = frame;
  }
  #frame;

  /** @param {import('./orbit.js').Orbit} orbit */
  draw(orbit) {
    this.place(orbit);
    this.#renderer.render(this.#scene, this.#camera);
  }

  /** The camera's pose alone. */
  place(orbit) {
    const { width, height, left, top, right, bottom } = this.#frame;
    const free = { width: Math.max(width - left - right, 1), height: Math.max(height - top - bottom, 1) };
    // The view of the free part alone would have the angle kView; the picture's is wider by its strips.
    this.#camera.fov = 2 * Math.atan(Math.tan(kView / 2) * height / free.height) * 180 / Math.PI;
    this.#camera.aspect = width / height;
    this.#camera.setViewOffset(width, height, (right - left) / 2, (bottom - top) / 2, width, height);
    orbit.place(this.#camera, free.width / free.height);
    this.#camera.updateProjectionMatrix();
    this.#camera.updateMatrixWorld();
  }

  /** The ray of a pixel. @returns {{origin: number[], direction: number[]}} */
  rayAt(x, y) {
    const { width, height } = this.#frame;
    this.#ray.setFromCamera(new three.Vector2(2 * x / width - 1, 1 - 2 * y / height), this.#camera);
    return { origin: this.#ray.ray.origin.toArray(), direction: this.#ray.ray.direction.toArray() };
  }
  /** Where a point (m) is in the picture, px of CSS. */
  pixelOf(point) {
    const { width, height } = this.#frame, p = new three.Vector3(...point).project(this.#camera);
    return [(p.x + 1) / 2 * width, (1 - p.y) / 2 * height];
  }
  /** @returns {import('./hand_placing.js').Lens} */
  get lens() {
    const { width, height, left, top, right, bottom } = this.#frame, m = this.#camera.matrixWorld.elements;
    return { f: height / 2 / Math.tan(this.#camera.fov * Math.PI / 360), cx: (width - right + left) / 2, cy: (height - bottom + top) / 2,
             forward: [-m[8], -m[9], -m[10]], ...this.sides };
  }
  get width() { return this.#frame.width; }
  get height() { return this.#frame.height; }
  /** Unit vectors of the picture, right and up, in the room. */
  get sides() {
    const m = this.#camera.matrixWorld.elements;
    return { right: [m[0], m[1], m[2]], up: [m[4], m[5], m[6]], eye: [m[12], m[13], m[14]] };
  }
}

// An arrow of length 1 along y that ends at the origin.
function arrowOfOne() {
  const material = new three.MeshBasicMaterial({ color: 0xd8480a }), arrow = new three.Group();
  arrow.add(new three.Mesh(new three.CylinderGeometry(0.035, 0.035, 0.7, 12).translate(0, -0.65, 0), material),
            new three.Mesh(new three.ConeGeometry(0.11, 0.35, 20).translate(0, -0.175, 0), material));
  return arrow;
}

const kAxes = { y: new three.Vector3(0, 1, 0), z: new three.Vector3(0, 0, 1) };
// Puts a mesh with its origin to a point and its axis along a direction.
function lay(mesh, at, along, axis = 'y') {
  mesh.position.set(...at);
  mesh.quaternion.setFromUnitVectors(kAxes[axis], new three.Vector3(...along));
}
