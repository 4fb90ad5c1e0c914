"""The entries of the imagery: the source with its terms, the date, the key and the map types."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING

from qgis.core import QgsApplication
from qgis.gui import QgsAuthConfigSelect, QgsCollapsibleGroupBoxBasic
from qgis.PyQt.QtCore import QSignalBlocker, QStringListModel, Qt, pyqtSignal
from qgis.PyQt.QtGui import QFont, QStandardItemModel
from qgis.PyQt.QtWidgets import (
    QCheckBox,
    QComboBox,
    QCompleter,
    QFileDialog,
    QLabel,
    QMenu,
    QStyle,
    QToolButton,
    QWidget,
)

from ...core.errors import TerrAInavError
from ..form.fields import field_choices, field_label
from ..form.mission_form import own_imagery
from ..form.state import ENTERED_AS_DECLARED, URL_TEMPLATE, FormState
from ..i18n import tr
from ..paths import icon
from ..plain import shown_plain
from ..qgis_source.connections import SERVICE_PREFIX
from ..widgets import Chooser, FieldMarks, form_layout, line_edit, named, row, tool_button
from .choices import (
    CATALOGUE,
    CONNECTION,
    FILE,
    OTHER,
    OWN,
    PROJECT,
    REGIONAL,
    SERVICE,
    SourceChoice,
    template_limits,
    unlisted,
)
from .imagery_list import ImageryList

if TYPE_CHECKING:
    from ...core.mission.imageries import NamedImagery

#: Number of entries visible without scrolling.
_ROWS = 24


class ImageryEntries(QgsCollapsibleGroupBoxBasic):
    """Group of the imagery.

    Signals
    -------
    changed()
        The user has changed an entry.
    show_on_map_clicked(), add_source_clicked(), remove_source_clicked(), cache_clicked()
    service_chosen(str)
        The user has chosen a service, and must now choose one of its layers.
    imagery_wanted(str)
        The user wants to add another imagery, or to change the one of this text.

    Attributes
    ----------
    source : SourceCombo
    template, date : QLineEdit
    key : QgsAuthConfigSelect
    map_types : dict of str to QCheckBox
    limits : QLabel
        Terms of the chosen source's provider.
    others : ImageryList
        The imageries of a mission that has several.
    """

    changed = pyqtSignal()
    show_on_map_clicked = pyqtSignal()
    add_source_clicked = pyqtSignal()
    remove_source_clicked = pyqtSignal()
    cache_clicked = pyqtSignal()
    service_chosen = pyqtSignal(str)
    imagery_wanted = pyqtSignal(str)

    def __init__(self, marks: FieldMarks, choices: Sequence[SourceChoice]) -> None:
        super().__init__(tr("Imagery"))
        self._marks = marks
        self._choices: dict[str, SourceChoice] = {}
        self._last = ""
        #: Map types checked by the user, including types that the source lacks.
        self._wanted: set[str] = set()
        self._form = form_layout(self)
        self._add_source()
        self._add_details()
        self._add_map_types()
        self._add_others()
        self.set_choices(choices)
        self.source.currentIndexChanged.connect(self._source_chosen)
        for signal in (self.template.textChanged, self.date.textChanged):
            signal.connect(self.changed)
        for name, check in self.map_types.items():
            check.toggled.connect(partial(self._map_type_ticked, name))

    def choice(self) -> SourceChoice | None:
        """Return the chosen source; None for a URL template."""
        return self._choices.get(self.source.currentData())

    def source_name(self) -> str:
        """Return the name of the chosen source in a mission."""
        chosen = self.source.currentData()
        return self.template.text().strip() if chosen == URL_TEMPLATE else chosen or ""

    def own_imagery(self) -> NamedImagery:
        """Return the imagery of the entries, named after its source; raises InvalidInput."""
        return own_imagery(
            FormState(
                source=self.source.currentData() or "",
                template=self.template.text(),
                date=self.date.text().strip() if self._is_dated(self.choice()) else "",
                map_types=self.ticked()[:1],
            )
        )

    def choices(self) -> list[SourceChoice]:
        """Return the sources offered."""
        return list(self._choices.values())

    def title(self) -> str:
        """Return the title of the chosen source."""
        choice = self.choice()
        return choice.title if choice is not None else tr("URL template")

    def set_choices(self, choices: Sequence[SourceChoice]) -> None:
        """Offer other sources; the chosen source stays, even if it is not among them."""
        chosen = self.source.currentData()
        self._choices = {choice.name: choice for choice in choices}
        with QSignalBlocker(self.source):
            self.source.fill(choices, [(URL_TEMPLATE, tr("URL template…"))])
            if chosen is not None:
                self.choose_source(chosen)
        self._last = self.source.currentData()
        self.show_details()

    def choose_source(self, name: str) -> None:
        """Choose a source; if it is not listed, add it if it may exist, otherwise choose the first source."""
        choice = unlisted(name) if self.source.findData(name) < 0 else None
        if choice is not None:
            self._choices[name] = choice
            self.source.add(name, choice.title)
        self.source.choose(name)

    def ticked(self) -> tuple[str, ...]:
        """Return the checked map types that the source has."""
        boxes = self.map_types.items()
        return tuple(name for name, check in boxes if check.isChecked() and check.isEnabled())

    def offered(self) -> tuple[str, ...]:
        """Return the map types of the chosen source; empty if the source accepts any type."""
        choice = self.choice()
        return choice.map_types if choice is not None else ()

    def enter_map_types(self, names: Sequence[str]) -> None:
        """Check map types without emitting signals; a change counts as the user's choice."""
        if set(names) != set(self.ticked()):
            self._wanted = set(names)
        self._tick(names)

    def show_details(self) -> None:
        """Show the entries for the chosen source, and its provider's terms."""
        choice = self.choice()
        own_url = self.source.currentData() == URL_TEMPLATE
        self._form_row(self._template_label, self._template_field, own_url)
        self._show_key_row(choice, own_url)
        self._form_row(self._date_label, self._date_field, self._is_dated(choice))
        if choice is not None and choice.dates:
            self.date.setPlaceholderText(choice.default_date or tr("date"))
            self.date.setToolTip(shown_plain(tr("Date of the imagery: {dates}").format(dates=choice.dates)))
        else:
            self.date.setPlaceholderText(tr("date"))
            self.date.setToolTip(tr("Date of the imagery, in the format that the server accepts"))
        self.limits.setText(choice.limits if choice is not None else template_limits(self.template.text()))
        self.limits.setVisible(bool(self.limits.text()))
        self._remove.setEnabled(choice is not None and choice.group == OWN)
        offered = choice.map_types if choice is not None else ()
        for map_type, check in self.map_types.items():
            # A source with one kind of image accepts any name.
            check.setEnabled(not offered or map_type in offered)

    def _show_key_row(self, choice: SourceChoice | None, own_url: bool) -> None:
        """Show the entry of the key, or of the authentication of requests, if the source may need one."""
        is_key = "{key}" in self.template.text() if own_url else choice is not None and choice.needs_key
        shown = is_key or own_url or (choice is not None and choice.may_authenticate)
        self._key_label.setText(tr("API key") if is_key else tr("Authentication"))
        self.key.setToolTip(
            tr("API key, kept in QGIS's authentication database as the password of a configuration")
            if is_key
            else tr("How QGIS authenticates requests to this source; a configuration of its authentication database")
        )
        self._form_row(self._key_label, self._key_field, shown)

    def _is_dated(self, choice: SourceChoice | None) -> bool:
        """Whether the source may have several dates; a service must be requested to know."""
        from ...core.imagery.opening import source_kind

        if choice is not None:
            return bool(choice.dates) or "{date}" in choice.name
        address = self.template.text().strip()
        return "{date}" in address or source_kind(address).is_service

    def _form_row(self, label: QLabel, field: QWidget, shown: bool) -> None:
        label.setVisible(shown)
        field.setVisible(shown)

    def _add_source(self) -> None:
        self.source = SourceCombo()
        self.source.setToolTip(tr("Where the images come from; type a part of its name to find it"))
        # A small minimum, as the panel is usually wider.
        self.source.setMinimumContentsLength(9)
        tip = tr("Add this source to the map as background and zoom to the area")
        self.show_on_map = tool_button("show_on_map", icon("show_on_map"), tip, tr("Show on map"))
        self.show_on_map.clicked.connect(self.show_on_map_clicked)
        tip = tr("Add a source by URL, open a file, and more")
        self.more = tool_button("more_sources", QgsApplication.getThemeIcon("/symbologyAdd.svg"), tip)
        self.more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        menu = QMenu(self.more)
        menu.addAction(tr("Add source by URL…"), self.add_source_clicked.emit)
        menu.addAction(tr("Open raster or MBTiles file…"), self._browse)
        self._remove = menu.addAction(tr("Remove this source"), self.remove_source_clicked.emit)
        menu.addSeparator()
        menu.addAction(tr("Cache…"), self.cache_clicked.emit)
        self.more.setMenu(menu)
        line = row(self.source, self.more, self.show_on_map, stretch=0)
        self._form.addRow(tr("Source"), self._marks.field("source", self.source, line))

    def _add_details(self) -> None:
        tip = tr("Address of the tiles with {z}, {x} and {y} or {-y}; also {s}, {q}, {r}, {map_type}, {date}")
        self.template = line_edit("template", tip, "https://…/{z}/{x}/{y}.png")
        self.template.textChanged.connect(self.show_details)
        self._template_label, self._template_field = QLabel(tr("URL")), self.template
        self._form.addRow(self._template_label, self.template)
        self.limits = named(QLabel(), "limits")
        self.limits.setWordWrap(True)
        self.limits.setTextFormat(Qt.TextFormat.RichText)
        self.limits.setTextInteractionFlags(Qt.TextInteractionFlag.TextBrowserInteraction)
        self.limits.setOpenExternalLinks(True)
        self._form.addRow(self.limits)
        self.date = line_edit("date", "")
        self._date_label, self._date_field = QLabel(tr("Date")), self._marks.field("date", self.date)
        self._form.addRow(self._date_label, self._date_field)
        self.key = named(QgsAuthConfigSelect(), "key")
        self._key_label = QLabel(tr("API key"))
        self._key_field = self._marks.field("key", self.key.findChild(QComboBox) or self.key, self.key)
        self._form.addRow(self._key_label, self._key_field)

    def _add_map_types(self) -> None:
        field = ENTERED_AS_DECLARED["map_types"]
        self.map_types = {name: QCheckBox(label) for name, label in field_choices(field)}
        for name, check in self.map_types.items():
            check.setObjectName(f"map_type_{name}")
        checks = row(*self.map_types.values())
        self._form.addRow(field_label(field), self._marks.field("map_types", checks))

    def _add_others(self) -> None:
        self.others = ImageryList(self._marks, self._source_title, self._own_name)
        self.changed.connect(self.others.show_own)
        self.others.changed.connect(self.changed)
        self.others.wanted.connect(self.imagery_wanted)
        self._form.addRow(self.others)

    def _own_name(self) -> str:
        try:
            return self.own_imagery().name
        except TerrAInavError:
            return ""

    def _source_title(self, name: str) -> str:
        """Title of a source; its name if it is not listed."""
        choice = self._choices.get(name) or unlisted(name)
        return choice.title if choice is not None else name

    def _source_chosen(self) -> None:
        chosen = self.source.currentData()
        if isinstance(chosen, str) and chosen.startswith(SERVICE_PREFIX):
            # The user must first choose a layer of the service; until then, the source stays.
            with QSignalBlocker(self.source):
                self.choose_source(self._last)
            self.service_chosen.emit(chosen[len(SERVICE_PREFIX) :])
            return
        self._last = chosen
        self.show_details()
        self._tick_offered()
        self.changed.emit()

    def _tick_offered(self) -> None:
        """Check the map types that the user wants and the source has, or the only map type of the source."""
        choice = self.choice()
        offered = set(choice.map_types if choice is not None else ()) or set(self.map_types)
        self._tick(offered if len(offered) == 1 else self._wanted & offered)

    def _tick(self, names: Iterable[str]) -> None:
        for name, check in self.map_types.items():
            with QSignalBlocker(check):
                check.setChecked(name in names)

    def _map_type_ticked(self, name: str, on: bool) -> None:
        (self._wanted.add if on else self._wanted.discard)(name)
        self.changed.emit()

    def _browse(self) -> None:
        from ...core.imagery.opening import KINDS

        path, _ = QFileDialog.getOpenFileName(
            self,
            tr("Raster or MBTiles file"),
            "",
            tr("Rasters and tiles ({endings});;All files (*)").format(
                endings=" ".join(f"*{ending}" for kind in KINDS for ending in kind.endings)
            ),
        )
        if path:
            self.choose_source(path)


