"""Patterns of captures: what corridors, orbits and scans show, by a geometry of their own on a plane of PROJ's."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pyproj import Geod, Proj
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.mission.areas.area import Points, Polygon
from terrainav.core.mission.areas.coords import parse_coords
from terrainav.core.poses.patterns import corridor, facade, orbit, structure
from terrainav.core.poses.settings import Corridor, Orbit, Scan

from tests.support.command import command
from tests.support.thinning import examples

run = pytest.fixture(command, name="run")

CAMERA = Camera()
LAT, LON, AGL_M = 46.9, 7.4, 120.0
WIDE_M, HIGH_M = CAMERA.ground_size_m(AGL_M)
GEOD = Geod(ellps="WGS84")
PLANE = Proj(proj="aeqd", lat_0=LAT, lon_0=LON, ellps="WGS84")
#: Places that are looked at; and what a plane and 9 decimals of a degree move them by, metres.
PLACES, SLACK_M = 4000, 0.02


def line_of(corners_m: list[tuple[float, float]]) -> np.ndarray:
    lon, lat = PLANE(*np.array(corners_m).T, inverse=True)
    return np.stack([lat, lon], axis=1)


def planar(points: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """East and north of poses, and the direction of their images' tops on the plane."""
    lat, lon, _ = np.array(points.poses).T
    x, y = PLANE(lon, lat)
    ahead_lon, ahead_lat, _ = GEOD.fwd(lon, lat, points.yaws_deg, np.full(len(lon), 1.0))
    ahead_x, ahead_y = PLANE(ahead_lon, ahead_lat)
    return x, y, np.arctan2(ahead_x - x, ahead_y - y)


