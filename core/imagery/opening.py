"""From the text that names a source in a mission to that source: a name, a URL, a service or a file."""

from __future__ import annotations

import importlib
import re
from pathlib import Path
from typing import Any, Callable, NamedTuple

from ..errors import InvalidInput
from ..files import is_there
from .catalogue.user_sources import NAME
from .named import NamedSource, SourceOptions
from .source import Source

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
#: What GDAL's names of rasters within a file begin with, such as GPKG:ortho.gpkg:summer; a drive has one letter.
_WITHIN = re.compile(r"[A-Z][A-Za-z0-9_]+:")


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


def is_file(text: str) -> bool:
    """Whether a source is named by a file of pictures, whether or not it is there.

    A name as the catalogue has them is none, even where there is such a file: ``./name`` is.
    """
    if text.startswith("/vsi") or _is_within_file(text):
        return True
    if text.startswith(_QGIS) or "://" in text:
        return False
    if _TILE.search(text) and not is_there(text):
        # A template whose https:// was forgotten, as that says what is wrong.
        return False
    return _ending(text) in _RASTER_ENDINGS | {_MBTILES_ENDING} or (
        NAME.fullmatch(text) is None and is_there(text)
    )


def _is_within_file(text: str) -> bool:
    if not _WITHIN.match(text):
        return False
    from .raster.files import file_of_part

    return bool(file_of_part(text))


def _ending(text: str) -> str:
    return Path(text).suffix.lower()


#: Kinds of sources, asked in this order. A further one is its module and a line.
KINDS = (
    Kind(
        "mbtiles", lambda text: is_file(text) and _ending(text) == _MBTILES_ENDING, ".mbtiles", "MBTilesFile"
    ),
    Kind("raster", is_file, ".raster.named", "RasterFile"),
    Kind("service", lambda text: _SERVICE.match(text) is not None, ".services.ogc", "ServiceLayer"),
    Kind("template", lambda text: "://" in text or "{" in text, ".catalogue.listing", "URLTemplate"),
    Kind("catalogue", lambda _: True, ".catalogue.listing", "CatalogueName"),
)


def kind_of(text: str) -> str:
    """Name of the kind of source that a text names, among `KINDS`; raises InvalidInput for a map of QGIS."""
    return _kind(text).name


def is_service(text: str) -> bool:
    """Whether a source is named by a WMTS or WMS."""
    return not text.startswith(_QGIS) and kind_of(text) == "service"


def is_address(text: str) -> bool:
    """Whether a source is named by an address: a URL template, or a service."""
    return not text.startswith(_QGIS) and kind_of(text) in ("service", "template")


def named_source(text: str, options: SourceOptions = SourceOptions()) -> NamedSource:  # noqa: B008 (immutable)
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
    module = importlib.import_module(kind.module, __package__)
    source: NamedSource = getattr(module, kind.source)(text, options)
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


def _kind(text: str) -> Kind:
    if text.startswith(_QGIS):
        raise InvalidInput(
            f"source {text}: is a map of QGIS and can be captured inside QGIS only; name a file, a URL template or "
            "a name of the catalogue"
        )
    return next(kind for kind in KINDS if kind.recognises(text))
