"""A capture's JPEG images through QGIS's own "Import geotagged photos": every photo at its pose, height and heading."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone

import processing
import pytest
from qgis.core import QgsVectorLayer
from terrainav.core.capture.runner import capture
from terrainav.core.imagery.opening import open_source
from terrainav.core.mission.areas.area import Box, Points
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

# GDAL, through which QGIS reads tags, gives six digits of each number: seconds of arc to half of 1e-4, 1.5 mm of
# ground, and altitudes and headings of three digits before the point to half of 1e-3. The tags themselves are finer.
SHOWN_DEG = 0.51e-4 / 3600
SHOWN = 0.51e-3
AGRICENTER = Box(35.1425, -89.866, 35.1405, -89.863)
MISSIONS = {
    "map frames": Mission(AGRICENTER, 120.0, image_format="jpg"),
    "tilted, below the ellipsoid": Mission(
        Box(31.5, 35.475, 31.4985, 35.477),
        150.0,
        image_format="jpg",
        ground_height_m=-410.0,
        yaw_deg=250.5,
        tilt_deg=25.0,
        roll_deg=-5.0,
        max_px=160,
        start="2024-06-21T10:30:00Z",
    ),
    "on both sides of the antimeridian": Mission(
        Points(((-16.5, 179.9999, 60.0), (-16.5, -179.9999, 500.0), (0.00001, 0.00001, 90.0))),
        60.0,
        image_format="jpg",
        max_px=160,
    ),
}


@pytest.mark.parametrize("mission", MISSIONS.values(), ids=MISSIONS)
def test_qgis_puts_every_photo_at_its_pose(tmp_path, mission):
    source = open_source("world")
    worked_out = plan(mission, source.grid)
    assert capture(worked_out, source, tmp_path).failed == ()
    imported = processing.run(
        "native:importphotos",
        {"FOLDER": str(tmp_path / "satellite"), "RECURSIVE": False, "OUTPUT": "TEMPORARY_OUTPUT"},
    )["OUTPUT"]
    assert isinstance(imported, QgsVectorLayer)
    assert imported.crs().authid() == "EPSG:4326"
    photos = {feature["filename"]: feature for feature in imported.getFeatures()}
    assert set(photos) == set(worked_out.names)
    start = datetime.fromisoformat(mission.flight.start.replace("Z", "+00:00")).astimezone(timezone.utc)
    for index, name in enumerate(worked_out.names):
        photo, pose = photos[name], worked_out.poses.take(slice(index, index + 1))
        point = photo.geometry().constGet()
        lon = (pose.lon_deg[0] + 180.0) % 360.0 - 180.0
        assert point.x() == pytest.approx(lon, abs=SHOWN_DEG)
        assert point.y() == pytest.approx(pose.lat_deg[0], abs=SHOWN_DEG)
        altitude = mission.flight.ground_height_m + pose.agl_m[0]
        assert point.z() == pytest.approx(altitude, abs=SHOWN)
        assert photo["altitude"] == pytest.approx(altitude, abs=SHOWN)
        assert photo["direction"] == pytest.approx(pose.yaw_deg[0] % 360.0, abs=SHOWN)
        assert str(photo["rotation"]) in ("0", "NULL")
        taken = start + timedelta(seconds=float(worked_out.times_s[index]))
        assert photo["timestamp"].toString("yyyy-MM-dd HH:mm:ss") == f"{taken:%Y-%m-%d %H:%M:%S}"
