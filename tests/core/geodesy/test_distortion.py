"""Distortion of lenses against OpenCV, and its inverse."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import CORNERS, Camera

WIDTH, HEIGHT = 1280.0, 960.0
PERSPECTIVES = {
    "barrel": Camera(78.8, k1=-0.2, k2=0.05, p1=1e-3, p2=-2e-3, principal_x=0.01, principal_y=-0.02),
    "pincushion": Camera(78.8, k1=0.1, k2=-0.02, k3=0.003),
    "rational": Camera(90.0, k1=0.6, k2=0.1, k3=0.01, k4=0.9, k5=0.2, k6=0.03, p1=1e-4, p2=2e-4),
    "shifted": Camera(60.0, principal_x=0.1, principal_y=0.05),
}
FISHEYES = {
    "equidistant": Camera(150.0, lens="fisheye"),
    "fisheye": Camera(150.0, lens="fisheye", k1=0.01, k2=-0.004, k3=0.001, k4=-2e-4, principal_x=0.01),
    "narrow": Camera(60.0, lens="fisheye", k1=-0.05),
}
CAMERAS = {**PERSPECTIVES, **FISHEYES}


def matrix(camera: Camera) -> np.ndarray:
    """Camera matrix in px."""
    tan_x, tan_y = camera.half_tangents
    return np.array(
        [
            [WIDTH / 2.0 / tan_x, 0.0, WIDTH * (0.5 + camera.principal_x)],
            [0.0, HEIGHT / 2.0 / tan_y, HEIGHT * (0.5 + camera.principal_y)],
            [0.0, 0.0, 1.0],
        ]
    )


def projected(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Pixels (n, 2) of points right, down and ahead of the camera, by OpenCV."""
    cv2 = pytest.importorskip("cv2")
    still = np.zeros(3)
    if camera.lens == "fisheye":
        k = np.array([camera.k1, camera.k2, camera.k3, camera.k4])
        return cv2.fisheye.projectPoints(points[:, np.newaxis], still, still, matrix(camera), k)[0][:, 0]
    names = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
    k = np.array([getattr(camera, name) for name in names])
    return cv2.projectPoints(points, still, still, matrix(camera), k)[0][:, 0]


def image_points(count: int, seed: int = 1) -> np.ndarray:
    corners_and_sides = [*CORNERS, (0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 0.0)]
    return np.concatenate([corners_and_sides, np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 2))])


@pytest.mark.parametrize("name", CAMERAS)
def test_rays_are_projected_to_their_pixels_by_opencv(name):
    camera, points = CAMERAS[name], image_points(5000)
    east, north, up = camera.rays_enu(points).T
    found = projected(camera, np.stack([east, -north, -up], axis=1) * np.linspace(0.5, 90.0, len(east))[:, np.newaxis])
    wanted = (points * (1.0, -1.0) + 1.0) / 2.0 * (WIDTH, HEIGHT)
    assert np.abs(found - wanted).max() < 1e-9


@pytest.mark.parametrize("name", CAMERAS)
def test_image_points_of_rays_are_the_image_points(name):
    camera, points = CAMERAS[name], image_points(5000)
    for attitude in ((0.0, 0.0, 0.0), (30.0, 50.0, -10.0)):
        found, in_front = camera.image_xy(camera.rays_enu(points, *attitude), *attitude)
        assert in_front.all()
        assert np.abs(found - points).max() < 1e-12


@pytest.mark.parametrize("name", CAMERAS)
def test_points_appear_inside_only_where_they_are(name):
    camera = CAMERAS[name]
    vectors = np.random.default_rng(3).normal(size=(20_000, 3))
    # Many beside the border of the image.
    beside = camera.rays_enu(1.2 * image_points(20_000, 4))
    vectors = np.concatenate([vectors, beside])
    excess = camera.side_excess(vectors).max(axis=1)
    found, in_front = camera.image_xy(vectors)
    inside = in_front & (np.abs(found) <= 1.0).all(axis=1)
    assert ((excess <= 0.0) == inside).all()
    # Where the image points are inside, their rays lead where they come from.
    rays = camera.rays_enu(found[inside])
    unit = [one / np.linalg.norm(one, axis=1)[:, np.newaxis] for one in (rays, vectors[inside])]
    assert np.abs(unit[0] - unit[1]).max() < 1e-12
    assert 0.01 < inside.mean() < 0.9


@pytest.mark.parametrize("name", CAMERAS)
def test_excess_is_the_distance_to_the_side(name):
    camera = CAMERAS[name]
    # The direction that is seen a little outside the right edge, in half images.
    for x, side in ((1.001, 0), (-1.001, 1)):
        excess = camera.side_excess(camera.rays_enu(np.array([[x, 0.1]])))[0]
        assert 0.0 < excess[side] <= 0.0011
        assert excess.argmax() == side


@pytest.mark.parametrize("name", CAMERAS)
def test_slopes_are_the_differences_of_image_points(name):
    camera = CAMERAS[name]
    ideal = camera.ideal_xy(0.98 * image_points(200))
    slopes, step = camera.seen_slopes(ideal), 1e-6
    for axis in (0, 1):
        ahead, behind = (camera.seen_xy(ideal + sign * step * np.eye(2)[axis]) for sign in (1.0, -1.0))
        assert np.allclose(slopes[..., axis], (ahead - behind) / (2.0 * step), atol=1e-8)


