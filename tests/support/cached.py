"""Sources with a cache, of servers on the loopback."""

from __future__ import annotations

from terrainav.core.imagery.http.client import Client
from terrainav.core.imagery.http.requests_transport import RequestsTransport
from terrainav.core.imagery.http.transport import Timeouts
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.xyz import XYZSource

ZOOM = 9


def tile(x, y=0, tile_px=256):
    """Window of a tile of zoom 9."""
    return Window(ZOOM, x * tile_px, y * tile_px, tile_px, tile_px)


def source_of(template, cache, *, tries=2, key=None, **options):
    """Source that waits only briefly before it tries again."""
    client = Client(
        RequestsTransport(4, Timeouts(connect_s=5.0, read_s=5.0, whole_s=10.0)),
        "The provider",
        connections=4,
        tries=tries,
        first_wait_s=0.001,
        secrets=(key,) if key else (),
    )
    return XYZSource(template, client=client, cache=cache, key=key, **options)


class Clock:
    """A clock that is set by hand."""

    def __init__(self, now_s):
        self.now_s = now_s

    def __call__(self):
        return self.now_s
