// The list of layers: on or off, colour, and all that makes the style of each.

import { element, input } from "./elements.js";
import { StyleForm } from "./style_form.js";

/**
 * One row of the list for `layer`. `on_change` is called with {is_on, style} whenever the user
 * changes something; see StyleForm for the rest. Returns the element, and functions that show
 * another such state, with the `usual` style, and what the server finds wrong with the style.
 */
export function layer_row(layer, builtin_fill, suggest, on_change) {
  const title = String(layer.title || layer.name);
  const is_on = input("checkbox");
  const change = () => on_change({ is_on: is_on.checked, style: form.read() });
  const form = new StyleForm({ ...layer, title }, builtin_fill, suggest, change);
  is_on.addEventListener("change", change);

  const colour = form.fill.node.querySelector("input");
  const summary = element("summary", "", "Style");
  summary.setAttribute("aria-label", `Style of ${title}`);
  const details = element("details", "", summary, form.node);
  const row = element("li", "",
    element("label", "name", is_on, element("span", "", title)), colour, details);
  row.title = String(layer.description ?? "");
  return {
    row,
    show: (state) => {
      is_on.checked = state.is_on;
      form.show(state.style, state.usual);
    },
    show_problem: (problem) => {
      form.show_problem(problem);
      if (!problem) return;
      details.open = true;
      form.node.querySelector(".problem").scrollIntoView({ block: "nearest" });
    },
  };
}
