// A running `trapeze serve` with two small layers, and pages of a headless Chromium that show it.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { createServer } from "node:net";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after } from "node:test";
import { fileURLToPath } from "node:url";

export const HERE = dirname(fileURLToPath(import.meta.url));
export const WEB = join(HERE, "..", "..", "web");
const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium-headless-shell";
const SKIPPED = 77;
const START_TIMEOUT_MS = 60_000; // enough for sanitizers on a busy machine

function skip(reason) {
  console.log(`skipped: ${reason}`);
  process.exit(SKIPPED);
}

function load_playwright() {
  const require = createRequire(join(HERE, "package.json"));
  try {
    return require("playwright-core");
  } catch {
    return skip("playwright-core is not installed; run script/bootstrap");
  }
}

export function free_port() {
  return new Promise((resolve, reject) => {
    const probe = createServer();
    probe.on("error", reject);
    probe.listen(0, "127.0.0.1", () => {
      const { port } = probe.address();
      probe.close(() => resolve(port));
    });
  });
}

const config = (web_root, more) => `
[server]
address = "127.0.0.1"
web_root = "${web_root}"

[styles.night]
background = "#102030"
simplify = 2
[styles.night.land]
fill = "#405060"
stroke = "#ffffff"
stroke_width = 3
color_by = "name"
classes = "island:ff0000"
[styles.night.lake]
pattern = "dots"

[[layer]]
name = "land"
file = "${join(HERE, "land.geojson")}"
title = "Land"
attribution = 'Drawn by <a href="https://example.org/">hand</a>'
fast_topology = true
style = { fill = "#d8c99b" }

[[layer]]
name = "lake"
file = "${join(HERE, "lake.geojson")}"
title = "Lake"
style = { fill = "#4f8fba" }
${more}`;

async function wait_until_ready(base, server) {
  const end = Date.now() + START_TIMEOUT_MS;
  while (Date.now() < end) {
    if (server.process.exitCode !== null) break;
    try {
      if ((await fetch(`${base}ready`)).status === 200) return;
    } catch {
      // Not listening yet.
    }
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  throw new Error(`trapeze serve did not get ready; it said:\n${server.output}`);
}

/** Starts the server on a free port; the result is closed with `close`. */
async function start_server(more_config) {
  const binary = process.env.TRAPEZE_BINARY;
  if (!binary) throw new Error("TRAPEZE_BINARY must name the program to test");
  const folder = mkdtempSync(join(tmpdir(), "trapeze-viewer-"));
  const web_root = join(folder, "web");
  // Not web/dist, which is only as recent as the last run of script/bootstrap.
  execFileSync(process.execPath, [join(WEB, "assemble.mjs"), web_root]);
  const config_file = join(folder, "trapeze.toml");
  writeFileSync(config_file, config(web_root, more_config));

  const port = await free_port();
  const server = { output: "", base: `http://127.0.0.1:${port}/`, config_file };
  let exited;
  const launch = () => {
    const child = spawn(binary, ["serve", "--config", config_file, "--port", String(port)], {
      stdio: ["ignore", "pipe", "pipe"],
    });
    server.process = child;
    for (const stream of [child.stdout, child.stderr]) {
      stream.on("data", (text) => (server.output += text));
    }
    child.on("error", (error) => (server.output += error.message));
    exited = new Promise((resolve) =>
      child.on("exit", (code, signal) => resolve({ code, signal })));
  };
  server.stop = () => {
    server.process.kill("SIGTERM");
    return exited;
  };
  /** After stop(): starts the server again on the same port. */
  server.start = async () => {
    launch();
    await wait_until_ready(server.base, server);
  };
  server.close = async () => {
    const end = await server.stop();
    rmSync(folder, { recursive: true });
    return end;
  };
  launch();
  try {
    await wait_until_ready(server.base, server);
  } catch (error) {
    server.process.kill("SIGKILL");
    throw error;
  }
  return server;
}

/** `options` are additional command-line options of Chromium. */
async function start_browser(options) {
  const { chromium } = load_playwright();
  if (!existsSync(CHROMIUM)) skip(`${CHROMIUM} is not installed; run script/bootstrap`);
  return chromium.launch({
    executablePath: CHROMIUM,
    args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync",
      ...options],
  });
}

/**
 * Starts both and closes them after the tests of the file; the server must then exit cleanly.
 * `more_config` is added to the server's configuration.
 */
export async function start_browser_and_server(options = [], more_config = "") {
  const browser = await start_browser(options);
  let server;
  after(async () => {
    await browser.close();
    assert.deepEqual(await server?.close(), { code: 0, signal: null }, "SIGTERM ends the server");
  });
  server = await start_server(more_config);
  return { browser, server };
}

