// Other people's map clients show our tiles: pages of their own, from another origin than the tiles.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import test, { after, before } from "node:test";

import {
  HERE, WEB, new_page, save_screenshot, start_browser_and_server,
} from "./served_viewer.mjs";

const SIZE = 512;
const ZOOM = 5;
const CENTRE = { lon: 10, lat: 46 };
const LAND = [0xd8, 0xc9, 0x9b];
const LAKE = [0x4f, 0x8f, 0xba];
const RED = [255, 0, 0];
const PAPER = [255, 255, 255];
const TOLERANCE = 2; // of 255: WebGL multiplies by opacity and divides again

const FOLDERS = {
  "/leaflet/": join(WEB, "node_modules", "leaflet", "dist"),
  "/ol/": join(HERE, "node_modules", "ol"),
  "/maplibre-gl/": join(HERE, "node_modules", "maplibre-gl", "dist"),
  "/": join(HERE, "clients"),
};
const TYPES = {
  ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".mjs": "text/javascript",
};

// WebGL without a GPU.
const { browser, server } = await start_browser_and_server(
  ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
);
let pages;

before(async () => {
  pages = createServer(answer);
  await new Promise((resolve) => pages.listen(0, "127.0.0.1", resolve));
});

after(() => pages?.close());

async function answer(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  const [prefix, folder] = Object.entries(FOLDERS).find(([start]) => pathname.startsWith(start));
  const file = join(folder, normalize(`/${pathname.slice(prefix.length)}`));
  try {
    const bytes = await readFile(file);
    response.writeHead(200, { "Content-Type": TYPES[extname(file)] ?? "application/octet-stream" });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}

/** Where a place lies in the window, in pixels. */
function on_screen({ lon, lat }) {
  const mercator = (degrees) => Math.asinh(Math.tan((degrees * Math.PI) / 180)) / (2 * Math.PI);
  const world = 256 * 2 ** ZOOM;
  return {
    x: Math.round(SIZE / 2 + ((lon - CENTRE.lon) / 360) * world),
    y: Math.round(SIZE / 2 - (mercator(lat) - mercator(CENTRE.lat)) * world),
  };
}

/** What stands on the screen, as the bytes of RGBA. */
async function pixels_of_screen(page) {
  const picture = await page.screenshot();
  const pixels = await page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(0, 0, bitmap.width, bitmap.height).data];
  }, picture.toString("base64"));
  assert.equal(pixels.length, 4 * SIZE * SIZE);
  return pixels;
}

function is_colour(pixels, i, colour) {
  return colour.every((channel, c) => Math.abs(channel - pixels[i + c]) <= TOLERANCE);
}

function assert_colour_at(pixels, place, colour, what) {
  const { x, y } = on_screen(place);
  const i = 4 * (y * SIZE + x);
  assert.ok(is_colour(pixels, i, colour), `${what} at ${x}, ${y} is ${pixels.slice(i, i + 3)}`);
}

/** The share of the window that has a colour. */
function share_of(pixels, colour) {
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) if (is_colour(pixels, i, colour)) count++;
  return count / (SIZE * SIZE);
}

/** The map of tests/browser/{land,lake}.geojson, with the lake in this colour. */
function assert_map(pixels, lake) {
  assert_colour_at(pixels, { lon: 6.5, lat: 45.5 }, lake, "the lake");
  assert_colour_at(pixels, { lon: 15, lat: 46 }, LAND, "the mainland");
  assert_colour_at(pixels, { lon: 10, lat: 51 }, PAPER, "the bay");
  assert_colour_at(pixels, { lon: 0.4, lat: 46 }, LAND, "the island");
  assert_colour_at(pixels, { lon: 3, lat: 41 }, PAPER, "the sea");
  // All of it, and not doubled, shifted or scaled: its area on the screen.
  const area = (west, south, east, north) => {
    const a = on_screen({ lon: west, lat: south });
    const b = on_screen({ lon: east, lat: north });
    return ((b.x - a.x) * (a.y - b.y)) / (SIZE * SIZE);
  };
  const lake_area = area(5, 44, 8, 47);
  assert.ok(Math.abs(share_of(pixels, lake) - lake_area) < 0.05 * lake_area, "area of the lake");
}

// Addresses of the tile that holds the middle of the map.
const XYZ = [/\/tiles\/land,lake\/5\/16\/11\.png\?lake\.fill=ff0000/];
const WMTS = [
  /\/wmts\?(?=.*layer=land&)(?=.*tilematrix=5&)(?=.*tilecol=16(&|$))(?=.*tilerow=11(&|$))/i,
  /\/tiles\/lake\/s\/default\/5\/16\/11\.png$/,
];

const CLIENTS = [
  ["leaflet", "Leaflet, by the pattern of addresses", RED, XYZ],
  ["openlayers_xyz", "OpenLayers, by the pattern of addresses", RED, XYZ],
  ["openlayers_wmts", "OpenLayers, from WMTS capabilities", LAKE, WMTS],
  ["maplibre", "MapLibre GL JS, from TileJSON", RED, XYZ],
];

for (const [name, words, lake, middle_tiles] of CLIENTS) {
  test(`${words}: the map is drawn, in place and in its colours`, async () => {
    const { page, seen } = await new_page(browser, { viewport: { width: SIZE, height: SIZE } });
    const site = `http://127.0.0.1:${pages.address().port}/`;
    await page.goto(`${site}${name}.html?server=${encodeURIComponent(server.base)}`);
    await page.waitForFunction(() => window.is_drawn, null, { timeout: 60_000 });
    await save_screenshot(page, `client-${name}`);
    assert_map(await pixels_of_screen(page), lake);
    assert.deepEqual(seen.errors, []);
    assert.ok(seen.answers.length > 0);
    assert.deepEqual(seen.answers.filter(({ status }) => status >= 400), []);
    assert.deepEqual(
      seen.requests.filter((url) => /^https?:/.test(url) && !url.startsWith(site) &&
        !url.startsWith(server.base)), [], "nothing is fetched from elsewhere");
    for (const tile of middle_tiles) {
      assert.ok(seen.answers.some(({ url }) => tile.test(url)), `no ${tile} was asked for`);
    }
    await page.context().close();
  });
}
