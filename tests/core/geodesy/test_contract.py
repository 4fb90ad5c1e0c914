"""The camera contract: each program's form projects as OpenCV does."""

from __future__ import annotations

import json

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.contract import CameraContract

cv2 = pytest.importorskip("cv2")

LENSES = {
    "ideal": Camera(70.0, 4 / 3),
    "brown": Camera(70.0, 4 / 3, k1=-0.2, k2=0.05, p1=1e-3, p2=-5e-4, k3=0.01, principal_x=0.02),
    "rational": Camera(70.0, 4 / 3, k1=0.3, k2=0.05, k4=0.5, k5=0.02),
    "fisheye": Camera(120.0, 4 / 3, "fisheye", k1=0.02, k2=-0.003),
}
SIZE, FOCAL, CENTRE = (640, 480), (500.0, 501.0), (330.25, 241.5)


def contract_of(name):
    return CameraContract.of_lens(LENSES[name], SIZE, FOCAL, CENTRE)


def rays():
    rng = np.random.default_rng(4)
    return np.column_stack([rng.uniform(-0.5, 0.5, (50, 2)), np.ones(50)])


def opencv_px(contract):
    """Positions in px with (0.5, 0.5) in the centre of the first pixel, by OpenCV's own projection."""
    points, still = rays().reshape(-1, 1, 3), np.zeros(3)
    if contract.lens == "fisheye":
        found, _ = cv2.fisheye.projectPoints(points, still, still, contract.k, np.array(contract.coefficients))
    else:
        found, _ = cv2.projectPoints(points, still, still, contract.k, np.array(contract.coefficients or [0.0] * 4))
    return found.reshape(-1, 2) + 0.5


def colmap_px(contract):
    """COLMAP's projections, written down from its documentation of camera models."""
    model, (fx, fy, cx, cy, *k) = contract.colmap
    u, v = rays()[:, 0], rays()[:, 1]
    if model == "OPENCV_FISHEYE":
        r = np.hypot(u, v)
        angle = np.arctan(r)
        scale = angle * (1 + sum(one * angle ** (2 * at) for at, one in enumerate(k, 1))) / r
        return np.column_stack([fx * u * scale + cx, fy * v * scale + cy])
    k1, k2, p1, p2, k3, k4, k5, k6 = (*k, *[0.0] * (8 - len(k)))
    r2 = u * u + v * v
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    x = u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)
    y = v * radial + 2 * p2 * u * v + p1 * (r2 + 2 * v * v)
    return np.column_stack([fx * x + cx, fy * y + cy])


@pytest.mark.parametrize("name", LENSES)
def test_opencv_colmap_and_our_camera_project_alike(name):
    contract = contract_of(name)
    expected = opencv_px(contract)
    np.testing.assert_allclose(colmap_px(contract), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "model"),
    [("ideal", "PINHOLE"), ("brown", "FULL_OPENCV"), ("rational", "FULL_OPENCV"), ("fisheye", "OPENCV_FISHEYE")],
)
def test_colmap_has_the_simplest_model(name, model):
    assert contract_of(name).colmap[0] == model


@pytest.mark.parametrize(
    ("name", "model", "count"),
    [
        ("ideal", "plumb_bob", 5),
        ("brown", "plumb_bob", 5),
        ("rational", "rational_polynomial", 8),
        ("fisheye", "equidistant", 4),
    ],
)
def test_ros_has_opencvs_numbers(name, model, count):
    contract = contract_of(name)
    ros = contract.ros
    assert (ros["distortion_model"], len(ros["d"])) == (model, count)
    assert ros["k"] == [500.0, 0.0, 329.75, 0.0, 501.0, 241.0, 0.0, 0.0, 1.0]
    assert ros["p"] == [500.0, 0.0, 329.75, 0.0, 0.0, 501.0, 241.0, 0.0, 0.0, 0.0, 1.0, 0.0]
    assert list(contract.coefficients[:count]) == ros["d"][: len(contract.coefficients)]


def test_nerfstudio_has_no_rational_lens():
    assert contract_of("brown").nerfstudio["camera_model"] == "OPENCV"
    assert contract_of("fisheye").nerfstudio["camera_model"] == "OPENCV_FISHEYE"
    with pytest.raises(InvalidInput, match=r"k4 0\.5"):
        _ = contract_of("rational").nerfstudio


@pytest.mark.parametrize("name", LENSES)
def test_json_is_read_back(name):
    contract = contract_of(name)
    assert CameraContract.from_json(json.loads(json.dumps(contract.to_json()))) == contract


@pytest.mark.parametrize("change", [{"schema": 2}, {"fx_px": None}, {"distortion": [1]}, {"width_px": "wide"}])
def test_other_json_is_refused_in_one_line(change):
    with pytest.raises(InvalidInput, match="camera contract"):
        CameraContract.from_json({**contract_of("brown").to_json(), **change})
