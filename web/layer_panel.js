// One row of the list of layers: a switch, the colour, and the style form.

import { button, element, input } from "./elements.js";
import { over } from "./named_styles.js";
import { StyleForm } from "./style_form.js";

/**
 * The row of `layer`. `on` is {change({is_on, style}), called whenever the user changes something;
 * zoom_to()}; see StyleForm for the rest. Returns the element, its handle, the box that switches it on,
 * and functions that show a given state with the `usual` style, and a problem that the server reports
 * for the style.
 */
export function layer_row(layer, builtin_fill, suggest, on) {
  const title = String(layer.title || layer.name);
  const box = input("checkbox");
  // With colours by class, there is no single colour to show.
  let usual = new Map();
  const show_colour = (style) => (colour.hidden = over(usual, style).has("color-by"));
  const change = () => {
    const style = form.read();
    show_colour(style);
    on.change({ is_on: box.checked, style });
  };
  const form = new StyleForm({ ...layer, title }, builtin_fill, suggest, change);
  box.addEventListener("change", change);

  const handle = button("", { class: "handle", "aria-label": `Move ${title}` });
  const zoom = button("", { class: "zoom-to", "aria-label": `Zoom to ${title}`, title: "Zoom to it" });
  zoom.addEventListener("click", on.zoom_to);
  const colour = form.fill.node.querySelector("input");
  const summary = element("summary", "");
  summary.setAttribute("aria-label", `Style of ${title}`);
  summary.title = "Style";
  const description = element("p", "hint", String(layer.description ?? ""));
  const details = element("details", "", summary, description, form.node);
  const row = element("li", "layer",
    handle, element("label", "name", box, element("span", "", title)), zoom, colour, details);
  row.title = String(layer.description ?? "");
  details.addEventListener("toggle", () => {
    if (!details.open) return;
    form.open();
    if (show_where_wrong()) return;
    if (details.getBoundingClientRect().bottom > row.parentElement.getBoundingClientRect().bottom) {
      row.scrollIntoView({ block: "start" });
    }
  });
  /** @returns whether there is a problem */
  const show_where_wrong = () => {
    const told = form.node.querySelector(".problem");
    told?.scrollIntoView({ block: "center" });
    return told !== null;
  };
  return {
    row, handle, box, title,
    show: (state) => {
      box.checked = state.is_on;
      usual = state.usual;
      form.show(state.style, state.usual);
      show_colour(state.style);
    },
    show_problem: (problem) => {
      form.show_problem(problem);
      if (!problem) return;
      details.open = true;
      show_where_wrong();
    },
  };
}
