"""Answers compared with the truth, in the figures that publications report."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..arrays import Floats, NDArray, Numbers
from ..errors import Cancelled, InvalidInput, Message
from ..geodesy.camera import image_axes
from ..geodesy.local import LocalFrame, enu_axes
from ..geodesy.projections import geodesics
from . import metrics
from .answers import POSE, Predictions
from .folder import Benchmark, Columns, write_columns

#: Ranks K at which retrieval is reported.
RANKS = (1, 5, 10)
ALL = "all"


class Figure(NamedTuple):
    """A number with its unit and definition.

    Attributes
    ----------
    name, unit : str
        The unit is empty for counts, and for shares, which are from 0 to 1.
    value : float
        NaN without anything to count or average.
    definition : str
    """

    name: str
    value: float
    unit: str
    definition: str


@dataclass(frozen=True, eq=False)
class Errors(Columns):
    """Errors of the answers to q queries; NaN where an answer lacks the values for an error.

    Parameters
    ----------
    query, imagery : tuple of str
    lat_deg, lon_deg : array (q,)
        True position of the camera.
    predicted_lat_deg, predicted_lon_deg : array (q,)
    error_m : array (q,)
        Distance along the ground between true and predicted position.
    distance_m : array (q,)
        Distance between true and predicted camera in space.
    error_deg : array (q,)
        Angle between true and predicted attitude.
    rank : array (q,)
        Rank of the first positive tile, from 1.
    tile_m : array (q,)
        Distance from the ground at the query's centre to the centre of the first tile.
    seconds : array (q,)
    mask_iou : array (q,)
        Intersection over union of the query's mask of buildings and their silhouette at the predicted pose, 0 without
        one; NaN for queries that show no building, and for benchmarks without.
    """

    query: tuple[str, ...]
    imagery: tuple[str, ...]
    lat_deg: Floats
    lon_deg: Floats
    predicted_lat_deg: Floats
    predicted_lon_deg: Floats
    error_m: Floats
    distance_m: Floats
    error_deg: Floats
    rank: Floats
    tile_m: Floats
    seconds: Floats
    mask_iou: Floats

    def write(self, path: Path) -> None:
        """Write the table atomically, without the column of masks if there are none."""
        columns = {one.name: getattr(self, one.name) for one in fields(self)}
        if np.isnan(self.mask_iou).all():
            del columns["mask_iou"]
        write_columns(path, columns)


@dataclass(frozen=True, eq=False)
class Scores:
    """Figures of a method.

    Attributes
    ----------
    groups : dict of str to tuple of Figure
        Figures by the queries' imagery, and for `ALL` queries if there are several imageries.
    recall : dict of str to array (k,)
        Recall@1 to recall@k of each group.
    errors : Errors
    tiles : int
        Number of tiles in the gallery.
    part : str
        Part of the queries; empty for all.
    """

    groups: dict[str, tuple[Figure, ...]]
    recall: dict[str, Floats]
    errors: Errors
    tiles: int
    part: str


class _Compared(NamedTuple):
    """Errors, hits and distances (q, k) of tiles, and whether any answer has a ranking, a position or an attitude."""

    errors: Errors
    hits: NDArray[np.bool_]
    positives: Numbers
    centre_m: Floats
    centre_deg: Floats
    widths: Floats
    is_ranked: bool
    is_placed: bool
    is_posed: bool

    def take(self, rows: Numbers) -> _Compared:
        """Comparison of some queries, by row."""
        return _Compared(
            self.errors.take(rows),
            self.hits[rows],
            self.positives[rows],
            self.centre_m[rows],
            self.centre_deg[rows],
            self.widths[rows],
            self.is_ranked,
            self.is_placed,
            self.is_posed,
        )


def score(
    benchmark: Benchmark,
    predictions: Predictions,
    part: str = "",
    *,
    progress: Callable[[int, int], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Scores:
    """Compare predictions with the truth.

    Parameters
    ----------
    part : str
        ``train``, ``validation`` or ``test`` to score the part's queries, searched among its tiles; empty for all.
    progress : callable
        Called with the number of queries whose silhouettes were compared, and the number of all queries.
    cancelled : callable
        Called before each silhouette; returns whether to stop.

    Raises
    ------
    InvalidInput
        The part has no queries, or an answer ranks tiles of another part; the benchmark has buildings that cannot be
        rendered.
    Cancelled
        ``cancelled`` returned true.
    """
    rows, gallery = benchmark.query_rows_in(part), benchmark.gallery(part)
    compared = _compare(benchmark, predictions, rows, gallery)
    if benchmark.has_buildings and compared.is_posed:
        iou = _mask_overlaps(benchmark, predictions, rows, progress, cancelled)
        compared = compared._replace(errors=replace(compared.errors, mask_iou=iou))
    imagery = np.array(compared.errors.imagery)
    names = list(dict.fromkeys(compared.errors.imagery))
    rows_by_group = {name: np.flatnonzero(imagery == name) for name in names}
    if len(names) > 1:
        rows_by_group = {ALL: np.arange(len(rows)), **rows_by_group}
    groups, recall = {}, {}
    for name, some in rows_by_group.items():
        group = compared.take(some)
        groups[name] = tuple(_figures(group, len(gallery)))
        findable = group.hits[group.positives > 0]
        if group.is_ranked and len(findable):
            recall[name] = np.logical_or.accumulate(findable, axis=1).mean(axis=0)
    return Scores(groups, recall, compared.errors, len(gallery), part)


def _compare(benchmark: Benchmark, predictions: Predictions, rows: Numbers, gallery: Numbers) -> _Compared:
    """Compare the answers to some queries with the truth."""
    queries, tiles = benchmark.queries, benchmark.references
    answer = np.full(len(queries), -1, np.int64)
    answer[predictions.index] = np.arange(len(predictions.index))
    at = answer[rows]
    is_answered = at >= 0
    ranking = np.full((len(rows), max(predictions.ranking.shape[1], 1)), -1, np.int64)
    ranking[is_answered, : predictions.ranking.shape[1]] = predictions.ranking[at[is_answered]]
    foreign = np.setdiff1d(ranking[ranking >= 0], gallery)
    if len(foreign):
        raise InvalidInput(
            "{0}: rank {1}, which is of another part than the queries",
            Message("predictions {0}", predictions.source) if predictions.source else Message("predictions"),
            tiles.id[foreign[0]],
            remedy="leave the tiles of other parts out, or run the method on the part (terrainav benchmark run --part)",
        )
    pose, seconds = np.full((len(rows), len(POSE)), np.nan), np.full(len(rows), np.nan)
    pose[is_answered] = predictions.pose[at[is_answered]]
    seconds[is_answered] = predictions.seconds[at[is_answered]]
    right = benchmark.positives()
    positives = [right[row] for row in rows.tolist()]
    hits = metrics.hits(ranking, positives)
    centre_m, centre_deg = _tile_distances(benchmark, rows, ranking)
    lat, lon, height, *attitude = pose.T
    truth = (
        queries.lat_deg[rows],
        queries.lon_deg[rows],
        queries.height_m[rows],
        *(angle[rows] for angle in (queries.yaw_deg, queries.tilt_deg, queries.roll_deg)),
    )
    first = np.where(hits.any(axis=1), hits.argmax(axis=1) + 1.0, np.nan)
    errors = Errors(
        query=tuple(queries.id[row] for row in rows.tolist()),
        imagery=tuple(queries.imagery[row] for row in rows.tolist()),
        lat_deg=truth[0],
        lon_deg=truth[1],
        predicted_lat_deg=lat,
        predicted_lon_deg=lon,
        error_m=_ground_m(truth[0], truth[1], lat, lon),
        distance_m=_space_m(truth[:3], (lat, lon, height)),
        error_deg=_between_deg((*truth[:2], *truth[3:]), (lat, lon, *attitude)),
        rank=first,
        tile_m=centre_m[:, 0],
        seconds=seconds,
        mask_iou=np.full(len(rows), np.nan),
    )
    widths = np.where(ranking >= 0, tiles.width_m[ranking], np.nan)
    counts = np.array([len(one) for one in positives], np.int64)
    return _Compared(
        errors,
        hits,
        counts,
        centre_m,
        centre_deg,
        widths,
        bool((ranking >= 0).any()),
        bool(np.isfinite(errors.error_m).any()),
        bool(np.isfinite(errors.error_deg).any()),
    )


def _figures(compared: _Compared, tiles: int) -> list[Figure]:
    """Figures of a group of queries."""
    errors = compared.errors
    count = len(errors.query)
    answered = np.isfinite(errors.error_m) | np.isfinite(errors.tile_m)
    found = [Figure("queries", float(count), "", f"asked for; {int(answered.sum()):,} answered")]
    if compared.is_ranked:
        found += _ranking_figures(compared, tiles)
    if compared.is_placed:
        position = metrics.position_figures(errors.error_m)
        found.append(Figure("position", position.median, "m", "median error along the ground, of those answered"))
        found += [
            Figure(f"within {limit:g} m", share, "", "of all queries, along the ground")
            for limit, share in zip(metrics.WITHIN_M, position.within)
        ]
    if compared.is_posed:
        pose = metrics.pose_figures(errors.distance_m, errors.error_deg)
        found.append(Figure("attitude", pose.median, "deg", "median angle between attitudes, of those answered"))
        found += [
            Figure(f"within {m:g} m, {deg:g} deg", share, "", "of all queries, in space (OrthoLoC)")
            for (m, deg), share in zip(metrics.WITHIN_M_DEG, pose.within)
        ]
    if np.isfinite(errors.mask_iou).any():
        found += _silhouette_figures(errors)
    if np.isfinite(errors.seconds).any():
        found.append(Figure("time", float(np.nanmedian(errors.seconds)), "s", "median for a query"))
    return found


def _silhouette_figures(errors: Errors) -> list[Figure]:
    """Figures of queries with masks of buildings."""
    limits = metrics.WITHIN_M_DEG_OF_BUILDINGS
    shares = metrics.pose_figures(errors.distance_m, errors.error_deg, limits).within
    shown = int(np.isfinite(errors.mask_iou).sum())
    return [
        *(
            Figure(f"within {m:g} m, {deg:g} deg", share, "", "of all queries, in space (LoD-Loc v3)")
            for (m, deg), share in zip(limits, shares)
        ),
        Figure(
            "mask IoU",
            _mean(errors.mask_iou),
            "",
            f"mean intersection over union of mask and silhouette at the answer, of {shown:,} queries with buildings",
        ),
    ]


def _ranking_figures(compared: _Compared, tiles: int) -> list[Figure]:
    """Figures of retrieval."""
    findable = compared.positives > 0
    hits, counts = compared.hits[findable], compared.positives[findable]
    rest = int((~findable).sum())
    of_what = f"of {len(counts):,} queries that have a tile that is right" + (f", {rest:,} have none" if rest else "")
    found = [
        Figure(f"recall@{k}", metrics.recall(hits, k), "", f"a right tile among the first {k}, {of_what}")
        for k in RANKS
    ]
    if len(hits):
        percent = round(tiles * 0.01) + 1
        found.append(
            Figure(
                "recall@1%",
                metrics.top_percent(hits, tiles),
                "",
                f"among the first {percent} of {tiles:,} tiles",
            )
        )
    found += [
        Figure("AP", metrics.average_precision(hits, counts), "", "mean of precisions at hits (GTA-UAV)"),
        Figure("AP trapezoid", metrics.trapezoid_precision(hits, counts), "", "University-1652's and DenseUAV's"),
    ]
    for k in RANKS[:2]:
        weights = f"first {k} tiles, weights {k} to 1" if k > 1 else "first tile"
        found += [
            Figure(
                f"SDM@{k} per metre",
                metrics.sdm(compared.centre_m, k, metrics.SDM_PER_M),
                "",
                f"mean of exp(-0.001 d), d in metres to the {weights} (GTA-UAV)",
            ),
            Figure(
                f"SDM@{k} per degree",
                metrics.sdm(compared.centre_deg, k, metrics.SDM_PER_DEG),
                "",
                f"mean of exp(-5000 d), d in degrees to the {weights} (DenseUAV)",
            ),
            Figure(
                f"PDM@{k}",
                metrics.pdm(compared.centre_m / compared.widths, k),
                "",
                f"mean of 1 / (1 + exp(6 (d - 0.9))), d in tile widths to the {weights} (AnyVisLoc)",
            ),
        ]
    found.append(
        Figure(
            "Dis@1",
            _mean(compared.centre_m[:, 0]),
            "m",
            "mean distance from the ground in the middle of the query to the middle of the first tile (GTA-UAV)",
        )
    )
    return found


def _mask_overlaps(
    benchmark: Benchmark,
    predictions: Predictions,
    rows: Numbers,
    progress: Callable[[int, int], object] | None,
    cancelled: Callable[[], bool] | None,
) -> Floats:
    """Intersection over union (q,) of queries' masks and silhouettes at their answers; see `Errors`."""
    # Imported here, as only such benchmarks need vector files.
    from .silhouettes import Silhouettes, overlap

    silhouettes, found = Silhouettes.from_benchmark(benchmark), np.full(len(rows), np.nan)
    answers = dict(zip(predictions.index.tolist(), predictions.pose))
    for at, row in enumerate(rows.tolist()):
        if cancelled is not None and cancelled():
            raise Cancelled("nothing was written")
        mask = silhouettes.mask(row)
        if mask.any():
            found[at] = overlap(mask, silhouettes.render(row, answers[row])) if row in answers else 0.0
        if progress is not None:
            progress(at + 1, len(rows))
    return found


