// Rotations as nine numbers, row by row; vectors as three numbers.

export const IDENTITY = [1, 0, 0, 0, 1, 0, 0, 0, 1];

export const multiply = (A, B) => [0, 3, 6].flatMap((i) =>
  [0, 1, 2].map((j) => A[i] * B[j] + A[i + 1] * B[j + 3] + A[i + 2] * B[j + 6]));
export const apply = (A, v) => [0, 3, 6].map((i) => A[i] * v[0] + A[i + 1] * v[1] + A[i + 2] * v[2]);
export const transpose = (A) => [A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]];
export const add = (a, b) => a.map((x, i) => x + b[i]);
export const subtract = (a, b) => a.map((x, i) => x - b[i]);
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const norm = (a) => Math.hypot(...a);

/** The rotation of a unit quaternion x, y, z, w. */
export function fromQuaternion([x, y, z, w]) {
  return [
    1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
    2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
    2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)];
}

export const aboutX = (a) => [1, 0, 0, 0, Math.cos(a), -Math.sin(a), 0, Math.sin(a), Math.cos(a)];
export const aboutY = (a) => [Math.cos(a), 0, Math.sin(a), 0, 1, 0, -Math.sin(a), 0, Math.cos(a)];
export const aboutZ = (a) => [Math.cos(a), -Math.sin(a), 0, Math.sin(a), Math.cos(a), 0, 0, 0, 1];

/** Roll, pitch, yaw to a rotation: Rz(yaw) Ry(pitch) Rx(roll). */
export const fromEuler = ([roll, pitch, yaw]) =>
  multiply(aboutZ(yaw), multiply(aboutY(pitch), aboutX(roll)));

/** A rotation to roll, pitch, yaw, with |pitch| at most a right angle. */
export function toEuler(R) {
  const pitch = Math.atan2(-R[6], Math.hypot(R[0], R[3]));
  if (Math.hypot(R[0], R[3]) < 1e-9) return [0, pitch, Math.atan2(-R[1], R[4])];
  return [Math.atan2(R[7], R[8]), pitch, Math.atan2(R[3], R[0])];
}

/** The logarithm, which is axis times angle, with an angle of at most pi. */
export function log(R) {
  const twice = [R[7] - R[5], R[2] - R[6], R[3] - R[1]]; // 2 sin(angle) axis
  const sine = norm(twice) / 2;
  const cosine = (R[0] + R[4] + R[8] - 1) / 2;
  const angle = Math.atan2(sine, cosine);
  if (angle < 1e-8) return twice.map((x) => x / 2);
  if (Math.PI - angle > 1e-4) return twice.map((x) => (x * angle) / (2 * sine));
  // Near half a turn the sine vanishes, and the axis is the largest column of R + R^T - 2 cos I.
  const S = IDENTITY.map((e, i) => R[i] + transpose(R)[i] - 2 * cosine * e);
  const k = [0, 1, 2].reduce((best, i) => (S[4 * i] > S[4 * best] ? i : best), 0);
  const column = [S[k], S[3 + k], S[6 + k]];
  const sign = column[0] * twice[0] + column[1] * twice[1] + column[2] * twice[2] < 0 ? -1 : 1;
  return column.map((x) => (sign * x * angle) / norm(column));
}
