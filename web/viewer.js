// The viewer: all layers of the server on top of each other, with the place and the changes kept in the
// address.

import { ask_values } from "./attribute_values.js";
import { load_catalog } from "./catalog.js";
import { css_of } from "./colours.js";
import { CombinedTiles } from "./combined_tiles.js";
import { Comparison } from "./comparison.js";
import { Connection } from "./connection.js";
import { demonstrations } from "./demonstrations.js";
import { DetailPanel, simplify_in_words } from "./detail_panel.js";
import { choose, element } from "./elements.js";
import { FeatureChoice } from "./feature_choice.js";
import { LayerList } from "./layer_list.js";
import { layer_row } from "./layer_panel.js";
import { ask_legend, legend_section } from "./legend.js";
import { all_looks } from "./looks.js";
import {
  MAX_ZOOM, make_attribution, make_map, make_pane, show_boxes, show_place_in_free_part,
} from "./map_frame.js";
import { load_style, load_style_names, over, usual_shared, usual_style } from "./named_styles.js";
import { Notices } from "./notices.js";
import { format_hash, parse_hash } from "./place_hash.js";
import { ProgressLine } from "./progress_line.js";
import { has_fast_topology, taken_by } from "./tile_query.js";
import { tile_requests } from "./tile_requests.js";
import { watch_tiles } from "./tile_timing.js";
import { TryPanel } from "./try_panel.js";
import { box_in_view, is_in_view, wrapped_longitude } from "./view_bounds.js";

const BUILTIN_FILL = "808080"; // for layers whose style is missing in the catalog
const NARROW = "(max-width: 1100px)";
const UPRIGHT = "(max-width: 900px)"; // a tablet, half of which the panel would cover
const MESSAGE_MS = 6000;
const LEAST_ZOOM_TO = 18; // for a layer without detail_zoom
const OF_FILTER = ["filter", "ids", "join", "values"]; // a filter may name joined values

const BASE = document.baseURI;
const TILES = new URL("tiles/", BASE).href;
const $ = (id) => document.getElementById(id);

// ---- messages at the bottom of the map

const notices = new Notices($("status"));

/** Shows a message for a short time. */
function mention(text) {
  notices.say("message", text, { for_ms: MESSAGE_MS });
}

// ---- layers of the catalog

/** The catalog is untrusted: only layers with a name can be shown. */
function usable_layers(catalog) {
  return catalog.layers.filter((layer) => typeof layer?.name === "string" && layer.name !== "");
}

function in_quotes(names) {
  const some = names.slice(0, 3).map((name) => `"${name}"`).join(", ");
  return names.length > 3 ? `${some} and ${names.length - 3} more` : some;
}

/** Why the server refuses to draw a tile, and what helps. */
function refusal_in_words({ status, detail }) {
  if (status === 404) return "Some tiles no longer exist. Reload the page.";
  if (/drawing|draw/.test(detail)) return "There is too much to draw here. Zoom in, or simplify more.";
  return `Some tiles cannot be drawn. ${detail}`;
}

// ---- the page

/** The preferred language of the browser if the catalog lists it, else undefined. */
function language_among(languages) {
  const [whole, first] = [navigator.language, navigator.language.split("-")[0]];
  return Array.isArray(languages) ? languages.find((tag) => tag === whole) ??
    languages.find((tag) => tag === first) : undefined;
}

/** The zoom beyond which a layer of the catalog has no more detail. */
function zoom_of_detail(layer) {
  return Number.isInteger(layer?.detail_zoom) ? layer.detail_zoom : LEAST_ZOOM_TO;
}

function show_title(title) {
  if (typeof title !== "string" || title === "") return;
  document.title = title;
  $("title").textContent = title;
}

function show_about(catalog, layers) {
  const features = layers.reduce((sum, layer) => sum + (Number(layer.features) || 0), 0);
  const parts = [`${String(features).replaceAll(/\B(?=(\d{3})+$)/g, ",")} features`];
  if (typeof catalog.renderer === "string") parts.push(`rendered with ${catalog.renderer}`);
  $("about").textContent = parts.join(", ");
}

function make_foldable(toggle, body, folded_where) {
  const open = (is_open) => {
    toggle.setAttribute("aria-expanded", String(is_open));
    body.hidden = !is_open;
  };
  toggle.addEventListener("click", () => open(body.hidden));
  open(!window.matchMedia(folded_where).matches);
}

