// The things around an arm as three.js objects: faces, bands, tags and targets.
import * as THREE from "three";
import { axes, board } from "./marks.js";

const look = (colour, opacity = 1) => new THREE.MeshStandardMaterial({
  color: new THREE.Color().setRGB(...colour, THREE.SRGBColorSpace), roughness: 0.8, side: THREE.DoubleSide,
  transparent: opacity < 1, opacity, depthWrite: opacity >= 1 });

const KINDS = {
  /** A wall or a table top, which is a slab behind its face z = 0; `size` is [x, y]. */
  face: ({ size, colour = [0.75, 0.75, 0.8, 1] }) => {
    const group = new THREE.Group();
    const slab = new THREE.Mesh(new THREE.BoxGeometry(...size, 0.02), look(colour.slice(0, 3), Math.min(0.55, colour[3])));
    slab.position.z = -0.01;
    const rim = new THREE.LineSegments(new THREE.EdgesGeometry(slab.geometry), new THREE.LineBasicMaterial({ color: 0x57606a }));
    rim.position.z = -0.01;
    return group.add(slab, rim);
  },
  /** A rubber band from its anchor to the tip. */
  band: () => {
    const group = new THREE.Group();
    const anchor = new THREE.Mesh(new THREE.SphereGeometry(0.018, 20, 14), look([0.16, 0.47, 0.32]));
    const band = new THREE.Mesh(new THREE.CylinderGeometry(0.004, 0.004, 1, 10), look([0.16, 0.47, 0.32]));
    band.name = "band";
    return group.add(anchor, band);
  },
  /** The target, which is a frame; a pointer can drag it by the small ball in its middle. */
  target: () => {
    const ball = new THREE.Mesh(new THREE.SphereGeometry(0.016, 20, 14), look([0.1, 0.1, 0.12], 0.6));
    return axes().add(ball);
  },
  tag: ({ size = 0.12 }) => board(size),
};

/** Make a thing by its `kind`. */
export const thing = (data) => KINDS[data.kind](data);

/** Move a thing to its `position` and its `quaternion` x y z w; the other end of a band is at `tip`. */
export function place(mark, { position, quaternion }, tip) {
  mark.position.fromArray(position);
  if (quaternion) mark.quaternion.fromArray(quaternion).normalize();
  const band = mark.getObjectByName("band");
  if (!band || !tip) return;
  const way = new THREE.Vector3(...tip).sub(mark.position);
  band.position.copy(way).multiplyScalar(0.5);
  band.scale.y = Math.max(1e-6, way.length());
  band.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
}
