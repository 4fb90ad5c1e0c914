"""A margin about an area: geodesics of its length end on ground that images show, and so does GEOS' buffer."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Geod, Transformer
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.camera import Camera
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Box, Points, Polygon
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan

from tests.core.mission.test_rotated import CONCAVE, places_of, seen_by
from tests.support.thinning import sampled

ogr = pytest.importorskip("osgeo.ogr", reason="GDAL's Python module comes with QGIS")
ogr.UseExceptions()
GRID = PixelGrid(max_zoom=22, native_zoom=22)
GEOD = Geod(ellps="WGS84")
WIDE = Camera(73.7, 4 / 3)
SMALL = Box(35.142, -89.864, 35.137, -89.858)
FIELD = Polygon((((-89.864, 35.142), (-89.858, 35.1415), (-89.8595, 35.137), (-89.8615, 35.1395)),))
SCENES = {
    "box": Mission(SMALL, 120.0, WIDE, margin_m=80.0),
    "a thin margin": Mission(SMALL, 120.0, WIDE, margin_m=0.5),
    "box, tilted": Mission(SMALL, 120.0, WIDE, margin_m=80.0, tilt_deg=20.0, yaw_deg=30.0),
    "box, turned": Mission(SMALL, 120.0, WIDE, margin_m=80.0, row_azimuth_deg=33.0),
    "box, track": Mission(SMALL, 120.0, WIDE, margin_m=80.0, facing="track", overlap_along=0.5),
    "box, track tilted": Mission(SMALL, 120.0, WIDE, margin_m=80.0, facing="track", tilt_deg=15.0),
    "field": Mission(FIELD, 120.0, WIDE, margin_m=120.0),
    "field, turned and crossed": Mission(FIELD, 120.0, WIDE, margin_m=60.0, row_azimuth_deg=20.0, crosshatch=True),
    "a hole": Mission(CONCAVE, 300.0, WIDE, margin_m=150.0, row_azimuth_deg=120.0),
    "wider than the area": Mission(FIELD, 300.0, WIDE, margin_m=3000.0),
    "latitude 75": Mission(Box(75.02, 10.0, 75.0, 10.1), 500.0, WIDE, margin_m=900.0),
    "latitude 75, turned": Mission(Box(-75.0, 10.0, -75.02, 10.1), 500.0, WIDE, margin_m=900.0, row_azimuth_deg=60.0),
    "antimeridian": Mission(Box(-12.0, 179.99, -12.02, -179.99), 300.0, WIDE, margin_m=400.0),
    "a point": Mission(Box(35.0000000001, -89.0000000001, 35.0, -89.0), 120.0, WIDE, margin_m=300.0),
}


@pytest.mark.parametrize("name", sampled(SCENES, 3))
def test_ground_within_the_margin_is_shown(name):
    mission = SCENES[name]
    made = plan(mission, GRID)
    assert made.coverage.complete
    lon, lat = (values[:, np.newaxis] for values in places_of(mission.area, 30))
    azimuth, share = np.meshgrid(np.arange(0.0, 360.0, 15.0), [0.5, 1.0])
    to_lon, to_lat, _ = GEOD.fwd(
        *np.broadcast_arrays(lon, lat, azimuth.ravel(), mission.flight.margin_m * share.ravel())
    )
    counts = np.concatenate(
        [
            seen_by(made, np.arange(len(made)), some_lon, some_lat)
            for some_lon, some_lat in zip(np.split(to_lon.ravel(), 1), np.split(to_lat.ravel(), 1))
        ]
    )
    assert counts.min() >= 1
    # And no more images than an area needs that is larger by the margin and by an image.
    without = plan(mission.replace(margin_m=0.0), GRID)
    assert len(made) >= len(without)


@pytest.mark.parametrize("area", [SMALL, FIELD], ids=["box", "field"])
def test_windows_hold_the_buffer_that_geos_makes_and_little_more(area):
    made = plan(Mission(area, 60.0, WIDE, margin_m=100.0), GRID)
    to_plane = Transformer.from_crs(4326, "+proj=laea +lat_0=35.14 +lon_0=-89.861 +ellps=WGS84", always_xy=True)
    ring = area.rings[0] if isinstance(area, Polygon) else ring_of(area)
    field = polygon(*to_plane.transform(*np.array(ring).T))
    buffer = field.Buffer(100.0, 60)
    # Its sides are bent on the map, where windows have straight ones.
    buffer.Segmentize(2.0)
    to_map = Transformer.from_pipeline(
        "+proj=pipeline +step +inv +proj=laea +lat_0=35.14 +lon_0=-89.861 +ellps=WGS84 +step +proj=webmerc +ellps=WGS84"
    )
    points = np.array(buffer.GetGeometryRef(0).GetPoints())
    on_map = polygon(*to_map.transform(points[:, 0], points[:, 1]))
    shown = ogr.Geometry(ogr.wkbMultiPolygon)
    for west, south, east, north in zip(*made.edges):
        shown.AddGeometry(polygon([west, east, east, west], [south, south, north, north]))
    union = shown.UnionCascaded()
    assert on_map.Difference(union).Area() < 1e-3
    # Whole images at the ends of rows, and whole rows: about an image and a half more on each side.
    stretch = 1.0 / np.cos(np.radians(35.14))
    assert union.Difference(on_map.Buffer(1.5 * stretch * max(WIDE.ground_size_m(60.0)))).Area() < 1e-3


def ring_of(box):
    west, east = box.west_deg, box.east_deg
    return [(west, box.north_deg), (east, box.north_deg), (east, box.south_deg), (west, box.south_deg)]


def polygon(x, y):
    ring = ogr.Geometry(ogr.wkbLinearRing)
    for place in zip([*x, x[0]], [*y, y[0]]):
        ring.AddPoint_2D(*map(float, place))
    found = ogr.Geometry(ogr.wkbPolygon)
    found.AddGeometry(ring)
    return found


def test_points_have_no_margin():
    points = Points(((35.0, -89.0, 120.0),))
    assert len(plan(Mission(points, 120.0, margin_m=50.0), GRID)) == 1


def test_the_published_grid_has_no_margin():
    with pytest.raises(InvalidInput, match=r"margin 10 m: the layout paper does not support it; use --layout cover"):
        plan(Mission(SMALL, 120.0, margin_m=10.0, layout="paper"), GRID)


def test_margins_beyond_the_map_are_refused():
    with pytest.raises(InvalidInput, match="area reaches latitude 85"):
        plan(Mission(Box(85.0, 0.0, 84.99, 0.1), 300.0, margin_m=20_000.0), GRID)


@pytest.mark.parametrize("margin", [-1.0, 1e6, float("nan")])
def test_margins_that_are_none_are_refused(margin):
    with pytest.raises(InvalidInput, match="margin"):
        Mission(SMALL, 120.0, margin_m=margin)


def test_files_state_a_margin_only_where_there_is_one():
    assert "margin" not in Mission(SMALL, 120.0).to_json()
    wider = Mission(SMALL, 120.0, margin_m=5.0)
    assert Mission.from_json(wider.to_json()) == wider
