"""The coordinate reference system that is asked of a file, and what a dataset says of it."""

from __future__ import annotations

import json

import numpy as np
import pyproj
import pytest

gdal = pytest.importorskip("osgeo.gdal", reason="the tests make their rasters by GDAL's Python module")

from terrainav.core.capture.begun import BEGUN_FILE  # noqa: E402
from terrainav.core.capture.runner import capture  # noqa: E402
from terrainav.core.errors import InvalidInput, OutputError  # noqa: E402
from terrainav.core.imagery.opening import SourceOptions, named_source, open_source  # noqa: E402
from terrainav.core.mission.areas.area import Points  # noqa: E402
from terrainav.core.mission.mission import Mission  # noqa: E402
from terrainav.core.mission.plan import plan  # noqa: E402

from tests.support import rasters  # noqa: E402

LAT, LON = 35.15, -89.9
OWN = "EPSG:32616"


@pytest.fixture
def file(tmp_path):
    """An orthophoto of 0.5 m in UTM."""
    x, y = pyproj.Transformer.from_crs(4326, 32616, always_xy=True).transform(LON, LAT)
    values = np.random.default_rng(5).integers(0, 256, (3, 1000, 1000), np.uint8)
    rasters.write(tmp_path / "ortho.tif", values, (x - 250.0, 0.5, 0.0, y + 250.0, 0.0, -0.5), 32616)
    return str(tmp_path / "ortho.tif")


def captured(file, folder, crs="", **options):
    """Plan of a capture, and its mission's file."""
    mission = Mission(Points(((LAT, LON, 100.0),)), 100.0, source=file, crs=crs)
    source = open_source(file, crs=crs)
    worked_out = plan(mission, source.grid)
    capture(worked_out, source, folder, **options)
    source.close()
    return worked_out, folder / "mission.json"


def test_a_raster_has_its_own_system_and_the_map_s(file, tmp_path):
    own, stated = captured(file, tmp_path / "own")
    assert own.grid.plane.crs == OWN
    assert json.loads(stated.read_text())["imagery"]["crs"] == OWN
    by_name, same = captured(file, tmp_path / "named", OWN)
    assert same.read_bytes() == stated.read_bytes()
    assert by_name.names == own.names
    on_map, other = captured(file, tmp_path / "map", "EPSG:3857")
    assert on_map.grid.plane.wraps
    assert json.loads(other.read_text())["imagery"]["crs"] == "EPSG:3857"
    picture = gdal.Open(str(tmp_path / "map/satellite" / f"{on_map.names[0]}.tif"))
    assert picture.GetSpatialRef().GetAuthorityCode(None) == "3857"


def test_other_systems_name_those_there_are(file):
    with pytest.raises(InvalidInput) as refused:
        named_source(file, SourceOptions(crs="EPSG:2056")).grid  # noqa: B018
    assert refused.value.field == "crs"
    assert str(refused.value) == "coordinate reference system EPSG:2056: ortho.tif has EPSG:32616, EPSG:3857"


def test_degrees_become_the_map_s_pixels_only(tmp_path):
    values = np.zeros((3, 300, 300), np.uint8)
    rasters.write(tmp_path / "degrees.tif", values, (LON, 1e-5, 0.0, LAT, 0.0, -1e-5), 4326)
    named = str(tmp_path / "degrees.tif")
    assert named_source(named, SourceOptions(crs="EPSG:3857")).grid.plane.wraps
    with pytest.raises(InvalidInput, match=r"EPSG:4326: degrees\.tif has EPSG:3857$"):
        named_source(named, SourceOptions(crs="EPSG:4326")).grid  # noqa: B018


def test_a_system_without_a_code_is_stated_by_its_wkt_and_taken_again(tmp_path):
    local = pyproj.CRS("+proj=tmerc +lat_0=35 +lon_0=-89.9 +ellps=WGS84 +units=m")
    x, y = pyproj.Transformer.from_crs(4326, local, always_xy=True).transform(LON, LAT)
    path = tmp_path / "local.tif"
    values = np.random.default_rng(5).integers(0, 256, (3, 800, 800), np.uint8)
    rasters.write(path, values, (x - 200.0, 0.5, 0.0, y + 200.0, 0.0, -0.5), 32616)
    changed = gdal.Open(str(path), gdal.GA_Update)
    changed.SetProjection(local.to_wkt("WKT2_2019"))
    changed = None
    worked_out, stated = captured(str(path), tmp_path / "out")
    mission = Mission.load(stated)
    assert mission.imagery.crs == worked_out.grid.plane.crs
    source = open_source(str(path), crs=mission.imagery.crs)
    assert capture(plan(mission, source.grid), source, tmp_path / "out", resume=True).skipped == 1
    source.close()
    with pytest.raises(InvalidInput) as refused:
        named_source(str(path), SourceOptions(crs="EPSG:2056")).grid  # noqa: B018
    assert len(str(refused.value)) < 200


def test_a_folder_whose_mission_does_not_say_it_is_resumed_if_its_images_are_the_same(file, tmp_path):
    folder = tmp_path / "out"
    _, stated = captured(file, folder)
    text = json.loads(stated.read_text())
    del text["imagery"]["crs"]
    earlier = json.dumps(text)
    stated.write_text(earlier)
    # A version that did not state it kept no settings either.
    (folder / BEGUN_FILE).unlink()
    captured(file, folder, resume=True)
    assert stated.read_text() == earlier
    captured(file, folder, OWN, resume=True)
    (folder / BEGUN_FILE).unlink()
    with pytest.raises(OutputError, match="holds this mission with other images"):
        captured(file, folder, "EPSG:3857", resume=True)
    # Where it says it, the system is part of the mission.
    captured(file, tmp_path / "said")
    with pytest.raises(OutputError, match="holds another mission"):
        captured(file, tmp_path / "said", "EPSG:3857", resume=True)


@pytest.mark.parametrize("crs", ["A[]", 'PROJCS["nonsense"]', "PROJCS[" + 5000 * "x" + "]", 'X["' + 9000 * "y" + '"]'])
def test_what_only_looks_like_wkt_is_one_short_line(file, crs):
    with pytest.raises(InvalidInput, match=r"ortho\.tif has EPSG:32616, EPSG:3857") as refused:
        named_source(file, SourceOptions(crs=crs)).grid  # noqa: B018
    assert len(str(refused.value)) < 200


@pytest.mark.parametrize(
    "crs",
    [
        "A[" + 30_000 * "x" + "]",
        "2056",
        "epsg:2056",
        "EPSG:",
        "EPSG:2056 ",
        " ",
        "EPSG:20560000",
        "x[1]",
        "A[\n]",
    ],
)
def test_texts_that_name_no_system(crs):
    with pytest.raises(InvalidInput) as refused:
        Mission(Points(((LAT, LON, 100.0),)), 100.0, crs=crs)
    assert refused.value.field == "crs"
    assert "such as EPSG:2056" in str(refused.value)
