"""Tabs of the panel's entries; each page scrolls on its own."""

from __future__ import annotations

from collections.abc import Sequence

from qgis.core import QgsApplication, QgsSettings
from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QEvent, QObject, QSignalBlocker, QSize, Qt, QTimer
from qgis.PyQt.QtGui import QColor, QIcon, QShowEvent
from qgis.PyQt.QtWidgets import QFrame, QScrollArea, QStyle, QTabWidget, QVBoxLayout, QWidget

from ..tasks import single_shot
from ..widgets import WRONG_COLOUR

_KEY = "TerrAInav/tab"


class Pages(QTabWidget):
    """Tabs of groups of entries; the tab chosen last is shown again in the next session.

    Parameters
    ----------
    pages : sequence of (title, tip, boxes)
    """

    def __init__(self, pages: Sequence[tuple[str, str, Sequence[QWidget]]]) -> None:
        super().__init__()
        self.setObjectName("pages")
        self.setDocumentMode(True)
        self.tabBar().setExpanding(True)
        # Without scroll buttons, as every tab is to be seen.
        self.setUsesScrollButtons(False)
        self.setElideMode(Qt.TextElideMode.ElideNone)
        self.setIconSize(QSize(12, 12))
        for number, (title, tip, boxes) in enumerate(pages):
            contents = QWidget()
            layout = QVBoxLayout(contents)
            layout.setContentsMargins(2, 2, 2, 2)
            layout.setSpacing(2)
            for box in boxes:
                layout.addWidget(box)
            layout.addStretch(1)
            self.addTab(FormScroll(contents), title)
            self.setTabToolTip(number, tip)
        self._wanted: QWidget = self
        self._soon = single_shot(lambda: self.show_stop(self._wanted), self, 0)
        self.setCurrentIndex(QgsSettings().value(_KEY, 0, type=int))
        self.currentChanged.connect(lambda number: QgsSettings().setValue(_KEY, number))

    def page_of(self, widget: QWidget) -> FormScroll:
        """Page that holds a widget."""
        return next(page for page in self.pages() if page.isAncestorOf(widget))

    def pages(self) -> list[FormScroll]:
        """Pages from the first tab to the last."""
        return [self.widget(number) for number in range(self.count())]

    def show_field(self, widget: QWidget) -> None:
        """Show an entry: its tab, its group unfolded, scrolled into view and with the keyboard."""
        page = self.page_of(widget)
        self.setCurrentWidget(page)
        around = widget.parentWidget()
        while around is not None and around is not page:
            if isinstance(around, QgsCollapsibleGroupBoxBasic) and around.isCollapsed():
                around.setCollapsed(False)
            around = around.parentWidget()
        widget.setFocus(Qt.FocusReason.OtherFocusReason)
        # Groups that have just been unfolded are laid out later.
        self._wanted = widget
        self._soon.start()

    def show_stop(self, widget: QWidget) -> None:
        """Scroll to a widget."""
        for page in self.pages():
            if page.isAncestorOf(widget):
                page.ensureWidgetVisible(widget)

    def mark(self, wrong: Sequence[QWidget]) -> None:
        """Mark the tabs that hold a field with an invalid value."""
        warning = QgsApplication.getThemeIcon("/mIconWarning.svg")
        for number, page in enumerate(self.pages()):
            is_wrong = any(page.isAncestorOf(widget) for widget in wrong)
            # An invalid colour stands for the theme's.
            self.tabBar().setTabTextColor(number, QColor(WRONG_COLOUR) if is_wrong else QColor())
            # Dark themes of QGIS have colours of their own for tabs.
            self.setTabIcon(number, warning if is_wrong else QIcon())

    def minimumSizeHint(self) -> QSize:
        """All tabs, the widest page, and a few lines of the page."""
        bar = self.tabBar().sizeHint()
        width = max((bar.width(), *(page.minimumWidth() for page in self.pages())))
        return QSize(width, bar.height() + 3 * self.fontMetrics().lineSpacing())


class FormScroll(QScrollArea):
    """A scroll area that is never narrower than its contents, even if they become wider."""

    def __init__(self, contents: QWidget) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
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
        self._apply_folds()
        QTimer.singleShot(0, self._shown)

    def _shown(self) -> None:
        self._let_groups_scroll(True)

    def _apply_folds(self) -> None:
        """Fold and unfold groups whose state was set while the page was not seen, which QGIS only notes."""
        for group in self._groups:
            folded, contents = group.isCollapsed(), group.layout().itemAt(0).widget()
            if contents.isVisibleTo(group) == folded:
                with QSignalBlocker(group):
                    group.setCollapsed(not folded)
                    group.setCollapsed(folded)

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
