"""Footprints of a dataset, by position and index. On any thread; no file stays open.

QGIS reads a GeoJSON file from its beginning for every query, which takes seconds for a hundred thousand features.
Captures write one footprint per line: here their file is read once, and after that only at the lines needed. A JSON
parser on another thread would hold the GIL and block the user interface for seconds; numpy releases the GIL while it
reads the bounds from whole arrays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS, Transformer
from pyproj.exceptions import ProjError

from ...core.arrays import Bytes, Floats, Numbers
from ...core.dataset.folder import FOOTPRINTS_FILE
from ...core.errors import Cancelled, InvalidInput
from ...core.limits import MAX_LINE_BYTES, MAX_TABLE_BYTES
from ...core.storage.files import open_foreign, read_line, too_long_line
from ...core.text.safe_json import parse_json
from ..i18n import tr

#: Size of blocks to read: large enough for fast array operations, small in memory.
_BLOCK_BYTES = 1 << 20
#: Beginning of a footprint's line.
_FEATURE = b'{"type": "Feature",'
Bounds = tuple[float, float, float, float]
_LINE_END, _BRACKET, _MINUS, _DOT, _ZERO = (ord(sign) for sign in "\n[-.0")
#: Longest number read digit by digit: a sign, 17 significant digits, a point, leading zeros.
_WIDTH = 24
_TEN = 10
_NUMBER = re.compile(rb"-?[0-9.]+(?:[eE][-+]?[0-9]+)?")


class FootprintFile:
    """Positions of the footprints of a dataset in its file and on the ground.

    Parameters
    ----------
    folder : Path
        Folder of the dataset.
    cancelled : callable
        Called repeatedly while the file is read; True stops the reading.

    Raises
    ------
    InvalidInput
        The file cannot be read or was not written by a capture.
    Cancelled
        ``cancelled`` returned True.
    """

    def __init__(self, folder: Path, cancelled: Callable[[], bool] = lambda: False) -> None:
        self.path = folder / FOOTPRINTS_FILE
        self.stamp = file_stamp(self.path)
        offsets, bounds = [np.zeros(0, np.int64)], [np.zeros((0, 4))]
        try:
            with open_foreign(self.path, MAX_TABLE_BYTES) as file:
                for offset, block in _blocks(file):
                    if cancelled():
                        raise Cancelled(tr("footprints: stopped"))
                    starts, found = _features(block)
                    offsets.append(starts + offset)
                    bounds.append(found)
        except OSError as wrong:
            raise _unreadable(self.path, wrong.strerror) from wrong
        except InvalidInput as wrong:
            raise _unreadable(self.path, wrong) from wrong
        self._offsets, self._bounds = np.concatenate(offsets), np.concatenate(bounds)
        if not len(self) or np.isnan(self._bounds).any():
            raise _unreadable(self.path, tr("it was not written by a capture"))

    def __len__(self) -> int:
        return len(self._offsets)

    def covering(self, lat_deg: float, lon_deg: float) -> list[int]:
        """Indices of the footprints whose bounds contain a position."""
        west, south, east, north = self._bounds.T
        inside = (west <= lon_deg) & (lon_deg <= east) & (south <= lat_deg) & (lat_deg <= north)
        return [int(number) for number in np.flatnonzero(inside)]

    def read(self, number: int) -> dict[str, Any]:
        """GeoJSON feature of the footprint ``number``; raises InvalidInput if it cannot be read."""
        try:
            with open_foreign(self.path, MAX_TABLE_BYTES) as file:
                file.seek(int(self._offsets[number]))
                return read_feature(read_line(file))
        except OSError as wrong:
            raise _unreadable(self.path, wrong.strerror) from wrong
        except (ValueError, IndexError) as wrong:
            raise _unreadable(self.path, tr("it has changed")) from wrong


@dataclass(frozen=True, eq=False)
class Outlines:
    """Outlines of a dataset's footprints, as concatenated rings.

    Parameters
    ----------
    stems : tuple of str
        Names of the images, without extension.
    x, y : array (n,)
        Points of all rings: longitude and latitude in degrees, or projected coordinates.
    starts : array (r + 1,)
        Index of each ring's first point; finally n.
    owners : array (r,)
        Index of each ring's image.
    """

    stems: tuple[str, ...]
    x: Floats
    y: Floats
    starts: Numbers
    owners: Numbers

    def projected(self, wkt: str) -> Outlines:
        """Outlines in the CRS of ``wkt``; points outside its domain are infinite.

        Raises
        ------
        InvalidInput
            There is no transformation to the CRS.
        """
        try:
            transformer = Transformer.from_crs("EPSG:4326", CRS.from_wkt(wkt), always_xy=True)
            x, y = transformer.transform(self.x, self.y)
        except ProjError as wrong:
            raise InvalidInput(tr("cannot draw in the map's CRS ({reason})").format(reason=wrong)) from wrong
        return Outlines(self.stems, np.asarray(x), np.asarray(y), self.starts, self.owners)

    def bounds(self, stem: str) -> Bounds | None:
        """West, south, east and north of an image's outline; None if it has no outline."""
        if stem not in self.stems:
            return None
        rings = np.flatnonzero(self.owners == self.stems.index(stem))
        if not len(rings):
            return None
        places = slice(int(self.starts[rings[0]]), int(self.starts[rings[-1] + 1]))
        x, y = self.x[places], self.y[places]
        if not (np.isfinite(x).all() and np.isfinite(y).all()):
            return None
        return float(x.min()), float(y.min()), float(x.max()), float(y.max())


