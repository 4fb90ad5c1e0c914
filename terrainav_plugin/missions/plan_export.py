"""Write the panel's plan as a file for other programs, in the background: a million rows take a while."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QFileDialog, QMessageBox, QWidget

from ...core.errors import TerrAInavError
from ..form.mission_form import refused_fields
from ..i18n import tr, translate
from ..paths import exists, is_folder, open_in_system
from ..plain import shown_plain
from ..settings import Settings
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.mission.export import PlanFiles
    from ...core.mission.plan import Plan
    from ..messages import Messages
    from ..planner import PlannedMission

#: File ending for drones.
_FOR_DRONES = ".kmz"


class PlanExportTask(Task):
    """Write a plan.

    Attributes
    ----------
    exported : PlanFiles or None
    there : tuple of Path
        Existing files that further parts of the plan would replace without being asked for; nothing is written then.
    refusal : TerrAInavError or None
        Why the plan was not written: the format cannot hold it, or it comes too close to the relief.
    """

    def __init__(self, plan: Plan, path: Path, replace_parts: bool = False) -> None:
        super().__init__(tr("Writing {name}").format(name=path.name))
        self.plan, self.path = plan, path
        self.exported: PlanFiles | None = None
        self.there: tuple[Path, ...] = ()
        self.refusal: TerrAInavError | None = None
        self._replace_parts = replace_parts

    def work(self) -> None:
        """Write."""
        from ...core.mission.export import PartsAlreadyThere, write_plan

        try:
            self.exported = write_plan(self.plan, self.path, replace_parts=self._replace_parts)
        except PartsAlreadyThere as wrong:
            self.there = wrong.files
        except TerrAInavError as wrong:
            self.refusal = wrong
            raise


class PlanExport(QObject):
    """Ask for the file, write it, and report what its format cannot hold.

    Parameters
    ----------
    parent : QWidget
        Parent of the dialogs.
    messages : Messages
    folder : callable
        Returns the folder of the mission entered, which gives the default file name.
    drone_chosen : callable
        Returns whether a drone other than the default is entered: its file format then comes first.

    Signals
    -------
    plan_wanted(object, str)
        What to do with the plan once there is one; and what to report if it fails.
    refused(object)
        Messages by the entries to correct.
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

    @property
    def busy(self) -> bool:
        """Whether a file is being written."""
        return self._task is not None

    def close(self) -> None:
        """Stop for good, after a file being written."""
        if self._task is not None:
            self._task.ended.disconnect()
            self._task.waitForFinished()
            self._task = None

    def ask(self) -> None:
        """Let the user choose a file, and write the plan of the mission entered to it."""
        if self._task is not None:
            self._messages.info(
                tr("{name} is still being written; try again when it is there.").format(name=self._task.path.name)
            )
            return
        settings, known = Settings(), formats()
        folder = settings.missions
        name = self._mission_folder().name or tr("mission")
        first = _FOR_DRONES if self._drone_chosen() else next(iter(known))
        usual = settings.plan_ending if settings.plan_ending in known else first
        chosen, kind = QFileDialog.getSaveFileName(
            self._parent.window(),
            tr("TerrAInav: export plan"),
            # Of an ending in two parts only the last: the dialog replaces endings from the last dot.
            str((folder if is_folder(folder) else Path.home()) / f"{name}{Path(usual).suffix or usual}"),
            file_filters(),
            f"{known[usual]} (*{usual})",
        )
        if not chosen:
            return
        path = add_ending(Path(chosen), kind, usual)
        # The dialog has asked about the name that it shows, which may have received another ending.
        if path != Path(chosen) and exists(path) and not self._may_replace((path,)):
            return
        settings.plan_ending = _ending(path.name) or usual
        refusal = tr("Nothing to export yet.")
        self.plan_wanted.emit(lambda planned: self._write(planned, path), refusal)

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
        self._begin(PlanExportTask(planned.plan, path))

    def _begin(self, task: PlanExportTask) -> None:
        self._task = task
        task.begin(self._ended)

    def _ended(self, task: PlanExportTask) -> None:
        self._task = None
        if task.error:
            if task.refusal is not None:
                self.refused.emit(refused_fields(task.refusal))
            self._messages.failed(translate(task.error), task.trace)
            return
        if task.there:
            if self._may_replace(task.there):
                self._begin(PlanExportTask(task.plan, task.path, replace_parts=True))
            return
        if task.exported is None:
            return
        files, notes = task.exported.files, task.exported.notes
        text = tr("Plan exported as {names}.").format(names=", ".join(file.name for file in files))
        folder = files[0].parent
        open_folder = (tr("Open folder"), lambda: open_in_system(folder))
        if notes:
            lines = [translate(note) for note in notes]
            said = " ".join(f"{line[:1].upper()}{line[1:]}." for line in lines)
            self._messages.warning(f"{text} {said}", "\n".join(lines), open_folder)
        else:
            self._messages.success(text, open_folder)


def formats() -> dict[str, str]:
    """Endings of plan files, and the programs they are for."""
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
    """File with the ending chosen in the dialog, unless it has one of a plan."""
    chosen = next((ending for ending in formats() if f"(*{ending})" in kind), usual)
    own = _ending(path.name)
    if not own:
        return path.with_name(path.name + chosen)
    # With Litchi chosen, a .csv is Litchi's; the dialog completes names from the last dot only.
    if chosen.endswith(own) and chosen != own:
        return path.with_name(path.name[: -len(own)] + chosen)
    return path


def _ending(name: str) -> str:
    """Longest plan file ending of a name; empty for none."""
    return max((one for one in formats() if name.lower().endswith(one)), key=len, default="")
