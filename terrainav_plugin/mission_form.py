"""The dock's entries as plain values, and the mission they ask for. Knows no widget."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from .i18n import tr

if TYPE_CHECKING:
    from ..core.mission.area import Area, Box
    from ..core.mission.mission import Mission

#: International foot.
M_PER_FT = 0.3048
#: What the source chooser holds instead of a catalogue entry's name.
URL_TEMPLATE = "url-template"
#: Of the embedded world's landscape.
SEED = 2024
BOX_FIELDS = ("north", "west", "south", "east")
_SEPARATORS = re.compile(r"[_,;\s]+")


class FormError(Exception):
    """Entries that make no mission: a message for every field that is wrong."""

    def __init__(self, messages: dict[str, str]) -> None:
        super().__init__("; ".join(messages.values()))
        self.messages = messages


@dataclass(frozen=True)
class FormState:
    """What the dock shows, as typed: texts where people type freely, numbers where a spin box guards them.

    Parameters
    ----------
    north, west, south, east : str
        Edges of the area in degrees.
    fov_deg : float
        Diagonal field of view.
    aspect : str
        Width over height, as ``4:3`` or as a number.
    agl : float
        Height above ground, in ``agl_unit`` (m or ft).
    overlap_along_percent, overlap_across_percent : float
    source : str
        Name of a catalogue entry, or `URL_TEMPLATE`, for which ``template`` holds the template.
    """

    north: str = ""
    west: str = ""
    south: str = ""
    east: str = ""
    fov_deg: float = 78.8
    aspect: str = "4:3"
    agl: float = 120.0
    agl_unit: str = "m"
    overlap_along_percent: float = 0.0
    overlap_across_percent: float = 0.0
    layout: str = "cover"
    map_types: tuple[str, ...] = ("satellite",)
    source: str = "world"
    template: str = ""
    image_format: str = "tif"
    folder: str = ""

    @property
    def agl_m(self) -> float:
        """Height above ground in metres."""
        return self.agl * (M_PER_FT if self.agl_unit == "ft" else 1.0)

    @property
    def source_name(self) -> str:
        """What the mission names its source by."""
        return self.template.strip() if self.source == URL_TEMPLATE else self.source

    @property
    def has_box(self) -> bool:
        """Whether an area has been entered."""
        return all(getattr(self, name).strip() for name in BOX_FIELDS)

    def to_json(self) -> str:
        """Text for the settings."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> FormState:
        """State from what `to_json` gave; entries that no longer fit keep their defaults."""
        try:
            data = json.loads(text) if text else {}
        except json.JSONDecodeError:
            data = {}
        state = cls()
        for entry in fields(cls):
            value = data.get(entry.name) if isinstance(data, dict) else None
            default = getattr(state, entry.name)
            if isinstance(default, tuple) and isinstance(value, list):
                value = tuple(str(item) for item in value)
            if type(value) is type(default):
                state = replace(state, **{entry.name: value})
        return state


def parse_number(text: str) -> float:
    """Read a number as people type it: Unicode minus, degree sign and hemisphere letters are understood.

    Raises
    ------
    ValueError
        Where there is no number.
    """
    plain = text.strip().replace("\u2212", "-").rstrip("°").strip()
    sign = 1.0
    if plain and plain[-1:].upper() in "NESW":
        sign = -1.0 if plain[-1].upper() in "SW" else 1.0
        plain = plain[:-1].rstrip().rstrip("°")
    if "," in plain and "." not in plain:
        plain = plain.replace(",", ".")
    value = float(plain)
    if not math.isfinite(value):
        raise ValueError(text)
    return sign * value


def parse_aspect(text: str) -> float:
    """Width over height from ``4:3``, ``4/3``, ``4000x3000`` or ``1.333``; raises ValueError otherwise."""
    for separator in (":", "/", "x", "×"):
        if separator in text:
            width, height = (parse_number(part) for part in text.split(separator, 1))
            if height == 0.0:
                raise ValueError(text)
            return width / height
    return parse_number(text)


def aspect_text(ratio: float) -> str:
    """Shortest text that `parse_aspect` reads back as ``ratio``."""
    if not (math.isfinite(ratio) and ratio > 0.0):
        return repr(ratio)
    fraction = Fraction(ratio).limit_denominator(10_000)
    if fraction.denominator and fraction.numerator / fraction.denominator == ratio:
        return f"{fraction.numerator}:{fraction.denominator}"
    return repr(ratio)


