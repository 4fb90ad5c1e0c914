"""Several polygons in QGIS: what is drawn of their plan."""

from __future__ import annotations

import pytest
from qgis.core import QgsCoordinateReferenceSystem, QgsCoordinateTransform, QgsGeometry, QgsProject
from terrainav.core.geodesy.mercator import PixelGrid
from terrainav.core.mission.areas.area import Polygon, Polygons
from terrainav.core.mission.mission import Mission
from terrainav.core.mission.plan import plan
from terrainav.terrainav_plugin.preview.features import area_features

RINGS = (
    (
        ((-89.9, 35.1), (-89.89, 35.1), (-89.89, 35.11)),
        ((-89.893, 35.102), (-89.891, 35.102), (-89.891, 35.104)),
    ),
    (((-89.88, 35.1), (-89.87, 35.1), (-89.87, 35.11), (-89.88, 35.11)),),
)


def on_map(rings):
    """A polygon as GEOS has it in the map's CRS."""
    text = ", ".join("(" + ", ".join(f"{x} {y}" for x, y in (*ring, ring[0])) + ")" for ring in rings)
    geometry = QgsGeometry.fromWkt(f"Polygon ({text})")
    systems = (QgsCoordinateReferenceSystem(code) for code in ("EPSG:4326", "EPSG:3857"))
    # Sides that are straight in degrees are nearly so on the map: pieces make them so.
    geometry = geometry.densifyByCount(64)
    geometry.transform(QgsCoordinateTransform(*systems, QgsProject.instance()))
    return geometry


def test_the_area_s_layer_has_a_feature_of_each_polygon():
    area = Polygons(tuple(Polygon(rings) for rings in RINGS))
    features = area_features(plan(Mission(area, 400.0), PixelGrid()))
    assert len(features) == 2
    for feature, rings, part in zip(features, RINGS, area.parts):
        expected = on_map(rings)
        apart = feature.geometry().symDifference(expected)
        assert apart.area() < 1e-6 * expected.area()
        west, south, east, north = part.bounds.edges_deg
        assert feature.attributes() == pytest.approx([north, west, south, east])
