// Addresses of tiles, legends and features, from what is set in the viewer.

/** What holds for all layers alike; everything else is set layer by layer. */
export const SHARED_PARAMETERS = ["style", "simplify", "topology", "small", "debug"];

/** `parameters`: a Map, or pairs, of name and value. Ends up as "a=b&c=d". */
export function query_text(parameters) {
  return [...parameters].map(([name, value]) => `${encode(name)}=${encode(value)}`).join("&");
}

/** With the '?' if there is anything to ask. */
export function query_part(parameters) {
  const text = query_text(parameters);
  return text && `?${text}`;
}

/**
 * The parameters of a picture of several layers: `layers` are {name, style}, the lowest first.
 * A layer's own are written with its name before them, unless it is alone.
 */
export function parameters_of_layers(layers, shared) {
  const own = layers.flatMap(({ name, style }) =>
    [...style].map(([key, value]) => [layers.length > 1 ? `${name}.${key}` : key, value]));
  return [...own, ...shared];
}

export function path_of_layers(layers) {
  return layers.map(({ name }) => encodeURIComponent(name)).join(",");
}

/** Commas and colons part lists, and may stand in a query as they are. */
export function encode(text) {
  return encodeURIComponent(text).replaceAll("%2C", ",").replaceAll("%3A", ":");
}
