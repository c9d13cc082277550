// Suggestions for the first visit: a few buttons with a sentence each, which demonstrate features that other
// map servers lack. While a demonstration runs, its control replaces the buttons.

import { button, element } from "./elements.js";

export class TryPanel {
  /**
   * @param node the empty element of the panel
   * @param opener the button that reopens the panel
   * @param demonstrations {title, words, start(), control: a node}
   * @param places to zoom to: {title, go()}
   * @param on {started(), ended(): the previous state is to be restored, covered(): other panels hide it}
   */
  constructor(node, opener, demonstrations, places, on) {
    this.node_ = node;
    this.opener_ = opener;
    this.on_ = on;
    this.offer_ = this.make_offer_(demonstrations, places);
    this.is_running_ = false;
    opener.addEventListener("click", () => {
      this.open();
      if (node.offsetHeight === 0) on.covered();
      node.querySelector("button").focus();
    });
    // Elements at the bottom of the window make room for it.
    new ResizeObserver(() => document.documentElement.style.setProperty("--try",
      `${node.offsetHeight}px`)).observe(node);
  }

  open() {
    this.node_.replaceChildren(...this.offer_);
    this.node_.hidden = false;
    this.opener_.hidden = true;
  }

  close() {
    this.end_();
    this.node_.hidden = true;
    this.opener_.hidden = false;
  }

  /** Another view is shown: the previous state is not to be restored any more. */
  forget() {
    if (!this.is_running_) return;
    this.is_running_ = false;
    this.open();
  }

  make_offer_(demonstrations, places) {
    const close = button("×", { "aria-label": "Close", class: "close" });
    close.addEventListener("click", () => {
      this.close();
      this.opener_.focus();
    });
    const choices = demonstrations.map((demonstration) => {
      const choice = button("", { class: "choice" });
      choice.append(element("b", "", demonstration.title), element("span", "", demonstration.words));
      choice.addEventListener("click", () => this.run_(demonstration));
      return choice;
    });
    const ways = places.map(({ title, go }) => {
      const way = button(title);
      way.addEventListener("click", go);
      return way;
    });
    return [
      element("header", "", element("h2", "", "Try it"),
        ...(ways.length ? [element("p", "ways", "Go to", ...ways)] : []), close),
      element("div", "choices", ...choices),
    ];
  }

  run_({ title, words, start, control }) {
    if (!this.is_running_) this.on_.started();
    this.is_running_ = true;
    const back = button("Back");
    back.addEventListener("click", () => {
      this.end_();
      this.open();
      this.node_.querySelector(".choice").focus();
    });
    this.node_.replaceChildren(
      element("header", "", element("h2", "", title), back), element("p", "hint", words), control);
    start();
    (control.querySelector("input, button") ?? back).focus();
  }

  end_() {
    if (!this.is_running_) return;
    this.is_running_ = false;
    this.on_.ended();
  }
}
