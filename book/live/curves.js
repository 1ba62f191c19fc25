// The plot of a panel: the error of a whole run, the run before it faint, the kept one dashed, axes that stay.
import { wholeRun } from "./session.js";

const POINTS = 160;
const rest = () => new Promise((go) => setTimeout(go, 0));

/** Numbers of a run: root mean square and largest error in mm. */
export function summary(ticks) {
  const errors = ticks.map((tick) => 1000 * tick.error);
  const rms = Math.sqrt(errors.reduce((sum, x) => sum + x * x, 0) / errors.length);
  return { rms, most: Math.max(...errors), speed: Math.max(...ticks.map((tick) => tick.speed)) };
}

export class Curves {
  constructor(viewer, scrub) {
    this.element = viewer.h("div", { class: "lk-plots" });
    this.top = 10; // mm: grows by 1, 2, 5, and never shrinks under the reader's eyes
    this.plot = new viewer.Plot({ title: "Tip error of a run from the start [mm]", series: [], x: [0, 1], zero: true, least: this.top, scrub });
    this.element.append(this.plot.element);
  }

  /** Simulate a run and draw it; returns its numbers in words. */
  async run(mujoco, settings, seconds, stopped) {
    const ticks = await wholeRun(mujoco, settings, seconds, { rest, stopped });
    if (stopped()) return "";
    const step = Math.max(1, Math.floor(ticks.length / POINTS)), few = ticks.filter((_, k) => k % step === 0);
    [this.before, this.last] = [this.last, few.map((tick) => 1000 * tick.error)];
    this.x = few.map((tick) => tick.t);
    this.numbers = summary(ticks);
    this.draw();
    const { rms, most, speed } = this.numbers;
    return `error ${rms.toFixed(2)} mm (root mean square), ${most.toFixed(1)} mm at most; quickest joint ${speed.toFixed(2)} rad/s.`;
  }

  draw() {
    if (!this.last) return;
    const fit = (values) => this.x.map((_, i) => values[Math.min(i, values.length - 1)]);
    const series = [];
    if (this.before) series.push({ name: "before", values: fit(this.before), colour: "var(--lk-edge)", dash: "" });
    if (this.kept) series.push({ name: "kept", values: fit(this.kept.values), colour: "#1f77d0", dash: "7 3" });
    series.push({ name: "now", values: this.last, colour: "var(--lk-trace)", dash: "", width: 2.4 });
    const high = Math.max(...series.flatMap((s) => s.values));
    while (high > this.top) this.top *= /^2/.test(String(this.top)) ? 2.5 : 2;
    this.plot.least = this.top;
    this.plot.set(series, this.x);
  }

  keep(name) { this.kept = { name, values: this.last ?? [0] }; this.draw(); }
  drop() { this.kept = null; this.draw(); }
  time(t) { this.plot.time(t); }

  /** The numbers at a time, in words. */
  at(t) {
    if (!this.last) return "not there yet";
    const i = Math.max(0, this.x.findIndex((x) => x >= t));
    return `now ${this.last[i].toFixed(1)} mm${this.kept ? `, kept ${this.kept.values[i]?.toFixed(1)} mm` : ""}`;
  }

  dispose() { this.plot.dispose(); }
}
