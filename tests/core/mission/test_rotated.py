"""Turned and crossed rows, against cameras that are traced here once more, through Earth-centred coordinates."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pyproj import Geod, Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.mercator import PixelGrid, u_to_lon, v_to_lat
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.estimate import estimate
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.layout.rotated import rotated_rectangles
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support.thinning import examples, sampled

GRID = PixelGrid(max_zoom=22, native_zoom=22)
GEOD = Geod(ellps="WGS84")
TO_EARTH = Transformer.from_crs(4979, 4978, always_xy=True)
FIELD = Box(35.16, -89.90, 35.13, -89.86)
#: An L with a hole in its corner.
CONCAVE = Polygon(
    (
        (
            (-89.90, 35.16),
            (-89.86, 35.16),
            (-89.86, 35.15),
            (-89.885, 35.15),
            (-89.885, 35.12),
            (-89.90, 35.12),
        ),
        ((-89.897, 35.158), (-89.888, 35.158), (-89.888, 35.152), (-89.897, 35.152)),
    )
)


# Roundings of coordinates in Earth's frame that `image_positions` takes the differences of.
ORACLE_M = 8 * np.finfo(float).eps * 6378137.0


def image_positions(made, index, lon, lat):
    """Where captures (k, 1) see ground points (m,), right and up in half images (k, m, 2); NaN behind the camera."""
    poses = made.poses.take(np.asarray(index))
    ground_m = made.mission.flight.ground_height_m
    camera = np.stack(TO_EARTH.transform(poses.lon_deg, poses.lat_deg, poses.agl_m + ground_m), axis=-1)
    point = np.stack(TO_EARTH.transform(lon, lat, np.full_like(lon, ground_m)), axis=-1)
    sight = point - camera[:, np.newaxis]
    phi, lam = np.radians(poses.lat_deg), np.radians(poses.lon_deg)
    nothing = np.zeros_like(phi)
    east = np.stack([-np.sin(lam), np.cos(lam), nothing], axis=-1)
    up = np.stack([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)], axis=-1)
    north = np.cross(up, east)
    # An aircraft's axes, forward, right and down, turned by yaw, pitch and roll one after the other.
    yaw, pitch, roll = (np.radians(angle)[:, np.newaxis] for angle in poses.attitude)
    forward = np.cos(yaw) * north + np.sin(yaw) * east
    right, down = np.cos(yaw) * east - np.sin(yaw) * north, -up
    forward, down = (
        np.cos(pitch) * forward - np.sin(pitch) * down,
        np.cos(pitch) * down + np.sin(pitch) * forward,
    )
    right, down = np.cos(roll) * right + np.sin(roll) * down, np.cos(roll) * down - np.sin(roll) * right
    x, y, depth = (np.einsum("kmi,ki->km", sight, axis) for axis in (right, forward, down))
    tan_x, tan_y = made.mission.camera.half_tangents
    depth = np.where(depth > 0.0, depth, np.nan)
    return np.stack([x / depth / tan_x, y / depth / tan_y], axis=-1)


def seen_by(made, index, lon, lat):
    """How many of the captures see each ground point, (m,)."""
    with np.errstate(invalid="ignore"):
        return (np.abs(image_positions(made, index, lon, lat)) <= 1.0).all(axis=-1).sum(axis=0)


def inside(area, lon, lat):
    """Even-odd rule."""
    if isinstance(area, Box):
        return np.ones(lon.shape, bool)
    result = np.zeros(lon.shape, bool)
    for ring in area.rings:
        for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1]):
            crosses = (y0 <= lat) != (y1 <= lat)
            with np.errstate(divide="ignore", invalid="ignore"):
                result ^= crosses & (lon < x0 + (lat - y0) * (x1 - x0) / (y1 - y0))
    return result


def places_of(area, count=400, seed=1):
    """Random points of an area, and points of its border."""
    box = area.bounds
    draw = np.random.default_rng(seed)
    lon = box.west_deg + draw.uniform(0, 1, count) * box.span_deg
    lat = draw.uniform(box.south_deg, box.north_deg, count)
    within = inside(area, lon, lat)
    rings = (
        [np.array(ring) for ring in area.rings]
        if isinstance(area, Polygon)
        else [
            np.array([(box.west_deg + east * box.span_deg, north) for east, north in corners])
            for corners in [((0, box.north_deg), (1, box.north_deg), (1, box.south_deg), (0, box.south_deg))]
        ]
    )
    share = np.linspace(0, 1, 25, endpoint=False)[:, np.newaxis]
    border = [start + share * (end - start) for ring in rings for start, end in zip(ring, np.roll(ring, -1, axis=0))]
    return tuple(
        np.concatenate([found, *(part[:, axis] for part in border)])
        for axis, found in ((0, lon[within]), (1, lat[within]))
    )


def passes_of(made):
    ends = [*(part.first for part in made.passes[1:]), len(made)]
    return [np.arange(part.first, end) for part, end in zip(made.passes, ends)]


def ideal_count(made):
    width, height = made.mission.camera.ground_size_m(made.mission.flight.agl_m)
    steps = width * (1 - made.mission.flight.overlap_along) * height * (1 - made.mission.flight.overlap_across)
    return made.mission.area.area_m2() / steps


SCENES = {
    "37": Mission(FIELD, 120.0, row_azimuth_deg=127.0),
    "90": Mission(FIELD, 120.0, row_azimuth_deg=180.0),
    "-90": Mission(FIELD, 120.0, row_azimuth_deg=0.0),
    "180": Mission(FIELD, 120.0, row_azimuth_deg=270.0),
    "overlap": Mission(FIELD, 200.0, row_azimuth_deg=29.0, overlap_along=0.6, overlap_across=0.3),
    "crosshatch": Mission(FIELD, 200.0, crosshatch=True),
    "turned crosshatch": Mission(FIELD, 200.0, crosshatch=True, row_azimuth_deg=102.0, overlap_along=0.2),
    "concave": Mission(CONCAVE, 120.0, row_azimuth_deg=115.0),
    "concave crosshatch": Mission(CONCAVE, 120.0, row_azimuth_deg=115.0, crosshatch=True),
    "antimeridian": Mission(Box(-12.0, 179.98, -12.03, -179.98), 120.0, row_azimuth_deg=120.0),
    "latitude 60": Mission(Box(60.1, 10.0, 60.0, 10.2), 500.0, row_azimuth_deg=160.0),
    "latitude 80": Mission(Box(-80.0, 10.0, -80.3, 12.0), 2000.0, row_azimuth_deg=135.0),
    "tilt": Mission(FIELD, 120.0, row_azimuth_deg=127.0, tilt_deg=35.0, roll_deg=-5.0),
    "yaw across rows": Mission(FIELD, 120.0, row_azimuth_deg=127.0, yaw_deg=30.0),
    "wide": Mission(Box(42.0, 0.0, 40.0, 3.0), 12e3, row_azimuth_deg=110.0),
    "ground height": Mission(FIELD, 120.0, row_azimuth_deg=127.0, ground_height_m=2000.0),
    "a point": Mission(Box(35.0000000001, -89.0000000001, 35.0, -89.0), 120.0, row_azimuth_deg=100.0),
    "a line": Mission(Box(35.0000000001, -89.02, 35.0, -89.0), 120.0, row_azimuth_deg=100.0),
}


@pytest.mark.parametrize("mission", sampled(SCENES.values(), 2), ids=SCENES)
def test_every_place_of_the_area_is_in_a_picture_of_each_pass(mission):
    made = plan(mission, GRID)
    assert made.coverage.complete
    assert not made.frames.on_map
    lon, lat = places_of(mission.area)
    for captures in passes_of(made):
        assert seen_by(made, captures, lon, lat).min() >= 1
    assert len(set(zip(made.column.tolist(), made.row.tolist()))) == len(made)
    assert estimate(made).complete


#: Areas whose sides are bent so much in the plane that their corners stand far from what lies between.
ARCS = {
    "an arc": Mission(Box(80.5, 0.0, 80.3, 90.0), 3000.0, row_azimuth_deg=270.0),
    "a thin arc": Mission(Box(80.5, 0.0, 80.4999, 90.0), 400.0, row_azimuth_deg=270.0),
    "about a pole": Mission(Box(84.9, -70.0, 84.0, 70.0), 8e3, crosshatch=True, error_budget_px=1.0),
}


@pytest.mark.parametrize("mission", sampled({**SCENES, **ARCS}.values(), 2), ids={**SCENES, **ARCS})
def test_what_rows_count_on_is_in_their_pictures(mission):
    made = plan(mission, GRID)
    assert made.coverage.complete
    share = np.linspace(0.0, 1.0, 5)
    for part, captures in zip(made.passes, passes_of(made)):
        left, bottom, right, top = (side[0] for side in part.sides)
        along, up = left + share * (right - left), bottom + share * (top - bottom)
        x = np.concatenate([along, along, np.full(5, left), np.full(5, right)])
        y = np.concatenate([np.full(5, bottom), np.full(5, top), up, up])
        for some in np.array_split(captures[:: max(len(captures) // 1000, 1)], 20):
            here = part.plane.forward(made.lat_deg[some], made.lon_deg[some])
            lat, lon = part.plane.inverse(*(at[:, np.newaxis] + side for at, side in zip(here, (x, y))))
            seen = np.abs(image_positions(made, some, lon, lat))
            assert (seen <= 1.0 + 1e-9).all()


def test_sides_of_an_area_are_cut_alike_whatever_kind_of_numbers_its_corners_are():
    whole = Mission(Box(80, 0, 79, 60), 20e3, row_azimuth_deg=120.0, error_budget_px=1.0)
    real = whole.replace(area=Box(80.0, 0.0, 79.0, 60.0))
    assert len(plan(whole, GRID)) == len(plan(real, GRID)) < 1.7 * ideal_count(plan(real, GRID))


@pytest.mark.parametrize("name", ["37", "90", "-90", "180", "latitude 60", "wide", "overlap", "ground height"])
def test_hardly_more_pictures_are_flown_than_their_whole_ground_asks_for(name):
    made = plan(SCENES[name], GRID)
    # The area's border takes about half a row and half a column more on each side.
    perimeter = 2 * (np.sqrt(SCENES[name].area.area_m2()) * 2.2)
    width, height = made.mission.camera.ground_size_m(made.mission.flight.agl_m)
    share = (1 - made.mission.flight.overlap_along) * (1 - made.mission.flight.overlap_across)
    border = perimeter * math.hypot(width, height) / 2 / (width * height * share)
    assert ideal_count(made) <= len(made) < 1.03 * ideal_count(made) + border


def test_a_large_area_takes_what_its_ground_takes():
    mission = Mission(Box(35.5, -89.9, 35.1, -89.4), 120.0, row_azimuth_deg=127.0)
    made = plan(mission, GRID)
    assert len(made) > 100_000
    assert len(made) < 1.02 * ideal_count(made)
    assert made.coverage.complete


def turned_field(angle_deg, length_m=4000.0, breadth_m=2500.0):
    """A rectangle of ground whose longer sides are turned clockwise from east."""
    half = math.hypot(length_m, breadth_m) / 2
    corner = math.degrees(math.atan2(breadth_m, length_m))
    azimuths = [
        90 + angle_deg - corner,
        90 + angle_deg + corner,
        270 + angle_deg - corner,
        270 + angle_deg + corner,
    ]
    ends = [GEOD.fwd(-89.86, 35.14, azimuth, half)[:2] for azimuth in azimuths]
    return Polygon((tuple(ends),))


def test_a_field_that_is_turned_with_its_rows_takes_as_many_pictures():
    north_up = plan(Mission(turned_field(0.0), 120.0, frame="camera"), GRID)
    for angle in (37.0, -100.0, 180.0):
        made = plan(Mission(turned_field(angle), 120.0, row_azimuth_deg=(90.0 + angle) % 360.0), GRID)
        assert made.rows == north_up.rows
        assert abs(len(made) - len(north_up)) <= made.rows
        assert made.direct.distance_m == pytest.approx(north_up.direct.distance_m, rel=0.02)


@pytest.mark.parametrize("name", ["37", "-90", "180", "latitude 60", "antimeridian", "turned crosshatch", "wide"])
def test_pictures_lie_along_their_rows(name):
    made = plan(SCENES[name], GRID)
    for part, captures in zip(made.passes, passes_of(made)):
        along = captures[:-1][np.diff(made.row[captures]) == 0]
        ends = [values[index] for index in (along, along + 1) for values in (made.lon_deg, made.lat_deg)]
        forward, back, _ = GEOD.inv(*ends)
        eastward = made.column[along + 1] > made.column[along]
        heading = np.where(eastward, forward, forward + 180.0)
        # In its middle a row of the plane and the geodesic between neighbours have one direction.
        half_bend = (back - forward + 180.0 + 180.0) % 360.0 - 180.0
        off = heading + half_bend / 2.0 - 90.0 - (made.poses.yaw_deg[along] + made.poses.yaw_deg[along + 1]) / 2.0
        beside = np.abs(made.poses.yaw_deg[along] - made.poses.yaw_deg[along + 1]) < 1.0
        assert np.abs((off[beside] + 180.0) % 360.0 - 180.0).max() < 2e-3
        # And the pass's middle has the angle that was asked for.
        middle = np.argmin(np.hypot(*part.plane.forward(made.lat_deg[captures], made.lon_deg[captures])))
        own = made.poses.yaw_deg[captures][middle] - part.plane.angle_deg
        assert abs((own + 180.0) % 360.0 - 180.0) < 0.5


def test_crossed_rows_are_a_second_pass_with_its_pictures_turned():
    made = plan(SCENES["turned crosshatch"], GRID)
    first, second = passes_of(made)
    assert len(first) + len(second) == len(made)
    assert [part.plane.angle_deg for part in made.passes] == [12.0, 102.0]
    assert abs(np.median(made.poses.yaw_deg[first]) - 12.0) < 0.05
    assert abs(np.median(made.poses.yaw_deg[second]) - 102.0) < 0.05
    assert made.row[second].min() == made.row[first].max() + 1
    one = plan(SCENES["turned crosshatch"].replace(crosshatch=False), GRID)
    other = plan(SCENES["turned crosshatch"].replace(crosshatch=False, row_azimuth_deg=192.0), GRID)
    assert len(made) == len(one) + len(other)
    np.testing.assert_array_equal(made.lat_deg[first], one.lat_deg)
    np.testing.assert_array_equal(made.lat_deg[second], other.lat_deg)
    assert made.overlap.least_along == min(one.overlap.least_along, other.overlap.least_along)
    assert made.overlap.least_across == min(one.overlap.least_across, other.overlap.least_across)
    assert made.direct.distance_m > one.direct.distance_m + other.direct.distance_m


def test_each_pass_is_flown_in_the_order_asked_for():
    for order in ("serpentine", "one-way"):
        made = plan(SCENES["turned crosshatch"].replace(order=order), GRID)
        assert (np.diff(made.row) >= 0).all()
        for captures in passes_of(made):
            rows = made.row[captures] - made.row[captures[0]]
            for row in np.unique(rows).tolist():
                back = order == "serpentine" and row % 2
                assert (np.diff(made.column[captures][rows == row]) == (-1 if back else 1)).all()


@pytest.mark.parametrize("name", ["37", "overlap", "turned crosshatch", "tilt"])
def test_neighbours_share_at_least_what_is_said(name):
    made = plan(SCENES[name], GRID)
    said = made.overlap
    mission = made.mission
    assert said.least_along == pytest.approx(mission.flight.overlap_along, abs=1e-6)
    assert said.least_across == pytest.approx(mission.flight.overlap_across, abs=1e-6)
    if mission.attitude.tilt_deg:
        return
    # The middle of the next picture of a row lies a step to the right in this one.
    beside = np.flatnonzero((np.diff(made.row) == 0) & (np.diff(made.column) == 1))[::97]
    for index in beside.tolist():
        lon, lat = made.lon_deg[index + 1 : index + 2], made.lat_deg[index + 1 : index + 2]
        (x, y) = image_positions(made, [index], lon, lat)[0, 0]
        assert 1.0 - x / 2.0 >= mission.flight.overlap_along - 1e-9
        assert 1.0 - x / 2.0 == pytest.approx(mission.flight.overlap_along, abs=5e-4)
        assert abs(y) < 5e-4


@pytest.mark.parametrize("angle", sampled([25.0, -75.0], 2))
def test_pictures_beside_a_concave_area_are_not_flown(angle):
    made = plan(Mission(CONCAVE, 120.0, row_azimuth_deg=(90.0 + angle) % 360.0), GRID)
    whole = plan(Mission(CONCAVE.bounds, 120.0, row_azimuth_deg=(90.0 + angle) % 360.0), GRID)
    assert len(made) < 0.62 * len(whole)
    # Each picture shows ground of the area: a fine lattice of it has a point in every one.
    box = CONCAVE.bounds
    lon, lat = (
        axis.ravel()
        for axis in np.meshgrid(
            np.linspace(box.west_deg, box.east_deg, 700), np.linspace(box.south_deg, box.north_deg, 700)
        )
    )
    within = inside(CONCAVE, lon, lat)
    lon, lat = lon[within], lat[within]
    spare = 0
    for index in range(len(made)):
        near = (np.abs(lat - made.lat_deg[index]) < 0.002) & (np.abs(lon - made.lon_deg[index]) < 0.002)
        with np.errstate(invalid="ignore"):
            spare += not (np.abs(image_positions(made, [index], lon[near], lat[near])) <= 1.0).all(axis=-1).any()
    # Points stand 6 m apart: pictures of 158 by 118 m may touch the area with a tip between them.
    assert spare <= 0.01 * len(made)


@pytest.mark.parametrize("name", ["37", "tilt", "latitude 60", "turned crosshatch", "wide"])
def test_windows_lie_inside_the_pictures(name):
    made = plan(SCENES[name], GRID)
    world = GRID.world_px(made.zoom)
    left, top, right, bottom = made.windows.bounds_px
    assert (made.windows.width_px > 0).all()
    largest = 0.0
    for index in range(0, len(made), max(len(made) // 40, 1)):
        x = np.array([left[index], right[index], right[index], left[index]])
        y = np.array([top[index], top[index], bottom[index], bottom[index]])
        seen = image_positions(made, [index], u_to_lon(x / world), v_to_lat(y / world))
        largest = max(largest, float(np.abs(seen).max()))
    assert 0.8 < largest <= 1.0


@pytest.mark.parametrize("name", ["37", "tilt", "antimeridian", "turned crosshatch"])
def test_footprints_are_those_of_the_turned_pictures(name):
    made = plan(SCENES[name], GRID)
    for index in range(0, len(made), max(len(made) // 20, 1)):
        seen = image_positions(made, [index], made.corners.lon_deg[index], made.corners.lat_deg[index])[0]
        off_px = (seen - [(-1, 1), (1, 1), (1, -1), (-1, -1)]) * np.array(made.frames.largest_px) / 2.0
        of_oracle_px = ORACLE_M / made.resolution.camera_m_per_px
        assert np.hypot(*off_px.T).max() <= made.accuracy.footprint.method.bound_px + of_oracle_px < 1e-7


def test_rows_that_are_not_turned_are_those_along_parallels():
    for mission in (Mission(FIELD, 120.0), Mission(CONCAVE, 120.0, tilt_deg=20.0, frame="camera")):
        made = plan(mission.replace(row_azimuth_deg=90.0, crosshatch=False), GRID)
        assert made.passes == ()
        for row in range(made.rows):
            assert np.ptp(made.lat_deg[made.row == row]) == 0.0
        assert not any(made.poses.yaw_deg.strides)


def test_points_have_no_rows_to_turn():
    points = Points(((35.1, -89.8, 120.0), (35.1, -89.7, 120.0)))
    plain = plan(Mission(points, 120.0), GRID)
    made = plan(Mission(points, 120.0, row_azimuth_deg=127.0, crosshatch=True), GRID)
    assert made.names == plain.names
    assert made.poses.yaw_deg.tolist() == [0.0, 0.0]


def test_in_wind_what_is_covered_is_counted_on_the_pictures_that_are_flown():
    mission = Mission(FIELD, 200.0, row_azimuth_deg=127.0, wind=Wind(6.0, 250.0, 0.3))
    made = plan(mission, GRID)
    said = made.coverage
    assert not said.complete
    assert 0.5 < said.share < 1.0
    box = FIELD
    draw = np.random.default_rng(3)
    count = 3000
    lon, lat = (
        draw.uniform(box.west_deg, box.east_deg, count),
        draw.uniform(box.south_deg, box.north_deg, count),
    )
    shown = float((seen_by(made, np.arange(len(made)), lon, lat) > 0).mean())
    # The rectangles along the rows leave the corners of pictures out that the gusts have turned.
    noise = 4 * math.sqrt(shown * (1 - shown) / count)
    assert said.share <= shown + noise
    assert said.share > shown - 0.12
    assert made.overlap.least_along < 0.0
    closer = plan(mission.replace(overlap_along=0.6, overlap_across=0.6), GRID)
    assert closer.coverage.share > said.share


def test_what_is_counted_in_wind_is_in_each_picture_and_on_a_lattice():
    made = plan(SCENES["turned crosshatch"].replace(wind=Wind(6.0, 250.0, 0.3)), GRID)
    for part, captures in zip(made.passes, passes_of(made)):
        poses = made.poses.take(captures)
        own = rotated_rectangles(made.mission, made.mission.camera, part, poses, made.row[captures], WGS84, moved=True)
        for first, second in ((own.x0, own.y0), (own.x0, own.y1), (own.x1, own.y0), (own.x1, own.y1)):
            lat, lon = part.plane.inverse(first, second)
            seen = image_positions(made, captures, lon[:, np.newaxis], lat[:, np.newaxis])
            assert (np.abs(seen) <= 1.0 + 1e-9).all()
        assert (own.x1 > own.x0).all()
        assert (own.y1 > own.y0).all()
        # However many pictures there are, their sides are on no more lines than their ground has pieces.
        for sides, (size,) in zip(((own.x0, own.x1), (own.y0, own.y1)), part.sides.size_m):
            lines = np.concatenate(sides) / size * 512.0
            np.testing.assert_allclose(lines, np.rint(lines), atol=1e-6)


@pytest.mark.parametrize(
    ("mission", "grid", "says"),
    [
        (
            SCENES["37"].replace(layout="paper"),
            GRID,
            "row azimuth 127 deg: the layout paper is north-up; use --layout cover",
        ),
        (SCENES["crosshatch"].replace(layout="paper"), GRID, "crosshatch: the layout paper is north-up"),
        (
            SCENES["37"].replace(tilt_deg=75.0),
            GRID,
            "camera with tilt 75, roll 0 deg from 120 m: sees past the horizon",
        ),
        (
            SCENES["37"].replace(area=Box(50, 0, 30, 30)),
            GRID,
            "row azimuth 127 deg: turned rows hold to 1000 km",
        ),
        (SCENES["37"].replace(area=Box(85.2, 0, 85, 1)), GRID, "latitude 85.2"),
        (SCENES["37"].replace(max_images=100), GRID, "the limit is 100"),
        (SCENES["crosshatch"].replace(max_images=400), GRID, "the limit is 400"),
        (
            SCENES["37"].replace(frame="map"),
            GRID,
            "image 'map' was asked for, but has no bound here: the rows are",
        ),
        (SCENES["37"], PixelGrid(centre_decimals=6, max_size_px=640), "choose a source of tiles"),
        (SCENES["37"].replace(overlap_along=0.9999999999), GRID, "overlap less"),
    ],
)
def test_what_cannot_be_turned_is_refused_in_one_line(mission, grid, says):
    with pytest.raises(InvalidInput) as refused:
        plan(mission, grid)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


@settings(max_examples=examples(40), deadline=None)
@given(
    st.tuples(st.floats(-80, 80), st.floats(-180, 180), st.floats(0.001, 0.05), st.floats(0.001, 0.1)),
    st.floats(300, 3000),
    st.floats(0, 360).filter(lambda azimuth: azimuth != 90.0),
    st.booleans(),
    st.tuples(st.floats(0, 0.7), st.floats(0, 0.7)),
    st.tuples(st.floats(20, 120), st.floats(0.3, 3)),
    st.tuples(st.floats(-180, 180), st.floats(-25, 25), st.floats(-25, 25)),
)
def test_no_place_of_any_box_is_left_out(place, agl, azimuth, crosshatch, overlaps, lens, attitude):
    lat, west, height, width = place
    east = west + width
    area = Box(lat + height, west, lat, east if east <= 180 else east - 360)
    yaw, tilt, roll = attitude
    mission = Mission(
        area,
        agl,
        Camera(*lens),
        overlap_along=overlaps[0],
        overlap_across=overlaps[1],
        row_azimuth_deg=azimuth,
        crosshatch=crosshatch,
        yaw_deg=yaw,
        tilt_deg=tilt,
        roll_deg=roll,
        max_images=1500,
        error_budget_px=1.0,
    )
    try:
        made = plan(mission, GRID)
    except InvalidInput as refused:
        assume("the limit is" not in str(refused) and "past the horizon" not in str(refused))
        raise
    assert made.coverage.complete
    for side, asked in (("along", overlaps[0]), ("across", overlaps[1])):
        least = getattr(made.overlap, f"least_{side}")
        assert least is None or least >= asked - 1e-9
    lon, lat = places_of(area, 60)
    for captures in passes_of(made):
        assert seen_by(made, captures, lon, lat).min() >= 1
