// Third-party map clients show our tiles, in pages of their own and from another origin than the
// tiles.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { chmodSync, mkdtempSync, rmSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";
import test, { after, before } from "node:test";

import { start_nginx } from "./nginx.mjs";
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
  "/proj4/": join(HERE, "node_modules", "proj4", "dist"),
  "/maplibre-gl/": join(HERE, "node_modules", "maplibre-gl", "dist"),
  "/pmtiles/": join(HERE, "node_modules", "pmtiles", "dist"),
  "/archives/": mkdtempSync(join(tmpdir(), "trapeze-archives-")),
  "/": join(HERE, "clients"),
};
const TYPES = {
  ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".mjs": "text/javascript",
};

const on_the_swiss_grid = (name, fill) => `
[[layer]]
name = "swiss_${name}"
file = "${join(HERE, `${name}.geojson`)}"
crs = ["EPSG:3857", "EPSG:2056"]
style = { fill = "${fill}" }
`;

// WebGL without a GPU.
const { browser, server } = await start_browser_and_server(
  ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  on_the_swiss_grid("land", "#d8c99b") + on_the_swiss_grid("lake", "#4f8fba"),
);
let pages;
let nginx; // undefined where nginx is not installed

before(async () => {
  execFileSync(process.env.TRAPEZE_BINARY, ["seed", "--config", server.config_file,
    "--layers", "land,lake", "--style", "lake.fill=ff0000", "--zooms", "0-6",
    "--output", join(FOLDERS["/archives/"], "world.pmtiles")], { stdio: "pipe" });
  chmodSync(FOLDERS["/archives/"], 0o755);
  nginx = await start_nginx(FOLDERS["/archives/"]);
  pages = createServer(answer);
  await new Promise((resolve) => pages.listen(0, "127.0.0.1", resolve));
});

after(() => {
  pages?.close();
  nginx?.stop();
  rmSync(FOLDERS["/archives/"], { recursive: true });
});

async function answer(request, response) {
  const { pathname } = new URL(request.url, "http://localhost");
  const [prefix, folder] = Object.entries(FOLDERS).find(([start]) => pathname.startsWith(start));
  const file = join(folder, normalize(`/${pathname.slice(prefix.length)}`));
  try {
    const bytes = await readFile(file);
    const range = request.headers.range?.match(/^bytes=(\d+)-(\d+)$/);
    if (range) {
      const [begin, last] = [Number(range[1]), Math.min(Number(range[2]), bytes.length - 1)];
      response.writeHead(206, { "Content-Range": `bytes ${begin}-${last}/${bytes.length}`, ETag: '"one"' });
      response.end(bytes.subarray(begin, last + 1));
      return;
    }
    response.writeHead(200, { "Content-Type": TYPES[extname(file)] ?? "application/octet-stream" });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
}

/** The position of a place in the window, in pixels. */
function on_screen({ lon, lat }) {
  const mercator = (degrees) => Math.asinh(Math.tan((degrees * Math.PI) / 180)) / (2 * Math.PI);
  const world = 256 * 2 ** ZOOM;
  return {
    x: Math.round(SIZE / 2 + ((lon - CENTRE.lon) / 360) * world),
    y: Math.round(SIZE / 2 - (mercator(lat) - mercator(CENTRE.lat)) * world),
  };
}

/** The pixels of PNG files, each drawn at its position on white, as RGBA bytes. */
async function pixels_of_pictures(page, size, pictures) {
  const data_url = await page.evaluate(async ([size, pictures]) => {
    const context = new OffscreenCanvas(size, size).getContext("2d");
    context.fillStyle = "white";
    context.fillRect(0, 0, size, size);
    for (const { base64, x, y } of pictures) {
      const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
      context.drawImage(await createImageBitmap(new Blob([bytes])), x, y);
    }
    // As text: sending millions of numbers over the remote control takes minutes.
    const reader = new FileReader();
    const is_read = new Promise((resolve) => (reader.onload = resolve));
    reader.readAsDataURL(new Blob([context.getImageData(0, 0, size, size).data]));
    await is_read;
    return reader.result;
  }, [size, pictures]);
  return new Uint8Array(Buffer.from(data_url.slice(data_url.indexOf(",") + 1), "base64"));
}

/** The pixels on the screen, as RGBA bytes. */
async function pixels_of_screen(page, scale = 1) {
  const picture = await page.screenshot();
  assert.equal(picture.readUInt32BE(16), SIZE * scale, "width of the picture");
  return pixels_of_pictures(page, SIZE * scale, [{ base64: picture.toString("base64"), x: 0, y: 0 }]);
}

function is_colour(pixels, i, colour) {
  return colour.every((channel, c) => Math.abs(channel - pixels[i + c]) <= TOLERANCE);
}

function assert_colour_at(pixels, place, colour, what) {
  const { x, y } = on_screen(place);
  const i = 4 * (y * SIZE + x);
  assert.ok(is_colour(pixels, i, colour), `${what} at ${x}, ${y} is ${pixels.slice(i, i + 3)}`);
}

/** The share of the window that has this colour. */
function share_of(pixels, colour) {
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) if (is_colour(pixels, i, colour)) count++;
  return count / (SIZE * SIZE);
}

