"""Camera frames as files, read back by GDAL, and their rows of the table."""

from __future__ import annotations

import json
import threading

import numpy as np
import pytest
from PIL import Image
from terrainav.core.capture import records
from terrainav.core.capture.progress import Listener
from terrainav.core.capture.runner import capture
from terrainav.core.dataset.table import Table
from terrainav.core.errors import Cancelled, InvalidInput, OutputError
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.flight.wind import Wind
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.camera_frame import parts_of_tiles
from terrainav.core.picture.shot import Shot, Take
from terrainav.core.waiting import cancellable, check_cancelled
from terrainav.core.world import WorldSource

from tests.core.geodesy.reference import look, see
from tests.support.photos import SIXTH_DIGIT
from tests.support.thinning import sampled
from tests.support.waiting import wait_until

gdal = pytest.importorskip("osgeo.gdal")

SMALL = Box(35.1425, -89.866, 35.1405, -89.863)
SOURCE = WorldSource()


def captured(folder, area=SMALL, agl=120.0, **changes):
    worked_out = plan(Mission(area, agl, max_px=160, **changes), SOURCE.grid)
    result = capture(worked_out, SOURCE, folder)
    assert result.failed == ()
    return worked_out, result


@pytest.mark.parametrize(
    ("image_format", "tilt"), sampled([("tif", 85.0), ("jpg", 60.0), ("jpg", 85.0), ("png", 85.0)], 2)
)
def test_gdal_reads_the_pose_and_control_points_that_the_50_digit_camera_confirms(tmp_path, image_format, tilt):
    gdal.UseExceptions()
    area = Points(((35.1425, -89.866, 120.0),))
    worked_out, _ = captured(
        tmp_path / "out", area, tilt_deg=tilt, yaw_deg=30.0, image_format=image_format, ground_height_m=80.0
    )
    opened = gdal.Open(str(tmp_path / "out" / "satellite" / f"{worked_out.names[0]}.{image_format}"))
    assert (opened.RasterXSize, opened.RasterYSize) == worked_out.frames.largest_px == (160, 120)
    masked = tilt > 80.0 and image_format != "jpg"
    assert opened.RasterCount == (4 if masked else 3)
    metadata = opened.GetMetadata()
    assert float(metadata["TILT_DEG"]) == tilt
    assert float(metadata["YAW_DEG"]) == 30.0
    assert float(metadata["GROUND_HEIGHT_M"]) == 80.0
    assert metadata["FRAME"] == "camera"
    own_m = worked_out.mission.camera.ground_size_m(120.0)[0] / 160
    assert float(metadata["EFFECTIVE_GSD_M_PER_PX"]) == pytest.approx(own_m, rel=SIXTH_DIGIT)
    assert opened.GetGCPSpatialRef().GetAuthorityCode(None) == "4326"
    points = opened.GetGCPs()
    assert len(points) >= 20
    camera = worked_out.mission.camera
    for point in points[::7]:
        x, y = point.GCPPixel / 80.0 - 1.0, 1.0 - point.GCPLine / 60.0
        lat, dlon = see(35.1425, 120.0, camera.fov_deg, camera.aspect_ratio, 30.0, tilt, 0.0, x, y, 80.0)
        # Nine decimals of degrees.
        np.testing.assert_allclose([point.GCPY, point.GCPX + 89.866], [float(lat), float(dlon)], rtol=0, atol=0.51e-9)
        assert point.GCPZ == 80.0
    if masked:
        alpha = opened.GetRasterBand(4)
        assert alpha.GetColorInterpretation() == gdal.GCI_AlphaBand
        shown = alpha.ReadAsArray() > 0
        assert 1 - shown.mean() == pytest.approx(float(metadata["SKY_SHARE"]), rel=SIXTH_DIGIT)


