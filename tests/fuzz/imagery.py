"""What servers answer and files of imagery hold: pictures, headers, capabilities, MBTiles, VRTs."""

from __future__ import annotations

import importlib.util
import sqlite3
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from terrainav.core.imagery.decode import decode
from terrainav.core.imagery.http.client import Client, joined, redirect_target
from terrainav.core.imagery.http.transport import Response, check_length, freshness, unpacked
from terrainav.core.imagery.mbtiles import open_mbtiles
from terrainav.core.imagery.opening import SourceOptions, named_source
from terrainav.core.imagery.raster.trust import allowed_drivers
from terrainav.core.imagery.source import Window
from terrainav.core.limits import MAX_LINE_CHARACTERS
from terrainav.core.text.plain import one_line, table_cell
from terrainav.core.text.secrets import Secrets

from tests.fuzz.support import Target, any_of, mutated
from tests.support.patterns import positions, to_bytes
from tests.support.services import matrix, matrix_set, wms_document, wmts_document, wmts_layer

SIZE_PX = 64
PICTURE = np.ascontiguousarray(positions("", 6, 20, 30, 256)[:SIZE_PX, :SIZE_PX])
PICTURES = (
    *(to_bytes(PICTURE, kind) for kind in ("png", "jpg", "webp", "gif")),
    to_bytes(PICTURE, "jpg", progressive=True),
)
KEY = "s3cret/key+1"
HEADERS = {
    "content-length": "5",
    "content-encoding": "gzip",
    "content-type": "image/png; charset=utf-8",
    "cache-control": 'public, max-age=600, s-maxage="9", no-cache="a,b"',
    "expires": "Thu, 01 Dec 2026 16:00:00 GMT",
    "date": "Sun, 22 Nov 2026 16:00:00 GMT",
    "age": "3",
    "vary": "accept",
    "etag": '"abc"',
    "last-modified": "Sun, 22 Nov 2026 15:00:00 GMT",
    "retry-after": "1",
    "location": "https://h.example/a/b.png?c=d",
}
TILE = to_bytes(positions("", 6, 20, 30, 256), "png")
PLACE = (6, 0, 63)
STATUSES = (200, 204, 301, 302, 304, 400, 401, 403, 404, 429, 500, 503, 599, 999)
QUAD = matrix_set("quad", [matrix(str(zoom), zoom) for zoom in range(5)])
WMTS = wmts_document(
    [wmts_layer("ortho", {"quad": []}, resources=[("image/png", "/{TileMatrix}/{TileCol}/{TileRow}")])],
    [QUAD],
)
WMS = tuple(
    wms_document(version, "https://h.example/?", f"<Layer><Title>All</Title><{crs}>{name}</{crs}>{inner}</Layer>")
    for version, crs, name in (("1.3.0", "CRS", "EPSG:3857"), ("1.1.1", "SRS", "EPSG:900913"))
    for inner in ("<Layer><Name>ortho</Name><Title>O</Title></Layer>",)
)
METADATA = {
    "name": "mine",
    "format": "png",
    "minzoom": "6",
    "maxzoom": "6",
    "bounds": "-180,-85,180,85",
    "scheme": "tms",
}
VRT = """<VRTDataset rasterXSize="8" rasterYSize="8"><SRS>EPSG:3857</SRS><VRTRasterBand dataType="Byte" band="1">
<SimpleSource><SourceFilename relativeToVRT="1">own.tif</SourceFilename><SourceBand>1</SourceBand></SimpleSource>
</VRTRasterBand></VRTDataset>"""


def service_entry(name, **options):
    """Entry of a layer, from the capabilities of its service."""
    return named_source(name, SourceOptions(**options)).entry


def layers(name, **options):
    """Layers that a service offers."""
    return named_source(name, SourceOptions(**options)).layers()


class _Answer:
    """A transport with one answer, whatever is asked."""

    def __init__(self, response: Response) -> None:
        self._response = response

    def get(self, *_: Any, **__: Any) -> Response:
        return self._response

    def close(self) -> None:
        """Nothing is held."""


def picture(body: bytes) -> None:
    pixels = decode(body, SIZE_PX, SIZE_PX)
    assert pixels.shape[:2] == (SIZE_PX, SIZE_PX)


def answer(given: tuple[int, dict[str, str], bytes]) -> None:
    """All that is made of an answer, whose text and headers may be anything."""
    status, headers, body = given
    response = Response(status, headers, body)
    freshness(headers, time.time())
    client = Client(_Answer(response), "P", secrets=(KEY,), tries=1, longest_retry_after_s=0.5)
    said = client.message(response)
    assert said.isprintable()
    assert KEY not in said

    def target() -> None:
        found = redirect_target(response)
        if found:
            joined("https://h.example/", found)

    any_of(
        (
            target,
            lambda: check_length(len(body), headers),
            lambda: unpacked(body, headers, 1 << 20),
            lambda: client.get("https://h.example/", "tile"),
        )
    )


