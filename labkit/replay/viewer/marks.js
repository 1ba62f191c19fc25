// Marks drawn beside the robot: lines, frames, arrows and the tag's board.
import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";

/** A line through the points in rows (K, 3); `dash` and `gap` are in metres. */
export function line(rows, { colour, width = 3, dash, gap, opacity = 1 }) {
  const shape = new LineGeometry();
  shape.setPositions(rows.flat());
  const look = new LineMaterial({
    color: colour, linewidth: width, dashed: !!dash, dashSize: dash ?? 1, gapSize: gap ?? 1,
    transparent: opacity < 1, opacity });
  const made = new Line2(shape, look);
  made.computeLineDistances();
  return made;
}

/** The axes x, y, z with one, two and three rings, so that they can be told apart without colour. */
export function axes(length = 0.09) {
  const group = new THREE.Group();
  const turn = [[0, 0, -Math.PI / 2], [0, 0, 0], [Math.PI / 2, 0, 0]];
  [0xd1242f, 0x2da44e, 0x218bff].forEach((colour, k) => {
    const look = new THREE.MeshBasicMaterial({ color: colour });
    const axis = new THREE.Group();
    const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.004, 0.004, length, 10), look);
    rod.position.y = length / 2;
    const head = new THREE.Mesh(new THREE.ConeGeometry(0.011, 0.026, 16), look);
    head.position.y = length;
    axis.add(rod, head);
    for (let ring = 0; ring <= k; ring++) {
      const band = new THREE.Mesh(new THREE.CylinderGeometry(0.008, 0.008, 0.005, 12), look);
      band.position.y = 0.3 * length + 0.012 * ring;
      axis.add(band);
    }
    axis.rotation.set(...turn[k]);
    group.add(axis);
  });
  return group;
}

/** An arrow that can be moved to a point and set to a vector. */
export function arrow(colour) {
  const made = new THREE.Group(), look = new THREE.MeshStandardMaterial({ color: colour, roughness: 0.6 });
  const rod = new THREE.Mesh(new THREE.CylinderGeometry(0.0055, 0.0055, 1, 20), look);
  const head = new THREE.Mesh(new THREE.ConeGeometry(0.016, 0.042, 28), look);
  const knob = new THREE.Mesh(new THREE.SphereGeometry(0.013, 24, 16), look); // where it acts
  made.lay = (origin, vector) => {
    const along = new THREE.Vector3(...vector), length = along.length(), share = Math.min(1, length / 0.084);
    made.visible = length > 1e-4;
    made.position.fromArray(origin);
    made.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.normalize());
    head.scale.setScalar(share);
    head.position.y = length - 0.021 * share;
    knob.scale.setScalar(share);
    rod.scale.set(share, Math.max(1e-6, length - 0.042 * share), share);
    rod.position.y = rod.scale.y / 2;
  };
  return made.add(rod, head, knob);
}

/** A square board that represents the tag: white rim, black face, white cell. */
export function board(size = 0.12) {
  const group = new THREE.Group();
  [[1, 0xf5f5f5, 0], [0.8, 0x111111, 0.001], [0.26, 0xf5f5f5, 0.002]].forEach(([scale, colour, z]) => {
    const look = new THREE.MeshBasicMaterial({ color: colour, side: THREE.DoubleSide });
    const face = new THREE.Mesh(new THREE.PlaneGeometry(scale * size, scale * size), look);
    face.position.z = z;
    group.add(face);
  });
  return group;
}

/** Free the memory of a mark on the graphics card. */
export function dispose(mark) {
  mark.traverse((part) => { part.geometry?.dispose(); part.material?.dispose?.(); });
}
