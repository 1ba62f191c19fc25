// The grid of recorded runs.  Their keys, such as "0-3-1", are the indices on its axes.

/**
 * The recorded key nearest to the wanted indices, measured in steps on the grid.
 * `words` says which axes are lists of names, whose values are kept if possible.
 */
export function nearest(keys, wanted, words) {
  const far = (key) => key.split("-").reduce((sum, k, i) =>
    sum + (words[i] ? 1000 * (+k !== wanted[i]) : Math.abs(k - wanted[i])), 0);
  return keys.reduce((best, key) => (far(key) < far(best) ? key : best), keys[0]);
}
