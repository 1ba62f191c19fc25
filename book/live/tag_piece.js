// "Age, not noise": a tag that moves or is dragged, a slow camera, and a prediction that can do harm.
import { add, length, subtract } from "./algebra.js";
import { CAMERA, Chase } from "./chase.js";
import { corners } from "./corners.js";
import { TAG } from "./numbers.js";
import { CALM, Panel } from "./panel.js";
import { predictBox } from "./predict.js";
import { READY } from "./settings.js";

const MOVES = { conveyor: "a conveyor", circle: "a circle", hand: "a hand with sudden stops" };
const SECONDS = 8, TICK = 0.005;
const SETTINGS = { controller: "workspaceVelocity", path: "tag", move: "conveyor", tagSpeed: 0.06,
  camera: { ...CAMERA, age: 0.2, rate: 20, sigma: 0.0005, predict: false }, gains: {} };
const AIM = { title: "Distance from the aim to the tag [mm]", top: 20, value: (tick) => tick.miss };
const AGE = { title: "Speed of the tag times the age of the reading [mm]", top: 20, value: (tick) => tick.due };

/** The camera's readings of the tag for some seconds, without the arm, as ticks 5 ms apart. */
export function watched(settings, seconds = SECONDS) {
  const chase = new Chase(settings, READY, false, 3), ticks = [];
  let before = chase.goal(0);
  for (let k = 0; k * TICK < seconds; k++) {
    const t = k * TICK, goal = chase.goal(t), { pose } = chase.target(t);
    const speed = length(subtract(goal, before)) / TICK;
    before = goal;
    if (chase.sight.readings.length === 2) {
      ticks.push({ t, miss: 1000 * length(subtract(goal, pose.p)), due: 1000 * speed * chase.aimed.old });
    }
  }
  return ticks;
}

/** The root mean square of the aim's distance from the tag, in [mm]. */
export const miss = (settings) => {
  const ticks = watched(settings);
  return Math.sqrt(ticks.reduce((sum, tick) => sum + tick.miss ** 2, 0) / ticks.length);
};

class Age extends Panel {
  quantities() { return [AIM, AGE]; }

  parts(stagebox) {
    const { h, viewer } = this;
    const camera = (what) => this.change({ camera: { ...this.settings.camera, ...what } });
    const { camera: now, tagSpeed } = this.settings;
    this.predicted = predictBox(h, {
      question: "The tag rides on a conveyor at 60 mm/s, and the camera's readings are 200 ms old. By the equations alone, how far from the tag does the hand aim (as a root mean square)?",
      unit: "mm", commit: () => this.change({ ...this.settings, ...SETTINGS }), found: () => miss({ ...this.settings, ...SETTINGS }) });
    const move = viewer.choice({ label: "The tag on", values: Object.values(MOVES), value: MOVES[this.settings.move],
      onchange: (label) => { this.release(); this.change({ move: Object.keys(MOVES).find((k) => MOVES[k] === label) }); } });
    const box = h("input", { type: "checkbox", onchange: () => camera({ predict: box.checked }) });
    const dials = [
      this.dial({ label: "Age", unit: "ms", min: 0, max: 800, value: 1000 * now.age }, (x) => camera({ age: x / 1000 })),
      this.dial({ label: "Pictures", unit: "1/s", min: 2, max: 60, value: now.rate }, (rate) => camera({ rate })),
      this.dial({ label: "Noise", unit: "mm", min: 0, max: 5, value: 1000 * now.sigma }, (x) => camera({ sigma: x / 1000 })),
      this.dial({ label: "Tag's speed", unit: "mm/s", min: 10, max: 300, value: 1000 * tagSpeed }, (x) => this.change({ tagSpeed: x / 1000 }))];
    const steps = Object.entries({ "left": [0, 0.02, 0], "right": [0, -0.02, 0], "away": [0.02, 0, 0], "closer": [-0.02, 0, 0] });
    const keys = steps.map(([name, by]) => h("button", { type: "button", onclick: () => this.drag(add(this.session.chase.dragged ?? [0, 0, 0], by)) }, `${name} 2 cm`));
    this.table = h("table", { class: "lk-table" });
    const results = this.predicted.behind("Once you have entered a number above, the distance between the point aimed at and the tag appears here as a number, a curve and a table.",
      this.curves.element, this.said, h("div", { class: "lk-scroll", tabindex: 0 }, this.table));
    return [this.predicted.element, this.beside(stagebox, results, [this.fieldset("The camera", h("div", { class: "lk-dials" }, [dials[0].element, dials[2].element]),
      h("label", { class: "lk-check" }, box, "predict: continue the motion of the last two pictures"))]),
      this.folded(this.fieldset("The tag, which can be dragged", move.element, dials[3].element, dials[1].element, h("div", { class: "lk-pushes" }, keys))), corners(viewer)];
  }

