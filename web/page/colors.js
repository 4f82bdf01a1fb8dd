// The colours of stress: those of the desktop. The picture uses its shader as it is, and the legend takes the numbers
// out of the same text, so that both show the same colour for the same stress.
import shader from '../../src/palpable/live/render/shaders/color_map.glsl';

export const kColorMap = shader;
/** sRGB, 0..1: natural rubber, as kRubber in scene_renderer.h. */
export const kRubber = [218 / 255, 205 / 255, 182 / 255];
/** The share of the scale from which its colours cover the material: kOpaqueShare in color_map.h. */
export const kOpaque = 0.2;

const polynomial = [...shader.match(/vec3 blue_yellow[^]*?return/)[0].matchAll(/vec3\(([^)]*)\)/g)]
  .map(([, numbers]) => numbers.split(',').map(parseFloat));
const clamp = (x) => Math.min(Math.max(x, 0), 1);

/** @param {number} share  of the scale, 0..1 @returns {string} of CSS, as the body shows it in even light */
export function colorOf(share) {
  const s = clamp((share - 0.15 * kOpaque) / (0.85 * kOpaque)), cover = s * s * (3 - 2 * s);
  const bytes = kRubber.map((rubber, k) => {
    const scale = clamp(polynomial.reduceRight((sum, c) => sum * share + c[k], 0));
    return Math.round(255 * ((1 - cover) * rubber + cover * scale));
  });
  return `rgb(${bytes.join(' ')})`;
}
