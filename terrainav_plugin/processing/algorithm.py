"""Base of all algorithms, which runs their work off the main thread."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple, TypeVar

from qgis.core import (
    QgsProcessingAlgorithm,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProcessingOutputNumber,
    QgsProcessingParameterDefinition,
    QgsProcessingParameterFile,
    QgsProperty,
)
from qgis.PyQt.QtCore import QEventLoop, QTimer
from qgis.PyQt.QtGui import QIcon

from ...core.errors import Cancelled, InvalidInput, TerrAInavError
from ...core.text.plain import one_line
from ..foreign import check_raster, check_vector
from ..i18n import tr, translate
from ..packages import missing_packages
from ..paths import RESOURCES, icon
from ..tasks import PythonThread, hold_crs, on_python_thread
from .choices import ChoiceParameter

Result = TypeVar("Result")
#: Characters that no file name can contain: NUL and lone surrogates.
_IN_NO_FILE = re.compile("[\\0\ud800-\udfff]")


class AlgorithmTexts(NamedTuple):
    """Texts of an algorithm: title, tooltip, search words, paragraphs of help."""

    title: str
    tip: str
    tags: str
    help: tuple[str, ...]


class AlgorithmRun(NamedTuple):
    """Parameters, context and feedback of a run."""

    algorithm: Algorithm
    parameters: dict[str, Any]
    context: QgsProcessingContext
    feedback: QgsProcessingFeedback

    def is_given(self, name: str) -> bool:
        """Whether a parameter has a value."""
        return self.parameters.get(name) not in (None, "")

    def text(self, name: str) -> str:
        """Text, path or configuration of a parameter."""
        return self.algorithm.parameterAsString(self.parameters, name, self.context)

    def number(self, name: str) -> float:
        """Value of a number parameter; raises InvalidInput if it is not a number."""
        found = self.algorithm.parameterAsDouble(self.parameters, name, self.context)
        self._check_number(name, found, tr("{title} {value}: must be a number"))
        return found

    def whole(self, name: str) -> int:
        """Value of an integer parameter; raises InvalidInput if it is not an integer."""
        found = self.algorithm.parameterAsInt(self.parameters, name, self.context)
        self._check_number(name, found, tr("{title} {value}: must be a whole number of 32 bits"))
        return found

    def _check_number(self, name: str, found: float, words: str) -> None:
        """Refuse values that QGIS reads as another number, such as large integers and text in optional parameters."""
        given = self.parameters.get(name)
        if given == "" or not isinstance(given, (str, int, float)):
            return
        try:
            # Allow a difference of a half, as QGIS rounds to integers. NaN equals NaN here: a check of the range
            # refuses NaN, unless an integer is wanted.
            is_same = abs(float(given) - found) <= 0.5 or repr(float(given)) == repr(found)
        except ValueError:
            is_same = False
        if not is_same:
            title = self.algorithm.parameterDefinition(name).description()
            raise InvalidInput(words.format(title=title, value=one_line(str(given))))

    def flag(self, name: str) -> bool:
        """Whether a parameter is ticked."""
        return self.algorithm.parameterAsBool(self.parameters, name, self.context)

    def choice(self, name: str) -> str:
        """Value of a choice; empty if none is made. Raises InvalidInput for an unknown value."""
        chosen = self.chosen(name)
        return chosen[0] if chosen else ""

    def chosen(self, name: str) -> tuple[str, ...]:
        """Values of a multiple choice."""
        value = self.parameters.get(name)
        if isinstance(value, QgsProperty):
            value = self.text(name)
        choice = self.algorithm.choices[name]
        return choice.chosen(choice.defaultValue() if value is None or value == "" else value)


class Algorithm(QgsProcessingAlgorithm):
    """Base of TerrAInav's algorithms, with errors in one line; heavy packages are imported only in a run.

    Parameters
    ----------
    listed : bool
        Whether this object is only listed in the toolbox: it omits choices that are slow to determine, which the copy
        that runs has.
    """

    #: Identifiers of the algorithm and its group.
    NAME, GROUP = "", "missions"
    #: Python packages needed in addition to those of the plugin.
    PACKAGES: tuple[str, ...] = ()

    def __init__(self, *, listed: bool = False) -> None:
        super().__init__()
        self._listed = listed
        #: Choices by parameter name.
        self.choices: dict[str, ChoiceParameter] = {}
        #: Why the parameters cannot be run with; empty if they can.
        self._refusal = ""

    def createInstance(self) -> QgsProcessingAlgorithm:
        """Create the copy that QGIS runs."""
        return type(self)()

    def name(self) -> str:
        """Identifier."""
        return self.NAME

    def groupId(self) -> str:
        """Identifier of the group."""
        return self.GROUP

    def group(self) -> str:
        """Title of the group."""
        titles = {"missions": tr("Missions"), "datasets": tr("Datasets"), "benchmarks": tr("Benchmarks")}
        return titles[self.GROUP]

    def displayName(self) -> str:
        """Title."""
        return self.texts().title

    def shortDescription(self) -> str:
        """Tooltip."""
        return self.texts().tip

    def tags(self) -> list[str]:
        """Search words."""
        return self.texts().tags.split(",")

    def shortHelpString(self) -> str:
        """Help, shown as HTML in the toolbox and verbatim in a terminal."""
        return "\n\n".join(self.texts().help)

    def icon(self) -> QIcon:
        """Icon in the toolbox."""
        return icon("icon")

    def svgIconPath(self) -> str:
        """Path of the icon, for QGIS to draw."""
        return str(RESOURCES / "icon.svg")

    def helpUrl(self) -> str:
        """Address of the plugin's page."""
        from ..help import homepage

        return homepage()

    def canExecute(self) -> tuple[bool, str]:
        """Whether all packages are installed; if not, a message that names the missing ones."""
        missing = missing_packages(*self.PACKAGES)
        if not missing:
            return True, ""
        return False, tr("TerrAInav needs Python packages that this QGIS lacks: {packages}.").format(
            packages=", ".join(missing)
        )

    def add(self, parameter: QgsProcessingParameterDefinition, help_text: str, *, advanced: bool = False) -> None:
        """Add a parameter and its help."""
        parameter.setHelp(help_text)
        if advanced:
            parameter.setFlags(parameter.flags() | QgsProcessingParameterDefinition.Flag.FlagAdvanced)
        if isinstance(parameter, ChoiceParameter):
            self.choices[parameter.name()] = parameter
        self.addParameter(parameter)

    def add_dataset(self, help_text: str) -> None:
        """Add the parameter for a dataset's folder."""
        folder = QgsProcessingParameterFile.Behavior.Folder
        self.add(QgsProcessingParameterFile("DATASET", tr("Dataset folder"), folder), help_text)

    def add_numbers(self, titles: dict[str, str]) -> None:
        """Add numeric outputs with their titles."""
        for name, title in titles.items():
            self.addOutput(QgsProcessingOutputNumber(name, title))

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:  # noqa: ARG002  QGIS passes it
        """Add parameters and outputs."""
        self.define()

    def prepareAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> bool:
        """Read everything that is only available on the main thread, on which QGIS calls this."""
        hold_crs()
        self._refusal = ""
        try:
            _checked(lambda: self._check_texts(parameters))
            _checked(lambda: self.prepared(AlgorithmRun(self, parameters, context, feedback)))
        except QgsProcessingException as wrong:
            # A batch of newer QGIS takes a refusal here for a cancellation, and leaves out the rows that follow.
            self._refusal = str(wrong)
        return True

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        """Do the work."""
        try:
            if self._refusal:
                raise QgsProcessingException(self._refusal)
            return _checked(lambda: self.processed(AlgorithmRun(self, parameters, context, feedback)))
        finally:
            self.released()

    def _check_texts(self, parameters: dict[str, Any]) -> None:
        for definition in self.parameterDefinitions():
            text = parameters.get(definition.name())
            if isinstance(text, str) and _IN_NO_FILE.search(text):
                raise InvalidInput(
                    tr("{title} {value}: has a character that is not allowed in files or file names").format(
                        title=definition.description(), value=one_line(text)
                    )
                )

    def texts(self) -> AlgorithmTexts:
        """Return the texts of the algorithm."""
        raise NotImplementedError

    def define(self) -> None:
        """Add the parameters and outputs."""
        raise NotImplementedError

    def prepared(self, run: AlgorithmRun) -> None:
        """Read everything that is only available on the main thread, before the run."""

    def processed(self, run: AlgorithmRun) -> dict[str, Any]:
        """Do the work, on any thread, and return the outputs."""
        raise NotImplementedError

    def postProcessAlgorithm(
        self,
        context: QgsProcessingContext,  # noqa: ARG002  QGIS passes it
        feedback: QgsProcessingFeedback,  # noqa: ARG002  QGIS passes it
    ) -> dict[str, Any]:
        """Finish after the work: on the main thread, or on the thread of a model."""
        _checked(self.finished)
        return {}

    def finished(self) -> None:
        """Finish after the work: on the main thread, or on the thread of a model."""

    def released(self) -> None:
        """Release what was prepared, whether or not the run succeeded."""


