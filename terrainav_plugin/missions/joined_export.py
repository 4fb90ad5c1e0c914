"""Export of several missions of the project as one flight plan."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QAbstractItemView,
    QDialog,
    QDialogButtonBox,
    QFileDialog,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import Cancelled, TerrAInavError
from ..i18n import tr, translate
from ..widgets import named, push_button
from .plan_export import PlanExportTask

if TYPE_CHECKING:
    from ...core.geodesy.mercator import PixelGrid
    from ...core.mission.mission import Mission


class JoinedDialog(QDialog):
    """Choose missions, of the project and of files, and their order.

    Parameters
    ----------
    missions : iterable of (str, Mission)
        Titles and missions of the project, of which all are checked; a number is added to a title that appears again.
    folder : Path
        Folder in which the dialog for files begins.
    refused : callable
        Receives the name of a file that is no mission, and the error.
    """

    def __init__(
        self,
        missions: Iterable[tuple[str, Mission]],
        folder: Path,
        refused: Callable[[str, TerrAInavError], None],
        parent: QWidget,
    ) -> None:
        super().__init__(parent)
        self._missions: dict[str, Mission] = {}
        self._folder, self._refused = folder, refused
        self.setObjectName("joined_dialog")
        self.setWindowTitle(tr("TerrAInav: export as one flight"))
        about = QLabel(tr("Missions in the order of the flight: drag them to change it"))
        about.setWordWrap(True)
        self.list = named(QListWidget(), "joined_missions", about.text())
        self.list.setDragDropMode(QAbstractItemView.DragDropMode.InternalMove)
        for title, mission in missions:
            self._add(title, mission)
        about.setBuddy(self.list)
        self.add_files = push_button("add_missions", tr("&Add mission files…"), tr("Add missions saved as files"))
        self.add_files.clicked.connect(self._ask_for_files)
        buttons = QDialogButtonBox.StandardButton
        self.buttons = QDialogButtonBox(buttons.Ok | buttons.Cancel)
        self.buttons.button(buttons.Ok).setText(tr("Export…"))
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        for widget in (about, self.list, self.add_files, self.buttons):
            layout.addWidget(widget)
        self.list.itemChanged.connect(self._enable)
        self._enable()

    def chosen(self) -> dict[str, Mission]:
        """Checked missions by title, in order."""
        items = (self.list.item(at) for at in range(self.list.count()))
        checked = (item for item in items if item.checkState() == Qt.CheckState.Checked)
        return {item.text(): self._missions[item.text()] for item in checked}

    def _add(self, title: str, mission: Mission) -> None:
        name, number = title, 2
        while name in self._missions:
            name, number = f"{title} ({number})", number + 1
        # Several imageries share one flight.
        self._missions[name] = mission.of_first_imagery
        item = QListWidgetItem(name)
        item.setFlags(item.flags() | Qt.ItemFlag.ItemIsUserCheckable)
        item.setCheckState(Qt.CheckState.Checked)
        self.list.addItem(item)

    def _ask_for_files(self) -> None:
        title, kinds = tr("TerrAInav: add missions"), tr("Mission files (*.json);;All files (*)")
        paths, _ = QFileDialog.getOpenFileNames(self, title, str(self._folder), kinds)
        for path in paths:
            self._add_file(Path(path))
        self._enable()

    def _add_file(self, path: Path) -> None:
        from ...core.mission.mission import Mission

        try:
            self._add(path.stem, Mission.load(path))
        except TerrAInavError as wrong:
            self._refused(path.name, wrong)

    def _enable(self, *_: object) -> None:
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(len(self.chosen()) > 1)


class JoinedExportTask(PlanExportTask):
    """Plan missions, join them to one flight, and write it.

    Parameters
    ----------
    missions : mapping of str to Mission
        Missions by their titles, in the order of the flight.
    find_grids : sequence of callable
        Functions that return the pixel grid of each mission's source.

    Attributes
    ----------
    figures : str
        Figures of the flight in words.
    """

    def __init__(
        self,
        missions: Mapping[str, Mission],
        find_grids: Sequence[Callable[[], PixelGrid]],
        path: Path,
        replace_parts: bool = False,
    ) -> None:
        super().__init__(None, path, replace_parts)
        self._missions, self._find_grids = missions, find_grids
        self.figures = ""

    def work(self) -> None:
        """Plan, join and write."""
        from ...core.mission.flight.joined import join_plans, summarize
        from ..sources import mission_heights, plan_mission

        plans = []
        for number, (mission, find_grid) in enumerate(zip(self._missions.values(), self._find_grids)):
            plans.append(plan_mission(mission, find_grid))
            if not self.report_progress((number + 1) / (len(self._missions) + 1)):
                raise Cancelled
        first = next(iter(self._missions.values()))
        self.plan = join_plans(plans, list(self._missions), mission_heights(first))
        lines = list(summarize(self.plan, list(self._missions)).lines())[len(plans) + 1 :]
        self.figures = "; ".join(f"{translate(label)}: {translate(text)}" for label, text in lines)
        try:
            super().work()
        finally:
            # The entries of the panel are of one mission, so none of them is marked.
            self.refusal = None

    def again(self) -> JoinedExportTask:
        """Return a task that replaces parts."""
        return JoinedExportTask(self._missions, self._find_grids, self.path, replace_parts=True)
