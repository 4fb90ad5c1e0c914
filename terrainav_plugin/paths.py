"""Where the plugin's own files are."""

from __future__ import annotations

from pathlib import Path

from qgis.PyQt.QtGui import QIcon

RESOURCES = Path(__file__).resolve().parent.parent / "resources"


def icon(name: str) -> QIcon:
    """Icon of an action."""
    return QIcon(str(RESOURCES / f"{name}.svg"))


def style(name: str) -> str:
    """Path of a layer style."""
    return str(RESOURCES / f"{name}.qml")
