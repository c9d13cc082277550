"""WMS 1.3.0: every assertion of the OGC's test suite that a program can decide, under the names of its tests.

Dimensions, AUTO2, opaque layers, update sequences and unset metadata do not exist here. The assertions about them
check that they are absent, so that the tests fail once one of them is added.
"""

import json
import re
import sys

from assertions import (Suite, ask, expect_picture, expect_valid, has_schemas, with_query)
from layers import served_layers

WMS = "{http://www.opengis.net/wms}"
OGC = "{http://www.opengis.net/ogc}"
SLD = "{http://www.opengis.net/sld}"
HREF = "{http://www.w3.org/1999/xlink}href"
LOCATION = "{http://www.w3.org/2001/XMLSchema-instance}schemaLocation"
CAPABILITIES_SCHEMA = "wms/1.3.0/capabilities_1_3_0.xsd"
EXCEPTIONS_SCHEMA = "wms/1.3.0/exceptions_1_3_0.xsd"
PLACE = (6.0, 45.5, 8.0, 47.5)  # of the diamond
WHITE = (255, 255, 255, 255)
WOODS = (0x22, 0x88, 0x33, 255)
PONDS = (0x33, 0x66, 0xCC, 255)
DIAMOND = (0xCC, 0x44, 0x33, 255)

suite = Suite("WMS 1.3.0")


class Service:
    """The contents of the capabilities, and requests to the URLs in them."""

    def __init__(self, base):
        self.base = base
        self.document = ask(base + "wms?SERVICE=WMS&REQUEST=GetCapabilities&VERSION=1.3.0")
        self.root = self.document.xml()
        self.parents = {child: parent for parent in self.root.iter() for child in parent}
        self.map_formats = self.formats("GetMap")
        self.info_formats = self.formats("GetFeatureInfo")
        self.layers = [layer for layer in self.root.iter(WMS + "Layer")
                       if layer.find(WMS + "Name") is not None]
        self.names = [layer.find(WMS + "Name").text for layer in self.layers]
        self.png = next(name for name in self.map_formats if name.startswith("image/png"))

    def request(self, operation):
        return self.root.find(f"{WMS}Capability/{WMS}Request/{WMS}{operation}")

    def formats(self, operation):
        return [element.text for element in self.request(operation).findall(WMS + "Format")]

    def prefix(self, operation):
        return next(self.request(operation).iter(WMS + "OnlineResource")).get(HREF)

    def capabilities(self, **pairs):
        return ask(with_query(self.prefix("GetCapabilities"),
                              **{"REQUEST": "GetCapabilities", "SERVICE": "WMS", **pairs}))

    def map(self, **pairs):
        usual = {"VERSION": "1.3.0", "REQUEST": "GetMap", "LAYERS": "ponds", "STYLES": "",
                 "CRS": "CRS:84", "BBOX": ",".join(map(str, PLACE)), "WIDTH": 100, "HEIGHT": 100,
                 "FORMAT": self.png}
        return ask(with_query(self.prefix("GetMap"), **{**usual, **pairs}))

    def info(self, **pairs):
        usual = {"VERSION": "1.3.0", "REQUEST": "GetFeatureInfo", "LAYERS": "ponds",
                 "QUERY_LAYERS": "ponds", "STYLES": "", "CRS": "CRS:84",
                 "BBOX": ",".join(map(str, PLACE)), "WIDTH": 200, "HEIGHT": 200,
                 "FORMAT": self.png, "INFO_FORMAT": self.info_formats[0], "I": 150, "J": 100}
        return ask(with_query(self.prefix("GetFeatureInfo"), **{**usual, **pairs}))

    def lineage(self, layer):
        """The layer and its parents, the innermost first."""
        while layer is not None and layer.tag == WMS + "Layer":
            yield layer
            layer = self.parents.get(layer)

    def inherited(self, layer, name):
        return [element for one in self.lineage(layer) for element in one.findall(WMS + name)]

    def systems(self, layer):
        return [element.text for element in self.inherited(layer, "CRS")]

    def box(self, layer, system):
        return next(element for element in self.inherited(layer, "BoundingBox")
                    if element.get("CRS") == system)


