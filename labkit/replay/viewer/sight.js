// What is seldom used is folded under "More"; it begins with the controls of the view.
import { VIEWS } from "./rig.js";
import { choice, h } from "./dom.js";

/** A folded group of controls. */
export const more = (...children) => h("details", { class: "lk-more" }, h("summary", {}, "More"), ...children);

/**
 * The controls of a view: {element, magnifier}.
 * @param magnify  called with 1, 10 or 50; if it is missing, the error cannot be magnified
 * @param whole  whether the robot is more than its arm; then all of it can be shown
 */
export function sight(picture, { magnify, whole = true } = {}) {
  const { stage } = picture;
  const views = Object.keys(VIEWS).map((name) => h("button", { type: "button", onclick: () => stage.rig?.use(name) }, name));
  const box = h("input", { type: "checkbox", onchange: () => picture.alone(!box.checked) });
  const all = h("label", { class: "lk-check" }, box, "Whole robot");
  all.hidden = !whole;
  const sizes = ["× 1", "× 10", "× 50"];
  const magnifier = choice({ label: "Error", values: sizes, onchange: (shown) => magnify(+shown.slice(2)) }).element;
  magnifier.hidden = !magnify;
  const element = h("div", { class: "lk-bar lk-views", role: "group", "aria-label": "View" }, views, all, magnifier);
  return { element, magnifier };
}
