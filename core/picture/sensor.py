"""The image sensor of a mission: light becomes raw values, and raw values light with their noise."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..bands import Bands
from ..camera.bayer import demosaiced, mosaic
from ..camera.light import SATURATION_LX_S, white_exposure_s
from ..camera.sensor import Detector, read_out
from ..errors import InvalidInput, Message
from ..mission.mission import Mission
from ..mission.parts import IDEAL, NO_BAYER, RAW
from .scene import Light, RawValues


@dataclass(frozen=True)
class SensorReadout:
    """A sensor that measures light.

    Parameters
    ----------
    detector : Detector
        The sensor at its lowest speed.
    bayer, demosaicing : str
        Pattern of the colour filters, and the method that finds the other colours.
    is_exposed : bool
        Whether light is exposed: 1 saturates the image at the ISO speed. Otherwise 1 is the imagery's white, which
        saturates the sensor at its lowest speed.
    exposure_s : float
        Exposure time of light that is not exposed.
    """

    detector: Detector
    bayer: str
    demosaicing: str
    is_exposed: bool
    exposure_s: float
    keeps_raw: bool

    @classmethod
    def of(cls, mission: Mission) -> SensorReadout:
        """The sensor of a mission that has one."""
        sensor, control, exposure_ms = mission.sensor, mission.exposure, mission.route.exposure_ms
        figures = sensor.figures
        detector = Detector(bits=int(figures.pop("adc_bits")), **figures)
        exposure_s = (
            white_exposure_s(control.illuminance_lx, control.f_number, _lowest_iso(detector))
            if exposure_ms is None
            else exposure_ms / 1000.0
        )
        is_exposed = control.exposure != IDEAL
        return cls(detector, sensor.bayer, sensor.demosaicing, is_exposed, exposure_s, RAW in mission.products)

    def apply(self, light: Light) -> None:
        """Replace light by what its raw values stand for; state the gain and the share of saturated pixels."""
        detector, white_lx_s, exposure_s = self.detector, self.detector.saturation_lx_s, self.exposure_s
        if self.is_exposed:
            iso = float(light.facts["iso"])
            white_lx_s, exposure_s = SATURATION_LX_S / iso, float(light.facts["exposure_ms"]) / 1000.0
            detector = replace(detector, gain_dn_per_e=detector.gain_dn_per_e * iso / _lowest_iso(detector))
        exposure = light.values * np.float32(white_lx_s)
        if self.bayer != NO_BAYER:
            exposure = mosaic(exposure, self.bayer)
        scene = light.scene
        raw = read_out(detector, exposure, exposure_s, scene.mission.imagery.seed, scene.exposure_key)
        saturated = float(np.mean(raw >= detector.saturated_dn))
        light.facts.update(gain_dn_per_e=detector.gain_dn_per_e, saturated_share=saturated)
        found = detector.exposure_lx_s(raw)
        if self.bayer != NO_BAYER:
            found = demosaiced(found, self.bayer, self.demosaicing)
        light.values = found * np.float32(1.0 / white_lx_s)
        if self.keeps_raw:
            values = raw.reshape(*raw.shape[:2], -1)
            one = "grey" if self.bayer == NO_BAYER else self.bayer
            names = ("red", "green", "blue") if values.shape[2] == 3 else (one,)
            bands = Bands(names, "uint16", tuple(range(len(names))))
            light.raw = RawValues(values, bands, detector.most_dn)


def _lowest_iso(detector: Detector) -> float:
    """ISO speed of a sensor with the gain of its data sheet."""
    return SATURATION_LX_S / detector.saturation_lx_s


def check_sensor(mission: Mission, bands: Bands) -> None:
    """Raise InvalidInput for colour filters without colours, and for a speed at which the full well is not white."""
    readout = SensorReadout.of(mission)
    if readout.bayer != NO_BAYER and len(bands) != 3:
        raise InvalidInput(
            "colour filters {0}: need red, green and blue, and the source gives {1}",
            readout.bayer,
            bands,
            field="bayer",
        )
    lowest = _lowest_iso(readout.detector)
    # A speed that was computed from the same figures may be rounded.
    if readout.is_exposed and mission.exposure.iso < lowest * (1.0 - 1e-9):
        raise InvalidInput(
            "sensitivity ISO {0:g}: below that of the image sensor",
            mission.exposure.iso,
            field="iso",
            remedy=Message("give {0} or more", math.ceil(lowest)),
        )