class WorkFeedback:
    """Feedback for the thread that works: log, progress and cancellation."""

    def __init__(self, feedback: QgsProcessingFeedback) -> None:
        self._feedback = feedback

    def say(self, text: str) -> None:
        """Add a line to the log."""
        self._feedback.pushInfo(text)

    def warn(self, text: str) -> None:
        """Add a warning to the log."""
        self._feedback.pushWarning(text)

    def progress(self, share: float) -> bool:
        """Set the share done, 0 to 1, and return whether to continue."""
        self._feedback.setProgress(100.0 * share)
        return not self.cancelled()

    def cancelled(self) -> bool:
        """Whether the user has cancelled."""
        return self._feedback.isCanceled()


def off_main_thread(work: Callable[[WorkFeedback], Result], feedback: QgsProcessingFeedback) -> Result:
    """Do ``work`` on another thread and return its result, or raise its error.

    The main thread handles its events meanwhile; any other thread just waits.
    """
    from ..network.worker import in_main_thread

    if not in_main_thread():
        return on_python_thread(lambda: work(WorkFeedback(feedback)))
    relay, loop, timer = _Relay(feedback), QEventLoop(), QTimer()
    thread = PythonThread(lambda: work(relay), "terrainav-algorithm")

    def look() -> None:
        relay.deliver()
        if not thread.works:
            loop.quit()

    timer.timeout.connect(look)
    # Pass on progress and check for cancellation every 20 ms.
    timer.start(20)
    try:
        # User input has to wait, as during every algorithm that runs on the main thread.
        loop.exec(QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents)
    finally:
        relay.stop()
        thread.wait()
        timer.stop()
    relay.deliver()
    return thread.result()


