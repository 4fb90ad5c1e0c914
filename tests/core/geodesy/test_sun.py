"""The sun's place, held against NREL's Solar Position Algorithm."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.geodesy.sun import sun_position

# Time, latitude, longitude; height without refraction and azimuth, as pvlib 0.16.1 has them (nrel_numpy). The first is
# the example that Reda and Andreas publish with their algorithm (NREL/TP-560-34302, table A5.1).
SPA = [
    ("2003-10-17T19:30:30Z", 39.742476, -105.1786, 39.8720, 194.3402),
    ("2024-06-21T10:30:00Z", 51.5, -0.12, 56.7866, 138.9202),
    ("2024-12-21T15:00:00Z", 35.15, -89.9, 17.8267, 137.5164),
    ("2026-03-20T00:00:00Z", -33.9, 151.2, 45.7300, 46.9972),
    ("1999-09-23T12:00:00Z", 0.0, 0.0, 88.1253, 269.7646),
    ("2024-06-21T00:00:00Z", 80.0, 20.0, 13.9773, 18.4415),
    ("2030-01-05T06:15:00Z", -65.0, 140.0, 35.8849, 295.4276),
    ("2024-02-29T23:59:59Z", 19.6, -155.5, 55.6709, 219.9511),
    ("2050-07-01T18:00:00Z", 48.1, 11.6, 10.2766, 293.1795),
]


@pytest.mark.parametrize(("time", "lat", "lon", "height", "azimuth"), SPA)
def test_it_stands_where_spa_has_it(time, lat, lon, height, azimuth):
    found_height, found_azimuth = sun_position(time, np.zeros(1), lat, lon)
    assert found_height[0] == pytest.approx(height, abs=0.01)
    # Near the zenith a small way is a large angle.
    assert (found_azimuth[0] - azimuth) * np.cos(np.radians(height)) == pytest.approx(0.0, abs=0.01)


def test_seconds_after_a_start_are_later():
    start, later = "2024-06-21T10:30:00.5Z", "2024-06-21T12:00:00.5Z"
    after = sun_position(start, np.array([0.0, 5400.0]), 40.0, 10.0)
    alone = sun_position(later, np.zeros(1), 40.0, 10.0)
    assert [part[1] for part in after] == pytest.approx([part[0] for part in alone], abs=1e-9)
    assert after[0][0] != after[0][1]
