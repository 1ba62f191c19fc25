// A robot as three.js objects, with a group for each joint; a page makes Baxter's geometries only once.
import * as THREE from "three";
import { frames, posture } from "./kinematics.js";

let shared; // geometries and materials, made once

const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;

function geometry({ low, size, position, normal, index }) {
  const whole = new Uint16Array(bytes(position));
  const points = new Float32Array(whole.length);
  for (let i = 0; i < whole.length; i++) points[i] = low[i % 3] + (whole[i] / 65535) * size[i % 3];
  const made = new THREE.BufferGeometry();
  made.setAttribute("position", new THREE.BufferAttribute(points, 3));
  made.setAttribute("normal", new THREE.BufferAttribute(new Int8Array(bytes(normal)), 3, true));
  made.setIndex(new THREE.BufferAttribute(new Uint16Array(bytes(index)), 1));
  return made;
}

function parts(robot) {
  shared ??= {
    geometries: robot.meshes.map(geometry),
    materials: Object.fromEntries(Object.entries(robot.palette).map(([name, rgb]) => [name,
      new THREE.MeshStandardMaterial({
        color: new THREE.Color().setRGB(...rgb, THREE.SRGBColorSpace),
        roughness: name === "grey" ? 0.4 : 0.55, metalness: name === "grey" ? 0.4 : 0.05,
      })])),
  };
  return shared;
}

/** The length of a stretched arm without meshes, in metres. */
export const span = (robot) => [...robot.joints, ...Object.values(robot.tips)]
  .reduce((sum, { position }) => sum + Math.hypot(...position), 0);

/** The links of an arm without meshes: a capsule from each joint to the next, and to the tip. */
function capsules(robot) {
  const links = [...robot.joints, ...Object.values(robot.tips)];
  const ends = links.map(({ position }) => new THREE.Vector3(...position));
  const radius = 0.035 * span(robot);
  return links.map(({ parent }, k) => {
    const mesh = new THREE.Mesh(new THREE.CapsuleGeometry(radius, ends[k].length(), 6, 18));
    mesh.position.copy(ends[k]).multiplyScalar(0.5);
    mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), ends[k].clone().normalize());
    return { parent, mesh };
  });
}

/** Baxter's pieces; with a side, only those of one arm. */
function pieces(robot, side) {
  const { geometries, materials } = parts(robot);
  return robot.pieces.filter(({ parent }) => !side || parent.startsWith(side)).map((piece) => {
    const mesh = new THREE.Mesh(geometries[piece.mesh], materials[robot.meshes[piece.mesh].colour]);
    mesh.position.fromArray(piece.position);
    mesh.quaternion.fromArray(piece.quaternion);
    return { parent: piece.parent, mesh };
  });
}

/** The whole robot; with `ghost` {side, colour}, one see-through arm. */
export class Body {
  constructor(robot, ghost) {
    this.robot = robot;
    this.root = new THREE.Group();
    this.groups = { base: new THREE.Group() };
    for (const joint of robot.joints) this.groups[joint.name] = new THREE.Group();
    this.own = ghost && new THREE.MeshStandardMaterial({ // drawn as if a few mm behind, so that the arm itself stays red
      color: ghost.colour, transparent: true, opacity: 0.38, roughness: 0.8, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 400 });
    if (robot.arm) this.own ??= new THREE.MeshStandardMaterial({ color: 0x8a9099, roughness: 0.5 });
    for (const { parent, mesh } of robot.arm ? capsules(robot) : pieces(robot, ghost?.side)) {
      if (this.own) mesh.material = this.own;
      if (ghost) mesh.renderOrder = 1;
      mesh.castShadow = !ghost;
      this.groups[parent].add(mesh);
    }
    this.root.add(...Object.values(this.groups));
  }

  /** Move one arm to q. */
  pose(side, q) {
    const found = frames(this.robot, posture(this.robot, side, q));
    for (const [name, { R, p }] of Object.entries(found)) {
      const group = this.groups[name];
      group.matrixAutoUpdate = false;
      group.matrix.set(R[0], R[1], R[2], p[0], R[3], R[4], R[5], p[1], R[6], R[7], R[8], p[2], 0, 0, 0, 1);
      group.matrixWorldNeedsUpdate = true;
    }
  }

  dispose() { this.own?.dispose(); }
}
