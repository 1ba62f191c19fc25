// "Where the impossible goes": as the elbow straightens, joint speeds grow, and damping turns them into path error.
import { add, apply, scale, subtract, length } from "./algebra.js";
import { dampedSpeeds } from "./controllers.js";
import { ASKED, ERROR } from "./curves.js";
import { inverseKinematics } from "./inverse.js";
import { Model } from "./model.js";
import { CONTROLLERS, ROBOT } from "./numbers.js";
import { Panel } from "./panel.js";
import { predictBox } from "./predict.js";
import { ELBOW } from "./settings.js";

const LIMIT = 1.5; // rad/s, the limit of the fastest of Baxter's large joints
const SPEED = 0.1; // speed of the tip, in [m/s]
const LEVER = CONTROLLERS.ideal.workspaceVelocity.gains.lever;
const model = new Model(ROBOT);
const posed = (e1) => ROBOT.ready.map((x, i) => (i === ELBOW ? e1 : x));

/** The horizontal direction from the shoulder to the wrist, in which the elbow stretches the arm. */
function outwards(q) {
  const { joints } = model.frames(q), way = subtract(joints[5].p, joints[1].p);
  return scale(1 / length(way), way);
}

/** Joint speeds for a tip speed of 10 cm/s outwards at an elbow angle, and the part of that speed that is lost, in [mm/s]. */
export function atElbow(e1, lambda2) {
  const q = posed(e1), J = model.tipJacobian(q), V = [...scale(SPEED, outwards(q)), 0, 0, 0];
  const dq = dampedSpeeds(J, V, lambda2, LEVER);
  return { quickest: Math.max(...dq.map(Math.abs)), lost: 1000 * length(subtract(V, apply(J, dq)).slice(0, 3)) };
}

/** A sentence about the result of the equations for a damping; without damping the speed has no maximum. */
export function told(lambda2, x, found) {
  const peak = found.reduce((a, b) => (b.quickest > a.quickest ? b : a)), at = x[found.indexOf(peak)].toFixed(2);
  if (!lambda2) return `With λ² = 0: the speed of the fastest joint grows without bound at e1 = ${at} rad; the tip does not lose speed.`;
  const lost = Math.max(...found.map((f) => f.lost)).toFixed(0);
  return `With λ² = ${lambda2} m²: the fastest joint turns at ${peak.quickest.toFixed(1)} rad/s, at e1 = ${at} rad; the tip loses up to ${lost} of 100 mm/s.`;
}

/** The elbow angles of the maps, in [rad]. */
export const ANGLES = Array.from({ length: 240 }, (_, k) => 0.0025 * (k + 1));

/** The elbow angle at which a joint must turn fastest. */
export function worstElbow() {
  const angles = Array.from({ length: 1200 }, (_, k) => 0.0005 * (k + 1));
  return angles.reduce((best, e1) => (atElbow(e1, 0).quickest > atElbow(best, 0).quickest ? e1 : best));
}

/** The distance from the shoulder to the wrist, which depends only on the elbow and is largest where the speed is. */
const span = (e1) => { const { joints } = model.frames(posed(e1)); return length(subtract(joints[5].p, joints[1].p)); };

const FROM = 1.0, TO = 0.2; // elbow angles at the two ends of the path, on which the hand's orientation is constant
const READY = model.pose(ROBOT.ready), OUT = outwards(ROBOT.ready);
const at = (e1) => add(READY.p, scale(span(e1) - span(ROBOT.ready[ELBOW]), OUT));
const START = inverseKinematics(model, { R: READY.R, p: at(FROM) }, ROBOT.ready, ROBOT.ready);
const WAY = subtract(at(TO), at(FROM));
const SETTINGS = { controller: "workspaceVelocity", path: "stretch", start: START, way: WAY, shape: "trapezoid", speed: SPEED,
  gains: { lambda2: 0, threshold: 0.1 } };

class Singular extends Panel {
  quantities() { return [{ ...ASKED, title: "Largest joint speed that the law asks for, before the motors' limits [rad/s]" }, { ...ERROR, title: "Path error [mm]", top: 5 }]; }

  parts(stagebox) {
    const { h, viewer } = this;
    this.predicted = predictBox(h, {
      question: "The tip is to move outwards at 10 cm/s while the elbow stretches. By the equations alone, at which elbow angle e1 must a joint turn fastest? (0 is the straight elbow.)",
      unit: "rad", commit: () => this.map(0), found: worstElbow });
    this.lambda = this.dial({ label: "Damping λ²", unit: "m²", min: 0, max: 0.02, value: 0 }, (lambda2) => {
      this.change({ gains: { ...this.settings.gains, lambda2 } });
      this.map(lambda2);
    });
    const axis = { xName: "elbow e1 [rad]", zero: true };
    this.maps = [
      new viewer.Plot({ title: "Equations alone: largest joint speed for 10 cm/s outwards [rad/s]; cut at 20", series: [], x: [0, 1], least: 20, ...axis }),
      new viewer.Plot({ title: "Speed of the tip that is lost [mm/s]", series: [], x: [0, 1], least: 100, ...axis })];
    this.maptold = h("p", { class: "lk-kept", role: "status" });
    this.mapbox = h("div", { class: "lk-plots", hidden: true }, this.maps.map((plot) => plot.element));
    return [this.predicted.element, this.beside(stagebox, [this.curves.element, this.said], [this.fieldset("Damping", this.lambda.element)]),
      this.mapbox, this.maptold, this.folded(this.hands())];
  }

  showGains() {}

  /** The result of the equations at each elbow angle, shown once the reader has predicted. */
  map(lambda2) {
    if (this.predicted.said === null) return;
    const x = ANGLES, found = x.map((e1) => atElbow(e1, lambda2));
    const values = [found.map((f) => Math.min(20, f.quickest)), found.map((f) => f.lost)];
    this.mapbox.hidden = false;
    this.maps.forEach((plot, k) => {
      const series = [{ name: "now", values: values[k], colour: "var(--lk-trace)", dash: "", width: 2.4 }];
      if (this.mapped) series.unshift({ name: "before", values: this.mapped[k], colour: "var(--lk-edge)", dash: "" });
      if (k === 0) series.push({ name: `limit ${LIMIT}`, values: x.map(() => LIMIT), colour: "var(--lk-quiet)", dash: "3 3" });
      plot.set(series, x);
      plot.draw();
    });
    this.mapped = values;
    this.maptold.textContent = told(lambda2, x, found);
  }
}

export function singularPiece(host, config, ...given) {
  return new Singular(host, { title: "Where the impossible goes", seconds: 5, view: { azimuth: 1.5, elevation: 0.15 }, ...config, settings: { ...SETTINGS, ...config.settings } }, ...given);
}
