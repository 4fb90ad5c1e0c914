"""Export of the panel's plan to a file for other programs, in the background, as a million rows take a while."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QFileDialog, QMessageBox, QWidget

from ...core.errors import TerrAInavError
from ..form.mission_form import refused_fields
from ..i18n import capitalized, tr, translate
from ..paths import exists, is_folder, open_in_system
from ..plain import shown_plain
from ..settings import Settings
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.mission.export import PlanFiles
    from ...core.mission.plan import Plan
    from ..messages import Messages
    from ..planner import PlannedMission

#: Ending of files for drones.
_FOR_DRONES = ".kmz"
#: Topic of the messages on the last export: the next one replaces them.
_EXPORT = "plan"


class PlanExportTask(Task):
    """Write a plan to a file, or to several if one cannot hold it.

    Attributes
    ----------
    exported : PlanFiles or None
    there : tuple of Path
        Existing files that further parts of the plan would replace, which the user was not asked about; nothing is
        written then.
    refusal : TerrAInavError or None
        Why the plan was not written: the format cannot hold it, or the flight comes too close to the relief.
    """

    figures = ""

    def __init__(self, plan: Plan | None, path: Path, replace_parts: bool = False) -> None:
        super().__init__(tr("Writing {name}").format(name=path.name))
        self.plan, self.path = plan, path
        self.exported: PlanFiles | None = None
        self.there: tuple[Path, ...] = ()
        self.refusal: TerrAInavError | None = None
        self._replace_parts = replace_parts

    def work(self) -> None:
        """Write the files."""
        from ...core.mission.export import PartsAlreadyThere, write_plan

        try:
            self.exported = write_plan(self.plan, self.path, replace_parts=self._replace_parts)
        except PartsAlreadyThere as wrong:
            self.there = wrong.files
        except TerrAInavError as wrong:
            self.refusal = wrong
            raise

    def again(self) -> PlanExportTask:
        """Return a task that replaces parts."""
        return PlanExportTask(self.plan, self.path, replace_parts=True)


class PlanExport(QObject):
    """Ask for the file, write it, and report data that its format cannot hold.

    Parameters
    ----------
    parent : QWidget
        Parent of the dialogs.
    messages : Messages
    folder : callable
        Returns the folder of the entered mission, which gives the default file name.
    drone_chosen : callable
        Returns whether a drone other than the default is entered; the format for drones then comes first.

    Signals
    -------
    plan_wanted(object, str)
        A function to call with the plan once there is one, and a text to report if planning fails.
    refused(object)
        Messages by the entries that the user must correct.
    """

    plan_wanted = pyqtSignal(object, str)
    refused = pyqtSignal(object)

    def __init__(
        self,
        parent: QWidget,
        messages: Messages,
        folder: Callable[[], Path],
        drone_chosen: Callable[[], bool],
    ) -> None:
        super().__init__()
        self._parent, self._messages = parent, messages
        self._mission_folder, self._drone_chosen = folder, drone_chosen
        self._task: PlanExportTask | None = None
        #: Why there is no plan to export; empty if there is one.
        self.reason = ""

    @property
    def busy(self) -> bool:
        """Whether a file is being written."""
        return self._task is not None

    def close(self) -> None:
        """Stop for good, after waiting for a file that is being written."""
        if self._task is not None:
            self._task.ended.disconnect()
            self._task.waitForFinished()
            self._task = None

    def ask(self) -> None:
        """Let the user choose a file, and write the plan of the entered mission to it."""
        path = self.ask_for_path(self._mission_folder().name or tr("mission"))
        if path is not None:
            if not self.reason:
                # What another format could not hold is not wrong with the entries.
                self.refused.emit({})
            refusal = tr("Nothing to export yet.")
            self.plan_wanted.emit(lambda planned: self._write(planned, path), refusal)

    def ask_for_path(self, name: str) -> Path | None:
        """Let the user choose a file, of which ``name`` is the suggested name; None if there is none."""
        if self._task is not None:
            self._messages.info(
                tr("{name} is still being written; try again when it is there.").format(name=self._task.path.name)
            )
            return None
        settings, known = Settings(), formats()
        last = Path(settings.plan_folder)
        folder = last if settings.plan_folder and is_folder(last) else settings.missions
        first = _FOR_DRONES if self._drone_chosen() else next(iter(known))
        usual = settings.plan_ending if settings.plan_ending in known else first
        chosen, kind = QFileDialog.getSaveFileName(
            self._parent.window(),
            tr("TerrAInav: export plan"),
            # Only the last part of an ending with two dots, as the dialog replaces endings from the last dot.
            str((folder if is_folder(folder) else Path.home()) / f"{name}{Path(usual).suffix or usual}"),
            file_filters(),
            f"{known[usual]} (*{usual})",
        )
        if not chosen:
            return None
        path = add_ending(Path(chosen), kind, usual)
        # The dialog has asked about the name that it showed; ask again if the name has received another ending.
        if path != Path(chosen) and exists(path) and not self._may_replace((path,)):
            return None
        settings.plan_ending, settings.plan_folder = _ending(path.name) or usual, str(path.parent)
        return path

    def _may_replace(self, there: tuple[Path, ...]) -> bool:
        buttons = QMessageBox.StandardButton
        question = tr("{name} is already there. Replace it?").format(name=there[0].name)
        if len(there) > 1:
            question = tr("{count} files, {first} to {last}, are already there. Replace them?").format(
                count=len(there), first=there[0].name, last=there[-1].name
            )
        answer = QMessageBox.question(
            self._parent.window(),
            tr("TerrAInav: export plan"),
            shown_plain(question),
            buttons.Yes | buttons.No,
            buttons.No,
        )
        return bool(answer == buttons.Yes)

    def _write(self, planned: PlannedMission, path: Path) -> None:
        from ...core.mission.export import check_plan_ending

        try:
            check_plan_ending(path)
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
            return
        self.begin(PlanExportTask(planned.plan, path))

    def begin(self, task: PlanExportTask) -> None:
        """Write a plan in the background."""
        self._task = task
        task.begin(self._ended)

    def _ended(self, task: PlanExportTask) -> None:
        self._task = None
        self._messages.withdraw(_EXPORT)
        with self._messages.topic(_EXPORT):
            self._tell(task)

    def _tell(self, task: PlanExportTask) -> None:
        if task.error:
            if task.refusal is not None:
                self.refused.emit(refused_fields(task.refusal))
            self._messages.failed(translate(task.error), task.trace)
            return
        if task.there:
            if self._may_replace(task.there):
                self.begin(task.again())
            return
        if task.exported is None:
            return
        files, notes = task.exported.files, task.exported.notes
        text = tr("Plan exported as {names}.").format(names=", ".join(file.name for file in files))
        if task.figures:
            text = f"{text} {capitalized(task.figures)}."
        folder = files[0].parent
        open_folder = (tr("Open folder"), lambda: open_in_system(folder))
        if notes:
            lines = [translate(note) for note in notes]
            said = " ".join(f"{capitalized(line)}." for line in lines)
            # Until the user has read what the file does not hold, and closes it.
            self._messages.success(f"{text} {said}", open_folder, "\n".join(lines), lasts=True)
        else:
            self._messages.success(text, open_folder)


def formats() -> dict[str, str]:
    """Titles of the programs for which plan files are, by ending."""
    return {
        ".kml": tr("Google Earth"),
        _FOR_DRONES: tr("DJI Pilot 2, FlightHub 2, DJI Fly"),
        ".survey.plan": tr("QGroundControl survey"),
        ".plan": tr("QGroundControl waypoints"),
        ".litchi.csv": tr("Litchi"),
        ".gpx": tr("GPX route"),
        ".gpkg": tr("GeoPackage"),
        ".csv": tr("Table"),
        ".geojson": tr("GeoJSON footprints"),
    }


def file_filters() -> str:
    """File filters for dialogs."""
    return ";;".join(f"{title} (*{ending})" for ending, title in formats().items())


def add_ending(path: Path, kind: str, usual: str = ".kml") -> Path:
    """Path with the ending chosen in the dialog, unless it already has an ending of a plan file."""
    chosen = next((ending for ending in formats() if f"(*{ending})" in kind), usual)
    own = _ending(path.name)
    if not own:
        return path.with_name(path.name + chosen)
    # The format for Litchi also ends in .csv, and the dialog completes names only from the last dot.
    if chosen.endswith(own) and chosen != own:
        return path.with_name(path.name[: -len(own)] + chosen)
    return path


def _ending(name: str) -> str:
    """Longest ending of a plan file that a name has; empty if it has none."""
    return max((ending for ending in formats() if name.lower().endswith(ending)), key=len, default="")
