"""ArcGIS REST services and OGC API - Tiles by their descriptions, against a server on the loopback."""

from __future__ import annotations

import json
import re
from urllib.parse import urlsplit

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.errors import InvalidInput, PartError, SourceError, TerrAInavError
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import SourceOptions, named_source, open_source, source_kind
from terrainav.core.imagery.services.detecting import found_service, is_service_address
from terrainav.core.imagery.source import Window

from tests.support import patterns
from tests.support.json_services import (
    EXTENT_M,
    REL,
    answer_of,
    collection,
    image_service,
    landing,
    map_service,
    matrix_set,
    tileset,
)
from tests.support.services import matrix as wmts_matrix
from tests.support.services import matrix_set as wmts_set
from tests.support.services import painted, png, service_entry, wms_document, wmts_document, wmts_layer
from tests.support.thinning import named, thinned

#: A tile over the services' ground, and another place.
ZOOM, COLUMN, ROW = 14, 4101, 6462
NOT_FOUND = 404, "text/plain", b"nothing here"
LAYERS = "<Layer><Title>A</Title><CRS>EPSG:3857</CRS><Layer><Name>a</Name><Title>A</Title></Layer></Layer>"
MERCATOR_URI = "http://www.opengis.net/def/crs/EPSG/0/3857"


def serve(server, documents, tiles=None):
    """Answer with JSON by path, and with tiles where a path matches (its groups z, x, y)."""

    def answer(path, query):
        found = re.fullmatch(tiles, path) if tiles else None
        if found:
            return png(patterns.positions("satellite", int(found["z"]), int(found["x"]), int(found["y"]), 256))
        document = documents.get(path)
        if callable(document):
            return document(query)
        return NOT_FOUND if document is None else answer_of(document)

    server.answer = answer


def refusal(name, **options):
    with pytest.raises((SourceError, InvalidInput)) as raised:
        found_service(name, SourceOptions(**options)).source.entry  # noqa: B018
    text = str(raised.value)
    assert "\n" not in text
    assert len(text) < 600
    return text


# --- ArcGIS: tiles that are made


def test_cached_map_service_is_asked_for_its_tiles(server):
    base = "/arcgis/rest/services/Ortho/MapServer"
    serve(server, {base: map_service()}, rf"{base}/tile/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)")
    source = open_source(f"arcgis:{server.url}{base}")
    # Its scales end at 1:1128, which is level 19, whatever levels the scheme goes on to.
    assert (source.grid.tile_px, source.grid.min_zoom, source.grid.native_zoom) == (256, 0, 19)
    assert (source.title, source.attribution) == ("Orthophotos 2023", "Survey of Somewhere")
    tile = source.fetch("", Window(ZOOM, COLUMN * 256, ROW * 256, 256, 256))
    assert (tile == patterns.positions("satellite", ZOOM, COLUMN, ROW, 256)).all()
    assert server.asked == [f"{base}?f=json", f"{base}/tile/{ZOOM}/{ROW}/{COLUMN}"]
    # The ground that it states, by PROJ.
    west, south = Transformer.from_crs(3857, 4326, always_xy=True).transform(EXTENT_M["xmin"], EXTENT_M["ymin"])
    assert service_entry(f"arcgis:{server.url}{base}").bounds_deg[:2] == pytest.approx((west, south), abs=1e-9)
    source.close()