def test_gdal_warps_a_picture_to_where_the_camera_saw_it(tmp_path):
    gdal.UseExceptions()
    area = Points(((35.1425, -89.866, 120.0),))
    worked_out, _ = captured(tmp_path / "out", area, tilt_deg=40.0)
    opened = gdal.Open(str(tmp_path / "out" / "satellite" / f"{worked_out.names[0]}.tif"))
    transformer = gdal.Transformer(opened, None, ["METHOD=GCP_TPS"])
    camera = worked_out.mission.camera
    for column, row in ((30.0, 20.0), (80.0, 60.0), (140.0, 100.0)):
        _, (lon, lat, _) = transformer.TransformPoint(0, column, row)
        found = look(35.1425, 120.0, camera.fov_deg, camera.aspect_ratio, 0.0, 40.0, 0.0, lat, lon + 89.866)
        # A thin plate through 80 points is within a tenth of a pixel of a perspective.
        assert (float(found[0]) + 1) * 80.0 == pytest.approx(column, abs=0.1)
        assert (1 - float(found[1])) * 60.0 == pytest.approx(row, abs=0.1)


def test_tables_hold_sky_shares_and_nominal_poses(tmp_path):
    wind = Wind(6.0, 250.0, 0.15, seed=5)
    places = Points(((35.1425, -89.866, 120.0), (35.1425, -89.864, 120.0), (35.1425, -89.862, 120.0)))
    worked_out, result = captured(tmp_path / "out", places, tilt_deg=84.0, wind=wind)
    table = Table.load(tmp_path / "out" / "satellite" / "meta_data.csv")
    assert len(table) == len(worked_out) == result.written
    assert (table.sky_share > 0.3).all()
    np.testing.assert_array_equal(table.nominal_tilt_deg, 84.0)
    np.testing.assert_array_equal(table.nominal_agl_m, 120.0)
    np.testing.assert_allclose(table.tilt_deg, worked_out.poses.tilt_deg, rtol=1e-15)
    assert np.ptp(table.tilt_deg - 84.0) > 0.0
    assert (np.abs(table.tilt_deg - 84.0) < 15.0).all()
    captured(tmp_path / "calm", places, tilt_deg=84.0)
    without = Table.load(tmp_path / "calm" / "satellite" / "meta_data.csv")
    assert np.isnan(without.nominal_tilt_deg).all()
    np.testing.assert_array_equal(without.tilt_deg, 84.0)


def test_a_run_that_was_stopped_is_resumed_to_the_same_bytes(tmp_path):
    worked_out, _ = captured(tmp_path / "whole", tilt_deg=30.0)
    part = capture(worked_out, SOURCE, tmp_path / "parts", only=range(0, len(worked_out), 2))
    rest = capture(worked_out, SOURCE, tmp_path / "parts", resume=True)
    assert part.written + rest.written == len(worked_out)
    whole = {path.name: path.read_bytes() for path in (tmp_path / "whole" / "satellite").iterdir()}
    parts = {path.name: path.read_bytes() for path in (tmp_path / "parts" / "satellite").iterdir()}
    assert whole == parts


def test_a_run_is_stopped_between_the_takes_of_a_picture_and_resumed_to_the_same_bytes(tmp_path, monkeypatch):
    slow = {"tilt_deg": 30.0, "motion_blur": True, "exposure_ms": 20.0, "row_time_us": 200.0, "airspeed_m_per_s": 10.0}
    worked_out, _ = captured(tmp_path / "whole", **slow)
    takes = sum(map(len, Shot(worked_out, 0).instants))
    drawn, stop, draw = [], threading.Event(), Take.draw

    def is_cancelled():
        try:
            check_cancelled()
        except Cancelled:
            return True
        return False

    def draw_some(take, *arguments):
        if len(drawn) == takes // 2:
            stop.set()
            wait_until(is_cancelled)
        picture = draw(take, *arguments)
        drawn.append(take)
        return picture

    monkeypatch.setattr(Take, "draw", draw_some)
    listener = Listener(cancelled=stop.is_set)
    part = capture(worked_out, SOURCE, tmp_path / "parts", workers=1, listener=listener)
    assert (part.cancelled, part.written, part.failed) == (True, 0, ())
    assert len(drawn) == takes // 2
    assert not list((tmp_path / "parts" / "satellite").glob("*.tif*"))
    monkeypatch.undo()
    assert capture(worked_out, SOURCE, tmp_path / "parts", resume=True).written == len(worked_out)
    whole, parts = (
        {path.name: path.read_bytes() for path in (tmp_path / name / "satellite").iterdir()}
        for name in ("whole", "parts")
    )
    assert whole == parts


