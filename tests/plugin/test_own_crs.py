"""Rasters in a projected CRS in the real application: drawn, planned, previewed and captured in their own pixels."""

from __future__ import annotations

import html
from dataclasses import replace

import numpy as np
import processing
import pyproj
import pytest
from osgeo import gdal
from qgis.core import (
    QgsContrastEnhancement,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsFeature,
    QgsGeometry,
    QgsProject,
    QgsRasterLayer,
    QgsRectangle,
    QgsSingleBandGrayRenderer,
    QgsVectorLayer,
)
from qgis.PyQt.QtWidgets import QComboBox, QLabel
from terrainav.core.capture.runner import capture as run
from terrainav.core.imagery.raster.source import open_raster
from terrainav.core.imagery.source import Window
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.area.outline import AreaOutline, moved
from terrainav.terrainav_plugin.dataset.rectify import lay_on_map
from terrainav.terrainav_plugin.map.outlines import seen_edges
from terrainav.terrainav_plugin.qgis_source.snapshot import source_name, take_snapshot
from terrainav.terrainav_plugin.qgis_source.source import LayerSource
from terrainav.terrainav_plugin.results.shots import Finder, FootprintLayer

from tests.core.imagery.raster.test_own_pixels import about, noise
from tests.plugin.test_capture import capture, drawn, images
from tests.support import rasters
from tests.support.thinning import sampled

#: Orthophotos of 750 m about a place: EPSG code, latitude and longitude.
UTM, POLE = (32616, 35.15, -89.9), (3031, -90.0, 0.0)
#: What QGIS's transformations and pyproj's differ by: nanometres, of coordinates of millions of metres.
NOISE_M = 1e-5


def middle_of(place):
    epsg, lat, lon = place
    return pyproj.Transformer.from_crs(4326, epsg, always_xy=True).transform(lon, lat)


def rectangle(place, half_m):
    x, y = middle_of(place)
    return x - half_m, y - half_m, x + half_m, y + half_m


def set_source(desk, source):
    desk.form.set_state(replace(desk.session.state(), source=source, folder=str(desk.folder)))


def draw(desk, place, half_m):
    """Draw a square about a place by the mouse; the map shows half as much again."""
    desk.look_at(f"EPSG:{place[0]}", rectangle(place, 1.5 * half_m))
    # As the button does on a map with layers.
    desk.session.box_tool.start()
    to_px = desk.canvas.getCoordinateTransform().transform
    west, south, east, north = rectangle(place, half_m)
    start, end = (to_px(x, y) for x, y in ((west, north), (east, south)))
    desk.drag(start.toQPointF().toPoint(), end.toQPointF().toPoint())
    return desk.wait_planned()


def captured_edges(desk):
    """West, south, east, north of the files that were captured, by their names, and their CRS."""
    found, systems = {}, set()
    for path in images(desk):
        file = gdal.Open(str(path))
        west, across, _, north, _, down = file.GetGeoTransform()
        east, south = west + across * file.RasterXSize, north + down * file.RasterYSize
        found[path.stem] = west, south, east, north
        systems.add(f"EPSG:{file.GetSpatialRef().GetAuthorityCode(None)}")
    return found, systems


def edges_of(geometry):
    box = geometry.boundingBox()
    return box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()


def layer_edges(layer, to):
    """Edges of a layer's features in a CRS, by QGIS's own transformation."""
    there = QgsCoordinateTransform(layer.crs(), QgsCoordinateReferenceSystem(to), QgsProject.instance())
    found = {}
    for feature in layer.getFeatures():
        geometry = QgsGeometry(feature.geometry())
        assert geometry.transform(there) == 0
        found[feature["name"]] = geometry
    return found


