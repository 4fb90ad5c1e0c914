"""The provider of algorithms in QGIS's toolbox."""

from __future__ import annotations

from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from ..paths import RESOURCES, icon

PROVIDER = "terrainav"


class Provider(QgsProcessingProvider):
    """The plugin's algorithms; heavy packages are imported when an algorithm runs."""

    def id(self) -> str:
        """First part of the ids of algorithms, as in ``terrainav:plan``."""
        return PROVIDER

    def name(self) -> str:
        """Title in the toolbox."""
        return "TerrAInav"

    def icon(self) -> QIcon:
        """Icon in the toolbox."""
        return icon("icon")

    def svgIconPath(self) -> str:
        """Path of the icon, for QGIS to draw."""
        return str(RESOURCES / "icon.svg")

    def loadAlgorithms(self) -> None:
        """Add the algorithms."""
        from .benchmarks import MakeBenchmark, ScoreBenchmark
        from .capture import Capture, CaptureFailed
        from .datasets import Clean, Export, MakeMosaic, SplitAlgorithm
        from .line import PosesAlongLine
        from .plan import PlanAlgorithm
        from .report import AccuracyReport

        kinds = (
            *(
                PlanAlgorithm,
                PosesAlongLine,
                Capture,
                CaptureFailed,
                Clean,
                SplitAlgorithm,
                MakeMosaic,
                Export,
            ),
            *(MakeBenchmark, ScoreBenchmark, AccuracyReport),
        )
        for algorithm in kinds:
            self.addAlgorithm(algorithm(listed=True))
