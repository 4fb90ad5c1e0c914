"""The mission: everything the user asks for, as one frozen value, in and out of JSON."""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import MISSING, asdict, dataclass, field, fields, replace
from datetime import datetime, timezone
from typing import Any, TypeVar

from ..errors import InvalidInput, Message
from ..files import read_limited, write_whole
from ..geodesy.camera import Camera
from ..limits import MAX_MISSION_BYTES, MAX_PICTURE_PX, MAX_PICTURE_SIDE_PX, MAX_WHOLE_NUMBER
from ..safe_json import decoded, parse_json
from .area import Area, Box, Points, Polygon, check_agl
from .options import (
    AUTO,
    DEFAULT_AIRSPEED_M_PER_S,
    DEFAULT_BUDGET_PX,
    DEFAULT_IMAGE_PX,
    DEFAULT_MAX_IMAGES,
    DEFAULT_START,
    FORMATS,
    FRAMES,
    LAYOUTS,
    MAP_TYPES,
    ORDERS,
    PAPER_MAX_PX,
    RAYS,
    RESAMPLINGS,
    SERPENTINE,
)
from .wind import Wind, check_airspeed

_Part = TypeVar("_Part", Box, Camera, Wind)
#: Version of the mission file; readers accept this one and refuse newer ones.
SCHEMA = 1
#: Ground lies between these, metres: the shore of the Dead Sea and Everest, with room for geoid and lakes' beds.
LOWEST_GROUND_M, HIGHEST_GROUND_M = 12_000.0, 9_000.0

#: Footprints that mission files of version 0.1 name; the first two were cheaper than those of the exact camera.
_CHEAP_FOOTPRINTS = ("loc1", "loc2")
_OLD_FOOTPRINTS = (*_CHEAP_FOOTPRINTS, "exact", AUTO, None)
#: Meshes by their tolerance, as mission files of version 0.1 name them.
_OLD_MESH = re.compile(r"mesh-[0-9.]+px")

#: Fields that are real numbers.
_REAL = (
    *("agl_m", "overlap_along", "overlap_across", "gsd_m_per_px", "error_budget_px"),
    *("yaw_deg", "tilt_deg", "roll_deg", "ground_height_m", "grid_angle_deg", "airspeed_m_per_s"),
)

#: UTC as ISO 8601 writes it: to the second, or with up to six decimals of one.
_UTC = re.compile(r"[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\.[0-9]{1,6})?Z")


def utc_time(text: str) -> datetime:
    """Time of an ISO 8601 text in UTC, such as 2024-06-21T10:30:00Z; with the time zone UTC.

    Raises
    ------
    InvalidInput
        Another form, or a day or an hour that is not.
    """
    if _UTC.fullmatch(text):
        form = "%Y-%m-%dT%H:%M:%S.%fZ" if "." in text else "%Y-%m-%dT%H:%M:%SZ"
        try:
            return datetime.strptime(text, form).replace(tzinfo=timezone.utc)
        except ValueError as wrong:
            raise InvalidInput("start {0!r}: no such time ({1})", text, wrong, field="start") from wrong
    raise InvalidInput("start {0!r}: must be UTC as 2024-06-21T10:30:00Z", text, field="start")


def _choice(what: str, value: str, choices: tuple[str, ...]) -> None:
    if value not in choices:
        raise InvalidInput("{0} {1!r}: must be one of {2}", what, value, ", ".join(choices))