@pytest.mark.parametrize(
    ("place", "kind"), sampled([(UTM, "file"), (POLE, "file"), (UTM, "layer"), (POLE, "layer")], 3)
)
def test_orthophoto_is_planned_previewed_and_captured_in_its_own_pixels(desk, tmp_path, place, kind):
    values, (west, pixel, _, north, _, _) = noise(tmp_path / "ortho.tif", *place)
    crs = f"EPSG:{place[0]}"
    source = str(tmp_path / "ortho.tif")
    if kind == "layer":
        source = source_name(QgsProject.instance().addMapLayer(QgsRasterLayer(source, "ortho", "gdal")))
    set_source(desk, source)
    planned = draw(desk, place, 200.0)
    assert isinstance(planned.mission.area, Polygon if place is POLE else Box)
    assert planned.plan.grid.plane.crs == crs
    assert planned.plan.coverage.complete
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    previewed = layer_edges(desk.layer("Planned images"), crs)
    for name in ("Area", "Capture centres", "Flight line", "Planned images", "Images per place"):
        assert desk.layer(name).crs().authid() == crs
    # What is drawn is the ground that the mouse went around.
    (area,) = (feature.geometry() for feature in desk.layer("Area").getFeatures())
    grown = QgsGeometry.fromRect(QgsRectangle(*rectangle(place, 200.0))).buffer(2.0, 2)
    drawn = QgsGeometry.unaryUnion(list(previewed.values()))
    assert drawn.contains(QgsGeometry.fromRect(QgsRectangle(*rectangle(place, 198.0))))
    assert area.isGeosValid()
    assert area.length() < 1_700.0
    # The box around it is a little larger, as its sides are parallels and meridians.
    assert grown.contains(area) or place is UTM
    assert area.area() == pytest.approx(160_000.0, rel=0.08 if place is UTM else 0.03)

    capture(desk)
    found, systems = captured_edges(desk)
    assert systems == {crs}
    assert set(found) == set(previewed) == set(planned.plan.names)
    for name, edges in found.items():
        assert edges_of(previewed[name]) == pytest.approx(edges, abs=NOISE_M)

    # The mosaic is the orthophoto, wherever there are pictures.
    mosaic = desk.layer("Satellite images")
    assert mosaic.crs().authid() == crs
    file = gdal.Open(mosaic.source())
    left, across, _, top, _, down = file.GetGeoTransform()
    assert (across, down) == (pixel, -pixel)
    column, row = (left - west) / pixel, (north - top) / pixel
    assert (abs(column - round(column)), abs(row - round(row))) == pytest.approx((0.0, 0.0), abs=1e-6)
    shown = file.ReadAsArray()
    rows = slice(round(row), round(row) + shown.shape[1])
    columns = slice(round(column), round(column) + shown.shape[2])
    there = shown[3] == 255
    assert there.mean() > 0.9
    assert np.array_equal(shown[:3][:, there], values[:, rows, columns][:, there])

    # Footprints are in degrees; about the pole they still are where the pictures are.
    footprints = desk.layer("Captured images")
    assert footprints.crs().authid() == "EPSG:4326"
    for name, geometry in layer_edges(footprints, crs).items():
        if place is UTM:
            assert edges_of(geometry) == pytest.approx(found[name], abs=1.0)
        else:
            assert abs(geometry.area() / previewed[name].area() - 1.0) < 0.05


@pytest.mark.parametrize("map_crs", sampled(["EPSG:4326", "EPSG:3857", "EPSG:2163"], 3))
def test_preview_in_a_project_of_another_crs(desk, tmp_path, map_crs):
    """What is in view is drawn, wherever the map is moved, and nothing when it is elsewhere."""
    noise(tmp_path / "ortho.tif", *UTM)
    set_source(desk, str(tmp_path / "ortho.tif"))
    planned = draw(desk, UTM, 350.0)
    assert len(planned.plan) > 30
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    there = QgsCoordinateTransform(
        QgsCoordinateReferenceSystem("EPSG:32616"),
        QgsCoordinateReferenceSystem(map_crs),
        QgsProject.instance(),
    )
    for half_m in (30.0, 400.0, 100_000.0):
        extent = there.transformBoundingBox(QgsRectangle(*rectangle(UTM, half_m)))
        desk.look_at(map_crs, edges_of(QgsGeometry.fromRect(extent)))
        desk.wait_previewed()
        desk.wait(lambda: not desk.session.preview.busy)
        drawing = desk.session.preview.drawing
        assert drawing.layers["footprints"] or drawing.layers["density"]
    desk.look_at(map_crs, edges_of(QgsGeometry.fromRect(there.transformBoundingBox(QgsRectangle(5e5, 0, 6e5, 1e5)))))
    desk.wait(lambda: not desk.session.preview.busy)
    assert not desk.session.preview.drawing.layers["density"]


