"""What refusals of files and servers of others advise."""

from __future__ import annotations

import importlib
import sqlite3
import warnings
from contextlib import closing

import numpy as np
import pytest
from terrainav.core.errors import PartError
from terrainav.core.imagery import decode as decoding
from terrainav.core.imagery import mbtiles
from terrainav.core.imagery.http import client as clients
from terrainav.core.imagery.http.transport import Response, TransportError
from terrainav.core.imagery.mbtiles import open_mbtiles
from terrainav.core.imagery.source import Window
from terrainav.core.limits import MAX_LATE_PARTS

from tests.core.remedies.imagery import TEMPLATE, one_layer, opened, raster, read
from tests.support.patterns import positions, to_bytes
from tests.support.remedies import Case, remedy
from tests.support.services import ServiceServer, wms_document


class Late:
    """A transport whose server keeps everybody waiting until it is in time again."""

    def __init__(self):
        self.late = True

    def get(self, url, headers=None, cancelled=None):
        if self.late:
            raise TransportError("no whole answer within 60 s", late=True)
        return Response(200, {}, b"here")

    def close(self):
        """Hold nothing."""


@remedy("imagery/http/client.py", "{}: not requested, as the last {} requests had no answer in time; resume later")
def _kept_waiting(case: Case) -> None:
    server = Late()
    asked = clients.Client(server, "P", tries=1)
    for _ in range(MAX_LATE_PARTS):
        with pytest.raises(PartError):
            asked.get("u", "w")
    case.refused(lambda: asked.get("u", "w"))
    server.late = False
    # A client of its own, as a run that is resumed has.
    case.follow("resume later", lambda: clients.Client(server, "P").get("u", "w").body == b"here")


@remedy(
    "imagery/decode.py",
    "a WebP image, which libwebp {} would not read safely: install Pillow 10.0.1 or later",
)
def _old_libwebp(case: Case) -> None:
    picture = np.full((8, 8, 3), 90, np.uint8)
    body = to_bytes(picture, "webp")

    def decoded(libwebp):
        with case.monkeypatch.context() as pillow:
            pillow.setattr(decoding.features, "version", lambda _name: libwebp)
            pillow.setattr(decoding, "_brings_libraries", lambda: True)
            decoding.webp_problem.cache_clear()
            try:
                decoding.decode(body, 8, 8)
            finally:
                decoding.webp_problem.cache_clear()

    case.refused(lambda: decoded("1.3.1"))
    # What the wheels of Pillow 10.0.1 bring.
    case.follow("install Pillow 10.0.1 or later", lambda: decoded("1.3.2"))


@remedy(
    "imagery/tiles.py",
    "{}: {} is not sent there, because a file names this host and not you; set {}={} if the key is for it",
)
def _host_of_a_file(case: Case) -> None:
    case.monkeypatch.setenv("TERRAINAV_KEY", "s3cret")
    case.monkeypatch.delenv("TERRAINAV_KEY_HOSTS", raising=False)
    case.refused(lambda: opened(TEMPLATE + "?k={key}"))
    case.monkeypatch.setenv("TERRAINAV_KEY_HOSTS", "h.example")
    case.follow("set TERRAINAV_KEY_HOSTS=h.example if the key is for it", lambda: opened(TEMPLATE + "?k={key}"))


@remedy(
    "imagery/mbtiles.py",
    "{}: takes more than {} s to look a tile up; give the file an index: CREATE UNIQUE INDEX tile_index ON tiles "
    "(zoom_level, tile_column, tile_row)",
)
def _no_index(case: Case) -> None:
    path = case.tmp_path / "own.mbtiles"
    tile = to_bytes(positions("", 10, 0, 0, 256), "png")

    def execute(*statements):
        with closing(sqlite3.connect(path)) as database:
            for one in statements:
                database.execute(*one)
            database.commit()

    execute(
        ("CREATE TABLE metadata (name text, value text)",),
        ("INSERT INTO metadata VALUES ('minzoom', '10'), ('maxzoom', '10')",),
        ("CREATE TABLE tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)",),
        (
            (
                "INSERT INTO tiles WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n LIMIT 20480) "
                "SELECT 10, i % 1024, i / 1024, CASE WHEN i IN (0, 20479) THEN ? ELSE x'00' END FROM n"
            ),
            (tile,),
        ),
    )
    # With an index nobody looks at the clock: it takes fewer steps than are done between two looks.
    case.monkeypatch.setattr(mbtiles, "MAX_QUERY_S", 0.0)

    def looked_up():
        with closing(open_mbtiles(path)) as source:
            source.fetch("", Window(10, 1023 * 256, (1023 - 19) * 256, 256, 256))

    case.refused(looked_up)
    index = "CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row)"
    case.follow(
        f"give the file an index: {index}",
        lambda: (execute((index,)), looked_up()),
    )


@remedy("imagery/raster/trust.py", "{} reads {}, which is not beside it; set {}={} if that is right")
def _not_beside(case: Case) -> None:
    from osgeo import gdal

    case.monkeypatch.delenv("TERRAINAV_RASTER_FOLDERS", raising=False)
    (case.tmp_path / "far").mkdir()
    (case.tmp_path / "near").mkdir()
    path = case.tmp_path / "near" / "map.vrt"
    far = raster(case, "far/own.tif")
    gdal.BuildVRT(str(path), [str(far)]).FlushCache()
    case.refused(lambda: read(path))
    case.monkeypatch.setenv("TERRAINAV_RASTER_FOLDERS", str(far.parent))
    case.follow(f"set TERRAINAV_RASTER_FOLDERS={far.parent} if that is right", lambda: read(path))


@remedy(
    "imagery/raster/trust.py",
    "{} describes a service or a collection, whose requests keep to no terms; name the service itself: wms:URL, "
    "wmts:URL or a URL template",
)
def _described(case: Case) -> None:
    path = case.tmp_path / "service.xml"
    path.write_text('<GDAL_WMS><Service name="TMS"/></GDAL_WMS>', encoding="utf-8")
    case.refused(lambda: read(path))
    with warnings.catch_warnings():
        # OWSLib imports a module that Python is going to drop; that is for it to change.
        warnings.simplefilter("ignore", DeprecationWarning)
        importlib.import_module("owslib.wms")
    layer = "<Layer><Name>ortho</Name><Title>Ortho</Title><CRS>EPSG:3857</CRS></Layer>"
    with one_layer() as wmts, ServiceServer() as wms:
        wms.answer = lambda *_: (200, "text/xml", wms_document("1.3.0", wms.url, layer))
        case.follow("name the service itself: wms:URL", lambda: opened(f"wms:{wms.url}/c.xml"))
        case.follow("wmts:URL", lambda: opened(f"wmts:{wmts.url}/c.xml"))
    case.follow("a URL template", lambda: opened(TEMPLATE))
