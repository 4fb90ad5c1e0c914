"""The mosaic of a run, while layers show it: GDAL writes a virtual raster back when it closes it."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace

import numpy as np
import processing
import pytest
from osgeo import gdal
from qgis.core import QgsProject, QgsRasterLayer
from qgis.PyQt.QtTest import QTest
from terrainav.core.dataset.clean import clean, undo
from terrainav.core.dataset.table import Table

from tests.plugin.test_capture import capture, images
from tests.support.tileserver import TileServer

# Three by three images, of which one is there at first, and two side by side: so few pixels that QGIS
# takes the statistics of each, and not of the overviews. GDAL keeps them in the mosaic's file as it closes it.
NINE = ("35.14", "-89.87", "35.1375", "-89.866")
PAIR = ("35.14", "-89.87", "35.1395", "-89.868")


@pytest.fixture
def server():
    with TileServer() as running:
        yield running


def tiles_under(plan, indices):
    """Tiles that images need."""
    window, found = plan.windows, set()
    for index in indices:
        left, top = int(window.left_px[index]), int(window.top_px[index])
        right, bottom = left + int(window.width_px[index]) - 1, top + int(window.height_px[index]) - 1
        for x in range(left // 256, right // 256 + 1):
            found |= {(plan.zoom, x, y) for y in range(top // 256, bottom // 256 + 1)}
    return found


@pytest.fixture
def one_of_nine(desk, server):
    """A mission of nine images, of which the first alone has come; its layers are on the map."""
    desk.enter_box(*NINE)
    desk.use_template(server.url_template)
    plan = desk.wait_planned().plan
    assert len(plan) == 9
    server.fail("404", *(tiles_under(plan, range(1, 9)) - tiles_under(plan, [0])))
    capture(desk)
    assert len(images(desk)) == 1
    assert named(desk) == {path.name for path in images(desk)}
    server.heal()
    return desk


def named(desk):
    """Pictures that the file names."""
    text = (desk.folder / "satellite.vrt").read_text(encoding="utf-8")
    # No two rasters share open images, which threads of QGIS would read at once.
    assert text.count('shared="0"') == text.count("<SourceFilename") > 0
    return set(re.findall(r"satellite/([^<]*)</SourceFilename>", text))


def assert_shows_what_is_there(desk, layers=()):
    """File and layers show the images that are there, and no file of the making is left."""
    plan = desk.session.planned.plan
    there = {path.name for path in images(desk)}
    assert named(desk) == there
    assert np.all(gdal.Open(str(desk.folder / "satellite.vrt")).GetRasterBand(4).ReadAsArray() == 255)
    shown = [f"{name}.tif" in there for name in plan.names]
    west, south, east, north = (edge[shown] for edge in plan.edges)
    for layer in (desk.layer("Satellite images"), *layers):
        extent, provider = layer.extent(), layer.dataProvider()
        edges = extent.xMinimum(), extent.yMinimum(), extent.xMaximum(), extent.yMaximum()
        assert edges == pytest.approx((west.min(), south.min(), east.max(), north.max()), abs=1e-3)
        alpha = provider.block(4, extent, layer.width(), layer.height())
        assert set(bytes(alpha.data())) == {255}
    assert not list(desk.folder.glob("*.new"))


def assert_shows_all(desk, layers=()):
    assert len(images(desk)) == len(desk.session.planned.plan)
    assert_shows_what_is_there(desk, layers)


def capture_failed_again(desk):
    desk.click(desk.buttons_in_message_bar()["Capture only the failed ones"])
    desk.wait(lambda: len(images(desk)) == 9)
    desk.wait_for_run()


def test_images_captured_again_are_in_the_file_and_on_the_map(one_of_nine):
    desk = one_of_nine
    layer = desk.layer("Satellite images")
    layer.setOpacity(0.5)
    layer.renderer().setRedBand(3)
    identity = layer.id()
    # One that the user has made of it shows the same file.
    copy = layer.clone()
    QgsProject.instance().addMapLayer(copy)
    capture_failed_again(desk)
    assert_shows_all(desk, [copy])
    layer = desk.layer("Satellite images")
    assert (layer.id(), layer.opacity(), layer.renderer().redBand()) == (identity, 0.5, 3)

    # Closed, they leave the file as it is, and a reopened project finds it.
    project = desk.folder.parent / "project.qgz"
    assert QgsProject.instance().write(str(project))
    desk.iface.newProject(False)
    settle()
    desk.iface.addProject(str(project))
    desk.wait_planned()
    assert_shows_all(desk)
    assert desk.layer("Satellite images").source() == str(desk.folder / "satellite.vrt")
    assert desk.layer("Satellite images").opacity() == 0.5


def settle():
    """Let what QGIS deletes later be deleted."""
    QTest.qWait(100)


@pytest.mark.thorough
def test_images_captured_again_after_the_project_was_closed_are_in_the_file(one_of_nine, server):
    """The old layer goes while the run goes on, and nothing of it comes back."""
    desk = one_of_nine
    server.latency_s = 0.2
    desk.click(desk.buttons_in_message_bar()["Capture only the failed ones"])
    desk.wait(lambda: len(images(desk)) >= 2)
    desk.iface.newProject(False)
    desk.wait_for_run()
    settle()
    assert len(images(desk)) == 9
    assert named(desk) == {path.name for path in images(desk)}


@pytest.mark.thorough
def test_algorithm_that_captures_again_renews_what_the_project_shows(one_of_nine):
    desk = one_of_nine
    result = processing.run("terrainav:capturefailed", {"DATASET": str(desk.folder), "LOAD": False})
    assert result["WRITTEN"] == 8
    assert_shows_all(desk)


def test_update_of_the_mosaic_shows_what_cleaning_has_left_and_put_back(desk):
    desk.enter_box(*PAIR)
    desk.wait_planned()
    capture(desk)
    everything = named(desk)
    assert len(everything) == 2
    (cleaned,) = clean(desk.folder, middle_entropy(desk), move=True)
    assert 0 < cleaned.moved < len(everything)
    open_again(desk)
    assert_shows_what_is_there(desk)
    undo(desk.folder)
    open_again(desk)
    assert_shows_all(desk)


@pytest.mark.thorough
def test_update_of_the_mosaic_of_turned_images_shows_what_cleaning_has_left(desk):
    desk.enter_box(*PAIR)
    desk.form.set_state(replace(desk.session.state(), facing="track"))
    plan = desk.wait_planned().plan
    assert set(plan.frames.quarter_turns.tolist()) <= {1, 3}
    capture(desk)
    mosaic = desk.folder / "satellite.tif"
    assert shown_share(mosaic) > 0.99
    (cleaned,) = clean(desk.folder, middle_entropy(desk), move=True)
    assert 0 < cleaned.moved < len(plan)
    open_again(desk)
    with_some = gdal.Open(str(mosaic))
    place, size = with_some.GetGeoTransform(), (with_some.RasterXSize, with_some.RasterYSize)
    table = Table.load(desk.folder / "satellite" / "meta_data.csv")
    left = [name for name in table.img_names if (desk.folder / "satellite" / name).is_file()]
    edges = []
    for name in left:
        one = gdal.Open(str(desk.folder / "satellite" / name))
        edges.append(gdal.Info(one, format="json")["cornerCoordinates"].values())
    x, y = np.array([[corner[:2] for corner in corners] for corners in edges]).reshape(-1, 2).T
    assert place[0] == pytest.approx(x.min(), abs=0.01)
    assert place[3] == pytest.approx(y.max(), abs=0.01)
    assert size[0] * place[1] == pytest.approx(np.ptp(x), abs=0.01)
    undo(desk.folder)
    open_again(desk)
    assert shown_share(mosaic) > 0.99


def shown_share(path):
    raster = gdal.Open(str(path))
    return float((raster.GetRasterBand(4).ReadAsArray() == 255).mean())


def middle_entropy(desk):
    return float(np.median(Table.load(desk.folder / "satellite" / "meta_data.csv").entropies))


def open_again(desk):
    desk.session.missions.open_dataset(desk.folder)
    desk.wait(lambda: not desk.session.missions.busy)
    desk.wait_for_tasks()


@pytest.mark.thorough
def test_old_mosaic_written_by_another_program_is_known_by_its_pictures(one_of_nine):
    """A QGIS beside this one closes its layer later: the file is newer than all images, and old."""
    desk = one_of_nine
    path = desk.folder / "satellite.vrt"
    old = desk.folder.parent / "old.vrt"
    shutil.copy(path, old)
    capture_failed_again(desk)
    desk.iface.newProject(False)
    settle()
    path.write_bytes(old.read_bytes())
    desk.session.missions.open_dataset(desk.folder)
    desk.wait(lambda: not desk.session.missions.busy)
    desk.wait_planned()
    assert_shows_all(desk)


@pytest.mark.thorough
def test_a_mosaic_that_is_as_it_should_be_is_not_made_anew(one_of_nine):
    desk = one_of_nine
    capture_failed_again(desk)
    overviews = desk.folder / "satellite.vrt.ovr"
    made_ns = overviews.stat().st_mtime_ns
    open_again(desk)
    assert overviews.stat().st_mtime_ns == made_ns
    assert_shows_all(desk)


@pytest.mark.thorough
def test_a_mosaic_that_cannot_be_replaced_is_named_and_shown_as_it_was(one_of_nine, monkeypatch):
    """As on Windows, where another program has it open."""
    from terrainav.terrainav_plugin.dataset import mosaic

    desk = one_of_nine
    replace = mosaic.os.replace

    def refuse(source, target):
        if str(target).endswith(".ovr"):
            raise PermissionError(13, "in use")
        replace(source, target)

    monkeypatch.setattr(mosaic.os, "replace", refuse)
    capture_failed_again(desk)
    assert any("cannot be replaced (in use); close what shows it" in text for text in desk.messages())
    layer = desk.layer("Satellite images")
    assert isinstance(layer, QgsRasterLayer)
    assert layer.isValid()
    assert len(named(desk)) == 1
    monkeypatch.undo()
    # Opening it again mends it.
    open_again(desk)
    assert_shows_all(desk)
