// Values of a property as they stand in the view, found by asking what lies under a grid of places.

import { ask_features } from "./feature_panel.js";

const COLUMNS = 7;
const ROWS = 5;
const MAX_LATITUDE = 85;

/**
 * The values of `property` of `layer`, the commonest first; [] if nothing is found. A few dozen
 * small questions: enough to begin with, not a census.
 * @param bounds of the view: {west, south, east, north} in degrees
 */
export async function values_in_view(base, layer, property, bounds, zoom) {
  const asked = places_in(bounds).map((place) =>
    ask_features(base, [{ name: layer, style: new Map() }], [], place, zoom).catch(() => []));
  const found = new Map();
  for (const feature of (await Promise.all(asked)).flat()) {
    const value = feature.properties?.[property];
    if (value === null || value === undefined || value === "") continue;
    found.set(value, (found.get(value) ?? 0) + 1);
  }
  return [...found].sort((a, b) => b[1] - a[1] || (a[0] < b[0] ? -1 : 1)).map(([value]) => value);
}

function places_in({ west, south, east, north }) {
  const places = [];
  for (let row = 0; row < ROWS; row++) {
    for (let column = 0; column < COLUMNS; column++) {
      const lon = west + ((column + 0.5) / COLUMNS) * (east - west);
      const lat = south + ((row + 0.5) / ROWS) * (north - south);
      if (Math.abs(lat) <= MAX_LATITUDE) places.push({ lat, lon: wrapped_longitude(lon) });
    }
  }
  return places;
}

/** Of any number of degrees the like from -180 to 180. */
export function wrapped_longitude(lon) {
  return lon - 360 * Math.floor((lon + 180) / 360);
}
