// The drawing of a robot and its surroundings, which does not depend on time or on a kernel.
// The replay, the live arm of the notebook and the live arm of the book all use it.
import * as THREE from "three";
import { Body, span } from "./body.js";
import { frames, joints, posture, tip } from "./kinematics.js";
import { arrow, dispose } from "./marks.js";
import { Stage } from "./stage.js";
import { place, thing } from "./things.js";
import { apply, subtract, transpose } from "./so3.js";

const REACH = 0.25; // the largest distance in metres by which an arrow is moved out of the arm
const NEAR = 0.035; // distance from the tip in metres within which a pointer selects the tip
const LOOK = 80; // ms between two checks of what is under a pointer that holds nothing

export class Picture {
  /** A picture inside `host`; if `this.works` is false, WebGL is missing and nothing else may be called. */
  constructor(host, label) {
    this.stage = new Stage(host, label);
    this.works = this.stage.works;
    this.arrows = {};
    this.things = {};
    this.side = "left";
  }

  /** Draw this robot from now on. */
  embody(robot) {
    if (robot === this.robot) return;
    this.robot = robot;
    if (this.body) { this.stage.scene.remove(this.body.root); this.body.dispose(); }
    this.body = new Body(robot);
    this.stage.scene.add(this.body.root);
    this.stage.floor.position.z = robot.arm ? 0 : -0.925; // Baxter's base is its waist
    this.stage.rig.size = robot.arm ? Math.min(1, 0.5 * span(robot)) : 1;
  }

  /** Set the arm's present joint angles, n numbers in rad. */
  pose(side, q) {
    Object.assign(this, { side, q });
    this.body.pose(side, q);
    this.frames = frames(this.robot, posture(this.robot, side, q));
    this.tip = tip(this.robot, side, q);
    this.stage.draw();
  }

  /** A see-through arm: {pose(q), remove()}. */
  ghost(side, colour) {
    const body = new Body(this.robot, { side, colour });
    this.stage.scene.add(body.root);
    return { pose: (q) => body.pose(side, q), remove: () => { this.stage.scene.remove(body.root); body.dispose(); } };
  }

  /**
   * Draw the arrow `name` from a point along a vector, both in metres, with a text at its end; a
   * zero vector hides it.
   */
  arrow(name, origin, vector, text = "", colour = 0xc77700) {
    this.arrows[name] ??= this.made(name, colour);
    const a = this.arrows[name];
    a.mark.lay(origin, vector);
    a.end = Math.hypot(...vector) > 1e-4 ? origin.map((x, k) => x + vector[k]) : null;
    if (a.label.element.textContent !== text) a.label.element.textContent = text;
    this.stage.draw();
  }

  made(name, colour) {
    const mark = arrow(colour);
    this.stage.scene.add(mark);
    const made = { mark, end: null };
    made.label = this.stage.label("", () => made.end && made.label.element.textContent ? made.end : null,
      `#${colour.toString(16).padStart(6, "0")}`);
    return made;
  }

  /** Let the view "Motion" show the arm from its elbow to its tip, and these points [x, y, z]. */
  look(points) {
    const { rig } = this.stage;
    rig.mirror = this.side === "right" ? -1 : 1;
    rig.around([...points, this.tip.p, this.frames[`${this.side}_e1`]?.p ?? this.tip.p]);
    rig.use("Motion");
  }

  /**
   * Draw the things around the arm, {name: {kind, position, quaternion, size, colour, to}}, with
   * the kinds of things.js.  Things that are left out are removed; things that only moved are moved.
   */
  furnish(given) {
    for (const name of Object.keys(this.things)) if (!given[name]) this.drop(name);
    for (const [name, data] of Object.entries(given)) {
      const key = JSON.stringify([data.kind, data.size, data.colour]);
      if (this.things[name]?.key !== key) {
        this.drop(name);
        const mark = thing(data);
        mark.traverse((part) => { part.userData.thing = name; });
        this.stage.scene.add(mark);
        this.things[name] = { key, mark };
      }
      place(this.things[name].mark, data, this.tip?.p);
    }
    this.stage.draw();
  }

