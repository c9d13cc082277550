"""A running `trapeze serve` with three layers in a corner of Europe, for the assertions of the test suites."""

import json
import os
from contextlib import contextmanager

from assertions import SCHEMAS  # noqa: F401  (says at once what is not installed)
from served_map import served_map

CONFIG = """
[server]
address = "127.0.0.1"

[limits]
map_pixels = 600000

[styles.night]
fill = "#102040"

[styles.dotted]
pattern = "dots"

[[layer]]
name = "woods"
title = "Woods & meadows"
description = "What is green"
attribution = "Nobody <nobody@example.org>"
file = "{folder}/woods.geojson"
crs = ["EPSG:3857", "EPSG:2056"]
min_zoom = 3
max_zoom = 12
style = {{ fill = "#228833", stroke = "none" }}

[[layer]]
name = "ponds"
file = "{folder}/ponds.geojson"
crs = ["EPSG:3857", "EPSG:2056"]
style = {{ fill = "#3366cc", stroke = "none" }}

[[layer]]
name = "diamond"
file = "{folder}/diamond.geojson"
crs = ["EPSG:3857", "EPSG:2056", "EPSG:3035"]
style = {{ fill = "#cc4433", stroke = "none" }}
"""


def box(west, south, east, north):
    return [[[west, south], [east, south], [east, north], [west, north], [west, south]]]


# Two ponds overlap at 7.5 E, 46.5 N.
POLYGONS = {
    "woods": [box(6.2, 45.4, 8.1, 46.9)],
    "ponds": [box(6.5, 46.0, 7.0, 46.4), box(7.3, 46.3, 7.7, 46.7), box(7.4, 46.4, 7.9, 46.6)],
    "diamond": [[[[7, 45.5], [8, 46.5], [7, 47.5], [6, 46.5], [7, 45.5]]]],
}


def write_layers(folder):
    for name, polygons in POLYGONS.items():
        features = [{"type": "Feature", "properties": {"name": f"{name} {i}"},
                     "geometry": {"type": "Polygon", "coordinates": rings}}
                    for i, rings in enumerate(polygons)]
        with open(os.path.join(folder, name + ".geojson"), "w", encoding="utf-8") as file:
            json.dump({"type": "FeatureCollection", "features": features}, file)


@contextmanager
def served_layers():
    with served_map(CONFIG, write_layers) as (base, _):
        yield base
