"""Several polygons as one area, and polygons where no camera may stand."""

from __future__ import annotations

import itertools
import json
import math
import re
from fractions import Fraction
from unittest import mock

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.mission.areas import area as area_module
from terrainav.core.mission.areas.area import Box, Points, Polygon, Polygons, polygon_contains
from terrainav.core.mission.estimate import area_text, estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.layout import polygons as polygons_of_layout
from terrainav.core.mission.layout.rows import Layout
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.poses.patterns import structure
from terrainav.core.poses.random_poses import Distribution, PoseDistributions, random_poses
from terrainav.core.poses.settings import Scan

from tests.support.thinning import sampled


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
    assert mission.replace(no_fly=[OTHER, OTHER]).no_fly == (OTHER,)


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
    for shape, part in zip(area.placed(), area.parts):
        (lon, lat) = shape.arrays()[0]
        assert west - 1e-9 <= lon.min()
        assert lon.max() <= east + 1e-9
        (own, _) = part.arrays()[0]
        assert ((lon - own) % 360.0 == 0.0).all()
        assert polygon_contains(shape, lat[:1] + 1e-4, lon[:1] + 1e-4).all()


@pytest.mark.parametrize("chunk", [1, 50, area_module._CHUNK])
def test_places_are_inside_by_the_sum_of_the_angles_that_corners_make(chunk):
    rng = np.random.default_rng(7)
    turns = np.sort(rng.random(60)) * 2.0 * math.pi
    reach = 1.0 + rng.random(60)
    lon, lat = np.round(reach * np.cos(turns), 1), np.round(reach * np.sin(turns), 1)
    shape = Polygon((tuple(zip(lon.tolist(), lat.tolist())),))
    # Many places are at latitudes of corners.
    at_lat, at_lon = np.round(rng.uniform(-2.0, 2.0, 500), 1), rng.uniform(-2.0, 2.0, 500)
    with mock.patch.object(area_module, "_CHUNK", chunk):
        found = polygon_contains(shape, at_lat, at_lon)
    lon, lat = shape.arrays()[0]
    corners = (lon + 1j * lat) - (at_lon + 1j * at_lat)[:, np.newaxis]
    angles = np.angle(np.roll(corners, -1, axis=1) / corners)
    off_sides = (np.abs(angles) < math.pi - 1e-9).all(axis=1)
    assert off_sides.sum() > 480
    winding = np.rint(angles.sum(axis=1) / (2.0 * math.pi)).astype(int)
    np.testing.assert_array_equal(found[off_sides], winding[off_sides] % 2 == 1)


def test_the_area_is_the_sum_of_the_parts_as_geodesics_measure_it():
    area = Polygons((FIELD, OTHER, FIELD))
    assert area.parts == (FIELD, OTHER)
    whole = sum(
        abs(Geod(ellps="WGS84").polygon_area_perimeter(*zip(*ring))[0])
        for ring in (part.rings[0] for part in area.parts)
    )
    # Their sides are geodesics, the area's are straight in degrees: over 200 m that is nothing.
    assert area.area_m2() == pytest.approx(whole, rel=1e-7)


# --- plans

GRID = PixelGrid()
FAR_APART = Polygons((square(-89.9, 35.1, 0.004), square(-89.88, 35.11, 0.004), square(-89.89, 35.1, 0.004)))
#: With a hole, and without a side along a parallel or meridian.
RING = Polygon(
    (
        ((-89.8700, 35.1000), (-89.8640, 35.1015), (-89.8655, 35.1060), (-89.8710, 35.1050)),
        ((-89.8680, 35.1025), (-89.8665, 35.1030), (-89.8670, 35.1040)),
    )
)
LAYOUTS = {
    "cover": {},
    "overlap": {"overlap_along": 0.6, "overlap_across": 0.4},
    "one-way": {"order": "one-way", "overlap_along": 0.3},
    "rotated": {"row_azimuth_deg": 120.0},
    "crosshatch": {"crosshatch": True},
}


def planned(area, **more):
    return plan(Mission(area, 120.0, **more), GRID)


