// What lies under a click is told and highlighted.
import assert from "node:assert/strict";
import test from "node:test";

import {
  PHONE, assert_nothing_went_wrong, hash_of, new_page, pixels_of_colour, save_screenshot,
  start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const HIGHLIGHT = [0xff, 0xcc, 0x00];

const { browser, server } = await start_browser_and_server();

async function open(hash, options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen, features: page.locator("#features") };
}

const highlighted = (page, layer) => pixels_of_colour(page, layer, HIGHLIGHT);

async function wait_for_highlight(page, layer) {
  await page.waitForFunction((name) => {
    const tiles = [...document.querySelectorAll("img.leaflet-tile")];
    const is_highlighted = new RegExp(`/tiles/${name}/.*[?&]highlight=|[?&]${name}\\.highlight=`);
    return tiles.length > 0 && tiles.every(({ src }) => is_highlighted.test(src));
  }, layer);
  await tiles_drawn(page);
}

async function wait_for_no_highlight(page) {
  await page.waitForFunction(() => !document.querySelector("img.leaflet-tile[src*='highlight=']"));
  await tiles_drawn(page);
}

test("a click tells the attributes and highlights the feature; the address keeps it", async () => {
  const { page, seen, features } = await open("#5/46/10");
  await page.mouse.click(640, 400); // 46 north, 10 east: the mainland
  await features.getByText("mainland with a bay and a lake").waitFor();
  assert.deepEqual(await features.locator("dt").allInnerTexts(), ["name", "people"]);
  assert.deepEqual(await features.locator("dd").allInnerTexts(),
    ["mainland with a bay and a lake", "50000"]);
  await wait_for_highlight(page, "land");
  assert.ok((await highlighted(page, "land")) > 1000);
  await save_screenshot(page, "desktop-feature");

  const hash = await hash_of(page);
  assert.match(hash, /land\.highlight=\d+/);
  assert.match(hash, /at=46(\.\d+)?,10(\.\d+)?/);
  await page.reload();
  await wait_for_highlight(page, "land");
  await features.getByText("mainland with a bay and a lake").waitFor();
  assert.equal(await hash_of(page), hash);

  await features.getByRole("button", { name: "Close" }).click();
  await wait_for_no_highlight(page);
  assert.equal(await features.isVisible(), false);
  assert.doesNotMatch(await hash_of(page), /at=|highlight/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("of several features one is chosen by button, and one is gone to", async () => {
  const { page, seen, features } = await open("#5/46/10&on=land");
  // The island of the source has no other feature above or below it: the server's answer is doubled.
  await page.route("**/identify/**", async (route) => {
    const response = await route.fetch();
    const told = await response.json();
    told.features.push({
      type: "Feature", id: 1, layer: "land", bbox: [0, 45, 1, 47], geometry: null,
      properties: { name: "<b>island</b>", people: null },
    });
    await route.fulfill({ response, json: told });
  });
  await page.mouse.click(640, 400);
  const choices = features.locator(".found button");
  await choices.nth(1).click();
  await features.getByText("<b>island</b>").waitFor();
  assert.deepEqual(await features.locator("dd").allInnerTexts(), ["<b>island</b>", "–"]);
  assert.equal(await choices.nth(1).getAttribute("aria-pressed"), "true");
  assert.equal(await choices.nth(0).getAttribute("aria-pressed"), "false");
  await page.waitForFunction(() => location.hash.includes("land.highlight=1&"));
  await features.getByRole("button", { name: "Go to it" }).click();
  await page.waitForFunction(() => /^#[789]\/4[56]\.\d+\/0\.\d+&/.test(location.hash));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the keyboard asks for the middle of the map and comes back to it", async () => {
  const { page, seen, features } = await open("#6/45.5/6.5");
  await page.focus("#map");
  await page.keyboard.press("Enter");
  await features.getByText("the lake").waitFor();
  await wait_for_highlight(page, "lake");
  assert.ok((await highlighted(page, "lake")) > 1000);
  assert.equal(await page.evaluate(() => document.activeElement.ariaLabel), "Close");
  await page.keyboard.press("Escape");
  await wait_for_no_highlight(page);
  assert.equal(await features.isVisible(), false);
  assert.equal(await page.evaluate(() => document.activeElement.id), "map");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("only what is drawn is found: layers that are off and filtered features are not", async () => {
  const { page, seen, features } = await open("#6/45.5/6.5&on=land&land.filter=people<100");
  await page.focus("#map");
  await page.keyboard.press("Enter");
  await features.getByText("There is nothing here.").waitFor();
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a click beside everything says so, and a double click asks nothing", async () => {
  const { page, seen, features } = await open("#5/46/10");
  await page.mouse.dblclick(640, 400);
  await page.waitForTimeout(800);
  assert.equal(await features.isVisible(), false);
  assert.ok(!seen.requests.some((url) => url.includes("/identify/")));
  await page.goto(`${server.base}#5/46/-40`);
  await tiles_drawn(page);
  await page.mouse.click(500, 400);
  await features.getByText("There is nothing here.").waitFor();
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("an answer that never comes is told", async () => {
  const { page, features } = await open("#5/46/10");
  await page.route("**/identify/**", (route) => route.abort());
  await page.mouse.click(640, 400);
  await features.getByText("The server cannot be reached.").waitFor();
  await page.context().close();
});

test("a phone shows the feature below the map, and a tap closes it", async () => {
  const { page, seen, features } = await open("#5/46/10", PHONE);
  await page.touchscreen.tap(195, 422);
  await features.getByText("mainland with a bay and a lake").waitFor();
  await wait_for_highlight(page, "land");
  const { y, height, width } = await features.boundingBox();
  assert.ok(y > 422 && y + height <= 844 && width <= 390);
  await save_screenshot(page, "phone-feature");
  await features.getByRole("button", { name: "Close" }).tap();
  await wait_for_no_highlight(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
