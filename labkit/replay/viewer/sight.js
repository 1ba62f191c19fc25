// Controls of the view: named views, buttons that turn it, the close-up and the magnified error.
import { VIEWS } from "./rig.js";
import { choice, h } from "./dom.js";

const NEAR = 0.42; // distance from the hand to the camera of the close-up, in metres

/** A check box with its name. */
export function check(label, value, onchange) {
  const box = h("input", { type: "checkbox", checked: value, onchange: () => onchange(box.checked) });
  return h("label", { class: "lk-check" }, box, label);
}

/**
 * The bar under a picture: {element, magnifier, alone(on)}; `alone(true)` hides the rest of the robot.
 * @param magnify  called with 1, 10 or 50; if it is missing, the error cannot be magnified
 * @param whole  whether the robot is more than its arm; then the arm can be shown alone
 * @param camera  whether the things include a camera; then its picture can be shown
 */
export function sight(picture, { magnify, camera, whole = true } = {}) {
  const { stage } = picture;
  const views = Object.keys(VIEWS).map((name) => h("button", { type: "button", onclick: () => stage.rig?.use(name) }, name));
  const moves = [
    ["←", "Turn left", (r) => r.turn(-0.2, 0)], ["→", "Turn right", (r) => r.turn(0.2, 0)],
    ["↑", "Turn up", (r) => r.turn(0, 0.15)], ["↓", "Turn down", (r) => r.turn(0, -0.15)],
    ["+", "Zoom in", (r) => r.zoom(0.85)], ["−", "Zoom out", (r) => r.zoom(1 / 0.85)],
  ].map(([sign, name, act]) => h("button", {
    type: "button", class: "lk-icon", "aria-label": name, title: name, onclick: () => act(stage.rig) }, sign));
  const boxes = [check("Close-up", false, (on) => {
    inset(on && closely);
  }), check("Arm alone", false, (on) => picture.alone(on)),
  check("Velocity", false, (on) => { picture.quick = on; picture.velocity([0, 0, 0]); })];
  if (camera) boxes.push(check("Camera's picture", false, (on) => inset(on && (() => picture.seen()))));
  boxes[1].hidden = !whole;
  const [near, arm, , lens] = boxes.map((box) => box.querySelector("input"));
  const inset = (from) => { // one inset: the close-up or the camera's picture
    if (!stage.small) stage.inset();
    Object.assign(stage, { closely: () => from(picture) });
    stage.small.hidden = !from;
    near.checked = from === closely;
    if (lens) lens.checked = !!from && !near.checked;
    stage.draw();
  };
  const sizes = ["× 1", "× 10", "× 50"];
  const magnifier = choice({ label: "Error", values: sizes, value: sizes[0],
    onchange: (shown) => magnify?.(+shown.slice(2)) }).element;
  magnifier.hidden = !magnify;
  magnifier.classList.add("lk-magnify");
  const element = h("div", { class: "lk-bar lk-views", role: "group", "aria-label": "View" },
    h("span", { class: "lk-word", "aria-hidden": "true" }, "View"), views, h("span", { class: "lk-gap" }), moves,
    h("span", { class: "lk-gap" }), boxes, magnifier);
  // A click on a box that is not yet in the page would tick it without calling its handler.
  const alone = (on) => { arm.checked = on; picture.alone(on); };
  return { element, magnifier, alone };
}

/** The view of the close-up: a camera near the hand, on the same side as the picture's own camera. */
function closely({ stage, tip }) {
  const { camera } = stage;
  const away = camera.position.toArray().map((x, k) => x - tip.p[k]);
  const size = Math.hypot(...away);
  return { eye: away.map((x, k) => tip.p[k] + (NEAR * x) / size), at: tip.p };
}
