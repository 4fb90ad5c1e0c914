"""Interpret the text that names a source in a mission; the result describes the source and opens it."""

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

from ..bands import NO_STRETCH, Bands, source_bands
from ..errors import InvalidInput, SourceError
from ..geodesy.mercator import PixelGrid
from ..geodesy.sun import SunDirection
from ..storage.files import file_exists
from .entry import NAME, PIXELS, CatalogueEntry, find_providers, strictest
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


@dataclass(frozen=True)
class SourceOptions:
    """Options of a source and of its requests.

    Parameters
    ----------
    seed : int
        Seed of the embedded world.
    key, secret : str or None
        API key and signing secret; None to read them from the environment.
    sun : SunDirection or None
        Sun that lights the embedded world; None for the light of maps. Other sources have their own light.
    date : str or None
        Date of the imagery; None for the source's default.
    crs : str
        Coordinate reference system of the pictures, in which the source must have pixels: ``EPSG:code``, with EPSG:3857
        for the Web-Mercator map. Empty for the source's CRS; of a service, for EPSG:3857 if available.
    area_deg : tuple of float, or None
        West, south, east and north of the ground, to select the most suitable CRS of a service; None if unknown.
    tile_px : int or None
        Tile size; None for the default of the source, which is 256 for a template.
    max_zoom : int or None
        Highest zoom of a template; None for 22. Has no effect on catalogue entries.
    connections : int
        Most requests at a time; the provider may allow fewer.
    transport : Transport or None
        None to create a `RequestsTransport`.
    cache : TileCache or None
        Keeps tiles for later runs if the provider allows it; None to keep none.
    placeholders : tuple of str
        SHA-256, or the first 16 digits or more, of further files that count as missing.
    bands : tuple of str
        Bands in the wanted order, by name or by number from 1; empty for all, or for red, green and blue.
    stretch : str
        Conversion of values to 8 bits: ``none``, ``percentile``, or two numbers.
    as_stored : bool
        Whether to return all bands in the source's data type, for GeoTIFF; otherwise red, green and blue of 8 bits.
    heights : bool
        Whether to return heights: the first band of a raster file as float32, on a grid that may be in degrees.
    encoded : bool
        Whether to return colours and alpha of tiles unchanged, as they encode numbers such as heights.
    named_by_user : bool
        Whether the user, not a file, has named the source. If so, any host of an address with {key} may receive the
        environment's key; otherwise only hosts in TERRAINAV_KEY_HOSTS may.
    sharers : int
        Number of independent runs that use the provider at once, each with a share of the limits (`Policy.shared`);
        0 for a single run.
    """

    seed: int = 2024
    sun: SunDirection | None = None
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
        object.__setattr__(self, "placeholders", Placeholder().extended(self.placeholders).sha256)


