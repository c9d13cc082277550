"""MapProxy reads our tiles through a URL template and serves them unchanged, also as maps by WMS. The layer is the
one of docs/clients.md."""

import io
import os
import re

from mapproxy_site import GLOBALS, MapProxySite
from served_map import get, served_map
from PIL import Image

CONFIG = """
services:
  wmts:
  wms:
"""
DOCUMENT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/clients.md")
SERVED = "http://localhost:8080/tiles/countries/%(z)s/%(x)s/%(y)s.png"


def documented_layer(base):
    """The first configuration of the document, for our server, up to its globals."""
    with open(DOCUMENT, encoding="utf-8") as file:
        text = re.search(r"`{3}yaml\n(layers:.*?)^globals:", file.read(), re.DOTALL | re.MULTILINE).group(1)
    assert SERVED in text, text
    return text.replace(SERVED, f"{base}tiles/land,lake/%(z)s/%(x)s/%(y)s.png?lake.fill=ff0000")


def pixels(png):
    return Image.open(io.BytesIO(png)).convert("RGBA").tobytes()


with served_map() as (base, folder):
    site = MapProxySite(CONFIG + documented_layer(base) + GLOBALS.format(folder=folder), folder)
    for z, x, y in [(0, 0, 0), (5, 16, 11), (5, 17, 11), (7, 66, 45), (5, 0, 0)]:
        status, body = site.ask(f"/wmts/countries/GLOBAL_WEBMERCATOR/{z}/{x}/{y}.png")
        assert status.startswith("200"), (status, body[:500])
        own = get(f"{base}tiles/land,lake/{z}/{x}/{y}.png?lake.fill=ff0000")
        assert pixels(body) == pixels(own), f"{z}/{x}/{y} differs"
    print("MapProxy passes on 5 tiles, pixel by pixel")
    side = 20037508.342789244
    status, body = site.ask("/service", "SERVICE=WMS&VERSION=1.1.1&REQUEST=GetMap&LAYERS=countries&STYLES=&SRS=EPSG:3857"
                            f"&BBOX={-side},{-side},{side},{side}&WIDTH=256&HEIGHT=256&FORMAT=image/png"
                            "&TRANSPARENT=TRUE")
    assert status.startswith("200"), (status, body[:500])
    assert pixels(body) == pixels(get(f"{base}tiles/land,lake/0/0/0.png?lake.fill=ff0000")), "the map by WMS differs"
    print("MapProxy offers them by WMS")
