"""From the text that names a source in a mission to one value that tells all of it, and to the source itself."""

from __future__ import annotations

import os
import re
from abc import ABC, abstractmethod
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.util import resolve_name
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Callable

from ..bands import NO_STRETCH, Bands, bands_of
from ..errors import InvalidInput, SourceError
from ..geodesy.mercator import PixelGrid
from ..storage.files import is_there
from .entry import NAME, PIXELS, CatalogueEntry, providers_in, strictest
from .placeholder import Placeholder
from .policy import Policy
from .raster.trust import ADDRESS as RASTER_ADDRESS
from .raster.trust import FETCHED, file_of_part
from .source import Source
from .systems import MAP, Bounds
from .systems import refused as refused_crs

if TYPE_CHECKING:
    from .cache.tile_cache import TileCache
    from .http.transport import Transport
    from .services.capabilities import Offered

_ADDRESS = re.compile(r"://|\{")
_SERVICE = re.compile(r"wm(ts|s):.*://", re.IGNORECASE | re.DOTALL)
_ARCGIS = re.compile(r"arcgis:.*://", re.IGNORECASE | re.DOTALL)
_OGC_API = re.compile(r"ogcapi:.*://", re.IGNORECASE | re.DOTALL)
#: What stands in templates of tiles, and not in paths of dated files.
_TILE = re.compile(r"\{(z|zoom|x|-?y|q)\}")


@dataclass(frozen=True)
class SourceOptions:
    """What is wanted of a source, and how it is to be asked.

    Parameters
    ----------
    seed : int
        Of the embedded world.
    key, secret : str or None
        API key and signing secret; None for those of the environment.
    date : str or None
        Of the imagery, where the source has several; None for its default.
    crs : str
        Coordinate reference system in which pictures are made, one that the source has pixels in: ``EPSG:code``, and
        EPSG:3857 for those of the Web-Mercator map. Empty for the source's own, and the map's of a service that has it.
    area_deg : tuple of float, or None
        West, south, east and north of the ground that pictures are made of, where that is known: of several systems of
        a service the one that suits it best is taken.
    tile_px : int or None
        Size of tiles; None for the source's own, 256 for a template.
    max_zoom : int or None
        Highest zoom of a template; None for 22. Catalogue entries know theirs.
    connections : int
        Requests under way at once, where the provider allows so many.
    transport : Transport or None
        None for one of its own over requests.
    cache : TileCache or None
        Where tiles are kept for later runs, as far as the provider allows it; None for nowhere.
    placeholders : tuple of str
        Files of the provider that count as missing, beside those it is known for, by their SHA-256 or 16 of its digits.
    bands : tuple of str
        Of the source's bands, by name or by number from 1, in the order that is wanted; empty for all, or for those of
        colours.
    stretch : str
        How values become 8 bits: ``none``, ``percentile``, or two numbers.
    as_stored : bool
        Pixels are wanted with all their bands and in the source's own type, as GeoTIFF takes them; otherwise they are
        red, green and blue of 8 bits.
    heights : bool
        Pixels are heights: the first band of a raster file as float32, whose rows may run along degrees.
    encoded : bool
        Colours of tiles are numbers, such as heights: they are handed out as they are, with their own alpha.
    named_by_user : bool
        The user has named the source himself, and no file has: where it is an address with {key}, the environment's
        key is for its host. Otherwise that goes to the hosts of TERRAINAV_KEY_HOSTS alone.
    sharers : int
        Runs that ask the provider at the same time and know nothing of each other: each has its share of what the
        provider allows (`Policy.shared`). 0 for a run that is alone.
    """

    seed: int = 2024
    key: str | None = None
    secret: str | None = None
    date: str | None = None
    crs: str = ""
    area_deg: Bounds | None = None
    tile_px: int | None = None
    max_zoom: int | None = None
    connections: int = 8
    transport: Transport | None = None
    cache: TileCache | None = None
    placeholders: tuple[str, ...] = ()
    bands: tuple[str, ...] = ()
    stretch: str = NO_STRETCH
    as_stored: bool = False
    heights: bool = False
    encoded: bool = False
    named_by_user: bool = False
    sharers: int = 0

    def __post_init__(self) -> None:
        if self.connections < 1:
            raise InvalidInput("{0} connections: must be 1 or more", self.connections)
        object.__setattr__(self, "placeholders", Placeholder().with_files(self.placeholders).sha256)


