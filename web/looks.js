// Styles that work with any layers, which "Restyle" offers in addition to the styles of the server.

import { light_colour_at } from "./colours.js";

// Land colours before water colours, the usual layer order.
const FIRST = ["eedd88", "99ddff", "bbcc33", "ffaabb", "77aadd", "ee8866", "44bb99", "aaaa00"];
const colour_at = (i) => FIRST[i] ?? light_colour_at(i);

/** Each returns the parameters of the layer at position `i`. */
const LOOKS = {
  Pastel: (i) => [["fill", colour_at(i)], ["fill-opacity", "0.75"], ["stroke", "ffffff"],
    ["stroke-width", "0.8"], ["pattern", "none"]],
  Outlines: () => [["fill", "ffffff"], ["fill-opacity", "0"], ["stroke", "2c5f7c"],
    ["stroke-width", "0.9"], ["pattern", "none"]],
  Hatched: (i) => [["fill", colour_at(i)], ["fill-opacity", "0.35"], ["stroke", "3d4a57"],
    ["stroke-width", "0.9"], ["pattern", "hatch"], ["pattern-color", "3d4a57"],
    ["pattern-size", "8"], ["pattern-angle", String(45 + 45 * (i % 4))]],
};

/**
 * All looks: {name, title, styles}, where `name` is that of a style of the server, if any, and `styles`
 * contains the parameters of each layer of the catalog, if any are set.
 * @param named names of the server's styles
 * @param usual_of returns the default style of the layer at a position: a Map of parameters
 */
export function all_looks(named, count, usual_of) {
  const layers = [...Array(count).keys()];
  return [
    { title: "Default", styles: [] },
    ...named.map((name) => ({ name, title: capitalised(name), styles: [] })),
    ...Object.entries(LOOKS).map(([title, look]) => ({
      title, styles: layers.map((i) => with_one_colour(new Map(look(i)), usual_of(i))),
    })),
  ];
}

/** Replaces colours by class in the default style by the single fill. */
function with_one_colour(style, usual) {
  if (!usual.has("color-by")) return style;
  return new Map([...style, ["color-by", usual.get("color-by")],
    ["classes", `*:${style.get("fill")}`]]);
}

function capitalised(name) {
  const words = name.replaceAll(/[_-]+/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}
