"""Read cells of CSV tables: like the csv module, but much faster on tables that captures write."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from ..arrays import Floats, NDArray
from ..errors import InvalidInput, Message
from ..numbers import real_number

Places = NDArray[np.int64]

_COMMA, _QUOTE, _LINE_END, _MINUS, _DOT, _ZERO = b',"\n-.0'
#: Most characters of a number: 19 digits, which fit 64 bits, and a point. A sign is replaced by a zero.
_PLACES = 20
#: Powers of ten up to 10^19, also exact as doubles.
_POWERS = np.array([10**power for power in range(_PLACES)], np.uint64)


class ReadCells:
    """Rows read by the csv module.

    Parameters
    ----------
    lines : sequence of int
        Lines (n,) on which the rows end, from 1.
    rows : sequence of sequence of str
        Cells of each row; all rows have the same number.
    """

    def __init__(self, lines: Sequence[int], rows: Sequence[Sequence[str]]) -> None:
        self.lines = lines
        self._columns = list(zip(*rows))

    def texts(self, column: int) -> Sequence[str]:
        """Cells (n,) of a column."""
        return self._columns[column]

    def numbers(self, column: int) -> Floats | None:  # noqa: ARG002
        """None: the caller reads the texts one by one."""
        return None


class CutCells:
    """Rows whose cells are given by their positions in a text.

    Parameters
    ----------
    first_line : int
        Line of the table on which the text begins, from 1.
    text : str
        Whole lines.
    raw : array of uint8
        The text in UTF-8, padded with ``_PLACES`` bytes.
    starts, ends : array (columns, n)
        Where cells begin and end in ``raw``.
    """

    def __init__(self, first_line: int, text: str, raw: NDArray[np.uint8], starts: Places, ends: Places) -> None:
        self._text, self._raw, self._starts, self._lengths = text, raw, starts, ends - starts
        self._shortest, self._longest = self._lengths.min(axis=1), self._lengths.max(axis=1)
        self.lines = range(first_line, first_line + starts.shape[1])

    def texts(self, column: int) -> Sequence[str]:
        """Cells (n,) of a column."""
        count, longest = len(self.lines), int(self._longest[column])
        if self._shortest[column] == longest:
            found = self._gather(column, longest)
            if _are_rows_equal(found):
                return [found[0].tobytes().decode("utf-8", "surrogatepass")] * count
        starts = self._starts[column]
        places = zip(starts.tolist(), (starts + self._lengths[column]).tolist())
        if self._text.isascii():
            return [self._text[start:end] for start, end in places]
        raw = self._raw.tobytes()
        return [raw[start:end].decode("utf-8", "surrogatepass") for start, end in places]

    def numbers(self, column: int) -> Floats | None:
        """Numbers (n,) of a column, read by `real_number`, NaN for empty cells; None if a cell is not a number."""
        count, lengths = len(self.lines), self._lengths[column]
        width = min(int(self._longest[column]), _PLACES)
        if width == 0:
            return np.broadcast_to(np.nan, count)
        found = self._gather(column, width)
        if self._shortest[column] < width:
            found[np.arange(width) >= lengths[:, None]] = _ZERO
        elif self._longest[column] == width and _are_rows_equal(found):
            # In a flight, many columns repeat one value.
            value = _parse_number(found[0].tobytes())
            return None if value is None else np.broadcast_to(value, count)
        values, sure = _parse_decimals(found, lengths)
        for row in np.flatnonzero(~sure & (lengths > 0)).tolist():
            start = self._starts[column, row]
            value = _parse_number(self._raw[start : start + lengths[row]].tobytes())
            if value is None:
                return None
            values[row] = value
        if self._shortest[column] == 0:
            values[lengths == 0] = np.nan
        return values

    def _gather(self, column: int, width: int) -> NDArray[np.uint8]:
        """First bytes (n, width) of a column's cells; a shorter cell is followed by the text after it."""
        if width == 0:
            return np.empty((len(self.lines), 0), np.uint8)
        # View the bytes from each position on as one item, so that indexing copies whole items.
        at_each: NDArray[np.void] = np.ndarray(len(self._raw) - width, f"V{width}", self._raw, 0, (1,))
        found: NDArray[np.uint8] = at_each[self._starts[column]].view(np.uint8).reshape(-1, width)
        return found


