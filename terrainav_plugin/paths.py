"""Where the plugin's own files are, and the user's."""

from __future__ import annotations

import os
from pathlib import Path

from qgis.PyQt.QtGui import QIcon

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


def style(name: str) -> str:
    """Path of a layer style."""
    return str(RESOURCES / f"{name}.qml")
