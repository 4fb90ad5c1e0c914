"""Calibration of captured checkerboards by OpenCV finds the camera's parameters."""

from __future__ import annotations

import numpy as np
import pyproj
import pytest
from PIL import Image
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.ellipsoid import sight_lines
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.picture.test_lens import projected
from tests.support.rasters import write
from tests.support.thinning import sampled

cv2 = pytest.importorskip("cv2")

#: North-west corner of the board in UTM zone 31, its pixels in metres, and pixels along each side.
EAST, NORTH, PIXEL_M, SIDE_PX = 499_700.0, 5_400_300.0, 0.25, 2400
#: Side of a square, and half the reach of its corners from the middle.
SQUARE_M, REACH_M = 6.0, 240.0
AGL_M, SIZE_PX = 100.0, (640, 480)
CAMERAS = {
    "perspective": Camera(70.0, k1=-0.25, k2=0.09, k3=-0.012, p1=1e-3, p2=-7e-4, principal_x=0.008, principal_y=-0.012),
    "fisheye": Camera(90.0, lens="fisheye", k1=0.03, k2=-0.012, k3=4e-3, k4=-1e-3, principal_x=-0.006),
}
#: Quantiles of chi-squared that 99.73 % lie below (3 sigma of one normal variable), by degrees of freedom.
THREE_SIGMA = {8: 23.57, 9: 25.26}


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    at = (np.arange(SIDE_PX) + 0.5) * PIXEL_M // SQUARE_M
    board = np.where((at[:, np.newaxis] + at) % 2 == 0, 220, 30).astype(np.uint8)
    path = tmp_path_factory.mktemp("board") / "board.tif"
    write(path, np.stack([board] * 3), (EAST, PIXEL_M, 0.0, NORTH, 0.0, -PIXEL_M), 32631)
    return named_source(str(path)).open()


def places():
    """Corners of the squares: metres from the middle of the board (n, 2), latitudes and longitudes."""
    middle = SIDE_PX * PIXEL_M / 2.0
    steps = np.arange(np.ceil((middle - REACH_M) / SQUARE_M), (middle + REACH_M) / SQUARE_M) * SQUARE_M
    east, north = (at.ravel() for at in np.meshgrid(EAST + steps, NORTH - steps))
    lon, lat = pyproj.Transformer.from_crs(32631, 4326, always_xy=True).transform(east, north)
    return np.stack([east - EAST - middle, north - NORTH + middle], axis=1), np.asarray(lat), np.asarray(lon)


def views(source, camera):
    """A plan of 20 images around the middle of the board."""
    random = np.random.default_rng(4)
    east, north = EAST + SIDE_PX * PIXEL_M / 2.0, NORTH - SIDE_PX * PIXEL_M / 2.0
    yaw, tilt = random.uniform(-180.0, 180.0, 20), random.uniform(5.0, 32.0, 20)
    # The camera looks at a place near the middle.
    back = AGL_M * np.tan(np.radians(tilt))
    x, y = random.uniform(-20.0, 20.0, (2, 20)) - back * np.array([np.sin(np.radians(yaw)), np.cos(np.radians(yaw))])
    lon, lat = pyproj.Transformer.from_crs(32631, 4326, always_xy=True).transform(east + x, north + y)
    agl = random.uniform(0.8, 1.2, 20) * AGL_M
    points = Points(
        tuple(zip(lat.tolist(), lon.tolist(), agl.tolist())),
        yaws_deg=tuple(yaw.tolist()),
        tilts_deg=tuple(tilt.tolist()),
        rolls_deg=tuple(random.uniform(-10.0, 10.0, 20).tolist()),
    )
    mission = Mission(points, AGL_M, camera, image_px=SIZE_PX[0], mesh="rays", upsample=True, image_format="png")
    return plan(mission, source.grid)


