"""Tags of photos as mapping software reads them: by ExifTool, and by the formulas of OpenSfM and OpenDroneMap."""

from __future__ import annotations

import json
import shutil
import subprocess

import numpy as np
import pytest
from pyproj import Transformer

A_M, B_M = 6_378_137.0, 6_356_752.314245179

#: Relative rounding of numbers other than degrees, which files state with six digits: half of the sixth.
SIXTH_DIGIT = 5e-6


def exiftool(*paths) -> list[dict]:
    """Tags of photos as numbers, ``group:name`` to value, in the order of the paths."""
    program = shutil.which("exiftool")
    if program is None:
        pytest.skip("exiftool (Debian: libimage-exiftool-perl) is not installed")
    done = subprocess.run(
        [program, "-json", "-n", "-G1", *map(str, paths)], check=True, capture_output=True, timeout=60
    )
    return json.loads(done.stdout)


def position(tags) -> tuple[float, float, float]:
    """Latitude, longitude and altitude with their signs."""
    altitude = tags["GPS:GPSAltitude"] * (-1.0 if tags["GPS:GPSAltitudeRef"] == 1 else 1.0)
    signs = [-1.0 if tags[f"GPS:GPS{name}Ref"] in ("S", "W") else 1.0 for name in ("Latitude", "Longitude")]
    return signs[0] * tags["GPS:GPSLatitude"], signs[1] * tags["GPS:GPSLongitude"], altitude


def angles(tags) -> list[float]:
    """Yaw, pitch and roll; ExifTool leaves numbers of many digits as text."""
    return [float(tags[f"XMP-Camera:{angle}"]) for angle in ("Yaw", "Pitch", "Roll")]


def focal_ratio(tags) -> float:
    """Focal length in widths of the picture: `compute_focal` and `extract_sensor_width` of opensfm/exif.py."""
    mm_per_unit = {2: 25.4, 3: 10}[tags["ExifIFD:FocalPlaneResolutionUnit"]]
    units_per_pixel = 1 / tags["ExifIFD:FocalPlaneXResolution"]
    return tags["ExifIFD:FocalLength"] / (tags["ExifIFD:ExifImageWidth"] * units_per_pixel * mm_per_unit)


def camera_id(tags) -> str:
    """Name of a photo's camera: `camera_id` of opendm/photo.py, and of opensfm/exif.py but for fisheyes."""
    projection = {"fisheye": "fisheye_opencv"}.get(tags["XMP-Camera:ModelType"], tags["XMP-Camera:ModelType"])
    model = tags["IFD0:Model"].replace(tags["IFD0:Make"], "")
    size = [str(tags["ExifIFD:ExifImageWidth"]), str(tags["ExifIFD:ExifImageHeight"])]
    words = ["v2", tags["IFD0:Make"].strip(), model.strip(), *size, projection]
    return " ".join([*words, str(float(focal_ratio(tags)))[:6]]).lower()


def image_to_north_east_down(yaw_deg, pitch_deg, roll_deg):
    """Rotation from an image's axes (right, up, towards the viewer): `compute_opk` of opendm/photo.py.

    That is Bäumker and Heimes' matrix of the body in the local level frame, times that of a camera that looks down with
    the top of its image ahead.
    """
    y, p, r = np.radians([yaw_deg, pitch_deg, roll_deg])
    body = np.array(
        [
            [
                np.cos(y) * np.cos(p),
                np.cos(y) * np.sin(p) * np.sin(r) - np.sin(y) * np.cos(r),
                np.cos(y) * np.sin(p) * np.cos(r) + np.sin(y) * np.sin(r),
            ],
            [
                np.sin(y) * np.cos(p),
                np.sin(y) * np.sin(p) * np.sin(r) + np.cos(y) * np.cos(r),
                np.sin(y) * np.sin(p) * np.cos(r) - np.cos(y) * np.sin(r),
            ],
            [-np.sin(p), np.cos(p) * np.sin(r), np.cos(p) * np.cos(r)],
        ]
    )
    return body @ np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])


def ground_seen(tags, columns_rows, ground_height_m=0.0):
    """Longitude and latitude of the ground that a photo shows at points (k, 2), px from its upper left corner."""
    per_mm = [tags[f"ExifIFD:FocalPlane{axis}Resolution"] / 10.0 for axis in "XY"]
    focal_px = tags["ExifIFD:FocalLength"] * np.array(per_mm)
    centre_px = np.array([float(mm) for mm in tags["XMP-Camera:PrincipalPoint"].split(",")]) * per_mm
    across, down = ((np.asarray(columns_rows, float) - centre_px) / focal_px).T
    rotation = image_to_north_east_down(*angles(tags))
    north, east, below = rotation @ np.stack([across, -down, -np.ones_like(across)])
    return _hit(*position(tags), north, east, below, ground_height_m)


def _hit(lat_deg, lon_deg, altitude_m, north, east, below, ground_height_m):
    """Longitude and latitude where rays meet an ellipsoid, by geocentric coordinates and a quadratic equation."""
    to_geocentric = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    origin = np.array(to_geocentric.transform(lon_deg, lat_deg, altitude_m))
    lat, lon = np.radians([lat_deg, lon_deg])
    norths = np.array([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)])
    easts = np.array([-np.sin(lon), np.cos(lon), 0.0])
    ups = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    rays = np.outer(norths, north) + np.outer(easts, east) - np.outer(ups, below)
    axes = np.array([A_M, A_M, B_M]) + ground_height_m
    start, along = origin / axes, rays / axes[:, np.newaxis]
    a, b, c = (along**2).sum(axis=0), 2.0 * start @ along, (start**2).sum() - 1.0
    hit = origin[:, np.newaxis] + 2.0 * c / (-b + np.sqrt(b**2 - 4.0 * a * c)) * rays
    # Latitude and longitude are those of the normal of the ellipsoid at the height of the ground.
    normal = hit / (axes**2)[:, np.newaxis]
    lon = np.degrees(np.arctan2(normal[1], normal[0]))
    return lon, np.degrees(np.arctan2(normal[2], np.hypot(normal[0], normal[1])))
