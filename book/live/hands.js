// Hands on the arm: a spring to the pointer or finger, and pushes with a given force by button or key.
import { add, length, scale, subtract } from "./algebra.js";
import { push, spring } from "./scene.js";
import { placeOn } from "./session.js";

const PULL = { stiffness: 250, damping: 8 }; // N/m and N s/m of the spring to the pointer
const REACH = 0.2; // the largest length of that spring, in [m]
const PUSH = 1; // duration of a push by button, in [s] of the arm's time

export const AXES = { "+x": [1, 0, 0], "−x": [-1, 0, 0], "+y": [0, 1, 0], "−y": [0, -1, 0], "+z": [0, 0, 1], "−z": [0, 0, -1] };

/** Let pointers take hold of the arm or of `things()`, {name: move(point)}; each hold calls `touched`. */
export function hold(picture, sessions, things, touched) {
  picture.grab((picked) => {
    const move = things()[picked.thing];
    if (move) return { move: (event) => move(picture.dragged(event, picked.at)), end: () => {} };
    const hands = sessions().map((session) => ({ session, place: placeOn(session.arm.q, picked.link, picked.at) }));
    const release = () => hands.forEach(({ session, hand }) => { session.hands = session.hands.filter((other) => other !== hand); });
    return {
      move: (event) => {
        const anchor = picture.dragged(event, picked.at);
        release();
        for (const hand of hands) {
          const { session, place } = hand, { p } = session.arm.model.point(session.arm.q, place);
          const away = subtract(anchor, p), far = Math.max(1, length(away) / REACH);
          hand.hand = { ...spring({ anchor: add(p, scale(1 / far, away)), ...PULL, place }), name: "hand" };
          session.hands.push(hand.hand);
        }
        touched();
      },
      end: () => { release(); touched(); },
    };
  }, ({ thing }) => !thing || thing in things());
}

/** Push the tips of the arms in `sessions` along an axis, for a second of their time. */
export function pushTips(sessions, axis, newtons) {
  for (const session of sessions) {
    session.hands = session.hands.filter(({ name }) => name !== "push");
    session.hands.push({ ...push(scale(newtons, AXES[axis])), name: "push", until: session.loop.t + PUSH });
  }
}

/** Remove pushes whose time is over. */
export function tire(session) {
  session.hands = session.hands.filter(({ until }) => until === undefined || session.loop.t < until);
}
