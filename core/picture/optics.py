"""The camera of a picture: its optics in px and mm, its height, and the time of exposure.

Focal length and principal point in px follow from the plan. Millimetres need a sensor: that of the data sheet for
cameras that ship with the program, else a sensor with a longer side of `NOMINAL_SENSOR_MM`. The pixel size follows from
the focal length, so that mm and px give the same field of view.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..geodesy.camera import Camera
from ..geodesy.contract import PIXEL_DECIMALS, CameraContract
from ..geodesy.frames import in_image, swapped
from ..mission.cameras import shipped_cameras
from ..mission.parts import BY_ISO, BY_TIME, utc_time
from ..mission.plan import Plan

#: Longer side of the sensor of cameras that are known by field of view only: that of 35 mm film.
NOMINAL_SENSOR_MM = 36.0
#: Finest accuracy stated, that of RTK positioning: readers take 0 for unknown.
FINEST_ACCURACY_M = 0.01


class Body(NamedTuple):
    """A camera's model, its focal length in mm, and the kind of its lens: perspective or fisheye."""

    model: str
    focal_length_mm: float
    lens: str


@lru_cache(maxsize=8)
def camera_body(camera: Camera) -> Body:
    """Body of a mission's camera, with "(simulated)" in its model.

    Only shipped cameras are looked up, so that a mission writes the same files everywhere.
    """
    focal_length_mm = NOMINAL_SENSOR_MM / (2.0 * max(camera.half_tangents))
    for preset in shipped_cameras():
        known = ((preset.camera.fov_deg, camera.fov_deg), (preset.camera.aspect_ratio, camera.aspect_ratio))
        # Compare all but rounding.
        if all(math.isclose(one, other, rel_tol=1e-9) for one, other in known):
            return Body(f"{preset.name} (simulated)", preset.focal_length_mm or focal_length_mm, camera.lens)
    model = f"FOV {camera.fov_deg:.6g} deg, {camera.aspect_ratio:.6g} to 1 (simulated)"
    return Body(model, focal_length_mm, camera.lens)


class Optics(NamedTuple):
    """Pinhole cameras of pictures as written, arrays (n,) in px.

    Focal lengths along rows and columns differ where pixels of the map are not square on the ground (by up to 0.7 % in
    Web Mercator) or pictures are resized to another shape. The principal point counts from the upper left corner; in a
    map frame, whose edges are rounded to pixels, it is up to about a pixel off the centre.
    """

    width_px: Floats
    height_px: Floats
    focal_x_px: Floats
    focal_y_px: Floats
    centre_x_px: Floats
    centre_y_px: Floats

    def accuracy_m(self, agl_m: Floats) -> tuple[Floats, Floats]:
        """Position errors, horizontal and vertical, that readers with one focal length and a centred axis would see."""
        off_x = (self.centre_x_px - self.width_px / 2.0) / self.focal_x_px
        off_y = (self.centre_y_px - self.height_px / 2.0) / self.focal_y_px
        unequal = np.abs(self.focal_x_px - self.focal_y_px) / (self.focal_x_px + self.focal_y_px)
        across, in_height = agl_m * np.hypot(off_x, off_y), agl_m * unequal
        return FINEST_ACCURACY_M + across, FINEST_ACCURACY_M + in_height


def planned_optics(plan: Plan, at: NDArray[np.int64]) -> Optics:
    """Optics of some of a plan's pictures, by index (k,), before they are resized."""
    width, height = (np.asarray(size[at], np.float64) for size in (plan.frames.width_px, plan.frames.height_px))
    if plan.frames.on_map:
        pinhole = _map_frames(plan, at)
    else:
        tan_x, tan_y, right, down = plan.cameras[at].each(
            lambda camera: (*camera.half_tangents, camera.principal_x, camera.principal_y)
        )
        centre = width * (0.5 + right), height * (0.5 + down)
        pinhole = (width / (2.0 * tan_x), height / (2.0 * tan_y), *centre)
    return Optics(width, height, *pinhole)


def plan_optics(plan: Plan, at: NDArray[np.int64]) -> Optics:
    """Optics of some of a plan's pictures as written, by index (k,)."""
    planned = planned_optics(plan, at)
    if plan.mission.output.img_size is None:
        return planned
    width, height, focal_x, focal_y, centre_x, centre_y = planned
    wide, high = (np.full(len(at), float(size)) for size in plan.mission.output.img_size[:2])
    x, y = wide / width, high / height
    return Optics(wide, high, focal_x * x, focal_y * y, centre_x * x, centre_y * y)


def plan_contract(plan: Plan, index: int) -> CameraContract:
    """Contract of a plan's picture as written."""
    width, height, fx, fy, cx, cy = (float(values[0]) for values in plan_optics(plan, np.array([index])))
    return CameraContract.of_lens(plan.camera(index), (int(width), int(height)), (fx, fy), (cx, cy)).rounded


