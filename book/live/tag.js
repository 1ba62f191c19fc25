// A tag that moves, a camera that sees it seldom and late, and a point to aim at.
import { add, scale, subtract } from "./algebra.js";

/** Where the tag is, seen from its start, at time t, in [m]: three ways to move at a speed in [m/s]. */
export const MOVES = {
  conveyor: ({ speed }) => (t) => [0, speed * (t % 4 < 2 ? -(t % 4) : (t % 4) - 4), 0],
  circle: ({ speed, radius }) => (t) => {
    const a = (speed / radius) * t;
    return [radius * Math.sin(a), radius * (Math.cos(a) - 1), 0];
  },
  hand: ({ speed }) => (t) => { // goes, stops dead, comes back, stops dead
    const lap = t % 4;
    return [0, -speed * (lap < 1 ? lap : lap < 2 ? 1 : lap < 3 ? 3 - lap : 0), 0];
  },
};

/** What is known of the tag through a camera: readings that are `age` [s] old when they arrive. */
export class Sight {
  /** `rate` [Hz], `sigma` the deviation of a reading [m], `noise` gives normal numbers. */
  constructor({ rate, age, sigma, predict }, noise) {
    Object.assign(this, { rate, age, sigma, predict, noise, coming: [], readings: [], next: 0 });
  }

  /** Let the camera look at time t at a tag that is at p, and take in what has arrived. */
  look(t, p) {
    if (t >= this.next - 1e-9) {
      this.coming.push({ stamp: t, p: p.map((x, k) => (k < 2 ? x + this.sigma * this.noise() : x)) });
      this.next = t + 1 / this.rate;
    }
    while (this.coming.length && this.coming[0].stamp + this.age <= t + 1e-9) {
      this.readings = [...this.readings.slice(-1), this.coming.shift()];
    }
  }

  /** The point to aim at, and how old the newest reading is: that reading, or where an even motion has brought the tag. */
  aim(t) {
    const newest = this.readings.at(-1), still = [0, 0, 0];
    if (!newest) return { p: still, seen: still, v: still, old: 0 };
    const before = this.readings.at(-2), old = t - newest.stamp;
    const v = before && before !== newest ? scale(1 / (newest.stamp - before.stamp), subtract(newest.p, before.p)) : still;
    return { p: this.predict ? add(newest.p, scale(old, v)) : newest.p, seen: newest.p, v, old };
  }
}
