"""The dock's entries as one plain value. Knows no widget and no mission."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields, replace
from typing import Any

#: International foot.
M_PER_FT = 0.3048
#: What the source chooser holds instead of a catalogue entry's name.
URL_TEMPLATE = "url-template"
#: Of whatever is random, where a mission says nothing else.
SEED = 2024
BOX_FIELDS = ("north", "west", "south", "east")


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
    overlap_along, overlap_across : float
        Shares of a picture, 0 to 1.
    source : str
        Name of a source, or `URL_TEMPLATE`, for which ``template`` holds the template.
    date : str
        Of the imagery; empty for the source's own default.
    yaw_deg, tilt_deg, roll_deg, ground_height_m : float
        Attitude of the camera, and height of the ground above the ellipsoid.
    error_budget_px, accept_error, frame, resampling
        As a mission has them.
    wind : bool
        Whether the wind described by the next four blows.
    wind_speed_m_per_s, wind_from_deg, turbulence, airspeed_m_per_s : float
    more : str
        JSON of what a mission says beyond the entries; empty for nothing.
    """

    north: str = ""
    west: str = ""
    south: str = ""
    east: str = ""
    fov_deg: float = 78.8
    aspect: str = "4:3"
    agl: float = 120.0
    agl_unit: str = "m"
    overlap_along: float = 0.0
    overlap_across: float = 0.0
    layout: str = "cover"
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
    airspeed_m_per_s: float = 15.0
    more: str = ""

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

    @property
    def beyond_entries(self) -> dict[str, Any]:
        """What ``more`` holds, by the names of a mission file."""
        try:
            data = json.loads(self.more) if self.more else {}
        except json.JSONDecodeError:
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
