// The camera's stand, which turns about a point by mouse, finger or keys, without inertia.
import * as THREE from "three";

export const FIELD = 35; // the vertical field of view, in degrees

/** The point to look at, and the distance, to see all these points with room for a hand around them. */
export function framing(points) {
  const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k])));
  const high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
  const radius = 0.5 * Math.hypot(...high.map((x, k) => x - low[k])) + 0.12;
  return { target: high.map((x, k) => (x + low[k]) / 2), distance: radius / Math.sin((0.5 * FIELD * Math.PI) / 180) };
}

export const VIEWS = {
  Motion: { azimuth: 1.2, elevation: 0.5, distance: 1.6, target: [0.7, 0, 0.2] },
  Front: { azimuth: 0.5, elevation: 0.22, distance: 3.1, target: [0.3, 0, -0.02] },
  Side: { azimuth: 1.5708, elevation: 0.12, distance: 3.4, target: [0.4, 0, -0.06] },
  Top: { azimuth: 0, elevation: 1.5, distance: 3.0, target: [0.5, 0, 0] },
};

export class Rig {
  // If `grab(event)` is set, it is called first to find what a pointer takes hold of.  It returns
  // {move(event), end(event)}, or nothing if the pointer is to turn the view.
  constructor(canvas, camera, changed) {
    Object.assign(this, { camera, changed, mirror: 1, size: 1, motion: VIEWS.Motion });
    this.use("Motion");
    this.listen(canvas);
  }

  /** Go to a named view, which is mirrored for the right arm. */
  use(name) {
    Object.assign(this, name === "Motion" ? this.motion : VIEWS[name]);
    if (name !== "Top") this.azimuth *= this.mirror;
    this.view = name;
    this.changed();
  }

  /** Let the view "Motion" show all of these points [x, y, z]. */
  around(points) {
    this.motion = { ...VIEWS.Motion, ...framing(points) };
  }

  turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.min(1.55, Math.max(-1.2, this.elevation + dy));
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(8, Math.max(0.3, this.distance * factor));
    this.changed();
  }

  /** Put the camera in its place for this frame. */
  frame(aspect) {
    const c = Math.cos(this.elevation);
    const { target } = this;
    const reach = (this.view === "Motion" ? 1 : this.size) * this.distance * Math.max(1, 1.15 / aspect);
    this.camera.position.set(
      target[0] + reach * c * Math.cos(this.azimuth), target[1] + reach * c * Math.sin(this.azimuth),
      target[2] + reach * Math.sin(this.elevation));
    this.camera.lookAt(new THREE.Vector3(...target));
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }

  listen(canvas) {
    const held = new Map(); // pointers down, by id
    let grip = null; // what `grab` returned for the pointer that took hold of something
    canvas.addEventListener("pointerdown", (e) => {
      canvas.setPointerCapture(e.pointerId);
      const taken = grip ? null : this.grab?.(e);
      if (taken) grip = { id: e.pointerId, ...taken };
      else held.set(e.pointerId, [e.clientX, e.clientY]);
    });
    canvas.addEventListener("pointermove", (e) => {
      if (grip?.id === e.pointerId) { grip.move(e); return; }
      const before = held.get(e.pointerId);
      if (!before) return;
      if (held.size === 2) {
        const other = [...held].find(([id]) => id !== e.pointerId)[1];
        const span = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]);
        this.zoom(span(before) / Math.max(1, span([e.clientX, e.clientY])));
      } else this.turn((e.clientX - before[0]) * 0.008, (e.clientY - before[1]) * 0.008);
      held.set(e.pointerId, [e.clientX, e.clientY]);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(name, (e) => {
        if (grip?.id === e.pointerId) { grip.end(e); grip = null; }
        held.delete(e.pointerId);
      });
    }
    canvas.addEventListener("wheel", (e) => { // only if the canvas has the focus, so that the page still scrolls
      if (document.activeElement !== canvas) return;
      e.preventDefault();
      this.zoom(Math.exp(e.deltaY * 0.001));
    }, { passive: false });
    canvas.addEventListener("keydown", (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      const act = {
        ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0),
        ArrowUp: () => this.turn(0, 0.1), ArrowDown: () => this.turn(0, -0.1),
        "+": () => this.zoom(0.9), "=": () => this.zoom(0.9), "-": () => this.zoom(1 / 0.9),
      }[e.key] ?? (Object.keys(VIEWS)[e.key - 1] && (() => this.use(Object.keys(VIEWS)[e.key - 1])));
      if (!act) return;
      e.preventDefault();
      e.stopPropagation();
      act();
    });
  }
}
