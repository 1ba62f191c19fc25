// The five controllers of the course and Baxter's own controller, as in `solutions/study`.
//
// Each function takes a model and gains and returns a law, which takes the arm's state {t, q, dq} and
// the target's sample and returns a command.  Errors are target minus actual.
import { add, addDiagonal, apply, applyTransposed, dampedInverse, inverse, isPositive, root, scale, smallestSingularValue,
  solveMatrix, subtract, times, timesTransposed, transpose } from "./algebra.js";

export const position = (value) => ({ kind: "position", value });
export const velocity = (value) => ({ kind: "velocity", value });
export const torque = (value) => ({ kind: "torque", value });

/** The fraction of the largest damping to use: 0 far from singularities, 1 at a singularity. */
export function nearness(J, threshold) {
  if (isPositive(addDiagonal(timesTransposed(J, J), -(threshold ** 2)))) return 0; // all singular values are above it
  return 1 - (smallestSingularValue(J) / threshold) ** 2;
}

/** Joint speeds by the damped inverse, for which a radian counts as much as `lever` metres. */
export function dampedSpeeds(J, V, lambda2, lever) {
  const counts = [1, 1, 1, lever, lever, lever];
  return apply(dampedInverse(J.map((row, i) => scale(counts[i], row)), lambda2), times(counts, V));
}

/** u = J^+ (V_d + Kp e + Kd (V_d - J dq)) + (I - J^+ J) k (q_posture - q). */
export const workspaceVelocity = (model, { Kp, Kd, posture, pull, damping, lever, threshold }) => (state, target) => {
  const { q, dq } = state;
  const J = model.tipJacobian(q);
  const e = model.poseError(target.pose, q);
  const V = add(add(target.twist, times(Kp, e)), times(Kd, subtract(target.twist, apply(J, dq))));
  const wish = scale(pull, subtract(posture, q));
  const exact = dampedInverse(J, 0);
  const free = subtract(wish, apply(exact, apply(J, wish))); // the part of the wish that does not move the tip
  const lambda2 = nearness(J, threshold) * damping;
  return velocity(add(free, lambda2 ? dampedSpeeds(J, V, lambda2, lever) : apply(exact, V)));
};

/** u = dq_d + Kp e + Kd de. */
export const jointVelocity = (model, { Kp, Kd }) => (state, target) => {
  const e = subtract(target.position, state.q), de = subtract(target.velocity, state.dq);
  return velocity(add(target.velocity, add(times(Kp, e), times(Kd, de))));
};

/** tau = M (ddq_d + Kd de + Kp e) + C dq + g: computed torque. */
export const jointTorque = (model, { Kp, Kd, gravity }) => (state, target) => {
  const { q, dq } = state;
  const e = subtract(target.position, q), de = subtract(target.velocity, dq);
  const ddq = add(target.acceleration, add(times(Kd, de), times(Kp, e)));
  const tau = model.inverseDynamics(q, dq, ddq);
  return torque(gravity ? tau : subtract(tau, model.gravity(q)));
};

/** tau = J^T Lambda (dV_d + Lambda^-1 (D de + K e) - dJ dq) + C dq + g, and a posture term that does not move the tip. */
export const workspaceImpedance = (model, { K, zeta, gravity, posture, pull, damping, threshold }) => (state, target) => {
  const { q, dq } = state;
  const J = model.tipJacobian(q), M = model.massMatrix(q);
  const MJ = solveMatrix(M, transpose(J)); // M^-1 J^T
  const mobility = addDiagonal(timesTransposed(J, transpose(MJ)), nearness(J, threshold) * damping);
  const inertia = inverse(mobility); // Lambda
  const e = model.poseError(target.pose, q), de = subtract(target.twist, apply(J, dq));
  const F = add(times(K, e), apply(damper(inertia, K, zeta), de));
  const a = add(target.dtwist, apply(mobility, F));
  const free = subtract(scale(pull, subtract(posture, q)), scale(2 * Math.sqrt(pull), dq));
  const wrench = apply(inertia, subtract(subtract(a, model.drift(q, dq)), apply(J, free)));
  const tau = add(applyTransposed(J, wrench), add(apply(M, free), model.bias(q, dq)));
  return torque(gravity ? tau : subtract(tau, model.gravity(q)));
};

/** D = zeta (Lambda^1/2 K^1/2 + K^1/2 Lambda^1/2), so that the damping in each direction suits its inertia. */
function damper(inertia, K, zeta) {
  const A = root(inertia).map((row) => row.map((x, j) => x * Math.sqrt(K[j])));
  return A.map((row, i) => row.map((x, j) => zeta * (x + A[j][i])));
}

/** tau = M ddq_d + C dq_d + g + D de + K e: a spring and a damper at each joint. */
export const jointImpedance = (model, { K, D, gravity }) => (state, target) => {
  const { q, dq } = state;
  const e = subtract(target.position, q), de = subtract(target.velocity, dq);
  const motion = add(apply(model.massMatrix(q), target.acceleration), model.coriolisTimes(q, dq, target.velocity));
  const tau = add(motion, add(times(D, de), times(K, e)));
  return torque(gravity ? add(tau, model.gravity(q)) : tau);
};

/** Baxter's own controller: its server sends a target to the arm's position mode 100 times a second. */
export const baxtersOwn = () => (state, target) => position(target.position);
