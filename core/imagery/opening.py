"""From a source's name in a mission to the source: a name of the catalogue, a URL, a service or a file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InvalidInput, SourceError
from ..files import is_there
from .catalogue.entry import CatalogueEntry, under_provider
from .catalogue.listing import entry_named
from .catalogue.user_sources import NAME, described
from .keys import environment_key
from .source import Source
from .template import Template

if TYPE_CHECKING:
    from .cache.tile_cache import TileCache
    from .transport import Transport

#: Endings by which a name is known for a raster file that is not there, to say the right thing.
_RASTER_ENDINGS = frozenset(
    [".tif", ".tiff", ".vrt", ".jp2", ".img", ".png", ".jpg", ".jpeg", ".ecw", ".gpkg", ".cog"]
)
_MBTILES_ENDING = ".mbtiles"
#: What stands in templates of tiles, and not in paths of dated files.
_TILE = re.compile(r"\{(z|zoom|x|-?y|q)\}")
#: What the plugin names layers of its project by.
_QGIS = "qgis:"


def is_template(name: str) -> bool:
    """Whether a source is named by its URL template."""
    return not is_file(name) and not _is_service(name) and ("://" in name or "{" in name)


def is_file(name: str) -> bool:
    """Whether a source is named by a file of pictures, whether or not it is there.

    A name as the catalogue has them is none, even where there is such a file: ``./name`` is.
    """
    if name.startswith("/vsi") or _is_part(name):
        return True
    if name.startswith(_QGIS) or "://" in name:
        return False
    if _TILE.search(name) and not is_there(name):
        # A template whose https:// was forgotten, as that says what is wrong.
        return False
    ending = Path(name).suffix.lower()
    return (
        ending in _RASTER_ENDINGS
        or ending == _MBTILES_ENDING
        or (NAME.fullmatch(name) is None and is_there(name))
    )


def _is_service(name: str) -> bool:
    if "://" not in name:
        return False
    from .services.ogc import is_service

    return is_service(name)


def _is_part(name: str) -> bool:
    """Whether a name is GDAL's of a raster within a file, such as GPKG:ortho.gpkg:summer."""
    if ":" not in name[2:] or not name[:1].isupper():
        return False
    from .raster.files import file_of_part

    return bool(file_of_part(name))


def open_source(
    name: str,
    *,
    seed: int = 2024,
    key: str | None = None,
    secret: str | None = None,
    date: str | None = None,
    tile_px: int | None = None,
    max_zoom: int | None = None,
    connections: int = 8,
    transport: Transport | None = None,
    cache: TileCache | None = None,
    placeholders: Iterable[str] = (),
    plan_only: bool = False,
    named_by_user: bool = False,
) -> Source:
    """Open a source by name.

    Parameters
    ----------
    name : str
        A name of the catalogue or of the user's own sources; a URL template; ``wmts:URL`` or ``wms:URL`` (see
        `ogc`); an MBTiles file; any other raster file, or a path of such files with {date} in it.
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
    placeholders : iterable of str
        Files of the provider that count as missing, beside those it is known for, by their SHA-256 or 16 of its digits.
    plan_only : bool
        The source's grid and terms are wanted, nothing will be fetched: no key is needed.
    named_by_user : bool
        The user has named the source himself, and no file has: where it is an address with {key}, the environment's
        key is for its host. Otherwise that goes to the hosts of TERRAINAV_KEY_HOSTS alone.

    Raises
    ------
    InvalidInput
        The name, date or tile size is unknown, or the template is not valid.
    SourceError
        A key is needed and missing, or for other hosts; or the service or file cannot be read.
    """
    if connections < 1:
        raise InvalidInput(f"{connections} connections: must be 1 or more")
    if is_file(name):
        return _open_file(name, date)
    entry = entry_of(
        name, key=key, tile_px=tile_px, max_zoom=max_zoom, transport=transport, named_by_user=named_by_user
    )
    if entry.key_env and not plan_only:
        key = key or key_of_environment(name, named_by_user=named_by_user)
    return open_entry(
        entry,
        seed=seed,
        key=key,
        secret=secret,
        date=date,
        tile_px=tile_px,
        connections=connections,
        transport=transport,
        cache=cache,
        placeholders=placeholders,
        plan_only=plan_only,
    )


