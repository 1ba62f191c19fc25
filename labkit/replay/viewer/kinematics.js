// Forward kinematics and Jacobian of the robot's tree of joints, each turning about its own z.
import { IDENTITY, aboutZ, add, apply, cross, fromQuaternion, multiply, subtract, transpose } from "./so3.js";

export const ARM = ["s0", "s1", "e0", "e1", "w0", "w1", "w2"];
export const NEUTRAL = [0, -0.55, 0, 0.75, 0, 1.26, 0];

/** Joint angles by name: one arm at q, the other at rest, the head straight. */
export function posture(side, q) {
  const other = side === "left" ? "right" : "left";
  const angles = { head_pan: 0 };
  ARM.forEach((joint, i) => {
    angles[`${side}_${joint}`] = q[i];
    angles[`${other}_${joint}`] = NEUTRAL[i];
  });
  return angles;
}

const compose = (A, B) => ({ R: multiply(A.R, B.R), p: add(A.p, apply(A.R, B.p)) });
const placed = (x) => ({ R: fromQuaternion(x.quaternion), p: x.position });

/** Frames {R, p} in the base of every joint, by name. */
export function frames(robot, angles) {
  const found = { base: { R: IDENTITY, p: [0, 0, 0] } };
  for (const joint of robot.joints) {
    const turn = { R: aboutZ(angles[joint.name] ?? 0), p: [0, 0, 0] };
    found[joint.name] = compose(compose(found[joint.parent], placed(joint)), turn);
  }
  return found;
}

/** The tool's pose {R, p} in the base. */
export function tip(robot, side, q) {
  const tool = robot.tips[side];
  return compose(frames(robot, posture(side, q))[tool.parent], placed(tool));
}

/** Seven columns (v, w): the tip's twist per unit joint speed, at the tip, in the base's axes. */
export function tipJacobian(robot, side, q) {
  const all = frames(robot, posture(side, q));
  const end = compose(all[robot.tips[side].parent], placed(robot.tips[side]));
  return ARM.map((joint) => {
    const { R, p } = all[`${side}_${joint}`];
    const axis = [R[2], R[5], R[8]];
    return [...cross(axis, subtract(end.p, p)), ...axis];
  });
}

/** The same columns in the tip's own axes: the body Jacobian. */
export function bodyJacobian(robot, side, q) {
  const turn = transpose(tip(robot, side, q).R);
  return tipJacobian(robot, side, q).map((c) => [...apply(turn, c.slice(0, 3)), ...apply(turn, c.slice(3))]);
}

/** Yoshikawa's measure, sqrt(det(J J^T)); the same in base and body axes. */
export function manipulability(columns) {
  const A = [...Array(6)].map((_, i) => [...Array(6)].map((_, j) =>
    columns.reduce((sum, c) => sum + c[i] * c[j], 0)));
  let det = 1;
  for (let k = 0; k < 6; k++) { // Gauss with pivots
    let best = k;
    for (let i = k + 1; i < 6; i++) if (Math.abs(A[i][k]) > Math.abs(A[best][k])) best = i;
    if (best !== k) { [A[k], A[best]] = [A[best], A[k]]; det = -det; }
    if (A[k][k] === 0) return 0;
    det *= A[k][k];
    for (let i = k + 1; i < 6; i++) {
      const f = A[i][k] / A[k][k];
      for (let j = k; j < 6; j++) A[i][j] -= f * A[k][j];
    }
  }
  return Math.sqrt(Math.max(0, det));
}
