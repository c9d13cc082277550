// The line at the bottom of the map: the most important of all current messages.

import { button, element } from "./elements.js";

const ORDER = ["connection", "refused", "message", "empty", "detail"];

export class Notices {
  constructor(node) {
    this.node_ = node;
    this.said_ = new Map();
    this.timers_ = new Map();
  }

  /**
   * `kind` is one of ORDER; an empty `text` removes the message. `more` may have {aside: text that changes
   * too often for screen readers, bars: [{name, percent}], more: text below the bars, action: [text,
   * function], for_ms: time after which the message is removed}.
   */
  say(kind, text, more = {}) {
    clearTimeout(this.timers_.get(kind));
    if (text === "") this.said_.delete(kind);
    else this.said_.set(kind, { text, ...more });
    if (more.for_ms) this.timers_.set(kind, setTimeout(() => this.say(kind, ""), more.for_ms));
    this.show_();
  }

  show_() {
    const kind = ORDER.find((kind) => this.said_.has(kind));
    const said = this.said_.get(kind);
    this.node_.hidden = said === undefined;
    if (said === undefined) {
      this.node_.replaceChildren();
      this.now_ = undefined;
      return;
    }
    const label = said.action?.[0];
    const key = JSON.stringify([kind, said.text, label]);
    if (key !== this.now_) this.build_(said, key);
    this.aside_.textContent = said.aside ? ` ${said.aside}` : "";
    this.act_ = said.action?.[1];
    this.bars_.replaceChildren(...(said.bars ?? []).map(bar_of),
      ...(said.more ? [element("span", "more", said.more)] : []));
  }

  /** Called only for a new message, so that a button keeps the focus while a countdown changes. */
  build_({ text, action }, key) {
    this.now_ = key;
    this.aside_ = element("span", "aside");
    this.aside_.setAttribute("aria-hidden", "true");
    this.bars_ = element("span", "bars");
    this.bars_.setAttribute("aria-hidden", "true");
    this.node_.replaceChildren(element("span", "", text, this.aside_), this.bars_);
    if (!action) return;
    const control = button(action[0]);
    control.addEventListener("click", () => this.act_());
    this.node_.append(control);
  }
}

function bar_of({ name, percent }) {
  const ink = element("span", "ink");
  ink.style.width = `${percent}%`;
  return element("span", "bar", element("span", "name", name), element("span", "track", ink),
    element("span", "percent", `${percent} %`));
}
