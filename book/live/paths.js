// Paths, which are curves in s from 0 to 1, and trajectories along them; `labkit/paths.py`, `trajectory.py`.
import { add, length, scale, subtract, zeros } from "./algebra.js";
import { profile, trapezoid, trapezoidDuration } from "../../labkit/replay/viewer/scaling.js";

/** The straight segment from `start` to `goal`. */
export function line(start, goal) {
  const along = subtract(goal, start), still = zeros(start.length);
  const path = (s) => ({ position: add(start, scale(s, along)), velocity: along, acceleration: still });
  return Object.assign(path, { distance: length(along) });
}

/** The level circle through `start` about the vertical axis through `centre`, counter-clockwise from above. */
export function circle(start, centre, turns = 1) {
  const [x, y] = [start[0] - centre[0], start[1] - centre[1]], rate = 2 * Math.PI * turns;
  const path = (s) => {
    const whole = s === 1 && turns % 1 === 0;
    const c = whole ? 1 : Math.cos(rate * s), d = whole ? 0 : Math.sin(rate * s);
    const out = [c * x - d * y, d * x + c * y], on = [-d * x - c * y, c * x - d * y];
    return { position: [centre[0] + out[0], centre[1] + out[1], start[2]],
      velocity: [rate * on[0], rate * on[1], 0], acceleration: [-rate * rate * out[0], -rate * rate * out[1], 0] };
  };
  return Object.assign(path, { distance: Math.abs(rate) * Math.hypot(x, y) });
}

/** The straight segments from corner to corner. */
export const polyline = (points) => points.slice(1).map((goal, i) => line(points[i], goal));

/** A path of points with one orientation along it. */
export const posePath = (path, R) => (s) => {
  const { position, velocity, acceleration } = path(s);
  return { pose: { R, p: position }, twist: [...velocity, 0, 0, 0], dtwist: [...acceleration, 0, 0, 0] };
};

/** A path followed on a schedule t -> [s, ds, dds], by the chain rule. */
export function trajectory(path, scaling, duration) {
  const target = (t) => {
    const [s, ds, dds] = scaling(t);
    const { pose, twist, dtwist, position, velocity, acceleration } = path(s);
    const bend = (first, second) => second.map((x, i) => x * (ds * ds) + first[i] * dds);
    return pose ? { pose, twist: scale(ds, twist), dtwist: bend(twist, dtwist) }
      : { position, velocity: scale(ds, velocity), acceleration: bend(velocity, acceleration) };
  };
  return Object.assign(target, { duration, path, scaling });
}

/** Stay at joint angles or at a pose. */
export const hold = (place, duration) => Object.assign(() => (place.p
  ? { pose: place, twist: zeros(6), dtwist: zeros(6) }
  : { position: place, velocity: zeros(place.length), acceleration: zeros(place.length) }), { duration, place });

/** Trajectories one after another; where two meet, the later one counts. */
export function chain(parts) {
  const starts = parts.map((_, i) => parts.slice(0, i).reduce((sum, part) => sum + part.duration, 0));
  const target = (t) => {
    let i = starts.length - 1;
    while (i > 0 && starts[i] > t) i -= 1;
    return parts[i](t - starts[i]);
  };
  return Object.assign(target, { parts, duration: starts.at(-1) + parts.at(-1).duration });
}

/** The largest first and second derivative of each shape on [0, 1]. */
const PEAKS = { "bang-bang": [2, 4], cubic: [1.5, 6], quintic: [1.875, 10 / Math.sqrt(3)] };
export const SCALINGS = [...Object.keys(PEAKS), "trapezoid"];

/** The fastest schedule of a shape that keeps both limits on a path of this length. */
export function within(shape, distance, speed, acceleration) {
  if (shape === "trapezoid") {
    return { scaling: (t) => trapezoid(distance, speed, acceleration, t), duration: trapezoidDuration(distance, speed, acceleration) };
  }
  const [v, a] = PEAKS[shape];
  const duration = Math.max((v * distance) / speed, Math.sqrt((a * distance) / acceleration));
  return { scaling: (t) => profile(shape, duration, t), duration };
}
