// Exports the current view as snippets and addresses for other programs.

import { attribution_nodes } from "./attribution.js";
import { button, element, input } from "./elements.js";
import {
  address, curl_command, image_tag, leaflet_page, maplibre_page, openlayers_page, qgis_connections,
  seed_command,
} from "./share_snippets.js";
import { keep_style, shared_style } from "./share_style.js";
import { parameters_of_layers, query_part } from "./tile_query.js";
import { LONGEST, LONGEST_PLACE, MOST_LAYERS } from "./tile_requests.js";

const COPIED_MS = 1500;
const POSTED_TABLE = /^[0-9a-f]{40}$/; // its id; tables of the configuration have names

const TABS = [
  ["Leaflet", (map) => [snippet("A whole page: save it as a file and open it.", leaflet_page(map))]],
  ["OpenLayers", (map) => [snippet("A whole page: save it as a file and open it.",
    openlayers_page(map))]],
  ["MapLibre", (map) => [snippet("A whole page: save it as a file and open it.",
    maplibre_page(map))]],
  ["QGIS", qgis_parts],
  ["<img>", (map) => [snippet("The tile in the centre of the map, sharp on high-density screens.",
    image_tag(map))]],
  ["curl", (map) => [snippet("The tile in the centre of the map, 512 pixels wide.",
    curl_command(map))]],
  ["Archive", archive_parts],
  ["Links", link_parts],
];

export class SharePanel {
  /**
   * @param base address of the server's folder
   * @param look returns the current view: {names and titles of layers, the lowest first;
   *   attributions; drawn and settings for shared_style(); place, min_zoom, max_zoom}
   */
  constructor(base, look) {
    this.base_ = base;
    this.look_ = look;
    this.chosen_ = 0;
    this.make_();
  }

  make_() {
    const close = button("×", { "aria-label": "Close" });
    close.addEventListener("click", () => this.node_.close());
    this.tabs_ = TABS.map(([name], i) => {
      const tab = button(name, { role: "tab", id: `share-tab-${i}`, "aria-controls": "share-body" });
      tab.addEventListener("click", () => this.choose_(i));
      return tab;
    });
    const tab_list = element("div", "tabs", ...this.tabs_);
    tab_list.setAttribute("role", "tablist");
    tab_list.setAttribute("aria-label", "Programs");
    tab_list.addEventListener("keydown", (event) => this.move_(event));
    this.body_ = element("div", "share-body");
    this.body_.id = "share-body";
    this.body_.setAttribute("role", "tabpanel");
    this.body_.tabIndex = 0;
    this.long_ = input("checkbox");
    this.long_.addEventListener("change", () => this.fill_());
    this.long_row_ = element("label", "check", this.long_,
      element("span", "", "Long, permanent URLs"));
    this.note_ = element("p", "hint");
    this.note_.setAttribute("role", "status");
    const title = element("h2", "", "Use this map");
    title.id = "share-title";
    this.node_ = element("dialog", "share", element("header", "", title, close), tab_list,
      this.body_, element("footer", "", this.note_, this.long_row_));
    this.node_.setAttribute("aria-labelledby", "share-title");
    this.node_.addEventListener("click", (event) => {
      if (event.target === this.node_) this.node_.close(); // a click beside the panel
    });
    document.body.append(this.node_);
  }

  async open() {
    const seen = this.look_();
    this.seen_ = { ...seen, style: shared_style(seen.drawn, seen.settings) };
    this.id_ = null;
    this.problem_ = "";
    this.node_.showModal();
    this.tabs_[this.chosen_].focus();
    const { document } = this.seen_.style;
    if (document && this.seen_.names.length) await this.keep_(document);
    else this.fill_();
  }

  /** Stores the edited style on the server. */
  async keep_(document) {
    const seen = this.seen_;
    this.body_.replaceChildren(element("p", "hint", "Posting the style to the server."));
    this.note_.textContent = "";
    this.long_row_.hidden = true;
    try {
      // Posted every time the panel opens, because the server may have evicted the style.
      const id = await keep_style(this.base_, document);
      if (this.seen_ === seen) this.id_ = id;
    } catch (error) {
      if (this.seen_ === seen) this.problem_ = error.message;
    }
    if (this.seen_ === seen) this.fill_();
  }

