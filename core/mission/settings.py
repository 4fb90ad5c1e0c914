"""Values of a mission's options: from command line, environment, configuration file, preset and defaults.

The command line precedes the environment (``TERRAINAV_FOV=75``), ``config.json``, the preset and the defaults, in this
order. Alternative options count as one: ``--hfov`` precedes a ``fov`` in the file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InvalidInput
from ..geodesy.camera import Camera
from ..geodesy.lens import LENS_FIELDS, PERSPECTIVE
from ..limits import MAX_SETTINGS_BYTES
from ..storage.files import read_limited
from ..text.safe_json import parse_json
from ..units import LENGTHS_M
from .areas.area import Area, Points, Polygon
from .areas.coords import parse_coords
from .cameras import camera_named
from .flight.wind import Wind
from .mission import Mission, flat_fields
from .options import JOINED, OPTIONS
from .parts import AUTO, Flight, Pixels
from .presets import CAMERA_KINDS, preset_named

CONFIG_FILE = "config.json"
#: Options of a camera, any of which excludes the camera of a preset.
_CAMERA_OPTIONS = {"camera", "fov", "hfov", "vfov", "sensor", "focal_length", "aspect_ratio", "image_px"}


def resolve(
    given: Mapping[str, Any], environment: Mapping[str, str] | None = None, config: str | None = None
) -> dict[str, Any]:
    """Find the value of every option, by precedence.

    Parameters
    ----------
    given : mapping
        Values from the command line; None or absent for options that it does not give.
    environment : mapping
        Environment of the process, in which ``TERRAINAV_<NAME>`` gives an option.
    config : str or None
        JSON file of options, which must exist; None for ``config.json`` in the current folder, if any.

    Raises
    ------
    InvalidInput
        An unknown name in the file, or an invalid value.
    """
    values = {option.name: option.default for option in OPTIONS}
    settled: set[str] = set()
    for place in _places(given, os.environ if environment is None else environment, config):
        _take(place, values, settled)
    if values["preset"] is not None:
        _take(_read_preset(values, settled), values, settled)
    if values["camera_kind"] is not None:
        kind = preset_named(values["camera_kind"], CAMERA_KINDS)
        _take(_labelled(kind.name, kind.values), values, settled)
    return values


def _take(place: Mapping[str, tuple[str, Any]], values: dict[str, Any], settled: set[str]) -> None:
    """Take the options that a place, such as the environment, gives, unless an earlier place has settled them."""
    chosen = [option for option in OPTIONS if option.name in place and option.name not in settled]
    for option in chosen:
        where, value = place[option.name]
        values[option.name] = option.read(value, where)
    settled.update(*(_settled_options(option.name) for option in chosen))


def _read_preset(values: Mapping[str, Any], settled: set[str]) -> dict[str, tuple[str, Any]]:
    """Options of the preset by name, each as a label for messages and the value."""
    name = values["preset"]
    preset = preset_named(name)
    fields = dict(preset.values)
    given: dict[str, Any] = {"overlap": (fields.pop("overlap_along"), fields.pop("overlap_across"))}
    if "aspect_ratio" in fields:
        given["aspect_ratio"] = (fields.pop("aspect_ratio"), 1.0)
        shape = _camera_shape(values)
        if shape is not None:
            # Images keep the shape of the camera.
            del given["aspect_ratio"]
            fields["img_size"] = _fit_size(fields["img_size"], *shape)
    if preset.camera and not settled & _CAMERA_OPTIONS:
        given["camera"] = preset.camera
    if settled & {"source", "imagery"}:
        # Most sources have one map type, so that the folders of two would hold the same images.
        del fields["map_types"]
    return {**_labelled(name, fields), **{option: _labelling(name, value) for option, value in given.items()}}


def _labelled(preset: str, fields: Mapping[str, Any]) -> dict[str, tuple[str, Any]]:
    """Options of a preset by name, each with a label for messages, from the fields of a mission that it sets."""
    named = {one.name: one.name_of_option for one in flat_fields()}
    return {named[field]: _labelling(preset, value) for field, value in fields.items() if value is not None}


def _labelling(preset: str, value: Any) -> tuple[str, Any]:
    return f"preset {preset}, option", value


def _camera_shape(values: Mapping[str, Any]) -> tuple[float, float] | None:
    """Shape (width, height) of the requested camera's images; None if it is not requested."""
    if values["camera"] is not None:
        return camera_named(values["camera"]).camera.aspect_ratio, 1.0
    shape: tuple[float, float] | None = values["aspect_ratio"] or values["sensor"]
    # Making the camera reports an invalid shape.
    return shape if shape is not None and min(shape) > 0.0 else None


