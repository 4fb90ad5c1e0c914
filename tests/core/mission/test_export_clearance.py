"""Files for those who fly keep clear of the relief all along their legs, or are refused with the place."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pyproj
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their relief by GDAL's Python module")

from terrainav.core.elevation import layered as elevation  # noqa: E402
from terrainav.core.errors import InvalidInput  # noqa: E402
from terrainav.core.geodesy.camera import Camera  # noqa: E402
from terrainav.core.geodesy.mercator import PixelGrid  # noqa: E402
from terrainav.core.geodesy.projections import LocalPlane  # noqa: E402
from terrainav.core.mission.areas.area import Box, Points, Polygon  # noqa: E402
from terrainav.core.mission.export import write_plan  # noqa: E402
from terrainav.core.mission.flight.path import TRANSIT  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402
from terrainav.core.mission.relief import path_ground  # noqa: E402
from terrainav.core.picture.heights import mission_heights  # noqa: E402

from tests.core.mission.flown_reader import Ground, Leg, least_clearance_m, legs_of  # noqa: E402
from tests.core.mission.relief_files import NORTH, WEST, placed, write_relief  # noqa: E402
from tests.core.mission.wpml_reader import Wpml  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.thinning import sampled  # noqa: E402

SIDE, CELL = 500, 2.0
GRID, CAMERA = PixelGrid(max_zoom=20, native_zoom=20), Camera(78.8, 4 / 3)
GEOD = pyproj.Geod(ellps="WGS84")
ENDINGS = (".plan", ".survey.plan", ".kmz", ".litchi.csv", ".gpx", ".kml", ".gpkg")
#: Digits of the files, and what they make of a wall of 60 m a cell.
LEAST_M = -0.06
#: Images of a random mission that is tried; steep ground right below asks for very many.
MOST_IMAGES = 300


def hill(x, y):
    return 100.0 + 60.0 * np.exp(-((x - 500.0) ** 2 + (y - 500.0) ** 2) / (2.0 * 150.0**2))


def cliffs(x, y):
    return 100.0 + 45.0 * (x + 0.4 * y > 700.0) - 20.0 * (y > 560.0)


def towers(x, y):
    return hill(x, y) + 25.0 * ((x % 70.0 < 8.0) & (y % 90.0 < 8.0))


def rough(x, y):
    return 100.0 + 12.0 * np.sin(x / 11.0) * np.cos(y / 7.0) + 15.0 * np.sin(x / 60.0)


def masts(x, y):
    """On both sides of a square of 36 m."""
    return 100.0 + 50.0 * ((np.abs(x - 500.0) < 14.0) & (np.abs(np.abs(y - 500.0) - 25.0) < 6.0))


def level(x, y):
    return np.full(x.shape, 100.0)


SURFACES = (level, masts, hill, cliffs, towers, rough)


@pytest.fixture(scope="module")
def dem(tmp_path_factory):
    """Paths of surfaces by name, as files of 2 m pixels."""
    return write_relief(tmp_path_factory.mktemp("dem"), SURFACES, SIDE, CELL)


def box(west, south, east, north):
    (north_lat, west_lon), (south_lat, east_lon) = placed(west, north), placed(east, south)
    return Box(north_lat, west_lon, south_lat, east_lon)


def square(x, y, half):
    corners = ((x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half))
    return Polygon((tuple(placed(*corner)[::-1] for corner in corners),))


def worked_out(mission):
    return plan(mission, GRID, mission_heights(mission))


def shortfalls(made, folder, endings=ENDINGS):
    """By file, the least that legs keep beyond what is asked for, as read by another reader, and where."""
    terrain = made.mission.terrain
    surface = Ground((terrain.surface or terrain.elevation)[0])
    ground = Ground(terrain.elevation[0])
    found = {}
    for ending in endings:
        try:
            files = write_plan(made, folder / f"field{ending}").files
        except InvalidInput as wrong:
            if "survey" in str(wrong) or "of one waypoint" in str(wrong):
                continue
            raise
        for file in files:
            legs = legs_of(file, ground, made.mission.route.takeoff)
            least, where = least_clearance_m(legs, surface, terrain.clearance_distance_m)
            found[file.name] = least - terrain.clearance_m, where
            if terrain.height_above == "ground":
                # Where heights are above the ground, nine tenths of them are kept.
                least, where = least_clearance_m(legs, ground)
                least -= 0.9 * float(made.meant.agl_m.min())
                found[file.name] = min(found[file.name], (least, where), key=lambda one: one[0])
    return found


@pytest.mark.parametrize("trigger", sampled(["waypoint", "distance", "hover"], 2))
def test_a_hill_of_60_m_is_flown_over_at_30_m_in_every_file(dem, tmp_path, trigger):
    mission = Mission(box(400.0, 570.0, 620.0, 430.0), 30.0, CAMERA, elevation=(dem["hill"],), trigger=trigger)
    made = worked_out(mission)
    found = shortfalls(made, tmp_path)
    assert {ending for ending in ENDINGS if any(name.endswith(ending) for name in found)} == set(ENDINGS)
    assert min(least for least, _ in found.values()) >= LEAST_M


@pytest.mark.parametrize("ending", sampled(ENDINGS, 3))
def test_a_detour_keeps_clear_of_the_tower_that_it_passes(dem, tmp_path, ending):
    # One row, and on both ways around the square stands a mast that no image is taken above.
    mission = Mission(
        box(430.0, 504.0, 570.0, 496.0),
        80.0,
        Camera(40.0, 1.0),
        elevation=(dem["level"],),
        surface=(dem["masts"],),
        clearance_m=40.0,
        no_fly=(square(500.0, 500.0, 18.0),),
    )
    made = worked_out(mission)
    assert (made.path.kind == TRANSIT).any()
    for least, where in shortfalls(made, tmp_path, [ending]).values():
        assert least >= LEAST_M, where


def test_places_far_apart_are_flown_between_over_the_finest_heights(dem, tmp_path, monkeypatch):
    """More relief than is read at once: towers narrower than cells of what holds all of it."""
    monkeypatch.setattr(elevation, "MOST_CELLS", 1 << 17)
    monkeypatch.setattr(path_ground, "_TILE_CELLS", 64)
    mission = Mission(
        box(60.0, 180.0, 180.0, 60.0),
        45.0,
        CAMERA,
        elevation=(dem["level"],),
        surface=(dem["towers"],),
        clearance_m=15.0,
        takeoff=placed(930.0, 930.0),
    )
    made = worked_out(mission)
    lat, lon = made.path.lat_deg, made.path.lon_deg
    whole = made.relief.around(lat, lon, 0.0)
    assert isinstance(whole, path_ground.TiledPathGround)
    # The squares together are what one surface is.
    monkeypatch.setattr(elevation, "MOST_CELLS", 1 << 23)
    at_once, plane = made.relief._read_around(lat, lon, 0.0), LocalPlane(float(lat[0]), float(lon[0]))
    np.testing.assert_allclose(whole.highest_m(lat, lon), at_once.highest_m(lat, lon), atol=1e-6)
    np.testing.assert_allclose(whole.ground_m(lat, lon), at_once.ground_m(lat, lon), atol=1e-6)
    parts, one = (below.profile(lat, lon, plane, 5) for below in (whole, at_once))
    for leg in range(5, 5 + len(lat) - 1):
        own, other = parts.leg == leg, one.leg == leg
        assert own.sum() >= other.sum()
        on_leg = np.interp(one.share[other], parts.share[own], parts.highest_m[own])
        np.testing.assert_allclose(on_leg, one.highest_m[other], atol=0.5)
    assert min(least for least, _ in shortfalls(made, tmp_path, [".plan", ".kmz"]).values()) >= LEAST_M


def test_the_limit_of_a_drone_holds_for_each_file_of_a_flight(tmp_path):
    """Down a slope of 700 m and back up: the second file begins in the valley, from where its heights count."""
    size = 7000
    row = np.arange(size)[:, np.newaxis]
    slope = np.repeat(np.clip((6700.0 - row) * 0.1, 0.0, 700.0), 350, axis=1)
    path, transform = tmp_path / "slope.tif", (WEST, 2.0, 0.0, NORTH, 0.0, -1.0)
    rasters.write(path, slope[np.newaxis], transform, 32618, data_type=gdal.GDT_Float32)
    along = np.concatenate([np.linspace(200.0, 6800.0, 110), np.linspace(6800.0, 200.0, 190)])
    places = [placed(350.0 + 0.2 * at, y) for at, y in enumerate(along.tolist())]
    points = Points(tuple((lat, lon, 60.0) for lat, lon in places))
    made = worked_out(Mission(points, 60.0, CAMERA, elevation=(str(path),), drone="dji-fly"))
    with pytest.raises(InvalidInput, match=r"DJI mission at \d+(\.\d+)? m: must be 500 m above the take-off or less"):
        write_plan(made, tmp_path / "field.kmz")


def without_lifts(made):
    """The plan with a path of nothing but its captures."""
    path = made.path
    kept = {name: values[path.capture >= 0] for name, values in vars(path).items() if isinstance(values, np.ndarray)}
    made.__dict__["path"] = replace(path, **kept)
    return made


def refused(made, target):
    """How far short of its clearance, or how deep, a refusal says that a file is, and where."""
    target.write_bytes(b"mine")
    with pytest.raises(InvalidInput, match=re.escape(f"{target.name}: between waypoints ")) as wrong:
        write_plan(made, target)
    # What was there is there, and nothing else.
    assert [path.name for path in target.parent.iterdir()] == [target.name]
    assert target.read_bytes() == b"mine"
    return [float(value) for value in re.findall(r"-?\d+\.\d+", str(wrong.value).replace(" of 50 m", ""))]


@pytest.mark.parametrize("ending", sampled(ENDINGS, 3))
def test_a_file_that_does_not_keep_the_clearance_is_refused_with_the_place(dem, tmp_path, ending):
    mission = Mission(box(380.0, 560.0, 520.0, 440.0), 60.0, CAMERA, elevation=(dem["towers"],), clearance_m=50.0)
    made = without_lifts(worked_out(mission))
    path = made.path
    places = list(zip(path.lat_deg.tolist(), path.lon_deg.tolist(), path.height_m.tolist()))
    least, (lat, lon, _) = least_clearance_m([Leg(*pair) for pair in zip(places, places[1:])], Ground(dem["towers"]))
    short, *place = refused(made, tmp_path / f"field{ending}")
    assert short == pytest.approx(50.0 - least, abs=0.3)
    assert GEOD.inv(place[1], place[0], lon, lat)[2] < 2.0


@pytest.mark.parametrize("ending", [one for one in ENDINGS if one != ".survey.plan"])
def test_a_flight_into_the_surface_is_refused_with_the_place(dem, tmp_path, ending):
    points = Points(tuple((*placed(x, 500.0), 15.0) for x in (330.0, 670.0)))
    made = without_lifts(worked_out(Mission(points, 15.0, Camera(20.0, 1.0), elevation=(dem["hill"],))))
    below, *place = refused(made, tmp_path / f"field{ending}")
    top = placed(500.0, 500.0)
    assert GEOD.inv(place[1], place[0], top[1], top[0])[2] < 5.0
    assert below == pytest.approx(160.0 - float(made.height_m.mean()), abs=0.1)


def test_over_relief_a_drone_cuts_corners_by_half_a_centimetre_at_most(dem, tmp_path):
    mission = Mission(box(380.0, 560.0, 520.0, 440.0), 60.0, CAMERA, elevation=(dem["towers"],), clearance_m=50.0)
    write_plan(worked_out(mission), tmp_path / "field.kmz")
    read = Wpml(tmp_path / "field.kmz")
    first = read.marks[0]
    plane = pyproj.Proj(proj="aeqd", lat_0=first.lat_deg, lon_0=first.lon_deg, ellps="WGS84")
    at = np.array([(*plane(one.lon_deg, one.lat_deg), one.height_m) for one in read.marks])
    way = np.diff(at, axis=0)
    way /= np.linalg.norm(way, axis=1)[:, np.newaxis]
    marks = read.folder.findall(read.path("Placemark"))[1:-1]
    damping = [float(read.text(one, "waypointTurnParam/waypointTurnDampingDist")) for one in marks]
    assert len(set(damping)) > 3
    assert 0.0 < max(damping) <= 0.2
    # Half-way between where the aircraft leaves its line and where it is on the next one.
    cut = np.array(damping) * np.linalg.norm(np.diff(way, axis=0), axis=1) / 2.0
    assert cut.max() <= 0.005 + 1e-6


def random_mission(rng, dem):
    """A mission over one of the surfaces, with as many of the options that change its legs as chance has it."""

    def chance(share, value, otherwise=None):
        return value if rng.random() < share else otherwise

    x, y = rng.uniform(330.0, 480.0, 2)
    wide, high = rng.uniform(60.0, 200.0, 2)
    agl = clear = float(rng.uniform(30.0, 70.0))
    area = box(x, y + high, x + wide, y)
    above = str(rng.choice(["ground", "ground", "ground", "takeoff", "ellipsoid"]))
    if rng.random() < 0.2:
        corners = rng.uniform(330.0, 680.0, (6, 2))
        area = Points(tuple((*placed(*corner), agl) for corner in corners))
    if above != "ground":
        # High enough for the highest of all surfaces.
        agl += 180.0 if above == "ellipsoid" else 90.0
        if isinstance(area, Points):
            area = Points(tuple((lat, lon, agl) for lat, lon, _ in area.poses))
    routed = rng.random() < 0.5
    takeoff = placed(*rng.uniform(300.0, 720.0, 2)) if routed else None
    ground = str(rng.choice(["hill", "cliffs", "towers", "rough", "masts"]))
    return Mission(
        area,
        agl,
        Camera(float(rng.uniform(25.0, 60.0)), 4 / 3),
        elevation=(dem[ground],),
        height_above=above,
        clearance_m=float(chance(0.7, rng.uniform(0.7, 1.0) * clear, 0.0)),
        clearance_distance_m=float(chance(0.5, rng.uniform(1.0, 15.0), 0.0)),
        climb_m_per_s=chance(0.3, float(rng.uniform(1.0, 5.0))),
        overlap_along=float(rng.uniform(0.0, 0.6)),
        overlap_across=float(rng.uniform(0.0, 0.4)),
        row_azimuth_deg=float(chance(0.4, rng.uniform(0.0, 180.0), 90.0)),
        trigger=str(rng.choice(["waypoint", "distance", "distance", "hover"])),
        order=str(rng.choice(["serpentine", "one-way"])),
        takeoff=takeoff,
        battery_min=chance(0.5, float(rng.uniform(2.0, 6.0))) if routed else None,
        turnaround_m=float(chance(0.3, rng.uniform(5.0, 30.0), 0.0)),
        lead_in_m=float(chance(0.3, rng.uniform(5.0, 20.0), 0.0)),
        no_fly=(square(x + wide * rng.random(), y + high * rng.random(), 12.0),) if rng.random() < 0.4 else (),
        drone=str(rng.choice(["mavic-3e", "m350", "dji-fly"])),
    )


@pytest.mark.parametrize(
    ("places", "takeoff", "no_fly"),
    [
        (((300.0, 475.0), (310.0, 475.0)), placed(700.0, 475.0), ()),
        (((300.0, 500.0), (700.0, 500.0)), None, (square(500.0, 500.0, 20.0),)),
    ],
    ids=["home", "around a no-fly area"],
)
def test_level_ground_below_images_says_nothing_of_the_ways_between(dem, tmp_path, places, takeoff, no_fly):
    """Masts of 50 m stand where no image is taken, and 37 m above the ground is not above them."""
    mission = Mission(
        Points(tuple((*placed(*at), 37.0) for at in places)),
        37.0,
        Camera(20.0, 1.0),
        elevation=(dem["masts"],),
        takeoff=takeoff,
        no_fly=no_fly,
    )
    found = shortfalls(worked_out(mission), tmp_path)
    assert len(found) >= 3
    assert min(least for least, _ in found.values()) >= LEAST_M


@pytest.mark.thorough
@pytest.mark.parametrize(
    "seeds",
    [(6, 8, 12, 19), pytest.param(range(400), marks=pytest.mark.thorough)],
    ids=["few", "many"],
)
def test_random_missions_keep_clear_of_relief_in_every_file(dem, tmp_path, seeds):
    flown = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        try:
            made = worked_out(random_mission(rng, dem))
            if len(made) > MOST_IMAGES:
                continue
            _ = made.path
        except InvalidInput:
            # What cannot be flown at all: below what is seen, a take-off in a no-fly area, a battery too small.
            continue
        folder = tmp_path / str(seed)
        folder.mkdir()
        for name, (least, where) in shortfalls(made, folder).items():
            assert least >= LEAST_M, (seed, name, where, made.mission.to_dict())
        flown += 1
    assert flown >= len(seeds) / 2
