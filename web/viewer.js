// The viewer: all layers of the server over each other, with the place and what was changed kept
// in the address.
/* global L */

import { attribution_nodes, link_to } from "./attribution.js";
import { load_catalog } from "./catalog.js";
import { layer_row } from "./layer_panel.js";
import { MapLayer } from "./map_layer.js";
import { format_hash, parse_hash } from "./place_hash.js";

const MAX_ZOOM = 22;
const MAX_LATITUDE = 85.0511287798066;
// For layers whose style the catalog does not tell.
const COLOURS = ["d8c99b", "4f8fba", "8aa867", "c97b63", "9a86b8", "d8a94c"];
const OPACITY = 0.8;

const $ = (id) => document.getElementById(id);

// ---- what is said at the foot of the map

function say(text) {
  $("status").textContent = text;
  $("status").hidden = text === "";
}

const troubled_layers = new Set();

function tell_trouble(name, is_missing_tiles) {
  const before = troubled_layers.size;
  if (is_missing_tiles) troubled_layers.add(name);
  else troubled_layers.delete(name);
  if (troubled_layers.size === before) return;
  say(troubled_layers.size ? "Some tiles could not be loaded. Move the map to try again." : "");
}

// ---- layers as the catalog gives them

/** Anything may stand in the catalog: only what has a name can be shown. */
function usable_layers(catalog) {
  return catalog.layers.filter((layer) => typeof layer?.name === "string" && layer.name !== "");
}

function style_of_catalog(layer, i) {
  const fill = /^#?([0-9a-f]{6})$/i.exec(layer.style?.fill ?? "")?.[1];
  const opacity = layer.style?.["fill-opacity"];
  return {
    fill: (fill ?? COLOURS[i % COLOURS.length]).toLowerCase(),
    opacity: opacity >= 0 && opacity <= 1 ? opacity : fill ? 1 : OPACITY,
  };
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
    wheelPxPerZoomLevel: 120, // one notch of a mouse wheel is one zoom
  });
  L.control.scale({ position: "bottomleft", imperial: false }).addTo(map);
  return map;
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

function make_panel_foldable() {
  const toggle = $("panel-toggle");
  const open = (is_open) => {
    toggle.setAttribute("aria-expanded", String(is_open));
    $("panel-body").hidden = !is_open;
  };
  toggle.addEventListener("click", () => open($("panel-body").hidden));
  open(!window.matchMedia("(max-width: 600px)").matches);
}

/** Keeps panel, map and address the same, whichever of them changes. */
class Viewer {
  constructor(catalog) {
    this.layers_ = usable_layers(catalog);
    this.defaults_ = this.layers_.map(style_of_catalog);
    this.states_ = this.states_of_(parse_hash(location.hash));
    this.map_ = make_map();
    this.go_to_(parse_hash(location.hash).place);

    const tiles = new URL("tiles/", document.baseURI).href;
    this.map_layers_ = this.layers_.map((layer, i) =>
      new MapLayer(this.map_, tiles, layer, i + 1, (missing) => tell_trouble(layer.name, missing)));
    this.rows_ = this.layers_.map((layer, i) =>
      layer_row(layer, this.states_[i], (state) => this.change_(i, state)));
    // The list reads from top to bottom as the layers lie over each other.
    $("layers").replaceChildren(...this.rows_.map(({ row }) => row).reverse());
    show_attribution(this.map_, this.layers_);
    show_about(catalog, this.layers_);

    this.draw_();
    this.map_.on("moveend", () => this.write_address_());
    window.addEventListener("hashchange", () => this.read_address_());
    this.write_address_();
  }

  states_of_(view) {
    return this.layers_.map(({ name }, i) => ({
      is_on: view.on === null || view.on.includes(name),
      style: view.styles.get(name) ?? this.defaults_[i],
    }));
  }

  go_to_(place) {
    if (place) this.map_.setView([place.lat, place.lon], Math.min(place.zoom, MAX_ZOOM));
    else show_everything(this.map_, this.layers_);
  }

  change_(i, state) {
    this.states_[i] = state;
    this.draw_();
    this.write_address_();
  }

  draw_() {
    this.map_layers_.forEach((layer, i) => {
      layer.restyle(this.states_[i].style);
      layer.show(this.states_[i].is_on);
    });
  }

  read_address_() {
    const view = parse_hash(location.hash);
    this.states_ = this.states_of_(view);
    this.rows_.forEach(({ show }, i) => show(this.states_[i]));
    this.draw_();
    if (view.place) this.go_to_(view.place);
  }

  /** Says only what differs from the defaults, and makes no step in the history. */
  write_address_() {
    const { lat, lng } = this.map_.getCenter();
    const on = this.layers_.filter((_, i) => this.states_[i].is_on).map(({ name }) => name);
    const styles = new Map();
    this.layers_.forEach(({ name }, i) => {
      const { fill, opacity } = this.states_[i].style;
      const { fill: usual_fill, opacity: usual_opacity } = this.defaults_[i];
      if (fill !== usual_fill || opacity !== usual_opacity) styles.set(name, { fill, opacity });
    });
    const hash = format_hash({
      place: { zoom: this.map_.getZoom(), lat, lon: lng },
      on: on.length === this.layers_.length ? null : on,
      styles,
    });
    history.replaceState(null, "", hash);
  }
}

make_panel_foldable();
const catalog = await load_catalog(new URL("catalog", document.baseURI), say);
if (usable_layers(catalog).length === 0) say("The server has no layers.");
new Viewer(catalog);
