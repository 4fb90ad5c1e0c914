"""Camera and height in the panel: other terms for the same, presets, and cameras of one's own."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import pytest
from qgis.PyQt.QtCore import Qt, QTimer
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QApplication, QInputDialog, QLineEdit
from terrainav.core.mission.cameras import camera_shelf, shipped_cameras
from terrainav.terrainav_plugin.form.camera import convert_camera, in_unit, settled, shown_gsd
from terrainav.terrainav_plugin.form.mission_form import mission
from terrainav.terrainav_plugin.form.state import FOV_MODES, FormState, in_metres

from tests.support.thinning import sampled

BOX = {"north": "35.16", "west": "-89.9", "south": "35.115", "east": "-89.823"}


def type_number(spin, text):
    """Replace a number, key by key."""
    spin.setFocus()
    spin.selectAll()
    QTest.keyClicks(spin, text)


# --- without widgets


@pytest.mark.parametrize("modes", sampled([pytest.param(modes) for modes in itertools.permutations(FOV_MODES)], 6))
def test_other_terms_never_change_the_camera(modes):
    state = FormState(fov_deg=73.123456789, aspect="1.2345678901234")
    for mode in (*modes, *modes):
        state = settled(state, replace(state, fov_mode=mode), "fov_mode")
        assert state.fov_mode == mode
        assert state.fov_deg == 73.123456789


@pytest.mark.parametrize(
    ("mode", "entries", "half_diagonal"),
    [
        # Of a picture of 3 x 4 x 5: a 5/4 or a 5/3 of the side's tangent, or half the sensor's over the lens.
        ("horizontal", {"fov_typed_deg": 60.0}, math.tan(math.radians(30.0)) * 5.0 / 4.0),
        ("vertical", {"fov_typed_deg": 60.0}, math.tan(math.radians(30.0)) * 5.0 / 3.0),
        ("sensor", {"focal_length_mm": 4.0, "sensor_width_mm": 8.0, "sensor_height_mm": 6.0}, 5.0 / 4.0),
    ],
)
def test_numbers_typed_are_the_mission_s_diagonal(mode, entries, half_diagonal):
    before = convert_camera(FormState(**BOX), mode)
    state = settled(before, replace(before, **entries), next(iter(entries)))
    assert math.tan(math.radians(state.fov_deg) / 2.0) == pytest.approx(half_diagonal, rel=1e-14)
    assert mission(state).camera.fov_deg == state.fov_deg
    # What was typed stays, and another picture shape gives another diagonal.
    wider = settled(state, replace(state, aspect="4.1:3"), "aspect")
    assert {name: getattr(wider, name) for name in entries} == entries
    assert (wider.fov_deg != state.fov_deg) == (mode != "sensor")


def test_sensor_gives_the_picture_its_shape_where_the_two_differ():
    before = convert_camera(FormState(), "sensor")
    rounded = replace(before, sensor_width_mm=6.3, sensor_height_mm=4.7)
    assert settled(before, rounded, "sensor_width_mm").aspect == "4:3"
    other = replace(before, sensor_width_mm=13.2, sensor_height_mm=8.8)
    assert settled(before, other, "sensor_height_mm").aspect == "3:2"


@pytest.mark.parametrize("agl_m", [120.0, 0.1, 1234.5678, 99.9999999999999, 35786000.0])
def test_height_is_the_same_number_again_after_feet(agl_m):
    state = FormState(agl=agl_m)
    for unit in ("ft", "m", "ft", "m"):
        state = settled(state, replace(state, agl_unit=unit), "agl_unit")
        assert state.agl_m == pytest.approx(agl_m, rel=1e-15)
    assert state.agl == agl_m


def test_numbers_in_another_unit_are_short_where_they_can_be():
    assert in_unit(400 * 0.3048, 0.3048) == 400.0
    assert in_unit(0.254, 0.0254) == 10.0
    assert in_metres(in_unit(120.0, 0.3048), 0.3048) == 120.0


@pytest.mark.parametrize("unit", ["m", "ft"])
def test_height_and_ground_per_px_are_each_other_s_inverse(unit):
    one_unit_m, one_gsd_m = (1.0, 0.01) if unit == "m" else (0.3048, 0.0254)
    state = FormState(agl=400.0, agl_unit=unit, image_px=1000)
    # 1000 px along the longer side of 4:3 are 1250 px across the diagonal.
    across_m = 2.0 * 400.0 * one_unit_m * math.tan(math.radians(78.8 / 2.0))
    assert shown_gsd(state) == pytest.approx(across_m / 1250.0 / one_gsd_m, rel=1e-12)
    typed = settled(state, replace(state, height_by="gsd", camera_gsd=shown_gsd(state)), "camera_gsd")
    assert typed.agl == pytest.approx(400.0, rel=1e-12)


def test_what_was_typed_last_stays_when_the_camera_changes():
    by_height = FormState(agl=100.0)
    changed = settled(by_height, replace(by_height, image_px=1280), "image_px")
    assert changed.agl == 100.0
    assert shown_gsd(changed) == pytest.approx(shown_gsd(by_height) / 2.0)
    by_gsd = settled(by_height, replace(by_height, height_by="gsd", camera_gsd=10.0), "camera_gsd")
    changed = settled(by_gsd, replace(by_gsd, image_px=1280), "image_px")
    assert changed.camera_gsd == 10.0
    assert changed.agl == pytest.approx(2.0 * by_gsd.agl)
    wide = settled(changed, replace(changed, fov_deg=100.0), "fov_deg")
    assert wide.camera_gsd == 10.0
    assert wide.agl < changed.agl
    # A height typed then is what counts.
    typed = settled(wide, replace(wide, height_by="agl", agl=50.0), "agl")
    assert (typed.agl, typed.camera_gsd) == (50.0, 0.0)


# --- in the panel


def test_field_of_view_is_typed_in_any_terms(desk):
    desk.enter_small_mission()
    group = desk.form.camera_group
    exact = desk.wait_planned().mission.camera
    for mode in (*FOV_MODES[1:], *FOV_MODES):
        desk.choose(group.fov_mode, mode)
        assert desk.wait_planned().mission.camera == exact
    desk.choose(group.fov_mode, "horizontal")
    assert group.fov_typed.value() == pytest.approx(exact.horizontal_fov_deg, abs=0.005)
    assert not group.fov.isVisibleTo(desk.dock)
    type_number(group.fov_typed, "60")
    camera = desk.wait_planned().mission.camera
    assert camera.horizontal_fov_deg == pytest.approx(60.0, rel=1e-14)
    desk.type_text(desk.form.aspect, "1:1")
    assert desk.wait_planned().mission.camera.horizontal_fov_deg == pytest.approx(60.0, rel=1e-14)
    assert desk.form.camera.currentText() == "Custom"
    desk.choose(group.fov_mode, "diagonal")
    assert group.fov.value() == pytest.approx(desk.wait_planned().mission.camera.fov_deg, abs=0.005)


def test_presets_fill_in_lens_and_sensor_of_their_data_sheets(desk):
    group = desk.form.camera_group
    desk.choose(group.fov_mode, "sensor")
    for index, preset in enumerate(shipped_cameras()):
        desk.form.camera.setCurrentIndex(index)
        desk.form.camera.activated.emit(index)
        assert desk.session.state().fov_deg == preset.camera.fov_deg
        if preset.sensor_mm is not None:
            shown = [group.entries[name].value() for name in ("sensor_width_mm", "sensor_height_mm")]
            assert shown == pytest.approx(preset.sensor_mm, abs=1e-6)
            assert group.entries["focal_length_mm"].value() == pytest.approx(preset.focal_length_mm, abs=1e-6)
        tip = desk.form.camera.itemData(index, Qt.ItemDataRole.ToolTipRole)
        assert preset.source in tip
        assert preset.width_px is None or f"{preset.width_px} × {preset.height_px} px" in tip
        assert desk.session.state().image_px == (preset.image_px or 640)
        assert desk.form.camera.currentText() == preset.name


def test_a_camera_by_name_brings_its_own_pixels_to_a_wanted_ground_per_px(desk):
    """A Mavic 3E with 2 cm flew at 9 m, because the image stayed at 640 px."""
    desk.enter_small_mission()
    type_number(desk.form.camera_gsd, "2")
    at = desk.form.camera.findText("DJI Mavic 3E")
    desk.form.camera.setCurrentIndex(at)
    desk.form.camera.activated.emit(at)
    there = desk.form.state()
    assert (there.image_px, there.camera_gsd) == (5280, 2.0)
    # 5280 px of 2 cm across 17.3 mm behind a lens of 12.29 mm.
    assert there.agl_m == pytest.approx(5280 * 0.02 * 12.29 / 17.3, rel=0.01)
    # With other pixels it is that camera no longer.
    type_number(desk.form.camera_group.entries["image_px"], "640")
    assert desk.form.camera.currentText() == "Custom"


def test_height_follows_the_ground_per_px_that_is_typed(desk):
    desk.enter_small_mission()
    type_number(desk.form.camera_gsd, "25")
    wanted = desk.wait_planned().mission
    assert wanted.camera.gsd_m_per_px(wanted.flight.agl_m, 640) == pytest.approx(0.25, rel=1e-12)
    assert desk.form.agl.value() == pytest.approx(wanted.flight.agl_m, abs=0.005)
    type_number(desk.form.camera_group.entries["image_px"], "320")
    halved = desk.wait_planned().mission
    assert halved.pixels.image_px == 320
    assert halved.flight.agl_m == pytest.approx(wanted.flight.agl_m / 2.0, rel=1e-12)
    assert desk.form.camera_gsd.value() == 25.0
    desk.choose(desk.form.agl_unit, "ft")
    assert desk.form.camera_gsd.suffix() == " in"
    assert desk.form.camera_gsd.value() == pytest.approx(25.0 / 2.54, abs=1e-4)
    assert desk.wait_planned().mission.flight.agl_m == pytest.approx(halved.flight.agl_m, rel=1e-12)
    type_number(desk.form.agl, "300")
    assert desk.wait_planned().mission.flight.agl_m == pytest.approx(91.44)
    type_number(desk.form.camera_group.entries["image_px"], "640")
    assert desk.wait_planned().mission.flight.agl_m == pytest.approx(91.44)


def answer_with(text):
    """Type a text into the dialog that comes next, and accept it."""

    def look():
        dialog = QApplication.activeModalWidget()
        if not isinstance(dialog, QInputDialog):
            QTimer.singleShot(20, look)
            return
        QTest.keyClicks(dialog.findChild(QLineEdit), text)
        QTest.keyClick(dialog, Qt.Key.Key_Return)

    QTimer.singleShot(0, look)


@pytest.fixture
def own(desk):
    """The panel, with the chooser of cameras put back at the end."""
    yield desk
    for preset in camera_shelf().entries:
        desk.form.camera.setCurrentIndex(desk.form.camera.findText(preset.name))
        desk.form.camera_group.remove.trigger()


def test_own_camera_is_saved_chosen_and_removed(own):
    group, chooser = own.form.camera_group, own.form.camera
    assert not group.remove.isEnabled()
    own.form.fov.setValue(50.0)
    own.type_text(own.form.aspect, "5280:3956")
    answer_with("My quad")
    group.save.trigger()
    saved = camera_shelf().entries
    assert [preset.name for preset in saved] == ["My quad"]
    assert (saved[0].camera.fov_deg, saved[0].camera.aspect_ratio) == (50.0, 5280 / 3956)
    assert chooser.currentText() == "My quad"
    own.form.fov.setValue(60.0)
    assert chooser.currentText() == "Custom"
    chooser.setCurrentIndex(chooser.findText("My quad"))
    chooser.activated.emit(chooser.currentIndex())
    assert own.session.state().fov_deg == 50.0
    group.remove.trigger()
    assert camera_shelf().entries == ()
    assert chooser.findText("My quad") < 0
    assert own.form.fov.value() == 50.0


def test_camera_without_a_name_of_its_own_is_refused_at_the_chooser(own):
    answer_with(shipped_cameras()[0].name)
    own.form.camera_group.save.trigger()
    assert "is taken" in own.message("camera")
    assert camera_shelf().entries == ()
    own.form.camera.activated.emit(0)
    assert own.message("camera") == ""


def test_own_camera_keeps_its_lens_and_sensor(own):
    group = own.form.camera_group
    own.choose(group.fov_mode, "sensor")
    for name, text in (("sensor_width_mm", "13.2"), ("sensor_height_mm", "8.8"), ("focal_length_mm", "8.38")):
        type_number(group.entries[name], text)
    assert own.form.aspect.text() == "3:2"
    answer_with("One inch")
    group.save.trigger()
    (saved,) = camera_shelf().entries
    assert (saved.sensor_mm, saved.focal_length_mm) == ((13.2, 8.8), 8.38)
    assert saved.camera.fov_deg == pytest.approx(own.session.state().fov_deg, rel=1e-15)