@pytest.mark.thorough
def test_preview_goes_from_one_crs_to_another(desk, tmp_path):
    """The layers stay, with the style that the user has given them, and hold what belongs there."""
    noise(tmp_path / "ortho.tif", *UTM)
    desk.look_at("EPSG:32616", rectangle(UTM, 300.0))
    desk.enter_box("35.151", "-89.901", "35.149", "-89.899")
    desk.click(desk.dock.preview)
    desk.wait_planned()
    desk.wait_previewed()
    layer = desk.layer("Planned images")
    identity = layer.id()
    layer.setOpacity(0.5)
    assert layer.crs().authid() == "EPSG:3857"
    for source, crs in ((str(tmp_path / "ortho.tif"), "EPSG:32616"), ("world", "EPSG:3857")):
        set_source(desk, source)
        planned = desk.wait_planned().plan
        desk.wait_previewed()
        count = len(planned)
        desk.wait(lambda count=count: desk.layer("Planned images").featureCount() == count)
        layer = desk.layer("Planned images")
        assert (layer.id(), layer.opacity(), layer.crs().authid()) == (identity, 0.5, crs)
        drawn = layer_edges(layer, crs)
        for name, *edges in zip(planned.names, *planned.edges):
            assert edges_of(drawn[name]) == pytest.approx(edges, abs=1e-9)


@pytest.mark.thorough
def test_styled_layer_is_captured_in_its_style_at_its_own_pixels(desk, tmp_path):
    """One band in grey, stretched: as QGIS shows it, pixel by pixel."""
    values, (west, pixel, _, north, _, _) = noise(tmp_path / "ortho.tif", *POLE)
    layer = QgsProject.instance().addMapLayer(QgsRasterLayer(str(tmp_path / "ortho.tif"), "ortho", "gdal"))
    renderer = QgsSingleBandGrayRenderer(layer.dataProvider(), 2)
    stretch = QgsContrastEnhancement(layer.dataProvider().dataType(2))
    stretch.setContrastEnhancementAlgorithm(QgsContrastEnhancement.ContrastEnhancementAlgorithm.StretchToMinimumMaximum)
    stretch.setMinimumValue(0.0)
    stretch.setMaximumValue(127.5)
    renderer.setContrastEnhancement(stretch)
    layer.setRenderer(renderer)
    set_source(desk, source_name(layer))
    draw(desk, POLE, 120.0)
    capture(desk)
    for path in images(desk):
        file = gdal.Open(str(path))
        left, across, _, top, _, _ = file.GetGeoTransform()
        assert across == pixel
        column, row, shown = round((left - west) / pixel), round((north - top) / pixel), file.ReadAsArray()
        rows, columns = slice(row, row + shown.shape[1]), slice(column, column + shown.shape[2])
        expected = np.minimum(2 * values[1, rows, columns].astype(int), 255)
        assert np.abs(shown.astype(int) - expected).max() <= 1


@pytest.mark.thorough
def test_test_shot_of_a_camera_frame_lies_on_the_map_in_the_raster_s_crs(desk, tmp_path):
    """Laid on the ground by the exact camera: positions of a raster whose colours tell them."""
    for number, (epsg, lat, lon) in enumerate((UTM, POLE)):
        x, y = middle_of((epsg, lat, lon))
        side = 1500
        columns, rows = np.meshgrid(np.arange(side) + 0.5, np.arange(side) + 0.5)
        path = rasters.write(
            tmp_path / f"smooth{number}.tif",
            [rasters.triangle(columns), rasters.triangle(rows), columns * 0],
            (x - side / 4, 0.5, 0.0, y + side / 4, 0.0, -0.5),
            epsg,
        )
        source = open_raster(path)
        mission = Mission(Points(((lat, lon, 120.0),)), 120.0, tilt_deg=30.0, yaw_deg=20.0, source=str(path))
        worked_out = plan(mission, source.grid)
        assert not worked_out.frames.on_map
        folder = tmp_path / f"out{number}"
        run(worked_out, source, folder)
        source.close()
        (picture,) = (folder / "satellite").glob("*.tif")
        lay_on_map(worked_out, picture, tmp_path / f"on-map{number}.tif")
        laid = gdal.Open(str(tmp_path / f"on-map{number}.tif"))
        assert laid.GetSpatialRef().GetAuthorityCode(None) == str(epsg)
        west, across, _, north, _, down = laid.GetGeoTransform()
        shown = laid.ReadAsArray().astype(float)
        at_x, at_y = np.meshgrid(np.arange(shown.shape[2]) + 0.5, np.arange(shown.shape[1]) + 0.5)
        at = (west + at_x * across - (x - side / 4)) / 0.5, (y + side / 4 - north - at_y * down) / 0.5
        opaque = shown[3] == 255
        assert opaque.sum() > 100_000
        for channel in range(2):
            kept = opaque & ~rasters.turns(at[channel], 8.0)
            off = (shown[channel] - rasters.triangle(at[channel]))[kept] / 4.0
            # Twice resampled, each time to half a grey level; at the edge of the picture there is less than a pixel.
            assert np.percentile(np.abs(off), 98) < 0.6


