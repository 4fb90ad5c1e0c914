"""A capture in the panel's list: name, progress, figures, and what can be done about it."""

from __future__ import annotations

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtGui import QResizeEvent
from qgis.PyQt.QtWidgets import QFrame, QHBoxLayout, QLabel, QProgressBar, QToolButton, QVBoxLayout

from ..i18n import tr
from ..paths import icon
from ..plain import plain_label, shown_plain

_BAR_HEIGHT_PX = 6


class RunRow(QFrame):
    """Shows a run and asks; what it shows is given to it.

    Signals
    -------
    asked(str)
        One of `RunRow.DEEDS`.
    """

    DEEDS = PAUSE, RESUME, CANCEL, FAILED, ZOOM, CLEAN, OPEN, DISMISS = (
        "pause",
        "resume",
        "cancel",
        "capture_failed",
        "zoom",
        "clean",
        "open_folder",
        "dismiss",
    )
    asked = pyqtSignal(str)

    def __init__(self, title: str) -> None:
        super().__init__()
        self.setFrameShape(QFrame.Shape.StyledPanel)
        self.title = _ElidedLabel()
        self.title.setObjectName("run_title")
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.title.set_text(title)
        self.bar = QProgressBar()
        self.bar.setObjectName("run_progress")
        self.bar.setRange(0, 100)
        self.bar.setTextVisible(False)
        self.bar.setFixedHeight(_BAR_HEIGHT_PX)
        self.text = plain_label()
        self.text.setObjectName("run_text")
        self.text.setWordWrap(True)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.buttons = self._make_buttons(title)
        self._lay_out()

    def show_progress(self, percent: float, text: str) -> None:
        """Show how far the run is."""
        self.bar.setValue(int(percent))
        self.text.setText(text)

    def show_deeds(self, deeds: set[str], enabled: bool = True, underway: bool = True) -> None:
        """Offer what can be done now.

        Parameters
        ----------
        deeds : set of str
            Of `DEEDS`.
        enabled : bool
            Whether pausing is possible just now.
        underway : bool
            Whether there is a progress to show.
        """
        for name, button in self.buttons.items():
            button.setVisible(name in deeds)
        self.buttons[self.PAUSE].setEnabled(enabled)
        self.bar.setVisible(underway)

    def _make_buttons(self, title: str) -> dict[str, QToolButton]:
        of_qgis = QgsApplication.getThemeIcon
        looks = {
            self.PAUSE: (
                of_qgis("/temporal_navigation/pause.svg"),
                tr("Pause: hold this capture in its place"),
            ),
            self.RESUME: (of_qgis("/mActionPlay.svg"), tr("Resume this capture")),
            self.CANCEL: (of_qgis("/mTaskCancel.svg"), tr("Cancel; images that are finished are kept")),
            self.FAILED: (icon("capture_failed"), tr("Capture only the failed images again")),
            self.ZOOM: (of_qgis("/mActionZoomToLayer.svg"), tr("Zoom the map to this mission")),
            self.CLEAN: (icon("clean_dataset"), tr("Clean this dataset of images with too little to see")),
            self.OPEN: (of_qgis("/mActionFileOpen.svg"), tr("Open the folder of the images")),
            self.DISMISS: (of_qgis("/mIconClose.svg"), tr("Take this capture off the list; its images stay")),
        }
        buttons = {}
        for name, (image, tip) in looks.items():
            button = QToolButton()
            button.setObjectName(f"run_{name}")
            button.setIcon(image)
            button.setAutoRaise(True)
            button.setToolTip(tip)
            button.setAccessibleName(f"{tip} ({title})")
            # By keyboard as well.
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.clicked.connect(lambda _=False, name=name: self.asked.emit(name))
            buttons[name] = button
        return buttons

    def _lay_out(self) -> None:
        top = QHBoxLayout()
        top.setSpacing(0)
        top.addWidget(self.title, 1)
        for button in self.buttons.values():
            top.addWidget(button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(6, 2, 4, 4)
        layout.setSpacing(2)
        layout.addLayout(top)
        layout.addWidget(self.bar)
        layout.addWidget(self.text)


class _ElidedLabel(QLabel):
    """A line that is cut where the panel is narrow, and told whole by its tooltip."""

    def __init__(self) -> None:
        super().__init__()
        self.setTextFormat(Qt.TextFormat.PlainText)
        self._whole = ""
        self.setMinimumWidth(self.fontMetrics().averageCharWidth() * 8)

    def set_text(self, text: str) -> None:
        self._whole = text
        self.setToolTip(shown_plain(text))
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _fit(self) -> None:
        self.setText(self.fontMetrics().elidedText(self._whole, Qt.TextElideMode.ElideMiddle, self.width()))