def test_tiles_of_a_national_system_keep_its_grid(server):
    base = "/server/rest/services/Luftbild/MapServer"
    swiss = {"wkid": 2056, "latestWkid": 2056}
    # As map.geo.admin.ch cuts its caches, of which the last three halve.
    sizes = [4.0, 2.0, 1.0]
    document = map_service(
        spatialReference=swiss,
        fullExtent={
            "xmin": 2_480_000.0,
            "ymin": 1_070_000.0,
            "xmax": 2_840_000.0,
            "ymax": 1_300_000.0,
            "spatialReference": swiss,
        },
        maxScale=0,
        minScale=0,
        tileInfo={
            "rows": 512,
            "cols": 512,
            "dpi": 96,
            "format": "MIXED",
            "origin": {"x": 2_420_000.0, "y": 1_350_000.0},
            "spatialReference": swiss,
            "lods": [
                {"level": at + 20, "resolution": size, "scale": size * 96 / 0.0254} for at, size in enumerate(sizes)
            ],
        },
    )
    serve(server, {base: document})
    found = service_entry(f"arcgis:{server.url}{base}")
    grid = found.grid()
    assert (grid.plane.crs, grid.tile_px) == ("EPSG:2056", 512)
    # A pixel of the finest level is a metre, and the plane begins at the origin.
    assert grid.pixel_size(grid.native_zoom) == pytest.approx((1.0, 1.0), rel=1e-12)
    assert (grid.plane.west, grid.plane.north) == (2_420_000.0, 1_350_000.0)
    url = found.templates("")[""].url(grid.native_zoom, 3, 5)
    assert url.endswith(f"{base}/tile/22/5/3")
    # In Web Mercator, where that is asked for, the service draws.
    asked = service_entry(f"arcgis:{server.url}{base}", crs="EPSG:3857").urls[""]
    assert "/export?" in asked


# --- ArcGIS: drawn


def test_map_service_without_tiles_draws_the_layers_that_are_asked_for(server):
    base = "/arcgis/rest/services/Dynamic/MapServer"
    serve(
        server,
        {
            base: map_service(cached=False),
            f"{base}/export": lambda query: png(
                painted(
                    {
                        "BBOX": query["BBOX"],
                        **dict(zip(("WIDTH", "HEIGHT"), query["SIZE"].split(","))),
                    }
                )
            ),
        },
    )
    source = open_source(f"arcgis:{server.url}{base}#layers=0,2")
    assert source.title == "Orthophotos 2023: Imagery, Parcels"
    tile = source.fetch("", Window(ZOOM, COLUMN * 256, ROW * 256, 256, 256))
    # The pixels of the very places of the tile.
    columns, rows = patterns.decode_position(tile)
    assert (columns[0] == COLUMN * 256 % 4096 + np.arange(256)).all() or (
        columns[0] % 4096 == (COLUMN * 256 + np.arange(256)) % 4096
    ).all()
    assert (rows[:, 0] % 4096 == (ROW * 256 + np.arange(256)) % 4096).all()
    asked = server.asked[-1]
    for part in ("bboxSR=3857", "imageSR=3857", "size=256,256", "format=png32", "layers=show:0,2", "f=image"):
        assert part in asked
    # 1:1128 is finer than zoom 18 of 256 px, as the standard pixel of 0.28 mm has it.
    assert source.grid.native_zoom == 18
    source.close()
    # A layer's own address names it as well.
    assert "layers=show:2" in service_entry(f"arcgis:{server.url}{base}/2").urls[""]
    text = refusal(f"arcgis:{server.url}{base}#layers=7")
    assert "offers 0, 2" in text


def test_image_service_draws_up_to_its_own_pixels_and_in_any_system(server):
    base = "/arcgis/rest/services/Ortho/Shelby/ImageServer"
    serve(server, {base: image_service()})
    found = service_entry(f"arcgis:{server.url}{base}")
    assert "/exportImage?bbox={bbox-epsg-3857}" in found.urls[""]
    assert (found.title, found.attribution) == ("Ortho/Shelby", "County of Shelby")
    # 0.3 m of ground at 35 degrees: zoom 18 has 0.49 m there, zoom 19 0.24 m.
    assert found.native_zoom == 19
    own = service_entry(f"arcgis:{server.url}{base}", crs="EPSG:26916")
    assert own.plane.crs == "EPSG:26916"
    assert "bbox={bbox}&bboxSR=26916&imageSR=26916" in own.urls[""]
    assert own.plane.width / 2**own.native_zoom / 256 == 0.25
    with pytest.raises(InvalidInput, match="every projected system"):
        service_entry(f"arcgis:{server.url}{base}", crs="EPSG:4326")