  fill_() {
    this.choose_(this.chosen_);
    this.long_row_.hidden = !this.has_document_() || this.id_ === null;
    this.note_.textContent = this.has_document_() ? this.note_for_() : "";
  }

  has_document_() {
    return Boolean(this.seen_.style.document) && this.seen_.names.length > 0;
  }

  note_for_() {
    if (this.problem_) return `There is no short URL (${this.problem_}), but this one is permanent.`;
    if (this.long_.checked) return "The URL contains the whole style.";
    return "Short, because the server keeps this style in memory; it is lost when the server restarts.";
  }

  choose_(chosen) {
    this.chosen_ = chosen;
    this.tabs_.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === chosen));
      tab.tabIndex = i === chosen ? 0 : -1;
    });
    this.body_.setAttribute("aria-labelledby", `share-tab-${chosen}`);
    const [, parts_of] = TABS[chosen];
    this.note_.parentElement.hidden = !this.has_document_() || parts_of === archive_parts;
    this.body_.replaceChildren(...(this.seen_.names.length ? parts_of(this.map_())
      : [element("p", "hint", "All layers are off: there is nothing to show.")]));
    this.body_.scrollTop = 0;
  }

  move_(event) {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const last = TABS.length - 1;
    const to = event.key === "Home" ? 0 : event.key === "End" ? last
      : step && (this.chosen_ + step + TABS.length) % TABS.length;
    if (to === undefined) return;
    event.preventDefault();
    this.choose_(to);
    this.tabs_[to].focus();
  }

  /** The current view, with its addresses. */
  map_() {
    const { titles, attributions, style, place, view, min_zoom, max_zoom } = this.seen_;
    const sheets = this.sheets_();
    const links = sheets.flatMap((sheet, i) => this.links_of_(sheet, sheets.length > 1 ? i + 1 : ""));
    return {
      title: titles.join(", "),
      attribution: [...new Set(attributions)].map(safe_markup).join(" | "),
      sheets, place, view, min_zoom, max_zoom,
      wmts: `${this.base_}wmts.xml`,
      style_name: style.document ? null : style.name ?? null,
      has_style: style.document !== null,
      links: [
        ...links,
        ["WMTS", "capabilities for GIS programs: each layer separately", `${this.base_}wmts.xml`],
        ["Catalogue", "all layers of the server", `${this.base_}catalog`],
        ["This page", "with all settings", location.href],
      ],
    };
  }

  /** As few addresses as possible, the lowest first. */
  sheets_() {
    const query_of = this.query_(this.id_ === null || this.long_.checked);
    const lasting_of = this.query_(true);
    const sheets = [];
    const sheet_of = (names, is_lowest) => {
      // A background would hide the sheets below.
      const above = is_lowest ? [] : [["background", "0000"]];
      const parameters = [...query_of(names), ...above];
      const path = `${this.base_}tiles/${encoded_list(names)}`;
      const lasting = [...lasting_of(names), ...above];
      return { names, parameters, lasting, path, query: query_text_of(parameters) };
    };
    const fits = ({ names, path, query }) => names.length <= MOST_LAYERS &&
      path.length + LONGEST_PLACE + query.length <= LONGEST;
    for (const name of this.seen_.names) {
      const last = sheets.at(-1);
      const longer = last && sheet_of([...last.names, name], sheets.length === 1);
      if (longer && fits(longer)) sheets[sheets.length - 1] = longer;
      else sheets.push(sheet_of([name], sheets.length === 0));
    }
    return sheets;
  }

  links_of_({ names, parameters, path, query }, number) {
    const collections = query_text_of([["collections", names.join(",")], ...parameters]);
    return [
      [`TileJSON ${number}`, "for MapLibre, OpenLayers and others", `${path}.json${query}`],
      [`TileJSON @2x ${number}`, "the same for high-density screens", `${path}@2x.json${query}`],
      [`OGC API – Tiles ${number}`, "the tilesets of this map",
        `${this.base_}ogc/map/tiles${collections}`],
      [`Legend ${number}`, "as a picture",
        `${this.base_}legend/${encoded_list(names)}.png${query}`],
    ].map(([name, ...rest]) => [name.trim(), ...rest]);
  }

  /** A function from layer names to the parameters of their style; by its id unless `is_long`. */
  query_(is_long) {
    const { name, document, styled, shared } = this.seen_.style;
    if (document && !is_long) return () => [["style", this.id_]];
    if (!document) return () => (name ? [["style", name]] : []);
    return (names) => parameters_of_layers(styled.filter((layer) => names.includes(layer.name)),
      [...shared]);
  }
}

