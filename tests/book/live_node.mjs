// Runs the book's live arm in node: reads a list of requests from stdin, writes the answers to stdout.
import { readFileSync } from "node:fs";
import { runInThisContext } from "node:vm";
import { gunzipSync } from "node:zlib";
import { Arm } from "../../book/live/arm.js";
import { named, pictured, tilted } from "../../book/live/corners.js";
import * as laws from "../../book/live/controllers.js";
import { jointTrajectory } from "../../book/live/inverse.js";
import { Model } from "../../book/live/model.js";
import * as numbers from "../../book/live/numbers.js";
import { described } from "../../book/live/panel.js";
import { run } from "../../book/live/run.js";
import { spring, wall } from "../../book/live/scene.js";
import { ANGLES, atElbow, told } from "../../book/live/singular_piece.js";
import { PRESETS } from "../../book/live/settings.js";
import { taskTarget } from "../../book/live/tasks.js";
import { twoPoses } from "../../book/live/two_poses.js";

const { ROBOT, PLANTS, CONTROLLERS, CONSTANTS, TASK } = numbers;
const bundle = new URL("../../book/live/bundle/", import.meta.url);

async function engine() {
  globalThis.window = globalThis; // because MuJoCo's script is made for pages
  runInThisContext(readFileSync(new URL("mujoco.js", bundle), "utf8"));
  return globalThis.labkitLoadMuJoCo({ wasmBinary: gunzipSync(readFileSync(new URL("mujoco.wasm.gz", bundle))) });
}

/** A plant by its name, without random effects and with the changes of a test. */
const quiet = ({ plant, change }) => ({ ...PLANTS[plant], velocity_noise: ROBOT.ready.map(() => 0), lost_ticks: 0, ...change });

const ASK = {
  numbers: () => numbers,
  model: ({ q, dq, ddq, payload, armature }) => {
    const model = new Model(ROBOT, { payload, armature });
    return { M: model.massMatrix(q), h: model.bias(q, dq), tau: model.inverseDynamics(q, dq, ddq), drift: model.drift(q, dq),
      J: model.tipJacobian(q), pose: model.pose(q), Cd: model.coriolisTimes(q, dq, ddq) };
  },
  commands: ({ plant, controller, states }) => {
    const law = laws[controller](new Model(ROBOT, PLANTS[plant]), CONTROLLERS[plant][controller].gains);
    return states.map(([state, target]) => law(state, target).value);
  },
  flip: ({ distance, tilt }) => { // moves the upper right corner down in steps of half a pixel
    const corners = pictured(tilted(distance, tilt));
    let found = named(corners, null), count = 0;
    while (found.better === "A" && count < 100) {
      corners[1][1] += 0.5;
      found = named(corners, found);
      count += 1;
    }
    return count;
  },
  stretched: ({ lambda2 }) => told(lambda2, ANGLES, ANGLES.map((e1) => atElbow(e1, lambda2))),
  described: ({ plant, gains, change }) => described({ ...PRESETS[plant], controller: "jointVelocity", gains, ...change }),
  poses: ({ size, image }) => twoPoses(size, image),
  run: (request) => {
    const { controller, task, duration, things = [], start } = request;
    const plant = quiet(request), model = new Model(ROBOT, plant), { gains, rate, joints } = CONTROLLERS[request.plant][controller];
    const q0 = start ?? ROBOT.ready;
    const poses = taskTarget(task, new Model(ROBOT).pose(ROBOT.ready), TASK);
    const target = joints ? jointTrajectory(new Model(ROBOT), poses, ROBOT.ready, 101) : poses;
    const arm = new Arm(mujoco, ROBOT, plant, CONSTANTS);
    arm.reset(q0);
    arm.things = things.map((thing) => (thing.anchor ? spring(thing) : wall({ ...CONSTANTS.wall, ...thing }, CONSTANTS.pad)));
    const log = run(arm, target, laws[controller](model, gains), { rate, runaway: CONSTANTS.runaway, duration });
    arm.close();
    return log.map(({ q }) => q);
  },
};

const mujoco = await engine();
console.log(JSON.stringify(JSON.parse(readFileSync(0, "utf8")).map((request) => ASK[request.ask](request))));
