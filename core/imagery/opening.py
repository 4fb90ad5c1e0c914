"""From the text that names a source in a mission to one value that tells all of it, and to the source itself."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from importlib.util import resolve_name
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Callable, NamedTuple

from ..errors import InvalidInput, SourceError
from ..files import is_there
from ..geodesy.mercator import PixelGrid
from .entry import NAME, PIXELS, CatalogueEntry
from .placeholder import Placeholder
from .policy import Policy
from .raster.trust import file_of_part
from .source import Source

if TYPE_CHECKING:
    from .cache.tile_cache import TileCache
    from .http.transport import Transport
    from .services.capabilities import Offered

#: Endings by which a name is known for a raster file that is not there, to say the right thing.
_RASTER_ENDINGS = frozenset(
    [".tif", ".tiff", ".vrt", ".jp2", ".img", ".png", ".jpg", ".jpeg", ".ecw", ".gpkg", ".cog"]
)
_MBTILES_ENDING = ".mbtiles"
_SERVICE = re.compile(r"wm(ts|s):.*://", re.IGNORECASE | re.DOTALL)
#: What stands in templates of tiles, and not in paths of dated files.
_TILE = re.compile(r"\{(z|zoom|x|-?y|q)\}")
#: What the plugin names layers of its project by.
_QGIS = "qgis:"


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
    named_by_user : bool
        The user has named the source himself, and no file has: where it is an address with {key}, the environment's
        key is for its host. Otherwise that goes to the hosts of TERRAINAV_KEY_HOSTS alone.
    """

    seed: int = 2024
    key: str | None = None
    secret: str | None = None
    date: str | None = None
    tile_px: int | None = None
    max_zoom: int | None = None
    connections: int = 8
    transport: Transport | None = None
    cache: TileCache | None = None
    placeholders: tuple[str, ...] = ()
    named_by_user: bool = False

    def __post_init__(self) -> None:
        if self.connections < 1:
            raise InvalidInput("{0} connections: must be 1 or more", self.connections)
        object.__setattr__(self, "placeholders", Placeholder().with_files(self.placeholders).sha256)


def named_source(text: str, options: SourceOptions = SourceOptions()) -> NamedSource:
    """Return the source that a text names; whether there is one, it says where it is asked for more.

    Parameters
    ----------
    text : str
        A name of the catalogue or of the user's own sources; a URL template; ``wmts:URL`` or ``wms:URL`` (see
        `services.ogc`); an MBTiles file; any other raster file, or a path of such files with {date} in it.
    options : SourceOptions

    Raises
    ------
    InvalidInput
        It is a map of QGIS, which the plugin alone knows.
    """
    kind = _kind(text)
    source: NamedSource = getattr(_imported(kind.module), kind.source)(text, options)
    return source


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


def kind_of(text: str) -> str:
    """Name of the kind of source that a text names, among `KINDS`; raises InvalidInput for a map of QGIS."""
    return _kind(text).name


def is_service(text: str) -> bool:
    """Whether a source is named by a WMTS or WMS."""
    return not text.startswith(_QGIS) and kind_of(text) == "service"


def is_address(text: str) -> bool:
    """Whether a source is named by an address: a URL template, or a service."""
    return not text.startswith(_QGIS) and kind_of(text) in ("service", "template")


def is_file(text: str) -> bool:
    """Whether a source is named by a file of pictures, whether or not it is there.

    A name as the catalogue has them is none, even where there is such a file: ``./name`` is.
    """
    if text.startswith("/vsi") or file_of_part(text):
        return True
    if text.startswith(_QGIS) or "://" in text:
        return False
    if _TILE.search(text) and not is_there(text):
        # A template whose https:// was forgotten, as that says what is wrong.
        return False
    return _ending(text) in _RASTER_ENDINGS | {_MBTILES_ENDING} or (
        NAME.fullmatch(text) is None and is_there(text)
    )


def _ending(text: str) -> str:
    return Path(text).suffix.lower()


class Kind(NamedTuple):
    """A kind of source by how it is named.

    Parameters
    ----------
    name : str
    recognises : callable
        Whether a text names such a source, as far as no kind before it does.
    module, source : str
        Module of this package and the class of `NamedSource` in it; imported where there is such a source.
    """

    name: str
    recognises: Callable[[str], bool]
    module: str
    source: str


