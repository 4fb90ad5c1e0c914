"""The panel with the height profile: a line of figures, and the diagram."""

from __future__ import annotations

import html

from qgis.gui import QgsDockWidget
from qgis.PyQt.QtCore import Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor, QResizeEvent
from qgis.PyQt.QtWidgets import QLabel, QMenu, QSizePolicy, QVBoxLayout, QWidget

from ...core.mission.flight.path import CAPTURE, LANDING, TAKEOFF
from ...core.mission.profile import HeightProfile
from ...core.units import M_PER_FT
from ..i18n import number_text, tr
from ..units import FEET, length_text
from ..widgets import named
from .chart import CLEARANCE, ProfileChart


class ProfileDock(QgsDockWidget):
    """The panel; it only displays, and its chart emits the user's requests.

    Signals
    -------
    save_wanted()
        The user wants to save the profile as a file.

    Attributes
    ----------
    line : QLabel
        Legend, with the figures at the cursor, or of the least clearance.
    chart : ProfileChart
    """

    save_wanted = pyqtSignal()

    def __init__(self) -> None:
        super().__init__(tr("TerrAInav: height profile"))
        self.setObjectName("terrainav_profile")
        self.line = named(_Legend(), "profile_line")
        self.line.setTextFormat(Qt.TextFormat.RichText)
        # Longer lines are wrapped, and do not widen the window.
        self.line.setWordWrap(True)
        self.line.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.chart = ProfileChart(self.line)
        self.chart.pointed.connect(lambda _at: self._show_line())
        self.chart.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
        self.chart.customContextMenuRequested.connect(lambda at: self.menu().popup(self.chart.mapToGlobal(at)))
        contents = QWidget()
        layout = QVBoxLayout(contents)
        layout.setContentsMargins(4, 2, 4, 2)
        layout.setSpacing(1)
        layout.addWidget(self.line)
        layout.addWidget(self.chart, 1)
        self.setWidget(contents)
        self.show_text("")

    def menu(self) -> QMenu:
        """Menu of the diagram, deleted when it closes."""
        menu = QMenu(self.chart)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        actions = (
            (tr("&Least clearance"), self.chart.show_lowest),
            (tr("&Whole flight"), self.chart.show_whole),
            (tr("&Save as table or image…"), self.save_wanted.emit),
        )
        for text, act in actions:
            action = menu.addAction(text)
            action.setEnabled(self.chart.profile is not None)
            action.triggered.connect(lambda _checked=False, act=act: act())
        return menu

    def show_profile(self, profile: HeightProfile, unit: str) -> None:
        """Show a profile in metres or feet."""
        self._set_working(False)
        self.chart.show_profile(profile, unit)
        self._show_line()

    def show_working(self) -> None:
        """Show that a profile is being worked out; an earlier one is greyed."""
        if self.chart.profile is None:
            self.show_text(tr("Working out the height profile…"))
            return
        self.chart.clear_cursor()
        self._set_working(True)

    def show_text(self, text: str) -> None:
        """Show a text instead of a profile."""
        self._set_working(False)
        self.chart.show_hint(text)
        self._show_line()

    def _set_working(self, working: bool) -> None:
        for part in (self.line, self.chart):
            part.setEnabled(not working)

    def _show_line(self) -> None:
        profile, chart = self.chart.profile, self.chart
        self.line.setVisible(profile is not None)
        if profile is None:
            self.line.clear()
            return
        parts = line_parts(profile, chart.at, chart.unit)
        flight, surface, ground = chart.colours()
        shown = {"flight": flight, "surface": surface, "ground": ground, "clearance": CLEARANCE}
        self.line.show_words(" &nbsp; ".join(_key(shown.get(key)) + _whole(text) for key, text in parts))
        chart.setAccessibleDescription(", ".join(text for _, text in parts))


class _Legend(QLabel):
    """A line that wraps, and keeps its height while its text changes, so that the diagram below it stays in place."""

    def show_words(self, text: str) -> None:
        """Show a text."""
        self.setText(text)
        if self.isVisible():
            self.setMinimumHeight(max(self.minimumHeight(), self.heightForWidth(self.width())))

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Begin anew with the height of the text at another width."""
        if event.size().width() != event.oldSize().width():
            # Without a text there is no height.
            self.setMinimumHeight(max(self.heightForWidth(event.size().width()), 0))
        super().resizeEvent(event)


def line_parts(profile: HeightProfile, at: int, unit: str) -> list[tuple[str, str]]:
    """Kind and text of the figures at a point of a profile, or of the legend if ``at`` is -1."""
    titles = {"flight": tr("Flight"), "surface": tr("Surface"), "ground": tr("Ground")}
    if not profile.has_surface:
        del titles["surface"]
    note = [("", tr("Level ground: the mission has no relief"))] if profile.is_level else []
    if at < 0:
        lowest = profile.lowest
        least = tr("Least clearance {height} at {distance}")
        found = []
        if lowest is not None:
            height = _height(float(profile.clearance_m[lowest]), unit)
            distance = _distance(float(profile.distance_m[lowest]), unit)
            found = [("clearance", least.format(height=height, distance=distance))]
        return [*titles.items(), *found, *note]
    heights = {"flight": profile.height_m, "surface": profile.surface_m, "ground": profile.ground_m}
    return [
        ("", _distance(float(profile.distance_m[at]), unit)),
        *((key, f"{title} {_height(float(heights[key][at]), unit)}") for key, title in titles.items()),
        ("clearance", tr("Clearance {height}").format(height=_height(float(profile.clearance_m[at]), unit))),
        *_place(profile, at),
    ]


def _place(profile: HeightProfile, at: int) -> list[tuple[str, str]]:
    """Text on the point of the flight, and the sortie if there are several."""
    kind, image = int(profile.kind[at]), int(profile.image[at])
    text = ""
    if kind in (TAKEOFF, LANDING):
        text = tr("take-off") if kind == TAKEOFF else tr("landing")
    elif image >= 0:
        text = tr("image {number}") if kind == CAPTURE else tr("after image {number}")
        text = text.format(number=number_text(image + 1))
    found = [("", text)] if text else []
    if profile.sortie[-1] > 0:
        found.append(("", tr("sortie {number}").format(number=int(profile.sortie[at]) + 1)))
    return found


def _height(value_m: float, unit: str) -> str:
    if value_m != value_m:
        return tr("unknown")
    return f"{number_text(value_m / (M_PER_FT if unit == FEET else 1.0), ',.1f')} {unit}"


def _distance(value_m: float, unit: str) -> str:
    return length_text(value_m, unit) if value_m >= 1.0 else f"0 {unit}"


def _whole(text: str) -> str:
    """Text that is not wrapped."""
    return f'<span style="white-space:nowrap">{html.escape(text)}</span>'


def _key(colour: QColor | None) -> str:
    """Coloured square of a legend."""
    return "" if colour is None else f'<span style="color:{colour.name()}">\N{BLACK SQUARE}</span>\N{NO-BREAK SPACE}'
