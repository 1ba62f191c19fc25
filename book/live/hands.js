// Hands on the arm: a spring to the pointer or finger, and pushes with a given force by button or key.
import { add, length, scale, subtract } from "./algebra.js";
import { push, spring } from "./scene.js";
import { placeOn } from "./session.js";

const PULL = { stiffness: 250, damping: 8 }; // N/m and N s/m of the spring to the pointer
const REACH = 0.2; // the largest length of that spring, in [m]
const PUSH = 1; // duration of a push by button, in [s] of the arm's time

export const AXES = { "+x": [1, 0, 0], "−x": [-1, 0, 0], "+y": [0, 1, 0], "−y": [0, -1, 0], "+z": [0, 0, 1], "−z": [0, 0, -1] };

/** Let pointers take hold of the arm or of `things()`, {name: move(point)}; each hold calls `touched`. */
export function hold(picture, session, things, touched) {
  picture.grab((picked) => {
    const move = things()[picked.thing];
    if (move) return { move: (event) => move(picture.dragged(event, picked.at)), end: () => {} };
    const place = placeOn(session.arm.q, picked.link, picked.at);
    let hand;
    const release = () => { session.hands = session.hands.filter((other) => other !== hand); };
    return {
      move: (event) => {
        release();
        const { p } = session.arm.model.point(session.arm.q, place), away = subtract(picture.dragged(event, picked.at), p);
        hand = { ...spring({ anchor: add(p, scale(1 / Math.max(1, length(away) / REACH), away)), ...PULL, place }), name: "hand" };
        session.hands.push(hand);
        touched();
      },
      end: () => { release(); touched(); },
    };
  }, ({ thing }) => !thing || thing in things());
}

/** Push the tip of the arm along an axis, for a second of its time. */
export function pushTip(session, axis, newtons) {
  session.hands = session.hands.filter(({ name }) => name !== "push");
  session.hands.push({ ...push(scale(newtons, AXES[axis])), name: "push", until: session.loop.t + PUSH });
}

/** Remove pushes whose time is over. */
export function tire(session) {
  session.hands = session.hands.filter(({ until }) => until === undefined || session.loop.t < until);
}
