// Boxes in degrees, [west, south, east, north] as in the catalog, and their visible parts.
/* global L */

const MAX_LATITUDE = 85.05;
const LEAST_PIXELS = 12; // smaller boxes count as invisible

export function is_box(bounds) {
  return Array.isArray(bounds) && bounds.length === 4 && bounds.every(Number.isFinite) &&
    bounds[0] <= bounds[2] && bounds[1] <= bounds[3];
}

/** The bounds of `boxes` for Leaflet; invalid boxes are ignored. */
export function bounds_around(boxes) {
  return L.latLngBounds(boxes.filter(is_box).flatMap(([w, s, e, n]) => [[s, w], [n, e]]));
}

/** Any longitude, wrapped to -180 to 180. */
export function wrapped_longitude(lon) {
  return lon - 360 * Math.floor((lon + 180) / 360);
}

/** Whether a part of `box` is visible on the map, in any copy of the world. */
export function is_in_view(map, box) {
  if (!is_box(box)) return false;
  const [west, south, east, north] = box;
  const view = map.getBounds();
  const is_there = [-360, 0, 360].some((turn) =>
    view.intersects([[south, west + turn], [north, east + turn]]));
  return is_there && pixels_across(map, box) >= LEAST_PIXELS;
}

/** The longer side of `box` on the screen, in pixels. */
export function pixels_across(map, [west, south, east, north]) {
  const low = map.project([south, west]);
  const high = map.project([north, east]);
  return Math.max(high.x - low.x, low.y - high.y);
}

/** The visible box; all longitudes if it extends beyond the edge of the world. */
export function box_in_view(map) {
  const view = map.getBounds();
  const turn = wrapped_longitude(view.getWest()) - view.getWest();
  const [west, east] = [view.getWest() + turn, view.getEast() + turn];
  const within = (lat) => Math.max(-MAX_LATITUDE, Math.min(MAX_LATITUDE, lat));
  const [low, high] = east <= 180 ? [west, east] : [-180, 180];
  return [low, within(view.getSouth()), high, within(view.getNorth())];
}
