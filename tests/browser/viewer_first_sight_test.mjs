// The first view: the map that the server configures, and three things to try.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";

import {
  HERE, PHONE, TABLET, assert_nothing_went_wrong, hash_of, new_page, of_layer, query_of,
  save_screenshot, shown_tiles, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const START = "4/30/60&style=dusk";
const CONFIG = `
[viewer]
title = "My fields"
start = "${START}"

[styles.dusk]
background = "#304050"
[styles.dusk.fields]
color_by = "name"
classes = ["west:cc4444", "east:4444cc"]

[[layer]]
name = "fields"
file = "${join(HERE, "fields.geojson")}"
title = "Fields"
group = "Countryside"
detail_zoom = 6
fast_topology = true

[[layer]]
name = "pond"
file = "${join(HERE, "lake.geojson")}"
title = "Pond"
group = "Invented town"
detail_zoom = 8
`;
const TRIALS = ["Simplify with a slider", "Shared or separate borders", "Restyle with one click"];

const { browser, server } = await start_browser_and_server([], CONFIG);

async function open(hash = "", options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen, offer: page.locator("#try") };
}

/** Waits until the tiles of "fields" are requested with exactly these queries. */
async function wait_for_queries(page, ...wanted) {
  const text = (queries) => JSON.stringify(queries.map((query) => Object.entries(query).sort()).sort());
  const end = Date.now() + 20_000;
  for (let told = ""; ; await page.waitForTimeout(50)) {
    const tiles = of_layer(await shown_tiles(page), "fields");
    const queries = [...new Set(tiles.map((url) => JSON.stringify(query_of(url, "fields"))))];
    told = text(queries.map((query) => JSON.parse(query)));
    if (told === text(wanted)) break;
    assert.ok(Date.now() < end, `${text(wanted)}, not ${told}`);
  }
  await tiles_drawn(page);
}

