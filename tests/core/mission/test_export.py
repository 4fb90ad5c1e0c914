"""Plans written to files, read back by other software."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput, OutputError
from terrainav.core.geodesy.mercator import PixelGrid, wrap_lon_deg
from terrainav.core.mission.areas.area import Box
from terrainav.core.mission.export import write_plan
from terrainav.core.mission.export.rows import COLUMNS
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

HERE = Mission(Box(35.16, -89.90, 35.15, -89.88), 120.0)
ACROSS = Mission(Box(0.01, 179.99, -0.01, -179.99), 300.0)


@pytest.fixture(params=[HERE, ACROSS], ids=["here", "antimeridian"])
def worked_out(request):
    return plan(request.param, PixelGrid())


def test_the_table_holds_every_digit(worked_out, tmp_path):
    write_plan(worked_out, tmp_path / "plan.csv")
    with (tmp_path / "plan.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [row["name"] for row in rows] == worked_out.names
    assert [float(row["lat_deg"]) for row in rows] == worked_out.lat_deg.tolist()
    assert [float(row["lon_deg"]) for row in rows] == wrap_lon_deg(worked_out.lon_deg).tolist()
    world = worked_out.grid.world_px(worked_out.zoom)
    left = [int(row["left_px"]) for row in rows]
    assert all(0 <= value < world for value in left)
    assert [value % world for value in left] == (worked_out.windows.left_px % world).tolist()
    assert [float(row["se_lat_deg"]) for row in rows] == worked_out.corners.lat_deg[:, 2].tolist()
    assert all(-180 <= float(row["ne_lon_deg"]) < 180 for row in rows)


def signed_area(ring):
    x, y = np.array(ring).T
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])) / 2


def test_footprints_are_rfc_7946(worked_out, tmp_path):
    write_plan(worked_out, tmp_path / "plan.geojson")
    features = json.loads((tmp_path / "plan.geojson").read_text())["features"]
    assert [feature["properties"]["name"] for feature in features] == worked_out.names
    total = 0.0
    for feature in features:
        geometry = feature["geometry"]
        polygons = [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]
        for (ring,) in polygons:
            assert ring[0] == ring[-1]
            area = signed_area(ring)
            assert area > 0  # counter-clockwise
            total += area
            lon = [position[0] for position in ring]
            assert -180 <= min(lon) <= max(lon) <= 180
            assert max(lon) - min(lon) < 1  # no part goes around the world
    corners = worked_out.corners
    exact = sum(
        -signed_area([*zip(lon - lon[0], lat), (0.0, lat[0])]) for lon, lat in zip(corners.lon_deg, corners.lat_deg)
    )
    assert total == pytest.approx(exact, rel=1e-7)


@pytest.mark.parametrize("ending", ["geojson", "kml", "csv"])
def test_gdal_reads_what_is_written(worked_out, tmp_path, ending):
    ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
    ogr.UseExceptions()
    path = tmp_path / f"plan.{ending}"
    write_plan(worked_out, path)
    data = ogr.Open(str(path))  # a layer does not outlive it
    layer = data.GetLayer(0)
    assert layer.GetFeatureCount() == len(worked_out)
    if ending != "csv":
        assert all(feature.GetGeometryRef().IsValid() for feature in layer)
        west, east, south, north = layer.GetExtent()
        assert south == pytest.approx(worked_out.corners.lat_deg.min(), abs=1e-12)
        assert north == pytest.approx(worked_out.corners.lat_deg.max(), abs=1e-12)
        if worked_out.mission is HERE:
            assert (west, east) == pytest.approx(
                (worked_out.corners.lon_deg.min(), worked_out.corners.lon_deg.max()), abs=1e-12
            )


def test_other_endings_are_refused(worked_out, tmp_path):
    with pytest.raises(
        InvalidInput,
        match=r"must end in \.csv, \.geojson, \.kml, \.gpkg, \.gpx, \.litchi\.csv, \.kmz, \.plan, \.survey\.plan",
    ):
        write_plan(worked_out, tmp_path / "plan.shp")


def test_a_folder_that_is_not_there_is_named(worked_out, tmp_path):
    with pytest.raises(OutputError, match="gone"):
        write_plan(worked_out, tmp_path / "gone" / "plan.csv")
