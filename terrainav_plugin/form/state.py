"""The dock's entries as one plain value. Knows no widget and no mission."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from ...core.errors import InvalidInput
from ...core.safe_json import parse_json
from ..units import M_PER_FT

#: What a camera may be given by.
FOV_MODES = DIAGONAL, HORIZONTAL, VERTICAL, SENSOR = ("diagonal", "horizontal", "vertical", "sensor")
#: What the source chooser holds instead of a catalogue entry's name.
URL_TEMPLATE = "url-template"
#: Of whatever is random, where a mission says nothing else.
SEED = 2024
#: Width, height and channels of a picture.
_SIZE_PARTS = 3
BOX_FIELDS = ("north", "west", "south", "east")


@dataclass(frozen=True)
class FormState:
    """What the dock shows, as typed: texts where people type freely, numbers where a spin box guards them.

    Parameters
    ----------
    north, west, south, east : str
        Edges of the area in degrees; of the box around it where it is no box.
    shape : str
        JSON of a polygon's or points' area; empty for a box.
    fov_deg : float
        Diagonal field of view, however it was given.
    fov_mode : str
        What the camera is given by, one of `FOV_MODES`.
    fov_typed_deg : float
        Horizontal or vertical field of view as typed, where the camera is given by it; otherwise 0.
    focal_length_mm, sensor_width_mm, sensor_height_mm : float
        As typed, where the camera is given by its sensor; otherwise 0.
    aspect : str
        Width over height, as ``4:3`` or as a number.
    image_px : int
        Pixels along the longer side of the camera's image.
    agl : float
        Height above ground, in ``agl_unit`` (m or ft).
    agl_unit : str
        Also the unit that other lengths are shown in.
    height_by : str
        What the height follows from: itself (``agl``), or the camera's ground sample distance (``gsd``).
    camera_gsd : float
        Wanted ground sample distance of the camera in cm, or in inches with feet, where the height follows from it;
        otherwise 0.
    overlap_along, overlap_across : float
        Shares of a picture, 0 to 1, along the flight line (front) and between lines (side).
    grid_angle_deg, crosshatch, order, airspeed_m_per_s, start
        As a mission has them.
    resolution : str
        What the source's pixels are chosen by: ``auto``, ``zoom`` or ``gsd``.
    zoom, gsd_m_per_px, upsample
        As a mission has them; the first two count where ``resolution`` says so.
    max_px : int
        Limit of a picture's longest side; 0 for none.
    resize : bool
        Whether pictures are resized to the size described by the next three.
    resize_width_px, resize_height_px : int
    resize_grey : bool
    source : str
        Name of a source, or `URL_TEMPLATE`, for which ``template`` holds the template.
    date : str
        Of the imagery; empty for the source's own default.
    yaw_deg, tilt_deg, roll_deg, ground_height_m : float
        Attitude of the camera, and height of the ground above the ellipsoid.
    error_budget_px, accept_error, frame, resampling
        As a mission has them.
    wind : bool
        Whether the wind described by the next three blows.
    wind_speed_m_per_s, wind_from_deg, turbulence : float
    more : str
        JSON of what a mission says beyond the entries; empty for nothing.
    hidden : tuple of str
        Entries that the choices made leave out of sight: they keep what was typed, and nobody asks for it.
    """

    north: str = ""
    west: str = ""
    south: str = ""
    east: str = ""
    shape: str = ""
    fov_deg: float = 78.8
    fov_mode: str = DIAGONAL
    fov_typed_deg: float = 0.0
    focal_length_mm: float = 0.0
    sensor_width_mm: float = 0.0
    sensor_height_mm: float = 0.0
    aspect: str = "4:3"
    image_px: int = 640
    agl: float = 120.0
    agl_unit: str = "m"
    height_by: str = "agl"
    camera_gsd: float = 0.0
    overlap_along: float = 0.0
    overlap_across: float = 0.0
    layout: str = "cover"
    grid_angle_deg: float = 0.0
    crosshatch: bool = False
    order: str = "serpentine"
    airspeed_m_per_s: float = 15.0
    start: str = "2000-01-01T00:00:00Z"
    resolution: str = "auto"
    zoom: int = 18
    gsd_m_per_px: float = 0.5
    upsample: bool = False
    max_px: int = 0
    resize: bool = False
    resize_width_px: int = 640
    resize_height_px: int = 480
    resize_grey: bool = False
    map_types: tuple[str, ...] = ("satellite",)
    source: str = "world"
    template: str = ""
    date: str = ""
    image_format: str = "tif"
    folder: str = ""
    yaw_deg: float = 0.0
    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    ground_height_m: float = 0.0
    error_budget_px: float = 0.1
    accept_error: bool = False
    frame: str = "auto"
    resampling: str = "bilinear"
    wind: bool = False
    wind_speed_m_per_s: float = 5.0
    wind_from_deg: float = 270.0
    turbulence: float = 0.1
    more: str = ""
    hidden: tuple[str, ...] = field(default=(), compare=False)

    @property
    def agl_m(self) -> float:
        """Height above ground in metres."""
        return in_metres(self.agl, M_PER_FT) if self.agl_unit == "ft" else self.agl

    @property
    def source_name(self) -> str:
        """What the mission names its source by."""
        return self.template.strip() if self.source == URL_TEMPLATE else self.source

    @property
    def has_box(self) -> bool:
        """Whether an area has been entered."""
        return all(getattr(self, name).strip() for name in BOX_FIELDS)

    @property
    def asked_for(self) -> FormState:
        """State with the usual in place of what is hidden."""
        usual = asdict(FormState())
        return replace(self, **{name: usual[name] for name in self.hidden if name in usual})

    @property
    def beyond_entries(self) -> dict[str, Any]:
        """What ``more`` holds, by the names of a mission file."""
        try:
            data = parse_json(self.more) if self.more else {}
        except InvalidInput:
            return {}
        return data if isinstance(data, dict) else {}

    @property
    def seed(self) -> int:
        """Seed of the mission."""
        seed = self.beyond_entries.get("seed", SEED)
        return seed if isinstance(seed, int) else SEED

    def to_json(self) -> str:
        """Text for the settings."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> FormState:
        """State from what `to_json` gave, also long ago; entries that no longer fit keep their defaults."""
        try:
            data = parse_json(text) if text else {}
        except InvalidInput:
            data = {}
        data = _with_later_entries(data) if isinstance(data, dict) else {}
        state = cls()
        for entry in fields(cls):
            value = data.get(entry.name)
            default = getattr(state, entry.name)
            if isinstance(default, tuple) and isinstance(value, list):
                value = tuple(str(item) for item in value)
            if type(value) is type(default):
                state = replace(state, **{entry.name: value})
        return state


