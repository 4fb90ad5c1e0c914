"""The panel's entries as one plain value: the fields of a mission, some as typed. No widgets."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields, make_dataclass, replace
from typing import Any

from ...core.errors import InvalidInput
from ...core.fields import Field, declared_fields, field_named
from ...core.geodesy.lens import LENS_FIELDS, Lens
from ...core.mission.flight.wind import Wind
from ...core.mission.parts import FLAT_PARTS, Flight, Imagery, Pixels, Route
from ...core.text.safe_json import parse_json
from ...core.units import LENGTHS_M
from .text import aspect_text

#: Modes of describing the camera.
FOV_MODES = DIAGONAL, HORIZONTAL, VERTICAL, SENSOR = ("diagonal", "horizontal", "vertical", "sensor")
#: Value of the source chooser other than a catalogue entry's name.
URL_TEMPLATE = "url-template"
BOX_FIELDS = ("north", "west", "south", "east")
#: Fields of a mission whose entries differ from them: typed in a unit, after a choice, or as several entries.
_ENTERED_OTHERWISE = ("agl_m", "zoom", "gsd_m_per_px", "img_size", "takeoff", "imageries")
#: The other fields of a mission: their entries have the same name, value and default.
ENTERED_AS_DECLARED: dict[str, Field] = {
    one.name: one for part in FLAT_PARTS.values() for one in declared_fields(part) if one.name not in _ENTERED_OTHERWISE
}
ENTERED_AS_DECLARED.update((name, field_named(Lens, name)) for name in LENS_FIELDS)
#: Fields in `ENTERED_AS_DECLARED` without widgets: the panel keeps the values of a mission, and shows a note.
WITHOUT_ENTRY = ("mesh", "seed", "max_images")
#: Field of a mission for each entry: same names, entries that differ, and entries of the wind.
DECLARED: dict[str, Field] = {
    **ENTERED_AS_DECLARED,
    "agl": field_named(Flight, "agl_m"),
    "zoom": field_named(Pixels, "zoom"),
    "gsd_m_per_px": field_named(Pixels, "gsd_m_per_px"),
    "takeoff": field_named(Route, "takeoff"),
    "imageries": field_named(Imagery, "imageries"),
    "fov_deg": field_named(Lens, "fov_deg"),
    "wind_speed_m_per_s": field_named(Wind, "speed_m_per_s"),
    "wind_from_deg": field_named(Wind, "from_deg"),
    "turbulence": field_named(Wind, "turbulence"),
}

_Asked: Any = make_dataclass(
    "_Asked",
    [(one.name, one.kind, field(default=one.default)) for one in ENTERED_AS_DECLARED.values()],
    frozen=True,
)


@dataclass(frozen=True)
class FormState(_Asked):
    """The panel's entries as typed: texts for free entries, numbers for spin boxes.

    The fields in `ENTERED_AS_DECLARED` are inherited; the following are added.

    Parameters
    ----------
    north, west, south, east : str
        Edges of the area in degrees; of its bounding box if it is not a box.
    shape : str
        JSON of an area of polygons or points; empty for a box.
    no_fly : str
        JSON of the no-fly areas; empty for none.
    fov_deg : float
        Diagonal field of view, whatever the mode.
    fov_mode : str
        Mode of describing the camera, one of `FOV_MODES`.
    fov_typed_deg : float
        Horizontal or vertical field of view as typed, in the mode of that name; otherwise 0.
    focal_length_mm, sensor_width_mm, sensor_height_mm : float
        As typed, in sensor mode; otherwise 0.
    aspect : str
        Width over height, as ``4:3`` or as a number.
    agl : float
        Height above ground, in ``agl_unit`` (m or ft).
    agl_unit : str
        Unit of the height and of all other lengths.
    height_by : str
        Entry that determines the height: the height (``agl``), or the camera's ground sample distance (``gsd``).
    camera_gsd : float
        Ground sample distance of the camera in cm, or in inches with feet, if it determines the height; otherwise 0.
    resolution : str
        Entry that determines the resolution of the source's pixels: ``auto``, ``zoom`` or ``gsd``.
    zoom, gsd_m_per_px
        As in a mission; used if ``resolution`` is ``zoom`` or ``gsd``.
    resize : bool
        Whether to resize images to the size below.
    resize_width_px, resize_height_px : int
    resize_grey : bool
    template : str
        URL template, if ``source`` is `URL_TEMPLATE`.
    imageries : tuple of str
        Imageries captured besides that of ``source``, ``date`` and ``map_types``, as in a mission.
    imagery_name : str
        Name of the latter, if there are several; empty for one that follows from its source.
    takeoff : str
        Latitude and longitude of the take-off point; empty for none.
    folder : str
    wind : bool
        Whether there is wind; the following fields describe it.
    wind_speed_m_per_s, wind_from_deg, turbulence : float
    wind_seed : int or None
        Seed of the gusts; None for the mission's.
    hidden : tuple of str
        Names of hidden entries, which keep their values; `effective` replaces them by defaults.
    unread : tuple of (str, str)
        Name and text of each number's entry with an invalid text; the state keeps its last valid number.
    """

    north: str = ""
    west: str = ""
    south: str = ""
    east: str = ""
    shape: str = ""
    no_fly: str = ""
    fov_deg: float = Lens.fov_deg
    fov_mode: str = DIAGONAL
    fov_typed_deg: float = 0.0
    focal_length_mm: float = 0.0
    sensor_width_mm: float = 0.0
    sensor_height_mm: float = 0.0
    aspect: str = aspect_text(Lens.aspect_ratio)
    agl: float = DECLARED["agl"].initial_value
    agl_unit: str = "m"
    height_by: str = "agl"
    camera_gsd: float = 0.0
    resolution: str = "auto"
    zoom: int = DECLARED["zoom"].initial_value
    gsd_m_per_px: float = DECLARED["gsd_m_per_px"].initial_value
    resize: bool = False
    resize_width_px: int = 640
    resize_height_px: int = 480
    resize_grey: bool = False
    template: str = ""
    imageries: tuple[str, ...] = ()
    imagery_name: str = ""
    takeoff: str = ""
    folder: str = ""
    wind: bool = False
    wind_speed_m_per_s: float = DECLARED["wind_speed_m_per_s"].initial_value
    wind_from_deg: float = DECLARED["wind_from_deg"].initial_value
    turbulence: float = DECLARED["turbulence"].initial_value
    wind_seed: int | None = None
    hidden: tuple[str, ...] = field(default=(), compare=False)
    unread: tuple[tuple[str, str], ...] = field(default=(), compare=False)

    @property
    def agl_m(self) -> float:
        """Height above ground in metres."""
        return in_metres(self.agl, LENGTHS_M[self.agl_unit])

    @property
    def source_name(self) -> str:
        """Name of the source in the mission."""
        return self.template.strip() if self.source == URL_TEMPLATE else self.source

    @property
    def has_box(self) -> bool:
        """Whether a box has been entered."""
        return all(getattr(self, name).strip() for name in BOX_FIELDS)

    @property
    def effective(self) -> FormState:
        """State with defaults in place of the values of hidden entries."""
        usual = asdict(FormState())
        return replace(self, **{name: usual[name] for name in self.hidden if name in usual})

    def to_json(self) -> str:
        """JSON for the settings."""
        return json.dumps(asdict(replace(self, unread=())))

    @classmethod
    def from_json(cls, text: str) -> FormState:
        """State from the text of `to_json`; unknown names and values of a wrong type are ignored."""
        try:
            data = parse_json(text) if text else {}
        except InvalidInput:
            data = {}
        state = cls()
        for entry in fields(cls):
            value = data.get(entry.name) if isinstance(data, dict) else None
            default = getattr(state, entry.name)
            if isinstance(default, tuple) and isinstance(value, list):
                value = tuple(str(item) for item in value)
            if any("\0" in text for text in (value if isinstance(value, tuple) else (value,)) if isinstance(text, str)):
                # No file, source or place contains it.
                continue
            if type(value) is type(default) or (default is None and type(value) in (int, float)):
                state = replace(state, **{entry.name: value})
        return state


def in_metres(count: float, unit_m: float) -> float:
    """Convert ``count`` units to metres, rounded to 15 digits so that metres survive a conversion and back."""
    return float(f"{count * unit_m:.15g}")


def keep_unchanged(read: FormState, shown: FormState, given: FormState) -> FormState:
    """State read from widgets, with the exact value from ``given`` in each field that the user has not changed.

    Spin boxes round to their decimals, and check boxes have a fixed order: without this, displaying a mission would
    change it.

    Parameters
    ----------
    read, shown : FormState
        State read from the widgets now, and right after ``given`` was entered into them.
    """
    kept = {
        entry.name: getattr(given, entry.name)
        for entry in fields(FormState)
        if isinstance(getattr(read, entry.name), float) and getattr(read, entry.name) == getattr(shown, entry.name)
    }
    if set(read.map_types) == set(given.map_types):
        kept["map_types"] = given.map_types
    return replace(read, **kept)
