"""Python packages that the plugin needs in addition to QGIS."""

from __future__ import annotations

from importlib.util import find_spec

#: Packages by the module that they provide.
NEEDED = {"numpy": "numpy", "pyproj": "pyproj", "PIL": "Pillow", "requests": "requests"}


def missing_packages(*more: str) -> list[str]:
    """Packages of `NEEDED` and ``more`` that this QGIS lacks; nothing is imported."""
    wanted = {**NEEDED, **{name: name for name in more}}
    return [package for module, package in wanted.items() if find_spec(module) is None]
