"""Translation of what users read."""

from __future__ import annotations

from qgis.PyQt.QtCore import QCoreApplication


def tr(text: str) -> str:
    """Text in the user's language; placeholders are filled in afterwards, with ``str.format``."""
    return QCoreApplication.translate("TerrAInav", text)
