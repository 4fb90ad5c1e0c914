"""Images through lenses that distort: marks on the ground are where OpenCV projects them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pyproj
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.mercator import v_to_lat
from terrainav.core.geodesy.view import ImageRays, mesh
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.products import sighting

from tests.core.geodesy.test_distorted_views import perspective
from tests.support.rasters import write

cv2 = pytest.importorskip("cv2")

#: North-west corner of the raster in UTM zone 31, its pixels in metres, and their number along each side.
EAST, NORTH, PIXEL_M, SIDE_PX = 499_600.0, 5_400_400.0, 0.25, 3200
#: Marks every 20 m, each a bell of this standard deviation.
SPACING_M, SIGMA_M = 40.0, 2.5
AGL_M, IMAGE_PX = 400.0, 640
ATTITUDE = (20.0, 12.0, -4.0)
CAMERAS = {
    "barrel": Camera(60.0, k1=-0.25, k2=0.08, p1=1e-3, p2=-2e-3, principal_x=0.01, principal_y=-0.02),
    "rational": Camera(60.0, k1=0.6, k2=0.1, k3=0.01, k4=0.8, k5=0.2, k6=0.03),
    "fisheye": Camera(70.0, lens="fisheye", k1=0.02, k2=-0.01, k3=2e-3, k4=-1e-3, principal_y=0.01),
}


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Bells of light on dark ground."""
    at = (np.arange(SIDE_PX) + 0.5) * PIXEL_M
    bell = np.exp(-0.5 * ((np.mod(at, SPACING_M) - SPACING_M / 2.0) / SIGMA_M) ** 2)
    grey = np.rint(250.0 * bell[:, np.newaxis] * bell).astype(np.uint8)
    path = tmp_path_factory.mktemp("marks") / "marks.tif"
    write(path, np.stack([grey] * 3), (EAST, PIXEL_M, 0.0, NORTH, 0.0, -PIXEL_M), 32631)
    return named_source(str(path)).open()


def marks(off_east_m=0.0, off_north_m=0.0):
    """Latitudes and longitudes of the marks, or of points beside each, (n, ...)."""
    offsets = np.arange(SPACING_M / 2.0, SIDE_PX * PIXEL_M, SPACING_M)
    east, north = (at.ravel() for at in np.meshgrid(EAST + offsets, NORTH - offsets))
    east, north = np.add.outer(east, off_east_m), np.add.outer(north, off_north_m)
    lon, lat = pyproj.Transformer.from_crs(32631, 4326, always_xy=True).transform(east, north)
    return np.asarray(lat), np.asarray(lon)


