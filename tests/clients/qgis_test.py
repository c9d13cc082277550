"""QGIS, without a window, shows our tiles and maps, and identifies features over WMTS and WMS."""

import os
import sys
import tempfile

from served_map import get, served_map, skip

# No window, and no settings of the user.
profile = tempfile.TemporaryDirectory(prefix="trapeze-qgis-")
os.environ["QT_QPA_PLATFORM"] = "offscreen"
os.environ["QGIS_CUSTOM_CONFIG_PATH"] = profile.name
os.environ["XDG_RUNTIME_DIR"] = profile.name

try:
    from qgis.core import (
        QgsApplication, QgsCoordinateReferenceSystem, QgsMapRendererParallelJob, QgsMapSettings,
        QgsPointXY, QgsProject, QgsRaster, QgsRasterLayer, QgsRectangle)
    from qgis.PyQt.QtCore import QSize, Qt
    from qgis.PyQt.QtGui import QColor, QImage, QPainter
except ImportError as error:
    skip(f"QGIS is not installed ({error})")

HALF = 20037508.342789244
ZOOM = 5
SIDE = 2 * HALF / 2**ZOOM  # of a tile, in metres
COLUMNS = (16, 17)
ROWS = (10, 11)
EXTENT = QgsRectangle(COLUMNS[0] * SIDE - HALF, HALF - (ROWS[1] + 1) * SIDE,
                      (COLUMNS[1] + 1) * SIDE - HALF, HALF - ROWS[0] * SIDE)
SIZE = 512
TOLERANCE = 2  # of 255: QGIS rounds differently when blending
MOST_DIFFERING = 0.0005  # of all pixels
# From WMTS, QGIS draws only inside the bounds of the layer, whose edges it rounds to pixels: the map is
# shifted by up to a pixel, which shows along borders.
MOST_DIFFERING_OF_WMTS = 0.008


def tiles_of(pattern):
    """Our own tiles, put together on white."""
    picture = QImage(SIZE, SIZE, QImage.Format_RGB32)
    picture.fill(Qt.white)
    painter = QPainter(picture)
    for row in ROWS:
        for column in COLUMNS:
            tile = QImage.fromData(get(pattern.format(z=ZOOM, x=column, y=row)))
            assert tile.width() == 256, "no tile"
            painter.drawImage((column - COLUMNS[0]) * 256, (row - ROWS[0]) * 256, tile)
    painter.end()
    return picture


def drawn_by_qgis(layer, scale=1):
    settings = QgsMapSettings()
    settings.setLayers([layer])
    settings.setDestinationCrs(QgsCoordinateReferenceSystem("EPSG:3857"))
    settings.setOutputSize(QSize(scale * SIZE, scale * SIZE))
    settings.setOutputDpi(scale * 96)
    settings.setExtent(EXTENT)
    settings.setBackgroundColor(QColor(Qt.white))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    assert not job.errors(), [error.message for error in job.errors()]
    return job.renderedImage().convertToFormat(QImage.Format_RGB32)


def bytes_of(picture):
    bits = picture.constBits()
    bits.setsize(picture.sizeInBytes())
    return bytes(bits)


def check(name, layer, pattern, most_differing):
    assert layer.isValid(), f"{name}: {layer.error().message()}"
    shown = bytes_of(drawn_by_qgis(layer))
    own = bytes_of(tiles_of(pattern))
    assert len(set(own[i:i + 3] for i in range(0, len(own), 4))) > 1, "there is nothing on the map"
    differing = sum(
        any(abs(a - b) > TOLERANCE for a, b in zip(shown[i:i + 3], own[i:i + 3]))
        for i in range(0, len(own), 4))
    assert differing <= most_differing * SIZE * SIZE, f"{name}: {differing} pixels differ"
    print(f"QGIS shows the tiles of {name}; {differing} pixels differ")


def check_features(layer):
    place = QgsPointXY(15 / 180 * HALF, 5780349.2)  # 15 E, 46 N, on the mainland
    answer = layer.dataProvider().identify(
        place, QgsRaster.IdentifyFormatText, EXTENT, SIZE, SIZE)
    text = " ".join(str(value) for value in answer.results().values())
    assert "mainland with a bay and a lake" in text, (text, answer.error().message())
    print("QGIS tells the feature under a place")