/** Expects the map of tests/browser/{land,lake}.geojson, with the lake in this colour. */
function assert_map(pixels, lake) {
  assert_colour_at(pixels, { lon: 6.5, lat: 45.5 }, lake, "the lake");
  assert_colour_at(pixels, { lon: 15, lat: 46 }, LAND, "the mainland");
  assert_colour_at(pixels, { lon: 10, lat: 51 }, PAPER, "the bay");
  assert_colour_at(pixels, { lon: 0.4, lat: 46 }, LAND, "the island");
  assert_colour_at(pixels, { lon: 3, lat: 41 }, PAPER, "the sea");
  // The lake's area on the screen shows that it is complete and not doubled, shifted or scaled.
  const area = (west, south, east, north) => {
    const a = on_screen({ lon: west, lat: south });
    const b = on_screen({ lon: east, lat: north });
    return ((b.x - a.x) * (a.y - b.y)) / (SIZE * SIZE);
  };
  const lake_area = area(5, 44, 8, 47);
  assert.ok(Math.abs(share_of(pixels, lake) - lake_area) < 0.05 * lake_area, "area of the lake");
}

// Addresses of the tile in the middle of the map.
const XYZ = [/\/tiles\/land,lake\/5\/16\/11\.png\?lake\.fill=ff0000/];
const WMTS = [
  /\/wmts\?(?=.*layer=land&)(?=.*tilematrix=5&)(?=.*tilecol=16(&|$))(?=.*tilerow=11(&|$))/i,
  /\/wmts\/lake\/default\/WebMercatorQuad\/5\/11\/16\.png$/,
];

const WMS = [/\/wms\?(?=.*request=GetMap&)(?=.*layers=land%2Clake&)(?=.*crs=EPSG%3A3857)/i];

const CLIENTS = [
  ["leaflet", "Leaflet, by the pattern of addresses", RED, XYZ],
  ["leaflet_wms", "Leaflet, by WMS", RED, WMS],
  ["openlayers_xyz", "OpenLayers, by the pattern of addresses", RED, XYZ],
  ["openlayers_wmts", "OpenLayers, from WMTS capabilities", LAKE, WMTS],
  ["maplibre", "MapLibre GL JS, from TileJSON", RED, XYZ],
  ["leaflet_pmtiles", "Leaflet, from an archive that was seeded", RED, [/world\.pmtiles$/]],
  ["maplibre_pmtiles", "MapLibre GL JS, from an archive that was seeded", RED, [/world\.pmtiles$/]],
];

for (const [name, words, lake, middle_tiles] of CLIENTS) {
  test(`${words}: the map is drawn, in place and in its colours`, async () => {
    const { page, seen } = await new_page(browser, { viewport: { width: SIZE, height: SIZE } });
    const site = `http://127.0.0.1:${pages.address().port}/`;
    const archives = nginx?.base ?? `${site}archives/`;
    await page.goto(`${site}${name}.html?${new URLSearchParams({ server: server.base, archives })}`);
    await page.waitForFunction(() => window.is_drawn, null, { timeout: 60_000 });
    await save_screenshot(page, `client-${name}`);
    assert_map(await pixels_of_screen(page), lake);
    assert.deepEqual(seen.errors, []);
    assert.ok(seen.answers.length > 0);
    assert.deepEqual(seen.answers.filter(({ status }) => status >= 400), []);
    assert.deepEqual(
      seen.requests.filter((url) => /^https?:/.test(url) && !url.startsWith(site) &&
        !url.startsWith(server.base) && !url.startsWith(archives)), [], "nothing is fetched from elsewhere");
    for (const tile of middle_tiles) {
      assert.ok(seen.answers.some(({ url }) => tile.test(url)), `no ${tile} was asked for`);
    }
    await page.context().close();
  });
}

test("nginx lets pages of any origin read its answer for a tile that a folder lacks", async (context) => {
  if (!nginx) {
    context.skip("nginx is not installed");
    return;
  }
  const answer = await fetch(`${nginx.base}tiles/6/0/0.png`);
  assert.equal(answer.status, 204);
  assert.equal(answer.headers.get("access-control-allow-origin"), "*");
});

for (const [layer, place, colour] of [
  ["land", { lon: 15, lat: 46 }, [0x40, 0x50, 0x60]],
  ["lake", { lon: 3, lat: 41 }, [0x10, 0x20, 0x30]],
]) {
  test(`OpenLayers finds a style of WMTS by its name, for ${layer}`, async () => {
    const { page, seen } = await new_page(browser, { viewport: { width: SIZE, height: SIZE } });
    const query = new URLSearchParams({ server: server.base, layers: layer, style: "night" });
    await page.goto(`http://127.0.0.1:${pages.address().port}/openlayers_wmts.html?${query}`);
    await page.waitForFunction(() => window.is_drawn, null, { timeout: 60_000 });
    await save_screenshot(page, `client-openlayers-style-${layer}`);
    assert_colour_at(await pixels_of_screen(page), place, colour, layer);
    const tiles = seen.answers.filter(({ url }) => /\/wmts[/?]/.test(url));
    assert.ok(tiles.length > 0);
    for (const { url, status } of tiles) {
      assert.match(url, /\/night\/|style=night/i);
      assert.equal(status, 200, url);
    }
    await page.context().close();
  });
}

