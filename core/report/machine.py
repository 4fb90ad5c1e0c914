"""The machine and the software that a report was made with."""

from __future__ import annotations

import os
import platform
from pathlib import Path

import numpy as np
import PIL
import pyproj

from ..resources import version

#: Processors, on Linux.
_CPUINFO = Path("/proc/cpuinfo")


def machine() -> list[tuple[str, str]]:
    """Label and value of processor, cores and system."""
    return [
        ("processor", _processor()),
        ("cores", str(os.cpu_count() or "unknown")),
        ("system", f"{platform.system()} {platform.release()}, {platform.machine()}"),
    ]


def versions() -> list[tuple[str, str]]:
    """Name and version of TerrAInav and of the libraries that compute its results."""
    return [
        ("TerrAInav", version()),
        ("Python", platform.python_version()),
        ("numpy", np.__version__),
        ("pyproj", f"{pyproj.__version__} (PROJ {pyproj.__proj_version__})"),
        ("Pillow", PIL.__version__),
    ]


def _processor() -> str:
    try:
        lines = _CPUINFO.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    for line in lines:
        name, _, value = line.partition(":")
        if name.strip() == "model name" and value.strip():
            return " ".join(value.split())
    return platform.processor() or platform.machine() or "unknown"
