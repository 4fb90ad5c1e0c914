"""The entry point of the plugin, with toolbar and menu. Everything else is loaded on first use."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from qgis.core import QgsApplication, QgsPathResolver, QgsProject
from qgis.gui import QgisInterface, QgsOptionsWidgetFactory
from qgis.PyQt.QtCore import QTimer
from qgis.PyQt.QtWidgets import QMenu, QWidget

from .compat import VECTOR, QAction
from .i18n import install_translator, remove_translator, tr
from .messages import LogPanelHandler, Messages
from .packages import NEEDED
from .paths import COPIES, UNFINISHED, icon

if TYPE_CHECKING:
    from qgis.PyQt.QtCore import QTranslator
    from qgis.PyQt.QtWidgets import QToolBar

    from .panel.options_page import OptionsPage
    from .processing.provider import Provider
    from .session import Session

MENU = "TerrAInav"
#: Name of the algorithm provider, as in ``terrainav:plan``.
PROVIDER = "terrainav"
#: Icons of QGIS, by the actions that use them.
_OF_QGIS = {"settings": "/mActionOptions.svg", "help": "/mActionHelpContents.svg"}
#: Key of the plugin's page in QGIS's options.
PAGE = "terrainav_options"


class TerrAInavPlugin:
    """The plugin as QGIS loads and unloads it."""

    def __init__(self, iface: QgisInterface) -> None:
        self.iface = iface
        self.actions: dict[str, QAction] = {}
        self.messages: Messages | None = None
        self._log: LogPanelHandler | None = None
        self._toolbar: QToolBar | None = None
        self._menu: QMenu | None = None
        self._options: OptionsFactory | None = None
        self._translator: QTranslator | None = None
        self._session: Session | None = None
        self._provider: Provider | None = None
        self._processing_soon: QTimer | None = None
        self._unfinished_soon: QTimer | None = None
        self._path_finder = ""
        self._label_action: QAction | None = None

    def initProcessing(self) -> None:
        """Add the provider of algorithms; QGIS calls this itself if it has no windows (``qgis_process``)."""
        from .processing.provider import Provider

        registry = QgsApplication.processingRegistry()
        if registry.providerById(PROVIDER) is None:
            self._translate()
            # The registry owns the provider; this reference keeps its Python wrapper.
            self._provider = Provider()
            registry.addProvider(self._provider)

    def initGui(self) -> None:
        """Add toolbar, menu and options page."""
        self._translate()
        self._log = LogPanelHandler()
        self.messages = Messages(self.iface)
        self._toolbar = self.iface.addToolBar(MENU)
        self._toolbar.setObjectName("terrainav_toolbar")
        self._menu = QMenu(f"&{MENU}", self.iface.rasterMenu())
        self._menu.setObjectName("terrainav_menu")
        self._menu.setIcon(icon("icon"))
        for menu in self._menus():
            menu.addMenu(self._menu)
        self._add("dock", tr("Mission &panel"), self._toggle_dock, checkable=True)
        self._add("draw_box", tr("&Draw box"), self._toggle_box_tool, checkable=True)
        self._add("draw_polygon", tr("Draw pol&ygon"), self._toggle_polygon_tool, checkable=True)
        self._add("preview", tr("Preview &footprints"), self._toggle_preview, checkable=True)
        self._add("test_shot", tr("&Test shot"), self._toggle_point_tool, checkable=True)
        self._add("live_view", tr("&Live view"), self._toggle_live_view, checkable=True)
        self._add("capture", tr("&Capture"), lambda: self._use(lambda w: w.capture()))
        self._add("view_images", tr("&View images"), self._toggle_view_tool, checkable=True)
        self._add("clean_dataset", tr("D&ataset…"), lambda: self._use(lambda w: w.datasets.open()))
        self._add("make_benchmark", tr("Make &benchmark…"), lambda: self._use(lambda w: w.make_benchmark()))
        self._add(
            "score_benchmark",
            tr("Sc&ore benchmark…"),
            self._score_benchmark,
            in_toolbar=False,
        )
        self._menu.addSeparator()
        self._add("settings", tr("&Settings…"), self.show_settings, in_toolbar=False)
        self._add("help", tr("&Help"), self._show_help, in_toolbar=False)
        self._label_action = QAction(icon("icon"), tr("Label &images with this layer"), self.iface.mainWindow())
        self._label_action.setObjectName("terrainav_label_layer")
        self._label_action.triggered.connect(self._label_layer)
        # In the menus of all vector layers.
        self.iface.addCustomActionForLayerType(self._label_action, MENU, VECTOR, True)
        self._options = OptionsFactory(self._settings_changed)
        self.iface.registerOptionsWidgetFactory(self._options)
        # A preprocessor of paths, as QGIS looks for the files of layers before it reports that the project is read.
        self._path_finder = QgsPathResolver.setPathPreprocessor(_local_source)
        self.iface.projectRead.connect(self._project_read)
        self.iface.newProjectCreated.connect(self._project_begun)
        # Do nothing before QGIS has a window, to not delay its start.
        self._processing_soon = QTimer(self.iface.mainWindow())
        self._processing_soon.setSingleShot(True)
        self._processing_soon.timeout.connect(self.initProcessing)
        self._processing_soon.start(0)
        self._unfinished_soon = QTimer(self.iface.mainWindow())
        # Check twice a second whether QGIS has a window.
        self._unfinished_soon.setInterval(500)
        self._unfinished_soon.timeout.connect(self._offer_unfinished)
        self._unfinished_soon.start()

    def unload(self) -> None:
        """Remove everything that the plugin has added."""
        for timer in filter(None, (self._processing_soon, self._unfinished_soon)):
            timer.stop()
            timer.deleteLater()
        self._processing_soon = self._unfinished_soon = None
        # By name, as the registry may already have deleted the provider.
        QgsApplication.processingRegistry().removeProvider(PROVIDER)
        self._provider = None
        if self._toolbar is not None:
            self._remove_from_window()
        remove_translator(self._translator)
        self._translator = None

    def _translate(self) -> None:
        """Install the translation to the user's language, unless it is installed."""
        if self._translator is None:
            self._translator = install_translator()

    def _remove_from_window(self) -> None:
        from .help import close_help

        QgsPathResolver.removePathPreprocessor(self._path_finder)
        self.iface.projectRead.disconnect(self._project_read)
        self.iface.newProjectCreated.disconnect(self._project_begun)
        self.iface.unregisterOptionsWidgetFactory(self._options)
        self._options.deleteLater()
        close_help()
        if self._session is not None:
            self._session.close()
            self._session.deleteLater()
            self._session = None
        self.messages.close()
        self.messages.deleteLater()
        self._log.close()
        self.iface.removeCustomActionForLayerType(self._label_action)
        self._label_action.deleteLater()
        for action in self.actions.values():
            self.iface.unregisterMainWindowAction(action)
            action.deleteLater()
        self.actions.clear()
        for menu in self._menus():
            menu.removeAction(self._menu.menuAction())
        self._menu.deleteLater()
        self.iface.mainWindow().removeToolBar(self._toolbar)
        self._toolbar.deleteLater()
        self._toolbar = self._menu = self._options = self._label_action = None

    def _menus(self) -> tuple[QMenu, QMenu]:
        """Menus of QGIS that have the plugin's menu: of its subject, and where QGIS lists plugins."""
        return self.iface.rasterMenu(), self.iface.pluginMenu()

    def show_settings(self) -> None:
        """Open QGIS's options at the plugin's page."""
        self.iface.showOptionsDialog(self.iface.mainWindow(), PAGE)

    @property
    def session(self) -> Session | None:
        """The session, created at the first call; None if a package it needs is missing."""
        if self._session is None and self._can_work():
            from .session import Session

            self._session = Session(self.iface, self.messages)
            self._wire(self._session)
        return self._session

    def _add(
        self,
        name: str,
        text: str,
        slot: Callable[..., None],
        checkable: bool = False,
        in_toolbar: bool = True,
    ) -> None:
        image = QgsApplication.getThemeIcon(_OF_QGIS[name]) if name in _OF_QGIS else icon(name)
        action = QAction(image, text, self.iface.mainWindow())
        action.setObjectName(f"terrainav_{name}")
        action.setToolTip(tr("TerrAInav: {text}").format(text=text.replace("&", "")))
        action.setCheckable(checkable)
        action.triggered.connect(slot)
        # Without a default shortcut; the user can set one in QGIS's dialog.
        self.iface.registerMainWindowAction(action, "")
        if in_toolbar:
            self._toolbar.addAction(action)
        self._menu.addAction(action)
        self.actions[name] = action

    def _wire(self, session: Session) -> None:
        """Keep the toolbar's state up to date."""
        session.box_tool.setAction(self.actions["draw_box"])
        session.areas.polygon_tool.setAction(self.actions["draw_polygon"])
        session.point_tool.setAction(self.actions["test_shot"])
        session.viewing.tool.setAction(self.actions["view_images"])
        self.actions["dock"].setChecked(session.dock.isUserVisible())
        session.dock.visibilityChanged.connect(self.actions["dock"].setChecked)
        session.live.shown.connect(self.actions["live_view"].setChecked)
        session.preview_shown.connect(self.actions["preview"].setChecked)

    def _use(self, act: Callable[[Session], None]) -> None:
        session = self.session
        if session is not None:
            act(session)
            return
        for action in self.actions.values():
            action.setChecked(False)

    def _toggle_dock(self, visible: bool) -> None:
        self._use(lambda session: session.show_dock(visible))

    def _toggle_box_tool(self, on: bool) -> None:
        self._use(lambda session: session.draw_box() if on else session.box_tool.stop())
        # On an empty map, imagery is shown first: the button is pressed only once the tool starts.
        if self._session is not None:
            self.actions["draw_box"].setChecked(self._session.box_tool.isActive())

    def _toggle_polygon_tool(self, on: bool) -> None:
        self._use(lambda session: session.draw_polygon() if on else session.areas.polygon_tool.stop())
        if self._session is not None:
            self.actions["draw_polygon"].setChecked(self._session.areas.polygon_tool.isActive())

    def _toggle_point_tool(self, on: bool) -> None:
        self._use(lambda session: session.take_test_shot() if on else session.point_tool.stop())

    def _toggle_live_view(self, on: bool) -> None:
        self._use(lambda session: session.live.open() if on else session.live.hide())

    def _toggle_view_tool(self, on: bool) -> None:
        self._use(lambda session: session.viewing.start() if on else session.viewing.stop())
        if self._session is not None:
            # The button stays released if there is nothing to view.
            self.actions["view_images"].setChecked(self._session.viewing.tool.isActive())

    def _toggle_preview(self, on: bool) -> None:
        self._use(lambda session: session.set_preview(on))

    def _label_layer(self) -> None:
        layer = self.iface.activeLayer()
        if layer is not None:
            self._use(lambda session: session.label_layer(layer))

    def _score_benchmark(self) -> None:
        self._use(lambda session: session.benchmarks.score())

    def _show_help(self) -> None:
        from .help import show_help

        show_help()

    def _settings_changed(self) -> None:
        if self._session is not None:
            self._session.settings_changed()

    def _project_read(self) -> None:
        from .map.mission_group import saved_missions

        if saved_missions(QgsProject.instance()):
            self._use(lambda session: session.missions.restore())

    def _project_begun(self) -> None:
        # Not for the new project with which QGIS starts: keep the entries of the last session.
        if self._session is not None and self.iface.mainWindow().isVisible():
            self._session.project_begun()

    def _offer_unfinished(self) -> None:
        """Offer unfinished captures once there is a window; load little if there are none."""
        if not self.iface.mainWindow().isVisible():
            return
        self._unfinished_soon.stop()
        from .capture.left import left_folders

        if any(Path(QgsApplication.qgisSettingsDirPath(), UNFINISHED).glob("*.json")) or left_folders():
            self._use(lambda session: session.runs.offer_unfinished())

    def _can_work(self) -> bool:
        """Whether the needed packages are installed; reports missing packages."""
        missing = [package for module, package in NEEDED.items() if not _importable(module)]
        if missing:
            self.messages.warning(
                tr("TerrAInav needs Python packages that this QGIS lacks: {packages}.").format(
                    packages=", ".join(missing)
                )
            )
        return not missing


class OptionsFactory(QgsOptionsWidgetFactory):
    """Create the plugin's options page.

    Parameters
    ----------
    applied : callable
        Called after the settings are saved.
    """

    def __init__(self, applied: Callable[[], None]) -> None:
        super().__init__(MENU, icon("icon"))
        self._applied = applied

    def createWidget(self, parent: QWidget | None = None) -> OptionsPage:
        """Create the page each time the options are opened."""
        from .panel.options_page import OptionsPage

        page = OptionsPage(parent, self._applied)
        page.setObjectName(PAGE)
        return page


def _local_source(source: str) -> str:
    """Source of a layer, changed to the local copy if it is a file of a remote dataset."""
    if COPIES not in source.replace("\\", "/"):
        return source
    from .remote.copies import local_copy

    return local_copy(source)


def _importable(module: str) -> bool:
    try:
        importlib.import_module(module)
    except ImportError:
        return False
    return True
