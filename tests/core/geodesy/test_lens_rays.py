"""Pictures over relief and of buildings through lenses that distort: by OpenCV's lenses, Embree and marches."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.external import compiling
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.local import enu_axes, geocentric
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.geodesy.raytracing.faces import face_hits
from terrainav.core.geodesy.raytracing.tracing import Tracing
from terrainav.core.geodesy.triangles import NO_FACES, RELIEF, ROOF
from terrainav.core.geodesy.view import pixel_detail

from tests.core.geodesy.boxes import LAT, LON, METRE_LAT, METRE_LON, TOLERANCE_PX, code, town_boxes
from tests.core.geodesy.cliffs import Kept, surface_about
from tests.core.geodesy.test_relief import bilinear, heights, on_earth

cv2 = pytest.importorskip("cv2")

GRID = PixelGrid(max_zoom=22, native_zoom=22)
ZOOMS = (0, 22)
SIZE = 160, 120
BROWN = Camera(60.0, 4 / 3, k1=-0.3)
TANGENTIAL = Camera(70.0, 4 / 3, k1=0.2, k2=-0.05, p1=0.01, p2=-0.02, principal_x=0.06, principal_y=-0.04)
FISHEYE = Camera(150.0, 4 / 3, lens="fisheye", k1=0.02, k2=-0.003)
#: A pincushion, whose pixels are closer at the edges, and a fisheye whose corners look along the image plane.
EXTREME = {"pincushion": Camera(80.0, 4 / 3, k1=0.35), "widest": Camera(179.0, 4 / 3, lens="fisheye")}
LENSES = {"brown": BROWN, "tangential": TANGENTIAL, "fisheye": FISHEYE}
BOTH = pytest.mark.parametrize("is_compiled", [True, False])


@pytest.fixture(params=LENSES)
def camera(request):
    return LENSES[request.param]


@pytest.fixture
def town():
    return town_boxes()


def tracing_of(camera, faces, tilt_deg, *, height_m=300.0, at=(0.0, -60.0), size=SIZE, ground=None, **more):
    """Tracing over level ground of 100 m or a grid of heights (160, 160) with cells of 4 m."""
    z = np.full((160, 160), 100.0) if ground is None else ground
    surface, cell_m = surface_about("EPSG:2056", LAT, LON, 4.0, z)
    place = LAT + at[1] * METRE_LAT, LON + at[0] * METRE_LON
    poses = Poses(*(np.array([value]) for value in (*place, height_m - 100.0, 20.0, tilt_deg, 3.0)))
    scene = ImageGeometry(camera, *size, poses)
    return Tracing(scene, height_m, Kept(surface, cell_m), float(z.min()), TOLERANCE_PX, faces, **more)


def seen_by_opencv(camera, x, y, depth, size=SIZE):
    """Pixels (n, 2) of points in a camera's own axes (right, down, ahead), by OpenCV."""
    wide, high = size
    tan_x, _ = camera.half_tangents
    focal = wide / 2.0 / tan_x
    matrix = np.array(
        [[focal, 0.0, wide * (0.5 + camera.principal_x)], [0.0, focal, high * (0.5 + camera.principal_y)], [0, 0, 1]]
    )
    points = np.stack([x, y, depth], axis=-1).reshape(-1, 1, 3)
    if camera.lens == "fisheye":
        factors = np.array([camera.k1, camera.k2, camera.k3, camera.k4])
        found, _ = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), matrix, factors)
    else:
        factors = np.array([camera.k1, camera.k2, camera.p1, camera.p2, camera.k3, camera.k4, camera.k5, camera.k6])
        found, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), matrix, factors)
    return found.reshape(-1, 2)


def axes_of(made):
    """Right, down and ahead of a camera in east, north and up, as rows: by turns about yaw, tilt and roll."""
    yaw, tilt, roll = (np.radians(float(at[0])) for at in made.scene.poses.attitude)
    turns = [
        np.array([[np.cos(roll), 0, -np.sin(roll)], [0, 1, 0], [np.sin(roll), 0, np.cos(roll)]]),
        np.array([[1, 0, 0], [0, np.cos(tilt), np.sin(tilt)], [0, -np.sin(tilt), np.cos(tilt)]]),
        np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]),
    ]
    level = np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]])
    return level @ turns[0] @ turns[1] @ turns[2]


def all_pixels(made):
    row, column = (at.ravel() for at in np.mgrid[: made.rays.height, : made.rays.width])
    return row, column, made.rays.through(row, column)


