// Where to part numbers into classes. `sorted` are numbers in ascending order, which stand for all of
// them: so many lie between each two. What comes out are breaks, each greater than the one before: a
// number is in the class above each break that it reaches.

const MOST_DIGITS = 12;

export const WAYS = {
  quantiles: quantile_breaks,
  equal: equal_breaks,
  natural: natural_breaks,
};

/** As many numbers in each class. */
export function quantile_breaks(sorted, classes) {
  const firsts = parts(classes).map((part) => Math.floor(part * sorted.length));
  return ascending(firsts.map((first) => break_before(sorted, first)), sorted);
}

/** Classes that are equally wide. */
export function equal_breaks(sorted, classes) {
  const least = sorted[0];
  const spread = sorted.at(-1) - least;
  if (!(spread > 0)) return [];
  const step = 10 ** (Math.floor(Math.log10(spread)) - 2);
  return ascending(parts(classes).map((part) => multiple(Math.round((least + part * spread) / step), step)),
    sorted);
}

/**
 * Classes whose numbers are near each other: the sum of squared distances from the means of their
 * classes is the least, as Fisher and Jenks want it.
 */
export function natural_breaks(sorted, classes) {
  const count = sorted.length;
  const cost = costs_of(sorted);
  // best[last]: of the numbers up to `last` in so many classes; begins[k][last]: where the k-th of them begins.
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

/** The squared distances from their mean of the numbers from `first` to `last`. */
function costs_of(sorted) {
  const sums = [0];
  const squares = [0];
  for (const number of sorted) {
    const shifted = number - sorted[0]; // so that little is lost by the difference below
    sums.push(sums.at(-1) + shifted);
    squares.push(squares.at(-1) + shifted * shifted);
  }
  return (first, last) => {
    const sum = sums[last + 1] - sums[first];
    return squares[last + 1] - squares[first] - (sum * sum) / (last + 1 - first);
  };
}

/** The number with the fewest digits that parts the one at `first` from what lies below it. */
function break_before(sorted, first) {
  const [below, at] = [sorted[first - 1] ?? sorted[first], sorted[first]];
  if (!(at > below)) return at;
  for (let power = Math.ceil(Math.log10(at - below)); power >= -MOST_DIGITS; power--) {
    const found = multiple(Math.floor(at / 10 ** power), 10 ** power);
    if (found > below && found <= at) return found;
  }
  return at;
}

/** Without the last digits that a product has of its own. */
function multiple(count, step) {
  return Number((count * step).toPrecision(MOST_DIGITS));
}

/** Each once, and none at the least number, below which there is nothing. */
function ascending(breaks, sorted) {
  return [...new Set(breaks)].filter((number) => number > sorted[0]).sort((a, b) => a - b);
}