@dataclass(frozen=True)
class Mission:
    """What the user asks for.

    Parameters
    ----------
    area : Box, Polygon or Points
        Ground to cover, or the points to capture (which carry their own heights).
    agl_m : float
        Height above ground in metres, > 0; of the first point where the area is Points.
    camera : Camera
    overlap_along, overlap_across : float
        Share of a picture that the next one of its row, and of the next row, shows again, in [0, 1).
    layout : str
        ``cover`` (rows that leave nothing out) or ``paper`` (a UTM grid as published).
    grid_angle_deg : float
        By which an area's rows are turned clockwise from east, -180..180; the pictures turn with them. Points have no
        rows.
    crosshatch : bool
        Whether an area is flown a second time, in rows across the first ones, the pictures turned with them.
    order : str
        ``serpentine`` (rows to and fro) or ``one-way`` (each from its beginning).
    map_types : tuple of str
        Of satellite, roadmap, terrain.
    source : str
        Name of a source, a URL template, or a file.
    zoom : int or None
        Fixed zoom; None for the one whose pixels come nearest to the camera's.
    gsd_m_per_px : float or None
        Wanted ground sample distance of the source, instead of a zoom.
    image_px : int
        Pixels along the longer side of the camera's image, >= 1.
    max_px : int or None
        Limit of a picture's longest side in 256 px terms: where one would be larger, a lower zoom is taken for all.
        None for no limit but the source's, and the paper's in its layout.
    upsample : bool
        Whether zooms above the source's native one may be chosen.
    image_format : str
        tif, jpg or png.
    img_size : tuple (width, height, channels) or None
        Size pictures are resized to, and 1 (grey) or 3 (colour) channels.
    seed : int
        Of whatever is random: the embedded world's landscape, later the splits of a dataset.
    max_images : int
        More pictures than this are refused before memory is taken.
    yaw_deg, tilt_deg, roll_deg : float
        Attitude of every capture, as in `Camera.rays_enu`; tilt 0 looks straight down. The yaw counts from the rows'
        own north where those are turned, and gives way to the points' own yaws.
    ground_height_m : float
        Height of the ground over the WGS84 ellipsoid.
    error_budget_px : float
        What the bounds of the stages' errors may sum to, > 0.
    accept_error : bool
        Go on where no methods fit the budget.
    frame : str
        ``map``, ``camera``, or ``auto`` for the cheapest that fits.
    mesh : str
        ``rays`` for a ray for every pixel of a camera frame, ``auto`` for a mesh where one fits.
    resampling : str
        Of camera frames: nearest, bilinear, bicubic or lanczos.
    wind : Wind or None
        What moves the captures off their places; None for still air, which costs nothing.
    date : str
        Of the imagery, as the source writes it; empty for the source's default.
    airspeed_m_per_s : float
        Flight speed through the air, 0.1..340 m/s.
    start : str
        Time of the first exposure, ISO 8601 in UTC.
    notes : tuple of str
        What a mission file asked for that this version does not have, and why; no part of the mission.
    """

    area: Area
    agl_m: float
    camera: Camera = field(default_factory=Camera)
    overlap_along: float = 0.0
    overlap_across: float = 0.0
    layout: str = "cover"
    map_types: tuple[str, ...] = ("satellite",)
    source: str = "world"
    zoom: int | None = None
    gsd_m_per_px: float | None = None
    image_px: int = DEFAULT_IMAGE_PX
    max_px: int | None = None
    upsample: bool = False
    image_format: str = "tif"
    img_size: tuple[int, int, int] | None = None
    seed: int = 2024
    max_images: int = DEFAULT_MAX_IMAGES
    yaw_deg: float = 0.0
    tilt_deg: float = 0.0
    roll_deg: float = 0.0
    ground_height_m: float = 0.0
    error_budget_px: float = DEFAULT_BUDGET_PX
    accept_error: bool = False
    frame: str = AUTO
    mesh: str = AUTO
    resampling: str = "bilinear"
    wind: Wind | None = None
    date: str = ""
    grid_angle_deg: float = 0.0
    crosshatch: bool = False
    order: str = SERPENTINE
    airspeed_m_per_s: float = DEFAULT_AIRSPEED_M_PER_S
    start: str = DEFAULT_START
    notes: tuple[str, ...] = field(default=(), compare=False, repr=False)

    def __post_init__(self) -> None:
        check_agl(self.agl_m)
        for name in ("overlap_along", "overlap_across"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise InvalidInput("overlap {0}: must be at least 0 and below 1", getattr(self, name))
        _choice(Message("layout"), self.layout, LAYOUTS)
        _choice(Message("order of flight"), self.order, ORDERS)
        _choice(Message("image format"), self.image_format, FORMATS)
        if not self.map_types:
            raise InvalidInput("no map type: give one or more of {0}", ", ".join(MAP_TYPES))
        for map_type in self.map_types:
            _choice(Message("map type"), map_type, MAP_TYPES)
        if len(set(self.map_types)) != len(self.map_types):
            raise InvalidInput("map types {0}: each may be named once", " ".join(self.map_types))
        if not self.source:
            raise InvalidInput("source is empty: name one, or give a URL template or a file")
        if self.date != self.date.strip() or not self.date.isprintable():
            raise InvalidInput(
                "date {0!r}: must be text without spaces around it, such as 2024-06-21", self.date
            )
        self._check_pixels()
        self._check_accuracy()
        self._check_flight()
        for name in _REAL:
            # A whole number and its float are the same mission, and the same text.
            if isinstance(getattr(self, name), int):
                object.__setattr__(self, name, float(getattr(self, name)))

    def _check_flight(self) -> None:
        if not -180.0 <= self.grid_angle_deg <= 180.0:
            raise InvalidInput(
                "grid angle {0} deg: must be from -180 to 180", self.grid_angle_deg, field="grid_angle_deg"
            )
        check_airspeed(self.airspeed_m_per_s)
        if self.wind is not None:
            self.wind.flown_at(self.airspeed_m_per_s)
        utc_time(self.start)

    def _check_accuracy(self) -> None:
        for name, what, limit in (
            ("yaw_deg", Message("yaw"), 360.0),
            ("tilt_deg", Message("tilt"), 180.0),
            ("roll_deg", Message("roll"), 180.0),
        ):
            angle = getattr(self, name)
            if not -limit <= angle <= limit:
                raise InvalidInput(
                    "{0} {1} deg: must be from {2:g} to {3:g}", what, angle, -limit, limit, field=name
                )
        if not -LOWEST_GROUND_M <= self.ground_height_m <= HIGHEST_GROUND_M:
            raise InvalidInput(
                "ground height {0} m: must be from {1:g} to {2:g}",
                self.ground_height_m,
                -LOWEST_GROUND_M,
                HIGHEST_GROUND_M,
            )
        if not (math.isfinite(self.error_budget_px) and self.error_budget_px > 0.0):
            raise InvalidInput("error budget {0} px: must be a number above 0", self.error_budget_px)
        _choice(Message("frame"), self.frame, (AUTO, *FRAMES))
        _choice(Message("mesh"), self.mesh, (AUTO, RAYS))
        _choice(Message("resampling"), self.resampling, RESAMPLINGS)

    def _check_pixels(self) -> None:
        for name in ("zoom", "image_px", "max_px", "max_images", "seed"):
            if (getattr(self, name) or 0) > MAX_WHOLE_NUMBER:
                raise InvalidInput(
                    "{0} of more than 64 bits: must be at most {1}", name, MAX_WHOLE_NUMBER, field=name
                )
        if self.zoom is not None and self.gsd_m_per_px is not None:
            raise InvalidInput(
                "zoom {0} and ground sample distance {1} m: give one of the two", self.zoom, self.gsd_m_per_px
            )
        if self.zoom is not None and self.zoom < 0:
            raise InvalidInput("zoom {0}: must be 0 or more", self.zoom)
        if self.gsd_m_per_px is not None and not (
            math.isfinite(self.gsd_m_per_px) and self.gsd_m_per_px > 0.0
        ):
            raise InvalidInput("ground sample distance {0} m: must be above 0", self.gsd_m_per_px)
        if self.image_px < 1:
            raise InvalidInput(
                "longer side of the camera's image {0} px: must be 1 or more", self.image_px, field="image_px"
            )
        if self.max_px is not None and self.max_px < 1:
            raise InvalidInput("longest side of a picture {0} px: must be 1 or more", self.max_px)
        if self.max_images < 1:
            raise InvalidInput("limit of {0} images: must be 1 or more", self.max_images)
        if self.img_size is not None:
            width, height, channels = self.img_size
            if width < 1 or height < 1 or channels not in (1, 3):
                raise InvalidInput(
                    "image size {0} {1} {2}: needs a width and a height of 1 px or more, and 1 or 3 channels",
                    width,
                    height,
                    channels,
                )
            if max(width, height) > MAX_PICTURE_SIDE_PX or width * height > MAX_PICTURE_PX:
                raise InvalidInput(
                    "image size {0} x {1} px: must be at most {2:,} px along a side and {3:,} px in all",
                    width,
                    height,
                    MAX_PICTURE_SIDE_PX,
                    MAX_PICTURE_PX,
                    field="img_size",
                )

    @property
    def limit_px(self) -> int | None:
        """Limit of a picture's longest side in 256 px terms, apart from the source's; None for none."""
        return PAPER_MAX_PX if self.max_px is None and self.layout == "paper" else self.max_px

    @property
    def kind(self) -> str:
        """``raster`` for areas, ``single`` for one point, ``list`` for several."""
        if isinstance(self.area, Points):
            return "single" if len(self.area.poses) == 1 else "list"
        return "raster"

    def with_(self, **changes: Any) -> Mission:
        """Return a copy with some fields changed, checked again."""
        return replace(self, **changes)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping, with ``schema`` and the area's ``type``."""
        plain = {
            f.name: getattr(self, f.name)
            for f in fields(self)
            if f.compare and f.name not in ("area", "camera", "wind")
        }
        area = {"type": type(self.area).__name__.lower(), **asdict(self.area)}
        wind = None if self.wind is None else asdict(self.wind)
        return {"schema": SCHEMA, "area": area, "camera": asdict(self.camera), **plain, "wind": wind}

    def to_json(self) -> str:
        """Text of the mission file: the same mission gives the same text."""
        return json.dumps(self.to_dict(), indent=1, ensure_ascii=False) + "\n"

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Mission:
        """Mission from what `to_dict` gave, or from one written by hand with defaults left out.

        Raises
        ------
        InvalidInput
            On a newer schema, an unknown field, or a value outside its domain.
        """
        data = dict(data)
        schema = data.pop("schema", None)
        if schema != SCHEMA:
            raise InvalidInput("mission schema {0!r}: this version reads schema {1}", schema, SCHEMA)
        data, notes = _without_old_methods(data)
        known = {f.name for f in fields(cls) if f.compare}
        unknown = sorted(set(data) - known)
        if unknown:
            raise InvalidInput("mission field {0!r}: not one of {1}", unknown[0], ", ".join(sorted(known)))
        # A null stands for the default, as it does where that is none.
        data = {name: value for name, value in data.items() if value is not None}
        for name in data.keys() & _JSON_TYPES.keys():
            kinds, words = _JSON_TYPES[name]
            value = data[name]
            if not isinstance(value, kinds) or isinstance(value, bool) != (kinds is bool):
                raise InvalidInput("mission field {0!r} is {1!r}: must be {2}", name, value, words)
        try:
            data["area"], data["agl_m"] = _area_from_dict(data["area"]), data["agl_m"]
            data["camera"] = _made(Camera, "camera", data.get("camera", {}))
            if "wind" in data:
                data["wind"] = _made(Wind, "wind", data["wind"])
            data["map_types"] = tuple(data.get("map_types", ("satellite",)))
            if "img_size" in data:
                data["img_size"] = tuple(data["img_size"])
            return cls(**_with_image_px(data), notes=notes)
        except KeyError as missing:
            raise InvalidInput("mission without {0}: the field is needed", missing) from missing
        except InvalidInput:
            raise
        except (TypeError, AttributeError, ValueError, IndexError, OverflowError) as wrong:
            raise InvalidInput("mission with a value of the wrong type: {0}", wrong) from wrong

    @classmethod
    def from_json(cls, text: str) -> Mission:
        """Mission from the text of a mission file; raises InvalidInput as `from_dict` does."""
        try:
            data = parse_json(text)
        except InvalidInput as wrong:
            raise InvalidInput("mission is not JSON that can be read: {0}", wrong) from wrong
        if not isinstance(data, dict):
            raise InvalidInput("mission is a JSON {0}: must be an object", type(data).__name__)
        return cls.from_dict(data)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Mission:
        """Mission from a file."""
        try:
            text = decoded(read_limited(path, MAX_MISSION_BYTES))
        except OSError as wrong:
            raise InvalidInput("mission file {0}: cannot be read ({1})", path, wrong.strerror) from wrong
        except InvalidInput as wrong:
            raise InvalidInput("mission file {0}: cannot be read ({1})", path, wrong) from wrong
        if not text.lstrip().startswith("{"):
            raise InvalidInput(
                "mission file {0}: holds no mission, which is a JSON object; a file of places is given as "
                "coordinates",
                path,
            )
        return cls.from_json(text)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the mission to a file, whole or not at all."""
        write_whole(path, self.to_json().encode())


_NUMBER: tuple[tuple[type, ...], str] = ((int, float), Message("a number"))
_WHOLE: tuple[tuple[type, ...], str] = ((int,), Message("a whole number"))
_TEXT: tuple[tuple[type, ...], str] = ((str,), Message("text"))
_LIST: tuple[tuple[type, ...], str] = ((list, tuple), Message("a list"))
#: What JSON may hold in the fields that are neither area nor camera; null stands for the default.
_JSON_TYPES: dict[str, tuple[Any, str]] = {
    "agl_m": _NUMBER,
    "overlap_along": _NUMBER,
    "overlap_across": _NUMBER,
    "layout": _TEXT,
    "map_types": _LIST,
    "source": _TEXT,
    "date": _TEXT,
    "zoom": _WHOLE,
    "gsd_m_per_px": _NUMBER,
    "image_px": _WHOLE,
    "max_px": _WHOLE,
    "upsample": (bool, Message("true or false")),
    "image_format": _TEXT,
    "img_size": _LIST,
    "seed": _WHOLE,
    "max_images": _WHOLE,
    "yaw_deg": _NUMBER,
    "tilt_deg": _NUMBER,
    "roll_deg": _NUMBER,
    "ground_height_m": _NUMBER,
    "error_budget_px": _NUMBER,
    "accept_error": (bool, Message("true or false")),
    "frame": _TEXT,
    "mesh": _TEXT,
    "resampling": _TEXT,
    "wind": ((dict,), Message("an object")),
    "grid_angle_deg": _NUMBER,
    "crosshatch": (bool, Message("true or false")),
    "order": _TEXT,
    "airspeed_m_per_s": _NUMBER,
    "start": _TEXT,
}


def _made(kind: type[_Part], name: str, values: Any) -> _Part:
    """Part of a mission from its JSON object; raises InvalidInput where that is none, or has a field too many."""
    if not isinstance(values, dict):
        raise InvalidInput("mission field {0!r} is {1!r}: must be an object", name, values)
    known = [f.name for f in fields(kind)]
    unknown = sorted(set(values) - set(known))
    if unknown:
        raise InvalidInput("mission field {0}.{1}: not one of {2}", name, unknown[0], ", ".join(known))
    missing = [f.name for f in fields(kind) if f.default is MISSING and f.name not in values]
    if missing:
        raise InvalidInput("mission without {0}.{1}: the field is needed", name, missing[0])
    return kind(**values)


def _without_old_methods(data: dict[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Fields of a mission file without methods that only earlier versions had, and what there is to say of those."""
    data = dict(data)
    notes: list[str] = []
    footprint, mesh = data.get("footprint"), data.get("mesh")
    if footprint in _OLD_FOOTPRINTS:
        data.pop("footprint", None)
    if footprint in _CHEAP_FOOTPRINTS:
        notes.append(
            Message(
                "footprint {0!r} of the mission file is ignored: footprints are always exact, as cheaper ones "
                "save no time",
                footprint,
            )
        )
    if isinstance(mesh, str) and _OLD_MESH.fullmatch(mesh):
        data["mesh"] = AUTO
        notes.append(
            Message(
                "mesh {0!r} of the mission file is ignored: the mesh is as coarse as the error budget allows",
                mesh,
            )
        )
    return data, tuple(notes)


def _with_image_px(data: dict[str, Any]) -> dict[str, Any]:
    """Fields of a mission file; of one that states no image, written before there was one, those that mean the same.

    Such a file's longest side was the camera's, and the limit at once; with a zoom or a ground sample distance it was
    neither.
    """
    if "image_px" in data or "max_px" not in data:
        return data
    chosen = "zoom" in data or "gsd_m_per_px" in data
    return {**data, "image_px": data["max_px"], "max_px": None if chosen else data["max_px"]}


def _area_from_dict(values: Any) -> Area:
    if not isinstance(values, dict):
        raise InvalidInput("mission field 'area' is {0!r}: must be an object", values)
    area = dict(values)
    kind = area.pop("type", None)
    if kind == "box":
        return _made(Box, "area", area)
    if kind == "polygon":
        return Polygon(tuple(tuple((p[0], p[1]) for p in ring) for ring in area["rings"]))
    if kind == "points":
        return Points(tuple((p[0], p[1], p[2]) for p in area["poses"]), tuple(area.get("yaws_deg", ())))
    raise InvalidInput("area type {0!r}: must be box, polygon or points", kind)
