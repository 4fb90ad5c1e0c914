"""Terms of providers: they hold for whoever asks their hosts, however the address is written."""

from __future__ import annotations

import json
from urllib.parse import quote

import numpy as np
import pytest
from terrainav.core.imagery import entry
from terrainav.core.imagery.catalogue import shared_requests
from terrainav.core.imagery.entry import find_providers, shipped_entry
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import named_source
from terrainav.core.imagery.policy import TermsError
from terrainav.core.imagery.raster.remote import Remote
from terrainav.core.imagery.raster.source import open_raster
from terrainav.core.imagery.source import Window

from tests.support import rasters
from tests.support.command import command
from tests.support.growth import PROPORTIONAL, growth
from tests.support.ranges import RangeServer

run = pytest.fixture(command, name="run")

OSM = "https://tile.openstreetmap.org/{z}/{x}/{y}.png"


def encoded(text, times):
    for _ in range(times):
        text = quote(text, safe="")
    return text


@pytest.mark.parametrize(
    "text",
    [
        OSM,
        OSM.replace("tile", "TILE").upper(),
        "http://a:b@tile.openstreetmap.org:8080/1/0/0.png",
        "https://user@host:secret@tile.openstreetmap.org/1.png",
        "https://tile.openstreetmap.org./1.png",
        "https://tile%2Eopenstreetmap%2Eorg/1.png",
        "https://tile。openstreetmap。org/1.png",
        "https://ｔｉｌｅ.openstreetmap.org/1.png",
        "https:///tile.openstreetmap.org/1.png",
        "https:\\\\tile.openstreetmap.org\\1.png",
        "https://[a-c].tile.openstreetmap.org/1.png",
        "https://${switch:a,b,c}.tile.openstreetmap.org/1.png",
        "/vsicurl/https://tile.openstreetmap.org/1.png",
        "/vsicurl?use_head=no&url=https%3A%2F%2Ftile.openstreetmap.org%2F1.png",
        f"crs=EPSG:3857&type=xyz&url={encoded(OSM, 1)}&zmax=19",
        f"?formula=x&a:uri={encoded(f'type=xyz&url={encoded(OSM, 1)}', 1)}",
        "<GDAL_WMS><ServerUrl>https&#58;//tile.openstreetmap.org/${z}</ServerUrl></GDAL_WMS>",
        "<x>&lt;ServerUrl&gt;https://tile.openstreetmap.org/${z}&lt;/ServerUrl&gt;</x>",
        '{"links": {"href": "https://tile.openstreetmap.org/{z}/{x}/{y}.png"}}',
        "url='https://tile.openstreetmap.org' referer=''",
    ],
)
def test_an_address_is_of_its_provider_in_every_spelling(text):
    assert [one.name for one in find_providers(text)] == ["osm"]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "https://tiles.example/tile.openstreetmap.org/1.png",
        "https://tile.openstreetmap.org.example/1.png",
        "https://nottile.openstreetmap.org/1.png",
        "https://tile.openstreetmap.org@tiles.example/1.png",
        "https://tiles.example/?from=tile.openstreetmap.org",
        "/home/me/tile.openstreetmap.org/1.png",
        "C:/tile.openstreetmap.org/1.png",
        "https://www.openstreetmap.org/copyright",
    ],
)
def test_other_addresses_are_not(text):
    assert find_providers(text) == ()


def test_all_providers_of_a_text_are_found_each_once():
    text = f"{OSM} https://services.arcgisonline.com/x {OSM}"
    assert [one.name for one in find_providers(text)] == ["osm", "esri-world-imagery"]


@pytest.mark.parametrize("piece", ["a", "https://a", "{a", "[a", ":/", "%", "%25", "&amp;", "&#", "https://h/ "])
def test_reading_a_text_takes_time_in_proportion_to_it(piece):
    assert growth(lambda size: find_providers(piece * size), 10_000) < PROPORTIONAL


@pytest.mark.parametrize(
    "text",
    [
        "/vsicurl/https://services.arcgisonline.com/ortho.tif",
        "/vsicurl?url=https%3A%2F%2Fservices.arcgisonline.com%2Fortho.tif",
        "https://SERVICES.arcgisonline.com.:443/ortho.tif",
        "/vsizip//vsicurl/https://services.arcgisonline.com/a.zip/ortho.tif",
    ],
)
def test_terms_hold_for_rasters_of_a_provider_before_it_is_asked(text):
    assert named_source(text).stated_policy == shipped_entry("esri-world-imagery").policy


def test_terms_hold_where_a_redirect_leads():
    class Redirecting:
        def get(self, url, headers=None, *, origin=""):
            if "arcgisonline" in url:
                return Response(206, {"content-range": "bytes 0-0/9", "etag": '"a"'}, b"x")
            return Response(302, {"location": "https://services.arcgisonline.com/ortho.tif"}, b"")

        def close(self):
            pass

    found = Remote("/vsicurl/https://mirror.example/ortho.tif", "ortho", Redirecting())
    assert found.policy == shipped_entry("esri-world-imagery").policy
    found.close()


def test_a_raster_of_a_provider_ends_at_its_limit(tmp_path, monkeypatch):
    """The provider's host is the loopback's here; heights are read in the same way."""
    pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")
    policy = shipped_entry("esri-world-imagery").policy
    data = dict(entry.shipped_data())
    data["esri-world-imagery"] = {**data["esri-world-imagery"], "hosts": ["127.0.0.1"]}
    monkeypatch.setattr(entry, "shipped_data", lambda: data)
    values = np.full((3, 256, 256), 90, np.uint8)
    path = rasters.write(tmp_path / "a.tif", values, (5e5, 0.5, 0.0, 4e6, 0.0, -0.5), 32616)
    with RangeServer() as server:
        server.files["/a.tif"] = path.read_bytes(), '"a"'
        source = open_raster(f"{server.url}/a.tif")
        assert source.policy == policy
        zoom, size = source.grid.native_zoom, source.grid.tile_px
        for _ in range(policy.max_tiles):
            source.fetch("", Window(zoom, 0, 0, size, size))
        with pytest.raises(TermsError, match="at most 100 are allowed"):
            source.fetch("", Window(zoom, 0, 0, size, size))
        source.close()


def test_sources_under_the_same_terms_share_what_these_allow():
    osm, same, other = named_source("osm"), named_source(OSM.replace("tile", "a.tile")), named_source("usgs")
    assert shared_requests([(osm, 100), (other, 7), (same, 200), (osm, 1)]) == [301, 7, 301, 301]


def test_several_imageries_of_one_provider_are_counted_together(run):
    """None of the two is beyond the limit, and both together are."""
    mission = ("--coords", "35.14_-90.055_35.125_-90.04_300", "--data-dir", "out")
    alone = run("plan", *mission[:2], "--source", OSM, "--json")
    needed = json.loads(alone.stdout)["unique_tiles"]
    assert 125 < needed <= 250
    done = run("capture", *mission, "--imagery", f"a={OSM}", f"b={OSM.replace('tile.', 'TILE.')}")
    assert done.returncode == 3, done.stderr
    assert f"{2 * needed} requests, but at most 250 are allowed without breaking its terms" in done.stderr
