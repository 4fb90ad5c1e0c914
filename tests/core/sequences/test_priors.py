"""Priors against reference programs, and the statistics of their errors."""

from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.errors import InvalidInput
from terrainav.core.geodesy.local import enu_axes, geodetic
from terrainav.core.geodesy.magnetic import magnetic_field
from terrainav.core.poses.settings import Sensors
from terrainav.core.sequences.priors import gnss_places, magnetic_fields_nt, pressures_pa

from tests.core.sequences.test_inertial import winding

EXACT = Sensors(gnss_m=0.0, barometer_m=0.0, compass_deg=0.0)
#: 2025-01-01, at which the model has an epoch.
NEW_YEAR_US = 1_735_689_600_000_000


@pytest.mark.parametrize(
    ("lat", "lon", "height", "expected"),
    [
        (46.2, -122.2, 0.0, (5016.343, 19052.857, -48256.261)),
        (0.0, 10.0, 1000.0, (-530.719, 28442.619, 15835.046)),
        (80.0, 100.0, 100.0, (1067.824, 1502.285, -58872.622)),
        (-89.999, 30.0, 2000.0, (-14758.143, 8015.643, 51653.727)),
    ],
)
def test_the_magnetic_field_is_that_of_ppigrf(lat, lon, height, expected):
    """Figures of ppigrf 2.1.0 with IGRF-14, 2025-01-01."""
    field = magnetic_field(np.array([lat]), np.array([lon]), np.array([height]), 2025.0)
    assert field[0] == pytest.approx(expected, abs=0.01)


def test_years_without_a_model_are_refused():
    with pytest.raises(InvalidInput, match=r"year 2031\.0: the magnetic field is known from 1990 to 2030"):
        magnetic_field(np.zeros(1), np.zeros(1), np.zeros(1), 2031.0)


def test_exact_readings_are_those_of_the_place():
    flown, t = winding(), np.arange(0.0, 60.0, 0.5)
    motion = flown.at(t)
    lat, lon, height = geodetic(motion.place_m)
    assert np.stack(gnss_places(motion, t, EXACT, 1)) == pytest.approx(np.stack([lat, lon, height]), abs=1e-9)
    # ISO 2533 tabulates 954.61 hPa at 500 m.
    assert np.interp(500.0, np.sort(height), np.sort(pressures_pa(motion, t, EXACT, 1))[::-1]) == pytest.approx(
        95461.0, abs=2.0
    )
    fields = magnetic_fields_nt(motion, t, NEW_YEAR_US, EXACT, 1)
    back = np.einsum("nij,nj->ni", enu_axes(lat, lon) @ motion.rotation, fields)
    assert back == pytest.approx(magnetic_field(lat, lon, height, 2025.0), abs=2.0)


def test_errors_have_the_deviations_asked_for():
    flown = winding(seconds=600.0)
    t = np.arange(0.0, 600.0, 0.02)
    motion = flown.at(t)
    sensors = Sensors(gnss_m=2.0, barometer_m=3.0, compass_deg=4.0, drift_s=0.0)
    exact, found = (np.stack(gnss_places(motion, t, one, 5)) for one in (EXACT, sensors))
    assert np.std(found[2] - exact[2]) == pytest.approx(2.0, rel=0.02)
    assert np.std(found[0] - exact[0]) * 111_170.0 == pytest.approx(2.0, rel=0.02)
    exact, found = (pressures_pa(motion, t, one, 5) for one in (EXACT, sensors))
    # Pressure falls by 11.5 Pa/m at 500 m.
    assert np.std(found - exact) == pytest.approx(3.0 * 11.5, rel=0.05)
    exact, found = (magnetic_fields_nt(motion, t, NEW_YEAR_US, one, 5) for one in (EXACT, sensors))
    assert np.linalg.norm(found, axis=1) == pytest.approx(np.linalg.norm(exact, axis=1))


def test_a_receiver_has_no_place_in_an_outage():
    t = np.arange(0.0, 60.0, 0.2)
    places = np.stack(gnss_places(winding().at(t), t, Sensors(outage_share=0.3, outage_s=5.0), 5))
    lost = np.isnan(places)
    assert 0 < lost[0].sum() < len(t)
    assert (lost == lost[0]).all()