def projected(camera, pose, size_px, lat, lon, height_m=0.0):
    """Pixels (n, 2) of places, by PROJ's geocentric coordinates and OpenCV."""
    to_earth = pyproj.Transformer.from_crs(4979, 4978, always_xy=True)
    at_lat, at_lon, agl_m, yaw, tilt, roll = pose
    here = np.array(to_earth.transform(at_lon, at_lat, agl_m))
    there = np.stack(to_earth.transform(lon, lat, np.broadcast_to(height_m, np.shape(lon))), axis=-1)
    (sin_lat, cos_lat), (sin_lon, cos_lon) = ((np.sin(a), np.cos(a)) for a in np.radians((at_lat, at_lon)))
    enu = np.array(
        [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ]
    )
    (sy, cy), (st, ct), (sr, cr) = ((np.sin(a), np.cos(a)) for a in np.radians((yaw, tilt, roll)))
    # Right, down and ahead of a camera that looks straight down with its top to the north, turned by roll, tilt, yaw.
    down = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    rolled = np.array([[cr, 0.0, -sr], [0.0, 1.0, 0.0], [sr, 0.0, cr]])
    tilted = np.array([[1.0, 0.0, 0.0], [0.0, ct, st], [0.0, -st, ct]])
    yawed = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    points = (there - here) @ (down @ rolled @ tilted @ yawed @ enu).T
    (width, height), (tan_x, tan_y) = size_px, camera.half_tangents
    matrix = np.array(
        [
            [width / 2.0 / tan_x, 0.0, width * (0.5 + camera.principal_x)],
            [0.0, height / 2.0 / tan_y, height * (0.5 + camera.principal_y)],
            [0.0, 0.0, 1.0],
        ]
    )
    still = np.zeros(3)
    if camera.lens == "fisheye":
        k = np.array([camera.k1, camera.k2, camera.k3, camera.k4])
        return cv2.fisheye.projectPoints(points[:, np.newaxis], still, still, matrix, k)[0][:, 0]
    k = np.array([getattr(camera, name) for name in ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")])
    return cv2.projectPoints(points, still, still, matrix, k)[0][:, 0]


def mission_of(source, camera, **values):
    lat, lon = marks()
    # Beside the middle of the raster, and its marks.
    pose = (float(np.mean(lat)) - 6e-4, float(np.mean(lon)) + 1e-4, AGL_M)
    yaw, tilt, roll = ATTITUDE
    given = {"yaw_deg": yaw, "tilt_deg": tilt, "roll_deg": roll, "image_px": IMAGE_PX, "error_budget_px": 0.01}
    return Mission(Points((pose,)), AGL_M, camera, **{**given, "upsample": True, **values})


def captured(source, folder, mission):
    made = plan(mission, source.grid)
    capture(made, source, folder)
    (path,) = folder.glob("*/*.tif")
    return made, np.asarray(Image.open(path)).astype(float)


def centroids(grey, at, reach=14):
    """Centroids (n, 2) of light around pixels, less that of the dark between."""
    found = []
    for x, y in at:
        column, row = int(np.floor(x)), int(np.floor(y))
        part = grey[row - reach : row + reach + 1, column - reach : column + reach + 1]
        weights = np.clip(part - 4.0, 0.0, None)
        shares = np.stack(np.meshgrid(np.arange(-reach, reach + 1), np.arange(-reach, reach + 1)), axis=-1)
        found.append(np.array([column, row]) + 0.5 + np.tensordot(weights, shares, 2) / weights.sum())
    return np.array(found)


def seen_marks(camera, made, colour="green"):
    """Pixels of the marks inside an image: centroids of their light, of which pixels that span more ground get more."""
    size = made.views.size_px(0)
    pose = [float(values[0]) for values in made.poses]
    steps = np.linspace(-3.0, 3.0, 25) * SIGMA_M
    off_east, off_north = np.meshgrid(steps, steps)
    lat, lon = marks(off_east, off_north)
    at = projected(camera.of_colour(colour), pose, size, lat.ravel(), lon.ravel()).reshape(*lat.shape, 2)
    middle = at[:, 12, 12]
    at = at[(middle > 15.0).all(axis=1) & (middle < np.array(size) - 15.0).all(axis=1)]
    down, across = np.gradient(at, axis=(1, 2))
    area = np.abs(across[..., 0] * down[..., 1] - across[..., 1] * down[..., 0])
    light = 250.0 * np.exp(-0.5 * (off_east**2 + off_north**2) / SIGMA_M**2)
    weights = area * np.clip(light - 4.0, 0.0, None)
    return (at * weights[..., np.newaxis]).sum(axis=(1, 2)) / weights.sum(axis=(1, 2))[:, np.newaxis]


@pytest.mark.parametrize("by_rays", [False, True])
@pytest.mark.parametrize("name", CAMERAS)
def test_marks_are_where_opencv_projects_them(source, tmp_path, name, by_rays):
    camera = CAMERAS[name]
    # Where the zoom changes, bilinear samples shift light by some hundredths of a pixel.
    values = {"mesh": "rays", "resampling": "lanczos"} if by_rays else {}
    made, picture = captured(source, tmp_path / "out", mission_of(source, camera, **values))
    assert made.accuracy.choices[-1].method.name == ("rays" if by_rays else "mesh")
    at = seen_marks(camera, made)
    assert len(at) > 50
    off = np.hypot(*(centroids(picture[..., 1], at) - at).T)
    assert off.max() < 0.02


@pytest.mark.parametrize("tolerance_px", [0.1, 0.3])
@pytest.mark.parametrize("name", CAMERAS)
def test_meshes_err_to_no_side(name, tolerance_px):
    # A camera that errs outward sees ground as if it were lower.
    camera, size, lat, lon = CAMERAS[name], (640, 480), 48.0, 3.0
    pose = Poses.from_attitude(np.array([lat]), np.array([lon]), np.array([AGL_M]), *ATTITUDE)
    cells = mesh(ImageRays.from_scene(ImageGeometry(camera, *size, pose)), tolerance_px)
    random = np.random.default_rng(3)
    areas = (cells.box[:, 2:] - cells.box[:, :2]).prod(axis=1)
    at = random.choice(len(areas), 6000, p=areas / areas.sum())
    shares = random.uniform(0.0, 1.0, (len(at), 2))
    pixels = cells.box[at, :2] + shares * (cells.box[at, 2:] - cells.box[at, :2])
    du, v = perspective(np.stack([cells.du[at], cells.v[at]], axis=-1), *shares.T).T
    off = projected(camera, (lat, lon, AGL_M, *ATTITUDE), size, v_to_lat(v), lon + 360.0 * du) - pixels
    assert np.hypot(*off.T).max() <= tolerance_px
    outward = pixels - np.array(size) * (0.5 + camera.principal_x, 0.5 + camera.principal_y)
    aside = (off * outward).sum(axis=1)
    assert abs((aside / np.hypot(*outward.T)).mean()) < 0.015 * tolerance_px
    assert abs(aside.sum() / (outward * outward).sum()) < 5e-5 * tolerance_px


def test_red_and_blue_are_scaled_about_the_principal_point(source, tmp_path):
    camera = dataclasses.replace(CAMERAS["barrel"], red_scale=2e-3, blue_scale=-1e-3)
    made, picture = captured(source, tmp_path / "out", mission_of(source, camera))
    for channel, colour in enumerate(("red", "green", "blue")):
        at = seen_marks(camera, made, colour)
        assert np.hypot(*(centroids(picture[..., channel], at) - at).T).max() < 0.02
    # A corner is 400 px from the middle.
    green, red = (
        projected(camera.of_colour(one), [48.0, 3.0, 400.0, 0.0, 0.0, 0.0], (640, 480), 48.0012, 3.0023)
        for one in ("green", "red")
    )
    assert 0.4 < np.hypot(*(red - green)[0]) < 0.9


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("size_px", [(640, 480), (320, 240)])
def test_points_and_depths_of_pixels_are_those_of_opencv(source, name, size_px):
    camera = CAMERAS[name]
    made = plan(mission_of(source, camera, products=("depth", "points")), source.grid)
    seen = sighting(made, 0, size_px)
    pose = [float(values[0]) for values in made.poses]
    at = projected(camera, pose, size_px, seen.lat_deg.ravel(), seen.lon_deg.ravel(), seen.height_m.ravel())
    column, row = np.meshgrid(np.arange(size_px[0]) + 0.5, np.arange(size_px[1]) + 0.5)
    assert np.abs(at - np.stack([column.ravel(), row.ravel()], axis=1)).max() < 2e-3
    # Depth is along the optical axis, which the principal point shows.
    x, y = (int(size * (0.5 + shift)) for size, shift in zip(size_px, (camera.principal_x, camera.principal_y)))
    slant = AGL_M / np.cos(np.radians(ATTITUDE[1])) / np.cos(np.radians(ATTITUDE[2]))
    assert seen.depth_m[y, x] == pytest.approx(slant, rel=2e-3)


def test_images_cover_what_the_plan_says(source):
    camera = CAMERAS["barrel"]
    lat, lon = marks()
    box = Box(lat.mean() + 6e-4, lon.mean() - 8e-4, lat.mean() - 6e-4, lon.mean() + 8e-4)
    made = plan(Mission(box, 100.0, camera, overlap_along=0.2, overlap_across=0.2, tilt_deg=10.0), source.grid)
    assert made.coverage.share == 1.0
    some_lat, some_lon = (
        at.ravel()
        for at in np.meshgrid(
            np.linspace(*sorted((box.south_deg, box.north_deg)), 60), np.linspace(box.west_deg, box.east_deg, 60)
        )
    )
    shown = np.zeros(len(some_lat), int)
    for index in range(len(made)):
        size = made.views.size_px(index)
        pose = [float(values[index]) for values in made.poses]
        at = projected(camera, pose, size, some_lat, some_lon)
        near = np.hypot((some_lat - pose[0]) * 111e3, (some_lon - pose[1]) * 73e3) < 200.0
        shown += near & (at >= -1e-6).all(axis=1) & (at <= np.array(size) + 1e-6).all(axis=1)
    assert (shown > 0).all()


def test_a_map_frame_has_no_lens(source):
    with pytest.raises(InvalidInput, match="the lens distorts images, which windows of a map do not"):
        plan(mission_of(source, CAMERAS["barrel"], frame="map"), source.grid)
    # Without a lens a level image is a window of the source.
    level = {"yaw_deg": 0.0, "tilt_deg": 0.0, "roll_deg": 0.0, "frame": "auto", "error_budget_px": 50.0}
    for camera, name in (
        (Camera(60.0), "map"),
        (CAMERAS["barrel"], "camera"),
        (Camera(60.0, red_scale=1e-3), "camera"),
    ):
        assert plan(mission_of(source, camera, **level), source.grid).accuracy.picture.method.name == name


def test_a_mission_file_states_only_what_distorts():
    mission = Mission(Points(((48.0, 3.0, 100.0),)), 100.0, Camera(60.0, k1=-0.1))
    assert mission.to_dict()["camera"] == {"fov_deg": 60.0, "k1": -0.1}
    assert Mission.from_json(mission.to_json()) == mission
    assert "camera" not in Mission(Points(((48.0, 3.0, 100.0),)), 100.0).to_dict()
