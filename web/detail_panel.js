// What holds for all layers: how far they are simplified, and what is drawn to look inside.

import { choose, element, input, select } from "./elements.js";

const USUAL_SIMPLIFY = 0.25;
const STEPS = [0, USUAL_SIMPLIFY, 0.5, 1, 2, 4, 8, 16, 32, 64];
const SMALL = [["dust", "as a tint"], ["keep", "a pixel large"], ["drop", "left out"]];
const DEBUG = [["mesh", "Trapezoids"], ["vertices", "Vertices"], ["tile", "Borders of tiles"]];

/** "0.25 px", or in words that nothing is left out. */
export function simplify_in_words(pixels) {
  return pixels === 0 ? "every vertex" : `${pixels} px`;
}

export class DetailPanel {
  /** `on_change` is called without arguments. */
  constructor(on_change) {
    this.simplify_ = input("range", {
      min: 0, max: STEPS.length - 1, step: 1, "aria-label": "Simplify",
    });
    this.told_ = document.createElement("output");
    this.strict_ = input("checkbox");
    this.small_ = select(SMALL);
    this.compare_ = input("checkbox");
    this.debug_ = DEBUG.map(([word]) => Object.assign(input("checkbox"), { value: word }));
    this.pixels_ = USUAL_SIMPLIFY;

    this.simplify_.addEventListener("input", () => this.tell_(STEPS[this.simplify_.value]));
    this.simplify_.addEventListener("change", () => (this.pixels_ = STEPS[this.simplify_.value]));
    for (const control of [this.simplify_, this.strict_, this.small_, this.compare_,
      ...this.debug_]) {
      control.addEventListener("change", on_change);
    }
    this.node = element("div", "part",
      element("label", "row slider", element("span", "", "Simplify"), this.simplify_, this.told_),
      element("label", "check", this.compare_, "Compare with every vertex"),
      element("label", "check", this.strict_, "Borders never cross"),
      element("label", "row", "Too small", this.small_),
      ...DEBUG.map(([, text], i) => element("label", "check", this.debug_[i], text)));
  }

  /** {shared: Map of parameters, without those that have their usual value; is_comparing}. */
  read() {
    const shared = new Map();
    if (this.pixels_ !== USUAL_SIMPLIFY) shared.set("simplify", String(this.pixels_));
    if (!this.strict_.checked) shared.set("topology", "fast");
    if (this.small_.value !== SMALL[0][0]) shared.set("small", this.small_.value);
    const debug = this.debug_.filter(({ checked }) => checked).map(({ value }) => value);
    if (debug.length) shared.set("debug", debug.join(","));
    return { shared, is_comparing: this.compare_.checked };
  }

  show({ shared, is_comparing }) {
    this.pixels_ = Number(shared.get("simplify") ?? USUAL_SIMPLIFY);
    // An address may hold any number; the slider then stands at the next smaller step.
    this.simplify_.value = STEPS.findLastIndex((step) => step <= this.pixels_);
    this.tell_(this.pixels_);
    this.strict_.checked = shared.get("topology") !== "fast";
    choose(this.small_, shared.get("small") ?? SMALL[0][0]);
    this.compare_.checked = is_comparing;
    const debug = (shared.get("debug") ?? "").split(",");
    for (const box of this.debug_) box.checked = debug.includes(box.value);
  }

  tell_(pixels) {
    this.told_.textContent = simplify_in_words(pixels);
    this.simplify_.setAttribute("aria-valuetext", simplify_in_words(pixels));
  }
}