#: Kinds of sources, asked in this order. A further one is its module and a line.
KINDS = (
    Kind(
        "mbtiles", lambda text: is_file(text) and _ending(text) == _MBTILES_ENDING, ".mbtiles", "MBTilesFile"
    ),
    Kind("raster", is_file, ".raster.source", "RasterFile"),
    Kind("service", lambda text: _SERVICE.match(text) is not None, ".services.ogc", "ServiceLayer"),
    Kind("template", lambda text: "://" in text or "{" in text, ".catalogue", "URLTemplate"),
    Kind("catalogue", lambda _: True, ".catalogue", "CatalogueName"),
)


def _kind(text: str) -> Kind:
    if text.startswith(_QGIS):
        raise InvalidInput(
            "source {0}: is a map of QGIS and can be captured inside QGIS only",
            text,
            remedy="name a file, a URL template or a name of the catalogue",
        )
    return next(kind for kind in KINDS if kind.recognises(text))


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

    Parameters
    ----------
    text : str
    options : SourceOptions
    """

    def __init__(self, text: str, options: SourceOptions) -> None:
        self.text, self.options = text, options

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.text!r})"

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
            "source {0}: a file states no terms",
            self.text,
            remedy="name one of the sources that have some",
        )

    @property
    @abstractmethod
    def title(self) -> str:
        """What people see."""

    @property
    @abstractmethod
    def map_types(self) -> tuple[str, ...]:
        """Map types it can tell apart; empty where it has one kind of picture only."""

    @property
    @abstractmethod
    def grid(self) -> PixelGrid:
        """Its pixels."""

    @property
    @abstractmethod
    def policy(self) -> Policy:
        """What its provider allows."""

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

    @property
    def needs_key(self) -> bool:
        """Whether its entry names an environment variable with a key."""
        return self.entry.key_env is not None

    def environment_key(self) -> str | None:
        """Key of the variable that the entry names."""
        return self.entry.key(None)

    @property
    def title(self) -> str:
        """Title of the entry."""
        return self.entry.title

    @property
    def map_types(self) -> tuple[str, ...]:
        """Map types of the entry."""
        return self.entry.map_types

    @property
    def policy(self) -> Policy:
        """Terms of the entry."""
        return self.entry.policy

    @cached_property
    def _wanted(self) -> tuple[str, PixelGrid]:
        """Date and grid that the options ask for; both are refused together, as a plan asks for the grid alone."""
        return self.entry.date(self.options.date), self.entry.grid(self.options.tile_px)

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
        pixels = _imported(PIXELS[entry.kind])
        source: Source = pixels.open_entry(entry, date, key, options)
        return source


class DescribedSource(EntrySource):
    """A source whose entry is given, as that of a connection of QGIS is.

    Parameters
    ----------
    entry : CatalogueEntry
    options : SourceOptions
    """

    def __init__(self, entry: CatalogueEntry, options: SourceOptions) -> None:
        super().__init__(entry.name, options)
        self._given = entry

    def _find(self) -> CatalogueEntry:
        return self._given


class FileSource(NamedSource):
    """A file of pictures, on this machine; what it says of itself is read once."""

    @property
    def is_local(self) -> bool:
        """Whether its pixels are on this machine: they are."""
        return True

    @property
    def stated_policy(self) -> Policy:
        """Terms that the file itself would state are not read."""
        return Policy()

    @cached_property
    def _read(self) -> Source:
        source = self.open()
        source.close()
        return source

    @property
    def title(self) -> str:
        """Title that the file states, or its name."""
        return self._read.title

    @property
    def map_types(self) -> tuple[str, ...]:
        """None: a file has one kind of picture."""
        return ()

    @property
    def grid(self) -> PixelGrid:
        """Its pixels, up to its own zoom."""
        return self._read.grid

    @property
    def policy(self) -> Policy:
        """Licence that the file states."""
        return self._read.policy

    @property
    def date(self) -> str:
        """Date asked for, or that the file states."""
        return self._read.date
