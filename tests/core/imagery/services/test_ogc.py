"""WMTS and WMS by their capabilities, against a server on the loopback."""

from __future__ import annotations

import importlib
import re
import sys
import warnings
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput, PartError, SourceError
from terrainav.core.geodesy.mercator import extent_of_box
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import SourceOptions, named_source, open_source
from terrainav.core.imagery.source import Window

from tests.support import patterns
from tests.support.growth import PROPORTIONAL, growth
from tests.support.services import (
    dimension,
    matrix,
    matrix_set,
    painted,
    png,
    service_entry,
    wms_document,
    wmts_document,
    wmts_layer,
    xml,
)

pytest.importorskip("owslib")
with warnings.catch_warnings():
    # It imports a module that Python is going to drop; that is for it to change.
    warnings.simplefilter("ignore", DeprecationWarning)
    importlib.import_module("owslib.wms")

QUAD = matrix_set("GoogleMapsCompatible", [matrix(str(zoom), zoom) for zoom in range(19)])
DUTCH = matrix_set(
    "EPSG:28992", [matrix("0", 0, corner=(-285401.92, 903402.0), scale=0.1)], "urn:ogc:def:crs:EPSG::28992"
)
#: Of degrees, which make no grid of images.
DEGREES = matrix_set("EPSG:4326", [matrix("0", 0, corner=(90.0, -180.0))], "urn:ogc:def:crs:EPSG::4326")


def layers(name, **options):
    """Layers that a service offers."""
    return named_source(name, SourceOptions(**options)).layers()


def serve_tiles(server, document, pattern):
    """Answer with a document, and with tiles where a path or query matches ``pattern`` (its groups z, x, y)."""

    def answer(path, query):
        found = re.fullmatch(pattern, path + "?" + "&".join(f"{k}={v}" for k, v in sorted(query.items())))
        if found:
            zoom, x, y = int(found["z"]), int(found["x"]), int(found["y"])
            return png(patterns.positions("satellite", zoom, x, y, 256))
        return xml(document)

    server.answer = answer


def one_line(raised):
    text = str(raised.value)
    assert "\n" not in text
    return text


# --- WMTS


def test_tiles_as_resources_with_levels_called_otherwise_and_limited(server):
    sets = [matrix_set("webmercator", [matrix(f"L{zoom:02d}", zoom) for zoom in range(20)])]
    rest = f"{server.url}/tiles/{{Style}}/{{TileMatrixSet}}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    layer = wmts_layer("ortho", {"webmercator": [f"L{z:02d}" for z in range(3, 18)]}, resources=[("image/png", rest)])
    serve_tiles(
        server,
        wmts_document([layer], sets),
        r"/tiles/default/webmercator/L0*(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)\.png\?",
    )
    source = open_source(f"wmts:{server.url}/caps.xml")
    assert (source.grid.tile_px, source.grid.min_zoom, source.grid.native_zoom) == (256, 3, 17)
    assert source.title == "Orthophotos"
    assert source.attribution == "Survey of Somewhere"
    assert source.policy.terms == "access constraints: name the survey"
    tile = source.fetch("", Window(5, 7 * 256, 11 * 256, 256, 256))
    assert (tile == patterns.positions("satellite", 5, 7, 11, 256)).all()
    assert server.asked == ["/caps.xml", "/tiles/default/webmercator/L05/11/7.png"]
    source.close()


def test_tiles_by_query_of_the_set_that_fits_among_several(server):
    big = matrix_set("quad512", [matrix(f"{zoom}", zoom, 512) for zoom in range(23)])
    layer = wmts_layer("a b", {"EPSG:28992": [], "quad512": []}, formats=("image/jpeg", "image/png"))
    server.answer = lambda path, query: (
        xml(wmts_document([layer], [DUTCH, big], get_tile=f"{server.url}/kvp?map=x"))
        if query.get("REQUEST") == "GetCapabilities"
        else png(
            patterns.positions("satellite", int(query["TILEMATRIX"]), int(query["TILECOL"]), int(query["TILEROW"]), 512)
        )
    )
    source = open_source(f"wmts:{server.url}/service?map=x#layer=a b")
    assert (source.grid.tile_px, source.grid.native_zoom) == (512, 22)
    tile = source.fetch("", Window(4, 3 * 512, 2 * 512, 512, 512))
    assert (tile == patterns.positions("satellite", 4, 3, 2, 512)).all()
    assert server.asked[0] == "/service?map=x&SERVICE=WMTS&REQUEST=GetCapabilities&VERSION=1.0.0"
    assert server.asked[1] == (
        "/kvp?map=x&SERVICE=WMTS&REQUEST=GetTile&VERSION=1.0.0&LAYER=a%20b&STYLE=default&TILEMATRIXSET=quad512"
        "&TILEMATRIX=4&TILEROW=2&TILECOL=3&FORMAT=image/png"
    )
    source.close()


