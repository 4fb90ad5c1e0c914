"""Attitude, accuracy and wind in the panel: figures, refusals, and missions that come out as they went in."""

from __future__ import annotations

import html
from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtTest import QTest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.methods import bound_text
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import Output
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.form.mission_form import mission, mission_state, refused_fields
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.panel.figures import readout
from terrainav.terrainav_plugin.sources import mission_grid

AREA = Box(35.16, -89.90, 35.115, -89.823)
# Whose map frames are wrong by 0.05 px and whose footprints by less.
HIGH = {"north": "35.16", "west": "-89.90", "south": "35.115", "east": "-89.823"}
HIGH_M = 600.0


def shown(desk):
    """The figures' text, without its marks."""
    text = desk.dock.estimates.text() + desk.dock.figures.details.text()
    return html.unescape(text).replace("\N{NO-BREAK SPACE}", " ")


@pytest.fixture
def high(desk):
    desk.enter_box(**HIGH)
    desk.form.agl.setValue(HIGH_M)
    desk.wait_planned()
    return desk


# --- live figures


def test_smaller_budget_turns_map_frames_into_camera_frames(high):
    assert high.session.planned.plan.frames.on_map
    bound = bound_text(high.session.planned.plan.accuracy.picture.method.bound_px)
    assert f"image: map, ≤ {bound} px" in shown(high)
    assert "of a budget of 0.1 px" in shown(high)
    budget = high.form.accuracy.entries["error_budget_px"]
    budget.setFocus()
    budget.selectAll()
    QTest.keyClicks(budget, "0.02")
    QTest.keyClick(budget, Qt.Key.Key_Return)
    planned = high.wait_planned()
    assert planned.mission.accuracy.error_budget_px == 0.02
    assert planned.plan.frames.largest_px == (640, 480)
    assert "image: camera, ≤" in shown(high)
    assert "of a budget of 0.02 px" in shown(high)
    assert planned.plan.accuracy.bound_px <= 0.02
    # Why not a map frame stands in the tooltip.
    why = html.unescape(high.dock.figures.details.toolTip())
    assert f"not map: its bound of {bound} px" in why
    assert "Condition number" in why
    budget.setValue(0.1)
    assert high.wait_planned().plan.frames.on_map
    assert "image: map" in shown(high)


def test_figures_hold_every_part_of_the_accuracy(high):
    accuracy = high.session.planned.plan.accuracy
    for choice in accuracy.choices:
        assert f"{choice.method.name}, ≤ {bound_text(choice.method.bound_px)} px" in shown(high)
    for what, _ in accuracy.left_out:
        assert what in shown(high)
    assert accuracy.terrain_text() in shown(high)
    assert "(timed here)" in shown(high)


def test_cost_is_said_to_come_until_it_is_there():
    planned = plan(Mission(area=AREA, agl_m=HIGH_M), mission_grid(Mission(area=AREA, agl_m=HIGH_M)))
    assert dict(readout(planned, estimate(planned)).details)["Cost"] == "Measuring…"
    assert dict(readout(planned, estimate(planned), cost="nothing").details)["Cost"] == "nothing"


def test_horizon_is_said_without_numbers_that_are_none():
    there = Mission(area=Points(((35.0, -90.0, 120.0),)), agl_m=120.0, tilt_deg=85.0)
    planned = plan(there, mission_grid(there))
    shown = readout(planned, estimate(planned))
    assert "without limit at the horizon" in dict(shown.details)["Terrain"]
    text = shown.why
    assert "infinite (horizon)" in text
    assert " inf " not in text
    assert "nan" not in text


def test_budget_that_nothing_fits_is_marked_and_can_be_accepted(high):
    high.form.set_state(replace(high.session.state(), error_budget_px=1e-12))
    high.wait(lambda: "no methods fit" in high.message("error_budget_px"))
    # In words of the panel.
    assert "Allow exceeding the error budget" in high.message("error_budget_px")
    assert "--" not in high.message("error_budget_px")
    assert not high.form.accuracy.isCollapsed()
    assert high.dock.estimates.text() == ""
    high.click(high.dock.capture)
    high.wait(lambda: any("no methods fit" in text for text in high.messages()))
    assert high.session.runs.task is None

    high.form.accuracy.entries["accept_error"].setChecked(True)
    planned = high.wait_planned()
    assert high.message("error_budget_px") == ""
    assert planned.plan.accuracy.bound_px > 1e-12
    assert "which is exceeded" in shown(high)


