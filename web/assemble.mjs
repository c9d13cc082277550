// Assembles the page that the server serves: our files and Leaflet, without external resources. The build
// embeds them in the binary (embed.mjs). To try a change without building, write them to a folder and set it
// as web_root:
//
//   node assemble.mjs TARGET
//
// Files are written to a temporary name and renamed, so a running server never sees a partial file.
import { copyFileSync, mkdirSync, readdirSync, renameSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const WEB = dirname(fileURLToPath(import.meta.url));
const LEAFLET = join(WEB, "node_modules", "leaflet");

const PAGE = [
  "index.html",
  "viewer.css",
  "viewer.js",
  "attribute_values.js",
  "attribution.js",
  "catalog.js",
  "class_breaks.js",
  "class_editor.js",
  "class_list.js",
  "colours.js",
  "combined_tiles.js",
  "comparison.js",
  "connection.js",
  "demonstrations.js",
  "detail_panel.js",
  "elements.js",
  "feature_choice.js",
  "feature_panel.js",
  "layer_list.js",
  "layer_panel.js",
  "legend.js",
  "looks.js",
  "map_frame.js",
  "named_styles.js",
  "notices.js",
  "number_editor.js",
  "numbers.js",
  "place_hash.js",
  "progress_line.js",
  "row_order.js",
  "share.css",
  "share_panel.js",
  "share_snippets.js",
  "share_style.js",
  "style_controls.js",
  "style_form.js",
  "tile_query.js",
  "tile_requests.js",
  "tile_timing.js",
  "try_panel.js",
  "value_tables.js",
  "view_bounds.js",
  "icon.svg",
];

/** Every file of the viewer: its name within the page, and its path. */
export function viewerFiles() {
  const files = PAGE.map((name) => ({ name, from: join(WEB, name) }));
  for (const name of ["leaflet.js", "leaflet.css"]) {
    files.push({ name: `leaflet/${name}`, from: join(LEAFLET, "dist", name) });
  }
  for (const name of readdirSync(join(LEAFLET, "dist", "images")).sort()) {
    files.push({ name: `leaflet/images/${name}`, from: join(LEAFLET, "dist", "images", name) });
  }
  files.push({ name: "leaflet/LICENSE.txt", from: join(LEAFLET, "LICENSE") });
  return files;
}

function copy(from, to) {
  mkdirSync(dirname(to), { recursive: true });
  copyFileSync(from, `${to}.tmp`);
  renameSync(`${to}.tmp`, to);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const target = process.argv[2];
  if (!target) {
    console.error("usage: node assemble.mjs TARGET");
    process.exit(2);
  }
  for (const { name, from } of viewerFiles()) copy(from, join(target, name));
}
