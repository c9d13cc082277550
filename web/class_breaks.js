// Computes class breaks. `sorted` is an ascending sample of the numbers, with equally many of them between
// each two. The result is an ascending list of breaks: a number is in the class above each break that it
// reaches.

const MOST_DIGITS = 12;

export const WAYS = {
  quantiles: quantile_breaks,
  equal: equal_breaks,
  natural: natural_breaks,
};

/** Classes with equal counts. */
export function quantile_breaks(sorted, classes) {
  const firsts = parts(classes).map((part) => Math.floor(part * sorted.length));
  return ascending(firsts.map((first) => break_before(sorted, first)), sorted);
}

/** Classes of equal width. */
export function equal_breaks(sorted, classes) {
  const least = sorted[0];
  const spread = sorted.at(-1) - least;
  if (!(spread > 0)) return [];
  const step = 10 ** (Math.floor(Math.log10(spread)) - 2);
  return ascending(parts(classes).map((part) => multiple(Math.round((least + part * spread) / step), step)),
    sorted);
}

/**
 * Natural breaks (Fisher, Jenks): classes with the least sum of squared distances of numbers from the
 * mean of their class.
 */
export function natural_breaks(sorted, classes) {
  const count = sorted.length;
  const cost = costs_of(sorted);
  // best[last]: least sum for the numbers up to `last`, for the current number of classes;
  // begins[k][last]: where the k-th class begins.
  let best = sorted.map((_, last) => cost(0, last));
  const begins = [sorted.map(() => 0)];
  for (let k = 1; k < Math.min(classes, count); k++) {
    const next = [];
    const begin = [];
    for (let last = 0; last < count; last++) {
      next[last] = last === 0 ? 0 : Infinity;
      begin[last] = last;
      for (let first = 1; first <= last; first++) {
        const sum = best[first - 1] + cost(first, last);
        if (sum < next[last]) [next[last], begin[last]] = [sum, first];
      }
    }
    best = next;
    begins.push(begin);
  }
  const breaks = [];
  for (let k = begins.length - 1, last = count - 1; k > 0 && last >= 0; k--) {
    const first = begins[k][last];
    if (first > 0) breaks.unshift(break_before(sorted, first));
    last = first - 1;
  }
  return ascending(breaks, sorted);
}

function parts(classes) {
  return Array.from({ length: classes - 1 }, (_, i) => (i + 1) / classes);
}

/** The sum of squared distances from their mean, for the numbers from `first` to `last`. */
function costs_of(sorted) {
  // Each sum is of these numbers only: in differences of running sums, one number far from the others, such
  // as -1e38 for "no data", would leave no digits for those.
  const costs = sorted.map((_, first) => {
    let [mean, squares] = [sorted[first], 0];
    return sorted.slice(first).map((number, before) => {
      const distance = number - mean;
      mean += distance / (before + 1);
      squares += distance * (number - mean);
      return squares >= 0 ? squares : Infinity; // not NaN after an overflow
    });
  });
  return (first, last) => costs[first][last - first];
}

/** The number with the fewest digits that separates the one at `first` from the numbers below it. */
function break_before(sorted, first) {
  const at = sorted[first];
  // Equal numbers are in the same class, and have the same break.
  const below = sorted[sorted.indexOf(at) - 1] ?? at;
  if (!(at > below && Number.isFinite(at - below))) return at;
  for (let power = Math.ceil(Math.log10(at - below)); power >= -MOST_DIGITS; power--) {
    const found = multiple(Math.floor(at / 10 ** power), 10 ** power);
    if (found > below && found <= at) return found;
  }
  return at;
}

/** Without the rounding noise of the product in the last digits. */
function multiple(count, step) {
  return Number((count * step).toPrecision(MOST_DIGITS));
}

/** Sorted and distinct, without the minimum, below which there are no numbers. */
function ascending(breaks, sorted) {
  return [...new Set(breaks)].filter((number) => number > sorted[0]).sort((a, b) => a - b);
}
