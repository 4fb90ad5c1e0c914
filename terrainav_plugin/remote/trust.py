"""Servers and files that the user has agreed to in this profile of QGIS.

Projects, datasets and mission files name sources of imagery and heights and may be foreign: nothing is requested from
their sources until the user has agreed, just as QGIS asks before it runs a project's code. The user need not agree to
sources that were chosen or entered in this profile, to the shipped catalogue, to the user's own sources, and to layers
and connections of QGIS.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING
from urllib.parse import unquote

from ...core.errors import InvalidInput
from ...core.imagery.catalogue import shelf
from ...core.imagery.entry import serving
from ...core.imagery.tiles import url_host
from ...core.limits import MAX_AGREED_PLACES, MAX_DECODINGS, MAX_PLACE_CHARACTERS
from ...core.text.safe_json import parse_json
from ..settings import Settings

if TYPE_CHECKING:
    from ...core.mission.mission import Mission

#: Scheme and server of an address, with placeholders. Programs accept one or more slashes; a scheme has at least two
#: letters, unlike a drive.
_ADDRESS = re.compile(
    r"(?<![a-z0-9+.-])([a-z0-9+.-]{2,}):[/\\]{1,9}"
    r"((?:\{[^{}]*\}|\[[^\[\]]*\]|[^\s/\\?#&|'\"<>,{}\[\]]|[{}\[\]])+)",
    re.IGNORECASE,
)
#: The server after a user name; curl accepts user names with spaces beyond ASCII.
_SERVER_AFTER_NAME = re.compile(r"[^/\\?#]*@([^\s/\\?#&|'\"<>,]+)")
#: Windows path of a file on another machine.
_SHARE = re.compile(r"[\\/]{2}(?:[?.][\\/]+UNC[\\/]+)?[^\\/?.][^\\/]*", re.IGNORECASE)
#: Names through which GDAL may read other files.
_VIRTUAL = re.compile(r"[\\/]vsi|\.vrt$", re.IGNORECASE)
#: Names that consist of a prefix and one address; in other names, an address may be part of a key or unused option.
_BY_ADDRESS = re.compile(
    r"(?:/vsi(?:zip|gzip|tar)/+){0,8}(?:/vsicurl(?:_streaming)?/|[a-z]+:)?https?:"
    r"|/vsicurl\?url=https?(?::|%(?:25)?3A)[^&]*$",
    re.IGNORECASE,
)


def source_names(mission: Mission) -> tuple[str, ...]:
    """Names of a mission's sources of imagery, elevation, buildings and labels."""
    imagery = [one.source for one in mission.imagery.named] or [mission.imagery.source]
    return (*imagery, *elevation_names(mission), *mission.labels.labels)


def elevation_names(mission: Mission) -> tuple[str, ...]:
    """Names of a mission's sources of elevation and buildings."""
    return (*mission.terrain.elevation, *mission.terrain.surface, *mission.terrain.buildings)


def unagreed_places(texts: Iterable[str]) -> tuple[str, ...]:
    """Servers and files to which the user has not agreed; makes no request.

    Parameters
    ----------
    texts : iterable of str
        Names of sources as in missions, addresses of datasets, and paths of folders.

    Returns
    -------
    tuple of str
        Each place once: ``https://host`` for an address, the name itself for a file that may refer to others.
    """
    found = dict.fromkeys(one for text in texts for one in _places(text))
    known = {*_agreed()} if found else set()
    unknown = [one for one in found if one not in known and not _is_shipped(one)]
    own = {*_user_places()} if unknown else set()
    return tuple(one for one in unknown if one not in own)


def agree(texts: Iterable[str]) -> None:
    """Record that the user has chosen sources, or has agreed to places from `unagreed_places`."""
    new = [one for one in unagreed_places(texts) if len(one) <= MAX_PLACE_CHARACTERS]
    if new:
        Settings().agreed = json.dumps([*_agreed(), *new][-MAX_AGREED_PLACES:])


def _agreed() -> list[str]:
    try:
        found = parse_json(Settings().agreed or "[]")
    except InvalidInput:
        return []
    return [one for one in found if isinstance(one, str)] if isinstance(found, list) else []


def _user_places() -> Iterator[str]:
    """Servers and files of the sources that the user has added."""
    try:
        entries = shelf().entries
    except InvalidInput:
        return
    for entry in entries:
        for url in entry.urls.values():
            yield from _places(url)


def _is_shipped(place: str) -> bool:
    """Whether a place is a server of the shipped catalogue."""
    return place.startswith("https://") and "{" not in place and serving(url_host(place)) is not None


def _places(text: str) -> Iterator[str]:
    """Servers in a text, in any spelling, and files that refer to others; empty for other texts."""
    text = text.strip()
    if text.startswith("qgis:"):
        return
    readings = [text]
    while len(readings) <= MAX_DECODINGS and (decoded := unquote(readings[-1])) != readings[-1]:
        readings.append(decoded)
    found = [
        f"{address[1]}://{server.rpartition('@')[2]}".lower()
        for reading in readings
        for address in _ADDRESS.finditer(reading)
        for server in _servers(reading, address)
    ]
    share = _SHARE.match(text)
    if share is not None:
        found.append(share[0].replace("\\", "/").lower())
    # Also the whole text if \@ separates two servers, as some programs take the first and some the second.
    if (_VIRTUAL.search(text) and not (found and _BY_ADDRESS.match(text))) or (found and "\\@" in readings[-1]):
        found.append(text)
    yield from found


def _servers(reading: str, address: re.Match[str]) -> Iterator[str]:
    yield address[2]
    after_name = _SERVER_AFTER_NAME.match(reading, address.end())
    if after_name is not None:
        yield after_name[1]
