"""Alt and a letter: in QGIS's own window, beside its menus."""

from __future__ import annotations

import pytest
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QKeySequence
from qgis.PyQt.QtTest import QTest
from qgis.PyQt.QtWidgets import QAbstractButton, QApplication, QLabel, QMenu, QMenuBar, QPushButton, QWidget
from terrainav.terrainav_plugin.panel.keyboard import is_keyless
from terrainav.terrainav_plugin.widgets import menu_keys, mnemonic_key, remove_menu_mnemonics


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


def press_alt(window, key):
    shift, _, letter = key.rpartition("+")
    with_shift = Qt.KeyboardModifier.ShiftModifier if shift else Qt.KeyboardModifier.NoModifier
    focus = window.focusWidget() or window
    QTest.keyClick(focus, QKeySequence(letter)[0], Qt.KeyboardModifier.AltModifier | with_shift)


@pytest.fixture
def window(desk, iface):
    window = iface.mainWindow()
    window.activateWindow()
    desk.wait(window.isActiveWindow)
    return window


def seen_keys(desk):
    """Keys of what is seen, each with its target."""
    return [(key, target) for target, key in desk.dock.letters.keys if target.part.isVisible()]


@pytest.mark.parametrize("number", range(4))
def test_every_button_and_entry_that_is_seen_has_a_letter_of_its_own(desk, window, number):
    form, dock = desk.form, desk.dock
    form.pages.setCurrentIndex(number)
    page = form.pages.currentWidget()
    for section in [one for one in form.sections if page.isAncestorOf(one)] or [None]:
        if section is not None:
            for other in form.sections:
                other.setCollapsed(other is not section)
        desk.wait_steady(page.widget().height)
        keys = [key for key, _ in seen_keys(desk)]
        assert len(keys) == len(set(keys))
        parts = {id(target.part) for _, target in seen_keys(desk)}
        buttons = [
            one
            for one in dock.widget().findChildren(QAbstractButton)
            # Parts of entries, and those with keys of their own.
            if one.isVisible()
            and one.objectName() not in ("undo_area", "redo_area")
            and one.text() + one.toolTip()
            # Only Tab leads to coefficients.
            and not is_keyless(one)
        ]
        ours = [one for one in buttons if one.focusPolicy() & Qt.FocusPolicy.TabFocus]
        assert [one.objectName() or one.text() for one in ours if id(one) not in parts] == []
        labels = [one for one in page.findChildren(QLabel) if one.isVisible() and one.buddy() is not None]
        labels = [one for one in labels if not is_keyless(one)]
        # Those of ticks lead to the first tick, which has a letter.
        nameless = {one.text() for one in labels if id(one) not in parts}
        assert nameless <= {"Map types", "Products"}
    for section in form.sections:
        section.setCollapsed(True)


def test_letters_lead_to_their_entries_also_those_of_menus(desk, window):
    form = desk.form
    form.pages.setCurrentIndex(1)
    desk.wait_steady(form.pages.currentWidget().widget().height)
    menus = menu_keys(window.menuBar())
    labels = {
        target.text.replace("&", ""): (key, target)
        for key, target in seen_keys(desk)
        if isinstance(target.part, QLabel) and form.flight.isAncestorOf(target.part)
    }
    assert {"GSD", "Overlap", "Layout", "Height above ground", "Airspeed"} <= set(labels)
    before = desk.session.state()
    for key, target in labels.values():
        form.camera.setFocus()
        desk.wait(form.camera.hasFocus)
        press_alt(window, key)
        there = QApplication.focusWidget()
        assert target.part.buddy().isAncestorOf(there) or target.part.buddy() is there
        # What has the keyboard takes it: a number or a choice, and no mere holder.
        assert there.focusPolicy() & Qt.FocusPolicy.TabFocus
        assert there.focusProxy() is None
        assert QApplication.activePopupWidget() is None
    # No letter was typed.
    assert desk.session.state() == before
    assert {key for key, _ in labels.values()} & menus


def test_where_letters_are_taken_shift_leads_there(desk, window):
    form = desk.form
    form.pages.setCurrentIndex(3)
    form.route.setCollapsed(False)
    desk.wait_steady(form.pages.currentWidget().widget().height)
    with_shift = [(key, target) for key, target in seen_keys(desk) if key.startswith("Shift+")]
    key, target = next(one for one in with_shift if isinstance(one[1].part, QAbstractButton))
    form.route.entries["margin_m"].setFocus()
    desk.wait(form.route.entries["margin_m"].hasFocus)
    begun = []
    target.part.clicked.connect(lambda: begun.append(True))
    press_alt(window, key)
    desk.wait(lambda: bool(begun))
    assert key in target.part.toolTip()
    form.route.setCollapsed(True)


