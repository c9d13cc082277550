// The viewer: all layers of the server over each other, with the place and what was changed kept
// in the address.
/* global L */

import { attribution_nodes, link_to } from "./attribution.js";
import { load_catalog } from "./catalog.js";
import { CombinedTiles } from "./combined_tiles.js";
import { Comparison } from "./comparison.js";
import { Connection } from "./connection.js";
import { DetailPanel, simplify_in_words } from "./detail_panel.js";
import { choose } from "./elements.js";
import { FeaturePanel, ask_features } from "./feature_panel.js";
import { values_in_view, wrapped_longitude } from "./feature_samples.js";
import { layer_row } from "./layer_panel.js";
import { ask_legend, legend_section } from "./legend.js";
import { load_style, load_style_names, over, usual_shared, usual_style } from "./named_styles.js";
import { Notices } from "./notices.js";
import { format_hash, parse_hash } from "./place_hash.js";
import { ProgressLine } from "./progress_line.js";
import { SharePanel } from "./share_panel.js";
import { shared_style } from "./share_style.js";
import {
  divide_shared,
  has_fast_topology,
  parameters_of_layers,
  path_of_layers,
  query_part,
} from "./tile_query.js";
import { tile_requests } from "./tile_requests.js";
import { watch_tiles } from "./tile_timing.js";

const MAX_ZOOM = 22;
const MAX_LATITUDE = 85.0511287798066;
const BUILTIN_FILL = "808080"; // of layers whose style the catalog does not tell
const PHONE = "(max-width: 600px)";
const DOUBLE_CLICK_MS = 250;
const MESSAGE_MS = 6000;

const BASE = document.baseURI;
const TILES = new URL("tiles/", BASE).href;
const $ = (id) => document.getElementById(id);

// ---- what is said at the foot of the map

const notices = new Notices($("status"));

/** Said for a moment. */
function mention(text) {
  notices.say("message", text, { for_ms: MESSAGE_MS });
}

// ---- layers as the catalog gives them

/** Anything may stand in the catalog: only what has a name can be shown. */
function usable_layers(catalog) {
  return catalog.layers.filter((layer) => typeof layer?.name === "string" && layer.name !== "");
}

function in_quotes(names) {
  const some = names.slice(0, 3).map((name) => `"${name}"`).join(", ");
  return names.length > 3 ? `${some} and ${names.length - 3} more` : some;
}

/** Why the server will not draw a tile, and what helps. */
function refusal_in_words({ status, detail }) {
  if (status === 404) return "Some tiles are not there any more. Load the page again.";
  if (/drawing|draw/.test(detail)) return "There is too much to draw here. Zoom in, or simplify more.";
  return `Some tiles cannot be drawn. ${detail}`;
}

/** Where all layers can be seen, or the world if they span most of it. */
function show_everything(map, layers) {
  const boxes = layers.map((layer) => layer.bounds).filter(is_box);
  const all = L.latLngBounds(boxes.flatMap(([w, s, e, n]) => [[s, w], [n, e]]));
  if (all.isValid() && all.getEast() - all.getWest() < 180) {
    map.fitBounds(all);
  } else {
    // The smallest whole zoom at which the world is as high as the window.
    map.setView([25, 10], Math.max(1, Math.ceil(Math.log2(map.getSize().y / 256))));
  }
}

function is_box(bounds) {
  return Array.isArray(bounds) && bounds.length === 4 && bounds.every(Number.isFinite) &&
    bounds[0] <= bounds[2] && bounds[1] <= bounds[3];
}

// ---- the page

function make_map() {
  const map = L.map("map", {
    attributionControl: false,
    minZoom: 0,
    maxZoom: MAX_ZOOM,
    maxBounds: [[-MAX_LATITUDE, -1e6], [MAX_LATITUDE, 1e6]],
    maxBoundsViscosity: 1,
    worldCopyJump: true,
    // Old tiles show through new ones that fade in, and where frames come late (a tile fades for
    // 200 ms, Leaflet looks after 250) they never go.
    fadeAnimation: false,
    wheelPxPerZoomLevel: 120, // one notch of a mouse wheel is one zoom
  });
  L.control.scale({ position: "bottomleft", imperial: false }).addTo(map);
  return map;
}

function make_pane(map, name) {
  const pane = map.createPane(name);
  pane.style.zIndex = 200; // where Leaflet has its own tiles
  return pane;
}

