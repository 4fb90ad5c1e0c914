"""Keep the height profile of the entered mission up to date, and show its places on the map."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import Qgis, QgsCoordinateReferenceSystem, QgsCsException, QgsGeometry, QgsPointXY, QgsProject
from qgis.gui import QgisInterface, QgsVertexMarker
from qgis.PyQt.QtCore import QBuffer, QObject, Qt
from qgis.PyQt.QtWidgets import QDockWidget, QFileDialog

from ...core.errors import TerrAInavError
from ...core.waiting import cancellable
from ..i18n import tr, translate
from ..map.canvas import LON_LAT, to_lon_lat, wrap_longitude
from ..settings import Settings
from ..tasks import LatestWorker, failure_reason
from ..widgets import remove_menu_mnemonics
from .chart import CLEARANCE
from .dock import ProfileDock

if TYPE_CHECKING:
    from ...core.mission.plan import Plan
    from ...core.mission.profile import HeightProfile
    from ..messages import Messages

#: Height at which the panel opens.
_HEIGHT_PX = 190


class Profiles(QObject):
    """The panel with the height profile, its profile, and the mark of the cursor's place on the map.

    Profiles are worked out off the main thread, and only while the panel is seen.

    Parameters
    ----------
    unit : callable
        Returns the unit of heights, m or ft.
    """

    def __init__(self, iface: QgisInterface, messages: Messages, unit: Callable[[], str]) -> None:
        super().__init__()
        self._iface, self._messages, self._unit = iface, messages, unit
        self._canvas = iface.mapCanvas()
        self.dock: ProfileDock | None = None
        self._plan: Plan | None = None
        self._reason = tr("No area yet.")
        self._is_shown = False
        self._mark: QgsVertexMarker | None = None
        self._worker = LatestWorker("profile")
        self._worker.failed.connect(self._refused)

    @property
    def busy(self) -> bool:
        """Whether a profile is being worked out."""
        return self._worker.busy

    def open(self) -> None:
        """Show the panel below the map."""
        if self.dock is None:
            self.dock = ProfileDock()
            self.dock.chart.pointed.connect(self._show_mark)
            self.dock.chart.chosen.connect(self._show_place)
            self.dock.save_wanted.connect(self._ask_file)
            self.dock.visibilityChanged.connect(self._visibility_changed)
            self._add(self.dock)
        self.dock.setUserVisible(True)
        self.dock.chart.setFocus(Qt.FocusReason.OtherFocusReason)
        self._work()

    def close(self) -> None:
        """Remove the panel and the mark for good."""
        self._worker.close()
        self._remove_mark()
        if self.dock is not None:
            self._iface.removeDockWidget(self.dock)
            self.dock.deleteLater()
            self.dock = None

    def show_plan(self, plan: Plan) -> None:
        """Show the profile of a plan."""
        self._plan, self._reason, self._is_shown = plan, "", False
        self._work()

    def show_reason(self, text: str) -> None:
        """Show why there is no plan; an empty text means that one is being worked out."""
        self._worker.forget()
        self._plan, self._reason, self._is_shown = None, text, False
        self._remove_mark()
        self._work()

    def _add(self, dock: ProfileDock) -> None:
        """Add the panel below the map, as a tab next to another panel there."""
        window, area = self._iface.mainWindow(), Qt.DockWidgetArea.BottomDockWidgetArea
        remove_menu_mnemonics(dock, window.menuBar())
        others = [
            one
            for one in window.findChildren(QDockWidget)
            if window.dockWidgetArea(one) == area and one.isVisible() and not one.isFloating()
        ]
        self._iface.addDockWidget(area, dock)
        if others:
            window.tabifyDockWidget(others[0], dock)
        else:
            window.resizeDocks([dock], [_HEIGHT_PX], Qt.Orientation.Vertical)

    def _visibility_changed(self, visible: bool) -> None:
        if visible:
            self._work()
        else:
            self._remove_mark()

    def _work(self) -> None:
        """Work out the profile if it is seen and not up to date."""
        dock = self.dock
        if dock is None or not dock.isUserVisible() or self._is_shown:
            return
        if self._reason:
            dock.show_text(self._reason)
            return
        dock.show_working()
        plan = self._plan
        if plan is not None:
            self._worker.ask(partial(_profile, plan), self._show)

    def _show(self, profile: HeightProfile) -> None:
        self._is_shown = True
        if self.dock is not None:
            self.dock.show_profile(profile, self._unit())

    def _refused(self, error: Exception) -> None:
        if self.dock is not None:
            self.dock.show_text(translate(failure_reason(error)))

    # --- files

    def _ask_file(self) -> None:
        """Let the user choose a file for the profile."""
        kinds = (tr("Table (*.csv)"), tr("Image (*.png)"))
        window = self._iface.mainWindow()
        title = tr("TerrAInav: save height profile")
        usual = str(Settings().missions / "height-profile.csv")
        chosen, kind = QFileDialog.getSaveFileName(window, title, usual, ";;".join(kinds))
        if chosen:
            path = Path(chosen)
            self.save(path if path.suffix else path.with_suffix(".png" if kind == kinds[1] else ".csv"))

    def save(self, path: Path) -> None:
        """Save the shown profile as a table, or as an image if the file's ending is .png."""
        from ...core.report.heights import profile_table
        from ...core.storage.files import write_whole

        dock = self.dock
        if dock is None or dock.chart.profile is None:
            return
        if path.suffix.lower() == ".png":
            buffer = QBuffer()
            dock.widget().grab().save(buffer, "PNG")
            data = [bytes(buffer.data())]
        else:
            data = [line.encode() for line in profile_table(dock.chart.profile)]
        try:
            write_whole(path, data)
        except TerrAInavError as wrong:
            self._messages.warning(translate(wrong))
            return
        self._messages.success(tr("Height profile saved as {name}.").format(name=path.name))

    # --- places on the map

    def _place(self, at: int) -> tuple[QgsPointXY, QgsPointXY] | None:
        """Place of a point in degrees, and in the map's CRS; None if the map cannot show it."""
        profile = None if self.dock is None else self.dock.chart.profile
        if profile is None or not 0 <= at < len(profile):
            return None
        degrees = QgsPointXY(wrap_longitude(float(profile.lon_deg[at])), float(profile.lat_deg[at]))
        transform = to_lon_lat(self._canvas.mapSettings().destinationCrs(), QgsProject.instance())
        try:
            return degrees, transform.transform(degrees, Qgis.TransformDirection.Reverse)
        except QgsCsException:
            return None

    def _show_mark(self, at: int) -> None:
        """Mark the place of the cursor on the map; -1 removes the mark."""
        place = self._place(at)
        if place is None:
            self._remove_mark()
            return
        if self._mark is None:
            self._mark = QgsVertexMarker(self._canvas)
            self._mark.setIconType(QgsVertexMarker.IconType.ICON_CIRCLE)
            self._mark.setColor(CLEARANCE)
            self._mark.setIconSize(14)
            self._mark.setPenWidth(3)
        self._mark.setCenter(place[1])

    def _show_place(self, at: int) -> None:
        """Move the map to a place, and let the place flash."""
        place = self._place(at)
        if place is None:
            self._messages.warning(tr("This place cannot be shown in the map's CRS."))
            return
        degrees, there = place
        self._canvas.setCenter(there)
        self._canvas.refresh()
        self._canvas.flashGeometries([QgsGeometry.fromPointXY(degrees)], QgsCoordinateReferenceSystem(LON_LAT))

    def _remove_mark(self) -> None:
        if self._mark is not None:
            self._canvas.scene().removeItem(self._mark)
            self._mark = None


def _profile(plan: Plan, overtaken: Callable[[], bool]) -> HeightProfile:
    """Height profile of a plan, given up once overtaken. Runs on the worker's thread."""
    from ...core.mission.profile import height_profile

    with cancellable(overtaken):
        return height_profile(plan)
