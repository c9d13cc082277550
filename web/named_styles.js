// The named styles of the server, and the default style of a layer: its own style, overridden by the
// named one.

import { SHARED_PARAMETERS } from "./tile_query.js";

// These only make sense together.
export const CLASS_PARAMETERS = ["color-by", "classes", "breaks", "ramp"];

/** The names of the styles in the configuration; [] if the server does not return them. */
export async function load_style_names(base) {
  const told = await ask(new URL("styles", base));
  return Array.isArray(told?.styles) ? told.styles.filter((name) => typeof name === "string") : [];
}

/** The document of a style; {} for no name or no response, null if the server has no style of that name. */
export async function load_style(base, name) {
  if (name === undefined) return {};
  return ask(new URL(`styles/${encodeURIComponent(name)}`, base), {});
}

async function ask(url, otherwise = null) {
  try {
    const response = await fetch(url);
    if (response.status === 404) return null;
    return response.ok ? await response.json() : otherwise;
  } catch {
    return otherwise;
  }
}

/** The default style of a layer of the catalog: a Map of parameters. */
export function usual_style(layer, named) {
  const { layers, ...of_all } = named;
  const usual = over(parameters_in(layer.style), parameters_in(of_all));
  return over(usual, parameters_in(layers?.[layer.name]));
}

/** The parameters that a named style sets for all layers. */
export function usual_shared(named) {
  const all = parameters_in(named);
  return new Map(SHARED_PARAMETERS.filter((name) => all.has(name)).map((name) =>
    [name, all.get(name)]));
}

/** `lower` overridden by `upper`; class parameters are replaced as a group. */
export function over(lower, upper) {
  const has_classes = CLASS_PARAMETERS.some((name) => upper.has(name));
  const kept = [...lower].filter(([name]) => !has_classes || !CLASS_PARAMETERS.includes(name));
  return new Map([...kept, ...upper]);
}

function parameters_in(document) {
  const is_value = (value) => typeof value === "string" || Number.isFinite(value);
  return new Map(Object.entries(document ?? {}).filter(([, value]) => is_value(value))
    .map(([name, value]) => [name, String(value).replace(/^#/, "")]));
}