@pytest.mark.parametrize("tilt_deg", [0.0, 55.0])
def test_rays_of_pixels_are_seen_at_their_centres_by_opencv(camera, tilt_deg):
    made = tracing_of(camera, NO_FACES, tilt_deg)
    row, column, directions = all_pixels(made)
    px = seen_by_opencv(camera, *(directions @ axes_of(made).T).T)
    assert px == pytest.approx(np.stack([column + 0.5, row + 0.5], axis=1), abs=1e-9)


@BOTH
@pytest.mark.parametrize("tilt_deg", [0.0, 40.0, 75.0])
@pytest.mark.parametrize("kind", ["hills", "spikes", "noise"])
def test_relief_is_met_where_a_march_through_space_meets_it(camera, kind, tilt_deg, is_compiled):
    z = 100.0 + heights(kind, 160, 160)
    with code(is_compiled):
        made = tracing_of(camera, NO_FACES, tilt_deg, ground=z, at=(0.0, 0.0), height_m=float(z.max()) + 90.0)
        depth = made.depth_m
    surface, lat, lon, height_m = made.relief.kept, *made.place, made.height_m
    _, _, directions = all_pixels(made)
    some = np.random.default_rng(3).integers(0, len(directions), 120)
    directions, found = directions[some], depth.ravel()[some]
    there = np.isfinite(found)
    assert there.sum() > 20
    x, y, h = on_earth(surface, lat, lon, height_m, found[there, np.newaxis] * directions[there])
    steep = 1.0 + np.abs(np.diff(z)).max()
    pixel = made.rays.pixel
    # Where a point is met, it lies on the surface, as PROJ has it ...
    off = np.abs(bilinear(z, np.clip(x, 0, 159), np.clip(y, 0, 159)) - h)
    assert (off <= 2.0 * TOLERANCE_PX * pixel * found[there] * steep + 1e-6).all()
    # ... and nothing is in the way before it.
    reach = np.where(there, found * (1.0 - 1e-3), np.minimum(3000.0 / np.linalg.norm(directions, axis=1), 900.0))
    t = np.linspace(0.0, 1.0, 4000) * reach[:, np.newaxis]
    x, y, h = on_earth(surface, lat, lon, height_m, t[..., np.newaxis] * directions[:, np.newaxis])
    over = h - bilinear(z, x, y)
    from_above = np.isfinite(over[:, :-1]) & (over[:, :-1] > 0.05) & (over[:, 1:] < -0.05)
    assert not from_above.any()


@pytest.mark.skipif(not compiling.uses_numba(), reason="numba is not installed")
@pytest.mark.parametrize("tilt_deg", [0.0, 40.0, 75.0])
def test_numpy_gives_the_same_picture(camera, town, tilt_deg):
    rng = np.random.default_rng(8)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    made, plainly = (
        tracing_of(camera, town, tilt_deg, ground=ground, height_m=float(ground.max()) + 60.0) for _ in range(2)
    )
    found, view = made.sighting, made.view(GRID, ZOOMS)
    with compiling.without_numba():
        wanted, other = plainly.sighting, plainly.view(GRID, ZOOMS)
    faces = made._face_hits
    assert np.array_equal(faces.t, plainly._face_hits.t)
    # Others, beside the image, may be counted before them.
    met = faces.triangle >= 0
    corners = [one.triangles.corners_m[one.triangle[met]] for one in (faces, plainly._face_hits)]
    assert np.array_equal(*corners)
    off = np.abs(found.depth_m - wanted.depth_m) / wanted.depth_m
    assert np.mean(~(off < 1e-4) & np.isfinite(wanted.depth_m)) < 2e-3
    assert np.mean(found.instance != wanted.instance) < 2e-3
    assert (found.instance > 0).sum() > 50
    one, two = (
        {(int(r), int(c)): (part.zoom, du.mean()) for part in each.samples
         for r, c, du in zip(part.row, part.column, part.du)}
        for each in (view, other)
    )  # fmt: skip
    assert len(one.keys() ^ two.keys()) < 0.003 * len(one)
    same = [one[at][0] == two[at][0] and abs(one[at][1] - two[at][1]) < 1e-9 for at in one.keys() & two.keys()]
    assert np.mean(same) > 0.99


