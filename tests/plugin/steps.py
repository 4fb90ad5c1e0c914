"""What a person does with the plugin, in one line each: real events on real widgets."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from qgis.core import QgsApplication, QgsCoordinateReferenceSystem, QgsProject, QgsRectangle
from qgis.PyQt.QtCore import QEvent, QPoint, QPointF, Qt
from qgis.PyQt.QtGui import QMouseEvent
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QPushButton

# Waits end when the thing waited for happens; this only ends a test that would hang. Slow machines take long.
PATIENCE_MS = 60_000
# What has not changed for so long, with the event loop running, is taken to have come to rest.
STEADY_S = 0.3
# Nine by nine images of 646 x 487 px.
SMALL_BOX = {"north": "35.14", "west": "-89.87", "south": "35.131", "east": "-89.856"}
# Half the camera's resolution over half the area, for tests of what becomes of the images: six by six.
COARSE = {"resolution": "zoom", "zoom": 18}
COARSE_BOX = {"north": "35.14", "west": "-89.87", "south": "35.134", "east": "-89.8605"}


class Desk:
    """The mission panel and the map, as a person has them in front of them."""

    def __init__(self, plugin, iface, qtbot, folder: Path):
        self.plugin, self.iface, self.qtbot = plugin, iface, qtbot
        self.session = plugin.session
        self.dock, self.form = self.session.dock, self.session.dock.form
        self.canvas = iface.mapCanvas()
        self.folder = folder

    # --- the panel

    def type_text(self, edit, text):
        """Replace what is in a text field, key by key."""
        edit.setFocus()
        edit.selectAll()
        QTest.keyClicks(edit, text) if text else QTest.keyClick(edit, Qt.Key.Key_Delete)

    def enter_box(self, north, west, south, east):
        for name, text in {"north": north, "west": west, "south": south, "east": east}.items():
            self.type_text(self.form.edges[name], text)

    def enter_small_mission(self, box=SMALL_BOX):
        """Enter a mission of a few dozen images of the embedded world."""
        self.enter_box(**box)
        self.form.folder.setFilePath(str(self.folder))
        self.wait_planned()

    def enter_coarse_mission(self):
        """Enter a smaller one with images of half as many pixels along each side."""
        self.form.set_state(replace(self.session.state(), **COARSE))
        self.enter_small_mission(COARSE_BOX)

    def choose(self, combo, value):
        index = combo.findData(value)
        assert index >= 0, f"{combo.objectName()} has no {value}"
        combo.setCurrentIndex(index)

    def use_template(self, template):
        self.choose(self.form.source, "url-template")
        self.form.template.setText(template)

    def show(self, part):
        """Open the tab of a part of the panel."""
        pages = self.form.pages
        pages.setCurrentWidget(pages.page_of(part))

    def click(self, button):
        if self.form.pages.isAncestorOf(button):
            self.show(button)
        # In a group that has just been unfolded it has no size yet, and would not be hit.
        self.wait(lambda: not button.size().isEmpty())
        QTest.mouseClick(button, Qt.MouseButton.LeftButton)

    def message(self, field):
        """What is said at a field."""
        return self.form.marks.message(field)

    # --- the map

    def look_at(self, crs, rectangle):
        """Set the project's CRS and what the map shows."""
        QgsProject.instance().setCrs(QgsCoordinateReferenceSystem(crs))
        self.canvas.setExtent(QgsRectangle(*rectangle))
        self.canvas.waitWhileRendering()

    def zoom_to_box(self, box):
        """Have the plugin show an area: the map goes there once it has got its layers, and maybe another CRS."""

        def is_there():
            wanted, shown = self.session.background.rectangle(box), self.canvas.extent()
            return shown.contains(wanted) and shown.width() < 3 * wanted.width()

        self.session.zoom_to_box(box)
        self.wait(is_there)
        self.canvas.waitWhileRendering()

    def move(self, at: QPoint, held=Qt.MouseButton.NoButton):
        """Move the pointer over the map, with a button held down or without.

        The map is told itself: the screen's pointer joins moves that come at once, and none leads to where it is.
        """
        viewport = self.canvas.viewport()
        there = QPointF(viewport.mapToGlobal(at))
        event = QMouseEvent(
            QEvent.Type.MouseMove,
            QPointF(at),
            there,
            Qt.MouseButton.NoButton,
            held,
            Qt.KeyboardModifier.NoModifier,
        )
        QgsApplication.sendEvent(viewport, event)

    def drag(self, start: QPoint, end: QPoint):
        """Press, move and release the left button over the map."""
        viewport = self.canvas.viewport()
        QTest.mousePress(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, start)
        for share in (0.25, 0.5, 0.75, 1.0):
            QTest.mouseMove(viewport, start + (end - start) * share)
        QTest.mouseRelease(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, end)

    def click_map(self, at: QPoint):
        viewport = self.canvas.viewport()
        QTest.mouseClick(viewport, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, at)

    def at(self, share_x, share_y):
        """Pixel of the map at shares of its width and height."""
        return QPoint(int(self.canvas.width() * share_x), int(self.canvas.height() * share_y))

    # --- waiting

    def wait(self, condition):
        self.qtbot.waitUntil(condition, timeout=PATIENCE_MS)

    def wait_steady(self, value, rest_s=STEADY_S):
        """Wait until ``value()`` has come to rest; returns it."""
        last, since_s = value(), time.monotonic()

        def steady():
            nonlocal last, since_s
            if (now := value()) != last:
                last, since_s = now, time.monotonic()
            return time.monotonic() - since_s > rest_s

        self.wait(steady)
        return last

    def wait_planned(self):
        """Wait until the figures are those of what is entered."""
        self.wait(lambda: not (self.session.planner.busy or self.session.preview.busy))
        return self.session.planned

    def wait_previewed(self):
        """Wait until the preview is whole."""
        self.wait(lambda: self.session.preview.shown and not self.session.preview.busy)

    def wait_for_run(self):
        self.wait(lambda: self.session.runs.task is None)

    def wait_for_tasks(self):
        # One that is no longer active has still to tell its end: then the manager lets it go.
        self.wait(lambda: QgsApplication.taskManager().count() == 0)

    # --- what is there

    def messages(self):
        """Texts in the message bar."""
        return [item.text() for item in self.iface.messageBar().items()]

    def buttons_in_message_bar(self):
        """Buttons of the plugin's latest message; QGIS may have put one of its own on top."""
        item = next((item for item in self.iface.messageBar().items() if item.title() == "TerrAInav"), None)
        return {button.text(): button for button in item.findChildren(QPushButton)} if item else {}

    def group(self):
        """The mission's group in the layer tree, and that there is only one."""
        root = QgsProject.instance().layerTreeRoot()
        groups = [group for group in root.findGroups(True) if group.name().startswith("TerrAInav")]
        assert len(groups) <= 1, [group.name() for group in groups]
        return groups[0] if groups else None

    def layer_names(self):
        group = self.group()
        return [node.name() for node in group.findLayers()] if group else []

    def layer(self, name):
        """Layer of the mission's group."""
        return next(node.layer() for node in self.group().findLayers() if node.name() == name)