def named_source(text: str, options: SourceOptions = SourceOptions()) -> NamedSource:
    """Return the source that a text names; whether there is one, it says where it is asked for more.

    Parameters
    ----------
    text : str
        A name of the catalogue or of the user's own sources; a URL template; ``wmts:URL``, ``wms:URL``, ``arcgis:URL``
        or ``ogcapi:URL`` (see `services`); an MBTiles file; any other raster file, or a path of such files with {date}
        in it.
    options : SourceOptions

    Raises
    ------
    InvalidInput
        It is a map of QGIS, which the plugin alone knows; or bands or a stretch are wanted of what is no raster file.
    """
    kind = source_kind(text)
    if kind is _QGIS:
        raise InvalidInput(
            "source {0}: is a map of QGIS and can be captured inside QGIS only",
            text,
            remedy="name a file, a URL template or a name of the catalogue",
        )
    of_kind: type[NamedSource] = getattr(_imported(kind.module), kind.source)
    if not of_kind.has_bands:
        check_colours(text, options.bands, options.stretch)
    return of_kind(text, options)


def check_colours(text: str, bands: tuple[str, ...], stretch: str) -> None:
    """Refuse bands and a stretch for a source, as a mission names it, that is red, green and blue of 8 bits."""
    if bands:
        raise InvalidInput(
            "bands {0}: {1} has red, green and blue alone, as all sources but raster files",
            " ".join(bands),
            text,
            field="bands",
        )
    if stretch != NO_STRETCH:
        raise InvalidInput(
            "stretch {0}: {1} has 8 bits, as all sources but raster files",
            stretch,
            text,
            field="stretch",
        )


def open_source(name: str, **options: Any) -> Source:
    """Open the source that a text names, to fetch pixels.

    Parameters
    ----------
    name : str
        See `named_source`.
    **options
        See `SourceOptions`.

    Raises
    ------
    InvalidInput, SourceError
        As `NamedSource.open` does.
    """
    return named_source(name, SourceOptions(**options)).open()


@dataclass(frozen=True)
class SourceKind:
    """A kind of source: how a text names one, and the class that it is.

    Parameters
    ----------
    name : str
    named_by : str
        What a user gives to name one: `FILE`, `ADDRESS`, `SERVICE`, `NAMED` or `PROJECT`.
    module, source : str
        Module of this package and the class of `NamedSource` in it; imported where there is such a source.
    endings : tuple of str
        By which paths are known for its files, whether or not they are there.
    recognised_by : callable
        Whether another text names one as well, as far as no kind before it is named by that.
    """

    name: str
    named_by: str
    module: str
    source: str
    endings: tuple[str, ...] = ()
    recognised_by: Callable[[str], object] = lambda _: None

    def recognises(self, text: str) -> bool:
        """Whether a text names such a source, as far as no kind before it does."""
        by_ending = Path(text).suffix.lower() in self.endings and _is_path(text)
        return by_ending or bool(self.recognised_by(text))

    @property
    def is_file(self) -> bool:
        """Whether it is named by the path of a file."""
        return self.named_by == FILE

    @property
    def is_address(self) -> bool:
        """Whether it is named by an address, be it that of tiles or of a service."""
        return self.named_by in (ADDRESS, SERVICE)

    @property
    def is_service(self) -> bool:
        """Whether it is named by the address of a service, which is to be asked for dates and terms."""
        return self.named_by == SERVICE


def _is_path(text: str) -> bool:
    """Whether a text may be a path: an address is none, nor is a template whose https:// was forgotten."""
    if _is_within_file(text):
        return True
    return "://" not in text and (_TILE.search(text) is None or is_there(text))


def _is_within_file(text: str) -> bool:
    return text.startswith("/vsi") or bool(RASTER_ADDRESS.fullmatch(text) or file_of_part(text))


def _is_any_file(text: str) -> bool:
    """Whether a text names what GDAL may open; where a name of the catalogue is one of a file too, ``./name`` is."""
    return _is_within_file(text) or (_is_path(text) and NAME.fullmatch(text) is None and is_there(text))


