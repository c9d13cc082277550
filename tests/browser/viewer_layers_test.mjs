// Thirty layers: finding, switching, reordering and zooming to them.
import assert from "node:assert/strict";
import { join } from "node:path";
import test from "node:test";

import {
  DESKTOP, HERE, PHONE, assert_nothing_went_wrong, hash_of, layers_of, new_page, save_screenshot,
  shown_tiles, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const FILES = ["land", "lake", "fields"];
const GROUPS = ["Rivers", "Roads", "Parks", "Houses"];
const names = Array.from({ length: 28 }, (_, i) => `layer_${String(i + 1).padStart(2, "0")}`);
const CONFIG = names.map((name, i) => `
[[layer]]
name = "${name}"
file = "${join(HERE, `${FILES[i % FILES.length]}.geojson`)}"
title = "${GROUPS[Math.floor(i / 7)]} ${i % 7}"
group = "${GROUPS[Math.floor(i / 7)]}"
`).join("");
const ALL = ["land", "lake", ...names];
const MOST_IN_ONE = 16;

const { browser, server } = await start_browser_and_server([], CONFIG);

async function open(hash = "#5/46/10", options = DESKTOP) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  if (await page.locator("#panel-body").isHidden()) await page.click("#panel-toggle");
  return { page, seen };
}

/** The layers in the tiles, the lowest first. */
async function layers_drawn(page) {
  const sheets = await page.evaluate(() =>
    [...document.querySelectorAll(".leaflet-simplified-pane .leaflet-layer")]
      .filter((sheet) => sheet.querySelector("img"))
      .sort((a, b) => a.style.zIndex - b.style.zIndex)
      .map((sheet) => sheet.querySelector("img").src));
  return sheets.flatMap(layers_of);
}

async function wait_for_layers(page, wanted) {
  const end = Date.now() + 20_000;
  for (;;) {
    const drawn = await layers_drawn(page);
    if (drawn.join() === wanted.join()) return;
    assert.ok(Date.now() < end, `${drawn} where ${wanted} are wanted`);
    await page.waitForTimeout(50);
  }
}

const rows = (page) => page.locator("#layers .layer:not([hidden])");
const titles = async (page) => (await rows(page).locator(".name").allInnerTexts());

