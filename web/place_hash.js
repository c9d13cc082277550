// The state of the viewer, as the part of its address after '#':
//
//   #4/51.5074/-0.1278                          zoom, latitude, longitude
//   ...&on=countries                            only these layers (default: all)
//   ...&water.fill=ff8800&water.pattern=hatch   parameters of a layer, where changed
//   ...&simplify=4&debug=mesh                   parameters of all layers, where changed
//   ...&style=night                             a named style of the server
//   ...&compare=0.5                             full detail to the right of the middle
//   ...&compare=0.5&against=apart               each polygon simplified by itself there
//   ...&order=water,countries                   from the lowest to the topmost (default: as served)
//   ...&at=51.5,-0.12                           the place whose features are shown
//   ...&chosen=countries/12                     the outlined feature
//
// Names and values are percent-encoded. Parts that cannot be parsed are ignored and never an error,
// because people shorten and mistype addresses. The server validates the values of a layer's parameters.

import { encode } from "./tile_query.js";

const MAX_ZOOM = 24;
const MAX_LATITUDE = 85.0511287798066;
const LONGEST_SIMPLIFY = 64;
const DEBUG = ["faces", "junctions", "mesh", "tile", "vertices"];
const PARAMETER = /^[a-z]+(-[a-z]+)*$/;

const READ_SHARED = {
  style: (text) => /^[A-Za-z0-9_-]{1,64}$/.test(text),
  simplify: (text) => is_number(text, 0, LONGEST_SIMPLIFY),
  topology: (text) => ["strict", "fast"].includes(text),
  small: (text) => ["dust", "keep", "drop"].includes(text),
  debug: (text) => text === "" || text.split(",").every((word) => DEBUG.includes(word)),
};

/**
 * @typedef {{zoom: number, lat: number, lon: number}} Place
 * @typedef {Map<string, string>} Style  values of parameters by name
 * @typedef {{place: ?Place, on: ?string[], styles: Map<string, Style>, shared: Style,
 *   compare: ?number, against: ("apart"|undefined), order: ?string[], at: ?{lat: number, lon: number},
 *   chosen: ?{layer: string, id: string}}} View
 */

/** @returns {View} members missing in the hash are null or empty */
export function parse_hash(hash) {
  const [place, ...rest] = hash.replace(/^#/, "").split("&");
  const view = {
    place: parse_place(place), on: null, styles: new Map(), shared: new Map(), compare: null,
    order: null, at: null, chosen: null,
  };
  for (const part of rest) {
    const split = part.indexOf("=");
    if (split > 0) read_part(view, part.slice(0, split), part.slice(split + 1));
  }
  return view;
}

/** The inverse of parse_hash, with the '#'. */
export function format_hash({
  place, on, styles, shared, compare, against, order, at, chosen,
}) {
  const parts = [place ? format_place(place) : ""];
  if (on) parts.push("on=" + format_names(on));
  if (order) parts.push("order=" + format_names(order));
  for (const [layer, style] of styles) {
    for (const [name, value] of style) parts.push(`${encode_name(layer)}.${name}=${encode(value)}`);
  }
  for (const [name, value] of shared) parts.push(`${name}=${encode(value)}`);
  if (compare !== null) parts.push(`compare=${Number(compare.toFixed(3))}`);
  if (compare !== null && against) parts.push(`against=${against}`);
  if (at) parts.push(`at=${Number(at.lat.toFixed(7))},${Number(at.lon.toFixed(7))}`);
  if (at && chosen) parts.push(`chosen=${encode_name(chosen.layer)}/${chosen.id}`);
  return "#" + parts.join("&");
}

function read_part(view, key, value) {
  if (key === "on") {
    view.on = parse_names(value);
  } else if (key === "order") {
    view.order = parse_names(value);
  } else if (key === "compare") {
    if (is_number(value, 0, 1)) view.compare = Number(value);
  } else if (key === "against") {
    if (value === "apart") view.against = value;
  } else if (key === "at") {
    view.at = parse_point(value);
  } else if (key === "chosen") {
    view.chosen = parse_feature(value);
  } else if (Object.hasOwn(READ_SHARED, key)) {
    if (READ_SHARED[key](decode(value))) view.shared.set(key, decode(value));
  } else {
    read_layer_parameter(view.styles, key, decode(value));
  }
}

function read_layer_parameter(styles, key, value) {
  const dot = key.lastIndexOf(".");
  const layer = decode(key.slice(0, Math.max(dot, 0)));
  const name = key.slice(dot + 1);
  if (!layer || !PARAMETER.test(name) || value === "") return;
  if (!styles.has(layer)) styles.set(layer, new Map());
  styles.get(layer).set(name, value);
}

function is_number(text, min, max) {
  return text.trim() !== "" && Number(text) >= min && Number(text) <= max;
}

function parse_place(text) {
  const numbers = text.split("/").map((part) => (part.trim() === "" ? NaN : Number(part)));
  if (numbers.length !== 3 || !numbers.every(Number.isFinite)) return null;
  const [zoom, lat, lon] = numbers;
  if (zoom < 0 || zoom > MAX_ZOOM || Math.abs(lat) > MAX_LATITUDE) return null;
  return { zoom, lat, lon };
}

function parse_point(text) {
  const [lat, lon, ...more] = text.split(",");
  if (more.length || lon === undefined) return null;
  if (!is_number(lat, -MAX_LATITUDE, MAX_LATITUDE) || !is_number(lon, -180, 180)) return null;
  return { lat: Number(lat), lon: Number(lon) };
}

function parse_names(text) {
  return text.split(",").map(decode).filter(Boolean);
}

function format_names(names) {
  return names.map(encode_name).join(",");
}

function parse_feature(text) {
  const [layer, id, ...more] = text.split("/");
  if (more.length || !decode(layer) || !/^-?\d{1,20}$/.test(id ?? "")) return null;
  return { layer: decode(layer), id };
}

function format_place({ zoom, lat, lon }) {
  // One pixel of a tile is 360 / 2^(zoom + 8) degrees: uses enough digits for less than a pixel.
  const digits = Math.max(0, Math.ceil(((zoom + 8) * Math.LN2 - Math.log(360)) / Math.LN10) + 1);
  return [Number(zoom.toFixed(2)), lat.toFixed(digits), lon.toFixed(digits)].join("/");
}

/** Also encodes the comma, which is a separator here. */
function encode_name(name) {
  return encodeURIComponent(name).replaceAll(",", "%2C");
}

function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return "";
  }
}
