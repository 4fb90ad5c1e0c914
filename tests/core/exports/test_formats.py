"""Exports: images whose colours tell their place are found where the exported files alone say."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pyproj import Transformer
from scipy.spatial.transform import Rotation
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.clean import clean
from terrainav.core.dataset.table import Table
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.exports.formats import FORMATS, ORIGIN_FILE, export
from terrainav.core.exports.kinds import VIEWS
from terrainav.core.exports.views import Views
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.quaternions import quaternions_from_matrices
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.products import sighting

from tests.support import rasters
from tests.support.command import command

EPSG = 32616
WEST, NORTH, SIDE = 230_000.0, 3_890_000.0, 700
PLACED = (WEST, 1.0, 0.0, NORTH, 0.0, -1.0)
TO_UTM = Transformer.from_crs(4326, EPSG, always_xy=True)
TO_DEGREES = Transformer.from_crs(EPSG, 4326, always_xy=True)
TO_ECEF = Transformer.from_crs(4979, 4978, always_xy=True)
FROM_ECEF = Transformer.from_crs(4978, 4979, always_xy=True)


#: Lenses with their names in COLMAP and nerfstudio, the latter empty where it has none.
LENSES = {
    "brown": (Camera(70.0, k1=-0.2, k2=0.05, p1=0.002, p2=-0.001, principal_x=0.02), "OPENCV", "OPENCV"),
    "radial": (Camera(70.0, k1=-0.2, k2=0.05, k3=0.01), "FULL_OPENCV", "OPENCV"),
    "rational": (Camera(70.0, k1=0.2, k2=0.1, k4=0.4, k5=0.1, k6=0.02, principal_y=-0.01), "FULL_OPENCV", ""),
    "fisheye": (Camera(110.0, lens="fisheye", k1=0.02, k2=-0.01), "OPENCV_FISHEYE", "OPENCV_FISHEYE"),
}


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    """Tilted, rolled and turned views of colours that tell their place, above ground of 40 m."""
    return captured_with(Camera(), tmp_path_factory.mktemp("captured"))


def captured_with(camera: Camera, folder: Path, **more) -> Path:
    x, y = rasters.centres(PLACED, SIDE, SIDE)
    source = open_source(
        str(rasters.write(folder / "places.tif", rasters.position_colours(x - WEST, NORTH - y), PLACED, EPSG))
    )
    rng = np.random.default_rng(2)
    lon, lat = TO_DEGREES.transform(WEST + 200 + 300 * rng.random(7), NORTH - 200 - 300 * rng.random(7))
    poses = tuple((a, b, 80.0 + 5.0 * at) for at, (a, b) in enumerate(zip(lat.tolist(), lon.tolist())))
    yaws = tuple(float(yaw) for yaw in rng.uniform(-180.0, 180.0, 7))
    mission = Mission(
        Points(poses, yaws),
        80.0,
        camera,
        tilt_deg=25.0,
        roll_deg=-12.0,
        ground_height_m=40.0,
        image_px=90,
        image_format="png",
        mesh="rays",
        **more,
    )
    capture(plan(mission, source.grid), source, folder / "out")
    return folder / "out"


def origin_of(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Place of a folder's origin in geocentric axes, and the frame's axes in these (columns)."""
    told = json.loads((folder / ORIGIN_FILE).read_text())
    lat, lon = np.radians([told["lat_deg"], told["lon_deg"]])
    place = np.array(TO_ECEF.transform(told["lon_deg"], told["lat_deg"], told["height_m"]))
    east = [-np.sin(lon), np.cos(lon), 0.0]
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    up = [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)]
    return place, np.stack([east, north, up], axis=1)


