from __future__ import annotations

import numpy as np
import pytest
from terrainav.core.dataset.entropy import otsu


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
