// Integers beyond 2^53 in responses.
import assert from "node:assert/strict";
import test from "node:test";

import { parse_exactly } from "../../web/attribute_values.js";

test("only integers that a number cannot hold become strings", () => {
  const same = String.raw`{"a": [0, -1, 9007199254740991, 1.2345678901234567, 1e+300, true, null],
    "9007199254740993": "9007199254740993, \" 9007199254740993 \\"}`;
  assert.deepEqual(parse_exactly(same), JSON.parse(same));
  assert.deepEqual(parse_exactly("[617700169958293503, -9223372036854775808]"),
    ["617700169958293503", "-9223372036854775808"]);
  assert.throws(() => parse_exactly("[1"));
});
