"""Figures of rankings against their definitions, written once more query by query, as each benchmark states them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from terrainav.core.benchmark import metrics
from terrainav.core.errors import InvalidInput

RNG = np.random.default_rng(17)
REFERENCES = 130


@pytest.fixture
def drawn():
    """Complete rankings of 40 queries and their positives, of which there are 1 to 6."""
    ranking = np.array([RNG.permutation(REFERENCES) for _ in range(40)])
    positives = [RNG.choice(REFERENCES, RNG.integers(1, 7), replace=False) for _ in range(40)]
    return ranking, positives, metrics.hits(ranking, positives)


def ranks(ranking, positives):
    """Ranks from 1 on of a query's positives, sorted."""
    order = ranking.tolist()
    return sorted(order.index(one) + 1 for one in positives.tolist())


@pytest.mark.parametrize("most", [1, 5, 10, 130])
def test_recall_is_the_share_of_queries_with_a_positive_among_the_first(drawn, most):
    ranking, positives, found = drawn
    share = sum(ranks(row, wanted)[0] <= most for row, wanted in zip(ranking, positives)) / len(ranking)
    assert metrics.recall(found, most) == pytest.approx(share, abs=1e-9)


def test_the_first_percent_is_counted_as_university_1652_does(drawn):
    """Its curve is read at round(1 % of the references), from 0 on."""
    ranking, positives, found = drawn
    at = round(0.01 * REFERENCES)
    curve = np.zeros(REFERENCES)
    for row, wanted in zip(ranking, positives):
        curve[ranks(row, wanted)[0] - 1 :] += 1.0 / len(ranking)
    assert metrics.top_percent(found, REFERENCES) == pytest.approx(curve[at], abs=1e-9)


def test_average_precision_is_the_mean_of_precisions_at_hits(drawn):
    ranking, positives, found = drawn
    each = [
        np.mean([(count + 1) / rank for count, rank in enumerate(ranks(row, wanted))])
        for row, wanted in zip(ranking, positives)
    ]
    counts = np.array([len(wanted) for wanted in positives])
    assert metrics.average_precision(found, counts) == pytest.approx(np.mean(each), abs=1e-9)


def test_trapezoids_take_the_precision_before_each_hit_as_well(drawn):
    ranking, positives, found = drawn
    each = []
    for row, wanted in zip(ranking, positives):
        total = 0.0
        for count, rank in enumerate(ranks(row, wanted)):
            before = count / (rank - 1) if rank > 1 else 1.0
            total += (before + (count + 1) / rank) / 2.0
        each.append(total / len(wanted))
    counts = np.array([len(wanted) for wanted in positives])
    assert metrics.trapezoid_precision(found, counts) == pytest.approx(np.mean(each), abs=1e-9)


def test_queries_without_positives_count_in_no_average_precision(drawn):
    ranking, positives, _ = drawn
    found = metrics.hits(ranking[:2], [positives[0], np.array([], np.int64)])
    counts = np.array([len(positives[0]), 0])
    alone = metrics.average_precision(found[:1], counts[:1])
    assert metrics.average_precision(found, counts) == alone
    assert math.isnan(metrics.trapezoid_precision(found[1:], counts[1:]))


@pytest.mark.parametrize("weight", [metrics.SDM_PER_DEG, metrics.SDM_PER_M])
@pytest.mark.parametrize("most", [1, 3, 10])
def test_spatial_distance_metric(weight, most):
    distances = RNG.exponential(1.0 / weight, (30, 12))
    each = []
    for row in distances.tolist():
        over = sum((most - i) / math.exp(weight * row[i]) for i in range(most))
        each.append(over / sum(most - i for i in range(most)))
    assert metrics.sdm(distances, most, weight) == pytest.approx(np.mean(each), abs=1e-9)


@pytest.mark.parametrize("most", [1, 5, 40])
def test_the_metric_of_anyvisloc_ends_with_the_references(most):
    ratios = RNG.uniform(0.0, 3.0, (30, 12))
    each = []
    for row in ratios.tolist():
        counted = min(most, len(row))
        weights = range(counted, 0, -1)
        scores = [1.0 / (1.0 + math.exp(6.0 * (ratio - 0.9))) for ratio in row[:counted]]
        each.append(sum(w * s for w, s in zip(weights, scores)) / sum(weights))
    assert metrics.pdm(ratios, most) == pytest.approx(np.mean(each), abs=1e-9)


def test_what_is_not_answered_is_no_hit_and_not_near():
    found = metrics.hits(np.array([[3, -1], [-1, -1]]), [np.array([3]), np.array([2])])
    assert found.tolist() == [[True, False], [False, False]]
    assert metrics.recall(found, 2) == 0.5
    assert metrics.sdm(np.array([[0.0], [np.nan]]), 1, metrics.SDM_PER_M) == 0.5
    assert metrics.position_figures(np.array([0.5, np.nan, 4.0, 8.0])) == (4.0, (0.25, 0.25, 0.5, 0.75, 0.75))
    figures = metrics.pose_figures(np.array([0.05, 0.2, np.nan]), np.array([0.5, 20.0, np.nan]))
    assert figures.median == pytest.approx(10.25)
    assert figures.within == pytest.approx((1 / 3, 1 / 3, 1 / 3, 1 / 3, 1 / 3))


def test_figures_of_nothing_are_refused_or_not_known():
    with pytest.raises(InvalidInput, match="first 0 references: must be 1 or more"):
        metrics.recall(np.ones((1, 1), bool), 0)
    with pytest.raises(InvalidInput, match="rankings of 1 queries: there are 2"):
        metrics.hits(np.zeros((1, 3), np.int64), [np.array([1])] * 2)
    assert math.isnan(metrics.recall(np.ones((0, 3), bool), 1))
