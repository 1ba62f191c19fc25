// The replay of one motion: the robot, its controls, and plots that share a time cursor.
import { joints, tip } from "./kinematics.js";
import { dispose, line } from "./marks.js";
import { Picture } from "./picture.js";
import { DASHES, letters, Plot } from "./plots.js";
import { at, read } from "./recording.js";
import { more, sight } from "./sight.js";
import { h, reducedMotion, unique } from "./dom.js";

const GHOSTS = [0x1f77d0, 0xc77700, 0x2a9d66, 0x9a5bc4];
const hex = (k) => `#${GHOSTS[k % GHOSTS.length].toString(16).padStart(6, "0")}`;
const NEWTON = 0.01; // length of an arrow for 1 N, in metres
const SPEEDS = [0.1, 0.25, 0.5, 1, 2];

export class Player {
  constructor(host, json, robot) {
    const motion = read(json);
    Object.assign(this, { host, motion, robot: motion.robot ?? robot, speed: 1, playing: false, times: 1 }); // the error is drawn `times` as large
    this.element = h("div", { class: "lk-player", role: "group", "aria-label": `Replay: ${motion.title}` });
    this.stagebox = h("div", { class: "lk-stage" });
    this.legend = h("ul", { class: "lk-legend", "aria-label": "What is drawn" });
    this.readout = h("p", { class: "lk-readout" });
    this.status = h("p", { class: "lk-hidden", role: "status" });
    this.picture = new Picture(this.stagebox, `${motion.title}. ${motion.alt}`);
    this.stage = this.picture.stage;
    this.sight = sight(this.picture, { magnify: motion.target && ((k) => { this.times = k; this.dress(); this.explain(); this.arrange(); }) });
    this.tips = motion.q.map((q) => tip(this.robot, motion.side, q).p);
    const curves = this.curves(), beside = Math.max(0, ...curves.map(({ series }) => letters(series)));
    this.plots = curves.map((c) => new Plot({ ...c, beside, x: motion.time, scrub: (t) => { this.play(false); this.seek(t); } }));
    this.element.append(h("p", { class: "lk-title" }, motion.title), h("div", { class: "lk-beside" },
      h("div", {}, this.stagebox, this.timebar()),
      h("div", { class: "lk-plots" }, this.plots.map((p) => p.element)), h("div", {}, this.readout, this.legend)),
      more(this.timing, this.sight.element), this.status);
    host.append(this.element);
    this.explain();
    if (this.stage.works) {
      this.picture.embody(this.robot);
      this.picture.pose(motion.side, motion.q[0]);
      this.picture.look([...this.tips, ...(motion.target ?? []), ...(motion.board ?? [])]);
      this.dress();
      this.stage.drawn = () => { host.dataset.ready = "1"; };
      this.stage.themed = () => { this.dress(); this.arrange(); };
    } else {
      this.stagebox.append(h("p", { class: "lk-note" }, "This browser cannot draw in 3-D (WebGL is missing), so the picture does not move. The plots and the numbers follow the time slider."));
      this.sight.element.hidden = true;
      host.dataset.ready = "1";
    }
    this.seek(motion.start);
  }

  timebar() {
    const { motion } = this, ends = { min: motion.start, max: motion.end };
    this.button = h("button", { type: "button", class: "lk-play", onclick: () => this.play(!this.playing) }, "Play");
    this.range = h("input", { type: "range", class: "lk-range", "aria-label": "Time", ...ends, step: "any",
      oninput: () => { this.play(false); this.seek(+this.range.value); }, onchange: () => this.speak() });
    this.range.addEventListener("keydown", (e) => { // a key moves one recorded sample, Page keys a tenth
      const [one, ten] = [motion.period, (motion.end - motion.start) / 10];
      const by = { ArrowRight: one, ArrowUp: one, ArrowLeft: -one, ArrowDown: -one, PageUp: ten, PageDown: -ten,
        Home: -Infinity, End: Infinity }[e.key];
      if (!by) return;
      e.preventDefault();
      this.play(false);
      this.seek(this.time + by);
      this.speak();
    });
    this.number = h("input", { type: "number", class: "lk-number", "aria-label": "Time in seconds, typed", ...ends, step: "any",
      onchange: () => { this.play(false); this.seek(this.number.valueAsNumber || 0); this.speak(); } });
    const id = unique("speed");
    const speed = h("select", { id, onchange: () => { this.speed = +speed.value; } },
      SPEEDS.map((s) => h("option", { value: s, selected: s === 1 }, `${s} ×`)));
    this.timing = h("div", { class: "lk-bar" }, h("span", {}, "Time"), this.number, h("span", { class: "lk-unit" }, "s"),
      h("span", { class: "lk-speed" }, h("label", { for: id }, "Speed"), speed));
    return h("div", { class: "lk-bar" }, this.button, this.range);
  }

