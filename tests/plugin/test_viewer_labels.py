"""Labels over the image in the viewer: their colours, legend and what is under the mouse."""

from __future__ import annotations

import json
from contextlib import closing

import numpy as np
import pytest
from osgeo import gdal
from qgis.PyQt.QtCore import QPointF
from terrainav.core.capture.blocks.running import Blocks
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.dataset.overlay import LabelOverlay, LegendEntry
from terrainav.terrainav_plugin.results.labels_pane import _legend_html

from tests.plugin.test_addresses import captured, frame_map, open_address, serve
from tests.plugin.test_viewer import pixels
from tests.support.ranges import RangeServer

MISSION = Mission(Box(35.1583, -89.90, 35.1561, -89.8966), 120.0, image_px=640, max_px=640)
CROPS = ("maize", "oats", None)


@pytest.fixture(scope="module")
def fields(tmp_path_factory):
    """Parcels of three crops, one of them unknown, with lanes between them."""
    features = []
    for row in range(14):
        for column in range(14):
            west, south = -89.9005 + 0.0004 * column, 35.1555 + 0.00025 * row
            ring = [[0, 0], [0.00034, 0], [0.00034, 0.0002], [0, 0.0002], [0, 0]]
            geometry = {"type": "Polygon", "coordinates": [[[west + x, south + y] for x, y in ring]]}
            properties = {"crop": CROPS[(row + column) % 3]}
            features.append({"type": "Feature", "geometry": geometry, "properties": properties})
    path = tmp_path_factory.mktemp("layers") / "fields.geojson"
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    return path


def write(folder, fields, layout="", **values):
    """Capture a mission with labels over the embedded world, in blocks for shards."""
    mission = MISSION.replace(labels=(f"{fields}:crop",), **values)
    named = named_source("world")
    with closing(named.open()) as source:
        made = plan(mission, source.grid)
        if layout:
            assert not capture(made, named, folder, blocks=Blocks(3, layout)).failed
        else:
            assert not capture(made, source, folder).failed
    return folder


@pytest.fixture
def viewing(desk):
    yield desk.session.viewing
    desk.session.viewing.stop()
    viewer = desk.session.viewing.viewer
    if viewer is not None:
        viewer.labels.wanted.emit("")
        viewer.hide()


def view(desk, viewing, folder):
    """Open a dataset, and look at its first image."""
    desk.session.missions.open_dataset(folder)
    desk.wait(lambda: not desk.session.missions.busy and "Captured images" in desk.layer_names())
    frame_map(desk, MISSION)
    viewing.seen = None
    desk.plugin.actions["view_images"].trigger()
    desk.wait(lambda: viewing.seen is not None and not viewing.busy)
    return viewing.viewer


def choose(desk, viewing, product):
    pane, before = viewing.viewer.labels, viewing.seen
    pane.choice.setCurrentIndex(pane.choice.findData(product))
    pane.choice.activated.emit(pane.choice.currentIndex())
    desk.wait(lambda: viewing.seen is not before and not viewing.busy)
    return viewing.viewer.view.overlay


def file_values(folder, product, name):
    (path,) = (one for one in (folder / product).glob(f"{name}.*") if one.suffix in (".tif", ".png"))
    return gdal.Open(str(path)).ReadAsArray()


