"""A picture on its way through a camera: its light, and what effects may ask of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray
from ..bands import Bands
from ..camera.light import SRGB
from ..mission.mission import Mission
from ..mission.plan import Plan
from .optics import planned_optics
from .shot import MapShot, Shot


@dataclass(frozen=True, eq=False)
class PictureScene:
    """What effects may ask of the picture that they change, found when they ask."""

    plan: Plan
    index: int
    shot: MapShot | Shot

    @cached_property
    def mission(self) -> Mission:
        """The mission, with the values of this image."""
        return self.plan.settings(self.index)

    @property
    def name(self) -> str:
        """Name of the image, which seeds what is random in it."""
        return self.plan.names[self.index]

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        return self.plan.views.size_px(self.index)

    @cached_property
    def tangents(self) -> tuple[Floats, Floats]:
        """Tangents of the angles between the optical axis and the pixels' rays: to the right (w,), and down (h, 1)."""
        width, height = self.size_px
        _, _, focal_x, focal_y, x, y = (float(one[0]) for one in planned_optics(self.plan, np.array([self.index])))
        return (np.arange(width) + 0.5 - x) / focal_x, (np.arange(height) + 0.5 - y)[:, np.newaxis] / focal_y

    @cached_property
    def range_m(self) -> Floats:
        """Slant range from the camera to what each pixel shows, (h, w); infinite where it shows sky."""
        from .products import sighting

        right, down = self.tangents
        depth_m = sighting(self.plan, self.index, self.size_px, self.shot).depth_m
        return np.where(np.isfinite(depth_m), depth_m * np.sqrt(1.0 + right**2 + down**2), np.inf)


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