  /** The names of the joints in plots and sentences. */
  names() {
    return joints(this.robot, this.motion.side).map((name) => name.replace(`${this.motion.side}_`, ""));
  }

  /** Draw the lines and the see-through arms of this motion. */
  dress() {
    const { motion, stage } = this;
    this.marks?.forEach((mark) => { stage.scene.remove(mark); dispose(mark); });
    this.ghosts?.forEach(({ arm }) => arm.remove());
    this.labels?.forEach((label) => stage.unlabel(label));
    const style = getComputedStyle(this.element);
    const colour = (name, fallback) => style.getPropertyValue(name).trim() || fallback; // before the first paint
    this.trace = this.magnified(this.tips);
    this.marks = [line(this.trace, { colour: colour("--lk-trace", "#b3001b"), width: 3 })];
    if (motion.path) this.marks.push(line(motion.path, { colour: colour("--lk-path", "#1f2328"), width: 3.5, dash: 0.025, gap: 0.014 }));
    this.ghosts = Object.entries(motion.ghosts).map(([name, q], k) => ({
      name, q, k, arm: this.picture.ghost(motion.side, GHOSTS[k % GHOSTS.length]),
      tips: this.magnified(q.map((row) => tip(this.robot, motion.side, row).p)) }));
    for (const { tips, k } of this.ghosts) {
      this.marks.push(line(tips, { colour: GHOSTS[k % GHOSTS.length], width: 2.5, dash: 0.006, gap: 0.008 * (k + 1) }));
    }
    stage.scene.add(...this.marks);
    this.labels = this.ghosts.length ? [
      stage.label(motion.label, () => at(motion, this.trace, this.time), colour("--lk-trace", "#b3001b")),
      ...this.ghosts.map(({ name, tips, k }) => stage.label(name, () => at(motion, tips, this.time), hex(k)))] : [];
  }

  /** The positions of these tips if they were `times` as far from the target. */
  magnified(tips) {
    const { motion, times } = this;
    if (times === 1 || !motion.target) return tips;
    return tips.map((p, i) => p.map((x, k) => motion.target[i][k] + times * (x - motion.target[i][k])));
  }

  /** The legend of lines and arms. */
  explain() {
    const { motion } = this;
    const swatch = (dash, colour) => {
      const s = h("span", { class: `lk-swatch ${dash}`, "aria-hidden": "true" });
      s.style.borderTopColor = colour;
      return s;
    };
    const rows = [["lk-solid", "var(--lk-trace)", `tip, ${motion.label}${this.times > 1 ? `, its error drawn ${this.times} times as large` : ""}`]];
    if (motion.path) rows.push(["lk-dashed", "var(--lk-path)", "desired path"]);
    Object.keys(motion.ghosts).forEach((name, k) => rows.push(["lk-dotted", hex(k), `${name} (see-through arm)`]));
    if (motion.target) rows.push([null, null, "target: frame with x, y, z marked by one, two, three rings"]);
    if (motion.force) rows.push(["lk-solid", "#c77700", "force on the tip"]);
    this.legend.replaceChildren(...rows.map(([dash, colour, text]) => h("li", {}, dash && swatch(dash, colour), text)));
  }

