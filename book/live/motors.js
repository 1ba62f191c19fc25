// The motors' response to each kind of command in each physics step; `labkit/joints.py`.
import { cut, subtract, zeros } from "./algebra.js";

export class Motors {
  /** `own` is the arm's model of itself, which has its own weight but not the payload. */
  constructor(dt, plant, own, braking) {
    const { bodies } = own.robot;
    Object.assign(this, { dt, plant, own, braking, nothing: zeros(bodies.length),
      effort: bodies.map((b) => b.effort), speed: bodies.map((b) => b.speed), saturated: false });
  }

  /** Follow a command, limited to what the motors can do, from the next physics step. */
  follow({ kind, value }) {
    this.saturated = false;
    this.wanted = value;
    if (kind === "torque") this.wanted = this.within(value, this.effort);
    if (kind === "velocity") this.wanted = this.within(value, this.speed);
    if (kind !== this.kind) this.lagged = null;
    this.kind = kind;
    this.fresh = true;
  }

  within(x, most) {
    const kept = cut(x, most);
    this.saturated ||= kept.some((v, i) => v !== x[i]);
    return kept;
  }

  /** {tau: a fixed torque, speed: the speed to hold in addition, bound: the largest torque that holds it}. */
  drive(q, dq) {
    const { plant, nothing } = this;
    if (this.kind === "torque") {
      let tau = this.wanted;
      if (plant.gravity_compensation) {
        const g = this.own.gravity(q);
        tau = this.within(tau.map((x, i) => x + g[i]), this.effort);
      }
      return { tau, speed: nothing, bound: plant.stiction };
    }
    const speed = this.kind === "position" ? this.approach(q) : this.follows(dq);
    this.fresh = false;
    return { tau: nothing, speed, bound: this.effort };
  }

  /** The velocity mode follows its command with a lag. */
  follows(dq) {
    if (!this.plant.velocity_lag) return this.wanted;
    const share = Math.min(1, this.dt / this.plant.velocity_lag);
    const before = this.lagged ?? dq;
    return (this.lagged = before.map((x, i) => x + (this.wanted[i] - x) * share));
  }

  /** The position mode's speeds, from which the motors can still brake before the target. */
  approach(q) {
    if (this.fresh) {
      const M = this.own.massMatrix(q), g = this.own.gravity(q);
      this.brakes = g.map((x, i) => (this.braking * (this.effort[i] - Math.abs(x))) / M[i][i]);
    }
    const gain = Math.min(this.plant.position_gain || Infinity, 1 / this.dt);
    const gap = subtract(this.wanted, q);
    const stops = gap.map((x, i) => Math.sqrt(2 * this.brakes[i] * Math.abs(x)));
    return this.within(cut(gap.map((x) => gain * x), stops), this.speed);
  }
}
