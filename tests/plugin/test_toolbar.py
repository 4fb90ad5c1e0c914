"""Toolbar and menu: every button does what it says, and shows what is going on."""

from __future__ import annotations

from qgis.gui import QgsGui
from qgis.PyQt.QtGui import QKeySequence
from qgis.PyQt.QtWidgets import QToolBar
from terrainav.terrainav_plugin import plugin as plugin_module

BUTTONS = [
    "dock",
    "draw_box",
    "draw_polygon",
    "preview",
    "test_shot",
    "live_view",
    "capture",
    "view_images",
    "clean_dataset",
    "make_benchmark",
]


def test_toolbar_and_menu_hold_all_actions(plugin, iface):
    toolbar = iface.mainWindow().findChild(QToolBar, "terrainav_toolbar")
    assert [action.objectName() for action in toolbar.actions()] == [f"terrainav_{name}" for name in BUTTONS]
    (menu,) = (action.menu() for action in iface.rasterMenu().actions() if action.text() == "&TerrAInav")
    (in_plugins,) = (action.menu() for action in iface.pluginMenu().actions() if action.text() == "&TerrAInav")
    assert in_plugins is menu
    entries = [action.objectName() for action in menu.actions() if not action.isSeparator()]
    assert set(entries) == {action.objectName() for action in plugin.actions.values()}
    assert {f"terrainav_{name}" for name in (*BUTTONS, "score_benchmark", "settings", "help")} <= set(entries)
    for action in plugin.actions.values():
        assert not action.icon().isNull()
        assert action.icon().availableSizes() or not action.icon().pixmap(24).isNull()
        assert f"TerrAInav: {action.text().replace('&', '')}" in action.toolTip()


def test_menu_is_used_by_keyboard(plugin):
    """Every entry has a letter of its own, and users can give each a shortcut; it has none by itself."""
    letters = [text[text.index("&") + 1].lower() for text in (a.text() for a in plugin.actions.values())]
    assert sorted(letters) == sorted(set(letters))
    known = QgsGui.shortcutsManager()
    for action in plugin.actions.values():
        assert action in known.listActions()
        assert known.defaultKeySequence(action) == ""
    assert known.setKeySequence(plugin.actions["dock"], "Ctrl+Alt+Shift+F11")
    try:
        assert known.actionForSequence(QKeySequence("Ctrl+Alt+Shift+F11")) is plugin.actions["dock"]
    finally:
        known.setKeySequence(plugin.actions["dock"], "")


def test_dock_button_shows_and_hides_the_panel(desk):
    action = desk.plugin.actions["dock"]
    assert desk.dock.isVisible()
    assert action.isChecked()
    action.trigger()
    desk.wait(lambda: not desk.dock.isVisible())
    assert not action.isChecked()
    action.trigger()
    desk.wait(lambda: desk.dock.isVisible() and action.isChecked())


def test_every_button_brings_the_panel(ground, desk):
    desk.enter_small_mission()
    for name in ("draw_box", "preview", "test_shot"):
        desk.dock.setUserVisible(False)
        desk.plugin.actions[name].trigger()
        desk.wait(desk.dock.isVisible)
    desk.wait_previewed()


def test_tool_buttons_put_their_tool_away_again(ground, desk):
    before = desk.canvas.mapTool()
    for name in ("draw_box", "test_shot"):
        action = desk.plugin.actions[name]
        action.trigger()
        assert action.isChecked()
        assert desk.canvas.mapTool() is not before
        action.trigger()
        assert not action.isChecked()
        assert desk.canvas.mapTool() is before


def test_preview_button_and_panel_agree(desk):
    desk.enter_small_mission()
    action = desk.plugin.actions["preview"]
    action.trigger()
    desk.wait_previewed()
    assert desk.dock.preview.isChecked()
    action.trigger()
    assert not desk.dock.preview.isChecked()
    assert desk.group() is None


def test_capture_button_captures(desk):
    desk.enter_small_mission()
    desk.plugin.actions["capture"].trigger()
    desk.wait((desk.folder / "mission.json").is_file)


def test_missing_package_is_one_line(plugin, iface, monkeypatch):
    """Nothing else happens, and nothing is raised."""
    needed = {**plugin_module.NEEDED, "no_such_module_anywhere": "Imaginary"}
    monkeypatch.setattr(plugin_module, "NEEDED", needed)
    monkeypatch.setattr(plugin, "_session", None)
    for name in BUTTONS:
        plugin.actions[name].trigger()
    texts = {item.text() for item in iface.messageBar().items()}
    assert texts == {"TerrAInav needs Python packages that this QGIS lacks: Imaginary."}
    assert plugin._session is None
    assert not any(action.isChecked() for action in plugin.actions.values())
