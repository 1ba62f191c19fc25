// The model of the arm, M(q) ddq + C(q, dq) dq + g(q) = tau.  Its numbers are those of `Robot`, its frames
// are computed from the base to the tip, and its torques by the Newton-Euler method.
import { add, addDiagonal, eigen, scale, subtract, zeros } from "./algebra.js";
import { cross, inner, log, minus, plus, product, reverse, rotated, scaled, spun, withPoint } from "./space.js";

export const GRAVITY = 9.81;
const ZERO = [0, 0, 0];

/** Two bodies combined into one; inertias are about the centres of mass, nine numbers each. */
function joined(A, B) {
  const mass = A.mass + B.mass;
  const com = scaled(1 / mass, plus(scaled(A.mass, A.com), scaled(B.mass, B.com)));
  const both = add(A.inertia, B.inertia);
  return { mass, com, inertia: withPoint(withPoint(both, A.mass, minus(A.com, com)), B.mass, minus(B.com, com)) };
}

/** The arm's bodies as plain numbers; the last one includes the payload in the hand. */
export function bodiesOf({ bodies, tip }, payload) {
  const found = bodies.map((b) => ({
    R: b.T_parent.slice(0, 3).flatMap((row) => row.slice(0, 3)), p: b.T_parent.slice(0, 3).map((row) => row[3]),
    mass: b.mass, com: b.com, inertia: b.inertia.flat() }));
  if (payload > 0) Object.assign(found.at(-1), joined(found.at(-1), { mass: payload, com: tip.p, inertia: zeros(9) }));
  return found;
}

export class Model {
  /** `plant` has the payload in [kg] and each joint's rotor inertia in [kg m^2]. */
  constructor(robot, plant = { payload: 0, armature: zeros(robot.bodies.length) }) {
    Object.assign(this, { robot, plant, n: robot.bodies.length, bodies: bodiesOf(robot, plant.payload) });
  }

  /** Frames of the joints, centres and inertias of the bodies in world axes, and the tip. */
  frames(q) {
    if (q === this.lastq) return this.last;
    let R = [1, 0, 0, 0, 1, 0, 0, 0, 1], p = ZERO;
    const joints = this.bodies.map((body, i) => {
      p = plus(p, rotated(R, body.p));
      R = spun(product(R, body.R), q[i]);
      return { p, R, axis: [R[2], R[5], R[8]], mass: body.mass, com: plus(p, rotated(R, body.com)),
        inertia: product(product(R, body.inertia), reverse(R)) };
    });
    const { tip } = this.robot;
    this.lastq = q;
    return (this.last = { joints, tip: { R: product(R, tip.R), p: plus(p, rotated(R, tip.p)) } });
  }

  /** The tip's pose {R, p} in the world. */
  pose(q) { return this.frames(q).tip; }

  /** J in (v, w) = J dq for the tip's origin in world axes, six rows. */
  tipJacobian(q) {
    const { joints, tip } = this.frames(q);
    const columns = joints.map(({ p, axis }) => cross(axis, minus(tip.p, p)).concat(axis));
    return [0, 1, 2, 3, 4, 5].map((k) => columns.map((c) => c[k]));
  }

  /** The position of a link's point {link, local}, and the three rows of its Jacobian; null means the tip. */
  point(q, place) {
    const { joints, tip } = this.frames(q);
    const p = place ? plus(joints[place.link].p, rotated(joints[place.link].R, place.local)) : tip.p;
    const moved = place ? place.link : this.n - 1;
    const columns = joints.map((joint, i) => (i <= moved ? cross(joint.axis, minus(p, joint.p)) : ZERO));
    return { p, J: [0, 1, 2].map((k) => columns.map((c) => c[k])) };
  }

  /** Velocities and accelerations from the base outwards: w, dw and the origin's acceleration a of each joint. */
  motion(q, dq, ddq, a0) {
    const { joints } = this.frames(q);
    let w = ZERO, dw = ZERO, a = a0, before = ZERO;
    return joints.map(({ p, axis }, i) => {
      a = carried(a, w, dw, minus(p, before));
      const turn = scaled(dq[i], axis);
      dw = plus(plus(dw, scaled(ddq[i], axis)), cross(w, turn));
      w = plus(w, turn);
      before = p;
      return { w, dw, a };
    });
  }

