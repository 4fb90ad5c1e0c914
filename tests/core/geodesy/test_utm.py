"""UTM zones, and positions against PROJ's EPSG definitions."""

from __future__ import annotations

import numpy as np
import pytest
from pyproj import Transformer
from terrainav.core.geodesy.utm import UTMZone, utm_zone


@pytest.mark.parametrize(
    ("lat", "lon", "epsg"),
    [
        (35.14, -89.86, 32616),
        (-35.0, 149.0, 32755),
        (0.0, -180.0, 32601),
        (0.0, 179.9999, 32660),
        (0.0, 180.0, 32601),
        (10.0, 6.0, 32632),
        (10.0, 5.999999, 32631),
        (60.0, 4.0, 32632),  # Norway
        (64.0, 4.0, 32631),
        (55.9, 4.0, 32631),
        (78.0, 8.9, 32631),  # Svalbard
        (78.0, 9.0, 32633),
        (78.0, 20.9, 32633),
        (78.0, 21.0, 32635),
        (78.0, 33.0, 32637),
        (78.0, 42.0, 32638),
        (84.5, 10.0, 32632),  # beyond: the zone of the longitude
    ],
)
def test_zones(lat, lon, epsg):
    assert utm_zone(lat, lon).epsg == epsg


@pytest.mark.parametrize("zone", [UTMZone(16, False), UTMZone(55, True)])
def test_positions_are_projs_and_come_back(zone):
    random = np.random.default_rng(1)
    lon = zone.central_meridian_deg + random.uniform(-6, 6, 50)
    lat = random.uniform(0, 84, 50) * (-1 if zone.south else 1)
    x, y = zone.forward(lon, lat)
    np.testing.assert_allclose(
        np.stack([x, y]), Transformer.from_crs(4326, zone.epsg, always_xy=True).transform(lon, lat), atol=1e-6
    )
    np.testing.assert_allclose(np.stack(zone.inverse(x, y)), [lon, lat], atol=1e-11)
