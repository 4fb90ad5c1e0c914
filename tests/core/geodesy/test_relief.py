"""First points of a surface that rays meet, against marches in steps too small to pass by anything."""

from __future__ import annotations

import numpy as np
import pyproj
import pytest
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.raytracing.paths import Paths, evaluate, fit_paths
from terrainav.core.geodesy.raytracing.pixel_rays import PixelRays
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.geodesy.raytracing.tracing import Tracing

from tests.support.thinning import sampled

pytestmark = pytest.mark.usefixtures("ray_code")

CAMERA = Camera(78.8, 4 / 3)
#: Pixels of the images, cells of the surfaces, and metres of a cell.
WIDTH, HEIGHT, SIDE, CELL = 160, 120, 240, 1.0
MARCHED = 40_000


def wall(z):
    z[:, z.shape[1] // 2] = 20.0


def spikes(z):
    rng = np.random.default_rng(1)
    z[rng.integers(0, z.shape[0], 6), rng.integers(0, z.shape[1], 6)] = 25.0


def checkerboard(z):
    z += 5.0 * (np.indices(z.shape).sum(axis=0) % 2)


def cliff(z):
    z[:, z.shape[1] // 2 :] = 30.0


def noise(z):
    z += np.random.default_rng(2).normal(0.0, 3.0, z.shape)


def hills(z):
    y, x = np.indices(z.shape) / 9.0
    z += 2.0 * np.sin(x) * np.cos(1.3 * y) + 0.5 * np.sin(3.1 * x + y)


def hole(z):
    hills(z)
    z[z.shape[0] // 3 : z.shape[0] // 2, z.shape[1] // 3 : z.shape[1] // 2] = np.nan


KINDS = {kind.__name__: kind for kind in (wall, spikes, checkerboard, cliff, noise, hills, hole)}


def heights(kind, rows, columns):
    z = np.zeros((rows, columns))
    KINDS[kind](z)
    return z


def bilinear(z, x, y):
    """Heights at columns and rows; NaN beyond the surface."""
    rows, columns = z.shape
    inside = (x >= 0) & (x <= columns - 1) & (y >= 0) & (y <= rows - 1)
    j, i = (np.clip(np.where(inside, at, 0).astype(int), 0, most - 2) for at, most in ((x, columns), (y, rows)))
    u, v = x - j, y - i
    mean = (z[i, j] * (1 - u) + z[i, j + 1] * u) * (1 - v) + (z[i + 1, j] * (1 - u) + z[i + 1, j + 1] * u) * v
    return np.where(inside, mean, np.nan)


def marched(z, t, x, y, h):
    """First t (n, steps) at which rays are below the surface and were above it a step before; NaN for none.

    Rays that come in from beneath, through the side of the model, see nothing.
    """
    over = h - bilinear(z, x, y)
    below = over <= 0.0
    first = np.argmax(below, axis=1)
    row = np.arange(len(t))
    # Too near to its edge, where they come in, to say from which side of it.
    entry = over[row, np.argmax(np.isfinite(over), axis=1)]
    beneath = (below.any(axis=1) & ~np.isfinite(over[row, np.maximum(first - 1, 0)])) | (entry < 0.05)
    return np.where(below.any(axis=1) & ~beneath, t[row, first], np.nan), beneath


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(1, 12))])
def test_rays_meet_the_surface_first_where_a_march_does(kind, seed):
    """Straight rays in the surface's own pixels, from anywhere to anywhere; none passes a wall or a spike."""
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(2, 60, 2)
    z = heights(kind, rows, columns)
    surface = Surface(PixelGrid(), 0, 0, 0, z)
    highest = np.nanmax(z)
    start = np.array([*rng.uniform(-30, 80, 2), highest + rng.uniform(0.1, 60)])
    ends = np.stack([rng.uniform(0, side - 1, 60) for side in (columns, rows)] + [rng.uniform(-1, highest + 1, 60)])
    rays, farthest = ends.T - start, np.full(60, 5.0)
    hits = surface.first_hits(start, Paths(start, (np.eye(3),)).coefficients(rays), farthest)
    t = np.broadcast_to(np.linspace(0.0, 5.0, MARCHED), (60, MARCHED))
    wanted, from_beneath = marched(z, t, *(start[i] + t * rays[:, i, np.newaxis] for i in range(3)))
    step = 5.0 / MARCHED
    # The march may miss what is thinner than its step; then the point lies on the surface all the same.
    clear = ~from_beneath
    assert not (np.isnan(hits.t) & np.isfinite(wanted))[clear].any()
    assert not (hits.t > wanted + 1e-9)[clear].any()
    early = np.isfinite(hits.t) & ~(hits.t > wanted - 1.5 * step)
    assert early[clear].mean() < 0.05
    there = np.isfinite(hits.t)
    on_ray = start[2] + hits.t[there] * rays[there, 2]
    assert bilinear(z, hits.column[there], hits.row[there]) == pytest.approx(on_ray, abs=1e-9)


