"""Algorithm: a mission's error measured against run time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputHtml,
    QgsProcessingParameterAuthConfig,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterFolderDestination,
)

from ...core.errors import Cancelled
from ..i18n import tr, translate
from .algorithm import Watch, paragraphs, run_in_background
from .imagery import WithImagery, check_terms
from .mission_parameters import add_mission_parameters, mission_of

#: Requests that a report may make for the few pictures it measures on.
_REQUESTS = 200


class AccuracyReport(WithImagery):
    """Error against run time of every method, for the mission at hand."""

    NAME = "accuracyreport"
    PACKAGES = ("matplotlib",)

    def displayName(self) -> str:
        """Title."""
        return tr("Accuracy report of a mission")

    def shortDescription(self) -> str:
        """Tooltip."""
        return tr("Measures every method's error against its run time.")

    def tags(self) -> list[str]:
        """Words that it is found by."""
        return tr("accuracy,error,bound,run time,report,footprint,reprojection").split(",")

    def shortHelpString(self) -> str:
        """Help."""
        return paragraphs(
            tr(
                "Measures the methods of footprints and pictures on captures of the mission itself, against an exact "
                "reference: error, bound and time of each, what was chosen, and what was left out. Writes a page with "
                "diagrams, and the numbers as tables."
            ),
            tr(
                "In wind it also says how far the wind moves and turns the camera, and what that does to coverage and "
                "overlap."
            ),
        )

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: ARG002  QGIS passes it
        """Add parameters and outputs."""
        add_mission_parameters(self, listed=self._listed)
        self.add(
            QgsProcessingParameterAuthConfig("AUTHCFG", tr("Key or authentication"), optional=True),
            tr("As for a capture."),
            advanced=True,
        )
        self.add(
            QgsProcessingParameterBoolean("ACCEPT_TERMS", tr("I agree to the source's terms"), False),
            tr("Sources that ask for consent refuse larger missions without it."),
            advanced=True,
        )
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

    def prepared(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> None:
        """Take what belongs to the main thread."""
        self.take_imagery(mission_of(self, parameters, context, feedback), parameters, context)

    def processed(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Measure."""
        from ...core.report.page import write_report

        folder = self.parameterAsString(parameters, "FOLDER", context)
        accepted = self.parameterAsBool(parameters, "ACCEPT_TERMS", context)
        quick = self.parameterAsBool(parameters, "QUICK", context)

        def work(watch: Watch) -> Path:
            def tell(what: str) -> None:
                if watch.cancelled():
                    raise Cancelled(tr("the report is not finished"))
                watch.say(tr("Measuring: {what}").format(what=translate(what)))

            with self._imagery.opened() as source:
                worked_out = self._imagery.planned()
                check_terms(worked_out, source, _REQUESTS, accepted=accepted)
                return write_report(worked_out, source, folder, progress=tell, quick=quick)

        return {"FOLDER": folder, "HTML": str(run_in_background(work, feedback))}
