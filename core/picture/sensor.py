"""The image sensor of a mission: light becomes raw values, and raw values light with their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..bands import Bands
from ..camera.bayer import demosaiced, mosaic
from ..camera.sensor import Detector, read_out
from ..mission.mission import Mission
from ..mission.parts import NO_BAYER, RAW
from .scene import Light, RawValues


@dataclass(frozen=True)
class SensorReadout:
    """A sensor that measures light, in an ideal exposure: the imagery's white saturates it.

    Parameters
    ----------
    bayer, demosaicing : str
        Pattern of the colour filters, and the method that finds the other colours.
    white_s : float
        Exposure time of the ideal exposure.
    """

    detector: Detector
    bayer: str
    demosaicing: str
    white_s: float
    keeps_raw: bool

    @classmethod
    def of(cls, mission: Mission) -> SensorReadout:
        """The sensor of a mission that has one."""
        sensor = mission.sensor
        figures = sensor.figures
        detector = Detector(bits=int(figures.pop("adc_bits")), **figures)
        return cls(detector, sensor.bayer, sensor.demosaicing, 0.0, RAW in mission.products)

    def apply(self, light: Light) -> None:
        """Replace light by what its raw values stand for; state the gain and the share of saturated pixels."""
        white_lx_s = np.float32(self.detector.saturation_lx_s)
        exposure = light.values * white_lx_s
        if self.bayer != NO_BAYER:
            exposure = mosaic(exposure, self.bayer)
        scene = light.scene
        raw = read_out(self.detector, exposure, self.white_s, scene.mission.imagery.seed, scene.name)
        light.facts["gain_dn_per_e"] = self.detector.gain_dn_per_e
        light.facts["saturated_share"] = float(np.mean(raw >= self.detector.saturation_dn))
        found = self.detector.exposure_lx_s(raw)
        if self.bayer != NO_BAYER:
            found = demosaiced(found, self.bayer, self.demosaicing)
        light.values = found / white_lx_s
        if self.keeps_raw:
            values = raw.reshape(*raw.shape[:2], -1)
            one = "grey" if self.bayer == NO_BAYER else self.bayer
            names = ("red", "green", "blue") if values.shape[2] == 3 else (one,)
            bands = Bands(names, "uint16", tuple(range(len(names))))
            light.raw = RawValues(values, bands, self.detector.most_dn)
