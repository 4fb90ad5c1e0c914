"""Effects of air and lens on light, its exposure, white balance and tone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from ..arrays import NDArray
from ..bands import Bands
from ..camera.air import add_haze, extinction_per_m
from ..camera.light import (
    LUMINANCE,
    linear_of_bytes,
    metered_gain,
    mixed,
    saturation_share,
    white_balance,
    white_exposure_s,
)
from ..camera.optics import (
    cos4_falloff,
    cutoff_frequency,
    diffraction_contrast,
    dim,
    gaussian_contrast,
    half_contrast,
    radial_falloff,
    spread_light,
)
from ..errors import InvalidInput
from ..mission.mission import Mission
from ..mission.parts import BY_ISO, BY_TIME, COS4, Air, CameraOptics, ExposureControl
from .scene import Light, PictureScene
from .shot import Shot


@dataclass(frozen=True)
class Haze:
    """Air that takes the place of light with distance, after Koschmieder."""

    air: Air
    visibility_km: float

    def apply(self, light: Light) -> None:
        """Add haze by the distance of what each pixel shows."""
        airlight = linear_of_bytes(np.array(self.air.airlight_rgb, np.uint8)).astype(np.float64)
        if light.values.shape[2] == 1:
            airlight = np.array([airlight @ LUMINANCE])
        add_haze(light.values, light.scene.range_m, extinction_per_m(self.visibility_km), airlight)
        light.facts.update(visibility_km=self.visibility_km, airlight=self.air.airlight)


@dataclass(frozen=True)
class Vignetting:
    """Light that falls off from the middle of the image."""

    optics: CameraOptics

    def apply(self, light: Light) -> None:
        """Dim the light towards the image's corners."""
        scene, optics = light.scene, self.optics
        if optics.vignetting == COS4:
            share = cos4_falloff(*scene.tangents)
        else:
            share = radial_falloff(*scene.radii, optics.falloff_terms)
        dim(light.values, share)
        light.facts["vignetting"] = optics.vignetting


@dataclass(frozen=True)
class PointSpread:
    """Light that the lens spreads: by its stated sharpness, or by diffraction of an aperture for pixels of a pitch."""

    mtf50: float | None
    f_number: float
    pixel_um: float

    @classmethod
    def of(cls, mission: Mission) -> PointSpread | None:
        """Spread of a mission's lens; None if it is perfectly sharp."""
        optics = mission.optics
        if not optics.diffraction and optics.mtf50 is None:
            return None
        return cls(optics.mtf50, mission.exposure.f_number, mission.sensor.pitch_um or 0.0)

    def apply(self, light: Light) -> None:
        """Spread the light of what the picture shows, and state at what frequency half of the contrast is left."""
        if self.mtf50 is not None:
            contrast = partial(gaussian_contrast, mtf50=self.mtf50)
        else:
            cutoff = cutoff_frequency(self.f_number, self.pixel_um)
            contrast = partial(diffraction_contrast, cutoff=cutoff)
            light.facts["f_number"] = self.f_number
        shot = light.scene.shot
        hidden = shot.hidden if isinstance(shot, Shot) else None
        spread_light(light.values, contrast, None if hidden is None else ~hidden)
        light.facts["mtf50"] = float(f"{half_contrast(contrast):.6g}")


@dataclass(frozen=True)
class ExposedImage:
    """Light by exposure time, aperture and ISO speed, as shares of what saturates the sensor."""

    control: ExposureControl
    exposure_ms: float

    def apply(self, light: Light) -> None:
        """Expose the light, after metering it where exposure is automatic."""
        control, exposure_ms, iso = self.control, self.exposure_ms, self.control.iso
        if control.is_automatic:
            gain = metered_gain(light.values, control.metering, _seen(light.scene))
            wanted = gain / self._share(1.0, 1.0)
            if control.exposure == BY_TIME:
                exposure_ms = _rounded(wanted / iso, control.shortest_exposure_ms, control.longest_exposure_ms)
            elif control.exposure == BY_ISO:
                iso = _rounded(wanted / exposure_ms, control.iso, control.highest_iso)
        light.values *= np.float32(self._share(exposure_ms, iso))
        light.facts.update(exposure=control.exposure, exposure_ms=exposure_ms, f_number=control.f_number, iso=iso)

    def _share(self, exposure_ms: float, iso: float) -> float:
        control = self.control
        return saturation_share(control.illuminance_lx, exposure_ms / 1000.0, control.f_number, iso)


def exposure_s(mission: Mission) -> float:
    """Exposure time in seconds that a mission states; else that at which a white diffuser just saturates the sensor."""
    if mission.route.exposure_ms is not None:
        return mission.route.exposure_ms / 1000.0
    control = mission.exposure
    return white_exposure_s(control.illuminance_lx, control.f_number, control.iso)


def _seen(scene: PictureScene) -> NDArray[np.bool_] | None:
    """Pixels that show ground, which are metered; None for all."""
    hidden = scene.shot.hidden if isinstance(scene.shot, Shot) else None
    return None if hidden is None else ~hidden


def _rounded(value: float, least: float, most: float) -> float:
    """Setting of a camera within its limits, to four digits, on which all processors agree."""
    return min(max(float(f"{value:.4g}"), least), most)


@dataclass(frozen=True)
class WhiteBalance:
    """Colours of a camera that takes light of a colour temperature for white."""

    temperature_k: float

    def apply(self, light: Light) -> None:
        """Adapt the colours."""
        light.values = mixed(light.values, white_balance(self.temperature_k))
        light.facts["white_balance_k"] = self.temperature_k


def check_white_balance(mission: Mission, bands: Bands) -> None:
    """Raise InvalidInput for a white balance of imagery without colours."""
    if mission.exposure.white_balance_k is not None and len(bands) != 3:
        raise InvalidInput(
            "white balance {0:g} K: needs red, green and blue, and the source gives {1}",
            mission.exposure.white_balance_k,
            bands,
            field="white_balance_k",
        )


@dataclass(frozen=True)
class ToneCurve:
    """Curve from light to the image's values."""

    tone: str

    def apply(self, light: Light) -> None:
        """State the curve, by which light becomes values."""
        light.tone = self.tone
        light.facts["tone"] = self.tone
