"""A tile request is short to follow: the modules of imagery that one enters."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from terrainav.core import imagery
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.placeholder import Placeholder

from tests.support.cached import source_of, tile
from tests.support.caching import CachingTileServer

MOST_FILES = 7
FOLDER = Path(imagery.__file__).parent
MARKS = Placeholder(("0" * 64,), (("x-nothing", "here"),), ((1, 2, 3),))


def entered(source, window):
    """Modules of imagery that a fetch enters; in the calling thread, as the writer of the cache has its own time."""
    files = set()

    def note(frame, event, _):
        if event == "call" and FOLDER in Path(frame.f_code.co_filename).parents:
            files.add(str(Path(frame.f_code.co_filename).relative_to(FOLDER)))

    sys.setprofile(note)
    try:
        source.fetch("", window)
    finally:
        sys.setprofile(None)
    return files


@pytest.mark.parametrize(
    ("lifetime_s", "statuses"), [(3600, {200: 2}), (0, {200: 2, 304: 2})], ids=["fresh", "confirmed"]
)
def test_a_tile_request_passes_few_files(tmp_path, lifetime_s, statuses):
    with CachingTileServer(headers={"Cache-Control": f"max-age={lifetime_s}"}, etag=True) as server:
        for reached in ({"http/client.py"}, set() if lifetime_s else {"http/client.py"}):
            source = source_of(server.url_template, TileCache(tmp_path), placeholder=MARKS)
            # Opens the connection and the cache's file.
            source.fetch("", tile(0))
            files = entered(source, tile(1))
            source.close()
            assert len(files) <= MOST_FILES, sorted(files)
            assert {"xyz.py", "tiles.py", "decode.py", "cache/tilestore.py", *reached} <= files
        assert server.statuses == statuses
