// The viewer in a headless Chromium, against a running server.
import assert from "node:assert/strict";
import test from "node:test";

import {
  DESKTOP, PHONE, assert_nothing_went_wrong, at_rest, hash_of, new_page, of_layer, pixels_of_colour,
  save_screenshot, shown_tiles, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

// Chromium's message for every answer that is not 2xx; some tests cause such answers on purpose.
const FAILED_RESOURCE = /^Failed to load resource/;

const { browser, server } = await start_browser_and_server();

async function open(hash = "", options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen };
}

const zoom_of = (tile_url) => Number(/\/tiles\/[^/]+\/(\d+)\//.exec(tile_url)[1]);

/** The tiles that are shown after `action` but not before. */
async function new_tiles_after(page, action) {
  const before_it = new Set(await shown_tiles(page));
  const hash = await hash_of(page);
  await action();
  await page.waitForFunction((old) => location.hash !== old, hash);
  await at_rest(page);
  await tiles_drawn(page);
  return (await shown_tiles(page)).filter((url) => !before_it.has(url));
}

test("shows every layer over the others, in its colour, with its attribution", async () => {
  const { page, seen } = await open();
  const tiles = await shown_tiles(page);
  assert.ok(of_layer(tiles, "land").length > 0);
  assert.ok(of_layer(tiles, "lake").length > 0);
  assert.deepEqual(await page.locator("#layers .name").allInnerTexts(), ["Lake", "Land"]);
  assert.ok((await pixels_of_colour(page, "land", [0xd8, 0xc9, 0x9b])) > 1000,
    "land has the colour of the configuration, which the catalog tells as its style");
  assert.ok((await pixels_of_colour(page, "lake", [0x4f, 0x8f, 0xba])) > 1000,
    "lake has the colour of the configuration, which the catalog tells as its style");
  const attribution = page.locator(".leaflet-control-attribution");
  assert.equal(await attribution.innerText(), "Leaflet | Drawn by hand");
  assert.equal(await attribution.getByText("hand").getAttribute("href"), "https://example.org/");
  await save_screenshot(page, "desktop");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

for (const [device, options, zoom] of [["desktop", undefined, 1], ["phone", PHONE, 0]]) {
  test(`${device}: data from one edge of the world to the other, but of few latitudes, is seen whole`, async () => {
    const { page, seen } = await new_page(browser, options);
    await page.route("**/catalog", (route) => route.fulfill({
      json: { layers: [{ name: "land", title: "Land", bounds: [-179.2, 17.9, 179.8, 71.4] }] },
    }));
    await page.goto(server.base);
    await tiles_drawn(page);
    assert.match(await hash_of(page), new RegExp(`^#${zoom}/`));
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });
}

test("a drag brings new tiles and another address", async () => {
  const { page, seen } = await open("#7/46/10");
  const tiles = await new_tiles_after(page, async () => {
    await page.mouse.move(300, 600);
    await page.mouse.down();
    await page.mouse.move(800, 350, { steps: 8 });
    await page.mouse.up();
  });
  assert.ok(tiles.length > 0);
  assert.deepEqual([...new Set(tiles.map(zoom_of))], [7]);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the zoom button, the wheel and the keyboard bring tiles of the next zoom", async () => {
  const { page, seen } = await open("#5/46/10");
  const zooms = async (action) => [...new Set((await new_tiles_after(page, action)).map(zoom_of))];
  assert.deepEqual(await zooms(() => page.click(".leaflet-control-zoom-in")), [6]);
  await page.mouse.move(640, 400);
  assert.deepEqual(await zooms(() => page.mouse.wheel(0, -120)), [7]);
  await page.focus("#map");
  assert.deepEqual(await zooms(() => page.keyboard.press("+")), [8]);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("an address shows the same place again", async () => {
  const { page, seen } = await open("#6/46.5/9.25");
  await page.focus("#map");
  await new_tiles_after(page, async () => {
    for (let i = 0; i < 4; i++) await page.keyboard.press("ArrowRight");
  });
  const hash = await hash_of(page);
  const tiles = await shown_tiles(page);
  await page.reload();
  await tiles_drawn(page);
  assert.equal(await hash_of(page), hash);
  assert.deepEqual(await shown_tiles(page), tiles);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a layer can be switched off and coloured, and the address keeps it", async () => {
  const { page, seen } = await open("#5/46/10");
  await page.getByLabel("Colour of Land").fill("#ff0000");
  await page.waitForFunction(() => location.hash.includes("land.fill=ff0000"));
  await page.waitForFunction(() => [...document.querySelectorAll("img.leaflet-tile")].every((tile) =>
    tile.src.includes("land.fill=ff0000")));
  await tiles_drawn(page);
  assert.ok((await pixels_of_colour(page, "land", [255, 0, 0])) > 1000);

  await page.getByLabel("Lake", { exact: true }).uncheck();
  await page.waitForFunction(() => !document.querySelector('img[src*="lake"]'));

  await page.reload();
  await tiles_drawn(page);
  const tiles = await shown_tiles(page);
  assert.deepEqual(of_layer(tiles, "lake"), []);
  assert.ok(of_layer(tiles, "land").every((url) => url.includes("fill=ff0000")));
  assert.equal(await page.getByLabel("Lake", { exact: true }).isChecked(), false);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

/** Waits until all tiles are of the layer lake at `zoom`. */
function only_lake_at(page, zoom) {
  // Leaflet keeps tiles of the previous zoom until a moment after the new ones have arrived.
  return page.waitForFunction((part) =>
    [...document.querySelectorAll("img.leaflet-tile")].every((tile) => tile.src.includes(part)),
  `/lake/${zoom}/`);
}

test("typing another address moves the map and switches layers", async () => {
  const { page, seen } = await open("#5/46/10");
  await page.evaluate(() => (location.hash = "#8/45/6&on=lake"));
  await only_lake_at(page, 8);
  await tiles_drawn(page);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("tiles of another zoom go, however late frames come", async () => {
  const { page, seen } = await new_page(browser);
  await page.addInitScript(() => {
    const next_frame = requestAnimationFrame;
    window.requestAnimationFrame = (draw) => setTimeout(() => next_frame(draw), 300);
    window.cancelAnimationFrame = clearTimeout;
  });
  await page.goto(`${server.base}#5/46/10`);
  await tiles_drawn(page);
  await page.evaluate(() => (location.hash = "#8/45/6&on=lake"));
  await only_lake_at(page, 8);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("of addresses typed one upon the other the last one holds", async () => {
  const { page, seen } = await open("#5/46/10");
  await page.evaluate(async () => {
    location.hash = "#8/45/6&on=lake";
    while (!document.querySelector(".leaflet-zoom-anim")) {
      await new Promise((resolve) => setTimeout(resolve));
    }
    location.hash = "#7/47/8&on=lake";
    // Simulates an answer of the server that arrives at this moment.
    history.replaceState(null, "", "#5/46/10");
  });
  await only_lake_at(page, 7);
  await at_rest(page);
  assert.equal(await hash_of(page), "#7/47.000/8.000&on=lake");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("an address typed while the page waits for a style is not lost", async () => {
  let answer_style;
  const is_typed = new Promise((resolve) => (answer_style = resolve));
  const { page, seen } = await new_page(browser);
  await page.route("**/styles/night", async (route) => {
    await is_typed;
    await route.continue();
  });
  await page.goto(`${server.base}#5/46/10&style=night`);
  await page.waitForSelector("#layers .name");
  await page.evaluate(() => (location.hash = "#8/45/6&on=lake"));
  await only_lake_at(page, 8);
  const answered = page.waitForResponse("**/styles/night");
  answer_style();
  await (await answered).finished();
  await at_rest(page);
  await tiles_drawn(page);
  assert.equal(await hash_of(page), "#8/45.0000/6.0000&on=lake");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("another address leaves tiles alone that it does not change", async () => {
  const { page, seen } = await open("#5/46/10&on=land&land.fill=ff0000");
  await page.waitForSelector('img[src*="ff0000"]');
  await tiles_drawn(page);
  await page.evaluate(() => {
    for (const tile of document.querySelectorAll("img.leaflet-tile")) tile.dataset.is_old = "yes";
    location.hash = "#5/46/10&on=land&land.fill=ff0000&lake.fill=00ff00";
  });
  await page.waitForFunction(() => location.hash.includes("lake.fill=00ff00"));
  await page.waitForTimeout(500);
  const is_old = await page.evaluate(() =>
    [...document.querySelectorAll("img.leaflet-tile")].map((tile) => tile.dataset.is_old));
  assert.ok(is_old.length > 0 && is_old.every((mark) => mark === "yes"), String(is_old));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a phone gets dense tiles, a folded panel and controls for fingers", async () => {
  const { page, seen } = await open("#5/46/10", PHONE);
  assert.ok((await shown_tiles(page)).every((url) => url.includes("@2x.png")));
  assert.equal(await page.$eval("img.leaflet-tile", (tile) => tile.naturalWidth), 512);
  assert.equal(await page.locator("#panel-body").isVisible(), false);
  await save_screenshot(page, "phone");
  await page.tap("#panel-toggle");
  assert.equal(await page.locator("#panel-body").isVisible(), true);
  for (const control of ["#panel-toggle", ".leaflet-control-zoom-in", "#layers .name",
    "#layers input[type=color]"]) {
    const { width, height } = await page.locator(control).first().boundingBox();
    assert.ok(width >= 40 && height >= 40, `${control} is ${width} x ${height}`);
  }
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  await save_screenshot(page, "phone-layers");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("tiles meet on whole pixels of screens that have 1.5 or 2.75 for one", async () => {
  for (const deviceScaleFactor of [1.5, 2.75]) {
    const { page, seen } = await new_page(browser, { ...DESKTOP, deviceScaleFactor });
    await page.goto(`${server.base}#4/10.1/20.2`);
    await tiles_drawn(page);
    for (let step = 0; step < 3; ++step) {
      const off = await page.evaluate(() =>
        Math.max(...[...document.querySelectorAll("img.leaflet-tile")].map((tile) => {
          const { left, top } = tile.getBoundingClientRect();
          return Math.max(...[left, top].map((side) => {
            const pixels = side * window.devicePixelRatio;
            return Math.abs(pixels - Math.round(pixels));
          }));
        })));
      assert.ok(off < 0.05, `${deviceScaleFactor}, step ${step}: ${off}`);
      await page.mouse.move(500, 500);
      await page.mouse.down();
      await page.mouse.move(513, 507, { steps: 3 });
      await page.mouse.up();
      await at_rest(page);
      await tiles_drawn(page);
    }
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  }
});

test("nothing that a catalog says becomes markup", async () => {
  const { page, seen } = await new_page(browser);
  const evil = `<img src=x onerror="window.harmed=1"><script>window.harmed=1</script>`;
  await page.route("**/catalog", (route) => route.fulfill({
    json: {
      layers: [{
        name: "land", title: evil, description: evil, bounds: [0, 40, 20, 55], features: evil,
        attribution: `${evil}<a href="javascript:window.harmed=1">one</a> ` +
          `<a href="https://example.org/" onclick="window.harmed=1"><b>two</b></a>`,
      }, { name: 7 }, null, { name: "lake", bounds: "none", style: { fill: "url(x)" } }],
      renderer: evil,
    },
  }));
  await page.goto(server.base);
  await tiles_drawn(page);
  assert.equal(await page.evaluate(() => window.harmed), undefined);
  assert.equal(await page.locator("#panel img").count(), 1, "the icon of the page alone");
  assert.equal(await page.locator("#layers li").count(), 2);
  assert.equal((await page.locator("#layers .name").allInnerTexts())[1], evil);
  const attribution = page.locator(".leaflet-control-attribution");
  assert.equal(await attribution.innerText(), "Leaflet | one two");
  assert.deepEqual(await attribution.locator("a").evaluateAll((links) => links.map((l) => l.href)),
    ["https://leafletjs.com/", "https://example.org/"]);
  assert.equal(await attribution.locator("[onclick], img, b").count(), 0);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a server that is not ready or not there is waited for, in words", async () => {
  const { page, seen } = await new_page(browser);
  const answers = [
    (route) => route.fulfill({ status: 503, headers: { "Retry-After": "1" } }),
    (route) => route.abort(),
    (route) => route.fulfill({ body: "no JSON" }),
    (route) => route.continue(),
  ];
  await page.route("**/catalog", (route) => answers.shift()(route));
  await page.goto(server.base);
  const status = page.locator("#status");
  await status.getByText("still reading its layers").waitFor();
  await status.getByText("cannot be reached").waitFor();
  await status.getByText("cannot be parsed").waitFor();
  await tiles_drawn(page);
  assert.equal(await status.isVisible(), false);
  assert.deepEqual(seen.errors.filter((text) => !FAILED_RESOURCE.test(text)), []);
  await page.context().close();
});

test("a tile that fails is asked for again", async () => {
  const { page, seen } = await new_page(browser);
  let failures = 2;
  await page.route("**/tiles/land,lake/**", (route) =>
    failures-- > 0 ? route.fulfill({ status: 503 }) : route.continue());
  await page.goto(server.base + "#5/46/10");
  await tiles_drawn(page);
  const failed = seen.tiles.filter(({ status }) => status === 503).map(({ url }) => url);
  assert.equal(failed.length, 2);
  for (const url of failed) {
    assert.ok(seen.tiles.some((tile) => tile.url === url && tile.status === 200), url);
  }
  assert.deepEqual(seen.errors.filter((text) => !FAILED_RESOURCE.test(text)), []);
  await page.context().close();
});

test("an address that was gone to is not overwritten before it is shown", async () => {
  const { page, seen } = await open("#5/45/6");
  await page.evaluate(() => {
    window.written = [];
    const replace = history.replaceState.bind(history);
    history.replaceState = (...all) => {
      window.written.push(all[2]);
      replace(...all);
    };
  });
  await page.evaluate(() => (location.hash = "#6/46/7&style=night"));
  await page.waitForFunction(() =>
    document.querySelector("#map").style.background.includes("rgb(16, 32, 48)"));
  await at_rest(page);
  await tiles_drawn(page);
  const written = await page.evaluate(() => window.written);
  assert.deepEqual(written.filter((hash) => !/^#6\/46\.\d+\/7\.\d+&style=night$/.test(hash)), []);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
