// The panel of the live page: any path with any controller, dials and hands.
import { Curves, ERROR } from "./curves.js";
import { ARM_DIALS } from "./controls.js";
import { Drawing } from "./drawing.js";
import { ARMS } from "./form.js";
import { tire } from "./hands.js";
import { NAMES, PRESETS } from "./settings.js";
import { Session } from "./session.js";
import { TASK } from "./numbers.js";
import { write } from "./predict.js";

export const CALM = 800; // ms without another curve before a screen reader is given the last one
const SIGNS = { zeta: "ζ", lambda2: "λ²", threshold: "damped where σ is below" }; // symbols of gains, as in the text
const UNITS = { lambda2: " m²", threshold: " m" }; // lengths, because angles are multiplied by a lever in metres

const FORCES = { hand: "your pull" }; // words for a reader, if they differ from the name

/** A description of settings: the arm, the controller, and what the reader has changed in both. */
export function described({ controller, gains, plant, ...arm }) {
  const short = (x) => +x.toPrecision(3);
  const changed = ARM_DIALS.filter(({ key }) => key in PRESETS[plant] && arm[key] !== PRESETS[plant][key])
    .map(({ key, label, unit }) => `${label.toLowerCase()} ${short(arm[key])}${unit === "Baxter's" ? "" : ` ${unit}`}`);
  const told = Object.entries(gains).map(([name, x]) => `${SIGNS[name] ?? name} ${short(x)}${UNITS[name] ?? ""}`);
  return [ARMS[plant], ...changed, NAMES[controller], ...told].join(", ");
}

export class Panel extends Drawing {
  constructor(host, config, mujoco, viewer, robot) {
    super();
    Object.assign(this, { host, config, mujoco, viewer, h: viewer.h, playing: true, felt: viewer.steady() });
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

  build(robot) {
    const { h, viewer, host } = this;
    this.element = h("div", { class: "lk-player", role: "group", "aria-label": this.config.title ?? "The live arm" });
    const stagebox = h("div", { class: "lk-stage" });
    this.numbers = h("p", { class: "lk-readout" });
    this.status = h("p", { class: "lk-hidden", role: "status" });
    this.said = h("p", { class: "lk-kept" });
    this.gainbox = h("div", { class: "lk-dials" });
    this.curves = new Curves(viewer, this.quantities());
    this.sight = h("div");
    this.element.append(...this.parts(stagebox), this.status);
    host.append(this.element);
    this.picture = new viewer.Picture(stagebox, "Baxter, live");
    if (this.picture.works) {
      this.draw3d(robot);
      this.sight.replaceWith(viewer.sight(this.picture).element);
    }
    else stagebox.append(h("p", { class: "lk-note" }, "This browser cannot draw in 3-D (WebGL is missing). The arm is still simulated: push it with the buttons, and watch the numbers and the curve."));
    this.showGains();
  }

  /** The quantities of a run that are plotted. */
  quantities() { return [ERROR]; }

  /** Use new settings: the arm continues with them at once, and the curve is computed again. */
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

  restart() {
    this.session.restart();
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

  /** Advance the arms by a time in [s], and show the result. */
  live(seconds) {
    try {
      tire(this.session);
      this.now = this.session.advance(seconds).at(-1) ?? this.now;
    } catch (problem) { this.lost(problem); return; }
    this.show();
  }

  show() {
    const { now, picture } = this;
    if (!now) return;
    if (picture.works) this.drawNow(now);
    const words = [`t = ${now.t.toFixed(2)} s`, `tip ${(1000 * now.error).toFixed(1)} mm from its target`,
      ...now.forces.map((f) => `${FORCES[f.name] ?? f.name} ${f.size.toFixed(1)} N`), `fastest joint ${now.speed.toFixed(2)} rad/s`];
    this.numbers.textContent = words.join(" · ");
    if (this.settings.path === "stay") this.curves.follow(now);
    else this.curves.time(now.t % this.session.lap);
    this.shown?.(now);
    const hand = now.forces.find((f) => f.name === "hand")?.size ?? 0;
    if (this.felt(hand)) this.say(`Pulling with ${hand.toFixed(1)} N: ${this.numbers.textContent}`);
    this.host.dataset.ready = "1";
  }

  /** Compute the curve of a whole run with the present settings, unless the target stays. */
  recompute() {
    clearTimeout(this.due);
    this.asked = {};
    if (this.settings.path === "stay") { this.said.textContent = `${described(this.settings)}.`; return; }
    this.due = setTimeout(async () => {
      const settings = this.settings, asked = (this.asked = {});
      try {
        const told = await this.curves.run(this.mujoco, settings, this.config.seconds ?? 2.5, () => asked !== this.asked);
        if (asked !== this.asked) return;
        this.said.textContent = `A run from the start, ${described(settings)}: ${told}`;
        this.say(told, CALM);
      } catch (problem) { this.lost(problem); }
    }, this.curves.last ? 60 : 0);
  }

  lost(problem) {
    this.pause(true);
    this.session.restart();
    this.numbers.textContent = `Stopped: ${problem.message}. The arm is back at its start; change a dial and continue.`;
    this.say(this.numbers.textContent);
  }

  /** Let a screen reader say a sentence without interrupting; of several in a row, only the last one. */
  say(text, later = 0) {
    clearTimeout(this.telling);
    if (later) this.telling = setTimeout(() => this.say(text), later);
    else write(this.status, typeof text === "function" ? text() : text);
  }

  tell(later = 0) { this.say(() => this.numbers.textContent, later); }

  dispose() {
    cancelAnimationFrame(this.tick);
    clearTimeout(this.due);
    clearTimeout(this.telling);
    this.session.close();
    this.curves.dispose();
    this.picture.dispose();
    this.element.remove();
  }
}

