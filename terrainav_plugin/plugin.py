"""The plugin's entrance: toolbar and menu. Everything else is loaded when it is first used."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING

from qgis.core import QgsProject
from qgis.gui import QgisInterface
from qgis.PyQt.QtWidgets import QMenu

from .compat import QAction
from .i18n import tr
from .map.mission_group import saved_missions
from .messages import Messages
from .paths import icon

if TYPE_CHECKING:
    from .workflow import Workflow

MENU = "TerrAInav"
#: Packages the plugin needs beside QGIS.
_NEEDED = {"numpy": "numpy", "pyproj": "pyproj", "PIL": "Pillow", "requests": "requests"}


class TerrAInavPlugin:
    """What QGIS loads and unloads."""

    def __init__(self, iface: QgisInterface) -> None:
        self.iface = iface
        self.actions: dict[str, QAction] = {}
        self.messages: Messages | None = None
        self._toolbar = self._menu = None
        self._workflow: Workflow | None = None

    def initGui(self) -> None:
        """Add toolbar and menu."""
        self.messages = Messages(self.iface)
        self._toolbar = self.iface.addToolBar(MENU)
        self._toolbar.setObjectName("terrainav_toolbar")
        # Not QGIS's own menu for a plugin, which stays behind when its last entry is removed.
        self._menu = QMenu(MENU, self.iface.rasterMenu())
        self._menu.setObjectName("terrainav_menu")
        self._menu.setIcon(icon("icon"))
        self.iface.rasterMenu().addMenu(self._menu)
        self._add("dock", tr("Mission panel"), self._toggle_dock, checkable=True)
        self._add("draw_box", tr("Draw box"), self._toggle_box_tool, checkable=True)
        self._add("preview", tr("Preview footprints"), self._toggle_preview, checkable=True)
        self._add("test_shot", tr("Test shot"), self._toggle_point_tool, checkable=True)
        self._add("capture", tr("Capture"), lambda: self._use(lambda w: w.capture()))
        self.iface.projectRead.connect(self._project_read)

    def unload(self) -> None:
        """Take everything away again."""
        self.iface.projectRead.disconnect(self._project_read)
        if self._workflow is not None:
            self._workflow.close()
            self._workflow.deleteLater()
            self._workflow = None
        self.messages.clear()
        self.messages.deleteLater()
        for action in self.actions.values():
            action.deleteLater()
        self.actions.clear()
        self.iface.rasterMenu().removeAction(self._menu.menuAction())
        self._menu.deleteLater()
        self.iface.mainWindow().removeToolBar(self._toolbar)
        self._toolbar.deleteLater()
        self._toolbar = self._menu = None

    @property
    def workflow(self) -> Workflow | None:
        """The plugin at work; made at the first call, None where something it needs is missing."""
        if self._workflow is None and self._can_work():
            from .workflow import Workflow

            self._workflow = Workflow(self.iface, self.messages)
            self._wire(self._workflow)
        return self._workflow

    def _add(self, name: str, text: str, slot: Callable[..., None], checkable: bool = False) -> None:
        action = QAction(icon(name), text, self.iface.mainWindow())
        action.setObjectName(f"terrainav_{name}")
        action.setToolTip(tr("TerrAInav: {text}").format(text=text))
        action.setCheckable(checkable)
        action.triggered.connect(slot)
        self._toolbar.addAction(action)
        self._menu.addAction(action)
        self.actions[name] = action

    def _wire(self, workflow: Workflow) -> None:
        """Let the toolbar follow what is going on."""
        workflow.box_tool.setAction(self.actions["draw_box"])
        workflow.point_tool.setAction(self.actions["test_shot"])
        self.actions["dock"].setChecked(workflow.dock.isUserVisible())
        workflow.dock.visibilityChanged.connect(self.actions["dock"].setChecked)
        workflow.preview_shown.connect(self.actions["preview"].setChecked)
        workflow.running.connect(self.actions["capture"].setDisabled)

    def _use(self, act: Callable[[Workflow], None]) -> None:
        workflow = self.workflow
        if workflow is not None:
            act(workflow)
            return
        for action in self.actions.values():
            action.setChecked(False)

    def _toggle_dock(self, visible: bool) -> None:
        self._use(lambda workflow: workflow.show_dock(visible))

    def _toggle_box_tool(self, on: bool) -> None:
        self._use(lambda workflow: workflow.draw_box() if on else workflow.box_tool.stop())

    def _toggle_point_tool(self, on: bool) -> None:
        self._use(lambda workflow: workflow.take_test_shot() if on else workflow.point_tool.stop())

    def _toggle_preview(self, on: bool) -> None:
        self._use(lambda workflow: workflow.set_preview(on))

    def _project_read(self) -> None:
        if saved_missions(QgsProject.instance()):
            self._use(lambda workflow: workflow.restore_saved())

    def _can_work(self) -> bool:
        """Whether the needed packages are there; says which are not."""
        missing = [package for module, package in _NEEDED.items() if not _importable(module)]
        if missing:
            self.messages.warning(
                tr("TerrAInav needs Python packages that this QGIS lacks: {packages}.").format(
                    packages=", ".join(missing)
                )
            )
        return not missing


def _importable(module: str) -> bool:
    try:
        importlib.import_module(module)
    except ImportError:
        return False
    return True
