"""Tracks of GNSS receivers: GPX 1.0 and 1.1, their track points, else their route points."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..errors import InvalidInput
from ..safe_xml import UnreadableXMLError, root_of
from ..text import time_s
from .logs import reader_module
from .track import Track


def read_gpx(body: bytes, name: str = "GPX file") -> Track:
    """Read a track, its segments one after the other. Heights are the file's own; that of the ground is not known.

    Raises
    ------
    InvalidInput
        No GPX; points without a place, or with times that go back or that only some of them have.
    OutputError
        lxml is not installed.
    """
    reader_module("lxml.etree", "lxml")
    try:
        root = root_of(body)
    except UnreadableXMLError as wrong:
        raise InvalidInput("{0}: cannot be read as GPX ({1})", name, wrong) from wrong
    points = list(root.iter("{*}trkpt")) or list(root.iter("{*}rtept"))
    if not points:
        raise InvalidInput("{0}: has no track points and no route points", name)
    rows = np.array([_row(point, f"{name}, point {number}:") for number, point in enumerate(points, 1)])
    lat, lon, height, times = rows.T
    timed = np.isfinite(times)
    if timed.any() and not timed.all():
        raise InvalidInput("{0}: point {1:,} has no time, and others have", name, int(np.argmin(timed)) + 1)
    back = np.flatnonzero(np.diff(times) < 0.0)
    if len(back):
        raise InvalidInput("{0}: its times go back at point {1:,}", name, int(back[0]) + 2)
    return Track(lat, lon, height, None, times if timed.all() else None)


def _row(point: Any, where: str) -> tuple[float, float, float, float]:
    """Latitude, longitude, height and time of a point; NaN for what it may lack."""
    elevation, time = (_text(point, child) for child in ("ele", "time"))
    return (
        _number(point.get("lat", ""), where),
        _number(point.get("lon", ""), where),
        math.nan if elevation is None else _number(elevation, where),
        math.nan if time is None else time_s(time, where),
    )


def _text(point: Any, child: str) -> str | None:
    found = point.find(f"{{*}}{child}")
    return None if found is None or not (found.text or "").strip() else str(found.text).strip()


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidInput("{0} {1!r}: must be a number", where, text[:80])
    return value
