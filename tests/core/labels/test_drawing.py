"""Labels drawn by the nearest rule, against GDAL's rasterizer and shapely's distances."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from terrainav.core.external.compiling import without_numba
from terrainav.core.geodesy.mercator import MERCATOR
from terrainav.core.geodesy.planes import ProjectedPlane
from terrainav.core.labels.label_map import GroundBox, LabelLayer, LabelMap
from terrainav.core.labels.pieces import DegreePlane

from tests.support.labels import ShapelyLayer

gdal = pytest.importorskip("osgeo.gdal")
ogr = pytest.importorskip("osgeo.ogr")

SIZE = 200
#: Planes with west, north and size of a pixel, in the unit of their CRS.
PLANES = {
    "EPSG:3857": (MERCATOR, 1_200_000.0, 6_300_000.0, 0.5),
    "EPSG:4326": (ProjectedPlane("EPSG:4326", 8.0, 48.0, 1.0, 1.0), 8.3, 47.6, 1e-5),
    "EPSG:32633": (
        ProjectedPlane("EPSG:32633", 400_000.0, 5_500_000.0, 65_536.0, 65_536.0),
        412_345.0,
        5_467_890.0,
        1.0,
    ),
}


def shapes(seed):
    """Polygons in pixels, as awkward as they come: holes, parts, slivers, overlaps."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(40):
        x, y = rng.uniform(-20, SIZE + 20, 2)
        angle = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 30)))
        radius = rng.uniform(3, 40) * rng.uniform(0.4, 1.0, len(angle))
        outer = np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1)
        found.append(shapely.Polygon(outer).buffer(0))
    for _ in range(10):
        x, y = rng.uniform(20, SIZE - 20, 2)
        found.append(shapely.Point(x, y).buffer(15, 6).difference(shapely.Point(x + 2, y).buffer(9, 3)))
    for _ in range(10):
        x, y = rng.uniform(0, SIZE, 2)
        found.append(shapely.MultiPolygon([shapely.box(x, y, x + 7.3, y + 9), shapely.box(x + 12, y, x + 20, y + 1.1)]))
    for _ in range(20):
        (x, y), (east, north) = rng.uniform(0, SIZE, 2), rng.uniform(-60, 60, 2)
        found.append(shapely.Polygon([(x, y), (x + east, y + north), (x + east + 0.3, y + north + 0.3)]))
    # Edges along whole and half pixels, and one polygon around all.
    found += [shapely.box(10, 10, 30, 30), shapely.box(30.25, 10, 50.25, 30), shapely.box(-1e4, -1e4, 1e4, 1e4)]
    found = [one for one in found if not one.is_empty and one.area > 0]
    rng.shuffle(found)
    return found


def on_ground(plane, west, north, pixel, shape):
    """Geometry in longitude and latitude of one in pixels."""

    def to_ground(xy):
        u = (west + xy[:, 0] * pixel - plane.west) / plane.width
        v = (plane.north - (north - xy[:, 1] * pixel)) / plane.height
        lat, lon = plane.inverse(u, v)
        return np.stack([lon, lat], axis=1)

    return shapely.transform(shape, to_ground)


def pixel_centres(plane, west, north, pixel):
    at = np.arange(SIZE) + 0.5
    x, y = np.meshgrid(
        (west + at * pixel - plane.west) / plane.width, (plane.north - north + at * pixel) / plane.height
    )
    lat, lon = plane.inverse(x, y)
    return x, y, GroundBox.around(lat, lon)


