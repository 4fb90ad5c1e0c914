"""Where the plugin's own files are, and the user's."""

from __future__ import annotations

import os
import re
from collections.abc import Collection
from pathlib import Path

from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices, QIcon

#: Folder of the user's profile with what was copied of datasets at addresses.
COPIES = "TerrAInav/addresses"
RESOURCES = Path(__file__).resolve().parent.parent / "resources"


def folder_of(text: str) -> Path:
    """Folder that a user has entered; one that begins with nobody's ``~name`` is taken as it stands."""
    path = Path(text.strip())
    try:
        return path.expanduser()
    except RuntimeError:
        return path


def place_of(path: Path) -> str:
    """What two ways of writing the same path have in common."""
    return os.path.normcase(os.path.realpath(path))


def icon(name: str) -> QIcon:
    """Icon of an action."""
    return QIcon(str(RESOURCES / f"{name}.svg"))


def symbol(name: str) -> str:
    """Path of an image that a place is marked by on the map."""
    return str(RESOURCES / f"{name}.svg")


def style(name: str) -> str:
    """Path of a layer style."""
    return str(RESOURCES / f"{name}.qml")


def open_in_system(path: Path) -> None:
    """Open a folder or file with the program that the system has for it."""
    QDesktopServices.openUrl(QUrl.fromLocalFile(str(path)))


def next_folder(folder: Path, taken: Collection[Path] = ()) -> Path:
    """Folder beside ``folder`` that does not exist yet and is not ``taken``: mission, mission-2, mission-3."""
    stem = re.sub(r"-\d+$", "", folder.name)
    number = 2
    while (candidate := folder.with_name(f"{stem}-{number}")).exists() or candidate in taken:
        number += 1
    return candidate
