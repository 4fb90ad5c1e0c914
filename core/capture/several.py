"""Captures beside each other in one folder, each a dataset of its own: of several imageries, views or references."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..dataset.folder import JOURNAL_FILE, MISSION_FILE
from ..errors import InvalidInput
from ..imagery.opening import NamedSource
from ..imagery.source import Source
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..storage.stores import is_address, is_file, store_path
from .begun import hold_to_mission
from .folder import check_captured, open_place
from .holding import held
from .making import check_source
from .progress import CaptureResult, Progress
from .runner import capture

__all__ = ["capture_each", "capture_imageries", "combined"]


def capture_imageries(
    mission: Mission,
    plans: Mapping[str, Plan],
    sources: Mapping[str, Source | NamedSource],
    folder: str | os.PathLike[str],
    *,
    resume: bool = False,
    only_failed: bool = False,
    progress: Callable[[Progress], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
    **how: Any,
) -> CaptureResult:
    """Capture a mission of several imageries: a dataset of each in a folder of its name, ``mission.json`` above them.

    Images of one place have the same column and row in all of them. What commands on datasets do, such as splitting,
    they do to the folder as a whole.

    Parameters
    ----------
    mission : Mission
        With ``imageries``.
    plans, sources : mapping of str to Plan, and to Source
        By the imageries' names: of `Mission.by_imagery`, each with its source's own pixel grid.
    resume, only_failed, progress, cancelled, **how
        As for `capture`; progress, failures and repeats say the imagery's name in the place of a map type, and the
        total is that of all.

    Raises
    ------
    InvalidInput, OutputError, SourceError
        As for `capture`; of what a source does not have, before anything is written.
    """
    names = [one.name for one in mission.imagery.named]
    if list(plans) != names or set(sources) != set(names):
        raise InvalidInput("imageries {0}: need a plan and a source each", " ".join(names))
    for name in names:
        check_source(plans[name], sources[name])
    if only_failed and not is_address(folder):
        check_captured(folder)
    path = open_place(store_path(folder), mission, resume=resume or only_failed)
    with held(path) as check:
        hold_to_mission(path, mission)

        def ends() -> bool:
            check()
            return cancelled is not None and cancelled()

        results = capture_each(
            {name: (plans[name], sources[name]) for name in names},
            path,
            only_failed=only_failed,
            progress=progress,
            cancelled=ends,
            **how,
        )
    result = combined(path, results)
    # What was asked for, also where the run was stopped before it came to the last imagery.
    return result if only_failed else replace(result, total=sum(map(len, plans.values())))


def capture_each(
    captures: Mapping[str, tuple[Plan, Source | NamedSource]],
    folder: Path,
    *,
    only_failed: bool = False,
    progress: Callable[[Progress], object] | None = None,
    cancelled: Callable[[], bool] | None = None,
    **how: Any,
) -> dict[str, CaptureResult]:
    """Capture one after the other, each into its folder inside one that is the run's own; go on with what is there.

    Parameters
    ----------
    captures : mapping of str to (Plan, Source or NamedSource)
        By the folders' names, with ``/`` where they lie deeper.
    only_failed, progress, cancelled, **how
        As for `capture`; progress says the folder in the place of the map type.

    Returns
    -------
    dict of str to CaptureResult
        By the folders' names; where one was stopped it is the last.
    """
    results: dict[str, CaptureResult] = {}
    for name, (plan, source) in captures.items():
        begun = any(is_file(folder / name / file) for file in (JOURNAL_FILE, MISSION_FILE))
        if only_failed and not begun:
            # Nothing of it can have failed: an earlier run was stopped before it.
            continue
        results[name] = capture(
            plan,
            source,
            folder / name,
            resume=True,
            only_failed=only_failed,
            progress=None if progress is None else partial(_tell, progress, name),
            cancelled=cancelled,
            **how,
        )
        if results[name].cancelled:
            break
    return results


def _tell(progress: Callable[[Progress], object], name: str, report: Progress) -> None:
    progress(replace(report, map_type=name))


def combined(folder: Path, results: Mapping[str, CaptureResult]) -> CaptureResult:
    """Return the results of captures as one; what failed or repeats has its folder in the place of the map type."""
    done = results.values()
    return CaptureResult(
        folder=folder,
        total=sum(one.total for one in done),
        written=sum(one.written for one in done),
        failed=tuple(
            replace(failure, map_type=name) for name, one in results.items() for failure in one.failed
        ),
        skipped=sum(one.skipped for one in done),
        requests=sum(one.requests for one in done),
        unique_parts=sum(one.unique_parts for one in done),
        seconds=sum(one.seconds for one in done),
        cancelled=any(one.cancelled for one in done),
        repeated=tuple(
            replace(repeat, map_type=name) for name, one in results.items() for repeat in one.repeated
        ),
    )
