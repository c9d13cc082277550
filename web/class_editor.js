// Edits colours by attribute: the property, and either a list of values with colours, or breaks with a ramp.

import { WAYS } from "./class_breaks.js";
import { can_be_class, format_classes, parse_classes } from "./class_list.js";
import { CLASS_COLOURS, COLOUR_OF_OTHERS, light_colour_at, rgb_of } from "./colours.js";
import { button, choose, element, input, mark_wrong, select } from "./elements.js";

// The sequential and diverging ColorBrewer ramps, which can be interpolated to any number of classes. All
// but the last ones are safe for red-green colour blindness.
const RAMPS = [
  ["Light to dark", ["YlGnBu", "YlOrRd", "Blues", "Greens", "Oranges", "Purples", "Reds", "Greys",
    "BuGn", "BuPu", "GnBu", "OrRd", "PuBu", "PuBuGn", "PuRd", "RdPu", "YlGn", "YlOrBr"]],
  ["Diverging", ["BrBG", "PiYG", "PRGn", "PuOr", "RdBu", "RdYlBu"]],
  ["Not colour-blind safe", ["RdGy", "RdYlGn", "Spectral"]],
];
const BY_VALUE = "values";
const BY_RANGE = "ranges";
const WAYS_IN_WORDS = [["quantiles", "quantiles"], ["equal", "equal steps"],
  ["natural", "natural breaks"]];
const COUNTS = [3, 4, 5, 6, 7, 8, 9];
const USUAL_COUNT = 5;
const FROM = [["view", "the current view"], ["all", "the whole layer"]];

export class ClassEditor {
  /**
   * @param fields of the layer: {name, type: "string"|"integer"|"number"}
   * @param suggest async; takes a field name and whether to use the whole layer instead of the current
   *   view; returns {values, quantiles} as ask_values() does
   */
  constructor(fields, suggest, on_change) {
    this.fields_ = fields;
    this.suggest_ = suggest;
    this.asked_ = 0;
    this.on_change_ = on_change;
    this.classes_ = [];
    this.is_open_ = false;
    this.property_ = select([["", "One colour"], ...fields.map(({ name }) => [name, name])]);
    this.way_ = select([[BY_RANGE, "by range"], [BY_VALUE, "by value"]],
      { "aria-label": "Classes by" });
    this.breaks_ = input("text", { placeholder: "10, 100, 1000", inputmode: "decimal" });
    this.ramp_ = ramp_list();
    this.part_by_ = select(WAYS_IN_WORDS);
    this.count_ = select(COUNTS.map((count) => [String(count), String(count)]));
    this.count_.value = String(USUAL_COUNT);
    this.from_ = select(FROM);
    this.rows_ = element("ul", "classes");
    this.hint_ = element("p", "hint");
    this.hint_.setAttribute("role", "status");
    this.node = this.make_node_();
    this.listen_();
  }

  /** Pairs of parameter and value; empty while there are no classes. */
  read() {
    const property = this.property_.value;
    if (property === "") return [];
    if (this.is_by_range_()) {
      const breaks = this.breaks_.value.replaceAll(/[\s;,]+/g, ",").replace(/^,|,$/g, "");
      if (breaks === "") return [];
      return [["color-by", property], ["breaks", breaks], ["ramp", this.ramp_.value]];
    }
    const named = this.classes_.filter(({ is_new, value }) => !is_new || value !== "");
    if (named.length === 0) return [];
    return [["color-by", property], ["classes", format_classes(named)]];
  }

  /** `style`: a Map of parameters. */
  show(style) {
    ++this.asked_; // a suggestion that is on its way must not replace this style
    choose(this.property_, style.get("color-by") ?? "");
    this.breaks_.value = style.get("breaks") ?? "";
    choose(this.ramp_, style.get("ramp") ?? this.ramp_.options[0].value);
    this.classes_ = parse_classes(style.get("classes") ?? "") ?? [];
    this.way_.value = style.has("classes") ? BY_VALUE : BY_RANGE;
    this.show_parts_();
    this.show_rows_();
  }

  /** Called when the editor becomes visible; until then, building hundreds of rows would be wasted. */
  open() {
    if (this.is_open_) return;
    this.is_open_ = true;
    this.show_rows_();
  }

  mark_wrong(parameter) {
    mark_wrong(this.property_, parameter === "color-by");
    mark_wrong(this.breaks_, parameter === "breaks");
    mark_wrong(this.ramp_, parameter === "ramp");
  }

  is_by_range_() {
    return this.is_of_numbers_() && this.way_.value === BY_RANGE;
  }

  is_of_numbers_() {
    const field = this.fields_.find(({ name }) => name === this.property_.value);
    // Joined values are not a field, and the catalogue does not tell their type; only numbers have breaks.
    return field === undefined ? this.breaks_.value !== "" : field.type !== "string";
  }

