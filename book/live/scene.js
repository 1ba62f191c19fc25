// What the tip can meet: walls and tables that push, springs, hands; `labkit/scene.py`.
// Each gives {act}, a function of a point {p, v} of the arm and the step dt that returns
// {force, damping, outwards}, the force being f0 - D v at the end of the step, or null.
// A `place` {link, local} on it is where on the arm it acts; without one it is the tip.
import { dot, length, scale, subtract } from "./algebra.js";
import { cross } from "./space.js";

const outer = (a, b, s = 1) => a.map((x) => b.map((y) => s * x * y));
const plus = (A, B) => A.map((row, i) => row.map((x, j) => x + B[i][j]));
const diagonal = (s) => [[s, 0, 0], [0, s, 0], [0, 0, s]];

/** A flat solid face: {point, normal, size, stiffness, damping, friction}; `pad` is the finger's rubber. */
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

/** A spring of no length of its own between the tip and an anchor. */
export const spring = ({ anchor, stiffness, damping, place }) => ({
  place,
  act: ({ p }, dt) => ({ force: scale(stiffness, subtract(anchor, p)), damping: diagonal(damping + stiffness * dt) }) });

/** A hand that pushes with a force, whatever gives way. */
export const push = (force) => ({ act: () => ({ force, damping: diagonal(0) }) });
