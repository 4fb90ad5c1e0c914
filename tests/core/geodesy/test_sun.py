"""The position of the sun, compared with other implementations of NREL's Solar Position Algorithm."""

from __future__ import annotations

import json
from datetime import datetime, timezone

import numpy as np
import pytest
from terrainav.core.geodesy.sun import refraction_deg, sun_position

from tests.support.peers import told_by_peers

# Time, latitude, longitude; height without refraction and azimuth by pvlib 0.16 (nrel_numpy). The first is the example
# that Reda and Andreas publish with their algorithm (NREL/TP-560-34302, table A5.1).
SPA = [
    ("2003-10-17T19:30:30Z", 39.742476, -105.1786, 39.87204, 194.34024),
    ("2024-06-21T10:30:00Z", 51.5, -0.12, 56.7866, 138.9202),
    ("2024-12-21T15:00:00Z", 35.15, -89.9, 17.8267, 137.5164),
    ("2026-03-20T00:00:00Z", -33.9, 151.2, 45.7300, 46.9972),
    ("1999-09-23T12:00:00Z", 0.0, 0.0, 88.1253, 269.7646),
    ("2024-06-21T00:00:00Z", 80.0, 20.0, 13.9773, 18.4415),
    ("2030-01-05T06:15:00Z", -65.0, 140.0, 35.8849, 295.4276),
    ("2024-02-29T23:59:59Z", 19.6, -155.5, 55.6709, 219.9511),
    ("2050-07-01T18:00:00Z", 48.1, 11.6, 10.2766, 293.1795),
    # With the difference between terrestrial and universal time of each year, as far as it is known or expected.
    ("1990-01-01T00:00:00Z", 69.6, 18.9, -42.20717, 22.67416),
    ("1990-06-21T21:30:00Z", 69.6, 18.9, 4.04419, 342.53706),
    ("1995-12-21T12:00:00Z", 66.0, -45.0, -5.56956, 139.77243),
    ("2008-03-20T11:59:59.5Z", 89.9, 10.0, 0.19848, 188.15360),
    ("2016-12-21T18:00:00Z", -89.5, -120.0, 23.86642, 29.71106),
    ("2035-10-05T05:05:05Z", -77.8, 166.7, 9.53609, 292.76625),
    ("2055-08-30T03:00:00Z", 78.2, 15.6, 3.08264, 59.31515),
    ("2060-12-31T23:59:59Z", 1.3, 103.8, 11.35787, 113.74894),
    ("2060-06-20T12:00:00Z", 23.4, 0.4, 89.93741, 57.98977),
]
#: Degrees that the issue allows.
CLOSE_DEG = 0.001


@pytest.mark.parametrize(("time", "lat", "lon", "height", "azimuth"), SPA)
def test_position_is_that_of_spa(time, lat, lon, height, azimuth):
    found_height, found_azimuth = sun_position(time, np.zeros(1), lat, lon)
    assert found_height[0] == pytest.approx(height, abs=CLOSE_DEG)
    # Near the zenith a small way is a large angle.
    assert (found_azimuth[0] - azimuth) * np.cos(np.radians(height)) == pytest.approx(0.0, abs=CLOSE_DEG)


#: Apparent height, height and azimuth of the sun at each of some seconds, latitudes and longitudes, by pvlib.
PEER_CODE = """
import json, sys
from datetime import datetime, timezone
import numpy as np
from pvlib import spa

found = []
for second, lat, lon in json.loads(sys.argv[1]):
    time = datetime.fromtimestamp(second, timezone.utc)
    delta_t = float(spa.calculate_deltat(time.year, time.month))
    at = spa.solar_position(np.array([second]), lat, lon, 0.0, 1010.0, 10.0, delta_t, 0.5667, numthreads=1)
    found.append([float(at[index][0]) for index in (2, 3, 4)])
print(json.dumps(found))
"""


def test_positions_of_seventy_years_are_those_of_pvlib():
    random = np.random.default_rng(38)
    seconds = random.integers(631152000, 2871763200, 300).tolist()  # 1990 to 2060
    lats = np.degrees(np.arcsin(random.uniform(-1.0, 1.0, 300))).tolist()
    asked = list(zip(seconds, lats, random.uniform(-180.0, 180.0, 300).tolist()))
    told = json.loads(told_by_peers("-c", PEER_CODE, json.dumps(asked)))
    worst = 0.0
    for (second, lat, lon), (apparent, height, azimuth) in zip(asked, told):
        start = datetime.fromtimestamp(second, timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
        ours = sun_position(start, np.zeros(1), lat, lon)
        turned = (ours[1][0] - azimuth + 180.0) % 360.0 - 180.0
        risen = sun_position(start, np.zeros(1), lat, lon, refracted=True)[0][0]
        worst = max(worst, abs(ours[0][0] - height), abs(turned) * np.cos(np.radians(height)), abs(risen - apparent))
    assert worst < CLOSE_DEG


def test_refraction_is_that_of_the_published_example():
    # NREL/TP-560-34302, table A5.1: 820 mbar, 11 degrees, a zenith angle of 50.11162 degrees.
    raised = refraction_deg(np.array([39.872046]), 820.0, 11.0)
    assert 90.0 - 39.872046 - raised[0] == pytest.approx(50.11162, abs=1e-5)
    # At sunset it is 34 arcminutes, as almanacs state; it ends once the sun has set.
    assert refraction_deg(np.array([-34.0 / 60.0, -2.0])) == pytest.approx([34.0 / 60.0, 0.0], abs=0.02)


def test_seconds_after_a_start_are_later():
    start, later = "2024-06-21T10:30:00.5Z", "2024-06-21T12:00:00.5Z"
    after = sun_position(start, np.array([0.0, 5400.0]), 40.0, 10.0)
    alone = sun_position(later, np.zeros(1), 40.0, 10.0)
    assert [part[1] for part in after] == pytest.approx([part[0] for part in alone], abs=1e-9)
    assert after[0][0] != after[0][1]