def seen(found, lat, lon):
    """Which places lie in the window of some image, by their pixels at the plan's zoom."""
    world = 256 << found.zoom
    x = (np.mod(lon, 360.0) + 180.0) % 360.0 / 360.0 * world
    y = (1.0 - np.arcsinh(np.tan(np.radians(lat))) / math.pi) / 2.0 * world
    left, top, width, height = (np.asarray(part, np.float64)[:, np.newaxis] for part in found.windows)
    across = np.mod(x - left, world)
    return ((across <= width) & (y >= top) & (y <= top + height)).any(axis=0)


def places_in(polygon, count, seed):
    """Places drawn inside a polygon, held against it by GEOS."""
    ogr = pytest.importorskip("osgeo.ogr")
    text = ",".join("(" + ",".join(f"{lon!r} {lat!r}" for lon, lat in (*ring, ring[0])) + ")" for ring in polygon.rings)
    shape = ogr.CreateGeometryFromWkt(f"POLYGON ({text})")
    west, east, south, north = shape.GetEnvelope()
    found = []
    for u, v in np.random.default_rng(seed).random((40 * count, 2)):
        point = ogr.Geometry(ogr.wkbPoint)
        point.AddPoint_2D(west + u * (east - west), south + v * (north - south))
        if shape.Contains(point):
            found.append((point.GetY(), point.GetX()))
    return np.array(found[:count]).T


@pytest.mark.parametrize("layout", sampled(LAYOUTS, 3))
def test_every_place_of_every_polygon_is_seen(layout):
    area = Polygons((*FAR_APART.parts, RING))
    found = planned(area, **LAYOUTS[layout])
    assert found.coverage.complete
    assert found.coverage.area_m2 == pytest.approx(area.area_m2())
    if not found.passes:
        for polygon in area.parts:
            assert seen(found, *places_in(polygon, 60, 3)).all()


@pytest.mark.parametrize("layout", sampled(LAYOUTS, 3))
def test_each_polygon_has_the_images_that_it_has_alone(layout):
    found = planned(FAR_APART, **LAYOUTS[layout])
    alone = [planned(part, **LAYOUTS[layout]) for part in FAR_APART.parts]
    assert len(found) == sum(map(len, alone))
    assert len(set(zip(found.column.tolist(), found.row.tolist()))) == len(found)
    assert len(set(found.names)) == len(found)
    # Rows go on from polygon to polygon, as these are flown.
    blocks = np.split(found.row, found.parts[1:])
    assert [int(block.min()) for block in blocks[1:]] == [int(block.max()) + 1 for block in blocks[:-1]]
    # Neighbours are those of the same polygon: none of another is taken for one.
    for one in ("least_along", "least_across"):
        least = min(getattr(part.overlap, one) for part in alone)
        assert getattr(found.overlap, one) == pytest.approx(least, abs=0.006)


def test_one_polygon_is_the_mission_of_that_polygon():
    for more in LAYOUTS.values():
        one, other = planned(Polygons((RING,)), **more), planned(RING, **more)
        for values in ("column", "row", "lat_deg", "lon_deg", "edges"):
            np.testing.assert_array_equal(getattr(one, values), getattr(other, values))
        assert one.coverage == other.coverage
        assert one.names == other.names


def way_m(found):
    """Length of a flight, by pyproj."""
    _, _, length = Geod(ellps="WGS84").inv(found.lon_deg[:-1], found.lat_deg[:-1], found.lon_deg[1:], found.lat_deg[1:])
    return float(np.sum(length))


@pytest.mark.parametrize("count", [4, 12])
def test_polygons_along_a_line_are_flown_from_one_end_to_the_other(count):
    line = [square(-89.9 + 0.01 * number, 35.1) for number in range(count)]
    mixed = Polygons(tuple(line[number] for number in np.random.default_rng(5).permutation(count)))
    found = planned(mixed)
    middles = [float(np.mean(lon)) for lon in np.split(found.lon_deg, found.parts[1:])]
    assert middles in (sorted(middles), sorted(middles, reverse=True))


