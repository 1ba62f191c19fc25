// What is seldom used is folded under "More"; it begins with the controls of the view.
import { VIEWS } from "./rig.js";
import { choice, h } from "./dom.js";

/** A folded group of controls. */
export const more = (...children) => h("details", { class: "lk-more" }, h("summary", {}, "More"), ...children);

/**
 * The controls of a view: {element, magnifier}.
 * @param magnify  called with 1, 10 or 50; if it is missing, the error cannot be magnified
 */
export function sight(picture, { magnify } = {}) {
  const { stage } = picture;
  const views = Object.keys(VIEWS).map((name) => h("button", { type: "button", onclick: () => stage.rig?.use(name) }, name));
  const sizes = ["× 1", "× 10", "× 50"];
  const magnifier = choice({ label: "Error", values: sizes, onchange: (shown) => magnify(+shown.slice(2)) }).element;
  magnifier.hidden = !magnify;
  const element = h("div", { class: "lk-bar lk-views", role: "group", "aria-label": "View" }, views, magnifier);
  return { element, magnifier };
}
