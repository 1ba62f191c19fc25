// The report's tasks: a line, a circle, a square with stops at its corners, and a tag; `solutions/study/tasks.py`.
import { add } from "./algebra.js";
import { chain, circle, hold, line, polyline, posePath, trajectory, within } from "./paths.js";

/** Follow paths one after another, with rests between them, and hold at the end; all numbers are from `constants.task`. */
export function smooth(paths, R, { shape = "quintic", speed, acceleration, rest }) {
  const parts = paths.map((path) => {
    const { scaling, duration } = within(shape, path.distance, speed, acceleration);
    return trajectory(posePath(path, R), scaling, duration);
  });
  return chain([...parts, hold(parts.at(-1).path(1).pose, rest)]);
}

/** The paths of the tasks whose target is known beforehand, from the tip's ready pose. */
export const PATHS = {
  line: (p, task) => [line(p, add(p, task.line))],
  circle: (p, task) => [circle(p, add(p, task.circle))],
  square: (p, task) => polyline([p, ...task.square.map((goal) => add(p, goal)), p]),
};

/** The target of poses of a task by its name. */
export function taskTarget(name, ready, task) {
  return smooth(PATHS[name](ready.p, task), ready.R, task);
}
