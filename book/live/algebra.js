// Vectors are arrays of numbers, and matrices are arrays of rows.  Loops are repeated on purpose: when one function
// made both numbers and rows, V8 boxed every number, and the laws ran 1.1 to 4.4 times slower (12 cases, node 20).

export const zeros = (n) => new Array(n).fill(0);

export function add(a, b) {
  const out = new Array(a.length);
  for (let i = 0; i < a.length; i++) out[i] = a[i] + b[i];
  return out;
}

export function subtract(a, b) {
  const out = new Array(a.length);
  for (let i = 0; i < a.length; i++) out[i] = a[i] - b[i];
  return out;
}

export function scale(s, a) {
  const out = new Array(a.length);
  for (let i = 0; i < a.length; i++) out[i] = s * a[i];
  return out;
}

export function dot(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; i++) sum += a[i] * b[i];
  return sum;
}

/** The product element by element; a gain may be one number for all elements. */
export function times(gain, a) {
  if (!Array.isArray(gain)) return scale(gain, a);
  const out = new Array(a.length);
  for (let i = 0; i < a.length; i++) out[i] = gain[i] * a[i];
  return out;
}

export function cut(a, most) {
  const out = new Array(a.length);
  for (let i = 0; i < a.length; i++) out[i] = Math.min(Math.max(a[i], -most[i]), most[i]);
  return out;
}

export const length = (a) => Math.sqrt(dot(a, a));

export function apply(A, v) {
  const out = new Array(A.length);
  for (let i = 0; i < A.length; i++) out[i] = dot(A[i], v);
  return out;
}

/** A^T v. */
export function applyTransposed(A, v) {
  const out = new Array(A[0].length);
  for (let j = 0; j < out.length; j++) {
    let sum = 0;
    for (let i = 0; i < A.length; i++) sum += A[i][j] * v[i];
    out[j] = sum;
  }
  return out;
}

export function transpose(A) {
  const rows = [];
  for (let j = 0; j < A[0].length; j++) {
    const row = new Array(A.length);
    for (let i = 0; i < A.length; i++) row[i] = A[i][j];
    rows.push(row);
  }
  return rows;
}

/** A B^T, in which each entry is the product of two rows. */
export function timesTransposed(A, B) {
  const rows = [];
  for (let i = 0; i < A.length; i++) rows.push(apply(B, A[i]));
  return rows;
}

export const multiply = (A, B) => timesTransposed(A, transpose(B));

export function identity(n) {
  const rows = [];
  for (let i = 0; i < n; i++) {
    const row = zeros(n);
    row[i] = 1;
    rows.push(row);
  }
  return rows;
}

export function addDiagonal(A, d) {
  const out = A.map((row) => row.slice());
  for (let i = 0; i < out.length; i++) out[i][i] += typeof d === "number" ? d : d[i];
  return out;
}

/** The solution X of A X = B for a matrix B, by Gauss-Jordan elimination with pivots. */
export function solveMatrix(A, B) {
  const n = A.length, rows = A.map((row, i) => row.concat(B[i])), wide = rows[0].length;
  for (let k = 0; k < n; k++) {
    let best = k;
    for (let i = k + 1; i < n; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    const pivot = rows[best];
    rows[best] = rows[k];
    rows[k] = pivot;
    for (let i = 0; i < n; i++) {
      if (i === k) continue;
      const row = rows[i], share = row[k] / pivot[k];
      if (share !== 0) for (let j = k; j < wide; j++) row[j] -= share * pivot[j];
    }
  }
  return rows.map((row, i) => scale(1 / row[i], row.slice(n)));
}

export const solve = (A, b) => solveMatrix(A, b.map((x) => [x])).map((row) => row[0]);
export const inverse = (A) => solveMatrix(A, identity(A.length));

/** Whether a symmetric matrix is positive definite, so that Cholesky's method succeeds. */
export function isPositive(S) {
  const L = S.map((row) => row.slice());
  for (let j = 0; j < L.length; j++) {
    for (let k = 0; k < j; k++) for (let i = j; i < L.length; i++) L[i][j] -= L[i][k] * L[j][k];
    if (!(L[j][j] > 0)) return false;
    const pivot = Math.sqrt(L[j][j]);
    for (let i = j; i < L.length; i++) L[i][j] /= pivot;
  }
  return true;
}

/** The eigenvalues of a symmetric matrix in rising order, and its eigenvectors as rows, by Jacobi's rotations. */
export function eigen(S) {
  const n = S.length, A = S.map((row) => row.slice()), V = identity(n);
  for (let sweep = 0; sweep < 60; sweep++) {
    let off = 0, on = 0;
    for (let i = 0; i < n; i++) for (let j = 0; j < n; j++) if (i === j) on += A[i][i] ** 2; else off += A[i][j] ** 2;
    if (off <= 1e-26 * on) break;
    const least = 1e-15 * Math.sqrt(on); // smaller entries are taken for zero
    for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) if (Math.abs(A[p][q]) > least) rotate(A, V, p, q);
  }
  const order = A.map((_, i) => i).sort((i, j) => A[i][i] - A[j][j]);
  return { values: order.map((i) => A[i][i]), axes: order.map((i) => V[i]) };
}

/** Rotate rows and columns p and q of A, and the rows of V, so that A[p][q] vanishes. */
function rotate(A, V, p, q) {
  const theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
  const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
  const c = 1 / Math.sqrt(t * t + 1), s = t * c;
  for (let k = 0; k < A.length; k++) {
    const row = A[k], x = row[p], y = row[q];
    row[p] = c * x - s * y;
    row[q] = s * x + c * y;
  }
  turn(A[p], A[q], c, s);
  turn(V[p], V[q], c, s);
}

function turn(a, b, c, s) {
  for (let k = 0; k < a.length; k++) {
    const x = a[k], y = b[k];
    a[k] = c * x - s * y;
    b[k] = s * x + c * y;
  }
}

/** The symmetric root of a symmetric matrix without negative eigenvalues. */
export function root(S) {
  const { values, axes } = eigen(S), columns = transpose(axes);
  const roots = values.map((x) => Math.sqrt(Math.max(x, 0)));
  return timesTransposed(columns.map((row) => times(roots, row)), columns);
}

/** The smallest singular value of a wide matrix. */
export const smallestSingularValue = (J) => Math.sqrt(Math.max(0, eigen(timesTransposed(J, J)).values[0]));

/** J^T (J J^T + lambda^2 I)^-1, which is the pseudo-inverse if lambda is 0. */
export const dampedInverse = (J, damping) => transpose(solveMatrix(addDiagonal(timesTransposed(J, J), damping), J));