def test_services_of_a_server_are_listed_and_chosen(server):
    root = "/arcgis/rest/services"
    serve(
        server,
        {
            root: {
                "currentVersion": 10.91,
                "folders": ["Utilities"],
                "services": [
                    {"name": "Ortho/Shelby", "type": "ImageServer"},
                    {"name": "Streets", "type": "MapServer"},
                    {"name": "Find", "type": "GeocodeServer"},
                ],
            },
            f"{root}/Ortho/Shelby/ImageServer": image_service(),
        },
    )
    found = found_service(f"{server.url}{root}", SourceOptions())
    assert found.kind == "arcgis"
    assert [one.name for one in found.layers] == ["Ortho/Shelby/ImageServer", "Streets/MapServer"]
    chosen = named_source(f"{found.source.text}#service=Ortho%2FShelby%2FImageServer")
    assert chosen.layers() is None
    assert chosen.title == "Ortho/Shelby"
    assert "say which with #service=" in refusal(f"arcgis:{server.url}{root}")


def test_token_goes_with_each_request_and_into_no_file(server):
    base = "/arcgis/rest/services/Ortho/MapServer"

    def described(query):
        if query.get("TOKEN") != "s3cret/1":
            return answer_of({"error": {"code": 499, "message": "Token Required", "details": []}})
        return answer_of(map_service())

    serve(server, {base: described}, rf"{base}/tile/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)")
    assert "499 Token Required" in refusal(f"arcgis:{server.url}{base}")
    name = f"arcgis:{server.url}{base}?token={{key}}"
    assert "needs an API key" in refusal(name)
    found = service_entry(name, key="s3cret/1")
    assert "s3cret" not in json.dumps(found.to_data())
    assert found.key_env == "TERRAINAV_KEY"
    source = open_source(name, key="s3cret/1")
    source.fetch("", Window(3, 0, 0, 256, 256))
    assert server.asked[-1].endswith("/tile/3/0/0?token=s3cret%2F1")
    source.close()


@pytest.mark.parametrize(
    ("document", "words"),
    [
        (
            {"error": {"code": 500, "message": "Service Ortho/MapServer not started", "details": []}},
            "not started",
        ),
        ({"error": {}}, "no reason given"),
        ([1, 2], "does not describe a service"),
        (map_service(cached=False, capabilities="Query"), "neither has tiles nor draws maps"),
        (map_service(tileInfo={"cols": "many"}, capabilities="Tilemap"), "cannot be read"),
        (map_service(tileInfo={**map_service()["tileInfo"], "cols": 10**40}), ""),
        (
            map_service(tileInfo={**map_service()["tileInfo"], "lods": [{"level": 0}] * 3}, capabilities="x"),
            "neither",
        ),
        (
            map_service(cached=False, fullExtent={"xmin": "NaN", "spatialReference": {"wkid": -4}}, maxScale=-1),
            None,
        ),
        (map_service(cached=False, copyrightText=["not", "text"], documentInfo=7, layers="none"), None),
    ],
)
def test_broken_and_hostile_descriptions_end_in_one_line(server, document, words):
    base = "/arcgis/rest/services/Ortho/MapServer"
    serve(server, {base: lambda _: answer_of(document)})
    name = f"arcgis:{server.url}{base}"
    if words is None:
        assert service_entry(name).kind == "xyz"
    elif words == "":
        # A cache that cannot be is left aside for what the service draws.
        assert "/export?" in service_entry(name).urls[""]
    else:
        assert words in refusal(name)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "no description in JSON"),
        (b"<html><title>Sign in</title></html>", "Sign in"),
        (b'{"a":', "JSON that cannot be read"),
        (b'{"a":' + b"[" * 5000 + b"]" * 5000 + b"}", "nested too deep"),
        (b'{"a": 1e999}', "too large"),
        (b'{"a": "' + b"x" * (9 << 20) + b'"}', "more than 8 MB"),
        (b'{"\xff": 1}', "UTF-8"),
    ],
    ids=["empty", "page", "cut", "deep", "infinite", "huge", "encoding"],
)
def test_answers_that_are_no_description_end_in_one_line(server, body, words):
    server.answer = lambda *_: (200, "application/json", body)
    for kind in ("arcgis", "ogcapi"):
        assert words in refusal(f"{kind}:{server.url}/rest/services/A/MapServer")


