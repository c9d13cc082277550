// Class breaks for numbers, and whether the colours of classes can be told apart.
import assert from "node:assert/strict";
import test from "node:test";

import { equal_breaks, natural_breaks, quantile_breaks } from "../../web/class_breaks.js";
import { CLASS_COLOURS, COLOUR_OF_OTHERS } from "../../web/colours.js";

const WAYS = { equal_breaks, natural_breaks, quantile_breaks };

function classes_by(breaks, numbers) {
  const parts = Array.from({ length: breaks.length + 1 }, () => []);
  for (const number of numbers) parts[breaks.filter((at) => at <= number).length].push(number);
  return parts;
}

test("quantiles have as many numbers in each class", () => {
  const numbers = [...Array.from({ length: 99 }, (_, i) => i * i), 1e9]; // one outlier
  const parts = classes_by(quantile_breaks(numbers, 5), numbers);
  assert.deepEqual(parts.map(({ length }) => length), [20, 20, 20, 20, 20]);
});

test("equal steps are equally wide", () => {
  assert.deepEqual(equal_breaks([0, 1, 2, 100], 4), [25, 50, 75]);
  assert.deepEqual(equal_breaks([-1, 1], 5), [-0.6, -0.2, 0.2, 0.6]);
});

test("natural breaks lie in the gaps", () => {
  const numbers = [1, 2, 2, 3, 10, 11, 12, 50, 52, 55];
  assert.deepEqual(classes_by(natural_breaks(numbers, 3), numbers),
    [[1, 2, 2, 3], [10, 11, 12], [50, 52, 55]]);
});

/** The least sum of squared distances from the means of classes, by brute force. */
function least_sum(numbers, classes) {
  if (classes === 1) {
    const mean = numbers.reduce((a, b) => a + b, 0) / numbers.length;
    return numbers.reduce((sum, number) => sum + (number - mean) ** 2, 0);
  }
  let least = Infinity;
  for (let last = 1; last <= numbers.length - classes + 1; last++) {
    least = Math.min(least,
      least_sum(numbers.slice(0, last), 1) + least_sum(numbers.slice(last), classes - 1));
  }
  return least;
}

test("no other breaks have numbers nearer to the means of their classes than natural ones", () => {
  let state = 1;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  for (let round = 0; round < 30; round++) {
    const numbers = Array.from({ length: 9 }, () => Math.round(1000 * random() ** 3))
      .sort((a, b) => a - b);
    if (new Set(numbers).size < 9) continue;
    const parts = classes_by(natural_breaks(numbers, 3), numbers);
    const sum = parts.reduce((all, part) => all + least_sum(part, 1), 0);
    assert.ok(sum <= least_sum(numbers, 3) + 1e-6, `${numbers}: ${sum}`);
  }
});

test("natural breaks are the same beside a number that means no data", () => {
  const numbers = [10, 11, 12, 40, 41, 42, 90, 91, 92];
  for (const far of [-9999, -1e10, -3.4e38, -Number.MAX_VALUE]) {
    const parts = classes_by(natural_breaks([far, ...numbers], 4), [far, ...numbers]);
    assert.deepEqual(parts, [[far], [10, 11, 12], [40, 41, 42], [90, 91, 92]]);
  }
});

test("no class between breaks is empty where numbers are equal", () => {
  assert.deepEqual(quantile_breaks([1.2, 5.7, 5.7, 5.7, 5.7, 9.3], 4), [5]);
  const ends = [-Number.MAX_VALUE, Number.MAX_VALUE];
  for (const way of [natural_breaks, quantile_breaks]) assert.deepEqual(way(ends, 3), [Number.MAX_VALUE]);
});

test("breaks ascend, have few digits, and none has nothing below it, whatever the numbers", () => {
  const cases = [[5], [5, 5, 5], [0, 1], [-3, -2, -1], [0.001, 0.002, 0.009], [1e9, 2e9, 7e9],
    [1950, 1960, 1999, 2001], [0, 0, 0, 0, 0, 0, 7]];
  for (const [name, way] of Object.entries(WAYS)) {
    for (const numbers of cases) {
      for (const classes of [3, 5, 9]) {
        const breaks = way(numbers, classes);
        const words = `${name} of ${numbers}: ${breaks}`;
        assert.ok(breaks.length < classes, words);
        assert.deepEqual(breaks, [...new Set(breaks)].sort((a, b) => a - b), words);
        assert.ok(breaks.every((at) => at > numbers[0]), words);
        assert.ok(breaks.every((at) => String(at).replace(/^-?0\.0*|[^0-9]/g, "").length <= 10), words);
      }
    }
  }
});

// ---- colours as seen without one kind of cones: Machado, Oliveira and Fernandes, 2009

const EYES = {
  all: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998]],
  "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881]],
  "no blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039]],
};
const TOLD_APART = 8; // distance in CIELAB; 2.3 is said to be just noticeable

const dot = (matrix, colour) =>
  matrix.map((row) => row.reduce((sum, part, i) => sum + part * colour[i], 0));

function linear_of(hex) {
  return [0, 2, 4].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
}

function lab_of(linear) {
  const xyz = dot([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]],
    linear.map((part) => Math.min(Math.max(part, 0), 1)));
  const [x, y, z] = xyz.map((part, i) => part / [0.95047, 1, 1.08883][i])
    .map((part) => (part > 0.008856 ? Math.cbrt(part) : 7.787 * part + 16 / 116));
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

for (const [eye, matrix] of Object.entries(EYES)) {
  test(`colours of classes are told apart by eyes with ${eye === "all" ? "all cones" : `${eye} cones`}`,
    () => {
      const colours = [...CLASS_COLOURS, COLOUR_OF_OTHERS];
      const seen = colours.map((hex) => lab_of(dot(matrix, linear_of(hex))));
      seen.forEach((one, i) => seen.slice(0, i).forEach((other, j) => {
        const distance = Math.hypot(...one.map((part, k) => part - other[k]));
        assert.ok(distance >= TOLD_APART, `${colours[i]} and ${colours[j]}: ${distance.toFixed(1)}`);
      }));
    });
}