def text_of(box):
    return ",".join(box.get(side) for side in ("minx", "miny", "maxx", "maxy"))


def expect_exception(answer, code=None):
    assert answer.type == "text/xml", answer.type
    expect_valid(answer.body, EXCEPTIONS_SCHEMA)
    report = answer.xml()
    assert report.tag == OGC + "ServiceExceptionReport", report.tag
    codes = [element.get("code") for element in report.findall(OGC + "ServiceException")]
    assert codes, "there is no exception"
    assert code is None or code in codes, codes


def expect_capabilities(answer, kind="text/xml"):
    assert answer.status == 200 and answer.type == kind, (answer.status, answer.type)
    assert answer.xml().tag == WMS + "WMS_Capabilities", answer.body[:200]


def colours(picture):
    return {colour for _, colour in picture.getcolors(picture.width * picture.height)}


# The basic elements of the service


@suite("basic_elements:negotiate-no-version", "basic_elements:negotiate-higher-version",
       "basic_elements:negotiate-basic_elements-version", "basic_elements:negotiate-lower-version")
def _(wms):
    """The version is the requested one, else the highest below it, else the lowest; by default the highest."""
    versions = {None: "1.3.0", "1.3.0": "1.3.0", "100.0.0": "1.3.0", "0.0.0": "1.1.1"}
    for asked, answered in versions.items():
        root = wms.capabilities(VERSION=asked).xml()
        assert root.get("version") == answered, (asked, root.get("version"))


@suite("basic_elements:escaped-chars")
def _(wms):
    """Values may be percent-encoded completely."""
    escaped = "".join(f"%{ord(c):02X}" for c in "GetCapabilities")
    expect_capabilities(ask(wms.prefix("GetCapabilities") + f"SERVICE=WMS&VERSION=1.3.0&REQUEST={escaped}"))


@suite("basic_elements:escaped-space")
def _(wms):
    """In a value, a plus is a space; no layer name contains a space."""
    assert all(" " not in name for name in wms.names)
    one = wms.map(filter="name='ponds 0'")
    expect_picture(one, wms.png)
    base = with_query(wms.prefix("GetMap"), VERSION="1.3.0", REQUEST="GetMap", LAYERS="ponds", STYLES="",
                      CRS="CRS:84", BBOX=",".join(map(str, PLACE)), WIDTH=100, HEIGHT=100, FORMAT=wms.png)
    assert ask(base + "&filter=name='ponds+0'").body == one.body != wms.map().body


@suite("basic_elements:extra-GetCapabilities-param", "basic_elements:extra-GetMap-param",
       "basic_elements:extra-GetFeatureInfo-param")
def _(wms):
    """Parameters that the standard does not define are ignored."""
    expect_capabilities(wms.capabilities(VERSION="1.3.0", BOGUS="ignored"))
    expect_picture(wms.map(BOGUS="ignored"), wms.png, (100, 100))
    answer = wms.info(BOGUS="ignored")
    assert answer.status == 200 and answer.type == wms.info_formats[0], answer.type


# GetCapabilities


@suite("getcapabilities:each-format", "getcapabilities:no-format", "getcapabilities:invalid-format")
def _(wms):
    """An offered format is sent; text/xml if no format or an unknown one is requested."""
    for kind in wms.formats("GetCapabilities"):
        expect_capabilities(wms.capabilities(VERSION="1.3.0", FORMAT=kind), kind)
    expect_capabilities(wms.capabilities(VERSION="1.3.0"))
    expect_capabilities(wms.capabilities(VERSION="1.3.0", FORMAT="invalid"))


@suite("getcapabilities:updatesequence-ignored", "getcapabilities:updatesequence-current",
       "getcapabilities:updatesequence-lower", "getcapabilities:updatesequence-higher")
