// The live arm of the notebook.  The kernel simulates it and sends its position 30 times a second;
// this script draws it and sends the input of the pointer, the keys and the dials.
import { Picture } from "./picture.js";
import { Plot } from "./plots.js";
import { choice, dial, h, steady } from "./dom.js";
import { line } from "./marks.js";
import { more, sight } from "./sight.js";

const NEWTON = 0.006; // length of an arrow for 1 N, in metres
const BEAT = 60; // ms between two messages while something is held
const AXES = [["+x", [1, 0, 0]], ["−x", [-1, 0, 0]], ["+y", [0, 1, 0]], ["−y", [0, -1, 0]], ["+z", [0, 0, 1]], ["−z", [0, 0, -1]]];
const MOST = 60; // N, the limit of a push or a pull
const SHOWN = 10; // seconds of the curves
const LOOK = 2000; // ms between two checks that the kernel still exists
const QUIET = 5000; // ms without a message from a kernel whose arm runs before the page says so
const AGAIN = "run the notebook again from its first cell to this one.";

/** The name of a link in a sentence. */
const spoken = (link) => (/^(tip|elbow)/.test(link) ? `the ${link}` : `joint ${link}`);

export class LiveArm {
  /** link: {send(message), hear(f), cut()}, the connection to the kernel; without it the picture does not move. */
  constructor(host, data, robot, link) {
    Object.assign(this, { host, data, link, robot: data.robot ?? robot, held: null, rows: [], felt: steady() });
    this.element = h("div", { class: "lk-player lk-live", role: "group", "aria-label": data.title });
    this.stagebox = h("div", { class: "lk-stage" });
    this.note = h("p", { class: "lk-say", hidden: true });
    this.readout = h("p", { class: "lk-readout" });
    this.status = h("p", { class: "lk-hidden", role: "status" });
    this.picture = new Picture(this.stagebox, `${data.title}. Drag the arm or a thing to pull it, or drag elsewhere to turn the view`);
    this.times = 1; // the error is drawn this many times as large
    this.sight = sight(this.picture, { magnify: (k) => { this.times = k; this.draw(this.frame); } });
    this.plot = new Plot({ title: "Distance from the target [mm]", xName: "time [s]", zero: true, least: 1, ...this.curve() });
    const seen = h("div", {}, this.stagebox, this.buttons());
    const told = h("div", {}, h("div", { class: "lk-plots" }, this.plot.element), this.readout, this.dials(), this.note);
    this.element.append(h("p", { class: "lk-title" }, data.title), h("div", { class: "lk-beside" }, seen, told),
      more(this.hand(), this.sight.element), this.status);
    host.append(this.element);
    if (this.picture.works) this.furnish();
    else {
      this.stagebox.append(h("p", { class: "lk-note" }, "This browser cannot draw in 3-D (WebGL is missing). The buttons, the numbers and the curve still work."));
      this.sight.element.hidden = true;
      host.dataset.ready = "1";
    }
    this.show(data.first);
    if (!link) { this.say(`This arm needs a running kernel: ${AGAIN}`); return; }
    this.looking = setInterval(() => this.look(), LOOK);
    link.hear((message) => { this.came = performance.now(); this.show(message); });
  }

  send(message) {
    try { this.link?.send(message); } catch { this.lost(); } // the connection is closed
  }

  /** Check that the kernel still exists: a closed connection is certain, silence is not. */
  look() {
    if (this.link.cut?.()) this.lost();
    else if (this.state === "running" && performance.now() - this.came > QUIET) {
      this.say(`Nothing has come from the kernel for ${QUIET / 1000} s. Does every loop of the controller end? Else restart the kernel, and ${AGAIN}`);
    }
  }

  /** Say that the kernel has ended, and disable what needs it. */
  lost() {
    if (!this.link) return;
    this.link = null;
    this.release();
    clearInterval(this.looking);
    if (this.picture.works) this.picture.stage.rig.grab = null;
    for (const control of this.element.querySelectorAll("button, input, select")) {
      control.disabled ||= !this.sight.element.contains(control);
    }
    this.say(`The kernel was restarted or shut down, and this arm ended with it: ${AGAIN}`, true);
    this.speak(this.note.textContent, 0);
  }

  buttons() {
    this.start = h("button", { type: "button", class: "lk-play", disabled: !this.link,
      onclick: () => this.send({ kind: this.state === "running" ? "pause" : "go" }) }, "Start");
    const laws = this.data.laws.length < 2 ? [] : [choice({ label: "Controller", values: this.data.laws,
      onchange: (name) => this.send({ kind: "law", name }) }).element];
    return h("div", { class: "lk-bar" }, this.start, h("button", { type: "button", title: "Put the arm back to its start",
      disabled: !this.link, onclick: () => { this.release(); this.send({ kind: "reset" }); } }, "Reset"), laws);
  }

