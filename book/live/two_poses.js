// The two poses of a square tag that one picture allows: IPPE, Collins & Bartoli, International Journal of
// Computer Vision 109 (2014), as OpenCV's SOLVEPNP_IPPE_SQUARE.
import { apply, dot, length, scale, solve, solveMatrix } from "./algebra.js";
import { cross, plus, product, rotated } from "./space.js";

/** Corners of a tag of this size in its own frame (x right, y up), clockwise from the upper left, in [m]. */
export const cornersOf = (size) => [[-1, 1], [1, 1], [1, -1], [-1, -1]].map(([x, y]) => [0.5 * size * x, 0.5 * size * y, 0]);

/** The image of a point in a camera (z forward, x right, y down), at depth 1. */
export const seen = ({ R, p }, point) => {
  const [x, y, z] = plus(p, rotated(R, point));
  return [x / z, y / z];
};

/** The first eight numbers of the homography that maps the corners to their image; the ninth is 1. */
function homography(corners, image) {
  const rows = corners.flatMap(([x, y], k) => image[k].map((u, i) =>
    [...(i ? [0, 0, 0, x, y, 1] : [x, y, 1, 0, 0, 0]), -u * x, -u * y]));
  return solve(rows, image.flat());
}

/** The rotation that turns the z axis into a direction. */
function towards(direction) {
  const [x, y, z] = scale(1 / length(direction), direction), k = 1 / (1 + z);
  return [1 - k * x * x, -k * x * y, x, -k * x * y, 1 - k * y * y, y, -x, -y, z];
}

/** The position at which the rotated corners fit their image best, by least squares. */
function placed(R, corners, image) {
  const rows = [], right = [];
  corners.forEach((corner, k) => {
    const [x, y, z] = rotated(R, corner), [u, v] = image[k];
    rows.push([1, 0, -u], [0, 1, -v]);
    right.push(u * z - x, v * z - y);
  });
  const columns = [0, 1, 2].map((j) => rows.map((row) => row[j]));
  return solve(columns.map((a) => apply(columns, a)), apply(columns, right));
}

/** The root mean square of the distance between the corners of a pose and their image, at depth 1. */
export function misses(pose, corners, image) {
  const squares = corners.map((corner, k) => seen(pose, corner).reduce((sum, x, i) => sum + (x - image[k][i]) ** 2, 0));
  return Math.sqrt(squares.reduce((a, b) => a + b) / corners.length);
}

/** Both poses {R, p, miss} of a tag in the camera's frame, the better one first; `image` has the corners at depth 1. */
export function twoPoses(size, image) {
  const corners = cornersOf(size), [a, b, p, c, d, q, g, h] = homography(corners, image);
  const turn = towards([p, q, 1]); // the middle of the tag is in this direction
  // The slope of the homography there, as a matrix that a rotation and a depth have to match.
  const slope = [[a - g * p, b - h * p], [c - g * q, d - h * q]];
  const facing = [0, 1].map((i) => [0, 1].map((j) => turn[3 * i + j] - [p, q][i] * turn[6 + j]));
  const [[e, f], [i, j]] = solveMatrix(facing, slope);
  const square = e * e + f * f + i * i + j * j, area = e * j - f * i;
  const most = Math.sqrt(0.5 * (square + Math.sqrt(Math.max(0, square * square - 4 * area * area)))); // the larger singular value
  const [first, second] = [[e / most, i / most], [f / most, j / most]]; // columns without their third component
  const x = Math.sqrt(Math.max(0, 1 - dot(first, first))), y = Math.sqrt(Math.max(0, 1 - dot(second, second)));
  const same = dot(first, second) <= 0 ? 1 : -1; // the columns are at right angles
  return [1, -1].map((side) => {
    const u = [...first, side * x], v = [...second, side * same * y];
    const w = cross(u, v);
    const R = product(turn, [u[0], v[0], w[0], u[1], v[1], w[1], u[2], v[2], w[2]]);
    const pose = { R, p: placed(R, corners, image) };
    return { ...pose, miss: misses(pose, corners, image) };
  }).sort((one, other) => one.miss - other.miss);
}
