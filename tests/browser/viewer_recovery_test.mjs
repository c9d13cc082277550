// Failures are reported in a status line and recover automatically: the server stops and starts
// again, reloads its layers, is overloaded, or refuses to draw.
import assert from "node:assert/strict";
import test from "node:test";

import {
  DESKTOP, PHONE, at_rest, new_page, of_layer, save_screenshot, shown_tiles, start_browser_and_server,
  tiles_drawn,
} from "./served_viewer.mjs";

const FAILED_RESOURCE = /^Failed to load resource/; // Chromium's message for every answer that is not 2xx

const { browser, server } = await start_browser_and_server();

/** Does not wait for the tiles: a message may come and go before they are drawn. */
async function begin(hash, options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  return { page, seen, status: page.locator("#status") };
}

async function open(hash, options = undefined) {
  const opened = await begin(hash, options);
  await tiles_drawn(opened.page);
  return opened;
}

function pan(page) {
  return page.evaluate(() => (location.hash = "#7/46.5/12"));
}

/** Records every "in N s" in the status line from now on, and makes pauses as short as possible. */
function keep_what_is_told(page) {
  return page.evaluate(() => {
    Math.random = () => 0;
    window.told_seconds = [];
    const status = document.querySelector("#status");
    new MutationObserver(() => {
      const seconds = Number(/in (\d+) s/.exec(status.textContent)?.[1]);
      if (seconds && window.told_seconds.at(-1) !== seconds) window.told_seconds.push(seconds);
    }).observe(status, { childList: true, characterData: true, subtree: true });
  });
}

function told_seconds(page) {
  return page.evaluate(() => window.told_seconds);
}

/** Waits until the status line has shown a pause of this many seconds. */
function pause_begins(page, seconds) {
  return page.waitForFunction((wanted) => window.told_seconds.includes(wanted), seconds, { polling: 50 });
}

/** [1, 2, 1, 4, 3, ...]: seconds count down, and a higher number starts a new pause. */
function first_of_each_pause(seconds) {
  return seconds.filter((one, i) => i === 0 || one > seconds[i - 1]);
}

for (const [device, options] of [["desktop", DESKTOP], ["phone", PHONE]]) {
  test(`${device}: a server that stops is told at once; back again, every tile comes by itself`,
    async () => {
      const { page, seen, status } = await open("#7/45.5/6.5", options);
      await server.stop();
      await pan(page);
      await status.getByText("The server cannot be reached.").waitFor();
      await status.getByText(/Trying again in \d+ s\./).waitFor();
      await save_screenshot(page, `${device}-server-stopped`);
      const place = await page.evaluate(() => location.hash);
      await server.start();
      await tiles_drawn(page);
      await status.waitFor({ state: "hidden" });
      assert.equal(await page.evaluate(() => location.hash), place, "the map was not moved");
      assert.deepEqual(seen.errors.filter((text) => !FAILED_RESOURCE.test(text)), []);
      await page.context().close();
    });
}

test("pauses grow while the server is away, and end at once by hand, or when the network is back",
  async () => {
    const { page, seen, status } = await open("#7/45.5/6.5");
    await keep_what_is_told(page);
    await server.stop();
    try {
      await pan(page);
      await pause_begins(page, 4);
      const before = seen.requests.length;
      await pause_begins(page, 8);
      // One request a pause, regardless of the number of missing tiles.
      assert.deepEqual(seen.requests.slice(before).map((url) => new URL(url).pathname), ["/ready"]);
      assert.deepEqual(first_of_each_pause(await told_seconds(page)), [1, 2, 4, 8]);
      await status.getByRole("button", { name: "Try now" }).click();
      await pause_begins(page, 16);
      await page.evaluate(() => window.dispatchEvent(new Event("online")));
      await pause_begins(page, 30);
      const told = await told_seconds(page);
      assert.deepEqual(first_of_each_pause(told), [1, 2, 4, 8, 16, 30]);
      for (const begun of [16, 30]) {
        assert.ok(told[told.indexOf(begun) - 1] > 1, `the pause before ended by itself: ${told}`);
      }
    } finally {
      await server.start();
    }
    await status.getByRole("button", { name: "Try now" }).click();
    await tiles_drawn(page);
    await status.waitFor({ state: "hidden" });
    await page.context().close();
  });

test("whoever zooms while the server is away still sees the map, and then a sharp one", async () => {
  const { page, status } = await open("#7/45.5/6.5");
  await server.stop();
  try {
    await page.click(".leaflet-control-zoom-in");
    await status.getByText("The server cannot be reached.").waitFor();
    await at_rest(page);
    const old = await page.evaluate(() => [...document.querySelectorAll("img.leaflet-tile-loaded")]
      .filter(({ src, naturalWidth }) => src.includes("/7/") && naturalWidth > 0).length);
    assert.ok(old > 0, `${old} tiles of the zoom before`);
    await save_screenshot(page, "desktop-zoomed-while-away");
  } finally {
    await server.start();
  }
  await tiles_drawn(page);
  await page.waitForFunction(() =>
    [...document.querySelectorAll("img.leaflet-tile")].every(({ src }) => src.includes("/8/")));
  await status.waitFor({ state: "hidden" });
  await page.context().close();
});