def in_metres(count: float, unit_m: float) -> float:
    """Metres of so many units: to 15 digits, so that what was in metres first comes back as it was."""
    return float(f"{count * unit_m:.15g}")


def _with_later_entries(data: dict[str, Any]) -> dict[str, Any]:
    """Saved entries, with those taken out of ``more`` that the dock has had no entries for in its first version.

    The longest side of before there was an image's size was that size, also where nobody had changed it: as a limit it
    would be one that nobody has asked for.
    """
    try:
        more = parse_json(data.get("more") or "{}")
    except (InvalidInput, TypeError):
        return data
    if not isinstance(more, dict):
        return data
    found = {name: more.pop(name) for name in ("max_px", "upsample", "zoom", "gsd_m_per_px") if name in more}
    if "image_px" not in data:
        found["image_px"] = found.get("max_px", data.get("max_px"))
        found["max_px"] = 0
    for name, way in (("zoom", "zoom"), ("gsd_m_per_px", "gsd")):
        if found.get(name) is not None:
            found["resolution"] = way
    size = more.pop("img_size", None)
    if isinstance(size, list) and len(size) == _SIZE_PARTS:
        found.update(resize=True, resize_width_px=size[0], resize_height_px=size[1], resize_grey=size[2] == 1)
    return {**data, **found, "more": json.dumps(more) if more else ""}


def with_unchanged(read: FormState, shown: FormState, given: FormState) -> FormState:
    """State read from widgets, with what was given to them where they still show it.

    Spin boxes round to their decimals, and boxes to tick have one order: without this, a mission that is only
    looked at would come out changed.

    Parameters
    ----------
    read, shown : FormState
        What the widgets say now, and said when ``given`` had been entered.
    """
    kept = {
        entry.name: getattr(given, entry.name)
        for entry in fields(FormState)
        if isinstance(getattr(read, entry.name), float)
        and getattr(read, entry.name) == getattr(shown, entry.name)
    }
    if set(read.map_types) == set(given.map_types):
        kept["map_types"] = given.map_types
    return replace(read, **kept)
