"""Rays against triangles: by hand, by Embree, and merged with relief."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from terrainav.core.external import compiling
from terrainav.core.geodesy.local import enu_axes, geocentric
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.faces import face_hits
from terrainav.core.geodesy.raytracing.pixel_rays import PixelRays
from terrainav.core.geodesy.triangles import NO_FACES, RELIEF, ROOF, WALL, Triangles

from tests.core.geodesy.boxes import LAT, LON, Boxes, code, town_boxes, tracing_of

GRID = PixelGrid(max_zoom=22, native_zoom=22)
ZOOMS = (0, 22)
TILTS = (0.0, 45.0, 60.0, 85.0)
BOTH = pytest.mark.parametrize("is_compiled", [True, False])


@pytest.fixture
def town():
    return town_boxes()


def over(faces, tilt_deg, **more):
    """Tracing of a town: from above, or from low beside it where the view is towards the horizon."""
    if tilt_deg > 80.0:
        more = {"height_m": 160.0, "at": (-110.0, -300.0), **more}
    return tracing_of(faces, tilt_deg, **more)


def plain(corners):
    """Triangles of corners (n, 3, 3)."""
    count = len(corners)
    return Triangles(
        np.asarray(corners, float),
        np.full(count, WALL, np.uint8),
        np.arange(count) + 1,
        np.zeros((count, 3), np.uint8),
        np.zeros(count, bool),
    )


#: An image of 8 x 8 px whose rays look along the third axis, with x to the right and y down, each from -1 to 1.
SMALL = PixelRays(np.array([-1.0, -1.0, 1.0]), np.array([0.25, 0.0, 0.0]), np.array([0.0, 0.25, 0.0]), 8, 8)


def hits(corners, rays=SMALL):
    return face_hits(plain(corners), np.zeros(3), np.eye(3), rays)


@BOTH
def test_a_plane_across_the_view_is_hit_at_its_depth(is_compiled):
    with code(is_compiled):
        found = hits([[(-9, -9, 2), (9, -9, 2), (0, 18, 2)]])
    assert found.t == pytest.approx(np.full((8, 8), 2.0), rel=1e-14)


@BOTH
def test_both_sides_are_seen_and_the_nearer_of_two_wins(is_compiled):
    far = [(-9, -9, 4), (9, -9, 4), (0, 18, 4)]
    half = [(0, -9, 3), (0, 9, 3), (9, 0, 3)]
    with code(is_compiled):
        found, turned = hits([far, half]), hits([far[::-1], half[::-1]])
    wanted = np.where(np.arange(8) < 4, 4.0, 3.0)
    assert found.t == pytest.approx(np.tile(wanted, (8, 1)), rel=1e-14)
    assert turned.t == pytest.approx(found.t, rel=1e-14)
    assert (found.side == -turned.side).all()


@BOTH
def test_what_lies_behind_the_camera_is_not_seen_and_what_passes_beside_it_is(is_compiled):
    behind = [(-9, -9, -2), (9, -9, -2), (0, 18, -2)]
    # A floor half a unit below the camera (y is down), from far behind to far ahead: seen at depth 0.5 / y.
    floor = [(-1e4, 0.5, -1e4), (1e4, 0.5, -1e4), (0, 0.5, 3e4)]
    with code(is_compiled):
        found = hits([behind, floor])
    y = (np.arange(8) + 0.5) / 4.0 - 1.0
    below = y > 0.0
    assert (found.triangle[~below] == -1).all()
    assert found.t[below] == pytest.approx(np.tile((0.5 / y[below])[:, np.newaxis], (1, 8)), rel=1e-12)


@BOTH
def test_a_triangle_seen_edge_on_is_not_seen(is_compiled):
    with code(is_compiled):
        assert (hits([[(0, 0, 1), (1, 0, 2), (2, 0, 3)]]).triangle == -1).all()
        assert (hits([[(0, 0, 1), (0, 0, 1), (2, 0, 3)]]).triangle == -1).all()


@BOTH
@pytest.mark.parametrize("seed", range(5))
def test_no_ray_passes_between_triangles_that_share_an_edge(seed, is_compiled):
    rng = np.random.default_rng(seed)
    # A bent sheet of triangles, wider than the view, with edges through the centres of pixels.
    x, y = np.meshgrid(np.linspace(-4, 4, 65), np.linspace(-4, 4, 65))
    z = 2.0 + rng.uniform(0.0, 0.2, x.shape)
    points = np.stack([x * z / 2, y * z / 2, z], axis=-1)
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    corners = np.concatenate([np.stack(one, axis=2).reshape(-1, 3, 3) for one in ((a, b, c), (a, c, d))])
    turn = enu_axes(*rng.uniform(-80, 80, 2))
    with code(is_compiled):
        found = face_hits(plain(corners @ turn), np.zeros(3), turn, replace(SMALL, per_x=SMALL.per_x / 8, width=64))
    assert np.isfinite(found.t).all()


@pytest.mark.skipif(not compiling.uses_numba(), reason="numba is not installed")
@pytest.mark.parametrize("tilt_deg", TILTS)
def test_numpy_gives_the_same_pixels(town, tilt_deg):
    made, plainly = over(town, tilt_deg), over(town, tilt_deg)
    found = made._face_hits
    with compiling.without_numba():
        wanted = plainly._face_hits
    assert np.array_equal(found.t, wanted.t)
    assert np.array_equal(found.triangle, wanted.triangle)
    assert np.array_equal(found.forms, wanted.forms)
    assert np.array_equal(found.side, wanted.side)
    parts = made._seen_faces.samples(GRID, ZOOMS)
    with compiling.without_numba():
        others = made._seen_faces.samples(GRID, ZOOMS)
    for part, other in zip(parts, others):
        assert np.array_equal(part.row, other.row)
        assert part.du == pytest.approx(other.du, abs=1e-6 / GRID.world_px(22))
        assert part.v == pytest.approx(other.v, abs=1e-6 / GRID.world_px(22))
    assert len(parts) == len(others)


def corners_px(made, points_m):
    """Image points (..., 2) of geocentric points: by the pinhole's formula."""
    place = *made.place, made.height_m
    enu = (points_m - geocentric(*place)) @ enu_axes(*place[:2]).T
    x, y, depth = np.moveaxis(enu @ np.linalg.inv(made.rays.ways), -1, 0)[[1, 2, 0]]
    return np.stack([x / depth, y / depth], axis=-1), depth