def words(data: bytes) -> None:
    text = data.decode("utf-8", "replace")
    line = one_line(text)
    assert line.isprintable()
    assert len(line) <= MAX_LINE_CHARACTERS
    assert not table_cell(text).startswith(("=", "+", "-", "@"))
    secrets = Secrets([KEY])
    assert KEY not in secrets.masked(f"{text}{KEY}{text}")


def capabilities(body: bytes) -> None:
    transport = _Answer(Response(200, {"content-type": "text/xml"}, body))

    def of(kind: str) -> None:
        name = f"{kind}:https://h.example/c.xml?k={{key}}"
        layers(name, key=KEY, transport=transport)
        assert KEY not in str(service_entry(name, key=KEY, transport=transport).to_dict())

    any_of((lambda: of("wmts"), lambda: of("wms")))


def mbtiles(given: tuple[dict[str, Any], Any, tuple[Any, ...]]) -> None:
    path = Path("own.mbtiles")
    path.unlink(missing_ok=True)
    _write_mbtiles(path, *given)
    _read_mbtiles(path)


def _write_mbtiles(path: Path, metadata: dict[str, Any], body: Any, place: tuple[Any, ...]) -> None:
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE metadata (name, value)")
        database.execute("CREATE TABLE tiles (zoom_level, tile_column, tile_row, tile_data)")
        database.executemany("INSERT INTO metadata VALUES (?, ?)", metadata.items())
        database.execute("INSERT INTO tiles VALUES (?, ?, ?, ?)", (*place, body))
        database.commit()


def mbtiles_file(data: bytes) -> None:
    path = Path("own.mbtiles")
    path.write_bytes(data)
    _read_mbtiles(path)


def _read_mbtiles(path: Path) -> None:
    with closing(open_mbtiles(path)) as source:
        assert source.title.isprintable()
        assert source.attribution.isprintable()
        zoom = source.grid.native_zoom if source.grid.native_zoom is not None else source.grid.min_zoom
        size = source.grid.tile_px
        source.fetch("", Window(zoom, 0, 0, size, size))


def vrt(data: bytes) -> None:
    Path("map.vrt").write_bytes(data)
    allowed_drivers("map.vrt")


def _file_of_mbtiles() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "own.mbtiles"
        _write_mbtiles(path, METADATA, TILE, PLACE)
        return path.read_bytes()


def targets() -> Iterator[Target]:
    with warnings.catch_warnings():
        # OWSLib imports a module that Python is going to drop; that is for it to change.
        warnings.simplefilter("ignore", DeprecationWarning)
        has_owslib = importlib.util.find_spec("owslib") is not None
        for name in ("wms", "wmts") if has_owslib else ():
            importlib.import_module(f"owslib.{name}")
    texts = mutated(*HEADERS.values(), KEY, "²", "9" * 400).map(lambda data: data.decode("latin-1"))
    headers = st.dictionaries(st.sampled_from(sorted(HEADERS)), texts, max_size=5)
    bodies = mutated('{"message": "no"}', "<html><title>No</title>", KEY, "[" * 8000) | st.binary(max_size=50)
    head = PICTURES[1].partition(b"\xff\xda")[0]
    yield Target(
        "picture",
        picture,
        mutated(*PICTURES),
        (head + b"\xff\xda\x00\x02" + b"\xff" * 60_000, head + b"\xff\xda\x00\x02" * 100_000),
    )
    yield Target(
        "answer",
        answer,
        st.tuples(st.sampled_from(STATUSES), headers, bodies),
        (
            (503, {"retry-after": "²"}, b""),
            (200, {"cache-control": "max-age=²", "content-length": "²"}, b""),
            (500, {"content-type": "application/json"}, b"[" * 8000),
        ),
    )
    yield Target("words", words, mutated("<b>&copy; A</b>", f"{KEY}…", "=1"), (b"<" * 1_000_000, b"%25" * 300_000))
    if has_owslib:
        type_of = b'<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/hostname">]>'
        yield Target("capabilities", capabilities, mutated(WMTS, *WMS), (b"<WMS_Capabilities" * 60_000, type_of + WMTS))
    values = st.none() | st.integers(-(2**63), 2**63 - 1) | st.floats() | mutated(*METADATA.values())
    metadata = st.dictionaries(st.sampled_from(sorted(METADATA)), values).map(lambda some: {**METADATA, **some})
    number = st.sampled_from((0, 6, 63, -1, 2**62, 1e300, "6", None, b"6"))
    blobs = st.just(TILE) | mutated(TILE, *PICTURES) | values
    yield Target("MBTiles", mbtiles, st.tuples(metadata, blobs, st.just(PLACE) | st.tuples(number, number, number)))
    yield Target("file of MBTiles", mbtiles_file, mutated(_file_of_mbtiles()))
    yield Target("VRT", vrt, mutated(VRT), (b"<VRTDataset>" * 50_000,))
