// The README's snippets for map clients, pasted word for word into a page each, show the map.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import test, { after, before } from "node:test";

import { HERE, WEB, new_page, save_screenshot, start_browser_and_server } from "./served_viewer.mjs";

const SIZE = 512;
const TEAL = [0, 128, 128];
const TOLERANCE = 2; // of 255: WebGL multiplies by opacity and divides again
const README = join(HERE, "..", "..", "README.md");
const FOLDERS = {
  "/leaflet/": join(WEB, "node_modules", "leaflet", "dist"),
  "/ol/": join(HERE, "node_modules", "ol"),
  "/maplibre-gl/": join(HERE, "node_modules", "maplibre-gl", "dist"),
  "/clients/": join(HERE, "clients"),
};
const TYPES = { ".css": "text/css", ".js": "text/javascript", ".mjs": "text/javascript" };

/** A page before the snippet is pasted into it: a map with only the mainland. */
const PAGES = {
  Leaflet: `
    <link rel="stylesheet" href="/leaflet/leaflet.css">
    <script src="/leaflet/leaflet.js"></script>
    <script type="module">
      const map = L.map("map", { fadeAnimation: false }).setView([46, 10], 5);
      SNIPPET
    </script>`,
  OpenLayers: `
    <link rel="stylesheet" href="/ol/ol.css">
    <script src="/ol/dist/ol.js"></script>
    <script type="module">
      const map = new ol.Map({
        target: "map",
        view: new ol.View({ center: ol.proj.fromLonLat([10, 46]), zoom: 5 }),
      });
      SNIPPET
    </script>`,
  MapLibre: `
    <link rel="stylesheet" href="/maplibre-gl/maplibre-gl.css">
    <script type="module">
      import * as maplibregl from "/maplibre-gl/maplibre-gl.mjs";
      const map = new maplibregl.Map({
        container: "map", fadeDuration: 0, center: [10, 46], zoom: 4,
        style: { version: 8, sources: {}, layers: [] },
      });
      map.on("load", () => {
        SNIPPET
      });
    </script>`,
};

// WebGL without a GPU.
const { browser, server } = await start_browser_and_server(
  ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
);
const readme = await readFile(README, "utf8");
let pages;

before(async () => {
  pages = createServer(answer);
  await new Promise((resolve) => pages.listen(0, "127.0.0.1", resolve));
});

after(() => pages?.close());

async function answer(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  const client = pathname.slice(1);
  if (client in PAGES) {
    response.writeHead(200, { "Content-Type": "text/html; charset=utf-8" });
    return response.end(page_with(client));
  }
  const found = Object.entries(FOLDERS).find(([start]) => pathname.startsWith(start));
  if (!found) return response.writeHead(404).end();
  const [prefix, folder] = found;
  const file = join(folder, normalize(`/${pathname.slice(prefix.length)}`));
  try {
    const bytes = await readFile(file);
    response.writeHead(200, { "Content-Type": TYPES[extname(file)] ?? "application/octet-stream" });
    return response.end(bytes);
  } catch {
    return response.writeHead(404).end();
  }
}

/** The block of JavaScript after the line "CLIENT:", with the address and the layer of this server. */
function snippet_of(client) {
  const found = readme.match(new RegExp(`^${client}:\\n\\n\`\`\`js\\n([^]*?)\`\`\`$`, "m"));
  assert.ok(found, `the README has no snippet for ${client}`);
  return found[1].replaceAll("http://localhost:8080/", server.base).replaceAll("countries", "land");
}

function page_with(client) {
  return `<!doctype html><html lang="en"><head><meta charset="utf-8"><title>${client}</title>
    <link rel="icon" href="data:,"><link rel="stylesheet" href="/clients/client.css"></head>
    <body><div id="map"></div>${PAGES[client].replace("SNIPPET", () => snippet_of(client))}</body></html>`;
}

/** Red, green and blue of the pixel in the middle of the screen, which the mainland covers. */
async function middle_of_screen(page) {
  const picture = (await page.screenshot()).toString("base64");
  return page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(bitmap.width / 2, bitmap.height / 2, 1, 1).data].slice(0, 3);
  }, picture);
}

for (const client of Object.keys(PAGES)) {
  test(`The snippet of the README for ${client} shows the map`, async () => {
    const viewport = { width: SIZE, height: SIZE };
    const { page, seen } = await new_page(browser, { viewport, deviceScaleFactor: 2 });
    await page.goto(`http://127.0.0.1:${pages.address().port}/${client}`);
    const is_teal = (colour) => colour.every((value, i) => Math.abs(value - TEAL[i]) <= TOLERANCE);
    let colour = await middle_of_screen(page);
    for (const end = Date.now() + 60_000; !is_teal(colour) && Date.now() < end;) {
      await page.waitForTimeout(100);
      colour = await middle_of_screen(page);
    }
    await save_screenshot(page, `readme-${client}`);
    assert.ok(is_teal(colour), `${colour} in the middle of the map`);
    assert.ok(seen.answers.some(({ url }) => /\/5\/16\/11@2x\.png\?fill=/.test(url)),
      "tiles for a screen of two pixels for each of the page");
    assert.deepEqual(seen.answers.filter(({ status }) => status >= 400), []);
    assert.deepEqual(seen.errors, []);
    await page.context().close();
  });
}
