"""The GeoPackage: layers read back, valid by GDAL's own check of the standard, whole or not there."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from terrainav.core.errors import OutputError
from terrainav.core.geodesy.mercator import wrap_lon_deg
from terrainav.core.mission.export import write_plan

from tests.core.mission.flights import ACROSS, ALONE, HERE, IN_WIND, worked_out

ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")


def test_layers_have_the_values_that_are_drawn(tmp_path):
    flown = worked_out(
        HERE.replace(exposure="manual", exposure_ms=1.0, vary=("exposure_ms=uniform(1,2)", "iso=uniform(100,400)"))
    )
    write_plan(flown, tmp_path / "field.gpkg")
    data = ogr.Open(str(tmp_path / "field.gpkg"))
    for name in ("footprints", "captures"):
        features = list(data.GetLayer(name))
        stated = [{field: one.GetField(field) for field in ("exposure_ms", "iso")} for one in features]
        assert stated == [flown.drawn(index) for index in range(len(flown))]
        assert features[0].GetFieldAsDateTime("time")[0] > 0


@pytest.mark.parametrize("mission", [HERE, ACROSS, IN_WIND], ids=["here", "antimeridian", "wind"])
def test_layers_hold_the_plan(tmp_path, mission):
    flown = worked_out(mission)
    path = tmp_path / "field.gpkg"
    write_plan(flown, path)
    assert list(tmp_path.iterdir()) == [path]
    data = ogr.Open(str(path))
    layers = {layer.GetName(): layer for layer in (data.GetLayer(index) for index in range(data.GetLayerCount()))}
    assert list(layers) == ["footprints", "captures", "flight_line"]
    for layer in layers.values():
        assert layer.GetSpatialRef().GetAuthorityCode(None) == "4326"
    captures, footprints = list(layers["captures"]), list(layers["footprints"])
    for features in (captures, footprints):
        assert [one.GetField("name") for one in features] == flown.names
        assert [one.GetField("column") for one in features] == flown.column.tolist()
        assert [one.GetField("row") for one in features] == flown.row.tolist()
        for field, values in (
            ("lat_deg", flown.lat_deg),
            ("lon_deg", wrap_lon_deg(flown.lon_deg)),
            ("agl_m", flown.agl_m),
            ("yaw_deg", flown.poses.yaw_deg),
            ("tilt_deg", flown.poses.tilt_deg),
            ("roll_deg", flown.poses.roll_deg),
        ):
            assert [one.GetField(field) for one in features] == values.tolist()
        seconds = [one.GetFieldAsDateTime("time") for one in features]
        start = seconds[0]
        passed = [60.0 * (60 * (one[3] - start[3]) + one[4] - start[4]) + one[5] - start[5] for one in seconds]
        assert passed == pytest.approx(flown.times_s.tolist(), abs=2e-3)
        assert {one[6] for one in seconds} == {100}  # UTC
    points = [one.GetGeometryRef().GetPoint() for one in captures]
    assert points == list(zip(wrap_lon_deg(flown.lon_deg).tolist(), flown.lat_deg.tolist(), flown.agl_m.tolist()))
    area = sum(one.GetGeometryRef().GetArea() for one in footprints)
    x, y = flown.corners.lon_deg, flown.corners.lat_deg
    exact = np.abs(np.sum(x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1), axis=1)).sum() / 2
    assert area == pytest.approx(exact, rel=1e-7)
    assert all(one.GetGeometryRef().IsValid() for one in footprints)
    west, east, south, north = layers["footprints"].GetExtent()
    assert -180.0 <= west < east <= 180.0
    limits = (flown.corners.lat_deg.min(), flown.corners.lat_deg.max())
    assert (south, north) == pytest.approx(limits, abs=1e-12)
    (line,) = layers["flight_line"]
    assert line.GetField("length_m") == flown.direct.distance_m
    assert line.GetField("flight_s") == flown.direct.duration_s
    meant = flown.poses if flown.nominal is None else flown.nominal
    first = line.GetGeometryRef().GetGeometryRef(0).GetPoint(0)
    assert first == (wrap_lon_deg(meant.lon_deg)[0], meant.lat_deg[0], meant.agl_m[0])


def test_it_is_valid_by_the_standard(tmp_path):
    validate = pytest.importorskip("osgeo_utils.samples.validate_gpkg", reason="comes with GDAL's utilities")
    for name, mission in (("here", HERE), ("one", ALONE)):
        path = tmp_path / f"{name}.gpkg"
        write_plan(worked_out(mission), path)
        validate.check(str(path), abort_at_first_error=True)


def test_wind_is_told(tmp_path):
    (note,) = write_plan(worked_out(IN_WIND), tmp_path / "w.gpkg").notes
    assert "the flight line is the one that was meant" in note
    assert write_plan(worked_out(HERE), tmp_path / "h.gpkg").notes == ()


def test_an_older_file_is_replaced(tmp_path):
    path = tmp_path / "field.gpkg"
    path.write_bytes(b"something else")
    (tmp_path / "field.gpkg.part.gpkg").write_bytes(b"left behind")
    write_plan(worked_out(ALONE), path)
    assert list(tmp_path.iterdir()) == [path]
    assert ogr.Open(str(path)).GetLayerByName("captures").GetFeatureCount() == 1
    assert ogr.Open(str(path)).GetLayerByName("flight_line").GetFeatureCount() == 0


@pytest.mark.parametrize("raising", [False, True])
def test_a_file_that_cannot_be_written_is_named_and_left_alone(tmp_path, raising, monkeypatch, capfd):
    before = ogr.GetUseExceptions()
    (ogr.UseExceptions if raising else ogr.DontUseExceptions)()
    try:
        with pytest.raises(OutputError, match="gone") as raised:
            write_plan(worked_out(ALONE), tmp_path / "gone" / "field.gpkg")
    finally:
        (ogr.UseExceptions if before else ogr.DontUseExceptions)()
    assert "\n" not in str(raised.value)
    assert capfd.readouterr().err == ""


def test_a_plan_that_stops_halfway_leaves_the_older_file(tmp_path, monkeypatch):
    path = tmp_path / "field.gpkg"
    path.write_bytes(b"older")

    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("terrainav.core.mission.export.geopackage.flight_line", stop)
    with pytest.raises(KeyboardInterrupt):
        write_plan(worked_out(HERE), path)
    assert path.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [path]


def test_without_gdal_the_way_out_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "osgeo", None)
    with pytest.raises(OutputError, match=r"GeoPackages need GDAL's Python module .* or choose \.geojson"):
        write_plan(worked_out(ALONE), tmp_path / "field.gpkg")
    assert list(tmp_path.iterdir()) == []
