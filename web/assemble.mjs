// Puts the folder together that the server hands out: our page and Leaflet, nothing from outside.
//
//   node assemble.mjs TARGET
//
// Files are written beside their place and renamed, so a running server never sees half a file.
import { copyFileSync, mkdirSync, readdirSync, renameSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const WEB = dirname(fileURLToPath(import.meta.url));
const LEAFLET = join(WEB, "node_modules", "leaflet");

const PAGE = [
  "index.html",
  "viewer.css",
  "viewer.js",
  "attribution.js",
  "catalog.js",
  "class_editor.js",
  "class_list.js",
  "colours.js",
  "comparison.js",
  "detail_panel.js",
  "elements.js",
  "feature_panel.js",
  "feature_samples.js",
  "layer_panel.js",
  "legend.js",
  "map_layer.js",
  "named_styles.js",
  "place_hash.js",
  "style_controls.js",
  "style_form.js",
  "tile_query.js",
  "tile_timing.js",
  "icon.svg",
];

function copy(from, to) {
  mkdirSync(dirname(to), { recursive: true });
  copyFileSync(from, `${to}.tmp`);
  renameSync(`${to}.tmp`, to);
}

const target = process.argv[2];
if (!target) {
  console.error("usage: node assemble.mjs TARGET");
  process.exit(2);
}
for (const name of PAGE) copy(join(WEB, name), join(target, name));
for (const name of ["leaflet.js", "leaflet.css"]) {
  copy(join(LEAFLET, "dist", name), join(target, "leaflet", name));
}
for (const name of readdirSync(join(LEAFLET, "dist", "images"))) {
  copy(join(LEAFLET, "dist", "images", name), join(target, "leaflet", "images", name));
}
copy(join(LEAFLET, "LICENSE"), join(target, "leaflet", "LICENSE.txt"));
