// "Stiffness has a direction": a hand that carries a weight in front of a wall, with one dial or three.
import { add } from "./algebra.js";
import { Panel } from "./panel.js";
import { predictBox, write } from "./predict.js";
import { READY } from "./settings.js";

const LIMITS = { wall: 12, sag: 5 }; // N and mm
const BEHIND = 0.03; // distance of the target behind the wall's face, in [m]
const SETTINGS = { controller: "workspaceImpedance", path: "stay", place: [BEHIND, 0, 0], wall: 0, payload: 0.3,
  viscous: 1, gains: { K: 300 } };
const MODES = { one: "one K for all directions", three: "Kx, Ky, Kz", position: "position mode" };

class Stiffness extends Panel {
  parts(stagebox) {
    const { h, viewer } = this;
    this.mode = "one";
    this.predicted = predictBox(h, {
      question: "The target lies 3 cm behind the wall's face. With K = 1000 N/m in all directions, how hard does the hand press on the wall?",
      unit: "N", commit: () => this.gains({ K: 1000 }, "one"), found: () => (this.settled() && this.settings.gains.K === 1000 ? this.wallForce : null) });
    this.choose = viewer.choice({ label: "Hold by", values: Object.values(MODES), value: MODES.one,
      onchange: (label) => this.gains({}, Object.keys(MODES).find((k) => MODES[k] === label)) });
    this.bars = { wall: bar(h, "Wall force", LIMITS.wall, 45, "N"), sag: bar(h, "Sag", LIMITS.sag, 20, "mm") };
    this.verdict = h("p", { class: "lk-kept", role: "status" });
    const weight = this.dial({ label: "Weight", unit: "kg", min: 0, max: 1, value: 0.3 }, (payload) => this.change({ payload }));
    this.walldial = this.dial({ label: "Wall at", unit: "mm", min: -40, max: 60, value: 0 }, (x) => this.change({ wall: x / 1000 }));
    const results = this.predicted.behind("Once you have entered a number above, the force on the wall and the sag appear here and in the picture.",
      h("div", { class: "lk-bars" }, this.bars.wall.element, this.bars.sag.element), this.verdict);
    return [this.predicted.element, this.beside(stagebox, results, [this.fieldset("Stiffness", this.choose.element, this.gainbox)]),
      this.folded(this.fieldset("Weight in the hand, wall", h("div", { class: "lk-dials" }, weight.element, this.walldial.element)), this.hands()), this.said];
  }

  /** Use other gains, with one dial, three dials or none. */
  gains(gains, mode) {
    this.mode = mode;
    this.choose.set(MODES[mode]);
    const had = this.settings.gains.K ?? 300;
    const next = mode === "three" ? { Kx: had, Ky: had, Kz: had, ...gains } : { K: had, ...gains };
    this.change({ controller: mode === "position" ? "baxtersOwn" : "workspaceImpedance", gains: mode === "position" ? {} : next });
    this.showGains();
    this.say(`The arm is held by ${MODES[mode]}${next.K && mode === "one" ? `, K = ${next.K} N/m` : ""}.`);
  }

  showGains() {
    const { gains } = this.settings, keys = { one: ["K"], three: ["Kx", "Ky", "Kz"], position: [] }[this.mode];
    this.gainbox.replaceChildren(...keys.map((key) => this.dial(
      { label: key, unit: "N/m", min: 30, max: 3000, ratio: true, value: gains[key] ?? 300 },
      (x) => { this.change({ gains: { ...this.settings.gains, [key]: x } }); }).element));
  }

  change(what) {
    super.change(what);
    Object.assign(this, { since: this.session.loop.t, told: false });
  }

  /** The points that the first view shows, around the hand and the wall. */
  inSight() { return [[-0.1, 0, -0.1], [0.1, 0, 0.2]].map((d) => add(READY.p, d)); }

  recompute() {} // here only the place where the arm comes to rest matters
  settled() { return this.session.loop.t - (this.since ?? 0) > 2; }

  /** Hide the arrow of the wall's force until the reader has entered a number. */
  drawNow(now) {
    super.drawNow(this.predicted.said === null ? { ...now, forces: now.forces.filter((f) => f.name !== "wall") } : now);
  }

  shown(now) {
    if (this.predicted.said === null) { this.numbers.textContent = `t = ${now.t.toFixed(2)} s`; return; }
    const wall = now.forces.find((f) => f.name === "wall");
    this.wallForce = wall?.size ?? 0;
    this.sag = 1000 * now.off[2];
    this.bars.wall.set(this.wallForce);
    this.bars.sag.set(this.sag);
    this.predicted.tell();
    if (!this.settled()) { write(this.verdict, "Coming to rest…"); this.told = false; return; }
    if (this.told) return;
    this.told = true; // said to a screen reader only once, when the arm is at rest
    this.verdict.textContent = `At rest: ${this.wallForce.toFixed(1)} N on the wall (at most ${LIMITS.wall}), ${tenths(this.sag)} mm of sag (at most ${LIMITS.sag}). ${kept(this.wallForce, this.sag)}`;
    this.host.dataset.wall = this.wallForce.toFixed(2);
    this.host.dataset.sag = this.sag.toFixed(2);
  }
}

/** A number with one decimal place and a minus sign, but without negative zero. */
const tenths = (x) => x.toFixed(1).replace(/^-0\.0$/, "0.0").replace("-", "−");

/** A sentence that says which of the two limits are kept. */
function kept(force, sag) {
  const over = [...(force > LIMITS.wall ? ["force"] : []), ...(sag > LIMITS.sag ? ["sag"] : [])];
  if (over.length === 2) return "The force and the sag are over their limits.";
  return over.length ? `The ${over[0]} is over its limit.` : "Both limits are kept.";
}

/** A bar with a limit and its number. */
function bar(h, name, limit, most, unit) {
  const fill = h("span", { class: "lk-fill" }), mark = h("span", { class: "lk-limit" }), words = h("span", {});
  mark.style.left = `${(100 * limit) / most}%`;
  const element = h("div", { class: "lk-barrow" }, h("span", {}, name), h("span", { class: "lk-track", "aria-hidden": "true" }, fill, mark), words);
  const set = (x) => {
    fill.style.width = `${Math.min(100, Math.max(0, (100 * x) / most))}%`;
    fill.classList.toggle("lk-over", x > limit);
    words.textContent = `${tenths(x)} ${unit}, limit ${limit} ${unit}`;
  };
  return { element, set };
}

export function stiffnessPiece(host, config, ...given) {
  return new Stiffness(host, { title: "Stiffness has a direction", view: { azimuth: 1.35, elevation: 0.2 }, ...config, settings: { ...SETTINGS, ...config.settings } }, ...given);
}
