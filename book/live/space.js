// Vectors of three numbers and rotations of nine, without loops, because a physics step uses hundreds of them.
export { log } from "../../labkit/replay/viewer/so3.js";

export const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
export const inner = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const rotated = (R, v) => [
  R[0] * v[0] + R[1] * v[1] + R[2] * v[2], R[3] * v[0] + R[4] * v[1] + R[5] * v[2], R[6] * v[0] + R[7] * v[1] + R[8] * v[2]];
export const reverse = (R) => [R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8]];

/** A B. */
export function product(A, B) {
  const C = new Array(9);
  for (let i = 0; i < 9; i += 3) {
    for (let j = 0; j < 3; j++) C[i + j] = A[i] * B[j] + A[i + 1] * B[3 + j] + A[i + 2] * B[6 + j];
  }
  return C;
}

/** R rotated about its own z axis. */
export function spun(R, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [
    c * R[0] + s * R[1], c * R[1] - s * R[0], R[2],
    c * R[3] + s * R[4], c * R[4] - s * R[3], R[5],
    c * R[6] + s * R[7], c * R[7] - s * R[6], R[8]];
}

/** The nine numbers of `inertia` plus the inertia of a point mass at d. */
export function withPoint(inertia, mass, d) {
  const square = inner(d, d), out = inertia.slice();
  for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) out[3 * i + j] += mass * ((i === j ? square : 0) - d[i] * d[j]);
  return out;
}
