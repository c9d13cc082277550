// The style form of one layer: a control for every parameter, grouped by purpose.

import { ClassEditor } from "./class_editor.js";
import { button, element } from "./elements.js";
import { CLASS_PARAMETERS, over } from "./named_styles.js";
import { NUMBER_PARAMETERS, Numbers } from "./numbers.js";
import {
  choice_control, colour_control, number_control, switched_colour_control, text_control,
} from "./style_controls.js";

const DASHES = [["1,0", "solid"], ["6,4", "dashed"], ["1,3", "dotted"],
  ["9,3,1,3", "dash and dot"]];
const PATTERNS = ["none", "hatch", "crosshatch", "stripes", "dots", "checker"];
const UPRIGHT_PATTERNS = ["dots", "checker"];
const FIRST_STROKE = "33414f"; // friendlier than the default of a width alone:
const BUILTIN_STROKE = "000000";

const percent = (number) => `${Math.round(100 * number)}%`;
const pixels = (number) => `${number} px`;
const degrees = (number) => `${number}°`;

export class StyleForm {
  /**
   * @param layer of the catalog: {name, title, fields, locked}
   * @param builtin_fill the colour if the layer has none either
   * @param suggest returns the values of a property, see ClassEditor
   * @param on_change called without arguments when the user has changed something
   */
  constructor(layer, builtin_fill, suggest, on_change) {
    this.on_change_ = on_change;
    this.locked_ = Array.isArray(layer.locked) ? layer.locked : [];
    this.usual_ = new Map();
    this.kept_ = new Map();
    this.fill = colour_control("fill", `Colour of ${layer.title}`, builtin_fill,
      () => this.change_());
    this.make_controls_();
    this.make_groups_(layer, suggest);
    this.problem_ = element("p", "problem");
    this.problem_.setAttribute("role", "alert");
    this.node = this.make_node_();
  }

  /** The style as a Map of parameters and values, without those at their default. */
  read() {
    const style = new Map(this.kept_);
    for (const { gate, controls } of this.groups_) {
      if (gate && !gate.is_on()) {
        if (gate.is_usually_on()) style.set(...gate.off);
        continue;
      }
      for (const control of gate ? [gate.control, ...controls] : controls) {
        const { parameter, builtin, read } = control;
        const usual = this.usual_.get(parameter) ?? builtin();
        if (read() !== "" && read() !== usual) style.set(parameter, read());
      }
    }
    for (const [parameter, value] of this.changed_classes_()) style.set(parameter, value);
    return style;
  }

  /** `style` as returned by read(), on top of the `usual` one. */
  show(style, usual) {
    this.usual_ = usual;
    const shown = over(usual, style);
    if (has_outline(shown) && !shown.has("stroke")) shown.set("stroke", BUILTIN_STROKE);
    const controls = this.controls_();
    for (const { parameter, show } of controls) show(shown.get(parameter) ?? null);
    this.stroke_.switch_to(has_outline(shown));
    this.numbers_.show(shown);
    this.classes_.show(this.numbers_.is_on() ? without_classes(shown) : shown);
    this.show_gates_();
    // Parameters without a control, such as stroke-linejoin from an address, stay unchanged.
    const known = [...controls.map(({ parameter }) => parameter), ...CLASS_PARAMETERS,
      ...(this.numbers_.is_on() ? NUMBER_PARAMETERS : [])];
    this.kept_ = new Map([...style].filter(([parameter]) => !known.includes(parameter)));
    this.show_problem(null);
  }

  /** Called when the form becomes visible. */
  open() {
    this.classes_.open();
    this.numbers_.open();
  }

  /** Shows a problem reported by the server: {detail, parameter}, or null. */
  show_problem(problem) {
    this.problem_.remove();
    this.problem_.textContent = problem?.detail ?? "";
    if (problem) this.group_of_(problem.parameter).append(this.problem_);
    for (const { parameter, mark_wrong } of this.controls_()) {
      mark_wrong(parameter === problem?.parameter);
    }
    this.classes_.mark_wrong(problem?.parameter);
    this.numbers_.mark_wrong(problem?.parameter);
  }