# --- OGC API - Tiles


def tiles_api(server, *, quad=True, own=True, **more):
    """Serve an API with two collections: images, and vectors of which no images can be had."""
    base = "/collections/ortho/map/tiles"
    limits = [
        ("3", 0, 7, 0, 7),
        ("4", 0, 15, 0, 15),
        ("17", 0, 131071, 0, 131071),
        ("18", 0, 262143, 0, 262143),
    ]
    sets = []
    if quad:
        sets.append(tileset(server.url, base, "WebMercatorQuad", MERCATOR_URI, limits=limits[2:] if more else limits))
    if own:
        sets.append(tileset(server.url, base, "UTM32", "http://www.opengis.net/def/crs/EPSG/0/25832", limits=[]))
    documents = {
        "/": landing(server.url),
        "/collections": {
            "collections": [
                collection(server.url, "ortho"),
                collection(server.url, "roads", kind="vector"),
            ]
        },
        "/collections/ortho": collection(server.url, "ortho"),
        base: {"tilesets": [{**one, "links": one["links"][:1]} for one in sets]},
        **{f"{base}/{one['tileMatrixSetURI'].rpartition('/')[2]}": one for one in sets},
        "/tileMatrixSets/UTM32": matrix_set(
            "UTM32",
            "http://www.opengis.net/def/crs/EPSG/0/25832",
            (-46_133.17, 6_301_219.54),
            [1222.992452562495 / 2**at for at in range(14)],
            span=2_000_000.0,
        ),
    }
    serve(server, documents, rf"{base}/WebMercatorQuad/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)")


@pytest.mark.parametrize(
    "path",
    [
        "/",
        "/collections",
        "/collections/ortho",
        "/collections/ortho/map/tiles",
        "/collections/ortho/map/tiles/WebMercatorQuad",
    ],
)
def test_tiles_are_found_from_every_document(server, path):
    tiles_api(server)
    source = open_source(f"ogcapi:{server.url}{path}")
    # Zooms follow each other from the finest on; below the gap of this server's limits nothing is used.
    assert (source.grid.min_zoom, source.grid.native_zoom, source.grid.tile_px) == (17, 18, 256)
    tile = source.fetch("", Window(17, 5 * 256, 7 * 256, 256, 256))
    assert (tile == patterns.positions("satellite", 17, 5, 7, 256)).all()
    # PNG, which tells ground without imagery.
    assert server.asked[-1] == "/collections/ortho/map/tiles/WebMercatorQuad/17/7/5?f=png"
    if path != "/collections/ortho/map/tiles" and not path.endswith("Quad"):
        found = service_entry(f"ogcapi:{server.url}{path}")
        assert found.attribution == "Survey of Somewhere"
        assert found.policy.licence == "CC BY 4.0"
        assert found.bounds_deg == (-90.2, 34.9, -89.6, 35.3)
    source.close()


def test_beyond_the_limits_of_an_api_there_is_no_imagery_and_no_request(server):
    quad = tileset(server.url, "/t", "WebMercatorQuad", MERCATOR_URI, limits=[("5", 6, 13, 4, 11)])
    serve(server, {"/t/WebMercatorQuad": quad}, r"/t/WebMercatorQuad/(?P<z>\d+)/(?P<y>\d+)/(?P<x>\d+)")
    source = open_source(f"ogcapi:{server.url}/t/WebMercatorQuad")
    tile = source.fetch("", Window(5, 11 * 256, 6 * 256, 256, 256))
    assert (tile == patterns.positions("satellite", 5, 11, 6, 256)).all()
    asked = len(server.asked)
    for column, row in ((12, 6), (11, 5), (3, 6), (4, 14)):
        with pytest.raises(PartError, match="beyond the tiles of"):
            source.fetch("", Window(5, column * 256, row * 256, 256, 256))
    assert len(server.asked) == asked
    source.close()


