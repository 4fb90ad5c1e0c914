"""A plan as a table (CSV), and batches of rows, times and rings that bound the memory for a million captures."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...arrays import NDArray
from ...errors import InvalidInput
from ...geodesy.mercator import wrap_lon_deg
from ..outlines import footprints_deg
from ..plan import Plan

#: Longitudes and latitudes of a closed ring.
Corners = list[tuple[float, float]]
#: Columns of the table: poses, windows on the pixel grid, and ground corners; then those of the plan's random values.
POSE_COLUMNS = ("name", "column", "row", "lat_deg", "lon_deg", "agl_m", "yaw_deg", "tilt_deg", "roll_deg")
WINDOW_COLUMNS = ("zoom", "left_px", "top_px", "width_px", "height_px")
CORNER_COLUMNS = tuple(f"{corner}_{axis}_deg" for corner in ("nw", "ne", "se", "sw") for axis in ("lat", "lon"))
COLUMNS = POSE_COLUMNS + WINDOW_COLUMNS + CORNER_COLUMNS
#: Captures per batch.
BATCH = 10_000


def parts(count: int) -> Iterator[slice]:
    """Slices of `BATCH` that cover ``count``."""
    for start in range(0, count, BATCH):
        yield slice(start, min(start + BATCH, count))


def batches(plan: Plan) -> Iterator[dict[str, list[Any]]]:
    """Columns of the table, batch by batch, as Python values."""
    left = plan.wrapped_left_px
    poses = plan.poses._replace(lon_deg=wrap_lon_deg(plan.lon_deg))
    columns = {**poses._asdict(), **plan.windows._replace(left_px=left)._asdict()}
    if not plan.relief.is_level:
        columns["height_m"] = plan.height_m
    corner_lon = wrap_lon_deg(plan.corners.lon_deg)
    for part in parts(len(plan)):
        batch: dict[str, list[Any]] = {
            "name": plan.names[part],
            "column": plan.column[part].tolist(),
            "row": plan.row[part].tolist(),
            "zoom": plan.zooms[part].tolist(),
            **{name: values[part].tolist() for name, values in columns.items()},
        }
        drawn = [plan.drawn(index) for index in range(part.start, part.stop)] if plan.drawn_fields else []
        batch.update((name, [values[name] for values in drawn]) for name in plan.drawn_fields)
        if plan.direct.has_times:
            batch["time_utc"] = clock(plan.direct.start, plan.times_s[part])
        for index, corner in enumerate(("nw", "ne", "se", "sw")):
            hit = plan.corners.hit[part, index].tolist()
            for axis, values in (
                ("lat", plan.corners.lat_deg[part, index]),
                ("lon", corner_lon[part, index]),
            ):
                # The view through a corner may miss the Earth.
                cells = values.tolist()
                batch[f"{corner}_{axis}_deg"] = cells if all(hit) else [c if h else "" for c, h in zip(cells, hit)]
        yield batch


def sortie_numbers(plan: Plan) -> list[int] | None:
    """Sortie of each capture, (n,), numbered from 1; None if there is only one."""
    path = plan.path
    if path.sorties == 1:
        return None
    numbers = np.empty(len(plan), np.int64)
    taken = path.capture >= 0
    numbers[path.capture[taken]] = path.sortie[taken] + 1
    found: list[int] = numbers.tolist()
    return found


def closed_rings(plan: Plan, part: slice) -> Iterator[list[Corners]]:
    """Closed counter-clockwise rings of each footprint; several where it crosses the antimeridian."""
    for rings in footprints_deg(plan, part):
        yield [[*zip(x.tolist(), y.tolist()), (float(x[0]), float(y[0]))] for x, y in rings]


def clock(start: str, times_s: NDArray[np.float64]) -> list[str]:
    """UTC times, as ISO 8601 to the millisecond (2024-06-21T10:30:00.000Z), of seconds after a start.

    Raises
    ------
    InvalidInput
        A time is after the year 9999, the last in ISO 8601.
    """
    first = np.datetime64(start.rstrip("Z"), "us")
    milliseconds = np.round((first - np.datetime64(0, "us")).astype(np.int64) / 1000.0 + times_s * 1000.0)
    if milliseconds.max() >= np.datetime64("10000-01-01", "ms").astype(np.int64):
        raise InvalidInput(
            "start {0!r}: the flight of {1:.3g} s goes beyond the year 9999",
            start,
            times_s.max(),
            field="start",
            remedy="start earlier",
        )
    texts = np.datetime_as_string(milliseconds.astype("datetime64[ms]"), unit="ms")
    return [f"{text}Z" for text in texts.tolist()]


def csv_text(plan: Plan) -> Iterator[str]:
    """Text of the table, in blocks."""
    more = [
        name for name, known in (("time_utc", plan.direct.has_times), ("height_m", not plan.relief.is_level)) if known
    ]
    names = (*POSE_COLUMNS, *more, *WINDOW_COLUMNS, *CORNER_COLUMNS, *plan.drawn_fields)
    yield ",".join(names) + "\n"
    for batch in batches(plan):
        rows = zip(*(batch[name] for name in names))
        # str() of a float is its shortest exact form.
        yield "".join(",".join(map(str, row)) + "\n" for row in rows)
