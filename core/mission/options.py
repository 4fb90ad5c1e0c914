"""Options of the command: one for each field of a mission, and other ways to state the same."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Callable

from ..errors import InvalidInput
from ..fields import Field, declared_fields
from ..geodesy.lens import Lens
from ..limits import MAX_BANDS, MAX_HEIGHT_SOURCES, MAX_IMAGERIES, MAX_VARIED, MAX_VECTOR_LAYERS
from ..numbers import integer, real_number
from ..units import LENGTHS_M
from .parts import (
    AUTO,
    FLAT_PARTS,
    REALISM_PARTS,
    Accuracy,
    Attitude,
    Flight,
    Imagery,
    Output,
    PixelLabels,
    Pixels,
    Route,
    Terrain,
)
from .presets import CAMERA_KINDS, PRESET_NAMES

#: Fields of several values in one text.
JOINED = ("stretch", "airlight", "vignetting", "sun")
#: Kinds of missions.
KINDS = ("single", "list", "raster")


def share(text: str) -> float:
    """Read a share from 0 to below 1, written as 0.6 or 60%; raises ValueError."""
    plain = text.strip()
    value = real_number(plain[:-1]) / 100.0 if plain.endswith("%") else real_number(plain)
    if not 0.0 <= value < 1.0:
        raise ValueError(text)
    return value


def speed(text: str) -> float | str:
    """Read a speed, or ``auto``; raises ValueError."""
    return AUTO if text.strip() == AUTO else real_number(text)


@dataclass(frozen=True)
class Option:
    """An option of the command.

    Attributes
    ----------
    name : str
        With underscores.
    kind : callable
        Reads a value from text.
    count : (int, int) or None
        Least and greatest number of values; None for a single value.
    flag : bool
        Whether the option takes no value.
    about : str
        Unit and limits, which the help does not state.
    """

    name: str
    kind: Callable[[str], Any]
    default: Any
    help: str
    count: tuple[int, int] | None = None
    choices: tuple[str, ...] | None = None
    metavar: str | tuple[str, ...] | None = None
    flag: bool = False
    about: str = ""

    @classmethod
    def from_field(cls, field: Field) -> Option:
        """Option that sets a field of a mission."""
        has_no_default = field.needed or field.default == ()
        numbers: dict[str, Callable[[str], Any]] = {"img_size": int, "takeoff": float}
        metavars = {"img_size": ("W", "H", "C"), "takeoff": ("LAT", "LON"), "airlight": ("R", "G", "B")}
        counts = {
            "img_size": (3, 3),
            "map_types": (1, len(field.choices)),
            "bands": (1, MAX_BANDS),
            "imageries": (1, MAX_IMAGERIES),
            "elevation": (1, MAX_HEIGHT_SOURCES),
            "surface": (1, MAX_HEIGHT_SOURCES),
            "buildings": (1, MAX_VECTOR_LAYERS),
            "labels": (1, MAX_VECTOR_LAYERS),
            "vary": (1, MAX_VARIED),
            "products": (1, len(field.choices)),
            "stretch": (1, 2),
            "airlight": (3, 3),
            "vignetting": (1, 3),
            "sun": (1, 2),
            "takeoff": (2, 2),
        }
        return cls(
            field.name_of_option,
            numbers.get(field.name) or (str if field.kind in (bool, tuple) else field.kind),
            tuple(field.default.split()) if field.name in JOINED else None if has_no_default else field.default,
            field.help,
            count=counts.get(field.name),
            # Choices of lists are checked by the mission.
            choices=tuple(field.choices) if field.choices and field.kind is str else None,
            metavar=metavars.get(field.name),
            flag=field.kind is bool,
            about=field.unit_and_limits,
        )

    @property
    def full_help(self) -> str:
        """Help text with unit, limits and default."""
        shown = " ".join(map(str, self.default)) if isinstance(self.default, tuple) else self.default
        default = "" if shown in (None, False, "") else f"default {shown}"
        details = "; ".join(filter(None, (self.about, default)))
        return self.help + (f" ({details})" if details else "")

    def read(self, value: Any, where: str) -> Any:
        """Convert a value given as text, as JSON, or as the command line splits it.

        Raises
        ------
        InvalidInput
            An invalid value; the message states the value, where it was given, and valid values.
        """
        if self.flag:
            return _read_flag(value, f"{where} {self.name}")
        parts = value.split() if isinstance(value, str) and self.count else value
        parts = list(parts) if isinstance(parts, (list, tuple)) else [parts]
        low, high = self.count or (1, 1)
        if not low <= len(parts) <= high:
            wanted = str(low) if low == high else f"{low} to {high}"
            raise InvalidInput("{0} {1} {2!r}: takes {3} value{4}", where, self.name, value, wanted, "s" * (high > 1))
        values = tuple(self._read_value(part, where) for part in parts)
        return values if self.count else values[0]

    def _read_value(self, part: Any, where: str) -> Any:
        readers: dict[Callable[[str], Any], Callable[[str], Any]] = {float: real_number, int: integer}
        try:
            value = readers.get(self.kind, self.kind)(str(part))
        except ValueError as wrong:
            names: dict[Callable[[str], Any], str] = {
                float: "number",
                int: "whole number",
                share: "share from 0 to below 1, such as 0.6 or 60%",
                speed: "number, or auto",
            }
            raise InvalidInput("{0} {1} {2!r}: must be a {3}", where, self.name, part, names[self.kind]) from wrong
        if self.choices and value not in self.choices:
            raise InvalidInput("{0} {1} {2!r}: must be one of {3}", where, self.name, part, ", ".join(self.choices))
        return value


def _read_flag(value: Any, what: str) -> bool:
    if isinstance(value, bool):
        return value
    words = {
        **dict.fromkeys(("1", "true", "yes", "on"), True),
        **dict.fromkeys(("0", "false", "no", "off"), False),
    }
    if str(value).lower() not in words:
        raise InvalidInput("{0} {1!r}: must be true or false", what, value)
    return words[str(value).lower()]


def _fields(*parts: type, but: tuple[str, ...] = ()) -> tuple[Option, ...]:
    """Options of the fields of parts, except ``but``."""
    return tuple(Option.from_field(field) for part in parts for field in declared_fields(part) if field.name not in but)


def _image_px() -> Option:
    """Option of the image's longer side, which the camera sets by default."""
    option = next(one for one in _fields(Pixels) if one.name == "image_px")
    return replace(option, default=None, about=f"{option.about}; default {option.default}")


