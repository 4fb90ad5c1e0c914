"""Dialog for the address of a remote dataset: a web server or an object store."""

from __future__ import annotations

from qgis.gui import QgsAuthConfigSelect
from qgis.PyQt.QtWidgets import QDialog, QLabel, QVBoxLayout, QWidget

from ...core.errors import InvalidInput
from ..help import add_help_button
from ..i18n import tr, translate
from ..paths import entered_folder, exists
from ..remote.address import DatasetAddress
from ..settings import Settings
from ..widgets import STYLE_SHEET, FieldMarks, growing_form, line_edit, named, ok_and_cancel, show_row


class AddressDialog(QDialog):
    """Ask for the address of a dataset, and for a web server's authentication.

    Attributes
    ----------
    address : DatasetAddress or None
        None if a local folder was entered.
    """

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("terrainav_address")
        self.setWindowTitle(tr("TerrAInav: open dataset at an address"))
        self.setStyleSheet(STYLE_SHEET)
        self.address: DatasetAddress | None = None
        self._settings, self._marks = Settings(), FieldMarks()
        self.entry = line_edit(
            "dataset_address",
            tr("The dataset's folder, or its collection.json, items.parquet or meta_data.csv"),
            "https://host/run, s3://bucket/run",
        )
        self.key = named(
            QgsAuthConfigSelect(),
            "dataset_key",
            tr("For requests to this web server; object stores use the settings of AWS's tools"),
        )
        self._form = growing_form()
        label = QLabel(tr("&Address"))
        label.setBuddy(self.entry)
        self._form.addRow(label, self._marks.field("address", self.entry))
        self._form.addRow(tr("Authentication"), self.key)
        self.buttons = ok_and_cancel(self)
        add_help_button(self.buttons, tr("datasets-at-an-address"))
        layout = QVBoxLayout(self)
        layout.addLayout(self._form)
        layout.addWidget(self.buttons)
        self.setMinimumWidth(560)
        self.entry.textChanged.connect(self._changed)
        self._changed()

    def accept(self) -> None:
        """Accept the address; if it is invalid, stay open and show why."""
        text = self.entry.text().strip()
        if "://" not in text and text and exists(entered_folder(text)):
            super().accept()
            return
        try:
            self.address = DatasetAddress.parse(text)
        except InvalidInput as wrong:
            self._marks.show({"address": translate(wrong)})
            return
        if not self.address.is_s3:
            self._settings.set_authcfg(self.address.url, self.key.configId())
        super().accept()

    def _changed(self) -> None:
        """Offer the authentication of the server being entered."""
        self._marks.show({})
        text = self.entry.text().strip()
        is_web = text.lower().startswith(("http://", "https://"))
        show_row(self._form, self.key, is_web)
        if is_web:
            self.key.setConfigId(self._settings.authcfg(text))
