"""Alt and the underlined letter: in QGIS's own window, beside its menus."""

from __future__ import annotations

import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QKeySequence
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAbstractButton, QApplication, QLabel, QMenu, QMenuBar, QPushButton, QWidget
from terrainav.terrainav_plugin.widgets import mnemonic_key, remove_menu_mnemonics

from tests.support.thinning import sampled

#: Entries of the panel that have a letter: as many as there are letters that no menu has.
IN_THE_PANEL = {
    "Area from": "F",
    "Draw box": "B",
    "Camera": "A",
    "Field of view": "I",
    "Aspect ratio": "T",
    "Image's longer side": "N",
    "Height above ground": "U",
    "GSD": "G",
    "Layout": "Y",
}


def underlined(panel):
    """Parts of a panel with an underlined letter, by the letter."""
    found = {}
    for widget in [*panel.findChildren(QLabel), *panel.findChildren(QAbstractButton)]:
        if isinstance(widget, QLabel) and widget.buddy() is None:
            continue
        letter = mnemonic_key(widget.text()).rpartition("+")[2]
        if letter:
            assert letter not in found, (widget.text(), found[letter].text())
            found[letter] = widget
    return found


def press_alt(window, letter):
    QTest.keyClick(window.focusWidget() or window, QKeySequence(letter)[0], Qt.KeyboardModifier.AltModifier)


@pytest.fixture
def window(desk, iface):
    window = iface.mainWindow()
    window.activateWindow()
    desk.wait(window.isActiveWindow)
    for box in desk.form.boxes:
        box.setCollapsed(False)
    yield window
    for box in desk.form.boxes:
        box.setCollapsed(box in desk.form.sections)


def test_the_panel_has_the_letters_that_are_free(desk):
    assert {widget.text().replace("&", ""): letter for letter, widget in underlined(desk.dock).items()} == IN_THE_PANEL


@pytest.mark.parametrize("name", sampled(sorted(set(IN_THE_PANEL) - {"Draw box", "Area from"}), 3))
def test_letter_goes_to_its_entry(desk, window, name):
    label = underlined(desk.dock)[IN_THE_PANEL[name]]
    # Groups that have just been unfolded are laid out a while later: before, their letters do nothing.
    desk.wait(lambda: label.isVisible() and not label.size().isEmpty())
    desk.form.edges["north"].setFocus()
    desk.wait(desk.form.edges["north"].hasFocus)
    press_alt(window, IN_THE_PANEL[name])
    desk.wait(lambda: QApplication.focusWidget() not in (None, desk.form.edges["north"]))
    there = QApplication.focusWidget()
    assert QApplication.activePopupWidget() is None
    assert label.buddy().isAncestorOf(there)
    # What has the keyboard takes it: a number or a choice, and no mere holder.
    assert there.focusPolicy() & Qt.FocusPolicy.TabFocus
    assert there.focusProxy() is None


def test_letter_presses_its_button(desk, ground, window):
    desk.form.edges["north"].setFocus()
    desk.wait(desk.form.edges["north"].hasFocus)
    press_alt(window, IN_THE_PANEL["Draw box"])
    desk.wait(desk.session.box_tool.isActive)
    desk.session.box_tool.stop()


def test_letters_of_menus_still_open_them(desk, window, iface):
    menus = iface.mainWindow().menuBar()
    taken = {mnemonic_key(action.text()) for action in menus.actions() if action.isVisible()}
    assert taken
    assert not taken & {f"Alt+{letter}" for letter in underlined(desk.dock)}


def test_other_panels_have_free_letters_too(desk, iface):
    menus = iface.mainWindow().menuBar()
    taken = {mnemonic_key(action.text()).rpartition("+")[2] for action in menus.actions() if action.isVisible()}
    desk.session.datasets.open()
    panel = desk.session.datasets.window
    try:
        letters = set(underlined(panel))
        assert letters == {"A", "F", "K", "N", "T", "U", "X", "Y"}
        assert not letters & taken
    finally:
        panel.setUserVisible(False)


def test_letters_that_a_plugin_s_menu_takes_are_given_back(qtbot):
    panel, menus = QWidget(), QMenuBar()
    qtbot.addWidget(panel)
    qtbot.addWidget(menus)
    menus.addMenu(QMenu("&Zebra", menus))
    buttons = [QPushButton(text, panel) for text in ("&Zoo", "&Yak", "E&yot", "Plain")]
    remove_menu_mnemonics(panel, menus)
    assert [button.text() for button in buttons] == ["Zoo", "&Yak", "Eyot", "Plain"]
