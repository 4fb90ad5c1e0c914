"""Labels and buildings of a mission in the panel and on the map: what is wrong, counts, progress and the preview."""

from __future__ import annotations

import json
import threading
from dataclasses import replace

import numpy as np
import pyproj
import pytest
from qgis.core import QgsCategorizedSymbolRenderer, QgsProject
from qgis.PyQt.QtWidgets import QLabel
from terrainav.core.vectors import layer as layers
from terrainav.terrainav_plugin import plan_features
from terrainav.terrainav_plugin.preview import preview

from tests.plugin.steps import COARSE_BOX

WEST, SOUTH, EAST, NORTH = (float(COARSE_BOX[name]) for name in ("west", "south", "east", "north"))


def square(column, row, size=0.0003):
    west, south = WEST + 0.0005 * column, SOUTH + 0.0005 * row
    return [[west, south], [west + size, south], [west + size, south + size], [west, south + size], [west, south]]


def write(path, shapes):
    """Write geometries with their properties as GeoJSON."""
    features = [{"type": "Feature", "geometry": geometry, "properties": values} for geometry, values in shapes]
    path.write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
    return str(path)


def polygon(*rings):
    return {"type": "Polygon", "coordinates": list(rings)}


@pytest.fixture
def fields(tmp_path):
    """Ten squares of two crops and none, one that crosses itself, one without area, a line and a point."""
    shapes = [(polygon(square(at, 1)), {"crop": ("maize", "oats", None)[at % 3]}) for at in range(10)]
    bow = [[WEST, SOUTH], [WEST + 0.001, SOUTH + 0.001], [WEST + 0.001, SOUTH], [WEST, SOUTH + 0.0005], [WEST, SOUTH]]
    shapes.append((polygon(bow), {"crop": "oats"}))
    shapes.append((polygon([[WEST, SOUTH]] * 4), {"crop": "oats"}))
    line = {"type": "LineString", "coordinates": [[WEST, NORTH], [EAST, NORTH]]}
    shapes += [(line, {"crop": "road"}), ({"type": "Point", "coordinates": [WEST, SOUTH]}, {"crop": "tree"})]
    return write(tmp_path / "fields.geojson", shapes)


@pytest.fixture
def houses(tmp_path):
    """Footprints with a height, with levels, with neither, and with a height that cannot be read."""
    values = [{"height": "12 m"}, {"building:levels": "3"}, {}, {"height": "tall"}]
    shapes = [(polygon(square(2 * at, 4)), {"building": "yes", **one}) for at, one in enumerate(values)]
    return write(tmp_path / "houses.geojson", shapes)


def enter(desk, **values):
    """Enter a mission with labels or buildings, and wait until all of it is read."""
    desk.enter_coarse_mission()
    desk.form.set_state(replace(desk.session.state(), **values))
    desk.wait_planned()


def note(desk, field):
    label = desk.form.findChild(QLabel, f"{field}_note")
    return "" if label.isHidden() else label.text()


@pytest.mark.parametrize(
    ("entries", "field", "said"),
    [
        ({"labels": ("{folder}/gone.gpkg",)}, "labels", "gone.gpkg: no such file"),
        ({"labels": ("{folder}/fields.geojson:fields:colour",)}, "labels", "has no field 'colour', but crop"),
        ({"labels": ("{folder}/fields.geojson:roofs:crop",)}, "labels", "has no layer 'roofs', but fields"),
        ({"labels": ("{folder}/notes.txt",)}, "labels", "notes.txt: "),
        (
            {"labels": ("{folder}/fields.geojson",), "label_order": "rank"},
            "label_order",
            "no layer of labels has this field",
        ),
        ({"buildings": ("{folder}/gone.gpkg",)}, "buildings", "gone.gpkg: no such file"),
        ({"buildings": ("{folder}/houses.geojson:roofs:x",)}, "buildings", "has no layer 'roofs', but houses"),
        (
            {"buildings": ("{folder}/houses.geojson",), "building_height_field": "tallness"},
            "building_height_field",
            "no file of buildings has it, but ",
        ),
    ],
)
def test_what_is_wrong_with_a_file_is_said_at_its_entry(desk, fields, houses, tmp_path, entries, field, said):
    (tmp_path / "notes.txt").write_text("no vector file")
    filled = {
        name: tuple(one.format(folder=tmp_path) for one in value) if isinstance(value, tuple) else value
        for name, value in entries.items()
    }
    enter(desk, elevation=("100",), **filled)
    assert said in desk.message(field)
    assert desk.session.planned is None
    assert note(desk, "labels") == note(desk, "buildings") == ""
    # And is over once the entry is mended.
    desk.form.set_state(replace(desk.session.state(), labels=(), buildings=()))
    desk.wait_planned()
    assert desk.message(field) == ""
    assert desk.session.planned is not None