def check_print(base):
    """In print, at twice the resolution, lines have the same width: twice as many pixels."""
    layer = QgsRasterLayer("IgnoreReportedLayerExtents=1&contextualWMSLegend=0&crs=EPSG:3857&dpiMode=7&format=image/png&layers=land"
                           f"&styles=default&url={base}wms?stroke%3D000%26stroke-width%3D4",
                           "print", "wms")
    shown = bytes_of(drawn_by_qgis(layer, 2))
    box = ",".join(str(number) for number in (EXTENT.xMinimum(), EXTENT.yMinimum(),
                                              EXTENT.xMaximum(), EXTENT.yMaximum()))
    picture = QImage(2 * SIZE, 2 * SIZE, QImage.Format_RGB32)
    picture.fill(Qt.white)
    painter = QPainter(picture)
    painter.drawImage(0, 0, QImage.fromData(get(
        f"{base}map/land@2x.png?bbox={box}&crs=EPSG:3857&width={SIZE}&height={SIZE}"
        "&stroke=000&stroke-width=4")))
    painter.end()
    own = bytes_of(picture)
    differing = sum(
        any(abs(a - b) > TOLERANCE for a, b in zip(shown[i:i + 3], own[i:i + 3]))
        for i in range(0, len(own), 4))
    assert differing <= MOST_DIFFERING * 4 * SIZE * SIZE, f"in print, {differing} pixels differ"
    print(f"QGIS prints lines as wide as on the screen; {differing} pixels differ")


def check_degrees(base, name, source):
    """A map in EPSG:4326, which QGIS requests with the axes in the order of the version."""
    extent = QgsRectangle(0, 33.75, 22.5, 56.25)  # four tiles of WorldCRS84Quad
    layer = QgsRasterLayer(source, name, "wms")
    assert layer.isValid(), f"{name}: {layer.error().message()}"
    settings = QgsMapSettings()
    settings.setLayers([layer])
    settings.setDestinationCrs(QgsCoordinateReferenceSystem("EPSG:4326"))
    settings.setOutputSize(QSize(SIZE, SIZE))
    settings.setExtent(extent)
    settings.setBackgroundColor(QColor(Qt.white))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    assert not job.errors(), [error.message for error in job.errors()]
    shown = bytes_of(job.renderedImage().convertToFormat(QImage.Format_RGB32))
    picture = QImage(SIZE, SIZE, QImage.Format_RGB32)
    picture.fill(Qt.white)
    painter = QPainter(picture)
    painter.drawImage(0, 0, QImage.fromData(get(
        f"{base}map/land.png?bbox=0,33.75,22.5,56.25&crs=EPSG:4326&width={SIZE}&height={SIZE}")))
    painter.end()
    own = bytes_of(picture)
    assert len(set(own[i:i + 3] for i in range(0, len(own), 4))) > 1, "there is nothing on the map"
    differing = sum(
        any(abs(a - b) > TOLERANCE for a, b in zip(shown[i:i + 3], own[i:i + 3]))
        for i in range(0, len(own), 4))
    assert differing <= MOST_DIFFERING_OF_WMTS * SIZE * SIZE, f"{name}: {differing} pixels differ"
    print(f"QGIS shows {name}; {differing} pixels differ")


application = QgsApplication([], False)
application.initQgis()
try:
    with served_map() as (base, folder):
        xyz = f"type=xyz&url={base}tiles/land,lake/{{z}}/{{x}}/{{y}}.png&zmin=0&zmax=22"
        check("XYZ", QgsRasterLayer(xyz, "xyz", "wms"), base + "tiles/land,lake/{z}/{x}/{y}.png",
              MOST_DIFFERING)
        for style in ("default", "night"):
            wmts = ("contextualWMSLegend=0&crs=EPSG:3857&dpiMode=7&format=image/png&layers=land"
                    f"&styles={style}&tileMatrixSet=WebMercatorQuad&url={base}wmts.xml")
            layer = QgsRasterLayer(wmts, style, "wms")
            check(f"WMTS in the style {style}", layer,
                  base + f"tiles/land/s/{style}/{{z}}/{{x}}/{{y}}.png", MOST_DIFFERING_OF_WMTS)
        check_features(layer)
        for style in ("default", "night"):
            wms = ("IgnoreReportedLayerExtents=1&contextualWMSLegend=0&crs=EPSG:3857&dpiMode=7&format=image/png&layers=land"
                   f"&styles={style}&url={base}wms")
            layer = QgsRasterLayer(wms, style, "wms")
            check(f"WMS in the style {style}", layer,
                  base + f"tiles/land/s/{style}/{{z}}/{{x}}/{{y}}.png", MOST_DIFFERING)
        check_features(layer)
        check_print(base)
        check_degrees(base, "WMS in degrees",
                      "IgnoreReportedLayerExtents=1&contextualWMSLegend=0&crs=EPSG:4326&dpiMode=7"
                      f"&format=image/png&layers=land&styles=default&url={base}wms")
        check_degrees(base, "WMTS in degrees",
                      "contextualWMSLegend=0&crs=CRS:84&dpiMode=7&format=image/png&layers=land"
                      f"&styles=default&tileMatrixSet=WorldCRS84Quad&url={base}wmts.xml")
    status = 0
finally:
    QgsProject.instance().clear()
    application.exitQgis()
sys.exit(status)
