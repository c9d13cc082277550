// Looks that suit any layers: each layer gets a colour of its own.
import assert from "node:assert/strict";
import test from "node:test";

import { light_colour_at } from "../../web/colours.js";
import { all_looks } from "../../web/looks.js";

const LAYERS = 40;
const NEAR = 6; // of 255, the difference in every channel

const channels = (colour) => [0, 2, 4].map((i) => Number.parseInt(colour.slice(i, i + 2), 16));

test("forty layers have forty colours, which can be seen to differ", () => {
  for (const { title, styles } of all_looks([], LAYERS, () => new Map())) {
    if (!["Pastel", "Hatched"].includes(title)) continue;
    const fills = styles.map((style) => style.get("fill"));
    assert.ok(fills.every((fill) => /^[0-9a-f]{6}$/.test(fill)), fills.join(" "));
    fills.forEach((fill, i) => fills.slice(i + 1).forEach((other) => {
      const differences = channels(fill).map((value, c) => Math.abs(value - channels(other)[c]));
      assert.ok(Math.max(...differences) > NEAR, `${title}: ${fill} and ${other}`);
    }));
  }
});

test("colours are light, so that black text and thin lines can be read on them", () => {
  for (let i = 0; i < LAYERS; i++) {
    const sum = channels(light_colour_at(i)).reduce((all, value) => all + value, 0);
    assert.ok(sum > 300, light_colour_at(i));
  }
});

test("where features have colours by class, a look gives all of them its one", () => {
  const looks = all_looks(["night_sky"], 1, () => new Map([["color-by", "kind"]]));
  assert.deepEqual(looks.map(({ title }) => title),
    ["Default", "Night sky", "Pastel", "Outlines", "Hatched"]);
  assert.equal(looks[2].styles[0].get("classes"), `*:${looks[2].styles[0].get("fill")}`);
});
