// Joint angles for poses, and joint motions for motions of the tip; `labkit/inverse.py`.
import { add, apply, dampedInverse, dot, scale, subtract } from "./algebra.js";
import { chain, hold, trajectory } from "./paths.js";
import { spline } from "./spline.js";

export class Unreachable extends Error {}

/** The joint angles for a tip pose that are nearest to `posture`, found from q0 by the Gauss-Newton method. */
export function inverseKinematics(model, pose, q0, posture) {
  const { bodies } = model.robot;
  const inside = (x) => x.map((v, i) => Math.min(Math.max(v, bodies[i].lower), bodies[i].upper));
  let q = inside(q0);
  for (let round = 0; round < 200; round++) {
    const e = model.poseError(pose, q), square = dot(e, e), J = model.tipJacobian(q);
    const J_inv = dampedInverse(J, 1e-4 * Math.min(1, square)); // vanishes at the solution
    const wish = subtract(posture, q);
    const free = subtract(wish, apply(J_inv, apply(J, wish)));
    if (square < 1e-20 && dot(free, free) < 1e-18) return q;
    const step = add(apply(J_inv, e), free);
    const share = Math.min(1, 0.5 / Math.max(...step.map(Math.abs)));
    const moved = inside(add(q, scale(share, step)));
    if (square < 1e-20 && Math.max(...subtract(moved, q).map(Math.abs)) < 1e-9) return q;
    q = moved;
  }
  const e = model.poseError(pose, q);
  if (dot(e, e) < 1e-18) return q;
  throw new Unreachable(`the pose at ${pose.p.map((x) => x.toFixed(3)).join(", ")} m cannot be reached from here`);
}

/** The joint motion that moves the tip along a target of poses and stays near q0. */
export function jointTrajectory(model, target, q0, samples) {
  if (!target.parts) return follow(model, target, q0, q0, samples);
  let q = q0;
  return chain(target.parts.map((part) => {
    const joints = follow(model, part, q, q0, samples);
    q = joints(joints.duration).position;
    return joints;
  }));
}

function follow(model, target, q, posture, samples) {
  if (target.place) return hold(inverseKinematics(model, target.place, q, posture), target.duration);
  const grid = Array.from({ length: samples }, (_, k) => k / (samples - 1));
  const angles = grid.map((s) => (q = inverseKinematics(model, target.path(s).pose, q, posture)));
  return trajectory(spline(grid, angles), target.scaling, target.duration);
}