@pytest.mark.parametrize(
    ("styles", "asked"),
    [
        ((("", True),), ""),
        ((("", False),), ""),
        ((("grey", False), ("", True)), ""),
        ((("", False), ("grey", True)), "grey"),
        ((("  ", True),), ""),
        ((), ""),
    ],
)
def test_a_style_without_a_name_is_asked_for_by_none(server, styles, asked):
    """By query and as a resource; GeoWebCache writes such styles."""
    rest = f"{server.url}/tiles/{{Style}}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    for resources in ((), [("image/png", rest)]):
        layer = wmts_layer("ortho", {"GoogleMapsCompatible": []}, styles=styles, resources=resources)
        document = wmts_document([layer], [QUAD], get_tile=f"{server.url}/kvp")
        server.answer = lambda *_, document=document: xml(document)
        url = service_entry(f"wmts:{server.url}/c.xml").templates("")[""].url(3, 1, 2)
        if resources:
            assert url == f"{server.url}/tiles/{asked}/3/2/1.png"
        else:
            assert parse_qs(urlsplit(url).query, keep_blank_values=True)["STYLE"] == [asked]
    named = service_entry(f"wmts:{server.url}/c.xml#layer=ortho&style={asked}") if styles else None
    assert named is None or named.urls == service_entry(f"wmts:{server.url}/c.xml").urls


@pytest.mark.parametrize("crs", ["urn:ogc:def:crs:EPSG::3857", "urn:ogc:def:crs:EPSG::900913", "EPSG:3857"])
def test_the_corner_of_the_quad_may_be_written_in_the_other_order(server, crs):
    half = 20037508.342789244
    levels = [matrix(str(zoom), zoom, corner=(half, -half)) for zoom in range(19)]
    rest = f"{server.url}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    layer = wmts_layer("ortho", {"swapped": []}, resources=[("image/png", rest)])
    serve_tiles(
        server,
        wmts_document([layer], [matrix_set("swapped", levels, crs)]),
        r"/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)\.png\?",
    )
    source = open_source(f"wmts:{server.url}/c.xml")
    tile = source.fetch("", Window(18, 137263 * 256, 91771 * 256, 256, 256))
    assert (tile == patterns.positions("satellite", 18, 137263, 91771, 256)).all()
    assert server.asked[-1] == "/18/91771/137263.png"
    source.close()
    # Any other corner is of another grid.
    for corner in ((-half, -half), (half, half)):
        levels = [matrix(str(zoom), zoom, corner=corner) for zoom in range(19)]
        document = wmts_document([layer], [matrix_set("swapped", levels, crs)])
        server.answer = lambda *_, document=document: xml(document)
        with pytest.raises(InvalidInput, match="needs a Web-Mercator quad"):
            service_entry(f"wmts:{server.url}/c.xml")