def _(wms):
    """There is no update sequence, and a requested one is ignored."""
    assert wms.root.get("updateSequence") is None
    for sequence in ("ignored", "0", "9999"):
        expect_capabilities(wms.capabilities(VERSION="1.3.0", UPDATESEQUENCE=sequence))


@suite("getcapabilities:normative-schema", "getcapabilities:validate-using-schemaLocation")
def _(wms):
    """The document names the schema of the OGC and is valid against it."""
    places = wms.root.get(LOCATION).split()
    schemas = dict(zip(places[::2], places[1::2]))
    assert schemas["http://www.opengis.net/wms"] == (
        "http://schemas.opengis.net/wms/1.3.0/capabilities_1_3_0.xsd"), schemas
    expect_valid(wms.document.body, "sld/1.1.0/sld_capabilities.xsd")


@suite("getcapabilities:capability-onlineresource")
def _(wms):
    """The URLs for requests are prefixes to which a query can be appended."""
    links = list(wms.root.find(f"{WMS}Capability/{WMS}Request").iter(WMS + "OnlineResource"))
    assert len(links) >= 4
    for link in links:
        assert re.fullmatch(r"[^?]+\?(.*&)?", link.get(HREF)), link.get(HREF)


@suite("getcapabilities:capability-xml-getcapabilities-format",
       "getcapabilities:capability-xml-exception-format")
def _(wms):
    """Capabilities and exceptions are available as XML."""
    assert "text/xml" in wms.formats("GetCapabilities")
    exceptions = [element.text for element in wms.root.find(f"{WMS}Capability/{WMS}Exception")]
    assert exceptions[0] == "XML", exceptions


@suite("getcapabilities:bbox-crs-advertised", "getcapabilities:bbox-present",
       "getcapabilities:bbox-distinct-crs", "getcapabilities:crs-present",
       "getcapabilities:crs-auto2-declarations")
def _(wms):
    """Every layer has reference systems, none of them AUTO2, and one box in a system that it has."""
    for layer in wms.layers:
        systems = wms.systems(layer)
        assert systems and not any(name.startswith("AUTO2") for name in systems), systems
        assert wms.inherited(layer, "BoundingBox")
        for one in wms.lineage(layer):
            boxes = [element.get("CRS") for element in one.findall(WMS + "BoundingBox")]
            assert len(set(boxes)) == len(boxes), boxes
            assert set(boxes) <= set(wms.systems(one)), (boxes, wms.systems(one))


@suite("getcapabilities:crs-for-all-layers")
def _(wms):
    """The systems that all layers share are listed above them."""
    above = {element.text for element in wms.root.findall(f"{WMS}Capability/{WMS}Layer/{WMS}CRS")}
    common = set.intersection(*(set(wms.systems(layer)) for layer in wms.layers))
    assert common <= above, common - above
    for layer in wms.layers:
        repeated = above & {element.text for element in layer.findall(WMS + "CRS")}
        assert not repeated, repeated


@suite("getcapabilities:ex_geobbox-present", "getcapabilities:ex_geobbox-coordinates")
def _(wms):
    """Every layer has geographic bounds, west and south first."""
    for layer in wms.layers:
        west, east, south, north = (float(side.text) for side in
                                    wms.inherited(layer, "EX_GeographicBoundingBox")[0])
        assert west < east and south < north, (west, south, east, north)


@suite("getcapabilities:layer-extents")
def _(wms):
    """Boxes in degrees equal the geographic bounds, with axes in the order of the system, and have an area."""
    for layer in wms.root.iter(WMS + "Layer"):
        west, east, south, north = (float(side.text) for side in
                                    wms.inherited(layer, "EX_GeographicBoundingBox")[0])
        sides = {"EPSG:4326": (south, west, north, east), "CRS:84": (west, south, east, north)}
        seen = set()
        for element in layer.findall(WMS + "BoundingBox"):
            box = tuple(float(number) for number in text_of(element).split(","))
            assert box[0] < box[2] and box[1] < box[3], box
            seen.add(element.get("CRS"))
            expected = sides.get(element.get("CRS"), box)
            assert box == expected, (element.get("CRS"), box, expected)
        assert set(sides) <= seen, seen


