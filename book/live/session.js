// One arm that follows its target again and again, is touched, and accepts new settings while it moves.
import { length, subtract } from "./algebra.js";
import { Arm } from "./arm.js";
import { Chase, LAP } from "./chase.js";
import { Model } from "./model.js";
import { CONSTANTS, ROBOT } from "./numbers.js";
import { gaussian, uniform } from "./random.js";
import { Loop } from "./run.js";
import { READY, lawOf, plantOf, targetOf, thingsOf } from "./settings.js";

export class Session {
  constructor(mujoco, settings, seed = 1) {
    Object.assign(this, { mujoco, seed, hands: [] });
    this.change(settings);
  }

  /** Use new settings; the arm keeps its position and its speed. */
  change(settings) {
    const before = this.arm, time = this.loop?.t ?? 0;
    this.settings = settings;
    const plant = plantOf(settings), chance = uniform(this.seed);
    this.arm = new Arm(this.mujoco, ROBOT, plant, CONSTANTS, gaussian(this.seed + 1));
    const { law, rate, joints } = lawOf(settings, this.arm.own);
    this.follow(settings, joints);
    this.loop = new Loop(this.arm, this.target, law, {
      rate, runaway: CONSTANTS.runaway, late: () => chance() < plant.lost_ticks });
    this.loop.k = Math.round(time / this.loop.period);
    this.arm.steps = this.loop.k * this.loop.steps;
    this.arm.reset(before?.q ?? settings.start ?? ROBOT.ready, before?.dq);
    before?.close();
    this.solid = thingsOf(settings);
  }

  /** Set the target of the law and the true goal: a known motion, which is repeated, or a tag. */
  follow(settings, joints) {
    if (settings.path === "tag") {
      const { dragged = null } = this.chase ?? {};
      this.chase = Object.assign(new Chase(settings, READY, joints, this.seed + 2), { dragged });
      Object.assign(this, { lap: LAP, target: (t) => this.chase.target(t), goal: (t) => this.chase.goal(t), turn: READY.R });
      return;
    }
    const target = targetOf(settings, joints), poses = targetOf(settings, false);
    this.chase = null;
    Object.assign(this, { lap: target.duration, target: (t) => target(t % this.lap), goal: (t) => poses(t % this.lap).pose.p,
      turn: poses(0).pose.R }); // one orientation along a path
  }

  /** Put everything back to the start. */
  restart() {
    this.loop.k = this.arm.steps = 0;
    if (this.chase) this.change(this.settings);
    this.arm.reset(this.settings.start ?? ROBOT.ready);
  }

  /** Set what may touch the arm now: the things around it, and hands. */
  touched() { this.arm.things = [...this.solid, ...this.hands]; }

  /** Advance the arm by a time in [s], and return the values of each control tick. */
  advance(seconds) {
    const seen = [], end = this.loop.t + seconds - 1e-9;
    while (this.loop.t < end) {
      this.touched();
      const tick = this.loop.ask();
      this.loop.advance();
      seen.push(this.measured(tick));
    }
    return seen;
  }

  /** The values of a tick: positions of the tip and of its target, error, joint speed, forces. */
  measured({ t, q, dq, tau, command }) {
    const p = this.arm.own.pose(q).p, goal = this.goal(t);
    const off = subtract(goal, p);
    return { t, q, dq, tau, asked: command.value, aimed: this.chase?.aimed, p, goal, off, error: length(off), speed: Math.max(...dq.map(Math.abs)),
      forces: this.arm.forces.map(({ thing, p: at, force }) => ({ name: thing.name ?? "hand", at, force, size: length(force) })) };
  }

  close() { this.arm.close(); }
}

/** The place {link, local} on a link of a point in world axes, or null for the tip. */
export function placeOn(q, link, at) {
  if (link >= q.length) return null;
  const { joints } = new Model(ROBOT).frames(q), { R, p } = joints[link], d = subtract(at, p);
  return { link, local: [0, 1, 2].map((k) => R[k] * d[0] + R[3 + k] * d[1] + R[6 + k] * d[2]) };
}

/** The ticks of a whole run from the start, in the form of `measured`; pauses keep the page responsive. */
export async function wholeRun(mujoco, settings, seconds, { rest, stopped = () => false } = {}) {
  const session = new Session(mujoco, settings), ticks = [];
  try {
    while (session.loop.t < seconds && !stopped()) {
      ticks.push(...session.advance(0.1));
      if (rest) await rest();
    }
  } finally { session.close(); }
  return ticks;
}


