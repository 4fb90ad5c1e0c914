"""The source that is entered, shown as background around the area."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import QObject

from ...core.errors import TerrAInavError
from ...core.mission.area import Box
from ..form import mission_form
from ..i18n import told
from ..qgis_source.snapshot import is_of_qgis
from ..sources import WORLD
from .background import Background, WorldTask

if TYPE_CHECKING:
    from ..dock.dock import Dock
    from ..messages import Messages
    from ..settings import Settings

#: Where a first look at the embedded world goes while nothing says where: the fields of the published dataset.
_FIRST_PLACE = Box(35.16, -89.90, 35.115, -89.823)


class SourceOnMap(QObject):
    """Shows sources as background; the embedded world is drawn first, on a thread of the task manager."""

    def __init__(self, background: Background, dock: Dock, messages: Messages, settings: Settings) -> None:
        super().__init__()
        self._background, self._form = background, dock.form
        self._messages, self._settings = messages, settings
        self._task: WorldTask | None = None

    def show(self, then: Callable[[], None] | None = None) -> None:
        """Show what is entered, and zoom to the area; ``then`` is called once it is there."""
        from ...core.imagery.opening import is_file

        state = self._form.state()
        area, seen = mission_form.box(state), self._background.looked_at()
        map_type = state.map_types[0] if state.map_types else "satellite"
        try:
            stay = area is None and seen is not None
            if state.source == WORLD:
                self._show_world(area or seen or _FIRST_PLACE, map_type, state.seed, stay, then)
                return
            title = self._form.imagery.title()
            if is_file(state.source):
                self._background.show_file(state.source, title)
            elif not is_of_qgis(state.source):
                self._background.show_tiles(state.source_name, map_type, title, state.date)
            if not stay:
                self._background.zoom_to(area)
            if then is not None:
                then()
        except TerrAInavError as wrong:
            self._messages.warning(told(wrong))

    def close(self) -> None:
        """End for good."""
        if self._task is not None:
            self._task.ended.disconnect()
            self._task.cancel()
            self._task = None

    def _show_world(
        self, box: Box, map_type: str, seed: int, stay: bool, then: Callable[[], None] | None
    ) -> None:
        """Draw and show the embedded world around a box, and zoom there unless the map is to stay where it is."""
        if self._task is not None:
            return
        folder = self._settings.backgrounds
        task = self._background.world_task(box, map_type, seed, folder)
        title = self._form.imagery.title()

        def show(task: WorldTask | None) -> None:
            self._task = None
            self._form.show_on_map.setEnabled(True)
            if task is not None and task.error:
                self._messages.error(told(task.error), task.trace)
            elif task is None or not task.isCanceled():
                try:
                    self._background.show_world(box, map_type, seed, folder, title)
                    if not stay:
                        self._background.zoom_to(box)
                    if then is not None:
                        then()
                except TerrAInavError as wrong:
                    self._messages.warning(told(wrong))

        if task is None:
            show(None)
            return
        self._task = task
        self._form.show_on_map.setEnabled(False)
        task.ended.connect(show)
        QgsApplication.taskManager().addTask(task)
