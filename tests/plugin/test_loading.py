"""The plugin comes and goes without a trace, in the real application."""

from __future__ import annotations

import gc
import importlib
import sys
import threading
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest
import qgis.utils
from qgis.core import QgsApplication, QgsProject
from qgis.gui import QgsGui, QgsMapCanvasItem
from qgis.PyQt import sip
from qgis.PyQt.QtCore import QCoreApplication, QEvent, QMetaMethod, QObject, Qt, QTimer, QUrl, pyqtBoundSignal
from qgis.PyQt.QtGui import QDesktopServices
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAction, QApplication, QDockWidget, QMenu, QPushButton, QTabWidget, QToolBar

from tests.plugin.steps import COARSE, PATIENCE_MS, SMALL_BOX
from tests.support.datasets import write_dataset

PLUGIN = "terrainav"


def settle():
    """Let everything that was asked to be deleted be deleted."""
    gc.collect()
    for _ in range(3):
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
        QCoreApplication.processEvents()
    gc.collect()


def kinds(objects):
    return Counter(f"{item.metaObject().className()} {item.objectName()}" for item in objects)


def receivers(*senders):
    """Count the connections of every signal that `senders` have."""
    counts = Counter()
    for sender in senders:
        meta = sender.metaObject()
        methods = [meta.method(index) for index in range(meta.methodCount())]
        for name in {bytes(m.name()).decode() for m in methods if m.methodType() == QMetaMethod.MethodType.Signal}:
            signal = getattr(sender, name, None)
            if isinstance(signal, pyqtBoundSignal):
                counts[f"{meta.className()}.{name}"] = sender.receivers(signal)
    return counts


def names_of_the_plugin(iface):
    """Find what bears the plugin's name anywhere in the main window; a name may be an identifier or a visible text."""
    settle()
    settle()
    texts = ("objectName", "text", "title", "windowTitle", "toolTip")
    return [
        f"{type(item).__name__}.{text}: {getattr(item, text)()}"
        for item in iface.mainWindow().findChildren(QObject)
        for text in texts
        if callable(getattr(item, text, None)) and PLUGIN in str(getattr(item, text)()).lower()
    ]


# Qt's style animates QGIS's own widgets, whoever's they show. QGIS itself, without any plugin, keeps the indicators of
# temporary layers, and the legend entries that a layer had before its style was changed, or its project replaced.
NOT_OURS = {
    "QProgressStyleAnimation",
    "QScrollbarStyleAnimation",
    "QPropertyAnimation",
    "QgsLayerTreeViewIndicator",
    "QgsSymbolLegendNode",
}


def census(iface):
    """Count what a plugin can leave in the application."""
    window, registry = iface.mainWindow(), QgsApplication.processingRegistry()
    canvas, project = iface.mapCanvas(), QgsProject.instance()
    settle()
    return {
        "toolbars": kinds(window.findChildren(QToolBar)),
        "menus": kinds(window.findChildren(QMenu)),
        "docks": kinds(window.findChildren(QDockWidget)),
        "actions": kinds(window.findChildren(QAction)),
        "menu entries": Counter(
            f"{menu.objectName()}: {action.text()}" for menu in window.findChildren(QMenu) for action in menu.actions()
        ),
        "children of the main window": kinds(window.children()),
        "all objects below the main window": Counter(
            item.metaObject().className()
            for item in window.findChildren(QObject)
            if item.metaObject().className() not in NOT_OURS
        ),
        "layer tree groups": Counter(group.name() for group in project.layerTreeRoot().findGroups(True)),
        "layers": Counter(layer.name() for layer in project.mapLayers().values()),
        "map tool": Counter([type(canvas.mapTool()).__name__]),
        "canvas items": Counter(
            type(item).__name__ for item in canvas.scene().items() if isinstance(item, QgsMapCanvasItem)
        ),
        "processing providers": Counter(provider.id() for provider in registry.providers()),
        "processing algorithms": Counter(algorithm.id() for algorithm in registry.algorithms()),
        "options pages": Counter(kinds(getattr(iface, "optionsWidgetFactories", list)())),
        "tasks": Counter(task.description() for task in QgsApplication.taskManager().tasks()),
        "signal receivers": receivers(
            canvas, project, project.layerTreeRoot(), iface.layerTreeView(), iface.messageBar(), registry
        ),
    }


def differences(before, after):
    return {
        name: {"left behind": dict(after[name] - before[name]), "missing": dict(before[name] - after[name])}
        for name in before
        if before[name] != after[name]
    }


