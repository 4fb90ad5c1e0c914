"""Imagery by name, ``[NAME=]SOURCE[@DATE][:MAP_TYPE]``: several sources, dates or map types beside each other."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from ..errors import InvalidInput
from ..map_types import MAP_TYPES, SATELLITE

#: Names become those of folders, also on file systems that know no upper and lower case.
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")
_DEVICE = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
_MAP_TYPE = re.compile(rf"(.+):({'|'.join(MAP_TYPES)})", re.DOTALL)
#: A date begins with its year; an address may have other things after an @.
_DATE = re.compile(r"(.+)@(\d{4}[0-9A-Za-z:.+-]*)", re.DOTALL)
#: What names have no room for, and the ending of a file.
_NO_NAME, _ENDING = re.compile(r"[^A-Za-z0-9_.-]+"), re.compile(r"(?<=.)\.[A-Za-z]\w{1,7}$")


@dataclass(frozen=True)
class NamedImagery:
    """One of several imageries.

    Parameters
    ----------
    name : str
        Letters, digits, ``_``, ``-`` and ``.``: the name of its folder.
    source : str
        As a mission names it.
    date : str
        As the source writes it, from its year on; empty for the source's own.
    map_type : str
        One of `MAP_TYPES`.

    Raises
    ------
    InvalidInput
        A name that is none of a folder, no source, or another map type.
    """

    name: str
    source: str
    date: str = ""
    map_type: str = SATELLITE

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name) or self.name.endswith("."):
            raise InvalidInput(
                "imagery {0!r}: must be named by up to 64 letters, digits, _, - and ., such as 2014",
                self.name,
            )
        if _DEVICE.fullmatch(self.name):
            raise InvalidInput("imagery {0!r}: is the name of a device on Windows, and of no folder", self.name)
        if not self.source:
            raise InvalidInput("imagery {0!r}: has no source, such as {0}=world", self.name)
        if "\0" in self.source:
            raise InvalidInput("source {0!r}: holds a NUL character, which no name has", self.source)
        if self.map_type not in MAP_TYPES:
            raise InvalidInput("map type {0!r}: must be one of {1}", self.map_type, ", ".join(MAP_TYPES))

    @classmethod
    def parse(cls, text: str) -> NamedImagery:
        """Imagery of its text, without a name by that of its source, date and map type; raises InvalidInput."""
        name, equals, rest = text.partition("=")
        # An address may have an equals sign of its own.
        is_named = bool(equals) and "://" not in name
        rest = rest if is_named else text
        map_type, date = SATELLITE, ""
        if found := _MAP_TYPE.fullmatch(rest):
            rest, map_type = found.groups()
        if found := _DATE.fullmatch(rest):
            rest, date = found.groups()
        if not is_named:
            parts = (_short(rest), date, map_type if map_type != SATELLITE else "")
            name = folder_name("-".join(filter(None, parts))) or "imagery"
        return cls(name, rest, date, map_type)

    def __str__(self) -> str:
        date = f"@{self.date}" if self.date else ""
        kind = f":{self.map_type}" if self.map_type != SATELLITE else ""
        return f"{self.name}={self.source}{date}{kind}"


def folder_name(text: str) -> str:
    """Name of a folder made from a text, which may hold anything; empty where nothing is left."""
    return _NO_NAME.sub("-", text).strip("-_.")[:64].rstrip(".")


def _short(source: str) -> str:
    """The host of an address without any sign-in, a file without folder and ending, any other source as it is."""
    _, is_address, rest = source.partition("://")
    if is_address:
        return re.split(r"[/?#]", rest)[0].rpartition("@")[2]
    return _ENDING.sub("", re.split(r"[/\\]", source.rstrip("/\\"))[-1])


def named_imageries(texts: Iterable[str]) -> tuple[NamedImagery, ...]:
    """Return the imageries of texts, in their order; raises InvalidInput where two would share a folder."""
    found = tuple(NamedImagery.parse(text) for text in texts)
    names = [one.name.lower() for one in found]
    for at, name in enumerate(names):
        if name in names[:at]:
            raise InvalidInput("imagery {0!r}: is named twice", found[at].name)
    return found