def test_the_panel_states_what_files_hold(desk, fields, houses, screenshot):
    enter(desk, elevation=("100",), labels=(f"{fields}:crop",), buildings=(houses,))
    assert note(desk, "labels") == (
        "fields: 14 features, 1 repaired (self-crossing), 1 left out (no area or length).\n"
        # With those of walls and roofs.
        "Classes: 6. Features without a value, which are ignored: 3."
    )
    assert note(desk, "buildings") == (
        "houses: 4 features.\n"
        "In the planned area: 1 with a height, 1 with levels, 2 of the default height. "
        "Values of height that cannot be read: 1 (“tall”)."
    )
    desk.show(desk.form.labels)
    desk.form.labels.unfold()
    screenshot("panel-labels-notes")
    # They go with the entries.
    desk.form.set_state(replace(desk.session.state(), labels=(), buildings=()))
    desk.wait_planned()
    assert note(desk, "labels") == note(desk, "buildings") == ""


def test_files_elsewhere_are_noticed(desk, tmp_path):
    there = write(tmp_path / "elsewhere.geojson", [(polygon(square(-5000, 0)), {"height": 3})])
    enter(desk, elevation=("100",), labels=(there,), buildings=(there,))
    assert (desk.message("labels"), desk.message("buildings"), desk.dock.problem.text()) == ("", "", "")
    assert note(desk, "labels").endswith("No label lies in any image.")
    assert note(desk, "buildings").endswith("No building stands in any image.")


def test_reading_reports_its_progress_and_is_cancelled(desk, fields, monkeypatch, screenshot):
    started, go_on = threading.Event(), threading.Event()
    write_index = layers.write_index

    def slow(path, records, reference, about, progress):
        progress(5)
        started.set()
        go_on.wait(60.0)
        return write_index(path, records, reference, about, progress)

    monkeypatch.setattr(layers, "write_index", slow)
    desk.enter_coarse_mission()
    desk.form.set_state(replace(desk.session.state(), labels=(fields,)))
    figures = desk.dock.figures
    desk.wait(lambda: "fields.geojson: 5 of 14 features read" in figures.line.text())
    assert started.is_set()
    screenshot("panel-reading")
    # A press of Capture waits for the plan.
    desk.click(desk.dock.capture)
    figures.line.linkActivated.emit("cancel")
    go_on.set()
    desk.wait_planned()
    assert desk.session.planned is None
    assert figures.problem.text() == "The files of labels and buildings have not been read."
    assert desk.session.runs.idle
    monkeypatch.setattr(layers, "write_index", write_index)
    figures.warnings.linkActivated.emit("read")
    desk.wait_planned()
    assert desk.session.planned is not None
    assert note(desk, "labels")


def drawn(desk, name):
    """Kinds and boxes of the features of a layer of the preview, and its symbols' colours by kind."""
    layer = desk.layer(name)
    renderer = layer.renderer()
    assert isinstance(renderer, QgsCategorizedSymbolRenderer)
    colours = {one.value(): one.symbol().color().name() for one in renderer.categories()}
    return [(one["kind"], one["number"], one.geometry()) for one in layer.getFeatures()], colours


def test_the_preview_shows_labels_and_buildings(desk, fields, houses, screenshot):
    enter(desk, elevation=("100",), labels=(f"{fields}:crop",), buildings=(houses,), line_width_m=8.0)
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    desk.wait(lambda: desk.layer("Labels").featureCount() and not desk.session.planner.busy)
    desk.wait_previewed()
    found, colours = drawn(desk, "Labels")
    assert [number for _, number, _ in found] == [*range(1, 12), 13, 14]
    assert [kind for kind, *_ in found] == [*(["maize", "oats", "ignore"] * 4)[:10], "oats", "road", "tree"]
    assert colours == {
        "maize": "#e69f00",
        "oats": "#56b4e9",
        "road": "#009e73",
        "tree": "#f0e442",
        "ignore": "#ffffff",
    }
    # The line is as wide as on the ground, in the map's metres.
    road = found[-2][2].boundingBox()
    assert road.height() == pytest.approx(8.0 / 0.8177, rel=0.01)
    found, colours = drawn(desk, "Buildings")
    assert [kind for kind, *_ in found] == [
        "with height",
        "with levels",
        "default height (6 m)",
        "default height (6 m)",
    ]
    assert len(set(colours.values())) == 3
    desk.zoom_to_box(desk.session.planned.mission.area.bounds)
    screenshot("preview-labels")
    # They follow the mission, and go with the preview.
    desk.form.set_state(replace(desk.session.state(), buildings=()))
    desk.wait_planned()
    desk.wait_previewed()
    assert "Buildings" not in desk.layer_names()
    assert desk.layer("Labels").featureCount() == 13
    desk.click(desk.dock.preview)
    assert not QgsProject.instance().mapLayersByName("Labels")


