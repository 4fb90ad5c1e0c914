"""Planning in the background while the user types; only the latest request counts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from qgis.PyQt.QtCore import QObject, pyqtSignal

from ..core.errors import Message
from ..core.waiting import cancellable, reporting
from .i18n import tr, translate
from .tasks import LatestWorker, single_shot

if TYPE_CHECKING:
    from ..core.geodesy.mercator import PixelGrid
    from ..core.mission.estimate import Summary
    from ..core.mission.mission import Mission
    from ..core.mission.plan import Plan
    from .plan_features import PlanFeatures
    from .sources import MissionPlans

#: Pause in typing before planning starts.
_PAUSE_MS = 150


class PlannedMission(NamedTuple):
    """A mission, its plans, and the summary of all; ``whole`` is the first plan with all rows, if it skips some."""

    mission: Mission
    plans: MissionPlans
    summary: Summary
    whole: Plan | None = None

    @property
    def plan(self) -> Plan:
        """Plan of the first imagery."""
        return self.plans.first


class Planner(QObject):
    """Plan one mission at a time on a thread, and drop requests that newer requests have overtaken.

    Signals
    -------
    planned(object)
        The `PlannedMission` of the latest request.
    costed(object, object)
        The same `PlannedMission`, and the timing of its methods; after `planned`.
    features_read(object, object)
        The same `PlannedMission`, and the `PlanFeatures` around it, if it names labels or buildings; after `planned`.
    reading(str)
        Text on the progress of reading files before the plan can be worked out.
    refused(object)
        The error of the latest request.
    """

    planned = pyqtSignal(object)
    costed = pyqtSignal(object, object)
    features_read = pyqtSignal(object, object)
    reading = pyqtSignal(str)
    refused = pyqtSignal(object)
    _progressed = pyqtSignal(object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._wanted: tuple[Mission, dict[str, Callable[[], PixelGrid]], bool] | None = None
        self._worker = LatestWorker("plan", self)
        self._worker.failed.connect(self.refused)
        # The signal is emitted on the worker's thread and received on the thread of this object.
        self._progressed.connect(self._show_progress)
        self._pause = single_shot(self._start, self, _PAUSE_MS)

    @property
    def busy(self) -> bool:
        """Whether an answer is pending."""
        return self._wanted is not None or self._worker.busy

    def request(self, mission: Mission, at_once: bool = False, timed: bool = True) -> None:
        """Request a plan, to be emitted by `planned` (or an error by `refused`), then `costed` if ``timed``."""
        from .sources import grid_finders

        self._worker.forget()
        self._wanted = (mission, grid_finders(mission), timed)
        self._pause.start(0 if at_once else _PAUSE_MS)

    def forget(self) -> None:
        """Drop the pending request."""
        self._worker.forget()
        self._wanted = None
        self._pause.stop()

    def close(self) -> None:
        """End the thread, and emit no more answers."""
        self.forget()
        self._worker.close()

    def _start(self) -> None:
        if self._wanted is not None:
            (mission, find_grids, timed), self._wanted = self._wanted, None
            self._worker.ask(partial(_plan, mission, find_grids, self._progressed.emit), partial(self._deliver, timed))

    def _deliver(self, timed: bool, planned: PlannedMission) -> None:
        if planned.mission.labels.labels or planned.mission.terrain.buildings:
            self._worker.ask(partial(_read_features, planned), partial(self._deliver_features, timed, planned))
        elif timed:
            self._time(planned)
        self.planned.emit(planned)

    def _deliver_features(self, timed: bool, planned: PlannedMission, features: PlanFeatures) -> None:
        if timed:
            self._time(planned)
        self.features_read.emit(planned, features)

    def _time(self, planned: PlannedMission) -> None:
        self._worker.ask(partial(_time, planned), lambda cost: self.costed.emit(planned, cost))

    def _show_progress(self, text: Message) -> None:
        if self._worker.is_awaited:
            self.reading.emit(translate(text))


def _plan(
    mission: Mission,
    find_grids: dict[str, Callable[[], PixelGrid]],
    report: Callable[[Message], object],
    overtaken: Callable[[], bool],
) -> PlannedMission | None:
    """Plan step by step, ending early if overtaken. Runs on the planner's thread."""
    from .plan_features import open_labels

    with cancellable(overtaken), reporting(report):
        planned = _plan_imageries(mission, find_grids, overtaken)
        if planned is not None and mission.labels.labels:
            open_labels(planned.plan)
    return planned


def _plan_imageries(
    mission: Mission, find_grids: dict[str, Callable[[], PixelGrid]], overtaken: Callable[[], bool]
) -> PlannedMission | None:
    from .sources import plan_imageries, plan_mission, plan_summary

    plans = plan_imageries(mission, find_grids)
    summaries = {}
    for name, one in plans.by_imagery.items():
        if overtaken():
            return None
        summaries[name] = plan_summary(one)
    whole = None
    if mission.flight.skip_rows:
        whole = plan_mission(plans.first.mission.replace(skip_rows=""), find_grids[next(iter(plans.by_imagery))])
    return None if overtaken() else PlannedMission(mission, plans, summary_of_all(summaries), whole)


def summary_of_all(summaries: dict[str, Summary]) -> Summary:
    """Summary of the first imagery, with the tiles, bytes and times of all."""
    first, *others = summaries.values()
    if not others:
        return first
    added = ("unique_tiles", "download_bytes", "output_bytes", "seconds", "mosaic_s")
    warnings = [
        Message("{0}: {1}", name, warning)
        for name, one in summaries.items()
        for warning in one.warnings
        if one is not first and warning not in first.warnings
    ]
    return replace(
        first,
        **{name: sum(getattr(one, name) for one in summaries.values()) for name in added},
        # Local pixels need no download, unless some of them are from a server.
        pixels_from=next((one.pixels_from for one in summaries.values() if one.download_bytes), first.pixels_from),
        warnings=(*first.warnings, *warnings),
    )


def _read_features(planned: PlannedMission, overtaken: Callable[[], bool]) -> PlanFeatures:
    """Read the labels and buildings around a plan. Runs on the planner's thread."""
    from .plan_features import read_features

    with cancellable(overtaken):
        return read_features(planned.plan)


def _time(planned: PlannedMission, overtaken: Callable[[], bool]) -> str:
    """Time the methods of a plan. Runs on the planner's thread."""
    from ..core.picture.cost import timed_cost
    from .sources import mission_bands

    plan = planned.plan
    # Do not time larger images, which take more than a few seconds or much memory.
    if int(plan.frames.width_px[0]) * int(plan.frames.height_px[0]) > 4_000_000:
        return tr("not timed, as the images are large")
    # Use a copy of the plan: the views that it caches belong to the capture.
    bands = mission_bands(plan.mission)
    with cancellable(overtaken):
        return timed_cost(replace(plan), bands).text(planned.plans.images)
