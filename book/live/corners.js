// A tag in a picture whose corners can be dragged: it shows the two poses that they allow, and when the better one changes.
import { add, dot, length, scale } from "./algebra.js";
import { TAG } from "./numbers.js";
import { product } from "./space.js";
import { cornersOf, seen, twoPoses } from "./two_poses.js";

const NAMES = ["upper left", "upper right", "lower right", "lower left"];
const WIDE = 168, TALL = 132; // the part of the picture that is shown, in its pixels, with room for the nearest and most tilted tag
const STEP = 0.5; // step of a button, in pixels
const COLOURS = { A: "var(--lk-line-0)", B: "var(--lk-line-3)" };
const MARGIN = 4;

/** The pose of a tag straight ahead at a distance in [m], turned about the picture's vertical by an angle in degrees. */
export function tilted(distance, degrees) {
  const a = (degrees * Math.PI) / 180, c = Math.cos(a), s = Math.sin(a);
  return { R: product([c, 0, s, 0, 1, 0, -s, 0, c], [1, 0, 0, 0, -1, 0, 0, 0, -1]), p: [0, 0, distance] };
}

/** The corners of a tag in the picture, in pixels from the picture's middle. */
export const pictured = (pose) => cornersOf(TAG.size).map((corner) => scale(TAG.focal, seen(pose, corner)));

/** Both poses by name, and the name of the better one; each name stays with the pose nearer to the one that had it `before`. */
export function named(image, before) {
  const [one, other] = twoPoses(TAG.size, image.map((corner) => scale(1 / TAG.focal, corner)));
  const swapped = before && dot(before.A.R, other.R) > dot(before.A.R, one.R);
  return swapped ? { A: other, B: one, better: "B" } : { A: one, B: other, better: "A" };
}

/** A description of a pose. */
function told({ R, p, miss }) {
  const normal = [R[2], R[5], R[8]], angle = Math.acos(Math.min(1, -dot(normal, p) / length(p)));
  const [side, up] = [normal[0] > 0 ? "to the right" : "to the left", normal[1] > 0 ? "downwards" : "upwards"];
  const way = Math.abs(normal[0]) > Math.abs(normal[1]) ? side : up;
  return `${((angle * 180) / Math.PI).toFixed(0)}° ${way}, ${length(p).toFixed(3)} m away, misses the corners by ${(TAG.focal * miss).toFixed(2)} px`;
}

/** The fieldset with the picture, the descriptions and the controls. */
export function corners({ h, svg, unique, dial }) {
  let image, found, chosen = 0, at = { distance: 0.9, tilt: 15 };
  const art = svg("svg", { class: "lk-corners", viewBox: `${-WIDE / 2} ${-TALL / 2} ${WIDE} ${TALL}`, role: "img",
    "aria-label": "The tag in the picture, and its two poses" });
  const words = { A: h("p", {}), B: h("p", {}) }, said = h("p", { role: "status" });
  const points = (list) => list.map((p) => p.map((x) => x.toFixed(2)).join()).join(" ");

  function draw() {
    const parts = [svg("polygon", { class: "lk-paper", points: points(image) })];
    for (const name of ["A", "B"]) {
      const pose = found[name], style = `stroke: ${COLOURS[name]}; fill: none; stroke-width: ${name === found.better ? 1 : 0.5}`;
      const middle = scale(TAG.focal, seen(pose, [0, 0, 0])), end = scale(TAG.focal, seen(pose, [0, 0, 0.7 * TAG.size]));
      parts.push(svg("polygon", { points: points(pictured(pose)), style }),
        svg("polyline", { points: points([middle, end]), style }),
        svg("text", { x: end[0], y: end[1], style: `fill: ${COLOURS[name]}` }, name));
    }
    image.forEach(([x, y], k) => {
      const grip = svg("circle", { class: "lk-grip", cx: x, cy: y, r: 7 });
      grip.addEventListener("pointerdown", (event) => take(event, k));
      parts.push(svg("circle", { class: k === chosen ? "lk-corner lk-chosen" : "lk-corner", cx: x, cy: y, r: 1.6 }), grip);
    });
    art.replaceChildren(...parts);
  }

  function show(what = "") {
    const before = found?.better;
    found = named(image, found);
    for (const name of ["A", "B"]) words[name].textContent = `Pose ${name}: faces ${told(found[name])}.${name === found.better ? " Chosen." : ""}`;
    if (before && before !== found.better) said.textContent = `The pose flipped: now ${found.better} fits better.`;
    else if (what) said.textContent = what;
    draw();
  }

  function move(k, to) {
    const inside = [WIDE, TALL].map((size, i) => Math.max(MARGIN - size / 2, Math.min(size / 2 - MARGIN, to[i])));
    image = image.map((corner, i) => (i === k ? inside : corner));
    show();
  }

  /** Let a pointer drag corner k until the pointer is released. */
  function take(event, k) {
    event.preventDefault();
    choose.value = String((chosen = k));
    const place = (e) => {
      const box = art.getBoundingClientRect();
      return [WIDE * ((e.clientX - box.left) / box.width - 0.5), TALL * ((e.clientY - box.top) / box.height - 0.5)];
    };
    const off = place(event).map((x, i) => image[k][i] - x);
    const follow = (e) => move(k, add(place(e), off));
    art.setPointerCapture(event.pointerId);
    art.classList.add("lk-held");
    art.addEventListener("pointermove", follow);
    art.addEventListener("lostpointercapture", () => {
      art.classList.remove("lk-held");
      art.removeEventListener("pointermove", follow);
    }, { once: true });
  }

  function start(what) {
    at = { ...at, ...what };
    image = pictured(tilted(at.distance, at.tilt));
    found = null;
    show("These are the tag's true corners, and pose A is right.");
  }

  const dials = [
    { label: "Distance", unit: "m", min: 0.5, max: 1.5, value: at.distance, oninput: (distance) => start({ distance }) },
    { label: "Turned by", unit: "°", min: 0, max: 60, value: at.tilt, oninput: (tilt) => start({ tilt }) }]
    .map((spec) => dial(spec).element);
  const id = unique("corner");
  const choose = h("select", { id, onchange: () => { chosen = +choose.value; draw(); } }, NAMES.map((name, k) => h("option", { value: k }, name)));
  const keys = Object.entries({ left: [-STEP, 0], right: [STEP, 0], up: [0, -STEP], down: [0, STEP] }).map(([name, by]) =>
    h("button", { type: "button", "aria-label": `Corner ${name} ½ px`, onclick: () => move(chosen, add(image[chosen], by)) }, `${name} ½ px`));
  start({});
  said.textContent = "";
  return h("fieldset", {}, h("legend", {}, "One picture, two poses: drag the corners"), art,
    h("div", { class: "lk-twoposes" }, words.A, words.B, said),
    h("div", { class: "lk-dials" }, dials),
    h("div", { class: "lk-pushes" }, h("label", { for: id }, "Corner"), choose, keys, h("button", { type: "button", onclick: () => start({}) }, "Reset")));
}