class SourceCombo(Chooser):
    """Chooser of a source, with headings for groups; typing searches in any part of the titles.

    Signals
    -------
    about_to_open()
        Emitted before the list is shown, to update it.
    """

    about_to_open = pyqtSignal()

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("source")
        self.setEditable(True)
        self.setInsertPolicy(QComboBox.InsertPolicy.NoInsert)
        self.setMaxVisibleItems(_ROWS)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._titles = QStringListModel(self)
        completer = QCompleter(self._titles, self)
        completer.setFilterMode(Qt.MatchFlag.MatchContains)
        completer.setCaseSensitivity(Qt.CaseSensitivity.CaseInsensitive)
        completer.setMaxVisibleItems(_ROWS)
        self.setCompleter(completer)
        completer.activated[str].connect(self._take)
        self.lineEdit().editingFinished.connect(self._take_typed)
        self.currentIndexChanged.connect(self._show_start)

    def fill(self, choices: Sequence[SourceChoice], others: Sequence[tuple[str, str]]) -> None:
        """Offer choices, followed by ``others``, pairs (value, title); select the first choice."""
        self.clear()
        group = None
        for choice in choices:
            if choice.group != group:
                group = choice.group
                self._add_heading(group)
            self.add(choice.name, choice.title)
        self._add_heading(OTHER)
        for value, title in others:
            self.add(value, title)
        self.setCurrentIndex(self._first())

    def add(self, value: str, title: str) -> None:
        """Add an entry at the end."""
        self.addItem(title, value)
        row = self.count() - 1
        self.setItemData(row, shown_plain(title), Qt.ItemDataRole.ToolTipRole)
        self._titles.setStringList([self.itemText(at) for at in range(self.count()) if self._can_choose(at)])

    def choose(self, value: str) -> None:
        """Select the entry with a value; the first entry if there is none."""
        index = self.findData(value)
        self.setCurrentIndex(index if index >= 0 else self._first())

    def showPopup(self) -> None:
        """Show the updated list."""
        self.about_to_open.emit()
        # Widen the list beyond the narrow panel, so that titles are readable.
        bar = self.style().pixelMetric(QStyle.PixelMetric.PM_ScrollBarExtent)
        self.view().setMinimumWidth(self.view().sizeHintForColumn(0) + bar)
        super().showPopup()

    def _add_heading(self, group: int) -> None:
        titles = {
            CATALOGUE: tr("Catalogue: worldwide"),
            REGIONAL: tr("Catalogue: one country"),
            OWN: tr("Your own sources"),
            CONNECTION: tr("QGIS connections: XYZ tiles"),
            SERVICE: tr("QGIS connections: WMS and WMTS"),
            PROJECT: tr("This project"),
            FILE: tr("Files"),
            OTHER: tr("Other"),
        }
        self.addItem(titles[group])
        model = self.model()
        if isinstance(model, QStandardItemModel):
            item = model.item(self.count() - 1)
            item.setFlags(Qt.ItemFlag.NoItemFlags)
            font = QFont(self.font())
            font.setBold(True)
            item.setFont(font)

    def _can_choose(self, row: int) -> bool:
        return self.itemData(row) is not None

    def _first(self) -> int:
        return next((row for row in range(self.count()) if self._can_choose(row)), -1)

    def _take(self, title: str) -> None:
        rows = [row for row in range(self.count()) if self._can_choose(row) and self.itemText(row) == title]
        if rows and self.currentIndex() not in rows:
            self.setCurrentIndex(rows[0])

    def _take_typed(self) -> None:
        """Select the entry that matches the typed text, if only one does; otherwise show the current entry again."""
        typed = self.currentText().strip().casefold()
        own = self.itemText(self.currentIndex())
        if typed and typed != own.casefold():
            titles = [self.itemText(row) for row in range(self.count()) if self._can_choose(row)]
            same = [title for title in titles if title.casefold() == typed]
            found = same or [title for title in titles if typed in title.casefold()]
            if len(set(found)) == 1:
                self._take(found[0])
        self.setEditText(self.itemText(self.currentIndex()))

    def _show_start(self) -> None:
        # Show the beginning of a title longer than the field.
        self.lineEdit().setCursorPosition(0)
