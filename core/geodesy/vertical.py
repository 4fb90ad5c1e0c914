"""Names and codes of what heights count from. PROJ is loaded where used."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from .reference import is_code, read_reference

if TYPE_CHECKING:
    from pyproj import CRS

#: Codes by names; the ellipsoid, WGS 84's, has none and needs no grid.
_CODES = {"ellipsoid": "", "egm96": "EPSG:5773", "egm2008": "EPSG:3855"}


def vertical_code(text: str) -> str:
    """Code of a name, or of a code in any case; empty for the ellipsoid."""
    return _CODES.get(text.lower(), text.upper())


@lru_cache(32)
def vertical_crs(code: str) -> CRS:
    """Vertical system of a code or of WKT; raises InvalidInput where it is none."""
    try:
        found = read_reference(code)
    except InvalidInput as wrong:
        raise _unknown(code) from wrong
    if not found.is_vertical:
        raise _unknown(code)
    return found


def check_vertical(text: str) -> None:
    """Refuse what is neither empty nor the name or the code of a vertical system."""
    code = vertical_code(text)
    if not code:
        return
    # What is no code at all PROJ would look for among its names.
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