def far_from_edges(made, faces, least_px=0.5):
    """Whether pixels lie farther from all triangles' projected edges, (height, width)."""
    points, depth = corners_px(made, faces.corners_m)
    y, x = np.mgrid[: made.rays.height, : made.rays.width] + 0.5
    far = np.ones(x.shape, bool)
    for one in np.flatnonzero((depth > 0.0).all(axis=1)):
        for at in range(3):
            (x0, y0), (x1, y1) = points[one, at], points[one, (at + 1) % 3]
            square = max((x1 - x0) ** 2 + (y1 - y0) ** 2, 1e-12)
            share = np.clip(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / square, 0.0, 1.0)
            far &= np.hypot(x - x0 - share * (x1 - x0), y - y0 - share * (y1 - y0)) > least_px
    return far


@pytest.mark.parametrize("tilt_deg", TILTS)
def test_embree_hits_the_same_triangles_at_the_same_depth(town, tilt_deg):
    pytest.importorskip("embreex")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    made = over(town, tilt_deg, yaw_deg=33.0, size=(320, 240))
    place = *made.place, made.height_m
    enu = (town.all.corners_m - geocentric(*place)) @ enu_axes(*place[:2]).T
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, enu.astype(np.float32))
    y, x = (at.ravel() + 0.5 for at in np.mgrid[: made.rays.height, : made.rays.width])
    directions = made.rays.directions(x, y)
    got = scene.run(np.zeros(directions.shape, np.float32), directions.astype(np.float32), output=1)
    peer = np.where(got["primID"] >= 0, got["tfar"], np.inf).reshape(made.rays.height, made.rays.width)
    peer_id = np.where(got["primID"] >= 0, got["primID"], -1).reshape(peer.shape)
    everything = face_hits(town.all, geocentric(*place), enu_axes(*place[:2]), made.rays)
    numbers = {tuple(corner.ravel()): at for at, corner in enumerate(town.all.corners_m)}
    ids = np.array([numbers[tuple(corner.ravel())] for corner in everything.triangles.corners_m] + [-1])
    far = far_from_edges(made, town.all)
    assert far.mean() > 0.2
    assert np.array_equal(ids[everything.triangle][far], peer_id[far])
    met = far & np.isfinite(peer)
    assert met.sum() > 300
    assert everything.t[met] == pytest.approx(peer[met], rel=1e-4)


@pytest.mark.parametrize("is_compiled", [True, False])
@pytest.mark.parametrize("tilt_deg", TILTS)
def test_the_nearer_of_relief_and_faces_is_seen(town, tilt_deg, is_compiled):
    rng = np.random.default_rng(8)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    ground[70:75] += 60.0
    more = {"height_m": float(ground[100:].max()) + 60.0} if tilt_deg > 80.0 else {"height_m": 450.0}
    with code(is_compiled):
        made, bare = (over(model, tilt_deg, ground=ground, **more) for model in (town, NO_FACES))
        faces = made._face_hits.t
        depth, alone = made.depth_m, bare.depth_m
    wanted = np.fmin(alone, faces)
    off = np.abs(depth - wanted) / wanted
    # Rays that graze an edge of the relief may be cut short in other places.
    assert np.mean(~(off < 1e-4) & np.isfinite(wanted)) < 2e-3
    assert (np.isnan(depth) == np.isinf(wanted) | np.isnan(wanted)).mean() > 0.999
    seen = made.sighting
    assert np.array_equal(seen.kind != RELIEF, seen.instance > 0)
    assert ((seen.kind != RELIEF) == (faces < np.where(np.isnan(alone), np.inf, alone))).mean() > 0.998


