// The features at a place with their attributes, one of them selected.

import { parse_exactly } from "./attribute_values.js";
import { button, element } from "./elements.js";
import { tile_requests } from "./tile_requests.js";

/**
 * The features of `layers` ({name, style}, the lowest first) at a place, as drawn at `zoom`, the topmost
 * first; `catalog` has all layers. Throws an Error with a user-readable message.
 */
export async function ask_features(base, layers, catalog, shared, { lat, lon }, zoom) {
  // The limits of a tile, for the number of layers and the length of the address, apply here, too.
  const settings = {
    layers: catalog, shared, has_background: false, folder: new URL("identify/", base).pathname,
  };
  const found = await Promise.all(tile_requests(layers, settings).reverse().map(({ path, query }) =>
    ask(new URL(`identify/${path}/${lon},${lat}${query ? `${query}&` : "?"}z=${zoom}`, base))));
  return found.flat();
}

async function ask(url) {
  let response;
  try {
    response = await fetch(url);
  } catch {
    throw new Error("The server cannot be reached.");
  }
  const told = await response.text().then(parse_exactly).catch(() => null);
  if (!response.ok) {
    throw new Error(told?.detail ?? `The server answered with status ${response.status}.`);
  }
  if (!Array.isArray(told?.features)) throw new Error("The response cannot be parsed.");
  return told.features;
}

export class FeaturePanel {
  /**
   * @param node the empty element of the panel
   * @param act {choose(feature), go_to(feature), close()}; title_of(name of a layer)
   */
  constructor(node, act) {
    this.node_ = node;
    this.act_ = act;
    node.addEventListener("keydown", (event) => event.key === "Escape" && act.close());
  }

  hide() {
    this.node_.hidden = true;
  }

  show_message(text) {
    this.fill_(element("h2", "", "Features here"), [element("p", "hint", text)]);
  }

  /** `features` of a response, `chosen` one of them. */
  show(features, chosen) {
    const title = element("h2", "", this.name_of_(chosen));
    if (chosen.title) title.append(element("span", "of", this.act_.title_of(chosen.layer)));
    const parts = [this.attributes_of_(chosen)];
    if (features.length > 1) parts.unshift(this.list_of_(features, chosen));
    const go = button("Go to it");
    go.addEventListener("click", () => this.act_.go_to(chosen));
    parts.push(go);
    this.fill_(title, parts);
  }

  focus() {
    this.node_.querySelector("header button")?.focus();
  }

  fill_(title, parts) {
    const close = button("×", { "aria-label": "Close" });
    close.addEventListener("click", () => this.act_.close());
    this.node_.replaceChildren(element("header", "", title, close), ...parts);
    this.node_.hidden = false;
  }

  name_of_(feature) {
    return String(feature.title || `${this.act_.title_of(feature.layer)} ${feature.id}`);
  }

  list_of_(features, chosen) {
    const items = features.map((feature) => {
      const choose = button(this.name_of_(feature),
        { "aria-pressed": String(feature === chosen) });
      if (feature.title) choose.append(element("span", "of", this.act_.title_of(feature.layer)));
      choose.addEventListener("click", () => {
        this.act_.choose(feature);
        // The list is a new one.
        this.node_.querySelector('.found [aria-pressed="true"]')?.focus();
      });
      return element("li", "", choose);
    });
    return element("ul", "found", ...items);
  }

  attributes_of_(feature) {
    const rows = Object.entries(feature.properties ?? {}).flatMap(([name, value]) =>
      [element("dt", "", name), element("dd", "", in_words(value))]);
    if (rows.length === 0) return element("p", "hint", "No attributes.");
    return element("dl", "", ...rows);
  }
}

export function in_words(value) {
  if (value === null) return "–";
  if (typeof value !== "number" || Number.isInteger(value)) return String(value);
  return String(Number(Math.abs(value) < 1e5 ? value.toPrecision(7) : value.toFixed(2)));
}