def _fit_size(size: tuple[int, int, int], width: float, height: float) -> tuple[int, int, int]:
    """Size of the given shape with the longer side and the channels of ``size``."""
    longer_px = max(size[:2])
    scale = longer_px / max(width, height)
    return max(round(scale * width), 1), max(round(scale * height), 1), size[2]


def _places(
    given: Mapping[str, Any], environment: Mapping[str, str], config: str | None
) -> Iterator[dict[str, tuple[str, Any]]]:
    """Yield the options of each place, in order of precedence, by name: each a label for messages and the value."""
    yield {name: ("option", value) for name, value in given.items() if value is not None}
    variables = {option.name: f"TERRAINAV_{option.name.upper()}" for option in OPTIONS}
    yield {
        name: (f"environment {variable}, option", environment[variable])
        for name, variable in variables.items()
        if environment.get(variable)
    }
    where = f"{config or CONFIG_FILE}, option"
    yield {name: (where, value) for name, value in _read_config(config).items() if value is not None}


def _settled_options(name: str) -> set[str]:
    """Options that later places cannot change once an option is given: the option itself, and its alternatives."""
    # A named camera sets shape and pixels, but either of them alone does not exclude a named camera.
    found = {name, "aspect_ratio", "image_px"} if name == "camera" else {name}
    alternatives: tuple[tuple[tuple[str, ...], ...], ...] = (
        (("coords",), ("area",)),
        (("camera",), ("fov",), ("hfov",), ("vfov",), ("sensor", "focal_length")),
        (("zoom",), ("gsd",)),
    )
    for options in alternatives:
        if any(name in names for names in options):
            found.update(other for names in options if name not in names for other in names)
    return found


