"""The mission panel: what is typed becomes a mission, what is wrong is marked in words."""

from __future__ import annotations

import numpy as np
import pytest
from qgis.PyQt.QtWidgets import QApplication
from terrainav.core.mission.cameras import cameras
from terrainav.terrainav_plugin.area import editing
from terrainav.terrainav_plugin.area.editing import describe_area
from terrainav.terrainav_plugin.form import area as entered

from tests.support.thinning import sampled

AGRICENTER = "35.16_-89.90_35.115_-89.823_120"


def test_pasted_coordinates_fill_all_fields(desk):
    QApplication.clipboard().setText(AGRICENTER)
    edit = desk.form.edges["west"]
    edit.setFocus()
    edit.paste()
    assert [edit.text() for edit in desk.form.edges.values()] == ["35.16", "-89.9", "35.115", "-89.823"]
    assert desk.form.agl.value() == 120.0
    assert desk.wait_planned().summary.images > 1500


@pytest.mark.parametrize("text", ["35.16 -89.90 35.115 -89.823", "35.16, \u221289.90, 35.115, \u221289.823, 80"])
def test_other_spellings_are_understood(desk, text):
    desk.form.agl.setValue(80.0)
    desk.form.edges["north"].setText(text)
    assert desk.form.edges["west"].text() == "-89.9"
    assert desk.form.agl.value() == 80.0


def test_unreadable_coordinates_are_marked_until_they_are_right(desk):
    desk.form.edges["north"].setText("35.16_-89.90_35.115_x_120")
    assert "'x' is not a number" in desk.message("north")
    desk.form.edges["north"].setText(AGRICENTER)
    assert desk.message("north") == ""