def grid_about(crs, lat, lon):
    if crs == "EPSG:3857":
        return PixelGrid(), 17
    x, y = ProjectedPlane(crs, 0.0, 0.0, 1.0, 1.0).to_crs(np.array(lat), np.array(lon))
    size = CELL * 2**15
    return PixelGrid(256, 0, 7, 7, plane=ProjectedPlane(crs, float(x) - size / 2, float(y) + size / 2, size, size)), 7


def surface_about(crs, lat, lon, z):
    grid, zoom = grid_about(crs, lat, lon)
    u, v = grid.plane.forward(np.array(lat), np.array(lon))
    world = grid.world_px(zoom)
    left, top = (int(float(at) * world) - side // 2 for at, side in ((u, z.shape[1]), (v, z.shape[0])))
    return Surface(grid, zoom, left, top, z)


def image_rays(yaw, tilt, roll, width=WIDTH, height=HEIGHT):
    corner, right, below = CAMERA.rays_enu(((-1.0, 1.0), (1.0, 1.0), (-1.0, -1.0)), yaw, tilt, roll)
    return PixelRays(corner, (right - corner) / width, (below - corner) / height, width, height)


def whole(rays, farthest):
    """Spans of rays from the camera to a distance."""
    return np.zeros((rays.height, rays.width)), np.full((rays.height, rays.width), farthest)


def centres(rays):
    x, y = (at.ravel() for at in np.meshgrid(np.arange(rays.width) + 0.5, np.arange(rays.height) + 0.5))
    return rays.directions(x, y)


def on_earth(surface, lat, lon, height, points):
    """Columns, rows and heights of points in a camera's east, north and up, by PROJ's own geocentric coordinates."""
    to_space = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    phi, lam = np.radians(lat), np.radians(lon)
    east = [-np.sin(lam), np.cos(lam), 0.0]
    north = [-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)]
    up = [np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)]
    in_space = np.array(to_space.transform(lon, lat, height)) + points @ np.array([east, north, up])
    lons, lats, heights_m = to_space.transform(*np.moveaxis(in_space, -1, 0), direction="INVERSE")
    return *surface.position(np.array(lats), np.array(lons)), np.array(heights_m)


PLACES = [
    ("EPSG:32616", 35.1, -89.9),
    ("EPSG:3031", -90.0, 0.0),
    ("EPSG:3857", 47.5, 8.5),
    ("EPSG:2263", 40.7, -74.0),
]


VIEWS = (
    (60.0, (0.0, 0.0, 0.0)),
    (120.0, (33.0, 45.0, 5.0)),
    (30.0, (200.0, 80.0, 0.0)),
    (3000.0, (90.0, 2.0, 0.0)),
)


