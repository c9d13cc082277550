// The user's own numbers: a table is pasted, joined to a layer by a key, and shown on the map. Names of a table
// in the language of the browser.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test, { after } from "node:test";

import {
  DESKTOP, PHONE, assert_nothing_went_wrong, hash_of, new_page, save_screenshot,
  shown_tiles, start_browser_and_server, tiles_drawn,
} from "./served_viewer.mjs";

const folder = mkdtempSync(join(tmpdir(), "trapeze-numbers-"));
after(() => rmSync(folder, { recursive: true }));

const columns = Array.from({ length: 12 }, (_, i) => ({
  type: "Feature",
  properties: { code: `C${i}`, number: i },
  geometry: {
    type: "Polygon",
    coordinates: [[[i, 40], [i + 1, 40], [i + 1, 50], [i, 50], [i, 40]]],
  },
}));
writeFileSync(join(folder, "columns.geojson"),
  JSON.stringify({ type: "FeatureCollection", features: columns }));
writeFileSync(join(folder, "people.csv"),
  `code,people\n${columns.map((_, i) => `C${i},${1000 * (i + 1)}`).join("\n")}\n`);

writeFileSync(join(folder, "names.csv"),
  `code,name,name:de\n${columns.map((_, i) => `C${i},Column ${i},Spalte ${i}`).join("\n")}\n`);

const { browser, server } = await start_browser_and_server([], `
[values.people]
file = "${join(folder, "people.csv")}"
title = "people"
[styles.crowd.columns]
values = "people"
color_by = "value"
breaks = "equal:3"
ramp = "Reds"
label_format = ","

[values.names]
file = "${join(folder, "names.csv")}"
attribution = "Named by hand"
languages = ["de"]
[styles.steps.columns]
values = "people"
color_by = "value"
breaks = [3000, 6000]
ramp = "Reds"
[styles.named.columns]
values = "names"
label = "value"
label_overhang = 100

[[layer]]
name = "columns"
file = "${join(folder, "columns.geojson")}"
title = "Columns"
`);

async function open(hash, options = DESKTOP) {
  const { page, seen } = await new_page(browser, options);
  await page.goto(server.base + hash);
  await tiles_drawn(page);
  return { page, seen, form: page.locator("#layers li").filter({ has: page.getByLabel("Style of Columns") }) };
}

/** A table as a spreadsheet copies it; the columns 10 and 11 are missing, and "XX" is not a column. */
function copied(header, value_of) {
  const rows = columns.slice(0, 10).map(({ properties: { code } }, i) => `${code}\tname ${i}\t${value_of(i)}`);
  return [header, ...rows, "XX\tnowhere\t7"].join("\r\n");
}

async function legend_rows(page) {
  return page.locator("#legend-body section").filter({ hasText: "Columns" }).locator("li")
    .evaluateAll((rows) => rows.map(({ textContent }) => textContent.replaceAll("\u00a0", " ")));
}

