"""Several captures in one folder, each a dataset of one imagery, view or reference."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..dataset.folder import JOURNAL_FILE, MISSION_FILE
from ..errors import InvalidInput
from ..imagery.opening import NamedSource
from ..imagery.source import Source
from ..mission.mission import Mission
from ..mission.plan import Plan
from ..storage.stores import is_address, is_file, store_path
from .folder import capture_folder, check_captured
from .making import check_source
from .progress import SILENT, CaptureResult, Listener
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
    listener: Listener = SILENT,
    **how: Any,
) -> CaptureResult:
    """Capture a mission of several imageries, each into a subfolder of its name, beside ``mission.json``.

    Images of one place have the same column and row in all datasets. Commands on datasets, such as splitting, take the
    folder as a whole.

    Parameters
    ----------
    mission : Mission
        Mission with ``imageries``.
    plans, sources : mapping of str to Plan, and to Source
        Keyed by the names in `Mission.missions_by_imagery`; each plan has the pixel grid of its source.
    resume, only_failed, listener, **how
        As for `capture`; progress, failures and repeats have the imagery's name in place of the map type, and the
        total is over all imageries.

    Raises
    ------
    InvalidInput, OutputError, SourceError
        As for `capture`.
    """
    names = [one.name for one in mission.imagery.named]
    if list(plans) != names or set(sources) != set(names):
        raise InvalidInput("imageries {0}: need a plan and a source each", " ".join(names))
    for name in names:
        check_source(plans[name], sources[name])
    path = store_path(folder)
    if only_failed and not is_address(path):
        check_captured(path)
    with capture_folder(path).opened(mission, resume=resume or only_failed) as check:
        results = capture_each(
            {name: (plans[name], sources[name]) for name in names},
            path,
            only_failed=only_failed,
            listener=listener.guarded(check),
            **how,
        )
    result = combined(path, results)
    # All images requested, even if the run stopped before the last imagery.
    return result if only_failed else replace(result, total=sum(map(len, plans.values())))


def capture_each(
    captures: Mapping[str, tuple[Plan, Source | NamedSource]],
    folder: Path,
    *,
    only_failed: bool = False,
    listener: Listener = SILENT,
    **how: Any,
) -> dict[str, CaptureResult]:
    """Capture or resume plans one after the other, each in a subfolder of a folder that the run holds.

    Parameters
    ----------
    captures : mapping of str to (Plan, Source or NamedSource)
        By name of the subfolder; names with ``/`` are nested.
    only_failed, listener, **how
        As for `capture`; progress has the subfolder's name in place of the map type.

    Returns
    -------
    dict of str to CaptureResult
        Results by name of the subfolder; if a capture was stopped, it is the last.
    """
    results: dict[str, CaptureResult] = {}
    for name, (plan, source) in captures.items():
        begun = any(is_file(folder / name / file) for file in (JOURNAL_FILE, MISSION_FILE))
        if only_failed and not begun:
            # An earlier run was stopped before this capture, so none of its images has failed.
            continue
        results[name] = capture(
            plan,
            source,
            folder / name,
            resume=True,
            only_failed=only_failed,
            listener=listener.named(name),
            **how,
        )
        if results[name].cancelled:
            break
    return results


def combined(folder: Path, results: Mapping[str, CaptureResult]) -> CaptureResult:
    """Combine results; failures and repeats have the subfolder's name in place of the map type."""
    each = results.values()
    return CaptureResult(
        folder=folder,
        total=sum(one.total for one in each),
        written=sum(one.written for one in each),
        failed=tuple(replace(failure, map_type=name) for name, one in results.items() for failure in one.failed),
        skipped=sum(one.skipped for one in each),
        requests=sum(one.requests for one in each),
        unique_parts=sum(one.unique_parts for one in each),
        seconds=sum(one.seconds for one in each),
        cancelled=any(one.cancelled for one in each),
        repeated=tuple(replace(repeat, map_type=name) for name, one in results.items() for repeat in one.repeated),
    )