def edges_px(made, corners_m, count=65):
    """Image points (n, 3, count, 2) along the edges of triangles, by OpenCV; NaN beside and behind the camera."""
    place = *made.place, made.height_m
    corners = (corners_m - geocentric(*place)) @ enu_axes(*place[:2]).T @ axes_of(made).T
    share = np.linspace(0.0, 1.0, count)[:, np.newaxis]
    points = corners[:, :, np.newaxis] + share * (np.roll(corners, -1, axis=1) - corners)[:, :, np.newaxis]
    x, y, depth = np.moveaxis(points, -1, 0)
    away = np.hypot(x, y)
    ahead = depth > 0.02 * away
    if made.scene.camera.lens != "fisheye":
        # Farther out the polynomial folds.
        ahead &= away < 1.05 * depth
    px = seen_by_opencv(
        made.scene.camera, *(np.where(ahead, at, 1.0).ravel() for at in (x, y, depth)), made.scene.one_size_px
    )
    return np.where(ahead[..., np.newaxis], px.reshape(*x.shape, 2), np.nan)


def far_from_edges(made, faces):
    """Whether pixels lie farther than half a pixel from all triangles' projected edges, (height, width)."""
    # Lines of five quarters of a pixel.
    near = np.zeros((4 * made.rays.height, 4 * made.rays.width), np.uint8)
    for line in edges_px(made, faces.corners_m).reshape(-1, 65, 2):
        # OpenCV's pixels have their centres at whole numbers; it takes sixteenths.
        points = np.rint(16.0 * (4.0 * line[np.isfinite(line).all(axis=1)] - 0.5)).clip(-1e5, 1e5).astype(np.int32)
        if len(points):
            cv2.polylines(near, [points], isClosed=False, color=1, thickness=5, shift=4)
    return near[2::4, 2::4] == 0


@BOTH
@pytest.mark.parametrize("tilt_deg", [0.0, 45.0, 80.0])
def test_embree_hits_the_same_triangles_at_the_same_depth(camera, town, tilt_deg, is_compiled):
    pytest.importorskip("embreex")
    from embreex import rtcore_scene
    from embreex.mesh_construction import TriangleMesh

    more = {"height_m": 160.0, "at": (-110.0, -300.0)} if tilt_deg > 70.0 else {}
    made = tracing_of(camera, town, tilt_deg, size=(320, 240), **more)
    place = *made.place, made.height_m
    enu = (town.all.corners_m - geocentric(*place)) @ enu_axes(*place[:2]).T
    scene = rtcore_scene.EmbreeScene()
    TriangleMesh(scene, enu.astype(np.float32))
    _, _, directions = all_pixels(made)
    got = scene.run(np.zeros(directions.shape, np.float32), directions.astype(np.float32), output=1)
    shape = made.rays.height, made.rays.width
    peer = np.where(got["primID"] >= 0, got["tfar"], np.inf).reshape(shape)
    peer_id = np.where(got["primID"] >= 0, got["primID"], -1).reshape(shape)
    with code(is_compiled):
        everything = face_hits(town.all, geocentric(*place), enu_axes(*place[:2]), made.rays)
    numbers = {tuple(corner.ravel()): at for at, corner in enumerate(town.all.corners_m)}
    ids = np.array([numbers[tuple(corner.ravel())] for corner in everything.triangles.corners_m] + [-1])
    far = far_from_edges(made, town.all)
    assert far.mean() > 0.15
    assert np.array_equal(ids[everything.triangle][far], peer_id[far])
    met = far & np.isfinite(peer)
    assert met.sum() > 300
    assert everything.t[met] == pytest.approx(peer[met], rel=1e-4)


@BOTH
@pytest.mark.parametrize("camera", [*LENSES.values(), *EXTREME.values()], ids=[*LENSES, *EXTREME])
def test_points_of_the_products_project_to_their_pixels(camera, town, is_compiled):
    rng = np.random.default_rng(8)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    with code(is_compiled):
        made = tracing_of(camera, town, 35.0, ground=ground, height_m=float(ground.max()) + 120.0)
        seen = made.sighting
    at = np.isfinite(seen.depth_m)
    assert at.mean() > 0.5
    assert (seen.kind[at] != RELIEF).sum() > 50
    assert (seen.kind[at] == RELIEF).sum() > 1000
    place = *made.place, made.height_m
    points = (geocentric(seen.lat_deg[at], seen.lon_deg[at], seen.height_m[at]) - geocentric(*place)) @ enu_axes(
        *place[:2]
    ).T
    right, down, ahead = (points @ axes_of(made).T).T
    row, column = np.nonzero(at)
    wanted = np.stack([column + 0.5, row + 0.5], axis=1)
    px = seen_by_opencv(camera, right, down, ahead)
    is_face = seen.kind[at] != RELIEF
    assert px[is_face] == pytest.approx(wanted[is_face], abs=1e-6)
    assert px == pytest.approx(wanted, abs=1e-3)
    assert ahead == pytest.approx(seen.depth_m[at], rel=1e-4)
    normals = seen.normals[at]
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)), abs=1e-9)
    assert (np.sum(normals[is_face] * points[is_face], axis=1) < 0.0).all()


