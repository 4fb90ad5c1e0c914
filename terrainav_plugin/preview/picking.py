"""Rows to skip, and images after which the flight is split, picked by clicks on the planned images."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from qgis.core import QgsGeometry, QgsPointXY
from qgis.gui import QgsMapCanvas, QgsMapMouseEvent, QgsRubberBand
from qgis.PyQt.QtCore import QObject, Qt, pyqtSignal
from qgis.PyQt.QtGui import QColor

from ...core.geodesy.mercator import wrap_lon_deg
from ...core.mission.outlines import cut_at_antimeridian
from ...core.text.ranges import count, read_ranges, toggled
from ..compat import POLYGON
from ..form.state import FormState
from ..i18n import tr
from ..map.canvas import LON_LAT, ClickTool
from ..tasks import crs_named

if TYPE_CHECKING:
    from ...core.mission.plan import Plan
    from ..messages import Messages
    from ..planner import PlannedMission

#: Most skipped images that are marked on the map, so that a click is answered at once.
MOST_MARKED = 5000


class ImageTool(ClickTool):
    """Emit the places of clicks until another tool is chosen; ``extends`` says whether Shift was held."""

    extends = False

    def canvasReleaseEvent(self, event: QgsMapMouseEvent) -> None:
        """Emit the place clicked."""
        self.extends = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        super().canvasReleaseEvent(event)


class PlanPicking(QObject):
    """Turn clicks on planned images into entries, and mark the images of skipped rows.

    Parameters
    ----------
    canvas : QgsMapCanvas
    messages : Messages
    read : callable
        Returns the state of the form.
    is_current : callable
        Whether the rows of a plan are those of the entered mission.

    Signals
    -------
    entered(str, str, str)
        An entry, its new text, and the name of the step.

    Attributes
    ----------
    rows_tool, split_tool : ImageTool
    marked : int
        Number of images that are marked as skipped.
    """

    entered = pyqtSignal(str, str, str)

    def __init__(
        self,
        canvas: QgsMapCanvas,
        messages: Messages,
        read: Callable[[], FormState],
        is_current: Callable[[PlannedMission], bool],
    ) -> None:
        super().__init__()
        self._canvas, self._messages, self._read, self._is_current = canvas, messages, read, is_current
        self.rows_tool, self.split_tool = ImageTool(canvas), ImageTool(canvas)
        self._planned: PlannedMission | None = None
        self._last_row: int | None = None
        self._is_visible = False
        self.marked = 0
        self._mark: QgsRubberBand | None = None
        for tool, take in ((self.rows_tool, self._take_row), (self.split_tool, self._take_split)):
            tool.clicked.connect(take)
            tool.refused.connect(messages.warning)
        canvas.destinationCrsChanged.connect(self._draw)

    def close(self) -> None:
        """Stop for good."""
        self._canvas.destinationCrsChanged.disconnect(self._draw)
        self._planned = None
        self._draw()
        for tool in (self.rows_tool, self.split_tool):
            tool.stop()
            tool.deleteLater()

    def pick_rows(self) -> None:
        """Let the user click rows."""
        self._last_row = None
        self.rows_tool.start()
        self._messages.info(
            tr(
                "Click a row of the preview to skip it, and again to bring it back; Shift-click takes all rows up to "
                "it."
            )
        )

    def pick_splits(self) -> None:
        """Let the user click images after which the flight is split."""
        if not self._read().takeoff.strip():
            # A click that is meant to split must not skip a row.
            self.rows_tool.stop()
            self._messages.info(tr("A split needs a take-off point, where each sortie begins and ends."))
            return
        self.split_tool.start()
        self._messages.info(tr("Click the last image of a sortie; click it again to go on without landing."))

    def show(self, planned: PlannedMission) -> None:
        """Take the latest plan, and mark its skipped images."""
        self._planned = planned
        self._draw()

    def show_previewed(self, visible: bool) -> None:
        """Show the marks with the preview only."""
        self._is_visible = visible
        self._draw()

    # --- clicks

    def _take_row(self, lat_deg: float, lon_deg: float) -> None:
        planned = self._current_plan()
        if planned is None:
            return
        plan = planned.whole or planned.plan
        at = find_image(plan, lat_deg, lon_deg)
        if at is None or not planned.mission.area.covers_ground:
            self._messages.info(tr("There is no row of planned images."))
            return
        row, last = int(plan.row[at]), self._last_row
        rows = [row]
        if self.rows_tool.extends and last is not None:
            rows = [*range(min(row, last), max(row, last) + 1)]
        self._last_row = row
        held = self._read().skip_rows
        text = toggled(held, rows)
        is_added = count(read_ranges(text)) > count(read_ranges(held))
        step = tr("skip rows") if is_added else tr("bring rows back")
        self.entered.emit("skip_rows", text, step)

    def _take_split(self, lat_deg: float, lon_deg: float) -> None:
        planned = self._current_plan()
        if planned is None:
            return
        at = find_image(planned.plan, lat_deg, lon_deg)
        if at is None or at == len(planned.plan) - 1:
            self._messages.info(tr("There is no planned image, or the flight ends with it."))
            return
        self.entered.emit("split_after", toggled(self._read().split_after, [at + 1]), tr("split the flight"))

    def _current_plan(self) -> PlannedMission | None:
        """The latest plan, if its rows are those of the entered mission, and its numbers can be read."""
        planned = self._planned
        try:
            read_ranges(self._read().skip_rows)
            read_ranges(self._read().split_after)
        except ValueError:
            # The entry is marked.
            return None
        if planned is None or not self._is_current(planned):
            self._messages.info(tr("The plan is still being worked out."))
            return None
        return planned

    # --- marks

    def _draw(self) -> None:
        if self._mark is not None:
            self._canvas.scene().removeItem(self._mark)
            self._mark = None
        self.marked = 0
        whole = None if self._planned is None else self._planned.whole
        if whole is None or not self._is_visible:
            return
        skipped = np.zeros(len(whole), bool)
        for first, last in read_ranges(self._planned.mission.flight.skip_rows):
            skipped |= (whole.row >= first) & (whole.row <= last)
        corners = whole.corners
        which = np.flatnonzero(skipped & corners.hit.all(axis=1))[:MOST_MARKED]
        rings = [
            [[QgsPointXY(*place) for place in zip(lon.tolist(), lat.tolist())]]
            for corner_lon, corner_lat in zip(corners.lon_deg[which], corners.lat_deg[which])
            for lon, lat in cut_at_antimeridian(corner_lon, corner_lat)
        ]
        self.marked = len(which)
        mark = self._mark = QgsRubberBand(self._canvas, POLYGON)
        mark.setStrokeColor(QColor(120, 120, 120, 220))
        mark.setFillColor(QColor(90, 90, 90, 60))
        mark.setBrushStyle(Qt.BrushStyle.BDiagPattern)
        mark.setLineStyle(Qt.PenStyle.DashLine)
        mark.setWidth(1)
        mark.setToGeometry(QgsGeometry.fromMultiPolygonXY(rings), crs_named(LON_LAT))


def find_image(plan: Plan, lat_deg: float, lon_deg: float) -> int | None:
    """Index of the image that shows a place nearest to its middle; None if none shows it."""
    lat, lon, hit = plan.corners
    lon = lon_deg + wrap_lon_deg(lon - lon_deg)
    away = np.hypot(lat.mean(axis=1) - lat_deg, (lon.mean(axis=1) - lon_deg) * np.cos(np.radians(lat_deg)))
    inside = hit.all(axis=1) & (lat.min(axis=1) <= lat_deg) & (lat.max(axis=1) >= lat_deg)
    inside &= (lon.min(axis=1) <= lon_deg) & (lon.max(axis=1) >= lon_deg)
    if not inside.any():
        return None
    return int(np.argmin(np.where(inside, away, np.inf)))
