"""Raster files over real HTTP on the loopback: the manners of requests, and files that change while they are read."""

from __future__ import annotations

import io
import threading
import zipfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import InvalidInput, PartError, SourceError  # noqa: E402
from terrainav.core.imagery.http.transport import user_agent  # noqa: E402
from terrainav.core.imagery.opening import SourceOptions, named_source, open_source  # noqa: E402
from terrainav.core.imagery.raster import remote as remote_module  # noqa: E402
from terrainav.core.imagery.raster.source import open_raster  # noqa: E402
from terrainav.core.imagery.source import Window  # noqa: E402

from tests.support import rasters  # noqa: E402
from tests.support.command import command  # noqa: E402
from tests.support.ranges import RangeServer  # noqa: E402

SIDE, BLOCK = 1024, 128
GEOTRANSFORM = (500_000.0, 0.5, 0.0, 4_000_000.0, 0.0, -0.5)
OPTIONS = ("TILED=YES", f"BLOCKXSIZE={BLOCK}", f"BLOCKYSIZE={BLOCK}")
ETAG = '"v1:a/b"'
# Windows of a block and more, far enough apart that none is in what was read ahead for another.
WINDOWS = [(64, 64), (700, 130), (300, 500), (800, 800), (100, 860)]

pytestmark = pytest.mark.usefixtures("library")


@pytest.fixture(autouse=True)
def _no_waits(monkeypatch):
    monkeypatch.setattr(remote_module, "FIRST_WAIT_S", 0.01)


@pytest.fixture
def server():
    with RangeServer() as running:
        yield running


@pytest.fixture(scope="module")
def values():
    return np.random.default_rng(15).integers(0, 256, (3, SIDE, SIDE), np.uint8)


@pytest.fixture(scope="module", params=["DEFLATE", pytest.param("NONE", marks=pytest.mark.thorough)])
def body(request, values, tmp_path_factory):
    path = tmp_path_factory.mktemp("remote") / "ortho.tif"
    options = (*OPTIONS, f"COMPRESS={request.param}")
    return rasters.write(path, values, GEOTRANSFORM, 32616, options=options).read_bytes()


@pytest.fixture
def url(server, body):
    server.files["/maps/ortho.tif"] = body, ETAG
    return f"{server.url}/maps/ortho.tif"


def window(source, left, top, side=150):
    return Window(source.grid.native_zoom, left, top, side, side)


def is_same(source, values, left, top, side=150):
    fetched = source.fetch("", window(source, left, top, side))
    return np.array_equal(fetched, values[:, top : top + side, left : left + side].transpose(1, 2, 0))


@pytest.mark.parametrize("form", ["{0}", "/vsicurl/{0}", "/vsicurl?max_retry=1&url={0}"])
def test_pixels_are_the_files_and_requests_keep_to_our_manners(server, url, values, body, form):
    name = form.format(url)
    source = open_raster(name)
    assert (source.name, source.title) == (name, "ortho.tif")
    assert all(is_same(source, values, *place) for place in WINDOWS[:2])
    source.close()
    assert {path for _, path, _ in server.asked} == {"/maps/ortho.tif"}  # nothing beside it, and no folder
    assert {headers["User-Agent"] for _, _, headers in server.asked} == {user_agent()}
    gets = [headers for method, _, headers in server.asked if method == "GET"]
    assert gets[0]["Range"] == "bytes=0-0"
    assert all("Range" in headers for headers in gets)
    assert {headers["If-Match"] for headers in gets[1:]} == {ETAG}
    assert server.sent_bytes < len(body) / 2


def test_an_address_is_a_source_by_name_and_not_on_this_machine(url, values):
    named = named_source(url, SourceOptions(crs="EPSG:32616"))
    assert (named.is_local, named.title) == (False, "ortho.tif")
    source = named.open()
    assert source.name == url
    assert is_same(source, values, 5, 6)
    with pytest.raises(InvalidInput, match="holds a key in 'token'"):
        open_source(f"{url}?token=word")


@pytest.mark.thorough
def test_a_busy_server_is_asked_again(server, url, values):
    server.faults = [503, 0, 429]
    source = open_raster(url)
    server.faults = [503, 502]
    assert is_same(source, values, 300, 500)
    server.faults = [503] * 50
    with pytest.raises(PartError) as raised:
        source.fetch("", window(source, 800, 800))
    assert "\n" not in str(raised.value)
    server.faults = []
    assert is_same(source, values, 100, 100)


@pytest.mark.parametrize("keeps_conditions", [True, False])
@pytest.mark.parametrize("names_versions", [True, False])
def test_a_file_that_changes_is_no_more_read(server, url, values, body, keeps_conditions, names_versions, monkeypatch):
    # Servers that heed no condition are asked for the version now and then: here, each time.
    monkeypatch.setattr(remote_module, "_SAME_FOR_S", 60.0 if keeps_conditions and names_versions else 0.0)
    server.keeps_conditions, server.names_versions = keeps_conditions, names_versions
    source = open_raster(url)
    assert is_same(source, values, 64, 64)
    server.files["/maps/ortho.tif"] = body[::-1] + b"more", '"v2"'
    with pytest.raises(SourceError, match=r"^ortho.tif: has changed since it was opened; start anew$"):
        source.fetch("", window(source, 800, 800))
    # Opened anew it is the file that is there then, whatever GDAL has kept of the one before.
    server.files["/maps/ortho.tif"] = body, '"v3"'
    assert is_same(open_raster(url), values, 800, 800)


