"""Effects of a real camera in the panel: kinds of cameras, and test shots before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qgis.PyQt.QtWidgets import QApplication, QComboBox, QLabel
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.presets import CAMERA_KINDS, camera_kind_values
from terrainav.core.mission.sensors import shipped_sensors
from terrainav.terrainav_plugin.form.mission_form import FormError, mission, mission_state
from terrainav.terrainav_plugin.form.presets import find_camera_kind
from terrainav.terrainav_plugin.form.state import FormState
from terrainav.terrainav_plugin.widgets import choose as choose_data

AREA = Box(35.1550, -89.9000, 35.1540, -89.8990)


def kinds(desk):
    return desk.dock.findChild(QComboBox, "camera_kind")


def choose(desk, name):
    """Choose a kind of camera, as a click on its item does."""
    number = kinds(desk).findData(name)
    kinds(desk).setCurrentIndex(number)
    kinds(desk).activated.emit(number)


@pytest.mark.parametrize("kind", CAMERA_KINDS, ids=[kind.name for kind in CAMERA_KINDS])
def test_a_kind_of_camera_fills_in_its_effects_and_no_others(desk, kind):
    desk.enter_coarse_mission()
    desk.form.set_state(replace(desk.session.state(), iso=400.0, tone="linear", vary=("iso=uniform(100,200)",)))
    assert kinds(desk).currentText() == "Custom"
    choose(desk, kind.name)
    state = desk.session.state()
    assert {name: getattr(state, name) for name in camera_kind_values(kind)} == camera_kind_values(kind)
    assert state.vary == ("iso=uniform(100,200)",)
    assert kinds(desk).currentData() == kind.name
    assert find_camera_kind(state) == kind
    planned = desk.wait_planned().plan
    assert planned.mission.sensor.image_sensor == kind.values.get("image_sensor", "")


def test_a_kind_of_camera_is_shown_until_a_value_changes(desk):
    choose(desk, "machine-vision")
    desk.form.realism.entries["f_number"].setValue(8.0)
    assert kinds(desk).currentText() == "Custom"
    desk.form.realism.entries["f_number"].setValue(5.6)
    assert kinds(desk).currentData() == "machine-vision"
    assert "EMVA 1288" in kinds(desk).toolTip()


def test_the_chooser_stays_in_sight_while_other_groups_unfold(desk):
    desk.enter_coarse_mission()
    desk.form.pages.setCurrentIndex(3)
    desk.form.realism.setCollapsed(False)
    QApplication.processEvents()
    page = desk.form.pages.currentWidget()
    page.ensureWidgetVisible(kinds(desk))
    before = page.verticalScrollBar().value()
    choose(desk, "consumer-drone")
    QApplication.processEvents()
    assert not desk.form.route.isCollapsed()
    assert page.verticalScrollBar().value() == before


def test_a_test_shot_has_the_ideal_image_below(desk, screenshot):
    desk.enter_coarse_mission()
    desk.form.pages.setCurrentIndex(3)
    desk.form.realism.setCollapsed(False)
    choose(desk, "consumer-drone")
    desk.wait_planned()
    screenshot("realism-panel")
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    desk.click(desk.dock.test_shot)
    desk.click_map(desk.at(0.4, 0.6))
    desk.wait(lambda: desk.group() is not None)
    desk.wait_for_run()
    real, ideal = (node.layer() for node in desk.group().findLayers())
    screenshot("realism-test-shot")
    assert ideal.name() == f"Ideal t{real.name()[1:]}"
    assert real.extent() == ideal.extent()
    # QGIS draws both; they differ by haze and noise.
    blocks = [layer.dataProvider().block(1, layer.extent(), 80, 60) for layer in (real, ideal)]
    shown = [np.array([[one.value(row, column) for column in range(80)] for row in range(60)]) for one in blocks]
    assert 2.0 < np.abs(shown[0] - shown[1]).mean() < 120.0
    assert np.corrcoef(shown[0].ravel(), shown[1].ravel())[0, 1] > 0.8


def test_a_test_shot_of_an_ideal_camera_is_one_image(desk):
    desk.enter_coarse_mission()
    choose(desk, "ideal")
    desk.wait_planned()
    desk.look_at("EPSG:3857", (-10_010_000, 4_178_000, -9_998_000, 4_187_000))
    desk.click(desk.dock.test_shot)
    desk.click_map(desk.at(0.4, 0.6))
    desk.wait(lambda: desk.group() is not None)
    desk.wait_for_run()
    assert len(desk.group().findLayers()) == 1


@pytest.fixture
def section(desk):
    form = desk.form
    form.pages.setCurrentIndex(3)
    form.realism.setCollapsed(False)
    yield form.realism
    form.realism.setCollapsed(True)


def test_rows_are_shown_for_what_is_chosen(desk, section):
    entries = section.entries
    for name in ("f_number", "metering", "highest_iso", "read_noise_e", "bayer", "airlight", "k1"):
        assert not entries[name].isVisible(), name
    choose_data(entries["exposure"], "iso")
    assert entries["f_number"].isVisible()
    assert entries["highest_iso"].isVisible()
    assert not entries["longest_exposure_ms"].isVisible()
    entries["image_sensor"].setText("custom")
    assert entries["read_noise_e"].isVisible()
    section.distortion.setChecked(True)
    assert entries["k1"].isVisible()
    section.distortion.setChecked(False)
    entries["k1"].setValue(-0.1)
    # What counts stays in sight.
    assert entries["k1"].isVisible()
    desk.form.set_state(FormState())


def test_a_fisheye_has_no_rows_for_what_only_other_lenses_have(desk, section, screenshot):
    entries, only_perspective = section.entries, ("k5", "k6", "p1", "p2")
    section.distortion.setChecked(True)
    assert all(entries[name].isVisible() for name in only_perspective)
    entries["p1"].setValue(0.01)
    choose_data(entries["lens"], "fisheye")
    assert [name for name in only_perspective if entries[name].isVisible()] == ["p1"]
    desk.wait(lambda: "a fisheye has k1 to k4 only" in desk.form.marks.message("p1"))
    entries["p1"].setValue(0.0)
    assert not any(entries[name].isVisible() for name in only_perspective)
    labels = {label.text() for label in section.findChildren(QLabel) if label.isVisible()}
    assert any("k4" in text for text in labels)
    assert not any(name in text for name in only_perspective for text in labels)
    assert all(entries[name].isVisible() for name in ("k1", "k2", "k3", "k4", "principal_x", "red_scale"))
    screenshot("realism-fisheye")
    choose_data(entries["lens"], "perspective")
    assert all(entries[name].isVisible() for name in only_perspective)
    section.distortion.setChecked(False)
    desk.form.set_state(FormState())


def test_every_image_sensor_is_listed_by_a_click(desk, section):
    line = section.entries["image_sensor"]
    line.setText("FRAMOS IMX900 low gain")
    (arrow,) = (one for one in line.actions() if one.toolTip() == "List the image sensors")
    arrow.trigger()
    popup = line.completer().popup()
    assert popup.isVisible()
    shown = popup.model()
    names = [shown.index(row, 0).data() for row in range(shown.rowCount())]
    assert names == [*(one.name for one in shipped_sensors()), "custom"]
    assert popup.width() > max(map(popup.fontMetrics().horizontalAdvance, names))
    popup.hide()
    desk.form.set_state(FormState())


def test_a_short_message_takes_no_more_room_than_it_needs(desk, section):
    line, message = section.entries["vary"], desk.form.findChild(QLabel, "vary_message")
    heights = []
    for text in ("iso=normal(200,50)", "high=uniform(1,2)", "iso=normal(200,50)"):
        line.setText(text)
        desk.wait_planned()
        QApplication.processEvents()
        heights.append(message.height())
    assert heights[0] == heights[2] < heights[1] / 2
    desk.form.set_state(FormState())


def test_a_lens_that_is_none_is_refused_at_the_entry_that_is_wrong():
    for wrong, entry in (({"lens": "fisheye", "p1": 0.01}, "p1"), ({"k1": -0.9}, "k1")):
        with pytest.raises(FormError) as refused:
            mission(replace(mission_state(Mission(AREA, 100.0), ""), **wrong))
        assert list(refused.value.messages) == [entry]


def test_a_lens_is_kept_from_mission_to_mission(desk, section):
    camera = Camera(70.0, k1=-0.1, p1=0.001, principal_x=0.01, red_scale=0.0005)
    desk.form.set_state(mission_state(Mission(AREA, 100.0, camera), ""))
    assert mission(desk.session.state()).camera == camera
    assert section.entries["k1"].isVisible()
    desk.form.set_state(FormState())


def test_a_lens_that_folds_is_told_at_its_entry(desk, section):
    desk.form.set_state(mission_state(Mission(AREA, 100.0, Camera(70.0)), ""))
    section.entries["k1"].setValue(-3.0)
    desk.wait(lambda: "folds the image" in desk.form.marks.message("k1"))
    desk.form.set_state(FormState())