def _read_config(config: str | None) -> dict[str, Any]:
    path = Path(config or CONFIG_FILE)
    if config is None and not path.is_file():
        return {}
    try:
        data = parse_json(read_limited(path, MAX_SETTINGS_BYTES, named_by_user=config is not None))
    except (OSError, InvalidInput) as wrong:
        raise InvalidInput("config file {0}: cannot be read as JSON ({1})", path, wrong) from wrong
    if not isinstance(data, dict):
        raise InvalidInput("config file {0}: must hold a JSON object of options", path)
    data = {str(name).replace("-", "_"): value for name, value in data.items()}
    known = [option.name for option in OPTIONS]
    for name in data:
        if name not in known:
            import difflib

            near = difflib.get_close_matches(name, known, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else f"; known are {', '.join(known)}"
            raise InvalidInput("config file {0}: unknown option {1!r}{2}", path, name, hint)
    return data


def build_mission(values: Mapping[str, Any]) -> Mission:
    """Build a mission from the values that `resolve` returns.

    Raises
    ------
    InvalidInput
        No area, two areas, or a value outside its domain.
    """
    area, agl_m = _area(values)
    camera, camera_px = build_camera(values)
    overlap = values["overlap"]
    fields = {one.name: values[one.name_of_option] for one in flat_fields() if one.name_of_option in values}
    if fields["image_px"] is None:
        fields["image_px"] = camera_px
    for name in ("bands", "imageries", "elevation", "surface", "buildings", "labels", "vary", "products"):
        fields[name] = fields[name] or ()
    for name in JOINED:
        if isinstance(fields[name], tuple):
            fields[name] = " ".join(fields[name])
    if fields["airspeed_m_per_s"] == AUTO:
        # It is chosen once the mission is planned.
        fields["airspeed_m_per_s"] = Flight.airspeed_m_per_s
    fields.update(agl_m=agl_m, overlap_along=overlap[0], overlap_across=overlap[-1])
    return Mission(area, camera=camera, wind=_wind(values), no_fly=_no_fly(values), **fields)


def _no_fly(values: Mapping[str, Any]) -> tuple[Polygon, ...]:
    if values["no_fly"] is None:
        return ()
    from .areas.files import load_no_fly

    return load_no_fly(values["no_fly"])


def _wind(values: Mapping[str, Any]) -> Wind | None:
    if values["wind"] is None:
        return None
    speed, from_deg, turbulence = values["wind"]
    return Wind(speed, from_deg, turbulence, values["seed"])


def _area(values: Mapping[str, Any]) -> tuple[Area, float]:
    if values["area"] is not None and values["coords"] is not None:
        raise InvalidInput("area {0!r} and coords {1!r}: give one of the two", values["area"], values["coords"])
    agl_m = None if values["agl"] is None else values["agl"] * LENGTHS_M[values["agl_unit"]]
    if values["area"] is not None:
        if agl_m is None:
            raise InvalidInput("area {0!r}: needs a height, --agl", values["area"])
        from .areas.files import load_area

        return load_area(values["area"]), agl_m
    if values["coords"] is None:
        raise InvalidInput('no coordinates: give --coords, such as --coords "35.16_-89.90_35.115_-89.823_120"')
    area, coords_agl_m = parse_coords(values["coords"], values["mission"], values["agl_unit"], agl_m)
    if agl_m is None:
        return area, coords_agl_m
    if isinstance(area, Points):
        area = replace(area, poses=tuple((lat, lon, agl_m) for lat, lon, _ in area.poses))
    return area, agl_m


def build_camera(values: Mapping[str, Any]) -> tuple[Camera, int]:
    """Build the camera, and find the pixels along its image's longer side; raises InvalidInput."""
    _check_one_camera(values)
    lens = {name: values[name] for name in LENS_FIELDS if values[name] is not None}
    if values["camera"] is not None:
        preset = camera_named(values["camera"])
        return replace(preset.camera, **lens), preset.image_px or Pixels.image_px
    return replace(_camera_by_numbers(values), **lens), Pixels.image_px


def _camera_by_numbers(values: Mapping[str, Any]) -> Camera:
    """Camera by its field of view, or by sensor and focal length, without distortion."""
    shape, lens = values["aspect_ratio"], values["lens"] or PERSPECTIVE
    if shape is not None and not (shape[0] > 0.0 and shape[1] > 0.0):
        raise InvalidInput("aspect ratio {0:g} {1:g}: width and height must be above 0", shape[0], shape[1])
    if values["sensor"] is not None:
        stated = None if shape is None else shape[0] / shape[1]
        return Camera.from_sensor(values["sensor"], values["focal_length"], stated, lens)
    ratio = Camera.aspect_ratio if shape is None else shape[0] / shape[1]
    if values["hfov"] is not None:
        return Camera.from_horizontal_fov(values["hfov"], ratio, lens)
    if values["vfov"] is not None:
        return Camera.from_vertical_fov(values["vfov"], ratio, lens)
    return Camera(Camera.fov_deg if values["fov"] is None else values["fov"], ratio)


def _check_one_camera(values: Mapping[str, Any]) -> None:
    """Refuse a camera that is given in two ways, or incompletely."""
    ways = ["camera", "fov", "hfov", "vfov", "sensor"]
    if values["camera"] is not None:
        ways.append("aspect_ratio")
    given = [f"{name} {_format_value(values[name])}" for name in ways if values[name] is not None]
    if len(given) > 1:
        raise InvalidInput("{0} and {1}: give one of the two", given[0], given[1])
    if (values["sensor"] is None) != (values["focal_length"] is None):
        name, other = ("sensor", "focal_length") if values["focal_length"] is None else ("focal_length", "sensor")
        raise InvalidInput("{0} {1}: needs {2} as well", name, _format_value(values[name]), other)


def _format_value(value: Any) -> str:
    """Value of an option as users write it."""
    return " ".join(f"{one:g}" for one in value) if isinstance(value, tuple) else repr(value)
