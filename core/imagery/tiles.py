"""Tiles of a grid, and URL templates with ``{z}``, ``{x}``, ``{y}`` and other placeholders that address them."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple
from urllib.parse import quote, unquote, urlsplit

from ..addresses import key_parameters
from ..errors import InvalidInput, Message, PartError, SourceError
from ..geodesy.mercator import HALF_WORLD_M, PixelGrid
from ..geodesy.planes import ProjectedPlane
from ..map_types import MAP_TYPES
from .source import Window

#: Environment variable with the key for a user's address. The key is sent only to hosts that the user has named, as
#: addresses in mission files, config files and servers' documents may come from anybody.
KEY_ENV = "TERRAINAV_KEY"
#: Placeholders in braces, and descriptions of their values.
PLACEHOLDERS = {
    "z": "zoom",
    "x": "column",
    "y": "row counted from the north",
    "-y": "row counted from the south (TMS)",
    "q": "quadkey (Bing)",
    "s": "subdomain",
    "r": "@2x for tiles of 512 px",
    "map_type": "satellite, roadmap or terrain",
    "date": "date of the imagery",
    "key": "API key",
    "bbox-epsg-3857": "west,south,east,north of the tile in metres, for a WMS",
    "bbox": "west,south,east,north of the tile in the plane that the source states",
    "bbox-yx": "south,west,north,east of it",
}
#: Placeholders of a tile's bounds: on the map, as Mapbox and MapLibre name it; in the source's plane, with easting or
#: northing first.
BBOX = "bbox-epsg-3857"
OWN_BBOX, OWN_BBOX_YX = "bbox", "bbox-yx"
_BRACES = re.compile(r"\{([^{}]*)\}")
#: Subdomains in the host: {a-c} and {1-4} as in OpenLayers, [1-4], {switch:a,b,c} as in JOSM.
_RANGE = re.compile(r"\{(\w)-(\w)\}|\[(\w)-(\w)\]|\{switch:([\w,-]+)\}")
#: Environment variable with the hosts that may receive the key, separated by commas or spaces.
HOSTS_ENV = "TERRAINAV_KEY_HOSTS"


class Tile(NamedTuple):
    """A tile: zoom, column from 180° W, row from the north."""

    zoom: int
    x: int
    y: int

    def __str__(self) -> str:
        return Message("tile {0}/{1}/{2}", self.zoom, self.x, self.y)

    @property
    def tms(self) -> tuple[int, int, int]:
        """Zoom, column, and row counted from the south, as MBTiles stores them (TMS)."""
        return self.zoom, self.x, (1 << self.zoom) - 1 - self.y


def tile_address(part: Window, grid: PixelGrid, title: str) -> Tile:
    """Tile of ``grid`` that fills a part.

    Parameters
    ----------
    part : Window
    grid : PixelGrid
    title : str
        Name of the source in errors.

    Raises
    ------
    InvalidInput
        The part is not a tile of the grid, or its zoom is not available.
    PartError
        The tile lies beyond the edge of the map.
    """
    size = grid.tile_px
    x, left = divmod(part.left_px, size)
    y, top = divmod(part.top_px, size)
    if left or top or (part.width_px, part.height_px) != (size, size):
        raise InvalidInput("{0}: is not a tile of {1} px", part, size)
    tile = Tile(int(part.zoom), int(x), int(y))
    check_zoom(tile.zoom, grid, title)
    if not (0 <= tile.x < 1 << tile.zoom and 0 <= tile.y < 1 << tile.zoom):
        raise PartError("{0}: beyond the edge of the map", tile)
    return tile


def check_zoom(zoom: int, grid: PixelGrid, title: str) -> None:
    """Refuse a zoom that a grid does not have; errors name the source by its title."""
    if not grid.min_zoom <= zoom <= grid.max_zoom:
        raise InvalidInput("zoom {0}: {1} has {2} to {3}", zoom, title, grid.min_zoom, grid.max_zoom)


@dataclass(frozen=True)
class Template:
    """A checked URL template.

    Parameters
    ----------
    text : str
        Address of http or https with {z}, {x} and {y} or {-y}, or with {q} or {bbox-epsg-3857}; {key} stands for a key.
    subdomains : tuple of str
        Values of {s}, used in turn.
    levels : tuple of (zoom, name) pairs
        Values of {z} for zooms that the server names.
    plane : ProjectedPlane or None
        Plane of the tiles; None for the Web-Mercator map.
    """

    text: str
    subdomains: tuple[str, ...] = ("a", "b", "c")
    levels: tuple[tuple[int, str], ...] = ()
    plane: ProjectedPlane | None = None

    def __post_init__(self) -> None:
        text = self.text.strip().replace("${", "{").replace("{zoom}", "{z}")
        object.__setattr__(self, "subdomains", tuple(self.subdomains))
        object.__setattr__(self, "levels", tuple((int(zoom), str(name)) for zoom, name in self.levels))
        inline = _RANGE.search(text)
        if inline:
            object.__setattr__(self, "subdomains", _spelled_out(inline))
            text = _RANGE.sub("{s}", text, count=1)
        object.__setattr__(self, "text", text)
        self._check_url()
        self._check_placeholders()

    @property
    def names(self) -> frozenset[str]:
        """Placeholders in the template."""
        return frozenset(_BRACES.findall(self.text))

    @property
    def host(self) -> str:
        """Host of the tiles; the first one if there are several."""
        return self.hosts[0]

    @property
    def hosts(self) -> tuple[str, ...]:
        """Hosts of the tiles for every subdomain, map type and tile size, as `url_host` spells them."""
        values = itertools.product(self.subdomains or ("",), MAP_TYPES, ("", "@2x"))
        urls = (self._filled({"s": s, "map_type": map_type, "r": r}) for s, map_type, r in values)
        # Values of other placeholders depend on the tile; any value will do.
        return tuple(dict.fromkeys(url_host(_BRACES.sub("0", url)) for url in urls))

    def url(self, z: int, x: int, y: int, *, scale: int = 1, map_type: str = "", date: str = "", key: str = "") -> str:
        """URL of a tile; the subdomain depends on column and row, so that a tile always has the same URL."""
        names = self.names
        level = next((name for zoom, name in self.levels if zoom == z), str(z))
        values = {"z": quote(level, safe=":"), "x": str(x), "y": str(y), "-y": str((1 << z) - 1 - y)}
        if BBOX in names:
            values[BBOX] = bbox(z, x, y)
        if self.plane is not None and names & {OWN_BBOX, OWN_BBOX_YX}:
            edges = own_edges(self.plane, z, x, y)
            values[OWN_BBOX] = ",".join(map(repr, edges))
            values[OWN_BBOX_YX] = ",".join(repr(edges[at]) for at in (1, 0, 3, 2))
        if "q" in names:
            values["q"] = quadkey(z, x, y)
        if "s" in names:
            values["s"] = self.subdomains[(x + y) % len(self.subdomains)]
        values["r"] = "" if scale == 1 else f"@{scale}x"
        values.update(map_type=map_type, date=quote(date, safe=":"), key=quote(key, safe=""))
        return self._filled(values)

    def _filled(self, values: dict[str, str]) -> str:
        return _BRACES.sub(lambda found: values.get(found.group(1), found.group(0)), self.text)

    def _check_url(self) -> None:
        check_address(self.text, Message("URL template"))

    def _check_placeholders(self) -> None:
        names = self.names
        shown = self.text.partition("?")[0]
        for name in sorted(names - PLACEHOLDERS.keys()):
            raise InvalidInput(
                "URL template {0}: {{{1}}} is unknown; known are {2}", shown, name, _braced(PLACEHOLDERS)
            )
        if re.search(r"[{}]", _BRACES.sub("", self.text)):
            raise InvalidInput("URL template {0}: an unmatched brace", shown)
        if "s" in names and not self.subdomains:
            raise InvalidInput("URL template {0}: {{s}} without subdomains to put there", shown)
        in_host = set(_BRACES.findall(urlsplit(self.text).netloc)) - {"s"}
        if "key" in names and in_host:
            raise InvalidInput(
                "URL template {0}: {1} in its host; a key goes to a host that is written out",
                shown,
                _braced(sorted(in_host)),
            )
        missing = [name for name in ("z", "x") if name not in names]
        if not names & {"y", "-y"}:
            missing.append("y")
        other = {OWN_BBOX, OWN_BBOX_YX} if self.plane is None else {BBOX, "q"}
        for name in sorted(names & other):
            raise InvalidInput(
                "URL template {0}: {{{1}}} is for {2}",
                shown,
                name,
                Message("a source that states a plane")
                if self.plane is None
                else Message("tiles of the Web-Mercator map"),
            )
        if missing and not names & {"q", BBOX, OWN_BBOX, OWN_BBOX_YX}:
            raise InvalidInput(
                "URL template {0}: without {1}; needs {{z}}, {{x}} and {{y}} (or {{-y}}, or {{q}} or {{{2}}} alone)",
                shown,
                _braced(missing),
                BBOX,
            )


def url_host(url: str) -> str:
    """Host of a URL in the spelling of DNS; empty without a host.

    Upper case, percent-encoding, IDNA forms of letters and dots, and the final dot are normalised. A host that
    programs resolve differently, such as ``straße.example``, counts as missing; users can write xn--… instead.
    """
    try:
        host = unquote(urlsplit(url).hostname or "").rstrip(".")
        # IDNA 2003 and 2008 map these letters to different hosts.
        if len(host) > 253 or not {"\u00df", "\u1e9e", "\u03c2", "\u200c", "\u200d"}.isdisjoint(host):
            return ""
        plain = host.encode("idna").decode("ascii").lower()
    except ValueError:
        return ""
    # With other characters, programs disagree on the end of the host.
    return plain.rstrip(".") if re.fullmatch(r"[a-z0-9._-]+|[0-9a-f:.]+", plain) else ""


def check_address(text: str, what: str) -> None:
    """Refuse an address that is not http or https, or that contains credentials.

    Parameters
    ----------
    text : str
        Address, possibly with placeholders in braces.
    what : str
        Name of the address in errors.
    """
    if not text.isprintable() or " " in text:
        raise InvalidInput("{0} with spaces or control characters: must have none, or spaces written as %20", what)
    filled = _BRACES.sub("0", text)
    try:
        parts = urlsplit(filled)
        _ = parts.port
        sound = bool(url_host(filled)) or not parts.hostname
    except ValueError:
        sound = False
    if not sound:
        raise InvalidInput("{0} of an invalid host or port: must be as in https://tiles.example:8080/", what)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise InvalidInput(
            "{0} of {1} scheme: must start with http:// or https://", what, parts.scheme or Message("no")
        )
    if parts.username is not None or parts.password is not None:
        raise InvalidInput("{0} for {1}: holds a user name; no credentials may stand in it", what, parts.hostname)
    for name in key_parameters(text):
        raise InvalidInput(
            "{0} for {1}: holds a key in {2!r}, which would end up in files",
            what,
            parts.hostname,
            name,
            remedy=Message("write {0}={{key}} and set TERRAINAV_KEY", name),
        )


def _braced(names: Iterable[str]) -> str:
    return " ".join(f"{{{name}}}" for name in names)


def _spelled_out(inline: re.Match[str]) -> tuple[str, ...]:
    """Subdomains of a range or list in a template, matched by `_RANGE`."""
    first, last = inline.group(1) or inline.group(3), inline.group(2) or inline.group(4)
    if first is None:
        return tuple(inline.group(5).split(","))
    if ord(first) > ord(last):
        raise InvalidInput("URL template with subdomains {0}-{1}: the first comes after the last", first, last)
    return tuple(chr(code) for code in range(ord(first), ord(last) + 1))


def quadkey(z: int, x: int, y: int) -> str:
    """Bing's quadkey of a tile: one base-4 digit per zoom, column in the low bit, row in the high bit."""
    return "".join(str((x >> bit & 1) + 2 * (y >> bit & 1)) for bit in range(z - 1, -1, -1))


