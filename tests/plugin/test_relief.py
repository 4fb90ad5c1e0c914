"""Missions over relief in the real application: a layer of heights is chosen, the flight previewed and captured."""

from __future__ import annotations

import csv
from dataclasses import replace

import numpy as np
import pyproj
import pytest
from osgeo import gdal
from qgis.core import Qgis, QgsProject, QgsRasterLayer
from qgis.PyQt.QtCore import QCoreApplication, QEvent, QPointF, Qt
from qgis.PyQt.QtGui import QMouseEvent
from qgis.PyQt.QtWidgets import QCheckBox, QLineEdit, QMenu, QToolButton
from terrainav.core.errors import SourceError
from terrainav.core.fields import field_named
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Output
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.products import products
from terrainav.terrainav_plugin.capture import task
from terrainav.terrainav_plugin.capture.endings import Endings
from terrainav.terrainav_plugin.dataset.rectify import lay_on_map
from terrainav.terrainav_plugin.results.viewer import details

from tests.core.imagery.raster.test_own_pixels import noise
from tests.plugin.test_capture import capture, images
from tests.plugin.test_own_crs import UTM, draw, middle_of
from tests.plugin.test_viewer import pixels
from tests.support import rasters

SIDE, CELL = 500, 2.0


def ridge(x, y):
    """Heights by metres from the middle: a ridge of 40 m from north to south."""
    return 100.0 + 40.0 * np.exp(-((x / 60.0) ** 2)) + 0.0 * y


@pytest.fixture
def dem(tmp_path):
    """A layer of heights about the place, in the project."""
    middle_x, middle_y = middle_of(UTM)
    west, north = middle_x - SIDE * CELL / 2.0, middle_y + SIDE * CELL / 2.0
    offset = (np.arange(SIDE) + 0.5) * CELL - SIDE * CELL / 2.0
    x, y = np.meshgrid(offset, -offset)
    folder = tmp_path / "heights of the ground"
    folder.mkdir()
    path = rasters.write(
        folder / "ridge.tif",
        ridge(x, y)[np.newaxis],
        (west, CELL, 0.0, north, 0.0, -CELL),
        UTM[0],
        data_type=gdal.GDT_Float32,
    )
    layer = QgsRasterLayer(str(path), "Ridge", "gdal")
    assert layer.isValid()
    return QgsProject.instance().addMapLayer(layer)


def choose(desk, title):
    """Choose a source of heights by its button, as the mouse does."""
    section = desk.form.relief
    section.unfold()
    button = section.findChild(QToolButton, "elevation_choose")
    menu = button.menu()
    menu.aboutToShow.emit()
    (action,) = [action for action in menu.actions() if action.text() == title]
    action.trigger()


def set_up(desk, **values):
    asked = {"source": "world", "folder": str(desk.folder), "agl": 90.0, "overlap_along": 0.3, **values}
    desk.form.set_state(replace(desk.session.state(), **asked))


def test_a_layer_of_heights_is_flown_over(desk, dem):
    set_up(desk, tilt_deg=25.0, image_px=80, products=("depth",))
    choose(desk, "Ridge")
    assert desk.session.state().elevation == (dem.source(),)
    planned = draw(desk, UTM, 100.0)
    made = planned.plan
    assert planned.mission.terrain.elevation == (dem.source(),)
    assert not made.relief.is_level
    x, y = pyproj.Transformer.from_crs(4326, UTM[0], always_xy=True).transform(made.lon_deg, made.lat_deg)
    middle_x, middle_y = middle_of(UTM)
    assert made.ground_m == pytest.approx(ridge(x - middle_x, y - middle_y), abs=0.1)
    assert made.agl_m == pytest.approx(90.0)

    desk.click(desk.dock.preview)
    desk.wait_previewed()
    drawn = {one["name"]: one.geometry() for one in desk.layer("Planned images").getFeatures()}
    assert set(drawn) == set(made.names)
    # Footprints bend over the ridge: they are no trapezia any more.
    ring = next(iter(drawn.values())).vertices()
    assert sum(1 for _ in ring) > 8

    capture(desk)
    assert len(images(desk)) == len(made)
    with next(desk.folder.rglob("meta_data.csv")).open(newline="") as file:
        heights = [float(row["height_m"]) for row in csv.DictReader(file)]
    assert heights == pytest.approx(made.height_m)
    assert len(list(desk.folder.rglob("depth/*.tif"))) == len(made)
    # What is captured is what the core captures.
    again = plan(planned.mission, made.grid, mission_heights(planned.mission))
    assert again.names == made.names


