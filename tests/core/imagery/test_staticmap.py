"""Google Static Maps, against a server that renders about the centre it is sent."""

from __future__ import annotations

import base64
import re
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput, PartError, SourceError
from terrainav.core.geodesy.camera import Camera, Poses
from terrainav.core.geodesy.frames import map_windows
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.staticmap import StaticMapSource, sign

from tests.support.faults import FAULTS
from tests.support.patterns import MODULUS, decode_position
from tests.support.tileserver import STATIC_MAP_UNITS_PER_PX, TileServer

KEY = "AIzaSy-a-key"
SECRET = base64.urlsafe_b64encode(b"a signing secret \xff\xfe").decode()
# A pixel's position is told in sixteenths, rounded down.
TOLD_PX = 1.0 / STATIC_MAP_UNITS_PER_PX


@pytest.fixture
def server():
    with TileServer(key=KEY, secret=SECRET) as running:
        yield running


@pytest.fixture
def source_of():
    opened = []

    def make(server, key=KEY, secret=SECRET, **options):
        opened.append(StaticMapSource(key, secret, url=server.static_map_url, **options))
        return opened[-1]

    yield make
    for source in opened:
        source.close()


def planned(source, lat_deg, lon_deg, agl_m=120.0, zoom=18):
    """Window of one capture, as the plan has it."""
    pose = Poses.level(np.array([lat_deg]), np.array([lon_deg]), np.array([agl_m]))
    windows = map_windows(Camera(), pose, source.grid, zoom)
    return Window(zoom, *(values[0].item() for values in windows))


def test_a_broken_picture_is_asked_for_once_more(server, source_of):
    source = source_of(server)
    (part,) = source.parts(planned(source, 35.135, -89.861))
    whole = source.fetch("satellite", part.window)
    server.fail("bad-copy")
    assert np.array_equal(source.fetch("satellite", part.window), whole)
    assert sum(server.requests.values()) == 3
    server.heal()
    server.fail("corrupt")
    with pytest.raises(PartError, match=r"broken image \(.*\) \(tried 2 times\)$"):
        source.fetch("satellite", part.window)
    assert sum(server.requests.values()) == 5


def test_the_documentation_s_own_example_of_a_signature():
    url = "https://maps.googleapis.com/maps/api/geocode/json?address=New+York&client=clientID"
    assert sign(url, "vNIXE0xscrmjlyV-12Nj_BvUPaw=") == url + "&signature=chaRF2hTJKOScPr-RQCEhZbSzIE="
    assert sign(url, "vNIXE0xscrmjlyV-12Nj_BvUPaw") == url + "&signature=chaRF2hTJKOScPr-RQCEhZbSzIE="


@pytest.mark.parametrize("scale", [1, 2])
@pytest.mark.parametrize("map_type", ["satellite", "roadmap", "terrain"])
@pytest.mark.parametrize(
    ("lat_deg", "lon_deg"),
    [(35.1350000004, -89.8612345678), (-33.9, 151.2), (64.15, -21.95), (1e-8, -1e-8), (10.0, 179.9999999)],
)
def test_pixels_are_where_the_window_says(server, source_of, map_type, scale, lat_deg, lon_deg):
    source = source_of(server, scale=scale)
    window = planned(source, lat_deg, lon_deg)
    (part,) = source.parts(window)
    assert (part.dx_px, part.dy_px) == (0, 0)
    pixels = source.fetch(map_type, part.window)
    assert pixels.shape == (window.height_px, window.width_px, 3)
    columns, rows = decode_position(pixels, map_type)
    world_px = source.grid.world_px(18)
    for told, edge, size in (
        (columns[0], part.window.left_px, window.width_px),
        (rows[:, 0], window.top_px, window.height_px),
    ):
        centres = (edge + np.arange(size) + 0.5) % world_px
        off = (told + 0.5) * TOLD_PX - centres
        modulus = MODULUS * TOLD_PX
        off = (off + modulus / 2) % modulus - modulus / 2
        assert np.abs(off).max() <= TOLD_PX