def _mean(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.mean()) if len(known) else math.nan


def _tile_distances(benchmark: Benchmark, rows: Numbers, ranking: Numbers) -> tuple[Floats, Floats]:
    """Distances (q, k) from the ground at queries' centres to the centres of tiles, in metres and in degrees."""
    queries, tiles = benchmark.queries, benchmark.references
    lat, lon = (np.where(ranking >= 0, angle[ranking], np.nan) for angle in (tiles.lat_deg, tiles.lon_deg))
    query_lat, query_lon = (
        np.broadcast_to(angle[rows, np.newaxis], lat.shape)
        for angle in (queries.centre_lat_deg, queries.centre_lon_deg)
    )
    dlon = lon - query_lon
    dlon -= 360.0 * np.rint(dlon / 360.0)
    return _ground_m(query_lat, query_lon, lat, lon), np.sqrt((lat - query_lat) ** 2 + dlon**2)


def _ground_m(lat: Floats, lon: Floats, other_lat: Floats, other_lon: Floats) -> Floats:
    """Geodesic distances (any shape); NaN where a position is NaN."""
    found = np.full(lat.shape, np.nan)
    known = np.isfinite(lat) & np.isfinite(lon) & np.isfinite(other_lat) & np.isfinite(other_lon)
    *_, found[known] = geodesics(*(values[known] for values in (lat, lon, other_lat, other_lon)))
    return found