@pytest.fixture
def unloaded(plugin):
    """Take the plugin out by QGIS's own means, and put the same one back afterwards.

    Unloading makes QGIS forget the plugin's modules. They are put back as they were, as the other tests have imported
    from them: an error class of a second copy of a module would be another class.
    """
    modules = {name: module for name, module in sys.modules.items() if name.partition(".")[0] == PLUGIN}
    tracked = set(qgis.utils._plugin_modules[PLUGIN])
    assert qgis.utils.unloadPlugin(PLUGIN)
    yield
    if PLUGIN in qgis.utils.plugins:
        assert qgis.utils.unloadPlugin(PLUGIN)
    for name in [name for name in sys.modules if name.partition(".")[0] == PLUGIN]:
        del sys.modules[name]
    sys.modules.update(modules)
    # Packages that QGIS has not forgotten still name the modules of the copy in between.
    for name, module in modules.items():
        for child, value in list(vars(module).items()):
            whole = f"{name}.{child}"
            if isinstance(value, ModuleType) and value.__name__ == whole and modules.get(whole) is not value:
                delattr(module, child)
        package, _, child = name.rpartition(".")
        if package in modules:
            setattr(modules[package], child, module)
    qgis.utils._plugin_modules[PLUGIN] = tracked
    assert qgis.utils.startPlugin(PLUGIN)


def load():
    assert qgis.utils.loadPlugin(PLUGIN)
    assert qgis.utils.startPlugin(PLUGIN)


def test_application_starts_with_the_plugin(plugin, iface):
    assert type(plugin).__module__ == "terrainav.terrainav_plugin.plugin"
    assert iface.mainWindow().isVisible()
    assert not QgsApplication.taskManager().tasks()


def test_census_sees_a_loaded_plugin(unloaded, iface):
    before = census(iface)
    load()
    gained = differences(before, census(iface))
    assert gained["toolbars"]["left behind"]
    assert gained["actions"]["left behind"]
    assert names_of_the_plugin(iface)


# What is left behind by one round is left by each of them.
@pytest.mark.parametrize("rounds", [4, pytest.param(10, marks=pytest.mark.thorough)])
def test_nothing_is_left_behind(unloaded, iface, rounds):
    assert names_of_the_plugin(iface) == []
    before = census(iface)
    for _ in range(rounds):
        load()
        settle()
        assert qgis.utils.unloadPlugin(PLUGIN)
    assert differences(before, census(iface)) == {}
    assert names_of_the_plugin(iface) == []


def close_dialog():
    """Close the dialog that comes next."""
    dialog = QApplication.activeModalWidget()
    if dialog is None:
        QTimer.singleShot(20, close_dialog)
    else:
        dialog.reject()


def use_everything(iface, qtbot, folder):
    """Use what a person may have used before unloading: panel, tools, preview, options, a run, the guide."""
    plugin = qgis.utils.plugins[PLUGIN]
    plugin.actions["dock"].trigger()
    session = plugin.session
    # The button would draw imagery for the empty map in the first round, and find it drawn in others.
    session.box_tool.start()
    for name in ("test_shot", "preview"):
        plugin.actions[name].trigger()
    form_state = sys.modules["terrainav.terrainav_plugin.form.state"].FormState
    session.dock.form.set_state(form_state(**SMALL_BOX, **COARSE, folder=str(folder)))
    qtbot.waitUntil(lambda: not session.planner.busy, timeout=PATIENCE_MS)
    plugin.actions["live_view"].trigger()
    plugin.actions["capture"].trigger()
    plugin.actions["clean_dataset"].trigger()
    session.datasets.open(write_dataset(folder.with_name(f"{folder.name}-there")))
    qtbot.waitUntil(lambda: session.datasets.cleaning.marks.item is not None, timeout=PATIENCE_MS)
    session.datasets.cleaning.panel.buttons["mark"].click()
    close_dialog()
    plugin.actions["settings"].trigger()
    plugin.actions["help"].trigger()
    plugin.messages.error("for this test", "details")
    qtbot.waitUntil(lambda: any(folder.rglob("*.tif")), timeout=PATIENCE_MS)


def test_a_live_view_at_work_leaves_nothing_behind(unloaded, iface, qtbot, tmp_path):
    """Unloaded while it opens its imagery or takes pictures."""

    def threads():
        return [thread.name for thread in threading.enumerate() if thread.name.startswith("terrainav")]

    before = None
    for number in range(3):
        load()
        session = qgis.utils.plugins[PLUGIN].session
        form_state = sys.modules["terrainav.terrainav_plugin.form.state"].FormState
        state = form_state(**SMALL_BOX, elevation=("world",), tilt_deg=60.0, folder=str(tmp_path / "mission"))
        session.dock.form.set_state(state)
        session.live.open()
        assert session.live.feed.busy
        if number:
            qtbot.waitUntil(lambda live=session.live: live.dock.picture.image is not None, timeout=PATIENCE_MS)
        assert qgis.utils.unloadPlugin(PLUGIN)
        iface.newProject(False)
        qtbot.waitUntil(lambda: not threads(), timeout=PATIENCE_MS)
        settle()
        assert names_of_the_plugin(iface) == []
        if before is not None:
            assert differences(before, census(iface)) == {}
        before = census(iface)