def test_no_other_order_of_few_polygons_is_shorter():
    """All orders of polygons and all ways to fly each of them, one by one."""
    ways = [
        polygons_of_layout._ways(found, (), (0, 1, 2, 3))
        for found in (
            Layout(
                np.tile(np.arange(3), 2),
                np.repeat(np.arange(2), 3),
                35.0 + y * 0.01 + np.repeat([0.001, 0.0], 3),
                -89.0 + x * 0.01 + np.array([0.0, 0.001, 0.002, 0.002, 0.001, 0.0]),
                np.full(6, 120.0),
                np.zeros(6),
            )
            for x, y in ((0, 0), (3, 1), (1, 2), (2, -1))
        )
    ]

    def length(order, chosen):
        places = [(ways[part], way) for part, way in zip(order, chosen)]
        gaps = sum(
            int(np.rint(1000.0 * np.linalg.norm(b.start[j] - a.end[i]))) for (a, i), (b, j) in zip(places, places[1:])
        )
        return gaps + sum(int(one.length[way]) for one, way in places)

    least = min(
        length(order, chosen)
        for order in itertools.permutations(range(4))
        for chosen in itertools.product(range(4), repeat=4)
    )
    found = polygons_of_layout._shortest(ways)
    assert length(*zip(*found)) == least
    nearly = polygons_of_layout._best_ways(ways, polygons_of_layout._improved(polygons_of_layout._gaps(ways)))
    assert length(*zip(*nearly)) <= 1.25 * least


def test_a_flight_over_many_polygons_is_far_shorter_than_in_the_order_given():
    places = np.random.default_rng(11).random((40, 2))
    area = Polygons(tuple(square(-89.9 + 0.1 * x, 35.1 + 0.1 * y, 0.001) for x, y in places))
    found = planned(area)
    given = sum(
        math.dist((a[0] * math.cos(math.radians(35.1)), a[1]), (b[0] * math.cos(math.radians(35.1)), b[1]))
        for a, b in zip(places.tolist(), places[1:].tolist())
    )
    assert len(found.parts) == 40
    assert way_m(found) < 0.6 * given * 0.1 * 111_000.0
    assert found.coverage.complete


@pytest.mark.parametrize("layout", sampled(LAYOUTS, 3))
def test_polygons_on_both_sides_of_the_antimeridian_are_one_flight(layout):
    area = Polygons((square(179.99, 10.0), square(-179.998, 10.0), square(179.999, 10.01)))
    found = planned(area, **LAYOUTS[layout])
    assert np.ptp(found.lon_deg) < 0.03
    assert way_m(found) < 30_000.0
    assert found.coverage.complete
    moved = Polygons(tuple(square(lon, lat) for lon, lat in ((9.99, 10.0), (10.002, 10.0), (9.999, 10.01))))
    assert len(planned(moved, **LAYOUTS[layout])) == len(found)


def test_polygons_that_overlap_are_each_covered_and_counted():
    area = Polygons((square(-89.9, 35.1, 0.004), square(-89.898, 35.1, 0.004)))
    found = planned(area)
    assert found.coverage.complete
    assert found.coverage.area_m2 == pytest.approx(2.0 * square(-89.9, 35.1, 0.004).area_m2())
    assert len(found) == sum(len(planned(part)) for part in area.parts)


def test_the_papers_layout_takes_one_polygon():
    with pytest.raises(InvalidInput, match="layout paper: lays one grid over one polygon"):
        planned(FAR_APART, layout="paper")


def test_wind_and_polygons_go_together():
    found = planned(FAR_APART, wind=Wind(6.0, 270.0, 0.1), overlap_along=0.7, overlap_across=0.6)
    assert len(found.parts) == 3
    assert found.coverage.share > 0.99


# --- no-fly polygons

#: In the middle of the first of the polygons.
FORBIDDEN = square(-89.8990, 35.1008, 0.0015)


@pytest.mark.parametrize("layout", sampled(LAYOUTS, 2))
@pytest.mark.parametrize(
    "area", sampled([FAR_APART, FAR_APART.parts[0], FAR_APART.bounds], 4), ids=["parts", "polygon", "box"]
)
def test_captures_inside_no_fly_polygons_are_left_out_and_no_others(layout, area):
    more = {"overlap_along": 0.5, "overlap_across": 0.5, **LAYOUTS[layout]}
    whole, found = planned(area, **more), planned(area, no_fly=(FORBIDDEN,), **more)
    west, south, east, north = FORBIDDEN.bounds.edges_deg
    lat, lon = whole.lat_deg, whole.lon_deg
    out = (lat > south) & (lat < north) & (lon > west) & (lon < east)
    assert found.left_out == out.sum() > 0
    for values in ("column", "row", "lat_deg", "lon_deg"):
        np.testing.assert_array_equal(getattr(found, values), getattr(whole, values)[~out])
    assert whole.coverage.complete


