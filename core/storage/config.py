"""The user's configuration folder, and its JSON files of named entries."""

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

#: Environment variable that overrides the platform's configuration folder.
FOLDER_ENV = "TERRAINAV_CONFIG_DIR"

Entry = TypeVar("Entry")


def default_folder() -> Path:
    """Return the user's configuration folder, which may not exist yet."""
    if os.environ.get(FOLDER_ENV):
        return Path(os.environ[FOLDER_ENV])
    if sys.platform == "win32":
        parent_folder = Path(os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming")
    elif sys.platform == "darwin":
        parent_folder = Path.home() / "Library" / "Application Support"
    else:
        parent_folder = Path(os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config")
    return parent_folder / "terrainav"


def config_file(name: str, folder: str | os.PathLike[str] | None = None) -> Path:
    """Path of a configuration file in ``folder``, by default `default_folder`."""
    return (default_folder() if folder is None else Path(folder)) / name


def read_named(path: Path, what: str) -> dict[str, Any]:
    """Read entries by name from a JSON file; empty if the file does not exist.

    Parameters
    ----------
    path : Path
    what : str
        Plural noun for the entries, for messages.

    Raises
    ------
    InvalidInput
        The file cannot be read or is not a JSON object; the message names the file.
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
    """The user's valid entries of a kind, and the errors of invalid entries by name."""

    entries: tuple[Entry, ...]
    problems: Mapping[str, str]


def read_shelf(path: Path, what: str, entry: Callable[[str, Any], Entry]) -> Shelf[Entry]:
    """Read entries of a JSON file as `read_named` does; collect errors of invalid entries.

    Parameters
    ----------
    path : Path
    what : str
        Plural noun for the entries, for messages.
    entry : callable
        Creates an entry from its name and data, or raises InvalidInput.

    Raises
    ------
    InvalidInput
        The file cannot be read; the message names the file.
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
    """Write entries by name atomically; the folder is created if necessary.

    Raises
    ------
    OutputError
    """
    try:
        make_folder(path.parent)
        write_whole(path, json_bytes(data))
    except OutputError as wrong:
        raise OutputError("{0}; {1} names another folder", wrong, FOLDER_ENV) from wrong
