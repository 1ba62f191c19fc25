// The viewer: one classic script for page and notebook.  Leaves `labkitViewer` behind.
import { Explorer } from "./explorer.js";
import { JacobianDemo } from "./jacobian_demo.js";
import { Player } from "./player.js";
import { RotationDemo } from "./rotation_demo.js";
import { ScalingDemo } from "./scaling_demo.js";
import { dress } from "./style.js";

// For pages that bring their own loop, such as the book's live arm.
export { choice, dial, h, unique } from "./dom.js";
export * as kinematics from "./kinematics.js";
export { Picture } from "./picture.js";
export { dispose, line } from "./marks.js";
export { Plot } from "./plots.js";
export { sight } from "./sight.js";
export * as so3 from "./so3.js";
export { dress };

const KINDS = {
  motion: (host, data, robot) => new Player(host, data, robot),
  explorer: (host, data, robot, load) => new Explorer(host, data, robot, load),
  jacobian: (host, data, robot) => new JacobianDemo(host, data, robot),
  scaling: (host) => new ScalingDemo(host),
  rotation: (host) => new RotationDemo(host),
};

/** Builds what `data.kind` says inside `host`; the result can dispose(). */
export function mount(host, data, load) {
  dress();
  const made = KINDS[data.kind](host, data, globalThis.labkitRobot, load);
  made.element.dataset.lmSuppressShortcuts = "true"; // JupyterLab's own keys stay out
  host.labkit = made;
  return made;
}
