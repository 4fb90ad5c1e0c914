"""The panel by keyboard: Tab in reading order, and Alt with a letter for every button and entry."""

from __future__ import annotations

import html
import string
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from qgis.gui import QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QEvent, QObject, Qt
from qgis.PyQt.QtGui import QKeyEvent, QKeySequence
from qgis.PyQt.QtWidgets import (
    QAbstractButton,
    QApplication,
    QCheckBox,
    QGridLayout,
    QGroupBox,
    QLabel,
    QLayout,
    QLayoutItem,
    QPushButton,
    QScrollArea,
    QTabBar,
    QTabWidget,
    QToolButton,
    QWidget,
)

from ..plain import shown_plain

#: Keys of buttons without a text, and of texts without a free letter.
_DIGITS = string.digits[1:] + "0"
#: Keys beside Alt where all digits and letters are taken.
_SHIFT = "Shift+"
_WITH_SHIFT = tuple(_SHIFT + letter for letter in string.ascii_uppercase)
#: Modifiers of keys that lead somewhere.
_ALT = Qt.KeyboardModifier.AltModifier
_ALT_SHIFT = _ALT | Qt.KeyboardModifier.ShiftModifier
#: Property of what holds entries that only Tab leads to, as they are too many for letters.
KEYLESS = "keyless"
#: Objects with keys of their own.
_OWN_KEYS = ("undo_area", "redo_area")


def is_keyless(widget: QWidget | None) -> bool:
    """Whether a widget lies in one that is `KEYLESS`."""
    while widget is not None and not widget.property(KEYLESS):
        widget = widget.parentWidget()
    return widget is not None


def ordered_widgets(layout: QLayout) -> Iterator[QWidget]:
    """Widgets of a layout and of those inside it, row by row."""
    for item in _items(layout):
        widget, inner = item.widget(), item.layout()
        if widget is not None:
            yield widget
            yield from _parts(widget)
            inner = widget.layout()
        if inner is not None:
            yield from ordered_widgets(inner)


def _parts(widget: QWidget) -> Iterator[QWidget]:
    """Widgets that a widget holds without a layout."""
    if isinstance(widget, QTabWidget):
        yield widget.tabBar()
        for number in range(widget.count()):
            yield from _parts(widget.widget(number))
    elif isinstance(widget, QScrollArea):
        yield from ordered_widgets(widget.widget().layout())
    elif isinstance(widget, QgsCollapsibleGroupBoxBasic):
        fold = fold_button(widget)
        if fold is not None:
            yield fold


def fold_button(box: QgsCollapsibleGroupBoxBasic) -> QToolButton | None:
    """Button of a group that folds it; None without QGIS."""
    return box.findChild(QToolButton, "collapseButton", Qt.FindChildOption.FindDirectChildrenOnly)


def _items(layout: QLayout) -> list[QLayoutItem]:
    """Items of a layout; the items of a grid are ordered by row and column."""
    numbers = range(layout.count())
    if isinstance(layout, QGridLayout):
        places = sorted((layout.getItemPosition(number)[:2], number) for number in numbers)
        numbers = [number for _, number in places]
    return [layout.itemAt(number) for number in numbers]


def next_widget(panel: QWidget, forward: bool) -> QWidget | None:
    """Widget to which Tab leads within a panel; None at its end."""
    stops = [widget for widget in ordered_widgets(panel.layout()) if _is_stop(widget)]
    stops = stops if forward else stops[::-1]
    focus = QApplication.focusWidget()
    while focus is not None and focus not in stops:
        focus = focus.parentWidget()
    return None if focus is None else next(iter(stops[stops.index(focus) + 1 :]), None)


def widget_outside(panel: QWidget, forward: bool) -> QWidget | None:
    """Widget of the window to which Tab leads from the end of a panel."""
    start = QApplication.focusWidget()
    widget = start
    while widget is not None:
        widget = widget.nextInFocusChain() if forward else widget.previousInFocusChain()
        if widget is start:
            return None
        is_inside = panel is widget or panel.isAncestorOf(widget)
        if not is_inside and widget.window() is panel.window() and _is_stop(widget):
            return widget
    return None


def _is_stop(widget: QWidget) -> bool:
    """Whether Tab stops at a widget."""
    if widget.focusProxy() is not None or not widget.isVisible() or not widget.isEnabled():
        return False
    # Not at texts that can only be selected, nor at groups that have nothing to tick.
    if isinstance(widget, QLabel) and "<a " not in widget.text():
        return False
    if isinstance(widget, QGroupBox) and not widget.isCheckable():
        return False
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)