@pytest.mark.parametrize(
    ("offered", "asked"),
    [
        (["image/jpgpng"], "image/jpgpng"),
        (["image/jpg"], "image/jpg"),
        (["image/PNG"], "image/PNG"),
        (["image/png8"], "image/png8"),
        (["image/vnd.jpeg-png"], "image/vnd.jpeg-png"),
        # What was taken before is taken still, and colours come before 256 of them.
        (["image/jpgpng", "image/jpeg"], "image/jpeg"),
        (["image/png8", "image/jpg"], "image/jpg"),
        (["image/jpeg; mode=x", "image/png8"], "image/jpeg; mode=x"),
        (["image/tiff", "image/png32"], "image/png32"),
        (["", "image/png"], "image/png"),
    ],
)
def test_formats_go_by_other_names_too_and_are_asked_for_as_written(server, offered, asked):
    layer = wmts_layer("ortho", {"GoogleMapsCompatible": []}, formats=offered)
    document = wmts_document([layer], [QUAD], get_tile=f"{server.url}/kvp")

    def answer(_path, query):
        if query.get("REQUEST") != "GetTile":
            return xml(document)
        *_, body = png(patterns.positions("satellite", 3, 1, 2, 256))
        return 200, asked, body

    server.answer = answer
    source = open_source(f"wmts:{server.url}/c.xml")
    tile = source.fetch("", Window(3, 256, 512, 256, 256))
    assert (tile == patterns.positions("satellite", 3, 1, 2, 256)).all()
    assert parse_qs(urlsplit(server.asked[-1]).query)["FORMAT"] == [asked]
    source.close()
    short = asked.partition("/")[2]
    for choice in (asked, asked.upper(), short):
        entry = service_entry(f"wmts:{server.url}/c.xml#layer=ortho&format={choice}")
        assert parse_qs(urlsplit(entry.urls[""]).query)["FORMAT"] == [asked]


def test_a_format_may_be_spelled_otherwise_at_its_resource(server):
    rest = f"{server.url}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.jpg"
    layer = wmts_layer("ortho", {"GoogleMapsCompatible": []}, formats=["image/jpeg"], resources=[("image/jpg", rest)])
    server.answer = lambda *_: xml(wmts_document([layer], [QUAD]))
    assert service_entry(f"wmts:{server.url}/c.xml").templates("")[""].url(3, 1, 2).endswith("/3/2/1.jpg")


def test_a_wms_offers_formats_by_other_names(server):
    layer = "<Layer><Title>a</Title><Layer><Name>a</Name><Title>a</Title><CRS>EPSG:3857</CRS></Layer></Layer>"
    for kinds, asked, clear in (
        (("image/jpg",), "image/jpg", "FALSE"),
        (("image/PNG",), "image/PNG", "TRUE"),
    ):
        document = wms_document("1.3.0", f"{server.url}/wms", layer, formats=kinds)
        server.answer = lambda *_, document=document: xml(document)
        query = parse_qs(urlsplit(service_entry(f"wms:{server.url}/c.xml").urls[""]).query)
        assert (query["FORMAT"], query["TRANSPARENT"]) == ([asked], [clear])


def test_beyond_the_limits_of_the_quad_there_is_no_imagery_and_no_request(server):
    limits = {"4": (2, 3, 5, 6), "5": (4, 6, 11, 13), "6": (70, 9, 8, 9)}
    rest = f"{server.url}/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    layer = wmts_layer("ortho", {"GoogleMapsCompatible": limits}, resources=[("image/png", rest)])
    serve_tiles(server, wmts_document([layer], [QUAD]), r"/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)\.png\?")
    source = open_source(f"wmts:{server.url}/c.xml#layer=ortho&tilematrix=5")
    for zoom, column, row in ((5, 4, 6), (5, 11, 13), (4, 2, 3), (4, 5, 6)):
        tile = source.fetch("", Window(zoom, column * 256, row * 256, 256, 256))
        assert (tile == patterns.positions("satellite", zoom, column, row, 256)).all()
    asked = len(server.asked)
    for zoom, column, row in ((5, 3, 6), (5, 4, 5), (5, 12, 13), (5, 11, 14), (4, 1, 3), (4, 6, 6)):
        with pytest.raises(PartError, match="beyond the tiles of"):
            source.fetch("", Window(zoom, column * 256, row * 256, 256, 256))
    assert len(server.asked) == asked
    # The ends are the imagery's, and a plan knows.
    assert source.grid.extent == tuple((u / 32, v / 32) for u, v in ((4, 6), (12, 6), (12, 14), (4, 14)))
    source.close()
    # Limits that leave nothing are no limits.
    source = open_source(f"wmts:{server.url}/c.xml")
    assert source.fetch("", Window(6, 20 * 256, 9 * 256, 256, 256)).shape == (256, 256, 3)
    assert source.grid.extent is None
    source.close()


