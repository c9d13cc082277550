// The user's own numbers in the style of a layer. The controls are loaded when they become visible, because
// few users need them.

import { element } from "./elements.js";
import { CLASS_PARAMETERS } from "./named_styles.js";

export const NUMBER_PARAMETERS = ["values", "join"];

const RULE = /^(quantile|equal|jenks|pretty|stddev)\b/;

export class Numbers {
  /** @param layer of the catalog: {name, title, fields: usable ones, title_attribute} */
  constructor(layer, on_change) {
    this.layer_ = layer;
    this.on_change_ = on_change;
    this.style_ = new Map();
    this.told_ = element("p", "hint");
    this.told_.setAttribute("role", "status");
    this.node = element("details", "numbers", element("summary", "", "Your own numbers"), this.told_);
    this.node.addEventListener("toggle", () => this.node.open && this.load_());
  }

  /** Whether the layer is coloured by numbers of a table, classified by a rule. */
  is_on() {
    return this.style_.size > 0;
  }

  /** Pairs of parameter and value. */
  read() {
    return [...this.style_];
  }

  /** `style`: a Map of parameters; one without such numbers removes them. */
  show(style) {
    const is_of_numbers = style.has("values") && style.get("color-by") === "value" &&
      RULE.test(style.get("breaks") ?? "");
    this.style_ = new Map(is_of_numbers ? [...NUMBER_PARAMETERS, ...CLASS_PARAMETERS]
      .filter((name) => style.has(name)).map((name) => [name, style.get(name)]) : []);
    this.editor_?.show(this.style_);
  }

  /** Called when the style becomes visible. */
  open() {
    if (this.is_on()) this.node.open = true;
  }

  mark_wrong(parameter) {
    this.editor_?.mark_wrong(parameter);
  }

  async load_() {
    if (this.editor_) return;
    const module = await import("./number_editor.js").catch(() => null);
    this.told_.textContent = module ? "" : "The server cannot be reached. Reload the page.";
    if (!module || this.editor_) return;
    this.editor_ = new module.NumberEditor(this.layer_, (pairs) => {
      this.style_ = new Map(pairs);
      this.on_change_();
    });
    this.editor_.show(this.style_);
    this.node.append(this.editor_.node);
  }
}
