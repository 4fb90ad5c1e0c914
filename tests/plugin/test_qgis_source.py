"""Layers of the project, and its whole map, as sources: exact, whole, off the main thread, ended when asked."""

from __future__ import annotations

import re
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np
import pytest
from osgeo import gdal, osr
from pyproj import Transformer
from qgis.core import (
    QgsFeature,
    QgsFillSymbol,
    QgsGeometry,
    QgsHueSaturationFilter,
    QgsMarkerSymbol,
    QgsPalLayerSettings,
    QgsProject,
    QgsRasterLayer,
    QgsTextBufferSettings,
    QgsTextFormat,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)
from qgis.PyQt.QtCore import QCoreApplication, QTimer
from qgis.PyQt.QtGui import QColor
from terrainav.core.errors import Cancelled, InvalidInput, PartError
from terrainav.core.geodesy.mercator import HALF_WORLD_M
from terrainav.core.imagery.source import Window
from terrainav.core.picture.map_frame import assemble
from terrainav.terrainav_plugin.qgis_source import tiles
from terrainav.terrainav_plugin.qgis_source.connections import parse_connection
from terrainav.terrainav_plugin.qgis_source.renderer import Jobs
from terrainav.terrainav_plugin.qgis_source.snapshot import (
    PROJECT_SOURCE,
    grid_of_layers,
    layer_choices,
    policies_of_layers,
    source_name,
    take_snapshot,
)
from terrainav.terrainav_plugin.qgis_source.source import LayerSource

from tests.plugin.transports import BUSY_S, CANCEL_S
from tests.support.patterns import decode_position, encode_position, to_bytes
from tests.support.patterns import positions as pattern_tile
from tests.support.services import ServiceServer, matrix, matrix_set, wms_document, wmts_document, wmts_layer
from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

ZOOM = 17
# Some place of Memphis, not at a tile's edge: px of the global grid at that zoom.
LEFT, TOP = 32_819 * 256 + 37, 51_874 * 256 + 91
WINDOW = Window(ZOOM, LEFT, TOP, 600, 400)
SOURCES = []


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def add(layer):
    assert layer.isValid()
    return QgsProject.instance().addMapLayer(layer)


