"""WMTS 1.0.0: every assertion of the OGC's test suite about existing features, under the names of its tests: those
for key-value pairs over GET and for RESTful addresses. There is no POST and no SOAP, which the suite then skips,
no dimension, no theme, no update sequence, and no layer without tile limits.

In locators, the suite ignores the case of parameter names.
"""

import json
import sys

from assertions import Suite, ask, expect_picture, expect_valid, with_query
from layers import served_layers

WMTS = "{http://www.opengis.net/wmts/1.0}"
OWS = "{http://www.opengis.net/ows/1.1}"
HREF = "{http://www.w3.org/1999/xlink}href"
LOCATION = "{http://www.w3.org/2001/XMLSchema-instance}schemaLocation"
CAPABILITIES_SCHEMA = "wmts/1.0/wmtsGetCapabilities_response.xsd"
EXCEPTIONS_SCHEMA = "ows/1.1.0/owsExceptionReport.xsd"
SECTIONS = ("ServiceIdentification", "ServiceProvider", "OperationsMetadata", "Contents", "Themes")

suite = Suite("WMTS 1.0.0")


class Service:
    """The contents of the capabilities, and requests to the URLs in them."""

    def __init__(self, base):
        self.base = base
        self.document = ask(base + "wmts?service=WMTS&request=GetCapabilities")
        self.root = self.document.xml()
        self.contents = self.root.find(WMTS + "Contents")
        self.layers = {layer.find(OWS + "Identifier").text: layer
                       for layer in self.contents.findall(WMTS + "Layer")}
        self.sets = {one.find(OWS + "Identifier").text: one
                     for one in self.contents.findall(WMTS + "TileMatrixSet")}

    def prefix(self, operation):
        return self.root.find(f".//{OWS}Operation[@name='{operation}']//{OWS}Get").get(HREF)

    def capabilities(self, **pairs):
        usual = {"SERVICE": "WMTS", "REQUEST": "GetCapabilities"}
        return ask(with_query(self.prefix("GetCapabilities"), **{**usual, **pairs}))

    def tiles(self, layer, set_id):
        """For each matrix of the layer: its element, and a tile in the middle of the limits."""
        link = next(link for link in self.layers[layer].findall(WMTS + "TileMatrixSetLink")
                    if link.find(WMTS + "TileMatrixSet").text == set_id)
        matrices = {one.find(OWS + "Identifier").text: one
                    for one in self.sets[set_id].findall(WMTS + "TileMatrix")}
        for limits in link.find(WMTS + "TileMatrixSetLimits"):
            name, *sides = (element.text for element in limits)
            first_row, last_row, first_column, last_column = map(int, sides)
            yield matrices[name], Tile(layer, set_id, name, (first_row + last_row) // 2,
                                       (first_column + last_column) // 2,
                                       (first_row, last_row, first_column, last_column))

    def some_tile(self, layer="diamond", set_id="WebMercatorQuad", matrix="8"):
        return next(tile for _, tile in self.tiles(layer, set_id) if tile.matrix == matrix)

    def template(self, layer, kind, type_name):
        return next(one.get("template") for one in self.layers[layer].findall(WMTS + "ResourceURL")
                    if one.get("resourceType") == kind and one.get("format") == type_name)


class Tile:
    def __init__(self, layer, set_id, matrix, row, column, limits):
        self.layer, self.set_id, self.matrix = layer, set_id, matrix
        self.row, self.column, self.limits = row, column, limits

    def pairs(self, **others):
        return {"SERVICE": "WMTS", "REQUEST": "GetTile", "VERSION": "1.0.0", "LAYER": self.layer,
                "STYLE": "default", "FORMAT": "image/png", "TILEMATRIXSET": self.set_id,
                "TILEMATRIX": self.matrix, "TILEROW": self.row, "TILECOL": self.column, **others}

    def address(self, template, **others):
        parts = {"Style": "default", "TileMatrixSet": self.set_id, "TileMatrix": self.matrix,
                 "TileRow": self.row, "TileCol": self.column, "I": 100, "J": 100, **others}
        for name, value in parts.items():
            template = template.replace("{" + name + "}", str(value))
        return template


INFO = {"REQUEST": "GetFeatureInfo", "I": 100, "J": 100, "INFOFORMAT": "application/geo+json"}