@pytest.mark.parametrize(
    ("crs", "lat", "lon", "kind", "agl", "attitude"),
    [
        # Each view at each place, of one kind each; with all kinds it is thorough.
        pytest.param(*place, kind, *view, marks=() if (i + j) % 3 == k else pytest.mark.thorough)
        for i, place in enumerate(PLACES)
        for j, view in enumerate(VIEWS)
        for k, kind in enumerate(("hills", "spikes", "noise"))
    ],
)
def test_images_over_the_earth_meet_the_relief_where_a_march_through_space_does(crs, lat, lon, kind, agl, attitude):
    z = 500.0 + heights(kind, SIDE, SIDE)
    surface = surface_about(crs, lat, lon, z)
    height = float(np.nanmax(z)) + agl
    rays = image_rays(*attitude)
    paths, farthest, off_px = surface.paths(lat, lon, height, rays, 1e-3)
    assert off_px <= 1e-3
    hits = surface.image_hits(paths, rays, whole(rays, farthest), 1e-3)
    some = np.random.default_rng(3).integers(0, WIDTH * HEIGHT, 50)
    directions = centres(rays)[some]
    found = hits.t.ravel()[some]
    # Where a point is met, it lies on the surface, as PROJ has it ...
    there = np.isfinite(found)
    pixel = float(np.linalg.norm(rays.per_x))
    x, y, h = on_earth(surface, lat, lon, height, found[there, np.newaxis] * directions[there])
    steep = 1.0 + np.abs(np.diff(z)).max()
    assert (np.abs(bilinear(z, x, y) - h) <= 3e-3 * pixel * found[there] * steep + 1e-6).all()
    # ... and nothing is in the way before it.
    reach = np.where(there, found * (1.0 - 1e-6), farthest)
    t = np.linspace(0.0, 1.0, 4000) * reach[:, np.newaxis]
    x, y, h = on_earth(surface, lat, lon, height, t[..., np.newaxis] * directions[:, np.newaxis])
    over = h - bilinear(z, x, y)
    from_above = np.isfinite(over[:, :-1]) & (over[:, :-1] > 0.01) & (over[:, 1:] < -0.01)
    assert not from_above.any()