test("a server that comes back with other layers says so, and the page can be loaded again", async () => {
  const { page, status } = await open("#7/45.5/6.5");
  await server.stop();
  try {
    await pan(page);
    await status.getByText("The server cannot be reached.").waitFor();
    await page.route("**/catalog", (route) => route.fulfill({ json: { layers: [{ name: "lake" }] } }));
  } finally {
    await server.start();
  }
  const again = status.getByRole("button", { name: "Reload the page" });
  await again.waitFor();
  await save_screenshot(page, "desktop-other-layers");
  await again.click();
  await page.waitForFunction(() => document.querySelectorAll("#layers > li").length === 1);
  await page.context().close();
});

test("a style that changes while the server is away is drawn when it is back", async () => {
  const { page, status } = await open("#5/46/10");
  await server.stop();
  try {
    await page.evaluate(() => (location.hash = "#5/46/10&lake.fill=ff0000"));
    await status.getByText("The server cannot be reached.").waitFor();
  } finally {
    await server.start();
  }
  await page.waitForFunction(() => {
    const tiles = [...document.querySelectorAll("img.leaflet-tile")];
    return tiles.length && tiles.every(({ src, naturalWidth }) =>
      src.includes("lake.fill=ff0000") && naturalWidth > 0);
  }, null, { timeout: 30_000 });
  await status.waitFor({ state: "hidden" });
  await page.context().close();
});

test("a named style chosen while the server is away is known when it is back, with its legend", async () => {
  const { page, status } = await open("#5/46/10");
  await server.stop();
  try {
    await page.locator("#style").selectOption("night");
    await status.getByText("The server cannot be reached.").waitFor();
  } finally {
    await server.start();
  }
  await page.waitForFunction(() =>
    document.querySelector("#map").style.background.includes("rgb(16, 32, 48)") &&
    document.querySelector("#legend-body .swatch"), null, { timeout: 30_000 });
  await status.waitFor({ state: "hidden" });
  await page.context().close();
});

for (const [device, options] of [["desktop", DESKTOP], ["phone", PHONE]]) {
  test(`${device}: while layers are read the page says which and how far, and starts by itself`,
    async () => {
      const { page } = await new_page(browser, options);
      const told = [
        [{ name: "land", percent: 41.7 }, { name: "lake", percent: 0 }],
        [{ name: "land", percent: 100 }, { name: "lake", percent: 63 }],
      ];
      let is_ready = false;
      await page.route("**/catalog", (route) =>
        (is_ready ? route.continue() : route.fulfill({ status: 503, headers: { "Retry-After": "1" } })));
      await page.route("**/ready", (route) => {
        const layers = told.length > 1 ? told.shift() : told[0];
        return is_ready ? route.continue()
          : route.fulfill({ status: 503, json: { status: "loading", layers } });
      });
      await page.goto(server.base);
      const status = page.locator("#status");
      await status.getByText("The server is still reading its layers.").waitFor();
      await status.getByText("land 41 %, lake 0 %").waitFor({ state: "attached" });
      assert.deepEqual(await status.locator(".bar").allInnerTexts(), ["land\n41 %", "lake\n0 %"]);
      await save_screenshot(page, `${device}-loading`);
      await status.getByText("lake 63 %").waitFor({ state: "attached" });
      assert.deepEqual(await status.locator(".bar").allInnerTexts(), ["lake\n63 %"]);
      is_ready = true;
      await tiles_drawn(page);
      await status.waitFor({ state: "hidden" });
      await page.context().close();
    });
}

test("of many layers that are read six are shown, and how many more there are", async () => {
  const { page } = await new_page(browser);
  const layers = Array.from({ length: 30 }, (_, i) => ({ name: `layer ${i + 1}`, percent: i === 0 ? 100 : i }));
  await page.route("**/catalog", (route) => route.fulfill({ status: 503, headers: { "Retry-After": "1" } }));
  await page.route("**/ready", (route) => route.fulfill({ status: 503, json: { status: "loading", layers } }));
  await page.goto(server.base);
  const bars = page.locator("#status .bars");
  await bars.getByText("and 23 more").waitFor();
  assert.equal(await bars.locator(".bar").count(), 6);
  await page.context().close();
});