@suite("getcapabilities:style-unique", "getcapabilities:style-legendurls",
       "getcapabilities:resource-format", "getcapabilities:resource-size")
def _(wms):
    """Style names are unique; their legends have the size and the type in the capabilities."""
    for layer in wms.layers:
        names = [style.find(WMS + "Name").text for style in wms.inherited(layer, "Style")]
        assert {"default", "night", "dotted"} == set(names) and len(names) == 3, names
        for legend in layer.iter(WMS + "LegendURL"):
            answer = ask(legend.find(WMS + "OnlineResource").get(HREF))
            size = (int(legend.get("width")), int(legend.get("height")))
            expect_picture(answer, legend.find(WMS + "Format").text, size)


@suite("getcapabilities:logourls", "getcapabilities:dataurls", "getcapabilities:featurelisturls",
       "getcapabilities:metadataurls", "getcapabilities:style-stylesheeturls",
       "getcapabilities:style-styleurls", "getcapabilities:authorityurl-unique",
       "getcapabilities:identifier-matches-authorityurl")
def _(wms):
    """Nothing is claimed that the configuration cannot express."""
    for name in ("LogoURL", "DataURL", "FeatureListURL", "MetadataURL", "StyleSheetURL", "StyleURL",
                 "AuthorityURL", "Identifier"):
        assert wms.root.find(f".//{WMS}{name}") is None, name


@suite("getcapabilities:dims-time", "getcapabilities:dims-elevation-crs88",
       "getcapabilities:dims-no-redeclarations", "recommendations:dims-no-whitespace",
       "recommendations:dims-defaults", "time:main", "vector_elevation:main", "raster_elevation:main")
def _(wms):
    """Layers have no dimensions."""
    assert wms.root.find(f".//{WMS}Dimension") is None


# GetMap


@suite("basic:gif-or-png", "recommendations:png-getmap-format")
def _(wms):
    """Maps are available as PNG."""
    assert "image/png" in wms.map_formats, wms.map_formats


@suite("getmap:bbox-direct", "getmap:bbox-inherited", "getmap:crs-direct", "getmap:crs-inherited",
       "getmap:each-crs", "getmap:each-layer", "getmap:each-layer-crs-combination",
       "recommendations:layer-crs")
def _(wms):
    """Every layer is drawn in every system that it has, in the box from the capabilities."""
    for layer, name in zip(wms.layers, wms.names):
        systems = wms.systems(layer)
        assert {"CRS:84", "EPSG:4326", "EPSG:3857", "EPSG:2056"} <= set(systems), systems
        for system in systems:
            boxed = system if not re.fullmatch(r"EPSG:(900913|10211[34]|102100)", system) else "EPSG:3857"
            answer = wms.map(LAYERS=name, CRS=system, BBOX=text_of(wms.box(layer, boxed)))
            expect_picture(answer, wms.png, (100, 100))
            assert len(colours(answer.picture())) > 1 or name != "diamond", (name, system)


@suite("getmap:bbox-below-scale", "getmap:bbox-above-scale")
def _(wms):
    """Outside the scales of a layer the map is empty, without an exception."""
    woods = wms.layers[wms.names.index("woods")]
    least = float(woods.find(WMS + "MinScaleDenominator").text)
    most = float(woods.find(WMS + "MaxScaleDenominator").text)
    assert 0 < least < most
    for denominator in (0.9 * least, 1.1 * most):
        side = denominator * 0.00028 * 200 * 360 / 40075016.6855785
        answer = wms.map(LAYERS="woods", WIDTH=200, HEIGHT=200, BBOX=f"7,46,{7 + side},{46 + side}")
        expect_picture(answer, wms.png, (200, 200))
        assert colours(answer.picture()) == {WHITE}, denominator


