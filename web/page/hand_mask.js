// Hands before the body: where they are, the body's picture is taken away, and the camera's picture behind it shows them.
// Each capsule is a flat patch that faces the eye, at the depth of its near side, with soft edges.
import * as three from 'three';

const kFeather = 0.003; // m, of the edge
const kMost = 2 * 30;   // capsules

const kVertex = `
  attribute vec4 a, b; varying vec2 at; varying vec2 vA, vB; varying vec2 radii;
  uniform float feather;
  void main() {
    vec3 p = (modelViewMatrix * vec4(a.xyz, 1.0)).xyz, q = (modelViewMatrix * vec4(b.xyz, 1.0)).xyz;
    vec2 along = q.xy - p.xy; float size = length(along);
    along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
    float r = (position.x < 0.0 ? a.w : b.w) + feather, near = 0.8 * min(a.w, b.w);
    vec3 end = position.x < 0.0 ? p : q;
    at = end.xy + r * (position.x * along + position.y * vec2(-along.y, along.x));
    vA = p.xy; vB = q.xy; radii = vec2(a.w, b.w);
    gl_Position = projectionMatrix * vec4(at, end.z + near, 1.0);
  }`;
const kFragment = `
  varying vec2 at, vA, vB, radii; uniform float feather;
  void main() {
    vec2 u = vB - vA, p = at - vA; float t = clamp(dot(p, u) / max(dot(u, u), 1e-9), 0.0, 1.0);
    float away = length(p - t * u) - mix(radii.x, radii.y, t);
    gl_FragColor = vec4(0.0, 0.0, 0.0, 1.0 - smoothstep(-feather, feather, away));
  }`;

export class HandMask {
  #a = new three.InstancedBufferAttribute(new Float32Array(4 * kMost), 4);
  #b = new three.InstancedBufferAttribute(new Float32Array(4 * kMost), 4);
  mesh;

  constructor() {
    const geometry = new three.InstancedBufferGeometry();
    geometry.setAttribute('position', new three.BufferAttribute(Float32Array.of(-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0), 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.setAttribute('a', this.#a);
    geometry.setAttribute('b', this.#b);
    geometry.instanceCount = 0;
    this.mesh = new three.Mesh(geometry, new three.ShaderMaterial({
      vertexShader: kVertex, fragmentShader: kFragment, uniforms: { feather: { value: kFeather } },
      transparent: true, depthWrite: false, side: three.DoubleSide, blending: three.CustomBlending,
      blendEquation: three.AddEquation, blendSrc: three.ZeroFactor, blendDst: three.OneMinusSrcAlphaFactor,
    }));
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2; // after the body
  }

  /** @param {Float64Array[]} hands  capsules, 8 numbers each, m */
  show(hands) {
    let count = 0;
    for (const capsules of hands) {
      for (let c = 0; c < capsules.length && count < kMost; c += 8, ++count) {
        this.#a.array.set([...capsules.subarray(c, c + 3), capsules[c + 6]], 4 * count);
        this.#b.array.set([...capsules.subarray(c + 3, c + 6), capsules[c + 7]], 4 * count);
      }
    }
    this.mesh.geometry.instanceCount = count;
    this.mesh.visible = count > 0;
    this.#a.needsUpdate = this.#b.needsUpdate = true;
  }
}

/** A capsule for the forearm, which has no landmarks: from the wrist away from the middle finger's knuckle. For the mask alone.
 *  @param {Float64Array} joints  21 times x y z, m */
export function forearm(joints) {
  const wrist = joints.subarray(0, 3), knuckle = joints.subarray(27, 30), away = [0, 1, 2].map((k) => wrist[k] - knuckle[k]);
  const size = Math.hypot(...away) || 1, end = away.map((x, k) => wrist[k] + 0.25 * x / size);
  return Float64Array.of(...wrist, ...end, 0.027, 0.04);
}