def _lens() -> Iterator[Option]:
    """Options of the lens, which a camera by name may have set."""
    for option in _fields(Lens, but=("fov_deg", "aspect_ratio")):
        yield replace(option, default=None, about="; ".join(filter(None, (option.about, f"default {option.default}"))))


def _flight() -> Iterator[Option]:
    """Options of the flight, of which the airspeed may be ``auto``."""
    for option in _fields(Flight, but=("agl_m", "overlap_along", "overlap_across")):
        if option.name == "airspeed":
            more = "auto is the greatest that the camera's interval and the motion blur allow, up to 15 m/s"
            yield replace(option, kind=speed, help=f"{option.help}; {more}")
        else:
            yield option


#: All options that state a mission, in the order of help.
OPTIONS: tuple[Option, ...] = (
    Option(
        "preset",
        str,
        None,
        "values that suit a purpose; any other option overrides them",
        choices=PRESET_NAMES,
    ),
    Option(
        "camera_kind",
        str,
        None,
        "effects of a kind of camera; any other option overrides them",
        choices=tuple(kind.name for kind in CAMERA_KINDS),
    ),
    Option(
        "coords",
        str,
        None,
        "lat_lon_agl, latTL_lonTL_latBR_lonBR_agl, a file of lat lon agl [yaw] lines, or a table with a header "
        "(lat lon agl yaw tilt roll time)",
    ),
    Option(
        "area",
        str,
        None,
        "GeoJSON, KML or KMZ file, with --agl, instead of --coords: its polygons form one area, with separate rows",
        metavar="FILE",
    ),
    Option(
        "no_fly",
        str,
        None,
        "GeoJSON, KML or KMZ file of polygons where no camera may stand: images planned inside are left out",
        metavar="FILE",
    ),
    Option("agl", float, None, "height above ground of --area; elsewhere it replaces the coordinates' height"),
    Option("agl_unit", str, "m", "unit of the heights given", choices=tuple(LENGTHS_M)),
    Option("mission", str, None, "kind of mission; inferred from the coordinates if left out", choices=KINDS),
    Option("camera", str, None, "camera by name (see terrainav cameras) instead of --fov and --aspect-ratio"),
    Option("fov", float, None, f"diagonal field of view in degrees ({Lens.fov_deg})"),
    Option("hfov", float, None, "horizontal field of view in degrees, instead of --fov"),
    Option("vfov", float, None, "vertical field of view in degrees, instead of --fov"),
    Option(
        "sensor",
        float,
        None,
        "width and height of the sensor in mm, with --focal-length, instead of --fov",
        count=(2, 2),
        metavar=("W", "H"),
    ),
    Option("focal_length", float, None, "real focal length of the lens in mm, with --sensor"),
    Option("aspect_ratio", float, None, "width and height of the image (4 3)", count=(2, 2), metavar=("W", "H")),
    *_lens(),
    *_fields(Attitude),
    Option(
        "overlap",
        share,
        (Flight.overlap_along,),
        "front overlap, and side overlap where that is another: share of an image that the next one of its row, and "
        "the next row, shows again; from 0 to below 1, or with a percent sign",
        count=(1, 2),
        metavar=("FRONT", "SIDE"),
    ),
    *_flight(),
    Option(
        "wind",
        float,
        None,
        "wind that moves and turns the captures: mean speed in m/s, azimuth it blows from in degrees, turbulence "
        "(gusts over mean speed)",
        count=(3, 3),
        metavar=("SPEED", "FROM", "TURBULENCE"),
    ),
    *_fields(Imagery),
    _image_px(),
    *_fields(Pixels, but=("image_px",)),
    *_fields(Accuracy, Terrain, Route, PixelLabels, *(FLAT_PARTS[part] for part in REALISM_PARTS), Output),
    Option(
        "dataset",
        str,
        "TerrAInav",
        "layout of a dataset to read; plan and capture always write TerrAInav's",
        choices=("TerrAInav", "VBN"),
    ),
    Option("batch_size", int, 8, "images in a batch of a loaded dataset; plan and capture do not use it"),
    Option("data_dir", str, "datasets/terrainav", "folder the dataset is written to"),
    Option("connections", int, 8, "simultaneous requests"),
    Option(
        "placeholder",
        str,
        None,
        "SHA-256 (16 or more of its digits) of tiles to treat as missing, as a capture names them that has found the "
        "same tile in many places; with --resume, images that show them are made again",
        count=(1, 100),
    ),
    Option("cache_dir", str, None, "folder of the cache of tiles (terrainav cache list shows it)", metavar="DIR"),
    Option("cache_limit", int, None, "largest size of the cache, in MB", metavar="MB"),
    Option("no_cache", str, False, "do not use the cache of tiles", flag=True),
)


#: Options that state how to run a mission, and that may be given beside a mission file.
RUN_OPTIONS = (
    *("dataset", "batch_size", "data_dir", "connections", "placeholder"),
    *("cache_dir", "cache_limit", "no_cache"),
)
