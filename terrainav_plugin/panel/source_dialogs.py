"""Dialogs that add a user's source: from an address, or from a layer of a WMS or WMTS connection of QGIS."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import closing
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtGui import QImage, QPixmap
from qgis.PyQt.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
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
    push_button,
    spin,
    tick,
    whole_spin,
    wrapped_label,
)
from .choices import limits_html

if TYPE_CHECKING:
    from ...core.imagery.entry import CatalogueEntry
    from ...core.imagery.opening import NamedSource, SourceOptions
    from ...core.imagery.services.capabilities import Offered
    from ...core.imagery.services.detecting import FoundService
    from ...core.imagery.trial import Trial

#: Entries by the field of a source that an error names; other errors are shown at the address.
_ENTRIES = {"name": "name", "date": "default_date", "terms_url": "terms_url", "placeholder": "placeholders"}
#: Parameter of a source's name that selects a layer, by kind of service.
_CHOICES = {"wms": "layers", "wmts": "layer"}
#: Largest number of reference systems named in an item of the list.
_SYSTEMS_NAMED = 3


class AddSourceDialog(QDialog):
    """Ask for a source, show problems while typing, and save it.

    One entry accepts both tile templates and addresses of services; the kind and the layers of a service are requested
    in the background.

    Parameters
    ----------
    parent : QWidget or None
    place : callable or None
        Returns latitude and longitude of the map's centre, for the test tile, or None.

    Attributes
    ----------
    added : str
        Name of the saved source; empty if none was saved.
    """

    def __init__(
        self, parent: QWidget | None = None, place: Callable[[], tuple[float, float] | None] = lambda: None
    ) -> None:
        super().__init__(parent)
        self._place = place
        self._task: _Asking | None = None
        self._found: FoundService | None = None
        self._entry: CatalogueEntry | None = None
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
        """Save the source; stay open if that fails."""
        from ...core.imagery.catalogue import add

        name, key = self.name.text().strip(), self.key.text().strip()
        try:
            entry = add(name, self._data())
        except TerrAInavError as wrong:
            self.marks.show(_field_message(wrong))
            return
        if key and entry.key_env is not None:
            Settings().set_authcfg(name, store_key(entry.title, key))
        self.added = name
        super().accept()

    def done(self, result: int) -> None:
        """Cancel pending requests."""
        self._stop()
        super().done(result)

    def _make_fields(self) -> None:
        tip = tr(
            "Address of the tiles with {z}, {x} and {y} or {-y}, or of a WMTS, WMS, ArcGIS REST service or OGC API; "
            "{key} stands for an API key"
        )
        self.url = line_edit("url", tip, "https://…/{z}/{x}/{y}.png")
        self.find_layers = push_button(
            "find", tr("&Find layers"), tr("Ask the service what it is, and which layers it offers")
        )
        self.key = line_edit("key", tr("API key for {key} in the address; kept in QGIS's authentication database"))
        self.key.setEchoMode(QLineEdit.EchoMode.Password)
        self.layers = named(QListWidget(), "layers", tr("Layers that the service offers"))
        self.layers.setMaximumHeight(110)
        self.system = combo("system", (), tr("Coordinate reference system of the images"))
        self.notice = wrapped_label("notice")
        self.test = push_button("test", tr("&Test"), tr("Fetch one tile and show it"))
        self.tile = named(QLabel(), "tile")
        self.tile.setFixedSize(128, 128)
        self.about_tile = wrapped_label("about_tile")
        self.name = line_edit(
            "name", tr("Its name in missions and on the command line: lower-case letters, digits, - and _")
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
        self.max_zoom = whole_spin("max_zoom", 0, 30, tr("Highest zoom with native detail, 0 to 30"))
        self.max_zoom.setValue(19)
        self.tile_px = combo("tile_px", ((256, tr("256 px")), (512, tr("512 px"))), tr("Width and height of a tile"))
        tip = tr("Requests under way at once, as many as the provider allows")
        self.connections = whole_spin("connections", 1, 64, tip)
        # Moderate limits, as the terms of the source are unknown.
        self.connections.setValue(4)
        self.rate = spin(
            "rate", 0.1, 10_000.0, 1, tr(" a second"), tr("Requests a second, as many as the provider allows")
        )
        self.rate.setValue(10.0)
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
        self._form = form
        row = QHBoxLayout()
        row.addWidget(self.marks.field("url", self.url), 1)
        row.addWidget(self.find_layers, 0, Qt.AlignmentFlag.AlignTop)
        form.addRow(tr("URL"), row)
        self._rows = {
            "key": (QLabel(tr("Key")), self.key),
            "layers": (QLabel(tr("Layer")), self.layers),
            "system": (QLabel(tr("Reference system")), self.system),
        }
        for label, widget in self._rows.values():
            form.addRow(label, widget)
        form.addRow("", self.notice)
        for label, name in (
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
        # Hidden for a service, which states both values.
        self._rows["max_zoom"] = (QLabel(tr("Highest zoom")), self.max_zoom)
        self._rows["tile_px"] = (QLabel(tr("Tile size")), self.tile_px)
        for name in ("max_zoom", "tile_px"):
            form.addRow(*self._rows[name])
        form.addRow(tr("Connections"), self.connections)
        form.addRow(tr("Requests"), self.rate)
        form.addRow(tr("Treat as missing"), self.marks.field("placeholders", self.placeholders))
        form.addRow("", self.cached)
        layout = QVBoxLayout(self)
        layout.addLayout(form)
        layout.addWidget(self.limits)
        trial = QHBoxLayout()
        trial.addWidget(self.test, 0, Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        trial.addWidget(self.tile)
        trial.addWidget(self.about_tile, 1)
        layout.addLayout(trial)
        layout.addStretch(1)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(460)

    def _connect(self) -> None:
        self.name.textEdited.connect(self._take_name)
        self.url.textChanged.connect(self._forget)
        self.url.textChanged.connect(self._suggest_name)
        self.find_layers.clicked.connect(lambda _checked: self._find())
        self.url.returnPressed.connect(lambda: self._find() if self.find_layers.isEnabled() else None)
        self.layers.itemSelectionChanged.connect(self._layer_chosen)
        self.system.currentIndexChanged.connect(lambda _index: self._describe())
        self.test.clicked.connect(lambda _checked: self._try())
        self.key.textChanged.connect(self._check)
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
        """Suggest the host as name until the user types a name."""
        if self._named and self.name.text():
            return
        host = re.sub(r"^[^/]*//|[:/?].*$|\{s\}\.", "", self.url.text().strip().lower())
        self._named = False
        suggested = re.sub(r"[^a-z0-9]+", "-", host).strip("-")[:64]
        if self._entry is not None and suggested:
            # Each layer of a service needs a different name.
            suggested = _free_name(f"{suggested}-{self._entry.title}")
        self.name.setText(suggested)

    def _data(self) -> dict[str, Any]:
        from ...core.imagery.catalogue import described

        typed = {
            "title": self.title.text().strip(),
            "attribution": self.attribution.text().strip(),
            "licence": self.licence.text().strip(),
            "terms_url": self.terms_url.text().strip(),
        }
        paced = {
            "max_connections": self.connections.value(),
            "requests_per_s": self.rate.value(),
            "cache_allowed": self.cached.isChecked(),
        }
        files = self.placeholders.text().split()
        if self._entry is not None:
            from ...core.imagery.placeholder import Placeholder

            known = list(Placeholder().extended(files).sha256)
            own = {name: text for name, text in typed.items() if text}
            marks = {"placeholder": {"sha256": known}} if known else {}
            return {**self._entry.to_data(), **own, **paced, **marks}
        return described(
            self.url.text().strip(),
            **typed,
            **paced,
            max_zoom=self.max_zoom.value(),
            tile_px=self.tile_px.currentData(),
            default_date=self.default_date.text().strip(),
            placeholders=files,
        )

    # --- services

    def _is_service(self) -> bool:
        from ...core.imagery.services.detecting import is_service_address

        return is_service_address(self.url.text().strip())

    def _forget(self) -> None:
        """Discard what was found at a previous address."""
        self._stop()
        self._found = self._entry = None
        for chooser in (self.layers, self.system):
            chooser.blockSignals(True)
            chooser.clear()
            chooser.blockSignals(False)
        self.notice.clear()
        self._show_tile(None)

    def _stop(self) -> None:
        if self._task is not None:
            self._task.abandon()
            self._task.close()
            self._task = None

    def _ask(self, description: str, work: Callable[[QgisTransport], object], then: Callable[[Any], None]) -> None:
        """Do ``work``, which uses the network, in the background, and call ``then`` with its result."""
        self._stop()

        def ended(task: _Asking) -> None:
            self._task = None
            if task.error:
                self.notice.setText(translate(task.error))
            else:
                self.notice.clear()
                then(task.result)
            self._check()

        address = self.url.text().strip()
        self._task = _Asking(description, work, address)
        self.notice.setText(tr("Asking the service…"))
        self._check()
        self._task.begin(ended)

    def _options(self, transport: QgisTransport, crs: str = "") -> SourceOptions:
        from ...core.imagery.opening import SourceOptions

        return SourceOptions(key=self.key.text().strip() or None, crs=crs, transport=transport, connections=1)

    def _find(self) -> None:
        """Request the kind of service and its layers, or its details if there is no layer to choose."""
        from ...core.imagery.services.detecting import found_service

        address = self.url.text().strip()
        options = self._options
        self._forget()

        def work(transport: QgisTransport) -> object:
            found = found_service(address, options(transport))
            return found, found.source.entry if found.layers is None else None

        self._ask(tr("Asking {name} for its layers").format(name=address), work, self._show_found)

    def _show_found(self, result: tuple[FoundService, CatalogueEntry | None]) -> None:
        self._found, entry = result
        if entry is not None:
            self._take(entry)
            return
        offered = self._found.layers or ()
        for layer in sorted(offered, key=lambda one: one.title.casefold()):
            item = QListWidgetItem(_describe_layer(layer))
            item.setData(Qt.ItemDataRole.UserRole, layer)
            item.setToolTip(shown_plain(", ".join((layer.name, *layer.sets, *layer.systems))))
            self.layers.addItem(item)
        self.notice.setText(tr("{count} layers").format(count=number_text(len(offered))))
        if len(offered) == 1:
            self.layers.setCurrentRow(0)

    def _layer_chosen(self) -> None:
        layer = self._layer()
        self.system.blockSignals(True)
        self.system.clear()
        if layer is not None:
            self.system.addItem(tr("Automatic"), "")
            for code in layer.systems:
                self.system.addItem(code, code)
        self.system.blockSignals(False)
        self._describe()

    def _layer(self) -> Offered | None:
        items = self.layers.selectedItems()
        return items[0].data(Qt.ItemDataRole.UserRole) if items else None

    def _describe(self) -> None:
        """Request the details of the chosen layer."""
        from ...core.imagery.opening import named_source

        layer, found = self._layer(), self._found
        self._entry = None
        if layer is None or found is None:
            self._check()
            return
        choice = f"{found.layer_choice}={quote(layer.name, safe='')}"
        joint = "&" if "#" in found.source.text else "#"
        name, crs = f"{found.source.text}{joint}{choice}", self.system.currentData() or ""
        options = self._options
        self._ask(
            tr("Asking {name} for its layers").format(name=layer.title),
            lambda transport: named_source(name, options(transport, crs)).entry,
            self._take,
        )

    def _take(self, entry: CatalogueEntry) -> None:
        """Show a service's details of a layer as grey hints; what the user types takes precedence."""
        self._entry = entry
        self.title.setPlaceholderText(entry.title)
        self.attribution.setPlaceholderText(entry.attribution)
        self.licence.setPlaceholderText(entry.policy.licence)
        self.terms_url.setPlaceholderText(entry.policy.terms_url)
        self._suggest_name()

    # --- a tile

    def _try(self) -> None:
        """Fetch and show one tile of the entered source."""
        from ...core.imagery.entry import CatalogueEntry, under_provider
        from ...core.imagery.opening import DescribedSource
        from ...core.imagery.trial import try_tile

        try:
            entry = under_provider(CatalogueEntry.from_dict(self.name.text().strip() or "own", self._data(), user=True))
        except TerrAInavError as wrong:
            self.marks.show(_field_message(wrong))
            return
        place = self._place() or (None, None)
        options = self._options
        self._show_tile(None)
        self._ask(
            tr("Fetching a tile of {name}").format(name=entry.title),
            lambda transport: try_tile(DescribedSource(entry, options(transport)), *place),
            self._show_tile,
        )

    def _show_tile(self, trial: Trial | None) -> None:
        self.tile.setVisible(trial is not None)
        self.about_tile.setVisible(trial is not None)
        if trial is None:
            self.tile.clear()
            self.about_tile.clear()
            return
        pixels = trial.pixels[..., :3].tobytes()
        height, width = trial.pixels.shape[:2]
        image = QImage(pixels, width, height, 3 * width, QImage.Format.Format_RGB888).copy()
        room = self.tile.size()
        keep, smooth = Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
        self.tile.setPixmap(QPixmap.fromImage(image).scaled(room, keep, smooth))
        self.about_tile.setText(
            tr(
                "Tile {tile}: {width} x {height} px, {format}, {kilobytes} kB, in {seconds} s. Zoom {least} to {most}. "
                "Attribution: {attribution}."
            ).format(
                tile="/".join(map(str, trial.tile)),
                width=width,
                height=height,
                format=trial.format or tr("unknown format"),
                kilobytes=number_text(trial.file_bytes / 1000.0, ".1f"),
                seconds=number_text(trial.seconds, ".2f"),
                least=trial.min_zoom,
                most=trial.native_zoom,
                attribution=trial.attribution or tr("none stated"),
            )
        )

    def _check(self) -> None:
        """Bring rows, errors, limits and buttons up to date with the entries."""
        from ...core.imagery.entry import CatalogueEntry, under_provider
        from ...core.imagery.tiles import check_address

        service, busy = self._is_service(), self._task is not None
        shown = {
            "key": "{key}" in self.url.text(),
            "layers": self.layers.count() > 0,
            "system": self.system.count() > 2,
            "max_zoom": not service,
            "tile_px": not service,
        }
        for name, visible in shown.items():
            for widget in self._rows[name]:
                widget.setVisible(visible)
        self.find_layers.setEnabled(service and not busy)
        self.notice.setVisible(bool(self.notice.text()))
        dated = "{date}" in self.url.text()
        for widget in (self._date_label, self._date_row):
            widget.setVisible(dated)
        if not dated:
            self.default_date.clear()
        messages: dict[str, str] = {}
        limits = ""
        url, name = self.url.text().strip(), self.name.text().strip()
        ready = bool(url) and (not service or self._entry is not None)
        try:
            if ready:
                entry = CatalogueEntry.from_dict(name or "own", self._data(), user=True)
                limits = limits_html(under_provider(entry))
                self.title.setPlaceholderText(entry.title)
            elif service:
                check_address(re.sub(r"^\w+:(?=https?:)|#.*", "", url), tr("address"))
        except TerrAInavError as wrong:
            messages = _field_message(wrong)
            ready = False
        self.test.setEnabled(ready and not busy)
        if name and "name" not in messages:
            messages.update(_name_problem(name))
        self.marks.show(messages)
        self.limits.setText(limits)
        ok = self.buttons.button(QDialogButtonBox.StandardButton.Ok)
        ok.setEnabled(bool(ready and name and not messages and not busy))


