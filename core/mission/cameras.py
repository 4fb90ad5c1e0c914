"""Cameras by name: those that ship, and those that users add."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..errors import InvalidInput, Message
from ..fields import field_named
from ..geodesy.camera import Camera
from ..geodesy.lens import LENS_FIELDS, PERSPECTIVE, Lens
from ..resources import read_json
from ..storage.config import Shelf, config_file, read_named, read_shelf, write_named

#: Facts that state the field of view; a camera has one of them.
_VIEWS = ("fov_deg", "horizontal_fov_deg", "vertical_fov_deg", "sensor_mm", "focal_px")
#: Coefficients of a lens.
_COEFFICIENTS = tuple(name for name in LENS_FIELDS if name != "lens")
#: All facts of a camera.
FACTS = (
    *_VIEWS,
    "focal_length_mm",
    "aspect_ratio",
    "size_px",
    "image_px",
    "lens",
    *_COEFFICIENTS,
    "principal_px",
    "source",
)
_FILE = "cameras.json"


@dataclass(frozen=True)
class CameraPreset:
    """A camera by name.

    Parameters
    ----------
    width_px, height_px : int or None
        Size of its images; None where the source does not state it.
    source : str
        Where the facts come from; may be empty for a user's camera.
    sensor_mm : (width, height) or None
        Size of the sensor, if the camera is stated by it.
    focal_length_mm : float or None
        Focal length of the lens, if the camera is stated by its sensor.
    image_px : int or None
        Pixels along the longer side of its images, if known.
    user : bool
        Whether a user added it.
    """

    name: str
    camera: Camera
    width_px: int | None
    height_px: int | None
    source: str
    sensor_mm: tuple[float, float] | None = None
    focal_length_mm: float | None = None
    image_px: int | None = None
    user: bool = False

    @classmethod
    def from_dict(cls, name: str, data: Mapping[str, Any], *, user: bool = False) -> CameraPreset:
        """Preset from the facts of ``resources/cameras.json``, or of a user's ``cameras.json``.

        The field of view is given as ``sensor_mm`` with ``focal_length_mm``, or as ``fov_deg`` (diagonal),
        ``horizontal_fov_deg`` or ``vertical_fov_deg``; the shape of the image as ``size_px`` or ``aspect_ratio``, by
        default that of the sensor. Sizes and ratios are lists of width and height. Without ``size_px``, ``image_px``
        gives the pixels along the longer side. ``source`` names the origin of the facts.

        A calibration with OpenCV gives ``focal_px`` instead of a field of view, ``principal_px`` (its cx and cy), both
        with ``size_px``, and the coefficients ``k1`` to ``k6``, ``p1`` and ``p2``, for a fisheye with ``lens``.

        Raises
        ------
        InvalidInput
            A fact that is unknown, missing or of the wrong type, or a sensor whose shape differs from its image's.
        """
        try:
            return cls._build(name, data, user)
        except InvalidInput as wrong:
            raise InvalidInput("camera {0}: {1}", name, wrong) from wrong

    @classmethod
    def _build(cls, name: str, data: Mapping[str, Any], user: bool) -> CameraPreset:
        data = {fact: value for fact, value in data.items() if value is not None}
        view = _check_facts(data)
        source = data.get("source", "")
        if not (isinstance(source, str) and source.isprintable() and (source or user)):
            raise InvalidInput("source {0!r}: must be text of one line", source)
        size_px = _pair(data, "size_px") if "size_px" in data else None
        if size_px is not None and not all(side.is_integer() for side in size_px):
            raise InvalidInput("size_px {0!r}: must be whole numbers", data["size_px"])
        shape = size_px or (_pair(data, "aspect_ratio") if "aspect_ratio" in data else None)
        ratio = None if shape is None else shape[0] / shape[1]
        sensor_mm, focal_length_mm = None, None
        lens = field_named(Lens, "lens").settled(data.get("lens", PERSPECTIVE))
        if view == "sensor_mm":
            sensor_mm, focal_length_mm = _pair(data, view), _number(data, "focal_length_mm")
            camera = Camera.from_sensor(sensor_mm, focal_length_mm, ratio, lens)
        elif view == "focal_px":
            if size_px is None:
                raise InvalidInput("{0} {1!r}: needs size_px beside it", view, data[view])
            camera = Camera.from_focal_px(size_px, _number(data, view), lens)
        elif ratio is None:
            raise InvalidInput("{0} {1!r}: needs aspect_ratio or size_px beside it", view, data[view])
        else:
            make = {"horizontal_fov_deg": Camera.from_horizontal_fov, "vertical_fov_deg": Camera.from_vertical_fov}
            camera = make.get(view, Camera)(_number(data, view), ratio, lens)
        camera = replace(camera, **_distortion(data, size_px))
        width_px, height_px = (None, None) if size_px is None else map(int, size_px)
        image_px = _image_px(data) if size_px is None else int(max(size_px))
        return cls(name, camera, width_px, height_px, source, sensor_mm, focal_length_mm, image_px, user)


def _distortion(data: Mapping[str, Any], size_px: tuple[float, float] | None) -> dict[str, Any]:
    """Fields of the lens that facts state, besides its kind."""
    found = {name: data[name] for name in _COEFFICIENTS if name in data}
    if "principal_px" in data:
        if size_px is None:
            raise InvalidInput("{0} {1!r}: needs size_px beside it", "principal_px", data["principal_px"])
        x, y = (at / size - 0.5 for at, size in zip(_pair(data, "principal_px"), size_px))
        found.update(principal_x=x, principal_y=y)
    return found


def _check_facts(data: Mapping[str, Any]) -> str:
    """Return the fact that states the field of view; refuse none, several, and facts that exclude each other."""
    for fact in data:
        if fact not in FACTS:
            raise InvalidInput("{0!r} is unknown; known are {1}", fact, ", ".join(FACTS))
    given = [fact for fact in _VIEWS if fact in data]
    if len(given) != 1:
        raise InvalidInput(
            "{0}: give one of {1}", " and ".join(given) or Message("no field of view"), ", ".join(_VIEWS)
        )
    if (given[0] == "sensor_mm") != ("focal_length_mm" in data):
        raise InvalidInput("sensor_mm and focal_length_mm: one needs the other")
    for fact in ("aspect_ratio", "image_px"):
        if "size_px" in data and fact in data:
            raise InvalidInput("size_px and {0}: give one of the two", fact)
    return given[0]


def _image_px(data: Mapping[str, Any]) -> int | None:
    if "image_px" not in data:
        return None
    pixels = _number(data, "image_px")
    if not pixels.is_integer():
        raise InvalidInput("image_px {0!r}: must be a whole number", data["image_px"])
    return int(pixels)


def _number(data: Mapping[str, Any], fact: str) -> float:
    return _positive(data[fact], Message("{0} {1!r}: must be a number above 0", fact, data[fact]))


def _pair(data: Mapping[str, Any], fact: str) -> tuple[float, float]:
    pair = data[fact]
    wanted = Message("{0} {1!r}: must be a list of width and height, each above 0", fact, pair)
    if not isinstance(pair, (list, tuple)) or len(pair) != 2:
        raise InvalidInput(wanted)
    return _positive(pair[0], wanted), _positive(pair[1], wanted)


def _positive(value: Any, wanted: str) -> float:
    # Python counts bool as int, and JSON has integers that no float holds.
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < value <= sys.float_info.max:
        raise InvalidInput(wanted)
    return float(value)


def shipped_cameras() -> tuple[CameraPreset, ...]:
    """Return the cameras of ``resources/cameras.json``, the paper's first."""
    return tuple(
        CameraPreset.from_dict(data["name"], {fact: data[fact] for fact in data if fact != "name"})
        for data in read_json("cameras.json")
    )


