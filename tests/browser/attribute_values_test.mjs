// Integers beyond 2^53 in responses.
import assert from "node:assert/strict";
import test from "node:test";

import { parse_exactly } from "../../web/attribute_values.js";
import { in_words } from "../../web/feature_panel.js";

test("only integers that a number cannot hold become strings", () => {
  const same = String.raw`{"a": [0, -1, 9007199254740991, 1.2345678901234567, 1e+300, true, null],
    "9007199254740993": "9007199254740993, \" 9007199254740993 \\"}`;
  assert.deepEqual(parse_exactly(same), JSON.parse(same));
  assert.deepEqual(parse_exactly("[617700169958293503, -9223372036854775808]"),
    ["617700169958293503", "-9223372036854775808"]);
  assert.throws(() => parse_exactly("[1"));
});

test("numbers are shown with all digits before the point", () => {
  const shown = new Map([[123456791.5, "123456791.5"], [-1234567.891, "-1234567.89"], [3.141592653589793, "3.141593"],
    [0.1 + 0.2, "0.3"], [1.5e-9, "1.5e-9"], [123456789012345, "123456789012345"], [null, "–"], ["1.50", "1.50"]]);
  for (const [value, words] of shown) assert.equal(in_words(value), words);
});
