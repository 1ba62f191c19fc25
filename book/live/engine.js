// MuJoCo's WebAssembly as the engine of an arm, with the same model file as `labkit/sim/mujoco.py`.
import { bodiesOf, principal } from "./model.js";

const OFF = ["mjDSBL_CONSTRAINT", "mjDSBL_SENSOR", "mjDSBL_ACTUATION", "mjDSBL_AUTORESET"];

/** A plain array copied from a typed one, many times faster than with Array.from. */
function numbers(typed) {
  const out = new Array(typed.length);
  for (let i = 0; i < out.length; i++) out[i] = typed[i];
  return out;
}

export class Engine {
  /** `mujoco` is the loaded module; the lab's own code simulates stops, contacts and friction. */
  constructor(mujoco, robot, plant, dt) {
    Object.assign(this, { mujoco, model: mujoco.MjModel.from_xml_string(robot.urdf) });
    const { model } = this;
    model.opt.timestep = dt;
    model.opt.disableflags = OFF.reduce((flags, name) => flags | mujoco.mjtDisableBit[name].value, model.opt.disableflags);
    model.dof_armature.set(plant.armature);
    if (plant.payload > 0) this.carry(bodiesOf(robot, plant.payload).at(-1));
    this.data = new mujoco.MjData(model);
  }

  /** Give the last body another mass, centre and inertia. */
  carry({ mass, com, inertia }) {
    const { model } = this, last = model.body_mass.length - 1;
    const { moments, quaternion } = principal(inertia);
    model.body_mass[last] = mass;
    model.body_ipos.set(com, 3 * last);
    model.body_inertia.set(moments, 3 * last);
    model.body_iquat.set(quaternion, 4 * last);
  }

  /** Views of MuJoCo's memory, which are made again if the memory has grown. */
  view() {
    if (this.q?.length) return this;
    return Object.assign(this, { q: this.data.qpos, dq: this.data.qvel, tau: this.data.qfrc_applied });
  }

  place(q, dq) {
    this.view().q.set(q);
    this.dq.set(dq);
  }

  state() {
    const { q, dq } = this.view();
    return [numbers(q), numbers(dq)];
  }

  step(tau) {
    this.view().tau.set(tau);
    this.mujoco.mj_step(this.model, this.data);
  }

  close() {
    this.data.delete();
    this.model.delete();
  }
}