def test_zooms_come_from_the_scale_not_from_the_names(server):
    # Names count from the first level there is; one more level, of another scale, is of no use.
    levels = [matrix(str(at), zoom) for at, zoom in enumerate(range(6, 12))] + [matrix("9", 13, scale=1.1)]
    rest = f"{server.url}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}"
    layer = wmts_layer("ortho", {"mine": []}, resources=[("image/png", rest)])
    server.answer = lambda *_: xml(wmts_document([layer], [matrix_set("mine", levels)]))
    entry = service_entry(f"wmts:{server.url}/c.xml")
    assert (entry.min_zoom, entry.max_zoom) == (6, 11)
    assert entry.templates("")[""].url(8, 1, 2) == f"{server.url}/2/1/2"


@pytest.mark.parametrize(
    "off",
    [
        {"corner": (-20037508.34, 19000000.0)},
        {"scale": 1.001},
    ],
)
def test_matrices_beside_the_quad_are_refused_with_those_that_there_are(server, off):
    layer = wmts_layer("ortho", {"EPSG:4326": [], "near": []})
    near = matrix_set("near", [matrix("0", 0, **off)])
    server.answer = lambda *_: xml(wmts_document([layer], [DEGREES, near], get_tile=server.url))
    with pytest.raises(InvalidInput) as raised:
        service_entry(f"wmts:{server.url}/c.xml")
    text = one_line(raised)
    assert "EPSG:4326" in text
    assert "needs a Web-Mercator quad, such as WebMercatorQuad or GoogleMapsCompatible" in text


def test_a_set_asked_for_that_does_not_fit_names_those_that_do(server):
    layer = wmts_layer("ortho", {"EPSG:4326": [], "GoogleMapsCompatible": []})
    server.answer = lambda *_: xml(wmts_document([layer], [DEGREES, QUAD], get_tile=server.url))
    with pytest.raises(InvalidInput, match=r"tilematrixset 'EPSG:4326': .* offers GoogleMapsCompatible"):
        service_entry(f"wmts:{server.url}/c.xml#tilematrixset=EPSG:4326")
    assert service_entry(f"wmts:{server.url}/c.xml#tilematrixset=GoogleMapsCompatible").max_zoom == 18


def test_choices_are_named_where_they_are_needed_or_wrong(server):
    two = [
        wmts_layer(name, {"GoogleMapsCompatible": []}, title=name.upper(), styles=(("grey", False), ("colour", True)))
        for name in ("ortho", "topo")
    ]
    server.answer = lambda *_: xml(wmts_document(two, [QUAD], get_tile=server.url))
    name = f"wmts:{server.url}/c.xml"
    assert [(layer.name, layer.title) for layer in layers(name)] == [("ortho", "ORTHO"), ("topo", "TOPO")]
    for choice, says in (
        ("", "say which with #layer=…: ortho, topo; `terrainav sources show` lists them"),
        ("#layer=orto", "layer 'orto': 127.0.0.1 offers ortho, topo"),
        ("#layer=ortho&style=gold", "style 'gold': 127.0.0.1 offers grey, colour"),
        ("#layer=ortho&format=jpeg", "format 'image/jpeg': 127.0.0.1 offers image/png"),
        (
            "#layers=ortho",
            "choice 'layers' of a WMTS: must be one of layer, style, tilematrixset, tilematrix, format",
        ),
    ):
        with pytest.raises(InvalidInput) as raised:
            service_entry(name + choice)
        assert says in one_line(raised)
    assert "STYLE=colour" in service_entry(name + "#layer=topo").urls[""]
    assert "STYLE=grey" in service_entry(name + "#layer=topo&style=grey").urls[""]


def test_the_time_of_a_wmts_is_the_date(server):
    dims = dimension("Time", "2022", "2018", "2020", "2022") + dimension("band", "rgb", "rgb", "cir")
    rest = f"{server.url}/{{band}}/{{Time}}/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"
    layer = wmts_layer("o", {"GoogleMapsCompatible": []}, resources=[("image/png", rest)], dimensions=dims)
    serve_tiles(server, wmts_document([layer], [QUAD]), r"/rgb/20\d\d/(?P<z>\d+)/(?P<x>\d+)/(?P<y>\d+)\.png\?")
    name = f"wmts:{server.url}/c.xml"
    for asked, got in ((None, "2022"), ("2018", "2018")):
        source = open_source(name, date=asked)
        assert source.date == got
        source.fetch("", Window(1, 256, 0, 256, 256))
        assert server.asked[-1] == f"/rgb/{got}/1/1/0.png"
        source.close()
    with pytest.raises(InvalidInput, match="date '2019': must be one of those there are, such as 2018, 2020, 2022"):
        open_source(name, date="2019")