def get_tile(wmts, tile, **others):
    return ask(with_query(wmts.prefix("GetTile"), **tile.pairs(**others)))


def get_info(wmts, tile, **others):
    return ask(with_query(wmts.prefix("GetFeatureInfo"), **{**tile.pairs(**INFO), **others}))


def expect_exception(answer, code, locator, status=400):
    assert answer.status == status, (answer.status, answer.body[:300])
    expect_valid(answer.body, EXCEPTIONS_SCHEMA)
    exceptions = answer.xml().findall(OWS + "Exception")
    assert len(exceptions) == 1, answer.body
    assert exceptions[0].get("exceptionCode") == code, exceptions[0].get("exceptionCode")
    named = exceptions[0].get("locator")
    assert (named or "").lower() == (locator or "").lower(), named


def expect_capabilities(answer, *sections):
    assert answer.status == 200 and answer.type == "application/xml", (answer.status, answer.type)
    expect_valid(answer.body, CAPABILITIES_SCHEMA)
    root = answer.xml()
    assert root.tag == WMTS + "Capabilities" and root.get("version") == "1.0.0"
    found = [name for name in SECTIONS
             if root.find((WMTS if name in ("Contents", "Themes") else OWS) + name) is not None]
    assert found == list(sections), found


# The sections that exist; no service provider is configured.
ALL = ("ServiceIdentification", "OperationsMetadata", "Contents")


# Shared by all operations


@suite("Server.KVP.GET.HTTP.Mandatory 1-2", "Server.RESTful.HTTP.Mandatory 1-2")
def _(wmts):
    """An unknown service is not found."""
    for path in ("not-existent-service", "wmts/not/existent"):
        assert ask(wmts.base + path).status == 404, path


@suite("Server.KVP.GET.InvalidQueryString 1-5", "Server.RESTful.InvalidQueryString 1-5")
def _(wmts):
    """An invalid query lacks a service."""
    query = "request~GetCapabilities!service~!'WMTS'version~'1.0.0"
    expect_exception(ask(wmts.prefix("GetCapabilities") + query), "MissingParameterValue", "service")


@suite("Server.KVP.GET.InvalidService 1-5", "Server.KVP.GET.GetCapabilities.Request.InvalidService 1-6")
def _(wmts):
    """Another service is refused."""
    expect_exception(wmts.capabilities(SERVICE="BOGUS"), "InvalidParameterValue", "service")


@suite("Server.KVP.GET.InvalidRequest 1-5")
def _(wmts):
    """An unknown request is refused."""
    expect_exception(wmts.capabilities(REQUEST="GetBOGUS"), "InvalidParameterValue", "request")


@suite("POST is not offered")
def _(wmts):
    """There is no POST, with key-value pairs, XML or SOAP."""
    assert wmts.root.find(f".//{OWS}Post") is None


# GetCapabilities


@suite("Server.KVP.GET.GetCapabilities.Request.Mandatory 1-3",
       "Server.KVP.GET.GetCapabilities.Response.XML.Well.Formed 1-3",
       "Server.KVP.GET.GetCapabilities.Response.SchemaValid 1-3",
       "Server.RESTful.GetCapabilities.Request.Mandatory 1-3")
def _(wmts):
    """The document has all sections and is valid against the schema, also at its RESTful address."""
    expect_capabilities(wmts.document, *ALL)
    address = wmts.root.find(WMTS + "ServiceMetadataURL").get(HREF)
    assert ask(address).body == wmts.document.body


@suite("Server.KVP.GET.GetCapabilities.Request.NoService 1-6")
def _(wmts):
    """A request without a service is refused."""
    expect_exception(wmts.capabilities(SERVICE=None), "MissingParameterValue", "service")


@suite("Server.KVP.GET.GetCapabilities.Request.AcceptVersions.Valid 1-4",
       "Server.KVP.GET.GetCapabilities.Request.AcceptVersions.Invalid 1-6")
def _(wmts):
    """The version must be among the accepted ones."""
    for versions in ("1.0.0", "2.0.0,1.0.0"):
        expect_capabilities(wmts.capabilities(ACCEPTVERSIONS=versions), *ALL)
    for versions in ("2.0.0", "99.99.99,0.0.1"):
        expect_exception(wmts.capabilities(ACCEPTVERSIONS=versions), "VersionNegotiationFailed", None)