  /** The tip's acceleration dJ/dt dq while the joint speeds are constant. */
  drift(q, dq) {
    const { w, dw, a } = this.motion(q, dq, zeros(this.n), ZERO).at(-1);
    const { joints, tip } = this.frames(q);
    return carried(a, w, dw, minus(tip.p, joints.at(-1).p)).concat(dw);
  }

  /** Torques of a motion by Newton-Euler, without rotors; gravity is an acceleration of the base. */
  newtonEuler(q, dq, ddq, gravity) {
    const { joints } = this.frames(q);
    const motion = this.motion(q, dq, ddq, [0, 0, gravity]);
    const tau = zeros(this.n);
    let force = ZERO, moment = ZERO, at = ZERO;
    for (let i = this.n - 1; i >= 0; i--) {
      const { p, axis, mass, com, inertia } = joints[i], { w, dw, a } = motion[i];
      const arm = minus(com, p);
      const f = scaled(mass, carried(a, w, dw, arm));
      const spin = plus(rotated(inertia, dw), cross(w, rotated(inertia, w)));
      moment = plus(plus(plus(moment, cross(minus(at, p), force)), cross(arm, f)), spin);
      force = plus(force, f);
      at = p;
      tau[i] = inner(axis, moment);
    }
    return tau;
  }

  /** M(q), from the bodies beyond each joint combined into one body (Featherstone, section 6.2). */
  massMatrix(q) {
    const { joints } = this.frames(q);
    const M = zeros(this.n).map(() => zeros(this.n));
    let whole = null;
    for (let j = this.n - 1; j >= 0; j--) {
      whole = whole ? joined(whole, joints[j]) : joints[j];
      const { p, axis } = joints[j];
      const force = scaled(whole.mass, cross(axis, minus(whole.com, p)));
      const spin = rotated(whole.inertia, axis);
      for (let i = 0; i <= j; i++) {
        M[i][j] = M[j][i] = inner(joints[i].axis, plus(spin, cross(minus(whole.com, joints[i].p), force)));
      }
    }
    return addDiagonal(M, this.plant.armature);
  }

  gravity(q) { return this.newtonEuler(q, zeros(this.n), zeros(this.n), GRAVITY); }
  /** C(q, dq) dq + g(q). */
  bias(q, dq) { return this.newtonEuler(q, dq, zeros(this.n), GRAVITY); }
  /** M ddq + C dq + g. */
  inverseDynamics(q, dq, ddq) {
    return this.newtonEuler(q, dq, ddq, GRAVITY).map((x, i) => x + this.plant.armature[i] * ddq[i]);
  }

  /** C(q, a) b.  With Christoffel symbols it is symmetric in a and b, and so the mixed term of a square. */
  coriolisTimes(q, a, b) {
    const square = (v) => this.newtonEuler(q, v, zeros(this.n), 0);
    return scale(0.5, subtract(subtract(square(add(a, b)), square(a)), square(b)));
  }

  /** Target minus actual in world axes: the difference of positions, and the rotation between them. */
  poseError(target, q) {
    const tip = this.pose(q);
    return minus(target.p, tip.p).concat(log(product(target.R, reverse(tip.R))));
  }
}

/** The acceleration of a point at r on a body whose origin accelerates with a. */
const carried = (a, w, dw, r) => plus(plus(a, cross(dw, r)), cross(w, cross(w, r)));

/** A body's principal moments and axes in MuJoCo's form, moments and a quaternion w, x, y, z. */
export function principal(inertia) {
  const { values, axes } = eigen([0, 3, 6].map((k) => inertia.slice(k, k + 3)));
  const [a, b] = axes, c = cross(a, b);
  return { moments: values, quaternion: quaternion([a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2]]) };
}

export function quaternion([xx, xy, xz, yx, yy, yz, zx, zy, zz]) {
  const four = [xx + yy + zz, xx - yy - zz, yy - xx - zz, zz - xx - yy];
  const k = four.indexOf(Math.max(...four)), most = Math.sqrt(four[k] + 1) / 2, s = 1 / (4 * most);
  return [
    [most, s * (zy - yz), s * (xz - zx), s * (yx - xy)],
    [s * (zy - yz), most, s * (xy + yx), s * (xz + zx)],
    [s * (xz - zx), s * (xy + yx), most, s * (yz + zy)],
    [s * (yx - xy), s * (xz + zx), s * (yz + zy), most]][k];
}
