// Polygons with shared borders, compared in the viewer with the same polygons simplified one by
// one.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";

import {
  HERE, assert_nothing_went_wrong, hash_of, new_page, of_layer, save_screenshot, shown_tiles,
  start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

// Two fields with a crooked shared border, which crosses the tile 3/5/3; together they cover the
// tile.
const FIELDS = `
[[layer]]
name = "fields"
file = "${join(HERE, "fields.geojson")}"
title = "Fields"
coverage = "auto"
fast_topology = true
style = { fill = "#d8c99b", fill_opacity = 1.0 }

[[layer]]
name = "houses"
file = "${join(HERE, "land.geojson")}"
title = "Houses"
merge = 4
`;
const COLOURS = "&fields.color-by=name&fields.classes=west:cc4444,east:4444cc";

const { browser, server } = await start_browser_and_server([], FIELDS);

/** The number of transparent pixels of that tile in each of the two panes. */
function holes_by_pane(page) {
  return page.evaluate(() => Object.fromEntries(["simplified", "full"].map((pane) => {
    const tile = document.querySelector(`.leaflet-${pane}-pane img[src*="/tiles/fields/3/5/3"]`);
    const context = new OffscreenCanvas(256, 256).getContext("2d");
    context.drawImage(tile, 0, 0);
    const { data } = context.getImageData(0, 0, 256, 256);
    return [pane, data.filter((value, i) => i % 4 === 3 && value < 255).length];
  })));
}

test("compare: neighbours simplified together have no gap, each by itself they have", async () => {
  const { page, seen } = await new_page(browser);
  await page.goto(`${server.base}#3/25/67&on=fields&simplify=16${COLOURS}`);
  await tiles_drawn(page);
  await page.locator("#detail summary").click();
  await page.getByLabel("Compare with separate polygons").check();
  await page.waitForFunction(() => location.hash.includes("compare=0.5&against=apart"));
  await page.waitForSelector("img[src*='topology=fast']");
  await tiles_drawn(page);
  const queries = of_layer(await shown_tiles(page), "fields").map((url) => new URL(url).searchParams);
  assert.deepEqual(new Set(queries.map((query) => query.get("simplify"))), new Set(["16"]));
  assert.deepEqual(new Set(queries.map((query) => query.get("topology"))), new Set([null, "fast"]));
  assert.equal(await page.locator(".divider .right").innerText(), "separate polygons");
  assert.equal(await page.getByLabel("Divider between").count(), 1);
  await save_screenshot(page, "desktop-coverage");

  const { simplified, full } = await holes_by_pane(page);
  assert.equal(simplified, 0);
  assert.ok(full > 100, `${full} pixels of a gap`);

  const hash = await hash_of(page);
  await page.reload();
  await tiles_drawn(page);
  assert.equal(await hash_of(page), hash);
  assert.deepEqual(await holes_by_pane(page), { simplified, full });
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("compare: one of the two at a time, or none", async () => {
  const { page, seen } = await new_page(browser);
  await page.goto(`${server.base}#3/25/67&on=fields&simplify=16&compare=0.25&against=apart`);
  await tiles_drawn(page);
  await page.locator("#detail summary").click();
  const apart = page.getByLabel("Compare with separate polygons");
  const full = page.getByLabel("Compare with every vertex");
  assert.deepEqual([await apart.isChecked(), await full.isChecked()], [true, false]);
  await full.check();
  await page.waitForSelector("img[src*='simplify=0']");
  await page.waitForFunction(() => !document.querySelector("img[src*='topology=fast']"));
  assert.equal(await apart.isChecked(), false);
  assert.ok((await hash_of(page)).endsWith("&compare=0.25"), "the divider stays");
  await apart.check();
  await page.waitForSelector("img[src*='topology=fast']");
  assert.equal(await full.isChecked(), false);
  await apart.uncheck();
  await page.waitForFunction(() => !location.hash.includes("compare"));
  await page.waitForFunction(() => !document.querySelector("img[src*='topology=fast']"));
  assert.ok(!(await hash_of(page)).includes("against"));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a layer that is merged to blocks has a slider for the distance, and no other one has", async () => {
  const { page, seen } = await new_page(browser);
  await page.goto(`${server.base}#5/46/10&on=land,houses`);
  await tiles_drawn(page);
  for (const layer of ["Land", "Houses"]) {
    await page.locator("summary").and(page.getByLabel(`Style of ${layer}`)).click();
  }
  const panel_of = (layer) =>
    page.locator("#layers li").filter({ has: page.getByLabel(`Style of ${layer}`) });
  assert.equal(await panel_of("Land").getByLabel("Merge").count(), 0);
  const slider = panel_of("Houses").getByLabel("Merge");
  assert.equal(await slider.inputValue(), "4");
  await slider.fill("8");
  await page.waitForSelector("img[src*='merge=8']");
  await tiles_drawn(page);
  assert.match(await hash_of(page), /houses\.merge=8/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
