// Snippets to copy that show the map elsewhere. Pages are complete: saved as a file, they show the map.

import { query_text } from "./tile_query.js";

const LEAFLET = "https://unpkg.com/leaflet@1.9.4/dist";
const OPENLAYERS = "https://unpkg.com/ol@10.11.0";
const MAPLIBRE = "https://unpkg.com/maplibre-gl@6.17.0/dist";

/**
 * @typedef {object} SharedMap
 * @property {string} title
 * @property {string} attribution  markup that contains only text and links
 * @property {{names: string[], lasting: [string, string][], path: string, query: string}[]} sheets
 *   layers; parameters of their style that do not depend on the server's memory; address of their tiles
 *   without the tile coordinates; the lowest first, more than one if the server cannot draw all layers
 *   in one tile
 * @property {{lat: number, lon: number, zoom: number}} place
 * @property {[number, number, number, number]} view  the visible part of the map: west, south, east, north
 * @property {number} min_zoom @property {number} max_zoom
 * @property {string} wmts  address
 */

/** Tile address of one sheet; `tile` is a template such as "{z}/{x}/{y}{r}". */
export function address({ path, query }, tile) {
  return `${path}/${tile}.png${query}`;
}

export function leaflet_page(map) {
  const { lat, lon, zoom } = map.place;
  const options = (i) => [
    ...(map.min_zoom > 0 ? [`minZoom: ${map.min_zoom}`] : []), `maxZoom: ${map.max_zoom}`,
    ...(i === 0 ? attribution_option(map, "attribution") : []),
  ];
  return page(map, `  <link rel="stylesheet" href="${LEAFLET}/leaflet.css">
  <script src="${LEAFLET}/leaflet.js"></script>`, `  <script>
    const map = L.map("map").setView([${lat}, ${lon}], ${zoom});
${map.sheets.map((sheet, i) => `    L.tileLayer(${quoted(address(sheet, "{z}/{x}/{y}{r}"))}, {
${lines(options(i), 6)}
    }).addTo(map);`).join("\n")}
  </script>`);
}

export function openlayers_page(map) {
  const { lat, lon, zoom } = map.place;
  const source = (sheet, i) => [
    `url: ${for_any_screen(sheet)}`,
    "tilePixelRatio: dense ? 2 : 1", `maxZoom: ${map.max_zoom}`,
    ...(i === 0 ? attribution_option(map, "attributions") : []),
    ...(i === 0 && map.attribution ? ["attributionsCollapsible: false"] : []),
  ];
  return page(map, `  <link rel="stylesheet" href="${OPENLAYERS}/ol.css">
  <script src="${OPENLAYERS}/dist/ol.js"></script>`, `  <script>
    const dense = devicePixelRatio > 1;
    const map = new ol.Map({
      target: "map",
      layers: [
${map.sheets.map((sheet, i) => `        new ol.layer.Tile({
          source: new ol.source.XYZ({
${lines(source(sheet, i), 12)}
          }),
        }),`).join("\n")}
      ],
      view: new ol.View({ center: ol.proj.fromLonLat([${lon}, ${lat}]), zoom: ${zoom} }),
    });
  </script>`);
}

export function maplibre_page(map) {
  const { lat, lon, zoom } = map.place;
  const source = (sheet, i) => [
    'type: "raster"', "tileSize: 256",
    `tiles: [${for_any_screen(sheet)}]`,
    `minzoom: ${map.min_zoom}`, `maxzoom: ${map.max_zoom}`,
    ...(i === 0 ? attribution_option(map, "attribution") : []),
  ];
  const names = map.sheets.map((_, i) => (i === 0 ? "trapeze" : `trapeze_${i + 1}`));
  return page(map, `  <link rel="stylesheet" href="${MAPLIBRE}/maplibre-gl.css">`,
    `  <script type="module">
    import * as maplibregl from "${MAPLIBRE}/maplibre-gl.mjs";

    const dense = devicePixelRatio > 1;
    const map = new maplibregl.Map({
      container: "map",
      center: [${lon}, ${lat}],
      zoom: ${round(zoom - 1)}, // MapLibre zooms refer to tiles of 512 pixels
      style: {
        version: 8,
        sources: {
${map.sheets.map((sheet, i) => `          ${names[i]}: {
${lines(source(sheet, i), 12)}
          },`).join("\n")}
        },
        layers: [
${names.map((name) => `          { id: "${name}", type: "raster", source: "${name}" },`).join("\n")}
        ],
      },
    });
  </script>`);
}

