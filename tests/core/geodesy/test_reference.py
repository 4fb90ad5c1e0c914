"""The references against each other: 50 digits from the definitions, and long double from other formulas."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from tests.core.geodesy import longdouble, reference, scenes
from tests.core.geodesy.reference_check import exact, rounding_m

extended = pytest.mark.skipif(not longdouble.EXTENDED, reason=longdouble.WHY_NOT)

#: What a rounding of long double, relative 2**-64, moves a ray's end by; the position of the Earth's size has one, too.
UNIT = 2.0**-64
EARTH_M = 6.4e6
#: The rays' products of a dozen factors add up to a few roundings; the quadratic from far above near the horizon to 15.
ROUNDINGS = 40.0


@pytest.mark.parametrize("row", list(scenes.whole_domain(11, 60).rows()))
def test_fifty_digits_look_where_they_see(row):
    point = reference.see(*row)
    if point is None:
        return
    x, y = reference.look(*row[:7], *point, row[-1])
    with mpmath.workdps(reference.DIGITS):
        assert abs(x - mpmath.mpf(row[7])) < 1e-30
        assert abs(y - mpmath.mpf(row[8])) < 1e-30


def test_fifty_digits_know_what_is_hidden_and_what_is_behind():
    level, up = (0.0, 0.0, 0.0), (0.0, 180.0, 0.0)
    assert reference.look(0.0, 1e3, 90.0, 1.0, *level, 0.0, 0.5) is not None
    # The horizon of 1000 m lies 1.0146 degrees away; the antipode is in front of the camera, too, but hidden.
    assert reference.look(0.0, 1e3, 90.0, 1.0, *level, 0.0, 1.014) is not None
    assert reference.look(0.0, 1e3, 90.0, 1.0, *level, 0.0, 1.016) is None
    assert reference.look(0.0, 1e3, 90.0, 1.0, *level, 0.0, 180.0) is None
    assert reference.look(0.0, 1e3, 90.0, 1.0, *up, 0.0, 0.0) is None


@extended
@pytest.mark.parametrize(
    "drawn",
    [
        scenes.whole_domain(21, 1000),
        scenes.near_the_horizon(22, 200),
        scenes.near_the_horizon(23, 100, (-1.0, -1e-6)),
    ],
    ids=["whole domain", "inside the horizon", "above the horizon"],
)
def test_long_double_sees_what_fifty_digits_see(drawn):
    seen = longdouble.see(*drawn)
    for at, row in enumerate(drawn.rows()):
        point = reference.see(*row)
        assert seen.hit[at] == (point is not None), row
        if point is not None:
            error = reference.distance_m((exact(seen.lat_deg[at]), exact(seen.dlon_deg[at])), point, row[-1])
            slant, grazing = reference.slant_and_grazing(*row[:2], point, row[-1])
            assert error < ROUNDINGS * UNIT * (slant / grazing + EARTH_M), row


@extended
def test_long_double_looks_where_fifty_digits_look():
    drawn = scenes.whole_domain(24, 1000)
    seen = longdouble.see(*drawn)
    drawn, hit = drawn.take(seen.hit), seen.hit
    lat, dlon = (column[hit].astype(np.float64) for column in (seen.lat_deg, seen.dlon_deg))
    looked = longdouble.look(*drawn[:7], lat, dlon, drawn.ground_height_m)
    assert hit.sum() > 300
    for at, row in enumerate(drawn.rows()):
        image = reference.look(*row[:7], float(lat[at]), float(dlon[at]), row[-1])
        assert looked.visible[at] == (image is not None), row
        if image is not None:
            # In half widths of the image: 1e-12 is 3e-10 px of 640, seen in a field of view of 0.01 degrees only.
            error = max(abs(image[0] - exact(looked.x[at])), abs(image[1] - exact(looked.y[at])))
            assert float(error) < 1e-12 * max(1.0, abs(float(image[0])), abs(float(image[1]))), row


@extended
def test_long_double_keeps_the_shape_of_what_it_is_given():
    lat = np.array([[10.0], [-20.0]])
    seen = longdouble.see(lat, 100.0, 60.0, 1.5, np.array([0.0, 90.0, 180.0]), 5.0, 1.0, 0.5, -0.5)
    assert seen.lat_deg.shape == seen.dlon_deg.shape == seen.hit.shape == (2, 3)
    assert seen.lat_deg.dtype == np.longdouble


def test_roundings_are_those_of_the_degrees_where_the_camera_is_near():
    slant, grazing = map(float, reference.slant_and_grazing(45.0, 10.0, (45.0, 0.0)))
    assert (slant, grazing) == pytest.approx((10.0, 1.0))
    assert rounding_m(slant, grazing) == pytest.approx(1.6e-9, rel=1e-3)
