// The room: a floor with tiles of 5 cm that melts into the wall, a lamp above, and the shadow under the body.
import * as three from 'three';

const kTile = 0.05;                 // m
const kLamp = [-0.55, -0.75, 1.5];  // from the body's middle, in radii of it
const kLight = { wall: 0xf3f2ee, floor: 0xf0ede7, line: 'rgba(110,100,85,0.22)', sky: 0xffffff, ground: 0xf2ebe0,
                 skyPower: 2.2, lampPower: 1.25, shade: 0.34 };
const kDark = { wall: 0x1d2025, floor: 0x3a3e46, line: 'rgba(10,12,16,0.55)', sky: 0xf4f7ff, ground: 0xcfcac2,
                skyPower: 1.9, lampPower: 1.5, shade: 0.5 };

function canvasTexture(size, paint) {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  paint(canvas.getContext('2d'), size);
  const texture = new three.CanvasTexture(canvas);
  texture.colorSpace = three.SRGBColorSpace;
  return texture;
}

const lines = (color) => canvasTexture(256, (c, size) => {
  c.fillStyle = 'white';
  c.fillRect(0, 0, size, size);
  c.fillStyle = color;
  c.fillRect(0, 0, size, 3);
  c.fillRect(0, 3, 3, size - 3);
});
const blot = () => canvasTexture(128, (c, size) => { // dark in the middle
  const round = c.createRadialGradient(size / 2, size / 2, 0, size / 2, size / 2, size / 2);
  for (let k = 0; k <= 8; ++k) round.addColorStop(k / 8, `rgba(0,0,0,${(1 - k / 8) ** 2 * (1 + 2 * k / 8)})`);
  c.fillStyle = round;
  c.fillRect(0, 0, size, size);
});

export class Room {
  #floor = new three.Mesh(new three.PlaneGeometry(1, 1), new three.MeshLambertMaterial());
  #under = new three.Mesh(new three.PlaneGeometry(1, 1),
                          new three.MeshBasicMaterial({ map: blot(), transparent: true, depthWrite: false, fog: false }));
  #sky = new three.HemisphereLight();
  #lamp = new three.DirectionalLight();
  #radius = 0.1;

  constructor() {
    this.#floor.receiveShadow = true;
    this.#sky.position.set(0, 0, 1);
    this.#lamp.castShadow = true;
    this.#lamp.shadow.mapSize.set(512, 512); // coarse and wide: a soft edge
    this.#lamp.shadow.radius = 7;
    this.#under.renderOrder = -1;
  }
  get parts() { return [this.#floor, this.#under, this.#sky, this.#lamp, this.#lamp.target]; }

  paint(scene, renderer, dark) {
    const colors = dark ? kDark : kLight;
    this.#wall = new three.Color(colors.wall);
    this.#fog = new three.Fog(colors.wall);
    this.show(scene, this.#isShown);
    this.#floor.material.map?.dispose();
    this.#floor.material.map = lines(colors.line);
    this.#floor.material.map.wrapS = this.#floor.material.map.wrapT = three.RepeatWrapping;
    this.#floor.material.map.anisotropy = Math.min(8, renderer.capabilities.getMaxAnisotropy());
    this.#floor.material.color.set(colors.floor);
    this.#floor.material.needsUpdate = true;
    this.#sky.color.set(colors.sky);
    this.#sky.groundColor.set(colors.ground);
    this.#sky.intensity = colors.skyPower;
    this.#lamp.intensity = colors.lampPower;
    this.#under.material.opacity = colors.shade;
    this.#measure();
  }
  #fog;

  /** Shows floor and walls, or leaves them out: then the canvas is clear there. */
  show(scene, is) {
    this.#isShown = is;
    this.#floor.visible = this.#under.visible = is;
    scene.background = is ? this.#wall : null;
    scene.fog = is ? this.#fog : null;
  }
  #isShown = true;
  #wall = null;

  /** Makes the room large enough for a body. @param {import('./orbit.js').shapeOf} shape */
  fit({ target, radius, foot }) {
    this.#radius = radius;
    const [x, y, z] = target;
    this.#lamp.target.position.set(x, y, z);
    this.#lamp.position.set(x + 4 * radius * kLamp[0], y + 4 * radius * kLamp[1], z + 4 * radius * kLamp[2]);
    Object.assign(this.#lamp.shadow.camera, { left: -1.6 * radius, right: 1.6 * radius, top: 1.6 * radius,
                                              bottom: -1.6 * radius, near: 3 * radius, far: 12 * radius });
    this.#lamp.shadow.camera.updateProjectionMatrix();
    this.#lamp.shadow.normalBias = 0.02 * radius;
    this.#under.scale.set(2.6 * foot[2], 2.6 * foot[3], 1);
    this.#under.position.set(foot[0], foot[1], foot[4] + 0.002 * radius);
    this.#floor.position.z = foot[4];
    this.#measure();
  }
  #measure() {
    const size = 80 * this.#radius;
    this.#floor.scale.set(size, size, 1);
    // Rounded, so that a line runs through the origin.
    this.#floor.material.map?.repeat.setScalar(2 * Math.round(size / kTile / 2));
    if (this.#fog) [this.#fog.near, this.#fog.far] = [7 * this.#radius, 24 * this.#radius];
  }
}