def test_letters_open_tabs_and_press_buttons(desk, window):
    tabs = {target.text: key for key, target in seen_keys(desk) if target.part is desk.form.pages.tabBar()}
    desk.form.edges["north"].setFocus()
    desk.wait(desk.form.edges["north"].hasFocus)
    press_alt(window, tabs["Imagery"])
    assert desk.form.pages.currentIndex() == 2
    press_alt(window, tabs["Area"])
    assert desk.form.pages.currentIndex() == 0
    keys = {target.part: key for key, target in seen_keys(desk)}
    press_alt(window, keys[desk.form.draw_box])
    desk.wait(desk.session.box_tool.isActive)
    desk.session.box_tool.stop()
    desk.form.edges["north"].setFocus()
    press_alt(window, keys[desk.dock.capture])
    desk.wait(lambda: any("Nothing to capture yet" in text for text in desk.messages()))


def test_the_letter_of_a_tab_brings_the_keyboard_into_the_panel(desk, window, iface):
    """From elsewhere in the window, so that the letters that menus have, too, lead into the panel next."""
    keys = {target.text: key for key, target in seen_keys(desk) if target.part is desk.form.pages.tabBar()}
    desk.form.pages.setCurrentIndex(2)
    iface.mapCanvas().setFocus()
    desk.wait(iface.mapCanvas().hasFocus)
    press_alt(window, keys["Area"])
    assert desk.form.pages.currentIndex() == 0
    assert QApplication.focusWidget() is desk.form.pages.tabBar()
    letters = {target.text.replace("&", ""): key for key, target in seen_keys(desk)}
    press_alt(window, letters["North"])
    assert QApplication.focusWidget() is desk.form.edges["north"]
    assert QApplication.activePopupWidget() is None


def test_letters_of_menus_still_open_them(desk, window):
    taken = menu_keys(window.menuBar())
    assert taken
    shown = [*desk.dock.findChildren(QLabel), *desk.dock.findChildren(QAbstractButton)]
    for part in shown:
        # A label's letter is the text's; a button's can be taken off.
        text = part.shortcut().toString() if isinstance(part, QAbstractButton) else mnemonic_key(part.text())
        assert text.rpartition("+")[2] not in taken, part.text()
    bar = desk.form.pages.tabBar()
    assert not taken & {mnemonic_key(bar.tabText(number)).rpartition("+")[2] for number in range(bar.count())}


def test_other_panels_have_free_letters_too(desk, iface):
    taken = menu_keys(iface.mainWindow().menuBar())
    desk.session.datasets.open()
    panel = desk.session.datasets.window
    try:
        letters = set(underlined(panel))
        assert letters == {"A", "F", "K", "N", "T", "U", "X", "Y"}
        assert not letters & taken
    finally:
        panel.setUserVisible(False)


def test_letters_of_the_panel_rest_while_another_is_in_front_of_it(desk, window, iface):
    """Qt takes a dock behind another one for visible, so its letters would lead into what nobody sees."""
    texts = [button.text() for button in desk.dock.findChildren(QAbstractButton)]
    shortcuts = [button.shortcut() for button in desk.dock.findChildren(QAbstractButton)]
    keys = dict(seen_keys(desk))
    desk.session.datasets.open()
    panel = desk.session.datasets.window
    try:
        desk.wait(lambda: panel.isUserVisible() and not desk.dock.isUserVisible())
        page = desk.form.pages.currentIndex()
        for key, target in keys.items():
            iface.mapCanvas().setFocus()
            press_alt(window, key)
            assert desk.form.pages.currentIndex() == page, key
            assert not desk.dock.isAncestorOf(QApplication.focusWidget()), (key, target.text)
            if QApplication.activePopupWidget() is not None:
                QApplication.activePopupWidget().close()
        iface.mapCanvas().setFocus()
        press_alt(window, "F")
        assert panel.folder.isAncestorOf(QApplication.focusWidget())
        # Also if the keyboard has stayed in the panel.
        desk.dock.capture.setFocus()
        press_alt(window, "F")
        assert panel.folder.isAncestorOf(QApplication.focusWidget())
    finally:
        panel.setUserVisible(False)
    desk.wait(desk.dock.isUserVisible)
    assert [button.text() for button in desk.dock.findChildren(QAbstractButton)] == texts
    assert [button.shortcut() for button in desk.dock.findChildren(QAbstractButton)] == shortcuts
    iface.mapCanvas().setFocus()
    tab = next(key for key, target in keys.items() if target.text.replace("&", "") == "Imagery")
    press_alt(window, tab)
    assert desk.form.pages.currentIndex() == 2


def test_letters_that_a_plugin_s_menu_takes_are_given_back(qtbot):
    panel, menus = QWidget(), QMenuBar()
    qtbot.addWidget(panel)
    qtbot.addWidget(menus)
    menus.addMenu(QMenu("&Zebra", menus))
    buttons = [QPushButton(text, panel) for text in ("&Zoo", "&Yak", "E&yot", "Plain")]
    remove_menu_mnemonics(panel, menus)
    assert [button.text() for button in buttons] == ["Zoo", "&Yak", "Eyot", "Plain"]
