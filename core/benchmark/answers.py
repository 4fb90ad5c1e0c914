"""Queries as methods see them, answers, and files of predictions."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Floats, Numbers
from ..errors import InvalidInput
from ..geodesy.camera import Camera
from ..limits import MAX_RANKED
from .folder import Benchmark, read_number, read_rows, write_columns

#: Optional columns of a file of predictions, whose cells may be empty.
POSE = ("lat_deg", "lon_deg", "height_m", "yaw_deg", "tilt_deg", "roll_deg")
SECONDS = "seconds"


@dataclass(frozen=True)
class Query:
    """Query as a method sees it.

    Parameters
    ----------
    id : str
    image : Path
    camera : Camera
    fx_px, fy_px, cx_px, cy_px : float
        Intrinsics, as in `Queries`.
    height_m, ground_m : float
        Heights above the WGS 84 ellipsoid of the camera and of the ground below it, as if from a barometer.
    yaw_deg, tilt_deg, roll_deg : float
        Attitude of the camera, as if from a compass and an inertial unit.
    prior_lat_deg, prior_lon_deg, prior_agl_m, prior_yaw_deg : float
        Noisy measurements of a GNSS receiver, a barometer and a compass; NaN where there is no measurement.
    instances : Path or None
        Image of the numbers of the buildings that pixels show, as if segmented without an error; None if the benchmark
        has no buildings.
    """

    id: str
    image: Path
    camera: Camera
    fx_px: float
    fy_px: float
    cx_px: float
    cy_px: float
    height_m: float
    ground_m: float
    yaw_deg: float
    tilt_deg: float
    roll_deg: float
    prior_lat_deg: float = math.nan
    prior_lon_deg: float = math.nan
    prior_agl_m: float = math.nan
    prior_yaw_deg: float = math.nan
    instances: Path | None = None


@dataclass(frozen=True)
class Answer:
    """Answer of a method to a query; every field is optional.

    Parameters
    ----------
    references : sequence of str
        Ids of tiles, best first.
    lat_deg, lon_deg, height_m, yaw_deg, tilt_deg, roll_deg : float
        Pose of the camera; NaN where unknown.
    """

    references: Sequence[str] = ()
    lat_deg: float = math.nan
    lon_deg: float = math.nan
    height_m: float = math.nan
    yaw_deg: float = math.nan
    tilt_deg: float = math.nan
    roll_deg: float = math.nan

    def __post_init__(self) -> None:
        """Raise TypeError or ValueError for a wrong field here, rather than when the answer is scored."""
        iter(self.references)
        for name in POSE:
            float(getattr(self, name))


#: Localises one query.
Locate = Callable[[Query], Answer]
#: A method: prepares for a benchmark and a gallery (rows of the tiles to rank), and returns a function that localises
#: queries. It may read anything in the benchmark but the truth.
Method = Callable[[Benchmark, Numbers], Locate]


def visible_query(benchmark: Benchmark, index: int) -> Query:
    """Return a query as methods see it, without its position."""
    queries = benchmark.queries
    names = ("fx_px", "fy_px", "cx_px", "cy_px", "height_m", "ground_m", "yaw_deg", "tilt_deg", "roll_deg")
    values: dict[str, Any] = {name: float(getattr(queries, name)[index]) for name in names}
    prior_lat_deg, prior_lon_deg, prior_agl_m, prior_yaw_deg = benchmark.priors[index].tolist()
    return Query(
        queries.id[index],
        benchmark.folder / queries.file[index],
        queries.camera(index),
        **values,
        prior_lat_deg=prior_lat_deg,
        prior_lon_deg=prior_lon_deg,
        prior_agl_m=prior_agl_m,
        prior_yaw_deg=prior_yaw_deg,
        instances=benchmark.instance_file(index) if benchmark.has_buildings else None,
    )


@dataclass(frozen=True, eq=False)
class Predictions:
    """Answers to queries.

    Attributes
    ----------
    index : array (p,)
        Rows of the answered queries, each once.
    ranking : array (p, k)
        Rows of tiles, best first, padded with -1.
    pose : array (p, 6)
        Columns as in `POSE`; NaN where unknown.
    seconds : array (p,)
        Time taken by each answer; NaN where unknown.
    source : str
        File that the predictions were read from; empty if they were not read.
    """

    index: Numbers
    ranking: Numbers
    pose: Floats
    seconds: Floats
    source: str = ""

    @classmethod
    def from_answers(
        cls, benchmark: Benchmark, index: Sequence[int], answers: Sequence[Answer], seconds: Sequence[float]
    ) -> Predictions:
        """Predictions of answers; raises InvalidInput for unknown, repeated or too many tiles."""
        ranked = [_ranked(benchmark, answer.references, benchmark.queries.id[at]) for at, answer in zip(index, answers)]
        return cls._stacked(benchmark, index, ranked, answers, seconds)

    @classmethod
    def _stacked(
        cls,
        benchmark: Benchmark,
        index: Sequence[int],
        ranked: Sequence[Sequence[int]],
        answers: Sequence[Answer],
        seconds: Sequence[float],
    ) -> Predictions:
        # All rows of the array are as long as the longest ranking.
        longest, queries = max(map(len, ranked), default=0), len(benchmark.queries)
        if longest * queries > MAX_RANKED:
            raise InvalidInput(
                "predictions: query {0!r} ranks {1:,} tiles, and with {2:,} queries each may rank {3:,} at most",
                benchmark.queries.id[index[max(range(len(ranked)), key=lambda at: len(ranked[at]))]],
                longest,
                queries,
                MAX_RANKED // queries,
            )
        pose = [[getattr(answer, name) for name in POSE] for answer in answers]
        return cls(
            np.array(index, np.int64),
            _padded(ranked),
            np.array(pose, np.float64).reshape(-1, len(POSE)),
            np.array(seconds, np.float64),
        )

    @classmethod
    def read(cls, path: str | os.PathLike[str], benchmark: Benchmark) -> Predictions:
        """Predictions of a CSV file.

        The columns are ``query``, ``references`` (ids of tiles, best first, separated by spaces), the names in `POSE`,
        and ``seconds``. All but ``query`` are optional, and cells may be empty.

        Raises
        ------
        InvalidInput
            The file cannot be read, lacks columns, or names unknown queries or tiles; the message names the line.
        """
        lines = read_rows(Path(path), named_by_user=True)
        _, header = next(lines)
        known = [name for name in ("references", *POSE) if name in header]
        if "query" not in header or not known:
            raise InvalidInput(
                "predictions {0}: need the column query, and references or {1}; its columns are {2}",
                path,
                ", ".join(POSE[:2]),
                ", ".join(header),
            )
        if ("lat_deg" in header) != ("lon_deg" in header):
            raise InvalidInput("predictions {0}: lat_deg and lon_deg go together", path)
        line_numbers: dict[str, int] = {}
        answers: list[Answer] = []
        ranked: list[list[int]] = []
        seconds: list[float] = []
        for number, row in lines:
            where = f"predictions {path}, line {number}:"
            cells = dict(zip(header, row))
            name = cells["query"]
            if name not in benchmark.query_rows:
                raise InvalidInput("{0} query {1!r} is not in the benchmark", where, name)
            if line_numbers.setdefault(name, number) != number:
                raise InvalidInput("{0} query {1!r} is answered in line {2} already", where, name, line_numbers[name])
            values = checked_pose({one: read_number(cells.get(one, ""), f"{where} {one}") for one in POSE}, where)
            try:
                references = tuple(cells.get("references", "").split())
                ranked.append(_ranked(benchmark, references, name))
            except InvalidInput as wrong:
                raise InvalidInput("{0} {1}", where, wrong) from wrong
            answers.append(Answer(references, **values))
            seconds.append(read_number(cells.get(SECONDS, ""), f"{where} {SECONDS}"))
        if not answers:
            raise InvalidInput("predictions {0}: answer no query", path)
        index = [benchmark.query_rows[name] for name in line_numbers]
        found = cls._stacked(benchmark, index, ranked, answers, seconds)
        return replace(found, source=str(path))

    def write(self, path: Path, benchmark: Benchmark) -> None:
        """Write the file that `read` reads."""
        tiles = benchmark.references.id
        columns: dict[str, Sequence[str] | Floats] = {
            "query": [benchmark.queries.id[at] for at in self.index.tolist()],
            "references": [" ".join(tiles[at] for at in row if at >= 0) for row in self.ranking.tolist()],
        }
        columns.update(zip(POSE, self.pose.T))
        columns[SECONDS] = self.seconds
        write_columns(path, columns)


def checked_pose(pose: Mapping[str, float], where: str) -> Mapping[str, float]:
    """Return a pose keyed by `POSE`; raises InvalidInput, beginning with ``where``, if it is infinite or impossible."""
    if abs(pose["lat_deg"]) > 90.0 or abs(pose["lon_deg"]) > 360.0:
        raise InvalidInput("{0} {1:g}, {2:g} is not on the Earth", where, pose["lat_deg"], pose["lon_deg"])
    for name, value in pose.items():
        if math.isinf(value):
            raise InvalidInput("{0} {1} {2:g}: must be a finite number", where, name, value)
    return pose


def _ranked(benchmark: Benchmark, references: Sequence[str], query: str) -> list[int]:
    unknown = [name for name in references if name not in benchmark.reference_rows]
    if unknown:
        raise InvalidInput("reference {0!r} of query {1!r} is not in the benchmark", unknown[0], query)
    if len(set(references)) != len(references):
        raise InvalidInput("references of query {0!r}: one is named twice", query)
    return [benchmark.reference_rows[name] for name in references]


def _padded(rows: Sequence[Sequence[int]]) -> Numbers:
    """Array of rankings, padded with -1."""
    ranking = np.full((len(rows), max(map(len, rows), default=0)), -1, np.int64)
    for at, row in enumerate(rows):
        ranking[at, : len(row)] = row
    return ranking
