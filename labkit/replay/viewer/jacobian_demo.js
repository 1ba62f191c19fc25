// Live demo of the Jacobian: seven joint sliders, the tip's pose, and the columns as arrows and numbers.
import { Body } from "./body.js";
import { ARM, NEUTRAL, bodyJacobian, frames, manipulability, posture, tip, tipJacobian } from "./kinematics.js";
import { arrow, axes } from "./marks.js";
import { Stage } from "./stage.js";
import { choice, dial, fixed, h } from "./dom.js";
import { toEuler } from "./so3.js";

const ROWS = ["vx", "vy", "vz", "ωx", "ωy", "ωz"];
const SEEN = 0.25; // length of an arrow in metres for 1 m/s or 1 rad/s

export class JacobianDemo {
  constructor(host, { side = "left" }, robot) {
    Object.assign(this, { host, side, robot });
    const redraw = () => this.draw();
    const joint = (name) => robot.joints.find((j) => j.name === `${side}_${name}`);
    this.dials = ARM.map((name, i) => dial({
      label: name, unit: "rad", min: joint(name).lower, max: joint(name).upper, value: NEUTRAL[i], oninput: redraw }));
    this.column = choice({ label: "Column", values: ARM, value: "s1", onchange: redraw });
    this.frame = choice({ label: "Axes", values: ["base (at the tip)", "tip (body)"], onchange: redraw });
    this.stagebox = h("div", { class: "lk-stage" });
    this.table = h("table", { class: "lk-table" });
    this.words = h("p", { class: "lk-readout" });
    this.element = h("div", { class: "lk-demo", role: "group", "aria-label": "Jacobian, live" },
      this.stagebox, this.words,
      h("div", { class: "lk-dials" }, this.dials.map((d) => d.element), this.column.element, this.frame.element),
      h("div", { class: "lk-scroll", tabindex: 0, role: "region", "aria-label": "The Jacobian's numbers" }, this.table));
    host.append(this.element);
    this.stage = new Stage(this.stagebox, "Baxter with the chosen column of the Jacobian");
    if (this.stage.works) {
      this.body = new Body(robot);
      this.tool = axes(0.12);
      this.linear = arrow(0x0a5aa6);
      this.angular = arrow(0xc77700);
      this.axis = axes(0.16);
      this.stage.scene.add(this.body.root, this.tool, this.linear, this.angular, this.axis);
      this.stage.label("v", () => this.ends?.[0] ?? [0, 0, 0]);
      this.stage.label("ω", () => this.ends?.[1] ?? [0, 0, 0]);
      this.stage.rig.mirror = side === "left" ? 1 : -1;
      this.stage.rig.use("Front");
      this.stage.drawn = () => { host.dataset.ready = "1"; };
    } else {
      this.stagebox.append(h("p", { class: "lk-note" }, "This browser cannot draw in 3-D (WebGL is missing). The numbers below still follow the sliders."));
      host.dataset.ready = "1";
    }
    this.draw();
  }

  draw() {
    const q = this.dials.map((d) => d.get());
    const [{ R, p }, k] = [tip(this.robot, this.side, q), this.column.index()];
    const columns = tipJacobian(this.robot, this.side, q);
    if (this.stage.works) {
      this.body.pose(this.side, q);
      place(this.tool, { R, p });
      place(this.axis, frames(this.robot, posture(this.robot, this.side, q))[`${this.side}_${ARM[k]}`]);
      const [v, w] = [columns[k].slice(0, 3), columns[k].slice(3)].map((x) => x.map((c) => SEEN * c));
      this.linear.lay(p, v);
      this.angular.lay(p, w);
      this.ends = [v, w].map((x) => x.map((c, i) => c + p[i]));
      this.stage.draw();
    }
    const shown = this.frame.index() ? bodyJacobian(this.robot, this.side, q) : columns;
    const w = manipulability(columns);
    this.words.textContent = `Tip at x ${fixed(p[0])}, y ${fixed(p[1])}, z ${fixed(p[2])} m; roll, pitch, yaw ${toEuler(R).map((a) => a.toFixed(2)).join(", ")} rad. Manipulability ${w.toFixed(4)}${w < 0.005 ? ": close to a singularity." : "."}`;
    this.table.replaceChildren(
      h("caption", {}, `Jacobian, ${this.frame.get()} axes: twist of the tip per 1 rad/s of each joint`),
      h("thead", {}, h("tr", {}, h("td"), ARM.map((name, j) => h("th", { scope: "col", "aria-current": j === k && "true" }, name)))),
      h("tbody", {}, ROWS.map((row, i) => h("tr", {}, h("th", { scope: "row" }, row),
        shown.map((c, j) => h("td", { class: j === k && "lk-chosen" }, fixed(c[i])))))));
  }

  dispose() {
    this.stage.dispose();
    this.element.remove();
  }
}

function place(mark, { R, p }) {
  mark.matrixAutoUpdate = false;
  mark.matrix.set(R[0], R[1], R[2], p[0], R[3], R[4], R[5], p[1], R[6], R[7], R[8], p[2], 0, 0, 0, 1);
  mark.matrixWorldNeedsUpdate = true;
}
