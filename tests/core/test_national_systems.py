"""Ways to the coordinates of national systems and back, against PROJ's way there."""

from __future__ import annotations

import numpy as np
import pyproj
import pytest
from terrainav.core.benchmark.folder import ReferenceMosaic
from terrainav.core.dataset.labels import Frame
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.mosaic import raster

from tests.support.systems import NATIONAL
from tests.support.thinning import sampled

#: Noise of positions in degrees, and of coordinates, metres.
CLOSE_M = 1e-7
DEGREE_M = 111_320.0
SYSTEMS = pytest.mark.parametrize(("crs", "lat", "lon"), sampled(NATIONAL, 4))


def proj(crs):
    return pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True)


def unit_m(crs):
    return pyproj.CRS(crs).axis_info[0].unit_conversion_factor


def around(crs, lat, lon, count=40):
    """Eastings and northings within 10 km of a place, in the system's unit."""
    x, y = proj(crs).transform(lon, lat)
    east, north = np.random.default_rng(1).uniform(-1e4, 1e4, (2, count)) / unit_m(crs)
    return x + east, y + north


def plane_about(crs, lat, lon):
    x, y = proj(crs).transform(lon, lat)
    size = 2.0**16 / unit_m(crs)
    return ProjectedPlane(crs, x - size / 2, y + size / 2, size, size)


@SYSTEMS
def test_places_are_those_that_proj_takes_to_the_coordinates(crs, lat, lon):
    x, y = around(crs, lat, lon)
    found_lat, found_lon = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0).from_crs(x, y)
    there = proj(crs).transform(found_lon, found_lat)
    assert np.hypot(there[0] - x, there[1] - y).max() * unit_m(crs) < CLOSE_M
    # PROJ's own way back is near.
    back_lon, back_lat = proj(crs).transform(x, y, direction="INVERSE")
    assert np.abs(found_lat - back_lat).max() * DEGREE_M < 0.02
    assert np.abs(found_lon - back_lon).max() * DEGREE_M < 0.02


def by_turned_plane(crs, lat, lon):
    plane = plane_about(crs, lat, lon).turned(lat, lon, 33.0)
    return plane.forward, plane.inverse, 1.0


def by_fractions(crs, lat, lon):
    plane = plane_about(crs, lat, lon)
    return plane.forward, plane.inverse, plane.width * unit_m(crs)


def by_surface(crs, lat, lon):
    grid = PixelGrid(256, 0, 8, 8, plane=plane_about(crs, lat, lon))
    surface = Surface(grid, 8, 100, 100, np.zeros((2, 2)))
    return surface.position, surface.places, 1.0


def by_labels(crs, lat, lon):
    frame = Frame(crs, lat, lon)
    return (
        lambda at_lat, at_lon: tuple(frame.forward(at_lat, at_lon).T),
        lambda x, y: frame.inverse(np.stack([x, y], axis=1)),
        unit_m(crs),
    )


def by_mosaic(crs, lat, lon):
    plane = plane_about(crs, lat, lon)
    return (
        lambda at_lat, at_lon: raster.positions(plane, at_lat, at_lon),
        lambda x, y: raster.places(plane, x, y),
        unit_m(crs),
    )


def by_benchmark(crs, lat, lon):
    plane, pixel = plane_about(crs, lat, lon), 0.5 / unit_m(crs)
    mosaic = ReferenceMosaic("mosaic.tif", crs, plane.west, plane.north, pixel, pixel, 2**17, 2**17)
    return mosaic.px, mosaic.ground, 0.5


WAYS = (by_fractions, by_turned_plane, by_surface, by_labels, by_mosaic, by_benchmark)


@pytest.mark.parametrize("way", sampled(WAYS, 4))
@SYSTEMS
def test_each_pair_of_ways_leads_back(way, crs, lat, lon):
    there, back, unit = way(crs, lat, lon)
    rng = np.random.default_rng(2)
    lats, lons = lat + rng.uniform(-0.05, 0.05, 20), lon + rng.uniform(-0.05, 0.05, 20)
    x, y = there(lats, lons)
    back_lat, back_lon = back(x, y)
    assert np.abs(back_lat - lats).max() * DEGREE_M < 2.0 * CLOSE_M
    assert np.abs(back_lon - lons).max() * DEGREE_M < 2.0 * CLOSE_M / np.cos(np.radians(lat))
    again_x, again_y = there(back_lat, back_lon)
    assert np.hypot(again_x - x, again_y - y).max() * unit < 2.0 * CLOSE_M


@pytest.mark.parametrize("crs", ["EPSG:2056", "EPSG:27700", "EPSG:3031", "EPSG:3035", "EPSG:5880"])
def test_a_place_does_not_depend_on_those_it_is_asked_with(crs):
    lat, lon = {"EPSG:3031": (-80.0, 30.0), "EPSG:3035": (50.0, 5.0)}.get(
        crs, next((place[1:] for place in NATIONAL if place[0] == crs), None)
    )
    plane = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0)
    x, y = around(crs, lat, lon)
    together = np.stack(plane.from_crs(x, y))
    alone = np.concatenate([plane.from_crs(x[k : k + 1], y[k : k + 1]) for k in range(len(x))], axis=1)
    np.testing.assert_array_equal(together, alone)
    assert together.shape == np.stack(plane.from_crs(x.reshape(8, 5), y.reshape(8, 5))).reshape(2, -1).shape


@pytest.mark.parametrize(("crs", "middle"), [("EPSG:4230", 12.0), ("EPSG:4326", 180.0), ("EPSG:4272", 180.0)])
def test_degrees_of_other_datums_lead_back_across_the_antimeridian(crs, middle):
    plane = ProjectedPlane(crs, middle - 1.0, 46.0, 2.0, 2.0)
    rng = np.random.default_rng(3)
    x, y = middle + rng.uniform(-1, 1, 50), rng.uniform(44, 46, 50)
    there = plane.to_crs(*plane.from_crs(x, y))
    assert np.hypot(there[0] - x, there[1] - y).max() * DEGREE_M < 2.0 * CLOSE_M


@pytest.mark.parametrize("crs", ["EPSG:2056", "EPSG:27700", "EPSG:32632"])
def test_coordinates_that_no_place_has_give_none(crs):
    lat, lon = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0).from_crs(np.array([np.nan, np.inf]), np.zeros(2))
    assert np.isnan(lat).all()
    assert np.isnan(lon).all()
