"""Python packages that the plugin needs beside QGIS."""

from __future__ import annotations

from importlib.util import find_spec

#: Modules, and the packages that provide them.
NEEDED = {"numpy": "numpy", "pyproj": "pyproj", "PIL": "Pillow", "requests": "requests"}


def missing_packages(*more: str) -> list[str]:
    """Needed packages, and those in ``more``, that this QGIS lacks; imports none of them."""
    wanted = {**NEEDED, **{name: name for name in more}}
    return [package for module, package in wanted.items() if find_spec(module) is None]
