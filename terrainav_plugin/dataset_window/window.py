"""The window of a dataset: its folder, a tab for each kind of action, and Stop."""

from __future__ import annotations

from qgis.core import QgsApplication
from qgis.gui import QgsDockWidget
from qgis.PyQt.QtCore import QSignalBlocker, pyqtSignal
from qgis.PyQt.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QTabWidget, QVBoxLayout, QWidget

from ..i18n import tr
from ..widgets import folder_entry, growing_form, named, push_button, scrolled


class DatasetWindow(QgsDockWidget):
    """The dock widget with the tabs.

    Signals
    -------
    folder_chosen(str)
    compare_wanted(), stop_wanted()
    """

    folder_chosen = pyqtSignal(str)
    compare_wanted = pyqtSignal()
    stop_wanted = pyqtSignal()

    def __init__(self, tabs: dict[str, QWidget]) -> None:
        super().__init__(tr("Dataset (TerrAInav)"))
        self.setObjectName("terrainav_dataset")
        self.folder = folder_entry(
            "dataset_folder",
            tr("TerrAInav: folder of a dataset"),
            tr("Of a capture, or of images with a meta_data.csv beside them"),
        )
        self.folder.fileChanged.connect(self.folder_chosen)
        self.compare = push_button(
            "compare",
            tr("Compare…"),
            tr("Flicker between two images on the map, such as two dates of one mission"),
        )
        self.compare.clicked.connect(lambda _checked: self.compare_wanted.emit())
        self.tabs = named(QTabWidget(), "dataset_tabs")
        self.tabs.setUsesScrollButtons(True)
        titles = {
            "clean": tr("Clean"),
            "split": tr("Split"),
            "benchmark": tr("Benchmark"),
            "export": tr("Export"),
            "labels": tr("Labels"),
        }
        for name, tab in tabs.items():
            # Scroll the tabs: the window may be docked next to other panels, which it must not widen.
            self.tabs.addTab(scrolled(tab), titles[name])
        self.bar = named(QProgressBar(), "dataset_progress")
        self.bar.setTextVisible(False)
        self.bar.setFixedHeight(6)
        self.stop = push_button("stop", tr("Stop"), tr("Stop; what a task has done so far can be finished, or undone"))
        self.stop.setIcon(QgsApplication.getThemeIcon("/mTaskCancel.svg"))
        self.stop.clicked.connect(lambda _checked: self.stop_wanted.emit())
        self.setWidget(self._contents())
        self.show_working(False, 0.0)

    def show_folder(self, folder: str) -> None:
        """Show a folder without emitting signals."""
        with QSignalBlocker(self.folder):
            self.folder.setFilePath(folder)

    def show_working(self, working: bool, percent: float) -> None:
        """Show whether a task is under way, and its progress; the folder cannot change meanwhile."""
        self.show_progress(working, percent)
        self.folder.setEnabled(not working)

    def show_progress(self, shown: bool, percent: float) -> None:
        """Show progress, and the button that stops it; 0 % as a moving bar, as long as the share is unknown."""
        self.bar.setVisible(shown)
        self.stop.setVisible(shown)
        if shown:
            self.bar.setMaximum(100 if percent else 0)
            self.bar.setValue(int(percent))

    def _contents(self) -> QWidget:
        form = growing_form()
        label = QLabel(tr("Dataset &folder"))
        label.setBuddy(self.folder)
        form.addRow(label, self.folder)
        line = QHBoxLayout()
        line.addWidget(self.compare)
        line.addWidget(self.bar, 1)
        line.addStretch()
        line.addWidget(self.stop)
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addLayout(form)
        layout.addWidget(self.tabs, 1)
        layout.addLayout(line)
        return contents