def is_loadable(path: Path, feedback: QgsProcessingFeedback) -> bool:
    """Whether QGIS may open a result in a foreign folder; warns if not."""
    try:
        (check_vector if path.suffix == ".geojson" else check_raster)(path)
    except InvalidInput as wrong:
        feedback.pushWarning(translate(wrong))
        return False
    return True


def _checked(work: Callable[[], Result]) -> Result:
    """Return the result of ``work``, or raise its error as one that Processing shows."""
    from ..form.mission_form import FormError

    try:
        return work()
    except Cancelled as stopped:
        text = tr("Stopped: {reason}").format(reason=translate(stopped))
    except (TerrAInavError, FormError) as wrong:
        text = translate(wrong)
    except OSError as wrong:
        text = tr("cannot continue ({error})").format(error=one_line(str(wrong)))
    # Raise outside `except`, to release the original error and everything its traceback refers to.
    raise QgsProcessingException(text)


class _Relay(WorkFeedback):
    """Pass messages to the main thread, where the feedback of QGIS must be called."""

    def __init__(self, feedback: QgsProcessingFeedback) -> None:
        super().__init__(feedback)
        self._pending: SimpleQueue[Callable[[], object]] = SimpleQueue()
        self._stop = threading.Event()

    def say(self, text: str) -> None:
        self._pending.put(lambda: WorkFeedback.say(self, text))

    def warn(self, text: str) -> None:
        self._pending.put(lambda: WorkFeedback.warn(self, text))

    def progress(self, share: float) -> bool:
        self._pending.put(lambda: WorkFeedback.progress(self, share))
        return not self.cancelled()

    def cancelled(self) -> bool:
        return self._stop.is_set()

    def deliver(self) -> None:
        """Deliver pending messages; call on the main thread."""
        if self._feedback.isCanceled():
            self._stop.set()
        try:
            while True:
                self._pending.get_nowait()()
        except Empty:
            return

    def stop(self) -> None:
        """Ask the work to stop."""
        self._stop.set()
