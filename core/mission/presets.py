"""Presets: values of a mission's fields that suit a purpose, as a start for command and panel.

A preset fills in fields, each of which may still be changed; the mission does not keep its name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from ..errors import InvalidInput, Message
from ..fields import declared_fields
from ..map_types import ROADMAP, SATELLITE
from .parts import AUTO, BY_ISO, FLAT_PARTS, NORTH, REALISM_PARTS, TRACK, Sunlight, Varied

#: Front and side overlap at which structure from motion finds every point in several images and rows.
_MAPPING_OVERLAPS = (0.75, 0.65)
#: Each place is seen by two captures of a row and by two rows.
_NAVIGATION_OVERLAP = 0.5
#: Usual side of images for training neural networks, and of map tiles.
_LEARNING_PX = 256


@dataclass(frozen=True)
class Preset:
    """Values for a purpose.

    Parameters
    ----------
    name : str
    title : Message
        Label in menus.
    note : Message
        One line about the values.
    values : mapping
        Values by field of a mission, or ``aspect_ratio`` of its camera. Other fields stay as they are.
    camera : str
        Camera by name, unless another is chosen; empty for none.
    """

    name: str
    title: Message
    note: Message
    values: Mapping[str, Any]
    camera: str = ""


def _preset(name: str, title: Message, note: Message, camera: str = "", **values: Any) -> Preset:
    return Preset(name, title, note, MappingProxyType(values), camera)


PRESETS: tuple[Preset, ...] = (
    _preset(
        "mapping",
        Message("For mapping"),
        Message(
            "Overlap {0:g}/{1:g} %, camera along the track, JPEG with the pose in EXIF and XMP, which drone "
            "photogrammetry software reads",
            *(100.0 * overlap for overlap in _MAPPING_OVERLAPS),
        ),
        camera="DJI Mavic 3E",
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
#: Kinds of cameras, as values of the parts of a real camera's effects. Sensors are ones with a public data sheet, at
#: the lowest speed that they have; other values are usual ones, of no one model.
CAMERA_KINDS: tuple[Preset, ...] = (
    _preset("ideal", Message("Ideal"), Message("No effects: a pinhole camera without noise")),
    _preset(
        "machine-vision",
        Message("Machine-vision camera"),
        Message("Global shutter open for 0.5 ms, automatic ISO, sensor with the noise of its EMVA 1288 data sheet"),
        image_sensor="Allied Vision Alvium 1800 C-507m",
        vignetting="cos4",
        exposure=BY_ISO,
        exposure_ms=0.5,
        f_number=5.6,
        iso=240.0,
        motion_blur=True,
    ),
    _preset(
        "consumer-drone",
        Message("Consumer drone"),
        Message(
            "Rolling shutter, small pixels below colour filters, automatic ISO, soft tone curve, and a visibility of "
            "20 km"
        ),
        image_sensor="FRAMOS IMX900 low gain",
        bayer="rggb",
        vignetting="cos4",
        exposure=BY_ISO,
        exposure_ms=0.2,
        f_number=2.8,
        iso=160.0,
        motion_blur=True,
        # 30 ms from the top of an image of 480 rows to its bottom.
        row_time_us=62.5,
        tone="filmic",
        visibility_km=20.0,
    ),
)


def camera_kind_values(preset: Preset) -> dict[str, Any]:
    """Values of a kind of camera by field; fields of effects that it does not have take their defaults."""
    # The sun is not the camera's, and neither is what varies.
    parts = (part for part in map(FLAT_PARTS.__getitem__, REALISM_PARTS) if part not in (Sunlight, Varied))
    usual = {one.name: one.default for part in parts for one in declared_fields(part)}
    return {**usual, **preset.values}


def preset_named(name: str, presets: Sequence[Preset] = PRESETS) -> Preset:
    """Find a preset by its name.

    Raises
    ------
    InvalidInput
        No such preset; lists the names.
    """
    found = next((preset for preset in presets if preset.name == name), None)
    if found is None:
        names = ", ".join(preset.name for preset in presets)
        raise InvalidInput("preset {0!r}: must be one of {1}", name, names, field="preset")
    return found