def test_a_picture_that_is_drawn_when_the_run_is_stopped_is_written(tmp_path, monkeypatch):
    develop = records.develop_picture

    def cancelled_meanwhile(*arguments):
        check_cancelled()
        return develop(*arguments)

    monkeypatch.setattr(records, "develop_picture", cancelled_meanwhile)
    worked_out = plan(Mission(SMALL, 120.0, max_px=160, tilt_deg=30.0), SOURCE.grid)
    shot = Shot(worked_out, 0)
    parts = parts_of_tiles(SOURCE.grid, shot.tiles)
    (tmp_path / "satellite").mkdir()
    job = records.image_job(worked_out, 0, SOURCE, "satellite", tmp_path / "satellite")
    pixels = {part.window: SOURCE.fetch("satellite", part.window) for part in parts}
    calls = iter([False])
    with cancellable(lambda: next(calls, True)):
        made = records.make_picture(job, parts, pixels)
        with pytest.raises(Cancelled):
            check_cancelled()
    assert (tmp_path / "satellite" / f"{made.name}.tif").exists()


def test_sizes_that_were_asked_for_have_the_channels_that_were_asked_for(tmp_path):
    area = Points(((35.1425, -89.866, 120.0),))
    worked_out, _ = captured(tmp_path / "out", area, tilt_deg=85.0, img_size=(64, 48, 3))
    with Image.open(tmp_path / "out" / "satellite" / f"{worked_out.names[0]}.tif") as picture:
        assert picture.size == (64, 48)
        assert picture.mode == "RGB"


def test_footprints_of_the_plan_are_polygons_cut_by_the_horizon(tmp_path):
    captured(tmp_path / "out", Points(((40.1, -90.0, 8e6), (10.0, 179.9, 3.7e6))), 8e6)
    features = json.loads((tmp_path / "out" / "footprints.geojson").read_text())["features"]
    pole, across = features
    assert pole["properties"]["pole"] == "north"
    assert pole["properties"]["horizon_edges"] > 50
    for feature in features:
        rings = feature["geometry"]["coordinates"]
        rings = rings if feature["geometry"]["type"] == "Polygon" else [ring[0] for ring in rings]
        for ring in rings:
            lon, lat = np.array(ring).T
            assert ring[0] == ring[-1]
            assert (np.abs(lon) <= 180.0).all()
            assert (np.abs(lat) <= 90.0).all()
            # Counter-clockwise (RFC 7946).
            assert np.sum(lon[:-1] * lat[1:] - lon[1:] * lat[:-1]) > 0.0
    assert across["geometry"]["type"] == "MultiPolygon"
    assert "pole" not in across["properties"]
    reaches = [lat for ring in pole["geometry"]["coordinates"] for _, lat in (ring[0] if len(ring) == 1 else ring)]
    assert max(reaches) == 90.0


def test_pictures_by_their_centre_cannot_be_turned():
    grid = PixelGrid(max_zoom=21, native_zoom=21, centre_decimals=6, max_size_px=640)
    with pytest.raises(InvalidInput, match="images by their centre"):
        plan(Mission(SMALL, 120.0, tilt_deg=20.0), grid)
    high = Mission(Points(((40.0, -90.0, 16e3),)), 16e3)
    with pytest.raises(InvalidInput, match="times as much"):
        plan(high, grid)
    accepted = plan(high.replace(accept_error=True), grid)
    assert accepted.frames.on_map
    assert accepted.accuracy.bound_px > accepted.accuracy.budget_px


def test_another_mission_in_the_folder_is_refused(tmp_path):
    captured(tmp_path / "out", Points(((35.1425, -89.866, 120.0),)), tilt_deg=40.0)
    with pytest.raises(OutputError, match="another mission"):
        captured(tmp_path / "out", Points(((35.1425, -89.866, 120.0),)), tilt_deg=41.0)
