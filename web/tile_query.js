// Addresses of tiles, legends and features, from the settings in the viewer.

/** Parameters that are set for all layers; all others are set per layer. */
export const SHARED_PARAMETERS = ["style", "simplify", "topology", "small", "debug"];

/** `parameters`: a Map, or pairs, of name and value. Returns "a=b&c=d". */
export function query_text(parameters) {
  return [...parameters].map(([name, value]) => `${encode(name)}=${encode(value)}`).join("&");
}

/** Whether a layer of /catalog is served with topology=fast. */
export function has_fast_topology({ topologies }) {
  return Array.isArray(topologies) && topologies.includes("fast");
}

/** Those of the shared parameters that apply to a layer of /catalog. */
export function taken_by(layer, shared) {
  return [...shared].filter(([name]) => name !== "topology" || has_fast_topology(layer));
}

/**
 * The same for an image of several layers: if not all of them are served with topology=fast, the
 * parameter is set individually for those that are. `layers` are {name, style}; `catalog` has all layers.
 */
export function divide_shared(layers, catalog, shared) {
  const takes = ({ name }) => has_fast_topology(catalog.find((layer) => layer.name === name));
  if (!shared.has("topology") || layers.every(takes)) return { styled: layers, shared };
  const topology = ["topology", shared.get("topology")];
  return {
    styled: layers.map((layer) =>
      takes(layer) ? { ...layer, style: [...layer.style, topology] } : layer),
    shared: [...shared].filter(([name]) => name !== "topology"),
  };
}

/** Includes the '?' unless there are no parameters. */
export function query_part(parameters) {
  const text = query_text(parameters);
  return text && `?${text}`;
}

/**
 * The parameters of an image of several layers: `layers` are {name, style}, the lowest first. Parameters
 * of one layer are prefixed with its name, unless it is the only layer and there is no named style. A named
 * style may set parameters for this layer, which unprefixed parameters cannot override.
 */
export function parameters_of_layers(layers, shared) {
  const is_plain = layers.length === 1 && !new Map(shared).has("style");
  const own = layers.flatMap(({ name, style }) =>
    [...style].map(([key, value]) => [is_plain ? key : `${name}.${key}`, value]));
  return [...own, ...shared];
}

export function path_of_layers(layers) {
  return layers.map(({ name }) => encodeURIComponent(name)).join(",");
}

/** Keeps commas and colons, which separate list items and are valid in a query. */
export function encode(text) {
  return encodeURIComponent(text).replaceAll("%2C", ",").replaceAll("%3A", ":");
}
