// The names of the columns of a pasted table, which have to be those that the server finds.
import assert from "node:assert/strict";
import test from "node:test";

import { columns_of, post_table } from "../../web/value_tables.js";

test("columns are named as the server names them", () => {
  const tables = [
    ["code\tvalue\nFRA\t1", ["code", "value"]],
    ["\uFEFFcode;value\r\n1;2", ["code", "value"]],
    ["\n\n a , b \n1,2", ["a", "b"]],
    ["\"x, y\",b", ["x, y", "b"]],
    ["\"a;b\",c", ["a;b", "c"]],
    ["\"say \"\"hi\"\"\",b", ["say \"hi\"", "b"]],
    ["size 5\",value\nC1,3\n\"a\",2", ["size 5\"", "value"]],
    [",code,people\n0,C1,3", ["", "code", "people"]],
    ["code\t\"People\n(thousands)\"\nC1\t3", ["code", "People (thousands)"]],
    ["\"open,b\nc,d", ["\"open", "b"]],
    ["one\n1", []],
    ["", []],
  ];
  for (const [text, names] of tables) assert.deepEqual(columns_of(text), names, text);
});

test("a table is posted with each name in one line, and its rows as they are", async (context) => {
  let posted;
  context.mock.method(globalThis, "fetch", async (_, { body }) => {
    posted = body;
    return new Response("{}", { status: 400 });
  });
  await post_table("http://localhost/", "\ncode\t\"People\n(k)\"\nC1\t\"3\n\"\n", {}, "a", "code");
  assert.equal(posted, "code\t\"People (k)\"\nC1\t\"3\n\"\n");
});