def test_dataset_whose_crs_no_thread_has_read_is_opened_at_its_place(desk, tmp_path):
    """QGIS loses what another thread has read of a CRS: its places would then be coordinates as they were."""
    place = (3413, 88.0, 10.0)
    noise(tmp_path / "ortho.tif", *place)
    source = open_raster(tmp_path / "ortho.tif")
    lon, lat = about(*place, 200.0)
    ring = Polygon((tuple(zip(lon.tolist(), lat.tolist())),))
    run(plan(Mission(ring, 120.0, source=str(tmp_path / "ortho.tif")), source.grid), source, desk.folder)
    source.close()
    for _ in range(2):
        # The first time the mosaic is made, then it is there.
        desk.iface.newProject(False)
        desk.session.missions.open_dataset(desk.folder)
        desk.wait(lambda: "Satellite images" in desk.layer_names())
        desk.wait_for_tasks()
        layer = desk.layer("Satellite images")
        assert layer.crs().authid() == "EPSG:3413"
        there = QgsCoordinateTransform(layer.crs(), QgsCoordinateReferenceSystem("EPSG:4326"), QgsProject.instance())
        middle = there.transform(layer.extent().center())
        assert (middle.x(), middle.y()) == pytest.approx((10.0, 88.0), abs=0.01)


@pytest.mark.parametrize("place", [UTM, POLE])
def test_algorithms_give_layers_in_the_raster_s_crs(plugin, tmp_path, place):
    """Planned and captured by Processing: footprints, captures and flight line lie where the files do."""
    noise(tmp_path / "ortho.tif", *place)
    crs = f"EPSG:{place[0]}"
    lon, lat = about(*place, 150.0)
    mission = Mission(
        Points(tuple((y, x, 120.0) for x, y in zip(lon.tolist()[::2], lat.tolist()[::2]))),
        120.0,
        source=str(tmp_path / "ortho.tif"),
    )
    mission.save(str(tmp_path / "mission.json"))
    wanted = dict.fromkeys(("FOOTPRINTS", "CAPTURES", "FLIGHT"), "TEMPORARY_OUTPUT")
    found = processing.run("terrainav:plan", {"MISSION": str(tmp_path / "mission.json"), **wanted})
    made = processing.run(
        "terrainav:capture", {"MISSION": str(tmp_path / "mission.json"), "FOLDER": str(tmp_path / "out")}
    )
    assert made["WRITTEN"] == len(mission.area.poses)
    for name in wanted:
        assert found[name].crs().authid() == crs
    edges = {path.stem: gdal.Open(str(path)).GetGeoTransform() for path in (tmp_path / "out").glob("satellite/*.tif")}
    for feature in found["FOOTPRINTS"].getFeatures():
        west, _, _, north, _, _ = edges[feature["name"]]
        box = feature.geometry().boundingBox()
        assert (box.xMinimum(), box.yMaximum()) == pytest.approx((west, north), abs=NOISE_M)
        assert feature["gsd_m"] == pytest.approx(0.5, rel=0.04)
    to_crs = pyproj.Transformer.from_crs(4326, place[0], always_xy=True)
    for feature in found["CAPTURES"].getFeatures():
        at = feature.geometry().asPoint()
        assert (at.x(), at.y()) == pytest.approx(to_crs.transform(feature["lon_deg"], feature["lat_deg"]), abs=1e-6)
    (line,) = found["FLIGHT"].getFeatures()
    # Scale of the projection: a few parts in ten thousand in UTM, 3 % at the pole.
    assert line.geometry().length() == pytest.approx(line["length_m"], rel=0.035)
    assert QgsRasterLayer(made["MOSAIC"], "mosaic", "gdal").crs().authid() == crs