def _are_rows_equal(found: NDArray[np.uint8]) -> bool:
    """Whether all rows are the same."""
    return bool((found[0] == found[-1]).all() and (found == found[0]).all())


def _parse_number(cell: bytes) -> float | None:
    try:
        return real_number(cell.decode("utf-8", "surrogatepass")) if cell else np.nan
    except ValueError:
        return None


def _parse_decimals(found: NDArray[np.uint8], lengths: Places) -> tuple[Floats, NDArray[np.bool_]]:
    """Parse decimal numbers (n,); also return which of them certainly equal the result of ``float``.

    Parameters
    ----------
    found : array (n, places)
        Characters: a sign, digits and a point. Rows with other characters are uncertain. Overwritten.
    lengths : array (n,)
        Lengths of the numbers; the characters after them are zeros.
    """
    width = found.shape[1]
    negative = found[:, 0] == _MINUS
    found[negative, 0] = _ZERO
    values, sure = np.zeros(len(found)), lengths <= width
    left = np.ones(len(found), np.bool_)
    while left.any():
        # Usually all rows have the point at the same place.
        first = found[int(left.argmax())] == _DOT
        point = int(first.argmax()) if first.any() else width
        chosen = left & (found[:, point] == _DOT if point < width else ~(found == _DOT).any(axis=1))
        left &= ~chosen
        rows = slice(None) if chosen.all() else np.flatnonzero(chosen)
        values[rows], is_sure = _parse_fixed_point(point, found[rows], lengths[rows])
        sure[rows] &= is_sure & (lengths[rows] > negative[rows] + np.int64(point < width))
    values[negative] *= -1.0
    return values, sure


