"""The exact camera the other way around: where it sees given points of the ground."""

from __future__ import annotations

import numpy as np
from terrainav.core.geodesy.ellipsoid import WGS84, sight_lines


def image_points(camera, poses, lat_deg, lon_deg, ground=WGS84):
    """Image points, (n, k, 2), at which exact cameras see ground points (n, k); the inverse of `footprint.exact`.

    Points behind a camera give NaN; whether the Earth hides a point is not asked.
    """
    vectors = sight_lines(
        poses.lat_deg[:, np.newaxis],
        poses.agl_m[:, np.newaxis],
        lat_deg,
        lon_deg - poses.lon_deg[:, np.newaxis],
        ground,
    )
    points, in_front = camera.image_xy(vectors, *poses.attitude)
    return np.where(in_front[..., np.newaxis], points, np.nan)
