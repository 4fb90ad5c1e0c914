"""Frames on request: what a capture of the same pose writes, and what is said of frames that are not ready."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.errors import InvalidInput, PartError
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.local import LocalFrame, geocentric
from terrainav.core.live.camera import FrameRequest
from terrainav.core.live.encoding import encode
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights

from tests.core.live.scenes import HERE, live_camera, mission, random_requests
from tests.support.sources import FailingSource, PatternSource

GROUNDS = {"level": {}, "relief": {"elevation": ("world",)}}
EFFECTS = {"camera": Camera(70.0, 4 / 3, k1=-0.2), "exposure": "time", "exposure_ms": 4.0, "vignetting": "cos4"}


@pytest.mark.parametrize("more", [*GROUNDS.values(), EFFECTS], ids=[*GROUNDS, "effects"])
def test_a_frame_has_the_bytes_that_a_capture_of_its_pose_writes(tmp_path, more):
    camera = live_camera(**more)
    for number, request in enumerate(random_requests(4, 3, products=("depth",))):
        frame = camera.take(request)
        lat, lon, up, yaw, tilt, roll = request[:6]
        single = mission(frame="camera", products=("depth",), **more).replace(
            area=Points(((lat, lon, up),), yaws_deg=(yaw,), tilts_deg=(tilt,), rolls_deg=(roll,))
        )
        folder = tmp_path / str(number)
        capture(plan(single, camera.source.grid, mission_heights(single)), camera.source, folder)
        for image, name in (("picture", "satellite"), ("depth", "depth")):
            (written,) = (folder / name).glob("*.tif")
            assert encode(frame, image, "tif") == written.read_bytes()
        assert frame.request is request
        assert frame.coarse_share == 0.0


@pytest.mark.parametrize("more", GROUNDS.values(), ids=GROUNDS)
def test_depth_pose_and_contract_lead_to_the_ground_points(more):
    """The points are found by the contract alone: intrinsics, axes of the attitude, and depth along the view."""
    camera = live_camera(image_px=640, **more)
    for request in random_requests(4, 8, most_tilt=60.0, products=("depth", "points")):
        frame = camera.take(request)
        depth, points = frame.products["depth"][..., 0].astype(float), frame.products["points"]
        contract = frame.contract
        x, y = np.meshgrid(np.arange(contract.width_px) + 0.5, np.arange(contract.height_px) + 0.5)
        rays = np.stack([(x - contract.cx_px) / contract.fx_px, (y - contract.cy_px) / contract.fy_px, np.ones_like(x)])
        yaw, tilt, roll = np.radians(request[3:6])
        east, north, up = np.eye(3)
        # As the contract puts it: yaw turns the top clockwise, tilt raises the view to the top, roll puts right down.
        top, right, view = np.cos(yaw) * north + np.sin(yaw) * east, np.cos(yaw) * east - np.sin(yaw) * north, -up
        top, view = np.cos(tilt) * top + np.sin(tilt) * up, np.cos(tilt) * view + np.sin(tilt) * top
        right, view = np.cos(roll) * right + np.sin(roll) * view, np.cos(roll) * view - np.sin(roll) * right
        enu = np.einsum("ik,khw->hwi", np.stack([right, -top, view], axis=1), rays * depth)
        here = LocalFrame(request.lat_deg, request.lon_deg, frame.height_m)
        stated = here.enu(points[..., 1], points[..., 0], points[..., 2])
        pixel_m = depth / contract.fx_px
        assert np.isfinite(depth).mean() > 0.9
        off_px = np.linalg.norm(enu - stated, axis=-1) / pixel_m
        assert np.nanmax(off_px) < 1e-3


def test_points_of_pixels_lie_apart_as_the_earth_is_round():
    # Guards the test above against frames that are one and the same.
    here = geocentric(np.array(HERE[0]), np.array(HERE[1]), np.array(0.0))
    there = geocentric(np.array(HERE[0] + 0.01), np.array(HERE[1]), np.array(0.0))
    assert 1100.0 < float(np.linalg.norm(here - there)) < 1120.0


def test_a_frame_at_a_height_over_the_ellipsoid_is_that_of_the_height_over_ground():
    for more in ({"elevation": ("world",)}, {"ground_height_m": 500.0}):
        camera = live_camera(**more)
        request = random_requests(1, 4)[0]
        above_ground = camera.take(request)
        absolute = camera.take(request._replace(up_m=above_ground.height_m, above_ellipsoid=True))
        assert absolute.height_m == pytest.approx(above_ground.height_m, abs=1e-9)
        same = (absolute.picture == above_ground.picture).all(axis=-1).mean()
        assert same > 0.99


class HeldSource(PatternSource):
    """Tiles that arrive when they are let go; those of coarse zooms at once."""

    def __init__(self, coarsest):
        super().__init__(map_types=("satellite",))
        self.coarsest, self.held = coarsest, threading.Event()

    def paint(self, map_type, part):
        if part.zoom > self.coarsest:
            assert self.held.wait(30.0)
        # Every pixel of a zoom differs from those of others.
        return np.random.default_rng(abs(hash(part))).integers(0, 256, (part.height_px, part.width_px, 3), np.uint8)


@pytest.mark.parametrize("more", GROUNDS.values(), ids=GROUNDS)
def test_late_tiles_are_stood_in_for_by_coarser_ones_and_the_share_is_stated(more):
    source = HeldSource(coarsest=99)
    camera = live_camera(source, source="https://tile.example/{z}/{x}/{y}.png", tilt_deg=40.0, **more)
    request = random_requests(1, 5)[0]
    low = request._replace(up_m=4.0 * request.up_m, tilt_deg=0.0)
    camera.take(low)
    source.coarsest = max(part.window.zoom for part in camera.prepare(low).parts)
    late = camera.take(request, wait_s=0.0)
    source.held.set()
    whole = camera.take(request)
    assert whole.coarse_share == 0.0
    differs = (late.picture != whole.picture).any(axis=-1).mean()
    assert late.coarse_share > 0.3
    # Pixels of noise are alike by chance in one of 16 million.
    assert late.coarse_share == pytest.approx(differs, abs=1e-3)
    camera.tiles.close()


def test_a_tile_that_fails_fails_its_frame_and_is_asked_for_again():
    request = random_requests(1, 5)[0]
    known = PatternSource(map_types=("satellite",))
    live_camera(known).take(request)
    source = FailingSource({part: PartError("tile: is missing") for _, part in known.fetched})
    camera = live_camera(source)
    with pytest.raises(PartError):
        camera.take(request)
    source.errors.clear()
    assert camera.take(request).coarse_share == 0.0


def test_tiles_are_fetched_once_and_dropped_by_use():
    source = PatternSource(map_types=("satellite",))
    camera = live_camera(source)
    request = random_requests(1, 5)[0]
    first = camera.take(request)
    camera.take(request)
    assert set(source.fetched.values()) == {1}
    camera.tiles._most_bytes = 256 * 256 * 3
    camera.take(random_requests(1, 6)[0])
    again = camera.take(request)
    assert np.array_equal(first.picture, again.picture)
    assert max(source.fetched.values()) > 1


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"tilt_deg": 400.0}, "tilt"),
        ({"up_m": -3.0}, "height"),
        ({"lat_deg": 95.0}, "latitude"),
        ({"lat_deg": float("nan")}, "latitude"),
        ({"products": ("colour",)}, "colour"),
        ({"tilt_deg": 170.0}, "Earth"),
    ],
)
def test_a_pose_that_is_nonsense_is_refused_in_one_line(changes, text):
    camera = live_camera()
    with pytest.raises(InvalidInput) as wrong:
        camera.take(FrameRequest(*HERE, 100.0)._replace(**changes))
    assert text in str(wrong.value)
    assert "\n" not in str(wrong.value)


def test_map_frames_are_refused():
    with pytest.raises(InvalidInput, match="perspectives"):
        live_camera(frame="map")