def test_a_part_in_view_of_a_tilted_flight_over_relief_is_drawn(desk, dem):
    from terrainav.terrainav_plugin.preview.features import plan_part

    set_up(desk, tilt_deg=30.0, image_px=80, elevation=(dem.source(),))
    plan = draw(desk, UTM, 100.0).plan
    some = np.arange(0, len(plan), 2)
    part = plan_part(plan, some)
    assert np.array_equal(part.height_m, plan.height_m[some])
    for seen, whole in zip(part.frame_centres, plan.frame_centres):
        assert seen == pytest.approx(whole[some], abs=1e-12)


def test_sources_are_typed_and_cleared(desk, dem):
    set_up(desk)
    line = desk.form.relief.entries["elevation"]
    line.setText(f"{dem.source()}; 12.5")
    assert desk.session.state().elevation == (dem.source(), "12.5")
    choose(desk, "Level ground")
    assert desk.session.state().elevation == ()
    choose(desk, "Synthetic landscape (offline)")
    assert desk.session.state().elevation == ("world",)
    # By its title, as in the list of imagery; either may be typed.
    assert line.text() == "Synthetic landscape (offline)"
    assert line.cursorPosition() == 0
    set_up(desk, elevation=(dem.source(), "terrarium"))
    assert line.text() == f"{dem.source()}; Terrain Tiles (Terrarium, public)"
    for typed in ("world", "synthetic Landscape (offline)"):
        line.setText(f"{dem.source()};{typed}")
        assert desk.session.state().elevation == (dem.source(), "world")
        assert line.text() == f"{dem.source()};{typed}"


def test_products_are_ticked(desk):
    """As map types are; the order of a mission's file is kept."""
    set_up(desk, products=("normals", "depth"))
    boxes = desk.form.labels.entries["products"].findChildren(QCheckBox)
    choices = field_named(Output, "products").choices
    assert [box.text().replace("&", "") for box in boxes] == list(choices.values())
    assert dict(zip(choices, (box.isChecked() for box in boxes))) == {
        "depth": True,
        "points": False,
        "normals": True,
        "facades": False,
        "classes": False,
        "instances": False,
        "raw": False,
    }
    assert desk.session.state().products == ("normals", "depth")
    for box in boxes:
        box.click()
    assert desk.session.state().products == ("points", "facades", "classes", "instances", "raw")


def test_a_hole_below_the_flight_is_said_at_the_entry(desk, dem):
    set_up(desk, elevation=(dem.source(),))
    desk.enter_box("35.20", "-89.80", "35.199", "-89.799")
    desk.wait(lambda: bool(desk.message("elevation") or desk.dock.problem.text()))
    assert "no height at latitude 35.199" in desk.message("elevation")
    assert "“Elevation”" in desk.message("elevation")
    assert "--" not in desk.message("elevation")


def test_missions_over_relief_come_back_from_their_files(desk, dem, tmp_path):
    set_up(
        desk,
        elevation=(dem.source(),),
        height_above="takeoff",
        clearance_m=5.0,
        products=("depth", "normals"),
    )
    planned = draw(desk, UTM, 60.0)
    planned.mission.save(tmp_path / "mission.json")
    assert Mission.load(tmp_path / "mission.json") == planned.mission
    assert planned.mission.terrain.height_above == "takeoff"
    assert planned.mission.output.products == ("depth", "normals")