  showGains() {}

  /** The points that the first view shows: the tag and the point over it, along the whole path. */
  inSight() {
    const over = [0, 0.25, 0.5, 0.75].map((s) => this.session.goal(s * this.session.lap));
    return over.concat(over.map((p) => subtract(p, TAG.offset)));
  }

  release() { this.session.chase.dragged = null; }
  drag(place) { this.session.chase.dragged = place.map((x) => Math.max(-0.15, Math.min(0.15, x))); }

  /** Draw three dots: the tag now, the tag as seen, and the aim. */
  more(now) {
    const at = (p) => add(subtract(add(READY.p, p), TAG.offset), [0, 0, 0.004]);
    const seen = now.aimed ?? { seen: [0, 0, 0], p: [0, 0, 0] };
    const low = subtract(now.goal, TAG.offset);
    this.picture.arrow("seen", at(seen.seen), subtract(low, at(seen.seen)), "as seen", 0x7b3fa0);
    this.picture.arrow("aim", add(READY.p, seen.p), [0, 0, -0.12], "aimed at", 0x0a5aa6);
    return {};
  }

  shown(now) {
    if (!now.aimed) return;
    const off = 1000 * length(subtract(now.goal, add(READY.p, now.aimed.p)));
    const words = [`t = ${now.t.toFixed(2)} s`, `reading ${(1000 * now.aimed.old).toFixed(0)} ms old`];
    if (this.predicted.said !== null) words.push(`aim ${off.toFixed(1)} mm from the tag`, `hand ${(1000 * now.error).toFixed(1)} mm from the tag`);
    this.numbers.textContent = words.join(" · ");
  }

  /** Draw the curve at once: it depends only on the camera, so no arm has to be simulated. */
  recompute() {
    const { h, settings } = this;
    this.curves.show(watched(settings));
    const row = (predict) => Object.keys(MOVES).map((move) => miss({ ...settings, move, camera: { ...settings.camera, predict } }).toFixed(1));
    const lines = [["as seen", row(false)], ["predicted", row(true)]];
    this.table?.replaceChildren(h("caption", {}, "Root mean square of the aim's distance from the tag [mm] with these dials"),
      h("thead", {}, h("tr", {}, h("td", {}, ""), Object.values(MOVES).map((name) => h("th", { scope: "col" }, name)))),
      h("tbody", {}, lines.map(([name, cells]) => h("tr", {}, h("th", { scope: "row" }, name), cells.map((x) => h("td", {}, x))))));
    const rms = miss(settings), { age, rate, predict } = settings.camera;
    const turn = settings.move === "circle" ? ` During the age of a picture the circle turns by ω T = ${((settings.tagSpeed / TAG.radius) * age).toFixed(2)}.` : "";
    this.said.textContent = `The hand aims ${rms.toFixed(1)} mm from the tag (root mean square); speed × mean age is ${(1000 * settings.tagSpeed * (age + 0.5 / rate)).toFixed(1)} mm.${turn}`;
    if (this.predicted.said !== null) this.say(`${predict ? "Predicted" : "As seen"}: ${this.said.textContent}`, CALM);
  }
}

export function tagPiece(host, config, ...given) {
  return new Age(host, { title: "Age, not noise", view: { azimuth: 0.2, elevation: 0.6 }, ...config, settings: { ...SETTINGS, ...config.settings } }, ...given);
}
