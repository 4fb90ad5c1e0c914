"""What all algorithms have in common."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from qgis.core import (
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingParameterDefinition,
)
from qgis.PyQt.QtGui import QIcon

from ...core.errors import Cancelled, TerrAInavError
from ..i18n import told, tr
from ..packages import missing_packages
from ..paths import RESOURCES, icon
from .beside import Watch, beside_main

Result = TypeVar("Result")


class Algorithm(QgsProcessingAlgorithm):
    """An algorithm of TerrAInav: named by its class, its errors are one line, its heavy imports wait until it runs.

    Parameters
    ----------
    listed : bool
        For the toolbox's list only: choices that take long to find out are left for the copy that runs.
    """

    #: Its identifier, and that of its group.
    NAME, GROUP = "", "missions"
    #: Python packages that it needs beside the plugin's own.
    PACKAGES: tuple[str, ...] = ()

    def __init__(self, *, listed: bool = False) -> None:
        super().__init__()
        self._listed = listed

    def createInstance(self) -> QgsProcessingAlgorithm:
        """Make the copy that runs."""
        return type(self)()

    def name(self) -> str:
        """Identifier."""
        return self.NAME

    def groupId(self) -> str:
        """Identifier of the group."""
        return self.GROUP

    def group(self) -> str:
        """Title of the group."""
        return {"missions": tr("Missions"), "datasets": tr("Datasets")}[self.GROUP]

    def icon(self) -> QIcon:
        """Icon in the toolbox."""
        return icon("icon")

    def svgIconPath(self) -> str:
        """Icon where QGIS draws it itself."""
        return str(RESOURCES / "icon.svg")

    def helpUrl(self) -> str:
        """Page about the plugin."""
        return _homepage()

    def canExecute(self) -> tuple[bool, str]:
        """Whether all packages are there, and which are not."""
        missing = missing_packages(*self.PACKAGES)
        if not missing:
            return True, ""
        return False, tr("TerrAInav needs Python packages that this QGIS lacks: {packages}.").format(
            packages=", ".join(missing)
        )

    def add(
        self, parameter: QgsProcessingParameterDefinition, help_text: str, *, advanced: bool = False
    ) -> None:
        """Add a parameter and what there is to say of it."""
        parameter.setHelp(help_text)
        if advanced:
            parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.Flag.FlagAdvanced)
        self.addParameter(parameter)

    def prepareAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> bool:
        """Take what belongs to the main thread, where QGIS calls this."""
        _checked(lambda: self.prepared(parameters, context, feedback))
        return True

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Do the work."""
        try:
            return _checked(lambda: self.processed(parameters, context, feedback))
        finally:
            self.released()

    def prepared(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> None:
        """Prepare; for what an algorithm does on the main thread before it runs."""

    def processed(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Run; on any thread."""
        raise NotImplementedError

    def postProcessAlgorithm(
        self,
        context: QgsProcessingContext,  # noqa: ARG002  QGIS passes it
        feedback: QgsProcessingFeedback,  # noqa: ARG002  QGIS passes it
    ) -> dict[str, Any]:
        """Finish on the main thread, where QGIS calls this; a model calls it on its own."""
        _checked(self.finished)
        return {}

    def finished(self) -> None:
        """Do what belongs to the main thread once the work is done."""

    def released(self) -> None:
        """Let go of what was prepared; whatever became of the run."""


def _checked(work: Callable[[], Result]) -> Result:
    """What ``work`` returns; its errors in the way that Processing shows them."""
    from ..form.mission_form import FormError

    try:
        return work()
    except Cancelled as stopped:
        text = tr("Stopped: {reason}").format(reason=told(stopped))
    except (TerrAInavError, FormError) as wrong:
        text = told(wrong)
    # Out here the error is forgotten, and with it all that its trace would hold until the thread has ended.
    raise QgsProcessingException(text)


def run_beside(work: Callable[[Watch], Result], feedback: QgsProcessingFeedback) -> Result:
    """Work with the main thread free for its events; see `beside`."""
    return beside_main(work, feedback)


def paragraphs(*texts: str) -> str:
    """Help text, which the toolbox shows as HTML and a terminal as it is."""
    return "\n\n".join(texts)


def _homepage() -> str:
    metadata = Path(__file__).resolve().parents[2] / "metadata.txt"
    for line in metadata.read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition("=")
        if name == "homepage":
            return value
    return ""
