from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.dataset.entropy import otsu, separates_groups


def within_group_variance(values, threshold):
    """Otsu's own definition: the sum of the groups' variances, weighted by their shares."""
    groups = values[values < threshold], values[values >= threshold]
    return sum(len(group) * group.var() for group in groups if len(group)) / len(values)


@pytest.mark.parametrize("seed", range(8))
def test_no_other_threshold_parts_better(seed):
    random = np.random.default_rng(seed)
    values = np.concatenate([random.normal(0.8, 0.3, 40), random.normal(4.0, 0.8, 25)])
    best = within_group_variance(values, otsu(values))
    for other in np.linspace(values.min(), values.max(), 400):
        assert best <= within_group_variance(values, other) + 1e-12


def test_it_lies_in_the_gap_between_two_groups():
    assert otsu(np.array([0.1, 0.2, 0.15, 5.0, 5.2])) == pytest.approx((0.2 + 5.0) / 2)
    assert otsu(np.array([1.0, 3.0])) == 2.0


@pytest.mark.parametrize("values", [[], [2.0], [2.0, 2.0, 2.0]])
def test_what_is_all_the_same_has_none(values):
    assert otsu(np.array(values)) is None


@pytest.mark.parametrize(
    "draw",
    [
        lambda random, count: random.normal(5.0, 0.4, count),
        lambda random, count: random.uniform(3.0, 6.0, count),
        lambda random, count: 6.0 - random.gamma(3.0, 0.4, count),
    ],
    ids=["normal", "even", "skewed"],
)
@pytest.mark.parametrize("count", [40, 400, 4000])
def test_one_group_is_not_parted(draw, count):
    found = [draw(np.random.default_rng(seed), count) for seed in range(20)]
    parted = sum(separates_groups(values, otsu(values)) for values in found)
    # Some dozens of values may well lie in two heaps by chance.
    assert parted <= (2 if count == 40 else 0)


@pytest.mark.parametrize("share", [0.05, 0.42, 0.8])
@pytest.mark.parametrize("count", [40, 400, 4000])
def test_two_groups_are_parted(share, count):
    for seed in range(10):
        random = np.random.default_rng(seed)
        low = max(round(share * count), 2)
        values = np.concatenate([random.normal(1.0, 0.15, low), random.normal(4.0, 0.4, count - low)])
        assert separates_groups(values, otsu(values))


def test_thresholds_beside_all_values_part_nothing():
    values = np.array([1.0, 1.1, 4.0, 4.1])
    assert separates_groups(values, 2.5)
    assert not separates_groups(values, 0.5)
    assert not separates_groups(values, 9.0)
    assert not separates_groups(np.array([1.0]), 1.0)
    assert not separates_groups(np.empty(0), 1.0)