/** An <img> of the tile in the middle of the map. */
export function image_tag(map) {
  const tile = middle_tile(map);
  const at = (scale) => attribute(address(map.sheets[0], `${tile}${scale}`));
  return `<img src="${at("")}"
  srcset="${at("@2x")} 2x"
  width="256" height="256" alt="${attribute(map.title)}">`;
}

export function curl_command(map) {
  // Single quotes protect the address from the shell; these addresses contain none.
  return `curl -o map.png '${address(map.sheets[0], `${middle_tile(map)}@2x`)}'`;
}

/** The command that writes the current view, up to its zoom, into the archive with that number. */
export function seed_command({ place, view, min_zoom }, { names, lasting }, number) {
  const zoom = Math.max(min_zoom, Math.round(place.zoom));
  const style = query_text(lasting).replaceAll("'", "%27");
  return ["trapeze seed --config trapeze.toml", `--layers ${for_shell(names.join(","))}`,
    ...(style ? [`--style ${for_shell(style)}`] : []),
    `--zooms ${min_zoom}-${zoom}`, `--bbox=${view.map((side) => Number(side.toFixed(4))).join(",")}`,
    `--output map${number}.pmtiles`].join(" \\\n  ");
}

/** For QGIS: Browser, XYZ Tiles, Load Connections. */
export function qgis_connections(map) {
  const connections = map.sheets.map((sheet, i) => {
    const name = i === 0 ? map.title : `${map.title} (${i + 1})`;
    return `  <xyztiles name="${attribute(name)}" url="${attribute(address(sheet, "{z}/{x}/{y}@2x"))}"
    zmin="${map.min_zoom}" zmax="${map.max_zoom}" tilePixelRatio="2"
    username="" password="" authcfg="" referer=""/>`;
  });
  return `<!DOCTYPE connections>
<qgsXYZTilesConnections version="1.0">
${connections.join("\n")}
</qgsXYZTilesConnections>
`;
}

/** "z/x/y" of the tile that contains the middle of the map. */
export function middle_tile({ place: { lat, lon, zoom } }) {
  const z = Math.max(0, Math.round(zoom));
  const side = 2 ** z;
  const inside = (part) => Math.min(Math.max(Math.floor(part * side), 0), side - 1);
  const y = 0.5 - Math.asinh(Math.tan((lat * Math.PI) / 180)) / (2 * Math.PI);
  return `${z}/${inside((lon + 180) / 360)}/${inside(y)}`;
}

function page(map, head, script) {
  return `<!doctype html>
<html lang="en">
<head>
  <meta charset="utf-8">
  <meta name="viewport" content="width=device-width, initial-scale=1">
  <title>${text(map.title)}</title>
${head}
  <style>html, body, #map { height: 100%; margin: 0; }</style>
</head>
<body>
  <div id="map"></div>
${script}
</body>
</html>
`;
}

/** The address as a JavaScript expression with `dense`. Braces in names are encoded: these are ours. */
function for_any_screen(sheet) {
  return quoted(address(sheet, "{z}/{x}/{y}{dense}"))
    .replace("{dense}", '" + (dense ? "@2x" : "") + "');
}

function attribution_option({ attribution }, name) {
  return attribution ? [`${name}: ${quoted(attribution)}`] : [];
}

function lines(items, indent) {
  return items.map((item) => `${" ".repeat(indent)}${item},`).join("\n");
}

/** A string literal for an inline script, which cannot end the script element. */
function quoted(value) {
  return JSON.stringify(value).replaceAll("</", "<\\/").replace(/<(?=!|script)/gi, "\\u003c");
}

function text(value) {
  return value.replaceAll("&", "&amp;").replaceAll("<", "&lt;");
}

function attribute(value) {
  return text(value).replaceAll('"', "&quot;");
}

/** Any text as one shell word. */
function for_shell(word) {
  return /^[\w,./:-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`;
}

function round(number) {
  return Number(number.toFixed(2));
}
