// The server's response for a style: its legend entries, or its problem.

import { css_of } from "./colours.js";
import { element } from "./elements.js";
import { parameters_of_layers, query_part } from "./tile_query.js";

const LINE = "var(--pattern) 0 1px, transparent 1px 5px";
const PATTERNS = {
  hatch: [`repeating-linear-gradient(-45deg, ${LINE})`],
  crosshatch: [`repeating-linear-gradient(-45deg, ${LINE})`,
    `repeating-linear-gradient(45deg, ${LINE})`],
  stripes: ["repeating-linear-gradient(-45deg, var(--pattern) 0 3px, transparent 3px 6px)"],
  dots: ["radial-gradient(circle, var(--pattern) 1.2px, transparent 1.7px) 0 0 / 5px 5px"],
  checker: ["conic-gradient(var(--pattern) 25%, transparent 0 50%, var(--pattern) 0 75%, " +
    "transparent 0) 0 0 / 8px 8px"],
};

const MOST_NAMED = 3; // names in one row
const LOOK = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity"];

/**
 * Requests the legend of one layer in a style, on top of the named style `under`, if any. This also
 * validates a style before tiles are requested. @returns {entries, and values_title: the title of the
 * joined values, if they colour the layer} or {problem: {detail, parameter}}; neither if there is no
 * response.
 */
export async function ask_legend(base, name, style, under) {
  const parameters = parameters_of_layers([{ name, style }], under ? [["style", under]] : []);
  let response;
  try {
    response = await fetch(new URL(`legend/${encodeURIComponent(name)}.json${query_part(parameters)}`,
      base));
    const told = await response.json();
    if (response.ok && Array.isArray(told?.layers?.[0]?.entries)) {
      const { entries, values_title } = told.layers[0];
      return { entries, values_title };
    }
    if (response.status >= 400 && response.status < 500) {
      const detail = String(told?.detail ?? told?.title);
      const parameter = String(told?.parameter ?? "");
      const prefix = `${name}.`;
      return {
        problem: { detail, parameter: parameter.startsWith(prefix) ? parameter.slice(prefix.length) : parameter },
      };
    }
  } catch {
    // The tile requests will show whether the server is there.
  }
  return {};
}

/**
 * The legend section of one layer: the server's `entries`, grouped by look; `style` supplies properties
 * that they do not contain.
 * @param layer {title, and title_attribute, whose values each identify one feature}
 */
export function legend_section({ title, title_attribute }, entries, style) {
  if (entries.length <= 1) {
    return element("ul", "", ...entries.map((entry) => row_of(entry, title, style)));
  }
  const are_names = title_attribute !== undefined && style.get("color-by") === title_attribute;
  const noun = are_names ? title.toLowerCase() : "values";
  const rows = alike(entries).map((group) => {
    const names = group.map(({ label }) => String(label));
    if (names.length <= MOST_NAMED) return row_of(group[0], names.join(", "), style);
    return row_of(group[0], folded(`${names.length} ${noun}`, names.join(", ")), style);
  });
  return element("section", "", element("h2", "", title), element("ul", "", ...rows));
}

/** Entries in their order, grouped by look. */
function alike(entries) {
  const groups = new Map();
  for (const entry of entries) {
    const key = JSON.stringify(entry, LOOK);
    groups.set(key, [...(groups.get(key) ?? []), entry]);
  }
  return [...groups.values()];
}

function folded(words, names) {
  const summary = element("summary", "", words);
  const details = element("details", "", summary, element("p", "hint", names));
  details.title = names;
  return details;
}

function row_of(entry, text, style) {
  const shown = typeof text === "string" ? element("span", "", text) : text;
  return element("li", "", patch_of(entry, style), shown);
}

function patch_of(entry, style) {
  const ink = element("span", "ink");
  ink.style.background = css_of(String(entry.fill));
  ink.style.opacity = entry["fill-opacity"];
  const patch = element("span", "swatch", ink);
  const pattern = PATTERNS[style.get("pattern")];
  if (pattern) patch.append(pattern_of(pattern, style));
  if (entry.stroke) {
    const width = Math.min(Math.max(entry["stroke-width"], 1), 3);
    patch.style.border = `${width}px ${line_of(style)} ${css_of(String(entry.stroke))}`;
  }
  return patch;
}

function pattern_of(pattern, style) {
  const ink = element("span", "ink");
  ink.style.setProperty("--pattern", css_of(style.get("pattern-color") ?? "000"));
  ink.style.background = pattern.join(", ");
  ink.style.opacity = style.get("opacity") ?? 1;
  return ink;
}

function line_of(style) {
  return style.has("stroke-dasharray") ? "dashed" : "solid";
}
