// Makes an arm, a law and a target from the values of the dials.
import { add, scale } from "./algebra.js";
import * as laws from "./controllers.js";
import { jointTrajectory } from "./inverse.js";
import { Model } from "./model.js";
import { CONSTANTS, CONTROLLERS, PLANTS, ROBOT, TASK } from "./numbers.js";
import { hold, line } from "./paths.js";
import { wall } from "./scene.js";
import { PATHS, smooth } from "./tasks.js";

export const READY = new Model(ROBOT).pose(ROBOT.ready);
export const ELBOW = 3; // the joint e1
export const NAMES = {
  workspaceVelocity: "workspace velocity", jointVelocity: "joint velocity", jointTorque: "joint torque",
  workspaceImpedance: "workspace impedance", jointImpedance: "joint impedance", baxtersOwn: "Baxter's own (position mode)" };

/** The values of the plant's dials for an ideal and for a realistic arm. */
export const PRESETS = Object.fromEntries(Object.entries(PLANTS).map(([name, plant]) => [name, {
  plant: name, friction: +(name === "baxter"), noise: +(name === "baxter"), lag: 1000 * plant.velocity_lag,
  latency: 1000 * plant.state_delay, payload: plant.payload }]));

/** The plant that the dials describe; friction and noise are multiples of Baxter's. */
export function plantOf({ plant, friction, viscous = friction, noise, lag, latency, payload, positionGain }) {
  const real = PLANTS.baxter;
  return { ...PLANTS[plant], payload, velocity_lag: lag / 1000, state_delay: latency / 1000,
    position_gain: positionGain ?? PLANTS[plant].position_gain,
    stiction: scale(friction, real.stiction), viscous: scale(viscous, real.viscous),
    velocity_noise: scale(noise, real.velocity_noise), lost_ticks: noise * real.lost_ticks };
}

/** The gains of the comparison, changed by those of the dials. */
export function gainsOf({ plant, controller, gains = {}, start }) {
  const base = CONTROLLERS[plant][controller].gains, all = (x) => [x, x, x, x, x, x];
  const { Kp, Kd, K, Kx, Ky, Kz, stiffness, damping, zeta, lambda2, threshold } = gains;
  const made = { ...base };
  if (Kp !== undefined) made.Kp = base.Kp.length === 6 ? all(Kp) : Kp;
  if (Kd !== undefined) made.Kd = base.Kd.length === 6 ? all(Kd) : Kd;
  if (zeta !== undefined) made.zeta = zeta;
  if (lambda2 !== undefined) made.damping = lambda2;
  if (base.posture && start) made.posture = start;
  if (threshold !== undefined) made.threshold = threshold;
  if (base.zeta !== undefined) made.K = [Kx ?? K ?? base.K[0], Ky ?? K ?? base.K[1], Kz ?? K ?? base.K[2], ...base.K.slice(3)];
  if (base.D !== undefined) Object.assign(made, { K: scale(stiffness ?? 1, base.K), D: scale(damping ?? 1, base.D) });
  return made;
}

/** The controller, whose model does not include the payload, and the rate at which it is called. */
export function lawOf(settings, model) {
  const { plant, controller } = settings;
  return { law: laws[controller](model, gainsOf(settings)), ...CONTROLLERS[plant][controller] };
}

/** Paths that end where they begin, so that they can be followed again and again. */
const CLOSED = {
  ...PATHS,
  line: (p, task) => [line(p, add(p, task.line)), line(add(p, task.line), p)],
};
const kept = new Map(); // joint motions by their inputs, because inverse kinematics takes a while

/** A path outwards from the shoulder until the elbow is almost straight, and back. */
function stretch({ start, way }) {
  const from = new Model(ROBOT).pose(start);
  const paths = [line(from.p, add(from.p, way)), line(add(from.p, way), from.p)];
  return (shape, speed) => smooth(paths, from.R, { ...TASK, shape, speed, rest: 0.5 });
}

/** The target of poses of a path, or of joint angles: a function of time with a duration. */
export function targetOf({ path, shape = "quintic", speed = TASK.speed, place = [0, 0, 0], start, way }, joints) {
  const key = JSON.stringify([path, shape, speed, place, joints, start, way]);
  if (kept.has(key)) return kept.get(key);
  const made = path === "stay" ? hold({ R: READY.R, p: add(READY.p, place) }, 2.5)
    : path === "stretch" ? stretch({ start, way })(shape, speed)
    : smooth(CLOSED[path](READY.p, TASK), READY.R, { ...TASK, shape, speed, rest: 0.5 });
  const target = joints ? jointTrajectory(new Model(ROBOT), path === "stay" ? { parts: [made] } : made, ROBOT.ready, 101) : made;
  kept.set(key, target);
  return target;
}

/** A wall across x: its contact begins `distance` [m] before the ready tip. */
export const wallAt = (distance, stiffness = CONSTANTS.wall.stiffness) => ({
  ...CONSTANTS.wall, size: [0.3, 0.3], stiffness, normal: [-1, 0, 0],
  point: add(READY.p, [distance + CONSTANTS.pad.radius, 0, 0]) });

/** The things around the arm. */
export function thingsOf({ wall: at, wallStiffness }) {
  return at === undefined ? [] : [{ name: "wall", ...wall(wallAt(at, wallStiffness), CONSTANTS.pad) }];
}


