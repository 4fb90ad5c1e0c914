"""The mission: everything the user asks for, as one frozen value made of parts, to and from JSON."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, fields, is_dataclass, replace
from typing import Any, TypeVar

from ..errors import InvalidInput, Message, OptionName
from ..fields import Field, declared_fields
from ..geodesy.camera import Camera
from ..limits import MAX_MISSION_BYTES
from ..storage.files import read_limited, write_whole
from ..text.safe_json import decoded, parse_json
from .areas.area import Area, Box, Points, Polygon, Polygons, check_ground
from .flight.wind import Wind
from .imageries import NamedImagery
from .parts import (
    BY_DISTANCE,
    BY_ISO,
    BY_TIME,
    BY_WAYPOINT,
    FLAT_PARTS,
    LABELLED,
    MANUAL,
    PAPER,
    RAW,
    Accuracy,
    Air,
    Attitude,
    CameraOptics,
    ExposureControl,
    Flight,
    Imagery,
    ImageSensor,
    Output,
    PixelLabels,
    Pixels,
    Route,
    Shutter,
    Sunlight,
    Terrain,
    Varied,
)

_Part = TypeVar("_Part", Box, Camera, Wind)
#: Version of the mission file; readers refuse others.
SCHEMA = 1
#: Parts that are given as one value, with the types of each.
WHOLE_PARTS: dict[str, Any] = {
    "area": (Box, Polygon, Polygons, Points),
    "camera": Camera,
    "wind": Wind,
    "no_fly": tuple,
}
#: Defaults of parts; a mission file leaves out parts that equal their default.
_DEFAULT_PARTS: dict[str, Any] = {
    "camera": Camera(),
    "wind": None,
    "no_fly": (),
    **{name: part() for name, part in FLAT_PARTS.items() if part is not Flight},
}
#: The part of each field of `FLAT_PARTS`.
_PART_OF = {one.name: name for name, part in FLAT_PARTS.items() for one in declared_fields(part)}


@dataclass(frozen=True, init=False)
class Mission:
    """A mission: area, camera, flight, imagery and everything else that the user asks for.

    The constructor takes the fields of all parts by name, and each is read from its part:
    ``Mission(Box(…), 120.0, overlap_along=0.6).flight.overlap_along``. Area, camera, wind and no-fly polygons are given
    as one value each. The fields are declared in `parts`, `Lens` and `Wind`, and listed in ``docs/options.md``.

    Parameters
    ----------
    area : Box, Polygon, Polygons or Points
        Ground to cover, or points to capture, which have heights.
    agl_m : float
        Height above ground in metres, > 0; for Points, the height of the first point.
    wind : Wind or None
        Wind that displaces the captures; None for still air.
    no_fly : tuple of Polygon
        Ground above which no image is taken; captures planned there are left out.
    **values
        Other fields of the parts, by name.

    Raises
    ------
    InvalidInput
        A value outside its domain; the error names its field.
    """

    area: Area
    camera: Camera
    attitude: Attitude
    flight: Flight
    wind: Wind | None
    imagery: Imagery
    pixels: Pixels
    accuracy: Accuracy
    terrain: Terrain
    route: Route
    labels: PixelLabels
    sunlight: Sunlight
    air: Air
    optics: CameraOptics
    exposure: ExposureControl
    shutter: Shutter
    sensor: ImageSensor
    varied: Varied
    output: Output
    no_fly: tuple[Polygon, ...]

    def __init__(
        self,
        area: Area,
        agl_m: float,
        camera: Camera = Camera(),  # noqa: B008  frozen
        *,
        wind: Wind | None = None,
        no_fly: tuple[Polygon, ...] = (),
        **values: Any,
    ) -> None:
        given = _group_by_part({"agl_m": agl_m, **values})
        made = {name: part(**given.get(name, {})) for name, part in FLAT_PARTS.items()}
        self._keep(area=area, camera=camera, wind=wind, no_fly=no_fly, **made)

    def _keep(self, **parts: Any) -> None:
        """Set the parts, each of which is valid, after checking that they go together."""
        check_ground(parts["area"])
        asked = sorted(set(LABELLED) & set(parts["output"].products))
        if asked and not (parts["labels"].labels or parts["terrain"].has_buildings):
            raise InvalidInput(
                "product {0}: needs labels or buildings",
                asked[0],
                field="products",
                remedy=Message("name vector layers{0}", OptionName("labels").in_brackets),
            )
        if parts["optics"].by_area and parts["accuracy"].resampling != "bilinear":
            raise InvalidInput(
                "resampling {0}: must be bilinear for sampling {1}",
                parts["accuracy"].resampling,
                parts["optics"].sampling,
                field="resampling",
            )
        if parts["optics"].diffraction and parts["sensor"].pitch_um is None:
            raise InvalidInput(
                "diffraction: needs the pixel pitch",
                field="diffraction",
                remedy=Message("give it{0}", OptionName("pixel_um").in_brackets),
            )
        if parts["shutter"].motion_blur and parts["route"].exposure_ms is None:
            raise InvalidInput(
                "blur by motion: needs an exposure time",
                field="motion_blur",
                remedy=Message("give one{0}", OptionName("exposure_ms").in_brackets),
            )
        if parts["shutter"].motion_blur and parts["exposure"].exposure == BY_TIME:
            raise InvalidInput(
                "blur by motion: needs a stated exposure time, and a meter sets it",
                field="motion_blur",
                remedy=Message("choose another exposure{0}", OptionName("exposure").in_brackets),
            )
        _check_varied(parts)
        if parts["varied"].keep_undistorted:
            _check_distortion(parts["varied"].extreme_cameras(parts["camera"]))
        if RAW in parts["output"].products:
            _check_raw(parts["sensor"], parts["output"])
        exposure = parts["exposure"].exposure
        if exposure in (MANUAL, BY_ISO) and parts["route"].exposure_ms is None:
            raise InvalidInput(
                "exposure {0}: needs an exposure time",
                exposure,
                field="exposure",
                remedy=Message("give it{0}", OptionName("exposure_ms").in_brackets),
            )
        if parts["wind"] is not None:
            parts["wind"].checked(parts["flight"].airspeed_m_per_s)
        # Drop duplicates, and accept a list.
        parts["no_fly"] = tuple(dict.fromkeys(parts["no_fly"]))
        for name, part in parts.items():
            object.__setattr__(self, name, part)

    @property
    def limit_px(self) -> int | None:
        """Limit of a picture's longer side in pixels of 256 px tiles, besides the source's limit; None if unlimited."""
        # The paper's images have at most 640 px.
        return 640 if self.pixels.max_px is None and self.flight.layout == PAPER else self.pixels.max_px

    @property
    def kind(self) -> str:
        """``raster`` for areas, ``single`` for one point, ``list`` for several."""
        return self.area.kind

    @property
    def trigger(self) -> str:
        """Trigger of the camera: the route's, but by waypoint instead of by distance for points, which have no rows."""
        if self.route.trigger == BY_DISTANCE and not self.area.covers_ground:
            return BY_WAYPOINT
        return self.route.trigger

    @property
    def with_extremes(self) -> tuple[Mission, ...]:
        """The mission with the least, and with the greatest, values of the fields that vary; itself if none does."""
        if not (self.varied.of_camera or self.varied.of_lens):
            return (self,)
        ends = [(one.field, value) for one, value in self.varied.extremes()]
        cameras = self.varied.extreme_cameras(self.camera)
        fixed = self.replace(vary=(), keep_undistorted=False)
        return tuple(fixed.replace(camera=cameras[-at], **dict(ends[at::2])) for at in (0, 1))

    @property
    def moves_poses(self) -> bool:
        """Whether wind or chance moves poses from where they are planned."""
        return self.wind is not None or bool(self.varied.of_poses)

    @property
    def takes_time(self) -> bool:
        """Whether the motion of the camera changes images, or may do so where values vary."""
        return self.shutter.takes_time or any(one.field == "row_time_us" for one in self.varied.of_camera)

    @property
    def products(self) -> tuple[str, ...]:
        """Products to write: those asked for; with labels, classes and instances if neither is."""
        asked = self.output.products
        return (*asked, *LABELLED) if self.labels.labels and not set(LABELLED) & set(asked) else asked

    @property
    def missions_by_imagery(self) -> dict[str, Mission]:
        """A mission for each of several imageries, by name; empty for a mission with one source."""
        return {one.name: self.select_imagery(one) for one in self.imagery.named}

    @property
    def of_first_imagery(self) -> Mission:
        """The mission of the first of several imageries, which share one flight; itself with one source."""
        return self.select_imagery(self.imagery.named[0]) if self.imagery.named else self

    @property
    def undistorted(self) -> Mission:
        """The mission with a lens of the same focal length that does not distort, and without such twins."""
        return self.replace(camera=self.camera.undistorted, keep_undistorted=False, vary=self.varied.besides_lens)

    def select_imagery(self, imagery: NamedImagery) -> Mission:
        """Return a copy that captures this imagery alone."""
        return self.replace(imageries=(), source=imagery.source, date=imagery.date, map_types=(imagery.map_type,))

    def replace(self, **changes: Any) -> Mission:
        """Return a checked copy with some fields changed, by the names that the constructor takes."""
        parts = {one.name: getattr(self, one.name) for one in fields(self)}
        whole = {name: changes.pop(name) for name in list(changes) if name in WHOLE_PARTS}
        for name, values in _group_by_part(changes).items():
            parts[name] = replace(parts[name], **values)
        changed = object.__new__(Mission)
        changed._keep(**{**parts, **whole})
        return changed

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready mapping of the parts, ``schema`` and the area's ``type``, without fields that equal defaults."""
        parts = {one.name: getattr(self, one.name) for one in fields(self)}
        plain = {
            name: _without_defaults(part) for name, part in parts.items() if part != _DEFAULT_PARTS.get(name, MISSING)
        }
        kind = type(self.area).__name__.lower()
        return {"schema": SCHEMA, **plain, "area": {"type": kind, **plain["area"]}}

    def to_json(self) -> str:
        """Text of the mission file; equal missions give equal texts."""
        return json.dumps(self.to_dict(), indent=1, ensure_ascii=False) + "\n"

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Mission:
        """Mission from a mapping as `to_dict` returns it; fields that are left out or null take their defaults.

        Raises
        ------
        InvalidInput
            Another schema, an unknown field, or a value outside its domain.
        """
        data = dict(data)
        schema = data.pop("schema", None)
        if schema != SCHEMA:
            raise InvalidInput("mission schema {0!r}: this version reads schema {1}", schema, SCHEMA)
        _check_names(data, "", (*WHOLE_PARTS, *FLAT_PARTS))
        values: dict[str, Any] = {}
        for name, part in FLAT_PARTS.items():
            given = _object(name, {} if data.get(name) is None else data[name])
            _check_names(given, f"{name}.", [one.name for one in declared_fields(part)])
            values.update((one, value) for one, value in given.items() if value is not None)
        if data.get("area") is None:
            raise InvalidInput("mission without {0}: the field is needed", "'area'")
        if "agl_m" not in values:
            raise InvalidInput("mission without {0}: the field is needed", "'agl_m'")
        camera = _make_part(Camera, "camera", {} if data.get("camera") is None else data["camera"])
        wind = None if data.get("wind") is None else _make_part(Wind, "wind", data["wind"])
        no_fly = _polygons("no_fly", [] if data.get("no_fly") is None else data["no_fly"])
        return cls(area_from_dict(data["area"]), camera=camera, wind=wind, no_fly=no_fly, **values)

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
    def load(cls, path: str | os.PathLike[str], *, named_by_user: bool = False) -> Mission:
        """Mission from a file, or from a pipe if ``named_by_user``; raises InvalidInput as `from_dict` does."""
        try:
            text = decoded(read_limited(path, MAX_MISSION_BYTES, named_by_user=named_by_user))
        except OSError as wrong:
            raise InvalidInput("mission file {0}: cannot be read ({1})", path, wrong.strerror) from wrong
        except InvalidInput as wrong:
            raise InvalidInput("mission file {0}: cannot be read ({1})", path, wrong) from wrong
        if not text.lstrip().startswith("{"):
            raise InvalidInput(
                "mission file {0}: holds no mission, which is a JSON object; a file of places is given as coordinates",
                path,
            )
        return cls.from_json(text)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the mission to a file, completely or not at all."""
        write_whole(path, self.to_json().encode())


def _check_varied(parts: Mapping[str, Any]) -> None:
    """Refuse values of a field that do not go with the other fields of its part."""
    for variation, value in parts["varied"].extremes():
        with _refusing_variation(str(variation)):
            replace(parts[_PART_OF[variation.field]], **{variation.field: value})
    parts["varied"].extreme_cameras(parts["camera"])


@contextmanager
def _refusing_variation(text: str) -> Iterator[None]:
    """Raise InvalidInput that names the variation."""
    try:
        yield
    except InvalidInput as wrong:
        raise InvalidInput("vary {0!r}: {1}", text, wrong, field="vary") from wrong


def _check_distortion(cameras: tuple[Camera, ...]) -> None:
    """Refuse undistorted images of cameras none of which distorts."""
    if all(camera.is_ideal for camera in cameras):
        raise InvalidInput(
            "undistorted images: the lens does not distort, so they would be the images themselves",
            field="keep_undistorted",
            remedy="choose a lens with distortion, or leave them out",
        )


def _check_raw(sensor: ImageSensor, output: Output) -> None:
    """Refuse raw values without a sensor, and those of resized images."""
    if not sensor.image_sensor:
        raise InvalidInput(
            "product {0}: needs an image sensor",
            RAW,
            field="products",
            remedy=Message("name one{0}", OptionName("image_sensor").in_brackets),
        )
    if output.img_size is not None:
        raise InvalidInput(
            "product {0}: has the pixels of the sensor, of which resized images have none", RAW, field="products"
        )


def flat_fields() -> Iterator[Field]:
    """Yield the fields that a mission takes by name, part by part."""
    for part in FLAT_PARTS.values():
        yield from declared_fields(part)


def area_from_dict(values: Any) -> Area:
    """Area from its JSON object in a mission file.

    Raises
    ------
    InvalidInput
        Another type, an unknown or missing field, or a value outside its domain.
    """
    area = dict(_object("area", values))
    kind = area.pop("type", None)
    with _refusing_malformed():
        if kind == "box":
            return _make_part(Box, "area", area)
        if kind == "polygon":
            return _polygon(area)
        if kind == "polygons":
            return Polygons(tuple(_polygon(part) for part in area["parts"]))
        if kind == "points":
            columns = {name: tuple(values or ()) for name, values in area.items() if name != "poses"}
            _check_names(columns, "area.", [one.name for one in fields(Points)])
            return Points(tuple((p[0], p[1], p[2]) for p in area["poses"]), **columns)
    raise InvalidInput("area type {0!r}: must be box, polygon, polygons or points", kind)


@contextmanager
def _refusing_malformed() -> Iterator[None]:
    """Raise InvalidInput for a field that is missing or of another type."""
    try:
        yield
    except KeyError as missing:
        raise InvalidInput("mission without {0}: the field is needed", missing) from missing
    except InvalidInput:
        raise
    except (TypeError, AttributeError, ValueError, IndexError, OverflowError) as wrong:
        raise InvalidInput("mission with a value of the wrong type: {0}", wrong) from wrong


def _polygon(values: Mapping[str, Any]) -> Polygon:
    return Polygon(tuple(tuple((p[0], p[1]) for p in ring) for ring in values["rings"]))


def _polygons(name: str, values: Any) -> tuple[Polygon, ...]:
    """Polygons from the list of their JSON objects; raises InvalidInput."""
    if not isinstance(values, list):
        raise InvalidInput("mission field {0!r} is {1!r}: must be a list of polygons", name, values)
    found = []
    for at, one in enumerate(values):
        _check_names(_object(f"{name}[{at}]", one), f"{name}[{at}].", ("rings",))
        with _refusing_malformed():
            found.append(_polygon(one))
    return tuple(found)


def _without_defaults(value: Any) -> Any:
    """JSON-ready value; of a dataclass, the fields that differ from their defaults."""
    if isinstance(value, tuple) and value and is_dataclass(value[0]):
        return [_without_defaults(one) for one in value]
    if not is_dataclass(value):
        return value
    given = ((one, getattr(value, one.name)) for one in fields(value))
    return {one.name: _without_defaults(found) for one, found in given if found != one.default}


def _group_by_part(values: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Group the values of fields by part; raises TypeError for an unknown field, as Python does for arguments."""
    found: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        if name not in _PART_OF:
            import difflib

            near = difflib.get_close_matches(name, _PART_OF, n=1)
            meant = f", did you mean {near[0]!r}" if near else ""
            unknown = f"unknown field of a mission {name!r}{meant}"
            raise TypeError(unknown)
        found.setdefault(_PART_OF[name], {})[name] = value
    return found


def _object(name: str, value: Any) -> Mapping[str, Any]:
    if not isinstance(value, Mapping):
        raise InvalidInput("mission field {0!r} is {1!r}: must be an object", name, value)
    return value


def _check_names(values: Mapping[str, Any], where: str, known: Any) -> None:
    unknown = sorted(set(values) - set(known))
    if unknown:
        raise InvalidInput("mission field {0!r}: not one of {1}", where + unknown[0], ", ".join(sorted(known)))


def _make_part(kind: type[_Part], name: str, values: Any) -> _Part:
    """Make a part of a mission from its JSON object; raises InvalidInput."""
    given = {one: value for one, value in _object(name, values).items() if value is not None}
    _check_names(given, f"{name}.", [one.name for one in fields(kind)])
    needed = [one.name for one in fields(kind) if one.default is MISSING and one.name not in given]
    if needed:
        raise InvalidInput("mission without {0}.{1}: the field is needed", name, needed[0])
    try:
        return kind(**given)
    except TypeError as wrong:
        raise InvalidInput("mission with a value of the wrong type: {0}", wrong) from wrong
