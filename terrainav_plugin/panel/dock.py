"""The mission panel: entries, figures, buttons and captures."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from qgis.core import QgsApplication
from qgis.gui import QgsDockWidget
from qgis.PyQt.QtCore import QEvent, QSignalBlocker, QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QIcon, QResizeEvent
from qgis.PyQt.QtWidgets import QFrame, QHBoxLayout, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from ..help import show_help
from ..i18n import tr
from ..paths import icon
from ..plain import shown_plain
from ..widgets import push_button, tool_button, wrapped_label
from .choices import CameraChoice, SourceChoice
from .figures import Figures, Link
from .form import DockForm
from .keyboard import Letters, next_widget, widget_outside
from .runs import RunList

#: Least width of the panel, in letters.
_WIDTH_LETTERS = 62


class Dock(QgsDockWidget):
    """The panel; it only displays, and emits the user's requests.

    Signals
    -------
    preview_toggled(bool), test_shot_clicked(), capture_clicked(), export_plan_clicked()
    reading_cancelled(), reading_wanted()
        The user no longer wants to wait until files are read, or wants them to be read again.
    hint_followed(str)
        The user has clicked a link in the hint, to this address.
    """

    preview_toggled = pyqtSignal(bool)
    test_shot_clicked = pyqtSignal()
    capture_clicked = pyqtSignal()
    export_plan_clicked = pyqtSignal()
    reading_cancelled = pyqtSignal()
    reading_wanted = pyqtSignal()
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
        self.figures.link_followed.connect(self._follow_link)
        self.estimates, self.problem = self.figures.estimates, self.figures.problem
        self.run_list = RunList()
        self._make_buttons()
        self.letters: Letters | None = None
        #: Name of the dataset that is being opened; empty for none.
        self.opening = ""
        self.setWidget(self._contents())

    def assign_letters(self, menu_keys: set[str]) -> None:
        """Give buttons and entries letters; those of the window's menus only while the keyboard is in the panel."""
        self.letters = Letters(self.widget(), self.form.pages, self.form.sections, menu_keys)
        self.visibilityChanged.connect(self.letters.hear)

    def event(self, event: QEvent) -> bool:
        """Take Alt with a letter of the panel before the window's menus."""
        if event.type() == QEvent.Type.ShortcutOverride and self.letters is not None and self.letters.override(event):
            event.accept()
            return True
        return super().event(event)

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Move the keyboard in reading order, and out of the panel at its end."""
        widget = next_widget(self.widget(), forward) or widget_outside(self, forward)
        if widget is None:
            return super().focusNextPrevChild(forward)
        reason = Qt.FocusReason.TabFocusReason if forward else Qt.FocusReason.BacktabFocusReason
        widget.setFocus(reason)
        self.form.pages.show_stop(widget)
        return True

    def show_hint(self, text: str) -> None:
        """Show a hint (HTML) on the first steps; an empty text hides it."""
        self.hint.setText(text)
        self.hint.setVisible(bool(text))

    def show_nothing(self) -> None:
        """Show that no area is entered."""
        text = tr("Opening {name}…").format(name=self.opening) if self.opening else tr("No area yet.")
        self.figures.show_text(text)

    def show_plannable(self, reason: str) -> None:
        """Enable the export of the plan, unless there is a reason why there is none."""
        self.export_plan.setEnabled(not reason)
        refusal = tr("Nothing to export yet: {reason}").format(reason=reason)
        self.export_plan.setToolTip(shown_plain(refusal) if reason else _export_tip())

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
        self.preview = _text_button("preview", tr("Preview"), tr("Show every planned image on the map"))
        self.preview.setCheckable(True)
        self.preview.toggled.connect(self.preview_toggled)
        tip = tr("Click a point on the map and capture one image there")
        self.test_shot = _text_button("test_shot", tr("Test shot"), tip)
        self.test_shot.clicked.connect(self.test_shot_clicked)
        self.capture = push_button(
            "capture",
            tr("Capture"),
            tr("Capture all images; resumes where an earlier run stopped"),
            icon("capture"),
        )
        self.capture.clicked.connect(self.capture_clicked)
        self.export_plan = _text_button("export_plan", tr("Export plan…"), _export_tip())
        self.export_plan.clicked.connect(lambda _checked: self.export_plan_clicked.emit())
        of_qgis = QgsApplication.getThemeIcon
        tip = tr("Open, save and start missions: of this project, from files or from datasets")
        self.missions = tool_button("missions", of_qgis("/mActionFileOpen.svg"), tip, tr("Missions"))
        self.missions.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.missions.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.help = tool_button("help", of_qgis("/mActionHelpContents.svg"), tr("Open the guide"))
        self.help.setText(tr("Help"))
        self.help.clicked.connect(lambda _checked: show_help())

    def _contents(self) -> QWidget:
        top = QHBoxLayout()
        top.addWidget(self.missions)
        top.addWidget(self.form.presets, 1)
        top.addWidget(self.help)
        buttons = QHBoxLayout()
        buttons.setSpacing(4)
        for button in (self.preview, self.test_shot):
            buttons.addWidget(button)
        buttons.addWidget(self.capture, 1)
        buttons.addWidget(self.export_plan)
        contents = Contents(self._share_room)
        contents.setStyleSheet(self.form.styleSheet())
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 2, 4, 4)
        layout.setSpacing(4)
        layout.addLayout(top)
        layout.addWidget(self.hint)
        layout.addWidget(self.form, 1)
        layout.addWidget(self.figures)
        layout.addWidget(self.run_list)
        layout.addLayout(buttons)
        return contents

    def _share_room(self, height_px: int) -> None:
        for part in (self.figures, self.run_list):
            part.set_room(height_px)

    def _follow_link(self, link: str) -> None:
        form = self.form
        acts = {
            Link.WRONG: form.show_first_wrong,
            Link.HIGHER: form.fly_higher,
            Link.UPSAMPLE: form.allow_upsampling,
            Link.SOURCE: lambda: form.pages.show_field(form.source),
            Link.CANCEL: self.reading_cancelled.emit,
            Link.READ: self.reading_wanted.emit,
        }
        acts[link]()


class Contents(QWidget):
    """Contents of the panel.

    Parameters
    ----------
    resized : callable
        Called with each new height.
    """

    def __init__(self, resized: Callable[[int], None]) -> None:
        super().__init__()
        self._resized = resized

    def minimumSizeHint(self) -> QSize:
        """Return a width at which labels and entries are side by side."""
        hint = super().minimumSizeHint()
        return QSize(max(hint.width(), _WIDTH_LETTERS * self.fontMetrics().averageCharWidth()), hint.height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Share the room anew."""
        super().resizeEvent(event)
        self._resized(event.size().height())


def _export_tip() -> str:
    return tr("Write the plan as a file for drones, ground stations and other programs")


def _text_button(name: str, text: str, tip: str) -> QToolButton:
    """Button as narrow as its text."""
    made = tool_button(name, QIcon(), tip, text)
    made.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextOnly)
    made.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Preferred)
    made.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
    return made