def test_coverage_tells_what_no_fly_polygons_hold_from_what_they_leave_uncovered():
    found = planned(FAR_APART.parts[0], no_fly=(FORBIDDEN,))
    lat, lon = places_in(FAR_APART.parts[0], 4000, 7)
    west, south, east, north = FORBIDDEN.bounds.edges_deg
    held = (lat > south) & (lat < north) & (lon > west) & (lon < east)
    share = float(seen(found, lat, lon)[~held].mean())
    assert not found.coverage.complete
    assert found.coverage.share == pytest.approx(share, abs=0.01)
    assert found.coverage.no_fly_m2 == pytest.approx(FORBIDDEN.area_m2())
    figures = estimate(found)
    assert figures.to_dict()["images_over_no_fly"] == found.left_out
    assert figures.area_m2 == pytest.approx(FAR_APART.parts[0].area_m2())
    lines = dict(figures.lines())
    held_text = area_text(FORBIDDEN.area_m2())
    assert lines["over no-fly areas"] == f"{found.left_out} images left out, {held_text} of the area"
    assert re.fullmatch(r"[\d.]+ % of the area outside no-fly areas \(.* uncovered\)", lines["coverage"])
    assert "over no-fly areas" not in dict(estimate(planned(FAR_APART.parts[0])).lines())
    # What a polygon elsewhere holds is none of the area.
    away = estimate(planned(FAR_APART.parts[0], no_fly=(square(-89.95, 35.2),)))
    assert dict(away.lines())["coverage"] == "100 % (complete)"


def shape_of(polygons):
    """Union of polygons in GEOS."""
    ogr = pytest.importorskip("osgeo.ogr")
    union = ogr.Geometry(ogr.wkbMultiPolygon)
    for polygon in polygons:
        rings = ("(" + ",".join(f"{lon!r} {lat!r}" for lon, lat in (*ring, ring[0])) + ")" for ring in polygon.rings)
        union = union.Union(ogr.CreateGeometryFromWkt(f"POLYGON ({','.join(rings)})"))
    return union


@pytest.mark.parametrize("layout", sampled(["overlap", "rotated", "crosshatch"], 3))
@pytest.mark.parametrize("part", sampled([RING, RING.bounds], 2), ids=["polygon", "box"])
def test_ground_in_no_fly_polygons_is_that_of_their_union(layout, part):
    """Polygons that share ground, cross the area's sides and its hole, have a hole, and are there twice."""
    west, south, east, north = RING.bounds.edges_deg
    wide, high = east - west, north - south

    def at(*places):
        return tuple((west + x * wide, south + y * high) for x, y in places)

    bow = Polygon((at((-0.2, 0.1), (0.5, 0.35), (0.3, 0.8), (0.1, 0.3)),))
    frame = Polygon(
        (
            at((0.25, 0.2), (0.7, 0.3), (0.6, 0.7), (0.2, 0.6)),
            at((0.35, 0.35), (0.55, 0.4), (0.5, 0.55), (0.3, 0.5)),
        )
    )
    no_fly = (bow, frame, square(west - 1.0, south, 0.5), Polygon((at((0.8, 0.9), (1.3, 1.4), (0.7, 1.2)),)))
    whole, found = (planned(part, no_fly=zones, **LAYOUTS[layout]) for zones in ((), no_fly))
    area = part if isinstance(part, Polygon) else Polygon((at((0, 0), (1, 0), (1, 1), (0, 1)),))
    common = shape_of([area]).Intersection(shape_of(no_fly))
    m2_per_deg2 = part.area_m2() / shape_of([area]).GetArea()
    coverage = found.coverage
    assert coverage.no_fly_m2 == pytest.approx(common.GetArea() * m2_per_deg2, rel=1e-4)
    assert coverage.area_m2 + coverage.no_fly_m2 == pytest.approx(whole.coverage.area_m2, rel=1e-9)
    if not found.passes:
        lat, lon = places_in(area, 3000, 5)
        shown = seen(found, lat, lon)
        ogr = pytest.importorskip("osgeo.ogr")
        inside = np.array(
            [common.Contains(ogr.CreateGeometryFromWkt(f"POINT ({x!r} {y!r})")) for y, x in zip(lat, lon)]
        )
        assert coverage.share == pytest.approx(float(shown[~inside].mean()), abs=0.02)