def rasterized(geometries, numbers):
    """Numbers of polygons in pixels by GDAL, the last on top."""
    target = gdal.GetDriverByName("MEM").Create("", SIZE, SIZE, 1, gdal.GDT_Int32)
    target.SetGeoTransform((0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
    source = ogr.GetDriverByName("Memory").CreateDataSource("")
    layer = source.CreateLayer("shapes", None, ogr.wkbUnknown)
    layer.CreateField(ogr.FieldDefn("number", ogr.OFTInteger))
    for geometry, number in zip(geometries, numbers):
        feature = ogr.Feature(layer.GetLayerDefn())
        feature.SetGeometry(ogr.CreateGeometryFromWkb(shapely.to_wkb(geometry)))
        feature["number"] = int(number)
        layer.CreateFeature(feature)
    gdal.RasterizeLayer(target, [1], layer, options=["ATTRIBUTE=number"])
    return target.ReadAsArray()


def far_from_edges(geometries):
    """Pixels whose centre is farther than 1e-6 px from every edge."""
    x, y = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    edges = shapely.union_all([one.boundary for one in geometries])
    shapely.prepare(edges)
    return shapely.distance(edges, shapely.points(x, y)) > 1e-6


@pytest.mark.parametrize("crs", PLANES)
@pytest.mark.parametrize("ordered", [False, True])
def test_nadir_labels_equal_gdals(crs, ordered):
    plane, west, north, pixel = PLANES[crs]
    geometries = shapes(7)
    rng = np.random.default_rng(1)
    order = rng.permutation(len(geometries)) if ordered else np.arange(len(geometries))
    kinds = [f"kind {at % 5}" for at in range(len(geometries))]
    layer = ShapelyLayer(
        [on_ground(plane, west, north, pixel, one) for one in geometries], kind=kinds, rank=order.tolist()
    )
    labels = LabelMap([LabelLayer(layer, "shapes", "kind")], "rank" if ordered else "")
    classes, instances = labels.draw(plane, *pixel_centres(plane, west, north, pixel))
    drawn = np.argsort(order)
    wanted = rasterized([geometries[at] for at in drawn], drawn + 1)
    known = far_from_edges(geometries)
    assert known.mean() > 0.99
    np.testing.assert_array_equal(instances[known], wanted[known])
    np.testing.assert_array_equal(classes, np.where(instances > 0, (instances.astype(int) - 1) % 5 + 1, 0))
    with without_numba():
        again = labels.draw(plane, *pixel_centres(plane, west, north, pixel))
    np.testing.assert_array_equal(again[0], classes)
    np.testing.assert_array_equal(again[1], instances)


def test_polygons_side_by_side_leave_no_gap():
    plane, west, north, pixel = PLANES["EPSG:3857"]
    rng = np.random.default_rng(3)
    sites = shapely.MultiPoint(rng.uniform(-30, SIZE + 30, (300, 2)))
    cells = [
        one.intersection(shapely.box(-40, -40, SIZE + 40, SIZE + 40)) for one in shapely.voronoi_polygons(sites).geoms
    ]
    layer = ShapelyLayer([on_ground(plane, west, north, pixel, one) for one in cells if one.area > 0])
    _, instances = LabelMap([LabelLayer(layer, "cells")]).draw(plane, *pixel_centres(plane, west, north, pixel))
    assert (instances > 0).all()


@pytest.mark.parametrize("compiled", [True, False])
def test_lines_and_points_have_their_width_on_the_ground(compiled):
    # In a UTM grid near its central meridian, where metres of the plane are metres of the ground but for its scale.
    plane, west, north, pixel = PLANES["EPSG:32633"]
    west = 430_000.0
    rng = np.random.default_rng(5)
    lines = [shapely.LineString(rng.uniform(0, SIZE, (4, 2))) for _ in range(6)]
    points = [shapely.MultiPoint(rng.uniform(0, SIZE, (3, 2))) for _ in range(6)]
    ground = [on_ground(plane, west, north, pixel, one) for one in (*lines, *points)]
    labels = LabelMap([LabelLayer(ShapelyLayer(ground), "things")], "", 5.0, 4.0)
    centres = pixel_centres(plane, west, north, pixel)
    if compiled:
        _, instances = labels.draw(plane, *centres)
    else:
        with without_numba():
            _, instances = labels.draw(plane, *centres)
    x, y = np.meshgrid(np.arange(SIZE) + 0.5, np.arange(SIZE) + 0.5)
    lat, lon = plane.inverse(*centres[:2])
    metre = plane.ground_m(lat, lon)[0] / plane.width
    wanted, close = np.zeros((SIZE, SIZE), int), np.zeros((SIZE, SIZE), bool)
    for number, shape in enumerate((*lines, *points), 1):
        distance = shapely.distance(shape, shapely.points(x, y)) * metre
        radius = 2.5 if number <= len(lines) else 4.0
        wanted[distance <= radius] = number
        close |= np.abs(distance - radius) < 1e-3
    assert close.mean() < 0.01
    np.testing.assert_array_equal(instances[~close], wanted[~close])


def test_a_long_line_keeps_its_width_in_metres():
    """Web Mercator enlarges: a line of 4 m stays 4 m wide on the ground along hundreds of kilometres."""
    line = shapely.LineString([(10.0, 50.0), (10.0, 54.0)])
    labels = LabelMap([LabelLayer(ShapelyLayer([line]), "road")], "", 4.0)
    for lat_deg in (50.001, 52.0, 53.999):
        degree_m = float(DegreePlane().ground_m(np.array(lat_deg), np.array(10.0))[0])
        lon = 10.0 + np.linspace(-4.0, 4.0, 801)[np.newaxis] / degree_m
        lat = np.full(lon.shape, lat_deg)
        classes, _ = labels.draw(MERCATOR, *MERCATOR.forward(lat, lon), GroundBox.around(lat, lon))
        assert classes.sum() * 0.01 == pytest.approx(4.0, abs=0.03)


@pytest.mark.parametrize("unseen", [0.0, 0.1, 0.95, 1.0])
def test_tiles_that_a_piece_covers_have_the_same_pixels_without_compiled_code(unseen):
    """Also where many pixels see no ground."""
    rng = np.random.default_rng(7)
    covers = shapely.box(-9.0, -9.0, 9.0, 9.0).difference(shapely.Point(0.1, 0.2).buffer(0.5))
    shapes = [covers, shapely.box(-0.9, -0.9, 0.2, 0.1), shapely.Point(0.5, 0.5), shapely.box(3.0, 3.0, 4.0, 4.0)]
    lon, lat = np.meshgrid(np.linspace(-1.0, 1.0, 77), np.linspace(1.0, -1.0, 53))
    lon[rng.random(lon.shape) < unseen] = np.nan
    lat[rng.random(lat.shape) < unseen / 2.0] = np.nan
    labels = LabelMap([LabelLayer(ShapelyLayer(shapes), "things")], point_radius_m=20_000.0)
    drawn = labels.draw(DegreePlane(), lon, lat, GroundBox.around(lat, lon))
    with without_numba():
        wanted = labels.draw(DegreePlane(), lon, lat, GroundBox.around(lat, lon))
    np.testing.assert_array_equal(drawn, wanted)
    assert ((drawn[1] > 0) <= np.isfinite(lon + lat)).all()


def test_later_layers_lie_on_top_and_instances_go_on():
    below = ShapelyLayer([shapely.box(0, 0, 1, 1), shapely.box(1, 0, 2, 1)])
    above = ShapelyLayer([shapely.box(0.5, 0, 1.5, 1)])
    labels = LabelMap([LabelLayer(below, "fields"), LabelLayer(above, "roads")])
    lon, lat = np.array([[0.25, 0.75, 1.25, 1.75, 2.5, np.nan]]), np.full((1, 6), 0.5)
    classes, instances = labels.draw(DegreePlane(), lon, lat, GroundBox.around(lat, lon))
    assert classes.tolist() == [[1, 2, 2, 1, 0, 255]]
    assert instances.tolist() == [[1, 3, 3, 2, 0, 0]]
    assert list(labels.instance_rows()) == [(1, 1, "fields", 1), (2, 1, "fields", 2), (3, 2, "roads", 1)]


def test_images_of_one_region_read_it_once():
    layer = ShapelyLayer([shapely.box(0, 0, 1, 1)])
    labels = LabelMap([LabelLayer(layer, "fields")])
    for east in (0.1, 0.1001, 0.1002):
        lon, lat = np.meshgrid(east + np.arange(9) * 1e-5, 0.5 + np.arange(9) * 1e-5)
        assert labels.draw(DegreePlane(), lon, lat, GroundBox.around(lat, lon))[0].all()
    assert layer.reads <= 2