def test_own_system_of_an_api_is_taken_as_it_is(server):
    tiles_api(server)
    found = service_entry(f"ogcapi:{server.url}/collections/ortho", crs="EPSG:25832")
    grid = found.grid()
    assert grid.plane.crs == "EPSG:25832"
    # Level 13 has 1223 m / 2**13.
    assert grid.pixel_size(grid.native_zoom)[0] == pytest.approx(1222.992452562495 / 2**13, rel=1e-9)
    assert (grid.plane.west, grid.plane.north) == (-46_133.17, 6_301_219.54)
    assert "/UTM32/L13/4/9" in found.templates("")[""].url(grid.native_zoom, 9, 4)
    assert service_entry(f"ogcapi:{server.url}/collections/ortho#tilematrixset=UTM32").plane == found.plane


def test_collections_are_listed_where_one_is_to_be_chosen(server):
    tiles_api(server)
    found = found_service(f"{server.url}/collections", SourceOptions())
    assert found.kind == "ogcapi"
    assert [(one.name, one.title) for one in found.layers] == [("ortho", "Ortho")]
    assert named_source(f"{found.source.text}#collection=ortho").layers() is None
    assert "offers ortho" in refusal(f"ogcapi:{server.url}/#collection=nowhere")


@pytest.mark.parametrize(
    ("documents", "words"),
    [
        ({"/": {"links": []}}, "no tiles of images"),
        ({"/": {"links": "many"}}, "no tiles of images"),
        ({"/": {"links": [{"rel": "data", "href": "/"}]}}, "links to descriptions and no tiles"),
        ({"/": {"links": [{"rel": "data", "href": "file:///etc/passwd"}]}}, "http:// or https://"),
        ({"/": {"links": [{"rel": "data", "href": "/gone"}]}}, "404"),
        ({"/": {"collections": [{"id": 5}, None, {"id": "a"}]}}, "offers none"),
        (
            {"/": {"tilesets": [{"dataType": "vector", "links": [{"rel": "self", "href": "/x"}]}]}},
            "none of images",
        ),
        (
            {"/": {"links": [{"rel": "item", "type": "application/vnd.mapbox-vector-tile", "href": "/{tileMatrix}"}]}},
            "none of image/png",
        ),
        (
            {"/": {"links": [{"rel": "item", "type": "image/png", "href": "/{tileMatrix}"}]}},
            "which it does not describe",
        ),
        (
            {
                "/": {
                    "links": [
                        {"rel": "item", "type": "image/png", "href": "/{tileMatrix}/{tileRow}/{tileCol}"},
                        {"rel": f"{REL}tiling-scheme", "href": "/scheme"},
                    ]
                },
                "/scheme": {"id": "s", "crs": "EPSG:3857", "tileMatrices": [{"id": 1}] * 3},
            },
            "without matrices",
        ),
    ],
)
def test_apis_without_tiles_that_can_be_used_end_in_one_line(server, documents, words):
    serve(server, documents)
    assert words in refusal(f"ogcapi:{server.url}/")


def test_key_of_an_api_stays_with_its_server(server):
    """What links to another server gets no key, whatever they say."""
    base = "/collections/ortho/map/tiles"
    asked = []

    def checked(document):
        def answer(query):
            asked.append(query.get("API-KEY"))
            return answer_of(document)

        return answer

    elsewhere = server.url.replace("127.0.0.1", "localhost")
    quad = tileset(elsewhere, base, "WebMercatorQuad", MERCATOR_URI)
    serve(
        server,
        {
            "/collections/ortho": checked(collection(server.url, "ortho")),
            base: checked({"tilesets": [quad]}),
            f"{base}/WebMercatorQuad": checked(quad),
        },
    )
    found = service_entry(f"ogcapi:{server.url}/collections/ortho?api-key={{key}}", key="s3cret")
    assert asked == ["s3cret", "s3cret", None]
    assert "key" not in found.urls[""]
    assert found.key_env is None


# --- which kind