def random_scene(seed, count=24):
    """Rays looked at in a random scene, those whose point is off the surface, and those with ground before theirs."""
    rng = np.random.default_rng(seed)
    crs, lat, lon = PLACES[rng.integers(len(PLACES))]
    z = 400.0 + rng.uniform(0.2, 3.0) * heights(rng.choice(list(KINDS)), *rng.integers(2, SIDE, 2))
    surface = surface_about(crs, lat, lon, z)
    agl, tilt = 50.0 * 60.0 ** rng.random(), rng.uniform(0.0, 85.0)
    away = rng.uniform(-1.0, 1.0, 2) * (max(z.shape) * CELL + agl * min(np.tan(np.radians(tilt)), 2.0)) / 2.0
    camera_lat = lat + (away[0] if lat > -89.0 else abs(away[0])) / 111e3
    camera_lon = lon + away[1] / 111e3 / max(np.cos(np.radians(camera_lat)), 0.01)
    height = float(np.nanmax(z)) + agl
    rays = image_rays(rng.uniform(0.0, 360.0), tilt, rng.uniform(-15.0, 15.0))
    paths, farthest, _ = surface.paths(camera_lat, camera_lon, height, rays, 1e-3)
    hits = surface.image_hits(paths, rays, whole(rays, farthest), 1e-3)
    met = np.flatnonzero(np.isfinite(hits.t.ravel()))
    some = rng.integers(0, WIDTH * HEIGHT, count)
    if len(met):
        some[: count // 2] = rng.choice(met, count // 2)
    directions, found = centres(rays)[some], hits.t.ravel()[some]
    there = np.isfinite(found)
    pixel = float(np.linalg.norm(rays.per_x))
    x, y, h = on_earth(surface, camera_lat, camera_lon, height, found[there, np.newaxis] * directions[there])
    steep = 1.0 + max(np.nanmax(np.abs(np.diff(z, axis=axis))) for axis in (0, 1))
    # Points on the outermost edge may lie beyond it by what they may be off by.
    x, y = np.clip(x, 0.0, z.shape[1] - 1.0), np.clip(y, 0.0, z.shape[0] - 1.0)
    off = ~(np.abs(bilinear(z, x, y) - h) <= 3e-3 * pixel * found[there] * steep + 1e-6)
    # From above all relief on.
    down = np.maximum(-directions[:, 2], 1e-9)
    begin = np.minimum(0.98 * agl / down, farthest)[:, np.newaxis]
    reach = np.where(there, found * (1.0 - 1e-6), np.minimum(farthest, 2.0 * (agl + 100.0) / down))[:, np.newaxis]
    t = begin + np.linspace(0.0, 1.0, 1500) * np.maximum(reach - begin, 0.0)
    x, y, h = on_earth(surface, camera_lat, camera_lon, height, t[..., np.newaxis] * directions[:, np.newaxis])
    over = h - bilinear(z, x, y)
    # Rays that come in from beneath, through the side of the model, see nothing.
    entry = over[np.arange(count), np.argmax(np.isfinite(over), axis=1)]
    over[entry < 0.05] = np.nan
    before = np.isfinite(over[:, :-1]) & (over[:, :-1] > 0.01) & (over[:, 1:] < -0.01)
    return count, int(off.sum()), int(before.any(axis=1).sum())


@pytest.mark.parametrize(
    "seed", sampled([*range(30), *(pytest.param(n, marks=pytest.mark.thorough) for n in range(30, 300))], 3)
)
def test_random_scenes_are_seen_as_a_march_does(seed):
    _, off, before = random_scene(seed)
    assert (off, before) == (0, 0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "tilt",
    [
        0.0,
        pytest.param(30.0, marks=pytest.mark.thorough),
        pytest.param(60.0, marks=pytest.mark.thorough),
        80.0,
    ],
)
def test_bundles_find_what_single_rays_do(kind, tilt):
    z = heights(kind, SIDE, SIDE + 7)
    surface = surface_about("EPSG:32616", 35.1, -89.9, z)
    rays = image_rays(20.0, tilt, 3.0, 173, 131)
    paths, farthest, _ = surface.paths(35.1, -89.9, 90.0, rays, 1e-3)
    hits = surface.image_hits(paths, rays, whole(rays, farthest), 1e-6)
    n = rays.width * rays.height
    single = surface.first_hits(paths.start, paths.coefficients(centres(rays)), np.full(n, farthest))
    found = hits.t.ravel()
    assert np.array_equal(np.isnan(found), np.isnan(single.t))
    assert np.isfinite(found).mean() > 0.02
    there = np.isfinite(found)
    assert (np.abs(found - single.t)[there] <= 2e-3 * found[there]).all()
    assert np.median(np.abs(found - single.t)[there]) < 1e-6
    # What is asked for less exactly is off by no more than was allowed.
    coarse = surface.image_hits(paths, rays, whole(rays, farthest), 0.05).t.ravel()
    pixel = np.linalg.norm(rays.per_x)
    assert np.median(np.abs(coarse - single.t)[there]) < 0.05 * pixel * np.median(single.t[there])


@pytest.mark.parametrize("yaw", [30.0, 75.0, 285.0, 330.0])
@pytest.mark.parametrize("beside_m", [10.0, 40.0])
def test_bundles_from_beside_the_surface_spread_over_its_edge(yaw, beside_m):
    surface = surface_about("EPSG:32616", 35.1, -89.9, heights("hills", SIDE, SIDE))
    lat, lon = surface.places(np.array([SIDE / 2.0]), np.array([SIDE - 1.0]))
    lat, lon = float(lat[0]) - beside_m / 111e3, float(lon[0])
    rays = image_rays(yaw, 20.0, 0.0, 320, 240)
    height = surface.lowest_m + 400.0
    paths, farthest, _ = surface.paths(lat, lon, height, rays, 1e-3)
    hits = surface.image_hits(paths, rays, whole(rays, farthest), 1e-3)
    n = rays.width * rays.height
    single = surface.first_hits(paths.start, paths.coefficients(centres(rays)), np.full(n, farthest))
    assert np.isfinite(single.t).any()
    assert np.array_equal(np.isnan(hits.t.ravel()), np.isnan(single.t))


@pytest.mark.parametrize(("crs", "lat", "lon"), PLACES)
@pytest.mark.parametrize("far", [200.0, 5e3, 40e3])
def test_paths_are_as_exact_as_they_say(crs, lat, lon, far):
    surface = surface_about(crs, lat, lon, np.zeros((2, 2)))
    corners = image_rays(70.0, 80.0, 0.0)
    x, y = (at.ravel() for at in np.meshgrid(np.linspace(0, WIDTH, 6), np.linspace(0, HEIGHT, 6)))
    directions = corners.directions(x, y)
    directions /= np.linalg.norm(directions, axis=1)[:, np.newaxis]

    def coordinates(lat_deg, dlon, height):
        return np.stack([*surface.position(lat_deg, lon + dlon), height], axis=1)

    tolerances = np.array([1e-6, 1e-6, 1e-6])
    paths, off = fit_paths(lat, 300.0, directions, np.full(len(directions), far), coordinates, tolerances)
    rng = np.random.default_rng(4)
    inside = corners.directions(rng.uniform(0, WIDTH, 200), rng.uniform(0, HEIGHT, 200))
    inside /= np.linalg.norm(inside, axis=1)[:, np.newaxis]
    t = rng.uniform(0.0, far, 200)
    true = np.stack(on_earth(surface, lat, lon, 300.0, t[:, np.newaxis] * inside))
    told = evaluate(paths.start, paths.coefficients(inside), t)
    assert (off <= tolerances).all()
    # Heights by PROJ are off by 3e-6 m at a pole.
    assert (np.abs(told - true) <= off[:, np.newaxis] * t + 1e-5).all()


class Town:
    """Hills and towers whose heights differ from zoom to zoom, as those of averaged heights do."""

    title = attribution = ""
    grid = PixelGrid(max_zoom=19, native_zoom=19)

    def end_m(self, *_):
        return np.inf

    def cell_m(self, lat_deg, lon_deg):
        return float(self.grid.ground_m_per_px(np.array(lat_deg), np.array(lon_deg), 19))

    def surface(self, lat_deg, lon_deg, cell_m=0.0):
        zoom = 19
        while zoom > 0 and 2.0 ** (20 - zoom) * self.cell_m(lat_deg.mean(), lon_deg.mean()) <= cell_m:
            zoom -= 1
        u, v = (at * self.grid.world_px(zoom) for at in self.grid.plane.forward(lat_deg, lon_deg))
        left, top = int(u.min()) - 2, int(v.min()) - 2
        x, y = np.meshgrid(np.arange(left, int(u.max()) + 3), np.arange(top, int(v.max()) + 3))
        x_m, y_m = (at * 2.0 ** (19 - zoom) * 0.2 for at in (x, y))
        z = 300.0 + 8.0 * np.sin(x_m / 90.0) * np.cos(y_m / 70.0) + (19 - zoom) * np.sin(x_m + y_m)
        z += 15.0 * ((x % 37 < 3) & (y % 41 < 3)) / (20 - zoom)
        return Surface(self.grid, zoom, left, top, z)


@pytest.mark.parametrize(("agl", "tilt"), [(40.0, 78.0), pytest.param(300.0, 75.0, marks=pytest.mark.thorough)])
def test_rings_are_seen_as_a_march_over_them_does(agl, tilt):
    """Whatever stands between the camera and the first ground of the ring that a ray is over, none is lost."""
    lat, lon, height, tolerance_px = 47.3, 8.2, 320.0 + agl, 0.02
    pose = Poses(*(np.array([at]) for at in (lat, lon, agl, 40.0, tilt, 2.0)))
    tracing = Tracing(ImageGeometry(CAMERA, 96, 72, pose), height, Town(), 280.0, tolerance_px)
    rings, rays = list(tracing.rings()), tracing.rays
    assert len(rings) > 2
    # Each begins where the one before ends; none has cells larger than 1.5 pixels.
    pixel = float(np.linalg.norm(rays.per_x))
    for ring, end_m in zip(rings, [0.0, *(ring.end_m for ring in rings)]):
        assert ring.begin_m == end_m
        cell = Town.grid.ground_m_per_px(np.array(lat), np.array(lon), ring.surface.zoom)
        distance = np.hypot(ring.begin_m, max(height - ring.surface.highest_m, 0.0))
        assert ring.surface.zoom == 19 or cell <= 1.5 * pixel * distance
    steeps = [1.0 + max(np.abs(np.diff(one.surface.heights_m, axis=axis)).max() for axis in (0, 1)) for one in rings]
    some = np.random.default_rng(6).integers(0, 96 * 72, 20)
    directions, found = centres(rays)[some], tracing.depth_m.ravel()[some]
    assert 0.3 < np.isfinite(found).mean() < 1.0
    level = np.hypot(*directions[:, :2].T)
    for ray, t_found, way in zip(directions, found, level):
        for number, (surface, begin_m, end_m) in enumerate(rings):
            # A hit where a ring ends is where the next begins, but for rounding.
            begin, end = begin_m / way, end_m / way * (1.0 - 1e-9)
            last = min(end, 40_000.0 / way, 2.0 * t_found if np.isfinite(t_found) else np.inf)
            if begin >= last:
                break
            t = np.linspace(begin, last, 1500)
            if begin <= t_found <= last:
                t = np.unique(np.append(t, t_found))
            x, y, h = on_earth(surface, lat, lon, height, t[:, np.newaxis] * ray)
            over = h - bilinear(surface.heights_m, x, y)
            bound = 2.0 * tolerance_px * pixel * t * steeps[number] + 1e-6
            below = np.flatnonzero(over < -bound)
            if len(below):
                # The hit is no later, and may be where the ring begins.
                assert t_found <= t[below[0]]
            if np.isfinite(t_found) and begin * (1.0 - 1e-9) <= t_found < end:
                at = min(np.searchsorted(t, t_found), len(t) - 1)
                assert over[at] <= bound[at]
                assert abs(over[at]) <= bound[at] or (number and t_found == pytest.approx(begin))
            if len(below):
                break


def test_points_where_a_ring_begins_lie_on_their_rays():
    """A ray that comes in below a ring's surface meets the ring's edge, at its own height."""
    lat, lon, height, tolerance_px = 47.3, 8.2, 360.0, 0.02
    pose = Poses(*(np.array([at]) for at in (lat, lon, 40.0, 40.0, 78.0, 2.0)))
    tracing = Tracing(ImageGeometry(CAMERA, 192, 144, pose), height, Town(), 280.0, tolerance_px)
    seen, rings = tracing.sighting, list(tracing.rings())
    row, column = np.nonzero(np.isfinite(seen.depth_m))
    t = seen.depth_m[row, column]
    directions = tracing.rays.through(row, column)
    h = on_earth(rings[0].surface, lat, lon, height, t[:, np.newaxis] * directions)[2]
    steep = 1.0 + max(np.abs(np.diff(one.surface.heights_m, axis=axis)).max() for one in rings for axis in (0, 1))
    bound = 2.0 * tolerance_px * tracing.rays.pixel * t * steep + 1e-6
    assert (np.abs(seen.height_m[row, column] - h) <= bound).all()
    begin = np.array([ring.begin_m for ring in rings[1:]])
    at_edge = np.isclose(t * np.hypot(*directions[:, :2].T), begin[:, np.newaxis], rtol=1e-12).any(axis=0)
    assert at_edge.sum() > 5
    # Elsewhere, heights are those of the surface, off by the error along the ray.
    off_px = np.abs(seen.height_m[row, column] - h) / (tracing.rays.pixel * t)
    assert off_px[at_edge].max() < 1e-3