def shared_contract(plan: Plan) -> CameraContract | None:
    """Contract of a plan's pictures; None if they have several."""
    stated = np.round(plan_optics(plan, np.arange(len(plan))), PIXEL_DECIMALS)
    if len(plan.cameras.distinct) > 1 or (stated != stated[:, :1]).any():
        return None
    return plan_contract(plan, 0)


def _map_frames(plan: Plan, at: NDArray[np.int64]) -> tuple[Floats, Floats, Floats, Floats]:
    """Focal lengths and principal points of nadir cameras that see map frames."""
    focal_x, focal_y, x, y = _windows(plan, at)
    if plan.frames.is_north_up:
        return focal_x, focal_y, x, y
    turns = plan.frames.quarter_turns[at]
    wide, high = (np.asarray(size[at], np.float64) for size in plan.windows[2:])
    column, row = in_image(turns, x / wide, y / high)
    width, height = swapped(turns, wide, high)
    return (*swapped(turns, focal_x, focal_y), column * width, row * height)


def _windows(plan: Plan, at: NDArray[np.int64]) -> tuple[Floats, Floats, Floats, Floats]:
    """Focal lengths and principal points along the axes of the map, from the windows' upper left corners."""
    world_px, plane = float(plan.grid.world_px(plan.zoom)), plan.grid.plane
    lat, lon = plan.lat_deg[at], plan.lon_deg[at]
    u, v = plane.forward(lat, lon)
    left, top = (np.asarray(values[at], np.float64) for values in plan.windows[:2])
    focal_x, focal_y = plane.focal_px(lat, lon, plan.agl_m[at], plan.ground, world_px)
    # A camera and its window may lie on different sides of the antimeridian.
    return focal_x, focal_y, plane.nearest_px(u * world_px - left, world_px), v * world_px - top


class CameraSettings(NamedTuple):
    """Settings of a camera for one image; None where they are not stated."""

    exposure_ms: float | None = None
    f_number: float | None = None
    iso: float | None = None
    white_balance_k: float | None = None
    is_automatic: bool = False

    @classmethod
    def of_facts(cls, facts: Mapping[str, float | str]) -> CameraSettings:
        """Settings among what is stated of an image."""
        stated = {name: float(facts[name]) for name in cls._fields[:-1] if name in facts}
        return cls(**stated, is_automatic=facts.get("exposure") in (BY_TIME, BY_ISO))


@dataclass(frozen=True)
class Exposure:
    """Camera data for a picture's tags, besides the pose.

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
    settings : CameraSettings
        Settings of the camera, of what is stated.
    """

    body: Body
    size_px: tuple[int, int]
    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    altitude_m: float
    accuracy_m: tuple[float, float]
    taken: datetime | None
    settings: CameraSettings = field(default_factory=CameraSettings)

    def through_lens(self, plan: Plan, index: int) -> Exposure:
        """The same exposure with the optics of another plan of the captures."""
        (row,) = _optics_rows(plan, np.array([index]))
        return replace(self, body=camera_body(plan.camera(index)), **_optics_of_row(row))


def _optics_rows(plan: Plan, at: NDArray[np.int64]) -> Floats:
    """Optics and accuracies of a plan's pictures as written, (k, 8)."""
    optics = plan_optics(plan, at)
    return np.stack([*optics, *optics.accuracy_m(plan.agl_m[at])], axis=1)


def _optics_of_row(row: Floats) -> dict[str, Any]:
    """Fields of an `Exposure` in a row of `_optics_rows`."""
    width, height, focal_x, focal_y, centre_x, centre_y, *accuracy = row.tolist()
    return {
        "size_px": (int(width), int(height)),
        "focal_px": (focal_x, focal_y),
        "centre_px": (centre_x, centre_y),
        "accuracy_m": tuple(accuracy),
    }


class Exposures:
    """Exposures of a plan's captures."""

    def __init__(self, plan: Plan) -> None:
        self._columns = _optics_rows(plan, np.arange(len(plan)))
        self._cameras = plan.cameras
        self._height_m, self._start, self._times_s = (
            plan.height_m,
            utc_time(plan.direct.start),
            plan.times_s,
        )

    def take(self, which: NDArray[np.int64]) -> Exposures:
        """Exposures of some captures, by index."""
        part = copy(self)
        for name in ("_columns", "_cameras", "_height_m", "_times_s"):
            setattr(part, name, getattr(self, name)[which])
        return part

    def exposure(self, index: int) -> Exposure:
        """Exposure of one capture."""
        return Exposure(
            camera_body(self._cameras.of(index)),
            altitude_m=self._height_m[index].item(),
            taken=self._taken(index),
            **_optics_of_row(self._columns[index]),
        )

    def _taken(self, index: int) -> datetime | None:
        try:
            return self._start + timedelta(seconds=self._times_s[index].item())
        except OverflowError:
            return None
