"""The mission panel: entries, figures, buttons and captures."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.core import QgsApplication
from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsDockWidget
from qgis.PyQt.QtCore import QEvent, QObject, QSignalBlocker, Qt, QTimer, pyqtSignal
from qgis.PyQt.QtGui import QShowEvent
from qgis.PyQt.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QScrollArea,
    QStyle,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from ..help import show_help
from ..i18n import tr
from ..paths import icon
from ..widgets import push_button, tool_button, wrapped_label
from .choices import CameraChoice, SourceChoice
from .figures import Figures
from .form import DockForm
from .runs import RunList


class Dock(QgsDockWidget):
    """The panel. It shows and asks; what to do about it is decided elsewhere.

    Signals
    -------
    preview_toggled(bool), test_shot_clicked(), capture_clicked(), export_plan_clicked()
    hint_followed(str)
        Address of the link in the hint.
    """

    preview_toggled = pyqtSignal(bool)
    test_shot_clicked = pyqtSignal()
    capture_clicked = pyqtSignal()
    export_plan_clicked = pyqtSignal()
    hint_followed = pyqtSignal(str)

    def __init__(self, sources: Sequence[SourceChoice], cameras: Sequence[CameraChoice]) -> None:
        super().__init__(tr("TerrAInav mission"))
        self.setObjectName("terrainav_dock")
        self.form = DockForm(sources, cameras)
        self.hint = wrapped_label("hint")
        self.hint.setFrameShape(QFrame.Shape.StyledPanel)
        self.hint.setMargin(6)
        self.hint.setTextFormat(Qt.TextFormat.RichText)
        self.hint.setTextInteractionFlags(Qt.TextInteractionFlag.TextBrowserInteraction)
        self.hint.linkActivated.connect(self.hint_followed)
        self.figures = Figures()
        self.figures.enlarging_wanted.connect(self.form.allow_enlarged_pixels)
        self.estimates, self.problem = self.figures.estimates, self.figures.problem
        self.run_list = RunList()
        self._make_buttons()
        self.setWidget(self._contents())

    def show_hint(self, text: str) -> None:
        """Say what to do first, as HTML; an empty text hides the hint."""
        self.hint.setText(text)
        self.hint.setVisible(bool(text))

    def show_nothing(self) -> None:
        """Show that there is nothing to work out."""
        self.figures.show_text(tr("No area yet."))

    def show_problem(self, text: str) -> None:
        """Show why there are no figures."""
        self.figures.show_problem(text)

    def show_preview_on(self, on: bool) -> None:
        """Press or release the preview button without asking for a preview."""
        with QSignalBlocker(self.preview):
            self.preview.setChecked(on)

    def show_busy(self, busy: bool) -> None:
        """Show whether captures are under way: a test shot would wait behind them, another mission can."""
        self.test_shot.setEnabled(not busy)

    def _make_buttons(self) -> None:
        self.preview = push_button(
            "preview", tr("Preview"), tr("Show every planned image on the map"), icon("preview")
        )
        self.preview.setCheckable(True)
        self.preview.toggled.connect(self.preview_toggled)
        self.test_shot = push_button(
            "test_shot",
            tr("Test shot"),
            tr("Click a point on the map and capture one image there"),
            icon("test_shot"),
        )
        self.test_shot.clicked.connect(self.test_shot_clicked)
        self.capture = push_button(
            "capture",
            tr("Capture"),
            tr("Write all images; goes on where an earlier run was stopped"),
            icon("capture"),
        )
        self.capture.clicked.connect(self.capture_clicked)
        of_qgis = QgsApplication.getThemeIcon
        self.export_plan = push_button(
            "export_plan",
            tr("Export plan…"),
            tr("Write the plan as a file for drones, ground stations and other programs"),
            of_qgis("/mActionSharingExport.svg"),
        )
        self.export_plan.clicked.connect(lambda _checked: self.export_plan_clicked.emit())
        tip = tr("Missions of this project, mission files and datasets: open, save, begin")
        self.missions = tool_button("missions", of_qgis("/mActionFileOpen.svg"), tip, tr("Missions"))
        self.missions.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.missions.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.help = tool_button("help", of_qgis("/mActionHelpContents.svg"), tr("Open the guide"))
        self.help.setText(tr("Help"))
        self.help.clicked.connect(lambda _checked: show_help())

    def _contents(self) -> QWidget:
        figures = QgsCollapsibleGroupBoxBasic(tr("Estimates"))
        inside = QVBoxLayout(figures)
        inside.addWidget(self.figures)
        buttons = QGridLayout()
        buttons.addWidget(self.preview, 0, 0)
        buttons.addWidget(self.test_shot, 0, 1)
        buttons.addWidget(self.capture, 1, 0)
        buttons.addWidget(self.export_plan, 1, 1)
        buttons.setColumnStretch(0, 1)
        buttons.setColumnStretch(1, 1)
        top = QHBoxLayout()
        top.addWidget(self.missions)
        top.addStretch(1)
        top.addWidget(self.help)
        contents = QWidget()
        contents.setStyleSheet(self.form.styleSheet())
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 4, 4, 6)
        layout.addLayout(top)
        layout.addWidget(self.hint)
        layout.addWidget(FormScroll(self.form), 1)
        layout.addWidget(figures)
        layout.addLayout(buttons)
        layout.addWidget(self.run_list)
        return contents


class FormScroll(QScrollArea):
    """A scroll area that is never narrower than its contents, which may grow wider as entries come and go."""

    def __init__(self, contents: QWidget) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(contents)
        contents.installEventFilter(self)
        # Groups of QGIS scroll to themselves when they are unfolded, and also when they are first shown.
        self._groups = contents.findChildren(QgsCollapsibleGroupBoxBasic)
        self._let_groups_scroll(False)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        """Begin at the top; from then on, groups that are unfolded come into sight."""
        super().showEvent(event)
        QTimer.singleShot(0, self._shown)

    def _shown(self) -> None:
        self._let_groups_scroll(True)

    def _let_groups_scroll(self, scroll: bool) -> None:
        for group in self._groups:
            group.setScrollOnExpand(scroll)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow the contents."""
        if event.type() == QEvent.Type.LayoutRequest and watched is self.widget():
            self._fit()
        return super().eventFilter(watched, event)

    def _fit(self) -> None:
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setMinimumWidth(self.widget().minimumSizeHint().width() + bar)
