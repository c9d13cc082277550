// The features under a click are described and outlined.
import assert from "node:assert/strict";
import test from "node:test";

import {
  PHONE, assert_nothing_went_wrong, hash_of, new_page, pixels_of_colour, save_screenshot,
  start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const OUTLINE = [0xc2, 0x18, 0x5b];
const LAND = [0xd8, 0xc9, 0x9b];

const { browser, server } = await start_browser_and_server();

async function open(hash, options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen, features: page.locator("#features") };
}

const outlined = (page, layer) => pixels_of_colour(page, layer, OUTLINE);

/** Waits until the tiles above the map outline this feature and no other. */
async function wait_for_outline(page, layer, id) {
  await page.waitForFunction((wanted) => {
    const tiles = [...document.querySelectorAll(".leaflet-chosen-pane img.leaflet-tile")];
    return tiles.length > 0 && tiles.every(({ src }) => src.includes(wanted));
  }, `/tiles/${layer}/`);
  await page.waitForFunction((wanted) =>
    [...document.querySelectorAll(".leaflet-chosen-pane img.leaflet-tile")].every(({ src }) =>
      new URL(src).searchParams.get("ids") === wanted), String(id));
  await tiles_drawn(page);
}

async function wait_for_no_outline(page) {
  await page.waitForFunction(() =>
    !document.querySelector(".leaflet-chosen-pane img.leaflet-tile"));
  await tiles_drawn(page);
}

/** The opaque colours in the outline's tiles, except the colour of the line. */
function filled(page, layer) {
  return page.evaluate(([layer, line]) => {
    const found = new Set();
    for (const tile of document.querySelectorAll(`.leaflet-chosen-pane img[src*="/${layer}/"]`)) {
      const context = new OffscreenCanvas(256, 256).getContext("2d");
      context.drawImage(tile, 0, 0);
      const { data } = context.getImageData(0, 0, 256, 256);
      for (let i = 0; i < data.length; i += 4) {
        const colour = [...data.slice(i, i + 3)];
        if (data[i + 3] > 250 && colour.some((part, c) => Math.abs(part - line[c]) > 40)) {
          found.add(colour.join());
        }
      }
    }
    return [...found];
  }, [layer, OUTLINE]);
}