function encoded_list(names) {
  return names.map(encodeURIComponent).join(",");
}

/** Encodes apostrophes, which could end a string in a shell. */
function query_text_of(parameters) {
  return query_part(parameters).replaceAll("'", "%27");
}

function safe_markup(line) {
  const box = element("span", "", ...attribution_nodes(line));
  for (const link of box.querySelectorAll("a")) {
    link.removeAttribute("target");
    link.removeAttribute("rel");
  }
  return box.innerHTML;
}

// ---- contents of the tabs

function snippet(words, text) {
  const code = element("code", "", text);
  const box = element("pre", text.includes("\n") ? "" : "wrapped", code);
  box.tabIndex = 0; // for scrolling with the keyboard
  return element("section", "snippet",
    element("div", "over", element("p", "hint", words), copy_button(text, code)), box);
}

function copy_button(text, shown) {
  const control = button("Copy");
  control.addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // No clipboard without a secure connection, or without permission: falls back to execCommand.
      getSelection().selectAllChildren(shown);
      document.execCommand("copy");
    }
    control.textContent = "Copied";
    setTimeout(() => (control.textContent = "Copy"), COPIED_MS);
  });
  return control;
}

function qgis_parts(map) {
  const file = element("a", "download", "Save the connection as a file");
  file.href = `data:text/xml;charset=utf-8,${encodeURIComponent(qgis_connections(map))}`;
  file.download = "trapeze.xml";
  const style = map.has_style ? "A style edited in the viewer is available via XYZ only."
    : map.style_name ? `Choose its style "${map.style_name}".` : "";
  return [
    element("h3", "", "XYZ: this map"),
    ...map.sheets.map((sheet) => snippet(
      "Browser, XYZ Tiles, New Connection. Tile resolution: High (512 × 512).",
      address(sheet, "{z}/{x}/{y}@2x"))),
    element("p", "hint", file, ", for Load Connections."),
    element("h3", "", "WMTS: each layer separately"),
    snippet(`Browser, WMS/WMTS, New Connection. ${style}`, map.wmts),
  ];
}

function archive_parts(map) {
  const is_posted = ([key, value]) => /(^|\.)values$/.test(key) && POSTED_TABLE.test(value);
  return [
    ...map.sheets.map((sheet, i) => snippet(
      "Run this on the server, next to its configuration: all tiles of the current view in one file.",
      seed_command(map, sheet, map.sheets.length > 1 ? i + 1 : ""))),
    ...(map.sheets.some(({ lasting }) => lasting.some(is_posted)) ? [element("p", "hint",
      "Only this server knows the pasted table: add it to the configuration first.")]
      : []),
    element("p", "hint", "If the server was started with files, name them instead of --config. " +
      "The output can also be .mbtiles or a folder; --dry-run estimates its size."),
  ];
}

function link_parts(map) {
  return [element("ul", "links", ...map.links.map(([name, words, url]) => {
    const link = element("a", "", name);
    link.href = url;
    link.target = "_blank";
    link.rel = "noopener";
    const shown = element("span", "url", url);
    return element("li", "", element("div", "", link, element("span", "hint", words), shown),
      copy_button(url, shown));
  }))];
}
