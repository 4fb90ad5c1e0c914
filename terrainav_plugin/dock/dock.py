"""The mission panel: entries, figures, progress and buttons."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.core import QgsApplication
from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsDockWidget
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtGui import QIcon
from qgis.PyQt.QtWidgets import (
    QFrame,
    QGridLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QStyle,
    QVBoxLayout,
    QWidget,
)

from ..i18n import tr
from ..paths import icon
from .choices import CameraChoice, SourceChoice
from .dock_form import DockForm
from .figures import Figures


class Dock(QgsDockWidget):
    """The panel. It shows and asks; what to do about it is decided elsewhere.

    Signals
    -------
    preview_toggled(bool), test_shot_clicked(), capture_clicked(), cancel_clicked()
    """

    preview_toggled = pyqtSignal(bool)
    test_shot_clicked = pyqtSignal()
    capture_clicked = pyqtSignal()
    cancel_clicked = pyqtSignal()

    def __init__(self, sources: Sequence[SourceChoice], cameras: Sequence[CameraChoice]) -> None:
        super().__init__(tr("TerrAInav mission"))
        self.setObjectName("terrainav_dock")
        self.form = DockForm(sources, cameras)
        self.hint = _wrapped_label("hint")
        self.hint.setFrameShape(QFrame.Shape.StyledPanel)
        self.hint.setMargin(6)
        self.estimates = _wrapped_label("estimates")
        self.problem = _wrapped_label("problem")
        self.problem.setProperty("terrainavMark", "true")
        self._make_progress()
        self._make_buttons()
        self.setWidget(self._contents())
        self.show_running(None)

    def show_hint(self, text: str) -> None:
        """Say what to do first; an empty text hides the hint."""
        self.hint.setText(text)
        self.hint.setVisible(bool(text))

    def show_estimates(self, text: str, details: str = "") -> None:
        """Show the figures of the plan, and more about them in a tooltip."""
        self.estimates.setText(text)
        self.estimates.setToolTip(details)
        self.estimates.show()
        self.problem.hide()
        self._figures.fit()

    def show_nothing(self) -> None:
        """Show that there is nothing to work out."""
        self.show_estimates(tr("No area yet."))

    def show_problem(self, text: str) -> None:
        """Show why there are no figures."""
        self.estimates.setText("")
        self.estimates.setToolTip("")
        self.problem.setText(text)
        self.estimates.hide()
        self.problem.setVisible(bool(text))
        self._figures.fit()

    def show_preview_on(self, on: bool) -> None:
        """Press or release the preview button without asking for a preview."""
        self.preview.blockSignals(True)
        self.preview.setChecked(on)
        self.preview.blockSignals(False)

    def show_running(self, text: str | None, percent: float = 0.0) -> None:
        """Show the progress of a run; None when none is running."""
        running = text is not None
        self.progress.setVisible(running)
        self.progress_text.setVisible(running)
        self.cancel.setVisible(running)
        self.capture.setVisible(not running)
        self.test_shot.setEnabled(not running)
        self.progress.setValue(int(percent))
        self.progress_text.setText(text or "")

    def _make_progress(self) -> None:
        self.progress = QProgressBar()
        self.progress.setObjectName("progress")
        self.progress.setRange(0, 100)
        self.progress_text = _wrapped_label("progress_text")

    def _make_buttons(self) -> None:
        self.preview = _button(
            "preview", icon("preview"), tr("Preview"), tr("Show every planned image on the map")
        )
        self.preview.setCheckable(True)
        self.preview.toggled.connect(self.preview_toggled)
        self.test_shot = _button(
            "test_shot",
            icon("test_shot"),
            tr("Test shot"),
            tr("Click a point on the map and capture one image there"),
        )
        self.test_shot.clicked.connect(self.test_shot_clicked)
        self.capture = _button(
            "capture",
            icon("capture"),
            tr("Capture"),
            tr("Write all images; goes on where an earlier run was stopped"),
        )
        self.capture.clicked.connect(self.capture_clicked)
        self.cancel = _button(
            "cancel",
            QgsApplication.getThemeIcon("/mTaskCancel.svg"),
            tr("Cancel"),
            tr("Stop; images that are finished are kept"),
        )
        self.cancel.clicked.connect(self.cancel_clicked)

    def _contents(self) -> QWidget:
        scroll = QScrollArea()
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        scroll.setWidget(self.form)
        # The form is scrolled up and down only: the panel is never too narrow for it.
        bar = scroll.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        scroll.setMinimumWidth(self.form.minimumSizeHint().width() + bar)
        figures = QgsCollapsibleGroupBoxBasic(tr("Estimates"))
        inside = QVBoxLayout(figures)
        self._figures = Figures(self.estimates, self.problem)
        inside.addWidget(self._figures)
        buttons = QGridLayout()
        buttons.addWidget(self.preview, 0, 0)
        buttons.addWidget(self.test_shot, 0, 1)
        buttons.addWidget(self.capture, 1, 0, 1, 2)
        buttons.addWidget(self.cancel, 1, 0, 1, 2)
        contents = QWidget()
        contents.setStyleSheet(self.form.styleSheet())
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 4, 4, 6)
        layout.addWidget(self.hint)
        layout.addWidget(scroll, 1)
        layout.addWidget(figures)
        layout.addWidget(self.progress)
        layout.addWidget(self.progress_text)
        layout.addLayout(buttons)
        return contents


def _wrapped_label(name: str) -> QLabel:
    label = QLabel()
    label.setObjectName(name)
    label.setWordWrap(True)
    label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
    return label


def _button(name: str, image: QIcon, text: str, tip: str) -> QPushButton:
    button = QPushButton(image, text)
    button.setObjectName(name)
    button.setToolTip(tip)
    return button