def degrees_text(value: float, decimals: int = 7) -> str:
    """Degrees without trailing zeros; 7 decimals are a centimetre on the ground."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text in ("", "-0") else text


def with_box(state: FormState, box: Box) -> FormState:
    """State with the edges of ``box``."""
    return replace(
        state,
        north=degrees_text(box.north_deg),
        west=degrees_text(box.west_deg),
        south=degrees_text(box.south_deg),
        east=degrees_text(box.east_deg),
    )


def looks_like_coordinates(text: str) -> bool:
    """Whether a text entered into one field holds several numbers, as pasted coordinates do."""
    return len(_SEPARATORS.split(text.strip())) >= 3


def with_coordinates(state: FormState, text: str) -> FormState:
    """State with pasted coordinates: ``north_west_south_east_agl``, the height in the state's unit.

    Commas and spaces do as well as underscores, and the height may be left out.

    Raises
    ------
    FormError
        For the field ``north``, with what is wrong.
    """
    from ..core.errors import TerrAInavError
    from ..core.mission.area import Box
    from ..core.mission.coords import parse_coords

    parts = _SEPARATORS.split(text.strip())
    if len(parts) == len(BOX_FIELDS):
        parts.append(repr(state.agl))
    try:
        area, agl = parse_coords("_".join(parts))
    except TerrAInavError as wrong:
        raise FormError({"north": str(wrong)}) from wrong
    if not isinstance(area, Box):
        where = tr("“{text}” is a point: the area needs north_west_south_east_agl")
        raise FormError({"north": where.format(text=text.strip())})
    return replace(with_box(state, area), agl=agl)


class _Checks:
    """Runs the core's own checks field by field and keeps their messages."""

    def __init__(self) -> None:
        self.messages: dict[str, str] = {}

    def __call__(self, field: str, check: Callable[[], Any]) -> Any:
        from ..core.errors import TerrAInavError

        try:
            return check()
        except TerrAInavError as wrong:
            self.messages.setdefault(field, str(wrong))
        return None

    def number(self, field: str, what: str, text: str, parse: Callable[[str], float]) -> float | None:
        try:
            return parse(text)
        except ValueError:
            self.messages[field] = tr("{what} “{text}”: must be a number").format(
                what=what, text=text.strip()
            )
        return None


def mission(state: FormState) -> Mission:
    """Mission that a state asks for.

    Raises
    ------
    FormError
        With the core's message at every field that is wrong.
    """
    checks = _Checks()
    return _mission(state, _box(state, checks), checks)


def test_shot(state: FormState, lat_deg: float, lon_deg: float) -> Mission:
    """Mission of one picture above a point, otherwise as entered; raises FormError as `mission` does."""
    from ..core.mission.area import Points

    checks = _Checks()
    single = replace(state, map_types=state.map_types[:1])
    return _mission(single, checks("agl", lambda: Points(((lat_deg, lon_deg, state.agl_m),))), checks)


def box(state: FormState) -> Box | None:
    """Area that a state holds; None where it holds no sound one."""
    return _box(state, _Checks()) if state.has_box else None


def with_folder(state: FormState, folder: str) -> FormState:
    """State with another folder."""
    return replace(state, folder=folder)


def _mission(state: FormState, area: Area | None, checks: _Checks) -> Mission:
    from ..core.mission.area import Box, check_agl
    from ..core.mission.mission import Mission

    camera = _camera(state, checks)
    checks("agl", lambda: check_agl(state.agl_m))
    entries: dict[str, Any] = {
        "overlap_along": state.overlap_along_percent / 100.0,
        "overlap_across": state.overlap_across_percent / 100.0,
        "layout": state.layout,
        "map_types": state.map_types,
        "source": state.source_name,
        "image_format": state.image_format,
        "seed": SEED,
    }
    sound = Box(0.0, 0.0, 0.0, 0.0)
    for name, value in entries.items():
        checks(name, lambda name=name, value=value: Mission(area=sound, agl_m=1.0, **{name: value}))
    if checks.messages:
        raise FormError(checks.messages)
    return Mission(area=area, agl_m=state.agl_m, camera=camera, **entries)


def _camera(state: FormState, checks: _Checks) -> Any:
    from ..core.geodesy.camera import Camera

    checks("fov_deg", lambda: Camera(fov_deg=state.fov_deg))
    ratio = checks.number("aspect", tr("aspect ratio"), state.aspect, parse_aspect)
    if ratio is not None:
        checks("aspect", lambda: Camera(aspect_ratio=ratio))
    if "fov_deg" in checks.messages or "aspect" in checks.messages:
        return None
    return Camera(state.fov_deg, ratio)


def _box(state: FormState, checks: _Checks) -> Box | None:
    from ..core.mission.area import Box, check_lat_lon

    names = {
        "north": tr("northern edge"),
        "west": tr("western edge"),
        "south": tr("southern edge"),
        "east": tr("eastern edge"),
    }
    edges: dict[str, float] = {}
    for field, what in names.items():
        value = checks.number(field, what, getattr(state, field), parse_number)
        if value is None:
            continue
        edges[field] = value
        lat, lon = (value, 0.0) if field in ("north", "south") else (0.0, value)
        checks(field, lambda lat=lat, lon=lon: check_lat_lon(lat, lon))
    if len(edges) < len(names) or set(names) & set(checks.messages):
        return None
    return checks("south", lambda: Box(edges["north"], edges["west"], edges["south"], edges["east"]))


def state_of(mission: Mission, folder: str) -> FormState:
    """State that asks for ``mission`` again, whose area is a box; heights in metres."""
    state = FormState(
        fov_deg=mission.camera.fov_deg,
        aspect=aspect_text(mission.camera.aspect_ratio),
        agl=mission.agl_m,
        overlap_along_percent=mission.overlap_along * 100.0,
        overlap_across_percent=mission.overlap_across * 100.0,
        layout=mission.layout,
        map_types=mission.map_types,
        source=mission.source,
        image_format=mission.image_format,
        folder=folder,
    )
    if "{" in mission.source or "://" in mission.source:
        state = replace(state, source=URL_TEMPLATE, template=mission.source)
    return with_box(state, mission.area.bounds)