/** Leaflet's own control takes markup; ours takes nodes, so that no text can become markup. */
function show_attribution(map, layers) {
  const control = L.control({ position: "bottomright" });
  control.onAdd = () => {
    const box = L.DomUtil.create("div", "leaflet-control-attribution");
    box.append(link_to("https://leafletjs.com", "Leaflet"));
    for (const line of new Set(layers.map((layer) => layer.attribution).filter(Boolean))) {
      box.append(" | ", ...attribution_nodes(line));
    }
    return box;
  };
  control.addTo(map);
}

function show_about(catalog, layers) {
  const features = layers.reduce((sum, layer) => sum + (Number(layer.features) || 0), 0);
  const parts = [`${features.toLocaleString("en")} features`];
  if (typeof catalog.renderer === "string") parts.push(`drawn by ${catalog.renderer}`);
  $("about").textContent = parts.join(", ");
}

function make_foldable(toggle, body) {
  const open = (is_open) => {
    toggle.setAttribute("aria-expanded", String(is_open));
    body.hidden = !is_open;
  };
  toggle.addEventListener("click", () => open(body.hidden));
  open(!window.matchMedia(PHONE).matches);
}

function make_address_copyable() {
  $("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText($("tile-url").value);
    } catch {
      // No clipboard without a secure connection, or without leave: the old way.
      $("tile-url").select();
      document.execCommand("copy");
    }
    $("copy").textContent = "Copied";
    setTimeout(() => ($("copy").textContent = "Copy"), 1500);
  });
}

/** Calls `act` with the place of a click that is not the first half of a double click. */
function on_single_click(map, act) {
  let waiting = null;
  map.on("click", ({ latlng }) => {
    clearTimeout(waiting);
    waiting = setTimeout(() => act(latlng), DOUBLE_CLICK_MS);
  });
  map.on("dblclick", () => clearTimeout(waiting));
}

/** Keeps panels, map and address the same, whichever of them changes. */
class Viewer {
  constructor(catalog, connection) {
    this.connection_ = connection;
    this.layers_ = usable_layers(catalog);
    const view = parse_hash(location.hash);
    this.named_ = {};
    this.map_ = make_map();
    this.go_to_(view.place);
    this.make_map_layers_();
    this.make_panels_();
    show_attribution(this.map_, this.layers_);
    show_about(catalog, this.layers_);

    this.map_.on("moveend", () => this.write_address_());
    this.map_.on("zoomanim zoomend", ({ type }) => (this.is_zooming_ = type === "zoomanim"));
    // As it was typed: by now location may say again what write_address_ wrote.
    window.addEventListener("hashchange", ({ newURL }) => this.read_address_(new URL(newURL).hash));
    this.show_view_(view);
  }

  // ---- made once

  make_map_layers_() {
    const simplified = make_pane(this.map_, "simplified");
    const full = make_pane(this.map_, "full");
    const progress = new ProgressLine();
    const tiles_in = (pane) => new CombinedTiles(this.map_, TILES, pane, {
      failed: (url) => this.connection_.failed(url),
      came: () => this.connection_.worked(),
      refused_gone: () => this.tell_refused_(),
      loading: (waiting) => progress.show(pane, waiting),
    });
    this.tiles_ = tiles_in("simplified");
    this.compared_tiles_ = tiles_in("full");
    this.comparison_ = new Comparison(this.map_, simplified, full, (part) => {
      this.compare_ = part;
      this.write_address_();
    });
  }

  // ---- tiles that do not come

  ask_again_(was_away) {
    this.tiles_.retry();
    this.compared_tiles_.retry();
    if (was_away) this.tell_other_layers_();
  }

  /** A server that was away may have come back with other layers. */
  async tell_other_layers_() {
    const response = await fetch(new URL("catalog", BASE)).catch(() => null);
    const catalog = response?.ok ? await response.json().catch(() => null) : null;
    if (!Array.isArray(catalog?.layers)) return;
    const names = usable_layers(catalog).map(({ name }) => name);
    if (names.join() === this.layers_.map(({ name }) => name).join()) return;
    notices.say("message", "The server has other layers now.",
      { action: ["Load the page again", () => location.reload()] });
  }

  refuse_(url, problem) {
    const panes = [this.tiles_, this.compared_tiles_];
    if (panes.map((tiles) => tiles.give_way(url)).includes(false)) this.tell_refused_(problem);
  }

  tell_refused_(problem = null) {
    const is_refused = this.tiles_?.has_refused() || this.compared_tiles_?.has_refused();
    if (!is_refused) notices.say("refused", "");
    else if (problem) notices.say("refused", refusal_in_words(problem));
  }

