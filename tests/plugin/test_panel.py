"""The mission panel: presets, headings of folded groups, room on small screens, the list of captures, the start."""

from __future__ import annotations

from dataclasses import replace

import pytest
from qgis.core import QgsProject, QgsVectorLayer
from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QDate, QDateTime, QEvent, QLocale, Qt, QTime
from qgis.PyQt.QtGui import QFocusEvent
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QComboBox, QGroupBox, QLabel
from terrainav.core.mission.cameras import shipped_cameras
from terrainav.core.mission.parts import Flight
from terrainav.core.mission.presets import PRESETS
from terrainav.core.mission.settings import build_mission, resolve
from terrainav.terrainav_plugin.form import mission_form
from terrainav.terrainav_plugin.form.text import aspect_text, parse_aspect, short_aspect, short_degrees
from terrainav.terrainav_plugin.widgets import short_number

from tests.plugin.steps import COARSE, SMALL_BOX
from tests.support.thinning import sampled

BOX = "_".join(SMALL_BOX[edge] for edge in ("north", "west", "south", "east")) + "_120"
#: A small screen, and what QGIS's own menu, toolbars, title and status bar take of it.
SMALL_PX = (1280, 720)


def fold_all(desk, folded):
    """Fold or unfold the groups of each tab."""
    for box in desk.form.boxes:
        desk.show(box)
        box.setCollapsed(folded)


def choose_preset(desk, name):
    """Choose a preset as a person does: also one that is shown already."""
    choice = desk.form.presets.choice
    choice.setCurrentIndex(choice.findData(name))
    choice.activated.emit(choice.currentIndex())


@pytest.mark.parametrize("preset", sampled(PRESETS, 3), ids=lambda preset: preset.name)
def test_panel_and_command_make_the_same_of_a_preset(desk, preset):
    desk.enter_box(**SMALL_BOX)
    choose_preset(desk, preset.name)
    of_command = build_mission(resolve({"coords": BOX, "preset": preset.name}, {}, None))
    assert mission_form.mission(desk.session.state()) == of_command
    assert desk.form.presets.preset == preset
    assert desk.form.presets.choice.toolTip().startswith(f"{preset.note}.")


def test_values_of_a_preset_are_open_to_change_and_then_custom(desk):
    desk.enter_box(**SMALL_BOX)
    before = desk.session.state()
    choose_preset(desk, "learning")
    assert desk.form.aspect.text() == "1:1"
    # Another preset takes the values of the one before it back.
    choose_preset(desk, "mapping")
    state = desk.session.state()
    camera = {"fov_deg": state.fov_deg, "aspect": state.aspect, "image_px": 5280}
    assert state == replace(
        before, overlap_along=0.75, overlap_across=0.65, facing="track", image_format="jpg", resize=False, **camera
    )
    assert desk.form.camera.currentText() == "DJI Mavic 3E"
    assert desk.messages()[-1] == (
        "“For mapping” has set: front overlap, side overlap, camera faces, image format, camera DJI Mavic 3E."
    )
    desk.form.overlap_along.setValue(80.0)
    assert desk.form.presets.choice.currentText() == "Custom"
    assert desk.form.presets.choice.toolTip().startswith("Fills in")
    assert desk.session.state().image_format == "jpg"
    # From values of one's own, the next preset begins with them.
    choose_preset(desk, "learning")
    choose_preset(desk, "navigation")
    assert desk.session.state().aspect == camera["aspect"]


def test_a_survey_takes_the_real_camera_used_last_and_gives_it_back(desk):
    desk.enter_box(**SMALL_BOX)
    before = desk.session.state()
    desk.form.camera.setCurrentText("DJI Mini 2")
    desk.form.camera.activated.emit(desk.form.camera.currentIndex())
    choose_preset(desk, "mapping")
    # A real camera that is entered stays.
    assert desk.form.camera.currentText() == "DJI Mini 2"
    assert "camera DJI" not in desk.messages()[-1]
    desk.form.set_state(before)
    assert desk.form.camera.currentText() != "DJI Mini 2"
    choose_preset(desk, "mapping")
    assert desk.form.camera.currentText() == "DJI Mini 2"
    choose_preset(desk, "navigation")
    assert (desk.session.state().image_px, desk.session.state().fov_deg) == (before.image_px, before.fov_deg)


