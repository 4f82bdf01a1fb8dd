// How body and fingers look.
import * as three from 'three';
import { kColorMap, kOpaque, kRubber } from './colors.js';

const kColored = `
  vec3 shown = painted(vec3(${kRubber.join(', ')}), vShare, ${kOpaque}, 0);
  diffuseColor.rgb = mix(shown / 12.92, pow((shown + 0.055) / 1.055, vec3(2.4)), step(0.04045, shown)); // of sRGB`;

/** Rubber, painted with the stress. @param {number} top  Pa, of the scale */
export function bodyMaterial(top) {
  const material = new three.MeshStandardMaterial({ roughness: 0.62, metalness: 0 });
  material.onBeforeCompile = (shader) => {
    shader.uniforms.top = { value: top };
    shader.vertexShader = `attribute float stress; uniform float top; varying float vShare;\n${shader.vertexShader}`
      .replace('#include <begin_vertex>', '#include <begin_vertex>\n  vShare = stress / top;');
    shader.fragmentShader = `varying float vShare;\n${kColorMap}\n${shader.fragmentShader}`
      .replace('#include <color_fragment>', kColored);
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
