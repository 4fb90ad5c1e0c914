"""Open and save missions: of the project, of files and of datasets."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from qgis.core import QgsVectorLayer
from qgis.PyQt.QtCore import QObject, pyqtSignal
from qgis.PyQt.QtWidgets import QDialog, QFileDialog, QMenu, QToolButton

from ...core.dataset.folder import JOURNAL_FILE, MISSION_FILE
from ...core.errors import InvalidInput, OutputError, TerrAInavError
from ...core.limits import MAX_LINE_CHARACTERS
from ...core.storage.files import file_exists
from ...core.text.plain import one_line, shortened
from ..compat import RASTER
from ..dataset.layers import FAILED_FILE, FailedImages, OpenedResults, open_failed, open_results
from ..dataset.mosaic import MosaicRaster, build_any_mosaics, existing_mosaics
from ..dataset.placing import reread_footprints, show_failed, show_results
from ..form import mission_form
from ..form.area import FormError
from ..form.state import BOX_FIELDS, DECLARED
from ..i18n import tr, translate
from ..map.mission_group import SavedMission, addresses, mission_layers, saved_missions
from ..paths import entered_folder, exists, is_folder, next_folder
from ..plain import shown_plain
from ..remote.address import DatasetAddress
from ..remote.copies import copied_address, copy_dataset, copy_folder, has_images_elsewhere, read_only_reason
from ..remote.store import Store
from ..remote.trust import agree, source_names, unagreed_places
from ..settings import Settings, recent, remember
from ..sources import grid_finder
from ..tasks import Task
from .address_dialog import AddressDialog
from .joined_export import JoinedDialog, JoinedExportTask
from .plan_export import PlanExport
from .vehicle_export import VehicleExport

if TYPE_CHECKING:
    from ...core.geodesy.mercator import PixelGrid
    from ...core.mission.mission import Mission
    from ..dataset.placing import OpenProject
    from ..form.state import FormState
    from ..messages import Messages

#: Topic of the messages that ask for the user's agreement.
_UNAGREED = "unagreed"
#: Actions that may await the user's agreement.
_MISSION, _DATASETS = "mission", "datasets"
#: Largest number of characters of a name in a menu or message.
_MOST_TITLE = 100
#: Empty values for the area and the entries that depend on it.
_NO_AREA = dict.fromkeys((*BOX_FIELDS, "shape", "no_fly", "takeoff", "skip_rows", "split_after"), "")


class DatasetTask(Task):
    """Open the layers of a dataset, and build its mosaics if they are missing.

    Parameters
    ----------
    missions : mapping of Path to Mission
        Mission of the dataset by its folder, or of each of several imageries by its subfolder.
    find_grids : mapping of Path to callable
        By the same folders, functions that return the pixel grid of the mission's source, for missing mosaics.

    Attributes
    ----------
    opened : list of OpenedResults
    failed : list of QgsVectorLayer or None
        Layer of failed images of each dataset in ``opened``.
    left_out : str
        Why a mosaic is missing that could exist; empty if none is missing.
    """

    def __init__(
        self,
        folder: Path,
        mission: Mission | None,
        missions: Mapping[Path, Mission],
        find_grids: Mapping[Path, Callable[[], PixelGrid]],
    ) -> None:
        super().__init__(tr("Opening {name}").format(name=folder.name))
        self.folder, self.mission = folder, mission
        self.opened: list[OpenedResults] = []
        self.failed: list[QgsVectorLayer | None] = []
        self.left_out = ""
        self._missions, self._find_grids = missions, find_grids

    def work(self) -> None:
        """Open the layers."""
        for folder, mission in self._missions.items():
            elsewhere = has_images_elsewhere(folder)
            mosaics = [] if elsewhere else existing_mosaics(folder, mission)
            if mosaics is None:
                mosaics = self._made_mosaics(folder, mission)
            if self.isCanceled():
                return
            self.opened.append(open_results(folder, mission, mosaics)._replace(has_paths=not elsewhere))
            self.failed.append(self._open_failed(folder))
            if self.isCanceled():
                return

    def _open_failed(self, folder: Path) -> QgsVectorLayer | None:
        try:
            FailedImages(folder).update()
            return open_failed(folder)
        except OutputError as wrong:
            self.left_out = self.left_out or translate(wrong)
            return None

    def _made_mosaics(self, folder: Path, mission: Mission) -> list[MosaicRaster]:
        from ..sources import mission_heights, plan_mission

        places = unagreed_places(source_names(mission))
        if places:
            self.left_out = tr("it needs {place}, which you have not used in this QGIS").format(
                place=one_line(places[0], _MOST_TITLE)
            )
            return []
        try:
            steps = plan_mission(mission, self._find_grids[folder])
            return build_any_mosaics(steps, folder, mission_heights, self.report_progress)
        except TerrAInavError as wrong:
            # The footprints can be shown without the source.
            self.left_out = translate(wrong)
            return []


class AddressTask(DatasetTask):
    """Open a remote dataset: copy the files that its footprints need, and open the copy.

    Parameters
    ----------
    address : DatasetAddress
    again : bool
        Whether the project contains it already: the panel stays as it is.
    """

    def __init__(self, address: DatasetAddress, again: bool = False) -> None:
        super().__init__(copy_folder(address), None, {}, {})
        self.address, self.again = address, again
        self._store = Store(address)

    def work(self) -> None:
        """Copy the files, and open the copy."""
        self.folder, self.mission = copy_dataset(self._store, self.report_progress)
        self._missions = _missions_inside(self.mission, self.folder)
        super().work()

    def cancel(self) -> None:
        """Cancel the requests too."""
        super().cancel()
        self._store.close()

    def finished(self, result: bool) -> None:
        """Emit `ended`, on the main thread."""
        # Also needed here: a task cancelled before its start does not run `work`.
        self._store.close()
        super().finished(result)


class Missions(QObject):
    """The menu of missions, and its actions.

    Parameters
    ----------
    button : QToolButton
        Button that opens the menu.
    messages : Messages
    open_project : OpenProject
    read, write : callable
        Return the state of the form; enter a state into it.
    captures : callable
        Returns the folders of this session's captures.

    Signals
    -------
    preview_wanted(bool)
        True to show the preview and zoom to it, False to remove it.
    reopened()
        A mission of the project has been entered into the panel; its preview stays.
    zoom_wanted(object)
        A box to show on the map.
    refused(object)
        Error messages by field.
    capture_failed_wanted()
        The user wants to capture the failed images of the entered mission.
    clean_wanted(object)
        The user wants to clean the dataset in a folder.
    compare_wanted()
        The user wants to compare two images on the map.
    opening(str, float)
        Name of the dataset that is being opened, and the percentage of its mosaics made; empty at the end.
    """

    preview_wanted = pyqtSignal(bool)
    reopened = pyqtSignal()
    zoom_wanted = pyqtSignal(object)
    refused = pyqtSignal(object)
    capture_failed_wanted = pyqtSignal()
    clean_wanted = pyqtSignal(object)
    compare_wanted = pyqtSignal()
    opening = pyqtSignal(str, float)

    def __init__(
        self,
        button: QToolButton,
        messages: Messages,
        open_project: OpenProject,
        read: Callable[[], FormState],
        write: Callable[[FormState], None],
        captures: Callable[[], list[Path]],
    ) -> None:
        super().__init__()
        self._button, self._messages, self._open_project = button, messages, open_project
        self._read, self._write, self._captures = read, write, captures
        self._settings = Settings()
        self._task: DatasetTask | None = None
        #: Actions that await the user's agreement, with the servers and files that they access.
        self._unagreed: dict[str, tuple[tuple[str, ...], Callable[[], None]]] = {}
        open_project.project.cleared.connect(self._forget_unagreed)
        #: Remote datasets that were opened again: number of the project that contains them, and address.
        self._sought: set[tuple[int, str]] = set()
        self.plan_export = PlanExport(
            button, messages, self._folder, lambda: self._read().drone != DECLARED["drone"].default
        )
        self.vehicle_export = VehicleExport(button, messages)
        self.menu = QMenu(button)
        self.menu.setObjectName("missions_menu")
        self.menu.setToolTipsVisible(True)
        self.menu.aboutToShow.connect(self._fill)
        button.setMenu(self.menu)

    @property
    def busy(self) -> bool:
        """Whether a dataset is being opened."""
        return self._task is not None

    def close(self) -> None:
        """Stop for good."""
        self._open_project.project.cleared.disconnect(self._forget_unagreed)
        self.plan_export.close()
        self.vehicle_export.close()
        if self._task is not None:
            self._task.abandon()
            self._task.waitForFinished()
            self._task = None

    # --- the menu

    def _fill(self) -> None:
        menu = self.menu
        menu.clear()
        saved = saved_missions(self._open_project.project)
        if saved:
            menu.addSection(tr("In this project"))
        current = str(self._folder())
        for mission in saved:
            title = shortened(mission.title, _MOST_TITLE)
            action = menu.addAction(_plain(title), partial(self.open_saved, mission))
            action.setToolTip(shown_plain(shortened(mission.folder, MAX_LINE_CHARACTERS)))
            action.setCheckable(True)
            action.setChecked(mission.folder == current)
        menu.addSeparator()
        menu.addAction(tr("&New mission"), self.begin_new)
        menu.addAction(tr("&Open mission file…"), self.ask_for_file)
        menu.addAction(tr("Open &dataset folder…"), self.ask_for_dataset)
        at_address = menu.addAction(tr("Open dataset at an &address…"), self.ask_for_address)
        at_address.setToolTip(tr("On a web server or in an object store, such as https://host/run or s3://bucket/run"))
        last = menu.addMenu(tr("Open &recent"))
        for path in recent():
            address = copied_address(path)
            text = str(path) if address is None else address.url
            last.addAction(_plain(text), partial(self.open_path, path)).setToolTip(shown_plain(text))
        last.setEnabled(not last.isEmpty())
        menu.addAction(tr("&Save mission as file…"), self.save_as)
        export = menu.addAction(tr("&Export plan…"), self.plan_export.ask)
        export.setEnabled(not self.plan_export.reason)
        export.setToolTip(
            shown_plain(self.plan_export.reason)
            if self.plan_export.reason
            else tr("For DJI Pilot 2, QGroundControl, Litchi or Google Earth; as GPX, GeoPackage, GeoJSON or a table")
        )
        vehicle = menu.addAction(tr("Export to a &vehicle…"), self.vehicle_export.ask)
        vehicle.setEnabled(export.isEnabled())
        vehicle.setToolTip(
            shown_plain(self.plan_export.reason)
            if self.plan_export.reason
            else tr("Upload the flight to PX4 or ArduPilot over MAVLink, with the Python package pymavlink")
        )
        joined = menu.addAction(tr("Export as one fligh&t…"), self.export_joined)
        joined.setToolTip(tr("Several missions in one flight plan, with safe transits between them"))
        menu.addSeparator()
        failed = menu.addAction(tr("Capture only the &failed images"), self.capture_failed)
        failed.setToolTip(tr("Capture the images of the panel's mission that failed earlier"))
        failed.setEnabled(file_exists(self._folder() / FAILED_FILE))
        unchangeable = read_only_reason(self._folder())
        clean = menu.addAction(tr("&Dataset…"), self.clean)
        clean.setToolTip(tr("Clean, split, export and look at the dataset of the panel's mission"))
        clean.setEnabled(file_exists(self._folder() / MISSION_FILE) and not unchangeable)
        for action in (failed, clean) if unchangeable else ():
            action.setToolTip(shown_plain(unchangeable))
        compare = menu.addAction(tr("Co&mpare images…"), self.compare_wanted.emit)
        compare.setToolTip(tr("Flicker between two images on the map, such as two dates of one mission"))
        compare.setEnabled(len(mission_layers(self._open_project.project, RASTER)) > 1)

    # --- several missions

    def export_joined(self) -> None:
        """Let the user choose missions of the project and a file, and write them as one flight."""
        from ...core.mission.mission import Mission

        missions: list[tuple[str, Mission]] = []
        for saved in saved_missions(self._open_project.project):
            title = shortened(saved.title, _MOST_TITLE)
            try:
                missions.append((title, Mission.from_json(saved.text)))
            except TerrAInavError as wrong:
                self._tell_broken(title, wrong)
        dialog = JoinedDialog(missions, self._settings.missions, self._tell_broken, self._button.window())
        accepted = dialog.exec() == QDialog.DialogCode.Accepted
        picked = dialog.chosen()
        dialog.deleteLater()
        if not accepted:
            return

        def export() -> None:
            path = self.plan_export.ask_for_path(tr("flight"))
            if path is not None:
                self.plan_export.begin(JoinedExportTask(picked, [*map(grid_finder, picked.values())], path))

        self._once_agreed(_MISSION, [name for one in picked.values() for name in source_names(one)], export)

    # --- opening

    def restore(self) -> None:
        """Enter the mission that was in the panel when the opened project was saved."""
        saved = saved_missions(self._open_project.project)
        if saved:
            self._open_saved(next((mission for mission in saved if mission.current), saved[0]), zoom=False)
        self._open_lost()

    def open_saved(self, saved: SavedMission) -> None:
        """Enter a mission of the project into the panel."""
        self._open_saved(saved, zoom=True)

    def ask_for_file(self) -> None:
        """Let the user choose a mission file, and open it."""
        path, _ = QFileDialog.getOpenFileName(
            self._button.window(),
            tr("TerrAInav: open mission"),
            str(self._settings.missions),
            tr("Mission files (*.json);;All files (*)"),
        )
        if path:
            self.open_path(Path(path))

    def ask_for_dataset(self) -> None:
        """Let the user choose the folder of a dataset, and open it."""
        path = QFileDialog.getExistingDirectory(
            self._button.window(),
            tr("TerrAInav: open dataset"),
            str(self._settings.missions),
        )
        if path:
            self.open_path(Path(path))

    def ask_for_address(self) -> None:
        """Let the user enter the address of a dataset, and open it."""
        dialog = AddressDialog(self._button.window())
        if dialog.exec() == QDialog.DialogCode.Accepted:
            if dialog.address is None:
                self.open_path(entered_folder(dialog.entry.text()))
            else:
                self.open_address(dialog.address)
        dialog.deleteLater()

    def open_address(self, address: DatasetAddress, again: bool = False) -> None:
        """Enter the mission of a remote dataset into the panel, and add its footprints to the map.

        Parameters
        ----------
        address : DatasetAddress
        again : bool
            Whether the project contains it already: the panel stays as it is.
        """
        if self._task is not None:
            return
        if not again:
            agree([address.url])
        self._begin(AddressTask(address, again), address.name, None)

    def _open_lost(self) -> None:
        """Copy the project's remote datasets that have no copy on this machine, one after another, each once only."""
        number = self._open_project.number
        lost = []
        for folder, text in addresses(self._open_project.project):
            if copied_address(folder) is not None or (number, text) in self._sought:
                continue
            try:
                lost.append((text, DatasetAddress.parse(text)))
            except InvalidInput as wrong:
                self._sought.add((number, text))
                self._tell_broken(folder.name, wrong)

        def copy() -> None:
            if lost and self._task is None:
                text, address = lost[0]
                self._sought.add((number, text))
                self.open_address(address, again=True)

        self._once_agreed(_DATASETS, [address.url for _, address in lost], copy)

    def open_path(self, path: Path) -> None:
        """Open a dataset's folder or a mission file; for the copy of a remote dataset, open its address."""
        address = copied_address(path)
        if address is not None:
            self.open_address(address)
        elif is_folder(path):
            self.open_dataset(path)
        elif path.name == MISSION_FILE and file_exists(path.parent / JOURNAL_FILE):
            self.open_dataset(path.parent)
        else:
            self.open_file(path)

    def open_file(self, path: Path) -> None:
        """Enter the mission of a file into the panel, with another folder."""
        from ...core.mission.mission import Mission

        folder = self._settings.missions / path.stem
        try:
            mission = Mission.load(path)
            state = self._form_state(mission, self._suggested(next_folder(folder) if exists(folder) else folder))
        except TerrAInavError as wrong:
            self._tell_broken(path.name, wrong)
            return
        remember(path)

        def take_up() -> None:
            self._write(state)
            self.preview_wanted.emit(True)

        self._once_agreed(_MISSION, source_names(mission), take_up)

    def open_dataset(self, folder: Path) -> None:
        """Enter the mission of a dataset into the panel, and add its results to the map."""
        from ...core.mission.mission import Mission

        if self._task is not None:
            return
        try:
            if not file_exists(folder / MISSION_FILE):
                raise InvalidInput(
                    tr("folder {folder}: has no {name}, so it is not a dataset of a capture; choose its folder").format(
                        folder=folder, name=MISSION_FILE
                    )
                )
            mission = Mission.load(folder / MISSION_FILE)
            state = self._form_state(mission, folder)
            missions = _missions_inside(mission, folder)
            finders = {path: grid_finder(one) for path, one in missions.items()}
            task = DatasetTask(folder, mission, missions, finders)
        except TerrAInavError as wrong:
            self._tell_broken(folder.name, wrong)
            return
        self._begin(task, folder.name, state)

    def stop_opening(self) -> None:
        """Cancel the opening of a dataset."""
        if self._task is not None:
            self._task.cancel()

    def _begin(self, task: DatasetTask, name: str, state: FormState | None) -> None:
        begun_in = self._open_project.number
        self._task = task
        task.progressChanged.connect(lambda percent: self.opening.emit(name, percent))
        self.opening.emit(name, 0.0)
        task.begin(lambda task: self._dataset_opened(task, state, begun_in))

    # --- groups of datasets

    def restore_dataset(self, folder: Path) -> None:
        """Save the mission of a dataset with its group again, in place of a mission planned there since."""
        mission = _read_mission(folder)
        if mission is not None:
            self._open_project.mission_group(folder).remember_mission(mission.to_json())

    def gather(self, folder: Path) -> None:
        """Put the groups of a dataset, and of datasets of the same mission with other imagery, into one group."""
        mission = _read_mission(folder)
        if mission is not None:
            self._open_project.mission_group(folder).gather(lambda text: _is_same_flight(text, mission))

    # --- other menu entries

    def begin_new(self) -> None:
        """Clear the area and propose a free folder; keep camera, height and source."""
        state = self._read()
        folder = self._folder() if state.folder.strip() else self._settings.missions / "mission-1"
        taken = {Path(saved.folder) for saved in saved_missions(self._open_project.project)}
        taken |= set(self._captures())
        following = self._suggested(next_folder(_whole(folder), taken | {folder}))
        self.preview_wanted.emit(False)
        self._write(replace(state, folder=str(following), **_NO_AREA))
        if state.has_box and not file_exists(folder / MISSION_FILE):
            back = tr("Back to {name}").format(name=folder.name)
            # It stays, as the only way back.
            text = tr("{name} was not captured.").format(name=folder.name)
            self._messages.info(text, (back, lambda: self._write(state)), lasts=True)

    def begin_anew(self) -> None:
        """Clear the area for a new project, and propose a free folder."""
        state = self._read()
        if not any(getattr(state, name) for name in _NO_AREA):
            return
        folder = self._folder()
        if state.folder.strip() and exists(folder):
            taken = set(self._captures())
            state = replace(state, folder=str(self._suggested(next_folder(_whole(folder), taken))))
        self._write(replace(state, **_NO_AREA))

    def save_as(self) -> None:
        """Let the user save the panel's mission to a file."""
        try:
            mission = mission_form.mission(self._read())
        except FormError as wrong:
            self.refused.emit(wrong.messages)
            reason = next(iter(wrong.messages.values()), "")
            self._messages.refused(reason, tr("Nothing to save yet."))
            return
        chosen, _ = QFileDialog.getSaveFileName(
            self._button.window(),
            tr("TerrAInav: save mission"),
            str(self._settings.missions / f"{self._folder().name}.json"),
            tr("Mission files (*.json)"),
        )
        if not chosen:
            return
        path = Path(chosen)
        path = path if path.suffix else path.with_suffix(".json")
        try:
            mission.save(path)
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
            return
        remember(path)
        self._messages.success(tr("Mission saved as {name}.").format(name=path.name))

    def capture_failed(self) -> None:
        """Capture only the failed images of the panel's mission."""
        self.capture_failed_wanted.emit()

    def clean(self) -> None:
        """Open the window for cleaning the dataset of the panel's mission."""
        self.clean_wanted.emit(self._folder())

    # --- implementation

    def _suggested(self, folder: Path) -> Path:
        """Note that the panel has proposed a folder; if the folder is taken, a capture uses the next number."""
        self._settings.suggested_folder = str(folder)
        return folder

    def _folder(self) -> Path:
        return entered_folder(self._read().folder)

    def _form_state(self, mission: Mission, folder: Path) -> mission_form.FormState:
        return mission_form.mission_state(mission, str(folder), like=self._read())

    def _open_saved(self, saved: SavedMission, zoom: bool) -> None:
        from ...core.mission.mission import Mission

        try:
            if not saved.folder:
                raise InvalidInput(tr("its folder is not a path"))
            mission = Mission.from_json(saved.text)
            state = self._form_state(mission, Path(saved.folder))
        except TerrAInavError as wrong:
            self._messages.warning(tr("The project's mission cannot be read: {error}").format(error=translate(wrong)))
            return

        def take_up() -> None:
            self._write(state)
            self.reopened.emit()
            if zoom:
                self.zoom_wanted.emit(mission.area.bounds)

        self._once_agreed(_MISSION, [*source_names(mission), saved.folder], take_up)

    # --- places that others name and the user has not used in this QGIS

    def _once_agreed(self, topic: str, texts: Iterable[str], act: Callable[[], None]) -> None:
        """Call ``act``, which accesses sources: now, or once the user has agreed to new servers and files.

        Until then, nothing is requested, and a project keeps its contents.
        """
        places = unagreed_places(texts)
        self._unagreed.pop(topic, None)
        if not places:
            act()
        else:
            self._unagreed[topic] = places, act
        self._messages.withdraw(_UNAGREED)
        if not self._unagreed:
            return
        named = dict.fromkeys(one_line(place, _MOST_TITLE) for one, _ in self._unagreed.values() for place in one)
        shown = ", ".join([*named][:3]) + (" …" if len(named) > 3 else "")
        with self._messages.topic(_UNAGREED):
            self._messages.warning(
                tr(
                    "What you opened takes imagery, heights or datasets from {places}, which you have "
                    "not used in this QGIS. Nothing is requested there until you allow it."
                ).format(places=shown),
                action=(tr("Allow"), self._allow),
            )

    def _allow(self) -> None:
        waiting = [*self._unagreed.values()]
        self._unagreed.clear()
        agree(place for places, _ in waiting for place in places)
        for _, act in waiting:
            act()

    def _forget_unagreed(self) -> None:
        """Forget pending actions of a closed project."""
        self._unagreed.clear()
        self._messages.withdraw(_UNAGREED)

    def _dataset_opened(self, task: DatasetTask, state: mission_form.FormState | None, begun_in: int) -> None:
        self._task = None
        self.opening.emit("", 0.0)
        at_address = task if isinstance(task, AddressTask) else None
        if at_address is not None and begun_in == self._open_project.number:
            self._open_lost()
        if task.error:
            name = "" if at_address is None else f"{at_address.address.name}: "
            self._messages.failed(f"{name}{translate(task.error)}", task.trace)
            return
        if task.isCanceled() or begun_in != self._open_project.number:
            return
        if at_address is not None:
            try:
                state = None if at_address.again else self._form_state(task.mission, task.folder)
            except TerrAInavError as wrong:
                self._tell_broken(task.folder.name, wrong)
                return
        remember(task.folder)
        # In reverse, as each is inserted above the others, and the first one must be on top.
        for opened, failed in reversed([*zip(task.opened, task.failed)]):
            inside = self._open_project.mission_group(opened.folder)
            if at_address is not None:
                reread_footprints(inside)
            show_results(inside, opened)
            show_failed(inside, failed)
        # Release layers that were not needed: they keep files open.
        task.opened, task.failed = [], []
        group = self._open_project.mission_group(task.folder)
        if at_address is not None:
            group.remember_address(at_address.address.url)
        if state is None:
            return
        self._once_agreed(_MISSION, source_names(task.mission), partial(self._write, state))
        group.remember_mission(task.mission.to_json())
        self.gather(task.folder)
        group.make_current()
        self.zoom_wanted.emit(task.mission.area.bounds)
        if task.left_out:
            self._messages.warning(
                tr("{name}: opened without mosaic: {reason}").format(name=task.folder.name, reason=task.left_out)
            )

    def _tell_broken(self, name: str, wrong: TerrAInavError) -> None:
        self._messages.warning(tr("{name} was not opened: {reason}").format(name=name, reason=translate(wrong)))


