"""Write the schema of mission files and the tables of options from the declared fields of a mission.

Examples
--------
::

    python tools/options.py    # resources/mission.schema.json and docs/options.md, after a change of a field
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from terrainav.core.fields import Field, declared_fields, field_named
from terrainav.core.geodesy.camera import Camera
from terrainav.core.limits import MAX_WHOLE_NUMBER
from terrainav.core.mission.areas.area import ANGLES
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import SCHEMA, Mission
from terrainav.core.mission.options import OPTIONS, RUN_OPTIONS
from terrainav.core.mission.parts import FLAT_PARTS, Attitude, Flight
from terrainav.core.mission.presets import CAMERA_KINDS, PRESETS

ROOT = Path(__file__).resolve().parent.parent
SCHEMA_FILE, PAGE = ROOT / "resources" / "mission.schema.json", ROOT / "docs" / "options.md"
_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string", tuple: "array"}
_HEAD = """# Every option of a mission

Made by `python tools/options.py` from the fields declared in `core/mission/parts`, `core/mission/flight/wind.py` and
`core/geodesy/lens.py`. Set an option on the command line with `--name value`, in the environment as
`TERRAINAV_NAME`, or in `config.json` as `"name"`; the command line takes precedence. A mission file holds the options
in several parts (see `resources/mission.schema.json`) and omits default values. In Python, they are flat:
`Mission(area, agl_m=120.0, overlap_along=0.6)`.
"""
_PRESETS = """`--preset NAME` sets these values, unless another option does. If you also set a camera, a sensor or an
aspect ratio, the preset `learning` keeps that shape, 256 px along the longer side; if you set a source, the map types
are not changed.
"""
_KINDS = """`--camera-kind NAME` sets these values of [a real camera](realism.md), unless another option does.
"""
_PARTS = {
    "camera": "Camera",
    "attitude": "Attitude",
    "flight": "Flight",
    "wind": "Wind",
    "imagery": "Imagery",
    "pixels": "Pixels",
    "accuracy": "Accuracy",
    "terrain": "Relief and buildings",
    "route": "Flight path",
    "labels": "Labels of pixels",
    "sunlight": "Sunlight",
    "air": "Haze",
    "optics": "Optics",
    "exposure": "Exposure, white balance and tone",
    "shutter": "Shutter and motion",
    "sensor": "Image sensor",
    "varied": "Random values of images",
    "output": "Output",
}
#: Names of options that do not follow from the name of one field.
_TOGETHER = {
    "fov_deg": "`--fov`, `--hfov`, `--vfov`, `--sensor` with `--focal-length`, or `--camera`",
    "aspect_ratio": "`--aspect-ratio`",
    "agl_m": "in `--coords`, or `--agl` with `--agl-unit`",
    "overlap_along": "`--overlap`, first",
    "overlap_across": "`--overlap`, last",
    "speed_m_per_s": "`--wind`, first",
    "from_deg": "`--wind`, second",
    "turbulence": "`--wind`, last",
    "seed of the wind": "",
}


def parts() -> dict[str, Any]:
    """Parts whose fields are declared, in the order of a mission file."""
    declared = {"camera": Camera, "wind": Wind, **FLAT_PARTS}
    return {one.name: declared[one.name] for one in fields(Mission) if one.name in declared}


def schema() -> dict[str, Any]:
    """JSON Schema of a mission file."""
    properties: dict[str, Any] = {"schema": {"const": SCHEMA}, "area": _area()}
    for name, part in parts().items():
        of_part = {one.name: _property(one) for one in declared_fields(part)}
        needed = [one.name for one in declared_fields(part) if one.needed]
        properties[name] = {
            "type": "object" if needed else ["object", "null"],
            "properties": of_part,
            "additionalProperties": False,
            **({"required": needed} if needed else {}),
        }
    properties["no_fly"] = _no_fly()
    properties["pixels"]["not"] = {
        "type": "object",
        "required": ["zoom", "gsd_m_per_px"],
        "properties": {"zoom": {"type": "integer"}, "gsd_m_per_px": {"type": "number"}},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "TerrAInav mission",
        "description": "What is asked of a flight; null stands for a field's default.",
        "type": "object",
        "properties": properties,
        "required": ["schema", "area", "flight"],
        "additionalProperties": False,
    }


def _property(field: Field) -> dict[str, Any]:
    kind = _TYPES[field.kind]
    found: dict[str, Any] = {"description": _sentence(field), "type": kind if field.needed else [kind, "null"]}
    if not field.needed:
        found["default"] = list(field.default) if isinstance(field.default, tuple) else field.default
    for limit, name in (
        ("least", "minimum"),
        ("most", "maximum"),
        ("above", "exclusiveMinimum"),
        ("below", "exclusiveMaximum"),
    ):
        if getattr(field, limit) is not None:
            found[name] = getattr(field, limit)
    if field.kind is int:
        found.setdefault("maximum", MAX_WHOLE_NUMBER)
    choices = list(field.choices)
    if choices and field.kind is tuple:
        found["items"] = {"enum": choices}
    elif choices:
        found["enum"] = [*choices, None]
    return {**found, **field.schema}


#: Schemas of a latitude and of a longitude.
_LAT_LON: tuple[dict[str, Any], dict[str, Any]] = (
    {"type": "number", "minimum": -90, "maximum": 90},
    {"type": "number", "minimum": -360, "maximum": 360},
)


def _tuple_of(*items: Any) -> dict[str, Any]:
    return {"type": "array", "prefixItems": list(items), "minItems": len(items), "items": False}


def _polygon() -> dict[str, Any]:
    lat, lon = _LAT_LON
    ring = {"type": "array", "items": _tuple_of(lon, lat), "minItems": 3}
    return {"rings": {"type": "array", "items": ring, "minItems": 1}}


def _no_fly() -> dict[str, Any]:
    polygon = _polygon()
    return {
        "description": "Polygons where no camera may stand: captures planned inside are left out.",
        "type": ["array", "null"],
        "items": {
            "type": "object",
            "properties": polygon,
            "required": [*polygon],
            "additionalProperties": False,
        },
        "default": [],
    }


def _area() -> dict[str, Any]:
    lat, lon = _LAT_LON
    agl = _property(field_named(Flight, "agl_m"))
    per_point: dict[str, Any] = {"times_s": {"type": "number", "minimum": 0}}
    for name in ANGLES:
        angle = _property(field_named(Attitude, f"{name}_deg"))
        per_point[f"{name}s_deg"] = {"type": "number", "minimum": angle["minimum"], "maximum": angle["maximum"]}
    del agl["description"]

    def of_type(name: str, **properties: Any) -> dict[str, Any]:
        needed = [one for one in properties if one not in per_point]
        return {
            "type": "object",
            "properties": {"type": {"const": name}, **properties},
            "required": ["type", *needed],
            "additionalProperties": False,
        }

    polygon = _polygon()
    part = {"type": "object", "properties": polygon, "required": [*polygon], "additionalProperties": False}
    return {
        "description": "Ground to cover, or points to capture, in degrees; a box whose west exceeds its east crosses "
        "the antimeridian.",
        "oneOf": [
            of_type("box", north_deg=lat, west_deg=lon, south_deg=lat, east_deg=lon),
            of_type("polygon", **polygon),
            of_type("polygons", parts={"type": "array", "items": part, "minItems": 1}),
            of_type(
                "points",
                poses={"type": "array", "items": _tuple_of(lat, lon, agl), "minItems": 1},
                **{one: {"type": ["array", "null"], "items": value} for one, value in sorted(per_point.items())},
            ),
        ],
    }


def page() -> str:
    """Page of all options, with one table for each part."""
    text = [_HEAD]
    for name, part in parts().items():
        text += [
            f"## {_PARTS[name]}",
            "",
            "| option | in the file | description | unit and range | default |",
        ]
        text.append("| --- | --- | --- | --- | --- |")
        text += [_row(name, one) for one in declared_fields(part)]
        text.append("")
    declared = {one.name_of_option for part in parts().values() for one in declared_fields(part)}
    others = [one for one in OPTIONS if one.name not in declared | {"overlap", "wind"}]
    ways = [one for one in others if one.name not in RUN_OPTIONS]
    run = [one for one in others if one.name in RUN_OPTIONS]
    for title, some in (("Other ways to set areas and cameras", ways), ("The run", run)):
        text += [f"## {title}", "", "| option | description | default |", "| --- | --- | --- |"]
        text += [f"| `--{one.name.replace('_', '-')}` | {_cell(one.help)} | {_default(one.default)} |" for one in some]
        text.append("")
    text += [
        "## Presets",
        "",
        _PRESETS,
        "| preset | description | values |",
        "| --- | --- | --- |",
    ]
    text += [f"| `{one.name}` | {_cell(str(one.note))} | {_values(one.values)} |" for one in PRESETS]
    text += ["", _KINDS, "| kind of camera | description | values |", "| --- | --- | --- |"]
    text += [f"| `{one.name}` | {_cell(str(one.note))} | {_values(one.values)} |" for one in CAMERA_KINDS]
    return "\n".join([*text, ""])


def _values(values: Mapping[str, Any]) -> str:
    """Values of a preset, each after the name of its field."""
    return ", ".join(f"{name} {_default(value)}" for name, value in values.items() if value is not None)


def _row(part: str, field: Field) -> str:
    usual = f"`--{field.name_of_option.replace('_', '-')}`"
    key = "seed of the wind" if (part, field.name) == ("wind", "seed") else field.name
    limits = field.unit_and_limits
    if field.choices:
        limits = ", ".join(f"`{choice}`" for choice in field.choices)
    default = "needed" if field.needed else _default(field.default)
    return f"| {_TOGETHER.get(key, usual)} | `{part}.{field.name}` | {_cell(field.help)} | {limits} | {default} |"


def _default(value: Any) -> str:
    if value is None or value is False or value in ("", ()):
        return ""
    if isinstance(value, float):
        return f"`{value:g}`"
    return f"`{' '.join(map(str, value)) if isinstance(value, tuple) else value}`"


def _cell(text: str) -> str:
    begun = text if "_" in text.partition(" ")[0] else text[:1].upper() + text[1:]
    return begun.replace("|", "\\|")


def _sentence(field: Field) -> str:
    return _cell(field.help) + (f" ({field.unit.words})" if field.unit.words else "") + "."


def schema_text() -> str:
    """Text of the schema's file."""
    return json.dumps(schema(), indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    """Write the schema and the page; returns the exit code."""
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
    PAGE.write_text(page(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