@suite("basic:bbox-exponential")
def _(wms):
    """Numbers may be written with exponents."""
    plain = wms.map(LAYERS="woods,ponds,diamond", BBOX="6,45.5,8,47.5", WIDTH=400, HEIGHT=200)
    powers = wms.map(LAYERS="woods,ponds,diamond", BBOX=".6E1,4550e-2,+8e0,.475E+2", WIDTH=400, HEIGHT=200)
    expect_picture(plain, wms.png, (400, 200))
    assert plain.body == powers.body


@suite("basic:bbox-pixel-interpretation")
def _(wms):
    """The box surrounds the pixels at the border; it does not pass through their centres."""
    picture = wms.map(LAYERS="ponds", BBOX="6.5,46.0,7.0,46.4", WIDTH=10, HEIGHT=8).picture()
    assert colours(picture) == {PONDS}, colours(picture)
    wider = wms.map(LAYERS="ponds", BBOX="6.4,45.9,7.1,46.5", WIDTH=14, HEIGHT=12).picture()
    inside = {(x, y) for x in range(14) for y in range(12) if wider.getpixel((x, y)) == PONDS}
    assert inside == {(x, y) for x in range(2, 12) for y in range(2, 10)}, sorted(inside)


@suite("getmap:bbox-minx-gt-maxx", "getmap:bbox-minx-eq-maxx", "getmap:bbox-miny-gt-maxy",
       "getmap:bbox-miny-eq-maxy")
def _(wms):
    """A box without an area gives an exception."""
    for box in ("1,0,0,1", "0,0,0,1", "0,1,1,0", "0,0,1,0"):
        expect_exception(wms.map(BBOX=box))


@suite("getmap:bbox-no-overlap", "getmap:bbox-outside-crs")
def _(wms):
    """Outside the layer and outside the system's extent, the map is empty."""
    for box in ("-180,-90,5,45", "-10,90,10,110"):
        answer = wms.map(BBOX=box)
        expect_picture(answer, wms.png, (100, 100))
        assert colours(answer.picture()) == {WHITE}, box


@suite("basic:no-bgcolor", "basic:blue-bgcolor", "basic:transparent-true")
def _(wms):
    """The background is white, or BGCOLOR, or transparent."""
    for pairs, ground in (({}, WHITE), ({"BGCOLOR": "0x0000FF"}, (0, 0, 255, 255)),
                          ({"TRANSPARENT": "TRUE"}, (0, 0, 0, 0))):
        picture = wms.map(LAYERS="ponds", WIDTH=200, HEIGHT=200, **pairs).picture()
        assert colours(picture.crop((0, 0, 40, 200))) == {ground}, pairs
        assert picture.getpixel((75, 130)) == PONDS


@suite("getmap:transparent-default", "getmap:transparent-false")
def _(wms):
    """Maps are opaque, unless TRANSPARENT is set."""
    for value in (None, "FALSE"):
        alphas = wms.map(TRANSPARENT=value).picture().getchannel("A").getextrema()
        assert alphas == (255, 255), (value, alphas)


@suite("getmap:transparent-opaque-layer")
def _(wms):
    """No layer is declared opaque."""
    assert all(layer.get("opaque") in (None, "0") for layer in wms.root.iter(WMS + "Layer"))


@suite("getmap:invalid-crs")
def _(wms):
    """An unknown system gives an exception that names the cause."""
    expect_exception(wms.map(CRS="CRS:NonExistent"), "InvalidCRS")
    expect_exception(wms.map(LAYERS="woods", CRS="EPSG:3035", BBOX="2000000,4000000,2100000,4100000"),
                     "InvalidCRS")


@suite("getmap:exceptions-default", "getmap:exceptions-xml")
def _(wms):
    """Exceptions are XML, valid against the schema of the OGC."""
    expect_exception(wms.map(LAYERS="NonExistent"))
    expect_exception(wms.map(LAYERS="NonExistent", EXCEPTIONS="XML"))


