"""The folder of a user's configuration, and the JSON files of named things in it."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Generic, TypeVar

from ..errors import InvalidInput, Message, OutputError
from ..limits import MAX_SETTINGS_BYTES
from ..text.safe_json import parse_json
from .files import json_bytes, make_folder, read_limited, write_whole

#: Environment variable with the folder, for one elsewhere than where the platform keeps configuration.
FOLDER_ENV = "TERRAINAV_CONFIG_DIR"

Entry = TypeVar("Entry")


def default_folder() -> Path:
    """Return the folder of a user's configuration, which may not be there yet."""
    if os.environ.get(FOLDER_ENV):
        return Path(os.environ[FOLDER_ENV])
    if sys.platform == "win32":
        above = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        above = Path.home() / "Library" / "Application Support"
    else:
        above = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return above / "terrainav"


def config_file(name: str, folder: str | os.PathLike[str] | None = None) -> Path:
    """Path of a file of the configuration; ``folder`` is None for `default_folder`."""
    return (default_folder() if folder is None else Path(folder)) / name


def read_named(path: Path, what: str) -> dict[str, Any]:
    """Things by name, of a JSON file; none where there is no file.

    Parameters
    ----------
    what : str
        Plural of what they are, for messages.

    Raises
    ------
    InvalidInput
        The file cannot be read, or holds no JSON object; names it.
    """
    try:
        data = parse_json(read_limited(path, MAX_SETTINGS_BYTES))
    except FileNotFoundError:
        return {}
    except OSError as wrong:
        raise InvalidInput(
            "{0}: cannot be read ({1})", path, wrong.strerror, remedy="mend it, or move it away"
        ) from wrong
    except InvalidInput as wrong:
        raise InvalidInput(
            "{0}: cannot be read as JSON ({1})", path, wrong, remedy="mend it, or move it away"
        ) from wrong
    if not isinstance(data, dict):
        raise InvalidInput("{0}: must hold a JSON object of {1}", path, what)
    return data


@dataclass(frozen=True)
class Shelf(Generic[Entry]):
    """A user's own things of a kind that are right, and by name what is wrong with the others; names the file."""

    entries: tuple[Entry, ...]
    problems: Mapping[str, str]


def read_shelf(path: Path, what: str, entry: Callable[[str, Any], Entry]) -> Shelf[Entry]:
    """Things by name, of a JSON file as for `read_named`: one that is wrong does not hide another.

    Parameters
    ----------
    path : Path
    what : str
        Plural of what they are, for messages.
    entry : callable
        Makes one of its name and data, or raises InvalidInput.

    Raises
    ------
    InvalidInput
        The file cannot be read; names it.
    """
    entries: list[Entry] = []
    problems: dict[str, str] = {}
    for name, data in read_named(path, what).items():
        try:
            entries.append(entry(name, data))
        except InvalidInput as wrong:  # noqa: PERF203
            problems[name] = Message("{0}: {1}", path, Message(wrong))
    return Shelf(tuple(entries), problems)


def write_named(path: Path, data: Mapping[str, Any]) -> None:
    """Write things by name, whole or not at all; makes the folder.

    Raises
    ------
    OutputError
        Where it cannot be written.
    """
    try:
        make_folder(path.parent)
        write_whole(path, json_bytes(data))
    except OutputError as wrong:
        raise OutputError("{0}; {1} names another folder", wrong, FOLDER_ENV) from wrong
