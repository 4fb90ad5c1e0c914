"""The figures of a plan: what matters first, the rest behind a fold; they are scrolled where a screen is small."""

from __future__ import annotations

import html

from qgis.core import QgsSettings
from qgis.PyQt.QtCore import QSize, Qt, pyqtSignal
from qgis.PyQt.QtGui import QResizeEvent
from qgis.PyQt.QtWidgets import QFrame, QLabel, QScrollArea, QSizePolicy, QToolButton, QVBoxLayout, QWidget

from ..i18n import tr
from .estimates import Readout

#: Lines of text that are always to be seen.
_LEAST_LINES = 6
_FOLDED_KEY = "TerrAInav/folded/details"
_ENLARGE = "enlarge"


class Figures(QScrollArea):
    """Labels below each other, as high as their text where there is room for it.

    Signals
    -------
    enlarging_wanted()
        Pictures are to have enlarged pixels.

    Attributes
    ----------
    warnings, estimates, details, problem : QLabel
    fold : QToolButton
        Shows and hides the details.
    """

    enlarging_wanted = pyqtSignal()

    def __init__(self) -> None:
        super().__init__()
        self.problem, self.warnings = _label("problem"), _label("warnings")
        self.estimates, self.details = _label("estimates"), _label("details")
        for label in (self.problem, self.warnings):
            label.setProperty("terrainavMark", "true")
        self.problem.setTextFormat(Qt.TextFormat.PlainText)
        self.warnings.linkActivated.connect(self.enlarging_wanted)
        self.fold = QToolButton()
        self.fold.setObjectName("fold_details")
        self.fold.setText(tr("Details"))
        self.fold.setToolTip(tr("Picture size, methods with their error bounds, and what is left out"))
        self.fold.setCheckable(True)
        self.fold.setAutoRaise(True)
        self.fold.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.fold.toggled.connect(self._fold)
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        for part in (self.problem, self.warnings, self.estimates, self.fold, self.details):
            layout.addWidget(part)
        self.setWidget(contents)
        self.setWidgetResizable(True)
        for background in (contents, self.viewport()):
            background.setAutoFillBackground(False)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.fold.setChecked(not QgsSettings().value(_FOLDED_KEY, True, type=bool))
        self._fold(self.fold.isChecked())
        self.show_text("")

    def show_readout(self, readout: Readout) -> None:
        """Show the figures of a plan."""
        warnings = [html.escape(text) for text in readout.warnings]
        if readout.offers_enlarging:
            offer = tr("The source has no finer pixels of its own here.")
            link = tr("Allow enlarged pixels")
            warnings.append(f'{html.escape(offer)} <a href="{_ENLARGE}">{html.escape(link)}</a>')
        self._show(
            warnings="<br>".join(warnings), estimates=readout.figures_html(), details=readout.details_html()
        )
        self.details.setToolTip(readout.why)

    def show_text(self, text: str) -> None:
        """Show a text in place of figures."""
        self._show(estimates=html.escape(text))

    def show_problem(self, text: str) -> None:
        """Show why there are no figures; an empty text where fields say so themselves."""
        self._show(problem=text, warnings="" if text else tr("Put right what is marked above."))

    def sizeHint(self) -> QSize:
        """All of the text at this width."""
        return QSize(super().sizeHint().width(), self._text_height())

    def minimumSizeHint(self) -> QSize:
        """Some lines, or all of the text where it has fewer."""
        least = _LEAST_LINES * self.fontMetrics().lineSpacing()
        return QSize(super().minimumSizeHint().width(), min(least, self._text_height()))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Ask for another height where the text breaks otherwise."""
        super().resizeEvent(event)
        if event.oldSize().width() != event.size().width():
            self.updateGeometry()

    def _show(self, problem: str = "", warnings: str = "", estimates: str = "", details: str = "") -> None:
        for label, text in (
            (self.problem, problem),
            (self.warnings, warnings),
            (self.estimates, estimates),
            (self.details, details),
        ):
            label.setText(text)
            label.setVisible(bool(text))
        self.fold.setVisible(bool(details))
        self.details.setVisible(bool(details) and self.fold.isChecked())
        self.updateGeometry()

    def _fold(self, shown: bool) -> None:
        self.fold.setArrowType(Qt.ArrowType.DownArrow if shown else Qt.ArrowType.RightArrow)
        self.details.setVisible(shown and bool(self.details.text()))
        QgsSettings().setValue(_FOLDED_KEY, not shown)
        self.updateGeometry()

    def _text_height(self) -> int:
        layout = self.widget().layout()
        return layout.totalHeightForWidth(max(self.viewport().width(), layout.minimumSize().width()))


def _label(name: str) -> QLabel:
    label = QLabel()
    label.setObjectName(name)
    label.setWordWrap(True)
    label.setTextFormat(Qt.TextFormat.RichText)
    label.setTextInteractionFlags(
        Qt.TextInteractionFlag.TextSelectableByMouse
        | Qt.TextInteractionFlag.LinksAccessibleByMouse
        | Qt.TextInteractionFlag.LinksAccessibleByKeyboard
    )
    return label
