"""When and from where the rows of a picture are exposed: strips of rows (rolling shutter), instants (motion blur)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Union

import numpy as np

from ..arrays import Floats
from ..camera.shutter import instant_count, instants_s, strips
from ..errors import Message
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import sight_lines, trace
from .flight.rates import Rates
from .parts import HOVER
from .plan import Plan

#: Columns and rows of the points of an image at which its motion is measured.
_POINTS = 17, 13
#: Factor on the motion of an image of relief, which points may miss where it is greatest.
_RELIEF_MARGIN = 1.25
#: Time in which the motion of an image is measured, seconds.
_MOMENT_S = 1e-4
#: Metres to where there is no ground.
_FAR_M = 1e9
#: Columns of the table that state the rates of a camera, in the order of `Rates`.
RATE_COLUMNS = (
    *("speed_east_m_per_s", "speed_north_m_per_s", "speed_up_m_per_s"),
    *("yaw_rate_deg_per_s", "tilt_rate_deg_per_s", "roll_rate_deg_per_s"),
)
#: What is stated of the camera of an image and of effects on it, by the name of the table's column.
Facts = tuple[tuple[str, Union[float, str]], ...]


class RowStrip(NamedTuple):
    """Rows of a picture, from ``top`` to before ``bottom``, and the pose of the camera when they are exposed."""

    top: int
    bottom: int
    pose: Poses


@dataclass(frozen=True, eq=False)
class Timing:
    """Times at which the rows of a capture's picture are exposed, and the motion of the picture meanwhile.

    Attributes
    ----------
    exposure_ms : float
        Exposure time that blurs the picture; 0 without motion blur.
    """

    plan: Plan
    index: int
    exposure_ms: float
    row_time_us: float

    @classmethod
    def of(cls, plan: Plan, index: int) -> Timing | None:
        """Timing of a picture; None if motion does not change it."""
        mission = plan.settings(index)
        if plan.frames.on_map or not mission.shutter.takes_time:
            return None
        exposure_ms = mission.route.exposure_ms or 0.0
        return cls(plan, index, exposure_ms if mission.shutter.motion_blur else 0.0, mission.shutter.row_time_us)

    @cached_property
    def rates(self) -> Rates:
        """Velocity and turn rates of the camera, (1,)."""
        return self.plan.rates.take(slice(self.index, self.index + 1))

    @property
    def _flown(self) -> Poses:
        return self.plan.poses.take(slice(self.index, self.index + 1))

    def pose(self, after_s: float) -> Poses:
        """Pose of the camera at a time after that of the picture."""
        return self.rates.moved(self._flown, after_s)

    @cached_property
    def _speeds(self) -> tuple[Floats, Floats]:
        """Rows in px at which the motion of the picture is measured, (k,), and its greatest speed in px/s there."""
        (width, height), camera = self.plan.views.size_px(self.index), self.plan.camera(self.index)
        # Over relief, the centres of the pixels of a small picture; else also the edges.
        inset = 0.0 if self.plan.relief.is_level else 0.5
        across, down = (np.linspace(inset, count - inset, count) / count for count in _POINTS)
        x, y = np.meshgrid(2.0 * across - 1.0, 1.0 - 2.0 * down)
        points = np.stack([x, y], axis=-1).reshape(-1, 2)
        pose = self._flown
        angles = [float(angle[0]) for angle in pose.attitude]
        rays = camera.rays_enu(points, *angles)
        vectors = rays * self._depth_m(rays, angles)[:, np.newaxis]
        way = np.array([float(rate[0]) for rate in self.rates[:3]]) * _MOMENT_S
        turned = [angle + float(rate[0]) * _MOMENT_S for angle, rate in zip(angles, self.rates[3:])]
        before, _ = camera.image_xy(vectors, *angles)
        after, _ = camera.image_xy(vectors - way, *turned)
        moved_px = np.hypot(*((after - before) * (width / 2.0, height / 2.0)).T)
        speed = moved_px.reshape(x.shape).max(axis=1) / _MOMENT_S
        margin = 1.0 if self.plan.relief.is_level else _RELIEF_MARGIN
        return down * height, speed * margin

    def _depth_m(self, rays: Floats, angles: list[float]) -> Floats:
        """Depths (k,) of the ground at the points where the motion is measured."""
        if not self.plan.relief.is_level:
            depth_m = self.plan.views.tracing(self.index, _POINTS).sighting.depth_m.ravel()
        else:
            lat, _, agl, *_ = (value[0] for value in self._flown)
            ground = self.plan.ground
            seen = trace(lat, agl, rays, ground)
            axis = self.plan.camera(self.index).rays_enu(((0.0, 0.0),), *angles)[0]
            with np.errstate(invalid="ignore"):
                depth_m = sight_lines(lat, agl, seen.lat_deg, seen.dlon_deg, ground) @ axis
        return np.where(np.isfinite(depth_m), depth_m, _FAR_M)

    @cached_property
    def blur_px(self) -> float:
        """Greatest motion of the picture during the exposure."""
        return float(self._speeds[1].max()) * self.exposure_ms * 1e-3

    @property
    def readout_ms(self) -> float:
        """Time from the exposure of the first row to that of the last."""
        return (self.plan.views.size_px(self.index)[1] - 1) * self.row_time_us * 1e-3

    @property
    def skew_px(self) -> float:
        """Greatest motion of the picture from the exposure of the first row to that of the last."""
        return float(self._speeds[1].max()) * self.readout_ms * 1e-3

    @cached_property
    def instants(self) -> int:
        """Number of instants whose mean the picture is."""
        return instant_count(self.blur_px)

    @property
    def strip_count(self) -> int:
        """Number of strips of each instant."""
        return len(self._planned_strips)

    def instants_s(self) -> list[float]:
        """Times of the instants after the middle of the exposure."""
        times: list[float] = instants_s(self.exposure_ms, self.instants).tolist()
        return times

    def strips(self, height: int, after_s: float = 0.0) -> list[RowStrip]:
        """Strips of a picture of a height, at an instant after the middle of the exposure."""
        planned = self.plan.views.size_px(self.index)[1]
        found = []
        for top, bottom in self._planned_strips:
            first, end = (round(row * height / planned) for row in (top, bottom))
            if first < end:
                at_s = (top + bottom - planned) / 2.0 * self.row_time_us * 1e-6
                found.append(RowStrip(first, end, self.pose(at_s + after_s)))
        return found

    @cached_property
    def _planned_strips(self) -> list[tuple[int, int]]:
        height = self.plan.views.size_px(self.index)[1]
        rows, speeds = self._speeds
        middles = np.arange(height) + 0.5
        if self.plan.relief.is_level:
            speed = np.interp(middles, rows, speeds)
        else:
            # A hill may begin anywhere between two rows.
            below = np.clip(np.searchsorted(rows, middles), 1, len(rows) - 1)
            speed = np.maximum(speeds[below - 1], speeds[below])
        moved_px = speed * (self.row_time_us * 1e-6)
        if not moved_px.any():
            return [(0, height)]
        return strips(moved_px, self.plan.strip_px)

    @property
    def facts(self) -> Facts:
        """What the table states: with it, the pose of each row follows."""
        stated: dict[str, float] = {}
        if self.exposure_ms:
            stated = {
                "exposure_ms": self.exposure_ms,
                "motion_blur_px": self.blur_px,
                "exposure_instants": float(self.instants),
            }
        rates = dict(zip(RATE_COLUMNS, (float(rate[0]) for rate in self.rates)))
        # Of rows as written.
        height = self.plan.views.size_px(self.index)[1]
        written = (self.plan.mission.output.img_size or (0, height))[1]
        return (("row_time_us", self.row_time_us * height / written), *stated.items(), *rates.items())


def shown_box(plan: Plan, index: int) -> tuple[float, float, float, float]:
    """West, north, east and south end of the ground that a capture may show while it is taken; see `CameraViews.box`.

    The camera moves evenly, so that what it shows in between lies between what it shows at first and at last.
    """
    timing = Timing.of(plan, index)
    if timing is None:
        return plan.views.box(index)
    half_s = (timing.exposure_ms + timing.readout_ms) * 0.5e-3
    boxes = np.array([plan.views.box(index, timing.pose(after_s)) for after_s in (-half_s, half_s)])
    return (*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())


def fastest_capture(plan: Plan) -> int:
    """Capture whose images move fastest, judged by the ground below and the turns of the camera."""
    east, north, up, *turns = plan.rates
    turning = np.radians(np.sqrt(sum(rate * rate for rate in turns)))
    return int(np.argmax(np.sqrt(east**2 + north**2 + up**2) / plan.agl_m + turning))


def motion_text(plan: Plan) -> Message | None:
    """Motion in the image that moves most, in words; None for a mission whose images take no time."""
    if not plan.mission.takes_time:
        return None
    if plan.mission.trigger == HOVER:
        return Message("none: the camera hovers")
    timing = Timing.of(plan, fastest_capture(plan))
    if timing is None or not np.stack(timing.rates).any():
        return Message("none: the camera is at rest")
    found = []
    if timing.exposure_ms:
        found.append(
            Message(
                "blur of up to {0:.2g} px in {1:g} ms, {2} instants each",
                timing.blur_px,
                timing.exposure_ms,
                timing.instants,
            )
        )
    if timing.row_time_us:
        found.append(Message("skew of up to {0:.2g} px in {1:.3g} ms", timing.skew_px, timing.readout_ms))
    return Message.joined("; ", found)


def middle_strips(plan: Plan, index: int, size_px: tuple[int, int]) -> list[RowStrip]:
    """Strips of a capture's picture, of any size, in the middle of the exposure; one if it does not move."""
    timing = Timing.of(plan, index)
    if timing is None:
        return [RowStrip(0, size_px[1], plan.poses.take(slice(index, index + 1)))]
    return timing.strips(size_px[1])