def test_kind_is_told_by_the_address_or_by_the_answer(server):
    map_base, api = "/gis/rest/services/A/MapServer", "/maps"
    wms = wms_document(
        "1.3.0",
        f"{server.url}/any",
        "<Layer><Title>A</Title><CRS>EPSG:3857</CRS><Layer><Name>a</Name><Title>A</Title></Layer></Layer>",
    )
    wmts = wmts_document(
        [wmts_layer("ortho", {"q": []})], [wmts_set("q", [wmts_matrix(str(zoom), zoom) for zoom in range(5)])]
    )

    def answer(path, query):
        if path == map_base:
            return answer_of(map_service())
        if path == api:
            return answer_of(landing(server.url))
        if path == "/collections":
            return answer_of({"collections": [collection(server.url, "ortho")]})
        if path == "/caps.xml":
            return 200, "text/xml", wmts
        if path == "/geoserver/ows":
            # Its answer to a bare address is a page.
            return (200, "text/xml", wms) if query.get("SERVICE") == "WMS" else (200, "text/html", b"<h1>Hello</h1>")
        return 200, "text/html", b"<title>Welcome</title>"

    server.answer = answer
    kinds = {
        f"{server.url}{map_base}": ("arcgis", None),
        f"{server.url}{api}": ("ogcapi", ["ortho"]),
        f"{server.url}/caps.xml": ("wmts", ["ortho"]),
        f"{server.url}/geoserver/ows": ("wms", ["a"]),
    }
    for address, (kind, names) in kinds.items():
        assert is_service_address(address)
        found = found_service(address, SourceOptions())
        assert found.kind == kind
        assert found.source.text == f"{kind}:{address}"
        assert (None if found.layers is None else [one.name for one in found.layers]) == names
    text = refusal(f"{server.url}/shop")
    assert "no service known here" in text
    assert "Welcome" in text


def test_names_and_addresses_are_told_apart():
    for text, is_service in (
        ("https://h.example/{z}/{x}/{y}.png", False),
        ("https://h.example/wms?key={key}", True),
        ("arcgis:https://h.example/rest/services", True),
        ("osm", False),
        ("/data/map.tif", False),
    ):
        assert is_service_address(text) == is_service
    assert source_kind("ogcapi:https://h.example/").is_service


# --- anything anywhere


class Documents:
    """A transport that answers with documents by their paths."""

    def __init__(self, documents):
        self.documents = documents

    def get(self, url, headers=None, *, origin=""):
        document = self.documents.get(urlsplit(url).path)
        if document is None:
            return Response(404, {}, b"")
        return Response(200, {"content-type": "application/json"}, json.dumps(document).encode())

    def close(self):
        """Nothing is held."""


def places(value, at=()):
    """Each place within a JSON value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inner:
        yield (*at, key)
        yield from places(one, (*at, key))


def with_other(document, place, value):
    """Copy of a JSON value with another value at a place."""
    made = json.loads(json.dumps(document))
    inner = made
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return made


@pytest.mark.parametrize("value", thinned(named([None, 10**40, "{key}\n", {"wkid": 4326}]), ("None", "{key}\n")))
def test_any_value_in_any_place_gives_an_entry_or_one_line(value):
    base, api = "/rest/services/A", "https://h.example"
    quad = tileset(api, "/t", "WebMercatorQuad", MERCATOR_URI, limits=[("3", 0, 7, 0, 7)])
    for kind, path, document in (
        ("arcgis", f"{base}/MapServer", map_service()),
        ("arcgis", f"{base}/ImageServer", image_service()),
        ("ogcapi", "/t/WebMercatorQuad", quad),
        ("ogcapi", "/c", {"collections": [collection(api, "a")]}),
    ):
        # Levels and links are many, and alike.
        some = [place for place in places(document) if all(key in (0, 1, 2) or key == str(key) for key in place)]
        for place in some:
            transport = Documents({path: with_other(document, place, value)})
            try:
                found = service_entry(f"{kind}:{api}{path}", transport=transport)
                found.grid()
                said = found.title + found.attribution
            except TerrAInavError as wrong:
                said = str(wrong)
            assert said
            assert "\n" not in said