  drop(name) {
    if (!this.things[name]) return;
    this.stage.scene.remove(this.things[name].mark);
    dispose(this.things[name].mark);
    delete this.things[name];
  }

  /**
   * What a pointer points at: {thing, at}, {link, local, at} or null.  `link` is the number of the
   * joint that moves the link, `local` the point in the link's frame, `at` the point in the base frame.
   * The tip is a separate link with the number n.  Pointing near the tip selects it, even between its
   * fingers, and even if the target, a band or a wall is drawn in front of it.
   */
  pick(event) {
    const caster = this.stage.ray(event);
    const names = joints(this.robot, this.side);
    const solid = [...Object.values(this.things).map((t) => t.mark), ...names.map((n) => this.body.groups[n])];
    const hit = caster.intersectObjects(solid.filter((part) => part.visible), true)
      .find(({ object }) => object.userData.thing !== undefined || linkOf(object, this.body, names) >= 0);
    const near = Math.hypot(...subtract(this.dragged(event, this.tip.p), this.tip.p)) < NEAR;
    if (near && (!hit || hit.object.userData.thing !== undefined)) return this.atTip();
    if (!hit) return null;
    const at = hit.point.toArray();
    if (hit.object.userData.thing !== undefined) return { thing: hit.object.userData.thing, at };
    const link = linkOf(hit.object, this.body, names);
    if (link === names.length - 1 && Math.hypot(...subtract(at, this.tip.p)) < 0.06) return this.atTip();
    return { link, local: this.inLink(link, at), at };
  }

  /** The tip in the form that `pick` returns. */
  atTip() { return { link: joints(this.robot, this.side).length, local: [0, 0, 0], at: this.tip.p }; }

  /** The point where a vector from inside the arm leaves its surface, so that an arrow there is visible. */
  outside(at, along) {
    const way = new THREE.Vector3(...along).normalize(), far = new THREE.Vector3(...at).addScaledVector(way, REACH);
    const parts = joints(this.robot, this.side).map((name) => this.body.groups[name]);
    const [hit] = new THREE.Raycaster(far, way.negate(), 0, REACH).intersectObjects(parts, true);
    return hit ? hit.point.toArray() : at;
  }

  inLink(link, at) {
    const { R, p } = this.frames[joints(this.robot, this.side)[link]];
    return apply(transpose(R), subtract(at, p));
  }

  /** The point under the pointer on the plane through `at` that faces the camera. */
  dragged(event, at) {
    const { ray } = this.stage.ray(event);
    const facing = this.stage.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, new THREE.Vector3(...at));
    return ray.intersectPlane(plane, new THREE.Vector3())?.toArray() ?? at;
  }

  /**
   * If `free(picked)` says that a thing can be moved, pass the pointer to `take(picked, event)`, which
   * returns {move, end}; elsewhere pointers turn the view.  The shape of the cursor shows which.
   */
  grab(take, free) {
    const { canvas, rig } = this.stage;
    const under = (event) => {
      const picked = this.pick(event);
      return picked && free(picked) ? picked : null;
    };
    canvas.classList.add("lk-grab"); // a finger on the canvas no longer scrolls the page
    rig.grab = (event) => {
      const picked = event.button ? null : under(event);
      return picked && take(picked, event);
    };
    let latest;
    canvas.addEventListener("pointermove", (event) => {
      latest = event;
      if (!event.buttons) this.looking ??= setTimeout(() => {
        this.looking = null;
        if (!latest.buttons) canvas.classList.toggle("lk-over", under(latest) !== null);
      }, LOOK);
    });
  }

  dispose() {
    clearTimeout(this.looking);
    this.stage.dispose();
  }
}

/** The number of the joint that moves an object, or -1 if it is not a joint of this arm. */
function linkOf(object, body, names) {
  for (let part = object; part; part = part.parent) {
    const k = names.findIndex((name) => body.groups[name] === part);
    if (k >= 0) return k;
  }
  return -1;
}
