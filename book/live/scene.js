// The things that the tip can meet: walls and tables that push, springs, hands; `labkit/scene.py`.
// Each returns {act}, a function of a point {p, v} of the arm and of the step dt.  It returns null or
// {force, damping, outwards}, where the force is f0 - D v at the end of the step.
// A thing acts on its `place` {link, local} on the arm; without a `place` it acts on the tip.
import { dot, length, scale, subtract } from "./algebra.js";
import { cross } from "./space.js";

const outer = (a, b, s = 1) => a.map((x) => b.map((y) => s * x * y));
const plus = (A, B) => A.map((row, i) => row.map((x, j) => x + B[i][j]));
const diagonal = (s) => [[s, 0, 0], [0, s, 0], [0, 0, s]];

/** A flat solid face {point, normal, size, stiffness, damping, friction}; `pad` is the rubber of the finger. */
export function wall({ point, normal, size, stiffness, damping, friction }, pad) {
  const n = scale(1 / length(normal), normal);
  const side = cross(Math.abs(n[1]) < 0.9 ? [0, 1, 0] : [0, 0, 1], n);
  const x = scale(1 / length(side), side), y = cross(n, x);
  const k = 1 / (1 / stiffness + 1 / pad.stiffness), d = damping + pad.damping;
  const act = ({ p, v }, dt) => {
    const at = subtract(p, point), depth = pad.radius - dot(n, at);
    const press = k * depth - d * dot(n, v);
    const beside = Math.max(Math.abs(dot(x, at)) / size[0], Math.abs(dot(y, at)) / size[1]) > 0.5;
    if (beside || press <= 0 || !(depth > 0 && depth < pad.radius + pad.face)) return null;
    const across = plus(diagonal(1), outer(n, n, -1));
    const slide = length(across.map((row) => dot(row, v)));
    const drag = (friction * press) / Math.max(slide, pad.creep);
    const all = plus(outer(n, n, d + k * dt), across.map((row) => scale(drag, row)));
    return { force: scale(k * depth, n), damping: all, outwards: n };
  };
  return { act };
}

/** A spring between the tip and an anchor, with a rest length of zero. */
export const spring = ({ anchor, stiffness, damping, place }) => ({
  place,
  act: ({ p }, dt) => ({ force: scale(stiffness, subtract(anchor, p)), damping: diagonal(damping + stiffness * dt) }) });

/** A hand that pushes with a constant force, however far the arm moves. */
export const push = (force) => ({ act: () => ({ force, damping: diagonal(0) }) });
