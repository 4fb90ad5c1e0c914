"""Pixels that average what they cover of a fine pattern on a ramp, against the mean of dense rays."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.mercator import PixelGrid, lat_to_v, lon_to_u
from terrainav.core.geodesy.raytracing.surface import Surface
from terrainav.core.mission.areas.area import Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.mission.relief.ground import Heights

from tests.core.picture.zone_plate import GRID, LAT, LON, ZonePlate

#: Pixels of a side of the fine image in each pixel, in which its rays are even enough.
FINE = 16
#: Zoom of the cells, and how many there are north, south, and to either side of the camera.
ZOOM, NORTH, SOUTH, ASIDE = 16, 380, 100, 400


class Ramp:
    """Ground that rises by an eighth towards the north up to 740 m away, with waves that hide nothing."""

    title = attribution = ""

    def __init__(self):
        grid, self.size_m = PixelGrid(), 1.95
        world = grid.world_px(ZOOM)
        left, top = (int(float(of(np.array(at))) * world) for of, at in ((lon_to_u, LON), (lat_to_v, LAT)))
        east, north = np.meshgrid(np.arange(-ASIDE, ASIDE), np.arange(NORTH, -SOUTH, -1))
        heights = 100.0 + north * self.size_m / 8.0 + np.sin(east / 30.0) * np.cos(north / 40.0)
        self._surface = Surface(grid, ZOOM, left - ASIDE, top - NORTH, heights.astype(np.float32))

    def surface(self, *_):
        return self._surface

    def cell_m(self, *_):
        return self.size_m

    def end_m(self, *_):
        return np.inf


RAMP = Ramp()


def planned(image_px, sampling, **attitude):
    mission = Mission(
        Points(((LAT, LON, 120.0),)), 120.0, frame="camera", image_px=image_px, sampling=sampling,
        elevation=("100",), **attitude,
    )  # fmt: skip
    return plan(mission, GRID, Heights(RAMP, RAMP))


def truth(plate, image_px, **attitude):
    """Means over the pixels of what many rays through each see, (h, w); NaN where one sees no ground."""
    fine = planned(FINE * image_px, "zoom", **attitude)
    seen = fine.views.tracing(0).sighting
    light = plate.light(lon_to_u(seen.lon_deg), lat_to_v(seen.lat_deg))
    height, width = light.shape
    return light.reshape(height // FINE, FINE, width // FINE, FINE).mean(axis=(1, 3))


@pytest.mark.parametrize("attitude", [{"tilt_deg": 75.0}, {"tilt_deg": 75.0, "yaw_deg": 25.0}], ids=["ahead", "turned"])
def test_a_fine_pattern_on_a_ramp_has_under_a_hundredth_of_the_aliases_of_interpolation(attitude):
    plate = ZonePlate(1.0 / 4_000.0, 450.0)
    wanted = truth(plate, 64, **attitude)
    shown = np.isfinite(wanted)
    assert shown.mean() > 0.5
    off = {
        sampling: float(((plate.picture(planned(64, sampling, **attitude)) - wanted)[shown] ** 2).sum())
        for sampling in ("zoom", "area")
    }
    assert off["area"] < 0.01 * off["zoom"], off
