// Small line plots in SVG with a time cursor; lines differ by their dashes and have their names beside them.
import { h, svg, unique } from "./dom.js";

export const DASHES = ["", "7 3", "2 3", "9 3 2 3", "12 4", "5 2 1 2 1 2", "1 4"];
const HEIGHT = 196, LEFT = 46, TOP = 8, BOTTOM = 36;

/** Round values for an axis from low to high. */
export function ticks(low, high, wanted = 4) {
  const base = 10 ** Math.floor(Math.log10((high - low) / wanted || 1));
  const miss = (step) => Math.abs((high - low) / step - wanted);
  const step = [1, 2, 5, 10].map((m) => m * base).reduce((a, b) => (miss(b) < miss(a) ? b : a));
  const found = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + step * 1e-9; v += step) found.push(+v.toPrecision(10));
  return found;
}

/** The width of the longest name beside the lines; a single line has no name. */
export const letters = (series) => (series.length < 2 ? 0 : Math.max(...series.map((s) => s.name.length)));

export class Plot {
  /**
   * @param title  what is plotted, with its unit
   * @param series list of {name, values, dash?, colour?, width?}
   * @param x      abscissae, one per value
   * @param scrub  called with an abscissa when the reader drags over the plot
   * @param zero   whether the axis starts at zero
   * @param least  the smallest range of the axis, even if the values have a smaller one
   * @param beside letters to leave room for on the right, so that plots share one time axis
   */
  constructor({ title, series, x, xName = "time [s]", scrub, zero = false, least = 1e-12, beside = 0 }) {
    Object.assign(this, { title, series, x, xName, zero, least, beside, now: x[0] });
    const id = unique("plot");
    this.art = svg("svg", { class: "lk-plot", role: "img", "aria-labelledby": id, focusable: "false" });
    this.element = h("div", { class: "lk-plotbox" }, h("p", { class: "lk-plottitle", id }, title), this.art);
    this.observer = new ResizeObserver(() => this.draw());
    this.observer.observe(this.element);
    if (!scrub) return;
    this.art.classList.add("lk-scrub");
    const pick = (e) => {
      const u = (e.clientX - this.art.getBoundingClientRect().left - LEFT) / this.wide;
      scrub(this.x[0] + Math.min(1, Math.max(0, u)) * (this.x.at(-1) - this.x[0]));
    };
    this.art.addEventListener("pointerdown", (e) => { this.art.setPointerCapture(e.pointerId); pick(e); });
    this.art.addEventListener("pointermove", (e) => { if (e.buttons) pick(e); });
  }

  set(series, x = this.x) {
    Object.assign(this, { series, x });
    this.draw();
  }

  draw() {
    const width = this.element.clientWidth;
    if (!width) return;
    const longest = Math.max(this.beside, letters(this.series));
    const right = longest ? Math.min(24 + 6.6 * longest, 0.43 * width) : 12;
    const wide = this.wide = Math.max(60, width - LEFT - right);
    const tall = HEIGHT - TOP - BOTTOM;
    let low = this.zero ? 0 : Infinity, high = -Infinity;
    for (const { values } of this.series) for (const v of values) { low = Math.min(low, v); high = Math.max(high, v); }
    if (high - low < this.least) high = low + this.least;
    if (high - low < 1e-9) { low -= 0.5; high += 0.5; }
    const pad = 0.05 * (high - low);
    high += pad;
    if (!(this.zero && low === 0)) low -= pad;
    const [start, end] = [this.x[0], this.x.at(-1)];
    const px = this.px = (t) => LEFT + ((t - start) / (end - start || 1)) * wide;
    const py = (v) => TOP + (1 - (v - low) / (high - low)) * tall;
    const parts = [];
    for (const v of ticks(low, high)) {
      parts.push(svg("line", { class: "lk-gridline", x1: LEFT, x2: LEFT + wide, y1: py(v), y2: py(v) }),
        svg("text", { class: "lk-tick", x: LEFT - 6, y: py(v) + 4, "text-anchor": "end" }, String(v)));
    }
    for (const t of ticks(start, end, Math.max(2, wide / 80))) {
      parts.push(svg("line", { class: "lk-gridline", x1: px(t), x2: px(t), y1: TOP + tall, y2: TOP + tall + 4 }),
        svg("text", { class: "lk-tick", x: px(t), y: TOP + tall + 17, "text-anchor": "middle" }, String(t)));
    }
    parts.push(svg("text", { class: "lk-tick", x: LEFT + wide, y: HEIGHT - 3, "text-anchor": "end" }, this.xName));
    const names = this.series.map((s, k) => ({ k, s, y: py(s.values.at(-1)) })).sort((a, b) => a.y - b.y);
    names.forEach((n, i) => { if (i) n.y = Math.max(n.y, names[i - 1].y + 14); });
    const over = Math.max(0, (names.at(-1)?.y ?? 0) - (TOP + tall));
    names.forEach((n, i) => { n.y = Math.max(TOP + 4 + 14 * i, n.y - over); });
    this.series.forEach(({ values, dash, colour, width: thick }, k) => {
      const points = values.map((v, i) => `${px(this.x[i]).toFixed(1)},${py(v).toFixed(1)}`).join(" ");
      parts.push(svg("polyline", {
        class: "lk-line", points, "stroke-dasharray": dash ?? DASHES[k % DASHES.length],
        style: `stroke: ${colour ?? `var(--lk-line-${k % 7})`}; stroke-width: ${thick ?? 1.8}` }));
    });
    for (const { s, y } of names.length > 1 ? names : []) {
      const from = py(s.values.at(-1));
      parts.push(svg("path", { class: "lk-leader", d: `M${LEFT + wide + 1},${from} L${LEFT + wide + 8},${y}` }),
        svg("text", { class: "lk-name", x: LEFT + wide + 11, y: y + 4 }, s.name));
    }
    this.cursor = svg("line", { class: "lk-cursor", y1: TOP, y2: TOP + tall });
    this.art.setAttribute("viewBox", `0 0 ${width} ${HEIGHT}`);
    this.art.setAttribute("height", HEIGHT);
    this.art.replaceChildren(...parts, this.cursor);
    this.time(this.now);
  }

  /** Move the cursor. */
  time(t) {
    this.now = t;
    if (!this.cursor) return;
    const x = this.px(Math.min(Math.max(t, this.x[0]), this.x.at(-1))).toFixed(1);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
  }

  dispose() { this.observer.disconnect(); }
}