def running():
    """Threads of Python, open files, timers and top windows, of which a plugin may leave some."""
    return {
        "threads": Counter(
            thread.name for thread in threading.enumerate() if thread.name.startswith(("terrainav", "planner"))
        ),
        "files": Counter(
            str(path)
            for path in (_target(link) for link in Path("/proc/self/fd").iterdir())
            if path is not None and ("TerrAInav" in path or "mission" in path or "terrainav" in path.lower())
        ),
        "windows": Counter(
            f"{widget.metaObject().className()} {widget.objectName()}"
            for widget in QApplication.topLevelWidgets()
            if PLUGIN in widget.objectName().lower()
        ),
        "shortcuts": Counter(
            action.objectName() for action in QgsGui.shortcutsManager().listActions() if PLUGIN in action.objectName()
        ),
    }


def _target(link):
    try:
        return str(link.readlink())
    except OSError:
        return None  # closed meanwhile: the one that lists


@pytest.mark.thorough
@pytest.mark.parametrize("uses", [2, pytest.param(3, marks=pytest.mark.thorough)])
def test_nothing_is_left_behind_by_what_was_used(unloaded, iface, qtbot, tmp_path, monkeypatch, uses):
    """Loaded, used in full and unloaded while it works, again and again."""
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    # No homepage is opened where the guide is not there.
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda _url: True)
    before = None
    for number in range(uses):
        load()
        use_everything(iface, qtbot, tmp_path / f"mission-{number}")
        assert qgis.utils.unloadPlugin(PLUGIN)
        iface.newProject(False)
        iface.messageBar().clearWidgets()
        qtbot.waitUntil(lambda: QgsApplication.taskManager().countActiveTasks() == 0, timeout=PATIENCE_MS)
        # What QGIS itself makes at first use, such as panels and options, is there after the first round.
        if number == 0:
            before = census(iface), running()
    assert differences(before[0], census(iface)) == {}
    assert differences(before[1], running()) == {}
    assert not any(running().values())
    assert names_of_the_plugin(iface) == []


def test_windows_of_processing_close_with_the_plugin(unloaded, qtbot):
    """Not counted above: those of QGIS's own algorithms, too, leave receivers of the project for a while."""
    load()
    registry = QgsApplication.processingRegistry()
    qtbot.waitUntil(lambda: registry.providerById(PLUGIN) is not None, timeout=PATIENCE_MS)
    qgis.utils.plugins[PLUGIN].actions["score_benchmark"].trigger()
    (window,) = qgis.utils.plugins[PLUGIN].session.benchmarks.windows
    assert window.isVisible()
    assert qgis.utils.unloadPlugin(PLUGIN)
    settle()
    assert sip.isdeleted(window)


#: What takes long to load, and is of no use before the plugin is.
HEAVY = {"numpy", "pyproj", "PIL", "requests", "urllib3", "matplotlib", "osgeo", "rasterio", "owslib"}


def test_loading_imports_nothing_heavy(unloaded):
    """Measured where QGIS has not loaded such modules itself: benchmarks/startup.py."""
    before = set(sys.modules)
    load()
    gained = set(sys.modules) - before
    own = {name for name in gained if name.partition(".")[0] == PLUGIN}
    assert gained - own == set()
    # The rest of the plugin, and the core, are loaded when they are first used; so are the algorithms.
    assert own <= {
        "terrainav",
        "terrainav.terrainav_plugin",
        *(
            f"terrainav.terrainav_plugin.{name}"
            for name in ("plugin", "compat", "i18n", "messages", "packages", "paths", "plain")
        ),
    }


def test_what_is_loaded_at_the_start_names_nothing_heavy(unloaded):
    """Nor would it in a QGIS that has loaded less: the modules loaded at the start import none of it."""
    before = set(sys.modules)
    load()
    own = [sys.modules[name] for name in set(sys.modules) - before if name.partition(".")[0] == PLUGIN]
    assert len(own) > 5
    found = {
        (module.__name__, value.__name__)
        for module in own
        for value in vars(module).values()
        if isinstance(value, ModuleType) and value.__name__.partition(".")[0] in HEAVY
    }
    assert found == set()