  /** Controls that replace the pointer: choose a link and a force, and switch it on along an axis. */
  hand() {
    const { joints } = this.data;
    this.links = [...joints.map((j) => (j === "e1" ? "elbow (e1)" : j)), "tip"];
    this.where = choice({ label: "Push at", values: [...this.links].reverse() });
    this.newtons = h("input", { type: "number", "aria-label": "Force in newtons", min: 0, max: MOST, step: "any", value: 10, disabled: !this.link,
      onchange: () => this.pushing?.() });
    this.pushes = AXES.map(([name, axis]) => h("button", { type: "button", class: "lk-icon", "aria-pressed": "false", disabled: !this.link,
      "aria-label": `Push along ${name.replace("−", "minus ").replace("+", "plus ")}`, title: "Push until this button is pressed again",
      onclick: (e) => this.push(e.currentTarget, axis) }, name));
    return h("div", { class: "lk-bar", role: "group", "aria-label": "Push with keys" }, this.where.element,
      this.newtons, h("span", { class: "lk-unit" }, `N (0 to ${MOST}) along`), this.pushes, h("span", { class: "lk-unit" }, "(press again to let go)"));
  }

  push(button, axis) {
    const on = button.getAttribute("aria-pressed") !== "true";
    this.release();
    if (!on) return;
    button.setAttribute("aria-pressed", "true");
    const link = this.links.indexOf(this.where.get());
    this.pushing = () => { // called again when another force is typed
      const size = Math.min(MOST, Math.max(0, this.newtons.valueAsNumber || 0));
      this.newtons.value = size;
      this.take({ link, local: [0, 0, 0], force: axis.map((x) => size * x) });
    };
    this.pushing();
  }

  /** Hold the arm until `release`, with repeated messages, because the kernel drops a silent hand. */
  take(hand) {
    this.held = hand;
    this.beat();
    clearInterval(this.beating);
    this.beating = setInterval(() => this.beat(), BEAT);
  }

  beat() { this.send({ kind: "hand", ...this.held }); }

  release() {
    clearInterval(this.beating);
    this.pushing = null;
    this.pushes.forEach((b) => b.setAttribute("aria-pressed", "false"));
    if (!this.held) return;
    this.held = null;
    this.send({ kind: "hand", link: 0, local: [0, 0, 0] });
    this.speak("Let go.", 0);
  }

  dials() {
    const made = this.data.dials.map((d) => dial({ label: d.name.replaceAll("_", " "), unit: d.unit, typed: false, min: d.min, max: d.max, value: d.value,
      oninput: (value) => this.turn(d.name, value) }).element);
    return h("div", { class: "lk-dials lk-livedials", hidden: !made.length }, made);
  }

  /** Send a dial's value to the kernel, at most ten times a second, but always the last one. */
  turn(name, value) {
    this.turned = { ...this.turned, [name]: value };
    this.turning ??= setTimeout(() => {
      this.turning = null;
      for (const [n, v] of Object.entries(this.turned)) this.send({ kind: "dial", name: n, value: v });
      this.turned = {};
    }, 100);
  }

  furnish() {
    const { picture } = this;
    picture.embody(this.robot);
    picture.pose(this.data.side, this.data.first.q);
    const seen = [picture.tip.p, ...Object.values(this.data.first.things).filter((t) => t.kind !== "face").map((t) => t.position)];
    const { path } = this.data;
    if (path?.length) {
      this.path = line(path, { colour: 0xc77700, width: 2, dash: 0.012, gap: 0.008, opacity: 0.6 });
      picture.stage.scene.add(this.path);
    }
    picture.look([...seen, ...path ?? []]);
    picture.stage.drawn = () => { this.host.dataset.ready = "1"; };
    if (this.link) picture.grab((picked, event) => this.grip(picked, event), ({ thing }) => !this.things[thing]?.fixed);
  }

  /** A pointer takes hold of a link or a thing. */
  grip(picked, event) {
    const { picture } = this;
    const { at } = picked;
    if (picked.thing !== undefined) {
      const { position } = this.things[picked.thing];
      const from = picture.dragged(event, at);
      const move = (e) => {
        const to = picture.dragged(e, at);
        this.send({ kind: "thing", name: picked.thing, position: position.map((x, k) => x + to[k] - from[k]) });
      };
      return { move, end: () => this.speak("Moved.", 0) };
    }
    this.release();
    this.take({ link: picked.link, local: picked.local, to: at });
    const move = (e) => {
      if (!this.held?.to) return; // Reset also lets go
      this.held = { ...this.held, to: picture.dragged(e, at) };
      this.beat();
    };
    return { move, end: () => this.release() };
  }

