// The output of "Use this map" works elsewhere: pages pasted into a file, commands, addresses.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join } from "node:path";
import test, { after, before } from "node:test";

import {
  HERE, PHONE, WEB, assert_nothing_went_wrong, new_page, save_screenshot, start_browser_and_server,
  tiles_drawn,
} from "./served_viewer.mjs";

const MODULES = join(HERE, "node_modules");
const SIZE = 512;
const LAND = [0xd8, 0xc9, 0x9b];
const RED = [255, 0, 0];
const NIGHT = [0x40, 0x50, 0x60];
const DENSE = { viewport: { width: SIZE, height: SIZE }, deviceScaleFactor: 2 };
const TYPES = { ".css": "text/css", ".js": "text/javascript", ".mjs": "text/javascript" };

// WebGL without a GPU.
const { browser, server } = await start_browser_and_server(
  ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
);
const pages = createServer((request, response) => {
  response.writeHead(200, { "Content-Type": "text/html" }).end(pasted);
});
let pasted = "";

before(() => new Promise((resolve) => pages.listen(0, "127.0.0.1", resolve)));
after(() => pages.close());

/** Opens the viewer with the panel unfolded. */
async function open(hash, options = undefined) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  if (await page.locator("#share-open").isHidden()) await page.click("#panel-toggle");
  await page.click("#share-open");
  await page.getByRole("dialog", { name: "Use this map" }).waitFor();
  await page.locator(".share pre, .share .links").first().waitFor();
  return { page, seen };
}

async function snippet(page, tab, index = 0) {
  await page.getByRole("tab", { name: tab, exact: true }).click();
  return page.locator(".share code").nth(index).innerText();
}

async function links(page) {
  await page.getByRole("tab", { name: "Links" }).click();
  return Object.fromEntries(await page.locator(".links a").evaluateAll((all) =>
    all.map((link) => [link.textContent, link.href])));
}

/** Loads the scripts of a client from its package, not from the network. */
async function route_packages(page) {
  await page.route("https://unpkg.com/**", async (route) => {
    const [, name, version, path] =
      /^https:\/\/unpkg\.com\/([^@]+)@([^/]+)\/([^?]*)/.exec(route.request().url());
    const folder = name === "leaflet" ? join(WEB, "node_modules", name) : join(MODULES, name);
    const { version: installed } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    assert.equal(version, installed, `the version of ${name} is the one that is tried here`);
    await route.fulfill({
      body: readFileSync(join(folder, path)),
      contentType: TYPES[extname(path)] ?? "application/octet-stream",
      headers: { "Access-Control-Allow-Origin": "*" },
    });
  });
}

/** The share of a picture that has this colour. */
async function share_of(page, picture, colour) {
  return page.evaluate(async ([base64, colour]) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes]));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (colour.every((channel, c) => Math.abs(channel - data[i + c]) <= 2)) count++;
    }
    return count / (bitmap.width * bitmap.height);
  }, [picture.toString("base64"), colour]);
}

const CLIENTS = ["Leaflet", "OpenLayers", "MapLibre"];

