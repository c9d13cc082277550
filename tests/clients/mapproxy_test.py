"""MapProxy reads our tiles by the pattern of addresses and serves them as they are."""

import io
import os
import sys

from served_map import get, served_map, skip

try:
    from mapproxy.wsgiapp import make_wsgi_app
    from PIL import Image
except ImportError as error:
    skip(f"MapProxy is not installed ({error})")

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
globals:
  cache:
    base_dir: {folder}/cache
    lock_dir: {folder}/locks
  image:
    paletted: false
"""


def ask(app, path):
    """Status and body of a GET to the application."""
    seen = []
    environ = {
        "REQUEST_METHOD": "GET", "PATH_INFO": path, "QUERY_STRING": "", "SCRIPT_NAME": "",
        "SERVER_NAME": "localhost", "SERVER_PORT": "80", "SERVER_PROTOCOL": "HTTP/1.1",
        "HTTP_HOST": "localhost", "wsgi.url_scheme": "http", "wsgi.input": io.BytesIO(),
        "wsgi.errors": sys.stderr, "wsgi.version": (1, 0), "wsgi.multithread": False,
        "wsgi.multiprocess": False, "wsgi.run_once": False,
    }
    body = b"".join(app(environ, lambda status, headers, exc=None: seen.append(status)))
    return seen[0], body


def pixels(png):
    return Image.open(io.BytesIO(png)).convert("RGBA").tobytes()


with served_map() as (base, folder):
    config = os.path.join(folder, "mapproxy.yaml")
    with open(config, "w", encoding="utf-8") as file:
        file.write(CONFIG.format(base=base, folder=folder))
    app = make_wsgi_app(config)
    for z, x, y in [(0, 0, 0), (5, 16, 11), (5, 17, 11), (7, 66, 45), (5, 0, 0)]:
        status, body = ask(app, f"/wmts/land/GLOBAL_WEBMERCATOR/{z}/{x}/{y}.png")
        assert status.startswith("200"), (status, body[:500])
        own = get(f"{base}tiles/land,lake/{z}/{x}/{y}.png?lake.fill=ff0000")
        assert pixels(body) == pixels(own), f"{z}/{x}/{y} differs"
    print("MapProxy passes on 5 tiles, pixel by pixel")