@pytest.mark.parametrize("seed", range(120))
def test_cameras_at_random_see_inside_only_what_their_rays_lead_to(seed):
    random = np.random.default_rng(seed)
    is_fisheye, size = seed % 3 == 0, 10.0 ** random.uniform(-3.0, 0.0)
    values = {"principal_x": random.uniform(-0.1, 0.1), "principal_y": random.uniform(-0.1, 0.1)}
    if is_fisheye:
        values.update({f"k{at}": random.normal() * size * 0.3**at for at in range(1, 5)}, lens="fisheye")
    else:
        values.update({f"k{at}": random.normal() * size * 0.4 ** (at % 3) for at in range(1, 7)})
        values.update(p1=random.normal() * size * 0.02, p2=random.normal() * size * 0.02)
    try:
        camera = Camera(random.uniform(5.0, 175.0 if is_fisheye else 130.0), random.choice([0.5, 4 / 3, 2.2]), **values)
    except InvalidInput:
        return
    points = image_points(400, seed)
    assert np.abs(camera.image_xy(camera.rays_enu(points))[0] - points).max() < 1e-12
    vectors = np.concatenate([random.normal(size=(1000, 3)), camera.rays_enu(1.05 * points)])
    excess = camera.side_excess(vectors).max(axis=1)
    found, in_front = camera.image_xy(vectors)
    inside = in_front & (np.abs(found) <= 1.0).all(axis=1)
    assert (((excess <= 0.0) == inside) | (np.abs(excess) < 1e-12)).all()
    rays = camera.rays_enu(found[inside])
    unit = [one / np.linalg.norm(one, axis=1)[:, np.newaxis] for one in (rays, vectors[inside])]
    assert np.abs(unit[0] - unit[1]).max() < 1e-9


def test_an_ideal_camera_is_left_as_it_is():
    camera, points = Camera(78.8), image_points(10)
    assert camera.is_ideal
    assert camera.ideal_xy(points) is points
    assert camera.seen_xy(points) is points


def test_a_fisheye_is_wide_by_its_angles():
    camera = Camera(150.0, 4.0 / 3.0, lens="fisheye")
    ray = camera.rays_enu(((1.0, 1.0),))[0]
    assert math.degrees(math.acos(-ray[2] / np.linalg.norm(ray))) == pytest.approx(75.0, abs=1e-12)
    assert camera.horizontal_fov_deg == pytest.approx(150.0 * 0.8)


def folded_radius(k1: float) -> float:
    """Radius in the picture at which r(1 + k1 r^2) is greatest."""
    at = math.sqrt(-1.0 / (3.0 * k1))
    return at * (1.0 + k1 * at * at)


def test_a_fold_inside_the_image_is_refused_with_its_radius():
    with pytest.raises(InvalidInput, match=f"folds the image at {folded_radius(-0.5):.3g} focal lengths") as refused:
        Camera(78.8, k1=-0.5)
    assert refused.value.field == "k1"
    # A fold beyond the corner is none of the image.
    corner = math.tan(math.radians(78.8 / 2.0))
    k1 = -4.0 / 27.0 / (1.001 * corner) ** 2
    assert folded_radius(k1) == pytest.approx(1.001 * corner)
    assert Camera(78.8, k1=k1).distorts
    with pytest.raises(InvalidInput, match="folds the image"):
        Camera(78.8, k1=-4.0 / 27.0 / (0.999 * corner) ** 2)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"k4": 0.9}, "folds the image"),
        ({"fov_deg": 170.0, "lens": "fisheye", "k1": -0.2}, "folds the image"),
        ({"fov_deg": 179.9, "lens": "fisheye", "k1": -0.01}, "more than 89.9 deg off the axis"),
        ({"lens": "fisheye", "p1": 1e-3}, "p1 0.001: a fisheye has k1 to k4 only"),
        ({"lens": "anamorphic"}, "must be one of perspective, fisheye"),
        ({"k1": math.nan}, "distortion k1"),
        ({"principal_x": 0.6}, "principal point"),
    ],
)
def test_impossible_lenses_are_refused_in_one_line(values, message):
    with pytest.raises(InvalidInput, match=message) as refused:
        Camera(**values)
    assert "\n" not in str(refused.value)


def test_colours_are_magnified_about_the_principal_point():
    camera = Camera(78.8, k1=-0.1, principal_x=0.02, red_scale=1e-3, blue_scale=-2e-3)
    vectors = camera.rays_enu(0.9 * image_points(100))
    axis = np.array([2.0 * camera.principal_x, 0.0])
    green = camera.of_colour("green").image_xy(vectors)[0] - axis
    for colour, scale in (("red", 1.001), ("blue", 0.998)):
        found = camera.of_colour(colour).image_xy(vectors)[0] - axis
        assert np.abs(found - scale * green).max() < 1e-12
    assert Camera(78.8).of_colour("red") == Camera(78.8)
    assert camera.splits_colours
    assert not camera.of_colour("red").splits_colours
