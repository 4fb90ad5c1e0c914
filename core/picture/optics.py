"""The camera of a picture when it was taken: its optics in px and mm, its height, and the time.

The pinhole of a picture as it is written, its focal length and principal point in px, follows from the plan.
Millimetres need a sensor: that of the data sheet where the mission's camera is one of those that ship, else one whose
longer side is `NOMINAL_SENSOR_MM`. The pixels are as large as the focal length says they are, so that both give the
picture's own field of view.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass
from datetime import datetime, timedelta
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..geodesy.camera import Camera
from ..geodesy.frames import in_image, swapped
from ..mission.cameras import shipped_cameras
from ..mission.parts import utc_time
from ..mission.plan import Plan

#: Longer side of the sensor of cameras that are known by their field of view alone: that of 35 mm film.
NOMINAL_SENSOR_MM = 36.0
#: Least accuracy that is stated, as good as satellites give it to a drone (RTK): readers take 0 for unknown.
FINEST_ACCURACY_M = 0.01
#: Two cameras are the same where the field of view and the shape of the picture agree to the last digits.
_SAME = 1e-9


class Body(NamedTuple):
    """A camera's model, and its focal length in mm."""

    model: str
    focal_length_mm: float


@lru_cache(maxsize=8)
def camera_body(camera: Camera) -> Body:
    """Body of a mission's camera; the model says that it is simulated.

    The user's own cameras are not looked at: the same mission gives the same files everywhere.
    """
    focal_length_mm = NOMINAL_SENSOR_MM / (2.0 * max(camera.half_tangents))
    for preset in shipped_cameras():
        own = preset.camera
        if math.isclose(own.fov_deg, camera.fov_deg, rel_tol=_SAME) and math.isclose(
            own.aspect_ratio, camera.aspect_ratio, rel_tol=_SAME
        ):
            return Body(f"{preset.name} (simulated)", preset.focal_length_mm or focal_length_mm)
    return Body(f"FOV {camera.fov_deg:.6g} deg, {camera.aspect_ratio:.6g} to 1 (simulated)", focal_length_mm)


class Optics(NamedTuple):
    """Pinholes of pictures as they are written, arrays (n,) in px.

    The focal lengths along a row and a column of the picture differ where the map's pixels are not square on the ground
    (by up to 0.7 % in Web Mercator) or where pictures are resized to another shape. The principal point counts from the
    upper left corner; in a map frame, whose edges lie on whole pixels, it is up to about a pixel off the middle.
    """

    width_px: Floats
    height_px: Floats
    focal_x_px: Floats
    focal_y_px: Floats
    centre_x_px: Floats
    centre_y_px: Floats

    def accuracy_m(self, agl_m: Floats) -> tuple[Floats, Floats]:
        """How far off a camera seems, across and in height, to readers that know but one focal length and the middle.

        The poses themselves are exact.
        """
        off_x = (self.centre_x_px - self.width_px / 2.0) / self.focal_x_px
        off_y = (self.centre_y_px - self.height_px / 2.0) / self.focal_y_px
        unequal = np.abs(self.focal_x_px - self.focal_y_px) / (self.focal_x_px + self.focal_y_px)
        across, in_height = agl_m * np.hypot(off_x, off_y), agl_m * unequal
        return FINEST_ACCURACY_M + across, FINEST_ACCURACY_M + in_height


def plan_optics(plan: Plan, at: NDArray[np.int64]) -> Optics:
    """Optics of some of a plan's pictures, by their indices (k,)."""
    width, height = (np.asarray(size[at], np.float64) for size in (plan.frames.width_px, plan.frames.height_px))
    if plan.frames.on_map:
        pinhole = _map_frames(plan, at)
    else:
        tan_x, tan_y = plan.mission.camera.half_tangents
        pinhole = (width / (2.0 * tan_x), height / (2.0 * tan_y), width / 2.0, height / 2.0)
    focal_x, focal_y, centre_x, centre_y = pinhole
    if plan.mission.output.img_size is None:
        return Optics(width, height, focal_x, focal_y, centre_x, centre_y)
    wide, high = (np.full(len(at), float(size)) for size in plan.mission.output.img_size[:2])
    x, y = wide / width, high / height
    return Optics(wide, high, focal_x * x, focal_y * y, centre_x * x, centre_y * y)


