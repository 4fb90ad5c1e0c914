"""Coordinates in lines of GeoJSON, read by numpy as a whole.

A parser of JSON keeps Python's lock while it reads: for a hundred thousand footprints the application would falter for
seconds, although they are read on another thread. Work on whole arrays goes on without the lock.
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Numbers = NDArray[np.int64]

_LINE_END, _BRACKET, _MINUS, _DOT, _ZERO = (ord(sign) for sign in "\n[-.0")
#: Characters of the longest number that is read digit by digit: a sign, 17 significant digits, a dot, leading zeros.
_WIDTH = 24
_TEN = 10
#: Longest mantissa that a double and its power of ten hold without overflow of the whole number it is read as.
_DIGITS = 18
_NUMBER = re.compile(rb"-?[0-9.]+(?:[eE][-+]?[0-9]+)?")


def lines_and_bounds(text: Bytes) -> tuple[Numbers, Floats]:
    """Where each line begins, (n,), and the bounds of its positions, (n, 4); NaN for a line that has none.

    Bounds are west, south, east and north, right to the last place but one of a double.

    Parameters
    ----------
    text : array of bytes
        Whole lines in which a bracket before a number begins a position, as Python's `json` writes them.
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


def _begins_number(signs: Bytes) -> NDArray[np.bool_]:
    return (signs - np.uint8(_ZERO) < _TEN) | (signs == _MINUS)


def _numbers(padded: Bytes, at: Numbers) -> tuple[Floats, Numbers]:
    """Numbers that begin at some places, and how many characters each has."""
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
        # Digits beyond those that a whole number holds do not count.
        taken = is_digit & (digits < _DIGITS)
        mantissa = np.where(taken, mantissa * _TEN + digit, mantissa)
        digits += taken & (mantissa > 0)
        places += taken & fraction
        fraction |= is_dot
        length += alive
    values = np.where(negative, -mantissa, mantissa) / np.power(10.0, places)
    for odd in np.flatnonzero(
        np.isin(padded[np.minimum(at + length, len(padded) - 1)], (ord("e"), ord("E")))
    ):
        found = _NUMBER.match(padded[at[odd] : at[odd] + 2 * _WIDTH].tobytes())
        if found is not None:
            values[odd], length[odd] = float(found[0]), len(found[0])
    return values, length
