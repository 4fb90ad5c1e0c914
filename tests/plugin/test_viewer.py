"""Clicks on captured footprints show their images: every format, several images in one place, what is missing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from osgeo import gdal
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsPointXY,
    QgsProject,
)
from qgis.PyQt.QtCore import QPoint, Qt
from qgis.PyQt.QtGui import QDesktopServices, QImage
from qgis.PyQt.QtTest import QTest
from terrainav.terrainav_plugin.units import METRES, gsd_text

from tests.support.thinning import sampled
from tests.support.tileserver import TileServer


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


@pytest.fixture
def viewing(desk):
    """The plugin's part that shows images; its window is closed at the end."""
    yield desk.session.viewing
    desk.session.viewing.stop()
    if desk.session.viewing.viewer is not None:
        desk.session.viewing.viewer.hide()


@pytest.fixture
def captured(desk, server, viewing):
    """Capture a mission, changed by the caller, and look at it with the tool for viewing."""

    def capture(change=lambda: None):
        desk.enter_coarse_mission()
        desk.use_template(server.url_template)
        change()
        planned = desk.wait_planned()
        seen = []
        desk.session.runs.running.connect(seen.append)
        desk.click(desk.dock.capture)
        desk.wait(lambda: seen[-1:] == [False])
        desk.session.runs.running.disconnect(seen.append)
        desk.look_at("EPSG:3857", (0, 0, 1, 1))
        desk.zoom_to_box(planned.mission.area.bounds)
        desk.plugin.actions["view_images"].trigger()
        return planned.plan

    return capture


def pixel_of(desk, lat_deg, lon_deg) -> QPoint:
    """Pixel of the canvas at a place."""
    to_map = QgsCoordinateTransform(
        QgsCoordinateReferenceSystem("EPSG:4326"),
        desk.canvas.mapSettings().destinationCrs(),
        QgsProject.instance(),
    )
    at = desk.canvas.getCoordinateTransform().transform(to_map.transform(QgsPointXY(lon_deg, lat_deg)))
    return QPoint(round(at.x()), round(at.y()))


def look_at(desk, plan, index):
    """Click the middle of a footprint and wait for its image."""
    desk.session.viewing.seen = None
    desk.click_map(pixel_of(desk, plan.lat_deg[index], plan.lon_deg[index]))
    desk.wait(lambda: desk.session.viewing.seen is not None and not desk.session.viewing.busy)
    return desk.session.viewing.seen


