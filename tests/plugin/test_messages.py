"""Messages over the map: whole at any width, and nothing beside them gives way."""

from __future__ import annotations

import contextlib
import logging
import threading

import pytest
from qgis.core import Qgis, QgsApplication
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QDockWidget, QPushButton, QTextBrowser
from terrainav.core.errors import PartError
from terrainav.core.external.unexpected import UnexpectedErrors

from tests.plugin.steps import PATIENCE_MS
from tests.support.thinning import sampled

SMALL_PX, WIDE_PX = (1280, 720), (1600, 950)
TEXTS = (
    "mission-1: stopped with 18 of 93 images.",
    "mission-1: 12 of 93 images could not be captured (tile 18/65612/103456: the server answers 404; asked thrice).",
)


def widths(window):
    """Widths of the window and of its panels."""
    return [window.width(), *(panel.width() for panel in window.findChildren(QDockWidget))]


@pytest.fixture(params=[SMALL_PX, WIDE_PX], ids=["small", "wide"])
def window(desk, iface, request):
    """QGIS's window in a size, with the panel and that of the layers."""
    window, before = iface.mainWindow(), iface.mainWindow().geometry()
    was_maximized = window.isMaximized()
    window.showNormal()
    window.resize(*request.param)
    desk.wait_steady(lambda: widths(window))
    yield window
    window.setGeometry(before)
    if was_maximized:
        window.showMaximized()
    desk.wait_steady(lambda: widths(window))


@pytest.mark.parametrize("text", sampled(TEXTS, 2))
@pytest.mark.parametrize("buttons", sampled([0, 1, 2], 2))
def test_message_is_whole_and_takes_no_room_from_the_panels(desk, window, iface, text, buttons):
    panels = [window.findChild(QDockWidget, "Layers"), desk.dock]
    before = [panel.width() for panel in panels]
    action = ("Capture only the failed ones", lambda: None) if buttons else None
    desk.plugin.messages.warning(text, "the details" if buttons == 2 else "", action)
    (item,) = (item for item in iface.messageBar().items() if item.title() == "TerrAInav")
    shown = item.findChild(QTextBrowser)
    desk.wait_steady(lambda: (shown.viewport().height(), *(panel.width() for panel in panels)))
    assert shown.viewport().height() >= shown.document().size().height()
    assert shown.document().size().width() <= shown.viewport().width()
    for button in item.findChildren(QPushButton):
        assert button.width() >= button.minimumSizeHint().width()
        assert item.rect().contains(button.mapTo(item, button.rect().bottomRight()))
    assert [panel.width() for panel in panels] == before


def test_what_the_core_logs_stands_in_the_log_panel_until_the_plugin_goes(plugin, qtbot):
    heard = []
    received = QgsApplication.messageLog().messageReceived[str, str, Qgis.MessageLevel]

    def hear(text, tag, level):
        heard.append((text, tag, level))

    def work():
        failures = UnexpectedErrors()
        for _ in range(3):
            with contextlib.suppress(PartError):
                try:
                    raise ZeroDivisionError("of a tile")
                except ZeroDivisionError as wrong:
                    raise failures.failure(wrong) from wrong

    received.connect(hear)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        qtbot.waitUntil(lambda: bool(heard), timeout=PATIENCE_MS)
        thread.join()
        QTest.qWait(50)  # for what should not come
        ((text, tag, level),) = heard
        assert "Traceback" in text
        assert "ZeroDivisionError: of a tile" in text
        assert (tag, level) == ("TerrAInav", Qgis.MessageLevel.Critical)
    finally:
        received.disconnect(hear)
    assert logging.getLogger("terrainav").handlers == [plugin._log]
    plugin.unload()
    assert logging.getLogger("terrainav").handlers == []
    plugin.initGui()
