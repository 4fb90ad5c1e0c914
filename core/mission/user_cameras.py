"""A user's own cameras: kept by name in a file of the user's configuration folder."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, NamedTuple

from ..config import config_file, read_named, write_named
from ..errors import InvalidInput
from .camera_preset import CameraPreset, shipped_cameras

FILE = "cameras.json"
#: Longest name, in characters, that a list of cameras has room for.
LONGEST_NAME = 64


class Shelf(NamedTuple):
    """A user's own cameras, and what is wrong with those that are left out.

    Parameters
    ----------
    presets : tuple of CameraPreset
    problems : mapping of str to str
        Name of a camera to what is wrong with it; names the file.
    """

    presets: tuple[CameraPreset, ...]
    problems: Mapping[str, str]


def camera_shelf(folder: str | os.PathLike[str] | None = None) -> Shelf:
    """Return the user's cameras that are right, and what is wrong with the others: one does not hide another.

    Raises
    ------
    InvalidInput
        The file cannot be read; names it.
    """
    path = config_file(FILE, folder)
    taken = {key(preset.name): preset.name for preset in shipped_cameras()}
    presets: list[CameraPreset] = []
    problems: dict[str, str] = {}
    for name, data in read_named(path, "cameras").items():
        preset = _preset_or_problem(name, data, taken)
        if isinstance(preset, CameraPreset):
            presets.append(preset)
            taken[key(name)] = name
        else:
            problems[name] = f"{path}: {preset}"
    return Shelf(tuple(presets), problems)


def user_cameras(folder: str | os.PathLike[str] | None = None) -> tuple[CameraPreset, ...]:
    """Return the user's cameras that are right; raises as `camera_shelf`, which tells of the others."""
    return camera_shelf(folder).presets


def add_camera(
    name: str, data: Mapping[str, Any], folder: str | os.PathLike[str] | None = None
) -> CameraPreset:
    """Keep a camera under a name.

    Parameters
    ----------
    name : str
        Of one line, without spaces around it; none that is taken, in any case.
    data : mapping
        Facts as `CameraPreset.from_dict` takes them.

    Raises
    ------
    InvalidInput
        The name or the facts are not right.
    OutputError
        The file cannot be written.
    """
    path = config_file(FILE, folder)
    known = read_named(path, "cameras")
    taken = {key(other): other for other in (*(preset.name for preset in shipped_cameras()), *known)}
    _check_name(name, taken)
    preset = _preset(name, data)
    write_named(path, {**known, name: dict(data)})
    return preset


def remove_camera(name: str, folder: str | os.PathLike[str] | None = None) -> str:
    """Forget a camera of the user; its name may be in any case.

    Returns
    -------
    str
        Its name as it was kept.

    Raises
    ------
    InvalidInput
        There is no such camera, or it is one that ships.
    """
    path = config_file(FILE, folder)
    known = read_named(path, "cameras")
    found = name if name in known else next((own for own in known if key(own) == key(name)), None)
    if found is None:
        if any(key(preset.name) == key(name) for preset in shipped_cameras()):
            raise InvalidInput(f"camera {name!r}: comes with TerrAInav, and stays as it is")
        raise InvalidInput(f"camera {name!r}: is none of your own, which are {', '.join(known) or 'none'}")
    write_named(path, {other: data for other, data in known.items() if other != found})
    return found


def key(name: str) -> str:
    """What two names of one camera have in common: case and spaces do not matter."""
    return " ".join(name.casefold().split())


def _check_name(name: str, taken: Mapping[str, str]) -> None:
    if not (0 < len(name) <= LONGEST_NAME and name.isprintable() and name == " ".join(name.split())):
        raise InvalidInput(
            f"camera name {name!r}: must be 1 to {LONGEST_NAME} characters of one line, with single spaces inside"
        )
    if key(name) in taken:
        raise InvalidInput(f"camera name {name!r}: {taken[key(name)]} is taken; choose another")


def _preset(name: str, data: Any) -> CameraPreset:
    if not isinstance(data, Mapping):
        raise InvalidInput(f"camera {name}: must be an object")
    return CameraPreset.from_dict(name, data, user=True)


def _preset_or_problem(name: str, data: Any, taken: Mapping[str, str]) -> CameraPreset | str:
    try:
        _check_name(name, taken)
        return _preset(name, data)
    except InvalidInput as wrong:
        return str(wrong)
