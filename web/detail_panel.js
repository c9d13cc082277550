// Settings for all layers: simplification, and debug rendering.

import { choose, element, input, select } from "./elements.js";

const BUILTIN = [["simplify", "0.25"], ["topology", "strict"], ["small", "dust"], ["debug", ""]];
export const STEPS = [0, 0.25, 0.5, 1, 2, 4, 8, 16, 32, 64];
const SMALL = [["dust", "as a tint"], ["keep", "a pixel large"], ["drop", "left out"]];
const COMPARISONS = [["full", "Compare with every vertex"],
  ["apart", "Compare with separate polygons"]];
const DEBUG = [["mesh", "Trapezoids"], ["vertices", "Vertices"], ["faces", "Faces"],
  ["junctions", "Junctions"], ["tile", "Tile borders"]];

/** "0.25 px", or "every vertex". */
export function simplify_in_words(pixels) {
  return pixels === 0 ? "every vertex" : `${pixels} px`;
}

export class DetailPanel {
  /**
   * `on_change` is called without arguments; `has_fast`: a layer is served with topology=fast, and
   * `has_apart`: its polygons share borders.
   */
  constructor(on_change, { has_fast, has_apart }) {
    this.simplify_ = input("range", {
      min: 0, max: STEPS.length - 1, step: 1, "aria-label": "Simplify",
    });
    this.told_ = document.createElement("output");
    this.strict_ = input("checkbox");
    this.small_ = select(SMALL);
    this.comparisons_ = COMPARISONS.map(([value]) => Object.assign(input("checkbox"), { value }));
    this.debug_ = DEBUG.map(([word]) => Object.assign(input("checkbox"), { value: word }));
    this.is_small_chosen_ = false;
    this.pixels_ = 0;
    this.usual_ = new Map();

    this.simplify_.addEventListener("input", () => this.tell_(STEPS[this.simplify_.value]));
    this.simplify_.addEventListener("change", () => (this.pixels_ = STEPS[this.simplify_.value]));
    this.small_.addEventListener("change", () => (this.is_small_chosen_ = true));
    for (const box of this.comparisons_) {
      box.addEventListener("change", () => this.compare_with_(box.checked ? box.value : null));
    }
    for (const control of [this.simplify_, this.strict_, this.small_, ...this.comparisons_,
      ...this.debug_]) {
      control.addEventListener("change", on_change);
    }
    this.node = element("div", "part",
      element("label", "row slider", element("span", "", "Simplify"), this.simplify_, this.told_),
      ...COMPARISONS.filter(([value]) => has_apart || value !== "apart").map(([, text], i) =>
        element("label", "check", this.comparisons_[i], text)),
      ...(has_fast ? [element("label", "check", this.strict_, "Borders never cross")] : []),
      element("label", "row", "Tiny shapes", this.small_),
      ...DEBUG.map(([, text], i) => element("label", "check", this.debug_[i], text)));
  }

  /**
   * {shared: Map of parameters, without those at their default; against: "full" or "apart", null if
   * nothing is compared}.
   */
  read() {
    const debug = this.debug_.filter(({ checked }) => checked).map(({ value }) => value);
    const chosen = new Map([
      ["simplify", String(this.pixels_)],
      ["topology", this.strict_.checked ? "strict" : "fast"],
      ["small", this.small_.value],
      ["debug", debug.join(",")],
    ]);
    // Where features grow, "keep" is not the default of all layers.
    const counts = (name, value) => value !== this.usual_.get(name) ||
      (name === "small" && value === "keep" && this.is_small_chosen_);
    const shared = new Map([...chosen].filter(([name, value]) => counts(name, value)));
    return { shared, against: this.comparisons_.find(({ checked }) => checked)?.value ?? null };
  }

  /** `usual` are the defaults for parameters missing in `shared`: a Map, possibly incomplete. */
  show({ shared, against }, usual) {
    this.usual_ = new Map([...BUILTIN, ...usual]);
    const shown = new Map([...this.usual_, ...shared]);
    this.pixels_ = Number(shown.get("simplify"));
    // An address may contain any number; the slider then shows the next smaller step.
    this.simplify_.value = STEPS.findLastIndex((step) => step <= this.pixels_);
    this.tell_(this.pixels_);
    this.strict_.checked = shown.get("topology") === "strict";
    choose(this.small_, shown.get("small"));
    this.is_small_chosen_ = shared.has("small");
    this.compare_with_(against);
    const debug = shown.get("debug").split(",");
    for (const box of this.debug_) box.checked = debug.includes(box.value);
  }

  /** The default of `small` may have changed with the styles of the layers. */
  show_usual_small(value) {
    this.usual_.set("small", value);
    if (!this.is_small_chosen_) choose(this.small_, value);
  }

  compare_with_(against) {
    for (const box of this.comparisons_) box.checked = box.value === against;
  }

  /** The current simplification tolerance, in pixels. */
  get pixels() {
    return this.pixels_;
  }

  tell_(pixels) {
    this.told_.textContent = simplify_in_words(pixels);
    this.simplify_.setAttribute("aria-valuetext", simplify_in_words(pixels));
  }
}