#: What a user names a source by: a path, an address of tiles or of a service, a name, or a map of a QGIS project.
FILE, ADDRESS, SERVICE, NAMED, PROJECT = "file", "address", "service", "name", "project"
_RASTERS = (
    *(".tif", ".tiff", ".vrt", ".jp2", ".img", ".png", ".jpg", ".jpeg", ".ecw", ".gpkg", ".cog"),
    *(".hgt", ".asc"),
)
#: Kinds of sources, asked in this order. A further one is its module and a line.
KINDS = (
    SourceKind("mbtiles", FILE, ".mbtiles", "MBTilesFile", endings=(".mbtiles",)),
    SourceKind("raster", FILE, ".raster.source", "RasterFile", endings=_RASTERS, recognised_by=_is_any_file),
    SourceKind("service", SERVICE, ".services.ogc", "ServiceLayer", recognised_by=_SERVICE.match),
    SourceKind("arcgis", SERVICE, ".services.arcgis", "ArcGISService", recognised_by=_ARCGIS.match),
    SourceKind("ogcapi", SERVICE, ".services.ogcapi", "OGCAPITiles", recognised_by=_OGC_API.match),
    SourceKind("template", ADDRESS, ".catalogue", "URLTemplate", recognised_by=_ADDRESS.search),
    SourceKind("catalogue", NAMED, ".catalogue", "CatalogueName", recognised_by=lambda _: True),
)
#: Maps of QGIS, which the plugin alone opens.
_QGIS = SourceKind("qgis", PROJECT, "", "", recognised_by=re.compile("qgis:").match)


def source_kind(text: str) -> SourceKind:
    """Kind of source that a text names, whether or not there is such a source."""
    return next(kind for kind in (_QGIS, *KINDS) if kind.recognises(text))


def whole_path(text: str) -> str:
    """Text that names the same source in processes with another current folder: a file's path is whole."""
    if not source_kind(text).is_file or text.startswith("/vsi") or RASTER_ADDRESS.fullmatch(text):
        return text
    file = file_of_part(text) or text
    return text.replace(file, str(Path.cwd() / file))


def _imported(module: str) -> ModuleType:
    """Module by its name, relative to this package."""
    # By the built-in import and not importlib's: that is where QGIS keeps book of what it forgets when a plugin goes.
    return __import__(resolve_name(module, __package__ or ""), fromlist=["*"])


class NamedSource(ABC):
    """A source as a mission names it; each kind of them is a class of its own, in the table of `opening`.

    Making one reads nothing, and neither does asking for what the text itself tells: `is_local`, `needs_key`,
    `stated_policy`, `environment_key`. For the rest a file may be opened or a service asked for its capabilities, once;
    it raises InvalidInput and SourceError as `open` does. No key is needed until `open`, but by a service that wants
    one with the request for its capabilities.
    """

    #: Whether it may have other bands than red, green and blue of 8 bits.
    has_bands = False

    def __init__(self, text: str, options: SourceOptions) -> None:
        self.text, self.options = text, options

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.text!r})"

    def asked(self, options: SourceOptions) -> NamedSource:
        """Return the same source, asked in another way: what is known of it already is kept."""
        other = copy(self)
        other.options = options
        return other

    def __getstate__(self) -> dict[str, Any]:
        """What another process needs: no keys, no transport, nothing that is open."""
        options = replace(self.options, key=None, secret=None, transport=None)
        return {**self._described(), "text": self.text, "options": options}

    def _described(self) -> dict[str, Any]:
        """What is known of it that another process need not find out, or could not."""
        return {}

    @property
    def is_local(self) -> bool:
        """Whether its pixels are on this machine: no request is made, and no terms hold."""
        return False

    @property
    def needs_key(self) -> bool:
        """Whether it cannot be had without an API key."""
        return False

    @property
    def stated_policy(self) -> Policy | None:
        """What its provider allows; None where only the service could tell."""
        return self.policy

    def environment_key(self) -> str | None:
        """Return the key that the environment has for it; raises SourceError where that key is for other hosts."""
        return None

    def layers(self) -> list[Offered] | None:
        """Layers to choose from, where the text names a service and none of them yet; None for every other source."""
        return None

    @property
    def entry(self) -> CatalogueEntry:
        """All that is known of it; raises InvalidInput for a file, of which no terms are known."""
        raise InvalidInput(
            "source {0}: a file states no terms", self.text, remedy="name one of the sources that have some"
        )

    @property
    @abstractmethod
    def _known(self) -> CatalogueEntry | Source:
        """What tells its title, map types and terms."""

    @property
    def title(self) -> str:
        """What people see."""
        return self._known.title

    @property
    def map_types(self) -> tuple[str, ...]:
        """Map types it can tell apart; empty where it has one kind of picture only."""
        return self._known.map_types

    @property
    def bands(self) -> Bands:
        """What its pixels are, as the options ask for them."""
        return bands_of(self._known)

    @property
    def policy(self) -> Policy:
        """What its provider allows, or the licence that a file states."""
        return self._known.policy

    @property
    @abstractmethod
    def grid(self) -> PixelGrid:
        """Its pixels."""

    @property
    @abstractmethod
    def date(self) -> str:
        """Date of its imagery; empty where that is not known."""

    @abstractmethod
    def open(self) -> Source:
        """Open it, to fetch pixels.

        Raises
        ------
        InvalidInput
            The name, date or tile size is unknown, or a template or placeholder is not valid.
        SourceError
            A key is needed and missing, or for other hosts; or the service or file cannot be read.
        """


