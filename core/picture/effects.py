"""What a real camera makes of a picture: effects in the order in which light meets them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, Union

import numpy as np

from ..arrays import Floats, NDArray, PixelValues
from ..bands import Bands
from ..camera.light import bytes_of_linear, linear_of_bytes
from ..errors import InvalidInput
from ..mission.mission import Mission
from ..mission.plan import Plan
from .optics import planned_optics
from .shot import MapShot, Shot

#: What is stated of the effects on an image, by the name of the table's column.
Facts = tuple[tuple[str, Union[float, str]], ...]


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
    """

    values: NDArray[np.float32]
    scene: PictureScene
    facts: dict[str, float | str] = field(default_factory=dict)


class Effect(Protocol):
    """An effect of a real camera."""

    def apply(self, light: Light) -> None:
        """Change the light, and state the facts of this image."""


def effects(_mission: Mission) -> tuple[Effect, ...]:
    """Effects that a mission asks for, in the order in which light meets them; none by default."""
    # Air, vignetting, point spread function, exposure, sensor, white balance, tone.
    made: list[Effect | None] = []
    return tuple(one for one in made if one is not None)


@dataclass(frozen=True, eq=False)
class Development:
    """The way of one picture through the camera."""

    plan: Plan
    index: int

    @classmethod
    def of(cls, plan: Plan, index: int) -> Development | None:
        """The way of a capture's picture; None for an ideal camera."""
        mission = plan.settings(index)
        return cls(plan, index) if mission.varied.vary or effects(mission) else None

    def develop(self, pixels: PixelValues, shot: MapShot | Shot, colours: int) -> tuple[PixelValues, Facts]:
        """Return the picture (h, w, channels) of 8 bits that the camera makes of an ideal one, and its facts.

        Parameters
        ----------
        colours : int
            Number of channels that show light; those after them, a mask, stay as they are.
        """
        scene, drawn = PictureScene(self.plan, self.index, shot), self.plan.drawn(self.index)
        chain = effects(scene.mission)
        if not chain:
            return pixels, tuple(drawn.items())
        light = Light(linear_of_bytes(pixels[..., :colours]), scene, {**drawn})
        for effect in chain:
            effect.apply(light)
        developed = bytes_of_linear(light.values)
        return np.dstack([developed, pixels[..., colours:]]), tuple(light.facts.items())


def check_bands(mission: Mission, bands: Bands) -> None:
    """Raise InvalidInput if a mission asks for effects on bands that are not colours of 8 bits."""
    if effects(mission) and not bands.are_colours:
        raise InvalidInput(
            "effects of a real camera: need grey, or red, green and blue of 8 bits, and the source gives {0}",
            bands,
            field="source",
        )