def cameras() -> tuple[CameraPreset, ...]:
    """Return the cameras that ship, the paper's first, then those that the user added.

    Raises
    ------
    InvalidInput
        The user's file cannot be read.
    """
    return (*shipped_cameras(), *camera_shelf().entries)


def camera_named(name: str) -> CameraPreset:
    """Find a camera by its name, in any case; the maker's name may be left out.

    Raises
    ------
    InvalidInput
        No such camera; suggests similar names.
    """
    shipped, wanted = shipped_cameras(), key(name)
    found = _named(wanted, shipped, full=True)
    if found is not None:
        return found
    # Read the user's file, which may be broken, only for names that do not ship.
    added = camera_shelf()
    for other, problem in added.problems.items():
        if key(other) == wanted:
            raise InvalidInput(problem)
    presets = (*added.entries, *shipped)
    found = _named(wanted, added.entries, full=True) or _named(wanted, presets, full=False)
    if found is not None:
        return found
    names = {key(preset.name): preset.name for preset in presets}
    import difflib

    close = [names[near] for near in difflib.get_close_matches(wanted, names, n=3, cutoff=0.5)]
    close = close or [known for near, known in names.items() if wanted and wanted in near][:3]
    hint = Message("did you mean {0}? ", " or ".join(close)) if close else ""
    raise InvalidInput("camera {0!r} is unknown: {1}`terrainav cameras` lists the names", name, hint)


