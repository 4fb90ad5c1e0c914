"""The first step in an empty project: a map to plan on."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import QgsCoordinateReferenceSystem, QgsProject, QgsVectorLayer
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtTest import QTest
from terrainav.core.errors import InvalidInput
from terrainav.core.imagery.opening import open_source
from terrainav.core.imagery.source import Window
from terrainav.core.mission.areas.area import Box
from terrainav.terrainav_plugin.preview import background
from terrainav.terrainav_plugin.preview.background import choose_picture, render
from terrainav.terrainav_plugin.sources import tile_layer_uri

from tests.support.thinning import sampled
from tests.support.tileserver import TileServer

# JPEG at quality 90 of a picture with sharp edges, in grey levels of the mean.
JPEG_MEAN_ERROR = 4.0


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    """Drawing is what takes time; what is drawn where is the same at any size."""

    monkeypatch.setattr(background, "_MOST_PX", 6 * 256**2)


def show(desk):
    desk.click(desk.form.show_on_map)
    desk.wait_for_tasks()
    desk.wait(lambda: bool(QgsProject.instance().mapLayers()))
    return next(iter(QgsProject.instance().mapLayers().values()))


def fits(extent, box):
    """Whether a map shows a box as large as it can, however wide and high the map is."""
    return extent.contains(box) and (extent.height() < 2 * box.height() or extent.width() < 2 * box.width())


def test_embedded_world_comes_by_its_name_and_the_map_goes_there(desk):
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    layer = show(desk)
    assert layer.name() == "Synthetic (offline)"
    assert layer.isValid()
    project = QgsProject.instance()
    # QGIS gives an empty project the CRS of its first layer.
    desk.wait(lambda: project.crs().authid() == "EPSG:3857")
    assert project.layerTreeRoot().children()[-1].layer() is layer
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: fits(desk.canvas.extent(), box))
    assert layer.extent().contains(box)


def follow_hint(desk):
    """Click the link in the hint."""
    label = desk.dock.hint
    QTest.qWait(50)
    for x in range(4, label.width(), 6):
        for y in range(6, label.height(), 6):
            QTest.mouseMove(label, QPoint(x, y))
            QTest.qWait(1)
            if label.cursor().shape() == Qt.CursorShape.PointingHandCursor:
                QTest.mouseClick(label, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(x, y))
                return
    pytest.fail("the hint has no link under the mouse")


def test_link_of_the_hint_leads_to_a_first_place_and_to_drawing(desk):
    follow_hint(desk)
    desk.wait_for_tasks()
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: fits(desk.canvas.extent(), box))
    assert desk.canvas.mapTool() is desk.session.box_tool
    desk.drag(desk.at(0.4, 0.4), desk.at(0.6, 0.6))
    assert desk.session.state().has_box


@pytest.mark.parametrize("way", sampled(["draw_box", "draw_polygon", "toolbar", "draw", "single"], 3))
@pytest.mark.parametrize("crs", sampled(["EPSG:4326", "EPSG:3857"], 2))
def test_drawing_on_an_empty_map_begins_with_the_imagery(desk, crs, way, screenshot):
    # Where QGIS leaves an empty map of a project in degrees that was in metres before.
    desk.look_at(crs, (-2e7, -2e7, 2e7, 2e7))
    before = desk.canvas.mapTool()
    if way == "toolbar":
        desk.plugin.actions["draw_box"].trigger()
        assert not desk.plugin.actions["draw_box"].isChecked()
    elif way in ("draw", "single"):
        desk.form.area.area_from.actions_by_name[way].trigger()
    else:
        desk.click(getattr(desk.form.area, way))
    desk.wait(lambda: desk.canvas.mapTool() is not before)
    desk.wait_for_tasks()
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: fits(desk.canvas.extent(), box))
    screenshot(f"empty-map-{way}")
    if way == "draw_polygon":
        assert desk.canvas.mapTool() is desk.session.areas.polygon_tool
    elif way == "single":
        desk.click_map(desk.at(0.5, 0.5))
    else:
        desk.drag(desk.at(0.4, 0.4), desk.at(0.6, 0.6))
    assert desk.session.state().has_box or way == "draw_polygon"
    assert desk.messages() == []


def test_drawing_begins_also_where_the_imagery_cannot_be_shown(desk, monkeypatch):
    def fail(*_):
        raise InvalidInput("no such imagery")

    monkeypatch.setattr(desk.session.background, "world_task", fail)
    desk.click(desk.form.draw_box)
    assert desk.canvas.mapTool() is desk.session.box_tool
    assert any("o such imagery" in text for text in desk.messages())


def test_map_goes_there_though_it_still_has_layers_of_another_project(desk, iface):
    """QGIS takes CRS and place of a project's first layer when that comes to the map, whatever the map had before."""
    stale = QgsVectorLayer("Point?crs=EPSG:4326", "of the project before", "memory")
    desk.canvas.setLayers([stale])
    world = Box(60.0, -100.0, -60.0, 100.0)
    picture = choose_picture(world, "satellite", 2024)
    far = desk.session.background.show_picture(picture, write_world(desk, world), "far")
    desk.session.background.zoom_to_box(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: far in desk.canvas.layers())
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: fits(desk.canvas.extent(), box))


