"""A picture on its way through a camera: its light, and what effects may ask of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..bands import Bands
from ..camera.light import SRGB
from ..geodesy.accuracy import ImageGeometry
from ..geodesy.camera import Poses
from ..geodesy.ellipsoid import distances_m
from ..geodesy.view import ImageRays
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..mission.takes import middle_strips
from .optics import planned_optics
from .shot import MapShot, Shot

#: Pixels whose ground is found together.
_CACHED_PX = 1 << 16


@dataclass(frozen=True, eq=False)
class PictureScene:
    """What effects may ask of the picture that they change, found when they ask."""

    plan: Plan
    index: int
    shot: MapShot | Shot
    map_type: str = ""

    @cached_property
    def mission(self) -> Mission:
        """The mission, with the values of this image."""
        return self.plan.settings(self.index)

    @property
    def name(self) -> str:
        """Name of the image, which seeds what is random in it."""
        return self.plan.names[self.index]

    @property
    def exposure_key(self) -> str:
        """Name of the image and of its imagery, as two imageries of one place have noise of their own."""
        imagery = self.mission.imagery
        # A file has the same key wherever it is.
        source = imagery.source if "://" in imagery.source else imagery.source.replace("\\", "/").rpartition("/")[2]
        return "/".join((self.name, self.map_type, imagery.date, source))

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        return self.plan.views.size_px(self.index)

    @cached_property
    def tangents(self) -> tuple[Floats, Floats]:
        """Tangents of the angles of the pixels' rays to the optical axis, right and down, which broadcast to (h, w)."""
        width, height = self.size_px
        if self.plan.frames.on_map:
            _, _, focal_x, focal_y, x, y = (float(one[0]) for one in planned_optics(self.plan, np.array([self.index])))
            return (np.arange(width) + 0.5 - x) / focal_x, (np.arange(height) + 0.5 - y)[:, np.newaxis] / focal_y
        x_px, y_px = self._rays(self.plan.poses.take(np.array([self.index]))).ideal_centres(0, height)
        tan_x, tan_y = self.plan.camera(self.index).half_tangents
        return (2.0 * x_px / width - 1.0) * tan_x, (2.0 * y_px / height - 1.0) * tan_y

    @property
    def radii(self) -> tuple[Floats, Floats]:
        """Distances of pixels from the principal point as shares of half the diagonal, right (w,) and down (h, 1)."""
        width, height = self.size_px
        x, y = (float(one[0]) for one in planned_optics(self.plan, np.array([self.index]))[4:])
        corner = math.hypot(width, height) / 2.0
        return (np.arange(width) + 0.5 - x) / corner, (np.arange(height) + 0.5 - y)[:, np.newaxis] / corner

    def _rays(self, pose: Poses) -> ImageRays:
        return ImageRays.from_scene(ImageGeometry(self.plan.camera(self.index), *self.size_px, pose, self.plan.ground))

    @cached_property
    def range_m(self) -> Floats:
        """Slant range from the camera to what each pixel shows, (h, w); infinite where it shows sky."""
        right, down = self.tangents
        if self.plan.relief.is_level:
            if not self.plan.frames.on_map:
                return self._level_range_m()
            # The camera of a map frame looks straight down; that the Earth is no sphere does not matter to it.
            across = np.broadcast_arrays(right, -down, -1.0)
            pose = self.plan.poses.take(np.array([self.index]))
            rays = np.moveaxis(np.stack(across), 0, -1)
            return distances_m(pose.lat_deg[0], pose.agl_m[0], rays, self.plan.ground)
        from .products import sighting

        depth_m = sighting(self.plan, self.index, self.size_px, self.shot).depth_m
        return np.where(np.isfinite(depth_m), depth_m * np.sqrt(1.0 + right**2 + down**2), np.inf)

    def _level_range_m(self) -> Floats:
        """`range_m` of a camera frame over level ground, in a twentieth of the time of its ground points."""
        width, height = self.size_px
        range_m = np.empty((height, width))
        rows = max(_CACHED_PX // width, 1)
        for first, end, pose in middle_strips(self.plan, self.index, self.size_px):
            rays = self._rays(pose)
            for top in range(first, end, rows):
                bottom = min(top + rows, end)
                centres = rays.ideal_centres(top, bottom)
                # Each component in one piece of memory.
                directions = np.moveaxis(np.stack([rays.component(axis, *centres) for axis in range(3)]), 0, -1)
                range_m[top:bottom] = distances_m(pose.lat_deg[0], pose.agl_m[0], directions, self.plan.ground)
        return range_m


class RawValues(NamedTuple):
    """Values (h, w, bands) of uint16 that a sensor measured, before demosaicing; and the largest that it has."""

    values: NDArray[np.uint16]
    bands: Bands
    most_dn: int


@dataclass(eq=False)
class Light:
    """A picture on its way through the camera, which effects change.

    Attributes
    ----------
    values : array (h, w, c) of float32
        Linear light of each channel; 1 is what the imagery shows as white.
    scene : PictureScene
    facts : dict
        What the table and the image's metadata state of the effects, by the name of the column.
    tone : str
        Curve by which light becomes the image's values.
    raw : RawValues or None
        What the sensor measured, if there is one.
    """

    values: NDArray[np.float32]
    scene: PictureScene
    facts: dict[str, float | str] = field(default_factory=dict)
    tone: str = SRGB
    raw: RawValues | None = None