@pytest.mark.parametrize(
    "values", [{"image_format": "png"}, {"tilt_deg": 65.0, "yaw_deg": 30.0}], ids=["png", "tilted"]
)
def test_classes_and_instances_lie_over_the_image(desk, viewing, fields, tmp_path, screenshot, values):
    folder = write(tmp_path / "run", fields, **values)
    viewer = view(desk, viewing, folder)
    pane, name = viewer.labels, viewing.seen.shot.name
    assert pane.isVisibleTo(viewer)
    # Off at first.
    assert viewer.view.overlay is None
    assert not pane.opacity.isVisibleTo(pane)
    classes, instances = (file_values(folder, product, name) for product in ("classes", "instances"))
    shown = pixels(choose(desk, viewing, "classes"))
    assert shown.shape[:2] == classes.shape
    table = json.loads((folder / "classes.json").read_text())
    colours = {one["id"]: bytes.fromhex(one["color"][1:]) for one in table["classes"]} | {255: b"\xff\xff\xff"}
    for number in np.unique(classes).tolist():
        wanted = [*colours[number], 255] if number else [0, 0, 0, 0]
        assert (shown[classes == number] == wanted).all()
    legend = pane.legend.text()
    for one in table["classes"]:
        share = 100.0 * (classes == one["id"]).mean()
        assert f"{one['name']}&nbsp;{share:.1f}&nbsp;%" in legend
        assert one["color"] in legend
    screenshot(f"viewer-classes-{'tilted' if 'tilt_deg' in values else 'png'}", viewer)
    # Nor does QGIS's window grow beyond a low screen.
    assert viewer.minimumSizeHint().height() < 250
    pane.opacity.setValue(80)
    image = pixels(choose(desk, viewing, "instances"))
    assert f"{len(np.unique(instances)) - 1} instances in this image" in pane.legend.text()
    # Instances next to each other differ, and no background is coloured.
    assert (image[instances == 0, 3] == 0).all()
    assert len(np.unique(image[instances > 0], axis=0)) > 3
    screenshot(f"viewer-instances-{'tilted' if 'tilt_deg' in values else 'png'}", viewer)
    # Under the mouse is the feature that the file has there.
    row, column = (int(at[len(at) // 2]) for at in np.nonzero((instances > 0) & (classes < 255)))
    height, width = classes.shape
    viewer.view.pointed.emit(QPointF((column + 0.5) / width, (row + 0.5) / height))
    crop = {one["id"]: one["name"] for one in table["classes"]}[classes[row, column]]
    number = instances[row, column]
    assert pane.here.text() == f"{crop}, instance {number}, feature {number} of fields"
    row, column = (int(at[0]) for at in np.nonzero(classes == 0))
    viewer.view.pointed.emit(QPointF((column + 0.5) / width, (row + 0.5) / height))
    assert pane.here.text() == "Background here"
    # They stay over further images, until switched off.
    before = viewing.seen
    desk.click(viewer.following)
    desk.wait(lambda: viewing.seen is not before and not viewing.busy)
    assert viewing.seen.shown_labels == "instances"
    assert viewer.view.overlay is not None
    assert choose(desk, viewing, "") is None
    assert not pane.legend.isVisibleTo(pane)


def test_classes_that_are_there_are_not_said_to_be_absent():
    few = LabelOverlay(None, (LegendEntry("#ff0000", "a & b", 4e-4), LegendEntry("", "background", 0.9996)))
    text = _legend_html(few, "classes")
    assert "a&nbsp;&amp;&nbsp;b&nbsp;&lt;&nbsp;0.1&nbsp;%" in text
    assert "background&nbsp;100.0&nbsp;%" in text
    many = LabelOverlay(None, tuple(LegendEntry("#ff0000", str(at), 0.04) for at in range(25)))
    assert _legend_html(many, "classes").endswith("and 5 more classes")


def test_only_datasets_with_labels_offer_them_and_broken_files_say_so(desk, viewing, fields, tmp_path):
    folder = write(tmp_path / "run", fields, products=("classes",))
    viewer = view(desk, viewing, folder)
    pane = viewer.labels
    assert [pane.choice.itemData(at) for at in range(pane.choice.count())] == ["", "classes"]
    name = viewing.seen.shot.name
    table = folder / "classes.json"
    # Without the table, classes have numbers and colours of their own.
    table.unlink()
    assert choose(desk, viewing, "classes") is not None
    assert "1&nbsp;" in pane.legend.text()
    table.write_text('{"classes": [{"id": 1, "name": "<b>x</b>", "color": "red"}]}')
    assert choose(desk, viewing, "classes") is None
    assert "must be #rrggbb" in pane.legend.text()
    table.unlink()
    (folder / "classes" / f"{name}.tif").write_bytes(b"no image")
    assert choose(desk, viewing, "classes") is None
    assert pane.legend.text().startswith("The labels cannot be read: ")
    assert viewer.view.image is not None
    (folder / "classes" / f"{name}.tif").unlink()
    choose(desk, viewing, "classes")
    assert pane.legend.text() == "There are no labels (yet)."
    # One without labels.
    with closing(named_source("world").open()) as source:
        capture(plan(MISSION, source.grid), source, tmp_path / "plain")
    desk.iface.newProject(False)
    view(desk, viewing, tmp_path / "plain")
    assert not pane.isVisibleTo(viewer)
    assert viewer.view.overlay is None


@pytest.mark.parametrize("layout", ["folders", "webdataset"])
@pytest.mark.parametrize("image_format", ["tif", "png"])
def test_labels_are_fetched_with_the_image(desk, viewing, fields, tmp_path, layout, image_format):
    # Products in between are passed over.
    wanted = {"products": ("depth", "classes", "points", "instances"), "image_format": image_format}
    plain = write(tmp_path / "plain", fields, **wanted)
    folder = plain if layout == "folders" else write(tmp_path / "shards", fields, layout, **wanted)
    with RangeServer() as server:
        assert open_address(desk, serve(server, folder)) == ""
        assert captured(desk).featureCount() > 1
        frame_map(desk, MISSION)
        viewing.seen = None
        desk.plugin.actions["view_images"].trigger()
        desk.wait(lambda: viewing.seen is not None and not viewing.busy)
        before = len(server.asked)
        choose(desk, viewing, "classes")
        assert len(server.asked) > before
        seen = viewing.seen
        for product, values in (("classes", seen.labels.classes), ("instances", seen.labels.instances)):
            np.testing.assert_array_equal(values, file_values(plain, product, seen.shot.name))
        assert {"maize", "oats"} <= {one.name for one in seen.labels.legend}
