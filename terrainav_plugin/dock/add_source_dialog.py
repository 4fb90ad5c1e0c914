"""A source of one's own, by the URL of its tiles."""

from __future__ import annotations

import re
from typing import Any

from qgis.gui import QgsSpinBox
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QCheckBox,
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QLabel,
    QLineEdit,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import TerrAInavError
from ..help import add_help_button
from ..i18n import told, tr
from ..widgets import STYLE_SHEET, FieldMarks, combo, spin
from .source_choices import limits_html

#: Of a source of which nothing is said; a server may take more, and should be asked first.
_CONNECTIONS, _REQUESTS_PER_S = 4, 10.0
_ROOM_PX = 460
#: What may name a source.
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


class AddSourceDialog(QDialog):
    """Asks for a source, says what is wrong with it while it is typed, and keeps it.

    Attributes
    ----------
    added : str
        Name of the source that was kept; empty for none.
    """

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("terrainav_add_source")
        self.setWindowTitle(tr("TerrAInav: add source"))
        self.setStyleSheet(STYLE_SHEET)
        self.added = ""
        self.marks = FieldMarks()
        self._named = False
        self._make_fields()
        self._lay_out()
        self._connect()
        self._check()

    def accept(self) -> None:
        """Keep the source; stay open where that is not possible."""
        from ...core.imagery.catalogue.user_sources import add

        try:
            add(self.name.text().strip(), self._data())
        except TerrAInavError as wrong:
            self.marks.show(_at_field(str(wrong)))
            return
        self.added = self.name.text().strip()
        super().accept()

    def _make_fields(self) -> None:
        self.url = _line(
            "url", tr("Address of the tiles with {z}, {x} and {y} or {-y}; {key} stands for an API key")
        )
        self.url.setPlaceholderText("https://…/{z}/{x}/{y}.png")
        self.name = _line(
            "name", tr("Names it in missions and on the command line: lower-case letters and digits")
        )
        self.title = _line("title", tr("What you call it"))
        self.attribution = _line("attribution", tr("Credit that goes into every image's metadata"))
        self.licence = _line("licence", tr("Licence of the imagery, such as CC BY 4.0"))
        self.terms_url = _line("terms_url", tr("Address of the provider's terms of use"))
        self.default_date = _line(
            "default_date", tr("What {date} in the address stands for where no date is asked for")
        )
        self.placeholders = _line(
            "placeholders",
            tr("SHA-256 of tiles that show no imagery, 16 digits or more of each, with spaces between them"),
        )
        self.max_zoom = QgsSpinBox()
        self.max_zoom.setObjectName("max_zoom")
        self.max_zoom.setRange(0, 30)
        self.max_zoom.setValue(19)
        self.max_zoom.setShowClearButton(False)
        self.max_zoom.setToolTip(tr("Highest zoom with detail of its own, 0 to 30"))
        self.tile_px = combo(
            "tile_px", ((256, tr("256 px")), (512, tr("512 px"))), tr("Width and height of a tile")
        )
        self.connections = QgsSpinBox()
        self.connections.setObjectName("connections")
        self.connections.setRange(1, 64)
        self.connections.setValue(_CONNECTIONS)
        self.connections.setShowClearButton(False)
        self.connections.setToolTip(tr("Requests under way at once, as many as the provider allows"))
        self.rate = spin(
            "rate", 0.1, 10_000.0, 1, tr(" a second"), tr("Requests a second, as many as the provider allows")
        )
        self.rate.setValue(_REQUESTS_PER_S)
        self.cached = QCheckBox(tr("Tiles may be kept in the cache"))
        self.cached.setObjectName("cached")
        self.cached.setChecked(True)
        self.cached.setToolTip(tr("Leave it ticked only where the provider's terms allow storing"))
        self.limits = QLabel()
        self.limits.setTextFormat(Qt.TextFormat.RichText)
        self.limits.setObjectName("limits")
        self.limits.setWordWrap(True)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        add_help_button(self.buttons, tr("sources"))

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for label, name in (
            (tr("URL"), "url"),
            (tr("Name"), "name"),
            (tr("Title"), "title"),
            (tr("Attribution"), "attribution"),
            (tr("Licence"), "licence"),
            (tr("Terms"), "terms_url"),
        ):
            form.addRow(label, self.marks.field(name, getattr(self, name)))
        self._date_label, self._date_row = (
            QLabel(tr("Default date")),
            self.marks.field("default_date", self.default_date),
        )
        form.addRow(self._date_label, self._date_row)
        form.addRow(tr("Highest zoom"), self.max_zoom)
        form.addRow(tr("Tile size"), self.tile_px)
        form.addRow(tr("Connections"), self.connections)
        form.addRow(tr("Requests"), self.rate)
        form.addRow(tr("Treat as missing"), self.marks.field("placeholders", self.placeholders))
        form.addRow("", self.cached)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(self.limits)
        layout.addStretch(1)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(_ROOM_PX)

    def _connect(self) -> None:
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
        self.name.textEdited.connect(self._take_name)
        self.url.textChanged.connect(self._suggest_name)
        for signal in (
            self.url.textChanged,
            self.name.textChanged,
            self.title.textChanged,
            self.licence.textChanged,
            self.terms_url.textChanged,
            self.default_date.textChanged,
            self.placeholders.textChanged,
            self.max_zoom.valueChanged,
            self.tile_px.currentIndexChanged,
            self.connections.valueChanged,
            self.rate.valueChanged,
            self.cached.toggled,
        ):
            signal.connect(self._check)

    def _take_name(self) -> None:
        self._named = True

    def _suggest_name(self) -> None:
        """Name the source by its host, until a name is typed."""
        if self._named and self.name.text():
            return
        host = re.sub(r"^[^/]*//|[:/?].*$|\{s\}\.", "", self.url.text().strip().lower())
        self._named = False
        self.name.setText(re.sub(r"[^a-z0-9]+", "-", host).strip("-")[:64])

    def _data(self) -> dict[str, Any]:
        from ...core.imagery.catalogue.user_sources import described

        return described(
            self.url.text().strip(),
            title=self.title.text().strip(),
            attribution=self.attribution.text().strip(),
            licence=self.licence.text().strip(),
            terms_url=self.terms_url.text().strip(),
            max_zoom=self.max_zoom.value(),
            tile_px=self.tile_px.currentData(),
            default_date=self.default_date.text().strip(),
            max_connections=self.connections.value(),
            requests_per_s=self.rate.value(),
            cache_allowed=self.cached.isChecked(),
            placeholders=self.placeholders.text().split(),
        )

    def _check(self) -> None:
        """Say what is wrong, and under which limits it would be used."""
        from ...core.imagery.catalogue.entry import CatalogueEntry, under_provider

        dated = "{date}" in self.url.text()
        for widget in (self._date_label, self._date_row):
            widget.setVisible(dated)
        if not dated:
            self.default_date.clear()
        messages: dict[str, str] = {}
        limits = ""
        url, name = self.url.text().strip(), self.name.text().strip()
        try:
            if url:
                entry = CatalogueEntry.from_dict(name or "own", self._data(), user=True)
                limits = limits_html(under_provider(entry))
                self.title.setPlaceholderText(entry.title)
        except TerrAInavError as wrong:
            messages = _at_field(str(wrong))
        if name and "name" not in messages:
            messages.update(_name_problem(name))
        self.marks.show(messages)
        self.limits.setText(limits)
        ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        ok.setEnabled(bool(url and name and not messages))


def _line(name: str, tip: str) -> QLineEdit:
    edit = QLineEdit()
    edit.setObjectName(name)
    edit.setToolTip(tip)
    return edit


def _name_problem(name: str) -> dict[str, str]:
    """Message for a name that is not right, or taken."""
    from ...core.imagery.catalogue.listing import sources

    if not _NAME.fullmatch(name):
        return {"name": tr("must be lower-case letters, digits, hyphens and underscores, at most 64")}
    try:
        taken = any(entry.name == name for entry in sources())
    except TerrAInavError as wrong:
        return {"name": told(wrong)}
    return {"name": tr("“{name}” is taken; choose another name").format(name=name)} if taken else {}


def _at_field(text: str) -> dict[str, str]:
    """Message at the field that it is about, as the core's messages begin."""
    _, _, plain = text.rpartition("': ") if text.startswith("catalogue entry") else ("", "", text)
    fields = (
        ("source name", "name"),
        ("date", "default_date"),
        ("terms", "terms_url"),
        ("placeholder", "placeholders"),
    )
    return {next((field for words, field in fields if plain.startswith(words)), "url"): told(plain)}