def test_points_normals_and_heights_of_faces(town):
    made = tracing_of(town, 55.0)
    seen = made.sighting
    roofs, walls = seen.kind == ROOF, seen.kind == WALL
    assert roofs.sum() > 100
    assert walls.sum() > 100
    assert seen.normals[roofs] == pytest.approx(np.tile([0.0, 0.0, 1.0], (roofs.sum(), 1)), abs=1e-5)
    assert np.abs(seen.normals[walls][:, 2]).max() < 1e-4
    assert np.array_equal(seen.steep, walls)
    place = *made.place, made.height_m
    at = roofs | walls
    points = (geocentric(seen.lat_deg[at], seen.lon_deg[at], seen.height_m[at]) - geocentric(*place)) @ enu_axes(
        *place[:2]
    ).T
    row, column = np.nonzero(at)
    rays = made.rays.directions(column + 0.5, row + 0.5)
    assert points == pytest.approx(seen.depth_m[at][:, np.newaxis] * rays, abs=1e-6)
    # Walls face the camera.
    assert (np.sum(seen.normals[at] * rays, axis=1) < 0.0).all()
    first = 10 * (seen.instance[roofs] - 1) + 8
    top = town.all.corners_m[first, 0]
    wanted = np.linalg.norm(top, axis=1) - np.linalg.norm(geocentric(LAT, LON))
    assert seen.height_m[roofs] == pytest.approx(wanted, abs=1.0)


def test_samples_of_roofs_lie_where_the_roofs_are(town):
    made = tracing_of(town, 50.0)
    view, seen = made.view(GRID, ZOOMS), made.sighting
    count = 0
    for part in view.samples:
        at = part.row, part.column
        roof = seen.kind[at] == ROOF
        u, v = GRID.plane.forward(seen.lat_deg[at][roof], seen.lon_deg[at][roof])
        u -= float(GRID.meridian_u(np.asarray(made.place[1])))
        world = GRID.world_px(22)
        assert part.du[roof].mean(axis=1) * world == pytest.approx(u * world, abs=0.02)
        assert part.v[roof].mean(axis=1) * world == pytest.approx(v * world, abs=0.02)
        assert (seen.kind[at] != WALL).all()
        count += int(roof.sum())
    assert count == (seen.kind == ROOF).sum()
    painted = made.painted()
    assert np.array_equal(np.argwhere(seen.kind == WALL), np.stack([painted.row, painted.column], axis=1))
    assert (
        painted.colour[painted.which] == town.all.colour[10 * (seen.instance[painted.row, painted.column] - 1)]
    ).all()
    # What is hidden has no ground: it ends beyond the town.
    assert np.array_equal(view.hidden, np.isnan(seen.depth_m))
    assert view.facade_share == pytest.approx((seen.kind == WALL).mean())


def test_a_walls_silhouette_is_the_projected_line():
    faces = Boxes([(-20.0, 40.0, 40.0, 30.0, 100.0, 160.0)])
    made = tracing_of(faces, 75.0, yaw_deg=0.0, height_m=130.0, at=(0.0, -40.0), size=(640, 480))
    seen = made.sighting
    (top, bottom), depth = corners_px(made, geocentric(
        np.full(2, faces.lat[0, 0]), np.full(2, faces.lon[0, 0]), np.array([160.0, 98.0])
    ))  # fmt: skip
    assert (depth > 0).all()
    checked = 0
    for row in range(480):
        y = row + 0.5
        if not min(top[1], bottom[1]) < y < max(top[1], bottom[1]):
            continue
        line = np.flatnonzero(seen.kind[row] == WALL)
        if not len(line):
            continue
        edge = top[0] + (y - top[1]) / (bottom[1] - top[1]) * (bottom[0] - top[0])
        assert line[0] == np.ceil(edge - 0.5)
        assert np.array_equal(line, np.arange(line[0], line[-1] + 1))
        checked += 1
    assert checked > 100


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 45.0, 61.0])
def test_nothing_shows_between_two_walls_of_a_building(yaw_deg):
    faces = Boxes([(-20.0, 30.0, 40.0, 30.0, 100.0, 140.0)])
    made = tracing_of(faces, 60.0, yaw_deg=0.0, height_m=170.0, at=(yaw_deg - 50.0, -20.0), size=(320, 240))
    kinds = made.sighting.kind
    assert (kinds == WALL).any()
    for line in [*kinds, *kinds.T]:
        found = np.flatnonzero(line != RELIEF)
        assert len(found) == 0 or len(found) == found[-1] - found[0] + 1


