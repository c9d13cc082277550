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

/** Whether requests can set a parameter for a layer of /catalog. */
export function takes(layer, name) {
  if (Array.isArray(layer.locked) && layer.locked.includes(name)) return false;
  return name !== "topology" || has_fast_topology(layer);
}

/** Those of the parameters that apply to a layer of /catalog. */
export function taken_by(layer, parameters) {
  return [...parameters].filter(([name]) => takes(layer, name));
}

/**
 * The same for an image of several layers: parameters that not all of them take are set individually for
 * those that do. `layers` are {name, style}; `catalog` has all layers.
 */
export function divide_shared(layers, catalog, shared) {
  const known = layers.map(({ name }) => catalog.find((layer) => layer.name === name));
  const divided = [...shared].filter(([name]) => !known.every((layer) => takes(layer, name)));
  if (divided.length === 0) return { styled: layers, shared };
  return {
    styled: layers.map((layer, i) => {
      const own = taken_by(known[i], divided).filter(([name]) => !new Map(layer.style).has(name));
      return own.length ? { ...layer, style: [...layer.style, ...own] } : layer;
    }),
    shared: [...shared].filter(([name]) => !new Map(divided).has(name)),
  };
}

/**
 * Sets the shared parameters individually for those `layers` that take them and for which the named style
 * sets them, because unprefixed ones do not override these.
 */
export function over_named(layers, catalog, shared, { layers: of_layers } = {}) {
  return layers.map((layer) => {
    const known = catalog.find(({ name }) => name === layer.name);
    const own = taken_by(known, shared).filter(([name]) => SHARED_PARAMETERS.includes(name) &&
      Object.hasOwn(of_layers?.[layer.name] ?? {}, name) && !new Map(layer.style).has(name));
    return own.length ? { ...layer, style: new Map([...layer.style, ...own]) } : layer;
  });
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
  // Without a prefix, the layer's own value would be given twice.
  return [...own, ...[...shared].filter(([key]) => !is_plain || !new Map(layers[0].style).has(key))];
}

export function path_of_layers(layers) {
  return layers.map(({ name }) => encodeURIComponent(name)).join(",");
}

/** Keeps commas and colons, which separate list items and are valid in a query. */
export function encode(text) {
  return encodeURIComponent(text).replaceAll("%2C", ",").replaceAll("%3A", ":");
}
