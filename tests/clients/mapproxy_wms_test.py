"""MapProxy requests our maps over WMS: cached as tiles, and reprojected to a grid that it does not request."""

import io
import os
import sys

from mapproxy_site import GLOBALS, MapProxySite
from served_map import get, served_map
from PIL import Image, ImageChops

SERVED = """
[server]
address = "127.0.0.1"

[[layer]]
name = "land"
file = "{fixtures}/land.geojson"
crs = ["EPSG:3857", "EPSG:25832"]
style = {{ fill = "#d8c99b", stroke = "none" }}
"""

CONFIG = """
services:
  wmts:
  wms:
    srs: ["EPSG:3857", "EPSG:25832"]
layers:
  - name: cached
    title: Land
    sources: [cache]
  - name: native
    title: Land in two systems
    sources: [both]
caches:
  cache:
    grids: [GLOBAL_WEBMERCATOR]
    sources: [mercator]
    format: image/png
sources:
  mercator:
    type: wms
    supported_srs: ["EPSG:3857"]
    req: &request
      url: {base}wms?quality=exact
      layers: land
      transparent: true
    wms_opts: &options
      version: 1.3.0
  both:
    type: wms
    supported_srs: ["EPSG:3857", "EPSG:25832"]
    req: *request
    wms_opts: *options
""" + GLOBALS
PLACE = (200000, 4700000, 1200000, 5700000)  # in UTM, with the lake, the bay and the eastern coast
SIZE = 500
TOLERANCE = 2  # of 255: MapProxy rounds sides of windows
MOST_WARPED = 0.02  # of all pixels, those along borders


def picture(png):
    return Image.open(io.BytesIO(png)).convert("RGBA")


def on_white(one):
    return Image.alpha_composite(Image.new("RGBA", one.size, "white"), one)


def share_of_different(one, other):
    assert one.size == other.size, (one.size, other.size)
    difference = ImageChops.difference(on_white(one), on_white(other)).convert("RGB")
    different = [max(pixel) > TOLERANCE for pixel in difference.getdata()]
    return sum(different) / len(different)


def map_by_mapproxy(site, layer):
    box = ",".join(map(str, PLACE))
    status, body = site.ask("/service", f"SERVICE=WMS&VERSION=1.3.0&REQUEST=GetMap&LAYERS={layer}&STYLES="
                            f"&CRS=EPSG:25832&BBOX={box}&WIDTH={SIZE}&HEIGHT={SIZE}&FORMAT=image/png"
                            "&TRANSPARENT=TRUE")
    assert status.startswith("200"), (status, body[:500])
    return picture(body)


with served_map(SERVED) as (base, folder):
    site = MapProxySite(CONFIG.format(base=base, folder=folder), folder)
    for z, x, y in [(5, 16, 11), (5, 17, 11), (7, 66, 45), (5, 0, 0)]:
        own = picture(get(f"{base}tiles/land/{z}/{x}/{y}.png?quality=exact"))
        for _ in ("drawn", "cached"):
            status, body = site.ask(f"/wmts/cached/GLOBAL_WEBMERCATOR/{z}/{x}/{y}.png")
            assert status.startswith("200"), (status, body[:500])
            share = share_of_different(picture(body), own)
            assert share <= 0.0005, f"{z}/{x}/{y} differs in {share:.4f}"
    assert os.listdir(os.path.join(folder, "cache")), "nothing was cached"
    print("MapProxy caches maps of WMS as the tiles they are")

    box = ",".join(map(str, PLACE))
    own = picture(get(f"{base}map/land.png?crs=EPSG:25832&bbox={box}&width={SIZE}&height={SIZE}&quality=exact"))
    assert own.getchannel("A").getextrema() == (0, 255)
    share = share_of_different(map_by_mapproxy(site, "native"), own)
    assert share <= 0.0005, f"the map on the grid differs in {share:.4f}"
    warped = map_by_mapproxy(site, "cached")
    share = share_of_different(warped, own)
    assert share <= MOST_WARPED, f"the warped map differs in {share:.4f}"
    print(f"MapProxy passes on maps of UTM, and warps those of Web Mercator: {share:.4f} of the pixels differ")
sys.exit(0)
