"""Effects of a real camera in the panel: kinds of cameras, and test shots before and after."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qgis.PyQt.QtWidgets import QComboBox
from terrainav.core.mission.presets import CAMERA_KINDS, camera_kind_values
from terrainav.terrainav_plugin.form.presets import find_camera_kind


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