test("a pasted table colours the layer, says what does not match, and is in the link", async () => {
  const { page, seen, form } = await open("#5/45/6&on=columns");
  await page.getByLabel("Style of Columns").click();
  await form.getByText("Your own numbers").click();
  await form.getByLabel("Table", { exact: true }).fill(copied("code\tname\tscore", (i) => i * i));
  await form.getByLabel("Values in column").selectOption("score");
  await form.getByRole("button", { name: "Show on the map" }).click();
  await page.waitForFunction(() => location.hash.includes("columns.values="));
  const said = form.locator(".numbers .part > [role=status]");
  assert.equal(await said.textContent(), "10 rows match. 1 does not: XX. 2 features have no value.");
  await page.waitForFunction(() =>
    document.querySelector("#legend-body h2")?.textContent === "Columns: score");
  assert.deepEqual(await legend_rows(page),
    ["0 to 4", "4 to 16", "16 to 36", "36 to 64", "64 to 81", "no data"]);
  await form.getByLabel("Split by").selectOption("equal steps");
  await form.getByLabel("Into classes").selectOption("3");
  await page.waitForFunction(() => /columns\.breaks=equal(:|%3A)3&/.test(location.hash));
  await page.waitForFunction(() => document.querySelector("#legend-body").textContent.includes("0 to 27"));
  await save_screenshot(page, "desktop-numbers");
  // The link shows the same map, and the controls have the same state.
  const hash = await hash_of(page);
  const again = await open(hash);
  await again.page.waitForFunction(() => document.querySelector("#legend-body h2"));
  assert.deepEqual(await legend_rows(again.page), await legend_rows(page));
  await again.page.getByLabel("Style of Columns").click();
  assert.equal(await again.form.getByLabel("Split by").inputValue(), "equal");
  assert.equal(await again.form.getByLabel("Into classes").inputValue(), "3");
  assert_nothing_went_wrong(server, again.seen);
  await again.page.context().close();
  await form.getByRole("button", { name: "Take away" }).click();
  await page.waitForFunction(() => !location.hash.includes("columns."));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("the breaks of joined values survive that the layer is switched off and on", async () => {
  const { page, seen, form } = await open("#5/45/6&on=columns&style=steps");
  await page.waitForFunction(() => document.querySelector("#legend-body h2"));
  const rows = await legend_rows(page);
  await form.getByLabel("Columns", { exact: true }).uncheck();
  await form.getByLabel("Columns", { exact: true }).check();
  await page.waitForFunction(() => document.querySelector("#legend-body h2"));
  assert.deepEqual(await legend_rows(page), rows);
  assert.ok(!(await hash_of(page)).includes("columns."));
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});

test("names are in the language of the browser, if there are any, and it is said where they are from", async () => {
  for (const [locale, language] of [["de-AT", "de"], ["en-GB", null], ["fr", null]]) {
    const { page, seen } = await open("#5/45/6&on=columns&style=named", { ...DESKTOP, locale });
    for (const url of await shown_tiles(page)) {
      assert.equal(new URL(url).searchParams.get("label-language"), language, `${locale}: ${url}`);
    }
    assert.equal(await page.locator(".leaflet-control-attribution").innerText(), "Leaflet | Drawn by hand | Named by hand");
    assert.ok(!(await hash_of(page)).includes("language"), "whoever gets the link has a browser of their own");
    await page.evaluate(() => (location.hash = "#5/45/6&on=columns"));
    await page.waitForFunction(() => !document.querySelector(".leaflet-control-attribution").textContent.includes("Named"));
    await tiles_drawn(page);
    for (const url of await shown_tiles(page)) assert.ok(!url.includes("label"), url);
    assert_nothing_went_wrong(server, seen);
    await page.context().close();
  }
});

test("what is wrong with a table is said beside it, and the map stays", async () => {
  const { page, form } = await open("#5/45/6&on=columns", PHONE);
  if (!(await page.locator("#panel-body").isVisible())) await page.tap("#panel-toggle");
  await page.getByLabel("Style of Columns").click();
  await form.getByText("Your own numbers").click();
  const table = form.getByLabel("Table", { exact: true });
  const said = form.locator(".numbers .part > [role=status]");
  const show = form.getByRole("button", { name: "Show on the map" });
  const says = async (words) => {
    await show.click();
    await page.waitForFunction((text) =>
      document.querySelector("#layers details[open] .numbers .part > [role=status]").textContent.includes(text), words)
      .catch(async () => assert.fail(`"${await said.textContent()}" does not say "${words}"`));
  };
  await says("Paste a table first.");
  await table.fill("code,score\nC1,1\nC1,2\n");
  await says("occur more than once: C1 (rows 2 and 3)");
  assert.equal(await table.getAttribute("aria-invalid"), "true");
  await save_screenshot(page, "phone-numbers");
  await table.fill("code,score\nC1,many\nC2,2\n");
  await says('The values are text, such as "many"');
  assert.ok(!(await hash_of(page)).includes("columns."));
  await page.context().close();
});

test("a table of the configuration is shown in its style, and can be parted otherwise", async () => {
  const { page, seen, form } = await open("#5/45/6&on=columns&style=crowd");
  await page.waitForFunction(() =>
    document.querySelector("#legend-body h2")?.textContent === "Columns: people");
  assert.deepEqual(await legend_rows(page),
    ["1,000 to 4,667", "4,667 to 8,333", "8,333 to 12,000", "no data"]);
  await page.getByLabel("Style of Columns").click();
  assert.equal(await form.getByLabel("Palette").inputValue(), "Reds");
  await form.getByLabel("Split by").selectOption("round numbers");
  await page.waitForFunction(() => document.querySelector("#legend-body").textContent.includes("5,000 to 10,000"));
  assert.match(decodeURIComponent(await hash_of(page)), /columns\.values=people&.*columns\.breaks=pretty:3/);
  assert_nothing_went_wrong(server, seen);
  await page.context().close();
});
