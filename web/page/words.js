// What the page says about numbers. Pure functions.

// Young's modulus, Pa, below which a body feels like that. Gelatine has 1 to 10 kPa, sweets of gelatine and soft
// silicone some 50 to 100 kPa, erasers and rubber bands 1 to 3 MPa.
const kLikes = [[1e4, 'soft as jelly'], [3e4, 'soft as a marshmallow'], [2e5, 'soft as a jelly sweet'],
                [8e5, 'firm as a bath sponge toy'], [5e6, 'firm as a rubber eraser'], [Infinity, 'hard as a shoe sole']];

/** "60 kPa" of 60000. */
export function pascals(value) {
  const [factor, unit] = value >= 1e6 ? [1e6, 'MPa'] : value >= 1e3 ? [1e3, 'kPa'] : [1, 'Pa'];
  return `${Number((value / factor).toPrecision(3))} ${unit}`;
}

/** @param {string} line  of a body file: "neo-hookean, Young's modulus 6e+04 Pa, ..." */
export function materialWords(line) {
  const young = Number(line.match(/Young's modulus ([\d.e+-]+) Pa/)?.[1]);
  if (!young) return line;
  return `Rubber, ${kLikes.find(([below]) => young < below)[1]} (${pascals(young)})`;
}

/** @param {number} height  m */
export function sizeWords(height, width) {
  const cm = (x) => Number((100 * x).toPrecision(2));
  return `${cm(height)} cm tall, ${cm(width)} cm wide`;
}

/** "as heavy as 120 g" of 1.2 N. */
export function weightWords(newtons, none = 'force of your finger') {
  const grams = newtons / 9.81 * 1000;
  if (grams < 0.5) return none;
  if (grams < 1000) return `as heavy as ${grams < 10 ? grams.toFixed(0) : Number(grams.toPrecision(2))} g`;
  return `as heavy as ${Number((grams / 1000).toPrecision(2))} kg`;
}

/** One significant digit, as the desktop has it: the error itself is not known better. */
export function errorWords(relative) {
  if (!(relative > 0)) return '';
  const percent = 100 * relative;
  if (percent > 100) return 'model error > 100 %';
  return `model error ± ${percent < 1 ? percent.toFixed(1) : percent.toFixed(0)} %`;
}

/** kPa, with one decimal below 10. */
export const kilopascals = (pa) => (pa / 1000).toFixed(pa < 1e4 ? 1 : 0);

/** Round numbers from 0 to `top`, about `wanted` of them, in steps of 1, 2 or 5 times a power of ten: those of legend.h.
 * @returns {{value: number, text: string}[]} */
export function roundTicks(top, wanted) {
  const raw = top / wanted, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * (1 - 1e-9));
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return Array.from({ length: Math.floor(top / step * (1 + 1e-9)) + 1 },
                    (_, k) => ({ value: k * step, text: (k * step).toFixed(digits) }));
}
