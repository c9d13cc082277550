// The values of an attribute, as counted by the server for the current view or a whole layer.

import { query_part } from "./tile_query.js";

/**
 * Returns {values: [{value, count}], the most frequent first, with integers beyond 2^53 as strings;
 * quantiles: ascending, for numbers, else []}.
 * Both are empty if there are no values or no response.
 * @param box in degrees; null: the whole layer
 */
export async function ask_values(base, layer, attribute, box, style) {
  const parameters = [...(box ? [["bbox", box.map((degrees) => degrees.toFixed(6)).join(",")]] : []),
    ...style];
  const path = `values/${encodeURIComponent(layer)}/${encodeURIComponent(attribute)}`;
  const told = await fetch(new URL(path + query_part(parameters), base))
    .then((response) => (response.ok ? response.text() : "null")).then(parse_exactly).catch(() => null);
  return {
    values: Array.isArray(told?.values) ? told.values : [],
    quantiles: Array.isArray(told?.quantiles) ? told.quantiles.map(Number).filter(Number.isFinite) : [],
  };
}

const TEXT_OR_NUMBER = /"(?:[^"\\]|\\.)*"|-?\d[\d.eE+-]*/g;

/** Like JSON.parse(), but integers that a number cannot hold exactly become strings. */
export function parse_exactly(text) {
  return JSON.parse(text.replaceAll(TEXT_OR_NUMBER, (found) =>
    (/^-?\d{16,}$/.test(found) && !Number.isSafeInteger(Number(found)) ? `"${found}"` : found)));
}
