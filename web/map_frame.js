// The map, and the measurement of its part that no panel covers.
/* global L */

import { attribution_nodes, link_to } from "./attribution.js";
import { bounds_around } from "./view_bounds.js";

export const MAX_ZOOM = 22;
const MAX_LATITUDE = 85.0511287798066;
const MARGIN = 16; // pixels between the shown content and the edge of the visible part of the map

export function make_map() {
  const map = L.map("map", {
    attributionControl: false,
    minZoom: 0,
    maxZoom: MAX_ZOOM,
    maxBounds: [[-MAX_LATITUDE, -1e6], [MAX_LATITUDE, 1e6]],
    maxBoundsViscosity: 1,
    worldCopyJump: true,
    // Old tiles show through new ones that fade in. If frames are late, they are never removed: a tile
    // fades for 200 ms, and Leaflet checks after 250.
    fadeAnimation: false,
    wheelPxPerZoomLevel: 120, // one notch of the mouse wheel is one zoom level
  });
  L.control.scale({ position: "bottomleft", imperial: false }).addTo(map);
  tell_keys_from_pointers();
  return map;
}

/** A pane for tiles; panes created later are on top. */
export function make_pane(map, name) {
  const pane = map.createPane(name);
  pane.style.zIndex = 200; // as for Leaflet's own tile pane
  map.on("move resize", () => align_to_screen(map, pane));
  return pane;
}

/**
 * Leaflet places tiles at whole CSS pixels, which on many screens are 1.25, 1.5 or 2.75 device pixels. If
 * two tiles meet within a device pixel, a line shows. The pane is therefore moved by less than one pixel.
 */
function align_to_screen(map, pane) {
  const ratio = window.devicePixelRatio;
  const aligned = (pixels) => Math.round(pixels * ratio) / ratio;
  const { x, y } = L.DomUtil.getPosition(map.getPane("mapPane")).subtract(map.getPixelOrigin());
  pane.style.translate = Number.isInteger(ratio) ? "" : `${aligned(x) - x}px ${aligned(y) - y}px`;
}

/**
 * Leaflet's own control accepts markup; this one accepts DOM nodes, so that no text can become markup.
 * Returns a function that shows lines.
 */
export function make_attribution(map) {
  const control = L.control({ position: "bottomright" });
  const box = L.DomUtil.create("div", "leaflet-control-attribution");
  control.onAdd = () => box;
  control.addTo(map);
  return (lines) => box.replaceChildren(link_to("https://leafletjs.com", "Leaflet"),
    ...lines.flatMap((line) => [" | ", ...attribution_nodes(line)]));
}

/** Fits the map to `boxes`, or to the world if they span most of its width and height. */
export function show_boxes(map, boxes, max_zoom = MAX_ZOOM) {
  const all = bounds_around(boxes);
  const is_world = all.isValid() && all.getEast() - all.getWest() >= 180 &&
    all.getNorth() - all.getSouth() >= 110;
  if (all.isValid() && !is_world) {
    map.fitBounds(all, { ...free_padding(map), maxZoom: max_zoom });
  } else {
    // The smallest integer zoom at which the world is at least as high as the window.
    map.setView([25, 10], Math.max(1, Math.ceil(Math.log2(map.getSize().y / 256))));
  }
}

/** Centres `place` in the part of the map that no panel covers. */
export function show_place_in_free_part(map, { lat, lon, zoom }) {
  const { left, top, right, bottom } = free_part(map);
  const { x: width, y: height } = map.getSize();
  const offset = L.point(width - left - right, height - top - bottom).divideBy(2);
  const centre = map.project([lat, lon], zoom).add(offset);
  map.setView(map.unproject(centre, zoom), zoom);
}

/** The padding for the panels, in the form that Leaflet expects. */
function free_padding(map) {
  const { left, top, right, bottom } = free_part(map);
  const { x: width, y: height } = map.getSize();
  return {
    paddingTopLeft: [left + MARGIN, top + MARGIN],
    paddingBottomRight: [width - right + MARGIN, height - bottom + MARGIN],
  };
}

/** The map without the panels, in its pixels: each panel excludes a whole side, the smallest one possible. */
function free_part(map) {
  const { x: width, y: height } = map.getSize();
  const free = { left: 0, top: 0, right: width, bottom: height };
  for (const panel of document.querySelectorAll("#panel, #features, #try")) {
    const box = panel.getBoundingClientRect();
    if (box.width === 0) continue;
    const [side] = Object.entries({
      left: box.right * height, right: (width - box.left) * height,
      top: box.bottom * width, bottom: (height - box.top) * width,
    }).reduce((least, one) => (one[1] < least[1] ? one : least));
    if (side === "left") free.left = Math.max(free.left, box.right);
    if (side === "right") free.right = Math.min(free.right, box.left);
    if (side === "top") free.top = Math.max(free.top, box.bottom);
    if (side === "bottom") free.bottom = Math.min(free.bottom, box.top);
  }
  return free;
}

/**
 * Leaflet focuses the map on a click, after which browsers may draw a focus ring. Pointer users do not
 * need it.
 */
function tell_keys_from_pointers() {
  const { classList } = document.documentElement;
  document.addEventListener("keydown", () => classList.add("by-keys"), { capture: true });
  document.addEventListener("pointerdown", () => classList.remove("by-keys"), { capture: true });
}
