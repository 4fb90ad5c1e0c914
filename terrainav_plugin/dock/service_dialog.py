"""A layer of a WMS or WMTS that the user has a connection to in QGIS: chosen, and kept with the user's own sources."""

from __future__ import annotations

import re
from contextlib import closing
from typing import TYPE_CHECKING
from urllib.parse import quote

from qgis.core import QgsApplication
from qgis.PyQt.QtCore import Qt
from qgis.PyQt.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QVBoxLayout,
    QWidget,
)

from ...core.errors import SourceError, TerrAInavError
from ..credentials import store_key
from ..help import add_help_button
from ..i18n import number_text, told, tr
from ..network.transport import QgisTransport
from ..plain import plain_label, shown_plain
from ..qgis_source.connections import ServiceConnection
from ..settings import Settings, credential_home
from ..tasks import Task

if TYPE_CHECKING:
    from ...core.imagery.catalogue.entry import CatalogueEntry
    from ...core.imagery.services.capabilities import Offered

_ROOM_PX = (520, 420)
#: Choice of a layer in a service's name, by kind.
_CHOICES = {"wms": "layers", "wmts": "layer"}
#: Longest part of a layer's name that its source is called by: room is left for a number.
_NAME_LETTERS = 56


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
        from ...core.imagery.services.ogc import service_entry

        with closing(self._transport):
            if self._layer:
                chosen = f"{_CHOICES[self.kind]}={quote(self._layer, safe='')}"
                name = f"{self.kind}:{self._service.address}#{chosen}"
                self.entry = service_entry(name, key=self._service.key or None, transport=self._transport)
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

    def _find_layers(self) -> None:
        """QGIS's connections do not say which of the two they lead to."""
        from ...core.imagery.services.ogc import layers

        kinds = ("wmts", "wms") if "wmts" in self._service.address.lower() else ("wms", "wmts")
        problems: list[str] = []
        for kind in kinds:
            self.kind = kind
            try:
                name = f"{kind}:{self._service.address}"
                self.layers = layers(name, key=self._service.key or None, transport=self._transport)
            except SourceError as wrong:
                problems.append(str(wrong))
            else:
                return
        raise SourceError(problems[0])


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
        self.search = QLineEdit()
        self.search.setObjectName("search")
        self.search.setClearButtonEnabled(True)
        self.search.setPlaceholderText(tr("Search"))
        self.search.setToolTip(tr("Part of a layer's title or name"))
        self.list = QListWidget()
        self.list.setObjectName("layers")
        self.list.setToolTip(tr("Layers that the service offers"))
        self.told = plain_label()
        self.told.setObjectName("told")
        self.told.setWordWrap(True)
        self.buttons = QDialogButtonBox(
            QDialogButtonBox.StandardButton.Ok | QDialogButtonBox.StandardButton.Cancel
        )
        add_help_button(self.buttons, tr("sources"))
        layout = QVBoxLayout(self)
        for widget in (self.search, self.list, self.told, self.buttons):
            layout.addWidget(widget)
        self.resize(*_ROOM_PX)
        self.search.textChanged.connect(self._filter)
        self.list.itemSelectionChanged.connect(self._show_ready)
        self.list.itemDoubleClicked.connect(lambda _: self.accept())
        self.buttons.accepted.connect(self.accept)
        self.buttons.rejected.connect(self.reject)
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
            self._task.ended.disconnect()
            self._task.cancel()
            self._task = None
        super().done(result)

    def _ask(self, task: _Capabilities, then: object) -> None:
        self._task = task
        self.told.setText(tr("Asking the service…"))
        self._show_ready()
        task.ended.connect(then)
        QgsApplication.taskManager().addTask(task)

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
        self.told.setText(told(task.error) or text)
        self._show_ready()

    def _keep(self, task: _Capabilities) -> None:
        self._task = None
        try:
            if task.error or task.entry is None:
                raise SourceError(task.error or tr("nothing was answered"))
            self.added = kept(task.entry, self._service, self._chosen())
        except TerrAInavError as wrong:
            self.told.setText(told(wrong))
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
    from ...core.imagery.catalogue.listing import sources
    from ...core.imagery.catalogue.user_sources import add, shelf

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