def _map_frames(plan: Plan, at: NDArray[np.int64]) -> tuple[Floats, Floats, Floats, Floats]:
    """Focal lengths and principal point of the camera that looks straight down and sees a map frame."""
    focal_x, focal_y, x, y = _windows(plan, at)
    if plan.frames.is_north_up:
        return focal_x, focal_y, x, y
    turns = plan.frames.quarter_turns[at]
    wide, high = (np.asarray(size[at], np.float64) for size in plan.windows[2:])
    column, row = in_image(turns, x / wide, y / high)
    width, height = swapped(turns, wide, high)
    return (*swapped(turns, focal_x, focal_y), column * width, row * height)


def _windows(plan: Plan, at: NDArray[np.int64]) -> tuple[Floats, Floats, Floats, Floats]:
    """The same along the axes of the map, from the upper left corner of the windows."""
    world_px, plane = float(plan.grid.world_px(plan.zoom)), plan.grid.plane
    lat, lon = plan.lat_deg[at], plan.lon_deg[at]
    u, v = plane.forward(lat, lon)
    left, top = (np.asarray(values[at], np.float64) for values in plan.windows[:2])
    focal_x, focal_y = plane.focal_px(lat, lon, plan.agl_m[at], plan.ground, world_px)
    # A camera and its window may lie on different sides of the antimeridian.
    return focal_x, focal_y, plane.nearest_px(u * world_px - left, world_px), v * world_px - top


@dataclass(frozen=True)
class Exposure:
    """Data of the camera in a picture's tags, beyond the pose.

    Parameters
    ----------
    size_px : (width, height)
    focal_px : (x, y)
        Focal lengths, along a row and a column.
    centre_px : (x, y)
        Principal point from the upper left corner.
    altitude_m : float
        Height over the WGS84 ellipsoid.
    accuracy_m : (across, in height)
        As in `Optics.accuracy_m`.
    taken : datetime or None
        In UTC; None beyond the year 9999.
    """

    body: Body
    size_px: tuple[int, int]
    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    altitude_m: float
    accuracy_m: tuple[float, float]
    taken: datetime | None


class Exposures:
    """Exposures of a plan's captures; what they have in common is worked out once."""

    def __init__(self, plan: Plan) -> None:
        optics = plan_optics(plan, np.arange(len(plan)))
        self._columns = np.stack([*optics, *optics.accuracy_m(plan.agl_m)], axis=1)
        self._body = camera_body(plan.mission.camera)
        self._height_m, self._start, self._times_s = (
            plan.height_m,
            utc_time(plan.direct.start),
            plan.times_s,
        )

    def part(self, which: NDArray[np.int64]) -> Exposures:
        """Those of some captures alone, by their indices."""
        part = copy(self)
        for name in ("_columns", "_height_m", "_times_s"):
            setattr(part, name, getattr(self, name)[which])
        return part

    def at(self, index: int) -> Exposure:
        """Exposure of one capture."""
        width, height, focal_x, focal_y, centre_x, centre_y, *accuracy = self._columns[index].tolist()
        return Exposure(
            self._body,
            (int(width), int(height)),
            (focal_x, focal_y),
            (centre_x, centre_y),
            self._height_m[index].item(),
            (accuracy[0], accuracy[1]),
            self._taken(index),
        )

    def _taken(self, index: int) -> datetime | None:
        try:
            return self._start + timedelta(seconds=self._times_s[index].item())
        except OverflowError:
            return None
