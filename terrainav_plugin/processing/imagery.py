"""The imagery of a mission, for algorithms: what belongs to the main thread is taken there, before they run."""

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
    """A mission's source as it is when an algorithm is prepared; made on the main thread.

    Parameters
    ----------
    mission : Mission
    authcfg : str
        Configuration of QGIS's authentication database for the source's key or its requests; empty for the one that
        the user has chosen for the source in the panel.
    placeholders : tuple of str
        SHA-256 of tiles that count as missing, beside those of the settings.

    Raises
    ------
    InvalidInput
        The configuration or the layer is not there.
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
        """Work the mission out; raises InvalidInput or SourceError."""
        from ..sources import worked_out

        return worked_out(self._mission, self._grid)

    @contextmanager
    def opened(self) -> Iterator[Source]:
        """Source ready to fetch, once; closed afterwards with its connections."""
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
    """Holds what belongs to the main thread until that lets go of it: algorithms end on any."""

    over = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._kept: dict[int, MissionSource] = {}
        self.over.connect(self._drop, Qt.ConnectionType.QueuedConnection)

    def keep(self, imagery: MissionSource) -> None:
        """Hold it."""
        self._kept[id(imagery)] = imagery

    def release_source(self, key: int) -> None:
        """Let go, in the main thread, of what has this identity; called in any, by the last that used it."""
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
    """An algorithm that fetches, and holds its imagery while it runs."""

    _taken: tuple[MissionSource, ...] = ()

    @property
    def _imagery(self) -> MissionSource:
        """That of a mission of one source."""
        return self._taken[0]

    def add_access(self, help_text: str) -> None:
        """Add the parameters of what a source asks for: a key or authentication, and consent."""
        self.add(
            QgsProcessingParameterAuthConfig("AUTHCFG", tr("Key or authentication"), optional=True),
            help_text,
            advanced=True,
        )
        self.add_consent()

    def add_consent(self) -> None:
        """Add the parameter of consent to terms."""
        self.add(
            QgsProcessingParameterBoolean("ACCEPT_TERMS", tr("I agree to the source's terms"), False),
            tr("Sources that ask for consent refuse larger missions without it."),
            advanced=True,
        )

    def add_placeholders(self) -> None:
        """Add the parameter of tiles that show no imagery."""
        self.add(
            QgsProcessingParameterString("PLACEHOLDERS", tr("Tiles to treat as missing"), optional=True),
            tr(
                "SHA-256 of tiles that show no imagery, with spaces between them; the log names tiles that came for "
                "many places. Images that show one are captured again. Those of TerrAInav's options count as well."
            ),
            advanced=True,
        )

    def take_imagery(self, run: AlgorithmRun, *missions: Mission) -> None:
        """Take the imagery of missions; on the main thread."""
        placeholders = tuple(run.text("PLACEHOLDERS").replace(",", " ").split())
        self._taken = tuple(MissionSource(mission, run.text("AUTHCFG"), placeholders) for mission in missions)
        for imagery in self._taken:
            _keeper().keep(imagery)

    def released(self) -> None:
        """Let go of the imagery."""
        keys, self._taken = [id(imagery) for imagery in self._taken], ()
        for key in keys:
            _keeper().release_source(key)


def check_terms(worked_out: Plan, source: Source, requests: int, *, accepted: bool) -> None:
    """Raise SourceError where the source's terms do not let a run pass."""
    from ...core.imagery.catalogue import check_policy

    check_policy(
        source,
        requests,
        accept_terms=accepted,
        map_types=worked_out.mission.imagery.map_types,
        bounds_deg=worked_out.mission.area.bounds.edges_deg,
    )
