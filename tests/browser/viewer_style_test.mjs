// Every control of the viewer changes the requested tiles, and the address keeps it.
import assert from "node:assert/strict";
import test from "node:test";

import {
  PHONE, assert_nothing_went_wrong, hash_of, new_page, of_layer, pixels_of_colour, query_of,
  save_screenshot, shown_tiles, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const FAILED_RESOURCE = /^Failed to load resource/; // Chromium's message for every answer that is not 2xx

const { browser, server } = await start_browser_and_server();

/** Opens a page with the panel and the style of the layer "Land" unfolded. */
async function open(hash = "#5/46/10", options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  if (await page.locator("#panel-body").isHidden()) await page.click("#panel-toggle");
  for (const title of ["Style of Land", "Detail", "Tiles"]) {
    const named = page.getByLabel(title).or(page.getByText(title, { exact: true }));
    await page.locator("summary").and(named).click();
  }
  const land = page.locator("#layers li").filter({ has: page.getByLabel("Style of Land") });
  return { page, seen, land };
}

/** Waits until all tiles of the layer are requested with exactly these parameters. */
async function wait_for_query(page, name, wanted) {
  const text = (query) => JSON.stringify(Object.entries(query).sort());
  const end = Date.now() + 30_000;
  for (let told = []; ; await page.waitForTimeout(50)) {
    const tiles = of_layer(await shown_tiles(page), name);
    if (tiles.length && tiles.every((url) => text(query_of(url, name)) === text(wanted))) break;
    told = tiles;
    assert.ok(Date.now() < end, `${text(wanted)} of ${name} among ${[...new Set(told)].join(" ")}`);
  }
  await tiles_drawn(page);
}

/** Expects that the address alone restores the same tiles. */
async function assert_survives_reload(page) {
  const hash = await hash_of(page);
  const tiles = await shown_tiles(page);
  await page.reload();
  await page.waitForFunction((count) =>
    document.querySelectorAll("img.leaflet-tile-loaded").length === count, tiles.length);
  assert.deepEqual(await shown_tiles(page), tiles);
  assert.equal(await hash_of(page), hash);
}

/** Sets a slider as with the keyboard: in its own steps, with a change event at the end. */
async function slide(locator, value) {
  await locator.fill(String(value));
}

const STYLE_CONTROLS = [
  ["the colour", (land) => land.getByLabel("Colour of Land").fill("#ff0000"), { fill: "ff0000" }],
  ["the opacity of the fill", (land) => slide(land.getByLabel("Fill opacity"), 0.5),
    { "fill-opacity": "0.5" }],
  ["the opacity", (land) => slide(land.getByLabel("Opacity", { exact: true }), 0.25),
    { opacity: "0.25" }],
  ["the outline", (land) => land.getByRole("checkbox", { name: "Outline" }).check(),
    { stroke: "33414f" }],
  ["its parts", async (land) => {
    await land.getByRole("checkbox", { name: "Outline" }).check();
    await land.getByLabel("Colour of outline").fill("#0000ff");
    await slide(land.getByLabel("Width"), 3);
    await land.getByLabel("Dashes").selectOption("dashed");
    await slide(land.getByLabel("Line opacity"), 0.5);
  }, { stroke: "0000ff", "stroke-width": "3", "stroke-dasharray": "6,4", "stroke-opacity": "0.5" }],
  ["the pattern", (land) => land.getByRole("combobox", { name: "Pattern" }).selectOption("dots"),
    { pattern: "dots" }],
  ["its parts", async (land) => {
    await land.getByRole("combobox", { name: "Pattern" }).selectOption("hatch");
    await land.getByLabel("Colour of pattern").fill("#00ff00");
    await slide(land.getByLabel("Size"), 16);
    await slide(land.getByLabel("Angle"), 0);
  }, { pattern: "hatch", "pattern-color": "00ff00", "pattern-size": "16", "pattern-angle": "0" }],
  ["what is narrow", (land) => slide(land.getByLabel("Grow"), 2), { grow: "2" }],
  ["the corners", (land) => slide(land.getByLabel("Smooth"), 6), { smooth: "6" }],
  ["the names", async (land) => {
    await land.getByRole("combobox", { name: "Names" }).selectOption("name");
    await slide(land.getByLabel("Letters"), 16);
    await land.getByLabel("Colour of labels").fill("#102030");
  }, { label: "name", "label-size": "16", "label-color": "102030" }],
  ["the filter", async (land) => {
    await land.getByLabel("Filter").fill("people > 100");
    await land.getByLabel("Filter").press("Enter");
  }, { filter: "people > 100" }],
];

for (const [name, act, wanted] of STYLE_CONTROLS) {
  test(`style: ${name} sets ${Object.keys(wanted).join(", ")} of that layer alone`, async () => {
    const { page, seen, land } = await open();
    await act(land);
    await wait_for_query(page, "land", wanted);
    for (const url of of_layer(await shown_tiles(page), "lake")) {
      assert.deepEqual(query_of(url, "lake"), {});
    }
    await assert_survives_reload(page);
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });
}

test("what is switched off takes its parts along, and the usual style asks for nothing", async () => {
  const { page, seen, land } = await open(
    "#5/46/10&land.stroke=red&land.stroke-width=3&land.pattern=hatch&land.pattern-size=16" +
    "&land.stroke-linejoin=bevel");
  await wait_for_query(page, "land", {
    stroke: "red", "stroke-width": "3", pattern: "hatch", "pattern-size": "16",
    "stroke-linejoin": "bevel",
  });
  await land.getByRole("checkbox", { name: "Outline" }).uncheck();
  await land.getByRole("combobox", { name: "Pattern" }).selectOption("none");
  await wait_for_query(page, "land", { "stroke-linejoin": "bevel" });
  assert.equal(await land.getByLabel("Width").isVisible(), false);
  await land.getByRole("button", { name: "Reset" }).click();
  await wait_for_query(page, "land", {});
  assert.equal(await hash_of(page), "#5/46.000/10.000");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("classes of a text are suggested from the map, recoloured, added and removed", async () => {
  const { page, seen, land } = await open();
  await land.getByLabel("Colour by").selectOption("name");
  const mainland = "mainland with a bay and a lake";
  await page.waitForFunction(() => location.hash.includes("land.color-by=name"));
  await land.getByRole("button", { name: "Remove island" }).click();
  await land.getByLabel(`Colour of ${mainland}`).fill("#ff0000");
  await land.getByRole("button", { name: "Add a class" }).click();
  await page.keyboard.type("island");
  await page.keyboard.press("Tab");
  await page.waitForFunction(() => location.hash.includes("island"));
  const colour = (await land.locator(".classes input[type=color]").last().inputValue()).slice(1);
  await wait_for_query(page, "land",
    { "color-by": "name", classes: `${mainland}:ff0000,*:d9dde2,island:${colour}` });
  assert.ok((await pixels_of_colour(page, "land", [255, 0, 0])) > 1000);
  assert.deepEqual((await page.locator("#legend li").allInnerTexts()).map((text) => text.trim()),
    ["Lake", mainland, "island", "others"]);
  await save_screenshot(page, "desktop-classes");
  await assert_survives_reload(page);

  await page.getByLabel("Style of Land").click();
  await land.getByRole("button", { name: "Remove all others" }).click();
  await land.getByRole("button", { name: "Remove island" }).click();
  await wait_for_query(page, "land", { "color-by": "name", classes: `${mainland}:ff0000` });
  await land.getByLabel("Colour by").selectOption("");
  await wait_for_query(page, "land", {});
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("classes of a number are ranges with a ramp, or values", async () => {
  const { page, seen, land } = await open();
  await land.getByLabel("Colour by").selectOption("people");
  await page.waitForFunction(() => location.hash.includes("land.breaks=50000"));
  await land.getByRole("textbox", { name: "Breaks" }).fill("10, 1000 20000");
  await land.getByLabel("Ramp").selectOption("Reds");
  await wait_for_query(page, "land", { "color-by": "people", breaks: "10,1000,20000", ramp: "Reds" });
  assert.equal(await page.locator("#legend li").count(), 6, "four classes, others, and the lake");
  await assert_survives_reload(page);

  await page.getByLabel("Style of Land").click();
  await land.getByLabel("Classes by").selectOption("by value");
  await land.getByRole("button", { name: "Suggest from map" }).click();
  await page.waitForFunction(() => /land\.classes=12:[0-9a-f]{6},50000:[0-9a-f]{6},\*:d9dde2/.test(location.hash));
  await page.waitForFunction(() => !location.hash.includes("breaks"));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("what the server refuses is told in its words, and the map keeps what was right", async () => {
  const { page, seen, land } = await open();
  const filter = land.getByLabel("Filter");
  await filter.fill("nobody = 1");
  await filter.press("Enter");
  const problem = land.getByRole("alert");
  await problem.getByText("nobody").waitFor();
  assert.equal(await filter.getAttribute("aria-invalid"), "true");
  assert.ok((await shown_tiles(page)).every((url) => !url.includes("filter")));
  assert.ok(!(await hash_of(page)).includes("filter"));
  await save_screenshot(page, "desktop-problem");

  await filter.fill("name = 'island'");
  await filter.press("Enter");
  await wait_for_query(page, "land", { filter: "name = 'island'" });
  assert.equal(await problem.count(), 0);
  assert.equal(await filter.getAttribute("aria-invalid"), null);
  assert.deepEqual(seen.errors.filter((text) => !FAILED_RESOURCE.test(text)), []);
  assert.deepEqual(seen.tiles.filter(({ status }) => status !== 200), []);
  await page.context().close();
});

test("a wrong style in the address is told, and the usual one is drawn", async () => {
  const { page, seen } = await new_page(browser);
  await page.goto(`${server.base}#5/46/10&land.fill=nonsense&lake.fill=00ff00`);
  await page.getByRole("alert").getByText("fill").waitFor();
  await page.waitForFunction(() => {
    const told = document.querySelector("[role=alert]").getBoundingClientRect();
    const list = document.querySelector("#layers").getBoundingClientRect();
    return told.top >= list.top && told.bottom <= list.bottom;
  });
  await page.locator("#legend").getByText("Land").waitFor();
  await wait_for_query(page, "land", {});
  await wait_for_query(page, "lake", { fill: "00ff00" });
  assert.deepEqual(seen.tiles.filter(({ status }) => status !== 200), []);
  await page.context().close();
});

test("an answer that comes late does not undo what was changed since", async () => {
  const { page, seen, land } = await open();
  let let_go;
  const held = new Promise((resolve) => (let_go = resolve));
  await page.route("**/legend/land.json?**fill=ff0000**", async (route) => {
    await held;
    await route.continue();
  });
  const late = page.waitForResponse((response) => response.url().includes("fill=ff0000"));
  await land.getByLabel("Colour of Land").fill("#ff0000");
  await land.getByLabel("Colour of Land").fill("#00ff00");
  await wait_for_query(page, "land", { fill: "00ff00" });
  let_go();
  await (await late).finished();
  await page.waitForTimeout(500); // time enough for the late answer to be used
  await wait_for_query(page, "land", { fill: "00ff00" });
  assert.ok(!seen.tiles.some(({ url }) => url.includes("ff0000")));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a named style is asked for, shown in the panel, and changed by what is set", async () => {
  const { page, seen, land } = await open();
  await page.getByRole("combobox", { name: "Style", exact: true }).selectOption("night");
  await wait_for_query(page, "land", { style: "night" });
  await wait_for_query(page, "lake", { style: "night" });
  assert.ok((await pixels_of_colour(page, "land", [0x40, 0x50, 0x60])) > 1000);
  assert.ok((await pixels_of_colour(page, "land", [0x10, 0x20, 0x30])) > 1000);
  assert.equal(await page.locator("#detail output").innerText(), "2 px");
  const width = land.locator(".slider", { hasText: "Width" });
  assert.equal(await width.locator("output").innerText(), "3 px");
  assert.deepEqual(await land.locator(".classes input[type=text]").evaluateAll((inputs) =>
    inputs.map(({ value }) => value)), ["island"]);
  await assert_survives_reload(page);

  await page.getByLabel("Style of Land").click();
  await land.getByRole("checkbox", { name: "Outline" }).uncheck();
  await wait_for_query(page, "land", { style: "night", "stroke-width": "0" });
  await land.getByRole("checkbox", { name: "Outline" }).check();
  await wait_for_query(page, "land", { style: "night" });
  await land.getByLabel("Colour by").selectOption("");
  await wait_for_query(page, "land", { style: "night", "color-by": "name", classes: "*:405060ff" });
  await page.locator("#detail summary").click();
  await slide(page.getByLabel("Simplify"), 1);
  await wait_for_query(page, "land",
    { style: "night", simplify: "0.25", "color-by": "name", classes: "*:405060ff" });
  await page.getByLabel("Style of Lake").click();
  await page.locator("#layers li").first().getByRole("combobox", { name: "Pattern" })
    .selectOption("none");
  await wait_for_query(page, "lake",
    { style: "night", simplify: "0.25", pattern: "none" });
  await page.getByRole("combobox", { name: "Style", exact: true }).selectOption("");
  await wait_for_query(page, "lake", { simplify: "0.25", pattern: "none" });
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("what is set for a layer holds over what a named style sets for it, also where it is the only one",
  async () => {
    const { page, seen, land } = await open("#5/46/10&on=land&style=night&land.fill=00ff00");
    assert.ok((await pixels_of_colour(page, "land", [0, 255, 0])) > 1000);
    const swatch = page.locator("#legend li", { hasText: "others" }).locator(".ink");
    assert.equal(await swatch.evaluate((ink) => getComputedStyle(ink).backgroundColor), "rgb(0, 255, 0)");
    // The error is shown beside the control.
    await land.getByLabel("Filter").fill("nobody = 1");
    await page.keyboard.press("Tab");
    await land.locator("fieldset[aria-label=Features] .problem").waitFor();
    assert.equal(await land.getByLabel("Filter").getAttribute("aria-invalid"), "true");
    assert.deepEqual(seen.errors.filter((text) => !text.includes("400")), []);
    await page.context().close();
  });

test("a style that the server does not know is told and left out", async () => {
  const { page, seen } = await new_page(browser);
  await page.goto(`${server.base}#5/46/10&style=nonsense`);
  await page.getByText('There is no style "nonsense".').waitFor();
  await wait_for_query(page, "land", {});
  assert.ok(!(await hash_of(page)).includes("style"));
  assert.deepEqual(seen.tiles.filter(({ status }) => status !== 200), []);
  await page.context().close();
});

test("detail: simplify, topology, small and debug hold for all layers", async () => {
  const { page, seen } = await open();
  await slide(page.getByLabel("Simplify"), 6);
  assert.equal(await page.locator("#detail output").innerText(), "8 px");
  await page.getByLabel("Borders never cross").uncheck();
  await page.getByLabel("Tiny shapes").selectOption("left out");
  await page.getByLabel("Trapezoids").check();
  await page.getByLabel("Tile borders").check();
  const wanted = { simplify: "8", small: "drop", debug: "mesh,tile" };
  await wait_for_query(page, "land", { ...wanted, topology: "fast" });
  await wait_for_query(page, "lake", wanted); // is not served with topology=fast
  const url = new URL(await page.locator("#tile-url").inputValue());
  assert.equal(url.searchParams.get("land.topology"), "fast");
  assert.equal(url.searchParams.get("topology"), null);
  await assert_survives_reload(page);
  await page.locator("#detail summary").click();
  assert.equal(await page.getByLabel("Borders never cross").isChecked(), false);
  assert.equal(await page.getByLabel("Vertices").isChecked(), false);
  await page.getByLabel("Trapezoids").uncheck();
  await page.getByLabel("Tile borders").uncheck();
  await slide(page.getByLabel("Simplify"), 1);
  await page.getByLabel("Borders never cross").check();
  await page.getByLabel("Tiny shapes").selectOption("as a tint");
  await wait_for_query(page, "land", {});
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

/** The colour of the map on the screen at (x, y), taken from a screenshot of the page. */
async function colour_on_screen(page, x, y) {
  const picture = await page.screenshot({ clip: { x, y, width: 1, height: 1 } });
  return page.evaluate(async (bytes) => {
    const bitmap = await createImageBitmap(new Blob([new Uint8Array(bytes)]));
    const context = new OffscreenCanvas(1, 1).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(0, 0, 1, 1).data.slice(0, 3)];
  }, [...picture]);
}

test("tiny shapes can be left a tint while features grow", async () => {
  const { page, seen, land } = await open();
  const small = page.getByLabel("Tiny shapes");
  assert.equal(await small.inputValue(), "dust");
  await slide(land.getByLabel("Grow"), 2);
  await wait_for_query(page, "land", { grow: "2" });
  assert.equal(await small.inputValue(), "keep");
  await small.selectOption("as a tint");
  await wait_for_query(page, "land", { grow: "2", small: "dust" });
  await assert_survives_reload(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("compare shows every vertex right of a divider that pointer and keyboard move", async () => {
  const { page, seen } = await open("#5/46/10&on=land&simplify=64&debug=vertices");
  assert.equal(await page.getByLabel("Compare with separate polygons").count(), 0, "none share borders");
  await page.getByLabel("Compare with every vertex").check();
  await page.waitForFunction(() => location.hash.includes("compare=0.5"));
  await page.waitForSelector("img[src*='simplify=0']");
  await tiles_drawn(page);
  const queries = new Set((await shown_tiles(page)).map((url) => query_of(url, "land").simplify));
  assert.deepEqual([...queries].sort(), ["0", "64"]);
  const parts = await page.evaluate(() =>
    ["simplified", "full"].map((name) =>
      getComputedStyle(document.querySelector(`.leaflet-${name}-pane`)).clipPath));
  assert.ok(parts.every((part) => part.startsWith("polygon")), parts.join(" | "));
  await save_screenshot(page, "desktop-compare");

  const divider = page.getByLabel("Divider between");
  await divider.focus();
  await page.keyboard.press("ArrowLeft");
  await page.waitForFunction(() => location.hash.includes("compare=0.49"));
  const { y, height, width } = await divider.boundingBox();
  await page.mouse.move(22 + 0.49 * (width - 44), y + height / 2);
  await page.mouse.down();
  await page.mouse.move(300, y + height / 2, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction(() => /compare=0\.2\d/.test(location.hash));
  await assert_survives_reload(page);

  await page.locator("#detail summary").click();
  await page.getByLabel("Compare with every vertex").uncheck();
  await page.waitForFunction(() => !document.querySelector("img[src*='simplify=0']"));
  assert.ok(!(await hash_of(page)).includes("compare"));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("compare: each side shows its own picture, also after the map was moved", async () => {
  const { page, seen } = await new_page(browser);
  // The full-detail side gets another colour here, as no style can tell the two sides apart.
  await page.route("**/tiles/land/**simplify=0**", async (route) => {
    const url = route.request().url();
    await route.continue({ url: `${url}&fill=ff0000` });
  });
  await page.goto(`${server.base}#6/44/10&on=land&compare=0.5`);
  await tiles_drawn(page);
  const assert_sides = async () => {
    assert.deepEqual(await colour_on_screen(page, 600, 460), [0xd8, 0xc9, 0x9b]);
    assert.deepEqual(await colour_on_screen(page, 680, 460), [255, 0, 0]);
  };
  await assert_sides();
  await page.focus("#map");
  const before = await hash_of(page);
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction((hash) => location.hash !== hash, before); // written once the map has come to rest
  await tiles_drawn(page);
  await assert_sides();
  assert.deepEqual(seen.errors, []);
  await page.context().close();
});

test("the address of the tiles gives the picture that is shown, and can be copied", async () => {
  const { page, seen, land } = await open();
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await land.getByLabel("Colour of Land").fill("#ff0000");
  await page.waitForFunction(() => document.querySelector("#tile-url").value.includes("ff0000"));
  await page.getByRole("button", { name: "Copy" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(copied, `${server.base}tiles/land,lake/{z}/{x}/{y}.png?land.fill=ff0000`);
  const tile = copied.replace("{z}", 4).replace("{x}", 8).replace("{y}", 5);
  assert.equal((await fetch(tile)).status, 200);

  await page.getByLabel("Lake", { exact: true }).uncheck();
  await page.waitForFunction((base) => document.querySelector("#tile-url").value ===
    `${base}tiles/land/{z}/{x}/{y}.png?fill=ff0000`, server.base);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the time of tiles is told, and how many were kept", async () => {
  const { page, seen, land } = await open();
  const timing = page.locator("#timing");
  await land.getByLabel("Colour of Land").fill("#123456"); // used in no other test, so no tile is cached
  await wait_for_query(page, "land", { fill: "123456" });
  await timing.getByText(/^median [\d.]+ ms, drawing [\d.]+ ms, \d+ of \d+ from a cache$/).waitFor();
  await page.reload();
  await wait_for_query(page, "land", { fill: "123456" });
  await page.locator("#tiles summary").click();
  await timing.getByText(/^median [\d.]+ ms, (\d+) of \1 from a cache$/).waitFor();
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("everything in the panel can be reached and used by keyboard", async () => {
  const { page, seen, land } = await open();
  await page.focus("#panel-toggle");
  const reached = new Set();
  for (let i = 0; i < 60; i++) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => {
      const { id, labels, textContent, ariaLabel } = document.activeElement;
      return ariaLabel ?? labels?.[0]?.firstChild?.textContent ?? (textContent.trim() || id);
    }));
  }
  for (const name of ["Style of Lake", "Colour of Land", "Style of Land", "Fill opacity", "Colour by",
    "Pattern", "Names", "Filter", "Reset", "Detail", "Simplify", "Tiny shapes", "Tiles",
    "Copy"]) {
    assert.ok(reached.has(name), `${name} among ${[...reached].join(", ")}`);
  }
  const { y, height } = await page.locator("#share-open").boundingBox();
  assert.ok(y + height <= 800, "the way out stays in reach");
  await land.getByLabel("Fill opacity").focus();
  await page.keyboard.press("ArrowLeft");
  await wait_for_query(page, "land", { "fill-opacity": "0.95" });
  await page.locator("#panel-toggle").focus();
  await page.keyboard.press("Enter");
  assert.equal(await page.locator("#panel-body").isVisible(), false);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a phone shows every control within its width, large enough for a finger", async () => {
  const { page, seen, land } = await open("#5/46/10&land.stroke=red&land.pattern=dots", PHONE);
  const controls = await land.locator("button, select, summary, label.check, input[type=color]").all();
  assert.ok(controls.length >= 8);
  for (const control of controls) {
    if (!(await control.isVisible())) continue;
    const { x, width, height } = await control.boundingBox();
    const name = await control.evaluate((e) => e.outerHTML.slice(0, 80));
    assert.ok(height >= 40 && x >= 0 && x + width <= 390, `${name}: ${x}, ${width} x ${height}`);
  }
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await save_screenshot(page, "phone-style");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
