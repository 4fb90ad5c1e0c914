"""Sources of one's own: by the URL of tiles, or a layer of a WMS or WMTS that QGIS has a connection to."""

from __future__ import annotations

import re
from contextlib import closing
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import SourceError, TerrAInavError
from ..credentials import store_key
from ..help import add_help_button
from ..i18n import number_text, tr, translate
from ..network.transport import QgisTransport
from ..plain import shown_plain
from ..qgis_source.connections import ServiceConnection
from ..settings import Settings, credential_home
from ..tasks import Task
from ..widgets import (
    STYLE_SHEET,
    FieldMarks,
    combo,
    growing_form,
    line_edit,
    named,
    ok_and_cancel,
    spin,
    tick,
    whole_spin,
    wrapped_label,
)
from .choices import limits_html

if TYPE_CHECKING:
    from ...core.imagery.entry import CatalogueEntry
    from ...core.imagery.opening import NamedSource
    from ...core.imagery.services.capabilities import Offered

#: Of a source of which nothing is said; a server may take more, and should be asked first.
_CONNECTIONS, _REQUESTS_PER_S = 4, 10.0
_ROOM_PX = 460
_SERVICE_ROOM_PX = (520, 420)
#: Entries in which fields of a source are put right; all others come of its address.
_ENTRIES = {"name": "name", "date": "default_date", "terms_url": "terms_url", "placeholder": "placeholders"}
#: Choice of a layer in a service's name, by kind.
_CHOICES = {"wms": "layers", "wmts": "layer"}
#: Longest part of a layer's name that its source is called by: room is left for a number.
_NAME_LETTERS = 56


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
        from ...core.imagery.catalogue import add

        try:
            add(self.name.text().strip(), self._data())
        except TerrAInavError as wrong:
            self.marks.show(_at_field(wrong))
            return
        self.added = self.name.text().strip()
        super().accept()

    def _make_fields(self) -> None:
        tip = tr("Address of the tiles with {z}, {x} and {y} or {-y}; {key} stands for an API key")
        self.url = line_edit("url", tip, "https://…/{z}/{x}/{y}.png")
        self.name = line_edit(
            "name", tr("Names it in missions and on the command line: lower-case letters and digits")
        )
        self.title = line_edit("title", tr("What you call it"))
        self.attribution = line_edit("attribution", tr("Credit that goes into every image's metadata"))
        self.licence = line_edit("licence", tr("Licence of the imagery, such as CC BY 4.0"))
        self.terms_url = line_edit("terms_url", tr("Address of the provider's terms of use"))
        self.default_date = line_edit("default_date", tr("Default value of {date} in the address"))
        self.placeholders = line_edit(
            "placeholders",
            tr("SHA-256 of tiles that show no imagery, 16 digits or more of each, with spaces between them"),
        )
        self.max_zoom = whole_spin("max_zoom", 0, 30, tr("Highest zoom with detail of its own, 0 to 30"))
        self.max_zoom.setValue(19)
        self.tile_px = combo(
            "tile_px", ((256, tr("256 px")), (512, tr("512 px"))), tr("Width and height of a tile")
        )
        tip = tr("Requests under way at once, as many as the provider allows")
        self.connections = whole_spin("connections", 1, 64, tip)
        self.connections.setValue(_CONNECTIONS)
        self.rate = spin(
            "rate", 0.1, 10_000.0, 1, tr(" a second"), tr("Requests a second, as many as the provider allows")
        )
        self.rate.setValue(_REQUESTS_PER_S)
        tip = tr("Leave it ticked only where the provider's terms allow storing")
        self.cached = tick("cached", tr("Tiles may be kept in the cache"), tip)
        self.cached.setChecked(True)
        self.limits = named(QLabel(), "limits")
        self.limits.setTextFormat(Qt.TextFormat.RichText)
        self.limits.setWordWrap(True)
        self.buttons = ok_and_cancel(self)
        add_help_button(self.buttons, tr("sources"))

    def _lay_out(self) -> None:
        form = growing_form()
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
        from ...core.imagery.catalogue import described

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
        from ...core.imagery.entry import CatalogueEntry, under_provider

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
            messages = _at_field(wrong)
        if name and "name" not in messages:
            messages.update(_name_problem(name))
        self.marks.show(messages)
        self.limits.setText(limits)
        ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        ok.setEnabled(bool(url and name and not messages))


