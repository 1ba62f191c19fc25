// The smooth curve through given values, a quintic spline without knots at its second and third value.
import { scale, subtract, zeros } from "./algebra.js";

const DEGREE = 5;

/** The B-splines of a degree that do not vanish at x, and the number of the first one. */
function basis(knots, degree, x) {
  let k = degree;
  while (k < knots.length - degree - 2 && x >= knots[k + 1]) k += 1;
  let values = [1];
  for (let d = 1; d <= degree; d++) {
    const next = zeros(d + 1);
    values.forEach((value, r) => {
      const low = knots[k - d + 1 + r], high = knots[k + 1 + r];
      next[r] += ((high - x) / (high - low)) * value;
      next[r + 1] += ((x - low) / (high - low)) * value;
    });
    values = next;
  }
  return { first: k - degree, values };
}

function value(knots, degree, coefficients, x) {
  const { first, values } = basis(knots, degree, x);
  return values.map((b, r) => scale(b, coefficients[first + r])).reduce((a, b) => a.map((v, i) => v + b[i]));
}

/** Solve a banded system in place; B-splines need no pivots. */
function banded(rows, right, band) {
  const n = rows.length;
  for (let k = 0; k < n; k++) {
    for (let i = k + 1; i < Math.min(n, k + band); i++) {
      const share = rows[i][k] / rows[k][k];
      if (share === 0) continue;
      for (let j = k; j < Math.min(n, k + 2 * band); j++) rows[i][j] -= share * rows[k][j];
      right[i] = subtract(right[i], scale(share, right[k]));
    }
  }
  for (let k = n - 1; k >= 0; k--) {
    for (let j = k + 1; j < Math.min(n, k + 2 * band); j++) right[k] = subtract(right[k], scale(rows[k][j], right[j]));
    right[k] = scale(1 / rows[k][k], right[k]);
  }
  return right;
}

/** A path of points through `values` at `s`, rising from 0 to 1; at least six of them. */
export function spline(s, values) {
  const ends = (x) => new Array(DEGREE + 1).fill(x);
  let knots = [...ends(s[0]), ...s.slice(3, -3), ...ends(s.at(-1))];
  const rows = s.map((x) => {
    const row = zeros(s.length), { first, values: b } = basis(knots, DEGREE, x);
    b.forEach((v, r) => { row[first + r] = v; });
    return row;
  });
  let coefficients = banded(rows, values.map((v) => [...v]), DEGREE + 1);
  const starts = [s[0], ...s.slice(3, -3)];
  const taylor = []; // for each derivative, its value at the start of each piece, divided by the factorial
  for (let degree = DEGREE, factorial = 1; degree >= 0; degree--) {
    taylor.push(starts.map((x) => scale(1 / factorial, value(knots, degree, coefficients, x))));
    const before = knots, d = degree;
    coefficients = coefficients.slice(1).map((c, i) =>
      scale(d / (before[i + d + 1] - before[i + 1]), subtract(c, coefficients[i])));
    knots = knots.slice(1, -1);
    factorial *= DEGREE - degree + 1;
  }
  return (x) => {
    let low = 0, high = starts.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (starts[middle] <= x) low = middle; else high = middle;
    }
    const h = x - starts[low], c = taylor.map((of) => of[low]);
    const sum = (make) => c[0].map((_, i) => make((k) => c[k][i]));
    return {
      position: sum((a) => a(0) + h * (a(1) + h * (a(2) + h * (a(3) + h * (a(4) + h * a(5)))))),
      velocity: sum((a) => a(1) + h * (2 * a(2) + h * (3 * a(3) + h * (4 * a(4) + h * 5 * a(5))))),
      acceleration: sum((a) => 2 * a(2) + h * (6 * a(3) + h * (12 * a(4) + h * 20 * a(5)))) };
  };
}
