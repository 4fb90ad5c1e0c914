"""Where cameras face: north, along each row's flight, or a fixed azimuth, against cameras traced once more."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pyproj import Geod
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.mission.test_rotated import CONCAVE, FIELD, places_of, seen_by
from tests.support.thinning import examples, sampled

GRID = PixelGrid(max_zoom=22, native_zoom=22)
GEOD = Geod(ellps="WGS84")
WIDE = Camera(73.7, 4 / 3)
SMALL = Box(35.145, -89.866, 35.135, -89.856)
#: Rows meet in corners whose degrees are rounded, so far from the middle of an image's side, metres.
LEANING = {"tilt_deg": 20.0, "roll_deg": -8.0, "overlap_along": 0.3, "overlap_across": 0.2}
SCENES = {
    "track": Mission(SMALL, 120.0, WIDE, facing="track"),
    "track, tilted and rolled": Mission(SMALL, 120.0, WIDE, facing="track", **LEANING),
    "track, one way": Mission(SMALL, 120.0, WIDE, facing="track", order="one-way", **LEANING),
    "track at 30 deg": Mission(SMALL, 120.0, WIDE, facing="track", row_azimuth_deg=30.0, **LEANING),
    "track, crossed": Mission(SMALL, 120.0, WIDE, facing="track", crosshatch=True, **LEANING),
    "track, yaw": Mission(SMALL, 120.0, WIDE, facing="track", yaw_deg=25.0, **LEANING),
    "track over a field": Mission(CONCAVE, 120.0, WIDE, facing="track", row_azimuth_deg=155.0, tilt_deg=30.0),
    "azimuth": Mission(SMALL, 120.0, WIDE, facing="-50", **LEANING),
    "azimuth at 30 deg": Mission(SMALL, 120.0, WIDE, facing="200.5", row_azimuth_deg=30.0, **LEANING),
    "track near a pole": Mission(Box(-80.0, 10.0, -80.05, 10.3), 500.0, WIDE, facing="track", **LEANING),
}


def off_deg(angle):
    return np.abs(np.mod(np.asarray(angle) + 180.0, 360.0) - 180.0)


def tracks_deg(made):
    """Azimuth of the flight at each capture whose row goes on, its index, from geodesics between positions."""
    here = np.flatnonzero(made.row[1:] == made.row[:-1])
    lat, lon = made.lat_deg, made.lon_deg
    azimuth, _, _ = GEOD.inv(lon[here], lat[here], lon[here + 1], lat[here + 1])
    return here, azimuth


@pytest.mark.parametrize("name", sampled(SCENES, 3))
def test_every_place_is_seen_whichever_way_cameras_face(name):
    made = plan(SCENES[name], GRID)
    assert made.coverage.complete
    lon, lat = places_of(made.mission.area, 300)
    counts = seen_by(made, np.arange(len(made)), lon, lat)
    assert counts.min() >= 1
    for side in ("along", "across"):
        asked = getattr(made.mission.flight, f"overlap_{side}")
        assert getattr(made.overlap, f"least_{side}") >= asked - 2e-3


@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("track")])
def test_images_point_along_the_flight_of_their_row(name):
    made = plan(SCENES[name], GRID)
    here, azimuth = tracks_deg(made)
    assert off_deg(made.poses.yaw_deg[here] - azimuth - made.mission.attitude.yaw_deg).max() < 0.2
    ways = np.unique(np.rint(made.poses.yaw_deg / 10.0))
    assert len(ways) >= (1 if made.mission.flight.order == "one-way" else 2)


@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("azimuth")])
def test_a_fixed_azimuth_is_that_of_every_image(name):
    made = plan(SCENES[name], GRID)
    assert off_deg(made.poses.yaw_deg - float(made.mission.flight.facing)).max() < 1e-9


def test_the_long_side_across_the_track_takes_fewer_rows_and_a_shorter_flight():
    north, track = (plan(SCENES["track"].replace(facing=facing), GRID) for facing in ("north", "track"))
    assert track.rows < north.rows
    assert track.direct.distance_m < 0.9 * north.direct.distance_m


@settings(max_examples=examples(25), deadline=None)
@given(
    st.tuples(st.floats(-75, 75), st.floats(-180, 180), st.floats(0.002, 0.03), st.floats(0.002, 0.03)),
    st.sampled_from(("track", "33", "-90")),
    st.floats(0, 360),
    st.tuples(st.floats(0, 0.7), st.floats(0, 0.7)),
    st.tuples(st.floats(-180, 180), st.floats(-25, 25), st.floats(-25, 25)),
)
def test_no_place_of_any_box_is_left_out(place, facing, azimuth, overlaps, attitude):
    lat, west, height, width = place
    east = west + width
    mission = Mission(
        Box(lat + height, west, lat, east if east <= 180 else east - 360),
        400.0,
        WIDE,
        facing=facing,
        row_azimuth_deg=azimuth,
        overlap_along=overlaps[0],
        overlap_across=overlaps[1],
        max_images=1500,
        error_budget_px=1.0,
        **dict(zip(("yaw_deg", "tilt_deg", "roll_deg"), attitude)),
    )
    try:
        made = plan(mission, GRID)
    except InvalidInput as refused:
        assume("the limit is" not in str(refused))
        raise
    assert made.coverage.complete
    lon, lat = places_of(mission.area, 60)
    assert seen_by(made, np.arange(len(made)), lon, lat).min() >= 1


def test_points_face_the_next_one_that_is_elsewhere():
    corners = ((35.0, -89.0, 120.0), (35.0, -89.0, 120.0), (35.01, -89.0, 120.0), (35.01, -89.02, 120.0))
    points = Points((*corners, corners[-1]))
    made = plan(Mission(points, 120.0, facing="track", yaw_deg=5.0), GRID)
    west, _, _ = GEOD.inv(-89.0, 35.01, -89.02, 35.01)
    assert off_deg(made.poses.yaw_deg - np.array([5.0, 5.0, west + 5.0, west + 5.0, west + 5.0])).max() < 1e-6
    own = plan(Mission(Points(corners, yaws_deg=(1.0, 2.0, 3.0, 4.0)), 120.0, facing="track"), GRID)
    assert own.poses.yaw_deg.tolist() == [1.0, 2.0, 3.0, 4.0]
    alone = plan(Mission(Points(corners[:1]), 120.0, facing="track"), GRID)
    assert alone.poses.yaw_deg.tolist() == [0.0]
    fixed = plan(Mission(points, 120.0, facing="40"), GRID)
    assert fixed.poses.yaw_deg.tolist() == [40.0] * 5


def test_wind_disturbs_cameras_about_their_track():
    still = plan(SCENES["track"], GRID)
    made = plan(SCENES["track"].replace(wind=Wind(6.0, 250.0, 0.2)), GRID)
    assert made.nominal is not None
    assert np.array_equal(made.nominal.yaw_deg, still.poses.yaw_deg)
    off = off_deg(made.poses.yaw_deg - made.nominal.yaw_deg)
    assert 0.0 < off.max() < 45.0


@pytest.mark.parametrize(
    ("facing", "says"),
    [
        ("east", "camera faces 'east': must be north, track or an azimuth from -360 to 360"),
        ("361", "from -360 to 360"),
        ("", "must be north, track"),
        ("nan", "must be north, track"),
    ],
)
def test_what_no_camera_faces_is_refused(facing, says):
    with pytest.raises(InvalidInput, match=says):
        Mission(FIELD, 120.0, facing=facing)


def test_the_published_grid_is_north_up():
    with pytest.raises(InvalidInput, match=r"camera facing track: the layout paper does not support it; use --layout"):
        plan(Mission(FIELD, 120.0, facing="track", layout="paper"), GRID)


def test_files_say_what_cameras_face_only_where_that_is_not_north():
    assert "facing" not in Mission(FIELD, 120.0).to_json()
    turned = Mission(FIELD, 120.0, facing=33)
    assert turned.to_dict()["flight"]["facing"] == "33"
    assert Mission.from_json(turned.to_json()) == turned
