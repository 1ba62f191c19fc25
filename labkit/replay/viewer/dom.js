// Functions that make elements.

/** An element: h("button", {class: "x", onclick: f}, "text", child, ...). */
export function h(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** An element of SVG, made in the same form. */
export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "style") element.style.cssText = value; // set through the CSSOM, not as an inline style
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat().filter((c) => c !== null && c !== undefined));
  return element;
}

/**
 * Makes a function to call with each new force [N].  It returns true when a force has been held for a
 * second, and again when another force has been held; then there is something to say.
 */
export function steady() {
  let held = 0, since = 0, said = true;
  return (size) => {
    const now = performance.now();
    if (Math.abs(size - held) > Math.max(1, 0.2 * held)) [held, since, said] = [size, now, !size];
    if (said || now - since < 1000) return false;
    return (said = true);
  };
}

let count = 0;
/** An id that no other element has. */
export const unique = (stem) => `lk-${stem}-${++count}`;

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

/**
 * A slider with linear or logarithmic steps; its value stands in a box for a number, where any value
 * within the limits can be typed, or beside it if not `typed`.  `oninput` receives each new value.
 */
export function dial({ label, unit = "", min, max, value = min, ratio = false, typed = true, digits = 3, oninput }) {
  const id = unique("dial"), STEPS = 200; // so few that the rounding to digits never takes a key's step back
  const toShare = (x) => (ratio ? Math.log(x / min) / Math.log(max / min) : (x - min) / (max - min));
  const toValue = (s) => (ratio ? min * (max / min) ** s : min + s * (max - min));
  const round = (x) => +Number(x).toPrecision(digits);
  const range = h("input", { type: "range", id, min: 0, max: STEPS, step: 1 });
  const number = typed ? h("input", { type: "number", "aria-label": `${label}, typed`, min, max, step: "any" }) : h("output", { for: id });
  let now = value;
  const show = () => {
    range.value = Math.round(STEPS * toShare(now));
    number.value = String(round(now));
    range.setAttribute("aria-valuetext", `${round(now)} ${unit}`.trim());
  };
  const change = (x) => { now = x; show(); oninput?.(now); };
  range.addEventListener("input", () => change(round(toValue(range.value / STEPS))));
  number.addEventListener("change", () => change(Number.isFinite(number.valueAsNumber) ? Math.min(max, Math.max(min, number.valueAsNumber)) : now));
  show();
  const element = h("div", { class: "lk-dial" }, h("label", { for: id }, label), range, number, h("span", { class: "lk-unit" }, unit));
  return { element, get: () => now, set: (x) => { now = x; show(); } };
}

/** A number with three decimals, without "-0.000". */
export const fixed = (x) => (Math.round(1000 * x) / 1000 + 0).toFixed(3);

/** A labelled list from which one value is chosen. */
export function choice({ label, values, value, onchange }) {
  const id = unique("choice");
  const select = h("select", { id, onchange: () => onchange?.(select.value) },
    values.map((v) => h("option", { value: v }, v)));
  if (value != null) select.value = value;
  const element = h("div", { class: "lk-choice" }, h("label", { for: id }, label), select);
  return { element, get: () => select.value, index: () => select.selectedIndex, set: (v) => { select.value = v; } };
}
