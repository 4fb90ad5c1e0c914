"""Missions that need other methods than the cheapest: captured, and measured against the 50-digit camera."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.capture.runner import capture
from terrainav.core.geodesy.accuracy import ImageGeometry
from terrainav.core.geodesy.camera import CORNERS
from terrainav.core.geodesy.mercator import v_to_lat
from terrainav.core.geodesy.view import ImageRays, mesh
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.world import WorldSource

from tests.core.geodesy.bounds import map_frame_points, perspective
from tests.core.geodesy.reference import look
from tests.support.thinning import named, thinned

SOURCE = WorldSource()
NORTH_DAKOTA = Box(47.0371, -99.1857, 47.0040, -99.1240)
MISSIONS = {
    "Agricenter at 120 m": (Mission(Box(35.16, -89.90, 35.115, -89.823), 120.0), ["exact", "map"]),
    "tilt 85": (
        Mission(Box(35.16, -89.90, 35.115, -89.823), 120.0, tilt_deg=85.0),
        ["exact", "camera", "mesh"],
    ),
    "North Dakota at 1,200 m": (Mission(NORTH_DAKOTA, 1200.0, error_budget_px=0.1), ["exact", "map"]),
    "16 km": (Mission(Box(40.3, -90.2, 40.0, -89.8), 16e3), ["exact", "camera", "mesh"]),
}


def away_px(worked_out, index, lat, dlon, x, y):
    """Distance in the image, px, at 50 digits; None where the ground point is not seen."""
    camera = worked_out.mission.camera
    pose = [float(values[index]) for values in worked_out.poses.attitude]
    found = look(
        float(worked_out.lat_deg[index]),
        float(worked_out.agl_m[index]),
        camera.fov_deg,
        camera.aspect_ratio,
        *pose,
        lat,
        dlon,
    )
    if found is None:
        return None
    width, height = float(worked_out.frames.width_px[index]), float(worked_out.frames.height_px[index])
    return math.hypot((float(found[0]) - x) * width / 2, (float(found[1]) - y) * height / 2)


def corner_error_px(worked_out, index):
    corners = worked_out.corners
    errors = [
        away_px(worked_out, index, lat, lon - worked_out.lon_deg[index], *corner)
        for lat, lon, hit, corner in zip(corners.lat_deg[index], corners.lon_deg[index], corners.hit[index], CORNERS)
        if hit
    ]
    return max(errors)


def picture_error_px(worked_out, index):
    pose = worked_out.poses.take(np.array([index]))
    if worked_out.frames.on_map:
        lat, dlon, wanted = map_frame_points(worked_out.mission.camera, pose)
        return max(away_px(worked_out, index, a, b, *c) for a, b, c in zip(lat[0], dlon[0], wanted))
    scene = ImageGeometry(worked_out.mission.camera, *worked_out.frames.largest_px, pose)
    cells = mesh(ImageRays.from_scene(scene), worked_out.accuracy.mesh_tolerance_px)
    rng = np.random.default_rng(4)
    which = rng.integers(0, len(cells.box), 60)
    a, b = rng.random((2, 60))
    box = cells.box[which]
    x = (box[:, 0] + a * (box[:, 2] - box[:, 0])) / scene.width_px * 2 - 1
    y = 1 - (box[:, 1] + b * (box[:, 3] - box[:, 1])) / scene.height_px * 2
    du, v = perspective(cells.du[which], cells.v[which], a, b)
    errors = [away_px(worked_out, index, *point) for point in zip(v_to_lat(v), du * 360.0, x, y)]
    return max(error for error in errors if error is not None)


@pytest.mark.parametrize("name", thinned(named(MISSIONS), ("tilt 85", "North Dakota at 1,200 m")))
def test_what_is_chosen_is_captured_and_within_its_bound_at_50_digits(name, tmp_path):
    mission, methods = MISSIONS[name]
    worked_out = plan(mission, SOURCE.grid)
    chosen = worked_out.accuracy
    assert [choice.method.name for choice in chosen.choices] == methods
    assert chosen.bound_px <= 0.1
    assert worked_out.coverage.complete
    for index in (0, len(worked_out) // 2, len(worked_out) - 1):
        error = corner_error_px(worked_out, index) + picture_error_px(worked_out, index)
        assert 0.0 < error <= chosen.bound_px
    result = capture(worked_out, SOURCE, tmp_path / "out", only=[0, len(worked_out) - 1])
    assert result.written == 2
    assert result.failed == ()