test("a click tells the attributes under the title and outlines the feature; the address keeps it", async () => {
  const { page, seen, features } = await open("#5/46/10");
  await page.mouse.click(640, 400); // 46 north, 10 east: the mainland
  const heading = features.getByRole("heading", { name: "mainland with a bay and a lake" });
  await heading.waitFor();
  assert.deepEqual(await features.locator("dt").allInnerTexts(), ["name", "people"]);
  assert.deepEqual(await features.locator("dd").allInnerTexts(),
    ["mainland with a bay and a lake", "50000"]);
  await wait_for_outline(page, "land", 0);
  assert.ok((await outlined(page, "land")) > 300);
  assert.ok((await pixels_of_colour(page, "land", LAND)) > 10_000, "the map below is as it was");
  assert.deepEqual(await filled(page, "land"), [], "no colour hides what is below");
  await save_screenshot(page, "desktop-feature");

  const hash = await hash_of(page);
  assert.match(hash, /chosen=land\/0/);
  assert.match(hash, /at=46(\.\d+)?,10(\.\d+)?/);
  await page.reload();
  await wait_for_outline(page, "land", 0);
  await heading.waitFor();
  assert.equal(await hash_of(page), hash);

  await features.getByRole("button", { name: "Close" }).click();
  await wait_for_no_outline(page);
  assert.equal(await features.isVisible(), false);
  assert.doesNotMatch(await hash_of(page), /at=|chosen/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("of several features one is chosen by button, and one is gone to", async () => {
  const { page, seen, features } = await open("#5/46/10&on=land");
  // In the source, the island does not overlap any other feature, so the server's answer is doubled
  // here.
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
  await features.getByRole("definition").getByText("<b>island</b>").waitFor();
  assert.deepEqual(await features.locator("dd").allInnerTexts(), ["<b>island</b>", "–"]);
  assert.equal(await choices.nth(1).getAttribute("aria-pressed"), "true");
  assert.equal(await choices.nth(0).getAttribute("aria-pressed"), "false");
  assert.ok(await choices.nth(1).evaluate((choice) => choice === document.activeElement),
    "the focus stays where it was, so that Escape still closes the panel");
  await page.waitForFunction(() => location.hash.endsWith("&chosen=land/1"));
  await wait_for_outline(page, "land", 1);
  await features.getByRole("button", { name: "Go to it" }).click();
  await page.waitForFunction(() => /^#[789]\/4[4-7]\.\d+\/[01]\.\d+&/.test(location.hash));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the keyboard asks for the middle of the map and comes back to it", async () => {
  const { page, seen, features } = await open("#6/45.5/6.5");
  await page.focus("#map");
  await page.keyboard.press("Enter");
  await features.getByText("the lake").first().waitFor();
  await wait_for_outline(page, "lake", 0);
  assert.ok((await outlined(page, "lake")) > 300);
  assert.equal(await page.evaluate(() => document.activeElement.ariaLabel), "Close");
  await page.keyboard.press("Escape");
  await wait_for_no_outline(page);
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
  // Both clicks in one step: a busy machine may delay the second click beyond a double click's
  // limit.
  await page.evaluate(() => {
    const place = { bubbles: true, clientX: 640, clientY: 400 };
    const click = ["mousedown", "mouseup", "click"];
    const target = document.elementFromPoint(place.clientX, place.clientY);
    for (const type of [...click, ...click, "dblclick"]) target.dispatchEvent(new MouseEvent(type, place));
  });
  await page.waitForFunction(() => location.hash.startsWith("#6/"));
  await page.waitForTimeout(500); // time enough to send a request
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
  await features.getByRole("heading", { name: "mainland" }).waitFor();
  await wait_for_outline(page, "land", 0);
  const { y, height, width } = await features.boundingBox();
  assert.ok(y > 422 && y + height <= 844 && width <= 390);
  await save_screenshot(page, "phone-feature");
  await features.getByRole("button", { name: "Close" }).tap();
  await wait_for_no_outline(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("of a feature in parts, it goes to the part under the click", async () => {
  const { page, seen, features } = await open("#5/46/10&on=land");
  await page.route("**/identify/**", async (route) => {
    const response = await route.fetch();
    const told = await response.json();
    Object.assign(told.features[0], { bbox: [-170, -80, 170, 80], part_bbox: [0, 45, 1, 47] });
    await route.fulfill({ response, json: told });
  });
  await page.mouse.click(640, 400);
  await features.getByRole("button", { name: "Go to it" }).click();
  await page.waitForFunction(() => /^#[789]\/4[4-7]\.\d+\/[01]\.\d+&/.test(location.hash));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a click on a small part of a large feature does not paint over the other parts", async () => {
  const { page, seen } = await open("#5/46/10&on=land");
  await page.route("**/identify/**", async (route) => {
    const response = await route.fetch();
    const told = await response.json();
    Object.assign(told.features[0], { bbox: [-170, -80, 170, 80], part_bbox: [10, 46, 10.1, 46.1] });
    await route.fulfill({ response, json: told });
  });
  await page.mouse.click(640, 400);
  await page.waitForFunction(() =>
    [...document.querySelectorAll(".leaflet-chosen-pane img.leaflet-tile")].some(({ src }) =>
      new URL(src).searchParams.get("highlight-fill") === "ffffff40"));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

/** The signs of keyboard focus on the map: its outline, and the mark in the middle. */
function marks_of_focus(page) {
  return page.evaluate(() => {
    const map = document.querySelector("#map");
    return [getComputedStyle(map).outlineStyle, getComputedStyle(map, "::after").content];
  });
}

test("the map shows that it has the focus to who uses keys, and not to who uses a mouse", async () => {
  const { page, seen, features } = await open("#5/46/10");
  await page.mouse.click(640, 400);
  await features.getByRole("button", { name: "Close" }).click();
  assert.equal(await page.evaluate(() => document.activeElement.id), "map");
  assert.deepEqual(await marks_of_focus(page), ["none", "none"]);
  await page.keyboard.press("ArrowRight");
  assert.deepEqual(await marks_of_focus(page), ["solid", '""']);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