class EntrySource(NamedSource):
    """A source that an entry describes."""

    @abstractmethod
    def _find(self) -> CatalogueEntry:
        """Find the entry; asked once."""

    @cached_property
    def entry(self) -> CatalogueEntry:
        """All that is known of it."""
        return self._find()

    def _described(self) -> dict[str, Any]:
        return {"entry": self.entry}

    @property
    def _known(self) -> CatalogueEntry:
        return self.entry

    @property
    def _pixels(self) -> ModuleType:
        """Module that makes sources of entries of its kind."""
        return _imported(PIXELS[self.entry.kind])

    @property
    def needs_key(self) -> bool:
        """Whether its entry names an environment variable with a key."""
        return self.entry.key_env is not None

    def environment_key(self) -> str | None:
        """Key of the variable that the entry names."""
        return os.environ.get(self.entry.key_env) if self.entry.key_env else None

    @cached_property
    def _wanted(self) -> tuple[str, PixelGrid]:
        """Date and grid that the options ask for; both are refused together, as a plan asks for the grid alone."""
        grid = self.entry.grid(self.options.tile_px)
        if self.options.crs not in ("", grid.plane.crs):
            raise refused_crs(self.options.crs, self.entry.title, [grid.plane.crs])
        return self.entry.date(self.options.date), grid

    @property
    def grid(self) -> PixelGrid:
        """Grid of the tile size asked for."""
        return self._wanted[1]

    @property
    def date(self) -> str:
        """Date asked for, or the default; empty where there is but one."""
        return self._wanted[0]

    def open(self) -> Source:
        """Open it with the key that is given, or with the environment's."""
        entry, date, options = self.entry, self.date, self.options
        key = options.key or (self.environment_key() if entry.key_env else None)
        if entry.key_env and not key:
            raise SourceError(
                "{0}: needs an API key: set the environment variable {1}", entry.title, entry.key_env
            )
        source: Source = self._pixels.open_entry(entry, date, key, options)
        return source


class DescribedSource(EntrySource):
    """A source whose entry is given, as that of a connection of QGIS is."""

    def __init__(self, entry: CatalogueEntry, options: SourceOptions) -> None:
        super().__init__(entry.name, options)
        self._given = entry

    def _described(self) -> dict[str, Any]:
        return {"entry": self._given, "_given": self._given}

    def _find(self) -> CatalogueEntry:
        return self._given


class FileSource(NamedSource):
    """A file of pictures; what it says of itself is read once."""

    #: Whether a date may be asked for.
    takes_date = False

    @abstractmethod
    def _open(self, date: str) -> Source:
        """Open the file, of a date where one is asked for; raises InvalidInput where it cannot be."""

    def __getstate__(self) -> dict[str, Any]:
        """What another process needs, which may have another current folder."""
        return {**super().__getstate__(), "text": whole_path(self.text)}

    def open(self) -> Source:
        """Open it; raises InvalidInput where that cannot be, and for a date that it does not take."""
        date = self.options.date or ""
        if date and not self.takes_date:
            raise InvalidInput("date {0!r}: {1} has no dates to choose from", date, self.text, field="date")
        source, wanted = self._open(date), self.options.crs
        plane = source.grid.plane
        if wanted not in ("", plane.crs):
            source.close()
            raise refused_crs(wanted, source.title, [source.grid.own.name if source.grid.own else MAP, MAP])
        return source

    @property
    def is_local(self) -> bool:
        """Whether its pixels are on this machine: not where GDAL is to fetch them."""
        return FETCHED.search(self.text) is None

    @property
    def stated_policy(self) -> Policy:
        """Terms of the provider that it is fetched from; what the file itself would state is not read."""
        known = None if self.is_local else strictest(providers_in(self.text))
        return Policy() if known is None else known.policy

    @cached_property
    def _known(self) -> Source:
        source = self.open()
        source.close()
        return source

    @property
    def grid(self) -> PixelGrid:
        """Its pixels, up to its own zoom."""
        return self._known.grid

    @property
    def date(self) -> str:
        """Date asked for, or that the file states."""
        return self._known.date