  make_node_() {
    this.by_range_ = element("div", "part",
      element("label", "row", "Part by", this.part_by_),
      element("label", "row", "Classes", this.count_),
      element("label", "row tall", "Breaks", this.breaks_),
      element("label", "row", "Ramp", this.ramp_));
    this.add_ = button("Add a class");
    this.by_value_ = element("div", "part", this.rows_, this.add_);
    this.suggest_button_ = button("Suggest from map");
    this.body_ = element("div", "part", this.way_, this.by_range_, this.by_value_,
      element("label", "row", "From", this.from_), this.suggest_button_, this.hint_);
    return element("div", "", element("label", "row", "Colour by", this.property_), this.body_);
  }

  listen_() {
    this.property_.addEventListener("change", () => this.change_property_());
    this.way_.addEventListener("change", () => {
      this.show_parts_();
      this.on_change_();
    });
    this.breaks_.addEventListener("change", () => this.on_change_());
    this.ramp_.addEventListener("change", () => this.on_change_());
    for (const control of [this.part_by_, this.count_, this.from_]) {
      control.addEventListener("change", () => this.suggest_classes_());
    }
    this.suggest_button_.addEventListener("click", () => this.suggest_classes_());
    this.add_.addEventListener("click", () => {
      const used = new Set(this.classes_.map(({ colour }) => colour));
      let position = 0;
      while (used.has(light_colour_at(position))) position++;
      this.classes_.push({ kind: "value", value: "", colour: light_colour_at(position), is_new: true });
      this.show_rows_();
      this.rows_.lastElementChild.querySelector("input").focus();
    });
  }

  change_property_() {
    this.classes_ = [];
    this.breaks_.value = "";
    this.way_.value = BY_RANGE;
    this.show_parts_();
    this.show_rows_();
    if (this.property_.value === "") this.on_change_();
    else this.suggest_classes_();
  }

  async suggest_classes_() {
    const property = this.property_.value;
    const asked = ++this.asked_; // responses may arrive out of order
    this.hint_.textContent = "Looking…";
    const { values, quantiles } = await this.suggest_(property, this.from_.value === "all");
    if (this.property_.value !== property || asked !== this.asked_) return;
    const found = values.map(({ value }) => value).filter(can_be_class);
    this.hint_.textContent = found.length ? "" : "There are no values in view for classes.";
    if (found.length === 0) return this.on_change_();
    if (this.is_by_range_()) this.breaks_.value = this.breaks_of_(quantiles).join(", ");
    else this.classes_ = classes_of(found);
    this.show_rows_();
    this.on_change_();
  }

  breaks_of_(quantiles) {
    const breaks = WAYS[this.part_by_.value](quantiles, Number(this.count_.value));
    return breaks.length ? breaks : quantiles.slice(0, 1); // all values are equal
  }

  show_parts_() {
    this.body_.hidden = this.property_.value === "";
    this.way_.hidden = !this.is_of_numbers_();
    this.by_range_.hidden = !this.is_by_range_();
    this.by_value_.hidden = this.is_by_range_();
    this.hint_.textContent = "";
  }

  show_rows_() {
    if (!this.is_open_) return;
    this.rows_.replaceChildren(...this.classes_.map((wanted, i) => this.row_of_(wanted, i)));
  }

  row_of_(wanted, i) {
    const name = { others: "all others", null: "no value" }[wanted.kind];
    const value = input("text", { "aria-label": `Value of class ${i + 1}` });
    value.value = name ?? wanted.value;
    value.readOnly = name !== undefined;
    value.addEventListener("change", () => {
      wanted.value = value.value;
      this.on_change_();
    });
    const colour = input("color", { "aria-label": `Colour of ${value.value || `class ${i + 1}`}` });
    colour.value = `#${rgb_of(wanted.colour)}`;
    colour.addEventListener("change", () => {
      wanted.colour = colour.value.slice(1).toLowerCase();
      this.on_change_();
    });
    const remove = button("×", { "aria-label": `Remove ${value.value || `class ${i + 1}`}` });
    remove.addEventListener("click", () => {
      this.classes_.splice(i, 1);
      this.show_rows_();
      this.add_.focus();
      this.on_change_();
    });
    return element("li", "", value, colour, remove);
  }
}

function classes_of(values) {
  const classes = values.slice(0, CLASS_COLOURS.length).map((value, i) =>
    ({ kind: "value", value: String(value), colour: CLASS_COLOURS[i] }));
  return [...classes, { kind: "others", value: "", colour: COLOUR_OF_OTHERS }];
}

/** A select element with all ramps. */
export function ramp_list() {
  const list = select([]);
  for (const [label, names] of RAMPS) {
    const group = element("optgroup", "", ...names.map((name) => new Option(name, name)));
    group.label = label;
    list.append(group);
  }
  return list;
}