def shown(points: Points, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which places are in an image that looks straight down."""
    found = np.zeros(len(x), bool)
    for at_x, at_y, top in zip(*planar(points)):
        ahead = (x - at_x) * math.sin(top) + (y - at_y) * math.cos(top)
        right = (x - at_x) * math.cos(top) - (y - at_y) * math.sin(top)
        found |= (np.abs(ahead) <= HIGH_M / 2.0 + SLACK_M) & (np.abs(right) <= WIDE_M / 2.0 + SLACK_M)
    return found


def distances(corners: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    nearest = np.full(len(x), np.inf)
    for (x0, y0), (x1, y1) in zip(corners, corners[1:]):
        along = np.array([x1 - x0, y1 - y0])
        share = np.clip(((x - x0) * along[0] + (y - y0) * along[1]) / (along @ along), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(x - x0 - share * along[0], y - y0 - share * along[1]))
    return nearest


corners = st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=2, max_size=5, unique=True)


@settings(max_examples=examples(40))
@given(corners, st.floats(0.0, 500.0), st.sampled_from([0.0, 0.3, 0.65]), st.integers(0, 2**32 - 1))
def test_a_corridor_shows_all_of_its_strip(shape, width_m, overlap, seed):
    outline = np.array(shape) * 100.0
    points = corridor([line_of(outline.tolist())], CAMERA, AGL_M, (overlap, overlap), Corridor(width_m))
    assume(len(points.poses) < 3000)
    bits = np.random.default_rng(seed)
    low, high = outline.min(axis=0) - width_m, outline.max(axis=0) + width_m
    x, y = bits.uniform(low[0], high[0], PLACES), bits.uniform(low[1], high[1], PLACES)
    inside = distances(outline, x, y) <= width_m / 2.0
    missed = inside & ~shown(points, x, y)
    # Beyond its ends a corridor's strip ends as its images do: half of one.
    ends = np.minimum(*(np.hypot(x - end[0], y - end[1]) for end in (outline[0], outline[-1])))
    assert not (missed & (ends > width_m / 2.0 + 1.0)).any()
    assert (points.tilts_deg, points.rolls_deg) == ((), ())


def test_a_straight_corridor_has_the_fewest_images_and_the_overlaps_asked_for():
    length_m, width_m, along, across = 2000.0, 400.0, 0.75, 0.6
    points = corridor([line_of([(-1000.0, 0.0), (1000.0, 0.0)])], CAMERA, AGL_M, (along, across), Corridor(width_m))
    rows = math.ceil((width_m - WIDE_M) / (WIDE_M * (1.0 - across))) + 1
    columns = math.ceil(length_m / (HIGH_M * (1.0 - along))) + 1
    assert len(points.poses) == rows * columns
    x, y, top = planar(points)
    x, y, top = (values.reshape(rows, columns) for values in (x, y, top))
    assert np.abs(np.diff(x, axis=1)).max() <= HIGH_M * (1.0 - along) + SLACK_M
    assert np.abs(np.diff(y, axis=0)).max() <= WIDE_M * (1.0 - across) + SLACK_M
    # To and fro, with the top of the images ahead.
    np.testing.assert_allclose(
        np.sin(top), np.where(np.arange(rows) % 2, -1.0, 1.0)[:, np.newaxis] + 0.0 * top, atol=1e-4
    )
    assert np.all(np.sign(np.diff(x, axis=1)) == np.sign(np.sin(top[:, 1:])))


def test_an_offset_is_to_the_right_of_the_line():
    points = corridor([line_of([(0.0, 0.0), (0.0, 1000.0)])], CAMERA, AGL_M, (0.5, 0.5), Corridor(0.0, offset_m=80.0))
    x, _, _ = planar(points)
    np.testing.assert_allclose(x, 80.0, atol=SLACK_M)


def test_a_corridor_crosses_the_antimeridian():
    line = np.array([[10.0, 179.995], [10.0, -179.995]])
    points = corridor([line], CAMERA, AGL_M, (0.0, 0.0), Corridor(0.0))
    lon = np.array(points.poses)[:, 1]
    assert (np.abs(lon) > 179.99).all()
    assert len(lon) == math.ceil(GEOD.inv(179.995, 10.0, -179.995, 10.0)[2] / HIGH_M) + 1


def test_an_orbit_looks_at_its_target():
    wanted = Orbit(60.0, 30.0, 90.0, circles=3, images=24, target_m=12.0)
    points = orbit(LAT, LON, wanted)
    assert len(points.poses) == 72
    for (lat, lon, agl), yaw, tilt in zip(points.poses, points.yaws_deg, points.tilts_deg):
        azimuth, _, away_m = GEOD.inv(lon, lat, LON, LAT)
        assert away_m == pytest.approx(60.0, abs=1e-3)
        assert abs((azimuth - yaw + 180.0) % 360.0 - 180.0) < 1e-3
        # The ray through the middle of the image meets the target's height above the centre.
        assert agl - away_m / math.tan(math.radians(tilt)) == pytest.approx(12.0, abs=1e-3)
    assert sorted({pose[2] for pose in points.poses}) == [30.0, 60.0, 90.0]


@pytest.mark.parametrize("left", [False, True])
def test_a_facade_is_seen_from_one_side_with_the_overlaps_asked_for(left):
    wanted = Scan(25.0, 10.0, 60.0)
    points = facade([line_of([(0.0, 0.0), (200.0, 0.0)])], CAMERA, (0.7, 0.6), wanted, left=left)
    x, y, top = planar(points)
    np.testing.assert_allclose(y, 25.0 if left else -25.0, atol=SLACK_M)
    np.testing.assert_allclose(np.cos(top), -1.0 if left else 1.0, atol=1e-6)
    assert set(points.tilts_deg) == {90.0}
    wide_m, high_m = CAMERA.ground_size_m(25.0)
    levels = sorted({pose[2] for pose in points.poses})
    assert (levels[0], levels[-1]) == (10.0, 60.0)
    assert np.diff(levels).max() <= high_m * 0.4 + 1e-6
    for level in levels:
        on = np.sort(x[np.array([pose[2] == level for pose in points.poses])])
        assert np.diff(on).max() <= wide_m * 0.3 + SLACK_M
        np.testing.assert_allclose([on[0], on[-1]], [0.0, 200.0], atol=SLACK_M)


@pytest.mark.parametrize("reverse", [False, True])
def test_a_structure_is_flown_around_at_its_distance(reverse):
    outline = [(0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (30.0, 40.0), (30.0, 90.0), (0.0, 90.0)]
    ring = [(lon, lat) for lat, lon in line_of(outline[::-1] if reverse else outline)]
    points = structure([Polygon((tuple(ring),))], CAMERA, (0.6, 0.5), Scan(15.0, 12.0, 30.0))
    x, y, top = planar(points)
    away = distances(np.array([*outline, outline[0]]), x, y)
    np.testing.assert_allclose(away, 15.0, atol=SLACK_M + 0.6)
    assert away.min() >= 15.0 - SLACK_M
    # Each camera looks at a wall: the structure begins at the distance, straight ahead.
    ahead = distances(np.array([*outline, outline[0]]), x + 15.0 * np.sin(top), y + 15.0 * np.cos(top))
    assert ahead.max() < 0.7


def test_what_is_wrong_is_refused_in_one_line():
    line = line_of([(0.0, 0.0), (100.0, 0.0)])
    with pytest.raises(InvalidInput, match="width"):
        Corridor(-1.0)
    with pytest.raises(InvalidInput, match=r"highest height 10 m: is below the lowest, 20 m"):
        Scan(5.0, 20.0, 10.0)
    with pytest.raises(InvalidInput, match="3 circles at one height: must be 1; give the highest height"):
        Orbit(5.0, 20.0, circles=3)
    with pytest.raises(InvalidInput, match="at one place"):
        corridor([line[[0, 0]]], CAMERA, AGL_M, (0.0, 0.0), Corridor(0.0))
    with pytest.raises(InvalidInput, match=r"line of 1,1.. km: a pattern reaches up to 400 km; take shorter"):
        corridor([np.array([[0.0, 0.0], [0.0, 10.0]])], CAMERA, AGL_M, (0.0, 0.0), Corridor(0.0))
    with pytest.raises(InvalidInput, match="overlap"):
        corridor([line], CAMERA, AGL_M, (1.0, 0.0), Corridor(0.0))
    with pytest.raises(InvalidInput, match="poses: must be from 1 to"):
        corridor([line], CAMERA, 1e-3, (0.999, 0.0), Corridor(0.0))
    with pytest.raises(InvalidInput, match="line: missing"):
        corridor([], CAMERA, AGL_M, (0.0, 0.0), Corridor(0.0))


def test_the_command_writes_what_missions_are_flown_from(run, tmp_path):
    line = [[7.4, 46.9], [7.41, 46.9]]
    (tmp_path / "line.geojson").write_text(json.dumps({"type": "LineString", "coordinates": line}))
    ring = [[7.4, 46.9], [7.401, 46.9], [7.401, 46.901], [7.4, 46.9]]
    (tmp_path / "area.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    camera = "--hfov 60 --aspect-ratio 3 2 --overlap 0.7 0.6"
    walls = "--distance 20 --lowest 10 --highest 30 --output"
    for words in (
        f"corridor line.geojson --width 100 --agl 80 {camera} --output corridor.csv",
        "orbit 46.9 7.4 --radius 40 --lowest 30 --images 12 --output orbit.csv",
        f"facade line.geojson --left {camera} {walls} facade.csv",
        f"structure area.geojson {camera} {walls} structure.csv",
    ):
        said = run("poses", *words.split())
        assert (said.returncode, said.stderr) == (0, "")
        path = words.split()[-1]
        points, _ = parse_coords(str(tmp_path / path))
        assert said.stdout == f"{len(points.poses):,} poses in {path}\n"
    height = 2.0 * 80.0 * math.tan(math.radians(30.0)) / 1.5
    columns = math.ceil(GEOD.inv(*line[0], *line[1])[2] / (height * 0.3)) + 1
    corridor_points, _ = parse_coords(str(tmp_path / "corridor.csv"))
    assert len(corridor_points.poses) == 2 * columns
    wrong = run(*"poses corridor line.geojson --width -1 --agl 80 --output no.csv".split())
    assert (wrong.returncode, wrong.stderr) == (2, "terrainav: width -1.0 m: must be from 0 to 100000\n")
    assert not (tmp_path / "no.csv").exists()
