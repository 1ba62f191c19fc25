// A 3-D view in the page.  All stages share one WebGL context: a single renderer draws each frame,
// which is copied to the stage's own 2-D canvas, so a page can have any number of viewers.
import * as THREE from "three";
import { FIELD, Rig } from "./rig.js";
import { h } from "./dom.js";

const HURRY = 0.55; // factor of the size while a picture moves and the processor has to draw it
const CALM = 400; // ms without another picture before the last one is drawn at full size
const LONG = 40; // ms of drawing without a card; longer drawing leaves the page's timers time to run

let renderer; // undefined: not tried yet; null: this browser has no WebGL
let card; // whether there is a graphics card
const stages = new Set();

function context() {
  if (renderer !== undefined) return renderer;
  const canvas = document.createElement("canvas");
  card = hasCard();
  const gl = canvas.getContext("webgl2", { antialias: card, powerPreference: "low-power" });
  if (!gl) return (renderer = null);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => stages.forEach((s) => s.draw()));
  renderer = new THREE.WebGLRenderer({ canvas, context: gl });
  Object.assign(renderer.shadowMap, { enabled: card, type: THREE.VSMShadowMap });
  return renderer;
}

/** Smooth edges are used only with a card, because they double the time if the processor draws. */
function hasCard() {
  const probe = document.createElement("canvas").getContext("webgl2");
  const info = probe?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? probe.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  probe?.getExtension("WEBGL_lose_context")?.loseContext();
  return !/swiftshader|llvmpipe|software/i.test(name);
}

