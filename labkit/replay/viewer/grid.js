// The grid of recorded runs, keys like "0-3-1": the indices on its axes.

/**
 * The recorded key nearest to the wanted indices, by steps on the grid.
 * `words` says which axes are lists of names: those give way last.
 */
export function nearest(keys, wanted, words) {
  const far = (key) => key.split("-").reduce((sum, k, i) =>
    sum + (words[i] ? 1000 * (+k !== wanted[i]) : Math.abs(k - wanted[i])), 0);
  return keys.reduce((best, key) => (far(key) < far(best) ? key : best), keys[0]);
}