@suite("getmap:exceptions-inimage-mime", "getmap:exceptions-blank-mime", "interactive:exceptions-inimage")
def _(wms):
    """Exceptions in a picture have the requested type and size; one of them contains the message."""
    for kind in wms.map_formats:
        for exceptions in ("INIMAGE", "BLANK"):
            answer = wms.map(LAYERS="NonExistent", EXCEPTIONS=exceptions, FORMAT=kind, WIDTH=300)
            expect_picture(answer, kind, (300, 100))
            has_words = len(colours(answer.picture())) > 1
            assert has_words == (exceptions == "INIMAGE"), exceptions


@suite("getmap:exceptions-blank-red", "getmap:exceptions-blank-transparent")
def _(wms):
    """A blank exception has the colour BGCOLOR, or is transparent."""
    red = wms.map(LAYERS="NonExistent", EXCEPTIONS="BLANK", BGCOLOR="0xFF0000").picture()
    assert colours(red) == {(255, 0, 0, 255)}
    clear = wms.map(LAYERS="NonExistent", EXCEPTIONS="BLANK", TRANSPARENT="TRUE").picture()
    assert clear.getchannel("A").getextrema() == (0, 0)


@suite("getmap:each-format", "getmap:invalid-format")
def _(wms):
    """Each offered format is sent; other formats give exceptions."""
    for kind in wms.map_formats:
        expect_picture(wms.map(FORMAT=kind), kind, (100, 100))
    expect_exception(wms.map(FORMAT="UnknownFormat"), "InvalidFormat")


@suite("getmap:two-layers", "getmap:three-layers", "interactive:layer-order")
def _(wms):
    """Several layers are drawn, the leftmost at the bottom."""
    orders = {"woods,ponds": PONDS, "ponds,woods": WOODS, "woods,ponds,diamond": DIAMOND,
              "diamond,woods,ponds": PONDS}
    for order, top in orders.items():
        picture = wms.map(LAYERS=order).picture()
        assert picture.getpixel((40, 65)) == top, (order, picture.getpixel((40, 65)))


@suite("getmap:invalid-layer", "getmap:first-layer-invalid", "getmap:second-layer-invalid")
def _(wms):
    """An unknown layer gives an exception, at any position in the list."""
    for layers in ("NonExistent", "NonExistent,ponds", "ponds,NonExistent"):
        expect_exception(wms.map(LAYERS=layers), "LayerNotDefined")


@suite("getmap:layerlimit")
def _(wms):
    """As many layers as the limit allows are drawn; one more gives an exception."""
    limit = int(wms.root.find(f"{WMS}Service/{WMS}LayerLimit").text)
    expect_picture(wms.map(LAYERS=",".join(["ponds"] * limit)), wms.png)
    expect_exception(wms.map(LAYERS=",".join(["ponds"] * (limit + 1))))


@suite("getmap:styles-direct", "getmap:styles-inherited", "getmap:each-style", "getmap:two-styles",
       "getmap:three-styles")
def _(wms):
    """There is one style name for each layer."""
    for style in ("default", "night", "dotted"):
        expect_picture(wms.map(STYLES=style), wms.png, (100, 100))
    assert wms.map(STYLES="night").picture().getpixel((40, 65)) == (0x10, 0x20, 0x40, 255)
    two = wms.map(LAYERS="woods,ponds", STYLES="night,default").picture()
    assert two.getpixel((40, 65)) == PONDS and two.getpixel((80, 70)) == (0x10, 0x20, 0x40, 255)
    expect_picture(wms.map(LAYERS="woods,ponds,diamond", STYLES="night,default,dotted"), wms.png)


@suite("getmap:styles-default-single-layer", "getmap:styles-default-multiple-layers",
       "getmap:styles-default-commas", "getmap:styles-some-default")
