"""The plugin comes and goes without a trace, in the real application."""

from __future__ import annotations

import gc
import sys
from collections import Counter

import pytest
import qgis.utils
from qgis.core import QgsApplication, QgsProject
from qgis.gui import QgsMapCanvasItem
from qgis.PyQt.QtCore import QCoreApplication, QEvent, QMetaMethod, QObject, pyqtBoundSignal
from qgis.PyQt.QtWidgets import QAction, QDockWidget, QMenu, QToolBar

PLUGIN = "terrainav"
ROUNDS = 10


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
        for name in {
            bytes(m.name()).decode() for m in methods if m.methodType() == QMetaMethod.MethodType.Signal
        }:
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


# Qt's style animates QGIS's own progress bars while they move, whoever's task it is.
OF_THE_STYLE = {"QProgressStyleAnimation", "QScrollbarStyleAnimation"}


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
            f"{menu.objectName()}: {action.text()}"
            for menu in window.findChildren(QMenu)
            for action in menu.actions()
        ),
        "children of the main window": kinds(window.children()),
        "all objects below the main window": Counter(
            item.metaObject().className()
            for item in window.findChildren(QObject)
            if item.metaObject().className() not in OF_THE_STYLE
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


def test_nothing_is_left_behind(unloaded, iface):
    assert names_of_the_plugin(iface) == []
    before = census(iface)
    for _ in range(ROUNDS):
        load()
        settle()
        assert qgis.utils.unloadPlugin(PLUGIN)
    assert differences(before, census(iface)) == {}
    assert names_of_the_plugin(iface) == []
