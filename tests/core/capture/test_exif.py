"""Tags of JPEG pictures as ExifTool, Pillow and GDAL read them, against the plan and the ground it says they show."""

from __future__ import annotations

import dataclasses
import math
from datetime import datetime, timedelta, timezone

import numpy as np
import pytest
from PIL import Image
from pyproj import Geod
from terrainav.core.capture import tiff
from terrainav.core.capture.records import image_job, plan_exposures
from terrainav.core.capture.runner import capture
from terrainav.core.capture.writers import jpeg
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import u_to_lon, v_to_lat
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.cameras import add_camera, camera_named
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.core.picture.optics import camera_body
from terrainav.core.storage.config import FOLDER_ENV

from tests.support.photos import SIXTH_DIGIT, exiftool, focal_ratio, ground_seen, position
from tests.support.sources import PatternSource

# Half a ninth decimal of degrees, and half a sixth digit of focal lengths and principal points, 100 m from the middle.
TAGS_M = 1e-4 + 100.0 * SIXTH_DIGIT
# An ellipsoid whose axes are longer by a height lies at that height to the square of WGS84's flattening, 1.12e-5.
PARALLEL = 1.2e-5
# A map frame is a chart of the ground and not a pinhole's picture; the planner's own limit for choosing one.
MAP_FRAME_PX = 0.1
AGRICENTER = (35.1425, -89.866)


def photographed(folder, mission):
    source = PatternSource()
    worked_out = plan(mission, source.grid)
    assert capture(worked_out, source, folder).failed == ()
    paths = [folder / "satellite" / f"{name}.jpg" for name in worked_out.names]
    return worked_out, paths


def one(lat, lon, agl=120.0, **changes):
    return Mission(Points(((lat, lon, agl),)), agl, image_format="jpg", **changes)


ATTITUDES = [
    *((0.0, 0.0, 0.0), (90.0, 0.0, 0.0), (0.0, 40.0, 0.0), (0.0, 0.0, 25.0)),
    *((30.0, 40.0, 0.0), (-120.0, 35.0, -20.0), (250.0, -30.0, 15.0)),
]


def test_the_tags_alone_put_the_corners_of_a_camera_frame_where_the_plan_has_them(tmp_path):
    """The angles' signs, the optics and the altitude, by the rotation that mapping software makes of them."""
    cases = [(*AGRICENTER, 80.0, attitude) for attitude in ATTITUDES]
    cases += [(-33.9, 179.9995, -300.0, attitude) for attitude in ATTITUDES[-2:]]
    plans, photos = [], []
    for number, (lat, lon, ground, attitude) in enumerate(cases):
        angles = dict(zip(("yaw_deg", "tilt_deg", "roll_deg"), attitude))
        mission = one(lat, lon, **angles, ground_height_m=ground, frame="camera", max_px=120)
        worked_out, paths = photographed(tmp_path / str(number), mission)
        plans.append(worked_out)
        photos += paths
    for (_, _, ground, attitude), worked_out, tags in zip(cases, plans, exiftool(*photos)):
        width, height = worked_out.frames.largest_px
        seen_lon, seen_lat = ground_seen(tags, [(0, 0), (width, 0), (width, height), (0, height)], ground)
        corners = worked_out.corners
        _, _, apart = Geod(ellps="WGS84").inv(seen_lon, seen_lat, corners.lon_deg[0], corners.lat_deg[0])
        assert apart.max() < TAGS_M + PARALLEL * abs(ground), attitude


def test_the_tags_alone_put_the_edges_of_a_map_frame_where_the_file_has_them(tmp_path):
    places = [(*AGRICENTER, 120.0), (0.001, 0.0, 150.0), (-61.3, 179.99999, 80.0)]
    cases = [(*place, size) for place in places for size in (None, (100, 100, 3), (250, 61, 1))]
    plans, photos = [], []
    for number, (lat, lon, agl, img_size) in enumerate(cases):
        mission = one(lat, lon, agl, frame="map", img_size=img_size)
        worked_out, paths = photographed(tmp_path / str(number), mission)
        plans.append(worked_out)
        photos += paths
    for (lat, _, _, img_size), worked_out, tags in zip(cases, plans, exiftool(*photos)):
        left, top, width, height = (values[0] for values in worked_out.windows)
        wide, high = img_size[:2] if img_size else (width, height)
        assert (tags["ExifIFD:ExifImageWidth"], tags["ExifIFD:ExifImageHeight"]) == (wide, high)
        columns = np.array([0.0, wide / 2, wide, wide, 0.0])
        rows = np.array([0.0, 0.0, high / 2, high, high])
        world = worked_out.grid.world_px(worked_out.zoom)
        seen_lon, seen_lat = ground_seen(tags, np.stack([columns, rows], axis=1))
        east = u_to_lon((left + columns / wide * width) / world)
        north = v_to_lat((top + rows / high * height) / world)
        _, _, apart = Geod(ellps="WGS84").inv(seen_lon, seen_lat, east, north)
        ground_m = worked_out.grid.ground_m_per_px(worked_out.lat_deg, worked_out.lon_deg, worked_out.zoom)[0]
        assert apart.max() < MAP_FRAME_PX * ground_m, (lat, img_size)


