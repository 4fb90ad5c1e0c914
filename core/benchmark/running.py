"""Look up built-in and users' methods, and run them over the queries of a benchmark."""

from __future__ import annotations

import importlib
import math
import sys
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Numbers
from ..errors import InvalidInput, Message, TerrAInavError
from ..external.user_code import called, is_ctrl_c, output_apart
from ..text.plain import error_text, safe_str
from .answers import POSE, Answer, Locate, Method, Predictions, Query, checked_pose, visible_query
from .choices import METHODS
from .folder import Benchmark


def middle(benchmark: Benchmark, gallery: Numbers) -> Locate:
    """Method that always answers with the middle of the reference: a baseline that other methods have to beat."""
    mosaic = benchmark.mosaic
    lat, lon = (
        float(angle) for angle in mosaic.ground(np.array(mosaic.width_px / 2.0), np.array(mosaic.height_px / 2.0))
    )
    tiles = benchmark.references
    far = np.hypot(tiles.lat_deg[gallery] - lat, (tiles.lon_deg[gallery] - lon) * math.cos(math.radians(lat)))
    ranked = tuple(tiles.id[gallery[at]] for at in np.argsort(far, kind="stable")[:100].tolist())
    return lambda _: Answer(ranked, lat, lon)


def prior(benchmark: Benchmark, gallery: Numbers) -> Locate:  # noqa: ARG001  as all methods
    """Method that answers with the prior as it is: a baseline that methods which start from priors have to beat."""

    def locate(query: Query) -> Answer:
        place = query.prior_lat_deg, query.prior_lon_deg, query.ground_m + query.prior_agl_m
        return Answer((), *place, query.prior_yaw_deg, query.tilt_deg, query.roll_deg)

    return locate


def method_named(name: str) -> Method:
    """Return a built-in method by name, or a user's method by ``module:function``.

    Raises
    ------
    InvalidInput
        The method does not exist or cannot be imported.
    """
    if name in METHODS:
        module, function = METHODS[name]
        return getattr(importlib.import_module(module, __package__), function)  # type: ignore[no-any-return]
    module, colon, function = name.partition(":")
    if not colon:
        raise InvalidInput("method {0!r}: must be one of {1}, or module:function of your own", name, ", ".join(METHODS))
    # Find modules in the current folder, as `python -m` does.
    if "" not in sys.path:
        sys.path.insert(0, "")
    found = _imported(name, module, function)
    if not callable(found):
        raise InvalidInput("method {0!r}: is not a function", name)

    def prepared(benchmark: Benchmark, gallery: Numbers) -> Locate:
        locate = called(name, found, benchmark, gallery)
        if not callable(locate):
            raise InvalidInput("method {0}: returns {1}, not a function of a query", name, safe_str(locate, repr))
        tiles = len(benchmark.references)
        return lambda query: called(name, _answered, locate, query, tiles)

    return prepared


def _imported(name: str, module: str, function: str) -> Any:
    """Import a function of a user's module; raises InvalidInput."""
    try:
        with output_apart:
            return getattr(importlib.import_module(module), function)
    except BaseException as wrong:
        if is_ctrl_c(wrong):
            raise
        raise InvalidInput("method {0!r}: cannot be imported ({1})", name, error_text(wrong)) from wrong


def run_method(
    benchmark: Benchmark,
    method: Method,
    part: str = "",
    *,
    progress: Callable[[int, int], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Predictions | None:
    """Run a method over the queries of a part; None if cancelled.

    Parameters
    ----------
    part : str
        As in `score`.
    progress : callable
        Called with the number of answered queries and the number of all queries.
    cancelled : callable
        Called before each query; returns whether to stop.

    Raises
    ------
    InvalidInput
        The part has no queries, or the method does not return an `Answer`.
    """
    rows = benchmark.query_rows_in(part).tolist()
    locate = method(benchmark, benchmark.gallery(part))
    answers: list[Answer] = []
    seconds: list[float] = []
    for row in rows:
        if cancelled is not None and cancelled():
            return None
        begun = time.perf_counter()
        answers.append(_answered(locate, visible_query(benchmark, row), len(benchmark.references)))
        seconds.append(time.perf_counter() - begun)
        if progress is not None:
            progress(len(answers), len(rows))
    return Predictions.from_answers(benchmark, rows, answers, seconds)


def _answered(locate: Locate, query: Query, tiles: int) -> Answer:
    """Answer a query and convert the answer to plain values, as a user's method may return any types."""
    answer = locate(query)
    if not isinstance(answer, Answer):
        raise InvalidInput("method: answers {0} with {1}, not an Answer", query.id, safe_str(answer, repr))
    try:
        # Read at most one reference more than there are tiles: a generator may be endless.
        references = tuple(islice(iter(answer.references), tiles + 1))
        pose = {name: float(getattr(answer, name)) for name in POSE}
    except (TerrAInavError, MemoryError):
        raise
    except Exception as wrong:
        raise InvalidInput("method: the answer to {0} cannot be read ({1})", query.id, error_text(wrong)) from wrong
    if len(references) > tiles:
        raise InvalidInput("method: answers {0} with more references than there are: {1:,}", query.id, tiles)
    for reference in references:
        if not isinstance(reference, str):
            raise InvalidInput(
                "method: answers {0} with the reference {1}, not a text", query.id, safe_str(reference, repr)
            )
    return Answer(references, **checked_pose(pose, Message("method: answer to {0}:", query.id)))


def scores_folder(folder: Path, name: str, part: str = "") -> Path:
    """Folder inside the benchmark's folder for the scores of a method over a part, or over all queries."""
    return folder / "scores" / (f"{name}-{part}" if part else name).replace(":", "-")


def prediction_file(folder: Path, name: str) -> Path:
    """File for the predictions of a method, beside its scores."""
    return folder / f"{name.replace(':', '-')}.csv"
