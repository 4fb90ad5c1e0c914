"""Figures of how well queries are found in references: of rankings, and of positions and attitudes.

A ranking is an array (q, k) of distances or of hits, one row for each query, its best answer first. Definitions differ
between benchmarks that use one name; each here says whose it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..errors import InvalidInput

#: What SDM weighs distances by: DenseUAV counts degrees of latitude and longitude (arXiv 2201.09201), GTA-UAV metres
#: (arXiv 2409.16925).
SDM_PER_DEG, SDM_PER_M = 5e3, 1e-3
#: Of PDM (AnyVisLoc, arXiv 2503.10692): how sharply it falls, and the share of a reference's width at which it is half.
PDM_SHARPNESS, PDM_HALF = 6.0, 0.9
#: Metres within which AnyVisLoc counts positions.
WITHIN_M = (1.0, 3.0, 5.0, 10.0, 20.0)
#: Metres and degrees within which poses count together (OrthoLoC).
WITHIN_M_DEG = ((0.1, 1.0), (0.25, 2.0), (0.5, 5.0), (1.0, 5.0), (5.0, 10.0))


class Shares(NamedTuple):
    """Errors in figures.

    Attributes
    ----------
    median : float
        NaN without any.
    within : tuple of float
        Shares of all queries, those without an answer counted as not within.
    """

    median: float
    within: tuple[float, ...]


def hits(ranking: Numbers, positives: Sequence[Numbers]) -> Flags:
    """Which ranked references (q, k) are among each query's positives; -1 in a ranking stands for no answer."""
    _check_rows(ranking, len(positives))
    return np.array([np.isin(row, wanted) & (row >= 0) for row, wanted in zip(ranking, positives)], bool)


def recall(found: Flags, most: int) -> float:
    """Recall@K: the share of queries (q, k) with a positive among their first ``most`` references."""
    return float(found[:, : _checked(most)].any(axis=1).mean()) if len(found) else float("nan")


def top_percent(found: Flags, references: int) -> float:
    """Recall@1 %: University-1652's, whose first hundredth of the references has one more, rounded half to even."""
    return recall(found, round(references * 0.01) + 1)


def average_precision(found: Flags, positives: Numbers) -> float:
    """Mean of the queries' average precisions, as scikit-learn and GTA-UAV have it: of precisions at each hit.

    Parameters
    ----------
    found : array (q, k) of bool
        Hits.
    positives : array (q,)
        How many positives each query has; positives that are not ranked add nothing, queries without any do not count.
    """
    rank = np.arange(1.0, found.shape[1] + 1.0)
    precision = np.cumsum(found, axis=1) / rank
    return _mean_of_precisions(np.where(found, precision, 0.0).sum(axis=1), positives)


def trapezoid_precision(found: Flags, positives: Numbers) -> float:
    """Average precision by trapezoids, as University-1652 and DenseUAV have it; parameters as of `average_precision`.

    Each hit counts the mean of the precision at it and right before it, which at the first rank is 1.
    """
    rank = np.arange(1.0, found.shape[1] + 1.0)
    count = np.cumsum(found, axis=1)
    before = np.where(rank > 1.0, (count - 1.0) / np.maximum(rank - 1.0, 1.0), 1.0)
    both = np.where(found, (count / rank + before) / 2.0, 0.0)
    return _mean_of_precisions(both.sum(axis=1), positives)


def _mean_of_precisions(sums: Floats, positives: Numbers) -> float:
    some = positives > 0
    return float((sums[some] / positives[some]).mean()) if some.any() else float("nan")


def sdm(distances: Floats, most: int, weight: float) -> float:
    """SDM@K, spatial distance metric: nearness of the first ``most`` references, the first ones weighing more.

    Parameters
    ----------
    distances : array (q, k)
        From queries to the references that they are given, in degrees or in metres; NaN for none.
    weight : float
        `SDM_PER_DEG` or `SDM_PER_M`.
    """
    return _ranked_mean(np.exp(-weight * distances[:, : _checked(most)]), most)


def pdm(ratios: Floats, most: int) -> float:
    """PDM@K, AnyVisLoc's: nearness of the first ``most`` references, (q, k), the first ones weighing more.

    ``ratios`` are distances over the width of the reference; NaN for none.
    """
    with np.errstate(over="ignore"):
        near = 1.0 / (1.0 + np.exp(PDM_SHARPNESS * (ratios[:, : _checked(most)] - PDM_HALF)))
    return _ranked_mean(near, most)


def _ranked_mean(values: Floats, most: int) -> float:
    """Mean over queries of values (q, k) weighed K, K - 1, …, 1; what is not there counts 0."""
    weights = np.arange(min(most, values.shape[1]), 0.0, -1.0)
    sums = np.nan_to_num(values, nan=0.0) @ weights / weights.sum()
    return float(sums.mean()) if len(sums) else float("nan")


def position_figures(errors_m: Floats, within_m: Sequence[float] = WITHIN_M) -> Shares:
    """Median and shares of errors (q,) of positions; NaN for queries without an answer."""
    return Shares(_median(errors_m), tuple(float((errors_m <= limit).mean()) for limit in within_m))


def pose_figures(errors_m: Floats, errors_deg: Floats, within: Sequence[tuple[float, float]] = WITHIN_M_DEG) -> Shares:
    """Median of the angles, and shares of poses (q,) whose position and attitude are both below limits (OrthoLoC)."""
    both = tuple(float(((errors_m < m) & (errors_deg < deg)).mean()) for m, deg in within)
    return Shares(_median(errors_deg), both)


def _median(errors: Floats) -> float:
    known = errors[np.isfinite(errors)]
    return float(np.median(known)) if len(known) else float("nan")


def _checked(most: int) -> int:
    if most < 1:
        raise InvalidInput("first {0} references: must be 1 or more", most)
    return most


def _check_rows(ranking: Numbers, queries: int) -> None:
    if len(ranking) != queries:
        raise InvalidInput("rankings of {0} queries: there are {1}", len(ranking), queries)
