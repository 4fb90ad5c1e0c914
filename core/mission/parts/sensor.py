"""The part of a mission that describes the image sensor, by the figures of EMVA 1288."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import InvalidInput, Message, OptionName
from ...fields import CheckedFields, declared, field_named, is_plain
from ..sensors import CUSTOM, sensor_named

#: No colour filters: each pixel measures every colour of the imagery.
NO_BAYER = "none"
#: Fields that a sensor needs, and those that are 0 where neither the mission nor a data sheet has them.
_NEEDED = ("pixel_um", "quantum_efficiency", "full_well_e")
_NOISE = ("read_noise_e", "dark_current_e_per_s", "dsnu_e", "prnu", "black_level_dn")
_USUAL_BITS = 12


def _check_sensor(name: str) -> None:
    if not is_plain(name):
        raise InvalidInput("image sensor {0!r}: must be a name without spaces around it", name, field="image_sensor")
    if name not in ("", CUSTOM):
        sensor_named(name)


@dataclass(frozen=True)
class ImageSensor(CheckedFields):
    """Pixels, noise and converter of the image sensor."""

    image_sensor: str = declared(
        "",
        title="image sensor",
        help="sensor whose noise, saturation and quantisation images have, after EMVA 1288: a name, as "
        "terrainav cameras sensors lists them, or custom for figures of your own; left out, the sensor is ideal",
        advanced=True,
        check=_check_sensor,
    )
    pixel_um: float | None = declared(
        None,
        title="pixel pitch",
        help="distance between the centres of the sensor's pixels; the named sensor's, unless given",
        unit="um",
        above=0.0,
        most=1000.0,
        suggested=3.45,
        advanced=True,
    )
    quantum_efficiency: float | None = declared(
        None,
        title="quantum efficiency",
        help="electrons per photon; the named sensor's, unless given",
        unit="share",
        above=0.0,
        most=1.0,
        suggested=0.6,
        advanced=True,
    )
    full_well_e: float | None = declared(
        None,
        title="full well",
        help="electrons that a pixel holds, its saturation capacity; the named sensor's, unless given",
        unit="e",
        least=1.0,
        most=1e7,
        suggested=10_000.0,
        advanced=True,
    )
    read_noise_e: float | None = declared(
        None,
        title="read noise",
        help="standard deviation of the temporal noise in the dark; the named sensor's, unless given",
        unit="e",
        least=0.0,
        most=1e6,
        suggested=3.0,
        advanced=True,
    )
    dark_current_e_per_s: float | None = declared(
        None,
        title="dark current",
        help="electrons per pixel and second without light; the named sensor's, unless given",
        unit="e/s",
        least=0.0,
        most=1e6,
        suggested=5.0,
        advanced=True,
    )
    dsnu_e: float | None = declared(
        None,
        title="dark signal non-uniformity",
        help="standard deviation of the pixels' fixed offsets (DSNU); the named sensor's, unless given",
        unit="e",
        least=0.0,
        most=1e6,
        suggested=1.0,
        advanced=True,
    )
    prnu: float | None = declared(
        None,
        title="photo response non-uniformity",
        help="standard deviation of the pixels' fixed sensitivities (PRNU); the named sensor's, unless given",
        unit="share",
        least=0.0,
        most=0.25,
        suggested=0.005,
        advanced=True,
    )
    gain_dn_per_e: float | None = declared(
        None,
        title="system gain",
        help="digital numbers per electron (K); the named sensor's, unless given, and where its data sheet has none "
        "the one with which the full well reaches the largest number",
        unit="DN/e",
        above=0.0,
        most=1e6,
        suggested=0.4,
        advanced=True,
    )
    black_level_dn: float | None = declared(
        None,
        title="black level",
        help="digital number of a pixel without electrons; the named sensor's, unless given",
        unit="DN",
        least=0.0,
        most=4094.0,
        suggested=0.0,
        advanced=True,
    )
    adc_bits: int | None = declared(
        None,
        title="bits of the converter",
        help="bits of a raw value; the named sensor's, unless given, whose gain and black level follow",
        least=8,
        most=12,
        suggested=_USUAL_BITS,
        advanced=True,
    )
    bayer: str = declared(
        NO_BAYER,
        title="colour filters",
        help="Bayer pattern of the sensor, from its upper left pixel, row by row; without one, each pixel measures "
        "every colour",
        choices={
            NO_BAYER: "None",
            "rggb": "Red green, green blue",
            "bggr": "Blue green, green red",
            "grbg": "Green red, blue green",
            "gbrg": "Green blue, red green",
        },
        advanced=True,
    )
    demosaicing: str = declared(
        "malvar",
        title="demosaicing",
        help="how the colours that a pixel does not measure are found: bilinear from the nearest, malvar corrected by "
        "gradients (Malvar, He and Cutler 2004)",
        choices={"malvar": "Gradient-corrected", "bilinear": "Bilinear"},
        advanced=True,
    )

    def __post_init__(self) -> None:
        """Check every field, and that they go together."""
        super().__post_init__()
        if not self.image_sensor:
            self._check_unused()
            return
        figures = self.figures
        if figures["black_level_dn"] >= 2.0 ** figures["adc_bits"] - 1.0:
            raise InvalidInput(
                "black level {0:g} DN: must be below {1}, the largest number of {2} bits",
                figures["black_level_dn"],
                2 ** int(figures["adc_bits"]) - 1,
                int(figures["adc_bits"]),
                field="black_level_dn",
            )

    def _check_unused(self) -> None:
        """Refuse figures of a sensor that is not there; others use the pixel pitch."""
        for name, value in vars(self).items():
            if name != "pixel_um" and value != getattr(ImageSensor, name):
                raise InvalidInput(
                    "{0} {1}: needs an image sensor",
                    Message(field_named(ImageSensor, name).title),
                    value,
                    field=name,
                    remedy=Message("name one, or {0}{1}", CUSTOM, OptionName("image_sensor").in_brackets),
                )

    @property
    def figures(self) -> dict[str, float]:
        """Every figure of the sensor by field, the mission's own before those of the data sheet.

        Raises
        ------
        InvalidInput
            A sensor of one's own lacks a figure.
        """
        sheet = {} if self.image_sensor in ("", CUSTOM) else sensor_named(self.image_sensor).figures
        names = (*_NEEDED, *_NOISE, "gain_dn_per_e", "adc_bits")
        own = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        for name in _NEEDED:
            if name not in own and name not in sheet:
                title = Message(field_named(ImageSensor, name).title)
                raise InvalidInput(
                    "image sensor {0}: needs its {1}",
                    self.image_sensor,
                    title,
                    field=name,
                    remedy=Message("give it{0}", OptionName(name).in_brackets),
                )
        found: dict[str, float] = {**dict.fromkeys(_NOISE, 0.0), "adc_bits": _USUAL_BITS, **sheet, **own}
        # With fewer bits a converter leaves out the lowest ones.
        steps = 2.0 ** (found["adc_bits"] - sheet.get("adc_bits", found["adc_bits"]))
        for name in ("gain_dn_per_e", "black_level_dn"):
            if name in sheet and name not in own:
                found[name] = sheet[name] * steps
        if "gain_dn_per_e" not in found:
            room_dn = 2.0 ** found["adc_bits"] - 1.0 - found["black_level_dn"]
            found["gain_dn_per_e"] = room_dn / found["full_well_e"]
        return found

    @property
    def pitch_um(self) -> float | None:
        """Pixel pitch, given or the named sensor's; None if neither is known."""
        if self.pixel_um is not None or not self.image_sensor:
            return self.pixel_um
        return self.figures["pixel_um"]
