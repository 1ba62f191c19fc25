// The torques of motors, dry friction and stops at the joints in one physics step; `labkit/joints.py`.
import { add, apply, applyTransposed, cut, dot, identity, inverse, scale, solve, subtract, timesTransposed, transpose, zeros } from "./algebra.js";

// The cases for a joint: at its lower stop, with the largest torque upwards, at its target speed, with
// the largest torque downwards, at its upper stop.
const STICK = 3;
const ROUNDING = 1e-14, TOGETHER = 20, ROUNDS = 200;

/**
 * Torques y for which the speeds u + G y are the target's as far as the bounds allow, and the case of
 * each joint.  Torque over speed is a falling staircase, so the solution is unique.
 */
export function jointTorques(G, u, target, bound, slowest, fastest, guess) {
  const n = u.length, unit = identity(n);
  const stairs = u.map((_, i) => {
    const goal = Math.min(Math.max(target[i], slowest[i]), fastest[i]);
    return [Infinity, slowest[i], bound[i], goal, -bound[i], fastest[i], -Infinity];
  });
  const stands = [...guess];
  let y = zeros(n);
  for (let round = 0; round < ROUNDS; round++) {
    const held = stands.map((k) => k % 2 === 1); // then the speed is given, otherwise the torque
    const given = stands.map((k, i) => (held[i] ? stairs[i][k] - u[i] : stairs[i][k]));
    y = held.some(Boolean) ? solve(held.map((h, i) => (h ? G[i] : unit[i])), given) : given;
    const v = add(u, apply(G, y));
    let wrong = false;
    for (let i = 0; i < n; i++) {
      const k = stands[i], before = stairs[i][k - 1], after = stairs[i][k + 1];
      const move = k % 2
        ? (y[i] < after) - (y[i] > before)
        : (v[i] > after + ROUNDING) - (v[i] < before - ROUNDING);
      if (!move) continue;
      stands[i] += move;
      wrong = true;
      if (round >= TOGETHER) break; // in later rounds one joint at a time
    }
    if (!wrong) break;
  }
  return { y, stands };
}

export class Joints {
  /** The joints of an arm with `model`, in steps of `dt` [s]. */
  constructor(model, dt, quick) {
    const { bodies } = model.robot;
    Object.assign(this, { model, dt, lower: bodies.map((b) => b.lower), upper: bodies.map((b) => b.upper), reach: quick * dt });
    this.reset();
  }

  reset() { this.stands = this.lower.map(() => STICK); }

  /** The torques in this step: `tau` is the whole torque on the joints, `held` that of the drive within its bound. */
  solve(q, dq, drive, touches) {
    const { model, dt } = this;
    const tau = subtract(drive.tau, model.plant.viscous.map((d, i) => d * dq[i]));
    const inside = q.every((x, i) => x > this.lower[i] + this.reach && x < this.upper[i] - this.reach);
    if (inside && !touches.length && drive.bound.every((b) => b === 0)) return { held: drive.bound, tau };
    const h = model.bias(q, dq), M = model.massMatrix(q).map((row) => scale(1 / dt, row));
    const touched = touches.length ? pressed(dq, tau, touches) : { push: tau };
    const { D, push } = touched;
    const G = inverse(D ? M.map((row, i) => add(row, D[i])) : M);
    const u = add(dq, apply(G, subtract(push, h)));
    const stops = [this.lower, this.upper].map((end) => end.map((x, i) => (x - q[i]) / dt));
    const { y, stands } = jointTorques(G, u, drive.speed, drive.bound, ...stops, this.stands);
    let force = push;
    if (D) {
      const a = apply(G, add(subtract(push, h), y));
      const speeds = add(dq, a);
      const kept = touches.filter((touch) => pushes(touch, apply(touch.J, speeds)));
      if (kept.length < touches.length) return this.solve(q, dq, drive, kept); // the tip has left the other faces
      force = subtract(push, apply(D, a));
      this.felt = touches.map((touch) => subtract(touch.force, apply(touch.damping, apply(touch.J, speeds))));
    }
    this.stands = stands;
    return { held: cut(y, drive.bound), tau: add(force, y), touches };
  }
}

/** Forces f = f0 - D v, with v = J dq at the end of the step, as torques and damping of the joints. */
function pressed(dq, tau, touches) {
  let push = tau, D = null;
  for (const { J, force, damping } of touches) {
    const columns = transpose(J), own = timesTransposed(columns, timesTransposed(columns, damping));
    push = add(push, applyTransposed(J, force));
    D = D ? D.map((row, i) => add(row, own[i])) : own;
  }
  return { D, push: subtract(push, apply(D, dq)) };
}

/** A face pushes and never pulls. */
const pushes = ({ force, damping, outwards }, v) => !outwards || dot(outwards, subtract(force, apply(damping, v))) >= 0;