@suite("Server.KVP.GET.GetCapabilities.Request.CaseInsensitive.KVP.Names 1-2")
def _(wmts):
    """Keys may be in any case and in any order."""
    prefix = wmts.prefix("GetCapabilities")
    for query in ("REQUEST=GetCapabilities&SERVICE=WMTS&VERSION=1.0.0",
                  "version=1.0.0&service=WMTS&request=GetCapabilities",
                  "sErViCe=WMTS&VeRsIoN=1.0.0&ReQuEsT=GetCapabilities"):
        assert ask(prefix + query).body == wmts.document.body, query


@suite(*(f"Server.KVP.GET.GetCapabilities.Request.Sections.{name} 1-3" for name in
         ("All", "ServiceIdentification", "ServiceProvider", "OperationsMetadata", "Contents", "Themes",
          "Multiple")))
def _(wmts):
    """Only the requested sections are sent, if they exist."""
    expect_capabilities(wmts.capabilities(SECTIONS="All"), *ALL)
    for name in SECTIONS:
        expect_capabilities(wmts.capabilities(SECTIONS=name), *(s for s in ALL if s == name))
    expect_capabilities(wmts.capabilities(SECTIONS="Contents,Themes"), "Contents")
    expect_capabilities(wmts.capabilities(SECTIONS="Contents,ServiceIdentification"),
                        "ServiceIdentification", "Contents")


@suite("Server.KVP.GET.GetCapabilities.Request.Sections.Invalid 1-6",
       "Server.KVP.GET.GetCapabilities.Request.Sections.Missing 1-6")
def _(wmts):
    """An unknown section is refused, and so is an empty one."""
    expect_exception(wmts.capabilities(SECTIONS="Bogus"), "InvalidParameterValue", "sections")
    expect_exception(wmts.capabilities(SECTIONS=""), "MissingParameterValue", "sections")


@suite("Server.KVP.GET.GetCapabilities.Request.UpdateSequence",
       "Server.KVP.GET.GetCapabilities.Response.No.Layers.OtherSource",
       "Server.KVP.GET.GetCapabilities.Response.Dimension.Identifiers.Unique",
       "Server.KVP.GET.GetCapabilities.Response.Theme.LayerRef.Valid",
       *(f"Server.{binding}.{operation}.{name}" for binding in ("KVP.GET", "RESTful")
         for operation in ("GetTile", "GetFeatureInfo")
         for name in ("Optional", "Missing.Optional", "Invalid.SampleDimension.Value",
                      "Default.SampleDimension", "Current.SampleDimension",
                      "Invalid.Tile.Row.No.TileMatrixSetLimits", "Invalid.Tile.Col.No.TileMatrixSetLimits")),
       "Server.KVP.GET.GetTile.Invalid.SampleDimension.Name",
       "Server.KVP.GET.GetFeatureInfo.Invalid.SampleDimension.Name")
def _(wmts):
    """There are no update sequence, dimensions and themes; all layers have limits."""
    assert wmts.root.get("updateSequence") is None and wmts.layers
    for name in ("Dimension", "Theme"):
        assert wmts.root.find(f".//{WMTS}{name}") is None, name
    for layer in wmts.layers.values():
        for link in layer.findall(WMTS + "TileMatrixSetLink"):
            assert link.find(WMTS + "TileMatrixSetLimits") is not None


@suite("Server.KVP.GET.GetCapabilities.Request.AcceptFormats 1-2",
       "Server.KVP.GET.GetCapabilities.Response.AdvertisedFormat 1-3")
def _(wmts):
    """The document is application/xml, the only format declared, whatever the client accepts."""
    allowed = wmts.root.findall(f".//{OWS}Operation[@name='GetCapabilities']/{OWS}Parameter"
                                f"[@name='AcceptFormats']/{OWS}AllowedValues/{OWS}Value")
    assert [value.text for value in allowed] == ["application/xml"]
    for kind in ("application/xml", "bogus/xml"):
        expect_capabilities(wmts.capabilities(ACCEPTFORMATS=kind), *ALL)


