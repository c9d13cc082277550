// The style of one layer: a control for every parameter, told apart by what it is for.

import { ClassEditor } from "./class_editor.js";
import { button, element } from "./elements.js";
import {
  choice_control, colour_control, number_control, switched_colour_control, text_control,
} from "./style_controls.js";

const DASHES = [["none", "solid"], ["6,4", "dashed"], ["1,3", "dotted"], ["9,3,1,3", "dash and dot"]];
const PATTERNS = ["none", "hatch", "crosshatch", "stripes", "dots", "checker"];
const UPRIGHT_PATTERNS = ["dots", "checker"];
const FIRST_STROKE = "33414f";
const CLASS_PARAMETERS = ["color-by", "classes", "breaks", "ramp"];

const percent = (number) => `${Math.round(100 * number)}%`;
const pixels = (number) => `${number} px`;
const degrees = (number) => `${number}°`;

export class StyleForm {
  /**
   * @param layer of the catalog: {name, title, fields}
   * @param usual {fill, opacity} where nothing is set
   * @param suggest of the name of a property: values that stand in the view
   * @param on_change called without arguments when the user has changed something
   */
  constructor(layer, usual, suggest, on_change) {
    this.on_change_ = on_change;
    this.fill = colour_control("fill", `Colour of ${layer.title}`, usual.fill,
      () => this.change_());
    this.make_groups_(layer, usual, suggest);
    this.kept_ = new Map();
    this.problem_ = element("p", "problem");
    this.problem_.setAttribute("role", "alert");
    this.node = this.make_node_();
    this.show(new Map());
  }

  /** The style as a Map of parameters and values, without those that have their usual value. */
  read() {
    const style = new Map(this.kept_);
    for (const { gate, controls } of this.groups_) {
      if (gate && gate.read() === null) continue;
      for (const { parameter, read } of [gate, ...controls].filter(Boolean)) {
        if (read() !== null) style.set(parameter, read());
      }
    }
    for (const [parameter, value] of this.classes_.read()) style.set(parameter, value);
    return style;
  }

  show(style) {
    const controls = this.controls_();
    for (const { parameter, show } of controls) show(style.get(parameter) ?? null);
    this.classes_.show(style);
    this.show_gates_();
    // What has no control here, such as stroke-linejoin of an address, stays as it is.
    const known = [...controls.map(({ parameter }) => parameter), ...CLASS_PARAMETERS];
    this.kept_ = new Map([...style].filter(([parameter]) => !known.includes(parameter)));
    this.show_problem(null);
  }

  /** What the server found wrong: {detail, parameter}, or null. */
  show_problem(problem) {
    this.problem_.remove();
    this.problem_.textContent = problem?.detail ?? "";
    if (problem) this.group_of_(problem.parameter).append(this.problem_);
    for (const { parameter, mark_wrong } of this.controls_()) {
      mark_wrong(parameter === problem?.parameter);
    }
    this.classes_.mark_wrong(problem?.parameter);
  }

  make_groups_(layer, usual, suggest) {
    const change = () => this.change_();
    const range = (min, max, step, number, format) =>
      ({ min, max, step, usual: () => number, format });
    const fields = (Array.isArray(layer.fields) ? layer.fields : [])
      .filter((field) => typeof field?.name === "string");
    this.classes_ = new ClassEditor(fields, suggest, change);
    const pattern =
      choice_control("pattern", "Pattern", PATTERNS.map((name) => [name, name]), change);
    this.pattern_angle_ = number_control("pattern-angle", "Angle", {
      min: -90, max: 90, step: 5, format: degrees,
      usual: () => (UPRIGHT_PATTERNS.includes(pattern.read()) ? 0 : 45),
    }, change);
    this.groups_ = [
      {
        name: "Fill",
        controls: [
          this.fill,
          number_control("fill-opacity", "Fill opacity",
            range(0, 1, 0.05, usual.opacity, percent), change),
          number_control("opacity", "Opacity", range(0, 1, 0.05, 1, percent), change),
        ],
      },
      {
        name: "Outline",
        gate: switched_colour_control("stroke", "Outline", FIRST_STROKE, change),
        controls: [
          number_control("stroke-width", "Width", range(0.25, 8, 0.25, 1, pixels), change),
          choice_control("stroke-dasharray", "Dashes", DASHES, change),
          number_control("stroke-opacity", "Line opacity", range(0, 1, 0.05, 1, percent), change),
        ],
      },
      {
        name: "Pattern",
        gate: pattern,
        controls: [
          colour_control("pattern-color", "Colour of pattern", "000000", change),
          number_control("pattern-size", "Size", range(2, 32, 1, 8, pixels), change),
          this.pattern_angle_,
        ],
      },
      { name: "Features", controls: [text_control("filter", "Filter", example_filter(fields[0]), change)] },
    ];
  }

  make_node_() {
    for (const made of this.groups_) {
      // The colour of the fill is shown beside the name of the layer.
      const shown = [made.gate, ...made.controls].filter((control) => control && control !== this.fill);
      made.node = fieldset(made.name, ...shown.map(({ node }) => node));
    }
    const reset = button("Back to the usual style");
    reset.addEventListener("click", () => {
      this.show(new Map());
      this.on_change_();
    });
    this.class_group_ = fieldset("Classes", this.classes_.node);
    const [fill, ...others] = this.groups_.map(({ node }) => node);
    return element("div", "style-form", fill, this.class_group_, ...others, reset);
  }

  controls_() {
    return this.groups_.flatMap(({ gate, controls }) => (gate ? [gate, ...controls] : controls));
  }

  /** Where the parameter is set; the last group if it has no control. */
  group_of_(parameter) {
    if (CLASS_PARAMETERS.includes(parameter)) return this.class_group_;
    const found = this.groups_.find(({ gate, controls }) =>
      [gate, ...controls].some((control) => control?.parameter === parameter));
    return (found ?? this.groups_.at(-1)).node;
  }

  show_gates_() {
    for (const { gate, controls } of this.groups_) {
      for (const { node } of controls) if (gate) node.hidden = gate.read() === null;
    }
  }

  change_() {
    this.show_gates_();
    this.pattern_angle_.show(this.pattern_angle_.read()); // its usual value depends on the pattern
    this.on_change_();
  }
}

function example_filter(field) {
  if (!field) return "";
  return field.type === "string" ? `${field.name} = 'value'` : `${field.name} > 10`;
}

function fieldset(name, ...children) {
  const made = element("fieldset", "", ...children);
  made.setAttribute("aria-label", name);
  return made;
}
