"""The cache of tiles on the command line."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..text import printable
from .exits import DONE

if TYPE_CHECKING:
    from ..imagery.cache.tile_cache import TileCache

_MB = 1_000_000


def opened_cache(values: dict[str, Any]) -> TileCache | None:
    """Cache that the options of a run ask for; None for none."""
    limit_mb = values["cache_limit"]
    if limit_mb is not None and limit_mb < 1:
        raise InvalidInput("cache limit {0} MB: must be 1 or more; --no-cache keeps nothing", limit_mb)
    if values["no_cache"]:
        return None
    _check_folder(values["cache_dir"])
    from ..imagery.cache.tile_cache import LIMIT_BYTES, TileCache

    return TileCache(values["cache_dir"], LIMIT_BYTES if limit_mb is None else limit_mb * _MB)


def _check_folder(folder: str | None) -> None:
    # As from a variable that is not set: the current folder, which it would stand for, is not meant.
    if folder == "":
        raise InvalidInput("cache folder '': must be the name of a folder, or left out for the usual one")


def run_cache(arguments: argparse.Namespace) -> int:
    """List or clear the cache."""
    _check_folder(arguments.cache_dir)
    from ..imagery.cache.tile_cache import TileCache
    from ..mission.estimate import size_text

    cache = TileCache(arguments.cache_dir)
    if arguments.action == "clear":
        freed = cache.clear(arguments.names or None)
        if arguments.json:
            print(json.dumps({"folder": str(cache.folder), "freed_bytes": freed}, indent=1))
        else:
            print(f"{size_text(freed)} freed in {cache.folder}")
        return DONE
    files = cache.list()
    if arguments.json:
        rows = [{**vars(file), "path": str(file.path)} for file in files]
        print(json.dumps({"folder": str(cache.folder), "files": rows}, indent=1))
        return DONE
    for file in files:
        what = ", ".join(filter(None, (file.title, file.map_type, file.date)))
        print(
            printable(
                f"{file.source:22s}{what}: {file.tiles:,} tiles of {file.tile_px} px, {size_text(file.bytes)}"
            )
        )
        print(f"{'':22s}{file.path.name}")
    total = sum(file.bytes for file in files)
    print(f"{len(files)} files, {size_text(total)} in {cache.folder} (limit {size_text(cache.limit_bytes)})")
    return DONE
