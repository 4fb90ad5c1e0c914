"""The part of a mission that states how images are exposed and developed."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import InvalidInput
from ...fields import CheckedFields, declared

#: Exposures: the brightness of the imagery, stated settings, or a meter that sets the exposure time or the ISO speed.
IDEAL, MANUAL, BY_TIME, BY_ISO = "ideal", "manual", "time", "iso"


@dataclass(frozen=True)
class ExposureControl(CheckedFields):
    """Exposure of images, and their development: white balance and tone."""

    exposure: str = declared(
        IDEAL,
        title="exposure",
        help="brightness of the images: ideal, as the imagery has it; manual, by exposure time, f-number and ISO speed "
        "in the light of the scene; time or iso, as a meter sets the exposure time or the ISO speed",
        choices={
            IDEAL: "Ideal (as the imagery)",
            MANUAL: "Manual",
            BY_TIME: "Automatic exposure time",
            BY_ISO: "Automatic ISO",
        },
        advanced=True,
    )
    f_number: float = declared(
        5.6,
        title="f-number",
        help="focal length over the diameter of the aperture",
        least=0.5,
        most=64.0,
        advanced=True,
    )
    iso: float = declared(
        100.0,
        title="sensitivity (ISO)",
        help="sensitivity of the camera, after ISO 12232: exposures of 78/ISO lux seconds saturate it; with automatic "
        "ISO, its lowest",
        least=1.0,
        most=10_000_000.0,
        advanced=True,
    )
    illuminance_lx: float = declared(
        80_000.0,
        title="illuminance",
        help="light that falls on the scene: sunlight has 80,000 lx or more, an overcast sky about 10,000 lx",
        unit="lx",
        above=0.0,
        most=1_000_000.0,
        advanced=True,
    )
    metering: str = declared(
        "average",
        title="metering",
        help="what automatic exposure meters: average brings the mean of the logarithms of luminance to 18 percent "
        "of saturation; highlights lets the brightest percent of the pixels saturate",
        choices={"average": "Average", "highlights": "Highlights"},
        advanced=True,
    )
    shortest_exposure_ms: float = declared(
        0.1,
        title="shortest exposure time",
        help="limit of the automatic exposure time",
        unit="ms",
        option="shortest_exposure",
        above=0.0,
        most=10_000.0,
        advanced=True,
    )
    longest_exposure_ms: float = declared(
        10.0,
        title="longest exposure time",
        help="limit of the automatic exposure time",
        unit="ms",
        option="longest_exposure",
        above=0.0,
        most=10_000.0,
        advanced=True,
    )
    highest_iso: float = declared(
        6_400.0,
        title="highest sensitivity (ISO)",
        help="limit of the automatic ISO",
        least=1.0,
        most=10_000_000.0,
        advanced=True,
    )
    white_balance_k: float | None = declared(
        None,
        title="white balance",
        help="colour temperature that the camera takes for white, of a scene in daylight of 6,504 K: lower ones make "
        "images blue, higher ones yellow; left out, it suits the scene",
        unit="K",
        least=2_000.0,
        most=25_000.0,
        suggested=5_500.0,
        advanced=True,
    )
    tone: str = declared(
        "srgb",
        title="tone curve",
        help="curve from light to values: srgb, that of the imagery; linear, none; filmic, with soft shadows and "
        "highlights",
        choices={"srgb": "sRGB", "linear": "Linear", "filmic": "Filmic"},
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field; refuse limits that leave nothing between them."""
        super().__post_init__()
        if self.shortest_exposure_ms > self.longest_exposure_ms:
            raise InvalidInput(
                "shortest exposure time {0:g} ms: must be at most the longest one, {1:g} ms",
                self.shortest_exposure_ms,
                self.longest_exposure_ms,
                field="shortest_exposure_ms",
            )
        if self.exposure == BY_ISO and self.iso > self.highest_iso:
            raise InvalidInput(
                "sensitivity ISO {0:g}: must be at most the highest one, ISO {1:g}",
                self.iso,
                self.highest_iso,
                field="iso",
            )

    @property
    def is_automatic(self) -> bool:
        """Whether a meter sets the exposure."""
        return self.exposure in (BY_TIME, BY_ISO)