  /** Series for the plots: the error of every arm, and the torques of the first one. */
  curves() {
    const { motion } = this;
    const away = (q) => q.map((row, i) => {  // in millimetres
      const p = tip(this.robot, motion.side, row).p;
      return 1000 * Math.hypot(...p.map((x, k) => x - motion.target[i][k]));
    });
    const found = [];
    const main = motion.error?.map(([e]) => 1000 * e) ?? (motion.target && away(motion.q));
    if (main) {
      const series = [{ name: motion.label, values: main, colour: "var(--lk-trace)", width: 2.4 }];
      if (motion.target) Object.entries(motion.ghosts).forEach(([name, q], k) => series.push({
        name, values: away(q), dash: DASHES[1 + k], colour: hex(k) }));
      this.error = series[0].values;
      // The axis spans at least 0.2 mm, so that a perfect run is a flat line and not rounding errors.
      found.push({ title: "Tip error [mm]", series, zero: Math.min(...main) >= 0, least: 0.2 });
    } else this.error = null;
    if (motion.tau) found.push({
      title: "Joint torque [N m]",
      series: this.names().map((name, k) => ({ name, values: motion.tau.map((row) => row[k]) })) });
    return found;
  }

  seek(time) {
    const { motion } = this;
    this.time = Math.min(Math.max(time, motion.start), motion.end);
    if (this.stage.works) this.arrange();
    this.range.value = this.time;
    this.range.setAttribute("aria-valuetext", `${this.time.toFixed(2)} seconds`);
    if (document.activeElement !== this.number || !this.playing) this.number.value = this.time.toFixed(2);
    this.plots.forEach((p) => p.time(this.time));
    this.readout.textContent = this.numbers();
  }

  /** Move the arm, the see-through arms and the marks to their places at this time. */
  arrange() {
    const { motion } = this;
    const q = at(motion, motion.q, this.time);
    const here = (rows) => at(motion, rows, this.time);
    this.ghosts.forEach((g) => g.arm.pose(here(g.q)));
    this.picture.pose(motion.side, q);
    const around = { ...motion.things };
    for (const [name, kind] of [["target", "target"], ["board", "tag"]]) {
      if (motion[name]) around[name] = { kind, position: here(motion[name]),
        quaternion: motion[`${name}_quaternion`] && here(motion[`${name}_quaternion`]) };
    }
    this.picture.furnish(around);
    if (motion.target) {
      const from = here(motion.target), to = here(this.trace);
      this.picture.arrow("error", from, to.map((x, k) => x - from[k]), this.times > 1 ? `error × ${this.times}` : "", 0xb3001b);
    }
    const f = motion.force ? here(motion.force) : [0, 0, 0], size = Math.hypot(...f);
    this.picture.arrow("force", this.picture.tip.p, f.map((x) => NEWTON * x), size > 0.05 ? `${size.toFixed(1)} N` : "");
  }

  /** The current numbers as a sentence. */
  numbers() {
    const { motion } = this;
    const words = [`t = ${this.time.toFixed(2)} s`];
    if (this.error) {
      const e = at(motion, this.error.map((x) => [x]), this.time)[0];
      words.push(`error ${e.toFixed(1)} mm`);
    }
    if (motion.tau) {
      const tau = at(motion, motion.tau, this.time);
      const k = tau.reduce((b, x, i) => (Math.abs(x) > Math.abs(tau[b]) ? i : b), 0);
      words.push(`largest torque ${tau[k].toFixed(1)} N m at ${this.names()[k]}`);
    }
    return words.join(" · ");
  }

  /** Let a screen reader say the numbers when the motion stops, not in every frame. */
  speak() {
    clearTimeout(this.spoken);
    this.spoken = setTimeout(() => { this.status.textContent = this.numbers(); }, 500);
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    this.button.textContent = on ? "Pause" : "Play";
    if (!on) { cancelAnimationFrame(this.tick); this.speak(); return; }
    if (this.time >= this.motion.end) this.seek(this.motion.start);
    let last = performance.now();
    // With reduced motion, a reader who chooses to play sees still pictures, four a second.
    let due = 0;
    const step = (now) => {
      if (!this.playing) return;
      if (now >= due) {
        if (reducedMotion()) due = now + 250;
        this.seek(this.time + (this.speed * (now - last)) / 1000);
        last = now;
      }
      if (this.time >= this.motion.end) this.play(false);
      else this.tick = requestAnimationFrame(step);
    };
    this.tick = requestAnimationFrame(step);
  }

  dispose() {
    this.play(false);
    clearTimeout(this.spoken);
    this.plots.forEach((p) => p.dispose());
    this.picture.dispose();
    this.element.remove();
  }
}
