"""What refusals of sources of imagery advise, against files and servers on the loopback."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from functools import partial

import numpy as np
import pytest
from terrainav.core.elevation.filling import interpolated
from terrainav.core.imagery import catalogue as user_sources
from terrainav.core.imagery.cache.tile_cache import TileCache
from terrainav.core.imagery.catalogue import entry_named
from terrainav.core.imagery.entry import Dates
from terrainav.core.imagery.http import client as clients
from terrainav.core.imagery.http.transport import Response
from terrainav.core.imagery.opening import named_source, open_source, source_kind
from terrainav.core.imagery.policy import Policy
from terrainav.core.imagery.raster import reading as raster_files
from terrainav.core.imagery.raster import sizes, trust
from terrainav.core.imagery.raster.source import open_raster
from terrainav.core.imagery.source import Window
from terrainav.core.imagery.staticmap import StaticMapSource
from terrainav.core.imagery.tiles import check_address
from terrainav.core.imagery.xyz import XYZSource
from terrainav.core.limits import MAX_RASTER_BANDS

from tests.core.remedies.files import extra_brings
from tests.support.ranges import RangeServer
from tests.support.remedies import Case, remedy
from tests.support.services import ServiceServer, matrix, matrix_set, wmts_document, wmts_layer

TEMPLATE = "https://h.example/{z}/{x}/{y}.png"


def opened(name, **options):
    open_source(name, **options).close()


@remedy("imagery/cache/tile_cache.py", "cache of {} bytes: must be 1 or more; leave the cache out for none")
def _no_cache(case: Case) -> None:
    case.refused(lambda: TileCache(case.tmp_path, 0))
    case.follow("leave the cache out for none", lambda: opened(TEMPLATE, cache=None))


@remedy("imagery/entry.py", "date {}: must be one the server takes; say which (--date)")
def _any_date(case: Case) -> None:
    dates = Dates("any")
    case.refused(lambda: dates.checked(""))
    case.follow("say which (--date)", lambda: dates.checked("2020") == "2020")


@remedy("imagery/entry.py", "{}: has imagery of several dates; say which (--date)")
def _several_dates(case: Case) -> None:
    dated = "https://h.example/{date}/{z}/{x}/{y}.png"
    case.refused(lambda: opened(dated))
    case.follow("say which (--date)", lambda: opened(dated, date="2020"))


def own(case: Case, name, folder="config"):
    return user_sources.add(name, user_sources.described(TEMPLATE), case.tmp_path / folder)


@remedy("imagery/catalogue.py", "source name {}: is one of the catalogue's; choose another")
def _of_the_catalogue(case: Case) -> None:
    case.refused(lambda: own(case, "usgs"))
    case.follow("choose another", lambda: own(case, "usgs-mine"))
    # The same of a file that somebody has written.
    case.monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(case.tmp_path / "config"))
    path = case.tmp_path / "config" / user_sources.FILE
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("usgs-mine", "usgs"), encoding="utf-8")
    case.says(user_sources.shelf().problems["usgs"])
    path.write_text(text, encoding="utf-8")
    assert not user_sources.shelf().problems


@remedy(
    "imagery/catalogue.py",
    "source name {}: is taken; choose another, or `terrainav sources remove` it",
)
def _taken(case: Case) -> None:
    own(case, "mine")
    case.refused(lambda: own(case, "mine"))
    case.follow("choose another", lambda: own(case, "yours"))

    def removed():
        assert case.run("sources", "remove", "mine").returncode == 0
        own(case, "mine")

    case.follow("terrainav sources remove` it", removed)


@remedy(
    "imagery/catalogue.py",
    "source {} is unknown: {}`terrainav sources` lists the names; a file, a URL template with {z}, {x}, "
    "{y}, and wmts:URL, wms:URL, arcgis:URL and ogcapi:URL work as well",
)
def _unknown(case: Case) -> None:
    case.refused(lambda: entry_named("usgz"))
    case.follow("did you mean usgs?", lambda: entry_named("usgs"))
    listed = case.run("sources").stdout
    assert "usgs " in listed
    with one_layer() as server:
        others = (raster(case), TEMPLATE, f"wmts:{server.url}/c.xml")
        case.follow(
            "terrainav sources` lists the names; a file, a URL template with {z}, {x}, {y}, and wmts:URL, wms:URL, "
            "arcgis:URL and ogcapi:URL work as well",
            lambda: [opened(str(name)) for name in ("usgs", *others)],
        )


@remedy("imagery/catalogue.py", "source {}: several have this title; name one of {}")
def _title_of_several(case: Case) -> None:
    case.monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(case.tmp_path))
    for name in ("one", "two"):
        user_sources.add(name, {**user_sources.described(TEMPLATE), "title": "My tiles"})
    case.refused(lambda: entry_named("my tiles"))
    case.follow("name one of one, two", lambda: [entry_named(name) for name in ("one", "two")])


class Answers:
    """A transport that gives one answer after the other, the last one for ever."""

    def __init__(self, *answers):
        self.answers = list(answers)

    def get(self, url, headers=None, cancelled=None):
        return self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]

    def close(self):
        """Hold nothing."""


BUSY, DONE = Response(429, {}, b""), Response(200, {"content-type": "text/plain"}, b"here")


@remedy("imagery/http/client.py", "{}: {}; ask for less at a time, or resume later")
def _too_many_requests(case: Case) -> None:
    asked = clients.Client(Answers(BUSY), "P", first_wait_s=0.0, tries=2)
    case.refused(lambda: asked.get("u", "w"))
    # A server that takes one request, and one that has got over it.
    fewer = clients.Client(Answers(DONE, BUSY), "P", first_wait_s=0.0, tries=1)
    case.follow("ask for less at a time", lambda: fewer.get("u", "w").body == b"here")
    asked._transport.answers[:] = [DONE]
    case.follow("resume later", lambda: asked.get("u", "w").body == b"here")


@remedy("imagery/http/client.py", "{}: {}; it asks to come back in {} s: resume then")
def _come_back(case: Case) -> None:
    asked = clients.Client(Answers(Response(503, {"retry-after": "3600"}, b"")), "P", first_wait_s=0.0)
    case.refused(lambda: asked.get("u", "w"))
    asked._transport.answers[:] = [DONE]
    case.follow("resume then", lambda: asked.get("u", "w").body == b"here")


@remedy("imagery/opening.py", "{}: needs an API key: set the environment variable {}")
def _key(case: Case) -> None:
    for name in ("TERRAINAV_KEY", "TERRAINAV_MAPBOX_KEY"):
        case.monkeypatch.delenv(name, raising=False)
    text = case.refused(lambda: opened("mapbox-satellite"))
    variable = text.rpartition(" ")[2]
    case.monkeypatch.setenv(variable, "a-key")
    case.follow(f"set the environment variable {variable}", lambda: opened("mapbox-satellite"))


@remedy(
    "imagery/opening.py",
    "source {}: is a map of QGIS and can be captured inside QGIS only; name a file, a URL template or a "
    "name of the "
    "catalogue",
)
def _of_qgis(case: Case) -> None:
    case.refused(lambda: open_source("qgis:project"))
    case.follow("name a file", lambda: opened(str(raster(case))))
    case.follow("a URL template", lambda: opened(TEMPLATE))
    case.follow("a name of the catalogue", lambda: opened("usgs"))


@remedy("imagery/opening.py", "source {}: a file states no terms; name one of the sources that have some")
def _no_terms(case: Case) -> None:
    case.refused(lambda: named_source("ortho.tif").entry)
    case.follow("name one of the sources that have some", lambda: bool(named_source("usgs").entry.policy.terms))


ASKS = Policy(bulk_allowed="ask", max_tiles=10, terms="Ask first.")
NEVER = Policy(bulk_allowed="no", max_tiles=10, terms="Never.")


@remedy("imagery/policy.py", "take another source")
def _another_source(case: Case) -> None:
    case.refused(lambda: NEVER.check("S", 11))
    case.follow("take another source", lambda: Policy().check("T", 11))


@remedy("imagery/policy.py", "agree to the terms first (--accept-terms)")
def _agree(case: Case) -> None:
    case.refused(lambda: ASKS.check("S", 11))
    case.follow("agree to the terms first (--accept-terms)", lambda: ASKS.check("S", 11, accept_terms=True))


@remedy("imagery/policy.py", "bulk_allowed {} without max_tiles: say how many are no bulk")
def _no_bulk(case: Case) -> None:
    case.refused(lambda: Policy(bulk_allowed="ask"))
    case.follow("say how many are no bulk", lambda: Policy(bulk_allowed="ask", max_tiles=10))


# --- rasters

ON_GRID = (0.0, 1.0, 0.0, 6_000_000.0, 0.0, -1.0)
PART = Window(15, 128 * 32768, 128 * 22956, 64, 64)


def raster(case: Case, name="r.tif", *, geotransform=ON_GRID, epsg=3857, kind=None, bands=3, size=64):
    gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")
    from tests.support import rasters

    values = np.random.default_rng(4).integers(1, 255, (bands, size, size), np.uint8)
    more = {} if kind is None else {"data_type": getattr(gdal, kind)}
    return rasters.write(case.tmp_path / name, values, geotransform, epsg, **more)


def read(path, **options):
    open_raster(path, **options).close()


@remedy(
    "imagery/raster/colours.py",
    "values of band {} are {}, but JPEG and PNG have 8 bits; choose how they become 8 bits (--stretch), such as "
    "percentile, or write GeoTIFF (--format)",
)
def _deep(case: Case) -> None:
    path = raster(case, kind="GDT_UInt16")
    case.refused(lambda: read(path))
    case.follow(
        "choose how they become 8 bits (--stretch), such as percentile",
        lambda: read(path, stretch="percentile"),
    )
    case.follow("write GeoTIFF (--format)", lambda: read(path, as_stored=True))


@remedy(
    "imagery/raster/colours.py",
    "{} bands: JPEG and PNG have one or three; name so many, or write GeoTIFF (--format)",
)
def _two_bands(case: Case) -> None:
    path = raster(case)
    case.refused(lambda: read(path, bands=("1", "2")))
    case.follow("name so many", lambda: (read(path, bands=("1",)), read(path, bands=("3", "1", "2"))))
    case.follow("write GeoTIFF (--format)", lambda: read(path, bands=("1", "2"), as_stored=True))


@remedy("imagery/raster/source.py", "{}: say which date")
def _date_of_vsi(case: Case) -> None:
    raster(case, "a_20200101.tif")
    path = f"/vsisubfile/0_{(case.tmp_path / 'a_20200101.tif').stat().st_size},{case.tmp_path}/a_{{date}}.tif"
    case.refused(lambda: read(path))
    case.follow("say which date", lambda: read(path.replace("{date}", "20200101"), date="20200101"))


@remedy("imagery/raster/source.py", "say which date")
def _date_of_files(case: Case) -> None:
    raster(case, "a_20200101.tif")
    path = case.tmp_path / "a_{date}.tif"
    case.refused(lambda: read(path))
    case.follow("say which date", lambda: read(path, date="2020-01-01"))


@contextmanager
def _without_gdal(case: Case) -> Iterator[None]:
    real = importlib.util.find_spec
    with case.monkeypatch.context() as without:
        without.setattr(
            importlib.util,
            "find_spec",
            lambda name, *rest: None if name in ("rasterio", "osgeo") else real(name, *rest),
        )
        without.setitem(sys.modules, "qgis", sys)
        yield


@remedy(
    "elevation/filling.py",
    "missing heights: are interpolated by GDAL, which is not there: pip install terrainav[raster]",
)
def _not_interpolated(case: Case) -> None:
    holed = np.ones((5, 5), np.float32)
    holed[2, 2] = np.nan
    with _without_gdal(case):
        case.refused(lambda: interpolated(holed))
    case.follow("pip install terrainav[raster]", lambda: extra_brings("raster", "rasterio"))
    assert np.isfinite(interpolated(holed)).all()


@remedy("imagery/raster/reading.py", "raster files need rasterio: pip install terrainav[raster]")
def _no_rasterio(case: Case) -> None:
    with _without_gdal(case):
        case.refused(raster_files.opener)
    case.follow("pip install terrainav[raster]", lambda: extra_brings("raster", "rasterio"))
    raster_files.opener()


@remedy(
    "imagery/raster/georeference.py",
    "it states no coordinate reference system: say which, for example with gdal_edit.py -a_srs EPSG:32632",
)
def _no_crs(case: Case) -> None:
    _place_by_crs(case, None)


@remedy(
    "imagery/raster/georeference.py",
    "its coordinate reference system, {}, is not one of maps: say which, for example with gdal_edit.py -a_srs "
    "EPSG:32632",
)
def _no_map(case: Case) -> None:
    _place_by_crs(case, 4978)


def _place_by_crs(case: Case, epsg: int | None) -> None:
    path = raster(case, epsg=epsg, geotransform=(505_000.0, 2.0, 0.0, 5_317_000.0, 0.0, -2.0))
    case.refused(lambda: read(path))
    from osgeo import gdal

    def edited():
        # What gdal_edit.py does.
        gdal.Translate(str(case.tmp_path / "placed.tif"), str(path), options="-a_srs EPSG:32632").FlushCache()
        read(case.tmp_path / "placed.tif")

    case.follow("say which, for example with gdal_edit.py -a_srs EPSG:32632", edited)


@remedy(
    "imagery/raster/georeference.py",
    "only ground control points place it: make a map of it first, with gdalwarp",
)
def _by_points(case: Case) -> None:
    path = raster(case, "points.tif", geotransform=None, epsg=None)
    from osgeo import gdal, osr

    system = osr.SpatialReference()
    system.ImportFromEPSG(4326)
    placed = gdal.Open(str(path), gdal.GA_Update)
    corners = [gdal.GCP(9.0 + x / 1e3, 48.0 - y / 1e3, 0.0, x, y) for x in (0, 64) for y in (0, 64)]
    placed.SetGCPs(corners, system.ExportToWkt())
    del placed
    case.refused(lambda: read(path))

    def warped():
        gdal.Warp(str(case.tmp_path / "map.tif"), str(path)).FlushCache()
        read(case.tmp_path / "map.tif")

    case.follow("make a map of it first, with gdalwarp", warped)


@remedy("imagery/raster/source.py", "name one of those within, such as {}")
def _within(case: Case) -> None:
    from osgeo import gdal

    path = case.tmp_path / "several.gpkg"
    first, second = raster(case, "a.tif"), raster(case, "b.tif")
    for name, one, more in (("a", first, ()), ("b", second, ("APPEND_SUBDATASET=YES",))):
        options = [f"RASTER_TABLE={name}", *more]
        gdal.Translate(str(path), str(one), format="GPKG", creationOptions=options).FlushCache()
    text = case.refused(lambda: read(path))
    named = text.rpartition("such as ")[2]
    case.follow(f"name one of those within, such as {named}", lambda: opened(named))
    assert not any(source_kind(name).is_file for name in ("GPKG:not.there:a", "Mine:a", "WMS:https://h/wms"))


@remedy(
    "imagery/raster/source.py",
    "{}: a part of zoom {} covers {}x{} px of it, which are too many; give it overviews, with gdaladdo",
)
def _no_overviews(case: Case) -> None:
    from osgeo import gdal

    path = raster(case, "large.tif", size=4200, bands=1)
    # As large as the parts of a turned raster become.
    far = Window(14, 64 * 32768, 64 * 22956, 512, 512)

    def fetched():
        with closing(open_raster(path, own_pixels=False)) as source:
            source.fetch("", far)

    case.refused(fetched)

    def with_overviews():
        opened = gdal.Open(str(path), gdal.GA_Update)
        opened.BuildOverviews("NEAREST", [2])
        del opened
        fetched()

    case.follow("give it overviews, with gdaladdo", with_overviews)


@remedy("imagery/raster/source.py", "{}: is a folder; name a raster file")
def _folder(case: Case) -> None:
    path = raster(case)
    case.refused(lambda: read(case.tmp_path))
    case.follow("name a raster file", lambda: read(path))


@remedy("imagery/raster/source.py", "{}: has changed since it was opened; start anew")
def _changed(case: Case) -> None:
    path = raster(case)
    with closing(open_raster(path, own_pixels=False)) as source:
        source.fetch("", PART)
        path.unlink()
        raster(case, size=32)
        case.refused(lambda: source.fetch("", PART))

    def anew():
        with closing(open_raster(path, own_pixels=False)) as source:
            source.fetch("", PART)

    case.follow("start anew", anew)


# --- services

QUAD = matrix_set("GoogleMapsCompatible", [matrix(str(zoom), zoom) for zoom in range(19)])


def one_layer(*names):
    server = ServiceServer()
    layers = [wmts_layer(name, {"GoogleMapsCompatible": []}) for name in names or ("ortho",)]
    server.answer = lambda *_: (200, "text/xml", wmts_document(layers, [QUAD], get_tile=server.url))
    pytest.importorskip("owslib")
    return server


@remedy("imagery/services/capabilities.py", "the capabilities at this address are of a {}: write {}:URL")
def _other_service(case: Case) -> None:
    with one_layer() as server:
        case.refused(lambda: opened(f"wms:{server.url}/c.xml"))
        case.follow("write wmts:URL", lambda: opened(f"wmts:{server.url}/c.xml"))


@remedy(
    "imagery/services/capabilities.py",
    "{} of {}: say which with #{}=…: {}; `terrainav sources show` lists them",
)
def _which_layer(case: Case) -> None:
    with one_layer("ortho", "topo") as server:
        name = f"wmts:{server.url}/c.xml"
        case.refused(lambda: opened(name))
        case.follow("say which with #layer=…: ortho, topo", lambda: opened(f"{name}#layer=topo"))
        listed = case.run("sources", "show", name).stdout
        case.follow("`terrainav sources show` lists them", lambda: "ortho" in listed and "topo" in listed)


@remedy("imagery/services/service.py", "{}: needs an API key: set the environment variable {}")
def _key_of_service(case: Case) -> None:
    case.monkeypatch.delenv("TERRAINAV_KEY", raising=False)
    with one_layer() as server:
        name = f"wmts:{server.url}/c.xml?apikey={{key}}"
        case.refused(lambda: opened(name))
        case.monkeypatch.setenv("TERRAINAV_KEY", "s3cret")
        case.follow("set the environment variable TERRAINAV_KEY", lambda: opened(name, named_by_user=True))


@remedy("imagery/raster/source.py", "{}: needs an API key: set the environment variable {}")
def _key_of_raster(case: Case) -> None:
    case.monkeypatch.delenv("TERRAINAV_KEY", raising=False)
    with RangeServer() as server:
        server.files["/r.tif"] = raster(case).read_bytes(), '"one"'
        name = f"{server.url}/r.tif?sig={{key}}"
        case.refused(lambda: opened(name))
        case.monkeypatch.setenv("TERRAINAV_KEY", "s3cret")
        case.follow("set the environment variable TERRAINAV_KEY", lambda: opened(name, named_by_user=True))


@remedy("imagery/services/capabilities.py", "source {}:{}: needs OWSLib: pip install owslib")
def _no_owslib(case: Case) -> None:
    with one_layer() as server:
        with case.monkeypatch.context() as without:
            for name in [name for name in sys.modules if name.partition(".")[0] == "owslib"]:
                without.delitem(sys.modules, name)
            without.setitem(sys.modules, "owslib", None)
            case.refused(lambda: opened(f"wmts:{server.url}/c.xml"))
        # It is what pip installs under that name.
        assert importlib.util.find_spec("owslib") is not None
        case.follow("pip install owslib", lambda: opened(f"wmts:{server.url}/c.xml"))


@remedy(
    "imagery/staticmap.py",
    "{}: its centre {} has more than {} decimals, which {} drops; plan with this source's grid",
)
def _decimals(case: Case) -> None:
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.mission.areas.area import Points
    from terrainav.core.mission.mission import Mission
    from terrainav.core.mission.plan import plan
    from terrainav.core.picture.map_frame import capture_window

    mission = Mission(Points(((35.135, -89.861, 120.0),)), 120.0, frame="map", max_px=640)
    with closing(StaticMapSource("a-key")) as source:
        case.refused(lambda: source.centre(capture_window(plan(mission, PixelGrid()), 0)))
        case.follow(
            "plan with this source's grid",
            lambda: source.centre(capture_window(plan(mission, source.grid), 0)),
        )


@remedy(
    "imagery/tiles.py",
    "{} for {}: holds a key in {}, which would end up in files; write {}={key} and set TERRAINAV_KEY",
)
def _key_in_url(case: Case) -> None:
    url = TEMPLATE + "?apikey="
    case.refused(lambda: check_address(url + "s3cret", "URL template"))
    check_address(url + "{key}", "URL template")
    case.monkeypatch.setenv("TERRAINAV_KEY", "s3cret")
    case.follow("write apikey={key}", lambda: opened(url + "{key}", named_by_user=True))
    case.follow("set TERRAINAV_KEY", lambda: opened(url + "{key}", named_by_user=True))


@remedy("imagery/xyz.py", "source {}: its URL has a {date}; say which")
def _date_of_url(case: Case) -> None:
    from terrainav.core.geodesy.mercator import PixelGrid
    from terrainav.core.imagery.tiles import Template

    templates = {"": Template("https://h.example/{date}/{z}/{x}/{y}.png")}

    def made(**options):
        XYZSource(templates, grid=PixelGrid(), **options).close()

    case.refused(made)
    case.follow("say which", partial(made, date="2020"))


@remedy(
    "world/source.py",
    "CRS {}: the synthetic world has {}; choose EPSG:3413 around the North Pole, EPSG:3031 around the South Pole, or "
    "none elsewhere",
)
def _no_such_chart(case: Case) -> None:
    case.refused(lambda: opened("world", crs="EPSG:32661"))
    case.follow("choose EPSG:3413 around the North Pole", lambda: opened("world", crs="EPSG:3413"))
    case.follow("EPSG:3031 around the South Pole", lambda: opened("world", crs="EPSG:3031"))
    case.follow("none elsewhere", lambda: opened("world", crs=""))


@remedy("imagery/raster/remote.py", "{}: has changed since it was opened; start anew")
def _remote_changed(case: Case) -> None:
    body = raster(case).read_bytes()
    with RangeServer() as server:
        server.files["/r.tif"] = body, '"one"'
        with closing(open_raster(f"{server.url}/r.tif", own_pixels=False)) as source:
            server.files["/r.tif"] = body + b"more", '"two"'
            case.refused(lambda: source._pool.remote.check(anew=True))
        case.follow("start anew", lambda: read(f"{server.url}/r.tif"))


@remedy(
    "imagery/raster/remote.py",
    "{}: its server sends whole files only, and a raster is read in parts (HTTP Range); "
    "name a copy of it on this machine",
)
def _whole_files_only(case: Case) -> None:
    path = raster(case)
    with RangeServer() as server:
        server.files["/r.tif"], server.sends_parts = (path.read_bytes(), '"one"'), False
        case.refused(lambda: read(f"{server.url}/r.tif"))
    case.follow("name a copy of it on this machine", lambda: read(path))


@remedy(
    "imagery/raster/trust.py",
    "is of a format that is read from folders of this machine alone; name a copy of it, unpacked and on this machine",
)
def _whole_formats(case: Case) -> None:
    import zipfile

    from osgeo import gdal

    path = case.tmp_path / "r.img"
    gdal.Translate(str(path), str(raster(case)), format="HFA").FlushCache()
    with zipfile.ZipFile(case.tmp_path / "r.zip", "w") as packed:
        packed.write(path, "r.img")
    case.refused(lambda: read(f"/vsizip/{case.tmp_path}/r.zip/r.img"))
    case.follow("name a copy of it, unpacked and on this machine", lambda: read(path))


def _made_by_gdal(case: Case, path, *words, name="less.tif"):
    """What ``gdal_translate`` makes of a file with these words."""
    from osgeo import gdal

    target = case.tmp_path / name
    gdal.Translate(str(target), str(path), options=list(words)).FlushCache()
    return target


@remedy(
    "imagery/raster/sizes.py",
    "has {} bands: must be at most {}; make a copy of those that you need, with gdal_translate -b",
)
def _too_many_bands(case: Case) -> None:
    path = raster(case, bands=MAX_RASTER_BANDS + 1, size=1)
    case.refused(lambda: read(path))
    case.follow(
        "make a copy of those that you need, with gdal_translate -b",
        lambda: read(_made_by_gdal(case, path, "-b", "1", "-b", "2", "-b", "3")),
    )


@remedy(
    "imagery/raster/sizes.py",
    "has {} overviews: must be at most {}; make a copy without them, with gdal_translate",
)
def _too_many_overviews(case: Case) -> None:
    path = raster(case)
    case.monkeypatch.setattr(sizes, "MAX_RASTER_OVERVIEWS", 1)
    from osgeo import gdal

    gdal.Open(str(path), gdal.GA_Update).BuildOverviews("NEAREST", [2, 4])
    case.refused(lambda: read(path))
    case.follow("make a copy without them, with gdal_translate", lambda: read(_made_by_gdal(case, path)))


@remedy(
    "imagery/raster/sizes.py",
    "is decoded in blocks of {}x{} px, {} MB each: must be at most {} MB; "
    "make a copy in tiles, with gdal_translate -co TILED=YES",
)
def _large_blocks(case: Case) -> None:
    path = raster(case, size=1024)
    case.monkeypatch.setattr(sizes, "MAX_RASTER_BLOCK_BYTES", 1 << 18)
    from osgeo import gdal

    strip = _made_by_gdal(case, path, "-co", "COMPRESS=LZW", "-co", "BLOCKYSIZE=1024", name="s.tif")
    assert gdal.Open(str(strip)).GetRasterBand(1).GetBlockSize() == [1024, 1024]
    case.refused(lambda: read(strip))
    case.follow(
        "make a copy in tiles, with gdal_translate -co TILED=YES",
        lambda: read(_made_by_gdal(case, strip, "-co", "TILED=YES")),
    )


@remedy(
    "imagery/raster/sizes.py",
    "{} has more than {} directories; make a copy of its first image, with gdal_translate",
)
def _many_directories(case: Case) -> None:
    path = raster(case)
    case.monkeypatch.setattr(sizes, "MAX_TIFF_DIRECTORIES", 1)
    from osgeo import gdal

    gdal.Open(str(path), gdal.GA_Update).BuildOverviews("NEAREST", [2, 4])
    case.refused(lambda: read(path))
    case.follow("make a copy of its first image, with gdal_translate", lambda: read(_made_by_gdal(case, path)))


@remedy(
    "imagery/raster/trust.py",
    "{} reads files more than {} times; make one raster of it, with gdal_translate",
)
def _many_sources(case: Case) -> None:
    from osgeo import gdal

    path = case.tmp_path / "m.vrt"
    gdal.BuildVRT(str(path), [str(raster(case))]).FlushCache()
    case.monkeypatch.setattr(trust, "MAX_VRT_SOURCES", 2)
    case.refused(lambda: read(path))
    case.follow("make one raster of it, with gdal_translate", lambda: read(_made_by_gdal(case, path)))
