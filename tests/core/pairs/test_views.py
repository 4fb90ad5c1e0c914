"""Views around a place: where the cameras stand, and how far they see."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import WGS84
from terrainav.core.geodesy.footprint import exact
from terrainav.core.pairs.views import PairView, reach_m, rings, spiral, standing_poses

from tests.core.geodesy.inverse import image_points

GEOD = Geod(ellps="WGS84")
CAMERA = Camera(78.8, 1.0)
LAT = np.array([35.12, -33.95, 0.0, 69.6, -16.1])
LON = np.array([-89.93, 18.46, 0.0, 18.9, 180.0])


def test_the_spiral_is_that_of_university_1652():
    views = spiral()
    assert len(views) == 54
    assert [views[0].agl_m, views[-1].agl_m] == [256.0, 121.5]
    assert [view.yaw_deg for view in views] == pytest.approx([20.0 * at % 360.0 for at in range(54)])
    assert np.diff([view.agl_m for view in views]) == pytest.approx(-134.5 / 53, abs=1e-6)


def test_rings_have_every_height_yaw_and_tilt():
    views = rings((120, 160), 4, (30, 60))
    assert len(views) == len(set(views)) == 16
    assert views[:2] == (PairView(120.0, 0.0, 30.0), PairView(120.0, 90.0, 30.0))
    assert {view.tilt_deg for view in views[:8]} == {30.0}


@pytest.mark.parametrize("ground", [WGS84, WGS84.raised(2500.0)])
@pytest.mark.parametrize(
    "view", [PairView(120.0, 0.0, 0.0), PairView(256.0, 200.0, 45.0), PairView(500.0, -70.0, 80.0)]
)
def test_the_place_is_in_the_middle_of_the_picture(view, ground):
    poses = standing_poses(LAT, LON, view, ground)
    seen = image_points(CAMERA, poses, LAT[:, np.newaxis], LON[:, np.newaxis], ground)
    # Cameras are placed to 10 micrometres, of which the farthest picture shows 1e-7.
    assert np.abs(seen).max() < 1e-6


def test_the_camera_stands_off_against_its_view():
    poses = standing_poses(LAT, LON, PairView(200.0, 30.0, 45.0))
    for lat, lon, place_lat, place_lon in zip(poses.lat_deg, poses.lon_deg, LAT, LON):
        azimuth, _, distance = GEOD.inv(lon, lat, place_lon, place_lat)
        assert azimuth == pytest.approx(30.0, abs=0.001)
        # 200 m on flat ground; the Earth falls away by 3 mm.
        assert distance == pytest.approx(200.0, abs=0.02)


def test_no_ground_is_seen_beyond_the_reach():
    views = rings((120.0, 256.0), 3, (0.0, 45.0))
    reach = reach_m(LAT, views, CAMERA)
    border = np.linspace(-1.0, 1.0, 41)
    side = np.ones_like(border)
    points = np.concatenate(
        [np.stack(pair, axis=-1) for pair in ((border, side), (border, -side), (side, border), (-side, border))]
    )
    farthest = np.zeros_like(reach)
    for view in views:
        seen = exact(CAMERA, standing_poses(LAT, LON, view), tuple(map(tuple, points)))
        for at, (lat, lon) in enumerate(zip(LAT, LON)):
            many = np.full(len(points), 1.0)
            _, _, distance = GEOD.inv(lon * many, lat * many, seen.lon_deg[at], seen.lat_deg[at])
            farthest[at] = max(farthest[at], distance.max())
    assert (farthest <= reach).all()
    assert farthest == pytest.approx(reach, rel=0.002)


def test_views_of_the_horizon_reach_without_end():
    assert np.isinf(reach_m(LAT, (PairView(120.0, 0.0, 70.0),), CAMERA)).all()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: PairView(0.0, 0.0, 0.0), "height above ground 0.0 m"),
        (lambda: PairView(100.0, 0.0, 81.0), "tilt 81.0 deg: must be from 0"),
        (lambda: PairView(100.0, 0.0, float("nan")), "tilt nan deg"),
        (lambda: rings((120, 120), 3, (45,)), "heights 120 120: each may be named once"),
        (lambda: rings((120,), 0, (45,)), "0 yaws"),
        (lambda: rings((120,), 3, ()), "no tilt"),
        (lambda: spiral((120,), 0), "0 views"),
        (lambda: spiral((120,), 1_000_000), "1000000 views: must be from 1 to 10,000"),
        (lambda: rings((120,), 10_001, (45,)), "10001 yaws: must be from 1 to 10,000"),
        (lambda: spiral((120,), 2, 3), "3 rounds of 2 views"),
    ],
)
def test_views_that_cannot_be_flown_are_refused(make, told):
    with pytest.raises(InvalidInput, match=told):
        make()