@suite("Server.KVP.GET.GetCapabilities.Response.SchemaReferenced 1-3")
def _(wmts):
    """The document names the schema of the OGC."""
    places = wmts.root.get(LOCATION).split()
    assert dict(zip(places[::2], places[1::2]))["http://www.opengis.net/wmts/1.0"] == (
        "http://schemas.opengis.net/wmts/1.0/wmtsGetCapabilities_response.xsd")


@suite("Server.KVP.GET.GetCapabilities.Response.OnlineResource 1-3",
       "Server.KVP.GET.GetCapabilities.Response.Encoding.Constraint 1-3")
def _(wmts):
    """The URLs are prefixes for key-value pairs."""
    gets = list(wmts.root.iter(OWS + "Get"))
    assert len(gets) == 3
    for get in gets:
        assert get.get(HREF).endswith("?"), get.get(HREF)
        constraint = get.find(OWS + "Constraint")
        assert constraint.get("name") == "GetEncoding"
        assert [value.text for value in constraint.iter(OWS + "Value")] == ["KVP"]


@suite(*(f"Server.KVP.GET.GetCapabilities.Response.{name} 1-3" for name in
         ("Layer.Identifiers.Unique", "Style.Identifiers.Unique", "TileMatrixSet.Identifiers.Unique",
          "TileMatrix.Identifiers.Unique", "TileMatrixSet.ScaleDenominators.Unique",
          "Layer.TileMatrixSet.Valid")))
def _(wmts):
    """Identifiers are unique and not empty; layers link to existing sets."""
    def identifiers(elements):
        names = [element.find(OWS + "Identifier").text for element in elements]
        assert all(names) and len(set(names)) == len(names), names
        return set(names)
    identifiers(wmts.contents.findall(WMTS + "Layer"))
    sets = identifiers(wmts.contents.findall(WMTS + "TileMatrixSet"))
    linked = set()
    for layer in wmts.layers.values():
        assert identifiers(layer.findall(WMTS + "Style")) == {"default", "night", "dotted"}
        assert [style.get("isDefault") for style in layer.findall(WMTS + "Style")].count("true") == 1
        linked |= {link.find(WMTS + "TileMatrixSet").text
                   for link in layer.findall(WMTS + "TileMatrixSetLink")}
    assert linked == sets, (linked, sets)
    for one in wmts.sets.values():
        matrices = one.findall(WMTS + "TileMatrix")
        identifiers(matrices)
        scales = [float(matrix.find(WMTS + "ScaleDenominator").text) for matrix in matrices]
        assert len(set(scales)) == len(scales) and scales == sorted(scales, reverse=True), scales


@suite(*(f"Server.KVP.GET.GetCapabilities.Response.Layer.LegendURL.Correct.{name}" for name in
         ("Resource 1-3", "Format", "Size")))
def _(wmts):
    """Legends are pictures of the declared type, and of the declared size if there is one."""
    legends = list(wmts.contents.iter(WMTS + "LegendURL"))
    assert len(legends) == 3 * len(wmts.layers)
    for legend in legends:
        size = None
        if legend.get("width"):
            size = (int(legend.get("width")), int(legend.get("height")))
        expect_picture(ask(legend.get(HREF)), legend.get("format"), size)


@suite("Server.KVP.GET.GetCapabilities.Response.TileMatrixSet.WellKnownScaleSet")
def _(wmts):
    """Well-known sets have their scales, halved from one matrix to the next."""
    first = {"urn:ogc:def:wkss:OGC:1.0:GoogleMapsCompatible": 559082264.0287178,
             "urn:ogc:def:wkss:OGC:1.0:GoogleCRS84Quad": 279541132.0143589}
    known = 0
    for one in wmts.sets.values():
        name = one.find(WMTS + "WellKnownScaleSet")
        if name is None:
            continue
        known += 1
        for i, matrix in enumerate(one.findall(WMTS + "TileMatrix")):
            scale = float(matrix.find(WMTS + "ScaleDenominator").text)
            assert abs(scale * 2**i / first[name.text] - 1) < 1e-9, (name.text, i, scale)
    assert known == 2, known


# GetTile


@suite("Server.KVP.GET.GetTile.Mandatory 1-13", "Server.RESTful.GetTile.Mandatory 1-10",
       "Server.KVP.GET.GetTile.Valid.Tile.Format", "Server.RESTful.GetTile.Valid.Tile.Format 1-12",
       "Server.KVP.GET.GetTile.Valid.Tile.Size", "Server.RESTful.GetTile.Valid.Tile.Size 1-12")