def _named(wanted: str, presets: tuple[CameraPreset, ...], *, full: bool) -> CameraPreset | None:
    """First preset with the wanted name; unless ``full``, without the maker's name, which is the first word."""
    for preset in presets:
        name = key(preset.name)
        if wanted and wanted == (name if full else name.partition(" ")[2]):
            return preset
    return None


def camera_shelf() -> Shelf[CameraPreset]:
    """Return the user's valid cameras, and the problems of the others; raises as `read_shelf` does."""
    taken = {key(preset.name): preset.name for preset in shipped_cameras()}

    def preset(name: str, data: Any) -> CameraPreset:
        _check_name(name, taken)
        made = _preset(name, data)
        taken[key(name)] = name
        return made

    return read_shelf(config_file(_FILE), Message("cameras"), preset)


def add_camera(name: str, data: Mapping[str, Any]) -> CameraPreset:
    """Store a user's camera under a name.

    Parameters
    ----------
    name : str
        One line without surrounding spaces; differs from every other name in more than case.
    data : mapping
        Facts as `CameraPreset.from_dict` takes them.

    Raises
    ------
    InvalidInput
        The name or a fact is invalid.
    OutputError
        The file cannot be written.
    """
    path = config_file(_FILE)
    known = read_named(path, Message("cameras"))
    taken = {key(other): other for other in (*(preset.name for preset in shipped_cameras()), *known)}
    _check_name(name, taken)
    preset = _preset(name, data)
    write_named(path, {**known, name: dict(data)})
    return preset


def remove_camera(name: str) -> str:
    """Remove a camera that the user added; its name may be in any case.

    Returns
    -------
    str
        Its name as stored.

    Raises
    ------
    InvalidInput
        No such camera, or it ships with TerrAInav.
    """
    path = config_file(_FILE)
    known = read_named(path, Message("cameras"))
    found = name if name in known else next((stored for stored in known if key(stored) == key(name)), None)
    if found is None:
        if any(key(preset.name) == key(name) for preset in shipped_cameras()):
            raise InvalidInput("camera {0!r}: comes with TerrAInav, and stays as it is", name)
        raise InvalidInput(
            "camera {0!r}: not one of your own, which are {1}", name, ", ".join(known) or Message("none")
        )
    write_named(path, {other: data for other, data in known.items() if other != found})
    return found


def key(name: str) -> str:
    """Name in lower case with single spaces, to compare names by."""
    return " ".join(name.casefold().split())


def _check_name(name: str, taken: Mapping[str, str]) -> None:
    # Longer names do not fit into lists.
    longest = 64
    if not (0 < len(name) <= longest and name.isprintable() and name == " ".join(name.split())):
        raise InvalidInput(
            "camera name {0!r}: must be 1 to {1} characters of one line, with single spaces inside",
            name,
            longest,
        )
    if key(name) in taken:
        raise InvalidInput("camera name {0!r}: {1} is taken", name, taken[key(name)], remedy="choose another")


def _preset(name: str, data: Any) -> CameraPreset:
    if not isinstance(data, Mapping):
        raise InvalidInput("camera {0}: must be an object", name)
    return CameraPreset.from_dict(name, data, user=True)
