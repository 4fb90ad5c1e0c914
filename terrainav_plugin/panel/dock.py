"""The mission panel: entries, figures, buttons and captures."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.core import QgsApplication, QgsSettings
from qgis.gui import QgsCollapsibleGroupBoxBasic, QgsDockWidget
from qgis.PyQt.QtCore import QEvent, QObject, QSignalBlocker, QSize, Qt, QTimer, pyqtSignal
from qgis.PyQt.QtGui import QResizeEvent, QShowEvent
from qgis.PyQt.QtWidgets import (
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QScrollArea,
    QSplitter,
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
from .form import DockForm, set_tab_order
from .runs import RunList

_SHARE_KEY = "TerrAInav/estimates_share"


class Dock(QgsDockWidget):
    """The panel; it only displays, and emits the user's requests.

    Signals
    -------
    preview_toggled(bool), test_shot_clicked(), capture_clicked(), export_plan_clicked()
    hint_followed(str)
        The user has clicked a link in the hint, to this address.
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
        self.figures.upsampling_wanted.connect(self.form.allow_upsampling)
        self.estimates, self.problem = self.figures.estimates, self.figures.problem
        self.run_list = RunList()
        self._make_buttons()
        self.setWidget(self._contents())

    def show_hint(self, text: str) -> None:
        """Show a hint (HTML) on the first steps; an empty text hides it."""
        self.hint.setText(text)
        self.hint.setVisible(bool(text))

    def show_nothing(self) -> None:
        """Show that no area is entered."""
        self.figures.show_text(tr("No area yet."))

    def show_problem(self, text: str) -> None:
        """Show why there are no figures."""
        self.figures.show_problem(text)

    def set_preview_pressed(self, on: bool) -> None:
        """Press or release the preview button without emitting a signal."""
        with QSignalBlocker(self.preview):
            self.preview.setChecked(on)

    def show_busy(self, busy: bool) -> None:
        """Show whether captures are under way: this disables test shots, which would have to wait for them."""
        self.test_shot.setEnabled(not busy)

    def _make_buttons(self) -> None:
        self.preview = push_button("preview", tr("Preview"), tr("Show every planned image on the map"), icon("preview"))
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
            tr("Capture all images; resumes where an earlier run stopped"),
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
        tip = tr("Open, save and start missions: of this project, from files or from datasets")
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
        below = QWidget()
        inside_below = QVBoxLayout(below)
        inside_below.setContentsMargins(0, 0, 0, 0)
        inside_below.addWidget(figures)
        inside_below.addWidget(self.run_list)
        inside_below.addStretch(1)
        above = QWidget()
        inside_above = QVBoxLayout(above)
        inside_above.setContentsMargins(0, 0, 0, 0)
        inside_above.addWidget(self.hint)
        inside_above.addWidget(self.form, 1)
        self.parts = PanelSplitter(FormScroll(above), below)
        contents = QWidget()
        contents.setStyleSheet(self.form.styleSheet())
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 4, 4, 6)
        layout.addLayout(top)
        layout.addWidget(self.parts, 1)
        layout.addLayout(buttons)
        # For all rows together: after an order of the entries alone, Tab would lead from the last entry to the first.
        set_tab_order(layout)
        return contents


class PanelSplitter(QSplitter):
    """Entries above; below, figures and captures at their natural height until the user moves the border.

    The position of a moved border is kept in later sessions; a double click resets it.
    """

    def __init__(self, above: QWidget, below: QWidget) -> None:
        super().__init__(Qt.Orientation.Vertical)
        self.setObjectName("parts")
        self.setChildrenCollapsible(False)
        self._below = below
        for part in (above, below):
            self.addWidget(part)
        self.setStretchFactor(0, 1)
        self.setStretchFactor(1, 0)
        self._share = QgsSettings().value(_SHARE_KEY, 0.0, type=float)
        self.splitterMoved.connect(self._moved)
        handle = self.handle(1)
        handle.setToolTip(tr("Drag to give the entries or the estimates more room; double-click to reset"))
        handle.installEventFilter(self)
        below.installEventFilter(self)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Keep the relative position of the border."""
        super().resizeEvent(event)
        self.fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Adapt to a new height of the lower part; reset the border on a double click."""
        if event.type() == QEvent.Type.MouseButtonDblClick:
            self._keep(0.0)
        elif event.type() == QEvent.Type.LayoutRequest and watched is self._below:
            self.fit()
        return super().eventFilter(watched, event)

    def fit(self) -> None:
        """Give the lower part its natural height, or the share chosen by the user."""
        room = self.height() - self.handleWidth()
        if room <= 0:
            return
        layout = self._below.layout()
        wanted = layout.totalSizeHint().height()
        if layout.hasHeightForWidth():
            wanted = layout.totalHeightForWidth(self.width())
        # Until the user moves the border, figures and captures take at most half of the panel.
        most = round(room * (self._share or 0.5))
        below = most if self._share else min(wanted, most)
        self.setSizes([room - below, below])

    def _moved(self) -> None:
        above, below = self.sizes()
        self._keep(below / max(above + below, 1))

    def _keep(self, share: float) -> None:
        self._share = share
        QgsSettings().setValue(_SHARE_KEY, share)
        self.fit()


class FormScroll(QScrollArea):
    """A scroll area that is never narrower than its contents, even if they become wider."""

    def __init__(self, contents: QWidget) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setWidget(contents)
        contents.installEventFilter(self)
        # QGIS's groups scroll into view when they are unfolded, but unfortunately also when first shown.
        self._groups = contents.findChildren(QgsCollapsibleGroupBoxBasic)
        self._let_groups_scroll(False)
        self._fit()

    def showEvent(self, event: QShowEvent) -> None:
        """Start at the top, and let groups scroll into view from then on."""
        super().showEvent(event)
        QTimer.singleShot(0, self._shown)

    def _shown(self) -> None:
        self._let_groups_scroll(True)

    def _let_groups_scroll(self, scroll: bool) -> None:
        for group in self._groups:
            group.setScrollOnExpand(scroll)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Fit the width to the contents."""
        if event.type() == QEvent.Type.LayoutRequest and watched is self.widget():
            self._fit()
        return super().eventFilter(watched, event)

    def sizeHint(self) -> QSize:
        """Return the preferred width of the entries."""
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        return QSize(self.widget().sizeHint().width() + bar, super().sizeHint().height())

    def _fit(self) -> None:
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.setMinimumWidth(self.widget().minimumSizeHint().width() + bar)