def opencv_rays(model: str, parameters, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Rays (3, n) of image points, whose (0, 0) is the upper left corner, by OpenCV and the parameters of COLMAP."""
    cv2 = pytest.importorskip("cv2")
    fx, fy, cx, cy, *distortion = parameters
    matrix, points = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]), np.stack([x, y], axis=1)[:, np.newaxis]
    undistort = cv2.fisheye.undistortPoints if model == "OPENCV_FISHEYE" else cv2.undistortPointsIter
    criteria = (cv2.TERM_CRITERIA_MAX_ITER + cv2.TERM_CRITERIA_EPS, 100, 1e-12)
    more = () if model == "OPENCV_FISHEYE" else (None, np.eye(3))
    found = undistort(points, matrix, np.array(distortion), *more, **({} if not more else {"criteria": criteria}))
    return np.vstack([found[:, 0].T, np.ones(len(x))])


def check_colours(image: Path, focal, to_world: np.ndarray, centre: np.ndarray, origin, model="PINHOLE") -> None:
    """Rays of OpenCV's axes, turned by a matrix, from a place, hit the ground of 40 m where the colours say."""
    with Image.open(image) as opened:
        seen = np.asarray(opened, float)
    rows, columns = np.mgrid[5 : seen.shape[0] - 5 : 6, 5 : seen.shape[1] - 5 : 6]
    x, y = columns.ravel() + 0.5, rows.ravel() + 0.5
    if model == "PINHOLE":
        fx, fy, cx, cy = focal
        rays = np.stack([(x - cx) / fx, (y - cy) / fy, np.ones(rows.size)])
    else:
        rays = opencv_rays(model, focal, x, y)
    place, axes = origin
    start, towards = place + axes @ centre, axes @ to_world @ rays
    # On a surface 40 m above the ellipsoid, found by Newton's method on the height that PROJ tells.
    far = np.full(rows.size, 100.0)
    for _ in range(8):
        heights = [FROM_ECEF.transform(*(start[:, None] + towards * (far + by)))[2] - 40.0 for by in (0.0, 0.01)]
        far = far - heights[0] * 0.01 / (heights[1] - heights[0])
    assert np.isfinite(far).all()
    lon, lat, _ = FROM_ECEF.transform(*(start[:, None] + towards * far))
    x, y = TO_UTM.transform(lon, lat)
    waves = (x - WEST, NORTH - y, x - WEST + NORTH - y)
    # Far off the axis of a fisheye, pixels are larger.
    straight = ~np.any([rasters.turns(wave, 3.0 if model == "PINHOLE" else 6.0) for wave in waves], axis=0)
    expected = np.stack([rasters.triangle(wave) for wave in waves])
    off = np.abs(seen[rows.ravel(), columns.ravel()].T - expected)[:, straight]
    assert straight.sum() > 40
    # A tenth of a pixel of the image, which shows a metre or more, at 4 levels a metre of each axis; half for rounding.
    assert (off.max(axis=1) <= 0.1 * np.array([4.0, 4.0, 8.0]) * 1.5 + 0.501).all()


def test_colmap(captured, tmp_path):
    folder = export(Views.read(captured), tmp_path / "model", "colmap") / "sparse" / "0"
    cameras = {}
    comment, *rows = (folder / "cameras.txt").read_text().splitlines()
    assert comment == "# CAMERA_ID MODEL WIDTH HEIGHT FX FY CX CY"
    for line in rows:
        number, model, _, _, *focal = line.split()
        assert model == "PINHOLE"
        cameras[number] = [float(one) for one in focal]
    lines = (folder / "images.txt").read_text().splitlines()[1:]
    assert len(lines) == 14
    assert set(lines[1::2]) == {""}
    origin = origin_of(tmp_path / "model")
    for line in lines[::2]:
        _, *numbers, camera, name = line.split()
        w, x, y, z, *shift = map(float, numbers)
        rotation = Rotation.from_quat([x, y, z, w]).as_matrix()
        check_colours(captured / "satellite" / name, cameras[camera], rotation.T, -rotation.T @ shift, origin)


@pytest.mark.parametrize("lens", LENSES)
def test_lenses_that_distort(lens, tmp_path):
    camera, colmap, nerfstudio = LENSES[lens]
    captured = captured_with(camera, tmp_path)
    folder = export(Views.read(captured), tmp_path / "model", "colmap") / "sparse" / "0"
    cameras = {}
    for line in (folder / "cameras.txt").read_text().splitlines()[1:]:
        number, model, _, _, *parameters = line.split()
        assert model == colmap
        cameras[number] = [float(one) for one in parameters]
    origin = origin_of(tmp_path / "model")
    for line in (folder / "images.txt").read_text().splitlines()[1::2]:
        _, *numbers, number, name = line.split()
        w, x, y, z, *shift = map(float, numbers)
        rotation = Rotation.from_quat([x, y, z, w]).as_matrix()
        image = captured / "satellite" / name
        check_colours(image, cameras[number], rotation.T, -rotation.T @ shift, origin, colmap)
    row = Table.load(captured / "satellite" / "meta_data.csv").other
    assert {row[name][0] for name in ("lens", "k1")} == {camera.lens, str(camera.k1)}
    if not nerfstudio:
        with pytest.raises(InvalidInput, match="nerfstudio has no such lens"):
            export(Views.read(captured), tmp_path / "nerf", "nerfstudio")
        return
    document = json.loads(
        (export(Views.read(captured), tmp_path / "nerf", "nerfstudio") / "transforms.json").read_text()
    )
    assert document["camera_model"] == nerfstudio
    frame = document["frames"][0]
    assert [frame[name] for name in ("fl_x", "fl_y", "cx", "cy")] in [one[:4] for one in cameras.values()]
    stated = {name: document[name] for name in document if name[0] in "kp"}
    assert stated == {name: getattr(camera, name) for name in stated}
    assert {name for name in ("k1", "k2", "k3", "k4", "p1", "p2") if getattr(camera, name)} <= set(stated)


@pytest.mark.parametrize("lens", ["ideal", *LENSES])
def test_cameras_are_written_digit_by_digit(lens, tmp_path):
    """The bytes of before formats derived from the contract: whatever the mission's camera gives, unrounded."""
    camera, model, nerfstudio = LENSES.get(lens, (Camera(70.0), "PINHOLE", "OPENCV"))
    views = Views.read(captured_with(camera, tmp_path))
    wide, high = int(views.width_px[0]), int(views.height_px[0])
    tan_x, tan_y = camera.half_tangents
    pinhole = [wide / 2.0 / tan_x, high / 2.0 / tan_y]
    pinhole += [wide * (0.5 + camera.principal_x), high * (0.5 + camera.principal_y)]
    names = {"PINHOLE": "", "OPENCV": "k1 k2 p1 p2", "OPENCV_FISHEYE": "k1 k2 k3 k4"}
    more = names.get(model, "k1 k2 p1 p2 k3 k4 k5 k6").split()
    numbers = " ".join(repr(one) for one in (*pinhole, *(getattr(camera, name) for name in more)))
    text = (export(views, tmp_path / "model", "colmap") / "sparse" / "0" / "cameras.txt").read_text()
    assert text.splitlines()[1] == f"1 {model} {wide} {high} {numbers}"
    if not nerfstudio:
        return
    names = ("k1", "k2", "k3", "k4") if camera.lens == "fisheye" else ("k1", "k2", "k3", "p1", "p2")
    stated = [(name, getattr(camera, name)) for name in names if name != "k3" or camera.k3]
    document = json.loads((export(views, tmp_path / "nerf", "nerfstudio") / "transforms.json").read_text())
    frame = zip(("w", "h", "fl_x", "fl_y", "cx", "cy"), (wide, high, *pinhole))
    assert list(document.items())[:-1] == [("camera_model", nerfstudio), *stated]
    assert list(document["frames"][0].items())[1:-1] == list(frame)


VARIED = {
    "brown": (
        Camera(70.0, k2=0.05),
        "k1=uniform(-0.2,0.05)",
        "p2=uniform(-0.002,0.002)",
        "principal_x=choice(-0.04,0.04)",
    ),
    "zoom": (Camera(70.0, k1=-0.1, k3=0.01), "fov_deg=uniform(55,80)", "principal_y=uniform(-0.03,0.03)"),
    "fisheye": (LENSES["fisheye"][0], "k1=uniform(-0.02,0.03)", "fov_deg=uniform(80,95)"),
}


@pytest.mark.parametrize("lens", VARIED)
def test_lenses_that_vary(lens, tmp_path):
    """Each image has its camera: colours of the ground, and its points, are where OpenCV projects them."""
    cv2 = pytest.importorskip("cv2")
    camera, *texts = VARIED[lens]
    captured = captured_with(camera, tmp_path, vary=tuple(texts))
    folder = export(Views.read(captured), tmp_path / "model", "colmap") / "sparse" / "0"
    cameras = {}
    for line in (folder / "cameras.txt").read_text().splitlines()[1:]:
        number, model, _, _, *parameters = line.split()
        cameras[number] = model, [float(one) for one in parameters]
    assert len(cameras) == len(Views.read(captured)) > 5
    place, axes = origin_of(tmp_path / "model")
    mission = Mission.load(captured / "mission.json")
    made = plan(mission, open_source(str(tmp_path / "places.tif")).grid)
    table = Table.load(captured / "satellite" / "meta_data.csv")
    document = json.loads(
        (export(Views.read(captured), tmp_path / "nerf", "nerfstudio") / "transforms.json").read_text()
    )
    assert not [name for name in document if name[0] in "kp"]
    frames = {Path(one["file_path"]).name: one for one in document["frames"]}
    for line in (folder / "images.txt").read_text().splitlines()[1::2]:
        _, *numbers, number, name = line.split()
        model, parameters = cameras[number]
        w, x, y, z, *shift = map(float, numbers)
        rotation = Rotation.from_quat([x, y, z, w]).as_matrix()
        image = captured / "satellite" / name
        check_colours(image, parameters, rotation.T, -rotation.T @ shift, (place, axes), model)
        index = made.names.index(image.stem)
        seen = sighting(made, index, made.views.size_px(index))
        some = (slice(3, None, 9), slice(3, None, 9))
        lat, lon, height = (np.asarray(one[some]).ravel() for one in (seen.lat_deg, seen.lon_deg, seen.height_m))
        world = (np.stack(TO_ECEF.transform(lon, lat, height), axis=1) - place) @ axes
        project = cv2.fisheye.projectPoints if model == "OPENCV_FISHEYE" else cv2.projectPoints
        fx, fy, cx, cy, *distortion = parameters
        matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
        turn, _ = cv2.Rodrigues(rotation)
        found, *_ = project(world[:, np.newaxis], turn, np.array(shift), matrix, np.array(distortion))
        rows, columns = np.mgrid[: seen.lat_deg.shape[0], : seen.lat_deg.shape[1]]
        wanted = np.stack([columns[some].ravel() + 0.5, rows[some].ravel() + 0.5], axis=1)
        assert np.abs(found[:, 0] - wanted).max() < 0.01
        # What the table and nerfstudio state of the image.
        own, row = made.camera(index), table.img_names.index(name)
        for variation in mission.varied.of_lens:
            assert float(table.other[variation.field][row]) == getattr(own, variation.field)
        assert float(table.other["k1"][row]) == frames[name]["k1"] == own.k1
        assert [frames[name][one] for one in ("fl_x", "fl_y", "cx", "cy")] == parameters[:4]


def test_nerfstudio(captured, tmp_path):
    folder = export(Views.read(captured), tmp_path / "nerf", "nerfstudio")
    document = json.loads((folder / "transforms.json").read_text())
    assert len(document["frames"]) == 7
    for frame in document["frames"]:
        pose = np.array(frame["transform_matrix"])
        focal = [frame[name] for name in ("fl_x", "fl_y", "cx", "cy")]
        # OpenGL looks along its -z, with y up.
        to_world = pose[:3, :3] @ np.diag([1.0, -1.0, -1.0])
        check_colours(folder / frame["file_path"], focal, to_world, pose[:3, 3], origin_of(folder))


def opengl_rotation(yaw_deg, tilt_deg, roll_deg):
    """Rotation from right, up and back of a camera that looks down from an aircraft, to east, north and up."""
    to_ned = Rotation.from_euler("ZYX", [yaw_deg, tilt_deg, roll_deg], degrees=True).as_matrix()
    to_enu = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    to_body = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    return to_enu @ to_ned @ to_body


@pytest.mark.parametrize("img_size", [None, (40, 60, 3)], ids=["as drawn", "resized"])
def test_nerfstudio_states_the_motion_of_images(tmp_path, img_size):
    area = Points(
        ((34.98, -86.0, 100.0), (34.9801, -85.9998, 110.0), (34.9803, -85.9996, 100.0)),
        (350.0, 20.0, 60.0),
        (0.0, 10.0, 40.0),
        (5.0, -5.0, 0.0),
        times_s=(0.0, 1.5, 2.5),
    )
    given = {"img_size": img_size} if img_size else {}
    mission = Mission(area, 100.0, image_px=80, row_time_us=50.0, motion_blur=True, exposure_ms=4.0, **given)
    source = open_source("world")
    made = plan(mission, source.grid)
    capture(made, source, tmp_path / "made")
    views = Views.read(tmp_path / "made")
    document = json.loads((export(views, tmp_path / "nerf", "nerfstudio") / "transforms.json").read_text())
    assert document["exposure_time"] == pytest.approx(4e-3)
    assert document["rolling_shutter_time"] == pytest.approx(50e-6 * made.views.size_px(0)[1])
    step_s = 1e-4
    for at, frame in enumerate(document["frames"]):
        pose = np.array(frame["transform_matrix"])
        speed = pose[:3, :3] @ frame["camera_linear_velocity"]
        rates = [float(rate[at]) for rate in made.rates]
        assert speed == pytest.approx(rates[:3], abs=1e-2)
        angles = np.array([float(angle[at]) for angle in made.poses.attitude])
        start, end = opengl_rotation(*angles), opengl_rotation(*(angles + np.array(rates[3:]) * step_s))
        assert pose[:3, :3] == pytest.approx(start, abs=1e-5)
        turn = Rotation.from_rotvec(np.array(frame["camera_angular_velocity"]) * step_s).as_matrix()
        assert start @ turn == pytest.approx(end, abs=1e-7)


def test_images_at_rest_state_no_motion(captured, tmp_path):
    folder = export(Views.read(captured), tmp_path / "nerf", "nerfstudio")
    text = (folder / "transforms.json").read_text()
    assert "velocity" not in text
    assert "_time" not in text


def test_tum(captured, tmp_path):
    views = Views.read(captured)
    folder = export(views, tmp_path / "tum", "tum")
    rows = np.loadtxt(folder / "trajectory.txt")
    assert rows.shape == (7, 8)
    assert rows[:, 0].tolist() == list(range(7))
    for at, row in enumerate(rows):
        focal = views.fx_px[at], views.fy_px[at], views.width_px[at] / 2.0, views.height_px[at] / 2.0
        to_world = Rotation.from_quat(row[4:]).as_matrix()
        check_colours(captured / "satellite" / views.names[at], focal, to_world, row[1:4], origin_of(folder))


def test_kitti(captured, tmp_path):
    views = Views.read(captured)
    folder = export(views, tmp_path / "kitti", "kitti")
    rows = np.loadtxt(folder / "poses.txt").reshape(7, 3, 4)
    assert not (folder / "times.txt").exists()
    for at, row in enumerate(rows):
        focal = views.fx_px[at], views.fy_px[at], views.width_px[at] / 2.0, views.height_px[at] / 2.0
        check_colours(captured / "satellite" / views.names[at], focal, row[:, :3], row[:, 3], origin_of(folder))


def test_quaternions_are_those_of_scipy():
    rotations = Rotation.random(200, random_state=1).as_matrix()
    halves = Rotation.from_euler("xyz", [[180, 0, 0], [0, 180, 0], [0, 0, 180], [0, 0, 0]], degrees=True).as_matrix()
    for matrix in np.concatenate([rotations, halves]):
        found = quaternions_from_matrices(matrix[np.newaxis])[0]
        assert found[0] >= 0.0
        assert np.abs(Rotation.from_quat([*found[1:], found[0]]).as_matrix() - matrix).max() < 1e-12


def test_rejected_images_are_left_out(captured, tmp_path):
    folder = tmp_path / "out"
    shutil.copytree(captured, folder)
    clean(folder, 8.0)
    with pytest.raises(InvalidInput, match="has no image to export"):
        Views.read(folder)


def test_windows_of_the_map_are_no_cameras_images(tmp_path):
    source = open_source("world")
    mission = Mission(Points(((35.0, -90.0, 100.0),)), 100.0, image_px=64, image_format="png")
    capture(plan(mission, source.grid), source, tmp_path / "out")
    with pytest.raises(InvalidInput, match=r"which no camera takes; capture camera frames \(--frame camera\)"):
        Views.read(tmp_path / "out")


def test_the_command(captured, tmp_path, monkeypatch, capsys):
    assert set(VIEWS) == set(FORMATS)
    run = command(tmp_path, monkeypatch, capsys)
    done = run("export", str(captured), "model", "--as", "colmap")
    assert done.returncode == 0
    assert done.stdout.startswith("7 images as colmap in model; the images stay in ")
    again = run("export", str(captured), "model", "--as", "tum")
    assert again.returncode == 3
    assert "folder model: is not empty; choose another folder" in again.stderr
    assert run("export", str(tmp_path), "other", "--as", "tum").returncode == 2


def test_bad_requests_are_refused(captured, tmp_path):
    views = Views.read(captured)
    with pytest.raises(InvalidInput, match="format 'ply': must be one of colmap, nerfstudio, tum, kitti"):
        export(views, tmp_path / "a", "ply")
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match="is not empty; choose another folder"):
        export(views, tmp_path, "tum")
    with pytest.raises(InvalidInput, match="map type 'roadmap'"):
        Views.read(captured, "roadmap")