export class Stage {
  /** A canvas inside `host`; `this.works` is false without WebGL. */
  constructor(host, label) {
    this.works = context() !== null;
    this.canvas = h("canvas", {
      class: "lk-canvas", tabindex: 0, role: "application", "aria-roledescription": "3-D view",
      "aria-label": `${label}. Arrow keys turn the view, plus and minus zoom, 1 to 4 choose a view.` });
    this.overlay = h("div", { class: "lk-overlay", "aria-hidden": "true" });
    this.host = host;
    if (!this.works) return;
    host.append(this.canvas, this.overlay);
    this.paper = this.canvas.getContext("2d");
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD, 4 / 3, 0.05, 30);
    this.camera.up.set(0, 0, 1);
    this.rig = new Rig(this.canvas, this.camera, () => this.draw());
    this.light();
    this.visible = true;
    this.waiting = this.rest = 0;
    this.labels = [];
    this.watch = [new ResizeObserver(() => this.draw()), new IntersectionObserver(([entry]) => {
      this.visible = entry.isIntersecting;
      this.draw();
    }), new MutationObserver(() => { this.themed?.(); this.draw(); })];
    this.watch[0].observe(this.canvas);
    this.watch[1].observe(this.canvas);
    const theme = { attributeFilter: ["data-theme", "data-jp-theme-light"] };
    this.watch[2].observe(document.documentElement, theme);
    this.watch[2].observe(document.body, theme);
    stages.add(this);
  }

  light() {
    const key = new THREE.DirectionalLight(0xffffff, 2.6);
    key.position.set(2.5, -1.5, 4);
    const rim = new THREE.DirectionalLight(0xdfe8ff, 2.6);
    rim.position.set(-3, 2, 2.5);
    const side = new THREE.DirectionalLight(0xfff1e0, 1.2); // makes the edge of a dark arm visible in front of a dark body
    side.position.set(1, 4, 0.5);
    key.castShadow = true;
    Object.assign(key.shadow, { radius: 5, blurSamples: 10 });
    const disc = new THREE.CircleGeometry(1.9, 64), fade = h("canvas", { width: 128, height: 128 }), pen = fade.getContext("2d");
    pen.fillStyle = pen.createRadialGradient(64, 64, 20, 64, 64, 64);
    ["#fff", "#000"].forEach((grey, k) => pen.fillStyle.addColorStop(k, grey));
    pen.fillRect(0, 0, 128, 128);
    this.floor = new THREE.Mesh(disc, new THREE.MeshBasicMaterial({ alphaMap: new THREE.CanvasTexture(fade), transparent: true, opacity: 0.4, depthWrite: false }));
    const shade = new THREE.Mesh(disc, new THREE.ShadowMaterial({ opacity: 0.3, depthWrite: false }));
    shade.receiveShadow = true;
    shade.position.z = 0.002;
    this.floor.add(shade);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9ca3, 2.4), key, rim, side, this.floor);
  }

  /** A text that follows a point; `place()` returns [x, y, z], or nothing while there is no point. */
  label(text, place, colour) {
    const element = h("span", { class: "lk-tag" }, text);
    if (colour) element.style.borderColor = colour;
    this.overlay.append(element);
    const made = { element, place };
    this.labels.push(made);
    return made;
  }

  /** Remove a text. */
  unlabel(label) {
    label.element.remove();
    this.labels = this.labels.filter((other) => other !== label);
  }

  /** Request a frame; many calls lead to one frame. */
  draw() {
    if (!this.works || !this.visible || this.waiting) return;
    this.waiting = requestAnimationFrame((now) => {
      this.waiting = 0;
      if (now < this.rest) this.draw();
      else this.paint();
    });
  }

  paint() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const now = performance.now(), hurried = !card && now - this.last < CALM;
    this.last = now;
    clearTimeout(this.calm);
    if (hurried) this.calm = setTimeout(() => this.draw(), CALM);
    const fine = card ? Math.min(2, devicePixelRatio) : 1, drawn = hurried ? HURRY : fine;
    const [w, t] = [Math.round(width * drawn), Math.round(height * drawn)];
    const [W, T] = [Math.round(width * fine), Math.round(height * fine)];
    if (this.canvas.width !== W || this.canvas.height !== T) Object.assign(this.canvas, { width: W, height: T });
    const style = getComputedStyle(this.canvas);
    const colour = (name) => new THREE.Color(style.getPropertyValue(name).trim() || "#888");
    this.floor.material.color = colour("--lk-grid");
    renderer.setClearColor(colour("--lk-sky"));
    renderer.setPixelRatio(1);
    const size = renderer.getSize(new THREE.Vector2());
    if (size.x !== w || size.y !== t) renderer.setSize(w, t, false);
    this.rig.frame(width / height);
    renderer.render(this.scene, this.camera);
    this.paper.drawImage(renderer.domElement, 0, 0, w, t, 0, 0, W, T);
    this.settle(width, height);
    const end = performance.now();
    this.rest = card ? 0 : 2 * end - now - LONG;
    this.drawn?.();
  }

  /** A Raycaster along the line of sight through a pointer's position in the page. */
  ray({ clientX, clientY }) {
    const box = this.canvas.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.params.Line.threshold = 0.005; // three.js has a default of one metre
    caster.setFromCamera(new THREE.Vector2(
      2 * (clientX - box.left) / box.width - 1, 1 - 2 * (clientY - box.top) / box.height), this.camera);
    return caster;
  }

  /** Put the labels beside their points, where they hide no hand, and move labels apart that would overlap. */
  settle(width, height) {
    const spots = this.labels.map(({ element, place }) => {
      const at = place();
      if (!at) return { element, x: 0, y: -Infinity, behind: true };
      const p = new THREE.Vector3(...at).project(this.camera);
      return { element, x: (p.x + 1) * width / 2, y: (1 - p.y) * height / 2, behind: p.z > 1 };
    }).sort((a, b) => a.y - b.y);
    let last = -Infinity;
    for (const { element, x, y, behind } of spots) {
      element.hidden = behind;
      if (behind) continue;
      const { offsetWidth: wide, offsetHeight: high } = element;
      last = Math.max(y - high / 2, last + high);
      const left = Math.max(4, Math.min(x + 14, width - wide - 4));
      element.style.transform = `translate(${Math.round(left)}px, ${Math.round(last)}px)`;
    }
  }

  dispose() {
    cancelAnimationFrame(this.waiting);
    clearTimeout(this.calm);
    this.watch?.forEach((w) => w.disconnect());
    stages.delete(this);
  }
}
