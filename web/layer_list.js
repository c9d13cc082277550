// The list of layers, the topmost first, under group headings, with search, switches for groups, and
// reordering.

import { button, element, input } from "./elements.js";
import { make_movable } from "./row_order.js";

const FEW = 3; // up to so many can be switched one by one
const AT_A_GLANCE = 8; // up to so many need no search

export class LayerList {
  /**
   * @param tools, list empty elements of the page
   * @param layers of the catalog
   * @param rows from layer_row(), one per layer
   * @param on {switch_all(layer numbers, is_on), zoom_to(numbers), reorder(numbers, the lowest first)}
   */
  constructor(tools, list, layers, rows, on) {
    this.list_ = list;
    this.layers_ = layers;
    this.rows_ = rows;
    this.on_ = on;
    this.order_ = [];
    this.make_tools_(tools);
    rows.forEach(({ handle }) => (handle.hidden = rows.length < 2));
    make_movable(list, () => this.seen_().map((i) => rows[i].row), (row, other) =>
      this.move_(this.number_of_(row), this.number_of_(other)));
  }

  /** `order`: the numbers of all layers, the lowest first. */
  show_order(order) {
    this.order_ = order;
    this.groups_ = [];
    const items = [];
    let last = "";
    for (const i of [...order].reverse()) {
      const name = String(this.layers_[i].group ?? "");
      if (name !== last) items.push(this.start_group_(name || "Other layers"));
      this.groups_.at(-1)?.numbers.push(i);
      items.push(this.rows_[i].row);
      last = name;
    }
    this.list_.replaceChildren(...items);
    this.filter_();
    this.show_groups();
  }

  /** Updates the group boxes after layers were switched on or off. */
  show_groups() {
    for (const { box, numbers } of this.groups_) {
      const on = numbers.filter((i) => this.rows_[i].box.checked).length;
      box.checked = on === numbers.length;
      box.indeterminate = on > 0 && on < numbers.length;
    }
  }

  make_tools_(tools) {
    this.search_ = input("search", { placeholder: "Find a layer", "aria-label": "Find a layer" });
    this.search_.addEventListener("input", () => this.filter_());
    this.told_ = element("p", "hint");
    this.told_.setAttribute("role", "status");
    this.moved_ = element("p", "unseen");
    this.moved_.setAttribute("role", "status");
    const all = (text, is_on) => {
      const control = button(text);
      control.addEventListener("click", () => this.on_.switch_all(this.seen_(), is_on));
      return control;
    };
    const count = this.layers_.length;
    if (count > AT_A_GLANCE) tools.append(this.search_);
    if (count > FEW) tools.append(all("All on", true), all("All off", false));
    tools.append(this.told_, this.moved_);
    tools.hidden = count <= FEW;
  }

  start_group_(name) {
    const group = { numbers: [] };
    const box = input("checkbox");
    box.addEventListener("change", () => this.on_.switch_all(group.numbers, box.checked));
    const zoom = button("", { class: "zoom-to", "aria-label": `Zoom to ${name}`, title: "Zoom to it" });
    zoom.addEventListener("click", () => this.on_.zoom_to(group.numbers));
    group.box = box;
    group.row = element("li", "group", element("label", "", box, element("span", "", name)), zoom);
    this.groups_.push(group);
    return group.row;
  }

  filter_() {
    const words = this.search_.value.toLowerCase().split(/\s+/).filter(Boolean);
    this.layers_.forEach((layer, i) => {
      const text = [this.rows_[i].title, layer.name, layer.group ?? ""].join(" ").toLowerCase();
      this.rows_[i].row.hidden = !words.every((word) => text.includes(word));
    });
    for (const { row, numbers } of this.groups_) {
      row.hidden = numbers.every((i) => this.rows_[i].row.hidden);
    }
    this.told_.textContent = words.length && this.seen_().length === 0 ? "No layer has that name." : "";
  }

  /** The layers matched by the search, the topmost first. */
  seen_() {
    return [...this.order_].reverse().filter((i) => !this.rows_[i].row.hidden);
  }

  number_of_(row) {
    return this.rows_.findIndex((one) => one.row === row);
  }

  /** Moves layer `i` to the position of `other`, which makes room for it. */
  move_(i, other) {
    const to = this.order_.indexOf(other);
    const order = this.order_.filter((number) => number !== i);
    order.splice(to, 0, i);
    this.show_order(order);
    const { title } = this.rows_[i];
    this.moved_.textContent = `${title}: ${order.length - to} of ${order.length} from the top`;
    this.on_.reorder(order);
  }
}