export const DESKTOP = { viewport: { width: 1280, height: 800 } };
export const TABLET = {
  viewport: { width: 820, height: 1180 },
  deviceScaleFactor: 2,
  isMobile: true,
  hasTouch: true,
};
export const PHONE = {
  viewport: { width: 390, height: 844 },
  deviceScaleFactor: 2,
  isMobile: true,
  hasTouch: true,
};

/** A page in its own context that records its requests and errors. */
export async function new_page(browser, options = DESKTOP) {
  const context = await browser.newContext(options);
  const page = await context.newPage();
  const seen = { requests: [], answers: [], tiles: [], errors: [] };
  page.on("request", (request) => seen.requests.push(request.url()));
  page.on("response", (response) => {
    const answer = { url: response.url(), status: response.status() };
    seen.answers.push(answer);
    if (answer.url.includes("/tiles/")) seen.tiles.push(answer);
  });
  page.on("console", (message) => {
    if (message.type() === "error") seen.errors.push(message.text());
  });
  page.on("pageerror", (error) => seen.errors.push(String(error)));
  return { page, seen };
}

/** Waits until every requested tile has been drawn and no old one is left. */
export async function tiles_drawn(page) {
  await page.waitForFunction(() => {
    const tiles = [...document.querySelectorAll("img.leaflet-tile")];
    return tiles.length > 0 && tiles.every((tile) =>
      tile.classList.contains("leaflet-tile-loaded") && tile.naturalWidth > 0 &&
      getComputedStyle(tile).opacity === "1");
  }, null, { timeout: 30_000, polling: 50 });
}

/** Waits until nothing on the page moves, unfolds or fades. */
export async function at_rest(page) {
  await page.waitForFunction(() => !document.querySelector(".leaflet-pan-anim, .leaflet-zoom-anim") &&
    document.getAnimations().every(({ playState }) => playState !== "running"), null, { polling: 50 });
}

/**
 * The addresses of the tiles on the page, sorted. Read in one step: a list of elements that is
 * transferred first ($$eval) may contain tiles that have been removed since.
 */
export function shown_tiles(page) {
  return page.evaluate(() =>
    [...document.querySelectorAll("img.leaflet-tile")].map((tile) => tile.src).sort());
}

/** The tiles that show a layer, alone or together with others. */
export function of_layer(tiles, name) {
  return tiles.filter((url) => layers_of(url).includes(name));
}

export function layers_of(tile_url) {
  return /\/tiles\/([^/]+)\//.exec(tile_url)[1].split(",");
}

/** The parameters in a tile's address that apply to one of its layers: its own and those for all layers. */
export function query_of(tile_url, name) {
  const layers = layers_of(tile_url);
  const parameters = [...new URL(tile_url).searchParams];
  const of_others = (key) => layers.some((layer) => layer !== name && key.startsWith(`${layer}.`));
  return Object.fromEntries(parameters.filter(([key]) => !of_others(key)).map(([key, value]) =>
    [key.startsWith(`${name}.`) ? key.slice(name.length + 1) : key, value]));
}

export function hash_of(page) {
  return page.evaluate(() => location.hash);
}

/** The number of opaque pixels with this colour in the tiles that show a layer. */
export function pixels_of_colour(page, name, [r, g, b]) {
  return page.evaluate(([name, r, g, b]) => {
    let count = 0;
    for (const tile of document.querySelectorAll("img.leaflet-tile")) {
      if (!/\/tiles\/([^/]+)\//.exec(tile.src)[1].split(",").includes(name)) continue;
      const canvas = new OffscreenCanvas(tile.naturalWidth, tile.naturalHeight);
      const context = canvas.getContext("2d");
      context.drawImage(tile, 0, 0);
      const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
      for (let i = 0; i < data.length; i += 4) {
        if (data[i + 3] > 250 && data[i] === r && data[i + 1] === g && data[i + 2] === b) count++;
      }
    }
    return count;
  }, [name, r, g, b]);
}

/** Conditions that every undisturbed visit must satisfy. */
export function assert_nothing_went_wrong(server, seen) {
  assert.deepEqual(seen.errors, []);
  assert.deepEqual(seen.requests.filter((url) => !url.startsWith(server.base)), [],
    "nothing is fetched from elsewhere");
  assert.deepEqual(seen.tiles.filter(({ status }) => status !== 200 && status !== 304), []);
}

export async function save_screenshot(page, name) {
  const folder = process.env.TRAPEZE_SCREENSHOTS;
  if (!folder) return;
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}.png`) });
}
