"""Working out plans in the background while the user types: the last change wins."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from qgis.PyQt.QtCore import QObject, QTimer, pyqtSignal

from .i18n import tr

if TYPE_CHECKING:
    from ..core.geodesy.mercator import PixelGrid
    from ..core.mission.estimate import Summary
    from ..core.mission.mission import Mission
    from ..core.mission.plan import Plan

#: Pause in typing after which a plan is worked out.
_PAUSE_MS = 150
#: Pixels of the largest picture that is timed: some seconds, and memory to spare.
_MOST_TIMED_PX = 4_000_000


class Planned(NamedTuple):
    """A mission worked out."""

    mission: Mission
    plan: Plan
    summary: Summary


class _Overtaken(Exception):
    """A newer request has come in."""


class Planner(QObject):
    """Plans one mission at a time on a thread of its own; requests overtaken by newer ones are dropped.

    Signals
    -------
    planned(object)
        `Planned`, of the latest request.
    costed(object, str)
        The same, and what its methods were timed at; after `planned`.
    refused(object)
        The error of the latest request.
    """

    planned = pyqtSignal(object)
    costed = pyqtSignal(object, str)
    refused = pyqtSignal(object)
    _finished = pyqtSignal(int, object)

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._latest = 0
        self._timed = True
        self._wanted: tuple[Mission, Callable[[], PixelGrid], bool] | None = None
        self._running: Future[Planned] | Future[tuple[Planned, str]] | None = None
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="terrainav-plan")
        self._pause = QTimer(self)
        self._pause.setSingleShot(True)
        self._pause.setInterval(_PAUSE_MS)
        self._pause.timeout.connect(self._start)
        # Emitted on the planner's thread, received on this object's.
        self._finished.connect(self._deliver)

    @property
    def busy(self) -> bool:
        """Whether an answer is still to come."""
        return self._wanted is not None or self._running is not None

    def request(self, mission: Mission, at_once: bool = False, timed: bool = True) -> None:
        """Ask for a plan; the answer comes by `planned` or `refused`, and by `costed` where it is to be timed."""
        self._latest += 1
        from .sources import grid_finder

        self._wanted = (mission, grid_finder(mission), timed)
        self._pause.start(0 if at_once else _PAUSE_MS)

    def forget(self) -> None:
        """Drop the request under way."""
        self._latest += 1
        self._wanted = None
        self._pause.stop()

    def close(self) -> None:
        """End the thread; no answer comes any more."""
        self.forget()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _start(self) -> None:
        if self._wanted is None or self._running is not None:
            return
        (mission, find_grid, self._timed), self._wanted = self._wanted, None
        number = self._latest
        self._submit(self._work, number, mission, find_grid)

    def _submit(self, work: Callable[..., object], number: int, *values: object) -> None:
        self._running = self._pool.submit(work, number, *values)
        self._running.add_done_callback(lambda future: self._finished.emit(number, future))

    def _work(self, number: int, mission: Mission, find_grid: Callable[[], PixelGrid]) -> Planned:
        """Plan step by step, ending early when overtaken. Runs on the planner's thread."""
        from ..core.mission.estimate import estimate
        from ..core.mission.plan import plan
        from .sources import costs_of

        steps = plan(mission, find_grid())
        self._check(number)
        return Planned(mission, steps, estimate(steps, costs_of(mission.source)))

    def _time(self, number: int, planned: Planned) -> tuple[Planned, str]:
        """Time the methods of a plan, last of all. Runs on the planner's thread."""
        from ..core.picture.cost import timed_cost

        self._check(number)
        plan = planned.plan
        if int(plan.width_px[0]) * int(plan.height_px[0]) > _MOST_TIMED_PX:
            return planned, tr("not timed, as the pictures are large")
        # A copy: what the plan keeps of its views belongs to whoever captures it.
        return planned, timed_cost(replace(plan)).text(len(plan) * len(planned.mission.map_types))

    def _check(self, number: int) -> None:
        if number != self._latest:
            raise _Overtaken

    def _deliver(self, number: int, future: Future[Planned]) -> None:
        self._running = None
        if self._wanted is not None and not self._pause.isActive():
            self._start()
        if number != self._latest or future.cancelled():
            return
        error = future.exception()
        if error is not None:
            self.refused.emit(error)
        elif isinstance(future.result(), Planned):
            if self._timed and self._running is None:
                self._submit(self._time, number, future.result())
            self.planned.emit(future.result())
        else:
            self.costed.emit(*future.result())
