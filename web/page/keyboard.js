// The keyboard alone: arrows move a finger over the skin, Space or Enter presses.

const kStep_m = 0.006;      // of one arrow key
const kTurn_px = 24;        // of one arrow key with Shift, as of a mouse
const kAbove_m = 0.02;      // from where the skin is looked for beside a place
const kWidest = 0.9;        // rad: the room turns when the finger would go to the far side
const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const along = (point, way, direction) => point.map((x, k) => x + way * direction[k]);

/** The place a step beside another one, in a direction of the picture.
 * @param {(origin: number[], direction: number[]) => import('./pick.js').Place | null} look  along a ray */
export function placeBeside(place, wanted, step, look) {
  const { point, inwards } = place, flat = along(wanted, -dot(wanted, inwards), inwards);
  const length = Math.hypot(...flat);
  if (length < 1e-6) return place;
  const direction = flat.map((x) => x / length);
  // Further in, where the skin bends away from the step; at last from ahead, where it ends.
  for (const down of [0, 0.5, 1, 2]) {
    const way = inwards.map((x, k) => x - down * direction[k]), size = Math.hypot(...way);
    const found = look(along(along(point, step, direction), -kAbove_m, way.map((x) => x / size)), way.map((x) => x / size));
    if (found && Math.hypot(...found.point.map((x, k) => x - point[k])) < 4 * step) return found;
  }
  return place;
}

/** @param actions  start(): Place | null, look(origin, direction), sides, mark(place), press(key, place), release(key),
 *                  turn(dx, dy), face(normal, widest), zoom(steps), plane(steps), reset() */
export class Keyboard {
  #actions;
  #place = null;
  #held = null; // the key that presses

  constructor(canvas, actions) {
    this.#actions = actions;
    canvas.addEventListener('keydown', (event) => this.#down(event));
    canvas.addEventListener('keyup', ({ code }) => { if (code === this.#held) this.#end(); });
    canvas.addEventListener('blur', () => this.hide());
  }
  /** Ends a press, and hides the finger's ring: another body, or the mouse has taken over. */
  hide(forget = false) {
    this.#end();
    if (forget) this.#place = null;
    this.#actions.mark(null);
  }

  #end() {
    if (this.#held) this.#actions.release('keyboard');
    this.#held = null;
  }

  #down(event) {
    if (event.altKey || event.metaKey || event.ctrlKey) return;
    const { key, code, shiftKey, repeat } = event, arrow = kArrows[key];
    if (arrow && shiftKey) this.#actions.turn(-kTurn_px * arrow[0], kTurn_px * arrow[1]);
    else if (arrow) this.#move(arrow);
    else if (code === 'Space' || key === 'Enter') { if (!repeat) this.#press(code); }
    else if (key === '+' || key === '=') this.#actions.zoom(1);
    else if (key === '-' || key === '_') this.#actions.zoom(-1);
    else if (key === 'PageUp' || key === 'PageDown') this.#actions.plane(key === 'PageUp' ? 1 : -1);
    else if (key === 'r' || key === 'R') this.#actions.reset();
    else return;
    event.preventDefault();
  }

  #move([right, up]) {
    if (this.#held) return;
    if (!this.#place) {
      this.#place = this.#actions.start();
    } else {
      const sides = this.#actions.sides, wanted = sides.right.map((x, k) => right * x + up * sides.up[k]);
      this.#place = placeBeside(this.#place, wanted, kStep_m, this.#actions.look);
    }
    if (!this.#place) return;
    this.#actions.face(this.#place.inwards.map((x) => -x), kWidest);
    this.#actions.mark(this.#place);
  }

  #press(code) {
    if (this.#held) return;
    this.#place ??= this.#actions.start();
    if (!this.#place) return;
    // The skin may have moved since: a press starts at it.
    const { point, inwards } = this.#place;
    this.#place = this.#actions.look(along(point, -kAbove_m, inwards), inwards) ?? this.#place;
    this.#held = code;
    this.#actions.mark(this.#place);
    this.#actions.press('keyboard', this.#place);
  }
}