def test_what_is_sent(server, source_of):
    source = source_of(server, scale=2)
    window = planned(source, 35.135, -89.8612)
    source.fetch("roadmap", source.parts(window)[0].window)
    source.fetch("satellite", source.parts(window)[0].window)
    roadmap, satellite = (parse_qs(urlsplit(path).query) for path in server.requests)
    # The frame's centre is a little off the nadir: it is in the middle of whole pixels.
    assert re.fullmatch(r"35\.13(5|4999)\d*,-89\.8612\d\d", roadmap["center"][0])
    assert [len(value.partition(".")[2]) for value in roadmap["center"][0].split(",")] == [6, 6]
    assert roadmap["zoom"] == ["18"]
    assert roadmap["size"] == [f"{window.width_px // 2}x{window.height_px // 2}"]
    assert roadmap["scale"] == ["2"]
    assert roadmap["style"] == ["feature:all|element:labels|visibility:off"]
    assert roadmap["format"] == ["png32"]
    assert satellite["maptype"] == ["satellite"]
    assert "style" not in satellite
    assert source.grid.tile_px == 512


def test_a_centre_the_service_would_move_is_refused(server, source_of):
    source = source_of(server)
    window = planned(source, 35.135, -89.8612)
    with pytest.raises(InvalidInput, match="has more than 6 decimals"):
        source.fetch("satellite", window._replace(left_px=window.left_px + 0.05))
    assert not server.requests


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width_px": 642}, "642x.* px: Google Static Maps gives up to 640 px times 1"),
        ({"height_px": 0}, "gives up to 640"),
        ({"zoom": 23}, "zoom 23: Google Static Maps has 0 to 21"),
    ],
)
def test_pictures_the_service_does_not_have(server, source_of, change, message):
    window = Window(0, 128.0 - 100, 128.0 - 100, 200, 200)._replace(**change)
    world_px = 256 << window.zoom
    window = window._replace(left_px=world_px / 2 - window.width_px / 2, top_px=world_px / 2 - window.height_px / 2)
    with pytest.raises(InvalidInput, match=message):
        source_of(server).fetch("satellite", window)


def test_other_map_types_and_scales_are_refused(server, source_of):
    with pytest.raises(InvalidInput, match="map type 'hybrid'"):
        source_of(server).fetch("hybrid", Window(0, 0.0, 0.0, 256, 256))
    with pytest.raises(InvalidInput, match="scale 3"):
        source_of(server, scale=3)


@pytest.mark.parametrize(
    ("key", "secret"), [("wrong", SECRET), (KEY, None), (KEY, base64.b64encode(b"other").decode())]
)
def test_a_refused_key_or_signature_stops_the_run_and_is_not_told(server, source_of, key, secret):
    source = source_of(server, key=key, secret=secret)
    with pytest.raises(SourceError, match="Google Static Maps refuses: 403 Forbidden: ") as raised:
        source.fetch("satellite", Window(0, 0.0, 0.0, 256, 256))
    text = f"{raised.value} {raised.value!r} {source!r}"
    assert key not in text
    assert not secret or secret not in text
    assert sum(server.requests.values()) == 1


def test_a_secret_that_is_none_is_not_told():
    with pytest.raises(InvalidInput, match="signing secret") as raised:
        StaticMapSource(KEY, "not*base64*at all")
    assert "not*base64" not in f"{raised.value} {raised.value.__context__}"


def test_a_picture_with_a_warning_is_no_picture(server, source_of, monkeypatch):
    def warn(handler, body):
        handler.answer(200, body, "image/png", {"X-Staticmap-API-Warning": "style is not valid"})

    monkeypatch.setitem(FAULTS, "404", warn)
    server.fail("404")
    with pytest.raises(PartError, match=r"image at 0\.000000,0\.000000 zoom 0: .*style is not valid"):
        source_of(server).fetch("satellite", Window(0, 0.0, 0.0, 256, 256))


def test_parts_wrap_around_the_world(server, source_of):
    (part,) = source_of(server).parts(Window(3, -20.5, 100.0, 300, 200))
    assert part.window.left_px == (256 << 3) - 20.5