def test_map_frame_of_a_tilted_camera_is_refused_at_the_choice(high):
    high.form.set_state(replace(high.session.state(), tilt_deg=10.0))
    high.choose(high.form.accuracy.entries["frame"], "map")
    high.wait(lambda: "cameras that look straight down" in high.message("frame"))
    assert not high.form.accuracy.entries["resampling"].isEnabled()
    high.choose(high.form.accuracy.entries["frame"], "camera")
    assert high.wait_planned().plan.frames.largest_px == (640, 480)
    assert high.message("frame") == ""
    assert high.form.accuracy.entries["resampling"].isEnabled()


@pytest.mark.parametrize(
    ("entries", "field"),
    [
        ({"tilt_deg": 179.0}, "tilt_deg"),
        ({"error_budget_px": 1e-12}, "error_budget_px"),
        ({"frame": "map", "tilt_deg": 5.0}, "frame"),
        ({"frame": "camera", "source": "google-static"}, "source"),
        (
            {"agl_m": 1.0, "wind": Wind(10.0, 270.0, 1.4), "area": Box(35.14, -89.87, 35.139, -89.869)},
            "turbulence",
        ),
    ],
)
def test_refusals_of_the_core_belong_to_an_entry(entries, field):
    there = Mission(**{"area": AREA, "agl_m": HIGH_M, **entries})
    with pytest.raises(InvalidInput) as refused:
        plan(there, mission_grid(there))
    assert list(refused_fields(refused.value)) == [field]


def test_other_refusals_belong_to_none():
    assert refused_fields(InvalidInput("mission of 9 images: the limit is 8", field="max_images")) == {}
    assert refused_fields(InvalidInput("error budget 3 px: but about no field")) == {}


# --- sections


def test_sections_open_where_there_is_something_to_see(desk):
    attitude, wind = desk.form.attitude, desk.form.wind
    for section in (attitude, wind):
        section.setCollapsed(True)
    desk.form.set_state(replace(desk.session.state(), agl=77.0))
    assert attitude.isCollapsed()
    assert wind.isCollapsed()
    desk.form.set_state(replace(desk.session.state(), roll_deg=5.0, wind=True))
    assert not attitude.isCollapsed()
    assert not wind.isCollapsed()
    attitude.setCollapsed(True)
    desk.form.set_state(replace(desk.session.state(), yaw_deg=1e4))
    assert "must be from -360 to 360" in desk.message("yaw_deg")
    assert not attitude.isCollapsed()


def test_every_entry_says_what_it_is(desk):
    for group in desk.form.groups:
        for name, widget in group.entries.items():
            assert widget.toolTip(), name
    units = {"yaw_deg": "degrees", "ground_height_m": "metres", "airspeed_m_per_s": "metres per second"}
    entries = {name: w for group in desk.form.groups for name, w in group.entries.items()}
    assert all(unit in entries[name].toolTip() for name, unit in units.items())


def test_wind_that_is_not_ticked_is_never_wrong(desk):
    desk.enter_small_mission()
    desk.form.set_state(replace(desk.session.state(), wind=False, wind_speed_m_per_s=99.0))
    assert desk.wait_planned().mission.wind is None
    desk.form.wind.setChecked(True)
    assert "must be below the airspeed" in desk.message("wind_speed_m_per_s")


def test_wind_moves_and_turns_the_captures(desk):
    desk.enter_small_mission()
    desk.form.wind.setChecked(True)
    planned = desk.wait_planned().plan
    assert planned.mission.wind == Wind(5.0, 270.0, 0.2)
    assert planned.frames.largest_px == (640, 480)
    assert planned.nominal is not None
    # The preview holds the images in view, and the map may be anywhere.
    desk.zoom_to_box(planned.mission.area)
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    features = list(desk.layer("Planned images").getFeatures())
    assert len({feature["tilt"] for feature in features}) == len(planned)
    assert [feature["yaw"] for feature in features] == planned.poses.yaw_deg.tolist()


# --- round trips

