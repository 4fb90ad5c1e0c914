"""The SQLite file in which the features of a layer are kept, with an R*Tree of their boxes."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Floats
from .features import POINT, Features, starts
from .reading import Record
from .shaping import Reference, extent, shaped, size_m
from .wkb import Part, parse_wkb

if TYPE_CHECKING:
    import sqlite3

#: Features that are checked and transformed at once.
_BATCH = 5_000
_ROWS = """
SELECT number, kind, shape, field_values FROM boxes JOIN features USING (number)
WHERE east >= ? AND west <= ? AND north >= ? AND south <= ? AND (size_m >= ? OR kind = ?)
"""
#: Those whose boxes have their middles nearest to a place, at a latitude whose cosine, squared, is given.
_NEAREST = "ORDER BY ? * (west + east - ?) * (west + east - ?) + (south + north - ?) * (south + north - ?) LIMIT ?"
_COUNT = "SELECT count(*) FROM boxes WHERE east >= ? AND west <= ? AND north >= ? AND south <= ?"
_TABLES = """
PRAGMA journal_mode = OFF;
PRAGMA synchronous = OFF;
CREATE TABLE about (name TEXT PRIMARY KEY, value TEXT);
CREATE TABLE features (number INTEGER PRIMARY KEY, kind INTEGER, size_m REAL, shape BLOB, field_values TEXT);
CREATE VIRTUAL TABLE boxes USING rtree (number, west, east, south, north);
"""


@contextlib.contextmanager
def connection(path: Path, mode: str) -> Iterator[sqlite3.Connection]:
    """Open an index (``ro`` or ``rwc``), and close it."""
    import sqlite3

    opened = sqlite3.connect(f"{path.absolute().as_uri()}?mode={mode}", uri=True)
    try:
        yield opened
        opened.commit()
    finally:
        opened.close()


def write_index(
    path: Path,
    records: Iterator[Record],
    reference: Reference,
    about: dict[str, Any],
    progress: Callable[[int], object] = lambda _count: None,
) -> None:
    """Write all features of a layer, with counts of all, of those repaired and of those left out.

    Parameters
    ----------
    progress : callable
        Called with the number of features written so far, after each batch; its exceptions end the work.
    """
    count = repaired = dropped = 0
    with connection(path, "rwc") as database:
        database.executescript(_TABLES)
        while batch := list(islice(records, _BATCH)):
            parsed = [_parsed(shape) for shape, _, _ in batch]
            made = shaped(parsed, reference)
            rows = [
                (number, parts, values)
                for number, (parts, (_, _, values)) in enumerate(zip(made, batch), count + 1)
                if parts
            ]
            _insert(database, rows)
            count += len(batch)
            dropped += len(batch) - len(rows)
            repaired += sum(mended and bool(parts) for parts, (_, mended, _) in zip(made, batch))
            progress(count)
        state = {**about, "count": count, "repaired": repaired, "dropped": dropped}
        database.executemany(
            "INSERT INTO about VALUES (?, ?)", [(name, json.dumps(one)) for name, one in state.items()]
        )


def _parsed(shape: bytes) -> list[Part]:
    return parse_wkb(shape) if shape else []


def _insert(database: sqlite3.Connection, rows: Sequence[tuple[int, list[Part], tuple[Any, ...]]]) -> None:
    boxes, features = [], []
    for number, parts, values in rows:
        west, south, east, north = box = extent(parts)
        # Each box begins within one turn of the Earth, and so is found by whole turns.
        turn = 360.0 * math.floor((west + 180.0) / 360.0)
        boxes.append((number, west - turn, east - turn, south, north))
        features.append((number, parts[0][0], size_m(box), _packed(parts, turn), json.dumps(values, default=str)))
    database.executemany("INSERT INTO boxes VALUES (?, ?, ?, ?, ?)", boxes)
    database.executemany("INSERT INTO features VALUES (?, ?, ?, ?, ?)", features)


def _packed(parts: list[Part], turn_deg: float) -> bytes:
    """Numbers of parts and rings, rings of each part, vertices of each ring, longitudes, latitudes."""
    rings = [ring for _, all_of in parts for ring in all_of]
    head = [len(parts), len(rings), *(len(all_of) for _, all_of in parts), *(len(ring) for ring in rings)]
    places = np.concatenate(rings)
    numbers = np.concatenate([places[:, 0] - turn_deg, places[:, 1]])
    return bytes(np.array(head, "<i8").tobytes() + numbers.astype("<f8").tobytes())


def read_about(path: Path) -> dict[str, Any]:
    """Description of the layer, as written."""
    with connection(path, "ro") as database:
        return {name: json.loads(value) for name, value in database.execute("SELECT name, value FROM about")}


def read_rows(
    path: Path, box: tuple[float, float, float, float], least_m: float, most: int = -1
) -> list[tuple[int, int, bytes, str, float]]:
    """Number, kind, shape, values and shift in degrees of the features that meet a box, by number.

    With ``most``, only those nearest to the middle of the box.
    """
    found: list[tuple[int, int, bytes, str, float]] = []
    with connection(path, "ro") as database:
        for shift, edges in _turns(box):
            chosen = (*edges, least_m, POINT)
            if most < 0:
                rows = database.execute(_ROWS, chosen)
            else:
                west, east, south, north = edges
                across, up = (west + east,) * 2, (south + north,) * 2
                narrow = math.cos(math.radians((south + north) / 2.0)) ** 2
                rows = database.execute(_ROWS + _NEAREST, (*chosen, narrow, *across, *up, most))
            found += [(*row, shift) for row in rows]
    found.sort(key=lambda row: (row[0], row[4]))
    return found[:most] if most >= 0 else found


def count_rows(path: Path, box: tuple[float, float, float, float]) -> int:
    """Number of features that meet a box."""
    with connection(path, "ro") as database:
        return sum(database.execute(_COUNT, edges).fetchone()[0] for _, edges in _turns(box))


def _turns(box: tuple[float, float, float, float]) -> Iterator[tuple[float, tuple[float, float, float, float]]]:
    """Shift in degrees of each turn of the Earth that meets a box; the box there as west, east, south, north."""
    west, south, east, north = box
    # A feature's box begins in [-180, 180) and is at most a turn wide.
    for turn in range(math.floor((west - 180.0) / 360.0), math.floor((east + 180.0) / 360.0) + 1):
        shift = 360.0 * turn
        yield shift, (west - shift, east - shift, south, north)


def read_values(path: Path) -> Iterator[list[Any]]:
    """Values of all fields of each feature that was kept."""
    with connection(path, "ro") as database:
        for (text,) in database.execute("SELECT field_values FROM features ORDER BY number"):
            yield json.loads(text)


def unpack(rows: Sequence[tuple[int, int, bytes, str, float]], chosen: dict[str, int]) -> Features:
    """Features of rows, with the values of fields, each at its place among all fields."""
    parts, rings, vertices = [], [], []
    lon: list[Floats] = []
    lat: list[Floats] = []
    for _, _, shape, _, shift in rows:
        count, of_rings = np.frombuffer(shape, "<i8", 2).tolist()
        head = np.frombuffer(shape, "<i8", count + of_rings, 16)
        places = np.frombuffer(shape, "<f8", offset=8 * (2 + count + of_rings)).reshape(2, -1)
        parts.append(count)
        rings.append(head[:count])
        vertices.append(head[count:])
        lon.append(places[0] + shift)
        lat.append(places[1])
    values = [json.loads(row[3]) for row in rows] if chosen else []
    return Features(
        np.array([row[0] for row in rows], np.int64),
        np.array([row[1] for row in rows], np.uint8),
        np.concatenate([np.empty(0), *lon]),
        np.concatenate([np.empty(0), *lat]),
        starts(vertices),
        starts(rings),
        starts([np.array(parts, np.int64)]),
        {name: tuple(one[place] for one in values) for name, place in chosen.items()},
    )