def pixels(image: QImage):
    """Pixels of an image, (h, w, 4)."""
    image = image.convertToFormat(QImage.Format.Format_RGBA8888)
    lines = np.frombuffer(image.constBits().asstring(image.sizeInBytes()), np.uint8)
    return lines.reshape(image.height(), image.bytesPerLine() // 4, 4)[:, : image.width()]


@pytest.mark.parametrize("image_format", sampled(["tif", "png", "jpg"], 3))
def test_click_shows_the_image_and_what_is_known_of_it(desk, captured, viewing, image_format, screenshot):
    plan = captured(lambda: desk.choose(desk.form.image_format, image_format))
    index = len(plan) // 2
    seen = look_at(desk, plan, index)
    assert seen.shot.name == plan.names[index]
    path = desk.folder / "satellite" / f"{plan.names[index]}.{image_format}"
    assert seen.picture.path == path
    file = np.moveaxis(gdal.Open(str(path)).ReadAsArray(), 0, -1)
    assert np.array_equal(pixels(viewing.viewer.view.image)[..., :3], file[..., :3])
    text = viewing.viewer.details.text()
    for told in (
        f"{plan.lat_deg[index]:.7f}",
        "120.00 m above ground",
        "Entropy",
        " bits",
        "<b>GSD</b>",
        " cm",
        "127.0.0.1",
        plan.names[index],
    ):
        assert told in text, told
    screenshot(f"viewer-{image_format}")
    # No file is kept open: it can be replaced and removed.
    path.unlink()
    look_at(desk, plan, index)
    assert viewing.seen.picture.image is None
    assert "Missing" in viewing.viewer.details.text()


@pytest.mark.parametrize("tilt_deg", sampled([0.0, 20.0], 2))
def test_the_gsd_is_that_of_the_panel_and_says_where_the_source_is_coarser(desk, captured, viewing, tilt_deg):
    def upsample():
        box = {"north": "35.1310", "west": "-89.8700", "south": "35.1309", "east": "-89.8699"}
        more = {"resolution": "auto", "upsample": True, "agl": 7.0, "tilt_deg": tilt_deg}
        if not tilt_deg:
            # Of map frames only resizing makes finer pixels than the finest zoom.
            more.update(resize=True, resize_width_px=1280, resize_height_px=960)
        desk.form.set_state(replace(desk.session.state(), **box, **more))

    plan = captured(upsample)
    delivered, source = plan.resolution.delivered_m_per_px, plan.resolution.source_m_per_px
    assert source > 1.5 * delivered
    look_at(desk, plan, 0)
    text = viewing.viewer.details.text()
    assert f"{gsd_text(delivered, METRES)} (" in text
    assert f"the source's GSD is {gsd_text(source, METRES)}" in text.replace("&#x27;", "'")


def test_next_and_previous_follow_the_flight(desk, captured, viewing):
    plan = captured()
    look_at(desk, plan, 0)
    viewer = viewing.viewer
    assert not viewer.previous.isEnabled()
    for expected in (1, 2):
        QTest.mouseClick(viewer.following, Qt.MouseButton.LeftButton)
        desk.wait(lambda expected=expected: viewing.seen.shot.name == plan.names[expected])
    desk.wait(lambda: not viewing.busy)
    QTest.mouseClick(viewer.previous, Qt.MouseButton.LeftButton)
    desk.wait(lambda: viewing.seen.shot.name == plan.names[1])
    assert viewer.place.text() == f"2 of {len(plan)}"
    # Outlined on the map, whatever its CRS.
    to_degrees = QgsCoordinateTransform(
        desk.canvas.mapSettings().destinationCrs(),
        QgsCoordinateReferenceSystem("EPSG:4326"),
        QgsProject.instance(),
    )
    outline = to_degrees.transformBoundingBox(viewing._band.asGeometry().boundingBox())
    lat, lon = plan.corners.lat_deg[1], plan.corners.lon_deg[1]
    assert (outline.xMinimum(), outline.yMaximum()) == pytest.approx((lon.min(), lat.max()), abs=1e-5)
    assert (outline.xMaximum(), outline.yMinimum()) == pytest.approx((lon.max(), lat.min()), abs=1e-5)


@pytest.mark.thorough
def test_several_images_under_one_click_are_listed(desk, captured, viewing):
    def overlap():
        desk.enter_box("35.14", "-89.87", "35.137", "-89.865")
        desk.form.overlap_along.setValue(60)
        desk.form.overlap_across.setValue(60)

    plan = captured(overlap)
    index = len(plan) // 2 + 3
    look_at(desk, plan, index)
    choices = viewing.viewer.under_click
    assert choices.isVisibleTo(viewing.viewer)
    assert choices.count() >= 4
    names = [choices.itemText(number).rpartition(" ")[2] for number in range(choices.count())]
    assert plan.names[index] in names
    wanted = choices.count() - 1
    choices.setCurrentIndex(wanted)
    choices.activated.emit(wanted)
    desk.wait(lambda: viewing.seen.shot.name == names[wanted])


@pytest.mark.thorough
def test_camera_frames_show_what_has_no_ground_as_transparent(desk, captured, viewing, screenshot):
    def tilt():
        desk.enter_box("35.14", "-89.87", "35.1395", "-89.8695")
        desk.form.set_state(replace(desk.session.state(), tilt_deg=75.0, yaw_deg=30.0))

    plan = captured(tilt)
    assert not plan.frames.on_map
    desk.zoom_to_box(plan.mission.area.bounds)
    # Not below the camera: a tilted one does not see that.
    footprint = next(desk.layer("Captured images").getFeatures()).geometry().pointOnSurface().asPoint()
    desk.canvas.setExtent(
        desk.canvas.mapSettings().layerExtentToOutputExtent(
            desk.layer("Captured images"), desk.layer("Captured images").extent()
        )
    )
    desk.canvas.waitWhileRendering()
    viewing.seen = None
    desk.click_map(pixel_of(desk, footprint.y(), footprint.x()))
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    file = np.moveaxis(gdal.Open(str(viewing.seen.picture.path)).ReadAsArray(), 0, -1)
    assert file.shape[2] == 4
    assert (file[..., 3] == 0).any()
    assert np.array_equal(pixels(viewing.viewer.view.image)[..., 3], file[..., 3])
    screenshot("viewer-camera")


def test_failed_image_says_why(desk, captured, viewing, server):
    failed = []

    def fail_first():
        plan = desk.wait_planned().plan
        x, y = int(plan.windows.left_px[0]) // 256, int(plan.windows.top_px[0]) // 256
        server.fail("404", (plan.zoom, x, y))
        failed.append(plan.names[0])

    plan = captured(fail_first)
    seen = look_at(desk, plan, 0)
    assert [seen.shot.name] == failed
    assert viewing.viewer.view.image is None
    assert "404" in viewing.viewer.details.text()


def test_rejected_image_is_found_and_said_to_be(desk, captured, viewing):
    plan = captured()
    folder = desk.folder / "satellite"
    (folder / "rejected").mkdir()
    name = f"{plan.names[0]}.tif"
    (folder / name).rename(folder / "rejected" / name)
    seen = look_at(desk, plan, 0)
    assert seen.rejected
    assert viewing.viewer.view.image is not None
    assert "cleaning" in viewing.viewer.details.text()


def test_without_captured_images_it_says_so(desk, viewing):
    action = desk.plugin.actions["view_images"]
    before = desk.canvas.mapTool()
    action.trigger()
    assert any("no captured images on the map yet" in text for text in desk.messages())
    assert not action.isChecked()
    assert desk.canvas.mapTool() is before


def test_click_beside_all_footprints_and_removed_layers(desk, captured, viewing):
    plan = captured()
    first = look_at(desk, plan, 0)
    desk.click_map(desk.at(0.01, 0.01))
    desk.wait(lambda: any("No image shows this place" in text for text in desk.messages()))
    # The image stays, and so do the ways from it to others.
    assert viewing.seen is first
    assert viewing.viewer.view.image is not None
    outline = viewing._band.asGeometry().boundingBox()
    desk.click(viewing.viewer.following)
    desk.wait(lambda: viewing.seen is not first and not viewing.busy)
    assert viewing.seen.shot.name == plan.names[1]
    assert viewing._band.asGeometry().boundingBox() != outline
    look_at(desk, plan, 1)
    desk.iface.newProject(False)
    assert viewing.seen is None
    assert viewing._band is None


def test_large_images_are_read_no_larger_than_they_are_shown(tmp_path):
    from terrainav.terrainav_plugin.dataset.picture import read_picture

    path = tmp_path / "large.tif"
    raster = gdal.GetDriverByName("GTiff").Create(str(path), 4000, 2000, 1)
    raster.GetRasterBand(1).Fill(77)
    del raster
    picture = read_picture(path, 1000)
    assert (picture.image.width(), picture.image.height()) == (1000, 500)
    assert (picture.width_px, picture.height_px) == (4000, 2000)
    assert (pixels(picture.image)[..., :3] == 77).all()


def test_broken_image_is_one_line(tmp_path):
    from terrainav.terrainav_plugin.dataset.picture import read_picture

    path = tmp_path / "broken.tif"
    path.write_bytes(b"no image")
    picture = read_picture(path, 1000)
    assert picture.image is None
    assert "cannot be read" in picture.problem


def test_open_hands_the_file_to_the_system(desk, captured, viewing, monkeypatch):
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", opened.append)
    plan = captured()
    look_at(desk, plan, 2)
    QTest.mouseClick(viewing.viewer.open, Qt.MouseButton.LeftButton)
    assert [url.toLocalFile() for url in opened] == [str(viewing.seen.picture.path)]


def test_the_window_opens_beside_the_map_on_the_first_image(desk, captured, viewing, screenshot):
    plan = captured()
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    assert viewing.seen.shot.name == plan.names[0]
    viewer = viewing.viewer
    assert not viewer.isFloating()
    assert viewer.isVisible()
    on_screen = viewer.rect().translated(viewer.mapToGlobal(QPoint(0, 0)))
    canvas = desk.canvas.rect().translated(desk.canvas.mapToGlobal(QPoint(0, 0)))
    assert not on_screen.intersects(canvas)
    screenshot("viewer-docked")


def test_the_tool_ends_with_the_window(desk, captured, viewing):
    captured()
    desk.wait(lambda: not viewing.busy)
    assert viewing.tool.isActive()
    viewing.viewer.close()
    desk.wait(lambda: not viewing.tool.isActive())
    assert not desk.plugin.actions["view_images"].isChecked()
    desk.plugin.actions["view_images"].trigger()
    assert viewing.viewer.isVisible()
    assert viewing.tool.isActive()


@pytest.mark.parametrize(("tilt_deg", "yaw_deg"), sampled([(0.0, 0.0), (0.0, 270.0), (40.0, 20.0)], 3))
def test_an_image_is_shown_on_the_map_and_removed_again(desk, captured, viewing, screenshot, tilt_deg, yaw_deg):
    def tilt():
        desk.enter_box("35.14", "-89.87", "35.138", "-89.867")
        desk.form.set_state(replace(desk.session.state(), tilt_deg=tilt_deg, yaw_deg=yaw_deg))

    plan = captured(tilt)
    index = len(plan) // 2
    seen = look_at(desk, plan, index)
    viewer = viewing.viewer
    name = seen.shot.name

    def on_map():
        return [layer for layer in QgsProject.instance().mapLayers().values() if layer.name() == name]

    desk.click(viewer.on_map)
    desk.wait(lambda: not viewing.busy and len(on_map()) == 1)
    (layer,) = on_map()
    # Above all groups, and seen.
    top = QgsProject.instance().layerTreeRoot().children()[0]
    assert top.layerId() == layer.id()
    assert top.isVisible()
    assert layer.isValid()
    assert layer.crs().authid() == "EPSG:3857"
    assert viewer.on_map.isChecked()

    def footprint_in(crs):
        transform = QgsCoordinateTransform(QgsCoordinateReferenceSystem("EPSG:4326"), crs, QgsProject.instance())
        return transform.transformBoundingBox(seen.shot.outline.boundingBox())

    at = footprint_in(layer.crs())
    # As far as the footprint reaches.
    assert layer.extent().width() == pytest.approx(at.width(), rel=0.02)
    assert layer.extent().height() == pytest.approx(at.height(), rel=0.02)
    assert layer.extent().center().distance(at.center()) < 0.02 * at.width()
    # The map has gone there.
    assert desk.canvas.extent().contains(footprint_in(desk.canvas.mapSettings().destinationCrs()))
    screenshot(f"viewer-on-map-{tilt_deg:.0f}-{yaw_deg:.0f}")
    # Another image is not there; this one still is.
    desk.click(viewer.following)
    desk.wait(lambda: not viewing.busy and viewing.seen.shot.name != name)
    assert not viewer.on_map.isChecked()
    desk.click(viewer.previous)
    desk.wait(lambda: not viewing.busy and viewing.seen.shot.name == name)
    assert viewer.on_map.isChecked()
    desk.click(viewer.on_map)
    desk.wait(lambda: not on_map())
    # A layer that is taken off the map by hand counts as removed.
    desk.click(viewer.on_map)
    desk.wait(lambda: not viewing.busy and len(on_map()) == 1)
    QgsProject.instance().removeMapLayer(on_map()[0].id())
    assert not viewer.on_map.isChecked()