  make_controls_() {
    const change = () => this.change_();
    this.stroke_ = switched_colour_control("stroke", "Outline", FIRST_STROKE, () => {
      // An outline that was off may have had no width.
      if (this.stroke_.is_on() && Number(this.stroke_width_.read()) === 0) {
        this.stroke_width_.show(has_outline(this.usual_) ? this.usual_.get("stroke-width") : null);
      }
      change();
    });
    this.stroke_width_ =
      number_control("stroke-width", "Width", range(0.25, 8, 0.25, 1, pixels), change);
    this.pattern_ =
      choice_control("pattern", "Pattern", PATTERNS.map((name) => [name, name]), change);
    this.pattern_angle_ = number_control("pattern-angle", "Angle", {
      min: -90, max: 90, step: 5, format: degrees,
      builtin: () => (UPRIGHT_PATTERNS.includes(this.pattern_.read()) ? 0 : 45),
    }, change);
  }

  make_groups_(layer, suggest) {
    const change = () => this.change_();
    const fields = (Array.isArray(layer.fields) ? layer.fields : [])
      .filter((field) => typeof field?.name === "string");
    // Only one of the two colours the layer.
    this.classes_ = new ClassEditor(fields, suggest, () => {
      this.numbers_.show(new Map());
      change();
    });
    this.numbers_ = new Numbers({ ...layer, fields }, () => {
      if (this.numbers_.is_on()) this.classes_.show(new Map());
      change();
    });
    this.label_ = choice_control("label", "Names",
      [["none", "none"], ...fields.map(({ name }) => [name, name])], change);
    this.filter_ = text_control("filter", "Filter", example_filter(fields[0]), () => {
      // No filter at all cannot be requested: without one, the default style's filter applies.
      if (this.filter_.read() === "") this.filter_.show(this.usual_.get("filter") ?? null);
      change();
    });
    this.groups_ = [
      {
        name: "Fill",
        controls: [
          this.fill,
          number_control("fill-opacity", "Fill opacity", range(0, 1, 0.05, 1, percent), change),
          number_control("opacity", "Opacity", range(0, 1, 0.05, 1, percent), change),
        ],
      },
      {
        name: "Outline",
        gate: {
          control: this.stroke_,
          is_on: this.stroke_.is_on,
          is_usually_on: () => has_outline(this.usual_),
          off: ["stroke-width", "0"],
        },
        controls: [
          this.stroke_width_,
          choice_control("stroke-dasharray", "Dashes", DASHES, change),
          number_control("stroke-opacity", "Line opacity", range(0, 1, 0.05, 1, percent), change),
        ],
      },
      {
        name: "Pattern",
        gate: {
          control: this.pattern_,
          is_on: () => this.pattern_.read() !== "none",
          is_usually_on: () => (this.usual_.get("pattern") ?? "none") !== "none",
          off: ["pattern", "none"],
        },
        controls: [
          colour_control("pattern-color", "Colour of pattern", "000000", change),
          number_control("pattern-size", "Size", range(2, 32, 1, 8, pixels), change),
          this.pattern_angle_,
        ],
      },
      {
        name: "Shape",
        controls: [
          ...(layer.merge > 0
            ? [number_control("merge", "Merge",
              { ...range(1, 32, 1, layer.merge, pixels), is_relative: true }, change)] : []),
          number_control("grow", "Grow", range(0, 8, 0.5, 0, pixels), change),
          number_control("smooth", "Smooth", range(0, 32, 1, 0, pixels), change),
        ],
      },
      {
        name: "Labels",
        gate: {
          control: this.label_,
          is_on: () => this.label_.read() !== "none",
          is_usually_on: () => (this.usual_.get("label") ?? "none") !== "none",
          off: ["label", "none"],
        },
        controls: [
          number_control("label-size", "Letters", range(6, 32, 1, 12, pixels), change),
          colour_control("label-color", "Colour of labels", "222222", change),
          number_control("label-overhang", "Overhang", range(0, 100, 2, 8, pixels), change),
        ],
      },
      {
        name: "Features",
        controls: [this.filter_],
      },
    ];
  }