def _space_m(place: Sequence[Floats], other: Sequence[Floats]) -> Floats:
    """Distances (q,) in space between positions (latitude, longitude, height); NaN where ``other`` has a NaN."""
    found = np.full(len(place[0]), np.nan)
    for at in np.flatnonzero(np.isfinite(other).all(axis=0)).tolist():
        frame = LocalFrame(*(float(values[at]) for values in place))
        found[at] = np.linalg.norm(frame.enu(*(np.array(values[at]) for values in other)))
    return found


def _between_deg(pose: Sequence[Floats], other: Sequence[Floats]) -> Floats:
    """Angles (q,) between poses (latitude, longitude, yaw, tilt, roll); NaN where ``other`` has a NaN."""
    found = np.full(len(pose[0]), np.nan)
    for at in np.flatnonzero(np.isfinite(other).all(axis=0)).tolist():
        axes = [
            np.stack(image_axes(*attitude)) @ enu_axes(lat, lon)
            for lat, lon, *attitude in ([float(values[at]) for values in one] for one in (pose, other))
        ]
        # Computed from the chord between axes, as the arccosine of the trace loses the digits of small angles.
        chord = np.linalg.norm(axes[0] - axes[1])
        found[at] = math.degrees(2.0 * math.asin(min(float(chord) / math.sqrt(8.0), 1.0)))
    return found