test("thirty layers come in as few requests as the server takes, each in a colour of its own", async () => {
  const { page, seen } = await open();
  await wait_for_layers(page, ALL);
  const places = new Map();
  for (const url of await shown_tiles(page)) {
    const place = new URL(url).pathname.split("/").slice(-3).join("/");
    places.set(place, (places.get(place) ?? 0) + 1);
  }
  assert.deepEqual([...new Set(places.values())], [Math.ceil(ALL.length / MOST_IN_ONE)]);
  const colours = await page.locator("#layers .layer > input[type=color]").evaluateAll((inputs) =>
    inputs.map(({ value }) => value));
  assert.equal(new Set(colours).size, ALL.length);
  await save_screenshot(page, "desktop-thirty-layers");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a search finds layers by title, name and group; what it finds is switched together", async () => {
  const { page, seen } = await open();
  await page.getByLabel("Find a layer").fill("park 3");
  assert.deepEqual(await titles(page), ["Parks 3"]);
  await page.getByLabel("Find a layer").fill("LAYER_0");
  assert.equal((await titles(page)).length, 9);
  await page.getByLabel("Find a layer").fill("roads");
  assert.equal((await titles(page)).length, 7);
  assert.deepEqual(await page.locator("#layers .group:not([hidden])").allInnerTexts(), ["Roads"]);
  await page.getByRole("button", { name: "All off" }).click();
  await wait_for_layers(page, ALL.filter((name) => !names.slice(7, 14).includes(name)));
  await page.getByLabel("Find a layer").fill("nonsense");
  await page.getByText("No layer has that name.").waitFor();
  await page.getByLabel("Find a layer").fill("");
  assert.equal((await titles(page)).length, 30);
  await page.getByRole("button", { name: "All off" }).click();
  await page.getByText("All layers are off. Turn one on in the list.").waitFor();
  assert.match(await hash_of(page), /&on=$/);
  await page.getByRole("button", { name: "All on" }).click();
  await wait_for_layers(page, ALL);
  assert.equal(await hash_of(page), "#5/46.000/10.000");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a group is switched by its heading, which shows whether all of it is on", async () => {
  const { page, seen } = await open();
  const group = page.getByRole("checkbox", { name: "Rivers", exact: true });
  assert.equal(await group.isChecked(), true);
  await page.getByRole("checkbox", { name: "Rivers 3" }).uncheck();
  assert.equal(await group.evaluate((box) => box.indeterminate), true);
  await group.click(); // a click on a partly checked group turns all of it on
  await wait_for_layers(page, ALL);
  await group.uncheck();
  await wait_for_layers(page, ALL.filter((name) => !names.slice(0, 7).includes(name)));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("arrow keys on its handle move a layer; the address keeps the order", async () => {
  const { page, seen } = await open("#5/46/10&on=land,lake,layer_01");
  await wait_for_layers(page, ["land", "lake", "layer_01"]);
  const before = await titles(page);
  const handle = page.getByRole("button", { name: "Move Land" });
  await handle.focus();
  await page.keyboard.press("ArrowUp");
  await wait_for_layers(page, ["lake", "land", "layer_01"]);
  assert.equal(await page.evaluate(() => document.activeElement.ariaLabel), "Move Land");
  await page.keyboard.press("ArrowUp");
  await wait_for_layers(page, ["lake", "layer_01", "land"]);
  await page.locator("[role=status]", { hasText: "Land: 28 of 30 from the top" }).waitFor({ state: "attached" });
  await page.keyboard.press("ArrowDown");
  await wait_for_layers(page, ["lake", "land", "layer_01"]);
  await page.reload();
  await wait_for_layers(page, ["lake", "land", "layer_01"]);
  assert.deepEqual((await titles(page)).slice(-2), ["Land", "Lake"]);
  await page.getByRole("button", { name: "Move Land" }).focus();
  await page.keyboard.press("ArrowDown");
  await wait_for_layers(page, ["land", "lake", "layer_01"]);
  assert.deepEqual(await titles(page), before);
  assert.doesNotMatch(await hash_of(page), /order=/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a layer is dragged by its handle to where it is dropped", async () => {
  const { page, seen } = await open("#5/46/10&on=layer_28,layer_27,layer_26");
  await wait_for_layers(page, ["layer_26", "layer_27", "layer_28"]);
  const middle_of = async (title) => {
    const { x, y, width, height } =
      await page.getByRole("button", { name: `Move ${title}` }).boundingBox();
    return [x + width / 2, y + height / 2];
  };
  const drag = async (title, onto, by) => {
    const [x, y] = await middle_of(onto);
    await page.mouse.move(...await middle_of(title));
    await page.mouse.down();
    await page.mouse.move(x, y + by, { steps: 6 });
    await page.mouse.up();
  };
  await drag("Houses 6", "Houses 4", 10); // from the top to below the third
  await wait_for_layers(page, ["layer_28", "layer_26", "layer_27"]);
  assert.deepEqual((await titles(page)).slice(0, 3), ["Houses 5", "Houses 4", "Houses 6"]);
  await drag("Houses 6", "Houses 5", -10);
  await wait_for_layers(page, ["layer_26", "layer_27", "layer_28"]);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a layer and a group can be gone to", async () => {
  const { page, seen } = await open("#2/0/0");
  await page.getByRole("button", { name: "Zoom to Lake" }).click();
  await page.waitForFunction(() => /^#\d+\/4[456]\..*\/[678]\./.test(location.hash));
  await page.getByRole("button", { name: "Zoom to Parks" }).first().click();
  await page.waitForFunction(() => !/^#\d+\/4[456]\..*\/[678]\./.test(location.hash));
  await tiles_drawn(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

for (const [device, options] of [
  ["laptop", { viewport: { width: 1280, height: 720 } }], ["phone", PHONE],
]) {
  test(`${device}: Detail, Tiles and the way out stay in reach, whatever the list holds`, async () => {
    const { page, seen } = await open("#5/46/10", options);
    const { height } = options.viewport;
    const is_seen = async (locator) => {
      const box = await locator.boundingBox();
      return box !== null && box.y >= 0 && box.y + box.height <= height;
    };
    const ways = [page.locator("#detail summary"), page.locator("#tiles summary"),
      page.locator("#share-open")];
    for (const way of ways) assert.ok(await is_seen(way));
    await page.locator("#layers").evaluate((list) => (list.scrollTop = list.scrollHeight));
    assert.ok(await is_seen(page.getByLabel("Land", { exact: true })));
    for (const way of ways) assert.ok(await is_seen(way));
    await ways[0].click();
    assert.ok(await is_seen(page.getByLabel("Simplify", { exact: true })));
    for (const way of ways) assert.ok(await is_seen(way));
    await save_screenshot(page, `${device}-thirty-layers`);
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });
}