function make_address_copyable() {
  $("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText($("tile-url").value);
    } catch {
      // No clipboard without a secure connection, or without permission: falls back to execCommand.
      $("tile-url").select();
      document.execCommand("copy");
    }
    $("copy").textContent = "Copied";
    setTimeout(() => ($("copy").textContent = "Copy"), 1500);
  });
}

/** Keeps panels, map and address in sync. */
class Viewer {
  constructor(catalog, connection) {
    this.connection_ = connection;
    this.layers_ = usable_layers(catalog);
    this.tables_ = catalog.tables ?? {};
    this.language_ = language_among(catalog.languages);
    this.start_ = typeof catalog.viewer?.start === "string" ? catalog.viewer.start : "";
    this.address_ = location.hash; // as last read or written
    this.coming_ = null; // the view of an address that is not shown yet
    const is_first_sight = location.hash.length < 2;
    const view = this.view_of_(location.hash);
    this.named_ = {};
    this.style_names_ = [];
    this.order_ = this.layers_.map((_, i) => i);
    this.map_ = make_map();
    this.make_map_layers_();
    this.make_panels_();
    show_title(catalog.viewer?.title);
    this.show_attribution_ = make_attribution(this.map_);
    show_about(catalog, this.layers_);
    if (is_first_sight && this.layers_.length) this.try_.open();
    if (is_first_sight && view.place) show_place_in_free_part(this.map_, view.place);
    else this.go_to_(view.place);

    this.map_.on("moveend", () => {
      this.write_address_();
      this.show_legend_();
      this.show_outline_();
      this.tell_end_of_detail_();
    });
    this.map_.on("zoomanim zoomend", ({ type }) => (this.is_zooming_ = type === "zoomanim"));
    // Uses newURL: write_address_ may have overwritten location in the meantime.
    window.addEventListener("hashchange", ({ newURL }) => this.read_address_(new URL(newURL).hash));
    this.show_view_(view);
  }

  // ---- created once

  make_map_layers_() {
    const simplified = make_pane(this.map_, "simplified");
    const full = make_pane(this.map_, "full");
    make_pane(this.map_, "chosen");
    const progress = new ProgressLine();
    const tiles_in = (pane) => new CombinedTiles(this.map_, TILES, pane, {
      failed: (url) => this.connection_.failed(url),
      came: () => this.connection_.worked(),
      refused_gone: () => this.tell_refused_(),
      loading: (waiting) => progress.show(pane, waiting),
    });
    this.tiles_ = tiles_in("simplified");
    this.compared_tiles_ = tiles_in("full");
    this.outline_tiles_ = tiles_in("chosen");
    this.comparison_ = new Comparison(this.map_, simplified, full, (part) => {
      this.compare_ = part;
      this.write_address_();
    });
  }

  // ---- failed tiles

  ask_again_(was_away) {
    for (const tiles of this.all_tiles_()) tiles.retry();
    if (!was_away) return;
    this.tell_other_layers_();
    this.ask_styles_again_();
  }

  /** What was chosen while the server was away: its named style, legends and problems have not come. */
  async ask_styles_again_() {
    const { view_: view } = this;
    const name = this.shared_.get("style");
    const chosen = new Map(name ? [["style", name]] : []);
    const named = await this.load_named_style_(chosen);
    if (this.view_ !== view || this.shared_.get("style") !== name) return;
    if (!chosen.has("style")) this.shared_.delete("style");
    this.named_ = named;
    this.show_usual_();
    this.prove_all_();
  }

  /** Reports if a server that was away has come back with different layers. */
  async tell_other_layers_() {
    const response = await fetch(new URL("catalog", BASE)).catch(() => null);
    const catalog = response?.ok ? await response.json().catch(() => null) : null;
    if (!Array.isArray(catalog?.layers)) return;
    const names = usable_layers(catalog).map(({ name }) => name);
    if (names.join() === this.layers_.map(({ name }) => name).join()) return;
    notices.say("message", "The layers of the server have changed.",
      { action: ["Reload the page", () => location.reload()] });
  }

  refuse_(url, problem) {
    const ways = this.all_tiles_().map((tiles) => tiles.give_way(url));
    if (ways.includes(false)) this.tell_refused_(problem);
  }

