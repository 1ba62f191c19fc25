// The open page's panel: any path with any controller, dials, hands, a kept run beside the present one.
import { ARM_DIALS, gainDials } from "./controls.js";
import { dial } from "./dial.js";
import { AXES, hold, pushTips, tire } from "./hands.js";
import { Curves, ERROR } from "./curves.js";
import { NAMES, PRESETS, READY, wallAt } from "./settings.js";
import { SCALINGS } from "./paths.js";
import { Session } from "./session.js";
import { TAG, TASK } from "./numbers.js";
import { subtract } from "./algebra.js";

const GHOST = 0x1f77d0, NEWTON = 0.01; // metres of arrow for a newton
const PATHS = ["line", "circle", "square", "tag", "stay"];
const ARMS = { ideal: "ideal arm", baxter: "realistic arm" };
const key = (names, label) => Object.keys(names).find((k) => names[k] === label);

export class Panel {
  constructor(host, config, mujoco, viewer, robot, began) {
    Object.assign(this, { host, config, mujoco, viewer, h: viewer.h, began, playing: true, alone: false });
    const plant = config.plant ?? "ideal";
    this.armdials = {};
    this.settings = { ...PRESETS[plant], controller: "workspaceImpedance", path: "circle", shape: "quintic",
      speed: TASK.speed, gains: {}, ...config.settings };
    this.session = new Session(mujoco, this.settings);
    this.build(robot);
    this.last = performance.now();
    this.tick = requestAnimationFrame((now) => this.frame(now));
    this.recompute();
  }

  get sessions() { return this.other ? [this.session, this.other] : [this.session]; }

  build(robot) {
    const { h, viewer, host } = this;
    this.element = h("div", { class: "lk-player", role: "group", "aria-label": this.config.title ?? "The live arm" });
    const stagebox = h("div", { class: "lk-stage" });
    this.numbers = h("p", { class: "lk-readout" });
    this.status = h("p", { class: "lk-hidden", role: "status" });
    this.said = h("p", { class: "lk-kept" });
    this.gainbox = h("div", { class: "lk-dials" });
    this.curves = new Curves(viewer, this.quantities(), (t) => this.say(`At ${t.toFixed(2)} s: ${this.curves.at(t)}`));
    this.element.append(stagebox, ...this.parts(), this.status);
    host.append(this.element);
    this.picture = new viewer.Picture(stagebox, "Baxter, live");
    if (this.picture.works) {
      this.draw3d(robot);
      const { element } = viewer.sight(this.picture);
      stagebox.after(element);
      element.querySelectorAll("input[type=checkbox]")[1].click(); // the arm alone
    }
    else stagebox.append(h("p", { class: "lk-note" }, "This browser draws no 3-D (WebGL is missing). The arm is simulated all the same: push it by the buttons; numbers and curve follow."));
    this.showGains();
  }

  /** What stands under the picture, in order. */
  parts() {
    return [this.buttons(), this.choices(), this.fieldset("Gains", this.gainbox), this.hands(), this.details(), this.numbers,
      this.curves.element, this.said];
  }

  /** What is plotted of a run. */
  quantities() { return [ERROR]; }

  fieldset(name, ...children) { return this.h("fieldset", {}, this.h("legend", {}, name), ...children); }

  buttons() {
    const { h } = this;
    const button = (text, onclick) => h("button", { type: "button", onclick }, text);
    this.play = button("Pause", () => this.pause(this.playing));
    this.play.classList.add("lk-play");
    this.keeper = button("Keep this run", () => this.keep());
    return h("div", { class: "lk-bar" }, this.play, button("Step 0.1 s", () => { this.pause(true); this.live(0.1); this.tell(); }),
      button("From the start", () => this.restart()), this.keeper);
  }

  choices() {
    const { h, viewer, settings } = this;
    const only = this.config.controllers ?? Object.keys(NAMES);
    this.selects = {
      plant: viewer.choice({ label: "Arm", values: Object.values(ARMS), value: ARMS[settings.plant],
        onchange: (label) => this.preset(key(ARMS, label)) }),
      path: viewer.choice({ label: "Path", values: this.config.paths ?? PATHS, value: settings.path,
        onchange: (path) => this.change({ path }) }),
      controller: viewer.choice({ label: "Controller", values: only.map((name) => NAMES[name]), value: NAMES[settings.controller],
        onchange: (label) => { this.change({ controller: key(NAMES, label), gains: {} }); this.showGains(); } }),
      shape: viewer.choice({ label: "Time scaling", values: SCALINGS, value: settings.shape,
        onchange: (shape) => this.change({ shape }) }) };
    return h("div", { class: "lk-livebar" }, Object.values(this.selects).map((c) => c.element));
  }

