// One layer of the server on the map: tiles in the current style, asked for again when they fail.
/* global L */

const TRIES = 5;
const FIRST_WAIT_MS = 500;

export class MapLayer {
  /**
   * @param map the Leaflet map
   * @param url address of the server's tiles folder, ending in '/'
   * @param layer of the catalog: {name, minzoom, maxzoom}; not shown at other zooms
   * @param z_index higher lies above
   * @param on_trouble called with whether tiles are missing for good
   */
  constructor(map, url, layer, z_index, on_trouble) {
    this.map_ = map;
    this.layer_ = layer;
    this.z_index_ = z_index;
    this.on_trouble_ = on_trouble;
    // {r} is "@2x" on a dense screen. Braces of a name are encoded: only ours are replaced.
    this.pattern_ = `${url}${encodeURIComponent(layer.name)}/{z}/{x}/{y}{r}.png`;
    this.query_ = "";
    this.is_on_ = false;
    this.tiles_ = null;
    this.outdated_ = [];
  }

  show(is_on) {
    if (is_on === this.is_on_) return;
    this.is_on_ = is_on;
    if (is_on) {
      this.add_tiles_();
    } else {
      this.remove_outdated_();
      this.tiles_.remove();
    }
  }

  /** The old tiles stay until the new ones have come, so that the map does not blink. */
  restyle({ fill, opacity }) {
    const query = `?fill=${fill}&fill-opacity=${Number(opacity.toFixed(2))}`;
    if (query === this.query_) return;
    this.query_ = query;
    if (!this.is_on_) return;
    this.outdated_.push(this.tiles_);
    this.add_tiles_();
  }

  add_tiles_() {
    const tiles = L.tileLayer(this.pattern_ + this.query_, {
      minZoom: zoom_or(this.layer_.minzoom, this.map_.getMinZoom()),
      maxZoom: zoom_or(this.layer_.maxzoom, this.map_.getMaxZoom()),
      zIndex: this.z_index_,
      className: `layer-${this.z_index_}`,
    });
    tiles.on("tileerror", ({ tile, coords }) => this.try_again_(tiles, tile, coords));
    tiles.on("tileload", () => this.on_trouble_(false));
    tiles.on("load", () => this.remove_outdated_());
    this.tiles_ = tiles.addTo(this.map_);
  }

  remove_outdated_() {
    for (const tiles of this.outdated_.splice(0)) tiles.remove();
  }

  try_again_(tiles, tile, coords) {
    const tries = Number(tile.dataset.tries ?? 1);
    if (tries >= TRIES) {
      this.on_trouble_(true);
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
