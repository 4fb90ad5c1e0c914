"""Cameras by name, from ``resources/cameras.json``: public facts of sensors and lenses, with their source."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import InvalidInput
from ..geodesy.camera import Camera
from ..resources import read_json

#: Width to height of a sensor may differ from that of its pixels by this share, which is what data sheets round
#: away; beyond, the numbers do not belong together or the pixels are not square.
SQUARE_PIXELS = 0.03


@dataclass(frozen=True)
class CameraPreset:
    """A camera by name.

    Parameters
    ----------
    name : str
    camera : Camera
    width_px, height_px : int or None
        Size of its pictures, where the source states it.
    source : str
        Where the facts are from.
    """

    name: str
    camera: Camera
    width_px: int | None
    height_px: int | None
    source: str

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> CameraPreset:
        """Preset from the facts of ``resources/cameras.json``.

        They are a sensor's ``sensor_mm``, ``focal_length_mm`` and ``size_px``, or ``aspect_ratio`` and a
        field of view (``fov_deg``, the diagonal one, or ``horizontal_fov_deg``).

        Raises
        ------
        InvalidInput
            The sensor and its pixels are of different shapes.
        """
        name, source = data["name"], data["source"]
        if "sensor_mm" not in data:
            ratio = data["aspect_ratio"][0] / data["aspect_ratio"][1]
            return cls(name, Camera(_diagonal_fov_deg(data, ratio), ratio), None, None, source)
        width_mm, height_mm = data["sensor_mm"]
        width_px, height_px = data["size_px"]
        if abs((width_mm / height_mm) / (width_px / height_px) - 1.0) > SQUARE_PIXELS:
            raise InvalidInput(
                f"camera {name}: sensor {width_mm} by {height_mm} mm and {width_px} by {height_px} px: pixels "
                "would not be square"
            )
        half = math.hypot(width_mm, height_mm) / 2.0
        fov_deg = math.degrees(2.0 * math.atan(half / data["focal_length_mm"]))
        return cls(name, Camera(fov_deg, width_px / height_px), width_px, height_px, source)


def _diagonal_fov_deg(data: Mapping[str, Any], aspect_ratio: float) -> float:
    if "fov_deg" in data:
        return float(data["fov_deg"])
    half = math.tan(math.radians(data["horizontal_fov_deg"]) / 2.0)
    return math.degrees(2.0 * math.atan(half * math.hypot(1.0, 1.0 / aspect_ratio)))


def cameras() -> tuple[CameraPreset, ...]:
    """Return the presets, the paper's first."""
    return tuple(CameraPreset.from_dict(data) for data in read_json("cameras.json"))


def camera_named(name: str) -> CameraPreset:
    """Preset of a name, in any case; the maker's name may be left out.

    Raises
    ------
    InvalidInput
        Naming those that are close.
    """
    presets = cameras()
    wanted = " ".join(name.lower().split())
    for full in (True, False):
        for preset in presets:
            own = preset.name.lower()
            if wanted and wanted == (own if full else own.partition(" ")[2]):
                return preset
    names = {preset.name.lower(): preset.name for preset in presets}
    close = [names[found] for found in difflib.get_close_matches(wanted, names, n=3, cutoff=0.5)]
    close = close or [preset.name for preset in presets if wanted and wanted in preset.name.lower()][:3]
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise InvalidInput(f"camera {name!r} is unknown: {hint}`terrainav cameras` lists the names")
