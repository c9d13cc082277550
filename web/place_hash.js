// What the viewer shows, as the part of its address behind '#':
//
//   #4/51.5074/-0.1278                                  zoom, latitude, longitude
//   #4/51.5074/-0.1278&on=countries                     only these layers (default: all)
//   #4/51.5074/-0.1278&style=water,ff8800,0.5           fill and opacity of a layer, where changed
//
// Names are percent-encoded. Whatever cannot be understood is left out, never an error: people
// shorten and mistype addresses.

const MAX_ZOOM = 24;
const MAX_LATITUDE = 85.0511287798066;

/**
 * @typedef {{zoom: number, lat: number, lon: number}} Place
 * @typedef {{fill: string, opacity: number}} Style  fill as "rrggbb", opacity 0 to 1
 * @typedef {{place: ?Place, on: ?string[], styles: Map<string, Style>}} View
 */

/** @returns {View} `place` and `on` are null where the hash does not say. */
export function parse_hash(hash) {
  const [place, ...rest] = hash.replace(/^#/, "").split("&");
  const view = { place: parse_place(place), on: null, styles: new Map() };
  for (const part of rest) {
    const split = part.indexOf("=");
    const key = part.slice(0, split);
    const value = part.slice(split + 1);
    if (key === "on") view.on = value.split(",").map(decode).filter(Boolean);
    if (key === "style") add_style(view.styles, value);
  }
  return view;
}

/** The inverse of parse_hash, with the '#'. */
export function format_hash({ place, on, styles }) {
  const parts = [place ? format_place(place) : ""];
  if (on) parts.push("on=" + on.map(encode).join(","));
  for (const [name, { fill, opacity }] of styles) {
    parts.push(`style=${encode(name)},${fill},${Number(opacity.toFixed(2))}`);
  }
  return "#" + parts.join("&");
}

function parse_place(text) {
  const numbers = text.split("/").map((part) => (part.trim() === "" ? NaN : Number(part)));
  if (numbers.length !== 3 || !numbers.every(Number.isFinite)) return null;
  const [zoom, lat, lon] = numbers;
  if (zoom < 0 || zoom > MAX_ZOOM || Math.abs(lat) > MAX_LATITUDE) return null;
  return { zoom, lat, lon };
}

function format_place({ zoom, lat, lon }) {
  // One pixel of a tile is 360 / 2^(zoom + 8) degrees: enough digits for less than that.
  const digits = Math.max(0, Math.ceil(((zoom + 8) * Math.LN2 - Math.log(360)) / Math.LN10) + 1);
  return [Number(zoom.toFixed(2)), lat.toFixed(digits), lon.toFixed(digits)].join("/");
}

function add_style(styles, text) {
  const [name, fill, opacity] = text.split(",");
  const number = opacity === undefined || opacity === "" ? NaN : Number(opacity);
  if (!decode(name) || !/^[0-9a-f]{6}$/i.test(fill ?? "")) return;
  if (!(number >= 0 && number <= 1)) return;
  styles.set(decode(name), { fill: fill.toLowerCase(), opacity: number });
}

/** The comma is a separator here. */
function encode(name) {
  return encodeURIComponent(name).replaceAll(",", "%2C");
}

function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return "";
  }
}
