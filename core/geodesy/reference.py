"""Coordinate reference systems from foreign files, servers and datasets. PROJ is imported only where used.

A definition may name files of grids and parameters, which PROJ would open wherever they are: on this machine, on
another one, even if the file is an endless pipe. Such definitions are refused before PROJ or GDAL sees them. Grids that
PROJ's database lists for a code are left to PROJ.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..limits import MAX_CRS_CHARACTERS
from ..text.safe_json import parse_json

if TYPE_CHECKING:
    from pyproj import CRS

#: Codes, URNs and URLs, also of compound CRSs; PROJ looks them up only in its database.
_CODE = re.compile(
    r"[a-z]\w*:\w[\w.]*(\+([a-z]\w*:)?\w[\w.]*)?|CRS84"
    r"|(urn:(x-)?ogc:def:crs|https?://(www\.)?opengis\.net/def/crs)[:,/][\w.:,/-]+",
    re.IGNORECASE,
)
_WKT = re.compile(r"[a-z]\w*\s*[\[(]", re.IGNORECASE)
#: Parameter of a PROJ string: numbers, names and lists of them, but no paths.
_PARAMETER = re.compile(r"\+?[a-z]\w*(=[\w.,+:'°@-]*(/\d+(\.\d+)?)?)?", re.IGNORECASE)
#: File name of a grid, without a folder, such as older GDAL versions wrote beside the codes of vertical CRSs.
_GRID_OF_GDAL = r"(?:egm96_15|egm08_25|g\d{4}[a-z]?\d*(?:_\w+)?)\.gtx"
#: One or more of these grids, or the null grid.
_HARMLESS = rf"(?:@?null|{_GRID_OF_GDAL}(?:\s*,\s*{_GRID_OF_GDAL})*)"
#: End of the name of a grid: end of the text, of a quoted word, or of a member.
_END = r'(?:\s*$|"?\s*[\])}|<]|"\s*,\s*(?:"|[a-z]+\s*[\[(]))'
#: Parameters and operations of PROJ strings and WKT for which PROJ opens a file, except null grids and EPSG codes. PROJ
#: accepts typographic quotes. Compiled where used, as this takes milliseconds.
_FILES = rf"""
    grids["“”]?\s*=(?!\s*"?@?null(?:{_END}|\s+[+a-z]))
    | (?<![a-z])(?:catalog|init)["“”]?\s*=(?!\s*epsg:\d)
    | \b(?:tinshift|defmodel)\b
    | \bGEOIDMODEL\s*[\[(][^a-z]{{0,9}}PROJ[\s-]
    | \bPROJ4_GRIDS\b(?!"?\s*,\s*"?{_HARMLESS}{_END})
    | \bPARAMETERFILE\b(?!\s*[\[(]\s*"[^"“”]{{0,100}}"\s*,\s*"?{_HARMLESS}{_END})
"""
#: Any text that `_FILES` matches contains one of these, in upper or lower case.
_CLUES = (b"grids", b"catalog", b"init", b"tinshift", b"defmodel", b"geoidmodel", b"parameterfile")
#: Name of the file that follows, for messages.
_NAME = re.compile(r"""[\s="“”,\[(]*(?:[^"“”,]{0,100}["“”]\s*,)?[\s"“”]*([^\s"“”\])|<]{1,200})""")


def is_code(text: str) -> bool:
    """Whether a text is a code, URN or URL of a CRS."""
    return _CODE.fullmatch(text.strip()) is not None


def may_name_file(data: bytes) -> bool:
    """Whether bytes may name a file: a quick test before `file_named`, which is a hundred times slower."""
    lower = data.lower()
    return any(clue in lower for clue in _CLUES)


def file_named(text: str) -> str:
    """First file that PROJ would open for a definition, or for definitions within a text; empty if there is none."""
    found = re.search(_FILES, text, re.IGNORECASE | re.VERBOSE)
    if found is None:
        return ""
    name = _NAME.match(text, found.end())
    return name[1] if name else found[0]


def check_reference(text: str) -> None:
    """Raise unless a definition is a code, WKT, PROJJSON or PROJ string without files; PROJ is not called.

    Raises
    ------
    InvalidInput
        It names a file, is too long, or is not a definition.
    """
    from ..text.plain import one_line

    if len(text) > MAX_CRS_CHARACTERS:
        raise InvalidInput(
            "coordinate reference system: {0} characters: must be no more than {1}",
            len(text),
            MAX_CRS_CHARACTERS,
        )
    text = text.strip()
    if is_code(text):
        return
    named = file_named(text)
    if not named and text.startswith("{"):
        named = next(_files_of_json(parse_json(text)), "")
    elif not named and not _WKT.match(text):
        words = text.split()
        is_one = text.lstrip("+").startswith("proj=") and "pipeline" not in text
        if not is_one or not all(_PARAMETER.fullmatch(word) for word in words):
            raise InvalidInput(
                "coordinate reference system {0!r}: must be a code such as EPSG:25832, or WKT",
                one_line(text[:80]),
            )
    if named:
        raise InvalidInput(
            "coordinate reference system: names the file {0}, which is not opened; must be a code such as EPSG:25832, "
            "or WKT without files",
            one_line(named),
        )


def read_reference(text: str) -> CRS:
    """CRS of a code, WKT, PROJJSON or PROJ string; opens no file and asks no server.

    Raises
    ------
    InvalidInput
        As for `check_reference`; also if PROJ does not know the CRS, or a unit is not positive.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    from ..text.plain import one_line

    check_reference(text)
    try:
        # PROJ 9.5 needs the authority before this name.
        found = CRS.from_user_input("OGC:CRS84" if text.upper() == "CRS84" else text.strip())
    except CRSError as wrong:
        # The message quotes the definition before the reason.
        reason = str(wrong).rpartition("(Internal Proj Error: ")[2].rstrip(")")
        raise InvalidInput("coordinate reference system {0!r}: {1}", one_line(text[:80]), one_line(reason)) from wrong
    for part in (found, *found.sub_crs_list):
        for axis in part.axis_info:
            unit = float(axis.unit_conversion_factor)
            if not 0.0 < unit < math.inf:
                raise InvalidInput(
                    "coordinate reference system {0}: unit {1!r} of {2:g}: must be greater than 0",
                    one_line(found.name),
                    one_line(axis.unit_name),
                    unit,
                )
    return found


def _files_of_json(node: Any) -> Iterator[str]:
    """Yield the files that a PROJJSON definition names."""
    if isinstance(node, list):
        for part in node:
            yield from _files_of_json(part)
    if not isinstance(node, dict):
        return
    for name, part in node.items():
        if name == "parameters" and isinstance(part, list):
            values = (one.get("value") for one in part if isinstance(one, dict))
            yield from (
                one for one in values if isinstance(one, str) and not re.fullmatch(_HARMLESS, one, re.IGNORECASE)
            )
        # The name of a geoid model may be the word PROJ followed by a grid.
        if name in ("geoid_model", "geoid_models"):
            models = part if isinstance(part, list) else [part]
            names = (str(one.get("name")) for one in models if isinstance(one, dict))
            yield from (one for one in names if one.upper().startswith("PROJ "))
        if isinstance(part, str):
            yield from filter(None, [file_named(part)])
        yield from _files_of_json(part)