def _(wmts):
    """Every layer has tiles in every matrix of every set, over both interfaces, of the declared type and size."""
    count = 0
    for name, layer in wmts.layers.items():
        assert [element.text for element in layer.findall(WMTS + "Format")] == ["image/png"]
        template = wmts.template(name, "tile", "image/png")
        for link in layer.findall(WMTS + "TileMatrixSetLink"):
            set_id = link.find(WMTS + "TileMatrixSet").text
            for matrix, tile in wmts.tiles(name, set_id):
                size = (int(matrix.find(WMTS + "TileWidth").text), int(matrix.find(WMTS + "TileHeight").text))
                answer = get_tile(wmts, tile)
                expect_picture(answer, "image/png", size)
                assert ask(tile.address(template)).body == answer.body
                count += 1
    assert count > 100, count
    for style in ("night", "dotted"):
        tile = wmts.some_tile()
        answer = get_tile(wmts, tile, STYLE=style)
        expect_picture(answer, "image/png", (256, 256))
        assert answer.body == ask(tile.address(wmts.template("diamond", "tile", "image/png"), Style=style)).body
        assert answer.body != get_tile(wmts, tile).body


REQUIRED = ("LAYER", "STYLE", "FORMAT", "TILEMATRIXSET", "TILEMATRIX", "TILEROW", "TILECOL")


@suite("Server.KVP.GET.GetTile.Missing", "Server.RESTful.GetTile.Missing")
def _(wmts):
    """Every required parameter must be present."""
    tile = wmts.some_tile()
    for key in ("SERVICE", "REQUEST", "VERSION") + REQUIRED:
        expect_exception(get_tile(wmts, tile, **{key: None}), "MissingParameterValue", key)
    template = wmts.template("diamond", "tile", "image/png")
    assert ask(tile.address(template).rsplit("/", 1)[0]).status == 404


WRONG = {"LAYER": "bogus", "STYLE": "bogus", "TILEMATRIXSET": "bogus", "TILEMATRIX": "bogus"}


@suite(*(f"Server.{binding}.GetTile.Invalid.{name}" for binding in ("KVP.GET", "RESTful") for name in
         ("Layer 1-16", "TileMatrixSet 1-16", "TileMatrix 1-14", "Tile.Style")),
       "Server.KVP.GET.GetTile.Invalid.Tile.Format")
def _(wmts):
    """Unknown values are refused: with 400 in a query, with 404 in a path."""
    tile = wmts.some_tile()
    for key, value in {**WRONG, "FORMAT": "image/bogus"}.items():
        expect_exception(get_tile(wmts, tile, **{key: value}), "InvalidParameterValue", key)
    template = wmts.template("diamond", "tile", "image/png")
    for name in ("Style", "TileMatrixSet", "TileMatrix"):
        expect_exception(ask(tile.address(template, **{name: "bogus"})), "InvalidParameterValue", name, 404)
    expect_exception(ask(tile.address(template.replace("/diamond/", "/bogus/"))), "InvalidParameterValue",
                     "layer", 404)


@suite(*(f"Server.{binding}.GetTile.Invalid.Tile.{name}.TileMatrixSetLimits 1-14"
         for binding in ("KVP.GET", "RESTful") for name in ("Row", "Col")))
def _(wmts):
    """A tile outside the limits is out of range."""
    tile = wmts.some_tile()
    first_row, last_row, first_column, last_column = tile.limits
    template = wmts.template("diamond", "tile", "image/png")
    for key, name, values in (("TILEROW", "TileRow", (first_row - 1, last_row + 1, -1)),
                              ("TILECOL", "TileCol", (first_column - 1, last_column + 1, 999999999999))):
        for value in values:
            expect_exception(get_tile(wmts, tile, **{key: value}), "TileOutOfRange", name)
            expect_exception(ask(tile.address(template, **{name: value})), "TileOutOfRange", name, 404)


@suite("Server.KVP.GET.GetTile.Valid.Tile.Transparency", "Server.RESTful.GetTile.Valid.Tile.Transparency")
def _(wmts):
    """Empty tiles are transparent."""
    picture = get_tile(wmts, wmts.some_tile(matrix="5")).picture()
    assert picture.getchannel("A").getextrema() == (0, 255)


