// The task of following a tag, which moves or is dragged: a camera sees it, and the tip moves to the aim.
import { add, apply, dampedInverse, scale, subtract } from "./algebra.js";
import { inverseKinematics } from "./inverse.js";
import { Model } from "./model.js";
import { ROBOT, TAG } from "./numbers.js";
import { gaussian } from "./random.js";
import { MOVES, Sight } from "./tag.js";

export const CAMERA = { rate: 10, age: 0.1, sigma: 0.001, predict: true };
export const LAP = TAG.duration;

export class Chase {
  /** `ready` is the tip's pose over the tag's start; with `joints` the target has joint angles. */
  constructor({ move = "circle", tagSpeed = (2 * Math.PI * TAG.radius) / TAG.lap, camera = CAMERA }, ready, joints, seed) {
    Object.assign(this, { ready, joints, dragged: null, path: MOVES[move]({ speed: tagSpeed, radius: TAG.radius }),
      sight: new Sight(camera, gaussian(seed)), model: new Model(ROBOT), q: ROBOT.ready });
  }

  /** The tip's goal at time t, which is over the true position of the tag. */
  goal(t) { return add(this.ready.p, this.dragged ?? this.path(t)); }

  /** The target of the law, which comes from the camera's readings. */
  target(t) {
    this.sight.look(t, subtract(this.goal(t), this.ready.p));
    this.aimed = this.sight.aim(t);
    const v = this.sight.predict ? this.aimed.v : [0, 0, 0];
    const pose = { R: this.ready.R, p: add(this.ready.p, this.aimed.p) };
    const twist = [...v, 0, 0, 0];
    if (!this.joints) return { pose, twist, dtwist: scale(0, twist) };
    this.q = inverseKinematics(this.model, pose, this.q, ROBOT.ready);
    const velocity = apply(dampedInverse(this.model.tipJacobian(this.q), 0), twist);
    return { position: this.q, velocity, acceleration: scale(0, velocity) };
  }
}