def test_an_interval_of_days_is_a_range(server):
    dims = dimension("Time", "2024-06-30", "2015-11-24/2016-02-01/P1D", "2016-02-03/2024-06-30/P1D")
    layer = wmts_layer("o", {"GoogleMapsCompatible": []}, dimensions=dims)
    server.answer = lambda *_: xml(wmts_document([layer], [QUAD], get_tile=server.url))
    dates = service_entry(f"wmts:{server.url}/c.xml").dates
    assert (dates.kind, dates.first, dates.last, dates.default) == (
        "day",
        "2015-11-24",
        "2024-06-30",
        "2024-06-30",
    )
    assert "Time=2016-05-01" in service_entry(f"wmts:{server.url}/c.xml").templates("2016-05-01")[""].text


# --- keys


def test_a_key_is_sent_and_written_nowhere(server):
    # The server repeats the key in its addresses, as some do.
    rest = f"{server.url}/s3cret/{{TileMatrix}}/{{TileCol}}/{{TileRow}}.png"
    layer = wmts_layer("o", {"GoogleMapsCompatible": []}, resources=[("image/png", rest)])
    serve_tiles(server, wmts_document([layer], [QUAD]), r"/s3cret/(?P<z>\d+)/(?P<x>\d+)/(?P<y>\d+)\.png\?")
    name = f"wmts:{server.url}/c.xml?apikey={{key}}"
    source = open_source(name, key="s3cret")
    source.fetch("", Window(1, 0, 0, 256, 256))
    assert server.asked == ["/c.xml?apikey=s3cret", "/s3cret/1/0/0.png"]
    assert "s3cret" not in repr(vars(source)["_templates"]) + source.name + source.title
    source.close()
    assert "s3cret" not in str(service_entry(name, key="s3cret").to_data())
    with pytest.raises(SourceError, match="needs an API key: set the environment variable TERRAINAV_KEY"):
        open_source(name)
    with pytest.raises(InvalidInput, match="holds a key in 'apikey'"):
        open_source(f"wmts:{server.url}/c.xml?apikey=s3cret")
    server.answer = lambda *_: xml(b"<Error>key s3cret is over its quota</Error>", 403)
    with pytest.raises(SourceError) as raised:
        open_source(name, key="s3cret")
    assert "s3cret" not in one_line(raised)
    assert "over its quota" in str(raised.value)
    # Nor in part, where the provider's words are cut short in the middle of it.
    for length in range(185, 205):
        words = b"<Error>" + b"x" * length + b"s3cret</Error>"
        server.answer = lambda *_, body=words: xml(body)
        with pytest.raises(SourceError) as raised:
            open_source(name, key="s3cret")
        assert "s3" not in one_line(raised)


# --- capabilities that are none


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (xml(b"<ServiceExceptionReport><ServiceException>no such map</ServiceException></ServiceExceptionReport>"),
         "no capabilities at this address: no such map"),
        ((200, "text/html", b"<html><title>Please log in</title></html>"), "no capabilities at this address: Please"),
        ((404, "text/plain", b"gone"), "404 Not Found: gone"),
        (xml(b"<Capabilities><Contents>"),
         {"wmts": "capabilities that cannot be read", "wms": "are of a WMTS: write wmts:"}),
        (xml(b"<WMS_Capabilities/>"), {"wmts": "are of a WMS: write wms:", "wms": "capabilities that cannot be read"}),
        (xml(b'<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/hostname">]><Capabilities>&e;</Capabilities>'),
         {"wmts": "a document type or entities, which are not read", "wms": "are of a WMTS"}),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["wmts", "wms"])
def test_an_address_without_capabilities_is_one_line(server, kind, answer, says):
    server.answer = lambda *_: answer
    with pytest.raises(SourceError) as raised:
        open_source(f"{kind}:{server.url}/c.xml")
    assert (says if isinstance(says, str) else says[kind]) in one_line(raised)
    assert "127.0.0.1" in str(raised.value)


