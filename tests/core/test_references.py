"""Coordinate reference systems of others: no definition has PROJ open a file, and each harmless one is taken."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyproj
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.reference import check_reference, file_named, read_reference

from tests.support.growth import PROPORTIONAL, growth

#: What stands for the file in the definitions below.
FILE = "{file}"
_WGS84 = (
    'GEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]],'
    'CS[ellipsoidal,2],AXIS["lat",north],AXIS["lon",east],ANGLEUNIT["degree",0.0174532925199433],ID["EPSG",4326]]'
)
_OLD = (
    'PROJCS["x",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]DATUM],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
    'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],'
    'PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]END]'
)
_NEW = (
    'PROJCRS["x",BASEGEOGCRS["WGS 84",DATUM["World Geodetic System 1984",ELLIPSOID["WGS 84",6378137,298.257223563]]],'
    'CONVERSION["c",METHOD["{method}"]],CS[Cartesian,2],AXIS["e",east],AXIS["n",north],LENGTHUNIT["metre",1]]'
)


def _old(datum="", end=""):
    return _OLD.replace("DATUM]", f"{datum}]").replace("END]", f"{end}]")


def _new(method):
    return _NEW.replace("{method}", method)


def _json_of(kind):
    crs = pyproj.CRS.from_epsg(25832).to_json_dict()
    if kind == "value":
        crs["conversion"]["parameters"].append({"name": "grid", "value": "FILE"})
    else:
        crs = pyproj.CRS.from_user_input("EPSG:4326+5773").to_json_dict()
        crs["components"][1]["geoid_model"] = {"name": "PROJ FILE"}
    import json

    # Escaped, as no search for words finds it.
    return json.dumps(crs).replace("geoid_model", "geoid\\u005fmodel").replace("FILE", FILE)


HOSTILE = {
    "nadgrids": f"+proj=utm +zone=32 +ellps=bessel +nadgrids={FILE} +type=crs",
    "behind the end of a word": _new(f'PROJ hgridshift grids=@null"",{FILE}'),
    "behind a grid of zeros": f"+proj=utm +zone=32 +ellps=bessel +nadgrids=@null,{FILE} +type=crs",
    "geoidgrids": f"+proj=utm +zone=32 +ellps=bessel +geoidgrids={FILE} +type=crs",
    "init": f"+init={FILE}:x",
    "init of a projection": f"+proj=utm +zone=32 +init={FILE}:x +type=crs",
    "a shift of grids": f"+proj=hgridshift +grids={FILE} +type=crs",
    "a pipeline": f"+proj=pipeline +step +proj=utm +zone=32 +step +proj=vgridshift +grids={FILE}",
    "a triangulation": f"+proj=tinshift +file={FILE} +type=crs",
    "a deformation model": f"+proj=defmodel +model={FILE} +type=crs",
    "PROJ4_GRIDS": _old(datum=f',EXTENSION["PROJ4_GRIDS","{FILE}"]'),
    "PROJ4 nadgrids": _old(end=f',EXTENSION["PROJ4","+proj=utm +zone=32 +ellps=bessel +nadgrids={FILE}"]'),
    "PROJ4 init": _old(end=f',EXTENSION["PROJ4","+proj=utm +zone=32 +init={FILE}:x"]'),
    "PROJ4 of a shift": _old(end=f',EXTENSION["PROJ4","+proj=hgridshift +grids={FILE}"]'),
    "a method of PROJ": _new(f"PROJ hgridshift grids={FILE}"),
    "a method with init": _new(f"PROJ utm zone=32 init={FILE}:x"),
    "a method by its text": _new(f"PROJ-based operation method: +proj=hgridshift +grids={FILE}"),
    "a remark": _new("PROJ utm zone=32")[:-1] + f',REMARK["PROJ CRS string: +proj=utm +nadgrids={FILE}"]]',
    "a geoid model": f'COMPOUNDCRS["x",{_WGS84},VERTCRS["v",VDATUM["v"],CS[vertical,1],AXIS["h",up],'
    f'LENGTHUNIT["metre",1],GEOIDMODEL["PROJ {FILE}"]]]',
    "printed quotes": f'VERTCRS["v",VDATUM["v"],CS[vertical,1],AXIS["h",up],GEOIDMODEL[“PROJ {FILE}”]]',
    "heights": f'COMPD_CS["x",{_WGS84},VERT_CS["EGM96 height",VERT_DATUM["EGM96 geoid",2005,'
    f'EXTENSION["PROJ4_GRIDS","{FILE}"]],UNIT["m",1.0],AXIS["h",UP],AUTHORITY["EPSG","5773"]]]',
    "a bound system": f'BOUNDCRS[SOURCECRS[{_WGS84}],TARGETCRS[{_WGS84}],ABRIDGEDTRANSFORMATION["t",METHOD["NTv2",'
    f'ID["EPSG",9615]],PARAMETERFILE["Latitude and longitude difference file","{FILE}",ID["EPSG",8656]]]]',
    "JSON": _json_of("value"),
    "a geoid model in JSON": _json_of("model"),
}
#: As HOSTILE, in a process of its own: none may wait for a pipe, or leave a trace of having opened it.
_TRIED = """
import sys
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.geodesy.vertical import vertical_crs
for text in sys.stdin.read().split(chr(0)):
    for read in (lambda: ProjectedPlane(text, 0.0, 0.0, 1.0, 1.0).to_crs([50.0], [9.0]), lambda: vertical_crs(text)):
        try:
            read()
        except InvalidInput as refused:
            assert "\\n" not in str(refused)
        else:
            sys.exit(text)
