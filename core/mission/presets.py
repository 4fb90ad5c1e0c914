"""Cameras by name: those that ship, with the source of their facts, and the user's own."""

from __future__ import annotations

import difflib

from ..errors import InvalidInput
from ..geodesy.camera import SQUARE_PIXELS
from .camera_preset import CameraPreset, shipped_cameras
from .user_cameras import add_camera, camera_shelf, key, remove_camera, user_cameras

__all__ = [
    "SQUARE_PIXELS",
    "CameraPreset",
    "add_camera",
    "camera_named",
    "camera_shelf",
    "cameras",
    "remove_camera",
    "shipped_cameras",
    "user_cameras",
]


def cameras() -> tuple[CameraPreset, ...]:
    """Return the cameras that ship, the paper's first, then the user's own (``user`` is True).

    Raises
    ------
    InvalidInput
        The user's file cannot be read; names it.
    """
    return (*shipped_cameras(), *user_cameras())


def camera_named(name: str) -> CameraPreset:
    """Preset of a name, in any case; the maker's name may be left out.

    Raises
    ------
    InvalidInput
        Naming those that are close.
    """
    shipped, wanted = shipped_cameras(), key(name)
    found = _named(wanted, shipped, full=True)
    if found is not None:
        return found
    # The user's file, which may be broken, is read only for what does not ship under its full name.
    own = camera_shelf()
    for other, problem in own.problems.items():
        if key(other) == wanted:
            raise InvalidInput(problem)
    presets = (*own.presets, *shipped)
    found = _named(wanted, own.presets, full=True) or _named(wanted, presets, full=False)
    if found is not None:
        return found
    names = {key(preset.name): preset.name for preset in presets}
    close = [names[near] for near in difflib.get_close_matches(wanted, names, n=3, cutoff=0.5)]
    close = close or [known for near, known in names.items() if wanted and wanted in near][:3]
    hint = f"did you mean {' or '.join(close)}? " if close else ""
    raise InvalidInput(f"camera {name!r} is unknown: {hint}`terrainav cameras` lists the names")


def _named(wanted: str, presets: tuple[CameraPreset, ...], *, full: bool) -> CameraPreset | None:
    for preset in presets:
        own = key(preset.name)
        if wanted and wanted == (own if full else own.partition(" ")[2]):
            return preset
    return None