def read_outlines(folder: Path, cancelled: Callable[[], bool] = lambda: False) -> Outlines:
    """Outlines of a capture's footprints; empty if there is no file of them.

    Raises
    ------
    InvalidInput
        The file cannot be read.
    Cancelled
        ``cancelled`` has returned True.
    """
    path = folder / FOOTPRINTS_FILE
    stems: list[str] = []
    x: list[float] = []
    y: list[float] = []
    starts, owners = [0], []
    try:
        # Images from other programs have no footprints.
        for feature in map(read_feature, feature_lines(path) if path.is_file() else ()):
            # Check for cancellation every 500 footprints.
            if len(stems) % 500 == 0 and cancelled():
                raise Cancelled(tr("footprints: stopped"))
            for ring in chain.from_iterable(polygon_rings(feature)):
                x += [at[0] for at in ring]
                y += [at[1] for at in ring]
                starts.append(len(x))
                owners.append(len(stems))
            stems.append(str(feature["properties"]["name"]))
    except (OSError, ValueError, KeyError, TypeError, IndexError) as wrong:
        raise InvalidInput(
            tr("footprints {path}: cannot be read ({reason})").format(path=path, reason=wrong)
        ) from wrong
    return Outlines(
        tuple(stems),
        np.array(x, np.float64),
        np.array(y, np.float64),
        np.array(starts, np.int64),
        np.array(owners, np.int64),
    )


def file_stamp(path: Path) -> tuple[int, int]:
    """Modification time and length of a file; zeros if it does not exist."""
    try:
        found = path.stat()
    except OSError:
        return 0, 0
    return found.st_mtime_ns, found.st_size


def polygon_rings(feature: dict[str, Any]) -> list[list[list[list[float]]]]:
    """Polygons of a feature, each a list of closed rings of longitudes and latitudes."""
    geometry = feature["geometry"]
    coordinates = geometry["coordinates"]
    # Captures write several rings for parts on either side of the antimeridian.
    return coordinates if geometry["type"] == "MultiPolygon" else [coordinates]


def feature_lines(path: Path) -> Iterator[bytes]:
    """Lines of the features of a file."""
    # Read large blocks: a thread that reads little at a time retakes the GIL before another thread wakes, which would
    # block the main thread for most of a second.
    with open_foreign(path, MAX_TABLE_BYTES, _BLOCK_BYTES) as file:
        while line := read_line(file):
            if line.startswith(_FEATURE):
                yield line


def read_feature(line: bytes) -> dict[str, Any]:
    """Parse the feature in a line; raises InvalidInput if the line is not JSON."""
    feature = parse_json(line.rstrip().rstrip(b","))
    return feature if isinstance(feature, dict) else {}


