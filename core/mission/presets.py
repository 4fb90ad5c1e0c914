"""Presets: values of a mission's fields for what its images are for, the starting points of command and panel.

A preset is no part of a mission: it fills in fields, each of which stays open to change.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from ..errors import InvalidInput, Message
from ..map_types import ROADMAP, SATELLITE
from .parts import AUTO, NORTH, TRACK

#: Overlaps at which structure from motion finds every point in several images, also of the rows beside.
_MAPPING_OVERLAPS = (0.75, 0.65)
#: Each place is seen from two captures of its row and of the next.
_NAVIGATION_OVERLAP = 0.5
#: Side of the images that networks are commonly trained with, and of the tiles that map imagery comes in.
_LEARNING_PX = 256


@dataclass(frozen=True)
class Preset:
    """Values for a purpose.

    Parameters
    ----------
    name : str
    title : Message
        What people choose.
    note : Message
        What it sets, in one line.
    values : mapping
        By fields of a mission, ``aspect_ratio`` of its camera among them. Fields that a preset does not name stay as
        they are.
    """

    name: str
    title: Message
    note: Message
    values: Mapping[str, Any]


def _preset(name: str, title: Message, note: Message, **values: Any) -> Preset:
    return Preset(name, title, note, MappingProxyType(values))


PRESETS: tuple[Preset, ...] = (
    _preset(
        "mapping",
        Message("For mapping"),
        Message(
            "Overlap {0:g}/{1:g} %, camera along the track, JPEG with the pose in EXIF and XMP, which drone "
            "photogrammetry software reads",
            *(100.0 * overlap for overlap in _MAPPING_OVERLAPS),
        ),
        overlap_along=_MAPPING_OVERLAPS[0],
        overlap_across=_MAPPING_OVERLAPS[1],
        facing=TRACK,
        frame=AUTO,
        image_format="jpg",
        img_size=None,
        map_types=(SATELLITE,),
    ),
    _preset(
        "navigation",
        Message("For navigation"),
        Message(
            "Overlap {0:g} %, true perspective as the camera sees it, lossless GeoTIFF with the pose",
            100.0 * _NAVIGATION_OVERLAP,
        ),
        overlap_along=_NAVIGATION_OVERLAP,
        overlap_across=_NAVIGATION_OVERLAP,
        facing=NORTH,
        frame="camera",
        image_format="tif",
        img_size=None,
        map_types=(SATELLITE,),
    ),
    _preset(
        "learning",
        Message("For machine learning"),
        Message(
            "No overlap, square images of {0} × {0} px, lossless PNG; satellite and roadmap where the source has both",
            _LEARNING_PX,
        ),
        overlap_along=0.0,
        overlap_across=0.0,
        facing=NORTH,
        frame=AUTO,
        image_format="png",
        img_size=(_LEARNING_PX, _LEARNING_PX, 3),
        aspect_ratio=1.0,
        map_types=(SATELLITE, ROADMAP),
    ),
)
PRESET_NAMES = tuple(preset.name for preset in PRESETS)


def preset_named(name: str) -> Preset:
    """Preset of a name.

    Raises
    ------
    InvalidInput
        No such preset; names those there are.
    """
    found = next((preset for preset in PRESETS if preset.name == name), None)
    if found is None:
        raise InvalidInput("preset {0!r}: must be one of {1}", name, ", ".join(PRESET_NAMES), field="preset")
    return found
