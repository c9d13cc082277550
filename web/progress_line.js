// A thin line at the top of the page while tiles are loading. It is hidden from screen readers.

import { element } from "./elements.js";

const PATIENCE_MS = 150; // tiles that load faster need no line

export class ProgressLine {
  constructor() {
    this.node_ = element("div", "progress");
    this.node_.setAttribute("aria-hidden", "true");
    document.body.append(this.node_);
    this.parts_ = new Map();
    this.most_ = 0;
    this.timer_ = null;
  }

  /** `waiting`: the number of tiles that `part` of the map still waits for. */
  show(part, waiting) {
    this.parts_.set(part, waiting);
    const left = [...this.parts_.values()].reduce((sum, count) => sum + count, 0);
    if (left === 0) {
      this.end_();
      return;
    }
    this.most_ = Math.max(this.most_, left);
    // Visible from the start, and never full before loading has finished.
    this.node_.style.transform = `scaleX(${0.08 + 0.9 * (1 - left / this.most_)})`;
    this.timer_ ??= setTimeout(() => this.node_.classList.add("shown"), PATIENCE_MS);
  }

  end_() {
    clearTimeout(this.timer_);
    this.timer_ = null;
    this.most_ = 0;
    if (this.node_.classList.contains("shown")) this.node_.style.transform = "scaleX(1)";
    this.node_.classList.remove("shown");
  }
}
