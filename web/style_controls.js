// Controls of single parameters. Each has {parameter, node, read, show, mark_wrong}: `read` gives
// the value as the parameter takes it, null for the usual one; `show` takes such a value, which may
// come from an address and is kept as it was written until the user touches the control.

import { css_of, rgb_of } from "./colours.js";
import { choose, element, input, mark_wrong, select } from "./elements.js";

/** `usual`: colour where nothing is set. */
export function colour_control(parameter, label, usual, on_change) {
  const picker = input("color", { "aria-label": label });
  let value = null;
  const control = make_control(parameter, picker, element("label", "row", label, picker), {
    read: () => value,
    show: (shown) => {
      value = shown;
      picker.value = `#${rgb_of(shown ?? usual)}`;
    },
  });
  on_user_change(picker, () => {
    const picked = picker.value.slice(1).toLowerCase();
    value = picked === rgb_of(usual) ? null : picked;
    on_change();
  });
  return control;
}

/** As colour_control, with a box that switches what the colour belongs to on and off. */
export function switched_colour_control(parameter, label, first, on_change) {
  const box = input("checkbox");
  const picker = input("color", { "aria-label": `Colour of ${label.toLowerCase()}` });
  let value = first;
  const node = element("div", "row", element("label", "check", box, label), picker);
  const control = make_control(parameter, box, node, {
    read: () => (box.checked ? value : null),
    show: (shown) => {
      box.checked = shown !== null;
      picker.hidden = !box.checked;
      value = shown ?? value;
      picker.value = `#${rgb_of(value)}`;
    },
  });
  on_user_change(box, () => {
    control.show(box.checked ? value : null);
    on_change();
  });
  on_user_change(picker, () => {
    value = picker.value.slice(1).toLowerCase();
    on_change();
  });
  return control;
}

/** `range`: {min, max, step, usual: a function that tells the number, format: number to text}. */
export function number_control(parameter, label, range, on_change) {
  const { min, max, step, usual, format } = range;
  // Else the name would be that of its label, which holds the number, too.
  const slider = input("range", { min, max, step, "aria-label": label });
  const told = document.createElement("output");
  let value = null;
  const tell = (number) => {
    told.textContent = format(number);
    slider.setAttribute("aria-valuetext", format(number));
  };
  const control = make_control(parameter, slider,
    element("label", "row slider", element("span", "", label), slider, told), {
      read: () => value,
      show: (shown) => {
        value = shown;
        slider.value = shown ?? usual();
        tell(shown === null || !Number.isFinite(Number(shown)) ? usual() : Number(shown));
      },
    });
  // A slider being dragged tells its number at once; the map follows on release, since every step
  // of it would be a screen full of new tiles.
  slider.addEventListener("input", () => tell(Number(slider.value)));
  on_user_change(slider, () => {
    value = Number(slider.value) === usual() ? null : String(Number(slider.value));
    on_change();
  });
  return control;
}

/** `options`: pairs of value and text; the first is the usual one. */
export function choice_control(parameter, label, options, on_change) {
  const list = select(options);
  const usual = options[0][0];
  const control = make_control(parameter, list, element("label", "row", label, list), {
    read: () => (list.value === usual ? null : list.value),
    show: (shown) => choose(list, shown ?? usual),
  });
  on_user_change(list, on_change);
  return control;
}

export function text_control(parameter, label, placeholder, on_change) {
  const field = input("text", {
    placeholder, autocomplete: "off", autocapitalize: "off", spellcheck: "false",
  });
  const control = make_control(parameter, field, element("label", "row tall", label, field), {
    read: () => field.value.trim() || null,
    show: (shown) => (field.value = shown ?? ""),
  });
  on_user_change(field, on_change);
  return control;
}

/** A patch of the legend or of a list, coloured as on the map. */
export function swatch(fill, opacity) {
  const patch = element("span", "swatch", element("span", "ink"));
  patch.firstChild.style.background = css_of(fill);
  patch.firstChild.style.opacity = opacity;
  return patch;
}

function make_control(parameter, target, node, { read, show }) {
  return {
    parameter,
    node,
    read,
    show,
    mark_wrong: (is_wrong) => mark_wrong(target, is_wrong),
  };
}

function on_user_change(target, act) {
  target.addEventListener("change", act);
}
