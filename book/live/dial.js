// A slider with a box for a number beside it, with linear or logarithmic steps; any typed value within the limits is used.

export function dial({ h, unique }, { label, unit = "", min, max, value, ratio = false, digits = 3, oninput }) {
  const id = unique("live"), STEPS = 1000;
  const toShare = (x) => (ratio ? Math.log(x / min) / Math.log(max / min) : (x - min) / (max - min));
  const toValue = (s) => (ratio ? min * (max / min) ** s : min + s * (max - min));
  const round = (x) => +Number(x).toPrecision(digits);
  const number = h("input", { type: "number", "aria-label": `${label}, typed`, min, max, step: "any" });
  const range = h("input", { type: "range", id, min: 0, max: STEPS, step: 1 });
  let now = value;
  const show = () => {
    range.value = Math.round(STEPS * toShare(now));
    number.value = String(round(now));
    range.setAttribute("aria-valuetext", `${round(now)} ${unit}`.trim());
  };
  range.addEventListener("input", () => { now = round(toValue(range.value / STEPS)); show(); oninput(now); });
  number.addEventListener("change", () => {
    if (Number.isFinite(number.valueAsNumber)) now = Math.min(max, Math.max(min, number.valueAsNumber));
    show();
    oninput(now);
  });
  show();
  const element = h("div", { class: "lk-dial" }, h("label", { for: id }, label), range, number, h("span", { class: "lk-unit" }, unit));
  return { element, get: () => now, set: (x) => { now = x; show(); } };
}
