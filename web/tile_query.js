// Addresses of tiles, legends and features, from what is set in the viewer.

/** What holds for all layers alike; everything else is set layer by layer. */
export const SHARED_PARAMETERS = ["style", "simplify", "topology", "small", "debug"];

/** `parameters`: a Map, or pairs, of name and value. Ends up as "a=b&c=d". */
export function query_text(parameters) {
  return [...parameters].map(([name, value]) => `${encode(name)}=${encode(value)}`).join("&");
}

/** Whether a layer, as /catalog has it, is served with topology=fast. */
export function has_fast_topology({ topologies }) {
  return Array.isArray(topologies) && topologies.includes("fast");
}

/** What of the parameters for all layers holds for one of /catalog. */
export function taken_by(layer, shared) {
  return [...shared].filter(([name]) => name !== "topology" || has_fast_topology(layer));
}

/**
 * The same for a picture of several: where not all of them are served with topology=fast, it is
 * written for those that are. `layers` are {name, style}, `catalog` is all that there are.
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

/** With the '?' if there is anything to ask. */
export function query_part(parameters) {
  const text = query_text(parameters);
  return text && `?${text}`;
}

/**
 * The parameters of a picture of several layers: `layers` are {name, style}, the lowest first.
 * A layer's own are written with its name before them, unless it is alone and no named style is there,
 * which may say something of this layer: of all layers one cannot say otherwise.
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

/** Commas and colons part lists, and may stand in a query as they are. */
export function encode(text) {
  return encodeURIComponent(text).replaceAll("%2C", ",").replaceAll("%3A", ":");
}
