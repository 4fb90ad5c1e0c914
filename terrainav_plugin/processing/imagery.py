"""The imagery of a mission, prepared on the main thread before an algorithm runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING

from qgis.core import (
    QgsProcessingParameterAuthConfig,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterString,
)
from qgis.PyQt.QtCore import QObject, Qt, pyqtSignal, pyqtSlot

from ...core.errors import InvalidInput
from ..i18n import tr
from .algorithm import Algorithm, AlgorithmRun

if TYPE_CHECKING:
    from ...core.geodesy.mercator import PixelGrid
    from ...core.imagery.source import Source
    from ...core.mission.mission import Mission
    from ...core.mission.plan import Plan
    from ..qgis_source.snapshot import Snapshot


class MissionSource:
    """A mission's source, prepared for an algorithm. Create on the main thread.

    Parameters
    ----------
    mission : Mission
    authcfg : str
        Id of a configuration in QGIS's authentication database for the source's key or requests; empty for the
        configuration that the panel has for the source.
    placeholders : tuple of str
        SHA-256 of tiles that count as missing, in addition to those in the settings.

    Raises
    ------
    InvalidInput
        The configuration or layer does not exist.
    """

    def __init__(self, mission: Mission, authcfg: str = "", placeholders: tuple[str, ...] = ()) -> None:
        from ..credentials import credential_problem, read_key
        from ..network.transport import QgisTransport
        from ..settings import Settings, credential_home
        from ..sources import grid_finder, mission_snapshot, needs_key, source_key, source_transport

        self._mission, self._placeholders = mission, placeholders
        self.connections = Settings().connections
        is_key = needs_key(mission.imagery.source)
        if authcfg:
            problem = credential_problem(authcfg, is_key)
            if problem:
                raise InvalidInput(problem)
        self._key = read_key(authcfg) if authcfg and is_key else source_key(mission.imagery.source)
        self._grid: Callable[[], PixelGrid] = grid_finder(mission)
        self._snapshot: Snapshot | None = mission_snapshot(mission)
        self._transport = (
            QgisTransport(self.connections, authcfg=authcfg, home=credential_home(mission.imagery.source))
            if authcfg and not is_key
            else source_transport(mission.imagery.source, self.connections)
        )

    def grid(self) -> PixelGrid:
        """Pixel grid of the source, on any thread; raises InvalidInput, SourceError or FormError."""
        return self._grid()

    def planned(self) -> Plan:
        """Plan the mission; raises InvalidInput or SourceError."""
        from ..sources import plan_mission

        return plan_mission(self._mission, self._grid)

    @contextmanager
    def opened(self) -> Iterator[Source]:
        """Open the source; it and its connections are closed on exit, so that this works only once."""
        from ..sources import open_for_capture

        with closing(self._transport) as transport:
            source = open_for_capture(
                self._mission,
                self._key,
                transport=transport,
                snapshot=self._snapshot,
                placeholders=self._placeholders,
            )
            with closing(source):
                yield source


class _Keeper(QObject):
    """Holds sources until the main thread, to which they belong, can release them: algorithms end on any thread."""

    over = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._kept: dict[int, MissionSource] = {}
        self.over.connect(self._drop, Qt.ConnectionType.QueuedConnection)

    def keep(self, imagery: MissionSource) -> None:
        """Hold a source."""
        self._kept[id(imagery)] = imagery

    def release_source(self, key: int) -> None:
        """Release the source whose `id` is ``key``, on the main thread. Call on any thread, after its last use."""
        from ..network.worker import in_main_thread

        if in_main_thread():
            self._drop(key)
        else:
            self.over.emit(key)

    @pyqtSlot(object)
    def _drop(self, key: int) -> None:
        self._kept.pop(key, None)


@lru_cache(None)
def _keeper() -> _Keeper:
    return _Keeper()


class WithImagery(Algorithm):
    """Base of algorithms that fetch imagery; holds its sources during the run."""

    _taken: tuple[MissionSource, ...] = ()

    @property
    def _imagery(self) -> MissionSource:
        """The source of an algorithm with a single mission."""
        return self._taken[0]

    def add_access(self, help_text: str) -> None:
        """Add parameters for a source's key or authentication, and for consent to its terms."""
        self.add(
            QgsProcessingParameterAuthConfig("AUTHCFG", tr("Key or authentication"), optional=True),
            help_text,
            advanced=True,
        )
        self.add_consent()

    def add_consent(self) -> None:
        """Add a parameter for consent to terms."""
        self.add(
            QgsProcessingParameterBoolean("ACCEPT_TERMS", tr("I agree to the source's terms"), False),
            tr("Sources that ask for consent refuse larger missions without it."),
            advanced=True,
        )

    def add_placeholders(self) -> None:
        """Add a parameter for tiles that count as missing."""
        self.add(
            QgsProcessingParameterString("PLACEHOLDERS", tr("Tiles to treat as missing"), optional=True),
            tr(
                "SHA-256 of tiles that show no imagery, with spaces between them; the log names tiles "
                "received for many places. Images that show one are captured again. The tiles in "
                "TerrAInav's options count as well."
            ),
            advanced=True,
        )

    def take_imagery(self, run: AlgorithmRun, *missions: Mission) -> None:
        """Prepare the sources of missions. Main thread only."""
        placeholders = tuple(run.text("PLACEHOLDERS").replace(",", " ").split())
        self._taken = tuple(MissionSource(mission, run.text("AUTHCFG"), placeholders) for mission in missions)
        for imagery in self._taken:
            _keeper().keep(imagery)

    def released(self) -> None:
        """Release the sources."""
        keys, self._taken = [id(imagery) for imagery in self._taken], ()
        for key in keys:
            _keeper().release_source(key)


def check_terms(plan_mission: Plan, source: Source, requests: int, *, accepted: bool) -> None:
    """Raise SourceError if the source's terms do not allow a run."""
    from ...core.imagery.catalogue import check_policy

    check_policy(
        source,
        requests,
        accept_terms=accepted,
        map_types=plan_mission.mission.imagery.map_types,
        bounds_deg=plan_mission.mission.area.bounds.edges_deg,
    )
