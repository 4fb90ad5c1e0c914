"""Named imageries, written ``[NAME=]SOURCE[@DATE][:MAP_TYPE]``; a mission may capture several."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from ..errors import InvalidInput
from ..map_types import MAP_TYPES, SATELLITE


@dataclass(frozen=True)
class NamedImagery:
    """A source, date and map type under a name.

    Parameters
    ----------
    name : str
        Name of its folder: letters, digits, ``_``, ``-`` and ``.``.
    source : str
        Source as a mission names it.
    date : str
        Date as the source writes it, year first; empty for the source's default.
    map_type : str
        One of `MAP_TYPES`.

    Raises
    ------
    InvalidInput
        A name that no folder can have, an empty source, or an unknown map type.
    """

    name: str
    source: str
    date: str = ""
    map_type: str = SATELLITE

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}", self.name) or self.name.endswith("."):
            raise InvalidInput(
                "imagery {0!r}: must be named by up to 64 letters, digits, _, - and ., such as 2014",
                self.name,
            )
        if re.fullmatch(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", self.name, re.IGNORECASE):
            raise InvalidInput("imagery {0!r}: is the name of a device on Windows, and of no folder", self.name)
        if not self.source:
            raise InvalidInput("imagery {0!r}: has no source, such as {0}=world", self.name)
        if "\0" in self.source:
            raise InvalidInput("source {0!r}: holds a NUL character, which no name has", self.source)
        if self.map_type not in MAP_TYPES:
            raise InvalidInput("map type {0!r}: must be one of {1}", self.map_type, ", ".join(MAP_TYPES))

    @classmethod
    def parse(cls, text: str) -> NamedImagery:
        """Read ``[NAME=]SOURCE[@DATE][:MAP_TYPE]``; a missing name is made from the rest. Raises InvalidInput."""
        name, equals, rest = text.partition("=")
        # The query of an address may contain an equals sign.
        is_named = bool(equals) and "://" not in name
        rest = rest if is_named else text
        map_type, date = SATELLITE, ""
        if found := re.fullmatch(rf"(.+):({'|'.join(MAP_TYPES)})", rest, re.DOTALL):
            rest, map_type = found.groups()
        # An address may also contain an @, so only an @ before a year begins a date.
        if found := re.fullmatch(r"(.+)@(\d{4}[0-9A-Za-z:.+-]*)", rest, re.DOTALL):
            rest, date = found.groups()
        return cls(name, rest, date, map_type) if is_named else cls.unnamed(rest, date, map_type)

    @classmethod
    def unnamed(cls, source: str, date: str = "", map_type: str = SATELLITE) -> NamedImagery:
        """Imagery with a name made from the rest; raises InvalidInput."""
        parts = (_short_name(source), date, map_type if map_type != SATELLITE else "")
        return cls(folder_name("-".join(filter(None, parts))) or "imagery", source, date, map_type)

    def __str__(self) -> str:
        date = f"@{self.date}" if self.date else ""
        kind = f":{self.map_type}" if self.map_type != SATELLITE else ""
        return f"{self.name}={self.source}{date}{kind}"


def folder_name(text: str) -> str:
    """Turn any text into the name of a folder, on any file system; may be empty."""
    return re.sub(r"[^A-Za-z0-9_.-]+", "-", text).strip("-_.")[:64].rstrip(".")


def _short_name(source: str) -> str:
    """Host of an address without user and password, or a file's name without its ending; else the source itself."""
    _, is_address, rest = source.partition("://")
    if is_address:
        return re.split(r"[/?#]", rest)[0].rpartition("@")[2]
    return re.sub(r"(?<=.)\.[A-Za-z]\w{1,7}$", "", re.split(r"[/\\]", source.rstrip("/\\"))[-1])


def named_imageries(texts: Iterable[str]) -> tuple[NamedImagery, ...]:
    """Read imageries from texts, in their order; raises InvalidInput where two would share a folder."""
    found = tuple(NamedImagery.parse(text) for text in texts)
    # Some file systems ignore case.
    names = [one.name.lower() for one in found]
    for at, name in enumerate(names):
        if name in names[:at]:
            raise InvalidInput("imagery {0!r}: is named twice", found[at].name)
    return found