@pytest.mark.parametrize(
    ("name", "focal_length_mm", "model"),
    [
        ("DJI Phantom 4 Pro", 8.8, "DJI Phantom 4 Pro (simulated)"),
        ("DJI Zenmuse P1 35 mm", 35.0, "DJI Zenmuse P1 35 mm (simulated)"),
        ("NVIG", None, "NVIG (simulated)"),
        (Camera(60.0, 1.5), None, "FOV 60 deg, 1.5 to 1 (simulated)"),
        (Camera(60.0, 0.75), None, "FOV 60 deg, 0.75 to 1 (simulated)"),
    ],
)
def test_focal_length_and_pixels_of_the_sensor_give_the_field_of_view(tmp_path, name, focal_length_mm, model):
    camera = camera_named(name).camera if isinstance(name, str) else name
    mission = one(*AGRICENTER, camera=camera, frame="camera", max_px=300)
    worked_out, paths = photographed(tmp_path, mission)
    (tags,) = exiftool(*paths)
    assert (tags["IFD0:Make"], tags["IFD0:Model"], tags["IFD0:Software"]) == ("TerrAInav", model, "TerrAInav")
    assert 1.0 / (2.0 * camera.half_tangents[0]) == pytest.approx(focal_ratio(tags), rel=SIXTH_DIGIT)
    length = tags["ExifIFD:FocalLength"]
    width, height = worked_out.frames.largest_px
    longer_mm = length * 2.0 * max(camera.half_tangents)
    if focal_length_mm is None:
        assert longer_mm == pytest.approx(36.0, rel=SIXTH_DIGIT)
    else:
        assert length == pytest.approx(focal_length_mm, rel=1e-9)
        assert longer_mm == pytest.approx(camera_named(name).sensor_mm[0], rel=0.03)
    field = 2.0 * math.atan(
        math.hypot(width / tags["ExifIFD:FocalPlaneXResolution"], height / tags["ExifIFD:FocalPlaneYResolution"])
        * 10.0
        / 2.0
        / length
    )
    assert math.degrees(field) == pytest.approx(camera.fov_deg, rel=SIXTH_DIGIT)
    assert "ExifIFD:FocalLengthIn35mmFormat" not in tags
    assert tags["XMP-Camera:PerspectiveFocalLength"] == pytest.approx(length, rel=1e-8)


def test_every_photo_says_where_and_when_along_the_flight_it_was_taken(tmp_path):
    mission = Mission(
        Box(35.1425, -89.866, 35.1395, -89.861),
        120.0,
        image_format="jpg",
        ground_height_m=-430.0,
        start="2024-02-29T23:59:59.75Z",
    )
    worked_out, paths = photographed(tmp_path, mission)
    assert len(paths) > 8
    start = datetime(2024, 2, 29, 23, 59, 59, 750_000, tzinfo=timezone.utc)
    for index, tags in enumerate(exiftool(*paths)):
        lat, lon, altitude = position(tags)
        # Nine decimals of degrees, and half of the last digit of a second of arc.
        assert lat == pytest.approx(worked_out.lat_deg[index], abs=0.52e-9)
        assert lon == pytest.approx(worked_out.lon_deg[index], abs=0.52e-9)
        assert (altitude, tags["XMP-Camera:AboveGroundAltitude"]) == (-310.0, 120.0)
        # From these versions on the references of an altitude count from the ellipsoid.
        assert (str(tags["ExifIFD:ExifVersion"]), tags["GPS:GPSVersionID"]) == ("0300", "2 4 0 0")
        assert (tags["GPS:GPSImgDirection"], tags["GPS:GPSImgDirectionRef"]) == (0, "T")
        taken = start + timedelta(seconds=float(worked_out.times_s[index]))
        written = f"{tags['ExifIFD:DateTimeOriginal']}.{tags['ExifIFD:SubSecTimeOriginal']}"
        assert datetime.strptime(written + "+0000", "%Y:%m:%d %H:%M:%S.%f%z") == taken
        assert tags["ExifIFD:OffsetTimeOriginal"] == "+00:00"
        assert tags["GPS:GPSDateStamp"] == f"{taken:%Y:%m:%d}"
        hours, minutes, seconds = str(tags["GPS:GPSTimeStamp"]).split(":")
        assert (int(hours), int(minutes)) == (taken.hour, taken.minute)
        assert float(seconds) == pytest.approx(taken.second + taken.microsecond / 1e6, abs=1e-7)
        # The picture's middle is off the camera by less than a pixel: so much may readers be off.
        ground_m = worked_out.resolution.camera_m_per_px
        assert 0.01 <= tags["XMP-Camera:GPSXYAccuracy"] < 0.01 + 1.5 * ground_m
        assert 0.01 <= tags["XMP-Camera:GPSZAccuracy"] < 0.01 + 120.0 * 0.0034
    assert worked_out.times_s[-1] > 1.0