  make_node_() {
    for (const group of this.groups_) {
      // The colour of the fill is shown beside the name of the layer.
      const shown = [group.gate?.control, ...group.controls]
        .filter((control) => control && control !== this.fill);
      group.node = fieldset(group.name, ...shown.map(({ node }) => node));
    }
    const reset = button("Reset");
    reset.addEventListener("click", () => {
      this.show(new Map(), this.usual_);
      this.on_change_();
    });
    this.class_group_ = fieldset("Classes", this.classes_.node, this.numbers_.node);
    this.disable_locked_();
    const [fill, ...others] = this.groups_.map(({ node }) => node);
    return element("div", "style-form", fill, this.class_group_, ...others, reset);
  }

  /** Requests with these parameters would be refused. */
  disable_locked_() {
    const is_locked = (parameter) => this.locked_.includes(parameter);
    for (const { gate, controls } of this.groups_) {
      if (gate && (is_locked(gate.control.parameter) || is_locked(gate.off[0]))) disable(gate.control);
      controls.filter(({ parameter }) => is_locked(parameter)).forEach(disable);
    }
    this.class_group_.disabled = CLASS_PARAMETERS.some(is_locked);
  }

  /** Pairs of parameter and value; empty if the classes are the default ones. */
  changed_classes_() {
    const pairs = this.numbers_.is_on() ? this.numbers_.read() : this.classes_.read();
    const parameters = this.numbers_.is_on() ? [...NUMBER_PARAMETERS, ...CLASS_PARAMETERS] : CLASS_PARAMETERS;
    const usual = parameters.filter((name) => this.usual_.has(name));
    const is_usual = pairs.length === usual.length &&
      pairs.every(([name, value]) => this.usual_.get(name) === value);
    if (is_usual) return [];
    if (pairs.length > 0) return pairs;
    // Classes were removed although the default style has some: uses one class for all features.
    return [["color-by", this.usual_.get("color-by")], ["classes", `*:${this.fill.read()}`]];
  }

  controls_() {
    return this.groups_.flatMap(({ gate, controls }) =>
      (gate ? [gate.control, ...controls] : controls));
  }

  /** The group that contains the parameter; the last group if it has no control. */
  group_of_(parameter) {
    if ([...CLASS_PARAMETERS, ...NUMBER_PARAMETERS].includes(parameter)) return this.class_group_;
    const found = this.groups_.find(({ gate, controls }) =>
      [gate?.control, ...controls].some((control) => control?.parameter === parameter));
    return (found ?? this.groups_.at(-1)).node;
  }

  show_gates_() {
    for (const { gate, controls } of this.groups_) {
      for (const { node } of controls) if (gate) node.hidden = !gate.is_on();
    }
  }

  change_() {
    this.pattern_angle_.refresh(); // its default may depend on the pattern
    this.show_gates_();
    this.on_change_();
  }
}

function disable({ node }) {
  for (const control of node.querySelectorAll("input, select")) control.disabled = true;
}

function range(min, max, step, builtin, format) {
  return { min, max, step, builtin: () => builtin, format };
}

function has_outline(style) {
  if (!style.has("stroke") && !style.has("stroke-width")) return false;
  return Number(style.get("stroke-width") ?? 1) > 0;
}

function without_classes(style) {
  return new Map([...style].filter(([name]) => !CLASS_PARAMETERS.includes(name)));
}

function example_filter(field) {
  if (!field) return "";
  const name = /^\d|\W/.test(field.name) ? JSON.stringify(field.name) : field.name;
  return field.type === "string" ? `${name} = 'value'` : `${name} > 10`;
}

function fieldset(name, ...children) {
  const made = element("fieldset", "", ...children);
  made.setAttribute("aria-label", name);
  return made;
}
