from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from terrainav.core.dataset.labels import Scaler
from terrainav.core.errors import InvalidInput

metres = st.floats(-2e7, 2e7)


def test_scaled_labels_have_mean_0_and_standard_deviation_1():
    values = np.array([[1.0, 5.0], [2.0, 7.0], [6.0, 0.0]])
    scaler = Scaler.fit(values)
    assert scaler.mean == (3.0, 4.0)
    assert scaler.scale == pytest.approx((np.sqrt(14 / 3), np.sqrt(26 / 3)), rel=1e-15)
    scaled = scaler.transform(values)
    np.testing.assert_allclose(scaled.mean(axis=0), 0.0, atol=1e-15)
    np.testing.assert_allclose(scaled.std(axis=0), 1.0, rtol=1e-15)


@given(st.lists(st.tuples(metres, metres), min_size=1, max_size=20))
def test_inverse_is_exact_within_its_stated_bound_and_bitwise_where_stated(pairs):
    values = np.array(pairs)
    scaler = Scaler.fit(values)
    back = scaler.inverse(scaler.transform(values))
    away = np.abs(values - np.array(scaler.mean))
    bitwise = np.abs(values) >= 8.0 * away
    np.testing.assert_array_equal(back[bitwise], values[bitwise])
    assert (np.abs(back - values) <= 2.0**-51 * away + 1e-300).all()


def test_eastings_and_northings_of_a_mission_come_back_bitwise():
    spread = np.random.default_rng(1).uniform(-15_000.0, 15_000.0, (10_000, 2))
    values = spread + np.array([242_000.0, 3_890_000.0])
    scaler = Scaler.fit(values)
    np.testing.assert_array_equal(scaler.inverse(scaler.transform(values)), values)


def test_constant_column_becomes_0_and_comes_back():
    values = np.array([[0.1, 1.0], [0.1 + 1e-9, 3.0]])
    scaler = Scaler.fit(values)
    assert scaler.scale == (1.0, 1.0)
    np.testing.assert_allclose(scaler.transform(values)[:, 0], 0.0, atol=2e-9)
    np.testing.assert_array_equal(scaler.inverse(scaler.transform(values)), values)
    one = Scaler.fit(values[:1])
    assert one.transform(values[:1]).tolist() == [[0.0, 0.0]]


@pytest.mark.parametrize("values", [np.empty((0, 2)), np.array([[np.nan, 1.0]]), np.array([[np.inf, 1.0]])])
def test_nothing_to_fit_to_is_refused(values):
    with pytest.raises(InvalidInput, match="needs one or more"):
        Scaler.fit(values)


@pytest.mark.parametrize(
    ("mean", "scale", "said"),
    [((0.0,), (1.0, 1.0), "1 means and 2"), ((np.nan,), (1.0,), "finite"), ((0.0,), (0.0,), "above 0")],
)
def test_bad_scaler_never_exists(mean, scale, said):
    with pytest.raises(InvalidInput, match=said):
        Scaler(mean, scale)