@pytest.mark.thorough
def test_area_about_the_pole_is_drawn_without_a_way_to_the_pole(desk, tmp_path):
    """Its outline on the map is the rectangle that was drawn, and the map goes there."""
    noise(tmp_path / "ortho.tif", *POLE)
    set_source(desk, str(tmp_path / "ortho.tif"))
    area = draw(desk, POLE, 200.0).mission.area
    outline = AreaOutline(area, QgsCoordinateReferenceSystem("EPSG:3031"), QgsProject.instance(), 0.0).shape
    assert outline.isGeosValid()
    assert outline.area() == pytest.approx(160_000.0, rel=0.03)
    assert outline.length() < 1_700.0
    desk.look_at("EPSG:3031", (1e6, 1e6, 1.1e6, 1.1e6))
    desk.zoom_to_box(area.bounds)
    assert desk.canvas.extent().contains(QgsRectangle(*rectangle(POLE, 150.0)))
    assert desk.canvas.extent().width() < 3_000.0
    # Degrees would make another area of it; what is in the panel and in files is the one that was drawn.
    assert moved(area, 0.01, 30.0) == area
    assert desk.session.planned.mission == Mission.from_json(desk.session.planned.mission.to_json())


@pytest.mark.thorough
def test_captured_images_about_the_pole_are_drawn_as_rectangles(desk, tmp_path):
    """Their file cuts them at ±180°; on the map no line goes there, from the pole or through an image."""
    noise(tmp_path / "ortho.tif", *POLE)
    set_source(desk, str(tmp_path / "ortho.tif"))
    draw(desk, POLE, 200.0)
    capture(desk)
    edges = np.array(list(captured_edges(desk)[0].values()))
    crs = QgsCoordinateReferenceSystem("EPSG:3031")
    layer = desk.layer("Captured images")
    layer.setLabelsEnabled(False)
    shown = drawn(desk, layer, QgsRectangle(*rectangle(POLE, 250.0)), 1000, 1000, crs)
    rows, columns = np.nonzero((shown < 255).any(axis=2))
    assert len(rows) > 1000
    x, y = (columns + 0.5) * 0.5 - 250.0, 250.0 - (rows + 0.5) * 0.5
    on_edge = np.zeros(len(x), bool)
    for west, south, east, north in edges:
        away_x = np.minimum(np.abs(x - west), np.abs(x - east))
        away_y = np.minimum(np.abs(y - south), np.abs(y - north))
        across, along = (x > west - 3) & (x < east + 3), (y > south - 3) & (y < north + 3)
        on_edge |= (across & (away_y < 3.0)) | (along & (away_x < 3.0))
    assert on_edge.all()


def test_figures_say_what_the_pixels_are(desk, tmp_path):
    noise(tmp_path / "ortho.tif", *UTM)
    set_source(desk, str(tmp_path / "ortho.tif"))
    draw(desk, UTM, 200.0)
    details = html.unescape(desk.dock.figures.details.text())
    assert "px: the source's own pixels, 50 cm in EPSG:32616" in details
    assert "zoom" not in details
    desk.form.agl.setValue(400.0)
    desk.wait_planned()
    assert "px: means of 2 x 2 of the source's own pixels" in html.unescape(desk.dock.figures.details.text())
    set_source(desk, "world")
    desk.wait_planned()
    assert "px at zoom" in desk.dock.figures.details.text()


def test_zoom_is_one_of_the_source_s_own(desk, tmp_path):
    """What its zooms are stands below the entry, and choosing by zoom starts with one that it has."""
    noise(tmp_path / "ortho.tif", *POLE)
    set_source(desk, str(tmp_path / "ortho.tif"))
    planned = draw(desk, POLE, 200.0).plan
    native, pixels = planned.grid.native_zoom, desk.form.pixels
    assert native < desk.session.state().zoom
    desk.show(pixels)
    pixels.unfold()
    note = pixels.findChild(QLabel, "zooms")
    assert not note.isVisibleTo(pixels)
    by_hand = pixels.findChild(QComboBox, "resolution")
    desk.choose(by_hand, "zoom")
    by_hand.activated.emit(by_hand.currentIndex())
    chosen = desk.wait_planned()
    assert chosen.mission.pixels.zoom == chosen.plan.zoom == planned.zoom
    assert note.isVisibleTo(pixels)
    # The projection shows 0.5 m of its plane as 2.8 % more of the ground at the pole.
    assert note.text().startswith(f"Zoom {native} is the source's native resolution, with a GSD of 51.4 cm.")
    # A zoom that it has stays.
    desk.form.set_state(replace(desk.session.state(), zoom=native - 1, resolution="auto"))
    desk.wait_planned()
    desk.choose(by_hand, "zoom")
    by_hand.activated.emit(by_hand.currentIndex())
    assert desk.wait_planned().plan.zoom == native - 1