def named_source(text: str, options: SourceOptions = SourceOptions()) -> NamedSource:
    """Describe the source that a text names, without a check that the source exists.

    Parameters
    ----------
    text : str
        A name of the catalogue or of the user's sources; a URL template; ``wmts:URL``, ``wms:URL``, ``arcgis:URL``
        or ``ogcapi:URL`` (see `services`); an MBTiles file; another raster file, or a path with {date} of several such
        files.
    options : SourceOptions

    Raises
    ------
    InvalidInput
        The text names a map of QGIS, which only the plugin opens; bands or a stretch are given for a source that is not
        a raster file; or a sun for one that is not the embedded world.
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
    named = of_kind(text, options)
    if options.sun is not None and not named.is_lit_by_sun:
        check_sun(text, options.sun)
    return named


def check_sun(title: str, sun: SunDirection | None) -> None:
    """Refuse a sun for imagery, whose shadows stay where they were."""
    if sun is not None:
        raise InvalidInput(
            "sun at {0:.1f} degrees: {1} has the light in which it was taken, and only the synthetic world can be lit",
            sun.height_deg,
            title,
            field="sun",
        )


def check_colours(text: str, bands: tuple[str, ...], stretch: str) -> None:
    """Refuse bands and a stretch for a source that has 8-bit red, green and blue only."""
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
    """Open the source that a text names.

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
    """A kind of source: the texts that name one, and the class that describes it.

    Parameters
    ----------
    name : str
    named_by : str
        `FILE`, `ADDRESS`, `SERVICE`, `NAMED` or `PROJECT`.
    module, source : str
        Module of this package, imported when needed, and the name of its subclass of `NamedSource`.
    endings : tuple of str
        Extensions of files of this kind; paths with them are recognised even if no file exists.
    recognised_by : callable
        Called with a text without such an extension; returns whether the text names a source of this kind, unless an
        earlier kind recognises it.
    """

    name: str
    named_by: str
    module: str
    source: str
    endings: tuple[str, ...] = ()
    recognised_by: Callable[[str], object] = lambda _: None

    def recognises(self, text: str) -> bool:
        """Whether a text names a source of this kind, unless an earlier kind recognises the text."""
        by_ending = Path(text).suffix.lower() in self.endings and _is_path(text)
        return by_ending or bool(self.recognised_by(text))

    @property
    def is_file(self) -> bool:
        """Whether a path names such a source."""
        return self.named_by == FILE

    @property
    def is_address(self) -> bool:
        """Whether an address of tiles or of a service names such a source."""
        return self.named_by in (ADDRESS, SERVICE)

    @property
    def is_service(self) -> bool:
        """Whether the address of a service names such a source; the service is requested for dates and terms."""
        return self.named_by == SERVICE


def _is_path(text: str) -> bool:
    """Whether a text may be a path, not an address or a template without https://."""
    if _is_inside_file(text):
        return True
    # These placeholders occur in templates of tiles, not in paths of dated files.
    return "://" not in text and (re.search(r"\{(z|zoom|x|-?y|q)\}", text) is None or file_exists(text))


def _is_inside_file(text: str) -> bool:
    return text.startswith("/vsi") or bool(RASTER_ADDRESS.fullmatch(text) or file_of_part(text))


def _is_any_file(text: str) -> bool:
    """Whether GDAL may open a text as a file; files named like sources of the catalogue are written ``./name``."""
    return _is_inside_file(text) or (_is_path(text) and NAME.fullmatch(text) is None and file_exists(text))


#: Ways to name a source: path, address of tiles, address of a service, name, map of a QGIS project.
FILE, ADDRESS, SERVICE, NAMED, PROJECT = "file", "address", "service", "name", "project"


def _has_prefix(prefix: str) -> Callable[[str], object]:
    """Return a function that finds whether a text is an address after a prefix such as ``wms:``."""
    return re.compile(rf"{prefix}:.*://", re.IGNORECASE | re.DOTALL).match


#: Kinds of sources, tried in this order. To add one, write its module and a line here.
KINDS = (
    SourceKind("mbtiles", FILE, ".mbtiles", "MBTilesFile", endings=(".mbtiles",)),
    SourceKind(
        *("raster", FILE, ".raster.source", "RasterFile"),
        endings=tuple(".tif .tiff .vrt .jp2 .img .png .jpg .jpeg .ecw .gpkg .cog .hgt .asc".split()),
        recognised_by=_is_any_file,
    ),
    SourceKind("service", SERVICE, ".services.ogc", "ServiceLayer", recognised_by=_has_prefix("wm(ts|s)")),
    SourceKind("arcgis", SERVICE, ".services.arcgis", "ArcGISService", recognised_by=_has_prefix("arcgis")),
    SourceKind("ogcapi", SERVICE, ".services.ogcapi", "OGCAPITiles", recognised_by=_has_prefix("ogcapi")),
    SourceKind("template", ADDRESS, ".catalogue", "URLTemplate", recognised_by=re.compile(r"://|\{").search),
    SourceKind("catalogue", NAMED, ".catalogue", "CatalogueName", recognised_by=lambda _: True),
)
#: Maps of QGIS, which only the plugin opens.
_QGIS = SourceKind("qgis", PROJECT, "", "", recognised_by=re.compile("qgis:").match)


