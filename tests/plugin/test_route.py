"""The flight path in the panel, on the map and in Processing."""

from __future__ import annotations

import numpy as np
import processing
import pytest
from qgis.core import QgsCoordinateReferenceSystem, QgsPointXY, QgsProcessingFeedback, QgsReferencedPointXY

HOME = "35.1353, -89.8715"


@pytest.fixture
def routed(desk):
    desk.look_at("EPSG:4326", (-89.874, 35.128, -89.852, 35.143))
    desk.enter_small_mission()
    route = desk.form.route
    route.unfold()
    route.takeoff.setText(HOME)
    route.entries["turnaround_m"].setValue(40.0)
    route.entries["battery_min"].setValue(15.0)
    desk.click(desk.dock.preview)
    desk.wait_previewed()
    return desk


def test_each_sortie_is_drawn_by_itself_with_its_ways_there_and_back(routed, wait_until_drawn, screenshot):
    planned = routed.session.planned.plan
    path = planned.path
    assert planned.mission.route.takeoff == (35.1353, -89.8715)
    assert path.sorties > 1
    layer = routed.layer("Flight line")
    lines = list(layer.getFeatures())
    assert [line["sortie"] for line in lines] == list(range(1, path.sorties + 1))
    assert sum(line["images"] for line in lines) == len(planned)
    for number, line in enumerate(lines):
        one = path.sortie_path(number)
        (drawn,) = line.geometry().asMultiPolyline()
        assert len(drawn) == len(one)
        assert drawn[0] == drawn[-1]
        assert (line["first_lat"], line["first_lon"]) == (35.1353, -89.8715)
        assert line["length_m"] == pytest.approx(one.distance_m)
        assert line["start"].msecsTo(line["end"]) == pytest.approx(1000.0 * path.sorties_s[number], abs=2.0)
    assert layer.labelsEnabled()
    wait_until_drawn()
    screenshot("route")


def test_the_panel_says_what_a_pilot_needs(routed):
    summary, text = routed.session.planned.summary, routed.dock.figures.estimates.text()
    assert "with turns" in text
    assert f"{len(summary.sorties_s)}: " in text
    assert "of 15 min" in text
    routed.form.route.entries["battery_min"].setValue(0.5)
    routed.wait(lambda: "the way to image 1 and back takes" in routed.message("battery_min"))


def test_a_folded_group_shows_its_whole_title(desk):
    route = desk.form.route
    desk.session.show_dock(True)
    desk.show(route)
    route.setCollapsed(False)
    assert route.minimumHeight() == 0
    route.setCollapsed(True)
    assert route.minimumHeight() >= route.fontMetrics().height() + 5
    assert route.maximumHeight() >= route.minimumHeight()


def test_a_take_off_point_that_was_set_is_shown_from_its_beginning(desk):
    desk.form.area_editing.set_takeoff("35.1310932, -89.8681622", "test")
    assert desk.form.route.takeoff.text() == "35.1310932, -89.8681622"
    assert desk.form.route.takeoff.cursorPosition() == 0


def test_a_wrong_take_off_is_marked_at_its_entry(routed):
    routed.form.route.takeoff.setText("somewhere")
    routed.wait(lambda: "must be a latitude and a longitude" in routed.message("takeoff"))


def test_processing_takes_a_point_in_any_crs():
    place = QgsReferencedPointXY(QgsPointXY(-10_004_455.0, 4_182_600.0), QgsCoordinateReferenceSystem("EPSG:3857"))
    found = processing.run(
        "terrainav:plan",
        {
            "COORDS": "35.141_-89.871_35.130_-89.855_120",
            "TAKEOFF": place,
            "TURNAROUND": 30.0,
            "ENTRY": "nearest",
            "BATTERY": 15.0,
            **dict.fromkeys(("FOOTPRINTS", "CAPTURES", "FLIGHT"), "memory:"),
        },
        feedback=QgsProcessingFeedback(),
    )
    lines = list(found["FLIGHT"].getFeatures())
    assert len(lines) == found["SORTIES"] > 1
    assert found["PATH_M"] == pytest.approx(sum(line["length_m"] for line in lines))
    for line in lines:
        (drawn,) = line.geometry().asMultiPolyline()
        assert np.allclose([drawn[0].x(), drawn[0].y()], [-10_004_455.0, 4_182_600.0], atol=0.01)