test("tiles refused for a while (429) are told and come later, not sooner than was asked", async () => {
  const { page, seen, status } = await open("#5/46/10");
  let is_refusing = true;
  await page.route("**/tiles/**", (route) => (is_refusing
    ? route.fulfill({ status: 429, headers: { "Retry-After": "2" }, json: { detail: "Try again." } })
    : route.continue()));
  await pan(page);
  await status.getByText("Too many requests for the server.").waitFor();
  await save_screenshot(page, "desktop-429");
  is_refusing = false;
  await tiles_drawn(page);
  await status.waitFor({ state: "hidden" });
  assert.deepEqual(seen.errors.filter((text) => !FAILED_RESOURCE.test(text)), []);
  await page.context().close();
});

const TOO_DEAR = { detail: "This picture would take more than 5 units of drawing, the limit here." };

test("tiles too dear for all layers at once are drawn layer by layer", async () => {
  const { page } = await new_page(browser);
  await page.route("**/tiles/land,lake/**", (route) =>
    route.fulfill({ status: 400, json: TOO_DEAR }));
  await page.goto(`${server.base}#5/46/10&style=night`);
  await page.waitForFunction(() => document.querySelector('img[src*="/tiles/lake/"]'));
  await tiles_drawn(page);
  const tiles = await shown_tiles(page);
  assert.equal(of_layer(tiles, "land").length, of_layer(tiles, "lake").length);
  assert.ok(of_layer(tiles, "lake").every((url) => url.includes("background=0000")));
  assert.ok(of_layer(tiles, "land").every((url) => !url.includes("background")));
  assert.equal(await page.locator("#status").isVisible(), false);
  await page.context().close();
});

test("a tile too dear by itself is told in a line until it is out of sight, and not asked for again",
  async () => {
    const { page, seen } = await new_page(browser);
    await page.route("**/tiles/**/5/**", (route) => route.fulfill({ status: 400, json: TOO_DEAR }));
    await page.goto(`${server.base}#5/46/10&on=land`);
    const status = page.locator("#status");
    await status.getByText("There is too much to draw here. Zoom in, or simplify more.").waitFor();
    await save_screenshot(page, "desktop-too-dear");
    await page.waitForTimeout(3000); // time enough to send another request
    const tiles = seen.requests.filter((url) => url.includes("/5/"));
    const most = Math.max(...tiles.map((url) => tiles.filter((other) => other === url).length));
    assert.ok(most <= 2, `${most} times: as a picture, and to learn the reason`);
    await page.evaluate(() => (location.hash = "#7/46/10&on=land"));
    await tiles_drawn(page);
    await status.waitFor({ state: "hidden" });
    await page.context().close();
  });

test("all layers off, and layers that are not there, are said in a line", async () => {
  const { page, status } = await begin("#5/46/10&on=lake,nowhere");
  await status.getByText('There is no layer "nowhere" here.').waitFor();
  await save_screenshot(page, "desktop-unknown-layer");
  await page.evaluate(() => (location.hash = "#5/46/10&on="));
  await status.getByText("All layers are off. Turn one on in the list.").waitFor();
  await save_screenshot(page, "desktop-all-off");
  await page.evaluate(() => (location.hash = "#5/46/10"));
  await tiles_drawn(page);
  await status.waitFor({ state: "hidden" });
  await page.context().close();
});

test("a wrong filter in the address is told on a phone, whose panel is folded", async () => {
  const { page, status } = await begin("#5/46/10&land.filter=nobody%20%3D%201", PHONE);
  await status.getByText("Land:").waitFor();
  await save_screenshot(page, "phone-wrong-filter");
  await tiles_drawn(page);
  assert.ok((await shown_tiles(page)).every((url) => !url.includes("filter")));
  await page.context().close();
});

test("a line at the top shows that tiles are on their way, and goes when they are there", async () => {
  const { page } = await new_page(browser);
  let let_go;
  const held = new Promise((resolve) => (let_go = resolve));
  let count = 0;
  await page.route("**/tiles/**", async (route) => {
    if (count++ > 3) await held;
    await route.continue();
  });
  await page.goto(`${server.base}#5/46/10`);
  await page.locator(".progress.shown").waitFor();
  await page.waitForFunction(() => { // it moves smoothly
    const { width } = document.querySelector(".progress").getBoundingClientRect();
    return width > 100 && width < 1200;
  });
  await save_screenshot(page, "desktop-progress");
  // Pending tiles are no longer needed, and the viewer does not wait for them.
  await page.click(".leaflet-control-zoom-in");
  await at_rest(page);
  let_go();
  await tiles_drawn(page);
  await page.waitForFunction(() => !document.querySelector(".progress.shown"));
  await page.context().close();
});

test("one request a tile draws all layers that are on, dense where the screen is", async () => {
  const { page, seen } = await open("#5/46/10", PHONE);
  const tiles = seen.requests.filter((url) => url.includes("/tiles/"));
  assert.ok(tiles.length > 0);
  assert.ok(tiles.every((url) => /\/tiles\/land,lake\/5\/\d+\/\d+@2x\.png$/.test(url)), tiles.join(" "));
  assert.equal(new Set(tiles).size, tiles.length);
  await page.context().close();
});
