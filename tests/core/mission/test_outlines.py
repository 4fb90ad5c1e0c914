"""What is drawn of a plan: cut once at the antimeridian, and the same ground in degrees and on the map."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.mercator import HALF_WORLD_M, MAX_LAT_DEG, PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.mission import outlines
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.outlines import (
    cut_at_antimeridian,
    cut_line,
    footprints_deg,
    metres,
    pictures_m,
)
from terrainav.core.mission.plan import plan

from tests.support.thinning import sampled

GRID = PixelGrid()
TO_MAP = Transformer.from_crs(4326, 3857, always_xy=True)
ACROSS = Box(-16.5, 179.995, -16.505, -179.995)
SCENES = {
    "map frames": Mission(Box(35.1425, -89.868, 35.1385, -89.863), 120.0),
    "map frames across": Mission(ACROSS, 120.0),
    "camera frames": Mission(Box(35.1425, -89.868, 35.1385, -89.863), 120.0, yaw_deg=30.0, tilt_deg=20.0),
    "camera frames across": Mission(ACROSS, 120.0, yaw_deg=45.0),
    "bent": Mission(Points(((35.0, 179.7, 40e3), (-60.0, 20.0, 40e3))), 40e3, tilt_deg=30.0, yaw_deg=80.0),
    "horizon": Mission(Points(((35.0, 179.9, 3e3),)), 3e3, tilt_deg=70.0, yaw_deg=90.0),
    "pole": Mission(Points(((70.0, -90.0, 8e6),)), 8e6),
    "south pole": Mission(Points(((-70.0, 179.0, 8e6),)), 8e6, yaw_deg=20.0),
}


def area(ring):
    """Signed area of a ring, positive where it runs counter-clockwise."""
    x, y = (np.asarray(part, np.float64) - np.mean(part) for part in ring)
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2.0


@pytest.mark.parametrize("name", SCENES)
def test_rings_are_counter_clockwise_within_the_world_and_lose_no_ground(name, monkeypatch):
    made, wholes = plan(SCENES[name], GRID), []

    def cut(*whole):
        wholes.append(whole)
        return cut_at_antimeridian(*whole)

    monkeypatch.setattr(outlines, "cut_at_antimeridian", cut)
    for rings in footprints_deg(made):
        assert sum(map(area, rings)) == pytest.approx(area(wholes[-1]), rel=1e-9)
        for lon, lat in rings:
            assert area((lon, lat)) > 0.0
            assert np.abs(lon).max() <= 180.0
            assert np.abs(lat).max() <= 90.0
    crosses = any(len(rings) > 1 for rings in footprints_deg(made))
    # Around a pole a ring goes from ±180° to ±180°, and is not cut.
    assert crosses == ("across" in name or name in ("bent", "horizon"))


@pytest.mark.parametrize("name", sampled(SCENES, 3))
def test_pictures_on_the_map_are_the_frames_that_files_state_or_what_the_camera_sees(name):
    made = plan(SCENES[name], GRID)
    west, south, east, north = made.edges
    for index, (rings, seen) in enumerate(zip(pictures_m(made), footprints_deg(made))):
        for x, y in rings:
            assert area((x, y)) > 0.0
            assert np.abs(x).max() <= HALF_WORLD_M
        if made.frames.on_map:
            size = (east[index] - west[index]) * (north[index] - south[index])
            assert sum(map(area, rings)) == pytest.approx(size, rel=1e-9)
            assert {float(value) for _, y in rings for value in y} == {south[index], north[index]}
            continue
        if "pole" in name:
            # What lies beyond the map is cut off.
            assert max(np.abs(y).max() for _, y in rings) == pytest.approx(float(metres(0.0, MAX_LAT_DEG)[1]), abs=1e-3)
            continue
        assert len(rings) == len(seen)
        for ring, degrees in zip(rings, seen):
            assert np.stack(ring) == pytest.approx(np.stack(TO_MAP.transform(*degrees)), abs=1e-6)


@pytest.mark.parametrize("name", ["map frames across", "camera frames", "bent"])
def test_a_part_of_a_plan_is_drawn_as_in_the_whole(name):
    made = plan(SCENES[name], GRID)
    for draw in (footprints_deg, pictures_m):
        whole = list(draw(made))
        for part in (slice(1, None), slice(0, len(made), 2)):
            some = list(draw(made, part))
            assert len(some) == len(whole[part])
            for ours, theirs in zip(some, whole[part]):
                assert all(np.array_equal(a, b) for one, two in zip(ours, theirs) for a, b in zip(one, two))


@pytest.mark.parametrize(("lat", "lon", "yaw"), [(88.0, 30.0, 0.0), (-88.0, 170.0, 20.0), (-90.0, 0.0, 180.0)])
def test_ground_around_a_pole_is_in_one_piece_and_on_a_plane_has_no_way_to_the_pole(lat, lon, yaw):
    pole, crs = math.copysign(1.0, lat), 3413 if lat > 0.0 else 3031
    plane = ProjectedPlane(f"EPSG:{crs}", -2e6, 2e6, 4e6, 4e6)
    mission = Mission(Points(((lat, lon, 1e6),)), 1e6, yaw_deg=yaw, tilt_deg=1.0, frame="camera", accept_error=True)
    made = plan(mission, PixelGrid(plane=plane, max_zoom=12, native_zoom=12))
    assert made.views.poles[0] == pole
    ((x, y),) = next(footprints_deg(made))
    # Along the antimeridian and the pole's parallel alone it has edges that the camera does not see.
    along = np.abs(np.diff(np.append(x, x[0]))) < 1e-9
    assert (np.abs(x[along]) == 180.0).all()
    assert (x.min(), x.max()) == (-180.0, 180.0)
    assert (pole * y).max() == 90.0
    ((east, north),) = next(pictures_m(made))
    assert np.hypot(east, north).min() > 1e5
    to_plane = Transformer.from_crs(4326, crs, always_xy=True)
    seen = made.views.outline(0)
    expected = np.stack(to_plane.transform(seen.dlon_deg + lon, seen.lat_deg))
    assert np.stack((east, north)) == pytest.approx(expected, abs=1e-3)


@given(st.floats(-400, 400), st.floats(1e-3, 170.0), st.floats(-80, 79), st.floats(1e-3, 1.0))
def test_a_box_is_cut_into_what_each_turn_of_the_earth_has_of_it(west, width, south, height):
    lon, lat = west + np.array([0.0, width, width, 0.0]), south + np.array([0.0, 0.0, height, height])
    parts = cut_at_antimeridian(lon, lat)
    assert 1 <= len(parts) <= 2
    assert sum(float(np.ptp(x)) for x, _ in parts) == pytest.approx(width, abs=1e-9)
    total = sum(WGS84.ring_area_m2(x, y) for x, y in parts)
    assert total == pytest.approx(WGS84.ring_area_m2(lon, lat), rel=1e-6)


def test_nothing_is_cut_into_nothing():
    assert cut_at_antimeridian(np.empty(0), np.empty(0)) == []


@given(st.lists(st.tuples(st.floats(-179.9, 179.9), st.floats(-80, 80)), min_size=1, max_size=8))
def test_lines_keep_their_places_and_take_the_shorter_way(places):
    lon, lat = np.array(places).T
    parts = cut_line(lon, lat)
    assert all(np.abs(x).max() <= 180.0 for x, _ in parts)
    went = sum(float(np.abs(np.diff(x)).sum()) for x, _ in parts)
    shorter = (np.diff(lon) + 180.0) % 360.0 - 180.0
    assert went == pytest.approx(float(np.abs(shorter).sum()), abs=1e-6)
    drawn = {(round(float(x), 9), round(float(y), 9)) for part in parts for x, y in zip(*part)}
    assert {(round(x, 9), round(y, 9)) for x, y in places} <= drawn


def _straight_m(k1, seen):
    """Where a ray meets the ground 100 m below that a lens with k1 shows at ``seen`` focal lengths from the middle."""
    roots = np.roots([k1, 0.0, 1.0, -seen])
    return 100.0 * min(root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0.0)


@pytest.mark.parametrize(
    ("camera", "ground_m"),
    [
        (Camera(150.0, 4.0 / 3.0, lens="fisheye"), lambda share: 100.0 * math.tan(share * math.radians(75.0))),
        (Camera(60.0, 4.0 / 3.0, k1=-0.2), lambda share: _straight_m(-0.2, share * math.tan(math.radians(30.0)))),
        (Camera(60.0, 4.0 / 3.0, k1=0.3), lambda share: _straight_m(0.3, share * math.tan(math.radians(30.0)))),
    ],
    ids=["fisheye", "barrel", "pincushion"],
)
def test_footprints_are_bent_as_the_lens_bends_them(camera, ground_m):
    made = plan(Mission(Points(((35.15, -89.9, 100.0),)), 100.0, camera), GRID)
    (((x, y),),) = pictures_m(made)
    east, north = TO_MAP.transform(-89.9, 35.15)
    bearing = np.degrees(np.arctan2(x - east, y - north))
    far_m = np.hypot(x - east, y - north) * math.cos(math.radians(35.15))
    order = np.argsort(bearing)
    sides = np.interp([0.0, 90.0, 180.0, 270.0], bearing[order], far_m[order], period=360.0)
    # Shares of half the diagonal; the map's scale is not that of a sphere by some thousandths.
    assert sides == pytest.approx([ground_m(0.6), ground_m(0.8)] * 2, rel=5e-3)
    assert far_m.max() == pytest.approx(ground_m(1.0), rel=5e-3)
    (((lon, _),),) = footprints_deg(made)
    assert len(lon) == len(x)
