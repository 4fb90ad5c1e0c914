"""Mission files of earlier versions, as today's mean the same."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from ..errors import InvalidInput, Message
from ..fields import declared_fields
from .parts import AUTO, EASTWARD_DEG, FLAT_PARTS

#: Footprints that mission files of version 0.1 name; the first two were cheaper than those of the exact camera.
_CHEAP_FOOTPRINTS = ("loc1", "loc2")
_OLD_FOOTPRINTS = (*_CHEAP_FOOTPRINTS, "exact", AUTO, None)
#: Meshes by their tolerance, as mission files of version 0.1 name them.
_OLD_MESH = re.compile(r"mesh-[0-9.]+px")
#: Rows were said by how far they were turned clockwise from east, within these degrees.
GRID_ANGLE, _NEW_AZIMUTH = "grid_angle_deg", "row_azimuth_deg"
_LARGEST_ANGLE_DEG = 180.0
#: What schema 1 held beside plain fields, as today's does.
_WHOLE = ("area", "camera", "wind")


def of_schema_1(data: Mapping[str, Any]) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Fields of a mission file of schema 1, where they were not yet in parts, and what there is to say of some.

    Parameters
    ----------
    data : mapping
        Without its ``schema``.

    Returns
    -------
    dict
        As schema 2 has them.
    tuple of str
        Methods that there are no more, and why they are ignored.

    Raises
    ------
    InvalidInput
        A field that no version had.
    """
    values, notes = _without_old_methods({name: value for name, value in data.items() if value is not None})
    values = with_row_azimuth(_with_image_px(values))
    parts = {name: [one.name for one in declared_fields(part)] for name, part in FLAT_PARTS.items()}
    known = {*_WHOLE, *(one for names in parts.values() for one in names)}
    # A null stands for the default of a field that there is, or was.
    unknown = sorted(({*data} - {"footprint", GRID_ANGLE} | {*values}) - known)
    if unknown:
        raise InvalidInput("mission field {0!r}: not one of {1}", unknown[0], ", ".join(sorted(known)))
    nested: dict[str, Any] = {name: values[name] for name in _WHOLE if name in values}
    for name, names in parts.items():
        nested[name] = {one: values[one] for one in names if one in values}
    return nested, notes


def with_row_azimuth(values: Mapping[str, Any]) -> dict[str, Any]:
    """Fields of a flight whose rows may be turned by a grid angle, as version 0.1 said it, with their azimuth.

    Raises
    ------
    InvalidInput
        An angle that no version took, or one beside an azimuth.
    """
    values = dict(values)
    if GRID_ANGLE not in values:
        return values
    angle = values.pop(GRID_ANGLE)
    if angle is None:
        return values
    if values.get(_NEW_AZIMUTH) is not None:
        raise InvalidInput(
            "mission with grid_angle_deg {0!r} and row_azimuth_deg {1!r}: give one of the two",
            angle,
            values[_NEW_AZIMUTH],
            field=_NEW_AZIMUTH,
        )
    if isinstance(angle, bool) or not isinstance(angle, (int, float)) or not abs(angle) <= _LARGEST_ANGLE_DEG:
        raise InvalidInput("grid angle {0!r}: must be a number from -180 to 180", angle, field=_NEW_AZIMUTH)
    return {**values, _NEW_AZIMUTH: (EASTWARD_DEG + angle) % 360.0}


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
