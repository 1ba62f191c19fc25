// A run, which closes the loop of arm, target and controller in each tick; `labkit/run.py`.

/** Joints faster than this, in [rad/s], are out of control. */
export class Diverged extends Error {}

export class Loop {
  /** The loop calls `controller` `rate` times a second; `late()` says whether a tick's command is lost. */
  constructor(arm, target, controller, { rate, runaway, late = () => false }) {
    Object.assign(this, { arm, target, controller, runaway, late, k: 0, steps: Math.round(1 / (rate * arm.dt)) });
    this.period = this.steps * arm.dt;
    this.often = Math.max(1, Math.round(0.005 / this.period));
  }

  get t() { return this.k * this.period; }

  /** Call the controller and let the arm follow its command. */
  ask() {
    const { arm } = this;
    const sample = this.target(this.t), truth = arm.truth();
    const command = this.controller(arm.state(), sample);
    const speed = Math.hypot(...truth.dq);
    if (this.k % this.often === 0 && !(speed <= this.runaway)) throw new Diverged(`the arm went out of control at t = ${this.t.toFixed(3)} s`);
    if (!this.late()) arm.follow(command);
    return { t: this.t, q: truth.q, dq: truth.dq, tau: arm.torque, sample, command };
  }

  /** Advance the physics by one control period. */
  advance() {
    for (let i = 0; i < this.steps; i++) this.arm.step();
    this.k += 1;
  }
}

/** A whole run of `duration` seconds, as a list of its ticks. */
export function run(arm, target, controller, options) {
  const loop = new Loop(arm, target, controller, options);
  const last = Math.round((options.duration ?? target.duration) / loop.period + 1e-9);
  const log = [loop.ask()];
  while (loop.k < last) {
    loop.advance();
    log.push(loop.ask());
  }
  return log;
}
