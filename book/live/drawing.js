// The picture of a live panel, with the arm, its path, the things around it, and arrows for forces.
import { subtract } from "./algebra.js";
import { Form } from "./form.js";
import { hold } from "./hands.js";
import { quaternion } from "./model.js";
import { TAG } from "./numbers.js";
import { ELBOW, READY, wallAt } from "./settings.js";

const NEWTON = 0.006; // length of an arrow for 1 N, in metres

export class Drawing extends Form {
  draw3d(robot) {
    const { picture } = this;
    picture.embody(robot);
    picture.pose("left", this.session.arm.q);
    const { rig } = picture.stage;
    rig.around(this.inSight());
    Object.assign(rig.motion, this.config.view);
    rig.use("Motion");
    const target = (p) => this.change({ place: p.map((x, k) => Math.max(-0.15, Math.min(0.15, x - READY.p[k]))) });
    const wall = (p) => { const at = p[0] - READY.p[0]; this.walldial.set(1000 * at); this.change({ wall: at }); };
    const tag = (p) => { this.session.chase.dragged = subtract(p, READY.p).map((x, k) => (k === 2 ? 0 : x + TAG.offset[k])); };
    hold(picture, this.session, () => ({ wall, tag, ...(this.settings.path === "stay" && { target, spring: target }) }), () => this.pause(false));
    this.drawPath();
    this.ring = picture.stage.label("pull here", () => (this.session.chase && this.now ? subtract(this.now.goal, TAG.offset) : picture.tip.p));
    this.ring.element.classList.add("lk-ring");
  }

  /** The points that the first view shows: the target's path, and the arm from the elbow to the tip. */
  inSight() {
    const { arm, lap } = this.session, { joints } = arm.own.frames(arm.q);
    return [0, 0.25, 0.5, 0.75].map((s) => this.session.goal(s * lap)).concat([arm.own.pose(arm.q).p, joints[ELBOW].p]);
  }

  /** Draw the path of the target as a dashed line. */
  drawPath() {
    const { viewer, picture, session } = this;
    if (!picture.works) return;
    if (this.path) { picture.stage.scene.remove(this.path); viewer.dispose(this.path); }
    const rows = Array.from({ length: 121 }, (_, k) => session.goal((k / 120.001) * session.lap));
    this.path = viewer.line(rows, { colour: 0xc77700, width: 2.5, dash: 0.012, gap: 0.008 });
    this.path.visible = this.settings.path !== "stay";
    picture.stage.scene.add(this.path);
    picture.stage.draw();
  }

  /** Draw the arm in its present state, its surroundings, and the forces on it. */
  drawNow(now) {
    const { picture } = this;
    picture.pose("left", this.session.arm.q);
    this.furnish(now);
    if (this.ring && (this.session.chase?.dragged || now.forces.some(({ name }) => name !== "wall"))) this.ring = picture.stage.unlabel(this.ring);
    for (const name of ["hand", "push", "wall"]) {
      const force = now.forces.find((f) => f.name === name);
      picture.arrow(name, force?.at ?? now.p, force ? force.force.map((x) => NEWTON * x) : [0, 0, 0], force ? `${force.size.toFixed(1)} N` : "");
    }
  }

  furnish(now) {
    const [w, ...xyz] = quaternion(this.session.turn);
    const things = { target: { kind: "target", position: now.goal, quaternion: [...xyz, w] } };
    if (this.session.chase) things.tag = { kind: "tag", position: subtract(now.goal, TAG.offset), size: TAG.size };
    if (this.settings.controller === "workspaceImpedance") things.spring = { kind: "band", position: now.goal }; // the spring that the law simulates
    if (this.settings.wall !== undefined) {
      const { point, size } = wallAt(this.settings.wall);
      things.wall = { kind: "face", position: point, quaternion: [0, -Math.SQRT1_2, 0, Math.SQRT1_2], size };
    }
    this.picture.furnish({ ...things, ...this.more?.(now) });
  }
}