  dial(spec, oninput) { return dial({ h: this.h, unique: this.viewer.unique }, { ...spec, oninput }); }

  showGains() {
    const { plant, controller, gains } = this.settings;
    const dials = gainDials(plant, controller).map((spec) => this.dial({ ...spec, value: gains[spec.key] ?? spec.value },
      (x) => this.change({ gains: { ...this.settings.gains, [spec.key]: x } })));
    const none = "The position mode has no gains to choose: it goes where it is told as fast as its motors can still brake.";
    this.gainbox.replaceChildren(...(dials.length ? dials.map((d) => d.element) : [this.h("p", { class: "lk-kept" }, none)]));
  }

  hands() {
    const { h } = this;
    const newtons = this.dial({ label: "Force", unit: "N", min: 1, max: 40, value: 10 }, () => {});
    const push = (axis) => { pushTips(this.sessions, axis, newtons.get()); this.pause(false); this.say(`Pushing the tip with ${newtons.get()} N along ${axis} for a second.`); this.tell(900); };
    const buttons = Object.keys(AXES).map((axis) => h("button", { type: "button", "aria-label": `Push along ${axis}`, onclick: () => push(axis) }, axis));
    return this.fieldset("Push the tip, or drag the arm in the picture", newtons.element, h("div", { class: "lk-pushes" }, buttons));
  }

  details() {
    const { h, settings } = this;
    this.armdials = Object.fromEntries(ARM_DIALS.map((spec) => [spec.key,
      this.dial({ ...spec, value: settings[spec.key] }, (x) => this.change({ [spec.key]: x }))]));
    const wall = this.dial({ label: "Wall at", unit: "mm", min: -50, max: 150, value: 1000 * (settings.wall ?? 0.05) },
      (x) => this.change(this.settings.wall === undefined ? {} : { wall: x / 1000 }));
    const there = h("input", { type: "checkbox", checked: settings.wall !== undefined,
      onchange: () => this.change({ wall: there.checked ? wall.get() / 1000 : undefined }) });
    this.walldial = wall;
    return h("details", { open: this.config.open }, h("summary", {}, "The arm and its surroundings"),
      this.fieldset("Arm", h("div", { class: "lk-dials" }, Object.values(this.armdials).map((d) => d.element))),
      this.fieldset("Wall before the tip", h("label", { class: "lk-check" }, there, "stands"), wall.element));
  }

  draw3d(robot) {
    const { picture } = this;
    picture.embody(robot);
    picture.pose("left", this.session.arm.q);
    const { rig } = picture.stage;
    const reach = 0.17;
    rig.around([READY.p.map((x) => x - reach), READY.p.map((x) => x + reach)]);
    Object.assign(rig.motion, this.config.view);
    rig.use("Motion");
    hold(picture, () => this.sessions, {
      wall: { move: (p) => { const at = p[0] - READY.p[0]; this.walldial.set(1000 * at); this.change({ wall: at }); } },
      tag: { move: (p) => { for (const { chase } of this.sessions) chase.dragged = subtract(p, READY.p).map((x, k) => (k === 2 ? 0 : x + TAG.offset[k])); } },
      target: { move: (p) => {
        if (this.settings.path !== "stay") return;
        this.change({ place: p.map((x, k) => Math.max(-0.15, Math.min(0.15, x - READY.p[k]))) });
      } },
    }, () => this.pause(false));
    this.drawPath();
  }

  /** The path of the target, dashed. */
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

  /** New settings: the arm goes on under them at once, the curve is made again. */
  change(what) {
    this.settings = { ...this.settings, ...what };
    try {
      this.session.change(this.settings);
    } catch (problem) { this.lost(problem); return; }
    if (what.path || what.place) this.drawPath();
    this.recompute();
    this.changed?.();
  }

  preset(plant) {
    this.change({ ...PRESETS[plant], gains: {} });
    for (const [name, d] of Object.entries(this.armdials)) d.set(this.settings[name]);
    this.showGains();
  }

  /** Put this run beside the next ones: a see-through arm, and its curve. */
  keep() {
    this.other?.close();
    this.picture.works && this.ghost?.remove();
    if (this.kept) { [this.other, this.ghost, this.kept] = []; this.curves.drop(); } else {
      this.kept = this.settings;
      this.other = new Session(this.mujoco, this.settings);
      this.ghost = this.picture.works && this.picture.ghost("left", GHOST);
      this.curves.keep(this.words());
      this.restart();
    }
    this.keeper.textContent = this.kept ? "Let the kept run go" : "Keep this run";
    this.say(this.kept ? "Kept: the see-through arm goes on with these values." : "The kept run is gone.");
  }