def test_zoom_does_not_wait_for_a_layer_that_is_hidden_or_gone(desk):
    background, project = desk.session.background, QgsProject.instance()
    place = Box(35.16, -89.90, 35.115, -89.823)
    picture = choose_picture(place, "satellite", 2024)
    background.show_picture(picture, write_world(desk, place), "world")
    background.zoom_to_box(place)
    layer = next(iter(project.mapLayers().values()))
    project.layerTreeRoot().findLayer(layer).setItemVisibilityChecked(False)
    desk.wait(lambda: fits(desk.canvas.extent(), background.rectangle(place)))
    project.layerTreeRoot().findLayer(layer).setItemVisibilityChecked(True)
    background.zoom_to_box(Box(36.0, -90.0, 35.0, -89.0))
    project.removeAllMapLayers()
    desk.wait(lambda: fits(desk.canvas.extent(), background.rectangle(Box(36.0, -90.0, 35.0, -89.0))))


def write_world(desk, box):
    """Draw the embedded world around a box; returns the folder."""
    folder = Path(desk.session.settings.backgrounds_folder)
    picture = choose_picture(box, "satellite", 2024)
    render(picture, folder / picture.file_name, lambda _share: True)
    return folder


def test_link_of_the_hint_draws_no_box_where_there_is_one(desk):
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    follow_hint(desk)
    desk.wait_for_tasks()
    desk.wait(lambda: bool(QgsProject.instance().mapLayers()))
    assert desk.canvas.mapTool() is not desk.session.box_tool