def _(wms):
    """An empty style means the layer's own style, for each layer or for all of them."""
    assert wms.map(STYLES="").body == wms.map(STYLES="default").body
    own = wms.map(LAYERS="woods,ponds,diamond", STYLES="default,default,default").body
    for styles in ("", ",,"):
        assert wms.map(LAYERS="woods,ponds,diamond", STYLES=styles).body == own, styles
    assert (wms.map(LAYERS="woods,ponds", STYLES="night,").body ==
            wms.map(LAYERS="woods,ponds", STYLES="night,default").body)


@suite("getmap:invalid-style", "getmap:first-style-invalid", "getmap:second-style-invalid")
def _(wms):
    """An unknown style gives an exception, at any position in the list."""
    expect_exception(wms.map(STYLES="NonExistent"), "StyleNotDefined")
    for styles in ("NonExistent,default", "default,NonExistent"):
        expect_exception(wms.map(LAYERS="woods,ponds", STYLES=styles), "StyleNotDefined")


@suite("getmap:large-size", "getmap:small-size")
def _(wms):
    """Pictures have the requested size, up to the limits in the capabilities and no further."""
    service = wms.root.find(WMS + "Service")
    most = int(service.find(WMS + "MaxWidth").text), int(service.find(WMS + "MaxHeight").text)
    assert most == (774, 774), most
    for width, height in (most, (8, 5)):
        expect_picture(wms.map(WIDTH=width, HEIGHT=height), wms.png, (width, height))
    expect_exception(wms.map(WIDTH=most[0] + 1, HEIGHT=most[1] + 1))


@suite("interactive:basic-polygons-sanity-check", "interactive:blue-lake-sanity-check")
def _(wms):
    """A diamond that fills the map has the right shape."""
    picture = wms.map(LAYERS="diamond", WIDTH=300, HEIGHT=300).picture()
    for at in ((150, 150), (150, 5), (150, 294), (5, 150), (294, 150), (80, 80)):
        assert picture.getpixel(at) == DIAMOND, (at, picture.getpixel(at))
    for at in ((60, 60), (240, 60), (60, 240), (240, 240), (0, 0), (299, 299)):
        assert picture.getpixel(at) == WHITE, at


@suite("interactive:aspect-ratio")
def _(wms):
    """If box and size do not match, the map is stretched."""
    picture = wms.map(LAYERS="diamond", WIDTH=100, HEIGHT=300).picture()
    for x, y in ((50, 5), (50, 294), (2, 150), (97, 150)):
        assert picture.getpixel((x, y)) == DIAMOND, (x, y)
    assert picture.getpixel((20, 60)) == WHITE


@suite("interactive:fees-and-access-constraints")
def _(wms):
    """There are neither fees nor constraints, and the capabilities do not mention any."""
    assert wms.root.find(f"{WMS}Service/{WMS}Fees") is None
    assert wms.root.find(f"{WMS}Service/{WMS}AccessConstraints") is None


# GetFeatureInfo


@suite("queryable:getfeatureinfo-supported", "queryable:std-data-queryable",
       "getfeatureinfo:query_layers-not-queryable", "getfeatureinfo:each-queryable-layer")
def _(wms):
    """Features can be requested from every layer."""
    for layer, name in zip(wms.layers, wms.names):
        assert layer.get("queryable") == "1"
        answer = wms.info(LAYERS=name, QUERY_LAYERS=name, INFO_FORMAT="text/plain")
        assert answer.status == 200 and name.encode() in answer.body, (name, answer.body)


@suite("getfeatureinfo:exceptions-default", "getfeatureinfo:exceptions-xml",
       "getfeatureinfo:invalid-query_layers")
def _(wms):
    """Errors are reported as XML."""
    for exceptions in (None, "XML"):
        expect_exception(wms.info(LAYERS="UndefinedLayer", QUERY_LAYERS="UndefinedLayer",
                                  EXCEPTIONS=exceptions), "LayerNotDefined")
    expect_exception(wms.info(QUERY_LAYERS="InvalidLayer"), "LayerNotDefined")