def _whole(folder: Path) -> Path:
    """Folder of the whole dataset, if the given one is of one of its imageries."""
    return folder.parent if exists(folder.parent / MISSION_FILE) else folder


def _read_mission(folder: Path) -> Mission | None:
    """Mission of the dataset in a folder; None if it cannot be read."""
    from ...core.mission.mission import Mission

    try:
        return Mission.load(folder / MISSION_FILE)
    except TerrAInavError:
        return None


def _missions_inside(mission: Mission, folder: Path) -> dict[Path, Mission]:
    """Missions of the datasets in a folder, by their folders: the only one, or one for each captured imagery."""
    from ...core.mission.mission import Mission

    if not mission.imagery.imageries:
        return {folder: mission}
    places = [folder / one.name for one in mission.imagery.named]
    return {place: Mission.load(place / MISSION_FILE) for place in places if file_exists(place / MISSION_FILE)}


def _is_same_flight(text: str, mission: Mission) -> bool:
    """Whether a mission, as JSON, has the same flight as another, apart from imagery and files."""
    from ...core.mission.mission import Mission

    try:
        other = Mission.from_json(text)
    except TerrAInavError:
        # The mission is damaged, or of another version.
        return False
    return _flown(other) == _flown(mission)


def _flown(mission: Mission) -> dict[str, Any]:
    """A mission without imagery and output, as plain data."""
    return {name: part for name, part in mission.to_dict().items() if name not in ("imagery", "output")}


def _plain(text: str) -> str:
    """Text for a menu entry, escaped so that it has no mnemonic."""
    return text.replace("&", "&&")
