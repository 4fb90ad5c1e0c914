"""Plans written as files from the panel's menu."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from osgeo import ogr
from qgis.core import Qgis
from qgis.PyQt.QtWidgets import QFileDialog, QMessageBox
from terrainav.core.mission.areas.area import Polygon, Polygons
from terrainav.terrainav_plugin.settings import Settings

from tests.core.mission.wpml_reader import Wpml
from tests.plugin.test_project import choose_in_menu
from tests.support.thinning import sampled


@pytest.fixture
def choose_file(monkeypatch):
    """Choose a file and a kind in the dialog for a file to save."""

    def choose(path, kind=""):
        monkeypatch.setattr(QFileDialog, "getSaveFileName", lambda *_: (str(path), kind))

    return choose


def export(desk):
    choose_in_menu(desk, "Export plan…")
    exporting = desk.session.missions.plan_export
    desk.wait(lambda: not desk.session.planner.busy and not exporting.busy)


@pytest.mark.parametrize(
    ("ending", "one_a_capture"),
    sampled([(".kml", False), (".geojson", True), (".gpkg", True), (".csv", True), (".gpx", False)], 2),
)
def test_plan_is_written_and_read_by_others(desk, tmp_path, choose_file, ending, one_a_capture):
    desk.enter_small_mission()
    plan = desk.wait_planned().plan
    path = tmp_path / f"survey{ending}"
    choose_file(path)
    export(desk)
    assert any(f"Plan exported as survey{ending}." in text for text in desk.messages())
    opened = ogr.Open(str(path))
    assert opened is not None
    assert opened.GetLayerCount() >= 1
    if one_a_capture:
        assert opened.GetLayer(0).GetFeatureCount() == len(plan)


def test_plan_for_qgroundcontrol_says_what_it_cannot_hold(desk, tmp_path, choose_file):
    desk.enter_small_mission()
    desk.wait_planned()
    choose_file(tmp_path / "survey.plan")
    export(desk)
    assert json.loads((tmp_path / "survey.plan").read_text())["fileType"] == "Plan"
    (text,) = (text for text in desk.messages() if "Plan exported as survey.plan." in text)
    assert len(text) > len("Plan exported as survey.plan.")


@pytest.mark.parametrize(
    ("chosen", "kind", "written"),
    [
        ("survey", "Litchi (*.litchi.csv)", "survey.litchi.csv"),
        ("survey.csv", "Litchi (*.litchi.csv)", "survey.litchi.csv"),
        ("survey.csv", "Table (*.csv)", "survey.csv"),
        ("survey.litchi.csv", "Table (*.csv)", "survey.litchi.csv"),
        ("survey 1.5", "GPX route (*.gpx)", "survey 1.5.gpx"),
        ("survey", "", "survey.kml"),
        ("survey", "DJI Pilot 2, FlightHub 2, DJI Fly (*.kmz)", "survey.kmz"),
        ("survey", "QGroundControl survey (*.survey.plan)", "survey.survey.plan"),
        ("field.plan", "QGroundControl survey (*.survey.plan)", "field.survey.plan"),
        ("field.plan", "QGroundControl waypoints (*.plan)", "field.plan"),
        ("field.survey.plan", "QGroundControl waypoints (*.plan)", "field.survey.plan"),
        ("field.kml", "DJI Pilot 2, FlightHub 2, DJI Fly (*.kmz)", "field.kml"),
    ],
)
def test_name_gets_the_ending_of_the_kind(chosen, kind, written):
    from terrainav.terrainav_plugin.missions.plan_export import add_ending

    assert add_ending(Path(chosen), kind) == Path(written)


def test_dialog_opens_where_the_last_plan_went_and_the_message_of_a_success_is_green(desk, tmp_path, monkeypatch):
    opened = []
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()

    def choose(_parent, _title, path, _filters, kind):
        opened.append((Path(path).parent, kind))
        return (str(elsewhere / "survey.plan"), kind) if len(opened) == 1 else ("", "")

    Settings().plan_ending, Settings().plan_folder = ".plan", ""
    monkeypatch.setattr(QFileDialog, "getSaveFileName", choose)
    desk.enter_small_mission()
    desk.wait_planned()
    export(desk)
    (item,) = (item for item in desk.iface.messageBar().items() if "Plan exported" in item.text())
    assert item.level() == Qgis.MessageLevel.Success
    # What the file does not hold stays until it is read.
    assert item.duration() == 0
    export(desk)
    assert opened[1] == (elsewhere, "QGroundControl waypoints (*.plan)")
    elsewhere.joinpath("survey.plan").unlink()
    elsewhere.rmdir()
    export(desk)
    assert opened[2][0] == opened[0][0]


def test_where_a_drone_is_chosen_its_file_is_offered_first(desk, tmp_path, monkeypatch):
    Settings().plan_ending = ""
    offered = []

    def choose(_parent, _title, path, _filters, kind):
        offered.append((Path(path).suffix, kind))
        return (str(tmp_path / "mine.gpx") if len(offered) == 3 else ""), ""

    monkeypatch.setattr(QFileDialog, "getSaveFileName", choose)
    desk.enter_small_mission()
    desk.wait_planned()
    export(desk)
    desk.choose(desk.form.route.entries["drone"], "m30")
    export(desk)
    export(desk)
    # What the user has exported is what comes first from then on.
    export(desk)
    assert offered == [
        (".kml", "Google Earth (*.kml)"),
        *[(".kmz", "DJI Pilot 2, FlightHub 2, DJI Fly (*.kmz)")] * 2,
        (".gpx", "GPX route (*.gpx)"),
    ]


def test_the_button_beside_capture_exports_for_dji(desk, tmp_path, choose_file):
    desk.enter_small_mission()
    plan = desk.wait_planned().plan
    choose_file(tmp_path / "survey.kmz")
    button = desk.dock.export_plan
    assert button.isVisibleTo(desk.dock)
    button.click()
    exporting = desk.session.missions.plan_export
    desk.wait(lambda: not desk.session.planner.busy and not exporting.busy)
    read = Wpml(tmp_path / "survey.kmz")
    assert len(read.marks) == len(plan)
    (text,) = (text for text in desk.messages() if "Plan exported as survey.kmz." in text)
    assert "The file is for the drone Mavic 3E. Not flown yet: " in text


@pytest.mark.parametrize("replaced", [True, False])
def test_a_file_that_the_dialog_did_not_ask_for_is_not_replaced_unasked(
    desk, tmp_path, choose_file, monkeypatch, replaced
):
    desk.enter_small_mission()
    desk.wait_planned()
    (tmp_path / "field.survey.plan").write_text("kept")
    buttons = QMessageBox.StandardButton
    asked = []

    def answer(_parent, _title, text, *_):
        asked.append(text)
        return buttons.Yes if replaced else buttons.No

    monkeypatch.setattr(QMessageBox, "question", answer)
    choose_file(tmp_path / "field.plan", "QGroundControl survey (*.survey.plan)")
    export(desk)
    assert asked == ["field.survey.plan is already there. Replace it?"]
    assert (tmp_path / "field.survey.plan").read_text().startswith("{") is replaced


@pytest.mark.parametrize("replaced", [True, False])
def test_parts_of_a_flight_replace_files_only_when_the_user_says_so(desk, tmp_path, choose_file, monkeypatch, replaced):
    desk.enter_small_mission()
    route = desk.form.route
    route.takeoff.setText("35.1353, -89.8715")
    route.entries["battery_min"].setValue(8.0)
    assert desk.wait_planned().plan.path.sorties > 2
    for number in (1, 2):
        (tmp_path / f"field-{number}.kmz").write_text("kept")
    buttons, asked = QMessageBox.StandardButton, []

    def answer(_parent, _title, text, *_):
        asked.append(text)
        return buttons.Yes if replaced else buttons.No

    monkeypatch.setattr(QMessageBox, "question", answer)
    choose_file(tmp_path / "field.kmz")
    export(desk)
    assert asked == ["2 files, field-1.kmz to field-2.kmz, are already there. Replace them?"]
    assert ((tmp_path / "field-1.kmz").read_bytes() != b"kept") is replaced
    assert (tmp_path / "field-3.kmz").exists() is replaced
    assert any("Plan exported as field-1.kmz" in text for text in desk.messages()) is replaced


def test_a_plan_that_is_there_is_not_made_again(desk, tmp_path, choose_file, monkeypatch):
    desk.enter_small_mission()
    planned = desk.wait_planned()
    asked = []
    monkeypatch.setattr(desk.session.planner, "request", lambda *given: asked.append(given))
    choose_file(tmp_path / "survey.csv")
    export(desk)
    assert asked == []
    assert len((tmp_path / "survey.csv").read_text().splitlines()) == len(planned.plan) + 1


def test_the_dialog_names_programs_and_begins_with_the_last_ending(desk, tmp_path, monkeypatch):
    desk.enter_small_mission()
    desk.wait_planned()
    Settings().plan_ending = ".kml"
    asked = []

    def answer(_parent, _title, path, filters, chosen=""):
        asked.append((Path(path).name, filters.split(";;"), chosen))
        return str(tmp_path / "field.plan"), "QGroundControl survey (*.survey.plan)"

    monkeypatch.setattr(QFileDialog, "getSaveFileName", answer)
    export(desk)
    assert (tmp_path / "field.survey.plan").is_file()
    # Else the second time it is asked whether to replace it.
    (tmp_path / "field.survey.plan").unlink()
    export(desk)
    (first, filters, chosen), (second, _, chosen_then) = asked
    assert "DJI Pilot 2, FlightHub 2, DJI Fly (*.kmz)" in filters
    assert "QGroundControl survey (*.survey.plan)" in filters
    assert (first.endswith(".kml"), chosen) == (True, "Google Earth (*.kml)")
    assert (second, chosen_then) == (first.replace(".kml", ".plan"), "QGroundControl survey (*.survey.plan)")


def test_export_is_off_without_a_plan_and_says_why(desk):
    missions, button = desk.session.missions, desk.dock.export_plan

    def entry():
        missions.menu.aboutToShow.emit()
        return next(one for one in missions.menu.actions() if one.text() == "&Export plan…")

    desk.wait(lambda: not button.isEnabled())
    assert "No area yet" in button.toolTip()
    assert not entry().isEnabled()
    assert "No area yet" in entry().toolTip()
    desk.enter_small_mission()
    desk.wait_planned()
    assert button.isEnabled()
    assert entry().isEnabled()
    desk.type_text(desk.form.agl.lineEdit(), "-5")
    desk.wait(lambda: not button.isEnabled())
    assert desk.form.marks.first_message() in button.toolTip()
    desk.type_text(desk.form.agl.lineEdit(), "100")
    desk.wait(button.isEnabled)
    assert "for drones" in button.toolTip()


def test_what_cannot_be_exported_is_one_line(desk, tmp_path, choose_file):
    desk.enter_small_mission()
    desk.wait_planned()
    choose_file(tmp_path / "nowhere" / "survey.kml")
    (tmp_path / "nowhere").write_text("a file in the way")
    desk.iface.messageBar().clearWidgets()
    export(desk)
    ours = [item.text() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert len(ours) == 1
    assert "survey.kml" in ours[0]
    assert "\n" not in ours[0]


def test_a_flight_too_near_to_the_relief_is_refused_beside_its_entry(desk, tmp_path, choose_file, monkeypatch):
    from terrainav.core.errors import InvalidInput
    from terrainav.core.mission import export as exports

    def write_plan(_plan, path, **_how):
        raise InvalidInput("{0}: comes 3.00 m short at latitude 38.8, longitude -77.1", path.name, field="clearance_m")

    desk.enter_small_mission()
    desk.wait_planned()
    monkeypatch.setattr(exports, "write_plan", write_plan)
    choose_file(tmp_path / "survey.plan")
    export(desk)
    text = "survey.plan: comes 3.00 m short at latitude 38.8, longitude -77.1"
    assert any(text in said for said in desk.messages())
    assert text in desk.session.dock.form.marks.message("clearance_m")
    assert list(tmp_path.glob("survey*")) == []


def test_the_message_and_the_marks_of_an_export_last_until_the_next_one(desk, tmp_path, choose_file):
    desk.enter_small_mission()
    corners = (-89.868, 35.132), (-89.868, 35.136), (-89.864, 35.132)
    beside = tuple((lon + 0.007, lat) for lon, lat in corners)
    desk.form.area_editing.set_area(Polygons((Polygon((corners,)), Polygon((beside,)))), "test")
    desk.wait_planned()
    desk.iface.messageBar().clearWidgets()
    choose_file(tmp_path / "two.survey.plan")
    export(desk)
    marks = desk.session.dock.form.marks
    assert "needs an area of one polygon" in marks.first_message()
    for name in ("two.plan", "two.gpx"):
        choose_file(tmp_path / name)
        export(desk)
    assert marks.first_message() == ""
    ours = [item.text() for item in desk.iface.messageBar().items() if item.title() == "TerrAInav"]
    assert len(ours) == 1
    assert "two.gpx" in ours[0]


def test_closed_dialog_writes_nothing(desk, tmp_path, choose_file):
    desk.enter_small_mission()
    desk.wait_planned()
    choose_file("")
    export(desk)
    assert desk.messages() == []
    assert not list(tmp_path.glob("survey*"))
