"""Lenses that distort, measured as cameras are: OpenCV calibrates captured images of a checkerboard."""

from __future__ import annotations

import math

import numpy as np
import pytest
from PIL import Image
from pyproj import Transformer
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.support import rasters

cv2 = pytest.importorskip("cv2")

EPSG, WEST, NORTH, PIXEL_M = 32616, 230_000.0, 3_890_000.0, 0.02
#: Inner corners of the board across and down, and the side of its squares.
CORNERS, SQUARE_M = (11, 8), 1.0
#: Width of the white margin around the squares.
MARGIN_M = 30.0
SIZE = 640, 480
#: Views calibrated, and captured: in some the board is cut off.
VIEWS, TRIED = 20, 30
#: Most standard errors by which a parameter may be off.
SIGMAS = 3.0
LENSES = {
    "brown": Camera(70.0, k1=-0.12, k2=0.05, p1=0.0015, p2=-0.001, principal_x=0.012, principal_y=-0.02),
    "fisheye": Camera(85.0, lens="fisheye", k1=0.03, k2=-0.01, principal_x=-0.01, principal_y=0.015),
}


@pytest.fixture(scope="module")
def board(tmp_path_factory):
    """Raster of a checkerboard, each of whose pixels is the exact mean of what it covers."""
    across, down = ((count + 1) * SQUARE_M for count in CORNERS)
    width, height = (round((side + 2.0 * MARGIN_M) / PIXEL_M) for side in (across, down))
    column, row = ((np.arange(size) + 0.5) * PIXEL_M - MARGIN_M for size in (width, height))
    is_board = ((column > 0.0) & (column < across)) & ((row > 0.0) & (row < down))[:, np.newaxis]
    is_black = (np.floor(column / SQUARE_M) + np.floor(row / SQUARE_M)[:, np.newaxis]) % 2.0 == 0.0
    grey = np.where(is_board & is_black, 40, 215).astype(np.uint8)
    placed = (WEST, PIXEL_M, 0.0, NORTH, 0.0, -PIXEL_M)
    path = rasters.write(tmp_path_factory.mktemp("board") / "board.tif", np.stack([grey] * 3), placed, EPSG)
    return open_source(str(path))


def poses():
    """Views from all sides, of which most see the whole board."""
    rng = np.random.default_rng(11)
    to_degrees = Transformer.from_crs(EPSG, 4326, always_xy=True)
    middle = WEST + MARGIN_M + (CORNERS[0] + 1) / 2.0, NORTH - MARGIN_M - (CORNERS[1] + 1) / 2.0
    found = []
    for _ in range(TRIED):
        yaw, tilt, agl = rng.uniform(-180.0, 180.0), rng.uniform(5.0, 28.0), rng.uniform(13.0, 17.0)
        back = agl * math.tan(math.radians(tilt))
        x = middle[0] - back * math.sin(math.radians(yaw)) + rng.uniform(-0.5, 0.5)
        y = middle[1] - back * math.cos(math.radians(yaw)) + rng.uniform(-0.5, 0.5)
        lon, lat = to_degrees.transform(x, y)
        found.append(((lat, lon, agl), yaw, tilt, rng.uniform(-8.0, 8.0)))
    return Points(*(tuple(column) for column in zip(*found)))


def corners_in(image: np.ndarray) -> np.ndarray | None:
    """Image points of the board's corners, with (0, 0) the centre of the first pixel; None if they are not found."""
    is_found, points = cv2.findChessboardCornersSB(image, CORNERS, cv2.CALIB_CB_EXHAUSTIVE)
    if not is_found:
        return None
    # Those of the finder are off to one side by 0.015 px.
    criteria = cv2.TERM_CRITERIA_MAX_ITER + cv2.TERM_CRITERIA_EPS, 100, 1e-4
    return cv2.cornerSubPix(image, points, (8, 8), (-1, -1), criteria)


def calibrated(grid, points):
    """Root of the mean squared error in px, the parameters of a perspective lens, and their standard errors."""
    boards, seen = [grid.astype(np.float32)] * len(points), [one.astype(np.float32) for one in points]
    rms, matrix, k, _, _, errors, _, _ = cv2.calibrateCameraExtended(boards, seen, SIZE, np.eye(3), np.zeros(5))
    return rms, np.append(matrix[[0, 1, 0, 1], [0, 1, 2, 2]], k), errors.ravel()[:9]


def calibrated_fisheye(grid, points):
    """The same of a fisheye, whose standard errors OpenCV does not tell: by its Jacobians, of all views at once."""
    boards, seen = [grid] * len(points), [one.astype(np.float64) for one in points]
    flags = cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC | cv2.fisheye.CALIB_FIX_SKEW
    rms, matrix, k, turns, shifts = cv2.fisheye.calibrate(boards, seen, SIZE, np.eye(3), np.zeros((4, 1)), flags=flags)
    rows = []
    for view, (turn, shift) in enumerate(zip(turns, shifts)):
        _, jacobian = cv2.fisheye.projectPoints(grid, turn, shift, matrix, k)
        pose = np.zeros((len(jacobian), 6 * len(points)))
        pose[:, 6 * view : 6 * view + 6] = jacobian[:, 8:14]
        rows.append(np.hstack([jacobian[:, :8], pose]))
    jacobian = np.vstack(rows)
    # The error that OpenCV states is that of points, with two coordinates each.
    squared = rms**2 * len(jacobian) / 2.0 / (len(jacobian) - jacobian.shape[1])
    errors = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))[:8] * squared)
    return rms, np.append(matrix[[0, 1, 0, 1], [0, 1, 2, 2]], k), errors


@pytest.mark.parametrize("lens", LENSES)
def test_opencv_finds_the_lens(board, lens, tmp_path):
    camera = LENSES[lens]
    mission = Mission(poses(), 12.0, camera, image_px=SIZE[0], image_format="png", mesh="rays", upsample=True)
    capture(plan(mission, board.grid), board, tmp_path)
    images = [np.asarray(Image.open(path).convert("L")) for path in sorted(tmp_path.glob("satellite/*.png"))]
    points = [one for one in map(corners_in, images) if one is not None]
    assert len(points) >= VIEWS
    points = points[:VIEWS]
    grid = np.zeros((CORNERS[0] * CORNERS[1], 1, 3))
    grid[:, 0, :2] = np.mgrid[: CORNERS[0], : CORNERS[1]].T.reshape(-1, 2) * SQUARE_M
    tan_x, tan_y = camera.half_tangents
    width, height = SIZE
    # OpenCV's pixels have their centres at whole numbers.
    true = [
        *(width / 2.0 / tan_x, height / 2.0 / tan_y),
        *(width * (0.5 + camera.principal_x) - 0.5, height * (0.5 + camera.principal_y) - 0.5),
    ]
    calibrate = calibrated_fisheye if lens == "fisheye" else calibrated
    rms, found, errors = calibrate(grid, points)
    names = ("k1", "k2", "k3", "k4") if lens == "fisheye" else ("k1", "k2", "p1", "p2", "k3")
    wanted = np.array([*true, *(getattr(camera, name) for name in names)])
    assert rms < 0.1
    assert (np.abs(found - wanted) < SIGMAS * errors).all()