def _parse_fixed_point(
    point: int, found: NDArray[np.uint8], lengths: Places
) -> tuple[Floats, NDArray[np.bool_] | bool]:
    """Parse numbers whose points are all at one place; ``point`` is the width if they have none."""
    width = found.shape[1]
    digits = (found - _ZERO).astype(np.uint8, copy=False)
    places = [place for place in range(width) if place != point]
    is_other = digits > 9
    is_other[:, point : point + 1] = False
    sure = ~is_other.any(axis=1) if is_other.any() else True
    whole = _join_digits(digits, places)
    if point == width:
        padding = np.clip(width - lengths, 0, _PLACES - 1)
        return (whole // _POWERS[padding]).astype(np.float64), sure & (width < _PLACES)
    values, exact = _divide(whole, len(places) - point)
    return values, exact & sure


def _join_digits(digits: NDArray[np.uint8], places: Sequence[int]) -> NDArray[np.uint64]:
    """Whole numbers (n,) of the digits (n, …) at some places, most significant first."""
    # Doubles hold the last ten digits exactly, and also the digits before them.
    low = max(len(places) - 10, 0)
    halves = np.zeros((digits.shape[1], 2))
    for index, place in enumerate(places):
        power = len(places) - 1 - index
        halves[place, int(index >= low)] = _POWERS[power - (0 if index >= low else len(places) - low)]
    # Sums of whole numbers below 2^53 are exact in any order.
    high, rest = (digits @ halves).astype(np.uint64).T
    whole: NDArray[np.uint64] = high * _POWERS[len(places) - low] + rest
    return whole


def _divide(whole: NDArray[np.uint64], power: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Divide whole numbers (n,) by a power of ten; also return which quotients are certainly the nearest doubles.

    Each number is rounded to a double and divided. The quotient is corrected by the remainder, which is a double, and
    by the digits lost in rounding. It is certain if slightly larger and slightly smaller corrections give the same
    double, which fails only within 2^-50 of the middle between two doubles.
    """
    divisor = _POWERS[power].astype(np.float64)
    held = whole.astype(np.float64)
    last = (whole - held.astype(np.uint64)).view(np.int64).astype(np.float64)
    quotient = held / divisor
    product = quotient * divisor
    left, right = _split_double(quotient), _split_double(divisor)
    error = ((left[0] * right[0] - product) + left[0] * right[1] + left[1] * right[0]) + left[1] * right[1]
    rest = (((held - product) - error) + last) / divisor
    nearest = quotient + rest
    # Bound on the relative error of the correction, which is rounded twice.
    slack = 2.0**-50
    return nearest, (quotient + rest * (1.0 + slack)) == (quotient + rest * (1.0 - slack))


def _split_double(value: Floats) -> tuple[Floats, Floats]:
    # Dekker's split: the products of the halves are exact.
    high = value * (2.0**27 + 1.0)
    high = high - (high - value)
    return high, value - high


class CsvRows:
    """Read rows of a table, some at a time, from texts of whole lines.

    Attributes
    ----------
    headers : list of str
        Cells of the first row.

    Raises
    ------
    InvalidInput
        The text is not CSV; messages call the table ``name``. Rows with more or fewer cells than headers are skipped
        and added to ``faults`` with their line numbers.
    """

    def __init__(self, texts: Iterable[str], name: str, faults: list[tuple[int, str]]) -> None:
        self._texts, self._name, self._faults = iter(texts), name, faults
        self._line = 0
        #: Lines of the current text that have not been read yet.
        self._left = io.StringIO()
        # Reads a line only when a row needs it.
        self._reader = csv.reader(iter(self._next_line, None), strict=True)
        self.headers = self._next_row() or []

    def __iter__(self) -> Iterator[ReadCells | CutCells]:
        while text := self._left.read() or next(self._texts, ""):
            cells = _split_cells(text, len(self.headers), self._line + 1)
            if cells is not None:
                self._line = cells.lines[-1]
                yield cells
            else:
                self._left = io.StringIO(text, newline="")
                yield from self._read(len(text))

    def _read(self, length: int) -> Iterator[ReadCells]:
        """Read the rows that begin in the current text."""
        lines, rows, begun = [], [], self._left
        while self._left is begun and begun.tell() < length and (row := self._next_row()) is not None:
            if len(row) == len(self.headers):
                lines.append(self._line)
                rows.append(row)
            elif row:
                fault = Message("has {0} cells, not {1}", len(row), len(self.headers))
                self._faults.append((self._line, fault))
        if rows:
            yield ReadCells(lines, rows)

    def _next_line(self) -> str | None:
        while not (line := self._left.readline()):
            text = next(self._texts, "")
            if not text:
                return None
            self._left = io.StringIO(text, newline="")
        self._line += 1
        return line

    def _next_row(self) -> list[str] | None:
        try:
            return next(self._reader, None)
        except csv.Error as wrong:
            raise InvalidInput("{0}: line {1} is not CSV ({2})", self._name, self._line, wrong) from wrong


def _split_cells(text: str, width: int, first_line: int) -> CutCells | None:
    """Cut whole lines into cells at commas; None if the csv module might read them differently."""
    if "\r" in text or "\0" in text:
        return None
    text += "" if text.endswith("\n") else "\n"
    pieces = text.split('"')
    quotes = len(pieces) - 1
    raw = np.frombuffer(text.encode("utf-8", "surrogatepass") + bytes(_PLACES), np.uint8)
    outside = raw
    if quotes:
        pieces[1::2] = [piece.replace(",", ";") for piece in pieces[1::2]]
        outside = np.frombuffer('"'.join(pieces).encode("utf-8", "surrogatepass"), np.uint8)
    is_line_end = outside == _LINE_END
    rows = int(np.count_nonzero(is_line_end))
    ends = np.flatnonzero(is_line_end | (outside == _COMMA))
    if len(ends) != rows * width or not is_line_end[ends[width - 1 :: width]].all():
        return None
    starts = np.empty_like(ends)
    starts[0], starts[1:] = 0, ends[:-1] + 1
    if quotes:
        quoted = (raw[starts] == _QUOTE) & (raw[ends - 1] == _QUOTE) & (ends - starts > 1)
        # Every quote must be the first or the last character of a cell.
        if 2 * int(np.count_nonzero(quoted)) != quotes:
            return None
        starts += quoted
        ends -= quoted
    if (ends - starts).max() > csv.field_size_limit():
        return None
    starts, ends = (np.ascontiguousarray(places.reshape(rows, width).T) for places in (starts, ends))
    return CutCells(first_line, text, raw, starts, ends)
