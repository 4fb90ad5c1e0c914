"""Web Mercator and pixel grids against PROJ, exact fractions and 50 digits."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyproj import Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.mercator import (
    HALF_WORLD_M,
    MAX_LAT_DEG,
    PixelGrid,
    fitting_zoom,
    lat_to_v,
    lon_to_u,
    u_to_lon,
    v_to_lat,
    wrap_lon_deg,
)


def exact_v(lat_deg):
    """World fraction of a latitude at 50 digits."""
    with mpmath.workdps(50):
        phi = mpmath.radians(mpmath.mpf(float(lat_deg)))
        return mpmath.mpf(1) / 2 - mpmath.asinh(mpmath.tan(phi)) / (2 * mpmath.pi)


def test_positions_are_projs():
    lon = np.linspace(-180, 180, 37)
    lat = np.linspace(-85.05, 85.05, 37)
    x, y = Transformer.from_crs(4326, 3857, always_xy=True).transform(lon, lat)
    np.testing.assert_allclose((lon_to_u(lon) - 0.5) * 2 * HALF_WORLD_M, x, atol=1e-8)
    np.testing.assert_allclose((0.5 - lat_to_v(lat)) * 2 * HALF_WORLD_M, y, atol=2e-8)


@pytest.mark.parametrize("lat", [1e-9, 35.14, 84.9999, 85.0001, 89.0, 89.999, 89.999999, -89.9999])
def test_the_forward_keeps_its_digits_to_the_poles(lat):
    # A pixel of zoom 22 is 9e-10 of the world.
    assert abs(float(exact_v(lat) - mpmath.mpf(float(lat_to_v(np.array(lat)))))) < 5e-16 * max(
        1.0, 1 / math.cos(math.radians(lat)) * 1e-3
    )


def test_the_poles_are_infinitely_far():
    assert lat_to_v(np.array([90.0, -90.0])).tolist() == [-math.inf, math.inf]


@given(st.floats(-89.9999, 89.9999))
def test_latitudes_come_back(lat):
    assert float(v_to_lat(lat_to_v(np.array(lat)))) == pytest.approx(lat, abs=3e-14 * 90)


@given(st.floats(-540, 540))
def test_longitudes_come_back(lon):
    assert float(u_to_lon(lon_to_u(np.array(lon)))) == pytest.approx(lon, abs=2e-13)


@given(st.floats(-1000, 1000))
def test_wrapped_longitudes_are_the_same_place(lon):
    wrapped = float(wrap_lon_deg(np.array(lon)))
    assert -180.0 <= wrapped < 180.0
    turns = (lon - wrapped) / 360.0
    assert turns == pytest.approx(round(turns), abs=1e-12)
    if -180.0 <= lon < 180.0:
        assert wrapped == lon


def test_the_world_is_square():
    assert v_to_lat(np.array([0.0, 1.0])).tolist() == pytest.approx([MAX_LAT_DEG, -MAX_LAT_DEG])
    assert pytest.approx(85.0511287798066) == MAX_LAT_DEG


@pytest.mark.parametrize("tile_px", [256, 512])
def test_window_edges_are_stated_from_the_corner_of_the_world(tile_px):
    grid = PixelGrid(tile_px=tile_px)
    west, south, east, north = grid.edges(*(np.array([v]) for v in (1000, 2000, 300, 200)), zoom=14)
    resolution = Fraction(2 * HALF_WORLD_M) / (tile_px * 2**14)
    assert float(west[0]) == pytest.approx(float(-Fraction(HALF_WORLD_M) + 1000 * resolution), abs=1e-8)
    assert float(east[0]) == pytest.approx(float(-Fraction(HALF_WORLD_M) + 1300 * resolution), abs=1e-8)
    assert float(north[0]) == pytest.approx(float(Fraction(HALF_WORLD_M) - 2000 * resolution), abs=1e-8)
    assert float(south[0]) == pytest.approx(float(Fraction(HALF_WORLD_M) - 2200 * resolution), abs=1e-8)


def test_ground_per_pixel_is_the_papers_table():
    grid = PixelGrid()
    assert float(grid.ground_m_per_px(np.array(0.0), np.array(0.0), 0)) == pytest.approx(156_543.03, abs=0.01)
    assert float(grid.ground_m_per_px(np.array(0.0), np.array(0.0), 19)) == pytest.approx(0.2986, abs=1e-4)


@given(st.integers(0, 22), st.integers(1, 4096))
def test_a_span_of_exactly_the_size_fits(zoom, size):
    span = size / (256.0 * 2**zoom)
    assert fitting_zoom(span, size) == zoom


@given(st.floats(1e-12, 10.0), st.integers(1, 4096))
def test_the_fitting_zoom_is_the_highest(span, size):
    zoom = fitting_zoom(span, size)
    factor = Fraction(2) ** zoom
    assert Fraction(span) * 256 * factor <= size * (1 + Fraction(2, 10**6))
    assert Fraction(span) * 256 * factor * 2 > size


@pytest.mark.parametrize("span", [0.0, -1.0, math.nan, math.inf])
def test_spans_that_are_not_positive_are_refused(span):
    with pytest.raises(InvalidInput, match="span"):
        fitting_zoom(span, 640)


@pytest.mark.parametrize(
    "bad", [{"tile_px": 300}, {"tile_px": 0}, {"native_zoom": 23}, {"min_zoom": 5, "native_zoom": 4}]
)
def test_impossible_grids_are_refused(bad):
    with pytest.raises(InvalidInput, match=r"tile size|zooms"):
        PixelGrid(**bad)
