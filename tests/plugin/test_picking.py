"""Rows skipped and flights split by clicks on the preview, and several missions exported as one flight."""

from __future__ import annotations

import json

import numpy as np
import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QDialog, QFileDialog
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.plan import plan
from terrainav.core.text.ranges import read_ranges
from terrainav.terrainav_plugin.missions.joined_export import JoinedDialog

from tests.plugin.test_project import choose_in_menu


@pytest.fixture
def previewed(desk):
    desk.look_at("EPSG:4326", (-89.874, 35.128, -89.852, 35.143))
    desk.enter_small_mission()
    route = desk.form.route
    route.unfold()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    return desk


def click_image(desk, row, shift=False, at=0):
    """Click the middle of an image of a row, in the plan with all rows."""
    planned = desk.session.planned
    plan = planned.whole or planned.plan
    index = [number for number, one in enumerate(plan.row.tolist()) if one == row][at]
    click_at(desk, plan, index, shift)


def click_at(desk, plan, index, shift=False):
    tool = desk.canvas.mapTool()
    tool.extends = shift
    lat, lon = (values[index].mean() for values in plan.corners[:2])
    tool.clicked.emit(float(lat), float(lon))
    desk.wait(lambda: not desk.session.planner.busy)


def entry(desk, name):
    return desk.form.route.entries[name]


def test_a_click_skips_a_row_and_another_brings_it_back(previewed, wait_until_drawn, screenshot):
    desk, whole = previewed, previewed.session.planned.plan
    button = desk.form.route.findChild(type(desk.form.route.pick_takeoff), "pick_skip_rows")
    desk.click(button)
    assert desk.canvas.mapTool() is desk.session.picking.rows_tool
    click_image(desk, 1)
    assert entry(desk, "skip_rows").text() == "1"
    desk.wait(lambda: desk.session.planned is not None and desk.session.planned.whole is not None)
    planned = desk.session.planned
    assert len(planned.plan) + planned.plan.in_skipped_rows == len(whole)
    desk.wait_previewed()
    # What is left out is drawn as left out, and nothing else.
    assert desk.session.picking.marked == planned.plan.in_skipped_rows
    assert desk.layer("Planned images").featureCount() == len(planned.plan)
    wait_until_drawn()
    screenshot("skipped-rows")
    click_image(desk, 1)
    assert entry(desk, "skip_rows").text() == ""
    desk.wait(lambda: desk.session.planned is not None and len(desk.session.planned.plan) == len(whole))
    assert desk.session.picking.marked == 0


def test_shift_click_takes_all_rows_and_undo_brings_them_back(previewed):
    desk = previewed
    desk.session.picking.pick_rows()
    click_image(desk, 0)
    click_image(desk, 2, shift=True)
    assert entry(desk, "skip_rows").text() == "0-2"
    history = desk.form.area_editing.history.stack
    history.undo()
    assert entry(desk, "skip_rows").text() == "0"
    history.redo()
    assert entry(desk, "skip_rows").text() == "0-2"
    history.undo()
    history.undo()
    assert entry(desk, "skip_rows").text() == ""


def test_undo_names_the_step_by_what_it_does_to_rows(previewed):
    desk = previewed
    entry(desk, "skip_rows").setText("0,2")
    desk.wait(lambda: desk.session.planned is not None and desk.session.planned.whole is not None)
    desk.session.picking.pick_rows()
    click_image(desk, 1)
    assert entry(desk, "skip_rows").text() == "0-2"
    assert desk.form.area_editing.history.stack.undoText() == "skip rows"


def test_skipped_rows_at_the_antimeridian_are_marked_on_the_map(previewed):
    desk, planned = previewed, previewed.session.planned
    area = Box(0.01, 179.99, -0.01, -179.99)
    mission = planned.mission.replace(area=area, skip_rows="0", source="world")
    whole = plan(mission.replace(skip_rows=""), PixelGrid())
    picking = desk.session.picking
    picking.show(planned._replace(mission=mission, whole=whole))
    assert picking.marked == np.count_nonzero(whole.row == 0)
    assert whole.corners.lon_deg.max() > 180.0
    widths_m = [part.boundingBox().width() for part in picking._mark.asGeometry().asGeometryCollection()]
    assert len(widths_m) >= picking.marked
    assert max(widths_m) < 10_000.0


def test_a_click_beside_the_images_says_so(previewed):
    desk = previewed
    desk.session.picking.pick_rows()
    desk.canvas.mapTool().clicked.emit(0.0, 0.0)
    assert any("There is no row of planned images." in text for text in desk.messages())
    assert entry(desk, "skip_rows").text() == ""


