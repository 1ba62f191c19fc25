// The fields of a live panel, with its choices, dials and push buttons.
import { ARM_DIALS, gainDials } from "./controls.js";
import { AXES, pushTip } from "./hands.js";
import { NAMES } from "./settings.js";
import { SCALINGS } from "./paths.js";

export const ARMS = { ideal: "ideal arm", baxter: "realistic arm" };
const PATHS = ["line", "circle", "square", "tag", "stay"];
const key = (names, label) => Object.keys(names).find((k) => names[k] === label);

export class Form {
  /** The parts in order: picture and curve side by side, then the controls; the rest is folded. */
  parts(stagebox) {
    const { controller, ...others } = this.choices(), bar = (...made) => this.h("div", { class: "lk-livebar" }, made.map((c) => c.element));
    return [this.beside(stagebox, [this.curves.element, this.said], [bar(controller), this.gainbox]),
      this.folded(this.hands(), bar(...Object.values(others)), ...this.surroundings())];
  }

  /** The picture with its buttons, beside it what it shows, and below it what changes it. */
  beside(stagebox, told, under = []) {
    const { h } = this;
    return h("div", { class: "lk-beside" }, h("div", {}, stagebox, this.buttons()), h("div", {}, told), h("div", {}, this.numbers, under));
  }

  folded(...parts) {
    return this.viewer.more(this.h("div", { class: "lk-bar" }, this.h("button", { type: "button", onclick: () => this.restart() }, "From the start")), ...parts, this.sight);
  }

  fieldset(name, ...children) { return this.h("fieldset", {}, this.h("legend", {}, name), ...children); }

  buttons() {
    this.play = this.h("button", { type: "button", class: "lk-play", onclick: () => this.pause(this.playing) }, "Pause");
    return this.h("div", { class: "lk-bar" }, this.play);
  }

  choices() {
    const { viewer, settings } = this;
    const only = this.config.controllers ?? Object.keys(NAMES);
    return {
      plant: viewer.choice({ label: "Arm", values: Object.values(ARMS), value: ARMS[settings.plant],
        onchange: (label) => this.preset(key(ARMS, label)) }),
      path: viewer.choice({ label: "Path", values: this.config.paths ?? PATHS, value: settings.path,
        onchange: (path) => this.change({ path }) }),
      controller: viewer.choice({ label: "Controller", values: only.map((name) => NAMES[name]), value: NAMES[settings.controller],
        onchange: (label) => { this.change({ controller: key(NAMES, label), gains: {} }); this.showGains(); } }),
      shape: viewer.choice({ label: "Time scaling", values: SCALINGS, value: settings.shape,
        onchange: (shape) => this.change({ shape }) }) };
  }

  dial(spec, oninput) { return this.viewer.dial({ ...spec, oninput }); }

  showGains() {
    const { plant, controller, gains } = this.settings;
    const dials = gainDials(plant, controller).map((spec) => this.dial({ ...spec, value: gains[spec.key] ?? spec.value },
      (x) => this.change({ gains: { ...this.settings.gains, [spec.key]: x } })));
    const none = "The position mode has no gains to choose: it moves to its target at the highest speed from which its motors can still brake.";
    this.gainbox.replaceChildren(...(dials.length ? dials.map((d) => d.element) : [this.h("p", { class: "lk-kept" }, none)]));
  }

  hands() {
    const { h } = this;
    const newtons = this.dial({ label: "Force", unit: "N", min: 1, max: 40, value: 10 }, () => {});
    const push = (axis) => { pushTip(this.session, axis, newtons.get()); this.pause(false); this.say(`Pushing the tip with ${newtons.get()} N along ${axis} for a second.`); this.tell(900); };
    const buttons = Object.keys(AXES).map((axis) => h("button", { type: "button", "aria-label": `Push along ${axis}`, onclick: () => push(axis) }, axis));
    return this.fieldset("Push the tip, or drag the arm in the picture", newtons.element, h("div", { class: "lk-pushes" }, buttons));
  }

  surroundings() {
    const { h, settings } = this;
    this.armdials = Object.fromEntries(ARM_DIALS.map((spec) => [spec.key,
      this.dial({ ...spec, value: settings[spec.key] }, (x) => this.change({ [spec.key]: x }))]));
    const wall = this.dial({ label: "Wall at", unit: "mm", min: -50, max: 150, value: 1000 * (settings.wall ?? 0.05) },
      (x) => this.change(this.settings.wall === undefined ? {} : { wall: x / 1000 }));
    const there = h("input", { type: "checkbox", checked: settings.wall !== undefined,
      onchange: () => this.change({ wall: there.checked ? wall.get() / 1000 : undefined }) });
    this.walldial = wall;
    return [this.fieldset("Arm", h("div", { class: "lk-dials" }, Object.values(this.armdials).map((d) => d.element))),
      this.fieldset("Wall in front of the tip", h("label", { class: "lk-check" }, there, "present"), wall.element)];
  }
}
