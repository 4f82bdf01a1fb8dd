// The words and numbers over the picture.
import { colorOf } from './colors.js';
import { errorWords, kilopascals, materialWords, roundTicks, sizeWords, weightWords } from './words.js';

const kTicks = 5;
const kStops = 24; // colours of the bar
const at = (id) => document.getElementById(id);
const write = (id, text) => { if (at(id).textContent !== text) at(id).textContent = text; };

const kOfFingers = { many: 'fingers', none: 'force of your finger' };

/** Name, material, size, credit and the colours' scale of a body. */
export function showFacts({ facts, shape }) {
  document.title = `${facts.name}: a body to press`;
  write('name', facts.name);
  write('material', materialWords(facts.material));
  write('size', sizeWords(shape.height, shape.width));
  showCredit(facts.credit);
  at('view').setAttribute('aria-label', `${facts.name}, a soft body in a room`);
  const stops = Array.from({ length: kStops + 1 }, (_, k) => colorOf(k / kStops));
  at('bar').style.setProperty('--stops', stops.join(', '));
  at('ticks').replaceChildren(...roundTicks(facts.stressTop / 1000, kTicks).map(({ value, text }) => {
    const tick = document.createElement('span');
    tick.textContent = text;
    tick.style.setProperty('--at', value / (facts.stressTop / 1000));
    return tick;
  }));
}

// A credit names its shape's source, with a link, and its terms. The text is another person's: never HTML.
function showCredit(credit) {
  at('credit').replaceChildren();
  if (!credit) return;
  const place = /^https?:/.test(credit.url ?? '') ? document.createElement('a') : document.createElement('span');
  if (place.tagName === 'A') place.href = credit.url;
  place.textContent = credit.text;
  at('credit').append(place, credit.terms ? ` ${credit.terms}` : '');
}

/** The numbers of a frame. @param {ReturnType<import('./pressed_body.js').PressedBody['reading']>} reading
 *  @param {number} top  Pa, of the colours @param {{many: string, none: string}} of  what presses */
export function showReading(reading, top, of = kOfFingers) {
  write('newtons', reading.force.toFixed(reading.force < 99.95 ? 2 : 0));
  write('weight', weightWords(reading.force, of.none));
  write('push', reading.fingers === 0 ? '\u00a0'
    : `${reading.fingers > 1 ? `${reading.fingers} ${of.many}, ` : ''}${(1000 * reading.push).toFixed(1)} mm${reading.fingers > 1 ? '' : ' deep'}`);
  const any = reading.fingers > 0 && reading.stress >= 50; // less would be written as 0.0
  at('mark').hidden = !any;
  at('mark').style.setProperty('--at', Math.min(reading.stress / top, 1));
  write('largest', any ? `largest ${kilopascals(reading.stress)} kPa${reading.stress > top ? ', above the colours' : ''}` : 'at rest');
  write('error', any && reading.error > 0 ? errorWords(reading.error) : '\u00a0');
}

/** Says a press aloud, for people who do not see it. */
export function speak({ force, push, stress, error }) {
  const about = error > 0 ? `, ${errorWords(error).replace('±', 'plus or minus')}` : '';
  write('spoken', `Pressed ${(1000 * push).toFixed(0)} millimetres: ${force.toFixed(1)} newtons, ` +
    `largest stress ${kilopascals(stress)} kilopascals${about}.`);
}
export const say = (text) => write('spoken', text);

const kTouchHint = 'Press the body. Drag beside it to turn.';
export function showHint(coarse) {
  write('hint', coarse ? kTouchHint : 'Press the body and hold. Drag beside it to turn.');
}
export const endHint = () => at('hint').classList.add('done');

export function showProgress(text, share) {
  at('loading').hidden = at('progress').hidden = false;
  write('stage', text);
  if (share === undefined) at('progress').removeAttribute('value');
  else at('progress').value = share;
}
export const endProgress = () => { at('loading').hidden = true; };
export function showTrouble(text) {
  at('loading').hidden = false;
  at('loading').setAttribute('role', 'alert');
  at('progress').hidden = true;
  write('stage', text);
}

/** The strips at the picture's edges that words cover. */
export function coveredStrips() {
  const { width, height } = at('view').getBoundingClientRect();
  const low = at('legend').getBoundingClientRect(), seen = at('seen').getBoundingClientRect(); // empty while it is hidden
  if (width > 640) return { width, height, left: seen.right, top: 0, right: Math.min(0.12 * width, 140), bottom: 56 };
  if (seen.height > 0) return { width, height, left: 0, right: 0, top: seen.bottom, bottom: Math.max(0, height - low.top) };
  const top = Math.max(at('about').getBoundingClientRect().bottom, at('force').getBoundingClientRect().bottom);
  return { width, height, left: 0, right: 0, top: Math.min(top, 0.4 * height), bottom: Math.max(0, height - low.top) };
}
