"""The imageries of a mission that has several: their list, and the dialog that adds one."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import TYPE_CHECKING

from qgis.PyQt.QtCore import QSignalBlocker, Qt, pyqtSignal
from qgis.PyQt.QtWidgets import QHBoxLayout, QHeaderView, QTreeWidget, QTreeWidgetItem, QVBoxLayout, QWidget

from ...core.errors import TerrAInavError
from ..form.fields import field_tip, map_type_title
from ..form.state import DECLARED
from ..i18n import tr
from ..plain import shown_plain
from ..widgets import FieldMarks, named, push_button

if TYPE_CHECKING:
    from ...core.mission.imageries import NamedImagery

#: Rows in sight at once.
_ROWS = 4
_NAME, _SOURCE, _DETAILS = range(3)


class ImageryList(QWidget):
    """List of the imageries, the panel's own first; only the button that adds one if there is one imagery.

    Parameters
    ----------
    marks : FieldMarks
    title : callable
        Returns the title of a source by its name.
    own_name : callable
        Returns the name that the panel's own imagery has unless the user has renamed it.

    Signals
    -------
    changed()
        The user has renamed or removed an imagery.
    wanted(str)
        The user wants to add an imagery (empty), or to change the one of this text.
    """

    changed = pyqtSignal()
    wanted = pyqtSignal(str)

    def __init__(self, marks: FieldMarks, title: Callable[[str], str], own_name: Callable[[], str]) -> None:
        super().__init__()
        self._title, self._own_name = title, own_name
        self._name, self._texts = "", ()
        self.tree = named(QTreeWidget(), "imageries")
        self.tree.setToolTip(field_tip(DECLARED["imageries"]))
        self.tree.setRootIsDecorated(False)
        self.tree.setHeaderLabels([tr("Name"), tr("Source"), tr("Date, type")])
        self.tree.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.tree.setTabKeyNavigation(False)
        self.tree.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        header = self.tree.header()
        header.setMinimumSectionSize(24)
        header.setSectionResizeMode(_NAME, QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(_SOURCE, QHeaderView.ResizeMode.Stretch)
        header.setSectionResizeMode(_DETAILS, QHeaderView.ResizeMode.ResizeToContents)
        header.setStretchLastSection(False)
        self.tree.itemChanged.connect(self._renamed)
        self.tree.currentItemChanged.connect(lambda *_: self._enable())
        self.tree.itemDoubleClicked.connect(self._double_clicked)
        self.add = push_button(
            "add_imagery",
            tr("Add imagery…"),
            tr("Capture another date or source over the same ground, into a folder of its own"),
        )
        self.add.clicked.connect(lambda _checked: self.wanted.emit(""))
        self.edit = push_button("edit_imagery", tr("Change…"), tr("Change the selected imagery"))
        self.edit.clicked.connect(lambda _checked: self._ask())
        self.rename = push_button("rename_imagery", tr("Rename"), tr("Rename the selected imagery, and its folder"))
        self.rename.clicked.connect(lambda _checked: self.tree.editItem(self.tree.currentItem(), _NAME))
        self.remove = push_button("remove_imagery", tr("Remove"), tr("Remove the selected imagery from the mission"))
        self.remove.clicked.connect(lambda _checked: self._remove())
        buttons = QHBoxLayout()
        buttons.setContentsMargins(0, 0, 0, 0)
        buttons.addWidget(self.add)
        for button in (self.edit, self.rename, self.remove):
            buttons.addWidget(button)
        buttons.addStretch(1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(2)
        # The message stands at the button while there is no list.
        layout.addWidget(self.tree)
        layout.addWidget(marks.label("imageries", self.tree))
        layout.addLayout(buttons)
        self._fill()

    def values(self) -> dict[str, object]:
        """Return the values of the state's fields."""
        return {"imagery_name": self._name, "imageries": self._texts}

    def enter(self, name: str, texts: Collection[str]) -> None:
        """Show imageries: the name of the panel's own, and the texts of the others."""
        if (name, tuple(texts)) != (self._name, self._texts):
            self._name, self._texts = name, tuple(texts)
            self._fill()
        self.show_own()

    def names(self) -> list[str]:
        """Return the names of the imageries."""
        return [self._name or self._own_name(), *(one.name for one in map(_parsed, self._texts) if one is not None)]

    def show_own(self) -> None:
        """Show the name of the panel's own imagery, which follows its source."""
        item = self.tree.topLevelItem(0)
        if item is not None:
            with QSignalBlocker(self.tree):
                item.setText(_NAME, self._name or self._own_name())

    def put(self, imagery: NamedImagery, instead: str) -> None:
        """Add an imagery, or put it in place of the one of the text ``instead``."""
        text = str(imagery)
        self._texts = tuple(text if one == instead else one for one in self._texts) if instead else (*self._texts, text)
        self._fill(self._texts.index(text) + 1)
        self.changed.emit()

    def _fill(self, current: int = 0) -> None:
        with QSignalBlocker(self.tree):
            self.tree.clear()
            if self._name or self._texts:
                self._add_item(self._name or self._own_name(), tr("as above"), "", "")
            for text in self._texts:
                one = _parsed(text)
                if one is None:
                    self._add_item(text, "", "", text)
                    continue
                kind = map_type_title(one.map_type)
                self._add_item(one.name, self._title(one.source), ", ".join(filter(None, (one.date, kind))), text)
            self.tree.setCurrentItem(self.tree.topLevelItem(current))
        rows = min(self.tree.topLevelItemCount(), _ROWS)
        row_px = self.tree.sizeHintForRow(0) if rows else 0
        self.tree.setFixedHeight(self.tree.header().sizeHint().height() + rows * row_px + 2 * self.tree.frameWidth())
        self._enable()

    def _add_item(self, name: str, source: str, details: str, text: str) -> None:
        item = QTreeWidgetItem([name, source, details])
        item.setData(_NAME, Qt.ItemDataRole.UserRole, text)
        item.setToolTip(_SOURCE, shown_plain(text or source))
        item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
        self.tree.addTopLevelItem(item)

    def _enable(self) -> None:
        is_several = self.tree.topLevelItemCount() > 0
        is_other = bool(self._current())
        for widget in (self.tree, self.edit, self.rename, self.remove):
            widget.setVisible(is_several)
        self.edit.setEnabled(is_other)
        self.remove.setEnabled(is_other)

    def _current(self) -> str:
        """Text of the selected imagery; empty for the panel's own."""
        item = self.tree.currentItem()
        return item.data(_NAME, Qt.ItemDataRole.UserRole) if item is not None else ""

    def _double_clicked(self, _item: QTreeWidgetItem, column: int) -> None:
        if column != _NAME:
            self._ask()

    def _ask(self) -> None:
        if self._current():
            self.wanted.emit(self._current())

    def _remove(self) -> None:
        gone = self._current()
        self._texts = tuple(text for text in self._texts if text != gone)
        if not self._texts:
            self._name = ""
        self._fill()
        self.changed.emit()

    def _renamed(self, item: QTreeWidgetItem, column: int) -> None:
        if column != _NAME:
            return
        text, name = item.data(_NAME, Qt.ItemDataRole.UserRole), item.text(_NAME).strip()
        one = _parsed(text)
        if not text:
            self._name = name if name != self._own_name() else ""
        elif one is not None:
            # A wrong name stays, as its message says what is wrong.
            renamed = f"{name}={text.partition('=')[2]}"
            self._texts = tuple(renamed if other == text else other for other in self._texts)
        self._fill(self.tree.indexOfTopLevelItem(item))
        self.changed.emit()


def _parsed(text: str) -> NamedImagery | None:
    """Imagery of a text; None for a wrong one."""
    from ...core.mission.imageries import NamedImagery

    try:
        return NamedImagery.parse(text)
    except TerrAInavError:
        return None


def free_name(imagery: NamedImagery, taken: Collection[str]) -> NamedImagery:
    """Imagery with a number added to a name that is taken."""
    names = {name.lower() for name in taken}
    name, number = imagery.name, 2
    while name.lower() in names:
        name, number = f"{imagery.name[:60]}-{number}", number + 1
    return replace(imagery, name=name)
