// A tag that moves, a camera whose pictures are rare and late, and the point at which the hand aims.
import { add, scale, subtract } from "./algebra.js";

/** The tag's position relative to its start at time t, in [m], for three motions with a speed in [m/s]. */
export const MOVES = {
  conveyor: ({ speed }) => (t) => [0, speed * (t % 4 < 2 ? -(t % 4) : (t % 4) - 4), 0],
  circle: ({ speed, radius }) => (t) => {
    const a = (speed / radius) * t;
    return [radius * Math.sin(a), radius * (Math.cos(a) - 1), 0];
  },
  hand: ({ speed }) => (t) => { // moves, stops suddenly, comes back, stops suddenly
    const lap = t % 4;
    return [0, -speed * (lap < 1 ? lap : lap < 2 ? 1 : lap < 3 ? 3 - lap : 0), 0];
  },
};

/** The camera's knowledge of the tag, from readings that are `age` [s] old when they arrive. */
export class Sight {
  /** `rate` is in [Hz], `sigma` is the deviation of a reading in [m], and `noise` returns normal numbers. */
  constructor({ rate, age, sigma, predict }, noise) {
    Object.assign(this, { rate, age, sigma, predict, noise, coming: [], readings: [], next: 0 });
  }

  /** Let the camera look at a tag at p at time t, and use the readings that have arrived. */
  look(t, p) {
    if (t >= this.next - 1e-9) {
      this.coming.push({ stamp: t, p: p.map((x, k) => (k < 2 ? x + this.sigma * this.noise() : x)) });
      this.next = t + 1 / this.rate;
    }
    while (this.coming.length && this.coming[0].stamp + this.age <= t + 1e-9) {
      this.readings = [...this.readings.slice(-1), this.coming.shift()];
    }
  }

  /** The point to aim at, which is the newest reading or its prediction with a constant velocity, and the reading's age. */
  aim(t) {
    const newest = this.readings.at(-1), still = [0, 0, 0];
    if (!newest) return { p: still, seen: still, v: still, old: 0 };
    const before = this.readings.at(-2), old = t - newest.stamp;
    const v = before && before !== newest ? scale(1 / (newest.stamp - before.stamp), subtract(newest.p, before.p)) : still;
    return { p: this.predict ? add(newest.p, scale(old, v)) : newest.p, seen: newest.p, v, old };
  }
}
