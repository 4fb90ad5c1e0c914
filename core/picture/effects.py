"""What a real camera makes of a picture: effects in the order in which light meets them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..arrays import PixelValues
from ..bands import Bands
from ..camera.light import SRGB, bytes_of_linear, linear_of_bytes
from ..errors import InvalidInput
from ..mission.mission import Mission
from ..mission.parts import IDEAL, NO_VIGNETTING
from ..mission.plan import Plan
from ..mission.takes import Facts
from .photometry import ExposedImage, Haze, PointSpread, ToneCurve, Vignetting, WhiteBalance, check_white_balance
from .scene import Light, PictureScene, RawValues
from .sensor import SensorReadout, check_sensor
from .shot import MapShot, Shot


class Effect(Protocol):
    """An effect of a real camera."""

    def apply(self, light: Light) -> None:
        """Change the light, and state the facts of this image."""


def effects(mission: Mission) -> tuple[Effect, ...]:
    """Effects that a mission asks for, in the order in which light meets them; none by default."""
    # Air, vignetting, point spread function, exposure, sensor, white balance, tone.
    air, optics, exposure = mission.air, mission.optics, mission.exposure
    made: list[Effect | None] = [
        None if air.visibility_km is None else Haze(air, air.visibility_km),
        None if optics.vignetting == NO_VIGNETTING else Vignetting(optics),
        PointSpread.of(mission),
        None if exposure.exposure == IDEAL else ExposedImage(exposure, mission.route.exposure_ms or 0.0),
        SensorReadout.of(mission) if mission.sensor.image_sensor else None,
        None if exposure.white_balance_k is None else WhiteBalance(exposure.white_balance_k),
        None if exposure.tone == SRGB else ToneCurve(exposure.tone),
    ]
    return tuple(one for one in made if one is not None)


@dataclass(frozen=True, eq=False)
class Development:
    """The way of one picture through the camera."""

    plan: Plan
    index: int
    map_type: str = ""

    @classmethod
    def of(cls, plan: Plan, index: int, map_type: str = "") -> Development | None:
        """The way of a capture's picture; None for an ideal camera."""
        return cls(plan, index, map_type) if plan.mission.varied.vary or effects(plan.mission) else None

    @property
    def needs_range(self) -> bool:
        """Whether effects ask for the distance of what the pixels show."""
        return self.plan.settings(self.index).air.visibility_km is not None

    def develop(
        self, pixels: PixelValues, shot: MapShot | Shot, colours: int
    ) -> tuple[PixelValues, Facts, RawValues | None]:
        """Return the picture (h, w, channels) of 8 bits that the camera makes of an ideal one, its facts, raw values.

        Parameters
        ----------
        colours : int
            Number of channels that show light; those after them, a mask, stay as they are.
        """
        scene, drawn = PictureScene(self.plan, self.index, shot, self.map_type), self.plan.drawn(self.index)
        chain = effects(scene.mission)
        if not chain:
            return pixels, tuple(drawn.items()), None
        light = Light(linear_of_bytes(pixels[..., :colours]), scene, {**drawn})
        for effect in chain:
            effect.apply(light)
        developed = bytes_of_linear(light.values, light.tone)
        return np.dstack([developed, pixels[..., colours:]]), tuple(light.facts.items()), light.raw


def check_bands(mission: Mission, bands: Bands) -> None:
    """Raise InvalidInput if a mission asks for effects on bands that are not colours of 8 bits."""
    if mission.camera.splits_colours and not (bands.are_colours and len(bands) == 3):
        raise InvalidInput(
            "lens with a scale of red or blue: needs red, green and blue of 8 bits, and the source gives {0}",
            bands,
            field="source",
        )
    if (effects(mission) or mission.shutter.motion_blur) and not bands.are_colours:
        raise InvalidInput(
            "effects of a real camera: need grey, or red, green and blue of 8 bits, and the source gives {0}",
            bands,
            field="source",
        )
    if mission.sensor.image_sensor:
        check_sensor(mission, bands)
    check_white_balance(mission, bands)
