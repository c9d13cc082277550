// Accessibility: axe finds no violation in any state of the page, targets are large enough for fingers,
// and the page is small and quickly usable.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import test from "node:test";

import {
  DESKTOP, HERE, PHONE, at_rest, new_page, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const AXE = readFileSync(createRequire(join(HERE, "package.json")).resolve("axe-core/axe.min.js"), "utf8");
const FIELDS = `
[viewer]
start = "4/30/60"

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
group = "Town"
`;
const TARGET = 44; // pixels
const MOST_ON_THE_WIRE = 123_000; // bytes
const TRIES = 5;

const { browser, server } = await start_browser_and_server([], FIELDS);

async function open(hash, options) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen };
}

async function open_panel(page) {
  if (await page.locator("#panel-body").isHidden()) await page.click("#panel-toggle");
}

const STATES = {
  "first sight": { hash: "" },
  "simplify": { hash: "", act: (page) => page.click("#try .choice >> nth=0") },
  "comparison": { hash: "", act: (page) => page.click("#try .choice >> nth=1") },
  "restyle": { hash: "", act: (page) => page.click("#try .choice >> nth=2") },
  "a style unfolded": {
    hash: "#5/46/10&land.color-by=name&land.classes=island:ff8800,*:dddddd&land.stroke=red",
    act: async (page) => {
      await open_panel(page);
      await page.getByLabel("Style of Land").click();
    },
  },
  "ranges": {
    hash: "#5/46/10&land.color-by=people&land.breaks=100,1000&land.ramp=Reds&land.pattern=dots",
    act: async (page) => {
      await open_panel(page);
      await page.getByLabel("Style of Land").click();
    },
  },
  "detail and tiles": {
    hash: "#5/46/10",
    act: async (page) => {
      await open_panel(page);
      await page.click("#detail summary");
      await page.click("#tiles summary");
    },
  },
  "a filter that is wrong": {
    hash: "#5/46/10",
    act: async (page) => {
      await open_panel(page);
      await page.getByLabel("Style of Land").click();
      await page.locator("#layers").getByLabel("Filter").nth(3).fill("nobody = 1");
      await page.keyboard.press("Tab");
      await page.getByRole("alert").waitFor();
    },
  },
  "a feature": {
    hash: "#5/46/10&at=46,10",
    act: (page) => page.locator("#features dl").waitFor(),
  },
  "the legend": {
    hash: "#5/46/10&style=night",
    act: async (page) => {
      if (await page.locator("#legend-body").isHidden()) await page.click("#legend-toggle");
    },
  },
  "the way out": {
    hash: "#5/46/10&lake.fill=ff0000",
    act: async (page) => {
      await open_panel(page);
      await page.click("#share-open");
      await page.locator(".share pre").first().waitFor();
    },
  },
  "links": {
    hash: "#5/46/10",
    act: async (page) => {
      await open_panel(page);
      await page.click("#share-open");
      await page.getByRole("tab", { name: "Links" }).click();
    },
  },
  "the end of detail": { hash: "#8/30/60&on=fields" },
  "all layers off": { hash: "#5/46/10&on=", is_empty: true },
};

/** The violations that axe finds, each with its elements. */
async function violations(page) {
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const { violations } = await window.axe.run(document, { resultTypes: ["violations"] });
    return violations.map(({ id, help, nodes }) =>
      `${id}: ${help}: ${nodes.map(({ html }) => html.slice(0, 160)).join(" | ")}`);
  });
}

/** Visible controls that are too small for a finger. */
function small_targets(page) {
  return page.evaluate((target) => {
    // A link within a sentence is as high as its line; a checkbox counts together with its label.
    const pressed = "button, select, summary, input, a.download, .links a, [role=button]";
    const found = [...document.querySelectorAll(pressed)].filter((control) =>
      control.checkVisibility({ visibilityProperty: true }) && !control.closest("#legend-body"));
    return [...new Set(found.map((control) => control.closest("label") ?? control))].flatMap((control) => {
      const { width, height } = control.getBoundingClientRect();
      return width === 0 || (width >= target - 0.5 && height >= target - 0.5) ? []
        : [`${control.outerHTML.slice(0, 120)}: ${width} x ${height}`];
    });
  }, TARGET);
}

for (const [device, options] of [["desktop", DESKTOP], ["phone", PHONE]]) {
  for (const [name, { hash, act = () => {}, is_empty }] of Object.entries(STATES)) {
    test(`${device}, ${name}: axe finds nothing${device === "phone" ? ", and fingers hit" : ""}`, async () => {
      const { page } = await new_page(browser, options);
      await page.goto(server.base + hash);
      if (is_empty) await page.getByText("All layers are off").waitFor();
      else await tiles_drawn(page);
      await act(page);
      await at_rest(page);
      assert.deepEqual(await violations(page), []);
      if (device === "phone") assert.deepEqual(await small_targets(page), []);
      await page.context().close();
    });
  }
}

test("the legend keeps its colours where the system replaces those of pages", async () => {
  const { page } = await open("#5/46/10", { ...DESKTOP, forcedColors: "active" });
  const inks = page.locator("#legend .swatch .ink");
  await inks.first().waitFor();
  const colours = await inks.evaluateAll((found) =>
    found.map((ink) => getComputedStyle(ink).backgroundColor));
  assert.ok(colours.includes("rgb(216, 201, 155)"), colours.join(" "));
  await page.context().close();
});

test("the page is small on the wire", async () => {
  const { page } = await new_page(browser);
  const sizes = [];
  page.on("requestfinished", (request) => {
    const { pathname } = new URL(request.url());
    if (/(\/|\.js|\.css|\.svg)$/.test(pathname)) sizes.push(request.sizes());
  });
  await page.goto(server.base);
  await tiles_drawn(page);
  const all = (await Promise.all(sizes)).reduce((sum, { responseBodySize, responseHeadersSize }) =>
    sum + responseBodySize + responseHeadersSize, 0);
  assert.ok(sizes.length > 30 && all > 50_000, `${sizes.length} files`);
  assert.ok(all <= MOST_ON_THE_WIRE, `${all} bytes`);
  await page.context().close();
});

test("every module is announced in the page, so that none is found late", async () => {
  const { page, seen } = await open("#5/46/10");
  const announced = await page.locator("link[rel=modulepreload]").evaluateAll((links) =>
    links.map(({ href }) => href));
  const loaded = seen.requests.filter((url) =>
    url.endsWith(".js") && !/\/(viewer|leaflet)\.js$/.test(url));
  assert.deepEqual([...new Set(loaded)].sort(), [...announced].sort());
  assert.equal(loaded.length, announced.length, "each is loaded once");
  await page.context().close();
});

test("the page can be used, and how soon after the server has answered is told", async () => {
  const times = [];
  for (let i = 0; i < TRIES; i++) {
    const { page } = await new_page(browser);
    await page.addInitScript(() => {
      new MutationObserver((_, observer) => {
        if (!document.querySelector("#layers .layer")) return;
        observer.disconnect();
        // After this frame, all pending work is done.
        setTimeout(() => (window.usable_at = performance.now()));
      }).observe(document, { childList: true, subtree: true });
    });
    await page.goto(server.base);
    await tiles_drawn(page);
    times.push(await page.evaluate(() =>
      window.usable_at - performance.getEntriesByType("navigation")[0].responseStart));
    await page.context().close();
  }
  assert.ok(times.every((ms) => ms > 0));
  console.log(`# ${times.map((ms) => Math.round(ms)).join(", ")} ms`);
});
