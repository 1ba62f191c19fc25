// The dials of each controller and of the arm, with their labels, units, ranges and the values that they set.
import { CONTROLLERS } from "./numbers.js";

const first = (x) => (Array.isArray(x) ? x[0] : x);

/** The dials of a controller's gains, which begin at the gains of the comparison. */
export function gainDials(plant, controller) {
  const { gains } = CONTROLLERS[plant][controller];
  const of = (key, label, unit, max) => ({ key, label, unit, min: 0, max, value: first(gains[key]) });
  return {
    workspaceVelocity: () => [of("Kp", "Kp", "1/s", 40), of("Kd", "Kd", "", 2)],
    jointVelocity: () => [of("Kp", "Kp", "1/s", 40), of("Kd", "Kd", "", 2)],
    jointTorque: () => [of("Kp", "Kp", "1/s²", 1000), of("Kd", "Kd", "1/s", 100)],
    workspaceImpedance: () => [
      { key: "K", label: "Stiffness K", unit: "N/m", min: 30, max: 3000, ratio: true, value: first(gains.K) },
      { key: "zeta", label: "Damping ζ", unit: "", min: 0.05, max: 3, value: gains.zeta }],
    jointImpedance: () => [
      { key: "stiffness", label: "Stiffness ×", unit: "", min: 0.1, max: 5, ratio: true, value: 1 },
      { key: "damping", label: "Damping ×", unit: "", min: 0.05, max: 3, value: 1 }],
    baxtersOwn: () => [],
  }[controller]();
}

/** The dials of the arm and of its surroundings. */
export const ARM_DIALS = [
  { key: "friction", label: "Friction ×", unit: "Baxter's", min: 0, max: 3 },
  { key: "payload", label: "Payload", unit: "kg", min: 0, max: 2 },
  { key: "lag", label: "Lag", unit: "ms", min: 0, max: 150 },
  { key: "latency", label: "Latency", unit: "ms", min: 0, max: 60 },
  { key: "noise", label: "Noise ×", unit: "Baxter's", min: 0, max: 5 },
  { key: "speed", label: "Top speed", unit: "m/s", min: 0.05, max: 0.6 },
];
