"""The height profile of a flight: heights as read from the raster, distances as flown, and nothing lost by thinning."""

from __future__ import annotations

import numpy as np
import pyproj
import pytest

pytest.importorskip("osgeo.gdal", reason="the tests make their relief by GDAL's Python module")

from terrainav.core.errors import Cancelled
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.projections import LocalPlane
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.path import CAPTURE, LANDING, TAKEOFF
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.profile import BETWEEN, height_profile
from terrainav.core.mission.relief import path_ground
from terrainav.core.picture.heights import mission_heights
from terrainav.core.waiting import cancellable

from tests.core.mission.flights import ACROSS, ALONE, HERE
from tests.core.mission.flights import worked_out as worked_out_level
from tests.core.mission.flown_reader import Ground
from tests.core.mission.relief_files import placed, write_relief

SIDE, CELL = 400, 3.0
GRID, CAMERA = PixelGrid(max_zoom=20, native_zoom=20), Camera(78.8, 4 / 3)
GEOD = pyproj.Geod(ellps="WGS84")
#: Straight lines of a plane and of another one, and pieces straight in degrees, part by less than this.
SAME_M = 0.02


def terrain(x, y):
    return 100.0 + 15.0 * np.sin(x / 90.0) * np.cos(y / 70.0)


def towers(x, y):
    """On the terrain, with edges across the grid."""
    return terrain(x, y) + 25.0 * (((x + 0.3 * y) % 110.0 < 14.0) & ((y - 0.2 * x) % 130.0 < 11.0))


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Paths of ground and surface, as files of 3 m pixels."""
    return write_relief(tmp_path_factory.mktemp("dem"), (terrain, towers), SIDE, CELL)


def over_towers(dem, **more):
    (north, west), (south, east) = placed(420.0, 500.0), placed(760.0, 720.0)
    mission = Mission(
        Box(north, west, south, east),
        60.0,
        CAMERA,
        elevation=(dem["terrain"],),
        surface=(dem["towers"],),
        takeoff=placed(300.0, 830.0),
        **more,
    )
    return plan(mission, GRID, mission_heights(mission))


def sampled_clearance_m(made, surface, radius_m=0.0):
    """Least clearance on straight lines from point to point of the path, without climbs, every few centimetres."""
    path, least = made.path, np.inf
    plane = LocalPlane(float(path.lat_deg.mean()), float(path.lon_deg.mean()))
    x, y = plane.forward(path.lat_deg, path.lon_deg)
    for leg in range(len(path) - 1):
        if path.kind[leg] in (TAKEOFF, LANDING) or path.kind[leg + 1] == LANDING:
            continue
        share = np.linspace(0.0, 1.0, 2 + int(np.hypot(x[leg + 1] - x[leg], y[leg + 1] - y[leg]) / 0.04))
        lat, lon = plane.inverse(*(at[leg] + share * (at[leg + 1] - at[leg]) for at in (x, y)))
        height = path.height_m[leg] + share * (path.height_m[leg + 1] - path.height_m[leg])
        top = surface.highest(lat, lon, radius_m) if radius_m else surface.at(lat, lon)
        least = min(least, float((height - top).min()))
    return least


def test_heights_are_those_of_the_rasters(dem):
    made = over_towers(dem, battery_min=4.0, trigger="hover")
    found = height_profile(made)
    assert found.has_surface
    assert not found.is_level
    assert made.path.sorties > 1
    ground, surface = Ground(dem["terrain"]), Ground(dem["towers"])
    assert found.ground_m == pytest.approx(ground.at(found.lat_deg, found.lon_deg), abs=1e-3)
    # Along pieces straight in degrees, points are millimetres off the crossings; walls rise by 8 m a metre.
    assert found.surface_m == pytest.approx(surface.at(found.lat_deg, found.lon_deg), abs=SAME_M)
    assert found.clearance_m == pytest.approx(found.height_m - found.surface_m, abs=1e-9)
    assert (found.surface_m - found.ground_m).max() > 20.0


def test_no_least_clearance_is_missed(dem):
    made = over_towers(dem)
    found = height_profile(made)
    at = found.lowest
    sampled = sampled_clearance_m(made, Ground(dem["towers"]))
    assert found.clearance_m[at] == pytest.approx(sampled, abs=SAME_M)
    assert found.kind[at] not in (TAKEOFF, LANDING)


def test_the_clearance_counts_what_stands_within_its_distance(dem):
    made = over_towers(dem, clearance_m=5.0, clearance_distance_m=12.0)
    found = height_profile(made)
    least = float(found.clearance_m[found.lowest])
    assert 5.0 - 1e-3 <= least <= sampled_clearance_m(made, Ground(dem["towers"]), 12.0) + SAME_M
    assert (found.clearance_m <= found.height_m - found.surface_m + 1e-9).all()


def test_the_way_is_that_of_the_path(dem):
    made = over_towers(dem, battery_min=4.0, trigger="hover", turnaround_m=20.0, lead_in_m=15.0)
    path, found = made.path, height_profile(made)
    assert found.distance_m[0] == 0.0
    assert (np.diff(found.distance_m) >= 0.0).all()
    flown = 0.0
    for one in range(path.sorties):
        part = path.sortie_path(one)
        flown += GEOD.line_length(part.lon_deg, part.lat_deg)
    assert found.length_m == pytest.approx(flown, rel=1e-9)
    of_path = found.kind != BETWEEN
    for name in ("lat_deg", "lon_deg", "height_m", "kind", "sortie"):
        assert getattr(found, name)[of_path] == pytest.approx(getattr(path, name), abs=1e-9)
    taken = found.kind == CAPTURE
    assert found.image[taken].tolist() == list(range(len(made)))
    # From image to image, the number is that of the last one.
    assert found.image.tolist() == np.maximum.accumulate(np.where(taken, found.image, -1)).tolist()
    # A climb has no points between its ends.
    first, second = np.flatnonzero(found.kind == TAKEOFF)[0], np.flatnonzero(found.kind == TAKEOFF)[0] + 1
    assert found.distance_m[first] == found.distance_m[second]
    assert found.kind[second] != BETWEEN


@pytest.mark.parametrize("most", [60, 400])
def test_a_thinned_profile_loses_no_extreme(dem, most):
    made = over_towers(dem, battery_min=4.0, trigger="hover")
    whole, thinned = height_profile(made, 10**7), height_profile(made, most)
    assert len(whole) > 8 * most
    # First and last point, and the ends of sorties, come on top.
    assert len(thinned) <= most + 12 + 2 * made.path.sorties
    assert float(thinned.clearance_m[thinned.lowest]) == float(whole.clearance_m[whole.lowest])
    assert thinned.length_m == whole.length_m
    for name, extreme in (("surface_m", np.max), ("ground_m", np.max), ("ground_m", np.min), ("height_m", np.max)):
        assert extreme(getattr(thinned, name)) == extreme(getattr(whole, name))
    # Each stretch has the extremes of all its points.
    count = most // 6
    edges = np.append(np.linspace(0.0, whole.length_m, count + 1)[:-1], np.inf)
    flown = [~np.isin(one.kind, (TAKEOFF, LANDING)) for one in (whole, thinned)]
    for one in (whole, thinned):
        assert (np.diff(one.distance_m) >= 0.0).all()
    for low, high in zip(edges[:-1], edges[1:]):
        least = [
            one.clearance_m[some & (one.distance_m >= low + 1e-6) & (one.distance_m < high - 1e-6)]
            for one, some in zip((whole, thinned), flown)
        ]
        if len(least[0]):
            assert least[1].min() == least[0].min()
    assert set(np.unique(thinned.sortie)) == set(np.unique(whole.sortie))


def test_a_part_shows_what_the_whole_has_there(dem):
    found = height_profile(over_towers(dem))
    part = found.part(500.0, 900.0, 100)
    there = (found.distance_m >= 500.0) & (found.distance_m <= 900.0)
    # With the points on both sides, so that lines go on.
    assert part.distance_m[0] < 500.0
    assert part.distance_m[-1] > 900.0
    assert len(part) <= 100 + 12
    inside = (part.distance_m >= 500.0) & (part.distance_m <= 900.0)
    assert part.clearance_m[inside].min() == found.clearance_m[there].min()
    assert part.surface_m[inside].max() == found.surface_m[there].max()
    assert found.part(-10.0, 1e9, 10**6).distance_m.tolist() == found.distance_m.tolist()


def test_relief_read_in_tiles_gives_the_same_profile(dem, monkeypatch):
    whole = height_profile(over_towers(dem))
    monkeypatch.setattr(path_ground, "_TILE_CELLS", 32)
    made = over_towers(dem)
    tiled = made.relief._tiled
    monkeypatch.setattr(type(made.relief), "around", lambda *_: tiled)
    found = height_profile(made)
    assert float(found.clearance_m[found.lowest]) == pytest.approx(float(whole.clearance_m[whole.lowest]), abs=SAME_M)
    assert np.interp(whole.distance_m, found.distance_m, found.ground_m) == pytest.approx(whole.ground_m, abs=SAME_M)


def test_one_model_is_ground_and_surface(dem):
    mission = Mission(Points(((*placed(500.0, 600.0), 50.0),)), 50.0, CAMERA, elevation=(dem["terrain"],))
    found = height_profile(plan(mission, GRID, mission_heights(mission)))
    assert not found.has_surface
    assert len(found) == 1
    below = float(Ground(dem["terrain"]).at(*placed(500.0, 600.0)))
    assert found.ground_m.tolist() == pytest.approx([below], abs=1e-3)
    assert found.clearance_m.tolist() == pytest.approx([50.0], abs=0.01)


def test_level_ground_has_one_height():
    for mission in (HERE, ACROSS, ALONE, HERE.replace(takeoff=(35.15, -89.9), ground_height_m=80.0)):
        made = worked_out_level(mission)
        found = height_profile(made)
        assert found.is_level
        assert not found.has_surface
        assert len(found) == len(made.path)
        assert set(found.ground_m.tolist()) == {mission.flight.ground_height_m}
        assert found.clearance_m == pytest.approx(made.path.agl_m)
        assert found.length_m == pytest.approx(made.path.distance_m)
        assert float(found.clearance_m[found.lowest]) == pytest.approx(mission.flight.agl_m)


def test_long_flights_over_level_ground_are_thinned():
    made = worked_out_level(Mission(Box(35.2, -90.0, 35.1, -89.9), 120.0, overlap_along=0.6))
    found = height_profile(made, 120)
    assert len(made) > 1000
    assert len(found) <= 120 + 12
    assert found.image[-1] == len(made) - 1


def test_a_profile_that_is_not_wanted_any_more_is_given_up(dem):
    made = over_towers(dem)
    with cancellable(lambda: True), pytest.raises(Cancelled):
        height_profile(made)
