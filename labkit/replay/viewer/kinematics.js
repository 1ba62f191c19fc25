// Forward kinematics and Jacobian of the robot's tree of joints, each of which turns about its z axis.
import { IDENTITY, aboutZ, add, apply, cross, fromQuaternion, multiply, subtract, transpose } from "./so3.js";

export const ARM = ["s0", "s1", "e0", "e1", "w0", "w1", "w2"];
export const NEUTRAL = [0, -0.55, 0, 0.75, 0, 1.26, 0];

/** The names of the joints in q, which are those of one of Baxter's arms or of a reader's own arm. */
export const joints = (robot, side) => robot.arm ?? ARM.map((joint) => `${side}_${joint}`);

/** Joint angles by name, with one arm at q, Baxter's other arm at rest and its head straight. */
export function posture(robot, side, q) {
  const angles = {};
  const put = (arm, values) => joints(robot, arm).forEach((joint, i) => { angles[joint] = values[i]; });
  if (!robot.arm) for (const arm of ["left", "right"]) put(arm, NEUTRAL);
  put(side, q);
  return angles;
}

const compose = (A, B) => ({ R: multiply(A.R, B.R), p: add(A.p, apply(A.R, B.p)) });
const placed = (x) => ({ R: fromQuaternion(x.quaternion), p: x.position });

/** The frames {R, p} of all joints in the base frame, by name. */
export function frames(robot, angles) {
  const found = { base: { R: IDENTITY, p: [0, 0, 0] } };
  for (const joint of robot.joints) {
    const turn = { R: aboutZ(angles[joint.name] ?? 0), p: [0, 0, 0] };
    found[joint.name] = compose(compose(found[joint.parent], placed(joint)), turn);
  }
  return found;
}

/** The tool's pose {R, p} in the base frame. */
export function tip(robot, side, q) {
  const tool = robot.tips[side];
  return compose(frames(robot, posture(robot, side, q))[tool.parent], placed(tool));
}

/** A column (v, w) for each joint: the tip's twist per unit of joint speed, in base axes at the tip. */
export function tipJacobian(robot, side, q) {
  const all = frames(robot, posture(robot, side, q));
  const end = compose(all[robot.tips[side].parent], placed(robot.tips[side]));
  return joints(robot, side).map((joint) => {
    const { R, p } = all[joint];
    const axis = [R[2], R[5], R[8]];
    return [...cross(axis, subtract(end.p, p)), ...axis];
  });
}

/** The same columns in the tip's own axes: the body Jacobian. */
export function bodyJacobian(robot, side, q) {
  const turn = transpose(tip(robot, side, q).R);
  return tipJacobian(robot, side, q).map((c) => [...apply(turn, c.slice(0, 3)), ...apply(turn, c.slice(3))]);
}

/** Yoshikawa's measure, sqrt(det(J J^T)), which is the same in base and body axes. */
export function manipulability(columns) {
  const A = [...Array(6)].map((_, i) => [...Array(6)].map((_, j) =>
    columns.reduce((sum, c) => sum + c[i] * c[j], 0)));
  let det = 1;
  for (let k = 0; k < 6; k++) { // Gaussian elimination with pivots
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
