"""Rows in the panel: aligned with the area in the background, and where cameras face."""

from __future__ import annotations

import json
import time
from dataclasses import replace

import pytest
from qgis.core import QgsApplication
from terrainav.core.errors import Cancelled
from terrainav.core.mission.flight import alignment
from terrainav.core.mission.flight.pilot import greatest_speed_m_per_s
from terrainav.core.mission.parts import LONGEST_SIDE, SHORTEST
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.compat import QAction
from terrainav.terrainav_plugin.form.state import FormState

from tests.plugin.test_dock_use import type_number
from tests.support.thinning import sampled

RING = [[-89.866, 35.1385], [-89.8585, 35.1425], [-89.8597, 35.1440], [-89.8672, 35.1400]]


def enter_field(desk):
    desk.enter_small_mission()
    lon, lat = zip(*RING)
    desk.form.set_state(
        replace(
            desk.session.state(),
            shape=json.dumps({"type": "polygon", "rings": [RING]}),
            north=str(max(lat)),
            south=str(min(lat)),
            west=str(min(lon)),
            east=str(max(lon)),
            agl=250.0,
        )
    )
    return desk.wait_planned()


def press(desk, way):
    desk.form.flight.align.menu().findChild(QAction, way).trigger()
    desk.wait(lambda: not desk.form.flight.align.isEnabled())
    desk.wait(desk.form.flight.align.isEnabled)


@pytest.mark.parametrize("way", sampled([LONGEST_SIDE, SHORTEST], 3))
def test_rows_are_aligned_and_the_gain_is_said(desk, way):
    before = enter_field(desk)
    press(desk, way)
    azimuth = desk.session.state().row_azimuth_deg
    assert azimuth != 90.0
    if way == LONGEST_SIDE:
        assert azimuth == pytest.approx(57.0, abs=0.5)
    planned = desk.wait_planned()
    assert planned.mission.flight.row_azimuth_deg == azimuth
    gain = round(100 * (1 - planned.summary.flight_distance_m / before.summary.flight_distance_m))
    said = desk.messages()[-1]
    assert said.startswith("Row azimuth")
    assert f"{gain} % shorter than 90°" in said


def test_entries_that_change_meanwhile_are_kept(desk):
    enter_field(desk)
    desk.session.alignment._look(SHORTEST, desk.session.planned)
    type_number(desk.form.flight.entries["row_azimuth_deg"], "12")
    desk.wait(desk.form.flight.align.isEnabled)
    assert desk.session.state().row_azimuth_deg == 12.0
    assert "entries changed" in desk.messages()[-1]


def test_alignment_shows_how_far_it_is_and_can_be_cancelled(desk, monkeypatch, screenshot):
    enter_field(desk)
    align, before = desk.form.flight.align, desk.session.state()

    def search(*arguments):
        go_on = arguments[-1]
        while go_on(0.4):
            time.sleep(0.01)
        raise Cancelled("alignment: stopped")

    monkeypatch.setattr(alignment, "align_rows", search)
    align.menu().findChild(QAction, SHORTEST).trigger()
    desk.wait(lambda: desk.session.alignment.task is not None)
    task = desk.session.alignment.task
    desk.wait(lambda: task.progress() == 40.0)
    assert task in QgsApplication.taskManager().activeTasks()
    assert task.canCancel()
    assert not align.isEnabled()
    screenshot("aligning")
    task.cancel()
    desk.wait(align.isEnabled)
    assert desk.session.state() == before
    assert desk.messages() == []


def test_points_have_no_rows_to_align(desk):
    desk.enter_small_mission()
    points = {"type": "points", "poses": [[35.14, -89.86, 100.0], [35.141, -89.86, 100.0]]}
    box = {"north": "35.141", "south": "35.14", "west": "-89.86", "east": "-89.86"}
    desk.form.set_state(replace(desk.session.state(), shape=json.dumps(points), **box))
    desk.wait_planned()
    press(desk, LONGEST_SIDE)
    assert "points have no rows" in desk.messages()[-1].lower()


def test_cameras_face_what_is_chosen(desk):
    desk.enter_small_mission()
    desk.wait_planned()
    facing = desk.form.flight.entries["facing"]
    assert not facing.azimuth.isVisibleTo(facing)
    desk.choose(facing.choice, "track")
    made = desk.wait_planned()
    assert made.mission.flight.facing == "track"
    assert set(made.plan.frames.quarter_turns.tolist()) <= {1, 3}
    desk.choose(facing.choice, "azimuth")
    assert facing.azimuth.isVisibleTo(facing)
    type_number(facing.azimuth, "45.5")
    assert desk.wait_planned().mission.flight.facing == "45.5"
    assert plan(desk.wait_planned().mission, made.plan.grid).poses.yaw_deg == pytest.approx(45.5)
    # What a mission says in other digits comes out as it went in.
    desk.form.set_state(replace(desk.session.state(), facing="12.3456789"))
    assert desk.session.state().facing == "12.3456789"
    facing.azimuth.setValue(720.0)
    desk.wait(lambda: "must be north, track or an azimuth" in desk.message("facing"))
    desk.form.set_state(replace(desk.session.state(), facing="north"))
    assert desk.wait_planned().mission.flight.facing == "north"


def test_a_margin_is_flown(desk):
    desk.enter_small_mission()
    plain = desk.wait_planned().summary.images
    type_number(desk.form.route.entries["margin_m"], "150")
    made = desk.wait_planned()
    assert made.mission.flight.margin_m == 150.0
    assert made.summary.images > plain
    assert FormState.from_json(desk.session.state().to_json()).margin_m == 150.0


def test_images_that_are_turned_are_captured_and_make_a_mosaic(desk):
    desk.enter_coarse_mission()
    desk.choose(desk.form.flight.entries["facing"].choice, "track")
    made = desk.wait_planned()
    desk.session.capture()
    desk.wait(lambda: desk.session.runs.task is not None)
    desk.wait_for_run()
    images = list((desk.folder / "satellite").glob("*.tif"))
    assert len(images) == len(made.plan)
    assert desk.layer("Satellite images").isValid()
    assert desk.layer("Captured images").featureCount() == len(made.plan)


def test_the_greatest_airspeed_is_entered_and_said(desk):
    desk.enter_small_mission()
    before = desk.wait_planned().mission.flight.airspeed_m_per_s
    desk.click(desk.form.flight.fastest)
    assert "needs a limit of the camera" in desk.messages()[-1]
    assert desk.session.state().airspeed_m_per_s == before
    desk.form.set_state(replace(desk.session.state(), exposure_ms=20.0))
    planned = desk.wait_planned()
    expected = greatest_speed_m_per_s(planned.plan)
    assert expected < before
    desk.click(desk.form.flight.fastest)
    assert desk.wait_planned().mission.flight.airspeed_m_per_s == pytest.approx(expected)
    assert desk.messages()[-1].startswith(f"Airspeed {expected:g} m/s. Greatest speed: ")
    assert "0.5 px of blur in 20 ms" in desk.messages()[-1]