def test_ground_of_a_polygon_inside_a_no_fly_area_does_not_count_as_uncovered():
    for more in LAYOUTS.values():
        found = planned(FAR_APART, no_fly=(square(-89.891, 35.099, 0.006),), **more)
        assert found.coverage.no_fly_m2 == pytest.approx(FAR_APART.parts[2].area_m2(), rel=1e-6)
        assert found.coverage.complete
        assert len(found.parts) == 3
        assert found.overlap.least_along is not None


def test_a_mission_over_a_no_fly_area_alone_is_refused():
    with pytest.raises(InvalidInput, match=r"all \d+ images lie over no-fly areas; choose another area"):
        planned(FAR_APART, no_fly=(square(-89.95, 35.05, 0.1),))


def test_points_over_no_fly_areas_are_left_out_with_all_that_is_their_own():
    area = Points(
        ((35.1, -89.9, 100.0), (35.1, -89.8, 110.0), (35.1, -89.7, 120.0)),
        (10.0, 20.0, 30.0),
        (0.0, 5.0, 10.0),
        (1.0, 2.0, 3.0),
        (100.0, 200.0, 350.0),
    )
    found = plan(Mission(area, 100.0, no_fly=(square(-89.81, 35.09, 0.02),)), GRID)
    assert found.column.tolist() == [0, 2]
    assert found.agl_m.tolist() == [100.0, 120.0]
    assert [angle.tolist() for angle in found.poses.attitude] == [[10.0, 30.0], [0.0, 10.0], [1.0, 3.0]]
    assert found.times_s.tolist() == [0.0, 250.0]
    assert found.left_out == 1


@pytest.mark.parametrize("west", [179.999, -180.001])
def test_no_fly_polygons_across_the_antimeridian_hold_on_both_sides(west):
    area = Box(10.004, 179.998, 10.0, -179.998)
    found = planned(area, no_fly=(square(west, 9.99, 0.02),), overlap_along=0.5)
    inside_it = (np.mod(found.lon_deg - west, 360.0) < 0.02).any()
    assert found.left_out > 0
    assert not inside_it


def test_wind_blows_on_the_captures_that_are_left():
    more = {"wind": Wind(6.0, 270.0, 0.1), "overlap_along": 0.6}
    found = planned(FAR_APART.parts[0], no_fly=(FORBIDDEN,), **more)
    assert len(found.nominal.lat_deg) == len(found) == len(found.times_s)


@pytest.mark.parametrize("layout", sampled(["cover", "rotated", "crosshatch"], 3))
def test_polygons_in_a_crs_of_the_source_s_own_are_covered_each_by_itself(layout):
    grid = named_source("world", SourceOptions(crs="EPSG:3413")).grid

    def field(west, south):
        east, north = west + 0.03, south + 0.004
        return Polygon((((west, south), (east, south), (east, north), (west, north)),))

    area = Polygons((field(179.99, 80.0), field(-179.9, 80.01), field(179.9, 80.0)))
    found = plan(Mission(area, 120.0, crs="EPSG:3413", **LAYOUTS[layout]), grid)
    assert found.coverage.complete
    assert found.coverage.area_m2 == pytest.approx(area.area_m2())
    assert found.imagery.share == 1.0
    assert np.ptp(found.lon_deg) < 0.3
    left = plan(found.mission.replace(no_fly=(field(179.99, 80.0),)), grid)
    assert left.left_out > 0
    assert left.coverage.no_fly_m2 == pytest.approx(field(179.99, 80.0).area_m2())