def test_a_source_of_one_map_type_is_asked_for_no_other(desk):
    desk.enter_box(**SMALL_BOX)
    desk.choose(desk.form.source, "osm")
    choose_preset(desk, "learning")
    assert desk.session.state().map_types == ("roadmap",)
    assert desk.form.presets.choice.currentData() == "learning"


def test_a_folded_group_says_what_it_holds(desk, screenshot):
    desk.enter_small_mission()
    form = desk.form
    form.set_state(replace(form.state(), fov_deg=65.0, overlap_along=0.75, overlap_across=0.65, aspect="3:2"))
    fold_all(desk, False)
    assert [QGroupBox.title(box) for box in (form.camera_group, form.flight, form.wind)] == [
        "Camera",
        "Flight",
        "Wind",
    ]
    fold_all(desk, True)
    assert QGroupBox.title(form.camera_group) == "Camera: 65°, 3:2"
    assert QGroupBox.title(form.flight) == "Flight: 120 m, overlap 75/65 %"
    assert QGroupBox.title(form.wind) == "Wind: off"
    assert QGroupBox.title(form.imagery) == "Imagery: Synthetic (offline)"
    desk.show(form.flight)
    assert form.flight.toolTip() == "Flight: 120 m, overlap 75/65 %"
    assert "Gusts" in form.wind.toolTip()
    assert QGroupBox.title(form.route) == "Flight path: first to last capture"
    # Every group says something.
    assert [box.objectName() for box in form.boxes if ": " not in QGroupBox.title(box)] == []
    desk.show(form.route)
    screenshot("headings", desk.dock)
    route = {"takeoff": "35.13, -89.86", "turnaround_m": 20.0, "battery_min": 25.0, "trigger": "hover"}
    form.set_state(replace(form.state(), **route))
    form.route.setCollapsed(True)
    whole = "Flight path: from the take-off point, Hover and capture, turnaround 20 m, sorties of 25 min"
    assert form.route.toolTip() == whole
    # Where there is no room the title is cut, and the tooltip is not.
    form.set_state(replace(form.state(), folder="/somewhere/" + "long-" * 40, start="2024-06-21T10:30:00Z"))
    title = QGroupBox.title(form.output)
    assert title.startswith("Output: long-")
    assert title.endswith("…")
    assert form.output.fontMetrics().horizontalAdvance(title) <= form.output.width()
    assert "long-" * 40 in form.output.toolTip()
    # A group opens where a value is not the usual one.
    assert QGroupBox.title(form.attitude) == "Attitude, ground and time"
    form.attitude.setCollapsed(True)
    assert form.attitude.toolTip() == "Attitude, ground and time: straight down, 2024-06-21T10:30:00Z"


@pytest.fixture
def small(desk, iface):
    """QGIS on a small screen, with an area drawn over imagery."""
    window = iface.mainWindow()
    before = window.size()
    desk.enter_small_mission()
    for box in desk.form.boxes:
        desk.show(box)
        box.setCollapsed(box in desk.form.sections)
    desk.form.pages.setCurrentIndex(0)
    QgsProject.instance().addMapLayer(QgsVectorLayer("Point?crs=EPSG:4326", "imagery", "memory"))
    window.resize(*SMALL_PX)
    window.resizeDocks([desk.dock], [desk.dock.minimumSizeHint().width()], Qt.Orientation.Horizontal)
    desk.wait_steady(lambda: (desk.dock.width(), desk.dock.height()))
    yield desk
    window.resize(before)
    for box in desk.form.boxes:
        desk.show(box)
        box.setCollapsed(box in desk.form.sections)
    desk.form.pages.setCurrentIndex(0)


