"""Vertical datums by name and code. PROJ is loaded where used."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from .reference import is_code, read_reference

if TYPE_CHECKING:
    from pyproj import CRS


def vertical_code(text: str) -> str:
    """Code of a datum given by name or, in upper or lower case, by code; empty for the WGS 84 ellipsoid."""
    codes = {"ellipsoid": "", "egm96": "EPSG:5773", "egm2008": "EPSG:3855"}
    return codes.get(text.lower(), text.upper())


@lru_cache(32)
def vertical_crs(code: str) -> CRS:
    """Vertical CRS of a code or of WKT; raises InvalidInput for any other text."""
    try:
        found = read_reference(code)
    except InvalidInput as wrong:
        raise _unknown(code) from wrong
    if not found.is_vertical:
        raise _unknown(code)
    return found


def check_vertical(text: str) -> None:
    """Raise InvalidInput unless a text is empty, or the name or code of a vertical CRS."""
    code = vertical_code(text)
    if not code:
        return
    # For any other text PROJ would search its names.
    if not is_code(code):
        raise _unknown(text)
    vertical_crs(code)


def _unknown(text: str) -> InvalidInput:
    return InvalidInput(
        "vertical datum {0!r}: must be {1}, {2}, {3} or the code of a vertical system",
        text,
        "ellipsoid",
        "EGM96",
        "EGM2008",
        field="vertical_datum",
    )