  all_tiles_() {
    return [this.tiles_, this.compared_tiles_, this.outline_tiles_].filter(Boolean);
  }

  tell_refused_(problem = null) {
    if (!this.all_tiles_().some((tiles) => tiles.has_refused())) notices.say("refused", "");
    else if (problem) notices.say("refused", refusal_in_words(problem));
  }

  make_panels_() {
    this.rows_ = this.layers_.map((layer, i) => layer_row(layer, BUILTIN_FILL,
      (attribute, is_all) => this.ask_values_(i, attribute, is_all), {
        change: (state) => this.change_(i, state),
        zoom_to: () => this.zoom_to_([i]),
      }));
    this.list_ = new LayerList($("layer-tools"), $("layers"), this.layers_, this.rows_, {
      switch_all: (numbers, is_on) => this.switch_all_(numbers, is_on),
      zoom_to: (numbers) => this.zoom_to_(numbers),
      reorder: (order) => this.reorder_(order),
    });
    load_style_names(BASE).then((names) => this.show_style_names_(names));
    $("style").addEventListener("change", () => this.change_named_style_($("style").value));
    this.detail_ = new DetailPanel(() => this.change_detail_(), {
      has_fast: this.layers_.some(has_fast_topology),
      has_apart: this.has_apart_(),
    });
    $("detail").append(this.detail_.node);
    this.choice_ = new FeatureChoice(this.map_, $("features"), () => this.what_is_asked_(), {
      change: () => this.show_choice_(),
      go_to: (box, name) =>
        show_boxes(this.map_, [box], zoom_of_detail(this.layers_.find((one) => one.name === name))),
      title_of: (name) => this.title_of_(name),
    });
    $("share-open").addEventListener("click", () => this.open_share_panel_());
    this.make_try_panel_();
  }

  make_try_panel_() {
    const shown = demonstrations({
      simplify: (pixels) => this.set_shared_("simplify", String(pixels)),
      compare_apart: (pixels) => this.compare_apart_(pixels),
      restyle: (look) => this.restyle_(look),
      looks: () => this.looks_(),
      is_shown: ({ name, styles }) => !styles.length && this.shared_.get("style") === name &&
        this.states_.every(({ style }) => style.size === 0),
      picture_of: (look) => this.picture_of_(look),
    }, { has_apart: this.has_apart_() });
    const groups = new Map();
    this.layers_.forEach(({ group }, i) =>
      group && groups.set(group, [...(groups.get(group) ?? []), i]));
    const places = [...groups].map(([title, numbers]) =>
      ({ title: String(title), go: () => this.zoom_to_(numbers) }));
    this.try_ = new TryPanel($("try"), $("try-open"), shown, places.length > 1 ? places : [], {
      started: () => (this.before_ = this.settings_()),
      ended: () => this.take_settings_(this.before_),
      covered: () => this.uncover_try_panel_(),
    });
  }

  /** On a phone, the layers and the features hide it. */
  uncover_try_panel_() {
    if (!$("panel-body").hidden) $("panel-toggle").click();
    if ($("try").offsetHeight > 0) return;
    this.choice_.show({ at: null, chosen: null });
    this.show_choice_();
  }

  /** Loads the panel on demand, because few users open it. */
  async open_share_panel_() {
    const module = await import("./share_panel.js").catch(() => null);
    if (!module) return mention("The server cannot be reached. Reload the page.");
    this.share_ ??= new module.SharePanel(new URL(".", BASE).href, () => this.what_is_shared_());
    return this.share_.open();
  }

  has_apart_() {
    return this.layers_.some((layer) => layer.coverages > 0 && has_fast_topology(layer));
  }

  title_of_(name) {
    return String(this.layers_.find((layer) => layer.name === name)?.title || name);
  }

  // ---- the view

  /** The view in `hash`, or else the server's start view. */
  view_of_(hash) {
    return parse_hash(hash.length > 1 ? hash : `#${this.start_}`);
  }

