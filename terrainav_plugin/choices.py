"""What the dock offers to choose from."""

from __future__ import annotations

from typing import NamedTuple


class SourceChoice(NamedTuple):
    """An entry of the source chooser; ``map_types`` is empty where the source has one kind of picture."""

    name: str
    title: str
    map_types: tuple[str, ...]
    needs_key: bool


class CameraChoice(NamedTuple):
    """An entry of the camera chooser."""

    name: str
    fov_deg: float
    aspect_ratio: float