  make_panels_() {
    this.rows_ = this.layers_.map((layer, i) => layer_row(layer, BUILTIN_FILL,
      (property) => this.values_in_view_(layer.name, property), (state) => this.change_(i, state)));
    // The list reads from top to bottom as the layers lie over each other.
    $("layers").replaceChildren(...this.rows_.map(({ row }) => row).reverse());
    load_style_names(BASE).then((names) => this.show_style_names_(names));
    $("style").addEventListener("change", () => this.change_named_style_($("style").value));
    this.detail_ = new DetailPanel(() => this.change_detail_(), {
      has_fast: this.layers_.some(has_fast_topology),
      has_apart: this.layers_.some((layer) => layer.coverages > 0 && has_fast_topology(layer)),
    });
    $("detail").append(this.detail_.node);
    this.features_ = new FeaturePanel($("features"), {
      choose: (feature) => this.choose_(feature),
      go_to: ({ bbox: [west, south, east, north] }) =>
        this.map_.fitBounds([[south, west], [north, east]]),
      close: () => this.close_features_(),
      title_of: (name) => this.title_of_(name),
    });
    new SharePanel($("share-open"), new URL(".", BASE).href, () => this.what_is_shared_());
    on_single_click(this.map_, (place) => this.identify_(place));
    $("map").addEventListener("keydown", (event) => {
      if (event.target !== $("map")) return;
      if (event.key === "Enter") this.identify_(this.map_.getCenter(), { is_by_key: true });
      if (event.key === "Escape") this.close_features_();
    });
  }

  title_of_(name) {
    return String(this.layers_.find((layer) => layer.name === name)?.title || name);
  }

  // ---- what is shown

  /** Everything but the place; nothing new is drawn before its named style has come. */
  async show_view_(view) {
    this.view_ = view;
    this.shared_ = view.shared;
    this.compare_ = view.compare;
    this.against_ = view.against ?? "full";
    this.at_ = view.at;
    this.states_ = this.layers_.map(({ name }, i) => {
      const style = view.styles.get(name) ?? new Map();
      return {
        is_on: view.on === null || view.on.includes(name),
        style, // as it stands in the panel
        // The last style that the server took; what sets nothing is right.
        drawn: style.size === 0 ? style : (this.states_?.[i].drawn ?? null),
        entries: [], // of its legend
        usual: new Map(), // what holds where the style says nothing
      };
    });
    const named = await this.load_named_style_(view.shared);
    if (this.view_ !== view) return;
    this.named_ = named;
    this.show_usual_();
    this.states_.forEach((_, i) => this.prove_style_(i));
    this.tell_unknown_layers_(view);
    if (this.at_) this.identify_({ lat: this.at_.lat, lng: this.at_.lon });
    else this.features_.hide();
  }

  tell_unknown_layers_({ on, styles }) {
    const known = new Set(this.layers_.map(({ name }) => name));
    const unknown = [...new Set([...(on ?? []), ...styles.keys()])].filter((name) => !known.has(name));
    if (unknown.length === 1) mention(`There is no layer "${unknown[0]}" here.`);
    if (unknown.length > 1) mention(`There are no layers ${in_quotes(unknown)} here.`);
  }

  /** The panel, after what is usual may have changed. */
  show_usual_() {
    this.states_.forEach((state, i) => {
      state.usual = usual_style(this.layers_[i], this.named_);
      this.rows_[i].show(state);
    });
    const against = this.compare_ === null ? null : this.against_;
    this.detail_.show({ shared: this.shared_, against }, usual_shared(this.named_));
    choose($("style"), this.shared_.get("style") ?? "");
    $("style-row").hidden = $("style").options.length < 2;
  }

  show_style_names_(names) {
    const chosen = $("style").value;
    $("style").replaceChildren(new Option("that of each layer", ""),
      ...names.map((name) => new Option(name, name)));
    choose($("style"), chosen);
    $("style-row").hidden = $("style").options.length < 2;
  }

  /** What the style is made of that is named in `shared`, from which an unknown name is taken. */
  async load_named_style_(shared) {
    const named = await load_style(BASE, shared.get("style"));
    if (named) return named;
    mention(`There is no style "${shared.get("style")}".`);
    shared.delete("style");
    return {};
  }

  async change_named_style_(name) {
    const shared = new Map([...(name ? [["style", name]] : []),
      ...[...this.shared_].filter(([key]) => key !== "style")]);
    const named = await this.load_named_style_(shared);
    if ($("style").value !== name) return;
    this.shared_ = shared;
    this.named_ = named;
    this.show_usual_();
    this.states_.forEach((_, i) => this.prove_style_(i));
  }

