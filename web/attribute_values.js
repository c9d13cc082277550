// The values of an attribute, of what is in view or of all of a layer, as the server counts them.

import { query_part } from "./tile_query.js";

/**
 * {values: [{value, count}], the commonest first; quantiles: of numbers, ascending, else []}; both are
 * empty where there is nothing, or no answer.
 * @param box in degrees; null: all of the layer
 */
export async function ask_values(base, layer, attribute, box, style) {
  const parameters = [...(box ? [["bbox", box.map((degrees) => degrees.toFixed(6)).join(",")]] : []),
    ...style];
  const path = `values/${encodeURIComponent(layer)}/${encodeURIComponent(attribute)}`;
  const told = await fetch(new URL(path + query_part(parameters), base))
    .then((response) => (response.ok ? response.json() : null)).catch(() => null);
  return {
    values: Array.isArray(told?.values) ? told.values : [],
    quantiles: Array.isArray(told?.quantiles) ? told.quantiles.filter(Number.isFinite) : [],
  };
}
