// The map itself, and how the part of it is measured that no panel covers.
/* global L */

import { attribution_nodes, link_to } from "./attribution.js";
import { bounds_around } from "./view_bounds.js";

export const MAX_ZOOM = 22;
const MAX_LATITUDE = 85.0511287798066;
const MARGIN = 16; // pixels between what is shown and the edge of what can be seen of the map

export function make_map() {
  const map = L.map("map", {
    attributionControl: false,
    minZoom: 0,
    maxZoom: MAX_ZOOM,
    maxBounds: [[-MAX_LATITUDE, -1e6], [MAX_LATITUDE, 1e6]],
    maxBoundsViscosity: 1,
    worldCopyJump: true,
    // Old tiles show through new ones that fade in, and where frames come late (a tile fades for
    // 200 ms, Leaflet looks after 250) they never go.
    fadeAnimation: false,
    wheelPxPerZoomLevel: 120, // one notch of a mouse wheel is one zoom
  });
  L.control.scale({ position: "bottomleft", imperial: false }).addTo(map);
  tell_keys_from_pointers();
  return map;
}

/** A pane for tiles; those that are made later lie above. */
export function make_pane(map, name) {
  const pane = map.createPane(name);
  pane.style.zIndex = 200; // where Leaflet has its own tiles
  map.on("move resize", () => align_to_screen(map, pane));
  return pane;
}

/**
 * Leaflet puts tiles on whole pixels of the page, which on many screens have 1.25, 1.5 or 2.75 pixels of the
 * screen: where two tiles meet within one of those, a line would show. So the pane is moved by less than one.
 */
function align_to_screen(map, pane) {
  const ratio = window.devicePixelRatio;
  const aligned = (pixels) => Math.round(pixels * ratio) / ratio;
  const { x, y } = L.DomUtil.getPosition(map.getPane("mapPane")).subtract(map.getPixelOrigin());
  pane.style.translate = Number.isInteger(ratio) ? "" : `${aligned(x) - x}px ${aligned(y) - y}px`;
}

/**
 * Leaflet's own control takes markup; ours takes nodes, so that no text can become markup. Returns a
 * function that shows lines.
 */
export function make_attribution(map) {
  const control = L.control({ position: "bottomright" });
  const box = L.DomUtil.create("div", "leaflet-control-attribution");
  control.onAdd = () => box;
  control.addTo(map);
  return (lines) => box.replaceChildren(link_to("https://leafletjs.com", "Leaflet"),
    ...lines.flatMap((line) => [" | ", ...attribution_nodes(line)]));
}

/** Where all of `boxes` can be seen, or the world if they span most of it from side to side and in height. */
export function show_boxes(map, boxes, max_zoom = MAX_ZOOM) {
  const all = bounds_around(boxes);
  const is_world = all.isValid() && all.getEast() - all.getWest() >= 180 &&
    all.getNorth() - all.getSouth() >= 110;
  if (all.isValid() && !is_world) {
    map.fitBounds(all, { ...free_padding(map), maxZoom: max_zoom });
  } else {
    // The smallest whole zoom at which the world is as high as the window.
    map.setView([25, 10], Math.max(1, Math.ceil(Math.log2(map.getSize().y / 256))));
  }
}

/** Shows `place` in the middle of what no panel covers. */
export function show_place_in_free_part(map, { lat, lon, zoom }) {
  const { left, top, right, bottom } = free_part(map);
  const { x: width, y: height } = map.getSize();
  const offset = L.point(width - left - right, height - top - bottom).divideBy(2);
  const centre = map.project([lat, lon], zoom).add(offset);
  map.setView(map.unproject(centre, zoom), zoom);
}

/** How far panels reach into the map, as Leaflet takes it. */
function free_padding(map) {
  const { left, top, right, bottom } = free_part(map);
  const { x: width, y: height } = map.getSize();
  return {
    paddingTopLeft: [left + MARGIN, top + MARGIN],
    paddingBottomRight: [width - right + MARGIN, height - bottom + MARGIN],
  };
}

/** The map without the panels, in pixels of it: of each panel a whole side is left out, the smallest. */
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
 * Leaflet gives the map the focus when it is clicked, which browsers may take for a reason to show where
 * the focus is: whoever uses a pointer sees that anyway.
 */
function tell_keys_from_pointers() {
  const { classList } = document.documentElement;
  document.addEventListener("keydown", () => classList.add("by-keys"), { capture: true });
  document.addEventListener("pointerdown", () => classList.remove("by-keys"), { capture: true });
}