def test_settings_have_most_of_a_small_screen_and_need_few_of_them(small, iface, screenshot):
    assert (iface.mainWindow().width(), iface.mainWindow().height()) == SMALL_PX
    form, dock = small.form, small.dock
    screens = 0
    # The way from the area to the button: all tabs but the last, of less common entries.
    for page in form.pages.pages()[:-1]:
        form.pages.setCurrentWidget(page)
        small.wait_steady(page.viewport().height)
        screenshot(f"small-screen-{form.pages.currentIndex()}", iface.mainWindow())
        assert page.viewport().height() >= 0.6 * dock.widget().height()
        screens += -(-page.widget().height() // page.viewport().height())
    assert screens <= 3
    # QGIS's window does not grow beyond the screen for it.
    assert dock.minimumSizeHint().height() < 250


def test_the_angle_of_a_named_camera_is_shown_whole(small):
    form = small.form
    camera = next(one for one in shipped_cameras() if one.name == "DJI Mavic 3E").camera
    form.set_state(replace(small.session.state(), fov_deg=camera.fov_deg))
    form.pages.show_field(form.fov)
    small.wait(form.fov.isVisible)
    line = form.fov.lineEdit()
    assert line.text() == "82.721 °"
    # Also at the panel's least width, beside the arrows.
    needed_px = line.fontMetrics().horizontalAdvance(line.text())
    assert needed_px <= form.fov.minimumWidth() - (form.fov.width() - line.width())
    # Its label stays beside it.
    label = next(
        one for one in form.camera_group.findChildren(QLabel) if one.text().replace("&", "") == "Field of view"
    )
    assert label.mapTo(form, label.rect().center()).x() < form.fov.mapTo(form, form.fov.rect().topLeft()).x()
    middles = (one.mapTo(form, one.rect().center()).y() for one in (label, form.fov))
    assert abs(next(middles) - next(middles)) < 5


def test_nothing_is_cut_at_the_least_width(small):
    form, dock = small.form, small.dock
    fold_all(small, False)
    for page in form.pages.pages():
        form.pages.setCurrentWidget(page)
        small.wait_steady(page.widget().height)
        assert page.widget().width() <= page.viewport().width()
        for box in page.findChildren(QgsCollapsibleGroupBoxBasic):
            assert box.width() >= box.minimumSizeHint().width(), box.objectName()
    # Unfolding shows nothing that is to be hidden.
    assert not form.area.no_fly_words.isVisible()
    bar = form.pages.tabBar()
    assert sum(bar.tabRect(number).width() for number in range(bar.count())) <= form.pages.width()
    for part in (dock.missions, dock.help, dock.preview, dock.test_shot, dock.capture, dock.export_plan):
        assert dock.rect().contains(part.mapTo(dock, part.rect().bottomRight())), part.objectName()
        assert part.width() >= part.minimumSizeHint().width(), part.objectName()
    # The button that is used most is the widest.
    assert dock.capture.width() >= max(part.width() for part in (dock.preview, dock.test_shot, dock.export_plan))


def test_large_letters_scroll_and_stay_whole(small, screenshot):
    form, dock = small.form, small.dock
    points = 2.0 * dock.font().pointSizeF()
    try:
        dock.setStyleSheet(f"* {{ font-size: {points}pt; }}")
        small.wait_steady(lambda: (dock.width(), form.pages.currentWidget().widget().height()))
        for page in form.pages.pages():
            form.pages.setCurrentWidget(page)
            small.wait_steady(page.widget().height)
            screenshot(f"large-letters-{form.pages.currentIndex()}", dock)
            assert page.widget().width() <= page.viewport().width()
            assert page.viewport().height() >= 3 * form.agl.fontMetrics().lineSpacing()
        for part in (dock.preview, dock.test_shot, dock.capture, dock.export_plan):
            assert part.width() >= part.minimumSizeHint().width(), part.objectName()
    finally:
        dock.setStyleSheet("")
        small.wait_steady(dock.width)


def test_warnings_leave_the_settings_their_room(small):
    small.dock.figures.show_problem("What is wrong is said at length. " * 40)
    small.wait_steady(small.form.pages.height)
    page = small.form.pages.currentWidget()
    assert page.viewport().height() >= 0.6 * small.dock.widget().height()


def test_edges_that_are_cut_are_whole_in_their_tooltips(desk, screenshot):
    whole = {"north": "35.1454915269515", "west": "-123.4567891", "south": "35.1", "east": "-123.4"}
    # It is shown to a centimetre.
    desk.form.set_state(replace(desk.session.state(), **whole))
    edges = desk.form.area.edges
    north = edges["north"]
    # What is cut follows from the layout, which settles later.
    desk.wait(lambda: north.text() == whole["north"] or north.toolTip().startswith(f"{whole['north']}\n"))
    desk.wait(lambda: edges["south"].toolTip().startswith("Southern edge"))
    screenshot("edges", desk.dock)
    # Who leaves it sees its first digits.
    for edge in edges.values():
        QApplication.sendEvent(edge, QFocusEvent(QEvent.Type.FocusOut))
    assert [edge.cursorPosition() for edge in edges.values()] == [0] * 4
    # What is cut depends on the room there is.
    least = edges["west"].minimumWidth()
    edges["west"].setFixedWidth(least)
    desk.wait(lambda: edges["west"].toolTip().startswith(f"{whole['west']}\n"))
    screenshot("edges-narrow", desk.dock)
    edges["west"].setFixedWidth(3 * least)
    desk.wait(lambda: edges["west"].toolTip().startswith("Western edge"))
    edges["west"].setMaximumWidth(16_777_215)
    edges["west"].setMinimumWidth(least)


def test_a_start_that_is_taken_back_is_not_set(desk, screenshot):
    form = desk.form
    desk.show(form.attitude)
    form.attitude.setCollapsed(False)
    entry = form.attitude.entries["start"]
    assert entry.edit.lineEdit().text() == "not set"
    form.set_state(replace(form.state(), start="2024-06-21T10:30:00Z"))
    assert entry.edit.lineEdit().text() == "2024-06-21 10:30:00 UTC"
    form.set_state(replace(form.state(), start=Flight.start))
    # And not the present time, which QGIS's entry has when it is cleared.
    assert entry.edit.lineEdit().text() == "not set"
    assert entry.text() == Flight.start
    QTest.qWait(50)
    desk.form.pages.show_field(entry)
    screenshot("start-not-set", desk.dock)


@pytest.mark.thorough
def test_finished_captures_are_cleared_and_their_files_kept(desk):
    desk.form.set_state(replace(desk.session.state(), **COARSE))
    desk.enter_small_mission()
    desk.session.capture()
    desk.wait(lambda: bool(desk.session.runs.runs))
    runs = desk.dock.run_list
    desk.wait_for_run()
    (row,) = runs.rows
    # A single row is removed by its own button.
    assert not runs.clear.isVisible()
    # One line: name and words side by side.
    assert row.title.geometry().center().y() == pytest.approx(row.text.geometry().center().y(), abs=2)
    assert row.height() < 3 * row.fontMetrics().height()
    assert "images captured" in row.text.text()
    assert row.buttons["dismiss"].toolTip() == "Remove from list (files are kept)"
    desk.session.capture()
    desk.wait(lambda: len(desk.session.runs.runs) == 2)
    desk.wait_for_run()
    desk.click(runs.clear)
    assert runs.rows == []
    assert not runs.isVisible()
    assert list((desk.folder / "satellite").glob("*.tif"))


def test_the_start_is_chosen_in_utc_with_the_local_time_beside(desk):
    start = desk.form.attitude.entries["start"]
    assert start.text() == Flight.start
    assert start.edit.isNull()
    assert not start.local.text()
    desk.enter_small_mission()
    # A time that was entered comes back to the last decimal, also beyond what the entry shows.
    desk.form.set_state(replace(desk.session.state(), start="2024-06-21T10:30:00.123456Z"))
    assert desk.session.state().start == "2024-06-21T10:30:00.123456Z"
    assert start.edit.text() == "2024-06-21 10:30:00 UTC"
    local = QDateTime(QDate(2024, 6, 21), QTime(10, 30), Qt.TimeSpec.UTC).toLocalTime()
    assert QLocale().toString(local, QLocale.FormatType.ShortFormat) in start.local.text()
    assert start.local.text().endswith("local time of this computer")
    # Half an hour that clocks skip elsewhere is one like any other.
    start.edit.setDateTime(QDateTime(QDate(2024, 3, 31), QTime(2, 30), Qt.TimeSpec.UTC))
    assert mission_form.mission(desk.session.state()).flight.start == "2024-03-31T02:30:00Z"
    start.edit.clear()
    assert desk.session.state().start == Flight.start


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (330.266666666, 330.27),
        (393.700787401575, 393.7),
        (123.4567, 123.4567),
        (4.62934123456, 4.6293),
        (123456.7891234, 123456.8),
        (7.000000000000001, 7.0),
        (0.0, 0.0),
        (-73.739795291688, -73.74),
    ],
)
def test_numbers_have_the_digits_that_mean_something(value, shown):
    assert short_number(value) == shown


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("1320:989", "1.335"),
        ("4:3", "4:3"),
        ("4000x3000", "4000x3000"),
        ("6000:4000", "6000:4000"),
        ("1.3346814964", "1.335"),
        ("1,5", "1.5"),
        ("x:y", "x:y"),
        ("", ""),
    ],
)
def test_aspect_ratios_are_short(text, shown):
    assert short_aspect(text) == shown


