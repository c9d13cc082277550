// Compares two renderings of the map side by side, on the left and the right of a divider.

import { element, input } from "./elements.js";

const HANDLE = 44; // pixels; as in viewer.css

export class Comparison {
  /**
   * @param map the Leaflet map
   * @param left, right panes of the map
   * @param on_change called with the fraction of the width on the left of the divider, 0 to 1
   */
  constructor(map, left, right, on_change) {
    this.map_ = map;
    this.left_ = left;
    this.right_ = right;
    this.slider_ = input("range", { min: 0, max: 1, step: 0.01 });
    this.left_label_ = element("span", "left");
    this.right_label_ = element("span", "right");
    this.line_ = element("div", "divider", this.left_label_, this.right_label_);
    this.node_ = element("section", "comparison", this.line_, this.slider_);
    this.node_.setAttribute("aria-label", "Comparison");
    map.getContainer().after(this.node_);
    this.slider_.addEventListener("input", () => this.clip_());
    this.slider_.addEventListener("change", () => on_change(Number(this.slider_.value)));
    map.on("move resize zoomend", () => this.clip_());
    this.show(null);
  }

  /** `part`: as for on_change; null shows only the left rendering. */
  show(part, left_text = "", right_text = "") {
    this.node_.hidden = part === null;
    if (part !== null) this.slider_.value = part;
    this.left_label_.textContent = left_text;
    this.right_label_.textContent = right_text;
    this.slider_.setAttribute("aria-label", `Divider between the simplified map and ${right_text}`);
    this.clip_();
  }

  clip_() {
    if (this.node_.hidden) {
      this.left_.style.clipPath = "";
      return;
    }
    const { x: width, y: height } = this.map_.getSize();
    // The centre of the slider's handle, which stays inside the window.
    const middle = HANDLE / 2 + Number(this.slider_.value) * (width - HANDLE);
    this.line_.style.left = `${middle}px`;
    this.left_.style.clipPath = this.clip_path_(0, middle, height);
    this.right_.style.clipPath = this.clip_path_(middle, width, height);
  }

  /** The path is in the coordinates of the panes, which move with the map. */
  clip_path_(left, right, height) {
    const { x, y } = this.map_.containerPointToLayerPoint([0, 0]);
    const corner = (dx, dy) => `${x + dx}px ${y + dy}px`;
    return `polygon(${corner(left, 0)}, ${corner(right, 0)}, ${corner(right, height)}, ` +
      `${corner(left, height)})`;
  }
}
