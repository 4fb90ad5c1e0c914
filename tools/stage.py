"""Actions of scripts in the real QGIS: wait, click, type, drag, and take pictures of the screen."""

from __future__ import annotations

import time
from collections.abc import Callable

from qgis.core import QgsProject
from qgis.PyQt.QtCore import QEventLoop, QPoint, QRect, Qt, QTimer
from qgis.PyQt.QtGui import QPixmap
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAbstractButton, QComboBox, QLineEdit, QWidget
from qgis.utils import iface

#: Longest wait: a capture may take minutes on a slow machine, everything else takes much less.
PATIENCE_S = 900
POLL_MS = 20
_LEFT = Qt.MouseButton.LeftButton
_PLAIN = Qt.KeyboardModifier.NoModifier


class StageError(Exception):
    """A step failed, or had a wrong result."""


def wait(what: str, condition: Callable[[], bool]) -> None:
    """Let the application run until ``condition`` holds."""
    loop, timer, started, held = QEventLoop(), QTimer(), time.monotonic(), [False]

    def look() -> None:
        # Kept, as the condition may not hold for long: the map, for one, may soon be drawn again.
        held[0] = condition()
        if held[0] or time.monotonic() - started > PATIENCE_S:
            loop.quit()

    timer.timeout.connect(look)
    timer.start(POLL_MS)
    loop.exec()
    timer.stop()
    if not held[0]:
        raise StageError(f"{what}: nothing after {PATIENCE_S} s")


def wait_until_drawn() -> None:
    """Wait until the map is drawn and its widgets are painted."""
    canvas = iface.mapCanvas()
    if not canvas.layers():
        # Without layers nothing is drawn, and no signal is sent.
        QTest.qWait(10 * POLL_MS)
        return
    # QGIS prints "Image is a null image" (QgsRasterDrawer::drawImage) if the drawing of a raster is interrupted.
    wait("drawing the map", lambda: not canvas.isDrawing())
    drawn: list[bool] = []

    def note() -> None:
        drawn.append(True)

    canvas.mapCanvasRefreshed.connect(note)
    canvas.refreshAllLayers()
    wait("drawing the map", lambda: bool(drawn) and not canvas.isDrawing())
    canvas.mapCanvasRefreshed.disconnect(note)
    QTest.qWait(10 * POLL_MS)


def tidy_messages() -> None:
    """Remove QGIS's messages about tasks, which it shows where the desktop has no notifications."""
    bar = iface.messageBar()
    for item in bar.items():
        if item.title() != "TerrAInav":
            bar.popWidget(item)


def layer_names() -> list[str]:
    """Names of the project's layers."""
    return [layer.name() for layer in QgsProject.instance().mapLayers().values()]


# --- mouse and keyboard


def click(button: QAbstractButton) -> None:
    """Press a button with the mouse."""
    if not (button.isVisible() and button.isEnabled()):
        raise StageError(f"button {button.objectName() or button.text()}: cannot be pressed")
    QTest.mouseClick(button, _LEFT)


def enter(field: QWidget, text: str) -> None:
    """Replace the content of a text field or a spin box, key by key, and leave the field."""
    edit = field if isinstance(field, QLineEdit) else field.findChild(QLineEdit)
    edit.setFocus()
    edit.selectAll()
    QTest.keyClicks(edit, text)
    QTest.keyClick(edit, Qt.Key.Key_Tab)


def choose(combo: QComboBox, value: object) -> None:
    """Choose an entry by its data."""
    index = combo.findData(value)
    if index < 0:
        raise StageError(f"chooser {combo.objectName()}: has no {value!r}")
    combo.setCurrentIndex(index)
    combo.activated.emit(index)


def at(share_x: float, share_y: float) -> QPoint:
    """Pixel of the map at shares of its width and height."""
    canvas = iface.mapCanvas()
    return QPoint(int(canvas.width() * share_x), int(canvas.height() * share_y))


def press_map(start: QPoint, end: QPoint) -> None:
    """Press the left button over the map and drag, without releasing it."""
    viewport = iface.mapCanvas().viewport()
    QTest.mousePress(viewport, _LEFT, _PLAIN, start)
    for share in (0.25, 0.5, 0.75, 1.0):
        QTest.mouseMove(viewport, start + (end - start) * share)
        QTest.qWait(POLL_MS)


def release_map(end: QPoint) -> None:
    """Release the left button."""
    QTest.mouseRelease(iface.mapCanvas().viewport(), _LEFT, _PLAIN, end)


def click_map(place: QPoint) -> None:
    """Move the pointer to a place on the map and click."""
    viewport = iface.mapCanvas().viewport()
    QTest.mouseMove(viewport, place)
    QTest.mouseClick(viewport, _LEFT, _PLAIN, place)


def right_click_map(place: QPoint) -> None:
    """Click the map with the right button."""
    viewport = iface.mapCanvas().viewport()
    QTest.mouseMove(viewport, place)
    QTest.mouseClick(viewport, Qt.MouseButton.RightButton, _PLAIN, place)


def press_key(key: Qt.Key) -> None:
    """Press a key over the map."""
    QTest.keyClick(iface.mapCanvas(), key)


# --- pictures


def window_picture() -> QPixmap:
    """QGIS's whole window."""
    return iface.mainWindow().grab()


def screen_picture(part: QRect) -> QPixmap:
    """Part of the screen, with menus, lists and dialogs above the windows."""
    screen = iface.mainWindow().screen()
    return screen.grabWindow(0, part.x(), part.y(), part.width(), part.height())
