// From what a finder says of single pictures to hands that go on: which hand is which, smooth, and where they are now.
// Pure: no clock and no page; times in s come as arguments. Lengths are picture widths; both axes have the same unit, which
// the caller sees to. `points` are 21 times x y z.

/** m or picture widths: a hand's size is the distance from wrist to the middle finger's knuckle, or 1.45 times that between
 *  the knuckles of index and little finger, which is longer where the palm is seen from the side. */
export function sizeOf(points) {
  const apart = (i, j) => Math.hypot(points[3 * i] - points[3 * j], points[3 * i + 1] - points[3 * j + 1]);
  return Math.max(apart(0, 9), kOfBreadth * apart(5, 17), 1e-6);
}
const kOfBreadth = 1.45;

const kSame = 0.5;          // hand sizes, mean of the points: nearer hands of one picture are the same one, found twice
const kFollow = 1;          // hand sizes: as far may a hand be from where it was expected,
const kFollowMore = 5;      // and as many more for each second since (0.5 m/s)
const kHeld = 0.2;          // s: as long a hand stays that is no longer found
const kSilence = 1;        // s: as long the finder may say nothing
const kAhead = 0.1;         // s, most of prediction: a hand that stops was wrong by this times its speed
const kMostHands = 2;
const kSideVotes = 5;       // finds until the side of a hand is settled

// One-Euro (Casiez et al., CHI 2012): a low-pass filter with cut-off f = kSlow + kPerSpeed |v|, lag 1 / (2 pi f). A hand
// that rests trembles by 1 to 2 mm; one that moves must not lag.
const kSlow = 1.5;          // Hz, at rest: 106 ms
const kPerSpeed = 4;        // Hz for each hand size a second: at one (some 0.1 m/s) 29 ms, at five 7 ms
const kSpeedCutoff = 4;     // Hz, of the speed: 40 ms

/** s, of the filter at a speed in hand sizes a second. */
export const lagAt = (speed) => 1 / (2 * Math.PI * (kSlow + kPerSpeed * speed));

const share = (cutoff, seconds) => 1 / (1 + 1 / (2 * Math.PI * cutoff * seconds));

/** Mean distance of two hands' points across the picture, in sizes of the first. */
function between(a, b) {
  let sum = 0;
  for (let k = 0; k < 63; k += 3) sum += Math.hypot(a[k] - b[k], a[k + 1] - b[k + 1]);
  return sum / 21 / sizeOf(a);
}

/** Without hands that were found twice: of each two the surer stays. */
export function withoutDoubles(found) {
  const kept = [];
  for (const hand of [...found].sort((a, b) => b.score - a.score)) {
    if (kept.every((other) => between(other.points, hand.points) > kSame)) kept.push(hand);
  }
  return kept;
}

class Track {
  #speed = new Float64Array(63);  // of each point, filtered
  #motion = [0, 0];               // of the hand: the mean of these
  #votes = 0;                     // > 0: right
  #count = 0;

  constructor(id, hand, time) {
    Object.assign(this, { id, side: hand.side, points: Float64Array.from(hand.points), time, born: time });
    this.#vote(hand);
  }
  #vote({ side, score }) {
    if (this.#count >= kSideVotes) return; // settled: what flips later is not believed
    this.#votes += (side === 'right' ? 1 : -1) * (score || 0.5);
    ++this.#count;
    this.side = this.#votes > 0 ? 'right' : 'left';
  }

  update(hand, time) {
    const seconds = time - this.time, { points } = this;
    if (!(seconds > 0)) return;
    const size = sizeOf(hand.points), ofSpeed = share(kSpeedCutoff, seconds);
    const sums = [0, 0];
    for (let k = 0; k < 63; ++k) {
      this.#speed[k] += ofSpeed * ((hand.points[k] - points[k]) / seconds - this.#speed[k]);
      if (k % 3 < 2) sums[k % 3] += this.#speed[k] / 21;
    }
    this.#motion = sums;
    for (let k = 0; k < 63; k += 3) {
      // One cut-off for a point, not for each axis: a filter of its own would bend straight ways.
      const speed = Math.hypot(this.#speed[k], this.#speed[k + 1]) / size, of = share(kSlow + kPerSpeed * speed, seconds);
      const ofDepth = share(kSlow, seconds); // which is known badly
      points[k] += of * (hand.points[k] - points[k]);
      points[k + 1] += of * (hand.points[k + 1] - points[k + 1]);
      points[k + 2] += ofDepth * (hand.points[k + 2] - points[k + 2]);
    }
    this.time = time;
    this.#vote(hand);
  }

  /** The points at a time: moved on as a whole, as it moved last. */
  at(time) {
    const ahead = Math.min(Math.max(time - this.time, 0), kAhead), result = this.points.slice();
    for (let k = 0; k < 63; k += 3) {
      result[k] += ahead * this.#motion[0];
      result[k + 1] += ahead * this.#motion[1];
    }
    return result;
  }
}

export class HandTracks {
  #all = [];
  #next = 1;
  #latest = 0; // s, of the last picture

  #dropLost() { this.#all = this.#all.filter((track) => this.#latest - track.time <= kHeld + 1e-9); }

  /** Takes what was found in a picture of a time.
   *  @param {import('./hand_finder.js').FoundHand[]} found */
  update(found, time) {
    this.#latest = time;
    const left = withoutDoubles(found), pairs = [];
    for (const track of this.#all) {
      for (const hand of left) pairs.push([between(track.at(time), hand.points), track, hand]);
    }
    pairs.sort((a, b) => a[0] - b[0]);
    const taken = new Set();
    for (const [far, track, hand] of pairs) {
      if (far > kFollow + kFollowMore * (time - track.time) || taken.has(track) || taken.has(hand)) continue;
      taken.add(track).add(hand);
      track.update(hand, time);
    }
    this.#dropLost();
    for (const hand of left) {
      // A hand that is found anew where a held one is: the same one.
      if (taken.has(hand) || this.#all.length >= kMostHands) continue;
      if (this.#all.some((track) => between(track.at(time), hand.points) < kSame)) continue;
      this.#all.push(new Track(this.#next++, hand, time));
    }
  }

  /** The hands at a time. One that was not found in the pictures of 200 ms is gone, and all are where no picture came for 1 s.
   *  @returns {{id: number, side: 'left' | 'right', points: Float64Array}[]} */
  at(time) {
    if (time - this.#latest > kSilence) return [];
    return this.#all.map((track) => ({ id: track.id, side: track.side, points: track.at(time) }));
  }
  clear() { this.#all = []; }
}