for (const tiled of ["", "1"]) {
  test(`OpenLayers with proj4 shows a map on the Swiss grid, ${tiled ? "in pieces" : "in one picture"}`, async () => {
    const { page, seen } = await new_page(browser, { viewport: { width: SIZE, height: SIZE } });
    const query = new URLSearchParams({ server: server.base, tiled });
    await page.goto(`http://127.0.0.1:${pages.address().port}/openlayers_lv95.html?${query}`);
    await page.waitForFunction(() => window.is_drawn, null, { timeout: 60_000 });
    await save_screenshot(page, `client-openlayers-lv95${tiled ? "-in-pieces" : ""}`);
    const shown = await pixels_of_screen(page);
    for (const [lonlat, colour] of [
      [[6.5, 46], RED], [[7.9, 46.9], RED], [[8.1, 46.9], LAND], [[7.9, 47.1], LAND],
      [[10, 48.2], PAPER], [[9.5, 48.2], LAND], [[10.5, 48.2], LAND],
    ]) {
      const [x, y] = await page.evaluate((place) => window.pixel_of(place), lonlat);
      const i = 4 * (y * SIZE + x);
      assert.ok(is_colour(shown, i, colour), `${lonlat} at ${x}, ${y} is ${shown.slice(i, i + 3)}`);
    }
    const answer = await fetch(`${server.base}map/swiss_land,swiss_lake.png?crs=EPSG:2056` +
      `&bbox=2404000,929000,2916000,1441000&width=${SIZE}&height=${SIZE}&swiss_lake.fill=ff0000`);
    assert.equal(answer.status, 200);
    const base64 = Buffer.from(await answer.arrayBuffer()).toString("base64");
    const expected = await pixels_of_pictures(page, SIZE, [{ base64, x: 0, y: 0 }]);
    let differing = 0;
    for (let i = 0; i < expected.length; i += 4) {
      if (!is_colour(shown, i, expected.slice(i, i + 3))) differing++;
    }
    // With pieces, the colours along their borders may be reduced differently in each piece.
    assert.ok(differing <= 0.0005 * SIZE * SIZE, `${differing} pixels differ`);
    assert.ok(seen.answers.some(({ url }) => /crs=EPSG%3A2056/i.test(url)));
    assert.deepEqual(seen.answers.filter(({ status }) => status >= 400), []);
    assert.deepEqual(seen.errors, []);
    await page.context().close();
  });
}

// The corner of four tiles of zoom 5, so that pixels of the tiles match pixels of the screen.
const CORNER = { column: 17, row: 11 };
const CORNER_PLACE = [
  (CORNER.column / 2 ** ZOOM) * 360 - 180,
  (Math.atan(Math.sinh(Math.PI * (1 - (2 * CORNER.row) / 2 ** ZOOM))) * 180) / Math.PI,
];

for (const [scale, suffix] of [[1, ""], [2, "@2x"]]) {
  test(`MapLibre draws the tiles of a TileJSON${suffix} pixel by pixel where a pixel of CSS has ${scale}`, async () => {
    const viewport = { width: SIZE, height: SIZE };
    const { page, seen } = await new_page(browser, { viewport, deviceScaleFactor: scale });
    const style = "style=night&lake.fill=ff0000";
    const query = new URLSearchParams({
      server: server.base, center: CORNER_PLACE.join(","), tilejson: `tiles/land,lake${suffix}.json?${style}`,
    });
    await page.goto(`http://127.0.0.1:${pages.address().port}/maplibre.html?${query}`);
    await page.waitForFunction(() => window.is_drawn, null, { timeout: 60_000 });
    await save_screenshot(page, `client-maplibre${suffix}-pixels`);
    const tiles = [];
    for (const [dx, dy] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
      const tile = `5/${CORNER.column - 1 + dx}/${CORNER.row - 1 + dy}`;
      const url = `${server.base}tiles/land,lake/s/night/${tile}${suffix}.png?lake.fill=ff0000ff`;
      assert.ok(seen.answers.some((answer) => answer.url === url), `${url} was not asked for`);
      const answer = await fetch(url);
      const base64 = Buffer.from(await answer.arrayBuffer()).toString("base64");
      tiles.push({ base64, x: dx * 256 * scale, y: dy * 256 * scale });
    }
    const expected = await pixels_of_pictures(page, SIZE * scale, tiles);
    const shown = await pixels_of_screen(page, scale);
    let differing = 0;
    for (let i = 0; i < expected.length; i += 4) {
      if (!is_colour(shown, i, expected.slice(i, i + 3))) differing++;
    }
    assert.ok(differing <= 0.0005 * expected.length / 4, `${differing} pixels differ`);
    assert.deepEqual(seen.answers.filter(({ status }) => status >= 400), []);
    await page.context().close();
  });
}
