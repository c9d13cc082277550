// Controls for single parameters. Each has {parameter, node, builtin, read, show, mark_wrong}: `read`
// returns the value in the syntax of the parameter. `show` accepts such a value, which may come from an
// address and is kept as written until the user changes the control. `builtin` returns the value that
// applies if neither a layer nor a style nor a query sets one; `show` with null shows it.

import { rgb_of } from "./colours.js";
import { choose, element, input, mark_wrong, select } from "./elements.js";

export function colour_control(parameter, label, builtin, on_change) {
  const picker = input("color", { "aria-label": label });
  let value = builtin;
  const control = {
    parameter,
    node: element("label", "row", label, picker),
    builtin: () => builtin,
    read: () => value,
    show: (shown) => {
      value = shown ?? builtin;
      picker.value = `#${rgb_of(value)}`;
    },
    mark_wrong: (is_wrong) => mark_wrong(picker, is_wrong),
  };
  picker.addEventListener("change", () => {
    value = picker.value.slice(1).toLowerCase();
    on_change();
  });
  return control;
}

/**
 * Like colour_control, with a box that switches the coloured item on and off; it also has {is_on,
 * switch_to}. `first`: the colour before one is picked.
 */
export function switched_colour_control(parameter, label, first, on_change) {
  const box = input("checkbox");
  const colour = colour_control(parameter, `Colour of ${label.toLowerCase()}`, first, on_change);
  const picker = colour.node.querySelector("input");
  const control = {
    ...colour,
    node: element("div", "row", element("label", "check", box, label), picker),
    builtin: () => null,
    is_on: () => box.checked,
    switch_to: (is_on) => {
      box.checked = is_on;
      picker.hidden = !is_on;
    },
    mark_wrong: (is_wrong) => mark_wrong(box, is_wrong),
  };
  box.addEventListener("change", () => {
    control.switch_to(box.checked);
    on_change();
  });
  return control;
}

/**
 * `range`: {min, max, step, builtin: a function that returns the number, format: number to text,
 * is_relative: whether the default depends on parameters of other controls, so that every chosen number
 * counts}.
 */
export function number_control(parameter, label, range, on_change) {
  const { min, max, step, builtin, format, is_relative = false } = range;
  // Without it, the accessible name would be that of the label, which contains the number, too.
  const slider = input("range", { min, max, step, "aria-label": label });
  const told = document.createElement("output");
  let value = null;
  const tell = (text) => {
    told.textContent = format(Number(text));
    slider.setAttribute("aria-valuetext", format(Number(text)));
  };
  const control = {
    parameter,
    node: element("label", "row slider", element("span", "", label), slider, told),
    builtin: () => (is_relative ? "" : String(builtin())),
    read: () => value ?? control.builtin(),
    show: (shown) => {
      value = shown;
      slider.value = value ?? builtin();
      tell(value ?? builtin());
    },
    refresh: () => control.show(value),
    mark_wrong: (is_wrong) => mark_wrong(slider, is_wrong),
  };
  // While dragged, the slider shows its number immediately; the map follows on release, because every
  // step would request a screen full of new tiles.
  slider.addEventListener("input", () => tell(slider.value));
  slider.addEventListener("change", () => {
    value = String(Number(slider.value));
    on_change();
  });
  return control;
}

/** `options`: pairs of value and text; the first is the built-in default. */
export function choice_control(parameter, label, options, on_change) {
  const list = select(options);
  const builtin = options[0][0];
  list.addEventListener("change", on_change);
  return {
    parameter,
    node: element("label", "row", label, list),
    builtin: () => builtin,
    read: () => list.value,
    show: (shown) => choose(list, shown ?? builtin),
    mark_wrong: (is_wrong) => mark_wrong(list, is_wrong),
  };
}

export function text_control(parameter, label, placeholder, on_change) {
  const field = input("text", {
    placeholder, autocomplete: "off", autocapitalize: "off", spellcheck: "false",
  });
  field.addEventListener("change", on_change);
  return {
    parameter,
    node: element("label", "row tall", label, field),
    builtin: () => "",
    read: () => field.value.trim(),
    show: (shown) => (field.value = shown ?? ""),
    mark_wrong: (is_wrong) => mark_wrong(field, is_wrong),
  };
}