EVERYTHING = Mission(
    area=Box(35.123456789012, -89.9, 35.1, -89.82345678901),
    agl_m=123.456789,
    camera=Camera(61.23456789, 1.2345678),
    overlap_along=0.123456,
    overlap_across=0.07,
    layout="paper",
    map_types=("terrain", "satellite"),
    zoom=17,
    max_px=1024,
    upsample=True,
    image_format="png",
    img_size=(64, 48, 1),
    seed=7,
    max_images=1000,
    yaw_deg=12.3456789012,
    tilt_deg=-3.25,
    roll_deg=1e-9,
    ground_height_m=-12.3456,
    error_budget_px=1e-13,
    accept_error=True,
    frame="camera",
    mesh="rays",
    resampling="lanczos",
    wind=Wind(3.21, 123.4567, 0.15, 99),
    airspeed_m_per_s=17.5,
    row_azimuth_deg=77.654321099,
    crosshatch=True,
    order="one-way",
    start="2024-06-21T10:30:00.25Z",
)
POLYGON = Polygon((((-89.9, 35.1), (-89.8, 35.1), (-89.85, 35.2)),))


@pytest.mark.parametrize(
    "there",
    [
        EVERYTHING,
        Mission(area=AREA, agl_m=120.0),
        EVERYTHING.replace(zoom=None, gsd_m_per_px=0.3, wind=None),
        EVERYTHING.replace(wind=Wind(3.0, 1.0, 0.1, EVERYTHING.imagery.seed), area=Box(1.0, 179.5, -1.0, -179.5)),
        EVERYTHING.replace(area=POLYGON, source="https://example.org/{z}/{x}/{y}.png"),
        Mission(area=Points(((10.0, 20.0, 100.0), (10.01, 20.0, 200.0))), agl_m=100.0),
        Mission(area=Points(((10.0, 179.9, 100.0), (10.01, -179.9, 200.0))), agl_m=100.0),
    ],
)
def test_mission_comes_out_of_the_panel_as_it_went_in(desk, there):
    text = there.to_json()
    desk.form.set_state(mission_state(Mission.from_json(text), str(desk.folder)))
    assert mission(desk.session.state()).to_json() == text
    # Also after a session's end.
    desk.session.memory.write()
    remembered = FormState.from_json(desk.session.settings.form)
    assert mission(remembered).to_json() == text


def test_one_changed_entry_changes_nothing_else(desk):
    desk.form.set_state(mission_state(EVERYTHING, ""))
    desk.form.attitude.entries["yaw_deg"].setValue(20.0)
    assert mission(desk.session.state()) == EVERYTHING.replace(yaw_deg=20.0)
    desk.form.map_types["satellite"].setChecked(False)
    assert mission(desk.session.state()) == EVERYTHING.replace(yaw_deg=20.0, map_types=("terrain",))


def test_what_the_panel_has_no_entry_for_is_shown_and_can_be_forgotten(desk):
    desk.form.set_state(mission_state(EVERYTHING, ""))
    assert "maximum number of images: 1000" in desk.form.accuracy.more.text()
    assert "mesh: rays" in desk.form.accuracy.more.text()
    desk.form.accuracy.more.linkActivated.emit("forget")
    assert desk.form.accuracy.more.text() == ""
    forgotten = mission(desk.session.state())
    assert (forgotten.output.max_images, forgotten.accuracy.mesh) == (Output.max_images, "auto")
    assert forgotten.attitude.tilt_deg == EVERYTHING.attitude.tilt_deg


def test_another_box_takes_the_place_of_a_polygon():
    state = mission_state(Mission(area=POLYGON, agl_m=120.0), "")
    assert mission(state).area == POLYGON
    state = replace(state, north="35.3")
    assert mission(state).area == Box(35.3, -89.9, 35.1, -89.8)


def test_points_are_planned_and_previewed_from_the_panel(desk):
    there = Mission(area=Points(((35.1, -90.0, 100.0), (35.11, -90.0, 200.0))), agl_m=100.0)
    desk.form.set_state(mission_state(there, str(desk.folder)))
    desk.zoom_to_box(Box(35.12, -90.02, 35.09, -89.98))
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    assert desk.session.planned.mission == there
    assert desk.layer("Planned images").featureCount() == 2


def test_another_height_moves_all_points():
    state = mission_state(Mission(area=Points(((10.0, 20.0, 100.0), (10.01, 20.0, 200.0))), agl_m=100.0), "")
    assert mission(replace(state, agl=50.0)).area.poses == ((10.0, 20.0, 50.0), (10.01, 20.0, 50.0))


def test_seed_of_the_mission_draws_the_background(desk):
    assert mission_state(EVERYTHING, "").seed == 7
    assert FormState().seed == Mission(area=AREA, agl_m=1.0).imagery.seed