@BOTH
def test_samples_lie_where_the_pixels_points_do_and_are_as_fine_as_they_are_near(camera, is_compiled):
    with code(is_compiled):
        made = tracing_of(camera, NO_FACES, 25.0, at=(0.0, -40.0))
        view, seen = made.view(GRID, ZOOMS), made.sighting
    u, v = GRID.plane.forward(seen.lat_deg, seen.lon_deg)
    u -= float(GRID.meridian_u(np.asarray(made.place[1])))
    # The ground of a pixel reaches half-way to its neighbours' points.
    per_x, per_y = (np.hypot(*(np.gradient(at, axis=axis) for at in (u, v))) for axis in (1, 0))
    world, same, count = GRID.world_px(22), 0, 0
    for part in view.samples:
        at = part.row, part.column
        assert part.du.mean(axis=1) * world == pytest.approx(u[at] * world, abs=0.02)
        assert part.v.mean(axis=1) * world == pytest.approx(v[at] * world, abs=0.02)
        inner = (part.row > 0) & (part.row < SIZE[1] - 1) & (part.column > 0) & (part.column < SIZE[0] - 1)
        inner &= np.isfinite(per_x[at] + per_y[at])
        wanted = pixel_detail(per_x[at][inner], per_y[at][inner], GRID, ZOOMS)
        same += int(((wanted.zoom == part.zoom) & (wanted.samples_x * wanted.samples_y == part.du.shape[1])).sum())
        count += int(inner.sum())
    assert count > 0.4 * seen.depth_m.size
    assert same > 0.97 * count


@pytest.mark.usefixtures("ray_code")
def test_rows_are_those_of_the_whole_picture(camera, town):
    rng = np.random.default_rng(3)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    rows = 37, 90
    whole, part = (tracing_of(camera, town, 30.0, ground=ground, rows=some) for some in (None, rows))
    wanted, found = whole.sighting, part.sighting
    depth = wanted.depth_m[slice(*rows)]
    off = np.abs(found.depth_m - depth) / depth
    assert np.mean(~(off < 1e-4) & np.isfinite(depth)) < 2e-3
    assert np.mean(found.instance != wanted.instance[slice(*rows)]) < 1e-3
    assert (found.kind == ROOF).any()


@pytest.mark.parametrize("tilt_deg", [0.0, 50.0, 75.0])
def test_the_box_of_the_ground_holds_all_that_the_pixels_see(camera, tilt_deg):
    rng = np.random.default_rng(3)
    ground = 100.0 + np.cumsum(rng.normal(0.0, 1.0, (160, 160)), axis=1)
    made = tracing_of(camera, NO_FACES, tilt_deg, ground=ground, height_m=float(ground.max()) + 80.0)
    seen = made.sighting
    u, v = GRID.plane.forward(seen.lat_deg, seen.lon_deg)
    west, north, east, south = made.box(GRID)
    assert np.isfinite(u).sum() > 1000
    assert west <= np.nanmin(u)
    assert np.nanmax(u) <= east
    assert north <= np.nanmin(v)
    assert np.nanmax(v) <= south


@pytest.mark.parametrize("rise_m", [1e-3, 3.0])
def test_level_ground_stands_for_relief_only_where_no_pixel_shows_the_difference(camera, rise_m):
    rng = np.random.default_rng(3)
    made = tracing_of(camera, NO_FACES, 0.0, ground=100.0 + rng.uniform(0.0, rise_m, (160, 160)), height_m=350.0)
    if rise_m > 1.0:
        assert made.level_m is None
        return
    assert made.level_m == pytest.approx(100.0 + rise_m / 2.0, abs=rise_m / 2.0)
    row, column, _ = all_pixels(made)
    seen = made.sighting
    at = np.isfinite(seen.depth_m)
    level = tracing_of(camera, NO_FACES, 0.0, ground=np.full((160, 160), made.level_m), height_m=350.0).sighting
    place = *made.place, made.height_m
    points = (geocentric(level.lat_deg[at], level.lon_deg[at], seen.height_m[at]) - geocentric(*place)) @ enu_axes(
        *place[:2]
    ).T
    px = seen_by_opencv(camera, *(points @ axes_of(made).T).T)
    centres = np.stack([column + 0.5, row + 0.5], axis=1)[at.ravel()]
    assert np.hypot(*(px - centres).T).max() < TOLERANCE_PX
