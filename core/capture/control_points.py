"""Where a camera frame lies: ground control points, which GDAL and QGIS warp the picture by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geodesy.footprint import exact
from ..geodesy.mercator import wrap_lon_deg
from ..mission.layout.framing import ground_of
from ..mission.plan import Plan
from .digits import degrees
from .georeference import WGS84_WKT, geo_keys, pam_text, xml_text
from .tiff import Kind, Tag

Floats = NDArray[np.float64]

EPSG = 4326
#: Points along the longer and the shorter side, and how often both are doubled where the horizon leaves too few.
_LONG_SIDE, _SHORT_SIDE, _DOUBLINGS = 9, 7, 4
#: What the least surface through control points, a plane's perspective, needs.
_FEWEST = 4


@dataclass(frozen=True, eq=False)
class ControlPoints:
    """Points of a picture and the ground that the exact camera sees there.

    Parameters
    ----------
    points : array (k, 5)
        Column and row in px from the upper left corner, longitude and latitude in degrees, height over the
        ellipsoid in metres. Longitudes are continuous with the camera's.
    """

    points: Floats

    @classmethod
    def of(cls, plan: Plan, index: int, width_px: int, height_px: int) -> ControlPoints:
        """Points of one capture, evenly spread over the part of its picture that sees the ground.

        Parameters
        ----------
        width_px, height_px : int
            Of the picture as written.
        """
        pose = plan.poses.take(np.array([index]))
        pose = pose._replace(lon_deg=wrap_lon_deg(pose.lon_deg))
        mission = plan.mission
        across, down = (_LONG_SIDE, _SHORT_SIDE) if width_px >= height_px else (_SHORT_SIDE, _LONG_SIDE)
        found = np.empty((0, 5))
        for doubling in range(_DOUBLINGS + 1):
            x, y = (
                values.ravel()
                for values in np.meshgrid(
                    np.linspace(-1.0, 1.0, (across << doubling) + 1),
                    np.linspace(1.0, -1.0, (down << doubling) + 1),
                )
            )
            seen = exact(mission.camera, pose, tuple(zip(x.tolist(), y.tolist())), ground_of(mission))
            hit = seen.hit[0]
            lon, lat = ([degrees(angle) for angle in angles[0]] for angles in (seen.lon_deg, seen.lat_deg))
            columns = (
                (x + 1.0) / 2.0 * width_px,
                (1.0 - y) / 2.0 * height_px,
                np.array(lon),
                np.array(lat),
                np.full(len(x), mission.ground_height_m),
            )
            found = np.stack(columns, axis=1)[hit]
            if len(found) >= _FEWEST:
                break
        return cls(found)

    def aux_xml(self, metadata: Mapping[str, str]) -> str:
        """Text of GDAL's auxiliary file (PAM): the points, their CRS, and metadata."""
        points = "".join(
            f'    <GCP Id="{number}" Pixel="{column!r}" Line="{row!r}" X="{lon!r}" Y="{lat!r}" Z="{height!r}" />\n'
            for number, (column, row, lon, lat, height) in enumerate(self.points.tolist(), 1)
        )
        crs = xml_text(WGS84_WKT)
        place = f'  <GCPList Projection="{crs}" dataAxisToSRSAxisMapping="2,1">\n{points}  </GCPList>\n'
        return pam_text(place, metadata)

    def tags(self) -> list[Tag]:
        """GeoTIFF's tags: tie points, and a geographic CRS by its code."""
        ties = np.insert(self.points, 2, 0.0, axis=1).ravel().tolist()
        return [
            Tag(33922, Kind.DOUBLE, ties),  # ModelTiepoint
            Tag(34735, Kind.SHORT, geo_keys([(1024, 2), (1025, 1), (2048, EPSG)])),
        ]