def lines_and_bounds(text: Bytes) -> tuple[Numbers, Floats]:
    """Start of each line, (n,), and the bounds of its positions, (n, 4); NaN for a line without positions.

    Bounds are west, south, east and north, exact except for the last digit of a double.

    Parameters
    ----------
    text : array of bytes
        Whole lines as written by Python's `json`: a bracket before a number begins a position.
    """
    starts = np.concatenate([[0], np.flatnonzero(text[:-1] == _LINE_END) + 1])
    padded = np.concatenate([text, np.zeros(_WIDTH, np.uint8)])
    lon_at = np.flatnonzero((text == _BRACKET) & _begins_number(padded[1 : len(text) + 1])) + 1
    bounds = np.full((len(starts), 4), np.nan)
    if not len(lon_at):
        return starts, bounds
    lon, length = _numbers(padded, lon_at)
    lat, _ = _numbers(padded, lon_at + length + len(", "))
    first = np.searchsorted(lon_at, starts)
    filled = np.flatnonzero(first < np.append(first[1:], len(lon_at)))
    for column, values in enumerate((lon, lat)):
        bounds[filled, column] = np.minimum.reduceat(values, first[filled])
        bounds[filled, column + 2] = np.maximum.reduceat(values, first[filled])
    return starts, bounds


def _blocks(file: IO[bytes]) -> Iterator[tuple[int, Bytes]]:
    """Blocks of whole lines, with their offsets in the file."""
    offset, rest = 0, b""
    while chunk := file.read(_BLOCK_BYTES):
        whole, end, new_rest = chunk.rpartition(b"\n")
        if end:
            text = rest + whole + end
            yield offset, np.frombuffer(text, np.uint8)
            offset, rest = offset + len(text), new_rest
        else:
            rest += chunk
        if len(rest) > MAX_LINE_BYTES:
            raise too_long_line()
    if rest:
        yield offset, np.frombuffer(rest + b"\n", np.uint8)


def _features(block: Bytes) -> tuple[Numbers, Floats]:
    """Starts of the feature lines in a block, and their bounds."""
    starts, bounds = lines_and_bounds(block)
    beginning = np.frombuffer(_FEATURE, np.uint8)
    at = np.minimum(starts[:, np.newaxis] + np.arange(len(beginning)), len(block) - 1)
    ours = (block[at] == beginning).all(axis=1)
    return starts[ours], bounds[ours]


def _unreadable(path: Path, reason: object) -> InvalidInput:
    return InvalidInput(tr("footprints {path}: cannot be read ({reason})").format(path=path, reason=reason))


def _begins_number(signs: Bytes) -> NDArray[np.bool_]:
    return (signs - np.uint8(_ZERO) < _TEN) | (signs == _MINUS)


def _numbers(padded: Bytes, at: Numbers) -> tuple[Floats, Numbers]:
    """Numbers that begin at the indices ``at``, and their lengths in characters."""
    negative = padded[at] == _MINUS
    alive = np.ones(len(at), np.bool_)
    fraction = np.zeros(len(at), np.bool_)
    mantissa, digits, places, length = (np.zeros(len(at), np.int64) for _ in range(4))
    length += negative
    alive_at = at + negative
    for offset in range(_WIDTH - 1):
        sign = padded[np.minimum(alive_at + offset, len(padded) - 1)]
        digit = (sign - np.uint8(_ZERO)).astype(np.int64)
        is_digit, is_dot = alive & (digit < _TEN), alive & (sign == _DOT)
        alive = is_digit | is_dot
        if not alive.any():
            break
        # Ignore digits after the 18th, which would overflow the 64-bit mantissa.
        taken = is_digit & (digits < 18)
        mantissa = np.where(taken, mantissa * _TEN + digit, mantissa)
        digits += taken & (mantissa > 0)
        places += taken & fraction
        fraction |= is_dot
        length += alive
    values = np.where(negative, -mantissa, mantissa) / np.power(10.0, places)
    for odd in np.flatnonzero(np.isin(padded[np.minimum(at + length, len(padded) - 1)], (ord("e"), ord("E")))):
        found = _NUMBER.match(padded[at[odd] : at[odd] + 2 * _WIDTH].tobytes())
        if found is not None:
            values[odd], length[odd] = float(found[0]), len(found[0])
    return values, length