@pytest.mark.parametrize("place", [UTM, POLE])
def test_layer_far_away_is_the_mean_of_its_pixels(tmp_path, place):
    """As the file itself is; pixels that reach beyond the raster are missing."""
    values, _ = noise(tmp_path / "ortho.tif", *place)
    layer = QgsProject.instance().addMapLayer(QgsRasterLayer(str(tmp_path / "ortho.tif"), "ortho", "gdal"))
    source = LayerSource(take_snapshot(source_name(layer), QgsProject.instance()))
    of_file = open_raster(tmp_path / "ortho.tif")
    assert source.grid == of_file.grid
    native = source.grid.native_zoom
    for zoom, factor in ((native, 1), (native - 1, 2), (native - 2, 4)):
        shown = source.fetch("satellite", Window(zoom, 256, 256, 100, 80))
        kept = values[:, 256 * factor : (256 + 80) * factor, 256 * factor : (256 + 100) * factor]
        if factor < 4:
            mean = kept.reshape(3, 80, factor, 100, factor).mean(axis=(2, 4))
            assert np.abs(shown - np.moveaxis(mean, 0, -1)).max() <= 0.5
        expected = of_file.fetch("satellite", Window(zoom, 256, 256, 100, 80)).astype(int)
        assert expected.shape == shown.shape
        assert np.abs(shown.astype(int) - expected).max() <= 1
    of_file.close()
    source.close()


def test_algorithms_take_areas_about_the_pole(plugin, tmp_path):
    """An extent and a polygon of the polar CRS: as large as they are, and covered."""
    noise(tmp_path / "ortho.tif", *POLE)
    layer = QgsVectorLayer("Polygon?crs=EPSG:3031", "about the pole", "memory")
    feature = QgsFeature()
    feature.setGeometry(QgsGeometry.fromWkt("Polygon ((-150 -150, 180 -120, 0 190, -150 -150))"))
    layer.dataProvider().addFeatures([feature])
    for area, m2 in (({"EXTENT": "-200,200,-200,200 [EPSG:3031]"}, 160_000.0), ({"AREA": layer}, None)):
        made = processing.run(
            "terrainav:plan",
            {
                **area,
                "OTHER_SOURCE": str(tmp_path / "ortho.tif"),
                "MISSION_FILE": str(tmp_path / "mission.json"),
                "FOOTPRINTS": "TEMPORARY_OUTPUT",
            },
        )
        wanted = feature.geometry().area() if m2 is None else m2
        asked = Mission.load(str(tmp_path / "mission.json")).area
        assert isinstance(asked, Polygon)
        # Ground is up to 6 % larger than the map there, which is true to scale at 71 degrees.
        assert asked.area_m2() == pytest.approx(wanted / 0.9727**2, rel=1e-3)
        assert made["COVERAGE"] == 100.0
        drawn = QgsGeometry.unaryUnion([one.geometry() for one in made["FOOTPRINTS"].getFeatures()])
        shape = feature.geometry() if m2 is None else QgsGeometry.fromRect(QgsRectangle(-200, -200, 200, 200))
        assert drawn.buffer(0.2, 1).contains(shape)


def test_viewer_finds_and_outlines_the_image_that_holds_the_pole(desk, tmp_path):
    """Its outline on the polar map is the edges of the picture alone, and a click at the very pole finds it."""
    noise(tmp_path / "ortho.tif", *POLE)
    set_source(desk, str(tmp_path / "ortho.tif"))
    planned = draw(desk, POLE, 30.0).plan
    capture(desk)
    (held,) = (name for name, pole in zip(planned.names, planned.views.poles) if pole)
    footprints = desk.layer("Captured images")
    (feature,) = (feature for feature in footprints.getFeatures() if feature["name"] == held)
    assert len(feature.geometry().asGeometryCollection()) == 1
    there = QgsCoordinateTransform(footprints.crs(), QgsCoordinateReferenceSystem("EPSG:3031"), QgsProject.instance())
    edges = seen_edges(feature.geometry())
    assert edges.transform(there) == 0
    west, south, east, north = (float(edge[planned.names.index(held)]) for edge in planned.edges)
    assert edges.length() == pytest.approx(2.0 * (east - west + north - south), rel=0.02)
    assert min(west**2, south**2, east**2, north**2) > 100.0

    shots = Finder(lambda: False).find_shots([FootprintLayer.read(footprints)], -90.0, 12.0)
    assert held in {shot.name for shot in shots}
