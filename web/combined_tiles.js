// The tiles of one pane of the map, which show all layers that are on. Old tiles stay until the new ones
// have loaded, so that the map does not flicker. Failed tiles are recorded and requested again.
/* global L */

/** Where a tile failed, the tile of the previous zoom stays visible, as it does for a loading tile. */
const PatientTiles = L.TileLayer.extend({
  _tileReady(coords, error, tile) {
    if (error && this._map) this.fire("tileerror", { error, tile, coords });
    else L.TileLayer.prototype._tileReady.call(this, coords, error, tile);
  },
});

export class CombinedTiles {
  /**
   * @param map the Leaflet map
   * @param url address of the server's tiles folder, ending in '/'
   * @param pane name of a pane of the map
   * @param on {failed(url), refused_gone(), came(), loading(tiles still loading, all tiles)}
   */
  constructor(map, url, pane, on) {
    this.map_ = map;
    this.url_ = url;
    this.pane_ = pane;
    this.on_ = on;
    this.shown_ = []; // {key, request, tiles: Leaflet layer, images: by place, failed: by image}
    this.outdated_ = [];
    this.split_ = new Set(); // keys of requests that the server refused to draw in one tile
    this.refused_ = new Set(); // images that are not requested again
    this.requests_ = [];
  }

  /** Shows the result of tile_requests(); [] shows nothing. */
  show(requests) {
    this.requests_ = requests;
    const wanted = requests.flatMap((request) =>
      this.split_.has(key_of(request)) ? request.parts : [request]);
    const kept = new Map(this.shown_.map((sheet) => [sheet.key, sheet]));
    const next = wanted.map((request) => kept.get(key_of(request)) ?? this.new_sheet_(request));
    const is_same = next.length === this.shown_.length &&
      next.every((sheet, i) => sheet === this.shown_[i]);
    if (is_same) return;
    this.outdated_.push(...this.shown_.filter((sheet) => !next.includes(sheet)));
    for (const sheet of this.outdated_) this.forget_failures_(sheet);
    this.shown_ = next;
    next.forEach((sheet, i) => {
      sheet.tiles.setZIndex(i + 1);
      if (!this.map_.hasLayer(sheet.tiles)) sheet.tiles.addTo(this.map_);
    });
    this.tidy_();
  }

  /** The number of failed tiles. */
  missing() {
    return this.shown_.reduce((sum, { failed }) => sum + failed.size, 0);
  }

  /** Whether the server has refused some of them for good. */
  has_refused() {
    return this.refused_.size > 0;
  }

  /** Requests every missing tile again. */
  retry() {
    for (const { failed, waiting } of this.shown_) {
      for (const [image, url] of [...failed]) {
        if (this.refused_.has(image)) continue;
        failed.delete(image);
        waiting.add(image);
        image.src = url;
        this.tell_loading_();
      }
    }
  }

  /**
   * The server refuses to draw the tile at `url`: from now on its layers are requested one by one.
   * @returns whether that is possible; otherwise the tile is not requested again
   */
  give_way(url) {
    const sheet = this.shown_.find(({ failed }) => [...failed.values()].includes(url));
    if (!sheet) return true;
    if (sheet.request.parts.length) {
      this.split_.add(sheet.key);
      this.show(this.requests_);
      return true;
    }
    for (const [image, its_url] of sheet.failed) if (its_url === url) this.refused_.add(image);
    return false;
  }

  new_sheet_(request) {
    // {r} is "@2x" on a high-density screen. Braces in names are encoded, so only ours are replaced.
    const tiles = new PatientTiles(`${this.url_}${request.path}/{z}/{x}/{y}{r}.png${request.query}`, {
      minZoom: Math.max(request.min_zoom, this.map_.getMinZoom()),
      maxZoom: Math.min(request.max_zoom, this.map_.getMaxZoom()),
      pane: this.pane_,
    });
    const sheet = {
      key: key_of(request), request, tiles, images: new Map(), failed: new Map(), waiting: new Set(),
    };
    tiles.on("tileloadstart", ({ tile, coords }) => {
      sheet.images.set(place_of(coords), tile);
      sheet.waiting.add(tile);
      this.tell_loading_();
    });
    tiles.on("tileload", ({ tile, coords }) => {
      sheet.waiting.delete(tile);
      sheet.failed.delete(tile);
      if (this.is_shown_(sheet)) {
        this.hide_outdated_at_(place_of(coords));
        this.on_.came();
      }
      this.tidy_();
    });
    tiles.on("tileerror", ({ tile }) => {
      sheet.waiting.delete(tile);
      if (!this.is_shown_(sheet)) return this.tidy_();
      sheet.failed.set(tile, tile.src);
      this.tell_loading_();
      this.on_.failed(tile.src);
    });
    // A tile that is no longer needed before it has loaded is aborted, not unloaded.
    tiles.on("tileunload tileabort", ({ tile, coords }) => {
      sheet.images.delete(place_of(coords));
      sheet.waiting.delete(tile);
      sheet.failed.delete(tile);
      if (this.refused_.delete(tile)) this.on_.refused_gone();
      this.tidy_();
    });
    return sheet;
  }

  is_shown_(sheet) {
    return this.shown_.includes(sheet);
  }

  forget_failures_(sheet) {
    for (const image of sheet.failed.keys()) this.refused_.delete(image);
    sheet.failed.clear();
    this.on_.refused_gone();
  }

  /** Hides old tiles where all new ones have loaded, because they would show through. */
  hide_outdated_at_(place) {
    const has_come = ({ images, waiting, failed }) => {
      const image = images.get(place);
      return image === undefined || (!waiting.has(image) && !failed.has(image));
    };
    if (!this.shown_.every(has_come)) return;
    for (const { images } of this.outdated_) {
      const image = images.get(place);
      if (image) image.style.visibility = "hidden";
    }
  }

  /** Removes old tiles when all new ones have loaded. */
  tidy_() {
    const is_whole = this.shown_.every(({ waiting, failed }) => !waiting.size && !failed.size);
    if (is_whole) {
      for (const { tiles } of this.outdated_.splice(0)) tiles.remove();
    }
    this.tell_loading_();
  }

  tell_loading_() {
    const sum = (count) => this.shown_.reduce((all, sheet) => all + count(sheet), 0);
    this.on_.loading(sum(({ waiting }) => waiting.size), sum(({ images }) => images.size));
  }
}

function key_of({ path, query }) {
  return path + query;
}

function place_of({ x, y, z }) {
  return `${z}/${x}/${y}`;
}
