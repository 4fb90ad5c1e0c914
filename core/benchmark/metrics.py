"""Metrics of retrieval, and of positions and attitudes.

A ranking is an array (q, k) of distances or of hits: a row for each query, best answer first. As benchmarks define
metrics of one name differently, each docstring states the source of the definition.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Flags, Floats, Numbers
from ..errors import InvalidInput

#: Weights in SDM of distances in degrees (DenseUAV, arXiv 2201.09201) and in metres (GTA-UAV, arXiv 2409.16925).
SDM_PER_DEG, SDM_PER_M = 5e3, 1e-3
#: Steepness of PDM (AnyVisLoc, arXiv 2503.10692), and the distance in reference widths at which PDM is one half.
PDM_SHARPNESS, PDM_HALF = 6.0, 0.9
#: AnyVisLoc's limits of positions, metres.
WITHIN_M = (1.0, 3.0, 5.0, 10.0, 20.0)
#: OrthoLoC's limits of poses, metres and degrees.
WITHIN_M_DEG = ((0.1, 1.0), (0.25, 2.0), (0.5, 5.0), (1.0, 5.0), (5.0, 10.0))
#: LoD-Loc v3's limits of poses (arXiv 2603.19609), metres and degrees.
WITHIN_M_DEG_OF_BUILDINGS = ((2.0, 2.0), (3.0, 3.0), (5.0, 5.0))


class Shares(NamedTuple):
    """Median of errors, and shares below limits.

    Attributes
    ----------
    median : float
        NaN without errors.
    within : tuple of float
        Shares of all queries; queries without an answer count as beyond every limit.
    """

    median: float
    within: tuple[float, ...]


def hits(ranking: Numbers, positives: Sequence[Numbers]) -> Flags:
    """Whether each ranked reference (q, k) is a positive of its query; rankings are padded with -1."""
    _check_rows(ranking, len(positives))
    return np.array([np.isin(row, wanted) & (row >= 0) for row, wanted in zip(ranking, positives)], bool)


def recall(found: Flags, most: int) -> float:
    """Recall@K: the share of queries (q, k) with a positive among their first ``most`` references."""
    return float(found[:, : _checked(most)].any(axis=1).mean()) if len(found) else float("nan")


def top_percent(found: Flags, references: int) -> float:
    """University-1652's recall@1 %: recall among the first hundredth of references, rounded half to even, plus one."""
    return recall(found, round(references * 0.01) + 1)


def average_precision(found: Flags, positives: Numbers) -> float:
    """Mean over queries of the mean precision at hits, as in scikit-learn and GTA-UAV.

    Parameters
    ----------
    found : array (q, k) of bool
        Hits.
    positives : array (q,)
        Number of positives of each query; unranked positives add nothing, and queries without positives are left out.
    """
    rank = np.arange(1.0, found.shape[1] + 1.0)
    precision = np.cumsum(found, axis=1) / rank
    return _mean_of_precisions(np.where(found, precision, 0.0).sum(axis=1), positives)


def trapezoid_precision(found: Flags, positives: Numbers) -> float:
    """Mean average precision by trapezoids, as in University-1652 and DenseUAV; parameters as in `average_precision`.

    Each hit adds the mean of the precisions at its rank and at the previous one; before the first rank, it is 1.
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
    """SDM@K, spatial distance metric: mean of exp(-weight distance) over the first K = ``most`` references.

    Weights are K, K - 1, …, 1.

    Parameters
    ----------
    distances : array (q, k)
        From queries to their ranked references, in degrees or metres; NaN where no reference is ranked.
    weight : float
        `SDM_PER_DEG` or `SDM_PER_M`.
    """
    return _ranked_mean(np.exp(-weight * distances[:, : _checked(most)]), most)


def pdm(ratios: Floats, most: int) -> float:
    """AnyVisLoc's PDM@K: mean logistic nearness of the first K = ``most`` references, weighted as in `sdm`.

    ``ratios`` (q, k) are distances divided by the reference's width; NaN where no reference is ranked.
    """
    with np.errstate(over="ignore"):
        near = 1.0 / (1.0 + np.exp(PDM_SHARPNESS * (ratios[:, : _checked(most)] - PDM_HALF)))
    return _ranked_mean(near, most)


def _ranked_mean(values: Floats, most: int) -> float:
    """Mean over queries of values (q, k) with weights K, K - 1, …, 1; NaN counts as 0."""
    weights = np.arange(min(most, values.shape[1]), 0.0, -1.0)
    sums = np.nan_to_num(values, nan=0.0) @ weights / weights.sum()
    return float(sums.mean()) if len(sums) else float("nan")


def position_figures(errors_m: Floats, within_m: Sequence[float] = WITHIN_M) -> Shares:
    """Median and shares of position errors (q,), which are NaN for queries without an answer."""
    return Shares(_median(errors_m), tuple(float((errors_m <= limit).mean()) for limit in within_m))


def pose_figures(errors_m: Floats, errors_deg: Floats, within: Sequence[tuple[float, float]] = WITHIN_M_DEG) -> Shares:
    """Median of angles, and shares of poses (q,) with position and attitude both below limits (OrthoLoC)."""
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
