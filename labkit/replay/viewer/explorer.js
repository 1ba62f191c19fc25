// Shows the chosen one of the runs that were recorded on a grid of gains.
import { Player } from "./player.js";
import { choice, dial, h } from "./dom.js";
import { nearest } from "./grid.js";

const isWords = ({ values }) => typeof values[0] === "string";

export class Explorer {
  /** index: {dials: [{name, label, unit, values}], runs: {"0-1-2": url or motion}, facts: {key: text}} */
  constructor(host, index, robot, load) {
    Object.assign(this, { host, index, robot, load });
    this.asked = ""; // the sentence about a typed number that is not on the grid
    this.controls = index.dials.map((d) => (isWords(d)
      ? choice({ label: d.label, values: d.values, value: d.value, onchange: () => this.change() })
      : dial({ label: d.label, unit: d.unit, stops: d.values, value: d.value, digits: 4, oninput: (value, typed = value) => {
        this.change(Math.abs(typed - value) > 1e-9
          ? `No run was recorded at ${d.label} ${typed}; the nearest, ${value}, is shown. ` : "");
      } })));
    this.note = h("p", { class: "lk-recorded", role: "status" });
    this.element = h("div", { class: "lk-demo lk-explorer", role: "group", "aria-label": index.title },
      h("div", { class: "lk-dials" }, this.controls.map((c) => c.element)), this.note);
    host.append(this.element);
    this.change();
  }

  change(asked = "") { // sliders send many events, so a run is loaded only when they rest
    this.asked = asked;
    clearTimeout(this.due);
    this.due = setTimeout(() => this.show(), this.player ? 120 : 0);
  }

  async show() {
    const wanted = this.controls.map((c) => c.index());
    const key = nearest(Object.keys(this.index.runs), wanted, this.index.dials.map(isWords));
    const run = this.index.runs[key];
    let motion;
    try {
      motion = typeof run === "string" ? await this.load(key, run) : run;
    } catch {
      this.note.textContent = `The recorded run ${run} is missing beside this page.`;
      return;
    }
    if (wanted.some((k, i) => k !== this.controls[i].index())) return; // the reader has moved a slider since
    const words = key.split("-").map((k, i) => {
      const { label, unit, values } = this.index.dials[i];
      return typeof values[k] === "string" ? values[k] : `${label} ${values[k]}${unit ? ` ${unit}` : ""}`;
    }).join(", ");
    const exact = key === wanted.join("-") ? "" : "This point was not recorded; the nearest recorded point is shown. ";
    this.note.replaceChildren(h("span", { class: "lk-badge" }, "recorded"), ` ${this.asked}${exact}${words}. ${this.index.facts?.[key] ?? ""}`);
    this.host.dataset.run = key;
    if (this.player) this.player.show(motion);
    else {
      this.player = new Player(this.element, motion, this.robot);
      this.player.stage.drawn = () => { this.host.dataset.ready = "1"; };
      if (!this.player.stage.works) this.host.dataset.ready = "1";
    }
  }

  dispose() {
    clearTimeout(this.due);
    this.player?.dispose();
    this.element.remove();
  }
}