def test_link_of_the_hint_draws_on_a_map_of_one_s_own(desk):
    QgsProject.instance().addMapLayer(QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory"))
    follow_hint(desk)
    assert desk.canvas.mapTool() is desk.session.box_tool


def test_map_that_shows_a_place_stays_there(desk):
    layer = QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory")
    QgsProject.instance().addMapLayer(layer)
    desk.look_at("EPSG:3857", (1.2e6, 6.0e6, 1.21e6, 6.01e6))
    before = desk.canvas.extent()
    desk.click(desk.form.show_on_map)
    desk.wait_for_tasks()
    desk.wait(lambda: len(QgsProject.instance().mapLayers()) == 2)
    assert desk.canvas.extent() == before
    (world,) = [one for one in QgsProject.instance().mapLayers().values() if one is not layer]
    there = desk.canvas.mapSettings().layerExtentToOutputExtent(world, world.extent())
    assert there.contains(before)


def test_background_shows_the_world_where_it_is(desk):
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    layer = show(desk)
    file = gdal.Open(layer.source())
    west, resolution, _, north, _, _ = file.GetGeoTransform()
    source = open_source("world")
    zoom = next(z for z in range(23) if source.grid.pixel_size(z)[0] == pytest.approx(resolution, rel=1e-9))
    half_world = 20_037_508.342789244
    left, top = round((west + half_world) / resolution), round((half_world - north) / resolution)
    assert (left % 256, top % 256) == (0, 0)
    tile = source.fetch("satellite", Window(zoom, left, top, 256, 256))
    got = np.moveaxis(file.ReadAsArray(0, 0, 256, 256), 0, -1)
    assert np.abs(got.astype(float) - tile).mean() < JPEG_MEAN_ERROR


def test_second_time_moves_the_one_layer(desk):
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    first = show(desk).source()
    desk.enter_box("10.16", "20.00", "10.115", "20.1")
    desk.click(desk.form.show_on_map)
    desk.wait_for_tasks()
    desk.wait(lambda: next(iter(QgsProject.instance().mapLayers().values())).source() != first)
    assert len(QgsProject.instance().mapLayers()) == 1


def test_without_an_area_it_is_a_place_where_an_area_can_be_drawn(desk):
    layer = show(desk)
    assert 5e3 < layer.extent().width() < 1e5


def test_crs_of_a_project_in_use_stays(desk, clean_project):
    clean_project.addMapLayer(QgsVectorLayer("Point?crs=EPSG:32616", "mine", "memory"))
    clean_project.setCrs(QgsCoordinateReferenceSystem("EPSG:32616"))
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    desk.click(desk.form.show_on_map)
    desk.wait_for_tasks()
    desk.wait(lambda: len(clean_project.mapLayers()) == 2)
    assert clean_project.crs().authid() == "EPSG:32616"
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: desk.canvas.extent().contains(box))


def test_tiles_by_template_are_drawn(desk, wait_until_drawn):
    with TileServer() as server:
        desk.enter_small_mission()
        desk.use_template(server.url_template)
        layer = show(desk)
        assert layer.name() == "URL template"
        assert layer.isValid()
        desk.wait(lambda: bool(server.requests))
        wait_until_drawn()


def test_keyed_source_is_not_written_into_the_project(desk):
    desk.use_template("https://example.org/{z}/{x}/{y}.png?key={key}")
    desk.click(desk.form.show_on_map)
    assert any("needs a key" in text for text in desk.messages())
    assert not QgsProject.instance().mapLayers()


def test_source_without_tiles_says_so(desk):
    desk.choose(desk.form.source, "google-static")
    desk.click(desk.form.show_on_map)
    assert any("no tiles to show" in text for text in desk.messages())


@pytest.mark.parametrize(
    ("template", "expected"),
    [
        ("https://h.org/{z}/{x}/{-y}.png", "https://h.org/{z}/{x}/{-y}.png"),
        ("https://{s}.h.org/{z}/{x}/{y}{r}.png", "https://a.h.org/{z}/{x}/{y}.png"),
        ("https://h.org/{map_type}/{q}.jpg?a=1&b=2", "https://h.org/terrain/{q}.jpg?a=1%26b=2"),
    ],
)
def test_templates_in_the_spelling_of_qgis(template, expected):
    assert f"url={expected}&zmin=0&zmax=22" in tile_layer_uri(template, "terrain")


def test_unknown_source_is_refused():
    with pytest.raises(InvalidInput, match="is unknown"):
        tile_layer_uri("nowhere", "satellite")


