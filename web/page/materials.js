// How body and fingers look.
import * as three from 'three';
import { kColorMap, kOpaque, kRubber } from './colors.js';

const kColored = `
  vec3 shown = painted(vec3(${kRubber.join(', ')}), vShare, ${kOpaque}, 0);
  diffuseColor.rgb = mix(shown / 12.92, pow((shown + 0.055) / 1.055, vec3(2.4)), step(0.04045, shown)); // of sRGB`;

// A line where planes that face the eye cut the body, as wide everywhere (webcam hands press there).
const kCut = `#include <opaque_fragment>
  float perPixel = max(fwidth(vViewPosition.z), 1e-5);
  vec2 off = abs(vec2(vViewPosition.z) - planes) / perPixel, line = (1.0 - smoothstep(0.8, 1.8, off)) * step(vec2(0.0), planes);
  gl_FragColor.rgb = mix(gl_FragColor.rgb, vec3(0.75, 0.10, 0.005), max(line.x, line.y));`;

/** Rubber, painted with the stress; material.userData.planes: depths (m) of planes to show, below 0: none. @param {number} top  Pa, of the scale */
export function bodyMaterial(top) {
  const material = new three.MeshStandardMaterial({ roughness: 0.62, metalness: 0 });
  const planes = material.userData.planes = { value: new three.Vector2(-1, -1) };
  material.onBeforeCompile = (shader) => {
    shader.uniforms.top = { value: top };
    shader.uniforms.planes = planes;
    shader.vertexShader = `attribute float stress; uniform float top; varying float vShare;\n${shader.vertexShader}`
      .replace('#include <begin_vertex>', '#include <begin_vertex>\n  vShare = stress / top;');
    shader.fragmentShader = `varying float vShare; uniform vec2 planes;\n${kColorMap}\n${shader.fragmentShader}`
      .replace('#include <color_fragment>', kColored)
      .replace('#include <opaque_fragment>', kCut);
  };
  return material;
}

/** Glass that shows the dent behind it, and ends softly. @param {number} length  m, over which it fades */
export function fingerMaterial(length) {
  return new three.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: { length: { value: length } },
    vertexShader: `
      varying vec3 n, toEye; varying float back;
      uniform float length;
      void main() {
        vec4 p = modelViewMatrix * vec4(position, 1.0);
        n = normalMatrix * normal;
        toEye = -p.xyz;
        back = clamp(-position.y / length, 0.0, 1.0);
        gl_Position = projectionMatrix * p;
      }`,
    fragmentShader: `
      varying vec3 n, toEye; varying float back;
      void main() {
        float facing = clamp(dot(normalize(n), normalize(toEye)), 0.0, 1.0);
        float rim = pow(1.0 - facing, 2.0);
        vec3 color = mix(vec3(0.94, 0.97, 1.0), vec3(0.16, 0.24, 0.36), rim);
        gl_FragColor = vec4(color, mix(0.20, 0.78, rim) * (1.0 - smoothstep(0.35, 1.0, back)));
      }`,
  });
}

/** A sheet around a fingertip, which fades outwards: it shows the plane in which the tip presses. @param {number} half  m, of its side */
export function sheetMaterial(half) {
  return new three.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    side: three.DoubleSide,
    uniforms: { half_: { value: half }, touches: { value: 0 } },
    vertexShader: `
      varying vec2 at;
      void main() {
        at = position.xy;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: `
      varying vec2 at;
      uniform float half_, touches;
      void main() {
        float away = length(at), fade = 1.0 - smoothstep(0.25 * half_, half_, away);
        float ring = 1.0 - smoothstep(0.0005, 0.0011, abs(away - 0.008));
        vec3 color = mix(vec3(1.0), vec3(0.95, 0.42, 0.10), max(touches, 0.35));
        gl_FragColor = vec4(color, max(0.95 * ring, 0.22 * fade));
      }`,
  });
}
