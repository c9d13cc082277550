"""OWSLib reads our WMS capabilities, and requests maps, features and exceptions with them."""

import sys

from served_map import get, served_map, skip

try:
    from owslib.util import ServiceException
    from owslib.wms import WebMapService
except ImportError as error:
    skip(f"OWSLib is not installed ({error})")

BOX = (0.0, 5000000.0, 2500000.0, 7000000.0)
DEGREES = (0.0, 40.0, 25.0, 60.0)
SIZE = (500, 400)
COMMON = {"srs": "EPSG:3857", "bbox": BOX, "size": SIZE, "format": "image/png"}


def own_map(base, query):
    box = ",".join(str(number) for number in BOX)
    return get(f"{base}map/land.png?bbox={box}&crs=EPSG:3857&width={SIZE[0]}&height={SIZE[1]}{query}")


def check(base, version):
    wms = WebMapService(base + "wms", version=version)
    assert list(wms.contents) == ["land", "lake"], wms.contents
    assert {"GetCapabilities", "GetMap", "GetFeatureInfo", "GetLegendGraphic"} <= {
        operation.name for operation in wms.operations}
    land = wms["land"]
    assert land.queryable == 1 and "EPSG:3857" in land.crsOptions, land.crsOptions
    assert set(land.styles) == {"default", "night"}, land.styles
    assert land.boundingBox[4] == "EPSG:3857" and land.boundingBox[0] < land.boundingBox[2]
    assert get(land.styles["night"]["legend"]).startswith(b"\x89PNG")

    for style, query in (("", ""), ("night", "&style=night")):
        shown = wms.getmap(layers=["land"], styles=[style], transparent=True, **COMMON).read()
        assert shown == own_map(base, query), f"{version}: another picture in the style '{style}'"
    white = wms.getmap(layers=["land"], styles=[""], bgcolor="#FFFFFF", **COMMON).read()
    assert white == own_map(base, "&background=fff"), f"{version}: another background"

    # For boxes in degrees, OWSLib puts the axes into the order of the version.
    for system in ("EPSG:4326", "CRS:84"):
        if system == "CRS:84" and version == "1.1.1":
            continue
        assert system in land.crsOptions, land.crsOptions
        degrees = dict(COMMON, srs=system, bbox=DEGREES)
        shown = wms.getmap(layers=["land"], styles=[""], transparent=True, **degrees).read()
        box = ",".join(str(number) for number in DEGREES)
        own = get(f"{base}map/land.png?bbox={box}&crs={system}&width={SIZE[0]}&height={SIZE[1]}")
        assert shown == own, f"{version}: another picture in {system}"

    text = wms.getfeatureinfo(layers=["land"], query_layers=["land"], styles=[""],
                              info_format="text/plain", xy=(334, 244), **COMMON).read().decode()
    assert "mainland with a bay and a lake" in text, text
    try:
        wms.getmap(layers=["cake"], styles=[""], **COMMON)
        raise AssertionError("there is no such layer")
    except ServiceException as exception:
        assert "LayerNotDefined" in str(exception), exception
    print(f"OWSLib reads WMS {version}")


with served_map() as (address, _):
    for number in ("1.1.1", "1.3.0"):
        check(address, number)
sys.exit(0)