def test_a_flight_that_outlasts_the_calendar_has_photos_without_times(tmp_path):
    mission = Mission(
        Points(((35.0, -89.0, 120.0), (35.0, -88.9, 120.0))),
        120.0,
        image_format="jpg",
        start="9999-12-31T23:59:59Z",
    )
    _, paths = photographed(tmp_path, mission)
    first, second = exiftool(*paths)
    assert first["ExifIFD:DateTimeOriginal"] == "9999:12:31 23:59:59"
    assert not {"ExifIFD:DateTimeOriginal", "GPS:GPSTimeStamp"} & set(second)
    assert "ExifIFD:FocalLength" in second


def test_years_are_of_four_digits(tmp_path):
    _, paths = photographed(tmp_path, one(*AGRICENTER, start="0099-01-02T03:04:05Z"))
    (tags,) = exiftool(*paths)
    assert tags["ExifIFD:DateTimeOriginal"] == "0099:01:02 03:04:05"


def test_pillow_and_gdal_read_the_same(tmp_path):
    gdal = pytest.importorskip("osgeo.gdal", reason="GDAL's Python modules are not installed")
    gdal.UseExceptions()
    worked_out, (path,) = photographed(tmp_path, one(*AGRICENTER, yaw_deg=30.0, tilt_deg=20.0, max_px=100))
    with Image.open(path) as image:
        assert image.size == worked_out.frames.largest_px
        root, exposure = image.getexif(), image.getexif().get_ifd(0x8769)
        assert (root[271], root[274]) == ("TerrAInav", 1)
        assert (exposure[40962], exposure[40963]) == image.size
        focal_px = float(exposure[37386]) * float(exposure[41486]) / 10.0
        assert focal_px == pytest.approx(50.0 / worked_out.mission.camera.half_tangents[0], rel=SIXTH_DIGIT)
    opened = gdal.Open(str(path))
    assert opened.GetMetadata()["EXIF_GPSAltitude"] == "(120)"
    (packet,) = opened.GetMetadata("xml:XMP")
    assert 'Camera:Pitch="20.0"' in packet
    assert not gdal.VSIGetLastErrorMsg()


def test_xmp_stands_where_text_searches_find_it(tmp_path):
    """As OpenSfM does: the element in the text of the file's bytes, where a new line would be a backslash and an n."""
    _, (path,) = photographed(tmp_path, one(*AGRICENTER))
    text = str(path.read_bytes())
    packet = text[text.index("<x:xmpmeta") : text.index("</x:xmpmeta") + 12]
    assert "\\" not in packet
    assert 'Camera:ModelType="perspective"' in packet
    assert "drone-dji" not in text


def test_texts_that_no_jpeg_has_room_for_are_refused(tmp_path):
    source = PatternSource()
    worked_out = plan(one(*AGRICENTER), source.grid)
    job = image_job(worked_out, 0, source, "satellite", tmp_path, plan_exposures(worked_out))
    long = dataclasses.replace(job.description, attribution="x" * 66_000)
    with pytest.raises(InvalidInput, match="choose tif or png"):
        jpeg(np.zeros((8, 8, 3), np.uint8), long)


def test_other_formats_cost_nothing(tmp_path):
    worked_out = plan(one(*AGRICENTER).replace(image_format="tif"), PatternSource().grid)
    assert plan_exposures(worked_out) is None


def test_a_camera_of_the_users_own_does_not_change_the_tags(monkeypatch, tmp_path):
    monkeypatch.setenv(FOLDER_ENV, str(tmp_path))
    facts = {"fov_deg": 61.0, "aspect_ratio": [5, 4]}
    camera = Camera(61.0, 1.25)
    assert add_camera("Mine", facts).camera == camera_named("Mine").camera == camera
    assert camera_body(camera).model == "FOV 61 deg, 1.25 to 1 (simulated)"


@pytest.mark.parametrize("value", [0.0, 1e-12, 0.3, 26.3, 8.8, 359.999999, 4_294_967.294, 36_000_120.0, 4.2e9])
def test_rationals_keep_nine_digits(value):
    numerator, denominator = tiff.rational(value)
    assert 0 <= numerator < 1 << 32
    assert 0 < denominator < 1 << 32
    assert (numerator == 0) == (value == 0.0)
    assert numerator / denominator == pytest.approx(value, rel=1.2e-9, abs=1e-9)


def test_a_rational_ends_at_the_largest_number():
    assert tiff.rational(1e12) == [0xFFFFFFFF, 1]
