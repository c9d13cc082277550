// Three demonstrations of features that other map servers lack, each started with one click.

import { STEPS, simplify_in_words } from "./detail_panel.js";
import { button, element, input } from "./elements.js";

const FIRST_PIXELS = 4; // a difference that is clearly visible
const PIXELS_APART = 8; // enough for wide gaps

/**
 * For the TryPanel. `act` is {simplify(pixels), compare_apart(pixels), restyle(look), looks(),
 * is_shown(look), picture_of(look): the address of a tile}; `has_apart`: polygons that share borders are
 * also served separately.
 */
export function demonstrations(act, { has_apart }) {
  return [simplify_by_slider(act), ...(has_apart ? [gapless_against_apart(act)] : []),
    restyle_by_click(act)];
}

function simplify_by_slider({ simplify }) {
  const slider = input("range", {
    min: 0, max: STEPS.length - 1, step: 1, "aria-label": "Simplify by",
  });
  const told = document.createElement("output");
  const tell = () => {
    const words = simplify_in_words(STEPS[slider.value]);
    told.textContent = words;
    slider.setAttribute("aria-valuetext", words);
  };
  slider.addEventListener("input", () => {
    tell();
    simplify(STEPS[slider.value]);
  });
  return {
    title: "Simplify with a slider",
    words: "Remove as much detail as you like: neighbours keep their shared borders.",
    start: () => {
      slider.value = STEPS.indexOf(FIRST_PIXELS);
      tell();
      simplify(FIRST_PIXELS);
    },
    control: element("label", "row slider", element("span", "", "every vertex"), slider, told),
  };
}

function gapless_against_apart({ compare_apart }) {
  return {
    title: "Shared or separate borders",
    words: "Neighbours share their borders on the left. On the right, each polygon is simplified separately.",
    start: () => compare_apart(PIXELS_APART),
    control: element("p", "hint", "Drag the handle in the middle of the map."),
  };
}

function restyle_by_click({ restyle, looks, is_shown, picture_of }) {
  const list = element("div", "looks");
  const choose = (look, chosen) => {
    for (const other of list.children) other.setAttribute("aria-pressed", String(other === chosen));
    restyle(look);
  };
  const show = () => {
    list.replaceChildren(...looks().map((look) => {
      const picture = element("img", "");
      picture.alt = "";
      picture.src = picture_of(look);
      const control = button("", { "aria-pressed": String(is_shown(look)) });
      control.append(picture, element("span", "", look.title));
      control.addEventListener("click", () => choose(look, control));
      return control;
    }));
  };
  return {
    title: "Restyle with one click",
    words: "Any style for the whole map: every tile is drawn on request.",
    start: show,
    control: list,
  };
}
