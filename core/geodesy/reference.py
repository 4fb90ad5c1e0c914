"""Coordinate reference systems as files, servers and datasets of others state them. PROJ is loaded where used.

A definition may name files, of grids and of parameters, which PROJ opens wherever they lie: on this machine, on
another one, or a pipe without end. None of these is taken, and each is refused before PROJ or GDAL sees it. Grids that
PROJ's own database has for a code stay PROJ's affair.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..limits import MAX_CRS_CHARACTERS
from ..safe_json import parse_json

if TYPE_CHECKING:
    from pyproj import CRS

#: Codes and their URNs and addresses, which are looked up in PROJ's database alone; several for the two of a compound.
_CODE = re.compile(
    r"[a-z]\w*:\w[\w.]*(\+([a-z]\w*:)?\w[\w.]*)?|CRS84"
    r"|(urn:(x-)?ogc:def:crs|https?://(www\.)?opengis\.net/def/crs)[:,/][\w.:,/-]+",
    re.IGNORECASE,
)
_WKT = re.compile(r"[a-z]\w*\s*[\[(]", re.IGNORECASE)
#: Parameter of PROJ's texts: numbers, names and the lists of them, no paths.
_PARAMETER = re.compile(r"\+?[a-z]\w*(=[\w.,+:'°@-]*(/\d+(\.\d+)?)?)?", re.IGNORECASE)
#: Grids that GDAL named beside the codes of vertical systems until it had PROJ's database, without a folder.
_GRID_OF_GDAL = r"(?:egm96_15|egm08_25|g\d{4}[a-z]?\d*(?:_\w+)?)\.gtx"
#: One or more of these, or the grid of zeros.
_HARMLESS = rf"(?:@?null|{_GRID_OF_GDAL}(?:\s*,\s*{_GRID_OF_GDAL})*)"
#: What follows the last of them: the end of a text, of a word in quotes, or of a member.
_END = r'(?:\s*$|"?\s*[\])}|<]|"\s*,\s*(?:"|[a-z]+\s*[\[(]))'
#: What has PROJ open a file: its parameters (but for grids of zeros and EPSG's codes, which are none), the operations
#: whose files have other parameters, and those of WKT. Printed quotes are as good as others to PROJ.
_FILES = re.compile(
    rf"""
    grids["“”]?\s*=(?!\s*"?@?null(?:{_END}|\s+[+a-z]))
    | (?<![a-z])(?:catalog|init)["“”]?\s*=(?!\s*epsg:\d)
    | \b(?:tinshift|defmodel)\b
    | \bGEOIDMODEL\s*[\[(][^a-z]{{0,9}}PROJ[\s-]
    | \bPROJ4_GRIDS\b(?!"?\s*,\s*"?{_HARMLESS}{_END})
    | \bPARAMETERFILE\b(?!\s*[\[(]\s*"[^"“”]{{0,100}}"\s*,\s*"?{_HARMLESS}{_END})
    """,
    re.IGNORECASE | re.VERBOSE,
)
#: One of these is in each text of which `_FILES` finds something, in letters of any case.
_CLUES = (b"grids", b"catalog", b"init", b"tinshift", b"defmodel", b"geoidmodel", b"parameterfile")
#: A name behind one of these, as far as messages show it.
_NAME = re.compile(r"""[\s="“”,\[(]*(?:[^"“”,]{0,100}["“”]\s*,)?[\s"“”]*([^\s"“”\])|<]{1,200})""")
#: Members of PROJJSON whose name may be that of a grid, behind this word.
_GEOID_MODELS = frozenset({"geoid_model", "geoid_models"})
_PROJ = "PROJ "


def is_code(text: str) -> bool:
    """Whether a text is a code, in any of the ways that documents write one."""
    return _CODE.fullmatch(text.strip()) is not None


def may_name_file(data: bytes) -> bool:
    """Whether `file_named` has to look through bytes of a text, which takes a hundred times as long as this."""
    lower = data.lower()
    return any(clue in lower for clue in _CLUES)


def file_named(text: str) -> str:
    """Return the first file that a definition, or a text with some in it, has PROJ open; empty where it has none."""
    found = _FILES.search(text)
    if found is None:
        return ""
    name = _NAME.match(text, found.end())
    return name[1] if name else found[0]


def check_reference(text: str) -> None:
    """Refuse a definition that PROJ would open a file for; nothing is asked of PROJ.

    Raises
    ------
    InvalidInput
        It names a file, is too long, or is neither a code nor a definition.
    """
    from ..text import one_line

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
    """CRS of a code, WKT, PROJJSON or PROJ's text; no file is opened for it, and no server asked.

    Raises
    ------
    InvalidInput
        As `check_reference` does; PROJ knows no such system, or one of its units is none.
    """
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    from ..text import one_line

    check_reference(text)
    try:
        # PROJ 9.5 knows this name with its authority alone.
        found = CRS.from_user_input("OGC:CRS84" if text.upper() == "CRS84" else text.strip())
    except CRSError as wrong:
        # The definition stands before the reason.
        reason = str(wrong).rpartition("(Internal Proj Error: ")[2].rstrip(")")
        raise InvalidInput(
            "coordinate reference system {0!r}: {1}", one_line(text[:80]), one_line(reason)
        ) from wrong
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
    """Files that a definition in JSON names."""
    if isinstance(node, list):
        for part in node:
            yield from _files_of_json(part)
    if not isinstance(node, dict):
        return
    for name, part in node.items():
        if name == "parameters" and isinstance(part, list):
            values = (one.get("value") for one in part if isinstance(one, dict))
            yield from (
                one
                for one in values
                if isinstance(one, str) and not re.fullmatch(_HARMLESS, one, re.IGNORECASE)
            )
        if name in _GEOID_MODELS:
            models = part if isinstance(part, list) else [part]
            names = (str(one.get("name")) for one in models if isinstance(one, dict))
            yield from (one for one in names if one.upper().startswith(_PROJ))
        if isinstance(part, str):
            yield from filter(None, [file_named(part)])
        yield from _files_of_json(part)
