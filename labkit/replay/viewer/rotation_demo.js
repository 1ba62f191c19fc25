// Live demo: the error between two orientations by the logarithm, and by subtracting Euler angles.
import { dial, fixed, h } from "./dom.js";
import { apply, fromEuler, log, multiply, norm, subtract, toEuler, transpose } from "./so3.js";

const ANGLES = ["roll", "pitch", "yaw"];
const STARTS = { target: [0.2, 1.3, 0.1], actual: [-2.6, 1.4, -2.7] };

/** Both error vectors in the base's axes, and the angle between the two orientations. */
export function errors(target, actual) {
  const [Rd, Ra] = [fromEuler(target), fromEuler(actual)];
  const phi = log(multiply(transpose(Ra), Rd)); // in the actual frame
  return { log: apply(Ra, phi), euler: subtract(toEuler(Rd), toEuler(Ra)), angle: norm(phi) };
}

export class RotationDemo {
  constructor(host) {
    const redraw = () => this.draw();
    this.dials = {};
    const group = (name) => h("fieldset", { class: "lk-dials" }, h("legend", {}, `The ${name} orientation`),
      (this.dials[name] = ANGLES.map((a, i) => dial({
        label: a, unit: "rad", min: -3.14, max: 3.14, value: STARTS[name][i], oninput: redraw,
      }))).map((d) => d.element));
    this.table = h("table", { class: "lk-table" });
    this.words = h("p", { class: "lk-readout" });
    this.element = h("div", { class: "lk-demo", role: "group", "aria-label": "Orientation error, live" },
      group("target"), group("actual"), this.words,
      h("div", { class: "lk-scroll", tabindex: 0, role: "region", "aria-label": "The two error vectors" }, this.table));
    host.append(this.element);
    this.draw();
    host.dataset.ready = "1";
  }

  draw() {
    const found = errors(...["target", "actual"].map((n) => this.dials[n].map((d) => d.get())));
    const aligned = found.log.reduce((sum, x, i) => sum + x * found.euler[i], 0) / (norm(found.log) * norm(found.euler) || 1);
    const off = (Math.acos(Math.min(1, Math.max(-1, aligned))) * 180) / Math.PI;
    this.words.textContent = `The orientations are ${found.angle.toFixed(3)} rad apart. The difference of the Euler angles has length ${norm(found.euler).toFixed(3)}, and its direction is ${off.toFixed(0)}° away from the axis of the shortest rotation.`;
    const row = (name, v) => h("tr", {}, h("th", { scope: "row" }, name), v.map((x) => h("td", {}, fixed(x))), h("td", {}, norm(v).toFixed(3)));
    this.table.replaceChildren(
      h("caption", {}, "Error = target − actual, as a rotation vector in base axes [rad]"),
      h("thead", {}, h("tr", {}, ["", "x / roll", "y / pitch", "z / yaw", "length"].map((n, i) => h(i ? "th" : "td", i ? { scope: "col" } : {}, n)))),
      h("tbody", {}, row("logarithm", found.log), row("Euler difference", found.euler)));
  }

  dispose() { this.element.remove(); }
}