def test_rows_are_not_skipped_elsewhere_when_the_layout_changes(previewed):
    desk = previewed
    entry(desk, "skip_rows").setText("1")
    desk.wait(lambda: desk.session.planned is not None and desk.session.planned.whole is not None)
    # The speed moves no row.
    desk.form.flight.entries["airspeed_m_per_s"].setValue(7.0)
    desk.wait(lambda: not desk.session.planner.busy)
    assert entry(desk, "skip_rows").text() == "1"
    desk.form.flight.entries["row_azimuth_deg"].setValue(30.0)
    desk.wait(lambda: not desk.session.planner.busy)
    assert entry(desk, "skip_rows").text() == ""
    assert any("Cleared because rows and images have new numbers: skipped rows." in text for text in desk.messages())


def test_an_opened_mission_keeps_its_rows(desk, tmp_path):
    desk.enter_small_mission()
    mission = desk.wait_planned().mission
    mission.replace(skip_rows="1").save(tmp_path / "one.json")
    box = mission.area
    other = mission.replace(area=type(box)(box.north_deg + 0.1, box.west_deg, box.south_deg + 0.1, box.east_deg))
    other.replace(skip_rows="1").save(tmp_path / "other.json")
    for name in ("one", "other"):
        desk.session.missions.open_file(tmp_path / f"{name}.json")
        desk.wait_planned()
        assert desk.form.state().skip_rows == "1"


def test_a_click_splits_the_flight_after_an_image(previewed, wait_until_drawn, screenshot):
    desk = previewed
    desk.session.picking.pick_rows()
    desk.session.picking.pick_splits()
    assert any("A split needs a take-off point" in text for text in desk.messages())
    # A click would skip a row.
    assert desk.canvas.mapTool() is not desk.session.picking.rows_tool
    desk.form.route.takeoff.setText("35.1353, -89.8715")
    desk.wait_planned()
    desk.session.picking.pick_splits()
    plan = desk.session.planned.plan
    click_at(desk, plan, 4)
    assert entry(desk, "split_after").text() == "5"
    desk.wait(lambda: desk.session.planned is not None and desk.session.planned.plan.path.sorties == 2)
    desk.wait_previewed()
    lines = list(desk.layer("Flight line").getFeatures())
    assert [line["images"] for line in lines] == [5, len(plan) - 5]
    wait_until_drawn()
    screenshot("split-flight")
    # Skipping a row gives other numbers to images.
    desk.session.picking.pick_rows()
    click_image(desk, 0)
    assert entry(desk, "split_after").text() == ""
    assert read_ranges(entry(desk, "skip_rows").text()) == ((0, 0),)


def test_missions_are_exported_as_one_flight(desk, tmp_path, monkeypatch, screenshot):
    desk.enter_small_mission()
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    first = desk.session.planned.mission
    first.replace(airspeed_m_per_s=7.0).save(tmp_path / "slow.json")
    (tmp_path / "broken.json").write_text("{}")
    shown, refused = [], []

    def accept(dialog):
        ok = dialog.buttons.button(dialog.buttons.StandardButton.Ok)
        # One mission is no flight of several.
        assert not ok.isEnabled()
        dialog.add_files.click()
        refused.extend(text for text in desk.messages() if "broken.json was not opened" in text)
        shown.append([dialog.list.item(at).text() for at in range(dialog.list.count())])
        assert ok.isEnabled()
        dialog.list.item(0).setCheckState(Qt.CheckState.Unchecked)
        assert not ok.isEnabled()
        dialog.list.item(0).setCheckState(Qt.CheckState.Checked)
        dialog.show()
        screenshot("joined-dialog", dialog)
        return QDialog.DialogCode.Accepted

    monkeypatch.setattr(JoinedDialog, "exec", accept)
    files = [str(tmp_path / name) for name in ("slow.json", "broken.json")]
    monkeypatch.setattr(QFileDialog, "getOpenFileNames", lambda *_: (files, ""))
    monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(tmp_path / "flight.plan"), ""))
    choose_in_menu(desk, "Export as one flight…")
    exporting = desk.session.missions.plan_export
    desk.wait(lambda: not exporting.busy)
    assert len(shown[0]) == 2
    assert shown[0][1] == "slow"
    assert len(refused) == 1
    (text,) = (text for text in desk.messages() if "Plan exported as flight.plan." in text)
    assert "Flight path" in text
    assert "between missions" in text
    items = json.loads((tmp_path / "flight.plan").read_text())["mission"]["items"]
    speeds = [item["params"][1] for item in items if item["command"] == 178]
    assert speeds == [first.flight.airspeed_m_per_s, 7.0]