  /** Shows everything except the place; nothing new is drawn before the named style has loaded. */
  async show_view_(view) {
    this.view_ = view;
    this.shared_ = view.shared;
    this.compare_ = view.compare;
    this.against_ = view.against ?? "full";
    this.order_ = this.order_of_(view.order ?? []);
    this.states_ = this.layers_.map(({ name }, i) => {
      const style = view.styles.get(name) ?? new Map();
      return {
        is_on: view.on === null || view.on.includes(name),
        style, // as shown in the panel
        // The last style that the server accepted; an empty style is always valid.
        drawn: style.size === 0 ? style : (this.states_?.[i].drawn ?? null),
        entries: [], // of its legend
        usual: new Map(), // defaults for parameters missing in the style
      };
    });
    this.list_.show_order(this.order_);
    const named = await this.load_named_style_(view.shared);
    if (this.view_ !== view) return;
    this.named_ = named;
    this.show_usual_();
    this.list_.show_groups();
    this.prove_all_();
    this.tell_unknown_layers_(view);
    this.choice_.show(view);
  }

  prove_all_() {
    this.states_.forEach((_, i) => this.prove_style_(i));
  }

  /** The numbers of all layers, the lowest first: those of `names` in that order, then the others above. */
  order_of_(names) {
    const named = [...new Set(names.map((name) =>
      this.layers_.findIndex((layer) => layer.name === name)))].filter((i) => i >= 0);
    return [...named, ...this.layers_.keys()].filter((i, at, all) => all.indexOf(i) === at);
  }

  tell_unknown_layers_({ on, styles }) {
    const known = new Set(this.layers_.map(({ name }) => name));
    const unknown = [...new Set([...(on ?? []), ...styles.keys()])].filter((name) => !known.has(name));
    if (unknown.length === 1) mention(`There is no layer "${unknown[0]}" here.`);
    if (unknown.length > 1) mention(`There are no layers ${in_quotes(unknown)} here.`);
  }