  go_to_(place) {
    if (place) this.map_.setView([place.lat, place.lon], Math.min(place.zoom, MAX_ZOOM));
    else show_everything(this.map_, this.layers_);
  }

  change_(i, { is_on, style }) {
    this.states_[i].is_on = is_on;
    this.states_[i].style = style;
    this.prove_style_(i);
  }

  change_detail_() {
    const { shared, against } = this.detail_.read();
    const named = [...this.shared_].filter(([key]) => key === "style");
    this.shared_ = new Map([...named, ...shared]);
    this.compare_ = against === null ? null : (this.compare_ ?? 0.5);
    this.against_ = against ?? this.against_;
    this.draw_();
    this.write_address_();
  }

  /** The map keeps the last style that was right: the server judges before tiles are asked for. */
  async prove_style_(i) {
    const state = this.states_[i];
    const { style } = state;
    if (style.size === 0) state.drawn = style;
    this.draw_();
    this.write_address_();
    const name = this.shared_.get("style");
    const { problem = null, entries = [] } = await ask_legend(BASE, this.layers_[i].name,
      name ? [...style, ["style", name]] : style);
    if (this.states_[i] !== state || state.style !== style) return;
    if (this.shared_.get("style") !== name) return;
    this.rows_[i].show_problem(problem);
    if (problem && $("panel-body").hidden) {
      mention(`${this.title_of_(this.layers_[i].name)}: ${problem.detail}`);
    }
    if (!problem) Object.assign(state, { drawn: style, entries });
    else state.drawn ??= new Map();
    this.draw_();
    this.write_address_();
  }

  draw_() {
    const is_apart = this.against_ === "apart";
    const compared = new Map([...this.shared_, is_apart ? ["topology", "fast"] : ["simplify", "0"]]);
    // What is not yet proved comes in a moment; the map waits for it, to ask once and for all.
    const is_proved = this.states_.every(({ is_on, drawn }) => !is_on || drawn !== null);
    if (is_proved) {
      this.tiles_.show(this.tile_requests_(this.shared_));
      this.compared_tiles_.show(this.compare_ === null ? [] : this.tile_requests_(compared));
    }
    this.tell_refused_();
    const is_empty = this.layers_.length > 0 && this.states_.every(({ is_on }) => !is_on);
    notices.say("empty", is_empty ? "All layers are off. Switch one on in the list." : "");
    const { pixels } = this.detail_;
    const words = simplify_in_words(pixels);
    this.comparison_.show(this.compare_, pixels === 0 ? words : `simplified to ${words}`,
      is_apart ? "each polygon by itself" : "every vertex");
    this.show_legend_();
    $("tile-url").value = this.tile_url_();
  }

  tile_requests_(shared) {
    return tile_requests(this.drawn_layers_(), {
      layers: this.layers_,
      shared,
      has_background: Boolean(this.named_.background),
      folder: new URL(TILES).pathname,
    });
  }

  show_legend_() {
    const sections = this.states_.flatMap(({ is_on, drawn, entries, usual }, i) =>
      is_on && entries.length
        ? [legend_section(this.title_of_(this.layers_[i].name), entries, over(usual, drawn))] : []);
    $("legend-body").replaceChildren(...sections.reverse());
    $("legend").hidden = sections.length === 0;
  }

  /** Those that are on, the lowest first, in the style that is drawn. */
  drawn_layers_() {
    return this.layers_.flatMap(({ name }, i) => {
      const { is_on, drawn } = this.states_[i];
      return is_on && drawn ? [{ name, style: drawn }] : [];
    });
  }

  tile_url_() {
    const layers = this.drawn_layers_();
    if (layers.length === 0) return "";
    const { styled, shared } = divide_shared(layers, this.layers_, this.shared_);
    const query = query_part(parameters_of_layers(styled, shared));
    return `${TILES}${path_of_layers(layers)}/{z}/{x}/{y}.png${query}`;
  }

  what_is_shared_() {
    const drawn = this.drawn_layers_();
    const layers = drawn.map(({ name }) => this.layers_.find((layer) => layer.name === name));
    const zooms = (member, otherwise) =>
      layers.map((layer) => (Number.isInteger(layer[member]) ? layer[member] : otherwise));
    const { lat, lng } = this.map_.getCenter();
    return {
      names: drawn.map(({ name }) => name),
      titles: layers.map(({ name }) => this.title_of_(name)),
      attributions: layers.map(({ attribution }) => attribution).filter(Boolean),
      style: shared_style(drawn, {
        layers: this.layers_, shared: this.shared_, named: this.named_,
      }),
      place: {
        lat: Number(lat.toFixed(5)), lon: Number(wrapped_longitude(lng).toFixed(5)),
        zoom: this.map_.getZoom(),
      },
      min_zoom: Math.min(...zooms("minzoom", 0)),
      max_zoom: Math.max(...zooms("maxzoom", MAX_ZOOM)),
    };
  }