def test_details_open_the_log_at_the_plugin_s_tab(plugin, iface, qtbot):
    plugin.messages.error("Something failed", "and this is why")
    item = next(item for item in iface.messageBar().items() if item.text() == "Something failed")
    (button,) = [button for button in item.findChildren(QPushButton) if button.text() == "Details"]
    panel = iface.mainWindow().findChild(QDockWidget, "MessageLog")
    tabs = panel.findChild(QTabWidget)
    tabs.setCurrentIndex(0)
    QTest.mouseClick(button, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(panel.isVisible, timeout=PATIENCE_MS)
    assert tabs.tabText(tabs.currentIndex()) == "TerrAInav"
    assert "and this is why" in tabs.currentWidget().toPlainText()
    panel.close()


def test_help_is_the_guide_or_the_homepage(plugin, tmp_path, monkeypatch, qtbot):
    # The one that the plugin's own import finds, however often it was loaded before.
    help_module = importlib.import_module("terrainav.terrainav_plugin.help")
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toString()))
    monkeypatch.setattr(help_module, "_PLUGIN", tmp_path)
    (tmp_path / "metadata.txt").write_text("[general]\nhomepage=https://home.example/\n", encoding="utf-8")
    plugin.actions["help"].trigger()
    assert opened == ["https://home.example/"]
    (tmp_path / "docs").mkdir()
    lines = [
        "# Guide",
        "",
        *("text\n" for _ in range(200)),
        "## Sources and keys",
        "",
        "[out](https://o.example/)",
    ]
    (tmp_path / "docs" / "guide.md").write_text("\n".join([*lines, *("text\n" for _ in range(200))]), encoding="utf-8")
    help_module.show_help("sources-and-keys")
    (window,) = [widget for widget in QApplication.topLevelWidgets() if widget.objectName() == "terrainav_guide"]
    qtbot.waitUntil(window.isVisible, timeout=PATIENCE_MS)
    assert "Sources and keys" in window.toPlainText()
    there_px = window.verticalScrollBar().value()
    assert there_px > 1000
    window.anchorClicked.emit(QUrl("https://o.example/"))
    assert opened[-1] == "https://o.example/"
    window.anchorClicked.emit(QUrl("#guide"))
    # The page's margin is above the first heading.
    assert window.verticalScrollBar().value() < 20
    help_module.close_help()
    settle()
    assert not [w for w in QApplication.topLevelWidgets() if w.objectName() == "terrainav_guide"]


@pytest.mark.thorough
def test_messages_still_shown_go_with_the_plugin(unloaded, iface, qtbot):
    """Nothing of the plugin is called by an item that the message bar deletes afterwards."""
    for _ in range(3):
        load()
        plugin = qgis.utils.plugins[PLUGIN]
        for number in range(3):
            plugin.messages.warning(f"message {number}", "details", ("Do it", lambda: None))
        plugin.session.viewing.start()
        del plugin
        assert qgis.utils.unloadPlugin(PLUGIN)
        settle()
        qtbot.wait(20)
        settle()
    assert iface.messageBar().items() == []


def test_file_dialog_of_the_panel_closes_with_the_plugin(unloaded, iface, qtbot, monkeypatch, tmp_path):
    """It runs an event loop of its own, in which the panel must not be deleted under it."""
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path))
    load()
    plugin = qgis.utils.plugins[PLUGIN]
    imagery = plugin.session.dock.form.imagery
    closed = []

    def unload():
        dialog = QApplication.activeModalWidget()
        if dialog is None:
            QTimer.singleShot(20, unload)
            return
        dialog.finished.connect(closed.append)
        assert qgis.utils.unloadPlugin(PLUGIN)

    QTimer.singleShot(20, unload)
    imagery._browse()
    assert closed == [0]
    del plugin, imagery
    qtbot.wait(50)
    assert names_of_the_plugin(iface) == []


def test_no_run_begins_after_the_plugin_has_gone(unloaded, qtbot, monkeypatch, tmp_path):
    """Unloaded while it asks whether the terms of the source are agreed to."""
    monkeypatch.setenv("TERRAINAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setenv("TERRAINAV_CONFIG_DIR", str(tmp_path / "config"))
    load()
    folder = tmp_path / "mission"
    session = qgis.utils.plugins[PLUGIN].session
    session.dock.form.set_state(type(session.state())(**SMALL_BOX, folder=str(folder)))
    qtbot.waitUntil(lambda: session.planned is not None and not session.planner.busy, timeout=PATIENCE_MS)
    runs = session.runs

    def agree(*_):
        assert qgis.utils.unloadPlugin(PLUGIN)
        return True

    monkeypatch.setattr(runs.questions, "terms_allow", agree)
    runs.start(session.planned, folder)
    assert runs.runs == []
    assert not folder.exists()
    assert QgsApplication.taskManager().countActiveTasks() == 0


def test_messages_that_users_close_are_forgotten(plugin, iface):
    for text in ("one", "two", "three"):
        plugin.messages.warning(text)
    iface.messageBar().popWidget()
    assert [item.text() for item in plugin.messages._shown] == ["one", "two"]
    iface.messageBar().clearWidgets()
    assert plugin.messages._shown == []