for (const client of CLIENTS) {
  test(`the page for ${client} shows the map, dense, in its style, with its attribution`, async () => {
    const { page: viewer } = await open("#5/46/10&lake.fill=ff0000&simplify=2");
    pasted = await snippet(viewer, client);
    assert.match(pasted, /\?style=[0-9a-f]{40}"/);
    await viewer.context().close();

    const { page, seen } = await new_page(browser, DENSE);
    await route_packages(page);
    await page.goto(`http://127.0.0.1:${pages.address().port}/`);
    let shares = {};
    for (const end = Date.now() + 60_000; !(shares.lake > 0.01) && Date.now() < end;) {
      await page.waitForTimeout(200);
      const picture = await page.screenshot();
      shares = {
        land: await share_of(page, picture, LAND), lake: await share_of(page, picture, RED),
      };
    }
    await save_screenshot(page, `share-${client.toLowerCase()}`);
    // At zoom 5 and 512 pixels, as on the viewer's screen: 3 by 3 degrees of lake.
    const lake = (3 / 360) * 2 ** 5 * 256 / SIZE;
    assert.ok(Math.abs(shares.lake - lake * lake * 1.43) < 0.008, `the lake fills ${shares.lake}`);
    assert.ok(shares.land > 0.1, `the land fills ${shares.land}`);
    assert.deepEqual(seen.errors, []);
    assert.ok(seen.tiles.length > 0);
    for (const { url, status } of seen.tiles) {
      assert.equal(status, 200, url);
      assert.match(url, /\/tiles\/land,lake\/5\/\d+\/\d+@2x\.png\?style=/);
    }
    assert.match(await page.locator("body").innerText(), /Drawn by hand/);
    await page.context().close();
  });
}

test("a named style goes by its name, the usual one without", async () => {
  const { page, seen } = await open("#5/46/10&style=night");
  assert.match(await snippet(page, "Leaflet"), /land,lake\/\{z\}\/\{x\}\/\{y\}\{r\}\.png\?style=night"/);
  assert.equal(await page.locator(".share footer").isVisible(), false);
  assert.match((await links(page)).TileJSON, /\/tiles\/land,lake\.json\?style=night$/);
  await page.keyboard.press("Escape");
  await page.evaluate(() => (location.hash = "#5/46/10"));
  await page.waitForFunction(() => !document.querySelector("img.leaflet-tile[src*=night]"));
  await page.click("#share-open");
  assert.match(await snippet(page, "Leaflet"), /land,lake\/\{z\}\/\{x\}\/\{y\}\{r\}\.png"/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("a style changed by hand is kept under an id, or stands in a long address: both draw the same",
  async () => {
    const { page, seen } = await open(
      "#5/46/10&style=night&lake.fill=ff0000&land.filter=name%20%3D%20'island'&topology=fast&simplify=4");
    const short = (await links(page)).TileJSON;
    await page.getByLabel("Long, permanent URLs").check();
    const long = (await links(page)).TileJSON;
    assert.match(short, /\?style=[0-9a-f]{40}$/);
    assert.match(long, /lake\.fill=ff0000/);
    assert.ok(!long.includes("'"), "no apostrophe that a shell would take");
    const tile = (url) => url.replace(".json", "/5/16/11.png");
    const [by_id, by_query] = await Promise.all([short, long].map((url) => fetch(tile(url))));
    assert.equal(by_id.status, 200);
    assert.equal(by_query.status, 200);
    assert.deepEqual(Buffer.from(await by_id.arrayBuffer()), Buffer.from(await by_query.arrayBuffer()));
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  });

test("the command for curl and the <img> fetch the tile in the middle of the map", async () => {
  const { page } = await open("#5/46/10&lake.fill=ff0000&land.filter=name%20%3D%20'island'");
  await page.getByLabel("Long, permanent URLs").check();
  const folder = mkdtempSync(join(tmpdir(), "trapeze-share-"));
  const command = await snippet(page, "curl");
  execFileSync("sh", ["-c", command.replace("curl ", "curl -sS -f ")], { cwd: folder });
  const bytes = readFileSync(join(folder, "map.png"));
  assert.ok((await share_of(page, bytes, RED)) > 0.02);
  rmSync(folder, { recursive: true });
  assert.ok(!existsSync(folder));

  pasted = `<!doctype html><title>Image</title>${await snippet(page, "<img>")}`;
  const { page: other, seen } = await new_page(browser, DENSE);
  await other.goto(`http://127.0.0.1:${pages.address().port}/`);
  const sizes = await other.$eval("img", async (image) => {
    await image.decode();
    return [image.width, image.currentSrc];
  });
  assert.equal(sizes[0], 256);
  assert.match(sizes[1], /\/5\/16\/11@2x\.png\?/);
  assert.deepEqual(seen.tiles.map(({ status }) => status), [200]);
  await other.context().close();
  await page.context().close();
});

test("the command for an archive seeds what is on the screen, with the bytes that the server sends",
  async () => {
    const { page } = await open("#5/46/10&lake.fill=ff0000&land.filter=name%20%3D%20'island'&style=night");
    const command = await snippet(page, "Archive");
    assert.match(command, /--zooms 0-5 /);
    const folder = mkdtempSync(join(tmpdir(), "trapeze-share-"));
    const here = command.replace("trapeze seed --config trapeze.toml",
      `"$TRAPEZE_BINARY" seed --config '${server.config_file}'`).replace("map.pmtiles", "tiles");
    execFileSync("sh", ["-c", here], { cwd: folder, stdio: "ignore" });
    const seeded = readFileSync(join(folder, "tiles/5/16/11.png"));
    rmSync(folder, { recursive: true });
    const { TileJSON } = await links(page);
    const sent = await fetch(TileJSON.replace(".json", "/5/16/11.png"));
    assert.deepEqual(seeded, Buffer.from(await sent.arrayBuffer()));
    assert.ok((await share_of(page, seeded, RED)) > 0.02);
    await page.context().close();
  });

test("every link answers, and the connection for QGIS is XML with the address of the tiles", async () => {
  const { page } = await open("#5/46/10&lake.fill=ff0000");
  for (const [name, url] of Object.entries(await links(page))) {
    assert.equal((await fetch(url)).status, 200, `${name}: ${url}`);
  }
  const xyz = await snippet(page, "QGIS");
  assert.match(xyz, /\/tiles\/land,lake\/\{z\}\/\{x\}\/\{y\}@2x\.png\?style=[0-9a-f]{40}$/);
  const tile = xyz.replace("{z}", 5).replace("{x}", 16).replace("{y}", 11);
  assert.equal((await fetch(tile)).status, 200);
  assert.equal(await snippet(page, "QGIS", 1), `${server.base}wmts.xml`);
  const [connection, file] = await page.locator("a.download").evaluate(async (link) => {
    const text = await (await fetch(link.href)).text();
    const xml = new DOMParser().parseFromString(text, "text/xml");
    const tiles = xml.querySelector("qgsXYZTilesConnections > xyztiles");
    return [{ url: tiles.getAttribute("url"), scale: tiles.getAttribute("tilePixelRatio") },
      link.download];
  });
  assert.deepEqual(connection, { url: xyz, scale: "2" });
  assert.equal(file, "trapeze.xml");
  await page.context().close();
});

test("more layers than one tile can hold are several addresses, of which the lowest has the background",
  async () => {
    const { page } = await new_page(browser);
    const layers = Array.from({ length: 20 }, (_, i) => ({ name: `l${i}`, bounds: [0, 40, 20, 55] }));
    await page.route("**/catalog", (route) => route.fulfill({ json: { layers } }));
    await page.route("**/tiles/**", (route) => route.fulfill({ status: 204 }));
    await page.route("**/legend/**", (route) => route.fulfill({ json: { layers: [{ entries: [] }] } }));
    await page.goto(`${server.base}#5/46/10&style=night`);
    await page.waitForSelector("#layers > li");
    await page.click("#share-open");
    const tiles = (await snippet(page, "Leaflet")).match(/L\.tileLayer\(".*?"/g);
    assert.equal(tiles.length, 2);
    assert.match(tiles[0], /\/tiles\/l0,.*,l15\/\{z\}\/\{x\}\/\{y\}\{r\}\.png\?style=night"/);
    assert.match(tiles[1], /\/tiles\/l16,l17,l18,l19\/.*\?style=night&background=0000"/);
    assert.equal((await snippet(page, "OpenLayers")).match(/new ol\.layer\.Tile/g).length, 2);
    assert.equal((await snippet(page, "MapLibre")).match(/type: "raster", source:/g).length, 2);
    assert.match(await snippet(page, "Archive"), /--layers l0,.*,l15 .*--output map1\.pmtiles/s);
    assert.match(await snippet(page, "Archive", 1),
      /--layers l16,.* --style 'style=night&background=0000' .*--output map2\.pmtiles/s);
    await page.context().close();
  });

test("what the page says of itself cannot become markup or script of the pasted page", async () => {
  const { page } = await new_page(browser);
  const evil = `</script><img src=x onerror="window.harmed=1"> "quoted" 'once'`;
  await page.route("**/catalog", (route) => route.fulfill({
    json: { layers: [{ name: "land", title: evil, attribution: evil, bounds: [0, 40, 20, 55] }] },
  }));
  await page.goto(server.base);
  await tiles_drawn(page);
  await page.click("#share-open");
  for (const client of CLIENTS) {
    pasted = await snippet(page, client);
    const { page: other, seen } = await new_page(browser, DENSE);
    await route_packages(other);
    await other.goto(`http://127.0.0.1:${pages.address().port}/`);
    for (const end = Date.now() + 60_000; seen.tiles.length === 0 && Date.now() < end;) {
      await other.waitForTimeout(100);
    }
    assert.ok(seen.tiles.length > 0, client);
    assert.equal(await other.title(), evil);
    assert.equal(await other.evaluate(() => window.harmed), undefined);
    assert.deepEqual(seen.errors, []);
    await other.context().close();
  }
  await page.context().close();
});

test("Copy copies, arrow keys go from tab to tab, Escape closes and gives back the focus", async () => {
  const { page, seen } = await open("#5/46/10&lake.fill=ff0000");
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await save_screenshot(page, "desktop-share");
  await page.getByRole("tab", { name: "Leaflet" }).focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.getByRole("tab", { name: "OpenLayers" }).getAttribute("aria-selected"), "true");
  await page.getByRole("button", { name: "Copy" }).click();
  await page.getByRole("button", { name: "Copied" }).waitFor();
  assert.equal(await page.evaluate(() => navigator.clipboard.readText()),
    await page.locator(".share code").evaluate((code) => code.textContent));
  await snippet(page, "QGIS");
  await save_screenshot(page, "desktop-share-qgis");
  await links(page);
  await save_screenshot(page, "desktop-share-links");
  await page.keyboard.press("Escape");
  assert.equal(await page.getByRole("dialog").count(), 0);
  assert.equal(await page.evaluate(() => document.activeElement.id), "share-open");
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("on a phone all of it has room, with controls for fingers", async () => {
  const { page, seen } = await open("#5/46/10&lake.fill=ff0000", PHONE);
  await save_screenshot(page, "phone-share");
  for (const tab of ["Leaflet", "QGIS", "Archive", "Links"]) {
    await page.getByRole("tab", { name: tab, exact: true }).click();
    await save_screenshot(page, `phone-share-${tab.toLowerCase()}`);
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
    for (const control of await page.locator(".share button:visible, .share label:visible").all()) {
      const { height, width } = await control.boundingBox();
      const name = await control.innerText();
      assert.ok(height >= 44 && width >= 40, `${name} is ${width} x ${height}`);
    }
  }
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
