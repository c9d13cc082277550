// Writes what is known of the world's countries beside their land, as CSV: code, name, region, area,
// and the name in other languages.
//
//   node list_countries.mjs COUNTRIES.json OUT.csv

import { readFileSync, writeFileSync } from "node:fs";

// The codes that geo-maps has, where they are others.
const CODES = new Map([["UNK", "XKX"]]); // Kosovo

// The tags of languages in the columns, by the codes that the source has.
const LANGUAGES = {
  ara: "ar", ces: "cs", deu: "de", est: "et", fin: "fi", fra: "fr", hrv: "hr", hun: "hu", ita: "it",
  jpn: "ja", kor: "ko", nld: "nl", per: "fa", pol: "pl", por: "pt", rus: "ru", slk: "sk", spa: "es",
  srp: "sr", swe: "sv", tur: "tr", urd: "ur", zho: "zh",
};

const [source, out] = process.argv.slice(2);
const countries = JSON.parse(readFileSync(source, "utf8"));
const rows = countries.map(({ cca3, name, region, area, translations }) =>
  [CODES.get(cca3) ?? cca3, name.common, region, area > 0 ? area : "",
    ...Object.keys(LANGUAGES).map((code) => translations[code]?.common ?? "")]);
rows.sort(([a], [b]) => (a < b ? -1 : 1));
const names = Object.values(LANGUAGES).map((tag) => `name:${tag}`);
const lines = [["A3", "name", "region", "area", ...names], ...rows].map((row) => row.map(field).join(","));
writeFileSync(out, `${lines.join("\n")}\n`);

/** As RFC 4180 has it. */
function field(value) {
  const text = String(value);
  return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
