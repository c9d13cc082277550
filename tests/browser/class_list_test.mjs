// The list of classes as the server parses it, and the addresses of tiles with several layers.
import assert from "node:assert/strict";
import test from "node:test";

import { can_be_class, format_classes, parse_classes } from "../../web/class_list.js";
import { parameters_of_layers, query_part } from "../../web/tile_query.js";

const value = (text, colour) => ({ kind: "value", value: text, colour });

test("classes are read with quotes, brackets and special values", () => {
  assert.deepEqual(parse_classes("FRA:red,'a,b:''c''':rgb(1,2,3),'*':0af,null:eee,*:rgba(0,0,0,0)"), [
    value("FRA", "red"),
    value("a,b:'c'", "rgb(1,2,3)"),
    value("*", "0af"),
    { kind: "null", value: "", colour: "eee" },
    { kind: "others", value: "", colour: "rgba(0,0,0,0)" },
  ]);
});

test("classes that are written are read back", () => {
  const texts = ["FRA", "a,b", "it's", "x:y", "*", "null", "", "  spaced  ", "ünïcode", "'"];
  const classes = [...texts.map((text) => value(text, "ff8800")),
    { kind: "null", value: "", colour: "eee" }, { kind: "others", value: "", colour: "ddd" }];
  assert.deepEqual(parse_classes(format_classes(classes)), classes);
});

test("values that an address cannot contain are no classes", () => {
  for (const text of ["", "a", "x:y", "ünïcode", "9007199254740993", 7, "a".repeat(256), "長".repeat(40)]) {
    assert.ok(can_be_class(text), text);
  }
  for (const text of ["1 Main Street\nSpringfield", "tab\tx", "\u007f", "長".repeat(41)]) {
    assert.ok(!can_be_class(text), text);
  }
});

test("what is no list of classes is told apart from an empty one", () => {
  assert.deepEqual(parse_classes(""), []);
  for (const text of ["a", "a:", "'a:red", ":red", "a:red,", "a:red,,b:blue", "a:red,b"]) {
    assert.equal(parse_classes(text), null, text);
  }
});

test("layers drawn together are told apart by name, one alone only over a named style", () => {
  const land = { name: "land", style: new Map([["fill", "red"]]) };
  const lake = { name: "lake", style: new Map([["filter", "name = 'a & b'"]]) };
  const shared = new Map([["simplify", "4"]]);
  assert.equal(query_part(parameters_of_layers([land], shared)), "?fill=red&simplify=4");
  assert.equal(query_part(parameters_of_layers([land, lake], shared)),
    "?land.fill=red&lake.filter=name%20%3D%20'a%20%26%20b'&simplify=4");
  assert.equal(query_part(parameters_of_layers([land], new Map([["style", "night"]]))),
    "?land.fill=red&style=night");
  assert.equal(query_part(parameters_of_layers([{ name: "lake", style: new Map() }], [])), "");
});