@pytest.mark.parametrize(
    ("field", "entries", "words"),
    sampled(
        [
            ("north", {"north": "95"}, "latitude 95.0: must be within -90 and 90 degrees"),
            ("west", {"west": "-400"}, "longitude -400.0: must be within -360 and 360 degrees"),
            ("east", {"east": "abc"}, "eastern edge “abc”: must be a number"),
            ("south", {"south": "36"}, "south lies above north"),
            ("fov_deg", {"fov_deg": 180.0}, "field of view 180.0 deg: must be between 0 and 180"),
            ("aspect", {"aspect": "4:0"}, "aspect ratio “4:0”: must be a number"),
            ("aspect", {"aspect": "-1"}, "aspect ratio -1.0: must be above 0"),
            ("agl", {"agl": 0.0}, "height above ground 0 m: must be above 0"),
            ("overlap_along", {"overlap_along": 1.0}, "front overlap 100.0 %: must be at least 0 and below 100"),
            (
                "fov_typed_deg",
                {"fov_mode": "horizontal", "fov_typed_deg": 190.0},
                "horizontal field of view 190.0 deg",
            ),
            ("sensor_width_mm", {"fov_mode": "sensor", "focal_length_mm": 5.0}, "both sides must be above 0"),
            (
                "sensor_width_mm",
                {"fov_mode": "sensor", "focal_length_mm": 5.0, "sensor_width_mm": 9.0, "sensor_height_mm": 3.0},
                "pixels would not be square",
            ),
            (
                "focal_length_mm",
                {"fov_mode": "sensor", "sensor_width_mm": 8.0, "sensor_height_mm": 6.0},
                "focal length 0.0 mm: must be above 0",
            ),
            ("image_px", {"image_px": 0}, "image's longer side 0 px: must be 1 or more"),
            ("camera_gsd", {"height_by": "gsd", "camera_gsd": 0.0}, "must be above 0"),
            ("row_azimuth_deg", {"row_azimuth_deg": 361.0}, "row azimuth 361.0 deg: must be from 0 to 360"),
            ("start", {"start": "tomorrow"}, "start 'tomorrow': must be UTC as 2024-06-21T10:30:00Z"),
            ("zoom", {"resolution": "zoom", "zoom": -1}, "zoom -1: must be 0 or more"),
            ("gsd_m_per_px", {"resolution": "gsd", "gsd_m_per_px": 0.0}, "ground sample distance 0.0 m"),
            ("resize_width_px", {"resize": True, "resize_width_px": 0}, "image size 0 480 3"),
            ("map_types", {"map_types": ()}, "no map type: tick one or more"),
            ("source", {"source": "url-template", "template": ""}, "source is empty"),
            ("yaw_deg", {"yaw_deg": 361.0}, "yaw 361.0 deg: must be from -360 to 360"),
            ("tilt_deg", {"tilt_deg": -200.0}, "tilt -200.0 deg: must be from -180 to 180"),
            ("roll_deg", {"roll_deg": 181.0}, "roll 181.0 deg: must be from -180 to 180"),
            (
                "ground_height_m",
                {"ground_height_m": 9001.0},
                "ground height 9001.0 m: must be from -12000 to 9000",
            ),
            ("error_budget_px", {"error_budget_px": 0.0}, "error budget 0.0 px: must be above 0"),
            (
                "wind_speed_m_per_s",
                {"wind": True, "wind_speed_m_per_s": 15.0},
                "must be below the airspeed, 15.0 m/s",
            ),
            (
                "wind_speed_m_per_s",
                {"wind": True, "wind_speed_m_per_s": -1.0},
                "wind speed -1.0 m/s: must be 0 or more",
            ),
            ("turbulence", {"wind": True, "turbulence": 4.0}, "gusts of 20 m/s must stay below the airspeed"),
            (
                "airspeed_m_per_s",
                {"wind": True, "airspeed_m_per_s": 0.0},
                "airspeed 0.0 m/s: must be from 0.1 to 340",
            ),
        ],
        4,
    ),
)
def test_bad_value_is_marked_at_its_field_only(desk, field, entries, words):
    from dataclasses import replace

    desk.enter_small_mission()
    desk.form.set_state(replace(desk.session.state(), **entries))
    assert words in desk.message(field)
    labels = [label for _, label in desk.form.marks.fields() if label.text()]
    assert len(labels) == 1
    # The link beside the figures leads there.
    desk.dock.figures.warnings.linkActivated.emit("wrong")
    assert labels[0].isVisibleTo(desk.dock)
    assert desk.dock.estimates.text() == ""


def test_unknown_template_is_marked_at_the_source(desk):
    desk.enter_small_mission()
    desk.use_template("https://example.org/{z}/{x}.png")
    desk.wait(lambda: "without {y}" in desk.message("source"))


def test_empty_fields_are_no_errors(desk):
    assert [desk.message(name) for name in ("north", "west", "south", "east")] == [""] * 4
    desk.type_text(desk.form.edges["north"], "35.2")
    assert desk.message("north") == ""
    assert "must be a number" in desk.message("west")


def test_feet_and_metres_are_the_same_height(desk):
    desk.enter_small_mission()
    images = desk.session.planned.summary.images
    desk.choose(desk.form.agl_unit, "ft")
    assert desk.form.agl.value() == pytest.approx(393.7, abs=0.01)
    assert desk.wait_planned().summary.images == images
    desk.choose(desk.form.agl_unit, "m")
    assert desk.form.agl.value() == pytest.approx(120.0, abs=0.005)


def test_camera_presets_fill_in_their_values(desk):
    for index, preset in enumerate(cameras()):
        desk.form.camera.setCurrentIndex(index)
        desk.form.camera.activated.emit(index)
        state = desk.session.state()
        # What a preset is, to the decimals the fields show.
        assert state.fov_deg == pytest.approx(preset.camera.fov_deg, abs=1e-4)
        width, height = (float(part) for part in state.aspect.split(":"))
        assert width / height == preset.camera.aspect_ratio
        assert desk.form.camera.currentText() == preset.name


def test_changed_camera_values_are_own_values(desk):
    desk.form.fov.setValue(50.0)
    assert desk.form.camera.currentText() == "Custom"
    desk.form.fov.setValue(78.8)
    assert desk.form.camera.currentText() == cameras()[0].name


