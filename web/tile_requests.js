// The tile requests for the layers that are on: one for all of them, or as few as the server accepts.

import {
  divide_shared, over_named, parameters_of_layers, path_of_layers, query_part, taken_by,
} from "./tile_query.js";

export const MOST_LAYERS = 16; // in one tile
export const LONGEST = 4000; // bytes of path and query; the server accepts 4096
export const LONGEST_PLACE = "/22/4194303/4194303@2x.png".length;

/**
 * @param drawn {name, style}, the lowest first
 * @param settings {layers: of the catalog; shared: parameters of all layers; named: document of the
 *   named style among them, if known; has_background: whether it fills the tile; folder: path of the
 *   server's tiles}
 * @returns requests, the lowest first: {layers: names, path, query, min_zoom, max_zoom, parts}, where
 *   `parts` are requests for the same layers one by one
 */
export function tile_requests(drawn, settings) {
  const requests = [];
  let group = [];
  const close = () => {
    if (group.length) requests.push(with_parts(group, settings, requests.length === 0));
    group = [];
  };
  for (const layer of over_named(drawn, settings.layers, settings.shared, settings.named)) {
    if (group.length && !fits([...group, layer], settings)) close();
    group.push(layer);
  }
  close();
  return requests;
}

function fits(group, settings) {
  if (group.length > MOST_LAYERS) return false;
  const { path, query } = request_for(group, settings, false);
  return settings.folder.length + path.length + LONGEST_PLACE + query.length <= LONGEST;
}

function with_parts(group, settings, is_lowest) {
  const parts = group.length === 1 ? []
    : group.map((layer, i) => request_for([layer], settings, is_lowest && i === 0));
  return { ...request_for(group, settings, is_lowest), parts };
}

function request_for(group, { layers, shared, has_background }, is_lowest) {
  const known = group.map(({ name }) => layers.find((layer) => layer.name === name));
  const of_one = group.length === 1;
  const { styled, shared: rest } = of_one
    ? { styled: group, shared: taken_by(known[0], shared) } : divide_shared(group, layers, shared);
  // The background would hide the requests below, so only the lowest request includes it.
  const cover = has_background && !is_lowest ? [["background", "0000"]] : [];
  return {
    layers: group.map(({ name }) => name),
    path: path_of_layers(group),
    query: query_part([...parameters_of_layers(styled, rest), ...cover]),
    min_zoom: Math.min(...known.map(({ minzoom }) => whole_or(minzoom, 0))),
    max_zoom: Math.max(...known.map(({ maxzoom }) => whole_or(maxzoom, Infinity))),
    parts: [],
  };
}

function whole_or(zoom, otherwise) {
  return Number.isInteger(zoom) ? zoom : otherwise;
}