def test_a_file_that_vanishes_says_so(server, url):
    source = open_raster(url)
    del server.files["/maps/ortho.tif"]
    with pytest.raises(SourceError, match=r"^ortho.tif: is gone$"):
        source.fetch("", window(source, 800, 800))
    with pytest.raises(InvalidInput, match=r"^ortho.tif: 404 Not Found"):
        open_raster(url)


def test_answers_that_are_cut_give_no_pixels(server, url):
    source = open_raster(url)
    server.cuts_at = 9000
    with pytest.raises(PartError, match=r"^ortho.tif: cannot be read here: ") as raised:
        source.fetch("", window(source, 700, 700))
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("length", [None, 2000])
def test_a_server_that_sends_whole_files_only_is_not_asked_for_one(server, url, body, length):
    server.files["/maps/ortho.tif"] = body[:length], ETAG
    server.sends_parts = False
    with pytest.raises(InvalidInput, match="sends whole files only") as raised:
        open_raster(url)
    assert "; name a copy of it on this machine" in str(raised.value)
    assert [method for method, _, _ in server.asked] == ["GET"]


def test_redirects_lead_to_http_alone(server, url, values):
    server.redirects = {"/to.tif": url, "/away.tif": "ftp://h.example/x.tif", "/round.tif": "/round.tif"}
    assert is_same(open_raster(f"{server.url}/to.tif"), values, 64, 64)
    for name, words in (("away", "neither http nor https"), ("round", "more than 5 redirects")):
        with pytest.raises(SourceError, match=words):
            open_raster(f"{server.url}/{name}.tif")


def test_what_is_no_raster_is_named_as_the_user_did(server):
    server.files["/x.tif"] = b"hello" * 1000, '"x"'
    with pytest.raises(InvalidInput, match="is not a readable raster") as raised:
        open_raster(f"{server.url}/x.tif")
    assert "#" not in str(raised.value)


@pytest.mark.parametrize("form", ["/vsizip//vsicurl/{0}/in/ortho.tif", "/vsizip/{{/vsicurl/{0}}}/in/ortho.tif"])
def test_a_raster_in_an_archive_over_http(server, body, values, form):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("in/ortho.tif", body)
    server.files["/a.zip"] = packed.getvalue(), '"z"'
    source = open_raster(form.format(f"{server.url}/a.zip"))
    assert is_same(source, values, 700, 130)
    assert {path for _, path, _ in server.asked} == {"/a.zip"}
    assert {headers["User-Agent"] for _, _, headers in server.asked} == {user_agent()}
    server.files["/a.zip"] = packed.getvalue()[:-1] + b"x", '"y"'
    with pytest.raises(SourceError, match="has changed"):
        source.fetch("", window(source, 300, 700))


def test_no_more_requests_at_once_than_threads(server, url, values):
    server.latency_s = 0.02
    source = open_raster(url)
    with ThreadPoolExecutor(3) as threads:
        assert all(threads.map(lambda place: is_same(source, values, *place), WINDOWS))
    assert server.most_under_way <= 3


def test_a_user_who_has_gdal_send_credentials_is_left_to_gdal(server, url, values, monkeypatch):
    monkeypatch.setenv("GDAL_HTTP_HEADERS", "Authorization: Bearer word")
    assert is_same(open_raster(url), values, 64, 64)
    assert "bytes=0-0" not in {headers.get("Range") for _, _, headers in server.asked}


def test_closing_ends_the_wait_for_a_server(server, url):
    source = open_raster(url)
    threading.Timer(0.2, source.close).start()
    source._pool.remote._asked_s = -1e9
    server.latency_s = 60.0
    with pytest.raises(Exception, match="cancelled"):
        source.fetch("", window(source, 64, 64))
    assert server.under_way


def test_a_capture_names_the_source_as_the_user_did_and_leaves_nothing_half_written(
    server, url, tmp_path, monkeypatch, capsys
):
    run = command(tmp_path, monkeypatch, capsys)
    capture = [
        "capture",
        "--source",
        url,
        "--connections",
        "2",
        "--coords",
        "36.1435_-86.9998_36.1422_-86.9973_60",
    ]
    planned = run("plan", *capture[1:])
    assert planned.returncode == 0, planned.stderr
    assert "terms" in planned.stdout
    done = run(*capture, "--data-dir", "one")
    assert done.returncode == 0, done.stderr
    assert url in (tmp_path / "one/mission.json").read_text()
    whole = {path.name: path.read_bytes() for path in (tmp_path / "one").rglob("*.tif")}
    assert len(whole) > 4
    # The file changes after the first requests for pixels.
    body, _ = server.files["/maps/ortho.tif"]
    server.when = len(server.asked) + 8, lambda: server.files.update({"/maps/ortho.tif": (body, '"v2"')})
    failed = run(*capture, "--data-dir", "two")
    assert failed.returncode != 0
    assert "ortho.tif: has changed since it was opened" in failed.stderr
    assert "Traceback" not in failed.stderr
    written = {path.name: path.read_bytes() for path in (tmp_path / "two").rglob("*.tif*")}
    assert written.items() <= whole.items()