class ServiceDialog(QDialog):
    """Lists the layers of a service, found by typing, and keeps the one that is chosen.

    Attributes
    ----------
    added : str
        Name of the source that was kept; empty for none.
    """

    def __init__(self, service: ServiceConnection, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("terrainav_service")
        self.setWindowTitle(tr("TerrAInav: layer of {name}").format(name=service.name))
        self.added = ""
        self._service = service
        self._task: _Capabilities | None = None
        self._kind = ""
        self.search = line_edit("search", tr("Part of a layer's title or name"), tr("Search"))
        self.search.setClearButtonEnabled(True)
        self.list = named(QListWidget(), "layers", tr("Layers that the service offers"))
        self.told = wrapped_label("told")
        self.buttons = ok_and_cancel(self)
        add_help_button(self.buttons, tr("sources"))
        layout = QVBoxLayout(self)
        for widget in (self.search, self.list, self.told, self.buttons):
            layout.addWidget(widget)
        self.resize(*_SERVICE_ROOM_PX)
        self.search.textChanged.connect(self._filter)
        self.list.itemSelectionChanged.connect(self._show_ready)
        self.list.itemDoubleClicked.connect(lambda _: self.accept())
        self._show_ready()
        self._ask(_Capabilities(service), self._show_layers)

    def accept(self) -> None:
        """Ask for what is to be known of the layer, and keep it."""
        layer = self._chosen()
        if layer and self._task is None:
            self._ask(_Capabilities(self._service, self._kind, layer), self._keep)

    def done(self, result: int) -> None:
        """End what is still being asked."""
        if self._task is not None:
            self._task.abandon()
            self._task = None
        super().done(result)

    def _ask(self, task: _Capabilities, then: object) -> None:
        self._task = task
        self.told.setText(tr("Asking the service…"))
        self._show_ready()
        task.begin(then)

    def _show_layers(self, task: _Capabilities) -> None:
        self._task, self._kind = None, task.kind
        for layer in sorted(task.layers, key=lambda one: one.title.casefold()):
            title = layer.title or layer.name
            item = QListWidgetItem(title)
            item.setData(Qt.ItemDataRole.UserRole, layer.name)
            item.setToolTip(shown_plain(layer.name))
            self.list.addItem(item)
        text = tr("{count} layers").format(count=number_text(len(task.layers)))
        if self._service.key:
            text += " " + tr("The key in its address will be kept in QGIS's authentication database.")
        self.told.setText(translate(task.error) or text)
        self._show_ready()

    def _keep(self, task: _Capabilities) -> None:
        self._task = None
        try:
            if task.error or task.entry is None:
                raise SourceError(task.error or tr("nothing was answered"))
            self.added = kept(task.entry, self._service, self._chosen())
        except TerrAInavError as wrong:
            self.told.setText(translate(wrong))
            self._show_ready()
            return
        super().accept()

    def _filter(self, text: str) -> None:
        wanted = text.strip().casefold()
        for row in range(self.list.count()):
            item = self.list.item(row)
            item.setHidden(wanted not in f"{item.text()} {item.data(Qt.ItemDataRole.UserRole)}".casefold())

    def _chosen(self) -> str:
        items = [item for item in self.list.selectedItems() if not item.isHidden()]
        return str(items[0].data(Qt.ItemDataRole.UserRole)) if items else ""

    def _show_ready(self) -> None:
        ready = self._task is None and bool(self._chosen())
        self.buttons.button(QDialogButtonBox.StandardButton.Ok).setEnabled(ready)


def kept(entry: CatalogueEntry, service: ServiceConnection, layer: str) -> str:
    """Keep a layer as a source of the user, with the connection's authentication; returns its name.

    Raises
    ------
    TerrAInavError
        It cannot be kept.
    """
    from ...core.imagery.catalogue import add, shelf, sources

    taken = {known.name for known in sources()} | set(shelf().problems)
    plain = (
        re.sub(r"[^a-z0-9]+", "-", f"{service.name} {layer}".lower()).strip("-")[:_NAME_LETTERS] or "layer"
    )
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain}-{number}", number + 1
    title = tr("{layer} ({service})").format(layer=entry.title, service=service.name)
    add(name, {**entry.to_data(), "title": title})
    authcfg = store_key(title, service.key) if service.key else service.authcfg
    # Its tiles may be on another server, which the service's capabilities name and the user has not.
    if all(credential_home(url) == credential_home(service.address) for url in entry.urls.values()):
        Settings().set_authcfg(name, authcfg)
    return name