def bbox(z: int, x: int, y: int) -> str:
    """West, south, east and north of a tile in metres of EPSG:3857, with all digits."""
    size_m = 2.0 * HALF_WORLD_M / (1 << z)
    west, north = x * size_m - HALF_WORLD_M, HALF_WORLD_M - y * size_m
    # Compute each edge from its grid line, so that neighbours share it to the last digit.
    edges = (west, HALF_WORLD_M - (y + 1) * size_m, (x + 1) * size_m - HALF_WORLD_M, north)
    return ",".join(repr(edge) for edge in edges)


def own_edges(plane: ProjectedPlane, z: int, x: int, y: int) -> tuple[float, float, float, float]:
    """West, south, east and north of a tile of a plane, in the unit of its CRS; neighbours share an edge."""
    columns, rows = (x, x + 1), (y + 1, y)
    west, east = (plane.west + plane.width * column / (1 << z) for column in columns)
    south, north = (plane.north - plane.height * row / (1 << z) for row in rows)
    return west, south, east, north


def environment_key(hosts: Iterable[str], *, named_by_user: bool) -> str | None:
    """Return the environment's key for an address with ``{key}``; None if there is none.

    Parameters
    ----------
    hosts : iterable of str
        All hosts of the address.
    named_by_user : bool
        Whether the user, not a file, has named the address, so that all hosts may receive the key.

    Raises
    ------
    SourceError
        The key is for other hosts.
    """
    key = os.environ.get(KEY_ENV)
    if not key or named_by_user:
        return key or None
    known = os.environ.get(HOSTS_ENV, "").replace(",", " ").lower().split()
    for host in hosts:
        if not any(host == named or host.endswith("." + named) for named in (one.strip(".") for one in known)):
            raise SourceError(
                "{0}: {1} is not sent there, because a file names this host and not you",
                host,
                KEY_ENV,
                remedy=Message("set {0}={1} if the key is for it", HOSTS_ENV, host),
            )
    return key
