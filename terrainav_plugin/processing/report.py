"""Algorithm that measures a mission's error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from qgis.core import (
    QgsProcessingOutputHtml,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
)

from ...core.errors import Cancelled
from ..i18n import tr, translate
from .algorithm import AlgorithmRun, AlgorithmTexts, WorkFeedback, off_main_thread
from .imagery import WithImagery, check_terms
from .mission_parameters import add_mission_parameters, read_mission


class AccuracyReport(WithImagery):
    """Error against run time of every method, for the given mission."""

    NAME = "accuracyreport"
    PACKAGES = ("matplotlib",)

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        return AlgorithmTexts(
            tr("Accuracy report of a mission"),
            tr("Measures every method's error against its run time."),
            tr("accuracy,error,bound,run time,report,footprint,reprojection"),
            (
                tr(
                    "Measures the methods of footprints and images on captures of the mission itself, against an "
                    "exact reference: error, bound and time of each, what was chosen, and what was left out. Writes a "
                    "page with diagrams, and the numbers as tables."
                ),
                tr(
                    "In wind, it also reports how far the wind moves and turns the camera, and how that "
                    "affects coverage and overlap."
                ),
            ),
        )

    def define(self) -> None:
        """Add the parameters and outputs."""
        add_mission_parameters(self, listed=self._listed)
        self.add_access(tr("As for a capture."))
        self.add(
            QgsProcessingParameterBoolean("QUICK", tr("Quick"), False),
            tr("Time every method once only; the times are then not compared."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterFolderDestination("FOLDER", tr("Folder of the report")),
            tr("Files of an earlier report are replaced."),
        )
        self.addOutput(QgsProcessingOutputHtml("HTML", tr("Report")))

    def prepared(self, run: AlgorithmRun) -> None:
        """Prepare the mission's imagery."""
        self.take_imagery(run, read_mission(run))

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Measure."""
        from ...core.report.page import write_report

        folder, accepted, quick = run.text("FOLDER"), run.flag("ACCEPT_TERMS"), run.flag("QUICK")

        def work(watch: WorkFeedback) -> Path:
            def tell(what: str) -> None:
                if watch.cancelled():
                    raise Cancelled(tr("the report is not finished"))
                watch.say(tr("Measuring: {what}").format(what=translate(what)))

            with self._imagery.opened() as source:
                worked_out = self._imagery.planned()
                # A report measures only a few images, with at most 200 requests.
                check_terms(worked_out, source, 200, accepted=accepted)
                return write_report(worked_out, source, folder, progress=tell, quick=quick)

        return {"FOLDER": folder, "HTML": str(off_main_thread(work, run.feedback))}