  /** Updates the panel after the defaults may have changed. */
  show_usual_() {
    this.states_.forEach((state, i) => {
      state.usual = usual_style(this.layers_[i], this.named_);
      this.rows_[i].show(state);
    });
    const against = this.compare_ === null ? null : this.against_;
    this.detail_.show({ shared: this.shared_, against }, this.usual_shared_());
    choose($("style"), this.shared_.get("style") ?? "");
    $("style-row").hidden = $("style").options.length < 2;
    // Visible until tiles load, and on some screens in hairlines between them.
    $("map").style.background = css_of(String(this.named_.background ?? "").replace(/^#/, ""));
  }

  /** The parameters of all layers if the address sets none. */
  usual_shared_() {
    const grows = (i) => Number(this.style_shown_(i).get("grow") ?? 0) > 0;
    // The server's default; if only some of the layers grow, that of these.
    const small = this.layers_on_().some(grows) ? "keep" : "dust";
    return new Map([["small", small], ...usual_shared(this.named_)]);
  }

  show_style_names_(names) {
    const chosen = $("style").value;
    this.style_names_ = names;
    $("style").replaceChildren(new Option("Default", ""),
      ...names.map((name) => new Option(name, name)));
    choose($("style"), chosen);
    $("style-row").hidden = $("style").options.length < 2;
  }

  /** The document of the style named in `shared`; removes an unknown name from it. */
  async load_named_style_(shared) {
    const named = await load_style(BASE, shared.get("style"));
    if (named) return named;
    mention(`There is no style "${shared.get("style")}".`);
    shared.delete("style");
    return {};
  }

  async change_named_style_(name) {
    const { view_: view } = this;
    const chosen = new Map(name ? [["style", name]] : []);
    const named = await this.load_named_style_(chosen);
    if (this.view_ !== view || $("style").value !== name) return;
    // Read only now: other settings may have been changed in the meantime.
    this.shared_ = new Map([...chosen, ...[...this.shared_].filter(([key]) => key !== "style")]);
    this.named_ = named;
    this.show_usual_();
    this.prove_all_();
  }

  go_to_(place) {
    if (place) this.map_.setView([place.lat, place.lon], Math.min(place.zoom, MAX_ZOOM));
    else show_boxes(this.map_, this.layers_.map(({ bounds }) => bounds));
  }

  zoom_to_(numbers) {
    const layers = numbers.map((i) => this.layers_[i]);
    show_boxes(this.map_, layers.map(({ bounds }) => bounds),
      Math.max(...layers.map(zoom_of_detail)));
  }

  change_(i, { is_on, style }) {
    this.states_[i].is_on = is_on;
    this.states_[i].style = style;
    this.list_.show_groups();
    this.prove_style_(i);
  }

  switch_all_(numbers, is_on) {
    for (const i of numbers) {
      this.states_[i].is_on = is_on;
      this.rows_[i].box.checked = is_on;
    }
    this.list_.show_groups();
    this.refresh_();
  }

  reorder_(order) {
    this.order_ = order;
    this.refresh_();
  }

  change_detail_() {
    const { shared, against } = this.detail_.read();
    const named = [...this.shared_].filter(([key]) => key === "style");
    this.shared_ = new Map([...named, ...shared]);
    this.compare_ = against === null ? null : (this.compare_ ?? 0.5);
    this.against_ = against ?? this.against_;
    this.refresh_();
  }

  // ---- demonstrations

  /** All settings that a demonstration may change. */
  settings_() {
    return {
      shared: new Map(this.shared_), compare: this.compare_, against: this.against_,
      styles: this.states_.map(({ style }) => style),
    };
  }

  async take_settings_({ shared, compare, against, styles }) {
    this.shared_ = new Map(shared);
    this.compare_ = compare;
    this.against_ = against;
    this.states_.forEach((state, i) => (state.style = styles[i]));
    const named = await this.load_named_style_(this.shared_);
    if (this.shared_.get("style") !== shared.get("style")) return;
    this.named_ = named;
    this.show_usual_();
    this.prove_all_();
  }

  set_shared_(name, value) {
    this.shared_.set(name, value);
    this.show_usual_();
    this.refresh_();
  }

  compare_apart_(pixels) {
    this.compare_ = 0.5;
    this.against_ = "apart";
    this.set_shared_("simplify", String(pixels));
  }

  restyle_({ name, styles }) {
    const { shared, ...rest } = this.settings_();
    shared.delete("style");
    if (name) shared.set("style", name);
    this.take_settings_({ ...rest, shared, styles: this.layers_.map((_, i) => styles[i] ?? new Map()) });
  }

  looks_() {
    const looks = all_looks(this.style_names_, this.layers_.length, (i) => usual_style(this.layers_[i], {}));
    return looks.map(({ styles, ...look }) =>
      ({ ...look, styles: styles.map((style, i) => new Map(taken_by(this.layers_[i], style))) }));
  }

  /** The address of the tile in the middle of the map. */
  picture_of_({ name, styles }) {
    const layers = this.layers_on_().map((i) =>
      ({ name: this.layers_[i].name, style: styles[i] ?? new Map() }));
    const [lowest] = tile_requests(layers, this.request_settings_(new Map(name ? [["style", name]] : [])));
    if (!lowest) return "";
    const zoom = this.map_.getZoom();
    const { x, y } = this.map_.project(this.map_.getCenter(), zoom).divideBy(256).floor();
    const across = 2 ** zoom;
    return `${TILES}${lowest.path}/${zoom}/${((x % across) + across) % across}/${y}.png${lowest.query}`;
  }

  /** Validates a style on the server before tiles are requested; the map keeps the last valid style. */
  async prove_style_(i) {
    const state = this.states_[i];
    const { style } = state;
    if (style.size === 0) state.drawn = style;
    this.refresh_();
    const name = this.shared_.get("style");
    const { problem = null, entries = [], values_title } =
      await ask_legend(BASE, this.layers_[i].name, style, name);
    if (this.states_[i] !== state || state.style !== style) return;
    if (this.shared_.get("style") !== name) return;
    this.rows_[i].show_problem(problem);
    if (problem && $("panel-body").hidden) {
      mention(`${this.title_of_(this.layers_[i].name)}: ${problem.detail}`);
    }
    if (!problem) Object.assign(state, { drawn: style, entries, values_title });
    else if (!state.drawn) this.draw_usual_(i, state, name);
    this.refresh_();
  }

  /** Draws the default style instead of an invalid style from the address. */
  async draw_usual_(i, state, name) {
    state.drawn = new Map();
    const { entries = [], values_title } =
      await ask_legend(BASE, this.layers_[i].name, state.drawn, name);
    if (state.drawn.size === 0) Object.assign(state, { entries, values_title });
    this.show_legend_();
  }

  /** Updates map and address, once for all simultaneous changes. */
  refresh_() {
    if (this.is_stale_) return;
    this.is_stale_ = true;
    queueMicrotask(() => {
      this.is_stale_ = false;
      this.draw_();
      this.write_address_();
    });
  }

  draw_() {
    const is_apart = this.against_ === "apart";
    const compared = new Map([...this.shared_, is_apart ? ["topology", "fast"] : ["simplify", "0"]]);
    // Styles not yet validated will be soon; the map waits for them, so that tiles are requested only once.
    const is_proved = this.states_.every(({ is_on, drawn }) => !is_on || drawn !== null);
    if (is_proved) {
      this.tiles_.show(this.tile_requests_(this.shared_));
      this.compared_tiles_.show(this.compare_ === null ? [] : this.tile_requests_(compared));
      this.show_attribution_(this.attributions_of_(this.layers_.map((_, i) => i)));
    }
    this.detail_.show_usual_small(this.usual_shared_().get("small"));
    this.show_outline_();
    this.tell_refused_();
    this.tell_end_of_detail_();
    const is_empty = this.layers_.length > 0 && this.states_.every(({ is_on }) => !is_on);
    notices.say("empty", is_empty ? "All layers are off. Turn one on in the list." : "");
    const { pixels } = this.detail_;
    const words = simplify_in_words(pixels);
    const simplified = pixels === 0 ? words : `simplified to ${words}`;
    this.comparison_.show(this.compare_, is_apart ? "shared borders" : simplified,
      is_apart ? "separate polygons" : "every vertex");
    this.show_legend_();
    $("tile-url").value = this.tile_url_();
  }

  tile_requests_(shared) {
    return tile_requests(this.drawn_layers_(), this.request_settings_(shared));
  }

  /** Adds the language of the browser if a layer has labels. */
  in_language_(shared) {
    const has_label = (i) => (this.style_shown_(i).get("label") ?? "none") !== "none";
    return this.language_ && this.layers_on_().some(has_label)
      ? new Map([...shared, ["label-language", this.language_]]) : shared;
  }

  style_shown_(i) {
    const { drawn, style, usual } = this.states_[i];
    return over(usual, drawn ?? style);
  }

  /** The attribution markup of layers, and of the tables joined to those that are on. */
  attributions_of_(layers) {
    const of_tables = layers.filter((i) => this.states_[i].is_on)
      .map((i) => this.tables_[this.style_shown_(i).get("values")]?.attribution);
    const all = [...layers.map((i) => this.layers_[i].attribution), ...of_tables];
    return [...new Set(all.filter((line) => typeof line === "string" && line !== ""))];
  }

  request_settings_(shared) {
    return {
      layers: this.layers_,
      shared: this.in_language_(shared),
      named: this.named_,
      has_background: Boolean(this.named_.background),
      folder: new URL(TILES).pathname,
    };
  }

  /** Shows the legend of the layers that are on and in view, the topmost first. */
  show_legend_() {
    const sections = this.layers_on_().flatMap((i) => {
      const { drawn, entries, values_title, usual } = this.states_[i];
      if (!drawn || entries.length === 0 || !is_in_view(this.map_, this.layers_[i].bounds)) return [];
      const title = this.title_of_(this.layers_[i].name);
      const layer = { ...this.layers_[i], title: values_title ? `${title}: ${values_title}` : title };
      return [legend_section(layer, entries, over(usual, drawn))];
    });
    // Replaced only if it changes, so that unfolded names stay unfolded while the map moves.
    const body = element("div", "", ...sections.reverse());
    if (body.innerHTML !== this.legend_markup_) {
      this.legend_markup_ = body.innerHTML;
      $("legend-body").replaceChildren(...body.childNodes);
    }
    $("legend").hidden = sections.length === 0;
  }

  /** Reports when the zoom is beyond the detail of all layers in view. */
  tell_end_of_detail_() {
    const zoom = this.map_.getZoom();
    const ends = this.layers_on_().map((i) => this.layers_[i])
      .filter(({ bounds }) => is_in_view(this.map_, bounds))
      .map(({ detail_zoom }) => (Number.isInteger(detail_zoom) ? detail_zoom : Infinity));
    const end = Math.max(...ends);
    if (zoom > end && end >= 0) {
      notices.say("detail", `There is no more detail here than at zoom ${end}.`,
        { action: [`Back to zoom ${end}`, () => this.map_.setZoom(end)] });
    } else {
      notices.say("detail", "");
    }
  }

  /** The numbers of the layers that are on, the lowest first. */
  layers_on_() {
    return this.order_.filter((i) => this.states_[i].is_on);
  }

  /** The layers that are on, the lowest first, in the style that is drawn. */
  drawn_layers_() {
    return this.layers_on_().filter((i) => this.states_[i].drawn)
      .map((i) => ({ name: this.layers_[i].name, style: this.states_[i].drawn }));
  }

  /** More than one address, the lowest first, if the server cannot draw all layers in one tile. */
  tile_url_() {
    return this.tile_requests_(this.shared_)
      .map(({ path, query }) => `${TILES}${path}/{z}/{x}/{y}.png${query}`).join(" ");
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
      attributions: this.attributions_of_(this.layers_on_().filter((i) => this.states_[i].drawn)),
      drawn,
      settings: { layers: this.layers_, shared: this.shared_, named: this.named_ },
      place: {
        lat: Number(lat.toFixed(5)), lon: Number(wrapped_longitude(lng).toFixed(5)),
        zoom: this.map_.getZoom(),
      },
      view: box_in_view(this.map_),
      min_zoom: Math.min(...zooms("minzoom", 0)),
      max_zoom: Math.max(...zooms("maxzoom", MAX_ZOOM)),
    };
  }

  // ---- features at a place

  what_is_asked_() {
    // Here, a style from the address that is not yet validated is treated like a drawn one.
    const layers = this.layers_on_().map((i) => {
      const { drawn, style } = this.states_[i];
      return { name: this.layers_[i].name, style: drawn ?? style };
    });
    const shapes = new Map([...usual_shared(this.named_), ...this.shared_]);
    return { base: BASE, layers, catalog: this.layers_, shared: this.shared_, shapes };
  }

  show_choice_() {
    this.show_outline_();
    this.write_address_();
  }

  show_outline_() {
    this.outline_tiles_.show(this.choice_.requests());
  }

  /** The distribution of the values of an attribute, in view or in the whole layer. */
  ask_values_(i, attribute, is_all) {
    const { drawn, usual } = this.states_[i];
    const filter = [...over(usual, drawn ?? new Map())].filter(([name]) => OF_FILTER.includes(name));
    return ask_values(BASE, this.layers_[i].name, attribute, is_all ? null : box_in_view(this.map_),
      filter);
  }

  // ---- the address

  async read_address_(hash) {
    const view = this.view_of_(hash);
    this.address_ = location.hash;
    this.coming_ = view;
    this.try_.forget();
    await this.show_view_(view);
    // Moving writes the address; skipped if another view has been requested in the meantime.
    const go = () => {
      if (this.view_ !== view) return;
      this.coming_ = null;
      if (view.place) this.go_to_(view.place);
      else this.write_address_();
    };
    // Leaflet accepts no other place while it zooms.
    if (this.is_zooming_) this.map_.once("zoomend", go);
    else go();
  }

  /** Writes only differences from the defaults, and adds no history entry. */
  write_address_() {
    // The browser has gone to another address, which is still to be shown, or even to be read.
    if (this.coming_ || location.hash !== this.address_) return;
    const { lat, lng } = this.map_.getCenter();
    const names = (numbers) => numbers.map((i) => this.layers_[i].name);
    const on = this.layers_.filter((_, i) => this.states_[i].is_on).map(({ name }) => name);
    const is_as_served = this.order_.every((i, at) => i === at);
    const hash = format_hash({
      place: { zoom: this.map_.getZoom(), lat, lon: lng },
      on: on.length === this.layers_.length ? null : on,
      // The style from the address until the server has validated it.
      styles: new Map(this.layers_.map(({ name }, i) =>
        [name, this.states_[i].drawn ?? this.states_[i].style])),
      shared: this.shared_,
      compare: this.compare_,
      against: this.against_ === "apart" ? "apart" : undefined,
      order: is_as_served ? null : names(this.order_),
      ...this.choice_.now,
    });
    // Slow in browsers, and some refuse frequent calls.
    if (hash !== location.hash) history.replaceState(null, "", hash);
    this.address_ = location.hash;
  }
}

make_foldable($("panel-toggle"), $("panel-body"), UPRIGHT);
make_foldable($("legend-toggle"), $("legend-body"), NARROW);
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