def open_entry(
    entry: CatalogueEntry,
    *,
    seed: int = 2024,
    key: str | None = None,
    secret: str | None = None,
    date: str | None = None,
    tile_px: int | None = None,
    connections: int = 8,
    transport: Transport | None = None,
    cache: TileCache | None = None,
    placeholders: Iterable[str] = (),
    plan_only: bool = False,
) -> Source:
    """Open the source that an entry describes; see `open_source`.

    Raises
    ------
    InvalidInput
        The date or tile size is unknown, or a placeholder is no SHA-256.
    SourceError
        A key is needed and missing.
    """
    chosen, key = entry.date(date), None if plan_only else entry.key(key)
    placeholder = entry.placeholder.with_files(placeholders)
    if entry.kind == "world":
        from .world import WorldSource

        return WorldSource(seed)
    if entry.key_env and not key and not plan_only:
        raise SourceError(f"{entry.title}: needs an API key: set the environment variable {entry.key_env}")
    if entry.kind == "static-map":
        from .staticmap import GOOGLE_URL, PLACEHOLDER, StaticMapSource

        return StaticMapSource(
            key or "",
            secret or (os.environ.get(entry.signing_env) if entry.signing_env else None),
            scale=entry.grid(tile_px).scale,
            name=entry.name,
            title=entry.title,
            attribution=entry.attribution,
            policy=entry.policy,
            placeholder=PLACEHOLDER.with_files(placeholder.sha256),
            url=os.environ.get("TERRAINAV_GOOGLE_URL", GOOGLE_URL),
            transport=transport,
            connections=connections,
        )
    from .xyz import XYZSource

    return XYZSource(
        entry.templates(chosen),
        name=entry.name,
        title=entry.title,
        attribution=entry.credit(chosen),
        grid=entry.grid(tile_px),
        key=key,
        date=chosen,
        placeholder=placeholder,
        policy=entry.policy,
        transport=transport,
        cache=cache,
        connections=connections,
    )


def entry_of(
    name: str,
    *,
    key: str | None = None,
    tile_px: int | None = None,
    max_zoom: int | None = None,
    transport: Transport | None = None,
    named_by_user: bool = False,
) -> CatalogueEntry:
    """Entry of a source's name, as `open_source` takes them; files have none.

    Raises
    ------
    InvalidInput, SourceError
        As `open_source` does.
    """
    if name.startswith(_QGIS):
        raise InvalidInput(
            f"source {name}: is a map of QGIS and can be captured inside QGIS only; name a file, a URL template or "
            "a name of the catalogue"
        )
    if is_file(name):
        raise InvalidInput(f"source {name}: a file states no terms; name one of the sources that have some")
    if _is_service(name):
        from .services.ogc import service_entry

        return service_entry(name, key=key, tile_px=tile_px, transport=transport, named_by_user=named_by_user)
    if not is_template(name):
        return entry_named(name)
    # A provider's terms hold however its tiles are asked for.
    data = described(name, tile_px=tile_px or 256, max_zoom=max_zoom)
    return under_provider(CatalogueEntry.from_dict(Template(name).text, data, user=True))


def key_of_environment(name: str, *, named_by_user: bool = False) -> str | None:
    """Return the key that the environment has for a source; None where there is none.

    Raises
    ------
    InvalidInput
        There is no such source.
    SourceError
        The environment's key is for other hosts.
    """
    if _is_service(name):
        from .services.capabilities import Service

        return environment_key([Service.named(name).host], named_by_user=named_by_user)
    if is_template(name):
        return environment_key(Template(name).hosts, named_by_user=named_by_user)
    # Whose key it is, the catalogue or the user's own file says.
    return entry_named(name).key(None)


def _open_file(name: str, date: str | None) -> Source:
    if Path(name).suffix.lower() != _MBTILES_ENDING:
        from .raster import open_raster

        return open_raster(name, date=date or "")
    if date:
        raise InvalidInput(f"date {date!r}: {name} has no dates to choose from")
    from .mbtiles import open_mbtiles

    return open_mbtiles(name)
