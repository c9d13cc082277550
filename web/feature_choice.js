// The clicked place, the features there, and the selected one, which are shown in a panel and outlined on
// the map.

import { FeaturePanel, ask_features } from "./feature_panel.js";
import { path_of_layers, query_part, taken_by, takes } from "./tile_query.js";
import { pixels_across, wrapped_longitude } from "./view_bounds.js";

const DOUBLE_CLICK_MS = 250;

const OF_SHAPES = ["simplify", "topology"];
// The outline of the selection, on top of every style: a line visible on light and dark colours, and a
// tint that hides nothing.
const TINT = "ffffff40";
const LINE = "c2185b";
const OUTLINE = [["highlight-stroke", LINE], ["stroke", LINE],
  ["stroke-width", "2.5"], ["stroke-opacity", "1"], ["stroke-dasharray", "1,0"],
  ["fill-opacity", "1"], ["opacity", "1"], ["pattern", "none"]];
const SMALL = 32; // pixels; outlines of features hardly larger than the line width fade
// In large features, ponds and islets would only be specks of colour.
const LARGE = 200; // pixels
const PIXELS_IF_LARGE = 1; // minimum tolerance for the outline of a large feature

export class FeatureChoice {
  /**
   * @param map the Leaflet map
   * @param node of the panel
   * @param look returns {base; layers: those that are on, {name, style}, the lowest first; catalog; shared:
   *   parameters of all layers; shapes: the same, including those of the named style}
   * @param on {change(), called after the place or the selection has changed; go_to(box in degrees, name
   *   of a layer); title_of(name)}
   */
  constructor(map, node, look, on) {
    this.map_ = map;
    this.look_ = look;
    this.on_ = on;
    this.at_ = null;
    this.chosen_ = null;
    this.found_ = [];
    this.panel_ = new FeaturePanel(node, {
      choose: (feature) => this.choose_(feature),
      go_to: ({ bbox, part_bbox, layer }) => on.go_to(part_bbox ?? bbox, layer),
      close: () => this.close_(),
      title_of: on.title_of,
    });
    on_single_click(map, (place) => this.ask_(place));
    const container = map.getContainer();
    container.addEventListener("keydown", (event) => {
      if (event.target !== container) return;
      if (event.key === "Enter") this.ask_(map.getCenter(), { is_by_key: true });
      if (event.key === "Escape") this.close_();
    });
  }

  /** {at, chosen} for the address. */
  get now() {
    return { at: this.at_, chosen: this.chosen_ };
  }

  /** Restores the state from the address; hides the panel if `at` is null. */
  show({ at, chosen }) {
    this.chosen_ = chosen;
    if (at) {
      this.ask_({ lat: at.lat, lng: at.lon });
    } else {
      this.at_ = null;
      this.panel_.hide();
    }
  }

  /** The requests for the outline of the selected feature: none or one, see tile_requests(). */
  requests() {
    const { layers, catalog, shapes } = this.look_();
    const { layer: name, id } = this.chosen_ ?? {};
    const layer = catalog.find((one) => one.name === name);
    if (!layer || !layers.some((one) => one.name === name)) return [];
    if (!takes(layer, "ids") || !takes(layer, "highlight")) return [];
    const shape = new Map(taken_by(layer, shapes).filter(([key]) => OF_SHAPES.includes(key)));
    const pixels = this.pixels_across_();
    shape.set("small", "keep");
    // All of its parts are filled: a part may be small, but not the others.
    shape.set("highlight-fill", this.whole_pixels_across_() < SMALL ? LINE : TINT);
    if (pixels >= LARGE) {
      const { simplify = 0 } = Object.fromEntries(shape);
      shape.set("simplify", Math.max(PIXELS_IF_LARGE, Number(simplify)));
      shape.set("small", "drop");
    }
    return [{
      layers: [name],
      path: path_of_layers([layer]),
      query: query_part(taken_by(layer, [["ids", id], ["highlight", id], ...OUTLINE, ...shape])),
      min_zoom: 0, max_zoom: Infinity, parts: [],
    }];
  }

  async ask_({ lat, lng }, { is_by_key = false } = {}) {
    const at = { lat, lon: wrapped_longitude(lng) };
    this.at_ = at;
    const { base, layers, catalog, shared } = this.look_();
    try {
      if (layers.length === 0) throw new Error("No layer is shown.");
      const found = await ask_features(base, layers, catalog, shared, at, this.map_.getZoom());
      if (this.at_ !== at) return;
      this.found_ = found;
      this.choose_(found.find((feature) => this.is_chosen_(feature)) ?? found[0]);
    } catch (error) {
      if (this.at_ !== at) return;
      this.found_ = [];
      this.choose_(undefined, error.message);
    }
    if (is_by_key) this.panel_.focus();
  }

  /** The size of the selected feature on the screen, or of its part under the click; LARGE while unknown. */
  pixels_across_() {
    const found = this.found_.find((feature) => this.is_chosen_(feature));
    return found ? pixels_across(this.map_, found.part_bbox ?? found.bbox) : LARGE;
  }

  whole_pixels_across_() {
    const found = this.found_.find((feature) => this.is_chosen_(feature));
    return found ? pixels_across(this.map_, found.bbox) : LARGE;
  }

  /** Selects `feature`, one of those found, or nothing. */
  choose_(feature, otherwise = "There is nothing here.") {
    this.chosen_ = feature ? { layer: feature.layer, id: String(feature.id) } : null;
    if (feature) this.panel_.show(this.found_, feature);
    else this.panel_.show_message(otherwise);
    this.on_.change();
  }

  close_() {
    this.at_ = null;
    this.chosen_ = null;
    this.panel_.hide();
    this.on_.change();
    this.map_.getContainer().focus({ preventScroll: true });
  }

  is_chosen_({ layer, id }) {
    return this.chosen_?.layer === layer && this.chosen_.id === String(id);
  }
}

/** Calls `act` with the place of each click that does not start a double click. */
function on_single_click(map, act) {
  let waiting = null;
  map.on("click", ({ latlng }) => {
    clearTimeout(waiting);
    waiting = setTimeout(() => act(latlng), DOUBLE_CLICK_MS);
  });
  map.on("dblclick", () => clearTimeout(waiting));
}