test("an address that says nothing shows what the server wants, in the middle of what can be seen",
  async () => {
    const { page, seen, offer } = await open();
    assert.equal(await page.title(), "My fields");
    assert.equal(await page.locator("#panel h1").innerText(), "My fields");
    await wait_for_queries(page, { style: "dusk" });
    assert.match(await hash_of(page), /^#4\/.*&style=dusk$/);
    const [panel, box] = [await page.locator("#panel").boundingBox(), await offer.boundingBox()];
    const at = await page.evaluate(() => location.hash.match(/^#4\/([\d.-]+)\/([\d.-]+)/).slice(1));
    // 256 pixels of zoom 4 are 22.5 degrees.
    const x = 640 + ((60 - Number(at[1])) / 22.5) * 256;
    assert.ok(Math.abs(x - panel.x / 2) < 3, `60 east is at ${x}, beside the panel at ${panel.x}`);
    assert.ok(Number(at[0]) < 30, `30 north is above the middle, as ${box.height} pixels are covered`);
    await save_screenshot(page, "desktop-first-sight");
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });

test("three things can be tried, each with a sentence; an address that says something shows none",
  async () => {
    const { page, seen, offer } = await open();
    const choices = await offer.locator(".choice").allInnerTexts();
    assert.deepEqual(choices.map((text) => text.split("\n")[0]), TRIALS);
    for (const text of choices) assert.match(text, /\n.{30,110}\.$/);
    assert.equal(await page.locator("#try-open").isVisible(), false);
    await offer.getByRole("button", { name: "Close" }).click();
    assert.equal(await offer.isVisible(), false);
    await page.getByRole("button", { name: "Try it" }).click();
    assert.equal(await offer.locator(".choice").count(), 3);
    await page.reload();
    await tiles_drawn(page);
    assert.equal(await offer.isVisible(), false);
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });

test("simplify by a slider: each step is drawn, and back is as it was", async () => {
  const { page, seen, offer } = await open();
  await offer.getByRole("button", { name: TRIALS[0] }).click();
  await wait_for_queries(page, { style: "dusk", simplify: "4" });
  await offer.getByLabel("Simplify by").fill("9");
  await wait_for_queries(page, { style: "dusk", simplify: "64" });
  assert.equal(await offer.locator("output").innerText(), "64 px");
  await save_screenshot(page, "desktop-try-simplify");
  await offer.getByRole("button", { name: "Back" }).click();
  await wait_for_queries(page, { style: "dusk" });
  assert.equal(await offer.locator(".choice").count(), 3);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("gapless against apart: both are drawn, side by side", async () => {
  const { page, seen, offer } = await open();
  await offer.getByRole("button", { name: TRIALS[1] }).click();
  await wait_for_queries(page, { style: "dusk", simplify: "8" },
    { style: "dusk", simplify: "8", topology: "fast" });
  assert.equal(await page.getByLabel("Divider between").count(), 1);
  await save_screenshot(page, "desktop-try-apart");
  await offer.getByRole("button", { name: "Back" }).click();
  await wait_for_queries(page, { style: "dusk" });
  assert.equal(await page.getByLabel("Divider between").isVisible(), false);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("restyle by click: every look is shown as a tile of it, and taken by a click", async () => {
  const { page, seen, offer } = await open();
  await offer.getByRole("button", { name: TRIALS[2] }).click();
  const looks = offer.locator(".looks button");
  assert.deepEqual(await looks.allInnerTexts(),
    ["Default", "Dusk", "Night", "Pastel", "Outlines", "Hatched"]);
  await page.waitForFunction(() => [...document.querySelectorAll(".looks img")].every((picture) =>
    picture.complete && picture.naturalWidth === 256));
  assert.equal(await looks.nth(1).getAttribute("aria-pressed"), "true");
  await looks.nth(2).click();
  await wait_for_queries(page, { style: "night" });
  assert.equal(await looks.nth(1).getAttribute("aria-pressed"), "false");
  await looks.nth(5).click();
  await page.waitForSelector("img.leaflet-tile[src*='fields.pattern=hatch']");
  await tiles_drawn(page);
  await save_screenshot(page, "desktop-try-restyle");
  // Closing the offer also restores the earlier state.
  await offer.getByRole("button", { name: "Back" }).click();
  await offer.getByRole("button", { name: "Close" }).click();
  await wait_for_queries(page, { style: "dusk" });
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("groups of layers can be gone to", async () => {
  const { page, seen, offer } = await open();
  assert.deepEqual(await offer.locator(".ways button").allInnerTexts(), ["Countryside", "Invented town"]);
  await offer.getByRole("button", { name: "Invented town" }).click();
  await page.waitForFunction(() => /^#[78]\/4[345]/.test(location.hash));
  await tiles_drawn(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("where the data ends, a line says so and leads back", async () => {
  const { page, seen } = await open("#6/20/60&on=fields,pond");
  const status = page.locator("#status");
  assert.equal(await status.isVisible(), false);
  await page.click(".leaflet-control-zoom-in");
  await status.getByText("There is no more detail here than at zoom 6.").waitFor();
  await save_screenshot(page, "desktop-end-of-detail");
  await status.getByRole("button", { name: "Back to zoom 6" }).click();
  await status.waitFor({ state: "hidden" });
  assert.match(await hash_of(page), /^#6\//);
  // Nothing is shown if the layer is accurate at deeper zooms, or if nobody knows.
  await page.evaluate(() => (location.hash = "#7/45.5/6.5&on=fields,pond"));
  await page.waitForFunction(() => document.querySelector("img.leaflet-tile[src*='/7/']"));
  await tiles_drawn(page);
  assert.equal(await status.isVisible(), false);
  await page.evaluate(() => (location.hash = "#12/45.5/6.5"));
  await page.waitForFunction(() => document.querySelector("img.leaflet-tile[src*='/12/']"));
  await tiles_drawn(page);
  assert.equal(await status.isVisible(), false, "of the land nobody knows");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("on an upright tablet the panel is folded, so that both sides of a comparison are told", async () => {
  const { page, seen, offer } = await open("", TABLET);
  assert.equal(await page.locator("#panel-body").isVisible(), false);
  await offer.getByRole("button", { name: TRIALS[1] }).tap();
  await tiles_drawn(page);
  for (const side of [".left", ".right"]) {
    const is_on_top = await page.locator(`.divider ${side}`).evaluate((label) => {
      const { x, y, width, height } = label.getBoundingClientRect();
      // Labels let clicks through: any element that hides them would be hit there.
      const hit = document.elementFromPoint(x + width / 2, y + height / 2);
      return x >= 0 && x + width <= window.innerWidth && Boolean(hit?.closest("#map"));
    });
    assert.ok(is_on_top, side);
  }
  await save_screenshot(page, "tablet-try-apart");
  await page.tap("#panel-toggle");
  assert.equal(await page.locator("#layers").isVisible(), true);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

/** Expects that all visible elements in `parts` are inside the window and do not overlap. */
async function assert_in_window_and_apart(page, parts) {
  const window = page.viewportSize();
  const boxes = [];
  for (const part of parts) {
    const box = await page.locator(part).boundingBox();
    if (box === null) continue;
    const is_within = box.x >= 0 && box.y >= 0 && box.x + box.width <= window.width &&
      box.y + box.height <= window.height;
    assert.ok(is_within, part);
    boxes.push({ part, ...box });
  }
  boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => {
    const is_apart = a.x + a.width <= b.x || b.x + b.width <= a.x ||
      a.y + a.height <= b.y || b.y + b.height <= a.y;
    assert.ok(is_apart, `${a.part} and ${b.part}`);
  }));
}

test("on a phone all of it is within the window, and nothing lies over another thing", async () => {
  const { page, seen, offer } = await open("", PHONE);
  for (const part of ["#panel", "#try", "#legend", ".leaflet-control-zoom"]) {
    assert.ok(await page.locator(part).isVisible(), part);
  }
  await assert_in_window_and_apart(page, ["#panel", "#try", "#legend", ".leaflet-control-zoom"]);
  await save_screenshot(page, "phone-first-sight");
  for (const trial of TRIALS) {
    await offer.getByRole("button", { name: trial }).tap();
    await tiles_drawn(page);
    const { x, width, height } = await offer.boundingBox();
    assert.ok(x >= 0 && x + width <= 390 && height < 300, `${trial}: ${x}, ${width} x ${height}`);
    await offer.getByRole("button", { name: "Back" }).tap();
  }
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("on a phone it is seen when it is opened from the panel, which folds", async () => {
  const { page, seen, offer } = await open("#5/45/60", PHONE);
  await page.locator("#panel-toggle").tap();
  await page.locator("#try-open").tap();
  assert.ok(await offer.isVisible());
  assert.ok(await page.locator("#panel-body").isHidden());
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("another address ends what is tried, and is not taken back with it", async () => {
  const { page, seen, offer } = await open();
  await offer.getByRole("button", { name: TRIALS[0] }).click();
  await page.evaluate(() => (location.hash = "#4/30/60&simplify=8"));
  await wait_for_queries(page, { simplify: "8" });
  await offer.getByRole("button", { name: "Close" }).click();
  await tiles_drawn(page);
  assert.match(await hash_of(page), /&simplify=8$/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

for (const viewport of [{ width: 844, height: 390 }, { width: 667, height: 375 }, { width: 568, height: 320 }]) {
  test(`so it is on a phone of ${viewport.width} x ${viewport.height} that lies on its side`, async () => {
    const { page, seen, offer } = await open("", { ...PHONE, viewport });
    const parts = ["#panel", "#try", "#legend", ".leaflet-control-zoom"];
    assert.ok(await offer.isVisible());
    await assert_in_window_and_apart(page, parts);
    await save_screenshot(page, `phone-on-its-side-${viewport.width}`);
    await offer.getByRole("button", { name: "Close" }).tap();
    await assert_in_window_and_apart(page, parts);
    assert.ok(await page.locator("#legend").isVisible());
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });
}