def found_corners(made, folder):
    """Metres on the board (k, 3) and pixels (k, 2) of the corners in each image, as OpenCV refines them.

    It begins up to a pixel and a half beside them.
    """
    metres, lat, lon = places()
    random = np.random.default_rng(8)
    for index, name in enumerate(made.names):
        grey = np.asarray(Image.open(next(folder.glob(f"*/{name}*.png"))).convert("L"))
        pose = [float(values[index]) for values in made.poses]
        at = projected(made.mission.camera, pose, SIZE_PX, lat, lon)
        lines = sight_lines(np.array(pose[0]), np.array(pose[2]), lat, lon - pose[1])
        image_xy, in_front = made.mission.camera.image_xy(lines, *pose[3:])
        # Far outside the image OpenCV's polynomials may fold points back into it.
        inside = in_front & (np.abs(image_xy) < 1.0).all(axis=1)
        inside &= (at > 20.0).all(axis=1) & (at < np.array(SIZE_PX) - 20.0).all(axis=1)
        # Squares must be larger than the window.
        side = round(len(at) ** 0.5)
        sides = np.gradient(at.reshape(side, side, 2), axis=(0, 1))
        inside &= np.min([np.hypot(*np.moveaxis(one, -1, 0)) for one in sides], axis=0).ravel() > 22.0
        start = (at[inside] + random.uniform(-1.5, 1.5, (int(inside.sum()), 2)) - 0.5).astype(np.float32)
        criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
        refined = cv2.cornerSubPix(grey, start[:, np.newaxis].copy(), (6, 6), (-1, -1), criteria)[:, 0]
        known = np.column_stack([metres[inside], np.zeros(int(inside.sum()))])
        yield known.astype(np.float32), refined.astype(np.float64) + 0.5


def truth(camera):
    """Focal lengths, principal point and coefficients."""
    (width, height), (tan_x, tan_y) = SIZE_PX, camera.half_tangents
    pinhole = width / 2.0 / tan_x, height / 2.0 / tan_y
    centre = width * (0.5 + camera.principal_x), height * (0.5 + camera.principal_y)
    names = ("k1", "k2", "k3", "k4") if camera.lens == "fisheye" else ("k1", "k2", "p1", "p2", "k3")
    return np.array([*pinhole, *centre, *(getattr(camera, name) for name in names)])


def calibrated(camera, known, seen):
    """Parameters in the order of `truth`, their covariance by OpenCV's derivatives, and the rms error per point."""
    guess = np.array([[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]])
    flags = cv2.CALIB_USE_INTRINSIC_GUESS
    criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-12)
    if camera.lens == "fisheye":
        guess[0, 0] = guess[1, 1] = 420.0
        flags = (
            cv2.fisheye.CALIB_USE_INTRINSIC_GUESS | cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_FIX_SKEW
        )
        parts = [one[:, np.newaxis].astype(np.float64) for one in known], [one[:, np.newaxis] for one in seen]
        _, matrix, k, turns, shifts = cv2.fisheye.calibrate(
            *parts, SIZE_PX, guess, np.zeros(4), None, None, flags, criteria
        )
    else:
        parts = known, [one[:, np.newaxis].astype(np.float32) for one in seen]
        _, matrix, k, turns, shifts = cv2.calibrateCamera(*parts, SIZE_PX, guess, None, None, None, flags, criteria)
    parameters = np.array([matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], *np.ravel(k)])
    shared, squares, count = np.zeros((len(parameters),) * 2), 0.0, 0
    for points, at, turn, shift in zip(known, seen, turns, shifts):
        one = points.astype(np.float64)
        if camera.lens == "fisheye":
            found, slopes = cv2.fisheye.projectPoints(one[:, np.newaxis], turn, shift, matrix, k)
            # f, c, k, then rotation, translation and skew.
            inner, outer = slopes[:, :8], slopes[:, 8:14]
        else:
            found, slopes = cv2.projectPoints(one, turn, shift, matrix, k)
            outer, inner = slopes[:, :6], slopes[:, 6:15]
        off = found.reshape(-1, 2) - at
        squares, count = squares + float((off**2).sum()), count + off.size
        # What the image's own pose explains is no information on the camera.
        mixed = inner.T @ outer
        shared += inner.T @ inner - mixed @ np.linalg.solve(outer.T @ outer, mixed.T)
    variance = squares / (count - 6 * len(known) - len(parameters))
    return parameters, variance * np.linalg.inv(shared), float(np.sqrt(2.0 * squares / count))


@pytest.mark.parametrize("name", sampled(list(CAMERAS), 2))
def test_calibration_finds_the_camera(source, tmp_path, name):
    camera = CAMERAS[name]
    made = views(source, camera)
    capture(made, source, tmp_path / "out")
    known, seen = zip(*found_corners(made, tmp_path / "out"))
    assert len(known) == 20
    found, covariance, rms_px = calibrated(camera, known, seen)
    assert rms_px < 0.1
    off = found - truth(camera)
    assert float(off @ np.linalg.solve(covariance, off)) < THREE_SIGMA[len(off)]
