"""GPX 1.0 and 1.1: track points, or route points in files without a track."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..errors import InvalidInput, Message, OptionName
from ..mission.clock import implausible
from ..text.plain import finite_number, time_s
from ..text.safe_xml import ATTRIBUTES, UnreadableXMLError, XMLReader, iterate_elements
from .logs import missing_reader
from .track import REPORT_EACH, Progress, Track, report, unwatched

_TRACK, _ROUTE = ATTRIBUTES


def read_gpx(
    body: bytes,
    name: str = "GPX file",
    read_xml: XMLReader = iterate_elements,
    progress: Progress = unwatched,
    *,
    with_times: bool = True,
) -> Track:
    """Read a track, segment after segment. Heights stay in the file's reference; the ground height is unknown.

    If some points have a time, points without a time are left out and counted.

    Parameters
    ----------
    name : str
        Name of the file in messages.
    read_xml : callable
        XML reader; lxml by default.
    progress : callable
    with_times : bool
        Whether to read times; if not, no point is left out.

    Raises
    ------
    InvalidInput
        Not GPX; points without a place; times that decrease or are implausible.
    OutputError
        lxml is not installed.
    Cancelled
        ``progress`` returned False.
    """
    try:
        found = _points(body, read_xml, progress)
    except UnreadableXMLError as wrong:
        raise InvalidInput("{0}: cannot be read as GPX ({1})", name, wrong) from wrong
    except ImportError as missing:
        raise missing_reader("lxml") from missing
    points = found[_TRACK] or found[_ROUTE]
    if not points:
        raise InvalidInput("{0}: has no track points and no route points", name)
    rows = np.array([_row(point, f"{name}, point {number}:") for number, point in enumerate(points, 1)])
    timed = np.isfinite(rows[:, 3])
    if not (with_times and timed.any()):
        return Track(*rows[:, :3].T)
    lat, lon, height, times = rows[timed].T
    backward = np.flatnonzero(np.diff(times) < 0.0)
    fault = implausible(times, dated=True)
    if len(backward):
        fault = Message("its times go back at point {0:,}", int(backward[0]) + 2)
    if fault is not None:
        raise InvalidInput(
            "{0}: {1}", name, fault, remedy=Message("leave the times out{0}", OptionName("times").in_brackets)
        )
    return Track(lat, lon, height, None, times, without_time=int(np.count_nonzero(~timed)))


def _points(body: bytes, read_xml: XMLReader, progress: Progress) -> dict[str, list[dict[str, str]]]:
    """Attributes and child texts of each point, by element name."""
    # About one event per tag.
    most = max(body.count(b"<"), 1)
    found: dict[str, list[dict[str, str]]] = {_TRACK: [], _ROUTE: []}
    open_: list[str] = []
    for number, (name, text, attributes) in enumerate(read_xml(body)):
        if number % REPORT_EACH == 0:
            report(progress, min(number / most, 1.0))
        if not name:
            open_.pop()
            continue
        open_.append(name)
        if name in found:
            found[name].append(dict(attributes))
        elif len(open_) > 1 and open_[-2] in found and text.strip():
            # The first of repeated children counts.
            found[open_[-2]][-1].setdefault(name, text.strip())
    return found


def _row(point: Mapping[str, str], where: str) -> tuple[float, float, float, float]:
    """Latitude, longitude, height and time of a point; NaN for a missing height or time."""
    elevation, time = point.get("ele"), point.get("time")
    return (
        finite_number(point.get("lat", ""), where),
        finite_number(point.get("lon", ""), where),
        math.nan if elevation is None else finite_number(elevation, where),
        math.nan if time is None else time_s(time, where),
    )
