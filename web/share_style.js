// The current style in a short form for addresses: its name, or the id under which the server stores it.

import { over } from "./named_styles.js";
import { divide_shared, over_named, taken_by, takes } from "./tile_query.js";

// The selection is not part of an exported map.
const SELECTION = ["highlight", "highlight-fill", "highlight-stroke"];

/**
 * @param drawn {name, style}, the lowest first
 * @param settings {layers: of the catalog; shared: parameters of all layers; named: document of the
 *   named style among them, else {}}
 * @returns {name: of a style, or undefined; document: for POST /styles if the style was edited, else null;
 *   styled, shared: the same as request parameters}
 */
export function shared_style(drawn, { layers, shared, named }) {
  const plain = drawn.map(({ name, style }) => ({ name, style: without(style, SELECTION) }));
  const name = shared.get("style");
  const parts = divide_shared(plain, layers, shared);
  const rest = without(new Map(parts.shared), ["style"]);
  const is_changed = rest.size > 0 || parts.styled.some(({ style }) => new Map(style).size > 0);
  return {
    name,
    document: is_changed ? without_locked(document_of(parts.styled, rest, named), plain, layers) : null,
    ...divide_shared(over_named(plain, layers, shared, named), layers, shared),
  };
}

/** `named` with the edits applied. */
function document_of(styled, shared, named) {
  const { layers: of_layers = {}, ...of_all } = named;
  const layers = {};
  for (const [name, style] of Object.entries(of_layers)) {
    layers[name] = Object.fromEntries(without(new Map(Object.entries(style)), [...shared.keys()]));
  }
  for (const { name, style } of styled) {
    const own = over(new Map(Object.entries(layers[name] ?? {})), new Map(style));
    if (own.size) layers[name] = Object.fromEntries(own);
  }
  return { ...of_all, ...Object.fromEntries(shared), layers };
}

/** What layers have locked can be set by the named style, but not by one that is posted. */
function without_locked({ layers: of_layers, ...of_all }, drawn, catalog) {
  const known = drawn.map(({ name }) => catalog.find((layer) => layer.name === name));
  const is_for_all = ([name]) => known.every((layer) => takes(layer, name));
  const of_some = Object.entries(of_all).filter((entry) => !is_for_all(entry));
  const layers = { ...of_layers };
  for (const layer of known) {
    const own = taken_by(layer, [...of_some, ...Object.entries(layers[layer.name] ?? {})]);
    if (own.length) layers[layer.name] = Object.fromEntries(own);
    else delete layers[layer.name];
  }
  return { ...Object.fromEntries(Object.entries(of_all).filter(is_for_all)), layers };
}

function without(parameters, names) {
  return new Map([...parameters].filter(([name]) => !names.includes(name)));
}

/** Posts `document` and returns its id; throws an Error with a user-readable message. */
export async function keep_style(base, document) {
  let response;
  try {
    response = await fetch(new URL("styles", base), {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(document),
    });
  } catch {
    throw new Error("The server cannot be reached.");
  }
  const told = await response.json().catch(() => null);
  if (response.ok && typeof told?.id === "string") return told.id;
  throw new Error(typeof told?.detail === "string" ? told.detail
    : `The server answered with status ${response.status}.`);
}
