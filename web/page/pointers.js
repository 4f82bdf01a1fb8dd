// Mouse, pen and fingers on glass. What begins on the body presses it, each finger for itself; what begins beside it
// turns the room, and two fingers beside it also come closer.

const kPinchPerStep = 0.9;   // ratio of distances that is one step of the wheel
const kWheelPerStep = 100;   // px, of one notch
const kLinePx = 33;          // px, of a wheel that counts lines

/** @param {HTMLCanvasElement} canvas
 *  @param actions  placeAt(x, y), press(key, place), drag(key, px), release(key), turn(dx, dy), zoom(steps, isWheel) */
export class Pointers {
  #canvas;
  #actions;
  #pressing = new Map(); // by pointer: where it began
  #turning = new Map();  // by pointer: where it is

  constructor(canvas, actions) {
    [this.#canvas, this.#actions] = [canvas, actions];
    const on = (name, handle) => canvas.addEventListener(name, handle, { passive: false });
    on('pointerdown', (event) => this.#down(event));
    on('pointermove', (event) => this.#move(event));
    for (const name of ['pointerup', 'pointercancel', 'lostpointercapture']) on(name, (event) => this.#up(event));
    on('wheel', (event) => this.#wheel(event));
    on('contextmenu', (event) => event.preventDefault());
  }

  #at({ clientX, clientY }) {
    const { left, top } = this.#canvas.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  #down(event) {
    const key = event.pointerId, at = this.#at(event);
    if (this.#pressing.has(key) || this.#turning.has(key)) return; // a second button
    this.#canvas.setPointerCapture(key);
    const place = event.button === 0 ? this.#actions.placeAt(...at) : null;
    if (place) {
      this.#pressing.set(key, at);
      this.#actions.press(key, place);
    } else {
      this.#turning.set(key, at);
      this.#canvas.classList.add('turning');
    }
  }

  #move(event) {
    const key = event.pointerId, at = this.#at(event);
    if (this.#pressing.has(key)) {
      const from = this.#pressing.get(key);
      this.#actions.drag(key, Math.hypot(at[0] - from[0], at[1] - from[1]));
    } else if (this.#turning.has(key)) {
      this.#turn(key, at);
    } else if (event.pointerType === 'mouse') {
      this.#canvas.classList.toggle('over', this.#actions.placeAt(...at) !== null);
    }
  }

  // Of several fingers each moves the room by its share, so that it follows their middle.
  #turn(key, at) {
    const before = this.#turning.get(key), others = [...this.#turning].filter(([other]) => other !== key);
    const share = 1 / this.#turning.size;
    this.#actions.turn(share * (at[0] - before[0]), share * (at[1] - before[1]));
    if (others.length === 1) {
      const [, fixed] = others[0], apart = ([x, y]) => Math.hypot(x - fixed[0], y - fixed[1]);
      const ratio = apart(before) / Math.max(apart(at), 1);
      this.#actions.zoom(Math.log(ratio) / Math.log(kPinchPerStep));
    }
    this.#turning.set(key, at);
  }

  #up({ pointerId: key }) {
    if (this.#pressing.delete(key)) this.#actions.release(key);
    this.#turning.delete(key);
    if (this.#turning.size === 0) this.#canvas.classList.remove('turning');
  }

  #wheel(event) {
    event.preventDefault(); // else a pad's pinch enlarges the page
    const px = event.deltaY * (event.deltaMode === 1 ? kLinePx : 1);
    this.#actions.zoom(-px / kWheelPerStep * (event.ctrlKey ? 5 : 1), !event.ctrlKey);
  }
}