@pytest.mark.parametrize(
    "box",
    [
        None,
        Box(35.16, -89.90, 35.115, -89.823),
        Box(0.0, 0.0, 0.0, 0.0),
        Box(1.0, 179.5, -1.0, -179.0),
        Box(90.0, -180.0, -90.0, 180.0),
        Box(85.0, 10.0, 84.9999, 10.0001),
    ],
)
def test_picture_holds_the_box_and_stays_small(box):
    picture = choose_picture(box, "satellite", 2024)
    count = 1 << picture.zoom
    assert 0 < picture.columns * picture.rows <= 6
    assert 0 <= picture.left <= picture.left + picture.columns <= count
    assert 0 <= picture.top <= picture.top + picture.rows <= count
    if box is not None and box.west_deg <= box.east_deg:
        west, east = ((lon / 360.0 + 0.5) * count for lon in (box.west_deg, box.east_deg))
        assert picture.left <= west
        assert east <= picture.left + picture.columns


def test_coarse_image_is_there_while_the_fine_one_is_drawn(desk, monkeypatch):
    """Its places and colours are those of the fine one, as far as its pixels go."""
    monkeypatch.setattr(background, "_MOST_PX", 40 * 256**2)
    gate, drawn = threading.Event(), []
    whole = background.render

    def render_slowly(picture, path, progress):
        if drawn:
            assert gate.wait(60.0)
        drawn.append(picture)
        whole(picture, path, progress)

    monkeypatch.setattr(background, "render", render_slowly)
    desk.enter_box("35.16", "-89.90", "35.115", "-89.823")
    desk.click(desk.form.show_on_map)
    desk.wait(lambda: bool(QgsProject.instance().mapLayers()))
    (layer,) = QgsProject.instance().mapLayers().values()
    coarse, fine_was_there = layer.source(), len(drawn) > 1
    assert layer.isValid()
    assert not fine_was_there
    # The project takes the layer's CRS a while after the layer is there.
    desk.wait(lambda: QgsProject.instance().crs() == layer.crs())
    box = desk.session.background.rectangle(Box(35.16, -89.90, 35.115, -89.823))
    desk.wait(lambda: fits(desk.canvas.extent(), box))
    assert layer.extent().contains(box)
    first = gdal.Open(coarse)
    coarse_colours = first.ReadAsArray().astype(float)
    place, size = first.GetGeoTransform(), (first.RasterXSize, first.RasterYSize)
    del first
    # What the user does meanwhile stays.
    desk.canvas.zoomByFactor(0.5)
    kept = desk.canvas.extent()
    gate.set()
    desk.wait_for_tasks()
    assert [one.id() for one in QgsProject.instance().mapLayers().values()] == [layer.id()]
    assert layer.source() != coarse
    assert not Path(coarse).exists()
    assert desk.canvas.extent() == kept
    # The tiles of the place at a lower zoom, within what JPEG makes of them.
    picture, source = drawn[0], open_source("world")
    assert size == (picture.columns * 256, picture.rows * 256)
    tile = source.fetch("satellite", Window(picture.zoom, picture.left * 256, picture.top * 256, 256, 256))
    shown = np.moveaxis(coarse_colours[:, :256, :256], 0, -1)
    assert np.abs(shown - tile).mean() < JPEG_MEAN_ERROR
    edges = source.grid.edges(picture.left * 256, picture.top * 256, 0, 0, picture.zoom)
    assert (place[0], place[3]) == pytest.approx((edges[0], edges[3]), abs=1e-6)


def test_coarse_image_is_small_and_holds_the_fine_one():
    for box in (Box(35.16, -89.90, 35.115, -89.823), Box(1.0, 179.9, -1.0, -179.9), None):
        picture = choose_picture(box, "satellite", 2024)
        coarse = background.coarser(picture)
        times = 2 ** (picture.zoom - coarse.zoom)
        assert coarse.left * times <= picture.left
        assert coarse.top * times <= picture.top
        assert (coarse.left + coarse.columns) * times >= picture.left + picture.columns
        assert (coarse.top + coarse.rows) * times >= picture.top + picture.rows
        # No tile that is not needed.
        assert coarse.columns <= -(-picture.columns // times) + 1
        assert coarse.rows <= -(-picture.rows // times) + 1
