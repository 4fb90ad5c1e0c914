"""Local frames against the definition of geocentric coordinates, and attitudes against their own axes."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.geodesy.camera import attitude_from_axes, image_axes
from terrainav.core.geodesy.local import LocalFrame, enu_axes, geodetic


def geocentric(lat_deg: float, lon_deg: float, height_m: float) -> np.ndarray:
    lat, lon = math.radians(lat_deg), math.radians(lon_deg)
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    n = a / math.sqrt(1.0 - e2 * math.sin(lat) ** 2)
    return np.array(
        [
            (n + height_m) * math.cos(lat) * math.cos(lon),
            (n + height_m) * math.cos(lat) * math.sin(lon),
            (n * (1.0 - e2) + height_m) * math.sin(lat),
        ]
    )


latitudes, longitudes = st.floats(-89.0, 89.0), st.floats(-180.0, 180.0)


@given(
    latitudes,
    longitudes,
    st.floats(-100.0, 3000.0),
    st.floats(-0.1, 0.1),
    st.floats(-0.1, 0.1),
    st.floats(0.0, 500.0),
)
def test_places_are_differences_turned_into_the_frames_axes(lat, lon, height, dlat, dlon, up):
    frame = LocalFrame(lat, lon, height)
    place = (lat + dlat, lon + dlon, height + up)
    expected = enu_axes(lat, lon) @ (geocentric(*place) - geocentric(lat, lon, height))
    found = frame.enu(*(np.array([value]) for value in place))[0]
    assert np.abs(found - expected).max() < 1e-6
    again = [float(value[0]) for value in frame.geodetic(found[np.newaxis])]
    assert np.abs(geocentric(*again) - geocentric(*place)).max() < 1e-6


@given(latitudes, longitudes, latitudes, longitudes)
def test_vectors_are_turned_from_frame_to_frame(lat, lon, other_lat, other_lon):
    turn = LocalFrame(lat, lon).rotations(other_lat, other_lon)
    assert np.abs(turn @ turn.T - np.eye(3)).max() < 1e-12
    assert np.abs(enu_axes(other_lat, other_lon).T @ turn - enu_axes(lat, lon).T).max() < 1e-12


@given(st.floats(-179.0, 179.0), st.floats(-89.0, 89.0), st.floats(-179.0, 179.0))
def test_attitudes_are_those_that_made_the_axes(yaw, tilt, roll):
    found = [float(angle) for angle in attitude_from_axes(*image_axes(yaw, tilt, roll))]
    for axes, own in zip(image_axes(*found), image_axes(yaw, tilt, roll)):
        assert np.abs(axes - own).max() < 1e-12
    assert abs(found[1] - tilt) < 1e-9


@given(lat=latitudes, lon=longitudes, height=st.floats(-500.0, 9000.0))
def test_geodetic_positions_are_those_whose_geocentric_coordinates_were_given(lat, lon, height):
    found = geodetic(geocentric(lat, lon, height)[np.newaxis])
    assert np.abs(geocentric(*(float(one[0]) for one in found)) - geocentric(lat, lon, height)).max() < 1e-6