def test_figures_are_those_of_the_last_change(desk):
    desk.enter_small_mission()
    for agl in (119.0, 80.0, 60.0, 100.0):
        desk.form.agl.setValue(agl)
    planned = desk.wait_planned()
    assert planned.mission.flight.agl_m == 100.0
    assert f"{planned.summary.images:,}" in desk.dock.estimates.text()


def test_mission_beyond_the_limit_is_refused_in_words(desk):
    desk.enter_box("60", "-120", "-60", "120")
    desk.form.agl.setValue(1.0)
    desk.wait(lambda: "the limit is 10,000,000" in desk.dock.problem.text())
    assert "“Maximum number of images” of the algorithm “Plan a mission”" in desk.dock.problem.text()
    assert "--" not in desk.dock.problem.text()
    assert desk.dock.problem.isVisibleTo(desk.dock)


def test_hint_leads_through_the_first_use(desk):
    assert "The map is empty" in desk.dock.hint.text()
    from qgis.core import QgsProject, QgsVectorLayer

    QgsProject.instance().addMapLayer(QgsVectorLayer("Point?crs=EPSG:4326", "mine", "memory"))
    assert "Draw a box" in desk.dock.hint.text()
    desk.enter_box("35.14", "-89.87", "35.13", "-89.85")
    assert not desk.dock.hint.isVisibleTo(desk.dock)


def test_entries_are_remembered(desk):
    from terrainav.terrainav_plugin.form.state import FormState

    desk.enter_small_mission()
    desk.form.agl.setValue(77.0)
    desk.wait(lambda: not desk.session.memory.pending)
    assert FormState.from_json(desk.session.settings.form) == desk.session.state()


class Written:
    """Settings that count how often the entries are written down."""

    def __init__(self):
        self.texts = []

    def __setattr__(self, name, value):
        if name == "form":
            self.texts.append(value)
        else:
            super().__setattr__(name, value)


def test_entries_are_written_down_once_when_typing_pauses(desk, monkeypatch):
    written = Written()
    monkeypatch.setattr(desk.session.memory, "_settings", written)
    for key in range(20):
        desk.form.agl.setValue(100.0 + key)
    assert written.texts == []
    desk.wait(lambda: len(written.texts) > 0)
    assert written.texts == [desk.session.state().to_json()]
    desk.form.agl.setValue(50.0)
    desk.session.memory.write()
    # What is written down need not be written again.
    assert not desk.session.memory.pending
    assert written.texts[1:] == [desk.session.state().to_json()]


def test_large_shapes_are_looked_at_once_however_much_is_typed(desk, monkeypatch):
    from terrainav.core.mission.areas.area import Points, Polygon

    angles = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)
    ring = tuple(zip((0.01 * np.cos(angles)).tolist(), (0.01 * np.sin(angles)).tolist()))
    poses = tuple((35.0 + 1e-5 * index, -89.0, 120.0) for index in range(2000))
    looks = []
    words, parse = describe_area, entered.parse_json
    made = Points.__post_init__

    def noted(name, act):
        return lambda *values: looks.append(name) or act(*values)

    for area in (Polygon((ring,)), Points(poses)):
        desk.form.area_editing.set_area(area, "enter")
        with monkeypatch.context() as watched:
            watched.setattr(editing, "describe_area", noted("words", words))
            watched.setattr(entered, "parse_json", noted("read", parse))
            watched.setattr(Points, "__post_init__", noted("points", made))
            for key in range(5):
                desk.form.flight.entries["airspeed_m_per_s"].setValue(10.0 + key)
                desk.form.camera_group.entries["image_px"].setValue(500 + key)
            assert looks == []
            desk.form.agl.setValue(desk.form.agl.value() + 1.0)
            # Points at another height are other points, made once.
            assert looks == ([] if isinstance(area, Polygon) else ["points", "words"])
