"""Several polygons as one area, and polygons where no camera may stand."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.mission.area import Box, Polygon, Polygons, holds
from terrainav.core.mission.mission import Mission


def square(west, south, size=0.002):
    """A square of degrees."""
    east, north = west + size, south + size
    return Polygon((((west, south), (east, south), (east, north), (west, north)),))


FIELD, OTHER = square(-89.9, 35.1), square(-89.89, 35.11)


def test_a_mission_of_several_polygons_is_the_same_read_again():
    mission = Mission(Polygons((FIELD, OTHER)), 120.0, no_fly=(OTHER,))
    assert Mission.from_json(mission.to_json()) == mission
    data = json.loads(mission.to_json())
    assert data["area"]["type"] == "polygons"
    assert [len(part["rings"][0]) for part in data["area"]["parts"]] == [4, 4]
    assert [one["rings"] for one in data["no_fly"]] == [data["area"]["parts"][1]["rings"]]


def test_a_mission_without_no_fly_polygons_says_nothing_of_them():
    mission = Mission(FIELD, 120.0)
    assert mission.no_fly == ()
    assert "no_fly" not in json.loads(mission.to_json())
    assert mission.with_(no_fly=[OTHER, OTHER]).no_fly == (OTHER,)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"no_fly": {"rings": []}}, "mission field 'no_fly' is"),
        ({"no_fly": [[1.0, 2.0]]}, r"mission field 'no_fly\[0\]'"),
        ({"no_fly": [{"ring": []}]}, r"mission field 'no_fly\[0\].ring': not one of rings"),
        ({"no_fly": [{}]}, "mission without 'rings'"),
        ({"no_fly": [{"rings": [[[0.0]]]}]}, "value of the wrong type"),
        ({"area": {"type": "polygons", "parts": []}}, "area of no polygons"),
        ({"area": {"type": "polygons"}}, "mission without 'parts'"),
        ({"area": {"type": "polygons", "parts": [3]}}, "value of the wrong type"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(wrong, says):
    data = {**Mission(FIELD, 120.0).to_dict(), **wrong}
    with pytest.raises(InvalidInput, match=says):
        Mission.from_dict(data)


@pytest.mark.parametrize(
    ("parts", "bounds"),
    [
        ((FIELD, OTHER), Box(35.112, -89.9, 35.1, -89.888)),
        # The shorter way around the world leads across the antimeridian.
        ((square(-179.0, 10.0), square(178.0, 11.0)), Box(11.002, 178.0, 10.0, -178.998)),
        ((square(179.999, 10.0), square(-179.9, 10.0)), Box(10.002, 179.999, 10.0, -179.898)),
        ((square(179.999, 10.0), square(179.99, 10.0)), Box(10.002, 179.99, 10.0, -179.999)),
        ((square(-180.0, 0.0, 80.0), square(-100.0, 0.0, 200.0 - 120.0)), Box(80.0, -180.0, 0.0, -20.0)),
    ],
)
def test_bounds_are_the_smallest_box_around_all(parts, bounds):
    found = Polygons(parts).bounds
    assert found.edges_deg == pytest.approx(bounds.edges_deg, abs=1e-9)
    assert Polygons(parts[::-1]).bounds.edges_deg == pytest.approx(bounds.edges_deg, abs=1e-9)


def test_parts_that_go_around_the_world_have_all_of_it():
    around = Polygons(tuple(square(west, 0.0, 61.0) for west in range(-180, 180, 60)))
    assert around.bounds.span_deg == 360.0


@given(st.lists(st.tuples(st.floats(-180.0, 179.0), st.floats(0.01, 2.0)), min_size=1, max_size=4))
def test_longitudes_of_all_parts_go_on_from_the_west_of_the_bounds(places):
    area = Polygons(tuple(square(west, 5.0, size) for west, size in places))
    west, _, east, _ = area.bounds.edges_deg
    for shape, part in zip(area.shapes(), area.parts):
        (lon, lat) = shape.arrays()[0]
        assert west - 1e-9 <= lon.min()
        assert lon.max() <= east + 1e-9
        (own, _) = part.arrays()[0]
        assert ((lon - own) % 360.0 == 0.0).all()
        assert holds(shape, lat[:1] + 1e-4, lon[:1] + 1e-4).all()


def test_the_area_is_the_sum_of_the_parts_as_geodesics_measure_it():
    area = Polygons((FIELD, OTHER, FIELD))
    assert area.parts == (FIELD, OTHER)
    whole = sum(
        abs(Geod(ellps="WGS84").polygon_area_perimeter(*zip(*ring))[0])
        for ring in (part.rings[0] for part in area.parts)
    )
    # Their sides are geodesics, the area's are straight in degrees: over 200 m that is nothing.
    assert area.area_m2() == pytest.approx(whole, rel=1e-7)