class ServiceDialog(QDialog):
    """List the layers of a service, filtered by typing, and save the chosen layer as a source.

    Attributes
    ----------
    added : str
        Name of the source saved; empty for none.
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
        self.notice = wrapped_label("notice")
        self.buttons = ok_and_cancel(self)
        add_help_button(self.buttons, tr("sources"))
        layout = QVBoxLayout(self)
        for widget in (self.search, self.list, self.notice, self.buttons):
            layout.addWidget(widget)
        self.resize(520, 420)
        self.search.textChanged.connect(self._filter)
        self.list.itemSelectionChanged.connect(self._show_ready)
        self.list.itemDoubleClicked.connect(lambda _: self.accept())
        self._show_ready()
        self._ask(_Capabilities(service), self._show_layers)

    def accept(self) -> None:
        """Request the details of the chosen layer, and save it."""
        layer = self._chosen()
        if layer and self._task is None:
            self._ask(_Capabilities(self._service, self._kind, layer), self._keep)

    def done(self, result: int) -> None:
        """Cancel pending requests."""
        if self._task is not None:
            self._task.abandon()
            self._task = None
        super().done(result)

    def _ask(self, task: _Capabilities, then: object) -> None:
        self._task = task
        self.notice.setText(tr("Asking the service…"))
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
        self.notice.setText(translate(task.error) or text)
        self._show_ready()

    def _keep(self, task: _Capabilities) -> None:
        self._task = None
        try:
            if task.error or task.entry is None:
                raise SourceError(task.error or tr("nothing was answered"))
            self.added = save_layer(task.entry, self._service, self._chosen())
        except TerrAInavError as wrong:
            self.notice.setText(translate(wrong))
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


def save_layer(entry: CatalogueEntry, service: ServiceConnection, layer: str) -> str:
    """Save a layer as a user's source, with the connection's authentication, and return its name.

    Raises
    ------
    TerrAInavError
        The source cannot be saved.
    """
    from ...core.imagery.catalogue import add

    name = _free_name(f"{service.name} {layer}")
    title = tr("{layer} ({service})").format(layer=entry.title, service=service.name)
    add(name, {**entry.to_data(), "title": title})
    # No credentials if the capabilities refer to another server for the tiles: the user did not agree to that.
    if all(credential_home(url) == credential_home(service.address) for url in entry.urls.values()):
        Settings().set_authcfg(name, store_key(title, service.key) if service.key else service.authcfg)
    return name


def _free_name(words: str) -> str:
    """Unused source name made from words."""
    from ...core.imagery.catalogue import shelf, sources

    taken = {known.name for known in sources()} | set(shelf().problems)
    # Shorten the name, to leave room for a number.
    plain = re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")[:56].strip("-") or "layer"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain}-{number}", number + 1
    return name


def _describe_layer(layer: Offered) -> str:
    """Title of a layer, with its reference systems and dates if known."""
    codes = list(layer.systems[:_SYSTEMS_NAMED])
    if len(layer.systems) > _SYSTEMS_NAMED:
        codes.append(tr("{count} more").format(count=number_text(len(layer.systems) - _SYSTEMS_NAMED)))
    parts = [layer.title or layer.name, ", ".join(codes)]
    if layer.dates is not None:
        parts.append(translate(layer.dates.text()))
    return " · ".join(filter(None, parts))


def _name_problem(name: str) -> dict[str, str]:
    """Message for a name that is invalid or taken."""
    from ...core.imagery.catalogue import sources
    from ...core.imagery.entry import NAME

    if not NAME.fullmatch(name):
        return {"name": tr("must be lower-case letters, digits, hyphens and underscores, at most 64")}
    try:
        taken = any(entry.name == name for entry in sources())
    except TerrAInavError as wrong:
        return {"name": translate(wrong)}
    return {"name": tr("“{name}” is taken; choose another name").format(name=name)} if taken else {}


def _field_message(error: TerrAInavError) -> dict[str, str]:
    """Text of an error by entry: of its cause if there is one, as only the error itself names the new source."""
    inner = error.__cause__ if isinstance(error.__cause__, TerrAInavError) else error
    return {_ENTRIES.get(inner.field, "url"): translate(inner)}


class _Asking(Task):
    """A request to a server.

    Attributes
    ----------
    result : object
        Result of the request.
    """

    def __init__(self, description: str, work: Callable[[QgisTransport], object], address: str) -> None:
        super().__init__(description)
        from ...core.limits import MAX_CAPABILITIES_BYTES

        self.result: object = None
        self._work = work
        self._transport = QgisTransport(1, max_body_bytes=MAX_CAPABILITIES_BYTES, home=credential_home(address))

    def work(self) -> None:
        """Send the request."""
        with closing(self._transport):
            self.result = self._work(self._transport)

    def close(self) -> None:
        """Cancel the requests."""
        self._transport.close()

    def cancel(self) -> None:
        """Cancel the task and its requests."""
        super().cancel()
        self._transport.close()

    def finished(self, result: bool) -> None:
        """Emit `ended`, on the main thread."""
        self._transport.close()
        super().finished(result)


class _Capabilities(Task):
    """Request the layers of a service, or the details of a layer.

    Attributes
    ----------
    kind : str
        wms or wmts, once known.
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
        self._transport = QgisTransport(1, max_body_bytes=MAX_CAPABILITIES_BYTES, authcfg=service.authcfg, home=home)

    def work(self) -> None:
        """Send the requests."""
        with closing(self._transport):
            if self._layer:
                chosen = f"{_CHOICES[self.kind]}={quote(self._layer, safe='')}"
                self.entry = self._named(f"{self.kind}:{self._service.address}#{chosen}").entry
            else:
                self._find_layers()

    def cancel(self) -> None:
        """Cancel the task and its requests."""
        super().cancel()
        self._transport.close()

    def finished(self, result: bool) -> None:
        """Emit `ended`, on the main thread."""
        # Also needed here: a task cancelled before its start does not run `work`.
        self._transport.close()
        super().finished(result)

    def _named(self, name: str) -> NamedSource:
        from ...core.imagery.opening import SourceOptions, named_source

        return named_source(name, SourceOptions(key=self._service.key or None, transport=self._transport))

    def _find_layers(self) -> None:
        """Try WMS and WMTS, as QGIS's connections do not state the kind of service."""
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
