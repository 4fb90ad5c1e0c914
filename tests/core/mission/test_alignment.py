"""Rows along the longest side of an area, against geodesics, and the shortest flight, against all others planned."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import Cancelled, InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.estimate import estimate, length_text
from terrainav.core.mission.flight.alignment import align_rows, longest_side_deg
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.parts import LONGEST_SIDE
from terrainav.core.mission.plan import plan

GRID = PixelGrid()
GEOD = Geod(ellps="WGS84")
WIDE = Camera(73.7, 4 / 3)


def strip(azimuth, long_m=700.0, wide_m=230.0, extra=()):
    """A rectangle on the ground, its long side at an azimuth; ``extra`` shares of it are corners as well."""
    lon, lat = -89.86, 35.14
    ring = []
    for turn, length in ((0.0, long_m), (90.0, wide_m), (180.0, long_m), (270.0, wide_m)):
        ring.append((lon, lat))
        shares = extra if length == long_m else ()
        ring += [GEOD.fwd(lon, lat, azimuth + turn, share * length)[:2] for share in shares]
        lon, lat, _ = GEOD.fwd(lon, lat, azimuth + turn, length)
    return Polygon((tuple(ring),))


@pytest.mark.parametrize("azimuth", [0.0, 12.5, 57.0, 90.0, 133.3, 179.0])
@pytest.mark.parametrize("extra", [(), (0.3, 0.5)], ids=["sides", "sides in pieces"])
def test_the_longest_side_is_that_of_a_field(azimuth, extra):
    off = (longest_side_deg(strip(azimuth, extra=extra)) - azimuth + 90.0) % 180.0 - 90.0
    assert abs(off) < 0.02


@pytest.mark.parametrize(
    ("box", "azimuth"),
    [
        (Box(35.16, -89.90, 35.15, -89.86), 90.0),
        (Box(35.19, -89.87, 35.15, -89.86), 0.0),
        # As many degrees wide as high, and half as wide on the ground.
        (Box(60.5, 10.0, 60.0, 10.5), 0.0),
        (Box(-12.0, 179.95, -12.05, -179.9), 90.0),
        (Box(35.0, -89.0, 35.0, -89.0), 90.0),
    ],
)
def test_the_longest_side_of_a_box_is_the_longer_one_on_the_ground(box, azimuth):
    assert longest_side_deg(box) == azimuth


@pytest.mark.thorough
def test_no_flight_is_shorter_than_the_shortest():
    field = Polygon((((-89.866, 35.1385), (-89.8585, 35.1425), (-89.8597, 35.1440), (-89.868, 35.1405)),))
    mission = Mission(field, 220.0, WIDE, overlap_across=0.3)
    found = align_rows(mission, GRID)
    others = [
        plan(mission.replace(row_azimuth_deg=float(azimuth)), GRID).direct.distance_m for azimuth in range(0, 180, 15)
    ]
    assert found.made.direct.distance_m <= min(others)
    again = plan(found.mission, GRID)
    assert again.direct.distance_m == found.made.direct.distance_m
    assert found.before.direct.distance_m == plan(mission, GRID).direct.distance_m
    assert found.gain == 1.0 - found.made.direct.distance_m / found.before.direct.distance_m


def test_what_is_gained_is_said():
    mission = Mission(strip(57.0), 120.0, WIDE, overlap_across=0.3)
    found = align_rows(mission, GRID, way=LONGEST_SIDE)
    gain = round(100.0 * (1.0 - found.made.direct.distance_m / found.before.direct.distance_m))
    km = found.made.direct.distance_m / 1000.0
    assert found.text() == f"row azimuth 57°: {found.made.rows} rows, {km:.4g} km, {gain} % shorter than 90°"
    assert found.text(lambda metres: f"{metres:.0f} steps").split(", ")[1] == f"{1000.0 * km:.0f} steps"
    back = align_rows(found.mission.replace(area=strip(90.0)), GRID, way=LONGEST_SIDE)
    assert back.azimuth_deg == pytest.approx(90.0, abs=0.02)
    same = align_rows(found.mission, GRID, way=LONGEST_SIDE)
    assert same.text().endswith("km, as before")
    across = align_rows(mission.replace(row_azimuth_deg=147.0, overlap_across=0.8), GRID, way=LONGEST_SIDE)
    assert ("longer" in across.text()) == (across.gain < 0.0)


@pytest.mark.thorough
def test_what_is_flown_counts_with_its_turns_and_ways_around():
    """Turns that are much longer than the rows between make few rows the shortest flight, whatever lies between."""
    field = Polygon((((-89.866, 35.1385), (-89.8585, 35.1425), (-89.8597, 35.1440), (-89.868, 35.1405)),))
    forbidden = (Polygon((((-89.864, 35.1405), (-89.8635, 35.1405), (-89.8635, 35.141), (-89.864, 35.141)),)),)
    mission = Mission(field, 150.0, WIDE, takeoff=(35.1375, -89.8675), turnaround_m=400.0, no_fly=forbidden)
    found = align_rows(mission, GRID)
    others = [
        plan(mission.replace(row_azimuth_deg=float(azimuth)), GRID).path.distance_m for azimuth in range(0, 180, 45)
    ]
    assert found.made.path.distance_m <= min(others)
    captures_alone = align_rows(mission.replace(takeoff=None, turnaround_m=0.0, no_fly=()), GRID)
    there = plan(mission.replace(row_azimuth_deg=captures_alone.azimuth_deg), GRID).path.distance_m
    assert found.made.path.distance_m < there
    before = plan(mission, GRID).path.distance_m
    assert found.gain == 1.0 - found.made.path.distance_m / before
    said = estimate(found.made).path_m
    assert said is not None
    assert f", {length_text(said)} with turns, {round(100.0 * found.gain)} % shorter than 90°" in found.text()


@pytest.mark.thorough
def test_a_flight_that_is_hardly_longer_is_kept():
    found = align_rows(Mission(strip(57.0), 220.0, WIDE), GRID)
    assert align_rows(found.mission, GRID).mission == found.mission


def test_wind_and_all_else_are_left_as_they_are():
    mission = Mission(strip(57.0), 120.0, WIDE, wind=Wind(3.0, 90.0, 0.1), margin_m=5.0)
    found = align_rows(mission, GRID, way=LONGEST_SIDE)
    assert found.mission == mission.replace(row_azimuth_deg=found.azimuth_deg)
    assert found.made.mission.wind is None


@pytest.mark.parametrize(
    ("mission", "says"),
    [
        (Mission(Points(((35.0, -89.0, 120.0),)), 120.0), "points have no rows"),
        (Mission(strip(57.0), 120.0, layout="paper"), "layout paper is north-up; use --layout cover"),
        (Mission(strip(57.0), 120.0, max_images=2), "the limit is 2"),
    ],
)
def test_what_has_no_rows_to_align_is_refused(mission, says):
    with pytest.raises(InvalidInput, match=says):
        align_rows(mission, GRID)


def test_a_search_can_be_ended():
    shares = []

    def go_on(share):
        shares.append(share)
        return len(shares) < 4

    with pytest.raises(Cancelled):
        align_rows(Mission(strip(57.0), 120.0, WIDE), GRID, go_on=go_on)
    assert len(shares) == 4
    assert np.all(np.diff(shares) > 0.0)
    assert 0.0 <= shares[0] <= shares[-1] < 1.0