def source_kind(text: str) -> SourceKind:
    """Kind of source that a text names, even if the source does not exist."""
    return next(kind for kind in (_QGIS, *KINDS) if kind.recognises(text))


def whole_path(text: str) -> str:
    """Make the path in a text absolute, so that the text names the same source from any current folder."""
    if not source_kind(text).is_file or text.startswith("/vsi") or RASTER_ADDRESS.fullmatch(text):
        return text
    file = file_of_part(text) or text
    return text.replace(file, str(Path.cwd() / file))


def _imported(module: str) -> ModuleType:
    """Module by its name, relative to this package."""
    # Do not use importlib: QGIS hooks `__import__` to unload the modules of a plugin.
    return __import__(resolve_name(module, __package__ or ""), fromlist=["*"])


class NamedSource(ABC):
    """A source as a mission names it; each of `KINDS` has a subclass.

    The constructor, `is_local`, `needs_key`, `stated_policy` and `environment_key` depend on the text only and read no
    file. Other members may, once, open the file or request the capabilities of the service, and raise InvalidInput and
    SourceError as `open` does. `open` needs the key, and so do other members if a service requires the key for its
    capabilities.
    """

    #: Whether sources of this kind may have bands other than 8-bit red, green and blue.
    has_bands = False

    def __init__(self, text: str, options: SourceOptions) -> None:
        self.text, self.options = text, options

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.text!r})"

    def asked(self, options: SourceOptions) -> NamedSource:
        """Return the same source with other options; facts already read are kept."""
        other = copy(self)
        other.options = options
        return other

    def __getstate__(self) -> dict[str, Any]:
        """State for another process, without keys, transport and open files."""
        options = replace(self.options, key=None, secret=None, transport=None)
        return {**self._described(), "text": self.text, "options": options}

    def _described(self) -> dict[str, Any]:
        """Facts to pass to another process, which then need not read them again."""
        return {}

    @property
    def is_local(self) -> bool:
        """Whether the pixels are on this machine, so that no requests are made and no terms apply."""
        return False

    @property
    def is_lit_by_sun(self) -> bool:
        """Whether the pixels are computed in the light of the sun of the options."""
        return False

    @property
    def sun(self) -> SunDirection | None:
        """Sun that lights the pixels; None for the light in which they are."""
        return self.options.sun

    @property
    def needs_key(self) -> bool:
        """Whether the source needs an API key."""
        return False

    @property
    def stated_policy(self) -> Policy | None:
        """Terms of the provider; None if only the service states them."""
        return self.policy

    def environment_key(self) -> str | None:
        """Return the source's key in the environment, or None; raises SourceError if the key is for other hosts."""
        return None

    def layers(self) -> list[Offered] | None:
        """Layers to choose from if the text names a service without a layer; otherwise None."""
        return None

    @property
    def entry(self) -> CatalogueEntry:
        """Entry that describes the source; raises InvalidInput for a file, which has no entry."""
        raise InvalidInput(
            "source {0}: a file states no terms", self.text, remedy="name one of the sources that have some"
        )

    @property
    @abstractmethod
    def _known(self) -> CatalogueEntry | Source:
        """Entry or source with its title, map types and terms."""

    @property
    def title(self) -> str:
        """Title for people."""
        return self._known.title

    @property
    def map_types(self) -> tuple[str, ...]:
        """Available map types; empty if there is a single kind of picture."""
        return self._known.map_types

    @property
    def bands(self) -> Bands:
        """Bands of the pixels, by the options."""
        return source_bands(self._known)

    @property
    def policy(self) -> Policy:
        """Terms of the provider, or the licence that a file states."""
        return self._known.policy

    @property
    @abstractmethod
    def grid(self) -> PixelGrid:
        """Pixel grid."""

    @property
    @abstractmethod
    def date(self) -> str:
        """Date of the imagery; empty if unknown."""

    @abstractmethod
    def open(self) -> Source:
        """Open the source to fetch pixels.

        Raises
        ------
        InvalidInput
            The name, date or tile size is unknown, or a template or placeholder is not valid.
        SourceError
            A key is missing or for other hosts, or the service or file cannot be read.
        """


