"""Processing's benchmark windows, opened from toolbar and menu with the panel's mission."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import QgsApplication, QgsProcessingUtils
from qgis.gui import QgisInterface
from qgis.PyQt import sip
from qgis.PyQt.QtCore import QObject
from qgis.utils import plugins

from ..i18n import number_text, tr
from ..paths import exists, next_folder
from ..settings import Settings
from .mission_parameters import leave_mission_to_file

if TYPE_CHECKING:
    from qgis.gui import QgsProcessingAlgorithmDialogBase

    from ...core.mission.mission import Mission
    from ..messages import Messages

_MAKE, _SCORE = "terrainav:makebenchmark", "terrainav:scorebenchmark"


class BenchmarkWindows(QObject):
    """Open Processing's windows for benchmarks, and report their results.

    Processing provides progress, cancellation, log, batches and history.
    """

    def __init__(self, iface: QgisInterface, messages: Messages) -> None:
        super().__init__()
        self._iface, self._messages = iface, messages
        self.windows: list[QgsProcessingAlgorithmDialogBase] = []
        self._latest: Path | None = None

    def make(self, mission: Mission) -> None:
        """Ask for the settings of a benchmark whose queries are the views of a mission."""
        # QGIS removes the temporary file on exit; the benchmark keeps a copy of the mission.
        file = QgsProcessingUtils.generateTempFilename("mission.json")
        mission.save(file)
        folder = Settings().missions / "benchmark-1"
        usual = {"MISSION": file, "FOLDER": str(next_folder(folder) if exists(folder) else folder)}
        dialog = self._show(_MAKE, usual)
        if dialog is not None:
            dialog.algorithmFinished.connect(self._made)

    def score(self, folder: Path | None = None) -> None:
        """Ask for the answers to score; the default benchmark is the one made last."""
        folder = folder or self._latest
        self._show(_SCORE, {} if folder is None else {"BENCHMARK": str(folder)})

    def close(self) -> None:
        """Close the windows, and cancel their runs."""
        for dialog in self.windows:
            if not sip.isdeleted(dialog):
                if dialog.feedback is not None:
                    dialog.feedback.cancel()
                dialog.close()
        self.windows.clear()

    def _show(self, name: str, usual: dict[str, Any]) -> QgsProcessingAlgorithmDialogBase | None:
        algorithm = QgsApplication.processingRegistry().createAlgorithmById(name)
        if algorithm is None or "processing" not in plugins:
            self._messages.warning(
                tr("Benchmarks need QGIS's own plugin Processing and its provider TerrAInav; one is not enabled.")
            )
            return None
        from processing.gui.AlgorithmDialog import AlgorithmDialog

        if "MISSION" in usual:
            leave_mission_to_file(algorithm)
        dialog = AlgorithmDialog(algorithm, False, self._iface.mainWindow())
        dialog.setParameters(usual)
        self.windows = [one for one in self.windows if not sip.isdeleted(one)] + [dialog]
        dialog.show()
        return dialog

    def _made(self, is_done: bool, results: dict[str, Any]) -> None:
        if not is_done or "MOSAIC" not in results:
            return
        self._latest = Path(results["FOLDER"])
        text = tr("{name}: {queries} queries, and {tiles} tiles of the reference.").format(
            name=self._latest.name,
            queries=number_text(results["QUERY_COUNT"]),
            tiles=number_text(results["TILE_COUNT"]),
        )
        failed = results["FAILED"]
        if failed:
            text += " " + tr("{count} images could not be captured.").format(count=number_text(failed))
        tell = self._messages.warning if failed else self._messages.success
        tell(text, action=(tr("Score"), self.score))
