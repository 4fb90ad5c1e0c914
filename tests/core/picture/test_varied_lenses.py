"""Lenses that vary from image to image: each image is that of a mission with its camera alone, at the same pose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from terrainav.core.geodesy.camera import Camera
from terrainav.core.imagery.opening import named_source
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.outlines import footprints_deg
from terrainav.core.mission.plan import plan
from terrainav.core.picture.heights import mission_heights
from terrainav.core.picture.optics import plan_optics
from terrainav.core.picture.products import sighting
from terrainav.core.picture.shot import draw, make_shot, picture_parts

SOURCE = named_source("world")
#: Level, tilted, and turned in all ways; the last sees the horizon.
PLACES = ((35.16, -89.9, 120.0), (35.1605, -89.9004, 150.0), (35.161, -89.899, 200.0), (35.159, -89.8995, 130.0))
YAWS, TILTS, ROLLS = (0.0, 30.0, 200.0, 90.0), (0.0, 25.0, 40.0, 75.0), (0.0, 0.0, -10.0, 5.0)
AREA = Points(PLACES, YAWS, TILTS, ROLLS)
#: A millionth of a metre, in degrees: footprints of several captures are rounded otherwise than those of one.
ROUNDING_DEG = 1e-11
LENSES = {
    "brown": (
        Camera(60.0, k1=-0.1),
        (
            *("k1=uniform(-0.15,0.1)", "k2=uniform(0,0.05)", "p1=normal(0,0.002)within(-0.005,0.005)"),
            *("principal_x=uniform(-0.04,0.04)", "principal_y=uniform(-0.04,0.04)", "fov_deg=uniform(55,80)"),
        ),
    ),
    "from an ideal one": (Camera(70.0), ("k1=choice(-0.2,0.1,0)",)),
    "zoom": (Camera(70.0), ("fov_deg=loguniform(40,90)",)),
    "fisheye": (Camera(120.0, lens="fisheye"), ("k1=uniform(-0.02,0.04)", "fov_deg=uniform(100,140)")),
    "colours": (Camera(70.0, k1=-0.05), ("red_scale=uniform(-0.01,0)", "blue_scale=uniform(0.002,0.01)")),
}


def planned(camera, area=AREA, **values):
    values = {"image_px": 96, "mesh": "rays", "frame": "camera", **values}
    mission = Mission(area, 120.0, camera, **values)
    return plan(mission, SOURCE.grid, mission_heights(mission) if mission.terrain.elevation else None)


def picture(made, index, source):
    parts = picture_parts(made, source, index)
    pixels = {part.window: source.fetch("satellite", part.window) for part in parts}
    return draw(make_shot(made, index), parts, pixels, masked=True).pixels


@pytest.mark.parametrize("elevation", [(), ("world",)], ids=["level", "relief"])
@pytest.mark.parametrize("lens", LENSES)
def test_an_image_is_that_of_its_camera_alone(lens, elevation):
    camera, texts = LENSES[lens]
    # Relief up to the horizon takes long.
    area = Points(*(values[:3] for values in (PLACES, YAWS, TILTS, ROLLS))) if elevation else AREA
    given = {"elevation": elevation, "image_px": 64 if elevation else 96, "area": area}
    made, source = planned(camera, vary=texts, **given), SOURCE.open()
    cameras = [made.camera(index) for index in range(len(made))]
    assert len(set(cameras)) > 1
    for index, own in enumerate(cameras):
        alone = planned(own, **given)
        if elevation:
            # The more relief lenses may see, the coarser is that by which heights are planned: take the same pose.
            np.testing.assert_allclose(alone.height_m, made.height_m, rtol=0.0, atol=0.1)
            corners = made.relief.corners(own, made.poses, made.height_m)
            alone = replace(alone, relief=made.relief, poses=made.poses, flown=made.flown, corners=corners)
        assert made.settings(index).camera == own
        # The zoom in names is that of the mission's camera; centres on relief are rounded.
        assert elevation or made.names[index].rpartition("_")[0] == alone.names[index].rpartition("_")[0]
        assert picture(made, index, source).tobytes() == picture(alone, index, source).tobytes()
        for one, other in zip(made.corners, alone.corners):
            np.testing.assert_allclose(one[index], other[index], rtol=0.0, atol=ROUNDING_DEG)
        for one, other in zip(made.windows, alone.windows):
            # Over relief, the ground counts as being as high as the widest lens may see it.
            assert elevation or made.zoom != alone.zoom or one[index] == other[index]
        one, other = made.views.outline(index), alone.views.outline(index)
        for name in ("lat_deg", "dlon_deg", "horizon", "image_xy"):
            np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=0.0, atol=ROUNDING_DEG)
        part = slice(index, index + 1)
        for rings in zip(*(footprints_deg(one, part) for one in (made, alone))):
            np.testing.assert_allclose(*rings, rtol=0.0, atol=ROUNDING_DEG)
        assert made.views.box(index) == alone.views.box(index)
        at = np.array([index])
        np.testing.assert_array_equal(np.stack(plan_optics(made, at)), np.stack(plan_optics(alone, at)))
        size = made.views.size_px(index)
        for one, other in zip(sighting(made, index, size), sighting(alone, index, size)):
            np.testing.assert_array_equal(one, other)
