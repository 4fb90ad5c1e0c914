"""Windows stand beside the map: docked, where the user had them, as low as a small screen needs."""

from __future__ import annotations

import threading

import pytest
from qgis.PyQt import sip
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import QMenu
from terrainav.terrainav_plugin.dataset_window.datasets import TABS, Datasets
from terrainav.terrainav_plugin.missions import missions as missions_module
from terrainav.terrainav_plugin.results.viewing import Viewing

AREA = "35.14_-89.87_35.138_-89.868_120"


@pytest.fixture(scope="module")
def captured(tmp_path_factory):
    from terrainav.core.cli import main

    folder = tmp_path_factory.mktemp("captured") / "survey"
    assert main(["capture", "--coords", AREA, "--zoom", "17", "--data-dir", str(folder)]) == 0
    return folder


@pytest.fixture(params=["dataset", "viewer"])
def opener(request, desk):
    """Make a room anew, as in another session of QGIS, and return it with a function that opens its window."""
    made = []

    def open_one():
        if request.param == "dataset":
            room = Datasets(desk.iface, desk.session.messages, list)
            room.open()
            made.append(room)
            return room, room.window
        room = Viewing(desk.session.project, desk.iface, desk.session.messages)
        made.append(room)
        return room, room._shown_viewer()

    # The session's own windows have the same names.
    for window in (desk.session.datasets.window, desk.session.viewing.viewer):
        if window is not None:
            window.setObjectName("")
    yield open_one
    for room in made:
        if (room.window if request.param == "dataset" else room.viewer) is not None:
            room.close()
    for window, name in (
        (desk.session.datasets.window, "terrainav_dataset"),
        (desk.session.viewing.viewer, "terrainav_viewer"),
    ):
        if window is not None:
            window.setObjectName(name)


def end(room, window):
    """Close a room, as QGIS does at its end."""
    room.close()
    if not sip.isdeleted(window):
        sip.delete(window)


def test_a_window_is_docked_beside_the_map_and_low(desk, opener):
    canvas = desk.canvas.size()
    _, window = opener()
    desk.wait(window.isUserVisible)
    assert not window.isFloating()
    assert desk.iface.mainWindow().dockWidgetArea(window) == desk.iface.mainWindow().dockWidgetArea(desk.dock)
    assert desk.canvas.size() == canvas
    assert window.minimumSizeHint().height() < 250
    assert window.minimumSizeHint().width() <= desk.dock.minimumSizeHint().width()


def test_tabs_of_a_dataset_are_not_wider_than_the_panel(desk, captured):
    datasets = desk.session.datasets
    narrowest = desk.dock.minimumSizeHint().width()
    try:
        for tab in TABS:
            datasets.open(captured, tab)
            desk.wait(lambda: not datasets.busy)
            page = datasets.window.tabs.currentWidget()
            around = datasets.window.width() - page.viewport().width()
            assert page.widget().minimumSizeHint().width() + around <= narrowest, tab
    finally:
        datasets.open(tab=TABS[0])
        datasets.window.setUserVisible(False)


def test_a_window_comes_back_where_the_user_had_it(desk, opener):
    main = desk.iface.mainWindow()
    before = main.saveState()
    try:
        room, window = opener()
        main.addDockWidget(Qt.DockWidgetArea.LeftDockWidgetArea, window)
        desk.wait(window.isVisible)
        state = main.saveState()
        end(room, window)
        assert main.restoreState(state)
        room, window = opener()
        assert main.dockWidgetArea(window) == Qt.DockWidgetArea.LeftDockWidgetArea
        assert not window.isFloating()
        # In QGIS's list of panels, once.
        listed = main.findChild(QMenu, "mPanelMenu").actions()
        assert listed.count(window.toggleViewAction()) == 1
        window.setFloating(True)
        window.setGeometry(60, 80, 500, 400)
        desk.wait(window.isVisible)
        state = main.saveState()
        end(room, window)
        assert main.restoreState(state)
        room, window = opener()
        assert window.isFloating()
        assert window.isVisible()
        end(room, window)
    finally:
        main.restoreState(before)


def test_opening_a_dataset_is_shown_in_the_panel_and_can_be_stopped(desk, captured, monkeypatch):
    go_on, reached = threading.Event(), threading.Event()
    existing = missions_module.existing_mosaics

    def held(folder, mission):
        reached.set()
        assert go_on.wait(60.0)
        return existing(folder, mission)

    monkeypatch.setattr(missions_module, "existing_mosaics", held)
    line, rows, missions = desk.dock.figures.line, desk.dock.run_list, desk.session.missions
    assert "No area yet." in line.text()
    for stopped in (True, False):
        missions.open_dataset(captured)
        desk.wait(reached.is_set)
        assert "Opening survey…" in line.text()
        assert not desk.dock.hint.isVisible()
        (row,) = rows.rows
        assert (row.title.text(), row.text.text()) == ("survey", "Opening…")
        missions.opening.emit("survey", 40.0)
        assert row.bar.value() == 40
        assert "mosaic" in row.text.text()
        if stopped:
            desk.click(row.buttons["cancel"])
        go_on.set()
        desk.wait(lambda: not missions.busy)
        assert rows.rows == []
        go_on.clear()
        reached.clear()
        if stopped:
            assert "No area yet." in line.text()
            assert desk.group() is None
    desk.wait_planned()
    assert "Opening" not in line.text()
    desk.session.missions.begin_new()


def test_the_panel_and_its_tab_come_back_together(desk, iface):
    """After QGIS is started again, the window is again a tab of the panel, wherever the user has both."""
    from terrainav.terrainav_plugin.panel.dock import Dock
    from terrainav.terrainav_plugin.widgets import add_docked

    main = iface.mainWindow()
    before, names = main.saveState(), {}
    windows = (desk.dock, desk.session.datasets.window)
    for window in filter(None, windows):
        names[window] = window.objectName()
        window.setObjectName("")

    def begin():
        panel, datasets = Dock([], []), Datasets(iface, desk.session.messages, list)
        add_docked(panel, iface)
        datasets.open()
        return panel, datasets

    def finish(panel, datasets):
        end(datasets, datasets.window)
        iface.removeDockWidget(panel)
        sip.delete(panel)

    try:
        panel, datasets = begin()
        main.addDockWidget(Qt.DockWidgetArea.LeftDockWidgetArea, panel)
        main.tabifyDockWidget(panel, datasets.window)
        state = main.saveState()
        finish(panel, datasets)
        assert main.restoreState(state)
        panel, datasets = begin()
        assert main.dockWidgetArea(panel) == Qt.DockWidgetArea.LeftDockWidgetArea
        assert main.tabifiedDockWidgets(panel) == [datasets.window]
        finish(panel, datasets)
    finally:
        for window, name in names.items():
            window.setObjectName(name)
        main.restoreState(before)