  /** Show a frame from the kernel, which has the numbers for one picture. */
  show(frame) {
    const before = this.state, told = this.frame?.note;
    if (frame.state === "running" && performance.now() - (this.here ?? -1e9) > 1e4) { // if somebody is watching
      this.here = performance.now();
      this.send({ kind: "here" });
    }
    Object.assign(this, { frame, state: frame.state, things: frame.things });
    this.start.textContent = frame.state === "running" ? "Pause" : "Start";
    if (before !== frame.state && before === "running") this.release();
    if (this.picture.works) this.draw(frame);
    if (frame.error !== null && this.rows.at(-1)?.[0] !== frame.t) {
      if (this.rows.length && frame.t < this.rows.at(-1)[0]) this.rows = [];
      this.rows.push([frame.t, 1000 * frame.error]);
      while (this.rows[0][0] < frame.t - SHOWN) this.rows.shift();
    }
    this.readout.textContent = this.numbers();
    this.say(frame.note, frame.state === "stopped");
    if (before !== frame.state || frame.note && frame.note !== told) this.speak(frame.note || { running: "Running.", ready: "Ready." }[frame.state] || "", 0);
    if (this.felt(frame.force ? Math.hypot(...frame.force) : 0)) this.speak(this.forced(frame), 0);
    this.plotted ??= setTimeout(() => { this.plotted = null; const c = this.curve(); this.plot.set(c.series, c.x); this.plot.time(c.x.at(-1)); }, 200);
  }

  /** A sentence about the force of the hand. */
  forced({ force, link, error }) {
    const away = error === null ? "" : `; the tip is ${(1000 * error).toFixed(0)} mm from its target`;
    return `${this.pushing ? "Pushing" : "Pulling"} ${spoken(this.links[link])} with ${Math.hypot(...force).toFixed(1)} N${away}.`;
  }

  draw({ q, force, at, link, things }) {
    const { picture } = this;
    picture.pose(this.data.side, q);
    picture.furnish(things);
    const size = force ? Math.hypot(...force) : 0;
    const starts = this.held?.force && force && link < this.links.length - 1 ? picture.outside(at, force) : at ?? picture.tip.p;
    picture.arrow("force", starts, (force ?? [0, 0, 0]).map((x) => NEWTON * x), `${size.toFixed(1)} N`);
    const from = things.target?.position ?? picture.tip.p;
    const off = picture.tip.p.map((x, k) => this.times * (x - from[k]));
    picture.arrow("error", from, this.times > 1 ? off : [0, 0, 0], `error × ${this.times}`, 0xb3001b);
    const way = this.held?.to ? this.held.to.map((x, k) => x - (at ?? picture.tip.p)[k]) : [0, 0, 0];
    picture.arrow("pointer", at ?? picture.tip.p, way, "", 0x57606a);
  }

  curve() {
    const x = this.rows.length > 1 ? this.rows.map(([t]) => t) : [0, 1];
    return { x, series: [{ name: "distance", values: this.rows.length > 1 ? this.rows.map(([, e]) => e) : [0, 0], colour: "var(--lk-trace)", width: 2.2 }] };
  }

  numbers() {
    const { t, error, force, link, spent, law } = this.frame;
    const words = [law.replaceAll("_", " "), `t = ${t.toFixed(2)} s`];
    if (error !== null) words.push(`${(1000 * error).toFixed(1)} mm from the target`);
    words.push(force ? `your force ${Math.hypot(...force).toFixed(1)} N at ${spoken(this.links[link])}` : "your force 0.0 N");
    if (spent.length) words.push(`at its torque limit: ${spent.map((k) => this.data.joints[k]).join(", ")}`);
    return words.join(" · ");
  }

  say(text, alarm = false) {
    this.note.hidden = !text;
    if (this.note.textContent !== text) this.note.textContent = text;
    this.note.classList.toggle("lk-alarm", alarm);
  }

  /** Let a screen reader say a sentence without interrupting; only the last one is said. */
  speak(words, after = 300) {
    clearTimeout(this.spoken);
    this.spoken = setTimeout(() => { this.status.textContent = words; }, after);
  }

  dispose() {
    this.send({ kind: "pause" });
    for (const timer of [this.spoken, this.turning, this.plotted]) clearTimeout(timer);
    for (const timer of [this.beating, this.looking]) clearInterval(timer);
    this.plot.dispose();
    this.picture.dispose();
    this.element.remove();
  }
}