@dataclass(frozen=True)
class Target:
    """What a letter leads to.

    Parameters
    ----------
    part : QWidget
        Widget that has the text.
    text : str
        Text, with the underlined letter that its author prefers, if any.
    show : callable
        Underlines a letter of the text; takes the key, and whether a menu has the same letter.
    act : callable
        Goes there.
    hear : callable
        Lets Qt go there from everywhere in the window, or not; takes which.
    """

    part: QWidget
    text: str
    show: Callable[[str, bool], None]
    act: Callable[[], None]
    hear: Callable[[bool], None]

    def letters(self) -> list[str]:
        """Letters of the text, the best first."""
        plain = self.text.replace("&", "")
        preferred = QKeySequence.mnemonic(self.text).toString().rpartition("+")[2]
        begins = "".join(word[0] for word in plain.split())
        letters = [one for one in (preferred + begins + plain).upper() if one in string.ascii_uppercase]
        return list(dict.fromkeys(letters))


class Letters(QObject):
    """Letters of a panel's buttons and entries.

    Letters that QGIS's menus have, too, lead into the panel while the keyboard is in it; the others do so from
    everywhere in the window.

    Parameters
    ----------
    panel : QWidget
    pages : QTabWidget
        Pages of which one is seen at a time. The sections of the last page are seen one at a time.
    menu_keys : set of str
        Letters of the window's menus.
    """

    def __init__(self, panel: QWidget, pages: QTabWidget, sections: Sequence[QWidget], menu_keys: set[str]) -> None:
        super().__init__(panel)
        self._panel, self._menu_keys = panel, menu_keys
        widgets = [one for one in ordered_widgets(panel.layout()) if not is_keyless(one)]
        targets = [target for widget in widgets for target in _targets(widget)]
        always: list[Target] = []
        on_page: dict[QWidget, list[Target]] = {pages.widget(number): [] for number in range(pages.count())}
        in_section: dict[QWidget, list[Target]] = {section: [] for section in sections}
        for target in targets:
            section = next((one for one in sections if _holds(one, target.part)), None)
            page = next((one for one in on_page if one.isAncestorOf(target.part)), None)
            (always if page is None else on_page[page] if section is None else in_section[section]).append(target)
        #: Target and key.
        self.keys: list[tuple[Target, str]] = []
        self._taken: dict[int, str] = {}
        # The largest page first, as it leaves the fewest letters to the parts that are always seen.
        for on_one in sorted(on_page.values(), key=len, reverse=True):
            self._assign([*always, *on_one])
        for page, on_one in on_page.items():
            for section, own in in_section.items():
                if page.isAncestorOf(section):
                    self._assign([*always, *on_one, *own])
        self._is_heard = True
        self._pressed: Callable[[], None] | None = None
        pages.tabBar().installEventFilter(self)

    def _assign(self, targets: Sequence[Target]) -> None:
        """Give targets that are seen together different keys; those that have one keep it."""
        found = _matched(targets, self._taken, self._menu_keys)
        for target in targets:
            key = found.get(id(target))
            if key is not None and id(target) not in self._taken:
                target.show(key, key in self._menu_keys)
                self.keys.append((target, key))
                self._taken[id(target)] = key

    def hear(self, heard: bool) -> None:
        """Let Qt go where the letters lead, or not: a panel behind another one is still visible to Qt."""
        self._is_heard = heard
        for target, key in self.keys:
            # Qt has no shortcuts for letters of menus.
            if key not in self._menu_keys:
                target.hear(heard)

    def override(self, event: QKeyEvent) -> bool:
        """Whether a key with Alt leads to a part of the panel that is seen; the press of the key then goes there."""
        # A panel that another one has covered may still have the keyboard.
        is_letter = event.modifiers() in (_ALT, _ALT_SHIFT) and 0x20 < event.key() < 0x7F
        if not (self._is_heard and is_letter):
            return False
        key = (_SHIFT if event.modifiers() == _ALT_SHIFT else "") + chr(event.key()).upper()
        acts = [target.act for target, own in self.keys if own == key and target.part.isVisible()]
        focus = QApplication.focusWidget()
        if not acts or focus is None:
            return False
        self._pressed = acts[0]
        # Before the widget, which would take the letter as typed.
        focus.installEventFilter(self)
        return True

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Go where the pressed key leads; the letter of a tab moves the keyboard there, which Qt does not."""
        if event.type() == QEvent.Type.Shortcut and isinstance(watched, QTabBar):
            watched.setFocus(Qt.FocusReason.ShortcutFocusReason)
            return False
        if event.type() != QEvent.Type.KeyPress or self._pressed is None:
            return super().eventFilter(watched, event)
        if not isinstance(watched, QTabBar):
            watched.removeEventFilter(self)
        act, self._pressed = self._pressed, None
        if not isinstance(event, QKeyEvent) or event.modifiers() not in (_ALT, _ALT_SHIFT):
            return super().eventFilter(watched, event)
        act()
        return True


def _holds(section: QWidget, part: QWidget) -> bool:
    """Whether a part is seen only while its section is unfolded."""
    is_fold = isinstance(section, QgsCollapsibleGroupBoxBasic) and part is fold_button(section)
    return section.isAncestorOf(part) and not is_fold


def _matched(targets: Sequence[Target], pinned: dict[int, str], menu_keys: set[str]) -> dict[int, str]:
    """Key of each target, all different, by augmenting paths; those pinned keep theirs."""
    owners: dict[str, Target] = {}
    for target in targets:
        if id(target) in pinned:
            owners[pinned[id(target)]] = target

    def place(target: Target, tried: set[str]) -> bool:
        for key in target.letters():
            # Tabs cannot share a letter with a menu.
            if key in tried or (isinstance(target.part, QTabBar) and key in menu_keys):
                continue
            tried.add(key)
            owner = owners.get(key)
            if owner is None or (id(owner) not in pinned and place(owner, tried)):
                owners[key] = target
                return True
        return False

    others = [target for target in targets if id(target) not in pinned and not place(target, set())]
    free = [key for key in (*_DIGITS, *string.ascii_uppercase, *_WITH_SHIFT) if key not in owners]
    owners.update(zip(free, others))
    return {id(target): key for key, target in owners.items()}


def _targets(widget: QWidget) -> Iterator[Target]:
    if isinstance(widget, QTabBar):
        for number in range(widget.count()):
            yield _tab(widget, number)
    elif isinstance(widget, QLabel):
        # Ticks have letters of their own.
        if widget.buddy() is not None and not isinstance(_focused_by(widget.buddy()), QCheckBox):
            yield _label(widget, widget.buddy())
    elif isinstance(widget, QAbstractButton) and widget.objectName() not in _OWN_KEYS:
        yield _button(widget)


def _focused_by(widget: QWidget) -> QWidget:
    """Widget that gets the keyboard if another does."""
    while widget.focusProxy() is not None:
        widget = widget.focusProxy()
    return widget


def _tab(bar: QTabBar, number: int) -> Target:
    text = bar.tabText(number)

    def act() -> None:
        bar.setCurrentIndex(number)
        bar.setFocus(Qt.FocusReason.ShortcutFocusReason)

    return Target(bar, text, lambda key, _shared: bar.setTabText(number, _with_letter(text, key)), act, bar.setEnabled)


def _label(label: QLabel, buddy: QWidget) -> Target:
    text = label.text()

    def show(key: str, shared: bool) -> None:
        plain = text.replace("&", "")
        if not shared:
            label.setText(_with_letter(text, key))
        elif key in plain.upper():
            # An ampersand would take the letter from the menu.
            at = plain.upper().index(key)
            label.setTextFormat(Qt.TextFormat.RichText)
            parts = (html.escape(part) for part in (plain[:at], plain[at], plain[at + 1 :]))
            label.setText("{}<u>{}</u>{}".format(*parts))
        if key not in plain.upper():
            _show_in_tip(buddy, key)

    def hear(heard: bool) -> None:
        label.setBuddy(buddy if heard else None)

    return Target(label, text, show, lambda: buddy.setFocus(Qt.FocusReason.ShortcutFocusReason), hear)


def _button(button: QAbstractButton) -> Target:
    is_image = isinstance(button, QToolButton) and button.toolButtonStyle() == Qt.ToolButtonStyle.ToolButtonIconOnly
    text = "" if is_image and not button.icon().isNull() else button.text()

    def show(key: str, shared: bool) -> None:
        if text:
            button.setText(_with_letter(text, key))
        if shared:
            button.setShortcut(QKeySequence())
        if key not in text.upper():
            _show_in_tip(button, key)

    def act() -> None:
        button.setFocus(Qt.FocusReason.ShortcutFocusReason)
        if isinstance(button, (QPushButton, QToolButton)) and button.menu() is not None:
            button.showMenu()
        elif button.isEnabled():
            button.animateClick() if isinstance(button, QCheckBox) else button.click()

    def hear(heard: bool) -> None:
        button.setShortcut(QKeySequence.mnemonic(button.text()) if heard else QKeySequence())

    return Target(button, text, show, act, hear)


def _with_letter(text: str, key: str) -> str:
    """Text with a letter marked as underlined, if it has the letter."""
    plain = text.replace("&", "")
    at = plain.upper().find(key)
    return plain if at < 0 else f"{plain[:at]}&{plain[at:]}"


def _show_in_tip(widget: QWidget, key: str) -> None:
    keys = QKeySequence(f"Alt+{key}").toString(QKeySequence.SequenceFormat.NativeText)
    widget.setToolTip(shown_plain(f"{widget.toolTip().rstrip()} ({keys})"))
