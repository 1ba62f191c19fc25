// Time scalings s(t) with their first two derivatives, as in labkit.paths.

const SHAPES = {
  "bang-bang": (x) => (x < 0.5 ? [2 * x * x, 4 * x, 4] : [1 - 2 * (1 - x) ** 2, 4 * (1 - x), -4]),
  cubic: (x) => [x * x * (3 - 2 * x), 6 * x * (1 - x), 6 - 12 * x],
  quintic: (x) => [
    x ** 3 * (10 - 15 * x + 6 * x * x), 30 * (x * (1 - x)) ** 2, 60 * x * (1 - x) * (1 - 2 * x)],
};

/** [s, ds, dds] at time t of a shape stretched over a duration. */
export function profile(name, duration, t) {
  if (t >= duration) return [1, 0, 0];
  if (t < 0) return [0, 0, 0];
  const [s, ds, dds] = SHAPES[name](t / duration);
  return [s, ds / duration, dds / duration ** 2];
}

/** Duration of the trapezoid for a path of this length; on a short path it is a triangle. */
export function trapezoidDuration(distance, speed, acceleration) {
  const top = Math.min(speed, Math.sqrt(distance * acceleration));
  return distance === 0 ? 0 : distance / top + top / acceleration;
}

/** [s, ds, dds] at time t of the trapezoid whose limits hold along the path, in metres. */
export function trapezoid(distance, speed, acceleration, t) {
  const T = trapezoidDuration(distance, speed, acceleration);
  if (t >= T) return [1, 0, 0];
  if (t < 0) return [0, 0, 0];
  const top = Math.min(speed, Math.sqrt(distance * acceleration));
  const rise = top / acceleration;
  const a = acceleration / distance, v = top / distance;
  if (t < rise) return [(a * t * t) / 2, a * t, a];
  if (t < T - rise) return [v * (t - rise / 2), v, 0];
  return [1 - (a * (T - t) ** 2) / 2, a * (T - t), -a];
}
