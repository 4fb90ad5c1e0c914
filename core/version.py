"""The version, from the one place that states it for QGIS too."""

from __future__ import annotations

from configparser import ConfigParser
from pathlib import Path


def version() -> str:
    """Version in ``metadata.txt``, which lies beside this package in the plugin folder and in a wheel."""
    metadata = ConfigParser(interpolation=None)
    metadata.read(Path(__file__).parents[1] / "metadata.txt", encoding="utf-8")
    return metadata["general"]["version"]
