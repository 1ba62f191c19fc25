// The arm, which is the plant in the engine: read its state, set a command, advance the time; `labkit/arm.py`.
import { apply, zeros } from "./algebra.js";
import { Engine } from "./engine.js";
import { Joints } from "./joints.js";
import { Model } from "./model.js";
import { Motors } from "./motors.js";

export class Arm {
  /** `things` are {act, place}, see scene.js; `random` returns normally distributed numbers for the noise. */
  constructor(mujoco, robot, plant, constants, random = null) {
    Object.assign(this, { robot, plant, random, dt: constants.dt, steps: 0, things: [] });
    this.model = new Model(robot, plant);
    // The arm's own model does not include its payload; without a payload both models are the same.
    this.own = plant.payload > 0 ? new Model(robot, { ...plant, payload: 0 }) : this.model;
    this.engine = new Engine(mujoco, robot, plant, this.dt);
    this.joints = new Joints(this.model, this.dt, constants.quick);
    this.motors = new Motors(this.dt, plant, this.own, constants.braking);
    const noisy = plant.velocity_noise.some((x) => x > 0);
    this.every = plant.state_rate ? Math.round(1 / (plant.state_rate * this.dt)) : +(noisy || plant.state_delay > 0);
    this.reset(robot.ready);
  }

  /** Put the arm at q, at rest or with the speeds dq. */
  reset(q, dq = zeros(q.length)) {
    this.engine.place(q, dq);
    this.joints.reset();
    Object.assign(this, { q: [...q], dq: [...dq], torque: zeros(q.length), forces: [], reported: -1 });
    this.mail = [{ t: this.t, q: this.q, dq: this.dq }];
    this.motors.kind = null;
    this.stop();
  }

  get t() { return this.steps * this.dt; }
  stop() { this.follow({ kind: "velocity", value: zeros(this.q.length) }); }
  follow(command) { this.motors.follow(command); }

  /** The true state of the joints. */
  truth() { return { t: this.t, q: this.q, dq: this.dq }; }

  /** The state of the joints that the arm reports now, with the delay and the noise of the plant. */
  state() {
    if (!this.every) return this.truth();
    this.report();
    return this.newest();
  }

  /** The effect of a thing on its point of the arm; null if the thing does not reach the point. */
  touch(thing) {
    const { p, J } = this.model.point(this.q, thing.place ?? null);
    const touch = thing.act({ p, v: apply(J, this.dq) }, this.dt);
    return touch && { ...touch, J, p, thing };
  }

  /** One physics step. */
  step() {
    const { q, dq } = this;
    const touches = this.things.map((thing) => this.touch(thing)).filter(Boolean);
    if (this.every) this.report();
    const drive = this.motors.drive(q, dq);
    const given = this.joints.solve(q, dq, drive, touches);
    this.forces = (given.touches ?? []).map(({ thing, p }, i) => ({ thing, p, force: this.joints.felt[i] }));
    this.torque = this.motors.kind === "torque" ? drive.tau : given.held;
    this.engine.step(given.tau);
    [this.q, this.dq] = this.engine.state();
    this.steps += 1;
  }

  /** Send a report, if one is due at this physics step. */
  report() {
    if (this.steps % this.every || this.steps === this.reported) return;
    this.reported = this.steps;
    const noise = this.plant.velocity_noise;
    const dq = this.random ? this.dq.map((x, i) => x + noise[i] * this.random()) : this.dq;
    this.newest(); // deletes older reports that have arrived
    this.mail.push({ t: this.t, q: this.q, dq });
  }

  /** The newest report that has arrived. */
  newest() {
    while (this.mail.length > 1 && this.mail[1].t <= this.t - this.plant.state_delay + 1e-9) this.mail.shift();
    return this.mail[0];
  }

  close() { this.engine.close(); }
}
