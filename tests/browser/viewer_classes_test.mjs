// Colours by class: suggested from the values in the map, and explained in the legend.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";

import {
  DESKTOP, PHONE, assert_nothing_went_wrong, hash_of, new_page, save_screenshot,
  start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const folder = mkdtempSync(join(tmpdir(), "trapeze-classes-"));
after(() => rmSync(folder, { recursive: true }));

// Twenty columns a degree wide, from 0 to 20 east: their numbers are squares, the last is an
// outlier.
const columns = Array.from({ length: 20 }, (_, i) => ({
  type: "Feature",
  properties: { name: `column ${i}`, number: i < 19 ? i * i : 10_000, half: i < 10 ? "west" : "east" },
  geometry: {
    type: "Polygon",
    coordinates: [[[i, 40], [i + 1, 40], [i + 1, 50], [i, 50], [i, 40]]],
  },
}));
writeFileSync(join(folder, "columns.geojson"),
  JSON.stringify({ type: "FeatureCollection", features: columns }));

const colour_of = (i) => ["efdfb4", "c9d8ac", "e9c3b2"][i % 3];
const CONFIG = `
[styles.atlas.columns]
color_by = "name"
classes = [${columns.map((_, i) => `"column ${i}:${i < 18 ? colour_of(i) : `40${i}80`}"`).join(", ")}]

[[layer]]
name = "columns"
file = "${join(folder, "columns.geojson")}"
title = "Columns"
`;

const { browser, server } = await start_browser_and_server([], CONFIG);

async function open(hash, options = DESKTOP) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen, form: page.locator("#layers li").filter({ has: page.getByLabel("Style of Columns") }) };
}

async function parameter(page, name, wanted) {
  await page.waitForFunction(([key, text]) => {
    const part = location.hash.split("&").find((one) => one.startsWith(`${key}=`));
    return decodeURIComponent(part ?? "").slice(key.length + 1) === text;
  }, [`columns.${name}`, wanted], { timeout: 30_000 }).catch(async () =>
    assert.fail(`${name} is not ${wanted} in ${decodeURIComponent(await hash_of(page))}`));
}

test("numbers are parted by quantiles, equal steps and natural breaks, of all values in view",
  async () => {
    const { page, seen, form } = await open("#5/45/10&on=columns");
    await page.getByLabel("Style of Columns").click();
    await form.getByLabel("Colour by").selectOption("number");
    await parameter(page, "breaks", "10,60,140,250"); // below i * i for i = 4, 8, 12, 16
    await form.getByLabel("Part by").selectOption("equal steps");
    await parameter(page, "breaks", "2000,4000,6000,8000");
    await form.getByLabel("Part by").selectOption("natural breaks");
    await page.waitForFunction(() => /columns\.breaks=\d+,\d+,\d+,10000&/.test(location.hash));
    await form.getByLabel("Part by").selectOption("quantiles");
    await form.getByRole("combobox", { name: "Classes", exact: true }).selectOption("4");
    await parameter(page, "breaks", "20,100,200");
    await save_screenshot(page, "desktop-ranges");
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });

test("what is suggested is of the view, or of all of the layer", async () => {
  const { page, seen, form } = await open("#9/45/4.5&on=columns"); // 3 to 6 east
  await page.getByLabel("Style of Columns").click();
  await form.getByLabel("Colour by").selectOption("name");
  await page.waitForFunction(() => location.hash.includes("columns.classes="));
  const names = () => form.locator(".classes input[type=text]").evaluateAll((inputs) =>
    inputs.map(({ value }) => value));
  const in_view = await names();
  assert.ok(in_view.includes("column 4") && !in_view.includes("column 12"), String(in_view));
  await form.getByLabel("Colour by").selectOption("number");
  await form.getByLabel("From").selectOption("the whole layer");
  await parameter(page, "breaks", "10,60,140,250");
  await page.evaluate(() => (location.hash = "#9/45/14.5&on=columns"));
  await page.waitForFunction(() => document.querySelector("img.leaflet-tile[src*='/9/27']"));
  await form.getByLabel("Colour by").selectOption("half");
  await form.getByLabel("From").selectOption("the current view");
  await form.getByRole("button", { name: "Suggest from map" }).click();
  await page.waitForFunction(() => /columns\.classes=east:[0-9a-f]{6},\*:/.test(location.hash));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("classes of one colour are one row of the legend, with their names on demand", async () => {
  const { page, seen } = await open("#5/45/10&on=columns&style=atlas");
  const legend = page.locator("#legend-body");
  await legend.getByRole("heading", { name: "Columns" }).waitFor();
  const rows = legend.locator("li");
  assert.deepEqual(await rows.locator("> :last-child").evaluateAll((all) =>
    all.map((row) => (row.querySelector("summary") ?? row).textContent)),
  ["6 columns", "6 columns", "6 columns", "column 18", "column 19", "others"]);
  assert.equal(await rows.nth(1).locator("details").getAttribute("title"),
    [1, 4, 7, 10, 13, 16].map((i) => `column ${i}`).join(", "));
  assert.equal(await rows.nth(1).locator("p").isVisible(), false);
  await rows.nth(1).locator("summary").click();
  assert.equal(await rows.nth(1).locator("p").isVisible(), true);
  await save_screenshot(page, "desktop-legend");
  await page.focus("#map");
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => !location.hash.startsWith("#5/45.000/10.000"));
  assert.equal(await rows.nth(1).locator("p").isVisible(), true, "the names stay while the map moves");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the legend is of what is in view", async () => {
  const { page, seen } = await open("#7/45.5/6.5");
  const legend = page.locator("#legend-body");
  assert.match(await legend.innerText(), /Columns\s+Lake\s+Land/);
  await page.evaluate(() => (location.hash = "#7/45.5/25"));
  await page.waitForFunction(() => !document.querySelector("#legend-body").textContent.includes("Lake"));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("on a phone the legend never lies over the panel", async () => {
  const { page, seen } = await open("#5/45/10&style=atlas", PHONE);
  await page.tap("#legend-toggle");
  assert.equal(await page.locator("#legend-body").isVisible(), true);
  const [panel, legend] = [await page.locator("#panel").boundingBox(),
    await page.locator("#legend").boundingBox()];
  assert.ok(panel.y + panel.height <= legend.y);
  await save_screenshot(page, "phone-legend");
  await page.tap("#panel-toggle");
  assert.equal(await page.locator("#legend").isVisible(), false);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
