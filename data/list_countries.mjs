// Writes what is known of the world's countries beside their land, as CSV: code, name, region, area.
//
//   node list_countries.mjs COUNTRIES.json OUT.csv

import { readFileSync, writeFileSync } from "node:fs";

// The codes that geo-maps has, where they are others.
const CODES = new Map([["UNK", "XKX"]]); // Kosovo

const [source, out] = process.argv.slice(2);
const countries = JSON.parse(readFileSync(source, "utf8"));
const rows = countries.map(({ cca3, name, region, area }) =>
  [CODES.get(cca3) ?? cca3, name.common, region, area > 0 ? area : ""]);
rows.sort(([a], [b]) => (a < b ? -1 : 1));
const lines = [["A3", "name", "region", "area"], ...rows].map((row) => row.map(field).join(","));
writeFileSync(out, `${lines.join("\n")}\n`);

/** As RFC 4180 has it. */
function field(value) {
  const text = String(value);
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
