// Edits colours by the user's own numbers: a pasted table is stored by the server, joined to the layer by
// a key, and divided into classes.

import { ramp_list } from "./class_editor.js";
import { button, choose, element, mark_wrong, select } from "./elements.js";
import { columns_of, fit_in_words, post_table } from "./value_tables.js";

const VALUE = "value"; // the server's name for joined values
const WAYS = [["quantile", "quantiles"], ["equal", "equal steps"], ["jenks", "natural breaks"],
  ["pretty", "round numbers"], ["stddev", "standard deviations"]];
const COUNTS = [3, 4, 5, 6, 7, 8, 9];
const USUAL = { way: "quantile", count: "5", ramp: "YlGnBu" };
const COPIED_MS = 1500;
const LOOKING = "Looking…";

export class NumberEditor {
  /**
   * @param layer of the catalog: {name, title, fields: usable ones, title_attribute}
   * @param on_change called with pairs of parameter and value; empty if the numbers were removed
   */
  constructor(layer, on_change) {
    this.layer_ = layer;
    this.on_change_ = () => on_change(this.read_());
    this.values_ = null; // the name or id of the table
    this.made_anew_ = 0;
    this.text_ = element("textarea");
    this.text_.rows = 4;
    this.text_.placeholder = "code\tvalue\nFRA\t68.2\nDEU\t83.3";
    this.text_.spellcheck = false;
    const fields = layer.fields.map(({ name }) => [name, name]);
    this.join_ = select(fields);
    choose_usual_key(this.join_, layer);
    this.key_ = select([]);
    this.value_ = select([]);
    this.way_ = select(WAYS);
    this.count_ = select(COUNTS.map((count) => [String(count), String(count)]));
    this.ramp_ = ramp_list();
    this.show_button_ = button("Show on the map");
    this.copy_ = button("Copy the link");
    this.remove_ = button("Take away");
    this.told_ = element("p", "hint");
    this.told_.setAttribute("role", "status");
    this.node = this.make_node_();
    this.show(new Map());
    this.listen_();
  }

  is_on_() {
    return this.values_ !== null;
  }

  read_() {
    if (!this.is_on_()) return [];
    const way = this.way_.value;
    return [["values", this.values_], ...(this.joined_ ? [["join", this.joined_]] : []),
      ["color-by", VALUE], ["breaks", way === "stddev" ? way : `${way}:${this.count_.value}`],
      ["ramp", this.ramp_.value]];
  }

  /** `style`: a Map of the parameters passed to on_change; an empty one removes the numbers. */
  show(style) {
    const is_on = style.size > 0;
    if (this.values_ !== (is_on ? style.get("values") : null) || this.told_.textContent === LOOKING) {
      this.told_.textContent = "";
      ++this.made_anew_; // a table that is still being posted is not wanted any more
    }
    this.values_ = is_on ? style.get("values") : null;
    this.joined_ = style.get("join");
    if (is_on) {
      const [way, count] = style.get("breaks").split(":");
      this.way_.value = way;
      if (count) choose(this.count_, count);
      choose(this.ramp_, style.get("ramp") ?? USUAL.ramp);
      if (this.joined_) choose(this.join_, this.joined_);
    }
    this.show_parts_();
  }

  mark_wrong(parameter) {
    mark_wrong(this.text_, parameter === "values");
    mark_wrong(this.join_, parameter === "join");
  }

  make_node_() {
    const row = (words, control, kind = "row") => element("label", kind, words, control);
    this.columns_ = element("div", "part",
      row("Keys in column", this.key_), row("Values in column", this.value_));
    this.classes_ = element("div", "part",
      row("Split by", this.way_), row("Into classes", this.count_), row("Palette", this.ramp_));
    this.ends_ = element("div", "row", this.copy_, this.remove_);
    this.way_.value = USUAL.way;
    this.count_.value = USUAL.count;
    this.ramp_.value = USUAL.ramp;
    return element("div", "part",
      element("p", "hint", "Copy two columns from a spreadsheet, with their names in the first line."),
      row("Table", this.text_, "row tall"), this.columns_,
      row("Keys are in", this.join_), this.classes_, this.show_button_, this.told_, this.ends_);
  }

  listen_() {
    this.text_.addEventListener("input", () => this.show_columns_());
    this.show_button_.addEventListener("click", () => this.post_());
    for (const control of [this.way_, this.count_, this.ramp_]) {
      control.addEventListener("change", () => {
        this.show_parts_();
        if (this.is_on_()) this.on_change_();
      });
    }
    this.copy_.addEventListener("click", () => this.copy_link_());
    this.remove_.addEventListener("click", () => {
      this.show(new Map());
      this.text_.focus();
      this.on_change_();
    });
  }

  show_parts_() {
    this.count_.disabled = this.way_.value === "stddev";
    this.ends_.hidden = !this.is_on_();
    this.show_columns_();
  }

  /** The columns need to be chosen only if there are more than two. */
  show_columns_() {
    const columns = columns_of(this.text_.value);
    const fields = this.layer_.fields.map(({ name }) => name);
    const options = () => columns.map((name) => new Option(name, name));
    const chosen = [this.key_.value, this.value_.value];
    this.key_.replaceChildren(...options());
    this.value_.replaceChildren(...options());
    const [key = columns.find((name) => fields.includes(name)) ?? columns[0], value] =
      chosen.map((name) => (name !== "" && columns.includes(name) ? name : undefined));
    const others = columns.filter((name) => name !== key);
    this.key_.value = key ?? "";
    // The column of row numbers that many programs write has no name.
    this.value_.value = others.includes(value) ? value : (others.find((name) => name !== "") ?? "");
    if (key !== chosen[0] && fields.includes(key)) this.join_.value = key;
    this.columns_.hidden = columns.length <= 2;
  }

  async post_() {
    const text = this.text_.value;
    if (text.trim() === "") {
      this.told_.textContent = "Paste a table first.";
      return this.text_.focus();
    }
    // Without a name, the server takes the first column, or the second one for the values.
    const columns = Object.fromEntries([["key", this.key_.value], ["value", this.value_.value]]
      .filter(([, name]) => name !== ""));
    const number = ++this.made_anew_;
    const join = this.join_.value;
    this.told_.textContent = LOOKING;
    const { table, problem } = await post_table(document.baseURI, text, columns, this.layer_.name, join);
    if (number !== this.made_anew_) return undefined;
    this.told_.textContent = problem ?? fit_in_words(table);
    this.told_.className = problem === undefined ? "hint" : "problem";
    mark_wrong(this.text_, problem !== undefined);
    if (problem !== undefined || table.type === "string") return undefined;
    this.values_ = table.id;
    this.joined_ = join;
    this.show_parts_();
    return this.on_change_();
  }

  async copy_link_() {
    try {
      await navigator.clipboard.writeText(location.href);
      this.copy_.textContent = "Copied";
      setTimeout(() => (this.copy_.textContent = "Copy the link"), COPIED_MS);
    } catch {
      // No clipboard without a secure connection, or without permission.
      this.told_.textContent = "The link is the address of this page: copy it from there.";
    }
  }
}

/** Selects the attribute that names features, or else the first text attribute. */
function choose_usual_key(join, { fields, title_attribute }) {
  const usual = fields.find(({ name }) => name === title_attribute) ??
    fields.find(({ type }) => type === "string") ?? fields[0];
  if (usual) join.value = usual.name;
}
