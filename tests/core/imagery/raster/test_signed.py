"""Rasters behind signed addresses: what the message advises opens them, and the signature is in no file or message."""

from __future__ import annotations

from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.errors import InvalidInput, SourceError  # noqa: E402
from terrainav.core.imagery.opening import SourceOptions, named_source, source_kind  # noqa: E402
from terrainav.core.imagery.raster import remote as remote_module  # noqa: E402

from tests.core.imagery.raster.test_remote import GEOTRANSFORM, OPTIONS, is_same  # noqa: E402
from tests.support import rasters  # noqa: E402
from tests.support.command import command  # noqa: E402
from tests.support.ranges import RangeServer  # noqa: E402

VALUES = np.random.default_rng(15).integers(0, 256, (3, 512, 512), np.uint8)
SIGNED = "X-Amz-Algorithm=AWS4-HMAC-SHA256&X-Amz-Credential=AKIAX%2F20210422%2Fp%2Fs3%2Faws4_request&X-Amz-Expires=3600"
TOKEN = "X-Amz-Security-Token=Fwo%2FGXIv%3D%3D&X-Amz-Signature=0a1b2c3d4e5f"

pytestmark = pytest.mark.usefixtures("library")


@pytest.fixture(autouse=True)
def _no_waits(monkeypatch):
    monkeypatch.setattr(remote_module, "FIRST_WAIT_S", 0.01)


@pytest.fixture
def server(tmp_path):
    path = rasters.write(tmp_path / "made.tif", VALUES, GEOTRANSFORM, 32616, options=OPTIONS)
    with RangeServer() as running:
        running.files["/a.tif"] = path.read_bytes(), '"one"'
        yield running


def opened(name, **options):
    return named_source(name, SourceOptions(named_by_user=True, **options)).open()


@pytest.mark.parametrize(
    ("query", "key", "sent"),
    [
        # As Azure's and Amazon's addresses have it, written as in an address or not; a key that is a name of its own.
        ("sv=2021&sig={key}", "ab%2Bc%2Fd%3D", {"sv": "2021", "sig": "ab+c/d="}),
        ("sv=2021&sig={key}", "ab+c/d=", {"sv": "2021", "sig": "ab+c/d="}),
        (
            f"{SIGNED}&X-Amz-Signature={{key}}",
            "0a1b2c",
            {"X-Amz-Expires": "3600", "X-Amz-Signature": "0a1b2c"},
        ),
        (
            "AWSAccessKeyId=AKIAX&Expires=1&Signature={key}",
            "a/b=",
            {"AWSAccessKeyId": "AKIAX", "Signature": "a/b="},
        ),
        (
            "v=3&{key}",
            f"?{TOKEN}",
            {"v": "3", "X-Amz-Security-Token": "Fwo/GXIv==", "X-Amz-Signature": "0a1b2c3d4e5f"},
        ),
    ],
)
@pytest.mark.parametrize("before", ["", "/vsicurl/"])
def test_the_remedy_of_the_message_opens_the_raster(query, key, sent, before, server, monkeypatch):
    monkeypatch.setenv("TERRAINAV_KEY", key)
    name = f"{before}{server.url}/a.tif?{query}"
    assert source_kind(name).name == "raster"
    source = opened(name)
    assert is_same(source, VALUES, 64, 64)
    source.close()
    assert len(server.asked) > 1
    for _, path, _ in server.asked:
        found = {name: values[0] for name, values in parse_qs(urlsplit(path).query).items()}
        assert {name: found.get(name) for name in sent} == sent
    assert source.name == name
    assert source.title == "a.tif"
    assert key not in repr(source)


def test_without_a_key_or_for_another_host_nothing_is_asked(server, monkeypatch):
    monkeypatch.delenv("TERRAINAV_KEY", raising=False)
    name = f"{server.url}/a.tif?sig={{key}}"
    named = named_source(name, SourceOptions())
    assert named.needs_key
    with pytest.raises(SourceError, match="needs an API key: set the environment variable TERRAINAV_KEY"):
        named.open()
    monkeypatch.setenv("TERRAINAV_KEY", "abc")
    with pytest.raises(SourceError, match="is not sent there, because a file names this host"):
        named_source(name, SourceOptions()).open()
    assert not server.asked
    monkeypatch.setenv("TERRAINAV_KEY_HOSTS", "127.0.0.1")
    named_source(name, SourceOptions()).open().close()
    with pytest.raises(InvalidInput, match=r"holds a key in 'sig'.*write sig=\{key\} and set TERRAINAV_KEY"):
        opened(f"{server.url}/a.tif?sig=abc")
    # Whose signature it is may stand there only where the signature does not.
    with pytest.raises(InvalidInput, match="holds a key in 'X-Amz-Credential'"):
        opened(f"{server.url}/a.tif?{SIGNED}")
    with pytest.raises(InvalidInput, match="holds a key in 'X-Amz-Security-Token'"):
        opened(f"{server.url}/a.tif?{SIGNED}&X-Amz-Security-Token=x&X-Amz-Signature={{key}}")


def test_a_server_that_answers_no_heads_is_asked_for_none(server, monkeypatch):
    server.answers_heads = False
    source = opened(f"{server.url}/a.tif")
    asked = len(server.asked)
    assert is_same(source, VALUES, 64, 64)
    source.close()
    # Each request for a head would have cost one more.
    assert all(method == "GET" for method, _, _ in server.asked[asked:])
    monkeypatch.setenv("TERRAINAV_KEY", "abc")
    source = opened(f"{server.url}/a.tif?sig={{key}}")
    assert is_same(source, VALUES, 300, 100)
    source.close()


@pytest.mark.parametrize("fault", ["gone", "broken", "refused"])
def test_no_message_has_the_signature(fault, server, monkeypatch):
    monkeypatch.setenv("TERRAINAV_KEY", "tops3cret")
    name = f"{server.url}/a.tif?sig={{key}}"
    if fault == "gone":
        server.files.clear()
    elif fault == "broken":
        server.files["/a.tif"] = b"II*\0" + b"\xff" * 4000, '"one"'
    else:
        server.faults = [403] * 20
    with pytest.raises((InvalidInput, SourceError)) as caught:
        opened(name)
    shown, wrong = [], caught.value
    while wrong is not None:
        shown.append(f"{wrong!r} {wrong}")
        wrong = wrong.__cause__ or (None if wrong.__suppress_context__ else wrong.__context__)
    assert "tops3cret" not in " ".join(shown)


def test_a_capture_writes_the_signature_nowhere(server, tmp_path, monkeypatch, capsys):
    run = command(tmp_path, monkeypatch, capsys)
    monkeypatch.setenv("TERRAINAV_KEY", "tops3cret")
    import pyproj

    lon, lat = pyproj.Transformer.from_crs(32616, 4326, always_xy=True).transform(500_128.0, 3_999_872.0)
    done = run(
        *("capture", "--coords", f"{lat}_{lon}_40", "--source", f"{server.url}/a.tif?sig={{key}}"),
        *("--data-dir", "out"),
    )
    assert done.returncode == 0, done.stderr
    assert "tops3cret" not in done.stdout + done.stderr
    files = [path for path in (tmp_path / "out").rglob("*") if path.is_file()]
    assert any(path.suffix == ".tif" for path in files)
    for path in files:
        assert b"tops3cret" not in path.read_bytes()
    assert any(b"sig={key}" in path.read_bytes() for path in files)