@pytest.mark.thorough
def test_the_viewer_shows_the_depth_beside_the_picture(desk, dem, screenshot):
    set_up(desk, tilt_deg=70.0, image_px=80, products=("depth",), elevation=(dem.source(),))
    draw(desk, UTM, 100.0)
    capture(desk)
    viewing = desk.session.viewing
    desk.plugin.actions["view_images"].trigger()
    at = next(desk.layer("Captured images").getFeatures()).geometry().pointOnSurface().asPoint()
    viewing._clicked(at.y(), at.x())
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    viewer, seen = viewing.viewer, viewing.seen
    try:
        # As GDAL's own reader has it, with its mask.
        file = gdal.Open(str(desk.folder / "depth" / f"{seen.shot.name}.tif"))
        band = file.GetRasterBand(1)
        metres, there = band.ReadAsArray(), band.GetMaskBand().ReadAsArray() > 0
        assert there.any()
        assert not there.all()
        view = viewer.depth.view
        assert view.isVisibleTo(viewer)
        colours = pixels(view.image)
        assert colours.shape[:2] == metres.shape == pixels(viewer.view.image).shape[:2]
        # What the colours tell apart grows with the depth: brighter is farther, grey is nothing.
        assert (colours[~there][:, :3] == 128).all()
        nearest, farthest = np.where(there, metres, np.inf).argmin(), np.where(there, metres, 0.0).argmax()
        assert colours.reshape(-1, 4)[nearest, :3].tolist() == [68, 1, 84]
        assert colours.reshape(-1, 4)[farthest, :3].tolist() == [253, 231, 37]
        assert viewer.depth.near.text() == f"{metres[there].min():.1f} m"
        rows, columns = metres.shape
        # The mouse over either picture tells the same pixel's depth.
        for widget in (viewer.view, view):
            place = widget.place()
            for row, column in ((rows - 3, 5), (rows // 2, columns // 2), (0, columns - 1)):
                x = place.left() + (column + 0.5) * place.width() / columns
                y = place.top() + (row + 0.5) * place.height() / rows
                move = QMouseEvent(
                    QEvent.Type.MouseMove,
                    QPointF(int(x), int(y)),
                    Qt.MouseButton.NoButton,
                    Qt.MouseButton.NoButton,
                    Qt.KeyboardModifier.NoModifier,
                )
                widget.mouseMoveEvent(move)
                # The screen's pixel shows one of those of the picture next to its middle.
                around = (slice(max(row - 1, 0), row + 2), slice(max(column - 1, 0), column + 2))
                text = viewer.depth.here.text()
                if not there[around].any():
                    assert text == "No ground here"
                else:
                    near = metres[around].ravel()
                    assert text in {f"Depth here: {m:,.0f} m" if m >= 1e3 else f"Depth here: {m:.1f} m" for m in near}
        # The details say what the table does.
        with (desk.folder / "satellite" / "meta_data.csv").open(newline="") as table:
            row = next(row for row in csv.DictReader(table) if row["img_names"].startswith(seen.shot.name))
        agl, height = float(row["agl_m"]), float(row["height_m"])
        told = viewer.details.text()
        assert f"{agl:.2f} m above ground, {height:.2f} m above the ellipsoid" in told
        assert "Steep faces" not in told
        among = dict(details(seen._replace(row={**seen.row, "facade_share": "0.0312"})))
        assert among["Steep faces"] == "3.1 % of the pixels"
        screenshot("viewer-depth", viewer)
        assert viewer.depth.isVisibleTo(viewer)
        # With the list of images under a click, too, QGIS's window does not grow beyond the screen for it.
        assert viewer.minimumSizeHint().height() < 250
        # One that cannot be read says so where it would be, and the picture is shown all the same.
        path = desk.folder / "depth" / f"{seen.shot.name}.tif"
        whole = path.read_bytes()
        for broken in (b"", b"no image", whole[: len(whole) // 2]):
            path.write_bytes(broken)
            before = viewing.seen
            viewing._show_shot(seen.shot)
            desk.wait(lambda before=before: viewing.seen is not before and not viewing.busy)
            assert view.isVisibleTo(viewer)
            assert view.image is None
            assert view.accessibleName().startswith("The depth cannot be read: ")
            assert "\n" not in view.accessibleName()
            assert not viewer.depth.isVisibleTo(viewer)
            assert viewer.view.image is not None
        # Where none was made nothing is shown.
        path.unlink()
        seen = viewing.seen
        viewing._show_shot(seen.shot)
        desk.wait(lambda: viewing.seen is not seen and not viewing.busy)
        assert not view.isVisibleTo(viewer)
        assert not viewer.depth.isVisibleTo(viewer)
    finally:
        viewing.stop()
        viewer.hide()


def test_a_test_shot_lies_where_its_pixels_see_the_relief(desk, dem, tmp_path):
    """Laid on the map, each pixel of the picture is found again at the ground point that its product states."""
    source = open_source("world")
    _, lat, lon = UTM
    mission = Mission(
        Points(((lat, lon, 90.0),)), 90.0, tilt_deg=40.0, yaw_deg=90.0, image_px=80, source="world"
    ).replace(elevation=(dem.source(),), products=("points",))
    made = plan(mission, source.grid, mission_heights(mission))
    width, height = made.frames.largest_px
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    # A picture whose colours tell its pixels.
    told = np.stack([columns, rows, 0 * rows]).astype(np.uint8)
    raster = gdal.GetDriverByName("GTiff").Create(str(tmp_path / "told.tif"), width, height, 3)
    raster.WriteArray(told)
    del raster
    lay_on_map(made, tmp_path / "told.tif", tmp_path / "laid.tif")
    laid = gdal.Open(str(tmp_path / "laid.tif"))
    west, across, _, north, _, down = laid.GetGeoTransform()
    shown = laid.ReadAsArray().astype(float)
    ((_, points),) = products(made, 0, (width, height))
    x, y = pyproj.Transformer.from_crs(4326, 3857, always_xy=True).transform(points[..., 0], points[..., 1])
    i, j = ((y - north) / down).astype(int), ((x - west) / across).astype(int)
    inside = (points[..., 3] > 0) & (i >= 0) & (j >= 0) & (i < shown.shape[1]) & (j < shown.shape[2])
    assert inside.mean() > 0.9
    at = shown[:, i[inside], j[inside]]
    opaque = at[3] == 255
    assert opaque.mean() > 0.95
    off = np.abs(at[:2] - told[:2, inside])[:, opaque].max(axis=0)
    assert np.percentile(off, 95) <= 1.5


def test_menu_adds_a_source_that_fills_holes(desk, dem, screenshot):
    set_up(desk)
    choose(desk, "Ridge")
    line = desk.form.relief.findChild(QLineEdit, "elevation")
    assert "Separate several with ; each fills the holes of those before it." in line.toolTip()
    button = desk.form.relief.findChild(QToolButton, "elevation_choose")
    menu = button.menu()
    menu.aboutToShow.emit()
    more = menu.findChild(QMenu, "elevation_more")
    assert more.title() == "Fill its holes from"
    titles = [action.text() for action in more.actions()]
    # Not the source itself.
    assert titles == ["Terrain Tiles (Terrarium, public)", "Synthetic landscape (offline)", "File…"]
    screenshot("fill-holes-menu", menu)
    next(action for action in more.actions() if action.text().startswith("Synthetic")).trigger()
    assert desk.session.state().elevation == (dem.source(), "world")
    assert line.text().endswith("; Synthetic landscape (offline)")


def test_menu_that_is_opened_again_keeps_one_submenu(desk, dem):
    set_up(desk)
    choose(desk, "Ridge")
    menu = desk.form.relief.findChild(QToolButton, "elevation_choose").menu()
    for _ in range(9):
        menu.aboutToShow.emit()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        assert len(menu.findChildren(QMenu, "elevation_more")) == 1


def test_comma_between_sources_of_heights_is_said_at_the_field(desk, dem):
    set_up(desk)
    draw(desk, UTM, 60.0)
    desk.form.relief.unfold()
    desk.form.relief.findChild(QLineEdit, "elevation").setText(f"{dem.source()}, world")
    desk.wait(lambda: "several sources in one" in desk.message("elevation"))
    assert "a semicolon between them in QGIS" in desk.message("elevation")


@pytest.mark.thorough
def test_mosaic_over_the_landscape_of_imagery_in_another_crs(desk, tmp_path):
    """The dataset states the imagery's CRS, which is none of the landscape that its relief is of."""
    noise(tmp_path / "ortho.tif", *UTM)
    set_up(desk, source=str(tmp_path / "ortho.tif"), elevation=("world",), tilt_deg=10.0, image_px=80)
    made = draw(desk, UTM, 60.0).plan
    assert not made.relief.is_level
    capture(desk)
    assert len(images(desk)) == len(made)
    assert not any("mosaic" in text for text in desk.messages())
    assert (desk.folder / "satellite.tif").is_file()
    assert desk.layer("Satellite images").crs().authid() == f"EPSG:{UTM[0]}"


def test_mosaic_that_cannot_be_is_said_before_the_capture_and_at_its_end(desk, dem, monkeypatch):
    set_up(desk, tilt_deg=25.0, image_px=80, elevation=(dem.source(),))
    draw(desk, UTM, 60.0)

    def fail(_mission):
        raise SourceError("heights: are gone")

    seen = []
    monkeypatch.setattr(task, "mission_heights", fail)
    monkeypatch.setattr(Endings, "warn_of_mosaic", noted(Endings.warn_of_mosaic, lambda: seen.append(images(desk))))
    capture(desk)
    assert seen == [[]]
    assert "Without a mosaic: heights: are gone" in desk.messages()[0]
    levels = [item.level() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    durations = [item.duration() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert set(levels) == {Qgis.MessageLevel.Warning}
    assert set(durations) == {0}


def noted(work, note):
    def both(*given):
        note()
        work(*given)

    return both