  // ---- features under a place

  async identify_({ lat, lng }, { is_by_key = false } = {}) {
    const at = { lat, lon: wrapped_longitude(lng) };
    this.at_ = at;
    this.write_address_();
    // Of the address, and not yet proved, is as good as drawn here.
    const layers = this.layers_.flatMap(({ name }, i) => {
      const { is_on, drawn, style } = this.states_[i];
      return is_on ? [{ name, style: drawn ?? style }] : [];
    });
    try {
      if (layers.length === 0) throw new Error("No layer is shown.");
      const found = await ask_features(BASE, layers, this.shared_, at, this.map_.getZoom());
      if (this.at_ !== at) return;
      this.found_ = found;
      this.choose_(found.find((feature) => this.is_highlighted_(feature)) ?? found[0]);
    } catch (error) {
      if (this.at_ === at) this.features_.show_message(error.message);
    }
    if (is_by_key) this.features_.focus();
  }

  /** `feature` of those found, or nothing. */
  choose_(feature) {
    this.states_.forEach((state, i) => {
      const is_of_layer = feature?.layer === this.layers_[i].name;
      this.highlight_(i, is_of_layer ? String(feature.id) : null);
    });
    if (feature) this.features_.show(this.found_, feature);
    else this.features_.show_message("There is nothing here.");
  }

  close_features_() {
    this.at_ = null;
    this.features_.hide();
    this.states_.forEach((_, i) => this.highlight_(i, null));
    this.write_address_();
    $("map").focus({ preventScroll: true });
  }

  highlight_(i, ids) {
    const state = this.states_[i];
    if ((state.style.get("highlight") ?? null) === ids) return;
    state.style = new Map(state.style);
    if (ids === null) state.style.delete("highlight");
    else state.style.set("highlight", ids);
    this.rows_[i].show(state);
    this.prove_style_(i);
  }

  is_highlighted_({ layer, id }) {
    const state = this.states_[this.layers_.findIndex(({ name }) => name === layer)];
    return state?.style.get("highlight") === String(id);
  }

  values_in_view_(layer, property) {
    const bounds = this.map_.getBounds();
    const box = {
      west: bounds.getWest(), south: bounds.getSouth(), east: bounds.getEast(),
      north: bounds.getNorth(),
    };
    return values_in_view(BASE, layer, property, box, this.map_.getZoom());
  }

  // ---- the address

  async read_address_(hash) {
    const view = parse_hash(hash);
    await this.show_view_(view);
    if (!view.place) return;
    // Moving writes the address: of this view, unless another has come meanwhile.
    const go = () => this.view_ === view && this.go_to_(view.place);
    // Leaflet takes no other place while it zooms.
    if (this.is_zooming_) this.map_.once("zoomend", go);
    else go();
  }

  /** Says only what differs from the defaults, and makes no step in the history. */
  write_address_() {
    const { lat, lng } = this.map_.getCenter();
    const on = this.layers_.filter((_, i) => this.states_[i].is_on).map(({ name }) => name);
    const hash = format_hash({
      place: { zoom: this.map_.getZoom(), lat, lon: lng },
      on: on.length === this.layers_.length ? null : on,
      // Until the server has judged it, what the address said.
      styles: new Map(this.layers_.map(({ name }, i) =>
        [name, this.states_[i].drawn ?? this.states_[i].style])),
      shared: this.shared_,
      compare: this.compare_,
      against: this.against_ === "apart" ? "apart" : undefined,
      at: this.at_,
    });
    history.replaceState(null, "", hash);
  }
}

make_foldable($("panel-toggle"), $("panel-body"));
make_foldable($("legend-toggle"), $("legend-body"));
make_address_copyable();
watch_tiles(TILES, (line) => ($("timing").textContent = line));
let viewer = null;
const connection = new Connection(BASE, {
  tell: (text, more) => notices.say("connection", text, more),
  back: (was_away) => viewer?.ask_again_(was_away),
  refused: (url, problem) => viewer?.refuse_(url, problem),
});
document.body.classList.add("is-starting");
const catalog = await load_catalog(new URL("catalog", BASE), connection);
document.body.classList.remove("is-starting");
if (usable_layers(catalog).length === 0) notices.say("empty", "The server has no layers.");
viewer = new Viewer(catalog, connection);