def test_many_features_are_drawn_in_part_which_is_stated(desk, tmp_path, monkeypatch):
    for module in (plan_features, preview):
        monkeypatch.setattr(module, "MOST_FEATURES", 6)
    shapes = [(polygon(square(column, row)), {}) for column in range(5) for row in range(5)]
    enter(desk, labels=(write(tmp_path / "many.geojson", shapes),))
    desk.click(desk.dock.preview)
    name = "Labels (the nearest 6 of 25)"
    desk.wait(lambda: name in desk.layer_names() and not desk.session.preview.busy)
    assert desk.layer(name).featureCount() == 6
    # So are their heights.
    desk.form.set_state(replace(desk.session.state(), elevation=("100",), buildings=desk.session.state().labels))
    desk.wait_planned()
    assert note(desk, "buildings") == (
        "many: 25 features.\n"
        "Of the nearest 6 of 25 features in the planned area: 0 with a height, 0 with levels, 6 of the default height."
    )


@pytest.fixture
def city(tmp_path):
    """A CityJSON file with two boxes of ten metres, 20 m apart, in UTM."""
    to_utm = pyproj.Transformer.from_crs(4326, 32616, always_xy=True)
    x0, y0 = (float(round(at)) for at in to_utm.transform((WEST + EAST) / 2.0, (SOUTH + NORTH) / 2.0))
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    vertices, things = [], {}
    for number in range(2):
        first = len(vertices)
        west = x0 + 30.0 * number
        for up in (0.0, 8.0):
            vertices += [[west + x, y0 + y, up] for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))]
        solid = [[[[first + at for at in ring]] for ring in faces]]
        things[f"house{number}"] = {
            "type": "Building",
            "geometry": [{"type": "Solid", "lod": "1", "boundaries": solid}],
        }
    path = tmp_path / "town.city.json"
    content = {
        "type": "CityJSON",
        "version": "1.1",
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/32616"},
        "transform": {"scale": [0.001] * 3, "translate": [0.0] * 3},
        "CityObjects": things,
        "vertices": [[round(1000 * at) for at in place] for place in vertices],
    }
    path.write_text(json.dumps(content))
    return path, (x0, y0), to_utm


def test_buildings_of_cityjson_are_drawn_by_their_roofs(desk, city, houses):
    path, (x0, y0), to_utm = city
    enter(desk, elevation=("100",), buildings=(f"{path}#heights=ground", houses))
    lines = note(desk, "buildings").splitlines()
    assert lines[0] == "town.city.json: 2 buildings."
    assert lines[1] == "houses: 4 features."
    desk.click(desk.dock.preview)
    desk.wait(lambda: bool(desk.group()) and "Buildings" in desk.layer_names() and not desk.session.preview.busy)
    desk.wait(lambda: desk.layer("Buildings").featureCount() == 6)
    found, colours = drawn(desk, "Buildings")
    assert len(colours) == 4
    roofs = [shape for kind, _, shape in found if kind == "of CityJSON"]
    for number, shape in enumerate(roofs):
        # One outline, without the edges between triangles.
        (ring,) = shape.asMultiPolygon()[0]
        assert len(shape.asMultiPolygon()) == 1
        degrees = [(at.x() / 20037508.342789244 * 180.0, at.y()) for at in ring]
        lat = [np.degrees(np.arctan(np.sinh(y / 6378137.0))) for _, y in degrees]
        x, y = to_utm.transform([lon for lon, _ in degrees], lat)
        assert (min(x), max(x)) == pytest.approx((x0 + 30.0 * number, x0 + 30.0 * number + 10.0), abs=0.01)
        assert (min(y), max(y)) == pytest.approx((y0, y0 + 10.0), abs=0.01)
