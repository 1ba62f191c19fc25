// The viewer as one classic script for pages and notebooks.  It defines `labkitViewer`.
import { LiveArm } from "./live.js";
import { JacobianDemo } from "./jacobian_demo.js";
import { Player } from "./player.js";
import { RotationDemo } from "./rotation_demo.js";
import { dress } from "./style.js";

// For pages that have their own loop, such as the book's live arm.
export { choice, dial, h, steady, svg, unique } from "./dom.js";
export * as kinematics from "./kinematics.js";
export { Picture } from "./picture.js";
export { dispose, line } from "./marks.js";
export { Plot } from "./plots.js";
export { more, sight } from "./sight.js";
export * as so3 from "./so3.js";
export { dress };

const KINDS = {
  motion: (host, data, robot) => new Player(host, data, robot),
  live: (host, data, robot, link) => new LiveArm(host, data, robot, link),
  jacobian: (host, data, robot) => new JacobianDemo(host, data, robot),
  rotation: (host) => new RotationDemo(host),
};

/**
 * Builds the kind of view that `data.kind` names inside `host`; the result has dispose().  `link` is the
 * connection to a kernel.
 */
export function mount(host, data, link) {
  dress();
  const made = KINDS[data.kind](host, data, globalThis.labkitRobot, link);
  host.labkit = made;
  return made;
}
