"""The guide as the plugin shows it: its pictures, its links, and what is there when it is opened again."""

from __future__ import annotations

from pathlib import Path

import pytest
from qgis.PyQt.QtCore import QUrl
from qgis.PyQt.QtGui import QDesktopServices, QImage, QTextFormat
from terrainav.terrainav_plugin import help as help_module
from terrainav.terrainav_plugin.help import _OPEN

from tests.plugin.steps import PATIENCE_MS

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def window(plugin, qtbot):

    help_module.show_help()
    (shown,) = _OPEN
    yield shown
    help_module.close_help()


def pictures(window):
    """Names of the pictures in the order of the text, and their widths as they are shown."""
    found = {}
    block = window.document().begin()
    while block.isValid():
        place = block.begin()
        while not place.atEnd():
            form = place.fragment().charFormat()
            if form.objectType() == QTextFormat.ObjectTypes.ImageObject:
                name = form.toImageFormat().name()
                found[name] = window.loadResource(2, QUrl(name)).width()
            place += 1
        block = block.next()
    return found


def test_pictures_are_as_wide_as_the_window_lets_them(window, qtbot, screenshot):
    for width in (600, 1000):
        window.resize(width, 700)
        qtbot.waitUntil(
            lambda: window._fitted_px == window.viewport().width() and not window._fit_soon.isActive(),
            timeout=PATIENCE_MS,
        )
        shown = pictures(window)
        assert len(shown) > 10
        for name, found in shown.items():
            own = QImage(str(ROOT / "docs" / name)).width()
            assert 0 < found <= min(own, window.viewport().width())
            assert found == own or found > 0.9 * window.viewport().width()
        assert not window.horizontalScrollBar().isVisible()
        screenshot(f"guide-{width}", window)


def test_opened_again_it_reads_the_same(window):
    first = window.document().toHtml()
    for topic in ("sources", "settings", ""):
        help_module.show_help(topic)
    assert window.document().toHtml() == first


@pytest.mark.parametrize("topic", ["sources", "settings"])
def test_help_buttons_lead_to_their_headings(window, topic):
    help_module.show_help(topic)
    below = window.cursorForPosition(window.viewport().rect().topLeft()).block()
    assert below.text().lower() == topic


def test_pages_that_are_not_installed_are_opened_at_the_homepage(window, monkeypatch, tmp_path):
    opened = []
    monkeypatch.setattr(QDesktopServices, "openUrl", lambda url: opened.append(url.toString()))
    page = tmp_path / "guide.md"
    page.write_text("# Guide\n\n[Method](method.md)\n", encoding="utf-8")
    window.load(page)
    window.anchorClicked.emit(QUrl("method.md"))
    assert opened == ["https://github.com/terrainav/terrainav/blob/HEAD/docs/method.md"]