@suite("getfeatureinfo:each-info_format", "getfeatureinfo:invalid-info_format")
def _(wms):
    """Each offered format is sent; other formats give exceptions."""
    for kind in wms.info_formats:
        answer = wms.info(INFO_FORMAT=kind)
        assert answer.status == 200 and answer.type == kind, (kind, answer.type)
    expect_exception(wms.info(INFO_FORMAT="InvalidFormat"), "InvalidFormat")


@suite("getfeatureinfo:invalid-i", "getfeatureinfo:invalid-j")
def _(wms):
    """A pixel outside the map gives an exception."""
    expect_exception(wms.info(I=250), "InvalidPoint")
    expect_exception(wms.info(J=250), "InvalidPoint")
    expect_exception(wms.info(I=-1), "InvalidPoint")


@suite("getfeatureinfo:two-query_layers", "getfeatureinfo:three-query_layers",
       "getfeatureinfo:less-query_layers")
def _(wms):
    """Features are requested from some or all layers of a map."""
    for queried in ("ponds,woods", "ponds,woods,diamond", "diamond"):
        answer = wms.info(LAYERS="woods,ponds,diamond", QUERY_LAYERS=queried, INFO_FORMAT="text/plain")
        assert answer.status == 200 and answer.type == "text/plain", answer.type
        for name in wms.names:
            assert (name.encode() in answer.body) == (name in queried.split(",")), (queried, name)


@suite("queryable:feature_count-default", "queryable:feature_count-1")
def _(wms):
    """One feature is returned, or as many as requested."""
    def features(count):
        answer = wms.info(INFO_FORMAT="application/geo+json", FEATURE_COUNT=count)
        return len(json.loads(answer.body)["features"])
    assert [features(count) for count in (None, 1, 2)] == [1, 1, 2]


# Recommendations


@suite("recommendations:service-keywords", "recommendations:service-contact-info",
       "recommendations:layer-abstracts", "recommendations:layer-keywordlists",
       "recommendations:metadataurls")
def _(wms):
    """The layers have the metadata in the configuration, which has no contact and no keywords."""
    woods = wms.layers[wms.names.index("woods")]
    assert woods.find(WMS + "Title").text == "Woods & meadows"
    assert woods.find(WMS + "Abstract").text == "What is green"
    assert woods.find(f"{WMS}Attribution/{WMS}Title").text == "Nobody <nobody@example.org>"
    for name in ("KeywordList", "ContactInformation", "MetadataURL"):
        assert wms.root.find(f".//{WMS}{name}") is None, name


# Version 1.1.1, for which the standard has document types


@suite("1.1.1: capabilities and exceptions are valid")
def _(wms):
    """Capabilities and exceptions of version 1.1.1 are valid against its document types."""
    capabilities = wms.capabilities(VERSION="1.1.1")
    assert capabilities.type == "application/vnd.ogc.wms_xml", capabilities.type
    expect_valid(capabilities.body, "wms/1.1.1/WMS_MS_Capabilities.dtd")
    exception = wms.map(VERSION="1.1.1", CRS=None, SRS="EPSG:4326", LAYERS="NonExistent")
    assert exception.type == "application/vnd.ogc.se_xml", exception.type
    expect_valid(exception.body, "wms/1.1.1/exception_1_1_1.dtd")


@suite("schemas refuse what is wrong")
def _(wms):
    """Validation finds an unknown element."""
    if not has_schemas():
        return
    wrong = wms.document.body.replace(b"<MaxWidth>", b"<MostWidth>").replace(b"</MaxWidth>", b"</MostWidth>")
    try:
        expect_valid(wrong, "sld/1.1.0/sld_capabilities.xsd")
    except AssertionError:
        return
    raise AssertionError("a wrong document is taken for valid")


with served_layers() as address:
    status = suite.run(Service(address))
sys.exit(status)
