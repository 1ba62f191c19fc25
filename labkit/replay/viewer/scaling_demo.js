// Live demo of the time scalings: four shapes cover the same distance in the same time.
import { Plot } from "./plots.js";
import { choice, dial, fixed, h } from "./dom.js";
import { profile, trapezoid, trapezoidAcceleration } from "./scaling.js";

const NAMES = ["bang-bang", "trapezoid", "cubic", "quintic"];
const COUNT = 241;

export class ScalingDemo {
  constructor(host) {
    this.element = h("div", { class: "lk-demo", role: "group", "aria-label": "Time scalings, live" });
    const redraw = () => this.draw();
    this.length = dial({ label: "Length", unit: "m", min: 0.05, max: 1, step: 0.05, value: 0.4, oninput: redraw });
    this.duration = dial({ label: "Duration", unit: "s", min: 0.5, max: 8, step: 0.1, value: 2, oninput: redraw });
    this.cruise = dial({ label: "Cruising", unit: "of time", min: 0, max: 0.96, step: 0.02, value: 0.34, oninput: redraw });
    this.bold = choice({ label: "Emphasise", values: NAMES, value: "quintic", onchange: redraw });
    this.time = dial({ label: "Time", unit: "s", min: 0, max: 2, step: 0.01, value: 1, digits: 2, oninput: () => this.mark() });
    const plot = (title) => new Plot({ title, series: [], x: [0, 1], scrub: (t) => { this.time.set(t); this.mark(); } });
    this.plots = [plot("Distance along the path [m]"), plot("Speed [m/s]"), plot("Acceleration [m/s²]")];
    this.table = h("table", { class: "lk-table" });
    this.element.append(
      h("div", { class: "lk-dials" }, [this.length, this.duration, this.cruise, this.bold, this.time].map((d) => d.element)),
      h("div", { class: "lk-plots" }, this.plots.map((p) => p.element)),
      h("div", { class: "lk-scroll", tabindex: 0, role: "region", "aria-label": "Numbers of the four time scalings" }, this.table));
    host.append(this.element);
    this.draw();
    host.dataset.ready = "1";
  }

  /** [s, ds, dds] of a named scaling with the present settings. */
  sample(name, t) {
    const [d, T] = [this.length.get(), this.duration.get()];
    if (name !== "trapezoid") return profile(name, T, t);
    const v = (2 * d) / (T * (1 + this.cruise.get())); // without cruising this is bang-bang
    return trapezoid(d, v, trapezoidAcceleration(d, v, T), t);
  }

  draw() {
    const [d, T] = [this.length.get(), this.duration.get()];
    const x = Array.from({ length: COUNT }, (_, i) => (i * T) / (COUNT - 1));
    const all = NAMES.map((name) => x.map((t) => this.sample(name, Math.min(t, T * (1 - 1e-9)))));
    this.peaks = all.map((rows) => [1, 2].map((k) => d * Math.max(...rows.map((r) => Math.abs(r[k])))));
    this.plots.forEach((plot, k) => plot.set(NAMES.map((name, i) => ({
      name, values: all[i].map((r) => d * r[k]), width: name === this.bold.get() ? 3.2 : 1.4 })), x));
    this.time.element.querySelectorAll("input").forEach((input) => { input.max = T; });
    this.time.set(Math.min(this.time.get(), T));
    this.mark();
  }

  mark() {
    const [t, d] = [this.time.get(), this.length.get()];
    this.plots.forEach((p) => p.time(t));
    const cells = (values) => values.map((v) => h("td", {}, fixed(v)));
    this.table.replaceChildren(
      h("caption", {}, `At t = ${t.toFixed(2)} s, and the largest values during the motion`),
      h("thead", {}, h("tr", {}, ["time scaling", "distance [m]", "speed [m/s]", "accel. [m/s²]", "peak speed [m/s]", "peak accel. [m/s²]"].map((n) => h("th", { scope: "col" }, n)))),
      h("tbody", {}, NAMES.map((name, i) => h("tr", {}, h("th", { scope: "row" }, name),
        cells(this.sample(name, t).map((v) => d * v)), cells(this.peaks[i])))));
  }

  dispose() {
    this.plots.forEach((p) => p.dispose());
    this.element.remove();
  }
}
