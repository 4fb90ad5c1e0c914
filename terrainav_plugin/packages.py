"""Python packages that the plugin needs beside QGIS, and whether they are there."""

from __future__ import annotations

from importlib.util import find_spec

#: Modules, and what they are called where they can be had.
NEEDED = {"numpy": "numpy", "pyproj": "pyproj", "PIL": "Pillow", "requests": "requests"}


def missing_packages(*more: str) -> list[str]:
    """Names of needed packages, and of those in ``more``, that this QGIS lacks; nothing is imported."""
    wanted = {**NEEDED, **{name: name for name in more}}
    return [package for module, package in wanted.items() if find_spec(module) is None]