class EntrySource(NamedSource):
    """A source described by an entry."""

    @abstractmethod
    def _find(self) -> CatalogueEntry:
        """Find the entry; called once."""

    @cached_property
    def entry(self) -> CatalogueEntry:
        """Entry that describes the source."""
        return self._find()

    def _described(self) -> dict[str, Any]:
        return {"entry": self.entry}

    @property
    def _known(self) -> CatalogueEntry:
        return self.entry

    @property
    def _pixels(self) -> ModuleType:
        """Module that opens entries of this kind."""
        return _imported(PIXELS[self.entry.kind])

    @property
    def needs_key(self) -> bool:
        """Whether the entry names an environment variable with a key."""
        return self.entry.key_env is not None

    def environment_key(self) -> str | None:
        """Key in the variable that the entry names."""
        return os.environ.get(self.entry.key_env) if self.entry.key_env else None

    @cached_property
    def _wanted(self) -> tuple[str, PixelGrid]:
        """Date and grid by the options; checked together, as a plan reads the grid only."""
        grid = self.entry.grid(self.options.tile_px)
        if self.options.crs not in ("", grid.plane.crs):
            raise refused_crs(self.options.crs, self.entry.title, [grid.plane.crs])
        return self.entry.date(self.options.date), grid

    @property
    def grid(self) -> PixelGrid:
        """Grid for the chosen tile size."""
        return self._wanted[1]

    @property
    def date(self) -> str:
        """Chosen date, or the default; empty if the source has only one."""
        return self._wanted[0]

    def open(self) -> Source:
        """Open the source with the given key, or the environment's."""
        entry, date, options = self.entry, self.date, self.options
        key = options.key or (self.environment_key() if entry.key_env else None)
        if entry.key_env and not key:
            raise SourceError("{0}: needs an API key: set the environment variable {1}", entry.title, entry.key_env)
        source: Source = self._pixels.open_entry(entry, date, key, options)
        return source


class DescribedSource(EntrySource):
    """A source with a given entry, such as a connection of QGIS."""

    def __init__(self, entry: CatalogueEntry, options: SourceOptions) -> None:
        super().__init__(entry.name, options)
        self._given = entry

    def _described(self) -> dict[str, Any]:
        return {"entry": self._given, "_given": self._given}

    def _find(self) -> CatalogueEntry:
        return self._given


class FileSource(NamedSource):
    """A file of pictures, whose description is read once."""

    #: Whether a date may be chosen.
    takes_date = False

    @abstractmethod
    def _open(self, date: str) -> Source:
        """Open the file of a date, empty for any; raises InvalidInput if the file cannot be opened."""

    def __getstate__(self) -> dict[str, Any]:
        """State for another process, which may have another current folder."""
        return {**super().__getstate__(), "text": whole_path(self.text)}

    def open(self) -> Source:
        """Open the file; raises InvalidInput if that fails, and for a date that is not available."""
        date = self.options.date or ""
        if date and not self.takes_date:
            raise InvalidInput("date {0!r}: {1} has no dates to choose from", date, self.text, field="date")
        source, wanted = self._open(date), self.options.crs
        plane = source.grid.plane
        if wanted not in ("", plane.crs):
            source.close()
            raise refused_crs(wanted, source.title, [plane.name, MAP])
        return source

    @property
    def is_local(self) -> bool:
        """Whether the pixels are on this machine, not fetched by GDAL."""
        return FETCHED.search(self.text) is None

    @property
    def stated_policy(self) -> Policy:
        """Terms of the provider that serves the file; terms in the file are not read."""
        known = None if self.is_local else strictest(find_providers(self.text))
        return Policy() if known is None else known.policy

    @cached_property
    def _known(self) -> Source:
        source = self.open()
        source.close()
        return source

    @property
    def grid(self) -> PixelGrid:
        """Pixel grid, up to the native zoom."""
        return self._known.grid

    @property
    def date(self) -> str:
        """Chosen date, or the date stated in the file."""
        return self._known.date