print("all refused")
"""


@pytest.mark.parametrize("kind", HOSTILE)
def test_each_way_to_name_a_file_is_refused_by_its_name(kind, tmp_path):
    path = tmp_path / "up.gtx"
    with pytest.raises(InvalidInput, match=r"must be a code such as EPSG:25832, or WKT") as refused:
        check_reference(HOSTILE[kind].replace(FILE, str(path)))
    assert kind == "behind the end of a word" or str(path) in str(refused.value)


def test_no_pipe_is_waited_for_and_no_server_asked(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    texts = [text.replace(FILE, name) for text in HOSTILE.values() for name in (str(pipe), "http://[::1]:9/x")]
    done = subprocess.run(
        [sys.executable, "-c", _TRIED],
        input="\0".join(texts),
        capture_output=True,
        text=True,
        timeout=120,
        cwd=tmp_path,
        env={**os.environ, "PROJ_NETWORK": "ON"},
        check=False,
    )
    assert (done.stdout.strip(), done.stderr) == ("all refused", "")


@pytest.mark.parametrize(
    "code", ["EPSG:31467", "EPSG:27700", "EPSG:2053", "EPSG:5513", "EPSG:31370", "EPSG:3857", "ESRI:54030"]
)
def test_codes_and_what_programs_write_of_them_are_the_same_system(code):
    crs = pyproj.CRS.from_user_input(code)
    ways = [crs.to_wkt(), crs.to_json(), code.lower()]
    # WKT 1 has no word for axes of Krovak's that point south and west.
    ways += [crs.to_wkt("WKT1_GDAL")] if code != "EPSG:5513" else []
    there = ProjectedPlane(code, 0.0, 0.0, 1.0, 1.0).to_crs(np.array([50.1]), np.array([9.2]))
    for text in ways:
        assert file_named(text) == ""
        assert ProjectedPlane(text, 0.0, 0.0, 1.0, 1.0).to_crs(np.array([50.1]), np.array([9.2])) == there
    wanted = pyproj.Transformer.from_crs(4326, crs, always_xy=True).transform(9.2, 50.1)
    assert np.ravel(there) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize(
    "text",
    [
        "urn:ogc:def:crs:EPSG::25832",
        "http://www.opengis.net/def/crs/EPSG/0/4326",
        "EPSG:4326+5773",
        "+proj=ob_tran +o_proj=longlat +o_lat_p=39.25 +o_lon_p=-162 +lon_0=0 +type=crs",
        "+proj=tmerc +lon_0=9 +x_0=3500000 +ellps=bessel +towgs84=598.1,73.7,418.2,0.2,0.04,-2.4,6.7 +type=crs",
        "+proj=merc +a=6378137 +b=6378137 +units=m +nadgrids=@null +wktext +no_defs +type=crs",
    ],
)
def test_definitions_without_files_are_read(text):
    crs = read_reference(text)
    assert crs == pyproj.CRS.from_user_input(text)
    # And what PROJ makes of them.
    assert file_named(crs.to_wkt()) == ""


@pytest.mark.parametrize("text", ["", "WGS 84", "/etc/passwd", "{", "@/etc/passwd", "PROJCS[", "EPSG:999999"])
def test_what_is_no_definition_is_refused_in_a_line(text):
    with pytest.raises(InvalidInput) as refused:
        read_reference(text)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("unit", ["0", "-1", "1e400", "nan"])
@pytest.mark.parametrize(
    "text",
    [
        _old().replace('UNIT["metre",1]', 'UNIT["x",SIZE]'),
        _OLD.partition(",PROJECTION")[0].partition(",")[2].replace("DATUM]", "]").replace("0.0174532925199433", "SIZE"),
        f'COMPOUNDCRS["x",{_WGS84},VERTCRS["v",VDATUM["v"],CS[vertical,1],AXIS["h",up],LENGTHUNIT["x",SIZE]]]',
    ],
    ids=["metres", "degrees", "heights"],
)
def test_units_of_no_length_are_refused(text, unit):
    assert "SIZE" in text
    with pytest.raises(InvalidInput, match=f"of {unit}: must be greater than 0|non double value"):
        read_reference(text.replace("SIZE", unit))


def test_a_long_definition_is_refused_and_a_search_of_one_takes_time_by_its_length():
    with pytest.raises(InvalidInput, match="must be no more than 65536"):
        check_reference("PROJCS[" + " " * 70_000)
    for part in ("PARAMETERFILE[", "grids = ", "GEOIDMODEL[", 'PROJ4_GRIDS",', "init ", "grids=@null "):
        # The last of many is hostile at most.
        repeated = part if part == "grids=@null " else " " * len(part)
        assert growth(lambda count, one=repeated, last=part: file_named(one * count + last), 10_000) < PROPORTIONAL


def test_a_file_of_the_current_folder_is_not_read_either(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("up.gtx").write_bytes(b"")
    with pytest.raises(InvalidInput, match=r"names the file up\.gtx"):
        read_reference("+proj=utm +zone=32 +ellps=bessel +nadgrids=up.gtx +type=crs")