def _name_problem(name: str) -> dict[str, str]:
    """Message for a name that is not right, or taken."""
    from ...core.imagery.catalogue import sources
    from ...core.imagery.entry import NAME

    if not NAME.fullmatch(name):
        return {"name": tr("must be lower-case letters, digits, hyphens and underscores, at most 64")}
    try:
        taken = any(entry.name == name for entry in sources())
    except TerrAInavError as wrong:
        return {"name": translate(wrong)}
    return {"name": tr("“{name}” is taken; choose another name").format(name=name)} if taken else {}


def _at_field(error: TerrAInavError) -> dict[str, str]:
    """Message at the entry that an error is about, without the name of the source that is being made."""
    inner = error.__cause__ if isinstance(error.__cause__, TerrAInavError) else error
    return {_ENTRIES.get(inner.field, "url"): translate(inner)}


class _Capabilities(Task):
    """Asks a service for its layers, or for all about one of them.

    Attributes
    ----------
    kind : str
        wms or wmts, as it was found to be.
    layers : list of Offered
    entry : CatalogueEntry or None
    """

    def __init__(self, service: ServiceConnection, kind: str = "", layer: str = "") -> None:
        super().__init__(tr("Asking {name} for its layers").format(name=service.name))
        from ...core.limits import MAX_CAPABILITIES_BYTES

        self.kind = kind
        self.layers: list[Offered] = []
        self.entry: CatalogueEntry | None = None
        self._service, self._layer = service, layer
        home = credential_home(service.address)
        self._transport = QgisTransport(
            1, max_body_bytes=MAX_CAPABILITIES_BYTES, authcfg=service.authcfg, home=home
        )

    def work(self) -> None:
        """Ask."""
        with closing(self._transport):
            if self._layer:
                chosen = f"{_CHOICES[self.kind]}={quote(self._layer, safe='')}"
                self.entry = self._named(f"{self.kind}:{self._service.address}#{chosen}").entry
            else:
                self._find_layers()

    def cancel(self) -> None:
        """End the requests as well."""
        super().cancel()
        self._transport.close()

    def finished(self, result: bool) -> None:
        """Tell; on the main thread."""
        # A task that is cancelled before its turn does not run.
        self._transport.close()
        super().finished(result)

    def _named(self, name: str) -> NamedSource:
        from ...core.imagery.opening import SourceOptions, named_source

        return named_source(name, SourceOptions(key=self._service.key or None, transport=self._transport))

    def _find_layers(self) -> None:
        """QGIS's connections do not say which of the two they lead to."""
        kinds = ("wmts", "wms") if "wmts" in self._service.address.lower() else ("wms", "wmts")
        problems: list[SourceError] = []
        for kind in kinds:
            self.kind = kind
            try:
                self.layers = self._named(f"{kind}:{self._service.address}").layers() or []
            except SourceError as wrong:
                problems.append(wrong)
            else:
                return
        raise problems[0]