def test_a_document_beyond_measure_is_given_up(server, monkeypatch):
    monkeypatch.setattr("terrainav.core.imagery.services.capabilities.MAX_CAPABILITIES_BYTES", 1000)
    server.answer = lambda *_: xml(b"<Capabilities>" + b" " * 2000)
    with pytest.raises(SourceError, match="an answer of more than 1000 bytes"):
        open_source(f"wmts:{server.url}/c.xml")


@pytest.mark.parametrize("piece", [b"<WMS_Capabilities", b"<WMS_Capabilities version ", b"<a:", b"<Capabilities <"])
def test_a_megabyte_of_beginnings_is_soon_refused(server, piece):
    def read(size):
        server.answer = lambda *_: xml(piece * (size // len(piece)))
        with pytest.raises(SourceError):
            open_source(f"wms:{server.url}/c.xml")

    # A pattern that tried each of them anew took 40 s, and grew with the square of their number.
    assert growth(read, 125_000) < PROPORTIONAL


def test_titles_are_one_line_of_what_can_be_printed(server):
    layer = wmts_layer("a", {"quad": []}, title="Or&#10;tho&#x202e; &#x9b;31m", resources=[("image/png", "/{TileRow}")])
    server.answer = lambda *_: xml(wmts_document([layer], []))
    assert [one.title for one in layers(f"wmts:{server.url}/c.xml")] == ["Or tho 31m"]


@pytest.mark.parametrize("kind", ["wmts", "wms"])
def test_without_owslib_the_line_says_what_to_install(server, kind, monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "owslib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "owslib", None)
    server.answer = lambda *_: xml(b"<Capabilities/>" if kind == "wmts" else b"<WMS_Capabilities/>")
    with pytest.raises(SourceError, match=f"source {kind}:127.0.0.1: needs OWSLib: pip install owslib"):
        open_source(f"{kind}:{server.url}/c.xml")


@pytest.mark.parametrize("name", ["wms:ftp://h/x", "wmts:https://me:word@h/x"])
def test_addresses_that_are_refused(name):
    with pytest.raises(InvalidInput):
        open_source(name)


class InMemory:
    """A transport that answers every request with one document."""

    def __init__(self, body):
        self.body, self.closed = body, False

    def get(self, url, headers=None):
        return Response(200, {"content-type": "text/xml"}, self.body)

    def close(self):
        self.closed = True


def test_a_known_provider_s_terms_hold_for_its_services_too():
    layer = wmts_layer("o", {"GoogleMapsCompatible": []})
    transport = InMemory(wmts_document([layer], [QUAD], get_tile="https://services.arcgisonline.com/wmts"))
    source = open_source("wmts:https://services.arcgisonline.com/c.xml", transport=transport)
    assert source.policy.bulk_allowed == "no"
    assert not source.policy.cache_allowed
    # It goes on to fetch the tiles, and is closed with the source.
    assert not transport.closed
    source.close()
    assert transport.closed


# --- WMS

LAYERS_130 = """<Layer><Title>All</Title><CRS>EPSG:4326</CRS><CRS>EPSG:3857</CRS>
<Layer><Name>ortho</Name><Title>Orthophotos</Title><Style><Name>plain</Name><Title>Plain</Title></Style>
<Dimension name="time" units="ISO8601" default="2021-01-01">2019-01-01,2021-01-01</Dimension>
<Attribution><Title>Survey, 2021</Title></Attribution><MinScaleDenominator>1066.364</MinScaleDenominator></Layer>
<Layer><Name>roads</Name><Title>Roads</Title></Layer></Layer>"""
LAYERS_111 = """<Layer><Title>All</Title><SRS>EPSG:4326 EPSG:900913</SRS>
<Layer><Name>ortho</Name><Title>Orthophotos</Title><Dimension name="time" units="ISO8601"/>
<Extent name="time" default="2021">2019,2021</Extent></Layer></Layer>"""


def wms(server, version, body, paint=painted):
    document = wms_document(version, f"{server.url}/ows?map=a.map", body)
    server.answer = lambda path, query: xml(document) if query["REQUEST"] == "GetCapabilities" else png(paint(query))


@pytest.mark.parametrize(
    ("version", "body", "crs", "date"),
    [("1.3.0", LAYERS_130, "CRS=EPSG:3857", "2021-01-01"), ("1.1.1", LAYERS_111, "SRS=EPSG:900913", "2021")],
)
@pytest.mark.parametrize("tile_px", [256, 512])
def test_a_wms_becomes_tiles_of_the_grid(server, version, body, crs, date, tile_px):
    wms(server, version, body)
    source = open_source(f"wms:{server.url}/ows#layers=ortho&version={version}", tile_px=tile_px)
    assert (source.grid.tile_px, source.date) == (tile_px, date)
    # Far from the origin and at a high zoom, where an edge that is off by a little shows.
    zoom, x, y = 18, 131_071, 87_654
    tile = source.fetch("", Window(zoom, x * tile_px, y * tile_px, tile_px, tile_px))
    assert (tile == patterns.positions("satellite", zoom, x, y, tile_px)).all()
    asked = server.asked[-1]
    assert f"VERSION={version}" in asked
    assert crs in asked
    assert f"TIME={date}" in asked
    assert "TRANSPARENT=TRUE" in asked
    assert "FORMAT=image/png" in asked
    assert asked.startswith("/ows?map=a.map&")
    source.close()


def test_neighbouring_requests_share_their_edges_to_the_last_digit(server):
    wms(server, "1.3.0", LAYERS_130)
    template = service_entry(f"wms:{server.url}/ows#layers=ortho").templates("2021-01-01")[""]
    edges = {}
    for x, y in ((66_000, 42_000), (66_001, 42_000), (66_000, 42_001)):
        text = re.search("BBOX=([^&]*)", template.url(17, x, y))[1]
        edges[x, y] = text.split(",")
    assert edges[66_000, 42_000][2] == edges[66_001, 42_000][0]
    assert edges[66_000, 42_000][1] == edges[66_000, 42_001][3]


def test_what_a_wms_states_of_itself(server):
    wms(server, "1.3.0", LAYERS_130)
    entry = service_entry(f"wms:{server.url}/ows#layers=ortho&styles=plain&format=jpg")
    assert entry.attribution == "Survey, 2021"
    # 1066.364 is the scale of zoom 19 at 256 px and 0.28 mm (OGC 07-057r7, annex E).
    assert (entry.native_zoom, entry.dates.first) == (19, "2019-01-01")
    assert "STYLES=plain" in entry.urls[""]
    assert "FORMAT=image/jpeg&TRANSPARENT=FALSE" in entry.urls[""]
    both = service_entry(f"wms:{server.url}/ows#layers=ortho,roads")
    assert "LAYERS=ortho,roads&STYLES=,&" in both.urls[""]
    assert both.title == "Orthophotos, Roads"
    assert [layer.name for layer in layers(f"wms:{server.url}/ows")] == ["ortho", "roads"]


@pytest.mark.parametrize(
    ("choice", "says"),
    [
        ("", "say which with #layers=…: ortho, roads"),
        ("#layers=ortho,rods", "layers 'rods': 127.0.0.1 offers ortho, roads"),
        ("#layers=ortho&styles=gold", "styles 'gold': 127.0.0.1 offers plain"),
        ("#layers=ortho,roads&styles=plain", "must be one for each of 2 layers"),
        ("#layers=ortho&format=image/tiff", "format 'image/tiff': 127.0.0.1 offers image/jpeg, image/png"),
    ],
)
def test_choices_of_a_wms(server, choice, says):
    wms(server, "1.3.0", LAYERS_130)
    with pytest.raises(InvalidInput) as raised:
        service_entry(f"wms:{server.url}/ows{choice}")
    assert says in one_line(raised)


def test_a_layer_without_web_mercator_names_what_it_has(server):
    wms(server, "1.3.0", LAYERS_130.replace("EPSG:3857", "CRS:84"))
    with pytest.raises(InvalidInput, match="is offered in CRS:84, EPSG:4326; needs EPSG:3857 or another"):
        service_entry(f"wms:{server.url}/ows#layers=ortho")


def test_a_version_that_is_not_spoken(server):
    server.answer = lambda *_: xml(b'<WMT_MS_Capabilities version="1.0.0"/>')
    with pytest.raises(SourceError, match=r"speaks version 1\.0\.0; must be 1\.3\.0 or 1\.1\.1"):
        service_entry(f"wms:{server.url}/ows")


def test_an_exception_with_status_200_is_no_picture(server):
    report = b"""<?xml version="1.0"?><ServiceExceptionReport version="1.3.0">
<ServiceException code="InvalidFormat">msDrawMap(): failed to draw layer</ServiceException></ServiceExceptionReport>"""
    wms(server, "1.3.0", LAYERS_130)
    source = open_source(f"wms:{server.url}/ows#layers=ortho")
    server.answer = lambda *_: xml(report)
    with pytest.raises(PartError, match=r"text/xml instead of an image: msDrawMap\(\): failed to draw layer"):
        source.fetch("", Window(1, 0, 0, 256, 256))
    # The server has said what is wrong: asking again is of no use.
    assert server.asked[-1].count("GetMap") == 1
    assert "GetCapabilities" in server.asked[-2]
    source.close()


def wmts(server):
    rest = f"{server.url}/tiles/{{TileMatrix}}/{{TileRow}}/{{TileCol}}.png"
    document = wmts_document(
        [wmts_layer("ortho", {"quad": [str(zoom) for zoom in range(19)]}, resources=[("image/png", rest)])],
        [matrix_set("quad", [matrix(str(zoom), zoom) for zoom in range(19)])],
    )
    serve_tiles(server, document, r"/tiles/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)\.png\?")


@pytest.mark.parametrize("kind", ["wms", "wmts"])
def test_a_broken_picture_is_asked_for_once_more(server, kind):
    if kind == "wms":
        wms(server, "1.3.0", LAYERS_130)
        source = open_source(f"wms:{server.url}/ows#layers=ortho")
    else:
        wmts(server)
        source = open_source(f"wmts:{server.url}/caps.xml")
    right, broken = server.answer, [True]

    def answer(path, query):
        status, mime, body = right(path, query)
        return status, mime, body[:-40] if broken and broken.pop() else body

    server.answer, before = answer, len(server.asked)
    tile = source.fetch("", Window(9, 256, 256, 256, 256))
    assert (tile == patterns.positions("satellite", 9, 1, 1, 256)).all()
    assert len(server.asked) - before == 2
    broken.extend([True] * 9)
    with pytest.raises(PartError, match=r"broken image \(.*\) \(tried 2 times\)"):
        source.fetch("", Window(9, 512, 256, 256, 256))
    assert len(server.asked) - before == 4
    source.close()


def test_ground_without_imagery_is_transparent_and_stays_so(server):
    def half(query):
        opaque = np.full((256, 256, 1), 255, np.uint8)
        opaque[:, 128:] = 0
        return np.concatenate([painted(query), opaque], axis=2)

    wms(server, "1.3.0", LAYERS_130, half)
    source = open_source(f"wms:{server.url}/ows#layers=ortho")
    tile = source.fetch("", Window(9, 256, 256, 256, 256))
    assert tile.shape == (256, 256, 4)
    assert (tile[:, :128, :3] == patterns.positions("satellite", 9, 1, 1, 256)[:, :128]).all()
    assert (tile[:, :128, 3] == 255).all()
    assert (tile[:, 128:, 3] == 0).all()
    source.close()


def test_a_service_says_where_its_imagery_ends(server):
    """The box of a layer, of several layers together, or none that makes sense."""
    crs = "<CRS>EPSG:3857</CRS>"

    def layer(name, west, east):
        box = f"<westBoundLongitude>{west}</westBoundLongitude><eastBoundLongitude>{east}</eastBoundLongitude>"
        box += "<southBoundLatitude>45.8</southBoundLatitude><northBoundLatitude>47.9</northBoundLatitude>"
        box = f"<EX_GeographicBoundingBox>{box}</EX_GeographicBoundingBox>"
        return f"<Layer><Name>{name}</Name><Title>{name}</Title>{crs}{box}</Layer>"

    layers = layer("west", 5.9, 8.0) + layer("east", 8.0, 10.5) + layer("wrong", 20.0, 10.0)
    body = wms_document("1.3.0", f"{server.url}/wms", f"<Layer><Title>All</Title>{crs}{layers}</Layer>")
    server.answer = lambda *_: xml(body)
    name = f"wms:{server.url}/wms#layers="
    assert service_entry(name + "west,east").grid().extent == extent_of_box(5.9, 45.8, 10.5, 47.9)
    assert service_entry(name + "wrong").grid().extent is None