# GetFeatureInfo


@suite("Server.KVP.GET.GetFeatureInfo.Mandatory 1-16", "Server.RESTful.GetFeatureInfo.Mandatory",
       "Server.KVP.GET.GetFeatureInfo.Valid.InfoFormat", "Server.RESTful.GetFeatureInfo.Valid.InfoFormat")
def _(wmts):
    """Every layer returns its features in every format, in every set, over both interfaces."""
    for name, layer in wmts.layers.items():
        formats = [element.text for element in layer.findall(WMTS + "InfoFormat")]
        assert len(formats) >= 3, formats
        for link in layer.findall(WMTS + "TileMatrixSetLink"):
            *_, (_, tile) = (pair for pair in wmts.tiles(name, link.find(WMTS + "TileMatrixSet").text))
            for kind in formats:
                answer = get_info(wmts, tile, INFOFORMAT=kind)
                assert answer.status == 200 and answer.type == kind, (kind, answer.status, answer.type)
    tile = wmts.some_tile()
    found = json.loads(get_info(wmts, tile).body)["features"]
    assert [feature["properties"]["name"] for feature in found] == ["diamond 0"], found
    for kind in ("application/geo+json", "text/plain", "text/html"):
        address = tile.address(wmts.template("diamond", "FeatureInfo", kind))
        assert ask(address).body == get_info(wmts, tile, INFOFORMAT=kind).body, kind


@suite("Server.KVP.GET.GetFeatureInfo.Missing", "Server.RESTful.GetFeatureInfo.Missing")
def _(wmts):
    """Every required parameter must be present."""
    tile = wmts.some_tile()
    for key in ("SERVICE", "REQUEST", "VERSION") + REQUIRED + ("I", "J", "INFOFORMAT"):
        expect_exception(get_info(wmts, tile, **{key: None}), "MissingParameterValue", key)
    template = wmts.template("diamond", "FeatureInfo", "text/plain")
    assert ask(tile.address(template).rsplit("/", 1)[0]).status == 404


@suite(*(f"Server.{binding}.GetFeatureInfo.Invalid.{name}" for binding in ("KVP.GET", "RESTful") for name in
         ("Layer", "TileMatrixSet", "TileMatrix", "Tile.Style")),
       "Server.KVP.GET.GetFeatureInfo.Invalid.Tile.Format", "Server.KVP.GET.GetFeatureInfo.Invalid.InfoFormat")
def _(wmts):
    """Unknown values are refused."""
    tile = wmts.some_tile()
    for key, value in {**WRONG, "FORMAT": "image/bogus", "INFOFORMAT": "text/bogus"}.items():
        expect_exception(get_info(wmts, tile, **{key: value}), "InvalidParameterValue", key)
    template = wmts.template("diamond", "FeatureInfo", "text/plain")
    for name in ("Style", "TileMatrixSet", "TileMatrix"):
        expect_exception(ask(tile.address(template, **{name: "bogus"})), "InvalidParameterValue", name, 404)


@suite(*(f"Server.{binding}.GetFeatureInfo.Invalid.{name}" for binding in ("KVP.GET", "RESTful") for name in
         ("Tile.Row.TileMatrixSetLimits", "Tile.Col.TileMatrixSetLimits", "Pixel.Row.J", "Pixel.Col.I")))
def _(wmts):
    """A tile outside the limits and a pixel outside the tile are out of range."""
    tile = wmts.some_tile()
    template = wmts.template("diamond", "FeatureInfo", "text/plain")
    for name, value in (("TileRow", tile.limits[1] + 1), ("TileCol", tile.limits[3] + 1)):
        expect_exception(get_info(wmts, tile, **{name.upper(): value}), "TileOutOfRange", name)
        expect_exception(ask(tile.address(template, **{name: value})), "TileOutOfRange", name, 404)
    for name in ("I", "J"):
        for value in (256, -1):
            expect_exception(get_info(wmts, tile, **{name: value}), "PointIJOutOfRange", name)
            expect_exception(ask(tile.address(template, **{name: value})), "PointIJOutOfRange", name)


with served_layers() as address:
    status = suite.run(Service(address))
sys.exit(status)
