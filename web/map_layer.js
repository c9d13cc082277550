// One layer of the server on the map: tiles in the current style, asked for again when they fail.
/* global L */

const TRIES = 5;
const FIRST_WAIT_MS = 500;

export class MapLayer {
  /**
   * @param map the Leaflet map
   * @param url address of the server's tiles folder, ending in '/'
   * @param layer of the catalog: {name, minzoom, maxzoom}; not shown at other zooms
   * @param options {z_index: higher lies above; pane: of the map; on_trouble: called with whether
   *   tiles are missing for good}
   */
  constructor(map, url, layer, options) {
    this.map_ = map;
    this.layer_ = layer;
    this.options_ = options;
    // {r} is "@2x" on a dense screen. Braces of a name are encoded: only ours are replaced.
    this.pattern_ = `${url}${encodeURIComponent(layer.name)}/{z}/{x}/{y}{r}.png`;
    this.query_ = null;
    this.tiles_ = null;
    this.outdated_ = [];
  }

  /**
   * Shows the tiles of a query, such as "" or "?fill=ff8800"; null shows none. Old tiles stay until
   * the new ones have come, so that the map does not blink.
   */
  show(query) {
    if (query === this.query_) return;
    this.query_ = query;
    if (this.tiles_) this.outdated_.push(this.tiles_);
    this.tiles_ = null;
    if (query === null) this.remove_outdated_();
    else this.add_tiles_();
  }

  add_tiles_() {
    const tiles = L.tileLayer(this.pattern_ + this.query_, {
      minZoom: zoom_or(this.layer_.minzoom, this.map_.getMinZoom()),
      maxZoom: zoom_or(this.layer_.maxzoom, this.map_.getMaxZoom()),
      zIndex: this.options_.z_index,
      pane: this.options_.pane,
    });
    tiles.on("tileerror", ({ tile }) => this.try_again_(tiles, tile));
    tiles.on("tileload", () => this.options_.on_trouble(false));
    tiles.on("load", () => tiles === this.tiles_ && this.remove_outdated_());
    this.tiles_ = tiles.addTo(this.map_);
  }

  remove_outdated_() {
    for (const tiles of this.outdated_.splice(0)) tiles.remove();
  }

  try_again_(tiles, tile) {
    const tries = Number(tile.dataset.tries ?? 1);
    if (tries >= TRIES) {
      this.options_.on_trouble(true);
      return;
    }
    tile.dataset.tries = tries + 1;
    const url = tile.src;
    const wait = FIRST_WAIT_MS * 2 ** (tries - 1);
    setTimeout(() => {
      // Leaflet empties or removes a tile that is no longer wanted.
      if (tile.isConnected && this.map_.hasLayer(tiles) && tile.src === url) tile.src = url;
    }, wait);
  }
}

function zoom_or(zoom, otherwise) {
  return Number.isInteger(zoom) ? zoom : otherwise;
}