def test_degrees_are_short():
    assert short_degrees("35.1454915269515") == "35.1454915"
    assert short_degrees("-89.86") == "-89.86"
    assert short_degrees("35.14549152x") == "35.14549152x"


@pytest.mark.parametrize("text", ["(35.14180", "x.123456789", "²:³", f"{'9' * 5000}:1", "1.2.345678901"])
def test_what_is_no_number_is_shown_as_it_was_typed(text):
    assert short_aspect(text) == text
    assert short_degrees(text) == text


def test_what_is_shown_short_stays_whole_until_it_is_edited(desk):
    north, ratio = "35.1454915269515", 1320 / 989
    whole = replace(
        desk.session.state(),
        **{**SMALL_BOX, "north": north},
        aspect=aspect_text(ratio),
        agl=393.70078740157,
        fov_deg=73.739795291688,
    )
    desk.form.set_state(whole)
    state = desk.session.state()
    assert (state.north, parse_aspect(state.aspect), state.agl) == (north, ratio, whole.agl)
    assert mission_form.mission(state) == mission_form.mission(whole)
    assert desk.form.edges["north"].text() == "35.1454915"
    assert desk.form.aspect.text() == "1.335"
    assert desk.form.agl.text() == "393.7"
    # Of others an edit says nothing; what is typed counts as typed, even where it reads as before.
    desk.type_text(desk.form.aspect, "1.335")
    assert parse_aspect(desk.session.state().aspect) == 1.335
    assert desk.session.state().north == north
    desk.type_text(desk.form.edges["north"], "35.1454915")
    assert desk.session.state().north == "35.1454915"


def test_a_section_unfolded_on_a_tab_that_is_not_seen_shows_its_entries(desk):
    pixels, entry = desk.form.pixels, desk.form.pixels.findChild(QComboBox, "resolution")
    desk.show(pixels)
    pixels.setCollapsed(False)
    pixels.setCollapsed(True)
    desk.show(desk.form.area)
    pixels.unfold()
    desk.show(pixels)
    desk.wait(entry.isVisible)
    desk.show(desk.form.area)
    pixels.setCollapsed(True)
    desk.show(pixels)
    desk.wait(lambda: not entry.isVisible())