@pytest.mark.thorough
def test_polygons_over_relief_share_what_was_asked_for():
    area = Polygons((square(-89.9, 35.1, 0.001), square(-89.8985, 35.1005, 0.001)))
    mission = Mission(area, 60.0, overlap_along=0.5, overlap_across=0.4, elevation=("world",))
    found = plan(mission, GRID, mission_heights(mission, SourceOptions()))
    assert found.coverage.complete
    assert found.overlap.least_along > 0.49
    assert found.overlap.least_across > 0.39
    assert len(found.parts) == 2


def test_rows_of_one_direction_keep_to_it():
    found = planned(FAR_APART, order="one-way", overlap_along=0.3)
    same_row = found.row[1:] == found.row[:-1]
    assert same_row.any()
    assert (np.diff(found.lon_deg)[same_row] > 0.0).all()
    assert (np.diff(found.column)[same_row] == 1).all()


BOW = Polygon((((-89.9, 35.1), (-89.898, 35.102), (-89.898, 35.1), (-89.9, 35.102)),))
OUT_OF_IT = Polygon((FIELD.rings[0], square(-80.0, 35.1).rings[0]))


@pytest.mark.parametrize("read_again", [False, True])
@pytest.mark.parametrize(
    ("area", "no_fly", "says", "field"),
    [
        (
            BOW,
            (),
            r"^area: polygon whose sides cross at latitude 35\.101000, longitude -89\.899000: ",
            "area",
        ),
        (Polygons((FIELD, BOW)), (), r"^area: polygon 2: polygon whose sides cross at latitude 35", "area"),
        (OUT_OF_IT, (), r"^area: polygon with hole 1 outside of it", "area"),
        (FIELD, (BOW,), r"^no-fly areas: polygon whose sides cross", "no_fly"),
        (FIELD, (OTHER, BOW), r"^no-fly areas: polygon 2: polygon whose sides cross", "no_fly"),
    ],
)
def test_polygons_that_tell_no_ground_are_not_planned(area, no_fly, says, field, read_again):
    """However they came into a mission: as values, or in its file."""
    mission = Mission(area, 120.0, no_fly=no_fly)
    if read_again:
        mission = Mission.from_json(mission.to_json())
    with pytest.raises(InvalidInput, match=says) as refused:
        plan(mission, PixelGrid())
    assert refused.value.field == field


def test_nothing_is_flown_inside_or_around_a_bow_tie():
    with pytest.raises(InvalidInput, match="area: polygon whose sides cross"):
        random_poses(BOW, 10, PoseDistributions(Distribution("fixed", 100.0)), seed=1)
    with pytest.raises(InvalidInput, match="outlines: polygon 2: polygon whose sides cross"):
        structure([FIELD, BOW], Camera(), (0.5, 0.5), Scan(20.0, 5.0, 30.0))


def test_crossings_are_those_of_each_pair_of_sides():
    """Of random rings, by exact fractions; also where the pairs are looked at in many parts."""
    generator = np.random.default_rng(5)
    for _ in range(20):
        corners = [(int(x), int(y)) for x, y in generator.integers(0, 1000, (15, 2))]
        ring = Polygon((tuple((x / 1024.0, y / 1024.0) for x, y in corners),))
        places = set()
        for (a, b), (c, d) in itertools.combinations(zip(corners, [*corners[1:], corners[0]]), 2):
            turn = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0])
            if not turn:
                continue
            share = Fraction((c[0] - a[0]) * (d[1] - c[1]) - (c[1] - a[1]) * (d[0] - c[0]), turn)
            other = Fraction((c[0] - a[0]) * (b[1] - a[1]) - (c[1] - a[1]) * (b[0] - a[0]), turn)
            if 0 < share < 1 and 0 < other < 1:
                places.add((float(a[0] + share * (b[0] - a[0])), float(a[1] + share * (b[1] - a[1]))))
        for chunk in (100_000, 3):
            with mock.patch.object(area_module, "_CHUNK", chunk):
                lon, lat = area_module._crossing_places(*area_module.polygon_edges(ring))
            assert sorted(zip(1024.0 * lon, 1024.0 * lat)) == pytest.approx(np.array(sorted(places)), abs=1e-9)
