// The plots of a panel: a whole run with a faint line for the run before it, or the last ten seconds.
import { wholeRun } from "./session.js";

const POINTS = 160, KEPT = 10, PAUSE = 0.04; // s that a strip keeps, and between two of its points
const rest = () => new Promise((go) => setTimeout(go, 0));

/** Quantities of a run's ticks that can be plotted; `top` is the smallest maximum of the axis. */
export const ERROR = { title: "Tip error [mm]", top: 10, value: (tick) => 1000 * tick.error };
export const ASKED = { title: "Largest joint speed that the law asks for [rad/s]", top: 5, most: 20,
  value: (tick) => Math.max(...tick.asked.map(Math.abs)) };

/** Numbers of a run: the root mean square and the largest error in mm, and the highest joint speed in rad/s. */
export function summary(ticks) {
  const errors = ticks.map((tick) => 1000 * tick.error);
  const rms = Math.sqrt(errors.reduce((sum, x) => sum + x * x, 0) / errors.length);
  return { rms, most: Math.max(...errors), speed: Math.max(...ticks.map((tick) => tick.speed)) };
}

export class Curves {
  constructor(viewer, quantities) {
    this.element = viewer.h("div", { class: "lk-plots" });
    this.plots = quantities.map((of) => ({ of, top: of.top, plot: new viewer.Plot({
      title: of.title, series: [], x: [0, 1], zero: true, least: of.top }) }));
    this.element.append(...this.plots.map(({ plot }) => plot.element));
  }

  /** Simulate a run, draw it, and return a sentence with its numbers. */
  async run(mujoco, settings, seconds, stopped) {
    const ticks = await wholeRun(mujoco, settings, seconds, { rest, stopped });
    if (stopped()) return "";
    this.show(ticks);
    this.numbers = summary(ticks);
    const { rms, most, speed } = this.numbers;
    return `error ${rms.toFixed(2)} mm (root mean square), ${most.toFixed(2)} mm at most; the fastest joint reaches ${speed.toFixed(2)} rad/s.`;
  }

  /** Draw these ticks as the present run; the previous run stays behind it. */
  show(ticks) {
    const step = Math.max(1, Math.floor(ticks.length / POINTS)), few = ticks.filter((_, k) => k % step === 0);
    [this.before, this.last] = [this.last === this.strip ? null : this.last, few];
    this.draw();
  }

  /** Draw what has happened up to this tick, with what came shortly before it. */
  follow(tick) {
    const kept = this.strip && this.last === this.strip ? this.strip.filter(({ t }) => t < tick.t && t > tick.t - KEPT) : [];
    if (kept.length && tick.t - kept.at(-1).t < PAUSE) return;
    [this.before, this.last] = [null, this.strip = [...kept, tick]];
    this.draw();
    this.time(tick.t);
  }

  draw() {
    if (!this.last) return;
    const x = this.last.map((tick) => tick.t);
    for (const one of this.plots) {
      const { value, most = Infinity } = one.of;
      const fit = (ticks) => x.map((_, i) => Math.min(most, value(ticks[Math.min(i, ticks.length - 1)])));
      const series = [];
      if (this.before) series.push({ name: "before", values: fit(this.before), colour: "var(--lk-edge)", dash: "" });
      series.push({ name: "now", values: fit(this.last), colour: "var(--lk-trace)", dash: "", width: 2.4 });
      const high = Math.max(...series.flatMap((s) => s.values));
      while (high > one.top) one.top *= /^2/.test(String(one.top)) ? 2.5 : 2; // the axis never shrinks while the reader looks at it
      one.plot.least = one.top;
      one.plot.set(series, x);
    }
  }

  time(t) { this.plots.forEach(({ plot }) => plot.time(t)); }

  dispose() { this.plots.forEach(({ plot }) => plot.dispose()); }
}