def tiles_layer(server, name="tiles", zmax=19, **more):
    url = server.url_template.replace("{", "%7B").replace("}", "%7D")
    rest = "".join(f"&{key}={value}" for key, value in more.items())
    return add(QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax={zmax}{rest}", name, "wms"))


@pytest.fixture(autouse=True)
def sources():
    """Those that a test has opened, which are closed when it is over, also where it has not come to that."""
    del SOURCES[:]
    yield
    for source in SOURCES:
        source.close()


def opened(name, **options):
    SOURCES.append(LayerSource(take_snapshot(name, QgsProject.instance()), **options))
    return SOURCES[-1]


def off_the_main_thread(work):
    """Result of ``work`` on another thread, while the application goes on."""
    results = []

    def run():
        try:
            results.append(work())
        except Exception as wrong:  # noqa: BLE001  raised again below
            results.append(wrong)

    thread = threading.Thread(target=run)
    thread.start()
    while thread.is_alive():
        QCoreApplication.processEvents()
        time.sleep(0.001)
    if isinstance(results[0], Exception):
        raise results[0]
    return results[0]


def picture(source, window):
    """A window as a capture makes it: parts on several threads, put together."""

    def work():
        parts = source.parts(window)
        with ThreadPoolExecutor(4) as pool:
            pixels = pool.map(lambda part: source.fetch("satellite", part.window), parts)
            return assemble(window, parts, dict(zip((part.window for part in parts), pixels)))

    return off_the_main_thread(work)


def positions(window):
    """What a source of positions shows of a window."""
    return encode_position(window.left_px + np.arange(window.width_px), window.top_px + np.arange(window.height_px))


def edges(window):
    """West, south, east, north in EPSG:3857, by the definition of the grid."""
    px = 2.0 * HALF_WORLD_M / (256 << window.zoom)
    west, north = -HALF_WORLD_M + window.left_px * px, HALF_WORLD_M - window.top_px * px
    return west, north - window.height_px * px, west + window.width_px * px, north


def vector_layer(kind, name, *shapes, fields="", crs="EPSG:3857"):
    """Memory layer of WKT shapes, each with the values of its fields."""
    layer = QgsVectorLayer(f"{kind}?crs={crs}{fields}", name, "memory")
    features = []
    for wkt, values in shapes:
        feature = QgsFeature(layer.fields())
        feature.setGeometry(QgsGeometry.fromWkt(wkt))
        feature.setAttributes(list(values))
        features.append(feature)
    layer.dataProvider().addFeatures(features)
    layer.updateExtents()
    return layer


def box_wkt(west, south, east, north):
    return f"POLYGON(({west} {south},{east} {south},{east} {north},{west} {north},{west} {south}))"


def utm_raster(path, resolution_m, size_px, middle):
    """GeoTIFF in UTM 16 N about a place of EPSG:3857, whose pixels hold their own column and row."""
    x, y = Transformer.from_crs(3857, 32616, always_xy=True).transform(*middle)
    half = size_px * resolution_m / 2
    # Not on round numbers, as real rasters.
    west, north = x - half + 0.37 * resolution_m, y + half - 0.21 * resolution_m
    file = gdal.GetDriverByName("GTiff").Create(str(path), size_px, size_px, 3, gdal.GDT_Byte)
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(32616)
    file.SetProjection(crs.ExportToWkt())
    file.SetGeoTransform((west, resolution_m, 0.0, north, 0.0, -resolution_m))
    pattern = encode_position(np.arange(size_px), np.arange(size_px))
    for band in range(3):
        file.GetRasterBand(band + 1).WriteArray(pattern[..., band])
    file.FlushCache()
    return west, north


def test_tiles_of_a_service_come_pixel_by_pixel_and_once(server):
    source = opened(source_name(tiles_layer(server)))
    assert np.array_equal(picture(source, WINDOW), positions(WINDOW))
    # Each tile of the window, and no neighbour of them.
    columns = (LEFT + WINDOW.width_px - 1) // 256 - LEFT // 256 + 1
    rows = (TOP + WINDOW.height_px - 1) // 256 - TOP // 256 + 1
    wanted = {tile: times for tile, times in server.tile_requests.items() if tile[1] == ZOOM}
    assert len(wanted) == columns * rows
    assert set(wanted.values()) == {1}
    source.close()


@pytest.mark.parametrize("zoom", [3, 9, 14, 19])
def test_tiles_are_exact_at_every_zoom(server, zoom):
    source = opened(source_name(tiles_layer(server)))
    for share in (0.1, 0.37, 0.62, 0.9):
        at = int(share * (1 << zoom)) * 256
        window = Window(zoom, at, at, 256, 256)
        assert np.array_equal(picture(source, window), positions(window))
    source.close()


@pytest.mark.parametrize(
    ("fault", "reason"),
    sampled([("404", "no imagery at"), ("503", "503 Service Unavailable"), ("reset", "cut off after")], 3),
)
def test_hole_of_a_service_fails_the_pictures_that_show_it(server, fault, reason):
    missing = (ZOOM, LEFT // 256 + 1, TOP // 256)
    server.fail(fault, missing)
    source = opened(source_name(tiles_layer(server)))
    with pytest.raises(PartError, match=reason):
        picture(source, WINDOW)
    beside = Window(ZOOM, LEFT, TOP + 256, 600, 100)
    assert np.array_equal(picture(source, beside), positions(beside))
    source.close()


def zoomed_in(server, beyond):
    return opened(source_name(tiles_layer(server, zmax=ZOOM))), WINDOW._replace(
        zoom=ZOOM + beyond, left_px=LEFT << beyond, top_px=TOP << beyond
    )


@pytest.mark.parametrize("beyond", [1, 3])
def test_beyond_the_finest_tiles_each_pixel_is_repeated(server, beyond):
    source, window = zoomed_in(server, beyond)
    assert source.grid.native_zoom == ZOOM
    columns, rows = (
        (int(start) + np.arange(size)) >> beyond
        for start, size in ((window.left_px, window.width_px), (window.top_px, window.height_px))
    )
    assert np.array_equal(picture(source, window), encode_position(columns, rows))


def test_tiles_of_double_width_have_the_pixels_of_the_next_zoom():
    with TileServer(tile_px=512) as server:
        source = opened(source_name(tiles_layer(server, tilePixelRatio=2)))
        assert source.grid.native_zoom == 20
        assert np.array_equal(picture(source, WINDOW), positions(WINDOW))
        assert ZOOM not in {zoom for _, zoom, *_ in server.tile_requests}


@pytest.mark.parametrize("tile_px", [512, 1024])
def test_tiles_whose_width_is_not_stated_are_captured_at_256_px(tile_px):
    """QGIS's default, "Unknown (not scaled)": each of its tiles is drawn at 256 px, whatever it holds."""
    with TileServer(tile_px=tile_px) as server:
        layer = tiles_layer(server, tilePixelRatio=0)
        source = opened(source_name(layer))
        assert source.grid.native_zoom == 19
        shown = picture(source, Window(ZOOM, 256 * 5, 256 * 6, 256, 256))
        each = tile_px // 256
        tile = pattern_tile("", ZOOM, 5, 6, tile_px).astype(float)
        means = tile.reshape(256, each, 256, each, 3).mean(axis=(1, 3))
        assert np.abs(shown - means).max() <= 0.5 + 1e-9


def test_address_of_tiles_is_read_once(server, monkeypatch):
    read = []

    def noted(*given):
        read.append(given)
        return parse_connection(*given)

    monkeypatch.setattr(tiles, "parse_connection", noted)
    layer = tiles_layer(server)
    snapshot = take_snapshot(source_name(layer), QgsProject.instance())
    assert len(read) == 1
    assert snapshot.grid.native_zoom == 19
    snapshot.ground[0].close()


@contextmanager
def wmts_service(tile_px=256, level="{}"):
    """A service of the Web-Mercator quad, whose zooms go by names, and a layer of it in the project."""
    answered = re.compile(r"/tiles/(?:.*:)?(\d+)/(\d+)/(\d+)\.png")

    def answer(path, _query):
        if path == "/c.xml":
            rest = f"{running.url}/tiles/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"
            matrices = matrix_set("quad", [matrix(level.format(zoom), zoom, tile_px) for zoom in range(20)])
            layer = wmts_layer("ortho", {"quad": []}, resources=[("image/png", rest)])
            return 200, "application/xml", wmts_document([layer], [matrices])
        zoom, x, y = (int(number) for number in answered.fullmatch(path).groups())
        return 200, "image/png", to_bytes(pattern_tile("", zoom, x, y, tile_px), "png")

    with ServiceServer(answer) as running:
        uri = f"crs=EPSG:3857&format=image/png&layers=ortho&styles=default&tileMatrixSet=quad&url={running.url}/c.xml"
        yield running, add(QgsRasterLayer(uri, "wmts", "wms"))


def test_tiles_of_a_wmts_are_exact():
    """Their address is in the capabilities, which QGIS and the capture each ask for."""
    with wmts_service() as (running, layer):
        source = opened(source_name(layer))
        assert np.array_equal(picture(source, WINDOW), positions(WINDOW))
        asked = [path for path in running.asked if path.startswith(f"/tiles/{ZOOM}/")]
        assert len(asked) == len(set(asked)) == 3 * 2


def test_tiles_whose_zooms_are_others_are_refused_in_one_line():
    with wmts_service(tile_px=768) as (_, layer):
        source = opened(source_name(layer))
        with pytest.raises(InvalidInput, match="layer wmts: its service has tiles of 768 px; choose") as refused:
            picture(source, WINDOW)
        assert "\n" not in str(refused.value)
        source.close()


def overlay(url, name="overlay"):
    url = f"{url}/{{z}}/{{x}}/{{y}}.png".replace("{", "%7B").replace("}", "%7D")
    return add(QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax=19", name, "wms"))


def test_translucent_tiles_let_what_is_below_show(server):
    """Two layers of tiles, the upper half transparent: the mean of both, to within the rounding of the two."""
    half = np.dstack([np.full((256, 256, 3), (200, 100, 0), np.uint8), np.full((256, 256), 128, np.uint8)])
    with ServiceServer(lambda *_: (200, "image/png", to_bytes(half, "png"))) as above:
        tiles_layer(server)
        overlay(above.url)
        shown = picture(opened(PROJECT_SOURCE), WINDOW).astype(float)
    expected = positions(WINDOW) * (127 / 255) + np.array([200, 100, 0]) * (128 / 255)
    assert np.abs(shown - expected).max() <= 2.0


def test_layer_has_its_own_colours(server):
    """Grey by lightness, the mean of the largest and the least colour, and half as opaque on black paper."""
    layer = tiles_layer(server)
    layer.hueSaturationFilter().setGrayscaleMode(QgsHueSaturationFilter.GrayscaleMode.GrayscaleLightness)
    layer.renderer().setOpacity(0.5)
    QgsProject.instance().setBackgroundColor(QColor(0, 0, 0))
    shown = picture(opened(source_name(layer)), WINDOW).astype(float)
    own = positions(WINDOW).astype(float)
    lightness = (own.max(axis=2) + own.min(axis=2)) / 2.0
    assert np.ptp(shown, axis=2).max() <= 1.0
    assert np.abs(shown[..., 0] - lightness / 2.0).max() <= 2.0


def test_terms_of_the_provider_hold_for_a_layer_of_its_tiles():
    """However its tiles are asked for: OpenStreetMap's are for looking at."""
    url = "https://tile.openstreetmap.org/%7Bz%7D/%7Bx%7D/%7By%7D.png"
    layer = add(QgsRasterLayer(f"type=xyz&url={url}&zmin=0&zmax=19", "my map", "wms"))
    ((policy, title),) = policies_of_layers(source_name(layer), QgsProject.instance())
    assert (policy.bulk_allowed, title) == ("no", "my map")
    assert opened(PROJECT_SOURCE).policy == policy


def test_hole_below_a_drawing_is_a_hole(server):
    """A polygon over all of it must not hide that the service did not answer."""
    server.fail("404", (ZOOM, LEFT // 256 + 1, TOP // 256))
    tiles_layer(server)
    cover = vector_layer("Polygon", "cover", (box_wkt(*edges(WINDOW)), ()))
    add(cover)
    source = opened(PROJECT_SOURCE)
    with pytest.raises(PartError, match="no imagery at"):
        picture(source, WINDOW)
    source.close()


@pytest.mark.parametrize("resolution_m", [0.3, 1.0, 2.6])
def test_raster_in_utm_is_taken_at_the_very_pixels(tmp_path, resolution_m):
    """Of the whole map, each pixel shows the pixel of the raster that its centre lies in, by pyproj's formulas."""
    west_m, south_m, east_m, north_m = edges(WINDOW)
    size_px = int(1200 / resolution_m)
    middle = ((west_m + east_m) / 2, (south_m + north_m) / 2)
    path = tmp_path / "utm.tif"
    west, north = utm_raster(path, resolution_m, size_px, middle)
    add(QgsRasterLayer(str(path), "utm", "gdal"))
    source = opened(PROJECT_SOURCE)
    shown = picture(source, WINDOW)
    columns, rows = decode_position(shown)
    x = west_m + (np.arange(WINDOW.width_px) + 0.5) * (east_m - west_m) / WINDOW.width_px
    y = north_m - (np.arange(WINDOW.height_px) + 0.5) * (north_m - south_m) / WINDOW.height_px
    there = Transformer.from_crs(3857, 32616, always_xy=True).transform(*np.meshgrid(x, y))
    expected_x, expected_y = (there[0] - west) / resolution_m, (north - there[1]) / resolution_m
    # Half a pixel of the raster, and the nanometres in which two programs' projections differ.
    assert np.abs(columns % 4096 + 0.5 - expected_x).max() <= 0.5 + 1e-4
    assert np.abs(rows % 4096 + 0.5 - expected_y).max() <= 0.5 + 1e-4
    source.close()


def test_raster_says_up_to_which_zoom_it_has_detail(tmp_path):
    path = tmp_path / "utm.tif"
    utm_raster(path, 1.0, 300, (-10_000_000.0, 4_180_000.0))
    add(QgsRasterLayer(str(path), "utm", "gdal"))
    source = opened(PROJECT_SOURCE)
    # A metre at 35 degrees north is 1.22 m of the map, whose zooms have 1.19 m (17) and 2.39 m (16).
    assert source.grid.native_zoom == 16
    assert source.grid.max_zoom == 22


def test_raster_says_where_it_ends(tmp_path):
    """By pyproj's formulas, to a millimetre; several layers together say nothing."""
    path = tmp_path / "utm.tif"
    west, north = utm_raster(path, 1.0, 300, (-10_000_000.0, 4_180_000.0))
    add(QgsRasterLayer(str(path), "utm", "gdal"))
    corners = np.array(opened(PROJECT_SOURCE).grid.extent)
    x, y = Transformer.from_crs(32616, 3857, always_xy=True).transform(
        west + np.array([0.0, 300.0, 300.0, 0.0]), north - np.array([0.0, 0.0, 300.0, 300.0])
    )
    shown = (corners[:, 0] - 0.5) * 2.0 * HALF_WORLD_M, (0.5 - corners[:, 1]) * 2.0 * HALF_WORLD_M
    assert np.abs(np.array(shown) - (x, y)).max() < 1e-3
    add(vector_layer("Polygon", "cover", (box_wkt(*edges(WINDOW)), ())))
    assert opened(PROJECT_SOURCE).grid.extent is None


@pytest.mark.parametrize("whole_map", [True, False])
def test_beyond_a_raster_there_is_no_picture(tmp_path, whole_map):
    path = tmp_path / "utm.tif"
    utm_raster(path, 1.0, 200, edges(WINDOW)[::3])
    layer = add(QgsRasterLayer(str(path), "utm", "gdal"))
    source = opened(PROJECT_SOURCE if whole_map else source_name(layer))
    window = WINDOW if whole_map else Window(source.grid.native_zoom, -40, 150, 90, 70)
    with pytest.raises(PartError, match="no imagery at"):
        picture(source, window)
    source.close()


def test_vector_layer_with_its_style_lies_at_its_place():
    west, _, east, north = edges(WINDOW)
    px = (east - west) / WINDOW.width_px
    inner = box_wkt(west + 100 * px, north - 300 * px, west + 400 * px, north - 50 * px)
    layer = vector_layer("Polygon", "fields", (inner, ()))
    symbol = {"color": "10,200,30,255", "outline_style": "no"}
    layer.renderer().setSymbol(QgsFillSymbol.createSimple(symbol))
    source = opened(source_name(add(layer)))
    assert source.title == "fields"
    QgsProject.instance().setBackgroundColor(QColor(1, 2, 3))
    source = opened(source_name(layer))
    shown = picture(source, WINDOW)
    expected = np.full((400, 600, 3), (1, 2, 3), np.uint8)
    expected[50:300, 100:400] = (10, 200, 30)
    # The outermost line of pixels may be mixed: edges lie on them to a billionth of a pixel only.
    differing = (shown != expected).any(axis=2)
    differing[[49, 50, 299, 300], :] = False
    differing[:, [99, 100, 399, 400]] = False
    assert not differing.any()
    elsewhere = WINDOW._replace(left_px=WINDOW.left_px + 5000)
    with pytest.raises(PartError, match="fields shows nothing here"):
        picture(source, elsewhere)
    source.close()


def test_whole_map_is_what_lies_above_what(server):
    tiles_layer(server)
    west, south, east, north = edges(WINDOW)
    px = (east - west) / WINDOW.width_px
    patch = vector_layer(
        "Polygon", "patch", (box_wkt(west + 50 * px, north - 90 * px, west + 70 * px, north - 80 * px), ())
    )
    patch.renderer().setSymbol(QgsFillSymbol.createSimple({"color": "255,0,0,255", "outline_style": "no"}))
    add(patch)
    hidden = vector_layer("Polygon", "hidden", (box_wkt(west, south, east, north), ()))
    QgsProject.instance().layerTreeRoot().findLayer(add(hidden)).setItemVisibilityChecked(False)
    shown = picture(opened(PROJECT_SOURCE), WINDOW)
    expected = positions(WINDOW)
    assert (shown[82:88, 52:68] == (255, 0, 0)).all()
    differing = (shown != expected).any(axis=2)
    differing[79:92, 49:72] = False
    assert not differing.any()


def labelled_points():
    west, _, east, north = edges(WINDOW)
    px = (east - west) / WINDOW.width_px
    # One in the middle of a tile's edge, one whose label reaches over the picture's right edge.
    tile_edge = (LEFT // 256 + 1) * 256 - LEFT
    shapes = [
        (f"POINT({west + column * px} {north - row * px})", (text,))
        for column, row, text in ((tile_edge, 200, "MMMMMMMM"), (596, 100, "WWWWWWWW"))
    ]
    layer = vector_layer("Point", "labels", *shapes, fields="&field=name:string")
    layer.renderer().setSymbol(QgsMarkerSymbol.createSimple({"size": "0.1"}))
    text = QgsTextFormat()
    text.setSize(14)
    text.setColor(QColor(0, 0, 0))
    text.setBuffer(QgsTextBufferSettings())
    settings = QgsPalLayerSettings()
    settings.fieldName, settings.placement = "name", QgsPalLayerSettings.Placement.OverPoint
    settings.setFormat(text)
    layer.setLabeling(QgsVectorLayerSimpleLabeling(settings))
    layer.setLabelsEnabled(True)
    return layer


def test_labels_are_whole_where_tiles_and_pictures_meet():
    QgsProject.instance().setBackgroundColor(QColor(255, 255, 255))
    source = opened(source_name(add(labelled_points())))
    ink = (picture(source, WINDOW) < 128).all(axis=2)
    tile_edge = (LEFT // 256 + 1) * 256 - LEFT
    middle = ink[180:220]
    columns = np.flatnonzero(middle.any(axis=0))
    # Eight letters about the tile's edge, half of them on either side.
    assert columns.min() < tile_edge - 40 < tile_edge + 40 < columns.max()
    left, right = middle[:, :tile_edge].sum(), middle[:, tile_edge:].sum()
    assert abs(left - right) < 0.1 * (left + right)
    # The other begins in one picture and goes on in the next, as if both were one.
    beyond = (picture(source, WINDOW._replace(left_px=LEFT + WINDOW.width_px)) < 128).all(axis=2)
    astride = picture(source, WINDOW._replace(left_px=LEFT + 300))
    assert ink[80:120, -40:].any()
    assert beyond[80:120, :40].any()
    assert np.array_equal(np.hstack([ink, beyond])[80:120, 500:700], (astride < 128).all(axis=2)[80:120, 200:400])


def test_main_thread_goes_on_while_a_service_is_waited_for(server):
    """Its loop turns, and runs Python, many times while a single part is drawn."""
    server.latency_s = 0.5
    source = opened(source_name(tiles_layer(server)))
    turns = []
    timer = QTimer()
    timer.timeout.connect(lambda: turns.append(threading.get_ident()))
    timer.start(5)
    pixels = off_the_main_thread(lambda: source.fetch("satellite", Window(ZOOM, 0, 256, 256, 256)))
    timer.stop()
    source.close()
    assert pixels.shape == (256, 256, 3)
    assert len(turns) >= 10


def test_cancel_ends_a_service_that_does_not_answer(server):
    server.fail("stall")
    source = opened(source_name(tiles_layer(server)))
    outcome = {}

    def work():
        with pytest.raises(Cancelled):
            source.fetch("satellite", Window(ZOOM, 256 * 5, 256 * 6, 256, 256))
        outcome["ended_s"] = time.monotonic()

    def end():
        outcome["asked_s"] = time.monotonic()
        source.close()

    timer = threading.Timer(0.5, end)
    timer.start()
    off_the_main_thread(work)
    timer.join()
    assert outcome["ended_s"] - outcome["asked_s"] < CANCEL_S + BUSY_S
    with pytest.raises(Cancelled):
        source.fetch("satellite", Window(ZOOM, 0, 0, 256, 256))


def test_drawing_that_takes_too_long_is_a_failed_part():
    """A map that a service draws when it is asked."""
    over = threading.Event()

    def answer(_path, query):
        if query.get("REQUEST") == "GetCapabilities":
            crs = "<CRS>EPSG:3857</CRS><EX_GeographicBoundingBox><westBoundLongitude>-180</westBoundLongitude>"
            crs += "<eastBoundLongitude>180</eastBoundLongitude><southBoundLatitude>-85</southBoundLatitude>"
            crs += "<northBoundLatitude>85</northBoundLatitude></EX_GeographicBoundingBox>"
            layer = f"<Layer><Name>map</Name><Title>Map</Title>{crs}</Layer>"
            return 200, "text/xml", wms_document("1.3.0", f"{running.url}/wms", layer)
        over.wait(20.0)
        return 404, "text/plain", b""

    with ServiceServer(answer) as running:
        uri = f"crs=EPSG:3857&format=image/png&layers=map&styles=&url={running.url}/wms"
        source = opened(source_name(add(QgsRasterLayer(uri, "wms", "wms"))), jobs=Jobs(longest_s=0.3))

        def work():
            with pytest.raises(PartError, match="had not drawn it after"):
                source.fetch("satellite", Window(ZOOM, 256 * 5, 256 * 6, 256, 256))
            return True

        assert off_the_main_thread(work)
        over.set()


def test_choices_are_the_map_and_the_layers_that_show_something(server):
    assert layer_choices(QgsProject.instance()) == []
    tiles = tiles_layer(server, "orthophoto")
    add(QgsVectorLayer("NoGeometry?field=a:int", "table", "memory"))
    choices = layer_choices(QgsProject.instance())
    assert [choice.title for choice in choices] == ["Whole map", "orthophoto"]
    assert choices[1].name == f"qgis:layer/{tiles.id()}"


def test_attribution_and_date_come_from_the_layer(server, tmp_path):
    from qgis.core import Qgis, QgsDateTimeRange
    from qgis.PyQt.QtCore import QDate, QDateTime, QTime

    layer = tiles_layer(server)
    metadata = layer.metadata()
    metadata.setRights(["© County of Shelby"])
    layer.setMetadata(metadata)
    times = layer.temporalProperties()
    day = QDateTime(QDate(2023, 6, 1), QTime(0, 0))
    times.setMode(Qgis.RasterTemporalMode.FixedTemporalRange)
    times.setFixedTemporalRange(QgsDateTimeRange(day, day.addDays(1)))
    times.setIsActive(True)
    source = opened(source_name(layer))
    assert (source.title, source.attribution, source.date) == ("tiles", "© County of Shelby", "2023-06-01")


def test_layer_that_is_gone_is_named(server):
    name = source_name(tiles_layer(server))
    QgsProject.instance().removeAllMapLayers()
    with pytest.raises(InvalidInput, match="no such layer"):
        take_snapshot(name, QgsProject.instance())
    with pytest.raises(InvalidInput, match="shows no layer"):
        take_snapshot(PROJECT_SOURCE, QgsProject.instance())


def test_whole_map_is_captured_from_the_panel(desk, server):
    """From the chooser to georeferenced files whose pixels are where they say."""
    tiles_layer(server, "my orthophoto")
    desk.wait(lambda: desk.form.source.findData(PROJECT_SOURCE) >= 0)
    desk.enter_coarse_mission()
    desk.choose(desk.form.source, PROJECT_SOURCE)
    planned = desk.wait_planned()
    desk.click(desk.dock.capture)
    desk.wait(lambda: desk.session.runs.task is not None)
    desk.wait_for_run()
    files = sorted((desk.folder / "satellite").glob("*.tif"))
    assert len(files) == len(planned.plan)
    index = list(planned.plan.names).index(files[3].stem)
    shown = np.moveaxis(gdal.Open(str(files[3])).ReadAsArray(), 0, -1)
    columns, rows = decode_position(shown)
    left, top = (int(values[index]) for values in planned.plan.windows[:2])
    assert np.array_equal(columns[0], (left + np.arange(shown.shape[1])) % 4096)
    assert np.array_equal(rows[:, 0], (top + np.arange(shown.shape[0])) % 4096)
    assert "Whole map" in (desk.folder / "satellite" / "meta_data.csv").read_text()


@pytest.mark.parametrize(
    ("side", "bands", "data_type", "options", "words"),
    [
        (4, 10_001, gdal.GDT_Byte, (), "has 10,001 bands: must be at most 10,000"),
        (20_000, 1, gdal.GDT_UInt16, ("COMPRESS=DEFLATE", "BLOCKYSIZE=20000"), "blocks of 20,000x20,000 px"),
    ],
    ids=["bands", "blocks"],
)
def test_rasters_of_more_than_can_be_read_are_refused(tmp_path, side, bands, data_type, options, words):
    path, options = str(tmp_path / "large.tif"), ["SPARSE_OK=YES", "INTERLEAVE=PIXEL", *options]
    made = gdal.GetDriverByName("GTiff").Create(path, side, side, bands, data_type, options=options)
    made.SetGeoTransform((690_000.0, 1.0, 0.0, 5_300_000.0, 0.0, -1.0))
    made.SetProjection("EPSG:25832")
    made.FlushCache()
    layer = add(QgsRasterLayer(path, "large"))
    for taken in (take_snapshot, grid_of_layers):
        with pytest.raises(InvalidInput, match=f"large: .*{words}"):
            taken(source_name(layer), QgsProject.instance())