def test_a_camera_inside_a_building_sees_its_walls_all_around():
    faces = Boxes([(-10.0, -10.0, 20.0, 20.0, 100.0, 150.0)])
    made = tracing_of(faces, 80.0, height_m=120.0, at=(1.0, 2.0))
    seen = made.sighting
    assert (seen.kind[:60] == WALL).all()
    assert seen.depth_m[:60].max() < 40.0
    assert (np.sum(seen.normals[:60] * made.rays.directions(
        *(at.ravel() + 0.5 for at in np.mgrid[:60, :160][::-1])).reshape(60, 160, 3), axis=2) < 0.0).all()  # fmt: skip


def test_no_faces_cost_nothing_and_change_nothing():
    far = Boxes([(5000.0, 5000.0, 10.0, 10.0, 100.0, 120.0)])
    made, bare = (tracing_of(model, 30.0) for model in (far, NO_FACES))
    assert made._face_hits is None
    assert made.level_m == bare.level_m
    assert np.array_equal(made.depth_m, bare.depth_m, equal_nan=True)
    assert bare.painted() is None


def test_faces_30_km_away_are_where_the_earths_curve_puts_them():
    import mpmath

    mpmath.mp.dps = 40
    north_m = 30_000.0
    faces = Boxes([(-400.0, north_m, 800.0, 400.0, 100.0, 1500.0)])
    made = tracing_of(faces, 89.0, yaw_deg=0.0, height_m=500.0, at=(0.0, 0.0), size=(640, 480))
    hit = face_hits(faces.all, geocentric(*made.place, made.height_m), enu_axes(*made.place), made.rays)
    row, column = np.nonzero(hit.triangle >= 0)
    assert len(row) > 50

    def cartesian(lat, lon, height):
        lat, lon = mpmath.radians(mpmath.mpf(lat)), mpmath.radians(mpmath.mpf(lon))
        a, f = mpmath.mpf(6378137), 1 / mpmath.mpf("298.257223563")
        e2 = f * (2 - f)
        n = a / mpmath.sqrt(1 - e2 * mpmath.sin(lat) ** 2)
        return mpmath.matrix(
            [(n + height) * mpmath.cos(lat) * mpmath.cos(lon), (n + height) * mpmath.cos(lat) * mpmath.sin(lon),
             (n * (1 - e2) + height) * mpmath.sin(lat)]
        )  # fmt: skip

    lat, lon = (mpmath.radians(mpmath.mpf(float(at))) for at in made.place)
    axes = mpmath.matrix([
        [-mpmath.sin(lon), mpmath.cos(lon), 0],
        [-mpmath.sin(lat) * mpmath.cos(lon), -mpmath.sin(lat) * mpmath.sin(lon), mpmath.cos(lat)],
        [mpmath.cos(lat) * mpmath.cos(lon), mpmath.cos(lat) * mpmath.sin(lon), mpmath.sin(lat)],
    ])  # fmt: skip
    camera = cartesian(*made.place, made.height_m)
    # The south wall: its three upper and lower corners in their plane.
    a, b, c = (
        axes * (cartesian(float(faces.lat[0, at]), float(faces.lon[0, at]), height) - camera)
        for at, height in ((0, 98.0), (1, 98.0), (1, 1500.0))
    )
    u, v = b - a, c - a
    normal = mpmath.matrix([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    instance = hit.triangles.kind[hit.triangle[row, column]]
    for at in np.flatnonzero(instance == WALL)[::17]:
        ray = made.rays.directions(np.array([column[at] + 0.5]), np.array([row[at] + 0.5]))[0]
        ray = mpmath.matrix([mpmath.mpf(float(part)) for part in ray])
        wanted = mpmath.fdot(normal, a) / mpmath.fdot(normal, ray)
        assert float(hit.t[row[at], column[at]]) == pytest.approx(float(wanted), abs=1e-3)


def test_buildings_smaller_than_half_a_pixel_are_not_asked_for(town):
    made = over(town, 85.0)
    assert made._face_hits is not None
    pixel = made.rays.pixel
    # Nothing is nearer than the ground below, the town's included.
    highest = max(ring.surface.highest_m for ring in made.rings())
    assert town.asked[0] == pytest.approx(0.5 * pixel * (made.height_m - highest))
    assert town.asked == sorted(town.asked)
    assert town.asked[-1] > 0.0