  words() {
    const { controller, gains, plant } = this.settings;
    const told = Object.entries(gains).map(([name, x]) => `${name} ${+x.toPrecision(3)}`);
    return [ARMS[plant], NAMES[controller], ...told].join(", ");
  }

  restart() {
    for (const session of this.sessions) session.restart();
    this.pause(false);
  }

  pause(on) {
    this.playing = !on;
    this.play.textContent = on ? "Go on" : "Pause";
    this.last = performance.now();
    if (on) this.tell();
  }

  frame(now) {
    this.tick = requestAnimationFrame((later) => this.frame(later));
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches && now - this.last < 250;
    if (!this.playing || still || !this.element.isConnected) return;
    const asked = (now - this.last) / 1000;
    this.last = now;
    this.live(Math.min(asked, 0.3));
  }

  /** Let time pass for the arms, in [s], and show what came of it. */
  live(seconds) {
    try {
      for (const session of this.sessions) {
        tire(session);
        const seen = session.advance(seconds);
        if (session === this.session && seen.length) this.now = seen.at(-1);
      }
    } catch (problem) { this.lost(problem); return; }
    this.show();
  }

  show() {
    const { now, picture } = this;
    if (!now) return;
    if (picture.works) {
      picture.pose("left", this.session.arm.q);
      if (this.other) this.ghost.pose(this.other.arm.q);
      this.furnish(now);
      for (const name of ["hand", "push", "wall"]) {
        const force = now.forces.find((f) => f.name === name);
        picture.arrow(name, force?.at ?? now.p, force ? force.force.map((x) => NEWTON * x) : [0, 0, 0], force ? `${force.size.toFixed(1)} N` : "");
      }
    }
    const words = [`t = ${now.t.toFixed(2)} s`, `tip ${(1000 * now.error).toFixed(1)} mm from its target`,
      ...now.forces.map((f) => `${f.name} ${f.size.toFixed(1)} N`), `quickest joint ${now.speed.toFixed(2)} rad/s`];
    this.numbers.textContent = words.join(" · ");
    this.curves.time(now.t % this.session.lap);
    this.shown?.(now);
    if (!this.host.dataset.ready) {
      this.host.dataset.ready = "1";
      this.host.dataset.firstMotion = String(Math.round(performance.now() - this.began));
    }
  }

  furnish(now) {
    const things = { target: { kind: "target", position: now.goal } };
    if (this.session.chase) things.tag = { kind: "tag", position: subtract(now.goal, TAG.offset), size: TAG.size };
    if (this.settings.wall !== undefined) {
      const { point, size } = wallAt(this.settings.wall);
      things.wall = { kind: "face", position: point, quaternion: [0, -Math.SQRT1_2, 0, Math.SQRT1_2], size };
    }
    this.picture.furnish({ ...things, ...this.more?.(now) });
  }

  /** The curve of a whole run with the present settings; what was there stays behind it, faint. */
  recompute() {
    clearTimeout(this.due);
    this.due = setTimeout(async () => {
      const began = performance.now(), settings = this.settings, asked = (this.asked = {});
      try {
        const told = await this.curves.run(this.mujoco, settings, this.config.seconds ?? 2.5, () => asked !== this.asked);
        if (asked !== this.asked) return;
        this.host.dataset.rerun = String(Math.round(performance.now() - began));
        this.said.textContent = `${this.words()}: ${told}`;
        this.say(told);
        this.computed?.();
      } catch (problem) { this.lost(problem); }
    }, this.curves.last ? 60 : 0);
  }

  lost(problem) {
    this.pause(true);
    for (const session of this.sessions) session.restart();
    this.numbers.textContent = `Stopped: ${problem.message}. The arm is back at its start; change a dial and go on.`;
    this.say(this.numbers.textContent);
  }

  /** Tell a screen reader something, once and politely. */
  say(text) { this.status.textContent = text; }
  tell(later = 0) { clearTimeout(this.telling); this.telling = setTimeout(() => this.say(this.numbers.textContent), later); }

  dispose() {
    cancelAnimationFrame(this.tick);
    clearTimeout(this.due);
    clearTimeout(this.telling);
    this.sessions.forEach((session) => session.close());
    this.curves.dispose();
    this.picture.dispose();
    this.element.remove();
  }
}

