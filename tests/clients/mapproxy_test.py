"""MapProxy reads our tiles through a URL template and serves them unchanged."""

import io

from mapproxy_site import GLOBALS, MapProxySite
from served_map import get, served_map
from PIL import Image

CONFIG = """
services:
  wmts:
layers:
  - name: land
    title: Land
    tile_sources: [land]
caches:
  land:
    grids: [GLOBAL_WEBMERCATOR]
    sources: [trapeze]
    format: image/png
sources:
  trapeze:
    type: tile
    grid: GLOBAL_WEBMERCATOR
    url: {base}tiles/land,lake/%(z)s/%(x)s/%(y)s.png?lake.fill=ff0000
    transparent: true
""" + GLOBALS


def pixels(png):
    return Image.open(io.BytesIO(png)).convert("RGBA").tobytes()


with served_map() as (base, folder):
    site = MapProxySite(CONFIG.format(base=base, folder=folder), folder)
    for z, x, y in [(0, 0, 0), (5, 16, 11), (5, 17, 11), (7, 66, 45), (5, 0, 0)]:
        status, body = site.ask(f"/wmts/land/GLOBAL_WEBMERCATOR/{z}/{x}/{y}.png")
        assert status.startswith("200"), (status, body[:500])
        own = get(f"{base}tiles/land,lake/{z}/{x}/{y}.png?lake.fill=ff0000")
        assert pixels(body) == pixels(own), f"{z}/{x}/{y} differs"
    print("MapProxy passes on 5 tiles, pixel by pixel")
