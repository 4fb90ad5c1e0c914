"""Numbers and sentences of a report as people read them."""

from __future__ import annotations

import math

import pytest
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.report.machine import machine, versions
from terrainav.core.report.sentences import condition_text, mission_facts, mission_title, terrain_text
from terrainav.core.report.tables import bytes_text, metres_text, number_text, px_text, seconds_text
from terrainav.core.timing import Seconds
from terrainav.core.world import WorldSource

SOURCE = WorldSource()


def plain(text):
    return text.replace("\u00a0", " ")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.1, "0.1"),
        (12.3, "12"),
        (1.23e-9, "1.2 × 10⁻⁹"),
        (-2e-5, "-2 × 10⁻⁵"),
        (3e12, "3 × 10¹²"),
        (0.000999, "0.001"),
    ],
)
def test_numbers(value, text):
    assert plain(number_text(value)) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0 s"),
        (1.5e-7, "150 ns"),
        (4.321e-5, "43.2 µs"),
        (0.0123, "12.3 ms"),
        (-0.5, "-500 ms"),
        (90.0, "90 s"),
        (600.0, "10 min"),
        (36000.0, "10 h"),
        (None, "–"),
    ],
)
def test_seconds(value, text):
    assert plain(seconds_text(value)) == text


def test_seconds_of_several_rounds_have_their_quartiles_in_one_unit():
    rounds = Seconds((1.2e-3, 0.9e-3, 1.0e-3, 1.4e-3, 0.8e-3))
    assert plain(seconds_text(rounds)) == "1 ms (0.9 to 1.2)"
    assert plain(seconds_text(rounds * 1e-3)) == "1 µs (0.9 to 1.2)"
    assert plain(seconds_text(Seconds((1e-3,)))) == "1 ms"


def test_lengths_bytes_and_pixels():
    assert [plain(metres_text(value)) for value in (2300.0, 4.2, 0.034, 3.1e-3, 5e-6, 2e-9, math.inf)] == [
        "2.3 km",
        "4.2 m",
        "3.4 cm",
        "3.1 mm",
        "5 µm",
        "2 nm",
        "without limit",
    ]
    assert bytes_text(-2500) == "−2.5 kB"
    assert bytes_text(None) == "–"
    assert px_text(math.inf) == "no bound"
    assert px_text(None) == "–"


def test_conditions_and_terrain_are_put_into_words():
    assert "benign" in condition_text(1.4)
    assert "sensitive" in condition_text(27.0)
    assert "ill-conditioned" in condition_text(1e5)
    assert "infinite" in condition_text(math.inf)
    assert "1.7 px, 17 px" in terrain_text(1.7)
    assert "without limit" in terrain_text(math.inf)


@pytest.mark.parametrize(
    ("area", "title"),
    [
        (Box(-16.5, 179.98, -16.502, -179.98), "around 16.5° S, 180° W"),
        (Points(((35.14, -89.86, 120.0),)), "1 image from 120 m, around 35.14° N, 89.86° W"),
        (Points(((0.5, 10.0, 120.0), (0.6, 10.0, 120.0))), "2 images from 120 m, around 0.5° N, 10° E"),
    ],
)
def test_missions_are_put_into_words(area, title):
    worked_out = plan(Mission(area, 120.0, yaw_deg=0.0), SOURCE.grid)
    assert title in mission_title(worked_out)
    facts = dict(mission_facts(worked_out, SOURCE, "satellite"))
    assert "straight down and north-up" in facts["flight"]
    assert "map frames" in facts["images"]
    assert "Synthetic" in facts["source"]
    turned = plan(worked_out.mission.replace(tilt_deg=20.0, yaw_deg=5.0), SOURCE.grid)
    assert "camera turned by yaw 5°, tilt 20°" in dict(mission_facts(turned, SOURCE, "satellite"))["flight"]


def test_the_machine_and_the_software_are_named():
    assert all(value and "/" not in value for _, value in machine())
    assert dict(versions()).keys() == {"TerrAInav", "Python", "numpy", "pyproj", "Pillow"}
    assert "PROJ" in dict(versions())["pyproj"]
